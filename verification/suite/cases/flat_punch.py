# SPDX-License-Identifier: MIT
"""A rigid flat-ended cylinder: SAM, FEM and the closed form, with a pressure that is singular at the edge."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.figures.profiles import Profile, profiles
from verification.figures.views import VON_MISES
from verification.reference.flat_punch import FlatPunch
from verification.reference.hertz import effective_modulus
from verification.reference.stress import von_mises
from verification.runs.models import FEM, SAM
from verification.runs.sampling import peak
from verification.suite.cases.case import Case, Context, Outcome, grid_text, mesh_text
from verification.suite.gates import Measured

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


def run(context: Context) -> Outcome:
    """Solve with both models and compare approach, pressure inside, surface and axis."""
    scene = context.scene(context.case)
    modulus = effective_modulus(scene.body.young, scene.body.poisson)
    exact = FlatPunch(scene.loading.force, scene.counterbody.radius, modulus)
    results = {"SAM": context.solve(SAM, scene, "sam"), "FEM": context.solve(FEM, scene, "fem")}
    outcome = Outcome(setup=setup(scene, exact, results["SAM"], results["FEM"]))
    for name, result in results.items():
        for key, value in measured(result, exact, scene).items():
            outcome.values[f"{context.case}.{name.lower()}-{key}"] = value
    outcome.values[f"{context.case}.fem-load"] = Measured(results["FEM"].certificate["force_balance"])
    outcome.figures.append(
        context.save(
            profiles(panels(results, exact, scene)),
            "profiles",
            "Pressure, surface and stress under the centre",
            "Curves of the pressure, the surface displacement and the von Mises stress under the centre for SAM, FEM and "
            "the closed form, with the errors underneath.",
            "Pressure up to 0.95 a: at the edge it is unbounded. SAM represents the circle by whole cells, which makes "
            "the punch smaller by a fraction of a cell.",
        )
    )
    return outcome


def setup(scene: Scene, exact: FlatPunch, sam: Result, fem: Result) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    mesh, a = fem.discretisation, exact.radius
    return [
        ("Half-space", f"E = {scene.body.young / 1e9:g} GPa, ν = {scene.body.poisson:g}"),
        ("Cylinder", f"radius a = {exact.radius * 1e6:g} µm, rigid, flat end"),
        ("Force", f"{exact.force:g} N"),
        (
            "Approach δ, pressure in the centre",
            f"{exact.approach * 1e6:.5f} µm, {exact.pressure(0.0) / 1e9:.4f} GPa",
        ),
        ("SAM", grid_text(sam, a)),
        ("FEM", f"{mesh_text(fem)}, refined towards the edge to a/{a / mesh['h_edge_m']:.0f}"),
    ]


def measured(result: Result, exact: FlatPunch, scene: Scene) -> dict[str, Measured]:
    """One model against the closed form; the pressure is weighted with r dr."""
    x, p = peak(result.tables["line"], "x_m", "p_Pa")
    inside = (x >= 0.0) & (x <= INSIDE * exact.radius)
    x, p = x[inside], p[inside]
    z, mises = peak(result.tables["axis"], "z_m", "mises_Pa")
    use = z <= 2.0 * exact.radius
    z, mises = z[use], mises[use]
    return {
        "approach": Measured(result.quantities["approach_m"], exact.approach, unit="m"),
        "p-center": Measured(result.quantities["p_center_Pa"], float(exact.pressure(0.0)), unit="Pa"),
        "pressure": Measured(p, exact.pressure(x), x * np.gradient(x)),
        "mises-axis": Measured(mises, von_mises(exact.axis_stress(z, scene.body.poisson)), np.gradient(z)),
    }


def panels(results: dict[str, Result], exact: FlatPunch, scene: Scene) -> list[Profile]:
    a, p0, delta = exact.radius, float(exact.pressure(0.0)), exact.approach

    def panel(
        title: str, ylabel: str, function, where: tuple[str, str, str], unit: float, name: str, end: float
    ) -> Profile:
        """where: table, column of the place, column of the value; unit: of the value, also that of the error."""
        table, place, column = where
        columns = {key: peak(result.tables[table], place, column) for key, result in results.items()}
        series = {key: (x / a, y / unit) for key, (x, y) in columns.items()}
        xlabel = "$r/a$" if table == "line" else "$z/a$"
        return Profile(title, xlabel, ylabel, lambda s: function(s * a) / unit, series, 1.0, name, (0.0, end))

    def mises(z: np.ndarray) -> np.ndarray:
        return von_mises(exact.axis_stress(z, scene.body.poisson))

    center, label = "$p(0)$", VON_MISES.replace("p_0", "p(0)")
    line, axis = ("line", "x_m"), ("axis", "z_m", "mises_Pa")
    return [
        panel("Pressure", "$p/p(0)$", exact.pressure, (*line, "p_Pa"), p0, center, 0.95),
        panel(
            "Surface displacement",
            r"$u_z/\delta$",
            exact.displacement,
            (*line, "uz_m"),
            delta,
            r"$\delta$",
            1.5,
        ),
        panel("Von Mises under the centre", label, mises, axis, p0, center, 2.0),
    ]


CASES = (
    Case(
        "flat-punch",
        "Rigid flat-ended cylinder on a steel half-space",
        "Do SAM and FEM find approach and pressure of a punch whose pressure is unbounded at the edge?",
        run,
        EQUATIONS,
    ),
)
