# SPDX-License-Identifier: MIT
"""The case uncertainty: its scenes, what counts, and that another rule turns it red."""

from dataclasses import replace

import pytest
from made_results import context, red

from verification.suite.cases import uncertainty, uncertainty_study as study
from verification.suite.cases.uncertainty import Found
from verification.suite.cases.uncertainty_study import Row, covered, of_program, of_textbook
from verification.suite.judging import Measured

CASE = "uncertainty"


@pytest.fixture(scope="module")
def rows(tmp_path_factory) -> list[Row]:
    """Hertz's sphere on two triplets, without the scenes that need finite elements."""
    where = context(CASE, tmp_path_factory.mktemp("case"))
    return list(study.rows_of(where, study.subjects(where, study=False)[0]))


def gates(rows, rule=of_program) -> set[str]:
    found = Found(rows)
    values = dict(uncertainty.CASES[0].measure(found)) | {"covered": covered(rows, rule)}
    return red(CASE, {name: Measured(value) for name, value in values.items()}, whole=True)


def test_the_rule_holds_and_the_textbook_turns_red(rows):
    assert gates(rows) == set() and gates(rows, of_textbook) == {"covered"}


@pytest.mark.parametrize("factor, gate", [(0.5, "covered"), (12.0, "not-too-wide")])
def test_another_factor_turns_it_red(rows, monkeypatch, factor, gate):
    """A sixth of the factor covers too little, if the edge of the contact leaves nothing; four times as much
    says nothing.
    """
    made = study.bound

    def other(values, sizes, order, given=3.0):
        return made(values, sizes, order, factor * given / 3.0)

    monkeypatch.setattr(study, "bound", other)
    if factor < 1.0:
        monkeypatch.setattr(study, "of_edge", lambda *_: 0.0)
    assert gate in gates(rows, study.of_program)


def test_what_a_doubtful_reference_says_does_not_count(rows):
    row = rows[0]
    assert row.known and not replace(row, doubt=of_program(row) / 2.9).known
    doubtful = Found([row, replace(row, doubt=row.truth)])
    assert doubtful.known == [row] and ("Values that do not count", "1 of 2") <= next(
        words for words in uncertainty.CASES[0].setup(doubtful) if words[0].startswith("Values")
    )


def test_the_study_has_the_kinds_of_contact_that_were_asked_for(tmp_path):
    own = study.subjects(context(CASE, tmp_path), study=True)
    scenes = [subject.scene for subject in own]
    assert len(own) >= 8 and sum(len(subject.finest) for subject in own) >= 150
    assert any(scene.coefficient for scene in scenes) and any(scene.body.coating for scene in scenes)
    assert any(scene.counterbody and len(set(scene.counterbody.radii)) == 2 for scene in scenes)
    assert {subject.chose for subject in own} == {True, False}
