# SPDX-License-Identifier: MIT
"""The plastic state of a box of cells: frozen records of named fields, with one rule for each kind of field.

Three kinds of fields make up a state, and nothing else has to know their names:

* fields of the material (`MaterialFields`), tensors of any shape in each cell: when the box grows there are
  zeros around them; when the surface wears the columns of cells move up; a step adds its increment;
* residual fields, what is left without load and follows from the plastic strain (`ResidualFields`): they
  are computed anew when the box grows and when it wears;
* fields of the loaded surface (the pressure): when the box grows there are zeros around them.

A law that needs more memory (the misfit strain of a phase, say) adds a field to `MaterialFields`. A
checkpoint takes the records apart by their fields, and needs no rule of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from sam.arrays import Array
from sam.grid.cells import Window
from sam.schedule import UNLOADED, Load


@dataclass(frozen=True)
class MaterialFields:
    """What the material remembers at the points of the cells of a box, its increment over a step, or means
    over the points, without the axis of 4: plastic strain, (6, 4, n_layers, nx, ny); peeq: accumulated;
    back: strains a_k of the back-stresses, (N, 6, 4, ...), or None.
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

    def means(self) -> MaterialFields:
        """The means over the points of each cell, of fields at the points."""
        return self.each(lambda values: values.mean(axis=-4))

    def plus(self, increment: MaterialFields) -> MaterialFields:
        """The sum of both."""
        more = increment.by_name()
        return MaterialFields(**{name: values + more[name] for name, values in self.by_name().items()})


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
    """A committed state of the box: material at the points, residual fields, p_hat (nx, ny), load."""

    points: MaterialFields
    residual: ResidualFields
    pressure: Array
    load: Load = UNLOADED

    @cached_property
    def material(self) -> MaterialFields:
        """The means over the points of each cell."""
        return self.points.means()

    def after(self, trial: Trial) -> State:
        """The state at the end of a step that converged; ValueError for one that did not."""
        if not trial.converged:
            raise ValueError("a step that did not converge cannot be committed")
        # the same fields where nothing yields: what was computed of them is still right
        points = self.points.plus(trial.points) if trial.plastic else self.points
        return State(points, trial.residual, trial.pressure, trial.load)


@dataclass(frozen=True)
class Change:
    """An increment of the plastic strain, (6, n_layers, nx, ny), and what it adds to the residual fields."""

    strain: Array
    residual: ResidualFields

    def times(self, ratio: float) -> Change:
        """All is linear in the increment."""
        return Change(ratio * self.strain, self.residual.times(ratio))


@dataclass(frozen=True)
class Trial:
    """The end of a load step, converged or not, not committed; points: increment there; stress in
    Pa, (6, n_layers, nx, ny); residual: fields at its end; history: larger residual by iteration;
    goal: of it; rise: of the load.
    """

    load: Load
    points: MaterialFields
    stress: Array
    residual: ResidualFields
    pressure: Array
    yield_excess: float
    flow_residual: float
    history: tuple[float, ...]
    converged: bool
    rise: float
    goal: float

    @cached_property
    def increment(self) -> MaterialFields:
        """The means over the points of each cell."""
        return self.points.means()

    @property
    def excesses(self) -> dict[str, float]:
        """How far the step is from obeying the yield condition and the flow rule, by name."""
        return {"yield_excess": self.yield_excess, "flow_residual": self.flow_residual}

    @property
    def plastic(self) -> bool:
        """Whether the step strained any cell."""
        return bool(self.points.strain.any())

    def change(self, state: State) -> Change | None:
        """What the step adds to the state that it began at; None if it strains nothing."""
        if not self.plastic:
            return None
        return Change(self.increment.strain, self.residual.minus(state.residual))


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


def surrounded(values: Array, where: tuple[slice, ...], shape: tuple[int, ...]) -> Array:
    """Zeros around the values (..., *cells) of a field, as a box does that grows: (..., *shape), with the
    values at `where`, see `Extent.inside`.

    >>> surrounded(np.ones(2), (slice(1, 3),), (4,))
    array([0., 1., 1., 0.])
    """
    out = np.zeros((*values.shape[: values.ndim - len(shape)], *shape))
    out[(slice(None),) * (values.ndim - len(shape)) + where] = values
    return out


def on_larger_box(
    state: State, old: Extent, new: Extent, residual: Callable[[MaterialFields], ResidualFields]
) -> State:
    """The same state on a larger box. residual: what the material makes there."""
    where = old.inside(new)
    points = state.points.each(lambda values: surrounded(values, where, new.shape))
    pressure = surrounded(state.pressure, where[1:], new.window.shape)
    return replace(state, points=points, residual=residual(points.means()), pressure=pressure)
