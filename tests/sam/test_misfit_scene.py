# SPDX-License-Identifier: MIT
"""Scenes with loading.prescribed = "misfit-sphere": what is refused by name, the grid that is chosen, cycles,
and the stress of the load.
"""

import numpy as np
import pytest
from growing_sphere_checks import NU, YOUNG

import sam
from sam.elastic.misfit import PROFILES, MisfitSphere
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants
from sam.scene import Scene, parse_scene, resolved
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


def test_an_elastic_body_needs_no_cells():
    scene = parse_scene(
        GOOD.replace(GOOD[GOOD.index("[body.pl") : GOOD.index("[load")], "").encode(), "e.toml"
    )
    found = sam.solve(scene)
    left = {each.stage for each in found.left_out}
    assert {"contact search", "surface coefficients", "plastic loop"} <= left
    exact = 0.28 * YOUNG * 0.02 / (1 - NU)
    assert found.quantities["mises_max_Pa"] == pytest.approx(exact, rel=0.05)  # the image adds to it
