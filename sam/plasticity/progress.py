# SPDX-License-Identifier: MIT
"""The record of a load history: all that later steps read, so a history continued from it takes the same
steps, bit for bit.

A checkpoint holds this record and nothing else. It is frozen; `sam.plasticity.history.onward` makes the next
one of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sam.arrays import ROUNDING, Array, Mask
from sam.contact.convolution import Counters
from sam.grid.cells import Room
from sam.plasticity.model import Model
from sam.plasticity.state import CellFields, Change, Extent, State, Trial, filled, surrounded
from sam.results.history import History
from sam.scene import Status
from sam.scene.result import Attempt
from sam.scene.verdict import Period, Verdict, cell_fields, norm_of, verdict_on
from sam.schedule import Load, Target
from sam.tribofilm.state import TribofilmState
from sam.wear import WearState


@dataclass(frozen=True)
class Added:
    """What a period added to some cells of a box, (n,) and (6, n); worn: depth in m before it."""

    extent: Extent
    cells: Mask
    accumulated: Array
    norm: Array
    strain: Array | None
    worn: Array | None = None

    def on(self, extent: Extent, before: Array | None) -> Period:
        """The cells of a box in one row. before: worn depth at the beginning of the period before it."""
        where, shape = self.extent.inside(extent), extent.shape
        cells = surrounded(self.cells, where, shape)
        accumulated, norm = (filled(part, cells).ravel() for part in (self.accumulated, self.norm))
        strain = None if self.strain is None else filled(self.strain, cells).reshape(6, -1)
        restarted = None
        if self.worn is not None and before is not None:
            moved = (self.worn != before)[extent.window.slices]
            restarted = np.broadcast_to(moved, shape).ravel()
        return Period(accumulated, norm, strain, restarted)


@dataclass(frozen=True)
class Begun:
    """The material at the beginning of a cycle or period, on a box; worn as of `Added`."""

    extent: Extent
    material: CellFields
    worn: Array | None = None

    def added(self, state: State, extent: Extent) -> Added:
        """What a later state has more."""
        before = self.material.on_box(self.extent, extent)
        cells = state.material.cells | before.cells  # material may be gone where it was
        start, end = before.on(cells), state.material.on(cells)
        strain = end.strain.mean(axis=1) - start.strain.mean(axis=1)
        accumulated = end.peeq.mean(axis=0) - start.peeq.mean(axis=0)
        return Added(extent, cells, accumulated, norm_of(strain), strain, self.worn)

    def new_strain(self, state: State, extent: Extent) -> Array:
        """Accumulated plastic strain of a later state of the same cycle that is new, on the box of that."""
        return state.material.peeq - self.material.on_box(self.extent, extent).peeq


@dataclass(frozen=True)
class Periods:
    """The periods so far. begun: of the present one; last: those that have ended; verdicts: after each."""

    begun: Begun | None = None
    last: tuple[Added, ...] = ()
    verdicts: tuple[Verdict, ...] = ()

    def ended(self, model: Model, state: State, extent: Extent) -> Periods:
        """The same with the period that a state ends, before anything is removed from it."""
        if self.begun is None or model.plan.judging is None:
            raise ValueError("no period has begun")
        earlier = (*(replace(period, strain=None) for period in self.last[:-1]), *self.last[-1:])
        added = (*earlier, self.begun.added(state, extent))
        verdict = verdict_on(
            _compared(added, extent),
            state.material.peeq.ravel(),
            _yield_strain(model, extent),
            model.plan.judging,
            volume=np.broadcast_to(model.volumes(extent), extent.shape).ravel(),
        )
        return Periods(None, added, (*self.verdicts, verdict))

    def fields(self, model: Model, state: State, extent: Extent) -> dict[str, Array]:
        """Fields of the last period on a box, (n_layers, nx, ny) each; nothing before its end."""
        if model.plan.judging is None or not self.last:
            return {}
        compared, total = _compared(self.last, extent), state.material.peeq.ravel()
        of_cells = cell_fields(compared, total, _yield_strain(model, extent), model.plan.judging)
        return {name: values.reshape(extent.shape) for name, values in of_cells.items()}

    def at(self, place: Callable[[Extent], Extent]) -> Periods:
        """The same on another grid. place: of a box on it."""
        begun = self.begun and replace(self.begun, extent=place(self.begun.extent))
        return replace(
            self,
            begun=begun,
            last=tuple(replace(period, extent=place(period.extent)) for period in self.last),
        )


def _compared(added: Sequence[Added], extent: Extent) -> list[Period]:
    """The periods on one box."""
    before = [None, *(period.worn for period in added)]
    return [period.on(extent, worn) for period, worn in zip(added, before, strict=False)]


def _yield_strain(model: Model, extent: Extent) -> Array:
    """Initial yield stress over Young's modulus in each cell of a box, (n,)."""
    strain = model.plan.initial_yield[: extent.layers] / model.plan.pair.body.young
    return np.broadcast_to(strain[:, None, None], extent.shape).ravel()


