# SPDX-License-Identifier: MIT
"""Mutation check: numbers, comparisons and conditions changed one at a time, and what fast tests notice."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib import util
from pathlib import Path

from verification.cases.case import Case, Context, Measured, SmallTable
from verification.runs.threads import EVERY_LIBRARY

ROOT = Path(__file__).resolve().parents[3]
TOOL = "verification.robustness.mutants"
"""The program that perturbs the numbers: of the source, and not imported here before it is needed."""
MODULES = {
    "quick": ("sam.tribofilm.law",),
    "full": (
        *("sam.kernels.primitives", "sam.plasticity.flow", "sam.tribofilm.law"),
        *("fem_reference.common.back_stress", "fem_reference.common.elasticity"),
    ),
}
"""Those that are asked about; frozen.csv has what was found of all, in 25 minutes of processor time."""


def needs() -> str:
    """The tests, and what perturbs the numbers, are part of the source, not of the installed package."""
    if not (ROOT / "tests").is_dir() or util.find_spec(TOOL) is None:
        return "it asks the tests: run it in a checkout of the source, after `make .venv/.installed`"
    missing = [name for name in ("pytest", "hypothesis") if util.find_spec(name) is None]
    return f'install {" and ".join(missing)}: pip install -e ".[test]"' if missing else ""


def checked(*options: str) -> dict:
    """What `python -m verification.robustness.mutants` finds, in a process of its own: it forks."""
    with tempfile.TemporaryDirectory(prefix="samfem-mutation-") as base:
        found = Path(base, "judged.json")
        words = [sys.executable, "-m", TOOL, "--json", str(found), *options]
        environment = os.environ | dict.fromkeys(EVERY_LIBRARY, "1") | {"SAMFEM_STORE": ""}
        ended = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True)
        if not found.is_file():
            raise RuntimeError(f"the mutation check broke off: {ended.stderr[-400:]}")
        return json.loads(found.read_text(encoding="utf-8"))


def mutants_of(found: Mapping) -> list[tuple]:
    """(mutant, judgement, whether it is a changed number of the core, of which none is left out)."""
    from verification.robustness.mutants import changes, scope  # noqa: PLC0415 - of the source only

    pairs = [(changes.Mutant(**one["mutant"]), one) for one in found["judged"]]
    return [(mutant, one, scope.whole(mutant)) for mutant, one in pairs]


def values_of(found: Mapping) -> dict[str, Measured]:
    """The gates, from the judgements as read back."""
    outcomes = Counter(one["outcome"] for _, one, whole in mutants_of(found) if whole)
    killed = [one["seconds"] for one in found["judged"] if one["outcome"] == "killed"]
    moving = [one for one in found["shown"] if not one["equivalent"]]
    return {
        "killed": Measured(outcomes["killed"] / max(outcomes["killed"] + outcomes["survived"], 1)),
        "unexplained": Measured(len(found["lost"]), 0),
        "not-inert": Measured(len(moving)),
        "rewriting": Measured(len(found["control"])),
        "slowest-kill": Measured(max(killed, default=float("nan")), unit="s"),
    }


def counts_table(found: Mapping) -> SmallTable:
    """By module how many mutants were killed of those that count: numbers of the core, and the drawn."""
    counts, kinds = Counter(), ("number", "row", "comparison", "branch")
    for mutant, one, _ in mutants_of(found):
        kind = mutant.kind.replace("count", "number")
        for name in (mutant.module, "all"):
            counts[name, one["outcome"]] += 1
            counts[name, kind, one["outcome"]] += 1
    names = [*sorted({name for name, *_ in counts} - {"all"}), "all"]

    def killed_of(*key: str) -> str:
        killed = counts[*key, "killed"]
        return f"{killed} of {killed + counts[*key, 'survived']}"

    rows = [
        (name, *(killed_of(name, kind) for kind in kinds), str(counts[name, "structure"])) for name in names
    ]
    columns = ("module", "numbers", "table rows", "comparisons", "branches", "structure, left out")
    return SmallTable("Mutants by module, killed", columns, rows)


def survivors_table(found: Mapping) -> SmallTable:
    """What no test noticed and should have, and every other changed number of the core, with the reason."""
    from verification.robustness.mutants import scope  # noqa: PLC0415 - of the source only

    explained, lost = scope.constants("explained"), found["lost"]
    rows = [(name, *what.rsplit(": ", 1), "") for name, what in lost.items()]
    rows += [
        (mutant.name, f"{mutant.text} in {mutant.line}", explained.get(mutant.key, ""), str(one["asked"]))
        for mutant, one, whole in mutants_of(found)
        if whole and one["outcome"] == "survived" and mutant.name not in lost
    ]
    return SmallTable("Survivors", ("where", "what", "why", "tests asked"), rows)


def equivalent_table(found: Mapping) -> SmallTable:
    """The equivalent mutants: constants that must not matter, and how much they do."""
    rows = []
    for one in found["shown"]:
        where = f"{one['mutant']['module']} {one['mutant']['function']}"
        change, probes = f"{one['change']:.2g}", str(one["probes"])
        rows.append((where, one["mutant"]["text"], one["reason"], change, probes))
    columns = "where|constant|why it must not matter|largest change, in tolerances|solves that run the module"
    return SmallTable("Constants that must not change the answer", columns.split("|"), rows)


class Mutation(Case):
    """What `checked` finds of the modules of a level, at quick only where it is asked by name."""

    def solve(self, context: Context) -> dict:
        return checked(*(word for name in MODULES[context.level] for word in ("--module", name)))

    def measure(self, found: Mapping) -> dict[str, Measured]:
        return values_of(found)

    def setup(self, found: Mapping) -> Iterator[tuple[str, str]]:
        from verification.robustness.mutants import frozen, scope  # noqa: PLC0415 - of the source only
        from verification.robustness.mutants.changes import FACTOR, MORE  # noqa: PLC0415 - of the source only

        errors = Counter(one["error"] for one in found["judged"] if one["outcome"] == "killed")
        failed = sum(count for error, count in errors.items() if error in ("AssertionError", "Failed"))
        others = sum(errors.values()) - failed
        fast = f"{found['tests']} that take less than a second each"
        yield "Perturbed by", f"a factor {FACTOR}; named counts grow by {MORE}; one at a time"
        drawn = f"{scope.PERCENT} % of the comparisons, conditions and numbers around the core"
        yield "Drawn beside them", drawn
        yield "Left out as structure", "0, indices, powers, keys, integers that never meet a float"
        yield "Tests asked", f"{fast}; those that run the function, the fastest first"
        yield "Killed by", f"{failed} by an assertion, {others} by an error or by the time that they take"
        yield "Time", f"{found['seconds']:.0f} s"
        asked = {mutant.module for mutant, *_ in mutants_of(found)}
        yield "Sample", f"{len(found['judged'])} mutants of {', '.join(sorted(asked))}"
        killed = sum(int(row[kind]) for row in frozen.read() for kind in frozen.COLUMNS[2:5])
        survived = sum(len(row["survivors"]) for row in frozen.read())
        words = f"{killed} killed, {survived} survived, as frozen.csv has them"
        yield (
            "Campaign",
            f"once, all {len(scope.modules())} modules, by commit 38689b9 and later ones: {words}",
        )

    def tables(self, found: Mapping) -> Iterator[SmallTable]:
        for table in (counts_table, survivors_table, equivalent_table):
            if (made := table(found)).rows:
                yield made


CASES = (Mutation("mutation", needs=needs, alone=True),)
