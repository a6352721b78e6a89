# SPDX-License-Identifier: MIT
"""A misfit sphere: material about a centre that would grow, by the same linear strain in all directions, if
it were free.

The body around it makes stress of it. With the misfit strain e(r), E and nu, and the mean of e inside a
radius M(r) = 3/r^3 int_0^r e s^2 ds, that of an infinite body is s_r = -2 E M/(3 (1 - nu)) and s_theta - s_r
= E (M - e)/(1 - nu) (Timoshenko & Goodier 1970, Art. 152). Outside of the sphere it is that of a centre of
dilatation of strength S = int e s^2 ds * 3. A free surface adds the image of that centre (Mindlin & Cheng
1950), exact also above and inside the sphere, as the image of a point is harmonic in the place of the point.

With u = -K grad(1/R) of the centre, K = (1 + nu) S/(3 (1 - nu)), and phi = 1/R' about the mirrored centre the
displacement of the image is

    u' = -K ((3 - 4 nu) grad phi + 2 z grad phi_z - 2 (3 - 4 nu) e_z phi_z).                           (a)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from sam.arrays import Array
from sam.grid.cells import CellGrid, Window
from sam.half_space import ElasticConstants

SMALL = 1e-2  # of x: below it the series of the mean of exp(-x^2), whose next term is 1e-13
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)  # of the mean over a cell, in each direction
FARTHEST = 4.5  # radii: no grid is chosen for a larger zone (about 400 times the strain of first yield)
ZONE_POINTS = 4001  # at which the stress is looked at for the zone, 1e-3 radii apart
AT_ONCE = 200_000  # points whose stress is taken at once: 10 MB


@dataclass(frozen=True)
class Profile:
    """A misfit strain over x = r/radius, 1 at the centre, its mean inside x, and 3 int f x^2 dx."""

    local: Callable[[Array], Array]
    mean: Callable[[Array], Array]
    strength: float


def _inside(x: Array, inside: Callable[[Array], Array], strength: float) -> Array:
    """A mean that is `inside` up to x = 1, and that of the strength beyond."""
    return np.where(x < 1, inside(np.minimum(x, 1.0)), strength / np.maximum(x, 1.0) ** 3)


def _mean_of_gauss(x: Array) -> Array:
    large = np.maximum(x, SMALL)
    mean = 3 / large**3 * (np.sqrt(np.pi) / 4 * erf(large) - large / 2 * np.exp(-(large**2)))
    return np.where(x < SMALL, 1 - 3 / 5 * x**2 + 3 / 14 * x**4, mean)


PROFILES: Mapping[str, Profile] = {
    "smooth": Profile(
        lambda x: np.where(x < 1, (1 - np.minimum(x, 1.0) ** 2) ** 2, 0.0),
        lambda x: _inside(x, lambda s: 1 - 6 / 5 * s**2 + 3 / 7 * s**4, 8 / 35),
        8 / 35,
    ),
    "ball": Profile(lambda x: np.where(x < 1, 1.0, 0.0), lambda x: _inside(x, np.ones_like, 1.0), 1.0),
    "gauss": Profile(lambda x: np.exp(-(x**2)), _mean_of_gauss, 3 * float(np.sqrt(np.pi)) / 4),
}
"""The profiles of a scene, by their names."""


@dataclass(frozen=True)
class MisfitSphere:
    """A misfit strain, linear, about (0, 0, depth) in m; free: z = 0 has no tractions."""

    body: ElasticConstants
    depth: float
    radius: float
    strain: float
    profile: Profile
    free: bool

    def deviator(self, x: Array) -> Array:
        """s_theta - s_r of the infinite body in Pa at distances x, in radii, from the centre."""
        scale = self.body.young * self.strain / (1 - self.body.poisson)
        return scale * (self.profile.mean(x) - self.profile.local(x))

    def radial(self, x: Array) -> Array:
        """s_r of the infinite body in Pa at distances x, in radii, from the centre."""
        scale = self.body.young * self.strain / (1 - self.body.poisson)
        return -2 / 3 * scale * self.profile.mean(x)

    def zone(self, limit: float) -> float:
        """Radius in m of the plastic zone at a yield stress in Pa, FARTHEST radii at most, 0 for none."""
        scale = self.body.young * self.strain / (1 - self.body.poisson) * self.profile.strength
        x = np.linspace(0.0, min((scale / limit) ** (1 / 3), FARTHEST), ZONE_POINTS)
        reaching = x[self.deviator(x) >= limit * (1 - 1e-9)]
        return self.radius * float(reaching.max(initial=0.0))

    def stress(self, x: Array, y: Array, z: Array) -> Array:
        """Stress at points in m, (6, ...) in Pa, where x, y and z broadcast; z >= 0 on a free surface."""
        place = np.stack(np.broadcast_arrays(x, y, z - self.depth)) / self.radius
        distance = np.sqrt((place**2).sum(axis=0))
        normal = place / np.where(distance == 0, 1.0, distance)
        radial, deviator = self.radial(distance), self.deviator(distance)
        out = -deviator * _products(normal)
        out[:3] += radial + deviator
        return out + self._image(x, y, z) if self.free else out

    @property
    def _centre(self) -> float:
        """K of (a) in m^3."""
        nu, strength = self.body.poisson, self.profile.strength * self.strain * self.radius**3
        return (1 + nu) / (3 * (1 - nu)) * strength

    def _image(self, x: Array, y: Array, z: Array) -> Array:
        """Stress of (a) in Pa at points in m, (6, ...)."""
        nu, zeta = self.body.poisson, z + self.depth
        place = np.stack(np.broadcast_arrays(x, y, zeta))
        square = (place**2).sum(axis=0)
        distance = np.sqrt(square)
        products = _products(place)
        identity = np.array([1.0, 1, 1, 0, 0, 0]).reshape(6, *[1] * square.ndim)
        along_z = np.zeros_like(products)  # delta_iz X_j + delta_jz X_i
        along_z[2], along_z[3], along_z[4] = 2 * place[2], place[1], place[0]
        second = (3 * products / square - identity) / distance**3
        third = 3 * (along_z + place[2] * identity) / distance**5 - 15 * place[2] * products / distance**7
        mixed = np.zeros_like(second)  # delta_iz phi_zj + delta_jz phi_zi
        mixed[2], mixed[3], mixed[4] = 2 * second[2], second[3], second[4]
        strain = (3 - 4 * nu) * second + 2 * z * third - (2 - 4 * nu) * mixed
        return -2 * self.body.shear * self._centre * (strain - 4 * nu * second[2] * identity)

    def mean_stress(self, grid: CellGrid, window: Window, faces: Array) -> Array:
        """Means over the cells of a window and the layers between faces in m, (6, nz, nx, ny) in Pa."""
        (i, j), layers = window.slices, len(faces) - 1
        out = np.zeros((6, layers, window.nx, window.ny))
        x = grid.x[i, None] + grid.hx / 2 * POINTS
        y = grid.y[j, None] + grid.hy / 2 * POINTS
        z = (faces[1:] + faces[:-1])[:, None] / 2 + np.diff(faces)[:, None] / 2 * POINTS
        at_once = max(1, AT_ONCE // (x.size * y.size))
        for a, p in enumerate(WEIGHTS):
            for first in range(0, layers, at_once):
                some = slice(first, first + at_once)
                depths = z[some, a, None, None, None, None]
                points = self.stress(x[:, :, None, None], y, depths)
                out[:, some] += p / 8 * np.einsum("...iajb,a,b->...ij", points, WEIGHTS, WEIGHTS)
        return out

    def moved_surface(self, grid: CellGrid) -> Array:
        """u_z of the surface at the centres of the cells, (nx, ny) in m, > 0 into the body."""
        square = grid.x[:, None] ** 2 + grid.y**2 + self.depth**2
        held = -self._centre * self.depth / square**1.5
        return 4 * (1 - self.body.poisson) * held if self.free else held


def _products(vector: Array) -> Array:
    """n_i n_j of (3, ...), as (6, ...)."""
    a, b, c = vector
    return np.stack([a * a, b * b, c * c, b * c, a * c, a * b])
