# SPDX-License-Identifier: MIT
"""The pages, README and the guide can be read, have the numbers of the results, and name no machine."""

import copy
import json
import re
from fnmatch import fnmatch
from pathlib import Path
from xml.etree import ElementTree

import pytest
from made_histories import as_the_paper_says, verdicts
from page_checks import PageReader, broken_links, faults_of

from verification.cases import all_cases
from verification.rows import load_rows
from verification.suite.pages.answers import PARTS, Evidence, answers_of, cell, pairs_of
from verification.suite.pages.site import formula, with_scripts, works
from verification.suite.pages.stored import GROUPS, PAGES, group_of, read_stored, share_used
from verification.suite.readme import renewed

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ROOT / "reports"
MEGABYTE = 1e6


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


@pytest.mark.skipif(not (REPORTS / "figures").is_dir(), reason="a source distribution has no figures")
def test_published_pages_are_sound_small_and_lead_to_each_other(published):
    assert len(published) >= 10
    assert {name: faults_of(page) for name, page in published.items() if faults_of(page)} == {}
    assert broken_links(published, REPORTS) == []
    titles = [page.title for page in published.values()]
    assert len(set(titles)) == len(titles) and all(titles)
    pages = set(published) - {"report.html"}
    for name in pages:
        assert pages <= {each.get("href") for each in published[name].all("a")}, name
    files = [path for path in REPORTS.rglob("*") if path.is_file()]
    sizes = [path.stat().st_size for path in files if "latest" not in path.relative_to(REPORTS).parts[0]]
    assert max(sizes) < 2 * MEGABYTE and sum(sizes) < 15 * MEGABYTE  # a clone stays quick


def test_words_stay_words_and_nothing_of_a_formula_is_lost():
    for case in all_cases().values():
        for _, line, _ in case.equations:
            read = "".join(ElementTree.fromstring(f"<p>{formula(line)}</p>").itertext())
            kept, asked = ({k for k in text if k.isascii() and k.isalnum()} for text in (read, line))
            assert asked <= kept, line
    assert formula("dε_p ≤ E* w^(1 + w*^2), layer_thickness") == (
        "dε<sub>p</sub> ≤ E* w<sup>1 + w*<sup>2</sup></sup>, layer_thickness"
    )
    assert with_scripts("p₀/σ_y0 < 2, p_max") == "p₀/σ<sub>y0</sub> &lt; 2, p<sub>max</sub>"


# questions and their gates


def test_every_question_asks_for_gates_and_cases_that_there_are():
    gates, cases = [gate.id for gate in load_rows()], all_cases()
    pages = {group["name"] for group in GROUPS}

    def there(pattern: str, names) -> bool:
        return any(fnmatch(name, pattern) for name in names)

    for question in PAGES["question"]:
        assert question["page"] in pages and question["words"].endswith("?")
    parts = [part for question in PAGES["question"] for part in question.get("parts", ())]
    for kind, _, *part in parts + [part for _, *part in PAGES["first"]["numbers"]]:
        assert kind in PARTS
        if kind in ("largest", "held", "range"):
            for pattern in part[: 1 if kind == "range" else None]:
                case, begin, _ = pattern.partition(": ")
                assert there(case, cases if begin else gates), pattern
        elif kind in ("value", "percent"):
            assert part[0] in gates
        elif kind == "cell":
            assert part[0] in cases and set(part[5:]) <= set(gates)
    assert all(there(name, gates) for names in PAGES["kinds"].values() for name in names)
    assert all(there(case, cases) for key in ("beyond", "singular") for case, *_ in PAGES["pairs"][key])
    assert {group_of(case)["name"] for case in all_cases()} == pages - {"other"}
    assert group_of("none")["name"] == "other"
    named = "\n".join(text for case in all_cases().values() for row in case.equations for text in row)
    assert len([work for work in works() if re.search(work["mark"], named)]) >= 20
    assert all(re.fullmatch(r"(10\.[0-9]{4,}/\S+)?", work["doi"]) for work in works())


def test_the_published_index_answers_every_question(evidence):
    answers = answers_of(evidence)
    silent = [answer for answer in answers if not answer.findings]
    open_ = [answer.question["words"] for answer in silent if answer.status == "open"]
    assert open_ == ["What was compared with measurement?"]
    assert {name for answer in answers for name in answer.red} <= {g["id"] for _, g in evidence.stored.red}
    for question in PAGES["question"]:
        for kind, *part in question.get("parts", ()):
            if kind == "cell" and part[1] in evidence.stored.ran:
                assert len(list(cell(evidence, *part))) == 1, part


# nothing names the machine that wrote it


TEXTS = {".html", ".json", ".csv", ".xml", ".svg", ".md", ".toml", ".vtu"}
EMBEDDED = re.compile(r"base64,[A-Za-z0-9+/=\s]+")
OF_A_MACHINE = re.compile(
    r"(?<![\w.:/<])/(?:tmp|home|root|work|usr|opt|var|mnt|srv|data|Users|private)/[\w.+-]+|\b[A-Za-z]:\\[\w.+-]+"
)


def test_nothing_published_names_a_machine():
    """No text file has an absolute path."""
    for path in REPORTS.rglob("*"):
        if path.is_file() and path.suffix in TEXTS:
            text = EMBEDDED.sub("", path.read_text(encoding="utf-8"))
            assert OF_A_MACHINE.findall(text) == [], path


# README and guide


README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("page", ["README.md", "docs/guide/which-model.md"])
def test_the_numbers_are_those_of_the_published_pages(results, page):
    """Of a report of an older version all but the answer about running-in: its cases have no data."""
    text = (ROOT / page).read_text(encoding="utf-8")
    texts = [renewed(text, results), text]
    if not any("data" in case for case in results["cases"]):
        texts = [
            re.sub(r"\n- \[Does the model of running-in.*?(?=\n<!--)", "", t, flags=re.DOTALL) for t in texts
        ]
    assert texts[0] == texts[1]


def test_failed_gates_are_named_and_counted(results):
    none = copy.deepcopy(results)
    for gate in none["gates"]:
        gate["status"] = "passed" if gate["status"] == "failed" else gate["status"]
    for case in none["cases"]:
        case["status"] = "passed" if case["status"] == "failed" else case["status"]
    assert "Every gate of the published pages holds." in renewed(README, none)
    running_in = next(case for case in none["cases"] if case["name"] == "running-in")
    running_in["data"] = {"statements": {"printed inputs": verdicts([as_the_paper_says()])}}
    next(case for case in none["cases"] if case["name"] == "pavement")["status"] = "failed"
    assert "have a figure that cannot be read: `pavement`." in " ".join(renewed(README, none).split())
    fox = next(gate for gate in none["gates"] if gate["id"] == "pavement.fox")
    fox.update(status="failed", error=2.0, tolerance=1.0)
    one = renewed(README, none)
    assert "One gate fails on the published pages: `pavement.fox` (2 against \u2264 1)." in one
    words = "Yes. With the printed inputs, and ours where none are printed, 17 of its 17 statements"
    assert words in " ".join(one.split())


def test_a_share_of_one_uses_nothing_of_its_lower_bound():
    of = [share_used({"metric": "at_least", "tolerance": 0.8, "error": value}) for value in (0.9, 1.0)]
    assert of == [8 / 9, None]
