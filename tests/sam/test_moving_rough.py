# SPDX-License-Identifier: MIT
"""Rough bodies below a counter-body that moves, and a rough counter-body that moves over them."""

from dataclasses import replace

import numpy as np
import pytest
from builders import RUN_IN_STEEL, STEEL
from pydantic import ValidationError

import sam
from sam.contact.convolution import Counters
from sam.moving import Track
from sam.scene import HeightMap, Scene
from sam.scene.surface import CounterSurface, Strip, heights, with_relief

SIDE, CELLS = 16e-6, 24
CELL = SIDE / CELLS
FACES = (0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6)
WAVES = {"kind": "self-affine", "cutoff_long": SIDE, "cutoff_short": SIDE / 2, "hurst": 0.8}
COUNTER = {**WAVES, "sq": 20e-9, "seed": 7}
PATH = {"start": (-6 * CELL, 0.0), "end": (6 * CELL, 0.0), "steps": 6}


def rough(*, other=None, surface=COUNTER, body=True, plasticity=RUN_IN_STEEL, **loading) -> Scene:
    """A counter-body (a plane, if no other is given) that slides 12 cells over a patch of 24 x 24."""
    counter = {"shape": "flat", **(other or {})} | ({} if surface is None else {"surface": surface})
    depths = {"depths": FACES} if plasticity else {}
    return Scene(
        body={**STEEL, "plasticity": plasticity},
        counterbody=counter,
        surface={**WAVES, "ra": 0.1e-6, "seed": 1} if body else None,
        loading={"force": 0.06, "steps": 1, "unload": True, "path": PATH} | loading,
        grid={"cells": (CELLS, CELLS), "extent": (SIDE, SIDE), "border": "relief", **depths},
        solver={"tolerance": 1e-4},
    )


class TestStrip:
    STRIP = Strip(
        CounterSurface(**COUNTER), (CELLS,) * 2, (SIDE,) * 2, PATH["start"], (12 * CELL, 0.0), 1.0, False
    )
    X = (np.arange(CELLS) - (CELLS - 1) / 2) * CELL

    @pytest.mark.parametrize("cells", [-6, -1, 0, 6])
    def test_slides_over_the_patch(self, cells):
        """c(x - s): heights of the strip, periodic over its own length, at shifted places."""
        found = self.STRIP.at(0, (cells * CELL, 0.0))
        surface, sides = CounterSurface(**COUNTER), (36 * CELL, SIDE)
        expected = heights(surface, self.X - cells * CELL, self.X, sides)
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.ptp(expected))

    def test_a_way_back_and_across_meets_the_same_heights(self):
        strip = Strip(
            CounterSurface(**COUNTER), (CELLS,) * 2, (SIDE,) * 2, (0.0, CELL), (-3 * CELL, 4 * CELL), 0.5
        )  # a path of -6 cells along x and 8 along y, of which half is slid
        sides = (27 * CELL, 28 * CELL)
        for share in (0.0, 0.5, 1.0):
            found = strip.at(0, (-6 * CELL * share, CELL + 8 * CELL * share))
            x, y = self.X + 3 * CELL * (share - 0.5), self.X - 4 * CELL * (share - 0.5)
            if share == 0.5:  # between two cells along x
                shifted = [heights(strip.surface, x + d, y, sides) for d in (-CELL / 2, CELL / 2)]
                expected = (shifted[0] + shifted[1]) / 2
            else:
                expected = heights(strip.surface, x, y, sides)
            np.testing.assert_allclose(found, expected, atol=1e-12 * np.ptp(expected))

    def test_the_border_falls_off_and_stays_in_place(self):
        falling = Strip(
            CounterSurface(**COUNTER), (CELLS,) * 2, (SIDE,) * 2, PATH["start"], (12 * CELL, 0.0), 1.0, True
        )
        one, two = (falling.at(0, (x, 0.0)) - self.STRIP.at(0, (x, 0.0)) for x in (0.0, 3 * CELL))
        np.testing.assert_allclose(one, two, atol=1e-12 * np.ptp(one))
        flat = with_relief(np.zeros((CELLS,) * 2), (self.X, self.X), (SIDE, SIDE), 1.0)
        np.testing.assert_allclose(one / one.min(), flat / flat.min(), atol=1e-9)

    def test_of_a_map_the_middle_is_taken(self):
        values = np.random.Generator(np.random.PCG64(1)).normal(size=(40, 26))
        found = HeightMap(values, (40 * CELL, 26 * CELL))
        strip = Strip(
            CounterSurface(kind="file", path=found),
            (CELLS,) * 2,
            (SIDE,) * 2,
            (0.0, 0.0),
            (12 * CELL, 0.0),
            1.0,
        )
        np.testing.assert_array_equal(strip.at(0, (0.0, 0.0)), values[14:38, 1:25])
        np.testing.assert_array_equal(strip.at(0, (12 * CELL, 0.0)), values[2:26, 1:25])
        used = CounterSurface(kind="file", path=HeightMap(values[2:38, 1:25], (36 * CELL, 24 * CELL)))
        falling = replace(strip, relief=True)
        alone = replace(falling, surface=used)  # the border falls by the heights that come over the patch
        np.testing.assert_array_equal(falling.at(0, (0.0, 0.0)), alone.at(0, (0.0, 0.0)))


