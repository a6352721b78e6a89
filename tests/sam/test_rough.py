# SPDX-License-Identifier: MIT
"""Rough bodies in SAM: counter-bodies, borders, spots, maps in parts; running-in against other counts."""

from dataclasses import replace

import numpy as np
import pytest
from builders import CHEMICAL_FILM, LINEAR, RUN_IN_STEEL, STEEL, running_in, scene
from made_results import column

from sam import UnsupportedScene, left_out, plan, solve
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.plasticity import history
from sam.results.tables import in_the_fall_off, too_few_cells
from sam.scene import COUNTER_HEIGHT, CounterSurface, FrictionMap, HeightMap, Scene, SceneError, Status
from sam.scene.surface import border_cells, heights, mean_deviation, with_relief

FLAT, BALL = {"shape": "flat"}, {"shape": "sphere", "radius": 0.4e-3}
R, F = 100e-6, 0.05
SIDE = 20e-6
WAVE = {"kind": "sinusoid", "amplitude": 0.1e-6, "wavelength_x": 10e-6, "wavelength_y": 8e-6}
OTHER = {"kind": "self-affine", "sq": 20e-9, "cutoff_long": 16e-6, "cutoff_short": 8e-6, "hurst": 0.8}
FACES = (0.0, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6)


def centres(n: int, side: float) -> np.ndarray:
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def of_heights(height, n: int, side: float, counterbody=FLAT, force=F, **tables) -> Scene:
    """A scene whose surface is given by height(x, y) at n x n cells."""
    x = centres(n, side)
    surface = {"kind": "file", "path": HeightMap(height(x[:, None], x) + np.zeros((n, n)), (side, side))}
    loading = {"force": force} | tables.pop("loading", {})
    return scene(counterbody=counterbody, surface=surface, loading=loading, **tables)


def patch(n: int, force=0.6, **tables) -> Scene:
    """A self-affine patch of 64 um below a rigid plane."""
    surface = {"kind": "self-affine", "ra": 0.27e-6, "cutoff_long": 32e-6, "cutoff_short": 12e-6}
    surface |= {"hurst": 0.8, "anisotropy": 1.5, "seed": 1}
    grid = {"cells": (n, n), "extent": (64e-6, 64e-6), "border": "relief"}
    return scene(counterbody=FLAT, surface=surface, loading={"force": force}, grid=grid, **tables)


def pressed(counterbody, surface=None, **tables) -> Scene:
    """A patch of 32 x 32 cells."""
    grid = {"cells": (32, 32), "extent": (SIDE, SIDE), **tables.pop("grid", {})}
    loading = {"force": 0.02, "steps": 2, "unload": True, **tables.pop("loading", {})}
    return scene(counterbody=counterbody, surface=surface, grid=grid, loading=loading, **tables)


def test_a_pit_below_a_punch_carries_nothing():
    """The profile of a punch stays: cells beside it cannot touch, whatever the heights."""
    pit, punch = lambda x, y: -1e-6 * ((x**2 + y**2) < (2e-6) ** 2), {"shape": "punch", "radius": 6e-6}
    result = solve(of_heights(pit, 41, 16e-6, punch))
    p = column(result, "surface", "p_Pa").reshape(41, 41)
    assert result.converged and p[20, 20] == 0 and p[20, 31] > 0 and not p[0].any()


def test_spots_share_and_mean_gap_by_hand():
    """Six cells that stand out by 1 um: an L cut by the edge, two that meet at a corner, one alone."""
    tall = np.zeros((8, 8))
    tall[[0, 0, 1, 3, 4, 6], [4, 5, 5, 1, 2, 6]] = 1e-6
    found = solve(of_heights(lambda x, y: tall, 8, 8e-6, force=1e-6)).quantities
    assert found["contact_spots"] == 4
    assert found["mean_gap_m"] == pytest.approx(58 / 64 * 1e-6, rel=1e-5)
    assert found["contact_share"] == found["contact_area_m2"] / (8e-6) ** 2


