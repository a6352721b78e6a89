# SPDX-License-Identifier: MIT
"""A material point in the return maps of both models: closed forms, tangents, energies, layers of other laws.

With constant yield stress Y and S = C/g a loop of strain with the plastic amplitude e has the stress
amplitude Y + sum S tanh(g e) (+ C e for g = 0).
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from builders import HARDENING, SWIFT as SWIFT_LAW, YIELD_CURVE, scene, scene_text
from scipy.optimize import brentq
from skfem import MeshQuad

import fem_reference
import sam
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises as fem_mises
from fem_reference.common.plasticity import J2, CurveInUnits, History, Parts
from fem_reference.common.quadrilaterals import AxisymmetricSolid
from fem_reference.spatial.planner import plan as spatial_plan
from sam.plasticity.flow import (
    BackStresses,
    BackStressFields,
    deviator,
    kinematic_multiplier,
    mises,
    plastic_multiplier,
)
from sam.scene import Plasticity, load_scene, plastic_work, step_energies, stored_energy
from sam.scene.body import LAWS
from sam.scene.yield_curve import DepthProfile, Kinks, Linear, Strength, Swift, Tabulated
from tests.material_point import BULK, MU, POINTS, POISSON, YOUNG, FemPoint, SamPoint, Specimen
from verification.checks.material import yield_stress

PERFECT, SWIFT = Linear(1e9), Swift(945e6, 20.0, 0.121)
CURVES = {
    "swift": SWIFT,
    "linear": Linear(1e9, 10.5e9),
    "perfect": PERFECT,
    "table": Tabulated((0.0, 1e-3, 5e-3), (1e9, 1.4e9, 1.5e9)),
    # so that Newton alone could leave the bracket, with steps of slope in both directions
    "convex table": Tabulated((0.0, 1e-3, 2e-3), (1e9, 1.01e9, 2e9)),
}
BY_HAND = {
    "swift": lambda e: 945e6 * (20.0 + 1e6 * e) ** 0.121,
    "linear": lambda e: 1e9 + 10.5e9 * e,
    "perfect": lambda e: 1e9,
    "table": lambda e: float(np.interp(e, [0.0, 1e-3, 5e-3], [1e9, 1.4e9, 1.5e9])),
    "convex table": lambda e: float(np.interp(e, [0.0, 1e-3, 2e-3], [1e9, 1.01e9, 2e9])),
}
"""The same laws, written out a second time."""


@pytest.mark.parametrize("name", CURVES)
def test_plastic_multiplier_solves_the_return_map(name):
    """q - 3 m g = factor sigma_y(alpha + g), by a bracketing root finder, from yield to ten times it."""
    curve, m3, factor = CURVES[name], 3 * 80.8e9, np.full(5, 0.8)
    for alpha in (0.0, 7e-4, 3e-3):
        q = (0.8 * float(curve.stress(alpha))) * np.array([0.5, 1.0 + 1e-9, 1.01, 2.0, 10.0])
        solve = partial(plastic_multiplier, q, np.full(5, alpha), curve, factor, m3=m3)
        found = solve()
        assert found[0] == 0.0
        for near in (0.5, 2.0):
            assert solve(near=near * found) == pytest.approx(found, rel=1e-12, abs=1e-17)
        for value, gamma in zip(q[1:], found[1:], strict=True):

            def excess(g, value=value, alpha=alpha):
                return value - m3 * g - 0.8 * float(curve.stress(alpha + g))

            exact = brentq(excess, 0.0, value / m3, xtol=1e-18, rtol=1e-14)
            assert gamma == pytest.approx(exact, rel=1e-9, abs=1e-17)


# of finite elements


def material(curve, shape=(1, 1), factor=1.0, shears=1):
    return J2(Elastic(YOUNG, POISSON), curve, np.full(shape, factor), shears=shears)


def column(*strain):
    return np.array(strain, dtype=float)[:, None, None]


@pytest.mark.parametrize("law", CURVES)
@pytest.mark.parametrize(("size", "factor"), [(0.013, 1.4), (0.05, 1.0)])
def test_uniaxial_strain(law, size, factor):
    """e_zz alone: q = 2 G (e - ...) with a fixed direction, so that one step is exact; root by bisection."""
    expected = brentq(lambda g: 2 * MU * size - 3 * MU * g - factor * BY_HAND[law](g), 0.0, size, xtol=1e-17)
    update = material(CURVES[law], factor=factor).update(column(0, 0, -size, 0), History.virgin((1, 1)))
    assert update.history.peeq[0, 0] == pytest.approx(expected, rel=1e-11)
    q = factor * BY_HAND[law](expected)
    assert fem_mises(update.stress)[0, 0] == pytest.approx(q, rel=1e-11)
    assert update.stress[2, 0, 0] == pytest.approx(-BULK * size - 2 / 3 * q, rel=1e-11)
    flow = expected * np.array([0.5, 0.5, -1, 0])
    assert update.history.plastic_strain[:, 0, 0] == pytest.approx(flow, rel=1e-11)


def test_elastic_inside_the_yield_surface():
    """Below yield, and on the way back: nothing changes, not even the object; no loss of stiffness."""
    start, body = History.virgin((1, 1)), material(CURVES["perfect"])
    update = body.update(column(0, 0, -0.007, 0), start)
    assert update.history.yielded
    assert body.update(column(0, 0, -0.006, 0), start).history is start
    back = body.update(column(0, 0, -0.002, 0), update.history)
    assert back.history is update.history and back.elements.size == 0
    again = body.update(column(0, 0, -0.007, 0), update.history)
    assert again.history is update.history  # reloading to the same strain


@pytest.mark.parametrize("shears", [1, 3])
@pytest.mark.parametrize("law", CURVES)
def test_consistent_tangent(law, shears):
    """Central differences of the stress, steps of 1e-6 of a strain of 1e-2: their own error is about 1e-8."""
    count, body = 3 + shears, material(CURVES[law], (40, 1), shears=shears)
    first, second = 0.008 * np.random.default_rng(11).standard_normal((2, count, 40, 1))
    start, strain = body.update(first, History.virgin((40, 1), count)).history, first + second
    update = body.update(strain, start)
    assert 20 < update.elements.size <= 40
    tangent = body.stiffness - update.loss[:, 0]
    for k in range(count):
        step = np.zeros_like(strain)
        step[k] = 1e-8
        difference = body.update(strain + step, start).stress - body.update(strain - step, start).stress
        assert np.abs(difference[:, update.elements, 0].T / 2e-8 - tangent[:, :, k]).max() < 1e-6 * YOUNG


def test_six_components_yield_as_four():
    """A path in the plane y = 0 in three dimensions is the axisymmetric one: same history to rounding."""
    small, large = (material(CURVES["swift"], shears=shears) for shears in (1, 3))
    e = np.array([0.004, -0.001, -0.02, 0.015])
    four = small.update(column(*e), History.virgin((1, 1)))
    six = large.update(column(*e[:3], 0.0, e[3], 0.0), History.virgin((1, 1), 6))
    keep = [0, 1, 2, 4]
    assert six.history.peeq == pytest.approx(four.history.peeq, rel=1e-14)
    assert six.stress[keep] == pytest.approx(four.stress, rel=1e-13)
    assert six.loss[0, 0][np.ix_(keep, keep)] == pytest.approx(four.loss[0, 0], rel=1e-12, abs=1.0)
    rotated = large.update(column(*e[[1, 0, 2]], e[3], 0.0, 0.0), History.virgin((1, 1), 6))
    assert fem_mises(rotated.stress) == pytest.approx(fem_mises(six.stress), rel=1e-14)


def test_curve_in_other_units():
    """Strains in units of 1e-2, stresses in units of 5: values and slopes (chain rule) of the curve."""
    curve, e = CURVES["swift"], np.array([0.0, 0.3, 2.0])
    scaled = CurveInUnits(curve, 1e-2, 5.0)
    assert scaled.stress(e) == pytest.approx([BY_HAND["swift"](x * 1e-2) / 5 for x in e], rel=1e-14)
    assert scaled.slope(e) == pytest.approx(curve.slope(e * 1e-2) * 1e-2 / 5, rel=1e-14)


def test_parts_are_their_materials():
    """Element by element the return map of each material; what never yields keeps Hooke's law."""
    rng = np.random.default_rng(5)
    strain = rng.normal(size=(4, 6, 4))
    inside = np.array([True, False, True, False, False, True])
    ones = np.ones((3, 4))
    laws = [
        (inside, J2(Elastic(0.4, 0.2), Linear(0.3), ones)),
        (~inside, J2(Elastic(1.0, POISSON), Swift(0.1, 1.0, 0.2, 10.0), ones)),
    ]
    both = Parts(laws)
    start = History(0.1 * rng.normal(size=(4, 6, 4)), np.abs(rng.normal(size=(6, 4))))
    update = both.update(strain, start)
    assert both.shape == (6, 4)
    for elements, law in laws:
        alone = law.update(strain[:, elements], start.of(elements))
        assert np.array_equal(update.stress[:, elements], alone.stress)
        assert np.array_equal(update.history.peeq[elements], alone.history.peeq)
        numbers = np.flatnonzero(elements)[alone.elements]
        assert np.array_equal(update.loss[np.isin(update.elements, numbers)], alone.loss)
        spent = law.dissipated(start.of(elements), alone.history)
        assert np.array_equal(both.dissipated(start, update.history)[elements], spent)
        assert np.array_equal(both.yield_strain[elements], law.yield_strain)
    assert both.excess(update.stress, update.history).max() < 1e-12
    never = Parts([(inside, J2(Elastic(0.4, 0.2), Linear(np.inf), ones)), laws[1]])
    hooke = np.einsum("st,teq->seq", never.parts[0][1].stiffness, (strain - start.plastic_strain)[:, inside])
    assert np.array_equal(never.update(strain, start).stress[:, inside], hooke)
    still = never.update(np.zeros_like(strain), History.virgin((6, 4)))
    assert not still.elements.size and not still.history.yielded


