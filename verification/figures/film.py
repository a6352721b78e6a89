# SPDX-License-Identifier: MIT
"""The figures of films that yield or slide: what they change over the contact radius, pressures, sections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from sam.scene import Result
from verification.figures.friction import Curve, curves, peak_at
from verification.figures.maps import FieldPair, plane_maps
from verification.figures.style import (
    BLACK,
    BLUE,
    EXACT,
    GREEN,
    VERMILION,
    Columns,
    Drawing,
    sheet,
    style,
    zero_line,
)
from verification.figures.views import PLANE_AXES, VON_MISES, VON_MISES_LEVELS
from verification.runs.sampling import peak, plane_field

if TYPE_CHECKING:
    from pandas import DataFrame, Series

GIGA, MICRO, PERCENT = 1e-9, 1e6, 1e2
COLOURS = {"elastic": BLACK, "B 945": BLUE, "B 1780": VERMILION}
STYLES = {"bare": (0.9, ":"), "elastic": (1.4, "-"), "yields": (1.4, "--")}
"""Of the film: width and kind of the line."""
LIMIT = {"color": GREEN, "linewidth": 1.0, "linestyle": "-."}


def series(body: str, film: str) -> str:
    """The name of a curve."""
    return f"body {body}, " + ("no film" if film == "bare" else f"film {film}")


def looks(marker: str | None = None) -> dict[str, dict]:
    """Of each curve by its name: colour by body, line by film."""
    return {
        series(body, film): {
            "color": color,
            "marker": marker,
            "markersize": 4,
            "linewidth": w,
            "linestyle": line,
        }
        for body, color in COLOURS.items()
        for film, (w, line) in STYLES.items()
    }


def changes(found: DataFrame, limit: float) -> Drawing:
    """Changes of the largest pressure and of the body's von Mises stress in % over the contact radius in um.
    found: frame of `verification.cases.coated.film_yield`, as for the others.
    """
    panels: dict[str, dict[str, Curve]] = {}
    ends = MICRO * np.array([found["radius"].min(), found["radius"].max()])
    for name, words in (("p_change", "largest pressure"), ("mises_change", "von Mises in the body")):
        for counter, ones in found.groupby("counterbody"):
            panel = panels[f"{words}, {counter}"] = {}
            for kind, own in ones.sort_values("radius").groupby(["body", "film"], sort=False):
                panel[series(*kind)] = Curve(*(own[["radius", name]].to_numpy() * (MICRO, PERCENT)).T)
            panel["limit"] = Curve(ends, np.full(2, -PERCENT * limit))
    drawing = curves(panels, r"$a_0$ [$\mu$m]", "change [%]", looks=looks("o") | {"limit": LIMIT})
    first = drawing.figure.axes[0]
    entries = first.get_legend_handles_labels()
    first.get_legend().remove()
    with style():
        drawing.figure.legend(*entries, loc="outside lower center", ncols=len(entries[1]))
    return drawing


def pressures(found: DataFrame, bare_radius: float) -> Drawing:
    """Pressure in GPa over r/a0: a panel for each contact radius, without film and with each."""
    panels: dict[str, dict[str, Curve]] = {}
    for _, one in found[found["body"] != "B 1780"].iterrows():
        panel = panels.setdefault(title(one), {})
        for film, result, a in (
            ("bare", one["bare"], bare_radius),
            (one["film"], one["result"], one["radius"]),
        ):
            r, p = peak(result.tables["line"], "x_m", "p_Pa")
            panel[series(one["body"], film)] = Curve(r[use := r <= 1.4 * a] / a, GIGA * p[use])
    return curves(panels, "$r/a_0$", "pressure [GPa]", looks=looks())


def title(one: Series) -> str:
    """The contact radius of a panel."""
    return rf"$a_0$ = {MICRO * one['radius']:g} $\mu$m"


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


def thinning_curves(pressure: np.ndarray, curves: Mapping[str, np.ndarray], limit: float) -> Drawing:
    """pressure in GPa, (n,); curves: name -> thinning in %, (n,), NaN where there is none; limit in %."""
    rows = Columns("curve", "pressure_GPa", "thinning_percent")
    with sheet(4.8, 3.2) as (figure, axis):
        for (name, thinning), (color, line) in zip(
            curves.items(), ((BLUE, "-"), (VERMILION, "-"), (GREEN, "--")), strict=True
        ):
            axis.plot(pressure, thinning, color=color, linestyle=line, linewidth=1.6, label=name)
            shown = np.isfinite(thinning)
            rows.add(name, pressure[shown], thinning[shown])
        axis.axhline(limit, **EXACT, label=f"growth of a cycle, {limit:.2f} %")
        zero_line(axis)
        axis.set(xlabel="pressure [GPa]", ylabel="thinning [%]", xlim=(0.0, pressure.max()))
        axis.legend()
    return Drawing(figure, rows)
