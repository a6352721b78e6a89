# SPDX-License-Identifier: MIT
"""VTK reads what runs of shipped scenes write."""

import mesh_checks
import numpy as np
import pytest
import pyvista

from verification.runs import models
from verification.runs.files import read_run, write_run

CHEAP = {
    "flat-punch": models.FEM,
    "film-yield": models.FEM,
    "hertz-ellipse": models.FEM_3D,
    "hertz-sphere": models.SAM,
    "pin": models.SAM,
    "starts/indentation": models.SAM,
}


def written(folder, name: str):
    scene = mesh_checks.reduced(mesh_checks.SCENES / f"{name}.toml")
    write_run(models.solve(scene, CHEAP[name]), scene, folder, {})
    return read_run(folder)


@pytest.mark.parametrize("name", CHEAP)
def test_meshes_of_a_scene_hold_the_numbers_of_its_tables(tmp_path, name):
    run = written(tmp_path, name)
    assert mesh_checks.wrong(run) == []
    if name in ("hertz-sphere", "starts/indentation"):
        assert sum(len(found) for _, found, _ in mesh_checks.compared_stress(run)) > 20


def test_numbers_that_are_wrong_are_found(tmp_path):
    run = written(tmp_path, "hertz-sphere")
    run.tables["axis"]["szz_Pa"] *= 1 + 1e-6
    run.tables["line"]["uz_m"] *= 1 + 1e-6
    run.tables["plane"]["mises_Pa"] *= 1 + 1e-6
    fields = pyvista.read(tmp_path / "fields.vtu")
    fields.point_data["more"] = np.full(fields.n_points, np.nan)
    fields.save(tmp_path / "other.vtu")
    found = mesh_checks.wrong(run)
    assert "run.pvd: ['other.vtu']" in found and "other.vtu: more is not finite" in found
    assert {"fields.vtu: principal stresses", "surface.vtr: displacement"} <= set(found)
    assert "fields.vtu: von Mises stress" in found
