# SPDX-License-Identifier: MIT
"""The headline of the pages: what it says of made studies, and of studies that did not run."""

from dataclasses import replace

import pytest
from made_histories import as_the_paper_says
from made_studies import over_inputs, over_physics, verdicts
from page_checks import PageReader, faults_of

from verification.cases import all_cases
from verification.cases.running_in import running_in_physics, running_in_sensitivity
from verification.cases.running_in.study import BULK, HARDENING, STATEMENTS
from verification.runs.files import plain
from verification.suite.pages import write_report
from verification.suite.pages.headline import (
    COLUMNS,
    MEANING,
    READINGS,
    WORDS,
    headline_of,
)
from verification.suite.pages.stored import read_stored

NEVER = "hardening: still wears slowly"


def record(name, data, tables=(), notes=(), setup=()):
    """A case that ran, as in results.json."""
    shown = [
        {"caption": t.caption, "columns": list(t.columns), "rows": [list(r) for r in t.rows]} for t in tables
    ]
    words = {"title": name, "question": "", "failure": "", "status": "passed", "reused": None}
    lists = {"equations": [], "runs": [], "setup": list(map(list, setup)), "notes": list(notes)}
    made = {"name": name, "seconds": 1.0, "tables": shown, "figures": [], "data": plain(data)}
    return made | words | lists


def statements(**judged):
    return {"statements": judged}


def stored(*cases):
    source = {"commit": "abc", "time_utc": "2026-01-01", "input_sha256": {}}
    return {"provenance": source, "cases": list(cases), "gates": [], "level": "full"}


@pytest.fixture(scope="module")
def readings():
    """As the paper says, but the hardening case: first it does not wear, then as bulk does."""
    said = as_the_paper_says()
    still = {**said, HARDENING: replace(said[HARDENING], volume=0.0 * said[HARDENING].volume)}
    early = {**said, HARDENING: replace(said[HARDENING], volume=said[BULK].volume)}
    found = statements(**{"printed inputs": verdicts([still] * 3), "renewed": verdicts([early] * 3)})
    return record(READINGS, found | {"second_reading": "a soft layer"})


@pytest.fixture(scope="module")
def studies():
    """Of inputs and of physics, with one statement that holds nowhere."""
    hardening = as_the_paper_says()[HARDENING]
    never = {HARDENING: replace(hardening, volume=0.0 * hardening.volume)}
    made = (running_in_sensitivity, over_inputs(**never)), (running_in_physics, over_physics(**never))
    return [
        record(case.name, *(part(found) for part in (case.data, case.tables, case.notes, case.setup)))
        for case, found in ((all_cases()[study.CASES[0].name], found) for study, found in made)
    ]


def test_the_readings_of_the_words_are_counted(readings):
    found = headline_of(read_stored(stored(readings, record(WORDS, readings["data"]))))
    assert found.brief.endswith(" In 2 readings of its words 15 to 16 of 17 hold.")


def test_each_statement_has_a_row_with_what_decides_it_and_where_it_holds(readings, studies):
    found = headline_of(read_stored(stored(readings, *studies)))
    rows = {row[1].partition(" (")[0]: dict(zip(COLUMNS, row, strict=True)) for row in found.rows}
    assert list(rows) == [each.words for each in STATEMENTS]
    assert found.rows[0][1].endswith("(V(6)/V(25) ≥ 0.9)")
    held, failed = rows["curve A: friction falls"], rows[NEVER]
    assert held["printed inputs"] == "held, 3 of 3" and held["holds under"] == "24 of 24"
    assert held["share of points (90 %)"].startswith("50 %")
    assert "deviation of the layer" in held["decided by"]
    assert failed["printed inputs"].startswith("failed") and failed["holds under"] == "0 of 24"
    assert failed["share of points (90 %)"].startswith("0 %")
    assert rows["curve B: still wears linearly"]["holds under"] == "1 of 24"


def test_the_answer_counts_what_the_data_hold_and_the_index_and_the_page_say_it(readings, studies, tmp_path):
    results = stored(readings, *studies)
    found = headline_of(read_stored(results))
    assert found.answer.startswith("In part. With the printed inputs, 15 of its 17 statements")
    assert "of the 15 independent ones 13 hold, in the second reading 14." in found.answer
    assert "(a soft layer) 16 and 16" in found.answer
    assert "first on deviation of the layer, factor (" in found.depends
    assert "of 24 ways to harden and to load it, 15 hold together at best" in found.depends
    inputs, physics = studies
    none = {**inputs, "data": inputs["data"] | {"best": 0}}
    without = headline_of(read_stored(stored(readings, none, physics))).depends
    assert "At the best of the points" in found.depends and "At the best of the points" not in without
    write_report(results, tmp_path)
    names = "running-in.html", "index.html"
    page, index = (PageReader((tmp_path / name).read_text(encoding="utf-8")) for name in names)
    assert faults_of(page) == faults_of(index) == []
    assert found.answer[:80] in index.text and MEANING[:40] not in index.text
    places = [page.text.index(words[:40]) for words in (found.answer, found.depends, MEANING)]
    assert sorted(places) == places and places[-1] < page.text.index("Gate closest to its tolerance")
