# SPDX-License-Identifier: MIT
"""The law of the chemical film against closed forms, a general solver and the rate equations; its growth;
Tables 2 and 3.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np

from sam.scene import Friction
from sam.tribofilm import FilmLaw, FilmState
from verification.cases.case import Case, Context, Measured, Plot, SmallTable
from verification.figures.lines import thinning_curves
from verification.reference.bonded_film import (
    in_plane_strain,
    normal_strain,
    overall_coefficient,
    printed_thinning,
)
from verification.reference.convergence import fit_order
from verification.reference.film_flow import Film, FlowPoint
from verification.reference.film_tables import growth_coefficients, mean_of, table
from verification.reference.hamilton import sliding_stress
from verification.reference.regime import film_pressure, largest_pressure, thinning

FILM, BODY = (80e9, 0.3, 2e9 / 3.0), (210e9, 0.3)
"""E in Pa and nu, of the film also its yield stress in Pa, a third of its hardness: Bosman & Schipper (2011),
section 4.
"""
FRICTIONS, HIGH = (0.0, 0.1), 0.4
TRACK, WIDTH, SPEED, THICKNESS = 314.15e-3, 300e-6, 1.0, 100e-9
PRINTED_GROWTH = 2.04e-9
PRESSURES = np.array((1e9, 2e9, 3e9, 3.5e9, 3.8e9, 4e9, 5e9, 6.5e9))
STATES = {"quick": 100, "full": 1000}
SUBSTEPS = (16, 32, 64, 128)
LOAD_STEPS = (1, 2, 5, 10, 20, 50, 2000)
PLACES, PEAK = np.array((-0.9, -0.5, 0.0, 0.5, 0.9)), 3.5e9
WINDING = [
    FlowPoint(np.array(strain), p, -FRICTIONS[1] * p)
    for *strain, p in (
        *((0.0, 0.0, 0.0, 0.0), (0.004, 0.001, 0.002, 0.5e9), (-0.004, -0.002, 0.003, 3e9)),
        *((-0.002, -0.001, 0.0, 1e9), (0.0, 0.0, 0.0, 0.0)),
    )
]
"""Strains pulled, sheared, pressed and let go, none in proportion to another: the film yields both ways."""


def law_of(mu: float, limit: float = math.inf, printed: bool = False) -> FilmLaw:
    """The film of the paper, tested with a low coefficient mu."""
    return FilmLaw(*FILM, mu, HIGH, limit, printed)


def friction_of(bath: float) -> Friction:
    """[friction] of the paper at a bath temperature in degrees Celsius."""
    young, poisson, strength = FILM
    film = {"film_thickness": THICKNESS, "film_young": young, "film_poisson": poisson, "film_yield": strength}
    track = {"track": TRACK, "contact_width": WIDTH, "speed": SPEED, "bath_temperature": bath + 273.15}
    return Friction(law="chemical-film", low=FRICTIONS[1], high=HIGH, **film, **track)


def at_centre(law: FilmLaw, pressure: np.ndarray) -> FilmState:
    """A fresh film after one step to each pressure (n,), on a body strained as at the centre of a Hertz
    contact.
    """
    plane, normal = (
        np.array([strain(p, *BODY) for p in pressure])[:, None] for strain in (in_plane_strain, normal_strain)
    )
    strain, fresh = np.stack([plane, plane, np.zeros_like(plane)]), FilmState.fresh((len(pressure), 1))
    return law.step(fresh, strain, np.array(pressure)[:, None], bulk_normal=normal)


def exact_thinning(pressure: float, mu: float) -> float:
    """The thinning at the centre in closed form."""
    return thinning(pressure, mu, in_plane_strain(pressure, *BODY), FILM)


def closed_form_error(mu: float) -> float:
    """Largest relative error of the thinning at the PRESSURES that the film can bear; absolute where it is
    0.
    """
    borne = PRESSURES[largest_pressure(FILM[2], mu) > PRESSURES]
    pairs = zip(at_centre(law_of(mu), borne).thinning[:, 0], borne, strict=True)
    exact = ((ours, exact_thinning(p, mu)) for ours, p in pairs)
    return max(abs(ours - right) / (right or 1.0) for ours, right in exact)


def general_error(count: int) -> float:
    """Largest error of the plastic strain after a step at mu = 0.1 from random states, over its largest
    component, against the radial return in six components inside a root search.
    """
    rng, law, film = np.random.default_rng(7), law_of(FRICTIONS[1]), Film(*FILM)
    pressure = rng.uniform(0.0, 0.97 * law.bearable_pressure, count)
    strain, plastic = rng.normal(scale=5e-3, size=(3, count)), rng.normal(scale=3e-3, size=(6, count))
    plastic[2] = -plastic[0] - plastic[1]
    state = FilmState(plastic[..., None], np.zeros((count, 1), dtype=bool))
    found = law.step(state, strain[..., None], pressure[:, None]).plastic[..., 0]
    right = [
        film.implicit_step(plastic[:, k], FlowPoint(strain[:, k], p, -law.low * p))
        for k, p in enumerate(pressure)
    ]
    return max(float(np.abs(found[:, k] - each).max() / np.abs(each).max()) for k, each in enumerate(right))


def path_errors() -> tuple[np.ndarray, float]:
    """Error of the plastic strain after the winding path in each of SUBSTEPS a part, over its largest
    component, and that of the extrapolated one.
    """
    law, right, found = law_of(FRICTIONS[1]), Film(*FILM).along(WINDING), []
    for substeps in SUBSTEPS:
        state = FilmState.fresh((1, 1))
        for start, end in pairwise(WINDING):
            for k in range(1, substeps + 1):
                point = start.towards(end, k / substeps)
                state = law.step(state, point.strain[:, None, None], np.array([[max(point.pressure, 0.0)]]))
        found.append(state.plastic[:, 0, 0])
    extrapolated = 2.0 * found[-1] - found[-2]  # the error is of first order
    errors = np.abs(np.vstack([*found, extrapolated]) - right).max(axis=1) / np.abs(right).max()
    return errors[:-1], float(errors[-1])


@cache
def failure_pressure(mu: float, limit: float, printed: bool = False) -> float:
    """Pressure in Pa at which the law lets the film fail at the centre: bisected to rounding."""
    law, low, high = law_of(mu, limit, printed), 0.0, 20e9
    while (middle := (low + high) / 2.0) not in (low, high):
        low, high = (low, middle) if at_centre(law, np.array([middle])).failed[0, 0] else (middle, high)
    return high


def wrong_equilibria() -> int:
    """Verdicts that are wrong a little below and above the pressure that the film can bear, without a limit
    of strain.
    """
    shares, mu = 1.0 + np.array([-1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3, 1.0]), FRICTIONS[1]
    failed = at_centre(law_of(mu), shares * largest_pressure(FILM[2], mu)).failed[:, 0]
    return int(np.sum(failed != (shares > 1.0)))


def overall_error() -> float:
    """Sum of the traction over that of the pressure, against low + (high - low) W_high/W, over a thousand
    spots.
    """
    pressure = np.random.default_rng(3).uniform(0.0, 6e9, 1000)
    law = law_of(FRICTIONS[1], friction_of(100.0).thinning_limit)
    state = at_centre(law, pressure)
    q = law.coefficient(state)[:, 0] * pressure
    right = overall_coefficient(pressure, state.failed[:, 0], law.low, law.high, cell_area=1e-12)
    return float(abs(q.sum() / pressure.sum() / right - 1.0))


def in_load_steps(steps: int) -> np.ndarray:
    """Thinning at the PLACES, (n,), of a sliding Hertz contact at its peak, loaded in equal steps of the
    force; its contact radius is 1.
    """
    law, state, (young, nu) = law_of(FRICTIONS[1]), FilmState.fresh((len(PLACES), 1)), BODY
    for k in range(1, steps + 1):
        radius = (k / steps) ** (1.0 / 3.0)
        load = {"contact_radius": radius, "nu": nu, "friction": FRICTIONS[1]}
        s = sliding_stress(PLACES, 0.0, 0.0, PEAK * radius, **load)
        xx, yy = s[:, 0] - nu * (s[:, 1] + s[:, 2]), s[:, 1] - nu * (s[:, 0] + s[:, 2])
        strain = np.stack([xx, yy, (1.0 + nu) * s[:, 5]]) / young
        pressure = PEAK * np.sqrt(np.maximum(radius**2 - PLACES**2, 0.0))
        state = law.step(state, strain[..., None], pressure[:, None])
    return state.thinning[:, 0]


class FilmBreakdown(Case):
    """The law, its growth and the pressures at which it lets the film break down."""

    def solve(self, context: Context) -> str:
        return context.level

    def measure(self, level: str) -> dict[str, Measured | float]:
        friction, (errors, extrapolated) = friction_of(100.0), path_errors()
        values: dict[str, Measured | float] = {}
        for mu in FRICTIONS:
            right = film_pressure(friction.thinning_limit, mu, FILM, BODY)
            found = failure_pressure(mu, friction.thinning_limit)
            values |= {f"closed-form-{100 * mu:g}": closed_form_error(mu)}
            values |= {f"fails-at-{100 * mu:g}": Measured(found, right, unit="Pa")}
        printed = np.array([printed_thinning(p, FRICTIONS[1], FILM, BODY) for p in PRESSURES])
        ours = at_centre(law_of(FRICTIONS[1], printed=True), PRESSURES).thinning[:, 0]
        growth = {T: 1e-9 * k * math.sqrt((TRACK - WIDTH) / SPEED) for T, k in growth_coefficients().items()}
        return values | {
            "general": general_error(STATES[level]),
            "no-equilibrium": Measured(wrong_equilibria(), 0),
            "path-order": fit_order([1.0 / n for n in SUBSTEPS], errors).order,
            "path": extrapolated,
            "printed": float(np.abs(ours / printed - 1.0).max()),
            "overall": overall_error(),
            "growth": Measured(friction.growth, growth[100.0], unit="m"),
            "growth-limit": Measured(friction.thinning_limit, growth[100.0] / THICKNESS),
            "growth-printed": Measured(friction.growth, PRINTED_GROWTH, unit="m"),
            "growth-baths": max(abs(friction_of(T).growth / right - 1.0) for T, right in growth.items()),
        }

    def setup(self, level: str) -> Iterator[tuple[str, str]]:
        young, nu, strength = FILM
        words = f"{young / 1e9:g} GPa, ν = {nu:g}, yields at {strength / 1e9:.4f} GPa, 100 nm"
        yield "Film", f"{words}, perfectly plastic"
        yield "Body", f"{BODY[0] / 1e9:g} GPa, ν = {BODY[1]:g}, elastic"
        way = f"track {1e3 * TRACK:g} mm less contact width {1e6 * WIDTH:g} µm"
        yield "Growth", f"{way}, {SPEED:g} m/s, 100 °C"
        yield "Random states", f"{STATES[level]}, strains of 0.5 %, plastic strains of 0.3 %, μ = 0.1"

    def tables(self, level: str) -> Iterator[SmallTable]:
        rows = []
        for bath, coefficient in growth_coefficients().items():
            friction = friction_of(bath)
            fails = (f"{failure_pressure(mu, friction.thinning_limit) / 1e9:.4f}" for mu in FRICTIONS)
            limit = f"{100.0 * friction.thinning_limit:.4f}"
            rows.append((f"{bath:g}", f"{coefficient:g}", f"{1e9 * friction.growth:.4f}", limit, *fails))
        fails = (f"fails, μ = {mu:g} [GPa]" for mu in FRICTIONS)
        yield SmallTable(
            "Growth in a cycle (Table 3, Eqs. 11, 16, 17) and the pressure at which the film fails",
            ("bath [°C]", "K₀ [nm/√s]", "growth [nm]", "limit [%]", *fails),
            rows,
        )
        yield SmallTable(
            f"Thinning in % at places of a sliding Hertz contact (p₀ = {PEAK / 1e9:g} GPa, μ = 0.1) by equal "
            "steps of the force",
            ("steps", *(f"x/a = {x:g}" for x in PLACES)),
            [(f"{n}", *(f"{100.0 * e:.4f}" for e in in_load_steps(n))) for n in LOAD_STEPS],
        )

    def notes(self, level: str) -> Iterator[str]:
        (thickness, films), (young, moduli) = mean_of(table(2), "thickness"), mean_of(table(2), "young")
        limit = friction_of(100.0).thinning_limit
        fails = [failure_pressure(mu, limit) / 1e9 for mu in FRICTIONS]
        bears = [largest_pressure(FILM[2], mu) / 1e9 for mu in (FRICTIONS[1], HIGH)]
        yield (
            f"The film fails at {fails[0]:.3f} GPa without friction and at {fails[1]:.3f} GPa at μ = 0.1; "
            f"from {bears[0]:.3f} GPa on it cannot bear the traction at μ = 0.1 at all. At μ = {HIGH:g} that "
            f"would be {bears[1]:.3f} GPa: tested so, hardly a spot would be protected again."
        )
        yield (
            "As printed (Eqs. 12 and 13) the film grows thicker under pressure, which enters as a tension; "
            "by the size of its strain it would fail at "
            f"{failure_pressure(FRICTIONS[1], limit, True) / 1e9:.3f} GPa (μ = 0.1)."
        )
        yield (
            f"Table 2: mean thickness {thickness:.0f} nm ({films} studies, bounds as values) and mean "
            f"Young's modulus {young:.1f} GPa ({moduli} studies); the paper works with 100 nm and 80 GPa."
        )

    def figures(self, level: str) -> Iterator[Plot]:
        pressure = np.linspace(0.0, 6.5e9, 261)
        laws = {f"μ = {mu:g}": law_of(mu) for mu in FRICTIONS}
        laws["μ = 0.1, as printed"] = law_of(FRICTIONS[1], printed=True)
        states = {name: at_centre(law, pressure) for name, law in laws.items()}
        lines = {name: np.where(s.failed, np.nan, 100.0 * s.thinning)[:, 0] for name, s in states.items()}
        yield Plot(
            thinning_curves(pressure / 1e9, lines, 100.0 * friction_of(100.0).thinning_limit),
            "thinning",
            "Thinning of the film",
            "Thinning of the film against the pressure: it passes the growth of a cycle at 4.3 GPa without "
            "and at 3.4 GPa with friction of 0.1, and as printed the film grows thicker.",
            "At the centre of a Hertz contact on elastic steel. The line at μ = 0.1 ends where no "
            "equilibrium exists. Dotted: the growth of a cycle, within which the film lasts.",
        )


CASES = (FilmBreakdown("film-law"),)
