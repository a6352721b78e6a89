# SPDX-License-Identifier: MIT
"""From the solved fields of an elastic scene to the result record: history, tables, scalar quantities, mesh."""

from __future__ import annotations

import numpy as np

from sam.contact import Contact
from sam.grid import CellGrid, contact_modulus, equivalent_radius, gap_of
from sam.scene import FieldMesh, Scene
from sam.scene.result import CYCLES, HISTORY, QUANTITIES, STRESSES
from sam.stress import von_mises

PERIMETER_SHARE = (np.pi - 1 + np.log(2)) / 24  # Yastrebov, Anciaux & Molinari 2017, Eq. 12
ELASTIC_UNLOADING = "elastic: unloading in one step"
ELASTIC_CYCLE = "elastic: equal to cycle 1"


def contact_area(contact: Contact, grid: CellGrid) -> float:
    """Area in m^2 of the cells with p > 0, less the part of the outermost cells that is not in contact.

    A contact that ends by itself covers on average less than the whole of its outermost cells; each face between a
    cell in contact and one out of contact (not one beside the counter-body) takes off PERIMETER_SHARE of a cell.
    """
    touching, possible = contact.pressure > 0, np.isfinite(contact.gap)
    faces = 0
    for axis in (0, 1):
        t, q = np.moveaxis(touching, axis, 0), np.moveaxis(possible, axis, 0)
        faces += np.count_nonzero((t[1:] != t[:-1]) & q[1:] & q[:-1])
    return float((np.count_nonzero(touching) - PERIMETER_SHARE * faces) * grid.hx * grid.hy)


def history(scene: Scene, peaks: list[Contact], grid: CellGrid) -> dict[str, list]:
    """One row a load step; unloading is one step to zero force, and later cycles repeat the first."""
    loading = scene.loading
    rows = []
    for k, contact in enumerate(peaks, start=1):
        force = loading.force * k / loading.steps
        p_max = float(contact.pressure.max())
        area = contact_area(contact, grid)
        rows.append([1, k, force, contact.approach, area, p_max, 0.0, 0.0, contact.iterations, contact.residual, ""])
    if loading.unload:
        rows.append([1, len(peaks) + 1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0.0, ELASTIC_UNLOADING])
    first = list(rows)
    for cycle in range(2, loading.cycles + 1):
        rows += [[cycle, *row[1:8], 0, row[9], ELASTIC_CYCLE] for row in first]
    return {name: list(column) for name, column in zip(HISTORY, zip(*rows, strict=True), strict=True)}


