# SPDX-License-Identifier: MIT
"""Worn depth, smoothing, remap and bookkeeping against closed forms, exact weights, other filters and brute
force.
"""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from rounding import EPS, close, of_least_squares
from scipy.signal import savgol_filter

from sam.scene import Wear
from sam.wear import StrainLimits, WearLaw, filtered, limit_by_depth, remapped, smoothed, weights, worn_depth

UM = 1e-6
GRADED = UM * np.concatenate([[0.0], np.cumsum(0.1 * 1.25 ** np.arange(14))])
LIMIT = StrainLimits(0.002, 0.002, 0.0)


def column(*values):
    """alpha of one column, (n_layers, 1, 1)."""
    return np.array(values, dtype=float)[:, None, None]


def removed(alpha, faces, limits, interpolate=True):
    """(depth, roofed, at_bottom) of one column."""
    found = worn_depth(column(*alpha), np.array(faces, dtype=float), limits, interpolate)
    return tuple(part[0, 0] for part in found)


def grid(n):
    x = np.arange(n) - (n - 1) / 2
    return np.meshgrid(x, x, indexing="ij")


def paraboloid(n, radius):
    """Depth 1 - r^2/radius^2 of a scar on n x n cells; negative outside."""
    x, y = grid(n)
    return 1 - (x**2 + y**2) / radius**2


def exponential(depth, faces, scale, limit):
    """Means over the layers of limit exp((depth - z)/scale), which crosses its limit at z = depth."""
    factor = -scale * np.diff(np.exp(-faces / scale)) / np.diff(faces)
    return limit * np.exp(depth / scale) * factor[:, None, None]


# limits


def test_limits_of_a_scene():
    both = limit_by_depth(Wear(strain_limit=0.002, strain_limit_layer=0.02), 0.5 * UM)
    assert both(np.array([0.0, 0.4999, 0.5, 3.0]) * UM).tolist() == [0.02, 0.02, 0.002, 0.002]
    one = limit_by_depth(Wear(strain_limit=0.002), 0.5 * UM)
    assert one(np.array([0.0, UM])).tolist() == [0.002, 0.002]
    assert np.isinf(limit_by_depth(Wear(strain_limit=math.inf), None)(0.0))


@pytest.mark.parametrize("interpolate", [True, False])
@pytest.mark.filterwarnings("error")
def test_nothing_tears_at_an_infinite_limit(interpolate):
    alpha = np.full((14, 3, 4), 1000.0)  # the largest strain that a scene may name
    found = worn_depth(alpha, GRADED, StrainLimits(math.inf, math.inf, 0.0), interpolate)
    assert not found.depth.any() and not found.roofed.any() and not found.at_bottom.any()
    found = worn_depth(alpha, GRADED, StrainLimits(math.inf, 0.02, GRADED[3]), interpolate)
    assert found.depth == close(GRADED[3], 4 * EPS) and not found.roofed.any()


# worn depth


def errors_of_depth(interpolate, layers):
    """Mean error of the depth of a paraboloid scar (depth 1, layers down to 2), and of its volume."""
    exact = paraboloid(41, 17.3)
    faces = np.linspace(0, 2, layers + 1)
    found = worn_depth(exponential(exact, faces, 0.8, 0.002), faces, LIMIT, interpolate).depth
    exact = np.maximum(exact, 0)
    return np.abs(found - exact).mean(), abs(found.sum() - exact.sum()) / exact.sum()


def test_interpolated_depth_is_of_second_order_and_whole_layers_of_first():
    """Orders from 20 to 160 layers; asymptotic within 0.15 (measured 1.99 and 1.02)."""
    for interpolate, order in ((True, 2), (False, 1)):
        coarse, fine = (errors_of_depth(interpolate, n)[0] for n in (20, 160))
        assert math.log(coarse / fine, 8) == pytest.approx(order, abs=0.15)
    assert errors_of_depth(True, 160)[0] < errors_of_depth(False, 160)[0] / 20


