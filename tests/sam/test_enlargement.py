# SPDX-License-Identifier: MIT
"""A grid that the program chose follows the plastic zone, before the solve and during it; one that the user
gave stays.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import RUN_IN_STEEL, hertz_force, running_in, scene as small_scene
from plastic_start import begin

import sam
import sam.grid.smooth
import sam.planner.bodies
import sam.solver
from sam import choose_grid
from sam.grid.cells import MOST_TIMES, RATIO, Room, Sides, enlarged
from sam.grid.smooth import FARTHEST, point_load_reach
from sam.planner.bodies import SHAPES, given_sides, hertz_semi_axes
from sam.plasticity.history import on_larger_grid
from sam.scene import Body, Scene, Status
from verification.reference.point_loads import boussinesq_stress
from verification.reference.stress import von_mises

YOUNG, POISSON, RADIUS, YIELD = 200e9, 0.3, 1e-3, 750e6
HARDENING = {"law": "linear", "yield_stress": YIELD, "modulus": 0.02 * YOUNG / 0.98}
PERFECT = {"law": "perfect", "yield_stress": YIELD}
NO_ROOM = Room()


def scene(ratio: float, law=PERFECT, grid=None, **loading):
    """A rigid sphere; ratio: Hertz's largest pressure over the yield stress."""
    force = hertz_force(ratio * YIELD, RADIUS, YOUNG / (1 - POISSON**2))
    return small_scene(
        body={"young": YOUNG, "poisson": POISSON, "plasticity": law},
        counterbody={"radius": RADIUS},
        loading={"force": force, "steps": 4, **loading},
        grid=grid,
    )


def sides(grid) -> tuple[float, float]:
    """(side, depth) in m."""
    return grid.nx * grid.hx, float(grid.faces[-1])


@pytest.fixture
def coarse(monkeypatch):
    """Chosen grids have 4 cells in Hertz's radius, and are not told of the plastic zone beforehand."""
    monkeypatch.setattr(sam.grid.smooth, "PLASTIC_CELLS", 17)
    monkeypatch.setattr(sam.grid.smooth, "FARTHEST", 0.0)


def test_the_zone_is_expected_where_a_point_force_brings_the_bulk_to_yield():
    """Against Boussinesq's stresses; the factor over depth counts where it is constant."""
    law = PERFECT | {"profile": ((0.0, 3.0), (1e-6, 0.5))}
    for nu, plasticity, bulk in ((0.3, PERFECT, YIELD), (0.0, PERFECT, YIELD), (0.3, law, YIELD / 2)):
        one = scene(5, plasticity)
        one = one.model_copy(update={"body": one.body.model_copy(update={"poisson": nu})})
        depth = point_load_reach(one.loading.force, nu, bulk, 1.0)
        stress = boussinesq_stress(0.0, 0.0, depth, one.loading.force, nu=nu)
        assert von_mises(stress) == pytest.approx(bulk, rel=1e-9)


@pytest.mark.parametrize("law", [PERFECT, HARDENING])
def test_a_chosen_grid_grows_with_the_load_at_the_same_cell_size(law):
    small, large = choose_grid(scene(6, law)), choose_grid(scene(10, law))
    (a, _), (b, _) = hertz_semi_axes(scene(6, law)), hertz_semi_axes(scene(10, law))
    assert sides(small) == pytest.approx((4 * a, 3 * a), rel=0.1) and small.nx == 65
    assert large.hx / b == pytest.approx(small.hx / a, rel=1e-12) and large.nx % 2 == 1
    assert sides(large)[0] > 4.6 * b and sides(large)[1] > 3.3 * b  # perfect plasticity reaches 2.3 and 3.0


def _first(one: Scene) -> float:
    """Yield stress in Pa of unstrained material."""
    return float(one.body.plasticity.curve().stress(np.zeros(1))[0])


def test_a_vanishing_yield_stress_does_not_make_the_grid_endless():
    vanishing = scene(10, {"law": "swift", "B": 945e6, "C": 1e-15, "n": 0.121})
    a, _ = hertz_semi_axes(vanishing)
    assert point_load_reach(vanishing.loading.force, POISSON, _first(vanishing), a) == FARTHEST * a


