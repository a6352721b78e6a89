# SPDX-License-Identifier: MIT
"""Shipped scenes with fewer load steps, cells and elements, and what VTK reads of their meshes."""

from collections.abc import Iterator
from pathlib import Path

import meshio
import numpy as np
import pyvista

from sam.scene import Scene, read_scene
from verification.runs import models
from verification.runs.files import Run

SCENES = Path(__file__).resolve().parents[1] / "verification" / "scenes"
STATES = {"peak": "", "unloaded": "-unloaded"}
NEAR = 1e-9  # of the largest value: what the digits of the files leave, measured 0 at equal places


def reduced(path: Path) -> Scene:
    """A shipped scene in two steps, two cycles, on at most 33 cells where it is smooth, and few elements."""
    scene = read_scene(path)[0]
    loading, grid = scene.loading, scene.grid
    fewer = {"steps": min(loading.steps, 2), "cycles": min(loading.cycles, 2)}
    fewer |= {"unload_steps": 2} if loading.unload_steps else {}
    changes = {
        "loading": loading.model_copy(update=fewer),
        "fem": scene.fem.model_copy(update={"cells_per_radius": 4, "box": 5.0}),
    }
    if scene.surface is None and grid is not None and grid.cells is not None:
        cells = tuple(min(count, 32 + count % 2) for count in grid.cells)
        changes["grid"] = grid.model_copy(update={"cells": cells})
    return scene.model_copy(update=changes)


def wrong(run: Run) -> list[str]:
    """What is wrong with the meshes of a run, in words."""
    found = [*wrong_list(run.folder), *wrong_values(run.folder), *wrong_stress(run), *wrong_line(run)]
    return [*found, *wrong_mises(run)]


def wrong_list(folder: Path) -> Iterator[str]:
    """Files that run.pvd does not list, or not in the order of time."""
    steps = pyvista.PVDReader(folder / "run.pvd")
    times = [each.time for each in steps.datasets]
    if times != sorted(times):
        yield f"run.pvd: {times}"
    listed = {each.path for each in steps.datasets}
    on_disk = {path.name for path in folder.iterdir() if path.suffix in (".vtu", ".vtr")}
    if listed != on_disk:
        yield f"run.pvd: {sorted(listed ^ on_disk)}"


def wrong_values(folder: Path) -> Iterator[str]:
    """Values that are no numbers, and meshes that meshio reads otherwise than VTK."""
    for path in sorted(folder.glob("*.vt[ur]")):
        mesh = pyvista.read(path)
        if path.suffix == ".vtu" and not same_in_meshio(path, mesh):
            yield f"{path.name}: another mesh for meshio"
        for name, values in (*mesh.point_data.items(), *mesh.cell_data.items()):
            if not np.isfinite(values).all():
                yield f"{path.name}: {name} is not finite"


def same_in_meshio(path: Path, mesh: pyvista.UnstructuredGrid) -> bool:
    """Whether nodes, numbers of cells and fields are the same, bit by bit."""
    other = meshio.read(path)
    fields = other.point_data | {name: np.concatenate(values) for name, values in other.cell_data.items()}
    return (
        np.array_equal(other.points, mesh.points)
        and sum(len(block.data) for block in other.cells) == mesh.n_cells
        and fields.keys() == set(mesh.array_names)
        and all(np.array_equal(values, mesh[name], equal_nan=True) for name, values in fields.items())
    )


def compared_stress(run: Run) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """File, principal stresses of VTK and of axis.csv, (n, 3) each, at the places under the origin that both
    have.
    """
    for part in ("fields.vtu", "body.vtr"):
        for state, ending in STATES.items():
            path = run.folder / part.replace(".", f"{ending}.")
            if not path.exists():
                continue
            mesh, table = pyvista.read(path), run.tables["axis"]
            at_points = "stress_Pa" in mesh.point_data
            places = mesh.points if at_points else mesh.cell_centers().points
            table = table[table["state"] == state]
            stresses = by_name(mesh)
            under = np.hypot(places[:, 0], places[:, 1]) < NEAR * np.ptp(places[:, 0])
            depths, rows = -places[under, 2], table["z_m"].to_numpy()
            both = [
                (i, j) for i, z in enumerate(depths) for j in np.flatnonzero(np.isclose(rows, z, 1e-9, 0))
            ]
            ours, theirs = (
                (np.array(each, dtype=int) for each in zip(*both, strict=True)) if both else ([], [])
            )
            yield (
                path.name,
                principal({name: values[under][ours] for name, values in stresses.items()}),
                principal({name: table[f"s{name}_Pa"].to_numpy()[theirs] for name in stresses}),
            )


