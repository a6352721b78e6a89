# SPDX-License-Identifier: MIT
"""Elasto-plastic contact: eigenstrains on a box of cells, return mapping, load history."""
