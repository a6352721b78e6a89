# SPDX-License-Identifier: MIT
"""What a coating changes: a coated state, and the bare body under the same force, on the same grid."""

from __future__ import annotations

from sam.contact.normal import fit_of
from sam.elastic.problem import CoatedSurfaces, Loaded
from sam.elastic.stress import stresses_of
from sam.results.history import largest_pressure
from sam.results.snapshots import Coated, Comparison
from sam.results.tables import Remedies, advice
from sam.scene import Status

UNFIT = "bare body, for comparison: {}: its largest pressure and stress and their changes are not given"


def coated_state(coated: CoatedSurfaces, state: Loaded, remedies: Remedies) -> Coated:
    """What the coating adds to a state; under force with the bare body to compare with."""
    problem = state.problem
    comparison = bare_body(state, remedies) if state.load.force else None
    traction = state.traction if problem.slip.coupled else None
    moved = coated.counter_uz(problem.grid, state.contact.pressure, traction, problem.counters)
    return Coated(coated.thickness, moved, comparison)


def bare_body(state: Loaded, remedies: Remedies) -> Comparison:
    """Contact of the bare body, from the coated one's pressure on, and its stress; a warning where the grid
    does not suit it.
    """
    bare, load = state.problem.bare(), state.load.by_force()
    contact = bare.contact(load, start=state.contact.pressure)
    status = fit_of(contact, rough=bare.looked.anywhere)
    if status is not Status.CONVERGED:
        return Comparison(warning=UNFIT.format(advice(remedies, status)))
    mises = stresses_of(bare.state(load, contact)).mises
    return Comparison(largest_pressure(contact, bare.grid), mises)
