# SPDX-License-Identifier: MIT
"""Which of the inputs that the paper leaves open decide its statements on running-in.

Every input is drawn evenly over its range, each point on another surface, and all materials are run at each
point: shares of the points at which a statement holds are probabilities over these ranges.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from sam.scene import Scene
from verification.cost.estimates import estimate
from verification.figures.running_in_sensitivity import best_pair, probabilities
from verification.sensitivity import UNIFORM, design, indices
from verification.suite.cases.case import SAM, Context, Measured, Plot, SmallTable
from verification.suite.cases.running_in import DeeperWhereItYields, solved
from verification.suite.cases.running_in_fitted import PRINTED, Points, fitted_note, fitted_table
from verification.suite.cases.running_in_inputs import INPUTS, Input, scene_at, wilson
from verification.suite.cases.running_in_runs import RunningInRun
from verification.suite.cases.running_in_scenes import Effort, reduced
from verification.suite.cases.running_in_statements import (
    BULK,
    LAST,
    NAMES,
    STATEMENTS,
    A,
    Histories,
    Statement,
)

SEED, SURFACES = 26, 100  # of the design; seeds of surfaces count from here, and are no others'
EFFORTS = {
    "quick": (4, Effort((BULK, A), (), cycles=2, steps=2, cells=24)),
    "full": (32, Effort(tuple(NAMES), (), cycles=LAST, steps=3, cells=64)),
}
"""Points, and what is run at each: the whole patch, since on a quarter of it most surfaces do not wear at
all."""
DECIDING = 2  # inputs named for each statement
CHANCE = 1e-3  # of each of 17 × 16 changes of probability: less than one of them is named by chance
ACTS = 3.3  # standard errors 1/sqrt(n - 1) of a correlation of ranks that chance passes once in a thousand
RESPONSES = {
    "volume": lambda history: np.log10(1.0 + 1e18 * history.volume[-1]),
    "friction": lambda history: history.friction[-1],
    "roughness": lambda history: history.sa[-1],
}


@dataclass(frozen=True)
class Decider:
    """How much more often a statement holds in the upper half of an input's range than in the lower one, with
    bounds of 90 %; acts: whether it is beyond chance.
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
    def held(self) -> np.ndarray:
        """Whether a statement holds at a point, (statements, points); NaN where it says nothing there."""
        return np.array([[_holds(each, own) for own in self.histories] for each in STATEMENTS])

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


def _holds(statement: Statement, histories: Histories) -> float:
    if not set(statement.cases) <= set(histories):
        return np.nan
    value = float(statement.value(histories))
    return np.nan if np.isnan(value) else float(statement.holds(value))


def deciders(shares: np.ndarray, held: np.ndarray) -> list[Decider]:
    """The inputs that decide a statement, the first most. held: (points,), NaN: says nothing."""
    says = np.isfinite(held)
    found = []
    for share, one in zip(shares.T[:, says], INPUTS, strict=True):
        high, low = held[says][share >= 0.5], held[says][share < 0.5]
        if high.size and low.size:
            wide = change_between(high, low, 1.0 - CHANCE)
            change = float(high.mean() - low.mean())
            found.append(Decider(one, change, change_between(high, low, 0.9), wide[0] > 0.0 or wide[1] < 0.0))
    return sorted(found, key=lambda each: -abs(each.change))


def change_between(high: np.ndarray, low: np.ndarray, level: float) -> tuple[float, float]:
    """Bounds of the difference of two probabilities: Newcombe, Stat. Med. 17 (1998) 873, method 10."""
    ends = [(part.mean(), *wilson(int(part.sum()), part.size, level)) for part in (high, low)]
    (p, p_low, p_high), (q, q_low, q_high) = ends
    bounds = p - q - np.hypot(p - p_low, q_high - q), p - q + np.hypot(p_high - p, q - q_low)
    return float(bounds[0]), float(bounds[1])


