# SPDX-License-Identifier: MIT
"""Pictures in space: which run has which, what they show in numbers, and where a machine cannot draw."""

import re
import subprocess
import sys
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from builders import LINEAR, running_in, scene
from PIL import Image

from samfem.cli import PICTURES as NAMES
from verification.figures.space import CannotDrawError, draw, offscreen
from verification.figures.space.meshes import Found
from verification.figures.space.pictures import PICTURES, Picture
from verification.runs import models
from verification.runs.files import read_run, write_run

UNLOADED = {"force": 0.05, "steps": 1, "unload": True, "unload_steps": 1}
WAVE = {"kind": "sinusoid", "amplitude": 0.05e-6, "wavelength_x": 8e-6, "wavelength_y": 8e-6}
SQUARE = {"cells": (16, 16), "extent": (8e-6, 8e-6)}
SCENES = {
    "elastic": {"loading": {"force": 0.05}, "grid": {"cells": (17, 17)}},
    "yielding": {"body": {"plasticity": LINEAR}, "loading": UNLOADED, "grid": {"cells": (33, 33)}},
    "unloaded": {"loading": {"force": 0.0}, "grid": SQUARE},
    "rough": {"counterbody": {"shape": "flat"}, "surface": WAVE, "loading": {"force": 0.02}, "grid": SQUARE},
}
COARSE = {models.FEM: {"cells_per_radius": 8, "box": 5}, models.FEM_3D: {"cells_per_radius": 4, "box": 4}}
_FOLDERS: list[TemporaryDirectory] = []


@cache
def found(name: str, model: str = models.SAM) -> Found:
    """A solved scene, read back from files that stay until the tests end."""
    given = running_in() if name == "worn" else scene(**SCENES[name], fem=COARSE.get(model))
    _FOLDERS.append(TemporaryDirectory())
    write_run(models.solve(given, model), given, _FOLDERS[-1].name, {})
    return Found(read_run(_FOLDERS[-1].name))


@cache
def picture(kind: str, name: str, model: str = models.SAM) -> Picture:
    return PICTURES[kind](found(name, model))


def values(shown: Picture) -> np.ndarray:
    """All values that are coloured, (n,)."""
    coloured = [mesh["value"] for mesh, options in shown.parts if "scalars" in options]
    return np.concatenate([each[np.isfinite(each)] for each in coloured])


@pytest.mark.parametrize(
    ("name", "has"),
    [
        ("elastic", {"contact", "mises"}),
        ("yielding", {"contact", "mises", "plastic-zone", "imprint"}),
        ("rough", {"contact", "mises", "surface"}),
        ("worn", {"contact", "mises", "plastic-zone", "surface", "worn"}),
        ("unloaded", set()),
    ],
)
def test_a_run_has_the_pictures_of_what_it_knows(name, has):
    assert tuple(PICTURES) == NAMES  # of the command
    assert {kind for kind in PICTURES if picture(kind, name) is not None} == has


@pytest.mark.parametrize("model", [models.SAM, models.FEM, models.FEM_3D])
def test_pictures_show_what_the_tables_hold(model):
    """The largest pressure; a zone cut open at the largest strain; a surface as far down as it says."""
    run, shown = found("yielding", model).run, picture("contact", "yielding", model)
    assert shown.limits == (0.0, pytest.approx(1e-9 * run.quantities["p_max_Pa"], rel=1e-6))
    zone, imprint = picture("plastic-zone", "yielding", model), picture("imprint", "yielding", model)
    assert values(zone).max() == pytest.approx(zone.limits[1], rel=0.02) and zone.box[2, 1] == 0.0
    assert values(picture("mises", "yielding", model)).max() > 0.0
    (mesh, _), *_ = imprint.parts
    assert mesh.points[:, 2].min() / imprint.exaggeration == pytest.approx(1e-3 * imprint.limits[0])


DIES = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"


def test_without_a_library_nothing_is_started_and_the_packages_are_named(monkeypatch):
    monkeypatch.delenv(offscreen.WINDOW, raising=False)
    monkeypatch.setattr(offscreen, "WINDOWS", {"libNoSuchLibrary.so.1": "vtkEGLRenderWindow"})
    monkeypatch.setattr(subprocess, "run", pytest.fail)
    with pytest.raises(CannotDrawError, match=re.escape(offscreen.INSTALL)):
        draw(found("elastic").run.folder)


