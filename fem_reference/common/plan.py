# SPDX-License-Identifier: MIT
"""The plan of a scene: what a finite-element model solves, made once by the planner of its geometry; the
solver executes it and asks the scene nothing. Loads no numerical library but numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, TypeVar

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Bodies, Elastic, coating_of, expected_radius
from fem_reference.common.hertz import Scales, peak_force, relative_moduli
from fem_reference.common.refusals import Advice, advice_of
from fem_reference.common.schedule import Schedule, Sliding, schedule_of
from sam.scene import verdict
from sam.scene.result import NO_FORCE, LeftOut, Stage, left_out_of
from sam.scene.schema import Scene
from sam.scene.section import stated

TRACTION, RETURN_MAP = "tangential traction", "return mapping and plastic history"
LATER_CYCLES, ONE_STEP = "cycles after the first", "elastic: in one step"
AnyPlan = TypeVar("AnyPlan", bound="Plan")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What a finite-element model solves of a scene, in the units of `scales` but where another is named.

    force: normal force at the peak in N; prescribed: the pressure of Hertz, or a misfit strain, is given
    instead of a counter-body; cells_per_radius: elements in the radius of Hertz, as the scene has them;
    fine_cells_per_radius: the same of the mesh, which a contact smaller than that of Hertz makes finer;
    expected: estimate of the radius of the elastic contact at the peak; interface: depth of the lower face
    of the coating, also where the material of the half-space takes its place; elements, unknowns, points:
    elements and degrees of freedom of all bodies, Gauss points of the half-space; stages: what runs, with
    its size, and what does not, with the reason; judging: how repeated loading is judged, None without a
    verdict; dissipates: the energy that each cycle dissipates is asked for; bare: the contact without its
    coating on the same mesh, for comparison.
    """

    model: str
    scales: Scales
    force: float
    bodies: Bodies
    prescribed: bool
    schedule: Schedule
    sliding: Sliding
    cells_per_radius: int
    fine_cells_per_radius: float
    expected: float
    interface: float | None
    elements: int
    unknowns: int
    points: int
    stages: tuple[Stage, ...]
    advice: Advice
    judging: verdict.Judging | None = None
    dissipates: bool = False
    bare: Self | None = None

    def forgets(self, cycle: int) -> bool:
        """Whether no result reads the states inside a cycle: of a moving body, unless judged."""
        judged = self.judging is not None and cycle in verdict.last_period(self.judging, self.schedule.cycles)
        return self.sliding.moves and not judged

    @property
    def left_out(self) -> list[LeftOut]:
        """Stages that the scene does not need, with the reason."""
        return left_out_of(self.stages)


def planned(kind: type[AnyPlan], scene: Scene, units: Scales, **of_geometry: Any) -> AnyPlan:
    """The plan of a scene, with that of the bare contact. of_geometry: its own fields."""
    sliding, bodies = slide(scene, units.length), bodies_of(scene, units)
    expected = 1.0 if scene.patch_surface is not None else expected_radius(scene)
    plan = kind(
        scales=units,
        force=peak_force(scene) if scene.loading.approach is None else units.force,
        bodies=bodies,
        prescribed=scene.loading.prescribed is not None,
        schedule=steps_of(scene, units, bodies, sliding),
        sliding=sliding,
        cells_per_radius=scene.fem.cells_per_radius,
        fine_cells_per_radius=scene.fem.cells_per_radius / min(1.0, expected),
        expected=expected,
        interface=None if bodies.coating is None else bodies.coating.thickness,
        advice=advice_of(scene),
        judging=verdict.judging_of(scene),
        dissipates=verdict.counts_dissipation(scene),
        **of_geometry,
    )
    if bodies.coating is None:
        return plan
    bodies = replace(bodies, coating=None)
    targets = steps_of(scene, units, bodies, sliding).targets
    last = max(i for i, target in enumerate(targets) if not target.unloads)
    steps = Schedule(targets[0 if bodies.yields else last : last + 1])  # of an elastic body the peak alone
    return replace(plan, bare=replace(plan, bodies=bodies, schedule=steps, expected=1.0))


