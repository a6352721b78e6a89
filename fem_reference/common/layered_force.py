# SPDX-License-Identifier: MIT
"""What a bonded coating changes in the displacements of a half-space under a point force on its surface.

In the layered half-space, coating 0 <= z < h on a substrate, a force at the origin gives Hankel integrals
over the wave number k (Burmister, J. Appl. Phys. 16 (1945) 89; Sneddon, Fourier Transforms, 1951, Sec. 51).
With (U, W) the amplitudes along the wave and along z, S and T those of szz and of the shear stress over k,
every layer is a sum of four solutions; with m = k z, mu the shear modulus and kappa = 3 - 4 nu, the two
that decay are

    U = e^-m        W = e^-m              S = -2 mu e^-m                     T = -2 mu e^-m
    U = m e^-m      W = (kappa + m) e^-m  S = -2 mu (2 (1 - nu) + m) e^-m    T = -2 mu (1 - 2 nu + m) e^-m

and the two that grow their mirror images (m from the other face; W and T change sign). Referenced so, to
the face where each is largest, no exponential overflows and the linear system stays well conditioned for
every k h. Waves sheared across their direction (a tangential force) have V = e^-m and Q = -mu e^-m.

Only the difference to the bare substrate is integrated, with the factor exp(-(k b)^4), b = R/60 for points
at the distance R and beyond: far away this spreads the force over a size b without second moments, so that
it changes nothing there (the limits of thick coatings are met to 1e-5), and the integral ends at k R of
about 140, however thin the coating is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import j0, j1

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Coating, Elastic

SPREAD = 60.0
"""R/b in the factor: displacements of thick coatings are met to 1e-5."""
POWER = 4
"""Power in the factor: any even one above 2 leaves the second moments of the force as they are."""
PANELS = 24
"""Equal panels of k; twice as many change displacements by 8e-11, two thirds of them by 7e-8."""
HALVINGS = 24
"""The first panel is halved so often towards zero, for far points; 16 halvings are as good to rounding."""
POINTS = 10
"""Gauss points in each panel; 16 change displacements by 8e-11, 7 by 6e-6."""


def normal(coating: Coating, body: Elastic, r: Array, z: Array) -> Array:
    """(u_r, u_z) coated less bare, under a unit force along +z at the origin; r, z: (n,) far from
    it.
    """
    k, weight = _wave_numbers(np.hypot(r, z).min())
    depths, place = np.unique(z, return_inverse=True)
    U, W = amplitudes(coating, body, k, depths, load=(-1.0, 0.0))[:, :, place]
    return np.stack([weight @ (U * _wave(j1, k, r)), weight @ (W * _wave(j0, k, r))])


def tangential(coating: Coating, body: Elastic, points: Array) -> Array:
    """(u_x, u_y, u_z) with the coating minus without it, under a unit force along +x at the origin;
    otherwise as `normal`.

    With g along the wave, t across it and w along z for a unit traction along the wave (g, w) and across it
    (t): u_x = int [(g + t) J0 - (g - t) J2 cos 2 theta]/2, u_y = -int (g - t) J2 sin 2 theta/2, u_z = -int
    w J1 cos theta.
    """
    x, y, z = points
    r, theta = np.hypot(x, y), np.arctan2(y, x)
    k, weight = _wave_numbers(np.sqrt(r**2 + z**2).min())
    depths, place = np.unique(z, return_inverse=True)
    g, w = amplitudes(coating, body, k, depths, load=(0.0, -1.0))[:, :, place]
    t = _across(coating, body, k, depths)[:, place]
    even, odd = _wave(j0, k, r), _wave(j1, k, r)
    kr = k[:, None] * r
    second = np.divide(2.0 * odd, kr, out=np.zeros_like(kr), where=kr > 0.0) - np.where(
        kr > 0.0, even, 0.0
    )  # J2
    plain, double, vertical = (
        weight @ each for each in (0.5 * (g + t) * even, 0.5 * (g - t) * second, w * odd)
    )
    return np.stack(
        [plain - double * np.cos(2.0 * theta), -double * np.sin(2.0 * theta), -vertical * np.cos(theta)]
    )


def slanted_pair(coating: Coating, body: Elastic, points: Array, *, sliding: bool = True) -> Array:
    """(2, 3, n) displacements coated less bare, under unit forces along z and, if sliding, x."""
    x, y, z = points
    r = np.hypot(x, y)
    u_r, u_z = normal(coating, body, r, z)
    outward = np.stack([x, y]) / np.where(r > 0.0, r, 1.0)
    along_z = np.stack([*(u_r * outward), u_z])
    return np.stack([along_z, tangential(coating, body, points) if sliding else np.zeros_like(along_z)])


def _wave_numbers(distance: float) -> tuple[Array, Array]:
    """k (n,) and weights of int f k dk/(2 pi) with the factor; distance: of the nearest point."""
    b = distance / SPREAD
    width = 30.0 ** (1.0 / POWER) / b / PANELS  # the factor ends at e^-30
    x, w = np.polynomial.legendre.leggauss(POINTS)
    ends = width * np.concatenate([[0.0], 0.5 ** np.arange(HALVINGS, 0.0, -1.0), np.arange(1, PANELS + 1)])
    half = 0.5 * np.diff(ends)[:, None]
    k = (ends[:-1, None] + half * (x + 1.0)).ravel()
    return k, (half * w).ravel() * k * np.exp(-((k * b) ** POWER)) / (2.0 * np.pi)


def _wave(bessel: Callable[[Array], Array], k: Array, r: Array) -> Array:
    """(n_k, n) bessel(k r), once for each radius."""
    radii, place = np.unique(r, return_inverse=True)
    waves: Array = bessel(k[:, None] * radii)
    return waves[:, place]


@dataclass(frozen=True)
class _Modes:
    """Solutions of one material, U, W, S, T: (4, 2, ...), at m = k z (...)."""

    young: float
    poisson: float

    @property
    def shear(self) -> float:
        return self.young / (2.0 * (1.0 + self.poisson))

    def decaying(self, m: Array) -> Array:
        nu, one, two_mu = self.poisson, np.ones_like(m), 2.0 * self.shear
        first = [one, one, -two_mu * one, -two_mu * one]
        second = [m, 3.0 - 4.0 * nu + m, -two_mu * (2.0 * (1.0 - nu) + m), -two_mu * (1.0 - 2.0 * nu + m)]
        return np.stack([np.array(first), np.array(second)], axis=1) * np.exp(-m)

    def growing(self, m: Array) -> Array:
        """Return the mirror images of `decaying`; m counts from the other face."""
        return self.decaying(m) * np.array([1.0, -1.0, 1.0, -1.0]).reshape(4, 1, *[1] * np.ndim(m))


def amplitudes(coating: Coating, body: Elastic, k: Array, z: Array, *, load: tuple[float, float]) -> Array:
    """(U, W) (2, n_k, n) at depths z, coated less bare, for szz and shear `load` at z = 0."""
    top, base = _Modes(coating.young, coating.poisson), _Modes(body.young, body.poisson)
    kh, zero, stress = k * coating.thickness, np.zeros_like(k), np.array(load)
    system = np.zeros((6, 6, k.size))  # rows: S, T at z = 0; U, W, S, T at the interface
    system[:2, :4] = np.concatenate([top.decaying(zero), top.growing(kh)], axis=1)[2:]
    system[2:, :4] = np.concatenate([top.decaying(kh), top.growing(zero)], axis=1)
    system[2:, 4:] = -base.decaying(zero)
    right = np.zeros((k.size, 6, 1))
    right[:, :2, 0] = stress / k[:, None]
    coated = np.linalg.solve(system.transpose(2, 0, 1), right)[..., 0].T
    bare = np.linalg.solve(base.decaying(np.zeros(1))[2:, :, 0], stress)[:, None] / k
    inside, from_top = z < coating.thickness, k[:, None] * z
    from_interface = np.abs(k[:, None] * (z - coating.thickness))
    waves = np.concatenate([top.decaying(from_top), top.growing(from_interface)], axis=1)[:2]
    within = np.einsum("ck,ackn->akn", coated[:4], waves)
    below = np.einsum("ck,ackn->akn", coated[4:], base.decaying(from_interface)[:2])
    return np.where(inside, within, below) - np.einsum("ck,ackn->akn", bare, base.decaying(from_top)[:2])


def _across(coating: Coating, body: Elastic, k: Array, z: Array) -> Array:
    """V (n_k, n) at depths z, with the coating minus without, for a unit traction across the wave at z = 0.

    In the coating (cosh-like) V = A (e^-kz + rho e^-k(2h - z)), rho = (mu1 - mu2)/(mu1 + mu2); below
    continuous at h.
    """
    mu1, mu2 = _Modes(coating.young, coating.poisson).shear, _Modes(body.young, body.poisson).shear
    rho, k = (mu1 - mu2) / (mu1 + mu2), k[:, None]
    kh, kz = k * coating.thickness, k * z
    amplitude = 1.0 / (mu1 * k * (1.0 - rho * np.exp(-2.0 * kh)))
    within = amplitude * (np.exp(-kz) + rho * np.exp(-np.maximum(2.0 * kh - kz, kh)))
    below = amplitude * (1.0 + rho) * np.exp(-kz)
    return np.where(z < coating.thickness, within, below) - np.exp(-kz) / (mu2 * k)