WAVE = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": 2 * SIDE, "wavelength_y": 2 * SIDE}
SMOOTH = {"body": False, "plasticity": None, "unload": False}


def pressure_of(found) -> np.ndarray:
    """At the end of the path, (nx, ny) in Pa."""
    return np.array(found.tables["surface"]["p_Pa"]).reshape(CELLS, CELLS)


def test_a_wave_carries_its_pressure_with_it():
    """A crest across a smooth body, in steps of whole cells: the same pressure, further on."""
    path = {"start": (-2 * CELL, 0.0), "end": (2 * CELL, 0.0), "steps": 2}
    whole, half = (
        sam.solve(rough(surface=WAVE, **SMOOTH, path=path | more, force=0.01))
        for more in ({}, {"end": (0.0, 0.0), "start": (-4 * CELL, 0.0)})
    )
    history = whole.tables["history"]
    assert whole.converged and len(history["s_m"]) == 3
    np.testing.assert_array_equal(pressure_of(whole), pressure_of(half))  # only the middle of the way counts
    np.testing.assert_allclose(history["p_max_Pa"], history["p_max_Pa"][0], rtol=1e-6)
    np.testing.assert_allclose(history["pressure_offset_m"], [-2 * CELL, 0, 2 * CELL], atol=1e-3 * CELL)


def test_what_drives_a_rough_plane_is_what_the_contact_stores():
    """Elastic: F_x ds + F d(delta) = d(sum p u dA/2); waves of 12 cells leave some percent of it."""
    scene = rough(body=False, plasticity=None, path=PATH | {"steps": 12}, force=0.2)
    planned = sam.plan(scene)
    problem, stored = planned.problem(Counters()), []
    for target in planned.schedule.targets[:-1]:
        contact = problem.contact(target.load)
        stored.append((contact.pressure * contact.displacement).sum() * planned.grid.cell_area / 2)
    history = sam.solve(scene).tables["history"]
    s, drive, approach = (np.array(history[name])[:-1] for name in ("s_m", "fx_N", "approach_m"))
    work = np.append(0.0, np.cumsum((drive[1:] + drive[:-1]) / 2 * np.diff(s))) + 0.2 * (
        approach - approach[0]
    )
    np.testing.assert_allclose(work, np.array(stored) - stored[0], atol=0.04 * np.ptp(stored))


def test_a_body_that_yields_only_further_along_the_path():
    """The first place stays elastic by itself, and a later one does not."""
    path = {"start": (-3 * CELL, 0.0), "end": (3 * CELL, 0.0), "steps": 6}
    law = {"law": "perfect", "yield_stress": 3.8e9}
    ball = {"shape": "sphere", "radius": 400e-6}
    found = sam.solve(rough(other=ball, surface=None, plasticity=law, path=path, force=0.01))
    peeq = np.array(found.tables["history"]["peeq_max"])
    assert peeq[0] == 0 < peeq[-1]


def of_map(nx: int, ny: int, cell: float = CELL) -> dict:
    """A counter-surface from a file."""
    values = np.random.Generator(np.random.PCG64(1)).normal(scale=1e-8, size=(nx, ny))
    return {"kind": "file", "path": HeightMap(values, (nx * cell, ny * cell))}


