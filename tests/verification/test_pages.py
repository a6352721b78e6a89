# SPDX-License-Identifier: MIT
"""The pages: whether they can be read, and whether their answers are those of the results."""

import copy
import json
import re
from fnmatch import fnmatch
from importlib import resources
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from page_checks import PageReader, broken_links, contrast, faint, faults_of

from sam.scene import load_scene
from verification.cases import all_cases
from verification.figures.agreement import agreement
from verification.figures.check import findings
from verification.rows import load_rows
from verification.suite.pages import write_report
from verification.suite.pages.agreement import BEYOND
from verification.suite.pages.answers import KINDS, RESULT, answers_of, far, kind_of, sentence
from verification.suite.pages.costs import CASE, costs_of
from verification.suite.pages.findings import Cell, Evidence, Held, Largest, TimeTo, Value
from verification.suite.pages.groups import GROUPS, group_of
from verification.suite.pages.literature import works
from verification.suite.pages.mathml import formula, with_scripts
from verification.suite.pages.pairs import Pair, pairs_of, tabled
from verification.suite.pages.questions import QUESTIONS
from verification.suite.pages.stored import read_stored
from verification.suite.pages.views import brief

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ROOT / "reports"
MEGABYTE = 1e6
FIRST_SCREEN = 1500
"""Characters of text that the first screen of 1280 × 800 pixels shows for sure, with the navigation."""
CSS = resources.files("verification.suite").joinpath("templates", "pages.css").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def published() -> dict[str, PageReader]:
    return {path.name: PageReader(path.read_text(encoding="utf-8")) for path in REPORTS.glob("*.html")}


@pytest.fixture(scope="module")
def results() -> dict:
    return json.loads((REPORTS / "results.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def evidence(results) -> Evidence:
    stored = read_stored(results)
    return Evidence(stored, pairs_of(stored))


# what can be read


def test_published_pages_are_sound(published):
    assert len(published) >= 10
    assert {name: faults_of(page) for name, page in published.items() if faults_of(page)} == {}
    assert broken_links(published, REPORTS) == []
    titles = [page.title for page in published.values()]
    assert len(set(titles)) == len(titles) and all(titles)


def test_published_files_are_small():
    sizes = {path: path.stat().st_size for path in REPORTS.rglob("*") if path.is_file() and not _latest(path)}
    assert max(sizes.values()) < 2 * MEGABYTE and sum(sizes.values()) < 15 * MEGABYTE


def _latest(path: Path) -> bool:
    return path.relative_to(REPORTS).parts[0].startswith("latest")


def test_the_first_screen_holds_the_answer(published, evidence):
    for name, page in published.items():
        text = re.sub(r"\s+", " ", page.text)[:FIRST_SCREEN]
        if name == "index.html":
            assert sentence(evidence.stored, evidence.pairs) in text
        elif name != "report.html":
            assert re.search(
                r"((All [0-9]+ cases hold|The case holds): no gate|[0-9]+ of [0-9]+ cases) failed\.", text
            ), name


def test_every_page_leads_to_all_others(published):
    pages = set(published) - {"report.html"}
    for name in pages:
        assert pages <= {each.get("href") for each in published[name].all("a")}, name


def test_tables_scroll_inside_and_colours_stand_out():
    assert faint(CSS) == []
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0) and contrast("#777777", "#ffffff") < 4.5
    assert ".scroll { overflow-x: auto" in CSS and "@media print" in CSS


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<h1>A</h1><p><table></table></p>", "<table> in a paragraph"),
        ("<h1>A</h1><h3>B</h3>", "a heading of level 3"),
        ("<h1>A</h1><h1>B</h1>", "not one heading"),
        ("<h1>A</h1><div>", "<div> is not closed"),
        ("<h1>A</h1></div>", "</div> closes"),
        ('<h1>A</h1><img src="a.png" alt="">', "a.png without a text"),
        ('<h1 id="a">A</h1><p id="a"></p>', "id a twice"),
        ('<h1>A</h1><a href="b"><a href="c"></a></a>', "<a> in a link"),
        ("<h1>A</h1><script></script>", "a script"),
    ],
)
def test_a_fault_is_seen(text, fault):
    assert any(each.startswith(fault) for each in faults_of(PageReader(text)))


def test_a_broken_link_and_a_faint_colour_are_seen(tmp_path):
    page = PageReader('<h1 id="here">A</h1><a href="#here"></a><a href="none.html"></a><a href="#there"></a>')
    assert broken_links({"a.html": page}, tmp_path) == ["a.html: none.html", "a.html: #there"]
    assert faint(CSS.replace("--soft: #4f5863", "--soft: #9fa8b3", 1)) == ["light: soft on paper"]


# formulas


