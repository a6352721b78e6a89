# SPDX-License-Identifier: MIT
"""Maps of one run: fields in a plane, pressure and friction over the contact, wear."""

import numpy as np
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import Scar
from verification.figures.maps import (
    BAR,
    CROSS,
    INTERFACE,
    MapPeak,
    coloured,
    draw_field,
    iso_lines,
    mark_interface,
    mark_largest,
    mark_levels,
    mark_spots,
    name_marks,
    outline,
)
from verification.figures.places import (
    REACH,
    YIELDED,
    Section,
    SurfaceMap,
    in_film,
    interface_of,
    is_circular,
    plane_of,
    spots_of,
)
from verification.figures.style import EXACT, SAM, Drawing, sheet
from verification.runs.files import Run

MICRO, GIGA, PERCENT, NANO = 1e6, 1e-9, 1e2, 1e9
UNITS = {"mises_Pa": (GIGA, "GPa"), "peeq": (PERCENT, "%"), "p_Pa": (GIGA, "GPa"), "friction": (1.0, "")}
"""Column -> factor and name of the unit in which it is drawn."""
DIGITS = 5e-4
"""Relative; values that differ by less are one number in four digits."""


def plane_map(run: Run, section: Section, column: str, label: str) -> Drawing:
    """A column at the peak in the plane of a section, with iso-lines, contact and its maximum; in contact
    radii of a circle around the origin, else in µm, around the spot of the largest pressure and what is
    around the largest value. Plastic strain is drawn as far as its zone around the largest value reaches.
    """
    (unit, _), film = UNITS[column], interface_of(run)
    x, z, values = plane_of(run, section, column)
    at, shown = float(x[np.unravel_index(np.nanargmax(values), values.shape)[0]]), np.full(z.shape, True)
    if circular := is_circular(run):
        length = run.quantities["contact_radius_m"]
        names, last = ("$x/a$", "$z/a$"), REACH * length * (1.0 + 1e-9)
        first = -last
    else:
        where = f" at $y$ = {MICRO * section.y:.4g} $\\mu$m" if section.source != "plane" else ""
        length, names = 1.0 / MICRO, (f"$x$ [$\\mu$m]{where}", "$z$ [$\\mu$m]")
        (first, last), beside = section.reach, 0.25 * np.ptp(section.reach)
        first, last = min(first, at - beside), max(last, at + beside)
    if column == "peeq" and np.nanmax(values) > 0.0:
        strained = values > YIELDED * np.nanmax(values)
        zone = next(ends for ends in spots_of(x, strained.any(axis=1)) if ends[0] <= at <= ends[1])
        below, margin = (x > zone[0]) & (x < zone[1]), max(0.25 * np.ptp(zone), 1.5 * np.diff(x).min())
        shown = z <= max(z[strained[below].any(axis=0)][-1] + margin, z[1])
        if not circular:
            first, last = zone[0] - margin, zone[1] + margin
    use = (x >= first) & (x <= last)
    z, u, v, field = z[shown], x[use] / length, z[shown] / length, unit * values[np.ix_(use, shown)]
    top = _largest(run, section, column, (u, v, field))
    with sheet(5.4, 3.8, layout="compressed") as (figure, panel):
        mesh = draw_field(panel, u, v, field, cmap="viridis", vmin=0.0, vmax=top.value or 1.0)
        levels = MaxNLocator(7).tick_values(0.0, top.value or 1.0)[1:]
        for layer in [z >= 0.0] if film is None else [in_film(z, film), ~in_film(z, film)]:
            if np.count_nonzero(layer) > 1 and np.nanmax(field[:, layer], initial=0.0) >= levels[0]:
                iso_lines(panel, (u, v[layer]), field[:, layer], levels)
        mark_largest(panel, top)
        inside = [(max(a, x[use][0]), min(b, x[use][-1])) for a, b in section.spots]
        mark_spots(panel, [(a / length, b / length) for a, b in inside if a < b])
        panel.invert_yaxis()
        panel.set(xlabel=names[0], ylabel=names[1])
        if film is not None:
            mark_interface([panel], film / length, across=True)
        mark_levels(figure.colorbar(mesh, ax=panel, label=label), levels)
        name_marks(figure, [BAR, CROSS, *([INTERFACE] if film is not None else [])])
    places = (each.ravel() for each in np.meshgrid(u, v, indexing="ij"))
    columns = ("x/a", "z/a") if circular else ("x_um", "z_um")
    return Drawing(figure, dict(zip((*columns, label), (*places, field.ravel()), strict=True)))


