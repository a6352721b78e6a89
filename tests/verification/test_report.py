# SPDX-License-Identifier: MIT
"""What `samfem verify`, `report` and `publish` write, with small cases; whole cases from the store; a
publication that is killed on the way goes on with what is missing, to the same values and figures.
"""

import errno
import gzip
import json
from concurrent.futures import Executor, Future
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from builders import parsed, scene_text
from made_results import FakeCase, context, row
from matplotlib.lines import Line2D
from page_checks import PageReader, broken_links, faults_of
from stored import COARSE, COARSE_KEYS, flipped

from samfem import publishing
from samfem.cli import main
from verification.cases.case import Figure, Outcome, Plot, SmallTable
from verification.figures.style import Drawing, new_figure
from verification.judging import Measured
from verification.references import contact_of
from verification.robustness.hostile import MARKUP
from verification.runs import models
from verification.runs.files import FolderError
from verification.runs.store import Store
from verification.suite import freshness, outcomes, verify

ROWS = [
    row(f"{case}.{name}", quantity=f"quantity {name}, FEM", reason=f"because of {name}")
    for case, name in (("good", "one"), ("good", "two"), ("bad", "one"), ("broken", "one"), ("slow", "one"))
]


def sketch():
    """A drawing that takes a hundredth of the time, for tests of what stands around it."""
    figure = new_figure(1.0, 0.7, "none")
    figure.add_artist(Line2D([0.0, 1.0], [0.0, 1.0]))
    return Drawing(figure, {"x": [0.0, 1.0], "y": [0.0, 1.0]})


def solved(context, gate) -> Outcome:
    """What a case finds that solves COARSE: its largest pressure, 1 % off, and a figure."""
    p = context.solve(models.SAM, COARSE, "sam").quantities["p_max_Pa"]
    outcome = Outcome({gate: Measured(np.float64(p * 1.01), p)})
    outcome.figures = [context.save(Plot(sketch(), "curve", "A curve", "Caption"))]
    return outcome


def good(context):
    context.inputs["scene.toml"] = b"title"
    outcome = Outcome({"good.one": Measured(1.0, 1.0, unit="Pa"), "good.two": Measured(2.1, 2.0)})
    outcome.setup = [("Force", "1 N")]
    outcome.tables = [SmallTable("Small", ["a", "b"], [["1", "2"]])]
    outcome.figures = [context.save(Plot(sketch(), "curve", "A curve", "Caption"))]
    return outcome


def bad(context):
    return Outcome({"bad.one": Measured(float("nan"), 1.0)})


def broken(context):
    raise RuntimeError("<b>no</b> convergence")


CASES = {
    "good": FakeCase("good", "Good case", "Does it hold?", [("Law", "a < b & c", "Euclid")], does=good),
    "bad": FakeCase("bad", "Bad case", "Does it hold?", does=bad),
    "broken": FakeCase("broken", "Broken case", "Does it hold?", does=broken),
    "slow": FakeCase("slow", "Slow case", "Does it hold?", levels=("full",), does=good),
}


@pytest.fixture(autouse=True)
def _small_cases(monkeypatch):
    monkeypatch.setattr(verify, "all_cases", lambda: CASES)
    monkeypatch.setattr(verify, "load_rows", lambda: ROWS)


def run(out, *cases, level="quick"):
    return verify.main(list(cases), level, out)


def results(out):
    def no_constant(name):
        raise ValueError(f"{name} is no JSON")

    return json.loads((out / "results.json").read_text(encoding="utf-8"), parse_constant=no_constant)


def gates_of(out) -> dict[str, str]:
    return {gate["id"]: gate["status"] for gate in results(out)["gates"]}


def test_broken_case_does_not_stop_the_others_and_each_level_has_its_cases(tmp_path, capsys):
    out = tmp_path / "out"
    assert run(out) == 1
    status = {case["name"]: case["status"] for case in results(out)["cases"]}
    assert status == {"good": "passed", "bad": "failed", "broken": "failed", "slow": "not run"}
    found = gates_of(out)
    assert [found[f"{name}.one"] for name in CASES] == ["passed", "failed", "unchecked", "not run"]
    assert "no</b> convergence" in capsys.readouterr().out
    run(out, level="full")
    assert gates_of(out)["slow.one"] == "unchecked"
    run(out, "slow")  # at any level, where it is named
    cases = results(out)["cases"]
    assert [case["name"] for case in cases if case["status"] != "not run"] == ["slow"]
    assert {case["unmet"] for case in cases} == {"", "not asked for"}


def test_folder_with_other_files_is_left_alone(tmp_path, capsys):
    (tmp_path / "holiday.png").write_bytes(b"x")
    assert main(["verify", "good", "--out", str(tmp_path)]) == 2
    assert "holds files that are no verification report" in capsys.readouterr().err
    assert [path.name for path in tmp_path.rglob("*")] == ["holiday.png"]


