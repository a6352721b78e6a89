# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element solution of a scene: a rigid counter-body on a smooth or rough body, or given tractions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from fem_reference.axisymmetric.solution import FAR_FIELD, Clock, cost, peak_steps, recorded_states
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.film import judged
from fem_reference.common.hertz import peak_force
from fem_reference.common.loading import Step
from fem_reference.common.messages import message_of
from fem_reference.common.schedule import coated_quantities, solve_steps
from fem_reference.spatial import tables
from fem_reference.spatial.model import Model, build
from fem_reference.spatial.recovery import Stresses, largest_in_layer, largest_mises, largest_peeq, stresses
from fem_reference.spatial.support import check, left_out
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.residuals import residual_table
from sam.scene.result import QUANTITIES, UNLOADED, Progress, Result, Status, Table, of_load
from sam.scene.schema import Scene

MODEL = "fem-3d"


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
) -> Result:
    """Solve a smooth or rough scene with or without friction by finite elements in three dimensions.

    progress, checkpoint, start and what is raised: as in fem_reference.axisymmetric.solution.solve.
    """
    check(scene)
    check_model(start, MODEL)
    clock = Clock(start)
    model = build(scene)
    clock.ready()

    def keep(now: object, done: int, total: int) -> None:
        checkpoint(Checkpoint.of(MODEL, now, done=done, total=total, cost=clock.times()))

    bare = partial(build, scene, film=False)
    solved = solve_steps(scene, model, bare, progress, keep if checkpoint else None, start, model.sliding)
    steps = solved.steps
    states = recorded_states(model, steps, scene.loading.cycles)
    first, *_ = states
    fields = {name: stresses(model, state) for name, state in states.items()}
    status = judge(model, steps, fields[first])
    if solved.bare_steps and status is Status.CONVERGED:
        status = judge(
            solved.bare_model, solved.bare_steps, stresses(solved.bare_model, solved.bare_steps[-1].state)
        )
    status, message = judged(scene, status, message_of(scene, status), fields[first].peeq.max())
    return Result(
        model=MODEL,
        status=status,
        **of_load(
            first,
            scalar_results(scene, model, states, fields)
            | coated_quantities(solved, model, states[first], in_layers),
        ),
        tables=tables_of(scene, model, steps, states, fields),
        fields=tables.field_mesh(model, states[first], fields[first]),
        left_out=left_out(scene),
        discretisation=discretisation(model),
        certificate=certificate(model, states[first]),
        cost=cost(solved.all_steps, "multigrid_setups", **clock.times()),
        message="; ".join(filter(None, (message, steps[-1].state.ending))),
    )


def tables_of(
    scene: Scene,
    model: Model,
    steps: Sequence[Step],
    states: Mapping[str, Equilibrium],
    fields: Mapping[str, Stresses],
) -> dict[str, Table]:
    """The tables of a result by name, see sam.scene.result.COLUMNS: history and residuals of all steps, fields of the states."""
    first, *_ = states
    out = {
        "history": tables.history_table(model, steps, peak_force(scene)),
        "axis": tables.stacked([tables.axis_table(name, fields[name]) for name in states]),
        "line": tables.stacked(
            [tables.line_table(name, model, states[name], fields[name]) for name in states]
        ),
        "plane": tables.stacked([tables.plane_table(name, fields[name]) for name in states]),
    }
    path = scene.loading.path
    if states[first].force and (scene.surface is not None or (path is not None and any(path.end))):
        out["cut"] = tables.cut_table(first, model, states[first], fields[first])
    if scene.surface is not None:
        from fem_reference.spatial.rough_tables import surface_table

        out["surface"] = tables.stacked([surface_table(name, scene, model, states[name]) for name in states])
    out["residuals"] = residual_table((step.cycle, step.number, step.attempts) for step in steps)
    if scene.loading.cycles > 1:
        out["cycles"] = tables.cycles_table(model, peak_steps(steps))
    return out