def test_a_contact_at_the_edge_is_a_warning_and_its_border_does_not_count():
    """The ends of a ridge that is cut carry more than its middle. For smooth bodies the same is an error."""
    force, side, n = 2.0, 40e-6, 64
    result = solve(of_heights(lambda x, y: -(x**2) / (2 * R) + 0 * y, n, side, force=force))
    p = column(result, "surface", "p_Pa").reshape(n, n)
    assert result.status is Status.CONVERGED and "the outer 6 x 6 cells do not count" in result.warnings[-1]
    assert result.quantities["p_max_Pa"] == p[6:-6, 6:-6].max() < 0.8 * p.max()
    assert result.tables["history"]["p_max_Pa"][-1] == result.quantities["p_max_Pa"]


def test_small_spots_and_short_waves_are_warned_of():
    """At 24 cells the shortest wave of 12 um has 4.5, at 16 it has 3."""
    small, short = "too few cells in 2 of 2 spots", "3 cells in the shortest wavelength"
    assert small in solve(patch(24)).warnings[0] and short in solve(patch(16)).warnings[0]
    assert solve(patch(64, force=1e-4)).status is Status.UNDER_RESOLVED


def spots_of(*counts: int, load: float = 1.0) -> np.ndarray:
    """Pressures of spots in rows of their own, the first with the load per cell given, the others with 1."""
    pressure = np.zeros((2 * len(counts) + 1, 40))
    for k, count in enumerate(counts):
        pressure[2 * k + 1, 1 : count + 1] = 1.0 if k else load
    return pressure


@pytest.mark.parametrize(
    "pressure, words",
    [
        (spots_of(32, 23, 18, 15, 8, 2, 1, load=1.01), "4 of 5 spots|23, 18, 15, 8 cells; together 64.4 %"),
        (spots_of(32, 28, 1, load=1.01), ""),
        (spots_of(1, 30, 30, load=1.1), "1 of 3 spots|(1 cells; together 1.8 %"),  # the largest pressure
        (np.kron(np.eye(2), np.ones((4, 6))), "2 of 2 spots|24, 24 cells; together 100 %"),  # at a corner
        (np.zeros((4, 4)), ""),
    ],
)
def test_every_spot_that_carries_a_twentieth_of_the_load_is_judged(pressure, words):
    """28 cells are needed: pi 3^2."""
    found = too_few_cells(pressure)
    assert bool(found) == bool(words) and all(each in found for each in words.split("|") if words)


@pytest.mark.parametrize(
    "outside, inside, words",
    [
        (2.0, 1.0, "outer 3 x 3 cells, which have the largest pressure and 1 of the spots"),
        (0.9, 1.0, "which have 1 of the spots"),
        (0.02, 1.0, ""),
        (0.0, 0.0, ""),
    ],
)
def test_what_the_fall_off_of_the_border_makes_is_said(outside, inside, words):
    """A spot of which 2 of 3 cells lie in the border, 3/32 of 32 cells, and one within it."""
    pressure = np.zeros((32, 32))
    pressure[1:4, 16], pressure[16, 4:7] = outside, inside
    found = in_the_fall_off(pressure)
    assert bool(found) == bool(words) and words in found


# a rough counter-body


