# SPDX-License-Identifier: MIT
"""The rows of a smooth contact: which quantities and fields are compared, where, and within what.

All are at peak load, but for what is called residual: after unloading. In the plane, Gauss points of FEM
between the surface and the first depth of SAM are left out: nothing is extrapolated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator

from sam.scene import PEAK, UNLOADED
from verification.compare.rows import Pair, Solution, field_row, judged, number, scalar_row
from verification.judging import Measured, Verdict

WITHIN = 2.0  # contact radii: the part of line, axis and plane that is compared
INSIDE_EDGE = 0.8  # of a punch's radius: its pressure is compared up to there
# of the radius of a plastic contact: likewise, as the pressure falls within a cell at its edge
INSIDE_FLOW = 0.9
RING = 0.25  # of the radius of a plastic contact: over hats of this half width its whole pressure is compared
EDGE_ZONE = 0.25  # of a punch's radius: around its edge no stress is compared


EDGE = "cells and elements at the edge of the contact, where the pressure has a square root"
SCALARS = (
    (
        "approach_m",
        "relative",
        2e-3,
        "a global quantity: far field and both discretisations agree to a few 1e-4",
    ),
    ("contact_radius_m", "relative", 1e-2, EDGE),
    ("p_max_Pa", "relative", 1e-2, "largest cell or nodal value, second order in the cell size"),
    ("p_center_Pa", "relative", 1e-2, "one cell against an extrapolation of nodal values to the axis"),
    ("mises_max_Pa", "relative", 1e-2, "stress is one order less accurate than displacement in FEM"),
    ("mises_max_depth_m", "radii", 2e-2, "spacing of the output depths; the maximum is flat"),
)
UNBOUNDED_UNDER_A_PUNCH = ("p_max_Pa", "mises_max_Pa", "mises_max_depth_m")
"""Infinite in the continuum, or set by that: such values are those of the mesh."""
RIGID_EDGE = (
    "the cells of SAM end a punch to about a tenth of a cell, so its compliance is first order in h/radius"
)
FOR_A_PUNCH = {"approach_m": (5e-3, RIGID_EDGE), "uz_m on the line": (1e-2, RIGID_EDGE)}
WITHIN_EDGE = "the rounded edge, in which the pressure rises and falls within a few cells"
FOR_A_ROUNDED_EDGE = dict.fromkeys(
    ("p_Pa over the contact", "mises_Pa in the plane y = 0"), (2e-2, WITHIN_EDGE)
)
OF_SHAPES = {"punch": FOR_A_PUNCH, "rounded-punch": FOR_A_ROUNDED_EDGE}
"""Quantities whose tolerance and reason are others than those of a smooth contact, by shape."""

STRAIN = "cells, layers and elements in the plastic zone, and the load steps that both models share"
EDGE_FLOW = "the edge of the contact, where plastic flow raises the pressure within a few cells"
YIELDING = "bounded by the yield stress of the strain there, and steep at the edge of the contact"
RESIDUAL = "what is left of two larger fields that nearly cancel"
OF_ORDER = (
    "whole cells in a small part of the plastic volume: 1.2 % with 16 cells in the radius, 2.2 % with 8"
)
PLASTIC_SCALARS = (
    ("peeq_max", "relative", 1e-2, STRAIN),
    ("peeq_max_depth_m", "radii", 3e-2, "a share of a layer; the maximum is flat"),
    ("peeq_p95", "relative", 3e-2, OF_ORDER),
)
RESIDUAL_SCALARS = (("residual_uz_center_m", "relative", 2e-2, f"the sum of the plastic strains; {STRAIN}"),)
FOR_PLASTICITY = {
    "approach_m": (5e-3, f"{STRAIN}; the far field of FEM is the elastic one"),
    "contact_radius_m": (2e-2, EDGE_FLOW),
    "p_max_Pa": (2e-2, EDGE_FLOW),
    "p_Pa over the contact": (
        1e-2,
        "up to 0.9 of its radius: a line crosses the edge in two cells only, "
        "and the force fixes what lies beyond",
    ),
    "mises_Pa on the axis": (2e-2, YIELDING),
    "mises_Pa in the plane y = 0": (3e-2, YIELDING),
}
"""Tolerance and reason where a plastic scene has others than an elastic one."""
OF_THE_SURFACE = ("mises_max_Pa", "mises_max_depth_m", "peeq_max", "peeq_max_depth_m")
"""Largest at the surface or near it once friction is high: a value of the mesh."""
HEXAHEDRA = "hexahedra, the means of which stand for the stress at their centres"
SLIDING_SCALARS = (
    ("pressure_centroid_x_m", "radii", 5e-3, "an integral of the pressure, insensitive to its edge"),
)
CENTRE = "pressure_centroid_x_m on the line"
CENTRED = (2e-2, "an integral of the pressure; a result that is shifted along x is off by its shift")
FOR_SPATIAL = {
    "approach_m": (1e-2, "nodes of hexahedra at the edge of the contact, and the far field on a small box"),
    "contact_radius_m": (2e-2, "nodes of hexahedra at the edge of the contact"),
    "p_max_Pa": (1.5e-2, "nodal values of hexahedra"),
    "p_Pa over the contact": (
        4e-2,
        "the edge of the contact, which hexahedra resolve to a share of an element",
    ),
    "uz_m on the line": (1e-2, "far field of point forces on a smaller box"),
    "mises_Pa on the axis": (2e-2, HEXAHEDRA),
    "mises_Pa in the plane y = 0": (3e-2, HEXAHEDRA),
    "peeq on the axis": (3e-2, HEXAHEDRA),
    "peeq in the plane y = 0": (5e-2, f"{HEXAHEDRA}; the kink at the border of the zone"),
    "residual_uz_center_m": (3e-2, HEXAHEDRA),
    "residual uz_m on the line": (5e-2, HEXAHEDRA),
}
"""Tolerance and reason against the three-dimensional model, whose elements are larger and of lower order."""
IN_THE_FILM = ("mises_max_Pa", "mises_max_depth_m")
"""Of a coated scene: the larger one of film and body, compared by themselves."""
COATED_SCALARS = (
    (
        "mises_max_substrate_Pa",
        "relative",
        1e-2,
        "stress is one order less accurate than displacement in FEM",
    ),
    (
        "mises_max_film_Pa",
        "relative",
        2e-2,
        "largest at a face of the film or near it, beyond the last points of FEM",
    ),
    ("p_max_bare_Pa", "relative", 1e-2, "largest cell or nodal value, second order in the cell size"),
    ("mises_max_bare_Pa", "relative", 1e-2, "stress is one order less accurate than displacement in FEM"),
)
NOT_UNIQUE_IN_PLASTIC_FLOW = ("mises_max_depth_m",)
"""The largest von Mises stress is the yield stress, over a zone of almost equal values."""
ROUNDING = 1e-9
"""Of a depth: the interface is where a model says it is to within this."""


def compare_results(
    sam: Solution,
    fem: Solution,
    *,
    shape: str = "",
    plastic: bool = False,
    unloaded: bool = False,
    slides: bool = False,
    film: float = 0.0,
) -> list[Verdict]:
    """Every comparison of two results of one scene. Without load all fields are zero: scalars only.

    shape: of the counter-body; plastic: also the plastic strain; unloaded: also what is left after unloading;
    slides: with friction; film: thickness of a coating in m.
    """
    punch = shape == "punch"
    skipped = (*(UNBOUNDED_UNDER_A_PUNCH if punch else ()), *(NOT_UNIQUE_IN_PLASTIC_FLOW if plastic else ()))
    skipped += OF_THE_SURFACE * slides + IN_THE_FILM * (film > 0)
    if not any(solved.quantities.get("peeq_max") for solved in (sam, fem)):
        skipped += ("peeq_max_depth_m", "peeq_p95")  # of nothing
    spatial = _two_sided(fem)
    if spatial or not math.isfinite(_radius(fem)):
        skipped += (MEANS,)  # its line is compared over the whole contact; data need not say where that ends
    special = (
        (FOR_PLASTICITY if plastic else {}) | OF_SHAPES.get(shape, {}) | (FOR_SPATIAL if spatial else {})
    )
    loaded = fem.quantities.get("force_N") != 0
    radius = _radius(fem, sam)
    pair = Pair(sam, fem, radius, punch, plastic=plastic, slides=slides, spatial=spatial, film=film)
    scalars, sampled = wanted(plastic=plastic, unloaded=unloaded, slides=slides, coated=film > 0)
    rows = [
        scalar_row(pair, name, metric, special.get(name, (tolerance, reason)))
        for name, metric, tolerance, reason in scalars
        if name not in skipped and (loaded or metric == "relative")
    ]
    if loaded:
        rows += [
            field_row(pair, name, sample, special.get(name, (tolerance, reason)))
            for name, sample, tolerance, reason in sampled
            if name not in skipped
        ]
    return rows


def _radius(*solutions: Solution) -> float:
    """The contact radius of the first that has one; data of a user may have none."""
    radii = (number(solved.quantities.get("contact_radius_m")) for solved in solutions)
    return next((radius for radius in radii if math.isfinite(radius)), math.nan)


def centre_row(sam: Solution, other: Solution, fem: Solution) -> Verdict:
    """The centre of the pressure on the line y = 0; by it a result that is shifted is seen."""
    pair = Pair(sam, other, _radius(fem, sam), punch=False, plastic=False)
    values = tuple(_centre(solved) for solved in (sam, other))
    return judged(CENTRE, "radii", Measured(*values, scale=pair.radius), CENTRED)


def _centre(solved: Solution) -> float:
    """Of the pressure along x; 0 where only one side of the axis is given, NaN without pressure."""
    try:
        x, p = _rows(solved.tables["line"], PEAK, "x_m", "p_Pa")
    except (KeyError, ValueError):
        return math.nan
    if x.min() >= 0:
        return 0.0
    total = np.trapezoid(p, x)
    return float(np.trapezoid(p * x, x) / total) if total > 0 else math.nan


def wanted(*, plastic: bool, unloaded: bool, slides: bool, coated: bool) -> tuple[tuple, tuple]:
    """The scalars and the fields that a kind of scene may be compared by; see `SCALARS` and `FIELDS`."""
    scalars = SCALARS + PLASTIC_SCALARS * plastic + RESIDUAL_SCALARS * unloaded + SLIDING_SCALARS * slides
    fields = FIELDS + PLASTIC_FIELDS * plastic + RESIDUAL_FIELDS * unloaded
    return scalars + COATED_SCALARS * coated, fields


def _two_sided(fem: Solution) -> bool:
    """Whether FEM gives values on both sides of the axis, as the three-dimensional model does."""
    return bool(np.min(fem.tables.get("line", {}).get("x_m", [0.0]), initial=0.0) < 0.0)


def _rows(table: Mapping[str, Sequence], state: str, *names: str) -> list[np.ndarray]:
    """Columns of the rows of a state. Raises ValueError if there are none."""
    rows = np.asarray(table["state"]) == state
    if not rows.any():
        raise ValueError(f"no rows of the state {state}")
    return [np.asarray(table[name], dtype=float)[rows] for name in names]


def _on_line(tables, name: str, state: str = PEAK) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the axis, ascending, and a surface field there: the mean of both sides where both are
    given.
    """
    x, value = _rows(tables["line"], state, "x_m", name)
    r, where, count = np.unique(np.abs(x), return_inverse=True, return_counts=True)
    return r, np.bincount(where, value) / count


