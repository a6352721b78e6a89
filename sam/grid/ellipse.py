# SPDX-License-Identifier: MIT
"""Contact ellipse of Hertz. Loaded for unequal radii only: a sphere needs neither elliptic integrals nor a
root.
"""

from __future__ import annotations

from math import pi

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

EQUAL = 1e-4  # relative difference of the radii below which the ellipse is a circle to that accuracy


def elliptic_contact(force: float, radii: tuple[float, float], modulus: float) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m under a force in N, radii (Rx, Ry) in m, E* in Pa.
    Johnson 1985, Eq. 4.26.

    Solved for the ratio of the axes, with the complete elliptic integrals K and E of m = e^2 = 1 - ratio^2.
    """
    rx, ry = radii
    small, large = sorted((rx, ry))

    def curvatures(ratio: float) -> tuple[float, float]:
        """(K - E, E/ratio^2 - K)/e^2: proportional to the curvatures 1/(2 R) along the major and the minor
        axis.
        """
        m = 1 - ratio**2
        k, e = ellipk(m), ellipe(m)
        return (k - e) / m, (e / ratio**2 - k) / m

    def mismatch(log_ratio: float) -> float:
        along_major, along_minor = curvatures(np.exp(log_ratio))
        return along_minor / along_major * small / large - 1

    # the ratio of the axes lies between the ratio of the radii and 1 (Johnson: about its power 2/3)
    ratio = (
        float(np.exp(brentq(mismatch, np.log(small / large), -1e-6)))
        if small / large < 1 - EQUAL
        else 1 - 1e-6
    )
    major = (3 * force * small * curvatures(ratio)[1] / (pi * modulus)) ** (1 / 3)
    axes = major * ratio, major  # the contact is longer along the larger radius
    return axes if rx < ry else (major, major * ratio)
