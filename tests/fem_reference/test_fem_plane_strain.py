# SPDX-License-Identifier: MIT
"""The plane-strain model: line forces, full slip, passes."""

import numpy as np
import pytest
from builders import STEEL, scene

from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises, stiffness_tensor
from fem_reference.common.far_field import flamant, stretched
from fem_reference.plane_strain import load_steps, solve
from fem_reference.plane_strain.recovery import stresses

RADIUS, LENGTH, YOUNG, YIELD = 0.01, 0.02, 210e9, 400e6
CYLINDER = {"shape": "cylinder", "radius": RADIUS, "length": LENGTH}


def force_of(pressure, modulus=YOUNG / 0.91):
    """Force in N and half-width in m of Hertz's line contact with a largest pressure in Pa."""
    a = 2.0 * RADIUS * pressure / modulus
    return 0.5 * np.pi * a * pressure * LENGTH, a


def line(ratio=1.0, *, cells=8, box=None, friction=0.0, plasticity=None, path=None, **loading):
    """A rigid cylinder on steel; ratio: largest pressure over YIELD; path: half of it in half-widths."""
    force, a = force_of(ratio * YIELD)
    if path is not None:
        loading["path"] = {"start": [-path * a, 0], "end": [path * a, 0], "step_per_radius": 2}
    return scene(
        body={"plasticity": plasticity},
        counterbody=CYLINDER | ({} if path is None else {"slip": 0.0}),
        loading={"force": force, **loading},
        friction=friction,
        fem={"cells_per_radius": cells, **({} if box is None else {"box": box})},
    )


def test_line_force_stress():
    """The one radial stress of Flamant, -2 (P cos t + Q sin t)/(pi r); no displacement at the datum."""
    body, force, step = Elastic(3.0, 0.3), (2.0, -0.7), 1e-5
    r, t = np.array([0.5, 1.0, 3.0, 20.0]), np.array([0.3, -1.2, 1.5, -0.4])
    at = np.stack([r * np.sin(t), r * np.cos(t)])
    ends = [[flamant(force, body, at + s[:, None], 5.0) for s in (way, -way)] for way in step * np.eye(2)]
    slopes = [(after - before) / (2 * step) for after, before in ends]
    strain = np.stack([slopes[0][0], np.zeros(4), slopes[1][1], slopes[0][1] + slopes[1][0]])
    xx, yy, zz, xz = stiffness_tensor(3.0, 0.3) @ strain
    radial = -2.0 * (force[0] * np.cos(t) + force[1] * np.sin(t)) / (np.pi * r)
    expected = radial * np.array([np.sin(t) ** 2, np.cos(t) ** 2, np.sin(t) * np.cos(t)])
    np.testing.assert_allclose([xx, zz, xz], expected, atol=1e-8)
    np.testing.assert_allclose(yy, 0.3 * radial, atol=1e-8)
    edge = np.array([[5.0, -5.0], [0.0, 0.0]])
    assert np.abs(flamant((2.0, 0.0), body, edge, 5.0)[1]).max() < 1e-15
    assert np.abs(flamant((0.0, -0.7), body, edge, 5.0)[0]).max() < 1e-15


def test_strain_far_away():
    """By flat plastic strain, and by its depth: derivatives of line forces along the surface."""
    body, at = Elastic(3.0, 0.3), np.array([[2.0, -1.0, 0.3], [0.0, 0.7, 1.5]])

    def moved(forces, shift):
        return flamant(forces, body, at - np.array([[shift], [0.0]]), 1.0)

    unit, step = 3.0 / (1.0 - 0.3**2), 1e-4
    flat, deeper = stretched(body, at)
    along = (moved((0.0, unit), step) - moved((0.0, unit), -step)) / (2 * step)
    down = [moved((unit, 0.0), shift) for shift in (-step, 0.0, step)]
    np.testing.assert_allclose(flat, along, rtol=1e-6)
    np.testing.assert_allclose(deeper, -(down[0] - 2 * down[1] + down[2]) / step**2, rtol=1e-6, atol=1e-6)


