# SPDX-License-Identifier: MIT
"""Near-perfect and perfect plasticity far beyond yield, in few load steps: both solvers finish, or say what
stops them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

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
from verification.cases.certificates.certificates_measures import curves_of
from verification.cases.recipes import at_ratio
from verification.checks.conditions import peak_rows
from verification.figures.residuals import histories
from verification.references import contact_of

STEPS, SLOPE = 15, 1e-4
REACH = {
    6.2: 2.5,
    15.0: 5.5,
}  # half sides of the grid in elastic contact radii; the contact itself grows to 1.1 and 1.9
DEPTH = {6.2: 3.3, 15.0: 5.4}
CELLS = {"quick": {6.2: (6, 6), 15.0: (4, 4)}, "full": {6.2: (8, 10), 15.0: (6, 8)}}


@dataclass(frozen=True)
class StepScene:
    """A scene of the case. ratio: p0/sigma_y0; slope: of the yield curve over Young's modulus."""

    ratio: float
    slope: float

    @property
    def name(self) -> str:
        """The folder of its runs."""
        return f"{self.ratio:g}-{'perfect' if self.slope == 0.0 else 'nearly-perfect'}"

    def scene(self, base: Scene, cells: tuple[int, int], steps: int = STEPS) -> Scene:
        """cells: of SAM and of FEM in the elastic contact radius."""
        if self.slope:
            law = base.body.plasticity.model_copy(
                update={"law": "linear", "modulus": self.slope * base.body.young}
            )
            base = with_body(base, plasticity=law)
        scene = with_loading(at_ratio(base, self.ratio), steps=steps, unload=False)
        a, (count, elements) = contact_of(scene).contact_radius, cells
        n = 2 * round(REACH[self.ratio] * count) + 1
        faces = depths(count, DEPTH[self.ratio])
        grid = {"cells": (n, n), "extent": (n * a / count,) * 2, "depths": tuple(float(z) for z in a * faces)}
        return with_mesh(with_grid(scene, **grid), elements)


IN_ONE = f"{SAM}, one step"
MODELS = {SAM: "SAM", FEM: "FEM", IN_ONE: "SAM, one step"}
AT_ONCE, TIGHT = (
    StepScene(15.0, 0.0),
    1e-9,
)  # in one load step, to this tolerance: beyond what SAM iterates in a step


def depths(cells: int, deepest: float) -> np.ndarray:
    """Faces of the layers in elastic contact radii: even down to 1.8, then each thicker than the last, to
    `deepest`.
    """
    even = np.arange(round(3.0 * cells) + 1) / cells
    return even + (deepest - 3.0) / 1.2**2 * np.maximum(even - 1.8, 0.0) ** 2


@dataclass(frozen=True)
class Stepped:
    """cells: ratio -> cells of SAM and FEM in a; results: (scene, model) -> what became of it."""

    cells: Mapping[float, tuple[int, int]]
    results: Mapping[tuple[StepScene, str], Result]