def slide(scene: Scene, length: float) -> Sliding:
    """Friction and path of a scene. length: unit of the model in m."""
    path, strokes, places = scene.loading.path, scene.strokes, np.zeros((1, 2))
    if path is not None:
        places = np.linspace(path.start, path.end, strokes.count + 1) / length
    return Sliding(scene.coefficient, strokes, places)


def bodies_of(scene: Scene, units: Scales) -> Bodies:
    """The bodies of a scene in the units of a model."""
    plasticity, coating = scene.body.plasticity, scene.body.coating
    first, *others = relative_moduli(scene)
    elastic = [Elastic(first, scene.body.poisson)]
    elastic += [Elastic(young, stated(stated(scene.counterbody).poisson)) for young in others]
    bodies = Bodies(tuple(elastic), coating_of(scene, units))
    if coating is not None:
        bodies = replace(bodies, coating_yield=coating.yield_stress)
    if plasticity is not None:
        bodies = replace(bodies, strength=plasticity.strength())
    return bodies


def steps_of(scene: Scene, units: Scales, bodies: Bodies, sliding: Sliding) -> Schedule:
    """The load schedule of a scene for these bodies."""
    elastic, unit = not bodies.yields, units.displacement
    return schedule_of(scene.loading, units.peak_force, elastic=elastic, sliding=sliding, unit=unit)


def section_of(scene: Scene, x: Array, z: Array, words: str) -> dict[str, Any]:
    """Sizes and stages of a plane tensor mesh of 8-node quadrilaterals, as fields of a plan; x, z: lines of
    each body; words: of the mesh.
    """
    counter, columns, rows = scene.counterbody, x.size - 1, z.size - 1
    bodies = 2 if counter is not None and counter.elastic else 1
    nodes = (columns + 1) * (rows + 1) + columns * (rows + 1) + rows * (columns + 1)
    sizes = {"elements": bodies * columns * rows, "unknowns": 2 * bodies * nodes}
    stages = [Stage("mesh", True, words, {**sizes, "bodies": bodies})]
    if bodies > 1:
        words = "elastic: that of the body, turned over"
        stages.append(Stage("mesh of the counter-body", True, words, {"elements": columns * rows}))
    points = 4 * columns * rows
    stresses = Stage("stresses at the Gauss points", True, "at peak load", {"points": points})
    return {**sizes, "points": points, "stages": stages_of(scene, stages, stresses)}


def stages_of(scene: Scene, mesh: Sequence[Stage], stresses: Stage) -> tuple[Stage, ...]:
    """All stages in the order in which they begin, then those that the scene does not need.

    mesh: the first stages; stresses: the last one of the contact, whose size has the Gauss points.
    """
    coating, yields, stages = scene.body.coating, _kind(scene)[0], list(mesh)
    solving, bare = _solving(scene, stresses), []
    if coating is not None:
        kind = "elastic" if coating.yield_stress is None else "perfectly plastic"
        words = f"{kind}, two elements or more through its thickness"
        stages.append(Stage("film elements", True, words, {"thickness_m": coating.thickness}))
        words = "the same contact without the film, for comparison"
        bare = [Stage("bare body", True, words, {"steps": _steps(scene)})]
    if scene.loading.force == 0.0:
        solving, bare = ([Stage(stage.stage, False, NO_FORCE) for stage in some] for some in (solving, bare))
    stages += [*solving, stresses]
    if yields and not verdict.reason_without(scene):
        words = "strains of the unloaded body after each period"
        stages.append(Stage(verdict.VERDICT, True, words, {"periods": verdict.periods_of(scene)}))
    return (*stages, *bare, *(Stage(stage, False, reason) for stage, reason in _left_out(scene)))


def _kind(scene: Scene) -> tuple[bool, int, bool]:
    """Whether anything yields, the number of back-stresses, whether the traction alternates."""
    coating, plasticity, friction = scene.body.coating, scene.body.plasticity, scene.friction
    yields = plasticity is not None or (coating is not None and coating.yield_stress is not None)
    alternating = friction is not None and scene.coefficient > 0.0 and friction.direction == "alternating"
    return yields, 0 if plasticity is None else plasticity.back_stresses, alternating


