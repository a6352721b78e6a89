# SPDX-License-Identifier: MIT
"""The groove and the strain of a sphere that moves, SAM against the three-dimensional finite elements, both
on two grids and refined.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Result
from verification.figures.moving import grooves
from verification.suite.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_keys,
)
from verification.suite.cases.moving_sphere_scenes import Setting, radius

CELLS, ELEMENTS = (8, 12), (6, 8)  # in the radius; 4 elements are not yet of second order
LENGTH, BOX = 3.0, 12.0  # of the track and of the finite elements, radii; 6 lowers the groove by 0.9 %
EQUATIONS = (
    (
        "Refined",
        "v = (n₂² v₂ − n₁² v₁)/(n₂² − n₁²)",
        "Richardson: errors of second order in the size of cells and elements",
    ),
)
WITHIN = 1.0  # of the compared part of the track, half its length in radii


@dataclass(frozen=True)
class Grooves:
    """Results by cells, and by elements, in the radius a in m."""

    sam: Mapping[int, Result]
    fem: Mapping[int, Result]
    radius: float


def refined(counts: Sequence[int], values: Sequence[float]) -> float:
    """Limit of two values of second order in 1/count."""
    weights = np.square(counts) * [-1.0, 1.0]
    return float(weights @ np.asarray(values) / weights.sum())


def largest_strain(result: Result) -> float:
    """After the pass."""
    return float(result.quantities["peeq_max"])


def groove_at(result: Result, place: float) -> float:
    """Depth of the groove in m at a place along the track."""
    track = result.tables["track"]
    return float(np.interp(place, track["x_m"], track["uz_m"]))


def deepest(result: Result) -> float:
    """Largest depth of the groove in m."""
    return float(result.quantities["groove_deepest_m"])


class MovingSpatial(Case):
    """One pass in steps of a quarter of the radius, both models from the same scene."""

    def solve(self, context: Context) -> Grooves:
        scene = context.scene("moving-sphere")
        sam = {n: context.solve(SAM, Setting(cells=n, length=LENGTH).of(scene), f"sam-{n}") for n in CELLS}
        moved = Setting(cells=CELLS[0], length=LENGTH).of(scene)
        fem = {
            n: context.solve(FEM_3D, with_keys(moved, "fem", cells_per_radius=n, box=BOX), f"spatial-{n}")
            for n in ELEMENTS
        }
        return Grooves(sam, fem, radius(scene))

    def measure(self, found: Grooves) -> dict[str, Measured | float]:
        places = np.linspace(-WITHIN, WITHIN, 81) * found.radius
        on_sam, on_fem = (
            np.array([groove_at(each, place) for place in places])
            for each in (found.sam[CELLS[-1]], found.fem[ELEMENTS[-1]])
        )

        def limits(value) -> Measured:
            by_sam = refined(CELLS, [value(each) for each in found.sam.values()])
            return Measured(by_sam, refined(ELEMENTS, [value(each) for each in found.fem.values()]))

        return {
            "groove": float(np.abs(on_sam - on_fem).max() / on_fem.max()),
            "groove-refined": limits(lambda each: groove_at(each, 0.0)),
            "deepest-refined": limits(deepest),
            "strain-refined": limits(largest_strain),
        }

    def setup(self, found: Grooves) -> list[tuple[str, str]]:
        return [
            ("Track", f"{LENGTH:g} a in steps of a/4, p₀ = 4 yield stresses, no friction"),
            ("SAM", " and ".join(map(str, CELLS)) + " cells in a"),
            ("Finite elements", " and ".join(map(str, ELEMENTS)) + f" elements in a, box {BOX:g} a"),
        ]

    def tables(self, found: Grooves) -> Iterator[SmallTable]:
        rows = []
        for name, counts, results in (("SAM", CELLS, found.sam), ("finite elements", ELEMENTS, found.fem)):
            values = [
                (groove_at(each, 0.0), deepest(each), largest_strain(each)) for each in results.values()
            ]
            limit = tuple(refined(counts, column) for column in zip(*values, strict=True))
            for count, (middle, most, strain) in zip(
                (*map(str, counts), "refined"), [*values, limit], strict=True
            ):
                scaled = (f"{1e3 * each / found.radius:.3f}" for each in (middle, most))
                rows.append((name, count, *scaled, f"{100 * strain:.3f} %"))
        header = (
            "model",
            "in a",
            "groove in the middle [a/1000]",
            "deepest [a/1000]",
            "largest plastic strain",
        )
        yield SmallTable("Refinement of both models", header, rows)

    def figures(self, found: Grooves) -> Iterator[Plot]:
        lines = {}
        for name, result in (
            (f"SAM, {CELLS[-1]} cells in a", found.sam[CELLS[-1]]),
            (f"finite elements, {ELEMENTS[-1]} in a", found.fem[ELEMENTS[-1]]),
        ):
            x, depth = (np.asarray(result.tables["track"][column]) for column in ("x_m", "uz_m"))
            near = np.abs(x) <= (LENGTH / 2 + 2.0) * found.radius
            lines[name] = x[near] / found.radius + LENGTH / 2, depth[near] / found.radius
        yield Plot(
            grooves(lines, LENGTH),
            "groove",
            "Groove of one pass in both models",
            "Depth of the unloaded surface over the distance from the start, both models",
            "Unloaded surface along the track; a is the radius of Hertz.",
        )


CASES = (
    MovingSpatial(
        "moving-spatial",
        "A sphere that moves, SAM against three-dimensional finite elements",
        "Do both models leave the same groove and the same strain?",
        EQUATIONS,
        ("full",),
    ),
)
