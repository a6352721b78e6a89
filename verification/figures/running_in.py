# SPDX-License-Identifier: MIT
"""The figure of a run that wears: six panels, as of Bosman & Schipper (2011), Figs. 13-17."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LightSource, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import History, Scar
from verification.figures.maps import coloured, draw_field, outline
from verification.figures.places import edges_of
from verification.figures.style import BLUE, GREY, ORANGE, VERMILION, Drawing, sheet

MICRO, GIGA = 1e6, 1e-9
MAP_AXES = {"xlabel": "$x$ [µm]", "ylabel": "$y$ [µm]"}
BELOW_PANEL = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.17), "fontsize": 7}


def six_panels(scar: Scar, history: History, friction: tuple[float, float]) -> Drawing:
    """(a) worn depth, (b) the worn surface in relief, (c) volume and (d) friction over the cycles, (e) local
    friction and (f) pressure at the last peak. friction: the low and the high coefficient.
    """
    x, y, nothing = MICRO * scar.x, MICRO * scar.y, " no wear"
    with sheet(10.6, 6.6, (2, 3)) as (figure, axes):
        (worn, relief, volume), (over_cycles, local, pressure) = axes
        depth = np.where(scar.worn > 0.0, 1e9 * scar.worn, np.nan)
        touching = np.where(scar.in_contact, GIGA * scar.p, np.nan)
        for panel, field, label, colours in (
            (worn, depth, "worn depth [nm]", "viridis"),
            (pressure, touching, "pressure [GPa]", "plasma"),
        ):
            if np.isfinite(field).any():
                coloured(panel, (x, y), field, label, cmap=colours, vmin=0.0)
            panel.set(xlim=_ends(x), ylim=_ends(y), facecolor=GREY, aspect="equal", **MAP_AXES)
            panel.grid(False)
        worn.set_title("(a) worn depth" + f":{nothing}" * (not (scar.worn > 0.0).any()))
        pressure.set_title("(f) pressure")
        _relief(relief, scar)
        removed = 1e18 * history.volume
        for panel, values in ((volume, removed), (over_cycles, history.friction)):
            panel.plot(history.cycle, values, color=BLUE, marker="o", markersize=3, linewidth=1.3)
            panel.set(xlabel="cycle", xlim=(0.0, history.cycle[-1] + 0.5))
            panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        top = 1.06 * removed.max() or 1.0
        volume.set(ylabel="volume [µm³]", ylim=(-0.05 * (not removed.any()), top))
        volume.set_title("(c) wear volume" + f":{nothing}" * (not removed.any()))
        room = 0.05 * (friction[1] - friction[0])
        over_cycles.set(title="(d) friction, this surface", ylabel="coefficient of friction")
        over_cycles.set_ylim(friction[0] - room, friction[1] + room)
        _local_friction(local, scar, friction)
    x, y = np.meshgrid(scar.x, scar.y, indexing="ij")  # a row a cell; the cycles are in cycles.csv of the run
    fields = {"x_m": x, "y_m": y, "height_m": scar.height, "worn_m": scar.worn, "p_Pa": scar.p}
    fields["friction"] = scar.friction
    return Drawing(figure, {name: field.ravel() for name, field in fields.items()})


def _ends(places: np.ndarray) -> tuple[float, float]:
    return edges_of(places)[0], edges_of(places)[-1]


def _relief(panel: Axes, scar: Scar) -> None:
    """The worn surface around its scar or contact, as if lit from the upper left, with the scar's edge."""
    marked, near = scar.worn > 0.0 if (scar.worn > 0.0).any() else scar.in_contact, []
    for axis in (1, 0):
        cells = np.flatnonzero(marked.any(axis=axis)) if marked.any() else np.arange(marked.shape[1 - axis])
        beside = max(4, (cells[-1] - cells[0]) // 3)
        near.append(slice(max(0, cells[0] - beside), cells[-1] + beside + 1))
    x, y, height = MICRO * scar.x[near[0]], MICRO * scar.y[near[1]], (scar.height - scar.worn)[*near]
    steep = np.std(np.gradient(height, x, y)) or 1.0
    sun = LightSource(azdeg=315.0, altdeg=40.0)
    light = sun.hillshade(height.T, vert_exag=1.0 / steep, dx=x[1] - x[0], dy=y[1] - y[0])
    how = {"origin": "lower", "extent": (*_ends(x), *_ends(y)), "interpolation": "bilinear"}
    panel.imshow(np.repeat(light[..., None], 3, axis=2), **how)
    panel.grid(False)
    removed, edge = scar.worn[*near] > 0.0, {"color": VERMILION, "linewidth": 1.0}
    if removed.any():
        outline(panel, x, y, removed, **edge)
        panel.legend(handles=[Line2D([], [], **edge, label="edge of what is worn")], **BELOW_PANEL)
    panel.set(title=f"(b) {'worn ' * bool(removed.any())}surface in relief", **MAP_AXES)


def _local_friction(panel: Axes, scar: Scar, friction: tuple[float, float]) -> None:
    """Where there is no contact, and where friction is low or high."""
    low, high = friction
    looks = {"no contact": GREY, f"μ = {low:g}, film whole": BLUE, f"μ = {high:g}, film failed": ORANGE}
    state = np.where(scar.in_contact, np.where(scar.unprotected(*friction), 2, 1), 0)
    how = {"cmap": ListedColormap(list(looks.values())), "norm": BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3)}
    draw_field(panel, MICRO * scar.x, MICRO * scar.y, state, **how)
    panel.set(title="(e) local friction", **MAP_AXES)
    patches = [Patch(facecolor=colour, label=words) for words, colour in looks.items()]
    panel.legend(handles=patches, **BELOW_PANEL, ncols=3, handlelength=1.2)
