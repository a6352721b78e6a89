# SPDX-License-Identifier: MIT
"""The conditions of a solution, measured on a returned result with formulas of their own."""
