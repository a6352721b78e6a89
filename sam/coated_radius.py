# SPDX-License-Identifier: MIT
"""Contact radius of a coated half-space, estimated: the best Hertz pressure in the sense of the complementary energy.

Under p = p0 sqrt(1 - r^2/a^2), of force F, the harmonics have the amplitudes F S(k a), S(t) = 3 j1(t)/t with the spherical Bessel
function j1, and 1/E(k) = k c_zz(k)/2 is the compliance that each of them meets. The energy F^2/(2 pi) int S(k a)^2/E(k) dk of
both bodies and F <r^2>/(2 R) = F a^2/(5 R) of the gap are stationary for

    a^3 = 3/4 F R <1/E>,    <1/E> = 5/(3 pi) int 18 j1(t) j2(t)/t 1/E(t/a) dt:

Hertz with a mean compliance (the weights integrate to 1). Exact without film.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.optimize import brentq
from scipy.special import spherical_jn

PANELS, NODES = 30, 8  # of Gauss-Legendre nodes, one panel in pi
TAIL, TAIL_NODES = 1e9, 200  # beyond the panels 18 j1 j2/t has the mean 18/t^4: evenly in the logarithm
WIDER = 30.0  # the bracket, beyond the radii of the bare film and of the bare body


@cache
def _weights() -> tuple[np.ndarray, np.ndarray]:
    """Nodes t and weights of <1/E>, which sum to 1."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    t = (np.arange(PANELS)[:, None] * np.pi + (x + 1) * np.pi / 2).ravel()
    weight = np.tile(w * np.pi / 2, PANELS) * 18 * spherical_jn(1, t) * spherical_jn(2, t) / t
    far = np.geomspace(PANELS * np.pi, TAIL, TAIL_NODES)
    steps = np.gradient(np.log(far))
    steps[[0, -1]] /= 2
    nodes, weights = np.append(t, far), np.append(weight, 18 / far**3 * steps)
    return nodes, weights / weights.sum()


def contact_radius(
    response: Callable[[np.ndarray], np.ndarray], force: float, radius: float, bare: tuple[float, float]
) -> float:
    """Radius in m of the contact of a paraboloid with the radius of curvature in m under a force in N.

    response: k in 1/m -> c_zz(k) of both bodies in m/Pa; bare: the Hertz radii that the bare film and the bare body have.
    """
    t, weights = _weights()

    def excess(log_a: float) -> float:
        k = t / np.exp(log_a)
        compliance = weights @ (k * response(k) / 2)
        return 3 * log_a - np.log(0.75 * force * radius * compliance)

    low, high = np.log(min(bare) / WIDER), np.log(max(bare) * WIDER)
    return float(np.exp(brentq(excess, low, high, xtol=1e-13)))
