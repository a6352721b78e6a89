# SPDX-License-Identifier: MIT
"""A rough counter-body: its heights in the gap, and other ones in each cycle."""

import numpy as np
import pytest
from builders import LINEAR, running_in, scene
from pydantic import ValidationError

from sam import UnsupportedScene, left_out, plan, solve
from sam.contact.convolution import Counters
from sam.elastic.problem import Plan
from sam.scene import COUNTER_HEIGHT, CounterSurface, HeightMap, Scene
from sam.scene.surface import heights
from verification.runs import models
from verification.runs.files import read_run, write_run
from verification.runs.models import FEM, FEM_3D, ModelError

SIDE = 20e-6
WAVE = {"kind": "sinusoid", "amplitude": 0.1e-6, "wavelength_x": 10e-6, "wavelength_y": 8e-6}
OTHER = {
    "kind": "self-affine",
    "sq": 20e-9,
    "cutoff_long": 16e-6,
    "cutoff_short": 8e-6,
    "hurst": 0.8,
    "seed": 5,
}
ELASTIC = {"young": 210e9, "poisson": 0.3}
FLAT = {"shape": "flat"}
FACES = (0.0, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6)
BALL = {"shape": "sphere", "radius": 0.4e-3}


def pressed(counterbody, surface=None, **tables) -> Scene:
    """A patch of 32 x 32 cells."""
    grid = {"cells": (32, 32), "extent": (SIDE, SIDE), **tables.pop("grid", {})}
    loading = {"force": 0.02, "steps": 2, "unload": True, **tables.pop("loading", {})}
    return scene(counterbody=counterbody, surface=surface, grid=grid, loading=loading, **tables)


def of_heights(values) -> dict:
    return {"kind": "file", "path": HeightMap(values, (SIDE, SIDE))}


def cells(side=SIDE, n=32):
    return ((np.arange(n) + 0.5) / n - 0.5) * side


def equal_tables(one, two, but=()):
    """Every number of the tables of two results that both have, bit for bit."""
    assert set(one.tables) == set(two.tables)
    for name, table in one.tables.items():
        for column, values in table.items():
            if (name, column) not in but:
                np.testing.assert_array_equal(values, two.tables[name][column], f"{name}.{column}")


@pytest.mark.parametrize("elastic", [{}, ELASTIC], ids=["rigid", "elastic"])
@pytest.mark.parametrize("shape", [FLAT, BALL], ids=["flat", "sphere"])
@pytest.mark.parametrize("mu", [0.0, 0.3])
def test_waves_on_the_counter_body_are_those_on_the_body_upside_down(shape, elastic, mu):
    """A crest out of the counter-body points into the body: the gap knows only the sum of both heights."""
    on_body = solve(pressed({**shape, **elastic}, WAVE, friction=mu))
    opposite = solve(pressed({**shape, **elastic, "surface": WAVE}, friction=mu))
    assert opposite.quantities == on_body.quantities
    equal_tables(on_body, opposite, but=[("surface", "height_m")])
    table = opposite.tables["surface"]
    assert not table["height_m"].any()
    np.testing.assert_array_equal(table["counterbody_height_m"], on_body.tables["surface"]["height_m"])


@pytest.mark.parametrize("elastic", [{}, ELASTIC], ids=["rigid", "elastic"])
def test_waves_on_the_counter_body_strain_a_body_as_those_on_it_do(elastic):
    tables = {"body": {"plasticity": LINEAR}, "grid": {"border": "relief", "depths": FACES}}
    on_body = solve(pressed({**FLAT, **elastic}, WAVE, **tables))
    opposite = solve(pressed({**FLAT, **elastic, "surface": WAVE}, **tables))
    assert opposite.quantities == on_body.quantities and opposite.quantities["peeq_max"] > 1e-3
    equal_tables(on_body, opposite, but=[("surface", "height_m")])


