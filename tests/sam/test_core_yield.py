# SPDX-License-Identifier: MIT
"""Where yielding begins and what is measured of it, on both sides: von Mises stress, yield surface,
residuals, recovery.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fem_reference.axisymmetric import recovery
from fem_reference.common import elasticity
from fem_reference.common.bodies import Elastic
from fem_reference.common.plasticity import J2, CurveInUnits, History
from fem_reference.spatial import recovery as spatial
from sam.contact.convolution import Counters
from sam.contact.stress import von_mises
from sam.plasticity.flow import Material
from sam.plasticity.load_step import GivenPressure
from sam.plasticity.paper import PaperProblem
from sam.plasticity.state import MaterialFields, Trial
from sam.results.quantities import largest_mises
from sam.scene.yield_curve import Kinks, Linear, Swift
from sam.schedule import Load

YOUNG, POISSON = 210e3, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))


def principal(tensor: np.ndarray) -> float:
    """Von Mises stress from the principal stresses of (3, 3)."""
    a, b, c = np.linalg.eigvalsh(tensor)
    return float(np.sqrt(((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 2))


def test_von_mises_is_that_of_the_principal_stresses():
    for s in np.random.default_rng(3).normal(size=(5, 6)):
        s11, s22, s33, s23, s13, s12 = s
        expected = principal(np.array([[s11, s12, s13], [s12, s22, s23], [s13, s23, s33]]))
        assert von_mises(s) == pytest.approx(expected, rel=1e-12)
        axial = np.array([[s11, 0, s13], [0, s22, 0], [s13, 0, s33]])
        assert elasticity.mises(np.array([s11, s22, s33, s13])) == pytest.approx(principal(axial), rel=1e-12)


@pytest.mark.parametrize("beyond", [-1e-4, 1e-4])
def test_a_point_yields_just_beyond_its_yield_stress(beyond):
    """Pure shear with q = Y (1 + beyond): as it is below, back on the surface above."""
    strain = np.zeros((4, 1, 1))
    strain[3] = 1000.0 * (1 + beyond) / (np.sqrt(3) * SHEAR)
    update = J2(Elastic(YOUNG, POISSON), Linear(1000.0), np.ones((1, 1))).update(
        strain, History.virgin((1, 1))
    )
    q = float(elasticity.mises(update.stress)[0, 0])
    assert q == pytest.approx(1000.0 * (1 + min(beyond, 0.0)), rel=1e-9)
    assert (update.history.peeq[0, 0] > 0) == (beyond > 0)


def test_a_curve_in_other_units_is_the_same_curve():
    swift, stress, strain = Swift(945e6, 20.0, 0.121), 3e9, 0.02
    curve = CurveInUnits(swift, strain, stress)
    at = np.array([0.0, 0.1, 2.0])
    assert curve.stress(at) == pytest.approx(swift.stress(at * strain) / stress, rel=1e-12)
    step = 1e-7
    slopes = (curve.stress(at[1:] + step) - curve.stress(at[1:] - step)) / (2 * step)
    assert curve.slope(at[1:]) == pytest.approx(slopes, rel=1e-4)


def test_the_excess_is_that_of_the_stress_over_the_yield_stress():
    """In uniaxial stress of 1.2 Y after an increment that has hardened the material to Y = 1 GPa."""
    hardened = Material(80e9, Linear(0.5e9, 500e9), np.ones(1))
    x, s = np.zeros((6, 1, 1, 1)), np.zeros((6, 1, 1, 1))
    x[:3, 0, 0, 0] = 1e-3 * np.array([-0.5, -0.5, 1])
    s[:3, 0, 0, 0] = 1.2e9 * np.array([-1, -1, 2]) / 3
    flow = hardened.flow(MaterialFields.zero((1, 1, 1)))
    assert flow.excess(x, s) == pytest.approx(0.2, rel=1e-12)
    assert flow.excess(x, s / 2) == 0.0


def test_recovered_plastic_strain_is_a_tensor_in_units_of_one():
    """One element of 4 points: engineering shear halved, times the unit of strain; the accumulated one
    likewise.
    """
    points = np.array([[[0.1, 0.2, 0.1, 0.2]], [[0.1, 0.1, 0.2, 0.2]]])
    strain = np.arange(16.0).reshape(4, 1, 4) + 1
    body = SimpleNamespace(points=points, stress=lambda field, plastic: np.ones((4, 1, 4)) - 0 * plastic)
    model = SimpleNamespace(
        scales=SimpleNamespace(strain=2e-3, length=1e-5, pressure=5e9),
        plan=SimpleNamespace(bodies=SimpleNamespace(kinks=recovery.EVEN), interface=None),
        body=body,
        stress=lambda state: body.stress(state.u, state.history.plastic_strain),
    )
    history = History(strain, np.full((1, 4), 3.0))
    found = recovery.stresses(model, SimpleNamespace(history=history, u=None, yielded=True))
    for component, factor in enumerate((1, 1, 1, 0.5)):
        assert found.plastic_strain[component] == pytest.approx(factor * 2e-3 * strain[component], rel=1e-12)
    assert found.peeq == pytest.approx(np.full((1, 4), 6e-3), rel=1e-12)
    assert found.gauss == pytest.approx(np.full((4, 1, 4), 5e9), rel=1e-12)
    assert found.axis_z == pytest.approx([1e-6, 2e-6], rel=1e-9, abs=0.0)
    assert found.axis == pytest.approx(np.outer([5e9, 5e9, 5e9, 0.0], [1.0, 1.0]), rel=1e-12)


def test_top_of_a_parabola():
    x = np.array([0.2, 0.5, 0.9])
    value, place = recovery.parabola_peak(x, 3.0 - 4.0 * (x - 0.47) ** 2)
    assert place == pytest.approx(0.47, rel=1e-12) and value == pytest.approx(3.0, rel=1e-12)
    assert recovery.parabola_peak(x, np.array([1.0, 1.0, 1.0])) == (1.0, 0.5)


def test_no_parabola_goes_across_a_kink_of_the_yield_stress():
    """The largest of a soft layer, at its last point; in smooth surroundings that of a parabola."""
    z, field = np.array([0.5, 1.5, 2.5, 3.5]), np.array([0.2, 0.8, 1.0, 0.1])
    for rows, most, place in (((3.0,), 1.0, 2.5), ((1.0, 4.0), 929 / 880, 24 / 11)):
        kinks = Kinks(rows)
        flat = SimpleNamespace(kinks=kinks, axis_z=z, z=z)
        space = SimpleNamespace(kinks=kinks, x=np.zeros(1), z=z)
        snapshot = SimpleNamespace(mises=field[:, None], flowed=None)
        found = (
            recovery.largest(flat, 0 * field, field),
            spatial.largest(space, 0 * field[None, None], field[None]),
            largest_mises(z, snapshot, kinks)[::-1],
        )
        for value, depth in found:
            assert value == pytest.approx(most, rel=1e-12) and depth == pytest.approx(place, rel=1e-12)


def test_the_axis_is_reached_by_functions_even_in_r():
    """Two columns of points: 2 + 5 r^2 - 3 z is 2 - 3 z there."""
    r = np.array([[0.1, 0.3, 0.1, 0.3], [0.6, 0.8, 0.6, 0.8], [0.1, 0.3, 0.1, 0.3]])
    z = np.array([[0.1, 0.1, 0.3, 0.3], [0.1, 0.1, 0.3, 0.3], [0.6, 0.6, 0.8, 0.8]])
    depth, value = recovery.on_axis(r, z, (2 + 5 * r**2 - 3 * z)[None])
    assert depth.tolist() == [0.1, 0.3, 0.6, 0.8]
    assert value[0] == pytest.approx(2 - 3 * depth, rel=1e-12)


def test_stress_on_a_face_is_extrapolated_from_its_elements():
    """Two elements at the face, one deeper; linear in z; points that have yielded are left out."""
    r = np.array([[0.1, 0.3, 0.1, 0.3], [0.6, 0.8, 0.6, 0.8], [0.1, 0.3, 0.1, 0.3]])
    z = np.array([[0.1, 0.1, 0.3, 0.3], [0.1, 0.1, 0.3, 0.3], [0.6, 0.6, 0.8, 0.8]])
    stress = np.stack([1 + k + 2 * r - 3 * z for k in range(4)])
    part = recovery.Stresses(r, z, stress, np.zeros(0), np.zeros((4, 0)), np.zeros_like(r), np.zeros(0))
    found = recovery.on_face(part, 0.0)
    assert sorted(found[0]) == pytest.approx([1 + 2 * x for x in (0.1, 0.3, 0.6, 0.8)], rel=1e-12)
    assert found[3] == pytest.approx(found[0] + 3, rel=1e-12)
    part.peeq[0, 2] = 1e-3
    assert sorted(recovery.on_face(part, 0.0)[0]) == pytest.approx([2.2, 2.6], rel=1e-12)


def test_largest_stress_of_a_body_that_yields_is_not_beyond_its_yield_stress():
    """Uniaxial stresses on a curve over depth: its top from a parabola, but the largest value as it is where
    that has yielded.
    """
    z, q = np.array([0.1, 0.2, 0.3, 0.4]), np.array([0.6, 0.9, 1.0, 0.3])
    stress = np.zeros((6, 4, 1))
    stress[2] = -q[:, None]
    for strained, expected in ((0.0, recovery.parabola_peak(z[1:], q[1:])), (1e-3, (1.0, 0.3))):
        peak = SimpleNamespace(mises=von_mises(stress), flowed=np.full((4, 1), strained > 0))
        depth, largest = largest_mises(z, peak)
        assert (largest, depth) == pytest.approx(expected, rel=1e-12)
        assert largest == 1.0 if strained else largest > 1.02


@pytest.mark.parametrize("strained", [0.0, 1e-3])
def test_elements_that_yield_give_their_own_stress(strained):
    """In an axisymmetric and in a three-dimensional body whose stress is larger on the axis than in any
    element.
    """
    r, z = np.array([[0.1, 0.3, 0.1, 0.3]]), np.array([[0.1, 0.1, 0.3, 0.3]])
    within, axis = np.zeros((4, 1, 4)), np.zeros((4, 2))
    within[2], axis[2] = -1.0, [-1.1, -1.2]
    peeq = np.full((1, 4), strained)
    found = recovery.largest_mises(
        recovery.Stresses(r, z, within, np.array([0.1, 0.3]), axis, peeq, np.zeros(2))
    )
    assert found[0] == pytest.approx(1.0 if strained else 1.2, rel=1e-12)
    place, field, plane = np.array([0.1, 0.3]), np.zeros((6, 2, 1, 2)), np.zeros((6, 2, 2))
    field[2], plane[2] = -1.0, -1.2
    peeq = np.full((2, 1, 2), strained)
    cells = spatial.Stresses(
        place, place[:1], place, field, peeq, plane, np.zeros((2, 2)), np.zeros((6, 2)), np.zeros(2), None
    )
    assert spatial.largest_mises(cells)[0] == pytest.approx(1.0 if strained else 1.2, rel=1e-12)


def cell(*stress) -> np.ndarray:
    return np.array(stress, dtype=float).reshape(6, 1, 1, 1)


def perfect(limit: float = 1e9) -> Material:
    """A material without hardening, mu = 80 GPa."""
    return Material(80e9, Linear(limit), np.ones(1))


def test_the_return_map_of_a_cell():
    """Of a trial stress s with q = 1.3 Y: 3/2 (q - Y)/(3 m) s/q."""
    flow = perfect().flow(MaterialFields.zero((1, 1, 1)))
    trial = cell(-1, -1, 2, 0, 0, 0) * 1.3e9 / 3
    m = 40e9
    found = flow.returned(trial, m, near=np.zeros(1))
    assert found == pytest.approx(1.5 * 0.3e9 / (3 * m) * trial / 1.3e9, rel=1e-9)


class OneCell:
    """In place of a `BoxOperator`: a stress under any load, which relaxes by a number times the plastic
    strain.
    """

    layers, shape = 1, (1, 1)

    def __init__(self, elastic: np.ndarray, relaxes: float):
        self.elastic, self.relaxes = elastic, relaxes

    def keep(self, field):
        return field

    whole = transformed = response = keep

    def displacement(self, strain):
        return np.zeros((1, 1))

    def stress(self, pressure, response=None, traction=None):
        return self.elastic if response is None else -self.relaxes * response


def step_of_the_paper(elastic: np.ndarray, relaxes: float, tolerance: float) -> Trial:
    """One step of its loops from 3 N to 5 N, of an unstrained cell."""
    source = GivenPressure(lambda load: np.zeros((1, 1)), (1, 1))
    numbers = {"unit": 1.0, "tolerance": tolerance, "counters": Counters()}
    problem = PaperProblem(OneCell(elastic, relaxes), source, perfect(), **numbers)
    return problem.step(replace(problem.virgin(), load=Load(3.0)), Load(5.0))


@pytest.mark.parametrize("beyond", [5e-4, 0.3])
def test_the_paper_s_loop_relaxes_a_cell(beyond):
    """A cell that relaxes by 2 mu of its strain is on the yield surface after one return, by 3/2 (q - Y)/(3
    mu) s/q.
    """
    elastic = cell(-1, -1, 2, 0, 0, 0) / 3 * 1e9 * (1 + beyond)
    trial = step_of_the_paper(elastic, 2 * 80e9, 1e-8)
    length = trial.increment.peeq
    assert trial.converged and length == pytest.approx(beyond * 1e9 / (3 * 80e9), rel=1e-9)
    assert trial.increment.strain == pytest.approx(1.5 * length * elastic / (1e9 * (1 + beyond)), rel=1e-9)
    assert von_mises(trial.stress) == pytest.approx(1e9, rel=1e-12)


def test_excess_of_the_paper_s_loop():
    """Of what its loops leave: here a stress of 1.2 Y that nothing relaxes."""
    trial = step_of_the_paper(cell(-1, -1, 2, 0, 0, 0) / 3 * 1.2e9, 0.0, 1e-6)
    assert trial.yield_excess == pytest.approx(0.2, rel=1e-12)
    assert not trial.converged and trial.rise == 2.0
