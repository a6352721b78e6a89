# SPDX-License-Identifier: MIT
"""What `samfem solve --figures` draws, read from the drawn artists: where the contact is, its largest value,
and that number.

A scene of each kind that is not a sphere in the middle: wavy, elliptic, worn, travelling; solved
here, on few cells.
"""

import re
from dataclasses import replace
from functools import cache
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
import pytest
from builders import LINEAR, running_in, scene
from matplotlib.collections import QuadMesh

from verification.cost.contact import hertz_of
from verification.figures.run import drawings_of, history
from verification.runs import models
from verification.runs.files import Run, read_run, write_run

SOFT, PRESSED = {"plasticity": LINEAR}, {"force": 0.1, "steps": 2}
WAVE = {"kind": "sinusoid", "amplitude": 0.05e-6, "wavelength_x": 8e-6, "wavelength_y": 8e-6}
TRAVELLING = {"prescribed": "hertz", "p0": 2.5e9, "radius": 5e-6, "steps": 1}


TRAVELLING |= {"path": {"start": (-3e-6, 0.0), "end": (4e-6, 3e-6), "steps": 2}}
ELLIPSE = {"shape": "ellipsoid", "radius_x": 400e-6, "radius_y": 100e-6}
WIDE, WIDER = {"cells": (32, 32), "extent": (16e-6, 16e-6)}, {"cells": (31, 31), "extent": (30e-6, 30e-6)}
SCENES = {
    "sphere": scene(body=SOFT, loading={"force": 0.05, "steps": 1}, grid={"cells": (33, 33)}),
    "ellipse": scene(counterbody=ELLIPSE, loading=PRESSED, grid={"cells": (65, 65)}),
    "cut off": scene(counterbody={"shape": "flat"}, loading=PRESSED, surface=WAVE, grid=WIDE),
    "travelling": scene(body=SOFT, loading=TRAVELLING, grid=WIDER),
    "worn": running_in(),
}


@cache
def run_of(name: str) -> Run:
    """A scene solved by SAM, read back from files that stay until the tests end."""
    folder = TemporaryDirectory()
    write_run(models.solve(SCENES[name], models.SAM), SCENES[name], folder.name, {})
    _FOLDERS.append(folder)
    return read_run(folder.name)


_FOLDERS: list[TemporaryDirectory] = []


def test_the_history_distinguishes_loading_and_unloading_and_has_hertz():
    """A made history on the curve of Hertz: the lines begin at the first touch, and where loading ended."""
    run = run_of("sphere")
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
    run = run_of(name)
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
