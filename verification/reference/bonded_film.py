# SPDX-License-Identifier: MIT
"""A thin film bonded on a half-space under a frictionless smooth contact: its stress and plastic strain at
the centre, its flow.

The film of Bosman & Schipper (2011), Eqs. 12-14, without traction: the pressure p acts through it, and in the
surface it is strained as the body is. Printed, Eq. 12 gives the film all three strains of the body with half
the shear term, E/(2(1 + nu)) where Hooke's law has E/(1 + nu), and Eq. 13 adds p to the normal stress that
results. Used: the strains in the surface only, Hooke's law, and a normal stress of -p, as a bonded film
shares no other strain and equilibrium fixes that stress.
"""

from __future__ import annotations

import math

import numpy as np

from .checks import not_negative, poisson, positive


def in_plane_strain(pressure: float, young: float, nu: float) -> float:
    """Strain of the body's surface in every direction at the centre of Hertz's contact (Johnson 1985, Eq.
    3.46 in Hooke's law).

    sxx = syy = -(1 + 2 nu)/2 p and szz = -p: strain -(1 + nu)(1 - 2 nu)/2 p/E. pressure: p(0) in Pa; young,
    nu: of the body.
    """
    nu = poisson("nu", nu)
    return (
        -(1.0 + nu) * (1.0 - 2.0 * nu) / 2.0 * not_negative("pressure", pressure) / positive("young", young)
    )


def normal_strain(pressure: float, young: float, nu: float) -> float:
    """Strain of the body along z at the same place: twice that in the surface, -(1 + nu)(1 - 2 nu) p/E."""
    return 2.0 * in_plane_strain(pressure, young, nu)


def elastic_mises(pressure: float, strain: float, young: float, nu: float) -> float:
    """Von Mises stress in Pa of the elastic film: p + sxx, sxx = (E strain - nu p)/(1 - nu)."""
    return pressure + (positive("young", young) * strain - poisson("nu", nu) * pressure) / (1.0 - nu)


def plastic_strain(pressure: float, strain: float, film: tuple[float, float, float]) -> float:
    """Thinning of the perfectly plastic film under p, the strain in the surface kept; 0 below yield.

    film: Young's modulus in Pa, Poisson's ratio, yield stress in Pa.
    Plastic strains (e/2, e/2, -e) relieve the von Mises stress by E e/(2(1 - nu)) down to the yield stress.
    """
    young, nu, yield_stress = film
    excess = elastic_mises(pressure, strain, young, nu) - positive("yield_stress", yield_stress)
    return max(0.0, excess) * 2.0 * (1.0 - nu) / young


def printed_thinning(
    pressure: float, friction: float, film: tuple[float, float, float], body: tuple[float, float]
) -> float:
    """Thinning at the centre of Hertz's contact by Eqs. 12-14 as printed: negative, as the film grows thicker
    there.

    film: E and nu, then the yield stress in Pa; body: E in Pa and nu. Of the printed stress only szz - sxx,
    to which the sum of the strains gives nothing, and sxz = friction p count; the stress returns to the yield
    stress radially, at given strains.
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
    W_high/W.

    pressure in Pa and failed (bool) of each cell, one shape; cell_area in m^2. ValueError without load.
    """
    pressure, failed = np.asarray(pressure, dtype=float), np.asarray(failed, dtype=bool)
    if pressure.shape != failed.shape:
        raise ValueError(f"pressure {pressure.shape} and failed {failed.shape} must have one shape")
    area = positive("cell_area", cell_area)
    load = positive("load", math.fsum(pressure.ravel()) * area)
    return low + (high - low) * math.fsum(pressure[failed]) * area / load


def flow_gradient(yield_stress: float, thickness: float) -> float:
    """Pressure gradient in Pa/m at which the film flows out, bonded below and smooth above:
    yield_stress/(sqrt(3) thickness).

    The shear stress on the bonded face, the shear yield stress there, balances the change of the pressure
    over the thickness. Of first order in thickness over radius; twice that between two rough plates (Prandtl
    1923; Hill 1950, chapter VIII).
    """
    return positive("yield_stress", yield_stress) / math.sqrt(3.0) / positive("thickness", thickness)
