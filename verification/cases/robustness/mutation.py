# SPDX-License-Identifier: MIT
"""Mutation check: the numbers of the numerical core perturbed one at a time, and whether fast tests
notice.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from importlib import util
from pathlib import Path

from verification.cases.case import Case, Context, Measured, SmallTable
from verification.runs.threads import EVERY_LIBRARY

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
    """What `python -m verification.robustness.mutants` finds, in a process of its own: it forks, and replaces
    code.
    """
    with tempfile.TemporaryDirectory(prefix="samfem-mutation-") as base:
        found = Path(base, "judged.json")
        words = [sys.executable, "-m", TOOL, "--json", str(found), *["--quick"] * quick]
        environment = os.environ | dict.fromkeys(EVERY_LIBRARY, "1") | {"SAMFEM_STORE": ""}
        ended = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True)
        if not found.is_file():
            raise RuntimeError(f"the mutation check broke off: {ended.stderr[-400:]}")
        return json.loads(found.read_text(encoding="utf-8"))


def key_of(judged: Mapping) -> tuple[str, str, str]:
    """What names a mutant: module, function and text."""
    mutant = judged["mutant"]
    return mutant["module"], mutant["function"], mutant["text"]


def values_of(found: Mapping) -> dict[str, Measured]:
    """The gates, from the judgements as read back."""
    from verification.robustness.mutants import scope  # noqa: PLC0415 - of the source only

    outcomes = Counter(one["outcome"] for one in found["judged"])
    killed = [one for one in found["judged"] if one["outcome"] == "killed"]
    unexplained = [
        one for one in found["judged"] if one["outcome"] == "survived" and key_of(one) not in scope.EXPLAINED
    ]
    moving = [one for one in found["shown"] if not one["equivalent"]]
    share = len(killed) / max(len(killed) + outcomes["survived"], 1)
    slowest = max((one["seconds"] for one in killed), default=float("nan"))
    return {
        "killed": Measured(share),
        "unexplained": Measured(len(unexplained), 0),
        "not-inert": Measured(len(moving)),
        "rewriting": Measured(len(found["control"])),
        "slowest-kill": Measured(slowest, unit="s"),
    }


def counts_table(found: Mapping) -> SmallTable:
    """By module: mutants that count, killed, survived; equivalent mutants; integers that are structure."""
    from verification.robustness.mutants import scope  # noqa: PLC0415 - of the source only

    counts: Counter = Counter()
    for one in found["judged"]:
        counts[one["mutant"]["module"], one["outcome"]] += 1
        counts[one["mutant"]["module"], one["mutant"]["kind"]] += one["outcome"] != "structure"
    for one in found["shown"]:
        counts[one["mutant"]["module"], "equivalent"] += one["equivalent"]
    there = {where for where, _ in counts}
    names = [name for names in scope.GROUPS.values() for name in names if name in there]

    def row(title: str, modules: Sequence[str]) -> tuple[str, ...]:
        kinds = ("row", "killed", "survived", "equivalent", "structure")
        rows, killed, survived, *rest = (sum(counts[name, kind] for name in modules) for kind in kinds)
        return (title, *map(str, (killed + survived, rows, killed, survived, *rest)))

    columns = "module|mutants|of them table rows|killed|survived|equivalent|structure, left out"
    rows = [*[row(name, [name]) for name in names], row("all", names)]
    return SmallTable("Mutants by module", columns.split("|"), rows)


def _place(one: Mapping) -> str:
    return f"{one['mutant']['module']} {one['mutant']['function']}"


def survivors_table(found: Mapping) -> SmallTable:
    """Every mutant that no test noticed, and why."""
    from verification.robustness.mutants import scope  # noqa: PLC0415 - of the source only

    rows = []
    for one in (one for one in found["judged"] if one["outcome"] == "survived"):
        number = f"{one['mutant']['text']} in {one['mutant']['line'] or one['mutant']['place']}"
        why = scope.EXPLAINED.get(key_of(one), "not explained")
        rows.append((_place(one), number, str(one["asked"]), why))
    return SmallTable("Survivors", ("where", "number", "tests asked", "why"), rows)


def equivalent_table(found: Mapping) -> SmallTable:
    """The equivalent mutants: constants that must not matter, and how much they do."""
    rows = [
        (_place(one), one["mutant"]["text"], one["reason"], f"{one['change']:.2g}", str(one["probes"]))
        for one in found["shown"]
    ]
    columns = "where|constant|why it must not matter|largest change, in tolerances|solves that run the module"
    return SmallTable("Constants that must not change the answer", columns.split("|"), rows)


def killers_table(found: Mapping) -> SmallTable:
    """The tests that kill most."""
    counts = Counter(one["by"] for one in found["judged"] if one["outcome"] == "killed")
    rows = [(name, str(count)) for name, count in counts.most_common(NAMED)]
    return SmallTable("Tests that kill most", ("test", "mutants"), rows)


class Mutation(Case):
    """What `checked` finds, at the level quick of a few mutants."""

    def solve(self, context: Context) -> dict:
        return checked(context.level == "quick") | {"quick": context.level == "quick"}

    def measure(self, found: Mapping) -> dict[str, Measured]:
        return values_of(found)

    def setup(self, found: Mapping) -> Iterator[tuple[str, str]]:
        from verification.robustness.mutants import scope  # noqa: PLC0415 - of the source only
        from verification.robustness.mutants.numbers import FACTOR, MORE  # noqa: PLC0415 - of the source only

        errors = Counter(one["error"] for one in found["judged"] if one["outcome"] == "killed")
        failed = sum(count for error, count in errors.items() if error in ("AssertionError", "Failed"))
        others = sum(errors.values()) - failed
        fast = f"{found['tests']} that take less than a second each"
        yield "Perturbed by", f"a factor {FACTOR}; named counts grow by {MORE}; one at a time"
        yield "Left out as structure", "0, indices, powers, keys, integers that never meet a float"
        yield "Tests asked", f"{fast}; those that run the function, the fastest first"
        yield "Killed by", f"{failed} by an assertion, {others} by an error or by the time that they take"
        yield "Time", f"{found['seconds']:.0f} s"
        if found["quick"]:
            yield (
                "Sample",
                f"{scope.QUICK_COUNT} mutants of the film's law, seed {scope.SEED}; all of them at level "
                "full",
            )

    def tables(self, found: Mapping) -> Iterator[SmallTable]:
        for table in (counts_table, survivors_table, equivalent_table, killers_table):
            if (made := table(found)).rows:
                yield made


CASES = (Mutation("mutation", needs=needs, alone=True),)
