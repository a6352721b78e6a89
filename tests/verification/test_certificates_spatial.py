# SPDX-License-Identifier: MIT
"""Certificates of the three-dimensional FEM hold, and turn red on perturbed answers; those of a film that
yields.
"""

from dataclasses import replace

import pytest
from made_results import last_released, with_column, with_field

from fem_reference.spatial import load_steps
from sam.scene import FrictionMap
from verification.cases.case import Context, with_loading
from verification.cases.certificates.certificates_measures import by_rule, of_fem, of_spatial, solved
from verification.cases.certificates.certificates_scenes import PATCH_CELLS, rough, sliding, yielding_film
from verification.checks import axisymmetric as fem_checks, spatial as spatial_checks
from verification.rows import load_rows
from verification.runs import models
from verification.runs.models import FEM, FEM_3D

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

    def test_a_stress_beyond_yield(self, slid):
        _, now = steps_of(slid, {"u": lambda u: 1.001 * u})
        assert now.yields() > limit("yield")


class TestReturned:
    """What is read off the result."""

    @pytest.mark.parametrize("name", ["slid", "patch"])
    def test_surface(self, name, request):
        scene, result, _ = request.getfixturevalue(name)
        moved = with_field(result, "point_data", "uz_m", lambda u: 1.00001 * u)
        assert spatial_checks.surface(scene, moved)["complementarity"] > limit("complementarity")
        pressed = with_field(result, "point_data", "p_Pa", lambda p: 1.00001 * p)
        assert spatial_checks.surface(scene, pressed)["load"] > limit("load")
        pulled = with_field(result, "point_data", "p_Pa", lambda p: p - 1e-6 * p.max())
        assert spatial_checks.surface(scene, pulled)["load"] > limit("load")
        slipping = with_column(result, "line", "qx_Pa", lambda q: 1.00001 * q)
        assert spatial_checks.surface(scene, slipping)["friction"] > limit("friction")

    def test_penetration_without_force(self, slid):
        scene, result, _ = slid
        inside = with_column(result, "line", "gap_m", lambda gap: gap - 1e-12)
        assert spatial_checks.surface(scene, inside)["complementarity"] > limit("complementarity")

    def test_heights(self, patch):
        scene, result, _ = patch
        higher = with_column(result, "surface", "height_m", lambda height: 1.0001 * height)
        assert spatial_checks.surface(scene, higher)["complementarity"] > limit("complementarity")

    @pytest.mark.parametrize("name", ["stress_Pa", "peeq", "plastic_strain"])
    def test_fields(self, slid, name):
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
