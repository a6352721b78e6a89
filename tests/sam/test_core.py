# SPDX-License-Identifier: MIT
"""Single parts of both models against formulas: scales, waves in layers, means, yield surface."""

import itertools
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from builders import MODULUS, PERFECT, SPHERE, SWIFT as SWIFT_LAW, scene
from scipy.integrate import quad

import sam
from fem_reference.axisymmetric import recovery
from fem_reference.common import elasticity, recovery as common_recovery
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.hertz import (
    hertz_pressure,
    largest_mises,
    peak_force,
    plastic_radius,
    relative_moduli,
    scales,
)
from fem_reference.common.layered_force import _across
from fem_reference.common.mesh_lines import Lines
from fem_reference.common.plasticity import J2, History
from fem_reference.common.schedule import Load as FemLoad
from fem_reference.spatial import recovery as spatial
from sam.contact.convolution import Counters
from sam.contact.operators import CoatedPair, von_mises
from sam.elastic.problem import GivenHertz
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants, ElasticPair
from sam.kernels.patches import Cuboids, Lags, stress_coefficients
from sam.layered.patches import Layers, normal_compliance
from sam.plasticity.cell_means import NEAR, mean_stress_of_load
from sam.plasticity.flow import Material
from sam.plasticity.load_step import GivenPressure
from sam.plasticity.paper import PaperProblem
from sam.plasticity.state import MaterialFields, Trial
from sam.results import tables
from sam.results.history import Box, Sliding
from sam.scene.yield_curve import Kinks, Linear
from sam.schedule import Load
from verification.reference.hertz import effective_modulus, largest_von_mises

# the scales of a contact

RADIUS, FORCE = SPHERE["radius"], 0.65
SOFT = {"young": 70e9, "poisson": 0.2}
GIVEN = {"prescribed": "hertz", "p0": 2e9, "radius": 1e-5}


@pytest.mark.parametrize("counter", [{}, SOFT])
def test_sphere_carries_the_force_at_its_approach(counter):
    """F = 4/3 E* sqrt(R) d^(3/2) with a^2 = R d."""
    given = scene(counterbody=counter)
    unit, young = scales(given), relative_moduli(given)
    modulus = effective_modulus(210e9, 0.3, *counter.values())
    assert unit.modulus == pytest.approx(modulus, rel=1e-12)
    assert 4 / 3 * modulus * np.sqrt(RADIUS) * unit.displacement**1.5 == pytest.approx(FORCE, rel=1e-12)
    assert unit.length**2 == pytest.approx(RADIUS * unit.displacement, rel=1e-12, abs=0.0)
    assert unit.peak_force * unit.pressure * unit.length**2 == pytest.approx(FORCE, rel=1e-12)
    assert young[0] * modulus == pytest.approx(210e9, rel=1e-12)
    assert not counter or young[1] * modulus == pytest.approx(70e9, rel=1e-12)


def test_punch_and_given_pressure_carry_theirs():
    """A punch F = 2 a E* d; a pressure of Hertz displaces its centre by pi a p0/(2 E*) and sums to 2/3 pi
    a^2 p0. An ellipsoid takes the mean radius.
    """
    punch = scales(scene(counterbody={"shape": "punch", "radius": 2e-5}))
    assert 2 * 2e-5 * MODULUS * punch.displacement == pytest.approx(FORCE, rel=1e-12)
    assert punch.peak_force * punch.pressure * punch.length**2 == pytest.approx(FORCE, rel=1e-12)
    assert punch.length == 2e-5
    pressed = scene(loading=GIVEN)
    total = quad(lambda r: 2e9 * np.sqrt(1 - (r / 1e-5) ** 2) * 2 * np.pi * r, 0, 1e-5, epsabs=0.0)[0]
    unit = scales(pressed)
    assert peak_force(pressed) == pytest.approx(total, rel=1e-9)
    assert unit.peak_force * unit.pressure * unit.length**2 == pytest.approx(total, rel=1e-9)
    centre = 2e9 * quad(lambda r: np.sqrt(1 - r * r), 0, 1)[0] * 2e-5 / MODULUS  # a ring gives 2 p dr/E*
    assert unit.displacement == pytest.approx(centre, rel=1e-9, abs=0.0)
    curved = {"shape": "ellipsoid", "radius_x": 4 * RADIUS, "radius_y": RADIUS / 4}
    assert scales(scene(counterbody=curved)) == scales(scene())
    total = quad(lambda r: float(hertz_pressure(np.array(r))) * 2 * np.pi * r, 0, 1)[0]
    assert total == pytest.approx(1.0, rel=1e-7)
    assert hertz_pressure(np.array([1.0, 2.0])).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_largest_mises_is_that_of_the_axis(poisson):
    assert largest_mises(poisson) == pytest.approx(largest_von_mises(1.0, 1.0, poisson)[0], rel=1e-5)


