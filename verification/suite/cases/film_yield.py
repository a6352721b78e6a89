# SPDX-License-Identifier: MIT
"""The chemical film and the body under it beyond yield: does the film still change pressure and stress by less than 5 %?

Bosman & Schipper (2011), section 2, conclude so from an elastic calculation (Table 1, Fig. 3), and take a yield stress of the
film of 0.67 GPa (section 4), which the pressure of that calculation passes many times. Semi-analytical models have one
material; this is finite elements alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from sam.scene import Body, Coating, Plasticity, Result, Scene
from verification.compare.verdicts import LIMIT
from verification.figures.film import changes, pressures, strains
from verification.reference.bonded_film import flow_gradient
from verification.runs.models import FEM
from verification.suite.cases.case import Case, Context, Outcome, mesh_text, with_loading
from verification.suite.cases.film_contacts import (
    BARE_RADIUS,
    BODIES,
    PRESSURES,
    RADII,
    STEEL,
    Contact,
    Found,
    exact_changes,
    scene_of,
)
from verification.suite.cases.film_words import answer, claims, numbers, refinement
from verification.suite.cases.plastic import EQUATIONS
from verification.suite.gates import Measured

SCENE = "film-yield"
LEVEL = {"quick": (8, 5), "full": (12, 10)}
"""Elements in the contact radius, of which the film has two over its thickness whatever their number; load steps."""
THIN_RADIUS = 10e-6
PERFECT = Plasticity(law="perfect", yield_stress=1.358e9)
"""Body whose film is of its own material: about the initial yield stress of the first Swift law."""


def contacts(level: str) -> list[Contact]:
    """Those of the quick level have a contact radius of 2 um, one pressure and a rigid sphere."""
    if level == "quick":
        return [
            Contact(2e-6, 6.5e9, False, *kind)
            for kind in (("elastic", False), ("elastic", True), ("B 945", True))
        ]
    return [
        Contact(radius, p0, steel, body, yields)
        for steel in (False, True)
        for p0 in PRESSURES
        for body in BODIES
        for yields in (False, True)
        for radius in RADII
    ]


def refined(level: str) -> list[Contact]:
    """Those solved again with elements of half the size: under them the most strained film that still gives an answer."""
    if level == "quick":
        return [Contact(2e-6, 6.5e9, False, "B 945", True)]
    rigid = [Contact(radius, 6.5e9, False, "B 945", True) for radius in RADII]
    return [*rigid, Contact(2e-6, 6.5e9, True, "B 1780", True)]


def thin() -> list[Contact]:
    """An elastic body under a film of a hundredth of the contact radius, elastic and yielding, for what holds of a thin film."""
    return [Contact(THIN_RADIUS, PRESSURES[-1], False, "elastic", yields) for yields in (False, True)]


def flowing() -> Contact:
    """The smallest contact: its film flows out, so that its strain is no answer, but the pressure that it holds is known."""
    return Contact(RADII[-1], PRESSURES[-1], False, "elastic", True)


class Solver:
    """Solves contacts, each once. base: the scene that they vary."""

    def __init__(self, context: Context, base: Scene):
        self.context, self.base = context, base
        self._bare: dict[tuple[Contact, int], Result] = {}
        self._found: dict[tuple[Contact, int], Found] = {}

    def __call__(self, contact: Contact, cells: int) -> Found:
        """With the film and without. cells: elements in the contact radius."""
        if (contact, cells) not in self._found:
            scene = scene_of(self.base, contact, cells)
            result = self.context.solve(FEM, scene, f"{contact.label}-{cells}")
            self._found[contact, cells] = Found(contact, scene, result, self.bare(contact.alone, cells))
        return self._found[contact, cells]

    def bare(self, contact: Contact, cells: int) -> Result:
        """Without film."""
        if (contact, cells) not in self._bare:
            scene = scene_of(self.base, contact, cells, film=False)
            self._bare[contact, cells] = self.context.solve(FEM, scene, f"bare-{contact.label}-{cells}")
        return self._bare[contact, cells]


def run(context: Context) -> Outcome:
    """Every contact, the refined ones, and a film of the body's own material."""
    cells, steps = LEVEL[context.level]
    base = with_loading(context.scene(SCENE), steps=steps)
    solved = Solver(context, base)
    found = [solved(contact, cells) for contact in contacts(context.level)]
    finer = [solved(contact, 2 * cells) for contact in refined(context.level)]
    limits = [solved(contact, cells) for contact in thin()]
    hills = [
        one for one in [*found, solved(flowing(), cells)] if replace(one.contact, body="elastic") == flowing()
    ]
    pairs = [(next(one for one in found if one.contact == fine.contact), fine) for fine in finer]
    values = against_theory(found) | of_the_layers(found, limits, hills)
    values |= of_refinement(pairs) | of_one_material(context, base, cells)
    outcome = Outcome(
        {f"{context.case}.{name}": value for name, value in values.items()}, setup(base, found[-1], cells)
    )
    outcome.tables = [
        claims(found),
        *(numbers(found, steel, base.body.coating.yield_stress) for steel in (False, True)),
        refinement(pairs),
    ]
    outcome.tables = [table for table in outcome.tables if table.rows]
    outcome.notes = answer(found, base.body.coating)
    draw(context, outcome, found)
    return outcome


def against_theory(found: Sequence[Found]) -> dict[str, Measured]:
    """Contacts that are elastic throughout against the layered closed form, and every bare one on a mesh of its own."""
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
    found: Sequence[Found], limits: Sequence[Found], hills: Sequence[Found]
) -> dict[str, Measured]:
    """Thin films at their centre, flowing ones over r, the yield stress, and what a plastic body is spared."""
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


