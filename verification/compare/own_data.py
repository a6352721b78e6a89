# SPDX-License-Identifier: MIT
"""Data of the user beside both models: tables with the columns of a run, or a mesh of another program and the
small TOML file that says which of its arrays is what.

A wrong unit or place of data shows in what the results of the scene are about, before it is solved. A mesh
is turned and moved into the axes of the scene (x along sliding, z into the body, the origin at first contact)
and into SI units, and read along the line, the axis and the plane y = 0: at its nodes there, or, where there
are too few, at points between them. The value of a cell counts for its nodes, as the mean of those of all
cells around a node; below the surface only, where there are cells on all sides. pyvista is loaded for a mesh
only.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np
from pydantic import ValidationError

from sam import hertz_semi_axes
from sam.scene import (
    COLUMNS,
    PEAK,
    UNLOADED,
    Conflict,
    InputError,
    Problem,
    Scene,
    SceneError,
    Section,
    below,
    in_unit,
    parse_toml,
    problems,
    read_limited,
    spelling,
)
from verification.compare.rows import COLUMNS as COLUMNS_OF_ROWS
from verification.reference.hertz import effective_modulus
from verification.reference.stress import von_mises
from verification.runs.meshes import read_mesh
from verification.runs.tables import read_table
from verification.text.console import unknown
from verification.text.readable import with_prefix

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
FARTHEST = 100.0
"""Times more or less than expected: a wrong unit is off by 1000, plastic flow by less than 10."""
NEAR = 1.5  # contact radii: some values must be as near, and plastic flow may widen the contact so far
SHORTEST = 0.05  # contact radii: data that reach no farther are in a wrong unit of length
LEAST_NEAR = 2
PLACES = {"line": ("x_m",), "axis": ("z_m",), "plane": ("x_m", "z_m"), "history": ()}
LARGEST = 2**30  # bytes of a table
TABLES = ("axis", "line", "plane", "history")
HISTORY = ("force_N", "approach_m", "contact_area_m2", "p_max_Pa", "peeq_max")
COMPARED = ("x_m", "z_m", "p_Pa", "uz_m", "peeq", "mises_Pa", *(f"s{name}_Pa" for name in STRESSES))
"""Columns without which a row of a table says nothing; of others, and of a history, a cell may be empty."""
Tables = dict[str, dict[str, np.ndarray]]


@dataclass(frozen=True)
class OwnData:
    """Data beside the models. quantities: those that follow from the tables; tables: as those of a result."""

    name: str
    quantities: Mapping[str, float]
    tables: Mapping[str, Mapping[str, np.ndarray]]


def read_data(path: str | Path, scene: Scene) -> OwnData:
    """The data in a CSV file, a folder of such, or a mapped mesh. Raises SceneError with every fault."""
    path = Path(path)
    if path.stem.lower() in COLUMNS_OF_ROWS:
        raise _refused(path, [Problem("", "", f"{path.stem} is a column of compare.csv: rename the data")])
    radius, sizes = _expected(scene)
    if not radius > 0:
        raise _refused(path, [Problem("", "", "the load is zero: there is no contact to compare with")])
    if path.suffix.lower() == ".toml":
        tables = _read_mapped(path, radius)
    elif path.is_dir():
        files = [file for name in TABLES if (file := path / f"{name}.csv").is_file()]
        if not files:
            names = ", ".join(f"{name}.csv" for name in TABLES)
            raise _refused(path, [Problem("", "", f"the folder has none of {names}")])
        tables = dict(map(_read_csv, files))
    elif path.suffix.lower() == ".csv":
        tables = dict([_read_csv(path)])
    else:
        mapping = "a CSV file, a folder of CSV files, or the mapping (TOML) that names and explains a mesh"
        raise _refused(path, [Problem("", "", f"no data that can be read: give {mapping}")])
    faults = [fault for name, table in tables.items() for fault in _faults(name, table, radius, sizes)]
    if faults:
        raise _refused(path, faults)
    return OwnData(path.stem, _quantities(tables), tables)


def _refused(path: Path, faults: Sequence[Problem]) -> SceneError:
    return SceneError(faults, str(path))


def _read_csv(path: Path) -> tuple[str, dict[str, np.ndarray]]:
    """Which table of a run a file is, and its columns; those that are empty are left out."""
    try:
        content = read_limited(path, LARGEST).decode("utf-8-sig").encode()
        frame = read_table(content)
    except InputError as error:
        raise _refused(path, [Problem("", "", str(error))]) from None
    except ValueError as error:
        raise _refused(path, [Problem("", "", f"no table of numbers: {error}")]) from None
    frame.columns = [str(name).strip() for name in frame.columns]
    places = tuple(each for each in ("x_m", "y_m", "z_m") if each in frame)
    has = bool(places or {*frame} & {*HISTORY})
    named = [each for each, own in PLACES.items() if has and places == own]
    if not named:
        wanted = "x_m for the line, z_m for the axis, x_m and z_m for the plane y = 0, none for the history"
        said = spelling(", ".join(frame.columns))
        raise _refused(path, [Problem("columns", said, f"lengths in m as {wanted}")])
    (name,) = named
    known = f"{name}.csv has {', '.join(COLUMNS[name])}"
    strange = [column for column in frame.columns if column not in COLUMNS[name]]
    faults = [Problem(each, "", unknown("column", [each], COLUMNS[name], known)) for each in strange]
    empty = set(frame.columns[frame.isna().all()]) if not faults else {*frame}
    columns = {each: frame[each].to_numpy() for each in frame if each == "state" or each not in empty}
    faults += _bad_cells(columns)
    if faults or not len(frame):
        raise _refused(path, faults or [Problem("", "", "the table has no rows")])
    if name != "history":
        columns.setdefault("state", np.full(len(frame), PEAK))
    stresses = [f"s{each}_Pa" for each in STRESSES]
    if "mises_Pa" not in columns and set(stresses) <= set(columns):
        columns["mises_Pa"] = von_mises(np.stack([columns[each] for each in stresses], axis=1))
    return name, _sorted(columns, PLACES[name])


def _bad_cells(columns: Mapping[str, np.ndarray]) -> Iterator[Problem]:
    for column, values in columns.items():
        bad, allowed = ~np.isfinite(values) if column in COMPARED else [], "a number in each row, or in none"
        if column == "state":
            bad, allowed = ~np.isin(values, (PEAK, UNLOADED)), f'"{PEAK}" or "{UNLOADED}"'
        if np.any(bad):
            row = int(np.argmax(bad))
            yield Problem(f"{column}, row {row + 1}", spelling(str(values[row])), allowed)


def _sorted(columns: dict[str, np.ndarray], places: Sequence[str]) -> dict[str, np.ndarray]:
    """The rows by their places, ascending; a history as it is."""
    if not places:
        return columns
    order = np.lexsort([columns[place] for place in reversed(places)])
    return {name: values[order] for name, values in columns.items()}


def _quantities(tables: Tables) -> dict[str, float]:
    """The scalar quantities that tables of places and loads hold."""
    found: dict[str, float] = {}
    history, line = tables.get("history"), _at(tables, "line", PEAK)
    if history is not None:
        peak = int(np.nanargmax(history["force_N"])) if "force_N" in history else -1
        values = {name: float(history[name][peak]) for name in HISTORY if name in history}
        found |= {name: value for name, value in values.items() if np.isfinite(value)}
        if "contact_area_m2" in found:
            found["contact_radius_m"] = float(np.sqrt(found["contact_area_m2"] / np.pi))
    if "p_Pa" in line:
        found.setdefault("p_max_Pa", float(line["p_Pa"].max()))
    centres = ("p_center_Pa", line, "p_Pa"), ("residual_uz_center_m", _at(tables, "line", UNLOADED), "uz_m")
    for name, along, column in centres:
        if column in along and along["x_m"].min() <= 0 <= along["x_m"].max():
            found[name] = float(np.interp(0.0, along["x_m"], along[column]))
    axis, plane = (_at(tables, name, PEAK) for name in ("axis", "plane"))
    for column, name in (("mises_Pa", "mises_max_Pa"), ("peeq", "peeq_max")):
        if not (largest := [float(table[column].max()) for table in (axis, plane) if column in table]):
            continue
        of_fields = {name: max(largest)}
        if column in axis and largest[0] >= max(largest):  # its depth is known on the axis alone
            of_fields |= _refined(*np.unique(axis["z_m"], return_index=True), axis[column], name)
        found = of_fields | found
    return found


def _at(tables: Tables, name: str, state: str) -> dict[str, np.ndarray]:
    """The columns of a table in a state; none without rows."""
    table = tables.get(name, {})
    rows = table["state"] == state if table else np.zeros(1, bool)
    return {column: values[rows] for column, values in table.items()} if rows.any() else {}


def _refined(z: np.ndarray, rows: np.ndarray, values: np.ndarray, name: str) -> dict[str, float]:
    """The largest value and its depth, by a parabola through three neighbours; nothing at an end."""
    values = values[rows]
    k = int(np.argmax(values))
    if not 0 < k < z.size - 1:
        return {}
    around, unit = slice(k - 1, k + 2), z[k + 1] - z[k - 1]
    bend, slope, top = np.polyfit((z[around] - z[k]) / unit, values[around], 2)
    ends = (z[k - 1] - z[k]) / unit, (z[k + 1] - z[k]) / unit
    at = float(np.clip(-slope / (2 * bend), *ends)) if bend else 0.0
    depth = name.removesuffix("_Pa") + "_depth_m"
    return {name: float(top + at * (slope + bend * at)), depth: float(z[k] + at * unit)}


def _expected(scene: Scene) -> tuple[float, dict[str, float]]:
    """Contact radius in m, and column -> its largest value by Hertz, to a factor of ten; NaN: unknown."""
    radius, pressure, approach = float(max(hertz_semi_axes(scene))), math.nan, math.nan
    body, other, loading = scene.body, scene.counterbody, scene.loading
    if other is None:
        pressure = loading.p0 if loading.hertz else math.nan
    elif other.shape != "flat":
        modulus = effective_modulus(body.young, body.poisson, other.young, other.poisson)
        if other.radii is None:
            force = math.nan if loading.force is None else loading.force
            pressure, approach = force / (math.pi * radius**2), force / (2 * modulus * radius)
        else:
            largest = max(other.radii)
            pressure, approach = 2 * modulus * radius / (math.pi * largest), radius**2 / largest
    sizes = dict.fromkeys(("p_Pa", "p_max_Pa", "mises_Pa", "szz_Pa"), pressure)
    return radius, sizes | dict.fromkeys(("uz_m", "approach_m"), approach)


def _faults(
    name: str, table: Mapping[str, np.ndarray], radius: float, sizes: Mapping[str, float]
) -> Iterator[Problem]:
    """What a table says that cannot be of the scene: its place, its units, its signs."""
    rows = table["state"] == PEAK if "state" in table else slice(None)
    at_origin = f"the contact is at the origin, with a radius of about {with_prefix(radius, 'm')}"
    for column in PLACES[name]:
        values = table[column][rows]
        if not values.size:
            continue
        low, high = float(values.min()), float(values.max())
        reach = f"{with_prefix(low, 'm')} to {with_prefix(high, 'm')}"
        inside, words = values[values >= 0] if column == "z_m" else np.abs(values), ""
        if column == "z_m" and high <= 0 > low:
            words = "z points into the body: the axis is upside down"
        elif np.unique(inside[inside <= NEAR * radius]).size < LEAST_NEAR:
            words = f"{at_origin}: the place, or the unit of length, is another"
        elif max(abs(low), abs(high)) < SHORTEST * radius:
            words = f"{at_origin}: the unit of length is another"
        if words:
            yield Problem(f"{name}.{column}", reach, words)
    for column in (each for each in sizes if each in table):
        values, size, unit = table[column][rows], sizes[column], column.rpartition("_")[2]
        values = values[np.isfinite(values)]
        largest = float(np.abs(values).max(initial=0.0))
        if values.size and size > 0 and not size / FARTHEST <= largest <= size * FARTHEST:
            words = f"it is in {unit}, and expected at about {with_prefix(size, unit)}: the unit is another"
            yield Problem(f"{name}.{column}", f"at most {with_prefix(largest, unit)}", words)
        elif column == "p_Pa" and values.size and values.min() < -largest / 2:
            words = "p > 0 is compressive: change the sign"
            yield Problem(f"{name}.{column}", with_prefix(float(values.min()), unit), words)


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
    """The content of a mapping file. file: of the mesh, in the folder of the mapping; length_unit,
    stress_unit: of the mesh; origin: the point of first contact, in its unit; axes: its axes; step: of its
    load steps, from 1, else the last; state: the one of the scene that this is; pressure, mises, peeq: names
    of arrays; displacement, stress: of arrays with components, or lists of arrays with one; components: of
    the stress, in their order, else that of VTK.
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


