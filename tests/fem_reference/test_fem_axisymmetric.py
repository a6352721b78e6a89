# SPDX-License-Identifier: MIT
"""The axisymmetric model: record, statuses, estimates; load steps and given approaches; coatings."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import MODULUS, PERFECT, RADIUS, SHAPES, SPHERE, STEEL, SWIFT, hertz_force, scene as small_scene

import fem_reference
import fem_reference.spatial
from fem_reference.axisymmetric import planner
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common import loading
from fem_reference.common.bodies import Coating, Elastic, expected_radius
from fem_reference.common.contact import ActiveSet
from fem_reference.common.far_field import boussinesq, cerruti
from fem_reference.common.hertz import force_of_approach
from fem_reference.common.layered_force import normal, tangential
from fem_reference.common.loading import Step, run
from fem_reference.common.refusals import advice_of
from fem_reference.common.schedule import Load
from sam.scene.result import COLUMNS, COST, QUANTITIES, Status
from sam.scene.schema import Scene

PUNCH = {"shape": "punch", "radius": RADIUS}


def scene(cells=8, counter=SPHERE, *, poisson=0.3, plasticity=None, **loading):
    return small_scene(
        body={"poisson": poisson, "plasticity": plasticity},
        counterbody=counter,
        loading=loading,
        fem={"cells_per_radius": cells},
    )


def test_record_is_complete():
    result = fem_reference.solve(scene(unload=True, cycles=2))
    assert result.model == "fem-axisymmetric" and tuple(result.quantities) == QUANTITIES
    assert result.quantities["p_max_change"] is None and result.quantities["mises_max_film_Pa"] is None
    assert tuple(result.cost) == (*COST, "factorizations", "linear_iterations")
    assert set(result.tables) == {"history", "axis", "line", "plane", "cycles", "residuals"}
    for name, table in result.tables.items():
        assert tuple(table) == COLUMNS[name] and len({len(column) for column in table.values()}) == 1
    for name in ("axis", "line", "plane"):
        assert list(dict.fromkeys(result.tables[name]["state"])) == ["peak", "unloaded"]
    assert result.message == "" and result.cost["contact_iterations"] >= 1
    assert {"dofs", "elements", "h_m", "box_m", "cells_per_radius"} <= set(result.discretisation)
    assert max(result.certificate.values()) < 1e-8
    mesh = result.fields
    assert mesh.points[:, 1].max() == 0.0
    assert mesh.point_data["p_Pa"].max() == pytest.approx(result.quantities["p_max_Pa"], rel=1e-12)
    assert mesh.cell_data["stress_Pa"].shape == (len(mesh.cells["quad"]), 6)
    assert mesh.cell_data["mises_Pa"].max() < result.quantities["mises_max_Pa"]
    corners = mesh.points[mesh.cells["quad"]]
    x, z = corners[..., 0], corners[..., 2]
    area = 0.5 * np.abs(np.sum(x * np.roll(z, -1, axis=1) - np.roll(x, -1, axis=1) * z, axis=1))
    assert area.sum() == pytest.approx(result.discretisation["box_m"] ** 2, rel=1e-12)


def test_a_punch_is_singular_and_has_no_gap_beside_it():
    result = fem_reference.solve(scene(counter=PUNCH))
    line = {name: np.asarray(values) for name, values in result.tables["line"].items()}
    beside = line["x_m"] > RADIUS * (1 + 1e-12)
    assert result.quantities["contact_radius_m"] == RADIUS
    assert not line["p_Pa"][beside].any() and np.isnan(line["gap_m"][beside]).all()
    assert any("singular" in warning for warning in result.warnings)
    assert max(result.certificate.values()) < 1e-8


@pytest.mark.parametrize("made", [scene(force=0.0), scene(counter=PUNCH, force=0.0, steps=2, unload=True)])
def test_no_force(made):
    result = fem_reference.solve(made)
    assert result.status is Status.CONVERGED
    q, zero = result.quantities, ("force_N", "approach_m", "contact_area_m2", "p_max_Pa", "mises_max_Pa")
    assert [q[name] for name in zero] == [0.0] * len(zero) and q["mises_max_depth_m"] is None
    assert not any(result.tables["history"]["force_N"]) and not result.tables["line"]["p_Pa"].any()
    assert not result.tables["plane"]["mises_Pa"].any() and np.isfinite(result.tables["axis"]["z_m"]).all()


# --- statuses ---


@pytest.mark.parametrize("counter", [SPHERE, PUNCH])
def test_status_under_resolved(counter):
    coarse, fine = (fem_reference.solve(scene(n, counter)) for n in (3, 4))
    assert coarse.status is Status.UNDER_RESOLVED and "fem.cells_per_radius" in coarse.message
    assert fine.status is Status.CONVERGED


@pytest.mark.parametrize(
    ("core", "keys"),
    [("ELASTIC", {}), ("plastic_core", {"plasticity": PERFECT, "force": hertz_force(4e9), "steps": 4})],
)
def test_status_contact_at_the_edge_of_the_fine_mesh(monkeypatch, core, keys):
    small = planner.Core(0.9, 0.8)
    monkeypatch.setattr(planner, core, small if core == "ELASTIC" else lambda radius: small)
    result = fem_reference.solve(scene(**keys))
    assert result.status is Status.CONTACT_AT_GRID_EDGE and "loading.force" in result.message


def test_status_plastic_zone_at_the_edge():
    made = scene(4, plasticity=PERFECT, force=hertz_force(6e9), steps=10)
    made = made.model_copy(update={"fem": made.fem.model_copy(update={"box": 2.6})})
    result = fem_reference.solve(made)
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "fem.box" in result.message


def test_status_not_converged(monkeypatch):

    def restless(self, _multipliers, _gaps):
        self.stuck = True
        return True

    monkeypatch.setattr(ActiveSet, "update", restless)
    result = fem_reference.solve(scene())
    assert result.status is Status.NOT_CONVERGED and "did not settle" in result.message


# --- estimates, which set meshes ---

APPROACH = 2e-7
FLAT = SHAPES["rounded-punch"] | {"radius": RADIUS}


def law(slope):
    return (
        {"law": "linear", "yield_stress": 1e8, "modulus": slope} if slope else PERFECT | {"yield_stress": 1e8}
    )


@pytest.mark.parametrize("slope", [0.0, 1e10])
def test_the_estimated_force_ends_at_three_yield_stresses_below_the_surface(slope):
    """Of hardening steel at the representative strain 0.2 sqrt(2 R d)/R (Tabor); of an edge too."""
    beyond = np.sqrt(2 * RADIUS * APPROACH)
    for counter, area in ((SPHERE, np.pi * beyond**2), (FLAT, np.pi * (FLAT["flat_radius"] + beyond) ** 2)):
        wanted = 3 * area * (1e8 + slope * 0.2 * beyond / RADIUS)
        made = small_scene(body={"plasticity": law(slope)}, counterbody=counter)
        assert force_of_approach(made, APPROACH) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(
    ("thickness", "modulus", "punch"),
    [
        (1e-12, MODULUS, False),
        (1e-3, 80e9 / (1 - 0.2**2), False),
        (None, MODULUS, False),
        (None, MODULUS, True),
    ],
)
def test_the_estimated_force_of_an_elastic_body_is_that_of_hertz_or_of_a_punch(thickness, modulus, punch):
    """With a coating that of its material or of the body's, where the other does not count."""
    coating = thickness and {"thickness": thickness, "young": 80e9, "poisson": 0.2}
    made = small_scene(body={"coating": coating}, counterbody=PUNCH if punch else SPHERE)
    wanted = 2 * modulus * RADIUS * APPROACH if punch else 4 / 3 * modulus * np.sqrt(RADIUS) * APPROACH**1.5
    assert force_of_approach(made, APPROACH) == pytest.approx(wanted, rel=1e-6)


