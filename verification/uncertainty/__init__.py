# SPDX-License-Identifier: MIT
"""The numerical uncertainty of a result: the same scene on three grids and with three numbers of load steps.

The solvers know nothing of it.
"""

from verification.uncertainty.members import (
    RATIO,
    Family,
    Member,
    NoFamilyError,
    alone,
    coarser,
    depths_of_maxima,
    family,
    has_history,
    in_one_step,
    members_of_box,
    members_of_steps,
)
from verification.uncertainty.quantities import ORDERS, STEP_ORDER, why_not
from verification.uncertainty.rule import STEP_FACTOR, bound, converging, order_seen
from verification.uncertainty.solving import (
    Solve,
    Solved,
    asked_of,
    assessed,
    cost_of,
    solve,
    under_resolved,
)

__all__ = [
    "ORDERS",
    "RATIO",
    "STEP_FACTOR",
    "STEP_ORDER",
    "Family",
    "Member",
    "NoFamilyError",
    "Solve",
    "Solved",
    "alone",
    "asked_of",
    "assessed",
    "bound",
    "coarser",
    "converging",
    "cost_of",
    "depths_of_maxima",
    "family",
    "has_history",
    "in_one_step",
    "members_of_box",
    "members_of_steps",
    "order_seen",
    "solve",
    "under_resolved",
    "why_not",
]