def test_two_cylinders():
    """NAFEMS R0094-1: steel cylinder on aluminium, half-width 6.2146 mm, largest pressure 3585.4 MPa."""
    roller = {"shape": "cylinder", "radius": 0.05, "length": 1e-3, **STEEL}
    tables = {"loading": {"force": 35e3}, "fem": {"box": 20, "cells_per_radius": 10}}
    result = solve(scene(body={"young": 70e9}, counterbody=roller, **tables))
    found = [result.quantities[name] for name in ("contact_half_width_m", "p_max_Pa", "contact_area_m2")]
    assert found == pytest.approx([6.2146e-3, 3585.4e6, 2 * 6.2146e-6], rel=1e-3)
    assert result.status == "converged" and max(result.certificate.values()) < 1e-9


PERFECT = {"law": "perfect", "yield_stress": YIELD}
KINEMATIC = PERFECT | {"kinematic": {"modulus": [20e9], "recovery": [0.0]}}


def test_full_slip_is_askew():
    """With friction the pressure below a rigid cylinder is as (b + x)^(1/2 - k) (c - x)^(1/2 + k),
    tan(pi k) = mu (1 - 2 nu)/(2 (1 - nu)) (Johnson 1985, Sec. 8.2). On a half-width (1 - 4 k^2)^(-1/2) times
    Hertz's its middle lies 2 k and its resultant 8/3 k half-widths behind the apex.
    """
    model, (step,) = load_steps(line(cells=10, box=40.0, friction=0.8))
    state = step.state
    k = np.arctan(0.8 * 0.4 / 1.4) / np.pi
    start, end = model.edges(state)
    wide = 0.5 * (end - start)
    assert wide * np.sqrt(1.0 - 4.0 * k**2) == pytest.approx(1.0, rel=5e-3)
    assert 0.5 * (start + end) / wide == pytest.approx(-2.0 * k, rel=0.03)
    assert model.centroid(state) / wide == pytest.approx(-8.0 / 3.0 * k, rel=5e-3)


def test_flow_does_not_lock():
    """The mean pressure of a body that flows freely stays below that of a rigid-plastic one, (2 + pi) k, and
    rises towards it; the volume changes elastically alone.
    """
    model, steps = load_steps(line(6.0, cells=3, plasticity=PERFECT, steps=6))
    mean = [np.pi / 4.0 * 6.0 * step.state.force / model.scales.peak_force for step in steps]
    mean = [force / model.size(step.state) for force, step in zip(mean, steps, strict=True)]
    assert 2.3 < mean[-1] < (2.0 + np.pi) / np.sqrt(3.0) and mean == sorted(mean)
    state = steps[-1].state
    volume = model.body.strain(state.u)[:3].sum(axis=0)
    bulk = model.stress(state)[:3].sum(axis=0) * (1.0 - 2.0 * 0.3) / (1.0 - 0.3**2)
    np.testing.assert_allclose(volume, bulk, atol=1e-9)
    assert np.abs(state.history.plastic_strain[:3].sum(axis=0)).max() < 1e-9


def test_far_field_of_plastic_strain():
    """Residual stresses do not depend on the box, and those along x have no resultant on a line x = const."""
    found = []
    for box in (12.0, 24.0):
        model, steps = load_steps(line(3.0, cells=4, box=box, plasticity=PERFECT, steps=2, unload=True))
        state = steps[-1].state
        assert steps[-1].unloads and not state.active.any() and state.residual < 1e-9
        s, height = stresses(model, state), np.repeat(np.diff(model.plan.z), 2) / 2.0
        forces = s.stress[0] @ height / (np.abs(s.stress[0]) @ height)
        found.append((np.abs(forces[s.x < 2.0 * model.scales.length]).max(), mises(s.stress).max()))
    (near, coarse), (far, fine) = found
    assert far < 0.5 * near < 0.05 and coarse == pytest.approx(fine, rel=0.01)


def test_rolling_leaves_a_track():
    """Passes add less and less; a resumed result is equal; an elastic contact moves with the apex."""
    rolls = line(2.1, cells=4, plasticity=KINEMATIC, path=2.5, steps=2, cycles=2, unload=True)
    kept = []
    result = solve(rolls, checkpoint=kept.append)
    assert result.status == "converged" and result.quantities["groove_deepest_m"] > 0.0
    first, second = result.tables["passes"]["new_strain_max"]
    assert 0.0 <= second < 0.5 * first
    again = solve(rolls, start=kept[-4])
    assert again.quantities == result.quantities
    model, steps = load_steps(line(1.0, cells=4, path=1.0))
    for step in steps:
        assert model.centroid(step.state) == pytest.approx(step.state.load.x, abs=0.05)