def _read_mapped(path: Path, radius: float) -> Tables:
    """The tables line, axis and plane of a mapped mesh, undeformed; radius in m. Raises SceneError."""
    try:
        table = parse_toml(read_limited(path), str(path))
        mapping = MeshMapping.model_validate(table, context={"spelling": "file"})
    except InputError as error:
        raise _refused(path, [Problem("", "", str(error))]) from None
    except ValidationError as error:
        raise _refused(path, problems(error)) from None
    try:
        steps, mesh = read_mesh(below(path.parent, mapping.file, "mapping"), mapping.step or 0)
    except InputError as error:
        raise _refused(path, [Problem("file", spelling(mapping.file), f"no mesh: {error}")]) from None
    if (mapping.step or 1) > steps:
        raise _refused(path, [Problem("step", str(mapping.step), f"at most {steps}")])
    mesh = mesh.cast_to_unstructured_grid()
    fields = _fields(mapping, mesh, path)
    from_origin = np.asarray(mesh.points, dtype=float) - (mapping.origin or 0.0)
    mesh.points = from_origin @ mapping.turn.T * mapping.length
    mesh.clear_data()
    for name, (values, of_nodes) in fields.items():
        (mesh.point_data if of_nodes else mesh.cell_data)[name] = values
    _placed(mesh, mapping, path, radius)
    mesh = mesh.cell_data_to_point_data() if len(mesh.cell_data) else mesh
    tables = {}
    for name in ALONG:
        columns = [each for each in fields if (each in ("p_Pa", "uz_m")) == (name == "line")]
        columns = [each for each in columns if name != "plane" or each in ("peeq", "mises_Pa")]
        if columns:
            inside = not all(fields[each][1] for each in columns)
            table = _along(mesh, name, columns, radius=radius, inside=inside)
            tables[name] = {"state": np.full(len(table[PLACES[name][0]]), mapping.state), **table}
    return {name: table for name, table in tables.items() if len(table["state"])}


