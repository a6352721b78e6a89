# SPDX-License-Identifier: MIT
"""Yielding scenes in SAM: the solved state, steps that do not converge, grids about the plastic zone."""

from dataclasses import replace

import numpy as np
import pytest
from builders import LINEAR, PERFECT, RUN_IN_STEEL, running_in, scene, yielding
from plastic_start import begin, shrink_first_box

import sam
import sam.grid.demands
from sam import choose_grid
from sam.contact.convolution import Counters
from sam.elastic.problem import elastic_peak, solve_elastic
from sam.grid.cells import MOST_TIMES, RATIO, Room, Sides, enlarged
from sam.grid.demands import point_load_reach
from sam.planner.bodies import SHAPES, given_sides, hertz_semi_axes
from sam.planner.make import schedule_of
from sam.plasticity import history, load_step as plastic_step
from sam.plasticity.history import LONGER
from sam.scene import Scene, Status
from sam.scene.yield_curve import Swift
from sam.schedule import Load
from verification.reference.point_loads import boussinesq_stress
from verification.reference.stress import von_mises

FEW, SMALL = {"cells": (33, 33)}, {"cells": (17, 17)}


@pytest.fixture(scope="module")
def swift4():
    told = []
    result = sam.solve(
        yielding(4, loading={"steps": 4}, grid=FEW), progress=lambda *state: told.append(state)
    )
    assert ("load steps", 5, 5) in told  # the unloading too
    return result


def test_stress_is_on_the_yield_surface_where_it_strained(swift4):
    """Each point of a cell has its yield stress; the mean of their stresses is within that of their mean
    strain, by less than 0.2 %. A budget of work: a counter, not seconds (measured 25).
    """
    assert swift4.status is Status.CONVERGED and swift4.cost["operator_applications"] <= 32
    certificate = swift4.certificate
    assert certificate["yield_excess"] <= 1e-6 and certificate["flow_residual"] <= 1e-6
    assert certificate["yield_excess_outside_box"] == 0.0 and certificate["load_error"] < 1e-12
    assert certificate["gap_in_contact"] < 2e-8 and certificate["penetration"] < 2e-8
    axis = {name: np.asarray(column) for name, column in swift4.tables["axis"].items()}
    peak = axis["state"] == "peak"
    curve = Swift(945e6, 20, 0.121)
    strained = peak & (axis["peeq"] > 1e-5)
    assert strained.sum() >= 6
    share = axis["mises_Pa"][strained] / curve.stress(axis["peeq"][strained])
    assert (share > 1 - 2e-3).all() and (share < 1 + 1e-5).all()
    assert (axis["mises_Pa"][peak & (axis["peeq"] == 0)] <= curve.stress(0.0) * (1 + 1e-6)).all()


def test_the_body_is_of_cells_of_the_grid(swift4):
    body, grid = swift4.grids["peak"]["body"], choose_grid(yielding(4, loading={"steps": 4}, grid=FEW))
    for faces, centres, h in ((body.x, grid.x, grid.hx), (body.y, grid.y, grid.hy)):
        first = np.abs(centres - h / 2 - faces[0]).argmin()
        np.testing.assert_allclose(faces[1:] - h / 2, centres[first : first + len(faces) - 1], atol=1e-12 * h)
    np.testing.assert_allclose(body.z, grid.faces[: len(body.z)], rtol=1e-12)


def test_one_and_a_half_times_the_yield_stress_is_elastic():
    """First yield is at 1.6128: no operator is built, and the answer is the elastic one bit for bit."""
    a_scene = yielding(1.5, grid=FEW)
    result = sam.solve(a_scene)
    assert result.quantities["peeq_max"] == 0.0 and result.cost["operator_applications"] == 0
    assert any(entry.stage == "eigenstrain kernels" for entry in result.left_out)
    rows = solve_elastic(sam.plan(a_scene).problem(Counters()), lambda *_: None).rows
    assert result.tables["history"]["p_max_Pa"][-2] == rows[-2].p_max


@pytest.mark.parametrize(
    ("given", "shape"), [(yielding(3, grid=SMALL), (11, 17)), (running_in(wear=None, film=None), (8, 1))]
)
def test_the_elastic_peak_is_looked_for_in_one_plane_or_everywhere(given, shape):
    """Below a smooth body the plane y = 0; below a rough one the largest of each depth."""
    plan = sam.plan(given)
    assert elastic_peak(plan.problem(Counters()), plan.schedule.peak).mises.shape == shape


