# SPDX-License-Identifier: MIT
"""The load schedule of a scene, and the pressure that it may give in place of a force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sam.elastic.given import GivenHertz
from sam.scene import Loading, Scene
from sam.scene.section import stated
from sam.schedule import Load, Schedule, Target


def given_pressure_of(scene: Scene) -> GivenHertz | None:
    """The pressure that a scene gives; None if a counter-body is pressed on."""
    loading = scene.loading
    return GivenHertz(stated(loading.p0), stated(loading.radius)) if loading.hertz else None


def schedule_of(scene: Scene) -> Schedule:
    """All load steps of a scene, unloading in one."""
    loading, given = scene.loading, given_pressure_of(scene)
    alternates = scene.friction is not None and scene.friction.direction == "alternating"
    counter = scene.counter_surface
    empty = Schedule(
        (),
        _peak_of(loading, given),
        loading.unload_steps or loading.steps,
        _path_of(scene),
        loading.cycles,
        alternates,
        renews=counter is not None and counter.renewed,
    )
    cycles = range(1, loading.cycles + 1)
    targets = [target for cycle in cycles for target in _targets_of_cycle(scene, empty, cycle)]
    return replace(empty, targets=tuple(targets))


def _peak_of(loading: Loading, given: GivenHertz | None) -> Load:
    """The largest load."""
    if loading.misfit_sphere:
        return Load(0.0, misfit=1.0)
    if loading.approach is not None:
        return Load.by_approach(loading.approach)
    return Load(stated(loading.force) if given is None else given.peak_force)


def _path_of(scene: Scene) -> tuple[tuple[float, float], ...]:
    """Places of the load after each step at full size, the start first, (x, y) in m; the origin alone without
    path.
    """
    path = scene.loading.path
    if path is None:
        return ((0.0, 0.0),)
    shares = np.arange(path.steps + 1) / path.steps
    (x0, y0), (x1, y1) = path.start, path.end
    return tuple((float(x0 + share * (x1 - x0)), float(y0 + share * (y1 - y0))) for share in shares)


def _note(loading: Loading, load: Load) -> str:
    """What the history has no column for."""
    return f"misfit strain {stated(loading.misfit) * load.misfit:.6g}" if loading.misfit_sphere else ""


def _targets_of_cycle(scene: Scene, schedule: Schedule, cycle: int) -> list[Target]:
    """Loading, at the start of the path if there is one, the way along it, and unloading."""
    loading, places = scene.loading, schedule.path
    sign, stretch = schedule.sign_of(cycle), schedule.stretch_of(cycle)
    last = cycle == loading.cycles
    start, *along = (replace(schedule.peak, sign=sign, x=x, y=y, stretch=stretch) for x, y in places)
    up = [start.part(k, loading.steps) for k in range(1, loading.steps + 1)]
    targets = [Target(cycle, k, load, True, note=_note(loading, load)) for k, load in enumerate(up, start=1)]
    for k, load in enumerate(along, start=loading.steps + 1):
        targets.append(Target(cycle, k, load, True, note=f"load at x = {load.x:.6g} m, y = {load.y:.6g} m"))
    if last:
        targets[-1] = replace(targets[-1], snapshot="peak")
    if loading.unload or not last:
        name, zero = "unloaded" if last else "", Load(0.0, sign, *places[-1], stretch=stretch)
        targets.append(Target(cycle, len(targets) + 1, zero, False, name, elastic_unloading=True))
    return targets
