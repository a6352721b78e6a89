# SPDX-License-Identifier: MIT
"""Tables that the models of both geometries share, in SI units, with the columns of sam.scene.result, and the
verdict on repeated loading, from the plastic histories of the unloaded states that end the periods.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.loading import Step, Strained
from fem_reference.common.model import ContactModel
from fem_reference.common.plasticity import History
from fem_reference.common.recovery import plastic_fields
from sam.scene import verdict
from sam.scene.result import (
    BACK_STRESS,
    CYCLES,
    DISSIPATED,
    FRICTION_SIGN,
    HISTORY,
    LINE,
    LOOPS,
    FieldMesh,
    GridFields,
    Table,
    residual_table,
)


def columns(names: Sequence[str], values: Sequence[Any]) -> dict[str, Any]:
    """Table from its columns in file order; a single number or text is repeated in every row."""
    rows = max(np.size(value) for value in values)
    return {name: np.broadcast_to(value, rows).copy() for name, value in zip(names, values, strict=True)}


@dataclass(frozen=True)
class Surface:
    """The surface nodes (nx, ny) of a state, ny = 1 of a section.

    x, y: their lines in m; pressure: in Pa; ratio: tangential over normal traction, None without friction;
    gap: in m, not finite where there is none; u: displacements (3, nx, ny) in m.
    """

    x: Array
    y: Array
    pressure: Array
    ratio: Array | float | None
    gap: Array
    u: Array

    @classmethod
    def of_section(cls, model: Any, state: Equilibrium) -> Surface:
        """That of the model of a section; the gap is not finite where the pressure is given."""
        unit, u, x = model.scales, model.displacements(state), model.surface
        along, normal = (model.body.boundary_dofs("surface", component) for component in (0, 1))
        ux, uz, none = u[along], u[normal], np.zeros(x.size)
        bodies = range(len(model.problem.solids))
        opened = np.sum([model.problem.body(state.u, i)[normal] for i in bodies], axis=0)
        gap = model.at(state.load).initial_gap + opened - state.approach
        gap = np.where(model.plan.prescribed, np.nan, gap)
        ratio = state.load.ratio if model.plan.sliding.coefficient else None
        pressure = (model.nodal_pressure(state) * unit.pressure)[:, None]
        moved = np.stack([ux, none, uz])[..., None] * unit.displacement
        return cls(x * unit.length, np.zeros(1), pressure, ratio, gap[:, None] * unit.displacement, moved)

    def on_plane(self, values: Array) -> Array:
        """(nx,) at y = 0 of values (nx, ny)."""
        return at_zero_line(values, self.y)

    def centre(self, values: Array) -> float:
        """Value in the origin of those (nx, ny)."""
        return float(at_zero_line(self.on_plane(values), self.x))

    def table(self, state: str, plastic_shear: Array | float) -> Table:
        """The nodes at y = 0; NaN without a gap, and without friction of what belongs to that."""
        gap = self.on_plane(self.gap)
        pressure, slides = self.on_plane(self.pressure), self.ratio is not None
        traction = self.on_plane(self.ratio * self.pressure) if self.ratio is not None else 0.0
        values = [state, self.x, pressure, traction, np.where(np.isfinite(gap), gap, np.nan)]
        ux, uz = (self.on_plane(self.u[component]) for component in (0, 2))
        return columns(LINE, [*values, uz, *((ux, plastic_shear) if slides else (np.nan, np.nan))])

    def grid(self) -> GridFields:
        """Pressure, displacement, friction, and the gap where all of it is finite."""
        points = {"p_Pa": self.pressure, "displacement_m": self.u}
        if self.ratio is not None:
            touching = self.pressure > 0.0
            points |= {"qx_Pa": self.ratio * self.pressure, "friction": np.abs(self.ratio) * touching}
        if np.isfinite(self.gap).all():
            points["gap_m"] = self.gap
        flat = {name: values[..., None] for name, values in points.items()}
        return GridFields(self.x, self.y, np.zeros(1), flat)


def at_zero_line(values: Array, line: Array) -> Array:
    """Values at zero of those (..., n) on the lines of `line` (n,), or the mean of both sides."""
    zero = int(np.searchsorted(line, 0.0))
    return values[..., zero] if line[zero] == 0.0 else 0.5 * (values[..., zero - 1] + values[..., zero])


def plane_mesh(model: Any, state: Equilibrium, weights: Array) -> FieldMesh:
    """The half-space of a section in the plane y = 0: pressure and displacement at the corner nodes, stress
    and plastic strain in the elements. weights: (n_elements, n_points) of the points in the means of
    elements.
    """
    unit, mesh = model.scales, model.body.basis.mesh
    x, z = mesh.p
    pressure = np.interp(x, model.surface, model.nodal_pressure(state)) * (z == 0.0) * unit.pressure
    u = model.displacements(state) * unit.displacement
    ux, uz = (u[dofs] for dofs in model.body.basis.nodal_dofs)

    def mean(field: Array) -> Array:
        return (field * weights).sum(axis=-1) / weights.sum(axis=-1)

    points = model.stress(state) * unit.pressure
    peeq, strain = plastic_fields(state.history, points, unit.strain, lambda field: field)
    stress = mean(points)
    data = {"mises_Pa": mises(stress), "stress_Pa": six(stress).T}
    if strain is not None:
        data |= {"peeq": mean(peeq), "plastic_strain": six(mean(strain)).T}
    return FieldMesh(
        points=np.stack([x, np.zeros(x.size), z], axis=1) * unit.length,
        cells={"quad": mesh.t.T.copy()},
        point_data={"p_Pa": pressure, "uz_m": uz, "displacement_m": np.stack([ux, 0 * ux, uz], axis=1)},
        cell_data=data,
    )


def stacked(tables: Sequence[Table]) -> dict[str, Any]:
    """Tables of equal columns, one below the other."""
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


def step_tables(model: ContactModel, steps: Sequence[Step], peeq_max: Strained) -> dict[str, Table]:
    """History and residuals of all steps, and with more cycles than one their peaks."""
    out: dict[str, Table] = {"history": history_table(model, steps, peeq_max)}
    out["residuals"] = residual_table((step.cycle, step.number, step.attempts) for step in steps)
    if loops := loops_of(model, steps):
        out["loops"] = loops
    if model.plan.schedule.cycles > 1:
        peaks = peak_steps(steps)
        table = cycles_table(model, peaks, peeq_max)
        cycles = [step.cycle for step in peaks]
        if any(target.load.ratio < 0 for target in model.plan.schedule.targets):
            signs = [int(np.sign(step.state.load.ratio)) for step in peaks]
            table |= {FRICTION_SIGN: signs}
        if model.plan.dissipates:
            spent = [sum(step.dissipated for step in steps if step.cycle == cycle) for cycle in cycles]
            table |= {DISSIPATED: spent}  # J
        if (judging := model.plan.judging) is not None:
            table |= verdict.verdict_columns(cycles, verdicts_of(model, steps, judging), judging.period)
        out["cycles"] = table
    return out


def history_table(model: ContactModel, steps: Sequence[Step], peeq_max: Strained) -> Table:
    """One row per load step of every cycle that converged."""
    unit, rows = model.scales, []
    for step in steps:
        state = step.state
        if not state.converged:
            continue
        row = {
            "cycle": step.cycle,
            "step": step.number,
            "force_N": model.plan.force * model.share(state),
            "approach_m": None if model.plan.prescribed else state.approach * unit.displacement,
            "contact_area_m2": model.contact_area(state),
            "p_max_Pa": model.largest_pressure(state),
            "peeq_max": peeq_max(state) if step.peeq_max is None else step.peeq_max,
            "friction_coefficient": model.friction(state),
            "iterations": step.iterations,
            "residual": state.residual,
            "note": step.note,
        }
        rows.append(row)
    return {name: [row[name] for row in rows] for name in HISTORY}


def cycles_table(model: ContactModel, peaks: Sequence[Step], peeq_max: Strained) -> dict[str, list[Any]]:
    """Cycles at their peaks, without wear. What does not exist (skewness of a plane, tribofilm) is None."""
    states = [step.state for step in peaks]
    values: Mapping[str, list[float]] = {
        "cycle": [step.cycle for step in peaks],
        "friction_coefficient": [model.friction(state) for state in states],
        "p_max_Pa": [model.largest_pressure(state) for state in states],
        "peeq_max": [peeq_max(state) for state in states],
        **{name: [0.0] * len(peaks) for name in ("wear_volume_m3", "sa_m", "sq_m")},
    }
    return {name: values.get(name, [None] * len(peaks)) for name in CYCLES}


def peak_steps(steps: Sequence[Step]) -> list[Step]:
    """The last step towards the peak of each cycle that came to it."""
    peaks = {step.cycle: step for step in steps if not step.unloads}
    return [step for step in peaks.values() if step.state.converged]


def six(field: Array) -> Array:
    """(6, ...) components of a tensor (4 or 6, ...): rr, tt, zz, rz in the plane y = 0 of six."""
    out = np.zeros((6, *field.shape[1:]))
    out[[0, 1, 2, 4] if len(field) == 4 else slice(None)] = field
    return out


def _yield_strain(model: ContactModel) -> Array:
    """Initial yield stress over Young's modulus at each Gauss point, (n,)."""
    if model.problem.material is None:
        raise ValueError("the body does not yield")
    return model.scales.strain * model.problem.material.yield_strain.ravel()