@pytest.mark.parametrize("mu, counterbody", [(0.3, BALL), (0.0, FLAT | STEEL)], ids=["rigid", "elastic"])
@pytest.mark.parametrize("plasticity", [None, LINEAR], ids=["elastic", "plastic"])
def test_waves_on_the_counter_body_are_those_on_the_body_upside_down(counterbody, mu, plasticity):
    """A crest out of the counter-body points into the body: the gap knows only the sum of both heights."""
    tables = {"friction": mu, "body": {"plasticity": plasticity}}
    if plasticity:
        tables["grid"] = {"border": "relief", "depths": FACES}
    on_body = solve(pressed(counterbody, WAVE, **tables))
    opposite = solve(pressed({**counterbody, "surface": WAVE}, **tables))
    assert opposite.quantities == on_body.quantities
    for name, table in on_body.tables.items():
        for key, values in table.items():
            if (name, key) != ("surface", "height_m"):
                np.testing.assert_array_equal(values, opposite.tables[name][key], f"{name}.{key}")
    table = opposite.tables["surface"]
    assert not table["height_m"].any() and COUNTER_HEIGHT not in on_body.tables["surface"]
    np.testing.assert_array_equal(table[COUNTER_HEIGHT], on_body.tables["surface"]["height_m"])


def test_each_stretch_is_the_surface_of_the_next_seed_and_touches_first_at_zero():
    def gaps(given) -> list[np.ndarray]:
        found = plan(given)
        problem = found.problem(Counters())
        return [problem.gap(load) for load in found.schedule.peaks]

    renewed = pressed({**FLAT, "surface": {**OTHER, "seed": 5, "renew": True}}, loading={"cycles": 3})
    for k, gap in enumerate(gaps(renewed)):
        alone = gaps(pressed({**FLAT, "surface": {**OTHER, "seed": 5 + k}}))[0]
        np.testing.assert_array_equal(gap, alone)
        assert gap.min() == 0.0
    stages = {each.stage: each for each in plan(renewed).stages}
    assert stages["counter-surface heights"].size["stretches"] == 3
    assert not stages["surface heights"].runs and renewed.seeds == (5, 6, 7)
    reasons = {each.stage: each.reason for each in left_out(pressed(FLAT, WAVE))}
    assert reasons["counter-surface heights"] == "no [counterbody.surface]"


def test_a_map_is_used_part_by_part_from_its_crop_on():
    values = np.arange(48.0 * 32.0).reshape(48, 32) * 1e-12
    surface = {"kind": "file", "path": HeightMap(values, (48e-6, 32e-6))}
    found = CounterSurface(**surface, crop=(-16e-6, 8e-6, 16e-6, 16e-6), renew=True)
    starts = [tuple(part.start for part in found.stretch(k).window) for k in range(7)]
    assert starts == [(0, 16), (16, 16), (32, 16), (0, 0), (16, 0), (32, 0), (0, 16)]
    x = centres(16, 16e-6)
    np.testing.assert_array_equal(heights(found.stretch(1), x, x, (16e-6, 16e-6)), values[16:32, 16:])


def test_parts_of_a_long_map_begin_at_its_first_cell():
    """A thousand cells from the middle of the map, where a part of a per mille is a cell."""
    path = HeightMap(np.arange(2048.0)[:, None] * np.ones(16) * 1e-12, (2048e-6, 16e-6))
    found = CounterSurface(kind="file", path=path, crop=(0.0, 0.0, 16e-6, 16e-6), renew=True)
    assert [found.stretch(k).window[0].start for k in (0, 1, 63, 64)] == [1016, 1032, 2024, 8]


def test_maps_of_both_bodies_have_one_grid():
    small, own = (
        {"kind": "file", "path": HeightMap(np.eye(n) * 1e-7, (s, s))} for n, s in ((8, 8e-6), (32, SIDE))
    )
    with pytest.raises(SceneError, match=r"\[32, 32\] heights on 2e-05 m x 2e-05 m"):
        scene(counterbody={**FLAT, "surface": small}, surface=own)


def test_a_scene_without_its_maps_is_refused_by_name():
    known = HeightMap.known_by("0" * 64, (32, 32), (SIDE, SIDE))
    with pytest.raises(UnsupportedScene, match=r"counterbody\.surface\.path"):
        solve(scene(counterbody={**FLAT, "surface": {"kind": "file", "path": known}}))


# running-in

CELL = (16e-6 / 24) ** 2


