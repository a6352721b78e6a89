# SPDX-License-Identifier: MIT
"""Removal between the cycles of a rough body in three-dimensional finite elements: its depths, the state that
moves up, and cycles with and without it.
"""

from functools import cache

import numpy as np
import pytest
from made_results import column

import fem_reference
from fem_reference.common.plasticity import History
from fem_reference.spatial import plan, worn_cycles
from fem_reference.spatial.rough import build, on_mesh
from fem_reference.spatial.worn import Limits, columns_of_points, depth_above, moved_up, own_depth
from sam.scene import HeightMap, Scene

CELLS, SIDE, RADIUS = 6, 4e-6, 20e-6
THICK = 20e-9  # m: of the layer that may be removed in a cycle
Z = np.array([1.0, 2.0, 4.0])


@cache
def scene(wear: bool = True) -> Scene:
    """A ball on few cells that yields below a rigid plane and slides."""
    x = ((np.arange(CELLS) + 0.5) / CELLS - 0.5) * SIDE
    heights = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    kinematic = {"modulus": (50e9,), "recovery": (50.0,)}
    content = {
        "body": {"young": 210e9, "poisson": 0.3},
        "counterbody": {"shape": "flat"},
        "surface": {"kind": "file", "path": HeightMap(heights, (SIDE, SIDE))},
        "loading": {"force": 0.02, "steps": 1, "unload": True, "cycles": 2},
        "friction": {"coefficient": 0.3},
        "fem": {"box": 4},
    }
    law = {"law": "linear", "yield_stress": 2e9, "modulus": 5e9, "kinematic": kinematic}
    content["body"]["plasticity"] = law | {"layer_thickness": THICK}
    limits = {"strain_limit": np.inf, "strain_limit_layer": 0.004, "smoothing_window": 0}
    return Scene(**content, **({"wear": limits} if wear else {}))


@cache
def model():
    return build(plan(scene(False)))


def test_a_profile_is_removed_down_to_its_first_crossing():
    strain = np.array([[3.0, 2.0, 0.0], [0.5, 3.0, 0.0], [3.0, 1.0, 3.0], [0.0, 0.0, 0.0], [0.8, 0.2, 0.0]])
    # the surface by the first two: 4, -2, 5, 0, 1.4
    assert depth_above(1.0, Z, strain) == pytest.approx([3.0, 0.0, 2.0, 0.0, 2.0 / 3.0])
    with pytest.raises(ValueError, match="all of a column"):
        depth_above(1.0, Z, np.array([[3.0, 2.0, 1.5]]))


def made_history(slope: float) -> History:
    """All fields linear over depth and constant in the plane."""
    z, virgin = model().body.points[2], History.virgin(model().problem.material.shape, 6, 1)
    field = 2.0 + slope * z
    return History(virgin.plastic_strain + 3.0 * field, virgin.peeq + field, back=virgin.back - field)


def test_the_state_moves_up_by_the_depth():
    """Exact for fields that are linear over depth, and nothing moves where nothing is removed."""
    depth = np.zeros((CELLS, CELLS))
    depth[2:4, 3:5] = 0.1
    before, z = made_history(0.5), model().body.points[2]
    after = moved_up(model(), before, on_mesh(model().plan, depth, 0.0))
    x, y = (np.clip(np.abs(model().body.points[k]), 0.0, None) for k in (0, 1))
    up = (after.peeq - before.peeq) / 0.5
    # the deepest points have nothing below them
    shallow = z < 0.5 * z.max()
    assert up[shallow].max() == pytest.approx(0.1, rel=1e-12) and up[shallow].min() > -1e-14
    far = (x > 1.0) | (y > 1.0)
    assert np.array_equal(after.peeq[far], before.peeq[far])
    assert after.plastic_strain[0] == pytest.approx(3.0 * after.peeq, abs=1e-12)
    assert after.back[0, 5] == pytest.approx(-after.peeq, abs=1e-12)


def test_depths_of_a_layer_end_where_it_does():
    """Strains 2.4 % at the surface, less by 1 % in 0.5 half sides."""
    points, unit = model().body.points, model().scales
    peeq = np.maximum(0.024 - 0.02 * points[2], 0.0) / unit.strain
    history = History(np.zeros((6, *peeq.shape)), peeq)
    state = model().virgin()
    state = type(state)(*(history if name == "history" else getattr(state, name) for name in vars(state)))
    for limits, depth in (
        (Limits(0.004, 0.004, 0.0), 1.0),
        (Limits(np.inf, 0.02, 0.05 * unit.length), 0.05),
        (Limits(np.inf, 0.023, 0.1 * unit.length), 0.05),
        (Limits(0.014, 0.02, 0.1 * unit.length), 0.5),
    ):
        found = own_depth(model(), state, limits) / unit.length
        assert found == pytest.approx(np.full((CELLS, CELLS), depth), rel=1e-9)


def test_points_stand_in_columns():
    points = model().body.points.reshape(3, -1)[:, columns_of_points(model())]
    assert (np.diff(points[2], axis=2) > 0).all() and np.ptp(points[:2], axis=3).max() < 1e-12


def test_without_removal_the_cycles_are_those_of_a_solve():
    none = np.zeros((CELLS, CELLS))
    cycles = worn_cycles(scene(), [none, none])
    plain = fem_reference.spatial.solve(scene(False))
    assert np.array_equal(cycles[-1].tables["surface"]["p_Pa"], column(plain, "surface", "p_Pa"))
    assert cycles[-1].peeq_max == plain.quantities["peeq_max"]
    assert not cycles[-1].worn.any()


def test_what_is_removed_no_longer_bears():
    first, last = worn_cycles(scene())
    assert first.worn.max() == THICK and (last.worn >= first.worn).all()
    p = np.reshape(first.tables["surface"]["p_Pa"], (CELLS, CELLS))
    assert (p[first.worn > 0] > 0).mean() > 0.5
    deepest = np.unravel_index(first.worn.argmax(), first.worn.shape)
    assert np.reshape(last.tables["surface"]["p_Pa"], (CELLS, CELLS))[deepest] < p[deepest]
