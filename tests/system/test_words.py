# SPDX-License-Identifier: MIT
"""What commands say: the key to change, suggestions, advice first, sizes that a person can read."""

import json
import re
import sys
from pathlib import Path
from typing import get_args

import pandas as pd
import pytest
from builders import HARDENING, MODULUS, RADIUS, parsed, scene_text

from fem_reference.common.refusals import message_of
from sam.planner.make import remedies_of
from sam.results.tables import advice as words_of
from sam.scene import Compare, Scene, SceneError, Status
from sam.scene.section import OTHER_NAMES, Section, places_of
from samfem.cli import CLAIMS
from verification.cases.case import with_keys
from verification.reference.hertz import CircularContact
from verification.runs import models
from verification.runs.study import read_study


def advice(scene: Scene, status: Status) -> str:
    """What the semi-analytical model advises."""
    return words_of(remedies_of(scene), status)


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
SMOOTH = parsed()
PATCH = parsed(FLAT, add=ROUGH)
FILM = '[body.coating]\nthickness = "100 nm"\nyoung = "80 GPa"\npoisson = 0.3\n'


@pytest.fixture
def scene_file(folder):
    """Writes a scene file into the current folder and returns its name."""

    def write(*edits: tuple[str, str], add: str = "") -> str:
        (folder / "scene.toml").write_text(scene_text(*edits, add=add))
        return "scene.toml"

    return write


def test_a_comparison_names_what_stops_every_model_at_once(scene_file, samfem):
    """Removing what fem-3d names makes the comparison possible; a model that was asked for stands alone."""
    film = '[friction]\nlaw = "chemical-film"\nlow = 0.1\nhigh = 0.4\nfilm_thickness = "100 nm"\n'
    film += 'film_young = "80 GPa"\nfilm_poisson = 0.3\nfilm_yield = "0.6 GPa"\nstrain_limit = 0.02\n'
    said = samfem("compare", scene_file(FLAT, ELASTIC_COUNTER, add=ROUGH + film), code=2).err
    _, axisymmetric, spatial = said.splitlines()
    assert axisymmetric.startswith("  fem-axisymmetric: ") and "remove [surface]" in axisymmetric
    assert spatial.startswith("  fem-3d: ") and "remove young and poisson" in spatial
    assert "counterbody.young = " in spatial
    assert 'friction.law = "chemical-film"' in spatial and not Path("scene-compare").exists()
    assert models.cheapest_reference(PATCH) == models.FEM_3D
    said = samfem("compare", scene_file(FLAT, add=ROUGH + FILM), code=2).err
    assert re.search(r"fem-3d: body.coating.thickness = .*: remove it, or \[surface\]", said)
    said = samfem("compare", scene_file(FLAT, add=ROUGH), "--model", models.FEM, code=2).err
    assert "model fem-axisymmetric: " in said and "fem-3d" not in said


class TestClaim:
    """A film of 0.08 contact radii, a third as stiff, changes pressure and stress by 6 and 7 %."""

    film = FILM.replace("100 nm", "500 nm")
    asked = '[compare]\nclaim = "negligible-film"\n'

    def test_the_exit_code_is_about_the_film_only_if_asked(self, scene_file, samfem, monkeypatch, tmp_path):
        """The same results, solved once: [compare] is no part of the key of the store."""
        monkeypatch.setenv("SAMFEM_STORE", str(tmp_path / "store"))
        sizes = {"size of p_max_change", "size of mises_max_change"}
        for name, file, more, outside in (
            ("agreement", self.film, [], set()),
            ("option", self.film, ["--claim", "negligible-film"], sizes),
            ("scene", self.film + self.asked, [], sizes),
        ):
            shown = samfem("compare", scene_file(add=file), *more, code=int(bool(outside)))
            table = pd.read_csv("scene-compare/compare.csv")
            assert {*table["quantity"][~table["passed"]]} == outside
            assert ("--claim negligible-film" in shown.out) == (name == "agreement")
            assert ("taken from the store" in shown.err) == (name != "agreement")
            verdict = json.loads(Path("scene-compare/verdict.json").read_text())
            assert verdict["film_negligible"] is False and verdict["change_p_max"] < -0.05

    def test_a_claim_that_is_none_is_refused(self, scene_file, samfem):
        said = samfem("compare", scene_file(), "--claim", "negligible-film", code=2).err
        assert '--claim = "negligible-film": only for a scene with [body.coating]' in said
        assert "compare.claim" in samfem("plan", scene_file(add=self.asked), code=2).err
        unknown = scene_file(add=FILM + '[compare]\nclaim = "no-film"\n')
        assert 'one of "negligible-film"' in samfem("plan", unknown, code=2).err
        samfem("compare", scene_file(add=FILM), "--claim", "no-film", code=2)
        assert get_args(get_args(Compare.model_fields["claim"].annotation)[0]) == CLAIMS


@pytest.mark.parametrize(
    ("table", "place"),
    [
        ('[coatings]\nthickness = "1 um"', "[body.coating]"),
        ('[plasticity]\nlaw = "perfect"', "[body.plasticity]"),
        ('[counterbody.coating]\nthickness = "1 um"', "[body.coating]"),
        ("[loading.friction]\ncoefficient = 0.2", "[friction]"),
        ('[body.surface]\nkind = "sinusoid"', "[counterbody.surface] or [surface]"),
        ('[layer]\nthickness = "1 um"', "[body.coating] or [body.plasticity.layer]"),
        ('[indenter]\nradius = "1 um"', "[counterbody]"),
        ("[solver]\nlayer_thickness = 9", "body.plasticity.layer_thickness"),
        ("[fem]\nboxx = 9", "box"),
        ("[counter_body]\nx = 9", "counterbody"),
    ],
)
def test_of_a_misplaced_key_the_error_says_where_it_belongs(table, place):
    with pytest.raises(SceneError, match=re.escape(f"unknown key, did you mean {place}?")):
        parsed(add=table)