def test_heights_of_both_bodies_add():
    both = solve(pressed({**FLAT, "surface": WAVE}, OTHER))
    x = cells()
    total = sum(heights(CounterSurface(**each), x, x, (SIDE, SIDE)) for each in (WAVE, OTHER))
    one = solve(pressed(FLAT, of_heights(total), grid={"cells": None, "extent": None}))
    for name, value in one.quantities.items():
        if value is not None:
            assert both.quantities[name] == pytest.approx(value, rel=1e-9), name
    np.testing.assert_allclose(
        both.tables["surface"]["p_Pa"], one.tables["surface"]["p_Pa"], rtol=1e-6, atol=1e3
    )


def test_a_column_of_its_own_only_under_a_rough_counter_body(tmp_path):
    rough = pressed({**FLAT, "surface": OTHER}, WAVE)
    result = solve(rough)
    write_run(result, rough, tmp_path, {})
    read = read_run(tmp_path).tables["surface"]
    np.testing.assert_array_equal(read[COUNTER_HEIGHT], result.tables["surface"][COUNTER_HEIGHT])
    assert list(read)[-1] == COUNTER_HEIGHT
    assert "counterbody_height_m" not in solve(pressed(FLAT, WAVE)).tables["surface"]


def test_the_plan_says_what_is_opposite():
    rough = pressed({**FLAT, "surface": {**OTHER, "renew": True}}, loading={"cycles": 3})
    stages = {each.stage: each for each in plan(rough).stages}
    assert stages["counter-surface heights"].size["stretches"] == 3
    assert not stages["surface heights"].runs
    reasons = {each.stage: each.reason for each in left_out(pressed(FLAT, WAVE))}
    assert reasons["counter-surface heights"] == "no [counterbody.surface]"


def gaps(found: Plan) -> list[np.ndarray]:
    problem = found.problem(Counters())
    return [problem.gap(load) for load in found.schedule.peaks]


def test_each_stretch_is_the_surface_of_the_next_seed_and_touches_first_at_zero():
    found = gaps(plan(pressed({**FLAT, "surface": {**OTHER, "renew": True}}, loading={"cycles": 3})))
    for k, gap in enumerate(found):
        alone = gaps(plan(pressed({**FLAT, "surface": {**OTHER, "seed": 5 + k}})))[0]
        np.testing.assert_array_equal(gap, alone)
        assert gap.min() == 0.0


def test_a_map_is_used_part_by_part_from_its_crop_on():
    values = np.arange(48.0 * 32.0).reshape(48, 32) * 1e-12
    surface = {
        "kind": "file",
        "path": HeightMap(values, (48e-6, 32e-6)),
        "crop": (-16e-6, 8e-6, 16e-6, 16e-6),
    }
    found = CounterSurface(**surface, renew=True)
    starts = [tuple(part.start for part in found.stretch(k).window) for k in range(7)]
    assert starts == [(0, 16), (16, 16), (32, 16), (0, 0), (16, 0), (32, 0), (0, 16)]
    x = cells(16e-6, 16)
    np.testing.assert_array_equal(heights(found.stretch(1), x, x, (16e-6, 16e-6)), values[16:32, 16:])


def test_parts_of_a_long_map_begin_at_its_first_cell():
    """A thousand cells from the middle of the map, where a part of a per mille is a cell."""
    values = np.arange(2048.0)[:, None] * np.ones(16) * 1e-12
    crop = (0.0, 0.0, 16e-6, 16e-6)
    found = CounterSurface(kind="file", path=HeightMap(values, (2048e-6, 16e-6)), crop=crop, renew=True)
    assert [found.stretch(k).window[0].start for k in (0, 1, 63, 64)] == [1016, 1032, 2024, 8]


def test_an_elastic_body_meets_another_stretch_in_each_cycle():
    rough = {**FLAT, "surface": {**OTHER, "renew": True}}
    history = solve(pressed(rough, WAVE, loading={"cycles": 3})).tables["history"]
    peaks = [p for p, step in zip(history["p_max_Pa"], history["step"], strict=True) if step == 2]
    alone = [solve(pressed({**FLAT, "surface": {**OTHER, "seed": 5 + k}}, WAVE)) for k in range(3)]
    assert peaks == [each.quantities["p_max_Pa"] for each in alone]
    assert len(set(peaks)) == 3


