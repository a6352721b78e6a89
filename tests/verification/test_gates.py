# SPDX-License-Identifier: MIT
"""The table of gates and its evaluation: whatever is not a value within its tolerance is red."""

import math

import numpy as np
import pytest

from verification.quantities import Measured
from verification.rows import Row, RowStatus, error_of, evaluate, judge, load_rows

GATES = load_rows()
IDS = [gate.id for gate in GATES]


def synthetic(gate: Row, share: float) -> Measured:
    """A value whose error is `share` of the tolerance (for at_least: 1/share of it), built from the metric's
    meaning.
    """
    step = share * gate.tolerance
    return {
        "relative": lambda: Measured(2.0 * (1.0 + step), 2.0),
        "absolute": lambda: Measured(-step, 0.0),
        "relative_l2": lambda: Measured(np.full(7, 3.0 * (1.0 - step)), np.full(7, 3.0), np.arange(1.0, 8.0)),
        "at_most": lambda: Measured(-step),
        "at_least": lambda: Measured(gate.tolerance / share),
        "equal": lambda: Measured(4.0 if share < 1.0 else 5.0, 4.0),
    }[gate.metric]()


def spoilt(gate: Row, value: float) -> Measured:
    """The value replaced by one that is no finite number."""
    good = synthetic(gate, 0.5)
    replaced = np.append(good.value[:-1], value) if np.ndim(good.value) else value
    return Measured(replaced, good.expected, good.weight)


@pytest.mark.parametrize("gate", GATES, ids=IDS)
def test_a_row_passes_inside_its_tolerance_alone(gate):
    # 1 % beside the tolerance: far above rounding even for tolerances of 1e-12 (relative spacing of doubles
    # 2e-16)
    assert judge(gate, synthetic(gate, 0.99)).status is RowStatus.PASSED
    outside = {
        "1 % outside": synthetic(gate, 1.01),
        **{str(value): spoilt(gate, value) for value in (math.nan, math.inf, -math.inf)},
        "no value": Measured(None, synthetic(gate, 0.5).expected),
    }
    wrong = {name for name, value in outside.items() if judge(gate, value).status is not RowStatus.FAILED}
    assert wrong == set()
    assert len(gate.reason) > 15


@pytest.mark.parametrize("gate", GATES, ids=IDS)
def test_a_row_is_unchecked_and_red_when_its_case_skips_it(gate):
    own = {
        other.id: synthetic(other, 0.5) for other in GATES if other.case == gate.case and other is not gate
    }
    verdict = next(v for v in evaluate(GATES, {gate.case: own}) if v.row is gate)
    assert verdict.status is RowStatus.UNCHECKED and verdict.status.red


@pytest.mark.parametrize("metric", ["relative", "absolute", "relative_l2", "at_most", "at_least", "equal"])
def test_every_metric_turns_red_outside_its_tolerance(metric):
    gate = Row(
        id="x", case="y", quantity="q", metric=metric, tolerance=0.0 if metric == "equal" else 0.1, reason="r"
    )
    assert judge(gate, synthetic(gate, 0.99)).status is RowStatus.PASSED
    assert judge(gate, synthetic(gate, 1.01)).status is RowStatus.FAILED


def test_case_that_broke_off_leaves_its_gates_red_with_the_reason():
    verdicts = [
        v for v in evaluate(GATES, {GATES[0].case: {}}, {GATES[0].case: "out of luck"}) if v.status.red
    ]
    assert {v.row.id for v in verdicts} == {gate.id for gate in GATES if gate.case == GATES[0].case}
    assert {v.note for v in verdicts} == {"out of luck"}


def test_gates_of_other_cases_are_not_run_and_not_red():
    verdicts = evaluate(GATES, {})
    assert {v.status for v in verdicts} == {RowStatus.NOT_RUN} and not any(v.status.red for v in verdicts)


def test_value_without_a_row_is_red():
    verdict = evaluate(GATES, {GATES[0].case: {"misspelt": Measured(1.0)}})[-1]
    assert verdict.row.id == "misspelt" and verdict.status is RowStatus.FAILED and "no gate" in verdict.note


def test_value_of_another_case_does_not_count():
    other = next(gate for gate in GATES if gate.case != GATES[0].case)
    verdicts = {
        v.row.id: v.status for v in evaluate(GATES, {GATES[0].case: {other.id: synthetic(other, 0.5)}})
    }
    assert verdicts[other.id].red


@pytest.mark.parametrize(
    ("metric", "measured"),
    [
        ("relative", Measured(1.0)),
        ("relative", Measured(0.0, 0.0)),
        ("relative", Measured(np.ones(3), np.ones(3))),
        ("relative", Measured("a lot", 1.0)),
        ("relative_l2", Measured(1.0, 1.0)),
        ("relative_l2", Measured(np.ones(3), np.ones(4))),
        ("relative_l2", Measured(np.ones(3), np.ones(3), np.ones(2))),
        ("relative_l2", Measured(np.zeros(3), np.zeros(3))),
        ("relative_l2", Measured(np.array([]), np.array([]))),
        ("at_most", Measured(0.0, 1.0)),
        ("at_least", Measured(np.ones(2))),
    ],
)
def test_values_that_do_not_fit_the_metric_fail(metric, measured):
    gate = Row(id="x", case="y", quantity="q", metric=metric, tolerance=0.5, reason="r")
    verdict = judge(gate, measured)
    assert verdict.status is RowStatus.FAILED and verdict.note


def test_l2_is_weighted():
    value, expected, weight = np.array([1.0, 3.0]), np.array([1.0, 2.0]), np.array([3.0, 1.0])
    # by hand: sqrt(1 * 1^2 / (3 * 1^2 + 1 * 2^2)) = sqrt(1/7)
    assert error_of("relative_l2", Measured(value, expected, weight)) == pytest.approx(
        math.sqrt(1.0 / 7.0), rel=1e-15
    )


ROW = '[[gate]]\nid = "a"\ncase = "c"\nquantity = "q"\nmetric = "relative"\ntolerance = 0.1\nreason = "r"\n'


@pytest.mark.parametrize(
    "text",
    [
        ROW + ROW,
        ROW.replace("relative", "roughly"),
        ROW.replace("0.1", "0.0"),
        ROW.replace("0.1", "-0.1"),
        ROW.replace("0.1", "nan"),
        ROW.replace("0.1", "inf"),
        ROW.replace("0.1", '"0.1"'),
        ROW.replace("0.1", "true"),
        ROW.replace('reason = "r"\n', ""),
        ROW.replace('reason = "r"', 'reason = ""'),
        ROW + 'remark = "x"\n',
        ROW.replace('"relative"', '"equal"'),
        ROW.replace('case = "c"', 'case = "c"\ncases = ["c"]'),
        ROW.replace('case = "c"', 'cases = ["c", "c"]'),
        ROW.replace('case = "c"', "cases = [1]"),
    ],
)
def test_bad_table_is_refused(text):
    assert load_rows(ROW)[0].tolerance == 0.1
    with pytest.raises(ValueError):
        load_rows(text)


def test_row_of_several_cases_is_one_gate_for_each():
    gates = load_rows(ROW.replace('case = "c"', 'cases = ["c", "d-2"]'))
    assert [(gate.id, gate.case, gate.tolerance) for gate in gates] == [
        ("c.a", "c", 0.1),
        ("d-2.a", "d-2", 0.1),
    ]