def _pressure_at(solved: Solution, at: np.ndarray) -> np.ndarray:
    """p at r: p^2 is linear in r^2 between values, as it is under Hertz, and falls to zero at the contact
    radius.

    Where pressure is given beyond that radius it counts: then it ends halfway to the first value without
    pressure, as far as the last cell, or the surface that the last node stands for, reaches.
    """
    r, p = _on_line(solved.tables, "p_Pa")
    last = int(np.flatnonzero(p)[-1])
    end = np.fmax(number(solved.quantities.get("contact_radius_m")), r[last])
    if end == r[last]:
        end = (r[last] + r[min(last + 1, r.size - 1)]) / 2
    knots, squares = np.append(r[: last + 1], end), np.append(p[: last + 1], 0.0) ** 2
    return np.sqrt(np.interp(at**2, knots**2, squares))


def _means(pair: Pair):
    """Means of p over the whole contact and around its edge: by hat functions of the radius, RING apart."""
    reach = _reach(pair, pair.radius * 1.3)
    r, centres = np.linspace(0.0, reach, 2001), np.arange(0.0, reach, RING * pair.radius)
    hats = np.clip(1.0 - np.abs(r - centres[:, None]) / (RING * pair.radius), 0.0, None) * r
    weights = hats.sum(axis=1)
    on_sam, on_fem = (hats @ _pressure_at(solved, r) / weights for solved in (pair.sam, pair.fem))
    return on_sam, on_fem, weights


