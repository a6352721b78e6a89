# SPDX-License-Identifier: MIT
"""Residual histories of load steps, the same record for every solver, and in words why an iteration ended
above its tolerance.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sam.scene.result import RESIDUALS

RECENT = 10  # iterations that are asked whether the residual still falls
FALLS = 0.5  # it does if they bring its smallest value below this share of that before them


@dataclass(frozen=True)
class Attempt:
    """One attempt at a load, a whole step or a part of one.

    Parameters
    ----------
    accepted
        False if it was discarded, and the way to it halved.
    residuals
        After each iteration, in the measure by which the solver stops (zero: nothing to do).
    goal
        The residual at which it may stop.
    """

    accepted: bool
    residuals: tuple[float, ...]
    goal: float

    @classmethod
    def from_tree(cls, tree: dict[str, Any]) -> Attempt:
        """The attempt in the tree of a checkpoint."""
        return cls(**tree | {"residuals": tuple(tree["residuals"])})


def residual_table(steps: Iterable[tuple[int, int, Sequence[Attempt]]]) -> dict[str, list[Any]]:
    """One row an iteration. steps: (cycle, step, its attempts in their order)."""
    rows = [
        (cycle, step, k, int(attempt.accepted), n, residual, attempt.goal)
        for cycle, step, attempts in steps
        for k, attempt in enumerate(attempts, start=1)
        for n, residual in enumerate(attempt.residuals, start=1)
    ]
    return {name: [row[k] for row in rows] for k, name in enumerate(RESIDUALS)}


def stagnates(residuals: Sequence[float]) -> bool:
    """Whether the last iterations hardly lowered the smallest residual before them."""
    before, recent = residuals[:-RECENT], residuals[-RECENT:]
    return bool(before) and not min(recent) < FALLS * min(before)


def unfinished(what: str, residuals: Sequence[float], goal: float, stalled: bool | None = None) -> str:
    """Why an iteration ended above its goal: it diverged, it stagnates, or it ran out of iterations while it
    still fell.

    stalled: whether it gave up before its limit because the residual no longer fell; None: judged by the
    history.
    """
    finite = [value for value in residuals if np.isfinite(value)]
    if not finite or len(finite) < len(residuals) or finite[-1] > max(10.0 * finite[0], 1.0):
        return f"{what} diverged"
    best = min(finite)
    if stagnates(finite) if stalled is None else stalled:
        return f"{what} stagnated: its residual no longer falls below {best:.1e}, and {goal:.1e} is wanted"
    left = f"{best:.1e} is left, {goal:.1e} is wanted"
    return f"{what} ran out of iterations, {len(finite)}, while its residual still fell: {left}"
