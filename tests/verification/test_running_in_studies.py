# SPDX-License-Identifier: MIT
"""The studies of running-in over inputs, physics, cells and back-stresses, and on a way, on made results: no
run of them is solved.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_histories import as_the_paper_says
from made_results import Made, context, red
from made_studies import GOOD, over_inputs, over_physics, ran

from sam.scene import GridFields, Plasticity, Result, Scene, Status, load_scene, resolved
from verification.cases import all_cases
from verification.cases.cyclic import running_in_kinematic as kinematic
from verification.cases.running_in import (
    running_in_cells as cells_study,
    running_in_converged as converged,
    running_in_physics as physics_study,
    running_in_sensitivity as inputs_study,
)
from verification.cases.running_in.running_in_converged import CELLS, COARSEST, DEFAULT, FINEST, SEEDS, Member
from verification.cases.running_in.running_in_physics import ALL
from verification.cases.running_in.running_in_sensitivity import (
    INPUTS,
    PRINTED,
    Studied,
    deciders,
    scene_at,
    wilson,
)
from verification.cases.running_in.running_in_way import OnWay
from verification.cases.running_in.scenes import (
    BULK,
    DUCTILE,
    LAST,
    MODULI,
    NAMES,
    RECOVERY,
    SHARES,
    A,
    B,
    hardened,
    swift,
    with_constant,
)
from verification.cases.running_in.study import STATEMENTS, Run
from verification.figures.check import findings
from verification.sensitivity import UNIFORM, design
from verification.surrogate import Surrogate

SCENES = {case: load_scene(f"verification/scenes/running-in-{case}.toml") for case in NAMES}
OF_THE_LAYER = {"depth", "deviation", "hardening", "layer-limit"}


def readable(case, found) -> list:
    """The tables of a case, each row of which has a cell for each column; its figures can be read."""
    tables = list(case.tables(found))
    assert all(len(row) == len(table.columns) for table in tables for row in table.rows)
    assert all(list(findings(plot.drawing.figure)) == [] for plot in case.figures(found))
    return tables


class TestInputs:
    CASE = inputs_study.CASES[0]

    @pytest.fixture
    def found(self) -> Studied:
        return over_inputs(SCENES)

    @pytest.mark.parametrize("name", [one.name for one in INPUTS])
    def test_an_input_changes_the_scenes_that_it_is_about_and_no_others(self, name):
        """Each of the others is in the middle of its range."""
        for case in (BULK, A):
            shares = ([end if one.name == name else 0.5 for one in INPUTS] for end in (0.05, 0.95))
            low, high = (resolved(scene_at(SCENES[case], each, 7)) for each in shares)
            assert (low != high) == (case == A or name not in OF_THE_LAYER)

    def test_the_limit_of_the_ductile_layer_stays_its_multiple(self):
        middle = [0.5] * len(INPUTS)
        limits = [scene_at(SCENES[case], middle, 7).wear.strain_limit_layer for case in (A, DUCTILE)]
        assert limits[1] == pytest.approx(2.5 * limits[0], rel=1e-12)

    def test_points_have_surfaces_of_their_own_and_all_materials_of_a_point_the_same(self, tmp_path):
        seeds = {}
        for (point, _), scene in self.CASE.scenes(context(self.CASE.name, tmp_path)).items():
            seeds.setdefault(point, set()).add(scene.surface.seed)
        assert all(len(own) == 1 for own in seeds.values())
        assert len(set.union(*seeds.values())) == len(seeds)

    @pytest.mark.parametrize("case", [BULK, A])
    def test_the_printed_inputs_are_those_of_the_scenes(self, case):
        own = resolved(SCENES[case])
        again = resolved(scene_at(SCENES[case], PRINTED, own["surface"]["seed"]))
        layer = again["body"]["plasticity"].pop("layer", None)
        own["body"]["plasticity"].pop("layer", None)
        assert again == _close(own)
        assert layer is None or layer["alpha"] == pytest.approx(own["body"]["plasticity"]["alpha"], rel=1e-12)

    def test_the_deciding_input_is_found(self, found):
        decided = [row for row in found.held if len(set(row[np.isfinite(row)])) > 1]
        assert len(decided) >= 10
        for row in decided:
            first, second = deciders(found.shares, row)[:2]
            low, high = first.bounds
            assert first.input.name == "deviation" and first.acts
            assert low < first.change <= high and low > 0.5
            assert abs(second.change) < 0.45
        assert next(iter(found.decided_by)) == "deviation"
        _, correlations = inputs_study.response(found, A, "worn volume [µm³]")
        assert INPUTS[np.abs(correlations).argmax()].name == "deviation"

    def test_chance_names_no_input(self):
        """64 points, as many statements that no input decides: one of a thousand changes is beyond chance."""
        shares = design(UNIFORM, len(INPUTS), 64, 1)
        held = np.random.default_rng(1).integers(0, 2, (25, 64)).astype(float)
        every = [each for row in held for each in deciders(shares, row)]
        assert len(every) == 25 * len(INPUTS) and sum(each.acts for each in every) <= 2
        assert sum(not each.bounds[0] <= 0.0 <= each.bounds[1] for each in every) >= 20

    def test_a_change_within_chance_acts_only_where_a_believed_fit_names_the_input(self):
        """Of 16 points in each half it holds at 11 and at 5: beyond the bounds of 90 %, not of 99.9 %."""
        shares = np.full((32, len(INPUTS)), 0.4)
        shares[:16, 3] = 0.6
        held = np.r_[np.ones(11), np.zeros(5), np.ones(5), np.zeros(11)]
        moves = 0.6 * np.eye(len(INPUTS))[3]
        for predicted, parts, acts in ((0.6, moves, True), (0.4, moves, False), (0.6, 0.0 * moves, False)):
            (found,) = deciders(shares, held, Surrogate(predicted, parts, np.sign(parts)))
            assert found.input is INPUTS[3] and found.acts == acts and found.bounds[0] > 0.0
        assert not deciders(shares, held)[0].acts

    @pytest.mark.parametrize("points", [32, 64, 128])
    def test_what_a_study_resolves_is_what_acts_in_it(self, points):
        half = points // 2
        halves = np.column_stack([np.repeat([0.0, 1.0], half)] * len(INPUTS))

        def acts(change):
            held = [np.arange(half) < round(half * (0.5 + sign * change / 2)) for sign in (-1, 1)]
            return deciders(halves, np.concatenate(held).astype(float))[0].acts

        least, step = inputs_study.least_change(points), 2 / half
        assert not acts(least - step) and acts(least + step)

    def test_a_lost_run_says_nothing_and_turns_the_row_red(self, found):
        assert red(self.CASE.name, self.CASE.measure(found), whole=True) == set()
        for point in range(11):
            found.runs[point, A].result.converged = False
        found = replace(found)
        assert red(self.CASE.name, self.CASE.measure(found)) == {"lost"}
        of_curve_a = [
            np.isnan(each.on({k: v for k, v in as_the_paper_says().items() if k != A})) for each in STATEMENTS
        ]
        assert np.isnan(found.held[:, :11]).all(axis=1).tolist() == of_curve_a and sum(of_curve_a) == 7
        del found.runs[3, BULK]
        assert "missing" in red(self.CASE.name, self.CASE.measure(found))

    def test_tables_and_figures_can_be_read(self, found):
        tables = readable(self.CASE, found)
        statements = next(table for table in tables if table.caption.startswith("Probability"))
        assert len(statements.rows) == len(STATEMENTS)
        assert sum("deviation of the layer" in row[4] for row in statements.rows) >= 10
        said = self.CASE.data(found)["statements"]
        assert [f"{each['holds']} of {each['of']}" for each in said] == [row[2] for row in statements.rows]
        fewer = replace(found, effort=replace(found.effort, cycles=LAST - 1))
        assert len(list(self.CASE.tables(fewer))) == 2 and list(self.CASE.figures(fewer)) == []
        assert self.CASE.data(fewer) == {}

    def test_bounds_of_a_probability(self):
        """The ends solve (p - k/n)^2 = z^2 p (1 - p)/n, with z = 1.6449 for 90 %: Wilson (1927)."""
        low, high = wilson(81, 263)
        for end in (low, high):
            assert (end - 81 / 263) ** 2 == pytest.approx(1.644854**2 * end * (1.0 - end) / 263, rel=1e-5)
        assert low < 81 / 263 < high
        assert wilson(0, 20)[0] == 0.0 and wilson(0, 0) == (0.0, 1.0)


def fitted(shares, scenes=SCENES) -> Studied:
    """Points that are as the paper says: the statements hold at all of them."""
    runs = {
        (k, case): SimpleNamespace(**vars(ran(as_the_paper_says()[case])), scene=scene_at(scene, own, 7))
        for k, own in enumerate(shares)
        for case, scene in scenes.items()
    }
    return Studied(inputs_study.EFFORTS["full"][1], np.array(shares), runs, 1.0, SCENES)


class TestFitted:
    def test_the_nearest_of_the_best_points_comes_first(self):
        away = PRINTED + np.where(PRINTED < 0.5, 0.4, -0.4)
        found = fitted([away, PRINTED, 0.9 * PRINTED + 0.1 * away])
        assert found.away == pytest.approx([0.4, 0.0, 0.04]) and found.best == [1, 2, 0]
        for case in NAMES:
            found.runs[1, case].result.converged = False
        found = replace(found)
        assert found.best == [2, 0]
        table = inputs_study.fitted_table(found)
        assert table.columns == ("input", "printed inputs", "point 2: 17 hold", "point 0: 17 hold")
        assert all(len(row) == len(table.columns) for row in table.rows)
        assert {name: value for name, value, *_ in table.rows}["B of Swift's law [MPa]"] == "1.78e+03"

    def test_hardness_is_that_of_the_law_at_a_strain_of_8_percent(self):
        """1780 MPa (4 + 80000)^0.095 = 5.203 GPa, of curve A at the surface 0.8 of that."""
        bulk = inputs_study.hardness(SCENES[BULK])
        assert bulk == pytest.approx((2.8 * 5.2029e9, 3.0 * 5.2029e9), rel=1e-4)
        assert inputs_study.hardness(SCENES[A])[0] == pytest.approx(0.8 * 2.8 * 5.2029e9, rel=1e-4)

    @pytest.mark.parametrize(("B", "judged"), [(1780e6, "1.78 times the hardest"), (900e6, "plausible")])
    def test_a_hardness_beyond_that_of_steel_is_called_so(self, B, judged):
        found = fitted([PRINTED])
        for case in NAMES:
            found.runs[0, case].scene = with_constant(SCENES[case], B)
        bulk = inputs_study.fitted_note(found).split("by Tabor, of ")[1].split(";")[0]
        assert bulk.startswith("bulk") and judged in bulk
        assert ("not plausible" in bulk) == (B > 1e9)


def _close(tree):
    if isinstance(tree, dict):
        return {key: _close(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return type(tree)(map(_close, tree))
    return pytest.approx(tree, rel=1e-12) if isinstance(tree, float) else tree


class TestPhysics:
    CASE = physics_study.CASES[0]

    @pytest.fixture
    def found(self) -> physics_study.Found:
        return over_physics()

    def test_every_physics_is_another_scene(self, tmp_path):
        scenes = self.CASE.scenes(context(self.CASE.name, tmp_path))
        every = [repr(resolved(each)) for each in scenes.values()]
        assert len(set(every)) == len(set(map(self.CASE.label, scenes))) == len(ALL) * len(NAMES) == 120
        assert {scene.surface.seed for scene in scenes.values()} == {2}

    def test_the_physics_under_which_most_holds_is_named(self, found):
        assert found.held(GOOD) == max(map(found.held, ALL)) == len(STATEMENTS)
        first, *_, still, _ = self.CASE.notes(found)
        assert str(len(STATEMENTS)) in first and GOOD.words in first and first.count(";") == 0
        assert f"in {len(NAMES) - 1} of {len(found.runs)} runs" in still  # bulk has come to rest
        table, _ = readable(self.CASE, found)
        column = 2 + physics_study.COLUMNS.index((GOOD.counter, GOOD.sign))
        assert all("K" in row[column] for row in table.rows[:-1])
        assert table.rows[-1][column].endswith(f" {len(STATEMENTS)}")
        data = self.CASE.data(found)
        best = max(data["physics"], key=lambda each: each["held"])
        assert (best["counter"], best["sign"], best["hardening"]) == GOOD
        assert all(each["verdicts"][ALL.index(GOOD)] == "held" for each in data["statements"])

    def test_a_lost_run_says_nothing_and_turns_the_row_red(self, found):
        assert red(self.CASE.name, self.CASE.measure(found), whole=True) == set()
        for physics in ALL[:7]:
            found.runs[physics, BULK].result.converged = False
        found = replace(found)
        assert red(self.CASE.name, self.CASE.measure(found)) == {"lost"}
        table, wear = self.CASE.tables(found)
        assert "(IHK)" in table.rows[0][2] and wear.rows[0][2] == "not converged"
        del found.runs[GOOD, B]
        assert "missing" in red(self.CASE.name, self.CASE.measure(replace(found)))

    def test_a_first_cycle_of_its_own_turns_the_row_red(self, found):
        own = found.runs[GOOD, B].history
        found.runs[GOOD, B] = ran(replace(own, volume=own.volume * (1.0 + 1e-9)))
        assert red(self.CASE.name, self.CASE.measure(found)) == {"first-cycle"}


class TestCells:
    CASE = cells_study.CASES[0]

    @pytest.fixture
    def said(self) -> dict:
        """As the paper says on coarse cells; on fine ones bulk steel wears on."""
        runs = {}
        for cells, seed in (
            (cells, seed) for cells in cells_study.WINDOWS for seed in cells_study.EFFORT.seeds
        ):
            for case, history in as_the_paper_says().items():
                if cells > 32 and case == BULK:
                    history = replace(history, volume=1e-18 * np.arange(1, 26))
                runs[cells, case, seed] = SimpleNamespace(**vars(ran(history)), off=0.0)
                runs[cells, case, seed].result.cost["cpu_s"] = float(cells)
        return runs

    def test_verdicts_that_finer_cells_change_are_named(self, said):
        assert red(self.CASE.name, self.CASE.measure(said), whole=True) == set()
        coarse, fine = cells_study.on_cells(said).values()
        assert all(each.agreeing == len(cells_study.EFFORT.seeds) for each in coarse)
        changed, _ = self.CASE.notes(said)
        assert changed.count(": held, then failed") == sum(each.agreeing == 0 for each in fine) > 0
        assert "hardly any wear later: held, then failed" in changed
        statements, _ = readable(self.CASE, said)
        assert len(statements.rows) == len(STATEMENTS)
        lost = {key: one for key, one in said.items() if key[1] != BULK}
        assert red(self.CASE.name, self.CASE.measure(lost)) == {"missing"}
        said[32, BULK, 2].off = 1.0
        assert red(self.CASE.name, self.CASE.measure(said)) == {"volume"}

    def test_the_printed_scenes_differ_in_their_cells_alone(self, tmp_path):
        scenes = self.CASE.scenes(context(self.CASE.name, tmp_path))
        assert len(scenes) == len(cells_study.WINDOWS) * len(NAMES) * len(cells_study.EFFORT.seeds)
        for (cells, case, seed), scene in scenes.items():
            assert scene.grid.cells == (cells, cells) and scene.surface.seed == seed
            assert scene.wear.smoothing_window / cells == pytest.approx(5 / 32, rel=0.01)
            other = scenes[32, case, seed]
            assert (scene.grid.extent, scene.loading) == (other.grid.extent, other.loading)


class TestConverged:
    CASE = converged.CASES[0]

    @pytest.fixture
    def found(self) -> converged.Found:
        """All surfaces but the second wear; 3 % less at the recommended cells, what they have lost by 5 %."""
        volumes, lowered = {}, {}
        for one in converged.members():
            less = one.cells == DEFAULT
            volumes[one] = (
                (1e-18 if one.seed == 2 else 1e-16) * (1.0 - 0.03 * less) * (1.0 + 0.01 * one.thirds)
            )
            if one == Member(one.seed, one.cells):
                lowered[one] = np.full((COARSEST, COARSEST), 1e-8 * (1.0 - 0.05 * less))
        for seed in SEEDS:
            for name, change in ((converged.LAYERS, 0.92), (converged.LOADS, 1.02)):
                member = converged.VARIATIONS[name](seed)
                volumes[member] = change * volumes[Member(seed, member.cells)]
        return converged.Found(volumes, lowered, dict.fromkeys(lowered, (2.0, 10)), 1e-30)

    def test_every_run_is_another_scene_of_one_length_of_smoothing(self):
        scenes = {member.label: member.of(SCENES[BULK]) for member in converged.members()}
        assert (
            len(scenes) == len({repr(resolved(each)) for each in scenes.values()}) == len(converged.members())
        )
        for cells in CELLS:
            window = converged.window_of(cells)
            assert window % 2 == 1 and window / cells == converged.SMOOTHED / converged.SIDE
            assert Member(1, cells).of(SCENES[BULK]).wear.smoothing_window == window
        assert converged.per_wave(DEFAULT) == pytest.approx(24.0) and max(CELLS) == FINEST

    def test_a_surface_is_shifted_against_the_cells_exactly(self):
        """By a whole cell the same heights are one cell further, and fine cells hold those of coarse ones."""

        def heights(cells, shift=0.0):
            return converged.shifted(SCENES[BULK].surface, 3, cells, shift).measured.values

        assert heights(45, 1.0)[1:, 1:] == pytest.approx(heights(45)[:-1, :-1], abs=1e-18)
        assert heights(75)[1::3, 1::3] == pytest.approx(heights(25), abs=1e-18)
        assert heights(25, 1 / 3) == pytest.approx(heights(75)[::3, ::3], abs=1e-18)

    def test_cut_layers_keep_the_old_faces(self):
        finer = np.array(converged.cut(converged.FACES, 3))
        assert finer.size == 3 * (converged.FACES.size - 1) + 1 and (np.diff(finer) > 0).all()
        assert finer[::3] == pytest.approx(converged.FACES, rel=1e-14, abs=0.0)

    @pytest.mark.parametrize("fine", [25, 45, 135])
    def test_means_over_coarse_cells_keep_the_sum(self, fine):
        field, share = np.random.default_rng(fine).random((fine, fine)), converged.overlaps(fine, 25)
        assert share.sum(axis=1) == pytest.approx(np.ones(25)) and (share >= 0.0).all()
        fields = {"worn_m": field[..., None], "uz_m": 0.5 * field[..., None]}
        result = SimpleNamespace(grids={"unloaded": {"surface": GridFields(*[np.zeros(1)] * 3, {}, fields)}})
        assert converged.lowering(result).mean() == pytest.approx(1.5 * field.mean())

    def test_rows_hold_what_is_asked_and_turn_red(self, found):
        """With wrong volumes of two surfaces three are left that hold; of three surfaces they are not."""

        def red_with(factor, which, seeds):
            volumes = {
                one: volume * (factor if one.seed in seeds and which(one) else 1.0)
                for one, volume in found.volumes.items()
            }
            return red(self.CASE.name, self.CASE.values(replace(found, volumes=volumes)))

        assert red(self.CASE.name, self.CASE.values(found)) == set() and found.worn == [1, 3, 4, 5, 6]
        for row, factor, which in (
            ("cells", 0.85, lambda one: one.cells == DEFAULT),
            ("layers", 0.85, lambda one: one.parts > 1),
            ("steps", 1.1, lambda one: one.steps > converged.STEPS),
        ):
            assert row not in red_with(factor, which, (1, 3)) and row in red_with(factor, which, (1, 3, 4))
        assert "worn" in red_with(0.4, lambda one: True, SEEDS)
        assert red(self.CASE.name, self.CASE.values(replace(found, error=1e-27))) == {"volume"}
        lowered = {one: (1.3 if one.cells == DEFAULT else 1.0) * h for one, h in found.lowered.items()}
        assert red(self.CASE.name, self.CASE.values(replace(found, lowered=lowered))) == {"heights"}

    def test_one_bad_shift_counts_and_tables_show_every_surface(self, found):
        bad = (1, DEFAULT, 2)
        volumes = {
            one: (1.2 if (one.seed, one.cells, one.thirds) == bad else 1) * v
            for one, v in found.volumes.items()
        }
        found = replace(found, volumes=volumes)
        assert found.off(1, DEFAULT) == pytest.approx(1.2 * 0.97 * 1.02 - 1.0)
        tables = readable(self.CASE, found)
        assert [row[0] for row in tables[0].rows] == [str(seed) for seed in SEEDS]
        assert tables[0].rows[1][-1] == "–"
        held, missed, few = self.CASE.notes(found)
        assert "4 of 6 surfaces" in held and few.endswith("surface 2 (1 µm³).")
        assert missed == "Not on surface 1 (19%; 1 % more load changes it by +0%)."


class TestKinematic:
    CASE = kinematic.CASES[0]
    LAW = Plasticity(law="swift", B=1780e6, C=4.0, n=0.095, alpha=1e6)

    @pytest.mark.parametrize("share", SHARES.values(), ids=SHARES)
    def test_all_ways_have_one_curve_of_first_loading(self, share):
        scene = Scene(
            body={"young": 2e11, "poisson": 0.3, "plasticity": self.LAW.model_dump(exclude_none=True)},
            counterbody={"shape": "sphere", "radius": 1e-3},
            loading={"force": 1.0},
        )
        law, peeq = hardened(scene, share).body.plasticity, np.geomspace(*kinematic.FITTED, 50)
        stress = law.curve().stress(peeq)
        if share:
            constants = zip(law.kinematic.modulus, law.kinematic.recovery, strict=True)
            stress = stress + sum(c / g * (1 - np.exp(-g * peeq)) for c, g in constants)
        assert stress == pytest.approx(swift(self.LAW, peeq), rel=0.02 if share < 1 else 0.005)

    def found(self, first=1e-3, converged=True) -> kinematic.Found:
        """first, converged: of the kinematic runs."""
        cycles = {"wear_of_cycle_m3": np.repeat([2e-18, 1e-18], kinematic.HALF)}
        ways = {}
        for name in SHARES:
            last, good = (first, converged) if name == "kinematic" else (1e-3, True)
            history = {"peeq_max": [0.0] * (kinematic.EFFORT.steps - 1) + [last]}
            ways[name] = Run(
                SCENES[BULK], Made(tables={"cycles": cycles, "history": history}, converged=good)
            )
        peeq = np.geomspace(*kinematic.FITTED, 50)
        fit = np.abs((swift(self.LAW, np.zeros(1)) + kinematic.back_stress(peeq)) / swift(self.LAW, peeq) - 1)
        return kinematic.Found(float(fit.max()), dict.fromkeys(NAMES.values(), ways))

    def test_rows_hold_right_numbers_and_turn_red(self):
        def wrong(found):
            return red(self.CASE.name, self.CASE.values(found), whole=True)

        found = self.found()
        assert wrong(found) == set() and len(MODULI) == len(RECOVERY) == 5
        assert kinematic.late(found.runs["bulk"]["kinematic"]) == pytest.approx(0.5)
        assert wrong(replace(found, fit=0.01)) == {"fit"}
        assert wrong(self.found(first=1.2e-3)) == {"first-loading"}
        assert wrong(self.found(converged=False)) == {"converged"}


class TestWay:
    CASE = "running-in-way"

    def result(self, applications=30, status=Status.CONVERGED, **passes) -> Result:
        """Three passes that remove 6 m3 in all."""
        columns = (
            "work_J",
            "friction_mean",
            "protected_mean",
            "wear_of_pass_m3",
            "new_strain_max",
            "fx_mean_N",
        )
        table = {"pass": [1, 2, 3]} | {name: [0.2] * 3 for name in columns}
        tables = {
            "history": {"step": list(range(10))},
            "passes": table | {"wear_of_pass_m3": [3.0, 2.0, 1.0]} | passes,
            "surface": {"state": ["peak", "unloaded", "unloaded"], "worn_m": [9.0, 2.0, 1.0]},
        }
        return Result("sam", status, {}, tables, cost={"operator_applications": applications})

    @pytest.mark.parametrize(
        ("row", "part", "wrong"),
        [
            ("", "rest", {"applications": 20}),
            ("unconverged", "rest", {"status": Status.NOT_CONVERGED, "applications": 20}),
            ("increments", "moving", {"applications": 51}),
            ("missing", "moving", {"protected_mean": [0.1, np.nan, 0.1]}),
            ("volume", "moving", {"wear_of_pass_m3": [3.0, 2.0, 1.1]}),
            ("friction-range", "moving", {"friction_mean": [0.2, 0.41, 0.2]}),
        ],
    )
    def test_a_wrong_number_turns_its_row_red(self, row, part, wrong):
        scene = load_scene(f"verification/scenes/{self.CASE}.toml")
        loading = scene.loading.model_copy(update={"cycles": 3})
        grid = scene.grid.model_copy(update={"cells": (2, 2), "extent": (4.0, 2.0)})
        scene = scene.model_copy(update={"loading": loading, "grid": grid})
        found = OnWay(scene, self.result(), self.result(applications=20), 0, 0.0)
        measured = all_cases()[self.CASE].values(replace(found, **{part: self.result(**wrong)}))
        assert red(self.CASE, measured, whole=True) == {row} - {""}
