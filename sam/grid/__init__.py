# SPDX-License-Identifier: MIT
"""The cells and output depths of the semi-analytical model, how they are chosen, and the gap and heights on
them.
"""

from sam.grid.cells import CellGrid, Room, Window

__all__ = [
    "CellGrid",
    "Room",
    "Window",
]
