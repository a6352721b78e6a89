# SPDX-License-Identifier: MIT
"""Running-in in the semi-analytical model: chemical film, wear and cycles of a small rough patch, each
against another count.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import CHEMICAL_FILM as FILM, RUN_IN_STEEL as SWIFT, STEEL, running_in
from made_results import column

import sam
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.grid.cells import Sides
from sam.plasticity import history
from sam.scene import FrictionMap, Status
from sam.scene.surface import border_cells, heights, mean_deviation, with_relief
from verification.cost.plan import plan
from verification.reference.bonded_film import overall_coefficient

CELL = (16e-6 / 24) ** 2


@cache
def solved(**keys):
    return sam.solve(running_in(counterbody=STEEL, **keys))


def surface(result, state: str, name: str) -> np.ndarray:
    return column(result, "surface", name, state).reshape(24, 24)


def test_a_small_patch_runs_in():
    """Friction between the two coefficients, wear that only grows, books that close."""
    result = solved(cycles=3)
    cycles = result.tables["cycles"]
    assert result.status is Status.CONVERGED
    assert cycles["cycle"] == [1, 2, 3]
    assert all(0.1 < mu < 0.4 for mu in cycles["friction_coefficient"])
    assert all(0 < share < 1 for share in cycles["protected_fraction"])
    assert 0 < cycles["wear_volume_m3"][0] and np.all(np.diff(cycles["wear_volume_m3"]) >= 0)
    worn = surface(result, "unloaded", "worn_m")
    # sums of a few hundred numbers in another order
    assert cycles["wear_volume_m3"][-1] == pytest.approx(CELL * worn.sum(), rel=1e-13, abs=0)
    assert result.quantities["wear_volume_m3"] == cycles["wear_volume_m3"][-1]
    assert sum(cycles["operator_applications"]) == result.cost["operator_applications"]
    before = surface(result, "peak", "worn_m")
    assert CELL * before.sum() == pytest.approx(cycles["wear_volume_m3"][-2], rel=1e-13, abs=0)


def test_the_overall_coefficient_is_that_of_the_loads_on_both_kinds_of_spots():
    """Summed independently: 0.1 + 0.3 of the load on cells where the film has failed."""
    result = solved(cycles=3)
    p, friction = (surface(result, "peak", name) for name in ("p_Pa", "friction"))
    mu = overall_coefficient(p, friction > 0.25, 0.1, 0.4, cell_area=CELL)
    # q/p of the table is 0.4 up to rounding
    assert result.quantities["friction_coefficient"] == pytest.approx(mu, rel=1e-12)
    assert result.tables["cycles"]["friction_coefficient"][-1] == pytest.approx(mu, rel=1e-12)
    assert np.isnan(friction[p == 0]).all()
    touching = friction[p > 0]
    assert result.tables["cycles"]["protected_fraction"][-1] == pytest.approx(
        np.mean(touching < 0.25), rel=1e-12
    )


def test_roughness_of_the_first_row_is_that_of_the_worn_and_displaced_surface():
    scene = running_in(counterbody=STEEL, cycles=2, wear=None)
    result = sam.solve(scene)
    n, side = 24, (16e-6, 16e-6)
    x = ((np.arange(n) + 0.5) / n - 0.5) * 16e-6
    h = heights(scene.surface, x, x, side)
    h = with_relief(h, (x, x), side, mean_deviation(scene.surface, side))
    assert np.array_equal(surface(result, "peak", "height_m"), h)
    (bx, by), cycles = border_cells((n, n)), result.tables["cycles"]
    inner = h[bx:-bx, by:-by]
    sa = np.abs(inner - inner.mean()).mean()
    assert 0 < sa - cycles["sa_m"][-1] < 0.2 * sa  # flattened, and not by much


def test_without_a_limit_nothing_wears_and_the_strain_settles():
    """Plain cyclic contact: the same as without [wear], bit by bit; later cycles add little of the first."""
    inf = solved(cycles=4, wear=float("inf"))
    none = solved(cycles=4, wear=None)
    assert inf.tables["cycles"]["wear_volume_m3"] == [0.0] * 4
    assert inf.tables["cycles"] == none.tables["cycles"]
    high = solved(cycles=4, wear=999.0)  # out of reach, but looked for after each cycle
    margins = high.tables["cycles"].pop("margin_to_limit")
    assert margins == [pytest.approx(1 - peeq / 999) for peeq in high.tables["cycles"]["peeq_max"]]
    assert none.tables["cycles"].pop("margin_to_limit") == [None] * 4
    assert high.tables["cycles"].pop("roofed_volume_m3") == [0.0] * 4
    assert high.tables["cycles"] == none.tables["cycles"]
    assert not any(entry.stage == "worn geometry" for entry in high.left_out)
    peeq = np.array(inf.tables["cycles"]["peeq_max"])
    # loads on the same surface with a new film each time; Swift steel hardens
    assert np.diff(peeq)[-1] < 0.05 * peeq[0]
    assert any(entry.stage == "worn geometry" for entry in inf.left_out)
    stages = list(plan(running_in(counterbody=STEEL, wear=float("inf")))["models"][0]["stages"])
    assert [entry["runs"] for entry in stages if entry["stage"] == "worn geometry"] == [False]


def test_what_a_sound_layer_keeps_is_counted():
    """A layer that is never removed: all cells beyond the limit below it stay; those of the last cycle are in
    the unloaded body.
    """
    wear = {"strain_limit": 0.002, "strain_limit_layer": float("inf"), "interpolate": False}
    steel = SWIFT | {"layer_thickness": 0.2e-6, "layer": SWIFT}
    found = sam.solve(running_in(counterbody=STEEL, plasticity=steel, wear=wear | {"smoothing_window": 0}))
    body = found.grids["unloaded"]["body"]
    beyond = np.asarray(body.cell_data["peeq"])[..., 2:] > 0.002
    kept = (np.diff(body.x)[0] * np.diff(body.y)[0] * np.diff(body.z)[2:] * beyond).sum()
    cycles = found.tables["cycles"]
    assert found.converged and cycles["wear_volume_m3"] == [0.0, 0.0]
    assert (
        0 < cycles["roofed_volume_m3"][0] <= cycles["roofed_volume_m3"][1] == pytest.approx(kept, rel=1e-12)
    )


def test_every_failed_cell_fails_in_the_converged_contact(monkeypatch):
    """At the end of a step the film is tested once more: nothing further fails, and all that failed did so
    for a pressure near its limit at least.
    """
    seen, committed = [], history.committed

    def watched(model, now, trial, film):
        if film is not None and trial.load.force:
            failed = film.film.failed
            pressure = np.zeros((24, 24))
            pressure[now.extent.window.slices] = trial.pressure * model.unit
            plastic = now.state.material.strain + trial.increment.strain
            strain = model.surface_strain(now.extent, trial.stress, plastic)
            again = model.plan.tribofilm.tested(
                now.tribofilm, now.tribofilm, strain, pressure=pressure, sign=trial.load.sign
            ).film.failed
            seen.append((int(failed.sum()), int((failed & ~again).sum()), int((again & ~failed).sum())))
        return committed(model, now, trial, film)

    monkeypatch.setattr(history, "committed", watched)
    sam.solve(running_in(counterbody=STEEL, cycles=1, steps=5))
    failures = np.array(seen)
    assert failures[-1, 0] > 5 and (failures[:, 2] == 0).all()
    # raised friction may lower the pressure of its own cell, so that a failed film would just have held
    assert failures[:, 1].sum() <= 0.1 * failures[:, 0].sum()


def test_a_map_of_one_number_is_a_constant_coefficient():
    constant = sam.solve(running_in(counterbody=None, film={"coefficient": 0.3}, wear=None, cycles=1))
    path = FrictionMap(np.full((24, 24), 0.3), (16e-6, 16e-6))
    mapped = sam.solve(running_in(counterbody=None, film={"law": "map", "path": path}, wear=None, cycles=1))
    # the tangential part is multiplied by the same number in another order
    assert surface(mapped, "peak", "p_Pa") == pytest.approx(
        surface(constant, "peak", "p_Pa"), rel=1e-6, abs=1e-6 * 1e9
    )
    assert mapped.quantities["friction_coefficient"] == pytest.approx(0.3, rel=1e-12)


def test_local_friction_of_a_map_acts_where_it_is():
    """High friction on one half of the load: the overall coefficient is the mean, weighted by what each half
    carries.
    """
    load = np.cumsum(surface(solved(cycles=1, wear=None), "peak", "p_Pa").sum(axis=1))
    half = int(np.searchsorted(load, load[-1] / 2))
    left = np.where(np.arange(24)[:, None] < half, 0.4, 0.1) * np.ones((24, 24))
    path = FrictionMap(left, (16e-6, 16e-6))
    found = sam.solve(running_in(counterbody=STEEL, film={"law": "map", "path": path}, wear=None, cycles=1))
    p, friction = surface(found, "peak", "p_Pa"), surface(found, "peak", "friction")
    assert friction[p > 0] == pytest.approx(left[p > 0], rel=1e-12)
    share = p[:half].sum() / p.sum()
    assert 0.05 < share < 0.95
    assert found.quantities["friction_coefficient"] == pytest.approx(0.1 + 0.3 * share, rel=1e-12)


def test_a_new_film_without_friction_forgets_the_traction_of_the_cycle_before(monkeypatch):
    """With low = 0 a film that is whole again leaves no traction: the contact is that of the same surface
    without friction, though unlike bodies were coupled by the traction where it had failed.
    """
    seen, committed = [], history.committed

    def watched(model, now, trial, film):
        seen.append((model, now.extent, trial, film))
        return committed(model, now, trial, film)

    monkeypatch.setattr(history, "committed", watched)
    sam.solve(running_in(film=FILM | {"low": 0.0}, wear=None, cycles=1))
    model, extent, trial, film = next(each for each in reversed(seen) if each[2].load.force)
    assert film.film.failed.any()

    def pressure(source) -> np.ndarray:
        return source(trial.residual.displacement, trial.load, trial.pressure, 1e-8)

    with_failures = pressure(model.problem(extent, film, None).pressure)
    new = pressure(model.problem(extent, model.plan.tribofilm.fresh(model.nothing_strained()), None).pressure)
    grid = model.grid
    bare = SurfaceOperators((grid.nx, grid.ny), grid.hy / grid.hx, Counters())
    alone = pressure(replace(model.built.problem.pressure, contact=BoxContact(bare, extent.window)))
    assert np.abs(new - alone).max() <= 1e-7 * alone.max()
    assert np.abs(with_failures - alone).max() > 0.01 * alone.max()


def test_the_box_grows_after_wear_and_removal_strains_nothing_at_its_bottom(monkeypatch):
    """A first box that is too shallow, and is not let grow before the first removal, grows in the next load
    step. The step that finds equilibrium after removal does not enlarge it, and has not to.
    """
    worn, seen = [], []
    first, grown, edge, removed, committed = (
        history.first_extent, history.grown, history.edge_reached, history._worn, history.committed
    )  # fmt: skip

    def after_removal(model, now, trial):
        worn.append(len(seen))
        return removed(model, now, trial)

    def watched(model, now, trial, film):
        seen.append((now.extent.layers, bool(trial.increment.strain[:, -1].any())))
        return committed(model, now, trial, film)

    monkeypatch.setattr(history, "first_extent", lambda *a, **k: replace(first(*a, **k), layers=3))
    monkeypatch.setattr(history, "grown", lambda extent, *a: grown(extent, *a) if worn else extent)
    monkeypatch.setattr(history, "edge_reached", lambda *a, **k: edge(*a, **k) if worn else Sides())
    monkeypatch.setattr(history, "_worn", after_removal)
    monkeypatch.setattr(history, "committed", watched)
    result = sam.solve(running_in(counterbody=STEEL, cycles=2))
    assert result.status is Status.CONVERGED and result.quantities["wear_volume_m3"] > 0
    assert seen[worn[0] - 2] == (3, True) and seen[-1][0] > 3
    assert not any(seen[k][1] for k in worn) and len(worn) == 2
    assert result.certificate["yield_excess_outside_box"] <= 1e-4
