# SPDX-License-Identifier: MIT
"""Point forces on the surface of a half-space: Boussinesq (along z, into the body) and Cerruti (along +x).

Sources: Boussinesq (1885), Cerruti (1882); Johnson, Contact Mechanics (1985), Eq. 3.18-3.19 and 3.75-3.76,
rearranged in R + z so that the axis is regular. The force acts at the origin, R^2 = x^2 + y^2 + z^2; x, y, z
in m, broadcast. ValueError for a point at the origin itself, where the field is singular.
"""

import math

import numpy as np

from .checks import coordinate, depth, finite, poisson, positive
from .stress import components


def boussinesq_stress(x, y, z, force: float, *, nu: float) -> np.ndarray:
    """Stress under a normal force (N, > 0 pushes into the body), (..., 6) in Pa; t = R + z. 2 pi s_xx/F = (1
    - 2 nu) [z/R^3 - 1/(R t) + x^2 (2R + z)/(R^3 t^2)] - 3 x^2 z/R^5, 2 pi s_zz/F = -3 z^3/R^5.
    """
    x, y, z, R, t = _coordinates(x, y, z)
    D = 1.0 - 2.0 * poisson("nu", nu)
    curl = (2.0 * R + z) / (R**3 * t**2)
    mean = z / R**3 - 1.0 / (R * t)
    radial = 3.0 * z / R**5
    stress = components(
        D * (mean + x**2 * curl) - radial * x**2,
        D * (mean + y**2 * curl) - radial * y**2,
        -radial * z**2,
        -radial * y * z,
        xz=-radial * x * z,
        xy=(D * curl - radial) * x * y,
    )
    return finite("force", force) / (2.0 * math.pi) * stress


def cerruti_stress(x, y, z, force: float, *, nu: float) -> np.ndarray:
    """Stress under a tangential force (N) on the body along +x, (..., 6) in Pa; t = R + z. 2 pi s_xx/F = (1 -
    2 nu) [x/R^3 - 3x/(R t^2) + x^3 (3R + z)/(R^3 t^3)] - 3 x^3/R^5, 2 pi s_iz/F = -3 x x_i z/R^5.
    """
    x, y, z, R, t = _coordinates(x, y, z)
    D = 1.0 - 2.0 * poisson("nu", nu)
    curl = (3.0 * R + z) / (R**3 * t**3)
    radial = 3.0 * x / R**5
    stress = components(
        D * x * (1.0 / R**3 - 3.0 / (R * t**2) + x**2 * curl) - radial * x**2,
        D * x * (1.0 / R**3 - 1.0 / (R * t**2) + y**2 * curl) - radial * y**2,
        -radial * z**2,
        -radial * y * z,
        xz=-radial * x * z,
        xy=D * y * (x**2 * curl - 1.0 / (R * t**2)) - radial * x * y,
    )
    return finite("force", force) / (2.0 * math.pi) * stress


def boussinesq_displacement(x, y, z, force: float, *, young: float, nu: float) -> np.ndarray:
    """Displacement under a normal force (N), (..., 3) in m; at z = 0 u_z = (1 - nu^2) F/(pi E r)."""
    x, y, z, R, t = _coordinates(x, y, z)
    nu = poisson("nu", nu)
    radial = z / R**3 - (1.0 - 2.0 * nu) / (R * t)
    parts = np.broadcast_arrays(x * radial, y * radial, z**2 / R**3 + 2.0 * (1.0 - nu) / R)
    return _compliance(force, young, nu) * np.stack(parts, axis=-1)


def cerruti_displacement(x, y, z, force: float, *, young: float, nu: float) -> np.ndarray:
    """Displacement (u_x, u_y, u_z) under a tangential force (N) on the body along +x, (..., 3) in m."""
    x, y, z, R, t = _coordinates(x, y, z)
    D = 1.0 - 2.0 * poisson("nu", nu)
    shared = 1.0 / R**3 - D / (R * t**2)
    parts = np.broadcast_arrays(1.0 / R + D / t + x**2 * shared, x * y * shared, x * (z / R**3 + D / (R * t)))
    return _compliance(force, young, nu) * np.stack(parts, axis=-1)


def _coordinates(x, y, z):
    """x, y, z, R and t = R + z."""
    x, y, z = coordinate("x", x), coordinate("y", y), depth("z", z)
    R = np.sqrt(x**2 + y**2 + z**2)
    if not np.all(R > 0):
        raise ValueError("x, y, z must not be the point of load itself")
    return x, y, z, R, R + z


def _compliance(force: float, young: float, nu: float) -> float:
    """F/(4 pi mu), mu = E/(2 (1 + nu))."""
    return finite("force", force) * (1.0 + nu) / (2.0 * math.pi * positive("young", young))
