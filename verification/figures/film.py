# SPDX-License-Identifier: MIT
"""The figures of films that yield or slide: what they change over the contact radius, pressures, strains,
sections.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from sam.scene import Result
from verification.figures.friction import Curve, curves, peak_at
from verification.figures.maps import FieldPair, plane_maps
from verification.figures.style import BLACK, BLUE, GREEN, VERMILION, Drawing, style
from verification.figures.views import PLANE_AXES, VON_MISES, VON_MISES_LEVELS
from verification.runs.sampling import peak, plane_field

Found = Any
"""A contact with its results: `verification.cases.coated.film_contacts.Found`."""
GIGA, MICRO, PERCENT = 1e-9, 1e6, 1e2
COLOURS = {"elastic": BLACK, "B 945": BLUE, "B 1780": VERMILION}
BARE, ELASTIC, YIELDS = "bare", "elastic", "yields"
STYLES = {
    BARE: {"linewidth": 0.9, "linestyle": ":"},
    ELASTIC: {"linewidth": 1.4, "linestyle": "-"},
    YIELDS: {"linewidth": 1.4, "linestyle": "--"},
}
LIMIT = {"color": GREEN, "linewidth": 1.0, "linestyle": "-."}


def looks(bodies: Sequence[str], films: Sequence[str], marker: str | None = None) -> dict[str, dict]:
    """Colour by body, line by film, keyed as `series` names them."""
    return {
        series(body, film): {"color": COLOURS[body], "marker": marker, "markersize": 4, **STYLES[film]}
        for body in bodies
        for film in films
    }


def series(body: str, film: str) -> str:
    """The name of a curve."""
    return f"body {body}, " + ("no film" if film == BARE else f"film {film}")


def changes(found: Sequence[Found], limit: float) -> Drawing:
    """Changes of the largest pressure and of the body's von Mises stress in % over the contact radius in
    um.
    """
    panels: dict[str, dict[str, Curve]] = {}
    ends = (
        np.array([min(one.contact.radius for one in found), max(one.contact.radius for one in found)]) * MICRO
    )
    for k, words in enumerate(("largest pressure", "von Mises in the body")):
        for counter in ("rigid", "steel"):
            panel = panels.setdefault(f"{words}, {counter}", {})
            for kind in dict.fromkeys(one.contact.kind for one in found):
                ones = [one for one in found if one.contact.counter == counter and one.contact.kind == kind]
                ones.sort(key=lambda one: one.contact.radius)
                x = MICRO * np.array([one.contact.radius for one in ones])
                panel[series(*kind)] = Curve(x, PERCENT * np.array([one.changes[k] for one in ones]))
            panel["limit"] = Curve(ends, np.full(2, -PERCENT * limit))
    used = looks(tuple(COLOURS), (ELASTIC, YIELDS), "o") | {"limit": LIMIT}
    drawing = curves(panels, r"$a_0$ [$\mu$m]", "change [%]", looks=used)
    first = drawing.figure.axes[0]
    entries = first.get_legend_handles_labels()
    first.get_legend().remove()
    with style():
        drawing.figure.legend(*entries, loc="outside lower center", ncols=len(entries[1]))
    return drawing


def pressures(found: Sequence[Found]) -> Drawing:
    """Pressure in GPa over r/a0: a panel for each contact radius, without film and with each."""
    panels: dict[str, dict[str, Curve]] = {}
    for one in found:
        panel, body = panels.setdefault(title(one), {}), one.contact.body
        if body not in ("elastic", "B 945"):
            continue
        panel[series(body, BARE)] = pressure_of(one.bare, one.contact.alone.radius)
        panel[series(*one.contact.kind)] = pressure_of(one.result, one.contact.radius)
    used = looks(("elastic", "B 945"), (BARE, ELASTIC, YIELDS))
    return curves(panels, "$r/a_0$", "pressure [GPa]", looks=used)


def title(found: Found) -> str:
    """The contact radius of a panel."""
    return rf"$a_0$ = {MICRO * found.contact.radius:g} $\mu$m"


def pressure_of(result: Result, a: float, reach: float = 1.4) -> Curve:
    """Pressure in GPa over r/a at peak load."""
    r, p = peak(result.tables["line"], "x_m", "p_Pa")
    use = r <= reach * a
    return Curve(r[use] / a, GIGA * p[use])


def strains(found: Sequence[Found]) -> Drawing:
    """Mean plastic strain over the film's thickness in %, over r/a0: a panel for each contact radius, a curve
    for each body.
    """
    panels: dict[str, dict[str, Curve]] = {}
    for one in found:
        r, strain = one.film_profile
        use = r <= 1.4 * one.contact.radius
        panel = panels.setdefault(title(one), {})
        panel[series(*one.contact.kind)] = Curve(r[use] / one.contact.radius, PERCENT * strain[use])
        if one.contact.body == "elastic":
            panel["thin film"] = Curve(np.zeros(1), PERCENT * np.array([one.thin_film]))
    marks = {"color": BLACK, "marker": "o", "fillstyle": "none", "linestyle": "none"}
    used = looks(tuple(COLOURS), (YIELDS,)) | {"thin film": marks}
    return curves(panels, "$r/a_0$", "plastic strain of the film [%]", looks=used)


def sliding_pressures(panels: Mapping[str, Mapping[str, Curve]]) -> Drawing:
    """Pressure along the sliding direction: SAM with and without film, FEM with it."""
    used = {
        "SAM": {"color": BLUE, "linewidth": 1.6},
        "FEM": {"color": VERMILION, "marker": "x", "linestyle": "none", "markersize": 4},
        "SAM, no film": {"color": BLACK, "linewidth": 1.0, "linestyle": ":"},
    }
    return curves(panels, "$x/a_0$", "$p/p_0$", looks=used)


def sliding_sections(
    sam: Result,
    fem: Result,
    units: tuple[float, float],
    thickness: float,
    *,
    reach: float = 1.5,
    deep: float = 1.4,
) -> Drawing:
    """Von Mises stress of the body over p0 in y = 0, from the film's lower face on: SAM | FEM | difference.

    units: a in m and p0 in Pa.
    """
    a, p0 = units
    x, z, own = plane_field(sam.tables, "mises_Pa")
    use_x, use_z = np.abs(x) <= reach * a, (z >= thickness * (1.0 - 1e-9)) & (z <= deep * a)
    x, z, own = x[use_x], z[use_z], own[np.ix_(use_x, use_z)]
    fields = own / p0, in_body(fem, x, z, thickness) / p0
    edge = fem.quantities["contact_radius_m"] / a
    pair = FieldPair(x / a, z / a, *fields, ("SAM", "FEM"), PLANE_AXES, VON_MISES, (edge, edge))
    return plane_maps(pair, [peak_at(x / a, z / a, field) for field in fields], VON_MISES_LEVELS)


def in_body(
    fem: Result, x: np.ndarray, z: np.ndarray, thickness: float, *, column: str = "mises_Pa"
) -> np.ndarray:
    """(nx, nz) a column of the three-dimensional model in y = 0 below the film, linear; NaN above its first
    depth there.
    """
    u, w, values = plane_field(fem.tables, column)
    w[np.isclose(w, thickness, rtol=1e-9, atol=0.0)] = thickness  # to rounding
    body = w >= thickness
    at = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1)
    return RegularGridInterpolator((u, w[body]), values[:, body], bounds_error=False)(at)
