# SPDX-License-Identifier: MIT
"""Hertz contact of a rigid ellipsoid: SAM and the closed form (no axisymmetric model can represent it)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification.figures.maps import FieldPair, pressure_maps
from verification.figures.profiles import Profile, profiles
from verification.figures.views import SURFACE_AXES, VON_MISES, pressure_map
from verification.reference.elliptic import EllipticContact
from verification.reference.hertz import effective_modulus
from verification.reference.stress import von_mises
from verification.runs.sampling import peak
from verification.suite.cases.case import SAM, Case, Context, Measured, Plot, elastic_text, grid_text
from verification.suite.cases.hertz import mises_on_axis, smooth_values

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


@dataclass(frozen=True)
class Ellipse:
    """A scene solved by SAM, and its closed form."""

    scene: Scene
    exact: EllipticContact
    sam: Result


def contact_of(scene: Scene) -> EllipticContact:
    """The closed form of a scene with a rigid ellipsoid."""
    body, other = scene.body, scene.counterbody
    modulus = effective_modulus(body.young, body.poisson)
    return EllipticContact(scene.loading.force, other.radius_x, other.radius_y, modulus)


class HertzEllipse(Case):
    """SAM on rectangular cells: pressure, approach and stresses on the axis."""

    def solve(self, context: Context) -> Ellipse:
        scene = context.scene(self.name)
        return Ellipse(scene, contact_of(scene), context.solve(SAM, scene, "sam"))

    def measure(self, found: Ellipse) -> dict[str, Measured]:
        exact, nu = found.exact, found.scene.body.poisson
        return smooth_values(
            found.sam,
            exact,
            force=found.scene.loading.force,
            pressure=exact.pressure,
            largest=exact.largest_axis_von_mises(nu),
            axis=mises_on_axis(found.sam, 2.0 * min(exact.semi_axes), lambda z: exact.axis_stress(z, nu)),
        )

    def setup(self, found: Ellipse) -> list[tuple[str, str]]:
        other, (a, b), hy = (
            found.scene.counterbody,
            found.exact.semi_axes,
            found.sam.discretisation["cell_m"][1],
        )
        return [
            ("Half-space", elastic_text(found.scene.body)),
            ("Ellipsoid", f"Rx = {other.radius_x * 1e6:g} µm, Ry = {other.radius_y * 1e6:g} µm, rigid"),
            ("Force", f"{found.scene.loading.force:g} N"),
            ("Semi-axes a (along x), b (along y)", f"{a * 1e6:.4f} µm, {b * 1e6:.4f} µm"),
            ("Peak pressure p₀", f"{found.exact.peak_pressure / 1e9:.4f} GPa"),
            (
                "SAM",
                f"{grid_text(found.sam, a)} along x, {hy * 1e9:.1f} nm (b/{b / hy:.1f}) along y, apex on a "
                "cell centre",
            ),
        ]

    def figures(self, found: Ellipse) -> list[Plot]:
        exact, (a, b), p0 = found.exact, found.exact.semi_axes, found.exact.peak_pressure
        x, y, p = pressure_map(found.sam)
        x, y, p = x[near := np.abs(x) <= 1.2 * a], y[close := np.abs(y) <= 1.2 * a], p[np.ix_(near, close)]
        fields = (p / p0, exact.pressure(x[:, None], y[None, :]) / p0)
        return [
            Plot(
                pressure_maps(
                    FieldPair(
                        x / a, y / a, *fields, ("SAM", "closed form"), SURFACE_AXES, "$p/p_0$", (1.0, b / a)
                    )
                ),
                "pressure-maps",
                "Contact pressure",
                "Three maps of the contact pressure over x/a and y/a: SAM, closed form and their difference, "
                "which is confined to the edge of the contact ellipse.",
                "p/p₀ on the rectangular cells of SAM, the closed form at their centres, and the difference. "
                "Dashed: the contact ellipse of the closed form.",
            ),
            Plot(
                profiles(panels(found)),
                "profiles",
                "Pressure along the axes of the ellipse, and von Mises stress under the centre",
                "Curves of the pressure along x and of the von Mises stress over depth for SAM and the "
                "closed form, which coincide, with the errors underneath.",
                "Underneath: computed minus closed form in % of p₀.",
            ),
        ]


def panels(found: Ellipse) -> list[Profile]:
    """Pressure along both axes of the ellipse, von Mises stress under its centre."""
    exact, nu, (a, b), p0 = (
        found.exact,
        found.scene.body.poisson,
        found.exact.semi_axes,
        found.exact.peak_pressure,
    )
    x, y, p = pressure_map(found.sam)
    z, mises = peak(found.sam.tables["axis"], "z_m", "mises_Pa")

    def panel(labels: Sequence[str], function: Callable, points: tuple, limits: tuple) -> Profile:
        return Profile(*labels, function, {"SAM": points}, 1.0, "$p_0$", limits)

    along_x, along_y = (x / a, p[:, y.size // 2] / p0), (y / b, p[x.size // 2] / p0)
    return [
        panel(
            ("Pressure along x", "$x/a$", "$p/p_0$"),
            lambda s: exact.pressure(s * a, 0.0) / p0,
            along_x,
            (-1.5, 1.5),
        ),
        panel(
            ("Pressure along y", "$y/b$", "$p/p_0$"),
            lambda s: exact.pressure(0.0, s * b) / p0,
            along_y,
            (-1.5, 1.5),
        ),
        panel(
            ("Von Mises under the centre", "$z/b$", VON_MISES),
            lambda s: von_mises(exact.axis_stress(s * b, nu)) / p0,
            (z / b, mises / p0),
            (0.0, 2.0),
        ),
    ]


CASES = (
    HertzEllipse(
        "hertz-ellipse",
        "Rigid ellipsoid on a steel half-space",
        "Does SAM, on rectangular cells, reproduce the elliptic contact of Hertz?",
        EQUATIONS,
    ),
)