@pytest.mark.parametrize(
    ("grid", "reached", "expected"),
    [
        (None, Sides(), None),
        (None, Sides(beside=True), Room(RATIO, 1.0)),
        (None, Sides(below=True), Room(1.0, RATIO)),
        (None, Sides(True, True), Room(RATIO, RATIO)),
        ({"cells": (17, 17)}, Sides(beside=True), None),
        ({"cells": (17, 17)}, Sides(below=True), Room(1.0, RATIO)),
        ({"extent": (1e-4, 1e-4)}, Sides(beside=True), None),
        ({"layers": 6, "depth": 1e-4}, Sides(below=True), None),
        ({"layers": 6, "depth": 1e-4}, Sides(True, True), None),
        ({"layers": 6, "depth": 1e-4}, Sides(beside=True), Room(RATIO, 1.0)),
    ],
)
def test_what_the_user_gave_stays(grid, reached, expected):
    assert enlarged(given_sides(scene(9, grid=grid)), NO_ROOM, reached) == expected


def test_a_grid_is_not_enlarged_without_end():
    most = Room(RATIO**MOST_TIMES, 1.0)
    assert enlarged(given_sides(scene(9)), most, Sides(beside=True)) is None
    assert enlarged(given_sides(scene(9)), most, Sides(below=True)) == Room(most.beside, RATIO)


@pytest.mark.parametrize(
    ("grid", "named"),
    [
        ({"cells": (17, 17), "extent": (1.2e-4, 1.2e-4)}, ("grid.extent", "beside", "180 um")),
        ({"cells": (17, 17), "layers": 8, "depth": 5e-5}, ("grid.depth", "below", "75 um")),
    ],
)
def test_a_given_grid_that_is_too_small_is_named_by_its_side(grid, named):
    result = sam.solve(scene(8, grid=grid, unload=False))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "grid_enlarged" not in result.discretisation
    assert all(word in result.message for word in named)


def test_enlarged_during_the_solve_it_is_the_answer_of_the_larger_grid(coarse, monkeypatch):
    """The state is kept: no load step is taken twice, and the quantities are those of the larger grid from
    the beginning.
    """
    small = sam.solve(scene(9))
    grown = small.discretisation["grid_enlarged"]
    assert small.converged and grown["beside"] > 1.0
    assert any("enlarged" in warning for warning in small.warnings)
    assert list(small.tables["history"]["step"]) == list(range(1, len(small.tables["history"]["step"]) + 1))
    whole = sam.plan(scene(9)).on(Room(**grown)).grid
    monkeypatch.setattr(sam.solver, "plan_of", lambda bodies: replace(sam.plan(bodies.scene), grid=whole))
    large = sam.solve(scene(9))
    assert large.discretisation["cells"] == small.discretisation["cells"]
    for name in ("approach_m", "p_max_Pa", "peeq_max", "mises_max_Pa"):
        # each step is solved to 1e-6 of the yield stress, from another start
        assert small.quantities[name] == pytest.approx(large.quantities[name], rel=1e-4)
    assert small.cost["operator_applications"] >= large.cost["operator_applications"]


def test_a_solve_on_an_enlarged_grid_can_be_continued(coarse):
    kept = []
    result = sam.solve(scene(9), checkpoint=kept.append)
    again = sam.solve(scene(9), start=kept[-2])
    assert again.discretisation == result.discretisation and again.warnings == result.warnings
    assert again.quantities == result.quantities
    for name in ("contact_iterations", "plastic_iterations", "operator_applications", "ffts"):
        assert again.cost[name] == result.cost[name]