def test_a_case_of_the_suite_from_end_to_end(tmp_path, monkeypatch):
    """The ellipse is the quickest; its report holds the page, the figures and the run."""
    monkeypatch.undo()
    assert run(tmp_path, "hertz-ellipse") == 0
    assert (tmp_path / "elastic.html").stat().st_size > 0
    assert (tmp_path / "runs/hertz-ellipse/sam/summary.json").stat().st_size > 0
    for kind in ("png", "csv.gz"):
        assert (tmp_path / "figures" / f"hertz-ellipse-pressure-maps.{kind}").stat().st_size > 1000


def test_a_solve_that_does_not_converge_breaks_its_case_off(tmp_path):
    here = context("test", tmp_path)
    small = parsed(add='[grid]\nextent = ["5 um", "5 um"]\n')  # than the contact
    with pytest.raises(RuntimeError, match="grid-edge"):
        here.solve(models.SAM, small, "sam")
    assert here.runs == ["runs/test/sam"]


def test_earlier_report_is_replaced(tmp_path):
    out = tmp_path / "out"
    run(out, "good")
    (out / "notes.txt").write_text("mine")
    assert (out / "figures" / "good-curve.png").exists()
    run(out, "bad")
    assert not (out / "figures").exists() and "good.one" in {gate["id"] for gate in results(out)["gates"]}
    assert (out / "notes.txt").exists() and not (out / verify.UNFINISHED).exists()


def files_in(out) -> dict[str, bytes]:
    return {str(path.relative_to(out)): path.read_bytes() for path in out.rglob("*") if path.is_file()}


def stopped(*_, **_keys):
    raise KeyboardInterrupt


def test_pages_of_what_has_ended_can_be_opened_and_the_earlier_report_stays(tmp_path, monkeypatch, capsys):
    out, new = tmp_path / "out", tmp_path / "out" / verify.UNFINISHED
    run(out, "bad")
    earlier = files_in(out)
    with monkeypatch.context() as patch:
        patch.setitem(CASES, "bad", replace(CASES["bad"], does=stopped))
        assert main(["verify", "--no-store", "--out", str(out)]) == 130
    said = capsys.readouterr().err
    assert f"interrupted: 1 of 3 cases have ended, pages in {new / 'index.html'}; the same command" in said
    assert earlier.items() <= files_in(out).items() and not results(new)["complete"]
    pages = {name: page_of(new, name) for name in ("index.html", "other.html")}
    assert "Running: 1 of 3 cases finished." in pages["index.html"].text
    assert "(samfem verify bad): still to run" in pages["other.html"].text
    assert [faults_of(page) for page in pages.values()] == [[], []]
    data = dict.fromkeys(("gates.csv", "results.json", "README.md"), PageReader(""))
    assert broken_links(pages | data, new) == []
    assert main(["report", str(new)]) == 2
    assert run(out) == 1 and not new.exists() and results(out)["complete"]


def test_a_full_disk_ends_the_report_in_one_error(tmp_path, monkeypatch, capsys):
    def full(context):
        raise OSError(errno.ENOSPC, "No space left on device", "runs/good/line.csv")

    monkeypatch.setitem(CASES, "good", replace(CASES["good"], does=full))
    assert main(["verify", "--no-store", "--out", str(tmp_path / "out")]) == 1
    (said,) = capsys.readouterr().err.splitlines()
    assert "line.csv" in said and "free some space" in said
    (tmp_path / "file").touch()
    assert main(["verify", "--out", str(tmp_path / "file")]) == 2
    assert "no folder that can be written to" in capsys.readouterr().err


def page_of(out, name="other.html"):
    return PageReader((out / name).read_text(encoding="utf-8"))


def test_pages_need_no_script_and_what_they_link_is_there(tmp_path):
    out = tmp_path / "out"
    run(out)
    pages = {name: page_of(out, name) for name in ("index.html", "other.html")}
    assert "Bad case" in pages["other.html"].text and "Bad case" not in pages["index.html"].text
    pictures = [image["src"] for page in pages.values() for image in page.all("img")]
    assert pictures == ["figures/good-curve.png"] * 2  # the only figure is the picture of a contact too
    assert [faults_of(page) for page in pages.values()] == [[], []]
    written = {name: page_of(out, name) for name in ("README.md", "gates.csv", "results.json")}
    assert broken_links(pages | {name: PageReader("") for name in written}, out) == []
    assert 'url=index.html"' in (out / "report.html").read_text(encoding="utf-8")
    assert main(["report", str(out), "--single-file"]) == 0
    page = page_of(out, "report.html")
    assert [image["src"][:22] for image in page.all("img")] == ["data:image/png;base64,"]
    assert all(words in page.text for words in ("Good case", "Bad case", "Broken case", "because of two"))


