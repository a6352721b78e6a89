# SPDX-License-Identifier: MIT
"""One picture in space: VTK draws the bodies, matplotlib the title, the colour bar, the axes and the notes.

Lengths are in µm and z points up, out of the body. The view is a parallel projection from the side y < 0, so
that lengths along an axis are read off everywhere with the same ticks.
"""

from __future__ import annotations

import html
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from verification.figures.style import new_figure, style

TOWARDS = np.array([0.55, -1.0, 0.75])
"""Direction from the middle of the bodies to the eye: the cut y = const is seen from its open side."""
PIXELS = 1560
"""Width of the drawn part before it is written: twice that in the figure, which makes its edges smooth."""
OVER = "position: absolute; z-index: 9; pointer-events: none; top: 0.5em; font: 14px sans-serif"
"""Of what lies over the scene of a page."""
ADD_OVER = """<script type="module">
document.documentElement.append(document.getElementById("over").content)
</script>"""
"""The scene empties the body of its page: what lies over it waits in the head and is then added."""
WIDTH, DRAWN, MARGINS, BAR = 6.2, 3.9, (0.7, 0.45, 0.4), 2.6
"""In inches: the width of the figure and that of the bodies in it, the margins to the left, below and above
them, and the length of the colour bar."""
COLOURS = "viridis"
BODY = "#d0d0d0"
"""Of surfaces without a value."""
LIT = {"ambient": 0.4, "diffuse": 0.6, "specular": 0.0, "smooth_shading": True}
UPRIGHT, APART = 2, 0.35
"""The axis z, and inches between ticks at least."""
FLAT = {"lighting": False}
"""Colours as in the colour bar: nothing shaded."""


@dataclass(frozen=True)
class Picture:
    """What is drawn, in µm and with heights times `exaggeration`.

    parts: (mesh, options of pyvista's `add_mesh`); "scalars" among them are coloured between
    `limits`; label: of the colour bar, with the unit; box: (3, 2), the ends of the axes.
    """

    title: str
    label: str
    limits: tuple[float, float]
    parts: Sequence[tuple[pv.DataSet, Mapping[str, Any]]]
    box: np.ndarray
    exaggeration: float = 1.0
    note: str = ""

    @property
    def said(self) -> str:
        """What must be known to read the picture, empty without exaggeration and note."""
        times = "" if self.exaggeration == 1.0 else f"heights \N{MULTIPLICATION SIGN} {self.exaggeration:g}"
        return "; ".join(filter(None, (times, self.note)))


@dataclass(frozen=True)
class _Projection:
    """The parallel projection of a box: unit vectors on the screen, and the middle and the size of
    what is seen.
    """

    right: np.ndarray
    up: np.ndarray
    centre: np.ndarray
    half: np.ndarray

    @classmethod
    def of(cls, box: np.ndarray) -> _Projection:
        towards = TOWARDS / np.linalg.norm(TOWARDS)
        right = np.cross([0.0, 0.0, 1.0], towards)
        right /= np.linalg.norm(right)
        up = np.cross(towards, right)
        corners = np.stack(np.meshgrid(*box, indexing="ij"), axis=-1).reshape(-1, 3)
        seen = np.stack([corners @ right, corners @ up])
        middle = 0.5 * (seen.max(axis=1) + seen.min(axis=1))
        about = corners.mean(axis=0)
        centre = about + (middle[0] - about @ right) * right + (middle[1] - about @ up) * up
        return cls(right, up, centre, 0.505 * np.ptp(seen, axis=1))

    def place(self, *points: Sequence[float]) -> np.ndarray:
        """Points in µm on the screen, (n, 2)."""
        return np.stack([(np.array(points) - self.centre) @ axis for axis in (self.right, self.up)], axis=1)


