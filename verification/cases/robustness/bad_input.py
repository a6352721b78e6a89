# SPDX-License-Identifier: MIT
"""Bad input: what the readers and the command make of scenes, tables, archives and folders that are
wrong on purpose.
"""

import csv
import json
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

from sam.scene import Scene, SceneError, parse_scene, read_scene, resolved
from verification.cases.case import FEM, SAM, Context
from verification.compare.own_data import read_data
from verification.cost.plan import plan
from verification.robustness.fuzz import (
    ARCHIVE,
    KINDS,
    MAPPINGS,
    MESHES,
    RUN,
    SCENE,
    STUDIES,
    BadInput,
    bad_input,
    good_scenes,
    lay,
)
from verification.robustness.hostile import SMALL
from verification.robustness.kills import SAMFEM, Findings, finish, rows_of, start
from verification.runs.archive import ArchiveError, read_archive
from verification.runs.files import FolderError, json_text, read_run
from verification.runs.study import read_study

SEED = 20260
READ = {"quick": 150, "full": 500}
RUNS = {"quick": 10, "full": 40}
LIMIT_S = 2.0  # of processor time for a reader; the usual input takes milliseconds
MEMORY = 1 << 30  # bytes that a reader may take beyond what the process has
ADDRESSES = (1 << 30, 2 << 30, 4 << 30, None)  # bytes that a command may take
STREAMS = ("", "", "", ">&-", "2>&-", ">&- 2>&-")  # what is closed when a command begins
COMMAND_LIMIT_S = 120.0  # for a command; it starts in a second, and scenes that are solved take a few
SMALL_S, SMALL_BYTES = 1.0, 400e6  # predicted: scenes that the command solves, larger ones are planned
MOST_SCENES = 3  # of a study that is solved
AT_ONCE = 2
OUT = "cwd/out"
TRACEBACK = re.compile(r"Traceback \(most recent|internal error")
GATES = ("tracebacks", "hangs", "writes-outside", "wrong-errors", "exit-codes")


class Hang(BaseException):
    """Raised in a reader that takes too long; no Exception, so that none of its handlers takes it."""


@dataclass
class Tally:
    """counts: (kind, how it ended) -> number; slowest: seconds, input."""

    counts: Counter = field(default_factory=Counter)
    findings: Findings = field(default_factory=list)
    slowest: tuple[float, str] = (0.0, "")


def read_all(path: Path, bad: BadInput) -> str:
    """Read an input as samfem does: "valid" or "refused". Any other error than those of the readers
    comes out.
    """
    try:
        if bad.kind in (MESHES, MAPPINGS):
            read_data(path, read_scene(path.parent / SCENE)[0])
        elif bad.kind == STUDIES:
            read_study(path)
        elif bad.kind == ARCHIVE:
            read_archive(path)
        elif bad.kind == RUN:
            read_run(path)
        else:
            scene, _ = read_scene(path)
            found = plan(scene)
            lines = found.lines(verbose=True)
            json_text(found.content)
            if not all(character.isprintable() for line in lines for character in line):
                raise ValueError("the plan holds control characters")
            if Scene(**resolved(scene)) != scene:
                raise ValueError("the resolved scene is another one")
    except (SceneError, ArchiveError, FolderError):
        return "refused"
    return "valid"


def judge_readers(
    numbers: Sequence[int], base: Path, reader: Callable[[Path, BadInput], str] = read_all
) -> Tally:
    """Lay out inputs of SEED, one after the other, and read each within LIMIT_S and MEMORY."""
    tally, before = Tally(), set(os.listdir())
    plan(parse_scene(good_scenes()[0].encode(), SCENE))  # what readers load, on a busy machine for seconds
    for number in numbers:
        bad = bad_input(SEED, number)
        what = f"input {number}, {bad.kind}"
        with tempfile.TemporaryDirectory(dir=base) as folder:
            path, began = lay(bad, Path(folder)), time.process_time()
            try:
                with guarded(LIMIT_S, MEMORY):
                    end = reader(path, bad)
            except Hang:
                end = "hang"
                tally.findings.append(("hangs", what))
            except Exception as error:
                end = "wrong error"
                tally.findings.append(("wrong-errors", f"{what}: {type(error).__name__}: {error}"[:200]))
            taken = time.process_time() - began
        tally.counts[bad.kind, end] += 1
        tally.slowest = max(tally.slowest, (taken, what))
    for made in sorted(set(os.listdir()) - before):
        tally.findings.append(("writes-outside", f"{made} appeared in the current folder"))
    return tally


