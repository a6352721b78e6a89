# SPDX-License-Identifier: MIT
"""Tables that the models of both geometries share, in SI units, with the columns of sam.scene.result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fem_reference.common.loading import Step, Strained
from fem_reference.common.model import ContactModel
from fem_reference.common.periods import loops_of, verdict_columns_of
from sam.scene.result import CYCLES, DISSIPATED, FRICTION_SIGN, HISTORY, Table, residual_table


def columns(names: Sequence[str], values: Sequence[Any]) -> dict[str, Any]:
    """Table from its columns in file order; a single number or text is repeated in every row."""
    rows = max(np.size(value) for value in values)
    return {name: np.broadcast_to(value, rows).copy() for name, value in zip(names, values, strict=True)}


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
        found = cycles_table(model, peaks, peeq_max)
        cycles = [step.cycle for step in peaks]
        if any(target.load.ratio < 0 for target in model.plan.schedule.targets):
            signs = [int(np.sign(step.state.load.ratio)) for step in peaks]
            found = {**found, FRICTION_SIGN: signs}
        if model.plan.dissipates:
            found = {**found, DISSIPATED: dissipated_in(cycles, steps)}
        out["cycles"] = {**found, **verdict_columns_of(model, steps, cycles)}
    return out


def history_table(model: ContactModel, steps: Sequence[Step], peeq_max: Strained) -> Table:
    """One row per load step of every cycle; none for a step that did not converge, whose attempts the
    residuals have.
    """
    unit, rows = model.scales, []
    for step in steps:
        state = step.state
        if not state.converged:
            continue
        row = {
            "cycle": step.cycle,
            "step": step.number,
            "force_N": model.plan.force * model.share(state),
            "approach_m": None if model.prescribed else state.approach * unit.displacement,
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


def cycles_table(model: ContactModel, peaks: Sequence[Step], peeq_max: Strained) -> Table:
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


def dissipated_in(cycles: Sequence[int], steps: Sequence[Step]) -> list[float]:
    """The energy in J that each cycle dissipated."""
    return [sum(step.dissipated for step in steps if step.cycle == cycle) for cycle in cycles]


def peak_steps(steps: Sequence[Step]) -> list[Step]:
    """The last step towards the peak of each cycle that came to it."""
    peaks = {step.cycle: step for step in steps if not step.unloads}
    return [step for step in peaks.values() if step.state.converged]
