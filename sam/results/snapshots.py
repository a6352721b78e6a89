# SPDX-License-Identifier: MIT
"""States that go into the tables, and what friction, a coating and an offset contact add to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.normal import Contact
from sam.grid.cells import Window

SHEAR = 4  # index of the component 13 in the order 11 22 33 23 13 12


@dataclass(frozen=True)
class Sliding:
    """What friction adds to a state: traction q_x, (nx, ny) in Pa; in the rows at y = 0, (nx, rows)
    in m, ux, residual_ux of the plastic strain, uz beyond its share, and shear, -integral of 2
    eps_p_13.
    """

    traction: Array
    ux: Array
    residual_ux: Array
    uz: Array
    shear: Array

    def strained(self, residual_ux: Array, strain: Array, thickness: Array) -> Sliding:
        """The same with plastic strain, (6, nz, nx, rows), in layers of these thicknesses in m."""
        shear = -2 * np.tensordot(thickness, strain[SHEAR], axes=1)
        return Sliding(self.traction, self.ux + residual_ux, residual_ux, self.uz, shear)


@dataclass(frozen=True)
class Cut:
    """The plane y = const (m) through the largest pressure; x, z in m, stress (6, nz, nx) in Pa, peeq."""

    y: float
    x: Array
    z: Array
    stress: Array
    peeq: Array


def row_of_largest(contact: Contact, counts: Window) -> int | None:
    """The row of cells j with the largest pressure among the cells that count; None without contact."""
    inner = contact.pressure[counts.slices]
    return int(np.unravel_index(inner.argmax(), inner.shape)[1]) + counts.j0 if inner.any() else None


@dataclass(frozen=True)
class Comparison:
    """The bare body under the same load: p_max, von Mises stress (nz, n) in Pa, or a warning."""

    p_max: float | None = None
    mises: Array | None = None
    warning: str = ""


@dataclass(frozen=True)
class Coated:
    """What a coating adds to a state; counter_uz: (nx, rows) in m; comparison: with the bare body."""

    thickness: float
    counter_uz: Array
    comparison: Comparison | None = None


@dataclass(frozen=True)
class Box:
    """The cells that may yield: faces x, y, z in m; stress in Pa, strain (6, nz, nx, ny), peeq."""

    x: Array
    y: Array
    z: Array
    stress: Array
    strain: Array
    peeq: Array
    repeated: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Snapshot:
    """A state that goes into the tables. contact: on the full grid; residual_displacement: (nx, ny)
    in m; stress in Pa, strain: plastic, (6, nz, nx, rows), peeq: (nz, nx, rows) in the rows at y =
    0; mises: (nz, n) in Pa, among which the largest is; flowed: with plastic strain; top: depth in
    m and value of the largest peeq; worn in m; None for what a scene has not; repeated: by name.
    """

    state: str
    contact: Contact
    residual_displacement: Array
    stress: Array
    strain: Array
    peeq: Array
    mises: Array
    flowed: Mask | None = None
    sliding: Sliding | None = None
    coated: Coated | None = None
    top: tuple[float, float] | None = None
    worn: Array | None = None
    cut: Cut | None = None
    box: Box | None = None
    stretch: int = 0
    place: tuple[float, float] = (0.0, 0.0)
    repeated: Mapping[str, Array] = field(default_factory=dict)

    @property
    def friction(self) -> float:
        """Size of the sum of q over the sum of p; zero where either is."""
        if self.sliding is None or not self.contact.pressure.any():
            return 0.0
        return abs(float(self.sliding.traction.sum() / self.contact.pressure.sum()))

    @property
    def local_friction(self) -> Array:
        """|q|/p of each cell, (nx, ny); not a number out of contact."""
        p = self.contact.pressure
        if self.sliding is None:
            return np.where(p > 0, 0.0, np.nan)
        out = np.full(p.shape, np.nan)
        np.divide(np.abs(self.sliding.traction), p, out=out, where=p > 0)
        return out

    @property
    def in_plane(self) -> Array:
        """Stress in y = 0, the mean of the rows, (6, nz, nx) in Pa."""
        return self.stress.mean(axis=-1)
