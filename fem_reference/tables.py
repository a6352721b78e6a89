# SPDX-License-Identifier: MIT
"""Tables and fields of a result, in SI units, with the columns of sam.scene.result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_reference.contact import Equilibrium
from fem_reference.elasticity import mises
from fem_reference.model import Model
from fem_reference.recovery import Stresses
from sam.scene.result import AXIS, CYCLES, HISTORY, LINE, PLANE, FieldMesh, Table
from sam.scene.schema import Loading

UNLOADING_NOTE = "elastic: unloading in one step"


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
    return columns(AXIS, [state, s.axis_z, 0.0, mises(s.axis), rr, tt, zz, 0.0, 0.0, 0.0])


def line_table(state: str, model: Model, equilibrium: Equilibrium) -> Table:
    """Surface nodes from the axis to the outer boundary; x is r. Beside a punch there is no gap: NaN."""
    unit = model.scales
    uz = [
        model.problem.body(equilibrium.u, i)[b.solid.boundary_dofs("surface", 1)]
        for i, b in enumerate(model.problem.blocks)
    ]
    gap = model.initial_gap(model.surface) + np.sum(uz, axis=0) - equilibrium.approach
    gap[np.isinf(gap)] = np.nan
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    values = [state, model.surface * unit.length, pressure, 0.0, gap * unit.displacement, uz[0] * unit.displacement]
    return columns(LINE, values)


def plane_table(state: str, s: Stresses) -> Table:
    """Gauss points, element by element."""
    return columns(PLANE, [state, s.r.ravel(), s.z.ravel(), 0.0, mises(s.gauss).ravel()])


def history_table(model: Model, loading: Loading, steps: Sequence[Equilibrium]) -> Table:
    """One row per load step, the unloaded state last if the scene unloads; later cycles repeat the first."""
    unit, rows = model.scales, []
    for cycle in range(1, loading.cycles + 1):
        for number, step in enumerate(steps, start=1):
            notes = [UNLOADING_NOTE] if number > loading.steps else []
            notes += ["elastic: equal to cycle 1"] if cycle > 1 else []
            force = loading.force * number / loading.steps if number <= loading.steps else 0.0
            area = np.pi * (model.contact_radius(step) * unit.length) ** 2
            p_max = model.nodal_pressure(step).max() * unit.pressure
            approach = step.approach * unit.displacement
            work = (step.iterations, step.residual) if cycle == 1 else (0, step.residual)
            rows.append((cycle, number, force, approach, area, p_max, 0.0, 0.0, *work, "; ".join(notes)))
    return dict(zip(HISTORY, map(list, zip(*rows, strict=True)), strict=True))


def cycles_table(loading: Loading, p_max: float) -> Table:
    """Smooth, elastic and frictionless: nothing changes. What does not exist (skewness of a plane, film) is None."""
    cycle = dict.fromkeys(("wear_volume_m3", "friction_coefficient", "sa_m", "sq_m", "peeq_max"), 0.0)
    cycle["p_max_Pa"] = p_max
    table = {name: [cycle.get(name)] * loading.cycles for name in CYCLES}
    return table | {"cycle": list(range(1, loading.cycles + 1))}


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The body in the plane y = 0: pressure at the corner nodes, stress (order 11 22 33 23 13 12) in the elements."""
    unit, points = model.scales, model.mesh.p
    pressure = np.zeros(points.shape[1])
    on_surface = np.flatnonzero(points[1] == 0.0)
    on_surface = on_surface[np.argsort(points[0, on_surface])]
    pressure[on_surface] = model.nodal_pressure(equilibrium)[::2] * unit.pressure
    uz = model.problem.body(equilibrium.u, 0)[model.body.basis.nodal_dofs[1]] * unit.displacement
    rr, tt, zz, rz = s.elements
    zero = np.zeros_like(rr)
    return FieldMesh(
        points=np.stack([points[0], np.zeros(points.shape[1]), points[1]], axis=1) * unit.length,
        cells={"quad": model.mesh.t.T.copy()},
        point_data={"p_Pa": pressure, "uz_m": uz},
        cell_data={"mises_Pa": mises(s.elements), "stress_Pa": np.stack([rr, tt, zz, zero, rz, zero], axis=1)},
    )
