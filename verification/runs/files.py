# SPDX-License-Identifier: MIT
"""The folder of a run: CSV tables, meshes and summary.json.

Each file is written whole or not at all (a temporary file beside it, synced and renamed) and summary.json
last, so a folder without it is no result. Numbers keep every digit; what is not a number is an empty cell in
CSV and null in JSON.
"""

from __future__ import annotations

import errno
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from shutil import rmtree
from typing import TYPE_CHECKING, Any, Generic, Required, TypedDict, TypeVar

import numpy as np

from sam.scene import (
    COLUMNS,
    COST,
    EXTRA_COLUMNS,
    PATH_QUANTITIES,
    PEAK,
    QUANTITIES,
    InputError,
    Result,
    Scene,
    Table,
    open_file,
    resolved,
)
from verification.runs.meshes import STEPS, is_mesh, mesh_files, mesh_names, not_written, read_mesh
from verification.runs.model_range import OUTSIDE, outside_of_model, range_lines
from verification.runs.provenance import collect
from verification.runs.tables import columns_text, frame_of, read_table

if TYPE_CHECKING:
    from pandas import DataFrame

T = TypeVar("T")
SUMMARY = "summary.json"
CHECKPOINT = "checkpoint.npz"
COMPANION = "compare.json"
"""Beside the table of a comparison: its verdict and cost."""
MEMBERS = "members"
"""Folder in that of a run with what is solved for its uncertainty, until all of it is."""
FORMAT = "samfem run 1"
SPOTS = ("state", "spot", "x_m", "y_m", "area_m2", "force_N", "p_max_Pa", "cells")
TABLES = {**COLUMNS, "spots": SPOTS}
"""Columns of each table of a run: those of a result, and the contact spots of a rough body."""
RUN_FILES = (SUMMARY, CHECKPOINT, *(f"{name}.csv" for name in TABLES))
FIGURES, FIGURE_KINDS = "figures", (".png", ".pdf", ".svg", ".csv")
_TEMPORARY = ".part"
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Numbers of errors that say that there is no space."""


class FolderError(ValueError):
    """A folder that is no result, or that must not be written to; the message says which and what to do."""


class Uncertainty(TypedDict, total=False):
    """What is known of the numerical error of a quantity, in its unit; see `docs/guide/accuracy.md`."""

    u_num: Required[float | None]
    flag: Required[str]
    relative: float | None
    u_cells: float
    u_steps: float
    u_box: float
    order_seen: float | None
    values: list[float]
    cells: list[float]
    values_of_steps: list[float]
    steps: list[float]


class _Said(Generic[T]):
    """What summary.json says under the name of this attribute; None where an older one says nothing."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, run: Any, owner: type) -> T:
        found: Any = self if run is None else run.summary.get(self.name)
        return found


@dataclass(frozen=True)
class Run:
    """A result read back. summary: of summary.json; tables: name -> floats (NaN: empty) and texts."""

    folder: Path | None
    summary: Mapping
    tables: Mapping[str, DataFrame]

    model = _Said[str]()
    status = _Said[str]()
    message = _Said[str]()
    warnings = _Said[list[str]]()
    cost = _Said[Mapping[str, float | int | None]]()
    discretisation = _Said[Mapping[str, Any]]()
    verdict = _Said[Mapping[str, Any] | None]()
    uncertainty = _Said[Mapping[str, Uncertainty] | None]()
    model_range = _Said[Mapping[str, Any] | None]()

    @property
    def quantities(self) -> Mapping[str, float | None]:
        return dict.fromkeys(QUANTITIES) | self.summary["quantities"]  # older runs have fewer

    @property
    def last_fitting(self) -> Mapping[str, float | None]:
        return self.summary.get("last_fitting") or {}

    @property
    def range_lines(self) -> list[str]:
        """What is said about it, see `verification.runs.model_range`."""
        return [] if self.model_range is None else range_lines(self.model_range)

    @property
    def scene(self) -> Scene:
        return Scene.model_validate(self.summary["scene"])

    @property
    def converged(self) -> bool:
        return self.status == "converged"


