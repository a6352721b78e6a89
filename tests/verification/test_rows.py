# SPDX-License-Identifier: MIT
"""The rows of all cases and their evaluation: whatever is not a value within its tolerance is red."""

import math

import numpy as np
import pytest
from made_results import row

from sam.scene import SceneError
from verification.cases import LEVELS, all_cases
from verification.judging import Measured, Row, RowStatus, error_of, evaluate, judge
from verification.rows import Take, load_rows, read_cases
from verification.suite.forecast import costs_at

GATES = load_rows()


def test_gates_and_cases_belong_together():
    cases = all_cases()
    assert {gate.case for gate in GATES} == set(cases)
    assert all(set(case.levels) <= set(LEVELS) for case in cases.values())
    # those of no level need other programs
    assert [name for name, case in cases.items() if not case.levels] == ["periodic-peers", "peers"]
    assert set(costs_at("quick")) == {name for name, case in cases.items() if "quick" in case.levels}


def synthetic(gate: Row, share: float) -> Measured:
    """A value whose error is `share` of the tolerance (at_least: 1/share), by the metric's meaning."""
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


def test_every_row_of_every_case_passes_inside_its_tolerance_alone():
    # 1 % beside the tolerance: far above rounding even for tolerances of 1e-12 (relative spacing of doubles
    # 2e-16); ten tolerances off, not finite or missing is red too
    wrong = []
    for gate in GATES:
        outside = {
            "1 % outside": synthetic(gate, 1.01),
            "ten tolerances": synthetic(gate, 10.0),
            **{str(value): spoilt(gate, value) for value in (math.nan, math.inf, -math.inf)},
            "no value": Measured(None, synthetic(gate, 0.5).expected),
        }
        passed = [name for name, value in outside.items() if judge(gate, value).passed]
        if passed or not judge(gate, synthetic(gate, 0.99)).passed or len(gate.reason) <= 15:
            wrong.append((gate.id, passed))
    assert wrong == []


def test_a_row_is_unchecked_and_red_when_its_case_skips_it():
    missed = []
    for case in {gate.case for gate in GATES}:
        own = [gate for gate in GATES if gate.case == case]
        values = {gate.id: synthetic(gate, 0.5) for gate in own}
        for gate in own:
            verdicts = evaluate(own, {case: values | {gate.id: None}})
            missed += [v.row.id for v in verdicts if (v.status is RowStatus.UNCHECKED) != (v.row is gate)]
    assert missed == []


def test_a_case_that_broke_off_leaves_its_rows_red_with_the_reason_and_others_not_run():
    first = GATES[0].case
    for found in evaluate(GATES, {first: {}}, {first: "out of luck"}):
        broken = found.row.case == first
        assert found.status is (RowStatus.UNCHECKED if broken else RowStatus.NOT_RUN)
        assert found.status.red == broken and found.note == "out of luck" * broken


def test_a_value_without_a_row_of_its_case_is_red():
    other = next(gate for gate in GATES if gate.case != GATES[0].case)
    for name in ("misspelt", other.id):
        verdict = evaluate(GATES, {GATES[0].case: {name: Measured(1.0)}})[-1]
        assert verdict.row.id == name and verdict.status is RowStatus.FAILED and "no gate" in verdict.note


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
    gate = row("x", "y", metric=metric, tolerance=0.5)
    verdict = judge(gate, measured)
    assert verdict.status is RowStatus.FAILED and verdict.note


def test_l2_is_weighted():
    value, expected, weight = np.array([1.0, 3.0]), np.array([1.0, 2.0]), np.array([3.0, 1.0])
    found = error_of("relative_l2", Measured(value, expected, weight))
    assert found == pytest.approx(math.sqrt(1.0 / 7.0), rel=1e-15)  # 1 * 1^2 / (3 * 1^2 + 1 * 2^2)


FILE = """
title = "t"
question = "q"
[reasons]
known = "why it is so"
[rows.exact]
a = ["relative", 0.1, "@known", "quantity a"]
"{sam,fem}-b" = ["at_most", 1, "because of b", "quantity b, {SAM,FEM}"]
[cases.first]
[cases.second]
levels = ["full"]
[cases.second.rows.exact]
a = ["relative", 0.2, "wider here", "quantity a"]
"""