def of_yield(stress):
    """(scene, plastic radius in m) of perfect plasticity."""
    found = scene(body={"plasticity": {"law": "perfect", "yield_stress": stress}})
    radius = plastic_radius(found)
    return None if radius is None else radius * scales(found).length


def test_radius_of_a_contact_that_yields():
    """A soft body carries three yield stresses; a harder one a cavity, Johnson 1985, Eq. 6.33: p/Y = 2/3 (1 +
    ln(...)) + 2/3, with the slope a/R of the sphere. Yielding begins where the largest von Mises stress does.
    """
    assert FORCE / (np.pi * of_yield(1e8) ** 2) == pytest.approx(3e8, rel=1e-12)
    stress, tangent = 2e9, scales(scene()).length / RADIUS
    inside = (210e9 / (1 - 0.09) * tangent / stress + 4 * (1 - 0.6)) / (6 * 0.7)
    mean = FORCE / (np.pi * of_yield(stress) ** 2)
    assert mean / stress == pytest.approx(2 / 3 * (1 + np.log(inside)) + 2 / 3, rel=1e-12)
    limit = largest_mises(0.3) * (1.5 * FORCE / (np.pi * scales(scene()).length ** 2))
    assert of_yield(limit * (1 + 1e-9)) is None and of_yield(limit * (1 - 1e-6)) is not None


def test_radius_with_hardening():
    """The yield stress is that at Tabor's strain, 0.2 a/R; no radius is below that of Hertz."""
    body = {"plasticity": SWIFT_LAW}
    slope = (0.75 * 4.0 / (210e9 / 0.91) * 1e-4) ** (1 / 3) / 1e-4
    limit = 945e6 * (20 + 1e6 * 0.2 * slope) ** 0.121
    cavity = 2 / 3 * (2 + np.log((210e9 / 0.91 * slope / limit + 1.6) / 4.2))
    radius = np.sqrt(4.0 / (np.pi * limit * min(cavity, 3.0)))
    sphere = scene(body=body, counterbody={"radius": 1e-4}, loading={"force": 4.0})
    assert plastic_radius(sphere) == pytest.approx(radius / (slope * 1e-4), rel=1e-12)
    assert plastic_radius(scene(body=body, loading=GIVEN | {"p0": 6e9})) == 1.0
    barely = {"plasticity": PERFECT | {"yield_stress": 4.5e9}}
    assert plastic_radius(scene(body=barely, counterbody={"radius": 1e-4}, loading={"force": 0.4})) == 1.0


def test_a_load_of_finite_elements_is_halved_between_two():
    start, end = FemLoad(2.0, 0.1, x=1.0, y=5.0), FemLoad(6.0, 0.3, x=2.0, y=-1.0)
    assert end.halfway(start, 1.0) == FemLoad(4.0, 0.3, x=1.5, y=2.0)
    assert end.halfway(FemLoad(0.0, 0.1, x=7.0), 1.0) == FemLoad(3.0, 0.3, x=2.0, y=-1.0)
    for from_none in (FemLoad(0.0), FemLoad(0.0, approach=1.0)):  # unloaded, or apart at an approach
        assert FemLoad(6.0, approach=2.0).halfway(from_none, 1.0).approach == 1.5


