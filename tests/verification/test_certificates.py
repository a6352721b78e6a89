# SPDX-License-Identifier: MIT
"""Certificates of returned solutions turn red on perturbed answers; endings of iterations in words; step
cutting; threads.
"""

import os
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_results import last_released, with_column, with_field

import fem_reference.common.contact
import sam.plasticity.step
from fem_reference.common.contact import ended
from sam import choose_grid
from sam.contact.normal import Search, solve_contact
from sam.scene import Status
from sam.scene.residuals import Attempt, residual_table, stagnates, unfinished
from verification.cases.case import Context
from verification.cases.certificates import certificates, certificates_scenes, step_cutting, threads
from verification.cases.certificates.certificates_measures import (
    by_rule,
    common,
    curves_of,
    of_fem,
    of_sam,
    solved,
)
from verification.cases.certificates.step_cutting import StepScene
from verification.cases.recipes import Resolution
from verification.checks import axisymmetric as fem_checks, cells as cell_checks, conditions as contact_checks
from verification.judging import RowStatus, evaluate
from verification.rows import load_rows
from verification.runs import models
from verification.runs.models import FEM, SAM


@pytest.fixture(scope="module")
def context(tmp_path_factory):
    return Context("certificates", tmp_path_factory.mktemp("certificates"), "quick", lambda *_: None)


@pytest.fixture(scope="module")
def solves(context):
    """(scene, result, records) by name and model, on coarse grids."""
    level, certificates_scenes.LEVEL["quick"] = certificates_scenes.LEVEL["quick"], Resolution(6, 8)
    scenes = certificates_scenes.smooth(context)
    certificates_scenes.LEVEL["quick"] = level
    pairs = [("elastic", SAM), ("Swift", SAM), ("elastic", FEM), ("Swift", FEM)]
    return {(name, model): (scenes[name], *solved(scenes[name], model)) for name, model in pairs}


def limit(gate: str) -> float:
    return next(each.tolerance for each in load_rows() if each.id == gate)


def scaled_at(k, factor):
    def change(values):
        values[k] *= factor
        return values

    return change


@pytest.mark.parametrize("name", ["elastic", "Swift"])
@pytest.mark.parametrize("model, measured, prefix", [(SAM, of_sam, "sam"), (FEM, of_fem, "fem")])
def test_all_conditions_hold(solves, name, model, measured, prefix):
    for what, value in measured(*solves[name, model]).values.items():
        allowed = limit(f"certificates.{prefix}-{what}")
        assert value <= (2.5 * allowed if what in ("surface", "planes") else allowed), what


