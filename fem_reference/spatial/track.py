# SPDX-License-Identifier: MIT
"""The track of a counter-body that moves: what drives it in every step, the groove along the path, a section
across it, and what each pass adds; with the columns of sam.scene.result, in SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import Any

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import Step
from fem_reference.common.recovery import parabola_peak
from fem_reference.common.tables import columns
from fem_reference.spatial.model import Model
from fem_reference.spatial.recovery import Stresses, at_zero, stresses
from sam.scene.groove import Groove, passes_to_steady, steady_part
from sam.scene.result import CROSS, PASSES, PATH_HISTORY, PATH_QUANTITIES, TRACK, UNLOADED, Table

XX, YY, XZ = 0, 1, 4  # of the order 11 22 33 23 13 12


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
class Track:
    """The path of a model, in m."""

    model: Model

    @cached_property
    def ends(self) -> Array:
        """(2, 2) start and end."""
        return self.model.plan.sliding.places[[0, -1]] * self.model.scales.length

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
        return bool(self.ends[0, 1] == self.ends[1, 1]) and not self.plane

    @property
    def plane(self) -> bool:
        """Whether the counter-body is a rough plane, below which every place counts as steady."""
        patch = self.model.plan.patch
        return patch is not None and patch.radii is None

    @property
    def y(self) -> float:
        """Of a path along x, in the units of the model."""
        return float(self.model.plan.sliding.places[0, 1])

    def way(self, x: Array | float) -> Array:
        """Distances of places on a path along x from its start."""
        return (np.asarray(x) - self.ends[0, 0]) * self.direction[0]

    def steady(self, way: Array) -> Bools:
        """Whether these distances lie in the steady part."""
        if self.plane:
            return np.ones(np.shape(way), dtype=bool)
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
        model, unit, place = self.model, self.model.scales, np.array([state.load.x, state.load.y])
        way = float(self.direction @ (place * unit.length - self.ends[0]))
        forces = model.on_surface(state.multipliers) / model.part
        total = float(forces.sum())
        if state.force == 0.0 or total == 0.0:
            return Driven(way, 0.0, nan, nan)
        rolling = float((forces * model.slope(state.load, self.direction)).sum()) / total
        about = np.zeros(2) if self.plane else place
        offsets = (line - at for line, at in zip((model.lines.x, model.lines.y), about, strict=True))
        x, y = np.meshgrid(*offsets, indexing="ij")
        if model.lines.half:
            y = np.zeros_like(y)  # the other half has the opposite sign
        tx, ty = self.direction
        friction = float((forces * tx * model.ratio(state)).sum()) / total
        offset = float((forces * (tx * x + ty * y)).sum()) / total * unit.length
        newtons = total * unit.pressure * unit.length**2
        return Driven(way, newtons * (rolling + friction), rolling, offset)

    def surface(self, state: Equilibrium) -> Array:
        """(nx + 1, ny + 1) displacement of the surface in m."""
        dofs = self.model.body.basis.nodal_dofs[2][self.model.surface]
        return state.u[dofs] * self.model.scales.displacement

    def along(self, values: Array) -> Array:
        """(nx + 1,) of those (nx + 1, ny + 1) at the nodes, on the path."""
        return np.array([np.interp(self.y, self.model.lines.y, row) for row in values])

    def across(self, values: Array) -> Array:
        """(ny + 1,) of those at the nodes, in the middle of the steady part."""
        x = self.model.lines.x * self.model.scales.length
        return np.array([np.interp(self.middle, x, column) for column in values.T])

    def groove(self, state: Equilibrium) -> Groove:
        """The groove of the unloaded surface."""
        uz, way = self.surface(state), self.way(self.model.lines.x * self.model.scales.length)
        order, along = np.argsort(way), self.along(uz)
        way, along = way[order], along[order]
        k = int(np.clip(along.argmax(), 1, along.size - 2))
        depth, place = parabola_peak(way[k - 1 : k + 2], along[k - 1 : k + 2])
        steady, across = self.steady(way), self.across(uz)
        return Groove.of(way, along, steady, self.length, across=across, peak=(place, depth))


def path_results(
    model: Model, steps: Sequence[Step], states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> tuple[dict[str, Table], dict[str, float | None]]:
    """Columns of the history, the tables track, cross and passes, and PATH_QUANTITIES."""
    track, solved = Track(model), [step for step in steps if step.state.converged]
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
            tables["track"] = _track(track, states[UNLOADED], fields[UNLOADED])
            tables["cross"] = _cross(track, states[UNLOADED], fields[UNLOADED])
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
    rows, before = [], np.zeros(track.model.elements.shape)
    for cycle, driven in ways.items():
        last = [step.state for step in steps if step.cycle == cycle][-1]
        peeq, lengths = stresses(track.model, last).peeq, (nan,) * 4
        if track.along_x and last.force == 0.0:
            groove = track.groove(last)
            lengths = groove.middle, groove.at_start, groove.at_end, groove.beside
        added = peeq - before
        if track.along_x:
            x = track.model.lines.x * track.model.scales.length
            added = added[track.steady(track.way(0.5 * (x[1:] + x[:-1])))]
        rows.append((cycle, _sense(driven), *lengths, float(added.max(initial=0.0)), *_mean(track, driven)))
        before = peeq
    return {name: [row[k] for row in rows] for k, name in enumerate(PASSES)}


def _track(track: Track, state: Equilibrium, s: Stresses) -> Table:
    """Along the path at the surface nodes: the top layer and the most strained one."""
    model, x = track.model, track.model.lines.x * track.model.scales.length
    plane = at_zero(s.stress, model.lines.y - track.y, 2)
    inside = track.steady(track.way(s.x))
    strain = np.maximum(s.peeq.max(axis=1), s.plane_peeq if track.y == 0.0 else 0.0)
    layer = int((strain[inside] if inside.any() else strain).max(axis=0).argmax())
    values: dict[str, Any] = {
        "x_m": x,
        "uz_m": track.along(track.surface(state)),
        "peeq_max": np.interp(x, s.x, strain.max(axis=1)),
        "steady": track.steady(track.way(x)).astype(int),
    }
    for place, k in (("top", 0), ("deep", layer)):
        values[f"{place}_z_m"] = s.z[k]
        for name, component in (("sxx", XX), ("syy", YY), ("sxz", XZ)):
            values[f"{place}_{name}_Pa"] = np.interp(x, s.x, plane[component][:, k])
    return columns(TRACK, [values[name] for name in TRACK])


def _cross(track: Track, state: Equilibrium, s: Stresses) -> Table:
    """The elements in the plane x = const in the middle of the steady part, z running first."""
    model = track.model
    line = model.lines.x - track.middle / model.scales.length
    stress, peeq = at_zero(s.stress, line, 1), np.maximum(at_zero(s.peeq, line, 0), 0.0)
    y, z = np.meshgrid(s.y, s.z, indexing="ij")
    uz = np.interp(s.y, model.lines.y * model.scales.length, track.across(track.surface(state)))
    components = stress.reshape(6, -1)
    values = [y.ravel(), z.ravel(), np.repeat(uz, s.z.size), peeq.ravel(), mises(components), *components]
    return columns(CROSS, values)