def _reach(pair: Pair, limit: float, state: str = PEAK, *, side: int = 1) -> float:
    """The largest distance from the axis up to `limit` that both lines cover on a side of it, 1 or -1."""
    lines = (_rows(solved.tables["line"], state, "x_m")[0] for solved in (pair.sam, pair.fem))
    return min(limit, *((side * x).max() for x in lines))


def _pressure(pair: Pair):
    """p over the disc: weight 2 pi r dr; against the three-dimensional model along y = 0."""
    if pair.spatial:
        return _along(pair, "p_Pa", pair.radius * 1.2)
    known = math.isfinite(_radius(pair.fem))  # else, of data, its edge is known to the distance of two places
    reach = INSIDE_EDGE if pair.punch else 1.2 if known and not pair.plastic else INSIDE_FLOW
    r = np.linspace(0.0, _reach(pair, pair.radius * reach), 481)
    return _pressure_at(pair.sam, r), _pressure_at(pair.fem, r), r


def _along(pair: Pair, name: str, limit: float, state: str = PEAK):
    """A surface field along y = 0 on both sides of the axis."""
    reach = _reach(pair, limit, state)
    x = np.linspace(-_reach(pair, limit, state, side=-1), reach, 961)
    on_sam, on_fem = (
        np.interp(x, *_rows(solved.tables["line"], state, "x_m", name)) for solved in (pair.sam, pair.fem)
    )
    return on_sam, on_fem, np.ones_like(x)