class TestSam:
    """Each condition of a SAM result, right and perturbed."""

    def test_a_load_and_a_tension(self, solves):
        scene, result, _ = solves["Swift", SAM]
        more = with_field(result, "cell_data", "p_Pa", lambda p: 1.001 * p)
        assert contact_checks.load(scene, more)["load"] == pytest.approx(1e-3, rel=1e-6)
        pulled = with_field(
            result, "cell_data", "p_Pa", scaled_at(np.nanargmax(result.fields.cell_data["p_Pa"]), -1.0)
        )
        assert contact_checks.load(scene, pulled)["tension"] > limit("certificates.sam-load")

    def test_a_gap_in_contact(self, solves):
        scene, result, _ = solves["Swift", SAM]
        uz = with_column(result, "line", "uz_m", lambda u: 1.0001 * u)
        assert max(contact_checks.complementarity(scene, uz).values()) > limit(
            "certificates.sam-complementarity"
        )

    def test_the_displacement_of_an_elastic_contact(self, solves):
        scene, result, _ = solves["elastic", SAM]
        assert max(cell_checks.displaced(scene, result, []).values()) < 1e-9
        p = with_field(
            result, "cell_data", "p_Pa", scaled_at(np.nanargmax(result.fields.cell_data["p_Pa"]), 1.001)
        )
        assert max(cell_checks.displaced(scene, p, []).values()) > limit("certificates.sam-displacement")

    def test_the_stress_of_an_elastic_contact(self, solves):
        scene, result, _ = solves["elastic", SAM]
        more = with_field(result, "point_data", "stress_Pa", lambda stress: 1.00001 * stress)
        assert (
            cell_checks.stress(scene, result)
            < limit("certificates.sam-stress")
            < cell_checks.stress(scene, more)
        )

    @pytest.mark.parametrize("component", range(6))
    def test_the_displacement_by_plastic_strain(self, solves, component):
        """Of every component, under the load and after it."""
        scene, result, records = solves["Swift", SAM]
        trees = [record.tree() for record in records]
        for tree in trees:
            material = tree["state"]["points"]
            material["strain"] = np.array(material["strain"])
            material["strain"][component] *= 1.01
        changed = [SimpleNamespace(tree=lambda tree=tree: tree) for tree in trees]
        allowed = limit("certificates.sam-displacement")
        assert max(cell_checks.displaced(scene, result, records).values()) < allowed
        assert max(cell_checks.displaced(scene, result, changed).values()) > allowed
        assert cell_checks.left(scene, result, records) < allowed < cell_checks.left(scene, result, changed)

    def test_yield(self, solves):
        scene, result, _ = solves["Swift", SAM]
        softer = with_column(result, "plane", "peeq", lambda peeq: 0.99 * peeq)
        assert contact_checks.yields(scene, softer) > limit("certificates.sam-yield")

    @pytest.mark.parametrize("what, table, column", [
        ("yield", "plane", "mises_Pa"), ("surface", "axis", "szz_Pa"), ("complementarity", "line", "gap_m"),
    ])  # fmt: skip
    def test_without_force(self, solves, what, table, column):
        scene, result, _ = solves["Swift", SAM]
        assert contact_checks.unloaded(scene, result)[what] < limit(f"certificates.sam-{what}")
        size = {"mises_Pa": 5e9, "szz_Pa": 0.1 * result.quantities["p_max_Pa"], "gap_m": 1e-10}[column]
        more = with_column(result, table, column, lambda values: values + size)
        assert contact_checks.unloaded(scene, more)[what] > limit(f"certificates.sam-{what}")

    @pytest.mark.parametrize("name", ["strain", "stress", "peeq"])
    def test_flow(self, solves, name):
        """The increment along another direction, a stress that is not of it, a length that is not its own."""
        scene, _, records = solves["Swift", SAM]
        depths, records = choose_grid(scene).depths, records[:-1]  # the last one is that of unloading
        assert contact_checks.flow(scene, records, depths)["direction"] < limit("certificates.sam-flow")
        tree = records[-1].tree()
        owner = tree["last"] if name == "stress" else tree["state"]["points"]
        field = owner[name] = np.array(owner[name])
        field[(0, ...) if name != "peeq" else ...] *= 1.001
        changed = SimpleNamespace(tree=lambda: tree)
        found = by_rule(contact_checks.flow(scene, [*records[:-1], changed], depths))
        assert found["flow"] > limit("certificates.sam-flow")

    def test_tractions_and_planes(self, solves):
        scene, result, _ = solves["Swift", SAM]
        more = with_field(result, "point_data", "stress_Pa", lambda s: 1.2 * s)
        assert contact_checks.sam_surface(scene, more)["inside contact"] > limit("certificates.sam-surface")
        assert np.abs(contact_checks.sam_planes(scene, more)).max() > limit("certificates.sam-planes")


class TestFem:
    """Each condition of the axisymmetric FEM, right and perturbed."""

    def changed(self, solves, **keys):
        """The last step with other entries of its state, by functions of them."""
        scene, _, records = solves["Swift", FEM]
        model, steps = fem_checks.steps_of(scene, records)
        steps = [step for step in steps if not step.unloads]
        state = steps[-1].state
        state = replace(state, **{key: change(getattr(state, key)) for key, change in keys.items()})
        last, before = (
            fem_checks.Finite(scene, model, step) for step in (replace(steps[-1], state=state), steps[-2])
        )
        return scene, last, before

    def test_equilibrium(self, solves):
        _, finite, _ = self.changed(solves, u=lambda u: u * (1 + 1e-6))
        found = finite.equilibrium()
        assert found["equilibrium"] > limit("certificates.fem-equilibrium") and found["load"] > 1e-7

    def test_a_node_that_pulls_is_no_longer_free(self, solves):
        _, finite, _ = self.changed(solves, active=last_released)
        assert finite.equilibrium()["equilibrium"] > limit("certificates.fem-equilibrium")

    @pytest.mark.parametrize("part", ["plastic_strain", "peeq"])
    def test_yield_and_flow(self, solves, part):
        def more(history):
            return replace(history, **{part: 1.0001 * getattr(history, part)})

        _, finite, before = self.changed(solves, history=more)
        found = by_rule(finite.flow(before))
        assert found["flow"] > limit("certificates.fem-flow")
        assert found["consistency"] > limit("certificates.fem-consistency")

    def test_planes_and_surface(self, solves):
        _, finite, _ = self.changed(solves, u=lambda u: 1.1 * u)
        depths, errors = finite.planes()
        assert np.abs(errors[depths < fem_checks.DEEPEST]).max() > limit("certificates.fem-planes")
        assert max(finite.surface().values()) > limit("certificates.fem-surface")


