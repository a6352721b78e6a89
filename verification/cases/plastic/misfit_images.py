# SPDX-License-Identifier: MIT
"""Images of plastic strain at a free surface: those of a spherical plastic zone cancel."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from sam.contact import Counters
from sam.kernels import Cuboids, Lags
from sam.plasticity import BoxOperator
from verification.reference.misfit_sphere import GrowingSphere

NAMES = ("xx", "yy", "zz", "yz", "xz", "xy")
CELLS = 8  # in the radius: with 6 the cells leave so much that 1 % of four coefficients shows by 1.1 only
CENTRE = 1.3  # depth of the centre in radii: the zone of linear hardening ends 0.19 radii below the surface
DEEP = 10.0  # in radii: a five-hundredth of the images is left
POINTS = 4  # Gauss points of a cell each way, for means of the closed form


@dataclass(frozen=True)
class Images:
    """Of a plastic zone without hardening of its own: stress over the shear modulus, lengths in radii. parts:
    stress I that the surface adds because of strain J alone, (J, I, layers, nx, ny); raised: displacement u_z
    of the surface by strain J, (J, nx, ny); stress: L2 of the stress of all of it far from any surface.
    """

    parts: np.ndarray
    raised: np.ndarray
    stress: float

    def left(self, factors: Sequence[float] = (1.0,) * 6) -> np.ndarray:
        """L2 of the images of each stress over the stress, and the largest displacement of the surface, (7,):
        zero but for the cells. factors: by which the coefficients of each strain J are wrong.
        """
        wrong = np.array(factors)[:, None, None]
        stress = (wrong[..., None, None] * self.parts).sum(axis=0)
        norms = np.sqrt((stress**2).reshape(6, -1).sum(axis=1)) / self.stress
        return np.append(norms, np.abs((wrong * self.raised).sum(axis=0)).max())


def images(exact: GrowingSphere, cells: int = CELLS) -> Images:
    """Of the plastic zone of a closed form, on cubes, of its radius over `cells`."""
    edges = _edges(exact, cells)
    strain = mean_strain(exact, edges)
    near, raised = _alone(strain, CENTRE + edges, exact.nu)
    far, _ = _alone(strain, DEEP + edges, exact.nu)
    return Images(near - far, raised, float(np.sqrt((far.sum(axis=0) ** 2).sum())))


def _edges(exact: GrowingSphere, cells: int) -> np.ndarray:
    """Of cubes about the zone, in radii from its centre."""
    half = ceil(exact.zone()[1] / exact.radius * cells)
    return (np.arange(-half, half + 2) - 0.5) / cells


def cell_means(of: Callable[..., np.ndarray], edges: Sequence[np.ndarray]) -> np.ndarray:
    """Means over cells of a function of x, y and z, (..., nx, ny, nz), by Gauss points; edges: along each."""
    t, w = np.polynomial.legendre.leggauss(POINTS)
    x, y, z = (((e[1:] + e[:-1])[:, None] + np.diff(e)[:, None] * t) / 2 for e in edges)
    total = np.zeros(())
    for k, p in enumerate(w):  # one at a time, for the memory
        field = of(x.ravel()[:, None, None], y.ravel()[:, None], z[:, k])
        parts = field.reshape(*field.shape[:-3], len(x), POINTS, len(y), POINTS, len(z))
        total = total + p / 8 * np.einsum("...iajbk,a,b->...ijk", parts, w, w)
    return total


def mean_strain(exact: GrowingSphere, edges: np.ndarray) -> np.ndarray:
    """Means of the plastic strain over cells, (6, layers, nx, ny); edges: in radii from the centre."""

    def strain(*place: np.ndarray) -> np.ndarray:
        r = np.sqrt(sum(each**2 for each in place))
        q, n = exact.fields(r * exact.radius).plastic, [each / r for each in place]
        pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
        return np.stack([q * ((i == j) - 3 * n[i] * n[j]) for i, j in pairs])

    return np.moveaxis(cell_means(strain, (edges, edges, edges)), 3, 1)


def _alone(strain: np.ndarray, faces: np.ndarray, nu: float) -> tuple[np.ndarray, np.ndarray]:
    """Stress (J, I, layers, nx, ny) and u_z of the surface (J, nx, ny) by each component J by itself."""
    count, size = strain.shape[-1], float(faces[1] - faces[0])
    cuboids = Cuboids(Lags(count, count, size, size), (0.0, *map(float, faces)), nu)
    operator = BoxOperator(cuboids, 1.0, Counters())
    stress, moved = [], []
    for j in range(6):
        one = np.zeros((6, len(faces), count, count))
        one[j, 1:] = strain[j]
        transformed = operator.transformed(one)
        stress.append(operator.stress(None, operator.response(transformed))[:, 1:])
        moved.append(operator.displacement(transformed))
    return np.array(stress), np.array(moved)
