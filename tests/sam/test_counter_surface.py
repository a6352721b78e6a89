# SPDX-License-Identifier: MIT
"""A rough counter-body: its heights in the gap, and other ones in each cycle."""

import numpy as np
import pytest
from builders import scene

from sam import left_out, plan, solve
from sam.contact.convolution import Counters
from sam.planner.plan import Plan
from sam.scene import CounterSurface, HeightMap, Scene
from sam.scene.surface import heights

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


def test_a_column_of_its_own_only_under_a_rough_counter_body():
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


def test_an_elastic_body_meets_another_stretch_in_each_cycle():
    rough = {**FLAT, "surface": {**OTHER, "renew": True}}
    history = solve(pressed(rough, WAVE, loading={"cycles": 3})).tables["history"]
    peaks = [p for p, step in zip(history["p_max_Pa"], history["step"], strict=True) if step == 2]
    alone = [solve(pressed({**FLAT, "surface": {**OTHER, "seed": 5 + k}}, WAVE)) for k in range(3)]
    assert peaks == [each.quantities["p_max_Pa"] for each in alone]
    assert len(set(peaks)) == 3
