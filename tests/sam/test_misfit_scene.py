# SPDX-License-Identifier: MIT
"""Scenes with loading.prescribed = "misfit-sphere": what is refused by name, the grid that is chosen, cycles,
and the stress of the load.
"""

import numpy as np
import pytest
from growing_sphere_checks import LAWS, NU, YOUNG

import sam
from sam.elastic.misfit import PROFILES, MisfitSphere
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants
from sam.scene import Scene, parse_scene, resolved
from sam.scene.errors import SceneError
from samfem.cli import main
from verification.reference.mindlin_cheng import EigenstrainSphere
from verification.reference.misfit_sphere import GrowingSphere

A = 1e-5  # radius in m
GOOD = """\
[body]
young = "210 GPa"
poisson = 0.3
[body.plasticity]
law = "linear"
yield_stress = "1 GPa"
modulus = "10 GPa"
[loading]
prescribed = "misfit-sphere"
depth = "15 um"
radius = "10 um"
misfit = 0.02
"""
FRICTION = "[friction]\ncoefficient = 0.1\n"
ROUGH = '[surface]\nkind = "sinusoid"\namplitude = "1 nm"\nwavelength_x = "5 um"\n'
COATING = '[body.coating]\nthickness = "1 um"\nyoung = "80 GPa"\npoisson = 0.3\n'
WEAR = "unload = true\n[wear]\nstrain_limit = 0.01\n"
PATH = 'path = { start = ["0 um", "0 um"], end = ["5 um", "0 um"], steps = 2 }\n'
BAD = {
    "no depth": (("depth", ""), "loading.depth", "required"),
    "no radius": (("radius", ""), "loading.radius", "required"),
    "no misfit": (("misfit = ", ""), "loading.misfit", "required"),
    "depth without unit": (("depth", "depth = 15"), "loading.depth", "string with a unit"),
    "depth in N": (("depth", 'depth = "15 N"'), "loading.depth", "a length"),
    "negative depth": (("depth", 'depth = "-15 um"'), "loading.depth", "a length"),
    "at the surface": (("depth", 'depth = "10 um"'), "loading.depth", "more than the radius"),
    "above the surface": (("depth", 'depth = "5 um"'), "loading.depth", "more than the radius"),
    "no radius at all": (("radius", 'radius = "0 um"'), "loading.radius", "a length"),
    "shrinks": (("misfit = ", "misfit = -0.02"), "loading.misfit", "a strain"),
    "no growth": (("misfit = ", "misfit = 0.0"), "loading.misfit", "a strain"),
    "grows too far": (("misfit = ", "misfit = 2.0"), "loading.misfit", "a strain"),
    "misfit with a unit": (("misfit = ", 'misfit = "2 %"'), "loading.misfit", "a strain"),
    "another profile": (("", 'profile = "cube"'), "loading.profile", "smooth"),
    "gauss too shallow": (("", 'profile = "gauss"'), "loading.depth", "3 times the radius"),
    "another surface": (("", 'surface = "fixed"'), "loading.surface", "held"),
    "with force": (("", 'force = "1 N"'), "loading.force", "not both"),
    "with approach": (("", 'approach = "1 um"'), "loading.approach", "not both"),
    "with p0": (("", 'p0 = "1 GPa"'), "loading.p0", 'prescribed = "hertz"'),
    "with a path": (("", PATH), "loading.path", 'prescribed = "hertz"'),
    "with friction": (("", FRICTION), "friction", "not together with"),
    "with heights": (("", ROUGH), "surface", "remove it"),
    "with a coating": (("", COATING), "body.coating", "not together with"),
    "with a counter-body": (
        ("", '[counterbody]\nshape = "sphere"\nradius = "1 mm"\n'),
        "counterbody",
        "nothing presses on the body",
    ),
    "with wear": (("", WEAR), "loading.prescribed", "needs a contact"),
    "with the paper's loop": (("", '[solver]\nmethod = "paper"\n'), "solver.method", "solves a contact"),
    "keys without their load": (
        ('prescribed = "misfit-sphere"', 'force = "1 N"'),
        "loading.misfit",
        'only as part of prescribed = "misfit-sphere"',
    ),
    "keys of another load": (
        ('prescribed = "misfit-sphere"', 'prescribed = "hertz"\np0 = "1 GPa"'),
        "loading.depth",
        'only as part of prescribed = "misfit-sphere"',
    ),
}


def changed(edit: tuple[str, str]) -> str:
    """The good scene with the line that begins so replaced; without one with lines added."""
    old, new = edit
    if not old:
        return f"{GOOD}{new}\n"
    lines = [new if line.startswith(old) else line for line in GOOD.splitlines()]
    assert lines != GOOD.splitlines()
    return "\n".join(lines) + "\n"


def test_the_scene_itself_is_good():
    scene = parse_scene(GOOD.encode(), "good.toml")
    assert (scene.loading.profile, scene.loading.surface) == ("smooth", "free")
    assert Scene(**resolved(scene)) == scene


