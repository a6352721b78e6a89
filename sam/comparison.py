# SPDX-License-Identifier: MIT
"""The bare body in place of a coated one: the same load, grid and depths, so that the film alone makes the difference."""

from __future__ import annotations

from sam.advice import advice
from sam.coating import Comparison, bare
from sam.contact.convolution import Counters
from sam.contact.fit import fit_of
from sam.contact.normal import Contact
from sam.elastic import load_step, stress_and_mises
from sam.grid.cells import CellGrid
from sam.loading import Load
from sam.record import largest_pressure
from sam.scene import Scene, Status

UNFIT = "bare body, for comparison: {}: its largest pressure and stress and their changes are not given"


def bare_body(scene: Scene, grid: CellGrid, load: Load, coated: Contact, counters: Counters) -> Comparison:
    """Contact of the bare body, from the coated one's pressure on, and its stress; a warning where the grid does not suit it."""
    without = bare(scene)
    contact = load_step(without, grid, load, coated.pressure, counters)
    status = fit_of(contact, rough=scene.surface is not None)
    if status is not Status.CONVERGED:
        return Comparison(warning=UNFIT.format(advice(without, status)))
    mises = stress_and_mises(without, grid, load, contact, counters)[1]
    return Comparison(largest_pressure(contact, grid), mises)
