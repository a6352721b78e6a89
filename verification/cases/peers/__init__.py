# SPDX-License-Identifier: MIT
"""Other programs on the same contacts."""