REFUSED = {
    "a plane that moves without summits": ({"surface": None}, "loading.path", "nothing moves"),
    "a plane that rolls": ({"other": {"slip": 0.0}}, "counterbody.slip", "nothing moves on a plane"),
    "a plane without steps": (
        {"path": {"start": (0.0, 0.0), "end": (CELL, 0.0), "step_per_radius": 4.0}},
        "loading.path.steps",
        "no contact radius",
    ),
    "a way of broken cells": (
        {"path": PATH | {"end": (6.5 * CELL, 0.0)}},
        "loading.path.end",
        "slides 12.5 and 0 cells",
    ),
    "steps of broken cells": ({"path": PATH | {"steps": 8}}, "loading.path.steps", "12, or a divisor"),
    "half a slip in steps of broken cells": (
        {"other": {"slip": 0.5}, "path": PATH | {"steps": 4}},
        "loading.path.steps",
        "6, or a divisor",
    ),
    "steps that are long for the waves": ({"path": PATH | {"steps": 3}}, "loading.path.steps", "4 or more"),
    "renewed while the load stays on": (
        {"surface": {**COUNTER, "renew": True}, "path": PATH | {"return": "to-and-fro"}},
        "counterbody.surface.renew",
        "the load stays on",
    ),
    "a map that is shorter than the way": (
        {"surface": of_map(35, 24)},
        "counterbody.surface.path",
        "at least 2.4e-05 m x 1.6e-05 m, the patch and the way of the counter-body over it; it has 2.333",
    ),
    "a map of other cells": ({"surface": of_map(72, 48, CELL / 2)}, "counterbody.surface.path", "cells of"),
    "a map that is resampled": (
        {"surface": {**of_map(36, 24), "resample": "fourier"}},
        "counterbody.surface.resample",
        "remove it",
    ),
    "waves that the cells do not hold": (
        {"surface": {**COUNTER, "cutoff_short": 1.5 * CELL}},
        "grid.cells",
        "in the shortest wavelength",
    ),
}


@pytest.mark.parametrize("keys, key, words", REFUSED.values(), ids=REFUSED)
def test_a_refusal_names_key_and_what_is_allowed(keys, key, words):
    with pytest.raises(ValidationError) as caught:
        rough(**keys)
    found = {".".join(map(str, each["loc"])): each["ctx"]["allowed"] for each in caught.value.errors()}
    assert key in found and words in found[key], found


def test_a_map_alone_asks_for_a_grid():
    scene = rough(surface=of_map(36, 24), body=False)
    assert scene.counter_strip.whole == (36, 24) and scene.patch[0] == (CELLS, CELLS)
    with pytest.raises(ValidationError, match="longer than the patch"):
        Scene(**{**dict(scene), "grid": None})


def test_long_steps_over_summits_are_warned_of():
    warnings = [sam.plan(rough(path=PATH | {"steps": n})).track.warnings for n in (4, 12)]
    assert len(warnings[0]) == 1 and "0.25 of its shortest wave" in warnings[0][0] and not warnings[1]


@pytest.mark.parametrize("cells, warned", [(8, False), (7.996, True)])
def test_an_eighth_of_a_wave_is_not_warned_of(cells, warned):
    wave = CounterSurface(kind="sinusoid", amplitude=1e-8, wavelength_x=cells * CELL)
    strip = Strip(wave, (CELLS,) * 2, (SIDE,) * 2, (0.0, 0.0), (4 * CELL, 0.0), 1.0)
    track = Track((0.0, 0.0), (4 * CELL, 0.0), SIDE, (0.0, 0.0), CELL, plane=True, strip=strip)
    assert bool(track.warnings) is warned


@pytest.mark.parametrize("cells, refused", [(12, False), (11.99, True)])
def test_a_quarter_of_a_wave_is_the_longest_step(cells, refused):
    wave = CounterSurface(kind="sinusoid", amplitude=1e-8, wavelength_x=cells * CELL)
    strip = Strip(wave, (CELLS,) * 2, (SIDE,) * 2, (0.0, 0.0), (3 * CELL, 0.0), 1.0)
    assert bool(list(strip.excesses(1))) is refused


@pytest.mark.parametrize("share, warned", [(0.5, False), (0.5004, True)])
def test_half_a_radius_is_not_warned_of(share, warned):
    assert bool(Track((0.0, 0.0), (4.0, 0.0), 1.0, (0.1, 0.1), share).warnings) is warned
