# SPDX-License-Identifier: MIT
"""One family of antiderivatives of 1/R serves every influence coefficient.

P[a, b, c](x, y, z) is d_x^a d_y^b d_z^c of the triple antiderivative (in x, y and z) of 1/R, R^2 = x^2 + y^2
+ z^2, z >= 0; so P[1,1,1] = 1/R and P[1,1,0] = ln(R + z). A negative c is a repeated integral in z from
infinity. The integral of d_x^a d_y^b d_z^c (1/R) over a rectangle is P[a, b, c+1] differenced over its
corners.

In the paper (Eq. 26 to 30) the orders c >= 0 are the derivatives of phi, and c = -1 those of psi. U, V and
W below are the functions of its Eq. 27, 28 and 29; X is twice that of Eq. 30.

The forms below are right up to terms that the corner difference in x and y removes. Two choices matter:
P[2,0,0] must vanish for z -> infinity, hence X = 2 atan2(x, R + y + z) and not atan(y z / (x R)); and atan2
keeps the limit z -> 0 under a patch.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from sam.arrays import Array

_SYMMETRIC = ("t", "lz", "vz", "wz", "uz")  # the functions that an exchange of x and y leaves alone


class Corners:
    """The functions of corner coordinates x, y, z >= 0 that primitives are made of, each computed
    on demand and without a difference of nearly equal numbers. Not at x = y = z = 0, nor at y = z =
    0, x < 0.
    """

    def __init__(self, x: Array, y: Array, z: Array, radius: Array | None = None):
        self.x, self.y, self.z = x, y, z
        self.r = np.sqrt(x * x + y * y + z * z) if radius is None else radius

    @cached_property
    def swapped(self) -> Corners:
        """The same corners with x and y exchanged: P[b,a,c](x, y, z) = P[a,b,c](y, x, z)."""
        other = Corners(self.y, self.x, self.z, self.r)
        pairs = (("r_plus_x", "r_plus_y"), ("lx", "ly"), ("vx", "vy"), ("wx", "wy"))
        for mine, its in (
            *pairs,
            *((its, mine) for mine, its in pairs),
            *((name, name) for name in _SYMMETRIC),
        ):
            if mine in self.__dict__:
                other.__dict__[its] = self.__dict__[mine]
        return other

    @cached_property
    def t(self) -> Array:
        """R + z."""
        return self.r + self.z

    @cached_property
    def r_plus_y(self) -> Array:
        """R + y = (x^2 + z^2)/(R - y) for y < 0."""
        far = self.r + np.abs(self.y)
        return np.where(self.y < 0, (self.x**2 + self.z**2) / far, far)

    @cached_property
    def r_plus_x(self) -> Array:
        """R + x, likewise."""
        far = self.r + np.abs(self.x)
        return np.where(self.x < 0, (self.y**2 + self.z**2) / far, far)

    @cached_property
    def lx(self) -> Array:
        """L_x = ln(R + x)."""
        return np.log(self.r_plus_x)

    @cached_property
    def ly(self) -> Array:
        """L_y = ln(R + y)."""
        return np.log(self.r_plus_y)

    @cached_property
    def lz(self) -> Array:
        """L_z = ln(R + z)."""
        return np.log(self.t)

    @cached_property
    def vx(self) -> Array:
        """V_x = 1/(R (R + x)), paper Eq. 28."""
        return 1.0 / (self.r * self.r_plus_x)

    @cached_property
    def vy(self) -> Array:
        """V_y = 1/(R (R + y)), paper Eq. 28."""
        return 1.0 / (self.r * self.r_plus_y)

    @cached_property
    def vz(self) -> Array:
        """V_z = 1/(R (R + z)), paper Eq. 28."""
        return 1.0 / (self.r * self.t)

    @cached_property
    def uz(self) -> Array:
        """U_z = atan(x y/(z R)), with its limits +-pi/2 at z = 0; paper Eq. 27."""
        return np.arctan2(self.x * self.y, self.z * self.r)

    @cached_property
    def xx(self) -> Array:
        """X_x = 2 atan2(x, R + y + z), twice paper Eq. 30."""
        return 2.0 * np.arctan2(self.x, self.r_plus_y + self.z)

    @cached_property
    def wx(self) -> Array:
        """W_x = (2 R + x)/(R^3 (R + x)^2), paper Eq. 29."""
        return (self.r + self.r_plus_x) * self.vx * self.vx / self.r

    @cached_property
    def wy(self) -> Array:
        """W_y = (2 R + y)/(R^3 (R + y)^2), paper Eq. 29."""
        return (self.r + self.r_plus_y) * self.vy * self.vy / self.r

    @cached_property
    def wz(self) -> Array:
        """W_z = (2 R + z)/(R^3 (R + z)^2), paper Eq. 29."""
        return (self.r + self.t) * self.vz * self.vz / self.r


# P[a,b,c] for the surface-load and eigenstrain coefficients; sorted by degree of homogeneity 2 - (a + b + c).
# Paper Eq. 26 lists them as derivatives of phi and psi, with x and y, and for phi also z, exchanged.
_FORMS: dict[tuple[int, int, int], Callable[[Corners], Array]] = {
    (0, 0, 1): lambda g: g.x * g.ly + g.y * g.lx - g.z * g.uz,  # paper Eq. 26, phi_,k
    (1, 0, 0): lambda g: g.y * g.lz + g.z * g.ly - g.x * g.xx,
    (2, 0, -1): lambda g: -g.x * g.ly - g.z * g.xx,  # paper Eq. 26, psi_,kk
    (1, 1, -1): lambda g: g.z * g.lz - g.r,  # paper Eq. 26, psi_,12
    (2, 1, -2): lambda g: g.x * ((g.r - g.z) / (4 * g.t) - g.lz / 2),
    (3, 0, -2): lambda g: g.y * (g.lz / 2 - (g.r - g.z) / (4 * g.t)) - _FORMS[1, 0, 0](g),
    (2, 0, 0): lambda g: -g.xx,
    (0, 0, 2): lambda g: -g.uz,  # paper Eq. 26, phi_,kk
    (1, 1, 0): lambda g: g.lz,  # paper Eq. 26, phi_,kl
    (1, 0, 1): lambda g: g.ly,
    (2, 1, -1): lambda g: -g.x / g.t,  # paper Eq. 26, psi_,kkl
    (3, 0, -1): lambda g: g.y / g.t - g.ly,
    (3, 1, -2): lambda g: -g.lz / 2 - (g.x - g.y) * (g.x + g.y) / (2 * g.t) ** 2,
    (4, 0, -2): lambda g: g.x * g.y / (2 * g.t**2) + g.xx,
    (3, 0, 0): lambda g: -g.y * g.vz - g.z * g.vy,
    (2, 1, 0): lambda g: g.x * g.vz,  # paper Eq. 26, phi_,kkl: V_k is printed for V_j
    (2, 0, 1): lambda g: g.x * g.vy,
    (1, 1, 1): lambda g: 1.0 / g.r,
    (1, 0, 2): lambda g: g.z * g.vy,
    (0, 0, 3): lambda g: -g.x * g.vy - g.y * g.vx,  # paper Eq. 26, phi_,kkk
    (3, 1, -1): lambda g: ((g.x - g.y) * (g.x + g.y) / g.t**2 - 1) / (2 * g.r),
    (4, 0, -1): lambda g: -g.x * (g.y * g.vz / g.t + g.vy),
    (2, 1, 1): lambda g: -g.x / g.r**3,  # paper Eq. 26, phi_,123k
    (1, 1, 2): lambda g: -g.z / g.r**3,
    (2, 0, 2): lambda g: -g.x * g.z * g.wy,  # paper Eq. 26, phi_,kkll
    (3, 1, 0): lambda g: g.vz - g.x**2 * g.wz,  # paper Eq. 26, phi_,kkkl
    (3, 0, 1): lambda g: g.vy - g.x**2 * g.wy,
    (1, 0, 3): lambda g: g.vy - g.z**2 * g.wy,
    (4, 0, 0): lambda g: g.x * (g.y * g.wz + g.z * g.wy),
    (0, 0, 4): lambda g: g.z * (g.x * g.wy + g.y * g.wx),  # paper Eq. 26, phi_,kkkk
}


def primitive(a: int, b: int, c: int, corners: Corners) -> Array:
    """P[a, b, c] at the corners (paper Eq. 26); KeyError for an order that no coefficient uses."""
    if (a, b, c) in _FORMS:
        return _FORMS[a, b, c](corners)
    return _FORMS[b, a, c](corners.swapped)


def orders() -> list[tuple[int, int, int]]:
    """The orders (a, b, c) that are available, without those that follow by exchanging x and y."""
    return list(_FORMS)