def test_softened_is_the_derivative_of_the_internal_force():
    """Central differences of the assembled force of a quarter of a hollow sphere of which a part yields."""
    mesh = MeshQuad.init_tensor(np.linspace(1.0, 2.0, 5), np.linspace(0.0, np.pi / 2, 5))
    radius, angle = mesh.p
    mesh = MeshQuad(radius * np.array([np.sin(angle), np.cos(angle)]), mesh.t)
    solid = AxisymmetricSolid(mesh, Elastic(YOUNG, POISSON))
    body, start = material(CURVES["linear"], solid.points.shape[1:]), History.virgin(solid.points.shape[1:])
    rng = np.random.default_rng(5)
    u = 0.004 * solid.basis.doflocs[0] * rng.standard_normal(solid.size)
    v = rng.standard_normal(solid.size)
    update = body.update(solid.strain(u), start)
    assert 0 < update.elements.size <= 16
    force = [solid.internal_force(body.update(solid.strain(u + s * 1e-8 * v), start).stress) for s in (1, -1)]
    exact = solid.softened(update.elements, update.loss) @ v
    assert np.abs((force[0] - force[1]) / 2e-8 - exact).max() < 1e-6 * np.abs(exact).max()
    assert np.abs(solid.stiffness @ v - exact).max() > 0.05 * np.abs(exact).max()