def test_linear_strain_is_found_exactly():
    """alpha = 0.01 - 0.004 z on uneven layers: 0.002 at z = 2; the surface is extrapolated.

    1e-14: ten roundings of strains of 0.01, over the slope. 4 EPS: three roundings and those of the two
    strains.
    """
    faces = np.array([0, 0.3, 1, 1.5, 2.4, 4])
    alpha = 0.01 - 0.004 * (faces[1:] + faces[:-1]) / 2
    assert removed(alpha, faces, LIMIT) == pytest.approx((2, 0, False), abs=1e-14)
    assert removed(alpha, faces, StrainLimits(0.0098, 0.0098, 0)) == pytest.approx(
        (0.05, 0, False), abs=1e-14
    )
    assert removed(alpha, faces, StrainLimits(0.01 * (1 + 4 * EPS), 1, 0))[0] == 0  # not even at the surface
    assert removed(alpha, faces, LIMIT, False)[0] == 2.4  # the mean of 1.5 ... 2.4 is 0.0022
    assert removed(alpha, faces, StrainLimits(0.0023, 0.0023, 0), False)[0] == 1.5


def test_strain_at_the_surface_is_not_negative():
    """0 and 1 at the centres 0.5 and 1.5, 1 and 4 as well, extrapolate to -0.5: sound as 0 is, and so is what
    lies next.
    """
    limits = StrainLimits(0.25, 0.25, 0)
    assert removed([0, 1, 0, 0], range(5), limits)[:2] == (0, pytest.approx(1.5))
    assert removed([1, 4, 0, 0], range(5), limits)[:2] == (
        0,
        pytest.approx(0.375 + 1 + 0.9375),
    )  # from 0 to 1 over 0.5
    assert removed([0.3], [0, 2], limits) == (2, 0, True)  # a single layer is constant


def test_limit_of_the_layer_is_met_exactly_at_its_border():
    """alpha = 0.01 everywhere, the layer ends at 0.7, inside of a layer of cells. 4 EPS: a sum of at most six
    lengths.
    """
    faces, alpha = [0, 0.5, 1, 2, 4], [0.01] * 4
    assert removed(alpha, faces, StrainLimits(0.02, 0.005, 0.7)) == (close(0.7, 4 * EPS), 0, False)
    assert removed(alpha, faces, StrainLimits(0.005, 0.02, 0.7)) == (0, close(3.3, 4 * EPS), False)
    assert removed(alpha, faces, StrainLimits(0.005, 0.008, 0.7)) == (close(4, 4 * EPS), 0, True)
    assert removed(alpha, faces, StrainLimits(0.02, 0.005, 9.0)) == (close(4, 4 * EPS), 0, True)
    assert removed(alpha, faces, StrainLimits(0.02, 0.005, 0.7), False)[0] == 0.5  # second centre: 0.75


def test_strain_at_its_limit_does_not_tear():
    limits = StrainLimits(0.25, 0.25, 0)
    assert (
        removed([0.25] * 3, range(4), limits) == removed([0.25] * 3, range(4), limits, False) == (0, 0, False)
    )
    assert removed([0.5, 0.25, 0.5], range(4), limits, False) == (1, 1, False)
    falling = [
        0.75,
        0.5,
        0.25,
    ]  # reaches the limit of the layer where it ends, at the centre 1.5, and is above the next
    assert removed(falling, range(4), StrainLimits(0.375, 0.5, 1.5))[0] == 2


def test_zones_under_a_roof_stay_and_are_counted():
    """Linear between centres 0.5, 1.5 ...: crossings of 0.5 at 1, 2 and 4 with strains 1 0 1 1 0 at the
    centres.
    """
    limits = StrainLimits(0.5, 0.5, 0)
    assert removed([1, 0, 1, 1, 0], range(6), limits) == (pytest.approx(1), pytest.approx(2), False)
    assert removed([0, 0, 1, 1, 0], range(6), limits) == (0, pytest.approx(2), False)
    assert removed([1, 0, 1, 1, 0], range(6), limits, False) == (1, 2, False)
    assert removed([0, 0, 1, 1, 1], range(6), limits, False) == (0, 3, False)


PROFILES = st.integers(2, 6).flatmap(
    lambda n: st.tuples(
        st.lists(st.floats(0, 1), min_size=n, max_size=n), st.lists(st.floats(0.1, 3), min_size=n, max_size=n)
    )
)


