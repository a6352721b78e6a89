# SPDX-License-Identifier: MIT
"""The plastic state of a box of cells: frozen records of named fields, with one rule for each kind of field.

Three kinds of fields make up a state, and nothing else has to know their names:

* fields of the material (`MaterialFields`), tensors of any shape at points, of the cells that have yielded
  (`CellFields`) and zero in all others: when the surface wears the columns of cells move up; a step adds its
  increment;
* residual fields, what is left without load and follows from the plastic strain (`ResidualFields`): they
  are computed anew when the box grows and when it wears;
* fields of the loaded surface (the pressure): when the box grows there are zeros around them.

A law that needs more memory (the misfit strain of a phase, say) adds a field to `MaterialFields`. A
checkpoint takes the records apart by their fields, and needs no rule of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.grid.cells import Window
from sam.schedule import UNLOADED, Load

T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True)
class MaterialFields:
    """What the material remembers at points, or its increment over a step: plastic strain, (6, ...); peeq:
    accumulated, (...); back: strains a_k of the back-stresses, (N, 6, ...), or None.
    """

    strain: Array
    peeq: Array
    back: Array | None = None

    @classmethod
    def zero(cls, shape: tuple[int, ...], back_stresses: int = 0) -> MaterialFields:
        """No strain at points or cells.

        >>> MaterialFields.zero((4, 2, 3)).strain.shape
        (6, 4, 2, 3)
        """
        back = np.zeros((back_stresses, 6, *shape)) if back_stresses else None
        return cls(np.zeros((6, *shape)), np.zeros(shape), back)

    def by_name(self) -> dict[str, Array]:
        """All fields that there are."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        return {name: value for name, value in values.items() if value is not None}

    def each(self, rule: Callable[[Array], Array]) -> MaterialFields:
        """The same rule for every field."""
        return MaterialFields(**{name: rule(values) for name, values in self.by_name().items()})

    def plus(self, increment: MaterialFields) -> MaterialFields:
        """The sum of both."""
        more = increment.by_name()
        return MaterialFields(**{name: values + more[name] for name, values in self.by_name().items()})


def spread(values: Array, cells: Mask, among: Mask) -> Array:
    """Values (..., n) of some cells in the row (..., N) of more cells, zero at the others.

    >>> spread(np.ones(1), np.array([False, True, False]), np.array([True, True, False]))
    array([0., 1.])
    """
    out = np.zeros((*values.shape[:-1], np.count_nonzero(among)))
    out[..., cells[among]] = values
    return out


def filled(values: NDArray[T], cells: Mask) -> NDArray[T]:
    """Values (..., n) of some cells of a box on all of it, (..., n_layers, nx, ny), zero at the others."""
    out: NDArray[T] = np.zeros((*values.shape[:-1], *cells.shape), dtype=values.dtype)
    out[..., cells] = values
    return out


@dataclass(frozen=True)
class CellFields:
    """The material of a box, or its increment over a step. cells: those that have yielded, of (n_layers, nx,
    ny); points: the fields at their points, strain (6, 4, n); zero in all other cells.
    """

    cells: Mask
    points: MaterialFields

    @property
    def strain(self) -> Array:
        """Mean plastic strain of each cell, (6, n_layers, nx, ny)."""
        return filled(self.points.strain.mean(axis=1), self.cells)

    @property
    def peeq(self) -> Array:
        """Mean accumulated plastic strain of each cell, (n_layers, nx, ny)."""
        return filled(self.points.peeq.mean(axis=0), self.cells)

    def on(self, cells: Mask) -> MaterialFields:
        """The fields at the points of cells among which all of these are."""
        if self.cells is cells or np.array_equal(self.cells, cells):
            return self.points
        return self.points.each(lambda values: spread(values, self.cells, cells))

    def part(self, keep: Callable[[Mask], Mask]) -> CellFields:
        """The fields of a part of the box; keep: a view of the cells there."""
        inside = np.zeros_like(self.cells)
        keep(inside)[...] = True
        if inside.all():
            return self
        there = inside[self.cells]
        points = self.points.each(lambda values: values.compress(there, axis=-1))
        return CellFields(np.ascontiguousarray(keep(self.cells)), points)

    def on_box(self, old: Extent, new: Extent) -> CellFields:
        """The same on a larger box."""
        return CellFields(surrounded(self.cells, old.inside(new), new.shape), self.points)

    def plus(self, increment: CellFields) -> CellFields:
        """The sum of both."""
        cells = self.cells | increment.cells
        return CellFields(cells, self.on(cells).plus(increment.on(cells)))