def test_other_keys_get_no_such_suggestion_and_suggestions_exist(tmp_path):
    with pytest.raises(SceneError, match="unknown key, allowed here: title, body"):
        parsed(add="[zzz]\na = 1\n")
    (tmp_path / "s.toml").write_text('scene = "x.toml"\nforce = 1\n[vary]\n"loading.force" = {list = [1]}\n')
    with pytest.raises(SceneError, match="force = 1: unknown key, allowed here: title, scene"):
        read_study(tmp_path / "s.toml")
    known = {place for places in places_of(Section.whole).values() for place in places}
    assert {place.split(" with ")[0] for found in OTHER_NAMES.values() for place in found} <= known


@pytest.mark.parametrize("command", [["solve", "--model", "fem-axisymmetric"], ["compare", "--no-store"]])
def test_what_is_predicted_to_take_more_than_a_day_is_begun_only_when_asked(
    scene_file, samfem, monkeypatch, folder, command
):
    """A sphere that yields in 1000 steps on 64 elements in the radius, four times: 61 h, 1 GB."""
    name = scene_file(
        ("force = ", "steps = 1000\nunload = true\ncycles = 4\nforce = "),
        add=f"[body.plasticity]\n{HARDENING['perfect']}[fem]\ncells_per_radius = 64\n",
    )
    before = sorted(folder.iterdir())
    words = samfem(*command, name, code=2).err
    assert "fem-axisymmetric: about 61 h of processor time predicted, more than 24 h: lower fem." in words
    assert words.endswith(", loading.steps = 1000 or loading.cycles = 4, or say --anyway\n")
    assert sorted(folder.iterdir()) == before

    def begun(*_, **__):
        raise KeyboardInterrupt("begun")

    monkeypatch.setattr(models, "solve", begun)
    assert "begun" in samfem(*command, name, "--anyway", code=130).err


class TestPrintedResult:
    """Of a coarse sphere: Hertz's pressure 8.5 GPa, approach 0.35 um."""

    coarse = "[grid]\ncells = [33, 33]\n"

    def test_on_a_terminal_in_gpa_and_um(self, scene_file, samfem, monkeypatch):
        monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
        shown = samfem("solve", scene_file(add=self.coarse)).out
        assert re.match(r"converged in [\d.]+ s: 33 x 33 cells of \d+ nm, \d+ in contact", shown)
        for words, exact in ((r"p_max +([\d.]+) GPa", 8.47), (r"approach +([\d.]+) um", 0.349)):
            assert float(re.search(words, shown)[1]) == pytest.approx(exact, rel=0.02)
        assert re.search(r"contact_area +1\d\d\.\d+ um\^2", shown) and re.search(r"force +0\.65 N", shown)
        assert not re.search(r"_Pa|_m\b|e[-+]\d", shown) and "residual" not in shown

    def test_elsewhere_in_si_under_the_names_of_the_summary(self, scene_file, samfem):
        """Without nulls and what the scene has not; the numbers are those of summary.json, to six digits."""
        status, columns, *rows, path = samfem("solve", scene_file(add=self.coarse)).out.splitlines()
        assert status.startswith("converged in ")
        assert columns.split() == ["quantity", "sam", "Hertz", "deviation"]
        quantities = json.loads(Path(path).read_text())["quantities"]
        shown = {name: [float(value) for value in values[:2]] for name, *values in map(str.split, rows)}
        own = {name: values[0] for name, values in shown.items()}
        assert own == pytest.approx({name: quantities[name] for name in shown}, rel=1e-5)
        absent = {"peeq_max", "friction_coefficient", "pressure_centroid_x_m", "wear_volume_m3"}
        given = {name for name, value in quantities.items() if value is not None}
        assert given - set(shown) == absent
        hertz = CircularContact(0.65, RADIUS, MODULUS)
        assert shown["p_max_Pa"][1] == pytest.approx(hertz.peak_pressure, rel=1e-5)
        assert shown["contact_radius_m"][1] == pytest.approx(hertz.contact_radius, rel=1e-5)


AT_LIMIT = [
    (advice, Status.NOT_CONVERGED, 0.1, "solver.tolerance"),
    (advice, Status.STEP_CUT_LIMIT, 0.1, "solver.tolerance"),
    (advice, Status.STEP_CUT_LIMIT, 1000, "loading.steps"),
    (advice, Status.UNDER_RESOLVED, (4097, 4097), "grid.cells"),
    (message_of, Status.UNDER_RESOLVED, 256, "fem.cells_per_radius"),
    (message_of, Status.PLASTIC_ZONE_AT_GRID_EDGE, 1000.0, "fem.box"),
    (message_of, Status.STEP_CUT_LIMIT, 1000, "loading.steps"),
]


class TestAdviceOfWhatCanBeChanged:
    """No key at its limit, none that the scene has not, none that is set already."""

    @pytest.mark.parametrize("advise", [advice, message_of])
    def test_every_status_says_what_to_change(self, advise):
        for scene in (SMOOTH, PATCH):
            for status in set(Status) - {Status.CONVERGED}:
                what = advise(scene, status).partition(": ")[2]
                assert re.match("raise|lower|change|refine|give", what), (scene.title, what)

    @pytest.mark.parametrize(("advise", "status", "limit", "key"), AT_LIMIT)
    def test_a_key_at_its_limit_is_not_advised(self, advise, status, limit, key):
        assert f"raise {key}" in advise(SMOOTH, status)
        section, _, name = key.partition(".")
        assert key not in advise(with_keys(SMOOTH, section, **{name: limit}), status)
