# SPDX-License-Identifier: MIT
"""A result mesh of another program, and the small TOML file that says which of its arrays is what.

The mesh is turned and moved into the axes of a scene (x along sliding, z into the body, the origin at first
contact) and into SI units, and read along the line, the axis and the plane y = 0: at its nodes there, or,
where there are too few, at points between them. The value of a cell counts for its nodes, as the mean of
those of all cells around a node; below the surface only, where there are cells on all sides. pyvista is
loaded for a mesh only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import ValidationError

from sam.scene import (
    Conflict,
    InputError,
    Problem,
    SceneError,
    Section,
    below,
    in_unit,
    parse_toml,
    problems,
    read_limited,
    spelling,
)
from verification.compare.expected import NEAR, PLACES, SHORTEST
from verification.runs.meshes import read_mesh
from verification.text.console import unknown

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

Component = Literal["xx", "yy", "zz", "yz", "xz", "xy", "zx", "yx", "zy"]
Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
STRESSES = ("xx", "yy", "zz", "yz", "xz", "xy")
VTK = ("xx", "yy", "zz", "xy", "yz", "xz")
ON = 1e-4  # contact radii: a node is on a line if it is as near; coordinates may be in single precision
REACH = 4.0  # contact radii: how far a mesh is read, twice as far as is compared
LEAST_NODES = 8  # on a line within that reach; with fewer it is read between nodes
ALONG = {"line": (801, 1), "axis": (1, 401), "plane": (161, 81)}
"""Points along x and z where a mesh is read between its nodes."""


class MeshAxes(Section):
    """Which axis of the mesh points along the x and the z of the scene: "-y" is y the other way round."""

    of_scene: ClassVar[bool] = False

    x: Axis = "x"
    z: Axis

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Say that two axes are one."""
        x, z = (str(given.get(name, "x")) for name in ("x", "z"))
        if "z" in given and x[-1:] == z[-1:]:
            yield "z", f"another axis of the mesh than x, which is {x}"


class MeshMapping(Section):
    """The content of a mapping file.

    file: of the mesh, in the folder of the mapping; length_unit, stress_unit: of the mesh; origin: the point
    of first contact, in its unit; axes: its axes; step: of its load steps, from 1, else the last; state: the
    one of the scene that this is; pressure, mises, peeq: names of arrays; displacement, stress: of arrays
    with components, or lists of arrays with one; components: of the stress, in their order, else that
    of VTK.
    """

    of_scene: ClassVar[bool] = False

    file: str
    length_unit: str
    stress_unit: str
    axes: MeshAxes
    origin: list[float] | None = None
    step: int | None = None
    state: Literal["peak", "unloaded"] = "peak"
    pressure: str | None = None
    mises: str | None = None
    peeq: str | None = None
    displacement: str | list[str] | None = None
    stress: str | list[str] | None = None
    components: list[Component] | None = None

    @classmethod
    def _field_in_words(cls, name: str, file: bool) -> str:
        words = {"file": "the name of a mesh", "axes": 'a table, axes = { x = "x", z = "-y" }'}
        return words.get(name, 'a unit, such as "mm" or "MPa"')

    def excesses(self) -> Iterator[Conflict]:
        """Say which values cannot be used."""
        for key, unit in (("length_unit", "m"), ("stress_unit", "Pa")):
            if in_unit(f"1 {getattr(self, key)}", unit) is None:
                yield key, f'a unit of the dimension of {unit}, such as "{ {"m": "mm", "Pa": "MPa"}[unit] }"'
        if self.origin is not None and (len(self.origin) != 3 or not np.isfinite(self.origin).all()):
            yield "origin", "three numbers in length_unit"
        if Path(self.file).is_absolute():
            yield "file", "a path from the folder of the mapping, to a mesh in it or below"
        if self.step is not None and self.step < 1:
            yield "step", "a whole number from 1"
        if not any((self.pressure, self.mises, self.peeq, self.displacement, self.stress)):
            yield "pressure", "at least one of pressure, displacement, stress, mises and peeq"

    @property
    def length(self) -> float:
        return float(in_unit(f"1 {self.length_unit}", "m"))

    @property
    def turn(self) -> np.ndarray:
        """The axes x, y and z of the scene in those of the mesh, (3, 3), one a row."""
        x, z = _direction(self.axes.x), _direction(self.axes.z)
        return np.array([x, np.cross(z, x), z])


def _direction(axis: str) -> np.ndarray:
    return (-1.0 if axis.startswith("-") else 1.0) * np.eye(3)["xyz".index(axis[-1])]


