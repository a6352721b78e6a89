# SPDX-License-Identifier: MIT
"""Sweeps over depth against matrices between all layers and tables; images of a period against their sums."""

from functools import cache

import numpy as np
import pytest
from builders import SWIFT, running_in, scene
from made_results import column as of_state

import sam
from sam.contact.convolution import Counters
from sam.kernels.eigenstrain import ENTRIES, FOURTH, MIRRORED, _full_space_matrix, eigenstrain_table
from sam.kernels.layer_stress import CornerFunctions, LayerStress
from sam.kernels.patches import Cuboids, Lags
from sam.kernels.waves import nodes as nodes_of
from sam.plasticity.spectra import ODD_X, ODD_Y, BoxOperator
from sam.plasticity.swept import GAUSS, PeriodImages, Sweeps, SweptLayers

EVEN, GRADED = np.arange(7.0), np.append(0.0, np.cumsum(0.3 * 1.5 ** np.arange(6)))
ASPECT = 0.7
PHASE = (-1j) ** (ODD_X + ODD_Y)


def in_waves(nu, kx, ky, z, source):
    """Stress/mu at depths z by a unit strain per depth at others, of one wave, (6, 6, z, source), in the
    full space, and what the free surface adds. R and 1/R are -2 pi (1 + k |zeta|) e^{-k |zeta|}/k^3 and
    2 pi e^{-k zeta}/k in wave numbers.
    """
    k, zeta, sum_z = np.hypot(kx, ky), np.abs(z[:, None] - source), z[:, None] + source
    full, image = np.zeros((2, 36, *zeta.shape), complex)
    for column, indices in zip(_full_space_matrix(nu).T / (8 * np.pi * (1 - nu)), FOURTH, strict=True):
        a, b, c = (indices.count(i) for i in range(3))
        of_z = (
            (-k) ** c * (1 - c + k * zeta) * np.exp(-k * zeta)
        )  # c-th derivative of (1 + k zeta) e^{-k zeta}
        full += column[:, None, None] * -2 * np.pi / k**3 * (1j * kx) ** a * (1j * ky) ** b * of_z
    for row, name in enumerate(ENTRIES):
        for (p, q, a, b, c), powers in eigenstrain_table()["stress"][name].items():
            factor = sum(value * nu**n for n, value in enumerate(powers)) / (8 * np.pi * (1 - nu))
            of_z = (-k) ** c * 2 * np.pi / k * np.exp(-k * sum_z)
            image[row] += factor * np.outer(z**p, source**q) * (1j * kx) ** a * (1j * ky) ** b * of_z
    full *= np.where(z[:, None] < source, MIRRORED, 1)
    return full.reshape(6, 6, *zeta.shape), image.reshape(6, 6, *zeta.shape)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("faces", [EVEN, GRADED], ids=["even", "graded"])
def test_sweeps_sum_over_the_layers_what_the_tables_give(nu, faces):
    """Quadrature over the strained layer, points of the observed one; no full space in its own layer."""
    rng = np.random.default_rng(0)
    layers = len(faces) - 1
    box = Cuboids(Lags(4, 4, 1.0, ASPECT), tuple(faces), nu)
    waves, centres, halves = rng.uniform(0.1, 3.0, (2, 2)), (faces[1:] + faces[:-1]) / 2, np.diff(faces) / 2
    x, w = np.polynomial.legendre.leggauss(12)
    z, source = (np.add(centres[:, None], np.outer(halves, at)).ravel() for at in (GAUSS, x))
    weight = np.outer(halves, w).ravel() / 2
    expected = np.zeros((2, 6, layers, 6, layers))
    for n, (kx, ky) in enumerate(waves.T):
        plane = np.sinc(kx / 2 / np.pi) * np.sinc(ky * ASPECT / 2 / np.pi) * np.cos(kx / 2 / np.sqrt(3))
        plane *= np.cos(ky * ASPECT / 2 / np.sqrt(3))
        full, image = (
            (plane * weight * each).reshape(6, 6, layers, 2, layers, 12).sum(axis=(3, 5))
            for each in in_waves(nu, kx, ky, z, source)
        )
        stress = (full * (1 - np.eye(layers)) + image).swapaxes(1, 2)
        stress /= PHASE.reshape(6, 1, 1, 1) * PHASE.reshape(6, 1)
        expected[n] = stress.real
        assert np.abs(stress.imag).max() < 1e-14
    size, strain = np.abs(expected).max(), rng.standard_normal((2, 6 * layers, 3))
    for real, rounding in ((np.float64, 1e-12), (np.float32, 1e-6)):
        found = next(each for _, each in Sweeps(waves, box, real).matrices(reflected=True))
        assert np.abs(found - expected).max() <= rounding * size
        product = found.reshape(2, 6 * layers, -1) @ strain
        assert np.abs(Sweeps(waves, box, real)(strain) - product).max() <= rounding * np.abs(product).max()


class Drawn:
    """Coefficients drawn at random, alike for layers alike at equal distances."""

    def __init__(self, faces, waves, nu):
        self.faces, self.waves, self.nu, self.known = faces, waves, nu, {}

    def pair(self, i, j):
        key = np.round([*np.diff(self.faces)[[i, j]], self.faces[i] - self.faces[j]], 9).tobytes()
        seed = np.frombuffer(key, np.uint32)
        return np.random.default_rng(seed).standard_normal((6, 6, self.waves.shape[1]))

    def full_space(self, observed, sources):
        return np.stack([self.pair(observed, j) for j in range(sources.start, sources.stop)], axis=2)

    def image(self, layers):
        shape = (6, layers, 6, layers, self.waves.shape[1])
        return np.random.default_rng(layers).standard_normal(shape)


TWO = np.append(np.arange(5.0) / 4, np.arange(2.0, 9.0))


