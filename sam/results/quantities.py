# SPDX-License-Identifier: MIT
"""The scalar results of a scene, at the peak load and after it.

Richardson's extrapolation takes two grids, one with twice the cells of the other. The errors of maxima,
depths and displacements fall with the square of the cell once it is small: not smoothly where the edge of a
contact or of a plastic zone falls between cells. Of two values q_c (coarse) and q_f (fine, r times as many
cells) the extrapolated one is q_f + (q_f - q_c)/(r^2 - 1) (Richardson 1911). The coarse solution costs a
tenth to a half of the fine one. Their difference, recorded with each quantity, tells how good the fine value
is by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from sam.arrays import Array, Mask
from sam.grid.cells import CellGrid
from sam.half_space import equivalent_radius
from sam.results.history import Box, Coated, Snapshot, contact_area, largest_pressure
from sam.scene import LeftOut, Result, Status
from sam.scene.result import EXCEEDING, QUANTITIES, STRAINED
from sam.scene.yield_curve import Kinks

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
