# SPDX-License-Identifier: MIT
"""Observed order of SAM on the coated sphere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import Scene
from verification.cases.case import SAM, Case, Context, Plot, SmallTable, with_grid
from verification.cases.coated.coated_sphere import (
    QUANTITIES,
    QUICK,
    Answer,
    answer_of,
    coated_scene,
    errors,
    resolved_grid,
)
from verification.figures.profiles import convergence
from verification.reference.convergence import Order, fit_order

FILM = QUICK[1]
"""(E1/E2, thickness over the contact radius without film, counter-body)."""
REFINED = (12, 24, 48, 96)
"""Cells in the contact radius; the order is observed on all but the coarsest."""
SIZES = 1.0 / np.array(REFINED)
"""Over the contact radius."""
FITTED = ("center", "approach", "pressure")


@dataclass(frozen=True)
class FilmErrors:
    """series: quantity -> errors of SAM on the grids REFINED."""

    series: Mapping[str, np.ndarray]

    @cached_property
    def orders(self) -> dict[str, Order]:
        """Of all but the coarsest grid."""
        return {name: fit_order(SIZES[1:], values[1:]) for name, values in self.series.items()}


class CoatedConvergence(Case):
    """Errors of SAM on finer and finer cells under one film, and their order."""

    def solve(self, context: Context) -> FilmErrors:
        scene = coated_scene(context.scene("coated-sphere"), *FILM)
        answer = answer_of(scene)
        scenes = {n: coarse_depths(resolved_grid(scene, answer.contact, n), answer) for n in REFINED}
        found = [errors(context.solve(SAM, each, f"sam-{n}"), answer) for n, each in scenes.items()]
        return FilmErrors({name: np.array([each[name] for each in found]) for name in FITTED})

    def measure(self, found: FilmErrors) -> dict[str, float]:
        return {name: order.order for name, order in found.orders.items()}

    def setup(self, found: FilmErrors) -> list[tuple[str, str]]:
        return [("Film", "E₁/E₂ = {:.3g}, h/a₀ = {:g}, {} counter-body".format(*FILM))]

    def tables(self, found: FilmErrors) -> Iterator[SmallTable]:
        series = found.series.values()
        rows = [(f"a/{n}", *(f"{values[k]:.2e}" for values in series)) for k, n in enumerate(REFINED)]
        rows.append(("observed order", *(f"{order.order:.2f}" for order in found.orders.values())))
        yield SmallTable(
            "Relative errors of SAM", ("cell size", *(QUANTITIES[name] for name in found.series)), rows
        )

    def figures(self, found: FilmErrors) -> Iterator[Plot]:
        panel = {QUANTITIES[n]: (SIZES, values, found.orders[n]) for n, values in found.series.items()}
        yield Plot(
            convergence({"SAM, coated sphere": panel}),
            "orders",
            "Error against cell size with a film",
            "Log-log plot of the errors of SAM against the cell size with fitted straight lines.",
            "Against the spectral solution. Fitted without the coarsest grid, on which two parts of the "
            "error of the approach, from the edge and from the cells inside, nearly cancel.",
        )


def coarse_depths(scene: Scene, answer: Answer) -> Scene:
    """A few depths: nothing is looked at there."""
    h = scene.body.coating.thickness
    return with_grid(scene, depths=(0.0, h, h + 0.5 * answer.contact.contact_radius))


CASES = (CoatedConvergence("coated-convergence"),)
