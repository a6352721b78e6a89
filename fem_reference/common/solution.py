# SPDX-License-Identifier: MIT
"""The way from a scene to a result, plan, model, load steps, verdict, quantities, tables: the same for all
geometries, which differ by a `Method`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Generic, TypeVar

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.linear import NO_WORK
from fem_reference.common.loading import Progressed, Step, run
from fem_reference.common.model import ContactModel
from fem_reference.common.plan import Plan
from fem_reference.common.recovery import Stresses, exceeded_strain
from fem_reference.common.tables import (
    Surface,
    element_fields,
    peak_steps,
    stacked,
    step_tables,
    verdict_summary,
)
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.result import (
    COST,
    LAST,
    PEAK,
    QUANTITIES,
    UNLOADED,
    FieldMesh,
    Progress,
    Result,
    Status,
    Table,
    of_load,
)
from sam.scene.schema import Scene

M = TypeVar("M", bound=ContactModel)


@dataclass(frozen=True)
class Pair:
    """The steps of the coated contact and those of the bare one; None: not begun."""

    coated: Progressed | None = None
    bare: Progressed | None = None


@dataclass(frozen=True)
class Solved(Generic[M]):
    """The model of a plan and its steps, and of a coated one those of the bare contact."""

    model: M
    steps: list[Step]
    bare_model: M | None = None
    bare_steps: list[Step] = field(default_factory=list)


Keeping = Callable[..., None]
"""Called with a record, its part that goes on, the steps before that part and those after it."""


def coated_then_bare(
    coated: M, bare: M, begin: Pair, *, progress: Progress | None, keep: Keeping
) -> Solved[M]:
    """The steps of the coated contact, then, unless it failed, of the bare one on the same mesh."""
    schedule, later = coated.plan.schedule, bare.plan.schedule

    def counted(first: int, last: int) -> Progress | None:
        return progress and (lambda stage, done, total: progress(stage, first + done, first + total + last))

    steps = run(
        coated,
        schedule,
        progress=counted(0, later.loading_steps),
        keep=lambda record: keep(Pair(record), record, 0, len(later.targets)),
        begin=begin.coated,
    )
    if not steps[-1].state.converged:
        return Solved(coated, steps, bare)
    finished = Progressed(coated.virgin(), (), steps)
    bare_steps = run(
        bare,
        later.with_forces({(step.cycle, step.number): step.state.force for step in steps}),
        progress=counted(schedule.loading_steps, 0),
        keep=lambda record: keep(Pair(finished, record), record, len(steps), 0),
        begin=begin.bare,
    )
    return Solved(coated, steps, bare, bare_steps)


P = TypeVar("P", bound=Plan)
S = TypeVar("S", bound=Stresses)
Quantities = dict[str, float | None]
CONDITIONS = ("force_balance", "tension", "penetration", "gap_in_contact")


@dataclass(frozen=True)
class Method(Generic[P, M, S]):
    """What a geometry has of its own: functions of its plan P, its model M and its stresses S.

    setups: what a set-up of the linear solver is called; plan, build: of a scene, of a plan; stresses: of a
    state; contact_quantities: at the peak, beside those of all geometries; axis, plane: tables
    of a state and its name; field_mesh, surface: of one state; discretisation: in SI units; plastic_shear: in
    m, what plastic shear moves the surface along x, -integral of 2 e_p_xz over z, at places x in m; further:
    tables of all states by name; warnings: what a reader of the result must know; of_path: tables, and
    columns of the history, that a counter-body that moves adds, and quantities.
    """

    setups: str
    plan: Callable[[Scene], P]
    build: Callable[[Any], M]
    stresses: Callable[[M, Equilibrium], S]
    contact_quantities: Callable[[M, Equilibrium], Quantities]
    axis: Callable[[str, S], Table]
    plane: Callable[[str, S], Table]
    field_mesh: Callable[[M, Equilibrium, S], FieldMesh]
    surface: Callable[[M, Equilibrium], Surface]
    discretisation: Callable[[M], dict[str, object]]
    plastic_shear: Callable[[M, S, Array | float], Array | float] = lambda *_of_state: 0.0
    further: Callable[[M, Mapping[str, Equilibrium], Mapping[str, S]], dict[str, Table]] = lambda *_states: {}
    warnings: Callable[[M], tuple[str, ...]] = lambda _model: ()
    of_path: Callable[
        [M, Sequence[Step], Mapping[str, Equilibrium], Mapping[str, S]], tuple[dict[str, Table], Quantities]
    ] = lambda *_of_states: ({}, {})

    def peeq_max(self, model: M, state: Equilibrium) -> float:
        """Return the largest accumulated plastic strain of a state, as in the quantities."""
        return self.stresses(model, state).largest_peeq()[0] if state.yielded else 0.0

    def tables(
        self, model: M, states: Mapping[str, Equilibrium], fields: Mapping[str, S]
    ) -> dict[str, Table]:
        """Return the tables of the states, one below the other."""
        lines = []
        for name, state in states.items():
            surface = self.surface(model, state)
            lines.append(surface.table(name, self.plastic_shear(model, fields[name], surface.x)))
        return {
            "axis": stacked([self.axis(name, fields[name]) for name in states]),
            "line": stacked(lines),
            "plane": stacked([self.plane(name, fields[name]) for name in states]),
            **self.further(model, states, fields),
        }

    def solve(
        self,
        scene: Scene,
        progress: Progress | None = None,
        checkpoint: Keep | None = None,
        start: Checkpoint | None = None,
        *,
        plan: P | None = None,
    ) -> Result:
        """Solve a scene by finite elements.

        Parameters
        ----------
        scene : Scene
            One that `check` of the model allows.
        progress : callable, optional
            Called as ``progress("contact", done, total)`` after each load step towards the peak.
        checkpoint : callable, optional
            Called with a Checkpoint after each step of the schedule of a body that can yield.
        start : Checkpoint, optional
            One of them, of the same scene, to go on from there to the same result.
        plan : optional
            What `plan` made of the scene; without it that is done here.

        Returns
        -------
        Result
            In SI units; its status says whether it may be used. ``p_max_Pa`` is the largest nodal pressure:
            the multiplier of a surface node over the area that belongs to it; on an axis of symmetry it is
            extrapolated from the neighbours. In plane strain displacements and the approach count from the
            surface at half the length of the cylinder beside its axis under the same line force.

        Raises
        ------
        UnsupportedScene
            For what the model cannot represent, see `check`.
        ValueError
            For a `start` of another model.
        """
        plan = self.plan(scene) if plan is None else plan
        check_model(start, plan.model)
        clock = Clock(start)
        model = self.build(plan)
        clock.ready()

        def keep(record: object, part: Progressed, before: int = 0, after: int = 0) -> None:
            if checkpoint:
                done = before + len(part.steps)
                total = done + len(part.targets) + after
                checkpoint(Checkpoint.of(plan.model, record, done=done, total=total, cost=clock.times()))

        if plan.bare is not None:
            pair = start.record(Pair) if start else Pair()
            solved = coated_then_bare(model, self.build(plan.bare), pair, progress=progress, keep=keep)
        else:
            steps = run(
                model,
                plan.schedule,
                progress=progress,
                keep=lambda record: keep(record, record),
                begin=start.record(Progressed) if start else None,
                strained=partial(self.peeq_max, model),
            )
            solved = Solved(model, steps)
        return result_of(self, solved, clock)

    def load_steps(self, scene: Scene, record: Checkpoint | None = None) -> tuple[M, list[Step]]:
        """Return the model of a scene and its load steps, for a-posteriori checks of every state.

        record: of the last step of a solve; without it the steps are taken again, of a coated contact its own
        alone. The steps go up to the first that did not converge; of a record of a counter-body that moves
        those inside a pass are without displacements and strains. UnsupportedScene as of `solve`.
        """
        plan = self.plan(scene)
        model = self.build(plan)
        if record is None:
            return model, run(model, plan.schedule)
        reached = record.record(Progressed) if plan.bare is None else record.record(Pair).coated
        return model, [] if reached is None else reached.steps


def result_of(method: Method[P, M, S], solved: Solved[M], clock: Clock) -> Result:
    """The result of the steps of a plan."""
    model, steps = solved.model, solved.steps
    plan = model.plan
    states = recorded_states(model, steps)
    first, *_ = states
    fields = {name: method.stresses(model, state) for name, state in states.items()}
    peeq = float(fields[first].peeq.max())
    bodies = {}
    for name, state in states.items():
        mesh = method.field_mesh(model, state, fields[name])
        extra = element_fields(model, state, steps)
        bodies[name] = replace(mesh, cell_data={**mesh.cell_data, **extra})
    status, message = plan.advice.outcome(verdict(method, solved, fields[first]), peeq)
    of_steps = step_tables(model, steps, partial(method.peeq_max, model))
    quantities = quantities_of(method, model, states, fields)
    quantities |= coated_quantities(method, solved, states[first])
    of_path, path_quantities = (
        method.of_path(model, steps, states, fields) if plan.sliding.moves else ({}, {})
    )
    sizes = {"bodies": len(plan.bodies.elastic), "elements": plan.elements, "dofs": plan.unknowns}
    history = {**of_steps.pop("history"), **of_path.pop("history", {})}
    return Result(
        model=plan.model,
        status=status,
        **of_load(first, quantities | path_quantities),
        tables={"history": history, **method.tables(model, states, fields), **of_path, **of_steps},
        fields=bodies[first],
        bodies=bodies,
        grids={name: {"surface": method.surface(model, state).grid()} for name, state in states.items()},
        left_out=plan.left_out,
        discretisation=sizes | method.discretisation(model),
        certificate=certificate(model, states[first]),
        cost=cost(solved.steps + solved.bare_steps, method.setups, clock),
        message="; ".join(filter(None, (message, steps[-1].state.ending))),
        warnings=method.warnings(model),
        verdict=verdict_summary(model, steps),
    )


def coated_quantities(method: Method[P, M, S], solved: Solved[M], peak: Equilibrium) -> Quantities:
    """The quantities of a coated scene alone, none of any other. peak: the state that is reported.

    Relative changes are (coated - bare)/bare at equal force; None without a load, or if the bare contact
    did not converge.
    """
    if solved.bare_model is None:
        return {}
    of_coated = method.stresses(solved.model, peak)
    film, substrate = (of_coated.largest_in_layer(coating)[0] for coating in (True, False))
    values: Quantities = {"mises_max_film_Pa": film, "mises_max_substrate_Pa": substrate}
    if not solved.bare_steps or not (state := solved.bare_steps[-1].state).converged:
        return values
    p_max = solved.bare_model.largest_pressure(state)
    mises_max = method.stresses(solved.bare_model, state).largest_in_layer(False)[0]
    values |= {"p_max_bare_Pa": p_max, "mises_max_bare_Pa": mises_max}
    values["p_max_change"] = solved.model.largest_pressure(peak) / p_max - 1.0 if p_max else None
    values["mises_max_change"] = substrate / mises_max - 1.0 if mises_max else None
    return values


class Clock:
    """Times of a solve, from its beginning; those before a checkpoint count."""

    def __init__(self, start: Checkpoint | None):
        self._before = start.cost if start else {"setup_s": 0.0, "solve_s": 0.0}
        self._began = self._ready = time.perf_counter()

    def ready(self) -> None:
        """Note that the model is built."""
        self._ready = time.perf_counter()

    def times(self) -> dict[str, float]:
        """Return setup_s and solve_s so far."""
        setup, solving = self._ready - self._began, time.perf_counter() - self._ready
        return {"setup_s": self._before["setup_s"] + setup, "solve_s": self._before["solve_s"] + solving}


def recorded_states(model: ContactModel, steps: Sequence[Step]) -> dict[str, Equilibrium]:
    """The states of the tables: the last peak and what follows it, or the last load reached."""
    final = steps[-1]
    if not final.state.converged and not (final.unloads and final.cycle == model.plan.schedule.cycles):
        return {LAST: steps[-2].state if len(steps) > 1 else model.virgin()}
    states = {PEAK: peak_steps(steps)[-1].state}
    if final.unloads and final.state.converged:
        states[UNLOADED] = final.state
    return states


def verdict(method: Method[P, M, S], solved: Solved[M], peak: S) -> Status:
    """Status of the load steps, the bare contact included; peak: stresses of the first state."""
    status = judge(solved.model, solved.steps, peak)
    if solved.bare_model is None or not solved.bare_steps or status is not Status.CONVERGED:
        return status
    last = method.stresses(solved.bare_model, solved.bare_steps[-1].state)
    return judge(solved.bare_model, solved.bare_steps, last)


def judge(model: ContactModel, steps: Sequence[Step], peak: Stresses) -> Status:
    """Status of the load steps of one contact, whose largest contact judges the mesh."""
    states = [step.state for step in steps]
    if not states[-1].converged:
        return Status.NOT_CONVERGED if model.elastic else Status.STEP_CUT_LIMIT
    if model.scales.peak_force == 0.0:
        return Status.CONVERGED
    if model.outgrown(states):
        return Status.CONTACT_AT_GRID_EDGE
    if model.yields_at_edge(peak.peeq):
        return Status.PLASTIC_ZONE_AT_GRID_EDGE
    return Status.UNDER_RESOLVED if model.too_coarse(states) else Status.CONVERGED


def quantities_of(
    method: Method[P, M, S], model: M, states: Mapping[str, Equilibrium], fields: Mapping[str, S]
) -> Quantities:
    """Every name of QUANTITIES, None where it does not apply; a coating's own come later."""
    first, *_ = states
    peak, s = states[first], fields[first]
    mises_max, mises_depth = s.largest_mises()
    peeq_max, peeq_depth = s.largest_peeq()
    strain = None  # of a body that has not yielded
    if peak.history is not None:
        peeq = peak.history.peeq * model.scales.strain
        strain = exceeded_strain(peeq.ravel(), model.body.weights.ravel())
    values: Quantities = {
        "approach_m": None if model.plan.prescribed else peak.approach * model.scales.displacement,
        "p_max_Pa": model.largest_pressure(peak),
        "mises_max_Pa": mises_max,
        "mises_max_depth_m": mises_depth,
        "peeq_max": peeq_max,
        "peeq_max_depth_m": peeq_depth,
        "friction_coefficient": model.friction(peak),
        "wear_volume_m3": 0.0,
        "peeq_p95": strain,
        "force_N": model.plan.force * model.share(peak),
        "contact_area_m2": model.contact_area(peak),
        **method.contact_quantities(model, peak),
    }
    surface, slides = method.surface(model, peak), model.plan.sliding.coefficient > 0.0
    if model.centred:
        values["p_center_Pa"] = surface.centre(surface.pressure)
        values["tangential_displacement_center_m"] = surface.centre(surface.u[0]) if slides else None
    if UNLOADED in states:
        after = fields[UNLOADED]
        values["residual_mises_max_Pa"] = after.largest_mises()[0]
        surface = method.surface(model, states[UNLOADED])
        if model.centred:
            values["residual_uz_center_m"] = surface.centre(surface.u[2])
        if model.centred and slides:
            values["residual_ux_center_m"] = surface.centre(surface.u[0])
            values["plastic_shear_center_m"] = float(method.plastic_shear(model, after, 0.0))
    return {name: values.get(name) for name in QUANTITIES}


