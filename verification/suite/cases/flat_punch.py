# SPDX-License-Identifier: MIT
"""A rigid flat-ended cylinder: SAM, FEM and the closed form, with a pressure that is singular at the edge."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from sam.scene import Result, Scene
from verification.figures.profiles import Profile, profiles
from verification.figures.views import VON_MISES
from verification.reference.flat_punch import FlatPunch
from verification.reference.hertz import effective_modulus
from verification.reference.rounded_punch import RoundedPunch
from verification.reference.stress import von_mises
from verification.runs.sampling import peak
from verification.suite.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    elastic_text,
    grid_text,
    mesh_text,
)
from verification.suite.cases.hertz import mises_on_axis, scaled_columns

Punch = FlatPunch | RoundedPunch
INSIDE = 0.8
"""Share of the radius up to which the pressure is compared: at the edge it is unbounded."""

EQUATIONS = (
    ("Approach", "δ = F/(2aE*)", "Boussinesq (1885); Johnson, Contact Mechanics (1985), Eq. 3.36"),
    ("Pressure", "p = F/(2πa √(a² − r²))", "Johnson (1985), Eq. 3.34"),
    ("Surface outside", "u = (2δ/π) asin(a/r)", "Johnson (1985), Eq. 3.38"),
    (
        "Stresses on the axis, t = z/a, P = F/(2πa²)",
        "σzz = −P(1 + 3t²)/(1 + t²)²,  σxx = P[t²/(1 + t²)² − (½ + ν)/(1 + t²)]",
        "Sneddon, Proc. Camb. Phil. Soc. 42 (1946) 29",
    ),
)


@dataclass(frozen=True)
class PunchResults:
    """A scene solved by both models ("SAM", "FEM"), and its closed form."""

    scene: Scene
    exact: FlatPunch
    results: dict[str, Result]


class FlatPunchCase(Case):
    """Both models: approach, pressure inside, surface and axis."""

    def solve(self, context: Context) -> PunchResults:
        scene = context.scene(self.name)
        modulus = effective_modulus(scene.body.young, scene.body.poisson)
        exact = FlatPunch(scene.loading.force, scene.counterbody.radius, modulus)
        results = {"SAM": context.solve(SAM, scene, "sam"), "FEM": context.solve(FEM, scene, "fem")}
        return PunchResults(scene, exact, results)

    def measure(self, found: PunchResults) -> dict[str, Measured | float]:
        values = {"fem-load": found.results["FEM"].certificate["force_balance"]}
        for name, result in found.results.items():
            against = against_closed_form(result, found.exact, found.scene)
            values |= {f"{name.lower()}-{key}": value for key, value in against.items()}
        return values

    def setup(self, found: PunchResults) -> list[tuple[str, str]]:
        sam, fem, exact, a = *found.results.values(), found.exact, found.exact.contact_radius
        return [
            ("Half-space", elastic_text(found.scene.body)),
            ("Cylinder", f"radius a = {a * 1e6:g} µm, rigid, flat end"),
            ("Force", f"{exact.force:g} N"),
            (
                "Approach δ, pressure in the centre",
                (f"{exact.approach * 1e6:.5f} µm, {exact.pressure(0.0) / 1e9:.4f} GPa"),
            ),
            ("SAM", grid_text(sam, a)),
            (
                "FEM",
                f"{mesh_text(fem)}, refined towards the edge to a/{a / fem.discretisation['h_edge_m']:.0f}",
            ),
        ]

    def figures(self, found: PunchResults) -> Iterator[Plot]:
        yield plot(
            found.results,
            found.exact,
            nu=found.scene.body.poisson,
            until=0.95 * found.exact.contact_radius,
            caption="Pressure up to 0.95 a: at the edge it is unbounded. SAM represents the circle by whole "
            "cells, which makes the punch smaller by a fraction of a cell.",
        )


def against_closed_form(result: Result, exact: FlatPunch, scene: Scene) -> dict[str, Measured]:
    """One model against the closed form; the pressure is weighted with r dr."""
    x, p = peak(result.tables["line"], "x_m", "p_Pa")
    inside = (x >= 0.0) & (x <= INSIDE * exact.contact_radius)
    x, p = x[inside], p[inside]
    stress = partial(exact.axis_stress, nu=scene.body.poisson)
    return {
        "approach": Measured(result.quantities["approach_m"], exact.approach, unit="m"),
        "p-center": Measured(result.quantities["p_center_Pa"], float(exact.pressure(0.0)), unit="Pa"),
        "pressure": Measured(p, exact.pressure(x), x * np.gradient(x)),
        "mises-axis": mises_on_axis(result, 2.0 * exact.contact_radius, stress),
    }


def plot(results: Mapping[str, Result], exact: Punch, *, nu: float, until: float, caption: str) -> Plot:
    """Pressure up to r = until (in m), surface and stress under the centre of a rigid punch."""
    return Plot(
        profiles(panels(results, exact, nu, until)),
        "profiles",
        "Pressure, surface and stress under the centre",
        "Curves of the pressure, the surface displacement and the von Mises stress under the centre for "
        "SAM, FEM and the closed form, with the errors underneath.",
        caption,
    )


def panels(results: Mapping[str, Result], exact: Punch, nu: float, until: float) -> list[Profile]:
    """Pressure, surface displacement, and von Mises stress under the centre, over the contact radius."""
    a, center = exact.contact_radius, float(exact.pressure(0.0))

    def panel(labels: tuple, function: Callable, where: tuple[str, str, str], scale: tuple) -> Profile:
        """where: table, columns of place and value; scale: unit of the value and the error, its name, end of
        the axis.
        """
        unit, name, end = scale
        series = scaled_columns(results, where[0], where[1:], (a, unit))
        xlabel = "$r/a$" if where[0] == "line" else "$z/a$"
        return Profile(
            labels[0], xlabel, labels[1], lambda s: function(s * a) / unit, series, 1.0, name, (0.0, end)
        )

    return [
        panel(
            ("Pressure", "$p/p(0)$"), exact.pressure, ("line", "x_m", "p_Pa"), (center, "$p(0)$", until / a)
        ),
        panel(
            ("Surface displacement", r"$u_z/\delta$"),
            exact.displacement,
            ("line", "x_m", "uz_m"),
            (exact.approach, r"$\delta$", 1.5),
        ),
        panel(
            ("Von Mises under the centre", VON_MISES.replace("p_0", "p(0)")),
            lambda z: von_mises(exact.axis_stress(z, nu)),
            ("axis", "z_m", "mises_Pa"),
            (center, "$p(0)$", 2.0),
        ),
    ]


CASES = (
    FlatPunchCase(
        "flat-punch",
        "Rigid flat-ended cylinder on a steel half-space",
        "Do SAM and FEM find approach and pressure of a punch whose pressure is unbounded at the edge?",
        EQUATIONS,
    ),
)
