# SPDX-License-Identifier: MIT
"""What `samfem solve --figures` draws, read from the drawn artists: where the contact is, its largest value,
and that number; and pictures in space: which run has which, their numbers, where a machine cannot draw.

A scene of each kind that is not a sphere in the middle: wavy, elliptic, worn, travelling; solved
here, on few cells.
"""

import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
import pytest
from builders import LINEAR, running_in, scene
from matplotlib.collections import QuadMesh
from PIL import Image

from samfem.cli import PICTURES as NAMES
from verification.cost.contact import hertz_of
from verification.figures.run import drawings_of, history
from verification.figures.space import CannotDrawError, draw, offscreen
from verification.figures.space.meshes import Found
from verification.figures.space.pictures import PICTURES, Picture
from verification.runs import models
from verification.runs.files import read_run, write_run

SOFT, PRESSED = {"plasticity": LINEAR}, {"force": 0.1, "steps": 2}
UNLOADED = {"force": 0.05, "steps": 1, "unload": True, "unload_steps": 1}
WAVE = {"kind": "sinusoid", "amplitude": 0.05e-6, "wavelength_x": 8e-6, "wavelength_y": 8e-6}
TRAVELLING = {"prescribed": "hertz", "p0": 2.5e9, "radius": 5e-6, "steps": 1}
TRAVELLING |= {"path": {"start": (-3e-6, 0.0), "end": (4e-6, 3e-6), "steps": 2}}
ELLIPSE = {"shape": "ellipsoid", "radius_x": 400e-6, "radius_y": 100e-6}
WIDE, WIDER = {"cells": (32, 32), "extent": (16e-6, 16e-6)}, {"cells": (31, 31), "extent": (30e-6, 30e-6)}
SCENES = {
    "elastic": {"loading": {"force": 0.05}, "grid": {"cells": (17, 17)}},
    "yielding": {"body": SOFT, "loading": UNLOADED, "grid": {"cells": (33, 33)}},
    "unloaded": {"loading": {"force": 0.0}, "grid": WIDE},
    "ellipse": {"counterbody": ELLIPSE, "loading": PRESSED, "grid": {"cells": (65, 65)}},
    "cut off": {"counterbody": {"shape": "flat"}, "loading": PRESSED, "surface": WAVE, "grid": WIDE},
    "travelling": {"body": SOFT, "loading": TRAVELLING, "grid": WIDER},
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


def test_the_history_distinguishes_loading_and_unloading_and_has_hertz():
    """A made history on the curve of Hertz: the lines begin at the first touch, and where loading ended."""
    run = found("yielding").run
    force = np.array([0.02, 0.05, 0.03, 0.0])
    x = 1e6 * hertz_of(run.scene)["approach_m"] * (force / 0.05) ** (2 / 3)
    table = {"approach_m": 1e-6 * x, "force_N": force, "note": [""] * 4}
    made = replace(run, tables={**run.tables, "history": pd.DataFrame(table)})
    (panel,) = history(made).figure.axes
    hertz, up, down = panel.lines
    assert [line.get_label() for line in panel.lines] == ["Hertz (elastic)", "loading", "unloading"]
    assert np.interp(x[0], *hertz.get_data()) == pytest.approx(0.02, rel=1e-3)
    assert np.allclose(up.get_xydata().T, [[0, *x[:2]], [0, 0.02, 0.05]])
    assert np.allclose(down.get_xydata().T, [x[1:], force[1:]])
    once = replace(made, tables={"history": pd.DataFrame(table).iloc[[0, 1, 3]].assign(note="in one step")})
    assert {line.get_linestyle() for line in history(once).figure.axes[0].lines[1:]} == {"None"}


@pytest.mark.parametrize("name", ["ellipse", "cut off", "travelling", "worn"])
def test_only_the_contact_is_coloured_and_its_largest_value_is_written(name):
    run = found(name).run
    panel = drawings_of(run)["pressure"].figure.axes[0]
    (mesh,) = (each for each in panel.collections if isinstance(each, QuadMesh))
    corners, field = mesh.get_coordinates(), np.ma.filled(mesh.get_array().astype(float), np.nan).T
    x, y, touching = corners[0, :, 0], corners[:, 0, 1], np.isfinite(field)
    assert 0 < touching.sum() < field.size and np.nanmin(field) > 0.0
    assert touching.sum() == run.summary["discretisation"]["contact_cells"]
    quoted = 1e-9 * run.quantities["p_max_Pa"]
    words = " ".join([*(text.get_text() for text in panel.texts), panel.get_title(loc="right")])
    assert float(re.search(r"max\D*?(-?[\d.]+)", words)[1]) == pytest.approx(quoted, rel=6e-4)
    (cross,) = (each for each in panel.lines if each.get_marker() == "x")
    (u, v) = cross.get_xydata()[0]
    i, j = np.searchsorted(x, u) - 1, np.searchsorted(y, v) - 1
    assert field[i, j] == pytest.approx(quoted, rel=1e-12)
    assert "mu" in panel.get_xlabel() and "mu" in panel.get_ylabel()
    if name == "travelling":
        weight, end = np.nan_to_num(field), np.array(run.scene.loading.path.end)
        centres = ((edges[1:] + edges[:-1]) / 2 for edges in (x, y))
        middle = [
            sums @ at / weight.sum() for sums, at in zip((weight.sum(1), weight.sum(0)), centres, strict=True)
        ]
        assert middle == pytest.approx(1e6 * end, abs=0.05)
    if name == "cut off":  # cells at the edge of the patch bear more, and do not count
        assert np.nanmax(field) > 1.2 * quoted and "frame" in words
        (frame,) = panel.patches
        assert frame.get_x() < u < frame.get_x() + frame.get_width() < x[-1]
    else:
        assert np.nanmax(field) == pytest.approx(quoted, rel=1e-12) and not panel.patches


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
        ("cut off", {"contact", "mises", "surface"}),
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
