# SPDX-License-Identifier: MIT
"""One backward-Euler step of a perfectly plastic film under mixed control (von Mises), every cell by itself.

Known at the end of the step: the strains in the plane, those of the body below (xx, yy, xy), and the stresses
on top, s_zz = -p, s_xz = tau, s_yz = 0. That is the plane-stress problem of Simo & Hughes (1998), section
3.4, with other stresses than 0 off the plane. With S = s_xx + s_yy - 2 s_zz, D = s_xx - s_yy, T = s_xy and
the flow rule d eps_p = lambda s',

    S = S_tr/(1 + a lambda), (D, T) = (D_tr, T_tr)/(1 + b lambda), a = E/(3 (1 - nu)), b = E/(1 + nu),    (a)
    q(lambda) = sqrt(S^2/4 + 3 D^2/4 + 3 T^2) = k,   k^2 = sigma_y^2 - 3 tau^2.                            (b)

Without k^2 > 0 the film cannot bear tau, whatever its strains: no equilibrium. 1/q is concave and grows in
lambda (a power mean of exponent -2 of 1 + a lambda and 1 + b lambda), so Newton's method on 1/q = 1/k climbs
to the root from below, from lambda = 0, and never passes it: it needs no bracket. Where only S or only (D, T)
is there it ends after one iteration.
"""

from __future__ import annotations

import numpy as np

from sam.arrays import Array
from sam.tribofilm.material import Loads, Material

ITERATIONS = 50  # limit: 2 to 5 are needed from 1 to 1e9 times k
ROUNDING = 1e-14  # of k: 45 roundings of a number


def bearable_radius(shear: Array, yield_stress: float) -> Array:
    """k in Pa of (b), 0 where there is no equilibrium; shear: tau in Pa, any shape."""
    found: Array = np.sqrt(np.maximum(yield_stress**2 - 3.0 * shear**2, 0.0))
    return found


def increment(loads: Loads, material: Material) -> Array:
    """Increment of the plastic strain, (6, n), of cells that bear their traction."""
    radius = bearable_radius(loads.shear, material.yield_stress)
    return flow(trial_stress(loads, material), loads.shear, radius, material)


def trial_stress(loads: Loads, material: Material) -> Array:
    """(S, D, T) of (a) in Pa, (3, n), with no further flow. Paper Eq. 12, by Hooke's law with s_zz given by
    Eq. 13.
    """
    young, poisson, normal = material.young, material.poisson, -loads.pressure  # paper Eq. 13: s_zz = -P
    xx, yy, xy = loads.strain - loads.plastic[[0, 1, 5]]
    # s_xx + s_yy of paper Eq. 12, with E/(1 + nu) where E/(2 (1 + nu)) is printed, and s_zz = normal
    in_plane = (young * (xx + yy) + 2.0 * poisson * normal) / (1.0 - poisson)
    twice_shear = material.twice_shear
    return np.stack([in_plane - 2.0 * normal, twice_shear * (xx - yy), twice_shear * xy])


def flow(trial: Array, shear: Array, radius: Array, material: Material) -> Array:
    """Increment of the plastic strain (6, n) that brings the trial stresses (3, n) to radius k > 0, (n,); 0
    inside of it.
    """
    a, b = material.young / (3.0 * (1.0 - material.poisson)), material.twice_shear
    along, across = trial[0] ** 2 / 4.0, 0.75 * trial[1] ** 2 + 3.0 * trial[2] ** 2
    factor = multiplier(along, across, radius, (a, b))
    S, D, T = trial[0] / (1.0 + a * factor), *(trial[1:] / (1.0 + b * factor))
    deviator = np.stack([S / 6.0 + D / 2.0, S / 6.0 - D / 2.0, -S / 3.0, np.zeros_like(S), shear, T])
    found: Array = factor * deviator
    return found


def multiplier(along: Array, across: Array, radius: Array, moduli: tuple[float, float]) -> Array:
    """lambda >= 0 in 1/Pa of (b) where along = S_tr^2/4 and across = 3 D_tr^2/4 + 3 T_tr^2 in Pa^2; all (n,).

    radius: k in Pa; moduli: a and b of (a) in Pa. ArithmeticError if Newton's method does not settle, which
    only numbers that are not finite can do.
    """
    (a, b), factor = moduli, np.zeros_like(along)
    for _ in range(ITERATIONS):
        x, y = 1.0 + a * factor, 1.0 + b * factor
        square = along / x**2 + across / y**2
        excess = np.sqrt(square) / radius - 1.0
        above = ~(excess <= ROUNDING)  # NaN too
        if not above.any():
            return factor
        slope = np.where(above, a * along / x**3 + b * across / y**3, 1.0)  # of -q^2/2
        factor = factor + np.where(above, excess * square / slope, 0.0)
    raise ArithmeticError("the return map of the film did not settle: its strains or stresses are not finite")