# between coefficients and solvers


@pytest.mark.parametrize("load", [1, 3])
def test_stress_of_a_load_is_the_mean_over_the_observed_cell(load):
    """Of 2 x 2 x 2 Gauss points: near as they are, up to the last lags from the values at centres."""
    aspect, faces, n = 0.8, np.array([0.0, 0.5, 1.3]), NEAR + 5
    lags = Lags(n, n, 1.0, aspect)
    found = mean_stress_of_load(Cuboids(lags, tuple(faces), 0.3), load)
    scale = np.abs(found).max(axis=(0, 1))  # of each lag
    middle, half = (faces[1:] + faces[:-1])[:, None] / 2, np.diff(faces)[:, None] / 2
    depths = (middle + half * np.array([-1, 1]) / np.sqrt(3)).ravel()
    expected = [
        stress_coefficients(lags, depths, 0.3, load=load, shift=(x, aspect * y)).reshape(6, 2, 2, n, n)
        for x, y in itertools.product(np.array([-0.5, 0.5]) / np.sqrt(3), repeat=2)
    ]
    off = np.abs(found - np.mean(expected, axis=0).mean(axis=2)) / scale
    assert off[..., :NEAR, :NEAR].max() <= 1e-12
    assert off[..., NEAR + 3 :, NEAR + 3 :].max() <= 1e-6


def test_waves_across_a_film():
    """Antiplane shear of a film on a body, written out: no jump at the interface, unit traction."""
    body, coating = Elastic(3.0, 0.25), Coating(young=1.0, poisson=0.3, thickness=0.4)
    mu1, mu2 = 1.0 / 2.6, 3.0 / 2.5
    k, z = np.array([0.3, 2.0]), np.array([0.0, 0.1, 0.39, 0.7])
    found = _across(coating, body, k, z)
    for row, wave in enumerate(k):
        down, up, tail = np.exp(-wave * 0.4), np.exp(wave * 0.4), np.exp(-wave * 0.4)
        system = [[mu1 * wave, -mu1 * wave, 0], [down, up, -tail], [-mu1 * down, mu1 * up, mu2 * tail]]
        a, b, c = np.linalg.solve(system, [1.0, 0.0, 0.0])
        coated = np.where(z < 0.4, a * np.exp(-wave * z) + b * np.exp(wave * z), c * np.exp(-wave * z))
        assert found[row] == pytest.approx(coated - np.exp(-wave * z) / (mu2 * wave), rel=1e-10, abs=1e-14)


def test_compliance_of_a_film_of_the_material_of_its_body():
    """With that of the counter-body, of two half-spaces: 2/(E* k)."""
    k, body, other = np.array([1e4, 1e6, 1e8]), (1 - 0.3**2) / 210e9, (1 - 0.2**2) / 70e9
    layered = SimpleNamespace(response=partial(normal_compliance, Layers(210e9, 0.3, 1e-6, 210e9, 0.3)))
    pair = ElasticPair(ElasticConstants(210e9, 0.3), ElasticConstants(70e9, 0.2))
    found = CoatedPair(layered, pair, 1e-6).response(k)
    assert found == pytest.approx(2 * (body + other) / k, rel=1e-9, abs=0.0)


def test_shear_that_plastic_flow_carries_the_surface_by():
    """-2 times the integral of the component 13 over depth, and the residual displacement."""
    strain, zero = np.arange(1.0, 37.0).reshape(6, 2, 3, 1), np.zeros((3, 1))
    sliding = Sliding(zero, zero + 5.0, zero, zero, zero).strained(zero + 2.0, strain, np.array([0.5, 0.25]))
    assert sliding.shear == pytest.approx(-2 * (0.5 * strain[4, 0] + 0.25 * strain[4, 1]), rel=1e-12)
    assert sliding.ux == pytest.approx(zero + 7.0) and sliding.residual_ux == pytest.approx(zero + 2.0)