class RunningInSensitivity(DeeperWhereItYields):
    """All materials at every point of the design."""

    def ahead(self, context: Context) -> Iterator[Scene]:
        yield from scenes_of(context)[1].values()

    def solve(self, context: Context) -> Studied:
        shares, scenes = scenes_of(context)
        printed = bases_of(context)
        predicted = sum(estimate(scene, SAM).time_s for scene in scenes.values())
        runs = {
            (point, case): in_tables(solved(context, scene, f"point-{point:03}-{case}"))
            for (point, case), scene in scenes.items()
        }
        return Studied(EFFORTS[context.level][1], shares, runs, predicted, printed)

    def measure(self, found: Studied) -> dict[str, Measured]:
        points, cases = len(found.shares), found.effort.cases
        return {
            "missing": Measured(points * len(cases) - len(found.runs), 0),
            "lost": Measured(found.lost / len(found.runs)),
        }

    def setup(self, found: Studied) -> list[tuple[str, str]]:
        effort, points = found.effort, len(found.shares)
        took = sum(one.result.cost["cpu_s"] for one in found.runs.values())
        size = f"{points} points, {len(effort.cases)} materials: {len(found.runs)} runs"
        each = f"{effort.cells} × {effort.cells} cells, {effort.cycles} cycles, {effort.steps} load steps"
        return [
            ("Runs", f"{size} of {each}"),
            ("Inputs", "uniform and independent over their ranges, each point on another surface"),
            ("Processor time", f"{took / 60:.0f} min, predicted {found.predicted_s / 60:.0f} min"),
            ("Without a converged result", f"{found.lost} runs"),
            (
                "Sampling error of a probability",
                f"±{50 * np.diff(wilson(points // 2, points))[0]:.0f} % at a half (90 %)",
            ),
        ]

    def tables(self, found: Studied) -> Iterator[SmallTable]:
        yield ranges_table()
        if found.judged:
            yield statements_table(found)
            yield fitted_table(found.points)
        yield responses_table(found)

    def notes(self, found: Studied) -> Iterator[str]:
        if found.judged:
            yield fitted_note(found.points)

    def figures(self, found: Studied) -> Iterator[Plot]:
        if not found.judged:
            return
        names = [f"{each.figure}: {each.words}" for each in STATEMENTS]
        shares = [(int(np.nansum(row)), int(np.isfinite(row).sum())) for row in found.held]
        yield Plot(
            probabilities(
                [(name, held, of, wilson(held, of)) for name, (held, of) in zip(names, shares, strict=True)]
            ),
            "probabilities",
            "Probability that a statement of the paper holds",
            "A bar with its bounds for each of the 17 statements, and at how many points it holds.",
            "Right: points at which it holds, of those at which it says anything; bounds of 90 %.",
        )
        (first, second), decided = two_most(found), decided_by(found)
        places = [
            [one.factor * one.value(share) for share in found.shares[:, k]] for k, one in (first, second)
        ]
        yield Plot(
            best_pair(
                places,
                [one.words for _, one in (first, second)],
                found.counts,
                [one.logarithmic for _, one in (first, second)],
                printed=[one.factor * PRINTED[one.name] for _, one in (first, second)],
            ),
            "two-inputs",
            "Statements that hold together, over the two inputs that change them most",
            "A mark for each point over two inputs, coloured by the number of statements that hold there.",
            "All other inputs differ from point to point too. Statements whose probability is changed beyond "
            f"chance: {', '.join(f'{decided[one.name]} by {one.words}' for _, one in (first, second))}.",
        )


def in_tables(one: RunningInRun) -> RunningInRun:
    """A run without its fields, of which all runs have gigabytes; its files have them."""
    return RunningInRun(one.scene, replace(one.result, fields=None, grids={}))


def bases_of(context: Context) -> dict[str, Scene]:
    """The scene of each material as printed, on the grid and with the steps of the level."""
    effort = EFFORTS[context.level][1]
    return {case: reduced(context.scene(f"running-in-{case}"), effort) for case in effort.cases}


def scenes_of(context: Context) -> tuple[np.ndarray, dict[tuple[int, str], Scene]]:
    """Shares of the inputs at each point, and the scene of each point and material."""
    points, effort = EFFORTS[context.level]
    shares = design(UNIFORM, len(INPUTS), points, SEED)
    bases = bases_of(context)
    runs = itertools.product(range(points), effort.cases)
    return shares, {
        (point, case): scene_at(bases[case], shares[point], SURFACES + point) for point, case in runs
    }


