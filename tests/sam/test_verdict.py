# SPDX-License-Identifier: MIT
"""The verdict on repeated loading: cells whose strain per period is known, either side of each limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders import scene

from sam.scene.verdict import (
    ORDER,
    UNSTRAINED,
    Behaviour,
    Judging,
    Period,
    Verdict,
    _open_strain,
    classes,
    judging_of,
    last_period,
    loop_places,
    norm_of,
    reason_without,
    summary,
    verdict_on,
)

STRAIN = np.full(1, 1e-3)  # at first yield
FLOOR, NOISE, NEAR = 1e-3, 1e-5, 1e-5  # of it, and of a limit
AXIAL = np.array([1, -0.5, -0.5, 0, 0, 0])
UNIT = np.array([1.0, -2.0, 1.0, 1.0, 1.0, 1.0]) / np.sqrt(8.0)  # de = 1, all components at work
ACROSS = np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0]) / np.sqrt(4 / 3)  # de = 1, at right angles to it
E, K, A, R = Behaviour.ELASTIC, Behaviour.SHAKEDOWN, Behaviour.ALTERNATING, Behaviour.RATCHETTING
S, U = Behaviour.SETTLING, Behaviour.UNDECIDED
AGAIN = (5e-3, 1e-3, 1e-3, 1e-3)


def period(dp, strain, restarted=None):
    return Period(dp, norm_of(strain), strain, restarted)


def periods(dp, share=0.0, direction=AXIAL):
    """Periods of one cell: dp of each; share: de over dp, a number or one for each."""
    shares, directions = np.broadcast_to(share, len(dp)), np.broadcast_to(direction, (len(dp), 6))
    rows = zip(dp, shares, directions, strict=True)
    return [period(np.full(1, p), (p * s * unit)[:, None]) for p, s, unit in rows]


def steady(share=0.01, ratio=1.0, **keys):
    """Four periods of one cell whose last three have dp of a ratio."""
    return periods((5e-3, 1e-3, 1e-3 * ratio, 1e-3 * ratio**2), share, **keys)


def falling(turn):
    """Shares of de over dp that fall to nothing by a ratio."""
    return (1.0, 0.5, 0.5 * turn, 0.5 * turn**2)


def together(*cells):
    return [
        period(np.concatenate([one.accumulated for one in each]), np.hstack([one.strain for one in each]))
        for each in zip(*cells, strict=True)
    ]


def judging(worst=R, noise=NOISE):
    return Judging(1, FLOOR, noise, worst)


def class_of(found, **how):
    total = sum(each.accumulated for each in found)
    return ORDER[classes(found, total, STRAIN, judging(**how))[0][0]]


def verdict(found, volume, **how) -> Verdict:
    n = len(volume)
    return verdict_on(found, np.ones(n), np.full(n, 1e-3), judging(**how), volume=np.array(volume))


@pytest.mark.parametrize(
    ("found", "wanted"),
    [
        (periods((0, 0, 0)), E),
        (periods((1e-3, 1e-4, 9e-7, 9e-7)), K),
        (periods((1e-3, 0, 0)), K),
        (periods((1e-3, 8e-4, 6.4e-4, 5.2e-4), 1.0), S),
        (periods(AGAIN, 0.01), A),
        (periods(AGAIN, (1, 0.5, 0.4, 0.3)), A),
        (periods(AGAIN, 0.3), R),
        (periods(AGAIN, (1, 0.3, 0.35, 0.4)), U),
        (periods(AGAIN, (1, 0.5, 0.46, 0.4232)), A),  # falls to nothing
        (periods(AGAIN, (1, 0.5, 0.4, 0.35)), U),  # falls to 0.3
        (periods(AGAIN, (1, 0.5, 0.48, 0.467)), U),  # falls to 0.44
        (periods((5e-3, 1e-3, 1e-3), 0.3), U),
        # either side of a limit
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
def test_classes_of_given_strains(found, wanted):
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


@pytest.mark.parametrize("share", [(1, 0.5, 0.4, 0.35), (1, 0.5, 0.48, 0.467), (1, 0.5, 0.499, 0.498)])
def test_where_some_back_stress_never_recovers_the_strain_of_a_period_ends(share):
    """However slowly it falls; what does not fall is undecided. Isotropic hardening ends it all."""
    assert class_of(periods(AGAIN, share), worst=A) is A
    assert class_of(periods(AGAIN, 0.5), worst=A) is U
    assert class_of(periods((5e-3, 1e-3, 9.95e-4, 9.9e-4), share), worst=S) is S


@pytest.mark.parametrize(("ratio", "wanted"), [(1.0 - NEAR, S), (1.0 + NEAR, A)])
def test_any_fall_settles_where_the_yield_stress_grows_for_ever(ratio, wanted):
    assert class_of(steady(ratio=ratio), worst=S) is wanted


def test_a_ratchet_lasts_over_half_of_all_periods():
    """What falls in the first ten periods, to more than nothing, and not in the next nine."""
    share = np.array([1.0, *(0.3 + 0.2 * 0.7 ** np.minimum(np.arange(18), 8))])
    found = periods((5e-3, *(1e-3,) * 18), share)
    assert [class_of(found[:n]) for n in range(4, 20)] == [U] * 13 + [R] * 3


@pytest.mark.parametrize("cosine", [0.99 - NEAR, 0.99 + NEAR])
@pytest.mark.parametrize("turned", [1, -1])
def test_directions_of_two_periods(cosine, turned):
    """As tensors: shears count twice. The norm of a period is that of its equivalent strain."""
    aside = np.sqrt(1 - cosine**2) * turned
    found = steady(0.5, direction=[UNIT, UNIT, UNIT, cosine * UNIT + aside * ACROSS])
    assert found[0].norm == pytest.approx(2.5e-3, rel=1e-12)
    assert found[3].norm == pytest.approx(5e-4, rel=1e-12)
    assert class_of(found) is (R if cosine > 0.99 else U)


def test_material_that_wear_has_moved_is_not_judged():
    found = periods(AGAIN, 0.3)
    moved = period(found[-2].accumulated, found[-2].strain, np.ones(1, dtype=bool))
    assert class_of([*found[:-2], moved, *found[-1:] * 2]) is U
    assert class_of([*found[:-2], moved, *found[-1:] * 3]) is R


# the body


def test_what_settles_is_told_its_end():
    """A geometric series: dp rho/(1 - rho) is still to come."""
    found, top = verdict(periods(1e-3 * 0.8 ** np.arange(5)), [2.0]), 1e-3 * 0.8**4
    assert found.behaviour is S and found.remaining == pytest.approx(top * 4)
    assert found.periods_to_floor == pytest.approx(np.log(1e-6 / top) / np.log(0.8))
    assert (found.ratio, found.flowing) == (pytest.approx(0.8), 2.0)


@pytest.mark.parametrize(("share", "wanted"), [(0.01 - 1e-7, A), (0.01 + 1e-7, R)])
def test_a_hundredth_of_the_strain_makes_the_class_of_the_body(share, wanted):
    found = verdict(together(steady(), steady(0.5)), [1 - share, share])
    assert found.behaviour is wanted and found.volumes[R] == share


@pytest.mark.parametrize(
    ("volumes", "wanted"), [((1.0, 0.02, 0.0), R), ((1.0, 0.02, 0.03), A), ((1.0, 0.2, 0.03), U)]
)
def test_cells_that_ratchet_beside_cells_that_fall_count_as_undecided(volumes, wanted):
    """One alternates, one ratchets, one leaves less each time: strain moves from cell to cell."""
    cells = periods(AGAIN), periods(AGAIN, 0.1), periods(AGAIN, (0.2, 0.195, 0.19, 0.185))
    found = verdict(together(*cells), volumes)
    assert found.behaviour is wanted and found.volumes[R] == volumes[1]
    assert (found.periods_to_decide is None) is (wanted is not U)


def test_loops_are_of_the_most_strained_point_and_near_a_half_and_a_tenth_of_it():
    for share in (np.array([0.4999, 0.5002, 1.0]), np.array([0.4998, 0.5001, 1.0])[[1, 0, 2]]):
        assert loop_places(2e-3 * share, np.ones(3)) == [2, 0, 1]
    assert loop_places(2e-3 * np.array([0.0999, 0.1002, 0.5, 1.0]), np.ones(4)) == [3, 2, 0]
    assert loop_places(np.zeros(3), np.array([0.1, 1.0, 0.5])) == [1, 2, 0]


def verdicts(largest, behaviour=S) -> list[Verdict]:
    found = replace(UNSTRAINED, behaviour=behaviour, flowing=1.0, remaining=2.0, periods_to_floor=3.0)
    return [replace(found, accumulated=float(value)) for value in largest]


@pytest.mark.parametrize(
    ("largest", "trend"),
    [
        (np.arange(1.0, 13) ** -(0.5 + NEAR), "power"),
        (np.arange(1.0, 13) ** -(0.5 - NEAR), "geometric"),
        (0.8 ** np.arange(8), "geometric"),
        ((0.98 + NEAR) ** np.arange(8), "steady"),
        ((0.98 - NEAR) ** np.arange(8), "geometric"),
        ((1.02 + NEAR) ** np.arange(8), None),
        (0.8 ** np.arange(3), None),
    ],
)
def test_trend_of_the_largest_strain_of_a_period(largest, trend):
    found = summary(verdicts(1e-3 * largest), 2, 1e-6)
    assert found["trend"] == trend
    assert found["remaining_peeq"] == (2.0 if trend == "geometric" else None)


def test_since_when_the_class_is_the_same():
    found = verdicts((3e-3, 2e-3), U) + verdicts((1e-3, 5e-4, 2.5e-4))
    assert summary(found, 2, 1e-6)["decided_at_cycle"] == 6
    assert summary(found[2:], 1, 1e-6)["decided_at_cycle"] == 1
    assert last_period(Judging(2, 1e-4, 1e-5), 9) == range(7, 9)
    assert last_period(Judging(1, 1e-4, 1e-5), 9) == range(9, 10)


# the scene


def judged(*, tolerance=1e-6, verdict=False, recovery=(0.0,), law=(), **loading):
    """A sphere whose traction alternates, 5 + 7 steps a cycle."""
    plasticity = {"law": "perfect", "yield_stress": 1e9, **dict(law)}
    if recovery:
        plasticity["kinematic"] = {"modulus": (1e9,) * len(recovery), "recovery": recovery}
    return scene(
        body={"plasticity": plasticity},
        loading={"force": 0.1, "steps": 5, "unload": True, "unload_steps": 7, "cycles": 8} | loading,
        friction={"coefficient": 0.1, "direction": "alternating"},
        solver={"tolerance": tolerance, "verdict": verdict},
    )


LAYER = {"layer_thickness": 1e-6, "layer": {"law": "perfect", "yield_stress": 1e9}}


@pytest.mark.parametrize(
    ("law", "recovery", "worst"),
    [
        ({}, (300.0, 0.0), A),
        ({}, (300.0, 1.0), R),
        ({"law": "linear", "modulus": 1e9}, (300.0, 1.0), S),
        ({"law": "linear", "modulus": 0.0}, (300.0, 1.0), R),
        (LAYER, (0.0,), R),  # Prager's law in the body bounds nothing in a layer without it
    ],
)
def test_what_a_law_lets_happen_at_worst(law, recovery, worst):
    assert judging_of(judged(law=law, recovery=recovery)).worst is worst


@pytest.mark.parametrize(("tolerance", "floor"), [(1e-6, 1e-4), (1e-4, 4e-4 * 24)])
def test_floor_follows_the_tolerance(tolerance, floor):
    """Four tolerances for each load step of a period, at least 1e-4 of the yield strain."""
    found = judging_of(judged(tolerance=tolerance))
    assert (found.period, found.floor) == (2, pytest.approx(floor))
    assert found.noise == pytest.approx(4 * tolerance * 24)


@pytest.mark.parametrize(
    ("keys", "reason"),
    [
        ({"recovery": ()}, "no [body.plasticity.kinematic], and solver.verdict is false"),
        ({"unload": False, "unload_steps": None}, "loading.unload is false"),
        ({"cycles": 7}, "loading.cycles = 7: 8 are needed, four periods"),
    ],
)
def test_why_there_is_no_verdict(keys, reason):
    assert judging_of(judged(**keys)) is None and reason_without(judged(**keys)).startswith(reason)
    assert judging_of(judged(recovery=(), verdict=True)).period == 2  # it may be asked for


def further(share, noise=1e-12, dp=1e-3):
    """Periods after which it is known whether the strain of the only cell closes, not rounded."""
    found = periods((dp,) * len(share), share)
    return _open_strain(found, found[-1].accumulated, STRAIN, judging(noise=noise / STRAIN[0]))[2][0]


def test_how_long_an_undecided_strain_is_followed():
    """De of 12 periods, of which the first does not count, as a share of dp; small is .02 of it. What falls
    by a ratio is small after so many periods; followed are half as many again as there were, unless noise
    hides its end for longer, and as many if it ends at a limit that is not small. What falls as 1/k is small
    at k = A/.02, and what stays is followed once more.
    """
    k, rate = np.arange(1, 13), -np.log(0.9)
    near, far, slow = 0.025 * 0.9 ** (k - 12), 0.5 * 0.9 ** (k - 12), 5 * 0.99 ** (k - 12)
    assert further(near) == pytest.approx(np.log(0.025 / 0.02) / rate, rel=1e-9)
    assert further(far) == pytest.approx(5.0, rel=1e-12)
    assert further(slow, noise=5e-6) == pytest.approx(2 * np.log(3) / -np.log(0.99) - 10, rel=1e-9)
    assert further(0.1 + 0.7 * 0.9**k) == pytest.approx(10.0, rel=1e-12)
    assert further(3 / k, noise=1e-40) == pytest.approx(3 / 0.02 - 12, rel=1e-9)
    assert further(np.full(12, 0.5)) == pytest.approx(10.0, rel=1e-12)


@pytest.mark.parametrize("limit", [1 - NEAR, 1 + NEAR])
def test_a_fall_to_less_than_half_of_what_there_is_counts_as_one_by_a_ratio(limit):
    """De = L + D r^k, L either side of half of the last: followed as long again, or until it is steady."""
    share = 0.3 * (limit + (2 - limit) * 0.9 ** np.arange(-11, 1))
    assert bool(further(share) < 11) is (limit < 1)


def test_periods_until_a_changing_flow_is_judged():
    """Where dp still changes by 2.50025 times what counts as steady, 4 (2.50025 - 1) more; one at least."""
    total = np.ones(1)
    assert classes(steady(0.5, ratio=1.050005), total, STRAIN, judging())[1] == 7
    assert classes(steady((1.0, 0.1, 0.03, 0.01)), total, STRAIN, judging())[1] == 1
