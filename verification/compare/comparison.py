# SPDX-License-Identifier: MIT
"""SAM against FEM, quantity by quantity and field by field: the rows of `rows.toml` that a scene has.

All are at peak load, but for what is called residual: after unloading. In the plane, Gauss points of FEM
between the surface and the first depth of SAM are left out: nothing is extrapolated. Both arguments are
results (`sam.scene.Result`) or runs read back (`verification.runs.files.Run`).
"""

import math
import re
import tomllib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator

from sam.scene import PEAK, UNLOADED, Compare, Problem, Scene, SceneError, problems, spelling
from verification.compare.measures import Spot, patch_pressure, spots
from verification.compare.own_data import OwnData
from verification.compare.rows import Limit, Pair, Solution, field_row, judged, scalar_row
from verification.compare.verdicts import CHANGES, CLAIM
from verification.judging import Measured, RowStatus, Verdict
from verification.runs.sampling import gridded, rows_of
from verification.runs.tables import contact_size
from verification.text.console import unknown

RISE = 1.5  # of an elastic contact of Hertz, the steepest of those that are compared
GROOVE = ("groove_depth_m", "groove_deepest_m")
CENTRE, SPOT = "pressure_centroid_x_m on the line", "load of the spot"
SIDES = {"cylinder", "spatial"}  # kinds of scenes that are compared on both sides of the axis
WITHIN = 2.0  # contact radii: the part of line, axis and plane that is compared
INSIDE_EDGE = 0.8  # of a punch's radius: its pressure is compared up to there
INSIDE_FLOW = 0.9  # of the radius of a plastic contact: likewise, as pressure falls within a cell at its edge
RING = 0.25  # of the radius of a plastic contact: over hats of this half width its whole pressure is compared
EDGE_ZONE = 0.25  # of a punch's radius: around its edge no stress is compared
ROUNDING = 1e-9  # of a depth: the interface is where a model says it is to within this


_TEXT = Path(__file__).with_name("rows.toml").read_text(encoding="utf-8")
_REASONS = tomllib.loads(_TEXT)["reasons"]
_WHOLE = re.sub(r"@([a-z-]+)", lambda found: _REASONS[found[1]], _TEXT)
TABLES: Mapping[str, Mapping[str, Any]] = tomllib.loads(_WHOLE)
"""Kind of scene -> name -> what `rows.toml` says, with reasons written out."""


def wanted(kinds: Collection[str], left_out: bool = True) -> dict[str, list]:
    """Name -> [metric, tolerance, reason] of the rows of kinds of scenes, fields last."""
    found: dict[str, list] = {}
    left: set[str] = set()
    for name, said in ((n, s) for kind, table in TABLES.items() if kind in kinds for n, s in table.items()):
        if isinstance(said, str):
            left.add(name)
        elif len(said) == 3:
            found[name] = said
        elif name in found:
            found[name] = [found[name][0], *said]
    names = sorted(found, key=lambda name: found[name][0] == "relative_l2")
    return {name: found[name] for name in names if not (left_out and name in left)}


def names_of_rows(scene: Scene) -> tuple[str, ...]:
    """What the results of a scene may be compared by: names of rows, or how the names of several begin."""
    force = ("force_N",) if scene.loading.prescribed is None else ()
    if _rough(scene):
        return (*force, *wanted([kind for kind in TABLES if kind.startswith("rough")]))
    changes = CHANGES if scene.body.coating is not None else ()
    return (*force, *wanted(_kinds(scene), left_out=False), CENTRE, *changes)


def _rough(scene: Scene) -> bool:
    return scene.patch_surface is not None and scene.body.coating is None


def _kinds(scene: Scene) -> set[str]:
    """The tables of rows that a scene has."""
    plastic, slides = scene.body.plasticity is not None, scene.coefficient > 0
    unloaded = plastic and scene.loading.unload
    if _rough(scene):
        found = {"rough-map": not scene.constant_friction, "rough-at-rest": plastic and not slides}
        found |= {"rough": True, "rough-unloaded": unloaded}
    else:
        shape = "" if scene.counterbody is None else scene.counterbody.shape
        found = {"smooth": True, "unloaded": unloaded, "coated": scene.body.coating is not None}
        found |= {"plastic": plastic, "slides": slides, "moves": scene.moves, shape: True}
    return {kind for kind, has in found.items() if has}


