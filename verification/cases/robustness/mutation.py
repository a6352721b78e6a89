# SPDX-License-Identifier: MIT
"""Mutation check: numbers, comparisons and conditions changed one at a time, and what fast tests notice."""

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from importlib import util
from pathlib import Path
from typing import Any

from verification.cases.case import Context
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


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """What `checked` finds of the modules of a level, at quick only where it is asked by name."""
    return judged(checked(*(word for name in MODULES[context.level] for word in ("--module", name))))


def judged(found: Mapping) -> Iterator[dict[str, Any]]:
    """What the gates ask, of the judgements as read back; by module how many mutants were killed of those
    that count; what no test noticed, and the constants that must not matter.
    """
    from verification.robustness.mutants import changes, frozen, scope  # noqa: PLC0415 - of the source only

    counts, kinds = Counter(), {"number": "numbers", "row": "table rows"}
    kinds |= {"comparison": "comparisons", "branch": "branches"}
    modules: dict[str, set[str]] = {}
    explained, lost, kept = scope.constants("explained"), found["lost"], frozen.read()
    survivors = [{"where": name, "what": what} for name, what in lost.items()]
    for one in found["judged"]:
        mutant = changes.Mutant(**one["mutant"])
        part = "numbers of the core" if (whole := scope.whole(mutant)) else "drawn around it"
        counts[part, one["outcome"]] += 1
        own = "the core" if mutant.module in scope.core() else "what is around it"
        modules.setdefault(f"Mutants killed in the modules of {own}", set()).add(mutant.module)
        counts[mutant.module, mutant.kind.replace("count", "number"), one["outcome"]] += 1
        if whole and one["outcome"] == "survived" and mutant.name not in lost:
            why = explained.get(mutant.key, "")
            words = {"where": mutant.name, "what": f"{mutant.text} in {mutant.line}", "why": why}
            survivors.append(words | {"tests asked": one["asked"]})
    killed = [one for one in found["judged"] if one["outcome"] == "killed"]
    asserted = sum(one["error"] in ("AssertionError", "Failed") for one in killed)
    yield {
        "sweep": "Mutation",
        "killed": share(counts, "numbers of the core"),
        "killed, drawn": share(counts, "drawn around it"),
        "unexplained": len(lost),
        "not-inert": sum(not one["equivalent"] for one in found["shown"]),
        "rewriting": len(found["control"]),
        "slowest-kill": max((one["seconds"] for one in killed), default=float("nan")),
        "killed by an assertion": asserted,
        "by an error or the time": len(killed) - asserted,
        "tests": found["tests"],
        "time [s]": found["seconds"],
        "killed in the campaign": sum(int(row[kind]) for row in kept for kind in frozen.COLUMNS[2:5]),
        "survived in it": sum(len(row["survivors"]) for row in kept),
    }
    for words, names in modules.items():
        for name in sorted(names):
            ends = {end: [counts[name, kind, end] for kind in kinds] for end in ("killed", "survived")}
            said = {
                each: f"{one} of {one + other}"
                for each, one, other in zip(kinds.values(), *ends.values(), strict=True)
            }
            left = sum(counts[name, kind, "structure"] for kind in kinds)
            yield {"sweep": words, "module": name} | said | {"structure, left out": left}
    yield from ({"sweep": "Survivors"} | each for each in survivors)
    for one in found["shown"]:
        where = f"{one['mutant']['module']} {one['mutant']['function']}"
        row = {"sweep": "Constants that must not change the answer", "where": where}
        row |= {"what": one["mutant"]["text"], "why": one["reason"]}
        yield row | {
            "largest change, in tolerances": one["change"],
            "solves that run the module": one["probes"],
        }


def share(counts: Counter, part: str) -> float:
    """Of a part that tests kill, without what is structure."""
    killed = counts[part, "killed"]
    return killed / max(killed + counts[part, "survived"], 1)
