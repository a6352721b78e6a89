# SPDX-License-Identifier: MIT
"""Stresses under a sphere in full sliding: Hertz pressure p and traction q = mu p on the body along +x.

Source: G. M. Hamilton, Explicit equations for the stresses beneath a sliding spherical contact, Proc. Inst.
Mech. Eng. 197C (1983) 53-59; Hamilton and Goodman, J. Appl. Mech. 33 (1966) 371-376. Written with the
integrals of ``hertz_integrals``, which hold on the axis, at the edge and on the surface; for the traction
along -x take a negative friction coefficient. The pressure is that of frictionless contact (exact for like
bodies).
"""

import numpy as np
from scipy.optimize import minimize

from .checks import coordinate, depth, finite, not_negative, poisson, positive
from .hertz import hertz_integrals, subsurface_stress
from .stress import components, von_mises


def tangential_stress(x, y, z, peak_traction: float, *, contact_radius: float, nu: float) -> np.ndarray:
    """Stresses under the traction q = q0 sqrt(1 - r^2/a^2) on the body along +x, (..., 6) in Pa, z >= 0. x,
    y, z in m, broadcast; q0 in Pa, any sign. With c_m, s_m = cos, sin(m theta) and I(m, n) of
    ``hertz_integrals`` (Hankel form of Cerruti's solution, s_xz(z = 0) = -q), B = nu/2 I30 + zeta/4 I31: s_xx
    = -c_1 [(2 + nu/2) I10 - 3/4 zeta I11] - c_3 B, s_yy = -c_1 [3/2 nu I10 - zeta/4 I11] + c_3 B, s_xy = -s_1
    [(1 - nu/2) I10 - zeta/4 I11] - s_3 B, s_zz = -c_1 zeta I11, s_xz = -I00 + zeta/2 I01 - c_2 zeta/2 I21,
    s_yz = -s_2 zeta/2 I21. Inside the contact at z = 0: s_xx = -q0 pi (4 + nu) x/(8a), s_yy = -3 q0 pi nu
    x/(8a), s_xy = -q0 pi (2 - nu) y/(8a).
    """
    a, nu = positive("contact_radius", contact_radius), poisson("nu", nu)
    x, y, z = coordinate("x", x) / a, coordinate("y", y) / a, depth("z", z) / a
    i = hertz_integrals(np.hypot(x, y), z)
    cos2, sin2 = x**2 - y**2, 2.0 * x * y
    cos3, sin3 = x**3 - 3.0 * x * y**2, 3.0 * x**2 * y - y**3  # rho^3 cos(3 theta), rho^3 sin(3 theta)
    third = 0.5 * nu * i.i3 + 0.25 * i.z3
    stress = components(
        -x * ((2.0 + 0.5 * nu) * i.i1 - 0.75 * i.z1) - cos3 * third,
        -x * (1.5 * nu * i.i1 - 0.25 * i.z1) + cos3 * third,
        -x * i.z1,
        -0.5 * sin2 * i.z2,
        xz=-i.i0 + 0.5 * i.z0 - 0.5 * cos2 * i.z2,
        xy=-y * ((1.0 - 0.5 * nu) * i.i1 - 0.25 * i.z1) - sin3 * third,
    )
    return finite("peak_traction", peak_traction) * stress


def sliding_stress(
    x, y, z, peak_pressure: float, *, contact_radius: float, nu: float, friction: float
) -> np.ndarray:
    """Stresses under pressure p and traction q = friction * p along +x on the body, (..., 6) in Pa, z >= 0.
    x, y, z in m, broadcast; a negative friction coefficient reverses the sliding.
    """
    normal = subsurface_stress(x, y, z, peak_pressure, contact_radius=contact_radius, nu=nu)
    traction = finite("friction", friction) * peak_pressure
    return normal + tangential_stress(x, y, z, traction, contact_radius=contact_radius, nu=nu)


def largest_von_mises(
    peak_pressure: float, contact_radius: float, nu: float, friction: float
) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """The two largest von Mises stresses in the plane y = 0: (subsurface, edge), each (stress Pa, x m, z m).
    The edge value is that at the trailing edge (-a, 0, 0), where the traction pulls; the subsurface one is
    the largest in |x| <= 0.8 a, 0.1 a <= z <= a, found by a search from a coarse grid. The larger decides
    where yield begins.
    """
    p0, a = positive("peak_pressure", peak_pressure), positive("contact_radius", contact_radius)
    mu, nu = not_negative("friction", friction), poisson("nu", nu)

    def mises(point):
        return von_mises(sliding_stress(point[0], 0.0, point[1], 1.0, contact_radius=1.0, nu=nu, friction=mu))

    x, z = np.meshgrid(np.linspace(-0.8, 0.8, 33), np.linspace(0.2, 1.0, 33))
    start = np.argmax(mises((x, z)))
    bounds = [(-0.8, 0.8), (0.1, 1.0)]
    how = {"method": "Nelder-Mead", "bounds": bounds, "options": {"xatol": 1e-8, "fatol": 1e-14}}
    best = minimize(lambda point: -float(mises(point)), [x.flat[start], z.flat[start]], **how)
    subsurface = (float(-best.fun * p0), float(best.x[0] * a), float(best.x[1] * a))
    return subsurface, (float(mises((-1.0, 0.0))) * p0, -a, 0.0)