def test_the_first_box_does_not_matter(monkeypatch):
    """Started on a box that is too small in all directions, it grows, by sides, to the same answer."""
    given = yielding(3, grid=SMALL, friction=0.3)
    right = sam.solve(given)
    shrink_first_box(monkeypatch, x=3, y=2, less=4, layers=3)
    other = sam.solve(given)
    assert other.status is right.status is Status.CONVERGED
    for name in ("peeq_max", "residual_uz_center_m", "residual_ux_center_m"):
        assert other.quantities[name] == pytest.approx(right.quantities[name], rel=1e-4)


def test_unloading_in_steps_takes_equal_parts_of_the_force():
    loading = {"force": 0.4, "steps": 2, "unload_steps": 4}
    schedule = schedule_of(yielding(4, loading=loading))
    (unloading,) = (target for target in schedule.targets if not target.rises)
    steps = schedule.in_steps(unloading, schedule.peak)
    assert [step.load.force for step in steps] == pytest.approx([0.3, 0.2, 0.1, 0.0], rel=1e-12)


# steps that do not converge


@pytest.mark.parametrize("stop", ["stress", "strain"])
def test_the_papers_loops_meet_yield_but_not_the_flow_rule(stop):
    """One load step leaves a flow-rule residual of percents. Below yield the loops end without a strain."""
    solver = {"method": "paper", "stop": stop, "tolerance": 1e-4}
    given = yielding(4, loading={"unload": False}, grid=SMALL, solver=solver)
    wrong = sam.solve(given)
    assert wrong.certificate["yield_excess"] < 1e-3 and wrong.certificate["flow_residual"] > 1e-2
    assert any("flow-rule residual" in text for text in wrong.warnings)
    model, now = begin(given)
    trial = model.problem(now.extent).step(now.state, Load(given.loading.force / 4**3))
    assert trial.converged and trial.history == (0.0,) and trial.pressure.any()
    assert not trial.plastic and not trial.increment.points.strain.size


def test_a_step_too_large_is_cut(monkeypatch):
    monkeypatch.setattr(plastic_step, "ITERATIONS", 8)
    result = sam.solve(yielding(2.5, PERFECT, grid=SMALL))
    assert result.status is Status.CONVERGED and result.cost["step_cuts"] >= 1
    assert "cut into" in result.tables["history"]["note"][0]


def test_the_result_says_how_many_steps_needed_the_longer_iteration(monkeypatch):
    """From the first step that halving would not bring to converge; the answer is the same."""
    given = yielding(2.5, PERFECT, grid=SMALL, loading={"steps": 2})
    usual = sam.solve(given)
    monkeypatch.setattr(plastic_step, "ITERATIONS", 8)
    monkeypatch.setattr(history, "MOST_CUTS", 0)
    result = sam.solve(given)
    notes = result.tables["history"]["note"]
    longer = [LONGER in note for note in notes]
    assert result.status is usual.status and any(longer) and LONGER not in " ".join(usual.warnings)
    assert f"{sum(longer)} of {len(notes)} load steps" in " ".join(result.warnings)
    assert result.quantities["peeq_max"] == pytest.approx(usual.quantities["peeq_max"], rel=1e-3)
    assert result.cost["step_cuts"] == 0 and 0 in result.tables["residuals"]["accepted"]


# grids


def sides(grid) -> tuple[float, float]:
    """(side, depth) in m."""
    return grid.nx * grid.hx, float(grid.faces[-1])


@pytest.mark.parametrize(("nu", "profile", "bulk"), [(0.3, None, 1e9), (0.0, ((0.0, 3.0), (1e-6, 0.5)), 5e8)])
def test_the_zone_is_expected_where_a_point_force_brings_the_bulk_to_yield(nu, profile, bulk):
    """Against Boussinesq's stresses; the factor over depth counts where it is constant."""
    one = scene(body={"poisson": nu, "plasticity": PERFECT | ({"profile": profile} if profile else {})})
    depth = point_load_reach(one.loading.force, nu, bulk, 1.0)
    stress = boussinesq_stress(0.0, 0.0, depth, one.loading.force, nu=nu)
    assert von_mises(stress) == pytest.approx(bulk, rel=1e-9)


def test_a_chosen_grid_grows_with_the_load_at_the_same_cell_size():
    small, large = choose_grid(yielding(6, PERFECT)), choose_grid(yielding(10, PERFECT))
    (a, _), (b, _) = hertz_semi_axes(yielding(6, PERFECT)), hertz_semi_axes(yielding(10, PERFECT))
    assert sides(small) == pytest.approx((4 * a, 3 * a), rel=0.1) and small.nx == 65
    assert large.hx / b == pytest.approx(small.hx / a, rel=1e-12) and large.nx % 2 == 1
    assert sides(large)[0] > 4.6 * b and sides(large)[1] > 3.3 * b  # perfect plasticity reaches 2.3 and 3.0


