# SPDX-License-Identifier: MIT
"""The headline of the pages: whether this model of running-in predicts what the paper says.

It also tells on what that depends. Nothing is said here that the data or the notes of a case do not
hold; where a study did not run, that is said.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from verification.cases.running_in.study import LAST, STILL
from verification.suite.pages.judged import (
    FINER,
    FOLLOWS,
    HELD,
    INPUTS,
    NOT_RUN,
    OLDER,
    OPEN,
    PHYSICS,
    READINGS,
    Judged,
    held,
    in_words,
)
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
    "points. Holds under: of the ways to "
    "harden and to load. Of equal changes that make a statement hold the smallest are named. Bulk: steel "
    "without a layer, removed above a plastic strain of 0.2 %; curve A, curve B, hardening only: with a "
    "nano-crystalline layer as after polishing, mild wear or harder towards the surface, removed above 2 "
    "% (5 % where it is said)."
)
"""Of the columns and the words of the table."""
PICTURES = ((INPUTS, "probabilities"), (PHYSICS, "volume"))
"""Case and name of the figures of the headline."""
UNTESTED = (
    "That curve C is very close to curve B, so that the paper's Fig. 15 stands for both: curve C runs on one "
    "surface (case running-in, other assumptions), and no statement asks for it."
)
NOTHING = "none of those studied"
GIGA = 1e-9
COLUMNS = "Fig.|statement of the paper|printed inputs|second reading|share of points (90 %)".split("|")
COLUMNS += ["decided by", "holds under", "what makes it hold"]


@dataclass(frozen=True)
class Headline:
    """What the page of running-in begins with. answer: by the readings of the paper; depends: on
    what that depends, and what each of it does; rows: of the table of statements; pictures: figures
    as in results.json. Of an older version only the answer.
    """

    answer: str
    depends: Sequence[tuple[str, str]] = ()
    rows: Sequence[Sequence[str]] = ()
    pictures: Sequence[Mapping] = ()
    question: str = QUESTION
    page: str = f"{PAGE}.html"

    @property
    def table(self) -> dict:
        """The statements, and what its columns mean."""
        caption = "What the paper says of its Figures 13 to 17, and on what each statement depends"
        return {"caption": caption, "columns": COLUMNS, "rows": self.rows, "note": MEANING}


def headline_of(stored: Stored) -> Headline | None:
    """The headline, if any of the cases judged the statements of the paper."""
    judged = Judged(stored)
    if judged.older:
        return Headline(f"The studies of running-in in this report were {OLDER.format('have')}.")
    if not judged.statements:
        return None
    depends = {
        "Inputs that the paper leaves open": _of_inputs(judged),
        "Hardening and loading": _of_physics(judged),
        "Statements that fail with the printed inputs": _of_failed(judged),
        "Not judged": (UNTESTED,),
        "Size of the cells": (judged.note(FINER, "Verdicts"), judged.note(FINER, "One surface")),
        "Wear in the last cycles": _of_last_cycles(judged),
    }
    ran = {name: each.case for name in (INPUTS, PHYSICS) if (each := judged.case(name))}
    return Headline(
        " ".join(_of_readings(judged)),
        [(on, text) for on, said in depends.items() if (text := " ".join(filter(None, said)))],
        [_row(judged, words) for words in judged.statements],
        [
            figure
            for case, name in PICTURES
            for figure in ran.get(case, {}).get("figures", ())
            if figure["png"].endswith(f"{case}-{name}.png")
        ],
    )


def _of_readings(judged: Judged) -> Iterator[str]:
    if not judged.verdicts:
        yield judged.missing(READINGS)
        return
    count, readings = len(judged.statements), list(zip(*judged.verdicts.values(), strict=True))
    (first, agreed), *others = [
        (sum(map(held, each)), sum(one["by_agreement"] == HELD for one in each)) for each in readings
    ]
    yield "Yes." if first == count else "In part." if first else "No."
    second = judged.said(READINGS, "second_reading")
    yield (
        f"With the printed inputs, {first} of its {count} statements on five materials hold by the median of "
        f"the surfaces, {agreed} on at least 80 % of them"
        + "".join(f"; in a second reading ({second}) {more} and {of}" for more, of in others)
        + "."
    )
    own = {words: each for words, each in judged.verdicts.items() if words not in FOLLOWS}
    first, *others = (sum(map(held, each)) for each in zip(*own.values(), strict=True))
    yield (
        f"{count - len(own)} of the {count} follow from others: of the {len(own)} independent ones {first} "
        "hold" + "".join(f", in the second reading {more}" for more in others) + "."
    )
    coarse = [
        words
        for words, (coarsest, *_, finest) in judged.found(FINER).items()
        if words in own and held(own[words][0]) and held(coarsest) and not held(finest)
    ]
    if coarse:
        yield (
            f"With the printed inputs {len(coarse)} of these {first} ({'; '.join(coarse)}) failed on finer "
            "cells where those were tried, on one surface; not counting such, "
            f"{first - len(coarse)} of {len(own)} hold."
        )


def _of_inputs(judged: Judged) -> Iterator[str]:
    chances = judged.chances
    if not chances:
        yield judged.missing(INPUTS)
        return
    known = {words: each["holds"] / each["of"] for words, each in chances.items() if each["of"]}
    if not known:
        yield "No statement says anything at any point."
        return
    own, likely = chances.keys() - FOLLOWS.keys(), judged.likely
    least, most = (pick(known, key=lambda words: known[words]) for pick in (min, max))
    runs = dict(judged.stored.ran[INPUTS].case["setup"]).get("Runs", "")
    yield (
        f"{len(likely)} of {len(chances)} statements ({len(own.intersection(likely))} of the {len(own)} "
        f"independent ones) hold at more than half of the points, {judged.sure} of them also by the lower "
        f"bound ({runs.partition(':')[0]}): from "
        f"{100 * known[least]:.0f} % ({least}) to {100 * known[most]:.0f} % ({most})."
    )
    if deciding := [each["deciders"][0]["input"] for each in chances.values() if each["deciders"]]:
        named = ", ".join(f"{name} ({count})" for name, count in Counter(deciding).most_common(3))
        yield (
            f"{len(deciding)} of all {len(chances)} depend{'s' * (len(deciding) == 1)} on an input beyond "
            f"chance, first on {named}."
        )
    else:
        yield "None depends on an input beyond chance."
    yield (
        "Of the others the study does not tell: it resolves changes of "
        f"{100 * judged.said(INPUTS, 'resolved'):.0f} % and more between the halves of a range."
    )
    if best := judged.most_at_a_point:
        yield (
            f"At the best of the points {best} hold together (fitted), which is no bound: "
            "nothing between the points was tried."
        )


def _of_physics(judged: Judged) -> Iterator[str]:
    if not judged.physics:
        yield judged.missing(PHYSICS)
        return
    counts = {each: count for each, (count, _) in judged.physics.items()}
    best = [each for each, count in counts.items() if count == max(counts.values())]
    yield (
        f"On one surface under each of {len(counts)} ways to harden and to load it, {counts[best[0]]} hold "
        f"together at best, with {in_words(best, 'and')}; under the way of the paper {counts[()]}."
    )
    yield judged.note(PHYSICS, "One surface")


def _of_failed(judged: Judged) -> Iterator[str]:
    """From which pressures on the model removes metal, and whether what fails with the printed
    inputs holds under anything.
    """
    regimes: Mapping = next(iter(judged.said(READINGS, "regimes").values()), {})
    if reached := [own["reached"] for own in regimes.values() if own["reached"] is not None]:
        removed = ", ".join(f"{GIGA * own['removed_from']:.2f} ({name})" for name, own in regimes.items())
        films = min(own["film_fails_from"] for own in regimes.values())
        yield (
            f"Under a failed film metal is removed where the pressure is above {removed} GPa; films fail "
            f"from {GIGA * films:.2f} GPa, and the first cycle reaches {GIGA * max(reached):.2f} GPa "
            "(median)."
        )
    if judged.verdicts and judged.chances and judged.physics:
        never = [words for words in judged.statements if _remedy(judged, words) == NOTHING]
        yield (
            f"{len(never)} hold{'s' * (len(never) == 1)} ({'; '.join(never)}) under nothing that was studied."
            if never
            else "Each holds under something that was studied."
        )


def _of_last_cycles(judged: Judged) -> Iterator[str]:
    """Whether the last cycles wear."""
    if on := judged.said(PHYSICS, "wear_goes_on"):
        own, of = map(sum, zip(*on.values(), strict=True))
        yield (
            f"In the study over hardening and loading cycles {LAST - 4} to {LAST} add more than "
            f"{100 * STILL:g} % to the worn volume, where linear wear adds 20 %, in {own} of {of} runs "
            f"({'; '.join(f'{counter}: {k} of {n}' for counter, (k, n) in on.items())})."
        )
    last: Mapping = next(iter(judged.said(READINGS, "last_cycle").values()), {})
    if rests := [cycle for own in last.values() for cycle in own["rest_from"]]:
        busy = rests.count(None)
        yield (
            f"With the printed inputs cells strain anew in the last cycle in {busy} of {len(rests)} runs: "
            "under the same plane a cycle without new strain is followed by cycles like it."
            if busy
            else "With the printed inputs wear has ended because no cell strains anew in the last cycle in "
            f"any of {len(rests)} runs: a cycle that neither strains nor wears is followed by cycles like it."
        )


def _row(judged: Judged, words: str) -> tuple[str, ...]:
    verdicts, chance = judged.verdicts.get(words, ()), judged.chances.get(words)
    readings = [
        f"{each['by_median']}, {each['holds_on']} of {each['of']}"
        + f", none on {each['none_on']}" * bool(each["none_on"])
        for each in verdicts
    ]
    share, decided, physics = NOT_RUN, NOT_RUN, NOT_RUN
    if chance:
        low, high = (100 * (end or 0.0) for end in chance["bounds"])
        says = chance["of"] and f"{100 * chance['holds'] / chance['of']:.0f} % ({low:.0f} to {high:.0f})"
        share, decided = says or "says nothing", "; ".join(chance["words"]) or "not resolved"
    if judged.physics:
        silent = len(judged.under(words, OPEN))
        physics = f"{len(judged.under(words))} of {len(judged.physics)}"
        physics += f", says nothing under {silent}" * bool(silent)
    text = f"{words} ({verdicts[0]['measure']} {verdicts[0]['asked']})" if verdicts else words
    text += f"; follows from: {FOLLOWS[words]}" if words in FOLLOWS else ""
    readings += [NOT_RUN] * (2 - len(readings))
    return judged.statements[words], text, *readings, share, decided, physics, _remedy(judged, words)


def _remedy(judged: Judged, words: str) -> str:
    """What makes a statement hold that fails with the printed inputs, empty where it holds."""
    printed, *others = map(held, judged.verdicts.get(words, ({"by_median": ""},)))
    if printed:
        return ""
    found = ["the second reading"] * any(others)
    if under := judged.under(words):
        found.append(in_words([each for each in under if len(each) == len(under[0])], "or"))
    if (chance := judged.chances.get(words)) and chance["holds"]:
        found.append(f"other inputs, {chance['holds']} of {chance['of']} points")
    return "; ".join(found) or (NOTHING if judged.chances and judged.physics else "")
