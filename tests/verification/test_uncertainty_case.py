# SPDX-License-Identifier: MIT
"""The case uncertainty: its problems, what counts, and that another rule turns it red."""

from dataclasses import replace

import pytest
from made_results import context, red

from verification.cases.cost import uncertainty as study
from verification.cases.cost.uncertainty import Found, Row, covered, of_program, of_textbook
from verification.judging import Measured

CASE = "uncertainty"


@pytest.fixture(scope="module")
def rows(tmp_path_factory) -> list[Row]:
    """The bare elastic problems, whose answers are closed forms."""
    where = context(CASE, tmp_path_factory.mktemp("case"))
    closed = ("Hertz", "sliding", "ellipsoid", "rounded")
    own = [each for each in study.subjects(study=True) if each.kind.startswith(closed)]
    return [row for subject in own for row in study.rows_of(where, subject)]


def gates(rows, rule=of_program) -> set[str]:
    found = Found(rows)
    values = dict(study.CASES[0].measure(found)) | {"covered": covered(rows, rule)}
    return red(CASE, {name: Measured(value) for name, value in values.items()}, whole=True)


def widened(rows, factor: float) -> list[Row]:
    return [replace(row, entry={**row.entry, "u_num": factor * row.entry["u_num"]}) for row in rows]


def test_the_rule_holds_and_the_textbook_turns_red(rows):
    assert gates(rows) == set() and gates(rows, of_textbook) == {"covered"}


@pytest.mark.parametrize(
    "factor, gate", [(1 / 6, "covered"), (6.0, "not-too-wide"), (6.0, "area-not-too-wide")]
)
def test_another_factor_turns_it_red(rows, factor, gate):
    """A sixth of the uncertainty covers too little; six times as much says nothing."""
    assert gate in gates(widened(rows, factor))


def test_what_a_doubtful_reference_says_does_not_count(rows):
    row = replace(rows[0], truth=rows[0].entry["values"][0])
    assert row.known and not replace(row, doubt=of_program(row) / 2.9).known
    missed = replace(row, truth=row.truth - 5.0 * of_program(row), doubt=of_program(row))
    assert missed.known, "a reference that shows a miss counts"
    doubtful = Found([row, replace(row, doubt=row.truth)])
    assert doubtful.known == [row] and ("Values that do not count", "1 of 2") <= next(
        words for words in study.CASES[0].setup(doubtful) if words[0].startswith("Values")
    )


def test_the_study_has_problems_that_differ():
    """Forty; one elastic sphere at rest, every law, and grids of at least five sizes."""
    scenes = [each.drawn(0) for each in study.subjects(study=True)]
    assert len(scenes) == 40 == len({each.kind for each in study.subjects(study=True)})
    elastic = [each for each in scenes if each.body.plasticity is None and each.counterbody.shape == "sphere"]
    assert sum(each.body.coating is None and not each.coefficient for each in elastic) == 1
    laws = {each.body.plasticity.law for each in scenes if each.body.plasticity}
    assert laws == {"swift", "linear", "perfect", "table"}
    assert len({each.grid.cells for each in scenes}) >= 5 and any(each.coefficient for each in scenes)
