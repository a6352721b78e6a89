# SPDX-License-Identifier: MIT
"""Mutation check: ``python -m verification.robustness.mutants [--module NAME]``.

After a change of module X or of its tests, run ``--module X``: each mutant that survives and did not when
`frozen.csv` was written is named, and the exit code is 1. A function that moved to another module is found by
its name: run that module too. Where a survivor is understood, ``--freeze`` writes the lines of X anew.

Exit code 0: nothing is lost, and at least 95 % of the changed numbers of the core are killed. --json: the
judgement of each as a file.
"""

import argparse
import json
import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from verification.runs.threads import EVERY_LIBRARY


def check(modules: Sequence[str], files: Sequence[str], progress: Callable[[str, int, int], None]) -> dict:
    """{"judged": judgements, "shown": equivalent mutants, "control": tests that fail with numbers as they are
    and files that cannot be collected, "lost", "gone": see `frozen.compare`, "tests", "seconds"}. modules,
    files: only these, if any are named.
    """
    from verification.robustness.mutants import frozen, judge, scope
    from verification.robustness.mutants.equivalent import show

    chosen = list(modules or scope.modules())
    every = [mutant for module in chosen for mutant in scope.mutants_of(module)]
    equivalent = [mutant for mutant in every if mutant.key in scope.constants("equivalent")]
    mutants = [mutant for mutant in every if mutant not in equivalent and scope.drawn(mutant)]
    rows, names, known = frozen.read(), {mutant.function for mutant in every}, set(scope.modules())
    moved = [row for row in rows if row["module"] not in known and row["function"] in names]
    killers = {test for row in rows if row["module"] in chosen for test in row["tests"]}
    killers |= {test for row in moved for test in row["tests"]}
    answer: dict = {}

    def work(items) -> None:
        start = time.monotonic()
        if not files:
            wanted = {name for name, item in items.items() if judge.uses(item.module, chosen)}
            wanted |= {name for name in items if frozen.short(name) in killers}
            items = {name: item for name, item in items.items() if name in wanted}
        seen, loaded, control = judge.observe(chosen, items, partial(progress, "tests observed"))
        judged = judge.judge(mutants, items, (seen, loaded), partial(progress, "mutants"))
        answer.update(judged=judged, control=control, tests=len(seen), seconds=time.monotonic() - start)

    uncollected = judge.with_tests(files or ("test_*.py",), work)
    answer["control"] += uncollected
    there = {(m.module, m.function) for name in known.union(chosen) for m in scope.mutants_of(name)}
    lost, gone = frozen.compare(answer["judged"], there)
    return answer | {"shown": show(equivalent), "lost": lost, "gone": gone}


def main() -> int:
    """Change what is asked for, and return the exit code."""
    what = "Change numbers, comparisons and conditions, each by itself, and ask the fast tests"
    parser, several = argparse.ArgumentParser(description=what), {"action": "append", "default": []}
    parser.add_argument("--module", help="only this one, sam.contact.normal, say; may be repeated", **several)
    parser.add_argument("--tests", help="only this file of tests; may be repeated", **several)
    parser.add_argument("--json", type=Path, help="file for the judgement of each mutant")
    parser.add_argument("--freeze", action="store_true", help="write what is found into frozen.csv")
    parser.add_argument("--processes", type=int, default=2)
    words = parser.parse_args()
    from verification.robustness.mutants import frozen, judge, scope

    judge.WORKERS, terminal = words.processes, os.dup(2)

    def progress(what: str, done: int, of: int) -> None:
        if done == of or done % 100 == 0:
            os.write(terminal, f"{what}: {done}/{of}\n".encode())

    answer = check(words.module, words.tests, progress)
    if words.json:
        words.json.write_text(json.dumps(answer, indent=1, default=_plain))
    if words.freeze:
        frozen.write(answer["judged"], words.module or scope.modules())
    return told(answer)


def told(answer: dict) -> int:
    """Print what survives and is lost, and return the exit code."""
    from verification.robustness.mutants import scope

    for one in sorted(answer["judged"], key=lambda one: one.mutant.name):
        if one.outcome == "survived":
            print(f"survived {one.mutant.name} {one.mutant.text}   | {one.mutant.line}   ({one.asked} tests)")
    for one in answer["shown"]:
        if not one.equivalent:
            print(f"not equivalent {one.mutant.name}: changes {one.change:.3g} tol. in {one.probes} probes")
    for what in answer["gone"]:
        print(f"no longer there: {what}")
    for name, what in answer["lost"].items():
        print(f"lost: {name} {what}")
    outcomes = Counter((one.outcome, scope.whole(one.mutant)) for one in answer["judged"])
    for title, core in (("numbers of the core", True), ("the others, drawn", False)):
        killed, survived = outcomes["killed", core], outcomes["survived", core]
        print(f"{title}: {killed} killed, {survived} survived, {outcomes['structure', core]} structure")
    print(f"{len(answer['shown'])} equivalent, {answer['tests']} fast tests, {answer['seconds']:.0f} s")
    print("without a change fail:", answer["control"] or "nothing")
    few = outcomes["survived", True] > 0.05 * (outcomes["survived", True] + outcomes["killed", True])
    return int(few or bool(answer["control"]) or bool(answer["lost"]))


def _plain(one):
    """Of a judgement or a constant that was shown, with what it says of itself."""
    return asdict(one) | ({"equivalent": one.equivalent} if hasattr(one, "equivalent") else {})


if __name__ == "__main__":
    for name in EVERY_LIBRARY:
        os.environ.setdefault(name, "1")
    sys.exit(main())
