# SPDX-License-Identifier: MIT
"""The scalar results of a scene, at the peak load and after it."""

from __future__ import annotations

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid
from sam.half_space import equivalent_radius
from sam.results.history import contact_area, largest_pressure
from sam.results.peaks import EVEN, exceeded_strain, largest_in, largest_mises
from sam.results.snapshots import Coated, Snapshot
from sam.scene.result import QUANTITIES
from sam.scene.yield_curve import Kinks

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
    """Every name of QUANTITIES.

    wear_volume: of all cycles in m^3; kinks: see `refined_peak`; centred: whether the contact has a centre,
    which that of a rough body has not.
    """
    contact, rows = peak.contact, grid.axis_rows.slices[1]
    place, top = peak.top or (None, 0.0)
    depth, largest = largest_mises(grid.depths, peak, kinks)
    area, p_max = contact_area(contact, grid), largest_pressure(contact, grid)
    values: Quantities = {
        "force_N": float(contact.pressure.sum() * grid.hx * grid.hy),
        "approach_m": None if np.isnan(contact.approach) else contact.approach,
        "contact_area_m2": area,
        "contact_radius_m": equivalent_radius(area),
        "p_max_Pa": p_max,
        "p_center_Pa": float(contact.pressure[grid.axis_columns, rows].mean()) if centred else None,
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "peeq_max": top,
        "peeq_max_depth_m": place,
        "friction_coefficient": peak.friction,
        "pressure_centroid_x_m": _centroid(grid.x, contact.pressure.sum(axis=1)),
        "wear_volume_m3": wear_volume,
        "peeq_p95": None if peak.box is None else exceeded_strain(peak.box),
    }
    if peak.sliding is not None:
        values["tangential_displacement_center_m"] = float(peak.sliding.ux[grid.axis_columns].mean())
    if peak.coated is not None:
        values |= coated_quantities(grid.depths, peak.mises, p_max, peak.coated)
    if unloaded is not None:
        values |= _unloaded_quantities(grid, unloaded)
    return {name: values.get(name) for name in QUANTITIES}


def _unloaded_quantities(grid: CellGrid, unloaded: Snapshot) -> Quantities:
    """What is left after the load."""
    rows, sliding = grid.axis_rows.slices[1], unloaded.sliding
    values: Quantities = {
        "residual_uz_center_m": float(unloaded.residual_displacement[grid.axis_columns, rows].mean()),
        "residual_mises_max_Pa": float(unloaded.mises.max()),
    }
    if sliding is not None:
        values["residual_ux_center_m"] = float(sliding.residual_ux[grid.axis_columns].mean())
        values["plastic_shear_center_m"] = float(sliding.shear[grid.axis_columns].mean())
    return values


def _centroid(x: Array, weight: Array) -> float | None:
    """Mean of x with these weights; None where all are zero."""
    return float(x @ weight / weight.sum()) if weight.any() else None


def coated_quantities(depths: Array, mises: Array, p_max: float, coated: Coated) -> Quantities:
    """The names of QUANTITIES that only a coated scene has, and the largest stress anywhere.

    mises: von Mises stress of (nz, n) points in Pa; p_max in Pa. What the depths or the grid do not hold is
    None.
    """
    below, bare = depths >= coated.thickness, coated.comparison
    in_film, in_body = largest_in(depths, mises, ~below), largest_in(depths, mises, below)
    depth, largest = max((found for found in (in_film, in_body) if found), key=lambda found: found[1])
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
