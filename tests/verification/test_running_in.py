# SPDX-License-Identifier: MIT
"""Running-in on made tables: regimes, scenes, measures, statements, rows, both readings. No run is solved."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pandas as pd
import pytest
from made_histories import CYCLES, FORCE, SCENES, as_the_paper_says, history, result_of, verdicts
from made_results import Made, context, red as red_rows
from scipy.integrate import solve_ivp

from sam.scene import Status, load_scene
from verification.cases.running_in import running_in, study
from verification.cases.running_in.running_in import RENEWED, renewed
from verification.compare.running_in_measures import History, Limits, Scar, Spread
from verification.reference import bonded_film

FILM, BODY = (80e9, 0.3, 2e9 / 3), (210e9, 0.3)


def rate_integrated(p: float, mu: float) -> float:
    """Thinning under proportional p and mu p, strain -0.26 p/E: the rate equations of a perfectly plastic
    film.

    Unknown: s = sxx = syy. On the yield surface the deviator n is normal to it; d(strain) = elastic + lambda
    n in xx, and the consistency of the von Mises stress gives ds.
    """
    (young, nu, _), onset = FILM, onset_of_yield(mu)

    def rate(t: float, state: np.ndarray) -> list[float]:
        s, _ = state
        tau = mu * t
        ds = -1.0 - 3.0 * mu * tau / (s + t)  # (s + t)^2 + 3 tau^2 = sy^2, differentiated
        elastic = ((1 - nu) * ds + nu) / young
        return [ds, -2.0 * (-0.26 / BODY[0] - elastic)]  # ezz = -(exx + eyy) of the plastic strain

    start = [onset * elastic_slope(), 0.0]
    return -float(solve_ivp(rate, (onset, p), start, rtol=1e-11, atol=[1.0, 1e-15]).y[1, -1])


def elastic_slope() -> float:
    """sxx/p of the elastic film, Hooke's law with szz = -p and the strain of the body."""
    return (-0.26 * FILM[0] / BODY[0] - 0.3) / 0.7


def onset_of_yield(mu: float) -> float:
    """Pressure at which the elastic film yields: p sqrt((1 + sxx/p)^2 + 3 mu^2) = sy."""
    return FILM[2] / sqrt((1 + elastic_slope()) ** 2 + 3 * mu**2)


class TestRegime:
    @pytest.mark.parametrize("p", [2e9, 3e9, 3.8e9])
    def test_thinning_with_friction_is_that_of_the_rate_equations(self, p):
        """Integrated to 1e-11; 1e-8 leaves room for its steps. A friction of 0.11 is noticed."""
        e = bonded_film.in_plane_strain(p, *BODY)
        assert bonded_film.thinning(p, 0.1, e, FILM) == pytest.approx(rate_integrated(p, 0.1), rel=1e-8)
        assert bonded_film.thinning(p, 0.095, e, FILM) != pytest.approx(rate_integrated(p, 0.1), rel=1e-3)

    def test_film_fails_where_it_thins_by_the_limit_or_has_no_equilibrium(self):
        for mu in (0.0, 0.05, 0.1):
            p = bonded_film.film_pressure(0.0204, mu, FILM, BODY)
            assert bonded_film.thinning(p, mu, bonded_film.in_plane_strain(p, *BODY), FILM) == pytest.approx(
                0.0204, rel=1e-7
            )
        largest = bonded_film.largest_pressure(FILM[2], 0.1)
        assert bonded_film.film_pressure(0.5, 0.1, FILM, BODY) == largest == pytest.approx(3.849e9, rel=1e-4)
        assert bonded_film.thinning(3.85e9, 0.1, -1e-3, FILM) == np.inf

    def test_removal_is_von_mises_of_the_traction_alone(self):
        """sqrt(3) mu p = sigma_y."""
        p = bonded_film.tear_pressure(2.0522895e9, 0.4)
        assert sqrt(3 * (0.4 * p) ** 2) == pytest.approx(2.0522895e9, rel=1e-14)
        assert bonded_film.swift(1780e6, 4, 0.095, 0.0) == pytest.approx(2030.6e6, rel=1e-4)
        assert [bonded_film.regime(each, 3.4e9, 5.3e9) for each in (3e9, 4e9, 6e9)] == list(
            bonded_film.Regime
        )

    @pytest.mark.parametrize(
        ("case", "removal", "softer"),
        [
            (study.BULK, 5.29, 3.80),
            (study.A, 5.27, 3.79),
            (study.B, 2.96, 2.13),
            (study.DUCTILE, 3.23, 2.32),
            (study.HARDENING, 9.87, 7.10),
        ],
    )
    def test_pressures_that_remove_metal_in_the_five_cases(self, case, removal, softer):
        """Three digits, as they are known."""
        limits, other = (
            Limits.of(each) for each in (SCENES[case], study.with_constant(SCENES[case], 1280e6))
        )
        assert (limits.removal / 1e9, other.removal / 1e9) == pytest.approx((removal, softer), abs=5e-3)
        assert limits.film == other.film
        if case == study.BULK:
            assert limits.strength == pytest.approx(bonded_film.swift(1780e6, 4, 0.095, 0.002), rel=1e-12)

    def test_bad_numbers_are_refused_by_name(self):
        for wrong, name in (((-1.0, 0.4), "strength"), ((1e9, 0.0), "friction"), ((np.nan, 0.4), "strength")):
            with pytest.raises(ValueError, match=name):
                bonded_film.tear_pressure(*wrong)


