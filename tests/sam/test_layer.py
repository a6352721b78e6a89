# SPDX-License-Identifier: MIT
"""A layer with a hardening law of its own: what a scene may say of it, its curve over depth, and a body whose
layer is of the same law.
"""

import numpy as np
import pytest
from builders import HARDENING, LINEAR, RUN_IN_STEEL, SWIFT, YIELD_CURVE, running_in, scene, scene_text

import fem_reference
import sam
from fem_reference.common.bodies import Elastic
from fem_reference.common.plasticity import J2, History
from fem_reference.spatial.planner import plan as spatial_plan
from sam.plasticity.flow import plastic_multiplier
from sam.scene import Plasticity, load_scene, parse_scene
from sam.scene.body import LAWS
from sam.scene.section import SceneError
from sam.scene.yield_curve import DepthProfile, Kinks, Linear, Strength, Swift
from verification.checks.material import yield_stress
from verification.cost.advice import advice_of

BODY = HARDENING["swift"] + 'layer_thickness = "1 um"\n'
SOFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121, "alpha": 1e3}
THICK = 1.2e-6
DEPTHS = np.array([0.0, 0.4e-6, 1.1999e-6, 1.2e-6, 3e-6])


def layered(law: str, body: str = BODY, more: str = "") -> str:
    return scene_text(add=f"[body.plasticity]\n{body}[body.plasticity.layer]\n{law}{more}")


def test_a_layer_elsewhere_is_told_its_place():
    with pytest.raises(SceneError, match=r"did you mean \[body.coating\] or \[body.plasticity.layer\]\?"):
        parse_scene(scene_text(add="[layer]\nalpha = 1e3\n").encode(), "scene.toml")


@pytest.mark.parametrize("law", LAWS)
class TestEveryLaw:
    """The body hardens linearly, its factor goes from 2 at the surface to 1 at 3 um."""

    @pytest.fixture
    def read(self, law, tmp_path):
        (tmp_path / "curve.csv").write_text(YIELD_CURVE)
        (tmp_path / "p.csv").write_text("depth_m,factor\n0,2\n3e-6,1\n")
        body = HARDENING["linear"] + 'profile = "p.csv"\nlayer_thickness = "1.2 um"\n'
        (tmp_path / "scene.toml").write_text(layered(HARDENING[law], body))
        return load_scene(tmp_path / "scene.toml")

    def test_holds_above_the_thickness_and_the_law_of_the_body_below(self, read, law):
        plasticity, peeq = read.body.plasticity, np.array([[0.0], [2e-4], [0.013]])
        own = Plasticity(**plasticity.layer.model_dump()).curve().stress(peeq)
        factor = 2.0 - DEPTHS / 3e-6
        expected = factor * np.where(DEPTHS < THICK, own, 1e9 + 10.5e9 * peeq)
        np.testing.assert_allclose(plasticity.strength().stress(DEPTHS, peeq), expected, rtol=1e-15)
        checked = yield_stress(read, *np.broadcast_arrays(peeq, DEPTHS))
        np.testing.assert_allclose(checked, expected, rtol=1e-14)

    def test_both_return_maps_end_on_the_curve_of_the_point(self, read, law):
        """At one point of each region the stress after a step is the yield stress that the checks write once
        more.
        """
        strength, shear = read.body.plasticity.strength(), 80e9
        z, strained = np.array([0.4e-6, 2e-6]), np.array([1e-3, 2e-3])
        factor, curve = strength.profile(z), strength.curve_at(z)
        q = 1.5 * factor * curve.stress(strained)
        gamma = plastic_multiplier(q, strained, curve, factor, m3=3 * shear)
        limit = yield_stress(read, strained + gamma, z)
        assert (gamma > 1e-4).all()
        np.testing.assert_allclose(q - 3 * shear * gamma, limit, rtol=1e-13)
        body = J2(Elastic(2.6 * shear, 0.3), strength.curve_at(z[:, None]), factor[:, None])
        strain = np.zeros((4, 2, 1))
        strain[3, :, 0] = q / shear / np.sqrt(3.0)  # engineering shear
        update = body.update(strain, History(np.zeros((4, 2, 1)), strained[:, None]))
        np.testing.assert_allclose(update.history.peeq[:, 0] - strained, gamma, rtol=1e-11)
        np.testing.assert_allclose(np.sqrt(3.0) * update.stress[3, :, 0], limit, rtol=1e-12)


