# SPDX-License-Identifier: MIT
"""The contact solver against fields computed anew, its transforms against sums over cells."""

from dataclasses import replace

import numpy as np
import pytest
from rounding import EPS

from sam.contact import convolution, operators
from sam.contact.box import ApproachControl, BoxContact, ForceControl
from sam.contact.convolution import (
    Convolution,
    Counters,
    RowConvolution,
    back,
    convolution_onto,
    forward,
    half_length,
    row_sums,
)
from sam.contact.normal import Search, Solved, Units, around, fit_of, measured, no_contact, solve_contact
from sam.contact.operators import SurfaceOperators, stresses
from sam.grid.cells import CellGrid, Window
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, parity, stress_coefficients
from sam.plasticity.spectra import EXCHANGED, ODD_X, ODD_Y, BoxOperator
from sam.results.history import contact_area
from sam.scene import Status

P0 = 2 / np.pi  # Hertz with a = R = E* = 1: F = 4/3, approach 1


def sphere(n, **options):
    h = 4.0 / n
    x = (np.arange(n) - (n - 1) / 2) * h
    gap0 = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    return solve_contact(gap0, (h, h), 1.0, 4 / 3, search=Search(**options)), gap0, h


def test_area_below_a_punch_and_up_to_the_edge_of_the_grid_is_that_of_the_cells():
    punch = np.where(np.random.default_rng(2).random((9, 7)) < 0.7, 0.0, np.inf)
    for gap0 in (punch, np.zeros((5, 8))):
        contact = solve_contact(gap0, (1.0, 2.0), 1.0, 1.0)
        area = contact_area(contact, CellGrid(*gap0.shape, 1.0, 2.0, np.zeros(1)))
        assert area == pytest.approx(2.0 * (contact.pressure > 0).sum(), rel=1e-14)


def test_the_certificate_describes_the_returned_field():
    contact, gap0, h = sphere(25)
    coefficients = h * 2 * displacement_coefficients(Lags(25, 25, 1.0, 1.0), nu=0.0)  # E* = 1
    i = np.arange(25)
    lag = np.abs(i[:, None] - i[None, :])
    u = np.einsum("ikjm,km->ij", coefficients[lag[:, :, None, None], lag[None, None, :, :]], contact.pressure)
    gap = gap0 + u - contact.approach
    in_contact = contact.pressure > 0
    scale = coefficients[0, 0] * contact.pressure.max()
    assert np.abs(gap[in_contact]).max() < 1e-9 * scale and gap[~in_contact].min() > -1e-9 * scale
    assert np.allclose(gap, contact.gap, rtol=0, atol=1e-12)
    assert np.allclose(u, contact.displacement, rtol=0, atol=1e-12)
    assert contact.pressure.sum() * h * h == pytest.approx(4 / 3, rel=1e-12)
    assert contact.converged and contact.tension == 0.0 and contact.load_error < 1e-12


def test_converged_within_twice_the_tolerance():
    """A gap of 1e-9 in the one cell that touches unevenly, over the displacement of its pressure."""
    grid = SurfaceOperators((4, 4), 1.0, Counters())
    p, u = np.zeros((4, 4)), np.zeros((4, 4))
    p[1, 1:3], u[1, 2] = 0.5, 2e-9
    gap0 = np.where(p > 0, 0.0, 1.0)
    expected = 1e-9 / (grid.self_influence * 0.5)  # of the two cells each lies 1e-9 off their mean
    fields = Solved(p, u, grid.whole, 1)
    for share, converged in ((1.9995, True), (2.0005, False)):
        found = measured(grid, gap0, fields, Units(1.0, 1.0, 2.0), given=1.0, tolerance=expected / share)
        assert found.gap_residual == pytest.approx(expected, rel=1e-9, abs=0.0) and found.penetration == 0.0
        assert found.converged == converged
    other = measured(grid, gap0, fields, Units(2.0, 3.0, 10.0), given=30.0, tolerance=1.0)
    assert other.load_error == pytest.approx(0.0, abs=1e-15)
    assert found.approach == pytest.approx(1e-9, rel=1e-9, abs=0.0)