def of_surface(result, state: str, name: str) -> np.ndarray:
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
    none, high = (solve(running_in(counterbody=STEEL, wear=wear)) for wear in (None, 999.0))
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
    assert np.array_equal(of_surface(none, "peak", "height_m"), h)
    (bx, by), cycles = border_cells((24, 24)), none.tables["cycles"]
    inner = h[bx:-bx, by:-by]
    sa = np.abs(inner - inner.mean()).mean()
    assert 0 < sa - cycles["sa_m"][-1] < 0.2 * sa  # flattened, and not by much


@pytest.mark.parametrize("fills", [False, True])
def test_the_wear_of_a_cycle_is_the_sum_of_its_parts(fills):
    """Below a layer that never wears: under the roof, and the roof. The printed filter keeps that volume."""
    wear = {"strain_limit": 0.002, "strain_limit_layer": float("inf"), "interpolate": False}
    wear |= {"smoothing_window": 5 * fills, "smoothing_fills": fills, "roof": "falls"}
    steel = RUN_IN_STEEL | {"layer_thickness": 0.2e-6, "layer": RUN_IN_STEEL}
    found = solve(running_in(counterbody=STEEL, plasticity=steel, wear=wear))
    cycles = {name: np.array(values) for name, values in found.tables["cycles"].items()}
    under, roof = (cycles[f"{name}_volume_m3"] for name in ("roofed", "roof"))
    worn = of_surface(found, "unloaded", "worn_m")
    assert (under > 0).all() and cycles["raw_volume_m3"] == pytest.approx(under + roof, rel=1e-12)
    assert cycles["wear_of_cycle_m3"] == pytest.approx(cycles["raw_volume_m3"], rel=1e-12)
    assert cycles["wear_volume_m3"][-1] == pytest.approx(CELL * worn.sum(), rel=1e-12)
    left = np.asarray(found.grids["unloaded"]["body"].cell_data["peeq"])[..., 2:].max()
    assert (worn.min() < 0) == (cycles["filled_volume_m3"] > 0).all() == (left > 0.002) == fills


def test_local_friction_of_a_map_acts_where_it_is():
    """High friction on every other row of cells: the overall coefficient is the weighted mean."""
    local = np.where(np.arange(24)[:, None] % 2, 0.4, 0.1) * np.ones((24, 24))
    path = FrictionMap(local, (16e-6, 16e-6))
    found = solve(running_in(film={"law": "map", "path": path}, wear=None, cycles=1, steps=1))
    p, friction = of_surface(found, "peak", "p_Pa"), of_surface(found, "peak", "friction")
    assert friction[p > 0] == pytest.approx(local[p > 0], rel=1e-12)
    share = p[1::2].sum() / p.sum()
    assert 0 < share < 1
    assert found.quantities["friction_coefficient"] == pytest.approx(0.1 + 0.3 * share, rel=1e-12)


def test_a_step_in_which_the_film_fails_is_the_step_with_the_friction_that_it_leaves(seen):
    """Made again from its beginning with the film at its end, where no further cell fails."""
    solve(running_in(film=CHEMICAL_FILM, wear=None, cycles=1))
    failing = [each for each in seen if each[3].film.failed.sum() > each[1].tribofilm.film.failed.sum()]
    for model, now, trial, film in failing:
        again = model.problem(now.extent, film, None).step(now.state, trial.load)
        off = 2 * model.plan.pair.body.shear * np.abs(again.increment.strain - trial.increment.strain).max()
        assert off <= 5 * model.plan.solver.tolerance * model.plan.initial_yield.min()
    assert failing and any(trial.plastic for _, _, trial, _ in failing)


def test_a_new_film_without_friction_forgets_the_traction_of_the_cycle_before(seen):
    """With low = 0 the contact is that without friction, though the traction of unlike bodies coupled it."""
    solve(running_in(film=CHEMICAL_FILM | {"low": 0.0}, wear=None, cycles=1))
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
