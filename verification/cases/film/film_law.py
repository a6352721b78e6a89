# SPDX-License-Identifier: MIT
"""The law of the chemical film along a path against its rate equations, where it fails, and its growth."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from sam.scene import Friction
from sam.tribofilm import FilmLaw, FilmState
from verification.cases.case import Context
from verification.reference.bonded_film import film_pressure, in_plane_strain, normal_strain
from verification.reference.convergence import fit_power
from verification.reference.film_flow import Film, FlowPoint

FILM, BODY = (80e9, 0.3, 2e9 / 3.0), (210e9, 0.3)
"""E in Pa and nu, of the film also its yield stress in Pa: Bosman & Schipper (2011), section 4."""
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
    """A fresh film after one step to each pressure (n,), strained as at the centre of a Hertz contact."""
    plane, normal = (
        np.array([strain(p, *BODY) for p in pressure])[:, None] for strain in (in_plane_strain, normal_strain)
    )
    strain, fresh = np.stack([plane, plane, np.zeros_like(plane)]), FilmState.fresh((len(pressure), 1))
    return law.step(fresh, strain, np.array(pressure)[:, None], bulk_normal=normal)


def path_errors() -> tuple[np.ndarray, float]:
    """Errors of the strain after WINDING with SUBSTEPS a part, over its largest component; extrapolated."""
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
    """The thinning and the pressure at which the film breaks down by friction, and the thinning by the
    equations as printed; the growth in a cycle at the bath of the paper; and the law along a path against its
    rate equations.
    """
    friction, (errors, extrapolated) = friction_of(100.0), path_errors()
    pressure, laws = np.linspace(0.0, 6.5e9, 27), {mu: law_of(mu) for mu in FRICTIONS}
    for name, law in (laws | {"0.1, as printed": law_of(FRICTIONS[1], printed=True)}).items():
        state = at_centre(law, pressure)
        thinning = np.where(state.failed, np.nan, state.thinning)[:, 0]
        row = {"sweep": "breakdown", "friction": name, "pressure": pressure, "thinning": thinning}
        if name in laws:
            row["fails"] = failure_pressure(name, friction.thinning_limit)
            row["fails expected"] = film_pressure(friction.thinning_limit, name, FILM, BODY)
        yield row
    yield {"sweep": "growth", "growth": friction.growth, "over the thickness": friction.thinning_limit}
    order = fit_power([1.0 / n for n in SUBSTEPS], errors).exponent
    yield {"sweep": "path", "order": order, "path": extrapolated}
