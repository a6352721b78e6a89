# SPDX-License-Identifier: MIT
"""Tables and fields of a three-dimensional result, in SI units, with the columns of sam.scene.result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.axisymmetric.tables import columns, share, stacked
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import Step
from fem_reference.spatial.model import Model
from fem_reference.spatial.recovery import Stresses, at_zero, largest_peeq, stresses, with_interface
from sam.scene.result import AXIS, CUT, CYCLES, HISTORY, LINE, PLANE, FieldMesh, Table

VTK_CORNERS = [0, 3, 6, 2, 1, 5, 7, 4]
"""Of a hexahedron of scikit-fem in the order of VTK: skfem.io.meshio has it too, and loads meshio."""
__all__ = [
    "axis_table",
    "cut_table",
    "cycles_table",
    "field_mesh",
    "history_table",
    "line_table",
    "plane_table",
    "share",
    "stacked",
]


def axis_table(state: str, s: Stresses) -> Table:
    """Under the origin, at the depths of the centres of the elements; at the interface of a film with the values below it."""
    layers = with_interface(s)
    return stacked([columns(AXIS, [state, p.z, p.axis_peeq, mises(p.axis), *p.axis]) for p in layers])


def line_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> Table:
    """Surface nodes on y = 0 from one side of the block to the other. No gap where the pressure is given.

    plastic_shear_m: see `plastic_shear`; it and ux_m without friction: NaN.
    """
    unit, y = model.scales, model.lines.y
    ux, _, uz = (on_plane(equilibrium.u[dofs[model.surface]], y) for dofs in model.body.basis.nodal_dofs)
    gap = on_plane(model.initial_gap, y) + uz - equilibrium.approach
    gap = (
        np.full_like(uz, np.nan)
        if model.prescribed
        else np.where(np.isfinite(gap), gap * unit.displacement, np.nan)
    )
    nodal = model.nodal_pressure(equilibrium) * unit.pressure
    pressure, traction = on_plane(nodal, y), on_plane(model.ratio(equilibrium) * nodal, y)
    x = model.lines.x * unit.length
    values = [state, x, pressure, traction, gap, uz * unit.displacement]
    if model.sliding.coefficient == 0.0:
        return columns(LINE, [*values, np.nan, np.nan])
    return columns(LINE, [*values, ux * unit.displacement, np.interp(x, s.x, plastic_shear(model, s))])


def on_plane(values: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Of values (..., n) on the planes of `line` (n,), those at zero; the mean of both sides if no plane is there."""
    zero = int(np.searchsorted(line, 0.0))
    return values[..., zero] if line[zero] == 0.0 else 0.5 * (values[..., zero - 1] + values[..., zero])


def at_origin(values: np.ndarray, model: Model) -> float:
    """Of values (nx + 1, ny + 1) at the surface nodes, that in the origin."""
    return float(on_plane(on_plane(values, model.lines.y), model.lines.x))


def plastic_shear(model: Model, s: Stresses) -> np.ndarray:
    """(nx,) in m: what the surface moves along x by the plastic shear below it, -integral of 2 e_p_xz over z, at y = 0."""
    if s.plastic_strain is None:
        return np.zeros(s.x.size)
    in_plane = at_zero(s.plastic_strain[4], model.lines.y, 1)
    return -2.0 * in_plane @ np.diff(model.lines.z) * model.scales.length


def plane_table(state: str, s: Stresses) -> Table:
    """The plane y = 0, to which the elements beside it are extrapolated, at the x and z of their centres, x by x.

    At the interface of a film as well, with the values below it.
    """
    layers = with_interface(s)
    x, z = np.meshgrid(s.x, np.concatenate([part.z for part in layers]), indexing="ij")
    peeq, plane = (
        np.concatenate([getattr(part, name) for part in layers], axis=-1) for name in ("plane_peeq", "plane")
    )
    return columns(PLANE, [state, x.ravel(), z.ravel(), peeq.ravel(), mises(plane).ravel()])


def cut_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> Table:
    """The plane y = const through the node of the largest pressure: the mean of the elements on both of its sides.

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


def history_table(model: Model, steps: Sequence[Step], force: float) -> Table:
    """One row per load step of every cycle. force: at the peak, in N."""
    unit, rows = model.scales, []
    for step in steps:
        state = step.state
        approach = None if model.prescribed else state.approach * unit.displacement
        area, p_max = model.area(state) * unit.length**2, largest_pressure(model, state)
        strained = peeq(model, state)
        row = (step.cycle, step.number, force * share(model, state), approach, area, p_max, strained)
        rows.append((*row, model.friction(state), step.iterations, state.residual, step.note))
    return dict(zip(HISTORY, map(list, zip(*rows, strict=True)), strict=True))


def largest_pressure(model: Model, state: Equilibrium) -> float:
    """Largest nodal pressure in Pa; of a given one the largest at any node."""
    return float(model.nodal_pressure(state).max()) * model.scales.pressure


def peeq(model: Model, state: Equilibrium) -> float:
    """Largest accumulated plastic strain, as in the quantities."""
    return largest_peeq(stresses(model, state))[0] if state.yielded else 0.0


def cycles_table(model: Model, peaks: Sequence[Step]) -> Table:
    """Cycles at their peaks, without wear. What does not exist (skewness of a plane, film) is None."""
    table = {name: [None] * len(peaks) for name in CYCLES}
    table |= {name: [0.0] * len(peaks) for name in ("wear_volume_m3", "sa_m", "sq_m")}
    table["friction_coefficient"] = [model.friction(step.state) for step in peaks]
    table["cycle"] = [step.cycle for step in peaks]
    table["p_max_Pa"] = [largest_pressure(model, step.state) for step in peaks]
    table["peeq_max"] = [peeq(model, step.state) for step in peaks]
    return table


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The block (of a half: y >= 0), pressure and displacement at the nodes, stress and plastic strain in the elements."""
    unit, mesh = model.scales, model.problem.mesh
    pressure = np.zeros(mesh.p.shape[1])
    pressure[model.surface] = model.nodal_pressure(equilibrium) * unit.pressure
    uz = equilibrium.u[model.body.basis.nodal_dofs[2]] * unit.displacement
    by_number = np.argsort(model.elements, axis=None)

    def cells(field: np.ndarray) -> np.ndarray:
        return field.reshape(*field.shape[:-3], -1)[..., by_number].T

    cell_data = {"mises_Pa": cells(mises(s.stress)), "stress_Pa": cells(s.stress)}
    if s.plastic_strain is not None:
        cell_data |= {"peeq": cells(s.peeq), "plastic_strain": cells(s.plastic_strain)}
    return FieldMesh(
        points=mesh.p.T * unit.length,
        cells={"hexahedron": mesh.t[VTK_CORNERS].T.copy()},
        point_data={"p_Pa": pressure, "uz_m": uz},
        cell_data=cell_data,
    )
