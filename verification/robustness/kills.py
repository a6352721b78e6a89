# SPDX-License-Identifier: MIT
"""Commands in processes of their own, killed on purpose or not, and what they leave."""

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
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from verification.runs.archive import ArchiveError, read_archive
from verification.runs.files import SUMMARY
from verification.runs.meshes import FIELDS, STEPS, SURFACE

SAMFEM = (sys.executable, "-m", "samfem.cli")
LIMIT_S = 300.0
ORPHANS_S = 10.0  # processes that a killed one leaves must end by then
OF_EVERY_RUN = (SUMMARY, FIELDS, SURFACE, STEPS, "history.csv", "axis.csv", "line.csv", "plane.csv")
Ended = tuple[int | None, str]
"""Exit code (negative: by a signal, None: stopped after its limit) and what a command printed."""
Findings = list[tuple[str, str]]
"""(gate, what was wrong)."""
SAID = 20
"""Findings that a page shows."""


def rows_of(findings: Findings, gates: Sequence[str]) -> Iterator[dict[str, Any]]:
    """A row with the number of findings of each gate, and a row for each of the first of them."""
    counts = Counter(gate for gate, _ in findings)
    yield {"sweep": "What was wrong"} | {gate: counts[gate] for gate in gates}
    yield from ({"sweep": "Findings", "gate": gate, "finding": text} for gate, text in findings[:SAID])


def start(
    words: Sequence[str], store: Path, command: Sequence[str] = (), cwd: Path | None = None, **variables: str
) -> subprocess.Popen:
    """A command in a session of its own, with a checkpoint at each step, that hears SIGINT."""
    own = {"SAMFEM_STORE": str(store), "SAMFEM_CHECKPOINT_S": "0", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [*(command or SAMFEM), *words],
        cwd=cwd,
        env=os.environ | own | variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def finish(process: subprocess.Popen, limit_s: float = 0.0) -> Ended:
    """Wait for a command; one that does not end within the limit, or LIMIT_S, is killed with its children."""
    try:
        text = process.communicate(timeout=limit_s or LIMIT_S)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)  # the session that `start` made
        process.communicate()
        return None, ""
    return process.returncode, text.decode(errors="replace")


def living() -> dict[int, tuple[int, bytes]]:
    """Process -> its parent and command line, of all that run; none where there is no /proc."""
    found = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, ValueError):  # it has ended
            state, parent = (entry / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()[:2]
            if state not in "ZX":
                found[int(entry.name)] = int(parent), (entry / "cmdline").read_bytes()
    return found


def children(pid: int, words: bytes = b"") -> list[int]:
    """The living descendants of a process whose command line has these words."""
    processes, found, new = living(), [], [pid]
    while new:
        new = [child for child, (parent, _) in processes.items() if parent in new]
        found += [child for child in new if words in processes[child][1]]
    return found


def kill(pids: Sequence[int]) -> None:
    """Kill these processes; one that has ended is no fault."""
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def left_behind(pids: Sequence[int]) -> list[int]:
    """Those of the processes that still run after ORPHANS_S; they are killed."""
    until = time.monotonic() + ORPHANS_S
    while (alive := sorted(living().keys() & set(pids))) and time.monotonic() < until:
        time.sleep(0.1)
    kill(alive)
    return alive


def inspect(folder: Path, unfinished: bool = True) -> Findings:
    """Files of a folder that are not whole, and early summaries. unfinished: temporary files may be there."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.name.endswith(".part"):
            if not unfinished:
                found.append(("broken-files", f"{path.name} is left over"))
        elif path.is_file() and (fault := fault_of(path)):
            found.append(("broken-files", f"{path.relative_to(folder)}: {fault}"))
    for summary in folder.rglob(SUMMARY):
        missing = [name for name in OF_EVERY_RUN if not (summary.parent / name).is_file()]
        if missing:
            found.append(("early-summaries", f"{summary.relative_to(folder)} without {', '.join(missing)}"))
    return found


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


def differences(folder: Path, undisturbed: Mapping[str, bytes], how: str) -> Findings:
    """The tables of a folder that differ from those of the undisturbed run."""
    found = tables(folder)
    names = sorted(found.keys() | undisturbed.keys())
    other = [name for name in names if found.get(name) != undisturbed.get(name)]
    return [("changed-tables", f"{name}: {how}") for name in other]


Trial = tuple[str, Findings]
"""When or what was killed, in words, and what it left wrong."""


def killed_solve(
    words: Sequence[str], folder: Path, undisturbed: Mapping[str, bytes], delay: float, *, store: Path
) -> Trial:
    """Kill `samfem solve` after `delay` seconds, look at its folder, continue it, and compare the tables."""
    process = start([*words, "--out", str(folder)], store)
    time.sleep(delay)
    kill([process.pid])
    process.communicate()
    found = inspect(folder)
    done, kept = (folder / SUMMARY).exists(), (folder / "checkpoint.npz").exists()
    how = "after a checkpoint" if kept else "before the first checkpoint"
    how = "finished before the kill" if done else how
    code, text = finish(start([*words, "--out", str(folder), "--resume"], store))
    if code != 0:
        found.append(("wrong-endings", f"--resume {how}: exit code {code}: {text[-200:]}"))
    if kept and not done and "continued" not in text:
        found.append(("wrong-endings", f"--resume did not continue from its checkpoint: {text[-200:]}"))
    found += inspect(folder, unfinished=False)
    return how, found + differences(folder, undisturbed, how)


def killed_sweep(
    words: Sequence[str], folder: Path, table: bytes, delay: float, *, whom: str, rng: random.Random
) -> Trial:
    """Kill a sweep ("parent") or a worker ("worker") after `delay`, start it again if need be, compare."""
    store, file = folder.with_name(f"{folder.name}-store"), folder / "sweep.csv"
    process = start([*words, "--out", str(folder)], store)
    time.sleep(delay)
    below, at_work = children(process.pid), children(process.pid, b"spawn_main")
    victim = rng.choice(at_work) if whom == "worker" and at_work else process.pid
    kill([victim])
    if victim == process.pid:
        process.wait()
        alive, (code, text) = left_behind(below), finish(process)
    else:
        (code, text), alive = finish(process), left_behind(below)
    found = inspect(folder)
    if alive:
        found.append(("wrong-endings", f"{len(alive)} processes are left behind"))
    rows = csv.DictReader(file.read_text(encoding="utf-8").splitlines() if file.exists() else ())
    finished = sum(row["status"] == "converged" for row in rows)
    how = "the sweep" if victim == process.pid else "a worker"
    if (folder / "sweep.json").exists():
        how += ", and it finished"
    if code != 0:
        (code, text), reused = finish(start([*words, "--out", str(folder)], store)), 0
        if code == 0:
            reused = json.loads((folder / "sweep.json").read_text(encoding="utf-8"))["counts"]["reused"]
        lost = ("lost-points", f"{finished} finished, {reused} taken from the store")
        found += [lost] * (finished - reused)
        how += ", started again" + (" with points finished" if finished else "")
    if code != 0:
        found.append(("wrong-endings", f"the sweep ended in {code}: {text[-200:]}"))
    found += inspect(folder, unfinished=False)
    if not file.exists() or file.read_bytes() != table:
        found.append(("changed-tables", f"sweep.csv: {how}"))
    return how, found
