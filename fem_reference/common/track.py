# SPDX-License-Identifier: MIT
"""The path of a counter-body that moves, in space and in a section: what drives it in every step, and what
each pass adds; with the columns of sam.scene.result, in SI units.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import Any

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.loading import Step
from fem_reference.common.recovery import parabola_peak
from fem_reference.common.tables import columns
from sam.scene.result import PASSES, PATH_HISTORY, PATH_QUANTITIES, TRACK, UNLOADED, Table
from sam.scene.verdict import Groove, passes_to_steady, steady_part


@dataclass(frozen=True)
class Driven:
    """Of a solved step. way: from the start of the path in m; force: along the path in N that drives the
    counter-body; rolling: the part of it that the pressure makes, over the normal force; offset: of the
    centroid of the pressure from the apex along the path in m; the last two not numbers without force.
    """

    way: float
    force: float
    rolling: float
    offset: float


@dataclass(frozen=True)
class Track(ABC):
    """The path of a model, in m."""

    model: Any

    @cached_property
    def ends(self) -> Array:
        """(2, 2) start and end."""
        return np.asarray(self.model.plan.sliding.places[[0, -1]] * self.model.scales.length)

    @cached_property
    def length(self) -> float:
        """From start to end."""
        return float(np.hypot(*(self.ends[1] - self.ends[0])))

    @cached_property
    def direction(self) -> Array:
        """(2,) unit vector from start to end."""
        return (self.ends[1] - self.ends[0]) / self.length

    @property
    def along_x(self) -> bool:
        """Whether the groove is measured."""
        return True

    def way(self, x: Array | float) -> Array:
        """Distances of places on a path along x from its start."""
        return (np.asarray(x) - self.ends[0, 0]) * self.direction[0]

    def steady(self, way: Array) -> Bools:
        """Whether these distances lie in the steady part."""
        return steady_part(way, self.model.plan.radius, self.length)

    @cached_property
    def middle(self) -> float:
        """x of the middle of the steady part, in m."""
        inside = np.linspace(0.0, self.length, 1001)
        steady = inside[self.steady(inside)]
        return float(
            self.ends[0, 0] + self.direction[0] * (steady.mean() if steady.size else self.length / 2)
        )

    def driven(self, state: Equilibrium) -> Driven:
        """What drives the counter-body in a state: on its slope the pressure, and friction."""
        unit, place = self.model.scales, np.array([state.load.x, state.load.y])
        way = float(self.direction @ (place * unit.length - self.ends[0]))
        if state.force == 0.0 or not state.multipliers.any():
            return Driven(way, 0.0, nan, nan)
        forces, *parts = self.pressing(state)
        total = float(forces.sum())
        rolling, friction, offset = (float((forces * part).sum()) / total for part in parts)
        newtons = total * unit.pressure * unit.length**2
        return Driven(way, newtons * (rolling + friction), rolling, offset * unit.length)

    @abstractmethod
    def pressing(self, state: Equilibrium) -> tuple[Array, Array, Array, Array]:
        """Whole forces on the nodes; slope of the gap, ratio of the traction, distance from the apex, all
        along the path.
        """

    @abstractmethod
    def profile(self, state: Equilibrium) -> tuple[Array, Array, Array]:
        """x of the nodes on the path and the displacement in m there; that across the path."""

    @abstractmethod
    def strain(self, state: Equilibrium) -> tuple[Array, Array]:
        """Accumulated plastic strain (n, ...), and the places x (n,) in m of it."""

    @abstractmethod
    def tables(self, state: Equilibrium, stresses: Any) -> dict[str, Table]:
        """The tables track and cross of the unloaded state."""

    def groove(self, state: Equilibrium) -> Groove:
        """The groove of the unloaded surface."""
        x, along, across = self.profile(state)
        way = self.way(x)
        order = np.argsort(way)
        way, along = way[order], along[order]
        k = int(np.clip(along.argmax(), 1, along.size - 2))
        depth, place = parabola_peak(way[k - 1 : k + 2], along[k - 1 : k + 2])
        return Groove.of(way, along, self.steady(way), self.length, across=across, peak=(place, depth))


def path_results(
    track: Track, steps: Sequence[Step], states: Mapping[str, Equilibrium], fields: Mapping[str, Any]
) -> tuple[dict[str, Table], dict[str, float | None]]:
    """Columns of the history, the tables track, cross and passes, and PATH_QUANTITIES."""
    solved = [step for step in steps if step.state.converged]
    driven = [track.driven(step.state) for step in solved]
    columns_of = zip(PATH_HISTORY, ("way", "force", "offset"), strict=True)
    tables: dict[str, Table] = {
        "history": {name: [getattr(drive, part) for drive in driven] for name, part in columns_of}
    }
    cycles = sorted({step.cycle for step in solved})
    ways = {c: [d for d, step in zip(driven, solved, strict=True) if step.cycle == c] for c in cycles}
    values: dict[str, float | None] = {}
    if cycles:
        values["rolling_coefficient"] = _sense(ways[cycles[-1]]) * _mean(track, ways[cycles[-1]])[1]
    if solved and solved[-1].state.yielded:
        passes = _passes(track, solved, ways)
        tables["passes"] = passes
        if track.along_x and UNLOADED in states:
            tables |= track.tables(states[UNLOADED], fields[UNLOADED])
            groove = track.groove(states[UNLOADED])  # of the last pass
            values |= {
                "groove_depth_m": groove.depth,
                "groove_deepest_m": groove.deepest,
                "groove_deepest_x_m": float(track.ends[0, 0] + track.direction[0] * groove.deepest_at),
                "shoulder_start_m": groove.at_start,
                "shoulder_end_m": groove.at_end,
                "shoulder_side_m": groove.beside,
                "transient_length_m": groove.transient,
            }
            values["passes_to_steady"] = passes_to_steady(passes["new_strain_max"])
    numbers = {
        name: float(value) for name, value in values.items() if value is not None and not np.isnan(value)
    }
    return tables, {name: numbers.get(name) for name in PATH_QUANTITIES}


def _sense(driven: Sequence[Driven]) -> int:
    """1 of a pass from start to end, -1 of one back."""
    return 1 if driven[-1].way >= driven[0].way else -1


def _mean(track: Track, driven: Sequence[Driven]) -> tuple[float, float]:
    """(mean driving force in N, the part of the pressure over the normal force) in the steady part."""
    inside = [
        (drive.force, drive.rolling)
        for drive in driven
        if not np.isnan(drive.rolling) and track.steady(np.array(drive.way))
    ]
    if not inside:
        return nan, nan
    force, rolling = np.mean(inside, axis=0)
    return float(force), float(rolling)


def _passes(track: Track, steps: Sequence[Step], ways: Mapping[int, Sequence[Driven]]) -> Table:
    """A row for each pass; lengths of a groove only where the pass ends unloaded."""
    rows, before = [], np.zeros(1)
    for cycle, driven in ways.items():
        last = [step.state for step in steps if step.cycle == cycle][-1]
        (peeq, x), lengths = track.strain(last), (nan,) * 4
        if track.along_x and last.force == 0.0:
            groove = track.groove(last)
            lengths = groove.middle, groove.at_start, groove.at_end, groove.beside
        added = peeq - before
        if track.along_x:
            added = added[track.steady(track.way(x))]
        rows.append((cycle, _sense(driven), *lengths, float(added.max(initial=0.0)), *_mean(track, driven)))
        before = peeq
    return {name: [row[k] for row in rows] for k, name in enumerate(PASSES)}


def track_table(
    track: Track, nodes: tuple[Array, Array], points: tuple[Array, Array], fields: Array
) -> Table:
    """Along the path at the surface nodes: the top layer and the most strained one.

    nodes: x in m and u_z, both (n,); points: x (nx,) and z (nz,) in m of fields (4, nx, nz): accumulated
    plastic strain and the stresses xx, yy, xz.
    """
    (x, uz), (at, z), (strain, *stress) = nodes, points, fields
    inside = track.steady(track.way(at))
    layer = int((strain[inside] if inside.any() else strain).max(axis=0).argmax())
    values: dict[str, Any] = {
        "x_m": x,
        "uz_m": uz,
        "peeq_max": np.interp(x, at, strain.max(axis=1)),
        "steady": track.steady(track.way(x)).astype(int),
    }
    for place, k in (("top", 0), ("deep", layer)):
        values[f"{place}_z_m"] = z[k]
        for name, component in zip(("sxx", "syy", "sxz"), stress, strict=True):
            values[f"{place}_{name}_Pa"] = np.interp(x, at, component[:, k])
    return columns(TRACK, [values[name] for name in TRACK])