def test_given_pressure_lowers_the_surface_as_hertz_s():
    """pi p0 a (1 - nu^2)/(2 E) in the centre (Johnson 1985, Eq. 3.41a), to 3e-4 with 27 cells in a."""
    plan = sam.plan(scene(loading=GIVEN, grid={"cells": (65, 65), "extent": (24e-6, 24e-6)}))
    found = plan.problem(Counters()).contact(Load(plan.schedule.peak.force))
    expected = np.pi * 2e9 * 10e-6 / 2 * (1 - 0.3**2) / 210e9
    assert found.displacement.max() == pytest.approx(expected, rel=3e-4, abs=0.0)


def test_given_pressure_is_the_mean_over_each_cell():
    """Of eight times eight points each, about the place of the load, in proportion to its force."""
    given, grid = GivenHertz(3.0, 2.0), CellGrid(13, 11, 0.5, 0.6, np.zeros(1))
    assert given.peak_force == pytest.approx(8 * np.pi, rel=1e-12)
    part = (np.arange(8) - 3.5) / 8
    x, y = grid.x[:, None] - 0.3 + 0.5 * part, grid.y[:, None] + 0.2 + 0.6 * part
    inside = np.maximum(1 - (x[:, :, None, None] ** 2 + y**2) / 4, 0.0)
    expected = 1.5 * np.sqrt(inside).mean(axis=(1, 3))
    found = given.pressure(grid, Load(4 * np.pi, x=0.3, y=-0.2))
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_lines_of_a_block():
    """Areas of the surface nodes sum to that of the surface; a half block carries half of every force."""
    x, y, z = np.array([-1.0, 0.5, 2.0, 2.5]), np.array([0.0, 0.4, 1.0]), np.array([0.0, 1.0])
    lines = Lines(x, y, z, half=True)
    assert lines.areas.sum() == pytest.approx(3.5, rel=1e-12)
    assert lines.areas[1, 1] == pytest.approx(1.5 * 0.5, rel=1e-12) and lines.shape == (3, 2, 1)
    assert lines.share == 0.5 and Lines(x, y, z, half=False).share == 1.0


# the yield surface

SHEAR = 210e3 / 2.6


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
    law = J2(Elastic(210e3, 0.3), Linear(1000.0), np.ones((1, 1)))
    update = law.update(strain, History.virgin((1, 1)))
    q = float(elasticity.mises(update.stress)[0, 0])
    assert q == pytest.approx(1000.0 * (1 + min(beyond, 0.0)), rel=1e-9)
    assert (update.history.peeq[0, 0] > 0) == (beyond > 0)


def cell(*stress) -> np.ndarray:
    return np.array(stress, dtype=float).reshape(6, 1, 1, 1)


AXIAL = cell(-1, -1, 2, 0, 0, 0) / 3


def perfect() -> Material:
    """A material without hardening, Y = 1 GPa, mu = 80 GPa."""
    return Material(80e9, Linear(1e9), np.ones(1))


def test_the_excess_is_that_of_the_stress_over_the_yield_stress():
    """In uniaxial stress of 1.2 Y after an increment that has hardened the material to Y = 1 GPa."""
    flow = Material(80e9, Linear(0.5e9, 500e9), np.ones(1)).flow(MaterialFields.zero((1, 1, 1)))
    x = 1e-3 * cell(-0.5, -0.5, 1, 0, 0, 0)
    assert flow.excess(x, 1.2e9 * AXIAL) == pytest.approx(0.2, rel=1e-12)
    assert flow.excess(x, 0.6e9 * AXIAL) == 0.0


