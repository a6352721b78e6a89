# SPDX-License-Identifier: MIT
"""The film on a rough surface: the layered calculation of Bosman & Schipper (2011), Table 1 and Fig. 3, and
where it ends.

Their surface is a measurement that is not public, and they do not say against which body it is pressed: a
synthetic patch with its roughness takes its place, under steel and under a rigid plane, and as smooth and as
rough as the film is thick.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import sam
from sam.contact import stresses, von_mises
from sam.grid import Window
from sam.scene import Coating, Result, Scene
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
from verification.figures.rough import pressures, sections
from verification.runs.sampling import pressure_map

SCENE = "rough-patch"
GRIDS = {"quick": (64, 128), "full": (64, 128, 256, 512)}
WHITE, WHITE_GRIDS = 2e-6, {"quick": (128,), "full": (128, 256)}  # cut-off in m; four cells in it and more
SEEDS = (1, 2, 3, 4, 5)
PAPER = {"p_max": 6.5e9, "change": -0.015}  # Fig. 3: 6.5 to 6.4 GPa, and 3.55 to 3.5 GPa of von Mises stress
FILM_YIELD = 0.67e9  # a third of the hardness, Bosman & Schipper (2011), section 4
SPREAD = (
    (80e9, 60e-9),
    (80e9, 100e-9),
    (80e9, 160e-9),
    (130e9, 60e-9),
    (130e9, 100e-9),
    (130e9, 160e-9),
)  # Table 2
CRYSTALLINE = tuple(
    (share, depth) for share in (0.95, 0.9) for depth in (0.5e-6, 1e-6)
)  # of Young's modulus, Fig. 4


@dataclass(frozen=True)
class Patches:
    """The patch of the paper in all its variants.

    smooth, white: grids of the patch under steel, and of the rougher one under a rigid plane; others: by
    name; seeds, films, layers: rows of their tables, none at the quick level; shown: the scene that is drawn,
    its coated and bare result.
    """

    base: Scene
    smooth: Sequence[Result]
    white: Sequence[Result]
    others: Mapping[str, tuple[Scene, Result]]
    extra: Sequence[SmallTable]
    shown: tuple[Scene, Result, Result]


class RoughFilm(Case):
    """The patch of the paper on finer and finer grids, a rougher one, other seeds, films and layers; maps and
    sections.
    """

    def solve(self, context: Context) -> Patches:
        base, grids = context.scene(SCENE), GRIDS[context.level]
        white = WHITE_GRIDS[context.level]
        others = {"smooth, rigid": rigid(base), "rough, steel": rougher(base, keep_body=True)}
        smooth = [context.solve(SAM, at(base, n), f"steel-{n}") for n in grids]
        shown = at(base, grids[1])
        return Patches(
            base,
            smooth,
            [context.solve(SAM, at(rougher(base), n), f"white-rigid-{n}") for n in white],
            {n: (scene, context.solve(SAM, at(scene, 128), label(n))) for n, scene in others.items()},
            [table(context, base) for table in EXTRA[context.level]],
            (shown, smooth[1], context.solve(SAM, with_body(shown, coating=None), "steel-bare")),
        )

    def measure(self, found: Patches) -> dict[str, Measured]:
        return gates(found.smooth, found.white)

    def setup(self, found: Patches) -> list[tuple[str, str]]:
        scene, first = found.base, found.smooth[0].discretisation
        body, film, surface = scene.body, scene.body.coating, scene.surface
        return [
            (
                "Film",
                f"{film.thickness * 1e9:g} nm of {film.young / 1e9:g} GPa on {body.young / 1e9:g} GPa, both "
                "ν = 0.3",
            ),
            (
                "Surface",
                f"hard-turned, Ra = {surface.ra * 1e6:g} µm, feed {surface.feed * 1e6:g} µm, seed "
                f"{surface.seed}",
            ),
            ("Shortest wave", f"{surface.cutoff_short * 1e6:g} µm (smooth), {WHITE * 1e6:g} µm (rough)"),
            ("Patch", "64 × 64 µm, the same surface on every grid; heights fall off at the border"),
            ("Load", f"{scene.loading.force:g} N, μ = {scene.coefficient:g}, against steel or a rigid plane"),
            ("Cells in contact", f"{first['contact_cells']} of {64 * 64} on the coarsest grid"),
        ]

    def tables(self, found: Patches) -> list[SmallTable]:
        rows = [row("smooth, steel", found.base, each) for each in found.smooth]
        rows += [row("rough, rigid", rougher(found.base), each) for each in found.white]
        rows += [row(name, *pair) for name, pair in found.others.items()]
        return [SmallTable("What the film changes, at equal force", COLUMNS, rows), *found.extra]

    def notes(self, found: Patches) -> list[str]:
        return [why(found.base, found.smooth[-1], found.white[-1])]

    def figures(self, found: Patches) -> Iterator[Plot]:
        scene, coated, uncoated = found.shown
        (x, y, p), (_, _, p_bare) = pressure_map(coated), pressure_map(uncoated)
        yield Plot(
            pressures(x, y, p, p_bare),
            "pressure",
            "Pressure on the rough patch",
            "Maps of the pressure with and without the film and their difference: the same spots, slightly "
            "larger and softer.",
            "The patch of the paper's Fig. 3a and c, on a surface like theirs. Coated first; difference: "
            "coated less bare.",
        )
        j = int(np.unravel_index(np.argmax(p_bare), p_bare.shape)[1])
        depths = np.array([z for z in scene.grid.depths if z <= 4e-6])
        fields = [
            section(each, p_of, j, depths)
            for each, p_of in ((scene, p), (with_body(scene, coating=None), p_bare))
        ]
        yield Plot(
            sections(x, depths, *fields, thickness=scene.body.coating.thickness),
            "mises",
            "Von Mises stress under the rough patch",
            "Sections of the von Mises stress under the largest pressure, coated and bare; they differ most "
            "in the film.",
            f"At y = {y[j] * 1e6:.1f} µm, where the pressure is largest (Fig. 3b and d). Sliding along +x.",
        )


def at(scene: Scene, n: int) -> Scene:
    """The same surface on n x n cells."""
    return with_grid(scene, cells=(n, n))


def rigid(scene: Scene) -> Scene:
    """Under a rigid plane."""
    return with_keys(scene, "counterbody", young=None, poisson=None)


def rougher(scene: Scene, keep_body: bool = False) -> Scene:
    """With all waves down to the cut-off WHITE, under a rigid plane."""
    changed = with_keys(scene, "surface", cutoff_short=WHITE)
    return changed if keep_body else rigid(changed)


def with_film(scene: Scene, **keys) -> Scene:
    """With another coating."""
    return with_keys(scene, "body.coating", **keys)


def label(name: str) -> str:
    """For a folder."""
    return name.replace(", ", "-")


def gates(smooth: Sequence[Result], white: Sequence[Result]) -> dict[str, Measured]:
    """The patch of the paper on its coarsest grid, what refinement changes, and the rough patch that breaks
    the claim.
    """
    first, last = smooth[0].quantities, white[-1].quantities
    values = {"p-max": Measured(first["p_max_bare_Pa"], PAPER["p_max"], unit="Pa")}
    for name, key in (("p", "p_max_change"), ("mises", "mises_max_change")):
        changes = [result.quantities[key] for result in smooth]
        values[f"{name}-change"] = Measured(changes[0], PAPER["change"])
        values[f"{name}-refined"] = Measured(float(np.ptp(changes)))
        values[f"{name}-white"] = Measured(abs(last[key]))
    return values


COLUMNS = (
    *(
        "surface, against",
        "cells",
        "p_max bare [GPa]",
        "coated [GPa]",
        "change",
        "von Mises bare [GPa]",
        "change of the body's",
    ),
    *("von Mises in the film [GPa]", "over its yield stress", "radius of the summit [µm]", "claim"),
)


def row(name: str, scene: Scene, result: Result) -> tuple[str, ...]:
    """One line of the table; the summit is that with the largest pressure."""
    q, cells = result.quantities, result.discretisation["cells"]
    holds = max(abs(q["p_max_change"]), abs(q["mises_max_change"])) <= LIMIT
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
        "holds" if holds else "FAILS",
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


def why(base: Scene, smooth: Result, white: Result) -> str:
    """What decides: the size of the summits against the radius of the sphere that breaks the limit."""
    words = []
    for name, scene, result in (("steel", base, smooth), ("rigid", rougher(base), white)):
        q = result.quantities
        worst = max(abs(q["p_max_change"]), abs(q["mises_max_change"]))
        broken = worst > LIMIT
        words.append(
            f"Against the {name} plane the largest pressure is curved like that of a sphere with a contact "
            f"radius of {summit_radius(result) * 1e6:.2g} µm, and the film changes a sphere by {LIMIT:.0%} "
            f"at one of {breaking_radius(scene) * 1e6:.2g} µm. The change here is {worst:.1%}: the claim "
            f"{'FAILS' if broken else 'holds'}."
        )
    return " ".join(words) + (
        " The film is negligible where the summits are wide against it, which the sampling of a measured "
        "surface decides: with waves as short as a few micrometres it is not. Its own stress is beyond its "
        "yield stress in all of them."
    )


def seeds_table(context: Context, base: Scene) -> SmallTable:
    """The same statistics, other surfaces."""
    rows = []
    for name, scene in (("smooth, steel", base), ("rough, rigid", rougher(base))):
        for seed in SEEDS:
            drawn = with_keys(scene, "surface", seed=seed)
            result = context.solve(SAM, at(drawn, 128), f"{label(name)}-seed-{seed}")
            rows.append((f"{seed}", *row(name, drawn, result)))
    return SmallTable("Other surfaces of the same roughness", ("seed", *COLUMNS), rows)


def films_table(context: Context, base: Scene) -> SmallTable:
    """The range of films in the paper's Table 2."""
    rows = []
    for young, thickness in SPREAD:
        scene = at(with_film(with_depths(base, thickness), young=young, thickness=thickness), 64)
        result = context.solve(SAM, scene, f"film-{young / 1e9:g}-{thickness * 1e9:g}")
        cells = row("smooth, steel", scene, result)
        rows.append((f"{young / 1e9:g} GPa", f"{thickness * 1e9:g} nm", *cells[4:7], cells[-1]))
    return SmallTable(
        "Films as thick and stiff as the literature in the paper's Table 2 has them",
        ("Young's modulus", "thickness", *COLUMNS[4:7], COLUMNS[-1]),
        rows,
    )


