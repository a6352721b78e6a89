# SPDX-License-Identifier: MIT
"""Rough contact by finite elements: maps of friction, a moving counter-body, removal between cycles."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import LINEAR, scene
from made_results import column
from rounding import EPS, close

from fem_reference import spatial
from fem_reference.common.plasticity import History
from fem_reference.common.schedule import Load
from fem_reference.spatial import worn_cycles
from fem_reference.spatial.rough import build, on_mesh
from fem_reference.spatial.worn import Limits, columns_of_points, depth_above, moved_up, own_depth
from sam.scene import COUNTER_HEIGHT, FrictionMap, HeightMap, Scene, load_scene
from verification.scenes.asperities import CELLS, height_map

SIDE = 12e-6


def centres(n, side=SIDE):
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def two_tops(x, y):
    """Two spots of unequal load, none in the middle, nothing symmetric."""
    first = 130e-9 * np.exp(-((x + 2.9e-6) ** 2 / (2 * 1.6e-6**2)) - (y - 1.1e-6) ** 2 / (2 * 2.2e-6**2))
    return first + 118e-9 * np.exp(-((x - 2.9e-6) ** 2 + (y + 0.9e-6) ** 2) / (2 * 1.7e-6**2))


def rough(n=16, height=two_tops, *, side=SIDE, cells=None, **tables):
    """A plane on heights height(x, y) on n x n cells, or cells; a short box."""
    cells = cells or (n, n)
    sides = tuple(side * k / max(cells) for k in cells)
    x, y = (centres(k, length) for k, length in zip(cells, sides, strict=True))
    surface = {"kind": "file", "path": HeightMap(height(x[:, None], y[None, :]), sides)}
    content = {"counterbody": {"shape": "flat"}, "surface": surface, "fem": {"box": 4}}
    return scene(**content | {"loading": {"force": 0.04}} | tables)


def friction_map(values):
    return {"law": "map", "path": FrictionMap(values, (SIDE, SIDE))}


def test_a_map_on_a_smooth_body_is_the_constant():
    """The whole body with a map of one value against half of it: equal to the accuracy of the loop."""
    fem, grid = {"cells_per_radius": 3, "box": 4}, {"cells": [4, 4], "extent": [20e-6, 20e-6]}
    values = FrictionMap(np.full((4, 4), 0.2), (20e-6, 20e-6))
    half = spatial.solve(scene(fem=fem, friction=0.2))
    whole = spatial.solve(scene(fem=fem, friction={"law": "map", "path": values}, grid=grid))
    assert (half.discretisation["symmetry"], whole.discretisation["symmetry"]) == ("half, y >= 0", "none")
    for name in "approach_m p_max_Pa pressure_centroid_x_m friction_coefficient contact_area_m2".split():
        assert whole.quantities[name] == close(half.quantities[name], 1e-6)


def test_a_coarse_contact_is_not_called_converged():
    """Fewer nodes than one resolved spot has."""
    result = spatial.solve(rough(8, loading={"force": 1e-3}))
    assert result.status == "under-resolved" and "give a finer surface.path" in result.message


def test_surface_nodes_are_the_centres_of_the_cells():
    made = spatial.plan(rough(cells=(18, 12)))
    model, unit = build(made), made.scales.length
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
    model, load, unit = build(made), Load(4 / 3, 0.0, 0.1, 0.05), made.scales
    x, y = (np.meshgrid(*made.patch.centres, indexing="ij")[k] for k in (0, 1))
    inside, moved = np.isfinite(model.initial_gap), model.at(load)
    x, y = x - 0.1 * unit.length, y - 0.05 * unit.length
    assert moved.place == (0.1, 0.05)
    for direction, slope in (((1.0, 0.0), x / 400e-6), ((0.0, 1.0), y / 300e-6)):
        assert model.slope(load, direction)[inside] == pytest.approx(slope.ravel(), abs=1e-15)
    height = x**2 / 800e-6 + y**2 / 600e-6 - model.heights
    gap = moved.initial_gap[inside] * unit.displacement
    assert gap == pytest.approx((height - model.first).ravel(), abs=1e-12 * np.ptp(height))
    grid = {"cells": (12, 12), "extent": (SIDE, SIDE), "border": "relief"}
    wave = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": SIDE}
    lowered, plain = (
        build(spatial.plan(rough(12, surface=wave, grid=grid | {"border": border}))).heights
        for border in ("relief", "free")
    )
    assert np.array_equal(lowered[5:7, 5:7], plain[5:7, 5:7]) and lowered[0, 0] < plain[0, 0]


def test_the_map_is_read_where_the_nodes_are():
    values = np.repeat(np.linspace(0.1, 0.4, 12)[None, :], 12, axis=0)
    made = spatial.plan(rough(12, friction=friction_map(values)))
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
PATH = {"start": (-1.5 * CELL, 0.0), "end": (1.5 * CELL, 0.0), "steps": 3}
WAVE = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": 20 * CELL, "wavelength_y": 20 * CELL}


def sliding(counter=WAVE, *, path=PATH, plasticity=None) -> Scene:
    """A plane with a wave that slides three cells over 10 x 10."""
    return scene(
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
    moved, end = spatial.solve(sliding()), sliding().counter_strip.at(0, PATH["end"])
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
    result = spatial.solve(sliding(path=PATH | {"steps": 1}, plasticity=law))
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
    return build(spatial.plan(wearing(False)))


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
