# SPDX-License-Identifier: MIT
"""Contact in three dimensions: coatings, motion, linear solver; rough bodies, maps of friction, removal."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, RADIUS, SPHERE, SWIFT, SWIFT_YIELD, hertz_force, scene as small_scene
from made_results import column
from rounding import EPS, close

from fem_reference import spatial
from fem_reference.common import loading
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import run
from fem_reference.common.mesh_lines import Lines, two_sided
from fem_reference.common.plasticity import History
from fem_reference.common.schedule import Load
from fem_reference.spatial import recovery, worn_cycles
from fem_reference.spatial.hexahedra import HexSolid, block
from fem_reference.spatial.model import build
from fem_reference.spatial.multigrid import Preconditioner
from fem_reference.spatial.planner import plan
from fem_reference.spatial.rough import build as build_rough, on_mesh
from fem_reference.spatial.solution import METHOD
from fem_reference.spatial.worn import Limits, columns_of_points, depth_above, moved_up, own_depth
from sam.planner.make import schedule_of
from sam.scene import COUNTER_HEIGHT, FrictionMap, HeightMap, Scene, load_scene
from sam.scene.result import COLUMNS
from verification.scenes.asperities import CELLS, height_map

A, YOUNG, NU = 3e-6, 210e9, 0.3  # A: radius of the given pressures, in m
PLASTIC = {"body": {"plasticity": SWIFT}, "force": hertz_force(4 * SWIFT_YIELD)}
HERTZ = (0.75 * PLASTIC["force"] * RADIUS * (1 - NU**2) / YOUNG) ** (1 / 3)


def scene(cells=3, friction=0.0, *, body=None, counter=SPHERE, box=4.0, **keys):
    """A rigid sphere on steel; friction: its coefficient; keys: of loading."""
    return small_scene(
        body=body or {},
        counterbody=counter,
        loading=keys,
        friction=friction,
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


# --- rough bodies ---

PATCH = 12e-6


def centres(n, side=PATCH):
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def two_tops(x, y):
    """Two spots of unequal load, none in the middle, nothing symmetric."""
    first = 130e-9 * np.exp(-((x + 2.9e-6) ** 2 / (2 * 1.6e-6**2)) - (y - 1.1e-6) ** 2 / (2 * 2.2e-6**2))
    return first + 118e-9 * np.exp(-((x - 2.9e-6) ** 2 + (y + 0.9e-6) ** 2) / (2 * 1.7e-6**2))


def rough(n=16, height=two_tops, *, side=PATCH, cells=None, **tables):
    """A plane on heights height(x, y) on n x n cells, or cells; a short box."""
    cells = cells or (n, n)
    sides = tuple(side * k / max(cells) for k in cells)
    x, y = (centres(k, length) for k, length in zip(cells, sides, strict=True))
    surface = {"kind": "file", "path": HeightMap(height(x[:, None], y[None, :]), sides)}
    content = {"counterbody": {"shape": "flat"}, "surface": surface, "fem": {"box": 4}}
    return small_scene(**content | {"loading": {"force": 0.04}} | tables)


def test_a_map_on_a_smooth_body_is_the_constant():
    """The whole body with a map of one value against half of it: equal to the accuracy of the loop."""
    fem, grid = {"cells_per_radius": 3, "box": 4}, {"cells": [4, 4], "extent": [20e-6, 20e-6]}
    values = FrictionMap(np.full((4, 4), 0.2), (20e-6, 20e-6))
    half = spatial.solve(small_scene(fem=fem, friction=0.2))
    whole = spatial.solve(small_scene(fem=fem, friction={"law": "map", "path": values}, grid=grid))
    assert (half.discretisation["symmetry"], whole.discretisation["symmetry"]) == ("half, y >= 0", "none")
    for name in "approach_m p_max_Pa pressure_centroid_x_m friction_coefficient contact_area_m2".split():
        assert whole.quantities[name] == close(half.quantities[name], 1e-6)


def test_a_coarse_contact_is_not_called_converged():
    """Fewer nodes than one resolved spot has."""
    result = spatial.solve(rough(8, loading={"force": 1e-3}))
    assert result.status == "under-resolved" and "give a finer surface.path" in result.message


def test_surface_nodes_are_the_centres_of_the_cells():
    made = spatial.plan(rough(cells=(18, 12)))
    model, unit = build_rough(made), made.scales.length
    x, y = model.places
    assert made.patch.cells == (18, 12) and not model.lines.half
    assert np.unique(np.round(x * unit, 12)) == pytest.approx(centres(18), abs=1e-12)
    assert np.unique(np.round(y * unit, 12)) == pytest.approx(centres(12, 8e-6), abs=1e-12)
    expected = two_tops(x * unit, y * unit)
    gap = model.problem.gap0 * model.scales.displacement
    assert gap == pytest.approx(expected.max() - expected, abs=10 * EPS * np.abs(expected).max())


def test_an_ellipsoid_over_a_rough_body_has_its_gap_and_slope_at_each_place():
    """Its own slope, as the heights of the body do not drive it; in a relief these fall off at the border."""
    ball = {"shape": "ellipsoid", "radius_x": 400e-6, "radius_y": 300e-6}
    path = {"start": (-1e-6, 0.0), "end": (1e-6, 0.0), "steps": 1}
    made = spatial.plan(rough(12, counterbody=ball, loading={"force": 0.01, "path": path}))
    model, load, unit = build_rough(made), Load(4 / 3, 0.0, 0.1, 0.05), made.scales
    x, y = (np.meshgrid(*made.patch.centres, indexing="ij")[k] for k in (0, 1))
    inside, moved = np.isfinite(model.initial_gap), model.at(load)
    x, y = x - 0.1 * unit.length, y - 0.05 * unit.length
    assert moved.place == (0.1, 0.05)
    for direction, slope in (((1.0, 0.0), x / 400e-6), ((0.0, 1.0), y / 300e-6)):
        assert model.slope(load, direction)[inside] == pytest.approx(slope.ravel(), abs=1e-15)
    height = x**2 / 800e-6 + y**2 / 600e-6 - model.heights
    gap = moved.initial_gap[inside] * unit.displacement
    assert gap == pytest.approx((height - model.first).ravel(), abs=1e-12 * np.ptp(height))
    grid = {"cells": (12, 12), "extent": (PATCH, PATCH), "border": "relief"}
    wave = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": PATCH}
    lowered, plain = (
        build_rough(spatial.plan(rough(12, surface=wave, grid=grid | {"border": border}))).heights
        for border in ("relief", "free")
    )
    assert np.array_equal(lowered[5:7, 5:7], plain[5:7, 5:7]) and lowered[0, 0] < plain[0, 0]


def test_the_map_is_read_where_the_nodes_are():
    values = np.repeat(np.linspace(0.1, 0.4, 12)[None, :], 12, axis=0)
    local = {"law": "map", "path": FrictionMap(values, (PATCH, PATCH))}
    made = spatial.plan(rough(12, friction=local))
    patch = tuple(
        slice((line.size - 12) // 2, (line.size + 12) // 2) for line in (made.lines.x, made.lines.y)
    )
    assert made.weights[patch] == pytest.approx(values / 0.4)


def test_the_file_is_that_of_the_recipe():
    """Heights to 1e-12 m, places to 1e-9 m, as the file has them."""
    file, made = load_scene("verification/scenes/rough-asperities.toml").surface.measured, height_map(CELLS)
    assert file.cells == made.cells == (48, 48) and file.extent == pytest.approx(made.extent, rel=1e-4)
    assert np.abs(file.values - made.values).max() < 0.51e-12


# --- a rough counter-body that moves ---

CELL, SLIDING = 0.8e-6, 0.2
OVER_CELLS = {"start": (-1.5 * CELL, 0.0), "end": (1.5 * CELL, 0.0), "steps": 3}
WAVE = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": 20 * CELL, "wavelength_y": 20 * CELL}


def sliding(counter=WAVE, *, path=OVER_CELLS, plasticity=None) -> Scene:
    """A plane with a wave that slides three cells over 10 x 10."""
    return small_scene(
        body={"plasticity": plasticity},
        counterbody={"shape": "flat", "surface": counter},
        loading={"force": 0.012, "steps": 1, "unload": True, "path": path},
        friction=SLIDING,
        grid={"cells": (10, 10), "extent": (10 * CELL, 10 * CELL)},
        fem={"box": 4},
        solver={"tolerance": 1e-4},
    )


def test_the_contact_is_that_of_a_counter_body_at_rest_with_those_heights():
    """The same discrete problem within EQUILIBRIUM; friction alone drives a crest in equilibrium."""
    moved, end = spatial.solve(sliding()), sliding().counter_strip.at(0, OVER_CELLS["end"])
    at_rest = {"kind": "file", "path": HeightMap(end, (10 * CELL, 10 * CELL))}
    still = spatial.solve(sliding(at_rest, path=None))
    assert moved.converged and still.converged
    of_moved, of_still = (column(result, "surface", "p_Pa", "peak") for result in (moved, still))
    np.testing.assert_allclose(of_moved, of_still, atol=1e-6 * of_still.max())
    heights = np.array(moved.tables["surface"][COUNTER_HEIGHT])[:100]
    np.testing.assert_allclose(heights, end.ravel(), atol=1e-12 * np.ptp(end))
    history = {name: np.array(values)[:-1] for name, values in moved.tables["history"].items()}
    assert np.abs(history["fx_N"] / history["force_N"] / SLIDING - 1.0).max() < 2e-3
    assert np.diff(history["s_m"]) == pytest.approx(CELL, rel=1e-9)


def test_a_body_that_yields_has_a_row_for_the_pass():
    """Every place counts as steady below a plane, which leaves no groove."""
    law = LINEAR | {"yield_stress": 0.5e9}
    result = spatial.solve(sliding(path=OVER_CELLS | {"steps": 1}, plasticity=law))
    passes = result.tables["passes"]
    assert result.converged and passes["pass"] == [1] and np.isnan(passes["groove_m"]).all()
    assert "track" not in result.tables
    assert 0.0 < passes["new_strain_max"][0] <= result.tables["history"]["peeq_max"][-1]


# --- removal between the cycles ---

FEW, THICK = 6, 20e-9  # cells; m of the layer that may be removed in a cycle


@cache
def wearing(wear: bool = True) -> Scene:
    """A ball on few cells that yields below a rigid plane and slides."""
    law = LINEAR | {"yield_stress": 2e9, "modulus": 5e9, "layer_thickness": THICK}
    law |= {"kinematic": {"modulus": (50e9,), "recovery": (50.0,)}}
    limits = {"strain_limit": np.inf, "strain_limit_layer": 0.004, "smoothing_window": 0}
    return rough(
        FEW,
        lambda x, y: -(x**2 + y**2) / (2 * 20e-6),
        side=4e-6,
        body={"plasticity": law},
        loading={"force": 0.02, "steps": 1, "unload": True, "cycles": 2},
        friction={"coefficient": 0.3},
        **({"wear": limits} if wear else {}),
    )


@cache
def ball():
    return build_rough(spatial.plan(wearing(False)))


def test_a_profile_is_removed_down_to_its_first_crossing():
    z = np.array([1.0, 2.0, 4.0])
    strain = np.array([[3.0, 2.0, 0.0], [0.5, 3.0, 0.0], [3.0, 1.0, 3.0], [0.0, 0.0, 0.0], [0.8, 0.2, 0.0]])
    # the surface by the first two: 4, -2, 5, 0, 1.4
    assert depth_above(1.0, z, strain) == pytest.approx([3.0, 0.0, 2.0, 0.0, 2.0 / 3.0])
    with pytest.raises(ValueError, match="all of a column"):
        depth_above(1.0, z, np.array([[3.0, 2.0, 1.5]]))


def test_a_roof_falls_where_the_strain_is_beyond_its_limit_anywhere_below():
    """Two zones; along samples of the strain as it is linear between the Gauss points."""
    model, unit, z = ball(), ball().scales, ball().body.points[2]

    def strain(at):
        return np.interp(at, [0.2, 0.3, 0.4, 0.6, 0.7, 0.8], [0.0, 0.01, 0.0, 0.0, 0.02, 0.0])

    state = replace(model.virgin(), history=History(np.zeros((6, *z.shape)), strain(z) / unit.strain))
    nodes, fine = np.append(0.0, np.unique(z.round(12))), np.linspace(0.0, 1.0, 100001)
    for bulk in (0.004, 0.012, 0.05):
        depth = own_depth(model, state, Limits(bulk, 0.05, 0.1 * unit.length, True)) / unit.length
        lowest = fine[np.interp(fine, nodes, strain(nodes)) > bulk].max(initial=0.0)
        assert depth == pytest.approx(np.full((FEW, FEW), lowest), abs=2e-5)


def test_the_state_moves_up_by_the_depth():
    """Exact for fields that are linear over depth, and nothing moves where nothing is removed."""
    model, depth = ball(), np.zeros((FEW, FEW))
    depth[2:4, 3:5] = 0.1
    (x, y, z), virgin = model.body.points, History.virgin(model.problem.material.shape, 6, 1)
    field = 2.0 + 0.5 * z
    before = History(virgin.plastic_strain + 3.0 * field, virgin.peeq + field, back=virgin.back - field)
    after = moved_up(model, before, on_mesh(model.plan, depth, 0.0))
    up = (after.peeq - before.peeq) / 0.5
    shallow = z < 0.5 * z.max()  # the deepest points have nothing below them
    assert up[shallow].max() == pytest.approx(0.1, rel=1e-12) and up[shallow].min() > -1e-14
    far = (np.abs(x) > 1.0) | (np.abs(y) > 1.0)
    assert np.array_equal(after.peeq[far], before.peeq[far])
    assert after.plastic_strain[0] == pytest.approx(3.0 * after.peeq, abs=1e-12)
    assert after.back[0, 5] == pytest.approx(-after.peeq, abs=1e-12)
    points = model.body.points.reshape(3, -1)[:, columns_of_points(model)]
    assert (np.diff(points[2], axis=2) > 0).all() and np.ptp(points[:2], axis=3).max() < 1e-12


def test_depths_of_a_layer_end_where_it_does():
    """Strains 2.4 % at the surface, less by 1 % in 0.5 half sides."""
    model, unit = ball(), ball().scales
    peeq = np.maximum(0.024 - 0.02 * model.body.points[2], 0.0) / unit.strain
    state = replace(model.virgin(), history=History(np.zeros((6, *peeq.shape)), peeq))
    for limits, depth in (
        (Limits(0.004, 0.004, 0.0), 1.0),
        (Limits(np.inf, 0.02, 0.05 * unit.length), 0.05),
        (Limits(np.inf, 0.023, 0.1 * unit.length), 0.05),
        (Limits(0.014, 0.02, 0.1 * unit.length), 0.5),
    ):
        depths = own_depth(model, state, limits) / unit.length
        assert depths == pytest.approx(np.full((FEW, FEW), depth), rel=1e-9)


def test_without_removal_the_cycles_are_those_of_a_solve():
    none = np.zeros((FEW, FEW))
    (cycles, own), plain = worn_cycles(wearing(), [none, none], None), spatial.solve(wearing(False))
    assert np.array_equal(cycles[-1].tables["surface"]["p_Pa"], column(plain, "surface", "p_Pa"))
    assert cycles[-1].peeq_max == plain.quantities["peeq_max"] and not cycles[-1].worn.any()
    assert np.array_equal(own[0].tables["surface"]["p_Pa"], cycles[0].tables["surface"]["p_Pa"])
    assert own[-1].peeq_max == worn_cycles(wearing(), None)[0][-1].peeq_max


def test_what_is_removed_no_longer_bears():
    ((first, last),) = worn_cycles(wearing(), None)
    assert first.worn.max() == THICK and (last.worn >= first.worn).all()
    p, q = (np.reshape(cycle.tables["surface"]["p_Pa"], (FEW, FEW)) for cycle in (first, last))
    deepest = np.unravel_index(first.worn.argmax(), first.worn.shape)
    assert q[deepest] < p[deepest]