# back-stresses

PRAGER = ([YOUNG / 19], [0.0])
ONE = ([150e9], [300.0])
THREE = ([400e9, 60e9, 6e9], [2000.0, 300.0, 0.0])
BOTH = pytest.mark.parametrize("model", POINTS)


@BOTH
@pytest.mark.parametrize(("law", "component", "end"), [(THREE, 0, 0.02), (ONE, 5, 0.015)])
def test_stable_loop_between_given_strains(model, law, component, end):
    """The amplitudes of stress and plastic strain satisfy the closed form, in any number of steps."""
    specimen = Specimen(POINTS[model](PERFECT, *law))
    for value in (end, -end) * 5:
        specimen.to({component: value})
    stress, plastic = specimen.stress[component], specimen.point.plastic[0][component]
    root3 = np.sqrt(3) if component else 1.0  # shear: tau sqrt(3), and 2 eps_p/sqrt(3)
    stress, plastic = -stress * root3, -plastic * (2 / root3 if component else 1.0)
    saturating = [C / g * np.tanh(g * plastic) if g else C * plastic for C, g in zip(*law, strict=True)]
    assert stress == pytest.approx(1e9 + sum(saturating), rel=1e-7)


@pytest.mark.parametrize("law", [ONE, THREE], ids=["one", "three"])
@pytest.mark.parametrize("curve", [PERFECT, SWIFT], ids=["perfect", "swift"])
def test_return_map_is_the_same_for_every_stiffness(law, curve):
    """A fixed point of the return map of SAM is one for any m > 0."""
    rng, point = np.random.default_rng(7), SamPoint(curve, *law)
    for _ in range(4):
        point.state = point.at(0.01 * rng.standard_normal(6))[1]
    trial = 4e9 * rng.standard_normal((6, 1, 1, 1))
    trial[:3] -= trial[:3].mean()
    flow = point.material.flow(point.state)
    x = flow.returned(trial, MU, near=np.zeros(1))
    s = trial - 2 * MU * x
    assert flow.excess(x, s) < 1e-12
    for share in (0.3, 3.0):
        again = flow.returned(s + 2 * share * MU * x, share * MU, near=np.zeros(1))
        assert again == pytest.approx(x, rel=1e-10)


