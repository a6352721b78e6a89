# SPDX-License-Identifier: MIT
"""A-posteriori checks: the conditions of a solution, measured on a returned result with formulas of their
own.

Nothing that a solver says of its own residuals is used. The cases use this room; it uses `runs` and
`reference`, and of the solvers their models and load steps.
"""
