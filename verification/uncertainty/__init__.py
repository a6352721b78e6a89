# SPDX-License-Identifier: MIT
"""The numerical uncertainty of a result: the same scene on three grids and with three numbers of load steps.

The solvers know nothing of it.
"""

from verification.uncertainty.members import (
    Family,
    Member,
    NoFamilyError,
    alone,
    cells_to_edge,
    coarser,
    family,
    has_history,
)
from verification.uncertainty.quantities import ORDERS, STEP_ORDER, why_not
from verification.uncertainty.rule import FACTOR, bound, converging, of_edge, order_seen
from verification.uncertainty.solving import Solve, asked_of, solve

__all__ = [
    "FACTOR",
    "ORDERS",
    "STEP_ORDER",
    "Family",
    "Member",
    "NoFamilyError",
    "Solve",
    "alone",
    "asked_of",
    "bound",
    "cells_to_edge",
    "coarser",
    "converging",
    "family",
    "has_history",
    "of_edge",
    "order_seen",
    "solve",
    "why_not",
]
