# SPDX-License-Identifier: MIT
"""The headline of the pages: what it says of made studies, and of studies that did not run."""

from dataclasses import replace

import numpy as np
import pytest
from made_histories import as_the_paper_says
from made_studies import GOOD, over_inputs, over_physics, verdicts
from page_checks import PageReader, faults_of

from verification.cases import all_cases
from verification.cases.running_in import running_in_physics, running_in_sensitivity
from verification.cases.running_in.study import BULK, HARDENING, STATEMENTS
from verification.runs.files import plain
from verification.suite.pages import write_report
from verification.suite.pages.answers import Evidence, statements as of_paper
from verification.suite.pages.headline import COLUMNS, MEANING, NOTHING, headline_of
from verification.suite.pages.judged import (
    FINER,
    INPUTS,
    NOT_RUN,
    PHYSICS,
    READINGS,
    WORDS,
    Judged,
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
    figure = dict.fromkeys(("title", "alt", "caption", "csv"), "") | {"embedded": True}
    own = ("probabilities", "volume")
    figures = [figure | {"png": f"figures/{name}-{each}.png"} for each in own]
    made = {"name": name, "seconds": 1.0, "tables": shown, "figures": figures, "data": plain(data)}
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


def test_each_statement_has_a_row_with_what_decides_it_and_what_makes_it_hold(readings, studies):
    found = headline_of(read_stored(stored(readings, *studies)))
    rows = {row[1].partition(" (")[0]: dict(zip(COLUMNS, row, strict=True)) for row in found.rows}
    assert list(rows) == [each.words for each in STATEMENTS]
    assert found.rows[0][1].endswith("(V(6)/V(25) ≥ 0.9)")
    held, failed = rows["curve A: friction falls"], rows[NEVER]
    assert held["printed inputs"] == "held, 3 of 3" and held["what makes it hold"] == ""
    assert (
        held["share of points (90 %)"].startswith("50 %") and "deviation of the layer" in held["decided by"]
    )
    assert held["holds under"] == "24 of 24"
    assert failed["printed inputs"].startswith("failed") and failed["what makes it hold"] == NOTHING
    assert failed["holds under"] == "0 of 24" and failed["share of points (90 %)"].startswith("0 %")
    assert rows["curve B: still wears linearly"]["holds under"] == "1 of 24"
    assert rows["hardening: wears as much as bulk"]["what makes it hold"] == "the second reading"
    plain, *others = running_in_physics.ALL.values()
    assert set(WORDS) == {key for each in others for key in each} - set(plain)
    (good,) = Judged(read_stored(stored(*studies))).under("curve B: still wears linearly")
    assert good == tuple(WORDS[each] for each in reversed(running_in_physics.ALL[GOOD]))


def said(headline):
    return " ".join([headline.answer, *(text for _, text in headline.depends)])


def test_the_answer_counts_what_the_tables_hold_and_the_index_and_the_page_begin_with_it(
    readings, studies, tmp_path
):
    results = stored(readings, *studies)
    found = headline_of(read_stored(results))
    text = said(found)
    assert text.startswith("In part. With the printed inputs, 15 of its 17 statements")
    assert "of the 15 independent ones 13 hold, in the second reading 14." in text and "curve C" in text
    assert "(a soft layer) 16 and 16" in text and "40 points, 5 materials" in text
    assert "deviation of the layer, factor (" in text and f"1 holds ({NEVER}) under nothing" in text
    assert "In the study over hardening and loading cycles 21 to 25 add more than 0.1 %" in text
    assert [each["png"][19:-4] for each in found.pictures] == [
        *("sensitivity-probabilities", "physics-volume")
    ]
    write_report(results, tmp_path)
    page, index = (
        PageReader((tmp_path / name).read_text(encoding="utf-8"))
        for name in ("running-in.html", "index.html")
    )
    for each in (page, index):
        assert faults_of(each) == [] and found.answer[:80] in each.text and MEANING[:40] in each.text
    assert page.text.index(found.question) < page.text.index("Closest to its limit")
    (*_, most, under) = of_paper(Evidence(read_stored(results), []), "")
    assert most.value == under.value == "15 of 17"


def test_what_finer_cells_refute_and_the_pressures_that_remove_metal_are_said(readings, studies):
    said_so = as_the_paper_says()
    busy = {**said_so, BULK: replace(said_so[BULK], volume=1e-18 * np.arange(1.0, 26.0))}
    finer = record(FINER, statements(coarse=verdicts([said_so]), fine=verdicts([busy])))
    regimes = {
        "hard": {"removed_from": 9.87e9, "film_fails_from": 3.42e9, "reached": 10.2e9},
        "lost": {"removed_from": 2.0e9, "film_fails_from": 3.5e9, "reached": None},
    }

    def text(*rest_from):
        last = {"bulk": {"rest_from": [3.0]}, "hard": {"rest_from": rest_from}}
        found = {name: {"printed inputs": own} for name, own in (("regimes", regimes), ("last_cycle", last))}
        read = {**readings, "data": readings["data"] | found}
        return said(headline_of(read_stored(stored(read, *studies, finer))))

    assert "1 of these 13 (bulk: worn in the first six cycles) failed on finer cells" in text()
    assert "not counting such, 12 of 15 hold." in text()
    assert "above 9.87 (hard), 2.00 (lost) GPa; films fail from 3.42 GPa" in text()
    assert "reaches 10.20 GPa (median)" in text()
    assert "anew in the last cycle in 1 of 3 runs" in text(None, 7.0)
    assert "no cell strains anew in the last cycle in any of 2 runs" in text(7.0)


def test_a_study_that_did_not_run_is_said_not_to_have_run(readings, studies):
    found = headline_of(read_stored(stored(readings)))
    text = said(found)
    assert all(f"(case {name}) did not run." in text for name in (INPUTS, PHYSICS))
    assert {row[4] for row in found.rows} == {row[6] for row in found.rows} == {NOT_RUN}
    assert found.pictures == [] and headline_of(read_stored(stored())) is None
    short = record(INPUTS, {})
    assert headline_of(read_stored(stored(short))) is None
    assert "was made without" in said(headline_of(read_stored(stored(readings, short))))
    (_, of_physics) = studies
    found = headline_of(read_stored(stored(of_physics)))
    assert {row[2] for row in found.rows} == {NOT_RUN} and len(found.rows) == len(STATEMENTS)
