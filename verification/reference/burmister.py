# SPDX-License-Identifier: MIT
"""Two-layer pavement: a uniform pressure on a disc on a layer bonded to a half-space.

Sources: Burmister, J. Appl. Phys. 16 (1945) 89; the tables of Fox, Proc. 2nd Int. Conf. Soil Mech. 2 (1948)
236, for nu = 0.5 in both. Here: the Hankel integral of the layered response, P(k) = p a J1(k a)/k, by Gauss
quadrature.
"""

import numpy as np
from scipy.special import j1

from .checks import depth, positive
from .layered_axisymmetric import CoatedHalfSpace, hankel_stress, wave_numbers


def disc_stress(layers: CoatedHalfSpace, contact_radius: float, r, z, *, pressure: float = 1.0) -> np.ndarray:
    """Stresses in the plane theta = 0 for every r (n,) and z (m,) > 0, in m: (n, m, 6) in the unit of the
    pressure. At z = thickness the body's side. The integrand decays as exp(-k z) and is integrated to k z =
    40, in panels no longer than its oscillation allows: rounding error, at a cost that grows as (a + r)/z.
    Pressure on r < contact_radius (m).
    """
    a = positive("contact_radius", contact_radius)
    r, z = np.atleast_1d(depth("r", r)), np.atleast_1d(depth("z", z))
    if not np.all(z >= 1e-3 * a):
        least = f"contact_radius/1000 = {1e-3 * a:g} m"
        raise ValueError(f"z must be >= {least} everywhere, smallest value {z.min()!r}")
    k, weight = wave_numbers(np.min(z), a + np.max(r), 40.0)
    amplitudes = layers.amplitudes(k)
    profiles = [layers.profiles(k, amplitudes, at, film=bool(at < layers.thickness)) for at in z]
    transform = pressure * a * j1(k * a)  # k P(k)
    return hankel_stress(k, weight * transform, np.stack(profiles, axis=1), r)


def interface_stress(
    radius_over_thickness: float, young_ratio: float, poisson: float = 0.5, poisson_body: float = 0.5
):
    """Compressive stress on the axis at the interface over the pressure; tabulated by Fox for nu = 0.5."""
    layers = CoatedHalfSpace(young_ratio, poisson, 1.0, 1.0, poisson_body)
    return -float(disc_stress(layers, radius_over_thickness, 0.0, 1.0)[0, 0, 2])
