# SPDX-License-Identifier: MIT
"""Smooth contact in three dimensions: coatings, a moving counter-body, linear solver."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from builders import RADIUS, SPHERE, SWIFT, SWIFT_YIELD, hertz_force, scene as small_scene
from rounding import close

from fem_reference import spatial
from fem_reference.common import loading
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import run
from fem_reference.common.mesh_lines import Lines, two_sided
from fem_reference.common.schedule import Load
from fem_reference.spatial import recovery
from fem_reference.spatial.hexahedra import HexSolid, block
from fem_reference.spatial.model import build
from fem_reference.spatial.multigrid import Preconditioner
from fem_reference.spatial.planner import plan
from fem_reference.spatial.solution import METHOD
from sam.planner.make import schedule_of
from sam.scene.result import COLUMNS

A, YOUNG, NU = 3e-6, 210e9, 0.3  # A: radius of the given pressures, in m
PLASTIC = {"body": {"plasticity": SWIFT}, "force": hertz_force(4 * SWIFT_YIELD)}
HERTZ = (0.75 * PLASTIC["force"] * RADIUS * (1 - NU**2) / YOUNG) ** (1 / 3)


def scene(cells=3, friction=0.0, *, body=None, counter=SPHERE, box=4.0, direction="constant", **keys):
    """A rigid sphere on steel; friction: its coefficient; keys: of loading."""
    return small_scene(
        body=body or {},
        counterbody=counter,
        loading=keys,
        friction=friction and {"coefficient": friction, "direction": direction},
        fem={"cells_per_radius": cells, "box": box},
    )


def given(cells=3, friction=0.0, p0=2e9, **keys):
    return scene(cells, friction, prescribed="hertz", p0=p0, radius=A, **keys)


def film(h, ratio=80 / 210, strength=None):
    coating = {"thickness": h * A, "young": ratio * YOUNG, "poisson": NU, "yield_stress": strength}
    return {"coating": coating}


def test_a_load_that_travels():
    """An elastic body forgets the way: at the end of a path the state is that of the load put on there."""
    path = {"start": (-A, 0.0), "end": (A, 0.0), "steps": 2}
    model = build(plan(given(3, 0.2, path=path)))
    steps = run(model, model.plan.schedule)
    assert [step.state.load.x for step in steps] == [-1.0, 0.0, 1.0]
    direct = model.load(Load(model.scales.peak_force, 0.2, 1.0), model.virgin())
    assert np.abs(steps[-1].state.u - direct.u).max() < 1e-6
    moved = model.nodal_pressure(steps[-1].state)
    assert model.lines.x[np.argmax(moved[:, 0])] == pytest.approx(1.0)
    assert moved[::-1] == pytest.approx(model.nodal_pressure(steps[0].state), abs=1e-12)
    across = {"start": (0.0, -0.5 * A), "end": (0.0, 0.5 * A), "steps": 1}
    assert not plan(given(3, 0.2, path=across)).lines.half


def test_statuses():
    assert spatial.solve(scene(2)).status == "under-resolved"
    empty = spatial.solve(scene(force=0.0))
    assert empty.converged and empty.quantities["p_max_Pa"] == 0.0


# --- coatings ---


@cache
def coated():
    """Stresses under the pressure of Hertz and its traction, two elements in the coating."""
    model = build(plan(given(4, 0.4, p0=4e9, body=film(0.5), box=6.0)))
    return recovery.stresses(model, model.load(Load(model.scales.peak_force, 0.4), model.virgin()))


def test_a_face_never_takes_from_the_other_layer():
    """The coating's stresses multiplied leave those of the body's face as they are, and vice versa."""
    s = coated()
    for coating, other in ((True, slice(s.coating_layers, None)), (False, slice(None, s.coating_layers))):
        changed = {name: getattr(s, name).copy() for name in ("stress", "plane", "axis")}
        for field in changed.values():
            field[..., other] *= 7.0
        both = [recovery.with_face(of.layer(coating), s.interface) for of in (s, replace(s, **changed))]
        assert all(np.array_equal(*(getattr(face, name) for face in both)) for name in changed)


def test_a_layer_that_yielded_is_read_at_its_elements():
    """Beyond them a polynomial would pass the yield stress."""
    s = coated()
    part = s.layer(False)
    yielded = replace(part, peeq=np.where(part.peeq == 0.0, 1e-4, part.peeq))
    face = recovery.with_face(yielded, s.interface)
    assert np.array_equal(face.stress[..., 0], part.stress[..., 0]) and face.z[0] == s.interface
    assert not np.array_equal(recovery.with_face(part, s.interface).stress[..., 0], part.stress[..., 0])
    both = replace(s, peeq=np.full_like(s.peeq, 1e-4))
    assert both.largest_in_layer(False)[0] == mises(part.stress).max()


def test_a_field_that_is_quadratic_over_depth_is_exact_at_a_face():
    s = coated()
    made = replace(s.layer(False), plane=np.ones_like(s.layer(False).plane) * s.layer(False).z ** 2)
    assert recovery.with_face(made, s.interface).plane[..., 0] == pytest.approx(s.interface**2, rel=1e-9)


def test_far_field_of_a_coating_under_friction():
    """It is more than that of the body, and kept."""
    made, load = plan(scene(2, 0.2, body=film(0.5))), Load(4 / 3, 0.2)
    model, bare = build(made), build(made.bare)
    far, body = (m.problem.far_field(load) for m in (model, bare))
    assert np.abs(far - body).max() > 1e-3 * np.abs(body).max()
    assert np.array_equal(model.problem.far_field(load), far)


def test_a_coating_of_the_body_changes_nothing():
    """To the tolerance of the loop, under traction as well."""
    q = spatial.solve(scene(3, 0.2, body=film(0.1, 1.0), box=3.0)).quantities
    assert abs(q["p_max_change"]) < 1e-7 and abs(q["mises_max_change"]) < 1e-7


def test_a_coating_that_yields(monkeypatch):
    """Below its shear strength it does not go beyond; above, mu p0 > Y/sqrt(3), there is no equilibrium."""
    soft = film(0.05, strength=0.67e9)
    result = spatial.solve(given(2, 0.1, p0=2.5e9, body=soft, box=3.0))
    q = result.quantities
    assert result.status == "under-resolved"
    assert q["mises_max_film_Pa"] < 0.67e9 * (1 + 1e-9) and q["peeq_max"] > 0.0 == q["p_max_change"]
    assert result.certificate["yield_excess"] < 1e-9 and result.certificate["equilibrium"] < 1e-9
    monkeypatch.setattr(loading, "MOST_CUTS", 0)
    result = spatial.solve(given(2, 0.1, p0=5e9, body=soft, box=3.0))
    assert result.status == "step-cut-limit" and result.quantities["p_max_change"] is None
    assert "no pressure beyond 3.868e+09 Pa" in result.message and "friction.coefficient" in result.message


# --- plasticity ---


def test_result_is_complete():
    """Tables, fields in the order of meshio (positive volumes), traction, plastic shear, yield condition."""
    result = spatial.solve(scene(3, 0.4, box=3.0, unload=True, **PLASTIC))
    q = result.quantities
    assert result.certificate["yield_excess"] < 1e-9
    line = {name: np.asarray(values) for name, values in result.tables["line"].items()}
    peak = line["state"] == "peak"
    assert line["qx_Pa"] == pytest.approx(0.4 * line["p_Pa"], rel=1e-14)
    assert line["x_m"][peak][0] == -line["x_m"][peak][-1]
    assert 0 < q["plastic_shear_center_m"] < 2 * q["residual_ux_center_m"]
    mesh = result.fields
    corners = mesh.points[mesh.cells["hexahedron"]]
    edges = (corners[:, k] - corners[:, 0] for k in (1, 3, 4))
    volume = np.abs(np.einsum("ei,ei->e", np.cross(*(next(edges) for _ in (0, 1))), next(edges)))
    assert volume.sum() == close(np.prod(np.ptp(mesh.points, axis=0)), 1e-12)
    assert mesh.cell_data["plastic_strain"].shape == (len(corners), 6)
    assert np.abs(mesh.cell_data["plastic_strain"][:, :3].sum(axis=1)).max() < 1e-12
    worst = np.argmax(mesh.cell_data["peeq"])
    assert corners.mean(axis=1)[worst, 2] < 6e-6
    assert mesh.cell_data["peeq"][worst] <= q["peeq_max"] * (1 + 1e-12)


# --- a counter-body that moves ---


def moving(length, count, friction=0.0, *, back=False, turns="lifted", **keys):
    """Over `length` contact radii of Hertz about the origin, along x or against it."""
    ends = (-length / 2 * HERTZ, 0.0), (length / 2 * HERTZ, 0.0)
    start, end = ends[::-1] if back else ends
    return scene(
        3, friction, path={"start": start, "end": end, "steps": count, "return": turns}, **PLASTIC | keys
    )


@pytest.mark.parametrize("turns", ["lifted", "to-and-fro"])
@pytest.mark.parametrize("back", [True, False])
def test_the_steps_are_those_of_sam(turns, back):
    made = moving(3, 4, 0.2, turns=turns, back=back, unload=back, cycles=3, steps=2)
    targets = spatial.plan(made).schedule.targets
    unit = spatial.plan(made).scales
    others = schedule_of(made).targets
    ours = [
        (t.cycle, t.number, t.load.x * unit.length, t.load.force * unit.force / unit.peak_force, t.load.ratio)
        for t in targets
    ]
    expected = [(t.cycle, t.step, t.load.x, t.load.force, 0.2 * t.load.sign) for t in others]
    assert np.array(ours) == pytest.approx(np.array(expected), rel=1e-12, abs=1e-18)
    assert [t.unloads for t in targets] == [not t.rises for t in others]


def test_resumed_passes_hold_what_results_read():
    """Of the states inside a pass only those that a step begins from have displacements."""
    made, records = moving(0.4, 1, unload=True, cycles=2, steps=1, box=3.0), []
    whole = spatial.solve(made, checkpoint=records.append)
    assert all(list(whole.tables[name]) == list(COLUMNS[name]) for name in ("track", "cross", "passes"))
    model, steps = spatial.load_steps(made, records[-1])
    held = [bool(step.state.u.size) for step in steps]
    assert held == [a.cycle != b.cycle or b.unloads for a, b in pairwise(steps)] + [True]
    assert held.count(False) == 2
    largest = [METHOD.peeq_max(model, step.state) for step in run(model, model.plan.schedule)]
    assert np.array_equal(largest, whole.tables["history"]["peeq_max"])


# --- linear solver ---


def test_multigrid_is_deterministic_and_symmetric():
    line = two_sided(-1.0, 1.0, 0.25, 5.0)
    solid = HexSolid(block(Lines(line, line[line >= 0], line[line >= 0], True)), Elastic(1.0, 0.3))
    mesh = solid.basis.mesh
    far = np.zeros(mesh.p.shape[1], dtype=bool)
    far[np.unique(mesh.facets[:, mesh.boundaries["far"]])] = True
    free = ~np.repeat(far, 3)
    free[solid.boundary_dofs("symmetry", 1)] = False
    inverses = []
    for seed in (1, 2):
        np.random.seed(seed)  # noqa: NPY002 - of what must not depend on it
        inverses.append(Preconditioner(solid.stiffness, mesh.p, far)(solid.stiffness, free))
    a, b = np.random.default_rng(3).standard_normal((2, solid.size))
    assert np.array_equal(*(inverse(a) for inverse in inverses))

    def first(r: np.ndarray) -> np.ndarray:
        return np.where(free, inverses[0](np.where(free, r, 0.0)), 0.0)

    assert b @ first(a) == pytest.approx(a @ first(b), rel=1e-10)
