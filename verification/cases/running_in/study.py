# SPDX-License-Identifier: MIT
"""The study of running-in (Bosman & Schipper 2011, Figs. 13-17): five materials as scenes, named readings of
the paper that change them, their runs as one frame, and the statements of the paper as measures with limits.

A study (`Readings`) runs a list of named readings, each on some surfaces; `judged` says of each which of
STATEMENTS hold. A frame has a row a run: the parts of its key, `run`, `converged`, and its measures and other
numbers, NaN where it did not converge. The paper's surface is not public and its numbers belong to it: only
directions and ratios are asked for. A statement that the model contradicts is a finding; nothing here is a
row.
"""

from __future__ import annotations

import csv
import gzip
import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib import resources
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sam.scene import CounterSurface, Hardening, Plasticity, Result, Scene, Status
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_grid,
    with_keys,
    with_loading,
)
from verification.compare.running_in_measures import History, Scar, Spread
from verification.runs.store import identity, short

if TYPE_CHECKING:
    from pandas import DataFrame

BULK, A, B, DUCTILE, HARDENING = "bulk", "curve-a", "curve-b", "curve-b-ductile", "hardening"
NAMES = {BULK: "bulk", A: "curve A", B: "curve B", DUCTILE: "curve B, 5 %", HARDENING: "hardening only"}
"""The five materials, as scenes are named -> as the reader knows them."""
EARLY, STEADY, LAST = 6, 10, 25  # cycles of the paper's figures: end of the first wear, steady part, last
AGREED = 0.8  # of the surfaces that must agree
STILL = 1e-3  # of the worn volume: what cycles 21 to 25 add at least where wear goes on
LITERATURE_B = 1280e6  # Pa: of the steel with the paper's C and n in the literature; the paper takes 1780 MPa
DEEPER = ((14.2e-6, 19.4e-6), (26.5e-6, 36.2e-6))  # m: further faces of layers, each 1.366 times as deep
LAYER_ALPHA = 1e3  # of Swift's law in the layer: 2.4 GPa at a strain of 2 %, where 1e6 gives 4.6 GPa
ROUGHNESS = {"sq": 10e-9, "cutoff_long": 32e-6, "cutoff_short": 12e-6, "hurst": 0.8}
MODULI = (35648.8e9, 13721.5e9, 1895.4e9, 227.18e9, 37.371e9)
RECOVERY = (3e5, 3e4, 3e3, 300.0, 30.0)
"""Back-stresses that fit Swift's law with B = 1780 MPa, C = 4, n = 0.095 less its start, within 0.5 % from
1e-6 to 0.03."""
SHARES = {"isotropic": 0.0, "half and half": 0.5, "kinematic": 1.0}
"""Ways to harden -> share of the hardening that back-stresses have. Assumed: no cyclic curve is known."""
LARGEST, POINTS = 0.2, 60  # of the plastic strain in the table of a yield stress, and its rows
CUBIC, GIGA, NAN = 1e18, 1e-9, float("nan")


FOLDER = resources.files(__package__)
"""Where campaigns are."""


@dataclass(frozen=True)
class Effort:
    """How much is run: cycles, load steps each way, cells of 1 um a side, materials, seeds."""

    cycles: int
    steps: int
    cells: int
    cases: tuple[str, ...] = tuple(NAMES)
    seeds: tuple[int, ...] = (2,)


def printed_scenes(context: Context, effort: Effort) -> dict[str, Scene]:
    """Material -> its scene with the printed inputs at an effort."""
    return {case: reduced(context.scene(f"running-in-{case}"), effort) for case in effort.cases}


def reduced(scene: Scene, effort: Effort) -> Scene:
    """The scene on a patch of so many cells, at its nominal pressure, for so many cycles and steps."""
    if effort.cells != scene.grid.cells[0]:
        share = effort.cells / scene.grid.cells[0]
        extent = tuple(share * side for side in scene.grid.extent)
        scene = with_grid(scene, cells=(effort.cells,) * 2, extent=extent)
        scene = with_loading(scene, force=share**2 * scene.loading.force)
    return with_loading(scene, cycles=effort.cycles, steps=effort.steps, unload_steps=effort.steps)


