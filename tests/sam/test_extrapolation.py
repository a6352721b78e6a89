# SPDX-License-Identifier: MIT
"""Quantities from two grids: the formula, the gain against closed form, and what is refused."""

from importlib import resources

import numpy as np
import pytest
from pydantic import ValidationError

import fem_reference
import sam
from sam import choose_grid
from sam.planner.grids import coarse, halved
from sam.results.extrapolation import extrapolated
from sam.scene import Scene, Status, read_scene
from verification.cases.case import with_grid, with_loading, with_mesh
from verification.cases.recipes import at_ratio
from verification.cost.plan import plan
from verification.reference.hertz import CircularContact

SPHERE = {
    "body": {"young": 2.1e11, "poisson": 0.3},
    "counterbody": {"shape": "sphere", "radius": 1e-4},
    "loading": {"force": 0.1, "steps": 1},
}


def sphere(cells: int, **changes) -> Scene:
    return Scene.model_validate(SPHERE | {"grid": {"cells": (cells, cells)}} | changes)


def plastic(**grid) -> Scene:
    body = SPHERE["body"] | {"plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 2e10}}
    return Scene.model_validate(SPHERE | {"body": body, "grid": grid, "solver": {"extrapolate": True}})


def test_exact_for_a_quadratic_error():
    """q = 3 + 5 h^2 on h = 1 and 1/1.94: 3; what only one of both has, or is not of second order, stays
    away.
    """
    ratio = 33 / 17
    before, fine = (
        {"p_max_Pa": 3 + 5 * h**2, "contact_area_m2": 1.0, "approach_m": None} for h in (1.0, 1 / ratio)
    )
    found = extrapolated(before, fine, ratio)
    assert set(found) == {"p_max_Pa"} and found["p_max_Pa"] == pytest.approx(3.0, rel=1e-14)


@pytest.mark.parametrize("count", [17, 33, 65, 129, 16, 30, 64])
def test_half_as_many_cells_are_odd_if_those_are(count):
    assert halved(count) % 2 == count % 2 and abs(halved(count) - count / 2) <= 1


def test_closer_to_hertz_than_its_finer_grid():
    """Where the edge of an elastic contact falls between cells moves its maxima irregularly: from 16 and 8
    cells in the radius the error is a third (measured), gated at 0.6.
    """
    exact = CircularContact(0.1, 1e-4, 2.1e11 / (1 - 0.3**2))
    alone, both = sam.solve(sphere(65)), sam.solve(sphere(65, solver={"extrapolate": True}))
    assert both.status is Status.CONVERGED and both.discretisation["extrapolated_from_cells"] == [33, 33]
    for name, value in (("p_max_Pa", exact.peak_pressure), ("approach_m", exact.approach)):
        error, gained = abs(alone.quantities[name] / value - 1), abs(both.quantities[name] / value - 1)
        assert gained < 0.6 * error
        change = both.quantities[name] / alone.quantities[name] - 1
        assert both.discretisation["extrapolation_change"][name] == pytest.approx(change)
    assert np.array_equal(both.tables["line"]["p_Pa"], alone.tables["line"]["p_Pa"])
    assert both.cost["contact_iterations"] > alone.cost["contact_iterations"]


def test_the_force_of_a_given_approach_is_closer_to_hertz_too():
    loading = {"approach": 0.3e-6, "steps": 1}
    exact = 4 / 3 * 2.1e11 / (1 - 0.3**2) * np.sqrt(1e-4) * 0.3e-6**1.5
    alone, both = (
        sam.solve(sphere(65, loading=loading, solver={"extrapolate": each})) for each in (False, True)
    )
    error, gained = (abs(each.quantities["force_N"] / exact - 1) for each in (alone, both))
    assert gained < 0.6 * error
    assert both.quantities["approach_m"] == 0.3e-6


def test_plastic_strain_from_few_cells():
    """Swift steel at p0 = 4 yield stresses, 8 and 4 cells in the radius, against 12 finite elements in it
    (good to 0.1 %): within 0.4 %, less than half of what the finer grid alone is off.
    """
    scene = read_scene(resources.files("verification") / "scenes" / "plastic-swift-rigid.toml")[0]
    scene = with_mesh(
        with_grid(with_loading(at_ratio(scene, 4.0), unload=False, steps=4), cells=(33, 33)), 12
    )
    extrapolating = scene.model_copy(update={"solver": scene.solver.model_copy(update={"extrapolate": True})})
    reference = fem_reference.solve(scene).quantities["peeq_max"]
    both, alone = (sam.solve(each).quantities["peeq_max"] / reference - 1 for each in (extrapolating, scene))
    assert abs(both) < 4e-3 and abs(both) < abs(alone) / 2


def test_a_grid_too_coarse_to_start_from_is_said_and_not_used():
    """Seventeen cells over four radii leave the coarser grid nine: under-resolved."""
    alone, both = sam.solve(sphere(17)), sam.solve(sphere(17, solver={"extrapolate": True}))
    assert both.quantities == alone.quantities
    assert "extrapolation" in [entry.stage for entry in both.left_out]


def test_the_coarser_scene_keeps_extent_and_depth():
    scene = plastic(cells=(33, 33), layers=12, depth=1e-5)
    other = coarse(scene, choose_grid(scene))
    fine, less = choose_grid(scene), choose_grid(other)
    assert not other.solver.extrapolate and (less.nx, less.ny) == (17, 17)
    assert less.nx * less.hx == pytest.approx(fine.nx * fine.hx)
    assert len(less.depths) == 6 and less.faces[-1] == pytest.approx(fine.faces[-1])


def test_the_plan_says_that_two_grids_are_solved():
    single, both = (plan(sphere(33, solver={"extrapolate": each}))["models"][0] for each in (False, True))
    assert [stage["size"] for stage in both["stages"] if stage["stage"] == "coarser grid"] == [
        {"cells": [17, 17]}
    ]
    assert "coarser grid" not in [stage["stage"] for stage in single["stages"]]
    assert both["estimate"]["time_s"] > single["estimate"]["time_s"]


@pytest.mark.parametrize(
    "grid, key", [({"layers": 7, "depth": 1e-5}, "layers"), ({"depths": (0.0, 1e-6, 2e-6)}, "depths")]
)
def test_layers_that_cannot_be_halved_are_refused(grid, key):
    with pytest.raises(ValidationError, match="even number of layers") as error:
        plastic(**grid)
    assert key in str(error.value)


def test_rough_bodies_are_refused():
    surface = {"kind": "sinusoid", "amplitude": 1e-7, "wavelength_x": 1e-5}
    tables = SPHERE | {"counterbody": {"shape": "flat"}, "surface": surface, "solver": {"extrapolate": True}}
    tables["grid"] = {"cells": (32, 32), "extent": (1e-5, 1e-5)}
    with pytest.raises(ValidationError, match="belong to their grid"):
        Scene.model_validate(tables)