@settings(max_examples=60, deadline=None)
@given(PROFILES, st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.just(0.0) | st.floats(0.1, 10))
def test_depth_and_roof_equal_a_walk_down_the_profile(profile, bulk, layer, thickness):
    """Samples of the same piecewise linear strain: within two samples per crossing, of which a profile has 2
    + layers.
    """
    alpha, lengths = np.array(profile[0]), np.array(profile[1])
    faces = np.concatenate([[0], np.cumsum(lengths)])
    limits = StrainLimits(bulk, layer, thickness)
    centres = (faces[1:] + faces[:-1]) / 2
    surface = max(np.polynomial.Polynomial.fit(centres[:2], alpha[:2], 1)(0.0), 0.0)
    z = (np.arange(20000) + 0.5) / 20000 * faces[-1]
    above = np.interp(z, [0, *centres], [surface, *alpha]) > np.where(z < thickness, layer, bulk)
    walked = (len(z) if above.all() else int(np.argmin(above))) * faces[-1] / len(z)
    depth, roofed, _ = removed(alpha, faces, limits)
    within = 2 * (2 + len(alpha)) * faces[-1] / len(z)
    nodes = np.array([0, *sorted([*centres, thickness])])
    margins = np.interp(nodes, [0, *centres], [surface, *alpha])[:, None] - [bulk, layer]
    assume(np.abs(margins).min() > 1e-3)  # nearer, samples may miss a crossing
    assert (depth, depth + roofed) == pytest.approx((walked, above.mean() * faces[-1]), abs=within)


@pytest.mark.parametrize(
    "faces, words",
    [
        ([0, 1], "3 depths"),
        ([0.1, 1, 2], "from 0"),
        ([0, 2, 2], "ascending"),
        ([0, math.nan, 2], "ascending"),
    ],
)
def test_faces_that_do_not_fit_are_refused(faces, words):
    with pytest.raises(ValueError, match=f"faces = .*{words}"):
        removed([0, 0], faces, LIMIT)
    with pytest.raises(ValueError, match="alpha"):
        removed([0, math.nan], [0, 1, 2], LIMIT)


# smoothing


def monomials(window, order):
    """At all cells of a window (window^2, terms), in cells from the middle."""
    lags = np.arange(window) - window // 2
    k, l = np.meshgrid(lags, lags, indexing="ij")  # noqa: E741
    terms = [k**i * l**j for i in range(order + 1) for j in range(order + 1 - i)]
    return np.stack(terms, axis=-1).reshape(window**2, -1).astype(float)


@pytest.mark.parametrize(
    "window, order", [(1, 0), (3, 0), (3, 1), (3, 2), (5, 2), (5, 3), (7, 2), (7, 4), (9, 5)]
)
def test_weights_are_those_of_the_least_squares_fit(window, order):
    """Monomials up to 4^5 have a condition of up to 1700; the weights have a norm below 1."""
    half, basis = window // 2, monomials(window, order)
    fitted = np.linalg.lstsq(basis, np.eye(window**2), rcond=None)[0][0].reshape(window, window)
    assert weights(window, order) == pytest.approx(fitted[half:, half:], abs=of_least_squares(basis))


@pytest.mark.parametrize("window, order", [(3, 2), (5, 2), (7, 4)])
def test_polynomials_pass_the_filter_and_higher_ones_do_not(window, order):
    """A sum of window^2 products; their moduli add to at most window max |f|, as the weights have a norm
    below 1.
    """
    x, y = (axis / 10 for axis in grid(21))
    half = window // 2
    inner = (slice(half, -half),) * 2
    for i in range(order + 1):
        field = x**i * y ** (order - i) - 0.3 * x + 2
        rounding = window**3 * EPS * np.abs(field).max()
        assert filtered(field, window, order)[inner] == pytest.approx(field[inner], abs=rounding)
    higher = x**2 * y**order
    assert np.abs(filtered(higher, window, order) - higher)[inner].max() > 1e-6


