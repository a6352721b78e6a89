# SPDX-License-Identifier: MIT
"""Which of the inputs that the paper leaves open decide its statements on running-in. Each is drawn evenly
over the range that paper and literature allow, each point on another surface: shares of the points at which a
statement holds are probabilities over these ranges. The points at which most statements hold are chosen by
their result, so that they are fitted; what they would mean is said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest, norm

from sam.scene import Scene
from verification.cases.case import Context, DataFrame, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.running_in import study
from verification.cases.running_in.study import (
    BULK,
    DEEPER,
    LAST,
    NAMES,
    STATEMENTS,
    A,
    B,
    Effort,
    Reading,
    Readings,
)
from verification.figures.specials import probabilities
from verification.sensitivity import UNIFORM, design

SURFACES = 100  # seeds of surfaces count from here, and are no others'
EFFORTS = {"quick": (4, Effort(2, 2, 24, (BULK, A))), "full": (32, Effort(LAST, 3, 64))}
"""Points, and what is run at each: the whole patch, since on a quarter of it most surfaces do not wear at
all."""
SEED = 26  # of the design
CHANCE = 1e-3  # of each of 17 × 16 changes of probability: less than one of them is named by chance
DECIDING = 2  # inputs named for each statement
LAYER_LIMIT = 0.02  # of the layers of the printed scenes; curve B with 5 % keeps its 2.5 times as much
SMOOTH = 0.5e-9  # m: below it the counter-surface is a plane
NOMINAL = 1e-6  # m: printed thickness of the layer
TABOR, STRAIN = (2.8, 3.0), 0.08  # hardness over yield stress at STRAIN: Tabor, The Hardness of Metals (1951)
STEEL = "6.8 to 8.2 GPa of AISI 52100 hardened through (60 to 65 HRC, 697 to 832 HV by ASTM E140)"
DISCS = "5 to 60 nm of polished to ground discs"
BEST = 3  # points that are shown
AGAIN = 1  # points that are solved again beside a campaign: 5 of 160 runs
MATERIALS = (BULK, A, B)


class Input(NamedTuple):
    """An input between two ends, which are SI, drawn evenly in its value, its logarithm or its
    LEVELS; printed: in the scenes, where the paper does not print it what they assume; words,
    factor: for the reader; key: of the scene, else `put` by one of CHANGES.
    """

    name: str
    words: str
    low: float
    high: float
    printed: float
    factor: float
    even: str
    key: str

    def value(self, share: float) -> float:
        """At a share (0 to 1) of the way from one end to the other."""
        if self.even == "level":
            return LEVELS[min(int(share * len(LEVELS)), len(LEVELS) - 1)]
        if self.even == "logarithm":
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def shown(self, share: float) -> str:
        """For the reader."""
        return f"{self.factor * self.value(share):.3g}"

    @property
    def share(self) -> float:
        """Of the printed value; of a level the middle of its part."""
        if self.even == "level":
            return (LEVELS.index(int(self.printed)) + 0.5) / len(LEVELS)
        ends = self.low, self.high, self.printed
        low, high, at = np.log(ends) if self.even == "logarithm" else ends
        return float((at - low) / (high - low))

    def put(self, scene: Scene, value: float) -> Scene:
        """The scene with a value of it."""
        section, _, key = self.key.partition(".")
        return with_keys(scene, section, **{key: value}) if key else CHANGES[section](scene, value)


def layer_depth(scene: Scene, thickness: float) -> Scene:
    """The profile over depth, and the layer if there is one, so much thinner."""
    plasticity, share = scene.body.plasticity, thickness / NOMINAL
    if plasticity.profile is None:
        return scene
    keys = {"profile": tuple((share * z, factor) for z, factor in plasticity.profile)}
    if plasticity.layer_thickness is not None:
        keys["layer_thickness"] = share * plasticity.layer_thickness
    return study.with_plasticity(scene, **keys)


def layer_limit(scene: Scene, limit: float) -> Scene:
    """The limit of a layer, if there is one, its multiple of the printed 2 %."""
    if (printed := scene.wear.strain_limit_layer) is None:
        return scene
    return with_keys(scene, "wear", strain_limit_layer=limit * printed / LAYER_LIMIT)


CHANGES: Mapping[str, Callable[[Scene, float], Scene]] = {
    "constant": study.with_constant,
    "depth": layer_depth,
    "deviation": study.with_deviation,
    "alpha": study.with_layer_alpha,
    "limit": layer_limit,
    "load": lambda scene, force: with_loading(scene, force=force * scene.loading.force / 0.6),
    "counter": lambda scene, sq: scene if sq < SMOOTH else study.with_counter(scene, sq),
}
LEVELS = (0, 3, 5, 7, 9)  # cells
TABLE = """\
feed | share of the feed in Ra | 0.2 | 0.6 | 0.4 | 1 | value | surface.feed_share
shortest | shortest wave [µm] | 8e-6 | 20e-6 | 12e-6 | 1e6 | value | surface.cutoff_short
hurst | Hurst exponent | 0.6 | 0.95 | 0.8 | 1 | value | surface.hurst
anisotropy | anisotropy | 1 | 3 | 1.5 | 1 | value | surface.anisotropy
B | B of Swift's law [MPa] | 1280e6 | 1780e6 | 1780e6 | 1e-6 | value | constant
depth | depth of the layer [µm] | 0.3e-6 | 1e-6 | 1e-6 | 1e6 | value | depth
deviation | deviation of the layer, factor | 0.8 | 1.4 | 1 | 1 | value | deviation
hardening | hardening α of the layer | 1e1 | 1e6 | 1e6 | 1 | logarithm | alpha
limit | strain limit of the bulk [%] | 0.001 | 0.004 | 0.002 | 1e2 | logarithm | wear.strain_limit
layer-limit | strain limit of the layer [%] | 0.01 | 0.05 | 0.02 | 1e2 | logarithm | limit
growth | growth of the film [nm/√s] | 1.8e-9 | 7.3e-9 | 3.644e-9 | 1e9 | value | friction.growth_coefficient
film-yield | yield stress of the film [GPa] | 0.55e9 | 0.8e9 | 0.6667e9 | 1e-9 | value | friction.film_yield
high | friction of the failed film | 0.2 | 0.4 | 0.4 | 1 | value | friction.high
load | load [N] | 0.3 | 1.2 | 0.6 | 1 | logarithm | load
counter | roughness of the counter-surface [nm rms] | 0 | 30e-9 | 0 | 1e9 | value | counter
window | window of smoothing [cells] | 0 | 9 | 5 | 1 | level | wear.smoothing_window
"""
"""The fields of each input, in the order in which they are put: a layer takes the body's constants."""
INPUTS = tuple(
    Input(name, words, *map(float, numbers), even, key)
    for name, words, *numbers, even, key in study.parts_of(TABLE)
)
PRINTED = np.array([each.share for each in INPUTS])
"""(inputs,) shares of the printed inputs."""
LOW, HIGH = np.zeros(len(INPUTS)), np.ones(len(INPUTS))


