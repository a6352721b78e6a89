# SPDX-License-Identifier: MIT
"""Tables and fields of a result of the axisymmetric model, in SI units, with the columns of
sam.scene.result.
"""

from __future__ import annotations

import numpy as np

from fem_reference.axisymmetric.model import Model
from fem_reference.axisymmetric.recovery import Stresses
from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.tables import columns
from sam.scene.result import AXIS, LINE, PLANE, FieldMesh, GridFields, Table


def axis_table(state: str, s: Stresses) -> Table:
    """Stresses and strains under the apex; x and y are both radial there."""
    rr, tt, zz, _ = s.axis
    return columns(AXIS, [state, s.axis_z, s.axis_peeq, mises(s.axis), rr, tt, zz, 0.0, 0.0, 0.0])


def line_table(state: str, model: Model, equilibrium: Equilibrium) -> Table:
    """Surface nodes from the axis to the outer boundary; x is r. Beside a punch, under a given pressure:
    gap NaN.
    """
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
    unit, mesh = model.scales, model.body.basis.mesh
    points = mesh.p
    pressure = np.zeros(points.shape[1])
    on_surface = np.flatnonzero(points[1] == 0.0)
    on_surface = on_surface[np.argsort(points[0, on_surface])]
    pressure[on_surface] = model.nodal_pressure(equilibrium)[::2] * unit.pressure
    u = model.problem.body(equilibrium.u, 0) * unit.displacement
    ur, uz = (u[dofs] for dofs in model.body.basis.nodal_dofs)
    stress = s.in_elements(s.gauss)
    cell_data = {"mises_Pa": mises(stress), "stress_Pa": six(stress)}
    if s.plastic_strain is not None:
        cell_data |= {"peeq": s.in_elements(s.peeq), "plastic_strain": six(s.in_elements(s.plastic_strain))}
    return FieldMesh(
        points=np.stack([points[0], np.zeros(points.shape[1]), points[1]], axis=1) * unit.length,
        cells={"quad": mesh.t.T.copy()},
        point_data={"p_Pa": pressure, "uz_m": uz, "displacement_m": np.stack([ur, 0 * ur, uz], axis=1)},
        cell_data=cell_data,
    )


def surface_grid(model: Model, equilibrium: Equilibrium) -> GridFields:
    """The surface nodes, a line along r in y = 0: pressure, displacement and, where it is finite, the gap."""
    unit, line = model.scales, line_table("", model, equilibrium)
    dofs = (model.body.boundary_dofs("surface", component) for component in (0, 1))
    ur, uz = (model.problem.body(equilibrium.u, 0)[each] * unit.displacement for each in dofs)
    points = {"p_Pa": np.asarray(line["p_Pa"]), "displacement_m": np.stack([ur, 0 * ur, uz])}
    if np.isfinite(line["gap_m"]).all():
        points["gap_m"] = np.asarray(line["gap_m"])
    flat = {name: values[..., None, None] for name, values in points.items()}
    return GridFields(np.asarray(line["x_m"]), np.zeros(1), np.zeros(1), flat)


def six(tensor: Array) -> Array:
    """(n, 6), order 11 22 33 23 13 12, of (rr, tt, zz, rz) (4, n) in the plane y = 0."""
    rr, tt, zz, rz = tensor
    zero = np.zeros_like(rr)
    return np.stack([rr, tt, zz, zero, rz, zero], axis=1)
