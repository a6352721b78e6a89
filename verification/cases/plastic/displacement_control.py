# SPDX-License-Identifier: MIT
"""The approach is given and the force is found, in both models."""

from collections.abc import Iterator
from typing import Any

from verification.cases.case import FEM, SAM, Context, with_grid, with_loading, with_mesh
from verification.references import modulus_of

ELASTIC = 0.3e-6  # m, on the sphere of hertz-sphere: 0.65 N make 0.35 um
PLASTIC = 0.15e-6  # m, on the body of plastic-linear: p0 of Hertz would be 5 times its yield stress
CELLS = {"cells": (37, 37), "extent": (18e-6, 18e-6), "layers": 30, "depth": 12e-6}
ONE_STEP = 0.2  # N: force control in one step, whose approach is then given


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """The force that an approach takes, in both models."""
    given = with_loading(context.scene("hertz-sphere"), force=None, approach=ELASTIC, steps=1, unload=False)
    hertz = 4.0 / 3.0 * modulus_of(given) * given.counterbody.radius**0.5 * ELASTIC**1.5
    body = with_mesh(with_grid(context.scene("plastic-linear"), **CELLS), 12)
    plastic = with_loading(body, force=None, approach=PLASTIC, steps=5)
    results = {}
    for model, name in ((SAM, "sam"), (FEM, "fem")):
        force = context.solve(model, given, f"elastic-{name}").quantities["force_N"]
        yield {"sweep": "elastic", "model": name, "force": force, "force expected": hertz}
        results[model] = context.solve(model, plastic, f"plastic-{name}").quantities
    sam, fem = results.values()
    row = {"force": sam["force_N"], "force expected": fem["force_N"], "residual": sam["residual_uz_center_m"]}
    yield {"sweep": "plastic", "model": "sam/fem", **row, "residual expected": fem["residual_uz_center_m"]}
    in_one = with_loading(body, force=ONE_STEP, steps=1, unload=False)
    approach = context.solve(SAM, in_one, "force-sam").quantities["approach_m"]
    force = context.solve(SAM, with_loading(in_one, force=None, approach=approach), "returned-sam").quantities
    yield {"sweep": "returned", "model": "sam", "force": force["force_N"], "force expected": ONE_STEP}