def _largest(run: Run, section: Section, column: str, drawn_as: tuple[np.ndarray, ...]) -> MapPeak:
    """The largest value that is drawn, and in words also that of summary.json, where it is another number."""
    u, v, field = drawn_as
    i, k = np.unravel_index(np.nanargmax(field), field.shape)
    (unit, name), drawn = UNITS[column], float(field[i, k])
    place = f"$x$ = {u[i]:.4g}, $z$ = {v[k]:.4g} $\\mu$m"
    words = f"max {drawn:#.4g} {name} at {f'$z/a$ = {v[k]:.3f}' if is_circular(run) else place}"
    anywhere = unit * run.quantities["mises_max_Pa" if column == "mises_Pa" else "peeq_max"]
    if abs(anywhere - drawn) > DIGITS * anywhere:
        refined = section.source != "cut" and run.model != "fem-3d"
        where = "refined between the points" if refined else "anywhere, refined"
        words = f"{words}\n{where} {anywhere:#.4g} {name}"
    return MapPeak(float(u[i]), float(v[k]), drawn, words)


def contact_map(surface: SurfaceMap, column: str, label: str) -> Drawing:
    """A field over the contact, with its outline and the largest value of the cells that count."""
    (unit, name), touching = UNITS[column], surface.touching
    x, y, field = MICRO * surface.x, MICRO * surface.y, unit * surface.in_contact(column)
    with sheet(5.0, 3.8, layout="compressed") as (figure, panel):
        top = float(np.nanmax(field)) if np.isfinite(field).any() else 0.0
        colours = draw_field(panel, x, y, field, cmap="viridis", vmin=0.0, vmax=top or 1.0)
        if touching.any():
            outline(panel, x, y, touching)
            i, j = surface.largest(column)
            unit_words = f" {name}".rstrip()
            words = f"max {field[i, j]:#.4g}{unit_words} at $x$ = {x[i]:.3g}, $y$ = {y[j]:.3g} $\\mu$m"
            if any(surface.border):
                words += "\n(within the dashed frame)"
                (bx, by), hx, hy = surface.border, x[1] - x[0], y[1] - y[0]
                size = (x[-1 - bx] - x[bx] + hx, y[-1 - by] - y[by] + hy)
                look = {"facecolor": "none", "edgecolor": "black", "linestyle": "--", "linewidth": 0.8}
                panel.add_patch(Rectangle((x[bx] - 0.5 * hx, y[by] - 0.5 * hy), *size, **look))
            mark_largest(panel, MapPeak(float(x[i]), float(y[j]), float(field[i, j]), words))
        if np.ptp(np.diff(x)) > DIGITS * np.ptp(x):  # a mesh that reaches far beyond the contact
            for along, places, marked in (("x", x, touching.any(axis=1)), ("y", y, touching.any(axis=0))):
                first, last = places[marked][[0, -1]]
                ends = max(places[0], 2 * first - last), min(places[-1], 2 * last - first)
                panel.set(**{f"{along}lim": ends})
        panel.set(xlabel="$x$ [$\\mu$m]", ylabel="$y$ [$\\mu$m]")
        figure.colorbar(colours, ax=panel, label=label)
    places = np.meshgrid(surface.x, surface.y, indexing="ij")
    return Drawing(figure, {"x_m": places[0].ravel(), "y_m": places[1].ravel(), column: field.ravel() / unit})


def worn(run: Run) -> Drawing:
    """The depth worn at last, and the surface before and after along the row through its deepest cell."""
    scar = Scar.of(run.tables)
    i, j = np.unravel_index(np.nanargmax(scar.worn), scar.worn.shape)
    x, y, depth = MICRO * scar.x, MICRO * scar.y, NANO * np.where(scar.worn > 0.0, scar.worn, np.nan)
    top = float(NANO * scar.worn[i, j])
    with sheet(8.6, 3.6, 2) as (figure, (left, right)):
        coloured(left, (x, y), depth, "depth worn [nm]", cmap="viridis", vmin=0.0, vmax=top or 1.0)
        left.set(xlabel="$x$ [$\\mu$m]", ylabel="$y$ [$\\mu$m]")
        words = f"max {top:#.4g} nm at $x$ = {x[i]:.3g}, $y$ = {y[j]:.3g} $\\mu$m"
        mark_largest(left, MapPeak(float(x[i]), float(y[j]), top, words if top else "nothing is worn"))
        height = MICRO * scar.height[:, j]
        right.plot(x, height, **EXACT, label="before wear")
        right.plot(x, height - MICRO * scar.worn[:, j], **SAM, label="worn")
        right.set(xlabel=f"$x$ [$\\mu$m] at $y$ = {y[j]:.4g} $\\mu$m", ylabel="height [$\\mu$m]")
        right.legend()
    places = np.meshgrid(scar.x, scar.y, indexing="ij")
    columns = {"x_m": places[0], "y_m": places[1], "height_m": scar.height, "worn_m": scar.worn}
    return Drawing(figure, {name: values.ravel() for name, values in columns.items()})
