# SPDX-License-Identifier: MIT
"""What the result says of solved states: the tables axis, line, plane and cut, the fields on the surface, in
the plane y = 0 and in the box of plastic cells, the scalar results at the peak load and after it, what the
record of a rough scene has besides, and what to change when a solve ends badly.

Richardson's extrapolation takes two grids, one with twice the cells of the other. The errors of maxima,
depths and displacements fall with the square of the cell once it is small: not smoothly where the edge of a
contact or of a plastic zone falls between cells. Of two values q_c (coarse) and q_f (fine, r times as many
cells) the extrapolated one is q_f + (q_f - q_c)/(r^2 - 1) (Richardson 1911). The coarse solution costs a
tenth to a half of the fine one. Their difference, recorded with each quantity, tells how good the fine value
is by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.contact.normal import Contact, fewest_in_spot
from sam.contact.operators import von_mises
from sam.grid.cells import CellGrid, at_edge
from sam.grid.demands import RoughPatch
from sam.half_space import equivalent_radius
from sam.results.history import Box, Coated, Cut, CycleEnd, Snapshot, contact_area, largest_pressure
from sam.scene import FieldMesh, GridFields, LeftOut, Result, Status
from sam.scene.remedies import either
from sam.scene.result import COUNTER_HEIGHT, CUT, EXCEEDING, LINE, QUANTITIES, STRAINED, STRESSES, SURFACE
from sam.scene.surface import border_cells, roughness_as_read
from sam.scene.yield_curve import Kinks


@dataclass(frozen=True)
class Remedies:
    """What may be changed of a scene, in words; empty what may not. slower: less friction."""

    finer_cells: str
    smaller_patch: str
    larger_patch: str
    less_load: str
    slower: str
    more_steps: str
    looser: str


def advice(remedies: Remedies, status: Status, larger: str = "") -> str:
    """What to change, in words; empty for a converged solve; larger: how to enlarge the sides of the grid."""
    can = remedies
    match status:
        case Status.NOT_CONVERGED:
            what = either(can.finer_cells, can.looser, can.slower)
            return f"the contact iteration stopped above its tolerance: {what}"
        case Status.CONTACT_AT_GRID_EDGE:
            what = either(larger or can.larger_patch, can.less_load)
            return f"the contact touches the edge of the grid: {what}"
        case Status.UNDER_RESOLVED:
            return f"too few cells in the contact: {either(can.finer_cells, can.smaller_patch)}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            return f"the plastic zone touches the edge of the grid: {either(larger, can.less_load)}"
        case Status.STEP_CUT_LIMIT:
            what = either(can.more_steps, can.looser, can.less_load)
            return f"a load step did not converge however often it was halved: {what}"
    return status.advice


Table = dict[str, Any]


def state_tables(grid: CellGrid, snapshots: Sequence[Snapshot], share: float) -> dict[str, Table]:
    """The tables axis, line and plane, and cut where a state has one; share: see `ElasticPair.share`."""
    parts = [_tables_of(grid, snapshot, share) for snapshot in snapshots]
    merged: dict[str, Table] = {
        name: {column: np.concatenate([part[name][column] for part in parts]) for column in parts[0][name]}
        for name in parts[0]
    }
    for table in merged.values():
        table["state"] = table["state"].tolist()
    for snapshot in snapshots:
        if snapshot.cut is not None:
            merged["cut"] = _cut_table(snapshot.state, snapshot.cut)
    return merged


def _tables_of(grid: CellGrid, snapshot: Snapshot, share: float) -> dict[str, Table]:
    """The tables of one state."""
    rows = grid.axis_rows.slices[1]
    plane, peeq = snapshot.in_plane, snapshot.peeq.mean(axis=-1)
    axis = plane[:, :, grid.axis_columns].mean(axis=-1)
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    out: dict[str, Table] = {
        "axis": {
            "z_m": grid.depths,
            "peeq": peeq[:, grid.axis_columns].mean(axis=-1),
            "mises_Pa": von_mises(axis),
            **dict(zip(STRESSES, axis, strict=True)),
        },
        "line": _line(grid, snapshot, share, rows),
        "plane": {
            "x_m": x.ravel(),
            "z_m": z.ravel(),
            "peeq": peeq.T.ravel(),
            "mises_Pa": von_mises(plane).T.ravel(),
        },
    }
    return {name: {"state": [snapshot.state] * len(next(iter(t.values())))} | t for name, t in out.items()}


def _line(grid: CellGrid, snapshot: Snapshot, share: float, rows: slice) -> Table:
    """The surface along x in y = 0, the mean of the rows of cells that touch it."""
    contact, sliding = snapshot.contact, snapshot.sliding
    p = contact.pressure[:, rows].mean(axis=1)
    gap = np.where(np.isfinite(contact.gap), contact.gap, np.nan)  # NaN: no counter-body opposite
    if snapshot.coated is None:
        uz = share * contact.displacement[:, rows] + snapshot.residual_displacement[:, rows]
    else:
        uz = contact.displacement[:, rows] - snapshot.coated.counter_uz
    along_x = {}
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
    return {name: line.get(name, np.full_like(p, np.nan)) for name in LINE if name != "state"}


def _cut_table(state: str, cut: Cut) -> Table:
    """The table cut: a row a point, z running first."""
    x, z = np.meshgrid(cut.x, cut.z, indexing="ij")
    columns: Table = {
        "state": [state] * x.size,
        "x_m": x.ravel(),
        "y_m": np.full(x.size, cut.y),
        "z_m": z.ravel(),
        "peeq": cut.peeq.T.ravel(),
        "mises_Pa": von_mises(cut.stress).T.ravel(),
        **{name: component.T.ravel() for name, component in zip(STRESSES, cut.stress, strict=True)},
    }
    return {name: columns[name] for name in CUT}


def field_mesh(grid: CellGrid, snapshot: Snapshot, height: Array | None = None) -> FieldMesh:
    """The mesh of a state: stress and strain in the plane, pressure in the cells of the surface."""
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    surface = np.stack([*np.meshgrid(xs, ys, indexing="ij"), np.zeros((len(xs), len(ys)))], axis=-1).reshape(
        -1, 3
    )
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    plane = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)

    def quads(n: int, m: int, first: int) -> NDArray[np.int_]:
        """Node numbers of n - 1 x m - 1 quadrilaterals."""
        node = first + np.arange(n * m).reshape(n, m)
        return np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)

    def on_plane(field: Array) -> Array:
        """(..., nz, nx, rows) as (nodes, ...), not a number on the surface."""
        values = np.moveaxis(field.mean(axis=-1).swapaxes(-1, -2), (-2, -1), (0, 1))
        values = values.reshape(-1, *values.shape[2:])
        return np.concatenate([np.full((len(surface), *values.shape[1:]), np.nan), values])

    def on_surface(field: Array) -> Array:
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
            **{name: on_plane(field) for name, field in snapshot.repeated.items()},
        },
        cell_data={name: on_surface(field) for name, field in on_cells.items()},
    )


def state_grids(
    grid: CellGrid, snapshot: Snapshot, share: float, height: Array | None = None
) -> dict[str, GridFields]:
    """The fields of a state: on the "surface", in the "plane" and, of one that yields, in the "body"."""
    strained = {"plastic_strain": snapshot.strain, "peeq": snapshot.peeq} if snapshot.box else {}
    means = {"stress_Pa": snapshot.stress, **strained, **snapshot.repeated}
    in_plane = {name: field.mean(axis=-1) for name, field in means.items()}
    in_plane["mises_Pa"] = von_mises(snapshot.in_plane)
    points = {name: field.swapaxes(-1, -2)[..., None, :] for name, field in in_plane.items()}
    parts = {
        "surface": _surface(grid, snapshot, share, height),
        "plane": GridFields(grid.x, np.zeros(1), grid.depths, points),
    }
    if (box := snapshot.box) is not None:
        fields = {
            "stress_Pa": box.stress,
            "mises_Pa": von_mises(box.stress),
            "plastic_strain": box.strain,
            "peeq": box.peeq,
            **box.repeated,
        }
        cells = {name: np.moveaxis(field, -3, -1) for name, field in fields.items()}
        parts["body"] = GridFields(box.x, box.y, box.z, cell_data=cells)
    return parts


def cycle_grids(
    grid: CellGrid, ends: Sequence[CycleEnd], height: Array | None = None
) -> dict[str, dict[str, GridFields]]:
    """The unloaded surface after each cycle that can wear it, as "cycle-1" and so on."""
    return {
        f"cycle-{end.cycle}": {
            "surface": _on_cells(grid, {"uz_m": end.moved, "worn_m": end.worn, "height_m": height})
        }
        for end in ends
        if end.moved is not None
    }


def _surface(grid: CellGrid, snapshot: Snapshot, share: float, height: Array | None) -> GridFields:
    """The cells of the surface; friction is zero out of contact, a gap that is not everywhere is left out."""
    contact, sliding, coated = snapshot.contact, snapshot.sliding, snapshot.coated
    cells: dict[str, Array | None] = {"p_Pa": contact.pressure, "height_m": height, "worn_m": snapshot.worn}
    if np.isfinite(contact.gap).all():
        cells["gap_m"] = contact.gap
    if sliding is not None:
        cells |= {"qx_Pa": sliding.traction, "friction": np.nan_to_num(snapshot.local_friction)}
    beyond = [sliding.uz] if sliding is not None else []
    beyond += [coated.counter_uz] if coated is not None else []
    if not any(moved.any() for moved in beyond):  # those are known along y = 0 alone
        whole = 1.0 if coated is not None else share
        cells["uz_m"] = whole * contact.displacement + snapshot.residual_displacement
    return _on_cells(grid, cells)


def _on_cells(grid: CellGrid, cells: Mapping[str, Array | None]) -> GridFields:
    """Fields (nx, ny) of the surface but for None; displacements at nodes as means of the cells."""
    points, moved = {}, cells.get("uz_m")
    if moved is not None:
        around = np.pad(moved, 1, mode="edge")
        uz = (around[1:, 1:] + around[1:, :-1] + around[:-1, 1:] + around[:-1, :-1]) / 4
        points["normal_displacement_m"] = np.stack([0 * uz, 0 * uz, uz])[..., None]
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    known = {name: field[..., None] for name, field in cells.items() if field is not None}
    return GridFields(xs, ys, np.zeros(1), points, known)


LEAST_SHARE = 0.05  # of the load: a spot that carries as much has to be resolved
WELL_RESOLVED = 4.0  # cells in the shortest wavelength; below it maxima depend on where the cells lie


def rough_discretisation(patch: RoughPatch) -> dict[str, object]:
    """Roughness before the first load; of a file also as it was read, before form and gaps."""
    out: dict[str, object] = {"roughness": asdict(patch.roughness())}
    for surface, suffix in ((patch.surface, ""), (patch.counter, "_of_counterbody")):
        if surface is not None and surface.kind == "file":
            out[f"roughness_as_read{suffix}"] = asdict(roughness_as_read(surface))
    return out


def surface_table(patch: RoughPatch, grid: CellGrid, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
    """The table surface: a row a cell for each state, y running first; counter-body heights last."""
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    parts = [
        {
            "state": np.full(x.size, each.state),
            "x_m": x.ravel(),
            "y_m": y.ravel(),
            "height_m": patch.of_body.ravel(),
            "p_Pa": each.contact.pressure.ravel(),
            "worn_m": np.zeros(x.size) if each.worn is None else each.worn.ravel(),
            "friction": each.local_friction.ravel(),
        }
        for each in snapshots
    ]
    table = {name: np.concatenate([part[name] for part in parts]) for name in SURFACE}
    if patch.opposite is not None:
        table[COUNTER_HEIGHT] = np.concatenate(
            [patch.opposite(each.stretch, each.place).ravel() for each in snapshots]
        )
    return table | {"state": table["state"].tolist()}


def rough_quantities(grid: CellGrid, contact: Contact) -> dict[str, float | None]:
    """Contact spots, which join at the sides of cells and may be cut by the edge of the patch; the share
    of the patch in contact; the mean of the gap over the patch.
    """
    mean = float(contact.gap.mean())
    return {
        "contact_spots": float(spots_of(contact.pressure, grid.wraps).max()),
        "contact_share": contact_area(contact, grid) / (grid.nx * grid.hx * grid.ny * grid.hy),
        "mean_gap_m": mean if np.isfinite(mean) else None,
    }


def rough_warnings(
    patch: RoughPatch, remedies: Remedies, grid: CellGrid, contact: Contact
) -> tuple[str, ...]:
    """What a user should know about the peak, in words."""
    out, touching, finer = [], contact.pressure > 0, remedies.finer_cells
    finer = f": {finer}" if finer else ""
    for surface in (patch.surface, patch.counter):
        if surface is None or surface.kind == "file":
            continue
        cells = [s / h for s, h in zip(surface.shortest, (grid.hx, grid.hy), strict=True)]
        if min(cells) < WELL_RESOLVED * (1 - 1e-6):
            out.append(
                f"{min(cells):.3g} cells in the shortest wavelength of the {surface.words}: with "
                f"fewer than {WELL_RESOLVED:g} the largest pressure depends on where the cells lie{finer}"
            )
    if coarse := too_few_cells(contact.pressure, grid.wraps):
        out.append(f"{coarse}{finer}")
    if patch.relief and (made := in_the_fall_off(contact.pressure)):
        out.append("; ".join(filter(None, (made, remedies.larger_patch))))
    for surface in (patch.surface, patch.counter):
        if surface is not None and surface.taper is not None:
            changed, sq = patch.changed_by_taper(surface)
            out.append(
                f"{surface.table}.taper = {surface.taper:g}: so that they repeat, heights are changed by "
                f"{changed:.4g} m (rms), {100 * changed / sq:.3g} % of their rms deviation"
            )
    if not grid.periodic and at_edge(touching, grid.line):
        words, (bx, by) = (
            "the contact touches the edge of the grid, where the half-space is cut",
            grid.border,
        )
        if any(grid.border):
            words += f": the outer {bx} x {by} cells do not count for p_max_Pa and mises_max_Pa; "
            words += 'grid.border = "relief" lets the heights fall off'
        else:  # the heights fall off already, and all cells count
            can = either(remedies.larger_patch, remedies.less_load)
            words += f' although the heights fall off there (grid.border = "relief"): {can}'
        out.append(words)
    return tuple(out)


def spots_of(pressure: Array, wraps: tuple[bool, bool]) -> NDArray[np.intp]:
    """The number of the spot of each cell (nx, ny), joined at their sides, 0 beside them; wraps: also across
    the border along x and along y.
    """
    from scipy import ndimage  # noqa: PLC0415 - for rough scenes alone

    spots, count = ndimage.label(pressure > 0)
    if not any(wraps):
        return np.asarray(spots)
    from scipy import sparse  # noqa: PLC0415

    borders = [[spots.take(0, axis), spots.take(-1, axis)] for axis in (0, 1) if wraps[axis]]
    ends = np.concatenate(borders, axis=1)
    ends = ends[:, (ends > 0).all(axis=0)]
    pairs = sparse.coo_matrix((np.ones(ends.shape[1]), tuple(ends)), shape=(count + 1, count + 1))
    return np.asarray(sparse.csgraph.connected_components(pairs, directed=False)[1][spots])


def too_few_cells(pressure: Array, wraps: tuple[bool, bool] = (False, False)) -> str:
    """What to know about spots (nx, ny) in Pa that few cells resolve, joined at their sides."""
    spots = spots_of(pressure, wraps)
    if not spots.any():
        return ""
    cells = np.bincount(spots.ravel())[1:]
    share = np.bincount(spots.ravel(), pressure.ravel())[1:] / pressure.sum()
    judged = share >= LEAST_SHARE
    judged[spots[np.unravel_index(pressure.argmax(), pressure.shape)] - 1] = True
    least = fewest_in_spot(pressure)
    few = judged & (cells < least)
    if not few.any():
        return ""
    counts = ", ".join(map(str, sorted(cells[few], reverse=True)))
    return (
        f"too few cells in {few.sum()} of {judged.sum()} spots with {100 * LEAST_SHARE:g} % of the load or "
        f"more, or with the largest pressure ({counts} cells; together {100 * share[few].sum():.3g} % of the "
        f"load): with fewer than {least} the largest pressure of a spot is off by some percent"
    )


def in_the_fall_off(pressure: Array) -> str:
    """What to know about spots (nx, ny) in Pa where grid.border = "relief" lowers the heights."""
    from scipy import ndimage  # noqa: PLC0415 - for rough scenes alone

    spots, (bx, by) = ndimage.label(pressure > 0)[0].ravel(), border_cells(pressure.shape)
    border = np.ones(pressure.shape, dtype=bool)
    border[bx:-bx, by:-by] = False
    share = np.bincount(spots, pressure.ravel())[1:] / pressure.sum()
    outside = np.bincount(spots, (pressure * border).ravel())[1:] / pressure.sum()
    number = np.count_nonzero((share >= LEAST_SHARE) & (outside > 0.5 * share))
    what = ["the largest pressure"] * bool(pressure[border].max() == pressure.max() > 0)
    what += [f"{number} of the spots with {100 * LEAST_SHARE:g} % of the load or more"] * bool(number)
    if not what:
        return ""
    return (
        f'grid.border = "relief" lowers the heights of the outer {bx} x {by} cells, which have '
        f"{' and '.join(what)}: the surface itself need not have them"
    )


EVEN = Kinks()
"""Those of a body whose yield stress is the same at all depths, or that does not yield."""


def refined_peak(z: Array, values: Array, kinks: Kinks = EVEN) -> tuple[float, float]:
    """Depth and height of the maximum of a parabola through three neighbours, not across kinks."""
    k = int(values.argmax())
    if k in (0, len(values) - 1) or np.ptp(kinks.interval(z[k - 1 : k + 2])):
        return float(z[k]), float(values[k])
    c2, c1, c0 = np.polyfit(z[k - 1 : k + 2] - z[k], values[k - 1 : k + 2], 2)
    shift = -c1 / (2 * c2) if c2 < 0 else 0.0
    return float(z[k] + shift), float(c0 + c1 * shift + c2 * shift**2)


def largest_mises(z: Array, peak: Snapshot, kinks: Kinks = EVEN) -> tuple[float, float]:
    """Depth and value of the largest von Mises stress, refined over depth where it has not yielded."""
    mises = peak.mises
    k, column = np.unravel_index(mises.argmax(), mises.shape)
    if peak.flowed is not None and peak.flowed[k, column]:
        return float(z[k]), float(mises[k, column])
    return refined_peak(z, mises[:, column], kinks)


def exceeded_strain(box: Box) -> float | None:
    """Plastic strain that a share EXCEEDING of the plastic volume exceeds; cells count by half."""
    peeq = box.peeq.ravel()
    if not peeq.any():
        return None
    volume = np.multiply.outer(np.diff(box.z), np.multiply.outer(np.diff(box.x), np.diff(box.y))).ravel()
    order = np.argsort(-peeq)[: np.count_nonzero(peeq > STRAINED * peeq.max())]
    above = np.cumsum(volume[order])
    return float(np.interp(EXCEEDING * above[-1], above - volume[order] / 2, peeq[order]))


def largest_in(depths: Array, mises: Array, part: Mask) -> tuple[float, float] | None:
    """Depth and height of the largest value at some depths, refined between these only; else None."""
    if not part.any():
        return None
    some = mises[part]
    return refined_peak(depths[part], some[:, int(some.max(axis=0).argmax())])


Quantities = dict[str, float | None]


def quantities(
    grid: CellGrid,
    peak: Snapshot,
    unloaded: Snapshot | None,
    *,
    wear_volume: float = 0.0,
    kinks: Kinks = EVEN,
    centred: bool = True,
) -> Quantities:
    """Every name of QUANTITIES; centred: whether the contact has a centre, which a rough one has not."""
    contact, rows = peak.contact, grid.axis_rows.slices[1]
    along_x = contact.pressure.sum(axis=1)
    place, top = peak.top or (None, 0.0)
    depth, largest = largest_mises(grid.depths, peak, kinks)
    area, p_max = contact_area(contact, grid), largest_pressure(contact, grid)
    values: Quantities = {
        "force_N": float(contact.pressure.sum() * grid.hx * grid.hy),
        "approach_m": None if np.isnan(contact.approach) else contact.approach,
        "contact_area_m2": area,
        "contact_radius_m": None if grid.line else equivalent_radius(area),
        "contact_half_width_m": area / (2 * grid.ny * grid.hy) if grid.line and centred else None,
        "p_max_Pa": p_max,
        "p_center_Pa": float(contact.pressure[grid.axis_columns, rows].mean()),
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "peeq_max": top,
        "peeq_max_depth_m": place,
        "friction_coefficient": peak.friction,
        "pressure_centroid_x_m": float(grid.x @ along_x / along_x.sum()) if along_x.any() else None,
        "wear_volume_m3": wear_volume,
        "peeq_p95": None if peak.box is None else exceeded_strain(peak.box),
    }
    if peak.sliding is not None:
        values["tangential_displacement_center_m"] = float(peak.sliding.ux[grid.axis_columns].mean())
    if peak.coated is not None:
        values |= coated_quantities(grid.depths, peak.mises, p_max, peak.coated)
    if unloaded is not None:
        moved, sliding = unloaded.residual_displacement, unloaded.sliding
        values["residual_uz_center_m"] = float(moved[grid.axis_columns, rows].mean())
        values["residual_mises_max_Pa"] = float(unloaded.mises.max())
        if sliding is not None:
            values["residual_ux_center_m"] = float(sliding.residual_ux[grid.axis_columns].mean())
            values["plastic_shear_center_m"] = float(sliding.shear[grid.axis_columns].mean())
    known = QUANTITIES if centred else [name for name in QUANTITIES if "_center_" not in name]
    return dict.fromkeys(QUANTITIES) | {name: values.get(name) for name in known}


def coated_quantities(depths: Array, mises: Array, p_max: float, coated: Coated) -> Quantities:
    """What only a coated scene has, in Pa; None what depths or grid do not hold. mises: (nz, n)."""
    below, bare = depths >= coated.thickness, coated.comparison
    in_film, in_body = largest_in(depths, mises, ~below), largest_in(depths, mises, below)
    depth, largest = max((peak for peak in (in_film, in_body) if peak), key=lambda peak: peak[1])
    values: Quantities = {
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "mises_max_film_Pa": in_film and in_film[1],
        "mises_max_substrate_Pa": in_body and in_body[1],
    }
    if bare is None or bare.mises is None or bare.p_max is None:
        return values
    bare_in_body = largest_in(depths, bare.mises, below)
    values |= {"p_max_bare_Pa": bare.p_max, "p_max_change": p_max / bare.p_max - 1}
    if bare_in_body and in_body:
        values |= {
            "mises_max_bare_Pa": bare_in_body[1],
            "mises_max_change": in_body[1] / bare_in_body[1] - 1,
        }
    return values


SECOND_ORDER = tuple(
    "approach_m p_max_Pa p_center_Pa mises_max_Pa mises_max_depth_m peeq_max peeq_max_depth_m "
    "residual_uz_center_m residual_mises_max_Pa p_max_bare_Pa mises_max_substrate_Pa mises_max_bare_Pa "
    "mises_max_film_Pa peeq_p95".split()
)
"""Quantities whose error is of second order; those not named are left as the finer grid gives them."""


def with_extrapolation(before: Result, fine: Result, *, finds_force: bool) -> Result:
    """The result on the finer grid, extrapolated from the coarser, or with the reason why not."""
    cost = {name: (value or 0) + (before.cost[name] or 0) for name, value in fine.cost.items()}
    cells = before.discretisation["cells"]
    if before.status is not Status.CONVERGED or not fine.converged:
        reason = f"{cells} cells: {before.status}"
        return replace(fine, cost=cost, left_out=[*fine.left_out, LeftOut("extrapolation", reason)])
    ratio = fine.discretisation["cells"][0] / cells[0]
    names = (*SECOND_ORDER, "force_N") if finds_force else SECOND_ORDER
    limits = extrapolated(before.quantities, fine.quantities, ratio, names)
    changes = {name: limits[name] / value - 1 for name in limits if (value := fine.quantities[name])}
    extra = {"extrapolated_from_cells": cells, "extrapolation_change": changes}
    return replace(
        fine,
        quantities={**fine.quantities, **limits},
        discretisation={**fine.discretisation, **extra},
        cost=cost,
    )


def extrapolated(
    before: Mapping[str, float | None],
    fine: Mapping[str, float | None],
    ratio: float,
    names: Sequence[str] = SECOND_ORDER,
) -> dict[str, float]:
    """Those of the named quantities that both have."""
    out = {}
    for name in names:
        coarse, value = before.get(name), fine.get(name)
        if coarse is not None and value is not None:
            out[name] = value + (value - coarse) / (ratio**2 - 1)
    return out
