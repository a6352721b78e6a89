# SPDX-License-Identifier: MIT
"""The verdict on cells whose strain per period is known."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from sam.scene import Scene
from sam.scene.verdict import (
    ORDER,
    Behaviour,
    Judging,
    Period,
    classes,
    judging_of,
    norm_of,
    reason_without,
    verdict_on,
)
from sam.scene.yield_curve import Linear
from tests.material_point import FemPoint, SamPoint, Specimen

STRAIN = np.full(1, 1e-3)  # at first yield
FLOOR, NOISE = 1e-3, 1e-5  # of it
PERFECT, PRAGER = {"law": "perfect"}, {"modulus": ("10 GPa",)}


def periods(dp, share=0.0, direction=None):
    """Periods of one cell: dp of each; share: de over dp, a number or one for each."""
    directions = np.array([1, -0.5, -0.5, 0, 0, 0]) if direction is None else direction
    shares = np.broadcast_to(share, len(dp))
    return [
        period(np.full(1, p), (p * s * np.array(unit))[:, None])
        for p, s, unit in zip(dp, shares, np.broadcast_to(directions, (len(dp), 6)), strict=True)
    ]


def period(dp, strain, restarted=None):
    """What a period added."""
    return Period(dp, norm_of(strain), strain, restarted)


def judging(worst=Behaviour.RATCHETTING, noise=NOISE):
    return Judging(1, FLOOR, noise, worst)


def class_of(found, total=1.0, **how):
    """The class of the only cell."""
    return ORDER[classes(found, np.full(1, total), STRAIN, judging(**how))[0][0]]


@pytest.mark.parametrize(
    ("dp", "share", "wanted"),
    [
        ((0, 0, 0), 0.0, Behaviour.ELASTIC),
        ((1e-3, 1e-4, 9e-7, 9e-7), 0.0, Behaviour.SHAKEDOWN),
        ((1e-3, 0, 0), 0.0, Behaviour.SHAKEDOWN),
        ((1e-3, 8e-4, 6.4e-4, 5.2e-4), 1.0, Behaviour.SETTLING),
        ((5e-3, 1e-3, 1e-3, 1e-3), 0.01, Behaviour.ALTERNATING),
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.5, 0.4, 0.3), Behaviour.ALTERNATING),
        ((5e-3, 1e-3, 1e-3, 1e-3), 0.3, Behaviour.RATCHETTING),
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.3, 0.3, 0.2999), Behaviour.UNDECIDED),  # a fall beyond noise
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.3, 0.35, 0.4), Behaviour.UNDECIDED),
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.5, 0.46, 0.4232), Behaviour.ALTERNATING),  # falls to nothing
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.5, 0.4, 0.35), Behaviour.UNDECIDED),  # falls to 0.3
        ((5e-3, 1e-3, 1e-3, 1e-3), (1, 0.5, 0.48, 0.467), Behaviour.UNDECIDED),  # falls to 0.44
        ((5e-3, 1e-3, 9.6e-4, 9.3e-4), 0.0, Behaviour.UNDECIDED),
        ((5e-3, 1e-3, 1.2e-3, 1.5e-3), 0.0, Behaviour.UNDECIDED),
        ((5e-3, 1e-3, 1e-3), 0.3, Behaviour.UNDECIDED),
    ],
)
def test_classes_of_given_strains(dp, share, wanted):
    assert class_of(periods(dp, share), total=sum(dp)) is wanted


@pytest.mark.parametrize("share", [(1, 0.5, 0.4, 0.35), (1, 0.5, 0.48, 0.467), (1, 0.5, 0.499, 0.498)])
def test_where_some_back_stress_never_recovers_the_strain_of_a_period_ends(share):
    """However slowly it falls; what does not fall is undecided. Isotropic hardening ends it all."""
    steady = periods((5e-3, 1e-3, 1e-3, 1e-3), share)
    assert class_of(steady, worst=Behaviour.ALTERNATING) is Behaviour.ALTERNATING
    assert (
        class_of(periods((5e-3, 1e-3, 1e-3, 1e-3), 0.5), worst=Behaviour.ALTERNATING) is Behaviour.UNDECIDED
    )
    falling = periods((5e-3, 1e-3, 9.95e-4, 9.9e-4), share)
    assert class_of(falling, worst=Behaviour.SETTLING) is Behaviour.SETTLING


@pytest.mark.parametrize(
    ("law", "recovery", "worst"),
    [
        ({"law": "perfect"}, (300.0, 0.0), Behaviour.ALTERNATING),
        ({"law": "perfect"}, (300.0, 1.0), Behaviour.RATCHETTING),
        ({"law": "linear", "modulus": 1e9}, (300.0, 1.0), Behaviour.SETTLING),
        ({"law": "linear", "modulus": 0.0}, (300.0, 1.0), Behaviour.RATCHETTING),
    ],
)
def test_what_a_law_lets_happen_at_worst(law, recovery, worst):
    kinematic = {"modulus": (1e9, 2e9), "recovery": recovery}
    assert judging_of(judged_scene(law=law, kinematic=kinematic)).worst is worst


def test_a_layer_that_may_ratchet_is_seen():
    """Prager's law in the body bounds nothing in a layer without it."""
    layer = {"layer_thickness": 1e-6, "layer": {"law": "perfect", "yield_stress": 1e9}}
    assert judging_of(judged_scene(law={"law": "perfect"} | layer)).worst is Behaviour.RATCHETTING