SMALL = study.reduced(SCENES[study.B], study.Effort(3, 2, 8))
(CASE,) = running_in.CASES
TEN = tuple(range(1, 11))
INF = float("inf")
WET = "curve B: the whole surface protected"  # asks for a friction of 0.105 or less


class TestScenes:
    def test_reduced_keeps_the_nominal_pressure_and_the_cells(self):
        scene = study.reduced(SCENES[study.B], study.Effort(3, 4, 16))
        assert scene.grid.extent == pytest.approx((16e-6,) * 2) and scene.grid.cells == (16, 16)
        assert scene.loading.force / np.prod(scene.grid.extent) == pytest.approx(0.6 / 64e-6**2)
        assert (scene.loading.steps, scene.loading.unload_steps, scene.loading.cycles) == (4, 4, 3)
        whole = study.reduced(SCENES[study.B], study.Effort(25, 10, 64))
        assert (
            whole == SCENES[study.B] and study.with_seed(whole, 2) == whole and SMALL.loading.force == FORCE
        )

    def test_the_second_reading_is_that_of_its_file_with_counter_surfaces_of_its_own(self):
        assert renewed(SCENES[study.B]) == load_scene("verification/scenes/running-in-renewed.toml")
        assert renewed(SCENES[study.BULK]).body == SCENES[study.BULK].body
        scenes = [renewed(study.with_seed(SCENES[study.B], seed)) for seed in TEN]
        drawn = [seed for scene in scenes for seed in scene.counterbody.surface.seeds(25)]
        assert len(set(drawn)) == 250 and not set(drawn) & {scene.surface.seed for scene in scenes}
        own, other = (Limits.of(each) for each in (scenes[0], study.with_constant(scenes[0], 1280e6)))
        assert other.removal / own.removal == pytest.approx(1280 / 1780, rel=1e-12)  # that of the layer too