def verdicts_of(
    model: ContactModel, steps: Sequence[Step], judging: verdict.Judging
) -> list[verdict.Verdict]:
    """After each period that was finished: of the steps of a contact whose body yields."""
    histories, periods = _periods_of(model, steps)
    strain, volume = _yield_strain(model), model.body.weights.ravel() * model.scales.length**3 / model.part
    return [
        verdict.verdict_on(periods[:number], after.peeq.ravel(), strain, judging, volume=volume)
        for number, after in enumerate(histories, start=1)
    ]


def _periods_of(model: ContactModel, steps: Sequence[Step]) -> tuple[list[History], list[verdict.Period]]:
    """The histories at the ends of finished periods, and what each period added; none without a verdict."""
    if (judging := model.plan.judging) is None:
        return [], []
    last = {
        target.cycle: target.number
        for target in model.plan.schedule.targets
        if not target.unloads or not judging.loaded
    }
    ends = {
        step.cycle: step.state.history
        for step in steps
        if step.state.converged and step.number >= last[step.cycle] and step.unloads is not judging.loaded
    }
    ended = [ends[cycle] for cycle in sorted(ends) if cycle % judging.period == 0]
    histories = [history for history in ended if history is not None]
    if not histories:
        return [], []
    unit = model.scales.strain
    states = [History.virgin(histories[0].peeq.shape, len(histories[0].plastic_strain)), *histories]
    return histories, [_added(before, after, unit) for before, after in zip(states, histories, strict=False)]