def read_mapped(path: Path, radius: float) -> dict[str, dict[str, np.ndarray]]:
    """The tables line, axis and plane of the mesh that a mapping file names.

    radius: of the contact in m, about. Raises SceneError with everything that is wrong with mapping or mesh.
    """
    mapping = _mapping(path)
    mesh = _mesh(mapping, path)
    fields = _fields(mapping, mesh, path)
    mesh.points = (
        (np.asarray(mesh.points, dtype=float) - (mapping.origin or 0.0)) @ mapping.turn.T * mapping.length
    )
    mesh.clear_data()
    for name, (values, of_nodes) in fields.items():
        (mesh.point_data if of_nodes else mesh.cell_data)[name] = values
    _placed(mesh, mapping, path, radius)
    mesh = mesh.cell_data_to_point_data() if len(mesh.cell_data) else mesh
    tables = {}
    for name in ALONG:
        columns = [each for each in fields if (each in ("p_Pa", "uz_m")) == (name == "line")]
        wanted = {
            each: fields[each][1] for each in columns if name != "plane" or each in ("peeq", "mises_Pa")
        }
        if wanted:
            tables[name] = _along(mesh, name, wanted, radius=radius, state=mapping.state)
    return {name: table for name, table in tables.items() if len(table["state"])}


def _mapping(path: Path) -> MeshMapping:
    try:
        table = parse_toml(read_limited(path), str(path))
        return MeshMapping.model_validate(table, context={"spelling": "file"})
    except InputError as error:
        raise SceneError([Problem("", "", str(error))], str(path)) from None
    except ValidationError as error:
        raise SceneError(problems(error), str(path)) from None


def _mesh(mapping: MeshMapping, path: Path) -> UnstructuredGrid:
    """The mesh as one grid, at its load step, undeformed."""
    try:
        steps, mesh = read_mesh(below(path.parent, mapping.file, "mapping"), mapping.step or 0)
    except InputError as error:
        raise SceneError([Problem("file", spelling(mapping.file), f"no mesh: {error}")], str(path)) from None
    if (mapping.step or 1) > steps:
        raise SceneError([Problem("step", str(mapping.step), f"at most {steps}")], str(path))
    return mesh.cast_to_unstructured_grid()


def _fields(mapping: MeshMapping, mesh: UnstructuredGrid, path: Path) -> dict[str, tuple[np.ndarray, bool]]:
    """Column of a table -> its values in SI and the axes of the scene, and whether they are of nodes."""
    wanted = {
        "pressure": 1,
        "mises": 1,
        "peeq": 1,
        "displacement": 3,
        "stress": len(mapping.components or VTK),
    }
    found, faults = {}, []
    for key, width in wanted.items():
        names = getattr(mapping, key)
        if names is None:
            continue
        try:
            found[key] = _array(mesh, [names] if isinstance(names, str) else names, width)
        except ValueError as error:
            faults.append(Problem(key, spelling(names), str(error)))
    if faults:
        raise SceneError(faults, str(path))
    pascal = float(in_unit(f"1 {mapping.stress_unit}", "Pa"))
    fields = {
        column: (found[key][0][:, 0] * factor, found[key][1])
        for key, column, factor in (
            ("pressure", "p_Pa", pascal),
            ("mises", "mises_Pa", pascal),
            ("peeq", "peeq", 1.0),
        )
        if key in found
    }
    if "displacement" in found:
        values, of_nodes = found["displacement"]
        fields["uz_m"] = values @ mapping.turn[2] * mapping.length, of_nodes
    if "stress" in found:
        values, of_nodes = found["stress"]
        stress = _turned(values * pascal, mapping)
        fields |= {f"s{name}_Pa": (stress[:, k], of_nodes) for k, name in enumerate(STRESSES)}
        fields.setdefault("mises_Pa", (von_mises(stress), of_nodes))
    return fields


def _array(mesh: UnstructuredGrid, names: list[str], width: int) -> tuple[np.ndarray, bool]:
    """An array, or several beside each other, (n, width), and whether of nodes. Raises ValueError."""
    known = [*mesh.point_data.keys(), *mesh.cell_data.keys()]
    strange = [name for name in names if name not in known]
    if strange:
        raise ValueError(unknown("array", strange, known, f"the mesh has {', '.join(known) or 'none'}"))
    of_nodes = all(name in mesh.point_data for name in names)
    data = mesh.point_data if of_nodes else mesh.cell_data
    if not all(name in data for name in names):
        raise ValueError("arrays of nodes or of cells, not both")
    values = np.column_stack([np.asarray(data[name], dtype=float) for name in names])
    if width == 3 and values.shape[1] == 2:  # of a plane or axisymmetric mesh
        values = np.column_stack([values, np.zeros(len(values))])
    if values.shape[1] != width:
        raise ValueError(f"{width} components, here {values.shape[1]}")
    if not np.isfinite(values).any():
        raise ValueError("numbers, here are none")
    return values, of_nodes


