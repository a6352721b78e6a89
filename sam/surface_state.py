# SPDX-License-Identifier: MIT
"""What a surface remembers from one load step to the next besides plastic strain: its tribofilm, and what is
worn off.

The records are frozen. The laws that make a new record from an old one stand in `sam.tribofilm` and in
`sam.wear`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.arrays import Array, Mask


@dataclass(frozen=True, eq=False)
class FilmState:
    """The film since the start of the cycle.

    plastic: plastic strain (6, nx, ny), tensor components in the order 11 22 33 23 13 12; failed: (nx, ny)
    bool. A failed cell keeps the strain at which it failed; where no equilibrium exists, that of the step
    before.
    """

    plastic: Array
    failed: Mask

    @classmethod
    def fresh(cls, shape: tuple[int, int]) -> FilmState:
        """A whole film without plastic strain on (nx, ny) cells."""
        return cls(np.zeros((6, *shape)), np.zeros(shape, dtype=bool))

    @property
    def thinning(self) -> Array:
        """Share of the thickness that plastic flow took, (nx, ny); negative where it is thicker."""
        return 0.0 - self.plastic[2]


BINS = 40  # of the way between two visits, each sqrt(2) times as long as the one before


def bins_of_visits(period: float) -> Array:
    """Upper ends in m of the bins of the way between two visits, (BINS,); period: of a pass, the last one."""
    return period * 2.0 ** (np.arange(1 - BINS, 1) / 2)


@dataclass(frozen=True, eq=False)
class Visits:
    """When the cells of a surface were in contact with a counter-body that moves.

    clock: way of the counter-body at the end of the last step in m; inside: which cells were in contact then;
    left: the clock when a cell left, NaN of one that never was inside; limit: largest thinning of the film in
    the present visit; strain: as `reference` of `TribofilmState`, at the end of the last step, (4, nx, ny);
    counts: of visits by the way between two of them, see `bins_of_visits`. All but that (nx, ny).
    """

    clock: float
    inside: Mask
    left: Array
    limit: Array
    strain: Array
    counts: Array

    def unloaded(self, strain: Array) -> Visits:
        """The same without contact, on a surface with these strains."""
        left = np.where(self.inside, self.clock, self.left)
        return replace(self, inside=np.zeros_like(self.inside), left=left, strain=strain)


@dataclass(frozen=True, eq=False)
class TribofilmState:
    """The tribofilm on the cells of a surface, and the strain of the surface at the start of the cycle.

    film: on (nx, ny) cells; reference: total strains xx, yy, xy (tensor), zz of the surface when the film was
    new, (4, nx, ny). The printed form of the law alone needs zz. visits: below a counter-body that moves.
    """

    film: FilmState
    reference: Array
    visits: Visits | None = None


@dataclass(frozen=True, eq=False)
class WearState:
    """Wear so far on the whole grid.

    cell_area: hx hy in m2; depth: (nx, ny) in m, sum over the cycles of what was removed. For each cycle:
    volumes, in m3, removed; raw_volumes: what tore, before smoothing; roofed_volumes: above the limit under a
    sound roof, which stays; bottom_columns: how many tore down to the deepest face; residuals: of the remap,
    see `sam.wear.closing_residual`.
    """

    cell_area: float
    depth: Array
    volumes: tuple[float, ...] = ()
    raw_volumes: tuple[float, ...] = ()
    roofed_volumes: tuple[float, ...] = ()
    bottom_columns: tuple[int, ...] = ()
    residuals: tuple[float, ...] = ()

    @classmethod
    def empty(cls, shape: tuple[int, int], hx: float, hy: float) -> WearState:
        """The surface before the first cycle; hx, hy: cell in m."""
        return cls(hx * hy, np.zeros(shape))

    @property
    def volume(self) -> float:
        """Removed so far, in m3."""
        return sum(self.volumes)

    @property
    def raw_volume(self) -> float:
        """Raw removal so far, in m3; what smoothing left counts again when it is removed again."""
        return sum(self.raw_volumes)

    def volume_of(self, thickness: Array) -> float:
        """Volume in m3 of a layer of this thickness in m on the cells, (nx, ny)."""
        return float(self.cell_area * thickness.sum())

    def imbalance(self, original: Array, current: Array) -> float:
        """Volume minus hx hy sum(original - current), in m3; heights (nx, ny) in m, undisplaced."""
        return self.volume - self.volume_of(original - current)
