# SPDX-License-Identifier: MIT
"""The return map at 2 x 2 Gauss points in the plane of each cell.

The operator gives one stress s of a cell, that of plastic strain which is uniform in it. In the material the
stress varies over the cell, and so does what flows: half of a cell at the border of the plastic zone yields.
As within a finite element (Simo & Hughes 1998), the law of the material is therefore fulfilled
at Gauss points, and the plastic strain E of the cell is the mean over its points, E = mean E_g. The stress at
a point is

    s_g = [s + 2 m E]_g - 2 m E_g,      [v]_g = v +- h_x/(2 sqrt 3) dv/dx +- h_y/(2 sqrt 3) dv/dy,         (e)

with central differences between cells. A part of a cell that strains more than the rest lowers its own stress
by 2 m of the difference; s + 2 m E is what the surroundings alone make, and it is smooth where E is not. The
mean of (e) over the points is s again. With x_g = E_g - E_g0 over a step, (e) is the return map of the trial
stress [s + 2 m E]_g - 2 m E_g0, and the mean of the x_g is the increment of the cell.

The state (plastic strain, accumulated strain, back-stresses) belongs to the points. If it were made anew from
the cells at the beginning of each step, the stresses (e) that the step before ended with would be forgotten,
and a load that stays the same would strain the body again.

The points stand in the order (-x, -y), (-x, +y), (+x, -y), (+x, +y), on the axis before the layers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.contact.convolution import Transforms
from sam.contact.operators import yielding
from sam.kernels.patches import ODD_X, ODD_Y
from sam.plasticity.flow import Flow, Material, contraction, deviator, equivalent_strain, mises
from sam.plasticity.spectra import EVEN
from sam.plasticity.state import CellFields, filled, spread

POINTS = 4
CELLS_AT_ONCE = 2**14  # of layers whose trial stress is made together: a tensor of them fits into the cache
SIGNS = np.array([[-1.0, -1, 1, 1], [-1, 1, -1, 1]])[..., None]  # in x and in y
OFFSET = 1 / (4 * sqrt(3))  # of a point, over the distance between both neighbours of its cell
OPPOSITE = {-2: (np.array([2, 3, 0, 1]), ODD_X), -1: (np.array([1, 0, 3, 2]), ODD_Y)}
"""Points after x -> -x and after y -> -y, and the components that change their sign."""


def whole(transforms: Transforms, kept: CellFields) -> CellFields:
    """The fields on all of the box, of those on the cells that are kept."""
    if not any(transforms.mirror):
        return kept
    places = filled(1.0 + np.arange(np.count_nonzero(kept.cells)), kept.cells)
    places = transforms.whole(places[None], *EVEN)[0]
    cells = places > 0
    places = places[cells].astype(int) - 1
    first = {axis: np.nonzero(cells)[axis] < transforms.cells[axis] // 2 for axis in OPPOSITE}

    def everywhere(values: Array) -> Array:
        out = values.take(places, axis=-1)
        for axis, (order, odd) in OPPOSITE.items():
            if transforms.mirror[axis]:
                sign = np.where(odd, -1.0, 1.0)[:, None, None] if values.ndim > 2 else 1.0
                out[..., first[axis]] = sign * out[..., first[axis]][..., order, :]
        return out

    return CellFields(cells, kept.points.each(everywhere))


@dataclass(frozen=True)
class Linear:
    """Fields that are linear in each of (nx, ny) cells, by differences between neighbours; periodic: those at
    opposite sides are neighbours too, along x and along y.
    """

    cells: tuple[int, int]
    mirror: tuple[bool, bool] = (False, False)
    periodic: tuple[bool, bool] = (False, False)

    def at_points(self, values: Array, cells: Mask) -> Array:
        """Of means of cells, kept tensors (6, ..., nx, ny): at the points of some of them, (6, 4, n)."""
        at = np.repeat(values[:, None, cells], POINTS, axis=1)
        for axis, signs in zip((-2, -1), SIGNS, strict=True):
            at += OFFSET * signs * self.difference(values, axis)[:, None, cells]
        return at

    def farthest(self, q: Array) -> Array:
        """What von Mises of the values at a point of each cell cannot exceed, of that of their means q."""
        return q + OFFSET * (self._reach(q, -2) + self._reach(q, -1))

    def difference(self, values: Array, axis: int) -> Array:
        """v(i + 1) - v(i - 1) along axis -2 or -1; at a side of the box twice the one difference."""
        differences = np.zeros_like(values)
        v, out = np.moveaxis(values, axis, -1), np.moveaxis(differences, axis, -1)
        count = v.shape[-1]
        if count > 1:
            np.subtract(v[..., 2:], v[..., :-2], out=out[..., 1:-1])
            out[..., 0], out[..., -1] = 2 * (v[..., 1] - v[..., 0]), 2 * (v[..., -1] - v[..., -2])
        if self.periodic[axis] and count > 1:
            out[..., 0], out[..., -1] = v[..., 1] - v[..., -1], v[..., 0] - v[..., -2]
        if self.mirror[axis]:
            sign = np.where(ODD_X if axis == -2 else ODD_Y, -1.0, 1.0).reshape(6, *[1] * (v.ndim - 2))
            before = sign * v[..., min(self.cells[axis] % 2, count - 1)]
            out[..., 0] = v[..., 1] - before if count > 1 else 2 * (v[..., 0] - before)
        return differences

    def _reach(self, q: Array, axis: int) -> Array:
        """What von Mises of `difference` cannot exceed."""
        reach = np.zeros_like(q)
        v, out = np.moveaxis(q, axis, -1), np.moveaxis(reach, axis, -1)
        if v.shape[-1] > 1:
            np.add(v[..., 2:], v[..., :-2], out=out[..., 1:-1])
            out[..., 0], out[..., -1] = 2 * (v[..., 1] + v[..., 0]), 2 * (v[..., -1] + v[..., -2])
        if self.periodic[axis] and v.shape[-1] > 1:
            out[..., 0], out[..., -1] = v[..., 1] + v[..., -1], v[..., 0] + v[..., -2]
        return reach


def stress_at_points(stress: Array, strain: Array, m: float, *, periodic: bool = False) -> Array:
    """The stress (e) at the points of all cells of a box, (6, 4, n_layers, nx, ny) in Pa, of the stress of
    the cells, (6, n_layers, nx, ny), and plastic strain at the points; m: of the return map (a).
    """
    linear = Linear((stress.shape[-2], stress.shape[-1]), periodic=(periodic, periodic))
    every = np.ones(stress.shape[1:], dtype=bool)
    smooth = linear.at_points(stress + 2 * m * strain.mean(axis=1), every)
    return smooth.reshape(strain.shape) - 2 * m * strain


@dataclass(frozen=True)
class Returned:
    """The return map of an increment x of the cells that may flow: x and image, its mean over the points,
    (6, n); their points (6, 4, n), with the mean x; deviatoric stress there in Pa; flow_residual:
    2 m |image - x| over the initial yield stress.
    """

    cells: Mask
    x: Array
    image: Array
    points: Array
    stress: Array
    flow: Flow
    flow_residual: float

    @cached_property
    def yield_excess(self) -> float:
        """The largest (q - sigma_y)/sigma_y at the points."""
        return self.flow.excess(self.points, self.stress)

    def worst(self, goal: float) -> float:
        """The larger residual; that of the flow rule alone where this is beyond the goal."""
        return self.flow_residual if self.flow_residual > goal else max(self.flow_residual, self.yield_excess)

    def increment(self) -> CellFields:
        """The increment of the fields at the points of the cells that x strains."""
        strains: Mask = np.asarray(self.x.any(axis=0))
        fields = self.flow.increment(self.points, equivalent_strain(self.points))
        cells = filled(strains, self.cells)
        return CellFields(cells, fields.each(lambda values: values.compress(strains, axis=-1)))


class CellFlow:
    """How cells yield over a step, the return map at their points. before: the fields there at its beginning,
    on the cells that the transforms keep; m: of the return map (a); cells: those that may flow, of which more
    are found as they do.
    """

    def __init__(self, material: Material, before: CellFields, transforms: Transforms, m: float):
        self.material, self.before, self.m, self.cells = material, before, m, before.cells
        wraps = transforms.periodic, transforms.periodic or transforms.wraps
        self.linear = Linear(transforms.cells, transforms.mirror, wraps)
        # the least yield stress at the points of each cell
        unstrained = material.yield_stress(np.zeros((1, 1, 1)))
        self.least = np.broadcast_to(unstrained, before.cells.shape).copy()
        self.least[before.cells] = self.flow.limit.min(axis=0)
        self.last: tuple[Mask | None, Array] = None, np.zeros(0)  # cells and lengths of the last return

    @cached_property
    def flow(self) -> Flow:
        """Of the points of the cells."""
        return self.material.at(self.cells).flow(self.before.on(self.cells))

    def add(self, cells: Mask) -> None:
        """More cells that may flow."""
        if (cells & ~self.cells).any():
            self.cells = self.cells | cells
            vars(self).pop("flow", None)

    @property
    def nothing(self) -> Array:
        """No increment of the cells, (6, n)."""
        return np.zeros((6, np.count_nonzero(self.cells)))

    @property
    def counts(self) -> NDArray[np.intp]:
        """Of the cells in each layer."""
        return np.count_nonzero(self.cells, axis=(1, 2))

    def trial(self, x: Array, stress: Array) -> Array:
        """The trial stress (e) at the points of the cells that may yield, (6, 4, n); x: of `cells`."""
        added = 2 * self.m * (self.flow.before.strain.mean(axis=1) + x)
        at_once = max(1, CELLS_AT_ONCE // self.least[0].size)
        parts = np.split(added, np.cumsum(self.counts)[at_once - 1 : -1 : at_once], axis=-1)
        may_yield, at = self.cells.copy(), []
        for k, part in enumerate(parts):
            layers = slice(k * at_once, (k + 1) * at_once)
            smooth, cells = deviator(stress[:, layers]), may_yield[layers]
            smooth[:, cells] += part
            cells |= yielding(self.linear.farthest(mises(smooth)), self.least[layers])
            at.append(self.linear.at_points(smooth, cells))
        self.add(may_yield)
        return np.concatenate(at, axis=-1) - 2 * self.m * self.flow.before.strain

    def returned(self, x: Array, stress: Array) -> Returned:
        """The return map of an increment x (6, n) of `cells` and the stress of all, (6, n_layers, nx, ny)."""
        before = self.cells
        trial = self.trial(x, stress)
        x = spread(x, before, self.cells)
        points = self.flow.returned(trial, self.m, near=self.near(x))
        self.last = self.cells, equivalent_strain(points)
        image = points.mean(axis=1)
        change = x - image
        points += change[:, None]
        points[:, :, ~x.any(axis=0)] = 0.0  # what is accepted without an increment strains nothing
        unequal = 2 * self.m * np.sqrt(contraction(change, change).max(initial=0.0))
        trial -= 2 * self.m * points
        return Returned(
            self.cells, x, image, points, trial, self.flow, float(unequal / self.material.initial_yield)
        )

    def near(self, means: Array) -> Array:
        """Lengths that the increments at the points about have: of the last return, or of the cells."""
        cells, lengths = self.last
        return lengths if cells is self.cells else equivalent_strain(means)

    def stays_elastic(self, stress: Array, tolerance: float) -> bool:
        """Whether a stress of the cells, (6, n_layers, nx, ny), strains no point."""
        trial = self.trial(self.nothing, stress)
        return self.flow.excess(np.zeros_like(trial), trial) <= tolerance