def test_the_expected_radius_of_a_coated_contact_is_between_those_of_the_materials():
    """a^3 is as the compliance."""
    for thickness, ratio in ((1e-12, 1.0), (1e-3, 80e9 / (1 - 0.2**2) / MODULUS)):
        coating = {"thickness": thickness, "young": 80e9, "poisson": 0.2}
        made = small_scene(body={"coating": coating})
        assert expected_radius(made) == pytest.approx(ratio ** (-1 / 3), rel=1e-5)


# --- load steps: plastic history ---

YIELD = {"swift": 945e6 * 20**0.121, "perfect": 1e9, "profile": 1e9}
PROFILE = [[0.0, 1.3], [1e-6, 1.3], [4e-6, 1.0]]
LAWS = {"swift": SWIFT, "perfect": PERFECT, "profile": PERFECT | {"profile": PROFILE}}


def pressed(law="swift", ratio=4.0, cells=8, steps=10, **keys):
    """A sphere whose Hertz pressure is `ratio` times the yield stress."""
    force = hertz_force(ratio * YIELD[law or "swift"])
    return scene(
        cells, plasticity=law and LAWS[law], **{"force": force, "steps": steps, "unload": True} | keys
    )


def made(law="swift", ratio=4.0, cells=8, steps=10) -> tuple[Model, list[Step]]:
    model = build(plan(pressed(law, ratio, cells, steps, unload=False)))
    return model, run(model, model.plan.schedule)


