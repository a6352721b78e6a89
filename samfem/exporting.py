# SPDX-License-Identifier: MIT
"""The command export: a mesh of a run in a format of other programs, written by meshio."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from verification.runs.files import FolderError, mesh_of, read_summary, replacing
from verification.runs.meshes import mesh_names

XDMF = {"file_format": "xdmf", "data_format": "XML"}  # all in one file
WRITERS = {"inp": {"file_format": "abaqus"}, "msh": {"file_format": "gmsh"}, "xdmf": XDMF}
"""Format -> what meshio is told."""
MESH_ALONE = "inp"
NINE = [0, 3, 5, 3, 1, 4, 5, 4, 2]
"""Rows of a tensor from XX, YY, ZZ, XY, YZ, XZ; Gmsh has no six components, XDMF another order of them."""


def export(folder: Path, *, file_format: str, part: str, state: str, out: Path | None) -> int:
    """Write one part of a run: its mesh, and its fields where the format holds them.

    Raises FolderError for a folder that is no run, a part that the run does not have, and a place that cannot
    be written to.
    """
    import meshio
    from pyvista import to_meshio

    read_summary(folder)
    source = _source(folder, part, state)
    place = out or Path(f"{source.stem}.{file_format}")
    if place.suffix != f".{file_format}":
        raise FolderError(f"--out {place}: a name that ends in .{file_format} is needed")
    if place.is_dir() or not place.absolute().parent.is_dir():
        raise FolderError(f"--out {place}: the name of a file in a folder that exists is needed")
    mesh = to_meshio(mesh_of(folder, source.name).cast_to_unstructured_grid())
    mesh.point_data = _whole(mesh.point_data)
    mesh.cell_data = {
        name: list(_whole(dict(enumerate(each))).values()) for name, each in mesh.cell_data.items()
    }
    if file_format == MESH_ALONE:
        mesh.point_data, mesh.cell_data = {}, {}
        print("an Abaqus input file holds the mesh alone, without fields")
    with replacing(place) as temporary:
        meshio.write(temporary, mesh, **WRITERS[file_format])
    print(place)
    return 0


def _source(folder: Path, part: str, state: str) -> Path:
    """The file of a part of a run in a state, "unloaded" or the first one."""
    stem = f"{part}-{state}" if state == "unloaded" else part
    there = [name for name in mesh_names() if (folder / name).is_file() and not name.endswith(".pvd")]
    for name in there:
        if Path(name).stem == stem:
            return folder / name
    have = ", ".join(Path(name).stem for name in there) or "no mesh"
    raise FolderError(f"{folder} has no {stem}: it has {have}")


def _whole(fields: Mapping[Any, Any]) -> dict[Any, Any]:
    """The fields, tensors with all nine components."""
    return {
        name: np.ascontiguousarray(values[:, NINE] if values.shape[1:] == (6,) else values)
        for name, values in fields.items()
    }
