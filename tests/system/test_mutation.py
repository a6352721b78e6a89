# SPDX-License-Identifier: MIT
"""The mutation check: what it finds and where it changes it, what is lost, and its gates turn red."""

import sys
from functools import _lru_cache_wrapper
from types import FunctionType

import numpy as np
import pytest

from sam.kernels.patches import Lags, displacement_coefficients as coefficients
from verification.robustness.mutants import frozen, inject, scope
from verification.robustness.mutants.changes import Mutant, Number, find
from verification.robustness.mutants.judge import MutantVerdict, forked
from verification.robustness.mutants.scope import mutants_of

TOY = '''"""A toy."""
from functools import cache
import numpy as np

NODES = 4
SCALE, SHARE = 2.5, 3
TABLE = {(1, 2): 7.0}

class Body:
    iterations, threshold = 100, 0.5
    def area(self, r, factor=1.5):
        return factor * r * r / 2

def index(v, k):
    return v[k + 1] ** 2

def count(n):
    return np.zeros(2 * n + 1).size

@cache
def remembered():
    return 0.25

def nested(x):
    half = lambda y: y / 2
    return SCALE * half(x) - 1 + TABLE[1, 2] * 0

def inside(x):
    if 0 <= x < 2:
        return "inside"
    return [k for k in range(3) if k == x] or (x > 5 and not x[x < 7] if x is None else x)
'''


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """A module with numbers of every kind."""
    (tmp_path / "toy_numbers.py").write_text(TOY)
    monkeypatch.syspath_prepend(tmp_path)
    import toy_numbers  # noqa: PLC0415 - this fixture writes it

    yield toy_numbers
    del sys.modules["toy_numbers"]


def test_numbers_comparisons_and_conditions_are_found_and_structure_is_not():
    found = find("toy_numbers", TOY)
    assert {(m.function, m.text, m.kind) for m in found if m.kind in scope.NUMBERS} == {
        ("", "NODES = 4", "count"),
        ("", "SCALE = 2.5", "number"),
        ("", "SHARE = 3", "count"),
        ("", "7.0", "number"),
        ("Body", "iterations = 100", "count"),
        ("Body", "threshold = 0.5", "number"),
        ("Body", "1.5", "number"),
        ("Body.area", "2", "number"),
        ("count", "2", "number"),
        ("count", "1", "number"),
        ("remembered", "0.25", "number"),
        ("nested.<lambda>", "2", "number"),
        ("nested", "1", "number"),
    }
    comparisons = "0 < x|0 > x|x <= 2|x >= 2|x >= 5|x <= 5|x <= 7|x >= 7".split("|")
    branches = "not (0 <= x < 2)|not (k == x)|not (x is None)".split("|")
    for kind, texts in (("comparison", comparisons), ("branch", branches)):
        ones = [m for m in found if m.function == "inside" and m.kind == kind]
        assert [m.text for m in ones] == texts and [m.ordinal for m in ones] == list(range(len(texts)))


def in_forks(tasks):
    """What each task returns in a fork of this process; all objects are looked at once, before."""
    inject.living.cache_clear()
    for kind in (FunctionType, _lru_cache_wrapper):
        inject.living(kind)
    return dict(forked(tasks, 30.0))


USED = {
    ("2", "Body.area"): (lambda toy: toy.Body().area(2.0), 3.0 / 1.001),
    ("1.5", "Body"): (lambda toy: toy.Body().area(2.0), 3.003),
    ("iterations = 100", "Body"): (lambda toy: toy.Body().iterations, 102),
    ("SCALE = 2.5", ""): (lambda toy: toy.nested(2.0), 1.5025),
    ("2", "nested.<lambda>"): (lambda toy: toy.nested(2.0), 2.5 / 1.001 - 1),
    ("0.25", "remembered"): (lambda toy: toy.remembered(), 0.25025),
    ("2", "count"): (lambda toy: toy.count(3), 7),
    ("0 < x", "inside"): (lambda toy: (toy.inside(0), toy.inside(1)), ([0], "inside")),
    ("not (k == x)", "inside"): (lambda toy: toy.inside(2), [0, 1]),
}
"""Text and function of a mutant of the toy -> what shows it, and its answer."""


def test_a_mutant_is_put_where_it_is_used(toy):
    def changed(mutant, ask):
        inject.put([mutant])
        return ask(toy)

    toy.remembered()
    mutants = {(m.text, m.function): m for m in find("toy_numbers", TOY)}
    tasks = [(key, lambda key=key, ask=ask: changed(mutants[key], ask)) for key, (ask, _) in USED.items()]
    found = in_forks(tasks)
    for key, (_, expected) in USED.items():
        assert found[key] == (pytest.approx(expected, rel=1e-14) if isinstance(expected, float) else expected)