def layers_table(context: Context, base: Scene) -> SmallTable:
    """A nano-crystalline layer with a lower Young's modulus in place of the film (Fig. 4)."""
    rows = []
    for share, thickness in CRYSTALLINE:
        layer = Coating(thickness=thickness, young=share * base.body.young, poisson=base.body.poisson)
        scene = with_depths(base, thickness)
        scene = at(with_body(scene, coating=layer), 64)
        result = context.solve(SAM, scene, f"layer-{share:g}-{thickness * 1e9:g}")
        cells = row("smooth, steel", scene, result)
        rows.append((f"{share - 1:+.0%}", f"{thickness * 1e6:g} µm", *cells[4:7], cells[-1]))
    return SmallTable(
        "A nano-crystalline layer that is softer than the bulk, as its porosity may make it",
        ("Young's modulus", "thickness", *COLUMNS[4:7], COLUMNS[-1]),
        rows,
    )


def with_depths(scene: Scene, thickness: float) -> Scene:
    """With the depths within the old film spread over one of this thickness, the others below it."""
    old = scene.body.coating.thickness
    inside = [z * thickness / old for z in scene.grid.depths if z <= old]
    return with_grid(scene, depths=(*inside, *(z for z in scene.grid.depths if z > thickness * 1.05)))


def section(scene: Scene, pressure: np.ndarray, j: int, depths: np.ndarray) -> np.ndarray:
    """Von Mises stress in the row j of cells, (nx, nz) in Pa, of the pressure (nx, ny) and its traction."""
    (nx, ny), (lx, ly) = scene.grid.cells, scene.grid.extent
    tractions = {3: pressure, 1: scene.coefficient * pressure}
    layered = sam.plan(scene).coated.layered if scene.body.coating else None
    stress = stresses(
        tractions, (lx / nx, ly / ny), depths, Window(0, j, nx, 1), nu=scene.body.poisson, layered=layered
    )
    return von_mises(stress)[:, :, 0].T


EXTRA = {"quick": (), "full": (seeds_table, films_table, layers_table)}
"""Tables of the levels besides that of all grids."""
CASES = (RoughFilm("rough-film"),)