def test_traction_acts_along_x_unless_said_otherwise():
    """As summed with the sign 1; half of both signs' sum is that without a traction."""
    grid = SurfaceOperators((5, 4), 1.0, Counters(), coupling=0.4)
    p = np.arange(20.0).reshape(5, 4)
    along, against = (grid.displacement(p, grid.whole, grid.whole, sign) for sign in (1.0, -1.0))
    assert grid.displacement(p, grid.whole, grid.whole) == pytest.approx(along, rel=1e-12)
    alone = SurfaceOperators((5, 4), 1.0, Counters()).displacement(p, grid.whole, grid.whole)
    assert (along + against) / 2 == pytest.approx(alone, rel=1e-12) and np.abs(along - against).max() > 0.1


def test_the_box_does_not_change_the_answer():
    """A start on the wrong cells makes a box that is too small; the check on the full grid lets it grow."""
    right, gap0, _ = sphere(97)
    start = np.zeros_like(gap0)
    start[10:13, 50:53] = 1.0
    other, _, _ = sphere(97, start=start)
    assert other.converged and np.abs(other.pressure - right.pressure).max() < 1e-8 * P0
    assert right.box.nx < 97  # and the box did leave cells out
    cells = np.zeros((20, 30), dtype=bool)
    cells[0, 29] = True
    assert around(cells) == Window(0, 26, 4, 4)  # stays on the grid


def test_a_contact_moves_with_its_gap():
    """By whole cells, on a wider grid: to 1e-9, as residuals of 1e-11 are amplified tenfold."""
    k = np.hypot(np.fft.fftfreq(20)[:, None], np.fft.rfftfreq(16))
    spectrum = np.fft.rfft2(np.random.default_rng(1).normal(size=(20, 16)))
    waves, found = np.fft.irfft2(np.where(k <= 0.25, spectrum, 0.0), (20, 16)), []
    for i, j in ((0, 12), (7, 0)):
        room, window = np.full((27, 28), np.inf), np.s_[i : i + 20, j : j + 16]
        room[window] = 0.05e-6 * waves / np.abs(waves).max()
        found.append(solve_contact(room, (1e-6, 1e-6), 2e11, 0.02, search=Search(1e-11)).pressure[window])
    assert np.abs(found[0] - found[1]).max() <= 1e-9 * found[1].max()


def test_a_given_approach_starts_from_the_overlap_where_no_start_fits():
    """The number that fits the displacement of a start, here twice its pressure, best to the overlap."""
    control, gap0 = ApproachControl(1.0), np.array([[0.0, 3.0]])
    for start, expected in (([[4.0, 1.0]], [[4 / 17, 1 / 17]]), ([[0.0, 1.0]], [[0.5, 0.0]])):
        p, u = control.begun(np.array(start), gap0, 1.0, lambda p: 2 * p)
        assert p == pytest.approx(np.array(expected), rel=1e-12) and np.array_equal(u, 2 * p)


def test_the_work_of_a_contact_is_budgeted():
    """Counted, not timed: of a sphere 142 transforms and 44 displacements, from coarser grids."""
    counters = Counters()
    contact, _, _ = sphere(129, tolerance=1e-8, counters=counters)
    assert counters.ffts <= 150 and counters.displacement_applications <= 47
    assert counters.contact_iterations >= contact.iterations > 0


