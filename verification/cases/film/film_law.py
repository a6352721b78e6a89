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
from verification.figures.film_law import thinning_curves
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
PRESSURES = (1e9, 2e9, 3e9, 3.5e9, 3.8e9, 4e9, 5e9, 6.5e9)
STATES = {"quick": 100, "full": 1000}
SUBSTEPS = (16, 32, 64, 128)
LOAD_STEPS, MANY_STEPS = (1, 2, 5, 10, 20, 50), 2000
PLACES, PEAK = (-0.9, -0.5, 0.0, 0.5, 0.9), 3.5e9


def law_of(mu: float, limit: float = math.inf, printed: bool = False) -> FilmLaw:
    """The film of the paper, tested with a low coefficient mu."""
    return FilmLaw(*FILM, mu, HIGH, limit, printed)


def friction_of(bath: float) -> Friction:
    """[friction] of the paper at a bath temperature in degrees Celsius."""
    young, poisson, strength = FILM
    return Friction(
        law="chemical-film",
        low=FRICTIONS[1],
        high=HIGH,
        film_thickness=THICKNESS,
        film_young=young,
        film_poisson=poisson,
        film_yield=strength,
        bath_temperature=bath + 273.15,
        track=TRACK,
        contact_width=WIDTH,
        speed=SPEED,
    )


def at_centre(law: FilmLaw, pressure: np.ndarray) -> FilmState:
    """A fresh film after one step to each pressure (n,), on a body strained as at the centre of a Hertz
    contact.
    """
    plane, normal = (
        np.array([strain(p, *BODY) for p in pressure])[:, None] for strain in (in_plane_strain, normal_strain)
    )
    strain = np.stack([plane, plane, np.zeros_like(plane)])
    return law.step(
        FilmState.fresh((len(pressure), 1)), strain, np.array(pressure)[:, None], bulk_normal=normal
    )


def exact_thinning(pressure: float, mu: float) -> float:
    """The thinning at the centre in closed form."""
    return thinning(pressure, mu, in_plane_strain(pressure, *BODY), FILM)


# --- errors ---------------------------------------------------------------------------------------------


def closed_form_error(mu: float) -> float:
    """Largest relative error of the thinning at the PRESSURES that the film can bear; absolute where it is
    0.
    """
    borne = [p for p in PRESSURES if p < largest_pressure(FILM[2], mu)]
    found, right = (
        at_centre(law_of(mu), np.array(borne)).thinning[:, 0],
        [exact_thinning(p, mu) for p in borne],
    )
    return max(abs(ours - exact) / (exact or 1.0) for ours, exact in zip(found, right, strict=True))


