# SPDX-License-Identifier: MIT
"""One picture in space: VTK draws the bodies, matplotlib the title, the colour bar, the axes and the notes.

Lengths are in µm and z points up, out of the body. The view is a parallel projection from the side y < 0, so
that lengths along an axis are read off everywhere with the same ticks.
"""

import html
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyvista as pv
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.proj3d import proj_transform

from verification.figures.style import new_figure, style

TOWARDS = np.array([0.55, -1.0, 0.75])
"""Direction from the middle of the bodies to the eye: the cut y = const is seen from its open side."""
PIXELS = 1560
"""Side of the drawn square before it is written: twice that in the figure, which makes its edges smooth."""
OVER = "position: absolute; z-index: 9; pointer-events: none; top: 0.5em; font: 14px sans-serif"
"""Of what lies over the scene of a page."""
ADD_OVER = """<script type="module">
document.documentElement.append(document.getElementById("over").content)
</script>"""
"""The scene empties the body of its page: what lies over it waits in the head and is then added."""
COLOURS = "viridis"
LOW = 0.2
"""Of the width: bodies that are lower have less room for numbers along z."""
BODY = "#d0d0d0"
"""Of surfaces without a value."""
LIT = {"ambient": 0.4, "diffuse": 0.6, "specular": 0.0, "smooth_shading": True}
FLAT = {"lighting": False}
"""Colours as in the colour bar: nothing shaded."""


def length_unit(size: float) -> tuple[float, str]:
    """The unit of lengths up to a size in µm: how many of it are 1 µm, and its name."""
    return (1e3, "nm") if size < 0.1 else (1.0, "$\\mu$m")


@dataclass(frozen=True)
class Picture:
    """What is drawn, in µm and with heights times `exaggeration`. parts: (mesh, options of pyvista's
    `add_mesh`); "scalars" among them are coloured between `limits`; label: of the colour bar, with the unit;
    box: (3, 2), the ends of the axes.
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


def drawn(picture: Picture) -> Figure:
    """The picture as a figure of matplotlib in the house style: bodies behind axes of the same projection."""
    towards = TOWARDS / np.linalg.norm(TOWARDS)
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    across, up = right, np.cross(towards, right)
    middle, half = picture.box.mean(axis=1), 0.5 * np.linalg.norm(np.ptp(picture.box, axis=1))
    corners = middle + half * np.array([-across - up, across + up])
    ends, times = picture.box.copy(), [1.0, 1.0, picture.exaggeration]
    ends[2] /= picture.exaggeration
    with style():
        figure = new_figure(6.2, 4.4, "none")
        panel = figure.add_axes((-0.03, 0.1, 0.78, 0.86), projection="3d", proj_type="ortho")
        panel.set(xlim=ends[0], ylim=ends[1], zlim=ends[2], facecolor="none")
        (unit, name), upright = length_unit(np.abs(ends[2]).max()), np.ptp(picture.box[2])
        panel.set(xlabel="$x$ [$\\mu$m]", ylabel="$y$ [$\\mu$m]", zlabel=f"$z$ [{name}]")
        panel.set_box_aspect(np.ptp(picture.box, axis=1), zoom=1.05)
        panel.view_init(np.degrees(np.arcsin(towards[2])), np.degrees(np.arctan2(towards[1], towards[0])))
        panel.grid(False)
        for axis in (panel.xaxis, panel.yaxis, panel.zaxis):
            axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
            axis.set_major_locator(MaxNLocator(4))
            axis.labelpad = 6
        panel.zaxis.set_major_locator(MaxNLocator(2 if upright < LOW * np.ptp(picture.box[0]) else 4))
        panel.zaxis.set_major_formatter(lambda z, _: f"{unit * z:.4g}".replace("-", "\N{MINUS SIGN}"))
        figure.draw_without_rendering()
        x, y, _ = proj_transform(*(corners / times).T, panel.get_proj())
        (x0, y0), (x1, y1) = (panel.transData + figure.transFigure.inverted()).transform(np.stack([x, y], 1))
        bodies = figure.add_axes((x0, y0, x1 - x0, y1 - y0), zorder=-1)
        bodies.imshow(_pixels(picture, middle, half), interpolation="antialiased", aspect="auto")
        bodies.set_axis_off()
        figure.suptitle(picture.title, fontsize=9.5, fontweight="bold")
        colours = ScalarMappable(Normalize(*picture.limits), COLOURS)
        bar = figure.add_axes((0.87, 0.2, 0.02, 0.6))
        figure.colorbar(colours, cax=bar, label=picture.label).ax.grid(False)
        figure.text(0.99, 0.015, picture.said, ha="right", fontsize=8)
    return figure


def _pixels(picture: Picture, middle: np.ndarray, half: float) -> np.ndarray:
    """The bodies alone, on a transparent square of twice `half` around `middle`, (rows, columns, 4)."""
    plotter = pv.Plotter(off_screen=True, window_size=(PIXELS, PIXELS), lighting="none")
    add(plotter, picture)
    plotter.camera_position = [tuple(middle + 20.0 * half * TOWARDS), tuple(middle), (0.0, 0.0, 1.0)]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = half
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
