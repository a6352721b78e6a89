# SPDX-License-Identifier: MIT
"""The commands view and export: pictures in space of a finished run, and its meshes for other programs,
which meshio writes.

Wrong input raises FolderError before anything is drawn or written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from verification import need
from verification.figures.space import CannotDrawError, draw, draw_run
from verification.runs.files import FolderError, mesh_of, meshes_in, read_summary, replacing, write_atomically
from verification.runs.lock import locked

XDMF = {"file_format": "xdmf", "data_format": "XML"}  # all in one file
WRITERS = {"inp": {"file_format": "abaqus"}, "msh": {"file_format": "gmsh"}, "xdmf": XDMF}
"""Format -> what meshio is told."""
MESH_ALONE = "inp"
NINE = [0, 3, 5, 3, 1, 4, 5, 4, 2]
"""Rows of a tensor from XX, YY, ZZ, XY, YZ, XZ; Gmsh has no six components, XDMF another order of them."""


def view(folder: Path, *, name: str | None, out: Path | None, page: Path | None) -> int:
    """Draw one picture of the run in `folder` into the PNG `out` or the HTML file `page`, else all pictures
    into its folder of figures; 0, or 1 with a line on stderr where this machine cannot draw.
    """
    read_summary(folder)
    target = page or out
    if target is not None:
        _check_file(target, ".html" if page else ".png")
    if page:
        need("--html", "html")
    try:
        print(*_drawn(folder, name, target, as_page=page is not None), sep="\n")
    except CannotDrawError as error:
        print(f"samfem: {error}", file=sys.stderr)
        return 1
    return 0


def _drawn(folder: Path, name: str | None, target: Path | None, *, as_page: bool) -> list[Path]:
    """The files that were written. Raises FolderError for a run that does not have what is to be shown."""
    if target is None:
        with locked(folder):
            written = draw_run(folder, name)
    else:
        written = [target] * len(pictures := draw(folder, name, one=True, page=as_page))
        for content in pictures.values():
            write_atomically(target, content)
    if not written:
        what = (
            "has nothing to show in space" if name is None else f"does not have what --picture {name} shows"
        )
        raise FolderError(f"{folder} {what}; docs/guide/results.md says which runs have which pictures")
    return written


def _check_file(path: Path, ending: str) -> None:
    """Raise FolderError unless a file of this kind can be written there."""
    if path.suffix.lower() != ending:
        raise FolderError(f"{path} does not end in {ending}")
    if path.is_dir() or not path.absolute().parent.is_dir() or not os.access(path.absolute().parent, os.W_OK):
        raise FolderError(f"{path} cannot be written: give a file in a folder that can be written to")


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
    there = meshes_in(folder)
    if stem not in there:
        raise FolderError(f"{folder} has no {stem}: it has {', '.join(there) or 'no mesh'}")
    return there[stem]


def _whole(fields: Mapping[Any, Any]) -> dict[Any, Any]:
    """The fields, tensors with all nine components."""
    return {
        name: np.ascontiguousarray(values[:, NINE] if values.shape[1:] == (6,) else values)
        for name, values in fields.items()
    }