def with_seed(scene: Scene, seed: int) -> Scene:
    """Another surface of the same statistics."""
    return with_keys(scene, "surface", seed=seed)


def with_plasticity(scene: Scene, **keys) -> Scene:
    """With other keys in [body.plasticity]."""
    return with_keys(scene, "body.plasticity", **keys)


def with_constant(scene: Scene, B: float) -> Scene:
    """With another constant B, in Pa, in the body and in a layer with a law of its own."""
    layer = scene.body.plasticity.layer
    return with_plasticity(scene, B=B, layer=layer and layer.model_copy(update={"B": B}))


def with_layer_alpha(scene: Scene, alpha: float) -> Scene:
    """The layer, if there is one, with Swift's law of its own: hardening by alpha times the strain."""
    plasticity = scene.body.plasticity
    if plasticity.layer_thickness is None:
        return scene
    own = plasticity.model_dump(include={"law", "B", "C", "n"})
    return with_plasticity(scene, layer=Hardening(**own, alpha=alpha))


def with_deviation(scene: Scene, scale: float) -> Scene:
    """With so much of the layer's deviation from the bulk; scaling the factors would change the
    bulk below it too.
    """
    if (profile := scene.body.plasticity.profile) is None:
        return scene
    return with_plasticity(scene, profile=tuple((z, 1.0 + scale * (f - 1.0)) for z, f in profile))


def with_counter(scene: Scene, sq: float, *, renew: bool = True) -> Scene:
    """A rough counter-surface of so many m rms, another one in each cycle if it is renewed. Its seeds, one
    for each cycle, are neither those of the surfaces nor those of another surface's counter-surface.
    """
    keys = {**ROUGHNESS, "sq": sq, "seed": 1000 * scene.surface.seed + 1, "renew": renew}
    return with_keys(scene, "counterbody", surface=CounterSurface(kind="self-affine", **keys))


def deeper(scene: Scene) -> Scene:
    """With the next faces of DEEPER: softer steel, and the summits of some surfaces, let the body
    yield below the layers of the printed scenes.
    """
    depths = scene.grid.depths
    return with_grid(scene, depths=(*depths, *next(faces for faces in DEEPER if faces[0] > depths[-1])))


def swift(law: Plasticity, peeq: np.ndarray) -> np.ndarray:
    """Yield stress of the isotropic law in Pa."""
    return law.B * (law.C + law.alpha * peeq) ** law.n


def hardened(scene: Scene, share: float) -> Scene:
    """The body with so much of its hardening by back-stresses, and the rest as a table that ends flat."""
    law, peeq = scene.body.plasticity, np.append(0.0, np.geomspace(1e-7, LARGEST, POINTS))
    first = float(swift(law, np.zeros(1))[0])
    stress = first + (1 - share) * (swift(law, peeq) - first)
    table = {"law": "table", "file": tuple(zip(peeq.tolist(), stress.tolist(), strict=True))}
    isotropic = {"law": "perfect", "yield_stress": first} if share == 1 else table
    back = {"modulus": tuple(share * modulus for modulus in MODULI), "recovery": RECOVERY}
    place = law.model_dump(include={"profile", "layer_thickness"}, exclude_none=True)
    plasticity = Plasticity(**isotropic, **({"kinematic": back} if share else {}), **place)
    return with_keys(scene, "body", plasticity=plasticity)


@dataclass(frozen=True)
class Run:
    """A scene and its result; again: whether it has deeper layers than were asked for; kept: what a campaign
    has of it; solved: whether the result is not that.
    """

    scene: Scene
    result: Result
    again: bool = False
    kept: Kept | None = None
    solved: bool = True

    @cached_property
    def history(self) -> History:
        """The run over its cycles."""
        return History.of(self.result.tables)

    @cached_property
    def scar(self) -> Scar:
        """The surface of the last cycle."""
        return Scar.of(self.result.tables)

    @property
    def friction(self) -> tuple[float, float]:
        """The low and the high coefficient."""
        return self.scene.friction.low, self.scene.friction.high

    def of_cycles(self, column: str) -> np.ndarray:
        """A column of cycles.csv."""
        return np.asarray(self.result.tables["cycles"][column], dtype=float)