def _refined_peak(z: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Depth and height of the maximum, refined by a parabola through three neighbours (any spacing)."""
    k = int(values.argmax())
    if k in (0, len(values) - 1):
        return float(z[k]), float(values[k])
    c2, c1, c0 = np.polyfit(z[k - 1 : k + 2] - z[k], values[k - 1 : k + 2], 2)
    shift = -c1 / (2 * c2) if c2 < 0 else 0.0
    return float(z[k] + shift), float(c0 + c1 * shift + c2 * shift**2)


def cycles(scene: Scene, contact: Contact) -> dict[str, list]:
    """One row a cycle of an elastic, smooth, frictionless scene: all equal; what a plane has not (skewness) is None."""
    row = dict.fromkeys(("wear_volume_m3", "friction_coefficient", "sa_m", "sq_m", "peeq_max"), 0.0)
    row["p_max_Pa"] = float(contact.pressure.max())
    number = range(1, scene.loading.cycles + 1)
    return {name: list(number) if name == "cycle" else [row.get(name)] * len(number) for name in CYCLES}


def tables(scene: Scene, grid: CellGrid, contact: Contact, stress: np.ndarray) -> dict[str, dict]:
    """axis, line and plane at peak load, and at zero force when the scene unloads (all zero: the scene is elastic).

    stress: (6, nz, nx, rows) in the plane y = 0 (the rows that touch it).
    """
    share = (1 - scene.body.poisson**2) / scene.body.young * contact_modulus(scene)  # of the body in the displacement
    rows = grid.axis_rows.slices[1]
    plane = stress.mean(axis=-1)
    mises = von_mises(plane)
    axis = plane[:, :, grid.axis_columns].mean(axis=-1)
    p = contact.pressure[:, rows].mean(axis=1)
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    out = {
        "axis": {"z_m": grid.depths, "peeq": np.zeros_like(grid.depths), "mises_Pa": von_mises(axis)}
        | dict(zip(STRESSES, axis, strict=True)),
        "line": {
            "x_m": grid.x,
            "p_Pa": p,
            "qx_Pa": np.zeros_like(p),
            "gap_m": _where_opposed(contact.gap)[:, rows].mean(axis=1),
            "uz_m": share * contact.displacement[:, rows].mean(axis=1),
        },
        "plane": {"x_m": x.ravel(), "z_m": z.ravel(), "peeq": np.zeros(x.size), "mises_Pa": mises.T.ravel()},
    }
    unloaded_gap = _where_opposed(gap_of(scene, grid))[:, rows].mean(axis=1)
    for name, table in out.items():
        n = len(next(iter(table.values())))
        states = ["peak"] * n
        if scene.loading.unload:
            zero = {key: value if key in ("x_m", "z_m") else np.zeros_like(value) for key, value in table.items()}
            if name == "line":
                zero["gap_m"] = unloaded_gap
            table = {key: np.concatenate([value, zero[key]]) for key, value in table.items()}
            states += ["unloaded"] * n
        out[name] = {"state": states} | table
    return out


def _where_opposed(gap: np.ndarray) -> np.ndarray:
    """The gap, NaN (an empty cell in the files) where there is no counter-body opposite."""
    return np.where(np.isfinite(gap), gap, np.nan)


def fields(grid: CellGrid, contact: Contact, stress: np.ndarray) -> FieldMesh:
    """The surface (pressure, a quadrilateral a cell) and the plane y = 0 (stresses at the nodes), as one mesh."""
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    surface = np.stack([*np.meshgrid(xs, ys, indexing="ij"), np.zeros((len(xs), len(ys)))], axis=-1).reshape(-1, 3)
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    plane = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)

    def quads(n: int, m: int, first: int) -> np.ndarray:
        node = first + np.arange(n * m).reshape(n, m)
        return np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)

    cells = np.vstack([quads(len(xs), len(ys), 0), quads(*x.shape, len(surface))])
    in_plane = stress.mean(axis=-1).transpose(2, 1, 0).reshape(-1, 6)
    blank = np.full((len(surface), 6), np.nan)
    pressure = np.append(contact.pressure.ravel(), np.full(len(cells) - contact.pressure.size, np.nan))
    return FieldMesh(
        points=np.vstack([surface, plane]),
        cells={"quad": cells},
        point_data={
            "stress_Pa": np.vstack([blank, in_plane]),
            "mises_Pa": np.append(blank[:, 0], von_mises(in_plane.T)),
        },
        cell_data={"p_Pa": pressure},
    )


def quantities(scene: Scene, grid: CellGrid, contact: Contact, stress: np.ndarray) -> dict[str, float | None]:
    mises = von_mises(stress.mean(axis=-1))  # (nz, nx)
    column = int(mises.max(axis=0).argmax())
    depth, largest = _refined_peak(grid.depths, mises[:, column])
    rows = grid.axis_rows.slices[1]
    area = contact_area(contact, grid)
    unloaded = 0.0 if scene.loading.unload else None
    values = {
        "force_N": float(contact.pressure.sum() * grid.hx * grid.hy),
        "approach_m": contact.approach,
        "contact_area_m2": area,
        "contact_radius_m": equivalent_radius(area),
        "p_max_Pa": float(contact.pressure.max()),
        "p_center_Pa": float(contact.pressure[grid.axis_columns, rows].mean()),
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "residual_uz_center_m": unloaded,
        "residual_mises_max_Pa": unloaded,
        "peeq_max": 0.0,
        "friction_coefficient": 0.0,
        "wear_volume_m3": 0.0,
    }
    return {name: values.get(name) for name in QUANTITIES}