def test_gates_turn_red():
    """Every gate of the three cases on an answer beyond it."""
    gates = [g for g in load_rows() if g.case in ("certificates", "step-cutting", "threads")]
    assert len(gates) == 58
    for gate in gates:
        value = 0.5 * gate.tolerance if gate.metric == "at_least" else 1.1 * gate.tolerance or 1
        measured = certificates.Measured(value, 0 if gate.metric == "equal" else None)
        assert evaluate([gate], {gate.case: {gate.id: measured}})[0].status is RowStatus.FAILED


class TestHistories:
    """What is kept of the iterations, and why they ended."""

    def test_every_iteration_has_a_row(self, solves):
        for (name, model), (_, result, _) in solves.items():
            table, history = result.tables["residuals"], result.tables["history"]
            curves = curves_of(result)
            assert len(curves) == np.count_nonzero(history["iterations"]) and all(
                each.accepted for _, each in curves
            )
            assert all(each.residuals[-1] <= each.goal for _, each in curves)
            if (name, model) != (
                "elastic",
                SAM,
            ):  # there iterations with pressures below zero have no residual
                assert len(table["step"]) == sum(history["iterations"])

    def test_a_step_that_ends_above_its_goal_is_seen(self, solves):
        scene, result, _ = solves["Swift", SAM]
        late = with_column(result, "residuals", "residual", lambda r: 1e3 * r)
        assert common(scene, late)["histories"] >= 5

    def test_rows_of_attempts(self):
        attempts = (Attempt(False, (1.0, 2.0), 0.1), Attempt(True, (0.5,), 0.1))
        table = residual_table([(1, 3, attempts)])
        assert (
            table["attempt"] == [1, 1, 2]
            and table["accepted"] == [0, 0, 1]
            and table["residual"] == [1.0, 2.0, 0.5]
        )
        assert Attempt.from_tree({"accepted": True, "residuals": [0.5], "goal": 0.1}) == attempts[1]

    def test_words(self):
        falling, flat = list(0.5 ** np.arange(30.0)), [*0.5 ** np.arange(20.0), *[2e-6] * 12]
        assert not stagnates(falling) and stagnates(flat)
        assert "ran out of iterations, 30" in unfinished("x", falling, 1e-12)
        assert "stagnated" in unfinished("x", flat, 1e-12) and "1.9e-06" in unfinished("x", flat, 1e-12)
        assert unfinished("x", [1.0, 30.0], 0.1) == unfinished("x", [0.1, np.nan], 0.1) == "x diverged"
        assert "positive definite" in ended([], False, False) and "comes" not in ended([0.1], True, False)
        assert "coming back" in ended([0.1], True, True)


class TestEndings:
    """An iteration that stagnates says something else than one that ran out of iterations."""

    gap = np.add.outer(np.linspace(-1, 1, 33) ** 2, np.linspace(-1, 1, 33) ** 2) * 1e-7

    def test_contact(self):
        few = solve_contact(self.gap, (1e-6, 1e-6), 1e11, 0.5, search=Search(max_iterations=4))
        assert not few.converged and "ran out of iterations" in few.ending
        flat = solve_contact(self.gap, (1e-6, 1e-6), 1e11, 0.5, search=Search(1e-19))
        assert not flat.converged and "stagnated" in flat.ending and flat.iterations < 1000
        fine = solve_contact(self.gap, (1e-6, 1e-6), 1e11, 0.5)
        assert fine.converged and not fine.ending and fine.residuals[-1] <= 1e-10

    def test_plastic_iteration_of_sam(self, solves, monkeypatch):
        monkeypatch.setattr(sam.plasticity.step, "ITERATIONS", 1)
        monkeypatch.setattr(sam.plasticity.step, "LONG_ITERATIONS", 1)
        result = models.solve(solves["Swift", SAM][0], SAM)
        assert result.status is Status.STEP_CUT_LIMIT
        assert (
            "a load step did not converge however often it was halved: raise" in result.message
            and "ran out of iterations, 2" in result.message
        )
        assert set(result.tables["residuals"]["accepted"]) >= {0}

    @pytest.mark.parametrize("name, constant, value, status, words", [
        ("Swift", "MAX_ITERATIONS", 2, Status.STEP_CUT_LIMIT, "ran out of iterations, 2"),
        ("elastic", "EQUILIBRIUM", 1e-17, Status.NOT_CONVERGED, "stagnated"),
    ])  # fmt: skip
    def test_newtons_method(self, solves, monkeypatch, name, constant, value, status, words):
        monkeypatch.setattr(fem_reference.common.contact, constant, value)
        result = models.solve(solves[name, FEM][0], FEM)
        assert result.status is status and f"Newton's method {words}" in result.message


