# SPDX-License-Identifier: MIT
"""The pages: whether they can be read, and whether their answers are those of the results."""

import json
import re
from fnmatch import fnmatch
from pathlib import Path
from xml.etree import ElementTree

import pytest
from page_checks import PageReader, broken_links, faults_of

from verification.cases import all_cases
from verification.rows import load_rows
from verification.suite.pages.answers import (
    PARTS,
    Evidence,
    answers_of,
    cell,
    pairs_of,
)
from verification.suite.pages.mathml import formula, with_scripts
from verification.suite.pages.site import works
from verification.suite.pages.stored import GROUPS, PAGES, group_of, read_stored

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
    return evidence_of(results)


def evidence_of(results) -> Evidence:
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
    assert max(sizes) < 2 * MEGABYTE and sum(sizes) < 15 * MEGABYTE


def test_words_stay_words_and_nothing_of_a_formula_is_lost():
    for case in all_cases().values():
        for _, line, _ in case.equations:
            read = "".join(ElementTree.fromstring(f"<p>{formula(line)}</p>").itertext())
            kept, asked = ({k for k in text if k.isascii() and k.isalnum()} for text in (read, line))
            assert asked <= kept, line
    assert formula("bonded film at z ≥ h").startswith("bonded film at <math>")
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
