# SPDX-License-Identifier: MIT
"""The tribofilm and the body under it beyond yield, and whether the film still changes pressure and stress by
less than 5 %.

Bosman & Schipper (2011), section 2, conclude so from an elastic calculation (Table 1, Fig. 3), and take a
yield stress of the film of 0.67 GPa (section 4), which the pressure of that calculation passes many times.
Semi-analytical models have one material; this is finite elements alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np

from sam.scene import Body, Coating, CounterBody, Plasticity, Result, Scene
from verification.cases.case import (
    FEM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    elastic_text,
    mesh_text,
    number,
    with_body,
    with_loading,
    with_mesh,
)
from verification.compare.verdicts import LIMIT
from verification.figures.film import changes, pressures, strains
from verification.reference.bonded_film import elastic_mises, flow_gradient, in_plane_strain, plastic_strain
from verification.reference.hertz import effective_modulus
from verification.references import film_changes
from verification.runs.sampling import peak

SCENE = "film-yield"
LEVEL = {"quick": (8, 5), "full": (12, 10)}
"""Elements in the contact radius, of which the film has two over its thickness whatever their number; load
steps.
"""
LARGEST_STRAIN = 0.14
"""Of a film, up to which small strains on its undeformed thickness are taken for an answer: half of it is
their own error, and with elements of half the size the strain at the edge grows by a tenth; beyond, by half
of itself and more.
"""
RADII, THIN_RADIUS = (5e-6, 2e-6, 1e-6), 10e-6
PRESSURES = (4e9, 6.5e9)
BARE_RADIUS = 2e-6
"""Elastic contact radius in m at which the contacts without film are solved, one for all: without film
nothing has a length, and all that is relative to it is as at any other.
"""
STEEL = {"young": 210e9, "poisson": 0.3}
BODIES = {
    "elastic": None,
    "B 945": Plasticity(law="swift", B=945e6, C=20.0, n=0.121),
    "B 1780": Plasticity(law="swift", B=1780e6, C=4.0, n=0.095),
}
"""Steel of the substrate: elastic, the set published for 52100, and what the paper prints in section 5 for
its own.
"""
LEAST_STRAIN = 1e-3
"""Of a body without film, below which a relative change of it says nothing."""
COLUMNS = (
    *("contact", "body", "film", "elements in a₀", "p_max bare [GPa]", "its change [%]"),
    *("change of the body's von Mises [%]", "largest plastic strain of the body, bare [%]"),
    *("with film [%]", "of the film [%]", "von Mises in the film [GPa]"),
)
PERFECT = Plasticity(law="perfect", yield_stress=1.358e9)
"""Body whose film is of its own material: about the initial yield stress of the first Swift law."""


@dataclass(frozen=True)
class FilmContact:
    """radius: a0 of the elastic contact without film, m; p0: its largest pressure, Pa; steel: the sphere is;
    yields: the film does.
    """

    radius: float
    p0: float
    steel: bool
    body: str
    yields: bool

    @property
    def counter(self) -> str:
        """The counter-body in a word."""
        return "steel" if self.steel else "rigid"

    @property
    def words(self) -> str:
        """The contact for the reader."""
        return f"{self.counter}, a₀ = {1e6 * self.radius:g} µm, p₀ = {1e-9 * self.p0:g} GPa"

    @property
    def kind(self) -> tuple[str, str]:
        """Of the materials: body, film."""
        return self.body, "yields" if self.yields else "elastic"


@dataclass(frozen=True)
class SolvedFilm:
    """The results of a contact. bare: without film on a mesh of its own, at BARE_RADIUS."""

    contact: FilmContact
    scene: Scene
    result: Result
    bare: Result

    @property
    def changes(self) -> tuple[float, float]:
        """Of the largest pressure and of the largest von Mises stress of the body by the film."""
        return self.result.quantities["p_max_change"], self.result.quantities["mises_max_change"]

    @property
    def p_bare(self) -> float:
        """Largest pressure without film on the mesh with its elements, Pa."""
        return self.result.quantities["p_max_bare_Pa"]

    @property
    def negligible(self) -> bool | None:
        """Whether the claim of Bosman & Schipper (2011) holds; None if the film is squeezed out of reach of
        small strains.
        """
        known = self.film_strain <= LARGEST_STRAIN
        return all(abs(change) <= LIMIT for change in self.changes) if known else None

    @property
    def bare_strain(self) -> float:
        """Largest plastic strain of the body without film."""
        return self.bare.quantities["peeq_max"]

    @property
    def kept(self) -> float:
        """Largest plastic strain of the body with its film over that without."""
        return self.body_strain / self.bare_strain

    @cached_property
    def film_strain(self) -> float:
        """Largest plastic strain of the film."""
        return self._largest("peeq", ("axis", "plane"), film=True)

    @cached_property
    def body_strain(self) -> float:
        """Largest plastic strain of the body with its film."""
        return self._largest("peeq", ("axis", "plane"), film=False)

    @property
    def film_mises(self) -> float:
        """Largest von Mises stress in the film in Pa: of one that yields at the points where it is held to
        its yield stress.
        """
        if not self.contact.yields:
            return self.result.quantities["mises_max_film_Pa"]
        return self._largest("mises_Pa", ("plane",), film=True)

    @property
    def film_profile(self) -> tuple[np.ndarray, np.ndarray]:
        """Radii in m of the columns of Gauss points, and the mean plastic strain of the film in each, (n,)
        both.
        """
        r, z, strain = peak(self.result.tables["plane"], "x_m", "z_m", "peeq")
        inside = z < self.thickness
        radii, column = np.unique(np.round(r[inside] / r.max(), 12), return_inverse=True)
        return radii * r.max(), np.bincount(column, strain[inside]) / np.bincount(column)

    @property
    def thickness(self) -> float:
        """Of the film, m."""
        return self.scene.body.coating.thickness

    @property
    def thin_film(self) -> float:
        """What `at_centre` is on an elastic body, the film much thinner than the contact is wide."""
        body, film, p = self.scene.body, self.scene.body.coating, self.result.quantities["p_center_Pa"]
        strain = in_plane_strain(p, body.young, body.poisson)
        if self.contact.yields:
            return plastic_strain(p, strain, (film.young, film.poisson, film.yield_stress))
        return elastic_mises(p, strain, film.young, film.poisson)

    @property
    def at_centre(self) -> float:
        """On the axis, mean over the film: plastic strain of one that yields, else von Mises stress in Pa."""
        z, values = peak(self.result.tables["axis"], "z_m", "peeq" if self.contact.yields else "mises_Pa")
        return float(values[z < self.thickness].mean())

    @property
    def gradient(self) -> float:
        """Fall of the pressure over r in Pa/m, the line fitted to it from 0.4 to 0.8 of the contact radius
        without film.
        """
        r, p = peak(self.result.tables["line"], "x_m", "p_Pa")
        part = (r >= 0.4 * self.contact.radius) & (r <= 0.8 * self.contact.radius)
        return -float(np.polynomial.polynomial.polyfit(r[part] - r[part][0], p[part], 1)[1])

    def _largest(self, column: str, tables: Sequence[str], *, film: bool) -> float:
        read = [peak(self.result.tables[table], "z_m", column) for table in tables]
        return float(max(values[(z < self.thickness) == film].max() for z, values in read))


def scene_of(base: Scene, contact: FilmContact, cells: int, film: bool = True) -> Scene:
    """The scene of a contact; cells: elements in a0; film: False without coating."""
    other = STEEL if contact.steel else {}
    modulus = effective_modulus(base.body.young, base.body.poisson, *other.values())
    radius = 2.0 * contact.radius * modulus / (math.pi * contact.p0)  # Johnson (1985), Eq. 4.24
    force = 2.0 / 3.0 * math.pi * contact.radius**2 * contact.p0
    coating = base.body.coating
    if not contact.yields:
        coating = coating.model_copy(update={"yield_stress": None})
    scene = with_body(base, plasticity=BODIES[contact.body], coating=coating if film else None)
    scene = scene.model_copy(update={"counterbody": CounterBody(shape="sphere", radius=radius, **other)})
    return with_mesh(with_loading(scene, force=force), cells)


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
    """Every contact, some on finer elements, and a film of the body's own material."""

    def solve(self, context: Context) -> YieldingFilms:
        cells, steps = LEVEL[context.level]
        base, bare = with_loading(context.scene(SCENE), steps=steps), {}

        def solved(contact: FilmContact, cells: int = cells) -> SolvedFilm:
            scene, alone = scene_of(base, contact, cells), replace(contact, radius=BARE_RADIUS, yields=False)
            label = "-".join((*contact.kind, contact.counter)).lower().replace(" ", "")
            size = f"{1e6 * contact.radius:g}um-{1e-8 * contact.p0:g}-{cells}"
            if (alone, cells) not in bare:
                without = scene_of(base, alone, cells, film=False)
                bare[alone, cells] = context.solve(FEM, without, f"bare-{label}-{size}")
            return SolvedFilm(
                contact, scene, context.solve(FEM, scene, f"{label}-{size}"), bare[alone, cells]
            )

        most = FilmContact(2e-6, PRESSURES[-1], False, "B 945", True)
        elastic = replace(most, body="elastic", yields=False)
        contacts, refined = [elastic, replace(elastic, yields=True), most], [most]
        if context.level == "full":
            every = product((False, True), PRESSURES, BODIES, (False, True), RADII)
            contacts = [FilmContact(a, p0, steel, body, yields) for steel, p0, body, yields, a in every]
            refined = [replace(most, radius=a) for a in RADII] + [replace(most, steel=True, body="B 1780")]
        # the film of the smallest contact flows out: its strain is no answer, the pressure that it holds is
        flowing = replace(elastic, radius=RADII[-1], yields=True)
        thin = [replace(elastic, radius=THIN_RADIUS, yields=yields) for yields in (False, True)]
        found = {contact: solved(contact) for contact in dict.fromkeys([*contacts, flowing, *thin])}
        own = scene_of(base, FilmContact(BARE_RADIUS, PRESSURES[0], False, "elastic", True), cells)
        film = Coating(thickness=own.body.coating.thickness, **STEEL, yield_stress=PERFECT.yield_stress)
        own = own.model_copy(update={"body": Body(**STEEL, plasticity=PERFECT, coating=film)})
        same = context.solve(FEM, own, "one-material")
        return YieldingFilms(
            base,
            cells,
            [found[contact] for contact in contacts],
            [found[contact] for contact in thin],
            [found[contact] for contact in found if replace(contact, body="elastic") == flowing],
            [(found[contact], solved(contact, 2 * cells)) for contact in refined],
            (same, context.solve(FEM, with_body(own, coating=None), "one-material-bare")),
        )

    def measure(self, films: YieldingFilms) -> dict[str, Measured | float]:
        own, alone = (result.quantities for result in films.same)
        return against_theory(films) | {
            "equal-pressure": abs(own["p_max_change"]),
            "equal-mises": abs(own["mises_max_change"]),
            "equal-strain": Measured(own["peeq_max"], alone["peeq_max"]),
        }

    def setup(self, films: YieldingFilms) -> Iterator[tuple[str, str]]:
        film, last = films.base.body.coating, films.found[-1].result
        strength = f"elastic, or perfectly plastic at {film.yield_stress / 1e9:g} GPa"
        yield "Film", f"{1e9 * film.thickness:g} nm, {elastic_text(film)}; {strength}"
        swift = "Swift with B = 945 MPa, C = 20, n = 0.121 or 1780 MPa, 4, 0.095"
        yield "Half-space", f"E = 210 GPa, ν = 0.3; elastic, or {swift}"
        yield "Sphere", "rigid, or elastic with the constants of the half-space; radius from a₀ and p₀"
        yield "Contacts", "a₀ and p₀ of the elastic contact without film; force F = 2πa₀²p₀/3"
        yield "Load steps", f"{films.base.loading.steps}, the same with film and without"
        layers = last.discretisation["film_layers"]
        yield "FEM", f"{films.cells} elements in a₀, {layers} over the film; {mesh_text(last)}"

    def tables(self, films: YieldingFilms) -> Iterator[SmallTable]:
        columns = "body", "film", f"below {LIMIT:.0%}", "largest change of p_max", "of the body's von Mises"
        open_words = f"no answer (film squeezed by more than {1e2 * LARGEST_STRAIN:g} %)"
        rows = []
        for kind in dict.fromkeys(one.contact.kind for one in films.found):
            ones = [one for one in films.found if one.contact.kind == kind]
            known = [one for one in ones if one.negligible is not None]
            largest = [max((one.changes[k] for one in known), key=abs, default=math.nan) for k in (0, 1)]
            held = f"{sum(one.negligible for one in known)} of {len(ones)}"
            fails = "; ".join(one.contact.words for one in known if not one.negligible) or "none"
            lost = "; ".join(one.contact.words for one in ones if one.negligible is None) or "none"
            rows.append((*kind, held, *(f"{1e2 * change:+.2f} %" for change in largest), fails, lost))
        caption = f"Does the film change pressure and stress by less than {LIMIT:.0%}?"
        yield SmallTable(caption, (*columns, "fails in", open_words), rows)
        for caption, ones in (
            ("Every contact", films.found),
            ("Refinement, a film that yields", [one for pair in films.pairs for one in pair]),
        ):
            rows = [
                (
                    *(one.contact.words, *one.contact.kind, f"{one.scene.fem.cells_per_radius}"),
                    number(1e-9 * one.p_bare, 4),
                    *(f"{1e2 * change:+.2f}" for change in one.changes),
                    *(f"{1e2 * v:.3f}" for v in (one.bare_strain, one.body_strain, one.film_strain)),
                    number(1e-9 * one.film_mises, 3),
                )
                for one in ones
            ]
            yield SmallTable(caption, COLUMNS, rows)

    def notes(self, films: YieldingFilms) -> Iterator[str]:
        known = [one for one in films.found if one.negligible is not None and one.bare_strain > LEAST_STRAIN]
        most = min(known, key=lambda one: one.kept)
        yield (
            "A body that yields hides the film from this measure, as its von Mises stress is its yield "
            f"stress. Its largest plastic strain falls by up to {1e2 * (1.0 - most.kept):.0f} % "
            f"({most.contact.body}, {most.contact.words}; strains above {LEAST_STRAIN:.1%} without film)."
        )
        film = films.base.body.coating
        gradient = 1e-15 * flow_gradient(film.yield_stress, film.thickness)
        steep = {one.contact.p0 / one.contact.radius for one in films.found if one.negligible is None}
        lost = ", ".join(f"{1e-15 * each:g}" for each in sorted(steep)) or "never too steep"
        yield (
            "Bonded below and smooth above, the film that yields holds a pressure gradient of about "
            f"σ_y/(√3 h) = {gradient:.2f} GPa/µm; in contacts without an answer p₀/a₀ in GPa/µm is {lost}."
        )

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
            pressures(rigid, BARE_RADIUS),
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


