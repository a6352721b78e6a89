# SPDX-License-Identifier: MIT
"""Smooth scenes through the semi-analytical solver: history and statuses, a given approach, two grids."""

from dataclasses import replace

import numpy as np
import pytest
from builders import PERFECT, RADIUS, SHAPES, scene

import fem_reference
import sam
from sam import choose_grid
from sam.contact.convolution import Counters
from sam.contact.normal import solve_contact
from sam.planner.bodies import Bodies, coarse, hertz_semi_axes
from sam.results.tables import extrapolated
from sam.scene import Status
from sam.schedule import Approach, Load
from verification.cost.plan import plan
from verification.reference.elliptic import EllipticContact

FEW, COARSE = {"cells": (33, 33)}, {"cells": (33, 33), "extent": (24e-6, 24e-6)}


@pytest.mark.parametrize("ratio", [1.00001, 1.5, 1000.0])
def test_estimated_semi_axes_meet_hertz(ratio):
    """The estimate that chooses the grid, against the closed form by elliptic integrals."""
    a_scene = scene(counterbody={"shape": "ellipsoid", "radius_x": 1e-4, "radius_y": 1e-4 * ratio})
    exact = EllipticContact(0.65, 1e-4, 1e-4 * ratio, Bodies(a_scene).pair.contact_modulus)
    assert hertz_semi_axes(a_scene) == pytest.approx(exact.semi_axes, rel=3e-5, abs=0.0)


@pytest.mark.parametrize("shape", ["sphere", "ellipsoid", "punch", "rounded-punch"])
def test_the_gap_of_a_shape_by_hand(shape):
    grid = {"cells": (9, 7), "extent": (18e-6, 14e-6)}
    found = sam.plan(scene(counterbody=SHAPES[shape], grid=grid)).problem(Counters()).gap(Load(0.65))
    x, y = 2e-6 * (np.arange(9) - 4)[:, None], 2e-6 * (np.arange(7) - 3)
    r = np.hypot(x, y)
    expected = {
        "sphere": r**2 / (2 * RADIUS),
        "ellipsoid": x**2 / (2 * RADIUS) + y**2 / (4 * RADIUS),
        "punch": np.where(r <= 5e-6, 0.0, np.inf),
        "rounded-punch": np.maximum(r - 5e-6, 0.0) ** 2 / (2 * 50e-6),
    }[shape]
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-20)


@pytest.mark.parametrize("model", [sam, fem_reference], ids=["sam", "fem"])
def test_history_unloading_and_cycles(model):
    """Elastic: one step back to exactly nothing, which says so, and cycles that repeat the first."""
    loading, seen = {"steps": 3, "unload": True, "unload_steps": 5, "cycles": 3}, []
    result = model.solve(scene(loading=loading, grid=FEW), progress=lambda *call: seen.append(call))
    history, q = result.tables["history"], result.quantities
    assert history["cycle"] == [1] * 4 + [2] * 4 + [3] * 4 and history["step"] == [1, 2, 3, 4] * 3
    assert "one step" in history["note"][3] and all("cycle 1" in note for note in history["note"][4:])
    for name in ("force_N", "approach_m", "contact_area_m2", "p_max_Pa"):
        assert history[name][3] == 0.0 and history[name][4:8] == history[name][:4]
    assert result.tables["cycles"]["p_max_Pa"] == [q["p_max_Pa"]] * 3
    for table in ("axis", "line", "plane"):
        t = {name: np.asarray(values) for name, values in result.tables[table].items()}
        after = t["state"] == "unloaded"
        for name in set(t) & {"p_Pa", "uz_m", "mises_Pa", "sxx_Pa", "szz_Pa"}:
            assert not t[name][after].any() and t[name][~after].any()
        if table == "line":
            assert t["gap_m"][after] == pytest.approx(
                t["x_m"][after] ** 2 / (2 * RADIUS), rel=1e-9, abs=1e-20
            )
    assert q["residual_uz_center_m"] == q["residual_mises_max_Pa"] == 0.0
    assert model.solve(scene(grid=FEW)).quantities["residual_uz_center_m"] is None
    if model is sam:
        assert {e.stage for e in result.left_out} >= {"tangential kernels", "volume grid", "unloading steps"}
        assert seen[0][0] == "contact" and seen[-1] == ("stress", 1, 1)


@pytest.mark.parametrize(
    ("tables", "status", "words"),
    [
        ({"loading": {"force": 0.0}}, Status.CONVERGED, ""),
        ({"grid": FEW | {"extent": (10e-6, 10e-6)}}, Status.CONTACT_AT_GRID_EDGE, "grid."),
        ({"grid": {"cells": (9, 9), "extent": (40e-6, 40e-6)}}, Status.UNDER_RESOLVED, "grid."),
        ({"grid": FEW | {"depths": (0.0,)}, "solver": {"tolerance": 1e-12}}, Status.CONVERGED, ""),
    ],
)
def test_status_of_a_solve(tables, status, words):
    result = sam.solve(scene(**{"grid": FEW} | tables))
    assert result.status is status and words in result.message
    assert all(np.isfinite(value) for value in result.quantities.values() if value is not None)
    if not result.quantities["force_N"]:
        names = ("approach_m", "p_max_Pa", "contact_area_m2")
        assert {result.quantities[name] for name in names} == {0.0}


