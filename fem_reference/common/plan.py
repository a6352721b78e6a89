# SPDX-License-Identifier: MIT
"""The plan of a scene: what a finite-element model solves, made once; the solver executes it and asks the
scene nothing.

Here is what the plans of both models share; `fem_reference.axisymmetric.planner` and
`fem_reference.spatial.planner` make them. Loads no numerical library but numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, TypeVar

import numpy as np

from fem_reference.common.bodies import Bodies, Elastic, coating_of, expected_radius
from fem_reference.common.hertz import Scales, peak_force, relative_moduli, required
from fem_reference.common.refusals import Advice, advice_of
from fem_reference.common.schedule import Schedule, Sliding, schedule_of
from sam.scene.result import NO_FORCE, LeftOut, Stage, left_out_of
from sam.scene.schema import Scene
from sam.scene.verdict import (
    VERDICT,
    Judging,
    counts_dissipation,
    judging_of,
    last_period,
    periods_of,
    reason_without,
)

TRACTION = "tangential traction"
AnyPlan = TypeVar("AnyPlan", bound="Plan")


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What a finite-element model solves of a scene.

    Attributes
    ----------
    model : str
        Name of the model in a result.
    scales : Scales
        Units of all that follows but where another unit is named.
    force : float
        Normal force at the peak in N.
    bodies : Bodies
        Elastic constants, coating and yield curves.
    prescribed : bool
        The pressure of Hertz, or a misfit strain, is given instead of a counter-body.
    schedule : Schedule
        The loads, one after the other.
    sliding : Sliding
        Coefficient and direction of friction, path of the load.
    cells_per_radius : int
        Elements in the radius of Hertz, as the scene has them.
    fine_cells_per_radius : float
        The same of the mesh, which a contact smaller than that of Hertz makes finer.
    expected : float
        Estimate of the radius of the elastic contact at the peak.
    elements, unknowns, points : int
        Size of the mesh: elements and degrees of freedom of all bodies, Gauss points of the half-space.
    stages : tuple of Stage
        What runs, with its size, and what does not, with the reason.
    advice : Advice
        What to change, by status.
    judging : Judging or None
        How repeated loading is judged; None without a verdict.
    dissipates : bool
        Whether the energy that each cycle dissipates is asked for.
    bare : Plan or None
        The contact without its coating on the same mesh, for comparison; None where there is no coating.
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
    elements: int
    unknowns: int
    points: int
    stages: tuple[Stage, ...]
    advice: Advice
    judging: Judging | None = None
    dissipates: bool = False
    bare: Self | None = None

    def forgets(self, cycle: int) -> bool:
        """Whether no result reads displacements and strains of the states inside a cycle: of a counter-body
        that moves, but for the loops of the last period that is judged.
        """
        judged = self.judging is not None and cycle in last_period(self.judging, self.schedule.cycles)
        return self.sliding.moves and not judged

    @property
    def left_out(self) -> list[LeftOut]:
        """Stages that the scene does not need, with the reason."""
        return left_out_of(self.stages)


def shared_fields(scene: Scene, units: Scales) -> dict[str, Any]:
    """The fields that every plan has, but name, stages and the bare contact."""
    sliding = slide(scene, units.length)
    bodies, cells = bodies_of(scene, units), scene.fem.cells_per_radius
    expected = 1.0 if scene.patch_surface is not None else expected_radius(scene)
    return {
        "scales": units,
        "force": peak_force(scene) if scene.loading.approach is None else units.force,
        "bodies": bodies,
        "prescribed": scene.loading.prescribed is not None,
        "schedule": steps_of(scene, units, bodies, sliding),
        "sliding": sliding,
        "cells_per_radius": cells,
        "fine_cells_per_radius": cells / min(1.0, expected),
        "expected": expected,
        "advice": advice_of(scene),
        "judging": judging_of(scene),
        "dissipates": counts_dissipation(scene),
    }


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
    elastic += [Elastic(young, required(required(scene.counterbody).poisson)) for young in others]
    bodies = Bodies(tuple(elastic), coating_of(scene, units))
    if coating is not None:
        bodies = replace(bodies, coating_yield=coating.yield_stress)
    if plasticity is not None:
        bodies = replace(bodies, strength=plasticity.strength())
    return bodies


def with_bare_contact(plan: AnyPlan, scene: Scene) -> AnyPlan:
    """The plan of a coated scene with that of the bare contact: the same mesh, up to the last peak."""
    if plan.bodies.coating is None:
        return plan
    bodies = plan.bodies.without_coating()
    schedule = steps_of(scene, plan.scales, bodies, plan.sliding).of_bare_contact(not bodies.yields)
    return replace(plan, bare=replace(plan, bodies=bodies, schedule=schedule, expected=1.0))


def steps_of(scene: Scene, units: Scales, bodies: Bodies, sliding: Sliding) -> Schedule:
    """The load schedule of a scene for these bodies."""
    elastic, unit = not bodies.yields, units.displacement
    return schedule_of(scene.loading, units.peak_force, elastic=elastic, sliding=sliding, unit=unit)


def stages_of(scene: Scene, mesh: Sequence[Stage], stresses: Stage) -> tuple[Stage, ...]:
    """All stages in the order in which they begin, then those that the scene does not need.

    mesh: the first stages; stresses: the last one of the contact, whose size has the Gauss points.
    """
    coating, yields = scene.body.coating, _yields(scene)
    stages = list(mesh)
    if coating is not None:
        kind = "elastic" if coating.yield_stress is None else "perfectly plastic"
        words = f"{kind}, two elements or more through its thickness"
        stages.append(Stage("film elements", True, words, {"thickness_m": coating.thickness}))
    solving = [_load(scene), *_moving(scene)]
    if scene.coefficient:
        solving.append(Stage(TRACTION, True, "full slip: q = coefficient p along x, in every iteration"))
    if yields:
        reason = "backward Euler, in the iterations of the contact"
        reason += scene.body.plasticity.of_layer if scene.body.plasticity is not None else ""
        solving.append(Stage("return mapping and plastic history", True, reason, stresses.size))
        if count := _back_stresses(scene):
            words = "exact along a constant direction of flow"
            solving.append(Stage("back-stresses", True, words, {"back_stresses": count}))
        solving += _cycles(scene, "each starts from the strain that the others left")
    elif _alternating(scene):
        solving += _cycles(scene, "the traction turns round")
    if scene.loading.unload:
        words = (
            "in one step if that strains nothing, else in equal ones" if yields else "elastic: in one step"
        )
        steps = (scene.loading.unload_steps or scene.loading.steps) if yields else 1
        solving.append(Stage("unloading", True, words, {"steps": steps}))
    stages += [*_needs_force(scene, solving), stresses]
    if yields and not reason_without(scene):
        words = "strains of the unloaded body after each period"
        stages.append(Stage(VERDICT, True, words, {"periods": periods_of(scene)}))
    if coating is not None:
        words = "the same contact without the film, for comparison"
        stages += _needs_force(scene, [Stage("bare body", True, words, {"steps": _steps(scene)})])
    return (*stages, *(Stage(stage, False, reason) for stage, reason in _left_out(scene, yields)))


def _left_out(scene: Scene, yields: bool) -> list[tuple[str, str]]:
    """Stages that the scene does not need, with the reason."""
    coating = scene.body.coating
    out = [] if coating else [("film elements", "no [body.coating]")]
    if not scene.coefficient:
        out.append((TRACTION, "friction.coefficient is 0" if scene.friction else "no [friction]"))
    out.append(("worn geometry", "no [wear]"))
    if not yields:
        more = ", no body.coating.yield_stress" if coating else ""
        reason = f"the body is elastic: no [body.plasticity]{more}"
        out.append(("return mapping and plastic history", reason))
    elif not _back_stresses(scene):
        out.append(("back-stresses", "no [body.plasticity.kinematic]"))
    if scene.counterbody is not None and not scene.counterbody.elastic:
        words = "rigid: no counterbody.young and counterbody.poisson"
        out.append(("mesh of the counter-body", words))
    if scene.solver.extrapolate:
        out.append(("extrapolation", "solver.extrapolate is a method of the semi-analytical model"))
    if not scene.loading.unload:
        out.append(("unloading", "loading.unload is false"))
    elif not yields:
        out.append(("unloading steps", "elastic: unloading in one step is exact"))
    if not yields and scene.loading.cycles > 1 and not _alternating(scene):
        out.append(("cycles after the first", "elastic: every cycle equals the first"))
    if reason := reason_without(scene):
        out.append((VERDICT, reason))
    return out


def _yields(scene: Scene) -> bool:
    """Whether the body or its coating has a yield stress."""
    coating = scene.body.coating
    return scene.body.plasticity is not None or (coating is not None and coating.yield_stress is not None)


def _back_stresses(scene: Scene) -> int:
    """How many there are at most at any depth."""
    plasticity = scene.body.plasticity
    return 0 if plasticity is None else plasticity.back_stresses


def _alternating(scene: Scene) -> bool:
    """Whether the traction changes its sign from cycle to cycle."""
    friction = scene.friction
    return friction is not None and scene.coefficient > 0.0 and friction.direction == "alternating"


def _loaded(scene: Scene) -> bool:
    """Whether there is any load: a given pressure, an approach, or a force above zero."""
    return scene.loading.force != 0.0


def _steps(scene: Scene) -> int:
    """Load steps of a cycle, those along the path included; none without load."""
    return (scene.loading.steps + scene.strokes.count) * _loaded(scene)


def _needs_force(scene: Scene, stages: list[Stage]) -> list[Stage]:
    """The stages, none of which runs without force."""
    return stages if _loaded(scene) else [Stage(each.stage, False, NO_FORCE) for each in stages]


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


def _cycles(scene: Scene, reason: str) -> list[Stage]:
    """Further cycles that are not equal to the first."""
    cycles = scene.loading.cycles
    return [Stage("cycles after the first", True, reason, {"cycles": cycles})] if cycles > 1 else []
