# SPDX-License-Identifier: MIT
"""The robustness matrix: complete, and red when a cell is not what its row expects."""

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_results import red

from sam.scene import Status
from verification.cases.robustness.stability import CASES, Matrix
from verification.robustness.matrix import plastic
from verification.robustness.matrix.checks import within_refinement
from verification.robustness.matrix.row import Absent, Bench, Cell, Kind, Refused, Right, Row, both, judge
from verification.robustness.matrix.rows import TOPICS, all_rows
from verification.runs import models
from verification.runs.models import FEM, FEM_3D, SAM

(CASE,) = CASES

ROWS = {row.name: row for row in all_rows("full")}
EVERY = tuple(ROWS.values())


def red_of(rows, judged, level="quick") -> set[str]:
    return red("stability", CASE.values(Matrix(rows, judged, level)), whole=True)


def judged(*names):
    """(rows, their cells)."""
    rows, bench = [ROWS[name] for name in names], Bench()
    return rows, {row.name: {model: judge(row, model, bench) for model in row.expected} for row in rows}


@pytest.fixture(scope="module")
def some():
    return judged(
        "poisson-0", "poisson-0.5", "force-1e-15", "force-0", "one-cell", "coarse-mesh", "radii-1e5", "nan"
    )


@pytest.fixture
def answer(monkeypatch):
    """Puts a function of the result in the place of every solve's result."""

    def put(change):
        solve = models.solve
        monkeypatch.setattr(models, "solve", lambda scene, model: change(solve(scene, model)))

    return put


def test_rows_are_complete():
    assert len(ROWS) == len(EVERY) and {row.topic for row in EVERY} == set(TOPICS)
    assert all({SAM, FEM} <= set(row.expected) and row.what for row in EVERY)
    expectations = [expected for row in EVERY for expected in row.expected.values()]
    assert all(expected.reason for expected in expectations)
    assert all(expected.says for expected in expectations if isinstance(expected, Refused))
    assert all(expected.checks for expected in expectations if isinstance(expected, Right))
    assert {row.name for row in all_rows("quick")} < set(ROWS)


def test_right_cells_and_expected_errors_hold_every_gate(some):
    rows, cells = some
    kinds = {name: {model: cell.kind for model, cell in row.items()} for name, row in cells.items()}
    assert kinds["poisson-0"] == kinds["force-1e-15"] == {SAM: Kind.RIGHT, FEM: Kind.RIGHT}
    assert kinds["poisson-0.5"] == {SAM: Kind.RIGHT, FEM: Kind.ERROR, FEM_3D: Kind.ERROR}
    assert kinds["one-cell"] == {SAM: Kind.ERROR, FEM: Kind.ABSENT} and red_of(rows, cells) == set()
    tables = CASE.tables(Matrix(rows, cells))
    assert [len(table.rows) for table in tables] == [len(rows), 8, 9]  # matrix, right cells, errors


@pytest.mark.parametrize(
    ("name", "quantity", "factor"),
    [
        ("poisson-0", "p_center_Pa", 1.006),
        ("force-1e-15", "approach_m", 0.997),
        ("poisson-0.5", "mises_max_Pa", 1.02),
    ],
)
def test_a_wrong_answer_turns_the_matrix_red(answer, name, quantity, factor):
    answer(
        lambda result: replace(
            result, quantities={**result.quantities, quantity: factor * result.quantities[quantity]}
        )
    )
    rows, cells = judged(name)
    assert cells[name][SAM].kind is Kind.WRONG and "> 0.0" in cells[name][SAM].text
    assert red_of(rows, cells) == {"wrong"}


def test_what_is_not_finite_is_wrong(answer):
    answer(lambda result: replace(result, quantities={**result.quantities, "residual_uz_center_m": np.nan}))
    assert judge(ROWS["poisson-0"], SAM, Bench()).text == "not finite: residual_uz_center_m"


def test_an_answer_where_an_error_is_expected_is_wrong(answer):
    answer(lambda result: replace(result, status=Status.CONVERGED, message=""))
    rows, cells = judged("one-cell")
    assert cells["one-cell"][SAM].text == "converged, but an error was expected"
    assert red_of(rows, cells) == {"wrong"}


