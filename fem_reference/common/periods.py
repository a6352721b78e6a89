# SPDX-License-Identifier: MIT
"""The verdict on repeated loading, from the plastic histories of the unloaded states that end the periods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.loading import Step
from fem_reference.common.model import ContactModel
from fem_reference.common.plasticity import History
from sam.scene.verdict import KEPT, Judging, Period, Verdict, summary, verdict_columns, verdict_on


def floor(model: ContactModel) -> Array:
    """The strain at each Gauss point below which a period counts as without plastic strain, (n,)."""
    material, judging = model.problem.material, model.plan.judging
    if material is None or judging is None:
        raise ValueError("the contact is not judged")
    found: Array = judging.floor * model.scales.strain * material.yield_strain.ravel()
    return found


def verdicts_of(model: ContactModel, steps: Sequence[Step], judging: Judging) -> list[Verdict]:
    """After each period that was finished: of the steps of a contact whose body yields."""
    ends = {step.cycle: step.state.history for step in steps if step.unloads and step.state.converged}
    found = [ends[cycle] for cycle in sorted(ends) if cycle % judging.period == 0]
    histories = [each for each in found if each is not None]
    if not histories:
        return []
    unit = model.scales.strain
    states = [History.virgin(histories[0].peeq.shape, len(histories[0].plastic_strain)), *histories]
    periods = [_added(before, after, unit) for before, after in zip(states, histories, strict=False)]
    limit, volume = floor(model), model.body.weights.ravel() * model.scales.length**3 / model.part
    return [
        verdict_on(last, after.peeq.ravel(), limit, volume, worst=judging.worst)
        for last, after in zip(_last_of(periods), histories, strict=True)
    ]


def _last_of(periods: Sequence[Period]) -> list[Sequence[Period]]:
    """After each period those that are compared."""
    return [periods[max(0, k - KEPT) : k] for k in range(1, len(periods) + 1)]


def _added(before: History, after: History, unit: float) -> Period:
    """What a period added; the shears of a strain stand for twice the tensor."""
    strain = unit * (after.plastic_strain - before.plastic_strain).reshape(len(after.plastic_strain), -1)
    tensor = np.zeros((6, strain.shape[1]))
    tensor[:3], tensor[3 : len(strain)] = strain[:3], strain[3:] / 2.0
    return Period(unit * (after.peeq - before.peeq).ravel(), tensor)


def verdict_columns_of(
    model: ContactModel, steps: Sequence[Step], cycles: Sequence[int]
) -> dict[str, list[Any]]:
    """The last columns of the table cycles, of a scene that is judged; nothing of others."""
    judging = model.plan.judging
    if judging is None:
        return {}
    return verdict_columns(cycles, verdicts_of(model, steps, judging), judging.period)


def verdict_summary(model: ContactModel, steps: Sequence[Step]) -> Mapping[str, Any] | None:
    """What a result says of repeated loading; None where nothing is judged, or no period was finished."""
    judging = model.plan.judging
    if judging is None:
        return None
    found = verdicts_of(model, steps, judging)
    return summary(found, judging.period, float(floor(model).min())) if found else None
