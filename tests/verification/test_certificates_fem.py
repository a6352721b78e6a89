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
from sam.scene.result import Attempt, residual_table, stagnates, unfinished
from verification.cases.case import Context, with_loading
from verification.cases.certificates import certificates
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
    found = of_spatial(*request.getfixturevalue(name))
    assert set(found) == {
        key.removeprefix("certificates.fem-3d-") for key in LIMITS if "certificates.fem-3d-" in key
    }
    for what, value in found.items():
        assert value <= limit(what), what


def middle_node_moved(u):
    u = u.copy()
    u[u.size // 2] *= 1.0001
    return u


def more_of(part):
    """A history with 1.0001 times a part of it."""
    return lambda history: replace(history, **{part: 1.0001 * getattr(history, part)})


@pytest.mark.parametrize(
    ("changes", "seen"),
    [
        ({"u": middle_node_moved}, "equilibrium"),
        ({"u": lambda u: 1.00001 * u}, "load friction"),
        ({"active": last_released}, "equilibrium"),  # a node that pulls is no longer free
        ({"history": more_of("plastic_strain")}, "flow consistency"),
        ({"history": more_of("peeq")}, "flow consistency"),
        ({"u": lambda u: 1.001 * u}, "yield"),
    ],
)
def test_a_wrong_state_of_a_step_is_seen(slid, changes, seen):
    before, now = steps_of(slid, changes)
    found = now.equilibrium() | by_rule(now.flow(before)) | {"yield": now.yields()}
    assert all(found[what] > limit(what) for what in seen.split())


def test_another_coefficient_is_seen(slid, patch):
    scene, _, records = patch
    given = scene.friction.path
    mirrored = {"path": FrictionMap(given.values[:, ::-1], given.extent)}
    for (scene, _, records), other in ((slid, {"coefficient": 0.2001}), (patch, mirrored)):
        changed = scene.model_copy(update={"friction": scene.friction.model_copy(update=other)})
        right, wrong = (spatial_checks.steps_of(each, records)[0].equilibrium() for each in (scene, changed))
        assert right["friction"] < limit("friction") < wrong["friction"]


BOTH = ("slid", "patch")
WRONG = [
    (BOTH, lambda r: with_field(r, "point_data", "uz_m", lambda u: 1.00001 * u), "complementarity"),
    (BOTH, lambda r: with_field(r, "point_data", "p_Pa", lambda p: 1.00001 * p), "load"),
    (BOTH, lambda r: with_field(r, "point_data", "p_Pa", lambda p: p - 1e-6 * p.max()), "load"),
    (BOTH, lambda r: with_column(r, "line", "qx_Pa", lambda q: 1.00001 * q), "friction"),
    (BOTH[:1], lambda r: with_column(r, "line", "gap_m", lambda gap: gap - 1e-12), "complementarity"),
    (BOTH[1:], lambda r: with_column(r, "surface", "height_m", lambda h: 1.0001 * h), "complementarity"),
]


@pytest.mark.parametrize(("names", "change", "seen"), WRONG)
def test_what_is_returned_wrong_is_seen(names, change, seen, request):
    """Penetration after unloading on the sphere, heights of the patch."""
    for name in names:
        scene, result, _ = request.getfixturevalue(name)
        assert spatial_checks.surface(scene, change(result))[seen] > limit(seen)


def test_fields_of_elements_that_are_returned_wrong_are_seen(slid):
    scene, result, records = slid
    steps = spatial_checks.steps_of(scene, records)
    for name in ("stress_Pa", "peeq", "plastic_strain"):
        changed = with_field(result, "cell_data", name, lambda field: 1.0001 * field)
        assert spatial_checks.fields(steps, changed)[name] > limit("fields")


def test_a_film_in_three_dimensions(context):
    """Elastic: its steps are taken again. With the moduli of the body in the film there is no equilibrium."""
    scene = sliding(context)["film, sliding"]
    found = of_spatial(scene, models.solve(scene, FEM_3D), [])
    assert all(value <= limit(what) for what, value in found.items())
    step = spatial_checks.steps_of(scene, [])[-1]
    other = scene.body.coating.model_copy(update={"young": 1.0001 * scene.body.coating.young})
    scene = scene.model_copy(update={"body": scene.body.model_copy(update={"coating": other})})
    assert spatial_checks.Spatial(scene, step.model, step).equilibrium()["equilibrium"] > limit("equilibrium")


def test_a_film_that_yields(context):
    """Film and body flow by laws of their own, the film at its own yield stress."""
    scene = yielding_film(context)["film that yields"]
    result, records = solved(scene, FEM)
    for what, value in of_fem(scene, result, records).items():
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
    for what, value in of_fem(*solves[name, FEM]).items():
        assert value <= LIMITS[f"certificates.fem-{what}"] * (2.5 if what in ("surface", "planes") else 1.0)


@pytest.mark.parametrize(
    ("changes", "seen"),
    [
        ({"u": lambda u: u * (1 + 1e-6)}, "equilibrium"),
        ({"active": last_released}, "equilibrium"),
        ({"history": more_of("plastic_strain")}, "flow consistency"),
        ({"history": more_of("peeq")}, "flow consistency"),
        ({"u": lambda u: 1.1 * u}, "planes surface"),
    ],
)
def test_a_wrong_state_of_the_axisymmetric_model_is_seen(solves, changes, seen):
    """In the last step of loading."""
    scene, _, records = solves["Swift", FEM]
    model, steps = fem_checks.steps_of(scene, records)
    *_, before, last = [step for step in steps if not step.unloads]
    state = replace(last.state, **{key: of(getattr(last.state, key)) for key, of in changes.items()})
    finite = fem_checks.Finite(scene, model, replace(last, state=state))
    depths, errors = finite.planes()
    found = finite.equilibrium() | by_rule(finite.flow(fem_checks.Finite(scene, model, before)))
    found |= {"surface": max(finite.surface().values())}
    found |= {"planes": np.abs(errors[depths < fem_checks.DEEPEST]).max()}
    assert all(found[what] > LIMITS[f"certificates.fem-{what}"] for what in seen.split())


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

    def test_rows_of_attempts(self):
        attempts = (Attempt(False, (1.0, 2.0), 0.1), Attempt(True, (0.5,), 0.1))
        table = residual_table([(1, 3, attempts)])
        assert (
            table["attempt"] == [1, 1, 2]
            and table["accepted"] == [0, 0, 1]
            and table["residual"] == [1.0, 2.0, 0.5]
        )

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
