# SPDX-License-Identifier: MIT
"""Elastic Hertz and the rough patch: what is run, and the errors."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sam.scene import Progress
from verification.peers import problems, running
from verification.peers.running import ASPHER, CONTACT_MECHANICS, SAM, TAMAAS, Job, Measurement

SIZES = (64, 96, 128, 192, 256, 512)  # the error that is asked for lies between 192 and 256
ROUGH_SIZES = (256, 512, 1024)
COMPARED = (128, 256, 512)  # ratios on the same grid
HERTZ_SETTINGS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    SAM: {"": {"tolerance": 1e-5}, "grid of 4a": {"tolerance": 1e-5, "side": 4.0}},
    TAMAAS: {"1e-6": {"tolerance": 1e-6}, "1e-7": {"tolerance": 1e-7}},
    CONTACT_MECHANICS: {"1e-7": {"tolerance": 1e-7}, "1e-8": {"tolerance": 1e-8}},
    ASPHER: {
        "1e-6": {"tolerance": 1e-6, "backend": "fft"},
        "single precision": {"tolerance": 1e-5, "backend": "fft", "single_precision": True},
    },
}
"""Program -> label -> settings: the loosest tolerance of each with which the error is still that of the grid,
and beside it a tighter one or another option; looser ones end above the error of the grid."""
ROUGH_LADDERS: Mapping[str, Sequence[Mapping[str, Any]]] = {
    SAM: [{"tolerance": tolerance} for tolerance in (3e-3, 1e-3, 3e-4, 1e-4)],
    TAMAAS: [{"tolerance": tolerance} for tolerance in (3e-4, 1e-4, 3e-5, 1e-5)],
    CONTACT_MECHANICS: [{"tolerance": tolerance} for tolerance in (1e-2, 1e-4, 1e-5)],
    ASPHER: [{"tolerance": each, "backend": "fft", "single_precision": True} for each in (1e-3, 1e-4, 1e-5)],
}
"""Program -> settings, loose to tight: on each grid the first that reaches ROUGH_ERROR is compared."""
MISSED = dict.fromkeys([(CONTACT_MECHANICS, 1024), (TAMAAS, 512), (ASPHER, 512), (ASPHER, 1024)], 2)
MISSED[TAMAAS, 1024] = 4
"""Program and grid -> how many of these are left out: they end above the error, by commit a82b4b2, with which
Tamaas took 111 s on the finest grid, 34 times SAM's time.
"""
TIGHT: Mapping[str, Mapping[str, Any]] = {
    SAM: {"tolerance": 1e-11},
    TAMAAS: {"tolerance": 1e-9},
    CONTACT_MECHANICS: {"tolerance": 1e-8},
    ASPHER: {"tolerance": 1e-9, "backend": "fft"},
}
ROUGH_ERROR = 1e-4
HERTZ_ERROR = 5e-6


def solution(problem: str, n: int, python: Path, program: str = SAM, **settings: Any) -> np.ndarray:
    """The pressure on these cells with a tight tolerance. RuntimeError when there is none."""
    measurement = Measurement(Job(problem, n, {**TIGHT[program], **settings}))
    running.run(program, measurement, python)
    if measurement.failure or "pressure" not in measurement.fields:
        why = measurement.failure or "no pressure"
        raise RuntimeError(f"{program} on {n} x {n} cells of {problem}: {why}")
    return measurement.fields["pressure"]


def distance(p: np.ndarray, reference: np.ndarray) -> float:
    """Relative L2 distance of two fields."""
    return float(np.linalg.norm(p - reference) / np.linalg.norm(reference))


def disagreements(problem: str, n: int, pythons: Mapping[str, Path]) -> dict[str, float]:
    """Program -> relative L2 distance of its tight solution from SAM's: what is compared is one discrete
    problem.
    """
    own = solution(problem, n, pythons[SAM])
    others = [program for program in pythons if program != SAM]
    return {program: distance(solution(problem, n, pythons[program], program), own) for program in others}


def hertz_error(p: np.ndarray, converged_error: float) -> float:
    """Error of the largest pressure. converged_error: of the discrete problem, solved tightly; the larger
    counts, as an iteration that stops where its own error cancels that of the grid has solved the problem no
    better.
    """
    return max(abs(float(p.max()) / problems.P0 - 1), converged_error)


def hertz(
    pythons: Mapping[str, Path], rounds: int, progress: Progress
) -> tuple[list[dict[str, Any]], list[float]]:
    """Rows of every program with every setting on every grid, and the seconds of the calibration kernel in
    between.
    """
    jobs = {
        program: [
            Job(problems.HERTZ, n, settings, label)
            for label, settings in HERTZ_SETTINGS[program].items()
            for n in SIZES
        ]
        for program in pythons
    }
    found, kernel = running.measure(jobs, pythons, rounds, progress)
    least: dict[tuple[int, float], float] = {}

    def error(each: Measurement) -> float:
        n, side = each.job.cells, each.job.settings.get("side", problems.SIDE)
        if (n, side) not in least:
            tight = Measurement(Job(problems.HERTZ, n, {**TIGHT[SAM], "side": side}))
            running.run(SAM, tight, pythons[SAM])
            least[n, side] = hertz_error(tight.fields["pressure"], 0.0)
        return hertz_error(each.fields["pressure"], least[n, side])

    return running.rows_of(problems.HERTZ, found, error), kernel


def rough(
    pythons: Mapping[str, Path], rounds: int, progress: Progress
) -> tuple[list[dict[str, Any]], list[float]]:
    """Rows of every program at the loosest tolerance that reaches ROUGH_ERROR on each grid; those that miss
    it too.
    """
    tight = {n: solution(problems.ROUGH, n, pythons[SAM]) for n in ROUGH_SIZES}
    rows, kernel = [], []
    places = {(program, n): MISSED.get((program, n), 0) for program in pythons for n in ROUGH_SIZES}
    open_ = {each: place for each, place in places.items() if place < len(ROUGH_LADDERS[each[0]])}

    def error(each: Measurement) -> float:
        return distance(each.fields["pressure"], tight[each.job.cells])

    def reaches(each: Measurement) -> bool:
        return error(each) <= ROUGH_ERROR

    while open_:
        jobs: dict[str, list[Job]] = {}
        for (program, n), place in open_.items():
            settings = ROUGH_LADDERS[program][place]
            job = Job(problems.ROUGH, n, settings, f"{settings['tolerance']:g}")
            jobs.setdefault(program, []).append(job)
        found, seconds = running.measure(jobs, pythons, rounds, progress, reaches=reaches)
        kernel += seconds
        fresh = running.rows_of(problems.ROUGH, found, error)
        rows += fresh
        missed = {(row["model"], row["cells"]) for row in fresh if not row["error"] <= ROUGH_ERROR}
        open_ = {
            (program, n): place + 1
            for (program, n), place in open_.items()
            if (program, running.cells_in_words(n)) in missed and place + 1 < len(ROUGH_LADDERS[program])
        }
    return rows, kernel