def parts_of(table: str) -> list[list[str]]:
    """Of each line, between |."""
    return [[part.strip() for part in line.split("|")] for line in table.splitlines()]


def apart(value: float, expected: float) -> float:
    """Relative difference, 0 where both are 0."""
    return abs(value - expected) / max(abs(expected), abs(value)) if value != expected else 0.0


def outside(values: np.ndarray, low: float, high: float) -> float:
    """How far values lie out of a range, NaN where one is none."""
    return float(np.max(np.maximum(np.maximum(low - values, values - high), 0.0)))


def at_rest_from(new_strain: np.ndarray) -> float:
    """The first cycle from which on no cell strains; NaN if the last one still does."""
    busy = np.flatnonzero(new_strain > 0.0)
    after = int(busy[-1]) + 1 if busy.size else 0
    return after + 1.0 if after < new_strain.size else NAN


def ratio(a: float, b: float) -> float:
    """a/b of volumes, rates or heights; for b = 0 infinite, NaN where a is 0 too."""
    if b == 0.0:
        return NAN if a == 0.0 else float("inf")
    return a / b


MEASURES: Mapping[str, Callable[[History], float]] = {
    "early": lambda h: ratio(h.volume_after(EARLY), h.volume_after(LAST)),
    "later": lambda h: ratio(h.rate(STEADY, LAST), h.rate(0, EARLY)),
    "steady": lambda h: h.rate(STEADY, LAST),
    "volume": lambda h: h.volume_after(LAST),
    "straight": lambda h: float(np.nan_to_num(h.straightness(5, LAST))),  # 0, the worst, where nothing wears
    "grown": lambda h: float(np.nan_to_num(ratio(5 * h.rate(LAST - 5, LAST), h.volume_after(LAST)))),
    "friction": lambda h: h.at("friction", LAST),
    "fallen": lambda h: h.at("friction", LAST) - h.at("friction", 1),
    "sa": lambda h: h.at("sa", LAST),
}
"""Of a run of 25 cycles; grown: share of the volume that the last five wear, 0 where nothing has worn."""
COLUMNS: Mapping[str, Callable[[Run], float]] = {
    "V, after cycle 1 [µm³]": lambda one: CUBIC * one.history.volume[0],
    "V, after the last cycle [µm³]": lambda one: CUBIC * one.history.volume[-1],
    "μ, cycle 1": lambda one: one.history.friction[0],
    "μ, last cycle": lambda one: one.history.friction[-1],
    "Sa, after cycle 1 [nm]": lambda one: 1e9 * one.history.sa[0],
    "Sa, after the last cycle [nm]": lambda one: 1e9 * one.history.sa[-1],
    "p_max, cycle 1 [GPa]": lambda one: GIGA * one.history.p_max[0],
    "p_max, last cycle [GPa]": lambda one: GIGA * one.history.p_max[-1],
    "no new plastic strain from cycle": lambda one: at_rest_from(one.of_cycles("new_strain_max")),
}
"""What tables show of runs -> of a run that converged."""


def framed(
    runs: Mapping[tuple, Run],
    parts: Sequence[str],
    numbers: Mapping[str, Callable[[Run], float]] | None = None,
) -> DataFrame:
    """A row a run. parts: names of those of a key; numbers: name -> what a run that converged has
    of it, beside MEASURES.
    """
    import pandas as pd

    own = {name: lambda one, of=of: of(one.history) for name, of in MEASURES.items()} | (numbers or {})
    rows = [
        (*key, one, one.result.converged, *(of(one) if one.result.converged else NAN for of in own.values()))
        for key, one in runs.items()
    ]
    return pd.DataFrame(rows, columns=[*parts, "run", "converged", *own])


