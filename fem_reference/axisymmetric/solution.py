# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element solution of a scene: contact of a sphere or a flat punch with a half-space."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from fem_reference.axisymmetric import tables
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.recovery import (
    Stresses,
    largest_in_layer,
    largest_mises,
    largest_peeq,
    stresses,
)
from fem_reference.axisymmetric.support import check, left_out
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.film import judged
from fem_reference.common.hertz import peak_force
from fem_reference.common.linear import NO_WORK
from fem_reference.common.loading import Step
from fem_reference.common.messages import FEWEST_ELEMENTS, message_of
from fem_reference.common.schedule import coated_quantities, solve_steps
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.residuals import residual_table
from sam.scene.result import COST, LAST, PEAK, QUANTITIES, UNLOADED, Progress, Result, Status, of_load
from sam.scene.schema import Scene

MODEL = "fem-axisymmetric"
FAR_FIELD = {
    False: "displacements of the point force on the outer boundary",
    True: "displacements of the point force on the layered half-space on the outer boundary",
}
SINGULAR = "punch: the pressure is singular at the edge; p_max_Pa, mises_max_Pa, peeq_max and their depths depend on the mesh"


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
) -> Result:
    """Solve a frictionless, smooth scene by finite elements.

    progress: called as progress("contact", done, total) after each load step; checkpoint: called with a Checkpoint after
    each step of the schedule of a body that can yield; start: one of them, of the same scene, to go on from there to the
    same result. Returns a Result, whose status says whether it may be used. Raises UnsupportedScene for what this model
    cannot represent (see fem_reference.check), ValueError for a `start` of another model.
    """
    check(scene)
    check_model(start, MODEL)
    clock = Clock(start)
    model = build(scene)
    clock.ready()

    def keep(now: object, done: int, total: int) -> None:
        checkpoint(Checkpoint.of(MODEL, now, done=done, total=total, cost=clock.times()))

    solved = solve_steps(
        scene, model, partial(build, scene, film=False), progress, keep if checkpoint else None, start
    )
    steps = solved.steps
    states = recorded_states(model, steps, scene.loading.cycles)
    first, *_ = states
    fields = {name: stresses(model, state) for name, state in states.items()}
    status = judge(model, steps, fields[first])
    if solved.bare_steps and status is Status.CONVERGED:
        bare, last = solved.bare_model, solved.bare_steps[-1].state
        status = judge(bare, solved.bare_steps, stresses(bare, last))
    status, message = judged(scene, status, message_of(scene, status), fields[first].peeq.max())
    out = {
        "history": tables.history_table(model, steps, peak_force(scene)),
        "axis": tables.stacked([tables.axis_table(name, fields[name]) for name in states]),
        "line": tables.stacked([tables.line_table(name, model, states[name]) for name in states]),
        "plane": tables.stacked([tables.plane_table(name, fields[name]) for name in states]),
    }
    out["residuals"] = residual_table((step.cycle, step.number, step.attempts) for step in steps)
    if scene.loading.cycles > 1:
        out["cycles"] = tables.cycles_table(model, peak_steps(steps))
    return Result(
        model=MODEL,
        status=status,
        **of_load(
            first,
            scalar_results(scene, model, states, fields)
            | coated_quantities(solved, model, states[first], in_layers),
        ),
        tables=out,
        fields=tables.field_mesh(model, states[first], fields[first]),
        left_out=left_out(scene),
        discretisation=discretisation(model, scene),
        certificate=certificate(model, states[first]),
        cost=cost(solved.all_steps, "factorizations", **clock.times()),
        message="; ".join(filter(None, (message, steps[-1].state.ending))),
        warnings=(SINGULAR,) if model.punch else (),
    )


class Clock:
    """Times of a solve, from its beginning; those before a checkpoint count."""

    def __init__(self, start: Checkpoint | None):
        self._before = start.cost if start else {"setup_s": 0.0, "solve_s": 0.0}
        self._began = self._ready = time.perf_counter()

    def ready(self) -> None:
        """The model is built."""
        self._ready = time.perf_counter()

    def times(self) -> dict[str, float]:
        """setup_s and solve_s up to now."""
        setup, solving = self._ready - self._began, time.perf_counter() - self._ready
        return {"setup_s": self._before["setup_s"] + setup, "solve_s": self._before["solve_s"] + solving}


def peak_steps(steps: Sequence[Step]) -> list[Step]:
    """The last step towards the peak of each cycle that came to it."""
    peaks = {step.cycle: step for step in steps if not step.unloads}
    return [step for step in peaks.values() if step.state.converged]


def recorded_states(model: Model, steps: Sequence[Step], cycles: int) -> dict[str, Equilibrium]:
    """The states of the tables by name: the peak of the last cycle and what follows it; or the last load that was reached."""
    final = steps[-1]
    if not final.state.converged and not (final.unloads and final.cycle == cycles):
        return {LAST: steps[-2].state if len(steps) > 1 else model.virgin()}
    states = {PEAK: peak_steps(steps)[-1].state}
    if final.unloads and final.state.converged:
        states[UNLOADED] = final.state
    return states


