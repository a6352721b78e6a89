# SPDX-License-Identifier: MIT
"""Contact radii that break the claim of a negligible film, the film's own stress, and a layer of slightly softer steel."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

from sam.scene import Coating, CounterBody, Loading, Result, Scene
from verification.reference.coated_changes import THIN, breaking_thickness, mises_change, pressure_change
from verification.reference.hertz import CircularContact, effective_modulus
from verification.runs.models import FEM, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_mesh
from verification.suite.cases.coated_sphere import COUNTERBODIES
from verification.suite.cases.film_map import (
    COUNTER,
    EQUATIONS,
    PAPER_FILM,
    PAPER_RATIO,
    QUICK_MESH,
    Changes,
    of_result,
    of_spectral,
    percent,
)
from verification.suite.cases.hertz import contact_of
from verification.suite.gates import Measured

YOUNG, PRESSURE, FILM_YIELD = 210e9, 6.5e9, 0.67e9
"""E of the body, largest pressure without film and yield stress of the film in Pa: Bosman & Schipper (2011), Table 1, Fig. 3."""
LIMITS = (0.05, 0.01)
CHANGES = {"p": pressure_change, "mises": mises_change}
SIGNS = {"p": "p_max", "mises": "σvM"}
RATIOS = {"quick": (PAPER_RATIO,), "full": (40 / 210, PAPER_RATIO, 130 / 210, 2.0, 4.0)}
SPREAD_YOUNG, SPREAD_THICKNESS = (80e9, 99e9, 130e9), (60e-9, 111e-9, 160e-9)
"""Smallest, mean and largest of most films that Table 2 of the paper lists, in Pa and m (a few are 30 or 300 nm thick)."""
RADII = {"quick": (1e-6,), "full": (5e-6, 2e-6, 1e-6, 0.5e-6)}
"""Contact radii in m at which the stress of the film itself is looked at."""
NC_RADIUS, NC_THICKNESSES, NC_SHARES = 5e-6, (1e-6, 0.5e-6), (0.95, 0.9)
NC_QUICK = "rigid", 1e-6, 0.9
"""Contact radius in m; a nano-crystalline layer in m and its E over that of the steel: Fig. 4 of the paper."""


@cache
def broken_at(ratio: float, counterbody: str, limit: float, name: str) -> float:
    """Thickness over contact radius without film at which a change reaches the limit; NaN if the thinnest film passes it."""
    try:
        return breaking_thickness(ratio, counter=COUNTER[counterbody], limit=limit, change=CHANGES[name])
    except ValueError:
        return math.nan


def sphere_scene(base: Scene, coating: Coating, radius: float, counterbody: str) -> Scene:
    """A sphere whose contact without film has that radius in m and the largest pressure PRESSURE, on a coated body."""
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
    return Coating(young=young, poisson=0.3, thickness=thickness)


@dataclass(frozen=True)
class Solved:
    """One film in both models: contact radius without film in m, result of SAM, changes of FEM and spectral ones."""

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


def solve(context: Context, scene: Scene, counterbody: str, label: str) -> Solved:
    radius, film = contact_of(scene).contact_radius, scene.body.coating
    sam, fem = (
        context.solve(model, scene, f"{name}-{label}") for name, model in (("sam", SAM), ("fem", FEM))
    )
    spectral = of_spectral(film.young / scene.body.young, film.thickness / radius, counterbody)
    return Solved(scene, counterbody, radius, sam, of_result(fem), spectral)


def worst_errors(solved: Sequence[Solved]) -> dict[str, Measured]:
    """By model and change, over all films."""
    worst = {}
    for name in CHANGES:
        for k, model in enumerate(("sam", "fem")):
            worst[f"{model}-{name}"] = Measured(max(each.errors(name)[k] for each in solved))
    return worst


def run_limits(context: Context) -> Outcome:
    """Where the film of the paper breaks the claim; both models solved there, and at a few radii for its own stress."""
    base = context.scene("coated-sphere")
    if context.level == "quick":
        base = with_mesh(base, QUICK_MESH)
    limits = LIMITS[:1] if context.level == "quick" else LIMITS
    breaking = {at: broken_at(PAPER_RATIO, *at) for at in product(COUNTER, limits, CHANGES)}
    off = {"sam": 0.0, "fem": 0.0}
    for (counterbody, limit, name), thickness in breaking.items():
        if context.level == "quick" and name != "p":
            continue
        scene = sphere_scene(base, paper_film(), PAPER_FILM / thickness, counterbody)
        for short, model in (("sam", SAM), ("fem", FEM)):
            label = f"{short}-{counterbody}-{name}-{100 * limit:g}"
            found = getattr(of_result(context.solve(model, scene, label)), name)
            off[short] = max(off[short], abs(abs(found) - limit))
    outcome = Outcome({f"{context.case}.{name}-at-limit": Measured(value) for name, value in off.items()})
    outcome.setup = [
        (
            "Film",
            f"{PAPER_FILM * 1e9:g} nm, {PAPER_RATIO * YOUNG / 1e9:g} GPa, on {YOUNG / 1e9:g} GPa; ν = 0.3 in both",
        ),
        ("Largest pressure without film", f"{PRESSURE / 1e9:g} GPa"),
        ("Counter-body", "sphere, rigid or of the material of the body"),
    ]
    outcome.tables = [thickness_table(context.level, limits), radius_table(limits)]
    if context.level != "quick":
        outcome.tables.append(spread_table())
    own = [solve_film(context, base, a, other) for other in COUNTER for a in RADII[context.level]]
    outcome.tables.append(own_stress_table(own))
    outcome.notes += [limit_words(breaking), own_words(own)]
    return outcome


def solve_film(context: Context, base: Scene, radius: float, counterbody: str) -> tuple[float, str, Result]:
    """The film of the paper on a contact of that radius without it, by SAM."""
    label = f"sam-{counterbody}-{1e6 * radius:g}um".replace(".", "-")
    return (
        radius,
        counterbody,
        context.solve(SAM, sphere_scene(base, paper_film(), radius, counterbody), label),
    )


def thickness_table(level: str, limits: Sequence[float]) -> SmallTable:
    """h/a0 at which each change reaches each limit."""
    places = list(product(COUNTER, limits, CHANGES))
    rows = [(f"{ratio:.3g}", *(spelt(broken_at(ratio, *at)) for at in places)) for ratio in RATIOS[level]]
    columns = ("E₁/E₂", *(f"{other}, {100 * limit:g} % of {SIGNS[name]}" for other, limit, name in places))
    return SmallTable(
        "Thickness over contact radius without film, h/a₀, at which the film changes so much", columns, rows
    )


def spelt(thickness: float) -> str:
    return f"below {THIN:g}" if math.isnan(thickness) else f"{thickness:.4f}"


def radius_table(limits: Sequence[float]) -> SmallTable:
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
    columns = ("counter-body", "limit", *(f"for {SIGNS[name]} [µm]" for name in CHANGES))
    return SmallTable(
        "Contact radius below which the film of the paper changes more than the limit", columns, rows
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
    columns = ("E₁ [GPa]", "h [nm]", *(f"{other} [µm]" for other in COUNTER))
    caption = "Contact radius below which pressure or stress changes by more than 5 %, over the films of the paper's Table 2"
    return SmallTable(caption, columns, rows)


def own_stress_table(own: Sequence[tuple[float, str, Result]]) -> SmallTable:
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
    columns = (
        *("contact radius without film [µm]", "counter-body", "p_max [%]", "σvM of the body [%]"),
        *("σvM in the film [GPa]", "over its yield stress", "σvM in the body [GPa]"),
    )
    caption = f"The film of the paper, elastic, at {PRESSURE / 1e9:g} GPa without it: changes, and what it carries itself (SAM)"
    return SmallTable(caption, columns, rows)


def limit_words(breaking: dict[tuple[str, float, str], float]) -> str:
    """The answer to the question of the case."""
    radii = {
        other: PAPER_FILM / min(breaking[other, LIMITS[0], name] for name in CHANGES) for other in COUNTER
    }
    words = " and ".join(f"{1e6 * radius:.2f} µm under a {other} sphere" for other, radius in radii.items())
    return f"The film of 100 nm and 80 GPa changes pressure and stress by less than 5 % on contact radii above {words}."


def own_words(own: Sequence[tuple[float, str, Result]]) -> str:
    shares = [result.quantities["mises_max_film_Pa"] / FILM_YIELD for _, _, result in own]
    return (
        f"Negligible or not is said of pressure and body. The film itself, taken as elastic, carries {min(shares):.1f} to "
        f"{max(shares):.1f} times its yield stress of {FILM_YIELD / 1e9:g} GPa here: it would flow."
    )


def run_layer(context: Context) -> Outcome:
    """Changes by a layer of slightly softer steel, in both models."""
    base = context.scene("coated-sphere")
    solved = []
    for other, h, share in product(COUNTER, NC_THICKNESSES, NC_SHARES):
        if context.level == "quick" and (other, h, share) != NC_QUICK:
            continue
        scene = sphere_scene(base, paper_film(share * YOUNG, h), NC_RADIUS, other)
        solved.append(solve(context, scene, other, f"{other}-{1e9 * h:g}-{100 * share:g}"))
    outcome = Outcome({f"{context.case}.{name}": value for name, value in worst_errors(solved).items()})
    outcome.setup = [
        ("Layer", "1 and 0.5 µm of steel with Young's modulus lower by 5 and 10 %, bonded, ν = 0.3"),
        ("Contact", f"radius {1e6 * NC_RADIUS:g} µm and {PRESSURE / 1e9:g} GPa without the layer"),
    ]
    outcome.tables = [layer_table(solved)]
    largest = max(abs(change) for each in solved for change in (each.spectral.p, each.spectral.mises))
    outcome.notes.append(
        f"The largest change is {100 * largest:.2f} %: so much does an elastic calculation without layers miss where grains "
        "or pores have lowered the modulus as Fig. 4 of Bosman & Schipper (2011) shows."
    )
    return outcome


def layer_table(solved: Sequence[Solved]) -> SmallTable:
    rows = []
    for each in solved:
        film = each.scene.body.coating
        changes = of_result(each.sam), each.fem, each.spectral
        rows.append(
            (
                *(f"{1e6 * film.thickness:g}", percent(film.young / YOUNG - 1.0), each.counterbody),
                *(percent(getattr(change, name)) for name in CHANGES for change in changes),
            )
        )
    models = ("SAM", "FEM", "spectral")
    columns = (
        "h [µm]",
        "modulus [%]",
        "counter-body",
        *(f"{SIGNS[name]}, {model}" for name in CHANGES for model in models),
    )
    return SmallTable("Change by the layer in %, at equal force", columns, rows)


CASES = (
    Case(
        "film-limits",
        "Contact radii that break the claim",
        "Below which contact radius does the film of the paper change pressure or stress by more than 5 %, and what does it "
        "carry itself?",
        run_limits,
        EQUATIONS,
    ),
    Case(
        "nc-layer",
        "A nano-crystalline layer with a lower modulus",
        "What does a layer whose Young's modulus is 5 or 10 % lower change in pressure and stress?",
        run_layer,
        (
            *EQUATIONS[::2],
            ("Layer", "E₁ = 0.95 and 0.9 E₂", "Bosman & Schipper (2011), Fig. 4, after Kim & Bush (1999)"),
        ),
    ),
)
