# SPDX-License-Identifier: MIT
"""Curves against a closed form or FEM, with the errors underneath."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from sam.scene import Result
from verification.figures.lines import MICRO, PERCENT, POINTS
from verification.figures.maps import INTERFACE, mark_interface
from verification.figures.style import EXACT, FEM, SAM, Columns, Drawing, new_figure, sheet, style, zero_line
from verification.reference.hertz import CircularContact
from verification.runs.sampling import rows_of


@dataclass(frozen=True)
class Profile:
    """One panel above its errors: an exact curve, the computed series, and what their difference is divided
    by. exact: x -> y (vectorised); series: "SAM" or "FEM" -> (x, y); scale: the error is 100 (y - exact) /
    scale; xlim: what is shown (and written).
    """

    title: str
    xlabel: str
    ylabel: str
    exact: Callable[[np.ndarray], np.ndarray]
    series: Mapping[str, tuple[np.ndarray, np.ndarray]]
    scale: float
    scale_name: str
    xlim: tuple[float, float]


CLOSED_FORM = "closed form"


def profiles(
    panels: Sequence[Profile], reference: str = CLOSED_FORM, *, interface: float | None = None
) -> Drawing:
    """Each panel above its error in %, more than three in two columns; interface: end of a film."""
    rows, across = profile_rows(reference), len(panels) if len(panels) <= 3 else 2
    bands = -(-len(panels) // across)
    size = max(3.3 * across, 5.0), 4.2 * bands
    with sheet(*size, (2 * bands, across), height_ratios=(3, 1.3) * bands) as (figure, axes):
        for k, panel in enumerate(panels):
            band, column = divmod(k, across)
            upper, lower = axes[2 * band : 2 * band + 2, column]
            draw_profile((upper, lower), panel, reference, rows)
            if interface is not None:
                mark_interface((upper, lower), interface)
        entries = axes[0, 0].get_legend_handles_labels()[0] + [INTERFACE] * (interface is not None)
        figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
        figure.align_ylabels()
    return Drawing(figure, rows)


def profile_rows(reference: str) -> Columns:
    """The empty columns that `draw_profile` fills."""
    return Columns("panel", "series", "x", "value", reference.replace(" ", "_"), "error_percent")


def draw_profile(axes: tuple[Axes, Axes], panel: Profile, reference: str, rows: Columns) -> None:
    """A panel above its error; its numbers are added to `rows`."""
    upper, lower = axes

    def off(y: np.ndarray, exact: np.ndarray) -> np.ndarray:
        return PERCENT * (y - exact) / panel.scale

    for name, (x, y) in panel.series.items():
        x, y = x[inside := (x >= panel.xlim[0]) & (x <= panel.xlim[1])], y[inside]
        exact = panel.exact(x)
        look = {"SAM": SAM, "FEM": FEM}[name]
        upper.plot(x, y, **look, label=name)
        lower.plot(x, off(y, exact), **look)
        rows.add(panel.title, name, x, y, exact, off(y, exact))
    low, high = panel.xlim
    dense = np.linspace(low, high, 801)
    upper.plot(
        dense, panel.exact(dense), **EXACT | (FEM if reference == "FEM" else {}), label=reference, zorder=3
    )
    lower.sharex(upper)
    upper.set(title=panel.title, ylabel=panel.ylabel, xlim=(low, high))
    upper.tick_params(labelbottom=False)
    zero_line(lower)
    word = "error" if reference == CLOSED_FORM else "difference"
    lower.set(xlabel=panel.xlabel, ylabel=f"{word}\n[% of {panel.scale_name}]")


def against_fem(labels: tuple[str, str, str], sam: tuple, fem: tuple, limits: tuple[float, float]) -> Profile:
    """SAM over the curve of FEM, errors in % of the largest value of FEM. labels: title, of x and of y."""
    x, y = fem
    limits = (max(limits[0], x.min()), min(limits[1], x.max()))
    scale = np.max(np.abs(y[(x >= limits[0]) & (x <= limits[1])]))
    return Profile(*labels, lambda at: np.interp(at, x, y), {"SAM": sam}, scale, "the largest", limits)


def residual_surface(sam: Result, fem: Result, hertz: CircularContact, reach: float = 2.0) -> Drawing:
    """What is left of the surface, and force over approach with unloading, beside the elastic curve."""
    a, rows = hertz.contact_radius, profile_rows("FEM")
    found = []
    for result in (sam, fem):
        x, u = rows_of(result.tables["line"], "unloaded", "x_m", "uz_m")
        found.append((x[x >= 0.0] / a, 1e3 * MICRO * u[x >= 0.0]))
    panel = against_fem(("Residual surface", "$x/a$", "$u_z$, into the body [nm]"), *found, (0.0, reach))
    with style():
        figure = new_figure(8.4, 3.9)
        axes = figure.subplot_mosaic([["u", "f"], ["e", "f"]], height_ratios=(3, 1.3), width_ratios=(1, 1.15))
        draw_profile((axes["u"], axes["e"]), panel, "FEM", rows)
        axes["u"].invert_yaxis()
        axes["u"].legend()
        for name, result in (("SAM", sam), ("FEM", fem)):
            history = result.tables["history"]
            approach, force = (np.asarray(history[of], dtype=float) for of in ("approach_m", "force_N"))
            approach, top = MICRO * approach, int(np.argmax(force)) + 1
            start = top - 1 if force.size > top + 1 else top
            axes["f"].plot(approach[:top], force[:top], **POINTS[name], markersize=5, label=name)
            axes["f"].plot(approach[start:], force[start:], **POINTS[name], markersize=5)
            rows.add("Force [N] over approach [um]", name, approach, force, None, None)
        share = np.linspace(0.0, 1.0, 101)
        elastic = MICRO * hertz.approach * share ** (2 / 3), hertz.force * share
        axes["f"].plot(*elastic, **EXACT, label="elastic (Hertz)")
        axes["f"].set(title="Load and approach", xlabel=r"approach [$\mu$m]", ylabel="force [N]")
        axes["f"].legend()
        figure.align_ylabels([axes["u"], axes["e"]])
    return Drawing(figure, rows)