def test_beside_a_punch_there_is_no_gap():
    line = sam.solve(scene(counterbody=SHAPES["punch"], grid=FEW)).tables["line"]
    gap, x = np.asarray(line["gap_m"]), np.abs(line["x_m"])
    assert np.isnan(gap[x > 5.6e-6]).all() and np.isfinite(gap[x < 4.4e-6]).all()


# a given approach

CYCLES = {"force": 0.65, "steps": 3, "unload": True, "cycles": 2}
WAVES = {"kind": "self-affine", "sq": 20e-9, "hurst": 0.8, "cutoff_long": 12e-6, "cutoff_short": 2e-6}
COATING = {"thickness": 1e-6, "young": 80e9, "poisson": 0.3}
KINDS = {
    "punch": {"counterbody": SHAPES["punch"], "loading": CYCLES},
    "sliding": {"friction": 0.3, "loading": {"force": 0.65, "steps": 2}},
    "coated": {"body": {"coating": COATING}, "loading": CYCLES | {"cycles": 1}},
    "rough": {"surface": WAVES | {"seed": 1}, "loading": {"force": 0.1, "steps": 2}},
    "plastic": {
        "body": {"plasticity": PERFECT},
        "loading": CYCLES | {"force": 0.2, "steps": 2},
        "grid": COARSE | {"cells": (17, 17)},
    },
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_approaches_of_a_force_run_return_its_forces(monkeypatch, kind):
    """In every step, to ten times the tolerance of the solver; the rest of the record with them."""
    a_scene = scene(**{"grid": COARSE} | KINDS[kind])
    by_force, plan = sam.solve(a_scene), sam.plan(a_scene)
    history = by_force.tables["history"]
    rows = dict(zip(zip(history["cycle"], history["step"], strict=True), history["approach_m"], strict=True))

    def with_approach(target):
        load = replace(target.load, force=np.nan, approach=float(rows[target.cycle, target.step]))
        given = replace(target, load=load)
        return given if target.rises else target

    targets = tuple(map(with_approach, plan.schedule.targets))
    peak = next(target.load for target in reversed(targets) if target.rises)
    schedule = replace(plan.schedule, targets=targets, peak=replace(peak, sign=1.0))
    monkeypatch.setattr("sam.solver.plan_of", lambda _bodies: replace(plan, schedule=schedule))
    by_approach = sam.solve(a_scene)
    assert by_force.status is by_approach.status is Status.CONVERGED
    near = 10 * a_scene.solver.tolerance
    for name, scale in (("force_N", a_scene.loading.force), ("approach_m", RADIUS)):
        forces, found = (np.array(each.tables["history"][name]) for each in (by_force, by_approach))
        assert found == pytest.approx(forces, rel=near, abs=near * scale)
    for name in ("p_max_Pa", "mises_max_change", "friction_coefficient"):
        if by_force.quantities[name] is not None:
            assert by_approach.quantities[name] == pytest.approx(by_force.quantities[name], rel=1e-4, abs=0)


def test_an_approach_that_leaves_the_bodies_apart_has_no_force():
    gap = np.full((32, 32), 2.0)
    contact = solve_contact(gap, (1.0, 1.0), 1.0, Approach(1.0))
    assert contact.force == 0.0 and not contact.pressure.any() and contact.approach == 1.0
    assert np.array_equal(contact.gap, gap - 1.0)


def test_half_the_way_is_half_of_all_that_a_load_gives():
    pressed, moved = Load(2.0, x=1.0, y=-3.0, misfit=0.25), Load(6.0, x=2.0, y=1.0, misfit=0.75)
    assert pressed.halfway_to(moved) == Load(4.0, x=1.5, y=-1.0, misfit=0.5)
    start, end = Load(2.0, approach=1e-6), Load.by_approach(3e-6)
    half = start.halfway_to(end)
    assert half.approach == 2e-6 and np.isnan(half.force)
    assert start.halfway_to(Load(0.0)) == Load(1.0)
    assert end.rise(start) == pytest.approx(2e-6) and np.isnan(Load(1.0).rise(start))
    assert Load(0.0).rise(start) < 0.0


# from two grids


def test_extrapolation_is_exact_for_a_quadratic_error():
    """q = 3 + 5 h^2 on h = 1 and 1/1.94: 3; what only one of both has stays away."""
    ratio = 33 / 17
    before, fine = (
        {"p_max_Pa": 3 + 5 * h**2, "contact_area_m2": 1.0, "approach_m": None} for h in (1.0, 1 / ratio)
    )
    found = extrapolated(before, fine, ratio)
    assert set(found) == {"p_max_Pa"} and found["p_max_Pa"] == pytest.approx(3.0, rel=1e-14)


def test_the_coarser_scene_keeps_extent_and_depth():
    grid = {"cells": (33, 33), "layers": 12, "depth": 1e-5}
    both = scene(body={"plasticity": PERFECT}, grid=grid, solver={"extrapolate": True})
    other = coarse(both, choose_grid(both))
    fine, less = choose_grid(both), choose_grid(other)
    assert not other.solver.extrapolate and (less.nx, less.ny) == (17, 17)
    assert less.nx * less.hx == pytest.approx(fine.nx * fine.hx)
    assert len(less.depths) == 6 and less.faces[-1] == pytest.approx(fine.faces[-1])
    sizes = {stage["stage"]: stage["size"] for stage in plan(both).content["models"][0]["stages"]}
    assert sizes["coarser grid"] == {"cells": [17, 17]}
