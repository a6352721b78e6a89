# SPDX-License-Identifier: MIT
"""Plastic contact in three dimensions: against the axisymmetric model, tangent, cycles, checkpoints,
files.
"""

from itertools import pairwise

import numpy as np
import pytest
from builders import SWIFT, SWIFT_YIELD as YIELD, hertz_force, scene as small_scene
from rounding import close

import fem_reference
from fem_reference import spatial
from fem_reference.common import contact
from fem_reference.common.loading import run
from fem_reference.spatial import problem
from fem_reference.spatial.model import build
from fem_reference.spatial.planner import plan
from fem_reference.spatial.recovery import largest_peeq, stresses

YOUNG, NU, RADIUS = 210e9, 0.3, 105e-6


def scene(cells, friction=0.0, ratio=4, box=6, *, direction="constant", **loading):
    return small_scene(
        body={"plasticity": SWIFT},
        loading={"force": hertz_force(ratio * YIELD), **loading},
        friction=friction and {"coefficient": friction, "direction": direction},
        fem={"cells_per_radius": cells, "box": box},
    )


def given(cells, box):
    return small_scene(
        body={"plasticity": SWIFT},
        loading={"prescribed": "hertz", "p0": 4 * YIELD, "radius": 6e-6},
        fem={"cells_per_radius": cells, "box": box},
    )


def test_without_friction_it_is_the_axisymmetric_model():
    """One step on both sides, h = a/6: plastic strain within 2 % (0.5 % at a/8, as the case shows), pressure
    0.5 %.
    """
    model = build(plan(scene(6)))
    state = run(model, model.plan.schedule)[-1].state
    ring = fem_reference.solve(scene(16, box=10)).quantities
    value, depth = largest_peeq(stresses(model, state))
    assert value == pytest.approx(ring["peeq_max"], rel=0.02)
    assert depth == pytest.approx(ring["peeq_max_depth_m"], abs=0.04 * model.scales.length)
    assert model.nodal_pressure(state).max() * model.scales.pressure == pytest.approx(
        ring["p_max_Pa"], rel=5e-3
    )
    assert state.approach * model.scales.displacement == pytest.approx(ring["approach_m"], rel=5e-3)


def test_given_pressure_in_both_models():
    """The pressure of Hertz without contact: plastic strain of both models within 2 % at h = a/6; nothing to
    search.
    """
    space, ring = spatial.solve(given(6, 4)), fem_reference.solve(given(16, 10))
    assert space.converged and ring.converged
    assert space.quantities["peeq_max"] == pytest.approx(ring.quantities["peeq_max"], rel=0.02)
    for name in ("force_N", "contact_area_m2", "p_max_Pa", "p_center_Pa"):
        assert space.quantities[name] == close(ring.quantities[name], 1e-12)
    assert space.quantities["force_N"] == pytest.approx(2 / 3 * np.pi * (6e-6) ** 2 * 4 * YIELD, rel=1e-12)
    assert ring.quantities["approach_m"] is None and ring.tables["history"]["approach_m"] == [None]


def test_newton_is_quadratic(monkeypatch):
    """With friction and an accurate linear solve, residuals fall with order 2 at the end of a step (to
    rounding, 1e-11).
    """
    monkeypatch.setattr(problem, "ACCURACY", 1e-11)
    monkeypatch.setattr(contact, "NEGLIGIBLE", 1e-4)
    model = build(plan(scene(3, 0.4, box=4)))
    state = run(model, model.plan.schedule)[-1].state
    assert state.converged and state.iterations <= 8
    falls = [(a, b) for a, b in pairwise(state.residuals[-4:]) if a < 1e-2]
    assert falls and all(b < max(30 * a**2, 1e-11) for a, b in falls)


def test_resumed_solve_is_the_same_solve():
    """From every checkpoint the tables are equal to the last digit, unloading included."""
    s = scene(3, 0.3, box=3, steps=2, unload=True, cycles=2, direction="alternating")
    kept = []
    whole = spatial.solve(s, checkpoint=kept.append)
    assert len(kept) >= 5 and kept[1].done == 2
    again = spatial.solve(s, start=kept[-3])
    for name, table in whole.tables.items():
        for column, values in table.items():
            np.testing.assert_array_equal(
                np.asarray(again.tables[name][column]), np.asarray(values), f"{name} {column}"
            )
    assert whole.tables["history"]["friction_coefficient"] == [0.3] * len(whole.tables["history"]["step"])
    assert whole.tables["cycles"]["peeq_max"][1] > whole.tables["cycles"]["peeq_max"][0]
    assert whole.tables["cycles"]["friction_sign"] == [1, -1]
    with pytest.raises(ValueError, match="fem-3d"):
        fem_reference.solve(s.model_copy(update={"friction": None}), start=kept[0])


def test_result_is_complete():
    """Tables, fields in the order of meshio (positive volumes), traction, plastic shear of the surface, yield
    condition.
    """
    result = spatial.solve(scene(3, 0.4, box=3, unload=True))
    q = result.quantities
    assert result.certificate["yield_excess"] < 1e-9
    line = {name: np.asarray(values) for name, values in result.tables["line"].items()}
    peak = line["state"] == "peak"
    assert line["qx_Pa"] == pytest.approx(0.4 * line["p_Pa"], rel=1e-14)
    assert line["x_m"][peak][0] == -line["x_m"][peak][-1]
    assert line["ux_m"][peak].max() == pytest.approx(q["tangential_displacement_center_m"], rel=0.05)
    assert (
        0
        < q["plastic_shear_center_m"]
        < 2 * q["residual_ux_center_m"]
        < q["tangential_displacement_center_m"]
    )
    mesh = result.fields
    corners = mesh.points[mesh.cells["hexahedron"]]
    edges = (corners[:, k] - corners[:, 0] for k in (1, 3, 4))
    volume = np.abs(np.einsum("ei,ei->e", np.cross(*(next(edges) for _ in (0, 1))), next(edges)))
    assert volume.sum() == close(np.prod(np.ptp(mesh.points, axis=0)), 1e-12)
    assert mesh.cell_data["plastic_strain"].shape == (len(corners), 6)
    assert np.abs(mesh.cell_data["plastic_strain"][:, :3].sum(axis=1)).max() < 1e-12
    centres = corners.mean(axis=1)
    worst = np.argmax(mesh.cell_data["peeq"])
    assert centres[worst, 2] < 1e-6 * 6 and mesh.cell_data["peeq"][worst] <= q["peeq_max"] * (1 + 1e-12)
