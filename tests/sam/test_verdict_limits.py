# SPDX-License-Identifier: MIT
"""The verdict on repeated loading on either side of each of its limits, by 1e-5 of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sam.scene.verdict import (
    UNSTRAINED,
    Behaviour,
    Judging,
    Verdict,
    last_period,
    loop_places,
    summary,
    verdict_on,
)
from tests.sam.test_verdict import class_of, judging, period, periods

NEAR = 1e-5
UNIT = np.array([1.0, -2.0, 1.0, 1.0, 1.0, 1.0]) / np.sqrt(8.0)  # de = 1, all components at work
ACROSS = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0]) / np.sqrt(4 / 3)  # de = 1, at right angles to it
A, R, S, U = Behaviour.ALTERNATING, Behaviour.RATCHETTING, Behaviour.SETTLING, Behaviour.UNDECIDED


def steady(share=0.01, ratio=1.0, **keys):
    """Four periods of one cell whose last three have dp of a ratio."""
    return periods((5e-3, 1e-3, 1e-3 * ratio, 1e-3 * ratio**2), share, **keys)


def falling(turn):
    """Shares of de over dp that fall to nothing by a ratio."""
    return (1.0, 0.5, 0.5 * turn, 0.5 * turn**2)


@pytest.mark.parametrize(
    ("found", "wanted"),
    [
        (steady(ratio=1.02 - NEAR), A),
        (steady(ratio=1.02 + NEAR), U),
        (steady(ratio=0.98 + NEAR), A),
        (steady(ratio=0.98 - NEAR), U),
        (steady(ratio=0.9 - NEAR), S),
        (steady(ratio=0.9 + NEAR), U),
        (steady(0.02 - NEAR / 10), A),
        (steady(0.02 + NEAR / 10), R),
        (steady(falling(np.sqrt(0.9) - NEAR)), A),
        (steady(falling(np.sqrt(0.9) + NEAR)), U),
        (steady((1.0, 0.5, 0.5, 0.5 - 1e-5 + 1e-8)), R),
        (steady((1.0, 0.5, 0.5, 0.5 - 1e-5 - 1e-8)), U),
        (steady((1.0, 0.5, 0.5 * (1.05 - NEAR), 0.5 * (1.05 - NEAR) ** 2)), R),
        (steady((1.0, 0.5, 0.5 * (1.05 + NEAR), 0.5 * (1.05 + NEAR) ** 2)), U),
    ],
)
def test_either_side_of_a_limit(found, wanted):
    assert class_of(found) is wanted


@pytest.mark.parametrize(
    ("share", "noise", "sure"),
    [
        (falling(0.9), 1e-10 / 1.725e-6, A),  # small (a + c - 2 b) over (a + 2 b + c - 4 small)
        (0.5, 2 * 5e-4 / 3e3 / 1e-3, R),  # two periods of de over LASTS
        (0.05, 2 * 5e-5 / 3e3 / 1e-3, R),
    ],
)
def test_noise_that_hides_what_the_strain_does_leaves_it_undecided(share, noise, sure):
    assert class_of(steady(share), noise=noise * (1 - NEAR)) is sure
    assert class_of(steady(share), noise=noise * (1 + NEAR)) is U


def test_a_ratchet_lasts_over_half_of_all_periods():
    """What falls in the first ten periods, to more than nothing, and not in the next nine."""
    share = np.array([1.0, *(0.3 + 0.2 * 0.7 ** np.minimum(np.arange(18), 8))])
    found = periods((5e-3, *(1e-3,) * 18), share)
    assert [class_of(found[:n]) for n in range(4, 20)] == [U] * 13 + [R] * 3


@pytest.mark.parametrize(("ratio", "wanted"), [(1.0 - NEAR, S), (1.0 + NEAR, A)])
def test_any_fall_settles_where_the_yield_stress_grows_for_ever(ratio, wanted):
    assert class_of(steady(ratio=ratio), worst=S) is wanted


@pytest.mark.parametrize("cosine", [0.99 - NEAR, 0.99 + NEAR])
@pytest.mark.parametrize("turned", [1, -1])
def test_directions_of_two_periods(cosine, turned):
    """As tensors: shears count twice. The norm of a period is that of its equivalent strain."""
    aside = np.sqrt(1 - cosine**2) * turned
    directions = [UNIT, UNIT, UNIT, cosine * UNIT + aside * ACROSS]
    found = steady(0.5, direction=directions)
    assert found[0].norm == pytest.approx(2.5e-3, rel=1e-12)
    assert found[3].norm == pytest.approx(5e-4, rel=1e-12)
    assert class_of(found) is (R if cosine > 0.99 else U)


@pytest.mark.parametrize(("share", "wanted"), [(0.01 - 1e-7, A), (0.01 + 1e-7, R)])
def test_a_hundredth_of_the_strain_makes_the_class_of_the_body(share, wanted):
    mild, bad = steady(), steady(0.5)
    both = [
        period(np.append(a.accumulated, b.accumulated), np.hstack([a.strain, b.strain]))
        for a, b in zip(mild, bad, strict=True)
    ]
    found = verdict_on(both, np.ones(2), np.full(2, 1e-3), judging(), volume=np.array([1 - share, share]))
    assert found.behaviour is wanted


def test_loops_are_of_the_most_strained_point_and_near_a_half_and_a_tenth_of_it():
    for share in (np.array([0.4999, 0.5002, 1.0]), np.array([0.4998, 0.5001, 1.0])[[1, 0, 2]]):
        assert loop_places(2e-3 * share, np.ones(3)) == [2, 0, 1]
    assert loop_places(2e-3 * np.array([0.0999, 0.1002, 0.5, 1.0]), np.ones(4)) == [3, 2, 0]
    assert loop_places(np.zeros(3), np.array([0.1, 1.0, 0.5])) == [1, 2, 0]


def test_the_last_whole_period():
    assert last_period(Judging(2, 1e-4, 1e-5), 9) == range(7, 9)
    assert last_period(Judging(1, 1e-4, 1e-5), 9) == range(9, 10)


def verdicts(largest, behaviour=S) -> list[Verdict]:
    found = replace(UNSTRAINED, behaviour=behaviour, flowing=1.0, remaining=2.0, periods_to_floor=3.0)
    return [replace(found, accumulated=float(value)) for value in largest]


@pytest.mark.parametrize(
    ("largest", "trend"),
    [
        (1e-3 * np.arange(1.0, 13) ** -(0.5 + NEAR), "power"),
        (1e-3 * np.arange(1.0, 13) ** -(0.5 - NEAR), "geometric"),
        (1e-3 * 0.8 ** np.arange(8), "geometric"),
        (1e-3 * (0.98 + NEAR) ** np.arange(8), "steady"),
        (1e-3 * (0.98 - NEAR) ** np.arange(8), "geometric"),
        (1e-3 * (1.02 + NEAR) ** np.arange(8), None),
        (1e-3 * 0.8 ** np.arange(3), None),
    ],
)
def test_trend_of_the_largest_strain_of_a_period(largest, trend):
    found = summary(verdicts(largest), 2, 1e-6)
    assert found["trend"] == trend
    assert found["remaining_peeq"] == (2.0 if trend == "geometric" else None)


def test_since_when_the_class_is_the_same():
    found = verdicts((3e-3, 2e-3), U) + verdicts((1e-3, 5e-4, 2.5e-4))
    assert summary(found, 2, 1e-6)["decided_at_cycle"] == 6
    assert summary(found[2:], 1, 1e-6)["decided_at_cycle"] == 1
