# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element solution of a scene: elastic contact of a sphere or a flat punch with a half-space."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

import numpy as np

from fem_reference import tables
from fem_reference.contact import Equilibrium
from fem_reference.mesh import CORE
from fem_reference.model import Model, build, load, unloaded
from fem_reference.recovery import Stresses, largest_mises, stresses
from fem_reference.support import check, left_out
from sam.scene.result import COST, QUANTITIES, Progress, Result, Status
from sam.scene.schema import Loading, Scene

MODEL = "fem-axisymmetric"
FEWEST_ELEMENTS = 4
"""Elements in the contact radius below which a result is called under-resolved (pressure in the centre off by 1 %)."""
MESSAGES = {
    Status.CONVERGED: "",
    Status.NOT_CONVERGED: "the contact iteration did not settle: change fem.cells_per_radius",
    Status.CONTACT_AT_GRID_EDGE: "the contact reaches the edge of the fine mesh: lower loading.force",
    Status.UNDER_RESOLVED: f"fewer than {FEWEST_ELEMENTS} elements in the contact radius: raise fem.cells_per_radius",
}
SINGULAR = (
    "punch: the pressure is singular at the edge; p_max_Pa, mises_max_Pa and mises_max_depth_m depend on the mesh"
)


def solve(scene: Scene, progress: Progress | None = None) -> Result:
    """Solve an elastic, frictionless, smooth scene by finite elements.

    progress: called as progress("contact", done, total) after each load step. Returns a Result, whose status says
    whether it may be used. Raises UnsupportedScene for what this model cannot represent (see fem_reference.check).
    """
    check(scene)
    began = time.perf_counter()
    model = build(scene)
    ready = time.perf_counter()
    steps = loading_steps(model, scene.loading, progress)
    states = {"peak": steps[scene.loading.steps - 1]}
    if scene.loading.unload:
        states["unloaded"] = steps[-1]
    fields = {name: stresses(model, state) for name, state in states.items()}
    quantities = scalar_results(scene, model, states["peak"], fields["peak"])
    status = judge(model, steps)
    out = {
        "history": tables.history_table(model, scene.loading, steps),
        "axis": tables.stacked([tables.axis_table(name, fields[name]) for name in states]),
        "line": tables.stacked([tables.line_table(name, model, states[name]) for name in states]),
        "plane": tables.stacked([tables.plane_table(name, fields[name]) for name in states]),
    }
    if scene.loading.cycles > 1:
        out["cycles"] = tables.cycles_table(scene.loading, quantities["p_max_Pa"])
    return Result(
        model=MODEL,
        status=status,
        quantities=quantities,
        tables=out,
        fields=tables.field_mesh(model, states["peak"], fields["peak"]),
        left_out=left_out(scene),
        discretisation=discretisation(model, scene),
        certificate=certificate(model, states["peak"]),
        cost=cost(steps, setup_s=ready - began, solve_s=time.perf_counter() - ready),
        message=MESSAGES[status],
        warnings=(SINGULAR,) if model.punch else (),
    )


def loading_steps(model: Model, loading: Loading, progress: Progress | None) -> list[Equilibrium]:
    """Equal force steps to the peak, and the unloaded state if the scene unloads (elastic: exact in one step)."""
    steps: list[Equilibrium] = []
    peak = model.scales.peak_force
    for k in range(1, loading.steps + 1):
        previous = steps[-1] if steps else None
        steps.append(load(model, peak * k / loading.steps, previous) if peak > 0.0 else unloaded(model))
        if progress is not None:
            progress("contact", k, loading.steps)
    return [*steps, unloaded(model)] if loading.unload else steps


def scalar_results(scene: Scene, model: Model, peak: Equilibrium, s: Stresses) -> dict[str, float | None]:
    """Every name of QUANTITIES, None where it does not apply to an elastic, uncoated, smooth scene."""
    unit, pressure = model.scales, model.nodal_pressure(peak)
    radius = model.contact_radius(peak) * unit.length
    largest, depth = largest_mises(s)
    values = {
        "force_N": float(peak.multipliers.sum()) * scene.loading.force / (unit.peak_force or 1.0),
        "approach_m": peak.approach * unit.displacement,
        "contact_area_m2": np.pi * radius**2,
        "contact_radius_m": radius,
        "p_max_Pa": float(pressure.max()) * unit.pressure,
        "p_center_Pa": float(pressure[0]) * unit.pressure,
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "peeq_max": 0.0,
        "friction_coefficient": 0.0,
        "wear_volume_m3": 0.0,
    }
    if scene.loading.unload:
        values |= {"residual_uz_center_m": 0.0, "residual_mises_max_Pa": 0.0}
    return {name: values.get(name) for name in QUANTITIES}


def judge(model: Model, steps: Sequence[Equilibrium]) -> Status:
    """Status of the load steps; the mesh is judged at the largest contact."""
    if not all(step.converged for step in steps):
        return Status.NOT_CONVERGED
    if model.scales.peak_force == 0.0:
        return Status.CONVERGED
    radius = max(model.contact_radius(step) for step in steps)
    if not model.punch and radius >= CORE:
        return Status.CONTACT_AT_GRID_EDGE
    if round(radius * model.cells_per_radius) < FEWEST_ELEMENTS:
        return Status.UNDER_RESOLVED
    return Status.CONVERGED


def certificate(model: Model, state: Equilibrium) -> dict[str, float]:
    """Conditions of contact, measured on the returned displacements; all zero in an exact solution.

    force_balance: |sum(lambda) - F| / F; tension: largest -lambda / F, without the node on the axis, whose area is zero
    (and whose share of a pressure growing with r is negative); penetration: largest -gap outside contact / approach;
    gap_in_contact: largest |gap| in contact / approach; equilibrium: largest force on a free degree of freedom / F.
    """
    if state.force == 0.0:
        return dict.fromkeys(("force_balance", "tension", "penetration", "gap_in_contact", "equilibrium"), 0.0)
    reaction = model.problem.internal_force(state.u)[model.problem.normal[model.problem.slave]]
    gap = model.problem.gap(state.u, state.approach) / abs(state.approach)
    return {
        "force_balance": abs(float(reaction[state.active].sum()) / state.force - 1.0),
        "tension": max(0.0, -float(reaction[1:][state.active[1:]].min(initial=0.0)) / state.force),
        "penetration": max(0.0, -float(gap[~state.active].min(initial=0.0))),
        "gap_in_contact": float(np.abs(gap[state.active]).max()),
        "equilibrium": state.residual,
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
        "elements": model.mesh.nelements * len(model.problem.blocks),
        "dofs": model.problem.size,
        "far_field": "displacements of the point force on the outer boundary",
    }


def cost(steps: Sequence[Equilibrium], setup_s: float, solve_s: float) -> Mapping[str, float | int | None]:
    """Every name of COST. Contact and equilibrium share one Newton loop, so that their iterations are the same."""
    iterations = sum(step.iterations for step in steps)
    values = {
        "setup_s": setup_s,
        "solve_s": solve_s,
        "contact_iterations": iterations,
        "newton_iterations": iterations,
        "step_cuts": 0,
    }
    return {name: values.get(name) for name in COST}