def pair_of(scene: Scene, sam: Solution, fem: Solution) -> Pair:
    """Two results of a scene, and the tables of rows that they have."""
    kinds, film = _kinds(scene), scene.body.coating.thickness if scene.body.coating else 0.0
    if "smooth" in kinds:  # FEM in three dimensions gives values on both sides of the axis
        sides = np.min(fem.tables.get("line", {}).get("x_m", [0.0]), initial=0.0) < 0.0
        if sides and "cylinder" not in kinds:
            kinds.add("spatial")
        if not math.isfinite(_radius(fem)):
            kinds.add("unknown-radius")
        if not any(solved.quantities.get("peeq_max") for solved in (sam, fem)):
            kinds.add("nothing-yields")
    return Pair(sam, fem, _radius(fem, sam), frozenset(kinds), film)


def compare_scene(scene: Scene, sam: Solution, fem: Solution) -> list[Verdict]:
    """Every comparison of the results of a scene. Without load all fields are zero: quantities only."""
    pair, loaded = pair_of(scene, sam, fem), fem.quantities.get("force_N") != 0
    rows = []
    for name, (metric, *limit) in wanted(pair.kinds).items():
        if metric != "relative_l2":
            rows += [scalar_row(pair, name, metric, limit)] if loaded or metric == "relative" else []
        elif name == SPOT and loaded:
            rows += [_spot_row(pair, spot, limit) for spot in _spots(pair)]
        elif loaded:
            rows.append(field_row(pair, name, (ROUGH if "rough" in pair.kinds else FIELDS)[name], limit))
    if scene.moves and not _rough(scene):
        rows += [_single(pair, name) for name in GROOVE if sam.quantities.get(name) is not None]
    if scene.loading.prescribed is None and scene.loading.approach is None:
        return rows
    others = [row for row in rows if row.quantity != "approach_m"]
    if scene.loading.prescribed:
        return others
    (own,) = (row for row in rows if row.quantity == "approach_m")  # is given: the force in its place
    reason = f"{own.row.reason}; the force grows with the power {RISE:g} of the approach"
    return [scalar_row(pair, "force_N", "relative", (RISE * own.row.tolerance, reason)), *others]


def compare_data(
    scene: Scene, sam: Solution, fem: Solution, data: OwnData
) -> tuple[list[Verdict], list[Verdict]]:
    """Rows of both models beside data, and of SAM and the data, whose values the column fem then holds."""
    between: list[Verdict] = []
    found = compare_scene(scene, sam, data)
    for other, rows in ((fem, between), (data, found)):
        pair = Pair(sam, other, _radius(fem, sam))
        if scene.loading.force is not None:
            rows.append(_single(pair, "force_N"))
        if not _rough(scene):  # by the centre of pressure a result that is shifted is seen
            measured = Measured(_centre(sam), _centre(other), scale=pair.radius)
            metric, *limit = TABLES["single"][CENTRE]
            rows.append(judged(CENTRE, metric, measured, limit))
    own = [row for row in found if math.isfinite(row.expected)]
    return [row for row in between if row.quantity in {each.quantity for each in own}], own


def _single(pair: Pair, name: str) -> Verdict:
    metric, *limit = TABLES["single"][name]
    return scalar_row(pair, name, metric, limit)


def _radius(*solutions: Solution) -> float:
    """The contact radius of the first that has one; data of a user may have none."""
    radii = (contact_size(solved.quantities) for solved in solutions)
    return next((radius for radius in radii if math.isfinite(radius) and radius), math.nan)


# fields of smooth bodies: from two results the values at the same places, and their weights


def _rows(table, state: str, *names: str) -> tuple[np.ndarray, ...]:
    """Columns of the rows of a state. Raises ValueError if there are none."""
    found = rows_of(table, state, *names)
    if not found[0].size:
        raise ValueError(f"no rows of the state {state}")
    return found


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


