# SPDX-License-Identifier: MIT
"""The running-in cases: their scenes, measures and statements on made tables, gates on wrong ones."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import STEEL, running_in as small_patch
from made_histories import CYCLES, as_the_paper_says, history
from made_results import Made, red as red_gates

import sam
from sam.scene import load_scene
from verification.cases.case import with_grid, with_keys
from verification.cases.running_in import running_in, running_in_runs, running_in_wear
from verification.cases.running_in.running_in_scenes import (
    Effort,
    reduced,
    renewed,
    with_deviation,
    with_plasticity,
    with_seed,
)
from verification.cases.running_in.running_in_statements import (
    BULK,
    HARDENING,
    NAMES,
    STATEMENTS,
    A,
    B,
    judge,
)
from verification.cases.running_in.running_in_tables import (
    cases_table,
    cost_table,
    fate,
    held_of,
    new_strain_table,
    regimes_table,
    statements_table,
    varied_table,
)
from verification.cases.running_in.running_in_varied import varied_scenes
from verification.compare.running_in_measures import Limits, Scar, Spread
from verification.figures import run
from verification.figures.running_in import comparison, regime_map, six_panels
from verification.runs.files import write_run

SCENES = {case: load_scene(f"verification/scenes/running-in-{case}.toml") for case in (*NAMES, "curve-c")}


class TestScenes:
    def test_five_cases_differ_in_the_layer_and_its_limit_only(self):
        def rest(scene):
            body = scene.body.model_copy(
                update={
                    "plasticity": scene.body.plasticity.model_copy(
                        update={"profile": None, "layer_thickness": None}
                    )
                }
            )
            return scene.model_copy(
                update={
                    "title": "",
                    "body": body,
                    "wear": scene.wear.model_copy(update={"strain_limit_layer": None}),
                }
            )

        assert all(rest(scene) == rest(SCENES[BULK]) for scene in SCENES.values())
        limits = {case: scene.wear.strain_limit_layer for case, scene in SCENES.items()}
        assert limits == {
            BULK: None,
            A: 0.02,
            B: 0.02,
            "curve-b-ductile": 0.05,
            HARDENING: 0.02,
            "curve-c": 0.02,
        }
        film = SCENES[BULK].friction
        assert film.growth == pytest.approx(2.0415e-9, rel=1e-4) and film.thinning_limit == pytest.approx(
            0.020415, rel=1e-4
        )

    def test_layers_resolve_the_curves(self):
        """Between the knots of a curve, to 1 um, lie the centres of a layer or more."""
        for case in (A, B, "curve-c", HARDENING):
            faces = np.array(SCENES[case].grid.depths)
            centres = 0.5 * (faces[1:] + faces[:-1])
            knots = [z for z, _ in SCENES[case].body.plasticity.profile]
            assert all(((low < centres) & (centres < high)).any() for low, high in pairwise(knots))

    def test_reduced_keeps_the_nominal_pressure_and_the_cells(self):
        scene = reduced(SCENES[B], Effort((), (), 3, 4, 16))
        assert scene.grid.extent == pytest.approx((16e-6,) * 2) and scene.grid.cells == (16, 16)
        assert scene.loading.force / np.prod(scene.grid.extent) == pytest.approx(0.6 / 64e-6**2)
        assert (scene.loading.steps, scene.loading.unload_steps, scene.loading.cycles) == (4, 4, 3)
        whole = reduced(SCENES[B], Effort((), (), 25, 10, 64))
        assert whole == SCENES[B] and with_seed(whole, 2) == whole and with_seed(whole, 3) != whole

    def test_deviation_leaves_the_bulk_alone(self):
        z = np.array([0.0, 0.2e-6, 0.7e-6, 5e-6])
        before, after = (
            scene.body.plasticity.depth_profile()(z) for scene in (SCENES[B], with_deviation(SCENES[B], 1.25))
        )
        assert after - 1 == pytest.approx(1.25 * (before - 1), abs=1e-15) and after[-1] == 1.0

    def test_what_is_varied_differs_from_what_is_given(self):
        found = varied_scenes(SCENES, lambda name: SCENES[name.removeprefix("running-in-")])
        scenes = [scene for _, scene in found.values()]
        assert len({label for label, _ in found.values()}) == len(found)
        assert all(scene not in SCENES.values() for scene in scenes) and len(
            {repr(scene) for scene in scenes}
        ) == len(scenes)

    def test_the_file_of_the_second_reading_is_what_the_case_solves(self):
        assert renewed(SCENES[B]) == load_scene("verification/scenes/running-in-renewed.toml")

    def test_the_second_reading_changes_the_layer_the_counter_surface_and_the_depths_only(self):
        def printed(scene):
            scene = with_plasticity(with_keys(scene, "counterbody", surface=None), layer=None)
            return with_grid(scene, depths=scene.grid.depths[: len(SCENES[B].grid.depths)])

        for case, scene in SCENES.items():
            other = renewed(scene)
            assert printed(other).model_copy(update={"title": scene.title}) == scene
            assert other.grid.depths[-1] == 19.4e-6
            layer, law = other.body.plasticity.layer, scene.body.plasticity
            assert (layer is None) == (case == BULK)
            assert layer is None or (layer.B, layer.C, layer.n, layer.alpha) == (law.B, law.C, law.n, 1e3)
            assert Limits.of(other).strength <= Limits.of(scene).strength

    def test_no_two_cycles_and_no_two_surfaces_meet_the_same_counter_surface(self):
        scenes = [renewed(with_seed(SCENES[B], seed)) for seed in range(1, 11)]
        drawn = [seed for scene in scenes for seed in scene.counterbody.surface.seeds(25)]
        assert len(set(drawn)) == 250 and not set(drawn) & {scene.surface.seed for scene in scenes}

    def test_the_other_constant_is_that_of_the_layer_too(self):
        own, other = running_in_runs.limits_of(renewed(SCENES[B]))
        assert other.removal / own.removal == pytest.approx(1280 / 1780, rel=1e-12)


class TestMeasures:
    def test_rates_and_straightness_of_known_curves(self):
        line = history(3.0 * CYCLES + 7.0)
        assert line.rate(10, 25) == pytest.approx(3.0) and line.rate(0, 6) == pytest.approx((18 + 7) / 6)
        assert line.straightness(5, 25) == pytest.approx(1.0, abs=1e-12)
        assert np.isnan(history(np.full(25, 4.0)).straightness(5, 25)) and np.isnan(line.straightness(5, 26))
        saturating = history(1.0 - np.exp(-CYCLES / 2.0))
        assert saturating.straightness(5, 25) < 0.6 and np.isnan(line.at("volume", 26))

    def test_straightness_is_that_of_a_least_squares_line(self):
        v = np.cumsum(np.random.default_rng(3).uniform(size=25))
        x, y = CYCLES[4:], v[4:]
        rest = y - np.polyval(np.polyfit(x, y, 1), x)
        assert history(v).straightness(5, 25) == pytest.approx(1 - rest.var() / y.var(), rel=1e-10)

    def test_spread(self):
        assert Spread.of([3.0, 1.0, np.nan, 2.0]) == Spread(2.0, 1.0, 3.0, 3, 1.0)
        assert (
            Spread.of([np.nan]).text() == "–"
            and Spread.of([2.0]).text() == "2"
            and "1 to 3" in Spread.of([1.0, 3.0]).text()
        )


SMALL = reduced(SCENES[B], Effort((B,), (2,), 3, 2, 8))
N = 8


def made(order: str = "C", **changes) -> running_in.RunningInRun:
    """Eight by eight cells, three cycles; half of the load on failed film. order: how rows run, y first or x
    first.
    """
    x = (np.arange(N) - 3.5) * 1e-6
    p = np.zeros((N, N))
    p[2:4, 2:6] = SMALL.loading.force / 8 / 1e-12
    mu = np.where(p > 0, 0.1, np.nan)
    mu[3, 2:6] = 0.4
    worn = np.where(p > 0, 2e-8, 0.0)
    worn[2, 2] = 5e-8
    columns = {
        "x_m": x[:, None] + 0 * p,
        "y_m": x + 0 * p,
        "height_m": 1e-8 * np.arange(64.0).reshape(N, N),
        "p_Pa": p,
        "worn_m": worn,
        "friction": mu,
    }
    surface = {"state": ["peak"] * 64 + ["unloaded"] * 64}
    for name, values in columns.items():
        at_peak, later = values, values
        if name == "worn_m":
            at_peak = 0.5 * values
        if name in ("p_Pa", "friction"):
            later = 0.0 * p if name == "p_Pa" else np.full_like(p, np.nan)
        surface[name] = np.concatenate([at_peak.ravel(order), later.ravel(order)])
    volume = (7 * 2e-8 + 5e-8) * 1e-12
    rows = {
        "cycle": [1, 2, 3],
        "wear_volume_m3": [0.5 * volume, 0.5 * volume, volume],
        "friction_coefficient": [0.3, 0.28, 0.25],
        "sa_m": [2e-7] * 3,
        "sq_m": [3e-7] * 3,
        "ssk": [0.1] * 3,
        "protected_fraction": [0.4, 0.45, 0.5],
        "peeq_max": [0.01] * 3,
        "p_max_Pa": [p.max()] * 3,
        "new_strain_max": [0.01, 0.002, 0.0],
        "yielding_cells": [9, 4, 0],
        "wear_of_cycle_m3": [0.5 * volume, 0.0, 0.5 * volume],
    }
    steps = {"cycle": np.repeat([1, 2, 3], 2), "iterations": np.array([4, 2, 3, 2, 2, 1])}
    for name, change in changes.items():
        table = next(table for table in (rows, surface, steps) if name in table)
        table[name] = change(np.array(table[name], dtype=float))
    return running_in.RunningInRun(SMALL, Made(tables={"cycles": rows, "surface": surface, "history": steps}))


def red(*runs) -> set[str]:
    return red_gates("running-in", running_in.gates(runs), whole=True)


class TestGates:
    def test_surface_is_read_whichever_coordinate_runs_first(self):
        one, other = made().scar, made("F").scar
        assert all(
            np.array_equal(getattr(one, name), getattr(other, name), equal_nan=True) for name in vars(one)
        )
        assert one.height[1, 0] == 8e-8 and one.height[0, 1] == 1e-8

    def test_sums_of_the_made_surface(self):
        scar = made().scar
        assert scar.coefficient(0.1, 0.4) == pytest.approx(0.25) and scar.protected_fraction(0.1, 0.4) == 0.5
        assert scar.force == pytest.approx(SMALL.loading.force, rel=1e-12)
        assert scar.volume == pytest.approx(
            19e-20, rel=1e-12, abs=0.0
        )  # of the unloaded surface, twice that at the peak

    def test_right_numbers_pass(self):
        assert red(made(), made("F")) == set()

    @pytest.mark.parametrize(
        ("column", "change", "wrong"),
        [
            ("wear_volume_m3", lambda v: v * (1 + 1e-9), {"volume"}),
            ("wear_volume_m3", lambda v: v * [1.0, 0.9, 1.0], {"falls"}),
            ("friction_coefficient", lambda v: v + np.array([0, 0, 1e-9]), {"friction-sum"}),
            ("friction_coefficient", lambda v: v * [0.3, 1.0, 1.0], {"friction-range"}),
            ("protected_fraction", lambda v: v + 1e-3, {"protected"}),
            ("p_Pa", lambda v: v * (1 + 1e-8), {"load"}),
            ("iterations", lambda v: v[::-1], {"iterations"}),
            ("worn_m", lambda v: v - 1e-15, {"added", "volume"}),
            ("sa_m", lambda v: v * [1.0, np.nan, 1.0], {"cycles"}),
            ("cycle", lambda v: v + 1, {"cycles"}),
            ("new_strain_max", lambda v: v * [1.0, 0.0, 1.0], {"repeats"}),
        ],
    )
    def test_wrong_numbers_turn_red(self, column, change, wrong):
        assert red(made(), made(**{column: change})) == wrong

    def test_a_renewed_counter_surface_may_strain_what_has_come_to_rest(self):
        rested = made(new_strain_max=lambda v: v * [1.0, 0.0, 1.0])
        assert red(replace(rested, scene=renewed(SMALL))) == set()

    def test_runs_that_did_not_converge_are_counted_and_not_judged(self):
        lost = replace(
            made(wear_volume_m3=lambda v: 2 * v), result=Made(converged=False, status="not-converged")
        )
        assert red(made(), lost) == {"unconverged"}
        assert {"unconverged", "volume", "load"} <= red(lost)

    def test_cells_that_are_missing_are_an_error(self):
        one = made()
        short = {
            name: list(values)[:63] + list(values)[64:]
            for name, values in one.result.tables["surface"].items()
        }
        with pytest.raises(ValueError, match="63 rows"):
            Scar.of({"surface": short})


LIMITS = {case: running_in_runs.limits_of(scene) for case, scene in SCENES.items() if case in NAMES}


class TestTables:
    def test_rows_have_a_cell_for_each_column(self):
        found = {(case, seed): one for case, one in as_the_paper_says().items() for seed in (1, 2)}
        judged = [judge(statement, [as_the_paper_says()] * 5) for statement in STATEMENTS]
        own = {"given": (LIMITS[B][0], found[B, 1])}
        tables = (
            cases_table("printed inputs", found),
            statements_table({"printed inputs": judged, "renewed": judged}),
            regimes_table("printed inputs", LIMITS, found, {B: [(4, 1), (2, 0)]}),
            varied_table(own),
            new_strain_table({name: {B: [made().result.tables["cycles"]] * 2} for name in ("one", "two")}),
            cost_table({"two runs": [made().result] * 2}),
        )
        for table in tables:
            assert {len(row) for row in table.rows} == {len(table.columns)}

    def test_iterations_are_summed_over_the_steps_of_a_cycle(self):
        steps = {"cycle": np.repeat(np.arange(1, 8), 2), "iterations": np.tile([3, 1], 7)}
        steps["iterations"][-4:] = 1
        result = replace(
            made().result,
            tables={"history": steps, "cycles": {"cycle": np.arange(1, 8)}},
            cost={"cpu_s": 2.0, "solve_s": 7.0},
        )
        lost = replace(result, converged=False, cost={"cpu_s": 4.0, "solve_s": 14.0})
        row = cost_table({"one": [result, lost]}).rows[0]
        assert row[:4] == ("one", "1 of 2", "1.5 (1 to 2)", "3 (2 to 4)")
        assert row[6:8] == ("4 (4 to 4)", "2 (2 to 2)")

    def test_cells_that_hold_beyond_what_tears_are_counted(self):
        """Of eight equal cells in contact four have failed."""
        scar, own = made().scar, LIMITS[B][0]
        assert held_of(scar, replace(own, first=0.9 * scar.p.max()), (0.1, 0.4)) == (4, 4)
        assert held_of(scar, replace(own, first=1.1 * scar.p.max()), (0.1, 0.4)) == (4, 0)
        rows = regimes_table("printed inputs", LIMITS, {}, {B: [(4, 1), (2, 0)]}).rows
        assert [row[8] for row in rows] == ["0 of 0", "0 of 0", "1 of 6", "0 of 0", "0 of 0"]

    def test_fates_follow_from_the_pressures(self):
        assert "every spot" in fate(LIMITS[B][0], 5e9) and "no film fails" in fate(LIMITS[BULK][0], 3e9)
        assert fate(LIMITS[B][0], np.nan) == "no run converged"
        assert "removes nothing" in fate(LIMITS[BULK][0], 5e9) and "5.29" in fate(LIMITS[BULK][0], 6e9)


def test_figures_hold_the_numbers_that_they_show():
    one = made()
    drawing = six_panels(one.scar, one.history, (0.1, 0.4))
    volume = np.nansum(drawing.data["worn_m"]) * 1e-12
    assert len(drawing.figure.axes) >= 6 and volume == pytest.approx(
        one.history.volume[-1], rel=1e-12, abs=0.0
    )
    paper = as_the_paper_says()
    band = comparison({name: [paper[case]] * 2 for case, name in NAMES.items()})
    assert len(band.data["median"]) == 3 * 5 * 25
    limits = {NAMES[case]: pair for case, pair in LIMITS.items()}
    regimes = regime_map(limits, {"bulk": (6e9, 13e9)}, (0.1, 0.4), ("B = 1780 MPa", "B = 1280 MPa"))
    assert (
        regimes.data["tears_GPa"][0] == pytest.approx(5.29, abs=5e-3)
        and regimes.figure.axes[1].get_ylim()[1] > 13.0
    )


class TestWearCases:
    def test_asymmetry_is_noticed(self):
        x = np.arange(-4, 5)
        scar = np.maximum(0.0, 9.0 - x[:, None] ** 2 - x**2)
        turned = scar.copy()
        turned[4, 3] += 1e-9
        assert running_in_wear.asymmetry(scar) == 0.0 and running_in_wear.asymmetry(turned) > 1e-11
        assert np.isnan(running_in_wear.asymmetry(0.0 * scar))
        flattened = np.maximum(0.0, 9.0 - 1.001 * x[:, None] ** 2 - x**2)
        assert running_in_wear.asymmetry(flattened) == 0.0
        assert running_in_wear.asymmetry(flattened, turned=True) > 1e-4


def test_limits_need_no_layer():
    assert Limits.of(SCENES[BULK]).first == Limits.of(SCENES[BULK]).removal


def test_a_run_with_a_film_has_its_six_panels_among_its_figures(tmp_path, monkeypatch):
    """And one without has not. Its other figures are drawn, and not written: that is tested with smooth
    bodies.
    """
    save = run.save
    monkeypatch.setattr(
        run, "save", lambda drawing, stem, pdf: save(drawing, stem) if stem.name == "running-in" else []
    )
    for name, scene in (
        ("film", small_patch(counterbody=STEEL)),
        ("none", small_patch(film=None, wear=None)),
    ):
        write_run(sam.solve(scene), scene, tmp_path / name)
        drawn = [path.name for path in run.draw_run(tmp_path / name)]
        assert drawn == ([f"running-in.{kind}" for kind in ("png", "csv")] if name == "film" else [])
