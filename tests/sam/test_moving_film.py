# SPDX-License-Identifier: MIT
"""Film and wear below a counter-body that moves: its visits to the cells, and what a pass does."""

from dataclasses import replace

import numpy as np
import pytest
from builders import CHEMICAL_FILM, RUN_IN_STEEL, STEEL

import sam
from sam.moving import Track
from sam.planner.make import schedule_of
from sam.plasticity.progress import Progressed
from sam.scene import Checkpoint, Scene
from sam.schedule import Load
from sam.tribofilm.law import FilmLaw, FilmState
from sam.tribofilm.state import FilmOnCells, VisitLaw, bins_of_visits

LIMIT, RATE, TRACK = 0.02, 3.0, 10.0
LAW = FilmLaw(80e9, 0.3, 2e9 / 3, 0.1, 0.4, LIMIT)
X = (np.arange(40) + 0.5) / 4  # cells of 1/4 along a path of 10
HALF = 1.0  # of the contact
GROWTH = {"growth_coefficient": 3.644e-9, "track": 0.31415, "contact_width": 300e-6, "speed": 1.0}
FILM = {key: value for key, value in CHEMICAL_FILM.items() if key != "strain_limit"} | GROWTH


def swept(track: Track, cycles: int, steps: int = 40):
    """The film after each step of a contact of half-width HALF over cells in a row, unloaded after each pass
    unless that goes back: (cycle, place, film).
    """
    film_of = FilmOnCells(LAW, (len(X), 1), VisitLaw(RATE, track.period))
    film = film_of.fresh(np.zeros((4, len(X), 1)))
    for cycle in range(1, cycles + 1):
        ways = np.linspace(0.0, TRACK, steps + 1)
        for x in ways[::-1] if track.returns and cycle % 2 == 0 else ways:
            before = film_of.entered(film, track.clock(cycle, Load(1.0, x=x)))
            pressure = np.where(np.abs(X - x) <= HALF, 1e8, 0.0)[:, None]
            film = film_of.tested(before, before, np.zeros((4, len(X), 1)), pressure=pressure, sign=1.0)
            yield cycle, x, film
        if not track.returns:
            film = replace(film, visits=film.visits.unloaded(film.visits.strain))


def test_one_way_a_cell_is_out_of_contact_for_the_closed_track_less_the_contact():
    """Eq. 16 and 17: K_0 sqrt((track - 2 a)/V)/h from the second pass on, first that of the scene."""
    track = Track((0.0, 0.0), (TRACK, 0.0), HALF, None, period=25.0)
    first, second = np.full(len(X), np.nan), np.full(len(X), np.nan)
    for cycle, _, film in swept(track, 2):
        found, inside = (first, second)[cycle - 1], film.visits.inside[:, 0]
        found[inside] = film.visits.limit[inside, 0]
    middle = (X > HALF) & (X < TRACK - HALF)
    np.testing.assert_array_equal(first, LIMIT)
    out = (second / RATE) ** 2
    np.testing.assert_allclose(out[middle], 25.0 - 2 * HALF, atol=0.26)  # a step
    counts = film.visits.counts
    assert counts.sum() == len(X) and counts[-1] == len(X)  # all longer than 25/sqrt(2)
    bins = bins_of_visits(25.0)
    assert bins[-1] == 25.0 and bins[1:] / bins[:-1] == pytest.approx(np.sqrt(2.0), rel=1e-12)


def test_to_and_fro_the_film_thins_least_near_the_ends():
    """At d from the end the cell is out of contact for 2 (d - a), and not at all for d < a."""
    track = Track((0.0, 0.0), (TRACK, 0.0), HALF, None, period=TRACK, returns=True)
    back = np.full(len(X), np.nan)
    for cycle, _, film in swept(track, 2):
        if cycle == 2:
            inside = film.visits.inside[:, 0]
            back[inside] = film.visits.limit[inside, 0]
    out, end = (back / RATE) ** 2, TRACK - X
    left = end > HALF + 0.25
    np.testing.assert_allclose(out[left], 2 * (end - HALF)[left], atol=0.26)
    np.testing.assert_array_equal(back[end < HALF - 0.25], LIMIT)  # still the first visit


def test_a_failure_lasts_for_the_visit_and_unloading_in_place_ends_none():
    film_of, shape = FilmOnCells(LAW, (2, 1), VisitLaw(RATE, 1.0)), (2, 1)
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


def test_a_given_limit_is_that_of_every_visit():
    film_of = FilmOnCells(LAW, (1, 1), VisitLaw(None, 1.0))
    film = film_of.fresh(np.zeros((4, 1, 1)))
    for clock, p in ((0.0, 1.0), (0.1, 0.0), (0.2, 1.0)):
        before = film_of.entered(film, clock)
        film = film_of.tested(before, before, np.zeros((4, 1, 1)), pressure=np.full((1, 1), p), sign=1.0)
    assert film.visits.limit[0, 0] == LIMIT and film.visits.counts.sum() == 1


def test_a_limit_of_each_cell_takes_the_place_of_that_of_the_law():
    law, strain = FilmLaw(80e9, 0.3, 2e9 / 3, 0.1, 0.4, LIMIT), np.full((3, 2, 1), 5e-3)
    pressure = np.full((2, 1), 2.4e9)
    lost = law.step(FilmState.fresh((2, 1)), strain, pressure).thinning[0, 0]
    limits = np.array([[lost * 0.9], [lost * 1.1]])
    found = law.step(FilmState.fresh((2, 1)), strain, pressure, limit=limits)
    assert found.failed.ravel().tolist() == [True, False] and lost > 0