DISC = {**OTHER, "renew": True}


def runs_in(surface, **tables) -> Scene:
    """A small patch that yields over four cycles under friction."""
    return running_in(
        cycles=4, film={"coefficient": 0.2}, wear=None, counterbody={"surface": surface}, **tables
    )


def test_only_a_renewed_counter_surface_strains_in_every_cycle():
    """Isotropic hardening ends elastic where the same cells meet the same counter-body."""
    same, renewed = (solve(runs_in({**DISC, "renew": renew})).tables["cycles"] for renew in (False, True))
    assert same["new_strain_max"][0] == renewed["new_strain_max"][0] > 0
    assert same["new_strain_max"][1:] == [0.0, 0.0, 0.0]
    assert same["yielding_cells"][1:] == [0, 0, 0]
    assert min(renewed["new_strain_max"]) > 1e-4
    assert min(renewed["yielding_cells"]) > 0


def test_the_new_strain_of_the_first_cycle_is_the_strain_after_it():
    """Nothing was strained before; with a growing box too, as the first one is two layers deep here."""
    found = solve(runs_in(DISC))
    first = found.tables["cycles"]
    history = found.tables["history"]
    in_first = [p for p, cycle in zip(history["peeq_max"], history["cycle"], strict=True) if cycle == 1]
    assert first["new_strain_max"][0] == in_first[-1]


def test_a_sinusoid_renewed_is_the_same_in_every_cycle():
    pair = [solve(running_in(counterbody={"surface": {**WAVE, "renew": renew}})) for renew in (False, True)]
    assert pair[0].quantities == pair[1].quantities
    equal_tables(*pair)


def test_equal_parts_of_a_map_renewed_are_no_renewal():
    """Every part of the map has the same heights, so the cycles meet the same surface part after part."""
    side, n = 16e-6, 24
    tile = heights(CounterSurface(**OTHER), cells(side, n), cells(side, n), (side, side))
    surface = {
        "kind": "file",
        "path": HeightMap(np.tile(tile, (3, 1)), (3 * side, side)),
        "crop": (side, side),
    }
    pair = [solve(runs_in({**surface, "renew": renew})) for renew in (False, True)]
    assert pair[0].quantities == pair[1].quantities
    equal_tables(*pair)


def test_a_body_that_yields_only_under_a_later_stretch():
    """The first stretch stays elastic by itself, and the second does not."""
    first, grid = {**OTHER, "sq": 60e-9, "seed": 8}, {"border": "relief"}
    stretches = [{**FLAT, "surface": {**first, "seed": seed}} for seed in (8, 9)]
    largest = [solve(pressed(each, grid=grid)).quantities["mises_max_Pa"] for each in stretches]
    assert largest[0] < largest[1]
    body = {"plasticity": {"law": "linear", "yield_stress": sum(largest) / 2, "modulus": 1e10}}
    alone = [solve(pressed(each, grid=grid, body=body)) for each in stretches]
    assert alone[0].quantities["peeq_max"] == 0.0
    renewed = {**FLAT, "surface": {**first, "renew": True}}
    found = solve(pressed(renewed, grid=grid, body=body, loading={"cycles": 2}))
    before, after = found.tables["cycles"]["new_strain_max"]
    assert before == 0.0 < after
    assert found.quantities["peeq_max"] == pytest.approx(alone[1].quantities["peeq_max"], rel=1e-3)


def test_wear_of_a_cycle_adds_up_and_what_is_left_is_within_its_limit():
    found = solve(running_in(cycles=3, counterbody={"surface": DISC}))
    cycles = found.tables["cycles"]
    np.testing.assert_allclose(np.cumsum(cycles["wear_of_cycle_m3"]), cycles["wear_volume_m3"], rtol=1e-12)
    assert max(cycles["margin_to_limit"]) < 1.0
    assert solve(runs_in(DISC)).tables["cycles"]["margin_to_limit"] == [None] * 4


