# SPDX-License-Identifier: MIT
"""Observed order of both models on the rigid sphere of case hertz-sphere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    number,
    with_grid,
    with_loading,
    with_mesh,
)
from verification.cases.hertz.hertz import fem_values, sam_values
from verification.figures.profiles import convergence
from verification.reference.convergence import Order, fit_order
from verification.references import contact_of
from verification.rows import error_of

GRIDS = {"quick": (33, 65, 129, 257), "full": (33, 65, 129, 257, 513)}
MESHES = {"quick": (8, 16, 32), "full": (8, 16, 32, 64)}
SAM_ERRORS = {"sam-p-max": "relative", "sam-approach": "relative", "sam-pressure": "relative_l2"}
FEM_ERRORS = {"fem-approach": "relative", "fem-pressure": "relative_l2"}
LABELS = {"p-max": "largest pressure", "approach": "approach", "pressure": "pressure, L2"}
NOT_FITTED = ("fem-approach",)
"""Its error is that of the outer boundary (a box of 10 a), which no refinement of the contact changes."""

Errors = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class ErrorLadder:
    """The errors of one model over its grids. h: cell sizes over a, (n,); sizes: as asked for."""

    h: np.ndarray
    errors: Errors
    sizes: Sequence[int]

    @cached_property
    def orders(self) -> dict[str, Order]:
        """Row -> order of its error."""
        return {n: fit_order(self.h, e) for n, e in self.errors.items() if n not in NOT_FITTED}


@dataclass(frozen=True)
class Ladders:
    """Both models refined."""

    scene: Scene
    sam: ErrorLadder
    fem: ErrorLadder

    @property
    def orders(self) -> dict[str, Order]:
        """Row -> order of its error."""
        return self.sam.orders | self.fem.orders


class Convergence(Case):
    """Errors against Hertz over a ladder of grids and meshes, and the order fitted to them."""

    def solve(self, context: Context) -> Ladders:
        scene = with_loading(context.scene("hertz-sphere"), steps=1, unload=False)
        return Ladders(scene, sam_errors(context, scene), fem_errors(context, scene))

    def measure(self, found: Ladders) -> dict[str, float]:
        return {name: order.order for name, order in found.orders.items()}

    def setup(self, found: Ladders) -> list[tuple[str, str]]:
        a = f"{contact_of(found.scene).contact_radius * 1e6:.4f} µm"
        cells, elements = (", ".join(map(str, each.sizes)) for each in (found.sam, found.fem))
        return [
            ("Scene", f"hertz-sphere at peak load in one step; a = {a}"),
            ("SAM", f"{cells} cells a side over 4a, all odd: apex on a cell centre"),
            ("FEM", f"{elements} elements in a, box {found.scene.fem.box:g} a"),
        ]

    def tables(self, found: Ladders) -> list[SmallTable]:
        return [table("SAM", found.sam), table("FEM", found.fem)]

    def notes(self, found: Ladders) -> Iterator[str]:
        yield (
            "The approach of FEM is listed without an order: what is left of its error on the finer meshes "
            "is that of the displacements prescribed on the outer boundary, which shrinks with the box and "
            "not with the elements."
        )

    def figures(self, found: Ladders) -> Iterator[Plot]:
        panels = {
            title: {label(name): (each.h, e, each.orders.get(name)) for name, e in each.errors.items()}
            for title, each in (("SAM", found.sam), ("FEM (8-node elements)", found.fem))
        }
        fits = ", ".join(
            f"{name[:3].upper()} {label(name)} {order.order:.2f}" for name, order in found.orders.items()
        )
        yield Plot(
            convergence(panels),
            "orders",
            "Error against cell size",
            "Log-log plot of the errors against the cell size with fitted straight lines. Observed orders: "
            f"{fits}.",
            f"Lines: least-squares fits error ~ hᵐ through all points; observed orders: {fits}.",
        )


def sam_errors(context: Context, scene: Scene) -> ErrorLadder:
    """Of SAM on each grid; stresses at two depths only, as none is looked at."""
    exact, sizes = contact_of(scene), GRIDS[context.level]
    finer = (with_grid(scene, cells=(n, n), depths=(0.0, exact.contact_radius)) for n in sizes)
    found = [
        sam_values(context.solve(SAM, each, f"sam-{n}"), exact, scene)
        for n, each in zip(sizes, finer, strict=True)
    ]
    h = scene.grid.extent[0] / np.array(sizes) / exact.contact_radius
    return ErrorLadder(h, errors(SAM_ERRORS, found), sizes)


def fem_errors(context: Context, scene: Scene) -> ErrorLadder:
    """Of FEM on each mesh."""
    exact, sizes = contact_of(scene), MESHES[context.level]
    found = [fem_values(context.solve(FEM, with_mesh(scene, n), f"fem-{n}"), exact, scene) for n in sizes]
    return ErrorLadder(1.0 / np.array(sizes), errors(FEM_ERRORS, found), sizes)


def errors(metrics: Mapping[str, str], found: Sequence[Mapping[str, Measured]]) -> Errors:
    """Row -> its error on each grid, (n,)."""
    return {
        name: np.array([error_of(metric, values[name]) for values in found])
        for name, metric in metrics.items()
    }


def label(name: str) -> str:
    """The quantity of a gate, for the reader."""
    return LABELS[name[4:]]


def table(model: str, found: ErrorLadder) -> SmallTable:
    """One row a grid, the fitted orders in the last."""
    rows = [
        [f"a/{1.0 / h:.4g}", *(number(e[k], 3) for e in found.errors.values())] for k, h in enumerate(found.h)
    ]
    fitted = [f"{found.orders[n].order:.2f}" if n in found.orders else "not fitted" for n in found.errors]
    return SmallTable(
        f"Relative errors of {model} against the closed form",
        ["cell size", *(label(name) for name in found.errors)],
        [*rows, ["observed order", *fitted]],
    )


CASES = (Convergence("convergence"),)
