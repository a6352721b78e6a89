# SPDX-License-Identifier: MIT
"""The plane y = const through the largest pressure at the peak, where the contact need not be in the plane y = 0.

So it is below a rough body, and under a load that travels. The stresses are at hand there, and are kept for the table cut.
"""

from __future__ import annotations

import numpy as np

from sam.cell_row import Cut
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid, Window
from sam.scene.result import CUT, STRESSES


def row_of_largest(contact: Contact, counts: Window) -> int | None:
    """The row of cells j with the largest pressure among the cells that count; None without contact."""
    inner = contact.pressure[counts.slices]
    return int(np.unravel_index(inner.argmax(), inner.shape)[1]) + counts.j0 if inner.any() else None


def elastic_cut(grid: CellGrid, row: int, stress: np.ndarray) -> Cut:
    """Of a body without plastic strain; stress: (6, nz, nx) in Pa."""
    return Cut(float(grid.y[row]), grid.x, grid.depths, stress, np.zeros(stress.shape[1:]))


def cut_table(state: str, cut: Cut) -> dict:
    """The table cut: a row a point, z running first."""
    x, z = np.meshgrid(cut.x, cut.z, indexing="ij")
    columns = {
        "state": [state] * x.size,
        "x_m": x.ravel(),
        "y_m": np.full(x.size, cut.y),
        "z_m": z.ravel(),
        "peeq": cut.peeq.T.ravel(),
        "mises_Pa": von_mises(cut.stress).T.ravel(),
        **{name: component.T.ravel() for name, component in zip(STRESSES, cut.stress, strict=True)},
    }
    return {name: columns[name] for name in CUT}