def gradient_of(found: Found) -> float:
    """Of the pressure over a film that flows out, Pa/m."""
    return flow_gradient(found.scene.body.coating.yield_stress, found.thickness)


def of_refinement(pairs: Iterable[tuple[Found, Found]]) -> dict[str, Measured]:
    """Largest differences of the changes, and of the plastic strain of the body, between two sizes of elements.

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


def of_one_material(context: Context, base: Scene, cells: int) -> dict[str, Measured]:
    """A film of the material of the body, perfectly plastic: nothing changes, on its mesh and against one without film."""
    scene = scene_of(base, Contact(BARE_RADIUS, PRESSURES[0], False, "elastic", True), cells)
    film = Coating(thickness=scene.body.coating.thickness, **STEEL, yield_stress=PERFECT.yield_stress)
    body = Body(**STEEL, plasticity=PERFECT, coating=film)
    result = context.solve(FEM, scene.model_copy(update={"body": body}), "one-material")
    alone = body.model_copy(update={"coating": None})
    own = context.solve(FEM, scene.model_copy(update={"body": alone}), "one-material-bare")
    return {
        "equal-pressure": Measured(abs(result.quantities["p_max_change"])),
        "equal-mises": Measured(abs(result.quantities["mises_max_change"])),
        "equal-strain": Measured(result.quantities["peeq_max"], own.quantities["peeq_max"]),
    }


def off(ratios: Iterable[float]) -> float:
    """Largest distance from 1; NaN without any."""
    distances = [abs(ratio - 1.0) for ratio in ratios]
    return float(np.max(distances)) if distances else np.nan


def setup(base: Scene, found: Found, cells: int) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    film = base.body.coating
    return [
        (
            "Film",
            f"{1e9 * film.thickness:g} nm, E = {film.young / 1e9:g} GPa, ν = {film.poisson:g}; elastic, or",
        ),
        ("Yield stress of the film", f"{film.yield_stress / 1e9:g} GPa, perfectly plastic"),
        (
            "Half-space",
            "E = 210 GPa, ν = 0.3; elastic, or Swift with B = 945 MPa, C = 20, n = 0.121 or 1780 MPa, 4, 0.095",
        ),
        ("Sphere", "rigid, or elastic with the constants of the half-space; radius from a₀ and p₀"),
        (
            "Contacts",
            "a₀ and p₀ of the elastic contact without film; force F = 2πa₀²p₀/3, the same with film and without",
        ),
        ("Load steps", f"{base.loading.steps}, the same with film and without"),
        (
            "FEM",
            f"{cells} elements in a₀, {found.result.discretisation['film_layers']} over the film; {mesh_text(found.result)}",
        ),
    ]


def draw(context: Context, outcome: Outcome, found: Sequence[Found]) -> None:
    """Changes over the contact radius, and pressures and strains of the film over r."""
    hardest = [one for one in found if one.contact.p0 == PRESSURES[-1]]
    rigid = [one for one in hardest if not one.contact.steel]
    if len({one.contact.radius for one in found}) > 1:
        outcome.figures.append(
            context.save(
                changes([one for one in hardest if one.negligible is not None], LIMIT),
                "changes",
                "Changes by the film over the contact radius, p₀ = 6.5 GPa",
                "Changes of the largest pressure and of the largest von Mises stress of the body over the contact radius, for "
                "a rigid sphere and one of steel, with lines for every pair of materials and one at the limit.",
                "Lines: film elastic; dashed: film yields. Contacts that squeeze their film too far for an answer are left out.",
            )
        )
    outcome.figures += [
        context.save(
            pressures(rigid),
            "pressure",
            "Pressure under films, rigid sphere, p₀ = 6.5 GPa",
            "Pressure over radius for each contact radius: without film and with one that is elastic or yields.",
            "Where a film that yields flows out, at the smallest radius, the pressure falls on a line, by about σ_y/(√3 h).",
        ),
        context.save(
            strains([one for one in rigid if one.contact.yields]),
            "film-strain",
            "Plastic strain of the film, rigid sphere, p₀ = 6.5 GPa",
            "Plastic strain of the film over radius for each contact radius: nearly even under the contact, with a peak at "
            "its edge.",
            "Mean over the thickness of the film. Circle: thin film under the pressure at the centre, elastic body; it "
            "does not hold where the film flows out.",
        ),
    ]


CASES = (
    Case(
        "film-yield",
        "The film and the body yield",
        "Does a film of 100 nm still change pressure and stress by less than 5 % when film and body yield?",
        run,
        (
            (
                "Claim",
                "|Δp_max|, |Δσ_vM of the body| < 5 %",
                "Bosman & Schipper (2011), section 2, Table 1, Fig. 3",
            ),
            (
                "Film and body elastic",
                "integral transforms of the layered half-space",
                "O'Sullivan & King (1988)",
            ),
            (
                "Largest pressure gradient of a yielding film, bonded below and smooth above",
                "|dp/dr| ≈ σ_y/(√3 h), half of that between two rough plates",
                "Prandtl (1923); Hill, The Mathematical Theory of Plasticity (1950), chapter VIII",
            ),
            (
                "Thin film, centre",
                "σzz = −p, εxx = εyy of the body: σ_vM = p + (E ε − ν p)/(1 − ν); |εzzᵖ| = (σ_vM − σ_y) 2(1 − ν)/E",
                "Bosman & Schipper (2011), Eq. 12-14, with Hooke's law and the strains in the surface only",
            ),
            *EQUATIONS[:2],
        ),
    ),
)
