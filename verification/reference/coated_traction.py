# SPDX-License-Identifier: MIT
"""Stresses of a coated half-space under a given Hertz pressure p = p0 sqrt(1 - r^2/a^2) and the traction q =
mu p along +x.

The pressure is a Hankel sum of the harmonics of ``layered_axisymmetric``. The traction is a sum over wave
vectors k at the angle phi to x. In the frame L along k, T across it, a traction e^{i k L} along x is cos(phi)
along L and -sin(phi) along T. Under sin(k L) along L the depth functions are those of the axisymmetric
harmonic J1(k r), because a plane wave and a cylindrical one share Love's function of depth: s_zz, s_LL, s_TT
before cos(k L), s_zL before sin(k L). Under cos(k L) along T the displacement is antiplane, u_T = V(z) cos(k
L), with s_zT = t(z) cos(k L) and s_LT = -l(z) sin(k L). Turned back to x and y, and integrated over phi with
integral e^{i k x cos(phi)} cos(m phi) dphi = 2 pi i^m J_m(k x), on y = 0:

    s_xx = -(3 s_LL + s_TT + 2 l) J1/4 + (s_LL - s_TT - 2 l) J3/4,      s_zz = -s_zz J1, s_yy = -(s_LL + 3
    s_TT - 2 l) J1/4 - (s_LL - s_TT - 2 l) J3/4,      s_xz = (s_zL + t) J0/2 - (s_zL - t) J2/2,

and s_xy = s_yz = 0. Sources: Burmister, J. Appl. Phys. 16 (1945) 89; O'Sullivan & King, J. Tribol. 110 (1988)
235.
"""

import numpy as np
from scipy.special import j0, j1, jv, spherical_jn

from .checks import coordinate, depth, finite, positive
from .coated_changes import LargestChange, search
from .hamilton import sliding_stress
from .layered_axisymmetric import CoatedHalfSpace, hankel_stress, wave_numbers
from .stress import components

DECAYED = 40.0
"""Wave number times depth up to which is integrated: e^{-40} = 4e-18."""


def coated_sliding_stress(
    layers: CoatedHalfSpace,
    peak_pressure: float,
    contact_radius: float,
    friction: float,
    *,
    x,
    z,
    film: bool = False,
) -> np.ndarray:
    """Stresses in the plane y = 0 at every x (n,) and z (m,) in m: (n, m, 6) in the unit of the pressure.
    film: the places are those of the film, 0 <= z <= thickness, else of the body, z >= thickness; at the
    interface both exist. In the film what the interface sends back is added to Hamilton's closed form for a
    half-space of film. Gauss quadrature to rounding; its cost grows as contact_radius/thickness. ValueError
    for a depth outside its layer.
    """
    a, p0 = positive("contact_radius", contact_radius), finite("peak_pressure", peak_pressure)
    mu, h, nu = finite("friction", friction), layers.thickness, layers.poisson
    x, z = np.atleast_1d(coordinate("x", x)), np.atleast_1d(depth("z", z))
    if not np.all(z <= h if film else z >= h):
        raise ValueError(f"z must be {'<=' if film else '>='} thickness = {h:g} m everywhere, found {z!r}")
    k, weight = wave_numbers(np.min(2.0 * h - z if film else z), a + np.max(np.abs(x)), DECAYED)
    # the integral of sqrt(1 - s^2) J0(ka s) s ds over 0 <= s <= 1 is the spherical j1(ka)/ka
    weight = weight * p0 * a * spherical_jn(1, k * a)
    pressed, sheared = (layers.amplitudes(k, shear) for shear in (False, True))
    if film:  # less the amplitudes of e^{-s} and s e^{-s} in a half-space of film
        pressed[:, :2] -= [-2.0 * nu, -1.0]
        sheared[:, :2] -= [2.0 * nu - 1.0, 1.0]
    profiles = np.stack([layers.profiles(k, pressed, at, film) for at in z], axis=1)
    stress = hankel_stress(k, weight, profiles, np.abs(x))
    stress[..., 4] *= np.sign(x)[:, None]
    waves = np.stack([layers.profiles(k, sheared, at, film)[:4] for at in z], axis=1)
    across = np.stack([antiplane(layers, k, at, film) for at in z], axis=1)
    stress += mu * along_x(k, weight, waves, across, x=x)
    if film:
        stress += sliding_stress(x[:, None], 0.0, z[None, :], p0, contact_radius=a, nu=nu, friction=mu)
    return stress


def largest_von_mises(
    layers: CoatedHalfSpace, peak_pressure: float, contact_radius: float, friction: float, *, film: bool
) -> LargestChange:
    """Largest von Mises stress of the film, or of the body, in y = 0 with its faces; its r is x."""
    a, h = contact_radius, layers.thickness
    x, share = np.linspace(-1.2 * a, 1.2 * a, 49), np.linspace(0.0, 1.0, 25)
    depths = h * share if film else h + 1.5 * (a + h) * share**2
    load = layers, peak_pressure, a, friction
    return search(lambda x, z: coated_sliding_stress(*load, x=x, z=z, film=film), x, depths)


def antiplane(layers: CoatedHalfSpace, k: np.ndarray, z: float, film: bool) -> np.ndarray:
    """t and l of the module at the depth z under the traction cos(k L) along T: (2, n).

    Of the film without those of a half-space of film, -e^{-kz} and e^{-kz}.

    u_T = (A e^{-kz} + B e^{k(z - h)})/(mu_1 k) in the film, C e^{-k(z - h)}/(mu_2 k) below. Equal u_T and
    s_zT at z = h give B = rho A e^{-kh} and C = (1 - rho) A e^{-kh} with rho = (r - 1)/(r + 1) and r =
    mu_1/mu_2; the load A (1 - rho e^{-2kh}) = 1.
    """
    ratio = layers.young * (1.0 + layers.poisson_body) / (layers.young_body * (1.0 + layers.poisson))
    rho, h = (ratio - 1.0) / (ratio + 1.0), layers.thickness
    first = 1.0 / (1.0 - rho * np.exp(-2.0 * k * h))
    if not film:
        wave = (1.0 - rho) * first * np.exp(-k * z)
        return np.stack([-wave, wave])
    down, up = (rho * first * np.exp(-k * way) for way in (2.0 * h + z, 2.0 * h - z))
    return np.stack([up - down, up + down])


def along_x(
    k: np.ndarray, weight: np.ndarray, waves: np.ndarray, across: np.ndarray, *, x: np.ndarray
) -> np.ndarray:
    """The sum over wave vectors of the module: (nx, nz, 6). weight (n,): the traction's Hankel transform
    times k dk; waves (4, nz, n): s_zz, s_zL, s_LL, s_TT; across (2, nz, n): t, l.
    """
    argument = np.outer(x, k)
    first, third = j1(argument), jv(3, argument)
    zz, shear, along, side = np.swapaxes(waves * weight, 1, 2)
    t, turned = np.swapaxes(across * weight, 1, 2)
    quarter = 0.25 * third @ (along - side - 2.0 * turned)
    return components(
        -0.25 * first @ (3.0 * along + side + 2.0 * turned) + quarter,
        -0.25 * first @ (along + 3.0 * side - 2.0 * turned) - quarter,
        -first @ zz,
        xz=0.5 * (j0(argument) @ (shear + t) - jv(2, argument) @ (shear - t)),
    )
