# SPDX-License-Identifier: MIT
"""The numerical uncertainty of a result: the same scene on three grids and with three numbers of load steps.

The solvers know nothing of it.
"""

from verification.uncertainty.solving import asked_of, solve, unknown

__all__ = ["asked_of", "solve", "unknown"]
