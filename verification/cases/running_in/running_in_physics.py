# SPDX-License-Identifier: MIT
"""The same body under other physics: how it hardens, what presses on it from cycle to cycle, and whether
friction changes its sign; which statements of the paper hold in which of them.

Everything else has the printed inputs: materials, film, limits of strain and load. The patch has a quarter of
the area of the printed scenes, so that all combinations take minutes; one surface, so that nothing is said of
others.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sam.scene import Path, Scene
from verification.cases.case import SAM, Context, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.running_in.scenes import (
    BULK,
    LAST,
    NAMES,
    SHARES,
    A,
    B,
    Effort,
    deeper,
    hardened,
    printed_scenes,
    with_counter,
)
from verification.cases.running_in.study import STATEMENTS, STILL, Judged, Judgement, Run, Study, good, judged
from verification.compare.running_in_measures import History
from verification.cost.estimates import estimate
from verification.figures.lines import over_cycles

EFFORT = Effort(LAST, steps=3, cells=32)
SQ = 20e-9  # m: of the counter-surface, the geometric middle of the 5 to 60 nm of ground and polished discs
WAY, STEPS = (
    6e-6,
    6,
)  # m on either side of the middle; steps of 2 um, a sixth of the shortest wave of the disc
DRAWN = (BULK, A, B)
SIGNS = ("constant", "alternating")
"""Of friction from cycle to cycle."""
SHORT = {"isotropic": "I", "half and half": "H", "kinematic": "K"}


class Counter(StrEnum):
    """What presses on the body from cycle to cycle, in words."""

    SAME = "the same plane in place"
    RENEWED = "in place, rough, new in each cycle"
    MOVES = "moves, rough, the same in each pass"
    MOVES_RENEWED = "moves, rough, new in each pass"

    @property
    def moves(self) -> bool:
        """Whether it slides over the body in each cycle."""
        return self in (Counter.MOVES, Counter.MOVES_RENEWED)


class Physics(NamedTuple):
    """One combination."""

    counter: Counter
    sign: str
    hardening: str

    @property
    def words(self) -> str:
        """For the reader."""
        return f"{self.counter}, {self.sign} friction, {self.hardening}"

    def of(self, scene: Scene) -> Scene:
        """A printed scene under this physics."""
        scene = hardened(deeper(scene), SHARES[self.hardening])
        alternates = self.sign == "alternating"
        if self.counter is not Counter.SAME:
            scene = with_counter(scene, SQ, renew=self.counter is not Counter.MOVES)
        if self.counter.moves:
            back = "to-and-fro" if alternates else "lifted"
            path = Path(start=(-WAY, 0.0), end=(WAY, 0.0), steps=STEPS, **{"return": back})
            return with_loading(scene, path=path, unload_steps=None)
        return with_keys(scene, "friction", direction="alternating") if alternates else scene


COLUMNS = tuple(itertools.product(Counter, SIGNS))
ALL = tuple(Physics(*column, hardening) for column in COLUMNS for hardening in SHARES)


@dataclass(frozen=True)
class Found:
    """runs: physics and material -> what ran; predicted_s: by the plan."""

    runs: Mapping[tuple[Physics, str], Run]
    predicted_s: float

    @cached_property
    def histories(self) -> dict[tuple[Physics, str], History]:
        """Those that converged, over their cycles."""
        return {key: one.history for key, one in good(self.runs).items()}

    @cached_property
    def judged(self) -> dict[Physics, list[Judged]]:
        """The statements under each physics, on the one surface."""
        every = self.histories.items()
        return {
            physics: judged([{case: own for (of, case), own in every if of == physics}]) for physics in ALL
        }

    def held(self, physics: Physics) -> int:
        """How many statements hold under a physics."""
        return sum(each.agreed is Judgement.HELD for each in self.judged[physics])


def late(history: History) -> float:
    """Wear of the last five cycles in m3."""
    return history.volume_after(LAST) - history.volume_after(LAST - 5)


def goes_on(history: History) -> bool:
    """Whether the last five cycles still wear."""
    return late(history) > STILL * history.volume[-1]


def first_cycles(found: Found) -> float:
    """Largest relative difference of volume, friction or largest pressure in the first cycle between physics
    that differ only in what comes after it.
    """
    worst = 0.0
    for (each, case), history in found.histories.items():
        counter = Counter.MOVES if each.counter.moves else each.counter
        if other := found.histories.get((Physics(counter, "constant", each.hardening), case)):
            pairs = ((history.at(name, 1), other.at(name, 1)) for name in ("volume", "friction", "p_max"))
            worst = max(worst, *(abs(one - two) / (abs(two) or 1.0) for one, two in pairs))
    return worst


class RunningInPhysics(Study):
    """All materials under every physics."""

    def scenes(self, context: Context) -> dict[Any, Scene]:
        printed = printed_scenes(context, EFFORT)
        return {(each, case): each.of(scene) for each in ALL for case, scene in printed.items()}

    def label(self, key: tuple[Physics, str]) -> str:
        (counter, sign, hardening), case = key
        return f"{counter.name.lower()}-{sign}-{hardening}-{case}".replace("_", "-").replace(" ", "-")

    def solve(self, context: Context) -> Found:
        predicted = sum(estimate(scene, SAM).time_s for scene in self.scenes(context).values())
        return Found(self.runs(context), predicted)

    def measure(self, found: Found) -> dict[str, Measured]:
        return {
            "missing": Measured(len(ALL) * len(NAMES) - len(found.runs), 0),
            "lost": Measured((len(found.runs) - len(found.histories)) / len(found.runs)),
            "first-cycle": Measured(first_cycles(found)),
        }

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        each = f"{EFFORT.cells} × {EFFORT.cells} cells of 1 µm, {LAST} cycles, {EFFORT.steps} load steps"
        yield "Runs", f"{len(ALL)} physics, {len(NAMES)} materials: {len(found.runs)} runs of {each}"
        yield "Hardening", f"{', '.join(SHARES)}: one curve of first loading, as in running-in-kinematic"
        yield "Counter-surface", "; ".join(Counter)
        yield "Its roughness", f"{1e9 * SQ:g} nm rms, waves of 12 to 32 µm"
        yield "Way of a pass", f"{2e6 * WAY:g} µm in {STEPS} steps; with alternating friction to and fro"
        took = sum(one.result.cost["cpu_s"] for one in found.runs.values())
        yield "Processor time", f"{took / 60:.0f} min, predicted {found.predicted_s / 60:.0f} min"
        yield "Without a converged result", f"{len(found.runs) - len(found.histories)} runs"

    def data(self, found: Found) -> dict[str, Any]:
        physics = [
            {"counter": a, "sign": b, "hardening": c, "held": found.held(Physics(a, b, c))} for a, b, c in ALL
        ]
        statements = [
            {
                "figure": said.figure,
                "statement": said.words,
                "verdicts": [found.judged[each][k].agreed for each in ALL],
            }
            for k, said in enumerate(STATEMENTS)
        ]
        return {"physics": physics, "statements": statements, "wear_goes_on": wear_goes_on(found)}

    def tables(self, found: Found) -> Iterator[SmallTable]:
        yield statements_table(found)
        yield wear_table(found)

    def notes(self, found: Found) -> Iterator[str]:
        counts = {each: found.held(each) for each in ALL}
        most = max(counts.values())
        best = "; ".join(each.words for each, count in counts.items() if count == most)
        yield f"{most} of {len(STATEMENTS)} statements hold together at most, under: {best}."
        every = zip(*found.judged.values(), strict=True)
        never = [of[0].statement.words for of in every if all(one.agreed is not Judgement.HELD for one in of)]
        if never:
            yield f"Under none of them holds: {'; '.join(never)}."
        on = wear_goes_on(found)
        cells = "; ".join(f"{counter}: {own} of {of}" for counter, (own, of) in on.items())
        yield (
            f"Cycles {LAST - 4} to {LAST} add more than {100 * STILL:g} % to the worn volume, where "
            f"linear wear adds 20 %, in {sum(own for own, _ in on.values())} of {len(found.histories)} runs "
            f"({cells})."
        )
        yield "One surface of a quarter of the printed area: this indicates, and gives no probability."

    def figures(self, found: Found) -> Iterator[Plot]:
        panels = {
            (f"{NAMES[case]} [µm³]", str(counter)): {
                (hardening, f"{sign} friction"): np.append(0.0, 1e18 * history.volume)
                for hardening, sign in itertools.product(SHARES, SIGNS)
                if (history := found.histories.get((Physics(counter, sign, hardening), case)))
            }
            for case, counter in itertools.product(DRAWN, Counter)
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


def wear_goes_on(found: Found) -> dict[Counter, tuple[int, int]]:
    """Counter-body -> runs in which the last five cycles still wear, of how many."""
    own = {c: [goes_on(h) for (of, _), h in found.histories.items() if of.counter is c] for c in Counter}
    return {counter: (sum(each), len(each)) for counter, each in own.items()}


def statements_table(found: Found) -> SmallTable:
    """Under which hardening each statement holds, for each counter-surface and sign of friction."""

    def letters(column: tuple, k: int, verdict: Judgement) -> str:
        return "".join(SHORT[h] for h in SHARES if found.judged[Physics(*column, h)][k].agreed is verdict)

    rows = []
    for k, statement in enumerate(STATEMENTS):
        cells = [
            (letters(column, k, Judgement.HELD), letters(column, k, Judgement.OPEN)) for column in COLUMNS
        ]
        words = (f"{held} ({silent})".strip() if silent else held or "none" for held, silent in cells)
        rows.append((statement.figure, statement.words, *words))
    held = (", ".join(str(found.held(Physics(*column, h))) for h in SHARES) for column in COLUMNS)
    rows.append(("", "statements that hold together", *held))
    return SmallTable(
        "Which statements of the paper hold under which physics. In a cell the hardening with which it does: "
        "I isotropic, H half and half, K kinematic; in brackets those with which it says nothing. Last row: "
        "how many hold with each",
        ("Fig.", "statement", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        rows,
    )


def wear_table(found: Found) -> SmallTable:
    """Volume, what the last five cycles add to it, and the largest new strain of the last one."""

    def cell(physics: Physics, case: str) -> str:
        if not (history := found.histories.get((physics, case))):
            return "not converged"
        strain = 100 * found.runs[physics, case].of_cycles("new_strain_max")[-1]
        return f"{1e18 * history.volume[-1]:.3g}, {1e18 * late(history):.2g} ({strain:.2g})"

    return SmallTable(
        f"Volume worn in {LAST} cycles and, after a comma, in the last five [µm³]; in brackets the largest "
        "new plastic strain of the last cycle [%]",
        ("material", "hardening", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        [
            (NAMES[case], h, *(cell(Physics(*column, h), case) for column in COLUMNS))
            for case, h in itertools.product(NAMES, SHARES)
        ],
    )


CASES = (RunningInPhysics("running-in-physics"),)
