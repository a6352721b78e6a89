# SPDX-License-Identifier: MIT
"""Result meshes as converters of other programs write them, made from a result, with errors put in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyvista
from scipy.io import netcdf_file

AXES = 'axes = { x = "x", z = "-y" }\n'
ABAQUS = f"""file = "abaqus.vtu"
length_unit = "mm"
stress_unit = "MPa"
{AXES}pressure = "CPRESS"
displacement = "U"
stress = "S"
components = ["xx", "yy", "zz", "xy", "xz", "yz"]
"""
FROM_SCENE = [0, 2, 1, 4, 5, 3]
"""S11 (radial), S22 (axial, upwards), S33 (hoop), S12, S13, S23 among xx, yy, zz, yz, xz, xy of a result."""


def abaqus_mesh(fem, *, pressure: float = 1.0, shift: float = 0.0) -> pyvista.UnstructuredGrid:
    """The axisymmetric result in mm and MPa, y upwards, its pressure scaled and its nodes moved by mm."""
    points, quads = np.asarray(fem.fields.points), np.asarray(fem.fields.cells["quad"])
    mesh = pyvista.UnstructuredGrid(
        {pyvista.CellType.QUAD: quads}, 1e3 * points[:, [0, 2, 1]] * [1.0, -1.0, 1.0]
    )
    mesh.points[:, 0] += shift
    mesh.point_data["CPRESS"] = np.asarray(fem.fields.point_data["p_Pa"]) * 1e-6 * pressure
    uz = np.asarray(fem.fields.point_data["uz_m"])
    mesh.point_data["U"] = np.stack([0 * uz, -1e3 * uz, 0 * uz], axis=1)
    stress = np.asarray(fem.fields.cell_data["stress_Pa"])[:, FROM_SCENE] * 1e-6
    mesh.cell_data["S"] = stress * [1, 1, 1, -1, 1, -1]  # axial upwards: shear with it changes its sign
    return mesh


def mirrored(mesh: pyvista.UnstructuredGrid, shift: float = 0.0) -> pyvista.UnstructuredGrid:
    """Both sides of the axis, moved along x by mm: the plane y = 0 of a mesh in space."""
    other = mesh.copy()
    other.points[:, 0] *= -1.0
    both = mesh.merge(other, merge_points=False)
    both.points[:, 0] += shift
    return both


def write_exodus(path: Path, mesh: pyvista.UnstructuredGrid, factors=(0.5, 1.0)) -> None:
    """Nodes, quadrilaterals and nodal scalars as an Exodus file; at each time the scalars times a factor."""
    quads, points = np.asarray(mesh.cells_dict[pyvista.CellType.QUAD]), np.asarray(mesh.points, dtype=float)
    fields = {"CPRESS": mesh.point_data["CPRESS"]}
    fields |= {f"U_{axis}": mesh.point_data["U"][:, k] for k, axis in enumerate("xyz")}
    sizes = {"len_string": 33, "num_dim": 3, "num_nodes": len(points), "num_elem": len(quads)}
    sizes |= {"num_el_blk": 1, "num_el_in_blk1": len(quads), "num_nod_per_el1": 4, "num_nod_var": len(fields)}
    with netcdf_file(path, "w", version=2) as file:
        attributes = {"title": b"made", "file_size": np.int32(1), "floating_point_word_size": np.int32(8)}
        for name, value in (attributes | dict.fromkeys(("api_version", "version"), np.float32(4.98))).items():
            setattr(file, name, value)
        file.createDimension("time_step", None)
        for name, size in sizes.items():
            file.createDimension(name, size)

        def variable(name: str, kind: str, *dimensions: str):
            return file.createVariable(name, kind, dimensions)

        time = variable("time_whole", "d", "time_step")
        variable("eb_status", "i", "num_el_blk")[:] = 1
        block = variable("eb_prop1", "i", "num_el_blk")
        block[:], block.name = 1, b"ID"
        for k, axis in enumerate("xyz"):
            variable(f"coord{axis}", "d", "num_nodes")[:] = points[:, k]
        cells = variable("connect1", "i", "num_el_in_blk1", "num_nod_per_el1")
        cells[:] = quads + 1
        setattr(cells, "elem_type", b"SHELL4")  # noqa: B010 - an attribute of the file
        names = variable("name_nod_var", "c", "num_nod_var", "len_string")
        values = [variable(f"vals_nod_var{k + 1}", "d", "time_step", "num_nodes") for k in range(len(fields))]
        for step, factor in enumerate(factors):
            time[step] = factor
            for k, (name, field) in enumerate(fields.items()):
                names[k] = np.frombuffer(name.encode().ljust(33, b"\0"), "S1")
                values[k][step] = np.asarray(field) * factor
