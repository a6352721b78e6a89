# SPDX-License-Identifier: MIT
"""The store in the commands, and whole cases that are taken from it."""

import json
from pathlib import Path

import pytest
from builders import scene_text
from fake_case import FakeCase, row
from stored import BOTH, COARSE_KEYS, flipped
from test_report import solved

from verification.runs import models, store
from verification.runs.store import FOLDER, Store
from verification.suite import outcomes, verify

# the commands


@pytest.fixture
def folder(folder, monkeypatch):
    """The current folder with coarse.toml, and a store of its own."""
    monkeypatch.setenv(FOLDER, str(folder / "store"))
    (folder / "coarse.toml").write_text(scene_text(add=COARSE_KEYS))
    return folder


def test_compare_solves_once_and_what_solve_left_not_at_all(folder, counted, samfem):
    samfem("solve", "coarse.toml", "--model", models.FEM)
    assert counted == [models.FEM]
    said = samfem("compare", "coarse.toml", code=1).err
    assert counted == [models.FEM, models.SAM]
    assert "fem-axisymmetric: taken from the store: computed 20" in said
    first = (folder / "coarse-compare" / "compare.csv").read_bytes()
    samfem("compare", "coarse.toml", code=1)
    assert counted == [models.FEM, models.SAM]
    assert (folder / "coarse-compare" / "compare.csv").read_bytes() == first
    summary = json.loads((folder / "coarse-compare" / "sam" / "summary.json").read_text(encoding="utf-8"))
    assert summary["provenance"]["from_store"]["computed_utc"].startswith("20")
    samfem("solve", "coarse.toml", "--model", models.FEM)
    assert counted == [models.FEM, models.SAM, models.FEM]  # solve always solves
    kept = len(list((folder / "store").iterdir()))
    assert "store" not in samfem("compare", "coarse.toml", "--no-store", code=1).err
    assert counted[3:] == [*BOTH] and len(list((folder / "store").iterdir())) == kept


def test_store_lists_and_prunes(folder, counted, samfem, monkeypatch):
    assert "0 entries" in samfem("store").out
    samfem("compare", "coarse.toml", code=1)
    listed = samfem("store").out
    assert "2 entries (2 current, 0 stale, 0 damaged), 0 left over" in listed and "fem-axisymmetric" in listed
    keys = [path.stem for path in (folder / "store").iterdir()]
    assert all(key[:12] in listed for key in keys)
    assert "0 removed, 0 B freed" in samfem("store", "--prune", "--older-than", "1").out
    flipped(folder / "store" / f"{keys[0]}.npz", 40)
    size = (folder / "store" / f"{keys[0]}.npz").stat().st_size
    said = samfem("store", "--prune").out
    assert f"removed {keys[0][:12]}" in said and "1 removed" in said and f"{size / 1e3:.0f} kB freed" in said
    monkeypatch.setattr(store.Entry, "age_days", 3.0)
    assert "0 removed" in samfem("store", "--prune", "--older-than", "4").out
    assert "1 removed" in samfem("store", "--prune", "--older-than", "2").out
    samfem("compare", "coarse.toml", code=1)
    assert "2 removed" in samfem("store", "--prune", "all").out
    assert list((folder / "store").iterdir()) == []


def test_store_refuses_what_could_be_misread(refused):
    for words in (["--older-than", "3"], ["--prune", "all", "--older-than", "3"], ["--prune", "x"]):
        assert "--" in refused("store", *words)
    for days in ("-1", "nan", "inf", "many"):
        assert "--older-than" in refused("store", "--prune", "--older-than", days)


def test_store_says_when_there_is_none(monkeypatch, samfem):
    monkeypatch.setenv(FOLDER, "")
    assert "no store" in samfem("store", "--prune").out


# whole cases


class Small:
    """A case that solves the coarse scene with SAM, draws, and counts its runs."""

    runs = 0

    def __call__(self, context):
        self.runs += 1
        context.scene("starts/sliding")
        outcome = solved(context, "small.one")
        outcome.setup = [("Force", "1 N")]
        return outcome


