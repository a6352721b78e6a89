# SPDX-License-Identifier: MIT
"""SAM against FEM, quantity by quantity and field by field, each with a tolerance and its reason.

Both arguments of `compare_results` are results (sam.scene.Result) or runs read back (verification.files.Run). A value
that is missing or not finite fails. Metrics: "relative" |sam - fem|/|fem|; "radii" |sam - fem|/a with a the contact
radius of FEM; "relative L2" sqrt(sum w (sam - fem)^2 / sum w fem^2), for which the columns sam and fem hold the root
mean squares.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from typing import Protocol

import numpy as np

WITHIN = 2.0  # contact radii: the part of line, axis and plane that is compared
INSIDE_EDGE = 0.8  # of a punch's radius: its pressure is compared up to there
EDGE_ZONE = 0.25  # of a punch's radius: around its edge no stress is compared


class Solved(Protocol):
    """What is compared of a Result or a Run."""

    quantities: Mapping[str, float | None]
    tables: Mapping[str, Mapping[str, Sequence]]


@dataclass(frozen=True)
class Row:
    """One line of compare.csv."""

    quantity: str
    sam: float
    fem: float
    metric: str
    difference: float
    tolerance: float
    passed: bool
    reason: str


COLUMNS = tuple(field.name for field in fields(Row))

EDGE = "cells and elements at the edge of the contact, where the pressure has a square root"
SCALARS = (
    ("approach_m", "relative", 2e-3, "a global quantity: far field and both discretisations agree to a few 1e-4"),
    ("contact_radius_m", "relative", 1e-2, EDGE),
    ("p_max_Pa", "relative", 1e-2, "largest cell or nodal value, second order in the cell size"),
    ("p_center_Pa", "relative", 1e-2, "one cell against an extrapolation of nodal values to the axis"),
    ("mises_max_Pa", "relative", 1e-2, "stress is one order less accurate than displacement in FEM"),
    ("mises_max_depth_m", "radii", 2e-2, "spacing of the output depths; the maximum is flat"),
)
UNBOUNDED_UNDER_A_PUNCH = ("p_max_Pa", "mises_max_Pa", "mises_max_depth_m")
"""Infinite in the continuum, or set by that: such values are those of the mesh."""
RIGID_EDGE = "the cells of SAM end a punch to about a tenth of a cell, so its compliance is first order in h/radius"
FOR_A_PUNCH = {"approach_m": (5e-3, RIGID_EDGE), "uz_m on the line": (1e-2, RIGID_EDGE)}
"""Quantities whose tolerance and reason are others than those of a smooth contact."""


def compare_results(sam: Solved, fem: Solved, *, punch: bool = False) -> list[Row]:
    """Every comparison of two results of one scene, at peak load. Without load all fields are zero: scalars only."""
    skipped = UNBOUNDED_UNDER_A_PUNCH if punch else ()
    radius = _number(fem.quantities.get("contact_radius_m"))
    loaded = fem.quantities.get("force_N") != 0
    special = FOR_A_PUNCH if punch else {}
    rows = [
        _scalar(name, metric, *special.get(name, usual), sam, fem, radius)
        for name, metric, *usual in SCALARS
        if name not in skipped and (loaded or metric == "relative")
    ]
    if loaded:
        rows += [
            _field(name, *special.get(name, usual), sampled, sam, fem, radius, punch)
            for name, sampled, *usual in FIELDS
        ]
    return rows


def table_rows(rows: Sequence[Row]) -> list[tuple]:
    """The cells of compare.csv, in the order of COLUMNS."""
    return [astuple(row) for row in rows]


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _scalar(name, metric, tolerance, reason, sam: Solved, fem: Solved, radius: float) -> Row:
    a, b = _number(sam.quantities.get(name)), _number(fem.quantities.get(name))
    difference = _ratio(abs(a - b), radius if metric == "radii" else abs(b))
    return _judged(name, a, b, metric, difference, tolerance, reason)


def _ratio(difference: float, scale: float) -> float:
    """difference/scale; equal values agree even at zero, and a scale of zero or NaN never passes."""
    if difference == 0:
        return 0.0
    return difference / scale if scale > 0 else math.nan


def _judged(name, a, b, metric, difference, tolerance, reason) -> Row:
    return Row(name, a, b, metric, difference, tolerance, bool(difference <= tolerance), reason)


def _field(name, tolerance, reason, sampled: Callable, sam: Solved, fem: Solved, radius: float, punch: bool) -> Row:
    try:
        a, b, weight = sampled(sam, fem, radius, punch)
    except (KeyError, IndexError, ValueError):  # a table or state is missing, or too small to interpolate in
        a = b = weight = np.array([math.nan])
    total = np.sum(weight)
    rms = [float(np.sqrt(np.sum(weight * v**2) / total)) if total > 0 else math.nan for v in (a, b, a - b)]
    return _judged(name, rms[0], rms[1], "relative L2", _ratio(rms[2], rms[1]), tolerance, reason)


def _peak(table: Mapping[str, Sequence], *names: str) -> list[np.ndarray]:
    """Columns of the rows at peak load. Raises ValueError if there are none."""
    rows = np.asarray(table["state"]) == "peak"
    if not rows.any():
        raise ValueError("no rows at peak load")
    return [np.asarray(table[name], dtype=float)[rows] for name in names]


def _on_line(tables, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the axis, ascending, and a surface field there: the mean of both sides where both are given."""
    x, value = _peak(tables["line"], "x_m", name)
    r, where, count = np.unique(np.abs(x), return_inverse=True, return_counts=True)
    return r, np.bincount(where, value) / count