def test_kinks_are_the_rows_and_the_lower_side_of_another_law():
    graded = DepthProfile((0.0, 1e-6), (2.0, 1.0))
    steel, soft = Swift(945e6, 20.0, 0.121), Linear(1e9)
    assert Strength(steel, graded, soft, 2e-6).kinks == Kinks((0.0, 1e-6, 2e-6))
    assert Strength(steel, graded, soft, 1e-6).kinks == Strength(steel, graded, steel, 9e-6).kinks


def test_the_least_yield_stress_is_found_on_both_sides_of_the_lower_side():
    graded = DepthProfile((0.0, 4e-6), (2.0, 1.0))
    assert Strength(Linear(1e9), graded, Linear(0.5e9), 2e-6).least(0.0) == pytest.approx(0.75e9, rel=1e-12)
    rising = DepthProfile((0.0, 4e-6), (0.5, 1.0))
    assert Strength(Linear(1e9), rising, Linear(9e9), 2e-6).least(0.0) == pytest.approx(0.75e9, rel=1e-12)


def test_cells_and_elements_have_a_face_at_the_lower_side():
    body = {"plasticity": SWIFT | {"layer_thickness": THICK, "layer": SOFT}}
    found = scene(body=body, fem={"cells_per_radius": 8})
    assert THICK in sam.plan(found).grid.faces
    lines = fem_reference.plan(found).z * fem_reference.plan(found).scales.length
    assert np.abs(lines - THICK).min() < 1e-12 * THICK


ROUGH = {
    "surface": {"kind": "sinusoid", "amplitude": 0.1e-6, "wavelength_x": 16e-6, "wavelength_y": 16e-6},
    "counterbody": {"shape": "flat"},
    "grid": {"cells": (16, 16), "extent": (16e-6, 16e-6)},
}


@pytest.mark.parametrize("tables", [{}, ROUGH], ids=["smooth", "rough"])
@pytest.mark.parametrize("kinks", [(0.7e-6, THICK), (THICK,)], ids=["profile and layer", "layer"])
def test_every_model_has_faces_at_the_kinks_below_smooth_and_rough_bodies(tables, kinks):
    rows = {"profile": ((kinks[0], 2.0), (THICK, 1.0))} if len(kinks) > 1 else {}
    body = {"plasticity": SWIFT | rows | {"layer_thickness": THICK, "layer": SOFT}}
    found = scene(body=body, fem={"cells_per_radius": 8, "box": 4.0}, **tables)
    faces, space = sam.plan(found).grid.faces, spatial_plan(found)
    assert set(kinks) <= set(faces) and (np.diff(faces) > 0).all()
    planes = space.lines.z * space.scales.length
    assert max(np.abs(planes - kink).min() for kink in kinks) < 1e-12 * THICK


def test_faces_of_a_rough_body_without_a_kink_grow_evenly():
    even = {"plasticity": SWIFT | {"layer_thickness": THICK}}
    faces = sam.plan(scene(body=even, **ROUGH)).grid.faces
    np.testing.assert_allclose(np.diff(faces)[1:] / np.diff(faces)[:-1], 1.25, rtol=1e-9)


