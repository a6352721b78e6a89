# SPDX-License-Identifier: MIT
"""The same body under other physics: how it hardens, what presses on it from cycle to cycle, and whether
friction changes its sign; which statements of the paper hold in which of them.

Everything else has the printed inputs: materials, film, limits of strain and load. The patch has a quarter of
the area of the printed scenes, so that all combinations take minutes; one surface, so that nothing is said of
others.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from sam.scene import CounterSurface, Path, Scene
from verification.cases.case import (
    SAM,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_keys,
    with_loading,
)
from verification.cases.cyclic.running_in_kinematic import SHARES, hardened
from verification.cases.running_in.running_in import DeeperWhereItYields, solved
from verification.cases.running_in.running_in_runs import RunningInRun
from verification.cases.running_in.running_in_scenes import ROUGHNESS, Effort, deeper, reduced
from verification.cases.running_in.running_in_statements import (
    BULK,
    LAST,
    NAMES,
    STATEMENTS,
    STILL,
    A,
    B,
    JudgedStatement,
    Judgement,
    judge,
)
from verification.compare.running_in_measures import History
from verification.cost.estimates import estimate
from verification.figures.running_in_physics import volumes

EFFORT = Effort(tuple(NAMES), (), cycles=LAST, steps=3, cells=32)
SQ = 20e-9  # m: of the counter-surface, the geometric middle of the 5 to 60 nm of ground and polished discs
WAY, STEPS = (
    6e-6,
    6,
)  # m on either side of the middle; steps of 2 um, a sixth of the shortest wave of the disc


class Counter(StrEnum):
    """What presses on the body from cycle to cycle, in words."""

    SAME = "the same plane in place"
    RENEWED = "in place, rough, new in each cycle"
    MOVES = "moves, rough, the same in each pass"
    MOVES_RENEWED = "moves, rough, new in each pass"

    @property
    def rough(self) -> bool:
        """Whether it is no plane."""
        return self is not Counter.SAME

    @property
    def moves(self) -> bool:
        """Whether it slides over the body in each cycle."""
        return self in (Counter.MOVES, Counter.MOVES_RENEWED)


DRAWN = (BULK, A, B)
SIGNS = {"constant": False, "alternating": True}
"""Of friction from cycle to cycle -> whether it changes."""


def physics(scene: Scene, counter: Counter, alternates: bool, share: float) -> Scene:
    """A printed scene with a share of kinematic hardening below this counter-body."""
    scene = deeper(reduced(scene, EFFORT))
    body = scene.body.model_copy(update={"plasticity": hardened(scene.body.plasticity, share)})
    scene = scene.model_copy(update={"body": body})
    if counter.rough:
        renewed = counter in (Counter.RENEWED, Counter.MOVES_RENEWED)
        keys = {**ROUGHNESS, "sq": SQ, "seed": 1000 * scene.surface.seed + 1}
        surface = CounterSurface(kind="self-affine", **keys, renew=renewed)
        scene = with_keys(scene, "counterbody", surface=surface)
    if counter.moves:
        back = "to-and-fro" if alternates else "lifted"
        path = Path(start=(-WAY, 0.0), end=(WAY, 0.0), steps=STEPS, **{"return": back})
        return with_loading(scene, path=path, unload_steps=None)
    return with_keys(scene, "friction", direction="alternating") if alternates else scene


@dataclass(frozen=True)
class Physics:
    """One combination."""

    counter: Counter
    sign: str
    hardening: str

    @property
    def label(self) -> str:
        """For the names of runs."""
        counter = self.counter.name.lower().replace("_", "-")
        return f"{counter}-{self.sign}-{self.hardening.replace(' ', '-')}"

    def of(self, scene: Scene) -> Scene:
        """A printed scene under this physics."""
        return physics(scene, self.counter, SIGNS[self.sign], SHARES[self.hardening])


COLUMNS = tuple(itertools.product(Counter, SIGNS))
ALL = tuple(Physics(*column, hardening) for column in COLUMNS for hardening in SHARES)


@dataclass(frozen=True)
class Found:
    """runs: physics and material -> what ran; predicted_s: by the plan."""

    runs: Mapping[tuple[Physics, str], RunningInRun]
    predicted_s: float

    @cached_property
    def good(self) -> dict[tuple[Physics, str], RunningInRun]:
        """Those that converged."""
        return {key: one for key, one in self.runs.items() if one.result.converged}

    @cached_property
    def histories(self) -> dict[tuple[Physics, str], History]:
        """Those that converged, over their cycles."""
        return {key: one.history for key, one in self.good.items()}

    @cached_property
    def judged(self) -> dict[Physics, list[JudgedStatement]]:
        """The statements under each physics, on the one surface."""
        return {each: [judge(statement, [self.of(each)]) for statement in STATEMENTS] for each in ALL}

    def of(self, physics: Physics) -> dict[str, History]:
        """The materials under a physics that converged."""
        return {case: self.histories[physics, case] for case in NAMES if (physics, case) in self.histories}

    def held(self, physics: Physics) -> int:
        """How many statements hold under a physics."""
        return sum(each.judgement is Judgement.HELD for each in self.judged[physics])


def late(history: History) -> float:
    """Wear of the last five cycles in m3."""
    return history.volume_after(LAST) - history.volume_after(LAST - 5)


def first_cycles(found: Found) -> float:
    """Largest relative difference of volume, friction or largest pressure in the first cycle between physics
    that differ only in what comes after it.
    """
    worst = 0.0
    for (each, case), history in found.histories.items():
        counter = Counter.MOVES if each.counter.moves else each.counter
        other = found.histories.get((Physics(counter, "constant", each.hardening), case))
        if other is not None:
            pairs = ((history.at(name, 1), other.at(name, 1)) for name in ("volume", "friction", "p_max"))
            worst = max(worst, *(abs(one - two) / (abs(two) or 1.0) for one, two in pairs))
    return worst


class RunningInPhysics(DeeperWhereItYields):
    """All materials under every physics."""

    def ahead(self, context: Context) -> Iterator[Scene]:
        yield from scenes_of(context).values()

    def solve(self, context: Context) -> Found:
        scenes = scenes_of(context)
        predicted = sum(estimate(scene, SAM).time_s for scene in scenes.values())
        runs = {
            (each, case): solved(context, scene, f"{each.label}-{case}")
            for (each, case), scene in scenes.items()
        }
        return Found(runs, predicted)

    def measure(self, found: Found) -> dict[str, Measured]:
        lost = len(found.runs) - len(found.good)
        return {
            "missing": Measured(len(ALL) * len(NAMES) - len(found.runs), 0),
            "lost": Measured(lost / len(found.runs)),
            "first-cycle": Measured(first_cycles(found)),
        }

    def setup(self, found: Found) -> list[tuple[str, str]]:
        took = sum(one.result.cost["cpu_s"] for one in found.runs.values())
        cells = f"{EFFORT.cells} × {EFFORT.cells} cells of 1 µm"
        each = f"{cells}, {EFFORT.cycles} cycles, {EFFORT.steps} load steps"
        return [
            ("Runs", f"{len(ALL)} physics, {len(NAMES)} materials: {len(found.runs)} runs of {each}"),
            ("Hardening", f"{', '.join(SHARES)}: one curve of first loading, as in running-in-kinematic"),
            ("Counter-surface", "; ".join(Counter)),
            ("Its roughness", f"{1e9 * SQ:g} nm rms, waves of 12 to 32 µm"),
            ("Way of a pass", f"{2e6 * WAY:g} µm in {STEPS} steps; with alternating friction to and fro"),
            ("Processor time", f"{took / 60:.0f} min, predicted {found.predicted_s / 60:.0f} min"),
            ("Without a converged result", f"{len(found.runs) - len(found.good)} runs"),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        yield statements_table(found)
        yield wear_table(found)

    def notes(self, found: Found) -> Iterator[str]:
        counts = {each: found.held(each) for each in ALL}
        most = max(counts.values())
        best = "; ".join(words(each) for each, count in counts.items() if count == most)
        yield f"{most} of {len(STATEMENTS)} statements hold together at most, under: {best}."
        never = [
            statement.words
            for k, statement in enumerate(STATEMENTS)
            if not any(found.judged[each][k].judgement is Judgement.HELD for each in ALL)
        ]
        if never:
            yield f"Under none of them holds: {'; '.join(never)}."
        yield still_wear(found)
        yield "One surface of a quarter of the printed area: this indicates, and gives no probability."

    def figures(self, found: Found) -> Iterator[Plot]:
        panels = {
            (NAMES[case], str(counter)): {
                (hardening, sign): 1e18 * history.volume
                for hardening, sign in itertools.product(SHARES, SIGNS)
                if (history := found.histories.get((Physics(counter, sign, hardening), case))) is not None
            }
            for case, counter in itertools.product(DRAWN, Counter)
        }
        yield Plot(
            volumes(panels),
            "volume",
            "Worn volume over the cycles under each physics",
            "Worn volume over the cycles: a row of panels for each material, a column for each counter-body, "
            "a line for each hardening and sign of friction.",
            "Colours: how the body hardens. Linear wear would be a straight line; a line that ends flat has "
            "come to rest. Runs that did not converge have no line.",
        )


def still_wear(found: Found) -> str:
    """In how many runs wear goes on, for each counter-body."""
    own = {
        counter: [
            goes_on(history) for (each, _), history in found.histories.items() if each.counter is counter
        ]
        for counter in Counter
    }
    cells = "; ".join(f"{counter}: {sum(each)} of {len(each)}" for counter, each in own.items())
    on, runs = sum(map(sum, own.values())), len(found.good)
    return (
        f"Cycles {LAST - 4} to {LAST} add more than {100 * STILL:g} % to the worn volume, where linear "
        f"wear adds 20 %, in {on} of {runs} runs ({cells})."
    )


def goes_on(history: History) -> bool:
    """Whether the last five cycles still wear."""
    return late(history) > STILL * history.volume[-1]


def words(physics: Physics) -> str:
    """A physics for the reader."""
    return f"{physics.counter}, {physics.sign} friction, {physics.hardening}"


def statements_table(found: Found) -> SmallTable:
    """Under which hardening each statement holds, for each counter-surface and sign of friction."""
    rows = []
    for k, statement in enumerate(STATEMENTS):
        cells = (_holds([(h, found.judged[Physics(*column, h)][k]) for h in SHARES]) for column in COLUMNS)
        rows.append((statement.figure, statement.words, *cells))
    held = (", ".join(str(found.held(Physics(*column, h))) for h in SHARES) for column in COLUMNS)
    rows.append(("", "statements that hold together", *held))
    return SmallTable(
        "Which statements of the paper hold under which physics. In a cell the hardening with which it does: "
        "I isotropic, H half and half, K kinematic; in brackets those with which it says nothing. Last row: "
        "how many hold with each",
        ("Fig.", "statement", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        rows,
    )


def _holds(of: Sequence[tuple[str, JudgedStatement]]) -> str:
    held = "".join(SHORT[name] for name, each in of if each.judgement is Judgement.HELD)
    silent = "".join(SHORT[name] for name, each in of if each.judgement is Judgement.OPEN)
    return f"{held} ({silent})".strip() if silent else held or "none"


def wear_table(found: Found) -> SmallTable:
    """Volume, what the last five cycles add to it, and the largest new strain of the last one."""
    rows = []
    for case, hardening in itertools.product(NAMES, SHARES):
        cells = []
        for column in COLUMNS:
            one = found.good.get((Physics(*column, hardening), case))
            cells.append("not converged" if one is None else _worn(one))
        rows.append((NAMES[case], hardening, *cells))
    return SmallTable(
        f"Volume worn in {LAST} cycles and, after a comma, in the last five [µm³]; in brackets the largest "
        "new plastic strain of the last cycle [%]",
        ("material", "hardening", *(f"{counter}; {sign}" for counter, sign in COLUMNS)),
        rows,
    )


def _worn(one: RunningInRun) -> str:
    history, strain = one.history, one.of_cycles("new_strain_max")[-1]
    return f"{1e18 * history.volume[-1]:.3g}, {1e18 * late(history):.2g} ({100 * strain:.2g})"


def scenes_of(context: Context) -> dict[tuple[Physics, str], Scene]:
    """The scene of each physics and material."""
    printed = {case: context.scene(f"running-in-{case}") for case in NAMES}
    return {(each, case): each.of(printed[case]) for each in ALL for case in NAMES}


SHORT = {"isotropic": "I", "half and half": "H", "kinematic": "K"}
CASES = (RunningInPhysics("running-in-physics"),)
