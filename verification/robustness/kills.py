# SPDX-License-Identifier: MIT
"""Runs that are killed on purpose, and what they leave: whole files, early summaries, tables, processes."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from verification.runs.archive import ArchiveError, read_archive
from verification.runs.files import SUMMARY
from verification.runs.meshes import FIELDS, STEPS, SURFACE

SAMFEM = (sys.executable, "-m", "samfem.cli")
LIMIT_S = 300.0
ORPHANS_S = 10.0  # processes that a killed one leaves must end by then
OF_EVERY_RUN = (SUMMARY, FIELDS, SURFACE, STEPS, "history.csv", "axis.csv", "line.csv", "plane.csv")


@dataclass(frozen=True)
class Ended:
    """A command that ended: exit code (negative: by a signal, None: stopped after LIMIT_S) and what
    it printed.
    """

    code: int | None
    text: str


@dataclass
class KillTrial:
    """What a killed run left. how: when it was killed, in words; findings: gate -> what was wrong."""

    how: str = ""
    findings: dict[str, list[str]] = field(default_factory=dict)

    def found(self, gate: str, text: str) -> None:
        self.findings.setdefault(gate, []).append(text)


def start(words: Sequence[str], store: Path, command: Sequence[str] | None = None) -> subprocess.Popen:
    """A command in a session of its own, with a checkpoint at each step. It hears SIGINT, as
    started from a terminal: a job in the background of a script inherits that it does not.
    """
    own = {"SAMFEM_STORE": str(store), "SAMFEM_CHECKPOINT_S": "0", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [*(SAMFEM if command is None else command), *words],
        env=os.environ | own,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def finish(process: subprocess.Popen) -> Ended:
    """Wait for a command; one that does not end is killed, with its children."""
    try:
        text = process.communicate(timeout=LIMIT_S)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # the session that `start` made
        process.communicate()
        return Ended(None, "")
    return Ended(process.returncode, text.decode(errors="replace"))


def parent_of(pid: int | str) -> int | None:
    """The parent of a process that runs, from /proc; None where it ended, or there is no /proc."""
    try:
        state, parent = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[:2]
    except (OSError, ValueError):
        return None
    return None if state in "ZX" else int(parent)


def children(pid: int) -> list[int]:
    """The living descendants of a process; none where there is no /proc."""
    parents = {int(entry.name): parent_of(entry.name) for entry in Path("/proc").glob("[0-9]*")}
    found, new = [], [pid]
    while new:
        new = [child for child, parent in parents.items() if parent in new]
        found += new
    return found


def workers(pid: int) -> list[int]:
    """The descendants that solve: processes spawned for a pool."""
    found = []
    for child in children(pid):
        with contextlib.suppress(OSError):
            if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes():
                found.append(child)
    return found


def kill(pids: Sequence[int]) -> None:
    """Kill these processes; one that has ended is no fault."""
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def left_behind(pids: Sequence[int]) -> list[int]:
    """Those of the processes that still run after ORPHANS_S; they are killed."""
    until = time.monotonic() + ORPHANS_S
    while (alive := [pid for pid in pids if parent_of(pid) is not None]) and time.monotonic() < until:
        time.sleep(0.1)
    kill(alive)
    return alive


def inspect(folder: Path, trial: KillTrial, unfinished: bool = True) -> None:
    """Enter every file of a folder that is not whole, and summaries that came too early.

    unfinished: temporary files may be there.
    """
    for path in sorted(folder.rglob("*")):
        if path.name.endswith(".part"):
            if not unfinished:
                trial.found("broken-files", f"{path.name} is left over")
        elif path.is_file() and (fault := fault_of(path)):
            trial.found("broken-files", f"{path.relative_to(folder)}: {fault}")
    for summary in folder.rglob(SUMMARY):
        missing = [name for name in OF_EVERY_RUN if not (summary.parent / name).is_file()]
        if missing:
            trial.found("early-summaries", f"{summary.relative_to(folder)} without {', '.join(missing)}")


def fault_of(path: Path) -> str:
    """Why a file is not whole; empty if it is."""
    try:
        if path.suffix == ".csv":
            text = path.read_text(encoding="utf-8")
            lengths = {len(row) for row in csv.reader(io.StringIO(text, newline=""))}
            return "" if len(lengths) == 1 and text.endswith("\n") else "a line is cut"
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif path.suffix == ".npz":
            read_archive(path)
        elif path.suffix in (".vtu", ".vtr", ".pvd"):
            ElementTree.parse(path)
    except (OSError, ValueError, ArchiveError, ElementTree.ParseError) as error:
        return str(error)
    return ""


def tables(folder: Path) -> Mapping[str, bytes]:
    """The CSV files of a folder: relative path -> content."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*.csv"))}