def scene_at(scene: Scene, shares: Sequence[float]) -> Scene:
    """The scene of a material with every input at its share."""
    for each, share in zip(INPUTS, shares, strict=True):
        scene = each.put(scene, each.value(float(share)))
    while (
        scene.loading.force * (64e-6 / scene.grid.extent[0]) ** 2 > 0.7
        and scene.grid.depths[-1] < DEEPER[0][1]
    ):
        scene = study.deeper(scene)
    return scene


def wilson(held: int, of: int, level: float = 0.9) -> tuple[float, float]:
    """Bounds of a probability of which `held` of `of` draws are known: Wilson (1927)."""
    if not of:
        return 0.0, 1.0
    found = binomtest(held, of).proportion_ci(level, method="wilson")
    return float(found.low), float(found.high)


def deciders(shares: np.ndarray, held: np.ndarray) -> list[dict[str, Any]]:
    """The inputs that decide a statement beyond chance, the first most. held: (points,), NaN: says nothing.
    change: how much more often it holds in the upper half of an input's range than in the lower one, with
    bounds of 90 %.
    """
    says, found = np.isfinite(held), []
    for share, one in zip(shares.T[:, says], INPUTS, strict=True):
        high, low = held[says][share >= 0.5], held[says][share < 0.5]
        if high.size and low.size:
            least, most = change_between(high, low, 1.0 - CHANCE)
            if least > 0.0 or most < 0.0:
                bounds, change = change_between(high, low, 0.9), float(high.mean() - low.mean())
                found.append({"input": one.words, "change": change, "bounds": bounds})
    return sorted(found, key=lambda each: -abs(each["change"]))


