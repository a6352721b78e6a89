# SPDX-License-Identifier: MIT
"""The load history of an elasto-plastic scene, target by target, and the record of how far it has come.

Unloading takes one step if that strains nothing, else `unload_steps`. A step that does not converge is cut in halves.
`Progressed` holds all that later steps read, so a history that is continued from one takes
the same steps with the same rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.contact.convolution import Counters
from sam.contact.normal import Contact
from sam.elastic import UNLOADING
from sam.grid.cells import Room, Window
from sam.loading import Load, Target, in_steps
from sam.plasticity.extent import Extent
from sam.plasticity.recorder import Recorder
from sam.plasticity.step import Change, State, Trial
from sam.record import CycleEnd, Row, Snapshot, row_of
from sam.scene.residuals import Attempt
from sam.sliding import Sliding

if TYPE_CHECKING:
    from sam.plasticity.run import Run
    from sam.tribofilm.state import Film
    from sam.wear.ledger import Ledger

MOST_CUTS = 6  # halvings of a load step


@dataclass(frozen=True)
class Peak:
    """What is recorded of the largest load besides its snapshot: residuals of the step."""

    yield_excess: float
    flow_residual: float


@dataclass(frozen=True)
class Parts:
    """What is already committed of the step to the first target: number of parts, iterations, largest residual.

    attempts: also those that were discarded.
    """

    count: int = 0
    iterations: int = 0
    worst: float = 0.0
    attempts: tuple[Attempt, ...] = ()

    def with_(self, trial: Trial) -> Parts:
        worst = max(self.worst, trial.history[-1]) if self.count else trial.history[-1]
        tried = self.tried(trial)
        return Parts(self.count + 1, self.iterations + len(trial.history), worst, tried.attempts)

    def tried(self, trial: Trial) -> Parts:
        """With one more attempt."""
        return replace(self, attempts=(*self.attempts, Attempt(trial.converged, trial.history, trial.goal)))

    @classmethod
    def from_tree(cls, tree: dict) -> Parts:
        return cls(**tree | {"attempts": tuple(Attempt.from_tree(each) for each in tree["attempts"])})


@dataclass(frozen=True)
class Progressed:
    """A history after a committed step, or part of one.

    state, extent, last, change: of the box (see `Run`); targets: to come; cuts: loads on the way to the first of them, itself
    the last, empty before its step begins; outside: see `Recorder.known`; room: of the grid.
    """

    state: State
    extent: Extent
    last: Trial | None
    change: Change | None
    counters: Counters
    targets: list[Target]
    cuts: list[Load]
    parts: Parts
    rows: list[Row]
    snapshots: dict[str, Snapshot]
    peak: Peak | None
    ends: list[CycleEnd]
    ledger: Any
    film: Any
    recalled: dict[str, np.ndarray]
    outside: dict[str, np.ndarray]
    room: Room

    @classmethod
    def from_tree(cls, tree: dict) -> Progressed:
        """From the tree of a checkpoint, see `sam.scene.checkpoint`."""
        extent, last, change, peak = (tree[name] for name in ("extent", "last", "change", "peak"))
        return cls(
            state=State(**_with_load(tree["state"])),
            extent=Extent(Window(**extent["window"]), extent["layers"]),
            last=last and Trial(**_with_load(last) | {"history": tuple(last["history"])}),
            change=change and Change(**change),
            counters=Counters(**tree["counters"]),
            targets=[Target(**_with_load(target)) for target in tree["targets"]],
            cuts=[Load(**load) for load in tree["cuts"]],
            parts=Parts.from_tree(tree["parts"]),
            rows=[Row.from_tree(row) for row in tree["rows"]],
            snapshots={
                name: Snapshot(**_with_cut(_with_sliding(_with_contact(each))))
                for name, each in tree["snapshots"].items()
            },
            peak=peak and Peak(**peak),
            ends=[CycleEnd.from_tree(end) for end in tree["ends"]],
            ledger=_ledger(tree["ledger"]),
            film=_film(tree["film"]),
            recalled=tree["recalled"],
            outside=tree["outside"],
            room=Room(**tree["room"]),
        )


def _with_load(tree: dict) -> dict:
    return tree | {"load": Load(**tree["load"])}


def _with_sliding(tree: dict) -> dict:
    return tree | {"sliding": tree["sliding"] and Sliding(**tree["sliding"])}


def _with_cut(tree: dict) -> dict:
    if not tree["cut"]:
        return tree
    from sam.cut import Cut

    return tree | {"cut": Cut(**tree["cut"])}


def _with_contact(tree: dict) -> dict:
    contact = tree["contact"]
    return tree | {"contact": Contact(**contact | {"box": Window(**contact["box"])})}


def _ledger(tree: dict | None) -> Ledger | None:
    if tree is None:
        return None
    from sam.wear.ledger import Ledger

    return Ledger(
        **{name: tuple(value) if isinstance(value, list) else value for name, value in tree.items()}
    )


def _film(tree: dict | None) -> Film | None:
    if tree is None:
        return None
    from sam.tribofilm.law import FilmState
    from sam.tribofilm.state import Film

    return Film(FilmState(**tree["state"]), tree["reference"])


@dataclass
class History:
    """The loading of a `Run` in progress. committed: called after each committed step, or part of one."""

    run: Run
    committed: Callable[[History], None]
    targets: list[Target]
    cuts: list[Load] = field(default_factory=list)
    parts: Parts = Parts()
    rows: list[Row] = field(default_factory=list)
    snapshots: dict[str, Snapshot] = field(default_factory=dict)
    peak: Peak | None = None
    ends: list[CycleEnd] = field(default_factory=list)

    def __post_init__(self):
        self.recorder = Recorder(self.run)

    @classmethod
    def continued(cls, run: Run, committed: Callable[[History], None], start: Progressed) -> History:
        """On a run that was continued from the same record."""
        history = cls(
            run, committed, list(start.targets), list(start.cuts), start.parts, list(start.rows),
            dict(start.snapshots), start.peak, list(start.ends),
        )  # fmt: skip
        history.recorder.recall(start.outside)
        return history

    def progressed(self) -> Progressed:
        """The record of it; what it holds is not changed later."""
        run = self.run
        return Progressed(
            run.state, run.extent, run.last, run.change, replace(run.counters), list(self.targets), list(self.cuts),
            self.parts, list(self.rows), dict(self.snapshots), self.peak, list(self.ends), run.ledger,
            run.protection and run.protection.film, dict(run.recalled), self.recorder.known(), run.grid.room,
        )  # fmt: skip

    def advance(self) -> bool:
        """Load or unload to the first target, in as many cuts as it takes; False, and no row, if that failed."""
        target = self.targets[0]
        if target.step == 1 and not self.cuts:
            self.run.begin_cycle()
        if target.at_once:
            return self._unload_at_once(target)
        self.cuts = self.cuts or [target.load]
        while self.cuts:
            trial = self.run.attempt(self.cuts[0])
            if trial is None:
                return False
            if trial.converged:
                self.cuts.pop(0)
                self.parts = self.parts.with_(trial)
                if not self.cuts:
                    self._reached(target, trial)
                self.committed(self)
            elif not self._cut(trial):
                return False
        return True

    def _cut(self, trial: Trial) -> bool:
        """Halve the way to the next load after an attempt; False if it was halved too often."""
        self.parts = self.parts.tried(trial)
        if len(self.cuts) > MOST_CUTS:
            self.run.give_up(trial)
            return False
        self.run.counters.step_cuts += 1
        self.cuts.insert(0, self.run.state.load.halfway_to(self.cuts[0]))
        return True

    def _unload_at_once(self, target: Target) -> bool:
        """In one step if that strains nothing, else nothing is done but to plan the steps of the scene."""
        run = self.run
        if not run.problem.stays_elastic(run.state):
            self.targets[:1] = in_steps(target, run.scene)
            return True
        trial = run.problem.step(run.state, target.load)
        if not trial.converged or trial.plastic:
            self.targets[:1] = in_steps(target, run.scene)
            return True
        run.commit(trial)
        self.parts = self.parts.with_(trial)
        self._reached(target, trial, UNLOADING)
        self.committed(self)
        return True

    def _reached(self, target: Target, trial: Trial, note: str = "") -> None:
        """Record the step that `trial` ends."""
        run, recorder, parts, note = self.run, self.recorder, self.parts, note or target.note
        if parts.count > 1:
            note = "; ".join(filter(None, (note, f"cut into {parts.count} steps")))
        peeq_max = float(run.state.alpha.max())
        row = row_of(
            run.scene, run.grid, target.cycle, target.step, trial.load.force, recorder.contact(trial), recorder.friction(trial),
            parts.iterations, parts.worst, note, peeq_max, parts.attempts,
        )  # fmt: skip
        self.rows.append(row)
        self.targets.pop(0)
        self.parts = Parts()
        if not self.targets or self.targets[0].cycle > target.cycle:
            trial = self._ended(target, trial)
        if target.snapshot == "peak":
            self.peak = Peak(trial.yield_excess, trial.flow_residual)
        if target.snapshot:
            self.snapshots[target.snapshot] = recorder.snapshot(target.snapshot, trial)

    def _ended(self, target: Target, trial: Trial) -> Trial:
        """The end of a cycle: wear, if the body is unloaded. The trial at its end."""
        if trial.load.force == 0:
            trial = self.run.end_cycle(trial)
            if self.run.ledger is not None and self.run.ledger.volumes[-1]:
                words = f"{self.run.ledger.volumes[-1]:.6g} m3 torn off"
                last = self.rows[-1]
                self.rows[-1] = replace(last, note="; ".join(filter(None, (last.note, words))))
        self.ends.append(self.recorder.ended(target.cycle))
        return trial