@pytest.mark.parametrize(
    "name, args",
    [
        ("hx", (np.zeros((8, 8)), (0.0, 1.0), 1.0, 1.0)),
        ("hy", (np.zeros((8, 8)), (1.0, -1.0), 1.0, 1.0)),
        ("modulus", (np.zeros((8, 8)), (1.0, 1.0), np.nan, 1.0)),
        ("force", (np.zeros((8, 8)), (1.0, 1.0), 1.0, np.inf)),
        ("gap0", (np.full((8, 8), np.nan), (1.0, 1.0), 1.0, 1.0)),
        ("gap0", (np.full((8, 8), np.inf), (1.0, 1.0), 1.0, 1.0)),
    ],
)
def test_bad_arguments_are_refused_by_name(name, args):
    with pytest.raises(ValueError, match=name):
        solve_contact(*args)


def test_what_is_not_converged_is_not_called_so():
    """Out of iterations, and at a tolerance below rounding: the best of a double, honestly named."""
    contact, _, _ = sphere(129, max_iterations=2)
    assert not contact.converged and contact.residual > 1e-10
    contact, _, _ = sphere(65, tolerance=1e-18)
    # BLAS with other sums goes on for all of the thousand iterations, each of which rounds by some 1e-15
    assert not contact.converged and contact.residual < 1e-11
    assert contact.pressure.max() == pytest.approx(P0, rel=5e-4)


@pytest.mark.parametrize("width, enough", [(5, False), (6, True)])
def test_six_cells_across_resolve_a_contact(width, enough):
    """Three in the radius, to the letter. Without force there is no contact."""
    contact = no_contact(np.array([[2.0, 1.0], [3.0, 1.5]]))
    assert contact.approach == 1.0 and contact.pressure.sum() == 0.0 and contact.gap.min() == 0.0
    pressure = np.zeros((12, 12))
    pressure[3 : 3 + width, 3:10] = 1.0
    status = fit_of(replace(no_contact(np.zeros((12, 12))), pressure=pressure))
    assert status is (Status.CONVERGED if enough else Status.UNDER_RESOLVED)


# sums over cells


def direct_sum(kernel, signs, field, source, observed):
    out = np.zeros(observed.shape)
    for i, j in np.ndindex(*observed.shape):
        for k, m in np.ndindex(*source.shape):
            lx, ly = observed.i0 + i - source.i0 - k, observed.j0 + j - source.j0 - m
            sign = (signs[0] if lx < 0 else 1) * (signs[1] if ly < 0 else 1)
            out[i, j] += sign * kernel[abs(lx), abs(ly)] * field[k, m]
    return out


@pytest.mark.parametrize(
    "source, observed",
    [
        (Window(0, 0, 6, 5), Window(0, 0, 6, 5)),
        (Window(3, 2, 4, 5), Window(0, 0, 8, 9)),
        (Window(2, 1, 5, 6), Window(0, 4, 12, 1)),
        (Window(0, 0, 3, 2), Window(10, 7, 2, 4)),
        (Window(5, 5, 1, 1), Window(5, 5, 1, 1)),
    ],
    ids=["same window", "box seen from the grid", "one row", "apart", "one cell"],
)
def test_equals_the_direct_sum(source, observed):
    """Rounding only: 1e-12 of the largest value, for kernels of every parity. Transforms are counted."""
    field, counters = np.random.default_rng(3).standard_normal(source.shape), Counters()
    lags = Convolution.lags_needed(source, observed)
    for load in (1, 2, 3):
        kernels = stress_coefficients(Lags(*lags, 1.0, 0.7), 0.4, 0.3, load=load)[:, 0]
        signs = [parity(component, load) for component in STRESS]
        fast = Convolution(kernels, signs, source, observed, counters=counters)(field)
        assert counters.ffts == load * (6 + 1 + 6)
        for k in range(6):
            slow = direct_sum(kernels[k], signs[k], field, source, observed)
            assert np.abs(fast[k] - slow).max() <= 1e-12 * np.abs(kernels).max() * np.abs(field).sum()


