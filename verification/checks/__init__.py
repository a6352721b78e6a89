# SPDX-License-Identifier: MIT
"""A-posteriori checks: the conditions of a solution, measured on a returned result with formulas of their
own.

Nothing that a solver says of its own residuals is used.
"""
