# SPDX-License-Identifier: MIT
"""Extremes of a sphere that grows inside the body."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from verification.robustness.matrix.checks import as_other_model
from verification.robustness.matrix.elastic import both
from verification.robustness.matrix.plastic import residuals_hold, yields
from verification.robustness.matrix.row import TOLERANCE, Deviation, Expectation, Refused, Right, Row, Trial
from verification.robustness.matrix.scenes import scene_with
from verification.runs.models import FEM, FEM_3D, SAM


def rows() -> Iterator[Row]:
    """A sphere that grows inside the body: next to nothing and without end, deep and close to the surface."""
    given = {"prescribed": "misfit-sphere", "radius": 4e-6, "misfit": 0.02, "steps": 1}
    law = {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}
    base = {"counterbody": None, "grid": None, "body.plasticity": law}
    refused = Refused("it has no misfit strain", ["loading.prescribed", "axisymmetric"])
    only_axisymmetric: dict[str, Expectation] = {FEM_3D: refused}
    near = {"peeq_max": 0.1, "mises_max_Pa": 0.02}
    reason = "8 cells and elements in the radius of the sphere"
    both_yield = {
        model: Right("one plastic strain", [as_other_model(twin, near, reason), residuals_hold, yields])
        for model, twin in ((SAM, FEM), (FEM, SAM))
    }
    for name, what, keys, expected, quick in (
        ("deep", "the centre at ten radii", {"depth": 40e-6}, both_yield, True),
        ("close", "the centre at 1.01 radii", {"depth": 4.04e-6}, both_yield, False),
        ("nothing", "misfit 1e-9: nothing yields", {"depth": 6e-6, "misfit": 1e-9}, both(UNSTRAINED), False),
    ):
        changes = base | {"loading": given | keys}
        make = partial(scene_with, changes)
        yield Row(f"misfit-{name}", "misfit", what, make, expected | only_axisymmetric, quick)
    held = {"depth": 6e-6, "misfit": 0.5, "surface": "held"}
    reaches = Refused("the plastic zone reaches the held surface", ["loading.depth"])
    changes = partial(scene_with, base | {"loading": given | held})
    yield Row("misfit-held", "misfit", "misfit 0.5, held", changes, both(reaches) | only_axisymmetric)


def stays_elastic(trial: Trial) -> Iterator[Deviation]:
    """The largest von Mises stress of the elastic sphere, 0.28 E e/(1 - nu) but for the image."""
    body, misfit = trial.scene.body, trial.scene.loading.misfit
    exact = 0.28 * body.young * misfit / (1.0 - body.poisson)
    off = abs(trial.quantities["mises_max_Pa"] / exact - 1.0)
    yield Deviation("largest von Mises stress", off, 0.05, "8 cells in the radius, and the free surface")
    yield Deviation("plastic strain", trial.quantities["peeq_max"], 1e-15, TOLERANCE)


UNSTRAINED = Right("a millionth of the strain of first yield", [stays_elastic])
