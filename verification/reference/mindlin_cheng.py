# SPDX-License-Identifier: MIT
"""A sphere with a uniform isotropic eigenstrain (thermal expansion) in a half-space with a free surface.

Source: Mindlin and Cheng, Thermoelastic stress in the semi-infinite solid, J. Appl. Phys. 21 (1950) 931-933.
Outside, the field is that of a centre of dilatation for any sphere that does not cut the surface.
"""

from dataclasses import dataclass

import numpy as np

from .checks import coordinate, depth, finite, poisson, positive
from .nuclei import point_nucleus
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
        """Stress inside and outside the sphere, (..., 6) in Pa; x, y, z >= 0 in m, broadcast, not
        the centre itself. That of the sphere's volume of `nuclei.point_nucleus`; inside the sphere its part
        of a full space, -2 mu K (1/R)_,ij, is replaced by -4 mu K/radius^3 delta_ij = -2 E e/(3 (1 - nu))
        delta_ij. At the sphere's surface: the outside value.
        """
        place = x, y, z = np.broadcast_arrays(coordinate("x", x), coordinate("y", y), depth("z", z))
        height = z - self.centre_depth
        inside = x**2 + y**2 + height**2 < self.radius**2
        volume = 4.0 / 3.0 * np.pi * self.radius**3
        nucleus = point_nucleus(place, self.centre_depth, self.nu)[:6, :3].sum(axis=1)
        found = volume * self.eigenstrain * np.moveaxis(nucleus, 0, -1)
        core = components(*(2.0 / self.radius**3,) * 3) - _second_derivatives(x, y, height)
        found = found - 2.0 * self.strength * np.where(inside[..., None], core, 0.0)
        return self.young / (2.0 * (1.0 + self.nu)) * found


def _second_derivatives(x, y, z) -> np.ndarray:
    """(1/R)_,ij = (3 x_i x_j/R^2 - delta_ij)/R^3, (..., 6) in m^-3."""
    square = x**2 + y**2 + z**2
    products = components(x * x, y * y, z * z, y * z, xz=x * z, xy=x * y)
    delta = components(1.0, 1.0, 1.0)
    return (3.0 * products / square[..., None] - delta) / (square * np.sqrt(square))[..., None]