def loops_of(model: ContactModel, steps: Sequence[Step]) -> dict[str, list[Any]]:
    """Stress and plastic strain of three Gauss points over the last period, if judged."""
    judging, (histories, periods) = model.plan.judging, _periods_of(model, steps)
    if judging is None or len(periods) < 2 or len(periods) < model.plan.schedule.cycles // judging.period:
        return {}
    cycles, unit = verdict.last_period(judging, model.plan.schedule.cycles), model.scales
    end = max(step.number for step in steps if step.cycle == cycles.start - 1)
    wanted = [
        step for step in steps if step.cycle in cycles or (step.cycle, step.number) == (cycles.start - 1, end)
    ]
    coordinates = model.body.points.reshape(len(model.body.points), -1) * unit.length
    x, *across, z = coordinates
    y = across[0] if across else 0 * x
    rows, points = [], model.body.weights.shape[1]
    places = verdict.loop_places(periods[-2].accumulated, histories[-2].peeq.ravel())
    for number, at in enumerate(places, start=1):
        point = np.s_[:, *divmod(int(at), points)]
        for step in wanted:
            stress = six(model.stress(step.state)[point] * unit.pressure)
            if (history := step.state.history) is None:
                continue
            strain = six(history.plastic_strain[point] * unit.strain) / np.repeat([1, 2], 3)
            peeq = unit.strain * float(history.peeq.ravel()[at])
            values = (number, x[at], y[at], z[at], step.cycle, step.number, peeq)
            rows.append((*values, *stress.tolist(), *strain.tolist()))
    return {name: [row[k] for row in rows] for k, name in enumerate(LOOPS)}


def element_fields(model: ContactModel, state: Equilibrium, steps: Sequence[Step]) -> dict[str, Array]:
    """Means in the elements of back-stresses, and of the strains and classes of the last period."""
    material, judging, weights = model.problem.material, model.plan.judging, model.body.weights
    out: dict[str, Array] = {}
    if material is None or state.history is None:
        return out
    if material.back_stresses:
        back = material.back_stress(state.history) * model.scales.pressure
        out[BACK_STRESS] = six((back * weights).sum(axis=-1) / weights.sum(axis=-1)).T
    histories, periods = _periods_of(model, steps)
    if judging is None or not periods:
        return out
    for name, values in verdict.cell_fields(
        periods, histories[-1].peeq.ravel(), _yield_strain(model), judging
    ).items():
        points = values.reshape(weights.shape)
        mean = (points * weights).sum(axis=-1) / weights.sum(axis=-1)
        out[name] = points.max(axis=-1) if name == "class" else mean
    return out


def _added(before: History, after: History, unit: float) -> verdict.Period:
    """What a period added; the shears of a strain stand for twice the tensor."""
    strain = unit * (after.plastic_strain - before.plastic_strain).reshape(len(after.plastic_strain), -1)
    tensor = np.zeros((6, strain.shape[1]))
    tensor[:3], tensor[3 : len(strain)] = strain[:3], strain[3:] / 2.0
    return verdict.Period(unit * (after.peeq - before.peeq).ravel(), verdict.norm_of(tensor), tensor)


def verdict_summary(model: ContactModel, steps: Sequence[Step]) -> Mapping[str, Any] | None:
    """What a result says of repeated loading; None where nothing is judged, or no period was finished."""
    judging = model.plan.judging
    verdicts = [] if judging is None else verdicts_of(model, steps, judging)
    if judging is None or not verdicts:
        return None
    return verdict.summary(verdicts, judging.period, judging.floor * float(_yield_strain(model).min()))
