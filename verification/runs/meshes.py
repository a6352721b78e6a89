# SPDX-License-Identifier: MIT
"""The fields of a result as files that VTK, ParaView, pyvista and meshio read, z pointing up: z of the
tables, into the body, with the other sign. And the meshes of any program, read in a process of their own.

Nothing else turns the axes or the order of components of the records into those of the files. Written with
VTK itself, which takes a quarter of the time to load that pyvista takes, and loaded only here.
"""

import re
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from sam.scene import UNLOADED, FieldMesh, GridFields, InputError, LeftOut, Result, open_file, read_apart
from verification import need
from verification.runs.model_range import OUTSIDE

FIELDS, SURFACE, PARTS, STEPS = "fields.vtu", "surface.vtr", ("surface", "body"), "run.pvd"
"""Stresses and strains of every model; further parts, each NAME.vtr; the list of all, over time."""
CYCLE = "cycle-"
TENSOR_NAMES = ("XX", "YY", "ZZ", "XY", "YZ", "XZ")
"""Components of a symmetric tensor in the files, in the order in which VTK reads six components."""
_TO_VTK = [0, 1, 2, 5, 3, 4]
"""Where they are in a record, whose order is xx, yy, zz, yz, xz, xy."""
_TURNED = {3: np.array([1.0, 1.0, -1.0]), 6: np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0])}
"""Signs of the components of vectors and tensors, in VTK's order, where z points the other way."""
AXES = "z points up, out of the body: minus z_m of the tables; vectors and tensors are turned with it"
_CELLS = {"quad": (9, [0, 1, 2, 3]), "triangle": (5, [0, 1, 2]), "hexahedron": (12, [4, 5, 6, 7, 0, 1, 2, 3])}
"""Kind of cell: its number in VTK, and its corners in an order that keeps volumes above zero."""

READABLE = (".vtu", ".vtk", ".exo", ".e", ".ex2", ".pvd", ".case", ".vtr", ".vts", ".vtm", ".pvtu")
"""Endings of the meshes that are read."""
READER, BYTES = Path(__file__).with_name("mesh_child.py"), 8 << 30
FARTHEST = 1e30
"""Of a coordinate, in any unit; squares of larger ones overflow."""
_ANY_SIZE = (2, 4, 6, 7)
"""Kinds of cell of any number of nodes: points, a line, a strip, a polygon."""


def mesh_names() -> tuple[str, ...]:
    """The names of all files of a run but the surfaces after its cycles."""
    return STEPS, *(_named(part, state) for part in ("fields", *PARTS) for state in ("", UNLOADED))


def is_mesh(name: str) -> bool:
    """Whether a file of a run can have this name."""
    return name in mesh_names() or re.fullmatch(rf"surface-{CYCLE}\d+\.vtr", name) is not None


def mesh_files(result: Result, cycles: int, outside: float | None = None) -> dict[str, bytes]:
    """Name of a file -> content: parts of states, their list over cycles; none without VTK. outside: a/R."""
    files: dict[str, bytes] = {}
    entries = []
    for state, part, fields in _parts(result) if _has_vtk() else ():
        name, number = _named(part, state), ("fields", *PARTS).index(part)
        time = cycles - 0.5 * (not _ended(state))
        if state.startswith(CYCLE):
            time = float(state.removeprefix(CYCLE))
        files[name] = mesh_file(fields, outside)
        entries.append(f'  <DataSet timestep="{time!r}" part="{number}" name="{part}" file="{name}"/>')
    if entries:
        lines = ['<VTKFile type="Collection" version="0.1">', " <Collection>", *entries, " </Collection>"]
        files[STEPS] = "\n".join([*lines, "</VTKFile>", ""]).encode()
    return files


def not_written(result: Result) -> list[LeftOut]:
    """Where VTK is not installed: the files that are left out, and how to install it."""
    names = [] if _has_vtk() else [_named(part, state) for state, part, _ in _parts(result)]
    words = f"{', '.join([*names, STEPS])} (vtk is not installed: pip install 'samfem[report]')"
    return [LeftOut("meshes", words)] if names else []


def _has_vtk() -> bool:
    return find_spec("vtk") is not None


