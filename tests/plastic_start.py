# SPDX-License-Identifier: MIT
"""The start of an elasto-plastic load history in SAM, for tests of single steps and of the first box."""

from __future__ import annotations

from collections.abc import Callable

import sam
import sam.plasticity.history as solution
from sam.contact.convolution import Counters
from sam.elastic.problem import elastic_peak
from sam.grid.cells import Window
from sam.plasticity import Extent, Model, Progressed
from sam.plasticity.history import begun, first_box
from sam.plasticity.model import model_of
from sam.scene import Scene


def begin(scene: Scene, extent: Callable[[Model], Extent] | None = None) -> tuple[Model, Progressed]:
    """The model of a scene, and the record before its first step, on the scene's first box or another."""
    plan = sam.plan(scene)
    model = model_of(plan, plan.problem(Counters()))
    if extent is not None:
        return model, begun(model, [], extent(model))
    peak = elastic_peak(model, plan.schedule.peak)
    return model, begun(model, [], first_box(model, peak))


def shrink_first_box(monkeypatch, *, x: int, y: int, less: int, layers: int) -> None:
    """Let every history begin on a box that begins x and y cells later, and is `less` cells narrower."""
    first = solution.first_extent

    def small(*arguments, **keys) -> Extent:
        window = first(*arguments, **keys).window
        inner = Window(window.i0 + x, window.j0 + y, window.nx - less, window.ny - less)
        return Extent(inner, layers)

    monkeypatch.setattr(solution, "first_extent", small)