def classes_of(ends):
    """After each period between the plastic strains and accumulated ones of a material point."""
    added = [period(np.full(1, p1 - p0), (e1 - e0)[:, None]) for (e0, p0), (e1, p1) in pairwise(ends)]
    return [class_of(added[: k + 1]) for k in range(len(added))]


@pytest.mark.parametrize("model", [SamPoint, FemPoint])
@pytest.mark.parametrize("held", [True, False], ids=["tension-and-torsion", "given-stress"])
def test_a_ratchet_of_armstrong_and_frederick_is_found_at_once(model, held):
    """Between 1300 and -1200 MPa it leaves (1/g) ln[(S^2 - x2^2)/(S^2 - x1^2)] in each cycle from the first
    on, S = C/g, x = stress less or plus Y; so does a shear strain that goes to and fro below 300 MPa of held
    tension. Found from the fourth on, as a strain that lasts.
    """
    specimen, ends = Specimen(model(Linear(1e9), [150e9], [300.0])), [(np.zeros(6), 0.0)]
    if held:
        specimen.to(stress={0: 300e6})
    for _ in range(10):
        if held:
            for gamma in (*np.linspace(0.0, 0.015, 5)[1:], *np.linspace(0.015, -0.015, 9)[1:], 0.0):
                specimen.to(strain={5: gamma}, stress={0: 300e6})
        else:
            for stress in (1300e6, -1200e6):
                specimen.to(stress={0: stress})
        ends.append(specimen.point.plastic)
    found = classes_of(ends)
    assert found == [Behaviour.UNDECIDED] * 3 + [Behaviour.RATCHETTING] * 7


@pytest.mark.parametrize("ratio", [0.9, 0.97, 0.99, 0.997])
@pytest.mark.parametrize("seed", range(4))
def test_a_strain_that_falls_to_nothing_is_never_taken_for_a_ratchet(ratio, seed):
    """Whatever noise within its bound; it alternates, or is undecided for about as long as is said."""
    rng, count = np.random.default_rng(seed), 800
    share = 0.3 * ratio ** np.arange(count) + 1e-5 * rng.uniform(-0.5, 0.5, count)
    found = periods((5e-3, *(1e-3,) * (count - 1)), np.abs(share))
    numbers = [*range(4, 40), *range(40, count, 20)]
    said = [verdict_on(found[:n], np.ones(1), STRAIN, judging(), volume=np.ones(1)) for n in numbers]
    decided = [each.behaviour is Behaviour.ALTERNATING for each in said]
    assert {each.behaviour for each in said} <= {Behaviour.ALTERNATING, Behaviour.UNDECIDED}
    assert decided[-1]
    needed = numbers[decided.index(True)]
    for n, each in zip(numbers, said, strict=True):
        if n < needed:
            assert n + each.periods_to_decide > needed / 1.5, (n, needed)


def test_strain_that_turns_does_not_ratchet():
    """The same size in each period, but another direction."""
    directions = [(1, -0.5, -0.5, 0, 0, 0), (0, 0, 0, 0, 0, 0.866)] * 2
    assert class_of(periods((1e-3,) * 4, 0.5, directions)) is Behaviour.UNDECIDED
    assert class_of(periods((1e-3,) * 4, 0.5)) is Behaviour.RATCHETTING


def test_material_that_wear_has_moved_is_not_judged():
    found = periods((5e-3, 1e-3, 1e-3, 1e-3), 0.3)
    moved = period(found[-2].accumulated, found[-2].strain, np.ones(1, dtype=bool))
    assert class_of([*found[:-2], moved, found[-1]]) is Behaviour.UNDECIDED
    assert class_of([*found[:-2], moved, *found[-1:] * 2]) is Behaviour.UNDECIDED
    assert class_of([*found[:-2], moved, *found[-1:] * 3]) is Behaviour.RATCHETTING