def write_run(result: Result, scene: Scene, folder: str | Path, provenance: Mapping | None = None) -> Path:
    """Write a result into `folder` (made if need be) in place of an older one, whose figures stay if it is
    the same; the path of summary.json. provenance: as `collect` returns it. Raises FolderError if the folder
    holds anything but a run, OSError if it cannot be written.
    """
    folder = Path(folder)
    check_target(folder)
    if provenance is None:
        provenance = collect()
    outside = outside_of_model(result)
    tables = {name: _table_text(name, table, outside) for name, table in _tables(result).items()}
    said = replace(result, left_out=(*result.left_out, *not_written(result)))
    summary = plain(_summary(said, scene, provenance))
    folder.mkdir(parents=True, exist_ok=True)
    clear_run(folder, figures=not _holds(folder, summary))
    for name, text in tables.items():
        write_atomically(folder / f"{name}.csv", text.encode())
    for name, content in mesh_files(result, scene.loading.cycles, outside).items():
        write_atomically(folder / name, content)
    write_atomically(folder / SUMMARY, json_text(summary).encode())
    (folder / CHECKPOINT).unlink(missing_ok=True)  # only now: until here the solve could be continued from it
    rmtree(folder / MEMBERS, ignore_errors=True)
    return folder / SUMMARY


def read_run(folder: str | Path) -> Run:
    """The result in `folder`. Raises FolderError if there is none, or none that this version wrote."""
    folder = Path(folder)
    summary = read_summary(folder)
    paths = {name: folder / f"{name}.csv" for name in TABLES}
    return Run(folder, summary, {name: _read_table(path) for name, path in paths.items() if path.exists()})


def meshes_in(folder: Path) -> dict[str, Path]:
    """The meshes of a run by the name of their file without its ending."""
    there = [folder / name for name in mesh_names() if (folder / name).is_file()]
    return {path.stem: path for path in there if path.name != STEPS}


def mesh_of(folder: Path, name: str) -> Any:
    """A mesh of a run, as pyvista holds it. Raises FolderError for one that is damaged."""
    try:
        return read_mesh(folder / name)[1]
    except InputError as error:
        raise FolderError(f"{folder / name} is damaged ({error}): solve the scene again") from None


def run_of(result: Result, scene: Scene) -> Run:
    """A result that is in no folder, as it would be read back from one."""
    tables = {name: frame_of(table) for name, table in _tables(result).items()}
    return Run(None, plain(_summary(result, scene, collect())), tables)


def of_last_load(run: Run) -> Run:
    """The run with the last load reached in place of its peak, to be drawn; the same if that was reached."""
    if not run.last_fitting:
        return run
    stated = {name: table for name, table in run.tables.items() if "state" in table}
    tables = {**run.tables, **{name: table.assign(state=PEAK) for name, table in stated.items()}}
    return replace(run, summary={**run.summary, "quantities": run.last_fitting}, tables=tables)


def read_summary(folder: Path) -> dict:
    """summary.json of the result in `folder`. FolderError if none, or of another version."""
    try:
        with open_file(folder / SUMMARY) as stream:
            summary = json.loads(stream.read())
    except FileNotFoundError:
        reason = "it has no summary.json" if folder.is_dir() else "there is no such folder"
        raise FolderError(f"{folder} is no result: {reason}; run samfem solve first") from None
    # ValueError: not UTF-8, not JSON, a null character in the name
    except (OSError, ValueError, RecursionError) as error:
        raise FolderError(f"{folder} is no result: summary.json cannot be read ({_why(error)})") from None
    if not isinstance(summary, dict) or summary.get("format") != FORMAT:
        words = f'its summary.json, of another version, does not say "format": "{FORMAT}"'
        raise FolderError(f"{folder} is no result: {words}")
    return summary


def _why(error: Exception) -> str:
    return getattr(error, "strerror", None) or " ".join(str(error).split())


def check_target(folder: Path, also: Sequence[str] = ()) -> None:
    """Raise FolderError unless a run may be written to `folder`: absent, empty, or of an older or broken-off
    run; also: names that it may hold besides the files of a run.
    """
    try:
        check_place(folder)
        if (folder / SUMMARY).exists():
            read_summary(folder)
            return
        names = [entry.name for entry in folder.iterdir()] if folder.exists() else []
    except OSError as error:  # no permission, a name that is too long
        raise FolderError(f"{folder} cannot be used: {error.strerror}") from None
    if strange := [name for name in names if not (_of_a_run(name) or name in also)]:
        holds = f"it holds {min(strange)}"
        raise FolderError(f"{folder} is not the folder of a run ({holds}): give a new or empty one")


def check_place(folder: Path) -> None:
    """Raise FolderError, or OSError, unless a folder can be written to, or made."""
    if not folder.exists():
        parent = next(above for above in folder.absolute().parents if above.exists())
        if not parent.is_dir() or not os.access(parent, os.W_OK):
            raise FolderError(f"{folder} cannot be made: {parent} is no folder that can be written to")
    elif not folder.is_dir() or not os.access(folder, os.W_OK):
        words = "give one, new, empty or of an older run"
        raise FolderError(f"{folder} is no folder that can be written to: {words}")


