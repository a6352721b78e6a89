# SPDX-License-Identifier: MIT
"""Running-in: its scenes, measures and statements on made tables, rows on wrong ones, both readings as a
whole. No run is solved but one for its figure.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import STEEL, running_in as small_patch
from made_histories import CYCLES, as_the_paper_says, history
from made_results import Made, context, red as red_rows

import sam
from sam.scene import Status, load_scene
from verification.cases.case import with_grid, with_keys
from verification.cases.running_in import running_in, running_in_wear
from verification.cases.running_in.scenes import (
    BULK,
    DUCTILE,
    HARDENING,
    NAMES,
    A,
    B,
    Effort,
    Reading,
    reduced,
    renewed,
    with_deviation,
    with_plasticity,
    with_seed,
)
from verification.cases.running_in.study import (
    INF,
    STATEMENTS,
    Judged,
    Judgement,
    Statement,
    judged,
    statements_table,
)
from verification.compare.running_in_measures import Limits, Scar, Spread
from verification.figures import run
from verification.figures.lines import over_cycles
from verification.figures.running_in import regime_map, six_panels
from verification.runs.files import write_run

SCENES = {case: load_scene(f"verification/scenes/running-in-{case}.toml") for case in (*NAMES, "curve-c")}
SMALL = reduced(SCENES[B], Effort(3, 2, 8))
CASE = running_in.CASES[0]
TEN = tuple(range(1, 11))
N = 8


class TestScenes:
    def test_five_cases_differ_in_the_layer_and_its_limit_only(self):
        def rest(scene):
            scene = with_plasticity(scene, profile=None, layer_thickness=None)
            return with_keys(scene, "wear", strain_limit_layer=None).model_copy(update={"title": ""})

        assert all(rest(scene) == rest(SCENES[BULK]) for scene in SCENES.values())
        limits = {case: scene.wear.strain_limit_layer for case, scene in SCENES.items()}
        assert limits == dict.fromkeys(SCENES, 0.02) | {BULK: None, DUCTILE: 0.05}
        film = SCENES[BULK].friction
        assert (film.growth, film.thinning_limit) == pytest.approx((2.0415e-9, 0.020415), rel=1e-4)

    def test_layers_resolve_the_curves(self):
        """Between the knots of a curve, to 1 um, lie the centres of a layer or more."""
        for case in (A, B, "curve-c", HARDENING):
            faces = np.array(SCENES[case].grid.depths)
            centres = 0.5 * (faces[1:] + faces[:-1])
            knots = [z for z, _ in SCENES[case].body.plasticity.profile]
            assert all(((low < centres) & (centres < high)).any() for low, high in pairwise(knots))

    def test_reduced_keeps_the_nominal_pressure_and_the_cells(self):
        scene = reduced(SCENES[B], Effort(3, 4, 16))
        assert scene.grid.extent == pytest.approx((16e-6,) * 2) and scene.grid.cells == (16, 16)
        assert scene.loading.force / np.prod(scene.grid.extent) == pytest.approx(0.6 / 64e-6**2)
        assert (scene.loading.steps, scene.loading.unload_steps, scene.loading.cycles) == (4, 4, 3)
        whole = reduced(SCENES[B], Effort(25, 10, 64))
        assert whole == SCENES[B] and with_seed(whole, 2) == whole and with_seed(whole, 3) != whole

    def test_deviation_leaves_the_bulk_alone(self):
        z = np.array([0.0, 0.2e-6, 0.7e-6, 5e-6])
        scenes = SCENES[B], with_deviation(SCENES[B], 1.25)
        before, after = (scene.body.plasticity.depth_profile()(z) for scene in scenes)
        assert after - 1 == pytest.approx(1.25 * (before - 1), abs=1e-15) and after[-1] == 1.0

    def test_what_is_varied_differs_from_what_is_given(self):
        labels, scenes = zip(*running_in.varied_scenes(SCENES, SCENES["curve-c"]).values(), strict=True)
        assert len(set(labels)) == len({repr(scene) for scene in scenes}) == len(scenes)
        assert all(scene not in [SCENES[name] for name in NAMES] for scene in scenes)

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
        scenes = [renewed(with_seed(SCENES[B], seed)) for seed in TEN]
        drawn = [seed for scene in scenes for seed in scene.counterbody.surface.seeds(25)]
        assert len(set(drawn)) == 250 and not set(drawn) & {scene.surface.seed for scene in scenes}

    def test_the_other_constant_is_that_of_the_layer_too(self):
        own, other = running_in.limits_of(renewed(SCENES[B]))
        assert other.removal / own.removal == pytest.approx(1280 / 1780, rel=1e-12)


class TestMeasures:
    def test_rates_and_straightness_of_known_curves(self):
        line = history(3.0 * CYCLES + 7.0)
        assert line.rate(10, 25) == pytest.approx(3.0) and line.rate(0, 6) == pytest.approx((18 + 7) / 6)
        assert line.straightness(5, 25) == pytest.approx(1.0, abs=1e-12)
        assert np.isnan(history(np.full(25, 4.0)).straightness(5, 25)) and np.isnan(line.straightness(5, 26))
        assert history(1.0 - np.exp(-CYCLES / 2.0)).straightness(5, 25) < 0.6
        assert np.isnan(line.at("volume", 26))

    def test_straightness_is_that_of_a_least_squares_line(self):
        v = np.cumsum(np.random.default_rng(3).uniform(size=25))
        x, y = CYCLES[4:], v[4:]
        rest = y - np.polyval(np.polyfit(x, y, 1), x)
        assert history(v).straightness(5, 25) == pytest.approx(1 - rest.var() / y.var(), rel=1e-10)

    def test_spread(self):
        assert Spread.of([3.0, 1.0, np.nan, 2.0]) == Spread(2.0, 1.0, 3.0, 3, 1.0)
        texts = [Spread.of(each).text() for each in ([np.nan], [2.0], [1.0, 3.0])]
        assert texts == ["–", "2", "2 (1 to 3)"]

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

    @pytest.mark.parametrize(
        ("strains", "cycle"), [([3.0, 2.0, 0.0], 3.0), ([0.0, 0.0], 1.0), ([1.0, 0.0, 1.0, 0.0], 4.0)]
    )
    def test_a_body_is_at_rest_from_its_last_new_strain_on(self, strains, cycle):
        assert running_in.at_rest_from(np.array(strains)) == cycle
        assert np.isnan(running_in.at_rest_from(np.array([*strains, 1.0])))

    def test_the_deepest_scar_is_set_against_the_relief(self):
        flat, height = np.zeros((2, 2)), np.array([[1e-6, 0.0], [-1.5e-6, 0.5e-6]])
        scars = {
            name: Scar(np.arange(2.0), np.arange(2.0), height, flat, depth * np.eye(2), flat)
            for name, depth in (("shallow", 1e-6), ("half", 1.5e-6), ("deep", 2.75e-6))
        }
        text = running_in.lost_height_note(scars)
        assert "a half in 2 of 3 runs, above one in 1; the most is 1.10, 2.75 of 2.5 µm (deep)" in text


def made(order: str = "C", **changes) -> running_in.Run:
    """Eight by eight cells, three cycles; half of the load on failed film. order: how rows run, y first or x
    first.
    """
    x, p = (np.arange(N) - 3.5) * 1e-6, np.zeros((N, N))
    p[2:4, 2:6] = SMALL.loading.force / 8 / 1e-12
    mu = np.where(p > 0, 0.1, np.nan)
    mu[3, 2:6] = 0.4
    worn = np.where(p > 0, 2e-8, 0.0)
    worn[2, 2] = 5e-8
    places = {"x_m": x[:, None] + 0 * p, "y_m": x + 0 * p, "height_m": 1e-8 * np.arange(64.0).reshape(N, N)}
    peak = places | {"p_Pa": p, "worn_m": 0.5 * worn, "friction": mu}
    unloaded = places | {"p_Pa": 0.0 * p, "worn_m": worn, "friction": np.full_like(p, np.nan)}
    surface = {"state": ["peak"] * 64 + ["unloaded"] * 64}
    surface |= {name: np.concatenate([each[name].ravel(order) for each in (peak, unloaded)]) for name in peak}
    volume = (7 * 2e-8 + 5e-8) * 1e-12
    rows = {
        "cycle": [1, 2, 3],
        "wear_volume_m3": [0.5 * volume, 0.5 * volume, volume],
        "friction_coefficient": [0.3, 0.28, 0.25],
        **{
            name: [value] * 3
            for name, value in (("sa_m", 2e-7), ("sq_m", 3e-7), ("ssk", 0.1), ("peeq_max", 0.01))
        },
        "protected_fraction": [0.4, 0.45, 0.5],
        "p_max_Pa": [p.max()] * 3,
        "new_strain_max": [0.01, 0.002, 0.0],
        "yielding_cells": [9, 4, 0],
        "wear_of_cycle_m3": [0.5 * volume, 0.0, 0.5 * volume],
    }
    steps = {"cycle": np.repeat([1, 2, 3], 2), "iterations": np.array([4, 2, 3, 2, 2, 1])}
    for name, change in changes.items():
        table = next(table for table in (rows, surface, steps) if name in table)
        table[name] = change(np.array(table[name], dtype=float))
    return running_in.Run(SMALL, Made(tables={"cycles": rows, "surface": surface, "history": steps}))


def red(*runs) -> set[str]:
    return red_rows("running-in", running_in.measured(runs), whole=True)


class TestRows:
    def test_surface_is_read_whichever_coordinate_runs_first(self):
        one, other = made().scar, made("F").scar
        assert all(
            np.array_equal(values, getattr(other, k), equal_nan=True) for k, values in vars(one).items()
        )
        assert one.height[1, 0] == 8e-8 and one.height[0, 1] == 1e-8

    def test_sums_of_the_made_surface(self):
        """The volume is that of the unloaded surface, twice that at the peak."""
        scar = made().scar
        assert scar.coefficient(0.1, 0.4) == pytest.approx(0.25) and scar.protected_fraction(0.1, 0.4) == 0.5
        assert scar.force == pytest.approx(SMALL.loading.force, rel=1e-12)
        assert scar.volume == pytest.approx(19e-20, rel=1e-12, abs=0.0)

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
        lost = replace(made(), result=Made(converged=False, status="not-converged"))
        assert red(made(), lost) == {"unconverged"}
        assert {"unconverged", "volume", "load"} <= red(lost)

    def test_cells_that_are_missing_are_an_error(self):
        surface = made().result.tables["surface"]
        short = {name: [*values[:63], *values[64:]] for name, values in surface.items()}
        with pytest.raises(ValueError, match="63 rows"):
            Scar.of({"surface": short})


def of_friction(low, high) -> Statement:
    """Asks for the friction of curve B after the last cycle."""
    return Statement("0", "friction", "μ", low, high, lambda h: h[B].at("friction", 25))


def on(statement, frictions) -> Judged:
    return Judged(statement, tuple(statement.on({B: history(CYCLES, each)}) for each in frictions))


class TestStatements:
    def test_all_hold_for_histories_as_the_paper_describes_them(self):
        found = judged([as_the_paper_says()] * 10)
        assert [one.statement.words for one in found if one.agreed is not Judgement.HELD] == []
        assert all(one.agreeing == 10 for one in found) and len(found) == 17

    @pytest.mark.parametrize(
        ("case", "wrong", "failing"),
        [
            (
                BULK,
                lambda h: replace(h, volume=h.cycle * 1e-19),
                ("worn in the first six", "hardly any wear later"),
            ),
            (
                BULK,
                lambda h: replace(h, friction=h.friction - 0.06),
                ("stays high", "below that of bulk", "below bulk"),
            ),
            (A, lambda h: replace(h, volume=0 * h.volume), ("curve A: wears linearly",)),
            (
                B,
                lambda h: replace(h, friction=h.friction + 0.1),
                ("whole surface protected", "B below A and hardening"),
            ),
            (B, lambda h: replace(h, sa=2 * h.sa), ("roughness falls more",)),
            (HARDENING, lambda h: replace(h, volume=3 * h.volume), ("as much as bulk",)),
        ],
    )
    def test_other_histories_fail_the_statement(self, case, wrong, failing):
        changed = as_the_paper_says()
        changed[case] = wrong(changed[case])
        failed = [one.statement.words for one in judged([changed] * 5) if one.agreed is Judgement.FAILED]
        assert all(any(words in statement for statement in failed) for words in failing)

    def test_surfaces_that_disagree_decide_nothing(self):
        wet = next(k for k, s in enumerate(STATEMENTS) if "whole surface protected" in s.words)
        good, bad = as_the_paper_says(), as_the_paper_says()
        bad[B] = replace(bad[B], friction=bad[B].friction + 0.2)
        verdicts = [judged([bad] * k + [good] * (5 - k))[wet].agreed for k in range(6)]
        assert verdicts == [Judgement.HELD] * 2 + [Judgement.OPEN] * 2 + [Judgement.FAILED] * 2
        silent = judged([{}] * 5), judged([good, good, good, {}, {}]), judged([])
        assert all(each[wet].agreed is Judgement.OPEN for each in silent)

    def test_nothing_worn_says_nothing_of_when(self):
        none = as_the_paper_says()
        none[BULK] = replace(none[BULK], volume=0 * none[BULK].volume)
        first = judged([none] * 5)[0]
        assert first.agreed is Judgement.OPEN and np.isnan(first.values).all()

    def test_the_median_decides_with_what_the_surfaces_scatter(self):
        """Values 1 to 10 have the hinges 3 and 8; five of ten say nothing: nor does the median."""
        one = on(of_friction(-INF, 6.0), range(1, 11))
        assert (one.agreeing, one.agreed, one.by_median) == (6, Judgement.OPEN, Judgement.HELD)
        assert one.spread.interquartile == 5.0 and one.margin == pytest.approx(0.1) and one.is_close
        far = on(of_friction(12.0, INF), range(1, 11))
        assert far.by_median is far.agreed is Judgement.FAILED
        assert far.margin == pytest.approx(1.3) and not far.is_close
        silent = on(of_friction(-INF, 6.0), [1.0] * 5 + [np.nan] * 5)
        assert silent.by_median is Judgement.OPEN and not silent.is_close

    @pytest.mark.parametrize(
        ("values", "margin"),
        [
            ([2.0] * 10, INF),
            ([5.0] * 10, 0.0),
            ([INF] * 10, INF),
            ([1.0] * 5 + [INF] * 5, INF),
            ([1.0] * 7 + [INF] * 3, 0.0),
        ],
    )
    def test_values_without_scatter_and_without_bound(self, values, margin):
        """Infinite ratios count as numbers: they fail what is asked to be small."""
        one = on(of_friction(-INF, 5.0), values)
        assert one.margin == margin
        assert one.agreeing == sum(value <= 5.0 for value in values)
        assert "nan" not in "".join(statements_table({"one": [one]}).rows[0])

    def test_runs_that_are_missing_are_surfaces_that_say_nothing(self):
        statement = of_friction(-INF, 5.0)
        one = Judged(statement, (*on(statement, [1.0] * 8).values, statement.on({}), statement.on({})))
        assert one.agreed is one.by_median is Judgement.HELD
        row = statements_table({"one": [one], "other": [one]}).rows[0]
        assert row[5] == row[9] == "8 of 10, none on 2"
        assert row[6] == "held" and row[4] == "1 (1 to 1)"
        assert (one.data["holds_on"], one.data["of"], one.data["none_on"]) == (8, 10, 2)


def answer(case: str, **changes) -> Made:
    """The result of a run that went as the paper says, and at last strains no more."""
    own, result = as_the_paper_says()[case], made().result
    cycles = {
        "cycle": own.cycle,
        "wear_volume_m3": own.volume,
        "friction_coefficient": own.friction,
        "sa_m": own.sa,
        "protected_fraction": own.protected,
        "p_max_Pa": own.p_max,
        "new_strain_max": np.linspace(0.02, 0.0, CYCLES.size),
        "yielding_cells": CYCLES[::-1] - 1,
        "wear_of_cycle_m3": np.diff(own.volume, prepend=0.0),
    }
    steps = {"cycle": CYCLES, "iterations": CYCLES[::-1]}
    return replace(result, tables={**result.tables, "cycles": cycles, "history": steps}, **changes)


@pytest.fixture
def solved(tmp_path, monkeypatch):
    """The case at the full level. lost: labels of runs that do not converge; shallow: of those whose plastic
    zone reaches the last layer.
    """

    def solve(lost=(), shallow=()):
        here, scenes = context("running-in", tmp_path, "full"), {}

        def one(model, scene, label, demand):
            assert not demand
            scenes[label] = scene
            case = max((name for name in NAMES if name in label), key=len, default=B)
            stopped = Status.STEP_CUT_LIMIT if label in lost else Status.PLASTIC_ZONE_AT_GRID_EDGE
            bad = {"converged": False, "status": stopped} if label in (*lost, *shallow) else {}
            return answer(case, cost={"cpu_s": 2.0, "solve_s": 50.0}, **bad)

        monkeypatch.setattr(here, "solve", one)
        return CASE.solve(here), scenes

    return solve


class TestReadings:
    def test_each_scene_is_solved_under_a_name_of_its_own(self, solved):
        found, scenes = solved()
        assert len(scenes) == 108 and len({repr(scene) for scene in scenes.values()}) == 108
        assert scenes["curve-b-seed-3"].surface == scenes["renewed-curve-b-seed-3"].surface
        assert scenes["curve-b-seed-3"].surface.seed == 3
        assert scenes["renewed-curve-b-seed-3"].counterbody.surface.seed == 3001
        assert list(found.efforts) == list(Reading) and (len(found.runs), len(found.varied)) == (100, 8)

    def test_both_readings_stand_side_by_side(self, solved):
        found, _ = solved()
        statements, *others = CASE.tables(found)
        assert len(statements.rows) == 17
        assert {row[6] for row in statements.rows} == {row[10] for row in statements.rows}
        assert all(row[5] == row[9] == "10 of 10" for row in statements.rows)
        for table in (statements, *others):
            assert {len(row) for row in table.rows} == {len(table.columns)}, table.caption
        new_strain = next(table for table in others if table.caption.startswith("What the last cycle adds"))
        assert all(row[1:3] == row[6:8] == ["0 of 10", "25 (25 to 25)"] for row in new_strain.rows)
        words = [value for _, value in CASE.setup(found)]
        assert "13 layers" in " ".join(words) and "15 layers, to 19.4 µm" in words
        said = CASE.data(found)["statements"]
        assert [{each["by_median"] for each in of} for of in said.values()] == [{"held"}, {"held"}]
        cost = others[-1].rows[0]
        assert cost[1:4] == ("10 of 10", "2 (2 to 2)", "2 (2 to 2)")
        assert cost[6:8] == ("23 (23 to 23)", "10.5 (10.5 to 10.5)")

    def test_pages_are_given_numbers(self, solved):
        data = CASE.data(solved({"curve-b-seed-4"})[0])
        first, *_ = data["statements"]["printed inputs"]
        assert first["holds_on"] == 10 and first["by_median"] == "held" and len(first["values"]) == 10
        assert [each["none_on"] for each in data["statements"]["printed inputs"]].count(1) == 7
        bulk = data["regimes"]["renewed"]["bulk"]
        assert bulk["reached"] == 5e9 and bulk["removed_from"] == Limits.of(SCENES[BULK]).removal
        assert data["last_cycle"]["renewed"]["curve A"]["rest_from"] == [25.0] * 10

    def test_where_the_plastic_zone_reaches_the_last_layer_there_are_more(self, solved):
        found, scenes = solved(shallow={"bulk-seed-7", "renewed-bulk-seed-7", "renewed-bulk-seed-7-deeper"})
        printed, other = (found.runs[reading, BULK, 7] for reading in Reading)
        assert printed.scene == scenes["bulk-seed-7-deeper"] and printed.scene.grid.depths[-1] == 19.4e-6
        assert printed.scene.grid.depths[:-2] == scenes["bulk-seed-7"].grid.depths
        assert other.scene.grid.depths[-1] == 36.2e-6 and len(scenes) == 110
        notes = " ".join(CASE.notes(found))
        assert "bulk, surface 7, printed inputs, to 19.4 µm" in notes
        assert "bulk, surface 7, renewed: plastic-zone-at-grid-edge after 25 cycles." in notes

    def test_runs_that_are_lost_are_named_counted_and_left_out(self, solved):
        lost = {"renewed-curve-a-seed-4", *(f"renewed-bulk-seed-{seed}" for seed in TEN)}
        found, _ = solved(lost)
        assert CASE.measure(found)["unconverged"].value == 11
        text = next(note for note in CASE.notes(found) if note.startswith("Not converged"))
        assert text.count("step-cut-limit") == 11 and "curve A, surface 4, renewed" in text
        statements, *others = CASE.tables(found)
        rows = {row[1]: row for row in statements.rows}
        assert rows["curve A: friction falls"][5::4] == ["10 of 10", "9 of 10, none on 1"]
        assert rows["bulk: worn in the first six cycles"][9:] == ["0 of 10, none on 10", *["not decided"] * 2]
        cost = {row[0]: row[1] for row in others[-1].rows}
        names = "bulk, printed inputs", "bulk, renewed", "curve A, renewed"
        assert [cost[name] for name in names] == ["10 of 10", "0 of 10", "9 of 10"]

    def test_every_case_is_drawn_in_both_readings(self, solved, monkeypatch):
        """Without bulk in the second, which is lost. What a drawing holds is tested with the figures."""
        for drawing in ("over_cycles", "regime_map", "six_panels", "yield_profiles"):
            monkeypatch.setattr(running_in, drawing, lambda *_, **__: None)
        found, _ = solved({f"renewed-{BULK}-seed-{seed}" for seed in TEN} | {f"renewed-{DUCTILE}-seed-2"})
        names = [plot.name for plot in CASE.figures(found)]
        printed = ["yield", "regimes", *NAMES]
        assert names == [
            "readings",
            *printed,
            *(f"renewed-{name}" for name in printed if name != BULK),
        ]
        views = {view.name: view.run for view in CASE.views(found)}
        assert views[f"{A}-worn"] == f"{A}-seed-2" and views[f"renewed-{B}-worn"] == f"renewed-{B}-seed-2"
        assert views[f"renewed-{DUCTILE}-worn"] == f"renewed-{DUCTILE}-seed-1"

    def test_cells_that_hold_beyond_what_tears_are_counted(self, solved):
        """Of eight equal cells in contact four have failed, under 5/128 N on 1 um2."""
        found, _ = solved()
        counts = {
            case: (own["held_above"], own["failed"])
            for case, own in running_in.regimes(found, Reading.PRINTED).items()
        }
        assert counts == {
            case: (40 * (Limits.of(SCENES[case]).first < made().scar.p.max()), 40) for case in NAMES
        }

    def test_fates_follow_from_the_pressures(self):
        bulk, own = Limits.of(SCENES[BULK]), Limits.of(SCENES[B])
        assert "every spot" in running_in.fate(own.removal, own.film, 5e9)
        assert running_in.fate(own.removal, own.film, np.nan) == "no run converged"
        words = [running_in.fate(bulk.removal, bulk.film, reached) for reached in (3e9, 5e9, 6e9)]
        assert "no film fails" in words[0] and "removes nothing" in words[1] and "5.29" in words[2]
        assert bulk.first == bulk.removal  # without a layer


class TestFigures:
    def test_readings_share_a_panel_for_each_case(self):
        """Curve A worn in two readings, curve B lost in the second."""
        paper = as_the_paper_says()
        worn = [replace(paper[A], volume=k * paper[A].volume) for k in (1, 2, 4)]
        cases = {"curve A": {"one": worn, "other": [paper[A]]}, "curve B": {"one": [paper[B]], "other": []}}
        drawing = running_in.readings_plot(cases).drawing
        data = {name: np.array(values) for name, values in drawing.data.items()}
        rows = (data["quantity"] == "wear volume [µm³]") & (data["panel"] == "curve A")
        median = data["value"][rows & (data["surface"] == "median") & (data["reading"] == "one")]
        assert median == pytest.approx(2e18 * paper[A].volume)
        assert data["value"].size == 3 * CYCLES.size * (4 + 2 + 2)
        assert [len(axes.lines) for axes in drawing.figure.axes] == 3 * [6, 2]
        assert [text.get_text() for text in drawing.figure.legends[0].get_texts()] == ["one", "other"]

    def test_lines_of_two_names_have_colours_and_dashes(self):
        lines = {(one, two): np.arange(3.0) for one in "ab" for two in ("x", "y")}
        drawing = over_cycles({("V", "first, second and more"): lines}, ("one", "two"))
        (panel,), names = drawing.figure.axes, drawing.figure.legends[0].get_texts()
        assert [text.get_text() for text in names] == ["a", "b", "x", "y"]
        assert len({(line.get_color(), line.get_linestyle()) for line in panel.lines}) == 4
        assert panel.get_title() == "first,\nsecond and more" and drawing.data["cycle"][:3] == [0, 1, 2]

    def test_panels_and_regimes_hold_the_numbers_that_they_show(self):
        one = made()
        drawing = six_panels(one.scar, one.history, (0.1, 0.4))
        volume = np.nansum(drawing.data["worn_m"]) * 1e-12
        assert len(drawing.figure.axes) >= 6
        assert volume == pytest.approx(one.history.volume[-1], rel=1e-12, abs=0.0)
        limits = {NAMES[case]: running_in.limits_of(SCENES[case]) for case in NAMES}
        regimes = regime_map(limits, {"bulk": (6e9, 13e9)}, (0.1, 0.4), ("B = 1780 MPa", "B = 1280 MPa"))
        assert regimes.data["tears_GPa"][0] == pytest.approx(5.29, abs=5e-3)
        assert regimes.figure.axes[1].get_ylim()[1] > 13.0

    def test_a_run_with_a_film_has_its_six_panels_among_its_figures(self, tmp_path, monkeypatch):
        """And one without has not. Its other figures are drawn, and not written: that is tested with smooth
        bodies.
        """
        save = run.save
        own = lambda drawing, stem, pdf: save(drawing, stem) if stem.name == "running-in" else []  # noqa: E731
        monkeypatch.setattr(run, "save", own)
        for name, keys in (("film", {"counterbody": STEEL}), ("none", {"film": None, "wear": None})):
            scene = small_patch(**keys)
            write_run(sam.solve(scene), scene, tmp_path / name)
            drawn = [path.name for path in run.draw_run(tmp_path / name)]
            assert drawn == ([f"running-in.{kind}" for kind in ("png", "csv")] if name == "film" else [])
