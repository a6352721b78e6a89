# SPDX-License-Identifier: MIT
"""The record of a row of cells in which a state is kept beside the plane y = 0."""

from __future__ import annotations

from dataclasses import dataclass

from sam.arrays import Array


@dataclass(frozen=True)
class Cut:
    """A row of cells. y: of their centres in m; x: (nx,), z: (nz,) in m; stress: (6, nz, nx) in Pa; peeq:
    (nz, nx).
    """

    y: float
    x: Array
    z: Array
    stress: Array
    peeq: Array
