# SPDX-License-Identifier: MIT
"""Stress and plastic strain of some cells over the last period of a repeated load, and their table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sam.grid.cells import CellGrid
from sam.scene.result import LOOPS


@dataclass(frozen=True)
class LoopRow:
    """A cell at the end of a load step. place: its layer, and its cell of the grid; stress in Pa and plastic
    strain, six components each.
    """

    place: tuple[int, int, int]
    cycle: int
    step: int
    peeq: float
    stress: tuple[float, ...]
    strain: tuple[float, ...]


def loops_table(grid: CellGrid, rows: Sequence[LoopRow]) -> dict[str, list[Any]]:
    """The table loops; points are numbered from 1, the one that strains most first."""
    places = list(dict.fromkeys(row.place for row in rows))
    values = []
    for row in sorted(rows, key=lambda row: places.index(row.place)):
        layer, i, j = row.place
        where = float(grid.x[i]), float(grid.y[j]), float(grid.depths[layer])
        number = places.index(row.place) + 1
        values.append((number, *where, row.cycle, row.step, row.peeq, *row.stress, *row.strain))
    return {name: [value[k] for value in values] for k, name in enumerate(LOOPS)}
