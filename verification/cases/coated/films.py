# SPDX-License-Identifier: MIT
"""What a film changes under a sphere: a map over thickness and modulus, contact radii that break the claim of
a negligible film, and a film of a tenth of a cell and of ten.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sam.kernels import Lags
from sam.layered import LayeredPatches, Layers
from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_grid,
    with_mesh,
)
from verification.cases.recipes import coated_scene, film_under
from verification.figures.specials import change_maps
from verification.reference.coated_changes import (
    THIN,
    breaking_thickness,
    film_contact,
    mises_change,
    pressure_change,
)
from verification.references import changes_by_film, contact_of
from verification.runs import models
from verification.runs.sampling import pressure_map

if TYPE_CHECKING:
    import pandas as pd

SCENE, QUICK_MESH = "coated-sphere", 16
PAPER_RATIO, PAPER_FILM, FILM_YIELD = 80 / 210, 100e-9, 0.67e9
"""E1/E2, thickness in m and yield stress of the film in Pa: Bosman & Schipper (2011), Table 1, Fig. 3."""
COUNTER = {"rigid": math.inf, "steel": 1.0}
"""Contact modulus of the counter-body over the body's."""
CHANGES = {"p": pressure_change, "mises": mises_change}
WORDS = {"p": "largest pressure", "mises": "largest von Mises stress of the body"}
SIGNS = {"p": "p_max", "mises": "σvM"}


def changes_of(result: Result) -> dict[str, float]:
    """By the film, as shares of the values without it. RuntimeError if the model did not converge or has no
    contact without film to compare with.
    """
    found = {name: result.quantities[f"{name}_max_change"] for name in CHANGES}
    if not result.converged or None in found.values():
        said = " ".join((result.message, *result.warnings))
        raise RuntimeError(f"{result.model} ended {result.status}: {said}")
    return found


def percent(share: float) -> str:
    """A share in %, signed."""
    return f"{100 * share:+.2f}".replace("-", "\N{MINUS SIGN}")


# --- map ------------------------------------------------------------------------------------------------

THICKNESSES = {"quick": np.geomspace(0.02, 1.0, 2), "full": np.geomspace(0.01, 2.0, 13)}
MODULI = {"quick": np.geomspace(0.2, 5.0, 2), "full": np.geomspace(0.1, 10.0, 13)}
CELLS = 65
"""A side: 8 to 26 of them in the smaller of the contact radii with and without film."""
DEPTHS = 0.05 * np.arange(27)
"""Output depths below the interface, over the contact radius without film."""
RADII = (0.5e-6, 1e-6, 2e-6, 5e-6)
"""Contact radii in m at which the film of the paper is marked."""
BOTH = (
    *((PAPER_RATIO, 0.02, "rigid"), (PAPER_RATIO, 0.2, "steel"), (PAPER_RATIO, 0.065, "rigid")),
    *((PAPER_RATIO, 0.13, "steel"), (0.1, 0.05, "rigid"), (0.1, 0.5, "steel"), (0.2, 1.0, "rigid")),
    *((0.6, 2.0, "steel"), (2.0, 0.05, "steel"), (2.0, 0.5, "rigid"), (4.0, 0.1, "rigid")),
    *((4.0, 1.0, "steel"), (10.0, 0.02, "steel"), (10.0, 0.3, "rigid")),
)
"""(E1/E2, thickness, counter-body) solved by FEM as well; the first two at the quick level, on coarser
elements.
"""


def map_scene(base: Scene, ratio: float, thickness: float, counterbody: str) -> Scene:
    """The sphere of `base` on a film, with few cells and depths; thickness over the contact radius without
    film.
    """
    scene = coated_scene(base, ratio, thickness, counterbody)
    below = scene.body.coating.thickness + DEPTHS * contact_of(scene).contact_radius
    return with_grid(scene, cells=(CELLS, CELLS), depths=(0.0, *below))


@cache
def spectral(ratio: float, thickness: float, counterbody: str) -> dict[str, float]:
    """The changes in the spectral solution."""
    contact = film_contact(thickness, ratio, counter=COUNTER[counterbody])
    return {name: change(contact) for name, change in CHANGES.items()}


