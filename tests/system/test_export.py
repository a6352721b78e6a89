# SPDX-License-Identifier: MIT
"""`samfem export`: what meshio reads back is the mesh of the run, with every digit."""

import shutil

import meshio
import numpy as np
import pytest
import pyvista
from builders import PERFECT, scene

from samfem.cli import FORMATS
from verification.runs import models
from verification.runs.files import write_run

HEX, QUAD = "hexahedron", "quad"
PARTS = {
    models.SAM: {"fields": QUAD, "surface": QUAD, "body": HEX},
    models.FEM: {"fields": QUAD},
    models.FEM_3D: {"fields": HEX, "surface": QUAD},
}
CASES = [(model, part, kind) for model, parts in PARTS.items() for part, kind in parts.items()]


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Model -> folder of a run of it."""
    folder = tmp_path_factory.mktemp("runs")
    found = scene(
        body={"plasticity": PERFECT},
        loading={"force": 0.05, "steps": 1},
        fem={"cells_per_radius": 4, "box": 5},
        grid={"cells": (17, 17), "extent": (12e-6, 12e-6), "layers": 6, "depth": 4e-6},
    )
    for model in PARTS:
        write_run(models.solve(found, model), found, folder / model, {})
    return folder


@pytest.mark.parametrize("model, part, kind", CASES)
def test_an_exported_mesh_reads_back_to_the_last_digit(runs, folder, samfem, model, part, kind):
    (source,) = (runs / model).glob(f"{part}.vt?")
    ours = pyvista.read(source).cast_to_unstructured_grid()
    for name in (f"{part}.{each}" for each in FORMATS):
        samfem("export", runs / model, "--format", name.rpartition(".")[2], "--part", part)
        read = meshio.read(folder / name)
        np.testing.assert_array_equal(read.points, ours.points)
        (block,) = read.cells
        assert block.type == kind and len(block.data) == ours.n_cells
        centres = read.points[block.data].mean(axis=1)
        assert centres == pytest.approx(ours.cell_centers().points, rel=1e-12, abs=1e-18)
        if name.endswith(".inp"):
            assert not (read.point_data or read.cell_data)
            continue
        own = {name: values[0] for name, values in read.cell_data.items()} | read.point_data
        for key, values in (*ours.point_data.items(), *ours.cell_data.items()):
            expected = np.asarray(values)
            if expected.shape[1:] == (6,):
                xx, yy, zz, xy, yz, xz = expected.T
                expected = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1)
            np.testing.assert_array_equal(own[key].reshape(expected.shape), expected)
    assert sorted(path.name for path in folder.iterdir()) == [f"{part}.{each}" for each in FORMATS]


@pytest.mark.parametrize(
    "words", [["export", "--format", "msh", "--part", "surface"], ["view"], ["report", "--pdf"]]
)
def test_a_run_whose_mesh_is_damaged_is_refused(runs, folder, refused, words, monkeypatch):
    monkeypatch.setenv("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")  # of a display nothing is needed
    shutil.copytree(runs / models.FEM_3D, folder / "run")
    surface = (folder / "run" / "surface.vtr").read_bytes()
    (folder / "run" / "surface.vtr").write_bytes(surface[: len(surface) // 2])
    said = refused(words[0], "run", *words[1:])
    assert "run/surface.vtr is damaged (it cannot be read): solve the scene again" in said
