# SPDX-License-Identifier: MIT
"""The return map at the Gauss points of a cell: linear fields, mirrored boxes, and its fixed point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sam.contact.convolution import Counters, Transforms
from sam.plasticity import load_step as step
from sam.plasticity.flow import Material, deviator, equivalent_strain, mises
from sam.plasticity.points import POINTS, CellFlow, Linear, stress_at_points, whole
from sam.plasticity.spectra import ODD_X, ODD_Y
from sam.plasticity.state import MaterialFields
from sam.scene.yield_curve import Layered, Linear as LinearLaw, Swift

MU = 80e9
CELLS = (7, 6)


def every(shape) -> np.ndarray:
    return np.ones(shape, dtype=bool)


def smooth(cells=CELLS, layers=2) -> np.ndarray:
    """A tensor field (6, n_layers, nx, ny) with the parities of a mirrored scene, in Pa."""
    x, y = ((np.arange(n) - (n - 1) / 2) / 3 for n in cells)
    parts = [
        np.multiply.outer(np.sin(x) if odd_x else np.cos(x), np.sin(y) if odd_y else 1 - y**2)
        for odd_x, odd_y in zip(ODD_X, ODD_Y, strict=True)
    ]
    field = np.arange(1.0, 7.0)[:, None, None] / 6 * parts
    return 0.5e9 * np.stack([(k + 1) * field for k in range(layers)], axis=1)


def test_a_linear_field_is_exact_at_the_points():
    """Of the Gauss rule with two points in x and in y; the mean over the points is that of the cell."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    field = np.broadcast_to(2 + 3 * x - 5 * y, (6, 1, 5, 4))
    found = Linear((5, 4)).at_points(field, every((1, 5, 4))).reshape(6, POINTS, 1, 5, 4)
    at = 0.5 / np.sqrt(3)
    for point, (i, j) in enumerate(((-at, -at), (-at, at), (at, -at), (at, at))):
        assert found[:, point] == pytest.approx(field + 3 * i - 5 * j, rel=1e-14)
    assert found.mean(axis=1) == pytest.approx(field, rel=1e-14)


@pytest.mark.parametrize("mirror", [(False, False), (False, True), (True, True)])
@pytest.mark.parametrize("cells", [CELLS, (6, 7), (1, 2), (2, 1)])
def test_a_mirrored_box_gives_what_the_whole_one_does(mirror, cells):
    """Components that are odd in x or in y change sign across the mirror, and the points their places."""
    field, transforms = smooth(cells), Transforms(cells, mirror, single=False, counters=Counters())
    kept = transforms.keep(field)
    half = Linear(cells, mirror).at_points(kept, every(kept.shape[1:])).reshape(6, POINTS, *kept.shape[1:])
    full = Linear(cells).at_points(field, every(field.shape[1:])).reshape(6, POINTS, *field.shape[1:])
    assert whole(transforms, half) == pytest.approx(full, abs=1e-5)
    assert whole(transforms, half[0]) == pytest.approx(full[0], abs=1e-5)
    assert whole(transforms, np.stack([half, 2 * half]))[1] == pytest.approx(2 * full, abs=1e-5)


def test_cells_that_are_left_out_cannot_yield():
    """The bound on von Mises at the points holds for any field, mirrored ones included."""
    rng = np.random.default_rng(3)
    for mirror in ((False, False), (True, True)):
        transforms = Transforms((8, 7), mirror, single=False, counters=Counters())
        field = deviator(rng.standard_normal((6, 3, *transforms.shape)))
        linear = Linear((8, 7), mirror)
        at_points = linear.at_points(field, every(field.shape[1:])).reshape(6, POINTS, *field.shape[1:])
        assert (mises(at_points).max(axis=0) <= linear.farthest(mises(field)) * (1 + 1e-12)).all()


def test_at_the_sides_the_bound_is_reached_by_a_field_that_changes_its_sign():
    field = np.zeros((6, 1, 2, 2))
    field[5] = 1e9 * np.array([[1.0, -2.0], [-3.0, 5.0]])
    largest = mises(Linear((2, 2)).at_points(field, every((1, 2, 2))).reshape(6, POINTS, 1, 2, 2)).max(axis=0)
    assert Linear((2, 2)).farthest(mises(field)) == pytest.approx(largest, rel=1e-12)


