# SPDX-License-Identifier: MIT
"""The film on a rough surface: the layered calculation of Bosman & Schipper (2011), Table 1 and Fig. 3, and
where it ends.

Their surface is a measurement that is not public, and they do not say against which body it is pressed: a
synthetic patch with its roughness takes its place, under steel and under a rigid plane, and as smooth and as
rough as the film is thick.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

import sam
from sam.contact import stresses, von_mises
from sam.grid import Window
from sam.scene import Result, Scene
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    number,
    with_body,
    with_grid,
    with_keys,
)
from verification.compare.verdicts import LIMIT, breaking_radius
from verification.figures.maps import rough_pressures, sections
from verification.runs.sampling import pressure_map

SCENE = "rough-patch"
GRIDS = {"quick": (64, 128), "full": (64, 128, 256, 512)}
WHITE, WHITE_GRIDS = 2e-6, {"quick": (128,), "full": (128, 256)}  # cut-off in m; four cells in it and more
SEEDS = (1, 2, 3, 4, 5)
PAPER = {"p_max": 6.5e9, "change": -0.015}  # Fig. 3: 6.5 to 6.4 GPa, and 3.55 to 3.5 GPa of von Mises stress
FILM_YIELD = 0.67e9  # a third of the hardness, Bosman & Schipper (2011), section 4
SPREAD = tuple(product((80e9, 130e9), (60e-9, 100e-9, 160e-9)))  # Table 2
CRYSTALLINE = tuple(product((0.95, 0.9), (0.5e-6, 1e-6)))  # of Young's modulus, Fig. 4
SMOOTH, ROUGH = "smooth, steel", "rough, rigid"
COLUMNS = (
    *("surface, against", "cells", "p_max bare [GPa]", "coated [GPa]", "change", "von Mises bare [GPa]"),
    *("change of the body's", "von Mises in the film [GPa]", "over its yield stress"),
    *("radius of the summit [µm]", "claim"),
)


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
        "smooth, rigid": [at(rigid(base), 128)],
        "rough, steel": [at(rougher(base), 128)],
    }
    if level == "quick":
        return found
    for name, scene in ((SMOOTH, base), (ROUGH, rigid(rougher(base)))):
        found |= {f"{name}, seed {k}": [at(with_keys(scene, "surface", seed=k), 128)] for k in SEEDS}
    for young, thickness in SPREAD:
        name = f"{SMOOTH}, film of {young / 1e9:g} GPa and {thickness * 1e9:g} nm"
        found[name] = [at(with_film(base, thickness, young=young), 64)]
    for share, thickness in CRYSTALLINE:
        layer = {"young": share * base.body.young, "poisson": base.body.poisson}
        name = f"{SMOOTH}, {thickness * 1e6:g} µm of nano-crystalline steel, E {share - 1:+.0%}"
        found[name] = [at(with_film(base, thickness, **layer), 64)]
    return found


@dataclass(frozen=True)
class Patches:
    """Of each patch the results on its grids. shown: the scene that is drawn, its coated and bare result."""

    scenes: Mapping[str, Sequence[Scene]]
    results: Mapping[str, Sequence[Result]]
    shown: tuple[Scene, Result, Result]


class RoughFilm(Case):
    """The patch of the paper on finer and finer grids, a rougher one, other seeds, films and layers; maps and
    sections.
    """

    def solve(self, context: Context) -> Patches:
        scenes, results = patches(context.scene(SCENE), context.level), {}
        for name, on_grids in scenes.items():
            label = re.sub(r"[^a-z0-9-]+", "-", name.lower()).strip("-")
            results[name] = [context.solve(SAM, s, f"{label}-{s.grid.cells[0]}") for s in on_grids]
        shown = scenes[SMOOTH][1]
        bare = context.solve(SAM, with_body(shown, coating=None), "steel-bare")
        return Patches(scenes, results, (shown, results[SMOOTH][1], bare))

    def measure(self, found: Patches) -> dict[str, Measured | float]:
        smooth, last = found.results[SMOOTH], found.results[ROUGH][-1].quantities
        bare = smooth[0].quantities["p_max_bare_Pa"]
        values: dict[str, Measured | float] = {"p-max": Measured(bare, PAPER["p_max"], unit="Pa")}
        for name, key in (("p", "p_max_change"), ("mises", "mises_max_change")):
            changes = [result.quantities[key] for result in smooth]
            values[f"{name}-change"] = Measured(changes[0], PAPER["change"])
            values |= {f"{name}-refined": float(np.ptp(changes)), f"{name}-white": abs(last[key])}
        return values

    def tables(self, found: Patches) -> Iterator[SmallTable]:
        rows = [row(name, result) for name, results in found.results.items() for result in results]
        yield SmallTable("What the film changes, at equal force", COLUMNS, rows)

    def notes(self, found: Patches) -> Iterator[str]:
        for name, words in ((SMOOTH, "steel"), (ROUGH, "rigid")):
            result, scene = found.results[name][-1], found.scenes[name][-1]
            yield (
                f"Against the {words} plane the largest pressure is curved like that of a sphere with a "
                f"contact radius of {summit_radius(result) * 1e6:.2g} µm, and the film changes a sphere by "
                f"{LIMIT:.0%} at one of {breaking_radius(scene) * 1e6:.2g} µm. The change here is "
                f"{largest_change(result):.1%}: the claim {verdict(result)}."
            )
        yield from self.file.notes

    def figures(self, found: Patches) -> Iterator[Plot]:
        scene, coated, uncoated = found.shown
        (x, y, p), (_, _, p_bare) = pressure_map(coated), pressure_map(uncoated)
        yield Plot(
            rough_pressures(x, y, {"coated": p, "bare": p_bare}),
            "pressure",
            "Pressure on the rough patch",
            "Maps of the pressure with and without the film and their difference: the same spots, slightly "
            "larger and softer.",
            "The patch of the paper's Fig. 3a and c, on a surface like theirs. Coated first; difference: "
            "coated less bare.",
        )
        j = int(np.unravel_index(np.argmax(p_bare), p_bare.shape)[1])
        depths = np.array([z for z in scene.grid.depths if z <= 4e-6])
        bodies = (scene, p), (with_body(scene, coating=None), p_bare)
        fields = [section(each, p_of, j, depths) for each, p_of in bodies]
        yield Plot(
            sections(x, depths, *fields, thickness=scene.body.coating.thickness),
            "mises",
            "Von Mises stress under the rough patch",
            "Sections of the von Mises stress under the largest pressure, coated and bare; they differ most "
            "in the film.",
            f"At y = {y[j] * 1e6:.1f} µm, where the pressure is largest (Fig. 3b and d). Sliding along +x.",
        )


def largest_change(result: Result) -> float:
    """Of pressure and stress by the film, as a share."""
    return max(abs(result.quantities[key]) for key in ("p_max_change", "mises_max_change"))


def verdict(result: Result) -> str:
    """What becomes of the claim."""
    return "holds" if largest_change(result) <= LIMIT else "FAILS"


def row(name: str, result: Result) -> tuple[str, ...]:
    """One line of the table; the summit is that with the largest pressure."""
    q, cells = result.quantities, result.discretisation["cells"]
    return (
        name,
        f"{cells[0]} × {cells[1]}",
        *(number(q[key] * 1e-9, 4) for key in ("p_max_bare_Pa", "p_max_Pa")),
        f"{q['p_max_change']:+.2%}",
        number(q["mises_max_bare_Pa"] * 1e-9, 4),
        f"{q['mises_max_change']:+.2%}",
        number(q["mises_max_film_Pa"] * 1e-9, 4),
        f"{q['mises_max_film_Pa'] / FILM_YIELD:.1f}",
        number(summit_radius(result) * 1e6, 3),
        verdict(result),
    )


def summit_radius(result: Result) -> float:
    """Contact radius in m of the sphere whose pressure has the curvature of the largest one here, of which p0
    (1 - r^2/(2 a^2)).

    Spots merge several summits; how far the pressure of one reaches is what a film is thick or thin against.
    """
    x, y, p = pressure_map(result)
    i, j = np.unravel_index(np.nanargmax(p), p.shape)
    i, j = (int(np.clip(k, 1, n - 2)) for k, n in zip((i, j), p.shape, strict=True))
    along_x = (p[i - 1, j] - 2 * p[i, j] + p[i + 1, j]) / (x[1] - x[0]) ** 2
    along_y = (p[i, j - 1] - 2 * p[i, j] + p[i, j + 1]) / (y[1] - y[0]) ** 2
    return math.sqrt(-2 * p[i, j] / (along_x + along_y))


def section(scene: Scene, pressure: np.ndarray, j: int, depths: np.ndarray) -> np.ndarray:
    """Von Mises stress in the row j of cells, (nx, nz) in Pa, of the pressure (nx, ny) and its traction."""
    (nx, ny), (lx, ly) = scene.grid.cells, scene.grid.extent
    tractions = {3: pressure, 1: scene.coefficient * pressure}
    layered = sam.plan(scene).coated.layered if scene.body.coating else None
    stress = stresses(
        tractions, (lx / nx, ly / ny), depths, Window(0, j, nx, 1), nu=scene.body.poisson, layered=layered
    )
    return von_mises(stress)[:, :, 0].T


CASES = (RoughFilm("rough-film"),)