@pytest.mark.parametrize("closeness", [0.0, 1.0])
@pytest.mark.parametrize("law", [PRAGER, THREE, ([1e12], [100.0])])
def test_multiplier_takes_few_iterations(law, closeness):
    """From anywhere on or close to the root: rounding ends Newton's method."""
    rng, n = np.random.default_rng(5), 1000
    modulus, recovery = (np.tile(np.reshape(values, (-1, 1)), n) for values in law)
    back, calls = BackStressFields(modulus, recovery), []

    def unit_deviators(shape):
        """Deviators of random directions and von Mises stress 1, (..., 6, n)."""
        found = deviator(rng.normal(size=(6, *shape)))
        return np.moveaxis(found / mises(found), 0, -2)

    ball = np.where(recovery > 0, modulus / np.maximum(recovery, 1.0), 1e9) * rng.uniform(0, 1, modulus.shape)
    start = ball[:, None] * unit_deviators((len(modulus), n))
    trial = start.sum(axis=0) + 1e9 * (1 + 10.0 ** rng.uniform(-9, 1, n)) * unit_deviators((n,))

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


@pytest.mark.parametrize("curve", [PERFECT, SWIFT], ids=["perfect", "swift"])
@pytest.mark.parametrize(("law", "symmetric"), [(PRAGER, True), (THREE, False)], ids=["prager", "three"])
def test_tangent_with_back_stresses_is_the_derivative_of_the_stress(curve, law, symmetric):
    """With Prager's law exactly; else it is the symmetric part of the derivative."""
    rng = np.random.default_rng(3)
    point = FemPoint(curve, *law)
    specimen = Specimen(point)
    for _ in range(4):
        specimen.to(dict(enumerate(0.01 * rng.standard_normal(6))))
    start = point.state
    at = (specimen.strain + 0.02 * rng.standard_normal(6)) * [1, 1, 1, 2, 2, 2]

    def stress(engineering):
        return point.material.update(engineering.reshape(6, 1, 1), start).stress.ravel()

    tangent = point.material.stiffness - point.material.update(at.reshape(6, 1, 1), start).loss[0, 0]
    columns = []
    for unit in 1e-5 * np.eye(6):
        near, far = (stress(at + n * unit) - stress(at - n * unit) for n in (1, 2))
        columns.append((8 * near - far) / 12e-5)  # of fourth order
    derivative, scale = np.array(columns).T, np.abs(tangent).max()
    assert np.abs(tangent - tangent.T).max() < 1e-12 * scale
    assert np.abs(tangent - (derivative + derivative.T) / 2).max() < 2e-9 * scale
    skew = np.abs(derivative - derivative.T).max() / scale
    assert skew < 2e-9 if symmetric else skew > 1e-5


# what plastic strain dissipates and what back-stresses store: exact over a step

EXTREME = ([1e12, 6e9], [1e7, 1e-3])
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def constants(law, like):
    """C_k and g_k of a shape that broadcasts with fields of the dimension of one of the a_k."""
    return [np.reshape(np.array(values, dtype=float), (-1, *[1] * (like.ndim - 2))) for values in law]


