# SPDX-License-Identifier: MIT
"""Wear of cycle after cycle: the remap of material below the surface, and the books of what was removed."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from rounding import EPS, close
from test_wear import GRADED, UM, column, paraboloid

from sam.wear import (
    StrainLimits,
    WearState,
    Worn,
    closing_residual,
    remapped,
    smoothed,
    with_cycle,
    worn_depth,
)

# remap


def state(seed, faces, nx=5, ny=4):
    """Random deviatoric plastic strain, an accumulated one above its norm, and depths of which some are 0,
    some huge.
    """
    rng = np.random.default_rng(seed)
    strain = rng.standard_normal((6, len(faces) - 1, nx, ny))
    strain[2] = -strain[0] - strain[1]
    alpha = norm(strain) * (1 + rng.random(strain.shape[1:]))
    depth = rng.choice([0, 1e-9, 0.03, 0.4, 1.3], (nx, ny)) * rng.random((nx, ny)) * faces[-1]
    return strain, alpha, depth


def norm(strain):
    return np.sqrt(2 / 3 * ((strain[:3] ** 2).sum(axis=0) + 2 * (strain[3:] ** 2).sum(axis=0)))


def means_below(values, faces, depth):
    """Means after the move of one column from its integral over depth, which is linear over each layer."""
    integral = np.concatenate([[0], np.cumsum(values * np.diff(faces))])
    return np.diff(np.interp(faces + depth, faces, integral)) / np.diff(faces)


def assert_closed(before, after, removed, faces):
    """To the rounding of overlaps: two a layer, differences of depths, each with two roundings of the
    deepest.
    """
    integral = (np.abs(before) * np.diff(faces)[:, None, None]).sum(axis=-3).max()
    rounding = 4 * len(faces) * EPS * np.abs(before).max() * faces[-1]
    assert closing_residual(before, after, removed, faces) * integral <= rounding


LAYERS = st.lists(st.floats(0.05, 5), min_size=1, max_size=8)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), LAYERS)
def test_remap_conserves_and_creates_nothing(seed, thicknesses):
    faces = np.concatenate([[0], np.cumsum(thicknesses)]) * UM
    strain, alpha, depth = state(seed, faces)
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
    assert not new_alpha[:, depth >= faces[-1]].any()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), LAYERS)
def test_remap_equals_differences_of_the_integral(seed, thicknesses):
    """The differences of the reference, sums of up to eight layers, lose the ratio of depth to layer, up to
    700.
    """
    faces = np.concatenate([[0], np.cumsum(thicknesses)])
    rounding = 2 * len(faces) * EPS * faces[-1] / np.diff(faces).min()
    strain, alpha, depth = state(seed, faces, 2, 2)
    new_strain, new_alpha = (remapped(field, faces, depth)[0] for field in (strain, alpha))
    for i, j in np.ndindex(2, 2):
        expected = means_below(alpha[:, i, j], faces, depth[i, j])
        assert new_alpha[:, i, j] == pytest.approx(expected, abs=rounding * alpha.max())
        expected = means_below(strain[4, :, i, j], faces, depth[i, j])
        assert new_strain[4, :, i, j] == pytest.approx(expected, abs=rounding * np.abs(strain).max())


def moved(values, faces, depth):
    """One column moved up by `depth`."""
    return remapped(column(*values), np.array(faces, dtype=float), np.array([[depth]]))[0][:, 0, 0]


def test_whole_layers_move_exactly_and_fresh_material_follows():
    values = [0.7, 0.1, 0.4, 0.3]
    assert moved(values, range(5), 2.0).tolist() == [0.4, 0.3, 0, 0]
    assert moved(values, [0, 1, 3, 4, 6], 4.0).tolist() == close([0.3, 0.15, 0, 0], EPS)
    assert moved(values, range(5), 4.0).tolist() == [0, 0, 0, 0]


def test_constant_and_linear_strain_move_exactly_inside():
    """Constant on any layers, linear on equal ones; the layers that reach below the deepest face hold fresh
    material.

    Both lie up to nine thicknesses deep: four roundings of the depth for each overlap.
    """
    assert moved([0.3] * 14, GRADED / UM, 0.77)[:11] == close(np.full(11, 0.3), 4 * 9 * EPS)
    centres = np.arange(8) + 0.5
    assert moved(0.1 + 0.02 * centres, range(9), 0.3)[:7] == close(
        0.1 + 0.02 * (centres + 0.3)[:7], 4 * 9 * EPS
    )


def test_a_move_by_part_of_a_layer_smears_by_t_1_minus_t():
    """A layer of strain: its centre moves by w exactly, its second moment grows by t (1 - t) h^2.

    The layers lie up to 12 thicknesses deep: four roundings of the depth in each move.
    """
    t, h = 0.3, 0.5
    centres = (np.arange(12) + 0.5) * h
    values = np.zeros(12)
    values[7] = 1.0
    for count in (1, 2, 3):
        values = moved(values, np.arange(13) * h, t * h)
        mean = (values * centres).sum()
        rounding = count * 4 * 12 * EPS
        assert mean == close(centres[7] - count * t * h, rounding)
        assert (values * (centres - mean) ** 2).sum() == close(count * t * (1 - t) * h**2, 12 * rounding)


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


# cycles


def cycles(count, interpolate, window, faces=GRADED, strained=True):
    """Wear state and current heights after some cycles of straining (or only the first), removal, smoothing
    and remap.
    """
    rng = np.random.default_rng(5)
    shape = np.maximum(paraboloid(25, 8.0), 0) * np.exp(-((faces[:-1] / UM) ** 2))[:, None, None]
    original = 0.3 * UM * rng.standard_normal((25, 25))
    current, alpha = original.copy(), np.zeros((len(faces) - 1, 25, 25))
    worn = WearState.empty(original.shape, UM, 0.8 * UM)
    for cycle in range(count):
        if strained or cycle == 0:
            alpha = alpha + 0.02 * shape * (1 + rng.random(alpha.shape))
        raw = worn_depth(alpha, faces, StrainLimits(0.005, 0.02, 0.5 * UM), interpolate)
        depth = smoothed(raw.depth, window, 2)
        found, removed = remapped(alpha, faces, depth)
        worn = with_cycle(worn, raw, depth, closing_residual(alpha, found, removed, faces))
        current, alpha = current - depth, found
    return worn, original, current


@pytest.mark.parametrize("interpolate", [True, False])
def test_the_books_close_over_25_cycles(interpolate):
    """Heights of 0.3 um lose their rounding in each cycle; the volume of some um depth is held against it.

    Of the remap: four roundings of the depth, up to five thicknesses, for each overlap, and sums over 14
    layers.
    """
    worn, original, current = cycles(25, interpolate, 5)
    for each in (worn.volumes, worn.raw_volumes, worn.roofed_volumes, worn.bottom_columns):
        assert len(each) == 25
    assert worn.volume > 0 and max(worn.residuals) <= (4 * 5 + 14) * EPS
    assert abs(worn.imbalance(original, current)) <= 25 * EPS * worn.volume
    assert worn.depth == pytest.approx(original - current, abs=25 * EPS * np.abs(current).max())
    current[3, 3] += 1e-12  # a thousandth of the size of an atom
    assert abs(worn.imbalance(original, current)) > 0.9e-12 * 0.8 * UM**2


@pytest.mark.parametrize("all_removed", [True, False])
def test_material_that_smoothing_leaves_is_removed_again(all_removed):
    """One cell removed, nothing strained later. The plain filter removes 27/175 of it, and its mean strain
    falls by that factor until a tenth is left, digging the flanks in each cycle; if all of it goes, the
    first cycle is the last.
    """
    alpha, faces, volumes = np.zeros((6, 9, 9)), np.arange(7.0), []
    alpha[0, 4, 4] = 1.0
    for _ in range(20):
        depth = smoothed(
            worn_depth(alpha, faces, StrainLimits(0.1, 0.1, 0.0), False).depth, 5, 2, all_removed
        )
        alpha = remapped(alpha, faces, depth)[0]
        volumes.append(depth.sum())
    cycles, first = (
        (1, 1 + 200 / 175) if all_removed else (math.ceil(math.log(0.1) / math.log(148 / 175)), 227 / 175)
    )
    assert volumes == close([first] * cycles + [0.0] * (20 - cycles))


def test_a_cycle_of_the_wear_state():
    raw = Worn(np.array([[1e-7, 3e-8]]), np.array([[0, 3e-7]]), np.array([[True, False]]))
    worn = with_cycle(WearState.empty((1, 2), 2 * UM, 3 * UM), raw, np.array([[5e-8, 4e-8]]), 1e-16)
    assert worn.volumes == close((5.4e-19,)) and worn.raw_volumes == close((7.8e-19,))
    assert worn.roofed_volumes == close((1.8e-18,))
    assert worn.bottom_columns == (1,) and worn.residuals == (1e-16,)
    assert with_cycle(worn, raw, raw.depth, 0.0).raw_volume == close(2 * 7.8e-19)
