# SPDX-License-Identifier: MIT
"""Where flat surfaces and small strains stop being right."""