def _holds(folder: Path, summary: Mapping) -> bool:
    """Whether the run in a folder has this summary."""
    try:
        older = read_summary(folder)
    except FolderError:
        return False
    return lasting(older) == lasting(summary)


def lasting(summary: Mapping) -> dict[str, Any]:
    """A summary but for its cost and provenance, which differ from solve to solve."""
    return {key: value for key, value in summary.items() if key not in ("cost", "provenance")}


def figures_of(folder: Path) -> list[Path]:
    """The files of figures of a run."""
    return [entry for entry in (folder / FIGURES).glob("*") if entry.suffix in FIGURE_KINDS]


def clear_run(folder: Path, *, figures: bool = True) -> None:
    """Remove the files of an older run, summary.json first, and its figures; a checkpoint stays."""
    (folder / SUMMARY).unlink(missing_ok=True)
    drawn = figures_of(folder) if figures else []
    for entry in [*folder.iterdir(), *drawn]:
        if entry in drawn or (entry.is_file() and _of_a_run(entry.name) and entry.name != CHECKPOINT):
            entry.unlink()


def _of_a_run(name: str) -> bool:
    temporary = name.startswith(".") and name.endswith(_TEMPORARY)
    return temporary or name in (*RUN_FILES, FIGURES, MEMBERS) or is_mesh(name)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path beside `path`; synced and renamed to it only if the block succeeds."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}{_TEMPORARY}")
    try:
        yield temporary
        with open(temporary, "rb+") as stream:
            os.fsync(stream.fileno())
        os.replace(temporary, path)
    except OSError as error:  # those of writing do not say which file
        if error.errno is not None and error.filename is None:
            error.filename = str(path)
        raise
    finally:
        temporary.unlink(missing_ok=True)


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def json_text(content: Any) -> str:
    """Content as strict JSON; NaN and infinity, which JSON has no words for, as null."""
    return json.dumps(plain(content), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """Nested mappings, sequences, arrays, enumerations and paths as what JSON holds."""
    if isinstance(value, Enum):
        return value.value
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Sequence):
        return [plain(entry) for entry in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, int) else str(value)


def _tables(result: Result) -> dict[str, Table]:
    """The tables of a result, and that of its contact spots where it is of a rough body."""
    if "surface" not in result.tables:
        return dict(result.tables)
    from verification.runs.sampling import spots_of  # noqa: PLC0415 - loads scipy

    return {**result.tables, "spots": dict(zip(SPOTS, spots_of(result.tables["surface"]), strict=True))}


def _table_text(name: str, table: Table, outside: float | None) -> str:
    """A table in the order of TABLES, with a/R outside of the model last. ValueError for other columns."""
    columns = TABLES[name] + tuple(extra for extra in EXTRA_COLUMNS.get(name, ()) if extra in table)
    if set(table) != set(columns):
        raise ValueError(f"table {name} has the columns {sorted(table)}, not {sorted(columns)}")
    shown = {column: table[column] for column in columns}
    if outside is not None:
        shown[OUTSIDE] = [outside] * len(table[columns[0]])
    return columns_text(shown)


def _read_table(path: Path) -> DataFrame:
    """The table in a file. Raises FolderError for one that is damaged."""
    try:
        with open_file(path) as stream:
            return read_table(stream.read())
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, no numbers, rows of unequal length
        raise FolderError(f"{path} is damaged ({_why(error)}): solve the scene again") from None


def _summary(result: Result, scene: Scene, provenance: Mapping) -> dict:
    known = [*QUANTITIES, *(name for name in PATH_QUANTITIES if name in result.quantities)]
    unknown = set(result.quantities) - set(known)
    if unknown:
        raise ValueError(f"quantities without a place in the interface: {sorted(unknown)}")
    return {
        "format": FORMAT,
        "status": result.status,
        "message": result.message or result.status.advice,
        "model": result.model,
        "title": scene.title,
        "scene": resolved(scene),
        "quantities": {name: result.quantities.get(name) for name in known},
        "last_fitting": dict(result.last_fitting) or None,
        "discretisation": result.discretisation,
        "certificate": result.certificate,
        "warnings": result.warnings,
        **({} if result.verdict is None else {"verdict": result.verdict}),
        **({} if result.uncertainty is None else {"uncertainty": result.uncertainty}),
        **({} if result.model_range is None else {"model_range": result.model_range}),
        "left_out": [{"stage": entry.stage, "reason": entry.reason} for entry in result.left_out],
        "cost": {name: result.cost.get(name) for name in (*COST, *(set(result.cost) - set(COST)))},
        "provenance": provenance,
    }
