# SPDX-License-Identifier: MIT
"""What the commands say: reasons that name the key to change, suggestions, advice first, sizes that a person can read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from test_scene import scene_text

from sam.scene import parse_scene
from verification import models
from verification.cli import main

FLAT = ('shape = "sphere"\nradius = "105 um"', 'shape = "flat"')
ROUGH = """
[surface]
kind = "sinusoid"
amplitude = "0.1 um"
wavelength_x = "4 um"
[grid]
cells = [16, 16]
extent = ["16 um", "16 um"]
border = "relief"
"""
ELASTIC_COUNTER = ('shape = "flat"', 'shape = "flat"\nyoung = "210 GPa"\npoisson = 0.3')
FILM = '[body.coating]\nthickness = "100 nm"\nyoung = "80 GPa"\npoisson = 0.3\n'


@pytest.fixture
def scene_file(tmp_path: Path, monkeypatch):
    """Writes a scene file into the current folder and returns its name."""
    monkeypatch.chdir(tmp_path)

    def write(*edits: tuple[str, str], add: str = "") -> str:
        (tmp_path / "scene.toml").write_text(scene_text(*edits, add=add))
        return "scene.toml"

    return write


class TestReasonsOfCompare:
    def test_a_rough_scene_with_an_elastic_counter_body(self, scene_file, capsys):
        """Each model with the key that stops it; removing what fem-3d names makes the comparison possible."""
        assert main(["compare", scene_file(FLAT, ELASTIC_COUNTER, add=ROUGH)]) == 2
        _, axisymmetric, spatial = capsys.readouterr().err.splitlines()
        assert axisymmetric.startswith("  fem-axisymmetric: ") and "remove [surface]" in axisymmetric
        assert spatial.startswith("  fem-3d: counterbody.young = ") and "remove young and poisson" in spatial
        assert not Path("scene-compare").exists()
        possible = parse_scene(scene_text(FLAT, add=ROUGH).encode(), "")
        assert models.cheapest_reference(possible) == models.FEM_3D

    def test_every_reason_of_a_model_is_named_at_once(self, scene_file, capsys):
        film = '[friction]\nlaw = "chemical-film"\nlow = 0.1\nhigh = 0.4\nfilm_thickness = "100 nm"\n'
        film += 'film_young = "80 GPa"\nfilm_poisson = 0.3\nfilm_yield = "0.6 GPa"\nstrain_limit = 0.02\n'
        assert main(["compare", scene_file(FLAT, ELASTIC_COUNTER, add=ROUGH + film)]) == 2
        spatial = capsys.readouterr().err.splitlines()[-1]
        assert "counterbody.young" in spatial and 'friction.law = "chemical-film"' in spatial

    def test_a_rough_coated_scene(self, scene_file, capsys):
        assert main(["compare", scene_file(FLAT, add=ROUGH + FILM)]) == 2
        message = capsys.readouterr().err
        assert re.search(r"fem-3d: body.coating.thickness = .*: remove it, or \[surface\]", message)

    def test_a_model_that_was_asked_for_gives_its_own_reason(self, scene_file, capsys):
        assert main(["compare", scene_file(FLAT, add=ROUGH), "--model", models.FEM]) == 2
        message = capsys.readouterr().err
        assert "model fem-axisymmetric: " in message and "fem-3d" not in message
