# SPDX-License-Identifier: MIT
"""A grid that turns out too small: a side that the program chose is enlarged, one that the user gave is named."""

from __future__ import annotations

from dataclasses import dataclass

from sam.grid import CellGrid, Room
from sam.scene import Scene

RATIO, MOST_TIMES = 1.5, 2  # by which a side grows that was reached, and how often at most


@dataclass(frozen=True)
class Reached:
    """Where a plastic zone or a contact came to the edge of the grid."""

    beside: bool = False
    below: bool = False


def enlarged(scene: Scene, room: Room, reached: Reached) -> Room | None:
    """More room where the grid was too small; None if it was not, or where `[grid]` gives what would have to grow."""
    given = scene.grid
    fixed_beside = scene.surface is not None or (given is not None and bool(given.cells or given.extent))
    fixed_below = scene.surface is not None or (given is not None and bool(given.depths or given.layers))
    if (
        not (reached.beside or reached.below)
        or (reached.beside and fixed_beside)
        or (reached.below and fixed_below)
    ):
        return None
    larger = Room(
        room.beside * RATIO**reached.beside, room.below * RATIO**reached.below
    )  # fmt: skip
    return larger if max(larger.beside, larger.below) <= RATIO**MOST_TIMES else None


def how_to_enlarge(grid: CellGrid, reached: Reached) -> str:
    """The sides of a grid that were reached, and what to give in place of them; empty if none was."""
    sides = []
    if reached.beside:
        lx, ly = (RATIO * n * h * 1e6 for n, h in ((grid.nx, grid.hx), (grid.ny, grid.hy)))
        larger = f'["{lx:.3g} um", "{ly:.3g} um"]'
        sides.append(f"beside the contact, raise grid.extent to {larger} and grid.cells in proportion")
    if reached.below:
        deepest = RATIO * float(grid.faces[-1]) * 1e6
        sides.append(f'below the contact, let grid.depths (or grid.depth) go down to "{deepest:.3g} um"')
    return ", and ".join(sides)


def enlargement(first: CellGrid, grid: CellGrid) -> tuple[dict[str, object], str]:
    """(entry of the discretisation, warning) for a grid that was enlarged during the solve."""
    extra = {"grid_enlarged": {"beside": grid.room.beside, "below": grid.room.below}}
    before, after = (
        f"{one.nx} x {one.ny} cells and {one.depths[-1] * 1e6:.3g} um of depth" for one in (first, grid)
    )
    return (
        extra,
        f"the chosen grid was too small and was enlarged, from {before} to {after}; its cost is included",
    )