def change_between(high: np.ndarray, low: np.ndarray, level: float) -> tuple[float, float]:
    """Bounds of the difference of two probabilities: Newcombe, Stat. Med. 17 (1998) 873."""
    ends = [(part.mean(), *wilson(int(part.sum()), part.size, level)) for part in (high, low)]
    (p, p_low, p_high), (q, q_low, q_high) = ends
    bounds = p - q - np.hypot(p - p_low, q_high - q), p - q + np.hypot(p_high - p, q - q_low)
    return float(bounds[0]), float(bounds[1])


def least_change(points: int) -> float:
    """Smallest change of a probability near a half beyond CHANCE, between halves of a range."""
    return float(norm.isf(CHANCE / 2.0) * np.sqrt(2.0 * 0.25 / (points / 2.0)))


@dataclass(frozen=True)
class Studied:
    """frame: of all runs, a reading is the number of a point; shares: of the inputs, (points, inputs)."""

    frame: DataFrame
    shares: np.ndarray

    @cached_property
    def held(self) -> np.ndarray:
        """Whether a statement holds, (statements, points); NaN where it says nothing there."""
        measures = study.measured(self.frame, ["reading"]).reindex(range(len(self.shares)))
        holds = [[each.holds(value) for value in measures[each.words]] for each in STATEMENTS]
        return np.where(np.isnan(measures.to_numpy().T), np.nan, holds)

    @cached_property
    def chances(self) -> list[dict[str, Any]]:
        """Of each statement: points at which it holds, of how many, bounds of the share, deciding inputs."""
        found = []
        for said, row in zip(STATEMENTS, self.held, strict=True):
            holds, of, words = int(np.nansum(row)), int(np.isfinite(row).sum()), []
            acting = deciders(self.shares, row)[:DECIDING]
            for each in acting:
                low, high = (f"{100 * end:+.0f}" for end in each["bounds"])
                words.append(f"{each['input']}: {100 * each['change']:+.0f} % ({low} to {high})")
            chance = {"figure": said.figure, "statement": said.words, "holds": holds, "of": of}
            found.append(chance | {"bounds": wilson(holds, of), "deciders": acting, "words": words})
        return found

    @property
    def judged(self) -> bool:
        """Whether there are as many cycles as the statements ask for."""
        return self.frame["run"].iloc[0].scene.loading.cycles >= LAST

    @property
    def effort(self) -> Effort:
        """What was run at each point."""
        return EFFORTS["full" if self.judged else "quick"][1]

    @property
    def counts(self) -> np.ndarray:
        """Statements that hold together at a point, (points,)."""
        return np.nansum(self.held, axis=0).astype(int)

    @property
    def away(self) -> np.ndarray:
        """(points,) from the printed inputs: root mean square of the shares of the ranges."""
        return np.sqrt(np.mean((self.shares - PRINTED) ** 2, axis=1))

    @property
    def best(self) -> list[int]:
        """The points at which most hold, the nearest to the printed inputs first."""
        most = np.flatnonzero(self.counts == self.counts.max())
        return [int(point) for point in most[np.argsort(self.away[most], kind="stable")]][:BEST]


