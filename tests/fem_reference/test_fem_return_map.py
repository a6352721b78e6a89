# SPDX-License-Identifier: MIT
"""Small-strain plasticity of the finite elements: return map, back-stresses, tangent, parts, assembly."""

import numpy as np
import pytest
from scipy.optimize import brentq
from skfem import MeshQuad

from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises
from fem_reference.common.plasticity import J2, CurveInUnits, History, Parts
from fem_reference.common.quadrilaterals import AxisymmetricSolid
from sam.scene.yield_curve import Linear, Swift, Tabulated
from tests.material_point import FemPoint, Specimen

YOUNG, POISSON = 210e3, 0.3
SHEAR, BULK = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
CURVES = {
    "swift": Swift(945.0, 20.0, 0.121),
    "linear": Linear(1000.0, YOUNG / 20),
    "perfect": Linear(1000.0),
    # not concave, so that Newton alone could leave the bracket, with steps of slope in both directions
    "table": Tabulated((0.0, 1e-3, 1.2e-3, 5e-3), (600.0, 610.0, 900.0, 950.0)),
}
# the same laws, written out a second time
BY_HAND = {
    "swift": lambda e: 945.0 * (20.0 + 1e6 * e) ** 0.121,
    "linear": lambda e: 1000.0 + YOUNG / 20 * e,
    "perfect": lambda e: 1000.0,
    "table": lambda e: float(np.interp(e, [0.0, 1e-3, 1.2e-3, 5e-3], [600.0, 610.0, 900.0, 950.0])),
}


def material(curve, shape=(1, 1), factor=1.0, shears=1):
    return J2(Elastic(YOUNG, POISSON), curve, np.full(shape, factor), shears=shears)


def column(*strain):
    return np.array(strain, dtype=float)[:, None, None]


@pytest.mark.parametrize("law", CURVES)
@pytest.mark.parametrize(("size", "factor"), [(0.013, 1.4), (0.05, 1.0)])
def test_uniaxial_strain(law, size, factor):
    """e_zz alone: q = 2 G (e - ...) with a fixed direction, so that one step is exact; root by bisection."""
    expected = brentq(
        lambda g: 2 * SHEAR * size - 3 * SHEAR * g - factor * BY_HAND[law](g), 0.0, size, xtol=1e-17
    )
    update = material(CURVES[law], factor=factor).update(column(0, 0, -size, 0), History.virgin((1, 1)))
    assert update.history.peeq[0, 0] == pytest.approx(expected, rel=1e-11)
    q = factor * BY_HAND[law](expected)
    assert mises(update.stress)[0, 0] == pytest.approx(q, rel=1e-11)
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
    assert six.loss[0, 0][np.ix_(keep, keep)] == pytest.approx(four.loss[0, 0], rel=1e-12, abs=1e-6)
    rotated = large.update(column(*e[[1, 0, 2]], e[3], 0.0, 0.0), History.virgin((1, 1), 6))
    assert mises(rotated.stress) == pytest.approx(mises(six.stress), rel=1e-14)


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


@pytest.mark.parametrize("curve", [Linear(1e9), Swift(945e6, 20.0, 0.121)], ids=["perfect", "swift"])
@pytest.mark.parametrize(
    ("law", "symmetric"),
    [(([11e9], [0.0]), True), (([400e9, 60e9, 6e9], [2000.0, 300.0, 0.0]), False)],
    ids=["prager", "chaboche"],
)
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
