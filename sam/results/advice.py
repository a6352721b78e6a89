# SPDX-License-Identifier: MIT
"""What to change when a solve ends badly: nothing that is set already, nothing that the scene has not."""

from __future__ import annotations

from dataclasses import dataclass

from sam.scene import Status
from sam.scene.remedies import either


@dataclass(frozen=True)
class Remedies:
    """What may be changed of a scene, in words; empty what may not. See `sam.scene.remedies`.

    slower: less friction, where there is so much that a contact may not be found for it.
    """

    finer_cells: str
    smaller_patch: str
    larger_patch: str
    less_load: str
    slower: str
    more_steps: str
    looser: str


def advice(remedies: Remedies, status: Status, larger: str = "") -> str:
    """What to change, in words; empty for a converged solve.

    larger: how to enlarge the sides of the grid that were reached, see `sam.grid.enlargement`.
    """
    can = remedies
    match status:
        case Status.NOT_CONVERGED:
            what = either(can.finer_cells, can.looser, can.slower)
            return f"the contact iteration stopped above its tolerance: {what}"
        case Status.CONTACT_AT_GRID_EDGE:
            what = either(larger or can.larger_patch, can.less_load)
            return f"the contact touches the edge of the grid: {what}"
        case Status.UNDER_RESOLVED:
            return f"too few cells in the contact: {either(can.finer_cells, can.smaller_patch)}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            return f"the plastic zone touches the edge of the grid: {either(larger, can.less_load)}"
        case Status.STEP_CUT_LIMIT:
            what = either(can.more_steps, can.looser, can.less_load)
            return f"a load step did not converge however often it was halved: {what}"
    return status.advice