def row_of(at: tuple[float, float, str], **found: Mapping[str, float]) -> dict[str, float | str]:
    """A line of a frame: the film, and the changes by each model and in the spectral solution."""
    found = found | {"spectral": spectral(*at)}
    each = {f"{name} {model}": own[name] for name in CHANGES for model, own in found.items()}
    return dict(zip(("ratio", "thickness", "counterbody"), at, strict=True)) | each


def off(frame: pd.DataFrame, name: str, one: str, other: str) -> pd.Series:
    """Differences of a change between two columns."""
    return (frame[f"{name} {one}"] - frame[f"{name} {other}"]).abs()


class FilmMap(Case):
    """The maps under both counter-bodies, whose many solves are not kept one by one, and a few of their
    points by FEM.
    """

    def solve(self, context: Context) -> tuple[pd.DataFrame, pd.DataFrame]:
        from pandas import DataFrame

        base, quick, points = context.scene(SCENE), context.level == "quick", []
        base = with_mesh(base, QUICK_MESH) if quick else base
        for at in BOTH[:2] if quick else BOTH:
            scene, label = map_scene(base, *at), "{:.3g}-{:g}-{}".format(*at).replace(".", "-")
            runs = {
                name: context.solve(m, scene, f"{name}-{label}") for name, m in (("sam", SAM), ("fem", FEM))
            }
            points.append(row_of(at, **{name: changes_of(result) for name, result in runs.items()}))
        grid, maps = list(product(COUNTER, THICKNESSES[context.level], MODULI[context.level])), []
        for counterbody, thickness, modulus in grid:
            at = float(modulus), float(thickness), counterbody
            maps.append(row_of(at, sam=changes_of(models.solve(map_scene(base, *at), SAM))))
            context.progress(f"{context.case}: films", len(maps), len(grid))
        return DataFrame(maps), DataFrame(points)

    def measure(self, found: tuple[pd.DataFrame, pd.DataFrame]) -> dict[str, float]:
        maps, points = found
        values = {f"sam-{name}": off(maps, name, "sam", "spectral").max() for name in CHANGES}
        return values | {f"fem-{name}": off(points, name, "sam", "fem").max() for name in CHANGES}

    def setup(self, found: tuple[pd.DataFrame, pd.DataFrame]) -> Iterator[tuple[str, str]]:
        maps, _ = found
        for words, column in (("Thickness h/a₀", "thickness"), ("Ratio E₁/E₂", "ratio")):
            values = maps[column].unique()
            yield words, f"{values.size} from {values.min():g} to {values.max():g}"
        yield "Counter-body", "rigid, and of the material of the body; ν = 0.3 in all"
        yield "SAM", f"{CELLS} × {CELLS} cells, {DEPTHS.size} depths below the film, {DEPTHS[1]:g} a₀ apart"

    def tables(self, found: tuple[pd.DataFrame, pd.DataFrame]) -> Iterator[SmallTable]:
        maps, points = found
        rows = [
            (f"{row['ratio']:.3g}", f"{row['thickness']:g}", row["counterbody"], *map(percent, list(row)[3:]))
            for _, row in points.iterrows()
        ]
        heads = (f"{SIGNS[name]}, {m}" for name in CHANGES for m in ("SAM", "FEM", "spectral"))
        caption = "Change by the film in %, at equal force"
        yield SmallTable(caption, ("E₁/E₂", "h/a₀", "counter-body", *heads), rows)
        rows = []
        for name in CHANGES:
            at = maps.loc[off(maps, name, "sam", "spectral").idxmax()]
            place = f"h/a₀ = {at['thickness']:.3g}, E₁/E₂ = {at['ratio']:.3g}, {at['counterbody']}"
            rows.append((WORDS[name], percent(at[f"{name} sam"]), percent(at[f"{name} spectral"]), place))
        caption = "Where SAM and the spectral solution differ most over the maps"
        yield SmallTable(caption, ("change of", "SAM [%]", "spectral [%]", "at"), rows)

    def notes(self, found: tuple[pd.DataFrame, pd.DataFrame]) -> Iterator[str]:
        yield (
            "Both changes depend on h/a₀, E₁/E₂, Poisson's ratios and the ratio of the counter-body's "
            "modulus only: force and radius of the sphere enter through a₀ alone. An elastic counter-body is "
            "part of the compliance that the film does not change, so that a film matters less under steel "
            "than under a rigid body."
        )

    def figures(self, found: tuple[pd.DataFrame, pd.DataFrame]) -> Iterator[Plot]:
        maps, _ = found
        paper = PAPER_RATIO, {f"{1e6 * a:g} µm": PAPER_FILM / a for a in RADII}
        for counterbody, each in maps.groupby("counterbody"):
            if each["thickness"].nunique() < 4:  # too few for a map
                return
            panels = {
                words.capitalize().replace("mises", "Mises"): each.pivot(
                    index="thickness", columns="ratio", values=f"{name} sam"
                )
                for name, words in WORDS.items()
            }
            yield Plot(
                change_maps(panels, paper),
                str(counterbody),
                f"What a film changes, {counterbody} counter-body",
                "Two heat maps over thickness and modulus ratio of the film: change of the largest pressure "
                "and of the largest von Mises stress of the body. Soft films lower the pressure and stiff "
                "ones raise it, the stress of the body likewise under thin films; the lines of 1 % and 5 % "
                "run close to E1/E2 = 1 for thick films and spread for thin ones.",
                "SAM, at equal force. Lines: 1 % (dashed) and 5 % (solid). Green: the film of the paper, 100 "
                "nm and 80 GPa on steel, at contact radii of 0.5 to 5 µm.",
            )