def drawn(picture: Picture) -> Figure:
    """The picture as a figure of matplotlib in the house style."""
    view = _Projection.of(picture.box)
    with style():
        (width, height), pixels = view.half, _pixels(picture, view)
        figure, panel, bar = _sheet(height / width)
        panel.imshow(pixels, extent=(-width, width, -height, height), interpolation="antialiased", zorder=2)
        figure.suptitle(picture.title, fontsize=9.5, fontweight="bold")
        _axes(panel, picture, view)
        figure.colorbar(ScalarMappable(Normalize(*picture.limits), COLOURS), cax=bar, label=picture.label)
        bar.grid(False)
        if picture.said:
            figure.text(0.99, 0.06 / figure.get_figheight(), picture.said, ha="right", fontsize=8)
    return figure


def _sheet(flat: float) -> tuple[Figure, Axes, Axes]:
    """An empty figure for bodies `flat` times as high as wide, the axes of these, and of the colour bar."""
    left, below, above = MARGINS
    high = DRAWN * flat + below + above
    figure = new_figure(WIDTH, high, "none")
    panel = figure.add_axes((left / WIDTH, below / high, DRAWN / WIDTH, DRAWN * flat / high))
    panel.set_axis_off()
    length = min(BAR, 0.9 * (high - above))
    return (
        figure,
        panel,
        figure.add_axes((5.25 / WIDTH, 0.5 * (1.0 - length / high), 0.13 / WIDTH, length / high)),
    )


