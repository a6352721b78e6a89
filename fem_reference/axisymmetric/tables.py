# SPDX-License-Identifier: MIT
"""Tables and fields of a result, in SI units, with the columns of sam.scene.result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.axisymmetric.model import Model
from fem_reference.axisymmetric.recovery import Stresses, largest_peeq, stresses
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import Step
from sam.scene.result import AXIS, CYCLES, HISTORY, LINE, PLANE, FieldMesh, Table


def columns(names: Sequence[str], values: Sequence) -> Table:
    """Table from its columns in file order; a single number or text is repeated in every row."""
    rows = max(np.size(value) for value in values)
    return {name: np.broadcast_to(value, rows).copy() for name, value in zip(names, values, strict=True)}


def stacked(tables: Sequence[Table]) -> Table:
    """Tables of equal columns, one below the other."""
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def axis_table(state: str, s: Stresses) -> Table:
    """Under the apex; x and y are both radial there."""
    rr, tt, zz, _ = s.axis
    return columns(AXIS, [state, s.axis_z, s.axis_peeq, mises(s.axis), rr, tt, zz, 0.0, 0.0, 0.0])


def line_table(state: str, model: Model, equilibrium: Equilibrium) -> Table:
    """Surface nodes from the axis to the outer boundary; x is r. Beside a punch, under a given pressure: gap NaN."""
    unit = model.scales
    uz = [
        model.problem.body(equilibrium.u, i)[b.solid.boundary_dofs("surface", 1)]
        for i, b in enumerate(model.problem.blocks)
    ]
    gap = model.initial_gap(model.surface) + np.sum(uz, axis=0) - equilibrium.approach
    gap[np.isinf(gap) | model.prescribed] = np.nan
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    values = [
        state,
        model.surface * unit.length,
        pressure,
        0.0,
        gap * unit.displacement,
        uz[0] * unit.displacement,
    ]
    return columns(
        LINE, [*values, np.nan, np.nan]
    )  # tangential displacement and plastic shear belong to friction


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, element by element."""
    return columns(PLANE, [state, s.r.ravel(), s.z.ravel(), s.peeq.ravel(), mises(s.gauss).ravel()])


def history_table(model: Model, steps: Sequence[Step], force: float) -> Table:
    """One row per load step of every cycle. force: at the peak, in N."""
    unit, rows = model.scales, []
    for step in steps:
        state, p_max = step.state, largest_pressure(model, step.state)
        approach = None if model.prescribed else state.approach * unit.displacement
        area = np.pi * (model.contact_radius(state) * unit.length) ** 2
        row = (
            step.cycle,
            step.number,
            force * share(model, state),
            approach,
            area,
            p_max,
            peeq_max(model, state),
        )
        rows.append((*row, 0.0, step.iterations, state.residual, step.note))
    return dict(zip(HISTORY, map(list, zip(*rows, strict=True)), strict=True))


def share(model: Model, state: Equilibrium) -> float:
    """Force over that of the peak."""
    return state.force / (model.scales.peak_force or 1.0)


def largest_pressure(model: Model, state: Equilibrium) -> float:
    """Largest nodal pressure in Pa."""
    return float(model.nodal_pressure(state).max()) * model.scales.pressure


def peeq_max(model: Model, state: Equilibrium) -> float:
    """Largest accumulated plastic strain at a Gauss point or on the axis, as in the quantities."""
    return largest_peeq(stresses(model, state))[0] if state.yielded else 0.0


def cycles_table(model: Model, peaks: Sequence[Step]) -> Table:
    """Cycles at their peaks, without wear and friction. What does not exist (skewness of a plane, film) is None."""
    table = {name: [None] * len(peaks) for name in CYCLES}
    table |= {name: [0.0] * len(peaks) for name in ("wear_volume_m3", "friction_coefficient", "sa_m", "sq_m")}
    table["cycle"] = [step.cycle for step in peaks]
    table["p_max_Pa"] = [largest_pressure(model, step.state) for step in peaks]
    table["peeq_max"] = [peeq_max(model, step.state) for step in peaks]
    return table


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The body in the plane y = 0: pressure at the corner nodes, stress and plastic strain in the elements."""
    unit, points = model.scales, model.mesh.p
    pressure = np.zeros(points.shape[1])
    on_surface = np.flatnonzero(points[1] == 0.0)
    on_surface = on_surface[np.argsort(points[0, on_surface])]
    pressure[on_surface] = model.nodal_pressure(equilibrium)[::2] * unit.pressure
    uz = model.problem.body(equilibrium.u, 0)[model.body.basis.nodal_dofs[1]] * unit.displacement
    stress = s.in_elements(s.gauss)
    cell_data = {"mises_Pa": mises(stress), "stress_Pa": six(stress)}
    if s.plastic_strain is not None:
        cell_data |= {"peeq": s.in_elements(s.peeq), "plastic_strain": six(s.in_elements(s.plastic_strain))}
    return FieldMesh(
        points=np.stack([points[0], np.zeros(points.shape[1]), points[1]], axis=1) * unit.length,
        cells={"quad": model.mesh.t.T.copy()},
        point_data={"p_Pa": pressure, "uz_m": uz},
        cell_data=cell_data,
    )


def six(tensor: np.ndarray) -> np.ndarray:
    """(n, 6), order 11 22 33 23 13 12, of (rr, tt, zz, rz) (4, n) in the plane y = 0."""
    rr, tt, zz, rz = tensor
    zero = np.zeros_like(rr)
    return np.stack([rr, tt, zz, zero, rz, zero], axis=1)