def _turned(values: np.ndarray, mapping: MeshMapping) -> np.ndarray:
    """Stresses (n, components) in the axes of the scene, (n, 6) in the order of STRESSES."""
    tensor = np.zeros((len(values), 3, 3))
    for k, name in enumerate(mapping.components or VTK):
        i, j = ("xyz".index(letter) for letter in name)
        tensor[:, i, j] = tensor[:, j, i] = values[:, k]
    turned = mapping.turn @ tensor @ mapping.turn.T
    return np.stack([turned[:, "xyz".index(a), "xyz".index(b)] for a, b in map(tuple, STRESSES)], axis=1)


def von_mises(stresses: np.ndarray) -> np.ndarray:
    """From stresses (n, 6) in the order of STRESSES, (n,)."""
    xx, yy, zz, *shear = stresses.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(normal / 2 + 3 * sum(each**2 for each in shear))


def _placed(mesh: UnstructuredGrid, mapping: MeshMapping, path: Path, radius: float) -> None:
    """Raise SceneError for a mesh that has no body below the contact."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    um, near = 1e6, NEAR * radius
    box = ", ".join(
        f"{a} {lo * um:.4g} to {hi * um:.4g} um" for a, lo, hi in zip("xyz", low, high, strict=True)
    )
    about = (
        f"the contact is at the origin with a radius of about {radius * um:.4g} um, and the mesh is at {box}"
    )
    x, y, z = np.abs(mesh.points).T
    around = ((x <= REACH * radius) & (y <= REACH * radius) & (z <= REACH * radius)).sum()
    if high[2] < ON * radius <= -low[2]:
        key, words = "axes.z", ": z points into the body, the axis is upside down"
    elif (low[:2] > near).any() or (high[:2] < -near).any() or low[2] > near:
        key, words = "origin", ": they do not overlap"
    elif (high - low).max() < SHORTEST * radius or around < LEAST_NODES:
        key, words = "length_unit", f" with {around} nodes near the contact: the unit is another"
    else:
        return
    given = {
        "axes.z": mapping.axes.z,
        "origin": mapping.origin or [0, 0, 0],
        "length_unit": mapping.length_unit,
    }
    raise SceneError([Problem(key, spelling(given[key]), about + words)], str(path))


def _along(
    mesh: UnstructuredGrid, name: str, wanted: Mapping[str, bool], *, radius: float, state: str
) -> dict[str, np.ndarray]:
    """The columns of a table: at nodes of the mesh, else between them."""
    on, reach = ON * radius, REACH * radius
    x, y, z = np.asarray(mesh.points).T
    use = (np.abs(y) <= on) & (np.abs(x) <= reach) & (z >= -on) & (z <= reach)
    use &= {"line": np.abs(z) <= on, "axis": np.abs(x) <= on, "plane": True}[name]
    if not all(wanted.values()):
        use &= z > on
    if use.sum() >= LEAST_NODES:
        values = {column: np.asarray(mesh.point_data[column])[use] for column in wanted}
        return _table(name, np.stack([x, y, np.maximum(z, 0.0)], axis=1)[use], values, state)
    from pyvista import PolyData

    nx, nz = ALONG[name]
    xs = np.linspace(-reach, reach, nx) if nx > 1 else np.zeros(1)
    zs = np.linspace(0.0, reach, nz)
    places = np.stack([each.ravel() for each in np.meshgrid(xs, 0.0, zs, indexing="ij")], axis=1)
    found = PolyData(places).sample(mesh, tolerance=on)
    valid = np.asarray(found["vtkValidPointMask"], dtype=bool) & (all(wanted.values()) | (places[:, 2] > on))
    values = {column: np.asarray(found[column])[valid] for column in wanted}
    return _table(name, places[valid], values, state)


def _table(name: str, places: np.ndarray, values: dict, state: str) -> dict[str, np.ndarray]:
    """places: (n, 3), in the order of which the rows are."""
    places = {column: places[:, "xyz".index(column[0])] for column in PLACES[name]}
    there = np.isfinite(np.stack(list(values.values()))).all(axis=0)  # a pressure may be on the surface only
    order = np.lexsort(list(places.values())[::-1])
    order = order[there[order]]
    columns = {column: each[order] for column, each in (places | values).items()}
    return {"state": np.full(len(order), state), **columns}
