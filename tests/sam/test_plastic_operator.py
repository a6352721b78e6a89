# SPDX-License-Identifier: MIT
"""The operators of the plastic box against direct sums, and the cell means that they are made of against
quadrature.
"""

import numpy as np
import pytest

from sam.contact.convolution import Counters
from sam.grid.cells import Window
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.layer_stress import LayerStress, residual_stress_coefficients
from sam.kernels.patches import STRESS, Cuboids, Lags, parity, stress_coefficients
from sam.plasticity.measure import Strained, residual_stress, surface_displacement
from sam.plasticity.spectra import BoxOperator, CellMeans, _points, mean_stress_of_load

NX, NY, ASPECT, NU, MU = 7, 6, 0.8, 0.3, 2.5
FACES = np.array([0.0, 0.4, 1.0, 1.7, 3.0])  # uneven layers
LAYERS = len(FACES) - 1
BOX = Cuboids(Lags(NX, NY, 1.0, ASPECT), tuple(FACES), NU)
NAMES = dict(enumerate(STRESS))


def signs(i, j=None):
    a, b = parity(NAMES[i], 3), parity(NAMES[j], 3) if j is not None else (1, 1)
    return a[0] * b[0], a[1] * b[1]


def mean_stress(nx, ny, aspect, faces):
    """Of each layer in turn, the mean over its cells: (6, 6, n_layers, nx, ny)."""
    layers = LayerStress(CellMeans(Lags(nx, ny, 1.0, aspect)), _points(faces), faces, NU)
    for layer in range(len(faces) - 1):
        out = np.empty((36, len(faces) - 1, nx, ny))
        layers.of(layer, out)
        yield out.reshape(6, 6, *out.shape[1:])


def direct_sum(kernel, sign, field):
    """Sum over the source cells of one layer, with the sign of the lag."""
    lx = np.arange(NX)[:, None] - np.arange(NX)
    ly = np.arange(NY)[:, None] - np.arange(NY)
    matrix = kernel[np.abs(lx)[:, :, None, None], np.abs(ly)[None, None]]
    matrix = (
        matrix * np.where(lx < 0, sign[0], 1)[:, :, None, None] * np.where(ly < 0, sign[1], 1)[None, None]
    )
    return np.einsum("ikjm,km->ij", matrix, field)


def test_equals_direct_summation_on_uneven_layers():
    """Residual and elastic stress, and the surface: 1e-12 of the largest value (measured 5e-16)."""
    rng = np.random.default_rng(0)
    strain, pressure = rng.standard_normal((6, LAYERS, NX, NY)), rng.standard_normal((NX, NY))
    operator = BoxOperator(BOX, MU, Counters())
    transformed = operator.transformed(strain)
    found = operator.stress(pressure, operator.response(transformed))
    from_pressure = mean_stress_of_load(BOX)
    expected = np.zeros_like(strain)
    for layer, kernel in enumerate(mean_stress(NX, NY, ASPECT, FACES)):
        for i in range(6):
            expected[i, layer] = direct_sum(from_pressure[i, layer], signs(i), pressure)
            for j in range(6):
                for source in range(LAYERS):
                    expected[i, layer] += MU * direct_sum(
                        kernel[i, j, source], signs(i, j), strain[j, source]
                    )
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    kernel = surface_displacement_coefficients(Cuboids(Lags(NX, NY, 1.0, ASPECT), tuple(FACES), NU))
    residual = sum(direct_sum(kernel[j, k], signs(j), strain[j, k]) for j in range(6) for k in range(LAYERS))
    assert np.abs(operator.displacement(transformed) - residual).max() <= 1e-12 * np.abs(residual).max()


def test_cell_means_are_means():
    """Against 6 x 6 x 6 Gauss points over the observed cell.

    Next to the source its edges make the field logarithmic: two points a direction leave 5 % there (which
    moves the largest plastic strain of a contact by less than 1e-4). Beyond the near field second differences
    are used: 1e-3 of the value.
    """
    layer, points = 1, np.polynomial.legendre.leggauss(6)
    t, w = points[0] / 2, points[1] / 2
    depths = 0.7 + 0.6 * t
    mean = 0.0
    for a, wa in zip(t, w, strict=True):
        for b, wb in zip(t, w, strict=True):
            at = residual_stress_coefficients(
                Cuboids(Lags(9, 8, 1.0, ASPECT), tuple(FACES), NU), depths, off=(a, ASPECT * b)
            )
            mean = mean + wa * wb * np.tensordot(at, w, axes=(2, 0))
    found = list(mean_stress(9, 8, ASPECT, FACES))[layer]
    assert np.abs(found - mean).max() < 0.05 * np.abs(mean[..., 0, 0]).max()
    far = (slice(None), slice(None), slice(None), slice(5, None), slice(5, None))
    assert np.abs((found - mean)[far]).max() < 1e-3 * np.abs(mean[far]).max()


