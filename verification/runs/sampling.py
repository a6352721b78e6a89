# SPDX-License-Identifier: MIT
"""The fields of a result or of a run read back, as arrays on one grid. Lengths in m, stresses in Pa."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.ndimage import label, maximum

from sam.scene import Result

Tables = Mapping[str, Mapping[str, Sequence]]


def peak(table: Mapping[str, Sequence], *names: str) -> tuple[np.ndarray, ...]:
    """Columns of the rows at peak load, each (n,)."""
    return rows_of(table, "peak", *names)


def rows_of(table: Mapping[str, Sequence], state: str, *names: str) -> tuple[np.ndarray, ...]:
    """Columns of the rows of a state, "peak" or "unloaded", each (n,)."""
    rows = np.asarray(table["state"]) == state
    return tuple(np.asarray(table[name], dtype=float)[rows] for name in names)


def pressure_map(sam: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x (nx,), y (ny,) in m and p (nx, ny) in Pa of a SAM result."""
    return surface_pressure(sam.fields.points, sam.fields.cells["quad"], sam.fields.cell_data["p_Pa"])


def surface_pressure(
    points: np.ndarray, quads: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The pressure map of SAM from its mesh: x (nx,), y (ny,), p (nx, ny). points: (n, 3); quads: (m, 4); p:
    (m,), finite for the cells of the surface only.
    """
    surface = np.isfinite(p)
    corners = points[quads[surface]]
    x, y = corners.mean(axis=1).T[:2]
    pitch = np.ptp(corners[0], axis=0)
    column, row = (np.rint((c - c.min()) / h).astype(int) for c, h in ((x, pitch[0]), (y, pitch[1])))
    field = np.full((column.max() + 1, row.max() + 1), np.nan)
    field[column, row] = p[surface]
    return np.linspace(x.min(), x.max(), len(field)), np.linspace(y.min(), y.max(), field.shape[1]), field


def pressure_on(x: np.ndarray, y: np.ndarray, axisymmetric: Tables, power: int = 2) -> np.ndarray:
    """The pressure of the axisymmetric model at (x, y), (nx, ny), or of both sides of a section at x. Linear
    between the nodes is p^power: 2 for an elastic contact, which ends in a square root, 1 for a plastic one.
    """
    r, p = peak(axisymmetric["line"], "x_m", "p_Pa")
    at = np.hypot(x[:, None], y[None, :]) if r[0] >= 0 else x[:, None] + 0 * y
    return np.interp(at, r, p**power) ** (1 / power)


def plane_field(tables: Tables, column: str) -> tuple[np.ndarray, ...]:
    """A column of SAM in the plane y = 0 at peak load: x (nx,), z (nz,), field (nx, nz)."""
    return gridded(*peak(tables["plane"], "x_m", "z_m", column))


def gridded(x: np.ndarray, y: np.ndarray, *values: np.ndarray) -> tuple[np.ndarray, ...]:
    """Values (n,) at places (n,) on their grid: x (nx,), y (ny,), and each (nx, ny), NaN where none is."""
    (xs, i), (ys, j) = (np.unique(each, return_inverse=True) for each in (x, y))
    fields = np.full((len(values), xs.size, ys.size), np.nan)
    fields[:, i, j] = values
    return xs, ys, *fields


def spots_of(surface: Mapping[str, Sequence]) -> list[list]:
    """Spots of a table surface, whose cells join at their sides, the largest force of a state first: state,
    number, x and y of the centre of force, area, force, largest pressure and cells of each, in SI units.
    """
    columns: list[list] = [[] for _ in range(8)]
    for state in dict.fromkeys(surface["state"]):
        x, y, p = gridded(*rows_of(surface, state, "x_m", "y_m", "p_Pa"))
        cell = float(np.ptp(x) / (x.size - 1) * np.ptp(y) / (y.size - 1))
        of, count = label(p > 0.0)
        cells, load, along, across = (
            np.bincount(of.ravel(), (weight * np.ones_like(p)).ravel(), count + 1)[1:]
            for weight in (1.0, p, p * x[:, None], p * y)
        )
        first = np.argsort(-load, kind="stable")
        top = np.array(maximum(p, of, np.arange(1, count + 1)))
        found = along / load, across / load, cell * cells, cell * load, top, cells.astype(int)
        columns[0] += [state] * count
        columns[1] += range(1, count + 1)
        for column, values in zip(columns[2:], found, strict=True):
            column += values[first].tolist()
    return columns


def plane_field_on(x: np.ndarray, z: np.ndarray, fem: Tables, column: str) -> np.ndarray:
    """The same of the axisymmetric or the plane-strain model at (x, z), (nx, nz), linear between its Gauss
    points; NaN in the strip between the surface and the first of them. Half of a section is mirrored.
    """
    reach = 1.5 * max(np.abs(x).max(), z.max())
    along, depth, field = peak(fem["plane"], "x_m", "z_m", column)
    near = (np.abs(along) < reach) & (depth < reach)
    points, values = np.stack([along, depth], axis=1)[near], field[near]
    if along.min() >= 0.0:
        mirrored = points[:, 0] < 0.2 * reach  # enough to close the gap at the axis
        points = np.vstack([points, points[mirrored] * [-1.0, 1.0]])
        x, values = np.abs(x), np.append(values, values[mirrored])
    return LinearNDInterpolator(points / reach, values)(x[:, None] / reach, z[None, :] / reach)


def surface_nodes(fem: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x (nx,), y (ny,) >= 0 and the nodal pressure (nx, ny) of the three-dimensional model; m and Pa."""
    points, p = fem.fields.points, np.asarray(fem.fields.point_data["p_Pa"])
    use = (points[:, 2] == 0.0) & (points[:, 1] >= 0.0)
    points, p = points[use], p[use]
    order = np.lexsort((points[:, 1], points[:, 0]))
    x, y = np.unique(points[:, 0]), np.unique(points[:, 1])
    return x, y, p[order].reshape(x.size, y.size)


SUBDIVIDED = 16  # points of a cell, each way, that are counted into the rings


def ring_edges(width: float, reach: float) -> np.ndarray:
    """Radii from 0 in steps of `width` to the first beyond `reach`, m."""
    return width * np.arange(int(np.ceil(reach / width)) + 1)


def means_of_cells(x: np.ndarray, y: np.ndarray, p: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Ring means of p (nx, ny), uniform on each cell around the centres x (nx,), y (ny,): (n_edges - 1,)."""
    offsets = (np.arange(SUBDIVIDED) + 0.5) / SUBDIVIDED - 0.5
    across, along = ((c[:, None] + offsets * (c[1] - c[0])).ravel() for c in (x, y))
    r = np.hypot(across[:, None], along[None, :])
    fine = np.repeat(np.repeat(p, SUBDIVIDED, axis=0), SUBDIVIDED, axis=1)
    counted = np.histogram(r, edges)[0]
    return np.histogram(r, edges, weights=fine)[0] / counted


def means_of_line(r: np.ndarray, p: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Ring means of p linear between radii r (n,), ascending: (n_edges - 1,), exact (Simpson)."""
    knots = np.union1d(r[r < edges[-1]], edges)
    middle = (knots[1:] + knots[:-1]) / 2.0
    ends, inner = (np.interp(at, r, p) * at for at in (knots, middle))
    parts = np.diff(knots) * (ends[1:] + 4.0 * inner + ends[:-1]) / 6.0
    total = np.append(0.0, np.cumsum(parts))[np.searchsorted(knots, edges)]
    return 2.0 * np.diff(total) / np.diff(edges**2)