def _fields(mapping: MeshMapping, mesh: UnstructuredGrid, path: Path) -> dict[str, tuple[np.ndarray, bool]]:
    """Column of a table -> its values in SI and the axes of the scene, and whether they are of nodes."""
    widths = {"displacement": 3, "stress": len(mapping.components or VTK)}
    pascal = float(in_unit(f"1 {mapping.stress_unit}", "Pa"))
    scalars = {"pressure": ("p_Pa", pascal), "mises": ("mises_Pa", pascal), "peeq": ("peeq", 1.0)}
    fields: dict[str, tuple[np.ndarray, bool]] = {}
    faults = []
    for key in (*scalars, *widths):
        names = getattr(mapping, key)
        if names is None:
            continue
        try:
            values, of_nodes = _array(mesh, [names] if isinstance(names, str) else names, widths.get(key, 1))
        except ValueError as error:
            faults.append(Problem(key, spelling(names), str(error)))
            continue
        if key == "displacement":
            fields["uz_m"] = values @ mapping.turn[2] * mapping.length, of_nodes
        elif key == "stress":
            stress = _turned(values * pascal, mapping)
            fields |= {f"s{name}_Pa": (stress[:, k], of_nodes) for k, name in enumerate(STRESSES)}
            fields.setdefault("mises_Pa", (von_mises(stress), of_nodes))
        else:
            column, factor = scalars[key]
            fields[column] = values[:, 0] * factor, of_nodes
    if faults:
        raise _refused(path, faults)
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


