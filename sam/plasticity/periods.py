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
from sam.scene.verdict import KEPT, Period, Verdict, cell_fields, verdict_on


@dataclass(frozen=True)
class Added:
    """What a period added on a box: accumulated (n_layers, nx, ny), strain (6, n_layers, nx, ny); worn: depth
    in m at its beginning on the grid, (nx, ny), None if nothing wears.
    """

    extent: Extent
    accumulated: Array
    strain: Array
    worn: Array | None = None

    def on(self, extent: Extent, before: Array | None) -> Period:
        """The cells of a box in one row. before: worn depth at the beginning of the period before it."""
        where, shape = self.extent.inside(extent), extent.shape
        strain = surrounded(self.strain, where, shape).reshape(6, -1)
        restarted = None
        if self.worn is not None and before is not None:
            moved = (self.worn != before)[extent.window.slices]
            restarted = np.broadcast_to(moved, shape).ravel()
        return Period(surrounded(self.accumulated, where, shape).ravel(), strain, restarted)


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
        return Added(
            extent,
            state.material.peeq - surrounded(self.peeq, where, shape),
            state.material.strain - surrounded(self.strain, where, shape),
            self.worn,
        )


@dataclass(frozen=True)
class Periods:
    """The periods so far. begun: of the present one; last: those that are compared; verdicts: after each."""

    begun: Begun | None = None
    last: tuple[Added, ...] = ()
    verdicts: tuple[Verdict, ...] = ()

    def ended(self, model: Model, state: State, extent: Extent) -> Periods:
        """The same with the period that a state ends, before anything is removed from it."""
        if self.begun is None or model.judging is None:
            raise ValueError("no period has begun")
        added = (*self.last, self.begun.added(state, extent))[-KEPT:]
        found = verdict_on(
            _compared(added, extent),
            state.material.peeq.ravel(),
            floor(model, extent),
            np.broadcast_to(model.volumes(extent), extent.shape).ravel(),
            worst=model.judging.worst,
        )
        return Periods(None, added, (*self.verdicts, found))

    def fields(self, model: Model, state: State, extent: Extent) -> dict[str, Array]:
        """Fields of the last period on a box, (n_layers, nx, ny) each; nothing before its end."""
        if model.judging is None or not self.last:
            return {}
        compared, total, worst = (
            _compared(self.last, extent),
            state.material.peeq.ravel(),
            model.judging.worst,
        )
        found = cell_fields(compared, total, floor(model, extent), worst=worst)
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


def floor(model: Model, extent: Extent) -> Array:
    """Strain of each cell of a box below which a period counts as without plastic strain, (n,)."""
    if model.judging is None:
        raise ValueError("the scene is not judged")
    strain = model.body.initial_yield(model.grid.depths[: extent.layers]) / model.body.elastic.young
    return np.broadcast_to(model.judging.floor * strain[:, None, None], extent.shape).ravel()