def scalar_results(
    scene: Scene, model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, float | None]:
    """Every name of QUANTITIES, None where it does not apply to a smooth scene; those of a coating alone come later."""
    (peak, *_), (s, *_) = states.values(), fields.values()
    unit = model.scales
    pressure, radius = model.nodal_pressure(peak), model.contact_radius(peak) * unit.length
    mises_max, mises_depth = largest_mises(s)
    peeq_max, peeq_depth = largest_peeq(s)
    values = {
        "force_N": (peak.force if model.prescribed else float(peak.multipliers.sum()))
        * (peak_force(scene) / (unit.peak_force or 1.0)),
        "approach_m": None if model.prescribed else peak.approach * unit.displacement,
        "contact_area_m2": np.pi * radius**2,
        "contact_radius_m": radius,
        "p_max_Pa": float(pressure.max()) * unit.pressure,
        "p_center_Pa": float(pressure[0]) * unit.pressure,
        "mises_max_Pa": mises_max,
        "mises_max_depth_m": mises_depth,
        "peeq_max": peeq_max,
        "peeq_max_depth_m": peeq_depth,
        "friction_coefficient": 0.0,
        "pressure_centroid_x_m": 0.0 if pressure.any() else None,
        "wear_volume_m3": 0.0,
    }
    if UNLOADED in states:
        centre = model.body.boundary_dofs("surface", 1)[0]
        values["residual_uz_center_m"] = float(states[UNLOADED].u[centre]) * unit.displacement
        values["residual_mises_max_Pa"] = largest_mises(fields[UNLOADED])[0]
    return {name: values.get(name) for name in QUANTITIES}


def in_layers(model: Model, state: Equilibrium) -> dict[str, float]:
    """The largest values of a coated contact that are compared."""
    s = stresses(model, state)
    return {
        "p_max_Pa": tables.largest_pressure(model, state),
        "mises_max_film_Pa": largest_in_layer(s, film=True)[0],
        "mises_max_substrate_Pa": largest_in_layer(s, film=False)[0],
    }


def judge(model: Model, steps: Sequence[Step], peak: Stresses) -> Status:
    """Status of the load steps; the mesh is judged at the largest contact."""
    if not steps[-1].state.converged:
        return Status.NOT_CONVERGED if model.elastic else Status.STEP_CUT_LIMIT
    if model.scales.peak_force == 0.0:
        return Status.CONVERGED
    radius = max(model.contact_radius(step.state) for step in steps)
    if radius >= model.edge:
        return Status.CONTACT_AT_GRID_EDGE
    if (peak.peeq > 0.0)[model.outermost].any():
        return Status.PLASTIC_ZONE_AT_GRID_EDGE
    if round(radius * model.cells_per_radius) < FEWEST_ELEMENTS:
        return Status.UNDER_RESOLVED
    return Status.CONVERGED


def certificate(model: Model, state: Equilibrium) -> dict[str, float]:
    """Conditions of contact, measured on the returned displacements; all zero in an exact solution, and without contact.

    force_balance: |sum(lambda) - F| / F; tension: largest -lambda / F, without the node on the axis, whose area is zero
    (and whose share of a pressure growing with r is negative); penetration: largest -gap outside contact / approach;
    gap_in_contact: largest |gap| in contact / approach; equilibrium: largest force on a free degree of freedom / F;
    yield_excess (of a body that can yield): largest (mises - yield stress)/yield stress.
    """
    problem, history = model.problem, state.history
    excess = {}
    if history is not None:
        q = mises(model.body.stress(problem.body(state.u, 0), history.plastic_strain))
        excess["yield_excess"] = max(0.0, float(problem.material.excess(q, history.peeq).max()))
    if state.force == 0.0 or model.prescribed:
        names = ("force_balance", "tension", "penetration", "gap_in_contact", "equilibrium")
        return dict.fromkeys(names, 0.0) | {"equilibrium": state.residual} | excess
    reaction = problem.internal_force(state.u, history)[problem.normal[problem.slave]]
    gap = problem.gap(state.u, state.approach) / abs(state.approach)
    return {
        "force_balance": abs(float(reaction[state.active].sum()) / state.force - 1.0),
        "tension": max(0.0, -float(reaction[1:][state.active[1:]].min(initial=0.0)) / state.force),
        "penetration": max(0.0, -float(gap[~state.active].min(initial=0.0))),
        "gap_in_contact": float(np.abs(gap[state.active]).max()),
        "equilibrium": state.residual,
        **excess,
    }


def discretisation(model: Model, scene: Scene) -> dict[str, object]:
    """The mesh, in SI units."""
    length = model.scales.length
    return {
        "element": "8-node serendipity quadrilateral, 2 x 2 Gauss points",
        "bodies": len(model.problem.blocks),
        "cells_per_radius": scene.fem.cells_per_radius,
        "reference_radius_m": length,
        "h_m": float(model.surface[2] - model.surface[0]) * length,
        "h_edge_m": float(np.diff(model.surface[::2]).min()) * length,
        "box_m": float(model.surface[-1]) * length,
        **film_elements(model),
        "elements": model.mesh.nelements * len(model.problem.blocks),
        "dofs": model.problem.size,
        "far_field": FAR_FIELD[model.body.film is not None],
    }


def film_elements(model: Model) -> dict[str, object]:
    """Thickness of a film and its elements over the thickness."""
    film = model.body.film
    if film is None:
        return {}
    faces = np.unique(np.round(model.mesh.p[1], 12))
    layers = int(np.count_nonzero(faces < film.thickness * (1.0 - 1e-9)))
    return {"film_thickness_m": film.thickness * model.scales.length, "film_layers": layers}


def cost(
    steps: Sequence[Step], setups: str, setup_s: float, solve_s: float
) -> Mapping[str, float | int | None]:
    """Every name of COST, then `setups`, what a set-up is called, and "linear_iterations".

    Contact and equilibrium share one Newton loop, so that their iterations are the same.
    """
    work = sum((step.work for step in steps), NO_WORK)
    values = {
        "setup_s": setup_s,
        "solve_s": solve_s,
        "contact_iterations": work.newton,
        "newton_iterations": work.newton,
        "step_cuts": sum(step.cuts for step in steps),
    }
    return {name: values.get(name) for name in COST} | {setups: work.setups, "linear_iterations": work.linear}
