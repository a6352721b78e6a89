# SPDX-License-Identifier: MIT
"""Finite strain and true geometry: closed forms, consistent tangents, and limits of the model."""

import numpy as np
import pytest
from builders import scene as small_scene
from rounding import EPS
from scipy.optimize import brentq
from skfem import MeshQuad

from fem_reference.common.bodies import Elastic
from fem_reference.common.plasticity import J2, History
from fem_reference.common.quadrilaterals import AxisymmetricSolid
from fem_reference.common.schedule import Load
from fem_reference.finite_strain import model as study
from fem_reference.finite_strain.kinematics import (
    GradientOperator,
    deformation,
    exponential_change,
    logarithm,
)
from fem_reference.finite_strain.material import Hencky
from sam.scene.yield_curve import Linear, Swift
from verification.cases.limits import model_limits

YOUNG, POISSON = 200.0, 0.3
CURVES = {
    "elastic": Linear(np.inf),
    "perfect": Linear(1.0),
    "linear": Linear(1.0, 20.0),
    "swift": Swift(2.0, 0.01, 0.3, 1.0),
}
ONE = (1, 1)


def hencky(curve, strain=1.0):
    return Hencky(J2(Elastic(YOUNG, POISSON), curve, np.ones(ONE)), strain)


def at_point(*gradient):
    return np.array(gradient, dtype=float).reshape(*ONE, 5)


def scene(force, cells=8, poisson=0.3, **plasticity):
    return small_scene(
        body={"young": 1.0, "poisson": poisson, "plasticity": plasticity or None},
        counterbody={"radius": 1.0},
        loading={"force": force},
        fem={"cells_per_radius": cells, "box": 10.0},
    )


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("stretch", [0.4, 0.99, 2.5])
def test_uniaxial_stress_is_that_of_logarithmic_strains(name, stretch):
    """Along z in one step: t = E (ln stretch - e_p), |t| <= Y(|e_p|), and no lateral stress."""
    material, total = hencky(CURVES[name]), np.log(stretch)

    def lateral(r):
        return material.update(
            at_point(np.exp(r) - 1.0, np.exp(r) - 1.0, stretch - 1.0, 0.0, 0.0), History.virgin(ONE)
        )

    r = brentq(lambda r: lateral(r).kirchhoff[0, 0, 1], -1.5 * abs(total), 1.5 * abs(total), xtol=1e-15)
    update = lateral(r)
    peeq = float(update.history.peeq[0, 0])
    expected = YOUNG * (total - np.sign(total) * peeq)
    assert update.stress[0, 0, 2] == pytest.approx(expected / stretch, rel=1e-9)
    assert r == pytest.approx(-0.5 * np.sign(total) * peeq - POISSON * expected / YOUNG, rel=1e-9)
    if peeq:
        assert abs(expected) == pytest.approx(float(CURVES[name].stress(peeq)), rel=1e-9)
    else:
        assert abs(expected) <= CURVES[name].stress(0.0)


@pytest.mark.parametrize("name", CURVES)
def test_a_rotation_of_the_plane_turns_the_stress_and_changes_nothing_else(name):
    """F -> Q F: P -> Q P, and the plastic deformation, which is of the undeformed body, stays."""
    material, angle = hencky(CURVES[name]), 1.1
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    F = np.array([[1.2, 0.3], [-0.1, 0.8]])
    both = [material.update(of_plane(f, 1.05), History.virgin(ONE)) for f in (F, turn @ F)]
    before, after = (update.stress[0, 0][[0, 3, 4, 2]].reshape(2, 2) for update in both)
    assert after == pytest.approx(turn @ before, abs=1e-12 * np.abs(before).max())
    assert both[1].history.plastic_strain == pytest.approx(both[0].history.plastic_strain, abs=1e-13)
    assert material.update(of_plane(turn, 1.0), History.virgin(ONE)).stress == pytest.approx(
        0.0, abs=1e-12 * YOUNG
    )


def of_plane(F, hoop):
    return at_point(F[0, 0] - 1.0, hoop - 1.0, F[1, 1] - 1.0, F[0, 1], F[1, 0])


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("strain", [1.0, 0.05])
def test_the_tangent_is_the_derivative_of_the_stress_and_symmetric(name, strain):
    """Central differences at a second step, from a history with shear."""
    material = hencky(CURVES[name], strain)
    first = at_point(0.03, -0.02, -0.04, 0.05, -0.02) / strain
    history = material.update(first, History.virgin(ONE)).history
    at = first + at_point(0.02, 0.01, -0.05, -0.03, 0.06) / strain
    tangent, h = material.update(at, history).tangent[0, 0], 1e-6 / strain
    shifted = [
        [material.update(at + sign * h * e, history).stress[0, 0] for sign in (1, -1)] for e in np.eye(5)
    ]
    differences = np.array([(plus - minus) / (2.0 * h) for plus, minus in shifted]).T
    assert tangent == pytest.approx(differences, abs=2e-7 * np.abs(tangent).max())
    assert tangent == pytest.approx(tangent.T, abs=1e-12 * np.abs(tangent).max())


def test_the_tangent_without_deformation_is_that_of_small_strain():
    """Equal stretches: no axes are preferred."""
    material = hencky(CURVES["elastic"])
    tangent = material.update(at_point(0, 0, 0, 0, 0), History.virgin(ONE)).tangent[0, 0]
    strains = np.array([[1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 1, 1]])
    assert tangent == pytest.approx(strains.T @ material.small.stiffness @ strains, abs=1e-12 * YOUNG)