def fields_of(result: Result) -> dict[str, FieldMesh | GridFields]:
    """The fields of a result by the name that their file would have, without its ending."""
    return {Path(_named(part, state)).stem: fields for state, part, fields in _parts(result)}


def _parts(result: Result) -> Iterator[tuple[str, str, FieldMesh | GridFields]]:
    """State, part and fields of each mesh."""
    for state in dict.fromkeys((*result.grids, *result.bodies)):
        parts: dict[str, FieldMesh | GridFields] = {**result.grids.get(state, {})}
        if "plane" in parts:
            parts["fields"] = _as_mesh(parts.pop("plane"))
        if state in result.bodies:
            parts["fields"] = result.bodies[state]
        yield from ((state, part, fields) for part, fields in parts.items())


def _ended(state: str) -> bool:
    """Whether it is one at the end of a cycle."""
    return state == UNLOADED or state.startswith(CYCLE)


def as_pyvista(fields: FieldMesh | GridFields) -> Any:
    """What `read_mesh` gives of the file of a part, without the file."""
    need("a mesh")
    import pyvista

    return pyvista.wrap(_rectilinear(fields) if isinstance(fields, GridFields) else _unstructured(fields))


def mesh_file(fields: FieldMesh | GridFields, outside: float | None = None) -> bytes:
    """The content of one file; outside: see `mesh_files`."""
    from vtkmodules import vtkIOXML

    mesh = _rectilinear(fields) if isinstance(fields, GridFields) else _unstructured(fields)
    if outside is not None:
        mesh.GetFieldData().AddArray(_array(OUTSIDE, np.array([outside])))
    grid = isinstance(fields, GridFields)
    writer = (vtkIOXML.vtkXMLRectilinearGridWriter if grid else vtkIOXML.vtkXMLUnstructuredGridWriter)()
    writer.SetInputData(mesh)
    writer.WriteToOutputStringOn()
    writer.Write()
    text = writer.GetOutputString()
    return text.encode() if grid else text.replace("<VTKFile", f"<!-- {AXES} -->\n<VTKFile", 1).encode()


def read_mesh(path: Path, step: int = 0) -> tuple[int, Any]:
    """Number of load steps in a file, and the mesh at one, from 1, else the last, of pyvista. InputError."""
    need("reading a mesh")
    if path.suffix.lower() not in READABLE:
        raise InputError(f"its name ends in none of {', '.join(READABLE)}")
    try:
        open_file(path).close()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    said, arrays = read_apart(READER, str(path.absolute()), str(step), memory=BYTES)
    try:
        return int(said["steps"]), _mesh_of(arrays)
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, IndexError):
        raise InputError("its nodes, cells or fields contradict each other") from None


def _mesh_of(arrays: Mapping[str, np.ndarray]) -> Any:
    """The mesh, none of whose arrays is trusted. Raises KeyError, TypeError, ValueError or IndexError."""
    import pyvista

    places = [arrays[axis].astype(float) for axis in ("xyz" if "x" in arrays else ("points",))]
    if not all((np.abs(each) < FARTHEST).all() for each in places):
        raise InputError(f"its coordinates are not between {-FARTHEST:g} and {FARTHEST:g}")
    if "x" in arrays:
        mesh = pyvista.RectilinearGrid(*places)
    else:
        points, kinds, ends, nodes = (arrays[name] for name in ("points", "kinds", "ends", "nodes"))
        sizes = np.diff(ends, prepend=0)
        if points.shape != (len(points), 3) or sizes.sum() != nodes.size or (sizes < 1).any():
            raise ValueError("shapes")
        if not ((nodes >= 0) & (nodes < len(points))).all() or kinds.shape != ends.shape:
            raise ValueError("nodes")
        fixed = set(np.unique(kinds).tolist()) - set(_ANY_SIZE)
        if not all((sizes[kinds == kind] == _size(kind)).all() for kind in fixed):
            raise InputError("it has cells that are not read: those of fixed numbers of nodes are")
        mesh = pyvista.UnstructuredGrid(np.insert(nodes, ends - sizes, sizes), kinds, points)
    for name, values in arrays.items():
        where, _, field = name.partition(" ")
        if field:
            (mesh.point_data if where == "node" else mesh.cell_data)[field] = values
    return mesh


