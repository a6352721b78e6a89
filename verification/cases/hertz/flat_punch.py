# SPDX-License-Identifier: MIT
"""A rigid flat-ended cylinder: SAM, FEM and the closed form, with a pressure that is singular at the edge."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from sam.scene import Result
from verification.cases.case import (
    Plot,
)
from verification.cases.hertz.hertz import scaled_columns
from verification.figures.profiles import Profile, profiles
from verification.figures.views import VON_MISES
from verification.reference.flat_punch import FlatPunch
from verification.reference.rounded_punch import RoundedPunch
from verification.reference.stress import von_mises

Punch = FlatPunch | RoundedPunch
"""Share of the radius up to which the pressure is compared: at the edge it is unbounded."""


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
