# SPDX-License-Identifier: MIT
"""What pictures in space are made of, as meshes in µm whose z points up."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import pyvista as pv

from sam.scene import PEAK, UNLOADED
from verification.figures.places import Section, plane_of, section_of, surface_map
from verification.runs.files import Run, mesh_of
from verification.runs.tables import contact_size

MICRO = 1e6
FILES = {PEAK: "surface.vtr", UNLOADED: "surface-unloaded.vtr"}
"""State -> file with the surface."""
RAISED = "raised_m"
"""Of a surface: the displacement of its nodes upwards."""
TURNS, REACH, POINTS = 61, 2.0, 161
"""Of an axisymmetric run: steps of half a turn, and the square that is drawn, in contact radii, with its
points along x and y."""

_mesh = cache(mesh_of)
"""Each file once in a process, which draws and ends."""


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

    @cached_property
    def ends(self) -> np.ndarray:
        """Of a section, which is the same at every y: from where to where it is drawn along y, in m."""
        return np.ptp(self.section.reach) * np.array([-0.5, 0.5])

    def sheet(self, state: str = PEAK) -> pv.StructuredGrid | None:
        """The surface in a state, flat, with every field at nodes and in cells, RAISED if known, or None."""
        path, radius = self.run.folder / FILES[state], contact_size(self.run.quantities)
        if not path.exists() or (self.run.model == "fem-axisymmetric" and not radius):
            return None
        grid = _with_scalars(_mesh(self.run.folder, path.name).copy())
        if self.run.model == "fem-axisymmetric":  # nodes along r, turned around the axis on a square
            x = np.linspace(-REACH * radius, REACH * radius, POINTS)
            whole, r = pv.RectilinearGrid(x, x, [0.0]), np.hypot(x[:, None], x).ravel()
            for name, values in grid.point_data.items():
                whole.point_data[name] = np.interp(r, grid.x, values.reshape(-1, grid.x.size)[0])
            grid = whole
        elif grid.y.size == 1:
            whole = pv.RectilinearGrid(grid.x, self.ends, [0.0])
            for name, values in grid.point_data.items():
                whole.point_data[name] = np.tile(values, 2)
            grid = whole
        elif grid.y.size == 2:
            grid.y = self.ends
        elif grid.y[0] == 0.0:  # half a model: the other half is its mirror image
            whole = pv.RectilinearGrid(grid.x, np.append(-grid.y[:0:-1], grid.y), [0.0])
            for name, values in grid.point_data.items():
                half = values.reshape(grid.y.size, grid.x.size)
                whole.point_data[name] = np.vstack([half[:0:-1], half]).ravel()
            grid = whole
        at_nodes = dict(grid.cell_data_to_point_data().point_data.items())
        in_cells = dict(grid.point_data_to_cell_data().cell_data.items())
        grid.point_data.update(at_nodes)
        grid.cell_data.update(in_cells)
        grid.x, grid.y = MICRO * grid.x, MICRO * grid.y
        return grid.cast_to_structured_grid()

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
        if self.run.model == "fem-axisymmetric":  # the plane x >= 0, turned over half a turn to y > 0
            x, depth, values = self.plane("peeq")
            right = x >= 0.0
            r, turn, z = np.meshgrid(x[right], np.linspace(0.0, np.pi, TURNS), -depth, indexing="ij")
            grid = pv.StructuredGrid(r * np.cos(turn), r * np.sin(turn), z)
            grid["peeq"] = np.broadcast_to(values[right][:, None, :], r.shape).ravel(order="F")
            return grid
        if self.run.model == "fem-plane-strain":
            x, depth, values = self.plane("peeq")
            grid = pv.StructuredGrid(*np.meshgrid(x, MICRO * self.ends, -depth, indexing="ij"))
            grid["peeq"] = np.repeat(values[:, None], 2, axis=1).ravel(order="F")
            return grid
        path = self.run.folder / ("body.vtr" if self.run.model == "sam" else "fields.vtu")
        if not path.exists():
            return None
        body = _mesh(self.run.folder, path.name).copy()
        if isinstance(body, pv.RectilinearGrid) and body.y.size == 2:
            body.y = self.ends
        for name in set(body.cell_data.keys()) - {"peeq"}:
            del body.cell_data[name]
        return body.cell_data_to_point_data().cast_to_unstructured_grid().scale(MICRO)


def _with_scalars(grid: pv.RectilinearGrid) -> pv.RectilinearGrid:
    """The grid without its vectors and tensors, with RAISED in place of a displacement."""
    for name in list(grid.point_data):
        if grid.point_data[name].ndim > 1:
            if name.endswith("displacement_m"):
                grid.point_data[RAISED] = grid.point_data[name][:, 2]
            del grid.point_data[name]
    return grid


def drawn_at(sheet: pv.StructuredGrid, height: np.ndarray, values: np.ndarray) -> pv.StructuredGrid:
    """A surface with its nodes at heights (n,) in µm and "value" at the nodes or in the cells."""
    mesh = sheet.copy()
    mesh.clear_data()
    mesh.points = np.column_stack([mesh.points[:, :2], height])
    (mesh.point_data if values.size == mesh.n_points else mesh.cell_data)["value"] = values
    return mesh


def around(sheet: pv.StructuredGrid, shown: np.ndarray) -> pv.StructuredGrid:
    """The part around the nodes or cells that are marked, (n,), and half as much on each side."""
    nx, ny, _ = sheet.dimensions
    marked = shown.reshape((ny, nx) if shown.size == nx * ny else (ny - 1, nx - 1))
    ends = []
    for axis, size in ((0, nx), (1, ny)):
        at = np.flatnonzero(marked.any(axis=axis))
        if at.size == 0:
            ends += [0, size - 1]
            continue
        beside = (at[-1] - at[0]) // 2 + 2
        ends += [max(at[0] - beside, 0), min(at[-1] + beside, size - 1)]
    return sheet.extract_subset([*ends, 0, 0])


def _filled(depth: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (nz,), those that are not known as at the nearest depth where they are."""
    known = np.flatnonzero(np.isfinite(values))
    if known.size == 0:
        return values
    return values[known[np.abs(depth[:, None] - depth[known]).argmin(axis=1)]]
