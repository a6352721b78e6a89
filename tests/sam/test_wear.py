# SPDX-License-Identifier: MIT
"""Worn depth, smoothing, remap and books of what was removed: closed forms, other filters and brute force."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from rounding import EPS, close, of_least_squares

from sam.grid.cells import Window
from sam.plasticity.flow import equivalent_strain as norm
from sam.scene import Wear
from sam.wear import (
    StrainLimits,
    WearLaw,
    WearState,
    Worn,
    closing_residual,
    filtered,
    limit_by_depth,
    remapped,
    smoothed,
    weights,
    with_cycle,
    worn_depth,
)

UM = 1e-6
GRADED = UM * np.concatenate([[0.0], np.cumsum(0.1 * 1.25 ** np.arange(14))])
LIMIT = StrainLimits(0.002, 0.002, 0.0)


def column(*values):
    """alpha of one column, (n_layers, 1, 1)."""
    return np.array(values, dtype=float)[:, None, None]


def removed(alpha, faces, limits, interpolate=True):
    """(depth, roofed, at_bottom) of one column."""
    found = worn_depth(column(*alpha), np.array(faces, dtype=float), limits, interpolate)
    return found.depth[0, 0], found.roofed[0, 0], found.at_bottom[0, 0]


def fallen(alpha, faces, limits, interpolate=True):
    """(depth, roofed, roof, at_bottom) of one column whose roof falls."""
    found = worn_depth(column(*alpha), np.array(faces, dtype=float), limits, interpolate, roof_falls=True)
    return tuple(part[0, 0] for part in found)


def rule(window, fills=False):
    """Wear of a scene that smooths so; the limits of a law are given beside it."""
    return Wear(strain_limit=0.5, smoothing_window=window, smoothing_fills=fills)


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


def test_margin_is_that_of_the_layer_nearest_to_its_limit():
    """Limits at the middles of the layers: 2 % above 0.5 um, 0.2 % below."""
    law = WearLaw((1, 1), UM, UM, StrainLimits(0.002, 0.02, 0.5 * UM), rule(0))
    faces = UM * np.array([0.0, 0.4, 0.8])  # the middle of the second lies below 0.5 um
    assert law.margin(column(0.015, 0.0005), faces) == pytest.approx(0.25, rel=1e-12)
    assert law.margin(column(0.001, 0.003), faces) == pytest.approx(-0.5, rel=1e-12)
    for end, limit in ((0.5998, 0.02), (0.6002, 0.002)):  # just above, and just below
        thin = UM * np.array([0.0, 0.4, end])
        assert law.margin(column(0.0, 0.01), thin) == pytest.approx(1 - 0.01 / limit, rel=1e-12)


# worn depth


def test_strain_at_the_surface_is_not_negative():
    """0 and 1, or 1 and 4, at 0.5 and 1.5 extrapolate to -0.5: sound as 0 is, as what lies next."""
    limits, above = StrainLimits(0.25, 0.25, 0), 0.375 + 1 + 0.9375  # from 0 to 1 over 0.5
    assert removed([0, 1, 0, 0], range(5), limits)[:2] == (0, pytest.approx(1.5))
    assert removed([1, 4, 0, 0], range(5), limits)[:2] == (0, pytest.approx(above))
    assert removed([0.3], [0, 2], limits) == (2, 0, True)  # a single layer is constant


def test_strain_at_its_limit_does_not_tear():
    limits = StrainLimits(0.25, 0.25, 0)
    for interpolate in (True, False):
        assert removed([0.25] * 3, range(4), limits, interpolate) == (0, 0, False)
    assert removed([0.5, 0.25, 0.5], range(4), limits, False) == (1, 1, False)
    # reaches the limit of the layer where it ends, at the centre 1.5, and is above the next
    assert removed([0.75, 0.5, 0.25], range(4), StrainLimits(0.375, 0.5, 1.5))[0] == 2


def test_a_roof_falls_with_what_is_under_it():
    """Linear between centres 0.5, 1.5 ...: strains 1 0 1 1 0 cross 0.5 at 1, 2 and 4. A layer that may strain
    ten times as much over metal beyond its limit down to z = 4: all of it goes, 2 as the roof. Without a
    roof nothing changes.
    """
    limits, layered = StrainLimits(0.5, 0.5, 0), StrainLimits(0.002, 0.02, 2.0)
    assert fallen([1, 0, 1, 1, 0], range(6), limits) == pytest.approx((4, 2, 1, False))
    assert fallen([0, 0, 1, 1, 0], range(6), limits) == pytest.approx((4, 2, 2, False))
    assert fallen([1, 0, 1, 1, 0], range(6), limits, False) == (4, 2, 1, False)
    assert fallen([0, 0, 1, 1, 1], range(6), limits, False) == (5, 3, 2, True)
    assert fallen([0.004] * 4 + [0.0], range(6), layered) == pytest.approx((4, 2, 2, False))
    assert fallen([0.001] * 5, range(6), layered) == (0, 0, 0, False)
    open_above = fallen([1, 0.2, 0.1], range(4), limits)
    assert open_above == (removed([1, 0.2, 0.1], range(4), limits)[0], 0, 0, False)


PROFILES = st.integers(2, 6).flatmap(
    lambda n: st.tuples(
        st.lists(st.floats(0, 1), min_size=n, max_size=n), st.lists(st.floats(0.1, 3), min_size=n, max_size=n)
    )
)


@settings(max_examples=30, deadline=None)
@given(PROFILES, st.floats(0.05, 0.95), st.floats(0.05, 0.95), st.just(0.0) | st.floats(0.1, 10))
def test_depth_and_roof_equal_a_walk_down_the_profile(profile, bulk, layer, thickness):
    """Samples of the same piecewise linear strain: within two samples per crossing."""
    alpha, lengths = np.array(profile[0]), np.array(profile[1])
    faces = np.concatenate([[0], np.cumsum(lengths)])
    limits = StrainLimits(bulk, layer, thickness)
    centres = (faces[1:] + faces[:-1]) / 2
    surface = max(np.polynomial.Polynomial.fit(centres[:2], alpha[:2], 1)(0.0), 0.0)
    z = (np.arange(20000) + 0.5) / 20000 * faces[-1]
    above = np.interp(z, [0, *centres], [surface, *alpha]) > np.where(z < thickness, layer, bulk)
    walked = (len(z) if above.all() else int(np.argmin(above))) * faces[-1] / len(z)
    lowest = (int(np.flatnonzero(above)[-1]) + 1 if above.any() else 0) * faces[-1] / len(z)
    depth, roofed, _ = removed(alpha, faces, limits)
    falls, under, roof, _ = fallen(alpha, faces, limits)
    within = 2 * (2 + len(alpha)) * faces[-1] / len(z)
    nodes = np.array([0, *sorted([*centres, thickness])])
    margins = np.interp(nodes, [0, *centres], [surface, *alpha])[:, None] - [bulk, layer]
    assume(np.abs(margins).min() > 1e-3)  # nearer, samples may miss a crossing
    assert (depth, depth + roofed) == pytest.approx((walked, above.mean() * faces[-1]), abs=within)
    assert (falls, under) == pytest.approx((lowest, roofed), abs=within)
    assert falls == pytest.approx(depth + under + roof, abs=1e-12)


# smoothing


@pytest.mark.parametrize("window, order", [(1, 0), (3, 2), (5, 2), (7, 4), (9, 5)])
def test_weights_are_those_of_the_least_squares_fit(window, order):
    """Monomials up to 4^5 have a condition of up to 1700; the weights have a norm below 1."""
    half, lags = window // 2, np.arange(window) - window // 2
    k, m = np.meshgrid(lags, lags, indexing="ij")
    terms = [k**i * m**j for i in range(order + 1) for j in range(order + 1 - i)]
    basis = np.stack(terms, axis=-1).reshape(window**2, -1).astype(float)
    fitted = np.linalg.lstsq(basis, np.eye(window**2), rcond=None)[0][0].reshape(window, window)
    assert weights(window, order) == pytest.approx(fitted[half:, half:], abs=of_least_squares(basis))


def test_negative_depths_are_the_volume_that_smoothing_adds():
    """One cell removed: the positive weights of window 5; weights and their sum to 50 EPS."""
    raw = np.zeros((15, 15))
    raw[7, 7] = 2e-7
    found = smoothed(raw, 5, 2)
    assert found.sum() == close(2e-7 * 227 / 175, 50 * EPS)
    assert (found >= 0).all() and np.count_nonzero(found) == 21
    assert found[7, 7] == close(2e-7 * 27 / 175, 50 * EPS)
    assert smoothed(raw, 0, 2) is raw
    none = np.zeros((9, 9))
    assert smoothed(none, 5, 2) is none


def test_bad_faces_windows_orders_and_depths_are_refused():
    for faces, words in (([0, 1], "3 depths"), ([0.1, 1, 2], "from 0"), ([0, math.nan, 2], "asc")):
        with pytest.raises(ValueError, match=f"faces = .*{words}"):
            removed([0, 0], faces, LIMIT)
    with pytest.raises(ValueError, match="alpha"):
        removed([0, math.nan], [0, 1, 2], LIMIT)
    for window, order, words in (
        (4, 2, "w = 4"),
        (-1, 0, "w = -1"),
        (3, 3, "order = 3"),
        (3, -1, "order = -1"),
    ):
        with pytest.raises(ValueError, match=words):
            filtered(np.ones((5, 5)), window, order)
    for bad in (-1e-9, math.nan, math.inf):
        with pytest.raises(ValueError, match="depth"):
            smoothed(np.array([[0.0, bad]]), 3, 2)
        if bad != -1e-9:  # a column may be raised
            with pytest.raises(ValueError, match="depth"):
                remapped(np.zeros((6, 2, 1, 2)), np.array([0.0, 1, 2]), np.array([[0.0, bad]]))


# remap


def state(seed, faces, nx=5, ny=4, raised=()):
    """Random deviatoric plastic strain, an accumulated one above its norm, and depths of which some are 0,
    some huge; raised: further shares of the deepest face.
    """
    rng = np.random.default_rng(seed)
    strain = rng.standard_normal((6, len(faces) - 1, nx, ny))
    strain[2] = -strain[0] - strain[1]
    alpha = norm(strain) * (1 + rng.random(strain.shape[1:]))
    shares = [0, 1e-9, 0.03, 0.4, 1.3, *raised]
    depth = rng.choice(shares, (nx, ny)) * rng.random((nx, ny)) * faces[-1]
    return strain, alpha, depth


def assert_closed(before, after, removed, faces):
    """To the rounding of overlaps: two a layer, differences of depths with two roundings each."""
    integral = (np.abs(before) * np.diff(faces)[:, None, None]).sum(axis=-3).max()
    rounding = 4 * len(faces) * EPS * np.abs(before).max() * faces[-1]
    assert closing_residual(before, after, removed, faces) * integral <= rounding


LAYERS = st.lists(st.floats(0.05, 5), min_size=1, max_size=8)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), LAYERS, st.sampled_from([(), (-1e-9, -0.03, -1.3)]))
def test_remap_conserves_and_creates_nothing(seed, thicknesses, raised):
    """And equals differences of the integral over depth, which is linear over each layer: these are sums of
    up to eight layers, and lose the ratio of depth to layer.
    """
    faces = np.concatenate([[0], np.cumsum(thicknesses)]) * UM
    strain, alpha, depth = state(seed, faces, raised=raised)
    new_strain, removed_strain = remapped(strain, faces, depth)
    new_alpha, removed_alpha = remapped(alpha, faces, depth)
    assert_closed(strain, new_strain, removed_strain, faces)
    assert_closed(alpha, new_alpha, removed_alpha, faces)
    assert (new_alpha >= 0).all() and (removed_alpha >= 0).all()
    rounding = 4 * EPS * faces[-1] / np.diff(faces).min()  # of an overlap, in parts of the thinnest layer
    assert (new_alpha <= alpha.max(axis=0) * (1 + rounding)).all()
    assert (new_alpha >= norm(new_strain) * (1 - 1e-12)).all()  # accumulated strain stays above the norm
    assert np.abs(new_strain[:3].sum(axis=0)).max() <= 2 * rounding * np.abs(strain).max()
    still = depth == 0
    assert np.array_equal(new_alpha[:, still], alpha[:, still]) and not removed_alpha[still].any()
    assert not new_alpha[:, np.abs(depth) >= faces[-1]].any()
    for before, after in ((alpha, new_alpha), (strain[4], new_strain[4])):
        for i, j in np.ndindex(2, 2):
            integral = np.concatenate([[0], np.cumsum(before[:, i, j] * np.diff(faces))])
            at = np.interp(faces + depth[i, j], faces, integral)  # above the old surface: nothing
            expected = np.diff(at) / np.diff(faces)
            bound = len(faces) * rounding * np.abs(before).max()
            assert after[:, i, j] == pytest.approx(expected, abs=bound)


def test_without_wear_the_material_is_not_touched():
    strain, alpha, depth = state(0, GRADED)
    for field in (strain, alpha):
        found, removed = remapped(field, GRADED, 0 * depth)
        assert found is field and not removed.any()


def test_closing_residual_sees_what_is_lost():
    _, alpha, depth = state(4, GRADED)
    found, removed = remapped(alpha, GRADED, depth + 0.1 * UM)
    lost = found.copy()
    lost[5] *= 1 - 1e-9
    assert closing_residual(alpha, lost, removed, GRADED) > 1e-11
    assert closing_residual(0 * alpha, 0 * alpha, 0 * removed, GRADED) == 0


@pytest.mark.parametrize("fills", [False, True])
@pytest.mark.parametrize("share", [0.5, 0.0])
def test_of_the_cells_that_have_yielded_is_left_what_is_left_of_all(share, fills):
    """The fields of these cells alone, in a row, against the remap of the whole box; also if none has."""
    limits = StrainLimits(0.5, 0.5, 0.0)
    rng, law = np.random.default_rng(6), WearLaw((9, 7), 1.0, 1.0, limits, rule(3, fills))
    cells, faces = rng.random((4, 5, 3)) < share, np.array([0.0, 0.4, 1.0, 1.7, 3.0])
    field = np.where(cells, rng.random((2, *cells.shape)), 0.0)
    window, values = Window(2, 3, 5, 3), field[:, cells]
    wear, left, below = law.removed(
        law.fresh(), {"peeq": values}, faces, window, cells=cells, peeq=field.mean(axis=0)
    )
    expected, removed = remapped(field, faces, wear.depth[window.slices])
    assert np.array_equal(left, expected.any(axis=0)) and np.array_equal(below["peeq"], expected[:, left])
    assert wear.residuals == (closing_residual(field, expected, removed, faces),)
    assert removed.any() == (left != cells).any() == bool(share)
    assert (wear.depth < 0).any() == (fills and bool(share))


@pytest.mark.parametrize("wraps", [(True, True), (False, True), (True, False)])
@pytest.mark.parametrize("fills", [False, True])
def test_strain_shifted_where_all_repeats_wears_the_shifted_surface(wraps, fills):
    """Across the border as inside; a direction that does not repeat has a border, which stays."""
    peeq, faces = np.random.default_rng(7).random((3, 9, 7)), np.arange(4.0)
    cells, shift = np.ones(peeq.shape, dtype=bool), tuple(3 * wrap for wrap in wraps)

    def worn(peeq, wraps=wraps):
        law = WearLaw((9, 7), 1.0, 1.0, StrainLimits(0.5, 0.5, 0.0), rule(5, fills), wraps)
        return law.removed(law.fresh(), {}, faces, Window(0, 0, 9, 7), cells=cells, peeq=peeq)[0].depth

    np.testing.assert_array_equal(worn(np.roll(peeq, shift, (1, 2))), np.roll(worn(peeq), shift, (0, 1)))
    assert not np.array_equal(worn(peeq, (False, False)), worn(peeq))


# cycles


@pytest.mark.parametrize("interpolate, fills", [(True, False), (False, False), (True, True)])
def test_the_books_close_over_25_cycles(interpolate, fills):
    """Heights of 0.3 um lose their rounding in each cycle; the volume of some um depth is held against it.

    Of the remap: four roundings of the depth, up to five thicknesses, for each overlap, and sums over 14
    layers.
    """
    rng = np.random.default_rng(5)
    x = np.arange(25.0) - 12
    scar = np.maximum(1 - (x[:, None] ** 2 + x**2) / 8.0**2, 0)
    shape = scar * np.exp(-((GRADED[:-1] / UM) ** 2))[:, None, None]
    original = 0.3 * UM * rng.standard_normal((25, 25))
    current, alpha = original.copy(), np.zeros((len(GRADED) - 1, 25, 25))
    worn = WearState(0.8 * UM**2, np.zeros(original.shape))
    for _ in range(25):
        alpha = alpha + 0.02 * shape * (1 + rng.random(alpha.shape))
        raw = worn_depth(alpha, GRADED, StrainLimits(0.005, 0.02, 0.5 * UM), interpolate, roof_falls=fills)
        depth = (filtered if fills else smoothed)(raw.depth, 5, 2)
        found, removed = remapped(alpha, GRADED, depth)
        worn = with_cycle(worn, raw, depth, closing_residual(alpha, found, removed, GRADED))
        current, alpha = current - depth, found
    for each in (worn.volumes, worn.raw_volumes, worn.roofed_volumes, worn.bottom_columns):
        assert len(each) == 25
    dug = np.array(worn.volumes) - worn.raw_volumes + worn.filled_volumes  # of the flanks
    assert dug == close(worn.filled_volumes, 200 * EPS) if fills else (dug > worn.filled_volumes).any()
    assert worn.volume > 0 and max(worn.residuals) <= (4 * 5 + 14) * EPS
    assert abs(worn.volume - worn.volume_of(original - current)) <= 25 * EPS * worn.volume
    assert worn.depth == pytest.approx(original - current, abs=25 * EPS * np.abs(current).max())
    current[3, 3] += 1e-12  # a thousandth of the size of an atom
    assert abs(worn.volume - worn.volume_of(original - current)) > 0.9e-12 * 0.8 * UM**2


@pytest.mark.parametrize("all_removed", [True, False])
def test_material_that_smoothing_leaves_is_removed_again(all_removed):
    """One cell removed, nothing strained later. The plain filter removes 27/175 of it, and its mean strain
    falls by that factor until a tenth is left, digging the flanks in each cycle; if all of it goes, the
    first cycle is the last.
    """
    alpha, faces, volumes = np.zeros((6, 9, 9)), np.arange(7.0), []
    alpha[0, 4, 4] = 1.0
    for _ in range(20):
        raw = worn_depth(alpha, faces, StrainLimits(0.1, 0.1, 0.0), False).depth
        depth = smoothed(raw, 5, 2, all_removed)
        alpha = remapped(alpha, faces, depth)[0]
        volumes.append(depth.sum())
    decay = math.ceil(math.log(0.1) / math.log(148 / 175))
    cycles, first = (1, 1 + 200 / 175) if all_removed else (decay, 227 / 175)
    assert volumes == close([first] * cycles + [0.0] * (20 - cycles))


def test_a_cycle_of_the_wear_state():
    roofs = np.array([[0, 3e-7]]), np.array([[1e-8, 0]])
    raw = Worn(np.array([[1e-7, 3e-8]]), *roofs, np.array([[True, False]]))
    worn = with_cycle(WearState(6 * UM**2, np.zeros((1, 2))), raw, np.array([[5e-8, 4e-8]]), 1e-16)
    assert worn.volumes == close((5.4e-19,)) and worn.raw_volumes == close((7.8e-19,))
    assert worn.roofed_volumes == close((1.8e-18,)) and worn.roof_volumes == close((6e-20,))
    assert worn.filled_volumes == close((3e-19,))
    assert worn.bottom_columns == (1,) and worn.residuals == (1e-16,)
    assert sum(with_cycle(worn, raw, raw.depth, 0.0).raw_volumes) == close(2 * 7.8e-19)