def principal(s: dict[str, np.ndarray]) -> np.ndarray:
    """Principal stresses, (n, 3), smallest first, of components by their names."""
    rows = ("xx", "xy", "xz"), ("xy", "yy", "yz"), ("xz", "yz", "zz")
    tensor = np.stack([np.stack([s[name] for name in row], -1) for row in rows], -1)
    return np.linalg.eigvalsh(tensor)


def wrong_stress(run: Run) -> Iterator[str]:
    """Principal stresses that are not those of axis.csv."""
    for name, found, expected in compared_stress(run):
        if len(found) and np.abs(found - expected).max() > NEAR * np.abs(expected).max():
            yield f"{name}: principal stresses"


def wrong_mises(run: Run) -> Iterator[str]:
    """Von Mises stresses of SAM's plane that are not those of plane.csv."""
    for state, ending in STATES.items():
        path, table = run.folder / f"fields{ending}.vtu", run.tables["plane"]
        if run.summary["model"] != models.SAM or not path.exists():
            continue
        mesh, table = pyvista.read(path), table[table["state"] == state]
        expected = table.sort_values(["z_m", "x_m"], kind="stable")
        order = np.lexsort((mesh.points[:, 0], -mesh.points[:, 2]))
        one, two, three = principal(by_name(mesh)).T
        mises = np.sqrt(0.5 * ((one - two) ** 2 + (two - three) ** 2 + (three - one) ** 2))[order]
        if not np.allclose(mises, expected["mises_Pa"], rtol=0, atol=NEAR * mises.max()):
            yield f"{path.name}: von Mises stress"


def by_name(mesh: pyvista.DataSet) -> dict[str, np.ndarray]:
    """The stresses of a mesh by the names that VTK reads, in lower case."""
    at_points = "stress_Pa" in mesh.point_data
    array = (mesh.GetPointData() if at_points else mesh.GetCellData()).GetArray("stress_Pa")
    names = [array.GetComponentName(k).lower() for k in range(6)]
    return dict(zip(names, np.asarray(mesh["stress_Pa"]).T, strict=True))


def wrong_line(run: Run) -> Iterator[str]:
    """Displacements of the surface that are not those of line.csv, or at other places."""
    for state, ending in STATES.items():
        path, table = run.folder / f"surface{ending}.vtr", run.tables["line"]
        if not path.exists():
            continue
        mesh, table = pyvista.read(path), table[table["state"] == state]
        expected = table["uz_m"].to_numpy()
        if not {"uz_m", "displacement_m"} & set(mesh.array_names):
            continue  # a rough elastic body: its surface tells its gap in their place
        places, moved = mesh.cell_centers().points, mesh.cell_data.get("uz_m")
        if moved is None:
            places, moved = mesh.points, -np.asarray(mesh.point_data["displacement_m"])[:, 2]
        row = np.abs(places[:, 1])
        row = np.isclose(row, row.min(), rtol=0, atol=NEAR * np.ptp(places[:, 0]))
        near = np.abs(places[:, 0] - table["x_m"].to_numpy()[:, None]) < NEAR * np.ptp(places[:, 0])
        counts = (near & row).sum(axis=1)
        if not counts.all():
            yield f"{path.name}: other places than line.csv"
            continue
        found = (near & row) @ np.asarray(moved) / counts
        if np.abs(found - expected).max() > NEAR * np.abs(expected).max():
            yield f"{path.name}: displacement"
