# SPDX-License-Identifier: MIT
"""Figures of coated bodies: pressure under films of all thicknesses, maps of what a
film changes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import SymLogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from scipy.interpolate import RectBivariateSpline

from sam.scene import Result
from verification.figures.maps import FieldPair, plane_maps
from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, sheet
from verification.figures.views import VON_MISES, VON_MISES_LEVELS, peak_of
from verification.runs.sampling import plane_field, plane_field_on

if TYPE_CHECKING:
    from pandas import DataFrame

COLOURS = (BLUE, VERMILION, GREEN, ORANGE, BLACK)
CLEAR = 0.25
"""Of an element; the Gauss points of eight-node elements are 0.21 of it from its edges."""
PAPER_LOOK = {"color": GREEN, "marker": "o", "markersize": 4, "linewidth": 1.8}
FINE = 200
"""Points of each side of a map that is drawn."""
TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)
LIMITS = (0.01, 0.05)
LINES = ("--", "-")
"""Changes whose lines a map carries, and their look."""


MODEL_MARKS = {"SAM": {"marker": "o", "fillstyle": "none"}, "FEM": {"marker": "x"}}


def film_pressures(panels: Mapping[str, Mapping[str, Mapping[str, tuple]]]) -> Drawing:
    """Pressure over p0 over r/a0 under films of one modulus a panel; panels: title -> film -> "reference" or
    model -> (r, p); the bare contact of Hertz dotted.
    """
    rows = Columns("panel", "film", "series", "r_over_a0", "p_over_p0")
    bare, down = np.linspace(0.0, 1.0, 401), -(-len(panels) // 2)
    hertz = {"color": "#888888", "linestyle": ":", "linewidth": 1.6, "label": "without film"}
    with sheet(8.6, 0.3 + 3.5 * down, (down, 2), sharey="row") as (figure, grid):
        for axis, (title, films) in zip(axes := grid.ravel(), panels.items(), strict=False):
            axis.plot(bare, np.sqrt(1.0 - bare**2), **hertz)
            for (film, series), color in zip(films.items(), COLOURS, strict=False):
                for name, (r, p) in series.items():
                    line = {"linewidth": 1.3, "label": film}
                    points = {"linestyle": "none", "markersize": 4.5} | MODEL_MARKS.get(name, {})
                    axis.plot(r, p, color=color, **(line if name == "reference" else points))
                    rows.add(title, film, name, r, p)
            axis.set(title=title, xlabel="$r/a_0$", xlim=(0.0, None))
            axis.legend(loc="upper right")
        for axis in axes[::2]:  # shared by the panels of a row
            axis.set(ylabel="$p/p_0$", ylim=(0.0, None))
        _name_the_marks(axes[0], MODEL_MARKS)
    return Drawing(figure, rows)


def _name_the_marks(axis: Axes, names: Mapping) -> None:
    """A second legend, of the models."""
    marks = [
        Line2D([], [], color=BLACK, linestyle="none", markersize=4.5, label=n, **MODEL_MARKS[n])
        for n in names
    ]
    marks.append(Line2D([], [], color=BLACK, linewidth=1.3, label="reference"))
    first = axis.get_legend()
    axis.legend(handles=marks, loc="lower left")
    axis.add_artist(first)


def film_planes(
    sam: Result, fem: Result, units: tuple[float, float], *, film: float, element: float
) -> Drawing:
    """Von Mises stress over p0 in y = 0 of a coated body: SAM | FEM | difference; units: a in m, p0 in Pa.

    film: its thickness, element: size of the elements there, both in m. Between the last Gauss points above
    and below the interface, within CLEAR of an element, no stress of FEM is known on either side: nothing is
    drawn there.
    """
    a, p0 = units
    x, z, mises = plane_field(sam.tables, "mises_Pa")
    use_x, use_z = np.abs(x) <= 1.5 * a, (z <= 1.9 * a) & (np.abs(z - film) > CLEAR * element)
    x, z, mises = x[use_x], z[use_z], mises[np.ix_(use_x, use_z)]
    fields = mises / p0, plane_field_on(x, z, fem.tables, "mises_Pa") / p0
    pair = FieldPair(x / a, z / a, *fields, ("SAM", "FEM"), ("$x/a_0$", "$z/a_0$"), VON_MISES)
    quoted = [(r.quantities["mises_max_depth_m"] / a, r.quantities["mises_max_Pa"] / p0) for r in (sam, fem)]
    peaks = [peak_of(pair.u, field, *values) for field, values in zip(fields, quoted, strict=True)]
    return plane_maps(pair, peaks, VON_MISES_LEVELS, interface=film / a)


def change_maps(maps: Mapping[str, DataFrame], paper: tuple[float, Mapping[str, float]]) -> Drawing:
    """Heat maps on logarithmic axes with the lines of LIMITS, one colour scale for all, and the film of the
    paper.

    maps: title -> changes as shares over thickness/a0 (index) and E1/E2 (columns); paper: its modulus ratio,
    and label -> thickness/a0 on some contact radii.
    """
    rows = Columns("map", "thickness_over_a0", "E1_over_E2", "change_percent")
    largest = 100.0 * max(np.abs(each.to_numpy()).max() for each in maps.values())
    norm = SymLogNorm(linthresh=1.0, linscale=0.5, vmin=-largest, vmax=largest)
    with sheet(5.0 * len(maps), 4.4, len(maps), sharey=True) as (figure, axes):
        for axis, (title, each) in zip(axes, maps.items(), strict=True):
            mesh = _draw_map(axis, each, norm)
            axis.set(title=title, xlabel="$h/a_0$, thickness over bare contact radius")
            _mark_paper(axis, *paper)
            h, e = np.meshgrid(each.index, each.columns, indexing="ij")
            rows.add(title, h.ravel(), e.ravel(), 100.0 * each.to_numpy().ravel())
        axes[0].set_ylabel("$E_1/E_2$, film over body")
        bar = figure.colorbar(mesh, ax=axes, label="change by the film [%]", fraction=0.04, pad=0.02)
        ticks = [t for t in (1, 2, 5, 10, 20, 50, 100) if t <= largest]
        ticks = [-t for t in ticks[::-1]] + [0, *ticks]
        bar.set_ticks(ticks, labels=_signed(ticks))
        bar.ax.yaxis.set_minor_locator(NullLocator())
        looks = zip(LIMITS, LINES, strict=True)
        names = [
            Line2D([], [], color="black", linestyle=line, label=f"±{100 * limit:g} %")
            for limit, line in looks
        ]
        names.append(Line2D([], [], label="film of the paper on contact radii", **PAPER_LOOK))
        figure.legend(handles=names, loc="outside lower center", ncols=len(names))
    return Drawing(figure, rows)


def _signed(ticks: Sequence[float]) -> list[str]:
    return [f"{t:+g}".replace("-", "\N{MINUS SIGN}") if t else "0" for t in ticks]


def _draw_map(axis: Axes, each: DataFrame, norm: SymLogNorm):
    """Colours and lines of LIMITS of either sign, of a bicubic spline through the points over the
    logarithms.
    """
    thickness, modulus = each.index.to_numpy(), each.columns.to_numpy()
    spline = RectBivariateSpline(np.log(thickness), np.log(modulus), 100.0 * each.to_numpy())
    h, e = (np.geomspace(side.min(), side.max(), FINE) for side in (thickness, modulus))
    percent = spline(np.log(h), np.log(e)).T
    axis.set(xscale="log", yscale="log")
    mesh = axis.pcolormesh(h, e, percent, shading="gouraud", cmap="RdBu_r", norm=norm, rasterized=True)
    for limit, line in zip(LIMITS, LINES, strict=True):
        levels = [-100 * limit, 100 * limit]
        axis.contour(h, e, percent, levels, colors="black", linestyles=line, linewidths=1.2)
    axis.grid(False)
    for side, values in ((axis.xaxis, thickness), (axis.yaxis, modulus)):
        ticks = [t for t in TICKS if values.min() <= 1.001 * t <= 1.002 * values.max()]
        side.set_major_locator(FixedLocator(ticks))
        side.set_major_formatter(FuncFormatter(lambda t, _: f"{t:g}"))
        side.set_minor_locator(NullLocator())
    return mesh


def _mark_paper(axis: Axes, modulus: float, places: Mapping[str, float]) -> None:
    axis.plot(list(places.values()), [modulus] * len(places), **PAPER_LOOK)
    look = {"textcoords": "offset points", "ha": "center", "va": "top", "fontsize": 7.5}
    for label, place in places.items():
        axis.annotate(label, (place, modulus), xytext=(0, -5), **look)
