# SPDX-License-Identifier: MIT
"""A counter-body that moves: its path, groove and rough surface, and film and wear on its way."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from builders import CHEMICAL_FILM, PATH, SWIFT, SWIFT_YIELD, hertz_force, parsed, running_in, scene

import sam
from sam.grid.cells import CellGrid, Window
from sam.moving import Track, _cross as cross_table, _track as track_table
from sam.planner.make import schedule_of
from sam.results.history import Box
from sam.results.tables import refined_peak
from sam.scene import HeightMap, Scene, SceneError, Status
from sam.scene.result import UNLOADED
from sam.scene.surface import CounterSurface, Strip, heights
from sam.scene.verdict import Groove
from sam.schedule import Load
from sam.tribofilm.law import FilmLaw, FilmState
from sam.tribofilm.state import FilmOnCells, bins_of_visits

# the path and its passes


def test_steps_are_counted_in_radii_of_hertz():
    """a = (3 F R/(4 E*))^(1/3) = 6.053 um: 18 um in steps of a/4 are 11.89: 12. Of a punch its flat end."""
    path = PATH.replace("steps = 4", "step_per_radius = 4")
    assert parsed(add=path).strokes.count == 12
    assert parsed(('force = "0.65 N"', 'approach = "0.349 um"'), add=path).strokes.count == 12  # a^2/R
    for punch in ('punch"\nradius = "6 um"', 'rounded-punch"\nradius = "50 um"\nflat_radius = "6 um"'):
        assert parsed(('sphere"\nradius = "105 um"', punch), add=path).strokes.count == 12


def test_the_steps_of_a_scene_to_and_fro():
    loading = {"force": 0.65, "steps": 2, "unload": True, "cycles": 2}
    path = {"start": (-9e-6, 0.0), "end": (9e-6, 0.0), "steps": 4, "return": "to-and-fro"}
    schedule = schedule_of(scene(loading=loading | {"path": path}, friction=0.1))
    loads = [(t.cycle, t.step, round(t.load.x * 1e6, 9), t.load.force, t.load.sign) for t in schedule.targets]
    full = [(1, 2 + k, -9 + 4.5 * k, 0.65, 1.0) for k in range(5)]
    back = [(2, k, 9 - 4.5 * k, 0.65, -1.0) for k in range(1, 5)]
    assert loads == [(1, 1, -9.0, 0.325, 1.0), *full, *back, (2, 5, -9.0, 0.0, -1.0)]
    peaks = [t.step for t in schedule.targets if schedule.at_peak(t.cycle, t.step)]
    assert peaks == [2, 3, 4, 5, 6, 1, 2, 3, 4]
    assert schedule.targets[-2].snapshot == "peak" and schedule.targets[-1].snapshot == "unloaded"
    backwards = {"force": 0.65, "path": {"start": (9e-6, 0.0), "end": (-9e-6, 0.0), "steps": 4}, "cycles": 2}
    signs = {target.load.sign for target in schedule_of(scene(loading=backwards, friction=0.1)).targets}
    assert signs == {-1.0}


class TestTrack:
    GRID = CellGrid(8, 6, 1.0, 1.0, np.zeros(1))
    TRACK = Track((-2.0, 0.5), (2.0, 0.5), 0.5, (0.1, 0.2))

    @pytest.mark.parametrize("i, j", [*itertools.product((-2, 0, 3), (-1, 2))])
    def test_carries_a_pressure_and_lets_none_come_in_on_the_other_side(self, i, j):
        pressure = np.arange(1.0, 49.0).reshape(8, 6)
        moved = self.TRACK.carried(self.GRID, pressure, Load(1.0), Load(1.0, x=i + 0.3, y=j - 0.4))
        wide = np.zeros((24, 18))
        wide[8 + i : 16 + i, 6 + j : 12 + j] = pressure
        np.testing.assert_array_equal(moved, wide[8:16, 6:12])

    def test_carries_nothing_that_has_left_the_grid(self):
        pressure = np.zeros((8, 6))
        pressure[0] = 1.0
        assert self.TRACK.carried(self.GRID, pressure, Load(1.0), Load(1.0, x=-1.0)) is None

    def test_a_contact_is_at_the_edge_where_its_cells_are_the_outermost(self):
        pressure = np.zeros((8, 6))
        assert not Track.at_edge(self.GRID, pressure, self.GRID.whole)
        pressure[3:5, 2:4] = 1.0
        assert not Track.at_edge(self.GRID, pressure, self.GRID.whole)
        pressure[7, 3] = 1.0
        assert Track.at_edge(self.GRID, pressure, self.GRID.whole)

    def test_two_rows_of_cells_touch_a_path_between_them(self):
        track = Track((-2.0, 0.0), (2.0, 0.0), 0.5, None)
        assert track.touched(self.GRID.y, 1.0).tolist() == [False, False, True, True, False, False]

    def test_force_of_a_pressure_on_a_slope(self):
        """Of one cell, p dA (x - s)/R, and mu p dA of friction; across the grid that along the path."""
        pressure = np.zeros((3, 2))
        pressure[2, 0] = 4.0
        load, window = Load(4.0, x=1.0, y=0.5), Window(4, 2, 3, 2)  # the cell at x = 2.5, y = -0.5
        found = self.TRACK.moved(self.GRID, load, pressure, window=window, traction=0.3)
        assert (found.way, found.offset) == (3.0, 1.5)
        assert found.force == pytest.approx(4.0 * (0.1 * 1.5 + 0.3))
        track, cell = Track((0.0, -1.0), (0.0, 1.0), 0.5, (0.1, 0.2)), Window(4, 3, 1, 1)  # x = y = 0.5
        found = track.moved(self.GRID, Load(1.0), np.ones((1, 1)), window=cell, traction=0.0)
        assert (found.way, found.offset) == (1.0, 0.5) and found.force == pytest.approx(0.2 * 0.5)
        flat = replace(self.TRACK, curvatures=None)  # a punch: its slope is not known
        found = flat.moved(self.GRID, load, pressure, window=window, traction=0.3)
        assert (found.way, found.offset) == (3.0, 1.5) and np.isnan(found.force) and not found.at_edge

    def test_measures_of_a_made_groove(self):
        """1 + exp(-s) in the steady part 3 <= s <= 8.5 of a length of 10; shoulders of 0.1, 0.3 and 0.2."""
        way = np.linspace(-2.0, 12.0, 1401)
        uz = np.where(way >= 0, 1 + np.exp(-way), 2 + 3 * way)
        uz[way < -0.5] = -0.1
        uz[way > 10] = -0.3
        steady, across = (way >= 3) & (way <= 8.5), np.array([1.0, -0.2, 0.0])
        found = Groove.of(way, uz, steady, 10.0, across=across, peak=refined_peak(way, uz))
        depth = 1 + (np.exp(-3) - np.exp(-8.5)) / 5.5
        assert (found.at_start, found.at_end, found.beside) == (0.1, 0.3, 0.2)
        assert found.depth == pytest.approx(depth, rel=1e-3)
        assert found.transient == pytest.approx(-np.log(1.02 * depth - 1), abs=1e-2)
        assert found.middle == pytest.approx(1 + np.exp(-5.75), rel=1e-3)
        assert found.deepest == pytest.approx(2.0, rel=1e-2) and abs(found.deepest_at) < 0.02

    def test_tables_of_a_made_track(self):
        """Cells of 1 in a box of 4 x 3 x 2 cells: stresses are means over both rows that touch the path."""
        made = np.random.Generator(np.random.PCG64(5)).normal
        x, y, z = np.arange(-2.0, 3.0), np.arange(-2.0, 2.0), np.array([0, 0.4, 1.2])
        box = Box(x, y, z, *made(size=(2, 6, 2, 4, 3)), np.arange(24.0).reshape(2, 4, 3))
        last = SimpleNamespace(box=box, state=UNLOADED, worn=None, residual_displacement=made(size=(8, 6)))
        track = Track((-2.0, 0.0), (2.0, 0.0), 0.25, None)
        along, across = track_table(track, self.GRID, last), cross_table(track, self.GRID, last)
        stress = box.stress[..., 1:].mean(axis=-1)
        for place, layer, depth in (("top", 0, 0.2), ("deep", 1, 0.8)):
            np.testing.assert_allclose(along[f"{place}_z_m"], depth, rtol=1e-12)
            for k, name in ((0, "sxx"), (1, "syy"), (4, "sxz")):
                np.testing.assert_array_equal(along[f"{place}_{name}_Pa"][2:6], stress[k, layer])
        np.testing.assert_array_equal(along["peeq_max"], [0, 0, 14, 17, 20, 23, 0, 0])
        np.testing.assert_allclose(across["y_m"], np.repeat([-1.5, -0.5, 0.5], 2), rtol=1e-12)
        np.testing.assert_allclose(across["z_m"], np.tile([0.2, 0.8], 3), rtol=1e-12)
        np.testing.assert_array_equal(across["syy_Pa"], box.stress[1, :, 2].T.ravel())

    @pytest.mark.parametrize("share, warned", [(0.5, False), (0.5004, True)])
    def test_half_a_radius_is_not_warned_of(self, share, warned):
        assert bool(Track((0.0, 0.0), (4.0, 0.0), 1.0, (0.1, 0.1), share).warnings) is warned


# smooth bodies

RADIUS, P0 = 1e-2, 4 * SWIFT_YIELD
A = np.pi * P0 * RADIUS / (2 * 210e9 / 0.91)  # of Hertz, Johnson 1985, Eq. 4.24


def moving(path: dict, *, track=2.0, plasticity=SWIFT, grid=None, **tables) -> Scene:
    """A sphere at p0 = 4 yield stresses on 4 cells in a, the path in a about the origin."""
    h, nx = A / 4, 2 * round((track / 2 + 2.2) * 4) + 1
    depths = {"depths": tuple(h * np.append(np.arange(7), [7.2, 8.8, 12]))} if plasticity else {}
    ends = {"start": (-track / 2 * A, 0.0), "end": (track / 2 * A, 0.0)}
    loading = {"force": hertz_force(P0, RADIUS), "steps": 1, "unload": True, "path": ends | path}
    return scene(
        body={"plasticity": plasticity},
        loading=loading | tables.pop("loading", {}),
        grid={"cells": (nx, 15), "extent": (nx * h, 15 * h)} | depths | (grid or {}),
        solver={"tolerance": 1e-4},
        **{"counterbody": {"shape": "sphere", "radius": RADIUS}} | tables,
    )


class TestGroove:
    def test_has_its_measures(self):
        found = sam.solve(moving({"steps": 8}, track=6.0, loading={"steps": 2}))
        quantities, table = found.quantities, found.tables["track"]
        steady = np.array(table["steady"]) == 1
        assert found.converged and found.status == Status.CONVERGED
        assert quantities["groove_depth_m"] == pytest.approx(table["uz_m"][steady].mean())
        assert -3 * A < quantities["groove_deepest_x_m"] < -2 * A
        assert quantities["groove_deepest_m"] > quantities["groove_depth_m"] > 0
        assert 0 < quantities["shoulder_start_m"] < quantities["shoulder_end_m"]
        assert quantities["rolling_coefficient"] > 0
        line = found.tables["line"]
        unloaded = np.array(line["state"]) == "unloaded"
        np.testing.assert_array_equal(np.asarray(line["uz_m"])[unloaded], table["uz_m"])


def test_says_where_the_plastic_zone_left_the_grid():
    few = {"depths": tuple(A / 4 * np.arange(3))}
    found = sam.solve(moving({"steps": 3}, grid=few))
    assert found.status == Status.PLASTIC_ZONE_AT_GRID_EDGE
    assert "grid.depth" in found.message and "the counter-body is at x = " in found.message


@pytest.mark.parametrize("law", [None, {"law": "perfect", "yield_stress": 2.3 * SWIFT_YIELD}])
def test_says_where_the_contact_left_the_grid(law):
    """Ending 1.1 radii behind the path: a body that yields ends, an elastic one says from where."""
    narrow = {"cells": (33, 15), "extent": (33 * A / 4, 15 * A / 4)}
    path = {"steps": 8, "start": (-2 * A, 0.0)}
    found = sam.solve(moving(path, track=6.0, plasticity=law, grid=narrow, loading={"steps": 2}))
    assert found.status == Status.CONTACT_AT_GRID_EDGE
    assert "raise grid.extent" in found.message and "after" in found.message
    assert len(found.tables["history"]["step"]) > 5
    assert set(found.tables["line"]["state"]) == ({"last"} if law else {"peak", "unloaded"})


# rough bodies

SIDE, CELLS = 16e-6, 24
CELL = SIDE / CELLS
WAVES = {"kind": "self-affine", "cutoff_long": SIDE, "cutoff_short": SIDE / 2, "hurst": 0.8}
COUNTER = {**WAVES, "sq": 20e-9, "seed": 7}
X = (np.arange(CELLS) - (CELLS - 1) / 2) * CELL


def strip(surface, start=(0.0, 0.0), way=(12 * CELL, 0.0), share=1.0) -> Strip:
    """Of a counter-body over the patch; surface: its keys."""
    return Strip(CounterSurface(**surface), (CELLS,) * 2, (SIDE,) * 2, start, way, share)


class TestStrip:
    @pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
    def test_a_way_back_and_across_meets_the_same_heights(self, share):
        """A path of -6 cells along x and 8 along y, of which half is slid."""
        over = strip(COUNTER, (0.0, CELL), (-3 * CELL, 4 * CELL), 0.5)
        found = over.at(0, (-6 * CELL * share, CELL + 8 * CELL * share))
        x, y = X + 3 * CELL * (share - 0.5), X - 4 * CELL * (share - 0.5)
        between = (-CELL / 2, CELL / 2) if share == 0.5 else (0.0,)  # two cells along x
        shifted = [heights(over.surface, x + d, y, (27 * CELL, 28 * CELL)) for d in between]
        expected = sum(shifted) / len(shifted)
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.ptp(expected))

    def test_of_a_map_the_middle_is_taken(self):
        values = np.random.Generator(np.random.PCG64(1)).normal(size=(40, 26))
        of_map = {"kind": "file", "path": HeightMap(values, (40 * CELL, 26 * CELL))}
        over = strip(of_map)
        np.testing.assert_array_equal(over.at(0, (0.0, 0.0)), values[14:38, 1:25])
        np.testing.assert_array_equal(over.at(0, (12 * CELL, 0.0)), values[2:26, 1:25])
        used = CounterSurface(kind="file", path=HeightMap(values[2:38, 1:25], (36 * CELL, 24 * CELL)))
        falling = replace(over, relief=True)
        alone = replace(falling, surface=used)  # the border falls by the heights that come over the patch
        np.testing.assert_array_equal(falling.at(0, (0.0, 0.0)), alone.at(0, (0.0, 0.0)))

    @pytest.mark.parametrize("cells, warned", [(8, False), (7.996, True)])
    def test_an_eighth_of_a_wave_is_not_warned_of(self, cells, warned):
        over = strip(of_wave(cells), way=(4 * CELL, 0.0))
        track = Track((0.0, 0.0), (4 * CELL, 0.0), SIDE, (0.0, 0.0), CELL, plane=True, strip=over)
        assert bool(track.warnings) is warned

    @pytest.mark.parametrize("cells, least", [(12, None), (11.99, 2), (6.003, 2)])
    def test_a_quarter_of_a_wave_is_the_longest_step(self, cells, least):
        over = strip(of_wave(cells), way=(3 * CELL, 0.0))
        assert [words.split()[0] for _, words in over.excesses(1)] == [str(least)] * bool(least)


def test_a_wave_is_drawn_from_no_seed():
    assert CounterSurface(**of_wave(8), renew=True).seeds(3) == ()
    assert CounterSurface(**COUNTER, renew=True).seeds(3) == (7, 8, 9)


def of_wave(cells: float) -> dict:
    return {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": cells * CELL}


def test_a_body_that_yields_only_further_along_the_path():
    loading = {"force": 0.01, "path": {"start": (-3 * CELL, 0.0), "end": (3 * CELL, 0.0), "steps": 6}}
    keys = {"counterbody": {"shape": "sphere", "radius": 400e-6}, "loading": loading, "cycles": 1, "steps": 1}
    law = {"law": "perfect", "yield_stress": 3.8e9}
    found = sam.solve(running_in(plasticity=law, film=None, wear=None, **keys))
    peeq = np.array(found.tables["history"]["peeq_max"])
    assert peeq[0] == 0 < peeq[-1]


def test_a_map_alone_asks_for_a_grid():
    values = np.random.Generator(np.random.PCG64(1)).normal(scale=1e-8, size=(36, 24))
    surface = {"kind": "file", "path": HeightMap(values, (36 * CELL, 24 * CELL))}
    path = {"start": (-6 * CELL, 0.0), "end": (6 * CELL, 0.0), "steps": 6}
    grid = {"cells": (CELLS, CELLS), "extent": (SIDE, SIDE)}
    found = scene(counterbody={"shape": "flat", "surface": surface}, loading={"path": path}, grid=grid)
    assert found.counter_strip.whole == (36, 24) and found.patch[0] == (CELLS, CELLS)
    with pytest.raises(SceneError, match="longer than the patch"):
        Scene(**{**dict(found), "grid": None})


# film and wear on the way

LIMIT, RATE, TRACK = 0.02, 3.0, 10.0
LAW = FilmLaw(80e9, 0.3, 2e9 / 3, 0.1, 0.4, LIMIT)
ALONG = (np.arange(40) + 0.5) / 4  # cells of 1/4 along a path of 10
HALF = 1.0  # of the contact


def swept(track: Track, cycles: int, steps: int = 40):
    """(cycle, film) after each step of a contact of half-width HALF over cells in a row."""
    film_of = FilmOnCells(LAW, (len(ALONG), 1), RATE, track.period)
    film = film_of.fresh(np.zeros((4, len(ALONG), 1)))
    for cycle in range(1, cycles + 1):
        ways = np.linspace(0.0, TRACK, steps + 1)
        for x in ways[::-1] if track.returns and cycle % 2 == 0 else ways:
            before = film_of.entered(film, track.clock(cycle, Load(1.0, x=x)))
            pressure = np.where(np.abs(ALONG - x) <= HALF, 1e8, 0.0)[:, None]
            film = film_of.tested(before, before, np.zeros((4, len(ALONG), 1)), pressure=pressure, sign=1.0)
            yield cycle, film
        if not track.returns:
            film = replace(film, visits=film.visits.unloaded(film.visits.strain))


def test_one_way_a_cell_is_out_of_contact_for_the_closed_track_less_the_contact():
    """Eq. 16 and 17: K_0 sqrt((track - 2 a)/V)/h from the second pass on, first that of the scene."""
    track = Track((0.0, 0.0), (TRACK, 0.0), HALF, None, period=25.0)
    first, second = np.full(len(ALONG), np.nan), np.full(len(ALONG), np.nan)
    for cycle, film in swept(track, 2):
        found, inside = (first, second)[cycle - 1], film.visits.inside[:, 0]
        found[inside] = film.visits.limit[inside, 0]
    middle = (ALONG > HALF) & (ALONG < TRACK - HALF)
    np.testing.assert_array_equal(first, LIMIT)
    np.testing.assert_allclose((second / RATE)[middle] ** 2, 25.0 - 2 * HALF, atol=0.26)  # a step
    counts = film.visits.counts
    assert counts.sum() == len(ALONG) and counts[-1] == len(ALONG)  # all longer than 25/sqrt(2)
    bins = bins_of_visits(25.0)
    assert bins[-1] == 25.0 and bins[1:] / bins[:-1] == pytest.approx(np.sqrt(2.0), rel=1e-12)


def test_to_and_fro_the_film_thins_least_near_the_ends():
    """At d from the end the cell is out of contact for 2 (d - a), and not at all for d < a."""
    track = Track((0.0, 0.0), (TRACK, 0.0), HALF, None, period=TRACK, returns=True)
    back = np.full(len(ALONG), np.nan)
    for cycle, film in swept(track, 2):
        if cycle == 2:
            inside = film.visits.inside[:, 0]
            back[inside] = film.visits.limit[inside, 0]
    out, end = (back / RATE) ** 2, TRACK - ALONG
    left = end > HALF + 0.25
    np.testing.assert_allclose(out[left], 2 * (end - HALF)[left], atol=0.26)
    np.testing.assert_array_equal(back[end < HALF - 0.25], LIMIT)  # still the first visit


def test_a_failure_lasts_for_the_visit_and_unloading_in_place_ends_none():
    film_of, shape = FilmOnCells(LAW, (2, 1), RATE, 1.0), (2, 1)
    film = film_of.fresh(np.zeros((4, *shape)))
    too_much = np.array([[5e9], [0.0]])  # more than the film bears

    def step(film, clock, pressure):
        before = film_of.entered(film, clock)
        return film_of.tested(before, before, np.ones((4, *shape)), pressure=pressure, sign=1.0)

    film = step(film, 0.0, too_much)
    assert film.film.failed.ravel().tolist() == [True, False]
    unloaded = replace(film, visits=film.visits.unloaded(film.visits.strain))
    again = step(unloaded, 1e-16, np.full(shape, 1e6))
    assert again.film.failed.ravel().tolist() == [True, False]  # nothing has moved
    away = step(film, 0.5, np.zeros(shape))
    assert away.film.failed.ravel().tolist() == [True, False]
    back = film_of.entered(away, 0.75)
    assert not back.film.failed.any() and back.visits.limit[0, 0] == pytest.approx(RATE * 0.5)
    np.testing.assert_array_equal(back.reference[:, 0], 1.0)  # strain counts from there and then
    np.testing.assert_array_equal(back.film.plastic[:, 0], 0.0)
    assert film_of.entered(back, 0.75).film.failed is back.film.failed  # nothing is solved anew


def test_a_limit_of_each_cell_takes_the_place_of_that_of_the_law():
    strain, pressure = np.full((3, 2, 1), 5e-3), np.full((2, 1), 2.4e9)
    lost = LAW.step(FilmState.fresh((2, 1)), strain, pressure).thinning[0, 0]
    limits = np.array([[lost * 0.9], [lost * 1.1]])
    found = LAW.step(FilmState.fresh((2, 1)), strain, pressure, limit=limits)
    assert found.failed.ravel().tolist() == [True, False] and lost > 0


def worn(**path) -> Scene:
    """A rough pin that a renewed disc wears, with a film, in two passes of 6 cells."""
    growth = {"growth_coefficient": 3.644e-9, "track": 0.31415, "contact_width": 300e-6, "speed": 1.0}
    film = {key: value for key, value in CHEMICAL_FILM.items() if key != "strain_limit"} | growth
    ends = {"start": (-3 * CELL, 0.0), "end": (3 * CELL, 0.0), "steps": 3} | path
    disc = {**COUNTER, "seed": 8, "renew": True}
    found = running_in(steps=2, film=film, counterbody={"surface": disc}, loading={"path": ends})
    return found.model_copy(update={"solver": found.solver.model_copy(update={"tolerance": 1e-3})})


class TestPasses:
    def test_wear_friction_and_work_of_each_pass(self):
        found = sam.solve(worn())
        passes, cycles, history = (found.tables[name] for name in ("passes", "cycles", "history"))
        wear = np.array(passes["wear_of_pass_m3"])
        np.testing.assert_allclose(np.cumsum(wear), cycles["wear_volume_m3"])
        np.testing.assert_allclose(passes["wear_per_length_m2"], wear / (6 * CELL))
        full = (np.array(history["cycle"]) == 1) & (np.array(history["step"]) >= 2)
        full &= np.array(history["force_N"]) > 0.05
        s, drive, friction = (np.array(history[n])[full] for n in ("s_m", "fx_N", "friction_coefficient"))
        assert wear[0] > 0 and passes["work_J"][0] == pytest.approx(np.trapezoid(drive, s))
        assert passes["friction_mean"][0] == pytest.approx(friction.mean())
        assert 0 <= passes["protected_mean"][0] < 1 and 0.1 <= passes["friction_mean"][1] <= 0.4


def test_an_elastic_body_with_a_film_meets_every_pass():
    """No pass stands for all: the film of a later one may thin by less."""
    scene = worn()
    body = scene.body.model_copy(update={"plasticity": None})
    grid = scene.grid.model_copy(update={"depths": None})
    elastic = scene.model_copy(update={"body": body, "grid": grid, "wear": None})
    history = sam.solve(elastic).tables["history"]
    cycle, friction = (np.array(history[name]) for name in ("cycle", "friction_coefficient"))
    first, second = friction[cycle == 1], friction[cycle == 2]
    assert len(first) == len(second) and "elastic: equal" not in "".join(history["note"])
    assert second[:-1].mean() != first[:-1].mean()


def test_a_body_that_wears_is_unloaded_at_each_reversal():
    targets = schedule_of(worn(**{"return": "to-and-fro"})).targets
    assert [(t.cycle, round(t.load.x / CELL)) for t in targets if t.load.force == 0] == [(1, 3), (2, -3)]
    pressed = [t for t in targets if t.cycle == 2 and t.step <= 2]
    assert [(t.load.force, round(t.load.x / CELL)) for t in pressed] == [(0.03, 3), (0.06, 3)]
