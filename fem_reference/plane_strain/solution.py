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
from sam.scene.result import AXIS, PLANE, Table


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains below the origin."""
    xx, yy, zz, xz = s.axis
    return columns(AXIS, [state, s.z, s.axis_peeq, mises(s.axis), xx, yy, zz, 0.0, xz, 0.0])


def plastic_shear(model: Model, s: Stresses, x: Array | float) -> Array | float:
    """See `fem_reference.common.solution.Method`."""
    if s.plastic_strain is None:
        return 0.0
    height = np.repeat(np.diff(model.plan.z), 2) / 2.0 * model.scales.length
    return np.interp(x, s.x, -2.0 * s.plastic_strain[3] @ height)


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, column by column."""
    x, z = np.meshgrid(s.x, s.z, indexing="ij")
    return columns(PLANE, [state, x.ravel(), z.ravel(), s.peeq.ravel(), mises(s.stress).ravel()])


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
    contact_quantities=_contact_quantities,
    axis=axis_table,
    plane=plane_table,
    field_mesh=lambda model, state, _: plane_mesh(model, state, np.ones_like(model.body.weights)),
    surface=Surface.of_section,
    discretisation=_discretisation,
    plastic_shear=plastic_shear,
    of_path=lambda model, *of_states: path_results(LineTrack(model), *of_states),
)
solve, load_steps = METHOD.solve, METHOD.load_steps
