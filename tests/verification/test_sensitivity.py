# SPDX-License-Identifier: MIT
"""Indices of sensitivity against functions whose indices are known."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from verification.sensitivity import METHODS, MORRIS, SOBOL, UNIFORM, design, indices, size

SLOPES = np.array([3.0, -2.0, 0.5, 0.0])
# Ishigami & Homma (1990), a = 7, b = 0.1: Saltelli et al., Global Sensitivity Analysis (2008), section 4.2
FIRST, TOTAL = [0.3139, 0.4424, 0.0], [0.5576, 0.4424, 0.2437]


def linear(shares: np.ndarray) -> np.ndarray:
    return 1.0 + shares @ SLOPES


def ishigami(shares: np.ndarray) -> np.ndarray:
    x, y, z = np.pi * (2.0 * np.asarray(shares).T - 1.0)
    return np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def found(method: str, function, factors: int, samples: int, lost=()) -> dict[str, np.ndarray]:
    shares = design(method, factors, samples, 3)
    values = function(shares)
    values[list(lost)] = np.nan
    return {index.name: index for index in indices(method, shares, values, 3)}


def test_a_trajectory_moves_each_factor_once_between_the_levels():
    shares = design(MORRIS, 4, 50, 1).reshape(50, 5, 4)
    moved = np.diff(shares, axis=1)
    assert np.allclose(np.abs(moved).sum(axis=2), 2 / 3) and np.allclose(np.abs(moved).sum(axis=1), 2 / 3)
    assert np.allclose(np.sort(np.unique(shares.round(12))), [0, 1 / 3, 2 / 3, 1])


@pytest.mark.parametrize("method", METHODS)
def test_more_samples_begin_with_those_of_fewer(method):
    few, many = (design(method, 3, count, 7) for count in (5, 12))
    assert np.array_equal(few, many[: len(few)]) and len(few) == 5 * size(method, 3)
    assert not np.array_equal(few, design(method, 3, 5, 8))


def test_effects_of_a_linear_function_are_its_slopes():
    of = found(MORRIS, linear, 4, 10)
    for name, expected in (("mu_star", np.abs(SLOPES)), ("mu", SLOPES), ("sigma", 0.0 * SLOPES)):
        assert of[name].values == pytest.approx(expected, abs=1e-13)
        assert of[name].bounds == pytest.approx(np.array([expected, expected]), abs=1e-13)


def test_shares_of_the_variance_of_the_ishigami_function():
    """Errors are about 2/sqrt(n) of n = 4096 pairs; wrong factors are 0.1 off and more."""
    of = found(SOBOL, ishigami, 3, 4096)
    assert of["first"].values == pytest.approx(FIRST, abs=0.03)
    assert of["total"].values == pytest.approx(TOTAL, abs=0.03)
    assert (np.diff([of["total"].bounds[0], TOTAL, of["total"].bounds[1]], axis=0) >= 0.0).all()
    assert np.abs(np.roll(of["first"].values, 1) - FIRST).max() > 0.1


def test_a_point_without_a_value_takes_the_effects_beside_it_away_and_no_others():
    of = found(MORRIS, linear, 4, 6, lost=[5])  # the first of the second trajectory
    assert sorted(of["mu_star"].count) == [5, 6, 6, 6]
    assert of["mu_star"].values == pytest.approx(np.abs(SLOPES), abs=1e-13)
    assert found(SOBOL, linear, 4, 64, lost=[0, 1, 30])["first"].count.tolist() == [62] * 4


@pytest.mark.parametrize("method", METHODS)
def test_a_result_that_never_changes_and_too_few_samples_have_no_index(method):
    assert found(method, lambda shares: np.ones(len(shares)), 2, 16) == {}
    assert found(method, lambda shares: np.full(len(shares), np.nan), 2, 16) == {}
    assert found(method, lambda shares: shares @ [1.0, 2.0], 2, 1) == {}


def test_correlations_of_ranks_are_spearmans_and_do_not_ask_for_a_straight_line():
    shares = design(UNIFORM, 3, 50, 2)
    rising = {index.name: index for index in indices(UNIFORM, shares, np.exp(9.0 * shares[:, 1]), 2)}
    assert rising["rank_correlation"].values[1] == pytest.approx(1.0, abs=1e-12)
    values = linear(np.column_stack([shares, shares[:, 0]]))
    (index,) = indices(UNIFORM, shares, values, 2)
    exact = [spearmanr(share, values).statistic for share in shares.T]
    assert index.values == pytest.approx(exact, abs=1e-12)
    assert (index.bounds[0] <= index.values).all() and (index.values <= index.bounds[1]).all()
