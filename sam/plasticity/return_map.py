# SPDX-License-Identifier: MIT
"""Backward-Euler radial return of the von Mises yield condition with isotropic hardening (Simo & Hughes 1998,
box 3.1).

With the trial stress s^tr (deviator) and q = sqrt(3/2 s^tr : s^tr), the increment of the accumulated plastic
strain solves

    q - 3 m dgamma = sigma_y(alpha + dgamma),        d eps_p = 3/2 dgamma s^tr/q,                      (a)

where m is the stiffness with which the plastic strain of a cell lowers its own stress. For a homogeneously
strained body m = mu. A fixed point of trial = sigma(eps_p) + 2 m d eps_p is the same for every m > 0, so m is
free to speed it up.
"""

from __future__ import annotations

import numpy as np

from sam.arrays import Array
from sam.scene.yield_curve import YieldCurve

ITERATIONS = 50
ROUNDING = 1e-14  # of the yield stress
SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor


def deviator(stress: Array) -> Array:
    """Deviatoric part of (6, ...)."""
    out = stress.copy()
    out[:3] -= (stress[0] + stress[1] + stress[2]) / 3
    return out


def contraction(a: Array, b: Array) -> Array:
    """Double contraction of symmetric tensors, a : b.

    Parameters
    ----------
    a, b
        Components 11 22 33 23 13 12, (6, ...), in any units.

    Returns
    -------
    Array
        (...), in the product of the units.

    Examples
    --------
    >>> float(contraction(np.array([1.0, 0, 0, 0, 0, 1]), np.array([2.0, 0, 0, 0, 0, 3])))  # 1 2 + 2 (1 3)
    8.0
    """
    found: Array = (SHEAR @ (a * b).reshape(6, -1)).reshape(a.shape[1:])
    return found


def equivalent_strain(strain: Array) -> Array:
    """sqrt(2/3 e : e) of a plastic strain (6, ...)."""
    return np.sqrt(2 / 3 * contraction(strain, strain))


def mises(s: Array) -> Array:
    """sqrt(3/2 s : s) of a deviator (6, ...)."""
    return np.sqrt(1.5 * contraction(s, s))


def plastic_multiplier(
    q: Array,
    alpha: Array,
    curve: YieldCurve,
    factor: Array,
    *,
    m3: float,
    near: Array | None = None,
) -> Array:
    """dgamma of (a), (n,); q, alpha, factor, near: (n,); m3: 3 m in Pa.

    Zero where paper Eq. 8 holds: q <= sigma_y.

    Newton's method from `near`, or from zero, kept inside (0, q/m3): monotone from the left of the answer for
    a concave curve, bracketed for any other that does not soften.
    """
    low, high = np.zeros_like(q), q / m3
    gamma = np.zeros_like(q) if near is None else np.minimum(near, high)
    yielding = q > factor * curve.stress(alpha)  # paper Eq. 8 does not hold
    for _ in range(ITERATIONS):
        yield_stress = factor * curve.stress(alpha + gamma)
        excess = np.where(yielding, q - m3 * gamma - yield_stress, 0.0)
        found = np.abs(excess) <= ROUNDING * yield_stress
        if found.all():
            break
        low, high = np.where(excess > 0, gamma, low), np.where(excess < 0, gamma, high)
        newton = gamma + excess / (m3 + factor * curve.slope(alpha + gamma))
        inside = (newton > low) & (newton < high)
        gamma = np.where(found, gamma, np.where(inside, newton, (low + high) / 2))
    return np.where(yielding, gamma, 0.0)
