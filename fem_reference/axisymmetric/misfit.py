# SPDX-License-Identifier: MIT
"""A misfit sphere on the axis of a half-space: its strain, and the elastic fields far from it.

The misfit strain e(R), 1 at the centre, is the same in all directions. With its mean m(R) inside the distance
R, an elastic body around it is displaced radially by (1 + nu)/(3 (1 - nu)) m R, and stressed by s_RR = -2/3 c
m and s_tt - s_RR = c (m - e), c = E/(1 - nu) (Timoshenko and Goodier, Theory of Elasticity, 1970, Art. 152).
Plastic strain of a zone around the sphere changes none of them outside of it. A free surface adds the image
of Mindlin and Cheng (J. Appl. Phys. 21 (1950) 931). Lengths are in radii of the sphere, strains in that of
its centre.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Elastic

_erf = np.vectorize(math.erf, otypes=[float])
EDGE_POINTS = 8
"""Gauss points of an edge for the tractions, which are smooth: exact to rounding."""


def _smooth(s: Array) -> tuple[Array, Array]:
    inside, outer = np.minimum(s, 1.0) ** 2, np.maximum(s, 1.0) ** 3
    mean = 1.0 - 1.2 * inside + 3.0 / 7.0 * inside**2
    return (1.0 - inside) ** 2, mean / outer


def _ball(s: Array) -> tuple[Array, Array]:
    return (s < 1.0).astype(float), 1.0 / np.maximum(s, 1.0) ** 3


def _gauss(s: Array) -> tuple[Array, Array]:
    far, local = np.maximum(s, 0.1), np.exp(-(s**2))
    mean = 0.75 * (np.sqrt(np.pi) * _erf(far) - 2.0 * far * np.exp(-(far**2))) / far**3
    series = 1.0 - 0.6 * s**2 + 3.0 / 14.0 * s**4 - s**6 / 18.0 + s**8 / 88.0
    return local, np.where(s < 0.1, series, mean)


PROFILES: dict[str, Callable[[Array], tuple[Array, Array]]] = {
    "smooth": _smooth,
    "ball": _ball,
    "gauss": _gauss,
}
"""(e, m) over the distance from the centre."""


@dataclass(frozen=True)
class MisfitSphere:
    """A misfit sphere about (0, depth). free: no tractions at z = 0; else of an infinite body."""

    elastic: Elastic
    depth: float
    profile: str
    free: bool

    @property
    def stiffness(self) -> float:
        """Stress per strain, c in the text above."""
        return self.elastic.young / (1.0 - self.elastic.poisson)

    def strain(self, r: Array, z: Array) -> Array:
        """(4, ...) misfit strain (rr, tt, zz, 2 rz)."""
        e = PROFILES[self.profile](np.hypot(r, z - self.depth))[0]
        return np.stack([e, e, e, np.zeros_like(e)])

    def displacement(self, r: Array, z: Array) -> Array:
        """(2, n) displacements (u_r, u_z) of the elastic body outside of the sphere."""
        nu = self.elastic.poisson
        share = (1.0 + nu) / (3.0 * (1.0 - nu))
        distance = np.hypot(r, z - self.depth)
        u = share * PROFILES[self.profile](distance)[1] * np.stack([r, z - self.depth])
        if not self.free:
            return u
        below = z + self.depth
        R = np.hypot(r, below)
        # of a unit centre of dilatation far away: the mean times the cube of the distance
        far = share * float(PROFILES[self.profile](np.array(1e6))[1]) * 1e18
        u_r = (3.0 - 4.0 * nu) * r / R**3 - 6.0 * z * below * r / R**5
        u_z = -(3.0 - 4.0 * nu) * below / R**3 + 2.0 * z / R**3 - 6.0 * z * below**2 / R**5
        return u + far * np.stack([u_r, u_z])

    def surface_forces(self, r: Array) -> Array:
        """(2, n) consistent nodal forces along r and z that hold the surface, at the nodes r."""
        forces = np.zeros((2, r.size))
        if self.free:
            return forces
        t, w = np.polynomial.legendre.leggauss(EDGE_POINTS)
        s, w = 0.5 * (t + 1.0), 0.5 * w
        at = r[:-2:2, None] + np.diff(r[::2])[:, None] * s
        distance = np.hypot(at, self.depth)
        e, m = PROFILES[self.profile](distance)
        radial, more = -2.0 / 3.0 * self.stiffness * m, self.stiffness * (m - e)
        along, down = at / distance, -self.depth / distance
        # the surface looks towards -z: traction = -(s_rz, s_zz)
        tractions = more * along * down, more * down**2 - (radial + more)
        shapes = (1.0 - s) * (1.0 - 2.0 * s), 4.0 * s * (1.0 - s), s * (2.0 * s - 1.0)
        for out, traction in zip(forces, tractions, strict=True):
            ring = 2.0 * np.pi * at * traction * np.diff(r[::2])[:, None] * w
            for first, shape in enumerate(shapes):
                out[first : r.size - 2 + first : 2] += ring @ shape
        return forces

    def zone(self, limit: float) -> float:
        """Radius of the plastic zone in an infinite body of a yield stress; 0 without one."""
        s = np.linspace(0.0, max(1.0, 2.0 * np.cbrt(self.stiffness / limit)), 8001)
        e, m = PROFILES[self.profile](s)
        return float(s[self.stiffness * (m - e) >= limit].max(initial=0.0))
