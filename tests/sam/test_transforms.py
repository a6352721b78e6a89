# SPDX-License-Identifier: MIT
"""Operators on the part of a box that symmetry leaves, and on few rows, against those that know of no
symmetry.
"""

import numpy as np
import pytest
from rounding import EPS

from sam.contact.box import BoxContact, ForceControl
from sam.contact.convolution import (
    BoxConvolution,
    Convolution,
    Counters,
    MirroredConvolution,
    RowConvolution,
    Window,
    convolution_onto,
    mirror_half,
    row_sums,
)
from sam.contact.operators import SurfaceOperators
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, parity, stress_coefficients
from sam.plasticity.spectra import EXCHANGED, ODD_X, ODD_Y, BoxOperator

FACES = np.array([0.0, 1.0, 2.0, 3.5])
SIZES = [(9, 11), (8, 11), (9, 10), (8, 10)]
# two transforms of up to 24 x 24 points, 4 EPS for each of 9 levels; a sum over six strains of three layers
ROUNDING = (2 * 4 * 9 + 6 * 3) * EPS


def mirrored_fields(operator, rng):
    """(strain, pressure) on the box, with the symmetry that the operator takes for granted."""
    kept = operator.transforms.shape
    strain = rng.normal(size=(6, operator.layers, *kept))
    for axis, odd in ((2, ODD_X), (3, ODD_Y)):
        if (
            operator.transforms.mirror[axis - 2] and operator.shape[axis - 2] % 2
        ):  # an odd field is zero in the middle
            middle = [slice(None)] * 4
            middle[axis] = 0
            strain[tuple(middle)] *= (1 - odd)[:, None, None]
    return operator.whole(strain), operator.whole(rng.random(kept))


@pytest.mark.parametrize("mirror", [(False, True), (True, True)])
@pytest.mark.parametrize("size", SIZES)
def test_a_mirrored_box_gives_what_the_whole_box_gives(size, mirror):
    """Stress of plastic strain, pressure and (with one mirror) traction, and the surface: to `ROUNDING` of
    the largest value.
    """
    box = Cuboids(Lags(*size, 1.0, 1.1), tuple(FACES), 0.3)
    whole = BoxOperator(box, 1.0, Counters(), sliding=True)
    half = BoxOperator(box, 1.0, Counters(), sliding=True, mirror=mirror)
    strain, pressure = mirrored_fields(half, np.random.default_rng(0))
    traction = None if mirror[0] else 0.3 * pressure
    there, here = whole.transformed(strain), half.transformed(half.keep(strain))
    assert (there.shape[-1], here.shape[-1]) == (4, 1 if mirror[0] else 2)
    stress = whole.stress(pressure, whole.response(there), traction)
    found = half.stress(
        half.keep(pressure), half.response(here), None if traction is None else half.keep(traction)
    )
    assert np.abs(half.whole(found) - stress).max() <= ROUNDING * np.abs(stress).max()
    residual, moved = whole.displacement(there), half.whole(half.displacement(here))
    assert np.abs(moved - residual).max() <= ROUNDING * np.abs(residual).max()


def exchanged(field):
    """A field of components with x and y exchanged."""
    return field[EXCHANGED].swapaxes(-1, -2)


@pytest.mark.parametrize("n", [9, 10])
def test_half_of_the_wave_numbers_gives_all_where_x_and_y_may_be_exchanged(n):
    """The stress that all of them give, to rounding; a strain that is not the same exchanged is noticed."""
    box = Cuboids(Lags(n, n, 0.7, 0.7), tuple(FACES), 0.3)
    whole = BoxOperator(box, 1.0, Counters(), mirror=(True, True))
    half = BoxOperator(box, 1.0, Counters(), mirror=(True, True), exchange=True)
    assert half.memory < 0.6 * whole.memory
    lopsided = mirrored_fields(whole, np.random.default_rng(7))[0]
    for strain, same in ((lopsided + exchanged(lopsided), True), (lopsided, False)):
        expected, found = (
            one.stress(None, one.response(one.transformed(one.keep(strain)))) for one in (whole, half)
        )  # fmt: skip
        assert (np.abs(found - expected).max() <= ROUNDING * np.abs(expected).max()) == same