class TestStepCutting:
    """Discarded attempts leave nothing behind, in both models."""

    @pytest.fixture
    def scene(self, context):
        return StepScene(6.2, 0.0).scene(context.scene("plastic-perfect"), (4, 4), 2)

    def test_sam_cuts_and_goes_on(self, scene, monkeypatch):
        """With fewer iterations than two steps take, steps are cut; the answer is that of smaller steps."""
        whole = models.solve(scene, SAM)
        monkeypatch.setattr(sam.plasticity.step, "ITERATIONS", 14)
        cut = models.solve(scene, SAM)
        assert whole.converged and whole.cost["step_cuts"] == 0
        assert (
            cut.converged
            and cut.cost["step_cuts"] > 0
            and any("cut into" in note for note in cut.tables["history"]["note"])
        )
        assert sum(not each.accepted for _, each in curves_of(cut)) == cut.cost["step_cuts"]
        assert cut.quantities["approach_m"] == pytest.approx(whole.quantities["approach_m"], rel=0.02)

    def test_fem_cuts_and_goes_on(self, scene):
        result = models.solve(
            scene.model_copy(update={"loading": scene.loading.model_copy(update={"steps": 1})}), FEM
        )
        assert result.converged and result.cost["step_cuts"] > 0
        assert result.tables["history"]["note"] == [f"cut into {result.cost['step_cuts'] + 1} steps"]
        assert sum(not each.accepted for _, each in curves_of(result)) == result.cost["step_cuts"]

    def test_gates_see_a_solve_that_did_not_finish(self, scene):
        sam_result = models.solve(scene, SAM)
        worse = replace(sam_result, status=Status.STEP_CUT_LIMIT)
        key = StepScene(6.2, 0.0)
        found = step_cutting.values_of({(key, SAM): worse, (key, FEM): sam_result})
        assert found["unfinished"].value == 1 and found["area"].value == 0.0


class TestThreads:
    """Differences between two results are found wherever they are."""

    def test_differences(self, solves):
        _, result, _ = solves["Swift", SAM]
        assert threads.difference(result, result) == 0.0
        for name, column in (("axis", "szz_Pa"), ("line", "gap_m"), ("plane", "peeq")):
            other = with_column(result, name, column, lambda values: values * (1 + 1e-9))
            assert threads.difference(result, other) == pytest.approx(1e-9, rel=1e-3)
        assert (
            threads.difference(result, with_field(result, "cell_data", "p_Pa", scaled_at(0, np.nan)))
            == np.inf
        )

    def test_statuses(self, solves):
        _, result, _ = solves["Swift", SAM]
        cut = replace(result, status=Status.STEP_CUT_LIMIT)
        assert [threads.unfinished(*pair) for pair in ((result, result), (result, cut), (cut, cut))] == [
            0,
            2,
            2,
        ]

    def test_cells(self):
        table = {"x_m": [0.0, 1.0, 2.0], "worn_m": [0.0, 1e-6, 0.0], "friction": [0.1, 0.4, np.nan]}
        one = SimpleNamespace(tables={"surface": table})
        assert threads.cells_apart(one, one) == (0, 0.0)
        two = SimpleNamespace(tables={"surface": table | {"friction": [0.4, 0.1, np.nan]}})
        assert threads.cells_apart(one, two) == (2, 0.0)
        three = SimpleNamespace(tables={"surface": table | {"worn_m": [1e-9, 1e-6, 0.0]}})
        assert threads.cells_apart(one, three) == (1, pytest.approx(1e-3))

    def test_rounding_about_zero(self):
        assert (
            threads.relative([1e-20], [-1e-20], 1e-15) == 0.0 and threads.relative([0.0], [1.0], 1e-15) == 1.0
        )


def test_threads_are_compared_on_two_cores_only(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    assert threads.needs() == ""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {1}, raising=False)
    assert threads.needs() == "2 cores are needed, this process may use 1"