class StepCutting(Case):
    """Both ratios with both models; and one step from nothing, which SAM cuts if it must."""

    def solve(self, context: Context) -> Stepped:
        base, level = context.scene("plastic-perfect"), CELLS[context.level]
        slopes = (0.0, SLOPE) if context.level == "full" else (0.0,)
        results = {}
        for step_scene in (StepScene(ratio, slope) for ratio in level for slope in slopes):
            scene = step_scene.scene(base, level[step_scene.ratio])
            for model in (SAM, FEM):
                found = context.solve(model, scene, f"{step_scene.name}-{model}", demand=False)
                results[step_scene, model] = found
        once = with_keys(AT_ONCE.scene(base, CELLS["quick"][AT_ONCE.ratio], 1), "solver", tolerance=TIGHT)
        results[AT_ONCE, IN_ONE] = context.solve(SAM, once, "one-step", demand=False)
        return Stepped(level, results)

    def measure(self, found: Stepped) -> dict[str, Measured]:
        return values_of(found.results)

    def setup(self, found: Stepped) -> list[tuple[str, str]]:
        laws = f"perfectly plastic or with a slope of {SLOPE:g} E"
        sizes = (f"p₀/σ_y0 = {r:g}: {s} cells (SAM), {f} elements (FEM)" for r, (s, f) in found.cells.items())
        return [
            ("Scene", f"rigid sphere, E/σ_y0 = 210, {laws}, {STEPS} load steps"),
            ("Resolution", ", ".join(f"{size} in the elastic contact radius" for size in sizes)),
        ]

    def tables(self, found: Stepped) -> Iterator[SmallTable]:
        yield SmallTable(
            "What it took, and what was found",
            (
                *(
                    "p₀/σ_y0",
                    "slope/E",
                    "model",
                    "status",
                    "attempts",
                    "cuts",
                    "time [s]",
                    "contact area [µm²]",
                ),
                *("approach [nm]", "largest peeq [%]", "on the axis [%]"),
            ),
            [row_of(*key, result) for key, result in found.results.items()],
        )

    def notes(self, found: Stepped) -> Iterator[str]:
        yield (
            "The largest plastic strain of a perfectly plastic body lies at single points near the edge of "
            "contact and grows with refinement in both models; area, approach and the strain on the axis are "
            "what the models are compared by. SAM takes each of the 15 steps without a cut; it cuts where "
            "the tolerance asks for more iterations than a step may take."
        )

    def figures(self, found: Stepped) -> Iterator[Plot]:
        drawn = {
            rf"$p_0$ = {p.name.partition('-')[0]} $\sigma_y$, {MODELS[m]}": curves_of(r)
            for (p, m), r in found.results.items()
            if p.slope == 0.0
        }
        yield Plot(
            histories(drawn),
            "residuals",
            "Attempts at the load steps",
            "Residual curves over the iterations; discarded attempts in another colour",
            "Blue: accepted, the later the darker; red: given up, and the way to the load halved; dotted: "
            "where an attempt may stop.",
        )


def row_of(step_scene: StepScene, model: str, result: Result) -> tuple[str, ...]:
    """A row of the table."""
    q = result.quantities
    return (
        f"{step_scene.ratio:g}",
        f"{step_scene.slope:g}",
        model,
        str(result.status),
        f"{len(curves_of(result))}",
        f"{result.cost['step_cuts']}",
        f"{result.cost['cpu_s']:.1f}",
        f"{1e12 * q['contact_area_m2']:.1f}",
        f"{1e9 * q['approach_m']:.0f}",
        f"{1e2 * q['peeq_max']:.2f}",
        f"{1e2 * on_axis(result):.2f}",
    )


def on_axis(result: Result) -> float:
    """Largest plastic strain under the apex."""
    return float(np.max(peak_rows(result, "axis")["peeq"]))


def _apart(measure: Callable[[Result], float], sam: Result, fem: Result) -> float:
    """Relative difference of a measure; not a number where a peak was not reached."""
    return math.nan if sam.last_fitting or fem.last_fitting else abs(measure(sam) / measure(fem) - 1.0)


def values_of(results: Mapping[tuple[StepScene, str], Result]) -> dict[str, Measured]:
    """The gates: solves that did not finish, cuts of FEM, and area and approach against the other model."""
    pairs = {
        step_scene: (results[step_scene, SAM], results[step_scene, FEM])
        for step_scene, model in results
        if model == SAM
    }
    measures = {
        "area": lambda result: result.quantities["contact_area_m2"],
        "approach": lambda result: result.quantities["approach_m"],
        "axis": on_axis,
    }
    apart = {
        name: float(np.max([_apart(measure, *pair) for pair in pairs.values()]))
        for name, measure in measures.items()
    }
    loads = [
        math.nan
        if result.last_fitting
        else result.quantities["force_N"] / result.tables["history"]["force_N"][-1] - 1.0
        for result in results.values()
    ]
    return {
        "unfinished": Measured(sum(not result.converged for result in results.values()), 0),
        "fem-cuts": Measured(max(fem.cost["step_cuts"] for _, fem in pairs.values())),
        "sam-cuts": Measured(
            max(result.cost["step_cuts"] for (_, model), result in results.items() if model in (SAM, IN_ONE))
        ),
        "load": Measured(float(np.abs(loads).max())),
        **{name: Measured(value) for name, value in apart.items()},
    }


CASES = (StepCutting("step-cutting"),)
