# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element solution of a scene: contact of a sphere or a flat punch with a half-space.
Tables and fields are in SI units, with the columns of sam.scene.result.
"""

from __future__ import annotations

import numpy as np

from fem_reference.axisymmetric import recovery
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.planner import plan
from fem_reference.axisymmetric.recovery import Stresses
from fem_reference.common import solution
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.far_field import words_of
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import Surface, columns, plane_mesh
from sam.scene.result import AXIS, PLANE, Table

SINGULAR = (
    "punch: the pressure is singular at the edge; "
    "p_max_Pa, mises_max_Pa, peeq_max and their depths depend on the mesh"
)


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains under the apex; x and y are both radial there."""
    rr, tt, zz, _ = s.axis
    return columns(AXIS, [state, s.axis_z, s.axis_peeq, mises(s.axis), rr, tt, zz, 0.0, 0.0, 0.0])


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, element by element."""
    return columns(PLANE, [state, s.r.ravel(), s.z.ravel(), s.peeq.ravel(), mises(s.stress).ravel()])


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    unit = model.scales
    force = peak.force if model.plan.prescribed else float(peak.multipliers.sum())
    return {
        "force_N": force * (model.plan.force / (unit.peak_force or 1.0)),
        "contact_radius_m": model.contact_radius(peak) * unit.length,
        "pressure_centroid_x_m": 0.0 if model.nodal_pressure(peak).any() else None,
    }


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    length, plan, coating = model.scales.length, model.plan, model.plan.bodies.coating
    layers = None if coating is None else int(np.searchsorted(plan.z, coating.thickness * (1.0 - 1e-9)))
    return {
        "element": "8-node serendipity quadrilateral, 2 x 2 Gauss points",
        "cells_per_radius": plan.cells_per_radius,
        "reference_radius_m": length,
        "h_m": float(model.surface[2] - model.surface[0]) * length,
        "h_edge_m": float(np.diff(model.surface[::2]).min()) * length,
        "box_m": float(model.surface[-1]) * length,
        **solution.coating_elements(model, layers),
        "far_field": words_of(coating),
    }


METHOD = solution.Method(
    setups="factorizations",
    plan=plan,
    build=build,
    stresses=recovery.stresses,
    contact_quantities=_contact_quantities,
    axis=axis_table,
    plane=plane_table,
    field_mesh=lambda model, state, s: plane_mesh(model, state, s.r),
    surface=Surface.of_section,
    discretisation=_discretisation,
    warnings=lambda model: (SINGULAR,) if model.plan.punch else (),
)
solve, load_steps = METHOD.solve, METHOD.load_steps