class TestMeasures:
    def test_rates_and_straightness_of_known_curves(self):
        line = history(3.0 * CYCLES + 7.0)
        assert line.rate(10, 25) == pytest.approx(3.0) and line.rate(0, 6) == pytest.approx((18 + 7) / 6)
        assert line.straightness(5, 25) == pytest.approx(1.0, abs=1e-12)
        assert np.isnan(history(np.full(25, 4.0)).straightness(5, 25)) and np.isnan(line.straightness(5, 26))
        assert np.isnan(line.at("volume", 26))

    def test_spread(self):
        assert Spread.of([3.0, 1.0, np.nan, 2.0]) == Spread(2.0, 1.0, 3.0, 3)
        texts = [Spread.of(each).text for each in ([np.nan], [2.0], [1.0, 3.0])]
        assert texts == ["–", "2", "2 (1 to 3)"]

    def test_a_body_is_at_rest_from_its_last_new_strain_on(self):
        for strains, cycle in (([3.0, 2.0, 0.0], 3.0), ([0.0, 0.0], 1.0), ([1.0, 0.0, 1.0, 0.0], 4.0)):
            assert study.at_rest_from(np.array(strains)) == cycle
            assert np.isnan(study.at_rest_from(np.array([*strains, 1.0])))


def made(order: str = "C", **changes) -> study.Run:
    """Three cycles, the friction and the protected area of the last as its surface has them."""
    cycle = np.arange(1.0, 4.0)
    volume, friction, protected = [9.5e-20, 9.5e-20, 1.9e-19], [0.3, 0.28, 0.25], [0.4, 0.45, 0.5]
    columns = cycle, volume, friction, 0 * cycle, protected, 0 * cycle + 1e9
    result = result_of(History(*map(np.array, columns)), order)
    result.tables["cycles"]["new_strain_max"] = np.array([0.01, 0.002, 0.0])
    for name, change in changes.items():
        table = next(table for table in result.tables.values() if name in table)
        table[name] = change(np.array(table[name], dtype=float))
    return study.Run(SMALL, result)


def red(*runs) -> set[str]:
    frame = study.framed({(k,): one for k, one in enumerate(runs)}, ("surface",))
    return red_rows("running-in", CASE.measure(frame), whole=True)