def test_the_seeds_of_all_cycles_are_told():
    assert runs_in(DISC).seeds == (1, 5, 6, 7, 8)
    assert runs_in(OTHER).seeds == (1, 5)
    assert runs_in({**WAVE, "renew": True}).seeds == (1,)


SMALL = {"path": HeightMap(np.ones((8, 8)), (8e-6, 8e-6)), "kind": "file"}
WORDS = "counterbody.surface"


@pytest.mark.parametrize(
    "surface, key",
    [
        ({"kind": "waves"}, f"{WORDS}.kind"),
        ({}, f"{WORDS}.kind"),
        ({**WAVE, "amplitude": 0.0}, f"{WORDS}.amplitude"),
        ({**WAVE, "amplitude": float("nan")}, f"{WORDS}.amplitude"),
        ({**WAVE, "seed": 1}, f"{WORDS}.seed"),
        ({**WAVE, "renew": 1}, f"{WORDS}.renew"),
        ({**WAVE, "renew": "yes"}, f"{WORDS}.renew"),
        ({**WAVE, "renewed": True}, f"{WORDS}.renewed"),
        ({**WAVE, "wavelength_x": -1e-6}, f"{WORDS}.wavelength_x"),
        ({"kind": "sinusoid", "amplitude": 1e-7}, f"{WORDS}.wavelength_x"),
        ({**WAVE, "wavelength_x": 1e-6}, "grid.cells"),
        ({**OTHER, "ra": 1e-8}, f"{WORDS}.sq"),
        ({**OTHER, "seed": -1}, f"{WORDS}.seed"),
        ({**OTHER, "seed": 1.5}, f"{WORDS}.seed"),
        ({**OTHER, "hurst": 2.0}, f"{WORDS}.hurst"),
        ({**OTHER, "cutoff_short": 20e-6}, f"{WORDS}.cutoff_short"),
        ({**OTHER, "cutoff_short": 1e-6}, "grid.cells"),
        ({**OTHER, "path": HeightMap(np.ones((8, 8)), (8e-6, 8e-6))}, f"{WORDS}.path"),
        ({"kind": "file"}, f"{WORDS}.path"),
        ({**SMALL, "crop": (9e-6, 8e-6)}, f"{WORDS}.crop"),
        ({**SMALL, "crop": (4e-6,)}, f"{WORDS}.crop"),
        ({**SMALL, "form": "cone"}, f"{WORDS}.form"),
        ({**SMALL, "resample": "spline"}, f"{WORDS}.resample"),
        ({**SMALL, "renew": True}, f"{WORDS}.renew"),
        (SMALL, "grid.cells"),
    ],
)
def test_malformed_tables_are_refused_by_name(surface, key):
    with pytest.raises(ValidationError) as refused:
        pressed({**FLAT, "surface": surface})
    assert key in [".".join(map(str, line["loc"])) for line in refused.value.errors()]


def test_maps_of_both_bodies_have_one_grid():
    with pytest.raises(ValidationError, match=r"\[32, 32\] heights on 2e-05 m x 2e-05 m"):
        scene(counterbody={**FLAT, "surface": SMALL}, surface=of_heights(np.eye(32) * 1e-7))


def test_a_scene_without_its_maps_is_refused_by_name():
    known = HeightMap.known_by("0" * 64, (32, 32), (SIDE, SIDE))
    with pytest.raises(UnsupportedScene, match=r"counterbody\.surface\.path"):
        solve(scene(counterbody={**FLAT, "surface": {"kind": "file", "path": known}}))


@pytest.mark.parametrize(
    "model, counterbody, key",
    [
        (FEM, {**BALL, "surface": WAVE}, "counterbody.surface.kind"),
        (FEM_3D, {**BALL, **ELASTIC, "surface": WAVE}, "counterbody.young"),
        (FEM_3D, {**FLAT, "surface": DISC}, "counterbody.surface.renew"),
    ],
)
def test_finite_elements_refuse_by_name_what_they_cannot_represent(model, counterbody, key):
    with pytest.raises(ModelError, match=key):
        models.check(pressed(counterbody, loading={"cycles": 2}), model)
