# SPDX-License-Identifier: MIT
"""Conditions of a coated, elastic body as SAM returns it, without or with sliding friction; as in
`conditions`.

Its surface moves as that of a half-space of the film's material (closed forms, cell by cell) and by what the
body below adds, Hankel integrals of the compliances of `CoatedHalfSpace` less those of short waves. These are
smooth over the film's thickness: a few points in each cell do.
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import j0, j1

from sam.scene import Result, Scene
from verification.checks.cells import half_space
from verification.checks.conditions import conditions, initial_gap, plane_of, surface_of, traction_of
from verification.checks.material import in_plane
from verification.reference.layered_axisymmetric import CoatedHalfSpace, wave_numbers

SHORTEST = 24.0  # wave number times thickness
RADII, POINTS = 3000, 6
"""Of the splines of the Hankel integrals; Gauss points of a cell each way, none in its middle."""


def displaced(scene: Scene, result: Result) -> float:
    """`conditions` of all cells, their displacement summed directly."""
    x, y, p = surface_of(result)
    film, cell = scene.body.coating, result.discretisation["cell_m"]
    q = traction_of(scene, result)
    u = half_space(film.young, film.poisson, x, y, p=p, q=q, cell=cell)
    reach = 1.05 * float(np.hypot(np.ptp(x) + cell[0], np.ptp(y) + cell[1]))
    for k, load in enumerate((p, q)):
        if load.any():
            u = u + cell[0] * cell[1] * summed(
                cell_means(scene, reach, k, p.shape, cell=cell), load, odd=k == 1
            )
    return conditions(initial_gap(scene, x[:, None], y[None, :], 0.0) + u, p, result)


def cell_means(
    scene: Scene, reach: float, load: int, shape: tuple[int, int], *, cell: tuple[float, float]
) -> np.ndarray:
    """(nx, ny) means over a cell, i hx and j hy away, of u_z by the body below, in m/N: of a unit
    force along z or x. With c cos(k x) under p = cos(k x) or q = sin(k x): (1/2 pi) times the
    integral of c J0(k r) k dk, and -cos(theta)/2 pi times that of c J1(k r) k dk.
    """
    film, body = scene.body.coating, scene.body
    layers = CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)
    k, weight = wave_numbers(film.thickness, reach, SHORTEST)
    short = (1 - film.poisson, -(1 - 2 * film.poisson) / 2)[load] * 2 * (1 + film.poisson) / film.young
    c = k * layers.compliance(k, layers.amplitudes(k, shear=load == 1)) - short
    r = np.linspace(0.0, reach, RADII)
    bessel = j0(np.outer(r, k)) if load == 0 else -j1(np.outer(r, k))
    radial = CubicSpline(r, bessel @ (weight * c) / (2 * np.pi))
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    x, y = ((np.arange(n)[:, None] + 0.5 * nodes) * side for n, side in zip(shape, cell, strict=True))
    dx, dy = x.reshape(-1, 1), y.reshape(1, -1)
    at = np.hypot(dx, dy)
    values = radial(at) * (dx / at if load else 1.0)
    return np.einsum(
        "ipjq,p,q->ij", values.reshape(shape[0], POINTS, shape[1], POINTS), weights / 2, weights / 2
    )


def summed(influence: np.ndarray, load: np.ndarray, odd: bool) -> np.ndarray:
    """(nx, ny) sums over the loaded cells of `influence` of their distances, odd or even along x."""
    i, j = np.nonzero(load)
    di, dj = (np.arange(n)[:, None] - at for n, at in zip(load.shape, (i, j), strict=True))
    sign = np.sign(di) if odd else np.ones_like(di)
    values = influence[np.abs(di)[:, None, :], np.abs(dj)[None, :, :]]
    return (values * sign[:, None, :]) @ load[i, j]


def interface(scene: Scene, result: Result) -> float:
    """Jumps at the interface in y = 0: of szz, syz, sxz over the largest pressure, of exx, eyy, exy
    over that of E of the softer. The film's side is the last depth above the interface.
    """
    _, z, stress = plane_of(result)
    film, body = scene.body.coating, scene.body
    k = int(np.argmin(np.abs(z - film.thickness)))
    top = surface_of(result)[2].max()
    above, below = stress[:, :, k - 1], stress[:, :, k]
    strains = in_plane(above, film.young, film.poisson) - in_plane(below, body.young, body.poisson)
    jump = np.abs(strains).max() * min(film.young, body.young)
    return float(max(np.abs(above - below)[2:5].max(), jump) / top)
