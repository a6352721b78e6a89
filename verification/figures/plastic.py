# SPDX-License-Identifier: MIT
"""The figures of one elasto-plastic contact: plastic strain, stresses that stay, residual surface, load and
approach.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from sam.scene import Result
from verification.figures.iso_numbers import readable
from verification.figures.maps import FieldPair, plane_maps
from verification.figures.profiles import Profile, draw_profile, profile_rows, profiles
from verification.figures.style import EXACT, FEM, SAM, Drawing, new_figure, style
from verification.figures.views import PLANE_AXES, peak_of
from verification.reference.hertz import CircularContact
from verification.runs.sampling import plane_field, plane_field_on, rows_of

LINE = 0.2  # %: the proof strain of tensile tests
MICRO, GIGA, PERCENT = 1e6, 1e-9, 1e2
_POINTS = {"SAM": SAM | {"marker": "o", "fillstyle": "none"}, "FEM": FEM | {"marker": "x"}}


def compared_peeq(sam: Result, fem: Result, a: float, *, reach: float = 1.5, deep: float = 1.9) -> Drawing:
    """Plastic strain in % in y = 0, |x/a| <= reach, z/a <= deep: SAM | FEM | difference, with the iso-line of
    0.2 %.

    a: length unit, the elastic contact radius in m; the bar over the maps is the contact of FEM.
    """
    x, z, peeq = plane_field(sam.tables, "peeq")
    use_x, use_z = np.abs(x) <= reach * a, z <= deep * a
    x, z, peeq = x[use_x], z[use_z], peeq[np.ix_(use_x, use_z)]
    fields = (PERCENT * peeq, PERCENT * plane_field_on(x, z, fem.tables, "peeq"))
    edge = fem.quantities["contact_radius_m"] / a
    pair = FieldPair(x / a, z / a, *fields, ("SAM", "FEM"), PLANE_AXES, "plastic strain [%]", (edge, edge))
    quoted = [(r.quantities["peeq_max_depth_m"] / a, PERCENT * r.quantities["peeq_max"]) for r in (sam, fem)]
    peaks = [peak_of(pair.u, field, *values) for field, values in zip(fields, quoted, strict=True)]
    levels = iso_lines(max(largest for _, largest in quoted))
    return readable(lambda left: plane_maps(pair, peaks, left), levels, keep=(LINE,))


def iso_lines(largest: float) -> np.ndarray:
    """Levels in % up to the largest strain: round numbers, and 0.2 % whenever it is reached."""
    ticks = MaxNLocator(6).tick_values(0.0, largest)
    apart = ticks[(ticks > 0.0) & (ticks < largest) & (np.abs(ticks - LINE) > 0.25 * ticks[1])]
    return np.union1d(apart, [LINE] if largest > LINE else [])


def axis_profiles(sam: Result, fem: Result, a: float, deep: float = 2.0) -> Drawing:
    """Under the centre: plastic strain and von Mises stress at the peak, von Mises and lateral stress when
    unloaded.
    """
    wanted = (
        ("Plastic strain", "plastic strain [%]", "peak", "peeq", PERCENT),
        ("Von Mises, at the peak", r"$\sigma_\mathrm{vM}$ [GPa]", "peak", "mises_Pa", GIGA),
        ("Von Mises, unloaded", r"$\sigma_\mathrm{vM}$ [GPa]", "unloaded", "mises_Pa", GIGA),
        ("Residual lateral stress", r"$\sigma_{xx}$ [GPa]", "unloaded", "sxx_Pa", GIGA),
    )
    panels = []
    for title, label, state, column, unit in wanted:
        found = [
            (z / a, unit * v)
            for z, v in (rows_of(r.tables["axis"], state, "z_m", column) for r in (sam, fem))
        ]
        panels.append(_against_fem((title, "$z/a$", label), *found, (0.0, deep)))
    return profiles(panels, reference="FEM")


def _against_fem(
    labels: tuple[str, str, str], sam: tuple, fem: tuple, limits: tuple[float, float]
) -> Profile:
    """SAM over the curve of FEM, within what both cover; errors in % of the largest value of FEM.

    labels: title, of x and of y.
    """
    x, y = fem
    limits = (max(limits[0], x.min()), min(limits[1], x.max()))
    scale = np.max(np.abs(y[(x >= limits[0]) & (x <= limits[1])]))
    return Profile(*labels, lambda at: np.interp(at, x, y), {"SAM": sam}, scale, "max", limits)


def residual_surface(sam: Result, fem: Result, hertz: CircularContact, reach: float = 2.0) -> Drawing:
    """What is left of the surface after unloading, and the force over the approach with unloading."""
    a, rows = hertz.contact_radius, profile_rows("FEM")
    found = []
    for result in (sam, fem):
        x, u = rows_of(result.tables["line"], "unloaded", "x_m", "uz_m")
        found.append((x[x >= 0.0] / a, 1e3 * MICRO * u[x >= 0.0]))
    panel = _against_fem(("Residual surface", "$x/a$", "$u_z$, into the body [nm]"), *found, (0.0, reach))
    with style():
        figure = new_figure(8.4, 3.9)
        axes = figure.subplot_mosaic([["u", "f"], ["e", "f"]], height_ratios=(3, 1.3), width_ratios=(1, 1.15))
        draw_profile((axes["u"], axes["e"]), panel, "FEM", rows)
        axes["u"].invert_yaxis()
        axes["u"].legend()
        for name, result in (("SAM", sam), ("FEM", fem)):
            rows.add("Force [N] over approach [um]", name, *_load_curve(axes["f"], name, result), None, None)
        _hertz_curve(axes["f"], hertz)
        axes["f"].legend()
        figure.align_ylabels([axes["u"], axes["e"]])
    return Drawing(figure, rows)


def _load_curve(panel: Axes, name: str, result: Result) -> tuple[np.ndarray, np.ndarray]:
    """The history, loading and unloading apart; returns (approach in um, force in N).

    Unloading in one step is a single point: a line to it would be no load curve.
    """
    history = result.tables["history"]
    approach, force = (np.asarray(history[name], dtype=float) for name in ("approach_m", "force_N"))
    approach, peak = MICRO * approach, int(np.argmax(force)) + 1
    start = peak - 1 if force.size > peak + 1 else peak
    panel.plot(approach[:peak], force[:peak], **_POINTS[name], markersize=5, label=name)
    panel.plot(approach[start:], force[start:], **_POINTS[name], markersize=5)
    return approach, force


def _hertz_curve(panel: Axes, hertz: CircularContact) -> None:
    share = np.linspace(0.0, 1.0, 101)
    panel.plot(
        MICRO * hertz.approach * share ** (2 / 3), hertz.force * share, **EXACT, label="elastic (Hertz)"
    )
    panel.set(title="Load and approach", xlabel=r"approach [$\mu$m]", ylabel="force [N]")
