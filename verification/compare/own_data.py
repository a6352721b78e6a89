# SPDX-License-Identifier: MIT
"""Data of the user beside both models: tables with the columns of a run, or a mesh and its mapping."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sam.scene import COLUMNS, PEAK, UNLOADED, InputError, Problem, Scene, SceneError, read_limited, spelling
from verification.compare.expected import PLACES, Expected
from verification.compare.mapping import read_mapped, von_mises
from verification.compare.rows import COLUMNS as COLUMNS_OF_ROWS
from verification.runs.tables import read_table
from verification.text.console import unknown

LARGEST = 2**30  # bytes of a table
TABLES = ("axis", "line", "plane", "history")
STRESSES = tuple(name for name in COLUMNS["axis"] if name.startswith("s") and name.endswith("_Pa"))
HISTORY = ("force_N", "approach_m", "contact_area_m2", "p_max_Pa", "peeq_max")
COMPARED = ("x_m", "z_m", "p_Pa", "uz_m", "peeq", "mises_Pa", *STRESSES)
"""Columns without which a row of a table says nothing; of others, and of a history, a cell may be empty."""
Tables = dict[str, dict[str, np.ndarray]]


@dataclass(frozen=True)
class OwnData:
    """Data beside the models. quantities: those that follow from the tables; tables: as those of a result."""

    name: str
    quantities: Mapping[str, float]
    tables: Mapping[str, Mapping[str, np.ndarray]]


def read_data(path: str | Path, scene: Scene) -> OwnData:
    """The data in a CSV file, in a folder of such files, or in the mesh that a mapping (TOML) names.

    Raises SceneError with everything that is wrong with them, or that cannot be of this scene.
    """
    path = Path(path)
    if path.stem.lower() in COLUMNS_OF_ROWS:
        raise _refused(path, [Problem("", "", f"{path.stem} is a column of compare.csv: rename the data")])
    expected = Expected.of(scene)
    if not expected.radius > 0:
        raise _refused(path, [Problem("", "", "the load is zero: there is no contact to compare with")])
    if path.suffix.lower() == ".toml":
        tables = read_mapped(path, expected.radius)
    elif path.is_dir():
        tables = _folder(path)
    elif path.suffix.lower() == ".csv":
        tables = dict([_table(path)])
    else:
        mapping = "a CSV file, a folder of CSV files, or the mapping (TOML) that names and explains a mesh"
        raise _refused(path, [Problem("", "", f"no data that can be read: give {mapping}")])
    faults = [
        Problem(f"{name}.{fault.key}", fault.value, fault.allowed)
        for name, table in tables.items()
        for fault in expected.faults(name, table)
    ]
    if faults:
        raise _refused(path, faults)
    return OwnData(path.stem, _quantities(tables), tables)


def _refused(path: Path, faults: Sequence[Problem]) -> SceneError:
    return SceneError(faults, str(path))


def _folder(path: Path) -> Tables:
    files = [file for name in TABLES if (file := path / f"{name}.csv").is_file()]
    if not files:
        names = ", ".join(f"{name}.csv" for name in TABLES)
        raise _refused(path, [Problem("", "", f"the folder has none of {names}")])
    return dict(_table(file) for file in files)


def _table(path: Path) -> tuple[str, dict[str, np.ndarray]]:
    """Which table of a run a file is, and its columns; those that are empty are left out."""
    try:
        content = read_limited(path, LARGEST).decode("utf-8-sig").encode()
        frame = read_table(content)
    except InputError as error:
        raise _refused(path, [Problem("", "", str(error))]) from None
    except ValueError as error:
        raise _refused(path, [Problem("", "", f"no table of numbers: {error}")]) from None
    frame.columns = [str(name).strip() for name in frame.columns]
    name = _kind(path, list(frame.columns))
    faults = [
        Problem(
            column,
            "",
            unknown("column", [column], COLUMNS[name], f"{name}.csv has {', '.join(COLUMNS[name])}"),
        )
        for column in frame.columns
        if column not in COLUMNS[name]
    ]
    columns = {
        column: frame[column].to_numpy()
        for column in frame.columns
        if column == "state" or not (faults or frame[column].isna().all())
    }
    faults += _bad_cells(columns)
    if faults or not len(frame):
        raise _refused(path, faults or [Problem("", "", "the table has no rows")])
    if name != "history":
        columns.setdefault("state", np.full(len(frame), PEAK))
    return name, _with_mises(_sorted(columns, PLACES.get(name, ())))


def _kind(path: Path, columns: list[str]) -> str:
    """The table that has these columns of places; a history has none."""
    places = tuple(name for name in ("x_m", "y_m", "z_m") if name in columns)
    for name, own in PLACES.items():
        if places == own:
            return name
    if not places and set(columns) & set(HISTORY):
        return "history"
    wanted = "x_m for the line, z_m for the axis, x_m and z_m for the plane y = 0, none for the history"
    raise _refused(path, [Problem("columns", spelling(", ".join(columns)), f"lengths in m as {wanted}")])


def _bad_cells(columns: Mapping[str, np.ndarray]) -> list[Problem]:
    faults = []
    for name, values in columns.items():
        if name == "state":
            bad = ~np.isin(values, (PEAK, UNLOADED))
            allowed = f'"{PEAK}" or "{UNLOADED}"'
        elif name not in COMPARED:
            continue
        else:
            bad, allowed = ~np.isfinite(values), "a number in each row, or in none"
        if bad.any():
            row = int(np.flatnonzero(bad)[0])
            faults.append(Problem(f"{name}, row {row + 1}", spelling(str(values[row])), allowed))
    return faults


def _sorted(columns: dict[str, np.ndarray], places: Sequence[str]) -> dict[str, np.ndarray]:
    """The rows by their places, ascending; a history as it is."""
    if not places:
        return columns
    order = np.lexsort([columns[place] for place in reversed(places)])
    return {name: values[order] for name, values in columns.items()}


def _with_mises(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The von Mises stress also, where all six stresses are there and it is not."""
    if "mises_Pa" in columns or not set(STRESSES) <= set(columns):
        return columns
    return columns | {"mises_Pa": von_mises(np.stack([columns[name] for name in STRESSES], axis=1))}


