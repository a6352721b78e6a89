# SPDX-License-Identifier: MIT
"""The commands where the approach is given: plan, solve --resume and sweep."""

import csv
import json

import pytest
from builders import parsed, scene_text

from verification.cost.plan import plan
from verification.runs import checkpoints
from verification.runs.files import CHECKPOINT

PLASTIC = '[body.plasticity]\nlaw = "linear"\nyield_stress = "1 GPa"\nmodulus = "10 GPa"\n'
STEPS = "steps = 3\nunload = true\n[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 4\nbox = 5\n"
MOVED = scene_text(('force = "0.65 N"', 'approach = "0.1 um"'), ("[counterbody]", PLASTIC + "[counterbody]"))


@pytest.fixture
def folder(folder, monkeypatch):
    """The current folder, with moved.toml; a checkpoint after every step."""
    monkeypatch.setenv(checkpoints.INTERVAL, "0")
    (folder / "moved.toml").write_text(MOVED + STEPS)
    return folder


def test_plan_says_what_every_model_would_do(folder, samfem):
    entries = json.loads(samfem("plan", "moved.toml", "--json").out)["models"]
    assert [entry["available"] for entry in entries] == [True, True, True]
    for entry in entries:
        (contact,) = (stage for stage in entry["stages"] if stage["stage"] == "contact search")
        assert contact["runs"] and contact["size"] == {"steps": 3}
        assert 0.0 < entry["estimate"]["time_s"] and 0.0 < entry["estimate"]["memory_bytes"]


def test_an_approach_is_estimated_like_the_force_that_it_takes():
    """0.65 N move the elastic sphere by 0.35 um (Hertz): the same grid and mesh, and so the same cost."""
    moved, pressed = (
        plan(parsed(*edits))["models"] for edits in ([('force = "0.65 N"', 'approach = "0.3502 um"')], [])
    )
    for by_approach, by_force in zip(moved, pressed, strict=True):
        for name in ("time_s", "memory_bytes"):
            assert by_approach["estimate"][name] == pytest.approx(by_force["estimate"][name], rel=0.02)


@pytest.mark.parametrize("model", ["sam", "fem-axisymmetric"])
def test_a_solve_that_was_interrupted_is_resumed(folder, samfem, monkeypatch, model):
    """To the same tables, byte for byte."""
    original, calls = checkpoints.Writer.__call__, []

    def interrupted(self, checkpoint):
        original(self, checkpoint)
        calls.append(checkpoint)
        if len(calls) == 2:
            raise KeyboardInterrupt

    words = ("solve", "moved.toml", "--model", model, "--out")
    with monkeypatch.context() as patch:
        patch.setattr(checkpoints.Writer, "__call__", interrupted)
        samfem(*words, "out", code=130)
    assert (folder / "out" / CHECKPOINT).exists()
    assert "continued from step 3 of 4" in samfem(*words, "out", "--resume").err
    samfem(*words, "whole")
    tables = {path.name: path.read_bytes() for path in (folder / "out").glob("*.csv")}
    assert tables == {path.name: path.read_bytes() for path in (folder / "whole").glob("*.csv")} != {}


def test_a_sweep_varies_the_approach(folder, samfem):
    study = (
        'scene = "moved.toml"\n[vary]\n"loading.approach" = { range = ["0.05 um", "0.1 um"], count = 2 }\n'
    )
    (folder / "study.toml").write_text(study)
    samfem("sweep", "study.toml", "--out", "swept", "--workers", "1", "--no-runs")
    with (folder / "swept" / "sweep.csv").open(newline="") as table:
        rows = list(csv.DictReader(table))
    assert [float(row["loading.approach"]) for row in rows] == pytest.approx([0.05e-6, 0.1e-6])
    assert [row["status"] for row in rows] == ["converged", "converged"]
    assert 2.0 < float(rows[1]["force_N"]) / float(rows[0]["force_N"]) < 2**1.5  # Hertz: 2^1.5; plastic: 2