def _on_line(tables, name: str, state: str = PEAK) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the axis, ascending, and a surface field there: the mean of both sides."""
    x, value = _rows(tables["line"], state, "x_m", name)
    r, where, count = np.unique(np.abs(x), return_inverse=True, return_counts=True)
    return r, np.bincount(where, value) / count


def _pressure_at(solved: Solution, at: np.ndarray) -> np.ndarray:
    """p at r: p^2 is linear in r^2 between values, as it is under Hertz, and falls to zero at the
    contact radius. Where pressure is given beyond that radius it counts: then it ends halfway to
    the first value without pressure, as far as the last cell, or the surface that the last node
    stands for, reaches.
    """
    r, p = _on_line(solved.tables, "p_Pa")
    last = int(np.flatnonzero(p)[-1])
    end = np.fmax(contact_size(solved.quantities), r[last])
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
    on_sam, on_fem = (hats @ _pressure_at(solved, r) / weights for solved in pair.both)
    return on_sam, on_fem, weights


def _reach(pair: Pair, limit: float, state: str = PEAK, *, side: int = 1) -> float:
    """The largest distance from the axis up to `limit` that both lines cover on a side of it, 1 or -1."""
    lines = (_rows(solved.tables["line"], state, "x_m")[0] for solved in pair.both)
    return min(limit, *((side * x).max() for x in lines))


def _pressure(pair: Pair):
    """p over the disc: weight 2 pi r dr; of a line contact, and against `fem-3d`, along y = 0."""
    if "spatial" in pair.kinds:
        return _along(pair, "p_Pa", pair.radius * 1.2)
    known = "unknown-radius" not in pair.kinds  # else its edge is known to the distance of two places
    reach = INSIDE_EDGE if "punch" in pair.kinds else 1.2 if known and not pair.plastic else INSIDE_FLOW
    if "cylinder" in pair.kinds:
        return _along(pair, "p_Pa", pair.radius * reach)
    r = np.linspace(0.0, _reach(pair, pair.radius * reach), 481)
    return _pressure_at(pair.sam, r), _pressure_at(pair.fem, r), r


def _along(pair: Pair, name: str, limit: float, state: str = PEAK):
    """A surface field along y = 0 on both sides of the axis."""
    x = np.linspace(-_reach(pair, limit, state, side=-1), _reach(pair, limit, state), 961)
    lines = (_rows(solved.tables["line"], state, "x_m", name) for solved in pair.both)
    return *(np.interp(x, at, values) for at, values in lines), np.ones_like(x)


def _displacement(pair: Pair, state: str = PEAK):
    limit = WITHIN * pair.radius
    if pair.kinds & SIDES:
        return _along(pair, "uz_m", limit, state)
    r = np.linspace(0.0, _reach(pair, limit, state), 481)
    lines = (_on_line(solved.tables, "uz_m", state) for solved in pair.both)
    return *(np.interp(r, at, values) for at, values in lines), np.ones_like(r)


def _axis(pair: Pair, column: str, state: str = PEAK):
    """On the axis at the output depths of SAM; each stands for the depth around it."""
    z, on_sam = _rows(pair.sam.tables["axis"], state, "z_m", column)
    fem_z, on_fem = _below(pair.film, *_rows(pair.fem.tables["axis"], state, "z_m", column))
    use = (z >= max(fem_z.min(), pair.top)) & (z <= min(WITHIN * pair.radius, fem_z.max()))
    return on_sam[use], np.interp(z[use], fem_z, on_fem), np.gradient(z[use])


def _below(film: float, z: np.ndarray, *others: np.ndarray) -> list[np.ndarray]:
    """The rows of the body, from the interface on, where stresses along the surface jump."""
    z = np.where(np.isclose(z, film, rtol=ROUNDING, atol=0.0), film, z)
    return [column[z >= film] for column in (z, *others)]


def _plane(pair: Pair, column: str):
    """In y = 0 at the Gauss points of FEM, each counted once. SAM is interpolated between its cells and
    depths, where the body yields by a bicubic spline: between 14 cells a radius a strain field is off by 1 %
    linearly, 0.3 % with it.
    """
    z, x, on_sam = _below(pair.film, *_rows(pair.sam.tables["plane"], PEAK, "z_m", "x_m", column))
    depth, r, on_fem = _below(pair.film, *_rows(pair.fem.tables["plane"], PEAK, "z_m", "x_m", column))
    xs, zs, grid = gridded(x, z, on_sam)
    reach = WITHIN * pair.radius
    use = (np.abs(r) <= min(reach, xs.max())) & (depth <= min(reach, zs.max()))
    use &= depth >= max(zs.min(), pair.top)
    if "punch" in pair.kinds:
        use &= np.hypot(r - pair.radius, depth) > EDGE_ZONE * pair.radius
    if not pair.kinds & SIDES:
        grid = (grid + grid[::-1]) / 2
    if pair.plastic:
        between = RectBivariateSpline(xs, zs, grid, s=0).ev(r[use], depth[use])
    else:
        between = RegularGridInterpolator((xs, zs), grid)((r[use], depth[use]))
    return between, on_fem[use], np.ones_like(r[use])


FIELDS: Mapping[str, Callable] = {
    "p_Pa over the contact": _pressure,
    "p_Pa as means over a/4": _means,
    "uz_m on the line": _displacement,
    "mises_Pa on the axis": partial(_axis, column="mises_Pa"),
    "mises_Pa in the plane y = 0": partial(_plane, column="mises_Pa"),
    "peeq on the axis": partial(_axis, column="peeq"),
    "peeq in the plane y = 0": partial(_plane, column="peeq"),
    "residual uz_m on the line": partial(_displacement, state=UNLOADED),
    "residual mises_Pa on the axis": partial(_axis, column="mises_Pa", state=UNLOADED),
}

# fields of rough bodies


def _spots(pair: Pair) -> list[Spot]:
    """None where a table is missing: its rows fail by themselves."""
    try:
        return spots(*(solved.tables for solved in pair.both))
    except (KeyError, ValueError):
        return []


def _spot_row(pair: Pair, spot: Spot, limit: Limit) -> Verdict:
    """The row of the load of a spot, a field of one value."""
    name = f"{SPOT} at {spot.x * 1e6:.2f}, {spot.y * 1e6:.2f} um"
    return field_row(pair, name, lambda _: (np.array([spot.sam]), np.array([spot.fem]), np.ones(1)), limit)


def _patch(pair: Pair):
    own, fem = (patch_pressure(solved.tables)[-1] for solved in pair.both)
    return own, fem, np.ones_like(fem)


def _residual(pair: Pair):
    """At the cells of SAM."""
    (x, own), (nodes, fem) = (_rows(each.tables["line"], UNLOADED, "x_m", "uz_m") for each in pair.both)
    return own, np.interp(x, nodes, fem), np.ones_like(x)


ROUGH: Mapping[str, Callable] = {"p_Pa over the patch": _patch, "residual uz_m on the line": _residual}

# tolerances that a user gives

IN_SCENE, ASKED = "[compare] tolerances", "the option or argument tolerance"


@dataclass(frozen=True)
class Tolerances:
    """Name of a row, of a spot without its place -> its tolerance, and who gave it."""

    values: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)

    def judged(self, rows: Sequence[Verdict]) -> list[Verdict]:
        """The rows with these tolerances, and who gave each at the head of its reason."""
        return [self._judged(row) for row in rows]

    def _judged(self, row: Verdict) -> Verdict:
        name = row.quantity.partition(" at ")[0]  # of a spot: without its place
        if name not in self.values or row.row.metric == CLAIM:
            return row
        given = self.values[name]
        reason = f"given by {self.sources[name]}; without it {row.row.tolerance:g}: {row.row.reason}"
        changed = row.row.model_copy(update={"tolerance": given, "reason": reason})
        return replace(row, row=changed, status=RowStatus.PASSED if row.error <= given else RowStatus.FAILED)


def tolerances_of(scene: Scene, given: Mapping[str, object], source: str) -> Tolerances:
    """Those of the scene, and `given` in their place where both have one. given: name -> a number, or a text
    such as "2 %". Raises SceneError with every name that no row of the scene has, and every value that is no
    tolerance; source names the scene in it.
    """
    known, faults = names_of_rows(scene), []
    of_scene = (scene.compare.tolerances if scene.compare else None) or {}
    for where, names in (("compare.tolerances", of_scene), ("tolerances", given)):
        for name in names:
            if name not in known:
                allowed = unknown("quantity", [name], known, f"this scene has {', '.join(known)}")
                faults.append(Problem(f"{where}.{name}", spelling(names[name]), allowed))
    values = dict(of_scene)
    try:
        values |= Compare(tolerances=dict(given)).tolerances
    except ValidationError as error:
        faults += problems(error)
    if faults:
        raise SceneError(faults, source)
    return Tolerances(values, dict.fromkeys(of_scene, IN_SCENE) | dict.fromkeys(given, ASKED))
