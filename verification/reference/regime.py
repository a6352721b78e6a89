# SPDX-License-Identifier: MIT
"""What a spot under pressure does: its film stays whole, fails without harm to the metal, or fails and the
metal is removed.

The film of Bosman & Schipper (2011), Eqs. 12-17, read as in `bonded_film`, and their limit of the plastic
strain. Both are sufficient conditions at one point of the surface: the film's by the elastic body at the
centre of a Hertz contact, the metal's by equilibrium of the traction alone. Metal may be removed at less, as
the pressure also strains it.
"""

from __future__ import annotations

import math
from enum import StrEnum

from scipy.optimize import brentq

from .bonded_film import in_plane_strain
from .checks import not_negative, poisson, positive

MICROSTRAIN = 1e6


class Regime(StrEnum):
    """What happens at a spot."""

    WHOLE = "film whole"
    BARE = "film failed, metal holds"
    REMOVED = "film broken down, metal removed"


def swift(B: float, C: float, n: float, strain: float) -> float:
    """Yield stress B (C + 1e6 strain)^n in Pa of the paper's Eq. 18, which counts in microstrain."""
    return positive("B", B) * (positive("C", C) + MICROSTRAIN * not_negative("strain", strain)) ** positive(
        "n", n
    )


def tear_pressure(strength: float, friction: float) -> float:
    """Pressure in Pa above which the traction alone strains the surface past its limit: strength/(sqrt(3)
    friction).

    strength: yield stress in Pa of the surface at the limit, its factor over depth included. The shear stress
    at the surface is friction * p whatever flows, and sigma_y >= von Mises stress >= sqrt(3) |s_xz|.
    """
    return positive("strength", strength) / (math.sqrt(3.0) * positive("friction", friction))


def largest_pressure(yield_stress: float, friction: float) -> float:
    """Pressure in Pa above which a perfectly plastic film and its traction have no equilibrium."""
    return tear_pressure(yield_stress, friction) if friction else math.inf


def thinning(pressure: float, friction: float, strain: float, film: tuple[float, float, float]) -> float:
    """Normal plastic strain of the film, positive: thinner; 0 below yield, inf where no equilibrium exists.

    pressure in Pa; strain: of the body's surface, in every direction; film: Young's modulus in Pa, Poisson's
    ratio, yield stress in Pa. With szz = -p and sxz = friction p, yield fixes sxx = syy = s: (s + p)^2 + 3
    (friction p)^2 = yield_stress^2. Hooke's law takes its elastic share off the strain, what is left is
    plastic, and the film thins by twice that: of the path nothing is needed.
    """
    young, nu, yield_stress = film
    p, tau = not_negative("pressure", pressure), not_negative("friction", friction) * pressure
    room = positive("yield_stress", yield_stress) ** 2 - 3.0 * tau**2
    if room < 0.0:
        return math.inf
    s = math.sqrt(room) - p
    elastic = ((1.0 - poisson("nu", nu)) * s + nu * p) / positive("young", young)
    return max(0.0, 2.0 * (strain - elastic))


def film_pressure(
    limit: float,
    friction: float,
    film: tuple[float, float, float],
    body: tuple[float, float],
) -> float:
    """Pressure in Pa above which the film thins by more than `limit`, or has no equilibrium.

    film: Young's modulus in Pa, Poisson's ratio and yield stress in Pa; body: Young's modulus and Poisson's
    ratio, elastic, strained as at the centre of a Hertz contact.
    """
    yield_stress = film[2]

    def excess(p: float) -> float:
        return thinning(p, friction, in_plane_strain(p, *body), film) - positive("limit", limit)

    top = largest_pressure(yield_stress, friction)
    if math.isinf(top):
        top = 2.0 * yield_stress
        while excess(top) < 0.0:
            top *= 2.0
    elif excess(top * (1.0 - 1e-12)) < 0.0:
        return top
    else:
        top *= 1.0 - 1e-12
    return brentq(excess, 0.0, top, xtol=1e-9 * top)


def regime(pressure: float, film: float, removal: float) -> Regime:
    """Of a spot, from its pressure and those at which its film fails and bare metal is removed, in Pa."""
    if pressure <= film:
        return Regime.WHOLE
    return Regime.REMOVED if pressure > removal else Regime.BARE