def cases_in(text, tmp_path):
    path = tmp_path / "cases.toml"
    path.write_text(text, encoding="utf-8")
    return {case.name: case for case in read_cases(path)}


def test_a_file_holds_several_cases_which_override_and_rows_in_braces(tmp_path):
    cases = cases_in(FILE, tmp_path)
    said = {
        name: {r.id: (r.tolerance, r.quantity, r.kind) for r in case.rows} for name, case in cases.items()
    }
    pair = {"sam-b": (1.0, "quantity b, SAM", "exact"), "fem-b": (1.0, "quantity b, FEM", "exact")}
    for name, tolerance in (("first", 0.1), ("second", 0.2)):
        rows = {"a": (tolerance, "quantity a", "exact"), **pair}
        assert said[name] == {f"{name}.{key}": row for key, row in rows.items()}
    assert cases["first"].rows[0].reason == "why it is so" and cases["second"].levels == ("full",)


def test_a_take_says_in_words_what_it_is():
    take, held = Take.of_row("order p-max of sam coarse at grid-cells = 3, z < 2 | of fem")
    assert take.words() == "largest pressure, SAM, coarse, grid cells 3, z < 2, observed order of convergence"
    assert held.words({"order": "", "z < 2": "near"}) == "largest pressure, FEM, grid cells 3, near"
    assert Take.parse("own-column").words() == "own column"


def test_braces_in_the_name_of_a_case_stand_for_several(tmp_path):
    text = '[cases."c-{2,3}"]\ntitle = "p = {2,3}"\nscene = "s"\nvary = {p = "{2,3}", law = "{a,b,c}"}\n'
    cases = cases_in(text + '[cases.c-3]\nlevels = ["full"]\n', tmp_path)
    said = {name: (case.title, case.vary["p"], case.levels) for name, case in cases.items()}
    assert said == {"c-2": ("p = 2", 2.0, ("quick", "full")), "c-3": ("p = 3", 3.0, ("full",))}
    assert {case.vary["law"] for case in cases.values()} == {"{a,b,c}"}


def test_rows_of_models_take_their_words_from_the_vocabulary(tmp_path):
    text = '[rows."sam/exact"]\np-max = ["relative", 0.1, "because"]\n'
    text += '[rows."sam/fem"]\napproach = ["at_most", 1, "because"]'
    rows = cases_in('title = "t"\n' + text, tmp_path)["cases"].rows
    assert [(row.id, row.quantity, row.kind) for row in rows] == [
        ("cases.sam-p-max", "largest pressure, SAM", "exact"),
        ("cases.approach", "approach, SAM against FEM", "model"),
    ]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('["relative", 0.1, "@known"', '["roughly", 0.1, "@known"', "rows.exact.a.metric"),
        ('["relative", 0.1', '["relative", 0.0', "above 0 for the others"),
        ('["relative", 0.1', '["relative", -0.1', "rows.exact.a.tolerance"),
        ('["relative", 0.1', '["relative", nan', "rows.exact.a.tolerance"),
        ('["relative", 0.1', '["relative", "0.1"', "rows.exact.a.tolerance"),
        ('["relative", 0.1', '["relative", true', "rows.exact.a.tolerance"),
        ('"because of b"', '""', "reason"),
        ('"@known"', '"@unknown"', "rows.exact.a"),
        ('"quantity a"]', '"quantity a", "value a", "more"]', "rows.exact.a"),
        ('"quantity a"]', '"quantity a", "value a"]', "takes of sweeps"),
        (
            'question = "q"',
            'frame = "f"\nrows.limit.c = ["at_most", 1, "known", "c", "", "c"]',
            "rows.limit.c",
        ),
        ("[rows.exact]", "[rows.roughly]", "kind"),
        ("{SAM,FEM}", "{SAM}", "rows.exact.{sam,fem}-b"),
        ('"{sam,fem}-b"', '"{a,fem-b}"', "occurs twice"),
        ('title = "t"', 'titel = "t"', "titel"),
        ('title = "t"', "title = t", "case file"),
    ],
)
def test_a_bad_file_ends_in_an_error_that_names_file_key_and_what_is_allowed(old, new, said, tmp_path):
    with pytest.raises(SceneError) as error:
        cases_in(FILE.replace(old, new, 1), tmp_path)
    assert said in str(error.value) and "cases.toml" in str(error.value)
