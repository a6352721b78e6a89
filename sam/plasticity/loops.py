# SPDX-License-Identifier: MIT
"""Stress and plastic strain of three cells over the last period of a repeated load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sam.plasticity.model import Model
from sam.plasticity.progress import Progressed
from sam.plasticity.state import Trial, surrounded
from sam.results.loops import LoopRow
from sam.scene.verdict import last_period, loop_places
from sam.schedule import Target


def with_loops(model: Model, now: Progressed, target: Target, trial: Trial) -> Progressed:
    """The record with the cells at the end of a step, if it belongs to the last period or ends the one
    before.
    """
    if model.judging is None or not now.periods.last:
        return now
    period, ends = last_period(model.judging, model.schedule.cycles), now.periods.begun is None
    if not (target.cycle in period or (target.cycle == period.start - 1 and ends)):
        return now
    rows = now.measured.loops
    places = [row.place for row in rows[:3]] if rows else _chosen(now)
    own = now.extent.window
    at = [(layer, i - own.i0, j - own.j0) for layer, i, j in places]
    material = now.state.material
    found = [
        LoopRow(
            place,
            target.cycle,
            target.step,
            float(material.peeq[cell]),
            tuple(trial.stress[(slice(None), *cell)].tolist()),
            tuple(material.strain[(slice(None), *cell)].tolist()),
        )
        for place, cell in zip(places, at, strict=True)
    ]
    return replace(now, measured=replace(now.measured, loops=(*rows, *found)))


def _chosen(now: Progressed) -> list[tuple[int, int, int]]:
    """Layer and cells of the grid of the cells, see `loop_places`."""
    extent, own, last = now.extent, now.extent.window, now.periods.last[-1]
    accumulated = surrounded(last.accumulated, last.extent.inside(extent), extent.shape)
    places = loop_places(accumulated.ravel(), now.state.material.peeq.ravel())
    found = [np.unravel_index(place, extent.shape) for place in places]
    return [(int(layer), int(i) + own.i0, int(j) + own.j0) for layer, i, j in found]
