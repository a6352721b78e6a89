# SPDX-License-Identifier: MIT
"""The plastic strain that each period of a repeated load adds to the cells of the box, and the verdict on it;
see `sam.scene.verdict`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sam.arrays import Array
from sam.plasticity.model import Model
from sam.plasticity.state import Extent, State, surrounded
from sam.scene.verdict import Period, Verdict, cell_fields, norm_of, verdict_on


@dataclass(frozen=True)
class Added:
    """What a period added on a box: accumulated and the norm of the strain, (n_layers, nx, ny), and the
    strain, (6, n_layers, nx, ny), None of all but the last two periods; worn: depth in m at its beginning on
    the grid, (nx, ny), None if nothing wears.
    """

    extent: Extent
    accumulated: Array
    norm: Array
    strain: Array | None
    worn: Array | None = None

    def on(self, extent: Extent, before: Array | None) -> Period:
        """The cells of a box in one row. before: worn depth at the beginning of the period before it."""
        where, shape = self.extent.inside(extent), extent.shape
        accumulated, norm = (surrounded(each, where, shape).ravel() for each in (self.accumulated, self.norm))
        strain = None if self.strain is None else surrounded(self.strain, where, shape).reshape(6, -1)
        restarted = None
        if self.worn is not None and before is not None:
            moved = (self.worn != before)[extent.window.slices]
            restarted = np.broadcast_to(moved, shape).ravel()
        return Period(accumulated, norm, strain, restarted)


@dataclass(frozen=True)
class Begun:
    """Plastic strain and accumulated one at the beginning of a period, on a box; worn as of `Added`."""

    extent: Extent
    strain: Array
    peeq: Array
    worn: Array | None = None

    def added(self, state: State, extent: Extent) -> Added:
        """What a later state has more."""
        where, shape = self.extent.inside(extent), extent.shape
        strain = state.material.strain - surrounded(self.strain, where, shape)
        accumulated = state.material.peeq - surrounded(self.peeq, where, shape)
        return Added(extent, accumulated, norm_of(strain), strain, self.worn)


@dataclass(frozen=True)
class Periods:
    """The periods so far. begun: of the present one; last: those that have ended; verdicts: after each."""

    begun: Begun | None = None
    last: tuple[Added, ...] = ()
    verdicts: tuple[Verdict, ...] = ()

    def ended(self, model: Model, state: State, extent: Extent) -> Periods:
        """The same with the period that a state ends, before anything is removed from it."""
        if self.begun is None or model.judging is None:
            raise ValueError("no period has begun")
        earlier = (*(replace(each, strain=None) for each in self.last[:-1]), *self.last[-1:])
        added = (*earlier, self.begun.added(state, extent))
        found = verdict_on(
            _compared(added, extent),
            state.material.peeq.ravel(),
            _yield_strain(model, extent),
            model.judging,
            volume=np.broadcast_to(model.volumes(extent), extent.shape).ravel(),
        )
        return Periods(None, added, (*self.verdicts, found))

    def fields(self, model: Model, state: State, extent: Extent) -> dict[str, Array]:
        """Fields of the last period on a box, (n_layers, nx, ny) each; nothing before its end."""
        if model.judging is None or not self.last:
            return {}
        compared, total = _compared(self.last, extent), state.material.peeq.ravel()
        found = cell_fields(compared, total, _yield_strain(model, extent), model.judging)
        return {name: values.reshape(extent.shape) for name, values in found.items()}

    def at(self, place: Callable[[Extent], Extent]) -> Periods:
        """The same on another grid. place: of a box on it."""
        begun = self.begun and replace(self.begun, extent=place(self.begun.extent))
        return replace(
            self, begun=begun, last=tuple(replace(each, extent=place(each.extent)) for each in self.last)
        )


def _compared(added: Sequence[Added], extent: Extent) -> list[Period]:
    """The periods on one box."""
    before = [None, *(each.worn for each in added)]
    return [each.on(extent, worn) for each, worn in zip(added, before, strict=False)]


def _yield_strain(model: Model, extent: Extent) -> Array:
    """Initial yield stress over Young's modulus in each cell of a box, (n,)."""
    strain = model.body.initial_yield(model.grid.depths[: extent.layers]) / model.body.elastic.young
    return np.broadcast_to(strain[:, None, None], extent.shape).ravel()


def floor(model: Model, extent: Extent) -> Array:
    """Strain of each cell of a box below which a period counts as without plastic strain, (n,)."""
    if model.judging is None:
        raise ValueError("the scene is not judged")
    return model.judging.floor * _yield_strain(model, extent)
