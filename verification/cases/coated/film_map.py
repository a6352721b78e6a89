# SPDX-License-Identifier: MIT
"""Map of what a film changes under a sphere: largest pressure and von Mises stress over thickness and
modulus.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Plot,
    SmallTable,
    number,
    with_grid,
    with_mesh,
)
from verification.cases.coated.coated_sphere import coated_scene
from verification.figures.coated import Map, PaperCase, change_maps
from verification.reference.coated_changes import film_contact, mises_change, pressure_change
from verification.references import contact_of
from verification.runs import models

PAPER_RATIO, PAPER_FILM = 80 / 210, 100e-9
"""E1/E2 and thickness in m: Bosman & Schipper (2011), Table 1."""
COUNTER = {"rigid": math.inf, "steel": 1.0}
"""Contact modulus of the counter-body over the body's."""
THICKNESSES = {"quick": np.geomspace(0.02, 1.0, 2), "full": np.geomspace(0.01, 2.0, 13)}
MODULI = {"quick": np.geomspace(0.2, 5.0, 2), "full": np.geomspace(0.1, 10.0, 13)}
CELLS = 65
"""A side: 8 to 26 of them in the smaller of the contact radii with and without film."""
DEPTHS = 0.05 * np.arange(27)
"""Output depths below the interface, over the contact radius without film."""
RADII = (0.5e-6, 1e-6, 2e-6, 5e-6)
"""Contact radii in m at which the film of the paper is marked."""
BOTH = (
    *(
        (PAPER_RATIO, 0.02, "rigid"),
        (PAPER_RATIO, 0.2, "steel"),
        (PAPER_RATIO, 0.065, "rigid"),
        (PAPER_RATIO, 0.13, "steel"),
    ),
    *((0.1, 0.05, "rigid"), (0.1, 0.5, "steel"), (0.2, 1.0, "rigid"), (0.6, 2.0, "steel")),
    *(
        (2.0, 0.05, "steel"),
        (2.0, 0.5, "rigid"),
        (4.0, 0.1, "rigid"),
        (4.0, 1.0, "steel"),
        (10.0, 0.02, "steel"),
    ),
    (10.0, 0.3, "rigid"),
)
"""(E1/E2, thickness, counter-body) solved by FEM as well; the first two at the quick level, on coarser
elements.
"""
QUICK_MESH = 16
FEWEST_DRAWN = 3  # thicknesses: fewer are no map
NAMES = {"p": "largest pressure", "mises": "largest von Mises stress of the body"}


@dataclass(frozen=True)
class Changes:
    """By the film, as shares of the values without it: largest pressure, largest von Mises stress at z >=
    thickness.
    """

    p: float
    mises: float


def of_result(result: Result) -> Changes:
    """As a model returns them. RuntimeError if it did not converge or has no contact without film to compare
    with.
    """
    found = result.quantities["p_max_change"], result.quantities["mises_max_change"]
    if not result.converged or None in found:
        raise RuntimeError(
            f"{result.model} ended {result.status}: {result.message} {' '.join(result.warnings)}"
        )
    return Changes(*found)


@cache
def of_spectral(ratio: float, thickness: float, counterbody: str) -> Changes:
    """The same of the spectral solution."""
    contact = film_contact(thickness, ratio, counter=COUNTER[counterbody])
    return Changes(pressure_change(contact), mises_change(contact))


def map_scene(base: Scene, ratio: float, thickness: float, counterbody: str) -> Scene:
    """The sphere of `base` on a film, with few cells and depths; thickness over the contact radius without
    film.
    """
    scene = coated_scene(base, ratio, thickness, counterbody)
    below = scene.body.coating.thickness + DEPTHS * contact_of(scene).contact_radius
    return with_grid(scene, cells=(CELLS, CELLS), depths=(0.0, *below))


@dataclass(frozen=True)
class Field:
    """Changes over (thickness, modulus ratio), by SAM and in the spectral solution; each array (m, n)."""

    sam: dict[str, np.ndarray]
    spectral: dict[str, np.ndarray]

    def error(self, name: str) -> float:
        """The largest difference of SAM from the spectral solution."""
        return float(np.max(np.abs(self.sam[name] - self.spectral[name])))


def field_of(context: Context, base: Scene, counterbody: str) -> Field:
    """The map under one counter-body; its many solves are not kept one by one."""
    thicknesses, moduli = THICKNESSES[context.level], MODULI[context.level]
    shape = thicknesses.size, moduli.size
    field = Field(*({name: np.zeros(shape) for name in NAMES} for _ in range(2)))
    for number_, (i, j) in enumerate(np.ndindex(shape), start=1):
        at = float(moduli[j]), float(thicknesses[i]), counterbody
        ours, other = of_result(models.solve(map_scene(base, *at), SAM)), of_spectral(*at)
        for name in NAMES:
            field.sam[name][i, j], field.spectral[name][i, j] = getattr(ours, name), getattr(other, name)
        context.progress(f"{context.case}, {counterbody}: films", number_, shape[0] * shape[1])
    return field


@dataclass(frozen=True)
class FilmPoint:
    """One film in both models and in the spectral solution."""

    ratio: float
    thickness: float
    counterbody: str
    sam: Changes
    fem: Changes
    spectral: Changes

    def between(self, name: str) -> float:
        """The difference of both models."""
        return abs(getattr(self.sam, name) - getattr(self.fem, name))


