# SPDX-License-Identifier: MIT
"""The figures of one contact: from the fields of SAM and FEM, normalised, to drawings."""

from __future__ import annotations

import numpy as np

from sam.scene import Result
from verification.figures.maps import FieldPair, MapPeak, plane_maps, pressure_maps
from verification.figures.style import Drawing
from verification.runs.sampling import Tables, plane_field, plane_field_on, pressure_map, pressure_on

VON_MISES_LEVELS = np.arange(0.1, 0.95, 0.1)
VON_MISES = r"$\sigma_\mathrm{vM}/p_0$"
SURFACE_AXES, PLANE_AXES = ("$x/a$", "$y/a$"), ("$x/a$", "$z/a$")


def compared_pressure(
    sam: Result, fem: Tables, a: float, p0: float, *, reach: float = 1.3, edge: float = 1.0, power: int = 2
) -> Drawing:
    """p/p0 over (x/a, y/a) to `reach`: SAM | FEM | difference; edge: radius of the contact in a; power: see
    pressure_on.
    """
    x, y, p = pressure_map(sam)
    use_x, use_y = np.abs(x) <= reach * a, np.abs(y) <= reach * a
    x, y, p = x[use_x], y[use_y], p[np.ix_(use_x, use_y)]
    fields = (p / p0, pressure_on(x, y, fem, power) / p0)
    return pressure_maps(
        FieldPair(x / a, y / a, *fields, ("SAM", "FEM"), SURFACE_AXES, "$p/p_0$", (edge, edge))
    )


def compared_mises(
    sam: Result, fem: Result, a: float, p0: float, *, reach: float = 1.5, deep: float = 1.9
) -> Drawing:
    """von Mises stress over p0 in y = 0, |x/a| <= reach, z/a <= deep: SAM | FEM | difference."""
    x, z, mises = plane_field(sam.tables, "mises_Pa")
    use_x, use_z = np.abs(x) <= reach * a, z <= deep * a
    x, z, mises = x[use_x], z[use_z], mises[np.ix_(use_x, use_z)]
    fields = (mises / p0, plane_field_on(x, z, fem.tables, "mises_Pa") / p0)
    pair = FieldPair(x / a, z / a, *fields, ("SAM", "FEM"), PLANE_AXES, VON_MISES)
    quoted = [(r.quantities["mises_max_depth_m"] / a, r.quantities["mises_max_Pa"] / p0) for r in (sam, fem)]
    peaks = [peak_of(pair.u, field, *values) for field, values in zip(fields, quoted, strict=True)]
    return plane_maps(pair, peaks, VON_MISES_LEVELS)


def peak_of(u: np.ndarray, field: np.ndarray, depth: float, largest: float) -> MapPeak:
    """The maximum as the solver quotes it (refined in depth), in the column where the field is largest."""
    column = int(np.argmax(np.nanmax(np.where(np.isnan(field), -np.inf, field), axis=1)))
    return MapPeak(float(u[column]), depth, largest)