def general_error(count: int) -> float:
    """Largest error of the plastic strain after a step at mu = 0.1 from random states, over its largest
    component.

    Against the radial return in six components inside a root search.
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


def winding_path() -> list[FlowPoint]:
    """Strains pulled, sheared, pressed and let go, none in proportion to another: yields both ways."""
    corners = (
        *((0.0, 0.0, 0.0, 0.0), (0.004, 0.001, 0.002, 0.5e9), (-0.004, -0.002, 0.003, 3e9)),
        *((-0.002, -0.001, 0.0, 1e9), (0.0, 0.0, 0.0, 0.0)),
    )
    return [FlowPoint(np.array(strain), p, -FRICTIONS[1] * p) for *strain, p in corners]


def after_path(law: FilmLaw, substeps: int) -> np.ndarray:
    """Plastic strain (6,) after the winding path in so many steps a part."""
    state = FilmState.fresh((1, 1))
    for start, end in pairwise(winding_path()):
        for k in range(1, substeps + 1):
            point = start.towards(end, k / substeps)
            state = law.step(state, point.strain[:, None, None], np.array([[max(point.pressure, 0.0)]]))
    return state.plastic[:, 0, 0]


def path_errors() -> tuple[np.ndarray, float]:
    """Error of the plastic strain for each of SUBSTEPS, over its largest component, and that of the
    extrapolated one.
    """
    right = Film(*FILM).along(winding_path())
    found = np.array([after_path(law_of(FRICTIONS[1]), n) for n in SUBSTEPS])
    extrapolated = 2.0 * found[-1] - found[-2]  # the error is of first order
    errors = np.abs(np.vstack([found, extrapolated]) - right).max(axis=1) / np.abs(right).max()
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
    mu = FRICTIONS[1]
    shares = 1.0 + np.array([-1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3, 1.0])
    return int(
        np.sum(at_centre(law_of(mu), shares * largest_pressure(FILM[2], mu)).failed[:, 0] != (shares > 1.0))
    )


def printed_error() -> float:
    """Largest relative error of the printed form against its own closed form."""
    found = at_centre(law_of(FRICTIONS[1], printed=True), np.array(PRESSURES)).thinning[:, 0]
    right = np.array([printed_thinning(p, FRICTIONS[1], FILM, BODY) for p in PRESSURES])
    return float(np.abs(found / right - 1.0).max())


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


def growth_values() -> dict[str, Measured]:
    """Growth in a cycle against Eqs. 11 and 16 with Table 3, and against the number printed for 100 degrees
    Celsius.
    """
    ours = {T: friction_of(T).growth for T in growth_coefficients()}
    right = {T: 1e-9 * k * math.sqrt((TRACK - WIDTH) / SPEED) for T, k in growth_coefficients().items()}
    return {
        "growth": Measured(ours[100.0], right[100.0], unit="m"),
        "growth-limit": Measured(friction_of(100.0).thinning_limit, right[100.0] / THICKNESS),
        "growth-printed": Measured(ours[100.0], PRINTED_GROWTH, unit="m"),
        "growth-baths": Measured(max(abs(ours[T] / right[T] - 1.0) for T in right)),
    }


# --- tables ---------------------------------------------------------------------------------------------


def spelt(share: float) -> str:
    """A thinning in % for the reader."""
    return f"{100.0 * share:.4f}" if math.isfinite(share) else "no equilibrium"


def thinning_table() -> SmallTable:
    """Thinning over pressure: by the law, in closed form, and as printed."""
    rows = []
    states = [at_centre(law_of(mu), np.array(PRESSURES)) for mu in FRICTIONS]
    printed = [at_centre(law_of(mu, printed=True), np.array(PRESSURES)) for mu in FRICTIONS]
    for k, p in enumerate(PRESSURES):
        used = ("no equilibrium" if s.failed[k, 0] else spelt(s.thinning[k, 0]) for s in states)
        exact = (spelt(exact_thinning(p, mu)) for mu in FRICTIONS)
        rows.append((f"{p / 1e9:g}", *used, *exact, *(spelt(s.thinning[k, 0]) for s in printed)))
    kinds = ("μ = {:g}", "μ = {:g}, closed form", "μ = {:g}, as printed")
    return SmallTable(
        "Thinning of the film in % at the centre of a Hertz contact on an elastic body",
        ("p [GPa]", *(kind.format(mu) for kind in kinds for mu in FRICTIONS)),
        rows,
    )


def growth_table() -> SmallTable:
    """Growth over the bath temperature, and the pressures at which the film breaks down."""
    rows = []
    for bath, coefficient in growth_coefficients().items():
        friction = friction_of(bath)
        failures = (f"{failure_pressure(mu, friction.thinning_limit) / 1e9:.4f}" for mu in FRICTIONS)
        numbers = f"{bath:g}", f"{coefficient:g}", f"{1e9 * friction.growth:.4f}"
        rows.append((*numbers, f"{100.0 * friction.thinning_limit:.4f}", *failures))
    return SmallTable(
        "Growth in a cycle (Table 3, Eqs. 11, 16, 17) and the pressure at which the film fails",
        (
            "bath [°C]",
            "K₀ [nm/√s]",
            "growth [nm]",
            "limit [%]",
            *(f"fails, μ = {mu:g} [GPa]" for mu in FRICTIONS),
        ),
        rows,
    )


def sliding_strains(share: float) -> tuple[np.ndarray, np.ndarray]:
    """Strains (3, n, 1) of the body and pressure (n, 1) at the PLACES under a share of the load, contact
    radius 1 at the peak.
    """
    x, radius, (young, nu) = np.array(PLACES), share ** (1.0 / 3.0), BODY
    s = sliding_stress(x, 0.0, 0.0, PEAK * radius, contact_radius=radius, nu=nu, friction=FRICTIONS[1])
    xx, yy = s[:, 0] - nu * (s[:, 1] + s[:, 2]), s[:, 1] - nu * (s[:, 0] + s[:, 2])
    strain = np.stack([xx, yy, (1.0 + nu) * s[:, 5]]) / young
    pressure = PEAK * np.sqrt(np.maximum(radius**2 - x**2, 0.0))
    return strain[..., None], pressure[:, None]


def in_load_steps(steps: int) -> np.ndarray:
    """Thinning at the PLACES, (n,), of a sliding Hertz contact at its peak, loaded in equal steps of the
    force.
    """
    law, state = law_of(FRICTIONS[1]), FilmState.fresh((len(PLACES), 1))
    for k in range(1, steps + 1):
        state = law.step(state, *sliding_strains(k / steps))
    return state.thinning[:, 0]


def steps_table() -> SmallTable:
    """Thinning over the number of load steps."""
    return SmallTable(
        (
            f"Thinning in % at places of a sliding Hertz contact (p₀ = {PEAK / 1e9:g} GPa, μ = 0.1) by "
            "equal steps of the force"
        ),
        ("steps", *(f"x/a = {x:g}" for x in PLACES)),
        [(f"{n}", *(spelt(e) for e in in_load_steps(n))) for n in (*LOAD_STEPS, MANY_STEPS)],
    )


# --- the case -------------------------------------------------------------------------------------------


def values(level: str) -> dict[str, Measured]:
    """Every gate of the case, by the end of its id."""
    limit, (errors, extrapolated) = friction_of(100.0).thinning_limit, path_errors()
    measured = {f"closed-form-{100 * mu:g}": Measured(closed_form_error(mu)) for mu in FRICTIONS}
    for mu in FRICTIONS:
        right = film_pressure(limit, mu, FILM, BODY)
        measured[f"fails-at-{100 * mu:g}"] = Measured(failure_pressure(mu, limit), right, unit="Pa")
    measured |= {
        "general": Measured(general_error(STATES[level])),
        "no-equilibrium": Measured(wrong_equilibria(), 0),
    }
    measured["path-order"] = Measured(fit_order([1.0 / n for n in SUBSTEPS], errors).order)
    measured["path"] = Measured(extrapolated)
    measured |= {"printed": Measured(printed_error()), "overall": Measured(overall_error())}
    return measured | growth_values()


def words() -> list[str]:
    """The answer to the question of the case, from the numbers."""
    (thickness, films), (young, moduli) = mean_of(table(2), "thickness"), mean_of(table(2), "young")
    limit = friction_of(100.0).thinning_limit
    fails = [failure_pressure(mu, limit) / 1e9 for mu in FRICTIONS]
    late = in_load_steps(10) - in_load_steps(MANY_STEPS)
    return [
        f"The film fails at {fails[0]:.3f} GPa without friction and at {fails[1]:.3f} GPa at μ = 0.1; from "
        f"{largest_pressure(FILM[2], FRICTIONS[1]) / 1e9:.3f} GPa on it cannot bear the traction at μ = 0.1 "
        f"at all. At μ = {HIGH:g} that would be {largest_pressure(FILM[2], HIGH) / 1e9:.3f} GPa: tested so, "
        "hardly a spot would be protected again.",
        "As printed (Eqs. 12 and 13) the film grows thicker under pressure, which enters as a tension; by "
        f"the size of its strain it would fail at {failure_pressure(FRICTIONS[1], limit, True) / 1e9:.3f} "
        "GPa (μ = 0.1).",
        f"Table 2: mean thickness {thickness:.0f} nm ({films} studies, bounds as values) and mean Young's "
        f"modulus {young:.1f} GPa ({moduli} studies); the paper works with 100 nm and 80 GPa.",
        f"Ten load steps give a thinning within {100.0 * np.abs(late).max():.3f} % of the thickness of that "
        "of many steps.",
    ]


class FilmBreakdown(Case):
    """The law, its growth and the pressures at which it lets the film break down."""

    def solve(self, context: Context) -> str:
        return context.level

    def measure(self, level: str) -> dict[str, Measured]:
        return values(level)

    def setup(self, level: str) -> list[tuple[str, str]]:
        return [
            (
                "Film",
                f"{FILM[0] / 1e9:g} GPa, ν = {FILM[1]:g}, yields at {FILM[2] / 1e9:.4f} GPa, 100 nm, "
                "perfectly plastic",
            ),
            ("Body", f"{BODY[0] / 1e9:g} GPa, ν = {BODY[1]:g}, elastic"),
            (
                "Growth",
                f"track {1e3 * TRACK:g} mm less contact width {1e6 * WIDTH:g} µm, {SPEED:g} m/s, 100 °C",
            ),
            ("Random states", f"{STATES[level]}, strains of 0.5 %, plastic strains of 0.3 %, μ = 0.1"),
        ]

    def tables(self, level: str) -> list[SmallTable]:
        return [thinning_table(), growth_table(), steps_table()]

    def notes(self, level: str) -> list[str]:
        return words()

    def figures(self, level: str) -> Iterator[Plot]:
        pressure = np.linspace(0.0, 6.5e9, 261)
        laws = {f"μ = {mu:g}": law_of(mu) for mu in FRICTIONS}
        laws["μ = 0.1, as printed"] = law_of(FRICTIONS[1], printed=True)
        lines = {name: curve(at_centre(law, pressure)) for name, law in laws.items()}
        yield Plot(
            thinning_curves(pressure / 1e9, lines, 100.0 * friction_of(100.0).thinning_limit),
            "thinning",
            "Thinning of the film",
            "Thinning of the film against the pressure: it passes the growth of a cycle at 4.3 GPa without "
            "and at 3.4 GPa with friction of 0.1, and as printed the film grows thicker.",
            "At the centre of a Hertz contact on elastic steel. The line at μ = 0.1 ends where no "
            "equilibrium exists. Dotted: the growth of a cycle, within which the film lasts.",
        )


def curve(state: FilmState) -> np.ndarray:
    """Thinning in %, NaN without equilibrium."""
    return np.where(state.failed, np.nan, 100.0 * state.thinning)[:, 0]


CASES = (FilmBreakdown("film-law"),)
