# SPDX-License-Identifier: MIT
"""What area a rough surface that repeats has in contact over its load: elastic, as the cells become small, and
with a yield stress, beside a pressure that is cut off at a hardness.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sam.scene import Plasticity, Result, Scene
from sam.scene.surface import heights
from verification.cases.case import Context, Plot, with_body, with_grid, with_keys, with_loading
from verification.cases.recipes import initial_yield
from verification.figures.lines import PLAIN, Curve, curves
from verification.quantities import modulus_of
from verification.reference.capped import capped_pressure, rms_slope
from verification.rows import CaseFile
from verification.runs import models
from verification.runs.models import SAM

SHARES = (0.01, 0.02, 0.03, 0.04, 0.05)  # asked of the surface to be in contact, elastic
GUESS = 2.15  # of A E* h'/F, by which pressures are chosen
SIDE = 80e-6  # of the patch
ELASTIC: Mapping[str, Mapping[str, Any]] = {
    "quick": {"seeds": 2, "waves": (4, 16), "cells": (128, 256)},
    "full": {"seeds": 10, "waves": (4, 64), "cells": (512, 1024)},
}
"""Seeds, longest and shortest wave in the side, cells in the side: 8 and 16 in the shortest wave."""
FINEST = 2048
YIELDING: Mapping[str, Mapping[str, Any]] = {
    "quick": {"indices": (1.0, 8.0), "cells": (64,)},
    "full": {"indices": (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0), "cells": (64, 128)},
}
"""E* h' over the yield stress, and cells in the side: 8 and 16 in the shortest wave."""
HARDNESS = 3.0  # over the yield stress: Tabor
PRESSURE = 0.05  # over E* h', of the patch that yields: a tenth of it in contact if elastic
LAYERS = (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 13.0)  # faces in 1/128 of the side


def _heights(scene: Scene, n: int) -> np.ndarray:
    x = ((np.arange(n) + 0.5) / n - 0.5) * SIDE
    return heights(scene.surface, x, x, (SIDE, SIDE))


def _slope(scene: Scene) -> float:
    """Rms slope of the surface, from its waves: points that carry them all."""
    return rms_slope(_heights(scene, 4 * round(SIDE / scene.surface.cutoff_short)), (SIDE, SIDE))


def _rough(base: Scene, seed: int, waves: tuple[int, int], n: int) -> Scene:
    long, short = (SIDE / each for each in waves)
    scene = with_keys(base, "surface", seed=seed, cutoff_long=long, cutoff_short=short)
    return with_grid(scene, cells=(n, n), extent=(SIDE, SIDE), depths=(0.0,))


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
    how = ELASTIC[context.level]
    coarse, fine = how["cells"]
    for seed in range(1, how["seeds"] + 1):
        for k, share in enumerate(SHARES):
            context.progress(f"{context.case}: seed {seed}", k + 1, len(SHARES))
            found = {}
            for n in (coarse, fine, *[FINEST] * (seed == 1 and share == SHARES[-1] and fine > 256)):
                scene = _rough(base, seed, how["waves"], n)
                slope = _slope(scene)
                pressure = share / GUESS * modulus_of(scene) * slope
                result = _solved(with_loading(scene, mean_pressure=pressure))
                found[n] = float(result.quantities["contact_share"]) * GUESS / share
            row = {"sweep": "elastic", "model": "sam", "seed": seed, "asked": share, "slope": slope}
            limit = 2.0 * found[fine] - found[coarse]  # first order: the outermost cells of spots
            row |= {
                "share": limit * share / GUESS,
                "kappa": limit,
                "coarse": found[coarse],
                "fine": found[fine],
            }
            if FINEST in found:
                row |= {"halves": (found[fine] - found[FINEST]) / (found[coarse] - found[fine])}
                row |= {"finer": 2.0 * found[FINEST] - found[fine]}
            yield row


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
            faces = tuple(z * SIDE / 128 * max(1, 128 // n) for z in LAYERS)
            on = with_grid(scene, cells=(n, n), depths=faces)
            for name, law in (("swift", swift), ("perfect", perfect), ("elastic", None)):
                result = _solved(with_body(on, plasticity=law))
                found.setdefault(name, []).append(float(result.quantities["contact_share"]))
                if law:
                    found.setdefault(f"{name} p-max", []).append(result.quantities["p_max_Pa"] / strength)
            cap = capped_pressure(
                _heights(on, n), (SIDE, SIDE), modulus, pressure, hardness=HARDNESS * strength
            )
            found.setdefault("cap", []).append(float(np.mean(cap > 0.0)))
        shares = {name: 2.0 * v[-1] - v[0] if len(v) > 1 else v[0] for name, v in found.items()}
        row = {"sweep": "yielding", "model": "sam", "index": index, "pressure": PRESSURE * index}
        row |= {name: shares[name] / PRESSURE for name in ("elastic", "swift", "perfect", "cap")}
        row |= {f"{name} over elastic": shares[name] / shares["elastic"] for name in ("swift", "perfect")}
        row |= {f"cap over {name}": shares["cap"] / shares[name] for name in ("swift", "perfect")}
        yield row | {f"p-max {name}": found[f"{name} p-max"][-1] for name in ("swift", "perfect")}
