# SPDX-License-Identifier: MIT
"""Load steps, cycles and states: a record of each, and the tables of steps and cycles; what friction, a
coating and an offset contact add to a state.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sam.arrays import Array, Mask
from sam.contact.normal import Contact
from sam.grid.cells import CellGrid, Sides, Window, at_edge
from sam.scene import Status
from sam.scene.result import CYCLES, HISTORY, LOOPS, PATH_HISTORY, Attempt
from sam.scene.surface import Roughness
from sam.schedule import Coefficient, Target

SHEAR = 4  # index of the component 13 in the order 11 22 33 23 13 12


@dataclass(frozen=True)
class Sliding:
    """What friction adds to a state: traction q_x, (nx, ny) in Pa; in the rows at y = 0, (nx, rows)
    in m, ux, residual_ux of the plastic strain, uz beyond its share, and shear, -integral of 2
    eps_p_13.
    """

    traction: Array
    ux: Array
    residual_ux: Array
    uz: Array
    shear: Array

    def strained(self, residual_ux: Array, strain: Array, thickness: Array) -> Sliding:
        """The same with plastic strain, (6, nz, nx, rows), in layers of these thicknesses in m."""
        shear = -2 * np.tensordot(thickness, strain[SHEAR], axes=1)
        return Sliding(self.traction, self.ux + residual_ux, residual_ux, self.uz, shear)


@dataclass(frozen=True)
class Cut:
    """The plane y = const (m) through the largest pressure; x, z in m, stress (6, nz, nx) in Pa, peeq."""

    y: float
    x: Array
    z: Array
    stress: Array
    peeq: Array


def row_of_largest(contact: Contact, counts: Window) -> int | None:
    """The row of cells j with the largest pressure among the cells that count; None without contact."""
    inner = contact.pressure[counts.slices]
    return int(np.unravel_index(inner.argmax(), inner.shape)[1]) + counts.j0 if inner.any() else None


@dataclass(frozen=True)
class Comparison:
    """The bare body under the same load: p_max, von Mises stress (nz, n) in Pa, or a warning."""

    p_max: float | None = None
    mises: Array | None = None
    warning: str = ""


@dataclass(frozen=True)
class Coated:
    """What a coating adds to a state; counter_uz: (nx, rows) in m; comparison: with the bare body."""

    thickness: float
    counter_uz: Array
    comparison: Comparison | None = None


@dataclass(frozen=True)
class Box:
    """The cells that may yield: faces x, y, z in m; stress in Pa, strain (6, nz, nx, ny), peeq."""

    x: Array
    y: Array
    z: Array
    stress: Array
    strain: Array
    peeq: Array
    repeated: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Snapshot:
    """A state that goes into the tables. contact: on the full grid; residual_displacement: (nx, ny)
    in m; stress in Pa, strain: plastic, (6, nz, nx, rows), peeq: (nz, nx, rows) in the rows at y =
    0; mises: (nz, n) in Pa, among which the largest is; flowed: with plastic strain; top: depth in
    m and value of the largest peeq; worn in m; None for what a scene has not; repeated: by name.
    """

    state: str
    contact: Contact
    residual_displacement: Array
    stress: Array
    strain: Array
    peeq: Array
    mises: Array
    flowed: Mask | None = None
    sliding: Sliding | None = None
    coated: Coated | None = None
    top: tuple[float, float] | None = None
    worn: Array | None = None
    cut: Cut | None = None
    box: Box | None = None
    stretch: int = 0
    place: tuple[float, float] = (0.0, 0.0)
    repeated: Mapping[str, Array] = field(default_factory=dict)

    @property
    def friction(self) -> float:
        """Size of the sum of q over the sum of p; zero where either is."""
        if self.sliding is None or not self.contact.pressure.any():
            return 0.0
        return abs(float(self.sliding.traction.sum() / self.contact.pressure.sum()))

    @property
    def local_friction(self) -> Array:
        """|q|/p of each cell, (nx, ny); not a number out of contact."""
        p = self.contact.pressure
        if self.sliding is None:
            return np.where(p > 0, 0.0, np.nan)
        out = np.full(p.shape, np.nan)
        np.divide(np.abs(self.sliding.traction), p, out=out, where=p > 0)
        return out

    @property
    def in_plane(self) -> Array:
        """Stress in y = 0, the mean of the rows, (6, nz, nx) in Pa."""
        return self.stress.mean(axis=-1)


OUTERMOST, HALFWAY = 0.785, 1.866
"""Of `contact_area`. Fitted to the areas of 42 contacts of Hertz of 4 to 28 cells in the radius, the apex
anywhere in a cell; with a range and an exponent of its own the fit finds one cell, as it must be, and 1.07.
"""

OF_ROW = "cycle step force approach area p_max peeq_max friction iterations residual note".split()
OF_CYCLE = ("new_strain_max", "yielding_cells", "wear_of_cycle_m3")  # zero of a body that stays elastic


@dataclass(frozen=True)
class Moved:
    """Of a moving counter-body: way from the start, force, offset of the pressure; m and N."""

    way: float
    force: float
    offset: float
    at_edge: bool = False


@dataclass(frozen=True)
class PassEnd:
    """What a pass over a path leaves; lengths as of `sam.scene.verdict`; drive: mean force in N."""

    cycle: int
    direction: int
    depth: float = np.nan
    at_start: float = np.nan
    at_end: float = np.nan
    beside: float = np.nan
    strain: float = 0.0
    drive: float = np.nan
    rolling: float = np.nan


@dataclass(frozen=True)
class Row:
    """One load step. ending: of its contact, if that did not converge; moved: of a moving counter-body."""

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
    moved: Moved | None = None


def row_of(
    grid: CellGrid, target: Target, contact: Contact, *, coefficient: Coefficient, whole: float | None = None
) -> Row:
    """The row of a contact; coefficient: of friction, without sign; whole: that under a whole film."""
    friction, protected, p = 0.0, None, contact.pressure
    if contact.force:
        varies = np.ndim(coefficient) > 0
        friction = float((coefficient * p).sum() / p.sum()) if varies else float(coefficient)
        if whole is not None:
            low = np.asarray(coefficient) <= whole
            protected = float(low[p > 0].mean())
    return Row(
        target.cycle,
        target.step,
        contact.force,
        contact.approach,
        contact_area(contact, grid),
        largest_pressure(contact, grid),
        contact.converged,
        friction=friction,
        protected=protected,
        ending=contact.ending,
    )


def counted(contact: Contact, grid: CellGrid) -> Window:
    """The cells that count for maxima: all but a border, once the contact touches the edge."""
    touching, (bx, by) = contact.pressure > 0, grid.border
    if not at_edge(touching, grid.line):
        bx = by = 0
    return Window(bx, by, grid.nx - 2 * bx, grid.ny - 2 * by)


def largest_pressure(contact: Contact, grid: CellGrid) -> float:
    """The largest pressure in Pa, over the cells that count."""
    return float(contact.pressure[counted(contact, grid).slices].max())


def contact_area(contact: Contact, grid: CellGrid) -> float:
    """Area in m^2 within an outline between the cells with p > 0 and the others. q = gap E*/(p h)
    of two neighbours tells where between them the edge is (Johnson 1985, Sec. 4.2), h being the
    distance of lines of centres along it, in other cells than square ones of a second pass.
    Straight lines join these places in squares of four centres, arcs add to corners; at an end of
    the grid it is halfway, unless that repeats.
    """
    if contact.area is not None:
        return contact.area
    hx, hy = grid.hx, grid.hy
    compliance = 2 / np.pi * (hx * np.arcsinh(hy / hx) + hy * np.arcsinh(hx / hy))  # times E*, Love 1929
    p, gap = contact.pressure, contact.gap
    for axis, wraps in enumerate(grid.wraps):  # of neighbours across a border each pair once
        width = [(int(not wraps), 1) if each == axis else (0, 0) for each in (0, 1)]
        p = np.pad(p, width, mode="wrap") if wraps else np.pad(p, width)
        gap = np.pad(gap, width, mode="wrap") if wraps else np.pad(gap, width, constant_values=np.inf)
    unit, mean = HALFWAY * contact.compliance / compliance, np.array(2 / (1 / hx + 1 / hy))
    along_x, along_y = _shares(p, gap, unit * mean), _shares(p.T, gap.T, unit * mean).T
    if hx != hy:
        normal = np.diff(along_y, axis=0), np.diff(along_x, axis=1)
        h_x, h_y = (_distances(normal, axis, (hx, hy)) for axis in (1, 0))
        along_x, along_y = _shares(p, gap, unit * h_x), _shares(p.T, gap.T, unit * h_y.T).T
    two_x, two_y = along_x[:, :-1] + along_x[:, 1:], along_y[:-1] + along_y[1:]
    touching = sliding_window_view(p > 0, (2, 2)).sum(axis=(2, 3))
    squares = np.where(touching <= 2, two_x * two_y / 2, 1 - (2 - two_x) * (2 - two_y) / 2)
    corners = np.count_nonzero(touching == 1) - np.count_nonzero(touching == 3)
    return float((squares.sum() + corners / 8) * hx * hy)


def _shares(p: Array, gap: Array, unit: Array) -> Array:
    """Of the line to each next cell along the first axis, the share in contact; unit: of gap over p."""
    first, second = p[:-1] > 0, p[1:] > 0
    inside, outside = np.where(first, p[:-1], p[1:]), np.where(first, gap[1:], gap[:-1]).clip(0.0)
    share = (first & second).astype(float)
    edge, ended = first != second, np.isinf(outside)
    share[edge & ended] = 0.5
    edge &= ~ended
    scale = np.broadcast_to(unit, share.shape)[edge] * inside[edge]
    share[edge] = OUTERMOST - outside[edge] / (outside[edge] + scale)
    return share


def _distances(normal: tuple[Array, Array], axis: int, cell: tuple[float, float]) -> Array:
    """In m, of lines of centres along the outline (normal in cells) at each line to a next cell."""
    width = [(1, 1) if each == axis else (0, 0) for each in (0, 1)]
    u, v = (sliding_window_view(np.pad(part, width), 2, axis).sum(axis=-1) for part in normal)
    reach, distance = np.hypot(u / cell[0], v / cell[1]), np.full(u.shape, min(cell))
    np.divide(np.hypot(u, v), reach, out=distance, where=reach > 0)
    return distance


def history_table(rows: Sequence[Row]) -> dict[str, list[Any]]:
    """The table history, one row a load step."""
    table = {name: [getattr(row, each) for row in rows] for name, each in zip(HISTORY, OF_ROW, strict=True)}
    moved = [row.moved for row in rows if row.moved is not None]
    if moved:
        of_path = zip(PATH_HISTORY, ("way", "force", "offset"), strict=True)
        table |= {name: [getattr(each, field) for each in moved] for name, field in of_path}
    return table


@dataclass(frozen=True)
class CycleEnd:
    """The surface after a cycle: wear_volume so far in m^3; roughness, None if smooth; new_strain,
    yielding: the largest and in how many cells; dissipated in J; wear_of_cycle, roofed, raw, roof, filled
    in m^3, see `WearState`; yield_excess, flow_residual: the largest that a load step leaves;
    margin: of the cell nearest to its limit; moved, worn: (nx, ny) in m, None without.
    """

    cycle: int
    wear_volume: float
    roughness: Roughness | None
    applications: int
    moved: Array | None = None
    worn: Array | None = None
    new_strain: float = 0.0
    yielding: int = 0
    wear_of_cycle: float = 0.0
    margin: float | None = None
    roofed: float = 0.0
    raw: float = 0.0
    roof: float = 0.0
    filled: float = 0.0
    yield_excess: float = 0.0
    flow_residual: float = 0.0
    dissipated: float = 0.0


def cycles_table(
    rows: Sequence[Row],
    ends: Sequence[CycleEnd],
    *,
    at_peak: Callable[[int, int], bool],
    roughness: Roughness | None = None,
) -> dict[str, list[Any]]:
    """The table cycles: a row for each cycle that came to its peak; None for what there is not."""
    peaks: dict[int, Row] = {}
    for row in rows:
        if at_peak(row.cycle, row.step):
            peaks[row.cycle] = row
    same: dict[str, Any] = dict.fromkeys(("wear_volume_m3", "sa_m", "sq_m"), 0.0)
    same |= dict.fromkeys(("operator_applications", *OF_CYCLE), 0)
    same |= _heights_of(roughness)
    table: dict[str, list[Any]] = {name: [same.get(name)] * len(peaks) for name in CYCLES}
    table["cycle"] = list(peaks)
    table["friction_coefficient"] = [row.friction for row in peaks.values()]
    table["peeq_max"] = [row.peeq_max for row in peaks.values()]
    table["p_max_Pa"] = [row.p_max for row in peaks.values()]
    before = 0
    for end in ends:
        table["operator_applications"][end.cycle - 1], before = end.applications - before, end.applications
        table["wear_volume_m3"][end.cycle - 1] = end.wear_volume
        numbers = end.new_strain, end.yielding, end.wear_of_cycle, end.margin
        for name, value in zip((*OF_CYCLE, "margin_to_limit"), numbers, strict=True):
            table[name][end.cycle - 1] = value
        for name, value in _heights_of(end.roughness).items():
            table[name][end.cycle - 1] = value
    table["protected_fraction"] = [row.protected for row in peaks.values()]
    return table


def of_ends(cycles: Sequence[int], ends: Sequence[CycleEnd], name: str) -> list[float | None]:
    """A number of CycleEnd for each cycle; zero of an elastic body, None of a cycle that did not end."""
    values = {end.cycle: getattr(end, name) for end in ends}
    return [values.get(cycle) if values else 0.0 for cycle in cycles]


def _heights_of(roughness: Roughness | None) -> Mapping[str, float | None]:
    return {"sa_m": roughness.sa, "sq_m": roughness.sq, "ssk": roughness.ssk} if roughness is not None else {}


@dataclass(frozen=True)
class LoopRow:
    """A cell (layer, i, j) at the end of a load step; stress in Pa and plastic strain, both (6,)."""

    place: tuple[int, int, int]
    cycle: int
    step: int
    peeq: float
    stress: tuple[float, ...]
    strain: tuple[float, ...]


def loops_table(grid: CellGrid, rows: Sequence[LoopRow]) -> dict[str, list[Any]]:
    """The table loops; points are numbered from 1, the one that strains most first."""
    places = list(dict.fromkeys(row.place for row in rows))
    values = []
    for row in sorted(rows, key=lambda row: places.index(row.place)):
        layer, i, j = row.place
        where = float(grid.x[i]), float(grid.y[j]), float(grid.depths[layer])
        number = places.index(row.place) + 1
        values.append((number, *where, row.cycle, row.step, row.peeq, *row.stress, *row.strain))
    return {name: [value[k] for value in values] for k, name in enumerate(LOOPS)}


@dataclass(frozen=True)
class History:
    """What is recorded of a load history: rows of load steps; snapshots by state; ends of cycles;
    passes; loops of three cells; status; reached: sides of the grid; ending in words; certificate:
    residuals at the peak; unfinished: cycle, step and attempts; floor: strain of no plastic strain.
    """

    rows: tuple[Row, ...] = ()
    snapshots: Mapping[str, Snapshot] = field(default_factory=dict)
    ends: tuple[CycleEnd, ...] = ()
    passes: tuple[PassEnd, ...] = ()
    loops: tuple[LoopRow, ...] = ()
    status: Status = Status.CONVERGED
    reached: Sides = field(default_factory=Sides)
    ending: str = ""
    certificate: Mapping[str, float] = field(default_factory=dict)
    discretisation: Mapping[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    unfinished: tuple[tuple[int, int, tuple[Attempt, ...]], ...] = ()
    floor: float = 0.0