def compare(folder: Path, undisturbed: Mapping[str, bytes], trial: KillTrial) -> None:
    """Enter the tables that differ from those of the undisturbed run."""
    found = tables(folder)
    for name in sorted(found.keys() | undisturbed.keys()):
        if found.get(name) != undisturbed.get(name):
            trial.found("changed-tables", f"{name}: {trial.how}")


def killed_solve(
    words: Sequence[str], folder: Path, undisturbed: Mapping[str, bytes], delay: float, *, base: Path
) -> KillTrial:
    """Kill `samfem solve` after `delay` seconds, look at its folder, continue it, and compare the tables."""
    trial, store = KillTrial(), base / "store"
    process = start([*words, "--out", str(folder)], store)
    time.sleep(delay)
    kill([process.pid])
    process.communicate()
    inspect(folder, trial)
    done, kept = (folder / SUMMARY).exists(), (folder / "checkpoint.npz").exists()
    trial.how = ("before the first checkpoint", "after a checkpoint")[kept]
    trial.how = "finished before the kill" if done else trial.how
    again = finish(start([*words, "--out", str(folder), "--resume"], store))
    if again.code != 0:
        trial.found("wrong-endings", f"--resume {trial.how}: exit code {again.code}: {again.text[-200:]}")
    if kept and not done and "continued" not in again.text:
        trial.found("wrong-endings", f"--resume did not continue from its checkpoint: {again.text[-200:]}")
    inspect(folder, trial, unfinished=False)
    compare(folder, undisturbed, trial)
    return trial


def killed_sweep(
    words: Sequence[str],
    folder: Path,
    table: bytes,
    delay: float,
    *,
    whom: str,
    rng: random.Random,
    base: Path,
) -> KillTrial:
    """Kill a sweep ("parent") or one of its workers ("worker") after `delay`, start it again if
    need be, and compare.
    """
    trial, store = KillTrial(), base / f"{folder.name}-store"
    process = start([*words, "--out", str(folder)], store)
    time.sleep(delay)
    below, at_work = children(process.pid), workers(process.pid)
    victim = rng.choice(at_work) if whom == "worker" and at_work else process.pid
    kill([victim])
    if victim == process.pid:
        process.wait()
        alive, ended = left_behind(below), finish(process)
    else:
        ended, alive = finish(process), left_behind(below)
    if alive:
        trial.found("wrong-endings", f"{len(alive)} processes are left behind")
    inspect(folder, trial)
    finished = finished_points(folder)
    trial.how = "a worker" if victim != process.pid else "the sweep"
    if (folder / "sweep.json").exists():
        trial.how += ", and it finished"
    if ended.code != 0:
        ended, reused = finish(start([*words, "--out", str(folder)], store)), 0
        if ended.code == 0:
            reused = json.loads((folder / "sweep.json").read_text(encoding="utf-8"))["counts"]["reused"]
        for _ in range(finished - reused):
            trial.found("lost-points", f"{finished} finished, {reused} taken from the store")
        trial.how += ", started again" + (" with points finished" if finished else "")
    if ended.code != 0:
        trial.found("wrong-endings", f"the sweep ended in {ended.code}: {ended.text[-200:]}")
    inspect(folder, trial, unfinished=False)
    if not (folder / "sweep.csv").exists() or (folder / "sweep.csv").read_bytes() != table:
        trial.found("changed-tables", f"sweep.csv: {trial.how}")
    return trial


def finished_points(folder: Path) -> int:
    """Rows of sweep.csv with a converged result."""
    try:
        text = (folder / "sweep.csv").read_text(encoding="utf-8")
    except FileNotFoundError:
        return 0
    return sum(row["status"] == "converged" for row in csv.DictReader(io.StringIO(text, newline="")))
