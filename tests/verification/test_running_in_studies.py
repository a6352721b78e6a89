# SPDX-License-Identifier: MIT
"""The studies of running-in on made results: inputs, physics, cells, back-stresses, finite elements."""

import gzip
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from made_histories import (
    GOOD,
    SCENES,
    as_the_paper_says,
    at_rest,
    framed_physics,
    over_inputs,
    over_physics,
    result_of,
)
from made_results import Made, context, of_frame, of_plane, red

from fem_reference.spatial import WornCycle
from sam.scene import GridFields, Plasticity, resolved
from verification.cases import all_cases
from verification.cases.cyclic import running_in_kinematic as kinematic
from verification.cases.running_in import (
    running_in_converged as converged,
    running_in_fem as fem,
    running_in_readings as words,
    study,
)
from verification.cases.running_in.running_in import PRINTED as PRINTED_READING
from verification.cases.running_in.running_in_converged import DEFAULT, SEEDS
from verification.cases.running_in.running_in_physics import ALL
from verification.cases.running_in.running_in_sensitivity import INPUTS, PRINTED, scene_at, wilson
from verification.figures.check import findings
from verification.runs.store import Reuse
from verification.scenes.asperities import SIDE

ROOT = Path(__file__).resolve().parents[2]
OF_THE_LAYER = {"depth", "deviation", "hardening", "layer-limit"}


def readable(case, found) -> list:
    """The tables of a case, each row of which has a cell for each column; its figures can be read."""
    tables = list(case.tables(found))
    assert all(len(row) == len(table.columns) for table in tables for row in table.rows)
    assert all(list(findings(plot.drawing.figure)) == [] for plot in case.figures(found))
    return tables


def wrong(case: str, rows) -> set[str]:
    """The rows of a case that are red on a frame."""
    frame = pd.DataFrame([{"sweep": "", "model": "", **row} for row in rows])
    return red(case, of_frame(case, frame), whole=True)


@pytest.fixture(scope="module")
def found():
    return over_inputs()


class TestInputs:
    CASE = all_cases()["running-in-sensitivity"]

    @pytest.mark.parametrize("name", [one.name for one in INPUTS])
    def test_an_input_changes_the_scenes_that_it_is_about_and_no_others(self, name):
        """Each of the others is in the middle of its range."""
        for case in (study.BULK, study.A):
            shares = ([end if one.name == name else 0.5 for one in INPUTS] for end in (0.05, 0.95))
            low, high = (resolved(scene_at(SCENES[case], each)) for each in shares)
            assert (low != high) == (case == study.A or name not in OF_THE_LAYER)

    @pytest.mark.parametrize("case", [study.BULK, study.A])
    def test_the_printed_inputs_are_those_of_the_scenes(self, case):
        own = resolved(SCENES[case])
        again = resolved(scene_at(SCENES[case], PRINTED))
        layer = again["body"]["plasticity"].pop("layer", None)
        own["body"]["plasticity"].pop("layer", None)
        assert again == _close(own)
        assert layer is None or layer["alpha"] == pytest.approx(own["body"]["plasticity"]["alpha"], rel=1e-12)

    def test_tables_and_figures_can_be_read(self, found):
        tables = readable(self.CASE, found)
        statements = next(table for table in tables if table.caption.startswith("Probability"))
        assert len(statements.rows) == len(study.STATEMENTS)
        assert sum("deviation of the layer" in row[4] for row in statements.rows) >= 10
        said = self.CASE.data(found)["statements"]
        assert [f"{each['holds']} of {each['of']}" for each in said] == [row[2] for row in statements.rows]
        short = study.Run(found.frame["run"].iloc[0].scene.model_copy(deep=True), Made())
        short.scene.loading.__dict__["cycles"] = study.LAST - 1
        fewer = replace(found, frame=found.frame.assign(run=short))
        assert not fewer.judged and self.CASE.data(fewer) == {} and list(self.CASE.figures(fewer)) == []

    def test_bounds_of_a_probability(self):
        """The ends solve (p - k/n)^2 = z^2 p (1 - p)/n, with z = 1.6449 for 90 %: Wilson (1927)."""
        low, high = wilson(81, 263)
        for end in (low, high):
            assert (end - 81 / 263) ** 2 == pytest.approx(1.644854**2 * end * (1.0 - end) / 263, rel=1e-5)
        assert low < 81 / 263 < high
        assert wilson(0, 20)[0] == 0.0 and wilson(0, 0) == (0.0, 1.0)