def test_junit_has_one_testcase_a_gate(tmp_path):
    run(tmp_path / "out")
    suites = list(ElementTree.parse(tmp_path / "out" / "junit.xml").getroot())
    kinds = "failure", "error", "skipped"
    keys = "tests", "failures", "errors", "skipped"
    said = {s.get("name"): [int(s.get(key)) for key in keys] for s in suites}
    held = {s.get("name"): [len(s), *(len(s.findall(f"testcase/{kind}")) for kind in kinds)] for s in suites}
    assert held == said
    assert said == {"good": [2, 0, 0, 0], "bad": [1, 1, 0, 0], "broken": [2, 1, 1, 0], "slow": [1, 0, 0, 1]}


def test_rebuild_writes_the_same_page_without_running(tmp_path, monkeypatch):
    out = tmp_path / "out"
    run(out)
    pages = {path.name: path.read_bytes() for path in (*out.glob("*.html"), out / "README.md")}
    for name in pages:
        (out / name).unlink()
    monkeypatch.setattr(verify, "all_cases", None)
    monkeypatch.setattr(verify, "older", lambda results: {})  # the small cases are not of the suite
    assert verify.rebuild(out) == 0
    assert {name: (out / name).read_bytes() for name in pages} == pages
    (out / "figures" / "good-curve.png").unlink()
    assert verify.rebuild(out) == 0
    assert "figures/good-curve.png is missing" in page_of(out).text


