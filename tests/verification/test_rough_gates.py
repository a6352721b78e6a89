# SPDX-License-Identifier: MIT
"""The gates of the cases with three asperities: made results turn the right ones red, and so do heights that
point the wrong way and a layer without its law.
"""

from importlib import resources

import numpy as np

import sam
from sam.scene import HeightMap, Result, Scene, load_scene
from verification.cases.case import with_keys, with_loading
from verification.cases.rough.rough_contact import SETTINGS, THICK, SolvedAsperities, at, compared
from verification.compare.rough_measures import Depths, compared_depths
from verification.judging import evaluate
from verification.rows import load_rows


def made(load=1.0, strain=1.0, dent=1.0, area=1.0):
    """A result of the case made up: three spots of constant pressure, bells of strain below, dents; factors
    on spot 1.
    """
    x, y = (np.linspace(-5.5e-6, 5.5e-6, 12) for _ in "xy")
    p, places = np.zeros((12, 12)), (2, 6, 10)
    for k, value in zip(places, (4e9 * load, 3e9, 2e9), strict=True):
        p[k - 1 : k + 1, 5:7] = value
    z = np.linspace(0.1e-6, 3e-6, 24)
    peeq = np.full((12, 1), 0.01) * np.exp(-(((z - 0.6e-6) / 0.5e-6) ** 2))
    peeq[:4] *= strain
    xx, yy = np.meshgrid(x, y, indexing="ij")
    px, pz = np.meshgrid(x, z, indexing="ij")
    uz = np.where(x < -2e-6, dent, 1.0) * 5e-9 * np.cos(x * 1e6) ** 2
    surface = {"x_m": xx.ravel(), "y_m": yy.ravel(), "p_Pa": p.ravel(), "state": ["peak"] * 144}
    plane = {"x_m": px.ravel(), "z_m": pz.ravel(), "peeq": peeq.ravel(), "state": ["peak"] * px.size}
    line = {"x_m": x, "uz_m": uz, "state": ["unloaded"] * 12}
    quantities = {"contact_area_m2": 1e-11 * area}
    return Result("made", "converged", quantities, {"surface": surface, "plane": plane, "line": line})


def red(sam_result, fem_result, case="rough-contact-0-2"):
    """Which gates of the case are red."""
    found = compared(SolvedAsperities(sam_result, fem_result))
    values = {f"{case}.{name}": value for name, value in found.items()}
    verdicts = evaluate(load_rows(), {case: values})
    return {v.row.id.split(".")[1] for v in verdicts if v.status.red}


def coarse(case: str) -> Scene:
    """The scene of a case on 24 x 24 cells."""
    base = load_scene(resources.files("verification").joinpath("scenes", "rough-asperities.toml"))
    return at(base, next(each for each in SETTINGS if each.name == case), 24)


def test_the_gates_of_the_case_notice_wrong_results():
    """Equal results pass; each factor beyond its tolerance turns its own gate red, and no other."""
    assert red(made(), made()) == set() and red(made(load=1.03), made()) == {"load-1"}
    assert red(made(strain=1.1), made()) == {"strain-1"} and red(made(dent=0.7), made()) == {"residual"}
    assert red(made(area=1.06), made()) == {"area"}
    assert {"spots", "load-3"} <= red(made(load=0.0), made(load=0.0))


def test_the_gates_under_a_rough_counter_body_notice_wrong_results():
    """The case with the asperities on the counter-body has the gates of the others; heights that point the
    wrong way leave no three spots.
    """
    case = "rough-counterbody"
    assert red(made(), made(), case) == set() and red(made(load=1.03), made(), case) == {"load-1"}
    assert red(made(strain=1.1), made(), case) == {"strain-1"}
    assert {"spots", "load-3"} <= red(made(load=0.0), made(load=0.0), case)
    scene = coarse(case)
    heights = scene.counterbody.surface.path
    down = {"path": HeightMap(-heights.values, heights.extent)}
    wrong = with_keys(scene, "counterbody.surface", **down)
    right, turned = (sam.solve(with_loading(each, steps=1)) for each in (scene, wrong))
    assert "spots" not in red(right, right, case)
    assert "spots" in red(turned, turned, case)


def test_the_gates_over_a_layer_notice_wrong_results_and_a_body_without_it():
    case = "rough-layer"
    assert red(made(), made(), case) == set() and red(made(load=1.03), made(), case) == {"load-1"}
    assert red(made(strain=1.3), made(), case) == {"strain-1"}
    scene = coarse(case)
    own = sam.solve(scene)
    assert THICK in sam.plan(scene).grid.faces
    assert red(own, own, case) == set()
    plain = sam.solve(with_keys(scene, "body.plasticity", layer=None))
    assert {"strain-1", "strain-2", "strain-3"} <= red(plain, own, case)


def test_the_strain_on_either_side_of_a_jump_is_found_and_not_between_the_points_beside_it():
    x, z, jump = np.linspace(-1.0, 1.0, 5), np.arange(0.05, 2.0, 0.1), 0.9
    strain = np.where(z < jump, 1.0 + z, 0.5 - 0.1 * z)
    depths = Depths(x, z, strain * np.ones((5, 1)), jump)
    at_z = np.array([0.1, 0.84, 0.96, 1.5])
    np.testing.assert_allclose(depths.below(0.0, at_z), [1.1, 1.84, 0.404, 0.35], rtol=1e-9)
    compared = compared_depths(depths, 0.0, 0.5)
    assert not ((compared > 0.85 + 1e-9) & (compared < 0.95 - 1e-9)).any() and compared[-1] > 1.5
    even = Depths(x, z, (1.0 + z) * np.ones((5, 1)))
    np.testing.assert_allclose(even.below(0.0, at_z), 1.0 + at_z, rtol=1e-9)
