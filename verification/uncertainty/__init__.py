# SPDX-License-Identifier: MIT
"""The numerical uncertainty of a result: the same scene on three grids and with three numbers of load steps.

The solvers know nothing of it.
"""

from verification.uncertainty.members import Family, Member, NoFamilyError, family
from verification.uncertainty.quantities import ORDERS, STEP_ORDER
from verification.uncertainty.rule import FACTOR, bound, converging, order_seen
from verification.uncertainty.solving import asked_of, solve

__all__ = [
    "FACTOR",
    "ORDERS",
    "STEP_ORDER",
    "Family",
    "Member",
    "NoFamilyError",
    "asked_of",
    "bound",
    "converging",
    "family",
    "order_seen",
    "solve",
]