def test_stresses_are_sums_of_coefficients_over_cells():
    rng, window, depths = np.random.default_rng(6), Window(0, 0, 5, 4), np.array([0.0, 0.7, 2.0])
    loads = {3: rng.normal(size=(5, 4)), 1: rng.normal(size=(5, 4))}
    found = stresses(loads, (2.0, 1.5), depths, window, nu=0.3)
    expected = np.zeros_like(found)
    for load, field in loads.items():
        kernels = stress_coefficients(Lags(5, 4, 2.0, 1.5), depths, 0.3, load=load)
        for k, n in np.ndindex(6, 3):
            expected[k, n] += direct_sum(kernels[k, n], parity(STRESS[k], load), field, window, window)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("rows", [Window(0, 6, 15, 1), Window(2, 5, 11, 2), Window(9, 0, 6, 1)])
def test_sums_over_rows_are_the_convolution(rows):
    """Stress of a pressure and of a traction, and kernels of every parity, on rows inside and beside."""
    source, rng = Window(3, 2, 7, 8), np.random.default_rng(4)
    field, lags = rng.normal(size=(7, 8)), Convolution.lags_needed(source, rows)
    for load in (1, 3):
        kernels = stress_coefficients(Lags(*lags, 1.0, 0.8), np.array([0.4, 2.0]), 0.3, load=load)
        signs = [parity(name, load) for name in STRESS for _ in range(2)]
        expected = Convolution(kernels, signs, source, rows)(field)
        found = convolution_onto(kernels, signs, source, rows)
        assert isinstance(found, RowConvolution)
        assert np.abs(found(field) - expected).max() <= 1e-13 * np.abs(expected).max()
    kernels, fields = rng.normal(size=(6, 6, 3, 4, *lags)), rng.normal(size=(6, 4, 7, 8))
    differ = [np.not_equal.outer(odd, odd) for odd in (ODD_X, ODD_Y)]
    kernels[differ[0], :, :, 0] = kernels[differ[1], :, :, :, 0] = 0.0  # as of an odd function
    signs = [tuple(1 - 2 * int(odd[a, b]) for odd in differ) for a, b in np.ndindex(6, 6) for _ in range(4)]
    odd = np.array([ODD_X, ODD_Y])
    found = row_sums(kernels, fields, source, rows, odd_out=odd, odd_in=odd)
    for depth in range(3):
        expected = Convolution(kernels[:, :, depth], signs, source, rows).summed(fields)
        assert np.abs(found[:, depth] - expected).max() <= 1e-13 * np.abs(expected).max()


# on the part of a box that symmetry leaves

FACES = (0.0, 1.0, 2.0, 3.5)
SIZES = [(9, 11), (8, 11), (8, 10)]
# two transforms of up to 24 x 24 points, 4 EPS for each of 9 levels; a sum over six strains of three layers
ROUNDING = (2 * 4 * 9 + 6 * 3) * EPS


def mirrored_fields(operator, rng):
    """(strain, pressure) on the box, with the symmetry that the operator takes for granted."""
    kept = operator.transforms.shape
    strain = rng.normal(size=(6, operator.layers, *kept))
    for axis, odd in ((2, ODD_X), (3, ODD_Y)):  # an odd field is zero in the middle
        if operator.transforms.mirror[axis - 2] and operator.shape[axis - 2] % 2:
            middle = [slice(None)] * 4
            middle[axis] = 0
            strain[tuple(middle)] *= (1 - odd)[:, None, None]
    return operator.whole(strain), operator.whole(rng.random(kept))