@BOTH
@pytest.mark.parametrize("law", [PRAGER, THREE, EXTREME])
def test_work_of_the_stress_is_what_is_stored_and_dissipated(model, law):
    """To rounding in random states, strains from 0.1 to 10 %; dissipation and error are never negative."""
    rng = np.random.default_rng(3)
    for size in (1e-3, 1e-2, 1e-1):
        point = POINTS[model](SWIFT, *law)
        for _ in range(5):
            before, total = point.state, point.plastic
            stress, point.state = point.at(size * rng.standard_normal(6))
            s, now = stress - [*[stress[:3].mean()] * 3, 0, 0, 0], point.plastic
            x, length = now[0] - total[0], point.state.peeq - before.peeq
            if not length.item():
                continue
            C, g = constants(law, before.back)
            found = step_energies(C, g, before.back, x.reshape(before.back.shape[1:]), length=length)
            work = float(TWICE @ (s * x))
            parts = SWIFT.stress(now[1]) * length + found.stored + found.dissipated + found.error
            assert parts.item() == pytest.approx(work, rel=1e-11)
            change = stored_energy(C, point.state.back) - stored_energy(C, before.back)
            assert found.stored.item() == pytest.approx(change.item(), abs=1e-11 * work)
            assert found.dissipated.item() >= 0 and found.error.item() >= 0


@pytest.mark.parametrize("size", [1e-7, 1e-4, 0.1])
@pytest.mark.parametrize("law", [PRAGER, THREE, EXTREME])
def test_a_straight_step_dissipates_what_its_parts_do(law, size):
    """Energies are exact in any number of steps along a direction; their error falls with the steps."""
    point = SamPoint(PERFECT, *law)
    for strain in ((0.01, -0.003, -0.007, 0, 0.004, 0), (-0.02, 0.01, 0.01, 0.003, 0, 0)):
        point.state = point.at(np.array(strain))[1]
    N, start = np.array([1, -0.5, -0.5, 0, 0, 0]).reshape(6, 1, 1, 1), point.state.back
    C, g = constants(law, start)
    dp = np.full((1, 1, 1), size)
    whole, parts, back = step_energies(C, g, start, size * N, length=dp), [], start
    for _ in range(5):
        parts.append(step_energies(C, g, back, size / 5 * N, length=dp / 5))
        back = back + point.material.back.change(back, size / 5 * N, dp / 5)
    assert whole.stored == pytest.approx(sum(each.stored for each in parts), rel=1e-9, abs=1e-6)
    assert whole.dissipated == pytest.approx(sum(each.dissipated for each in parts), rel=1e-12)
    assert 0 < sum(each.error for each in parts) < (1 + 1e-9) * whole.error


@pytest.mark.parametrize("ends", [(0.0, 1e-7), (1e-3, 0.3)])
def test_work_of_swifts_law_is_its_closed_form(ends):
    law = Swift(1780e6, 4.0, 0.095, 1e6)
    before, after = (law.stress(np.array(end)) * (law.C + law.alpha * end) for end in ends)
    exact = (after - before) / law.alpha / (law.n + 1)
    assert plastic_work(law, np.array(ends[1]), ends[0]) == pytest.approx(exact, rel=1e-7)


# a layer with a hardening law of its own

THICK = 1.2e-6
DEPTHS = np.array([0.0, 0.4e-6, 1.1999e-6, 1.2e-6, 3e-6])


