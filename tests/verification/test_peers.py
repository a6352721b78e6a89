# SPDX-License-Identifier: MIT
"""SAM beside other programs, without them: problems, errors, times to an error, processes that fail."""

import json
import math
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from verification.cases import all_cases
from verification.cases.case import Context
from verification.cases.peers import peers
from verification.judging import evaluate
from verification.peers import elastic, plastic, problems, running
from verification.peers.programs import sam as ours
from verification.peers.running import SAM, TAMAAS, VARIABLE, Job, Measurement
from verification.references import contact_of
from verification.rows import load_rows
from verification.suite.verify import main


class TestProblems:
    def test_rough_surface_is_one_on_all_grids(self):
        coarse, fine = problems.rough_heights(160), problems.rough_heights(320)
        assert np.allclose(fine[::2, ::2], coarse, rtol=0.0, atol=1e-12)
        assert np.sqrt(np.mean(fine**2)) == pytest.approx(1.0, rel=1e-12)
        with pytest.raises(ValueError, match="128 cells"):
            problems.rough_heights(128)

    def test_step_is_three_times_the_yield_stress_in_the_scene_too(self):
        scene = ours.scene_of(32, 16, 1e-3)
        exact = contact_of(scene)
        a, p0 = exact.contact_radius, exact.peak_pressure
        assert (a, p0) == pytest.approx((ours.RADIUS_M, 3 * scene.body.plasticity.yield_stress), rel=1e-12)
        assert scene.grid.extent[0] == pytest.approx(6 * a, rel=1e-12) and scene.loading.steps == 1


def rows(**found) -> pd.DataFrame:
    """Of programs whose error is 0.01/n^2: (seconds for n = 1, label) of each curve."""
    record = {"converged": True, "peak_memory_bytes": 1e8}
    own = {
        program: [
            Measurement(Job(problems.HERTZ, n, {"tolerance": 1e-5}, label), [0.0], [each * n], record=record)
            for each, label in curves
            for n in (10, 100)
        ]
        for program, curves in found.items()
    }
    return pd.DataFrame(running.rows_of("hertz", own, lambda m: 0.01 / m.job.cells**2))


class TestTimes:
    def test_time_to_an_error_is_interpolated_and_the_better_curve_taken(self):
        made = rows(sam=[(1e-3, "")], tamaas=[(2e-2, "tight"), (1e-2, "loose")])
        found = peers.reached(made, 1e-5)  # at n = sqrt(1000)
        assert found[SAM] == ("SAM", pytest.approx(1e-3 * 1000**0.5, rel=1e-12))
        assert found[TAMAAS] == ("Tamaas, loose", pytest.approx(1e-2 * 1000**0.5, rel=1e-12))
        assert peers.tamaas_to_error(made, "") == pytest.approx(10.0, rel=1e-12)
        never = peers.reached(made, 1e-9)
        assert never[SAM][1] is None and math.isnan(peers.ratio(never[TAMAAS][1], None))


def test_what_is_not_there_has_no_ratio():
    """SAM alone, on one grid of the rough patch and two of the sphere."""
    made = pd.concat([rows(sam=[(1e-3, "")]), rows(sam=[(1e-3, "")]).assign(sweep="rough", cells="1024²")])
    made["floor"] = 0.0
    for take in (peers.contact_mechanics_to_error, peers.contact_mechanics_on_finest):
        assert math.isnan(take(made, ""))
    assert all(math.isnan(take(made[:0], "")) for take in (peers.step_on_coarse, peers.step_on_fine))
    tables = [table(made).rows for table in (peers.hertz_times, peers.rough_times, peers.step_times)]
    assert [len(each) for each in tables] == [1, 1, 0] and tables[0][0][3] == tables[1][0][4] == "1"
    plot = peers.over_time(None, made, "hertz")
    assert "processor time" in plot.caption and plot.drawing.data