def floor(model: Model, extent: Extent) -> Array:
    """Strain of each cell of a box below which a period counts as without plastic strain, (n,)."""
    if model.plan.judging is None:
        raise ValueError("the scene is not judged")
    return model.plan.judging.floor * _yield_strain(model, extent)


@dataclass(frozen=True)
class Parts:
    """What is committed of the step to the first target: parts, iterations, largest residual, attempts."""

    count: int = 0
    iterations: int = 0
    worst: float = 0.0
    attempts: tuple[Attempt, ...] = ()

    def with_(self, trial: Trial) -> Parts:
        """The same with one more part."""
        worst = max(self.worst, trial.history[-1]) if self.count else trial.history[-1]
        tried = self.tried(trial)
        return Parts(self.count + 1, self.iterations + len(trial.history), worst, tried.attempts)

    def tried(self, trial: Trial) -> Parts:
        """The same with one more attempt."""
        return replace(self, attempts=(*self.attempts, Attempt(trial.converged, trial.history, trial.goal)))


@dataclass(frozen=True)
class Outside:
    """Plastic u_z of the surface (nx, ny) in m, and stress in the rows at y = 0, (6, nz, nx, rows) in Pa."""

    displacement: Array
    stress: Array | None = None


@dataclass(frozen=True)
class Progressed:
    """A history after a committed step, or part of one: state on a box, targets to come, work, what
    the surface remembers; last, change: the trial committed last; cuts: loads to the first target;
    parts: committed of it; recalled: p_hat of earlier steps by load; outside: None where to be
    computed; longer: the longer iteration; cycle_start, periods: what strain counts from;
    dissipated: J in the cycle; left: the largest yield excess and flow residual of its steps.
    """

    state: State
    extent: Extent
    room: Room
    targets: tuple[Target, ...]
    counters: Counters
    tribofilm: TribofilmState | None = None
    wear: WearState | None = None
    last: Trial | None = None
    change: Change | None = None
    cuts: tuple[Load, ...] = ()
    parts: Parts = Parts()
    history: History = field(default_factory=History)
    recalled: Mapping[str, Array] = field(default_factory=dict)
    outside: Outside | None = None
    longer: bool = False
    cycle_start: Begun | None = None
    periods: Periods = field(default_factory=Periods)
    dissipated: float = 0.0
    left: tuple[float, float] = (0.0, 0.0)

    @property
    def ended(self) -> bool:
        """Whether all targets are reached, or one was not."""
        return not self.targets or self.history.status is not Status.CONVERGED

    def guess(self, load: Load) -> Change | None:
        """What the last step changed, scaled with the load, while the load rises on the same box."""
        if self.change is None or self.last is None or self.change.increment.cells.shape != self.extent.shape:
            return None
        ratio = load.rise(self.state.load) / (self.last.rise or float("inf"))
        return replace(self.change, ratio=ratio) if 0 < ratio <= 1 + ROUNDING else None