KEPT = """\
cycle wear_volume_m3 friction_coefficient sa_m protected_fraction p_max_Pa new_strain_max wear_of_cycle_m3
raw_volume_m3 roof_volume_m3 filled_volume_m3 yield_excess flow_residual peeq_max""".split()


class Kept(NamedTuple):
    """What a campaign has of a run. result: its status and the columns KEPT of its cycles, to six digits;
    case: whose campaign; made: the number of its runs, commit and date.
    """

    result: Result
    case: str
    made: str


@cache
def campaigns() -> Mapping[str, Kept]:
    """Digest of a scene -> its run, of all studies beside this module that take hours and were solved."""
    found = {}
    for file in FOLDER.iterdir():
        case, _, ending = file.name.partition(".")
        if ending == "csv.gz":
            made, *lines = gzip.decompress(file.read_bytes()).decode().splitlines()
            for digest, rows in groupby(csv.DictReader(lines), key=itemgetter("scene")):
                own = list(rows)
                cycles = {name: [float(row[name] or NAN) for row in own] for name in KEPT}
                there = {name: values for name, values in cycles.items() if not np.isnan(values).all()}
                result = Result(SAM, Status(own[0]["status"]), {}, {"cycles": there})
                found[digest] = Kept(result, case, made.removeprefix("# "))
    return found


def digest_of(scene: Scene) -> str:
    """Of a scene with all its defaults, but without its title."""
    return hashlib.sha256(json.dumps(identity(scene, SAM), sort_keys=True).encode()).hexdigest()[:16]


@dataclass(frozen=True)
class Reading:
    """How the paper is read. label: in names of runs; change: of the printed scene of a material."""

    label: str
    effort: Effort
    change: Callable[[Scene], Scene] = lambda scene: scene


PARTS = ("reading", "material", "surface")
"""Of a key."""


