# SPDX-License-Identifier: MIT
"""What the model says of a test at its points, by solves, or from the store."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from sam.scene import UNLOADED, Progress, Result, Scene, Status
from verification.fit.definition import Test, Variables
from verification.runs import models
from verification.runs.model_range import errors
from verification.runs.store import Store, solve_or_reuse

LEAST_CELLS = 4  # in the contact radius: with fewer a result is not resolved
HISTORY = ("force_N", "approach_m", "contact_area_m2")


class FitError(models.ModelError):
    """A fit that cannot be made; the message says why and what to change."""


@dataclass(frozen=True)
class Answer:
    """Of a model on a test. depths: at its points, in m; off: by how much small strains of a flat half-space
    put them off there, as far as that was measured; strain: the largest plastic one; ratio: a/R.
    """

    depths: np.ndarray
    off: np.ndarray
    strain: float
    ratio: float


Answers = Callable[[Test, Variables, bool], Answer]
"""Of a test, values of its unknown keys, and whether on the fine grid."""


@dataclass
class Solves:
    """Answers by solving, each different scene once. told: of the number of solves; twice: whether tests are
    loaded a second time, as the unloading of one was elastic, and has no load steps.
    """

    model: str
    store: Store | None
    told: Progress = lambda *_: None
    known: dict[str, Result] = field(default_factory=dict)
    twice: bool = False

    def __call__(self, test: Test, values: Variables, fine: bool) -> Answer:
        """The answer; an unloading that is elastic is that of a second cycle.

        Raises FitError where the model does not hold, or was not solved.
        """
        scene = test.at(values) if fine else coarser(test.at(values))
        back = bool(test.points.unloading.any())
        result = self._once(_again(scene) if back and self.twice else scene)
        if back and not self.twice:
            force = np.asarray(result.tables["history"]["force_N"], dtype=float)
            if not (force[int(np.argmax(force)) + 1 :] > 0.0).any():  # none after the peak before the last, 0
                self.twice = True
                result = self._once(_again(scene))
        radius, found = scene.counterbody.radius if scene.counterbody else None, result.quantities
        ratio = (found["contact_radius_m"] or 0.0) / (radius or np.inf)
        return Answer(_depths(test, result), _off(test, result), float(found["peeq_max"] or 0.0), ratio)

    def _once(self, scene: Scene) -> Result:
        key = scene.model_dump_json()
        if key not in self.known:
            self.told(f"{len(self.known)} model solves", 0, 0)
            try:
                models.check(scene, self.model)
                result, _ = solve_or_reuse(self.store, scene, self.model)
            except models.ModelError as error:
                raise FitError(f"data outside of the range of the model: {error}") from None
            if result.status not in (Status.CONVERGED, Status.OUTSIDE_OF_MODEL):
                words = f"{result.status}: {result.message or result.status.advice}"
                raise FitError(f"the model was not solved: {words}; or narrow the bounds of the fit")
            self.known[key] = result
        return self.known[key]


def coarser(scene: Scene) -> Scene:
    """The scene with half the load steps, and half the cells where it says how many."""
    load, grid, cells = scene.loading, scene.grid, scene.fem.cells_per_radius
    cells = min(cells, max(cells // 2, LEAST_CELLS))
    steps = {"steps": max(load.steps // 2, 1), "unload_steps": max((load.unload_steps or 2) // 2, 1)}
    change: dict[str, Any] = {"loading": load.model_copy(update=steps)}
    change["fem"] = scene.fem.model_copy(update={"cells_per_radius": cells})
    if grid is not None and grid.cells is not None:
        change["grid"] = grid.model_copy(update={"cells": tuple(n // 4 * 2 + n % 2 for n in grid.cells)})
    return scene.model_copy(update=change)


def _again(scene: Scene) -> Scene:
    """Loaded a second time: where unloading is elastic that is its way back."""
    return scene.model_copy(update={"loading": scene.loading.model_copy(update={"cycles": 2})})


def _depths(test: Test, result: Result) -> np.ndarray:
    """Depths of the model at the points of a test, in m."""
    if test.kind != "curve":
        line = result.tables["line"]
        x, uz = (np.asarray(line[name], dtype=float) for name in ("x_m", "uz_m"))
        rows = np.flatnonzero((np.asarray(line["state"]) == UNLOADED) & (x >= 0.0))
        rows = rows[np.argsort(x[rows])]
        return np.asarray(np.interp(test.points.x, x[rows], uz[rows]))
    table = result.tables["history"]
    force, depth, cycle = (np.asarray(table[name], dtype=float) for name in (*HISTORY[:2], "cycle"))
    first, back = np.flatnonzero(cycle == 1), test.points.unloading
    peak = int(np.argmax(force[first]))
    up, down = first[: peak + 1], first[peak:]
    if down.size <= 2 and (cycle == 2).any():  # elastic: the way back is that of the second loading
        again = np.flatnonzero(cycle == 2)
        down = np.concatenate([again[: int(np.argmax(force[again])) + 1][::-1], first[-1:]])
    found = np.empty(test.points.x.size)
    force_up, depth_up = (np.concatenate([[0.0], each[up]]) for each in (force, depth))
    found[~back] = _along(force_up, depth_up, test.points.x[~back])
    found[back] = _along(force[down][::-1], depth[down][::-1], test.points.x[back])
    return found


def _along(force: np.ndarray, depth: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Depth over force, monotone in force^(2/3), in which Hertz's approach is a line; ends hold beyond."""
    curve = PchipInterpolator(force ** (2.0 / 3.0), depth)
    return np.asarray(curve(np.clip(at, force[0], force[-1]) ** (2.0 / 3.0)))


def _off(test: Test, result: Result) -> np.ndarray:
    """By how much the depths of a curve are off by small strains of a flat half-space, in m."""
    law, ball = (result.model_range or {}).get("law"), test.scene.counterbody
    if law is None or test.kind != "curve" or ball is None or ball.radius is None:
        return np.zeros(test.points.x.size)
    history = (np.asarray(result.tables["history"][name], dtype=float) for name in HISTORY)
    force, approach, area = history
    last = int(np.argmax(force)) + 1
    ratios, nu = np.sqrt(area[:last] / np.pi) / ball.radius, test.scene.body.poisson
    share = np.array([errors(law, nu, float(ratio)).get("approach", (0.0, 0.0))[0] for ratio in ratios])
    shift = np.concatenate([[0.0], share * approach[:last]])
    at = np.interp(test.points.x, np.concatenate([[0.0], force[:last]]), shift)
    return np.where(test.points.unloading, shift[-1], at)
