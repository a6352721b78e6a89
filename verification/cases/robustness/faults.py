# SPDX-License-Identifier: MIT
"""Solves and sweeps that are killed at random moments, and what else can go wrong in a run's folder."""

import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from subprocess import Popen
from typing import Any

from verification.cases.case import Context
from verification.robustness.kills import (
    Ended,
    Findings,
    Trial,
    finish,
    inspect,
    killed_solve,
    killed_sweep,
    rows_of,
    start,
    tables,
)
from verification.runs.files import SUMMARY

SEED = 417
KILLS = {"quick": (6, 4), "full": (10, 6)}  # of a solve, of a sweep, which takes three times as long
AT_ONCE = 2
KINDS = ("after a checkpoint", "a worker", "with points finished")
"""Kills that must have occurred, or the others prove little."""
GATES = ("broken-files", "early-summaries", "changed-tables", "lost-points", "wrong-endings")
SCENE = """title = "To be killed"
[body]
young = "210 GPa"
poisson = 0.3
[body.plasticity]
law = "swift"
B = "945 MPa"
C = 20
n = 0.121
[counterbody]
shape = "sphere"
radius = "105 um"
[loading]
force = "0.17 N"
steps = 15
unload = true
[grid]
cells = [49, 49]
[solver]
tolerance = 1e-5
"""
STUDY = """scene = "sphere.toml"
[vary]
"loading.force" = { range = ["0.1 N", "0.8 N"], count = 24 }
"""
SWEPT = SCENE[: SCENE.index("[body.plasticity]")] + SCENE[SCENE.index("[counterbody]") :].replace(
    "[49, 49]", "[257, 257]"
)


def solve_in(base: Path, out: Path, *more: str, **how) -> Ended:
    """Run `samfem solve` on the scene of a folder."""
    return finish(start(["solve", str(base / "scene.toml"), "--out", str(out), *more], base / "store", **how))


def begun(base: Path) -> Popen:
    """A solve into base/run that has written a checkpoint."""
    process = start(["solve", str(base / "scene.toml"), "--out", str(base / "run")], base / "store")
    checkpoint, until = base / "run" / "checkpoint.npz", time.monotonic() + 60.0
    while not checkpoint.exists() and process.poll() is None and time.monotonic() < until:
        time.sleep(0.02)
    return process


def interrupted(base: Path) -> Ended:
    """SIGINT, as from Ctrl-C, once there is a checkpoint."""
    process = begun(base)
    process.send_signal(signal.SIGINT)
    return finish(process)


def full_disk(base: Path) -> Ended:
    """No file may grow beyond 4 KiB: as on a full disk, writing fails in the middle of a file."""
    code = "import resource, sys; from samfem.cli import main; "
    code += "resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)); sys.exit(main())"
    return solve_in(base, base / "run", command=(sys.executable, "-c", code))


def read_only(base: Path) -> Ended:
    """A folder that cannot be written to; /proc for root, whom rights do not stop."""
    (folder := base / "locked").mkdir(mode=0o500)
    place = Path("/proc/samfem") if os.access(folder, os.W_OK) else folder / "run"
    return solve_in(base, place)


def two_runs(base: Path) -> Ended:
    """A second solve into the folder of one that runs, and ends well."""
    first = begun(base)
    second, (code, text) = solve_in(base, base / "run"), finish(first)
    if code != 0:
        return code, f"the first run: {text}"
    (base / "run" / SUMMARY).unlink()
    return second


def other_version(base: Path) -> Ended:
    """A folder that another version wrote."""
    (base / "run").mkdir()
    older = '{"format": "samfem run 0"}'
    (summary := base / "run" / SUMMARY).write_text(older)
    ended = solve_in(base, base / "run")
    if summary.read_text(encoding="utf-8") != older:
        return None, "the summary of the other version was overwritten"
    summary.unlink()
    return ended


def other_scene(base: Path) -> Ended:
    """--resume in the folder of another scene's interrupted run."""
    interrupted(base)
    (base / "scene.toml").write_text(SCENE.replace("0.17 N", "0.16 N"))
    return solve_in(base, base / "run", "--resume")


Fault = tuple[Callable[[Path], Ended], tuple[int, ...], str]
"""What makes it in a folder, with base/run for the run; the right exit codes; what the message says."""
FAULTS: dict[str, Fault] = {
    "interrupt (SIGINT)": (interrupted, (130,), "--resume"),
    "full disk: files end at 4 KiB": (full_disk, (1,), "free"),
    "folder that cannot be written to": (read_only, (1, 2), "cannot"),
    "two runs into one folder": (two_runs, (2,), "is being written by"),
    "folder of another version": (other_version, (2,), "another"),
    "--resume with another scene's checkpoint": (other_scene, (2,), "another scene"),
}