@pytest.mark.parametrize(
    ("line", "markup"),
    [
        ("σ_vM", '<msub><mi>σ</mi><mrow><mi mathvariant="normal">vM</mi></mrow></msub>'),
        ("a³", "<msup><mi>a</mi><mrow><mn>3</mn></mrow></msup>"),
        ("a/R", "<mfrac><mrow><mi>a</mi></mrow><mrow><mi>R</mi></mrow></mfrac>"),
        ("3F/(4E)", "<mrow><mn>4</mn><mi>E</mi></mrow></mfrac>"),
        ("√(1 − x)", "<msqrt><mn>1</mn>"),
        ("σzz", "<msub><mi>σ</mi><mrow><mi>z</mi><mi>z</mi></mrow></msub>"),
        ("w*^1.425", "<mrow><mo>*</mo><mn>1.425</mn></mrow></msup>"),
        ("tr(ε)", "<mi>tr</mi>"),
    ],
)
def test_a_formula_has_real_scripts(line, markup):
    assert markup in formula(line)


def test_words_stay_words_and_nothing_of_a_formula_is_lost():
    for case in all_cases().values():
        for _, line, _ in case.equations:
            markup = f"<p>{formula(line)}</p>"
            read = "".join(ElementTree.fromstring(markup).itertext())
            kept, asked = ({k for k in text if k.isascii() and k.isalnum()} for text in (read, line))
            assert asked <= kept, line
    assert formula("bonded film at z ≥ h").startswith("bonded film at <math>")
    assert with_scripts("p₀/σ_y0 < 2, p_max") == "p₀/σ<sub>y0</sub> &lt; 2, p<sub>max</sub>"


# questions and their gates


def test_every_question_asks_for_gates_and_cases_that_there_are():
    gates, cases = [gate.id for gate in load_rows()], all_cases()
    pages = {group.name for group in GROUPS}
    for question in QUESTIONS:
        assert question.page in pages and question.words.endswith("?")
        for part in question.parts:
            patterns = part.gates if isinstance(part, Largest | Held) else ()
            patterns += (part.gate,) if isinstance(part, Value) else ()
            assert all(any(fnmatch(gate, pattern) for gate in gates) for pattern in patterns), part
            asked = [case for case, _ in part.rows] if isinstance(part, Largest) else []
            asked += [CASE] if isinstance(part, TimeTo) else []
            assert all(any(fnmatch(case, pattern) for case in cases) for pattern in asked), part


def test_failed_gates_are_told_apart_by_what_they_are_about(results):
    gates, cases = [gate.id for gate in load_rows()], all_cases()
    for name in [name for names in KINDS.values() for name in names]:
        assert any(fnmatch(gate, name) for gate in gates), name
    assert all(any(fnmatch(case, pattern) for case in cases) for pattern, *_ in BEYOND)
    assert kind_of("peers.same-solution") == kind_of("hertz-sphere.pressure") == RESULT
    assert kind_of("peers.step-16") == "a cost"
    held = copy.deepcopy(results)
    for gate in held["gates"]:
        gate["status"] = "passed"
    for case in held["cases"]:
        case["status"] = "passed"
    assert "none failed; of" in sentence(read_stored(held), pairs_of(read_stored(held)))
    one = copy.deepcopy(held)
    one["cases"][0]["status"] = "not run"
    assert sentence(read_stored(one), pairs_of(read_stored(one))).endswith(" 1 further case: 1 did not run.")
    for gate, words in (
        ("peers.step-16", "1 failed (none about a result; 1 about a cost)"),
        ("peers.same-solution", "1 failed (1 about a result)"),
    ):
        stored = read_stored(changed(held, gate, status="failed"))
        assert words in sentence(stored, pairs_of(stored))


def test_what_is_far_off_says_why():
    def pair(name, quantity, sam, gate=None):
        return Pair(table_of(rows=[], name=name).ran[name], quantity, "FEM", sam, 1.0, gate)

    gate = {"tolerance": 0.1, "reason": "because"}
    found = far(
        [
            pair("figure-8-3", "largest plastic strain (μ = 0.4)", 1.06),
            pair("energy-fem", "stored energy", 0.92, gate),
            pair("energy-fem", "work [J]", 1.2),
            pair("hertz-sphere", "approach", 1.04),
        ]
    )
    assert [each.quantity for each in found] == ["work", "stored energy", "largest plastic strain (μ = 0.4)"]
    assert [each.why for each in found[:2]] == ["no gate", "its gate allows 10 %: because"]
    assert found[2].why.startswith("no gate; at this friction")


def test_the_sphere_that_the_limits_are_compared_with_is_that_of_the_pages():
    """a/R = pi p0/(2 E*) of Hertz."""
    scene = load_scene(ROOT / "verification" / "scenes" / "plastic-swift-rigid.toml")
    first = scene.body.plasticity.strength().least(0.0)
    at_4, at_6 = (np.pi * p * first / (2 * scene.body.young / (1 - scene.body.poisson**2)) for p in (4, 6.2))
    (note,) = (each.note for each in QUESTIONS if each.page == "limits")
    assert f"a/R = {at_4:.2f} at p₀ = 4 σ_y0 and {at_6:.2f} at 6.2 σ_y0" in note


