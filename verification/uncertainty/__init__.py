# SPDX-License-Identifier: MIT
"""The numerical uncertainty of a result: the same scene on three grids and with three numbers of load steps.

The solvers know nothing of it.
"""
