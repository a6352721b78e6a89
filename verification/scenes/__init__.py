# SPDX-License-Identifier: MIT
"""The scenes that are shipped, and the recipes by which the heights of two of them were made."""