def test_rebuild_refuses_a_folder_without_a_finished_report(tmp_path, monkeypatch, capsys):
    def interrupted(context):
        raise KeyboardInterrupt

    with pytest.raises(FolderError, match="no finished"):
        verify.rebuild(tmp_path)
    monkeypatch.setitem(CASES, "good", FakeCase("good", "Good case", "Does it hold?", does=interrupted))
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "out", "good")
    assert main(["report", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out" / "index.html").exists() and "no finished" in capsys.readouterr().err
    assert run(tmp_path / "out", "bad") == 1  # an interrupted report can be run again


OWN = """
title = "My contact"
question = "Do both models give my pressure?"
scene = "scene.toml"
models = ["sam"]
[values]
p-max = {value}
[rows."sam/published"]
p-max = ["relative", 0.05, "measured here to 5 %"]
"""


def test_a_file_of_own_rows_is_verified_by_the_same_rules(tmp_path, monkeypatch, capsys):
    monkeypatch.undo()
    (tmp_path / "scene.toml").write_text(scene_text(add=COARSE_KEYS), encoding="utf-8")
    exact = contact_of(COARSE).peak_pressure
    for value, code in ((1.01 * exact, 0), (2.0 * exact, 1)):
        (tmp_path / "my-contact.toml").write_text(OWN.format(value=value), encoding="utf-8")
        arguments = [str(tmp_path / "my-contact.toml"), "--no-store", "--out", str(tmp_path / "out")]
        assert main(["verify", *arguments]) == code
        (gate,) = results(tmp_path / "out")["gates"]
        assert gate["id"] == "my-contact.sam-p-max" and gate["kind"] == "published"
        assert gate["expected"] == value
    capsys.readouterr()
    for old, new, said in (
        ('p-max = ["', 'pmax = ["', "rows.sam/published.pmax"),
        ('"scene.toml"', '"scne.toml"', 'scene = "scne.toml": one of my-contact.toml, scene.toml'),
        ('models = ["sam"]', 'models = ["sam"]\nreference = "hertz"', "hertz-sphere"),
        ('models = ["sam"]', 'models = ["sam"]\nfigures = ["maps"]', 'figures = "maps"'),
        ("sam/published", "fem/published", "models names it"),
        ('5 %"]', '5 %"]\nown = ["at_most", 1, "because", "in my words"]', 'rows.sam/published = "own"'),
    ):
        (tmp_path / "my-contact.toml").write_text(OWN.format(value=1).replace(old, new), encoding="utf-8")
        assert main(["verify", *arguments]) == 2
        assert said in (text := capsys.readouterr().err) and "my-contact.toml" in text


def test_markup_and_control_characters_do_no_harm_in_a_report(tmp_path, monkeypatch):
    """In the set-up, a table, a note, and the message of a case that breaks off."""
    text = " ".join(entry for entry in MARKUP if len(entry) < 100)

    def fill(context):
        table = SmallTable(text, (text,), [(text,)])
        return Outcome({"good.one": Measured(1.0, 1.0)}, [("Scene", text)], tables=[table], notes=[text])

    def fail(context):
        raise RuntimeError(text)

    monkeypatch.setitem(CASES, "good", replace(CASES["good"], title=text, question=text, does=fill))
    monkeypatch.setitem(CASES, "bad", replace(CASES["bad"], does=fail))
    assert run(tmp_path / "out", "good", "bad") == 1
    page = (tmp_path / "out" / "other.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page and "<img src=x" not in page and "&lt;script&gt;alert" in page
    assert "{{ 7 * 7 }}" in page and "\x1b" not in page
    ElementTree.parse(tmp_path / "out" / "junit.xml")
    assert results(tmp_path / "out")["complete"]


def test_a_case_that_is_not_run_does_not_stop_the_others(tmp_path, monkeypatch, capsys):
    """The page and results.json have the reason; nothing of it is red."""
    why = "install nothing: pip install x"
    unmet = replace(CASES["slow"], needs=lambda: why, does=pytest.fail)
    monkeypatch.setitem(CASES, "slow", unmet)
    assert run(tmp_path / "out", "good", "slow") == 0
    assert f"slow: not run: {why}" in capsys.readouterr().out
    records = {case["name"]: (case["status"], case["unmet"]) for case in results(tmp_path / "out")["cases"]}
    assert records["slow"] == ("not run", why) and records["good"] == ("passed", "")
    assert f": {why}" in page_of(tmp_path / "out").text


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


NAMES = ("timed", "first", "second")
PUBLISHED_ROWS = [row(f"{name}.one") for name in NAMES]


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
        monkeypatch.setattr(module, "load_rows", lambda: PUBLISHED_ROWS)
    monkeypatch.setattr(publishing, "Processes", Here)
    monkeypatch.setattr(Here, "started", [])
    return made


def publish_in(base, out="out", store="store", code=0) -> dict[str, bytes]:
    """The figures and the table of gates."""
    where = {"out": base / out, "store": base / store}
    assert publishing.publish([], level="full", workers=2, **where) == code
    paths = *(base / out / "figures").iterdir(), base / out / "gates.csv"
    return {path.name: path.read_bytes() for path in paths}


def test_killed_twice_it_gives_the_same_gates_and_figures_and_repeats_nothing(tmp_path, published, counted):
    published.killed = {"second", "timed"}
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            publish_in(tmp_path)
        assert not (tmp_path / "out" / "results.json").exists()
    found = publish_in(tmp_path)
    assert published.runs == ["first", "second", "second", "timed", "timed"] and counted == [models.SAM]
    assert found == publish_in(tmp_path, "other", "other-store")
    assert {"gates.csv", *(f"{name}-curve.png" for name in NAMES)} <= found.keys()
    table = tmp_path / "other" / "figures" / "first-curve.csv"
    table.write_text("x,y\n" * 2000)
    figure = outcomes.packed(Figure("", "", "", "", "figures/first-curve.csv"), tmp_path / "other")
    assert gzip.decompress((tmp_path / "other" / figure.csv).read_bytes()) == b"x,y\n" * 2000
    assert outcomes.packed(figure, tmp_path / "other") == figure and not table.exists()
    assert not (tmp_path / "store" / publishing.SCRATCH).exists()
    assert not (tmp_path / "out" / "runs").exists()


def test_what_measures_times_runs_last_and_alone_and_is_kept_too(tmp_path, published):
    first = publish_in(tmp_path)
    assert Here.started == [("first", 2), ("second", 2), ("timed", 1)]
    assert publish_in(tmp_path, "again") == first and len(published.runs) == 3
    before = results(tmp_path / "out")
    assert (
        publish_in(tmp_path, store="new") == first and len(published.runs) == 3
    )  # of this code, without a store
    assert [results(tmp_path / "out")[key] for key in ("cases", "gates")] == [
        before["cases"],
        before["gates"],
    ]


def test_a_case_that_breaks_off_is_red_and_runs_again(tmp_path, published, capsys):
    published.problem = "second"
    publish_in(tmp_path, code=1)
    cases = results(tmp_path / "out")["cases"]
    status = {case["name"]: (case["status"], case["failure"][:16]) for case in cases}
    assert status["second"] == ("failed", "RuntimeError: no") and status["first"] == ("passed", "")
    assert "of 3: second: RuntimeError: no" in capsys.readouterr().out
    published.problem = ""
    publish_in(tmp_path)
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
    before = publish_in(tmp_path)
    where = {"out": tmp_path / "out", "store": tmp_path / "store", "workers": 2}
    assert publishing.publish([], level="quick", **where) == 2
    assert "out holds a report of level full: choose another folder" in capsys.readouterr().err
    assert publish_in(tmp_path) == before


def test_a_case_that_belongs_to_another_level_now_is_left_out(tmp_path, published, monkeypatch):
    publish_in(tmp_path)
    monkeypatch.setattr(FakeCase, "published_at", lambda case, _: case.name != "second")
    assert not any(name.startswith("second") for name in publish_in(tmp_path))