def two_most(found: Studied) -> list[tuple[int, Input]]:
    """The two inputs that change most statements beyond chance; of equal ones those that change by most."""
    decided = decided_by(found)
    total = dict.fromkeys(decided, 0.0)
    for row in found.held:
        for each in deciders(found.shares, row):
            total[each.input.name] += abs(each.change)
    return sorted(enumerate(INPUTS), key=lambda pair: (-decided[pair[1].name], -total[pair[1].name]))[:2]


def decided_by(found: Studied) -> dict[str, int]:
    """Name of an input -> number of statements whose probability it changes beyond chance."""
    acting = [each.input.name for row in found.held for each in deciders(found.shares, row) if each.acts]
    return {one.name: acting.count(one.name) for one in INPUTS}


def ranges_table() -> SmallTable:
    """What is varied."""
    rows = [
        (one.words, one.shown(0.0), one.shown(1.0), "logarithm" if one.logarithmic else "value")
        for one in INPUTS
    ]
    return SmallTable(
        "Inputs, drawn evenly in their value or its logarithm", ("input", "from", "to", "even in"), rows
    )


def statements_table(found: Studied) -> SmallTable:
    """How probable each statement is, and what decides it."""
    rows = []
    for statement, row in zip(STATEMENTS, found.held, strict=True):
        of, held = int(np.isfinite(row).sum()), int(np.nansum(row))
        low, high = wilson(held, of)
        named = [each.text for each in deciders(found.shares, row)[:DECIDING] if each.acts]
        share = f"{100 * held / of:.0f} % ({100 * low:.0f} to {100 * high:.0f})" if of else "says nothing"
        rows.append(
            (
                statement.figure,
                statement.words,
                f"{held} of {of}",
                share,
                *named,
                *[""] * (DECIDING - len(named)),
            )
        )
    return SmallTable(
        "Probability that a statement holds, and what changes it by most between the halves of its range, "
        f"with bounds of 90 %, beyond what chance does once in {1 / CHANCE:.0f}",
        ("Fig.", "statement of the paper", "holds", "probability (90 %)", "decided first by", "then by"),
        rows,
    )


def responses_table(found: Studied) -> SmallTable:
    """What moves volume, friction and roughness of each material."""
    rows = []
    limit = ACTS / np.sqrt(len(found.shares) - 1)
    for case, name in itertools.product(found.effort.cases, RESPONSES):
        values, of_inputs = found.response(case, name), found.correlations(case, name)
        order: Sequence[int] = np.argsort(-np.abs(np.nan_to_num(of_inputs)))[:3]
        named = [
            f"{INPUTS[k].words}: {of_inputs[k]:+.2f}"
            for k in order
            if abs(np.nan_to_num(of_inputs[k])) > limit
        ]
        low, middle, high = (
            np.nanquantile(values, (0.05, 0.5, 0.95)) if np.isfinite(values).any() else (np.nan,) * 3
        )
        rows.append(
            (
                NAMES[case],
                _WORDS[name],
                *(f"{_SHOWN[name](v):.3g}" for v in (low, middle, high)),
                *named,
                *[""] * (3 - len(named)),
            )
        )
    return SmallTable(
        f"What moves the last cycle: correlations of ranks above chance ({limit:.2f})",
        ("material", "what", "5 %", "median", "95 %", "first", "second", "third"),
        rows,
    )


_WORDS = {"volume": "worn volume [µm³]", "friction": "coefficient of friction", "roughness": "Sa [nm]"}
_SHOWN = {"volume": lambda v: 10.0**v - 1.0, "friction": lambda v: v, "roughness": lambda v: 1e9 * v}

CASES = (
    RunningInSensitivity(
        "running-in-sensitivity",
        "Running-in over the inputs that the paper leaves open",
        "How probable is each statement of the paper over the inputs that it leaves open, and which "
        "decide it?",
        (
            (
                "Probability",
                "share of the points of a uniform design at which a statement holds; bounds of Wilson (1927)",
                "Newcombe, Stat. Med. 17 (1998) 857 and 873",
            ),
            (
                "Correlation of ranks",
                "Spearman's, of a response and an input",
                "Saltelli et al. (2008), section 1.2",
            ),
        ),
    ),
)