class RunningInSensitivity(Readings):
    """All materials at every point of the design, which stand for readings, each on a surface of its own."""

    def readings(self, context: Context) -> dict[int, Reading]:
        points, effort = EFFORTS[context.level]
        return {
            k: Reading(
                f"point-{k:03}-", replace(effort, seeds=(SURFACES + k,)), partial(scene_at, shares=shares)
            )
            for k, shares in enumerate(design(UNIFORM, len(INPUTS), points, SEED))
        }

    def solved_again(self, reading: Any, material: str, surface: int) -> bool:
        return reading < AGAIN

    def solve(self, context: Context) -> Studied:
        points, _ = EFFORTS[context.level]
        return Studied(super().solve(context), design(UNIFORM, len(INPUTS), points, SEED))

    def measure(self, found: Studied) -> dict[str, Measured]:
        every = len(found.shares) * len(found.effort.cases)
        return {"missing": Measured(every - len(found.frame), 0)} | super().measure(found.frame)

    def setup(self, found: Studied) -> Iterator[tuple[str, str]]:
        points, effort = len(found.shares), found.effort
        size = f"{points} points, {len(effort.cases)} materials: {len(found.frame)} runs"
        yield (
            "Runs",
            f"{size} of {effort.cells} × {effort.cells} cells of 1 µm, {effort.cycles} cycles, "
            f"{effort.steps} load steps",
        )
        yield "Inputs", "uniform and independent over their ranges, each point on another surface"
        half = 50 * np.diff(wilson(points // 2, points))[0]
        yield "Sampling error of a share of points", f"±{half:.0f} % at a half (90 %)"
        least = 100 * least_change(points)
        yield "Resolved", f"changes of {least:.0f} % and more between the halves of a range"

    def data(self, found: Studied) -> dict[str, Any]:
        resolved, best = least_change(len(found.shares)), int(found.counts.max())
        return {"statements": found.chances, "resolved": resolved, "best": best} if found.judged else {}

    def tables(self, found: Studied) -> Iterator[SmallTable]:
        yield inputs_table(found)
        if found.judged:
            yield statements_table(found)
        groups = found.frame.groupby("material", sort=False)["run"]
        yield study.runs_table("Over all points", {NAMES[case]: runs for case, runs in groups})

    def notes(self, found: Studied) -> Iterator[str]:
        yield from self.told_of_campaign(found.frame)
        if found.judged:
            yield fitted_note(found)

    def figures(self, found: Studied) -> Iterator[Plot]:
        if not found.judged:
            return
        yield Plot(
            probabilities(
                [
                    (f"{each['figure']}: {each['statement']}", each["holds"], each["of"], each["bounds"])
                    for each in found.chances
                ]
            ),
            "probabilities",
            "Probability that a statement of the paper holds",
            "The bars show at which share of the points each statement of the paper holds, of those at "
            "which it says anything, with bounds of 90 %.",
        )


def statements_table(found: Studied) -> SmallTable:
    """How probable each statement is, and what decides it."""
    rows = []
    for each in found.chances:
        held, of, (low, high) = each["holds"], each["of"], each["bounds"]
        share = f"{100 * held / of:.0f} % ({100 * low:.0f} to {100 * high:.0f})" if of else "says nothing"
        cells = each["figure"], each["statement"], f"{held} of {of}", share
        rows.append((*cells, "; ".join(each["words"])))
    return SmallTable(
        "Probability that a statement holds, and what changes it by most between the halves of its range, "
        f"with bounds of 90 %, beyond what chance does once in {1 / CHANCE:.0f}",
        "Fig.|statement of the paper|holds|share of points (90 %)|decided by".split("|"),
        rows,
    )


def inputs_table(found: Studied) -> SmallTable:
    """What is drawn, and where most statements hold."""
    best = found.best if found.judged else []
    rows = [
        (
            one.words,
            one.even,
            *(one.shown(float(each[n])) for each in (LOW, HIGH, PRINTED, *found.shares[best])),
        )
        for n, one in enumerate(INPUTS)
    ]
    away = (f"{found.away[point]:.2f}" for point in best)
    rows.append(("distance from the printed inputs, in shares of the ranges (rms)", "", "", "", "0", *away))
    return SmallTable(
        "Inputs, each drawn evenly; fitted: the points at which most statements hold together, the nearest "
        "to the printed inputs first",
        ("input", "even in", "from", "to", "printed", *(f"point {k}: {found.counts[k]} hold" for k in best)),
        rows,
    )


def fitted_note(found: Studied) -> str:
    """What the nearest of them would mean."""
    point, hard = found.best[0], []
    scenes = found.frame[found.frame["reading"] == point].set_index("material")["run"]
    for case in MATERIALS:
        yields = 1e-9 * float(scenes[case].scene.body.plasticity.strength().stress(0.0, STRAIN))
        hard.append(f"{NAMES[case]} {TABOR[0] * yields:.1f} to {TABOR[1] * yields:.1f} GPa")
    rough = scenes[BULK].scene.counterbody.surface
    return (
        f"Fitted: at point {point}, {found.counts[point]} of {len(STATEMENTS)} statements hold together, "
        f"chosen of {len(found.shares)} points by this result, on one surface of its own; it is "
        f"{found.away[point]:.2f} of the ranges away from the printed inputs (two random points are "
        f"{1 / np.sqrt(6):.2f} apart). It would mean a surface hardness, by Tabor ({TABOR[0]:g} to "
        f"{TABOR[1]:g} σ_y at a strain of {STRAIN:.0%}), of {'; '.join(hard)}; plausible are {STEEL}. The "
        f"counter-surface has {1e9 * (rough.sq if rough else 0.0):.0f} nm rms; plausible are {DISCS}."
    )


CASES = (RunningInSensitivity("running-in-sensitivity"),)
