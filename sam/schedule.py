# SPDX-License-Identifier: MIT
"""The load history as a list of states, each with its force or approach, its place and the sign of its
traction.

Equal steps to the peak, along the path of a travelling load if there is one, then to zero. In full slip the
traction on the body is q = coefficient * p along x, at every step; its sign may change from cycle to cycle.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from functools import cached_property
from math import nan

import numpy as np

from sam.arrays import Array


@dataclass(frozen=True)
class Approach:
    """A rigid approach of the bodies that is given in place of the force. distance: in m."""

    distance: float


@dataclass(frozen=True)
class Load:
    """What acts on the body. force in N, NaN before a given approach (m) is solved; sign: of the
    traction along x; x, y in m; stretch: of a rough counter-body; misfit: share of its strain.
    """

    force: float
    sign: float = 1.0
    x: float = 0.0
    y: float = 0.0
    approach: float | None = None
    stretch: int = 0
    misfit: float = 0.0

    @classmethod
    def by_approach(cls, approach: float) -> Load:
        """A load that gives the approach in m; its force is to be found."""
        return cls(nan, approach=approach)

    @property
    def level(self) -> float:
        """What is given: force in N, or approach in m; without either the share of the misfit strain."""
        if self.approach is not None:
            return self.approach
        return self.force or self.misfit

    @property
    def rests(self) -> bool:
        """Whether nothing acts."""
        return self.force == 0 and self.misfit == 0

    @property
    def given(self) -> float | Approach:
        """What is given, as the contact takes it."""
        return self.force if self.approach is None else Approach(self.approach)

    def found(self, force: float) -> Load:
        """The load of a solved contact: with its force in N where the approach is given."""
        return self if self.approach is None else replace(self, force=force)

    def by_force(self) -> Load:
        """The load of a solved contact, with its force given."""
        return replace(self, approach=None)

    def part(self, k: int, count: int) -> Load:
        """The load after k of so many equal steps to it."""
        approach = None if self.approach is None else self.approach * k / count
        return replace(self, force=self.force * k / count, approach=approach, misfit=self.misfit * k / count)

    def rise(self, start: Load) -> float:
        """How much more is given than at another load, in N or m; NaN if of another kind."""
        if (self.approach is None) != (start.approach is None) and self.force and start.force:
            return nan
        return self.level - start.level

    def halfway_to(self, other: Load) -> Load:
        """The load half the way to another one, with its sign; without force there is no place to leave."""
        x, y = (self.x, self.y) if self.force else (other.x, other.y)
        misfit = (self.misfit + other.misfit) / 2
        half = replace(other, x=(x + other.x) / 2, y=(y + other.y) / 2, misfit=misfit)
        if other.approach is None:
            return replace(half, force=(self.force + other.force) / 2)
        return replace(half, approach=((self.approach or 0.0) + other.approach) / 2)


UNLOADED = Load(0.0)


@dataclass(frozen=True)
class Target:
    """The end of a load step; snapshot: the state to record; elastic_unloading: in one step."""

    cycle: int
    step: int
    load: Load
    rises: bool
    snapshot: str = ""
    elastic_unloading: bool = False
    note: str = ""


@dataclass(frozen=True)
class Schedule:
    """All load steps of a scene, unloading in one. peak: the largest load; unload_steps: of a body
    that yields; path: places on the way forth in m; alternates: sign of the traction; renews,
    varies: surfaces between and along paths; returns: even cycles go back; remembers: a film.
    """

    targets: tuple[Target, ...]
    peak: Load
    unload_steps: int
    path: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    cycles: int = 1
    alternates: bool = False
    renews: bool = False
    returns: bool = False
    varies: bool = False
    remembers: bool = False

    @property
    def peaks(self) -> list[Load]:
        """The largest load on each stretch of the counter-body, and at each place where surfaces differ."""
        places = self.path if self.varies else ((self.peak.x, self.peak.y),)
        stretches = range(self.cycles if self.renews else 1)
        return [replace(self.peak, stretch=k, x=x, y=y) for k in stretches for x, y in places]

    @property
    def different(self) -> list[Target]:
        """The steps that an elastic body needs: of all cycles where these differ, else of the last."""
        return [target for target in self.targets if target.cycle == self.cycles or not self.all_alike]

    @property
    def all_alike(self) -> bool:
        """Whether the cycles of an elastic body differ in nothing but the sign of the traction."""
        return not (self.renews or self.returns or self.remembers)

    @property
    def rises(self) -> int:
        """Steps of the first cycle to the peak, those along a path included."""
        return self._rises_of[1]

    @cached_property
    def _rises_of(self) -> Counter[int]:
        return Counter(target.cycle for target in self.targets if target.rises)

    def at_peak(self, cycle: int, step: int) -> bool:
        """Whether a step of a cycle ends at the full load."""
        rises = self._rises_of[cycle]
        return rises - len(self.path) < step <= rises

    @property
    def unloads(self) -> bool:
        """Whether the history ends unloaded."""
        return not self.targets[-1].rises

    def in_steps(self, target: Target, peak: Load) -> list[Target]:
        """Unloading in equal steps of the force in place of a single one."""
        count = self.unload_steps
        left = [1 - k / count if k < count else 0.0 for k in range(1, count + 1)]
        loads = [replace(target.load, force=peak.force * part, misfit=peak.misfit * part) for part in left]
        steps = [Target(target.cycle, target.step + k, load, False) for k, load in enumerate(loads)]
        return [*steps[:-1], replace(steps[-1], snapshot=target.snapshot)]


Coefficient = float | Array
"""A number, or one for each cell, (nx, ny)."""


@dataclass(frozen=True)
class FullSlip:
    """The traction q = coefficient * p along x. slides: anywhere; coefficient: at the cells, the
    low one of a tribofilm; highest: of a failed one; coupled: moves the surfaces normally;
    coupling: 2 beta, or 1 with a coating; whole: coefficient under a whole film, or None.
    """

    slides: bool = False
    coefficient: Coefficient = 0.0
    highest: Coefficient = 0.0
    coupled: bool = False
    coupling: float = 0.0
    whole: float | None = None

    @property
    def uniform(self) -> bool:
        """Whether one coefficient holds everywhere and always."""
        return self.whole is None and np.ndim(self.coefficient) == 0
