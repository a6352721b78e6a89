# SPDX-License-Identifier: MIT
"""Hertz contact of a rigid ellipsoid: SAM and the closed form (no axisymmetric model can represent it)."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.figures.maps import FieldPair, pressure_maps
from verification.figures.profiles import Profile, profiles
from verification.figures.views import SURFACE_AXES, VON_MISES, pressure_map
from verification.reference.elliptic import EllipticContact
from verification.reference.hertz import effective_modulus
from verification.reference.stress import von_mises
from verification.runs.models import SAM
from verification.runs.sampling import peak
from verification.suite.cases.case import Case, Context, Outcome, grid_text
from verification.suite.gates import Measured

EQUATIONS = (
    (
        "Ratio of the semi-axes",
        "Rx/Ry = R_D(0, 1, k²)/R_D(0, k², 1),  k = b/a",
        "Johnson, Contact Mechanics (1985), Eq. 4.28, in Carlson's symmetric integrals",
    ),
    ("Semi-axes", "a³ = F Rx R_D(0, k², 1)/(πE*),  b = ka", "Johnson (1985), section 4.2"),
    ("Pressure", "p = p₀ √(1 − x²/a² − y²/b²),  p₀ = 3F/(2πab)", "Johnson (1985), Eq. 3.58"),
    ("Approach", "δ = (p₀ab/E*) R_F(0, a², b²)", "Johnson (1985), Eq. 3.61"),
)


def run(context: Context) -> Outcome:
    """Solve with SAM on rectangular cells and compare pressure, approach and axis stresses."""
    scene = context.scene(context.case)
    body, other = scene.body, scene.counterbody
    modulus = effective_modulus(body.young, body.poisson)
    exact = EllipticContact(scene.loading.force, other.radius_x, other.radius_y, modulus)
    sam = context.solve(SAM, scene, "sam")
    values = measured(sam, exact, scene)
    outcome = Outcome(
        {f"{context.case}.{name}": value for name, value in values.items()}, setup(scene, exact, sam)
    )
    draw(context, outcome, sam, exact, scene)
    return outcome


def setup(scene: Scene, exact: EllipticContact, sam: Result) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    body, other, (a, b) = scene.body, scene.counterbody, exact.semi_axes
    _, hy = sam.discretisation["cell_m"]
    return [
        ("Half-space", f"E = {body.young / 1e9:g} GPa, ν = {body.poisson:g}"),
        ("Ellipsoid", f"Rx = {other.radius_x * 1e6:g} µm, Ry = {other.radius_y * 1e6:g} µm, rigid"),
        ("Force", f"{scene.loading.force:g} N"),
        ("Semi-axes a (along x), b (along y)", f"{a * 1e6:.4f} µm, {b * 1e6:.4f} µm"),
        ("Peak pressure p₀", f"{exact.peak_pressure / 1e9:.4f} GPa"),
        (
            "SAM",
            f"{grid_text(sam, a)} along x, {hy * 1e9:.1f} nm (b/{b / hy:.1f}) along y, apex on a cell centre",
        ),
    ]


def measured(sam: Result, exact: EllipticContact, scene: Scene) -> dict[str, Measured]:
    found, b = sam.quantities, min(exact.semi_axes)
    x, y, p = pressure_map(sam)
    load = np.sum(p) * (x[1] - x[0]) * (y[1] - y[0])
    z, mises = peak(sam.tables["axis"], "z_m", "mises_Pa")
    use = z <= 2.0 * b
    z, mises = z[use], mises[use]
    largest, depth = exact.largest_axis_von_mises(scene.body.poisson)
    return {
        "sam-p-max": Measured(found["p_max_Pa"], exact.peak_pressure, unit="Pa"),
        "sam-approach": Measured(found["approach_m"], exact.approach, unit="m"),
        "sam-load": Measured(load, scene.loading.force, unit="N"),
        "sam-pressure": Measured(p, exact.pressure(x[:, None], y[None, :])),
        "sam-mises-max": Measured(found["mises_max_Pa"], largest, unit="Pa"),
        "sam-mises-depth": Measured(found["mises_max_depth_m"], depth, unit="m"),
        "sam-mises-axis": Measured(
            mises, von_mises(exact.axis_stress(z, scene.body.poisson)), np.gradient(z)
        ),
    }


def draw(context: Context, outcome: Outcome, sam: Result, exact: EllipticContact, scene: Scene) -> None:
    (a, b), p0 = exact.semi_axes, exact.peak_pressure
    x, y, p = pressure_map(sam)
    use_x, use_y = np.abs(x) <= 1.2 * a, np.abs(y) <= 1.2 * a
    x, y, p = x[use_x], y[use_y], p[np.ix_(use_x, use_y)]
    fields = (p / p0, exact.pressure(x[:, None], y[None, :]) / p0)
    pair = FieldPair(x / a, y / a, *fields, ("SAM", "closed form"), SURFACE_AXES, "$p/p_0$", (1.0, b / a))
    outcome.figures += [
        context.save(
            pressure_maps(pair),
            "pressure-maps",
            "Contact pressure",
            "Three maps of the contact pressure over x/a and y/a: SAM, closed form and their difference, which is "
            "confined to the edge of the contact ellipse.",
            "p/p₀ on the rectangular cells of SAM, the closed form at their centres, and the difference. Dashed: the "
            "contact ellipse of the closed form.",
        ),
        context.save(
            profiles(panels(sam, exact, scene)),
            "profiles",
            "Pressure along the axes of the ellipse, and von Mises stress under the centre",
            "Curves of the pressure along x and of the von Mises stress over depth for SAM and the closed form, which "
            "coincide, with the errors underneath.",
            "Underneath: computed minus closed form in % of p₀.",
        ),
    ]


def panels(sam: Result, exact: EllipticContact, scene: Scene) -> list[Profile]:
    (a, b), p0 = exact.semi_axes, exact.peak_pressure
    x, y, p = pressure_map(sam)
    along_x, along_y = p[:, y.size // 2] / p0, p[x.size // 2] / p0
    z, mises = peak(sam.tables["axis"], "z_m", "mises_Pa")

    def on_x(s: np.ndarray) -> np.ndarray:
        return exact.pressure(s * a, 0.0) / p0

    def on_y(s: np.ndarray) -> np.ndarray:
        return exact.pressure(0.0, s * b) / p0

    def on_axis(s: np.ndarray) -> np.ndarray:
        return von_mises(exact.axis_stress(s * b, scene.body.poisson)) / p0

    def panel(
        title: str, xlabel: str, ylabel: str, function, place, value, start: float, end: float
    ) -> Profile:
        return Profile(title, xlabel, ylabel, function, {"SAM": (place, value)}, 1.0, "$p_0$", (start, end))

    return [
        panel("Pressure along x", "$x/a$", "$p/p_0$", on_x, x / a, along_x, -1.5, 1.5),
        panel("Pressure along y", "$y/b$", "$p/p_0$", on_y, y / b, along_y, -1.5, 1.5),
        panel("Von Mises under the centre", "$z/b$", VON_MISES, on_axis, z / b, mises / p0, 0.0, 2.0),
    ]


CASES = (
    Case(
        "hertz-ellipse",
        "Rigid ellipsoid on a steel half-space",
        "Does SAM, on rectangular cells, reproduce the elliptic contact of Hertz?",
        run,
        EQUATIONS,
    ),
)