def _close(tree):
    if isinstance(tree, dict):
        return {key: _close(value) for key, value in tree.items()}
    if isinstance(tree, list | tuple):
        return type(tree)(map(_close, tree))
    return pytest.approx(tree, rel=1e-12) if isinstance(tree, float) else tree


@pytest.mark.parametrize(
    ("name", "count"), [("running-in-physics", len(ALL) * len(study.NAMES)), ("running-in-readings", None)]
)
def test_every_run_is_another_scene_surface_by_surface(name, count, tmp_path):
    labels, scenes = zip(*all_cases()[name].scenes(context(name, tmp_path)).values(), strict=True)
    assert len({repr(resolved(each)) for each in scenes}) == len(set(labels)) == (count or len(scenes))
    seeds = [each.surface.seed for each in scenes]
    assert seeds == sorted(seeds) and (count is None or set(seeds) == {2})


class TestPhysics:
    CASE = all_cases()["running-in-physics"]

    def test_lost_and_missing_runs_and_a_first_cycle_of_its_own_turn_rows_red(self):
        readable(self.CASE, over_physics())
        runs = {tuple(row[:3]): row.run for row in over_physics().itertuples(index=False)}
        assert red(self.CASE.name, self.CASE.measure(framed_physics(runs)), whole=True) == set()
        own = as_the_paper_says()[study.B]
        first = {
            (GOOD, study.B, 2): study.Run(
                SCENES[study.B], result_of(replace(own, volume=own.volume * (1.0 + 1e-9)))
            )
        }
        assert red(self.CASE.name, self.CASE.measure(framed_physics(runs | first))) == {"first-cycle"}
        lost = {
            (each, study.BULK, 2): study.Run(SCENES[study.BULK], Made(converged=False))
            for each in list(ALL)[:7]
        }
        found = framed_physics(runs | lost)
        assert red(self.CASE.name, self.CASE.measure(found)) == {"lost"}
        under, hold = self.CASE.tables(found)
        assert under.rows[0][1:3] == ("13", "bulk: worn in the first six cycles") and under.rows[0][-1] == "7"
        good = next(row for row in hold.rows if row[0] == GOOD)
        assert good[1:] == ("17", ", ".join(map(str, range(1, 18))), "")
        assert hold.rows[0][3].startswith("1, 2")
        assert "missing" in red(self.CASE.name, self.CASE.measure(found.iloc[1:]))


class TestReadings:
    CASE = all_cases()["running-in-readings"]

    def found(self, name: str, wrong: float = 0.0, excess: float = 1e-3):
        """As the paper says, with curve C as B, in one reading; nothing wears later in the others. wrong: of
        wear that fills; excess: of the printed loop.
        """
        runs, said = {}, as_the_paper_says()
        for reading, case in np.ndindex(len(words.READINGS), len(words.NAMES)):
            (label, one), material = list(words.READINGS.items())[reading], list(words.NAMES)[case]
            own = said[study.B if material == words.C else material]
            result = result_of(own if label == name else at_rest(own))
            cycles = dict(result.tables["cycles"])
            cycles |= {"raw_volume_m3": cycles["wear_of_cycle_m3"] * (1 + wrong)}
            cycles |= {"filled_volume_m3": np.ones(study.LAST), "roof_volume_m3": np.ones(study.LAST)}
            cycles |= {"yield_excess": np.full(study.LAST, excess), "flow_residual": np.ones(study.LAST)}
            cycles |= {"peeq_max": np.ones(study.LAST)}
            scene = one.change(SCENES[study.B if material == words.C else material])
            made = replace(result, tables=result.tables | {"cycles": cycles})
            runs[label, material, 2] = study.Run(scene, made, kept=study.Kept(made, "", ""))
        return study.framed(runs, study.PARTS, self.CASE.numbers).assign(coarse=False)

    def test_statements_hold_where_the_runs_are_as_the_paper_says(self):
        """All but that the largest pressure of hardening falls, which made runs do not tell."""
        name = words.CHANGES[0][0]
        found = self.found(name)
        assert red(self.CASE.name, self.CASE.measure(found), whole=True) == set()
        verdicts = [one["by_agreement"] for one in self.CASE.judged(found)[name]]
        assert len(words.SAID) == 20 and verdicts == ["held"] * 19 + ["failed"]
        tables = readable(self.CASE, found)
        assert tables[-1].rows[0][:7] == (words.LOOP, "bulk", "2", "1", "1.0e-03", "1.0e+00", "1")
        assert tables[0].rows[0][:4] == ("A roof that falls", "model", "10", "19")
        assert len(tables[0].rows) == len(words.CHANGES)
        assert "10 to 19 of 20 statements hold" in next(iter(self.CASE.notes(found)))
        near = [words.near(words.SAID[0], {"values": (value,)}) for value in (0.82, 0.8)]
        assert near == [True, False]

    def test_wear_that_does_not_balance_and_a_loop_beyond_its_tolerance_turn_rows_red(self):
        name = words.named(words.PRINTED, "roof stays", "fills")
        assert red(self.CASE.name, self.CASE.measure(self.found(name, wrong=1e-9))) == {"balance"}
        assert red(self.CASE.name, self.CASE.measure(self.found(name, excess=1.1e-3))) == {"excess"}


