# SPDX-License-Identifier: MIT
"""Plastic strain under given tractions as cells and load steps become small, of each model from its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Scene
from verification.cases.case import FEM_3D, SAM, Context, SmallTable, number, off_text
from verification.compare.sliding_measures import Plane, depths_compared
from verification.runs.store import solve_or_reuse

FRICTION = 0.2
CELLS = {SAM: (12, 16), FEM_3D: (10, 12)}  # in the contact radius, loaded in one step
COARSE = {SAM: 12, FEM_3D: 8}  # the same, loaded in STEPS
STEPS = (1, 5, 10)
SHOWN = 0.45  # depth in radii of the strain at its largest


@dataclass(frozen=True)
class Limit:
    """cells: of one load step, by cells (SAM) or elements (FEM) in the contact radius; steps: by load steps,
    on one of them.
    """

    cells: Mapping[int, Plane]
    steps: Mapping[int, Plane]

    def at(self, x: float, z: np.ndarray) -> np.ndarray:
        """The strain at (x, z) in contact radii, (n,), without cells and load steps: of second order in the
        one and of first in the other, whose share is much the same on any cells.
        """
        (few, coarse), (many, fine) = ((n, _at(plane, x, z)) for n, plane in self.cells.items())
        one, some, more = (_at(self.steps[count], x, z) for count in STEPS)
        in_cells = (many**2 * fine - few**2 * coarse) / (many**2 - few**2)
        return in_cells * (more + (more - some) * STEPS[1] / (STEPS[2] - STEPS[1])) / one


@dataclass(frozen=True)
class Limits:
    """Of both models. solved: their planes with the cells and load steps of the case; x: of the profile."""

    sam: Limit
    fem: Limit
    solved: tuple[Plane, Plane]
    places: Mapping[str, float]

    def values(self) -> dict[str, float]:
        """Largest relative difference of both limits on each profile."""
        return {f"limit-{name}": self.apart(x) for name, x in self.places.items()}

    def apart(self, x: float) -> float:
        """The same at x, over the depths at which profiles are compared."""
        z = depths_compared(self.solved[1], x)
        return float(np.abs(self.sam.at(x, z) / self.fem.at(x, z) - 1.0).max())

    def table(self) -> SmallTable:
        """Both limits over depth, and how far each solve of the case is from its own."""
        rows = []
        for x in self.places.values():
            for z in np.sort(np.append(depths_compared(self.solved[1], x), SHOWN)):
                at = np.array([z])
                sam, fem = (float(limit.at(x, at)[0]) for limit in (self.sam, self.fem))
                off = (
                    off_text(float(_at(plane, x, at)[0]), value)
                    for plane, value in zip(self.solved, (sam, fem), strict=True)
                )
                words = number(1e2 * fem, 4), number(1e2 * sam, 4), off_text(sam, fem), *off
                rows.append((f"{x:.2f}", f"{z:.2f}", *words))
        columns = ("x/a", "z/a", "FEM", "SAM", "difference", "SAM as solved", "FEM as solved")
        caption = f"Plastic strain in % without cells and load steps, μ = {FRICTION:g}"
        return SmallTable(caption, columns, rows)


def _at(plane: Plane, x: float, z: np.ndarray) -> np.ndarray:
    return plane.at(np.array([x]), z)[0]


def limits(context: Context, scene: Callable[[int, int], Scene], solved: tuple[Plane, Plane]) -> Limits:
    """Solve both models on the cells and in the load steps that their limits need; no run folders are
    written. scene: of so many cells or elements in the contact radius, and load steps.
    """

    def plane(model: str, count: int, steps: int) -> Plane:
        at = scene(count, steps)
        context.progress(f"limit of {model}: {count} in the contact radius, {steps} load steps", 0, 1)
        result, _ = solve_or_reuse(context.store, at, model)
        if not result.converged:
            raise RuntimeError(f"{model} with {count} in the contact radius ended {result.status}")
        return Plane.of(result, at.loading.radius)

    found = {
        model: Limit(
            {count: plane(model, count, 1) for count in CELLS[model]},
            {steps: plane(model, COARSE[model], steps) for steps in STEPS},
        )
        for model in CELLS
    }
    places = {"axis": 0.0, "column": solved[1].place_of_maximum()}
    return Limits(found[SAM], found[FEM_3D], solved, places)
