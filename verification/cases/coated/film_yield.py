# SPDX-License-Identifier: MIT
"""The tribofilm and the body under it beyond yield, and whether the film still changes pressure and stress by
less than 5 %.

Bosman & Schipper (2011), section 2, conclude so from an elastic calculation (Table 1, Fig. 3), and take a
yield stress of the film of 0.67 GPa (section 4), which the pressure of that calculation passes many times.
Semi-analytical models have one material; this is finite elements alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from sam.scene import Body, Coating, Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    elastic_text,
    mesh_text,
    with_body,
    with_loading,
)
from verification.cases.coated.film_contacts import (
    BARE_RADIUS,
    BODIES,
    PRESSURES,
    RADII,
    STEEL,
    FilmContact,
    SolvedFilm,
    exact_changes,
    scene_of,
)
from verification.cases.coated.film_words import answer, claims, numbers, refinement
from verification.compare.verdicts import LIMIT
from verification.figures.film import changes, pressures, strains
from verification.reference.bonded_film import flow_gradient

SCENE = "film-yield"
LEVEL = {"quick": (8, 5), "full": (12, 10)}
"""Elements in the contact radius, of which the film has two over its thickness whatever their number; load
steps.
"""
THIN_RADIUS = 10e-6
PERFECT = Plasticity(law="perfect", yield_stress=1.358e9)
"""Body whose film is of its own material: about the initial yield stress of the first Swift law."""


def contacts(level: str) -> list[FilmContact]:
    """Those of the quick level have a contact radius of 2 um, one pressure and a rigid sphere."""
    if level == "quick":
        return [
            FilmContact(2e-6, 6.5e9, False, *kind)
            for kind in (("elastic", False), ("elastic", True), ("B 945", True))
        ]
    return [
        FilmContact(radius, p0, steel, body, yields)
        for steel in (False, True)
        for p0 in PRESSURES
        for body in BODIES
        for yields in (False, True)
        for radius in RADII
    ]


def refined(level: str) -> list[FilmContact]:
    """Those solved again with elements of half the size: under them the most strained film that still gives
    an answer.
    """
    if level == "quick":
        return [FilmContact(2e-6, 6.5e9, False, "B 945", True)]
    rigid = [FilmContact(radius, 6.5e9, False, "B 945", True) for radius in RADII]
    return [*rigid, FilmContact(2e-6, 6.5e9, True, "B 1780", True)]


def thin() -> list[FilmContact]:
    """An elastic body under a film of a hundredth of the contact radius, elastic and yielding, for what holds
    of a thin film.
    """
    return [FilmContact(THIN_RADIUS, PRESSURES[-1], False, "elastic", yields) for yields in (False, True)]


def flowing() -> FilmContact:
    """The smallest contact: its film flows out, so that its strain is no answer, but the pressure that it
    holds is known.
    """
    return FilmContact(RADII[-1], PRESSURES[-1], False, "elastic", True)


class FilmSolver:
    """Solves contacts, each once. base: the scene that they vary."""

    def __init__(self, context: Context, base: Scene) -> None:
        self.context, self.base = context, base
        self._result = cache(self._solved)

    def __call__(self, contact: FilmContact, cells: int) -> SolvedFilm:
        """With the film and without. cells: elements in the contact radius."""
        results = self._result(contact, cells, True), self._result(contact.alone, cells, False)
        return SolvedFilm(contact, scene_of(self.base, contact, cells), *results)

    def _solved(self, contact: FilmContact, cells: int, film: bool) -> Result:
        label = f"{contact.label}-{cells}" if film else f"bare-{contact.label}-{cells}"
        return self.context.solve(FEM, scene_of(self.base, contact, cells, film), label)


@dataclass(frozen=True)
class YieldingFilms:
    """Every contact, on `cells` elements in its radius. base: the scene that they vary.

    limits: thin films; hills: contacts whose film flows; pairs: contacts and themselves on finer elements;
    same: a film of the material of the body, and that body without it.
    """

    base: Scene
    cells: int
    found: Sequence[SolvedFilm]
    limits: Sequence[SolvedFilm]
    hills: Sequence[SolvedFilm]
    pairs: Sequence[tuple[SolvedFilm, SolvedFilm]]
    same: tuple[Result, Result]


class FilmYield(Case):
    """Every contact, the refined ones, and a film of the body's own material."""

    def solve(self, context: Context) -> YieldingFilms:
        cells, steps = LEVEL[context.level]
        base = with_loading(context.scene(SCENE), steps=steps)
        solved = FilmSolver(context, base)
        found = {contact: solved(contact, cells) for contact in contacts(context.level)}
        pairs = [(found[each], solved(each, 2 * cells)) for each in refined(context.level)]
        limits = [solved(contact, cells) for contact in thin()]
        flows = [*found.values(), solved(flowing(), cells)]
        hills = [one for one in flows if replace(one.contact, body="elastic") == flowing()]
        same = of_one_material(context, base, cells)
        return YieldingFilms(base, cells, list(found.values()), limits, hills, pairs, same)

    def measure(self, films: YieldingFilms) -> dict[str, Measured | float]:
        own, alone = (result.quantities for result in films.same)
        return {
            **against_theory(films.found),
            **of_the_layers(films.found, films.limits, films.hills),
            **of_refinement(films.pairs),
            "equal-pressure": abs(own["p_max_change"]),
            "equal-mises": abs(own["mises_max_change"]),
            "equal-strain": Measured(own["peeq_max"], alone["peeq_max"]),
        }

    def setup(self, films: YieldingFilms) -> list[tuple[str, str]]:
        film, last = films.base.body.coating, films.found[-1].result
        return [
            ("Film", f"{1e9 * film.thickness:g} nm, {elastic_text(film)}; elastic, or"),
            ("Yield stress of the film", f"{film.yield_stress / 1e9:g} GPa, perfectly plastic"),
            (
                "Half-space",
                "E = 210 GPa, ν = 0.3; elastic, or Swift with B = 945 MPa, C = 20, n = 0.121 or 1780 MPa, "
                "4, 0.095",
            ),
            ("Sphere", "rigid, or elastic with the constants of the half-space; radius from a₀ and p₀"),
            (
                "Contacts",
                "a₀ and p₀ of the elastic contact without film; force F = 2πa₀²p₀/3, the same with film and "
                "without",
            ),
            ("Load steps", f"{films.base.loading.steps}, the same with film and without"),
            (
                "FEM",
                f"{films.cells} elements in a₀, {last.discretisation['film_layers']} over the film; "
                f"{mesh_text(last)}",
            ),
        ]

    def tables(self, films: YieldingFilms) -> list[SmallTable]:
        stress = films.base.body.coating.yield_stress
        each = (numbers(films.found, steel, stress) for steel in (False, True))
        tables = [claims(films.found), *each, refinement(films.pairs)]
        return [table for table in tables if table.rows]

    def notes(self, films: YieldingFilms) -> list[str]:
        return answer(films.found, films.base.body.coating)

    def figures(self, films: YieldingFilms) -> Iterator[Plot]:
        hardest = [one for one in films.found if one.contact.p0 == PRESSURES[-1]]
        rigid = [one for one in hardest if not one.contact.steel]
        if len({one.contact.radius for one in films.found}) > 1:
            yield Plot(
                changes([one for one in hardest if one.negligible is not None], LIMIT),
                "changes",
                "Changes by the film over the contact radius, p₀ = 6.5 GPa",
                "Changes of the largest pressure and of the largest von Mises stress of the body over the "
                "contact radius, for a rigid sphere and one of steel, with lines for every pair of materials "
                "and one at the limit.",
                "Lines: film elastic; dashed: film yields. Contacts that squeeze their film too far for an "
                "answer are left out.",
            )
        yield Plot(
            pressures(rigid),
            "pressure",
            "Pressure under films, rigid sphere, p₀ = 6.5 GPa",
            "Pressure over radius for each contact radius: without film and with one that is elastic or "
            "yields.",
            "Where a film that yields flows out, at the smallest radius, the pressure falls on a line, by "
            "about σ_y/(√3 h).",
        )
        yield Plot(
            strains([one for one in rigid if one.contact.yields]),
            "film-strain",
            "Plastic strain of the film, rigid sphere, p₀ = 6.5 GPa",
            "Plastic strain of the film over radius for each contact radius: nearly even under the contact, "
            "with a peak at its edge.",
            "Mean over the thickness of the film. Circle: thin film under the pressure at the centre, "
            "elastic body; it does not hold where the film flows out.",
        )