class TestCampaign:
    @pytest.fixture
    def made(self, tmp_path, monkeypatch):
        """A case, its context at the full level, and the labels that it solves. Of a label: its history."""

        def of(name, history=lambda label: as_the_paper_says()[study.A]):
            own, solved = context(name, tmp_path, level="full"), []

            def solve(model, scene, label, *, demand):
                solved.append(label)
                own.sources[label] = Reuse(True, "2026-01-02T03:04", "abcdefgh")
                return result_of(history(label))

            monkeypatch.setattr(own, "solve", solve)
            return replace(all_cases()[name]), own, solved

        study.campaigns.cache_clear()  # they are read once in a process
        yield of
        study.campaigns.cache_clear()

    def test_runs_are_taken_from_it_and_some_are_solved_again_and_held_against_it(
        self, made, tmp_path, monkeypatch
    ):
        said, off = as_the_paper_says()[study.A], [0.0]
        case, own, solved = made(
            "running-in-readings", lambda _: replace(said, friction=said.friction + off[0])
        )
        one = next(iter(case.scenes(own)))[0]
        wanted = {key: each for key, each in case.scenes(own).items() if key[0] == one and key[2] < 3}
        monkeypatch.setattr(type(case), "scenes", lambda *_: wanted)
        monkeypatch.setattr(study, "FOLDER", tmp_path)
        before = case.runs(own)
        assert len(solved) == len(before) == 12 and np.isnan(
            study.apart_from_campaign(study.framed(before, study.PARTS))
        )
        case.keep(own, tmp_path / f"{case.name}.csv.gz")
        study.campaigns.cache_clear()
        solved.clear()
        off[0] = 0.03
        after = study.framed(case.runs(own), study.PARTS, case.numbers)
        assert solved == [wanted[one, study.A, 2][0]]
        assert study.apart_from_campaign(after) == pytest.approx([0.03], rel=1e-4)
        told = f"Taken from campaigns ({case.name}: 12 runs, commit abcdefg, 2026-01-02): 11 of 12 runs"
        assert list(case.told_of_campaign(after)) == [
            f"{told}; solved again and held against them: 1, whose friction differs in any cycle by 0.03 in "
            "the median and 0.03 at most."
        ]
        assert list(case.ahead(own)) == [wanted[one, study.A, 2][1]]
        kept = after.set_index("material").loc[study.B, "run"].iloc[0].history
        np.testing.assert_allclose(kept.volume, as_the_paper_says()[study.A].volume, rtol=1e-5)
        assert case.measure(after)["campaign"].value == pytest.approx(0.03, rel=1e-4)
        assert study.solved_of(after).index.tolist() == [list(wanted).index((one, study.A, 2))]

    @pytest.mark.parametrize(("name", "again"), [("running-in-physics", 24), ("running-in-sensitivity", 5)])
    def test_a_study_of_a_campaign_has_all_rows_tables_and_notes(
        self, name, again, made, tmp_path, monkeypatch
    ):
        said = as_the_paper_says()
        case, own, solved = made(
            name, lambda label: said[next(each for each in study.NAMES if f"{each}-seed" in label)]
        )
        monkeypatch.setattr(study, "FOLDER", tmp_path)
        case.keep(own, tmp_path / f"{name}.csv.gz")
        every = len(solved)
        study.campaigns.cache_clear()
        solved.clear()
        found = case.solve(own)
        assert len(solved) == again and red(name, case.measure(found), whole=True) == set()
        assert readable(case, found)
        assert f"{every - again} of {every} runs" in next(iter(case.notes(found)))

    def test_what_another_study_has_is_taken_from_there_and_not_kept_again(self, made, tmp_path):
        """running-in solves what its own campaign is to have: the printed reading is that of the readings."""
        case, own, solved = made("running-in")
        printed = len(case.readings(own)[PRINTED_READING].effort.seeds) * len(study.NAMES)
        case.keep(own, tmp_path / "kept.csv.gz")
        assert len(solved) == len(case.scenes(own)) - printed and all("renewed" in each for each in solved)
        assert gzip.decompress((tmp_path / "kept.csv.gz").read_bytes()).startswith(b"# %d runs" % len(solved))

    def test_the_guide_and_the_readme_say_what_it_gives(self, tmp_path, monkeypatch):
        case = all_cases()["running-in-readings"]
        monkeypatch.setattr(type(case), "solved_again", lambda *_: False)
        found = case.solve(context(case.name, tmp_path, level="full"))
        assert not found["run"].map(lambda one: one.solved).any()
        judged = case.judged(found)

        def told(reading: str, statement: str) -> tuple:
            one = next(each for each in judged[reading] if each["statement"] == statement)
            return f"{np.nanmedian(one['values']):.2f}", one["holds_on"], one["of"]

        stays, fills, falls = (
            words.named(words.PRINTED, *each)
            for each in (words.PLAIN, ("roof stays", "fills"), ("roof falls", "removes all"))
        )
        alike, straight = "hardening: wears as much as bulk", "curve B: still wears linearly"
        hard, (line, filled) = told(falls, alike), (told(each, straight) for each in (stays, fills))
        late = found[(found["reading"] == fills) & (found["material"] == study.B)][
            ["filled", "steady"]
        ].median()
        guide, readme = (
            " ".join((ROOT / name).read_text().split()) for name in ("docs/guide/limits.md", "README.md")
        )
        counts = [*map(len, words.held_in(judged).values())]
        ends = f"{min(counts)} to {max(counts)} of {len(words.SAID)}"
        assert f"{ends} statements hold." in guide
        assert f"{len(judged)} readings of its words {ends} hold." in readme
        assert f"({hard[0]} of its volume, on {hard[1]} of {hard[2]} surfaces; 0 where" in guide
        assert f"(R² {filled[0]}, on {filled[1]} of {filled[2]} surfaces; {line[0]} otherwise)" in guide
        assert "{:.1f} of the {:.1f} µm³".format(*(study.CUBIC * late)) in guide
        assert f"friction is then {told(fills, 'curve B: the whole surface protected')[0]}," in guide


