# SPDX-License-Identifier: MIT
"""Contact radii that break the claim of a negligible film, the film's own stress, and a layer of slightly
softer steel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

from sam.scene import Coating, CounterBody, Loading, Result, Scene
from verification.cases.case import FEM, SAM, Case, Context, SmallTable, with_mesh
from verification.cases.coated.coated_sphere import COUNTERBODIES
from verification.cases.coated.film_map import (
    COUNTER,
    PAPER_FILM,
    PAPER_RATIO,
    QUICK_MESH,
    Changes,
    of_result,
    of_spectral,
    percent,
)
from verification.reference.coated_changes import THIN, breaking_thickness, mises_change, pressure_change
from verification.reference.hertz import CircularContact, effective_modulus
from verification.references import contact_of

YOUNG, PRESSURE, FILM_YIELD = 210e9, 6.5e9, 0.67e9
"""E of the body, largest pressure without film and yield stress of the film in Pa: Bosman & Schipper (2011),
Table 1, Fig. 3.
"""
LIMITS = (0.05, 0.01)
CHANGES = {"p": pressure_change, "mises": mises_change}
SIGNS = {"p": "p_max", "mises": "σvM"}
RATIOS = {"quick": (PAPER_RATIO,), "full": (40 / 210, PAPER_RATIO, 130 / 210, 2.0, 4.0)}
SPREAD_YOUNG, SPREAD_THICKNESS = (80e9, 99e9, 130e9), (60e-9, 111e-9, 160e-9)
"""Smallest, mean and largest of most films that Table 2 of the paper lists, in Pa and m (a few are 30 or 300
nm thick).
"""
RADII = {"quick": (1e-6,), "full": (5e-6, 2e-6, 1e-6, 0.5e-6)}
"""Contact radii in m at which the stress of the film itself is looked at."""
NC_RADIUS, NC_THICKNESSES, NC_SHARES = 5e-6, (1e-6, 0.5e-6), (0.95, 0.9)
NC_QUICK = "rigid", 1e-6, 0.9
"""Contact radius in m; a nano-crystalline layer in m and its E over that of the steel: Fig. 4 of the paper.
"""


@cache
def broken_at(ratio: float, counterbody: str, limit: float, name: str) -> float:
    """Thickness over contact radius without film at which a change reaches the limit; NaN if the thinnest
    film passes it.
    """
    try:
        return breaking_thickness(ratio, counter=COUNTER[counterbody], limit=limit, change=CHANGES[name])
    except ValueError:
        return math.nan


def sphere_scene(base: Scene, coating: Coating, radius: float, counterbody: str) -> Scene:
    """A sphere whose contact without film has that radius in m and the largest pressure PRESSURE, on a coated
    body.
    """
    body, other = base.body, CounterBody(shape="sphere", radius=1.0, **COUNTERBODIES[counterbody])
    modulus = effective_modulus(body.young, body.poisson, other.young, other.poisson)
    curvature = 2.0 * modulus * radius / (math.pi * PRESSURE)  # p0 = 2 E* a/(pi R)
    force = CircularContact.from_peak_pressure(PRESSURE, curvature, modulus).force
    return base.model_copy(
        update={
            "body": body.model_copy(update={"coating": coating}),
            "counterbody": other.model_copy(update={"radius": curvature}),
            "loading": Loading(force=force),
        }
    )


def paper_film(young: float = PAPER_RATIO * YOUNG, thickness: float = PAPER_FILM) -> Coating:
    """A film like that of the paper."""
    return Coating(young=young, poisson=0.3, thickness=thickness)


@dataclass(frozen=True)
class SolvedLayer:
    """One film in both models: contact radius without film in m, result of SAM, changes of FEM and spectral
    ones.
    """

    scene: Scene
    counterbody: str
    radius: float
    sam: Result
    fem: Changes
    spectral: Changes

    def errors(self, name: str) -> tuple[float, float]:
        """Of SAM and FEM against the spectral solution."""
        exact = getattr(self.spectral, name)
        return tuple(abs(getattr(changes, name) - exact) for changes in (of_result(self.sam), self.fem))


def solve(context: Context, scene: Scene, counterbody: str, label: str) -> SolvedLayer:
    """One film by both models and in the spectral solution."""
    radius, film = contact_of(scene).contact_radius, scene.body.coating
    sam, fem = (
        context.solve(model, scene, f"{name}-{label}") for name, model in (("sam", SAM), ("fem", FEM))
    )
    spectral = of_spectral(film.young / scene.body.young, film.thickness / radius, counterbody)
    return SolvedLayer(scene, counterbody, radius, sam, of_result(fem), spectral)


@dataclass(frozen=True)
class BreakingRadii:
    """breaking: (counter-body, limit, change) -> h/a0; off: "sam", "fem" -> largest distance from a limit
    there.

    own: the film of the paper on a few contact radii, by SAM; level, limits: of the verification.
    """

    level: str
    limits: Sequence[float]
    breaking: Mapping[tuple[str, float, str], float]
    off: Mapping[str, float]
    own: Sequence[tuple[float, str, Result]]


class FilmLimits(Case):
    """Where the film of the paper breaks the claim; both models solved there, and at a few radii for its own
    stress.
    """

    def solve(self, context: Context) -> BreakingRadii:
        base, quick = context.scene("coated-sphere"), context.level == "quick"
        base = with_mesh(base, QUICK_MESH) if quick else base
        limits = LIMITS[:1] if quick else LIMITS
        breaking = {at: broken_at(PAPER_RATIO, *at) for at in product(COUNTER, limits, CHANGES)}
        off = {"sam": [0.0], "fem": [0.0]}
        for (counterbody, limit, name), thickness in breaking.items():
            scene = sphere_scene(base, paper_film(), PAPER_FILM / thickness, counterbody)
            for short, model in (("sam", SAM), ("fem", FEM)) if name == "p" or not quick else ():
                found = getattr(
                    of_result(context.solve(model, scene, (f"{short}-{counterbody}-{name}-{100 * limit:g}"))),
                    name,
                )
                off[short].append(abs(abs(found) - limit))
        largest = {short: max(each) for short, each in off.items()}
        own = [solve_film(context, base, a, other) for other in COUNTER for a in RADII[context.level]]
        return BreakingRadii(context.level, limits, breaking, largest, own)

    def measure(self, found: BreakingRadii) -> dict[str, float]:
        return {f"{name}-at-limit": value for name, value in found.off.items()}

    def setup(self, found: BreakingRadii) -> list[tuple[str, str]]:
        return [
            (
                "Film",
                f"{PAPER_FILM * 1e9:g} nm, {PAPER_RATIO * YOUNG / 1e9:g} GPa, on {YOUNG / 1e9:g} GPa; ν = "
                "0.3 in both",
            ),
            ("Largest pressure without film", f"{PRESSURE / 1e9:g} GPa"),
            ("Counter-body", "sphere, rigid or of the material of the body"),
        ]

    def tables(self, found: BreakingRadii) -> Iterator[SmallTable]:
        yield thickness_table(found.level, found.limits)
        yield radius_table(found.limits)
        yield from () if found.level == "quick" else (spread_table(),)
        yield own_stress_table(found.own)

    def notes(self, found: BreakingRadii) -> list[str]:
        return [limit_words(found.breaking), own_words(found.own)]


def solve_film(context: Context, base: Scene, radius: float, counterbody: str) -> tuple[float, str, Result]:
    """The film of the paper on a contact of that radius without it, by SAM."""
    label = f"sam-{counterbody}-{1e6 * radius:g}um".replace(".", "-")
    result = context.solve(SAM, sphere_scene(base, paper_film(), radius, counterbody), label)
    return radius, counterbody, result


def thickness_table(level: str, limits: Sequence[float]) -> SmallTable:
    """h/a0 at which each change reaches each limit."""
    places = list(product(COUNTER, limits, CHANGES))
    return SmallTable(
        "Thickness over contact radius without film, h/a₀, at which the film changes so much",
        ("E₁/E₂", *(f"{other}, {100 * limit:g} % of {SIGNS[name]}" for other, limit, name in places)),
        [(f"{ratio:.3g}", *(spelt(broken_at(ratio, *at)) for at in places)) for ratio in RATIOS[level]],
    )


def spelt(thickness: float) -> str:
    """A thickness for the reader."""
    return f"below {THIN:g}" if math.isnan(thickness) else f"{thickness:.4f}"


def radius_table(limits: Sequence[float]) -> SmallTable:
    """The contact radius below which the film of the paper breaks each limit."""
    rows = [
        (
            counterbody,
            f"{100 * limit:g} %",
            *(
                f"{1e6 * PAPER_FILM / broken_at(PAPER_RATIO, counterbody, limit, name):.3f}"
                for name in CHANGES
            ),
        )
        for counterbody, limit in product(COUNTER, limits)
    ]
    return SmallTable(
        "Contact radius below which the film of the paper changes more than the limit",
        ("counter-body", "limit", *(f"for {SIGNS[name]} [µm]" for name in CHANGES)),
        rows,
    )


def spread_table() -> SmallTable:
    """Contact radii that break the 5 % limit in pressure or stress, whichever is larger."""
    rows = []
    for young, thickness in product(SPREAD_YOUNG, SPREAD_THICKNESS):
        thinnest = {
            other: min(broken_at(young / YOUNG, other, LIMITS[0], name) for name in CHANGES)
            for other in COUNTER
        }
        rows.append(
            (
                f"{young / 1e9:g}",
                f"{thickness * 1e9:g}",
                *(f"{1e6 * thickness / h:.2f}" for h in thinnest.values()),
            )
        )
    return SmallTable(
        (
            "Contact radius below which pressure or stress changes by more than 5 %, over the films of the "
            "paper's Table 2"
        ),
        ("E₁ [GPa]", "h [nm]", *(f"{other} [µm]" for other in COUNTER)),
        rows,
    )


def own_stress_table(own: Sequence[tuple[float, str, Result]]) -> SmallTable:
    """What the film itself carries."""
    rows = []
    for radius, counterbody, result in own:
        changes, q = of_result(result), result.quantities
        rows.append(
            (
                *(f"{1e6 * radius:g}", counterbody, percent(changes.p), percent(changes.mises)),
                f"{q['mises_max_film_Pa'] / 1e9:.2f}",
                f"{q['mises_max_film_Pa'] / FILM_YIELD:.1f}",
                f"{q['mises_max_substrate_Pa'] / 1e9:.2f}",
            )
        )
    return SmallTable(
        (
            f"The film of the paper, elastic, at {PRESSURE / 1e9:g} GPa without it: changes, and what it "
            "carries itself (SAM)"
        ),
        (
            *("contact radius without film [µm]", "counter-body", "p_max [%]", "σvM of the body [%]"),
            *("σvM in the film [GPa]", "over its yield stress", "σvM in the body [GPa]"),
        ),
        rows,
    )


def limit_words(breaking: dict[tuple[str, float, str], float]) -> str:
    """The answer to the question of the case."""
    radii = {
        other: PAPER_FILM / min(breaking[other, LIMITS[0], name] for name in CHANGES) for other in COUNTER
    }
    words = " and ".join(f"{1e6 * radius:.2f} µm under a {other} sphere" for other, radius in radii.items())
    return (
        "The film of 100 nm and 80 GPa changes pressure and stress by less than 5 % on contact radii "
        f"above {words}."
    )


def own_words(own: Sequence[tuple[float, str, Result]]) -> str:
    """What the film itself carries, in words."""
    shares = [result.quantities["mises_max_film_Pa"] / FILM_YIELD for _, _, result in own]
    return (
        "Negligible or not is said of pressure and body. The film itself, taken as elastic, carries "
        f"{min(shares):.1f} to {max(shares):.1f} times its yield stress of {FILM_YIELD / 1e9:g} GPa here: it "
        "would flow."
    )


class NcLayer(Case):
    """Changes by a layer of slightly softer steel, in both models."""

    def solve(self, context: Context) -> list[SolvedLayer]:
        base, found = context.scene("coated-sphere"), []
        for other, h, share in product(COUNTER, NC_THICKNESSES, NC_SHARES):
            if context.level != "quick" or (other, h, share) == NC_QUICK:
                scene = sphere_scene(base, paper_film(share * YOUNG, h), NC_RADIUS, other)
                found.append(solve(context, scene, other, f"{other}-{1e9 * h:g}-{100 * share:g}"))
        return found

    def measure(self, found: list[SolvedLayer]) -> dict[str, float]:
        return {
            f"{model}-{name}": max(each.errors(name)[k] for each in found)
            for name in CHANGES
            for k, model in enumerate(("sam", "fem"))
        }

    def setup(self, found: list[SolvedLayer]) -> list[tuple[str, str]]:
        return [
            ("Layer", "1 and 0.5 µm of steel with Young's modulus lower by 5 and 10 %, bonded, ν = 0.3"),
            ("Contact", f"radius {1e6 * NC_RADIUS:g} µm and {PRESSURE / 1e9:g} GPa without the layer"),
        ]

    def tables(self, found: list[SolvedLayer]) -> Iterator[SmallTable]:
        rows = []
        for each in found:
            film, changes = each.scene.body.coating, (of_result(each.sam), each.fem, each.spectral)
            layer = f"{1e6 * film.thickness:g}", percent(film.young / YOUNG - 1.0), each.counterbody
            rows.append((*layer, *(percent(getattr(one, name)) for name in CHANGES for one in changes)))
        yield SmallTable(
            "Change by the layer in %, at equal force",
            (
                "h [µm]",
                "modulus [%]",
                "counter-body",
                *(f"{SIGNS[name]}, {model}" for name in CHANGES for model in ("SAM", "FEM", "spectral")),
            ),
            rows,
        )

    def notes(self, found: list[SolvedLayer]) -> Iterator[str]:
        largest = max(abs(change) for each in found for change in (each.spectral.p, each.spectral.mises))
        yield (
            f"The largest change is {100 * largest:.2f} %: so much does an elastic calculation without "
            "layers miss where grains or pores have lowered the modulus as Fig. 4 of Bosman & Schipper "
            "(2011) shows."
        )


CASES = (
    FilmLimits("film-limits"),
    NcLayer("nc-layer"),
)
