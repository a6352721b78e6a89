# SPDX-License-Identifier: MIT
"""Elastic contact of half-spaces on a grid of cells: search for the cells in contact, operators, and stresses
below it.

Uses the influence coefficients of `sam.kernels` and `sam.layered`. Used by `sam.plasticity` and the solver.
"""
