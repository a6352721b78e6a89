# SPDX-License-Identifier: MIT
"""Back-stresses at a material point, in the return maps of both models: against closed forms, and where they
have to agree with other laws.

Closed forms with constant yield stress Y, S = C/g: a loop of strain with the plastic amplitude e has the
stress amplitude Y + sum S tanh(g e) (+ C e for g = 0). Between stresses smax and smin one Armstrong-Frederick
back-stress ratchets by ln((S^2 - (smin + Y)^2)/(S^2 - (smax - Y)^2))/g in each cycle.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from sam.plasticity.flow import BackStresses, BackStressFields, deviator, kinematic_multiplier, mises
from sam.scene.yield_curve import Linear, Swift
from tests.material_point import MU, POINTS, YOUNG, FemPoint, SamPoint, Specimen

PERFECT = Linear(1e9)
PRAGER = ([YOUNG / 19], [0.0])
ARMSTRONG_FREDERICK = ([150e9], [300.0])
CHABOCHE = ([400e9, 60e9, 6e9], [2000.0, 300.0, 0.0])
BOTH = pytest.mark.parametrize("model", POINTS)


@BOTH
@pytest.mark.parametrize("steps", [1, 5])
def test_prager_between_given_strains(model, steps):
    """E/(1 + E/C) = E/20 beyond yield: +-1055 MPa at +-1 %."""
    specimen, plastic = Specimen(POINTS[model](PERFECT, *PRAGER)), 0.01 - 1055e6 / YOUNG
    found = specimen.by_strain(0, (0.01, -0.01, 0.01), steps)
    wanted = [(sign * 1055e6, sign * plastic) for sign in (1, -1, 1)]
    assert np.ravel(found) == pytest.approx(np.ravel(wanted), rel=1e-9)
    assert specimen.point.plastic[1] == pytest.approx(5 * plastic, rel=1e-9)


@BOTH
@pytest.mark.parametrize("steps", [1, 4])
@pytest.mark.parametrize(
    ("law", "component", "end"),
    [(ARMSTRONG_FREDERICK, 0, 0.01), (CHABOCHE, 0, 0.01), (ARMSTRONG_FREDERICK, 5, 0.0075)],
    ids=["one", "three", "shear"],
)
def test_stable_loop_between_given_strains(model, steps, law, component, end):
    """The amplitudes of stress and plastic strain satisfy the closed form, in any number of steps."""
    specimen = Specimen(POINTS[model](PERFECT, *law))
    stress, plastic = specimen.by_strain(component, (end, -end) * 20, steps)[-1]
    root3 = np.sqrt(3) if component else 1.0  # shear: tau sqrt(3), and 2 eps_p/sqrt(3)
    stress, plastic = -stress * root3, -plastic * (2 / root3 if component else 1.0)
    saturating = [C / g * np.tanh(g * plastic) if g else C * plastic for C, g in zip(*law, strict=True)]
    assert stress == pytest.approx(1e9 + sum(saturating), rel=1e-7)
    if not component:
        assert plastic == pytest.approx(end - stress / YOUNG, rel=1e-9)


@BOTH
@pytest.mark.parametrize("steps", [1, 3])
@pytest.mark.parametrize(
    ("smax", "smin"), [(1.3e9, -1.2e9), (1.4e9, -1.2e9), (1.3e9, -1.3e9), (1.2e9, -1.3e9)]
)
def test_ratchetting_between_given_stresses(model, steps, smax, smin):
    """The same step in each cycle, backward for a negative mean, none without a mean."""
    specimen, saturation = Specimen(POINTS[model](PERFECT, *ARMSTRONG_FREDERICK)), 150e9 / 300
    ends = []
    for _ in range(3):
        for start, end in ((smin, smax), (smax, smin)):
            for share in np.arange(1, steps + 1) / steps:
                specimen.to(stress={0: start + share * (end - start) if ends else share * end})
        ends.append(specimen.point.plastic[0][0])
    wanted = np.log((saturation**2 - (smin + 1e9) ** 2) / (saturation**2 - (smax - 1e9) ** 2)) / 300
    assert [b - a for a, b in pairwise(ends)] == pytest.approx([wanted] * 2, rel=1e-6, abs=1e-12)


def test_both_models_turn_alike():
    """A circle of strain (axial and shear, a quarter out of phase): the direction of flow turns in each step,
    which the closed forms never do; both models make the same error.
    """
    found = []
    for point in (SamPoint(PERFECT, *CHABOCHE), FemPoint(PERFECT, *CHABOCHE)):
        specimen = Specimen(point)
        for angle in np.linspace(0, 2 * np.pi, 25):
            specimen.to(strain={0: 0.01 * np.cos(angle), 5: 0.0075 * np.sin(angle)})
        found.append((*specimen.stress[[0, 5]], *point.plastic[0][[0, 5]], point.plastic[1]))
    assert found[0] == pytest.approx(found[1], rel=1e-9)


@BOTH
def test_first_loading_with_prager_is_isotropic_hardening(model):
    """Linear kinematic and linear isotropic hardening differ after a reversal only, at any factor."""
    kinematic = Specimen(POINTS[model](PERFECT, *PRAGER, factor=0.7))
    isotropic = Specimen(POINTS[model](Linear(1e9, YOUNG / 19), [1.0], [0.0], factor=0.7))
    one, other = (each.by_strain(0, (0.01, -0.01)) for each in (kinematic, isotropic))
    assert one[0] == pytest.approx(other[0], rel=1e-8)
    assert abs(one[1][0]) < 0.95 * abs(other[1][0])


@BOTH
def test_equal_back_stresses_add(model):
    """Three parts with the same recovery are one."""
    parts = Specimen(POINTS[model](PERFECT, [50e9, 70e9, 30e9], [300.0] * 3))
    whole = Specimen(POINTS[model](PERFECT, *ARMSTRONG_FREDERICK))
    ends = (0.01, -0.01, 0.004)
    assert np.ravel(parts.by_strain(0, ends)) == pytest.approx(np.ravel(whole.by_strain(0, ends)), rel=1e-10)


@BOTH
def test_saturated_back_stress_is_a_higher_yield_stress(model):
    """After p = 20/g the stress is Y + C/g, up to exp(-20)."""
    specimen = Specimen(POINTS[model](PERFECT, [20e9], [100.0]))
    ((stress, _),) = specimen.by_strain(0, (0.25,), 10)
    assert stress == pytest.approx(1.2e9, rel=1e-9)


@pytest.mark.parametrize("law", [ARMSTRONG_FREDERICK, CHABOCHE], ids=["one", "three"])
@pytest.mark.parametrize("curve", [PERFECT, Swift(945e6, 20.0, 0.121)], ids=["perfect", "swift"])
def test_return_map_is_the_same_for_every_stiffness(law, curve):
    """A fixed point of the return map of SAM is one for any m > 0."""
    rng = np.random.default_rng(7)
    point = SamPoint(curve, *law)
    specimen = Specimen(point)
    for _ in range(4):
        specimen.to(strain=dict(enumerate(0.01 * rng.standard_normal(6))))
    trial = 4e9 * rng.standard_normal((6, 1, 1, 1))
    trial[:3] -= trial[:3].mean()
    flow = point.material.flow(point.state)
    x = flow.returned(trial, MU, near=np.zeros(1))
    s = trial - 2 * MU * x
    assert flow.excess(x, s) < 1e-12
    for share in (0.3, 0.5, 3.0):
        again = flow.returned(s + 2 * share * MU * x, share * MU, near=np.zeros(1))
        assert again == pytest.approx(x, rel=1e-10)


def test_a_back_stress_that_is_left_out_is_seen():
    """The right increment with the back-stress of another state is not one."""
    point = SamPoint(PERFECT, *ARMSTRONG_FREDERICK)
    specimen = Specimen(point)
    specimen.by_strain(0, (0.01, -0.01))
    trial = np.zeros((6, 1, 1, 1))
    trial[:3, 0, 0, 0] = 2e9 * np.array([2, -1, -1]) / 3
    flow = point.material.flow(point.state)
    x = flow.returned(trial, MU, near=np.zeros(1))
    assert flow.excess(x, trial - 2 * MU * x) < 1e-12
    other = point.material.flow(point.material.virgin((1, 1, 1)))
    assert 2 * MU * np.abs(other.returned(trial, MU, near=np.zeros(1)) - x).max() > 0.05e9


@pytest.mark.parametrize("closeness", [0.0, 1e-8, 1.0])
@pytest.mark.parametrize("law", [PRAGER, ARMSTRONG_FREDERICK, CHABOCHE, ([1e12], [100.0])])
def test_multiplier_takes_few_iterations(law, closeness):
    """From anywhere on or close to the root: rounding ends Newton's method, and the yield condition holds to
    rounding of the stresses.
    """
    rng, n = np.random.default_rng(5), 4000
    modulus, recovery = (np.tile(np.reshape(values, (-1, 1)), n) for values in law)
    back, calls = BackStressFields(modulus, recovery), []
    ball = np.where(recovery > 0, modulus / np.maximum(recovery, 1.0), 1e9) * rng.uniform(0, 1, modulus.shape)
    start = ball[:, None] * unit_deviators(rng, (len(modulus), n))
    trial = start.sum(axis=0) + 1e9 * (1 + 10.0 ** rng.uniform(-9, 1, n)) * unit_deviators(rng, (n,))

    def curve(gamma):
        calls.append(gamma)
        return 1e9 + 1e9 * gamma, np.full(n, 1e9)

    solve = partial(kinematic_multiplier, trial, BackStresses.of(start), back, m3=1.5 * MU)
    root = solve(curve, near=np.zeros(n))[0]
    calls.clear()
    gamma, eta = solve(curve, near=root * (1 + closeness * rng.uniform(-1, 1, n)))
    assert len(calls) <= 12
    left = mises(eta) - 1.5 * MU * gamma - (modulus * back.recovered(gamma)[1]).sum(axis=0) - curve(gamma)[0]
    assert np.abs(left).max() < 1e-14 * (mises(trial) + ball.sum(axis=0)).max()
    assert np.abs(gamma / root - 1).max() < 1e-6


def unit_deviators(rng, shape):
    """Deviators of random directions and von Mises stress 1, (..., 6, n)."""
    found = deviator(rng.normal(size=(6, *shape)))
    return np.moveaxis(found / mises(found), 0, -2)
