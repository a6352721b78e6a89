# SPDX-License-Identifier: MIT
"""Load steps and grids of both models refined on spheres pressed beyond yield; the limits compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

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
    off_text,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.compare.comparison import compare_scene
from verification.figures.refinement import refinement
from verification.reference.convergence import Limit, extrapolate

NAMES = {SAM: "SAM", FEM: "FEM"}
STEPS, GRID = "load steps", "grid"
NORMS = ("peeq on the axis", "peeq in the plane y = 0")
Points = tuple[np.ndarray, np.ndarray]
"""1/steps or 1/cells in the contact radius, and the largest plastic strain."""


@dataclass(frozen=True)
class Rungs:
    """What is refined: load steps at the resolution `at`, and both grids, rung by rung, at `steps_of_grids`
    load steps.
    """

    steps: tuple[int, ...]
    at: Resolution
    grids: tuple[Resolution, ...]
    steps_of_grids: int


# Even numbers of cells: 0.5 a, near which the maximum lies, is then always a face. With odd ones among them
# the place of the maximum in its layer, not the size of the cells, decides the last 0.3 %.
LADDERS = {
    "quick": Rungs(
        (5, 10, 20), Resolution(8, 8), (Resolution(8, 8), Resolution(10, 12), Resolution(14, 16)), 5
    ),
    "full": Rungs(
        (5, 10, 20, 40),
        Resolution(10, 16),
        (Resolution(8, 8), Resolution(10, 12), Resolution(14, 16), Resolution(20, 32)),
        10,
    ),
}


@dataclass(frozen=True)
class PlasticRefinement:
    """Both models refined. points: what is refined -> model -> points; apart: see `differences`."""

    scene: Scene
    ladder: Rungs
    points: Mapping[str, Mapping[str, Points]]
    apart: np.ndarray

    @cached_property
    def limits(self) -> dict[str, dict[str, Limit]]:
        """What is refined -> model -> extrapolation."""
        return {axis: {m: extrapolate(*points) for m, points in e.items()} for axis, e in self.points.items()}

    def limit_of_both(self, model: str) -> float:
        """The limit of the grids, times what infinitely many load steps change on one grid."""
        _, strains = self.points[STEPS][model]
        used = strains[self.ladder.steps.index(self.ladder.steps_of_grids)]
        return self.limits[GRID][model].limit * self.limits[STEPS][model].limit / used


@dataclass(frozen=True)
class PlasticConvergence(Case):
    """Largest plastic strain over load steps and over grids, both models, extrapolated. scene: name of its
    file.
    """

    scene: str = ""
    ratio: float = 0.0

    def solve(self, context: Context) -> PlasticRefinement:
        ladder = LADDERS[context.level]
        scene = with_loading(at_ratio(context.scene(self.scene), self.ratio), unload=False)
        rungs = {model: over_grids(context, model, scene, ladder) for model in NAMES}
        points = {
            STEPS: {model: over_steps(context, model, scene, ladder) for model in NAMES},
            GRID: {model: largest_of(results, model, ladder) for model, results in rungs.items()},
        }
        return PlasticRefinement(scene, ladder, points, differences(scene, rungs[SAM], rungs[FEM]))

    def measure(self, found: PlasticRefinement) -> dict[str, Measured | float]:
        return {
            "grid-limit": Measured(*(found.limits[GRID][model].limit for model in NAMES)),
            "limit": Measured(*(found.limit_of_both(model) for model in NAMES)),
            "shrinks": growth(found.apart),
        }

    def setup(self, found: PlasticRefinement) -> list[tuple[str, str]]:
        scene, ladder = found.scene, found.ladder
        steps, at = ", ".join(map(str, ladder.steps)), ladder.at
        rungs = ", ".join(f"{r.sam} and {r.fem}" for r in ladder.grids)
        return [
            ("Scene", f"{scene.title}, p₀/σ_y0 = {self.ratio:g}, {scene.loading.force:.5g} N, loading only"),
            ("Load steps", f"{steps} with {at.sam} cells (SAM) and {at.fem} elements (FEM) in a"),
            ("Grids", f"{rungs} cells (SAM) and elements (FEM) in a, {ladder.steps_of_grids} load steps"),
        ]

    def tables(self, found: PlasticRefinement) -> list[SmallTable]:
        return [
            *(table(axis, found.points[axis], found.limits[axis]) for axis in found.points),
            norms(found.apart, found.ladder),
        ]

    def figures(self, found: PlasticRefinement) -> Iterator[Plot]:
        panels = {
            axis: {name: (*points[model], found.limits[axis][model]) for model, name in NAMES.items()}
            for axis, points in found.points.items()
        }
        ends = {axis: limits[SAM].limit / limits[FEM].limit for axis, limits in found.limits.items()}
        words = ", ".join(f"{axis} {1e2 * (end - 1.0):+.2f} %" for axis, end in ends.items())
        labels = {STEPS: "1 / load steps", GRID: "cell or element size / a"}
        yield Plot(
            refinement(panels, labels, "largest plastic strain [%]"),
            "refinement",
            "Largest plastic strain under refinement",
            "Largest plastic strain of SAM and FEM over the size of load steps and cells with fitted power "
            f"laws that meet at zero; difference of the extrapolated values: {words}.",
            f"Lines: limit + c hᵐ fitted to all points. SAM minus FEM, extrapolated: {words}.",
        )


def over_steps(context: Context, model: str, scene: Scene, ladder: Rungs) -> Points:
    """On the grid `ladder.at`."""
    scene = resolved_at(scene, ladder.at)
    results = (context.solve(model, with_loading(scene, steps=n), f"{model}-steps-{n}") for n in ladder.steps)
    return 1.0 / np.array(ladder.steps), np.array([result.quantities["peeq_max"] for result in results])


def over_grids(context: Context, model: str, scene: Scene, ladder: Rungs) -> list[Result]:
    """With `ladder.steps_of_grids` load steps."""
    scene = with_loading(scene, steps=ladder.steps_of_grids)
    return [
        context.solve(model, resolved_at(scene, resolution), f"{model}-grid-{cells_of(resolution, model)}")
        for resolution in ladder.grids
    ]


def largest_of(results: Sequence[Result], model: str, ladder: Rungs) -> Points:
    """The points of results over the grids of a ladder."""
    cells = np.array([cells_of(resolution, model) for resolution in ladder.grids])
    return 1.0 / cells, np.array([result.quantities["peeq_max"] for result in results])


def cells_of(resolution: Resolution, model: str) -> int:
    """Cells or elements in the contact radius."""
    return resolution.sam if model == SAM else resolution.fem


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
    """The largest ratio of the differences on successive rungs, (rungs, n): below 1 all of them shrink every
    time.
    """
    return float(np.max(difference[1:] / difference[:-1]))


def table(axis: str, found: Mapping[str, Points], limits: Mapping[str, Limit]) -> SmallTable:
    """One row a rung; the limits, the distance of the finest values from them and the observed orders in the
    last three.
    """
    (h_sam, sam), (h_fem, fem) = found[SAM], found[FEM]
    rows = [
        (_rung(axis, hs, hf), f"{1e2 * a:.4f}", f"{1e2 * b:.4f}", off_text(a, b))
        for hs, hf, a, b in zip(h_sam, h_fem, sam, fem, strict=True)
    ]
    ends = [limits[model].limit for model in NAMES]
    orders = [f"{limits[model].order:.2f}" if limits[model].observed else "none" for model in NAMES]
    rows.append(("extrapolated", *(f"{1e2 * end:.4f}" for end in ends), off_text(*ends)))
    left = [f"{1e2 * limits[model].uncertainty:.2f} %" for model in NAMES]
    rows.append(("finest from extrapolated", *left, ""))
    rows.append(("observed order", *orders, ""))
    return SmallTable(f"Largest plastic strain [%] over {axis}", (axis, "SAM", "FEM", "difference"), rows)


def norms(apart: np.ndarray, ladder: Rungs) -> SmallTable:
    """The distance of the models on each rung."""
    return SmallTable(
        "Plastic strain, SAM against FEM in L2",
        ("grid", "on the axis", "in the plane y = 0"),
        [
            (_rung("grid", 1.0 / rung.sam, 1.0 / rung.fem), *(f"{1e2 * value:.2f} %" for value in values))
            for rung, values in zip(ladder.grids, apart, strict=True)
        ],
    )


def _rung(axis: str, h_sam: float, h_fem: float) -> str:
    return f"{1.0 / h_sam:.0f}" if axis == "load steps" else f"a/{1.0 / h_sam:.0f} and a/{1.0 / h_fem:.0f}"


CASES = tuple(
    PlasticConvergence(name, scene=scene, ratio=ratio)
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