@pytest.mark.parametrize(
    ("program", "longest", "how", "what_to_do"),
    [
        (DIES, 60.0, "SIGSEGV", offscreen.INSTALL),
        ("raise ValueError('no such window')", 60.0, "ValueError: no such window", "please report it"),
        ("import sys; sys.exit(3)", 60.0, "exit code 3", "please report it"),
        ("import time; time.sleep(60)", 0.2, "timed out", offscreen.INSTALL),
    ],
)
def test_a_drawing_process_that_ends_badly_is_one_line(monkeypatch, program, longest, how, what_to_do):
    monkeypatch.setenv(offscreen.WINDOW, "vtkEGLRenderWindow")
    monkeypatch.setattr(offscreen, "CHILD", ("-c", program))
    monkeypatch.setattr(offscreen, "LONGEST_S", longest)
    with pytest.raises(CannotDrawError, match=re.escape(what_to_do)) as caught:
        draw(found("elastic").run.folder)
    assert how in str(caught.value) and "\n" not in str(caught.value)


class TestCommand:
    @pytest.fixture
    def cannot(self, monkeypatch):
        monkeypatch.setenv(offscreen.WINDOW, "vtkEGLRenderWindow")
        monkeypatch.setattr(offscreen, "CHILD", ("-c", DIES))

    @pytest.mark.usefixtures("cannot")
    def test_solving_keeps_the_other_figures_where_space_cannot_be_drawn(self, sphere_folder, samfem):
        shown = samfem("solve", "sphere.toml", "--figures")
        *others, of_pictures = shown.err.splitlines()  # with progress, where it takes a second
        assert any("half-space" in line for line in others)
        assert offscreen.INSTALL in of_pictures and "SIGSEGV" in of_pictures
        figures = {path.name for path in (sphere_folder / "sphere-sam" / "figures").iterdir()}
        assert {"mises.png", "history.png"} <= figures and not any("3d" in name for name in figures)

    @pytest.mark.usefixtures("cannot")
    def test_view_says_that_it_cannot_and_writes_nothing(self, tmp_path, monkeypatch, samfem):
        monkeypatch.chdir(tmp_path)
        shown = samfem("view", str(found("elastic").run.folder), "--out", "a.png", code=1)
        assert shown.out == "" and shown.err.count("\n") == 1 and offscreen.INSTALL in shown.err
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize(
        ("words", "said"),
        [
            (["nowhere"], "nowhere is no result: there is no such folder"),
            (["RUN", "--out", "a.jpg"], "a.jpg does not end in .png"),
            (["RUN", "--html", "a.png"], "a.png does not end in .html"),
            (["RUN", "--out", "none/a.png"], "none/a.png cannot be written"),
            (["RUN", "--picture", "worn", "--out", "a.png"], "does not have what --picture worn shows"),
            (["RUN", "--picture", "wron"], "invalid choice: 'wron'"),
            (["RUN", "--out", "a.png", "--html", "a.html"], "not allowed with argument"),
        ],
    )
    def test_wrong_words_are_refused(self, tmp_path, monkeypatch, samfem, words, said):
        monkeypatch.chdir(tmp_path)
        run = str(found("elastic").run.folder)
        shown = samfem("view", *(run if word == "RUN" else word for word in words), code=2)
        assert said in shown.err and list(tmp_path.iterdir()) == []


@pytest.fixture(scope="session")
def can_draw():
    """Skips where VTK cannot draw a triangle, in a process of its own."""
    window = offscreen.window()
    program = "import pyvista; pyvista.Plotter(off_screen=True).screenshot(return_img=True)"
    how = {"env": {offscreen.WINDOW: window}, "capture_output": True, "check": False}
    if window is None or subprocess.run([sys.executable, "-c", program], **how).returncode:
        pytest.skip(f"nothing is drawn in space: {offscreen.REMEDY}")


@pytest.mark.usefixtures("can_draw")
class TestDrawn:
    def test_view_draws_what_a_run_has_and_one_of_them_the_same_again(self, tmp_path, samfem):
        folder = found("worn").run.folder
        shown = samfem("view", str(folder))
        names = {f"{kind}-3d.png" for kind in ("contact", "mises", "plastic-zone", "surface", "worn")}
        assert {path.name for path in (folder / "figures").iterdir()} == names
        assert sorted(shown.out.split()) == sorted(str(folder / "figures" / name) for name in names)
        for name in names:
            drawn = Image.open(folder / "figures" / name).convert("RGB")
            assert drawn.width > 1000 and len(drawn.getcolors()) > 200
            pixels = np.asarray(drawn)
            edge = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
            assert (edge == 255).all()  # nothing is cut off
        samfem("view", str(folder), "--picture", "worn", "--out", str(tmp_path / "a.png"))
        assert (tmp_path / "a.png").read_bytes() == (folder / "figures" / "worn-3d.png").read_bytes()
