# SPDX-License-Identifier: MIT
"""A rigid sphere that moves over the body in three dimensions: its schedule, Hertz at each place, the
groove.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import RADIUS, SWIFT, SWIFT_YIELD, hertz_force, scene as small_scene

import sam
from fem_reference import spatial
from fem_reference.common.loading import run
from fem_reference.spatial.model import build
from fem_reference.spatial.solution import METHOD
from sam.planner.make import schedule_of
from verification.compare.comparison import compare_scene

ELASTIC = {"cells_per_radius": 4, "box": 4}
COARSE = {"cells_per_radius": 3, "box": 4}
FORCE = hertz_force(4 * SWIFT_YIELD)
A = (0.75 * FORCE * RADIUS * (1 - 0.3**2) / 210e9) ** (1 / 3)


def moving(length, count, friction=0.0, *, plastic=True, fem=COARSE, back=False, turns="lifted", **loading):
    """Over `length` contact radii of Hertz about the origin, along x or against it."""
    ends = (-length / 2 * A, 0.0), (length / 2 * A, 0.0)
    start, end = ends[::-1] if back else ends
    path = {"start": start, "end": end, "steps": count, "return": turns}
    return small_scene(
        body={"plasticity": SWIFT if plastic else None},
        loading={"force": FORCE, "path": path, **loading},
        friction=friction,
        fem=fem,
        solver={"tolerance": 1e-4},
    )


@pytest.mark.parametrize("turns", ["lifted", "to-and-fro"])
@pytest.mark.parametrize("unload", [True, False])
@pytest.mark.parametrize("back", [True, False])
def test_the_steps_are_those_of_sam(turns, unload, back):
    scene = moving(3, 4, 0.2, turns=turns, back=back, unload=unload, cycles=3, steps=2)
    plan = spatial.plan(scene)
    unit = plan.scales
    found = [
        (t.cycle, t.number, t.load.x * unit.length, t.load.force * unit.force / unit.peak_force, t.load.ratio)
        for t in plan.schedule.targets
    ]
    expected = [
        (t.cycle, t.step, t.load.x, t.load.force, 0.2 * t.load.sign) for t in schedule_of(scene).targets
    ]
    assert np.array(found) == pytest.approx(np.array(expected), rel=1e-12, abs=1e-18)
    assert [t.unloads for t in plan.schedule.targets] == [not t.rises for t in schedule_of(scene).targets]


def test_an_elastic_contact_is_that_of_hertz_wherever_it_is():
    """Places half an element and a whole one apart, the approach given: force within 1.5 % as 4 elements in
    the radius and a small box leave it, area within 1 %, as its edge is found inside elements; those at a
    whole distance equal to 1e-3, as the box is another one about each.
    """
    given = {"force": None, "approach": A**2 / RADIUS}
    model = build(spatial.plan(moving(0.5, 4, plastic=False, fem=ELASTIC, **given)))
    states = [step.state for step in run(model, model.plan.schedule)]
    assert [state.load.x for state in states] == pytest.approx([-0.25, -0.125, 0.0, 0.125, 0.25], abs=1e-12)
    for state in states:
        assert state.converged and state.approach == pytest.approx(1.0, rel=1e-12)
        assert state.force == pytest.approx(4 / 3, rel=0.015)
        assert model.area(state) / np.pi == pytest.approx((0.75 * state.force) ** (2 / 3), rel=0.01)
        assert model.centroid(state) == pytest.approx(state.load.x, abs=0.02)
    first, middle, last = (np.array([state.force, model.area(state)]) for state in states[::2])
    assert first == pytest.approx(middle, rel=1e-3) and last == pytest.approx(middle, rel=1e-3)


def unloaded(result):
    """x over the contact radius of Hertz, u_z over that, of the unloaded surface on y = 0."""
    line = result.tables["line"]
    here = np.asarray(line["state"]) == "unloaded"
    return np.asarray(line["x_m"])[here] / A, np.asarray(line["uz_m"])[here] / A


@pytest.fixture(scope="module")
def both():
    """Both models on five and a half radii in steps of almost a radius, with friction."""
    scene = moving(5.5, 6, 0.2, unload=True)
    return [solve(scene) for solve in (spatial.solve, sam.solve)]


def test_the_groove_is_that_of_sam(both):
    """3 elements in the radius: the whole groove within 15 % of its depth, deepest behind the start, a higher
    shoulder where the sphere stops.
    """
    (x, groove), (places, other) = map(unloaded, both)
    other = np.interp(x, places, other)
    assert groove == pytest.approx(other, abs=0.15 * other.max())
    for each in (groove, other):
        assert -2.75 < x[each.argmax()] < -1.75
        assert each[x < -2.75].min() > 1.5 * each[x > 2.75].min()


def test_the_tables_of_the_track_are_those_of_sam(both):
    """Lengths to 15 % of the depth, the strain to 10 % and forces to 1 %, of the pressure alone to a share of
    the slope at the edge of the contact.
    """
    fem, other = both
    for name in ("history", "track", "cross", "passes"):
        assert list(fem.tables[name]) == list(other.tables[name])
    values, expected = fem.quantities, other.quantities
    depth = expected["groove_depth_m"]
    for name in (
        "groove_depth_m",
        "groove_deepest_m",
        *(f"shoulder_{end}_m" for end in ("start", "end", "side")),
    ):
        assert values[name] == pytest.approx(expected[name], abs=0.15 * depth), name
    assert values["groove_deepest_x_m"] == pytest.approx(expected["groove_deepest_x_m"], abs=0.3 * A)
    assert values["rolling_coefficient"] == pytest.approx(
        expected["rolling_coefficient"], abs=0.02 * A / RADIUS
    )
    passes, known = fem.tables["passes"], other.tables["passes"]
    assert (passes["pass"], passes["direction"]) == ([1], [1])
    steady = np.asarray(fem.tables["track"]["uz_m"])[np.asarray(fem.tables["track"]["steady"]) == 1]
    assert steady.min() <= passes["groove_m"][0] <= steady.max()
    assert passes["new_strain_max"] == pytest.approx(known["new_strain_max"], rel=0.1)
    assert passes["fx_mean_N"] == pytest.approx(known["fx_mean_N"], rel=0.01)
    history, steps = fem.tables["history"], other.tables["history"]
    assert history["s_m"] == pytest.approx(steps["s_m"], rel=1e-9, abs=1e-15)
    assert history["fx_N"] == pytest.approx(steps["fx_N"], abs=0.01 * 0.2 * FORCE)
    assert history["pressure_offset_m"][:-1] == pytest.approx(steps["pressure_offset_m"][:-1], abs=0.01 * A)
    for table, column in (
        ("track", "deep_sxx_Pa"),
        ("cross", "syy_Pa"),
        ("cross", "uz_m"),
        ("cross", "peeq"),
    ):
        first, second = (np.nan_to_num(each.tables[table][column]) for each in both)
        largest = max(np.abs(second).max(), depth if column == "uz_m" else 0.0)
        assert first[np.abs(first).argmax()] == pytest.approx(
            second[np.abs(second).argmax()], abs=0.15 * largest
        )


def test_a_comparison_has_the_groove(both):
    """In place of the pressure about the origin, where the contact is not any more."""
    fem, other = both
    scene = moving(5.5, 6, 0.2, unload=True)
    rows = {row.quantity: row for row in compare_scene(scene, other, fem)}
    assert not {"p_center_Pa", "p_Pa over the contact"} & set(rows)
    for name in ("groove_depth_m", "groove_deepest_m"):
        assert (rows[name].value, rows[name].expected) == (other.quantities[name], fem.quantities[name])
        for factor, passes in ((1.04, True), (1.06, False)):
            changed = replace(fem, quantities={**fem.quantities, name: factor * fem.quantities[name]})
            found = {row.quantity: row.passed for row in compare_scene(scene, changed, fem)}
            assert found[name] is passes


def test_backwards_is_the_mirror_image():
    """With friction along the motion: displacements to the accuracy of the contact search."""
    forth, back = (
        unloaded(spatial.solve(moving(0.5, 1, 0.2, unload=True, back=back))) for back in (False, True)
    )
    assert forth[0] == pytest.approx(-back[0][::-1], abs=1e-12)
    assert forth[1] == pytest.approx(back[1][::-1], abs=1e-7 * forth[1].max())
    assert abs(forth[1] - forth[1][::-1]).max() > 0.05 * forth[1].max()


def test_resumed_passes_are_equal_and_hold_what_results_read():
    """Two passes, resumed inside the second one: equal to the last digit. Of the states inside a pass only
    those that a step begins from have displacements; the history is that of all states.
    """
    scene, records = moving(0.4, 1, unload=True, cycles=2, steps=1, fem={"cells_per_radius": 3, "box": 3}), []
    whole = spatial.solve(scene, checkpoint=records.append)
    again = spatial.solve(scene, start=records[-3])
    for name in ("history", "passes", "track", "line"):
        for column, values in whole.tables[name].items():
            np.testing.assert_array_equal(values, again.tables[name][column], column)
    model, steps = spatial.load_steps(scene, records[-1])
    held = [bool(step.state.u.size) for step in steps]
    assert held == [a.cycle != b.cycle or b.unloads for a, b in pairwise(steps)] + [True]
    assert held.count(False) == 2
    full = run(model, model.plan.schedule)
    found = [METHOD.peeq_max(model, step.state) for step in full]
    assert np.array_equal(found, whole.tables["history"]["peeq_max"])
