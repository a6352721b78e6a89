# SPDX-License-Identifier: MIT
"""Running-in of a small rough patch in SAM: chemical film, wear and cycles, each against another count."""

from dataclasses import replace

import numpy as np
import pytest
from builders import CHEMICAL_FILM as FILM, RUN_IN_STEEL as SWIFT, STEEL, running_in
from made_results import column

import sam
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.plasticity import history
from sam.scene import FrictionMap
from sam.scene.surface import border_cells, heights, mean_deviation, with_relief

CELL = (16e-6 / 24) ** 2


def surface(result, state: str, name: str) -> np.ndarray:
    return column(result, "surface", name, state).reshape(24, 24)


@pytest.fixture
def seen(monkeypatch) -> list:
    """The model, the record before it, the trial and the film of each step that is taken."""
    found, committed = [], history.committed

    def watched(*step):
        found.append(step)
        return committed(*step)

    monkeypatch.setattr(history, "committed", watched)
    return found


def test_a_limit_out_of_reach_is_no_wear():
    """Bit by bit; a later cycle adds little of the first, as Swift steel hardens."""
    none, high = (sam.solve(running_in(counterbody=STEEL, wear=wear)) for wear in (None, 999.0))
    assert none.tables["cycles"]["wear_volume_m3"] == [0.0] * 2
    cycles = high.tables["cycles"]
    margins = cycles.pop("margin_to_limit")
    assert margins == [pytest.approx(1 - peeq / 999) for peeq in cycles["peeq_max"]]
    assert none.tables["cycles"].pop("margin_to_limit") == [None] * 2
    assert cycles.pop("roofed_volume_m3") == [0.0] * 2 and cycles == none.tables["cycles"]
    scene = running_in(counterbody=STEEL, wear=None)
    side, x = (16e-6, 16e-6), ((np.arange(24) + 0.5) / 24 - 0.5) * 16e-6
    h = heights(scene.surface, x, x, side)
    h = with_relief(h, (x, x), side, mean_deviation(scene.surface, side))
    assert np.array_equal(surface(none, "peak", "height_m"), h)
    (bx, by), cycles = border_cells((24, 24)), none.tables["cycles"]
    inner = h[bx:-bx, by:-by]
    sa = np.abs(inner - inner.mean()).mean()
    assert 0 < sa - cycles["sa_m"][-1] < 0.2 * sa  # flattened, and not by much


@pytest.mark.parametrize("fills", [False, True])
def test_the_wear_of_a_cycle_is_the_sum_of_its_parts(fills):
    """Below a layer that never wears: under the roof, and the roof. The printed filter keeps that volume."""
    wear = {"strain_limit": 0.002, "strain_limit_layer": float("inf"), "interpolate": False}
    wear |= {"smoothing_window": 5 * fills, "smoothing_fills": fills, "roof": "falls"}
    steel = SWIFT | {"layer_thickness": 0.2e-6, "layer": SWIFT}
    found = sam.solve(running_in(counterbody=STEEL, plasticity=steel, wear=wear))
    cycles = {name: np.array(values) for name, values in found.tables["cycles"].items()}
    under, roof = (cycles[f"{name}_volume_m3"] for name in ("roofed", "roof"))
    worn = surface(found, "unloaded", "worn_m")
    assert (under > 0).all() and cycles["raw_volume_m3"] == pytest.approx(under + roof, rel=1e-12)
    assert cycles["wear_of_cycle_m3"] == pytest.approx(cycles["raw_volume_m3"], rel=1e-12)
    assert cycles["wear_volume_m3"][-1] == pytest.approx(CELL * worn.sum(), rel=1e-12)
    left = np.asarray(found.grids["unloaded"]["body"].cell_data["peeq"])[..., 2:].max()
    assert (worn.min() < 0) == (cycles["filled_volume_m3"] > 0).all() == (left > 0.002) == fills


def test_local_friction_of_a_map_acts_where_it_is():
    """High friction on every other row of cells: the overall coefficient is the weighted mean."""
    local = np.where(np.arange(24)[:, None] % 2, 0.4, 0.1) * np.ones((24, 24))
    path = FrictionMap(local, (16e-6, 16e-6))
    found = sam.solve(running_in(film={"law": "map", "path": path}, wear=None, cycles=1, steps=1))
    p, friction = surface(found, "peak", "p_Pa"), surface(found, "peak", "friction")
    assert friction[p > 0] == pytest.approx(local[p > 0], rel=1e-12)
    share = p[1::2].sum() / p.sum()
    assert 0 < share < 1
    assert found.quantities["friction_coefficient"] == pytest.approx(0.1 + 0.3 * share, rel=1e-12)


def test_a_step_in_which_the_film_fails_is_the_step_with_the_friction_that_it_leaves(seen):
    """Made again from its beginning with the film at its end, where no further cell fails."""
    sam.solve(running_in(film=FILM, wear=None, cycles=1))
    failing = [each for each in seen if each[3].film.failed.sum() > each[1].tribofilm.film.failed.sum()]
    for model, now, trial, film in failing:
        again = model.problem(now.extent, film, None).step(now.state, trial.load)
        off = 2 * model.plan.pair.body.shear * np.abs(again.increment.strain - trial.increment.strain).max()
        assert off <= 5 * model.plan.solver.tolerance * model.plan.initial_yield.min()
    assert failing and any(trial.plastic for _, _, trial, _ in failing)


def test_a_new_film_without_friction_forgets_the_traction_of_the_cycle_before(seen):
    """With low = 0 the contact is that without friction, though the traction of unlike bodies coupled it."""
    sam.solve(running_in(film=FILM | {"low": 0.0}, wear=None, cycles=1))
    model, now, trial, film = next(each for each in reversed(seen) if each[2].load.force)
    extent = now.extent
    assert film.film.failed.any()

    def pressure(source) -> np.ndarray:
        return source(trial.residual.displacement, trial.load, trial.pressure, 1e-8)

    with_failures = pressure(model.problem(extent, film, None).pressure)
    new = pressure(
        model.problem(extent, model.plan.tribofilm.fresh(np.zeros((4, *model.grid.shape))), None).pressure
    )
    grid = model.grid
    bare = SurfaceOperators((grid.nx, grid.ny), grid.hy / grid.hx, Counters())
    alone = pressure(replace(model.built.problem.pressure, contact=BoxContact(bare, extent.window)))
    assert np.abs(new - alone).max() <= 1e-7 * alone.max()
    assert np.abs(with_failures - alone).max() > 0.01 * alone.max()