# --- limits ---------------------------------------------------------------------------------------------

LIMITS = (0.05, 0.01)
RATIOS = {"quick": (PAPER_RATIO,), "full": (40 / 210, PAPER_RATIO, 130 / 210, 2.0, 4.0)}
SPREAD = tuple(product((80e9, 99e9, 130e9), (60e-9, 111e-9, 160e-9)))
"""Smallest, mean and largest of most films that Table 2 of the paper lists, in Pa and m (a few are 30 or 300
nm thick).
"""
OWN_RADII = {"quick": (1e-6,), "full": (5e-6, 2e-6, 1e-6, 0.5e-6)}
"""Contact radii in m at which the stress of the film itself is looked at."""


@cache
def broken_at(ratio: float, counterbody: str, limit: float, name: str) -> float:
    """Thickness over contact radius without film at which a change reaches the limit; NaN if the thinnest
    film passes it.
    """
    try:
        return breaking_thickness(ratio, counter=COUNTER[counterbody], limit=limit, change=CHANGES[name])
    except ValueError:
        return math.nan


@dataclass(frozen=True)
class BreakingRadii:
    """off: "sam", "fem" -> largest distance from a limit at the thicknesses where the spectral solution
    reaches it; own: counter-body, contact radius in m, result of SAM for the film of the paper.
    """

    level: str
    limits: Sequence[float]
    off: Mapping[str, float]
    own: Sequence[tuple[str, float, Result]]