loaded = cache(made)


@pytest.mark.parametrize("law", ["swift", "perfect"])
def test_elastic_below_yield(law):
    """p0 = 1.5 Y: yield starts at 1.61 Y; every number equals the elastic answer, bit by bit."""
    plastic = fem_reference.solve(pressed(law, 1.5, steps=3))
    elastic = fem_reference.solve(pressed(None, steps=3, force=hertz_force(1.5 * YIELD[law])))
    assert plastic.quantities == elastic.quantities | {"peeq_max": 0.0}
    for name, table in elastic.tables.items():
        for column, values in table.items():
            np.testing.assert_array_equal(plastic.tables[name][column], values, f"{name} {column}")


def test_a_depth_profile_acts_at_each_point():
    """Factor 1.3 down to 1 um: it is that of the depth, and there is less plastic strain than without."""
    model, steps = loaded("profile", steps=4)
    depth, factor = model.body.points[1] * model.scales.length, model.problem.material.factor
    assert factor == pytest.approx(np.interp(depth, [1e-6, 4e-6], [1.3, 1.0]))
    plain = loaded("perfect", steps=4)[1][-1].state
    assert steps[-1].state.history.peeq.max() < plain.history.peeq.max()


@pytest.mark.parametrize("thickness", [0.28, 0.32])
def test_the_mesh_has_a_line_where_the_yield_stress_has_a_kink(monkeypatch, thickness):
    """Both ends of a weak layer lie in one row of elements 1/8 high. The largest strain is that of points,
    of no parabola through the kink there.
    """
    a = np.pi * 4 * YIELD["swift"] * RADIUS / (2 * 210e9 / 0.91)
    layer = {"B": 9450e6, "profile": [[thickness * a, 0.1], [1.5 * thickness * a, 1.0]]}
    monkeypatch.setitem(LAWS, "swift", SWIFT | layer)
    result = fem_reference.solve(pressed(unload=False, steps=4))
    faces = np.unique(result.fields.points[:, 2]) / a
    assert np.abs(faces - thickness).min() < 1e-9 > np.abs(faces - 1.5 * thickness).min()
    largest = max(result.tables[name]["peeq"].max() for name in ("axis", "plane"))
    assert 0 < result.quantities["peeq_max"] == pytest.approx(largest, rel=1e-3)


# --- unloading and halved steps ---


def test_reverse_yielding_is_found_and_unloaded_in_steps():
    """Under a punch at 2.5 Y the edge yields backwards: as many steps as asked for, and strain added."""
    load = {"force": 2.5 * np.pi * 1e-10 * 1e9, "steps": 10, "unload": True, "unload_steps": 4}
    s = scene(6, {"shape": "punch", "radius": 1e-5}, plasticity=PERFECT, **load)
    model = build(plan(s))
    steps = run(model, model.plan.schedule)
    assert [step.unloads for step in steps] == [False] * 10 + [True] * 4
    assert all(step.state.converged for step in steps)
    peak, end = steps[9].state, steps[-1].state
    assert (end.history.peeq - peak.history.peeq).max() > 1e-3 * peak.history.peeq.max()
    assert not end.active.any()
    stress = model.body.stress(model.problem.body(end.u, 0), end.history.plastic_strain)
    assert model.problem.material.excess(stress, end.history).max() < 1e-10
    assert max(step.state.residual for step in steps) < 1e-9


def test_weak_steps_finish_by_cutting():
    """Perfect plasticity in one load step: Newton fails, the step is halved, and the cuts are counted."""
    result = fem_reference.solve(pressed("perfect", steps=1))
    assert result.status is Status.CONVERGED and result.cost["step_cuts"] >= 1
    assert result.quantities["force_N"] == pytest.approx(hertz_force(4e9), rel=1e-9)
    assert result.tables["history"]["iterations"][0] == result.cost["newton_iterations"] - 1


