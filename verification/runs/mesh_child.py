# SPDX-License-Identifier: MIT
"""A mesh read by VTK, in a process of its own: see `sam.scene.inputs`.

The files of a run need a part of VTK that loads in a third of the time of pyvista.
"""

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

IN_PARTS = (".pvd", ".pvtu", ".vtm", ".case")
"""Endings of files that name others."""


class RefusedError(Exception):
    """A mesh that is not read; the message says why."""


def answer(_: bytes, path: str, step: str) -> tuple[dict[str, int], dict[str, np.ndarray]]:
    """The number of load steps, and the arrays of the mesh at one of them, 0 for the last: nodes x, y and z
    of a grid, else points, kinds of the cells, ends of their nodes in `nodes`; data as "node NAME" and
    "cell NAME".
    """
    if Path(path).suffix.lower() in IN_PARTS:
        _check_parts(Path(path))
    own = Path(path).suffix.lower() in (".vtu", ".vtr")
    steps, mesh = (1, _one(path)) if own else _of_pyvista(path, int(step))
    if not mesh.GetNumberOfPoints() or not mesh.GetNumberOfCells():
        raise RefusedError("it has no nodes or no cells")
    return {"steps": steps}, _arrays(mesh)


def _one(path: str) -> Any:
    from vtkmodules import vtkIOXML

    grid = Path(path).suffix.lower() == ".vtr"
    reader = (vtkIOXML.vtkXMLRectilinearGridReader if grid else vtkIOXML.vtkXMLUnstructuredGridReader)()
    faults: list[str] = []
    reader.AddObserver("ErrorEvent", lambda *_: faults.append(""))
    reader.SetFileName(path)
    reader.Update()
    if faults or reader.GetErrorCode():
        raise RefusedError("it cannot be read")
    return reader.GetOutput()


def _of_pyvista(path: str, step: int) -> tuple[int, Any]:
    import pyvista

    reader = pyvista.get_reader(path)
    steps = max(getattr(reader, "number_time_points", 0), 1)
    if steps > 1 and (step or steps) <= steps:
        reader.set_active_time_point((step or steps) - 1)
    if hasattr(reader.reader, "SetApplyDisplacements"):
        reader.reader.SetApplyDisplacements(0)
    try:
        mesh = reader.read()
    except Exception as error:
        lines = str(error).splitlines() or [type(error).__name__]
        in_vtk = lines[0].startswith("ERROR: In vtk")  # it names a line of its source
        raise RefusedError("it cannot be read" if in_vtk else lines[0]) from None
    several = isinstance(mesh, pyvista.MultiBlock)
    return steps, mesh.combine() if several else mesh.cast_to_unstructured_grid()


def _arrays(mesh: Any) -> dict[str, np.ndarray]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    if hasattr(mesh, "GetXCoordinates"):
        found = {axis: vtk_to_numpy(getattr(mesh, f"Get{axis.upper()}Coordinates")()) for axis in "xyz"}
    else:
        cells = mesh.GetCells()
        found = {
            "points": vtk_to_numpy(mesh.GetPoints().GetData()),
            "kinds": vtk_to_numpy(mesh.GetCellTypesArray()),
            "ends": vtk_to_numpy(cells.GetOffsetsArray())[1:],
            "nodes": vtk_to_numpy(cells.GetConnectivityArray()),
        }
    for where, data in (("node", mesh.GetPointData()), ("cell", mesh.GetCellData())):
        for k in range(data.GetNumberOfArrays()):
            array = data.GetArray(k)  # None: of words
            if array is not None and array.GetName() and not array.GetName().startswith("vtkGhost"):
                found[f"{where} {array.GetName()}"] = vtk_to_numpy(array)
    return found


def _check_parts(path: Path) -> None:
    """Raise RefusedError for a file that names one outside of its folder."""
    if path.suffix.lower() == ".case":
        words = re.split(r"[\s:\"]+", path.read_text(encoding="utf-8", errors="replace"))
    else:
        words = [value for each in ElementTree.parse(path).iter() for value in each.attrib.values()]
    home = path.parent.resolve()
    for word in set(words):
        place = (home / word).resolve()
        if not place.is_relative_to(home):
            raise RefusedError(f"it names {word}, outside of its folder: copy it there")
        if place.suffix.lower() in IN_PARTS and place != path.resolve() and place.is_file():
            _check_parts(place)