@pytest.mark.parametrize("error", [0.5, 1e-3, 1e-30])
@pytest.mark.parametrize("faces", [EVEN, np.arange(3.0), GRADED, TWO], ids=["even", "few", "graded", "two"])
def test_layers_near_each_other_have_the_coefficients_of_cells(faces, error):
    """In place of (h), between layers less than log(8/error)/pi cells apart and their images."""
    layers, waves = len(faces) - 1, np.array([[0.0, 0.4, 3.0], [0.0, 1.0, 0.2]])
    box, drawn = Cuboids(Lags(4, 4, 1.0, 1.0), tuple(faces), 0.3), Drawn(faces, waves, 0.3)
    full, both = (next(Sweeps(waves, box, np.float64).matrices(each))[1] for each in (False, True))
    expected, reach = both.copy(), np.log(8 / error) / np.pi
    top = np.count_nonzero(faces[:-1] < reach)
    some = slice(0, top)
    expected[:, :, some, :, some] += np.moveaxis(drawn.image(top), -1, 0)
    expected[:, :, some, :, some] -= (both - full)[:, :, some, :, some]
    for i, j in np.ndindex(layers, layers):
        if max(faces[i] - faces[j + 1], faces[j] - faces[i + 1]) < reach:
            expected[:, :, i, :, j] += np.moveaxis(drawn.pair(i, j), -1, 0) - full[:, :, i, :, j]
    strain = np.random.default_rng(3).standard_normal((3, 6 * layers, 2))
    expected = expected.reshape(3, 6 * layers, -1) @ strain
    for real, rounding in ((np.float64, 1e-12), (np.float32, 1e-6)):
        swept = SweptLayers(drawn, waves, box, error=error, real=real)
        assert np.abs(swept(strain.astype(real)) - expected).max() <= rounding * np.abs(expected).max()
        counts = [run.count for run in swept.runs]
        assert sum(counts) == layers and (faces is not EVEN or len(counts) == 1)


@pytest.mark.parametrize(
    ("faces", "n", "error", "kind"),
    [
        (EVEN, 8, 1e-4, {}),
        (GRADED, 8, 1e-4, {"mirror": (False, True)}),
        (np.arange(19.0) / 2, 8, 1e-4, {"mirror": (True, True), "exchange": True}),
        (np.arange(14.0), 16, 1e-6, {}),
        (np.append(0.0, np.cumsum(0.4 * 1.25 ** np.arange(8))), 16, 1e-6, {}),
    ],
    ids=["even", "graded", "many", "even, small error", "graded, small error"],
)
def test_swept_stress_is_that_of_the_matrices(faces, n, error, kind):
    """To the stated error, without images of the period and with the waves shorter than the cells."""
    box = Cuboids(Lags(n, n, 1.0, 1.0 if "exchange" in kind else ASPECT), tuple(faces), 0.3)
    dense, swept = (BoxOperator(box, 1.0, Counters(), swept=each, **kind) for each in (0.0, error))
    strain = dense.keep(np.random.default_rng(1).standard_normal((6, len(faces) - 1, n, n)))
    if "exchange" in kind:
        strain = strain + strain[[1, 0, 2, 4, 3, 5]].swapaxes(-1, -2)
    expected, found = (on.stress(None, on.response(on.transformed(strain))) for on in (dense, swept))
    assert np.linalg.norm(found - expected) <= error * np.linalg.norm(strain)


def test_stresses_beside_a_large_box_are_those_of_its_coefficients(monkeypatch):
    """In y = 0, at centres: an error of .1 % two cells beside strained ones."""
    depths = tuple(np.linspace(0, 4e-6, 8))
    scene = running_in(cycles=1, steps=1, film=None, wear=None)
    scene = scene.model_copy(update={"grid": scene.grid.model_copy(update={"depths": depths})})
    by_size = sam.solve(scene)
    monkeypatch.setattr("sam.plasticity.box.MOST_BYTES", 0)
    swept = sam.solve(scene)
    box = by_size.discretisation["plastic_box_cells"]
    mises, found = (of_state(each, "plane", "mises_Pa", "unloaded") for each in (by_size, swept))
    assert box == swept.discretisation["plastic_box_cells"] and max(box) < 24
    assert mises.max() > 1e8
    np.testing.assert_allclose(found, mises, rtol=0, atol=1e-3 * mises.max())


def test_stresses_beside_a_box_are_swept_only_where_the_box_is(monkeypatch):
    """Below a sphere x and y are exchanged, and half of the matrices are stored."""
    grid = {"cells": (25, 25), "extent": (30e-6, 30e-6)}
    sphere = scene(body={"plasticity": SWIFT}, grid=grid, loading={"force": 0.3, "steps": 1})
    found = sam.solve(sphere)
    monkeypatch.setattr("sam.plasticity.box.MOST_BYTES", 1.5 * found.discretisation["operator_bytes"])
    monkeypatch.setattr("sam.plasticity.measure._swept_stress", None)
    again = sam.solve(sphere)
    assert max(found.discretisation["plastic_box_cells"]) < 25 and found.quantities["peeq_max"] > 0
    assert again.quantities == found.quantities


# images of a period

CELLS, SIDES = (16, 16), np.array([16.0, 20.0])  # cells of 1 x 1.25
LIKE, UNLIKE = (0.0, 2.0, 4.0, 6.0), (0.5, 0.8, 2.0, 6.0)
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
        (LIKE, 0.3, (32, 32), 1e-4),
        (UNLIKE, 0.5, (32, 24), 1e-4),
        (LIKE, 0.0, (32, 32), 1e-6),
        (UNLIKE, 0.3, (40, 28), 1e-6),
        (UNLIKE, 0.5, (64, 64), 1e-9),
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
