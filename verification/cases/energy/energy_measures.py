# SPDX-License-Identifier: MIT
"""The values that are gated of balances of energy, by the name of the gate without that of the contact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from verification.energy.balance import Balance
from verification.judging import Measured
from verification.reference.convergence import fit_order

Ladder = dict[int, Balance]
"""Balances by cells in the contact radius, or by steps."""


def order(ladder: Ladder, error: Callable[[Balance], float]) -> float:
    """Observed order of an error in 1/n, n the keys of the ladder."""
    return fit_order(1 / np.array(list(ladder)), [error(one) for one in ladder.values()]).order


def of_cells(one: Balance) -> float:
    """The largest error of the cells over the states."""
    return float(np.abs(one.error_of_cells).max())


def of_steps(one: Balance) -> float:
    """The largest error of the steps over the states."""
    return float(np.abs(one.error_of_steps).max())


def of_stress_within(one: Balance) -> float:
    """The largest plastic work of stresses that vary within the cells over the largest work; 0 in FEM."""
    return float(np.abs(one.within).max() / np.abs(one.work).max())


def of_pressing(one: Balance) -> float:
    """What the work F delta of the counter-body differs by from that of the pressure, up to the peak; without
    friction.
    """
    return abs(one.pressing[one.peak] / one.work[one.peak] - 1)


def of_last_cycle(one: Balance) -> float:
    """The work of the tractions over a last cycle less what is dissipated, over that; elastic energy and the
    energy of the back-stresses are to come back.
    """
    return abs(_added(one, one.work - one.beyond) / _added(one, one.dissipated) - 1)


def of_flow_in_last_cycle(one: Balance) -> float:
    """The plastic work over a last cycle less what is dissipated and stored by back-stresses, over the former
    of the two.
    """
    return abs(_added(one, one.flowed - one.back) / _added(one, one.dissipated) - 1)


def _added(one: Balance, energy: np.ndarray) -> float:
    """What the last cycle, between two states without force, adds to an energy."""
    before, end = np.flatnonzero(one.force == 0)[-2:]
    return float(energy[end] - energy[before])


def cycle_gates(by_steps: Ladder) -> dict[str, Measured]:
    """Of a body that alternates, both models."""
    most = by_steps[max(by_steps)]
    return {
        "cycle": Measured(of_last_cycle(most)),
        "cycle-order": Measured(order(by_steps, of_flow_in_last_cycle)),
    }


def sam_gates(by_cells: Ladder, by_steps: Ladder, friction: float) -> dict[str, Measured]:
    """What SAM's own balances must reach."""
    finest, most = by_cells[max(by_cells)], by_steps[max(by_steps)]
    out = {
        "sam-cells": Measured(of_cells(finest)),
        "sam-cells-order": Measured(order(by_cells, of_cells)),
        "sam-within": Measured(of_stress_within(finest)),
        "sam-within-order": Measured(order(by_cells, of_stress_within)),
        "sam-steps": Measured(of_steps(most)),
        "sam-steps-order": Measured(order(by_steps, of_steps)),
    }
    if not friction:
        out["sam-pressing"] = Measured(of_pressing(most))
        out["sam-pressing-order"] = Measured(order(by_steps, of_pressing))
    return out


def fem_gates(by_steps: Ladder) -> dict[str, Measured]:
    """What those of FEM must reach."""
    most = by_steps[max(by_steps)]
    return {
        "fem-steps": Measured(of_steps(most)),
        "fem-steps-order": Measured(order(by_steps, of_steps)),
        "fem-pressing": Measured(of_pressing(most)),
        "fem-pressing-order": Measured(order(by_steps, of_pressing)),
    }


def compared_gates(sam: Balance, fem: Balance) -> dict[str, Measured]:
    """Both models after the same steps."""
    return {
        "fem-cells": Measured(of_cells(fem)),
        "work": Measured(sam.work[sam.peak], fem.work[fem.peak], unit="J"),
        "dissipated": Measured(sam.dissipated[-1], fem.dissipated[-1], unit="J"),
        "locked": Measured(sam.elastic[-1], fem.elastic[-1], unit="J"),
    }