class Readings(Case):
    """Every material on every surface in each of some readings.

    Runs may stay unconverged: a row counts those, and a set of hours does not break off for one of them.
    Where the plastic zone reaches the last layer a run begins again with deeper ones.
    """

    numbers: Mapping[str, Callable[[Run], float]] = {}

    def readings(self, context: Context) -> Mapping[Any, Reading]:
        """By their names."""
        raise NotImplementedError(self.name)

    def solved_again(self, reading: Any, material: str, surface: int) -> bool:
        """Whether a run is solved even where a campaign has it."""
        return True

    def scenes(self, context: Context) -> dict[tuple, tuple[str, Scene]]:
        """Key -> label and scene of its run."""
        return {
            (name, case, seed): (f"{one.label}{case}-seed-{seed}", one.change(with_seed(scene, seed)))
            for name, one in self.readings(context).items()
            for seed in one.effort.seeds
            for case, scene in printed_scenes(context, one.effort).items()
        }

    def solve(self, context: Context) -> Any:
        return framed(self.runs(context), PARTS, self.numbers)

    def ahead(self, context: Context) -> Iterable[Scene]:
        for key, (_, scene) in self.scenes(context).items():
            if self.solved_again(*key) or digest_of(scene) not in campaigns():
                yield scene

    def then(self, scene: Scene, result: Result) -> Scene | None:
        at_edge = result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE
        return deeper(scene) if at_edge and scene.grid.depths[-1] < DEEPER[-1][0] else None

    def every(self, context: Context, *, campaign: bool = False) -> Iterator[tuple[tuple, str, Run]]:
        """Key, label and run, those with deeper layers after those that they replace. campaign: solve what
        that of this case is to have, and not only what `solved_again` asks for.
        """
        for key, (label, first) in self.scenes(context).items():
            below: Scene | None = first
            while below is not None:
                scene = below
                old = campaigns().get(digest_of(scene))
                now = old is None or (old.case == self.name if campaign else self.solved_again(*key))
                result = context.solve(SAM, scene, label, demand=False) if now else old.result
                # without the fields, of which all runs have gigabytes: their files have them
                bare = replace(result, fields=None, grids={})
                yield key, label, Run(scene, bare, scene is not first, old, now)
                below, label = self.then(scene, result), f"{label}-deeper"

    def runs(self, context: Context) -> dict[tuple, Run]:
        """What ran, or was kept, by key."""
        return {key: run for key, _, run in self.every(context)}

    def keep(self, context: Context, path: Path) -> None:
        """Solve all runs that no other study has, or take them from the store, and write what a campaign has
        of them, with the commit of the last one. No command calls it: `case_of(name).keep(context, path)`,
        once, with a path beside this module.
        """
        import pandas as pd

        rows = []
        for _, label, one in self.every(context, campaign=True):
            if one.solved:
                cycles = one.result.tables["cycles"]
                own = pd.DataFrame({name: cycles[name] for name in KEPT if name in cycles})
                who = {"scene": digest_of(one.scene), "run": label, "status": str(one.result.status)}
                own = own.reindex(range(max(len(own), 1)))  # of one that ended in its first cycle too
                rows.append(own.assign(**who))
        last = list(context.sources.values())[-1]
        made = f"# {len(rows)} runs, {short(last.commit)}, {last.created[:10]}\n"
        table = pd.concat(rows).reindex(columns=["scene", "run", "status", *KEPT])
        text = f"{made}{table.to_csv(index=False, float_format='%.6g')}"
        path.write_bytes(gzip.compress(text.encode(), mtime=0))

    def measure(self, found: Any) -> dict[str, Measured]:
        """lost: share of a frame that did not converge; campaign: what runs that are solved again differ by
        in the median, 0 where there is no campaign.
        """
        off = apart_from_campaign(found) if found["run"].map(lambda one: bool(one.kept)).any() else [0.0]
        lost = 1.0 - float(found["converged"].mean())
        return {"lost": Measured(lost), "campaign": Measured(float(np.median(off)))}

    def told_of_campaign(self, found: DataFrame) -> Iterator[str]:
        """How many runs are from which, and how many of those were solved again."""
        taken = [one.kept for one in found["run"] if not one.solved]
        if taken:
            off = apart_from_campaign(found)
            made = "; ".join(dict.fromkeys(f"{one.case}: {one.made}" for one in taken))
            yield (
                f"Taken from campaigns ({made}): {len(taken)} of {len(found)} runs; "
                f"solved again and held against them: {len(off)}, whose friction differs in any cycle by "
                f"{np.median(off):.2g} in the median and {np.max(off):.2g} at most."
            )


def apart_from_campaign(found: DataFrame) -> list[float]:
    """Of each run that is solved again the largest difference of the friction from that of a campaign, in any
    cycle that both have; NaN alone where there is none.
    """
    off = []
    for one in found["run"]:
        if one.solved and one.kept:
            pair = (
                each.tables["cycles"].get("friction_coefficient", ())
                for each in (one.result, one.kept.result)
            )
            off.append([abs(a - b) for a, b in zip(*pair, strict=False)])
    return [max(each) for each in off if each] or [NAN]


def solved_of(found: DataFrame) -> Any:
    """The runs of a frame that are no campaign's and converged: those of which there are all tables."""
    return found.loc[found["converged"] & found["run"].map(lambda one: one.solved), "run"]


def runs_table(caption: str, groups: Mapping[str, Iterable[Run]]) -> SmallTable:
    """Median and range of COLUMNS over the runs of each group that converged."""
    rows = []
    for name, runs in groups.items():
        every = list(runs)
        good = [one for one in every if one.result.converged]
        cells = (Spread.of([of(one) for one in good]).text for of in COLUMNS.values())
        rows.append((name, f"{len(good)} of {len(every)}", *cells))
    return SmallTable(f"{caption}: median and range", ("runs", "converged", *COLUMNS), rows)