def test_the_return_map_of_a_cell():
    """Of a trial stress s with q = 1.3 Y: 3/2 (q - Y)/(3 m) s/q."""
    flow, m = perfect().flow(MaterialFields.zero((1, 1, 1))), 40e9
    found = flow.returned(1.3e9 * AXIAL, m, near=np.zeros(1))
    assert found == pytest.approx(1.5 * 0.3e9 / (3 * m) * AXIAL, rel=1e-9)


class OneCell:
    """In place of a `BoxOperator`: a stress that relaxes by a number times the plastic strain."""

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
    """By 2 mu of its strain: one return of 3/2 (q - Y)/(3 mu) s/q; by nothing: the excess stays."""
    trial = step_of_the_paper(1e9 * (1 + beyond) * AXIAL, 2 * 80e9, 1e-8)
    length = trial.increment.peeq
    assert trial.converged and length == pytest.approx(beyond * 1e9 / (3 * 80e9), rel=1e-9)
    assert trial.increment.strain == pytest.approx(1.5 * length * AXIAL, rel=1e-9)
    assert von_mises(trial.stress) == pytest.approx(1e9, rel=1e-12)
    trial = step_of_the_paper(1e9 * (1 + 5e-4) * AXIAL, 2 * 80e9, 1e-3)  # inside the tolerance at once
    assert trial.converged and not trial.increment.peeq.any()
    trial = step_of_the_paper(1.2e9 * AXIAL, 0.0, 1e-6)
    assert trial.yield_excess == pytest.approx(0.2, rel=1e-12)
    assert not trial.converged and trial.rise == 2.0


# what is measured


def test_recovered_plastic_strain_is_a_tensor_in_units_of_one():
    """One element of 4 points: engineering shear halved, times the unit of strain."""
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
    factors = np.array([1, 1, 1, 0.5])[:, None, None] * 2e-3
    assert found.plastic_strain == pytest.approx(factors * strain, rel=1e-12)
    assert found.peeq == pytest.approx(np.full((1, 4), 6e-3), rel=1e-12)
    assert found.stress == pytest.approx(np.full((4, 1, 4), 5e9), rel=1e-12)
    assert found.axis_z == pytest.approx([1e-6, 2e-6], rel=1e-9, abs=0.0)
    assert found.axis == pytest.approx(np.outer([5e9, 5e9, 5e9, 0.0], [1.0, 1.0]), rel=1e-12)


def test_the_strain_that_a_twentieth_of_the_plastic_volume_exceeds():
    """0.01 in 92 % of the volume and 0.02 in 8 %: linear between the middles at 0.46 and 0.96, at 0.95."""
    strain, volume, none = np.array([0.01, 0.02]), np.array([0.92, 0.08]), np.zeros((6, 2, 1, 1))
    side, z = np.array([0.0, 1.0]), np.array([0.0, 0.92, 1.0])
    box = Box(side, side, z, none, none, strain.reshape(2, 1, 1))
    for found in (tables.exceeded_strain(box), common_recovery.exceeded_strain(strain, volume)):
        assert found == pytest.approx(0.01 * (1 + 0.49 / 0.5), rel=1e-12)


def test_top_of_a_parabola():
    x = np.array([0.2, 0.5, 0.9])
    value, place = common_recovery.parabola_peak(x, 3.0 - 4.0 * (x - 0.47) ** 2)
    assert place == pytest.approx(0.47, rel=1e-12) and value == pytest.approx(3.0, rel=1e-12)
    assert common_recovery.parabola_peak(x, np.array([1.0, 1.0, 1.0])) == (1.0, 0.5)