class FilmLimits(Case):
    """Where the film of the paper breaks the claim; both models solved there, and at a few radii for its own
    stress.
    """

    def solve(self, context: Context) -> BreakingRadii:
        base, quick = context.scene(SCENE), context.level == "quick"
        base, limits = with_mesh(base, QUICK_MESH) if quick else base, LIMITS[: 1 if quick else 2]
        apart = {"sam": 0.0, "fem": 0.0}
        for other, limit, name in product(COUNTER, limits, CHANGES if not quick else ("p",)):
            radius = PAPER_FILM / broken_at(PAPER_RATIO, other, limit, name)
            scene, label = film_under(base, (other, radius, PAPER_FILM, PAPER_RATIO)), f"{other}-{name}"
            for short, model in (("sam", SAM), ("fem", FEM)):
                found = changes_of(context.solve(model, scene, f"{short}-{label}-{100 * limit:g}"))[name]
                apart[short] = max(apart[short], abs(abs(found) - limit))
        own = []
        for other, a in product(COUNTER, OWN_RADII[context.level]):
            label = f"sam-{other}-{1e6 * a:g}um".replace(".", "-")
            scene = film_under(base, (other, a, PAPER_FILM, PAPER_RATIO))
            own.append((other, a, context.solve(SAM, scene, label)))
        return BreakingRadii(context.level, limits, apart, own)

    def measure(self, found: BreakingRadii) -> dict[str, float]:
        return {f"{name}-at-limit": value for name, value in found.off.items()}

    def setup(self, found: BreakingRadii) -> Iterator[tuple[str, str]]:
        yield "Film", f"{PAPER_FILM * 1e9:g} nm, 80 GPa, on 210 GPa; ν = 0.3 in both"
        yield "Largest pressure without film", "6.5 GPa"
        yield "Counter-body", "sphere, rigid or of the material of the body"

    def tables(self, found: BreakingRadii) -> Iterator[SmallTable]:
        places = list(product(COUNTER, found.limits, CHANGES))
        rows = []
        for ratio in RATIOS[found.level]:
            thinnest = (broken_at(ratio, *at) for at in places)
            rows.append((f"{ratio:.3g}", *(f"below {THIN:g}" if h != h else f"{h:.4f}" for h in thinnest)))
        yield SmallTable(
            "Thickness over contact radius without film, h/a₀, at which the film changes so much",
            ("E₁/E₂", *(f"{other}, {100 * limit:g} % of {SIGNS[name]}" for other, limit, name in places)),
            rows,
        )
        films = SPREAD if found.level == "full" else [(PAPER_RATIO * 210e9, PAPER_FILM)]
        yield SmallTable(
            "Contact radius below which pressure or stress changes by more than 5 %, over the films of the "
            "paper's Table 2",
            ("E₁ [GPa]", "h [nm]", *(f"{other} [µm]" for other in COUNTER)),
            [
                (f"{E / 1e9:g}", f"{h * 1e9:g}", *(f"{1e6 * breaking_radius(E, h, c):.2f}" for c in COUNTER))
                for E, h in films
            ],
        )
        rows = []
        for other, radius, result in found.own:
            changes, q = changes_of(result), result.quantities
            stress = f"{q['mises_max_film_Pa'] / 1e9:.2f}", f"{q['mises_max_film_Pa'] / FILM_YIELD:.1f}"
            body = f"{q['mises_max_substrate_Pa'] / 1e9:.2f}"
            rows.append((f"{1e6 * radius:g}", other, *map(percent, changes.values()), *stress, body))
        yield SmallTable(
            "The film of the paper, elastic, at 6.5 GPa without it: changes, and what it carries (SAM)",
            (
                *("contact radius without film [µm]", "counter-body", "p_max [%]", "σvM of the body [%]"),
                *("σvM in the film [GPa]", "over its yield stress", "σvM in the body [GPa]"),
            ),
            rows,
        )

    def notes(self, found: BreakingRadii) -> Iterator[str]:
        radii = {other: breaking_radius(PAPER_RATIO * 210e9, PAPER_FILM, other) for other in COUNTER}
        words = " and ".join(
            f"{1e6 * radius:.2f} µm under a {other} sphere" for other, radius in radii.items()
        )
        yield (
            "The film of 100 nm and 80 GPa changes pressure and stress by less than 5 % on contact radii "
            f"above {words}."
        )
        shares = [result.quantities["mises_max_film_Pa"] / FILM_YIELD for *_, result in found.own]
        yield (
            "Negligible or not is said of pressure and body. The film itself, taken as elastic, carries "
            f"{min(shares):.1f} to {max(shares):.1f} times its yield stress of {FILM_YIELD / 1e9:g} GPa "
            "here: it would flow."
        )


def breaking_radius(young: float, thickness: float, counterbody: str) -> float:
    """Contact radius in m below which a film changes pressure or stress by more than 5 %."""
    return thickness / min(broken_at(young / 210e9, counterbody, LIMITS[0], name) for name in CHANGES)


# --- coarse and fine cells ------------------------------------------------------------------------------

PATCHES = {"coarse": (1e-6, 65, 8e-6), "fine": (10e-9, 251, 0.8e-6)}
"""Size of a cell in m, cells a side, contact radius without film in m: patches of 65 um and 2.5 um, eight and
eighty cells in the radius.
"""
PARTS = 101
"""Cells of 9.9 nm in a cell of 1 um, along each side; odd, so that they have its centre."""
LAGS = ((0, 0), (1, 0), (1, 1), (4, 2), (20, 1), (60, 0))
"""In cells of 1 um."""


def patch_scene(base: Scene, cell: float, cells: int, radius: float) -> Scene:
    """A rigid sphere on the film of the paper on one grid."""
    scene = film_under(base, ("rigid", radius, PAPER_FILM, PAPER_RATIO))
    depths = (0.0, 0.5 * PAPER_FILM, *(PAPER_FILM + radius * np.linspace(0.0, 1.0, 21)))
    return with_grid(scene, cells=(cells, cells), extent=(cells * cell,) * 2, depths=depths)