class Statement(NamedTuple):
    """One sentence of the paper. low, high: of its measure, as asked; figure: of the paper; how:
    one of MEASURES and the materials; the largest of those before a sign, less or over the
    smallest of those behind it.
    """

    figure: str
    words: str
    measure: str
    low: float
    high: float
    how: str

    def of(self, measures: DataFrame) -> Any:
        """Its measure on each surface, NaN: says nothing there. measures: (measure, material) -> of each."""
        name, *materials = self.how.split()
        at = next((k for k, each in enumerate(materials) if each in "-/"), len(materials))
        own = measures[name][materials[:at]].max(axis=1, skipna=False)
        if at == len(materials):
            return own
        other = measures[name][materials[at + 1 :]].min(axis=1, skipna=False)
        return own - other if materials[at] == "-" else own / other

    def holds(self, value: float) -> bool:
        """Whether a value is what is asked for."""
        return self.low <= value <= self.high

    @property
    def asked(self) -> str:
        """What is asked for, for the reader."""
        if np.isinf(self.low) or np.isinf(self.high):
            return f"≤ {self.high:g}" if np.isinf(self.low) else f"≥ {self.low:g}"
        return f"{self.low:g} to {self.high:g}"


# 0.001 of a coefficient: a hundredth of the low one, more than the steps of a load that a few cells carry
TABLE = """\
13 | bulk: worn in the first six cycles | V(6)/V(25) | 0.9 | inf | early bulk
13 | bulk: hardly any wear later | wear per cycle, 11–25 over 1–6 | -inf | 0.05 | later bulk
13 | bulk: friction stays high, 0.17 | μ(25) | 0.14 | 0.2 | friction bulk
14 | curve A: wears linearly after the first cycles | R² of V, 5–25 | 0.95 | inf | straight curve-a
14 | curve A: friction falls | μ(25) − μ(1) | -inf | -0.001 | fallen curve-a
14 | curve A: friction below that of bulk | μ_A − μ_bulk | -inf | -0.001 | friction curve-a - bulk
15 | curve B: the whole surface protected | μ(25) | -inf | 0.105 | friction curve-b
15 | curve B: roughness falls more than with A | Sa_B/Sa_A | -inf | 0.999 | sa curve-b / curve-a
15 | curve B: still wears linearly | R² of V, 5–25 | 0.95 | inf | straight curve-b
16 | 5 % instead of 2 %: the same wear per cycle later | wear per cycle 11–25, ratio | 0.8 | 1.2 \
| steady curve-b-ductile / curve-b
16 | 5 % instead of 2 %: less volume | V(25), ratio | -inf | 0.999 | volume curve-b-ductile / curve-b
17 | hardening: wears as much as bulk | V(25), ratio | 0.5 | 2.0 | volume hardening / bulk
17 | hardening: still wears slowly | share of V, 21–25 | 0.001 | 0.2 | grown hardening
17 | hardening: friction falls | μ(25) − μ(1) | -inf | -0.001 | fallen hardening
13–17 | volume: hardening and bulk below A and B | largest over smallest | -inf | 0.999 \
| volume bulk hardening / curve-a curve-b
13–17 | friction: B below A and hardening | largest over smallest | -inf | 0.999 \
| friction curve-b / curve-a hardening
13–17 | friction: A and hardening below bulk | largest over smallest | -inf | 0.999 \
| friction curve-a hardening / bulk
"""
STATEMENTS = tuple(
    Statement(figure, words, measure, float(low), float(high), how)
    for figure, words, measure, low, high, how in parts_of(TABLE)
)


def measured(frame: DataFrame, by: Sequence[str], statements: Sequence[Statement] = STATEMENTS) -> DataFrame:
    """The measure of each statement (columns, by their words) on each surface, of which `by` are
    the parts of a key; NaN where it says nothing, or a run is missing or did not converge.
    """
    import pandas as pd

    words = [each.how.split() for each in statements]
    names = sorted({name for name, *_ in words})
    materials = sorted({each for _, *others in words for each in others} - {*"-/"})
    every = pd.MultiIndex.from_product([names, materials])
    wide = frame.pivot(index=list(by), columns="material", values=names).reindex(columns=every)
    return pd.DataFrame({each.words: each.of(wide.astype(float)) for each in statements})


