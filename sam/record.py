# SPDX-License-Identifier: MIT
"""From solved states to the result record: history, tables, scalar quantities, mesh. The same for every kind of scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.cell_row import Cut
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.friction import Coefficient
from sam.grid.cells import CellGrid, Window
from sam.half_space import equivalent_radius
from sam.loading import peak_force
from sam.planner.grids import pair_of
from sam.scene import FieldMesh, Scene
from sam.scene.residuals import Attempt
from sam.scene.result import CYCLES, HISTORY, LINE, QUANTITIES, STRESSES
from sam.scene.surface import Roughness
from sam.scene.yield_curve import DepthProfile
from sam.sliding import Sliding

if TYPE_CHECKING:
    from sam.coating import Coated

EVEN = DepthProfile()
REACHED = 1e-9  # of the peak load: rounding of a step to it
PERIMETER_SHARE = (np.pi - 1 + np.log(2)) / 24  # Yastrebov, Anciaux & Molinari 2017, Eq. 12


@dataclass(frozen=True)
class Snapshot:
    """A state that goes into the tables: "peak" or "unloaded", or "last" where the peak was not reached.

    contact: on the full grid; lift: residual displacement of the surface, (nx, ny) in m; stress: (6, nz, nx, rows) in Pa,
    strain: plastic, (6, nz, nx, rows), peeq: (nz, nx, rows), all in the rows of cells that touch y = 0; mises: von Mises stress
    of (nz, n) points in Pa, among which the largest is, None: in the plane y = 0; top: depth in m and value of the largest peeq
    anywhere, between the cells, None where nothing yields; sliding: None without friction; coated: None without coating; worn:
    depth in m, (nx, ny), None: nothing can wear; cut: see `sam.cut`, None: not at the peak, or the contact is in y = 0.
    """

    state: str
    contact: Contact
    lift: np.ndarray
    stress: np.ndarray
    strain: np.ndarray
    peeq: np.ndarray
    sliding: Sliding | None = None
    coated: Any = None
    mises: np.ndarray | None = None
    top: tuple[float, float] | None = None
    worn: np.ndarray | None = None
    cut: Cut | None = None

    @classmethod
    def elastic(
        cls,
        state: str,
        contact: Contact,
        stress: np.ndarray,
        mises: np.ndarray,
        sliding: Sliding | None = None,
        coated: Coated | None = None,
        cut: Cut | None = None,
    ) -> Snapshot:
        """A state without plastic strain."""
        zero = np.zeros_like(stress)
        lift = np.zeros(contact.gap.shape)
        return cls(state, contact, lift, stress, zero, zero[0], sliding, coated, mises, cut=cut)

    @property
    def friction(self) -> float:
        """Sum of q over sum of p; zero where either is."""
        if self.sliding is None or not self.contact.pressure.any():
            return 0.0
        return float(self.sliding.traction.sum() / self.contact.pressure.sum())

    @property
    def local_friction(self) -> np.ndarray:
        """|q|/p of each cell, (nx, ny); not a number out of contact."""
        p = self.contact.pressure
        if self.sliding is None:
            return np.where(p > 0, 0.0, np.nan)
        return np.divide(np.abs(self.sliding.traction), p, out=np.full(p.shape, np.nan), where=p > 0)

    @property
    def mises_at_depths(self) -> np.ndarray:
        """See mises, (nz, n)."""
        return von_mises(self.in_plane) if self.mises is None else self.mises

    @property
    def in_plane(self) -> np.ndarray:
        """Stress in y = 0, the mean of the rows, (6, nz, nx)."""
        return self.stress.mean(axis=-1)


@dataclass(frozen=True)
class Row:
    """One load step in the history. ending: of its contact, in words, if that did not converge."""

    cycle: int
    step: int
    force: float
    approach: float
    area: float
    p_max: float
    converged: bool
    iterations: int = 0
    residual: float = 0.0
    note: str = ""
    friction: float = 0.0
    protected: float | None = None
    peeq_max: float = 0.0
    attempts: tuple[Attempt, ...] = ()
    ending: str = ""


def row_of(
    scene: Scene,
    grid: CellGrid,
    cycle: int,
    step: int,
    force: float,
    contact: Contact,
    coefficient: Coefficient,
    iterations: int,
    residual: float,
    note: str,
    peeq_max: float = 0.0,
    attempts: tuple[Attempt, ...] = (),
) -> Row:
    """The row of a contact on the full grid, or on a box of it; coefficient: of friction, with the sign of the traction."""
    friction, protected, p = 0.0, None, contact.pressure
    if force:
        varies = np.ndim(coefficient) > 0
        friction = float((coefficient * p).sum() / p.sum()) if varies else float(coefficient)
        if scene.friction is not None and scene.friction.film:
            low = np.abs(coefficient) <= scene.friction.low
            protected = float(low[p > 0].mean())
    return Row(
        cycle, step, force, contact.approach, contact_area(contact, grid), largest_pressure(contact, grid),
        contact.converged, iterations, residual, note, friction, protected, peeq_max, attempts, contact.ending,
    )  # fmt: skip


def counted(contact: Contact, grid: CellGrid) -> Window:
    """The cells that count for maxima: all, but for the border of a grid that has one once the contact touches the edge."""
    touching, (bx, by) = contact.pressure > 0, grid.border
    if not (touching[[0, -1], :].any() or touching[:, [0, -1]].any()):
        bx = by = 0
    return Window(bx, by, grid.nx - 2 * bx, grid.ny - 2 * by)


def largest_pressure(contact: Contact, grid: CellGrid) -> float:
    """In Pa, over the cells that count."""
    return float(contact.pressure[counted(contact, grid).slices].max())


def contact_area(contact: Contact, grid: CellGrid) -> float:
    """Area in m^2 of the cells with p > 0, less the part of the outermost cells that is not in contact.

    A contact that ends by itself covers on average less than the whole of its outermost cells; each face between a cell
    in contact and one out of contact (not one beside the counter-body) takes off PERIMETER_SHARE of a cell.
    """
    if contact.area is not None:
        return contact.area
    touching, possible = contact.pressure > 0, np.isfinite(contact.gap)
    faces = 0
    for axis in (0, 1):
        t, q = np.moveaxis(touching, axis, 0), np.moveaxis(possible, axis, 0)
        faces += np.count_nonzero((t[1:] != t[:-1]) & q[1:] & q[:-1])
    return float((np.count_nonzero(touching) - PERIMETER_SHARE * faces) * grid.hx * grid.hy)


def history(rows: Sequence[Row], grid: CellGrid) -> dict[str, list]:
    """One row a load step."""
    values = [
        (
            row.cycle,
            row.step,
            row.force,
            row.approach,
            row.area,
            row.p_max,
            row.peeq_max,
            row.friction,
            row.iterations,
            row.residual,
            row.note,
        )
        for row in rows
    ]
    return {name: [value[k] for value in values] for k, name in enumerate(HISTORY)}


@dataclass(frozen=True)
class CycleEnd:
    """The surface after a cycle. wear_volume: of all cycles so far in m^3; roughness: without force, None if smooth.

    applications: of the residual-stress operator in all cycles so far.
    """

    cycle: int
    wear_volume: float
    roughness: Roughness | None
    applications: int


def cycles(
    scene: Scene, grid: CellGrid, rows: Sequence[Row], ends: Sequence[CycleEnd] = ()
) -> dict[str, list]:
    """One row for each cycle that came to its peak; volume and roughness at its end. What there is not (skewness) is None.

    ends: of an elastic body none, as its surface stays the same.
    """
    peaks: dict[int, Row] = {}
    for row in rows:
        if row.force >= peak_force(scene) * (1 - REACHED):
            peaks[row.cycle] = row
    same = dict.fromkeys(("wear_volume_m3", "sa_m", "sq_m"), 0.0) | {"operator_applications": 0}
    if scene.surface is not None:
        from sam.grid.rough import RoughPatch

        found = RoughPatch.of(scene.surface, scene.grid).roughness()
        same |= _heights_of(found)
    table = {name: [same.get(name)] * len(peaks) for name in CYCLES}
    table["cycle"] = list(peaks)
    table["friction_coefficient"] = [row.friction for row in peaks.values()]
    table["peeq_max"] = [row.peeq_max for row in peaks.values()]
    table["p_max_Pa"] = [row.p_max for row in peaks.values()]
    before = 0
    for end in ends:
        table["operator_applications"][end.cycle - 1], before = end.applications - before, end.applications
        table["wear_volume_m3"][end.cycle - 1] = end.wear_volume
        for name, value in (_heights_of(end.roughness) if end.roughness else {}).items():
            table[name][end.cycle - 1] = value
    table["protected_fraction"] = [row.protected for row in peaks.values()]
    return table


def _heights_of(found: Roughness) -> dict[str, float]:
    return {"sa_m": found.sa, "sq_m": found.sq, "ssk": found.ssk}


def refined_peak(z: np.ndarray, values: np.ndarray, profile: DepthProfile = EVEN) -> tuple[float, float]:
    """Depth and height of the maximum, refined by a parabola through three neighbours (any spacing).

    profile: of the yield stress of a body that yields; where that has a kink the stress has one, and no parabola goes across.
    """
    k = int(values.argmax())
    if k in (0, len(values) - 1) or np.ptp(profile.interval(z[k - 1 : k + 2])):
        return float(z[k]), float(values[k])
    c2, c1, c0 = np.polyfit(z[k - 1 : k + 2] - z[k], values[k - 1 : k + 2], 2)
    shift = -c1 / (2 * c2) if c2 < 0 else 0.0
    return float(z[k] + shift), float(c0 + c1 * shift + c2 * shift**2)


def largest_mises(z: np.ndarray, peak: Snapshot, profile: DepthProfile = EVEN) -> tuple[float, float]:
    """Depth and value of the largest von Mises stress, refined by a parabola over depth unless its cell has yielded.

    A cell that has is on the yield surface, which a parabola through it and its neighbours would pass.
    profile: as of `refined_peak`.
    """
    mises = peak.mises_at_depths
    k, column = np.unravel_index(mises.argmax(), mises.shape)
    if peak.mises is None and peak.peeq[k, column].any():
        return float(z[k]), float(mises[k, column])
    return refined_peak(z, mises[:, column], profile)


def tables(scene: Scene, grid: CellGrid, snapshots: Sequence[Snapshot]) -> dict[str, dict]:
    """axis, line and plane, the states one after the other; of a rough or worn body also surface, cut where there is one."""
    parts = [_tables_of(scene, grid, snapshot) for snapshot in snapshots]
    merged = {
        name: {column: np.concatenate([part[name][column] for part in parts]) for column in parts[0][name]}
        for name in parts[0]
    }
    for table in merged.values():
        table["state"] = table["state"].tolist()
    for snapshot in snapshots:
        if snapshot.cut is not None:
            from sam.cut import cut_table

            merged["cut"] = cut_table(snapshot.state, snapshot.cut)
    if scene.surface is not None:
        from sam.grid.rough import RoughPatch
        from sam.results.rough import surface_table

        heights = RoughPatch.of(scene.surface, scene.grid).heights()
        merged["surface"] = surface_table(heights, grid, snapshots)
    return merged


def _tables_of(scene: Scene, grid: CellGrid, snapshot: Snapshot) -> dict[str, dict]:
    """axis, line and plane of one state."""
    contact = snapshot.contact
    share = pair_of(scene).share  # of the body in the displacement
    rows = grid.axis_rows.slices[1]
    plane, peeq = snapshot.in_plane, snapshot.peeq.mean(axis=-1)
    axis = plane[:, :, grid.axis_columns].mean(axis=-1)
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    p = contact.pressure[:, rows].mean(axis=1)
    gap = np.where(np.isfinite(contact.gap), contact.gap, np.nan)  # NaN: no counter-body opposite
    if snapshot.coated is None:
        uz = share * contact.displacement[:, rows] + snapshot.lift[:, rows]
    else:
        uz = contact.displacement[:, rows] - snapshot.coated.counter_uz
    sliding, along_x = snapshot.sliding, {}
    if sliding is not None:
        uz = uz + sliding.uz
        along_x = {"ux_m": sliding.ux.mean(axis=1), "plastic_shear_m": sliding.shear.mean(axis=1)}
    line = {
        "x_m": grid.x,
        "p_Pa": p,
        "qx_Pa": np.zeros_like(p) if sliding is None else sliding.traction[:, rows].mean(axis=1),
        "gap_m": gap[:, rows].mean(axis=1),
        "uz_m": uz.mean(axis=1),
    } | along_x
    out = {
        "axis": {
            "z_m": grid.depths,
            "peeq": peeq[:, grid.axis_columns].mean(axis=-1),
            "mises_Pa": von_mises(axis),
            **dict(zip(STRESSES, axis, strict=True)),
        },
        "line": {name: line.get(name, np.full_like(p, np.nan)) for name in LINE if name != "state"},
        "plane": {
            "x_m": x.ravel(),
            "z_m": z.ravel(),
            "peeq": peeq.T.ravel(),
            "mises_Pa": von_mises(plane).T.ravel(),
        },
    }
    return {name: {"state": [snapshot.state] * len(next(iter(t.values())))} | t for name, t in out.items()}


def fields(grid: CellGrid, snapshot: Snapshot, height: np.ndarray | None = None) -> FieldMesh:
    """The surface and the plane y = 0 as one mesh: stress and strain at the nodes of the plane, pressure in the cells of the
    surface, with friction also the traction and the local coefficient, of a rough body its heights, (nx, ny) in m."""
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    surface = np.stack([*np.meshgrid(xs, ys, indexing="ij"), np.zeros((len(xs), len(ys)))], axis=-1).reshape(
        -1, 3
    )
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    plane = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)

    def quads(n: int, m: int, first: int) -> np.ndarray:
        node = first + np.arange(n * m).reshape(n, m)
        return np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)

    def on_plane(field: np.ndarray) -> np.ndarray:
        """(..., nz, nx, rows) as (nodes, ...), not a number on the surface."""
        values = np.moveaxis(field.mean(axis=-1).swapaxes(-1, -2), (-2, -1), (0, 1))
        values = values.reshape(-1, *values.shape[2:])
        return np.concatenate([np.full((len(surface), *values.shape[1:]), np.nan), values])

    def on_surface(field: np.ndarray) -> np.ndarray:
        """(nx, ny) as (cells,), not a number in the plane."""
        return np.append(field.ravel(), np.full(len(cells) - field.size, np.nan))

    cells = np.vstack([quads(len(xs), len(ys), 0), quads(*x.shape, len(surface))])
    on_cells = {"p_Pa": snapshot.contact.pressure}
    if snapshot.sliding is not None:
        on_cells |= {"qx_Pa": snapshot.sliding.traction, "friction": snapshot.local_friction}
    if height is not None:
        on_cells["height_m"] = height
    if snapshot.worn is not None:
        on_cells["worn_m"] = snapshot.worn
    return FieldMesh(
        points=np.vstack([surface, plane]),
        cells={"quad": cells},
        point_data={
            "stress_Pa": on_plane(snapshot.stress),
            "mises_Pa": on_plane(von_mises(snapshot.in_plane)[..., None]),
            "plastic_strain": on_plane(snapshot.strain),
            "peeq": on_plane(snapshot.peeq),
        },
        cell_data={name: on_surface(field) for name, field in on_cells.items()},
    )


def centroid(x: np.ndarray, weight: np.ndarray) -> float | None:
    """Mean of x with these weights; None where all are zero."""
    return float(x @ weight / weight.sum()) if weight.any() else None


def quantities(
    grid: CellGrid,
    peak: Snapshot,
    unloaded: Snapshot | None,
    wear_volume: float = 0.0,
    profile: DepthProfile = EVEN,
    rough: bool = False,
) -> dict[str, float | None]:
    """Every name of QUANTITIES; wear_volume: of all cycles in m^3; profile: see `refined_peak`; rough: has no centre."""
    contact, rows = peak.contact, grid.axis_rows.slices[1]
    mises, (place, top) = peak.mises_at_depths, peak.top or (None, 0.0)
    depth, largest = largest_mises(grid.depths, peak, profile)
    area = contact_area(contact, grid)
    values = {
        "force_N": float(contact.pressure.sum() * grid.hx * grid.hy),
        "approach_m": None if np.isnan(contact.approach) else contact.approach,
        "contact_area_m2": area,
        "contact_radius_m": equivalent_radius(area),
        "p_max_Pa": largest_pressure(contact, grid),
        "p_center_Pa": None if rough else float(contact.pressure[grid.axis_columns, rows].mean()),
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "peeq_max": top,
        "peeq_max_depth_m": place,
        "friction_coefficient": peak.friction,
        "pressure_centroid_x_m": centroid(grid.x, contact.pressure.sum(axis=1)),
        "wear_volume_m3": wear_volume,
    }
    if peak.sliding is not None:
        values["tangential_displacement_center_m"] = float(peak.sliding.ux[grid.axis_columns].mean())
    if peak.coated is not None:
        from sam.coated_record import coated_quantities

        values |= coated_quantities(grid.depths, mises, values["p_max_Pa"], peak.coated)
    if unloaded is not None:
        values["residual_uz_center_m"] = float(unloaded.lift[grid.axis_columns, rows].mean())
        if unloaded.sliding is not None:
            values["residual_ux_center_m"] = float(unloaded.sliding.residual_ux[grid.axis_columns].mean())
            values["plastic_shear_center_m"] = float(unloaded.sliding.shear[grid.axis_columns].mean())
        values["residual_mises_max_Pa"] = float(von_mises(unloaded.in_plane).max())
    return {name: values.get(name) for name in QUANTITIES}