def alias(result: Result, wider: Result) -> float:
    """Largest change of the pressure by a wider patch, over the largest pressure: 0 if nothing repeats
    itself.
    """
    near, far = (pressure_map(each)[2] for each in (result, wider))
    x, y = (np.array(far.shape) - near.shape) // 2
    return float(np.abs(far[x : x + near.shape[0], y : y + near.shape[1]] - near).max() / near.max())


def unfinished(result: Result) -> int:
    """How many numbers of the fields are not finite."""
    fields = {
        "axis": ("mises_Pa", "sxx_Pa", "szz_Pa"),
        "line": ("p_Pa", "uz_m", "gap_m"),
        "plane": ("mises_Pa",),
    }
    values = [
        np.asarray(result.tables[t][name], dtype=float) for t, names in fields.items() for name in names
    ]
    return sum(int(np.size(v) - np.isfinite(v).sum()) for v in (*values, pressure_map(result)[2]))


def error_of_parts(kind: str) -> float:
    """Largest distance of a coefficient of a 1 um cell from the sum over its 9.9 nm parts, over the largest
    coefficient. kind: "displacement", or "stress": s_zz at the interface.
    """
    patches = LayeredPatches(Layers(PAPER_RATIO * 210e9, 0.3, PAPER_FILM, 210e9, 0.3))

    def coefficients(nx: int, ny: int, cell: float) -> np.ndarray:
        if kind == "displacement":
            return patches.displacement(Lags(nx, ny, cell, cell))
        return patches.stress(Lags(nx, ny, cell, cell), [PAPER_FILM], load=3, names=["33"])[0, 0]

    most = np.array(LAGS).max(axis=0)
    coarse = coefficients(*(most + 1), 1e-6)
    fine = coefficients(*((most + 1) * PARTS), 1e-6 / PARTS)
    offset = np.arange(PARTS) - PARTS // 2
    sums = [fine[np.ix_(np.abs(i * PARTS + offset), np.abs(j * PARTS + offset))].sum() for i, j in LAGS]
    whole = np.array([coarse[i, j] for i, j in LAGS])
    return float(np.abs(np.array(sums) - whole).max() / np.abs(coarse).max())


class ThinFilmGrids(Case):
    """Both grids solved, also on wider patches, and the coefficients of both grids against each other."""

    def solve(self, context: Context) -> dict[str, tuple[Scene, Result, Result]]:
        base, found = context.scene(SCENE), {}
        for name, (cell, cells, radius) in PATCHES.items():
            wider = cells + 2 * (cells // 4)
            scenes = {
                label: patch_scene(base, cell, n, radius) for n, label in ((cells, ""), (wider, "-wider"))
            }
            results = (context.solve(SAM, scene, f"{name}{label}") for label, scene in scenes.items())
            found[name] = (scenes[""], *results)
        return found

    def measure(self, found: dict[str, tuple[Scene, Result, Result]]) -> dict[str, Measured | float]:
        values: dict[str, Measured | float] = {
            "alias": max(alias(*results) for _, *results in found.values()),
            "parts-displacement": error_of_parts("displacement"),
            "parts-stress": error_of_parts("stress"),
            "unfinished": Measured(sum(unfinished(r) for _, *results in found.values() for r in results), 0),
        }
        for name, (scene, result, _) in found.items():
            pairs = zip(changes_of(result).items(), changes_by_film(scene), strict=True)
            values |= {f"{name}-{change}": abs(ours - exact) for (change, ours), exact in pairs}
        return values

    def setup(self, found: dict[str, tuple[Scene, Result, Result]]) -> Iterator[tuple[str, str]]:
        yield "Film", f"{PAPER_FILM * 1e9:g} nm, 80 GPa, on 210 GPa"
        yield "Sphere", "rigid, 6.5 GPa without film"
        yield (
            "Parts of a cell",
            f"{PARTS} × {PARTS} of 9.9 nm in 1 µm, at lags of {', '.join(map(str, LAGS))} µm",
        )


CASES = (FilmMap("film-map"), FilmLimits("film-limits"), ThinFilmGrids("thin-film-grids"))
