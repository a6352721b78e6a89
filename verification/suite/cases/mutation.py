# SPDX-License-Identifier: MIT
"""Mutation check: the numbers of the numerical core perturbed one at a time, and whether fast tests notice."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib import util
from pathlib import Path

from verification.runs.threads import EVERY_LIBRARY
from verification.suite.cases.case import Case, Context, Outcome, SmallTable
from verification.suite.gates import Measured

ROOT = Path(__file__).resolve().parents[3]
TOOL = "verification.robustness.mutants"
"""The program that perturbs the numbers: of the source, and not imported here before it is needed."""
NAMED = 12
"""Tests that kill most, on the page."""


def needs() -> str:
    """The tests, and what perturbs the numbers, are part of the source, not of the installed package."""
    if not (ROOT / "tests").is_dir() or util.find_spec(TOOL) is None:
        return "it asks the tests: run it in a checkout of the source, after `make .venv/.installed`"
    missing = [name for name in ("pytest", "hypothesis") if util.find_spec(name) is None]
    return f'install {" and ".join(missing)}: pip install -e ".[test]"' if missing else ""


def checked(quick: bool) -> dict:
    """What `python -m verification.robustness.mutants` finds, in a process of its own: it forks, and replaces code."""
    with tempfile.TemporaryDirectory(prefix="samfem-mutation-") as base:
        found = Path(base, "judged.json")
        words = [
            sys.executable,
            "-m",
            TOOL,
            "--json",
            str(found),
            *(["--quick"] if quick else []),
        ]
        environment = os.environ | dict.fromkeys(EVERY_LIBRARY, "1") | {"SAMFEM_STORE": ""}
        ended = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True)
        if not found.is_file():
            raise RuntimeError(f"the mutation check broke off: {ended.stderr[-400:]}")
        return json.loads(found.read_text(encoding="utf-8"))


def key_of(judged: Mapping) -> tuple[str, str, str]:
    mutant = judged["mutant"]
    return mutant["module"], mutant["function"], mutant["text"]


def values_of(found: Mapping) -> dict[str, Measured]:
    """The gates, from the judgements as read back."""
    from verification.robustness.mutants import scope

    outcomes = Counter(one["outcome"] for one in found["judged"])
    killed = [one for one in found["judged"] if one["outcome"] == "killed"]
    unexplained = [
        one for one in found["judged"] if one["outcome"] == "survived" and key_of(one) not in scope.EXPLAINED
    ]
    moving = [one for one in found["shown"] if not one["inert"]]
    share = len(killed) / max(len(killed) + outcomes["survived"], 1)
    slowest = max((one["seconds"] for one in killed), default=float("nan"))
    return {
        "mutation.killed": Measured(share),
        "mutation.unexplained": Measured(len(unexplained)),
        "mutation.not-inert": Measured(len(moving)),
        "mutation.rewriting": Measured(len(found["control"])),
        "mutation.slowest-kill": Measured(slowest, unit="s"),
    }


def counts_table(found: Mapping) -> SmallTable:
    """By module: mutants that count, killed, survived; inert constants; integers that are structure."""
    from verification.robustness.mutants import scope

    counts: Counter = Counter()
    for one in found["judged"]:
        counts[one["mutant"]["module"], one["outcome"]] += 1
        counts[one["mutant"]["module"], one["mutant"]["kind"]] += one["outcome"] != "structure"
    for one in found["shown"]:
        counts[one["mutant"]["module"], "inert"] += one["inert"]
    names = [
        name for names in scope.GROUPS.values() for name in names if any(where == name for where, _ in counts)
    ]

    def row(title: str, modules: Sequence[str]) -> tuple[str, ...]:
        total = {what: sum(counts[name, what] for name in modules) for _, what in counts}
        both = total.get("killed", 0) + total.get("survived", 0)
        parts = [
            both,
            total.get("row", 0),
            total.get("killed", 0),
            total.get("survived", 0),
            total.get("inert", 0),
        ]
        return (title, *map(str, parts), str(total.get("structure", 0)))

    columns = (
        "module",
        "mutants",
        "of them table rows",
        "killed",
        "survived",
        "inert",
        "structure, left out",
    )
    rows = [row(name, [name]) for name in names]
    return SmallTable("Mutants by module", columns, [*rows, row("all", names)])


def survivors_table(found: Mapping) -> SmallTable:
    from verification.robustness.mutants import scope

    survived = [one for one in found["judged"] if one["outcome"] == "survived"]
    rows = [
        (
            f"{one['mutant']['module']} {one['mutant']['function']}",
            f"{one['mutant']['text']} in {one['mutant']['line'] or one['mutant']['place']}",
            str(one["asked"]),
            scope.EXPLAINED.get(key_of(one), "not explained"),
        )
        for one in survived
    ]
    return SmallTable("Survivors", ("where", "number", "tests asked", "why"), rows)


def inert_table(found: Mapping) -> SmallTable:
    rows = [
        (
            f"{one['mutant']['module']} {one['mutant']['function']}",
            one["mutant"]["text"],
            one["reason"],
            f"{one['change']:.2g}",
            str(one["probes"]),
        )
        for one in found["shown"]
    ]
    columns = (
        "where",
        "constant",
        "why it must not matter",
        "largest change, in tolerances",
        "solves that run the module",
    )
    return SmallTable("Constants that must not change the answer", columns, rows)


def killers_table(found: Mapping) -> SmallTable:
    counts = Counter(one["by"] for one in found["judged"] if one["outcome"] == "killed")
    return SmallTable(
        "Tests that kill most", ("test", "mutants"), [(n, str(k)) for n, k in counts.most_common(NAMED)]
    )


def run(context: Context) -> Outcome:
    from verification.robustness.mutants import scope
    from verification.robustness.mutants.numbers import FACTOR, MORE

    found = checked(context.level == "quick")
    errors = Counter(one["error"] for one in found["judged"] if one["outcome"] == "killed")
    failed = sum(count for error, count in errors.items() if error in ("AssertionError", "Failed"))
    setup = [
        ("Perturbed by", f"a factor {FACTOR}; named counts grow by {MORE}; one at a time"),
        ("Left out as structure", "0, indices, powers, keys, integers that never meet a float"),
        (
            "Tests asked",
            f"{found['tests']} that take less than a second each; those that run the function, the fastest first",
        ),
        (
            "Killed by",
            f"{failed} by an assertion, {sum(errors.values()) - failed} by an error or by the time that they take",
        ),
        ("Time", f"{found['seconds']:.0f} s"),
    ]
    if context.level == "quick":
        setup.append(
            (
                "Sample",
                f"{scope.QUICK_COUNT} mutants of the film's law, seed {scope.SEED}; all of them at level full",
            )
        )
    tables = [counts_table(found), survivors_table(found), inert_table(found), killers_table(found)]
    return Outcome(values_of(found), setup, tables=[table for table in tables if table.rows])


CASES = (
    Case(
        "mutation",
        "Mutation check of the numerical core",
        "Does a fast test fail when any number of the core is wrong by a thousandth, and do the others really not matter?",
        run,
        levels=("full",),
        needs=needs,
    ),
)