HELD, FAILED, OPEN = "held", "failed", "not decided"


def judged(measures: DataFrame, statements: Sequence[Statement] = STATEMENTS) -> list[dict[str, Any]]:
    """What pages are told of each statement, of its measures on surfaces, see `measured`.

    by_agreement: held or failed where eight surfaces of ten agree; one on which it says nothing
    agrees with neither. by_median: nothing where no more than half of them say anything. none_on:
    surfaces without a value.
    """
    found = []
    for said in statements:
        values = tuple(measures[said.words].tolist())
        spread, of, holds = Spread.of(values), len(values), sum(map(said.holds, values))
        needed, median, agreed = max(AGREED * of, 1), OPEN, OPEN
        if max(holds, spread.n - holds) >= needed:
            agreed = HELD if holds >= needed else FAILED
        if 2 * spread.n > of:
            median = HELD if said.holds(spread.median) else FAILED
        found.append(
            {"figure": said.figure, "statement": said.words, "measure": said.measure, "asked": said.asked}
            | {"values": values, "holds_on": holds, "of": of, "none_on": of - spread.n}
            | {"by_median": median, "by_agreement": agreed}
        )
    return found


def statements_table(
    readings: Mapping[str, Sequence[Mapping[str, Any]]], of: str = "the statements on Figures 13 to 17"
) -> SmallTable:
    """Each statement with its verdicts. readings: name of a reading -> what is told of the statements; of:
    what the caption names.
    """
    columns, rows = ["Fig.", "statement of the paper", "measure", "asked"], []
    for name in readings:
        columns += [f"{name}: median (range)", "holds on surfaces", "by the median", "by agreement"]
    for said in zip(*readings.values(), strict=True):
        row = [said[0][key] for key in ("figure", "statement", "measure", "asked")]
        for one in said:
            silent = f", none on {one['none_on']}" * (one["none_on"] > 0)
            row += [Spread.of(one["values"]).text, f"{one['holds_on']} of {one['of']}{silent}"]
            row += [one["by_median"], one["by_agreement"]]
        rows.append(row)
    return SmallTable(
        f"Verdicts: {of}, by the median of the surfaces and by agreement of {100 * AGREED:.0f} % of them. "
        "“none on 2”: on two surfaces the statement has no value",
        columns,
        rows,
    )


def readings_of(
    frame: DataFrame, statements: Sequence[Statement] = STATEMENTS
) -> dict[str, list[dict[str, Any]]]:
    """Reading -> what is told of the statements; none without all materials, or with fewer cycles than
    they ask for.
    """
    return {
        reading: judged(measured(own, ["surface"], statements), statements)
        for reading, own in frame.groupby("reading", sort=False)
        if own["material"].nunique() >= len(NAMES) and own["run"].iloc[0].scene.loading.cycles >= LAST
    }


def together(readings: Mapping[str, Sequence[Mapping[str, Any]]]) -> list[SmallTable]:
    """Under how many readings each statement holds by the median, and which hold together under each."""
    numbered, under = list(enumerate(zip(*readings.values(), strict=True), start=1)), []
    for number, said in numbered:
        verdicts = [one["by_median"] for one in said]
        words = [said[0][key] for key in ("figure", "statement", "measure", "asked")]
        under.append((str(number), *words, *(str(verdicts.count(each)) for each in (HELD, FAILED, OPEN))))
    hold = []
    for name, said in readings.items():
        places = [
            [str(k) for k, one in enumerate(said, start=1) if one["by_median"] == verdict]
            for verdict in (HELD, OPEN)
        ]
        hold.append((name, str(len(places[0])), *map(", ".join, places)))
    columns = ("no.", "Fig.", "statement of the paper", "measure", "asked", HELD, FAILED, OPEN)
    by, heads = "(by the median of the surfaces)", ("reading", "how many", "numbers", f"{OPEN}: numbers")
    return [
        SmallTable(f"Under how many of {len(readings)} readings a statement holds {by}", columns, under),
        SmallTable(f"Which statements hold together {by}", heads, hold),
    ]
