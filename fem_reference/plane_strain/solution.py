# SPDX-License-Identifier: MIT
"""Plane-strain finite-element solution of a scene: a cylinder, rigid or elastic, on a half-space. Tables and
fields are in SI units, with the columns of sam.scene.result; forces are on the length of the cylinder.
"""

from __future__ import annotations

import numpy as np

from fem_reference.common import solution
from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import Surface, columns, plane_mesh
from fem_reference.common.track import path_results
from fem_reference.plane_strain import recovery
from fem_reference.plane_strain.model import Model, build
from fem_reference.plane_strain.planner import plan
from fem_reference.plane_strain.recovery import Stresses
from fem_reference.plane_strain.track import LineTrack
from sam.scene.result import AXIS, PLANE, FieldMesh, Table


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains below the origin."""
    xx, yy, zz, xz = s.axis
    return columns(AXIS, [state, s.z, s.axis_peeq, mises(s.axis), xx, yy, zz, 0.0, xz, 0.0])


def surface_of(model: Model, equilibrium: Equilibrium) -> Surface:
    """The surface nodes."""
    dofs, bodies = model.body.boundary_dofs("surface", 1), range(len(model.problem.solids))
    uz = np.sum([model.problem.body(equilibrium.u, i)[dofs] for i in bodies], axis=0)
    gap = model.at(equilibrium.load).initial_gap + uz - equilibrium.approach
    return Surface.of_section(model, equilibrium, model.surface, gap)


def plastic_shear(model: Model, s: Stresses, x: Array | float) -> Array | float:
    """See `fem_reference.common.solution.Method`."""
    if s.plastic_strain is None:
        return 0.0
    height = np.repeat(np.diff(model.plan.z), 2) / 2.0 * model.scales.length
    return np.interp(x, s.x, -2.0 * s.plastic_strain[3] @ height)


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


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    unit = model.scales.length
    return {
        "contact_half_width_m": model.size(peak) * unit,
        "pressure_centroid_x_m": model.centroid(peak) * unit,
    }


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    length, plan = model.scales.length, model.plan
    return {
        "element": "8-node serendipity quadrilateral in plane strain, 2 x 2 Gauss points",
        "symmetry": "half, x >= 0" if plan.half else "none",
        "cells_per_radius": plan.cells_per_radius,
        "reference_half_width_m": length,
        "h_m": float(np.diff(plan.x).min()) * length,
        "box_m": float(plan.z[-1]) * length,
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
    axis=axis_table,
    plane=plane_table,
    field_mesh=field_mesh,
    surface=surface_of,
    discretisation=_discretisation,
    plastic_shear=plastic_shear,
    of_path=lambda model, *of_states: path_results(LineTrack(model), *of_states),
)
solve, load_steps = METHOD.solve, METHOD.load_steps
