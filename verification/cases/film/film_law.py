# SPDX-License-Identifier: MIT
"""The law of the chemical film along a path against its rate equations, where it fails, and its growth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Friction
from sam.tribofilm import FilmLaw, FilmState
from verification.cases.case import Context, Plot
from verification.figures.lines import thinning_curves
from verification.reference.bonded_film import film_pressure, in_plane_strain, normal_strain
from verification.reference.convergence import fit_power
from verification.reference.film_flow import Film, FlowPoint

if TYPE_CHECKING:
    from pandas import DataFrame

    from verification.rows import CaseFile

__all__ = ["frame", "thinning_of_the_film"]

FILM, BODY = (80e9, 0.3, 2e9 / 3.0), (210e9, 0.3)
"""E in Pa and nu, of the film also its yield stress in Pa, a third of its hardness: Bosman & Schipper (2011),
section 4.
"""
FRICTIONS, HIGH = (0.0, 0.1), 0.4
TRACK, WIDTH, SPEED, THICKNESS = 314.15e-3, 300e-6, 1.0, 100e-9
SUBSTEPS = (16, 32, 64, 128)
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


def failure_pressure(mu: float, limit: float) -> float:
    """Pressure in Pa at which the law lets the film fail at the centre: bisected to rounding."""
    law, low, high = law_of(mu, limit), 0.0, 20e9
    while (middle := (low + high) / 2.0) not in (low, high):
        low, high = (low, middle) if at_centre(law, np.array([middle])).failed[0, 0] else (middle, high)
    return high


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """The pressure at which the film breaks down by friction, the growth in a cycle at the bath of the paper,
    and the law along a path against its rate equations.
    """
    friction, (errors, extrapolated) = friction_of(100.0), path_errors()
    for mu in FRICTIONS:
        row = {"sweep": "breakdown", "friction": mu, "fails": failure_pressure(mu, friction.thinning_limit)}
        yield row | {"fails expected": film_pressure(friction.thinning_limit, mu, FILM, BODY)}
    yield {"sweep": "growth", "growth": friction.growth}
    order = fit_power([1.0 / n for n in SUBSTEPS], errors).exponent
    yield {"sweep": "path", "order": order, "path": extrapolated}


def thinning_of_the_film(file: CaseFile, found: DataFrame) -> Plot:
    """Thinning over the pressure."""
    pressure = np.linspace(0.0, 6.5e9, 261)
    laws = {f"μ = {mu:g}": law_of(mu) for mu in FRICTIONS}
    laws["μ = 0.1, as printed"] = law_of(FRICTIONS[1], printed=True)
    states = {name: at_centre(law, pressure) for name, law in laws.items()}
    lines = {name: np.where(s.failed, np.nan, 100.0 * s.thinning)[:, 0] for name, s in states.items()}
    words = (
        "Thinning of the film against the pressure at the centre of a Hertz contact on elastic steel. The "
        "line at μ = 0.1 ends where no equilibrium exists; as printed the film grows thicker. Dotted: the "
        "growth of a cycle, within which the film lasts."
    )
    drawing = thinning_curves(pressure / 1e9, lines, 100.0 * friction_of(100.0).thinning_limit)
    return Plot(drawing, "thinning", "Thinning of the film", words, words)