class TestConverged:
    NAME = "wear-converged"

    def rows(self, **changed) -> list[dict]:
        """All surfaces but the second wear; changed: name -> (factor, surfaces)."""
        rows = []
        for seed in SEEDS:
            row = {"surface": seed, "volume": 1e-18 if seed == 2 else 1e-16, "error": 1e-14}
            row |= {f"off-{DEFAULT}": 0.03, f"heights-{DEFAULT}": 0.05, "layers": 0.04, "steps": 0.03}
            for name, (factor, seeds) in changed.items():
                row[name.replace("_", "-")] *= factor if seed in seeds else 1.0
            rows.append(row)
        return rows

    def test_rows_hold_what_is_asked_and_turn_red(self):
        """With wrong numbers of two surfaces three are left that hold; of three surfaces they are not."""
        assert wrong(self.NAME, self.rows()) == set()
        for column, row in ((f"off_{DEFAULT}", "cells"), ("layers", "layers"), ("steps", "steps")):
            assert wrong(self.NAME, self.rows(**{column: (5.0, (1, 3))})) == set()
            assert wrong(self.NAME, self.rows(**{column: (5.0, (1, 3, 4))})) == {row}
        assert "heights" in wrong(self.NAME, self.rows(**{f"heights_{DEFAULT}": (6.0, SEEDS)}))
        assert "worn" in wrong(self.NAME, self.rows(volume=(0.4, SEEDS)))
        assert wrong(self.NAME, self.rows(error=(1e3, (4,)))) == {"volume"}

    def test_a_surface_is_shifted_against_the_cells_exactly(self):
        """By a whole cell the same heights are one cell further, and fine cells hold those of coarse ones."""

        def heights(cells, shift=0.0):
            return converged.shifted(SCENES[study.BULK].surface, 3, cells, shift).measured.values

        assert heights(45, 1.0)[1:, 1:] == pytest.approx(heights(45)[:-1, :-1], abs=1e-18)
        assert heights(75)[1::3, 1::3] == pytest.approx(heights(25), abs=1e-18)
        assert heights(25, 1 / 3) == pytest.approx(heights(75)[::3, ::3], abs=1e-18)

    def test_cut_layers_keep_the_old_faces_and_means_over_coarse_cells_the_sum(self):
        finer = np.array(converged.cut(converged.FACES, 3))
        assert finer.size == 3 * (converged.FACES.size - 1) + 1 and (np.diff(finer) > 0).all()
        assert finer[::3] == pytest.approx(converged.FACES, rel=1e-14, abs=0.0)
        field = np.random.default_rng(45).random((45, 45))
        assert converged.overlaps(45, 25).sum(axis=1) == pytest.approx(np.ones(25))
        fields = {"worn_m": field[..., None], "uz_m": 0.5 * field[..., None]}
        result = Made(grids={"unloaded": {"surface": GridFields(*[np.zeros(1)] * 3, {}, fields)}})
        assert converged.lowering(result).mean() == pytest.approx(1.5 * field.mean())


