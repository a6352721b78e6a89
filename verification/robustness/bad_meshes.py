# SPDX-License-Identifier: MIT
"""Meshes that are bad on purpose, each with the mapping that names it and a scene to compare it with."""

from __future__ import annotations

import random
import re
from functools import cache

import numpy as np

from sam.scene import GridFields, Result, Status
from verification.robustness.bad_files import AROUND, SCENE, BadInput, Special, mutated, toml_string
from verification.robustness.hostile import NUMBERS, PLACES, SMALL
from verification.runs.meshes import READABLE, mesh_files

MAPPING = "own.toml"
GOOD = """file = "own.vtu"
length_unit = "m"
stress_unit = "Pa"
axes = { x = "x", z = "-z" }
origin = [0.0, 0.0, 0.0]
step = 1
state = "peak"
pressure = "p_Pa"
mises = "mises_Pa"
displacement = "displacement_m"
"""
NOT_READ = (
    ".neu",
    ".res",
    ".nek5000",
    ".xdmf",
    ".foam",
    ".cgns",
    ".stl",
    ".inp",
    ".png",
    ".txt",
    "",
    ".",
    ".VTU",
)
_COUNT = re.compile(rb"\b\d+\b")


def with_mapping(kind: str, text: str, files: dict[str, bytes | Special]) -> BadInput:
    """A mapping beside a scene and files."""
    content = text.encode("utf-8", "surrogatepass")
    return BadInput(kind, {**AROUND, SCENE: SMALL.encode(), MAPPING: content, **files}, MAPPING)


def bad_mesh(rng: random.Random, kind: str) -> BadInput:
    """A mesh that is damaged, lies about its sizes, names others elsewhere, or is none."""
    edit = rng.randrange(6)
    name = f"own{rng.choice(('.vtu', '.vtk', '.vtr'))}"
    good = good_meshes()[name]
    if edit == 0:
        return _named(kind, name, mutated(rng, good))
    if edit == 1:  # a number of the first lines, which say how much of what there is
        found = rng.choice(list(_COUNT.finditer(good[:2_000])))
        return _named(kind, name, good[: found.start()] + rng.choice(NUMBERS).encode() + good[found.end() :])
    if edit == 2:
        place = rng.choice(
            (*PLACES, "own.vtu", "sub/own.vtu", "../own.vtu", "own.pvd", "own.vtm", "own.case")
        )
        part = f"<DataSet file={toml_string(place)}/>"
        xml = f'<VTKFile type="Collection"><Collection>{part}</Collection></VTKFile>'
        case = f"FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: 1 {place}\n"
        ending = rng.choice((".pvd", ".vtm", ".pvtu", ".case"))
        return _named(
            kind, f"own{ending}", (case if ending == ".case" else xml).encode("utf-8", "surrogatepass")
        )
    if edit == 3:
        start = rng.choice(
            (b"", b"# vtk DataFile Version 3.0\n", b"<VTKFile ", b"CDF\x01", b"\x89HDF\r\n\x1a\n", good[:300])
        )
        content = start + rng.randbytes(rng.choice((0, 1, 189, 5_000)))
        return _named(kind, f"own{rng.choice((*READABLE, *NOT_READ))}", content)
    if edit == 4:
        special = rng.choice(
            (Special("pipe"), Special("folder"), Special("link", "/dev/zero"), Special("link", "/etc/passwd"))
        )
        return _named(kind, name, special)
    return _named(kind, f"own{rng.choice(READABLE)}", good)  # with the ending of another format


def _named(kind: str, name: str, content: bytes | Special) -> BadInput:
    return with_mapping(kind, GOOD.replace('"own.vtu"', toml_string(name)), {**good_meshes(), name: content})


@cache
def good_meshes() -> dict[str, bytes]:
    """A plane below the contact of SMALL, in three formats."""
    x, z = np.linspace(-6e-5, 6e-5, 25), np.linspace(0.0, 6e-5, 13)
    p = np.where(z == 0.0, 1.0, 0.0) * np.sqrt(np.maximum(1.0 - (x[:, None] / 1.5e-5) ** 2, 0.0)) * 1e9
    fields = {
        "p_Pa": p[:, None],
        "mises_Pa": 0.5 * p[:, None],
        "displacement_m": 1e-16 * np.stack([p[:, None]] * 3),
    }
    plane = GridFields(x, np.zeros(1), z, fields, {})
    made = mesh_files(
        Result("sam", Status.CONVERGED, {}, {}, grids={"peak": {"plane": plane, "surface": plane}}), 1
    )
    return {"own.vtu": made["fields.vtu"], "own.vtr": made["surface.vtr"], "own.vtk": _legacy(x, z, p)}


def _legacy(x: np.ndarray, z: np.ndarray, p: np.ndarray) -> bytes:
    """The points of the plane with their pressure, in the old format of VTK, in bytes."""
    points = np.stack([each.ravel() for each in np.meshgrid(x, 0.0, -z, indexing="ij")], axis=-1)
    n = len(points)
    cells = np.stack([np.ones(n), np.arange(n)], axis=-1)
    values = f"\nPOINT_DATA {n}\nSCALARS p_Pa double 1\nLOOKUP_TABLE default\n".encode()
    head = (
        f"# vtk DataFile Version 3.0\nplane\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS {n} double\n".encode()
    )
    kinds = f"\nCELL_TYPES {n}\n".encode() + np.ones(n, ">i4").tobytes()
    body = points.astype(">f8").tobytes() + f"\nCELLS {n} {2 * n}\n".encode() + cells.astype(">i4").tobytes()
    return head + body + kinds + values + p.astype(">f8").tobytes()