def _pressure_at(solved: Solved, at: np.ndarray) -> np.ndarray:
    """p at r: p^2 is linear in r^2 between values, as it is under Hertz, and falls to zero at the contact radius.

    Where pressure is given beyond that radius it counts: then it ends at the first value without pressure.
    """
    r, p = _on_line(solved.tables, "p_Pa")
    last = int(np.flatnonzero(p)[-1])
    end = max(_number(solved.quantities.get("contact_radius_m")), r[last])
    if end == r[last]:
        end = r[min(last + 1, r.size - 1)]
    knots, squares = np.append(r[: last + 1], end), np.append(p[: last + 1], 0.0) ** 2
    return np.sqrt(np.interp(at**2, knots**2, squares))


def _reach(sam: Solved, fem: Solved, limit: float) -> float:
    """The largest distance from the axis up to `limit` that both lines cover."""
    return min(limit, *(_peak(solved.tables["line"], "x_m")[0].max() for solved in (sam, fem)))


def _pressure(sam: Solved, fem: Solved, radius: float, punch: bool):
    """p over the disc: weight 2 pi r dr."""
    r = np.linspace(0.0, _reach(sam, fem, radius * (INSIDE_EDGE if punch else 1.2)), 481)
    return _pressure_at(sam, r), _pressure_at(fem, r), r


def _displacement(sam: Solved, fem: Solved, radius: float, _punch: bool):
    r = np.linspace(0.0, _reach(sam, fem, WITHIN * radius), 481)
    on_sam, on_fem = (np.interp(r, *_on_line(solved.tables, "uz_m")) for solved in (sam, fem))
    return on_sam, on_fem, np.ones_like(r)


def _axis(sam: Solved, fem: Solved, radius: float, _punch: bool):
    """On the axis at the output depths of SAM; each stands for the depth around it."""
    z, mises = _peak(sam.tables["axis"], "z_m", "mises_Pa")
    fem_z, fem_mises = _peak(fem.tables["axis"], "z_m", "mises_Pa")
    use = (z >= fem_z.min()) & (z <= min(WITHIN * radius, fem_z.max()))
    return mises[use], np.interp(z[use], fem_z, fem_mises), np.gradient(z[use])


def _plane(sam: Solved, fem: Solved, radius: float, punch: bool):
    """In y = 0 at the Gauss points of FEM, each counted once; SAM is interpolated between its cells and depths."""
    from scipy.interpolate import RegularGridInterpolator

    x, z, mises = _peak(sam.tables["plane"], "x_m", "z_m", "mises_Pa")
    r, depth, fem_mises = _peak(fem.tables["plane"], "x_m", "z_m", "mises_Pa")
    xs, zs = np.unique(x), np.unique(z)
    grid = np.full((xs.size, zs.size), math.nan)
    grid[np.searchsorted(xs, x), np.searchsorted(zs, z)] = mises
    use = (r <= min(WITHIN * radius, xs.max())) & (depth <= min(WITHIN * radius, zs.max())) & (depth >= zs.min())
    if punch:
        use &= np.hypot(r - radius, depth) > EDGE_ZONE * radius
    r, depth = r[use], depth[use]
    both = RegularGridInterpolator((xs, zs), (grid + grid[::-1]) / 2)
    return both((r, depth)), fem_mises[use], np.ones_like(r)


FIELDS = (
    ("p_Pa over the contact", _pressure, 1e-2, EDGE),
    ("uz_m on the line", _displacement, 5e-3, "smooth: second order in the cell size, and the far field"),
    ("mises_Pa on the axis", _axis, 1e-2, "stress is one order less accurate than displacement in FEM"),
    ("mises_Pa in the plane y = 0", _plane, 1e-2, "the same, and the steep stress at the edge of the contact"),
)