def against_theory(found: Sequence[SolvedFilm]) -> dict[str, Measured]:
    """Contacts that are elastic throughout against the layered closed form, and every bare one on a mesh of
    its own.
    """
    elastic = [one for one in found if one.contact.kind == ("elastic", "elastic")]
    apart = np.array([np.subtract(one.changes, exact_changes(one)) for one in elastic])
    hertz = (one.result.quantities["p_max_bare_Pa"] / one.contact.p0 for one in elastic)
    meshes = (one.result.quantities["p_max_bare_Pa"] / one.bare.quantities["p_max_Pa"] for one in found)
    return {
        "elastic-pressure": Measured(float(np.abs(apart[:, 0]).max())),
        "elastic-mises": Measured(float(np.abs(apart[:, 1]).max())),
        "bare-hertz": Measured(off(hertz)),
        "bare-mesh": Measured(off(meshes)),
    }


def of_the_layers(
    found: Sequence[SolvedFilm], limits: Sequence[SolvedFilm], hills: Sequence[SolvedFilm]
) -> dict[str, Measured]:
    """Thin films at their centre, flowing ones over r, the yield stress, and what a plastic body is
    spared.
    """
    excess = max(
        one.film_mises / one.scene.body.coating.yield_stress - 1.0 for one in found if one.contact.yields
    )
    return {
        "centre-mises": Measured(
            off(one.at_centre / one.thin_film for one in limits if not one.contact.yields)
        ),
        "centre-strain": Measured(off(one.at_centre / one.thin_film for one in limits if one.contact.yields)),
        "flow": Measured(off(one.gradient / gradient_of(one) for one in hills)),
        "film-excess": Measured(max(0.0, excess)),
        "spared": Measured(max(one.body_strain / one.bare_strain for one in found if one.bare_strain > 0.0)),
    }


