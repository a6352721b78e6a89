# SPDX-License-Identifier: MIT
"""Displacements on the outer boundary of a mesh: those of the point forces that balance the contact on the
half-space, of Boussinesq and Cerruti.
"""

from __future__ import annotations

from importlib import import_module

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Coating, Elastic


def boussinesq(force: float, body: Elastic, r: Array, z: Array) -> Array:
    """Displacements (u_r, u_z) of the half-space z >= 0 under `force` along +z at the origin.

    Johnson, Contact Mechanics (1985), Eq. (3.18a, c); with R^2 = r^2 + z^2 and G = E / (2 (1 + nu)):

        u_r = F / (4 pi G) [ r z / R^3 - (1 - 2 nu) r / (R (R + z)) ]
        u_z = F / (4 pi G) [ z^2 / R^3 + 2 (1 - nu) / R ]

    r, z: (n,) in m, not both zero; force in N, body.young in Pa (or any consistent units). Returns (2, n)
    in m.
    """
    young, poisson = body.young, body.poisson
    R = np.hypot(r, z)
    factor = force * (1.0 + poisson) / (2.0 * np.pi * young)
    u_r = factor * (r * z / R**3 - (1.0 - 2.0 * poisson) * r / (R * (R + z)))  # Johnson, Eq. (3.18a)
    u_z = factor * (z**2 / R**3 + 2.0 * (1.0 - poisson) / R)  # Johnson, Eq. (3.18c)
    return np.stack([u_r, u_z])


def cerruti(force: float, body: Elastic, points: Array) -> Array:
    """Displacements (u_x, u_y, u_z) of the half-space z >= 0 under `force` along +x at the origin of its
    surface.

    Johnson, Contact Mechanics (1985), Eq. (3.75); with R^2 = x^2 + y^2 + z^2 and G = E / (2 (1 + nu)):

        u_x = F / (4 pi G) [ 1/R + x^2/R^3 + (1 - 2 nu) (1/(R + z) - x^2 / (R (R + z)^2)) ]
        u_y = F / (4 pi G) [ x y/R^3 - (1 - 2 nu) x y / (R (R + z)^2) ]
        u_z = F / (4 pi G) [ x z/R^3 + (1 - 2 nu) x / (R (R + z)) ]

    points: x, y, z (3, n) in m, not all zero; force in N, body.young in Pa (or any consistent units).
    Returns (3, n) in m.
    """
    (x, y, z), young, poisson = points, body.young, body.poisson
    R = np.sqrt(x**2 + y**2 + z**2)
    soft, over = 1.0 - 2.0 * poisson, 1.0 / (R * (R + z) ** 2)
    u_x = 1.0 / R + x**2 / R**3 + soft * (1.0 / (R + z) - x**2 * over)  # Johnson, Eq. (3.75)
    u_y = x * y / R**3 - soft * x * y * over
    u_z = x * z / R**3 + soft * x / (R * (R + z))
    return force * (1.0 + poisson) / (2.0 * np.pi * young) * np.stack([u_x, u_y, u_z])


def slanted(load: tuple[float, float], body: Elastic, points: Array) -> Array:
    """Displacements (3, n) under the forces `load` along z and x at the origin; points: (3, n)."""
    x, y, z = points
    r = np.hypot(x, y)
    u_r, u_z = boussinesq(load[0], body, r, z)
    outward = np.stack([x, y]) / np.where(r > 0.0, r, 1.0)
    u = np.stack([*(u_r * outward), u_z])
    return u + cerruti(load[1], body, points) if load[1] else u


def flamant(forces: tuple[float, float], body: Elastic, points: Array, datum: float) -> Array:
    """Displacements (u_x, u_z) in plane strain of the half-space z >= 0 under the line forces P along +z and
    Q along +x at the origin of its surface.

    The integrals of `boussinesq` and `cerruti` along the line, without their infinite constants; with r^2 =
    x^2 + z^2, t the angle from the z axis and G = E / (2 (1 + nu)):

        u_x = P / (2 pi G) [ x z/r^2 - (1 - 2 nu) t ] - Q / (2 pi G) [ z^2/r^2 + 2 (1 - nu) ln(r/datum) ]
        u_z = P / (2 pi G) [ z^2/r^2 - 2 (1 - nu) ln(r/datum) ] + Q / (2 pi G) [ x z/r^2 + (1 - 2 nu) t ]

    On the surface the displacement along each force is zero at the distance `datum` (Johnson 1985, Eq. 2.19
    and 2.22). forces: (P, Q) per length; points: x, z (2, n), not both zero. Returns (2, n).
    """
    (x, z), nu = points, body.poisson
    square, angle = x**2 + z**2, np.arctan2(x, z)
    deep, mixed, soft = z**2 / square, x * z / square, (1.0 - 2.0 * nu) * angle
    rise = (1.0 - nu) * np.log(square / datum**2)
    down, along = (force * (1.0 + nu) / (np.pi * body.young) for force in forces)
    return np.stack(
        [down * (mixed - soft) - along * (deep + rise), down * (deep - rise) + along * (mixed + soft)]
    )


def stretched(body: Elastic, points: Array) -> tuple[Array, Array]:
    """Displacements (u_x, u_z), each (2, ...), in plane strain far from a plastic strain near the origin of
    the surface, of which e_xx + nu e_yy has the integral one over the area; and further ones per depth of it.

    By reciprocity with a force far away, which stresses the free surface along it alone (s_yy = nu s_xx), the
    strain acts as a dipole E/(1 - nu^2) of forces along x; and as du_x/dz = -du_z/dx on the surface, its
    depth as twice the derivative of the forces along z. Of `flamant`, these are minus the derivative along x
    of Q's, and minus the second one of P's:

        u_x = 2 (1 - nu) x/r^2 - 2 x z^2/r^4        4 x z/r^4 (1 + nu - 2 x^2/r^2)
        u_z = 2 x^2 z/r^4 - 2 (1 - nu) z/r^2        2 z^2/r^4 (1 - 4 x^2/r^2) + 2 (1 - nu)/r^2 (1 - 2 x^2/r^2)

    over pi (1 - nu). points: x, z (2, ...), not both zero. Second order in depth over distance.
    """
    (x, z), soft = points, 1.0 - body.poisson
    square = x**2 + z**2
    X, Z = x**2 / square, z**2 / square
    u = 2.0 * np.stack([x * (soft - Z), z * (X - soft)]) / square
    deeper = np.stack(
        [2.0 * x * z / square * (2.0 - soft - 2.0 * X), Z * (1.0 - 4.0 * X) + soft * (1.0 - 2.0 * X)]
    )
    return u / (np.pi * soft), 2.0 * deeper / (np.pi * soft * square)


LAYERED = "fem_reference.common.layered_force"
"""Loaded for a coated body alone."""


def words_of(coating: Coating | None) -> str:
    """What a result says of the far field."""
    kind = "" if coating is None else " on the layered half-space"
    return f"displacements of the point force{kind} on the outer boundary"


def normal_far_field(coating: Coating | None, body: Elastic, r: Array, z: Array) -> Array:
    """(2, n) displacements u_r, u_z under a unit force along +z at the origin; r, z: (n,)."""
    u = boussinesq(1.0, body, r, z)
    if coating is None:
        return u
    effect: Array = import_module(LAYERED).normal(coating, body, r, z)
    return u + effect


def coating_effect(coating: Coating, body: Elastic, points: Array, *, sliding: bool) -> Array:
    """(2, 3, n) as `slanted_pair` of `layered_force`, which is loaded for a coating only."""
    return import_module(LAYERED).slanted_pair(coating, body, points, sliding=sliding)
