# SPDX-License-Identifier: MIT
"""What the record of a rough scene has besides that of a smooth one: its surface table, roughness and
warnings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.normal import Contact, fewest_in_spot
from sam.grid.cells import CellGrid, at_edge
from sam.grid.rough import RoughPatch
from sam.results.history import contact_area
from sam.results.snapshots import Snapshot
from sam.results.tables import Remedies
from sam.scene.remedies import either
from sam.scene.result import COUNTER_HEIGHT, SURFACE
from sam.scene.surface import border_cells, roughness_as_read

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
