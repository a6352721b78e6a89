# SPDX-License-Identifier: MIT
"""The approach is given and the force is found: SAM and FEM against Hertz, against each other, and against
force control.
"""

from __future__ import annotations

from dataclasses import dataclass

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    elastic_text,
    with_grid,
    with_loading,
    with_mesh,
)
from verification.reference.hertz import effective_modulus

ELASTIC = 0.3e-6  # m, on the sphere of hertz-sphere: 0.65 N make 0.35 um
PLASTIC = 0.15e-6  # m, on the body of plastic-linear: p0 of Hertz would be 5 times its yield stress
STEPS = 5
CELLS = {"cells": (37, 37), "extent": (18e-6, 18e-6), "layers": 30, "depth": 12e-6}
ELEMENTS = 12  # in the contact radius of Hertz
ONE_STEP = 0.2  # N: force control in one step, whose approach is then given


@dataclass(frozen=True)
class Approached:
    """Results at a given approach: elastic and plastic ones by model; returned: of SAM, at the approach that
    one step of the force had.
    """

    scene: Scene
    elastic: dict[str, Result]
    plastic: dict[str, Result]
    returned: Result

    @property
    def exact(self) -> float:
        """Force of Hertz in N."""
        body, radius = self.scene.body, self.scene.counterbody.radius
        return 4.0 / 3.0 * effective_modulus(body.young, body.poisson) * radius**0.5 * ELASTIC**1.5


class DisplacementControl(Case):
    """The force that an approach takes, in both models."""

    def solve(self, context: Context) -> Approached:
        sphere, body = context.scene("hertz-sphere"), context.scene("plastic-linear")
        elastic = with_loading(sphere, force=None, approach=ELASTIC, steps=1, unload=False)
        body = with_mesh(with_grid(body, **CELLS), ELEMENTS)
        plastic = with_loading(body, force=None, approach=PLASTIC, steps=STEPS)
        in_one = with_loading(body, force=ONE_STEP, steps=1, unload=False)
        by_force = context.solve(SAM, in_one, "force-sam")
        given = {"force": None, "approach": by_force.quantities["approach_m"]}
        return Approached(
            elastic,
            {name: context.solve(name, elastic, f"elastic-{name}") for name in (SAM, FEM)},
            {name: context.solve(name, plastic, f"plastic-{name}") for name in (SAM, FEM)},
            context.solve(SAM, with_loading(in_one, **given), "returned-sam"),
        )

    def measure(self, found: Approached) -> dict[str, Measured | float]:
        plastic, fem = (found.plastic[name].quantities for name in (SAM, FEM))
        values: dict[str, Measured | float] = {
            "sam-hertz": Measured(found.elastic[SAM].quantities["force_N"], found.exact, unit="N"),
            "fem-hertz": Measured(found.elastic[FEM].quantities["force_N"], found.exact, unit="N"),
            "returned": Measured(found.returned.quantities["force_N"], ONE_STEP, unit="N"),
        }
        for gate, name in (("plastic-force", "force_N"), ("plastic-residual", "residual_uz_center_m")):
            values[gate] = Measured(plastic[name], fem[name], unit=name.rsplit("_", 1)[1])
        return values

    def setup(self, found: Approached) -> list[tuple[str, str]]:
        return [
            ("Half-space", elastic_text(found.scene.body)),
            ("Sphere", f"R = {found.scene.counterbody.radius * 1e6:g} µm, rigid"),
            ("Approach, elastic", f"{ELASTIC * 1e6:g} µm, force of Hertz {found.exact:.6g} N"),
            ("Approach, linear hardening", f"{PLASTIC * 1e6:g} µm in {STEPS} steps, then to zero force"),
            ("Returned", f"the approach of one step to {ONE_STEP:g} N, given again"),
        ]

    def tables(self, found: Approached) -> list[SmallTable]:
        rows = []
        sam, fem = (found.plastic[name].tables["history"] for name in (SAM, FEM))
        for k, approach in enumerate(sam["approach_m"][: STEPS + 1]):
            rows.append([f"{approach * 1e9:.2f}", f"{sam['force_N'][k]:.6f}", f"{fem['force_N'][k]:.6f}"])
        header = ["approach of SAM [nm]", "force of SAM [N]", "force of FEM [N]"]
        return [SmallTable("Linear hardening: the force of each step", header, rows)]


CASES = (DisplacementControl("displacement-control"),)
