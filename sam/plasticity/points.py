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

from sam.arrays import Array, Mask
from sam.contact.convolution import Transforms
from sam.contact.stress import yielding
from sam.kernels.patches import ODD_X, ODD_Y
from sam.plasticity.flow import Flow, Material, contraction, equivalent_strain, mises
from sam.plasticity.spectra import EVEN
from sam.plasticity.state import MaterialFields

POINTS = 4
SIGNS = np.array([[-1.0, -1, 1, 1], [-1, 1, -1, 1]])[..., None]  # in x and in y
OFFSET = 1 / (4 * sqrt(3))  # of a point, over the distance between both neighbours of its cell
OPPOSITE = {-2: np.array([2, 3, 0, 1]), -1: np.array([1, 0, 3, 2])}  # after x -> -x, and after y -> -y


def whole(transforms: Transforms, kept: Array) -> Array:
    """A kept field at the points on all of the box, tensors (..., 6, 4, n_layers, nx, ny) or numbers."""
    *lead, points = kept.shape[:-3]
    flat = kept.reshape(-1, *kept.shape[-3:])
    parities = (ODD_X, ODD_Y) if lead else EVEN
    odd_x, odd_y = (np.resize(np.repeat(each, points), len(flat)) for each in parities)
    out = transforms.whole(flat, odd_x, odd_y)
    out = out.reshape(*kept.shape[:-3], *out.shape[-3:])
    for axis, order in OPPOSITE.items():
        if transforms.mirror[axis]:
            first = np.moveaxis(out, axis, 0)[: transforms.cells[axis] // 2]
            first[...] = np.take(first, order, axis=-3)
    return np.asarray(out, dtype=float)


@dataclass(frozen=True)
class Linear:
    """Fields that are linear in each of (nx, ny) cells, by differences between neighbours."""

    cells: tuple[int, int]
    mirror: tuple[bool, bool] = (False, False)

    def at_points(self, values: Array, cells: Mask) -> Array:
        """Of means of cells, kept tensors (6, n_layers, nx, ny): at the points of some of them, (6, 4, n)."""
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
        return reach


def stress_at_points(stress: Array, strain: Array, m: float) -> Array:
    """The stress (e) at the points of all cells of a box, (6, 4, n_layers, nx, ny) in Pa, of the stress of
    the cells, (6, n_layers, nx, ny), and plastic strain at the points; m: of the return map (a).
    """
    linear, every = Linear((stress.shape[-2], stress.shape[-1])), np.ones(stress.shape[1:], dtype=bool)
    smooth = linear.at_points(stress + 2 * m * strain.mean(axis=1), every)
    return smooth.reshape(strain.shape) - 2 * m * strain


@dataclass(frozen=True)
class Returned:
    """The return map of an increment x: image, its mean over the points, (6, n_layers, nx, ny);
    cells that may flow; their points (6, 4, n), with the mean x; deviatoric stress there in Pa;
    flow_residual: 2 m |image - x| over the initial yield stress.
    """

    image: Array
    cells: Mask
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


class CellFlow:
    """How cells yield over a step, the return map at their points. before: the fields there at its beginning,
    on the cells that the transforms keep; m: of the return map (a).
    """

    def __init__(self, material: Material, before: MaterialFields, transforms: Transforms, m: float):
        self.material, self.before, self.m = material, before, m
        self.linear = Linear(transforms.cells, transforms.mirror)
        self.strain = before.strain.mean(axis=1)
        limit = material.yield_stress(before.peeq)
        self.least, self.limit = limit.min(axis=0), limit.mean(axis=0)  # of the yield stress of each cell
        self.cells: Mask = np.asarray(before.peeq.any(axis=0))  # those that flow, now or before
        self.last: tuple[Mask | None, Array] = None, np.zeros(0)  # cells and lengths of the last return

    @cached_property
    def flow(self) -> Flow:
        """Of the points of the cells."""
        return self.material.at(self.cells).flow(self.before.each(lambda values: values[..., self.cells]))

    def trial(self, x: Array, s: Array) -> Array:
        """The trial stress (e) at the points of the cells that may yield, (6, 4, n)."""
        smooth = s + 2 * self.m * (self.strain + x)
        may_yield: Mask = yielding(self.linear.farthest(mises(smooth)), self.least)
        may_yield |= x.any(axis=0)
        if (may_yield & ~self.cells).any():
            self.cells = self.cells | may_yield
            vars(self).pop("flow", None)
        return self.linear.at_points(smooth, self.cells) - 2 * self.m * self.flow.before.strain

    def returned(self, x: Array, s: Array) -> Returned:
        """The return map of an increment x (6, n_layers, nx, ny) and the deviatoric stress s of the cells."""
        trial = self.trial(x, s)
        means = x[:, self.cells]
        points = self.flow.returned(trial, self.m, near=self.near(means))
        self.last = self.cells, equivalent_strain(points)
        image = np.zeros_like(x)
        image[:, self.cells] = points.mean(axis=1)
        change = means - image[:, self.cells]
        points += change[:, None]
        points[:, :, ~means.any(axis=0)] = 0.0  # what is accepted without an increment strains nothing
        unequal = 2 * self.m * np.sqrt(contraction(change, change).max(initial=0.0))
        stress, relative = trial - 2 * self.m * points, float(unequal / self.material.initial_yield)
        return Returned(image, self.cells, points, stress, self.flow, relative)

    def near(self, means: Array) -> Array:
        """Lengths that the increments at the points about have: of the last return, or of the cells."""
        cells, lengths = self.last
        return lengths if cells is self.cells else equivalent_strain(means)

    def increment(self, returned: Returned) -> MaterialFields:
        """The increment of the fields at the points of all cells."""
        small = self.flow.increment(returned.points, equivalent_strain(returned.points))

        def everywhere(values: Array) -> Array:
            out = np.zeros((*values.shape[:-1], *self.cells.shape))
            out[..., self.cells] = values
            return out

        return small.each(everywhere)

    def stays_elastic(self, s: Array, tolerance: float) -> bool:
        """Whether the deviatoric stress s of the cells strains no point."""
        trial = self.trial(np.zeros_like(s), s)
        return self.flow.excess(np.zeros_like(trial), trial) <= tolerance