def certificate(model: ContactModel, state: Equilibrium) -> dict[str, float]:
    """Conditions of contact, measured on the returned displacements; all zero in an exact solution, and
    without contact.

    force_balance: |sum(lambda) - F| / F; tension: largest -lambda / F, without a node on the axis, whose
    area is zero (and whose share of a pressure growing with r is negative); penetration: largest -gap
    outside contact / approach; gap_in_contact: largest |gap| in contact / approach; equilibrium: largest
    force on a free degree of freedom / F, that of friction included; yield_excess (of a body that can
    yield): largest (mises - yield stress)/yield stress. Where the pressure is given only the last two.
    """
    history, material = state.history, model.problem.material
    excess = {}
    if history is not None and material is not None:
        most = float(material.excess(model.stress(state), history).max())
        excess["yield_excess"] = max(0.0, most)
    if state.force == 0.0 or model.plan.prescribed:
        return dict.fromkeys(CONDITIONS, 0.0) | {"equilibrium": state.residual} | excess
    total, active, judged = model.part * state.force, state.active, slice(model.on_axis, None)
    forces = model.contact_forces(state)
    gap = model.at(state.load).problem.gap(state.u, state.approach) / abs(state.approach)
    return {
        "force_balance": abs(float(forces[active].sum()) / total - 1.0),
        "tension": max(0.0, -float(forces[judged][active[judged]].min(initial=0.0)) / total),
        "penetration": max(0.0, -float(gap[~active].min(initial=0.0))),
        "gap_in_contact": float(np.abs(gap[active]).max()),
        "equilibrium": state.residual,
        **excess,
    }


def coating_elements(model: ContactModel, layers: int | None) -> dict[str, object]:
    """Thickness of a coating and its layers of elements; nothing without one."""
    coating = model.plan.bodies.coating
    if coating is None:
        return {}
    return {"film_thickness_m": coating.thickness * model.scales.length, "film_layers": layers}


def cost(steps: Sequence[Step], setups: str, clock: Clock) -> dict[str, float | int | None]:
    """Every name of COST, `setups`, what a set-up is called, and "linear_iterations"."""
    work = sum((step.work for step in steps), NO_WORK)
    values = {
        **clock.times(),
        "contact_iterations": work.newton,
        "newton_iterations": work.newton,
        "step_cuts": sum(step.cuts for step in steps),
    }
    return {name: values.get(name) for name in COST} | {setups: work.setups, "linear_iterations": work.linear}