def test_a_soft_layer_makes_a_body_yield_that_would_not():
    """The largest von Mises stress of the elastic contact is half the yield stress of the body."""
    weak = {"law": "perfect", "yield_stress": 2e9}
    hard = {"law": "perfect", "yield_stress": 6e9, "layer_thickness": 3e-6}
    small = {"loading": {"force": 0.15, "steps": 1}, "grid": {"cells": (17, 17)}}
    assert sam.solve(scene(body={"plasticity": hard}, **small)).quantities["peeq_max"] == 0.0
    result = sam.solve(scene(body={"plasticity": hard | {"layer": weak}}, **small))
    assert 0.0 < result.quantities["peeq_max_depth_m"] < 3e-6


def test_a_plan_names_the_law_and_the_advice_counts_the_weaker_one():
    body = SWIFT | {"layer_thickness": THICK}
    plain, own = (scene(body={"plasticity": each}) for each in (body, body | {"layer": LINEAR}))
    for plan, stage in ((sam.plan, "plastic loop"), (fem_reference.plan, RETURN_MAP)):
        before, after = ({one.stage: one.reason for one in plan(each).stages} for each in (plain, own))
        assert after[stage] == before[stage] + ", law linear of its own at z < 1.2e-06 m"
    idle = [one.reason for one in sam.plan(own).left_out if one.stage == "strain limit of the layer"]
    assert idle == ["no [wear]"]
    weak = body | {"layer": {"law": "perfect", "yield_stress": 0.4e9}}
    light = {"force": 0.17}
    kinds = [
        advice_of(scene(body={"plasticity": each}, loading=light), ["sam"])["kind"] for each in (body, weak)
    ]
    assert kinds == ["yielding", "deeply yielding"]


RETURN_MAP = "return mapping and plastic history"
GRADED = {"profile": ((0.0, 0.5), (0.8e-6, 0.5), (1.2e-6, 1.0))}
SMALL = {"loading": {"force": 0.3, "steps": 2}, "fem": {"cells_per_radius": 4, "box": 4.0}}


def bits(result) -> dict:
    return {
        name: {key: [repr(each) for each in table[key]] for key in table}
        for name, table in result.tables.items()
    }


@pytest.mark.parametrize("law", [SWIFT, LINEAR], ids=["swift", "linear"])
@pytest.mark.parametrize("solve", [sam.solve, fem_reference.solve], ids=["sam", "fem-axisymmetric"])
def test_a_layer_of_the_same_law_changes_no_bit(law, solve):
    base = law | GRADED | {"layer_thickness": 1e-6}
    plain, own = (
        solve(scene(body={"plasticity": each}, grid={"cells": (17, 17)}, solver={"tolerance": 1e-3}, **SMALL))
        for each in (base, base | {"layer": law})
    )
    assert bits(plain) == bits(own) and plain.quantities == own.quantities
    assert plain.quantities["peeq_max"] > 0.0


def test_below_a_layer_deeper_than_all_cells_nothing_is_asked_of_the_body():
    grid = {"cells": (17, 17), "layers": 10, "depth": 12e-6}
    deep = {"law": "perfect", "yield_stress": 9e9, "layer_thickness": 1e-3, "layer": SWIFT}
    body, layer = (
        sam.solve(scene(body={"plasticity": each}, grid=grid, solver={"tolerance": 1e-3}, **SMALL))
        for each in (SWIFT, deep)
    )
    assert bits(body) == bits(layer) and layer.quantities["peeq_max"] > 1e-3


def test_a_layer_of_the_same_law_changes_no_bit_of_running_in_and_another_one_does():
    base = RUN_IN_STEEL | {"profile": ((0.0, 0.6), (1e-6, 1.0)), "layer_thickness": 1e-6}
    plain, own, soft = (
        sam.solve(running_in(plasticity=base | layer))
        for layer in ({}, {"layer": RUN_IN_STEEL}, {"layer": RUN_IN_STEEL | {"alpha": 1e3}})
    )
    assert bits(plain) == bits(own) and plain.quantities["wear_volume_m3"] > 0.0
    assert soft.quantities["wear_volume_m3"] > 1.1 * plain.quantities["wear_volume_m3"]
