# SPDX-License-Identifier: MIT
"""What the study of running-in over its inputs found: whether each statement holds at each point, and which
inputs decide that: by how often it holds in both halves of their ranges, and by a fit of its measure.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import norm

from sam.scene import Scene
from verification.cases.running_in.running_in_fitted import Points
from verification.cases.running_in.running_in_inputs import INPUTS, Input, wilson
from verification.cases.running_in.running_in_runs import RunningInRun
from verification.cases.running_in.running_in_scenes import Effort
from verification.cases.running_in.running_in_statements import LAST, STATEMENTS, Histories, Statement
from verification.sensitivity import UNIFORM, indices
from verification.surrogate import Surrogate, surrogate

SEED = 26  # of the design and of what is resampled
CHANCE = 1e-3  # of each of 17 × 16 changes of probability: less than one of them is named by chance
PREDICTS = 0.5  # Q² of a fit that is believed: of 200 results without any cause at most two have it
PART = 0.1  # of the variance: an input with less of it is not named
RESPONSES = {
    "volume": lambda history: np.log10(1.0 + 1e18 * history.volume[-1]),
    "friction": lambda history: history.friction[-1],
    "roughness": lambda history: history.sa[-1],
}


@dataclass(frozen=True)
class Decider:
    """How much more often a statement holds in the upper half of an input's range than in the lower one, with
    bounds of 90 %. acts: whether that is beyond chance: by itself, or beyond its bounds where a fit of the
    measure tells that the input moves it.
    """

    input: Input
    change: float
    bounds: tuple[float, float]
    acts: bool

    @property
    def text(self) -> str:
        """For the reader."""
        low, high = (f"{100 * end:+.0f}" for end in self.bounds)
        return f"{self.input.words}: {100 * self.change:+.0f} % ({low} to {high})"


@dataclass(frozen=True)
class Studied:
    """shares: of the inputs, (points, inputs); runs: point and material -> what ran; predicted_s: by the
    plan; printed: the scene of each material before any input is put.
    """

    effort: Effort
    shares: np.ndarray
    runs: Mapping[tuple[int, str], RunningInRun]
    predicted_s: float
    printed: Mapping[str, Scene]

    @cached_property
    def histories(self) -> list[Histories]:
        """For each point the materials that converged."""
        return [
            {
                case: self.runs[point, case].history
                for case in self.effort.cases
                if self.runs[point, case].result.converged
            }
            for point in range(len(self.shares))
        ]

    @cached_property
    def measures(self) -> np.ndarray:
        """Of each statement at each point, (statements, points); NaN where it says nothing there."""
        return np.array([[_measured(each, own) for own in self.histories] for each in STATEMENTS])

    @cached_property
    def held(self) -> np.ndarray:
        """Whether a statement holds at a point, (statements, points); NaN where it says nothing there."""
        return np.array(
            [
                [np.nan if np.isnan(value) else float(statement.holds(value)) for value in row]
                for statement, row in zip(STATEMENTS, self.measures, strict=True)
            ]
        )

    @cached_property
    def fits(self) -> list[Surrogate | None]:
        """Of the measure of each statement."""
        return [surrogate(self.shares, row) for row in self.measures]

    @cached_property
    def deciders(self) -> list[list[Decider]]:
        """Of each statement."""
        return [deciders(self.shares, *each) for each in zip(self.held, self.fits, strict=True)]

    @property
    def judged(self) -> bool:
        """Whether there are as many cycles as the statements ask for."""
        return self.effort.cycles >= LAST

    @property
    def lost(self) -> int:
        """Runs without a converged result."""
        return sum(not one.result.converged for one in self.runs.values())

    @property
    def counts(self) -> np.ndarray:
        """Statements that hold together at a point, (points,)."""
        return np.nansum(self.held, axis=0).astype(int)

    @property
    def points(self) -> Points:
        """For the points at which most statements hold."""
        scenes = {key: one.scene for key, one in self.runs.items()}
        return Points(self.shares, self.counts, scenes, self.printed)

    def response(self, case: str, name: str) -> np.ndarray:
        """One of RESPONSES at each point, NaN where the run did not converge."""
        of = RESPONSES[name]
        return np.array([of(own[case]) if case in own else np.nan for own in self.histories])

    def correlations(self, case: str, name: str) -> np.ndarray:
        """Of the ranks of a response with those of each input; NaN where it never changes."""
        found = indices(UNIFORM, self.shares, self.response(case, name), SEED)
        return found[0].values if found else np.full(len(INPUTS), np.nan)


def _measured(statement: Statement, histories: Histories) -> float:
    return float(statement.value(histories)) if set(statement.cases) <= set(histories) else np.nan


def deciders(shares: np.ndarray, held: np.ndarray, fit: Surrogate | None = None) -> list[Decider]:
    """The inputs that decide a statement, the first most. held: (points,), NaN: says nothing; fit: of its
    measure.
    """
    says = np.isfinite(held)
    moves = fit.shares >= PART if believed(fit) else np.zeros(len(INPUTS), dtype=bool)
    found = []
    for share, one, moved in zip(shares.T[:, says], INPUTS, moves, strict=True):
        high, low = held[says][share >= 0.5], held[says][share < 0.5]
        if high.size and low.size:
            bounds = change_between(high, low, 0.9)
            wide = bounds if moved else change_between(high, low, 1.0 - CHANCE)
            change = float(high.mean() - low.mean())
            found.append(Decider(one, change, bounds, wide[0] > 0.0 or wide[1] < 0.0))
    return sorted(found, key=lambda each: (not each.acts, -abs(each.change)))


def believed(fit: Surrogate | None) -> bool:
    """Whether a fit predicts the points that it has not seen."""
    return fit is not None and fit.predicted >= PREDICTS


def change_between(high: np.ndarray, low: np.ndarray, level: float) -> tuple[float, float]:
    """Bounds of the difference of two probabilities: Newcombe, Stat. Med. 17 (1998) 873, method 10."""
    ends = [(part.mean(), *wilson(int(part.sum()), part.size, level)) for part in (high, low)]
    (p, p_low, p_high), (q, q_low, q_high) = ends
    bounds = p - q - np.hypot(p - p_low, q_high - q), p - q + np.hypot(p_high - p, q - q_low)
    return float(bounds[0]), float(bounds[1])


def least_change(points: int) -> float:
    """Smallest change of a probability near a half that is beyond CHANCE, between the halves of a range."""
    return float(norm.isf(CHANCE / 2.0) * np.sqrt(2.0 * 0.25 / (points / 2.0)))


def two_most(found: Studied) -> list[tuple[int, Input]]:
    """The two inputs that change most statements beyond chance; of equal ones those that change by most."""
    decided = decided_by(found)
    total = dict.fromkeys(decided, 0.0)
    for each in itertools.chain(*found.deciders):
        total[each.input.name] += abs(each.change)
    return sorted(enumerate(INPUTS), key=lambda pair: (-decided[pair[1].name], -total[pair[1].name]))[:2]


def decided_by(found: Studied) -> dict[str, int]:
    """Name of an input -> number of statements whose probability it changes beyond chance."""
    acting = [each.input.name for each in itertools.chain(*found.deciders) if each.acts]
    return {one.name: acting.count(one.name) for one in INPUTS}
