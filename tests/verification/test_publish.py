# SPDX-License-Identifier: MIT
"""A publication that is killed on the way goes on with what is missing, to the same values and figures."""

import gzip
import json
from concurrent.futures import Executor, Future

import pytest
from fake_case import FakeCase, row
from test_report import solved

from samfem import publishing
from verification.cases.case import Figure
from verification.runs import models
from verification.suite import freshness, outcomes, verify

NAMES = ("timed", "first", "second")
ROWS = [row(f"{name}.one") for name in NAMES]


class Here(Executor):
    """In place of the processes: this one."""

    alone, most_deaths, lost, started = False, 1, 0, []

    def __init__(self, count, fresh):
        assert fresh
        self.executor, self.count = self, count

    def slots(self):
        return self.count

    def died(self, error):
        return False

    def submit(self, function, /, *arguments):
        self.started.append((arguments[0], self.count))
        future = Future()
        future.set_result(function(*arguments))
        return future


class Published:
    """Cases that solve and draw; a kill strikes the one that is named, after its solve."""

    def __init__(self):
        self.killed, self.problem, self.runs = set(), "", []

    def case(self, name: str) -> FakeCase:
        def does(context):
            self.runs.append(name)
            outcome = solved(context, f"{name}.one")
            if name in self.killed:
                self.killed.remove(name)
                raise KeyboardInterrupt
            if name == self.problem:
                raise RuntimeError("no")
            return outcome

        return FakeCase(name, name, "Does it hold?", alone=name == "timed", does=does)


@pytest.fixture
def published(monkeypatch, counted):
    made = Published()
    for module in (publishing, freshness):
        monkeypatch.setattr(module, "all_cases", lambda: {name: made.case(name) for name in NAMES})
    for module in (verify, freshness):
        monkeypatch.setattr(module, "load_rows", lambda: ROWS)
    monkeypatch.setattr(publishing, "Processes", Here)
    monkeypatch.setattr(Here, "started", [])
    return made


def report_in(base, name="out") -> dict:
    return json.loads((base / name / "results.json").read_text(encoding="utf-8"))


def run(base, out="out", store="store", code=0) -> dict[str, bytes]:
    """The figures and the table of gates."""
    where = {"out": base / out, "store": base / store}
    assert publishing.publish([], level="full", workers=2, **where) == code
    paths = *(base / out / "figures").iterdir(), base / out / "gates.csv"
    return {path.name: path.read_bytes() for path in paths}


def test_killed_twice_it_gives_the_same_gates_and_figures_and_repeats_nothing(tmp_path, published, counted):
    published.killed = {"second", "timed"}
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            run(tmp_path)
        assert not (tmp_path / "out" / "results.json").exists()
    found = run(tmp_path)
    assert published.runs == ["first", "second", "second", "timed", "timed"] and counted == [models.SAM]
    assert found == run(tmp_path, "other", "other-store")
    assert {"gates.csv", *(f"{name}-curve.png" for name in NAMES)} <= found.keys()
    table = tmp_path / "other" / "figures" / "first-curve.csv"
    table.write_text("x,y\n" * 2000)
    figure = outcomes.packed(Figure("", "", "", "", "figures/first-curve.csv"), tmp_path / "other")
    assert gzip.decompress((tmp_path / "other" / figure.csv).read_bytes()) == b"x,y\n" * 2000
    assert outcomes.packed(figure, tmp_path / "other") == figure and not table.exists()
    assert not (tmp_path / "store" / publishing.SCRATCH).exists()
    assert not (tmp_path / "out" / "runs").exists()


def test_what_measures_times_runs_last_and_alone_and_is_kept_too(tmp_path, published):
    first = run(tmp_path)
    assert Here.started == [("first", 2), ("second", 2), ("timed", 1)]
    assert run(tmp_path, "again") == first and len(published.runs) == 3
    before = report_in(tmp_path)
    assert run(tmp_path, store="new") == first and len(published.runs) == 3  # of this code, without a store
    assert [report_in(tmp_path)[key] for key in ("cases", "gates")] == [before["cases"], before["gates"]]


def test_a_case_that_breaks_off_is_red_and_runs_again(tmp_path, published, capsys):
    published.problem = "second"
    run(tmp_path, code=1)
    results = report_in(tmp_path)
    status = {case["name"]: (case["status"], case["failure"][:16]) for case in results["cases"]}
    assert status["second"] == ("failed", "RuntimeError: no") and status["first"] == ("passed", "")
    assert "of 3: second: RuntimeError: no" in capsys.readouterr().out
    published.problem = ""
    run(tmp_path)
    assert published.runs == ["first", "second", "timed", "second"]


def test_an_unknown_case_and_a_folder_of_something_else_are_refused(tmp_path, published, capsys):
    where = {"level": "full", "store": tmp_path / "store", "workers": 2}
    assert publishing.publish(["frist"], out=tmp_path / "out", **where) == 2
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    assert publishing.publish([], out=tmp_path / "mine", **where) == 2
    assert "first" in (said := capsys.readouterr().err) and "no verification report" in said
    assert published.runs == []


def test_a_report_of_another_level_is_left_alone(tmp_path, published, capsys):
    before = run(tmp_path)
    where = {"out": tmp_path / "out", "store": tmp_path / "store", "workers": 2}
    assert publishing.publish([], level="quick", **where) == 2
    assert "out holds a report of level full: choose another folder" in capsys.readouterr().err
    assert run(tmp_path) == before


def test_a_case_that_belongs_to_another_level_now_is_left_out(tmp_path, published, monkeypatch):
    run(tmp_path)
    monkeypatch.setattr(FakeCase, "published_at", lambda case, _: case.name != "second")
    assert not any(name.startswith("second") for name in run(tmp_path))