@pytest.mark.parametrize(
    ("grid", "reached", "expected"),
    [
        (None, Sides(), None),
        (None, Sides(beside=True), Room(RATIO, 1.0)),
        (None, Sides(True, True), Room(RATIO, RATIO)),
        (SMALL, Sides(beside=True), None),
        (SMALL, Sides(below=True), Room(1.0, RATIO)),
        ({"layers": 6, "depth": 1e-4}, Sides(True, True), None),
        ({"layers": 6, "depth": 1e-4}, Sides(beside=True), Room(RATIO, 1.0)),
    ],
)
def test_what_the_user_gave_stays(grid, reached, expected):
    assert enlarged(given_sides(yielding(9, PERFECT, grid=grid)), Room(), reached) == expected


def test_a_grid_is_not_enlarged_without_end():
    most, given = Room(RATIO**MOST_TIMES, 1.0), given_sides(yielding(9, PERFECT))
    assert enlarged(given, most, Sides(beside=True)) is None
    assert enlarged(given, most, Sides(below=True)) == Room(most.beside, RATIO)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"extent": (13e-6, 13e-6)}, ("grid.extent", "beside", "19.5 um")),
        ({"layers": 6, "depth": 5e-6}, ("grid.depth", "below", "7.5 um")),
    ],
)
def test_a_given_grid_that_is_too_small_is_named_by_its_side(given, words):
    result = sam.solve(yielding(8, PERFECT, grid=SMALL | given, loading={"unload": False, "steps": 2}))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "grid_enlarged" not in result.discretisation
    assert all(word in result.message for word in words), result.message


@pytest.mark.parametrize("plasticity", [None, PERFECT])
def test_a_chosen_grid_is_enlarged_and_the_solve_can_be_continued(monkeypatch, plasticity):
    """4 cells in Hertz's radius, not told of the plastic zone: no load step is taken twice."""
    monkeypatch.setattr(sam.grid.demands, "PLASTIC_CELLS", 17)
    monkeypatch.setattr(sam.grid.demands, "FARTHEST", 0.0)
    monkeypatch.setattr(sam.grid.demands, "DEFAULT_CELLS", 25)
    given = yielding(7, PERFECT, loading={"steps": 2, "unload": False})
    if plasticity is None:
        given = scene(loading={"force": given.loading.force})
        monkeypatch.setitem(SHAPES, "sphere", replace(SHAPES["sphere"], extent=1.5))
    kept = []
    result = sam.solve(given, checkpoint=kept.append)
    assert result.converged and result.discretisation["grid_enlarged"]["beside"] > 1.0
    if plasticity:
        assert any("enlarged" in warning for warning in result.warnings)
        steps = list(result.tables["history"]["step"])
        assert steps == list(range(1, len(steps) + 1))
        again = sam.solve(given, start=kept[-2])
        assert again.discretisation == result.discretisation and again.quantities == result.quantities


def rough(plasticity=RUN_IN_STEEL, force=0.12, depths=None, **tables) -> Scene:
    """Rough, running in with film and wear; the scene gives no depths of its layers."""
    one = running_in(plasticity=plasticity, loading={"force": force}, **tables)
    return one.model_copy(update={"grid": one.grid.model_copy(update={"depths": depths})})


def test_the_layers_below_a_rough_body_go_as_deep_as_a_point_load_yields():
    """With faces at the kinks of the yield stress, and not beyond half of the patch."""
    profile = ((0.0, 0.6), (0.3e-6, 1.0), (5e-6, 1.0))
    layered = RUN_IN_STEEL | {"profile": profile, "layer_thickness": 0.5e-6, "layer": LINEAR}
    small, large, endless = (choose_grid(rough(layered, force)).faces for force in (0.06, 0.24, 1e3))
    reach = point_load_reach(0.24, 0.3, 1780e6 * 4**0.095, 1.0)
    assert large[-2] >= reach > small[-1] and endless[-3] < 8e-6 <= endless[-2]
    assert np.array_equal(small[:-2], large[: len(small) - 2])
    assert all(np.abs(large - kink).min() == 0 for kink in (0.3e-6, 0.5e-6, 5e-6))


def test_given_layers_below_a_rough_body_stay_and_the_message_says_how_deep_they_must_go():
    result = sam.solve(rough(depths=(0.0, 0.3e-6, 0.8e-6, 1.6e-6, 3e-6), cycles=1))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "grid_enlarged" not in result.discretisation
    assert 'grid.depths (or grid.depth) go down to "4.5 um"' in result.message
