# SPDX-License-Identifier: MIT
"""The film on a rough surface: Bosman & Schipper (2011), Table 1 and Fig. 3. Their measured surface is not
public, nor do they say against which body: a synthetic patch with its roughness takes its place, under steel
and under a rigid plane, and as smooth and as rough as the film is thick.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import SAM, Context, DataFrame, Plot, with_body, with_grid, with_keys
from verification.compare.verdicts import LIMIT, breaking_radius
from verification.figures.maps import rough_pressures
from verification.rows import CaseFile
from verification.runs.sampling import pressure_map

SCENE = "rough-patch"
GRIDS = {"quick": (64, 128), "full": (64, 128, 256, 512)}
WHITE, WHITE_GRIDS = 2e-6, {"quick": (128,), "full": (128, 256)}  # cut-off in m; four cells in it and more
SEEDS = (1, 2, 3, 4, 5)
FILM_YIELD = 0.67e9  # a third of the hardness, Bosman & Schipper (2011), section 4
SPREAD = tuple(product((80e9, 130e9), (60e-9, 100e-9, 160e-9)))  # Table 2
CRYSTALLINE = tuple(product((0.95, 0.9), (0.5e-6, 1e-6)))  # of Young's modulus, Fig. 4
SMOOTH, ROUGH = "smooth-steel", "rough-rigid"


def at(scene: Scene, n: int) -> Scene:
    """The same surface on n x n cells."""
    return with_grid(scene, cells=(n, n))


def rigid(scene: Scene) -> Scene:
    """Under a rigid plane."""
    return with_keys(scene, "counterbody", young=None, poisson=None)


def rougher(scene: Scene) -> Scene:
    """With all waves down to the cut-off WHITE."""
    return with_keys(scene, "surface", cutoff_short=WHITE)


def with_film(scene: Scene, thickness: float, **keys: float) -> Scene:
    """With another coating: the depths within the old film spread over its thickness, the others below it."""
    old, depths = scene.body.coating.thickness, scene.grid.depths
    inside = [z * thickness / old for z in depths if z <= old]
    scene = with_grid(scene, depths=(*inside, *(z for z in depths if z > thickness * 1.05)))
    return with_keys(scene, "body.coating", thickness=thickness, **keys)


def patches(base: Scene, level: str) -> dict[str, list[Scene]]:
    """What the surface is like and against what it is pressed -> scenes."""
    found = {
        SMOOTH: [at(base, n) for n in GRIDS[level]],
        ROUGH: [at(rigid(rougher(base)), n) for n in WHITE_GRIDS[level]],
        "smooth-rigid": [at(rigid(base), 128)],
        "rough-steel": [at(rougher(base), 128)],
    }
    if level == "quick":
        return found
    for name, scene in ((SMOOTH, base), (ROUGH, rigid(rougher(base)))):
        found |= {f"{name}-seed-{k}": [at(with_keys(scene, "surface", seed=k), 128)] for k in SEEDS}
    for young, thickness in SPREAD:
        name = f"{SMOOTH}-film-of-{young / 1e9:g}-GPa-{thickness * 1e9:g}-nm"
        found[name] = [at(with_film(base, thickness, young=young), 64)]
    for share, thickness in CRYSTALLINE:
        layer = {"young": share * base.body.young, "poisson": base.body.poisson}
        name = f"{SMOOTH}-layer-of-{100 * share:g}-percent-of-E-{thickness * 1e9:g}-nm"
        found[name] = [at(with_film(base, thickness, **layer), 64)]
    return found


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """The patch of the paper on finer and finer grids, a rougher one, other seeds, films and layers: what the
    film changes at equal force, and whether the claim holds; on the finest grids of the two the contact
    radius at which the film changes a sphere by LIMIT, beside that of the summit with the largest pressure.
    """
    for name, scenes in patches(context.scene(SCENE), context.level).items():
        for scene in scenes:
            cells = scene.grid.cells[0]
            result = context.solve(SAM, scene, f"{name}-{cells}")
            q = result.quantities
            changes = {"p": q["p_max_change"], "mises": q["mises_max_change"]}
            row = {"surface": name, "cells": cells, "p-max": q["p_max_bare_Pa"]}
            row |= {f"{of}-change": change for of, change in changes.items()}
            row |= {"mises bare": q["mises_max_bare_Pa"], "mises of the film": q["mises_max_film_Pa"]}
            row["over its yield stress"] = q["mises_max_film_Pa"] / FILM_YIELD
            row["summit [µm]"] = 1e6 * summit_radius(result)
            if name in (SMOOTH, ROUGH) and scene is scenes[-1]:
                row["film matters at [µm]"] = 1e6 * breaking_radius(scene)
            row["claim"] = "holds" if max(map(abs, changes.values())) <= LIMIT else "fails"
            if name == SMOOTH and scene is scenes[1]:
                bare = context.solve(SAM, with_body(scene, coating=None), "steel-bare")
                row |= {"result": result, "bare": bare}
            yield row


def spread(rows: DataFrame, column: str) -> float:
    """Range over the grids."""
    return float(np.ptp(rows[column].to_numpy()))


def size(rows: DataFrame, column: str) -> float:
    """Without its sign, on the finest grid."""
    return abs(rows[column].iloc[-1])


def pressure(file: CaseFile, frame: DataFrame) -> Plot:
    """Of the coated and the bare patch."""
    both = frame.dropna(subset="bare").iloc[0]
    (x, y, p), (_, _, bare) = pressure_map(both["result"]), pressure_map(both["bare"])
    words = (
        "Maps of the pressure with and without the film and their difference: the same spots, a bit larger "
        "and softer. The patch of the paper's Fig. 3a and c, on a surface like theirs; coated less bare."
    )
    drawing = rough_pressures(x, y, {"coated": p, "bare": bare})
    return Plot(drawing, "pressure", "Pressure on the rough patch", words)


def summit_radius(result: Result) -> float:
    """Contact radius in m of the sphere whose pressure has the curvature of the largest one here, of which p0
    (1 - r^2/(2 a^2)). Spots merge several summits; how far the pressure of one reaches is what a film is
    thick or thin against.
    """
    x, y, p = pressure_map(result)
    i, j = np.unravel_index(np.nanargmax(p), p.shape)
    i, j = (int(np.clip(k, 1, n - 2)) for k, n in zip((i, j), p.shape, strict=True))
    along_x = (p[i - 1, j] - 2 * p[i, j] + p[i + 1, j]) / (x[1] - x[0]) ** 2
    along_y = (p[i, j - 1] - 2 * p[i, j] + p[i, j + 1]) / (y[1] - y[0]) ** 2
    return math.sqrt(-2 * p[i, j] / (along_x + along_y))