def _placed(mesh: UnstructuredGrid, mapping: MeshMapping, path: Path, radius: float) -> None:
    """Raise SceneError for a mesh that has no body below the contact."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    near, um = NEAR * radius, 1e6 * np.stack([low, high], axis=1)
    box = ", ".join(
        f"{axis} {least:.4g} to {most:.4g} um" for axis, (least, most) in zip("xyz", um, strict=True)
    )
    size = f"a radius of about {1e6 * radius:.4g} um"
    about = f"the contact is at the origin with {size}, and the mesh is at {box}"
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
    origin = mapping.origin or [0, 0, 0]
    given = {"axes.z": mapping.axes.z, "origin": origin, "length_unit": mapping.length_unit}
    raise _refused(path, [Problem(key, spelling(given[key]), about + words)])


def _along(
    mesh: UnstructuredGrid, name: str, columns: Sequence[str], *, radius: float, inside: bool
) -> dict[str, np.ndarray]:
    """The columns of a table, places first: at nodes, else between them; inside: below the surface only."""
    on, reach = ON * radius, REACH * radius
    x, y, z = np.asarray(mesh.points).T
    least = on if inside else -on
    use = (np.abs(y) <= on) & (np.abs(x) <= reach) & (z > least) & (z <= reach)
    use &= {"line": np.abs(z) <= on, "axis": np.abs(x) <= on, "plane": True}[name]
    found, places = mesh, np.stack([x, y, np.maximum(z, 0.0)], axis=1)
    if use.sum() < LEAST_NODES:
        from pyvista import PolyData

        nx, nz = ALONG[name]
        xs = np.linspace(-reach, reach, nx) if nx > 1 else np.zeros(1)
        zs = np.linspace(0.0, reach, nz)
        places = np.stack([each.ravel() for each in np.meshgrid(xs, 0.0, zs, indexing="ij")], axis=1)
        found = PolyData(places).sample(mesh, tolerance=on)
        use = np.asarray(found["vtkValidPointMask"], dtype=bool) & (places[:, 2] > least)
    values = {column: np.asarray(found.point_data[column]) for column in columns}
    use &= np.isfinite(np.stack(list(values.values()))).all(axis=0)  # a pressure may be on the surface only
    table = {column: places[use, "xyz".index(column[0])] for column in PLACES[name]}
    return _sorted(table | {column: each[use] for column, each in values.items()}, PLACES[name])