class TestKinematic:
    LAW = Plasticity(law="swift", B=1780e6, C=4.0, n=0.095, alpha=1e6)

    def rows(self, first=1e-3, converged=True, fit=0.0) -> list[dict]:
        """first, converged: of the kinematic runs."""
        fit = fit or kinematic.misfit(self.LAW)
        cycles = {"wear_of_cycle_m3": np.repeat([2e-18, 1e-18], kinematic.HALF)}
        cycles |= dict.fromkeys(("friction_coefficient", "flowing_volume_m3"), np.ones(2))

        def made(strain, good=True):
            history = {"peeq_max": [0.0] * (kinematic.EFFORT.steps - 1) + [strain]}
            return study.Run(
                SCENES[study.BULK], Made(tables={"cycles": cycles, "history": history}, converged=good)
            )

        runs = {name: made(1e-3) for name in study.SHARES} | {"kinematic": made(first, converged)}
        return [
            {"material": name, "hardening": way} | kinematic.row(run, runs["isotropic"], fit)
            for name in study.NAMES.values()
            for way, run in runs.items()
        ]

    def test_rows_hold_right_numbers_and_turn_red(self):
        name, rows = "running-in-kinematic", self.rows()
        assert wrong(name, rows) == set() and len(study.MODULI) == len(study.RECOVERY) == 5
        assert rows[0]["late over early"] == pytest.approx(0.5)
        worse = self.rows(fit=0.01, first=1.2e-3, converged=False)
        assert wrong(name, worse) == {"fit", "first-loading", "converged"}