@pytest.mark.parametrize("window, order", [(5, 2), (7, 3), (9, 4)])
def test_equals_the_filter_in_one_dimension_for_fields_of_one_coordinate(window, order):
    """scipy fits monomials of the lags, of condition 4, 23 and 255; the moduli add to sqrt(window) max |f| at
    most.
    """
    line = np.random.default_rng(0).standard_normal(30)
    field = np.repeat(line[:, None], 25, axis=1)
    mirrored = savgol_filter(np.pad(line, window, mode="symmetric"), window, order)[window:-window]
    condition = of_least_squares(np.vander(np.arange(window) - window // 2, order + 1))
    expected = np.repeat(mirrored[:, None], 25, axis=1)
    for found in (filtered(field, window, order), filtered(field.T, window, order).T):
        assert found == pytest.approx(expected, abs=condition * math.sqrt(window) * np.abs(line).max())


@pytest.mark.parametrize("window", [3, 5, 7, 33])
def test_filter_keeps_the_volume_up_to_the_border(window):
    """Sums of window^2 products, of moduli below twice the field, and over the cells."""
    field = np.random.default_rng(1).random((20, 13))  # 33: mirrored more than once
    assert filtered(field, window, 2).sum() == close(field.sum(), 2 * (window**2 + field.size) * EPS)


def test_negative_depths_are_the_volume_that_smoothing_adds():
    """One cell removed: its depth times the positive weights, (27 + 88 + 68 + 28 + 16)/175 of window 5;
    nothing beyond it.

    Weights as accurate as above, and their sum: 50 EPS.
    """
    raw = np.zeros((15, 15))
    raw[7, 7] = 2e-7
    found = smoothed(raw, 5, 2)
    assert found.sum() == close(2e-7 * 227 / 175, 50 * EPS)
    assert (
        (found >= 0).all()
        and np.count_nonzero(found) == 21
        and found[7, 7] == close(2e-7 * 27 / 175, 50 * EPS)
    )


def test_without_window_or_wear_nothing_is_computed():
    raw = np.maximum(paraboloid(9, 3), 0)
    assert smoothed(raw, 0, 2) is raw
    none = np.zeros((9, 9))
    assert smoothed(none, 5, 2) is none


def test_bad_windows_orders_and_depths_are_refused():
    for window, order, words in (
        (4, 2, "window = 4"),
        (-1, 0, "window = -1"),
        (3, 3, "order = 3"),
        (3, -1, "order = -1"),
    ):
        with pytest.raises(ValueError, match=words):
            filtered(np.ones((5, 5)), window, order)
    for bad in (-1e-9, math.nan, math.inf):
        with pytest.raises(ValueError, match="depth"):
            smoothed(np.array([[0.0, bad]]), 3, 2)
        with pytest.raises(ValueError, match="depth"):
            remapped(np.zeros((6, 2, 1, 2)), np.array([0.0, 1, 2]), np.array([[0.0, bad]]))


# symmetry


SYMMETRIES = [lambda f, t=turns: np.rot90(f, t, (-2, -1)) for turns in range(4)]
SYMMETRIES += [lambda f, s=same: np.swapaxes(s(f), -2, -1) for same in SYMMETRIES]


def asymmetry(field):
    return max(float(np.abs(same(field) - field).max()) for same in SYMMETRIES)


@pytest.mark.parametrize("cells", [24, 25])
@pytest.mark.parametrize("window, order", [(5, 2), (7, 4)])
def test_a_symmetric_field_stays_symmetric_bit_by_bit(cells, window, order):
    half = np.random.default_rng(2).random((14, cells, cells)) * 0.02 * np.exp(-GRADED[1:, None, None] / UM)
    for axis in (-2, -1):
        half = half + np.flip(half, axis)
    alpha = half + np.swapaxes(half, -2, -1)
    assert asymmetry(alpha) == 0
    limits = StrainLimits(0.01, 0.02, 0.5 * UM)
    depth = smoothed(worn_depth(alpha, GRADED, limits, True).depth, window, order)
    strain = np.broadcast_to(alpha, (6, *alpha.shape))
    (new_strain, _), (new_alpha, removed) = (remapped(field, GRADED, depth) for field in (strain, alpha))
    assert depth.any() and asymmetry(depth) == 0
    assert asymmetry(new_alpha) == 0 and asymmetry(new_strain) == 0 and asymmetry(removed) == 0
    alpha[:, *np.unravel_index(depth.argmax(), depth.shape)] *= 1 + 1e-9  # of one cell of its kind
    assert asymmetry(smoothed(worn_depth(alpha, GRADED, limits, True).depth, window, order)) > 0


# margin


def test_margin_is_that_of_the_layer_nearest_to_its_limit():
    """Limits at the middles of the layers: 2 % above 0.5 um, 0.2 % below."""
    law = WearLaw((1, 1), UM, UM, StrainLimits(0.002, 0.02, 0.5 * UM), interpolate=True, window=0, order=2)
    faces = UM * np.array([0.0, 0.4, 0.8])  # the middle of the second lies below 0.5 um
    assert law.margin(column(0.015, 0.0005), faces) == pytest.approx(0.25, rel=1e-12)
    assert law.margin(column(0.001, 0.003), faces) == pytest.approx(-0.5, rel=1e-12)
    for end, limit in ((0.5998, 0.02), (0.6002, 0.002)):  # just above, and just below
        thin = UM * np.array([0.0, 0.4, end])
        assert law.margin(column(0.0, 0.01), thin) == pytest.approx(1 - 0.01 / limit, rel=1e-12)
