# SPDX-License-Identifier: MIT
"""The commands verify, report, pages and publish: the cases of the suite, what they must reach, their pages.

publish runs every case at a level and makes the pages from what it keeps: what a case found is kept in a
store of its own, times included, so that a run that was stopped or killed goes on with the cases that are
missing. Cases that the report holds already, of this code, stay as they are. The longest begin; cases that
measure times run last and alone.
"""

from __future__ import annotations

import math
import shutil
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from sam.scene import Scene
from samfem.executors import Failure, Processes, run
from samfem.sweeping import KeepsAll
from verification.cases import Case, all_cases
from verification.cases.case import Context, Outcome
from verification.figures import solve_figures
from verification.runs.code_version import version_of_cases
from verification.runs.files import SUMMARY
from verification.runs.lock import locked
from verification.runs.models import SAM
from verification.runs.store import Lookup, Reuse, Store, default_store, solve_or_reuse
from verification.suite import outcomes, verify as suite
from verification.suite.changes import show_changes
from verification.suite.freshness import earlier, older, stale
from verification.suite.verify import RanCase
from verification.text.console import Progress

SCRATCH = "scratch"
"""Folder in the store where the cases that run have their files."""
REPORTS = Path("reports")
"""Its report says how long cases took, where that of the folder to write does not."""
UNKNOWN = math.inf  # s: what may be the longest begins
CHANGED = "files of the code changed while it ran: publish again"


def verify(
    case: Sequence[str], *, level: str, out: Path, use_store: bool = True, show: str | None = None
) -> int:
    """Run the named cases (none: all of the level) and write the report, or list them.

    show: "cases" or "gates", to list them and run none.
    """
    if show:
        return suite.show(show, case)
    return suite.main(list(case), level, out, store=default_store() if use_store else None)


def report(
    folder: Path,
    against: Path | None = None,
    *,
    table: Path | None = None,
    single_file: bool = False,
    pdf: bool = False,
) -> int:
    """Write the pages of a finished report again, or list what changed since an older one, or draw the
    figures of a report or a run as PDF. table: of the gates that the older one had and what they are now.
    """
    if against is not None:
        return show_changes(folder, against, table)
    if pdf and (folder / SUMMARY).is_file():
        print(*solve_figures(folder, pdf=True), sep="\n")
        return 0
    if pdf:
        with Progress() as progress:
            written = suite.draw_pdf(folder, progress, default_store())
        print(*written, sep="\n")
        return 0
    return suite.rebuild(folder, single_file=single_file)


def pages(folder: Path, *, list_stale: bool = False, single_file: bool = False) -> int:
    """Write the pages of a published report again, or list the cases that are older than the code; 1 if any
    is.
    """
    if not list_stale:
        return suite.rebuild(folder, single_file=single_file)
    results = suite.finished(folder)
    found = stale(results)
    print("".join(f"{name}: {why}\n" for name, why in found.items()), end="")
    count = sum(case["status"] != "not run" for case in results["cases"]) - len(older(results))
    print(f"{len(found)} stale, {count} as the code in front of you")
    return 1 if found else 0


def publish(case: Sequence[str], *, level: str, out: Path, store: Path, workers: int) -> int:
    """Run the cases (none: all that are published at the level) that neither the folder `store` nor a report
    in `out` holds of this code, and write the report of all of them into `out`, with the other cases that it
    holds.

    Returns 0 when every gate of every case held, 1 when not, 2 for an unknown case or a folder that holds
    something else, or a report of another level.
    """
    known = all_cases()
    wanted = [each for each in known.values() if (each.name in case if case else each.published_at(level))]
    before = suite.before(out)
    problem = suite.problem_of(case, known, out)
    if not problem and before.get("level", level) != level:
        problem = f"{out} holds a report of level {before['level']}: choose another folder with --out"
    if problem:
        print(f"samfem: error: {problem}", file=sys.stderr)
        return 2
    chosen, unmet = suite.runnable(wanted)
    if not chosen:
        return 0
    with locked(store), locked(out):
        folder, before, kept = suite.begin(out), suite.before(out), KeepsAll(store)
        took = _seconds(REPORTS) | _seconds(out)
        of_level = [each.name for each in known.values() if case or each.published_at(level)]
        stays = earlier(before, of_level, [each.name for each in chosen]) if before else suite.NOTHING
        missing = [each for each in chosen if each.name not in stays.cases]
        longest = sorted(missing, key=lambda each: -took.get(each.name, UNKNOWN))
        failures = _fill(kept, longest, level=level, workers=workers)
        for name in stays.files:
            if (out / name).is_file():
                (folder / name).parent.mkdir(exist_ok=True)
                shutil.copy(out / name, folder / name)
        ran = {
            each.name: _ran(each, kept, failures.get(each.name, ""), level=level, out=folder)
            for each in missing
        }
        words = " ".join(["samfem publish", *case, "--level", level])
        return suite.finish(ran, known, level=level, out=out, command=words, unmet=unmet, stays=stays)


