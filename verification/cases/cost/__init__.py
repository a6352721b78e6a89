# SPDX-License-Identifier: MIT
"""Error against run time, uncertainty and accuracy."""
