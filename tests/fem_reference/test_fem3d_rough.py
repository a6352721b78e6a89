# SPDX-License-Identifier: MIT
"""Rough contact by finite elements in three dimensions: Hertz, balance of forces, SAM, areas of spots, sets,
what is refused.
"""

from dataclasses import replace
from functools import cache
from importlib import resources

import numpy as np
import pytest
from made_results import column
from rounding import EPS, close

import fem_reference
import sam
from fem_reference import UnsupportedScene, spatial
from fem_reference.common.contact import ActiveSet
from fem_reference.spatial.rough import build as rough_model, overlapping
from sam.scene import COUNTER_HEIGHT, CounterSurface, FrictionMap, HeightMap, Scene
from verification.compare.comparison import compare_scene
from verification.compare.rough_measures import PatchPressure, spots
from verification.cost.plan import plan
from verification.scenes.asperities import CELLS, csv_text, height_map

YOUNG, NU, SIDE, RADIUS = 210e9, 0.3, 12e-6, 40e-6
MODULUS = YOUNG / (1 - NU**2)
SWIFT = {"law": "swift", "B": 945e6, "C": 20, "n": 0.121}
OFF = (0.22e-6, -0.13e-6)  # of the apex: off the nodes and off y = 0


def centres(n, side=SIDE):
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def rough(height, n=16, force=0.02, friction=None, plasticity=None, cells=None, **tables):
    """A scene of heights height(x, y) on n x n cells, or cells; a short box, which moves loads by less than
    1e-3.
    """
    cells = cells or (n, n)
    sides = tuple(SIDE * k / max(cells) for k in cells)
    x, y = (centres(k, side) for k, side in zip(cells, sides, strict=True))
    surface = {"kind": "file", "path": HeightMap(height(x[:, None], y[None, :]), sides)}
    content = {
        "body": {"young": YOUNG, "poisson": NU},
        "counterbody": {"shape": "flat"},
        "surface": surface,
        "loading": {"force": force},
        "fem": {"box": 4},
        **tables,
    }
    if plasticity:
        content["body"]["plasticity"] = plasticity
    if friction is not None:
        content["friction"] = friction if isinstance(friction, dict) else {"coefficient": friction}
    return Scene(**content)


def paraboloid(x, y):
    return -((x - OFF[0]) ** 2 + (y - OFF[1]) ** 2) / (2 * RADIUS)


def two_tops(x, y):
    """Two spots of unequal load, none in the middle, nothing symmetric."""
    first = 130e-9 * np.exp(-((x + 2.9e-6) ** 2 / (2 * 1.6e-6**2)) - (y - 1.1e-6) ** 2 / (2 * 2.2e-6**2))
    return first + 118e-9 * np.exp(-((x - 2.9e-6) ** 2 + (y + 0.9e-6) ** 2) / (2 * 1.7e-6**2))