@dataclass(frozen=True)
class ResidualFields:
    """What plastic strain makes without load: stress (6, n_layers, nx, ny) in Pa, u_z (nx, ny) in m."""

    stress: Array
    displacement: Array

    def plus(self, other: ResidualFields) -> ResidualFields:
        """The residual fields of the sum of two strains."""
        return ResidualFields(self.stress + other.stress, self.displacement + other.displacement)

    def minus(self, other: ResidualFields) -> ResidualFields:
        """The residual fields of the difference of two strains."""
        return ResidualFields(self.stress - other.stress, self.displacement - other.displacement)

    def times(self, ratio: float) -> ResidualFields:
        """The residual fields of the strain times a number."""
        return ResidualFields(ratio * self.stress, ratio * self.displacement)


@dataclass(frozen=True)
class State:
    """A committed state of the box: material, residual fields, p_hat (nx, ny), load."""

    material: CellFields
    residual: ResidualFields
    pressure: Array
    load: Load = UNLOADED

    def after(self, trial: Trial) -> State:
        """The state at the end of a step that converged; ValueError for one that did not."""
        if not trial.converged:
            raise ValueError("a step that did not converge cannot be committed")
        # the same fields where nothing yields: what was computed of them is still right
        material = self.material.plus(trial.increment) if trial.plastic else self.material
        return State(material, trial.residual, trial.pressure, trial.load)


@dataclass(frozen=True)
class Change:
    """An increment of the material and what it adds to the residual fields; ratio: how much of both."""

    increment: CellFields
    residual: ResidualFields
    ratio: float = 1.0


@dataclass(frozen=True)
class Trial:
    """The end of a load step, converged or not, not committed; increment: of the material; stress in
    Pa, (6, n_layers, nx, ny); residual: fields at its end; history: larger residual by iteration;
    goal: of it; rise: of the load.
    """

    load: Load
    increment: CellFields
    stress: Array
    residual: ResidualFields
    pressure: Array
    yield_excess: float
    flow_residual: float
    history: tuple[float, ...]
    converged: bool
    rise: float
    goal: float

    @property
    def excesses(self) -> dict[str, float]:
        """How far the step is from obeying the yield condition and the flow rule, by name."""
        return {"yield_excess": self.yield_excess, "flow_residual": self.flow_residual}

    @property
    def plastic(self) -> bool:
        """Whether the step strained any cell."""
        return bool(self.increment.cells.any())

    def change(self, state: State) -> Change | None:
        """What the step adds to the state that it began at; None if it strains nothing."""
        if not self.plastic:
            return None
        return Change(self.increment, self.residual.minus(state.residual))


@dataclass(frozen=True)
class Extent:
    """A box of cells: a window of the grid, and so many of its uppermost layers."""

    window: Window
    layers: int

    @property
    def shape(self) -> tuple[int, int, int]:
        """(n_layers, nx, ny)."""
        return self.layers, *self.window.shape

    def inside(self, larger: Extent) -> tuple[slice, slice, slice]:
        """Where the cells of this box are among those of a larger one."""
        i, j = self.window.i0 - larger.window.i0, self.window.j0 - larger.window.j0
        return slice(self.layers), slice(i, i + self.window.nx), slice(j, j + self.window.ny)


def surrounded(values: NDArray[T], where: tuple[slice, ...], shape: tuple[int, ...]) -> NDArray[T]:
    """Zeros around the values (..., *cells) of a field, as a box does that grows: (..., *shape), with the
    values at `where`, see `Extent.inside`.

    >>> surrounded(np.ones(2), (slice(1, 3),), (4,))
    array([0., 1., 1., 0.])
    """
    out: NDArray[T] = np.zeros((*values.shape[: values.ndim - len(shape)], *shape), dtype=values.dtype)
    out[(slice(None),) * (values.ndim - len(shape)) + where] = values
    return out


def on_larger_box(
    state: State, old: Extent, new: Extent, residual: Callable[[CellFields], ResidualFields]
) -> State:
    """The same state on a larger box. residual: what the material makes there."""
    material = state.material.on_box(old, new)
    pressure = surrounded(state.pressure, old.inside(new)[1:], new.window.shape)
    return replace(state, material=material, residual=residual(material), pressure=pressure)