@pytest.mark.parametrize("status", [Status.UNDER_RESOLVED, Status.NOT_CONVERGED])
def test_an_error_without_advice_or_of_another_kind_is_wrong(answer, status):
    answer(lambda result: replace(result, status=status, message="failed"))
    cell = judge(ROWS["one-cell"], SAM, Bench())
    assert cell.kind is Kind.WRONG
    assert ("does not say" if status is Status.UNDER_RESOLVED else "expected under-resolved") in cell.text


def test_an_error_where_an_answer_is_expected_is_wrong(answer):
    answer(lambda result: replace(result, status=Status.NOT_CONVERGED, message="raise something"))
    assert judge(ROWS["poisson-0"], FEM, Bench()).text == "not-converged: raise something"


def test_another_exception_and_a_warning_are_wrong(monkeypatch):
    def divide(scene, model):
        return 1 / 0

    monkeypatch.setattr(models, "solve", divide)
    assert judge(ROWS["poisson-0"], SAM, Bench()).text == "ZeroDivisionError: division by zero"

    def overflow(scene, model):
        with warnings.catch_warnings():
            return np.exp(np.array([1e3]))

    monkeypatch.setattr(models, "solve", overflow)
    cell = judge(ROWS["poisson-0"], SAM, Bench())
    assert cell.kind is Kind.WRONG and "overflow encountered in exp" in cell.text


@pytest.mark.parametrize("apart, kind", [(0.0, Kind.RIGHT), (0.05, Kind.RIGHT), (0.2, Kind.WRONG)])
def test_a_value_is_compared_within_the_refinement_uncertainty_of_both(monkeypatch, apart, kind):
    """Both models converge at first order, SAM to 1 and FEM to 1 + apart; each errs by 4 % on the cells of
    the row.
    """
    coarser = {SAM: plastic.larger_cells, FEM: plastic.larger_elements}

    def first_order(scene, model):
        cells = scene.grid.cells[0] if model == SAM else scene.fem.cells_per_radius
        value = (1.0 if model == SAM else 1.0 + apart) * (1.0 + 0.04 * (33 if model == SAM else 24) / cells)
        fine = {"cells": [33, 33], "cell_m": [1e-6, 1e-6]}
        return SimpleNamespace(converged=True, quantities={"peeq_max": value}, discretisation=fine)

    monkeypatch.setattr(models, "solve", first_order)
    row = replace(
        ROWS["perfect-7.5-chosen-grid"],
        make={"grid.cells": (33, 33), "fem.cells_per_radius": 24},
        expected={SAM: Right("", [within_refinement(FEM, "peeq_max", coarser)])},
    )
    cell = judge(row, SAM, Bench())
    assert cell.kind is kind, cell.text
    uncertainties = 2 * 0.04 * (33 / 23 - 1) + 2 * 0.04 * (24 / 16 - 1) * (1 + apart)
    assert cell.deviations[0].error == pytest.approx(apart * 1.04 / uncertainties)


def test_a_check_that_compares_nothing_is_wrong():
    empty = replace(ROWS["poisson-0"], expected={SAM: Right("no reason", [lambda trial: ()])})
    assert judge(empty, SAM, Bench()).text == "nothing was compared"


def test_a_cell_without_verdict_and_a_kind_without_row_turn_red(some):
    rows, cells = some
    assert red_of(rows, {**cells, "poisson-0": {SAM: cells["poisson-0"][SAM]}}) == {"rows"}
    assert red_of(rows, cells, "full") == {"topics-missing"}


def test_an_error_without_reason_turns_red(some):
    rows, cells = some
    bare = [
        replace(row, expected={**row.expected, FEM: Refused("", ["poisson"])})
        for row in rows
        if row.name == "poisson-0.5"
    ]
    assert red_of(bare, {"poisson-0.5": cells["poisson-0.5"]}) == {"errors-explained"}
    silent = {"poisson-0.5": cells["poisson-0.5"] | {FEM: Cell(Kind.ERROR)}}
    assert red_of([ROWS["poisson-0.5"]], silent) == {"errors-explained"}


def test_an_absent_cell_is_not_solved(monkeypatch):
    monkeypatch.setattr(models, "solve", None)
    row = Row("x", "edge", "x", {}, {FEM: Absent("of the other model")})
    assert judge(row, FEM, Bench()) == Cell(Kind.ABSENT, "of the other model")


def test_both_models_once():
    assert both(Absent("a")) == {SAM: Absent("a"), FEM: Absent("a")}
