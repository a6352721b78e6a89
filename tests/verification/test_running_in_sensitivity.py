# SPDX-License-Identifier: MIT
"""The study of what decides running-in, on made results: no run of it is solved."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import context, red
from made_studies import over_inputs

from sam.scene import resolved
from verification.cases.running_in import running_in_sensitivity as study
from verification.cases.running_in.running_in_deciders import Studied, deciders, least_change, two_most
from verification.cases.running_in.running_in_inputs import INPUTS, scene_at, wilson
from verification.cases.running_in.running_in_statements import BULK, DUCTILE, LAST, NAMES, STATEMENTS, A
from verification.figures.check import findings
from verification.sensitivity import UNIFORM, design
from verification.surrogate import Surrogate

CASE = study.CASES[0]
OF_THE_LAYER = {"depth", "deviation", "hardening", "layer-limit"}


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    here = context(CASE.name, tmp_path_factory.mktemp("scenes"))
    return {case: here.scene(f"running-in-{case}") for case in NAMES}


@pytest.fixture
def found(printed) -> Studied:
    return over_inputs(printed)


def at(scene, **shares):
    """The scene with each input in the middle of its range, but for these."""
    return resolved(scene_at(scene, [shares.get(one.name, 0.5) for one in INPUTS], 7))


@pytest.mark.parametrize("name", [one.name for one in INPUTS])
def test_an_input_changes_the_scenes_that_it_is_about_and_no_others(printed, name):
    for case in (BULK, A):
        changed = at(printed[case], **{name: 0.05}) != at(printed[case], **{name: 0.95})
        assert changed == (case == A or name not in OF_THE_LAYER)


def test_the_limit_of_the_ductile_layer_stays_its_multiple(printed):
    limits = [at(printed[case])["wear"]["strain_limit_layer"] for case in (A, DUCTILE)]
    assert limits[1] == pytest.approx(2.5 * limits[0], rel=1e-12)


def test_points_have_surfaces_of_their_own_and_all_materials_of_a_point_the_same(tmp_path):
    _, scenes = study.scenes_of(context(CASE.name, tmp_path))
    seeds = {}
    for (point, _), scene in scenes.items():
        seeds.setdefault(point, set()).add(scene.surface.seed)
    assert all(len(own) == 1 for own in seeds.values())
    assert len(set.union(*seeds.values())) == len(seeds)


def test_the_deciding_input_is_found(found):
    decided = [row for row in found.held if len(set(row[np.isfinite(row)])) > 1]
    assert len(decided) >= 10
    for row in decided:
        first, second = deciders(found.shares, row)[:2]
        low, high = first.bounds
        assert first.input.name == "deviation" and first.acts
        assert low < first.change <= high and low > 0.5
        assert abs(second.change) < 0.45
    assert two_most(found)[0][1].name == "deviation"
    correlations = found.correlations(A, "volume")
    assert INPUTS[np.abs(correlations).argmax()].name == "deviation"


def test_chance_names_no_input():
    """64 points, as many statements that no input decides: one of a thousand changes is beyond chance."""
    shares = design(UNIFORM, len(INPUTS), 64, 1)
    held = np.random.default_rng(1).integers(0, 2, (25, 64)).astype(float)
    named = [each.acts for row in held for each in deciders(shares, row)]
    assert len(named) == 25 * len(INPUTS) and sum(named) <= 2
    assert sum(not low <= 0.0 <= high for row in held for low, high in _bounds(shares, row)) >= 20


def test_a_change_within_chance_acts_only_where_a_believed_fit_names_the_input():
    """Of 16 points in each half it holds at 11 and at 5: beyond the bounds of 90 %, not of 99.9 %."""
    shares = np.full((32, len(INPUTS)), 0.4)
    shares[:16, 3] = 0.6
    held = np.r_[np.ones(11), np.zeros(5), np.ones(5), np.zeros(11)]
    moves = 0.6 * np.eye(len(INPUTS))[3]
    for predicted, parts, acts in ((0.6, moves, True), (0.4, moves, False), (0.6, 0.0 * moves, False)):
        (found,) = deciders(shares, held, Surrogate(predicted, parts, np.sign(parts)))
        assert found.input is INPUTS[3] and found.acts == acts and found.bounds[0] > 0.0
    assert not deciders(shares, held)[0].acts


def _bounds(shares, row):
    return [each.bounds for each in deciders(shares, row)]


@pytest.mark.parametrize("points", [32, 64, 128])
def test_what_a_study_resolves_is_what_acts_in_it(points):
    half = points // 2
    halves = np.repeat([0.0, 1.0], half)

    def acts(change):
        held = [np.arange(half) < round(half * (0.5 + sign * change / 2)) for sign in (-1, 1)]
        return deciders(np.column_stack([halves] * len(INPUTS)), np.concatenate(held).astype(float))[0].acts

    least, step = least_change(points), 2 / half
    assert not acts(least - step) and acts(least + step)


def test_a_lost_run_says_nothing_and_turns_the_gate_red(found):
    assert red(CASE.name, CASE.measure(found), whole=True) == set()
    for point in range(11):
        found.runs[point, A].result.converged = False
    assert red(CASE.name, CASE.measure(found)) == {"lost"}
    of_curve_a = [A in statement.cases for statement in STATEMENTS]
    assert np.isnan(found.held[:, :11]).all(axis=1).tolist() == of_curve_a
    del found.runs[3, BULK]
    assert "missing" in red(CASE.name, CASE.measure(found))


def test_tables_and_figures_can_be_read(found):
    tables = {table.caption: table for table in CASE.tables(found)}
    statements = next(table for caption, table in tables.items() if caption.startswith("Probability"))
    assert len(statements.rows) == len(STATEMENTS)
    assert sum("deviation of the layer" in row[4] for row in statements.rows) >= 10
    assert all(len(row) == len(table.columns) for table in tables.values() for row in table.rows)
    for plot in CASE.figures(found):
        assert list(findings(plot.drawing.figure)) == []


def test_bounds_of_a_probability():
    """The ends solve (p - k/n)^2 = z^2 p (1 - p)/n, with z = 1.6449 for 90 %: Wilson (1927)."""
    for end in wilson(81, 263):
        assert (end - 81 / 263) ** 2 == pytest.approx(1.644854**2 * end * (1.0 - end) / 263, rel=1e-5)
    low, high = wilson(81, 263)
    assert low < 81 / 263 < high
    assert wilson(0, 20)[0] == 0.0 and wilson(0, 0) == (0.0, 1.0)


def test_statements_are_not_judged_on_fewer_cycles(found):
    fewer = replace(found, effort=replace(found.effort, cycles=LAST - 1))
    assert found.judged and not fewer.judged
    assert not any(table.caption.startswith("Probability") for table in CASE.tables(fewer))
    assert list(CASE.figures(fewer)) == []
