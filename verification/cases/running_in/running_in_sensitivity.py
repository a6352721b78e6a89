# SPDX-License-Identifier: MIT
"""Which of the inputs that the paper leaves open decide its statements on running-in.

Every input is drawn evenly over its range, each point on another surface, and all materials are run at each
point: shares of the points at which a statement holds are probabilities over these ranges. Ranges are those
that the paper, the literature on this steel and the readings of its figures allow; within them every value
counts as equally likely, and inputs as independent.

The points at which most statements hold together are chosen by their result, so that they are fitted: how far
they are from the printed inputs, what they would mean for the body, and whether that is plausible is said.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.stats import binomtest, norm

from sam.scene import Scene
from verification.cases.case import SAM, Context, Measured, Plot, SmallTable, with_keys, with_loading
from verification.cases.running_in.scenes import (
    BULK,
    DEEPER,
    LAST,
    NAMES,
    A,
    B,
    Effort,
    deeper,
    printed_scenes,
    with_constant,
    with_counter,
    with_deviation,
    with_layer_alpha,
    with_plasticity,
    with_seed,
)
from verification.cases.running_in.study import STATEMENTS, Histories, Run, Study
from verification.cost.estimates import estimate
from verification.figures.specials import probabilities
from verification.sensitivity import UNIFORM, design, indices
from verification.surrogate import Surrogate, surrogate

SURFACES = 100  # seeds of surfaces count from here, and are no others'
EFFORTS = {"quick": (4, Effort(2, 2, 24, (BULK, A))), "full": (64, Effort(LAST, 3, 64))}
"""Points, and what is run at each: the whole patch, since on a quarter of it most surfaces do not wear at
all."""
SEED = 26  # of the design and of what is resampled
CHANCE = 1e-3  # of each of 17 × 16 changes of probability: less than one of them is named by chance
PREDICTS = 0.5  # Q² of a fit that is believed: of 200 results without any cause at most two have it
PART = 0.1  # of the variance: an input with less of it is not named
DECIDING, EXPLAINING = 2, 3  # inputs named for each statement, and for its measure
ACTS = 3.3  # standard errors 1/sqrt(n - 1) of a correlation of ranks that chance passes once in a thousand
LAYER_LIMIT = 0.02  # of the layers of the printed scenes; curve B with 5 % keeps its 2.5 times as much
SMOOTH = 0.5e-9  # m: below it the counter-surface is a plane
NOMINAL = 1e-6  # m: printed thickness of the layer
TABOR, STRAIN = (2.8, 3.0), 0.08  # hardness over yield stress at STRAIN: Tabor, The Hardness of Metals (1951)
STEEL = (6.8e9, 8.2e9)  # Pa: 697 to 832 HV, 60 to 65 HRC by ASTM E140, of AISI 52100 hardened through
DISCS = (5e-9, 60e-9)  # m rms: polished to ground, as in running-in-physics
BEST = 3  # points that are shown
MATERIALS = (BULK, A, B)


@dataclass(frozen=True)
class Input:
    """An input between two ends, which are SI, or one of its levels; printed: in the scenes, where the paper
    does not print it what they assume; words, factor: for the reader.
    """

    name: str
    words: str
    ends: tuple[float, float]
    printed: float
    put: Callable[[Scene, float], Scene]
    factor: float = 1.0
    logarithmic: bool = False
    levels: tuple[int, ...] = ()

    def value(self, share: float) -> float:
        """At a share (0 to 1) of the way from one end to the other."""
        if self.levels:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        low, high = self.ends
        return low * (high / low) ** share if self.logarithmic else low + (high - low) * share

    def shown(self, share: float) -> str:
        """For the reader."""
        return f"{self.factor * self.value(share):.3g}"

    @property
    def share(self) -> float:
        """Of the printed value; of a level the middle of its part."""
        if self.levels:
            return (self.levels.index(int(self.printed)) + 0.5) / len(self.levels)
        ends = (*self.ends, self.printed)
        low, high, at = np.log(ends) if self.logarithmic else ends
        return float((at - low) / (high - low))


def _key(section: str, key: str) -> Callable[[Scene, float], Scene]:
    return lambda scene, value: with_keys(scene, section, **{key: value})


def _layer_depth(scene: Scene, thickness: float) -> Scene:
    """The profile over depth, and the layer if there is one, so much thinner."""
    plasticity, share = scene.body.plasticity, thickness / NOMINAL
    if plasticity.profile is None:
        return scene
    keys = {"profile": tuple((share * z, factor) for z, factor in plasticity.profile)}
    if plasticity.layer_thickness is not None:
        keys["layer_thickness"] = share * plasticity.layer_thickness
    return with_plasticity(scene, **keys)


def _layer_limit(scene: Scene, limit: float) -> Scene:
    if (printed := scene.wear.strain_limit_layer) is None:
        return scene
    return with_keys(scene, "wear", strain_limit_layer=limit * printed / LAYER_LIMIT)


def _load(scene: Scene, force: float) -> Scene:
    return with_loading(scene, force=force * scene.loading.force / 0.6)


def _counter(scene: Scene, sq: float) -> Scene:
    return scene if sq < SMOOTH else with_counter(scene, sq)


LAYER, LIMIT, FILM = "hardening α of the layer", "strain limit of the", "yield stress of the film [GPa]"
COUNTER, GROWTH = "roughness of the counter-surface [nm rms]", "growth of the film [nm/√s]"
_friction, _limit = (lambda key: _key("friction", key)), _key("wear", "strain_limit")
INPUTS = (
    Input("feed", "share of the feed in Ra", (0.2, 0.6), 0.4, _key("surface", "feed_share")),
    Input("shortest", "shortest wave [µm]", (8e-6, 20e-6), 12e-6, _key("surface", "cutoff_short"), 1e6),
    Input("hurst", "Hurst exponent", (0.6, 0.95), 0.8, _key("surface", "hurst")),
    Input("anisotropy", "anisotropy", (1.0, 3.0), 1.5, _key("surface", "anisotropy")),
    Input("B", "B of Swift's law [MPa]", (1280e6, 1780e6), 1780e6, with_constant, 1e-6),
    Input("depth", "depth of the layer [µm]", (0.3e-6, 1e-6), 1e-6, _layer_depth, 1e6),
    Input("deviation", "deviation of the layer, factor", (0.8, 1.4), 1.0, with_deviation),
    Input("hardening", LAYER, (1e1, 1e6), 1e6, with_layer_alpha, logarithmic=True),
    Input("limit", f"{LIMIT} bulk [%]", (0.001, 0.004), 0.002, _limit, 1e2, logarithmic=True),
    Input("layer-limit", f"{LIMIT} layer [%]", (0.01, 0.05), 0.02, _layer_limit, 1e2, logarithmic=True),
    Input("growth", GROWTH, (1.8e-9, 7.3e-9), 3.644e-9, _friction("growth_coefficient"), 1e9),
    Input("film-yield", FILM, (0.55e9, 0.8e9), 0.6667e9, _friction("film_yield"), 1e-9),
    Input("high", "friction of the failed film", (0.2, 0.4), 0.4, _friction("high")),
    Input("load", "load [N]", (0.3, 1.2), 0.6, _load, logarithmic=True),
    Input("counter", COUNTER, (0.0, 30e-9), 0.0, _counter, 1e9),
    Input(
        *("window", "window of smoothing [cells]", (0.0, 9.0), 5),
        _key("wear", "smoothing_window"),
        levels=(0, 3, 5, 7, 9),
    ),
)
"""In the order in which they are put into a scene: a law of the layer takes the constants of the body."""
PRINTED = np.array([each.share for each in INPUTS])
"""(inputs,) shares of the printed inputs."""


def scene_at(scene: Scene, shares: Sequence[float], seed: int) -> Scene:
    """The scene of a material with every input at its share, on a surface of its own."""
    scene = with_seed(scene, seed)
    for each, share in zip(INPUTS, shares, strict=True):
        scene = each.put(scene, each.value(float(share)))
    while (
        scene.loading.force * (64e-6 / scene.grid.extent[0]) ** 2 > 0.7
        and scene.grid.depths[-1] < DEEPER[0][1]
    ):
        scene = deeper(scene)
    return scene


def wilson(held: int, of: int, level: float = 0.9) -> tuple[float, float]:
    """Bounds of a probability of which `held` of `of` draws are known: Wilson (1927)."""
    if not of:
        return 0.0, 1.0
    found = binomtest(held, of).proportion_ci(level, method="wilson")
    return float(found.low), float(found.high)


@dataclass(frozen=True)
class Decider:
    """How much more often a statement holds in the upper half of an input's range than in the lower one, with
    bounds of 90 %. acts: whether that is beyond chance: by itself, or beyond its bounds where a fit of the
    measure tells that the input moves it.
    """

    input: Input
    change: float
    bounds: tuple[float, float]
    acts: bool

    @property
    def text(self) -> str:
        """For the reader."""
        low, high = (f"{100 * end:+.0f}" for end in self.bounds)
        return f"{self.input.words}: {100 * self.change:+.0f} % ({low} to {high})"


def deciders(shares: np.ndarray, held: np.ndarray, fit: Surrogate | None = None) -> list[Decider]:
    """The inputs that decide a statement, the first most. held: (points,), NaN: says nothing; fit: of its
    measure.
    """
    says = np.isfinite(held)
    moves = fit.shares >= PART if believed(fit) else np.zeros(len(INPUTS), dtype=bool)
    found = []
    for share, one, moved in zip(shares.T[:, says], INPUTS, moves, strict=True):
        high, low = held[says][share >= 0.5], held[says][share < 0.5]
        if high.size and low.size:
            bounds = change_between(high, low, 0.9)
            wide = bounds if moved else change_between(high, low, 1.0 - CHANCE)
            change = float(high.mean() - low.mean())
            found.append(Decider(one, change, bounds, wide[0] > 0.0 or wide[1] < 0.0))
    return sorted(found, key=lambda each: (not each.acts, -abs(each.change)))


def believed(fit: Surrogate | None) -> bool:
    """Whether a fit predicts the points that it has not seen."""
    return fit is not None and fit.predicted >= PREDICTS


def change_between(high: np.ndarray, low: np.ndarray, level: float) -> tuple[float, float]:
    """Bounds of the difference of two probabilities: Newcombe, Stat. Med. 17 (1998) 873, method 10."""
    ends = [(part.mean(), *wilson(int(part.sum()), part.size, level)) for part in (high, low)]
    (p, p_low, p_high), (q, q_low, q_high) = ends
    bounds = p - q - np.hypot(p - p_low, q_high - q), p - q + np.hypot(p_high - p, q - q_low)
    return float(bounds[0]), float(bounds[1])


def least_change(points: int) -> float:
    """Smallest change of a probability near a half that is beyond CHANCE, between the halves of a range."""
    return float(norm.isf(CHANCE / 2.0) * np.sqrt(2.0 * 0.25 / (points / 2.0)))


@dataclass(frozen=True)
class Studied:
    """shares: of the inputs, (points, inputs); runs: point and material -> what ran; predicted_s: by the
    plan; printed: the scene of each material before any input is put.
    """

    effort: Effort
    shares: np.ndarray
    runs: Mapping[tuple[int, str], Run]
    predicted_s: float
    printed: Mapping[str, Scene]

    @cached_property
    def histories(self) -> list[Histories]:
        """For each point the materials that converged."""
        runs = {key: one for key, one in self.runs.items() if one.result.converged}
        return [
            {case: runs[point, case].history for case in self.effort.cases if (point, case) in runs}
            for point in range(len(self.shares))
        ]

    @cached_property
    def measures(self) -> np.ndarray:
        """Of each statement at each point, (statements, points); NaN where it says nothing there."""
        return np.array([[each.on(own) for own in self.histories] for each in STATEMENTS])

    @cached_property
    def held(self) -> np.ndarray:
        """Whether a statement holds at a point, (statements, points); NaN where it says nothing there."""
        holds = [
            [float(said.holds(v)) for v in row] for said, row in zip(STATEMENTS, self.measures, strict=True)
        ]
        return np.where(np.isnan(self.measures), np.nan, holds)

    @cached_property
    def fits(self) -> list[Surrogate | None]:
        """Of the measure of each statement."""
        return [surrogate(self.shares, row) for row in self.measures]

    @cached_property
    def deciders(self) -> list[list[Decider]]:
        """Of each statement."""
        return [deciders(self.shares, *each) for each in zip(self.held, self.fits, strict=True)]

    @property
    def chances(self) -> list[dict[str, Any]]:
        """Of each statement: at how many points it holds, of those at which it says anything, bounds of that
        share, and the inputs that decide it.
        """
        found = []
        for said, row, own in zip(STATEMENTS, self.held, self.deciders, strict=True):
            holds, of = int(np.nansum(row)), int(np.isfinite(row).sum())
            bounds, acting = wilson(holds, of), [each for each in own[:DECIDING] if each.acts]
            deciding = [{"input": e.input.words, "change": e.change, "bounds": e.bounds} for e in acting]
            chance = {"figure": said.figure, "statement": said.words, "holds": holds, "of": of}
            named = {"deciders": deciding, "words": [each.text for each in acting]}
            found.append(chance | {"bounds": bounds} | named)
        return found

    @property
    def judged(self) -> bool:
        """Whether there are as many cycles as the statements ask for."""
        return self.effort.cycles >= LAST

    @property
    def lost(self) -> int:
        """Runs without a converged result."""
        return len(self.runs) - sum(map(len, self.histories))

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

    @property
    def decided_by(self) -> dict[str, int]:
        """Name of an input -> number of statements whose probability it changes beyond chance; the two that
        change most first, of equal ones those that change by most.
        """
        every = list(itertools.chain(*self.deciders))
        counts = {one.name: sum(each.acts for each in every if each.input is one) for one in INPUTS}
        total = {one.name: sum(abs(each.change) for each in every if each.input is one) for one in INPUTS}
        return dict(sorted(counts.items(), key=lambda pair: (-pair[1], -total[pair[0]])))


class RunningInSensitivity(Study):
    """All materials at every point of the design."""

    def scenes(self, context: Context) -> dict[Any, Scene]:
        points, effort = EFFORTS[context.level]
        shares, bases = design(UNIFORM, len(INPUTS), points, SEED), printed_scenes(context, effort)
        runs = itertools.product(range(points), effort.cases)
        return {(point, case): scene_at(bases[case], shares[point], SURFACES + point) for point, case in runs}

    def label(self, key: tuple[int, str]) -> str:
        return "point-{:03}-{}".format(*key)

    def solve(self, context: Context) -> Studied:
        points, effort = EFFORTS[context.level]
        predicted = sum(estimate(scene, SAM).time_s for scene in self.scenes(context).values())
        # without the fields, of which all runs have gigabytes: their files have them
        runs = {
            key: Run(one.scene, replace(one.result, fields=None, grids={}))
            for key, one in self.runs(context).items()
        }
        shares = design(UNIFORM, len(INPUTS), points, SEED)
        return Studied(effort, shares, runs, predicted, printed_scenes(context, effort))

    def measure(self, found: Studied) -> dict[str, Measured]:
        points, cases = len(found.shares), found.effort.cases
        return {
            "missing": Measured(points * len(cases) - len(found.runs), 0),
            "lost": Measured(found.lost / len(found.runs)),
        }

    def setup(self, found: Studied) -> Iterator[tuple[str, str]]:
        effort, points = found.effort, len(found.shares)
        size = f"{points} points, {len(effort.cases)} materials: {len(found.runs)} runs"
        each = f"{effort.cells} × {effort.cells} cells, {effort.cycles} cycles, {effort.steps} load steps"
        yield "Runs", f"{size} of {each}"
        yield "Inputs", "uniform and independent over their ranges, each point on another surface"
        took = sum(one.result.cost["cpu_s"] for one in found.runs.values())
        yield "Processor time", f"{took / 60:.0f} min, predicted {found.predicted_s / 60:.0f} min"
        yield "Without a converged result", f"{found.lost} runs"
        half = 50 * np.diff(wilson(points // 2, points))[0]
        yield "Sampling error of a share of points", f"±{half:.0f} % at a half (90 %)"
        least = 100 * least_change(points)
        yield "Resolved", f"changes of {least:.0f} % and more between the halves of a range"

    def data(self, found: Studied) -> dict[str, Any]:
        best = [{"point": k, "hold": int(found.counts[k]), "away": float(found.away[k])} for k in found.best]
        resolved = least_change(len(found.shares))
        return {"statements": found.chances, "resolved": resolved, "best": best} if found.judged else {}

    def tables(self, found: Studied) -> Iterator[SmallTable]:
        even = ("logarithm" if one.logarithmic else "value" for one in INPUTS)
        rows = [
            (one.words, one.shown(0.0), one.shown(1.0), in_) for one, in_ in zip(INPUTS, even, strict=True)
        ]
        words = "Inputs, drawn evenly in their value or its logarithm"
        yield SmallTable(words, ("input", "from", "to", "even in"), rows)
        if found.judged:
            yield statements_table(found)
            yield fits_table(found)
            yield fitted_table(found)
        yield responses_table(found)

    def notes(self, found: Studied) -> Iterator[str]:
        if found.judged:
            yield fitted_note(found)

    def figures(self, found: Studied) -> Iterator[Plot]:
        if not found.judged:
            return
        chances = found.chances
        names = [f"{each['figure']}: {each['statement']}" for each in chances]
        numbers = ([each[key] for key in ("holds", "of", "bounds")] for each in chances)
        yield Plot(
            probabilities([(name, *each) for name, each in zip(names, numbers, strict=True)]),
            "probabilities",
            "Probability that a statement of the paper holds",
            "A bar with its bounds for each of the 17 statements, and at how many points it holds.",
            "Right: points at which it holds, of those at which it says anything; bounds of 90 %.",
        )


def _filled(cells: Sequence[str], count: int) -> tuple[str, ...]:
    return (*cells, *[""] * (count - len(cells)))


def statements_table(found: Studied) -> SmallTable:
    """How probable each statement is, and what decides it."""
    rows = []
    for each in found.chances:
        held, of, (low, high) = each["holds"], each["of"], each["bounds"]
        share = f"{100 * held / of:.0f} % ({100 * low:.0f} to {100 * high:.0f})" if of else "says nothing"
        cells = each["figure"], each["statement"], f"{held} of {of}", share
        rows.append((*cells, *_filled(each["words"], DECIDING)))
    return SmallTable(
        "Probability that a statement holds, and what changes it by most between the halves of its range, "
        f"with bounds of 90 %: beyond what chance does once in {1 / CHANCE:.0f}, or, where the fit below "
        "names the input, beyond those bounds",
        "Fig.|statement of the paper|holds|share of points (90 %)|decided first by|then by".split("|"),
        rows,
    )


def fits_table(found: Studied) -> SmallTable:
    """What a fit of the measure of each statement says."""
    rows = []
    for statement, fit, row in zip(STATEMENTS, found.fits, found.measures, strict=True):
        named = ["no fit predicts it"]
        if believed(fit):
            order = [int(k) for k in np.argsort(-fit.shares, kind="stable")[:EXPLAINING]]
            ways = ({1: "rises", -1: "falls"}.get(int(fit.slopes[k]), "bends") for k in order)
            named = [
                f"{INPUTS[k].words}: {100 * fit.shares[k]:.0f} %, {way}"
                for k, way in zip(order, ways, strict=True)
                if fit.shares[k] >= PART
            ]
        of, predicted = int((~np.isnan(row)).sum()), "–" if fit is None else f"{fit.predicted:.2f}"
        cells = statement.figure, statement.words, statement.measure, f"{of}", predicted
        rows.append((*cells, *_filled(named, EXPLAINING)))
    return SmallTable(
        "Shares of the variance of each measure (its ranks) by a sparse polynomial of single inputs, and "
        "whether the measure rises or falls with the input. Q²: of the variance, what the fit predicts at "
        f"points left out; no share where it is below {PREDICTS:g}. The rest is the surface, and what inputs "
        "do together",
        "Fig.|statement of the paper|measure|points|Q²|first|second|third".split("|"),
        rows,
    )


RESPONSES: Mapping[str, tuple[Callable, Callable]] = {
    "worn volume [µm³]": (lambda h: np.log10(1.0 + 1e18 * h.volume[-1]), lambda v: 10.0**v - 1.0),
    "coefficient of friction": (lambda h: h.friction[-1], lambda v: v),
    "Sa [nm]": (lambda h: h.sa[-1], lambda v: 1e9 * v),
}
"""What a run ends with -> of its history, and as it is shown."""


def response(found: Studied, case: str, name: str) -> tuple[np.ndarray, np.ndarray]:
    """One of RESPONSES at each point, NaN where the run did not converge, and the correlations of its ranks
    with those of each input, NaN where it never changes.
    """
    of, _ = RESPONSES[name]
    values = np.array([of(own[case]) if case in own else np.nan for own in found.histories])
    ranks = indices(UNIFORM, found.shares, values, SEED)
    return values, ranks[0].values if ranks else np.full(len(INPUTS), np.nan)


def responses_table(found: Studied) -> SmallTable:
    """What moves volume, friction and roughness of each material."""
    rows, limit = [], ACTS / np.sqrt(len(found.shares) - 1)
    for case, name in itertools.product(found.effort.cases, RESPONSES):
        values, of_inputs = response(found, case, name)
        order = np.argsort(-np.abs(np.nan_to_num(of_inputs)))[:3]
        above = [k for k in order if abs(np.nan_to_num(of_inputs[k])) > limit]
        named = [f"{INPUTS[k].words}: {of_inputs[k]:+.2f}" for k in above]
        says = np.isfinite(values).any()
        quantiles = np.nanquantile(values, (0.05, 0.5, 0.95)) if says else (np.nan,) * 3
        shown = (f"{RESPONSES[name][1](v):.3g}" for v in quantiles)
        rows.append((NAMES[case], name, *shown, *_filled(named, 3)))
    return SmallTable(
        f"What moves the last cycle: correlations of ranks above chance ({limit:.2f})",
        ("material", "what", "5 %", "median", "95 %", "first", "second", "third"),
        rows,
    )


def hardness(scene: Scene) -> tuple[float, float]:
    """Of the material at the surface in Pa, bounds by Tabor."""
    yields = float(scene.body.plasticity.strength().stress(0.0, STRAIN))
    return TABOR[0] * yields, TABOR[1] * yields


def _range(ends: tuple[float, float]) -> str:
    return f"{1e-9 * ends[0]:.1f} to {1e-9 * ends[1]:.1f}"


def fitted_table(found: Studied) -> SmallTable:
    """The points at which most statements hold, beside the printed inputs."""
    best = found.best
    rows = [
        (one.words, *(one.shown(float(of[n])) for of in (PRINTED, *found.shares[best])))
        for n, one in enumerate(INPUTS)
    ]
    words = "distance from the printed inputs, in shares of the ranges (rms)"
    rows.append((words, "0", *(f"{found.away[k]:.2f}" for k in best)))
    for case in MATERIALS:
        scenes = (found.printed[case], *(found.runs[k, case].scene for k in best))
        rows.append(
            (f"hardness of the surface, {NAMES[case]} [GPa]", *(_range(hardness(each)) for each in scenes))
        )
    return SmallTable(
        "Fitted: inputs of the points at which most statements hold together, the nearest to the "
        f"printed ones first. Hardness: {TABOR[0]:g} to {TABOR[1]:g} σ_y at a strain of {STRAIN:.0%} (Tabor)",
        ("input", "printed inputs", *(f"point {k}: {found.counts[k]} hold" for k in best)),
        rows,
    )


def fitted_note(found: Studied) -> str:
    """What the nearest of them would mean."""
    point, said = found.best[0], []
    for case in MATERIALS:
        own, before = hardness(found.runs[point, case].scene), hardness(found.printed[case])
        judged = "plausible"
        if own[0] > STEEL[1]:
            judged = f"{own[0] / STEEL[1]:.2f} times the hardest steel, not plausible"
        elif own[1] < STEEL[0]:
            judged = f"{own[1] / STEEL[0]:.2f} times the softest"
        said.append(f"{NAMES[case]} {_range(own)} GPa, {judged} (printed inputs {_range(before)})")
    rough = found.runs[point, BULK].scene.counterbody.surface
    sq = rough.sq if rough else 0.0
    as_discs = (
        "as polished to ground discs have"
        if DISCS[0] <= sq <= DISCS[1]
        else "smoother than polished to ground discs"
    )
    return (
        f"Fitted: at point {point}, {found.counts[point]} of {len(STATEMENTS)} statements hold together, "
        f"chosen of {len(found.shares)} points by this result, on one surface of its own; it is "
        f"{found.away[point]:.2f} of the ranges away from the printed inputs (two random points are "
        f"{1 / np.sqrt(6):.2f} apart). It would mean a surface hardness, by Tabor, of {'; '.join(said)}; "
        f"AISI 52100 hardened to 60 to 65 HRC has {_range(STEEL)} GPa. The counter-surface has "
        f"{1e9 * sq:.0f} nm rms, {as_discs} ({1e9 * DISCS[0]:.0f} to {1e9 * DISCS[1]:.0f} nm)."
    )


CASES = (RunningInSensitivity("running-in-sensitivity"),)