@pytest.mark.parametrize("mirror", [(False, True), (True, True)])
@pytest.mark.parametrize("size", SIZES)
def test_a_mirrored_box_gives_what_the_whole_box_gives(size, mirror):
    """Stress of strain, pressure and (with one mirror) traction, and the surface, to `ROUNDING`."""
    box = Cuboids(Lags(*size, 1.0, 1.1), FACES, 0.3)
    whole = BoxOperator(box, 1.0, Counters())
    half = BoxOperator(box, 1.0, Counters(), mirror=mirror)
    strain, pressure = mirrored_fields(half, np.random.default_rng(0))
    traction = None if mirror[0] else 0.3 * pressure
    there, here = whole.transformed(strain), half.transformed(half.keep(strain))
    assert (there.columns.shape[-1], here.columns.shape[-1]) == (4, 1 if mirror[0] else 2)
    stress = whole.stress(pressure, whole.response(there), traction)
    kept = None if traction is None else half.keep(traction)
    found = half.stress(half.keep(pressure), half.response(here), kept)
    assert np.abs(half.whole(found) - stress).max() <= ROUNDING * np.abs(stress).max()
    residual, moved = whole.displacement(there), half.whole(half.displacement(here))
    assert np.abs(moved - residual).max() <= ROUNDING * np.abs(residual).max()


@pytest.mark.parametrize("n", [9, 10])
def test_half_of_the_wave_numbers_gives_all_where_x_and_y_may_be_exchanged(n):
    """The stress that all of them give, to rounding; a strain that is not the same exchanged is noticed."""
    box = Cuboids(Lags(n, n, 0.7, 0.7), FACES, 0.3)
    whole = BoxOperator(box, 1.0, Counters(), mirror=(True, True))
    half = BoxOperator(box, 1.0, Counters(), mirror=(True, True), exchange=True)
    assert half.memory < 0.6 * whole.memory
    lopsided = mirrored_fields(whole, np.random.default_rng(7))[0]
    even = lopsided + lopsided[EXCHANGED].swapaxes(-1, -2)
    for strain, same in ((even, True), (lopsided, False)):
        stresses = (
            one.stress(None, one.response(one.transformed(one.keep(strain)))) for one in (whole, half)
        )
        expected, found = stresses
        assert (np.abs(found - expected).max() <= ROUNDING * np.abs(expected).max()) == same


def test_the_preconditioner_of_few_cells_is_that_by_transforms(monkeypatch):
    """On a box of unequal sides with rectangular cells, in single precision."""
    grid, r = SurfaceOperators((9, 12), 0.8, Counters()), np.random.default_rng(3).standard_normal((9, 12))
    few = grid.preconditioner(grid.whole, False)(r)
    monkeypatch.setattr(operators, "FEW_CELLS", 0)
    expected = grid.preconditioner(grid.whole, False)(r)
    np.testing.assert_allclose(few, expected, rtol=0, atol=2e-6 * abs(expected).max())


def test_a_contact_on_a_quarter_is_that_of_the_box():
    """The same pressure, to the tolerance, whether or not the symmetry of the gap is used, in any unit."""
    n, load = 33, 40.0
    control, x = ForceControl(load), np.arange(n) - (n - 1) / 2
    gap = (x[:, None] ** 2 + 1.3 * x**2) / 600
    grid, start = SurfaceOperators((n, n), 1.0, Counters()), np.ones((n, n))
    contact = BoxContact(grid, grid.whole)
    quarter, u, _ = contact.solve(gap, control, start, tolerance=1e-10, limit=200)
    whole, v, _ = contact._whole.solve(gap, control, start, tolerance=1e-10, limit=200)
    assert "_quarter" in vars(contact)
    assert np.abs(quarter - whole).max() <= 1e-9 * whole.max() and np.abs(u - v).max() <= 1e-9 * v.max()
    for iteration in (contact, contact._whole):
        tiny, *_ = iteration.solve(
            1e-200 * gap, ForceControl(1e-200 * load), start, tolerance=1e-10, limit=200
        )
        assert np.abs(1e200 * tiny - whole).max() <= 1e-9 * whole.max()
    assert np.array_equal(quarter, quarter[::-1]) and quarter.sum() == pytest.approx(load, rel=1e-12)
    aside = BoxContact(grid, grid.whole)
    aside.solve(gap + 1e-9 * x[:, None], control, start, tolerance=1e-6, limit=200)
    assert "_quarter" not in vars(aside)