def test_parts_of_a_cut_step_begin_with_the_nodes_of_the_last(monkeypatch):
    """A whole step begins with nodes scaled with the force, its halves with those that touch."""
    model, steps = loaded(cells=4, steps=3)
    state, begun = steps[1].state, []

    def tried(problem, load, start, **_):
        begun.append((load.force, start))
        return replace(steps[2].state, load=load, converged=len(begun) > 2)

    monkeypatch.setattr("fem_reference.common.model.equilibrium", tried)
    step = loading.advance(model, Load(2.0 * state.force), state)
    forces = [force / state.force for force, _ in begun[:3]]
    assert step.cuts == 2 and step.state.converged and forces == pytest.approx([2.0, 1.5, 1.25])
    assert begun[0][1].sum() > state.active.sum()
    assert all(np.array_equal(start, state.active) for _, start in begun[1:3])


# --- given approaches ---

COARSE, CYCLES = {"cells_per_radius": 4, "box": 5}, {"steps": 3, "unload": True, "cycles": 2}
WAVE = {"kind": "self-affine", "sq": 2e-8, "hurst": 0.8, "cutoff_long": 2e-5, "cutoff_short": 5e-6, "seed": 1}
KINDS = {
    "elastic": (fem_reference, {"counterbody": STEEL, "loading": CYCLES}),
    "sliding": (fem_reference.spatial, {"body": {"plasticity": SWIFT}, "friction": 0.2}),
    "rough": (fem_reference.spatial, {"surface": WAVE, "grid": {"cells": (8, 8), "extent": (1e-5, 1e-5)}}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_gives_the_approach(kind):
    """It is that of the result, of a mesh that is planned with an estimate of the force."""
    model, tables = KINDS[kind]
    loading = tables.get("loading", {}) | {"force": None, "approach": 0.3e-6}
    found = model.solve(small_scene(**tables | {"fem": COARSE, "loading": loading})).quantities["approach_m"]
    assert found == pytest.approx(0.3e-6, rel=1e-12)


def dented(fem, approach, steps):
    """Perfect plasticity, two cycles to an approach: the second begins above the dent of the first."""
    given = {"force": None, "approach": approach, "steps": steps, "unload": True, "cycles": 2}
    result = fem_reference.solve(small_scene(fem=fem, body={"plasticity": PERFECT}, loading=given))
    assert result.status is Status.CONVERGED
    return result.tables["history"]


def test_steps_in_a_dent_do_not_touch():
    """The first step of the second cycle ends above the dent of the first, without force, at its approach."""
    history = dented(COARSE, 0.3e-6, 5)
    at = {place: k for k, place in enumerate(zip(history["cycle"], history["step"], strict=True))}
    assert history["approach_m"][at[2, 1] - 1] > 0.06e-6  # unloaded
    assert history["force_N"][at[2, 1]] == 0.0
    assert history["approach_m"][at[2, 1]] == pytest.approx(0.06e-6, rel=1e-12)


def test_a_step_into_a_dent_is_halved_from_where_the_bodies_touch():
    """Not from no approach: most of the halves would end where the bodies are apart, and use the cuts up."""
    assert any("cut" in note for note in dented(COARSE, 0.312e-6, 4)["note"])


# --- coatings ---

NU, A = 0.3, 6e-6


def coated(h=0.1, ratio=80 / 210, cells=4, box=10, *, flow=None, p0=None, bare=False, **tables):
    """A sphere, a coating of h contact radii; p0: Hertz pressure on the body alone; flow: yield stress."""
    a = A if p0 is None else np.pi * p0 * RADIUS / (2 * MODULUS)
    coating = {"thickness": h * a, "young": ratio * STEEL["young"], "poisson": NU, "yield_stress": flow}
    loading = {"force": 4 / 3 * MODULUS * a**3 / RADIUS} | tables.pop("loading", {})
    body = {"coating": None if bare else coating} | tables.pop("body", {})
    return small_scene(body=body, loading=loading, fem={"cells_per_radius": cells, "box": box}, **tables)


# --- the point force ---


def test_layered_point_force_far_away():
    """Limits: none, equal materials, infinitely thick (that half-space, to 2e-5 of the difference)."""
    r, z = np.array([10.0, 10.0, 10.0, 5.0, 0.0]), np.array([0.0, 1.0, 9.0, 10.0, 10.0])
    points, body = np.stack([r * np.cos(0.7), r * np.sin(0.7), z]), Elastic(1.0, NU)
    for young in (0.38, 100.0):
        thick, thin, stuff = Coating(1e7, young, 0.2), Coating(1e-9, young, 0.2), Elastic(young, 0.2)
        for added, coated, bare in (
            (normal(thick, body, r, z), boussinesq(1.0, stuff, r, z), boussinesq(1.0, body, r, z)),
            (tangential(thick, body, points), cerruti(1.0, stuff, points), cerruti(1.0, body, points)),
        ):
            assert np.abs(added - (coated - bare)).max() < 2e-5 * np.abs(coated - bare).max()
        assert np.abs(normal(thin, body, r, z)).max() < 1e-9
        assert np.abs(tangential(thin, body, points)).max() < 1e-9
    same = Coating(1.0, 1.0, NU)
    assert np.abs(normal(same, body, r, z)).max() < 1e-12
    assert np.abs(tangential(same, body, points)).max() < 1e-12


def test_layered_point_force_is_reciprocal():
    """Betti: on the surface u_r under a normal force is minus u_z there under a tangential one."""
    film, body, x = Coating(1.5, 0.4, 0.2), Elastic(1.0, NU), np.array([7.0, 10.0])
    zero = np.zeros_like(x)
    of_tangential = tangential(film, body, np.stack([x, zero, zero]))[2]
    assert normal(film, body, x, zero)[0] == pytest.approx(-of_tangential, rel=1e-9)


# --- contacts ---


def test_a_coating_of_the_body_changes_nothing():
    """To rounding on its own mesh."""
    q = fem_reference.solve(coated(0.1, 1.0)).quantities
    assert abs(q["p_max_change"]) < 1e-11 and abs(q["mises_max_change"]) < 1e-11
    bare = fem_reference.solve(coated(bare=True)).quantities
    assert bare["p_max_change"] is None and bare["mises_max_film_Pa"] is None


def test_record():
    """All names and columns, the largest von Mises stress of coating and body, what is left out."""
    result = fem_reference.solve(coated(0.5, cells=6, loading={"unload": True}))
    q = result.quantities
    assert tuple(q) == QUANTITIES
    assert all(tuple(table) == COLUMNS[name] for name, table in result.tables.items())
    assert q["mises_max_Pa"] == max(q["mises_max_film_Pa"], q["mises_max_substrate_Pa"])
    for of, name in (("p_max_Pa", "p_max"), ("mises_max_substrate_Pa", "mises_max")):
        assert q[f"{name}_change"] == pytest.approx(q[of] / q[f"{name}_bare_Pa"] - 1, abs=1e-15)
    assert result.discretisation["film_layers"] >= 2 and max(result.certificate.values()) < 1e-8
    stages = [entry.stage for entry in result.left_out]
    assert "film elements" not in stages and "return mapping and plastic history" in stages
    z, interface = result.tables["axis"]["z_m"], 0.5 * A
    first = int(np.searchsorted(z[: len(z) // 2], interface * (1 - 1e-12)))
    assert z[first] == pytest.approx(interface, rel=1e-12)  # the first row of the body
    plane = np.asarray(result.tables["plane"]["z_m"])
    assert not np.isclose(plane, interface, rtol=1e-6).any()  # Gauss points, none on the interface


def test_other_contacts():
    """An elastic counter-body, a punch, a given pressure, no force."""
    steel, punch, unloaded = (
        fem_reference.solve(coated(0.5, cells=8, **tables))
        for tables in (
            {"counterbody": SPHERE | STEEL},
            {"counterbody": {"shape": "punch", "radius": A}},
            {"loading": {"force": 0.0}},
        )
    )
    assert steel.converged and punch.converged and unloaded.converged
    assert unloaded.quantities["p_max_change"] is None and unloaded.quantities["mises_max_film_Pa"] == 0.0
    content = coated(0.5, cells=8).model_dump() | {"counterbody": None}
    q = fem_reference.solve(
        Scene(**content | {"loading": {"prescribed": "hertz", "p0": 1e9, "radius": A}})
    ).quantities
    assert q["p_max_change"] == 0.0 and q["mises_max_change"] < 0.0


def test_film_that_flows_away_is_not_converged():
    """A coating sheared by more than its length is no result, and the message names the pressure."""
    advice = advice_of(coated(flow=0.67e9, friction=0.1))
    assert advice.outcome(Status.CONVERGED, 0.05) == (Status.CONVERGED, "")
    status, message = advice.outcome(Status.CONVERGED, 11.0)
    assert status is Status.NOT_CONVERGED and "3.868e+09 Pa" in message and "yield_stress" in message
    status, message = advice.outcome(Status.STEP_CUT_LIMIT, 0.0)
    assert status is Status.STEP_CUT_LIMIT and message.startswith("a load step did not converge")
    assert "friction.coefficient" in message
    _, message = advice_of(coated(ratio=2.0)).outcome(Status.NOT_CONVERGED, 0.0)
    assert "too thin and stiff for the digits of a double" in message