def test_costs_are_those_of_the_fastest_elements():
    times = [
        ["one", "SAM", "0.5 (8)", "a"],
        ["one", "FEM, 3D", "3.11 (4)", ""],
        ["one", "FEM, axisymmetric", "< 1.5 (2)", ""],
        ["two", "SAM", "not reached (2 %)", ""],
        ["two", "FEM, 3D", "7 (6)", ""],
    ]
    stored = table_of("problem", "method", "1 %", "kernels", rows=times, name=CASE)
    stored.ran[CASE].case["tables"].append(
        {"caption": "", "columns": ("problem", "quantity (SI)", "value"), "rows": [["one", "load", "1"]]}
    )
    one, two = costs_of(stored)
    assert one.row == ("one", "load", "0.5", "< 1.5", "< 3", "axisymmetric")
    assert two.row == ("two", "", "not reached", "7", "", "3D")
    (found,) = TimeTo().find(Evidence(stored, []))
    assert found.value == "< 3 to < 3 times" and "1 of 2 contacts" in found.words


def test_every_case_has_a_page():
    assert {group_of(case).name for case in all_cases()} == {group.name for group in GROUPS}
    assert group_of("none").name == "other"


def test_the_published_index_answers_every_question(evidence):
    answers = answers_of(evidence)
    silent = [answer.question for answer in answers if not answer.findings]
    assert [question.words for question in silent if not question.parts] == [
        "What was compared with measurement?"
    ]
    asked = {name for question in silent for name in _gates_of(question)}
    assert not asked & {gate["id"] for gate in evidence.stored.gates}
    assert {name for answer in answers for name in answer.red} <= {g["id"] for _, g in evidence.stored.red}


def _gates_of(question):
    """The gates that a question asks for."""
    patterns = [name for part in question.parts for name in getattr(part, "gates", ())]
    patterns += [part.gate for part in question.parts if isinstance(part, Value)]
    return [gate.id for gate in load_rows() if any(fnmatch(gate.id, pattern) for pattern in patterns)]


def answer_to(results, words):
    stored = read_stored(results)
    answers = answers_of(Evidence(stored, pairs_of(stored)))
    return next(answer for answer in answers if answer.question.words.startswith(words))


def changed(results, gate, **values):
    new = copy.deepcopy(results)
    next(each for each in new["gates"] if each["id"] == gate).update(values)
    return new


def test_an_answer_is_the_worst_of_its_gates(results):
    words, gate = "Do both models agree on rough", "rough-contact-0-2.load-3"
    (load, *_) = answer_to(results, words).findings
    assert load.allowed == "≤ 1\N{NO-BREAK SPACE}%"
    assert load.worst.name != "rough-contact-0-2" and load.red == ()
    (load, *_) = answer_to(changed(results, gate, error=0.031, status="failed"), words).findings
    assert (load.value, load.worst.name, load.red) == ("3.1\N{NO-BREAK SPACE}%", "rough-contact-0-2", (gate,))
    assert answer_to(changed(results, gate, status="failed"), words).status == "failed"


def test_what_did_not_run_is_not_answered(results):
    new = copy.deepcopy(results)
    for case in new["cases"]:
        case["status"] = "not run" if case["name"] == "peers" else case["status"]
    answer = answer_to(new, "Which other programs")
    assert (answer.findings, answer.status, answer.cost) == ([], "not run", "")


def test_pairs_are_those_of_gates_and_tables(results):
    stored = read_stored(results)
    case = stored.ran["plastic-swift-rigid-4"]
    pairs = {pair.quantity: pair for pair in pairs_of(stored) if pair.case is case}
    gate = next(gate for gate in case.gates if gate["id"].endswith(".peeq-max"))
    assert abs(pairs[gate["quantity"]].error) == pytest.approx(gate["error"])
    assert pairs["approach [nm]"].error == pytest.approx(145.73 / 145.78 - 1.0)
    assert not any("solution" in name or "depth" in name for name in pairs)
    sliding = [pair.quantity for pair in pairs_of(stored) if pair.case.name == "figure-8-3"]
    assert "largest plastic strain (μ = 0.4)" in sliding


@pytest.mark.parametrize(
    ("caption", "short"),
    [
        ("What the paper says of its Figures. By the median: more", "What the paper says of its Figures"),
        (
            "As printed: median and range over the surfaces; early: after 6",
            "As printed: median and range over the surfaces",
        ),
        (
            "Worn volume after one cycle and after five, median and range of the surfaces",
            "Worn volume after one cycle and after five, median and …",
        ),
        ("First and last cycle", "First and last cycle"),
    ],
)
def test_a_caption_in_few_words(caption, short):
    assert brief(caption) == short


