# SPDX-License-Identifier: MIT
"""An elastic film bonded to an elastic half-space under the axisymmetric pressure J0(k r) on its surface.

Love's function (Love 1929; Burmister 1945): Phi = f(s) J0(k r)/k^3 with s = k z and f = e^{-s}, s e^{-s},
e^{s}, s e^{s} gives stresses and displacements without a division by 1 - 2 nu, so nu = 0.5 needs no branch.
With ' = d/ds:

    s_zz = [(1 - nu) f''' - (2 - nu) f'] J0              s_rz = [nu f'' + (1 - nu) f] J1
    s_rr = [nu f''' + (1 - nu) f'] J0 - f' J1/(k r)      s_tt = nu (f''' - f') J0 + f' J1/(k r)
    2 mu k u_z = [(1 - 2 nu) f'' - 2 (1 - nu) f] J0      2 mu k u_r = f' J1

The six amplitudes (four in the film, two in the body) follow from s_zz = -J0, s_rz = 0 on the surface and
from equal s_zz, s_rz, u_z, u_r at the interface: one 6 x 6 system for each k, solved as it stands. Growing
exponentials are referenced to the interface, so that only decaying ones appear. Any pressure is a Hankel sum
of such harmonics.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import j0, j1

from .checks import Checked, depth
from .stress import components

PROFILES = 5
"""Functions of depth for each k: s_zz, s_rz, the J0 parts of s_rr and s_tt, and f' (times -+ J1/(k r) in
these)."""


@dataclass(frozen=True)
class CoatedHalfSpace(Checked):
    """Film (young, poisson, thickness) bonded on a half-space (young_body, poisson_body); Pa and m."""

    young: float
    poisson: float
    thickness: float
    young_body: float
    poisson_body: float

    @property
    def modulus(self) -> float:
        """E1/(1 - nu1^2) of the film, Pa."""
        return self.young / (1.0 - self.poisson**2)

    @property
    def modulus_body(self) -> float:
        """E2/(1 - nu2^2) of the body below, Pa."""
        return self.young_body / (1.0 - self.poisson_body**2)

    def amplitudes(self, k, shear: bool = False) -> np.ndarray:
        """The six amplitudes for the pressure J0(k r): (n, 6) for wave numbers k (n,) in 1/m, > 0. Film:
        e^{-s}, s e^{-s}, e^{t}, t e^{t}; body: e^{-t}, t e^{-t}, with t = k (z - thickness). shear: for the
        radial traction J1(k r) on the body, outwards, in place of the pressure.
        """
        k = np.atleast_1d(depth("k", k))
        if not np.all(k > 0):
            raise ValueError("k must be > 0 everywhere")
        h = k * self.thickness
        matrix = np.zeros((len(k), 6, 6))
        right = np.zeros((len(k), 6))
        matrix[:, :2, :4] = np.swapaxes(_states(self._film(np.zeros_like(h), h), self.poisson)[:2], 0, 1)
        right[:, 1 if shear else 0] = -1.0
        above = _states(self._film(h, h), self.poisson)
        below = _states(_exponentials(np.zeros_like(h), -1), self.poisson_body)
        above[2:] /= self.young / (1.0 + self.poisson)
        below[2:] /= self.young_body / (1.0 + self.poisson_body)
        scale = min(self.young, self.young_body)
        above[2:], below[2:] = above[2:] * scale, below[2:] * scale
        matrix[:, 2:, :4] = np.swapaxes(above, 0, 1)
        matrix[:, 2:, 4:] = -np.swapaxes(below, 0, 1)
        return np.linalg.solve(matrix, right[..., None])[..., 0]

    def compliance(self, k, amplitudes: np.ndarray | None = None) -> np.ndarray:
        """c_zz(k) = u_z/p on the surface, m/Pa, (n,); also that of the plane wave p cos(k x)."""
        k = np.atleast_1d(depth("k", k))
        amplitudes = self.amplitudes(k) if amplitudes is None else amplitudes
        surface = _states(self._film(np.zeros_like(k), k * self.thickness), self.poisson)[2]
        return np.einsum("nj,nj->n", surface, amplitudes[:, :4]) * (1.0 + self.poisson) / (self.young * k)

    def profiles(
        self, k, amplitudes: np.ndarray, z: float, film: bool, *, reflected: bool = False
    ) -> np.ndarray:
        """The five depth functions ``PROFILES`` at depth z (m): (5, n). film: continue the film's (True) or
        the body's (False) functions to z; reflected: the film's without those of a half-space of the film's
        material, f = -(2 nu + s) e^{-s}: what the interface sends back.
        """
        h = k * self.thickness
        if not film:
            return _combine(_exponentials(k * (z - self.thickness), -1), amplitudes[:, 4:], self.poisson_body)
        amplitudes = amplitudes[:, :4].copy()
        if reflected:
            amplitudes[:, :2] += [2.0 * self.poisson, 1.0]
        return _combine(self._film(k * z, h), amplitudes, self.poisson)

    def _film(self, s, h) -> np.ndarray:
        return np.concatenate([_exponentials(s, -1), _exponentials(s - h, 1)], axis=2)


def _exponentials(s: np.ndarray, sign: int) -> np.ndarray:
    """e^{sign s} and s e^{sign s} with their first three derivatives: (4, n, 2)."""
    power = np.array([sign**j for j in range(4)])[:, None]
    plain = np.broadcast_to(power, (4, len(s)))
    first = power * s + np.array([j * sign ** (j + 1) for j in range(4)])[:, None]
    return np.stack([plain, first], axis=2) * np.exp(sign * s)[:, None]


def _states(f: np.ndarray, nu: float) -> np.ndarray:
    """s_zz, s_rz, 2 mu k u_z, 2 mu k u_r of each basis function: (4, n, m) from (4, n, m)."""
    return np.stack(
        [
            (1.0 - nu) * f[3] - (2.0 - nu) * f[1],
            nu * f[2] + (1.0 - nu) * f[0],
            (1.0 - 2.0 * nu) * f[2] - 2.0 * (1.0 - nu) * f[0],
            f[1],
        ]
    )


def _combine(f: np.ndarray, amplitudes: np.ndarray, nu: float) -> np.ndarray:
    f = np.einsum("dnj,nj->dn", f, amplitudes)
    zz, rz = _states(f, nu)[:2]
    return np.stack([zz, rz, nu * f[3] + (1.0 - nu) * f[1], nu * (f[3] - f[1]), f[1]])


def wave_numbers(length: float, reach: float, top: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights in k (1/m) of a Hankel integral up to top/length: 24 Gauss points a panel. Panels are
    graded towards k = 0 in k length, where a film much stiffer or softer than its body has its features, and
    no longer than 36/reach, so that cos(k reach) is integrated to 1e-14.
    """
    edges = [0.0, *(4.0 ** -np.arange(8, 0, -1.0)), *(2.0 ** np.arange(0, math.log2(top)))]
    edges = np.append(edges, top) / length
    panels = [(a, b, 1 + max(1, math.ceil((b - a) * reach / 36.0))) for a, b in pairwise(edges)]
    starts = np.concatenate([*(np.linspace(*panel)[:-1] for panel in panels), edges[-1:]])
    t, w = np.polynomial.legendre.leggauss(24)
    half = np.diff(starts)[:, None] / 2.0
    return (starts[:-1, None] + half * (1.0 + t)).ravel(), (half * w).ravel()


def hankel_stress(k, weight, profiles: np.ndarray, r) -> np.ndarray:
    """Stresses in the plane theta = 0, (nr, nz, 6): the sum over k of weight times profile times J0 or J1.
    weight (n,): the pressure's Hankel transform times k dk; profiles (5, nz, n); r (nr,) in m.
    """
    argument = np.outer(np.atleast_1d(r), k)
    zero, one = j0(argument), j1(argument)
    over = np.divide(one, argument, out=np.full_like(one, 0.5), where=argument > 1e-12)
    zz, rz, rr, tt, slope = np.swapaxes(profiles * weight, 1, 2)
    hoop = over @ slope
    return components(zero @ rr - hoop, zero @ tt + hoop, zero @ zz, xz=one @ rz)
