# SPDX-License-Identifier: MIT
"""A thin film bonded on a half-space under a smooth contact: its stress, plastic strain and flow, and what a
spot under pressure does: its film stays whole, fails without harm to the metal, or fails and the metal is
removed.

The film of Bosman & Schipper (2011), Eqs. 12-14, without traction: the pressure p acts through it, and in the
surface it is strained as the body is. Printed, Eq. 12 gives the film all three strains of the body with half
the shear term, E/(2(1 + nu)) where Hooke's law has E/(1 + nu), and Eq. 13 adds p to the normal stress that
results. Used: the strains in the surface only, Hooke's law, and a normal stress of -p, as a bonded film
shares no other strain and equilibrium fixes that stress.

That a film fails, and that metal is removed, are sufficient conditions at one point of the surface: the
film's by the elastic body at the centre of a Hertz contact, the metal's by equilibrium of the traction alone
(Eqs. 15-17, and their limit of the plastic strain). Metal may be removed at less, as the pressure strains it
too.
"""

import math
from enum import StrEnum

import numpy as np
from scipy.optimize import brentq

from .checks import not_negative, poisson, positive


def in_plane_strain(pressure: float, young: float, nu: float) -> float:
    """Strain of the body's surface in every direction at the centre of Hertz's contact (Johnson 1985, Eq.
    3.46 in Hooke's law). sxx = syy = -(1 + 2 nu)/2 p and szz = -p: strain -(1 + nu)(1 - 2 nu)/2 p/E.
    pressure: p(0) in Pa; young, nu: of the body.
    """
    nu, strain = poisson("nu", nu), not_negative("pressure", pressure) / positive("young", young)
    return -(1.0 + nu) * (1.0 - 2.0 * nu) / 2.0 * strain


def normal_strain(pressure: float, young: float, nu: float) -> float:
    """Strain of the body along z at the same place: twice that in the surface, -(1 + nu)(1 - 2 nu) p/E."""
    return 2.0 * in_plane_strain(pressure, young, nu)


def elastic_mises(pressure: float, strain: float, young: float, nu: float) -> float:
    """Von Mises stress in Pa of the elastic film: p + sxx, sxx = (E strain - nu p)/(1 - nu)."""
    return pressure + (positive("young", young) * strain - poisson("nu", nu) * pressure) / (1.0 - nu)


def printed_thinning(
    pressure: float, friction: float, film: tuple[float, float, float], body: tuple[float, float]
) -> float:
    """Thinning at the centre of Hertz's contact by Eqs. 12-14 as printed: negative, as the film grows thicker
    there. film: E and nu, then the yield stress in Pa; body: E in Pa and nu. Of the printed stress only szz -
    sxx, to which the sum of the strains gives nothing, and sxz = friction p count; the stress returns to the
    yield stress radially, at given strains.
    """
    (young, nu, yield_stress), p = film, not_negative("pressure", pressure)
    shear = positive("young", young) / (2.0 * (1.0 + poisson("nu", nu)))
    across = shear * (normal_strain(p, *body) - in_plane_strain(p, *body)) + p  # szz - sxx
    mises = math.hypot(across, math.sqrt(3.0) * not_negative("friction", friction) * p)
    if mises <= positive("yield_stress", yield_stress):
        return 0.0
    return -(mises - yield_stress) / (3.0 * shear) * across / mises  # 3/2 dgamma s/q, s = 2/3 across


def overall_coefficient(pressure, failed, low: float, high: float, *, cell_area: float) -> float:
    """Traction over load where a film has low friction and its failed cells high: low + (high - low)
    W_high/W. pressure in Pa and failed (bool) of each cell, one shape; cell_area in m^2. ValueError without
    load.
    """
    pressure, failed = np.asarray(pressure, dtype=float), np.asarray(failed, dtype=bool)
    if pressure.shape != failed.shape:
        raise ValueError(f"pressure {pressure.shape} and failed {failed.shape} must have one shape")
    area = positive("cell_area", cell_area)
    load = positive("load", math.fsum(pressure.ravel()) * area)
    return low + (high - low) * math.fsum(pressure[failed]) * area / load


def flow_gradient(yield_stress: float, thickness: float) -> float:
    """Pressure gradient in Pa/m at which the film flows out, bonded below and smooth above:
    yield_stress/(sqrt(3) thickness). The shear stress on the bonded face, the shear yield stress there,
    balances the change of the pressure over the thickness. Of first order in thickness over radius; twice
    that between two rough plates (Prandtl 1923; Hill 1950, chapter VIII).
    """
    return positive("yield_stress", yield_stress) / math.sqrt(3.0) / positive("thickness", thickness)


MICROSTRAIN = 1e6


class Regime(StrEnum):
    """What happens at a spot."""

    WHOLE = "film whole"
    BARE = "film failed, metal holds"
    REMOVED = "film broken down, metal removed"


def swift(B: float, C: float, n: float, strain: float) -> float:
    """Yield stress B (C + 1e6 strain)^n in Pa of the paper's Eq. 18, which counts in microstrain."""
    total = positive("C", C) + MICROSTRAIN * not_negative("strain", strain)
    return positive("B", B) * total ** positive("n", n)


def tear_pressure(strength: float, friction: float) -> float:
    """Pressure in Pa above which the traction alone strains the surface past its limit: strength/(sqrt(3)
    friction). strength: yield stress in Pa of the surface at the limit, its factor over depth included. The
    shear stress at the surface is friction * p whatever flows, and sigma_y >= von Mises stress >= sqrt(3)
    |s_xz|.
    """
    return positive("strength", strength) / (math.sqrt(3.0) * positive("friction", friction))


def largest_pressure(yield_stress: float, friction: float) -> float:
    """Pressure in Pa above which a perfectly plastic film and its traction have no equilibrium."""
    return tear_pressure(yield_stress, friction) if friction else math.inf


def thinning(pressure: float, friction: float, strain: float, film: tuple[float, float, float]) -> float:
    """Normal plastic strain of the perfectly plastic film, positive: thinner; 0 below yield, inf without
    equilibrium. pressure in Pa; strain: of the body's surface, in every direction; film: Young's modulus in
    Pa, Poisson's ratio, yield stress in Pa. With szz = -p and sxz = friction p, yield fixes sxx = syy = s: (s
    + p)^2 + 3 (friction p)^2 = yield_stress^2. Hooke's law takes its elastic share off the strain, what is
    left is plastic, and the film thins by twice that: of the path nothing is needed.
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
    limit: float, friction: float, film: tuple[float, float, float], body: tuple[float, float]
) -> float:
    """Pressure in Pa above which the film thins by more than `limit`, or has no equilibrium. film: Young's
    modulus in Pa, Poisson's ratio and yield stress in Pa; body: Young's modulus and Poisson's ratio, elastic,
    strained as at the centre of a Hertz contact.
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