def against_theory(films: YieldingFilms) -> dict[str, float]:
    """Contacts that are elastic throughout against the layered closed form, every bare one on a mesh of its
    own, thin and flowing films against theirs, what a plastic body is spared, and what finer elements change:
    of films that are not squeezed too far, as at the edge of the others the strain grows with them.
    """
    found, strength = films.found, films.base.body.coating.yield_stress
    elastic = [one for one in found if one.contact.kind == ("elastic", "elastic")]
    apart = np.abs([np.subtract(one.changes, film_changes(one.scene)) for one in elastic])
    yielding = [one for one in found if one.contact.yields]
    pairs = [pair for pair in films.pairs if all(one.negligible is not None for one in pair)]
    finer = np.abs([np.subtract(coarse.changes, fine.changes) for coarse, fine in pairs])
    return {
        "elastic-pressure": float(apart[:, 0].max()),
        "elastic-mises": float(apart[:, 1].max()),
        "bare-hertz": off(one.p_bare / one.contact.p0 for one in elastic),
        "bare-mesh": off(one.p_bare / one.bare.quantities["p_max_Pa"] for one in found),
        "centre-mises": off(one.at_centre / one.thin_film for one in films.limits if not one.contact.yields),
        "centre-strain": off(one.at_centre / one.thin_film for one in films.limits if one.contact.yields),
        "flow": off(one.gradient / flow_gradient(strength, one.thickness) for one in films.hills),
        "film-excess": max(0.0, *(one.film_mises / strength - 1.0 for one in yielding)),
        "spared": max(one.kept for one in found if one.bare_strain > 0.0),
        "refined-pressure": float(finer[:, 0].max()),
        "refined-mises": float(finer[:, 1].max()),
        "refined-strain": off(coarse.body_strain / fine.body_strain for coarse, fine in pairs),
    }


def off(ratios: Iterable[float]) -> float:
    """Largest distance from 1; NaN without any."""
    return max((abs(ratio - 1.0) for ratio in ratios), default=math.nan)


CASES = (FilmYield("film-yield"),)
