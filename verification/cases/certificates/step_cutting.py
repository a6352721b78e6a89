# SPDX-License-Identifier: MIT
"""Near-perfect and perfect plasticity far beyond yield, in few load steps: both solvers finish, or say what
stops them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_body,
    with_grid,
    with_keys,
    with_loading,
    with_mesh,
)
from verification.cases.recipes import at_ratio
from verification.checks.certificates import curves_of
from verification.checks.conditions import peak_rows
from verification.figures.lines import histories
from verification.references import contact_of

SLOPES = {"perfect": 0.0, "nearly-perfect": 1e-4}  # of the yield curve over Young's modulus
EXTENT = {6.2: (2.5, 3.3), 15.0: (5.5, 5.4)}
"""p0/sigma_y0 -> half sides of the grid and its depth in elastic contact radii; the contact itself grows to
1.1 and 1.9.
"""
CELLS = {"quick": {6.2: (6, 6), 15.0: (4, 4)}, "full": {6.2: (8, 10), 15.0: (6, 8)}}
"""Of SAM and of FEM in the elastic contact radius."""
ONCE, TIGHT = "15-perfect-one-step-sam", 1e-9  # the whole load, to this tolerance: more than SAM iterates


def scene_of(
    base: Scene, ratio: float, cells: tuple[int, int], *, slope: float = 0.0, steps: int = 15
) -> Scene:
    """p0/sigma_y0 = ratio on these cells; layers are even down to 1.8 radii, then each thicker than the
    last.
    """
    if slope:
        keys = {"law": "linear", "modulus": slope * base.body.young}
        base = with_body(base, plasticity=base.body.plasticity.model_copy(update=keys))
    scene = with_loading(at_ratio(base, ratio), steps=steps, unload=False)
    a, (count, elements), (reach, deepest) = contact_of(scene).contact_radius, cells, EXTENT[ratio]
    n, even = 2 * round(reach * count) + 1, np.arange(round(3.0 * count) + 1) / count
    faces = even + (deepest - 3.0) / 1.2**2 * np.maximum(even - 1.8, 0.0) ** 2
    grid = {"cells": (n, n), "extent": (n * a / count,) * 2, "depths": tuple(float(z) for z in a * faces)}
    return with_mesh(with_grid(scene, **grid), elements)


class StepCutting(Case):
    """Both ratios with both models; and one step from nothing, which SAM cuts if it must."""

    def solve(self, context: Context) -> dict[str, Result]:
        """Name of a solve, as 6.2-perfect-sam -> what became of it."""
        base, results = context.scene("plastic-perfect"), {}
        for ratio, cells in CELLS[context.level].items():
            for law in SLOPES if context.level == "full" else ("perfect",):
                scene = scene_of(base, ratio, cells, slope=SLOPES[law])
                for name, model in (("sam", SAM), ("fem", FEM)):
                    label = f"{ratio:g}-{law}-{name}"
                    results[label] = context.solve(model, scene, label, demand=False)
        once = with_keys(scene_of(base, 15.0, CELLS["quick"][15.0], steps=1), "solver", tolerance=TIGHT)
        return results | {ONCE: context.solve(SAM, once, ONCE, demand=False)}

    def measure(self, found: Mapping[str, Result]) -> dict[str, Measured]:
        """Of pairs of models the largest relative difference, not a number where a peak was not reached."""

        def apart(of: Callable[[Result], float]) -> float:
            pairs = [(found[f"{name[:-4]}-sam"], found[name]) for name in found if name.endswith("-fem")]
            missing = [a.last_fitting or b.last_fitting for a, b in pairs]
            return math.nan if any(missing) else max(abs(of(a) / of(b) - 1.0) for a, b in pairs)

        def cuts(model: str) -> int:
            return max(each.cost["step_cuts"] for name, each in found.items() if name.endswith(model))

        loads = [
            math.nan if r.last_fitting else r.quantities["force_N"] / r.tables["history"]["force_N"][-1] - 1.0
            for r in found.values()
        ]
        return {
            "unfinished": Measured(sum(not result.converged for result in found.values()), 0),
            "fem-cuts": Measured(cuts("-fem")),
            "sam-cuts": Measured(cuts("-sam")),
            "load": Measured(float(np.abs(loads).max())),
            "area": Measured(apart(lambda result: result.quantities["contact_area_m2"])),
            "approach": Measured(apart(lambda result: result.quantities["approach_m"])),
            "axis": Measured(apart(on_axis)),
        }

    def tables(self, found: Mapping[str, Result]) -> Iterator[SmallTable]:
        columns = ("solve", "status", "attempts", "cuts", "time [s]", "contact area [µm²]", "approach [nm]")
        rows = [
            (
                name,
                str(r.status),
                f"{len(curves_of(r))}",
                f"{r.cost['step_cuts']}",
                f"{r.cost['cpu_s']:.1f}",
                f"{1e12 * r.quantities['contact_area_m2']:.1f}",
                f"{1e9 * r.quantities['approach_m']:.0f}",
                f"{1e2 * r.quantities['peeq_max']:.2f}",
                f"{1e2 * on_axis(r):.2f}",
            )
            for name, r in found.items()
        ]
        heads = (*columns, "largest peeq [%]", "on the axis [%]")
        yield SmallTable("What it took, and what was found", heads, rows)

    def notes(self, found: Mapping[str, Result]) -> Iterator[str]:
        yield (
            "The largest plastic strain of a perfectly plastic body lies at single points near the edge of "
            "contact and grows with refinement in both models; area, approach and the strain on the axis are "
            "what the models are compared by. SAM takes each of the 15 steps without a cut; it cuts where "
            "the tolerance asks for more iterations than a step may take."
        )

    def figures(self, found: Mapping[str, Result]) -> Iterator[Plot]:
        drawn = {name: curves_of(each) for name, each in found.items() if "nearly" not in name}
        words = (
            "Residuals over the iterations; blue: accepted, the later the darker; red: given up, and the way "
            "to the load halved; dotted: where an attempt may stop."
        )
        yield Plot(histories(drawn), "residuals", "Attempts at the load steps", words, words)


def on_axis(result: Result) -> float:
    """Largest plastic strain under the apex."""
    return float(np.max(peak_rows(result, "axis")["peeq"]))


CASES = (StepCutting("step-cutting"),)