@pytest.mark.parametrize("law", LAWS)
class TestEveryLaw:
    """The body hardens linearly, its factor goes from 2 at the surface to 1 at 3 um."""

    @pytest.fixture
    def read(self, law, tmp_path):
        (tmp_path / "curve.csv").write_text(YIELD_CURVE)
        (tmp_path / "p.csv").write_text("depth_m,factor\n0,2\n3e-6,1\n")
        body = "[body.plasticity]\n" + HARDENING["linear"] + 'profile = "p.csv"\nlayer_thickness = "1.2 um"\n'
        text = scene_text(add=body + "[body.plasticity.layer]\n" + HARDENING[law])
        (tmp_path / "scene.toml").write_text(text)
        return load_scene(tmp_path / "scene.toml")

    def test_holds_above_the_thickness_and_the_law_of_the_body_below(self, read, law):
        plasticity, peeq = read.body.plasticity, np.array([[0.0], [2e-4], [0.013]])
        own = Plasticity(**plasticity.layer.model_dump()).curve().stress(peeq)
        expected = (2.0 - DEPTHS / 3e-6) * np.where(DEPTHS < THICK, own, 1e9 + 10.5e9 * peeq)
        np.testing.assert_allclose(plasticity.strength().stress(DEPTHS, peeq), expected, rtol=1e-15)
        checked = yield_stress(read, *np.broadcast_arrays(peeq, DEPTHS))
        np.testing.assert_allclose(checked, expected, rtol=1e-14)

    def test_both_return_maps_end_on_the_curve_of_the_point(self, read, law):
        """At a point of each region the stress after a step is the yield stress of the checks."""
        strength, shear = read.body.plasticity.strength(), 80e9
        z, strained = np.array([0.4e-6, 2e-6]), np.array([1e-3, 2e-3])
        factor, curve = strength.profile(z), strength.curve_at(z)
        q = 1.5 * factor * curve.stress(strained)
        gamma = plastic_multiplier(q, strained, curve, factor, m3=3 * shear)
        limit = yield_stress(read, strained + gamma, z)
        assert (gamma > 1e-4).all()
        np.testing.assert_allclose(q - 3 * shear * gamma, limit, rtol=1e-13)
        body = J2(Elastic(2.6 * shear, 0.3), strength.curve_at(z[:, None]), factor[:, None])
        strain = np.zeros((4, 2, 1))
        strain[3, :, 0] = q / shear / np.sqrt(3.0)  # engineering shear
        update = body.update(strain, History(np.zeros((4, 2, 1)), strained[:, None]))
        np.testing.assert_allclose(update.history.peeq[:, 0] - strained, gamma, rtol=1e-11)
        np.testing.assert_allclose(np.sqrt(3.0) * update.stress[3, :, 0], limit, rtol=1e-12)


def test_kinks_are_the_rows_and_the_lower_side_of_another_law():
    graded = DepthProfile((0.0, 1e-6), (2.0, 1.0))
    assert Strength(SWIFT, graded, PERFECT, 2e-6).kinks == Kinks((0.0, 1e-6, 2e-6))
    assert Strength(SWIFT, graded, PERFECT, 1e-6).kinks == Strength(SWIFT, graded, SWIFT, 9e-6).kinks


@pytest.mark.parametrize("ends, own", [((2.0, 1.0), 0.5e9), ((0.5, 1.0), 9e9)])
def test_the_least_yield_stress_is_found_on_both_sides_of_the_lower_side(ends, own):
    least = Strength(PERFECT, DepthProfile((0.0, 4e-6), ends), Linear(own), 2e-6).least(0.0)
    assert least == pytest.approx(0.75e9, rel=1e-12)


SOFT = {"layer_thickness": THICK, "layer": SWIFT_LAW | {"alpha": 1e3}}
ROUGH = {
    "surface": {"kind": "sinusoid", "amplitude": 0.1e-6, "wavelength_x": 16e-6, "wavelength_y": 16e-6},
    "counterbody": {"shape": "flat"},
    "grid": {"cells": (16, 16), "extent": (16e-6, 16e-6)},
}


@pytest.mark.parametrize("tables", [{}, ROUGH], ids=["smooth", "rough"])
def test_every_model_has_faces_at_the_kinks_below_smooth_and_rough_bodies(tables):
    body = {"plasticity": SWIFT_LAW | SOFT | {"profile": ((0.7e-6, 2.0), (THICK, 1.0))}}
    found = scene(body=body, fem={"cells_per_radius": 8, "box": 4.0}, **tables)
    faces, space = sam.plan(found).grid.faces, spatial_plan(found)
    assert {0.7e-6, THICK} <= set(faces) and (np.diff(faces) > 0).all()
    planes = [space.lines.z * space.scales.length]
    if not tables:
        flat = fem_reference.plan(found)
        planes.append(flat.z * flat.scales.length)
    for each in planes:
        assert max(np.abs(each - kink).min() for kink in (0.7e-6, THICK)) < 1e-12 * THICK


def test_a_soft_layer_makes_a_body_yield_that_would_not():
    """The largest von Mises stress of the elastic contact is half the yield stress of the body."""
    hard = {"law": "perfect", "yield_stress": 6e9, "layer_thickness": 3e-6}
    small = {"loading": {"force": 0.15, "steps": 1}, "grid": {"cells": (17, 17)}}
    alone = sam.solve(scene(body={"plasticity": hard}, **small))
    weak = {"layer": {"law": "perfect", "yield_stress": 2e9}}
    layered = sam.solve(scene(body={"plasticity": hard | weak}, **small))
    assert alone.quantities["peeq_max"] == 0.0 < layered.quantities["peeq_max_depth_m"] < 3e-6