def _solving(scene: Scene, stresses: Stage) -> list[Stage]:
    """What runs in the load steps."""
    (yields, back_stresses, alternating), loading = _kind(scene), scene.loading
    solving = [_load(scene), *_moving(scene)]
    if scene.coefficient:
        solving.append(Stage(TRACTION, True, "full slip: q = coefficient p along x, in every iteration"))
    if yields:
        reason = "backward Euler, in the iterations of the contact"
        reason += "" if scene.body.plasticity is None else scene.body.plasticity.of_layer
        solving.append(Stage(RETURN_MAP, True, reason, stresses.size))
    if back_stresses:
        words = "exact along a constant direction of flow"
        solving.append(Stage("back-stresses", True, words, {"back_stresses": back_stresses}))
    if loading.cycles > 1 and (yields or alternating):
        words = "each starts from the strain that the others left" if yields else "the traction turns round"
        solving.append(Stage(LATER_CYCLES, True, words, {"cycles": loading.cycles}))
    if loading.unload:
        some = "in one step if that strains nothing, else in equal ones"
        words, steps = (some, loading.unload_steps or loading.steps) if yields else (ONE_STEP, 1)
        solving.append(Stage("unloading", True, words, {"steps": steps}))
    return solving


def _left_out(scene: Scene) -> list[tuple[str, str]]:
    """Stages that the scene does not need, with the reason."""
    (yields, back_stresses, alternating), coating = _kind(scene), scene.body.coating
    more = ", no body.coating.yield_stress" if coating else ""
    rigid = scene.counterbody is not None and not scene.counterbody.elastic
    again = not yields and scene.loading.cycles > 1 and not alternating
    unload, reason = scene.loading.unload, verdict.reason_without(scene)
    of_sam = "of the semi-analytical model"
    stages = (
        (not coating, "film elements", "no [body.coating]"),
        (not scene.coefficient, TRACTION, "friction.coefficient is 0" if scene.friction else "no [friction]"),
        (True, "worn geometry", "no [wear]"),
        (not yields, RETURN_MAP, f"the body is elastic: no [body.plasticity]{more}"),
        (yields and not back_stresses, "back-stresses", "no [body.plasticity.kinematic]"),
        (rigid, "mesh of the counter-body", "rigid: no counterbody.young and counterbody.poisson"),
        (scene.solver.extrapolate, "extrapolation", f"solver.extrapolate is a method {of_sam}"),
        (scene.solver.operator is not None, "operator", f"solver.operator is {of_sam}"),
        (not unload, "unloading", "loading.unload is false"),
        (unload and not yields, "unloading steps", "elastic: unloading in one step is exact"),
        (again, LATER_CYCLES, "elastic: every cycle equals the first"),
        (reason, verdict.VERDICT, reason or ""),
    )
    return [(stage, why) for left_out, stage, why in stages if left_out]


def _steps(scene: Scene) -> int:
    """Load steps of a cycle, those along the path included; none without load."""
    return (scene.loading.steps + scene.strokes.count) * (scene.loading.force != 0.0)


def _load(scene: Scene) -> Stage:
    """What puts the load on."""
    if scene.loading.prescribed is None:
        way = ", then along the path" if scene.loading.path is not None else ""
        return Stage("contact search", True, f"load steps to the peak{way}", {"steps": _steps(scene)})
    reason = f'loading.prescribed = "{scene.loading.prescribed}"'
    if scene.loading.misfit_sphere:
        return Stage("misfit strain", True, f"{reason}: at the Gauss points", {"steps": _steps(scene)})
    reason += ", and travels" if scene.loading.path else ""
    return Stage("given pressure", True, reason, {"steps": _steps(scene)})


def _moving(scene: Scene) -> list[Stage]:
    """A counter-body that travels, and its passes."""
    path, strokes = scene.loading.path, scene.strokes
    if path is None or not strokes.with_motion:
        return []
    way = "to and fro, the load stays on" if path.to_and_fro else "one way, unloaded at its end"
    where = "the mesh is uniform along the path" if scene.patch_surface is None else "in cells of the patch"
    words = f"the gap moves over the body, {way}; {where}"
    size = {"passes": strokes.cycles, "steps": strokes.count, "step_m": path.length / strokes.count}
    return [Stage("moving counter-body", True, words, size)]