@contextmanager
def guarded(seconds: float, memory: int) -> Iterator[None]:
    """Raise Hang in the block after so many seconds of processor time, MemoryError beyond so many
    further bytes. Main thread only.
    """

    def stop(*_):
        raise Hang

    limits, handler = resource.getrlimit(resource.RLIMIT_AS), signal.signal(signal.SIGPROF, stop)
    resource.setrlimit(resource.RLIMIT_AS, (_address_space() + memory, limits[1]))
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, handler)
        resource.setrlimit(resource.RLIMIT_AS, limits)


def _address_space() -> int:
    try:
        return int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[0]) * resource.getpagesize()
    except OSError:
        return 4 << 30


def words_for(bad: BadInput, path: Path, number: int) -> list[str]:
    """The command for an input: solve or compare what is wrong or small, plan the rest; read what
    is no scene as --out.
    """
    if bad.kind == RUN:
        return ["solve", "scene.toml", "--out", str(path)]
    if bad.kind == ARCHIVE:
        return ["report", str(path)]
    if bad.kind in (MESHES, MAPPINGS):
        return ["compare", str(path.parent / SCENE), "--with", str(path), "--out", "out/run"]
    if bad.kind == STUDIES and _is_small(path, read_study):
        return ["sweep", str(path), "--workers", "1", "--out", "out/run"]
    path = path.parent / SCENE if bad.kind == STUDIES else path
    commands = [
        ["solve", str(path), "--model", (SAM, FEM)[number % 2], "--out", "out/run"],
        ["compare", str(path), "--out", "out/run"],
        ["plan", str(path)],
        ["plan", str(path), "--json"],
    ]
    if not _is_small(path):
        return commands[2 + number % 2]
    return commands[number // 2 % 4 if number % 3 == 0 else 0]


def _is_small(path: Path, read: Callable[[Path], Any] = read_scene) -> bool:
    """Whether a scene, or those of a study, are solved in no time, as far as can be predicted, or refused."""
    try:
        with guarded(LIMIT_S, MEMORY):
            found = read(path)
            scenes = [found[0]] if read is read_scene else [each.scene for each in found.points]
            if len(scenes) > MOST_SCENES:
                return False
            models = [model["estimate"] for scene in scenes for model in plan(scene)["models"]]
    except (Exception, Hang):
        return True
    small = all(each["time_s"] < SMALL_S and each["memory_bytes"] < SMALL_BYTES for each in models if each)
    few = all(scene.loading.cycles * scene.loading.steps <= 20 for scene in scenes)
    return small and few and all(scene.solver.tolerance > 1e-7 for scene in scenes)


def run_command(
    words: Sequence[str], base: Path, command: Sequence[str] = (), how: random.Random | None = None
) -> tuple[int | None, str, set[str]]:
    """Run a command in base/cwd with homes of its own: its exit code, None where it was stopped
    after COMMAND_LIMIT_S, what it printed, and the paths below `base` that changed.

    how: draws its address space and what is closed; without it neither is limited.
    """
    homes = {"HOME": "home", "TMPDIR": "tmp", "XDG_CACHE_HOME": "home/cache"}
    homes["MPLCONFIGDIR"] = "cwd/out/matplotlib"  # it keeps a list of fonts
    for name in ("home", "tmp", "cwd"):
        (base / name).mkdir(exist_ok=True)
    own = {key: str(base / name) for key, name in homes.items()}
    words = [word.partition("\0")[0] for word in words]  # a system passes no more of it to a program
    if how is not None:
        most, closed = how.choice(ADDRESSES), how.choice(STREAMS)
        limit = f"ulimit -v {most >> 10}; " if most else ""
        command = ["sh", "-c", f'{limit}exec "$@" {closed}', "sh", *SAMFEM]
    before = snapshot(base)
    process = start(words, base / OUT / "store", command, base / "cwd", **own)
    code, text = finish(process, COMMAND_LIMIT_S)
    after = snapshot(base)
    return code, text, {path for path in before.keys() | after if before.get(path) != after.get(path)}


def snapshot(base: Path) -> dict[str, tuple]:
    """Everything below a folder: relative path -> (kind and rights, size, time of change of a
    file's content).
    """
    found = {}
    for above, folders, files in os.walk(base):
        for name in folders + files:
            status = os.lstat(path := os.path.join(above, name))
            changing = () if name in folders else (status.st_size, status.st_mtime_ns)
            found[os.path.relpath(path, base)] = (status.st_mode, *changing)
    return found


def judge_commands(
    numbers: Sequence[int], base: Path, command: Sequence[str] = (), progress=lambda *_: None
) -> Tally:
    """Run the command on inputs of SEED, AT_ONCE at a time, each in a folder of its own, of which
    it may change cwd/out, unless it ends in 2.
    """
    tally, prepared = Tally(), []
    for number in numbers:
        folder, bad = base / str(number), bad_input(SEED, number)
        (folder / "cwd").mkdir(parents=True)
        path = lay(bad, folder / "cwd" / "out" if bad.kind == RUN else folder / "in")
        if bad.kind == RUN:
            (folder / "cwd" / SCENE).write_text(SMALL)
        prepared.append((number, bad.kind, folder, words_for(bad, path, number)))

    def ended(each: tuple) -> tuple:
        number, _, folder, words = each
        how, began = None if command else random.Random(f"{SEED}/{number}/how"), time.perf_counter()
        return *run_command(words, folder, command, how), time.perf_counter() - began

    with ThreadPoolExecutor(AT_ONCE) as pool:
        for done, (each, found) in enumerate(zip(prepared, pool.map(ended, prepared), strict=True), start=1):
            (number, kind, _, words), (code, text, changed, seconds) = each, found
            what = f"input {number}: samfem {' '.join(words)}"[:160]
            tally.counts[kind, "hang" if code is None else f"exit {code}"] += 1
            if code is None:
                tally.findings.append(("hangs", what))
            elif code not in (0, 1, 2):
                tally.findings.append(("exit-codes", f"{what}: {code}"))
            if TRACEBACK.search(text):
                tally.findings.append(("tracebacks", f"{what}: {text.strip().splitlines()[-1]}"[:300]))
            if code != 2:
                changed = {path for path in changed if path != OUT and not path.startswith(f"{OUT}/")}
            if changed:
                tally.findings.append(("writes-outside", f"{what}: {min(changed)}"))
            tally.slowest = max(tally.slowest, (seconds, what))
            progress(done, len(prepared))
    return tally


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """How inputs ended that were read in this process, and others through the command."""
    reads, runs = READ[context.level], RUNS[context.level]
    with tempfile.TemporaryDirectory(prefix="samfem-bad-input-") as base:
        read = judge_readers(range(reads), Path(base))
        stride = range(reads, reads + 5 * runs, 5)  # 5 and the number of turns have no common factor
        progress = partial(context.progress, f"{context.case}: commands")
        yield from judged(read, judge_commands(stride, Path(base), progress=progress))


def judged(read: Tally, ran: Tally) -> Iterator[dict[str, Any]]:
    """How the inputs of each kind ended, here and in the campaign; how many wrongly, in each way, of how many
    kinds none was read, and the slowest.
    """
    yield from rows_of(read.findings + ran.findings, GATES)
    yield {"sweep": "left out", "kinds-left-out": len(set(KINDS) - {kind for kind, _ in read.counts})}
    kept = resources.files("verification").joinpath("data", "bad-input.csv").read_text(encoding="utf-8")
    counted = {"Read: valid or refused, with every reason": read.counts}
    counted |= {"Through the command, by exit code": ran.counts}
    for how, kind, end, count in list(csv.reader(kept.splitlines()))[1:]:
        counted.setdefault(f"Campaign: {how}", Counter())[kind, end] = int(count)
    for words, counts in counted.items():
        for (_, end), count in list(counts.items()):
            counts["all", end] += count
        ends = sorted({end for _, end in counts})
        for kind in dict.fromkeys((*KINDS, *sorted(kind for kind, _ in counts if kind != "all"), "all")):
            yield {"sweep": words, "kind of input": kind} | {end: counts[kind, end] for end in ends}
    for tally in (read, ran):
        yield {"sweep": "Slowest", "time [s]": tally.slowest[0], "input": tally.slowest[1].partition(":")[0]}


def main(what: str, first: str, last: str) -> None:
    """Part of a campaign, larger than the case: `read` or `run` the inputs from the first to before
    the last, and print kinds, ends and findings as a line of JSON.
    """
    with tempfile.TemporaryDirectory(prefix="samfem-bad-input-") as base:
        judge = {"read": judge_readers, "run": judge_commands}[what]
        tally = judge(range(int(first), int(last)), Path(base))
    found = {what: [first, last], "counts": [[*key, count] for key, count in sorted(tally.counts.items())]}
    print(json.dumps(found | {"findings": tally.findings, "slowest": tally.slowest}))


if __name__ == "__main__":
    main(*sys.argv[1:])
