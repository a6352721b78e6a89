# SPDX-License-Identifier: MIT
"""Observed order of SAM on the coated sphere."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sam.scene import Scene
from verification.figures.profiles import convergence
from verification.reference.convergence import Order, fit_order
from verification.runs.models import SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_grid
from verification.suite.cases.coated_sphere import (
    EQUATIONS,
    QUANTITIES,
    QUICK,
    Answer,
    answer_of,
    coated_scene,
    errors,
    resolved_grid,
)
from verification.suite.gates import Measured

FILM = QUICK[1]
"""(E1/E2, thickness over the contact radius without film, counter-body)."""
REFINED = (12, 24, 48, 96)
"""Cells in the contact radius; the order is observed on all but the coarsest."""
FITTED = ("center", "approach", "pressure")


def run(context: Context) -> Outcome:
    """Errors of SAM on finer and finer cells under one film, and their order."""
    scene = coated_scene(context.scene("coated-sphere"), *FILM)
    answer = answer_of(scene)
    found = [
        errors(
            context.solve(SAM, coarse_depths(resolved_grid(scene, answer.contact, n), answer), f"sam-{n}"),
            answer,
        )
        for n in REFINED
    ]
    h = 1.0 / np.array(REFINED)
    series = {name: np.array([each[name] for each in found]) for name in FITTED}
    orders = {name: fit_order(h[1:], values[1:]) for name, values in series.items()}
    outcome = Outcome({f"{context.case}.{name}": Measured(order.order) for name, order in orders.items()})
    outcome.setup = [("Film", "E₁/E₂ = {:.3g}, h/a₀ = {:g}, {} counter-body".format(*FILM))]
    outcome.tables = [convergence_table(series, orders)]
    panel = {QUANTITIES[name]: (h, values, orders[name]) for name, values in series.items()}
    outcome.figures.append(
        context.save(
            convergence({"SAM, coated sphere": panel}),
            "orders",
            "Error against cell size with a film",
            "Log-log plot of the errors of SAM against the cell size with fitted straight lines.",
            "Against the spectral solution. Fitted without the coarsest grid, on which two parts of the error of the approach, "
            "from the edge and from the cells inside, nearly cancel.",
        )
    )
    return outcome


def coarse_depths(scene: Scene, answer: Answer) -> Scene:
    """A few depths: nothing is looked at there."""
    h = scene.body.coating.thickness
    return with_grid(scene, depths=(0.0, h, h + 0.5 * answer.contact.contact_radius))


def convergence_table(series: Mapping[str, np.ndarray], orders: Mapping[str, Order]) -> SmallTable:
    rows = [(f"a/{n}", *(f"{values[k]:.2e}" for values in series.values())) for k, n in enumerate(REFINED)]
    rows.append(("observed order", *(f"{order.order:.2f}" for order in orders.values())))
    return SmallTable("Relative errors of SAM", ("cell size", *(QUANTITIES[name] for name in series)), rows)


CASES = (
    Case(
        "coated-convergence",
        "Convergence of SAM on the coated sphere",
        "Does a film leave the order of convergence as it is?",
        run,
        EQUATIONS[:2],
        ("full",),
    ),
)