@pytest.fixture
def small(monkeypatch, counted):
    case = Small()
    cases = {"small": FakeCase("small", "Small case", "Does it hold?", does=case)}
    monkeypatch.setattr(verify, "all_cases", lambda: cases)
    monkeypatch.setattr(verify, "load_rows", lambda: [row("small.one", quantity="one, FEM")])
    return case


def report_of(tmp_path, code=0, name="out", level="quick") -> dict:
    assert verify.main([], level, tmp_path / name, store=Store(tmp_path / "store")) == code
    return json.loads((tmp_path / name / "results.json").read_text(encoding="utf-8"))


def tree_of(folder: Path) -> dict[str, bytes]:
    chosen = [*(folder / "figures").rglob("*"), *(folder / "runs").rglob("*"), folder / "gates.csv"]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in chosen if path.is_file()}


def test_a_case_runs_once_and_its_files_come_back_byte_for_byte(tmp_path, small, counted, capsys):
    first = report_of(tmp_path)
    second = report_of(tmp_path, name="again")
    assert small.runs == 1 and counted == [models.SAM]
    assert tree_of(tmp_path / "out") == (files := tree_of(tmp_path / "again")) and len(files) == 14
    assert {Path(name).suffix for name in files} >= {".json", ".csv", ".png", ".pvd", ".vtu", ".vtr"}
    assert first["solves"] == {"solved": 1, "reused": 0, "cases": 0, "stale": 0, "damaged": 0}
    assert second["solves"] == {"solved": 0, "reused": 1, "cases": 1, "stale": 0, "damaged": 0}
    assert first["gates"] == second["gates"]
    assert second["provenance"]["input_sha256"].keys() == {"starts/sliding.toml"}
    pages = [(tmp_path / name / "index.html").read_text(encoding="utf-8") for name in ("out", "again")]
    assert "1 solved, 0 taken" in pages[0] and "0 solved, 1 taken from the store" in pages[1]
    said = capsys.readouterr().out
    assert "0 solved, 1 taken from the store; cases not run again, code and scenes unchanged: 1" in said
    assert "1 of 1: small: 1 gate passed, from the store\n" in said
    assert report_of(tmp_path, level="full")["solves"]["cases"] == 0  # another level is another outcome
    assert small.runs == 2 and counted == [models.SAM]


def test_gates_of_a_reused_case_are_judged_anew(tmp_path, small, monkeypatch):
    report_of(tmp_path)
    monkeypatch.setattr(verify, "load_rows", lambda: [row("small.one", quantity="one, FEM", tolerance=0.001)])
    assert report_of(tmp_path, code=1)["gates"][0]["status"] == "failed" and small.runs == 1


@pytest.mark.parametrize("why", ["other code", "another scene", "damaged"])
def test_a_case_of_other_code_or_scene_runs_again_on_stored_results(
    tmp_path, small, counted, monkeypatch, capsys, why
):
    report_of(tmp_path)
    asked = Store(tmp_path / "store"), verify.all_cases()["small"], "quick"
    assert outcomes.is_kept(*asked)
    if why == "damaged":
        (entry,) = [entry for entry in Store(tmp_path / "store").entries() if entry.kind == "outcome"]
        assert entry.what == "small, quick" and entry.state == "current"
        flipped(entry.path, entry.size // 2)
    with monkeypatch.context() as patched:
        if why == "other code":
            patched.setattr(outcomes, "version_of_cases", lambda: "f" * 64)
            assert not outcomes.is_kept(*asked)
        elif why == "another scene":
            patched.setattr(outcomes, "present", lambda name: b"title")
        solves = report_of(tmp_path)["solves"]
    damaged = int(why == "damaged")
    assert solves == {"solved": 0, "reused": 1, "cases": 0, "stale": 1 - damaged, "damaged": damaged}
    assert small.runs == 2 and counted == [models.SAM]
    assert ("small: damaged: " in capsys.readouterr().err) == bool(damaged)