def test_a_part_of_a_cell_that_strains_lowers_its_stress_nearly_as_a_sphere_does():
    """By mu of twice its strain, as docs/theory.md says; Eshelby's sphere: (7 - 5 nu)/(15 (1 - nu)) 2 mu."""
    nu = 0.3
    assert step.STIFFNESS == 0.5
    assert 2 * step.STIFFNESS == pytest.approx(2 * (7 - 5 * nu) / (15 * (1 - nu)), rel=0.05)


MATERIALS = {
    "perfect": Material(MU, LinearLaw(1e9), np.ones((2, 1, 1))),
    "layered": Material(
        MU,
        Layered(Swift(945e6, 20.0, 0.121), LinearLaw(1e9, 50e9), np.array([True, False]).reshape(2, 1, 1)),
        np.array([1.0, 0.8]).reshape(2, 1, 1),
    ),
}


@pytest.mark.parametrize("name", MATERIALS)
def test_two_steps_end_on_the_yield_surface_of_each_point(name):
    """Cells that relax by 2 mu of their strain: at the fixed point each point that flows has its yield
    stress, the mean over the points is the strain of the cell, and the same load again strains nothing.
    """
    material, load = MATERIALS[name], deviator(smooth())
    transforms = Transforms(CELLS, (False, False), single=False, counters=Counters())
    state, x = material.virgin((POINTS, 2, *CELLS)), np.zeros_like(load)
    for size in (1.0, 1.5, 1.5):
        flow, x = CellFlow(material, state, transforms, MU / 2), np.zeros_like(load)
        for _ in range(400):
            s = size * load - 2 * MU * (state.means().strain + x)
            found = flow.returned(x, s)
            if max(found.yield_excess, found.flow_residual) < 1e-12:
                break
            x = x + (found.image - x) / 2
        assert found.flow_residual < 1e-12
        increment = flow.increment(found)
        assert increment.means().strain == pytest.approx(x, abs=1e-17)
        before, state = state, state.plus(increment)
        stress = mises(stress_at_points(s, state.strain, MU / 2))
        limit, flows = material.yield_stress(state.peeq), increment.peeq > 1e-9
        assert (stress <= limit * (1 + 1e-11)).all()
        assert stress[flows] == pytest.approx(limit[flows], rel=1e-9)
    assert (
        before.peeq.max() > 1e-4 and (before.peeq.min(axis=0) < 1e-12)[before.peeq.max(axis=0) > 1e-9].any()
    )
    assert not flows.any() and equivalent_strain(x).max() < 1e-12


def test_a_change_below_the_tolerance_strains_no_point():
    """What a step accepts without an increment of the cells leaves the points as they are."""
    material, load = MATERIALS["perfect"], deviator(smooth())
    transforms = Transforms(CELLS, (False, False), single=False, counters=Counters())
    flow = CellFlow(material, material.virgin((POINTS, 2, *CELLS)), transforms, MU / 2)
    found = flow.returned(np.zeros_like(load), load)
    assert found.image.any() and not flow.increment(found).strain.any()
    size = np.sqrt((found.image[:3] ** 2).sum(axis=0) + 2 * (found.image[3:] ** 2).sum(axis=0)).max()
    assert found.flow_residual == pytest.approx(MU * size / 1e9, rel=1e-12)
    assert isinstance(flow.increment(found), MaterialFields)


def test_a_step_is_accepted_only_if_flow_rule_and_yield_condition_both_hold():
    """Points beyond their yield stress are seen although the increment is that of the return map."""
    material, load = MATERIALS["perfect"], deviator(smooth())
    transforms = Transforms(CELLS, (False, False), single=False, counters=Counters())
    flow = CellFlow(material, material.virgin((POINTS, 2, *CELLS)), transforms, MU / 2)
    right = replace(flow.returned(np.zeros_like(load), load), flow_residual=1e-4)
    beyond = replace(right, stress=1.2e9 / mises(right.stress).max() * right.stress)
    assert beyond.worst(1e-3) == beyond.yield_excess == pytest.approx(0.2, rel=1e-12)
    assert beyond.worst(1e-5) == 1e-4  # not accepted either way
    assert replace(right, stress=0.5 * beyond.stress).worst(1e-3) == 1e-4