@pytest.mark.parametrize("rows, most, place", [((3.0,), 1.0, 2.5), ((1.0, 4.0), 929 / 880, 24 / 11)])
def test_no_parabola_goes_across_a_kink_of_the_yield_stress(rows, most, place):
    """The largest of a soft layer, at its last point; in smooth surroundings that of a parabola."""
    z, field, kinks = np.array([0.5, 1.5, 2.5, 3.5]), np.array([0.2, 0.8, 1.0, 0.1]), Kinks(rows)
    flat = SimpleNamespace(kinks=kinks, axis_z=z, z=z)
    space = SimpleNamespace(kinks=kinks, x=np.zeros(1), z=z)
    snapshot = SimpleNamespace(mises=field[:, None], flowed=None)
    for found in (
        recovery.Stresses.largest(flat, 0 * field, field),
        spatial.Stresses.largest(space, 0 * field[None, None], field[None]),
        tables.largest_mises(z, snapshot, kinks)[::-1],
    ):
        assert found == (pytest.approx(most, rel=1e-12), pytest.approx(place, rel=1e-12))


R = np.array([[0.1, 0.3, 0.1, 0.3], [0.6, 0.8, 0.6, 0.8], [0.1, 0.3, 0.1, 0.3]])
Z = np.array([[0.1, 0.1, 0.3, 0.3], [0.1, 0.1, 0.3, 0.3], [0.6, 0.6, 0.8, 0.8]])


def test_the_axis_is_reached_by_functions_even_in_r():
    """Two columns of points: 2 + 5 r^2 - 3 z is 2 - 3 z there."""
    depth, value = recovery.on_axis(R, Z, (2 + 5 * R**2 - 3 * Z)[None])
    assert depth.tolist() == [0.1, 0.3, 0.6, 0.8]
    assert value[0] == pytest.approx(2 - 3 * depth, rel=1e-12)


def test_stress_on_a_face_is_extrapolated_from_its_elements():
    """Two elements at the face, one deeper; linear in z; points that have yielded are left out."""
    stress = np.stack([1 + k + 2 * R - 3 * Z for k in range(4)])
    part = recovery.Stresses(R, Z, stress, np.zeros(0), np.zeros((4, 0)), np.zeros_like(R), np.zeros(0))
    found = recovery.on_face(part, 0.0)
    assert sorted(found[0]) == pytest.approx([1 + 2 * x for x in (0.1, 0.3, 0.6, 0.8)], rel=1e-12)
    assert found[3] == pytest.approx(found[0] + 3, rel=1e-12)
    part.peeq[0, 2] = 1e-3
    assert sorted(recovery.on_face(part, 0.0)[0]) == pytest.approx([2.2, 2.6], rel=1e-12)


@pytest.mark.parametrize("strained", [0.0, 1e-3])
def test_what_has_yielded_gives_its_own_stress(strained):
    """Else the top of a parabola over depth, and the stress on the axis, larger here than in any element."""
    z, q = np.array([0.1, 0.2, 0.3, 0.4]), np.array([0.6, 0.9, 1.0, 0.3])
    peak = SimpleNamespace(mises=q[:, None], flowed=np.full((4, 1), strained > 0))
    depth, largest = tables.largest_mises(z, peak)
    expected = (1.0, 0.3) if strained else common_recovery.parabola_peak(z[1:], q[1:])
    assert (largest, depth) == pytest.approx(expected, rel=1e-12)
    within, axis, empty = np.zeros((4, 1, 4)), np.zeros((4, 2)), np.zeros(2)
    within[2], axis[2] = -1.0, [-1.1, -1.2]
    place, peeq = np.array([0.1, 0.3]), np.full((1, 4), strained)
    flat = recovery.Stresses(R[:1], Z[:1], within, place, axis, peeq, empty)
    field, plane, peeq = np.zeros((6, 2, 1, 2)), np.zeros((6, 2, 2)), np.full((2, 1, 2), strained)
    field[2], plane[2] = -1.0, -1.2
    last = plane, np.zeros((2, 2)), np.zeros((6, 2)), empty, None
    space = spatial.Stresses(place, place[:1], place, field, peeq, *last)
    for found in (flat.largest_mises()[0], space.largest_mises()[0]):
        assert found == pytest.approx(1.0 if strained else 1.2, rel=1e-12)
