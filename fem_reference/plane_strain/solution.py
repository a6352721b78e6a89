# SPDX-License-Identifier: MIT
"""Plane-strain finite-element solution of a scene: a cylinder, rigid or elastic, on a half-space. Tables and
fields are in SI units, with the columns of sam.scene.result; forces are on the length of the cylinder.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem_reference.common import solution
from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import Step
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import columns, plane_mesh, stacked
from fem_reference.common.track import path_results
from fem_reference.plane_strain import recovery
from fem_reference.plane_strain.model import Model, build
from fem_reference.plane_strain.planner import PlaneStrainPlan, plan
from fem_reference.plane_strain.recovery import Stresses
from fem_reference.plane_strain.track import LineTrack
from sam.scene.checkpoint import Checkpoint, Keep
from sam.scene.result import AXIS, LINE, PLANE, FieldMesh, GridFields, Progress, Result, Table
from sam.scene.schema import Scene


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains below the origin."""
    xx, yy, zz, xz = s.axis
    return columns(AXIS, [state, s.z, s.axis_peeq, mises(s.axis), xx, yy, zz, 0.0, xz, 0.0])


def line_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> Table:
    """Surface nodes; NaN in ux_m and plastic_shear_m without friction."""
    unit, x, ratio = model.scales, model.surface * model.scales.length, equilibrium.load.ratio
    ux, uz = surface_displacement(model, equilibrium)
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    values = [state, x, pressure, ratio * pressure, surface_gap(model, equilibrium), uz]
    if model.plan.sliding.coefficient == 0.0:
        return columns(LINE, [*values, np.nan, np.nan])
    return columns(LINE, [*values, ux, np.interp(x, s.x, plastic_shear(model, s))])


def surface_displacement(model: Model, equilibrium: Equilibrium) -> tuple[Array, Array]:
    """(u_x, u_z) of the surface nodes in m."""
    u = model.displacements(equilibrium) * model.scales.displacement
    return u[model.body.boundary_dofs("surface", 0)], u[model.body.boundary_dofs("surface", 1)]


def surface_gap(model: Model, equilibrium: Equilibrium) -> Array:
    """Gap at the surface nodes in m."""
    dofs, bodies = model.body.boundary_dofs("surface", 1), range(len(model.problem.solids))
    uz = np.sum([model.problem.body(equilibrium.u, i)[dofs] for i in bodies], axis=0)
    gap = model.at(equilibrium.load).initial_gap + uz - equilibrium.approach
    return np.asarray(gap * model.scales.displacement)


def plastic_shear(model: Model, s: Stresses) -> Array:
    """(nx,) in m: what plastic shear moves the surface along x, -integral of 2 e_p_xz over z."""
    if s.plastic_strain is None:
        return np.zeros(s.x.size)
    height = np.repeat(np.diff(model.plan.z), 2) / 2.0 * model.scales.length
    out: Array = -2.0 * s.plastic_strain[3] @ height
    return out


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, column by column."""
    x, z = np.meshgrid(s.x, s.z, indexing="ij")
    return columns(PLANE, [state, x.ravel(), z.ravel(), s.peeq.ravel(), mises(s.gauss).ravel()])


def in_elements(model: Model, field: Array) -> Array:
    """(k, n_elements) means over the four points of each element, of (k, 2 nx, 2 nz)."""
    flat = np.empty((len(field), model.body.weights.size))
    flat[:, recovery.columns_of_points(model).ravel()] = field.reshape(len(field), -1)
    out: Array = flat.reshape(len(field), *model.body.weights.shape).mean(axis=-1)
    return out


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The section: pressure and displacement at the corner nodes, stresses and strains in the elements."""
    cells = {"stress": in_elements(model, s.gauss)}
    if s.plastic_strain is not None:
        cells |= {"peeq": in_elements(model, s.peeq[None]), "strain": in_elements(model, s.plastic_strain)}
    return plane_mesh(model, equilibrium, model.surface, cells)