def _size(kind: int) -> int:
    """The number of nodes of a cell of VTK; 0 where that is not fixed."""
    from vtkmodules.vtkCommonDataModel import vtkGenericCell

    cell = vtkGenericCell.InstantiateCell(int(kind))
    return cell.GetNumberOfPoints() if cell else 0


def _named(part: str, state: str) -> str:
    """The name of the file of a part."""
    ending = "vtu" if part == "fields" else "vtr"
    return f"{part}-{state}.{ending}" if _ended(state) else f"{part}.{ending}"


def _as_mesh(plane: GridFields) -> FieldMesh:
    """The fields at the nodes of a plane y = const, which are (nx, 1, nz), as a mesh of quadrilaterals."""
    x, y, z = np.meshgrid(plane.x, plane.y, plane.z, indexing="ij")
    node = np.arange(x.size).reshape(x.shape)[:, 0]
    quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
    points = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    data = {name: values.reshape(*values.shape[:-3], -1).T for name, values in plane.point_data.items()}
    return FieldMesh(points, {"quad": quads}, data)


def _rectilinear(fields: GridFields) -> Any:
    """A grid of VTK: its points and cells run along x first, and its coordinates ascend."""
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkRectilinearGrid

    grid = vtkRectilinearGrid()
    grid.SetDimensions(fields.x.size, fields.y.size, fields.z.size)
    for axis, values in zip("XYZ", (fields.x, fields.y, 0.0 - fields.z[::-1]), strict=True):
        getattr(grid, f"Set{axis}Coordinates")(_array("", values))
    for data, found in ((grid.GetPointData(), fields.point_data), (grid.GetCellData(), fields.cell_data)):
        _add(data, {name: _upwards(np.asarray(values)) for name, values in found.items()})
    words = vtkStringArray()  # of an unstructured grid a comment: meshio reads no words
    words.SetName("axes")
    words.InsertNextValue(AXES)
    grid.GetFieldData().AddArray(words)
    return grid


def _upwards(values: np.ndarray) -> np.ndarray:
    """Values (..., nx, ny, nz) as (n,) or (n, components), with the deepest first."""
    leading = values.ndim - 3
    order = (*range(leading + 2, leading - 1, -1), *range(leading))
    return values[..., ::-1].transpose(order).reshape(-1, *values.shape[:leading])


def _unstructured(fields: FieldMesh) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkUnstructuredGrid

    mesh, points, cells = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    points.SetData(_array("", 0.0 + np.asarray(fields.points) * _TURNED[3]))
    mesh.SetPoints(points)
    kinds, sizes, nodes = [], [], []
    for kind, corners in fields.cells.items():
        number, order = _CELLS[kind]
        kinds += [np.full(len(corners), number, dtype=np.uint8)]
        sizes += [np.full(len(corners), len(order))]
        nodes += [np.asarray(corners, dtype=np.int64)[:, order].ravel()]
    ends = np.append(0, np.cumsum(np.concatenate(sizes)))
    numbers = ends.astype(np.int64), np.concatenate(nodes)
    cells.SetData(*(numpy_to_vtkIdTypeArray(each, deep=1) for each in numbers))
    mesh.SetCells(numpy_to_vtk(np.concatenate(kinds), deep=1), cells)
    _add(mesh.GetPointData(), fields.point_data)
    _add(mesh.GetCellData(), fields.cell_data)
    return mesh


def _add(data: Any, fields: Mapping[str, np.ndarray]) -> None:
    """Enter fields (n,), (n, 3) or (n, 6), of which the last two are turned."""
    for name, found in fields.items():
        values = np.asarray(found, dtype=float)
        if values.ndim > 1:
            ordered = values[:, _TO_VTK] if values.shape[1] == len(TENSOR_NAMES) else values
            values = 0.0 + ordered * _TURNED[values.shape[1]]  # 0.0: no zero with a sign
        data.AddArray(_array(name, values))


def _array(name: str, values: np.ndarray) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(np.ascontiguousarray(values, dtype=float), deep=1)
    array.SetName(name)
    if values.shape[1:] == (len(TENSOR_NAMES),):
        for k, component in enumerate(TENSOR_NAMES):
            array.SetComponentName(k, component)
    return array
