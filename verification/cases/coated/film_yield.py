# SPDX-License-Identifier: MIT
"""The tribofilm and the body under it beyond yield, and whether the film still changes pressure and stress by
less than 5 %.

Bosman & Schipper (2011), section 2, conclude so from an elastic calculation (Table 1, Fig. 3), and take a
yield stress of the film of 0.67 GPa (section 4), which the pressure of that calculation passes many times.
Semi-analytical models have one material; this is finite elements alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

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
    with_body,
    with_loading,
    with_mesh,
)
from verification.cases.recipes import COUNTERBODIES
from verification.compare.verdicts import LIMIT
from verification.figures.film import changes, pressures
from verification.reference.bonded_film import elastic_mises, flow_gradient, in_plane_strain, plastic_strain
from verification.reference.hertz import effective_modulus
from verification.references import changes_by_film
from verification.runs.sampling import peak

if TYPE_CHECKING:
    from pandas import DataFrame, Series

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
STEEL = COUNTERBODIES["steel"]
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
CHANGES = ("p_change", "mises_change")
COLUMNS = (
    ("p_bare", "p_max bare [GPa]", 1e-9),
    ("p_change", "its change [%]", 1e2),
    ("mises_change", "change of the body's von Mises [%]", 1e2),
    ("bare_strain", "largest plastic strain of the body, bare [%]", 1e2),
    ("body_strain", "with film [%]", 1e2),
    ("film_strain", "of the film [%]", 1e2),
    ("film_mises", "von Mises in the film [GPa]", 1e-9),
)
"""Of the frame, in words and in these units."""
PERFECT = Plasticity(law="perfect", yield_stress=1.358e9)
"""Body whose film is of its own material: about the initial yield stress of the first Swift law."""


@dataclass(frozen=True)
class FilmContact:
    """radius: a0 of the elastic contact without film, m; p0: its largest pressure, Pa; body: see BODIES;
    film: "elastic" or "yields".
    """

    radius: float
    p0: float
    counterbody: str
    body: str
    film: str

    @property
    def words(self) -> str:
        """The contact for the reader."""
        return f"{self.counterbody}, a₀ = {1e6 * self.radius:g} µm, p₀ = {1e-9 * self.p0:g} GPa"


def scene_of(base: Scene, contact: FilmContact, cells: int, film: bool = True) -> Scene:
    """The scene of a contact; cells: elements in a0; film: False without coating."""
    other = COUNTERBODIES[contact.counterbody]
    modulus = effective_modulus(base.body.young, base.body.poisson, *other.values())
    radius = 2.0 * contact.radius * modulus / (math.pi * contact.p0)  # Johnson (1985), Eq. 4.24
    force = 2.0 / 3.0 * math.pi * contact.radius**2 * contact.p0
    coating = base.body.coating
    if contact.film == "elastic":
        coating = coating.model_copy(update={"yield_stress": None})
    scene = with_body(base, plasticity=BODIES[contact.body], coating=coating if film else None)
    scene = scene.model_copy(update={"counterbody": CounterBody(shape="sphere", radius=radius, **other)})
    return with_mesh(with_loading(scene, force=force), cells)


def row_of(contact: FilmContact, scene: Scene, result: Result, bare: Result) -> dict[str, Any]:
    """A row of the frame of contacts. bare: the result without film, on a mesh of its own, at BARE_RADIUS.

    film_strain, body_strain, bare_strain: the largest plastic ones, the last without film; film_mises:
    largest in the film in Pa, where it yields at the points where it is held to its yield stress; known: it
    is not squeezed out of reach of small strains; holds: the claim of Bosman & Schipper (2011); at_centre:
    mean over the film on the axis, the plastic strain where it yields, else the von Mises stress in Pa;
    thin_film: what that is on an elastic body, the film much thinner than the contact is wide; gradient: fall
    of the pressure over r in Pa/m, of the line fitted to it from 0.4 to 0.8 a0.
    """
    body, film, q, yields = scene.body, scene.body.coating, result.quantities, contact.film == "yields"

    def within(table: str, column: str, inside: bool = True) -> np.ndarray:
        z, values = peak(result.tables[table], "z_m", column)
        return values[(z < film.thickness) == inside]

    film_strain, body_strain = (
        float(max(within(table, "peeq", inside).max() for table in ("axis", "plane")))
        for inside in (True, False)
    )
    r, p = peak(result.tables["line"], "x_m", "p_Pa")
    part = (r >= 0.4 * contact.radius) & (r <= 0.8 * contact.radius)
    centre = q["p_center_Pa"]
    strain = in_plane_strain(centre, body.young, body.poisson)
    if yields:
        thin = plastic_strain(centre, strain, (film.young, film.poisson, film.yield_stress))
    else:
        thin = elastic_mises(centre, strain, film.young, film.poisson)
    changes = {"p_change": q["p_max_change"], "mises_change": q["mises_max_change"]}
    return vars(contact) | {
        "contact": contact,
        "scene": scene,
        "result": result,
        "bare": bare,
        "words": contact.words,
        **changes,
        "p_bare": q["p_max_bare_Pa"],
        "film_strain": film_strain,
        "body_strain": body_strain,
        "bare_strain": bare.quantities["peeq_max"],
        "film_mises": float(within("plane", "mises_Pa").max()) if yields else q["mises_max_film_Pa"],
        "known": film_strain <= LARGEST_STRAIN,
        "holds": all(abs(change) <= LIMIT for change in changes.values()),
        "at_centre": float(within("axis", "peeq" if yields else "mises_Pa").mean()),
        "thin_film": thin,
        "gradient": -float(np.polynomial.polynomial.polyfit(r[part] - r[part][0], p[part], 1)[1]),
    }


@dataclass(frozen=True)
class YieldingFilms:
    """base: the scene that all vary; found: every contact; limits: thin films; hills: contacts whose film
    flows; coarse, fine: the same contacts on elements of half the size; same: a film of the material of the
    body, and that body without it.
    """

    base: Scene
    found: DataFrame
    limits: DataFrame
    hills: DataFrame
    coarse: DataFrame
    fine: DataFrame
    same: tuple[Result, Result]


class FilmYield(Case):
    """Every contact, some on finer elements, and a film of the body's own material."""

    def solve(self, context: Context) -> YieldingFilms:
        from pandas import DataFrame

        cells, steps = LEVEL[context.level]
        base, bare = with_loading(context.scene(SCENE), steps=steps), {}

        def solved(contact: FilmContact, cells: int = cells) -> dict[str, Any]:
            scene, alone = (
                scene_of(base, contact, cells),
                replace(contact, radius=BARE_RADIUS, film="elastic"),
            )
            label = "-".join((contact.body, contact.film, contact.counterbody)).lower().replace(" ", "")
            label += f"-{1e6 * contact.radius:g}um-{1e-8 * contact.p0:g}-{cells}"
            if (alone, cells) not in bare:
                without = scene_of(base, alone, cells, film=False)
                bare[alone, cells] = context.solve(FEM, without, f"bare-{label}")
            return row_of(contact, scene, context.solve(FEM, scene, label), bare[alone, cells])

        most = FilmContact(2e-6, PRESSURES[-1], "rigid", "B 945", "yields")
        elastic = replace(most, body="elastic", film="elastic")
        contacts, refined = [elastic, replace(elastic, film="yields"), most], [most]
        if context.level == "full":
            every = product(("rigid", "steel"), PRESSURES, BODIES, ("elastic", "yields"), RADII)
            contacts = [FilmContact(a, p0, other, body, film) for other, p0, body, film, a in every]
            refined = [replace(most, radius=a) for a in RADII]
            refined.append(replace(most, counterbody="steel", body="B 1780"))
        # the film of the smallest contact flows out: its strain is no answer, the pressure that it holds is
        flowing = replace(elastic, radius=RADII[-1], film="yields")
        thin = [replace(elastic, radius=THIN_RADIUS, film=film) for film in ("elastic", "yields")]
        found = {contact: solved(contact) for contact in dict.fromkeys([*contacts, flowing, *thin])}
        hills = [contact for contact in found if replace(contact, body="elastic") == flowing]
        own = scene_of(base, FilmContact(BARE_RADIUS, PRESSURES[0], "rigid", "elastic", "yields"), cells)
        film = Coating(thickness=own.body.coating.thickness, **STEEL, yield_stress=PERFECT.yield_stress)
        own = own.model_copy(update={"body": Body(**STEEL, plasticity=PERFECT, coating=film)})
        same = context.solve(FEM, own, "one-material")
        return YieldingFilms(
            base,
            *(DataFrame([found[each] for each in some]) for some in (contacts, thin, hills, refined)),
            DataFrame([solved(contact, 2 * cells) for contact in refined]),
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
        film, last = films.base.body.coating, films.found["result"].iloc[-1]
        strength = f"elastic, or perfectly plastic at {film.yield_stress / 1e9:g} GPa"
        yield "Film", f"{1e9 * film.thickness:g} nm, {elastic_text(film)}; {strength}"
        swift = "Swift with B = 945 MPa, C = 20, n = 0.121 or 1780 MPa, 4, 0.095"
        yield "Half-space", f"E = 210 GPa, ν = 0.3; elastic, or {swift}"
        yield "Sphere", "rigid, or elastic with the constants of the half-space; radius from a₀ and p₀"
        yield "Contacts", "a₀ and p₀ of the elastic contact without film; force F = 2πa₀²p₀/3"
        yield "Load steps", f"{films.base.loading.steps}, the same with film and without"
        layers = last.discretisation["film_layers"]
        yield "FEM", f"{layers} layers of elements over the film; {mesh_text(last)}"

    def tables(self, films: YieldingFilms) -> Iterator[SmallTable]:
        rows = []
        for kind, ones in films.found.groupby(["body", "film"], sort=False):
            known = ones[ones["known"]]
            largest = (f"{1e2 * max(known[k], key=abs, default=math.nan):+.2f} %" for k in CHANGES)
            apart = known[~known["holds"]], ones[~ones["known"]]
            said = ("; ".join(each["words"]) or "none" for each in apart)
            rows.append((*kind, f"{known['holds'].sum()} of {len(ones)}", *largest, *said))
        heads = "body", "film", f"below {LIMIT:.0%}", "largest change of p_max", "of the body's von Mises"
        no_answer = f"no answer (film squeezed by more than {1e2 * LARGEST_STRAIN:g} %)"
        caption = f"Does the film change pressure and stress by less than {LIMIT:.0%}?"
        yield SmallTable(caption, (*heads, "fails in", no_answer), rows)
        for caption, ones in (
            ("Every contact", films.found),
            ("On finer elements, a film that yields", films.fine),
        ):
            numbers = ([f"{factor * value:.4g}" for value in ones[name]] for name, _, factor in COLUMNS)
            lines = zip(ones["words"], ones["body"], ones["film"], *numbers, strict=True)
            heads = "contact", "body", "film", *(words for _, words, _ in COLUMNS)
            yield SmallTable(caption, heads, list(lines))

    def notes(self, films: YieldingFilms) -> Iterator[str]:
        known = films.found[films.found["known"] & (films.found["bare_strain"] > LEAST_STRAIN)]
        kept = known["body_strain"] / known["bare_strain"]
        most = known.loc[kept.idxmin()]
        yield (
            "A body that yields hides the film from this measure, as its von Mises stress is its yield "
            f"stress. Its largest plastic strain falls by up to {1e2 * (1.0 - kept.min()):.0f} % "
            f"({most['body']}, {most['words']}; strains above {LEAST_STRAIN:.1%} without film)."
        )
        film, lost = films.base.body.coating, films.found[~films.found["known"]]
        gradient = 1e-15 * flow_gradient(film.yield_stress, film.thickness)
        steep = ", ".join(f"{1e-15 * each:g}" for each in sorted(set(lost["p0"] / lost["radius"])))
        yield (
            "Bonded below and smooth above, the film that yields holds a pressure gradient of about "
            f"σ_y/(√3 h) = {gradient:.2f} GPa/µm; p₀/a₀ of contacts without an answer in GPa/µm: "
            f"{steep or 'none'}."
        )

    def figures(self, films: YieldingFilms) -> Iterator[Plot]:
        hardest = films.found[films.found["p0"] == PRESSURES[-1]]
        rigid = hardest[hardest["counterbody"] == "rigid"]
        if films.found["radius"].nunique() > 1:
            yield Plot(
                changes(hardest[hardest["known"]], LIMIT),
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


def against_theory(films: YieldingFilms) -> dict[str, float]:
    """Contacts that are elastic throughout against the layered closed form, every bare one on a mesh of its
    own, thin and flowing films against theirs, what a plastic body is spared, and what finer elements change:
    of films that are not squeezed too far, as at the edge of the others the strain grows with them.
    """
    found, film = films.found, films.base.body.coating
    elastic = found[(found["body"] == "elastic") & (found["film"] == "elastic")]
    exact = np.array([changes_by_film(scene) for scene in elastic["scene"]])
    apart = np.abs(elastic[list(CHANGES)].to_numpy() - exact).max(axis=0)
    alone = np.array([bare.quantities["p_max_Pa"] for bare in found["bare"]])
    yields = found[found["film"] == "yields"]
    centre = (films.limits["at_centre"] / films.limits["thin_film"]).to_numpy()
    known = films.coarse["known"] & films.fine["known"]
    coarse, fine, kept = films.coarse[known], films.fine[known], found[found["bare_strain"] > 0.0]
    finer = (coarse[list(CHANGES)] - fine[list(CHANGES)]).abs().max()
    return {
        "elastic-pressure": apart[0],
        "elastic-mises": apart[1],
        "bare-hertz": off(elastic["p_bare"] / elastic["p0"]),
        "bare-mesh": off(found["p_bare"] / alone),
        "centre-mises": off(centre[:1]),
        "centre-strain": off(centre[1:]),
        "flow": off(films.hills["gradient"] / flow_gradient(film.yield_stress, film.thickness)),
        "film-excess": max(0.0, (yields["film_mises"] / film.yield_stress - 1.0).max()),
        "spared": (kept["body_strain"] / kept["bare_strain"]).max(),
        "refined-pressure": finer.iloc[0],
        "refined-mises": finer.iloc[1],
        "refined-strain": off(coarse["body_strain"] / fine["body_strain"]),
    }


def off(ratios: Series | np.ndarray) -> float:
    """Largest distance from 1; NaN without any."""
    return float(np.abs(np.asarray(ratios) - 1.0).max(initial=-math.inf if len(ratios) else math.nan))


CASES = (FilmYield("film-yield"),)
