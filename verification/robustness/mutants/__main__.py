# SPDX-License-Identifier: MIT
"""Mutation check of the numerical core: ``python -m verification.robustness.mutants [--quick] [--module
NAME]``.

Each number of the core is perturbed by itself, and the fast tests that run it are asked. Exit code 0: at
least 95 % of the mutants are killed. --json: the judgement of each as a file.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from verification.runs.threads import EVERY_LIBRARY


def check(
    quick: bool, modules: Sequence[str], files: Sequence[str], progress: Callable[[str, int, int], None]
) -> dict:
    """{"judged": judgements, "shown": equivalent mutants, "control": names of tests, "tests", "seconds"}; see
    `scope` for the rest.

    modules, files: only these, if any are named.
    """
    from verification.robustness.mutants import scope
    from verification.robustness.mutants.equivalent import reason_of, show
    from verification.robustness.mutants.fasttests import with_tests
    from verification.robustness.mutants.judge import control, judge, mutants_of, observe

    chosen = list(
        modules
        or (scope.QUICK_MODULES if quick else [name for names in scope.GROUPS.values() for name in names])
    )
    mutants = [mutant for module in chosen for mutant in mutants_of(module)]
    equivalent = [mutant for mutant in mutants if reason_of(mutant)]
    mutants = [mutant for mutant in mutants if not reason_of(mutant)]
    if quick:
        mutants, equivalent = random.Random(scope.SEED).sample(mutants, scope.QUICK_COUNT), []
    answer: dict = {}

    def work(items) -> None:
        start = time.monotonic()
        seen = observe(items, lambda done, of: progress("tests observed", done, of))
        judged = judge(mutants, items, seen, lambda done, of: progress("mutants", done, of))
        answer.update(
            judged=judged,
            control=control(chosen, items, seen),
            tests=len(seen),
            seconds=time.monotonic() - start,
        )

    with_tests(files or (scope.QUICK_FILES if quick else scope.FILES), work)
    return answer | {"shown": show(equivalent)}


def main() -> int:
    """Perturb the numbers that are asked for, print what survives, and return the exit code."""
    parser = argparse.ArgumentParser(
        description="Perturb each number of the numerical core and ask the fast tests"
    )
    parser.add_argument("--quick", action="store_true", help="a sample of a few modules")
    parser.add_argument(
        "--module",
        action="append",
        default=[],
        help="only this one, sam.contact.normal, say; may be repeated",
    )
    parser.add_argument(
        "--tests", action="append", default=[], help="only this file of tests; may be repeated"
    )
    parser.add_argument("--json", type=Path, help="file for the judgement of each mutant")
    words = parser.parse_args()

    def progress(what: str, done: int, of: int) -> None:
        if sys.stderr.isatty() or done == of or done % 100 == 0:
            print(f"\r{what}: {done}/{of}", end="\n" if done == of else "", file=sys.stderr, flush=True)

    answer = check(words.quick, words.module, words.tests, progress)
    if words.json:
        plain = {
            key: [_plain(one) for one in value] if isinstance(value, list) else value
            for key, value in answer.items()
        }
        words.json.write_text(json.dumps(plain, indent=1))
    for one in sorted(answer["judged"], key=lambda one: one.mutant.name):
        if one.outcome == "survived":
            print(f"survived {one.mutant.name}   | {one.mutant.line}   ({one.asked} tests)")
    for one in answer["shown"]:
        if not one.equivalent:
            print(f"not equivalent {one.mutant.name}: changes {one.change:.3g} tol. in {one.probes} probes")
    outcomes = Counter(one.outcome for one in answer["judged"])
    print(
        dict(outcomes),
        f"{len(answer['shown'])} equivalent, {answer['tests']} fast tests, {answer['seconds']:.0f} s",
    )
    print("rewriting alone fails:", answer["control"] or "nothing")
    return int(
        outcomes["survived"] > 0.05 * (outcomes["survived"] + outcomes["killed"]) or bool(answer["control"])
    )


def _plain(one):
    """Of a judgement or a constant that was shown, with what it says of itself; names stay as they are."""
    if isinstance(one, str):
        return one
    return asdict(one) | ({"equivalent": one.equivalent} if hasattr(one, "equivalent") else {})


if __name__ == "__main__":
    for name in EVERY_LIBRARY:
        os.environ.setdefault(name, "1")
    sys.exit(main())