def halves(n, low=0.1, high=0.4, cells=None):
    """A map: low for x < 0, high beyond."""
    values = np.where(np.arange(n)[:, None] < n // 2, low, high) * np.ones((1, n))
    return {"law": "map", "path": FrictionMap(values, (SIDE, SIDE))}


@cache
def solved(friction=False):
    """Two spots on 18 x 18 cells with both models; friction: the map."""
    scene = rough(two_tops, 18, 0.04, friction=halves(18) if friction else None)
    return scene, spatial.solve(scene)


def test_the_cut_goes_through_the_largest_pressure():
    """It is the mean of the elements on both sides of that row, as they are in the fields; the plane y = 0
    misses the peak.
    """
    _, result = solved()
    surface, cut, plane = (result.tables[name] for name in ("surface", "cut", "plane"))
    top, pitch = int(np.argmax(surface["p_Pa"])), SIDE / 18
    assert cut["y_m"] == pytest.approx(np.full(len(cut["y_m"]), surface["y_m"][top]), abs=1e-12)
    assert max(cut["mises_Pa"]) > 1.1 * max(plane["mises_Pa"])
    assert 0.9 < max(cut["mises_Pa"]) / result.quantities["mises_max_Pa"] <= 1.0
    fields = result.fields
    centres = fields.points[fields.cells["hexahedron"]].mean(axis=1)
    beside = np.abs(centres[:, 1] - surface["y_m"][top]) < 0.6 * pitch
    for x, z, szz in list(zip(cut["x_m"], cut["z_m"], cut["szz_Pa"], strict=True))[::37]:
        at = beside & (np.hypot(centres[:, 0] - x, centres[:, 2] - z) < 1e-3 * pitch)
        assert at.sum() == 2
        assert fields.cell_data["stress_Pa"][at, 2].mean() == pytest.approx(szz, rel=1e-9, abs=1.0)


@cache
def at_peak():
    """Model and last state of the two spots with a map of friction, on coarse cells."""
    model, steps = spatial.load_steps(rough(two_tops, 12, 0.04, friction=halves(12)))
    return model, steps[-1].state


# --- against closed forms and SAM ---------------------------------------------------------------------------


def test_hertz():
    """A paraboloid of heights, 4.2 elements in the radius: p0 and approach as coarse meshes have them, the
    area to 3 %.

    The edge is off by 0.09 elements on average, taken off, and by up to 0.02 with its place: 1 % of the area.
    """
    n = 14
    a = 4.2 * SIDE / n
    force = 4 / 3 * MODULUS * a**3 / RADIUS
    q = spatial.solve(rough(paraboloid, n, force)).quantities
    assert q["p_center_Pa"] is None  # a patch has no centre
    assert q == q | {
        "p_max_Pa": pytest.approx(2 * MODULUS * a / (np.pi * RADIUS), rel=0.02),
        "approach_m": pytest.approx(a**2 / RADIUS, rel=0.02),
        "contact_area_m2": pytest.approx(np.pi * a**2, rel=0.03),
        "force_N": pytest.approx(force, rel=1e-9),
        "pressure_centroid_x_m": pytest.approx(OFF[0], abs=0.02 * a),
    }


def test_two_spots_are_those_of_sam():
    """Loads to 2.5 %, in the places they have: two or three cells in the radius of a spot put either model
    off by a percent.
    """
    scene, fem = solved()
    other = sam.solve(scene)
    found = spots(PatchPressure.of(other.tables), PatchPressure.of(fem.tables))
    assert len(found) == 2 and found[0].y > 0.5e-6 and found[1].y < -0.5e-6
    for spot in found:
        assert spot.fem == pytest.approx(spot.sam, rel=0.025)
    heights = np.asarray(other.tables["surface"]["height_m"])
    assert np.asarray(fem.tables["surface"]["height_m"]) == pytest.approx(
        heights, abs=1e-9 * np.abs(heights).max()
    )
    assert not fem.quantities["friction_coefficient"] and np.nanmax(fem.tables["surface"]["friction"]) == 0.0


def test_a_map_of_friction_acts_cell_by_cell():
    """The whole coefficient is that of the loads, as in SAM; the local one that of the cell; the loads shift
    as in SAM.
    """
    scene, fem = solved(friction=True)
    other = sam.solve(scene)
    found = spots(PatchPressure.of(other.tables), PatchPressure.of(fem.tables))
    low, high = (spot.fem for spot in found)
    whole = fem.quantities["friction_coefficient"]
    assert whole == pytest.approx((0.1 * low + 0.4 * high) / (low + high), rel=1e-9)
    assert whole == pytest.approx(other.quantities["friction_coefficient"], rel=0.01)
    local = np.asarray(fem.tables["surface"]["friction"])
    x, p = (np.asarray(fem.tables["surface"][name]) for name in ("x_m", "p_Pa"))
    assert local[p > 0] == pytest.approx(np.where(x < 0, 0.1, 0.4)[p > 0]) and np.isnan(local[p == 0]).all()
    assert found[0].fem == pytest.approx(found[0].sam, rel=0.01)


def test_conditions_on_the_returned_field():
    """Balance, slip with the local coefficient, signs, reactions far away: from displacements and stiffness
    alone (1e-9).
    """
    model, state = at_peak()
    problem, total = model.problem, model.scales.peak_force
    force = problem.solid.stiffness @ state.u
    normal = np.where(state.active, force[problem.normal], 0.0)
    assert state.converged and normal.sum() == pytest.approx(total, rel=1e-8) and normal.min() >= 0.0
    local = 0.4 * problem.weights[state.active]
    assert set(np.round(local, 12)) == {0.1, 0.4}
    assert force[problem.along][state.active] == pytest.approx(local * normal[state.active], abs=1e-8 * total)
    gap = problem.gap0 + state.u[problem.normal] - state.approach
    assert np.abs(gap[state.active]).max() < 1e-13 and gap.min() > -1e-9
    far = problem.solid.basis.nodal_dofs[:, problem.far]
    assert force[far[2]].sum() == pytest.approx(-total, rel=1e-7)
    assert force[far[0]].sum() == pytest.approx(-float(local @ normal[state.active]), rel=1e-6)


def test_the_far_field_has_the_whole_tangential_force():
    """Not the largest coefficient times the normal one: the displacements far away are those of the forces
    that act.
    """
    model, state = at_peak()
    problem = model.problem
    share = model.friction(state) / 0.4
    far = np.flatnonzero(problem.fixed)
    load = state.load.__class__(state.load.force, state.load.ratio * share)
    # the share is that of the iteration before the last, which the last changes by its residual
    assert state.u[far] == pytest.approx(problem.far_field(load)[far], abs=1e-7 * np.abs(state.u[far]).max())
    assert 0.3 < share < 0.9


def test_a_map_on_a_smooth_body_is_the_constant():
    """The whole body with a map of one value against half of it with that value: equal to the accuracy of the
    loop.
    """
    content = {
        "body": {"young": YOUNG, "poisson": NU},
        "counterbody": {"shape": "sphere", "radius": 105e-6},
        "loading": {"force": 0.65},
        "fem": {"cells_per_radius": 3, "box": 4},
    }
    half = spatial.solve(Scene(**content, friction={"coefficient": 0.2}))
    values = FrictionMap(np.full((4, 4), 0.2), (20e-6, 20e-6))
    whole = spatial.solve(
        Scene(
            **content,
            friction={"law": "map", "path": values},
            grid={"cells": [4, 4], "extent": [20e-6, 20e-6]},
        )
    )
    assert (half.discretisation["symmetry"], whole.discretisation["symmetry"]) == ("half, y >= 0", "none")
    for name in (
        "approach_m",
        "p_max_Pa",
        "pressure_centroid_x_m",
        "friction_coefficient",
        "contact_area_m2",
    ):
        assert whole.quantities[name] == close(half.quantities[name], 1e-6)


def test_a_plastic_spot_unloads_to_a_dent():
    """Yield condition, conditions of contact, and the dent that SAM leaves on cells half as large: its depth
    to a tenth.

    On these cells, 3.4 in the radius, that of SAM is a fifth too shallow; it comes from below, first order in
    the cell.
    """
    n, radius = 14, 80e-6
    a = 3.4 * SIDE / n
    keys = {"loading": {"force": 4 / 3 * MODULUS * a**3 / radius, "unload": True}, "plasticity": SWIFT}

    def half_as_high(x, y):
        return 0.5 * paraboloid(x, y)

    fem = spatial.solve(rough(half_as_high, n, **keys))
    other = sam.solve(rough(half_as_high, 2 * n, grid={"layers": 20, "depth": 7e-6}, **keys))
    assert fem.converged and other.converged
    assert (
        fem.certificate["yield_excess"] < 1e-9
        and fem.certificate["tension"] == 0.0 == fem.certificate["penetration"]
    )
    pressures = (column(fem, "surface", "p_Pa", state).max() for state in ("unloaded", "peak"))
    dents = [column(result, "line", "uz_m", "unloaded").max() for result in (fem, other)]
    assert next(pressures) == 0.0 < next(pressures)
    assert dents[0] == pytest.approx(dents[1], rel=0.1) and dents[0] > 1e-9


def test_a_coarse_contact_is_not_called_converged():
    """Fewer nodes than one resolved spot has."""
    result = spatial.solve(rough(paraboloid, 8, 1e-3))
    assert result.status == "under-resolved" and "give a finer surface.path" in result.message


# --- mesh, starting set, sets -------------------------------------------------------------------------------


def test_surface_nodes_are_the_centres_of_the_cells():
    made = spatial.plan(rough(two_tops, cells=(18, 12)))
    model = rough_model(made)
    assert made.patch.cells == (18, 12)
    x, y = model.places
    unit = made.scales.length
    assert np.unique(np.round(x * unit, 12)) == pytest.approx(centres(18), abs=1e-12)
    assert np.unique(np.round(y * unit, 12)) == pytest.approx(centres(12, 8e-6), abs=1e-12)
    expected = two_tops(x * unit, y * unit)
    assert model.problem.gap0 * model.scales.displacement == pytest.approx(
        expected.max() - expected, abs=10 * EPS * np.abs(expected).max()
    )
    assert not model.lines.half


def test_the_map_is_read_where_the_nodes_are():
    """Also where it is finer than nothing but x: a map that varies along y alone stays one along y."""
    values = np.repeat(np.linspace(0.1, 0.4, 12)[None, :], 12, axis=0)
    scene = rough(two_tops, 12, friction={"law": "map", "path": FrictionMap(values, (SIDE, SIDE))})
    made = spatial.plan(scene)
    weights, lines = made.weights, made.lines
    patch = tuple(slice((line.size - 12) // 2, (line.size + 12) // 2) for line in (lines.x, lines.y))
    assert weights[patch] == pytest.approx(values / 0.4)


def test_overlapping_finds_the_contact_of_hertz():
    """The starting set of a sphere has its area within a tenth, that of two equal ones twice that of one at
    half the force.
    """
    x = np.linspace(-5, 5, 201)
    r2, other = ((x[:, None] - at) ** 2 + x[None, :] ** 2 for at in (-2.5, 2.5))
    areas_of = np.full(r2.shape, (x[1] - x[0]) ** 2)
    one = overlapping(0.5 * r2, areas_of, 4 / 3)
    assert one.sum() * areas_of[0, 0] == pytest.approx(np.pi, rel=0.1)
    two = overlapping(0.5 * np.minimum(r2, other), areas_of, 8 / 3)
    assert two.sum() == pytest.approx(2 * one.sum(), rel=0.1)


def test_a_set_without_anchor_keeps_its_last_node():
    """The first node may leave; the one with the largest multiplier never does, so that the force has where
    to act.
    """
    free, tied = (ActiveSet(np.array([True, True, False]), anchored=anchored) for anchored in (False, True))
    for each in (free, tied):
        assert each.update(np.array([-1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])) == (each is free)
    assert free.active.tolist() == [False, True, False] and tied.active.tolist() == [True, True, False]
    assert not free.update(np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 1.0]))


# --- what is refused, plan, recipe --------------------------------------------------------------------------

FILM = {
    "law": "chemical-film",
    "low": 0.1,
    "high": 0.4,
    "film_thickness": 100e-9,
    "film_young": 80e9,
    "film_poisson": 0.3,
}
FILM |= {"film_yield": 0.67e9, "strain_limit": 0.02}
COATED = {"young": 2e11, "poisson": 0.3, "coating": {"thickness": 1e-7, "young": 8e10, "poisson": 0.3}}
WEAR = {"wear": {"strain_limit": 0.05}, "loading": {"force": 0.05, "unload": True}}


@pytest.mark.parametrize(
    ("tables", "key"),
    [
        ({"friction": FILM, "plasticity": SWIFT}, "friction.law"),
        (WEAR | {"plasticity": SWIFT}, "wear.strain_limit"),
        ({"counterbody": {"shape": "flat", "young": 2e11, "poisson": 0.3}}, "counterbody.young"),
        ({"counterbody": {"shape": "punch", "radius": 5e-6}}, "counterbody.shape"),
        ({"body": COATED}, "body.coating"),
    ],
)
def test_refused_by_name(tables, key):
    with pytest.raises(UnsupportedScene, match=key.replace(".", r"\.")):
        spatial.check(rough(two_tops, **tables))


def test_the_axisymmetric_model_refuses_them_too():
    with pytest.raises(UnsupportedScene, match=r"surface\.kind.*wear\.strain_limit"):
        fem_reference.check(rough(two_tops, plasticity=SWIFT, **WEAR))


def test_plan_knows_the_mesh():
    entry = next(each for each in plan(rough(two_tops, 16))["models"] if each["model"] == "fem-3d")
    assert entry["available"]
    mesh = next(stage for stage in entry["stages"] if stage["stage"] == "mesh")
    assert mesh["size"]["elements"] == int(np.prod(spatial.plan(rough(two_tops, 16)).lines.shape))


def test_the_file_is_that_of_the_recipe():
    text = (
        resources.files("verification").joinpath("scenes", "rough-asperities.csv").read_text(encoding="utf-8")
    )
    assert text == csv_text() and height_map(CELLS).cells == (48, 48)


# --- compare ------------------------------------------------------------------------------------------------


def test_compare_sees_a_wrong_load_and_a_missing_table():
    """Equal results pass every row; a spot that bears 3 % more fails its own row, a result without surface
    those that need it.
    """
    scene, fem = solved()
    rows = compare_scene(scene, fem, fem)
    assert all(row.passed for row in rows) and sum("load of the spot" in row.quantity for row in rows) == 2
    x, p = (np.asarray(fem.tables["surface"][name]) for name in ("x_m", "p_Pa"))
    heavier = {**fem.tables, "surface": {**fem.tables["surface"], "p_Pa": np.where(x < 0, 1.03 * p, p)}}
    rows = compare_scene(scene, replace(fem, tables=heavier), fem)
    assert [row.passed for row in rows if "load of the spot" in row.quantity] == [False, True]
    rows = compare_scene(scene, replace(fem, tables={}), fem)
    assert not {row.quantity: row.passed for row in rows}["p_Pa over the patch"]


def test_heights_on_the_counter_body_are_those_on_the_body():
    """Bit by bit but for the column of the heights, as the gap knows only their sum."""
    on_body = rough(two_tops, 16)
    table = CounterSurface(kind="file", path=on_body.surface.path)
    counterbody = on_body.counterbody.model_copy(update={"surface": table})
    opposite = on_body.model_copy(update={"surface": None, "counterbody": counterbody})
    one, two = spatial.solve(on_body), spatial.solve(opposite)
    assert two.quantities == one.quantities
    np.testing.assert_array_equal(two.tables["surface"]["p_Pa"], one.tables["surface"]["p_Pa"])
    np.testing.assert_array_equal(two.tables["surface"][COUNTER_HEIGHT], one.tables["surface"]["height_m"])
    assert not two.tables["surface"]["height_m"].any()
