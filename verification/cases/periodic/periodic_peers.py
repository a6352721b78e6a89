# SPDX-License-Identifier: MIT
"""SAM beside Tamaas on problems that are periodic in both: same heights, same cells, in turns in one run."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from verification.cases.case import Context
from verification.peers import problems
from verification.peers.elastic import ROUGH_ERROR, distance, solution
from verification.peers.plastic import GRIDS, SETTINGS, TOLERANCE, profile_error
from verification.peers.running import (
    SAM,
    TAMAAS,
    Job,
    Measurement,
    interpreter,
    measure,
    missing,
    pythons_of,
    rows_of,
)

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["missing"]  # named by the file of the case
SIZES = (256, 512, 1024)
TOLERANCES = {SAM: (1e-3, 3e-4), TAMAAS: (1e-4, 1e-5)}  # loose to tight: the first within ROUGH_ERROR counts
ROUNDS = {"quick": 1, "full": 3}


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """A row a measurement, and a row a grid for how far both are apart."""
    pythons, rounds = pythons_of(interpreter(), {TAMAAS: ""}), ROUNDS[context.level]
    tight = {
        (program, n): solution(problems.ROUGH, n, python, program, periodic=True)
        for program, python in pythons.items()
        for n in SIZES
    }
    for n in SIZES:
        ours, theirs = tight[SAM, n], tight[TAMAAS, n]
        row = {"sweep": "elastic-apart", "n": n, "h": 1.0 / n, "pressure": distance(ours, theirs)}
        share = np.mean(ours > 0.0) / np.mean(theirs > 0.0)
        yield row | {"p-max": abs(ours.max() / theirs.max() - 1.0), "share": abs(share - 1.0)}
    for number in range(len(TOLERANCES[SAM])):
        jobs = {
            program: [
                Job(problems.ROUGH, n, {"tolerance": own[number], "periodic": True}, f"{own[number]:g}")
                for n in SIZES
            ]
            for program, own in TOLERANCES.items()
        }
        found, _ = measure(jobs, pythons, rounds, context.progress)
        for program, one in ((program, one) for program, each in found.items() for one in each):
            error = partial(_error, tight[program, one.job.cells])
            yield from (row | {"n": one.job.cells} for row in rows_of("elastic", {program: [one]}, error))
    settings = {SAM: {"tolerance": TOLERANCE, "periodic": True}, TAMAAS: SETTINGS[""]}
    jobs = {program: [Job(problems.STEP, cells, how) for cells in GRIDS] for program, how in settings.items()}
    found, _ = measure(jobs, pythons, rounds, context.progress)
    for program, one in ((program, one) for program, each in found.items() for one in each):
        yield from (row | {"n": one.job.cells[0]} for row in rows_of("step", {program: [one]}, lambda _: 0.0))
    for ours, theirs in zip(*(found[program] for program in (SAM, TAMAAS)), strict=True):
        if not (ours.solved and theirs.solved):
            raise RuntimeError(f"step on {ours.job.cells}: {ours.failure or theirs.failure}")
        fields = [each.fields[name] for each in (ours, theirs) for name in ("z", "peeq")]
        largest = fields[1].max() / fields[3].max()
        row = {"sweep": "step-apart", "n": ours.job.cells[0], "h": 1.0 / ours.job.cells[0]}
        yield row | {"profile": profile_error(*fields), "peeq-max": abs(largest - 1.0)}


def _error(tight: np.ndarray, one: Measurement) -> float:
    return distance(one.fields["pressure"], tight)


def tamaas_over_sam(rows: DataFrame, column: str) -> float:
    """Tamaas' time over SAM's, of each the fastest within the error."""
    good = rows[rows["error"] <= ROUGH_ERROR].groupby("model")[column].min()
    return float(good.get(TAMAAS, np.nan) / good.get(SAM, np.nan))
