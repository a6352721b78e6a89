# SPDX-License-Identifier: MIT
"""`frozen.csv`: by function what was killed and survived, and how a later run differs from it."""

import csv
import json
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable
from pathlib import Path

from verification.robustness.mutants.judge import KILLED, STRUCTURE, SURVIVED, MutantVerdict
from verification.robustness.mutants.scope import NUMBERS, constants, whole

FILE = Path(__file__).with_name("frozen.csv")
COLUMNS = ("module", "function", "numbers", "comparisons", "branches", "survivors", "tests")


def read() -> list[dict]:
    """The lines of the table, none where there is none; survivors and tests as lists."""
    if not FILE.is_file():
        return []
    with FILE.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    return [row | {name: json.loads(row[name]) for name in ("survivors", "tests")} for row in rows]


def short(test: str) -> str:
    """A test without its folder and parameters."""
    return test.partition("[")[0].rpartition("/")[2]


def rows(judged: Iterable[MutantVerdict]) -> list[dict]:
    """The line of each function of which mutants were judged."""
    functions = defaultdict(list)
    for one in judged:
        if one.outcome != STRUCTURE:
            functions[one.mutant.module, one.mutant.function].append(one)
    found = []
    for (module, function), ones in sorted(functions.items()):
        killed = (one.mutant.kind for one in ones if one.outcome == KILLED)
        kinds = Counter("numbers" if kind in NUMBERS else kind for kind in killed)
        counts = kinds["numbers"], kinds["comparison"], kinds["branch"]
        survivors = sorted(f"{one.mutant.kind} {one.mutant.text}" for one in ones if one.outcome == SURVIVED)
        tests = sorted({short(one.by) for one in ones if "::" in one.by})
        found.append(dict(zip(COLUMNS, (module, function, *counts, survivors, tests), strict=True)))
    return found


def write(judged: Iterable[MutantVerdict], modules: Collection[str]) -> None:
    """Replace the lines of these modules by what was judged now."""
    kept = [row for row in read() if row["module"] not in modules]
    with FILE.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in sorted([*kept, *rows(judged)], key=lambda row: (row["module"], row["function"])):
            writer.writerow(row | {name: json.dumps(row[name]) for name in ("survivors", "tests")})


def compare(
    judged: Iterable[MutantVerdict], there: Collection[tuple[str, str]]
) -> tuple[dict[str, str], list[str]]:
    """Name of what survives unexplained -> what it is; functions of the table that are gone. Numbers of the
    core are explained in `constants.csv`, the others by having survived when the table was frozen. there:
    (module, function) of all mutants there are now. A function that is not where the table has it is looked
    for by its name; a mutant of one that was merged into another, by its text. Modules of which the table has
    nothing are not compared.
    """
    rows = {(row["module"], row["function"]): row for row in read()}
    judged, gone = list(judged), {place: row for place, row in rows.items() if place not in there}
    kept = {place: row for place, row in rows.items() if place in there}
    for name_of in (lambda function: function, lambda function: function.rpartition(".")[2]):
        for place in {(one.mutant.module, one.mutant.function) for one in judged} - kept.keys():
            same = [old for old in gone if name_of(old[1]) == name_of(place[1])]
            if len(same) == 1:
                kept[place] = gone.pop(same[0])
    left = {place: Counter(row["survivors"]) for place, row in kept.items()}
    merged = Counter(text for row in gone.values() for text in row["survivors"])
    frozen, lost = {module for module, _ in kept}, {}
    for mutant in (one.mutant for one in judged if one.outcome == SURVIVED):
        if whole(mutant):
            if mutant.key not in constants("explained"):
                lost[mutant.name] = f"{mutant.text}: a number of the core that is not explained"
            continue
        if mutant.module not in frozen:
            continue
        text, known = f"{mutant.kind} {mutant.text}", left.get((mutant.module, mutant.function))
        pool = known if known and known[text] else merged
        if pool[text]:
            pool[text] -= 1
        else:
            new = "of a function that the table does not have"
            why = new if known is None else "new, or killed before"
            lost[mutant.name] = f"{mutant.text}: {why}"
    return lost, [
        f"{module}:{function or 'module'}, {row['numbers']} numbers, {row['comparisons']} comparisons and "
        f"{row['branches']} branches killed"
        for (module, function), row in gone.items()
    ]