def scalar_results(
    scene: Scene, model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, float | None]:
    """Every name of QUANTITIES, None where it does not apply to a smooth scene; those of a coating alone come later."""
    (peak, *_), (s, *_) = states.values(), fields.values()
    unit, rough = model.scales, scene.surface is not None
    pressure, area = model.nodal_pressure(peak), model.area(peak) * unit.length**2
    along_x, _, along_z = model.body.basis.nodal_dofs[:, model.surface]
    mises_max, mises_depth = largest_mises(s)
    peeq_max, peeq_depth = largest_peeq(s)
    values = {
        "force_N": peak_force(scene) * tables.share(model, peak),
        "approach_m": None if model.prescribed else peak.approach * unit.displacement,
        "contact_area_m2": area,
        "contact_radius_m": float(np.sqrt(area / np.pi)),
        "p_max_Pa": float(pressure.max()) * unit.pressure,
        "p_center_Pa": None if rough else tables.at_origin(pressure, model) * unit.pressure,
        "mises_max_Pa": mises_max,
        "mises_max_depth_m": mises_depth,
        "peeq_max": peeq_max,
        "peeq_max_depth_m": peeq_depth,
        "friction_coefficient": model.friction(peak),
        "pressure_centroid_x_m": model.centroid(peak) * unit.length,
        "wear_volume_m3": 0.0,
    }
    slides = model.sliding.coefficient > 0.0
    if slides:
        values["tangential_displacement_center_m"] = (
            tables.at_origin(peak.u[along_x], model) * unit.displacement
        )
    if UNLOADED in states:
        left, after = states[UNLOADED], fields[UNLOADED]
        values["residual_uz_center_m"] = tables.at_origin(left.u[along_z], model) * unit.displacement
        values["residual_mises_max_Pa"] = largest_mises(after)[0]
        if slides:
            values["residual_ux_center_m"] = tables.at_origin(left.u[along_x], model) * unit.displacement
            values["plastic_shear_center_m"] = float(
                np.interp(0.0, after.x, tables.plastic_shear(model, after))
            )
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
    if any(model.outgrown(step.state) for step in steps):
        return Status.CONTACT_AT_GRID_EDGE
    yielded = peak.peeq > 0.0
    if any(np.any(side) for side in (yielded[[0, -1]], yielded[:, -1], yielded[:, :, -1])):
        return Status.PLASTIC_ZONE_AT_GRID_EDGE
    return Status.UNDER_RESOLVED if model.too_coarse([step.state for step in steps]) else Status.CONVERGED


def certificate(model: Model, state: Equilibrium) -> dict[str, float]:
    """Conditions of contact, measured on the returned displacements; all zero in an exact solution.

    force_balance: |sum(lambda) - F| / F; tension: largest -lambda / F; penetration: largest -gap outside contact / approach;
    gap_in_contact: largest |gap| in contact / approach; equilibrium: largest force on a free degree of freedom / F, that of
    friction included; yield_excess (of a body that can yield): largest (mises - yield stress)/yield stress. Where the
    pressure is given only the last two.
    """
    problem, history, excess = model.problem, state.history, {}
    stress = model.body.stress(state.u, 0.0 if history is None else history.plastic_strain)
    if history is not None:
        excess["yield_excess"] = max(0.0, float(problem.material.excess(mises(stress), history.peeq).max()))
    names = ("force_balance", "tension", "penetration", "gap_in_contact")
    if state.force == 0.0 or model.prescribed:
        return dict.fromkeys(names, 0.0) | {"equilibrium": state.residual} | excess
    total, active = problem.share * state.force, state.active
    reaction = model.body.internal_force(stress)[problem.normal]
    gap = problem.gap(state.u, state.approach) / abs(state.approach)
    return {
        "force_balance": abs(float(reaction[active].sum()) / total - 1.0),
        "tension": max(0.0, -float(reaction[active].min(initial=0.0)) / total),
        "penetration": max(0.0, -float(gap[~active].min(initial=0.0))),
        "gap_in_contact": float(np.abs(gap[active]).max()),
        "equilibrium": state.residual,
        **excess,
    }


def discretisation(model: Model) -> dict[str, object]:
    """The mesh, in SI units."""
    length, lines, film = model.scales.length, model.lines, model.body.film
    layers = (
        {}
        if film is None
        else {"film_thickness_m": film.thickness * length, "film_layers": model.film_layers}
    )
    return {
        "element": "8-node hexahedron, mean dilatation, 2 x 2 x 2 Gauss points",
        "bodies": 1,
        "symmetry": "half, y >= 0" if lines.half else "none",
        "cells_per_radius": model.cells_per_radius,
        "reference_radius_m": length,
        "h_m": float(np.diff(lines.x).min()) * length,
        "box_m": float(lines.z[-1]) * length,
        **layers,
        "elements": int(np.prod(lines.shape)),
        "dofs": model.problem.size,
        "far_field": FAR_FIELD[film is not None].replace(
            "the point force", "the normal and tangential point force"
        ),
    }