def _displacement(pair: Pair, state: str = PEAK):
    if pair.spatial:
        return _along(pair, "uz_m", WITHIN * pair.radius, state)
    r = np.linspace(0.0, _reach(pair, WITHIN * pair.radius, state), 481)
    on_sam, on_fem = (
        np.interp(r, *_on_line(solved.tables, "uz_m", state)) for solved in (pair.sam, pair.fem)
    )
    return on_sam, on_fem, np.ones_like(r)


def _axis(pair: Pair, column: str, state: str = PEAK):
    """On the axis at the output depths of SAM; each stands for the depth around it."""
    z, on_sam = _rows(pair.sam.tables["axis"], state, "z_m", column)
    fem_z, on_fem = _below(pair.film, *_rows(pair.fem.tables["axis"], state, "z_m", column))
    use = (z >= max(fem_z.min(), pair.top)) & (z <= min(WITHIN * pair.radius, fem_z.max()))
    return on_sam[use], np.interp(z[use], fem_z, on_fem), np.gradient(z[use])


def _below(film: float, z: np.ndarray, *others: np.ndarray) -> list[np.ndarray]:
    """The rows of the body, from the interface on, where z is `film` to rounding: stresses along the surface
    jump there.
    """
    z = np.where(np.isclose(z, film, rtol=ROUNDING, atol=0.0), film, z)
    return [column[z >= film] for column in (z, *others)]


def _plane(pair: Pair, column: str):
    """In y = 0 at the Gauss points of FEM, each counted once; SAM is interpolated between its cells and
    depths.
    """
    z, x, on_sam = _below(pair.film, *_rows(pair.sam.tables["plane"], PEAK, "z_m", "x_m", column))
    depth, r, on_fem = _below(pair.film, *_rows(pair.fem.tables["plane"], PEAK, "z_m", "x_m", column))
    xs, zs = np.unique(x), np.unique(z)
    grid = np.full((xs.size, zs.size), math.nan)
    grid[np.searchsorted(xs, x), np.searchsorted(zs, z)] = on_sam
    reach = WITHIN * pair.radius
    use = (
        (np.abs(r) <= min(reach, xs.max()))
        & (depth <= min(reach, zs.max()))
        & (depth >= max(zs.min(), pair.top))
    )
    if pair.punch:
        use &= np.hypot(r - pair.radius, depth) > EDGE_ZONE * pair.radius
    r, depth = r[use], depth[use]
    if not pair.spatial:
        grid = (grid + grid[::-1]) / 2
    return _between(xs, zs, grid, (r, depth), spline=pair.plastic), on_fem[use], np.ones_like(r)


def _between(xs, zs, grid, places: tuple, *, spline: bool) -> np.ndarray:
    """Linear, or by a bicubic spline: between 14 cells a radius a strain field is off by 1 % linearly, 0.3 %
    with it.
    """
    if spline:
        return RectBivariateSpline(xs, zs, grid, s=0).ev(*places)
    return RegularGridInterpolator((xs, zs), grid)(places)


FIELDS = (
    ("p_Pa over the contact", _pressure, 1e-2, EDGE),
    ("uz_m on the line", _displacement, 5e-3, "smooth: second order in the cell size, and the far field"),
    (
        "mises_Pa on the axis",
        partial(_axis, column="mises_Pa"),
        1e-2,
        "stress is one order less accurate than displacement in FEM",
    ),
    (
        "mises_Pa in the plane y = 0",
        partial(_plane, column="mises_Pa"),
        1e-2,
        "the same, and the steep stress at the edge of the contact",
    ),
)
MEANS = "p_Pa as means over a/4"
PLASTIC_FIELDS = (
    (
        MEANS,
        _means,
        2e-2,
        "the whole contact: where in a cell its edge lies counts as a share of the cell; 0.6 to 0.8 % "
        "with 16 cells and 32 elements in the radius, 1.5 % with half of both",
    ),
    ("peeq on the axis", partial(_axis, column="peeq"), 2e-2, STRAIN),
    (
        "peeq in the plane y = 0",
        partial(_plane, column="peeq"),
        3e-2,
        f"{STRAIN}; the kink at the border of the zone",
    ),
)
RESIDUAL_FIELDS = (
    (
        "residual uz_m on the line",
        partial(_displacement, state=UNLOADED),
        2e-2,
        f"as at the centre; {RESIDUAL}",
    ),
    ("residual mises_Pa on the axis", partial(_axis, column="mises_Pa", state=UNLOADED), 5e-2, RESIDUAL),
)