def gradient_of(found: SolvedFilm) -> float:
    """Of the pressure over a film that flows out, Pa/m."""
    return flow_gradient(found.scene.body.coating.yield_stress, found.thickness)


def of_refinement(pairs: Iterable[tuple[SolvedFilm, SolvedFilm]]) -> dict[str, Measured]:
    """Largest differences of the changes, and of the plastic strain of the body, between two sizes of
    elements.

    Of films that are not squeezed too far: at the edge of the others the strain grows with finer elements.
    """
    pairs = [pair for pair in pairs if all(one.negligible is not None for one in pair)]
    apart = np.abs([np.subtract(coarse.changes, fine.changes) for coarse, fine in pairs])
    strain = off(coarse.body_strain / fine.body_strain for coarse, fine in pairs)
    return {
        "refined-pressure": Measured(float(apart[:, 0].max())),
        "refined-mises": Measured(float(apart[:, 1].max())),
        "refined-strain": Measured(strain),
    }


def of_one_material(context: Context, base: Scene, cells: int) -> tuple[Result, Result]:
    """A film of the material of the body, perfectly plastic, and that body without it: nothing may change."""
    scene = scene_of(base, FilmContact(BARE_RADIUS, PRESSURES[0], False, "elastic", True), cells)
    film = Coating(thickness=scene.body.coating.thickness, **STEEL, yield_stress=PERFECT.yield_stress)
    coated = scene.model_copy(update={"body": Body(**STEEL, plasticity=PERFECT, coating=film)})
    result = context.solve(FEM, coated, "one-material")
    return result, context.solve(FEM, with_body(coated, coating=None), "one-material-bare")


def off(ratios: Iterable[float]) -> float:
    """Largest distance from 1; NaN without any."""
    distances = [abs(ratio - 1.0) for ratio in ratios]
    return float(np.max(distances)) if distances else np.nan


CASES = (FilmYield("film-yield"),)
