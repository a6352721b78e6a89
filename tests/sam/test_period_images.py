# SPDX-License-Identifier: MIT
"""Stress of the periodic images of a box against sums of the closed form over images."""

from functools import cache

import numpy as np
import pytest

from sam.kernels.eigenstrain import MIRRORED
from sam.kernels.layer_stress import CornerFunctions, LayerStress
from sam.kernels.patches import Cuboids, Lags
from sam.kernels.waves import nodes as nodes_of
from sam.plasticity.swept import PeriodImages

CELLS, SIDES = (16, 16), np.array([16.0, 20.0])  # cells of 1 x 1.25
EVEN, GRADED = (0.0, 2.0, 4.0, 6.0), (0.5, 0.8, 2.0, 6.0)
STRAIN = np.random.default_rng(3).standard_normal((6, 3, 2, 2))  # in layers and quarters of the box
SUMS, POWERS = np.array([3, 5, 8, 12]), (3, 4, 5)


@cache
def images(faces, nu, period, tolerance) -> PeriodImages:
    return PeriodImages(Cuboids(Lags(1, 1, 1.0, 1.25), faces, nu), CELLS, period, tolerance)


def closed_form(faces, nu, z, x, y):
    """Stress at the depth z by unit strain between lines in x and y from there, (6, 6, layers, X, Y)."""
    lines = [part[None] for part in np.meshgrid(x, y, indexing="ij")]
    out = np.empty((36, len(faces) - 1, len(x) - 1, len(y) - 1))
    LayerStress(CornerFunctions(out.shape[2:], tuple(lines)), np.array([[z]]), np.array(faces), nu).of(0, out)
    return out.reshape(6, 6, *out.shape[1:])


def uniform(faces, nu, z):
    """Stress/mu at z by laterally uniform strain in layers, (6, 6, layers)."""
    out = np.zeros((6, 6))
    out[:2, :2] = -2 / (1 - nu) * np.array([[1, nu], [nu, 1]])
    out[5, 5] = -2
    return out[..., None] * ((np.array(faces[:-1]) <= z) & (z < np.array(faces[1:])))


def summed(faces, nu, period, place):
    """Stress at a place (z, x, y) by STRAIN in the images: sums over ever more of them, completed by strain
    that is spread evenly over the rest of the plane, and extrapolated from there.
    """
    most, away, (z, *place) = SUMS[-1] + 1, period * SIDES / CELLS, place
    numbers, edges = np.arange(-most, most + 1)[:, None], np.array([-1, 0, 1])
    lines = [p - (numbers * b + s / 2 * edges).ravel() for p, s, b in zip(place, SIDES, away, strict=True)]
    of_cells = closed_form(faces, nu, z, *(line[::-1] for line in lines))[..., ::-1, ::-1]
    of_cells = np.pad(of_cells, [*[(0, 0)] * 3, (0, 1), (0, 1)]).reshape(6, 6, 3, len(numbers), 3, -1, 3)
    of_images = np.einsum("ijzmanb,jzab->imn", of_cells[:, :, :, :, :2, :, :2], STRAIN)
    of_images[:, most, most] = 0.0
    sums = []
    for m in SUMS:
        some = slice(most - m, most + m + 1)
        sums.append(of_images[:, some, some].sum(axis=(1, 2)))
        for a, b in np.ndindex(2, 2):
            offset = place - SIDES / 4 * (2 * np.array([a, b]) - 1)
            within = (offset + (m + 0.5) * away * side for side in (-1, 1))
            rest = uniform(faces, nu, z) - closed_form(faces, nu, z, *np.transpose([*within]))[..., 0, 0]
            sums[-1] += np.einsum("ijz,jz->i", rest, STRAIN[:, :, a, b]) * (SIDES / 2 / away).prod()
    powers = (2.0 * SUMS[:, None] + 1) ** -np.array([0, *POWERS])
    return np.linalg.solve(powers, sums)[0]


@pytest.mark.parametrize(
    "faces, nu, period, tolerance",
    [
        (EVEN, 0.3, (32, 32), 1e-4),
        (GRADED, 0.5, (32, 24), 1e-4),
        (EVEN, 0.0, (32, 32), 1e-6),
        (GRADED, 0.3, (40, 28), 1e-6),
        (GRADED, 0.5, (64, 64), 1e-9),
    ],
)
def test_equal_to_a_sum_over_images(faces, nu, period, tolerance):
    of = images(faces, nu, period, tolerance)
    values = of.values(of.moments(np.kron(STRAIN, np.ones((8, 8)))))
    nodes = [nodes_of(n) for n in values.shape[1:]]
    middle, half = (faces[-1] + faces[0]) / 2, (faces[-1] - faces[0]) / 2
    for k in ((0, 0, 0), (-1, 1, nodes[2].size // 2)):
        z, x, y = (node[i] for node, i in zip(nodes, k, strict=True))
        answer = summed(faces, nu, period, (middle + half * z, x * SIDES[0] / 2, y * SIDES[1] / 2))
        np.testing.assert_allclose(values[:, *k], answer, rtol=0, atol=2 * tolerance * abs(STRAIN).max())


@pytest.mark.parametrize("layers, nu", [((0, 0), 0.3), ((0, 2), 0.5), ((2, 1), 0.0)])
def test_coefficients_between_layers_are_those_of_the_box(layers, nu):
    faces = (0.5, 0.8, 1.1, 1.5)
    of = images(faces, nu, (32, 24), 1e-6)
    pairs = [faces[k : k + 2] for k in layers]
    full, image = (of.between(part, *pairs, (16, 12)).reshape(6, 6, 17, 13) for part in (False, True))
    strain = np.zeros((6, 6, 3, *CELLS))
    strain[np.arange(6), np.arange(6), layers[1], 2, 5] = 1.0
    fields = np.stack([of.fields(of.values(of.moments(each))) for each in strain], axis=1)
    bound = 2e-5 * abs(full + image).max()
    np.testing.assert_allclose(
        (full + image)[..., :14, :11], fields[:, :, layers[0], 2:, 5:], rtol=0, atol=bound
    )
    mirrored = of.between(False, *pairs[::-1], (16, 12)) * np.diff(pairs[1]) / np.diff(pairs[0])
    np.testing.assert_allclose((mirrored * MIRRORED).reshape(full.shape), full, rtol=0, atol=bound)
