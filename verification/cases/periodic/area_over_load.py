# SPDX-License-Identifier: MIT
"""What area a rough surface that repeats has in contact over its load: elastic, as the cells become small,
and with a yield stress, beside a pressure that is cut off at a hardness.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Plasticity, Result, Scene
from sam.scene.surface import heights
from verification.cases.case import Context, Plot, with_body, with_grid, with_keys, with_loading
from verification.cases.recipes import initial_yield
from verification.figures.lines import PERCENT, Curve, curves
from verification.figures.style import BLACK
from verification.quantities import modulus_of
from verification.reference.capped import capped_pressure, rms_slope
from verification.rows import CaseFile
from verification.runs import models
from verification.runs.models import SAM

if TYPE_CHECKING:
    from pandas import DataFrame

GUESS = 2.15  # of A E* h'/F, by which pressures are chosen
SIDE = 80e-6  # of the patch in m
WAVES, CELLS = (4, 64), (512, 1024)  # of the elastic patch: longest and shortest wave in its side; cells
ELASTIC: Mapping[str, tuple[int, tuple[float, ...], tuple[int, ...]]] = {
    "quick": (2, (0.01, 0.05), ()),
    "full": (10, (0.01, 0.02, 0.05), (2048,)),
}
"""Seeds; shares asked to be in contact; cells of one surface on which the extrapolation is checked."""
YIELDING: Mapping[str, Mapping[str, Any]] = {
    "quick": {"indices": (1.0, 3.0, 8.0), "cells": (64,), "points": (128, 256)},
    "full": {"indices": (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0), "cells": (64, 128), "points": (256, 512)},
}
"""E* h' over the yield stress; cells in the side, 8 and 16 in the shortest wave; points of the cut-off."""
THEORIES = {"Persson": np.sqrt(8 / np.pi), "Bush, Gibson & Thomas": np.sqrt(2 * np.pi)}
HARDNESS = 3.0  # over the yield stress: Tabor
PRESSURE = 0.05  # over E* h', of the patch that yields: a tenth of it in contact if elastic


def _heights(scene: Scene, n: int) -> np.ndarray:
    x = ((np.arange(n) + 0.5) / n - 0.5) * SIDE
    return heights(scene.surface, x, x, (SIDE, SIDE))