def test_integer_is_a_number_beside_floats_alone():
    two, floats, whole = Number(2, 1.001), np.array([2.0, 4.0]), np.array([2, 4])
    assert (two * 3, 3 + two, 5**two, [4, 5, 6][two], len(range(two))) == (6, 5, 25, 6, 2)
    assert (two - np.arange(3)).dtype.kind == "i" and (np.array([1.0, 2.5]) > two).tolist() == [False, True]
    whole *= two  # only integers meet
    assert whole.tolist() == [4, 8] and not two.met
    assert (two * 1.5, 1.5 - two, 1 / two, two / 1) == pytest.approx((3.003, -0.502, 1 / 2.002, 2.002))
    floats *= two
    assert two.met and floats.tolist() == [4.004, 8.008]
    assert np.subtract(np.array([6.0]), two).tolist() == [6.0 - 2.002]
    np.testing.assert_allclose(whole / two, [4 / 2.002, 8 / 2.002])


def test_row_of_a_table_is_perturbed_and_forgotten_with_the_fork():
    rows = [m for m in mutants_of("sam.kernels.patches") if m.kind == "row" and "displacement 3,F3" in m.text]
    before = coefficients(Lags(3, 3, 1.0, 1.0), 0.3, z=0.5)

    def after(row):
        inject.put([row])
        return coefficients(Lags(3, 3, 1.0, 1.0), 0.3, z=0.5)

    tasks = [(k, lambda row=row: after(row)) for k, row in enumerate(rows)]
    answers = in_forks(tasks).values()
    assert answers and all(np.abs(answer / before - 1).max() > 1e-6 for answer in answers)
    np.testing.assert_array_equal(coefficients(Lags(3, 3, 1.0, 1.0), 0.3, z=0.5), before)


def test_every_constant_that_is_said_to_be_equivalent_or_explained_exists():
    keys = {mutant.key for name in scope.core() for mutant in mutants_of(name)}
    equal, explained = (scope.constants(which).keys() for which in ("equivalent", "explained"))
    assert equal and explained and equal <= keys and explained <= keys - equal


def survivor(function, text, module="m", kind="comparison", outcome="survived"):
    by = "tests/a.py::b[1]" if outcome == "killed" else ""
    return MutantVerdict(Mutant(module, kind, function, 0, text, 1), outcome, by, asked=1)


def test_what_was_killed_before_and_survives_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(frozen, "FILE", tmp_path / "frozen.csv")
    before = [survivor("f", "x < 1"), survivor("f", "x < 2", outcome="killed"), survivor("C.g", "y < 1")]
    frozen.write([*before, survivor("f", "3", kind="number", outcome="structure")], ["m"])
    assert [row["tests"] for row in frozen.read()] == [[], ["a.py::b"]]
    there = {("m", "f"), ("m", "C.g")}
    assert frozen.compare(before, there) == ({}, [])
    lost, gone = frozen.compare([survivor("f", "x < 2"), survivor("f", "x < 1")], there)
    assert lost == {"m:f:comparison:0": "x < 2: new, or killed before"} and not gone
    # f is found by its name in another module and class, g was merged into h
    there = {("n", "D.f"), ("n", "h"), ("other", "f")}
    now = [survivor("D.f", "x < 1", "n"), survivor("h", "y < 1", "n")]
    lost, gone = frozen.compare(now, there)
    assert not lost and gone == ["m:C.g, 0 numbers, 0 comparisons and 0 branches killed"]
    lost, _ = frozen.compare([*now, survivor("h", "z", "n")], there)
    assert lost == {"n:h:comparison:0": "z: of a function that the table does not have"}
    assert frozen.compare([survivor("i", "z", "other")], there)[0] == {}  # of a module that is not frozen
    (module, function, text), *_ = scope.constants("explained")
    core = [survivor(function, name, module, "number") for name in (text, "77.0")]
    assert [*frozen.compare(core, there)[0].values()] == ["77.0: a number of the core that is not explained"]


def test_the_frozen_table_and_the_draw_do_not_depend_on_places():
    assert all(row["branches"].isdigit() and row["function"] is not None for row in frozen.read())
    one = Mutant("verification.compare.rows", "branch", "A.f", 0, "not (x)", 1)
    moved = Mutant("verification.compare.others", "branch", "f", 3, "not (x)", 70)
    assert scope.drawn(one) == scope.drawn(moved)
    drawn = [scope.drawn(m) for name in scope.modules() for m in mutants_of(name) if not scope.whole(m)]
    assert np.mean(drawn) == pytest.approx(scope.PERCENT / 100, abs=0.03)