def test_a_contact_that_outgrows_a_chosen_grid_is_given_room(coarse, monkeypatch):
    monkeypatch.setitem(SHAPES, "sphere", replace(SHAPES["sphere"], extent=1.5))
    monkeypatch.setattr(sam.grid.smooth, "DEFAULT_CELLS", 25)
    elastic = scene(9).model_copy(update={"body": Body(young=YOUNG, poisson=POISSON)})
    result = sam.solve(elastic)
    a, _ = hertz_semi_axes(elastic)
    assert result.converged and result.discretisation["grid_enlarged"] == {"beside": RATIO, "below": 1.0}
    assert result.quantities["contact_radius_m"] == pytest.approx(a, rel=0.02)


LAYERED = RUN_IN_STEEL | {
    "profile": ((0.0, 0.6), (0.3e-6, 1.0), (5e-6, 1.0)),
    "layer_thickness": 0.5e-6,
    "layer": {**RUN_IN_STEEL, "alpha": 1e3},
}


def rough(plasticity=RUN_IN_STEEL, force=0.12, depths=None, **tables) -> Scene:
    """Rough, running in with film and wear; the scene gives no depths of its layers."""
    one = running_in(plasticity=plasticity, loading={"force": force}, **tables)
    return one.model_copy(update={"grid": one.grid.model_copy(update={"depths": depths})})


def test_the_layers_below_a_rough_body_go_as_deep_as_a_point_load_yields():
    """Deeper with the load, at the same layers above, with faces at the kinks of the yield stress, and not
    beyond half of the patch.
    """
    small, large, endless = (choose_grid(rough(LAYERED, force)).faces for force in (0.06, 0.24, 1e3))
    reach = point_load_reach(0.24, POISSON, _first(rough()), 1.0)
    assert large[-2] >= reach > small[-1] and endless[-3] < 8e-6 <= endless[-2]
    assert np.array_equal(small[:-2], large[: len(small) - 2])
    assert all(np.abs(large - kink).min() == 0 for kink in (0.3e-6, 0.5e-6, 5e-6))


def test_layers_below_a_rough_body_are_added_when_the_zone_reaches_the_last(monkeypatch):
    """Over cycles with film and wear: no load step is taken twice, and the answer is that of layers that were
    deep enough from the beginning.
    """
    deep = sam.solve(rough())
    reach = sam.planner.bodies.point_load_reach
    monkeypatch.setattr(sam.planner.bodies, "point_load_reach", lambda *numbers: 0.6 * reach(*numbers))
    kept = []
    grown = sam.solve(rough(), checkpoint=kept.append)
    assert deep.converged and "grid_enlarged" not in deep.discretisation
    assert grown.converged and grown.discretisation["grid_enlarged"] == {"beside": 1.0, "below": RATIO}
    assert any("um of depth to" in warning for warning in grown.warnings)
    for name in ("step", "cycle"):
        assert grown.tables["history"][name] == deep.tables["history"][name]
    for name in ("peeq_max", "p_max_Pa", "wear_volume_m3"):
        # each step is solved to 1e-4 of the yield stress, some from another start
        assert grown.quantities[name] == pytest.approx(deep.quantities[name], rel=1e-4)
    again = sam.solve(rough(), start=kept[-2])
    assert again.quantities == grown.quantities and again.warnings == grown.warnings


def test_given_layers_below_a_rough_body_stay_and_the_message_says_how_deep_they_must_go():
    result = sam.solve(rough(depths=(0.0, 0.3e-6, 0.8e-6, 1.6e-6, 3e-6), cycles=1))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "grid_enlarged" not in result.discretisation
    assert 'grid.depths (or grid.depth) go down to "4.5 um"' in result.message


def test_layers_that_a_larger_grid_has_not_begin_anew():
    """A kink that only the further layers hold would move a face above it."""
    model, now = begin(rough())
    grid = model.grid
    larger = replace(
        grid, faces=np.append(grid.faces, 2 * grid.faces[-1]), depths=np.append(grid.depths, 1.0)
    )
    assert on_larger_grid(now, grid, larger) is not None
    moved = larger.faces * np.where(np.arange(len(larger.faces)) == len(grid.faces) - 1, 1.01, 1.0)
    assert on_larger_grid(now, grid, replace(larger, faces=moved)) is None
    assert on_larger_grid(now, grid, replace(larger, nx=grid.nx + 2)) is None