def _slope(scene: Scene) -> float:
    """Rms slope of the surface, from its waves: points that carry them all."""
    return rms_slope(_heights(scene, 4 * round(SIDE / scene.surface.cutoff_short)), (SIDE, SIDE))


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Rows of elastic surfaces, a row a seed, a grid and a load, then of those that yield."""
    base = context.scene("rough-periodic")
    yield from _elastic(context, with_loading(with_body(base, plasticity=None), unload=False))
    yield from _yielding(context, base)


def _solved(scene: Scene) -> Result:
    result = models.solve(scene, SAM)
    if not result.converged:
        raise RuntimeError(f"{scene.title} ended {result.status}: {result.message}")
    return result


def _elastic(context: Context, base: Scene) -> Iterator[dict[str, Any]]:
    seeds, shares, finer = ELASTIC[context.level]
    long, short = (SIDE / each for each in WAVES)
    for seed in range(1, seeds + 1):
        rough = with_keys(base, "surface", seed=seed, cutoff_long=long, cutoff_short=short)
        slope, modulus = _slope(rough), modulus_of(base)
        for k, share in enumerate(shares):
            context.progress(f"{context.case}: seed {seed}", k + 1, len(shares))
            pressure, found = share / GUESS * modulus * slope, {}
            last = seed == 1 and share == shares[-1]
            for n in (*CELLS, *(finer if last else ())):
                scene = with_grid(rough, cells=(n, n), extent=(SIDE, SIDE), depths=(0.0,))
                result = _solved(with_loading(scene, mean_pressure=pressure))
                found[n] = float(result.quantities["contact_share"]) * GUESS / share
            row = {"sweep": "elastic", "model": "sam", "seed": seed, "asked": share, "slope": slope}
            row |= {f"on {n}": value for n, value in found.items()}
            row |= {"kappa": (kappa := _limit(*(found[n] for n in CELLS))), "share": kappa * share / GUESS}
            if last:
                maps = [_heights(rough, n) for n in CELLS]
                own = [np.mean(capped_pressure(h, (SIDE, SIDE), modulus, pressure) > 0.0) for h in maps]
                row["fourier"] = _limit(*own, 1) * GUESS / share
                if finer:
                    row["finer"] = _limit(found[CELLS[-1]], found[finer[0]])
            yield row


def _limit(coarse: float, fine: float, order: int = 2) -> float:
    """Of an area on cells that are halved: second order where edges are placed within cells, as SAM does,
    first where points are counted.
    """
    return float(fine + (fine - coarse) / (2**order - 1))


def _yielding(context: Context, base: Scene) -> Iterator[dict[str, Any]]:
    """SAM with two laws, elastic, and the pressure cut off, on the same cells; the limit of both grids."""
    how = YIELDING[context.level]
    swift, perfect = base.body.plasticity, Plasticity(law="perfect", yield_stress=initial_yield(base))
    strength, modulus, slope = initial_yield(base), modulus_of(base), _slope(base)
    for k, index in enumerate(how["indices"]):
        context.progress(f"{context.case}: yields", k + 1, len(how["indices"]))
        sq = base.surface.sq * index * strength / (modulus * slope)
        pressure = PRESSURE * index * strength
        scene = with_loading(with_keys(base, "surface", sq=sq), mean_pressure=pressure, unload=False)
        found: dict[str, list[float]] = {}
        for n in how["cells"]:
            on = with_grid(scene, cells=(n, n))
            for name, law in (("swift", swift), ("perfect", perfect), ("elastic", None)):
                result = _solved(with_body(on, plasticity=law))
                found.setdefault(name, []).append(float(result.quantities["contact_share"]))
        for n in how["points"]:
            cap = capped_pressure(
                _heights(scene, n), (SIDE, SIDE), modulus, pressure, hardness=HARDNESS * strength
            )
            found.setdefault("cap", []).append(float(np.mean(cap > 0.0)))
        shares = {name: _limit(v[0], v[-1], 1 if name == "cap" else 2) for name, v in found.items()}
        row = {"sweep": "yielding", "model": "sam", "index": index, "pressure": PRESSURE * index}
        row |= {name: shares[name] / PRESSURE for name in ("elastic", "swift", "perfect", "cap")}
        row |= {f"{name}-over-elastic": shares[name] / shares["elastic"] for name in ("swift", "perfect")}
        row |= {f"cap-over-{name}": shares["cap"] / shares[name] for name in ("swift", "perfect")}
        yield row


# what rows take, and the figure


def bar(rows: DataFrame, column: str) -> float:
    """Standard error of the mean over the seeds."""
    return float(rows[column].std() / np.sqrt(len(rows)))


def departs(rows: DataFrame, column: str) -> float:
    """E* h' over the yield stress from which on the area is a twentieth larger than the elastic one."""
    return float(np.exp(np.interp(1.05, rows[column], np.log(rows["index"].astype(float)))))


def area(file: CaseFile, frame: DataFrame) -> Plot:
    """A E* h'/F over the share in contact, elastic, and over the yield stress."""
    elastic, yielding = (frame[frame["sweep"] == name] for name in ("elastic", "yielding"))
    by_load = elastic.groupby("asked")
    mean, bars = by_load["kappa"].mean().to_numpy(), by_load["kappa"].sem().to_numpy()
    x, index = PERCENT * by_load["share"].mean().to_numpy(), yielding["index"].to_numpy(dtype=float)
    left = {"elastic": Curve(x, mean, ends=(mean - bars, mean + bars))}
    for (name, level), line in zip(THEORIES.items(), (":", "--"), strict=True):
        left[name] = Curve(x, np.full(x.size, level), look=_line(line))
    words = {
        "perfect": "perfect plasticity",
        "swift": "Swift's law",
        "cap": "cut off at 3 $\\sigma_y$",
        "elastic": "elastic",
    }
    right = {words[name]: Curve(index, yielding[name].to_numpy(dtype=float)) for name in words}
    right["3 $\\sigma_y$ everywhere"] = Curve(index, index / HARDNESS, look=_line("-."))
    titles = "$A E^* h'/F$, elastic", "$A E^* h'/F$ with a yield stress"
    axes = dict(zip(titles, ("share in contact [%]", "$E^* h'/\\sigma_y$"), strict=True))
    drawing = curves(dict(zip(titles, (left, right), strict=True)), axes, None)
    text = (
        f"The left panel shows the area over the load of {elastic['seed'].nunique()} elastic surfaces, mean "
        "and standard error, beside two theories; the right one that of one surface with less and less "
        f"yield stress, at a mean pressure of {PRESSURE} E* h'."
    )
    return Plot(drawing, "area", "Area over load, elastic and with a yield stress", text)


def _line(style: str) -> dict[str, Any]:
    return {"marker": "", "linestyle": style, "color": BLACK}