def point_of(context: Context, base: Scene, at: tuple[float, float, str]) -> FilmPoint:
    """One film, solved by both models. at: E1/E2, thickness, counter-body."""
    scene = map_scene(base, *at)
    label = "{:.3g}-{:g}-{}".format(*at).replace(".", "-")
    ours, fem = (
        of_result(context.solve(model, scene, f"{name}-{label}"))
        for name, model in (("sam", SAM), ("fem", FEM))
    )
    return FilmPoint(*at, ours, fem, of_spectral(*at))


@dataclass(frozen=True)
class Maps:
    """The maps under both counter-bodies, of `thickness` by `modulus` points; points: also solved by FEM."""

    base: Scene
    thickness: np.ndarray
    modulus: np.ndarray
    points: Sequence[FilmPoint]
    fields: dict[str, Field]


class FilmMap(Case):
    """The maps under both counter-bodies, and a few of their points by FEM."""

    def solve(self, context: Context) -> Maps:
        base, quick = context.scene("coated-sphere"), context.level == "quick"
        base = with_mesh(base, QUICK_MESH) if quick else base
        points = [point_of(context, base, at) for at in (BOTH[:2] if quick else BOTH)]
        fields = {counterbody: field_of(context, base, counterbody) for counterbody in COUNTER}
        return Maps(base, THICKNESSES[context.level], MODULI[context.level], points, fields)

    def measure(self, found: Maps) -> dict[str, float]:
        values = {f"sam-{name}": max(each.error(name) for each in found.fields.values()) for name in NAMES}
        return values | {f"fem-{name}": max(each.between(name) for each in found.points) for name in NAMES}

    def setup(self, found: Maps) -> list[tuple[str, str]]:
        h, e = found.thickness, found.modulus
        return [
            (
                "Map",
                f"{h.size} thicknesses h/a₀ = {h[0]:g} to {h[-1]:g}, {e.size} ratios E₁/E₂ = {e[0]:g} to "
                f"{e[-1]:g}",
            ),
            ("Counter-body", "rigid, and of the material of the body; ν = 0.3 in all"),
            ("SAM", f"{CELLS} × {CELLS} cells, {DEPTHS.size} depths below the film, {DEPTHS[1]:g} a₀ apart"),
            ("FEM", f"{found.base.fem.cells_per_radius} elements in the contact radius"),
        ]

    def tables(self, found: Maps) -> list[SmallTable]:
        return [point_table(found.points), error_table(found)]

    def notes(self, found: Maps) -> Iterator[str]:
        yield (
            "Both changes depend on h/a₀, E₁/E₂, Poisson's ratios and the ratio of the counter-body's "
            "modulus only: force and radius of the sphere enter through a₀ alone. An elastic counter-body is "
            "part of the compliance that the film does not change, so that a film matters less under steel "
            "than under a rigid body."
        )

    def figures(self, found: Maps) -> Iterator[Plot]:
        paper = PaperCase(PAPER_RATIO, {f"{1e6 * a:g} µm": PAPER_FILM / a for a in RADII})
        grid = found.thickness, found.modulus
        for counterbody, field in found.fields.items() if found.thickness.size > FEWEST_DRAWN else ():
            panels = [
                Map(words[0].upper() + words[1:], *grid, field.sam[name]) for name, words in NAMES.items()
            ]
            yield Plot(
                change_maps(panels, paper),
                counterbody,
                f"What a film changes, {counterbody} counter-body",
                "Two heat maps over thickness and modulus ratio of the film: change of the largest pressure "
                "and of the largest von Mises stress of the body. Soft films lower the pressure and stiff "
                "ones raise it, the stress of the body likewise under thin films; the lines of 1 % and 5 % "
                "run close to E1/E2 = 1 for thick films and spread for thin ones.",
                "SAM, at equal force. Lines: 1 % (dashed) and 5 % (solid). Green: the film of the paper, 100 "
                "nm and 80 GPa on steel, at contact radii of 0.5 to 5 µm.",
            )


def percent(share: float) -> str:
    """A share in %, signed."""
    return f"{100 * share:+.2f}".replace("-", "\N{MINUS SIGN}")


def point_table(points: Sequence[FilmPoint]) -> SmallTable:
    """The films that both models solve."""
    rows = [
        (
            *(f"{p.ratio:.3g}", f"{p.thickness:g}", p.counterbody),
            *(percent(getattr(model, name)) for name in NAMES for model in (p.sam, p.fem, p.spectral)),
        )
        for p in points
    ]
    changes = (f"{q}, {m}" for q in ("p_max", "σvM") for m in ("SAM", "FEM", "spectral"))
    return SmallTable(
        "Change by the film in %, at equal force", ("E₁/E₂", "h/a₀", "counter-body", *changes), rows
    )


def error_table(found: Maps) -> SmallTable:
    """The largest differences over the maps and where they are."""
    rows = []
    for (counterbody, field), (name, words) in product(found.fields.items(), NAMES.items()):
        off = np.abs(field.sam[name] - field.spectral[name])
        i, j = np.unravel_index(np.argmax(off), off.shape)
        rows.append(
            (
                counterbody,
                words,
                number(100 * off[i, j], 2),
                (f"h/a₀ = {found.thickness[i]:.3g}, E₁/E₂ = {found.modulus[j]:.3g}"),
            )
        )
    return SmallTable(
        "SAM against the spectral solution over the maps, in percentage points",
        ("counter-body", "change of", "largest difference [points]", "at"),
        rows,
    )


CASES = (FilmMap("film-map"),)
