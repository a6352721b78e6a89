# SPDX-License-Identifier: MIT
"""What to change when the semi-analytical model ends badly: nothing that is set already, nothing that the scene has not."""

from __future__ import annotations

from sam.scene import Scene, Status
from sam.scene.remedies import (
    either,
    finer_cells,
    larger_patch,
    less_friction,
    less_load,
    looser,
    more_steps,
    smaller_patch,
)

STRONG = 3.0  # coefficient of friction, beyond that of surfaces in air, that may keep a contact from settling


def advice(scene: Scene, status: Status, larger: str = "") -> str:
    """In words; empty for a converged solve. With much friction the traction moves the surface further than the pressure does.

    larger: how to enlarge the sides of the grid that were reached, see `sam.grid.enlargement`.
    """
    match status:
        case Status.NOT_CONVERGED:
            slower = less_friction(scene) if scene.coefficient > STRONG else ""
            what = either(finer_cells(scene), looser(scene), slower)
            return f"the contact iteration stopped above its tolerance: {what}"
        case Status.CONTACT_AT_GRID_EDGE:
            what = either(larger or larger_patch(scene), less_load(scene))
            return f"the contact touches the edge of the grid: {what}"
        case Status.UNDER_RESOLVED:
            return f"too few cells in the contact: {either(finer_cells(scene), smaller_patch(scene))}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            return f"the plastic zone touches the edge of the grid: {either(larger, less_load(scene))}"
        case Status.STEP_CUT_LIMIT:
            what = either(more_steps(scene), looser(scene), less_load(scene))
            return f"a load step did not converge however often it was halved: {what}"
    return status.advice
