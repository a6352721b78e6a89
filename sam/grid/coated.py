# SPDX-License-Identifier: MIT
"""Cells and output depths of a coated scene: how wide its contact is, and depths in the coating and below it.

Loaded for coated scenes only. The contact radius is that of the best Hertz pressure in the sense of the
complementary energy. Under p = p0 sqrt(1 - r^2/a^2), of force F, the harmonics have the amplitudes F S(k a),
S(t) = 3 j1(t)/t with the spherical Bessel function j1, and 1/E(k) = k c_zz(k)/2 is the compliance that each
of them meets. The energy F^2/(2 pi) int S(k a)^2/E(k) dk of both bodies and F <r^2>/(2 R) = F a^2/(5 R) of
the gap are stationary for

    a^3 = 3/4 F R <1/E>,    <1/E> = 5/(3 pi) int 18 j1(t) j2(t)/t 1/E(t/a) dt:

Hertz with a mean compliance (the weights integrate to 1). It is exact without coating.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.optimize import brentq
from scipy.special import spherical_jn

from sam.arrays import Array

LEVELS = 8  # output depths in the coating at least, of equal distance
FILM_SIDE = 1 - 1e-6  # thicknesses: the deepest of them, the coating's side of the interface
# times the deepest of the other depths (two contact radii): a thicker coating is all that is looked at
REACH = 5.0
BELOW = (1.05, 1.1, 1.2, 1.35, 1.5)  # thicknesses: output depths below a coating where the other depths end
CLOSE = 0.25  # of the distance of the other depths: none of them is closer to the interface
BARE_ROOM = 1.6  # the contact of the bare body fits into a default grid up to this many coated contact radii
MOST_ROOM = 3.0  # factor on a default grid at most, for the contact of the bare body
PANELS = 30  # of Gauss-Legendre nodes, one panel in pi: the integrand oscillates with that period
NODES = 8  # in a panel
TAIL = 1e9  # beyond the panels 18 j1 j2/t has the mean 18/t^4, up to here
TAIL_NODES = 200  # evenly in the logarithm
WIDER = 30.0  # the bracket goes so far beyond the radii of the bare coating and of the bare body


def room_for_bare(scale: float) -> float:
    """By how much a default grid is wider than for the coated contact alone, so that it holds the bare one to
    compare with.
    """
    return float(np.clip(1 / (BARE_ROOM * scale), 1.0, MOST_ROOM))


def depths_with_film(depths: Array, thickness: float) -> Array:
    """Output depths of a bare body, ascending from 0, made those of a coated one.

    In the coating the given ones, at least LEVELS, and the coating's side of the interface; then the
    interface, where values are those of the body below; then the given ones that are deeper, and some below a
    coating that reaches as deep as they do. No interface and nothing below it where that is out of REACH.
    """
    deepest, spacing = depths[-1], depths[1] - depths[0]
    inside: Array = depths[depths < thickness - CLOSE * spacing]
    if thickness > REACH * deepest:
        return inside
    if len(inside) < LEVELS:
        inside = thickness * np.arange(LEVELS - 1) / (LEVELS - 1)
    inside = np.append(inside, FILM_SIDE * thickness)
    below = depths[depths > thickness + CLOSE * spacing]
    deeper = [share * thickness for share in BELOW if share * thickness > deepest]
    return np.concatenate([inside, [thickness], below, deeper])


@cache
def _weights() -> tuple[Array, Array]:
    """Nodes t and weights of <1/E>, which sum to 1."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    t = (np.arange(PANELS)[:, None] * np.pi + (x + 1) * np.pi / 2).ravel()
    weight = np.tile(w * np.pi / 2, PANELS) * 18 * spherical_jn(1, t) * spherical_jn(2, t) / t
    far = np.geomspace(PANELS * np.pi, TAIL, TAIL_NODES)
    steps = np.gradient(np.log(far))
    steps[[0, -1]] /= 2
    nodes, weights = np.append(t, far), np.append(weight, 18 / far**3 * steps)
    return nodes, weights / weights.sum()


def mean_compliance(response: Callable[[Array], Array], radius: float) -> float:
    """<1/E> in 1/Pa of a contact with the radius in m; response: k in 1/m -> c_zz(k) in m/Pa."""
    t, weights = _weights()
    k = t / radius
    return float(weights @ (k * response(k) / 2))


def contact_radius(
    response: Callable[[Array], Array], force: float, radius: float, bare: tuple[float, float]
) -> float:
    """Radius in m of the contact of a paraboloid with the radius of curvature in m under a force in N.

    response: k in 1/m -> c_zz(k) of both bodies in m/Pa; bare: the Hertz radii that the bare coating and the
    bare body have.
    """

    def excess(log_a: float) -> float:
        compliance = mean_compliance(response, np.exp(log_a))
        return float(3 * log_a - np.log(0.75 * force * radius * compliance))

    low, high = np.log(min(bare) / WIDER), np.log(max(bare) * WIDER)
    return float(np.exp(brentq(excess, low, high, xtol=1e-13)))
