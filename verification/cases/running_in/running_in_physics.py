# SPDX-License-Identifier: MIT
"""The same body under other physics: how it hardens, what presses on it from cycle to cycle, and whether
friction changes its sign. Everything else is as printed, on a quarter of the area and on one surface, so that
nothing is said of others.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from sam.scene import Path, Scene
from verification.cases.case import Context, DataFrame, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.running_in import study
from verification.cases.running_in.study import (
    BULK,
    CUBIC,
    HELD,
    LAST,
    NAMES,
    SHARES,
    STATEMENTS,
    STILL,
    A,
    B,
    Effort,
    Reading,
    Readings,
    Run,
    readings_of,
)
from verification.figures.lines import over_cycles

EFFORT = Effort(LAST, steps=3, cells=32)
SQ = 20e-9  # m: of the counter-surface, the geometric middle of the 5 to 60 nm of ground and polished discs
WAY, STEPS = 6e-6, 6  # m on either side of the middle; 2 um, a sixth of the shortest wave of the disc
DRAWN = (BULK, A, B)
AGAIN = "half and half"  # the way to harden whose DRAWN runs, 24, are solved again beside a campaign
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
ALL = {
    f"{counter}; {sign} friction; {hardening}": (counter, sign, hardening)
    for counter, sign, hardening in product(COUNTERS, SIGNS, SHARES)
}
"""Physics as it is named -> its counter-body, sign of friction and hardening."""


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


FIRST = {
    f"{name} 1": lambda one, name=name: one.history.at(name, 1) for name in ("volume", "friction", "p_max")
}
"""Of the first cycle of a run that converged."""


class RunningInPhysics(Readings):
    """All materials under every physics, which stand for readings."""

    numbers = FIRST | {"goes on": lambda one: float(late(one) > STILL * one.history.volume[-1])}

    def readings(self, context: Context) -> dict[str, Reading]:
        return {
            name: Reading(
                "-".join((COUNTERS[counter], *others, "")).replace(" ", "-"),
                EFFORT,
                partial(under, counter=counter, sign=others[0], hardening=others[1]),
            )
            for name, (counter, *others) in ALL.items()
        }

    def solved_again(self, reading: Any, material: str, surface: int) -> bool:
        return ALL[reading][-1] == AGAIN and material in DRAWN

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        """first-cycle: of physics that differ only in what comes after it: against constant
        friction under a counter-surface that is not renewed between passes; of runs that are solved, as a
        campaign keeps six digits.
        """
        good = found.loc[study.solved_of(found).index].set_index(["reading", "material"])[[*FIRST]]
        worst = 0.0
        for (name, case), own in good.iterrows():
            counter, _, hardening = ALL[name]
            base = MOVES if counter.startswith(MOVES[:5]) else counter
            if (key := (f"{base}; constant friction; {hardening}", case)) in good.index:
                other = good.loc[key]
                worst = max(worst, float(((own - other).abs() / other.abs().replace(0.0, 1.0)).max()))
        return {
            "missing": Measured(len(ALL) * len(NAMES) - len(found), 0),
            "first-cycle": Measured(worst),
        } | super().measure(found)

    def data(self, found: DataFrame) -> dict[str, Any]:
        said = {name: [one["by_agreement"] for one in each] for name, each in readings_of(found).items()}
        statements = [
            {"figure": each.figure, "statement": each.words, "verdicts": list(verdicts)}
            for each, verdicts in zip(STATEMENTS, zip(*said.values(), strict=True), strict=True)
        ]
        return {"held": [each.count(HELD) for each in said.values()], "statements": statements}

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        yield from study.together(readings_of(found))

    def notes(self, found: DataFrame) -> Iterator[str]:
        yield from self.told_of_campaign(found)
        on = wear_goes_on(found)
        own, of = map(sum, zip(*on.values(), strict=True))
        cells = "; ".join(f"{counter}: {k} of {n}" for counter, (k, n) in on.items())
        yield (
            f"Cycles {LAST - 4} to {LAST} add more than {100 * STILL:g} % to the worn volume, where "
            f"linear wear adds 20 %, in {own} of {of} runs ({cells})."
        )
        yield "One surface of a quarter of the printed area: this indicates, and gives no probability."

    def figures(self, found: DataFrame) -> Iterator[Plot]:
        panels: dict[tuple[str, str], dict[tuple[str, str], np.ndarray]] = {
            (f"{NAMES[case]} [µm³]", counter): {} for case, counter in product(DRAWN, COUNTERS)
        }
        good = found[found["converged"] & found["material"].isin(DRAWN)]
        for name, case, one in good[["reading", "material", "run"]].itertuples(index=False):
            counter, sign, hardening = ALL[name]
            line = np.append(0.0, CUBIC * one.history.volume)
            panels[f"{NAMES[case]} [µm³]", counter][hardening, f"{sign} friction"] = line
        yield Plot(
            over_cycles(panels, ("hardening", "friction")),
            "volume",
            "Worn volume over the cycles under each physics",
            "The figure compares the worn volume by how the body hardens, by the counter-body and by the "
            "sign of friction. Linear wear would be a straight line; a line that ends flat has come to "
            "rest. Runs that did not converge have no line.",
        )


def wear_goes_on(found: DataFrame) -> dict[str, tuple[int, int]]:
    """Counter-body -> runs in which the last five cycles still wear, of how many."""
    own = found[found["converged"]]
    groups = own["goes on"].groupby(own["reading"].map(lambda name: ALL[name][0]), sort=False)
    return {counter: (int(each.sum()), len(each)) for counter, each in groups}


CASES = (RunningInPhysics("running-in-physics"),)
