# SPDX-License-Identifier: MIT
"""fields.vtu as VTK itself reads it, and so ParaView and pyvista: names and order of the components of
tensors.

VTK takes six components for XX, YY, ZZ, XY, YZ, XZ, whatever their names are: its principal stresses are
right in that order only. Nothing is rendered, so no OpenGL is needed.
"""

import numpy as np
import pytest
from builders import PERFECT, scene as small_scene
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkFiltersTensor import vtkTensorPrincipalInvariants
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from sam.scene import HeightMap, Scene
from verification.runs import models
from verification.runs.files import TENSOR_NAMES, read_run, write_run

SINGLE = 1e-6
"""Of the largest stress: what single precision, in which some filters of VTK calculate, leaves; measured
1e-15.
"""
OURS = ("xx", "yy", "zz", "yz", "xz", "xy")
"""The order of a result record, whatever the file's is."""
STRESS = "stress_Pa"
SIDE = 12e-6


def smooth() -> Scene:
    """A rigid sphere on a body that yields."""
    loading, fem = {"force": 0.05, "steps": 2}, {"cells_per_radius": 8, "box": 5}
    return small_scene(body={"plasticity": PERFECT}, loading=loading, fem=fem)


def rough(n: int) -> Scene:
    """One summit beside the origin, yielding and sliding: no component vanishes under the origin."""
    x = ((np.arange(n) + 0.5) / n - 0.5) * SIDE
    height = -((x[:, None] - 0.9e-6) ** 2) / 400e-6 - (x[None, :] + 0.7e-6) ** 2 / 300e-6
    return small_scene(
        body={"plasticity": PERFECT},
        counterbody={"shape": "flat"},
        surface={"kind": "file", "path": HeightMap(height, (SIDE, SIDE))},
        friction={"coefficient": 0.3},
        loading={"force": 0.025, "steps": 1},
        grid={"layers": 6, "depth": 3e-6},
        fem={"box": 3},
    )


CASES = {models.SAM: rough(17), models.FEM: smooth(), models.FEM_3D: rough(16)}
"""On 17 cells nodes of SAM's plane lie under the origin, on 16 the middle of an element does."""


@pytest.fixture(scope="module", params=CASES)
def written(request, tmp_path_factory):
    """(the result, its run read back, its fields as VTK reads them) of each model."""
    folder = tmp_path_factory.mktemp("run")
    result = models.solve(CASES[request.param], request.param)
    assert result.converged
    write_run(result, CASES[request.param], folder, {})
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(folder / "fields.vtu"))
    reader.Update()
    return result, read_run(folder), reader.GetOutput()


def data_of(result, grid: vtkUnstructuredGrid, name: str):
    """Where a field is in the record and in VTK's grid, at the points or in the cells: (values, data)."""
    at_points = name in result.fields.point_data
    values = (result.fields.point_data if at_points else result.fields.cell_data)[name]
    return np.asarray(values), grid.GetPointData() if at_points else grid.GetCellData()


def by_name(data, name: str) -> dict[str, np.ndarray]:
    """The components of a tensor by the names that the file gives them, in lower case."""
    array = data.GetArray(name)
    names = [array.GetComponentName(k).lower() for k in range(array.GetNumberOfComponents())]
    return dict(zip(names, vtk_to_numpy(array).T, strict=True))


def principal(*components: np.ndarray) -> np.ndarray:
    """Principal values, largest first, (3, n), of xx, yy, zz, yz, xz, xy."""
    xx, yy, zz, yz, xz, xy = components
    tensor = np.stack([np.stack(row, -1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))], -1)
    return np.linalg.eigvalsh(tensor)[:, ::-1].T


def principal_of_vtk(grid: vtkUnstructuredGrid, name: str) -> np.ndarray:
    """The same as VTK's filter finds them from six components in its order, (3, n)."""
    finder = vtkTensorPrincipalInvariants()
    finder.SetInputData(grid)
    at_points = bool(grid.GetPointData().GetArray(name))
    (finder.GetPointDataArraySelection() if at_points else finder.GetCellDataArraySelection()).EnableArray(
        name
    )
    finder.Update()
    data = finder.GetOutput().GetPointData() if at_points else finder.GetOutput().GetCellData()
    return np.stack([vtk_to_numpy(data.GetArray(f"{name} - Sigma {k}")) for k in (1, 2, 3)])


