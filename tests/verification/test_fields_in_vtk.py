# SPDX-License-Identifier: MIT
"""The meshes of a run as VTK itself reads them, and so ParaView and pyvista: names and order of components, z
upwards.

VTK takes six components for XX, YY, ZZ, XY, YZ, XZ, whatever their names are: its principal stresses are
right in that order only. Nothing is rendered, so no OpenGL is needed.
"""

import numpy as np
import pytest
import pyvista
from builders import PERFECT, scene as small_scene
from vtkmodules.vtkFiltersTensor import vtkTensorPrincipalInvariants

from sam.scene import HeightMap, Scene
from verification.runs import models
from verification.runs.files import read_run, write_run
from verification.runs.meshes import TENSOR_NAMES, mesh_names

SINGLE = 1e-6
"""Of the largest stress: what single precision, in which some filters of VTK calculate, leaves; measured
1e-15.
"""
SIDE = 12e-6


def rough(n: int) -> Scene:
    """One summit beside the origin, yielding and sliding: no component vanishes under the origin."""
    x = ((np.arange(n) + 0.5) / n - 0.5) * SIDE
    height = -((x[:, None] - 0.9e-6) ** 2) / 400e-6 - (x[None, :] + 0.7e-6) ** 2 / 300e-6
    return small_scene(
        body={"plasticity": PERFECT},
        counterbody={"shape": "flat"},
        surface={"kind": "file", "path": HeightMap(height, (SIDE, SIDE))},
        friction={"coefficient": 0.3},
        loading={"force": 0.025, "steps": 1, "unload": True},
        grid={"layers": 6, "depth": 3e-6},
        fem={"box": 3},
    )


SMOOTH = small_scene(
    body={"plasticity": PERFECT},
    loading={"force": 0.05, "steps": 2, "unload": True},
    fem={"cells_per_radius": 8, "box": 5},
)
CASES = {models.SAM: rough(17), models.FEM: SMOOTH, models.FEM_3D: rough(16)}
"""On 17 cells nodes of SAM's plane lie under the origin, on 16 the middle of an element does."""
STATES = {"peak": "", "unloaded": "-unloaded"}
OURS = {"xx": 1.0, "yy": 1.0, "zz": 1.0, "yz": -1.0, "xz": -1.0, "xy": 1.0}
"""Components of a result record, in its order -> sign where z points the other way."""


@pytest.fixture(scope="module", params=CASES)
def written(request, tmp_path_factory):
    """(the result, its run read back) of each model."""
    folder, scene = tmp_path_factory.mktemp("run"), CASES[request.param]
    result = models.solve(scene, request.param)
    assert result.converged
    write_run(result, scene, folder, {})
    return result, read_run(folder)


def principal(xx, yy, zz, yz, xz, xy) -> np.ndarray:
    """Principal values, largest first, (3, n)."""
    tensor = np.stack([np.stack(row, -1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))], -1)
    return np.linalg.eigvalsh(tensor)[:, ::-1].T


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("name", ["stress_Pa", "plastic_strain"])
def test_components_have_the_names_order_and_turned_values_that_vtk_expects(written, name, state):
    grid = pyvista.read(written[1].folder / f"fields{STATES[state]}.vtu")
    of_points, result = name in grid.point_data, written[0]
    if of_points:
        values = result.grids[state]["plane"].point_data[name].reshape(6, -1).T
    else:
        values = result.bodies[state].cell_data[name]
    array = (grid.GetPointData() if of_points else grid.GetCellData()).GetArray(name)
    names = tuple(array.GetComponentName(k) for k in range(array.GetNumberOfComponents()))
    assert names == TENSOR_NAMES == ("XX", "YY", "ZZ", "XY", "YZ", "XZ")
    for k, (component, sign) in enumerate(OURS.items()):
        found = (grid.point_data if of_points else grid.cell_data)[name][:, names.index(component.upper())]
        np.testing.assert_array_equal(found, sign * values[:, k])
    finder = vtkTensorPrincipalInvariants()
    finder.SetInputData(grid)
    selected = finder.GetPointDataArraySelection() if of_points else finder.GetCellDataArraySelection()
    selected.EnableArray(name)
    finder.Update()
    of_vtk = pyvista.wrap(finder.GetOutput())
    found = np.stack([of_vtk[f"{name} - Sigma {k}"] for k in (1, 2, 3)])
    expected = principal(*values.T)
    largest = np.abs(expected).max()
    assert np.abs(found - expected).max() < SINGLE * largest
    swapped = principal(*values[:, [0, 1, 2, 4, 5, 3]].T)  # the record read in the order of VTK
    assert np.abs(swapped - expected).max() > 0.01 * largest


def test_every_file_is_listed_in_order_reads_without_gaps_and_says_where_z_points(written):
    result, run = written
    steps = pyvista.PVDReader(run.folder / "run.pvd")
    assert steps.time_values == [0.5, 1.0]
    parts = {"fields", "surface"} | ({"body"} if result.model == models.SAM else set())
    for state, time in zip(STATES, steps.time_values, strict=True):
        listed = {each.path for each in steps.datasets if each.time == time}
        assert {path.split(".")[0] for path in listed} == {f"{part}{STATES[state]}" for part in parts}
    listed = {each.path for each in steps.datasets}
    on_disk = {path.name for path in run.folder.iterdir() if path.suffix in (".vtu", ".vtr")}
    assert listed == on_disk and {*listed, "run.pvd"} <= set(mesh_names())
    for name in listed:
        mesh = pyvista.read(run.folder / name)
        head = (run.folder / name).read_text(encoding="utf-8").splitlines()[1]
        said = head if name.endswith(".vtu") else mesh.field_data["axes"][0]
        assert said.lstrip("<!- ").startswith("z points up")
        assert mesh.n_cells > 0 and mesh.bounds[5] <= 0.0 and mesh.length > 0.0
        if name == {models.SAM: "body.vtr", models.FEM_3D: "fields.vtu"}.get(result.model):
            assert mesh.compute_cell_sizes()["Volume"].min() > 0.0  # of an element turned inside out: below
        for values in (*mesh.point_data.values(), *mesh.cell_data.values()):
            assert np.isfinite(values).all()
