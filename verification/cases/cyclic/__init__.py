# SPDX-License-Identifier: MIT
"""Bodies with back-stresses under loads that come and go or travel."""