@pytest.mark.parametrize("edit, key, allowed", BAD.values(), ids=BAD.keys())
def test_what_is_wrong_is_named(edit, key, allowed):
    with pytest.raises(SceneError) as caught:
        parse_scene(changed(edit).encode(), "bad.toml")
    found = [problem for problem in caught.value.problems if problem.key == key]
    assert found and any(allowed in problem.allowed for problem in found), caught.value.problems


def test_a_zone_that_reaches_a_held_surface_ends_the_command(tmp_path, capsys):
    path = tmp_path / "soft.toml"
    path.write_text(GOOD.replace('"1 GPa"', '"0.2 GPa"') + 'surface = "held"\n', encoding="utf-8")
    assert main(["solve", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "loading.depth = 1.5" in (words := capsys.readouterr().err) and "held" in words
    assert not (tmp_path / "out").exists()


def sphere(profile="smooth", free=True, depth=1.5) -> MisfitSphere:
    return MisfitSphere(ElasticConstants(YOUNG, NU), depth * A, A, 0.02, PROFILES[profile], free)


def test_stress_below_a_free_surface_is_that_of_mindlin_and_cheng():
    """A uniform sphere, outside of it and inside."""
    exact = EigenstrainSphere(0.02, A, 1.5 * A, YOUNG, NU)
    x, y, z = (A * np.array(each) for each in ([0.3, 2.0, 0.0], [0.1, -1.0, 0.0], [1.7, 0.0, 0.2]))
    found = np.moveaxis(sphere("ball").stress(x, y, z), 0, -1)
    assert np.abs(found - exact.stress(x, y, z)).max() < 1e-12 * YOUNG * 0.02
    grid = CellGrid(3, 3, A, A, np.zeros(1))
    moved = exact.surface_displacement(grid.x[:, None], grid.y)
    assert sphere("ball").moved_surface(grid) == pytest.approx(moved, rel=1e-12)


@pytest.mark.parametrize("profile", list(PROFILES))
def test_stress_of_an_infinite_body_is_that_of_the_closed_form(profile):
    exact = GrowingSphere(YOUNG, NU, lambda peeq: 1e30 + 0 * peeq, 0.02, A, profile)
    x, y, z = (
        A * np.array(each) for each in ([0.3, 1.2, 0.0, 1e-3], [0.1, -1.0, 0.0, 0.0], [0.2, 0.3, 0.9, 0.0])
    )
    found = np.moveaxis(sphere(profile, free=False).stress(x, y, z + 1.5 * A), 0, -1)
    assert np.abs(found - exact.stress(x, y, z)).max() < 2e-7 * YOUNG * 0.02


def test_the_chosen_grid_holds_the_plastic_zone_with_a_cell_at_the_centre():
    for depth in (1.6, 4.0):
        scene = parse_scene(changed(("depth", f'depth = "{10 * depth:g} um"')).encode(), "good.toml")
        grid, zone = sam.choose_grid(scene), sam.misfit_zone(scene)
        assert zone == pytest.approx(1.11103 * A, rel=1e-3)
        assert grid.hx == pytest.approx(A / 8) and grid.nx % 2 == 1
        assert grid.nx * grid.hx / 2 > 1.4 * zone and grid.faces[0] == 0.0
        assert np.abs(grid.depths - depth * A).min() < 1e-6 * A
        assert np.all(np.diff(grid.faces) > 0.45 * grid.hx) and len(grid.depths) < 45


def test_cycles_of_a_perfect_body_strain_it_again_and_again():
    """The closed form of two cycles, whose accumulated strain is four times the first reverse yield more."""
    law = LAWS["perfect"][1]
    scene = Scene(
        body={"young": YOUNG, "poisson": NU, "plasticity": {"law": "perfect", "yield_stress": 1e9}},
        loading={
            "prescribed": "misfit-sphere", "depth": 1.5 * A, "radius": A, "misfit": 0.04,
            "surface": "held", "steps": 1, "unload": True, "unload_steps": 2, "cycles": 2,
        },
        grid={"cells": (23, 23), "extent": (4.6 * A, 4.6 * A)},
        solver={"tolerance": 1e-4},
    )  # fmt: skip
    found = sam.solve(scene)
    assert found.converged
    largest = found.tables["cycles"]["peeq_max"]
    at = A * np.linspace(0.3, 1.4, 1101)
    exact = [
        GrowingSphere(YOUNG, NU, law, 0.04, A, shares=shares).fields(at).peeq.max()
        for shares in ((1.0,), (1.0, 0.0, 1.0))
    ]
    assert largest == pytest.approx(exact, rel=0.1)  # five cells in the radius
    notes = found.tables["history"]["note"]
    assert notes[0] == "misfit strain 0.04" and set(found.tables["history"]["force_N"]) == {0.0}


def test_an_elastic_body_needs_no_cells():
    scene = parse_scene(
        GOOD.replace(GOOD[GOOD.index("[body.pl") : GOOD.index("[load")], "").encode(), "e.toml"
    )
    found = sam.solve(scene)
    left = {each.stage for each in found.left_out}
    assert {"contact search", "surface coefficients", "plastic loop"} <= left
    exact = 0.28 * YOUNG * 0.02 / (1 - NU)
    assert found.quantities["mises_max_Pa"] == pytest.approx(exact, rel=0.05)  # the image adds to it