class TestRows:
    def test_surface_is_read_whichever_coordinate_runs_first(self):
        one, other = made().scar, made("F").scar
        for name, values in vars(one).items():
            np.testing.assert_array_equal(values, getattr(other, name))
        assert one.height[1, 0] == 8e-8 and one.height[0, 1] == 1e-8

    def test_sums_of_the_made_surface(self):
        """The volume is that of the unloaded surface, twice that at the peak."""
        scar = made().scar
        assert scar.coefficient(0.1, 0.4) == pytest.approx(0.25) and scar.protected_fraction(0.1, 0.4) == 0.5
        assert scar.force == pytest.approx(FORCE, rel=1e-12)
        assert scar.volume == pytest.approx(19e-20, rel=1e-12, abs=0.0)

    @pytest.mark.parametrize(
        ("column", "change", "wrong"),
        [
            ("sa_m", lambda v: v, set()),
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
        assert red(made("F"), made(**{column: change})) == wrong

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


def told(values) -> dict:
    """What is told of the statement WET with these measures."""
    frame = pd.DataFrame({each.words: values for each in study.STATEMENTS}, dtype=float)
    return next(each for each in study.judged(frame) if each["statement"] == WET)


class TestStatements:
    def test_all_hold_for_histories_as_the_paper_describes_them(self):
        found = verdicts([as_the_paper_says()] * 3)
        assert (
            {each["by_agreement"] for each in found} == {each["by_median"] for each in found} == {study.HELD}
        )
        assert all(each["holds_on"] == 3 for each in found) and len(found) == 17

    @pytest.mark.parametrize(
        ("values", "median", "agreed"),
        [
            (np.arange(1, 11) / 6, study.HELD, study.OPEN),
            (np.arange(11, 21) / 6, study.FAILED, study.FAILED),
            ([1.0] * 5 + [np.nan] * 5, study.OPEN, study.OPEN),
            ([1.0] * 8 + [np.nan] * 2, study.HELD, study.HELD),
            ([0.5] * 5 + [INF] * 5, study.FAILED, study.OPEN),  # infinite ratios count as numbers
            ([0.5] * 7 + [INF] * 3, study.HELD, study.OPEN),
        ],
    )
    def test_the_median_decides_and_what_eight_of_ten_agree_on(self, values, median, agreed):
        one = told(0.105 * np.asarray(values))
        assert (one["by_median"], one["by_agreement"]) == (median, agreed)
        assert one["holds_on"] == sum(value <= 1.0 for value in values)
        row = study.statements_table({"one": [one], "other": [one]}).rows[0]
        assert "nan" not in "".join(row) and row[4:8] == row[8:]


@pytest.fixture
def solved(tmp_path, monkeypatch):
    """A case at the full level. lost: labels of runs that do not converge; shallow: of those whose plastic
    zone reaches the last layer; changed: other histories.
    """

    def solve(case=CASE, lost=(), shallow=(), **changed):
        here, scenes = context(case.name, tmp_path, "full"), {}
        monkeypatch.setattr(study, "campaigns", dict)

        def one(model, scene, label, demand):
            assert not demand
            scenes[label] = scene
            name = max((name for name in study.NAMES if name in label), key=len, default=study.B)
            stopped = Status.STEP_CUT_LIMIT if label in lost else Status.PLASTIC_ZONE_AT_GRID_EDGE
            bad = {"converged": False, "status": stopped} if label in (*lost, *shallow) else {}
            return result_of(changed.get(label, as_the_paper_says()[name]), **bad)

        monkeypatch.setattr(here, "solve", one)
        return case.solve(here), scenes

    return solve


class TestReadings:
    def test_both_readings_stand_side_by_side(self, solved):
        """Each run is another scene under a name of its own."""
        found, scenes = solved()
        assert len(scenes) == len({repr(scene) for scene in scenes.values()}) == len(found) == 100
        assert scenes["curve-b-seed-3"].surface == scenes["renewed-curve-b-seed-3"].surface
        statements, *others = CASE.tables(found)
        assert len(statements.rows) == 17 and len(others) == 3
        assert all(row[5] == row[9] == "10 of 10" for row in statements.rows)
        for table in (statements, *others):
            assert {len(row) for row in table.rows} == {len(table.columns)}, table.caption
        data = CASE.data(found)
        assert [{each["by_median"] for each in of} for of in data["statements"].values()] == [
            {study.HELD}
        ] * 2
        row = next(row for row in running_in.regimes_table(found).rows if row[:2] == (RENEWED, "bulk"))
        assert row[3] == f"{Limits.of(SCENES[study.BULK]).removal / 1e9:.2f}" and row[5] == "5.00"

    def test_runs_that_are_lost_are_named_counted_left_out_and_not_drawn(self, solved, monkeypatch):
        for drawing in ("curves", "six_panels", "yield_profiles"):
            monkeypatch.setattr(running_in, drawing, lambda *_, **__: None)
        lost = {f"renewed-{study.DUCTILE}-seed-2", *(f"renewed-{study.BULK}-seed-{seed}" for seed in TEN)}
        found, _ = solved(lost=lost)
        assert CASE.measure(found)["unconverged"].value == 11
        text = next(note for note in CASE.notes(found) if note.startswith("Not converged"))
        assert text.count("step-cut-limit") == 11 and "curve B, 5 %, surface 2, renewed" in text
        rows = {row[1]: row for row in next(iter(CASE.tables(found))).rows}
        assert rows["bulk: worn in the first six cycles"][9:] == [
            "0 of 10, none on 10",
            study.OPEN,
            study.OPEN,
        ]
        names = [
            "readings",
            "yield",
            *study.NAMES,
            *(f"{RENEWED}-{name}" for name in study.NAMES if name != study.BULK),
        ]
        plots = {plot.name: plot.caption for plot in CASE.figures(found)}
        assert list(plots) == names and "on our surface 1 alone" in plots[f"renewed-{study.DUCTILE}"]
        assert {view.name: view.run for view in CASE.views(found)}[f"{study.A}-worn"] == f"{study.A}-seed-2"