def test_equal_layers_share_what_each_pair_alone_gives():
    """Six equal layers below two thin ones: 1e-13 of the largest value, from a third of the sums; red without
    a power of d.
    """
    faces = np.concatenate([[0.0, 0.3], 0.7 + np.arange(7.0)])
    shared = np.array(list(mean_stress(5, 4, ASPECT, faces)))
    alone = np.empty_like(shared)
    for i, point in enumerate(_points(faces)):
        for j in range(len(faces) - 1):
            pair = LayerStress(CellMeans(Lags(5, 4, 1.0, ASPECT)), point[None], faces[j : j + 2], NU)
            pair.of(0, alone[i, :, :, j].reshape(36, 1, 5, 4))
    assert np.abs(shared - alone).max() < 1e-13 * np.abs(alone).max()
    layers = LayerStress(CellMeans(Lags(5, 4, 1.0, ASPECT)), _points(faces), faces, NU)
    assert len(layers.image.first) == 2 * 6 - 1 + 8 * 8 - 6 * 6
    assert len(layers.full.first) == 6 + 8 * 8 - 6 * 6
    for power in range(3):
        layers = LayerStress(CellMeans(Lags(5, 4, 1.0, ASPECT)), _points(faces), faces, NU)
        make = layers.image.make

        def spoilt(first, offsets, is_shared, make=make, power=power):
            sums = make(first, offsets, is_shared)
            sums[:, power:][:, :1] *= 1 - 1e-6
            return sums

        layers.image.make = spoilt
        for i in range(len(shared)):
            layers.of(i, alone[i].reshape(36, 8, 5, 4))
        assert np.abs(shared - alone).max() > 1e-10 * np.abs(shared).max(), power


def test_mean_stress_of_a_box_is_nearly_symmetric_and_negative():
    """Betti: cell means make a symmetric operator, and any plastic strain stores energy, a checkerboard too.

    With the stress at cell centres instead, a checkerboard along z and x releases energy: the reason for the
    means.
    """
    n = 4
    faces = np.arange(n + 1.0)

    def energy(mean: bool) -> float:
        strain = np.zeros((6, n, n, n))
        k, i, j = np.indices((n, n, n))
        sign = (-1.0) ** (i + j + k)
        for component, value in ((0, 0.5), (1, 0.5), (2, -1.0)):
            strain[component] = sign * value
        total = 0.0
        at_centres = np.moveaxis(
            residual_stress_coefficients(Cuboids(Lags(n, n, 1.0, 1.0), tuple(faces), NU), faces[:-1] + 0.5),
            2,
            0,
        )
        for layer, kernel in enumerate(mean_stress(n, n, 1.0, faces) if mean else at_centres):
            lx = np.abs(np.arange(n)[:, None] - np.arange(n))
            for a in range(3):
                for b in range(3):
                    block = kernel[a, b][:, lx[:, :, None, None], lx[None, None]]
                    total -= np.einsum("kisjm,ksm,ij->", block, strain[b], strain[a, layer])
        return total

    assert energy(mean=True) > 0 and energy(mean=True) > 2 * energy(mean=False)


def test_fields_outside_the_box_continue_those_inside():
    """Stress at cell centres and surface of the general routine: direct sums of the same coefficients."""
    strain = np.random.default_rng(2).standard_normal((6, LAYERS, NX, NY))
    box, row = Window(4, 3, NX, NY), Window(0, 5, 15, 1)
    depths = np.array([0.2, 2.0, 4.5])
    source = Strained(strain, box, BOX)
    found = residual_stress(source, depths, row, mu=MU)
    residual = surface_displacement(source, row, counters=Counters())
    kernel = residual_stress_coefficients(Cuboids(Lags(15, 15, 1.0, ASPECT), tuple(FACES), NU), depths)
    surface = surface_displacement_coefficients(Cuboids(Lags(15, 15, 1.0, ASPECT), tuple(FACES), NU))
    for x in (0, 6, 14):
        lags = [(x - 4 - i, 5 - 3 - j, i, j) for i in range(NX) for j in range(NY)]
        stress, uz = np.zeros((6, 3)), 0.0
        for lx, ly, i, j in lags:
            for b in range(6):
                sx, sy = signs(b)
                sign = (sx if lx < 0 else 1) * (sy if ly < 0 else 1)
                uz += sign * surface[b, :, abs(lx), abs(ly)] @ strain[b, :, i, j]
                for a in range(6):
                    sx, sy = signs(a, b)
                    sign = (sx if lx < 0 else 1) * (sy if ly < 0 else 1)
                    stress[a] += MU * sign * kernel[a, b, :, :, abs(lx), abs(ly)] @ strain[b, :, i, j]
        assert np.abs(found[:, :, x, 0] - stress).max() <= 1e-11 * np.abs(found).max()
        assert residual[x, 0] == pytest.approx(uz, rel=1e-10)


def test_pressure_alone_is_the_elastic_stress():
    """Far below, where the mean over a cell is its centre, the box agrees with the coefficients of the
    surface load.
    """
    faces = np.array([0.0, 30.0, 31.0])
    operator = BoxOperator(Cuboids(Lags(5, 5, 1.0, 1.0), tuple(faces), NU), MU, Counters())
    pressure = np.zeros((5, 5))
    pressure[0, 0] = 1.0
    found = operator.stress(pressure)[:, 1]
    expected = stress_coefficients(Lags(5, 5, 1.0, 1.0), 30.5, NU)[:, 0]
    assert np.abs(found - expected).max() < 2e-3 * np.abs(expected).max()


def test_boxes_of_equal_cells_share_their_coefficients():
    """Cached by content: other units, the same spectra; another layer, others."""

    def of(cell: float, faces: int, mu: float) -> BoxOperator:
        return BoxOperator(
            Cuboids(Lags(4, 4, cell, cell), tuple(cell * np.arange(faces)), NU), mu, Counters()
        )

    first, again, other = of(1e-6, 4, 1e9), of(3.7, 4, 1.0), of(3.7, 5, 1.0)
    assert first.spectra is again.spectra
    assert other.spectra is not again.spectra