def test_what_settles_is_told_its_end():
    """A geometric series: dp rho/(1 - rho) is still to come."""
    found = verdict_on(
        periods(1e-3 * 0.8 ** np.arange(5)), np.ones(1), STRAIN, judging(), volume=np.full(1, 2.0)
    )
    top = 1e-3 * 0.8**4
    assert found.behaviour is Behaviour.SETTLING
    assert found.remaining == pytest.approx(top * 4)
    assert found.periods_to_floor == pytest.approx(np.log(1e-6 / top) / np.log(0.8))
    assert (found.ratio, found.flowing) == (pytest.approx(0.8), 2.0)


def test_the_body_has_the_worst_class_that_carries_its_share():
    """A ratchetting cell that carries less than a hundredth is not the body's class; its volume is given."""
    alternating, ratchets = periods((5e-3, 1e-3, 1e-3, 1e-3)), periods((5e-3, 1e-3, 1e-3, 1e-3), 0.5)
    both = [
        period(np.append(a.accumulated, b.accumulated), np.hstack([a.strain, b.strain]))
        for a, b in zip(alternating, ratchets, strict=True)
    ]
    total, strain = np.ones(2), np.full(2, 1e-3)
    small = verdict_on(both, total, strain, judging(), volume=np.array([1.0, 0.005]))
    assert (small.behaviour, small.volumes[Behaviour.RATCHETTING]) == (Behaviour.ALTERNATING, 0.005)
    large = verdict_on(both, total, strain, judging(), volume=np.array([1.0, 0.02]))
    assert large.behaviour is Behaviour.RATCHETTING


@pytest.mark.parametrize(
    ("volumes", "wanted"),
    [
        ((1.0, 0.02, 0.0), Behaviour.RATCHETTING),
        ((1.0, 0.02, 0.03), Behaviour.ALTERNATING),
        ((1.0, 0.2, 0.03), Behaviour.UNDECIDED),
    ],
)
def test_cells_that_ratchet_beside_cells_that_fall_count_as_undecided(volumes, wanted):
    """One alternates, one ratchets, one leaves less each time: strain moves from cell to cell."""
    dp = (5e-3, 1e-3, 1e-3, 1e-3)
    cells = [periods(dp), periods(dp, 0.1), periods(dp, (0.2, 0.195, 0.19, 0.185))]
    all_of_them = [
        period(np.concatenate([one.accumulated for one in each]), np.hstack([one.strain for one in each]))
        for each in zip(*cells, strict=True)
    ]
    found = verdict_on(all_of_them, np.ones(3), np.full(3, 1e-3), judging(), volume=np.array(volumes))
    assert found.behaviour is wanted and found.volumes[Behaviour.RATCHETTING] == volumes[1]
    assert (found.periods_to_decide is None) is (wanted is not Behaviour.UNDECIDED)


def test_floor_follows_the_tolerance():
    """Four tolerances for each load step of a period, at least 1e-4 of the yield strain."""
    for tolerance, wanted in ((1e-6, 1e-4), (1e-4, 4e-4 * 24)):
        found = judging_of(judged_scene(tolerance=tolerance))
        assert (found.period, found.floor) == (2, pytest.approx(wanted))
        assert found.noise == pytest.approx(4 * tolerance * 24)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"kinematic": None}, "no [body.plasticity.kinematic], and solver.verdict is false"),
        ({"unload": False}, "loading.unload is false"),
        ({"cycles": 7}, "loading.cycles = 7: 8 are needed, four periods"),
    ],
)
def test_why_there_is_no_verdict(changed, reason):
    scene = judged_scene(**changed)
    assert judging_of(scene) is None and reason_without(scene).startswith(reason)


def test_verdict_may_be_asked_for():
    assert judging_of(judged_scene(kinematic=None, verdict=True)).period == 2


def judged_scene(*, tolerance=1e-6, verdict=False, kinematic=PRAGER, law=PERFECT, unload=True, cycles=8):
    """A sphere whose traction alternates, 5 + 7 steps a cycle."""
    plasticity = {"yield_stress": 1e9} | law | ({"kinematic": kinematic} if kinematic else {})
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        counterbody={"shape": "sphere", "radius": 1e-4},
        loading={
            "force": 0.1,
            "steps": 5,
            "unload": unload,
            "unload_steps": 7 if unload else None,
            "cycles": cycles,
        },
        friction={"coefficient": 0.1, "direction": "alternating"},
        solver={"tolerance": tolerance, "verdict": verdict},
    )
