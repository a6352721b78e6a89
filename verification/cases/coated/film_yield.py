# SPDX-License-Identifier: MIT
"""The tribofilm and the body under it beyond yield, by finite elements, and whether the film still changes
pressure and stress by less than 5 %. Bosman & Schipper (2011), section 2, conclude so from an elastic
calculation (Table 1, Fig. 3), whose pressure passes the yield stress of the film, 0.67 GPa (section 4), many
times.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from sam.scene import Body, Coating, CounterBody, Plasticity, Result, Scene
from verification.cases.case import FEM, Context, with_body, with_loading, with_mesh
from verification.cases.recipes import COUNTERBODIES
from verification.compare.verdicts import LIMIT
from verification.reference.bonded_film import elastic_mises, flow_gradient, in_plane_strain, thinning
from verification.reference.hertz import effective_modulus
from verification.references import changes_by_film
from verification.runs.sampling import peak

LEVEL = {"quick": (8, 5), "full": (12, 10)}
"""Elements in the contact radius, of which the film has two over its thickness; load steps."""
LARGEST_STRAIN = 0.14
"""Of a film, up to which small strains on its undeformed thickness are taken for an answer: half of it is
their own error, and with elements of half the size the strain at the edge grows by a tenth; beyond, by half
of itself and more.
"""
RADII, THIN_RADIUS = (5e-6, 2e-6, 1e-6), 10e-6
PRESSURES = (4e9, 6.5e9)
BARE_RADIUS = 2e-6
"""Elastic contact radius in m of the contacts without film, one for all: nothing there has a length."""
STEEL = COUNTERBODIES["steel"]
BODIES = {
    "elastic": None,
    "B 945": Plasticity(law="swift", B=945e6, C=20.0, n=0.121),
    "B 1780": Plasticity(law="swift", B=1780e6, C=4.0, n=0.095),
}
"""Steel of the substrate: elastic, published for 52100, and as the paper prints in section 5."""
PERFECT = Plasticity(law="perfect", yield_stress=1.358e9)
"""Body whose film is of its own material: about the initial yield stress of the first Swift law."""


@dataclass(frozen=True)
class FilmContact:
    """radius: a0 without film, m; p0: its peak pressure, Pa; body: see BODIES; film: "elastic", "yields"."""

    radius: float
    p0: float
    counterbody: str
    body: str
    film: str


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
    """A row of the frame. bare: the result without film, on a mesh of its own, at BARE_RADIUS. film_strain,
    body_strain, bare_strain: the largest plastic ones, the last without film; known: the film is not squeezed
    out of reach of small strains; holds: the claim of Bosman & Schipper (2011). centre: mean over the film on
    the axis, the plastic strain where it yields, else the von Mises stress, off the thin film; flow: fall of
    the pressure over r, of the line fitted to it from 0.4 to 0.8 a0, off that of a film that flows out;
    bare-mesh, hertz: largest pressure without film off that of the other mesh and of Hertz.
    """
    body, film, q, yields = scene.body, scene.body.coating, result.quantities, contact.film == "yields"

    def within(table: str, column: str, inside: bool = True) -> np.ndarray:
        z, values = peak(result.tables[table], "z_m", column)
        return values[(z < film.thickness) == inside]

    film_strain, body_strain = (
        float(max(within(table, "peeq", inside).max() for table in ("axis", "plane")))
        for inside in (True, False)
    )
    centre, changes = q["p_center_Pa"], (q["p_max_change"], q["mises_max_change"])
    strain, bare_strain = in_plane_strain(centre, body.young, body.poisson), bare.quantities["peeq_max"]
    if yields:
        thin = thinning(centre, 0.0, strain, (film.young, film.poisson, film.yield_stress))
    else:
        thin = elastic_mises(centre, strain, film.young, film.poisson)
    found = {
        "p_change": changes[0],
        "mises_change": changes[1],
        "film_strain": film_strain,
        "body_strain": body_strain,
        "bare_strain": bare_strain,
        "kept": body_strain / bare_strain if bare_strain else np.nan,
        "known": "yes" if film_strain <= LARGEST_STRAIN else "no",
        "holds": "yes" if max(map(abs, changes)) <= LIMIT else "no",
        "centre": off(float(within("axis", "peeq" if yields else "mises_Pa").mean()), thin),
        "bare-mesh": off(q["p_max_bare_Pa"], bare.quantities["p_max_Pa"]),
    }
    if yields:
        r, p = peak(result.tables["line"], "x_m", "p_Pa")
        part = (r >= 0.4 * contact.radius) & (r <= 0.8 * contact.radius)
        gradient = -float(np.polynomial.polynomial.polyfit(r[part] - r[part][0], p[part], 1)[1])
        found["flow"] = off(gradient, flow_gradient(film.yield_stress, film.thickness))
        found["excess"] = max(0.0, float(within("plane", "mises_Pa").max()) / film.yield_stress - 1.0)
    elif contact.body == "elastic":
        exact = changes_by_film(scene)
        apart = {f"{name}-off": abs(a - b) for name, a, b in zip(("p", "mises"), changes, exact, strict=True)}
        found |= apart | {"hertz": off(q["p_max_bare_Pa"], contact.p0)}
    material = contact.body.replace("B ", "Swift, B = ") + " MPa" * contact.body.startswith("B")
    words = {
        "materials": f"body {material}, film {contact.film}",
        "contact": f"{contact.counterbody} sphere, p₀ = {1e-9 * contact.p0:g} GPa",
    }
    return vars(contact) | words | found


def off(value: float, expected: float) -> float:
    """Distance of a ratio from 1."""
    return abs(value / expected - 1.0)


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Every contact; much wider ones and films that flow out; finer meshes; a film of the body's material."""
    cells, steps = LEVEL[context.level]
    base, bare = with_loading(context.scene("film-yield"), steps=steps), {}

    def solved(contact: FilmContact, cells: int = cells) -> dict[str, Any]:
        scene = scene_of(base, contact, cells)
        alone = replace(contact, radius=BARE_RADIUS, film="elastic")
        label = f"{contact.body}-{contact.film}-{contact.counterbody}".lower().replace(" ", "")
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
    for sweep, chosen in (("contacts", contacts), ("thin", thin)):
        for row in (found[contact] for contact in chosen):
            drawn = sweep == "contacts" and row["known"] == "yes"
            shown = {f"change-of-{name}": row[f"{name}_change"] for name in ("p", "mises")}
            yield {"sweep": sweep} | row | (shown if drawn else {})
    yield from (
        {"sweep": "flowing"} | found[each] for each in found if replace(each, body="elastic") == flowing
    )
    for contact in refined:
        before, now = found[contact], solved(contact, 2 * cells)
        row = {"sweep": "finer", **now, "known": min(before["known"], now["known"])}  # "no" before "yes"
        for name in ("p", "mises"):
            row[f"finer-{name}"] = abs(before[f"{name}_change"] - now[f"{name}_change"])
        yield row | {"finer-strain": off(before["body_strain"], now["body_strain"])}
    own = scene_of(base, FilmContact(BARE_RADIUS, PRESSURES[0], "rigid", "elastic", "yields"), cells)
    film = Coating(thickness=own.body.coating.thickness, **STEEL, yield_stress=PERFECT.yield_stress)
    own = own.model_copy(update={"body": Body(**STEEL, plasticity=PERFECT, coating=film)})
    same, alone = (
        context.solve(FEM, scene, label).quantities
        for scene, label in ((own, "one-material"), (with_body(own, coating=None), "one-material-bare"))
    )
    row = {f"{name}-change": same[f"{name}_max_change"] for name in ("p", "mises")}
    yield {"sweep": "same", "strain": same["peeq_max"], "strain expected": alone["peeq_max"]} | row