@pytest.mark.parametrize("size", SIZES)
def test_mirrored_displacements(size):
    """A quarter of the box against all of it, in double and in single precision."""
    kernel = displacement_coefficients(Lags(*size, 1.0, 0.9), nu=0.0)
    whole, quarter = BoxConvolution(kernel, size, Counters()), MirroredConvolution(kernel, size, Counters())
    pressure = np.random.default_rng(2).random(size)
    pressure = pressure + pressure[::-1]
    pressure = pressure + pressure[:, ::-1]
    kept = tuple(mirror_half(n) for n in size)
    expected = whole(pressure)
    for found, bound in ((quarter(pressure[kept]), ROUNDING), (quarter.single(pressure[kept]), 2e-6)):
        assert np.abs(found - expected[kept]).max() <= bound * expected.max()
    assert np.abs(whole.single(1e-200 * pressure) - 1e-200 * expected).max() <= 2e-6 * 1e-200 * expected.max()


def test_a_contact_on_a_quarter_is_that_of_the_box():
    """The same pressure, to the tolerance, whether or not the symmetry of the gap is used."""
    n, load = 33, 40.0
    control, x = ForceControl(load), np.arange(n) - (n - 1) / 2
    gap = (x[:, None] ** 2 + 1.3 * x**2) / 600
    grid, start = SurfaceOperators((n, n), 1.0, Counters()), np.ones((n, n))
    contact = BoxContact(grid, grid.whole)
    quarter, u, _ = contact.solve(gap, control, start, tolerance=1e-10, limit=200)
    whole, v, _ = contact._whole.solve(gap, control, start, tolerance=1e-10, limit=200)
    assert "_quarter" in vars(contact)
    assert np.abs(quarter - whole).max() <= 1e-9 * whole.max() and np.abs(u - v).max() <= 1e-9 * v.max()
    assert np.array_equal(quarter, quarter[::-1]) and quarter.sum() == pytest.approx(load, rel=1e-12)
    aside = BoxContact(grid, grid.whole)
    aside.solve(gap + 1e-9 * x[:, None], control, start, tolerance=1e-6, limit=200)
    assert "_quarter" not in vars(aside)


@pytest.mark.parametrize("rows", [Window(0, 6, 15, 1), Window(2, 5, 11, 2), Window(9, 0, 6, 1)])
def test_sums_over_rows_are_the_convolution(rows):
    """Stress of a pressure and of a traction (odd coefficients in x and in y), on rows inside and beside the
    source.
    """
    source, field = Window(3, 2, 7, 8), np.random.default_rng(4).normal(size=(7, 8))
    lags = Convolution.lags_needed(source, rows)
    for load in (1, 3):
        kernels = stress_coefficients(Lags(*lags, 1.0, 0.8), np.array([0.4, 2.0]), 0.3, load=load)
        signs = [parity(name, load) for name in STRESS for _ in range(2)]
        expected = Convolution(kernels, signs, source, rows)(field)
        found = convolution_onto(kernels, signs, source, rows)
        assert isinstance(found, RowConvolution)
        assert np.abs(found(field) - expected).max() <= 1e-13 * np.abs(expected).max()


@pytest.mark.parametrize("rows", [Window(0, 5, 15, 2), Window(4, 1, 3, 1), Window(0, 11, 2, 1)])
def test_sums_over_kernels_on_few_rows(rows):
    """Kernels of every parity and three depths, on rows inside and beside the source, against transforms in x
    and y.
    """
    source, rng = Window(3, 2, 7, 8), np.random.default_rng(5)
    lags = Convolution.lags_needed(source, rows)
    kernels, fields = rng.normal(size=(6, 6, 3, 4, *lags)), rng.normal(size=(6, 4, 7, 8))
    differ = [np.not_equal.outer(odd, odd) for odd in (ODD_X, ODD_Y)]
    kernels[differ[0], :, :, 0] = kernels[differ[1], :, :, :, 0] = 0.0  # as of an odd function
    signs = [tuple(1 - 2 * int(odd[a, b]) for odd in differ) for a, b in np.ndindex(6, 6) for _ in range(4)]
    odd = np.array([ODD_X, ODD_Y])
    found = row_sums(kernels, fields, source, rows, odd_out=odd, odd_in=odd)
    for depth in range(3):
        expected = Convolution(kernels[:, :, depth], signs, source, rows).summed(fields)
        assert np.abs(found[:, depth] - expected).max() <= 1e-13 * np.abs(expected).max()
    wrong = row_sums(kernels, fields, source, rows, odd_out=odd[:, ::-1], odd_in=odd)
    assert np.abs(wrong[:, 2] - expected).max() > 0.1 * np.abs(expected).max()
