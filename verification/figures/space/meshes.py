# SPDX-License-Identifier: MIT
"""What the pictures in space are made of: the surface, a plane y = const and the plastic zone of a
run, as meshes in µm whose z points up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import pyvista as pv

from sam.scene import PEAK, UNLOADED
from verification.figures.places import Section, plane_of, section_of, surface_map
from verification.runs.files import Run, mesh_of

MICRO = 1e6
FILES = {PEAK: "surface.vtr", UNLOADED: "surface-unloaded.vtr"}
"""State -> file with the surface."""
TURNS, REACH, POINTS = 61, 2.0, 161
"""Of an axisymmetric run: steps of half a turn, and the square that is drawn, in contact radii, with its
points along x and y."""

_mesh = cache(mesh_of)
"""Each file once in a process, which draws and ends."""


@dataclass(frozen=True)
class Sheet:
    """The surface in a state.

    x (nx,), y (ny,): its nodes in µm; raised: the displacement of the nodes upwards in µm, (nx,
    ny), None where it is not known; fields: name of a column -> values in its unit, at the nodes
    (nx, ny) or in the cells between them (nx - 1, ny - 1).
    """

    x: np.ndarray
    y: np.ndarray
    raised: np.ndarray | None
    fields: Mapping[str, np.ndarray]

    def at_nodes(self, name: str) -> np.ndarray:
        """A field at the nodes, the mean of the cells around each; zero without it."""
        values = self.fields.get(name, np.zeros((self.x.size, self.y.size)))
        if values.shape == (self.x.size, self.y.size):
            return values
        wide = np.pad(values, 1, mode="edge")
        return 0.25 * (wide[1:, 1:] + wide[1:, :-1] + wide[:-1, 1:] + wide[:-1, :-1])

    def in_cells(self, name: str) -> np.ndarray:
        """A field in the cells, the mean of the nodes around each."""
        values = self.fields[name]
        if values.shape == (self.x.size - 1, self.y.size - 1):
            return values
        return 0.25 * (values[1:, 1:] + values[1:, :-1] + values[:-1, 1:] + values[:-1, :-1])

    def mesh(self, height: np.ndarray, values: np.ndarray) -> pv.StructuredGrid:
        """The surface at heights (nx, ny) in µm with "value" at its nodes or in its cells."""
        x, y = np.meshgrid(self.x, self.y, indexing="ij")
        mesh = pv.StructuredGrid(x, y, height)
        data = mesh.point_data if values.shape == height.shape else mesh.cell_data
        data["value"] = values.ravel(order="F")
        return mesh

    def around(self, shown: np.ndarray) -> Sheet:
        """The part around what is marked, at the nodes or in the cells, and half as much on each side."""
        rows, columns = (
            _around(np.flatnonzero(shown.any(axis=k)), n) for k, n in ((1, self.x.size), (0, self.y.size))
        )
        fields = {}
        for name, values in self.fields.items():
            less = int(values.shape[0] < self.x.size)
            fields[name] = values[rows.start : rows.stop - less, columns.start : columns.stop - less]
        raised = None if self.raised is None else self.raised[rows, columns]
        return Sheet(self.x[rows], self.y[columns], raised, fields)


@dataclass(frozen=True)
class Found:
    """What there is to draw of a run, loaded as it is asked for."""

    run: Run

    @property
    def scene(self) -> Mapping:
        """Its scene, as in summary.json."""
        return self.run.summary["scene"]

    @cached_property
    def section(self) -> Section:
        """The plane in which the run is cut."""
        return section_of(self.run, surface_map(self.run))

    def sheet(self, state: str = PEAK) -> Sheet | None:
        """The surface in a state, None where there is none, or nothing that says what of it to draw."""
        path, radius = self.run.folder / FILES[state], self.run.quantities["contact_radius_m"]
        if not path.exists() or (self.run.model == "fem-axisymmetric" and not radius):
            return None
        grid = _mesh(self.run.folder, path.name)
        x, y = MICRO * np.array(grid.x), MICRO * np.array(grid.y)
        fields = {name: _folded(grid.cell_data[name], x.size - 1) for name in grid.cell_data.keys()}
        vectors = [
            grid.point_data[name] for name in grid.point_data.keys() if name.endswith("displacement_m")
        ]
        fields |= {
            name: _folded(values, x.size) for name, values in grid.point_data.items() if values.ndim == 1
        }
        raised = MICRO * _folded(vectors[0][:, 2], x.size) if vectors else None
        if self.run.model == "fem-axisymmetric":
            return self._turned(x, raised, fields)
        if y[0] == 0.0:  # half a model: the other half is its mirror image
            y = np.append(-y[:0:-1], y)
            raised, fields = _mirrored(raised), {name: _mirrored(values) for name, values in fields.items()}
        return Sheet(x, y, raised, fields)

    def _turned(self, r: np.ndarray, raised: np.ndarray, fields: Mapping[str, np.ndarray]) -> Sheet:
        """The surface nodes along r, turned around the axis, on a square."""
        a = REACH * MICRO * self.run.quantities["contact_radius_m"]
        x = np.linspace(-a, a, POINTS)
        places = np.hypot(x[:, None], x[None, :])

        def on(values: np.ndarray) -> np.ndarray:
            return np.interp(places, r, values[:, 0])

        return Sheet(x, x, on(raised), {name: on(values) for name, values in fields.items()})

    def plane(self, column: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A column in the plane of the section up to the surface: x (nx,), depth (nz,) in µm, (nx, nz).

        Within half a cell of the surface, or of an interface, where there are no points, it has the value of
        the next one.
        """
        x, depth, values = plane_of(self.run, self.section, column)
        if depth[0] > 0.0:
            depth, values = np.append(0.0, depth), np.pad(values, ((0, 0), (1, 0)), constant_values=np.nan)
        return MICRO * x, MICRO * depth, np.array([_filled(depth, below) for below in values])

    def strained(self) -> pv.DataSet | None:
        """The part of the body that may yield, with "peeq" at its points; None of an elastic run."""
        if not self.run.quantities["peeq_max"]:
            return None
        if self.run.model == "fem-axisymmetric":
            return self._turned_plane("peeq")
        path = self.run.folder / ("body.vtr" if self.run.model == "sam" else "fields.vtu")
        if not path.exists():
            return None
        body = _mesh(self.run.folder, path.name).copy()
        for name in set(body.cell_data.keys()) - {"peeq"}:
            del body.cell_data[name]
        return body.cell_data_to_point_data().cast_to_unstructured_grid().scale(MICRO)

    def _turned_plane(self, column: str) -> pv.StructuredGrid:
        """A column of the plane y = 0, x >= 0, turned over half a turn to y > 0."""
        x, depth, values = self.plane(column)
        right = x >= 0.0
        angle = np.linspace(0.0, np.pi, TURNS)
        r, turn, z = np.meshgrid(x[right], angle, -depth, indexing="ij")
        grid = pv.StructuredGrid(r * np.cos(turn), r * np.sin(turn), z)
        whole = np.broadcast_to(values[right][:, None, :], r.shape)
        grid["peeq"] = whole.ravel(order="F")
        return grid


def _filled(depth: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (nz,), those that are not known as at the nearest depth where they are."""
    known = np.flatnonzero(np.isfinite(values))
    if known.size == 0:
        return values
    return values[known[np.abs(depth[:, None] - depth[known]).argmin(axis=1)]]


def _folded(values: np.ndarray, nx: int) -> np.ndarray:
    """Values of a file, along x first, as (nx, ny)."""
    return np.array(values).reshape(-1, nx).T


def _mirrored(values: np.ndarray | None) -> np.ndarray | None:
    """Values at the nodes of a half, (nx, ny) with y[0] = 0, of the whole."""
    return None if values is None else np.hstack([values[:, :0:-1], values])


def _around(marked: np.ndarray, size: int) -> slice:
    """From the first to the last of the places marked (m,), and half as many on each side."""
    if marked.size == 0:
        return slice(0, size)
    beside = (marked[-1] - marked[0]) // 2 + 2
    return slice(max(marked[0] - beside, 0), min(marked[-1] + beside + 1, size))
