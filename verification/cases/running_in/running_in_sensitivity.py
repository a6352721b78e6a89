# SPDX-License-Identifier: MIT
"""Which of the inputs that the paper leaves open decide its statements on running-in.

Every input is drawn evenly over its range, each point on another surface, and all materials are run at each
point: shares of the points at which a statement holds are probabilities over these ranges.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from sam.scene import Scene
from verification.cases.case import SAM, Context, Measured, Plot, SmallTable
from verification.cases.running_in.running_in import DeeperWhereItYields, solved
from verification.cases.running_in.running_in_deciders import (
    CHANCE,
    PART,
    PREDICTS,
    RESPONSES,
    SEED,
    Studied,
    believed,
    decided_by,
    least_change,
    two_most,
)
from verification.cases.running_in.running_in_fitted import PRINTED, fitted_note, fitted_table
from verification.cases.running_in.running_in_inputs import INPUTS, scene_at, wilson
from verification.cases.running_in.running_in_runs import RunningInRun
from verification.cases.running_in.running_in_scenes import Effort, reduced
from verification.cases.running_in.running_in_statements import BULK, LAST, NAMES, STATEMENTS, A
from verification.cost.estimates import estimate
from verification.figures.running_in_sensitivity import best_pair, probabilities
from verification.sensitivity import UNIFORM, design
from verification.surrogate import Surrogate

SURFACES = 100  # seeds of surfaces count from here, and are no others'
EFFORTS = {
    "quick": (4, Effort((BULK, A), (), cycles=2, steps=2, cells=24)),
    "full": (64, Effort(tuple(NAMES), (), cycles=LAST, steps=3, cells=64)),
}
"""Points, and what is run at each: the whole patch, since on a quarter of it most surfaces do not wear at
all."""
DECIDING, EXPLAINING = 2, 3  # inputs named for each statement, and for its measure
ACTS = 3.3  # standard errors 1/sqrt(n - 1) of a correlation of ranks that chance passes once in a thousand


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
                "Sampling error of a share of points",
                f"±{50 * np.diff(wilson(points // 2, points))[0]:.0f} % at a half (90 %)",
            ),
            (
                "Resolved",
                f"changes of {100 * least_change(points):.0f} % and more between the halves of a range",
            ),
        ]

    def tables(self, found: Studied) -> Iterator[SmallTable]:
        yield ranges_table()
        if found.judged:
            yield statements_table(found)
            yield fits_table(found)
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
    """The scene of each material with the printed inputs, on the grid and with the steps of the level."""
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
    for statement, row, deciding in zip(STATEMENTS, found.held, found.deciders, strict=True):
        of, held = int(np.isfinite(row).sum()), int(np.nansum(row))
        low, high = wilson(held, of)
        named = [each.text for each in deciding[:DECIDING] if each.acts]
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
        f"with bounds of 90 %: beyond what chance does once in {1 / CHANCE:.0f}, or, where the fit below "
        "names the input, beyond those bounds",
        ("Fig.", "statement of the paper", "holds", "share of points (90 %)", "decided first by", "then by"),
        rows,
    )


def fits_table(found: Studied) -> SmallTable:
    """What a fit of the measure of each statement says."""
    rows = []
    for statement, fit, row in zip(STATEMENTS, found.fits, found.measures, strict=True):
        named = ["no fit predicts it"]
        if believed(fit):
            order = np.argsort(-fit.shares, kind="stable")[:EXPLAINING]
            named = [_explained(fit, int(k)) for k in order if fit.shares[k] >= PART]
        of = int((~np.isnan(row)).sum())
        predicted = "–" if fit is None else f"{fit.predicted:.2f}"
        rest = [""] * (EXPLAINING - len(named))
        rows.append((statement.figure, statement.words, statement.measure, f"{of}", predicted, *named, *rest))
    return SmallTable(
        "Shares of the variance of each measure (its ranks) by a sparse polynomial of single inputs, and "
        "whether the measure rises or falls with the input. Q²: of the variance, what the fit predicts at "
        f"points left out; no share where it is below {PREDICTS:g}. The rest is the surface, and what inputs "
        "do together",
        ("Fig.", "statement of the paper", "measure", "points", "Q²", "first", "second", "third"),
        rows,
    )


def _explained(fit: Surrogate, k: int) -> str:
    way = {1: "rises", -1: "falls"}.get(int(fit.slopes[k]), "bends")
    return f"{INPUTS[k].words}: {100 * fit.shares[k]:.0f} %, {way}"


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

CASES = (RunningInSensitivity("running-in-sensitivity"),)
