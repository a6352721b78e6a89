# SPDX-License-Identifier: MIT
"""Tables and fields of a three-dimensional result, in SI units, with the columns of sam.scene.result."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.tables import columns, stacked
from fem_reference.spatial.model import Model
from fem_reference.spatial.recovery import Stresses, at_zero, with_interface
from sam.scene.result import AXIS, CUT, LINE, PLANE, FieldMesh, GridFields

VTK_CORNERS = [0, 3, 6, 2, 1, 5, 7, 4]
"""Corners of a hexahedron of scikit-fem in the order of VTK; skfem.io.meshio has it too, and loads meshio."""


def axis_table(state: str, s: Stresses) -> dict[str, Any]:
    """Stresses and strains under the origin, at the depths of the centres of the elements; at the interface
    of a coating with the values below it.
    """
    layers = with_interface(s)
    return stacked([columns(AXIS, [state, p.z, p.axis_peeq, mises(p.axis), *p.axis]) for p in layers])


def line_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> dict[str, Any]:
    """Surface nodes on y = 0 from one side of the block to the other. No gap where the pressure is given.

    plastic_shear_m: see `plastic_shear`; it and ux_m without friction: NaN.
    """
    unit, y = model.scales, model.lines.y
    ux, _, uz = (on_plane(equilibrium.u[dofs[model.surface]], y) for dofs in model.body.basis.nodal_dofs)
    gap = on_plane(model.at(equilibrium.load).initial_gap, y) + uz - equilibrium.approach
    gap = np.where(np.isfinite(gap) & (not model.prescribed), gap * unit.displacement, np.nan)
    nodal = model.nodal_pressure(equilibrium) * unit.pressure
    pressure, traction = on_plane(nodal, y), on_plane(model.ratio(equilibrium) * nodal, y)
    x = model.lines.x * unit.length
    values = [state, x, pressure, traction, gap, uz * unit.displacement]
    if model.plan.sliding.coefficient == 0.0:
        return columns(LINE, [*values, np.nan, np.nan])
    return columns(LINE, [*values, ux * unit.displacement, np.interp(x, s.x, plastic_shear(model, s))])


def on_plane(values: Array, line: Array) -> Array:
    """Values at zero of those (..., n) on the planes of `line` (n,); the mean of both sides if no plane is
    there.
    """
    zero = int(np.searchsorted(line, 0.0))
    return values[..., zero] if line[zero] == 0.0 else 0.5 * (values[..., zero - 1] + values[..., zero])


def at_origin(values: Array, model: Model) -> float:
    """Value in the origin of those (nx + 1, ny + 1) at the surface nodes."""
    return float(on_plane(on_plane(values, model.lines.y), model.lines.x))


def plastic_shear(model: Model, s: Stresses) -> Array:
    """(nx,) in m: what the surface moves along x by the plastic shear below it, -integral of 2 e_p_xz over
    z, at y = 0.
    """
    if s.plastic_strain is None:
        return np.zeros(s.x.size)
    in_plane = at_zero(s.plastic_strain[4], model.lines.y, 1)
    return -2.0 * in_plane @ np.diff(model.lines.z) * model.scales.length


def plane_table(state: str, s: Stresses) -> dict[str, Any]:
    """The plane y = 0, to which the elements beside it are extrapolated, at the x and z of their centres, x
    by x.

    At the interface of a coating as well, with the values below it.
    """
    layers = with_interface(s)
    x, z = np.meshgrid(s.x, np.concatenate([part.z for part in layers]), indexing="ij")
    peeq, plane = (
        np.concatenate([getattr(part, name) for part in layers], axis=-1) for name in ("plane_peeq", "plane")
    )
    return columns(PLANE, [state, x.ravel(), z.ravel(), peeq.ravel(), mises(plane).ravel()])


def cut_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> dict[str, Any]:
    """The plane y = const through the node of the largest pressure: the mean of the elements on both of its
    sides.

    In y = 0 the values of `plane_table`, of which the elements beside it are no better ones.
    """
    pressure = model.nodal_pressure(equilibrium)
    j = int(np.unravel_index(pressure.argmax(), pressure.shape)[1])
    y = float(model.lines.y[j])
    beside = slice(max(j - 1, 0), j + 1)
    stress, peeq = (
        (s.plane, s.plane_peeq)
        if y == 0.0
        else (s.stress[:, :, beside].mean(axis=2), s.peeq[:, beside].mean(axis=1))
    )
    x, z = np.meshgrid(s.x, s.z, indexing="ij")
    place = [x.ravel(), y * model.scales.length, z.ravel()]
    components = stress.reshape(6, -1)
    return columns(CUT, [state, *place, peeq.ravel(), mises(components), *components])


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The block (of a half: y >= 0), pressure and displacement at the nodes, stress and plastic strain in
    the elements.
    """
    unit, mesh = model.scales, model.problem.mesh
    pressure = np.zeros(mesh.p.shape[1])
    pressure[model.surface] = model.nodal_pressure(equilibrium) * unit.pressure
    u = equilibrium.u[model.body.basis.nodal_dofs] * unit.displacement
    by_number = np.argsort(model.elements, axis=None)

    def cells(field: Array) -> Array:
        return field.reshape(*field.shape[:-3], -1)[..., by_number].T

    cell_data = {"mises_Pa": cells(mises(s.stress)), "stress_Pa": cells(s.stress)}
    if s.plastic_strain is not None:
        cell_data |= {"peeq": cells(s.peeq), "plastic_strain": cells(s.plastic_strain)}
    return FieldMesh(
        points=mesh.p.T * unit.length,
        cells={"hexahedron": mesh.t[VTK_CORNERS].T.copy()},
        point_data={"p_Pa": pressure, "uz_m": u[2], "displacement_m": u.T.copy()},
        cell_data=cell_data,
    )


def surface_grid(model: Model, equilibrium: Equilibrium) -> GridFields:
    """The surface nodes (of a half: y >= 0): pressure, displacement, with friction traction and coefficient,
    and the gap where it is finite everywhere.
    """
    unit, pressure = model.scales, model.nodal_pressure(equilibrium) * model.scales.pressure
    u = equilibrium.u[model.body.basis.nodal_dofs[:, model.surface]] * unit.displacement
    points = {"p_Pa": pressure, "displacement_m": u}
    if model.plan.sliding.coefficient != 0.0:
        ratio = model.ratio(equilibrium)
        points |= {"qx_Pa": ratio * pressure, "friction": np.abs(ratio) * (pressure > 0.0)}
    gap = (
        model.at(equilibrium.load).initial_gap * unit.displacement
        + u[2]
        - equilibrium.approach * unit.displacement
    )
    if np.isfinite(gap).all() and not model.prescribed:
        points["gap_m"] = gap
    x, y = (line * unit.length for line in (model.lines.x, model.lines.y))
    return GridFields(x, y, np.zeros(1), {name: values[..., None] for name, values in points.items()})
