# SPDX-License-Identifier: MIT
"""A fitted polynomial against functions whose shares of the variance are known."""

import numpy as np
import pytest

from verification.cases.running_in.running_in_sensitivity import PREDICTS
from verification.sensitivity import UNIFORM, design
from verification.surrogate import surrogate

POINTS, INPUTS = 32, 16
SLOPES = np.array([3.0, -2.0, 0.5])
SHARES = design(UNIFORM, INPUTS, POINTS, 26)


def linear(shares: np.ndarray) -> np.ndarray:
    return shares[:, : len(SLOPES)] @ SLOPES


def test_shares_of_a_linear_function_are_those_of_its_slopes():
    """Slopes squared over their sum: 0.68, 0.30, 0.02; 64 points and ranks move them by hundredths."""
    found = surrogate(design(UNIFORM, INPUTS, 64, 3), linear(design(UNIFORM, INPUTS, 64, 3)))
    assert found.predicted > 0.9
    assert found.shares[:3] == pytest.approx(SLOPES**2 / (SLOPES**2).sum(), abs=0.08)
    assert found.shares.sum() == pytest.approx(found.predicted, rel=1e-12)
    assert found.slopes[:2].tolist() == [1.0, -1.0]


def test_ranks_bear_any_scale_and_infinity():
    values = linear(SHARES)
    scaled = np.where(values == values.max(), np.inf, np.exp(9.0 * values))
    for field in ("predicted", "shares", "slopes"):
        assert np.array_equal(
            getattr(surrogate(SHARES, scaled), field), getattr(surrogate(SHARES, values), field)
        )


def test_what_has_no_cause_is_not_predicted():
    """At most one of 60 results is believed, and most are predicted worse than by the mean."""
    rng = np.random.default_rng(4)
    found = [surrogate(SHARES, rng.normal(size=POINTS)) for _ in range(60)]
    assert sum(each.predicted >= PREDICTS for each in found) <= 1
    assert sum(each.predicted < 0.0 for each in found) > 45
    assert all(not each.shares.any() for each in found if each.predicted < 0.0)


def test_what_is_predicted_is_what_a_fit_without_the_point_says():
    """A single input with a slope: the straight line through the others, fitted by hand at each point."""
    shares = design(UNIFORM, 1, 12, 5)
    values = shares[:, 0] + 0.2 * np.sin(40.0 * shares[:, 0])
    found = surrogate(shares, values)
    ranks = values.argsort().argsort() + 1.0
    error = spread = 0.0
    for k in range(12):
        line = np.polyfit(np.delete(shares[:, 0], k), np.delete(ranks, k), 1)
        error += (ranks[k] - np.polyval(line, shares[k, 0])) ** 2
        spread += (ranks[k] - np.delete(ranks, k).mean()) ** 2
    assert found.predicted == pytest.approx(1.0 - error / spread, rel=1e-10)


@pytest.mark.parametrize("values", [np.ones(POINTS), np.full(POINTS, np.nan)])
def test_a_result_that_never_changes_has_none(values):
    assert surrogate(SHARES, values) is None


def test_too_few_points_have_none():
    assert surrogate(SHARES[:8], linear(SHARES[:8])) is None
