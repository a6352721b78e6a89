# SPDX-License-Identifier: MIT
"""The programs as child processes, in turn and for several rounds, with the calibration kernel in between."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from sam.scene import Progress
from verification.cost.measured import calibration_s
from verification.runs.threads import THREADS

VARIABLE = "SAMFEM_PEERS"
SAM, TAMAAS, CONTACT_MECHANICS, ASPHER = "sam", "tamaas", "contact_mechanics", "aspher"
NAMES = {SAM: "SAM", TAMAAS: "Tamaas", CONTACT_MECHANICS: "ContactMechanics", ASPHER: "aspher"}
PACKAGES = {TAMAAS: "tamaas", CONTACT_MECHANICS: "ContactMechanics", ASPHER: "aspher"}
ROOT = Path(__file__).resolve().parents[2]
ALLOWANCE_S = 900  # of one job; one that takes longer is ended and told
LONG_S, LONGER_S = 2.0, 20.0  # jobs that take so long are measured in two rounds, or in one


class PeersError(ValueError):
    """There is no usable environment of the peers; the message says what to do."""


@dataclass(frozen=True)
class Job:
    """problem, cells: see `problems`; settings: of the program; label: names its curve, the same at all
    sizes.
    """

    problem: str
    cells: Any
    settings: Mapping[str, Any]
    label: str = ""


@dataclass
class Measurement:
    """A job as measured.

    setup_s, solve_s: one a round; record: counts of the last round; failure: why there is no answer.
    """

    job: Job
    setup_s: list[float] = field(default_factory=list)
    solve_s: list[float] = field(default_factory=list)
    record: dict = field(default_factory=dict)
    fields: dict[str, np.ndarray] = field(default_factory=dict)
    failure: str = ""

    @property
    def cpu_s(self) -> list[float]:
        return [setup + solve for setup, solve in zip(self.setup_s, self.solve_s, strict=True)]

    @property
    def seconds(self) -> float:
        """Median over the rounds; nan without an answer."""
        return float(np.median(self.cpu_s)) if self.solved else float("nan")

    @property
    def solved(self) -> bool:
        """Whether there is an answer that the program itself calls converged."""
        return not self.failure and bool(self.solve_s) and bool(self.record.get("converged"))

    def wanted(self, number: int) -> bool:
        """Whether it is measured in round `number` (from 0)."""
        if self.failure:
            return False
        slowest = max(self.cpu_s, default=0.0)
        return number < (1 if slowest > LONGER_S else 2 if slowest > LONG_S else number + 1)


def interpreter() -> Path:
    """The Python of the peers, from SAMFEM_PEERS. PeersError when it is not set or cannot be run."""
    place = os.environ.get(VARIABLE, "")
    if not place:
        words = "it names the Python of an environment with the peers; `make peers` makes one and sets it"
        raise PeersError(f"{VARIABLE} is not set: {words}")
    path = Path(place).absolute()
    if not path.is_file() or not os.access(path, os.X_OK):
        words = "no such program; `make peers` makes the environment and sets it"
        raise PeersError(f"{VARIABLE} = {place!r}: {words}")
    return path


def missing() -> str:
    """Why the peers cannot be run here, or an empty text."""
    try:
        interpreter()
    except PeersError as reason:
        return str(reason)
    return ""


def installed(python: Path) -> dict[str, str]:
    """Version of each peer that its environment has. PeersError when the interpreter does not answer."""
    ask = (
        "import json\nfrom importlib import metadata\nfound = {}\n"
        f"for name, package in {PACKAGES!r}.items():\n"
        "    try:\n        found[name] = metadata.version(package)\n"
        "    except metadata.PackageNotFoundError:\n        pass\n"
        "print(json.dumps(found))"
    )
    try:
        answer = subprocess.run([python, "-c", ask], capture_output=True, text=True, timeout=60, check=True)
        return json.loads(answer.stdout)
    except (OSError, subprocess.SubprocessError, ValueError) as problem:
        words = f"it is no Python that answers ({type(problem).__name__})"
        raise PeersError(f"{VARIABLE} = {python}: {words}") from None


def measure(
    jobs: Mapping[str, Sequence[Job]],
    pythons: Mapping[str, Path],
    rounds: int,
    progress: Progress = lambda *_: None,
    *,
    reaches: Callable[[Measurement], bool] = lambda _: True,
) -> tuple[dict[str, list[Measurement]], list[float]]:
    """The programs in turn, a job each, over several rounds, each in a process of its own: (program ->
    measurements, seconds of the kernel). Jobs that take long are measured in fewer rounds
    (`Measurement.wanted`), and those whose first answer `reaches` nothing in one. pythons: program ->
    interpreter.
    """
    found = {program: [Measurement(job) for job in own] for program, own in jobs.items()}
    kernel = [calibration_s()]
    turns = list(zip_longest(*found.values()))
    for number in range(rounds):
        for k, turn in enumerate(turns):
            progress(f"round {number + 1} of {rounds}", k + 1, len(turns))
            due = [
                (program, each)
                for program, each in zip(found, turn, strict=True)
                if each is not None and each.wanted(number) and (not each.solved or reaches(each))
            ]
            for program, each in due:
                run(program, each, pythons[program])
            if due:
                kernel.append(calibration_s())
    return found, kernel


def run(program: str, measurement: Measurement, python: Path, allowance: float = ALLOWANCE_S) -> None:
    """One process of a program for a job; adds its times, or says why there is no answer."""
    environment = {**os.environ, **dict.fromkeys(THREADS, "1"), "PYTHONPATH": str(ROOT)}
    environment |= {"PYTHONDONTWRITEBYTECODE": "1", "SAMFEM_STORE": ""}  # nothing of an earlier solve
    task = json.dumps({"program": program, "job": asdict(measurement.job)})
    with tempfile.TemporaryDirectory(prefix="samfem-peers-") as folder:
        target = Path(folder, "answer")
        words = [python, "-m", "verification.peers.worker", task, target]
        quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
        quiet |= {"text": True, "errors": "replace"}
        try:
            done = subprocess.run(words, cwd=folder, env=environment, timeout=allowance, check=False, **quiet)
        except subprocess.TimeoutExpired:
            measurement.failure = f"no answer within {allowance:g} s"
            return
        if done.returncode:
            last = done.stderr.strip().splitlines()[-1:] or [""]
            measurement.failure = f"ended with code {done.returncode}: {last[0][:200]}"
            return
        record = measurement.record = json.loads(target.with_suffix(".json").read_text(encoding="utf-8"))
        measurement.failure = record.pop("failure", "")
        if not measurement.failure:
            measurement.setup_s.append(record.pop("setup_s"))
            measurement.solve_s.append(record.pop("solve_s"))
            with np.load(target.with_suffix(".npz")) as fields:
                measurement.fields = dict(fields)


def pythons_of(python: Path, peers: Mapping[str, str]) -> dict[str, Path]:
    """Program -> interpreter: the peers' for what it has, this one for SAM."""
    return {SAM: Path(sys.executable)} | dict.fromkeys(peers, python)


def rows_of(
    problem: str, found: Mapping[str, Sequence[Measurement]], error: Callable[[Measurement], float]
) -> list[dict[str, Any]]:
    """A row for every measurement. error: that times are compared at, nan without an answer."""
    rows = []
    for program, own in found.items():
        for each in own:
            label = ", ".join(filter(None, (NAMES[program], each.job.label)))
            row: dict[str, Any] = {"sweep": problem, "model": program, "curve": label}
            row |= {"cells": cells_in_words(each.job.cells), "seconds": each.seconds}
            row["first"] = each.record.get("first_s", float("nan"))
            row["error"] = error(each) if each.solved else float("nan")
            if each.solved:
                row |= {"rounds": len(each.cpu_s), "iterations": each.record.get("iterations")}
                row |= {"least": min(each.cpu_s), "most": max(each.cpu_s), "set-up": np.median(each.setup_s)}
                row["memory"] = each.record["peak_memory_bytes"]
            rows.append(row | {"status": "" if each.solved else each.failure or "not converged"})
    return rows


def cells_in_words(cells: Any) -> str:
    """Cells a side, or these and layers."""
    return f"{cells}²" if isinstance(cells, int) else f"{cells[1]} × {cells[0]} × {cells[0]}"
