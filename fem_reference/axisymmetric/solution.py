# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element solution of a scene: contact of a sphere or a flat punch with a half-space.
Tables and fields are in SI units, with the columns of sam.scene.result.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem_reference.axisymmetric import recovery
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.planner import AxisymmetricPlan, plan
from fem_reference.axisymmetric.recovery import Stresses
from fem_reference.common import solution
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.far_field import WORDS, kind_of
from fem_reference.common.loading import Step
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import columns, plane_mesh, stacked
from sam.scene.checkpoint import Checkpoint, Keep
from sam.scene.result import AXIS, LINE, PLANE, FieldMesh, GridFields, Progress, Result, Table
from sam.scene.schema import Scene

SINGULAR = (
    "punch: the pressure is singular at the edge; "
    "p_max_Pa, mises_max_Pa, peeq_max and their depths depend on the mesh"
)


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains under the apex; x and y are both radial there."""
    rr, tt, zz, _ = s.axis
    return columns(AXIS, [state, s.axis_z, s.axis_peeq, mises(s.axis), rr, tt, zz, 0.0, 0.0, 0.0])


def line_table(state: str, model: Model, equilibrium: Equilibrium) -> Table:
    """Surface nodes; x is r. The gap is NaN beside a punch and where the pressure is given."""
    unit, problem, r = model.scales, model.problem, model.surface
    uz = [
        problem.body(equilibrium.u, i)[block.solid.boundary_dofs("surface", 1)]
        for i, block in enumerate(problem.blocks)
    ]
    gap = model.initial_gap(r) + np.sum(uz, axis=0) - equilibrium.approach
    gap[np.isinf(gap) | model.prescribed] = np.nan
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    values = [state, r * unit.length, pressure, 0.0, gap * unit.displacement, uz[0] * unit.displacement]
    # tangential displacement and plastic shear belong to friction
    return columns(LINE, [*values, np.nan, np.nan])


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, element by element."""
    return columns(PLANE, [state, s.r.ravel(), s.z.ravel(), s.peeq.ravel(), mises(s.gauss).ravel()])


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The body in the plane y = 0: pressure at the corner nodes, stresses and strains in the elements."""
    cells = {"stress": s.in_elements(s.gauss)}
    if s.plastic_strain is not None:
        cells |= {"peeq": s.in_elements(s.peeq)[None], "strain": s.in_elements(s.plastic_strain)}
    return plane_mesh(model, equilibrium, model.surface, cells)


def surface_grid(model: Model, equilibrium: Equilibrium) -> GridFields:
    """The surface nodes, a line along r in y = 0: pressure, displacement and, where it is finite, the gap."""
    unit, line = model.scales, line_table("", model, equilibrium)
    dofs = (model.body.boundary_dofs("surface", component) for component in (0, 1))
    ur, uz = (model.problem.body(equilibrium.u, 0)[part] * unit.displacement for part in dofs)
    points = {"p_Pa": np.asarray(line["p_Pa"]), "displacement_m": np.stack([ur, 0 * ur, uz])}
    if np.isfinite(line["gap_m"]).all():
        points["gap_m"] = np.asarray(line["gap_m"])
    flat = {name: values[..., None, None] for name, values in points.items()}
    return GridFields(np.asarray(line["x_m"]), np.zeros(1), np.zeros(1), flat)


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
    *,
    plan: AxisymmetricPlan | None = None,
) -> Result:
    """Solve a frictionless, smooth scene by axisymmetric finite elements.

    Parameters
    ----------
    scene : Scene
        A sphere or a flat punch on a half-space, or a given pressure of Hertz.
    progress : callable, optional
        Called as ``progress("contact", done, total)`` after each load step towards the peak.
    checkpoint : callable, optional
        Called with a Checkpoint after each step of the schedule of a body that can yield.
    start : Checkpoint, optional
        One of them, of the same scene, to go on from there to the same result.
    plan : AxisymmetricPlan, optional
        What `plan` made of the scene; without it that is done here.

    Returns
    -------
    Result
        In SI units; its status says whether it may be used. ``p_max_Pa`` is the largest nodal pressure:
        the multiplier of a surface node over the area that belongs to it, on the axis extrapolated from
        its neighbours.

    Raises
    ------
    UnsupportedScene
        For what this model cannot represent, see `check`.
    ValueError
        For a `start` of another model.
    """
    return solution.solve(METHOD, scene, progress=progress, checkpoint=checkpoint, start=start, plan=plan)


def load_steps(scene: Scene, record: Checkpoint | None = None) -> tuple[Model, list[Step]]:
    """Return the model of a scene and its load steps, for a-posteriori checks of every state.

    Parameters
    ----------
    scene : Scene
        As of `solve`.
    record : Checkpoint, optional
        Of the last step of a solve; without it the steps are taken again, those of the coated contact alone.

    Returns
    -------
    model : Model
        Mesh, bodies and units.
    steps : list of Step
        In their order, up to the first that did not converge.

    Raises
    ------
    UnsupportedScene
        For what this model cannot represent, see `check`.
    """
    return solution.load_steps(METHOD, scene, record)


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    unit = model.scales
    pressure, radius = model.nodal_pressure(peak), model.contact_radius(peak) * unit.length
    force = peak.force if model.prescribed else float(peak.multipliers.sum())
    return {
        "force_N": force * (model.plan.force / (unit.peak_force or 1.0)),
        "contact_area_m2": np.pi * radius**2,
        "contact_radius_m": radius,
        "p_center_Pa": float(pressure[0]) * unit.pressure,
        "pressure_centroid_x_m": 0.0 if pressure.any() else None,
    }


def _residual_quantities(model: Model, left: Equilibrium, s: Stresses) -> Quantities:
    """Quantities of the surface after unloading."""
    centre = model.body.boundary_dofs("surface", 1)[0]
    return {"residual_uz_center_m": float(left.u[centre]) * model.scales.displacement}


def _tables(
    model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, Table]:
    """Tables of the states."""
    return {
        "axis": stacked([axis_table(name, fields[name]) for name in states]),
        "line": stacked([line_table(name, model, states[name]) for name in states]),
        "plane": stacked([plane_table(name, fields[name]) for name in states]),
    }


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    length, plan, coating = model.scales.length, model.plan, model.plan.bodies.coating
    layers = None if coating is None else int(np.searchsorted(plan.z, coating.thickness * (1.0 - 1e-9)))
    return {
        "element": "8-node serendipity quadrilateral, 2 x 2 Gauss points",
        "bodies": len(plan.bodies.elastic),
        "cells_per_radius": plan.cells_per_radius,
        "reference_radius_m": length,
        "h_m": float(model.surface[2] - model.surface[0]) * length,
        "h_edge_m": float(np.diff(model.surface[::2]).min()) * length,
        "box_m": float(model.surface[-1]) * length,
        **solution.coating_elements(model, layers),
        "elements": plan.elements,
        "dofs": plan.unknowns,
        "far_field": WORDS[kind_of(coating)],
    }


METHOD = solution.Method(
    setups="factorizations",
    plan=plan,
    build=build,
    stresses=recovery.stresses,
    largest_mises=recovery.largest_mises,
    largest_peeq=recovery.largest_peeq,
    largest_in_layer=recovery.largest_in_layer,
    contact_quantities=_contact_quantities,
    residual_quantities=_residual_quantities,
    tables=_tables,
    field_mesh=field_mesh,
    surface=surface_grid,
    discretisation=_discretisation,
    warnings=lambda model: (SINGULAR,) if model.plan.punch else (),
)