SIDE, CELLS = 16e-6, 24
CELL = SIDE / CELLS
FACES = (0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6)
WAVES = {"kind": "self-affine", "cutoff_long": SIDE, "cutoff_short": SIDE / 2, "hurst": 0.8}


def worn(**path) -> Scene:
    """A rough pin that a renewed disc wears, with a film, in two passes of 6 cells."""
    ends = {"start": (-3 * CELL, 0.0), "end": (3 * CELL, 0.0), "steps": 3} | path
    return Scene(
        body={**STEEL, "plasticity": RUN_IN_STEEL},
        counterbody={"shape": "flat", "surface": {**WAVES, "sq": 20e-9, "seed": 8, "renew": True}},
        surface={**WAVES, "ra": 0.1e-6, "seed": 1},
        loading={"force": 0.06, "steps": 2, "unload": True, "cycles": 2, "path": ends},
        friction=FILM,
        wear={"strain_limit": 0.002},
        grid={"cells": (CELLS, CELLS), "extent": (SIDE, SIDE), "depths": FACES, "border": "relief"},
        solver={"tolerance": 1e-3},
    )


@pytest.fixture(scope="module")
def run():
    kept = []
    return sam.solve(worn(), checkpoint=kept.append), kept


class TestPasses:
    def test_wear_friction_and_work_of_each_pass(self, run):
        found, _ = run
        passes, cycles, history = (found.tables[name] for name in ("passes", "cycles", "history"))
        np.testing.assert_allclose(np.cumsum(passes["wear_of_pass_m3"]), cycles["wear_volume_m3"])
        assert passes["wear_of_pass_m3"][0] > 0
        np.testing.assert_allclose(
            passes["wear_per_length_m2"], np.array(passes["wear_of_pass_m3"]) / (6 * CELL)
        )
        full = (np.array(history["cycle"]) == 1) & (np.array(history["step"]) >= 2)
        full &= np.array(history["force_N"]) > 0.05
        s, drive, friction = (np.array(history[n])[full] for n in ("s_m", "fx_N", "friction_coefficient"))
        assert passes["work_J"][0] == pytest.approx(np.trapezoid(drive, s))
        assert passes["friction_mean"][0] == pytest.approx(friction.mean())
        assert 0 <= passes["protected_mean"][0] < 1 and 0.1 <= passes["friction_mean"][1] <= 0.4

    def test_visits_tell_how_long_cells_were_out_of_contact(self, run):
        """Thinning that a visit may take, K_0 sqrt(t)/h of the time without contact."""
        visits = run[0].tables["visits"]
        assert visits["way_m"][-1] == pytest.approx(6 * CELL) and sum(visits["visits"]) > 0
        np.testing.assert_allclose(visits["time_s"], np.array(visits["way_m"]) / 1.0)
        np.testing.assert_allclose(visits["thinning_limit"], 3.644e-9 * np.sqrt(visits["time_s"]) / 100e-9)

    def test_goes_on_from_the_middle_of_a_way(self, run):
        found, kept = run
        half = next(each for each in kept if each.done == found.tables["history"]["cycle"].index(2) + 3)
        again = sam.solve(worn(), start=half)
        for name, table in found.tables.items():
            for column, values in table.items():
                np.testing.assert_array_equal(values, again.tables[name][column], err_msg=f"{name}: {column}")

    def test_a_step_between_two_cells_takes_heights_between_them(self, run):
        """Of a step of two cells a half, and a half of that: interpolated, and the same at its end."""
        found, kept = run
        now = next(each for each in kept if each.done == 3).record(Progressed)
        end, half = now.targets[0].load, now.state.load.halfway_to(now.targets[0].load)
        cuts = now.state.load.halfway_to(half), half, end
        cut = Checkpoint.of("sam", replace(now, cuts=cuts), done=3, total=1, cost=kept[2].cost)
        again = sam.solve(worn(), start=cut)
        assert "cut into 3 steps" in again.tables["history"]["note"][3]
        for name in ("friction_mean", "work_J", "wear_of_pass_m3"):
            passes = (np.array(each.tables["passes"][name], dtype=float) for each in (again, found))
            np.testing.assert_allclose(*passes, rtol=0.05)

    def test_a_body_that_wears_is_unloaded_at_each_reversal(self):
        targets = schedule_of(worn(**{"return": "to-and-fro"})).targets
        assert [(t.cycle, round(t.load.x / CELL)) for t in targets if t.load.force == 0] == [(1, 3), (2, -3)]
        pressed = [t for t in targets if t.cycle == 2 and t.step <= 2]
        assert [(t.load.force, round(t.load.x / CELL)) for t in pressed] == [(0.03, 3), (0.06, 3)]


def test_an_elastic_body_with_a_film_meets_every_pass():
    """No pass stands for all: the film of a later one may thin by less."""
    scene = worn()
    body = scene.body.model_copy(update={"plasticity": None})
    grid = scene.grid.model_copy(update={"depths": None})
    found = sam.solve(scene.model_copy(update={"body": body, "grid": grid, "wear": None}))
    history = found.tables["history"]
    first, second = (
        np.array(history["friction_coefficient"])[np.array(history["cycle"]) == k] for k in (1, 2)
    )
    assert len(first) == len(second) and "elastic: equal" not in "".join(history["note"])
    assert second[:-1].mean() != first[:-1].mean()
