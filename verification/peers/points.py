# SPDX-License-Identifier: MIT
"""Measurements with their errors, as curves of error over time, and what a given error costs each program."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from verification.cost.precision import Reached, at_error
from verification.peers.running import NAMES, Measurement


@dataclass(frozen=True)
class PeerPoint:
    """A program with one setting on one grid. error: the one that times are compared at, nan where there is
    no answer; also: other measures, name -> value.
    """

    program: str
    measurement: Measurement
    error: float
    also: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return NAMES.get(self.program, self.program)

    @property
    def label(self) -> str:
        return ", ".join(filter(None, (self.name, self.measurement.job.label)))

    @property
    def cells(self) -> Any:
        return self.measurement.job.cells

    @property
    def seconds(self) -> float:
        return self.measurement.seconds


Errors = Callable[[Measurement], tuple[float, Mapping[str, float]]]


def points_of(found: Mapping[str, Sequence[Measurement]], errors: Errors) -> list[PeerPoint]:
    """Every measurement with its error; nan for those without an answer."""
    return [
        PeerPoint(program, each, *(errors(each) if each.solved else (float("nan"), {})))
        for program, own in found.items()
        for each in own
    ]


def curves(points: Sequence[PeerPoint]) -> dict[str, list[PeerPoint]]:
    """The points of each label, in their order: coarse to fine."""
    return {
        label: [p for p in points if p.label == label] for label in dict.fromkeys(p.label for p in points)
    }


def reached(points: Sequence[PeerPoint], target: float) -> dict[str, tuple[str, Reached]]:
    """Program -> its curve that is first at an error of `target`, and when; a curve that never is there
    counts last.
    """
    found: dict[str, tuple[str, Reached]] = {}
    for label, own in curves(points).items():
        solved = [p for p in own if p.measurement.solved]
        time = at_error([p.seconds for p in solved], [p.error for p in solved], target)
        before = found.get(own[0].name)
        if before is None or (time.value or float("inf")) < (before[1].value or float("inf")):
            found[own[0].name] = label, time
    return found


def fastest(points: Sequence[PeerPoint], cells: Any, error: float = float("inf")) -> dict[str, PeerPoint]:
    """Program -> its fastest point on these cells with at most this error."""
    found: dict[str, PeerPoint] = {}
    for p in points:
        better = p.name not in found or p.seconds < found[p.name].seconds
        if p.cells == cells and p.measurement.solved and p.error <= error and better:
            found[p.name] = p
    return found


def ratio(slower: float | None, faster: float | None) -> float:
    """slower/faster; nan where one of them is missing."""
    return slower / faster if slower and faster else float("nan")