def _pixels(picture: Picture, view: _Projection) -> np.ndarray:
    """The bodies alone, (rows, columns, 4), on a transparent background."""
    size = (PIXELS, round(PIXELS * view.half[1] / view.half[0]))
    plotter = pv.Plotter(off_screen=True, window_size=size, lighting="none")
    add(plotter, picture)
    eye = view.centre + 10.0 * np.ptp(picture.box) * TOWARDS
    plotter.camera_position = [tuple(eye), tuple(view.centre), (0.0, 0.0, 1.0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = view.half[1]
    plotter.reset_camera_clipping_range()
    pixels = plotter.screenshot(return_img=True, transparent_background=True)
    plotter.close()
    return pixels


def add(plotter: pv.Plotter, picture: Picture) -> None:
    """The bodies and two white lights, one from the left and one from the eye."""
    for place, strength in (((-1.0, -0.6, 1.4), 0.6), (tuple(TOWARDS), 0.4)):
        light = pv.Light(position=place, intensity=strength, light_type="scene light")
        light.positional = False
        plotter.add_light(light)
    for mesh, options in picture.parts:
        coloured = {"clim": picture.limits, "cmap": COLOURS, "show_scalar_bar": False, "nan_color": BODY}
        plotter.add_mesh(mesh, **(coloured if "scalars" in options else {}) | dict(options))


def _axes(panel: Axes, picture: Picture, view: _Projection) -> None:
    """Three edges of the box with ticks and the others behind the bodies; z says the lengths before
    their exaggeration.
    """
    (x0, x1), (y0, y1), (z0, z1) = picture.box
    hidden = [((x0, y0, z0), (x0, y1, z0)), ((x0, y1, z0), (x1, y1, z0)), ((x0, y1, z0), (x0, y1, z1))]
    for edge in hidden:
        panel.plot(*view.place(*edge).T, color="#bbbbbb", linewidth=0.6, zorder=1)
    _edge(panel, view, ((x0, y0, z0), (x1, y0, z0)), out=(0.0, -1.0, 0.0), label="$x$ [$\\mu$m]")
    _edge(panel, view, ((x1, y0, z0), (x1, y1, z0)), out=(1.0, 0.0, 0.0), label="$y$ [$\\mu$m]")
    upright, times = ((x0, y0, z0), (x0, y0, z1)), picture.exaggeration
    _edge(panel, view, upright, out=(-1.0, 0.0, 0.0), label="$z$ [$\\mu$m]", times=times)


def _edge(
    panel: Axes,
    view: _Projection,
    ends: tuple[Sequence[float], Sequence[float]],
    *,
    out: Sequence[float],
    label: str,
    times: float = 1.0,
) -> None:
    """An edge between two corners with ticks towards `out` and its label: beside its middle, or
    above its end where it is upright.
    """
    first, last = np.array(ends)
    along = int(np.argmax(np.abs(last - first)))
    panel.plot(*view.place(first, last).T, color="#444444", linewidth=0.8, zorder=3, clip_on=False)
    towards = view.place(view.centre + np.array(out))[0]
    towards /= np.linalg.norm(towards)
    inch = 2.0 * view.half[0] / DRAWN
    low, high = first[along] / times, last[along] / times
    length = np.linalg.norm(np.diff(view.place(first, last), axis=0)) / inch
    values = MaxNLocator(min(max(int(length / APART), 1), 5)).tick_values(low, high)
    side = "center" if abs(towards[0]) < 0.3 else "left" if towards[0] > 0.0 else "right"
    look = {"fontsize": 8, "ha": side, "va": "top" if towards[1] < -0.3 else "center"}
    rounding = 1e-9 * (high - low)
    for value in values[(values >= low - rounding) & (values <= high + rounding)]:
        point = first.copy()
        point[along] = value * times
        (at,) = view.place(point)
        tick = np.array([at, at + 0.05 * inch * towards])
        panel.plot(*tick.T, color="#444444", linewidth=0.8, clip_on=False)
        panel.text(*(at + 0.08 * inch * towards), f"{value + 0.0:.6g}".replace("-", "\N{MINUS SIGN}"), **look)
    if along == UPRIGHT:
        panel.text(*(view.place(last)[0] + [0.0, 0.12 * inch]), label, ha="right", fontsize=9)
    else:
        middle = view.place(0.5 * (first + last))[0]
        panel.text(*(middle + 0.36 * inch * towards), label, **look | {"fontsize": 9})


def page(picture: Picture) -> str:
    """The picture as one HTML page that turns in a browser and needs no network."""
    import trame_pyvista  # noqa: F401, PLC0415 - gives a plotter its `trame`

    plotter = pv.Plotter(off_screen=True, window_size=(1200, 800), lighting="none")
    add(plotter, picture)
    names = {"xtitle": "x [um]", "ytitle": "y [um]", "ztitle": ""}  # beside a short axis there is no place
    plotter.show_bounds(bounds=picture.box.ravel(), color="black", **names)
    plotter.view_vector(tuple(TOWARDS), viewup=(0.0, 0.0, 1.0))
    text = plotter.trame.export_html(None).read()
    title = html.escape(picture.title.replace("$", "").replace("\\mu", "\N{MICRO SIGN}"))
    text = re.sub("<title>.*?</title>", f"<title>{title}</title>", text, count=1)
    upright = f"upright axis: {picture.exaggeration:g} z [um]".replace(": 1 z", ": z")
    said = "; ".join(filter(None, (picture.said, upright)))
    caption = f'<div style="{OVER}; left: 1em">{title}<br>{html.escape(said)}</div>'
    bar = f'<div style="{OVER}; right: 1em">{_bar(picture)}</div>'
    over = f'<template id="over">{caption}{bar}</template></head>'
    return text.replace("</head>", over, 1).replace("</html>", f"{ADD_OVER}</html>")


def _bar(picture: Picture) -> str:
    """The colour bar as SVG."""
    buffer = io.StringIO()
    with style():
        figure = new_figure(1.1, 3.2)
        colours = ScalarMappable(Normalize(*picture.limits), COLOURS)
        figure.colorbar(colours, cax=figure.subplots(), label=picture.label).ax.grid(False)
        figure.savefig(buffer, format="svg", metadata={"Date": None}, transparent=True)
    return buffer.getvalue().partition("<svg")[1] + buffer.getvalue().partition("<svg")[2]
