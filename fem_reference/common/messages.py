# SPDX-License-Identifier: MIT
"""What to change when a finite-element solve ends badly: nothing that is set already, nothing that the scene has not."""

from __future__ import annotations

from fem_reference.common.loading import MOST_CUTS
from sam.scene.remedies import either, finer_cells, finer_mesh, larger_box, less_load, more_steps
from sam.scene.result import Status
from sam.scene.schema import Scene

FEWEST_ELEMENTS = 4
"""Elements in the contact radius below which a result is called under-resolved (pressure in the centre off by 1 %)."""
FEWEST_NODES = 28
"""In contact, all spots of a rough patch together: as many as a spot of three elements in the radius has."""


def message_of(scene: Scene, status: Status) -> str:
    """In words; empty for a converged solve."""
    rough = scene.surface is not None
    match status:
        case Status.CONVERGED:
            return ""
        case Status.NOT_CONVERGED if rough:
            full = f"{less_load(scene)} if all of it touches"
            return f"the contact iteration did not settle: {either(finer_cells(scene), full)}"
        case Status.NOT_CONVERGED:
            return "the contact iteration did not settle: change fem.cells_per_radius"
        case Status.CONTACT_AT_GRID_EDGE:
            return f"the contact reaches the edge of the fine mesh: {less_load(scene)}"
        case Status.UNDER_RESOLVED if rough:
            return f"fewer than {FEWEST_NODES} surface nodes in contact: {finer_cells(scene)}"
        case Status.UNDER_RESOLVED:
            return f"fewer than {FEWEST_ELEMENTS} elements in the contact radius: {finer_mesh(scene)}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            return (
                f"the plastic zone reaches the outer boundary: {either(larger_box(scene), less_load(scene))}"
            )
        case Status.STEP_CUT_LIMIT:
            what = either(more_steps(scene), less_load(scene))
            return f"a load step did not converge, halved {MOST_CUTS} times: {what}"
    raise ValueError(f"no message for {status}")
