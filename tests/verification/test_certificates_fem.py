# SPDX-License-Identifier: MIT
"""Certificates of finite elements hold, and see perturbed answers; endings of iterations, step cutting."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import last_released, with_column, with_field

import fem_reference.common.contact
import sam.plasticity.load_step
from fem_reference.common.contact import ended
from fem_reference.spatial import load_steps
from sam.contact.normal import Search, solve_contact
from sam.scene import FrictionMap, Status
from sam.scene.result import stagnates, unfinished
from verification.cases.case import Context, with_loading
from verification.cases.certificates import certificates, step_cutting
from verification.cases.certificates.certificates import PATCH_CELLS, rough, sliding, yielding_film
from verification.cases.recipes import Resolution
from verification.checks import axisymmetric as fem_checks, spatial as spatial_checks
from verification.checks.certificates import by_rule, curves_of, of_fem, of_spatial, solved
from verification.rows import load_rows
from verification.runs import models
from verification.runs.models import FEM, FEM_3D, SAM

LIMITS = {each.id: each.tolerance for each in load_rows()}


def limit(what: str) -> float:
    return LIMITS[f"certificates.fem-3d-{what}"]


@pytest.fixture(scope="module")
def context(tmp_path_factory):
    return Context("certificates", tmp_path_factory.mktemp("certificates"), "full", lambda *_: None)


@pytest.fixture(scope="module")
def slid(context):
    """(scene, result, records) of a sphere that slides on Swift steel."""
    scene = with_loading(sliding(context)["Swift, sliding"], steps=2)
    return scene, *solved(scene, FEM_3D)


@pytest.fixture(scope="module")
def patch(context):
    """The same of a rough patch under a map of friction, with few cells."""
    cells, PATCH_CELLS[FEM_3D] = PATCH_CELLS[FEM_3D], 13
    scene = with_loading(rough(context, FEM_3D)["rough, Swift"], steps=1)
    PATCH_CELLS[FEM_3D] = cells
    return scene, *solved(scene, FEM_3D)


def steps_of(solve, changes):
    """The first two steps, the second with other entries of its state, by functions of them."""
    scene, _, records = solve
    model, steps = load_steps(scene, records[-1])
    state = replace(
        steps[1].state, **{key: change(getattr(steps[1].state, key)) for key, change in changes.items()}
    )
    return [spatial_checks.Spatial(scene, model, step) for step in (steps[0], replace(steps[1], state=state))]


@pytest.mark.parametrize("name", ["slid", "patch"])
def test_all_conditions_hold(name, request):
    found = of_spatial(*request.getfixturevalue(name)).values
    assert set(found) == {
        key.removeprefix("certificates.fem-3d-") for key in LIMITS if "certificates.fem-3d-" in key
    }
    for what, value in found.items():
        assert value <= limit(what), what


class TestSteps:
    """What is formed anew of the displacements and histories."""

    def test_equilibrium(self, slid):
        def more(u):
            u = u.copy()
            u[u.size // 2] *= 1.0001
            return u

        assert steps_of(slid, {"u": more})[1].equilibrium()["equilibrium"] > limit("equilibrium")
        doubled = steps_of(slid, {"u": lambda u: 1.00001 * u})[1].equilibrium()
        assert doubled["load"] > limit("load") and doubled["friction"] > limit("friction")

    def test_a_node_that_pulls_is_no_longer_free(self, slid):
        pulling = steps_of(slid, {"active": last_released})[1]
        assert pulling.equilibrium()["equilibrium"] > limit("equilibrium")

    def test_another_coefficient(self, slid, patch):
        scene, result, records = slid
        other = scene.friction.model_copy(update={"coefficient": 0.2001})
        changed = scene.model_copy(update={"friction": other}), result, records
        assert steps_of(changed, {})[1].equilibrium()["friction"] > limit("friction")
        scene, result, records = patch
        given = scene.friction.path
        other = scene.friction.model_copy(update={"path": FrictionMap(given.values[:, ::-1], given.extent)})
        changed = scene.model_copy(update={"friction": other}), result, records
        assert spatial_checks.steps_of(scene, records)[0].equilibrium()["friction"] < limit("friction")
        assert spatial_checks.steps_of(changed[0], records)[0].equilibrium()["friction"] > limit("friction")

    @pytest.mark.parametrize("part", ["plastic_strain", "peeq"])
    def test_yield_and_flow(self, slid, part):
        before, now = steps_of(slid, {"history": lambda h: replace(h, **{part: 1.0001 * getattr(h, part)})})
        found = by_rule(now.flow(before))
        assert found["flow"] > limit("flow") and found["consistency"] > limit("consistency")


def returned(kind, name, change):
    """A result with a field of its mesh, or a column of a table, changed."""
    change_of = with_field if kind in ("point_data", "cell_data") else with_column
    return lambda result: change_of(result, kind, name, change)


RETURNED = [
    ("complementarity", returned("point_data", "uz_m", lambda u: 1.00001 * u)),
    ("load", returned("point_data", "p_Pa", lambda p: 1.00001 * p)),
    ("load", returned("point_data", "p_Pa", lambda p: p - 1e-6 * p.max())),
    ("friction", returned("line", "qx_Pa", lambda q: 1.00001 * q)),
]
HIGHER = "complementarity", returned("surface", "height_m", lambda height: 1.0001 * height)


@pytest.mark.parametrize(
    ("solve", "what", "change"),
    [(name, *each) for name in ("slid", "patch") for each in RETURNED] + [("patch", *HIGHER)],
)
def test_what_is_read_off_the_surface(solve, what, change, request):
    scene, result, _ = request.getfixturevalue(solve)
    assert spatial_checks.surface(scene, result)[what] <= limit(what)
    assert spatial_checks.surface(scene, change(result))[what] > limit(what)


@pytest.mark.parametrize("name", ["stress_Pa", "peeq", "plastic_strain"])
def test_what_is_read_off_the_elements(slid, name):
    scene, result, records = slid
    changed = with_field(result, "cell_data", name, lambda field: 1.0001 * field)
    assert spatial_checks.fields(spatial_checks.steps_of(scene, records), changed)[name] > limit("fields")


def test_a_film_in_three_dimensions(context):
    """Elastic: its steps are taken again. With the moduli of the body in the film there is no equilibrium."""
    scene = sliding(context)["film, sliding"]
    found = of_spatial(scene, models.solve(scene, FEM_3D), []).values
    assert all(value <= limit(what) for what, value in found.items())
    step = spatial_checks.steps_of(scene, [])[-1]
    other = scene.body.coating.model_copy(update={"young": 1.0001 * scene.body.coating.young})
    scene = scene.model_copy(update={"body": scene.body.model_copy(update={"coating": other})})
    assert spatial_checks.Spatial(scene, step.model, step).equilibrium()["equilibrium"] > limit("equilibrium")


def test_a_film_that_yields(context):
    """In the axisymmetric model: film and body flow by laws of their own, the film at its own yield
    stress.
    """
    scene = yielding_film(context)["film that yields"]
    result, records = solved(scene, FEM)
    for what, value in of_fem(scene, result, records).values.items():
        assert value <= LIMITS[f"certificates.fem-{what}"], what
    model, steps = fem_checks.steps_of(scene, records)
    inside = fem_checks.Finite(scene, model, steps[-2]).depths < scene.body.coating.thickness
    peeq = steps[-2].state.history.peeq
    assert peeq[inside].max() > 0 and peeq[~inside].max() > 0
    other = scene.body.coating.model_copy(update={"yield_stress": 0.9999 * scene.body.coating.yield_stress})
    softer = scene.model_copy(update={"body": scene.body.model_copy(update={"coating": other})})
    before, now = (fem_checks.Finite(softer, model, step) for step in steps[:2])
    assert now.yields() > LIMITS["certificates.fem-yield"]
    assert by_rule(now.flow(before))["consistency"] > LIMITS["certificates.fem-consistency"]


@pytest.fixture(scope="module")
def solves(context):
    """(scene, result, records) by name and model, on coarse grids."""
    level, certificates.LEVEL["full"] = certificates.LEVEL["full"], Resolution(6, 8)
    scenes = certificates.smooth(context)
    certificates.LEVEL["full"] = level
    pairs = [("Swift", SAM), ("elastic", SAM), ("elastic", FEM), ("Swift", FEM)]
    return {(name, model): (scenes[name], *solved(scenes[name], model)) for name, model in pairs}


@pytest.mark.parametrize("name", ["elastic", "Swift"])
def test_all_conditions_of_the_axisymmetric_model_hold(solves, name):
    """On coarse meshes its tractions and planes are less exact."""
    for what, value in of_fem(*solves[name, FEM]).values.items():
        assert value <= LIMITS[f"certificates.fem-{what}"] * (2.5 if what in ("surface", "planes") else 1.0)


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
        assert found["equilibrium"] > LIMITS["certificates.fem-equilibrium"] and found["load"] > 1e-7

    def test_a_node_that_pulls_is_no_longer_free(self, solves):
        _, finite, _ = self.changed(solves, active=last_released)
        assert finite.equilibrium()["equilibrium"] > LIMITS["certificates.fem-equilibrium"]

    @pytest.mark.parametrize("part", ["plastic_strain", "peeq"])
    def test_yield_and_flow(self, solves, part):
        def more(history):
            return replace(history, **{part: 1.0001 * getattr(history, part)})

        _, finite, before = self.changed(solves, history=more)
        found = by_rule(finite.flow(before))
        assert found["flow"] > LIMITS["certificates.fem-flow"]
        assert found["consistency"] > LIMITS["certificates.fem-consistency"]

    def test_planes_and_surface(self, solves):
        _, finite, _ = self.changed(solves, u=lambda u: 1.1 * u)
        depths, errors = finite.planes()
        assert np.abs(errors[depths < fem_checks.DEEPEST]).max() > LIMITS["certificates.fem-planes"]
        assert max(finite.surface().values()) > LIMITS["certificates.fem-surface"]


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
        monkeypatch.setattr(sam.plasticity.load_step, "ITERATIONS", 1)
        monkeypatch.setattr(sam.plasticity.load_step, "LONG_ITERATIONS", 1)
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
        return step_cutting.scene_of(context.scene("plastic-perfect"), 6.2, (4, 4), steps=2)

    def test_sam_cuts_and_goes_on(self, scene, monkeypatch):
        """With fewer iterations than two steps take, steps are cut; the answer is that of smaller steps."""
        whole = models.solve(scene, SAM)
        monkeypatch.setattr(sam.plasticity.load_step, "ITERATIONS", 14)
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
