# SPDX-License-Identifier: MIT
"""Removal of worn material: worn depth of each column, its smoothing, remap of the material, bookkeeping.
Arrays only.
"""