def test_passes_with_a_traction_end_at_their_limit(monkeypatch):
    """Short of the tolerance, with the displacement of the last pressure and its traction."""
    monkeypatch.setattr("sam.contact.box.PASSES", 2)
    x, grid = np.arange(9) - 4.0, SurfaceOperators((9, 9), 1.0, Counters(), coupling=0.4)
    contact, gap = BoxContact(grid, grid.whole), (x[:, None] ** 2 + x**2) / 600
    p, u, _ = contact.solve(gap, ForceControl(1.0), np.full((9, 9), 1 / 81), tolerance=1e-12, limit=1000)
    assert len(contact.residuals) == 2 and contact.residuals[-1] > 1e-12
    moved = contact._whole.displacement(p) + grid.tangential(grid.whole, grid.whole)(p)
    assert np.abs(u - moved).max() < 1e-12 * u.max() and p.sum() == pytest.approx(1.0, rel=1e-12)


def summed(kept: np.ndarray, half: int, odd: bool, between: bool) -> np.ndarray:
    """The 2 half values written out from the kept ones (..., n), their Fourier sum, times i^odd and real."""
    place = np.arange(half if between else half + 1)[: kept.shape[-1]] + 0.5 * between
    kept = kept[..., : len(place)].astype(float)
    total = np.zeros((*kept.shape[:-1], half + 1), dtype=complex)
    for j, value in zip(place, np.moveaxis(kept, -1, 0), strict=True):
        for sign in (1, -1):
            if sign == -1 and j in (0, half):  # its own mirror image
                continue
            wave = np.exp(-1j * np.pi * sign * j * np.arange(half + 1) / half)
            total += (sign if odd else 1) * value[..., None] * wave
    return (1j * total if odd else total).real


BY_BOTH = pytest.mark.parametrize("short", [0, 10**4], ids=["transforms", "products"])


@BY_BOTH
@pytest.mark.parametrize("odd", [False, True])
@pytest.mark.parametrize("between", [False, True])
@pytest.mark.parametrize("n, half", [(1, 3), (6, 6), (9, 6), (40, 45)])
def test_forward_is_the_fourier_sum(monkeypatch, odd, between, n, half, short):
    """1e-13: the sums beside it turn by up to 40 pi, 126 roundings a term, and add 40 terms."""
    monkeypatch.setattr(convolution, "SHORT", short)
    kept = np.random.default_rng(n).standard_normal((2, n, n))
    if odd and not between:
        kept[:, 0], kept[:, :, 0] = 0, 0  # what an odd row has in its middle
    expected = summed(kept, half, odd, between)
    bound = 1e-13 * max(np.abs(expected).max(), 1)
    assert np.abs(forward(kept, half, odd, -1, between=between) - expected).max() <= bound
    across = np.moveaxis(forward(kept.swapaxes(-1, -2), half, odd, -2, between=between), -2, -1)
    assert np.abs(across - expected).max() <= bound


@BY_BOTH
@pytest.mark.parametrize("odd", [False, True])
@pytest.mark.parametrize("n", [1, 2, 9, 10])
def test_back_is_the_inverse(monkeypatch, odd, n, short):
    """From the middle of a row outward, but for what an odd one has there. Two sums, of the values and of
    their transforms, neither larger than twice the sum of the moduli.
    """
    monkeypatch.setattr(convolution, "SHORT", short)
    half, kept, between = half_length(n) + 3, n - n // 2, n % 2 == 0
    field = np.random.default_rng(6).normal(size=(3, kept, kept))
    for axis in (-1, -2):
        again = back(forward(field, half, odd, axis, between=between), kept, odd, axis, between=between)
        same = np.moveaxis(np.abs(again - field), axis, 0)[1 if odd and not between else 0 :]
        assert not same.size or same.max() <= 2 * (kept + half) * EPS * np.abs(field).sum(axis).max()
    single = forward(field.astype(np.float32), half, odd, -1, between=between)
    assert single.dtype == back(single, kept, odd, -1, between=between).dtype == np.float32
