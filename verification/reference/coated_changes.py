# SPDX-License-Identifier: MIT
"""What a film changes under a sphere at equal load: largest pressure and largest von Mises stress, and where
it matters.

Everything depends on the ratios of the moduli, Poisson's ratios and thickness/a0 only, with a0 the Hertz
radius of the contact without the film. A change is (coated - bare)/bare; the body is z >= thickness in both,
the bare one too.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from .checks import positive
from .coated_sphere import CoatedContact, solve_force
from .hertz import CircularContact, subsurface_stress
from .layered_axisymmetric import CoatedHalfSpace
from .stress import von_mises

THIN, START, THICK = 2e-3, 0.02, 10.0
"""Range of thickness/a0 that ``breaking_thickness`` searches: upwards from START, below it, where a change is
linear, down."""
STEP = 1.5
"""Ratio of its steps."""


class LargestChange(NamedTuple):
    """A largest value (Pa) and where it is (m)."""

    value: float
    r: float
    z: float


def film_contact(
    thickness: float,
    young: float,
    poisson: float = 0.3,
    poisson_body: float = 0.3,
    *,
    counter: float = math.inf,
) -> CoatedContact:
    """The contact in units of the body and of a0: body modulus E2/(1 - nu2^2) = 1, R = 1, a0 = 1. thickness:
    over a0; young: E1/E2; counter: contact modulus of the counter-body over the body's, infinite if rigid.
    """
    body = 1.0 - poisson_body**2
    layers = CoatedHalfSpace(positive("young", young) * body, poisson, thickness, body, poisson_body)
    return solve_force(layers, 1.0, 4.0 / 3.0 / (1.0 + 1.0 / counter), counter)


def pressure_change(contact: CoatedContact) -> float:
    """(p_max - p0)/p0: p_max wherever it lies."""
    return contact.largest_pressure()[0] / contact.bare.peak_pressure - 1.0


def mises_change(contact: CoatedContact) -> float:
    """Change of the largest von Mises stress in z >= thickness."""
    return largest_mises(contact).value / largest_bare_mises(contact).value - 1.0


def largest_mises(contact: CoatedContact, film: bool = False) -> LargestChange:
    """Largest von Mises stress in the body, or in the film, searched in the whole half-plane."""
    a, h = contact.contact_radius, contact.layers.thickness
    if film:
        return _on_one_side(lambda r, z: contact.stress(r, z, film=True), 1.5 * a, 0.0, h, power=1.0)
    return _on_one_side(lambda r, z: contact.stress(r, z, film=False), a + h, h, h + 1.5 * (a + h), power=2.0)


def largest_bare_mises(contact: CoatedContact) -> LargestChange:
    """Largest von Mises stress without the film at the same force, in z >= thickness."""
    bare: CircularContact = contact.bare
    a, h, nu = bare.contact_radius, contact.layers.thickness, contact.layers.poisson_body

    def field(r, z):
        return subsurface_stress(r[:, None], 0.0, z[None, :], bare.peak_pressure, contact_radius=a, nu=nu)

    return _on_one_side(field, a + h, h, h + 1.5 * (a + h), power=2.0)


def _on_one_side(field: Callable, width: float, top: float, bottom: float, *, power: float) -> LargestChange:
    """``search`` in r <= width, top <= z <= bottom."""
    depths = top + (bottom - top) * np.linspace(0.0, 1.0, 25) ** power
    return search(field, np.linspace(0.0, width, 25), depths)


def search(field: Callable, r: np.ndarray, depths: np.ndarray) -> LargestChange:
    """Largest von Mises stress of field(r, z): on a grid of ascending r (n,) and z (m,), then on finer ones
    around it. Five grids, each four times finer than the last: with 25 places the place to about 2e-4 of the
    range, the value to 1e-7.
    """
    for _ in range(5):
        mises = von_mises(field(r, depths))
        i, j = np.unravel_index(np.argmax(mises), mises.shape)
        best = LargestChange(float(mises[i, j]), float(r[i]), float(depths[j]))
        r, depths = (
            np.linspace(grid[max(int(k) - 1, 0)], grid[min(int(k) + 1, len(grid) - 1)], 9)
            for grid, k in ((r, i), (depths, j))
        )
    return best


def breaking_thickness(
    young: float,
    poisson: float = 0.3,
    poisson_body: float = 0.3,
    counter: float = math.inf,
    *,
    limit: float = 0.05,
    change: Callable[[CoatedContact], float] = pressure_change,
) -> float:
    """Smallest thickness/a0 at which |change| reaches the limit; infinite if it does not up to ``THICK``.
    young: E1/E2; counter: contact modulus of the counter-body over the body's; change: ``pressure_change`` or
    ``mises_change``. ValueError if the limit is passed at ``THIN`` already.
    """
    positive("limit", limit)

    @cache
    def excess(log_thickness: float) -> float:
        contact = film_contact(math.exp(log_thickness), young, poisson, poisson_body, counter=counter)
        return abs(change(contact)) - limit

    lower = math.log(START)
    while excess(lower) >= 0:
        lower -= math.log(STEP)
        if lower < math.log(THIN):
            thinnest = f"thickness/a0 = {THIN:g} already, the thinnest film searched"
            raise ValueError(f"limit = {limit:g} is passed at {thinnest}")
    while lower < math.log(THICK):
        upper = lower + math.log(STEP)
        if excess(upper) >= 0:
            return math.exp(brentq(excess, lower, upper, xtol=1e-6))
        lower = upper
    return math.inf