def test_increments_that_fall_to_zero_are_no_pairs():
    rows = [["Swift", "SAM", "0.2000", "0.0010"], ["Swift", "FEM", "0.2010", "0.0004"]]
    columns = ("law", "model", "cycle 1", "cycle 4")
    caption = "Strain that a cycle adds in %, and the verdict"
    assert list(tabled(table_of(*columns, rows=rows, caption=caption).ran["running-in"])) == []
    assert len(list(tabled(table_of(*columns, rows=rows).ran["running-in"]))) == 2


def table_of(*columns, rows, caption="What it says. A note", name="running-in"):
    case = {"name": name, "title": "", "status": "passed", "failure": "", "seconds": 1.0, "notes": []}
    case |= {"question": "", "equations": [], "figures": [], "runs": [], "setup": []}
    case["tables"] = [{"caption": caption, "columns": columns, "rows": rows}]
    source = {"commit": "abc", "time_utc": "2026-01-01", "input_sha256": {}}
    return read_stored({"provenance": source, "cases": [case], "gates": []})


def test_literature_has_what_the_equations_name():
    named = "\n".join(text for case in all_cases().values() for row in case.equations for text in row)
    marks = [work for work in works() if re.search(work.mark, named)]
    assert len(marks) >= 20 and all(
        re.fullmatch(r"(10\.[0-9]{4,}/\S+|not confirmed)?", work.doi) for work in works()
    )


@pytest.fixture(scope="module")
def one_case(results) -> dict:
    few = copy.deepcopy(results)
    few["cases"] = [case for case in few["cases"] if case["name"] == "hertz-sphere"]
    return few


def test_what_is_older_than_the_code_is_marked(one_case, tmp_path):
    write_report(one_case, tmp_path, stale={"hertz-sphere": "its scene has changed"})
    marked = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.glob("*.*")}
    assert "Older than the code: its scene has changed." in marked["elastic.html"]
    assert (
        "1 case is older than the code" in marked["index.html"] and "1 case is older" in marked["README.md"]
    )
    write_report(one_case, tmp_path)
    assert "older than the code" not in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_pages_in_other_places_link_no_scene(one_case, tmp_path):
    """A link out of the folder would name a place of the machine."""
    page = PageReader(write_report(one_case, tmp_path).with_name("elastic.html").read_text(encoding="utf-8"))
    assert "hertz-sphere.toml" in page.text
    assert not [each["href"] for each in page.all("a") if each["href"].endswith(".toml")]


def test_the_picture_of_all_pairs_can_be_read(evidence):
    assert len(evidence.pairs) > 200
    assert findings(agreement([_row(pair) for pair in evidence.pairs]).figure) == []
    assert findings(agreement([_row(pair) for pair in evidence.pairs[:3]]).figure) == []


def _row(pair):
    return pair.page, pair.against, pair.predicted, pair.reference, pair.case.name, pair.quantity


def test_every_row_of_a_table_that_answers_is_there(evidence):
    cells = [part for each in QUESTIONS for part in each.parts if isinstance(part, Cell)]
    ran = [part for part in cells if part.case in evidence.stored.ran]
    assert ran and [part for part in ran if len(list(part.find(evidence))) != 1] == []


def test_cells_of_a_table_answer_and_have_a_gate_only_where_it_is_named():
    table = {"caption": "Rough: each", "columns": ["grid", "program", "ratio", "off"]}
    table["rows"] = [
        ["512²", "aspher", "2", "-8.07%"],
        ["1024²", "SAM", "1", "5"],
        ["1024²", "aspher", "3", "6"],
    ]
    gate = {"id": "peers.rough", "metric": "at_least", "tolerance": 2.0, "status": "failed"}
    ran = {"peers": SimpleNamespace(case={"tables": [table]}, name="peers", gates=[gate])}
    evidence = Evidence(SimpleNamespace(ran=ran), ())

    def found(case, grid, columns=("ratio",), **how):
        return list(Cell("aspher", case, "Rough", (grid, "aspher"), columns, **how).find(evidence))

    (one,) = found("peers", "1024²", shown="{} times")
    assert one.value == "3 times" and not one.gated and one.allowed == "no gate"
    (two,) = found("peers", "1024²", ("ratio", "off"), shown="{} ({})", gate="peers.rough")
    assert two.value == "3 (6)" and two.gated and two.allowed == "≥ 2" and two.red == ("peers.rough",)
    (three,) = found("peers", "512²", ("off",))
    assert three.value == "\N{MINUS SIGN}8.07\N{NO-BREAK SPACE}%"
    assert not found("peers", "256²") and not found("other", "1024²")
