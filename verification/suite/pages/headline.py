# SPDX-License-Identifier: MIT
"""The headline of the pages: whether this model of running-in predicts what the paper says, from the data of
the studies that judge its statements. Where a study did not run, that is said.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from verification.suite.pages.stored import ShownCase, Stored

PAGE = "running-in"
READINGS, INPUTS, PHYSICS = "running-in", "running-in-sensitivity", "running-in-physics"
WORDS = "running-in-readings"
STUDIES = {
    READINGS: "The comparison of both readings",
    INPUTS: "The study over the inputs",
    PHYSICS: "The study over hardening and loading",
}
NOT_RUN = "did not run"
HELD, OPEN = "held", "not decided"
FOLLOWS = {
    "bulk: hardly any wear later": "bulk: worn in the first six cycles",
    "curve A: friction below that of bulk": "friction: A and hardening below bulk",
}
"""Statements that say no more than another one does -> that one. The first follows by what is asked of both:
where nine tenths wear in 6 cycles, 15 of the other 19 wear at less than a twentieth of that rate. The second
follows in words only: a difference of 0.001 is asked of it, and of that one a ratio of 0.999.
"""
COLUMNS = "Fig.|statement of the paper|printed inputs|second reading|share of points (90 %)".split("|")
COLUMNS += ["decided by", "holds under"]
CAPTION = "What the paper says of its Figures 13 to 17, and on what each statement depends"
MEANING = (
    "All runs but those on finer cells have 12 cells in the shortest wave of the surface, half of what "
    "wear-converged recommends: it found worn volumes 6 to 27 % too small on 14 cells, 15 to 45 % on 8. "
    "Behind a statement: the measure that decides it, and what is asked of it; V: worn volume, μ: "
    "coefficient of friction, Sa: roughness, in brackets the cycle. Friction falls, or lies below another, "
    "where it does by 0.001, a third of a per cent of 0.3; what lies below another as a ratio, by 0.1 %. "
    "Printed inputs: those that the paper prints, and ours where it prints none: surface, size of the "
    "layers' deviation, smoothing; the plastic loop is not the printed one, see running-in-readings. "
    "Second reading: a layer that hardens weakly, and a rough counter-surface that is new in each cycle. "
    "Both: the verdict by the median of the surfaces, and on how many of them the statement holds; `none "
    "on 2`: on two of them it says nothing. Share of points: of the study over inputs, each on another "
    "surface, with bounds of 90 %. Decided by: how much more often the statement holds in the upper half "
    "of the range of an input; not resolved: no input changes that by more than chance does with so many "
    "points. Holds under: of the ways to "
    "harden and to load. Bulk: steel without a layer, removed above a plastic strain of 0.2 %; curve A, "
    "curve B, hardening only: with a nano-crystalline layer as after polishing, mild wear or harder towards "
    "the surface, removed above 2 % (5 % where it is said). That curve C is very close to curve B is judged "
    "in running-in-readings."
)
"""Of the columns and the words of the table."""
Verdicts = Mapping[str, Sequence[Mapping[str, Any]]]
"""Words of a statement -> what was found of it in each reading, or on each size of cells."""


@dataclass(frozen=True)
class Headline:
    """What the page of running-in begins with. answer: by the readings of the paper; brief: the same for
    whoever has not read it; depends: on what that depends; rows: of the table of statements; studies: behind
    it. Of an older version only the answer.
    """

    answer: str
    studies: tuple[ShownCase, ...]
    depends: str = ""
    rows: Sequence[Sequence[str]] = ()
    brief: str = ""
    page: str = f"{PAGE}.html"

    @property
    def table(self) -> dict:
        """The statements."""
        return {"caption": CAPTION, "columns": COLUMNS, "rows": self.rows, "note": MEANING}


def headline_of(stored: Stored) -> Headline | None:
    """The headline, if any of the cases judged the statements of the paper."""
    studies = tuple(stored.ran[name] for name in STUDIES if name in stored.ran)
    if studies and not any("data" in each.case for each in studies):
        words = (
            "The studies of running-in in this report were made by an older version and have to run again."
        )
        return Headline(words, studies)
    data = {each.name: each.case.get("data", {}) for each in stored.ran.values()}
    read, finer = (
        _together(data.get(name, {}).get(of, {})) for name, of in ((READINGS, "statements"), (WORDS, "finer"))
    )
    drawn, tried = (
        {each["statement"]: each for each in data.get(name, {}).get("statements", ())}
        for name in (INPUTS, PHYSICS)
    )
    figures = {words: each[0]["figure"] for words, each in read.items()}
    figures = figures or {words: each["figure"] for words, each in (drawn or tried).items()}
    if not figures:
        return None

    def missing(name: str) -> str:
        why = "was made without what the statements ask for" if name in stored.ran else NOT_RUN
        return f"{STUDIES[name]} (case {name}) {why}."

    second = data.get(READINGS, {}).get("second_reading", "")
    depends = [*(_of_inputs(drawn, data[INPUTS]) if drawn else [missing(INPUTS)])]
    if tried:
        counts = data[PHYSICS]["held"]
        depends.append(
            f"On one surface, which gives no probability, under each of {len(counts)} ways to harden and to "
            f"load it, {max(counts)} hold together at best; under the way of the paper {counts[0]}."
        )
    else:
        depends.append(missing(PHYSICS))
    return Headline(
        " ".join(_of_readings(read, finer, second)) if read else missing(READINGS),
        studies,
        " ".join(depends),
        [
            (figure, *_row(words, read.get(words, ()), drawn.get(words), tried.get(words)))
            for words, figure in figures.items()
        ],
        _in_brief(read, data.get(WORDS, {}).get("statements", {})) if read else "",
    )


def _together(statements: Mapping[str, Sequence[Mapping]]) -> Verdicts:
    """Of each statement what was found in every reading."""
    return {each[0]["statement"]: each for each in zip(*statements.values(), strict=True)}


def held(found: Mapping) -> bool:
    """Whether a statement holds by the median of the surfaces."""
    return found["by_median"] == HELD


def _by_median(read: Verdicts) -> list[int]:
    """How many statements hold by the median of the surfaces, in each reading."""
    return [sum(map(held, each)) for each in zip(*read.values(), strict=True)]


def _answer(held_first: int, count: int) -> str:
    return "Yes." if held_first == count else "In part." if held_first else "No."


def _in_brief(read: Verdicts, words: Mapping[str, Sequence[Mapping]]) -> str:
    first, *others = _by_median(read)
    second = "".join(f", {more} in a second reading of it" for more in others)
    counts, tried = [sum(map(held, each)) for each in words.values()], ""
    if counts:
        asked = max(map(len, words.values()))
        tried = f" In {len(counts)} readings of its words {min(counts)} to {max(counts)} of {asked} hold."
    return (
        f"{_answer(first, len(read))} With the printed inputs, and ours where none are printed, {first} of "
        f"its {len(read)} statements about wear and friction of five materials hold{second}. The page says "
        f"which, on how many rough surfaces, and what finer cells change.{tried}"
    )


def _of_readings(read: Verdicts, finer: Verdicts, second: str) -> Iterator[str]:
    count, readings = len(read), list(zip(*read.values(), strict=True))
    (first, agreed), *others = [
        (sum(map(held, each)), sum(one["by_agreement"] == HELD for one in each)) for each in readings
    ]
    yield _answer(first, count)
    yield (
        f"With the printed inputs, {first} of its {count} statements on five materials hold by the median of "
        f"the surfaces, {agreed} on at least 80 % of them"
        + "".join(f"; in a second reading ({second}) {more} and {of}" for more, of in others)
        + "."
    )
    own = {words: each for words, each in read.items() if words not in FOLLOWS}
    first, *others = _by_median(own)
    yield (
        f"{count - len(own)} of the {count} follow from others: of the {len(own)} independent ones {first} "
        "hold" + "".join(f", in the second reading {more}" for more in others) + "."
    )
    coarse = [
        words
        for words, (coarsest, *_, finest) in finer.items()
        if words in own and held(own[words][0]) and held(coarsest) and not held(finest)
    ]
    if coarse:
        yield (
            f"With the printed inputs {len(coarse)} of these {first} ({'; '.join(coarse)}) failed on finer "
            "cells where those were tried, on three surfaces of a quarter of the area; not counting such, "
            f"{first - len(coarse)} of {len(own)} hold."
        )


def _of_inputs(chances: Mapping[str, Mapping], data: Mapping) -> Iterator[str]:
    known = {words: each["holds"] / each["of"] for words, each in chances.items() if each["of"]}
    if not known:
        yield "No statement says anything at any point."
        return
    likely = [words for words, each in chances.items() if 2 * each["holds"] > each["of"]]
    sure = sum(chances[words]["bounds"][0] > 0.5 for words in likely)
    own = chances.keys() - FOLLOWS.keys()
    least, most = (pick(known, key=lambda words: known[words]) for pick in (min, max))
    yield (
        f"Over the inputs that the paper leaves open {len(likely)} of {len(chances)} statements "
        f"({len(own.intersection(likely))} of the {len(own)} independent ones) "
        f"hold at more than half of the points, {sure} of them also by the lower bound: from "
        f"{100 * known[least]:.0f} % ({least}) to {100 * known[most]:.0f} % ({most})."
    )
    deciding = [each["deciders"][0]["input"] for each in chances.values() if each["deciders"]]
    named = ", ".join(f"{name} ({count})" for name, count in Counter(deciding).most_common(3))
    yield (
        f"{f'{len(deciding)} of all {len(chances)} depend' if deciding else 'None depends'} on an input "
        f"beyond chance{f', first on {named}' * bool(named)}; the study resolves changes of "
        f"{100 * data['resolved']:.0f} % and more between the halves of a range, and no smaller ones."
    )
    if best := data["best"]:
        yield (
            f"At the best of the points {best} hold together (fitted), which is no bound: "
            "nothing between the points was tried."
        )


def _row(
    words: str, verdicts: Sequence[Mapping], chance: Mapping | None, tried: Mapping | None
) -> tuple[str, ...]:
    """Cells after the first; verdicts: in each reading; chance: over inputs; tried: other physics."""
    readings = [
        f"{each['by_median']}, {each['holds_on']} of {each['of']}"
        + f", none on {each['none_on']}" * bool(each["none_on"])
        for each in verdicts
    ]
    readings += [NOT_RUN] * (2 - len(readings))
    share, decided, physics = NOT_RUN, NOT_RUN, NOT_RUN
    if chance:
        low, high = (100 * (end or 0.0) for end in chance["bounds"])
        says = chance["of"] and f"{100 * chance['holds'] / chance['of']:.0f} % ({low:.0f} to {high:.0f})"
        share, decided = says or "says nothing", "; ".join(chance["words"]) or "not resolved"
    if tried:
        found = Counter(tried["verdicts"])
        physics = f"{found[HELD]} of {len(tried['verdicts'])}"
        physics += f", says nothing under {found[OPEN]}" * bool(found[OPEN])
    text = f"{words} ({verdicts[0]['measure']} {verdicts[0]['asked']})" if verdicts else words
    text += f"; follows from: {FOLLOWS[words]}" if words in FOLLOWS else ""
    return text, *readings, share, decided, physics
