# SPDX-License-Identifier: MIT
"""Load steps and grids of both models refined on spheres pressed beyond yield; the limits compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from sam.scene import Result, Scene
from verification.compare.comparison import compare_scene
from verification.figures.refinement import refinement
from verification.reference.convergence import Limit, extrapolate
from verification.runs.models import FEM, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.plastic import at_ratio
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

NAMES = {SAM: "SAM", FEM: "FEM"}
NORMS = ("peeq on the axis", "peeq in the plane y = 0")
Points = tuple[np.ndarray, np.ndarray]
"""1/steps or 1/cells in the contact radius, and the largest plastic strain."""


@dataclass(frozen=True)
class Ladder:
    """What is refined: load steps at the resolution `at`, and both grids, rung by rung, at `steps_of_grids` load steps."""

    steps: tuple[int, ...]
    at: Resolution
    grids: tuple[Resolution, ...]
    steps_of_grids: int


# Even numbers of cells: 0.5 a, near which the maximum lies, is then always a face. With odd ones among them the place of the
# maximum in its layer, not the size of the cells, decides the last 0.3 %.
LADDERS = {
    "quick": Ladder(
        (5, 10, 20), Resolution(8, 8), (Resolution(8, 8), Resolution(10, 12), Resolution(14, 16)), 5
    ),
    "full": Ladder(
        (5, 10, 20, 40),
        Resolution(10, 16),
        (Resolution(8, 8), Resolution(10, 12), Resolution(14, 16), Resolution(20, 32)),
        10,
    ),
}


def run(context: Context, scene_name: str, ratio: float) -> Outcome:
    """Largest plastic strain over load steps and over grids, both models, extrapolated."""
    ladder = LADDERS[context.level]
    scene = with_loading(at_ratio(context.scene(scene_name), ratio), unload=False)
    rungs = {model: over_grids(context, model, scene, ladder) for model in NAMES}
    found = {
        "load steps": {model: over_steps(context, model, scene, ladder) for model in NAMES},
        "grid": {model: largest_of(results, model, ladder) for model, results in rungs.items()},
    }
    apart = differences(scene, rungs[SAM], rungs[FEM])
    limits = {axis: {m: extrapolate(*points) for m, points in each.items()} for axis, each in found.items()}
    best = {model: limit_of_both(found["load steps"][model], limits, model, ladder) for model in NAMES}
    outcome = Outcome(
        {
            f"{context.case}.grid-limit": Measured(limits["grid"][SAM].limit, limits["grid"][FEM].limit),
            f"{context.case}.limit": Measured(best[SAM], best[FEM]),
            f"{context.case}.shrinks": Measured(growth(apart)),
        },
        setup(scene, ratio, ladder),
    )
    outcome.tables = [table(axis, found[axis], limits[axis]) for axis in found]
    outcome.tables.append(norms(apart, ladder))
    outcome.figures.append(draw(context, found, limits))
    return outcome


def over_steps(context: Context, model: str, scene: Scene, ladder: Ladder) -> Points:
    """On the grid `ladder.at`."""
    scene = resolved_at(scene, ladder.at)
    values = [largest(context, model, with_loading(scene, steps=n), f"steps-{n}") for n in ladder.steps]
    return 1.0 / np.array(ladder.steps), np.array(values)


def over_grids(context: Context, model: str, scene: Scene, ladder: Ladder) -> list[Result]:
    """With `ladder.steps_of_grids` load steps."""
    scene = with_loading(scene, steps=ladder.steps_of_grids)
    return [
        context.solve(model, resolved_at(scene, resolution), f"{model}-grid-{cells_of(resolution, model)}")
        for resolution in ladder.grids
    ]


def largest_of(results: Sequence[Result], model: str, ladder: Ladder) -> Points:
    cells = np.array([cells_of(resolution, model) for resolution in ladder.grids])
    return 1.0 / cells, np.array([result.quantities["peeq_max"] for result in results])


def largest(context: Context, model: str, scene: Scene, label: str) -> float:
    return context.solve(model, scene, f"{model}-{label}").quantities["peeq_max"]


def cells_of(resolution: Resolution, model: str) -> int:
    return resolution.sam if model == SAM else resolution.fem


def limit_of_both(
    steps: Points, limits: Mapping[str, Mapping[str, Limit]], model: str, ladder: Ladder
) -> float:
    """Both refined: the limit of the grids, times what infinitely many load steps change on one grid."""
    used = steps[1][ladder.steps.index(ladder.steps_of_grids)]
    return limits["grid"][model].limit * limits["load steps"][model].limit / used


def differences(scene: Scene, sam: Sequence[Result], fem: Sequence[Result]) -> np.ndarray:
    """L2 differences of the plastic strain on the axis and in y = 0 on each rung, (rungs, 2).

    Norms, as the largest values of both models may cross on the way.
    """
    rungs = []
    for pair in zip(sam, fem, strict=True):
        rows = {row.quantity: row.difference for row in compare_scene(scene, *pair)}
        rungs.append([rows[name] for name in NORMS])
    return np.array(rungs)


def growth(difference: np.ndarray) -> float:
    """The largest ratio of the differences on successive rungs, (rungs, n): below 1 all of them shrink every time."""
    return float(np.max(difference[1:] / difference[:-1]))


def setup(scene: Scene, ratio: float, ladder: Ladder) -> list[tuple[str, str]]:
    rungs = ", ".join(f"{r.sam} and {r.fem}" for r in ladder.grids)
    return [
        ("Scene", f"{scene.title}, p₀/σ_y0 = {ratio:g}, {scene.loading.force:.5g} N, loading only"),
        (
            "Load steps",
            f"{', '.join(map(str, ladder.steps))} with {ladder.at.sam} cells (SAM) and {ladder.at.fem} elements (FEM) in a",
        ),
        ("Grids", f"{rungs} cells (SAM) and elements (FEM) in a, {ladder.steps_of_grids} load steps"),
    ]


def table(axis: str, found: Mapping[str, Points], limits: Mapping[str, Limit]) -> SmallTable:
    """One row a rung; the limits, the distance of the finest values from them and the observed orders in the last three."""
    (h_sam, sam), (h_fem, fem) = found[SAM], found[FEM]
    rows = [
        (_rung(axis, hs, hf), f"{1e2 * a:.4f}", f"{1e2 * b:.4f}", f"{1e2 * (a / b - 1.0):+.2f} %")
        for hs, hf, a, b in zip(h_sam, h_fem, sam, fem, strict=True)
    ]
    ends = [limits[model].limit for model in NAMES]
    orders = [f"{limits[model].order:.2f}" if limits[model].observed else "none" for model in NAMES]
    rows.append(
        ("extrapolated", *(f"{1e2 * end:.4f}" for end in ends), f"{1e2 * (ends[0] / ends[1] - 1.0):+.2f} %")
    )
    left = [f"{1e2 * limits[model].uncertainty:.2f} %" for model in NAMES]
    rows.append(("finest from extrapolated", *left, ""))
    rows.append(("observed order", *orders, ""))
    return SmallTable(f"Largest plastic strain [%] over {axis}", (axis, "SAM", "FEM", "difference"), rows)


def norms(apart: np.ndarray, ladder: Ladder) -> SmallTable:
    rows = [
        (_rung("grid", 1.0 / rung.sam, 1.0 / rung.fem), *(f"{1e2 * value:.2f} %" for value in values))
        for rung, values in zip(ladder.grids, apart, strict=True)
    ]
    return SmallTable(
        "Plastic strain, SAM against FEM in L2", ("grid", "on the axis", "in the plane y = 0"), rows
    )


def _rung(axis: str, h_sam: float, h_fem: float) -> str:
    return f"{1.0 / h_sam:.0f}" if axis == "load steps" else f"a/{1.0 / h_sam:.0f} and a/{1.0 / h_fem:.0f}"


def draw(context: Context, found, limits):
    panels = {axis: {NAMES[m]: (*found[axis][m], limits[axis][m]) for m in NAMES} for axis in found}
    ends = {axis: limits[axis][SAM].limit / limits[axis][FEM].limit - 1.0 for axis in limits}
    words = ", ".join(f"{axis} {1e2 * end:+.2f} %" for axis, end in ends.items())
    return context.save(
        refinement(
            panels,
            {"load steps": "1 / load steps", "grid": "cell or element size / a"},
            "largest plastic strain [%]",
        ),
        "refinement",
        "Largest plastic strain under refinement",
        f"Largest plastic strain of SAM and FEM over the size of load steps and cells with fitted power laws that meet at "
        f"zero; difference of the extrapolated values: {words}.",
        f"Lines: limit + c hᵐ fitted to all points. SAM minus FEM, extrapolated: {words}.",
    )


CASES = tuple(
    Case(
        name,
        title,
        "Do both models converge to one largest plastic strain when load steps and grids are refined?",
        partial(run, scene_name=scene, ratio=ratio),
        (
            (
                "Extrapolation",
                "ε(h) = ε₀ + c hᵐ, m observed",
                "Richardson (1911); Roache, Verification and Validation in Computational Science and Engineering (1998)",
            ),
            ("Expected over load steps", "m ≈ 1", "backward Euler is first order"),
        ),
        levels,
    )
    for name, title, scene, ratio, levels in (
        (
            "plastic-convergence",
            "Convergence beyond yield, Swift steel",
            "plastic-swift-rigid",
            4.0,
            ("quick", "full"),
        ),
        (
            "plastic-convergence-perfect",
            "Convergence beyond yield, perfect plasticity",
            "plastic-perfect",
            3.0,
            ("full",),
        ),
    )
)
