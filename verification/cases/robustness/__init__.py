# SPDX-License-Identifier: MIT
"""Extreme and wrong input, killed runs, changed numbers."""
