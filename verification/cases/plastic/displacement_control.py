# SPDX-License-Identifier: MIT
"""The approach is given and the force is found: SAM and FEM against Hertz, against each other, and against
force control.
"""

from __future__ import annotations

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_grid,
    with_loading,
    with_mesh,
)
from verification.references import modulus_of

ELASTIC = 0.3e-6  # m, on the sphere of hertz-sphere: 0.65 N make 0.35 um
PLASTIC = 0.15e-6  # m, on the body of plastic-linear: p0 of Hertz would be 5 times its yield stress
CELLS = {"cells": (37, 37), "extent": (18e-6, 18e-6), "layers": 30, "depth": 12e-6}
ONE_STEP = 0.2  # N: force control in one step, whose approach is then given

Found = tuple[Scene, dict[str, Result]]
"""The elastic scene, and the results by part and model."""


class DisplacementControl(Case):
    """The force that an approach takes, in both models."""

    def solve(self, context: Context) -> Found:
        given = with_loading(
            context.scene("hertz-sphere"), force=None, approach=ELASTIC, steps=1, unload=False
        )
        body = with_mesh(with_grid(context.scene("plastic-linear"), **CELLS), 12)
        plastic = with_loading(body, force=None, approach=PLASTIC, steps=5)
        found = {
            f"{part}-{name}": context.solve(model, scene, f"{part}-{name}")
            for part, scene in (("elastic", given), ("plastic", plastic))
            for name, model in (("sam", SAM), ("fem", FEM))
        }
        in_one = with_loading(body, force=ONE_STEP, steps=1, unload=False)
        approach = context.solve(SAM, in_one, "force-sam").quantities["approach_m"]
        returned = with_loading(in_one, force=None, approach=approach)
        return given, found | {"returned": context.solve(SAM, returned, "returned-sam")}

    def measure(self, found: Found) -> dict[str, Measured]:
        scene, of = found[0], {name: each.quantities for name, each in found[1].items()}
        hertz = 4.0 / 3.0 * modulus_of(scene) * scene.counterbody.radius**0.5 * ELASTIC**1.5
        sam, fem = of["plastic-sam"], of["plastic-fem"]
        return {
            "sam-hertz": Measured(of["elastic-sam"]["force_N"], hertz, unit="N"),
            "fem-hertz": Measured(of["elastic-fem"]["force_N"], hertz, unit="N"),
            "returned": Measured(of["returned"]["force_N"], ONE_STEP, unit="N"),
            "plastic-force": Measured(sam["force_N"], fem["force_N"], unit="N"),
            "plastic-residual": Measured(sam["residual_uz_center_m"], fem["residual_uz_center_m"], unit="m"),
        }

    def setup(self, found: Found) -> list[tuple[str, str]]:
        return [
            ("Elastic", f"the sphere of hertz-sphere, {ELASTIC * 1e6:g} µm"),
            (
                "Linear hardening",
                f"the body of plastic-linear, {PLASTIC * 1e6:g} µm in 5 steps, then to zero force",
            ),
            ("Returned", f"the approach of one step to {ONE_STEP:g} N, given again"),
        ]

    def tables(self, found: Found) -> list[SmallTable]:
        sam, fem = (found[1][f"plastic-{name}"].tables["history"] for name in ("sam", "fem"))
        rows = [
            (f"{1e9 * sam['approach_m'][k]:.2f}", f"{sam['force_N'][k]:.6f}", f"{fem['force_N'][k]:.6f}")
            for k in range(6)
        ]
        header = "approach of SAM [nm]", "force of SAM [N]", "force of FEM [N]"
        return [SmallTable("Linear hardening: the force of each step", header, rows)]


CASES = (DisplacementControl("displacement-control"),)