def _quantities(tables: Mapping[str, Mapping[str, np.ndarray]]) -> dict[str, float]:
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
        found |= _at_centre("p_center_Pa", line, "p_Pa")
    found |= _at_centre("residual_uz_center_m", _at(tables, "line", UNLOADED), "uz_m")
    for column, name in (("mises_Pa", "mises_max_Pa"), ("peeq", "peeq_max")):
        found = _largest(tables, column, name) | found
    return found


def _at(tables, name: str, state: str) -> dict[str, np.ndarray]:
    """The columns of a table in a state; none without rows."""
    table = tables.get(name, {})
    rows = np.asarray(table["state"]) == state if table else np.zeros(1, bool)
    return {column: values[rows] for column, values in table.items()} if rows.any() else {}


def _at_centre(name: str, line: Mapping[str, np.ndarray], column: str) -> dict[str, float]:
    """A value of the line at x = 0, if the line reaches there."""
    if column not in line or not line["x_m"].min() <= 0 <= line["x_m"].max():
        return {}
    return {name: float(np.interp(0.0, line["x_m"], line[column]))}


def _largest(tables, column: str, name: str) -> dict[str, float]:
    """The largest value on the axis and in the plane; its depth where it is on the axis, by a parabola."""
    axis, plane = (_at(tables, table, PEAK) for table in ("axis", "plane"))
    values = [table[column].max() for table in (axis, plane) if column in table]
    if not values:
        return {}
    found = {name: float(max(values))}
    if column in axis and axis[column].max() >= found[name]:
        return found | _refined(*np.unique(axis["z_m"], return_index=True), axis[column], name)
    return found


def _refined(z: np.ndarray, rows: np.ndarray, values: np.ndarray, name: str) -> dict[str, float]:
    """The largest value and its depth, by a parabola through three neighbours; nothing at an end."""
    values = values[rows]
    k = int(np.argmax(values))
    if not 0 < k < z.size - 1:
        return {}
    around, unit = slice(k - 1, k + 2), z[k + 1] - z[k - 1]
    bend, slope, top = np.polyfit((z[around] - z[k]) / unit, values[around], 2)
    at = (
        float(np.clip(-slope / (2 * bend), (z[k - 1] - z[k]) / unit, (z[k + 1] - z[k]) / unit))
        if bend
        else 0.0
    )
    depth = name.removesuffix("_Pa") + "_depth_m"
    return {name: float(top + at * (slope + bend * at)), depth: float(z[k] + at * unit)}
