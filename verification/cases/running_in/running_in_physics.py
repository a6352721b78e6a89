# SPDX-License-Identifier: MIT
"""The same body under other physics: how it hardens, what presses on it from cycle to cycle, and
whether friction changes its sign; which statements of the paper hold in which of them.

Everything else has the printed inputs: materials, film, limits of strain and load. The patch has a
quarter of the area of the printed scenes, so that all combinations take minutes; one surface, so
that nothing is said of others.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Path, Scene
from verification.cases.case import Context, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.running_in import study
from verification.cases.running_in.study import (
    BULK,
    CUBIC,
    HELD,
    LAST,
    NAMES,
    OPEN,
    SHARES,
    STATEMENTS,
    STILL,
    A,
    B,
    Effort,
    Run,
    Study,
)
from verification.figures.lines import over_cycles

if TYPE_CHECKING:
    from pandas import DataFrame

EFFORT = Effort(LAST, steps=3, cells=32)
SQ = 20e-9  # m: of the counter-surface, the geometric middle of the 5 to 60 nm of ground and polished discs
WAY, STEPS = (
    6e-6,
    6,
)  # m on either side of the middle; steps of 2 um, a sixth of the shortest wave of the disc
DRAWN = (BULK, A, B)
SAME, MOVES = "the same plane in place", "moves, rough, the same in each pass"
COUNTERS = {
    SAME: "same",
    "in place, rough, new in each cycle": "renewed",
    MOVES: "moves",
    "moves, rough, new in each pass": "moves-renewed",
}
"""What presses on the body from cycle to cycle, in words -> in labels."""
SIGNS = ("constant", "alternating")
"""Of friction from cycle to cycle."""
SHORT = {"isotropic": "I", "half and half": "H", "kinematic": "K"}
COLUMNS = tuple(product(COUNTERS, SIGNS))
ALL = tuple(product(COUNTERS, SIGNS, SHARES))
PARTS = ["counter", "sign", "hardening"]
"""Of one physics, an entry of ALL."""


def under(scene: Scene, counter: str, sign: str, hardening: str) -> Scene:
    """A printed scene under one physics."""
    scene, short = study.hardened(study.deeper(scene), SHARES[hardening]), COUNTERS[counter]
    alternates = sign == "alternating"
    if counter != SAME:
        scene = study.with_counter(scene, SQ, renew=short != "moves")
    if short.startswith("moves"):
        back = "to-and-fro" if alternates else "lifted"
        path = Path(start=(-WAY, 0.0), end=(WAY, 0.0), steps=STEPS, **{"return": back})
        return with_loading(scene, path=path, unload_steps=None)
    return with_keys(scene, "friction", direction="alternating") if alternates else scene


def late(one: Run) -> float:
    """Wear of the last five cycles in m3."""
    return one.history.volume_after(LAST) - one.history.volume_after(LAST - 5)


NUMBERS = {
    "late": late,
    "goes on": lambda one: float(late(one) > STILL * one.history.volume[-1]),
    "new strain": lambda one: one.of_cycles("new_strain_max")[-1],
}
FIRST = {
    f"{name} 1": lambda one, name=name: one.history.at(name, 1) for name in ("volume", "friction", "p_max")
}
"""Of a run that converged, and of its first cycle."""


class RunningInPhysics(Study):
    """All materials under every physics."""

    def scenes(self, context: Context) -> dict[Any, Scene]:
        printed = study.printed_scenes(context, EFFORT)
        return {(*each, case): under(scene, *each) for each in ALL for case, scene in printed.items()}

    def label(self, key: tuple[str, ...]) -> str:
        counter, *others = key
        return "-".join((COUNTERS[counter], *others)).replace(" ", "-")

    def solve(self, context: Context) -> DataFrame:
        return study.framed(self.runs(context), [*PARTS, "material"], NUMBERS | FIRST)

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        """first-cycle: of physics that differ only in what comes after it: against constant
        friction under a counter-surface that is not renewed between passes.
        """
        good, worst = found[found["converged"]].set_index([*PARTS, "material"])[[*FIRST]], 0.0
        for (counter, _, hardening, case), own in good.iterrows():
            base = MOVES if counter.startswith(MOVES[:5]) else counter, "constant", hardening, case
            if base in good.index:
                other = good.loc[base]
                worst = max(worst, float(((own - other).abs() / other.abs().replace(0.0, 1.0)).max()))
        return {
            "missing": Measured(len(ALL) * len(NAMES) - len(found), 0),
            "lost": Measured(1.0 - float(found["converged"].mean())),
            "first-cycle": Measured(worst),
        }

    def data(self, found: DataFrame) -> dict[str, Any]:
        said = verdicts(found)
        physics = [dict(zip(PARTS, each, strict=True)) | {"held": said[each].count(HELD)} for each in ALL]
        statements = [
            {"figure": each.figure, "statement": each.words, "verdicts": [said[one][k] for one in ALL]}
            for k, each in enumerate(STATEMENTS)
        ]
        return {"physics": physics, "statements": statements, "wear_goes_on": wear_goes_on(found)}

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        yield statements_table(found)
        yield wear_table(found)

    def notes(self, found: DataFrame) -> Iterator[str]:
        said = verdicts(found)
        most = max(each.count(HELD) for each in said.values())
        best = (
            f"{counter}, {sign} friction, {hardening}"
            for (counter, sign, hardening), each in said.items()
            if each.count(HELD) == most
        )
        yield f"{most} of {len(STATEMENTS)} statements hold together at most, under: {'; '.join(best)}."
        held = zip(STATEMENTS, zip(*said.values(), strict=True), strict=True)
        if never := [each.words for each, of in held if HELD not in of]:
            yield f"Under none of them holds: {'; '.join(never)}."
        on = wear_goes_on(found)
        own, of = map(sum, zip(*on.values(), strict=True))
        cells = "; ".join(f"{counter}: {k} of {n}" for counter, (k, n) in on.items())
        yield (
            f"Cycles {LAST - 4} to {LAST} add more than {100 * STILL:g} % to the worn volume, where "
            f"linear wear adds 20 %, in {own} of {of} runs ({cells})."
        )
        yield "One surface of a quarter of the printed area: this indicates, and gives no probability."

    def figures(self, found: DataFrame) -> Iterator[Plot]:
        runs = found[found["converged"]].set_index([*PARTS, "material"])["run"]
        panels = {
            (f"{NAMES[case]} [µm³]", counter): {
                (hardening, f"{sign} friction"): np.append(0.0, CUBIC * runs[key].history.volume)
                for hardening, sign in product(SHARES, SIGNS)
                if (key := (counter, sign, hardening, case)) in runs
            }
            for case, counter in product(DRAWN, COUNTERS)
        }
        yield Plot(
            over_cycles(panels, ("hardening", "friction")),
            "volume",
            "Worn volume over the cycles under each physics",
            "Worn volume over the cycles: a row of panels for each material, a column for each counter-body, "
            "a line for each hardening and sign of friction.",
            "Colours: how the body hardens. Linear wear would be a straight line; a line that ends flat has "
            "come to rest. Runs that did not converge have no line.",
        )


def verdicts(found: DataFrame) -> dict[tuple[str, str, str], list[str]]:
    """Physics -> the verdict of each statement on the one surface."""
    measures = study.measured(found, PARTS).reindex(ALL)
    return {each: [one["by_agreement"] for one in study.judged(measures.loc[[each]])] for each in ALL}


def wear_goes_on(found: DataFrame) -> dict[str, tuple[int, int]]:
    """Counter-body -> runs in which the last five cycles still wear, of how many."""
    own = found[found["converged"]].groupby("counter", sort=False)["goes on"]
    return {counter: (int(each.sum()), len(each)) for counter, each in own}


def statements_table(found: DataFrame) -> SmallTable:
    """Under which hardening each statement holds, for each counter-surface and sign of friction."""
    said, rows = verdicts(found), []
    for k, statement in enumerate(STATEMENTS):
        cells = []
        for column in COLUMNS:
            held, silent = (
                "".join(SHORT[h] for h in SHARES if said[*column, h][k] == verdict)
                for verdict in (HELD, OPEN)
            )
            cells.append(f"{held} ({silent})".strip() if silent else held or "none")
        rows.append((statement.figure, statement.words, *cells))
    held = (", ".join(str(said[*column, h].count(HELD)) for h in SHARES) for column in COLUMNS)
    rows.append(("", "statements that hold together", *held))
    return SmallTable(
        "Which statements of the paper hold under which physics. In a cell the hardening with which it does: "
        "I isotropic, H half and half, K kinematic; in brackets those with which it says nothing. Last row: "
        "how many hold with each",
        ("Fig.", "statement", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        rows,
    )


def wear_table(found: DataFrame) -> SmallTable:
    """Volume, what the last five cycles add to it, and the largest new strain of the last one."""
    cells = {
        (*where, case): f"{CUBIC * one.history.volume[-1]:.3g}, {CUBIC * added:.2g} ({100 * strain:.2g})"
        for *where, case, one, good, added, strain in found[
            [*PARTS, "material", "run", "converged", "late", "new strain"]
        ].itertuples(index=False)
        if good
    }
    return SmallTable(
        f"Volume worn in {LAST} cycles and, after a comma, in the last five [µm³]; in brackets the largest "
        "new plastic strain of the last cycle [%]",
        ("material", "hardening", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        [
            (NAMES[case], h, *(cells.get((*column, h, case), "not converged") for column in COLUMNS))
            for case, h in product(NAMES, SHARES)
        ],
    )


CASES = (RunningInPhysics("running-in-physics"),)