def test_logarithm_and_exponential_are_inverse_also_of_equal_values():
    """Twelve elementary functions of numbers up to 2, to 4 EPS each."""
    tensors = np.array(
        [[0.3, -0.2, 0.1, 0.4], [0.2, 0.2, 0.2, 0.0], [-0.5, 0.1, 0.5, 0.0], [0.0, 0.0, 0.0, 1e-9]]
    )
    exponentials = np.add(exponential_change(tensors), [1.0, 1.0, 1.0, 0.0])
    assert logarithm(exponentials) == pytest.approx(tensors, abs=12 * 4 * EPS)


def test_a_patch_of_distorted_elements_carries_a_uniform_state_exactly():
    """u_r = a r, u_z = b z: uniform, and the inner nodes are in balance."""
    mesh = MeshQuad.init_tensor(np.array([0.5, 0.9, 1.4, 2.0]), np.array([0.0, 0.4, 1.0]))
    solid = AxisymmetricSolid(mesh, Elastic(YOUNG, POISSON))
    operator = GradientOperator(solid.basis, solid.weights)
    r, z = solid.basis.doflocs
    radial = np.isin(np.arange(solid.size), solid.basis.get_dofs(elements=True).all("u^1"))
    gradient = operator.gradient(np.where(radial, 0.2 * r, -0.3 * z))
    assert gradient == pytest.approx(np.broadcast_to([0.2, 0.2, -0.3, 0.0, 0.0], gradient.shape), abs=1e-13)
    material = Hencky(J2(Elastic(YOUNG, POISSON), CURVES["perfect"], np.ones(gradient.shape[:2])), 1.0)
    force = operator.nodal_forces(material.update(gradient, History.virgin(gradient.shape[:2])).stress)
    inner = (r > 0.5) & (r < 2.0) & (z > 0.0) & (z < 1.0)
    assert force[inner] == pytest.approx(0.0, abs=1e-12 * np.abs(force).max())
    plane, hoop = deformation(gradient, 1.0)
    volume = np.linalg.det(plane + np.eye(2)) * (1.0 + hoop) * solid.weights
    assert volume.sum() == pytest.approx(np.pi * 1.2**2 * 0.7 * (2.0**2 - 0.5**2), rel=1e-12)


@pytest.mark.parametrize("law, force", [({}, 1e-3), ({"law": "perfect", "yield_stress": 1e-2}, 1e-4)])
def test_the_tangent_of_the_contact_problem_is_the_derivative_of_its_forces(law, force):
    """Body alone; the curvature of the sphere shows in Newton's method, see the next test."""
    model = study.build(scene(force, 4, **law), "finite")
    state = study.load_to(model, [0.5, 1.0])[0].state
    rng = np.random.default_rng(1)
    direction, h = rng.standard_normal(state.u.size), 1e-6
    u = state.u + 0.01 * rng.standard_normal(state.u.size)
    plus, minus = (model.problem.respond(u + sign * h * direction, state.history).force for sign in (1, -1))
    exact = model.problem.respond(u, state.history).tangent @ direction
    assert (plus - minus) / (2.0 * h) == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())


@pytest.mark.parametrize("kind", ["sphere", "finite"])
def test_newtons_method_converges_quadratically(kind):
    """At a/R = 0.19, the last iterations with the same nodes in contact."""
    state = study.load_to(study.build(scene(1e-2, 6), kind), [0.5, 1.0])[-1].state
    assert state.converged and state.steady >= 2
    before, after = state.residuals[-2:]
    assert after <= max(5.0 * before**2, 1e-11)


def test_a_state_that_is_turned_inside_out_is_not_converged():
    """Ten times the radius of the sphere in one step: an error of the step, no answer."""
    model = study.build(scene(1e3, 4), "finite")
    assert not model.load(Load(model.scales.peak_force), model.virgin()).converged


X = np.linspace(0.1, 0.4, 7)


def test_a_limit_is_where_the_fit_passes_five_per_cent():
    fit = model_limits.Difference.of(X, -0.1 * X - 0.5 * X**2)
    limit = fit.limit()
    assert -0.1 * limit - 0.5 * limit**2 == pytest.approx(-model_limits.LIMIT, abs=1e-4)
    assert fit.limit(1.0) == fit.limit(-1.0) == fit.good_to() == limit


def test_a_limit_is_beyond_the_largest_contact_when_it_is_not_passed():
    fit = model_limits.Difference.of(X, 0.1 * X)
    assert fit.limit() == np.inf and fit.good_to() == 0.4 and model_limits.words(fit) == "> 0.40"


def test_differences_are_at_equal_force_and_of_resolved_contacts():
    force = np.linspace(0.1, 1.0, 10)
    flat = study.Curve(force, 0.2 * force, force, force, np.zeros(10))
    finite = study.Curve(force, 0.3 * force, 1.02 * force, 0.9 * force, np.zeros(10))
    found = model_limits.differences({"flat": flat, "finite": finite}, 12)
    assert set(found) == {"pressure", "radius", "approach"}  # no plastic strain, no ratio
    assert found["approach"].values == pytest.approx(0.02) and found["pressure"].values == pytest.approx(-0.1)
    assert found["radius"].x.min() >= 0.5 * found["radius"].x.max()
    assert found["radius"].x.max() == pytest.approx(0.3)
