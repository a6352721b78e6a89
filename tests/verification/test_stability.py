# SPDX-License-Identifier: MIT
"""The robustness matrix: complete, and red when a cell is not what its row expects."""

import warnings
from dataclasses import replace
from math import pi
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from builders import MODULUS, RADIUS, scene
from made_results import of_frame, red

from sam.scene import Status
from verification.cases.robustness.stability import judged
from verification.reference.hertz import CircularContact
from verification.robustness.matrix.checks import Bench, Trial, check_of
from verification.robustness.matrix.rows import RIGHT, WRONG, Cell, all_rows, judge, table, topics
from verification.robustness.matrix.scenes import SIDE, scene_with
from verification.runs import models
from verification.runs.models import FEM, SAM

ROWS = {row.name: row for row in all_rows("full")}
EVERY = tuple(ROWS.values())


def test_rows_are_complete():
    assert len(ROWS) == len(EVERY) and {row.topic for row in EVERY} == set(topics())
    assert all({SAM, FEM} <= set(row.expected) and row.what for row in EVERY)
    expectations = [expected for row in EVERY for expected in row.expected.values()]
    assert {kind for kind, *_ in expectations} == {"right", "error", "absent"}
    assert all(reason for _, reason, *_ in expectations)
    assert all(words for kind, _, *words in expectations if kind != "absent")
    assert all(words[1:] for kind, _, *words in expectations if kind == "error")
    for said in (said for kind, _, *checks in expectations if kind == "right" for said in checks):
        assert check_of(table()["checks"].get(said, said) if isinstance(said, str) else said)
    assert {row.name for row in all_rows("quick")} < set(ROWS)


def times(quantity: str, factor: float):
    """A result with a quantity times a factor, which is the quantity of one that has none."""

    def change(result):
        value = factor * (result.quantities[quantity] or 1.0)
        return replace(result, quantities={**result.quantities, quantity: value})

    return change


def ended(status: Status, message: str):
    return lambda result: replace(result, status=status, message=message)


def overflow(result):
    with warnings.catch_warnings():
        return np.exp(np.array([1e3]))


@pytest.mark.parametrize(
    ("name", "model", "change", "said"),
    [
        ("poisson-0", SAM, times("p_center_Pa", 1.006), "> 0.0"),
        ("force-1e-15", SAM, times("approach_m", 0.997), "> 0.0"),
        ("poisson-0.5", SAM, times("mises_max_Pa", 1.02), "> 0.0"),
        ("poisson-0", SAM, times("residual_uz_center_m", np.nan), "not finite: residual_uz_center_m"),
        ("one-cell", SAM, ended(Status.CONVERGED, ""), "converged, but an error was expected"),
        ("one-cell", SAM, ended(Status.UNDER_RESOLVED, "failed"), "does not say"),
        ("one-cell", SAM, ended(Status.NOT_CONVERGED, "failed"), "expected under-resolved"),
        ("poisson-0", FEM, ended(Status.NOT_CONVERGED, "raise it"), "not-converged: raise it"),
        ("poisson-0", SAM, lambda result: 1 / 0, "ZeroDivisionError: division by zero"),
        ("poisson-0", SAM, overflow, "overflow encountered in exp"),
    ],
)
def test_what_is_not_as_expected_is_wrong_and_turns_the_matrix_red(monkeypatch, name, model, change, said):
    """Wrong answers and errors, either in place of the other, other exceptions, a warning."""
    solve, row = models.solve, ROWS[name]
    monkeypatch.setattr(models, "solve", lambda scene, model: change(solve(scene, model)))
    cell = judge(row, model, Bench())
    assert cell.kind == WRONG and said in cell.text
    rest = {other: Cell(RIGHT) for other in row.expected}
    rows = [*judged([row], {name: rest | {model: cell}}), {"sweep": "Topics", "topics-missing": 0}]
    assert "wrong" in red("stability", of_frame("stability", pd.DataFrame(rows)), whole=True)


# --- checks, of made results ---