def _seconds(folder: Path) -> dict[str, float]:
    """How long each case of a report took, by its name; none where there is no report."""
    cases = suite.before(folder).get("cases", ())
    return {case["name"]: case["seconds"] for case in cases if case["seconds"] is not None}


def _fill(store: Store, chosen: Iterable[Case], *, level: str, workers: int) -> dict[str, str]:
    """Run what the store does not hold; why a case broke off, by its name."""
    missing = [
        case for case in chosen if outcomes.find(store, case, _context(case, store, level)).result is None
    ]
    by_name = {case.name for case in missing}
    beside, alone = ([case for case in missing if case.alone is kind] for kind in (False, True))
    failures: dict[str, str] = {}
    done = 0
    for cases, processes in ((beside, workers), (alone, 1)):
        with Processes(processes, fresh=True) as pool:
            for name, answer, _ in run(pool, make, _tasks(store, cases, level)):
                done += name in by_name
                failure, seconds = (answer.reason, 0.0) if isinstance(answer, Failure) else answer
                failures |= {name: failure} if failure else {}
                print(f"{done} of {len(missing)}: {name}: {failure or f'{seconds:.0f} s'}", flush=True)
    shutil.rmtree(store.folder / SCRATCH, ignore_errors=True)
    return failures


def _tasks(store: Store, cases: Iterable[Case], level: str) -> dict[str, tuple[Any, ...]]:
    """Name -> arguments of `make`: the cases, the scenes that are solved ahead, then the cases with such
    scenes.
    """
    whole = {case.name: (case.name, level, store.folder) for case in cases}
    scenes = {case.name: list(case.ahead(_context(case, store, level))) for case in cases}
    ahead = {
        f"{name}, scene {k} of {len(own)}": (*whole[name], scene)
        for name, own in scenes.items()
        for k, scene in enumerate(own, start=1)
        if store.lookup(scene, SAM).result is None
    }
    return {name: task for name, task in whole.items() if not scenes[name]} | ahead | whole


def make(name: str, level: str, folder: Path, scene: Scene | None = None) -> tuple[str, float]:
    """Run a case in this process and keep what it found in the store in `folder`, or only solve one of its
    scenes; why it broke off, and seconds.
    """
    case, store = all_cases()[name], KeepsAll(folder)
    if scene is not None:
        began = time.perf_counter()
        solve_or_reuse(store, scene, SAM)
        return "", time.perf_counter() - began
    context = _context(case, store, level)
    shutil.rmtree(context.out, ignore_errors=True)
    version_of_cases()  # of the files as they are before anything is computed
    began = time.perf_counter()
    outcome, failure = suite.attempt(case, context)
    seconds = time.perf_counter() - began + context.taken_s
    if failure:
        return failure, seconds
    outcomes.keep(store, case, context, outcome, seconds=seconds)
    kept = outcomes.find(store, case, context).result is not None
    shutil.rmtree(context.out, ignore_errors=True)
    return "" if kept else CHANGED, seconds


def _context(case: Case, store: Store, level: str) -> Context:
    return Context(case.name, store.folder / SCRATCH / case.name, level, _silent, store=store)


def _silent(stage: str, done: int, total: int) -> None:
    """No progress: two cases at once would write over each other's."""


def _ran(case: Case, store: Store, failure: str, *, level: str, out: Path) -> RanCase:
    """The case as it is kept, its figures put into `out`, not its runs, of gigabytes; or how it broke off."""
    context = Context(case.name, out, level, _silent, store=store)
    found = outcomes.find(store, case, context) if not failure else Lookup()
    if found.result is None:
        return RanCase(context, Outcome(), failure or CHANGED, 0.0, Reuse(False))
    outcome = outcomes.put_back(found.result, context, with_runs=False)
    outcome = replace(outcome, figures=[outcomes.packed(each, out) for each in outcome.figures])
    return RanCase(context, outcome, "", found.result.seconds, Reuse(True, found.created, found.commit))