@pytest.mark.parametrize("name", [STRESS, "plastic_strain"])
def test_components_have_the_names_of_vtk_and_the_values_of_the_record(written, name):
    result, _, grid = written
    values, data = data_of(result, grid, name)
    found = by_name(data, name)
    assert tuple(each.upper() for each in found) == TENSOR_NAMES == ("XX", "YY", "ZZ", "XY", "YZ", "XZ")
    for k, component in enumerate(OURS):
        np.testing.assert_array_equal(found[component], values[:, k])
    assert np.nanmax(np.abs(found["xz"])) > 0.0


@pytest.mark.parametrize("name", [STRESS, "plastic_strain"])
def test_principal_values_of_vtk_are_those_of_the_record(written, name):
    result, _, grid = written
    values, _ = data_of(result, grid, name)
    known = np.isfinite(values).all(axis=1)
    expected = principal(*values[known].T)
    found = principal_of_vtk(grid, name)[:, known]
    assert np.abs(found - expected).max() < SINGLE * np.abs(expected).max()
    swapped = principal(*values[known][:, [0, 1, 2, 4, 5, 3]].T)  # the record read in the order of VTK
    assert np.abs(swapped - expected).max() > 0.01 * np.abs(expected).max()


@pytest.mark.parametrize("written", [models.SAM, models.FEM_3D], indirect=True)
def test_principal_stresses_of_vtk_are_those_of_the_axis_table(written):
    """Under the origin: nodes of SAM's plane, elements of the three-dimensional model; exact in both."""
    result, run, grid = written
    values, data = data_of(result, grid, STRESS)
    points = np.array([grid.GetPoint(k) for k in range(grid.GetNumberOfPoints())])
    if data.GetNumberOfTuples() == grid.GetNumberOfPoints():
        places = points
    else:
        corners = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(grid.GetNumberOfCells(), -1)
        places = points[corners].mean(axis=1)
    under = (np.hypot(places[:, 0], places[:, 1]) < 1e-9 * SIDE) & np.isfinite(values).all(axis=1)
    under = np.flatnonzero(under)[np.argsort(places[under, 2])]
    table = run.tables["axis"]
    assert places[under, 2] == pytest.approx(table["z_m"], rel=1e-9)
    columns = {each: table[f"s{each}_Pa"] for each in OURS}
    expected = principal(*columns.values())
    largest = np.abs(expected).max()
    assert np.abs(principal_of_vtk(grid, STRESS)[:, under] - expected).max() < SINGLE * largest
    for each, component in by_name(data, STRESS).items():
        assert np.abs(component[under] - columns[each]).max() < SINGLE * largest
        assert np.abs(columns[each]).max() > 1e-3 * largest


@pytest.mark.parametrize("written", [models.FEM], indirect=True)
def test_stresses_of_the_axisymmetric_file_are_those_of_its_tables(written):
    """Means of elements, extrapolated to the axis, against axis.csv; by names. 2 %: from elements of a/8."""
    result, run, grid = written
    _, data = data_of(result, grid, STRESS)
    points = np.array([grid.GetPoint(k) for k in range(grid.GetNumberOfPoints())])
    corners = points[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)]
    inner, outer = corners[:, :, 0].min(axis=1), corners[:, :, 0].max(axis=1)
    depth = corners[:, :, 2].mean(axis=1)
    first = np.flatnonzero(inner == 0.0)
    first = first[np.argsort(depth[first])][1:12]
    second = [np.argmin(np.hypot(inner - outer[k], depth - depth[k])) for k in first]
    mean_r2 = 0.5 * (inner**2 + outer**2)  # of a ring: an even parabola a + b r^2 has the mean a + b mean_r2
    share = mean_r2[first] / (mean_r2[second] - mean_r2[first])
    table, found = run.tables["axis"], by_name(data, STRESS)
    largest = np.abs(table["szz_Pa"]).max()
    for name in ("xx", "yy", "zz"):
        on_axis = found[name][first] + share * (found[name][first] - found[name][second])
        expected = np.interp(depth[first], table["z_m"], table[f"s{name}_Pa"])
        assert on_axis == pytest.approx(expected, abs=0.02 * largest)
    assert np.abs(found["xz"]).max() > 0.1 * largest and not found["xy"].any() and not found["yz"].any()