def judge_fault(name: str, base: Path) -> tuple[dict[str, str], Findings]:
    """The row of a fault, and what was wrong with its end."""
    base.mkdir()
    (base / "scene.toml").write_text(SCENE)
    make, codes, says = FAULTS[name]
    code, text = make(base)
    lines, found = text.strip().splitlines() or [""], inspect(base / "run")
    message = next((line for line in reversed(lines) if line.startswith("samfem: error")), lines[-1])
    if code not in codes or "Traceback" in text:
        found.append(("wrong-endings", f"{name}: exit code {code}: {message}"))
    elif says not in message:
        found.append(("wrong-endings", f"{name}: the message does not say {says}: {message}"))
    if (base / "run" / SUMMARY).exists():
        found.append(("early-summaries", f"{name}: there is a {SUMMARY}"))
    row = {"sweep": "Other faults", "fault": name, "exit code": str(code)}
    return row | {"message": message.replace(str(base), "…")}, found


def undisturbed(words: Sequence[str], out: Path, store: Path) -> float:
    """Seconds that a command takes which is not killed. RuntimeError where it does not end well."""
    began = time.monotonic()
    code, text = finish(start([*words, "--out", str(out)], store))
    if code != 0:
        raise RuntimeError(f"the undisturbed {words[0]} ended in {code}: {text[-300:]}")
    return time.monotonic() - began


def kill_solves(count: int, base: Path, progress) -> tuple[list[Trial], float]:
    """Trials of solves killed at moments uniform over the time of an undisturbed one, also returned."""
    words = ["solve", str(base / "scene.toml")]
    seconds = undisturbed(words, base / "undisturbed", base / "store")
    expected = tables(base / "undisturbed")
    moments, trials = delays(count, seconds, random.Random(SEED)), []

    def trial(k: int) -> Trial:
        folder = base / f"solve-{k}"
        try:
            return killed_solve(words, folder, expected, moments[k], store=base / "store")
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    with ThreadPoolExecutor(AT_ONCE) as pool:
        for done, found in enumerate(pool.map(trial, range(count)), start=1):
            trials.append(found)
            progress("kills of a solve", done, count)
    return trials, seconds


def kill_sweeps(count: int, base: Path, progress) -> list[Trial]:
    """Trials of sweeps killed likewise, the parent and a worker in turns."""
    words = ["sweep", str(base / "study.toml"), "--workers", "2"]
    seconds = undisturbed(words, base / "sweep", base / "sweep-store")
    table, rng, trials = (base / "sweep" / "sweep.csv").read_bytes(), random.Random(SEED + 1), []
    for k, delay in enumerate(delays(count, seconds, rng)):
        whom, folder = ("worker", "parent")[k % 2], base / f"sweep-{k}"
        trials.append(killed_sweep(words, folder, table, delay, whom=whom, rng=rng))
        for left in (folder, base / f"{folder.name}-store"):  # a gigabyte
            shutil.rmtree(left, ignore_errors=True)
        progress("kills of a sweep", k + 1, count)
    return trials


def delays(count: int, seconds: float, rng: random.Random) -> list[float]:
    """Random moments, one in each of `count` equal parts of a run that takes `seconds`."""
    return [seconds * (k + rng.random()) / count for k in range(count)]


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """How solves and sweeps ended that were killed, and the other faults."""
    solves, sweeps = KILLS[context.level]

    def progress(stage: str, done: int, total: int) -> None:
        context.progress(f"{context.case}: {stage}", done, total)

    with tempfile.TemporaryDirectory(prefix="samfem-faults-") as name:
        base = Path(name)
        for file, text in (("scene.toml", SCENE), ("sphere.toml", SWEPT), ("study.toml", STUDY)):
            (base / file).write_text(text)
        solved, seconds = kill_solves(solves, base, progress)
        trials = {f"Kills of a solve of {seconds:.1f} s": solved}
        trials["Kills of a sweep of 24 scenes"] = kill_sweeps(sweeps, base, progress)
        others = [judge_fault(name, base / f"fault-{k}") for k, name in enumerate(FAULTS)]
    yield from (row for row, _ in others)
    yield from judged(trials, [each for _, found in others for each in found])


def judged(trials: Mapping[str, Sequence[Trial]], others: Findings) -> Iterator[dict[str, Any]]:
    """How often what was killed, and how often nothing was wrong afterwards; what was found wrong, and kinds
    of kills that did not occur. others: findings of other faults.
    """
    for words, each in trials.items():
        hows = Counter(how for how, _ in each)
        good = Counter(how for how, findings in each if not findings)
        for how in sorted(hows):
            row = {"sweep": words, "killed": how, "times": hows[how]}
            yield row | {"ended with equal tables, nothing lost": good[how]}
    every = [trial for each in trials.values() for trial in each]
    yield from rows_of([each for _, findings in every for each in findings] + others, GATES)
    missing = sum(not any(kind in how for how, _ in every) for kind in KINDS)
    yield {"sweep": "missing", "missing-kinds": missing}
