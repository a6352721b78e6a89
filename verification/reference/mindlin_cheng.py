# SPDX-License-Identifier: MIT
"""A sphere with a uniform isotropic eigenstrain (thermal expansion) in a half-space with a free surface.

Source: Mindlin and Cheng, Thermoelastic stress in the semi-infinite solid, J. Appl. Phys. 21 (1950) 931-933.
Outside, the field is that of a centre of dilatation for any sphere that does not cut the surface.
"""

from dataclasses import dataclass

import numpy as np

from .checks import coordinate, depth, finite, poisson, positive
from .stress import components


@dataclass(frozen=True)
class EigenstrainSphere:
    """Sphere of a radius (m) centred at (0, 0, centre_depth) (m), linear eigenstrain e on each axis, e > 0
    expands. young in Pa and nu are the same in and outside. ValueError if centre_depth < radius (not in the
    body).
    """

    eigenstrain: float
    radius: float
    centre_depth: float
    young: float
    nu: float

    def __post_init__(self):
        for name in ("radius", "centre_depth", "young"):
            positive(name, getattr(self, name))
        finite("eigenstrain", self.eigenstrain)
        poisson("nu", self.nu)
        if self.centre_depth < self.radius:
            raise ValueError(f"centre_depth = {self.centre_depth!r} must be >= radius = {self.radius!r}")

    @property
    def strength(self) -> float:
        """K of u = K R/R^3 outside the sphere in a full space: e radius^3 (1 + nu)/(3 (1 - nu)), m^3."""
        return self.eigenstrain * self.radius**3 * (1.0 + self.nu) / (3.0 * (1.0 - self.nu))

    def surface_displacement(self, x, y) -> np.ndarray:
        """u_z at z = 0, m; x, y in m: -4 (1 - nu) K d/(r^2 + d^2)^(3/2), 4 (1 - nu) K = (4/3)(1 + nu) e
        radius^3. Negative for e > 0: an expansion bulges the surface outwards.
        """
        distance = np.sqrt(coordinate("x", x) ** 2 + coordinate("y", y) ** 2 + self.centre_depth**2)
        return -4.0 * (1.0 - self.nu) * self.strength * self.centre_depth / distance**3

    def stress(self, x, y, z) -> np.ndarray:
        """Stress inside and outside the sphere, (..., 6) in Pa; x, y, z >= 0 in m, broadcast. s_ij = -2 mu K
        [(1/R1)_,ij + image_ij]; inside the sphere the first term is replaced by the full-space state -4 mu
        K/radius^3 delta_ij = -2 E e/(3 (1 - nu)) delta_ij. At the sphere's surface: the outside value.
        """
        x, y, z = coordinate("x", x), coordinate("y", y), depth("z", z)
        height = z - self.centre_depth
        inside = x**2 + y**2 + height**2 < self.radius**2
        source = _second_derivatives(x, y, np.where(inside, 2.0 * self.radius, height))
        core = components(*(2.0 / self.radius**3,) * 3)
        field = np.where(inside[..., None], core, source) + self._image(x, y, z)
        shear_modulus = self.young / (2.0 * (1.0 + self.nu))
        return -2.0 * shear_modulus * self.strength * field

    def _image(self, x, y, z) -> np.ndarray:
        """Field that frees the surface z = 0; G = 1/R2, R2^2 = x^2 + y^2 + (z + d)^2, subscript 3 = d/d(z +
        d). xx: 3 G_11 + 4 nu G_22 + 2 z G_113; yy: 3 G_22 + 4 nu G_11 + 2 z G_223; zz: -G_33 + 2 z G_333; yz:
        G_23 + 2 z G_233; xz: G_13 + 2 z G_133; xy: (3 - 4 nu) G_12 + 2 z G_123.
        """
        level = z + self.centre_depth
        g11, g22, g33, g23, g13, g12 = np.moveaxis(_second_derivatives(x, y, level), -1, 0)
        gradient = components(
            3.0 * g11 + 4.0 * self.nu * g22,
            3.0 * g22 + 4.0 * self.nu * g11,
            -g33,
            g23,
            xz=g13,
            xy=(3.0 - 4.0 * self.nu) * g12,
        )
        return gradient + 2.0 * z[..., None] * _third_derivatives(x, y, level)


def _second_derivatives(x, y, z) -> np.ndarray:
    """(1/R)_,ij = (3 x_i x_j/R^2 - delta_ij)/R^3, (..., 6) in m^-3."""
    square = x**2 + y**2 + z**2
    products = components(x * x, y * y, z * z, y * z, xz=x * z, xy=x * y)
    delta = components(1.0, 1.0, 1.0)
    return (3.0 * products / square[..., None] - delta) / (square * np.sqrt(square))[..., None]


def _third_derivatives(x, y, z) -> np.ndarray:
    """(1/R)_,ij3 = [-15 x_i x_j z/R^2 + 3 (delta_ij z + delta_i3 x_j + delta_j3 x_i)]/R^5, m^-4."""
    square = x**2 + y**2 + z**2
    products = components(x * x, y * y, z * z, y * z, xz=x * z, xy=x * y)
    linear = components(z, z, 3.0 * z, y, xz=x)
    bracket = 3.0 * linear - 15.0 * products * (z / square)[..., None]
    return bracket / (square**2 * np.sqrt(square))[..., None]
