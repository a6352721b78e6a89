# SPDX-License-Identifier: MIT
"""A grid that turns out too small: a side that the program chose is enlarged, one that the user gave is
named.
"""

from __future__ import annotations

from dataclasses import dataclass

from sam.grid.cells import CellGrid, Room

RATIO = 1.5  # by which a side grows that was reached
MOST_TIMES = 2  # how often a side grows at most: twice is 2.25 times the side, and five times the cells


@dataclass(frozen=True)
class Sides:
    """Sides of a grid, beside the contact and below it: those that were reached, or that a user gave."""

    beside: bool = False
    below: bool = False


def enlarged(given: Sides, room: Room, reached: Sides) -> Room | None:
    """More room where the grid was too small; None if it was not, or where the user gave what would have to
    grow.
    """
    if (
        not (reached.beside or reached.below)
        or (reached.beside and given.beside)
        or (reached.below and given.below)
    ):
        return None
    larger = Room(room.beside * RATIO**reached.beside, room.below * RATIO**reached.below)
    return larger if max(larger.beside, larger.below) <= RATIO**MOST_TIMES else None


def how_to_enlarge(grid: CellGrid, reached: Sides) -> str:
    """The sides of a grid that were reached, and what to give in place of them; empty if none was."""
    sides = []
    if reached.beside:
        lx, ly = (RATIO * n * h * 1e6 for n, h in ((grid.nx, grid.hx), (grid.ny, grid.hy)))
        larger = f'["{lx:.3g} um", "{ly:.3g} um"]'
        sides.append(f"beside the contact, raise grid.extent to {larger} and grid.cells in proportion")
    if reached.below and grid.faces is not None:
        deepest = RATIO * float(grid.faces[-1]) * 1e6
        sides.append(f'below the contact, let grid.depths (or grid.depth) go down to "{deepest:.3g} um"')
    return ", and ".join(sides)


def enlargement(first: CellGrid, grid: CellGrid) -> tuple[dict[str, object], str]:
    """(entry of the discretisation, warning) for a grid that was enlarged during the solve."""
    extra: dict[str, object] = {"grid_enlarged": {"beside": grid.room.beside, "below": grid.room.below}}
    before, after = (
        f"{one.nx} x {one.ny} cells and {one.depths[-1] * 1e6:.3g} um of depth" for one in (first, grid)
    )
    return (
        extra,
        f"the chosen grid was too small and was enlarged, from {before} to {after}; its cost is included",
    )
