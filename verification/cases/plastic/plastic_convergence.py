# SPDX-License-Identifier: MIT
"""What the refinement of both models beyond yield takes of its points."""

import numpy as np

from verification.cases.case import DataFrame
from verification.reference.convergence import extrapolate


def limit_of_both(rows: DataFrame, column: str) -> float:
    """The limit of the grids, times what infinitely many load steps change on one grid."""
    (steps, grid), name = (rows[rows["sweep"] == each] for each in ("steps", "grid")), "loading.steps"
    used = steps[steps[name] == grid[name].iloc[0]][column].iloc[0]
    limits = [extrapolate(each["h"], each[column]).limit for each in (grid, steps)]
    return limits[0] * limits[1] / used


def growth_of_norms(rows: DataFrame, column: str) -> float:
    """The largest ratio of the differences on successive grids, in norms: below 1 both shrink every time."""
    apart = rows[["peeq-axis", "peeq-plane"]].to_numpy(dtype=float)
    return float(np.max(apart[1:] / apart[:-1]))