SLIDES, SQUARE = scene(friction=0.3), 0.65 / (2 * 1.012 * MODULUS * SIDE / pi**0.5)
STEEL, MISFIT = SimpleNamespace(young=210e9, poisson=0.3), SimpleNamespace(misfit=0.01)
ELASTIC = SimpleNamespace(body=STEEL, loading=MISFIT)
HELD, SOFT = CircularContact(0.65, RADIUS, MODULUS), 4e9 / (1 - 0.2**2)
FILM = {"thickness": 1e-3, "young": 4e9, "poisson": 0.2}
BY_APPROACH = scene(loading={"force": None, "approach": 1e-6})


def cycles(*signs):
    table = {"cycle": [1, 2], "friction_coefficient": [0.3, 0.3], "friction_sign": signs}
    return {"tables": {"cycles": table}}


def uncertain(**entries):
    """Of quantities with their values over the exact ones less 1, and their relative uncertainties."""
    exact = {"p_max_Pa": HELD.peak_pressure, "approach_m": HELD.approach}
    return {
        "quantities": {name: value * (1 + entries[name][0]) for name, value in exact.items()},
        "uncertainty": {name: {"u_num": value * entries[name][1]} for name, value in exact.items()},
    }


def flagged(u, flag):
    return {"uncertainty": {"mises_max_Pa": {"u_num": u, "flag": flag}}}


def accuracy(relative):
    return {"discretisation": {"accuracy": {"relative": relative, "asked": 0.02}}}


def of(**quantities):
    return {"quantities": quantities}


MADE = [
    ("carries", SLIDES, of(friction_coefficient=0.3), of(friction_coefficient=0.300001)),
    ("signs", SLIDES, cycles(1, -1), cycles(1, 1)),
    ("stays-elastic", ELASTIC, *(of(mises_max_Pa=mises, peeq_max=0.0) for mises in (0.84e9, 0.9e9))),
    ("stays-elastic", ELASTIC, *(of(mises_max_Pa=0.84e9, peeq_max=peeq) for peeq in (0.0, 1e-9))),
    ("square-punch", scene(), of(approach_m=SQUARE), of(approach_m=1.01 * SQUARE)),
    ("warned", scene(), {"warnings": ("contact at the border",)}, {"warnings": ()}),
    ("covers", scene(), *(uncertain(p_max_Pa=(0.01, u), approach_m=(-0.01, 0.02)) for u in (0.02, 0.005))),
    ("covers", scene(), *(uncertain(p_max_Pa=(0.01, 0.02), approach_m=(-0.01, u)) for u in (0.02, 0.005))),
    ("zero", scene(), flagged(None, ""), flagged(1e-12, "")),
    ("reached", scene(), accuracy(0.019), accuracy(0.021)),
    (["without", "mises_max_Pa", "moves"], scene(), flagged(None, "it moves"), flagged(1.0, "it moves")),
    (["without", "mises_max_Pa", "moves"], scene(), flagged(None, "it moves"), flagged(None, "no")),
    (["Hertz, given approach", {"force_N": 1e-9}], BY_APPROACH,
     *(of(force_N=more * 4 / 3 * MODULUS * RADIUS**0.5 * 1e-9) for more in (1, 1.001))),
    (["limit of a thick film", {"p_max_Pa": 1e-9}], scene_with({"body.coating": FILM, "grid": "none"}),
     *(of(p_max_Pa=more * (6 * 0.17 * SOFT**2 / pi**3 / 1e-8) ** (1 / 3)) for more in (1, 1.001))),
]  # fmt: skip


def worst(said, given, result, twin=None):
    """The largest error over its bound. twin: what stands for another scene."""
    bench = SimpleNamespace(converged=lambda scene, model: SimpleNamespace(**twin(scene, model)))
    return max(each.share for each in check_of(said)(Trial(given, SAM, SimpleNamespace(**result), bench)))


@pytest.mark.parametrize(("said", "given", "right", "wrong"), MADE)
def test_a_check_tells_right_from_wrong(said, given, right, wrong):
    of_right, of_wrong = (worst(said, given, {"quantities": {}} | result) for result in (right, wrong))
    assert of_right <= 1 < of_wrong