class TestFem:
    NAME = "running-in-fem"

    def test_results_that_differ_or_do_not_fall_and_cycles_that_do_not_wear_turn_red(self):
        measures = ("pressure", "squares", "strain", "residual", "moved", "volume")
        rows = [
            {"cells": cells, "mode": mode, "cycle": cycle, "wears": 4e-9} | dict.fromkeys(measures, value)
            for cells, value in zip(fem.CELLS, (0.06, 0.04), strict=True)
            for mode in ("own", "given")
            for cycle in (1, fem.CYCLES)
        ]
        assert fem.shrinking(pd.DataFrame(rows[::4]), "strain") == pytest.approx(4 / 6, rel=1e-12)
        assert wrong(self.NAME, rows) == set()
        assert wrong(self.NAME, [{**row, "wears": 0.0} for row in rows]) == {"wears"}
        coarsest = fem.CELLS[0]
        worse = [{**row, "strain": row["strain"] * (10 if row["cells"] > coarsest else 1)} for row in rows]
        rows = {f"{a}{b}-strain" for a in ("", "shrinks-") for b in ("own", "given")}
        assert wrong(self.NAME, worse) == rows

    def test_models_are_compared_where_they_press_strain_and_wear(self, monkeypatch, tmp_path):
        """FEM presses twice on the middle spot, strains a tenth more and wears a fifth less than SAM."""
        asked = []

        def solve(model, scene, label):
            cells = int(label.split("-")[1])
            states = [*(f"cycle-{k}" for k in range(1, fem.CYCLES)), "unloaded"]
            grids = {s: heights(cells, k) for k, s in enumerate(states, start=1)}
            return Made(tables=tables(cells), grids=grids)

        def worn_cycles(scene, *ways):
            asked.extend(ways)
            cells = fem.CELLS[len(asked) // 2 - 1]
            worn = [heights(cells, k + 1)["surface"].cell_data["worn_m"][..., 0] for k in range(fem.CYCLES)]
            own = tables(cells, 2.0, 1.1)
            return [[WornCycle(own, 0.02, 0.8 * each, 2e-9 + 0.2 * each) for each in worn]] * len(ways)

        here = context(self.NAME, tmp_path)
        monkeypatch.setattr(here, "solve", solve)
        monkeypatch.setattr(fem, "worn_cycles", worn_cycles)
        rows = list(fem.compared(here))
        assert asked[0] is None
        assert np.sum(asked[1], axis=0).max() == pytest.approx(fem.CYCLES * fem.THICK, rel=1e-12)
        assert len(rows) == 8 and rows[-1]["wears"] == pytest.approx(fem.THICK)
        assert rows[-1]["pressure"] == pytest.approx(3.0 / np.sqrt(16 + 36 + 4))
        assert rows[-1]["residual"] < 1e-12
        assert rows[-1]["strain"] == pytest.approx(0.1 / 1.1) and rows[-1]["volume"] == pytest.approx(0.25)
        assert sum("lowered" in row for row in rows) == 1

    def test_means_over_squares_count_each_cell_by_its_shares(self):
        """Cells of 2/3 of a square: the second lies in two."""
        p = np.zeros((24, 24))
        p[1, 0] = 4.0
        found = fem.over_squares(p)
        assert found[:2, 0] == pytest.approx([4.0 * 2 / 9, 4.0 * 2 / 9], rel=1e-12)
        assert found.mean() == pytest.approx(p.mean(), rel=1e-12)


def heights(cells: int, cycles: int) -> dict:
    """Of a square of cells that has worn so many times."""
    worn = np.zeros((cells, cells, 1))
    worn[4:8, 4:8] = cycles * fem.THICK
    fields = {"worn_m": worn, "uz_m": np.full(worn.shape, 2e-9)}
    return {"surface": GridFields(*[np.zeros(1)] * 3, {}, fields)}


def tables(cells: int, pressure: float = 1.0, strain: float = 1.0) -> dict:
    """Three spots of constant pressure, and bells of strain below."""
    x = ((np.arange(cells) + 0.5) / cells - 0.5) * SIDE
    p, z = np.zeros((cells, cells)), np.linspace(0.1e-6, 3e-6, 24)
    for k, value in enumerate((4e9, 3e9, 2e9)):
        p[(3 + 7 * k) : (6 + 7 * k), cells // 2 - 1 : cells // 2 + 1] = value * (pressure if k == 1 else 1.0)
    xx, yy = np.meshgrid(x, x, indexing="ij")
    return {
        "surface": {"x_m": xx.ravel(), "y_m": yy.ravel(), "p_Pa": p.ravel(), "state": ["peak"] * xx.size},
        "plane": of_plane(x, z, "peeq", lambda _, z: 0.01 * strain * np.exp(-(((z - 0.6e-6) / 0.5e-6) ** 2))),
    }
