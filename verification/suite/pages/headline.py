# SPDX-License-Identifier: MIT
"""The headline of the pages: whether this model of running-in predicts what the paper says.

It also tells on what that depends. Nothing is said here that no table of a case holds; where a study did not
run, that is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from verification.suite.pages.judged import FINER, INPUTS, NOT_RUN, PHYSICS, READINGS, Chance, Judged, Verdict
from verification.suite.pages.statements import FOLLOWS
from verification.suite.pages.stored import Stored

QUESTION = "Does this model of running-in predict what its authors say, and on what does that depend?"
PAGE = "running-in"
MEANING = (
    "Behind a statement: the measure that decides it, and what is asked of it; V: worn volume, μ: "
    "coefficient of friction, Sa: roughness, in brackets the cycle. Friction falls, or lies below another, "
    "where it does by 0.001, a third of a per cent of 0.3; what lies below another as a ratio, by 0.1 %. "
    "Printed inputs: those that the paper prints, and ours where it prints none: surface, size of the "
    "layers' deviation, smoothing; the plastic loop is not the printed one, which is refused with wear. "
    "Second reading: a layer that hardens weakly, and a rough counter-surface that is new in each cycle. "
    "Both: the verdict by the median of the surfaces, and on how many of them the statement holds; `none "
    "on 2`: on two of them it says nothing. Share of points: of the study over inputs, each on another "
    "surface, with bounds of 90 %. Decided by: how much more often the statement holds in the upper half "
    "of the range of an input; not resolved: no input changes that by more than chance does with so many "
    "points, nor does a fit that predicts points it has not seen name one. Holds under: of the ways to "
    "harden and to load. Of equal changes that make a statement hold the smallest are named. Bulk: steel "
    "without a layer, removed above a plastic strain of 0.2 %; curve A, curve B, hardening only: with a "
    "nano-crystalline layer as after polishing, mild wear or harder towards the surface, removed above 2 "
    "% (5 % where it is said)."
)
"""Of the columns and the words of the table."""
PICTURES = ((INPUTS, "probabilities"), (INPUTS, "two-inputs"), (PHYSICS, "volume"))
"""Case and name of the figures of the headline."""
STUDIES = {
    READINGS: "The comparison of both readings",
    INPUTS: "The study over the inputs",
    PHYSICS: "The study over hardening and loading",
}
UNTESTED = (
    "That curve C is very close to curve B, so that the paper's Fig. 15 stands for both: curve C runs on one "
    "surface (case running-in, other assumptions), and no statement asks for it."
)
MANY = 2  # of what is equal that is named
COLUMNS = (
    "Fig.",
    "statement of the paper",
    "printed inputs",
    "second reading",
    "share of points (90 %)",
    "decided by",
    "holds under",
    "what makes it hold",
)


@dataclass(frozen=True)
class Headline:
    """What the page of running-in begins with. answer: by the readings of the paper; depends: on what that
    depends, and what each of it does; rows: of the table of statements; pictures: figures as in results.json;
    fitted: a table, empty without, and fitted_note what it would mean.
    """

    answer: str
    depends: Sequence[tuple[str, str]]
    rows: Sequence[Sequence[str]]
    pictures: Sequence[Mapping]
    fitted: Mapping
    fitted_note: str
    question: str = QUESTION
    page: str = f"{PAGE}.html"

    @property
    def table(self) -> dict:
        """The statements, and what its columns mean."""
        caption = "What the paper says of its Figures 13 to 17, and on what each statement depends"
        return {"caption": caption, "columns": COLUMNS, "rows": self.rows, "note": MEANING}

    @property
    def files(self) -> set[str]:
        """Of the figures, which need not be shown a second time."""
        return {each["png"] for each in self.pictures}


def headline_of(stored: Stored) -> Headline | None:
    """The headline, if any of the cases judged the statements of the paper."""
    judged = Judged(stored)
    if not judged.statements:
        return None
    return Headline(
        " ".join(_of_readings(judged) if judged.verdicts else _missing(judged, READINGS)),
        [(on, text) for on, said in depends(judged).items() if (text := " ".join(filter(None, said)))],
        [_row(judged, words) for words in judged.statements],
        list(_pictures(judged)),
        judged.fitted,
        judged.note(INPUTS, "Fitted"),
    )


def depends(judged: Judged) -> dict[str, Iterator[str]]:
    """What the answer may depend on -> sentences of what each does."""
    return {
        "Inputs that the paper leaves open": (
            _of_inputs(judged) if judged.chances else _missing(judged, INPUTS)
        ),
        "Hardening and loading": _of_physics(judged) if judged.physics else _missing(judged, PHYSICS),
        "Statements that fail with the printed inputs": _of_failed(judged),
        "Not judged": iter((UNTESTED,)),
        "Size of the cells": iter((judged.note(FINER, "Verdicts"), judged.note(FINER, "One surface"))),
        "Wear in the last cycles": _of_last_cycles(judged),
    }


def _missing(judged: Judged, case: str) -> Iterator[str]:
    where = "was made without what the statements ask for" if judged.case(case) else NOT_RUN
    yield f"{STUDIES[case]} (case {case}) {where}."


def _of_readings(judged: Judged) -> Iterator[str]:
    count = len(judged.statements)
    readings = list(zip(*judged.verdicts.values(), strict=True))
    (held, agreed), *others = [_counted(each) for each in readings]
    yield "Yes." if held == count else "In part." if held else "No."
    yield (
        f"With the printed inputs, {held} of its {count} statements on five materials hold by the median of "
        f"the surfaces, {agreed} on at least 80 % of them"
        + "".join(f"; in a second reading ({_second(judged)}) {more} and {of}" for more, of in others)
        + "."
    )
    own = {words: each for words, each in judged.verdicts.items() if words not in FOLLOWS}
    held, *others = (sum(each.held for each in of) for of in zip(*own.values(), strict=True))
    yield (
        f"{count - len(own)} of the {count} follow from others: of the {len(own)} independent ones {held} "
        "hold" + "".join(f", in the second reading {more}" for more in others) + "."
    )
    if coarse := [words for words in judged.refuted if words in own and own[words][0].held]:
        yield (
            f"With the printed inputs {len(coarse)} of these {held} ({'; '.join(coarse)}) failed on finer "
            "cells where those were tried, on one surface; not counting such, "
            f"{held - len(coarse)} of {len(own)} hold."
        )


def _second(judged: Judged) -> str:
    return judged.setup(READINGS, "Second reading").partition(";")[0]


def _counted(verdicts: Sequence[Verdict]) -> tuple[int, int]:
    return sum(each.held for each in verdicts), sum(each.agreed == "held" for each in verdicts)


def _of_inputs(judged: Judged) -> Iterator[str]:
    chances = judged.chances
    known = {words: each.percent for words, each in chances.items() if each.percent is not None}
    if not known:
        yield "No statement says anything at any point."
        return
    own = chances.keys() - FOLLOWS.keys()
    likely = sum(known.get(words, 0.0) > 50.0 for words in own)
    least, most = (pick(known, key=lambda words: known[words]) for pick in (min, max))
    yield (
        f"{judged.likely} of {len(chances)} statements ({likely} of the {len(own)} independent ones) hold at "
        f"more than half of the points, {judged.sure} of them also by the lower bound "
        f"({judged.setup(INPUTS, 'Runs').partition(':')[0]}): from "
        f"{known[least]:.0f} % ({least}) to {known[most]:.0f} % ({most})."
    )
    deciding = [each.deciders[0].partition(":")[0] for each in chances.values() if each.deciders]
    if deciding:
        first = Counter(deciding)
        named = ", ".join(f"{name} ({count})" for name, count in first.most_common(3))
        yield (
            f"{len(deciding)} of all {len(chances)} depend{'s' * (len(deciding) == 1)} on an input beyond "
            f"chance, first on {named}."
        )
    else:
        yield "None depends on an input beyond chance."
    if seen := judged.setup(INPUTS, "Resolved"):
        yield f"Of the others the study does not tell: it resolves {seen}."
    if judged.fitted:
        yield (
            f"At the best of the points {judged.most_at_a_point} hold together (fitted), which is no bound: "
            "nothing between the points was tried."
        )


def _of_physics(judged: Judged) -> Iterator[str]:
    most = max(judged.physics.values())
    best = [each for each, count in judged.physics.items() if count == most]
    named = " or ".join(each.words for each in best[:MANY])
    more = f" and {len(best) - MANY} more" if len(best) > MANY else ""
    yield (
        f"On one surface under each of {len(judged.physics)} ways to harden and to load it, {most} "
        f"hold together at best, with {named}{more}; under the way of the paper {judged.plain}."
    )
    yield judged.note(PHYSICS, "One surface")


def _of_failed(judged: Judged) -> Iterator[str]:
    """From which pressures on the model removes metal, and whether what fails with the printed inputs
    holds under anything.
    """
    table = judged.table(READINGS, "so", "What decides")  # that of the printed inputs is the first
    rows = [dict(zip(table["columns"], row, strict=True)) for row in table.get("rows", ())]
    if rows:
        removed = ", ".join(f"{row['removed from, μ high']} ({row['case']})" for row in rows)
        films, reached = ([row[name] for row in rows] for name in ("film fails from", "p_max, first cycle"))
        yield (
            f"Under a failed film metal is removed where the pressure is above {removed} GPa; films fail "
            f"from {min(films, key=float)} GPa, and the first cycle reaches {max(reached, key=float)} GPa "
            "(median)."
        )
    if judged.verdicts and judged.chances and judged.physics:
        never = [words for words in judged.statements if _remedy(judged, words) == NOTHING]
        yield (
            f"{_listed(never)} under nothing that was studied."
            if never
            else "Each holds under something that was studied."
        )


def _of_last_cycles(judged: Judged) -> Iterator[str]:
    """Whether the last cycles wear."""
    still = judged.note(PHYSICS, "Cycles ")
    if still:
        yield f"In the study over hardening and loading c{still[1:]}"
    table = judged.table(READINGS, "at rest from cycle")
    if table:
        column = 1  # of the printed inputs: on how many surfaces cells strain anew
        busy, of = (sum(int(row[column].split()[k]) for row in table["rows"]) for k in (0, 2))
        yield (
            f"With the printed inputs cells strain anew in the last cycle in {busy} of {of} runs: under the "
            "same plane a cycle without new strain is followed by cycles like it."
            if busy
            else "With the printed inputs wear has ended because no cell strains anew in the last cycle in "
            f"any of {of} runs: a cycle that neither strains nor wears is followed by cycles like it."
        )


NOTHING = "none of those studied"


def _row(judged: Judged, words: str) -> tuple[str, ...]:
    verdicts = judged.verdicts.get(words, [])
    readings = [each.text for each in verdicts] + [NOT_RUN] * (2 - len(verdicts))
    chance = judged.chances.get(words, Chance())
    decided = "; ".join(chance.deciders) or (NOT_RUN if chance.text == NOT_RUN else "not resolved")
    physics = f"{len(judged.under[words])} of {len(judged.physics)}" if judged.physics else NOT_RUN
    if silent := judged.silent.get(words):
        physics += f", says nothing under {silent}"
    made = "" if verdicts and verdicts[0].held else _remedy(judged, words)
    asked = judged.asked.get(words)
    text = f"{words} ({asked})" if asked else words
    text += f"; follows from: {FOLLOWS[words]}" if words in FOLLOWS else ""
    return judged.statements[words], text, *readings, chance.text, decided, physics, made


def _remedy(judged: Judged, words: str) -> str:
    """What makes a statement hold that fails with the printed inputs, empty where it holds."""
    printed, *others = judged.verdicts.get(words, [Verdict()])
    if printed.held:
        return ""
    found = ["the second reading"] if any(each.held for each in others) else []
    under = judged.under.get(words, [])
    if under:
        few = [each for each in under if len(each.changes) == len(under[0].changes)]
        more = f" or {len(few) - MANY} more" if len(few) > MANY else ""
        found.append(" or ".join(each.words for each in few[:MANY]) + more)
    chance = judged.chances.get(words, Chance())
    if chance.possible:
        found.append(f"other inputs, {chance.points} points")
    if found:
        return "; ".join(found)
    return NOTHING if judged.chances and judged.physics else ""


def _listed(words: Sequence[str]) -> str:
    return f"{len(words)} hold{'s' * (len(words) == 1)} ({'; '.join(words)})"


def _pictures(judged: Judged) -> Iterator[Mapping]:
    for case, name in PICTURES:
        ran = judged.case(case)
        for figure in ran.case["figures"] if ran else ():
            if figure["png"].endswith(f"{case}-{name}.png"):
                yield figure
