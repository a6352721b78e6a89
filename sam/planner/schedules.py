# SPDX-License-Identifier: MIT
"""The load schedule of a scene, and the pressure that it may give in place of a force."""

from __future__ import annotations

from dataclasses import replace

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
    loading, given, strokes = scene.loading, given_pressure_of(scene), scene.strokes
    counter = scene.counter_surface
    empty = Schedule(
        (),
        _peak_of(loading, given),
        loading.unload_steps or loading.steps,
        strokes.places(),
        loading.cycles,
        strokes.of_cycle(2).sign != strokes.of_cycle(1).sign,
        renews=counter is not None and counter.renewed,
        returns=loading.path is not None and loading.path.to_and_fro,
        remembers=scene.moves and scene.friction is not None and scene.friction.film,
        varies=scene.moves and scene.patch_surface is not None,
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


def _note(loading: Loading, load: Load) -> str:
    """What the history has no column for."""
    return f"misfit strain {stated(loading.misfit) * load.misfit:.6g}" if loading.misfit_sphere else ""


def _targets_of_cycle(scene: Scene, schedule: Schedule, cycle: int) -> list[Target]:
    """Loading, at the start of the path if there is one, the way along it, and unloading."""
    loading, stroke, last = scene.loading, scene.strokes.of_cycle(cycle), cycle == scene.loading.cycles
    sign, stretch, places = stroke.sign, schedule.stretch_of(cycle), stroke.places
    start, *along = (replace(schedule.peak, sign=sign, x=x, y=y, stretch=stretch) for x, y in places)
    up = [start.part(k, loading.steps) for k in range(1, loading.steps + 1)] if stroke.pressed else []
    targets = [Target(cycle, k, load, True, note=_note(loading, load)) for k, load in enumerate(up, start=1)]
    for k, load in enumerate(along, start=len(up) + 1):
        note = f"load at x = {load.x:.6g} m, y = {load.y:.6g} m" if scene.counterbody is None else ""
        targets.append(Target(cycle, k, load, True, note=note))
    if last:
        targets[-1] = replace(targets[-1], snapshot="peak")
    if stroke.unloads:
        name, zero = "unloaded" if last else "", Load(0.0, sign, *places[-1], stretch=stretch)
        targets.append(Target(cycle, len(targets) + 1, zero, False, name, elastic_unloading=True))
    return targets