def surface_grid(model: Model, equilibrium: Equilibrium) -> GridFields:
    """The surface nodes, a line along x in y = 0: pressure, displacement, gap and friction."""
    ux, uz = surface_displacement(model, equilibrium)
    pressure = model.nodal_pressure(equilibrium) * model.scales.pressure
    points = {"p_Pa": pressure, "displacement_m": np.stack([ux, 0 * ux, uz])}
    points["gap_m"] = surface_gap(model, equilibrium)
    if ratio := equilibrium.load.ratio:
        points |= {"qx_Pa": ratio * pressure, "friction": abs(ratio) * (pressure > 0.0)}
    flat = {name: values[..., None, None] for name, values in points.items()}
    return GridFields(model.surface * model.scales.length, np.zeros(1), np.zeros(1), flat)


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
    *,
    plan: PlaneStrainPlan | None = None,
) -> Result:
    """Solve a line contact with or without friction by finite elements in plane strain.

    Parameters
    ----------
    scene : Scene
        A cylinder, rigid or elastic, on a smooth half-space.
    progress, checkpoint, start, plan : optional
        As of `fem_reference.solve`.

    Returns
    -------
    Result
        In SI units; its status says whether it may be used. ``p_max_Pa`` is the largest nodal pressure:
        the multiplier of a surface node over the area that belongs to it. Displacements and the approach
        count from the surface at half the length of the cylinder beside its axis under the same line force.

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
        Of the last step of a solve; without it the steps are taken again.

    Returns
    -------
    model : Model
        Mesh, bodies, friction and units.
    steps : list of Step
        In their order, up to the first that did not converge; of a record of a counter-body that moves those
        inside a pass without displacements and strains.

    Raises
    ------
    UnsupportedScene
        For what this model cannot represent, see `check`.
    """
    return solution.load_steps(METHOD, scene, record)


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    unit = model.scales
    quantities: Quantities = {
        "force_N": model.plan.force * model.share(peak),
        "contact_area_m2": model.contact_area(peak),
        "contact_half_width_m": model.half_width(peak) * unit.length,
        "p_center_Pa": _centre(model, model.nodal_pressure(peak)) * unit.pressure,
        "pressure_centroid_x_m": model.centroid(peak) * unit.length,
    }
    if model.plan.sliding.coefficient > 0.0:
        quantities["tangential_displacement_center_m"] = _centre(model, surface_displacement(model, peak)[0])
    return quantities


def _residual_quantities(model: Model, left: Equilibrium, s: Stresses) -> Quantities:
    """Quantities of the surface after unloading."""
    ux, uz = surface_displacement(model, left)
    quantities: Quantities = {"residual_uz_center_m": _centre(model, uz)}
    if model.plan.sliding.coefficient > 0.0:
        quantities["residual_ux_center_m"] = _centre(model, ux)
        quantities["plastic_shear_center_m"] = float(np.interp(0.0, s.x, plastic_shear(model, s)))
    return quantities


def _centre(model: Model, values: Array) -> float:
    """Value at the surface node in the origin."""
    return float(values[np.searchsorted(model.surface, 0.0)])


def _of_path(
    model: Model, steps: Sequence[Step], states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> tuple[dict[str, Table], Quantities]:
    """What a counter-body that moves adds to the tables and quantities."""
    return path_results(LineTrack(model), steps, states, fields) if model.plan.sliding.moves else ({}, {})


def _tables(
    model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, Table]:
    """Tables of the states."""
    return {
        "axis": stacked([axis_table(name, fields[name]) for name in states]),
        "line": stacked([line_table(name, model, states[name], fields[name]) for name in states]),
        "plane": stacked([plane_table(name, fields[name]) for name in states]),
    }


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    length, plan = model.scales.length, model.plan
    return {
        "element": "8-node serendipity quadrilateral in plane strain, 2 x 2 Gauss points",
        "bodies": len(plan.bodies.elastic),
        "symmetry": "half, x >= 0" if plan.half else "none",
        "cells_per_radius": plan.cells_per_radius,
        "reference_half_width_m": length,
        "h_m": float(np.diff(plan.x).min()) * length,
        "box_m": float(plan.z[-1]) * length,
        "elements": plan.elements,
        "dofs": plan.unknowns,
        "far_field": "displacements of the normal and tangential line force on the outer boundary",
        "datum_m": 0.5 * plan.length * length,
    }


METHOD = solution.Method(
    setups="factorizations",
    plan=plan,
    build=build,
    stresses=recovery.stresses,
    largest_mises=recovery.largest_mises,
    largest_peeq=recovery.largest_peeq,
    largest_in_layer=lambda s, _coating: recovery.largest_mises(s),
    contact_quantities=_contact_quantities,
    residual_quantities=_residual_quantities,
    tables=_tables,
    field_mesh=field_mesh,
    surface=surface_grid,
    discretisation=_discretisation,
    of_path=_of_path,
)
