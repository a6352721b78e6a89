# SPDX-License-Identifier: MIT
"""Observed order of both models on the rigid sphere of case hertz-sphere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sam.scene import Scene
from verification.figures.profiles import convergence
from verification.reference.convergence import Order, fit_order
from verification.runs.models import FEM, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_grid, with_mesh
from verification.suite.cases.hertz import contact_of, fem_values, sam_values
from verification.suite.gates import Measured, error_of
from verification.text.console import number

GRIDS = {"quick": (33, 65, 129, 257), "full": (33, 65, 129, 257, 513)}
MESHES = {"quick": (8, 16, 32), "full": (8, 16, 32, 64)}
SAM_ERRORS = {"sam-p-max": "relative", "sam-approach": "relative", "sam-pressure": "relative_l2"}
FEM_ERRORS = {"fem-approach": "relative", "fem-pressure": "relative_l2"}
LABELS = {"p-max": "largest pressure", "approach": "approach", "pressure": "pressure, L2"}
NOT_FITTED = ("fem-approach",)
"""Its error is that of the outer boundary (a box of 10 a), which no refinement of the contact changes."""

Errors = Mapping[str, np.ndarray]


def run(context: Context) -> Outcome:
    """Errors against Hertz over a ladder of grids and meshes, and the order fitted to them."""
    base = context.scene("hertz-sphere")
    scene = base.model_copy(update={"loading": base.loading.model_copy(update={"steps": 1, "unload": False})})
    h_sam, sam = sam_errors(context, scene)
    h_fem, fem = fem_errors(context, scene)
    orders = {
        name: fit_order(h_sam if name in sam else h_fem, e)
        for name, e in (sam | fem).items()
        if name not in NOT_FITTED
    }
    outcome = Outcome({f"{context.case}.{name}": Measured(order.order) for name, order in orders.items()})
    outcome.setup = [
        (
            "Scene",
            f"hertz-sphere at peak load in one step; a = {contact_of(scene).contact_radius * 1e6:.4f} µm",
        ),
        (
            "SAM",
            f"{', '.join(map(str, GRIDS[context.level]))} cells a side over 4a, all odd: apex on a cell centre",
        ),
        ("FEM", f"{', '.join(map(str, MESHES[context.level]))} elements in a, box {scene.fem.box:g} a"),
    ]
    outcome.tables = [table("SAM", h_sam, sam, orders), table("FEM", h_fem, fem, orders)]
    outcome.notes.append(
        "The approach of FEM is listed without an order: what is left of its error on the finer meshes is that of the "
        "displacements prescribed on the outer boundary, which shrinks with the box and not with the elements."
    )
    curves = {"SAM": (h_sam, sam), "FEM (8-node elements)": (h_fem, fem)}
    outcome.figures.append(draw(context, curves, orders))
    return outcome


def sam_errors(context: Context, scene: Scene) -> tuple[np.ndarray, Errors]:
    """h/a and the errors on each grid; stresses at two depths only, as none is looked at."""
    exact, sizes = contact_of(scene), GRIDS[context.level]
    found = []
    for n in sizes:
        finer = with_grid(scene, cells=(n, n), depths=(0.0, exact.contact_radius))
        found.append(sam_values(context.solve(SAM, finer, f"sam-{n}"), exact, scene))
    h = scene.grid.extent[0] / np.array(sizes) / exact.contact_radius
    return h, errors(SAM_ERRORS, found)


def fem_errors(context: Context, scene: Scene) -> tuple[np.ndarray, Errors]:
    """h/a and the errors on each mesh."""
    exact, sizes = contact_of(scene), MESHES[context.level]
    found = [fem_values(context.solve(FEM, with_mesh(scene, n), f"fem-{n}"), exact, scene) for n in sizes]
    return 1.0 / np.array(sizes), errors(FEM_ERRORS, found)


def errors(metrics: Mapping[str, str], found: Sequence[Mapping[str, Measured]]) -> Errors:
    return {
        name: np.array([error_of(metric, values[name]) for values in found])
        for name, metric in metrics.items()
    }


def label(name: str) -> str:
    return LABELS[name[4:]]


def table(model: str, h: np.ndarray, found: Errors, orders: Mapping[str, Order]) -> SmallTable:
    """One row a grid, the fitted orders in the last."""
    rows = [[f"a/{1.0 / h[k]:.4g}", *(number(e[k], 3) for e in found.values())] for k in range(h.size)]
    fitted = [f"{orders[name].order:.2f}" if name in orders else "not fitted" for name in found]
    columns = ["cell size", *(label(name) for name in found)]
    return SmallTable(
        f"Relative errors of {model} against the closed form", columns, [*rows, ["observed order", *fitted]]
    )


def draw(context: Context, curves: Mapping[str, tuple[np.ndarray, Errors]], orders: Mapping[str, Order]):
    panels = {
        title: {label(name): (h, e, orders.get(name)) for name, e in found.items()}
        for title, (h, found) in curves.items()
    }
    fits = ", ".join(f"{name[:3].upper()} {label(name)} {order.order:.2f}" for name, order in orders.items())
    return context.save(
        convergence(panels),
        "orders",
        "Error against cell size",
        f"Log-log plot of the errors against the cell size with fitted straight lines. Observed orders: {fits}.",
        f"Lines: least-squares fits error ~ hᵐ through all points; observed orders: {fits}.",
    )


CASES = (
    Case(
        "convergence",
        "Convergence on the rigid sphere",
        "With what order do the errors of both models fall with the cell size?",
        run,
        equations=(
            ("Fit", "log(error) = m log(h) + c, least squares through all grids", "m is the observed order"),
            (
                "Expected, pressure in L2",
                "m = 1",
                "square-root edge of the pressure: errors of size √h on a ring of width h",
            ),
            (
                "Expected, approach and largest pressure of SAM",
                "m ≈ 2",
                "uniform pressure on each cell, and the load given",
            ),
        ),
    ),
)