class TestEnvironment:
    def test_without_the_variable_the_case_is_not_run(self, tmp_path, monkeypatch, capsys):
        monkeypatch.delenv(VARIABLE, raising=False)
        assert main(["peers"], "full", tmp_path / "out") == 0
        said = capsys.readouterr().out
        assert said.startswith("peers: not run: ") and VARIABLE in said and "make peers" in said
        assert not (tmp_path / "out").exists()
        monkeypatch.setenv(VARIABLE, str(tmp_path / "none"))
        assert main(["peers"], "full", tmp_path / "out") == 0 and "no such program" in capsys.readouterr().out


class TestWorker:
    def test_real_child_process(self):
        good, bad = (Measurement(Job(problems.HERTZ, 48, how)) for how in ({"tolerance": 1e-6}, {}))
        for each in (good, bad):
            running.run(SAM, each, Path(sys.executable))
        assert good.solved and good.seconds > 0.0 and good.record["peak_memory_bytes"] > 1e7
        assert good.fields["pressure"].max() == pytest.approx(problems.P0, rel=1e-3)
        assert not bad.solved and "KeyError" in bad.failure and math.isnan(bad.seconds)


def in_process(program, each, python, allowance=0.0):
    """SAM in the place of every program, ten times slower than it is, and in this process."""
    job = each.job
    settings = {key: job.settings[key] for key in ("tolerance", "side", "depth") if key in job.settings}
    if program != SAM and job.problem != problems.STEP:
        settings["tolerance"] = 1e-8  # theirs are other measures
    counts, fields = ours.read(ours.setup(job.problem, job.cells, settings)()())
    each.setup_s.append(0.0)
    each.solve_s.append(job.cells[0] if job.problem == problems.STEP else job.cells)
    each.solve_s[-1] *= 1e-3 if program == SAM else 1e-2
    each.record, each.fields = {**counts, "peak_memory_bytes": 1e8}, fields


class TestRounds:
    def test_the_page_with_sam_in_the_place_of_all(self, tmp_path, monkeypatch):
        """Times made ten to one, tables and figures whole, a program that is not built."""
        monkeypatch.setattr(running, "run", in_process)
        monkeypatch.setattr(running, "calibration_s", lambda: 0.2)
        monkeypatch.setattr(peers, "interpreter", lambda: Path("python"))
        monkeypatch.setattr(peers, "installed", lambda _: {"tamaas": "2.9", "contact_mechanics": "1.8"})
        for name, value in {"SIZES": (48, 192, 256), "ROUGH_SIZES": (160,), "COMPARED": (192,)}.items():
            monkeypatch.setattr(elastic, name, value)
        monkeypatch.setattr(elastic, "disagreements", lambda *_: {"tamaas": 1e-9, "contact_mechanics": 1e-8})
        grids = {"GRIDS": ((16, 8),), "COMPARED": ((16, 8),), "OWN_GRIDS": ((11, 8), (15, 11))}
        for name, value in grids.items():
            monkeypatch.setattr(plastic, name, value)
        monkeypatch.setattr(peers, "MESHES", (8, 12))
        context = Context("peers", tmp_path, "quick", lambda *_: None)
        outcome = all_cases()["peers"].run(context)
        values = {name: measured.value for name, measured in outcome.values.items()}
        assert values["peers.rough-contact-mechanics"] == pytest.approx(10.0)
        assert values["peers.hertz-tamaas"] == pytest.approx(10.0, rel=0.05)
        assert values["peers.hertz-contact-mechanics"] == pytest.approx(10.0, rel=0.05)
        assert values["peers.step-16"] == values["peers.step-32"] > 1.0  # here the cells of both are the same
        built = next(table for table in outcome.tables if table.caption == "programs").rows
        assert any("not built" in cell for row in built for cell in row if "aspher" in row)
        assert len(outcome.figures) == 2 and len(outcome.tables) == 9
        red = {v.row.id for v in evaluate(load_rows(), {"peers": outcome.values}) if v.status.red}
        assert {"peers.hertz-tamaas", "peers.hertz-contact-mechanics"} <= red  # ten is not twenty
        assert all(len(row) == len(table.columns) for table in outcome.tables for row in table.rows)
        json.dumps([list(table.rows) for table in outcome.tables])
