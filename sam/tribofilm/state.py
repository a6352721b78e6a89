# SPDX-License-Identifier: MIT
"""The tribofilm on a grid of cells, solved together with the contact in each load step: it decides where
friction is low.

Within a load step the film is tested with the pressure and the surface strain of a contact. Where it fails,
friction becomes high, which changes both; so the iteration of the step goes on with that, until no further
cell fails at its end. Failures only add up, hence this ends. A failure lasts until the end of the cycle; the
next one begins with a new film. Bosman & Schipper 2011, section 4. Below a counter-body that moves each visit
of it to a cell begins with a whole film, which may thin by what grew while the cell was out of contact.

A cell enters when it bears pressure after it bore none while the counter-body moved on; then its film is
whole, and its strain is counted from that of the surface before the step. It leaves when it bears none; a
failure lasts until then. The film that may be lost in a visit is what grew since the last one, K_0 sqrt(t)
over its thickness (Bosman & Schipper 2011, Eq. 11, 16 and 17), t = way of the counter-body between the two
over its speed; in the first visit it is that of the scene. The clock is the way: it stands still while the
load is put on or taken off, so that a cell that is unloaded and loaded again at one place goes on with the
film that it had.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.arrays import ROUNDING, Array, Mask
from sam.tribofilm.law import FilmLaw, FilmState

BINS = 40  # of the way between two visits, each sqrt(2) times as long as the one before


def bins_of_visits(period: float) -> Array:
    """Upper ends in m of the bins of the way between two visits, (BINS,); period: of a pass, the last one."""
    return period * 2.0 ** (np.arange(1 - BINS, 1) / 2)


@dataclass(frozen=True, eq=False)
class Visits:
    """When the cells of a surface were in contact with a moving body. clock: its way in m; inside:
    now; left: the clock at the end of contact, or NaN; limit: thinning of this visit; strain: (4,
    nx, ny) at the last step; counts: of visits by the way between them.
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
    """The tribofilm on (nx, ny) cells; reference: total strains xx, yy, xy, zz of the surface at
    its start, (4, nx, ny); visits: below a counter-body that moves.
    """

    film: FilmState
    reference: Array
    visits: Visits | None = None


@dataclass(frozen=True)
class FilmOnCells:
    """The law of a tribofilm on `shape` (nx, ny) cells; below a counter-body that moves, rate: with which it
    may thin in a visit in 1/sqrt(m), None: by the limit; period: its way in m from pass to pass.
    """

    law: FilmLaw
    shape: tuple[int, int]
    rate: float | None = None
    period: float | None = None

    def fresh(self, strain: Array) -> TribofilmState:
        """A whole film on a surface with these total strains xx, yy, xy, zz, (4, nx, ny)."""
        visits = None
        if self.period is not None:  # before the first contact
            left, limits = np.full(self.shape, np.nan), np.full(self.shape, self.law.limit)
            visits = Visits(0.0, np.zeros(self.shape, dtype=bool), left, limits, strain, np.zeros(BINS))
        return TribofilmState(FilmState.fresh(self.shape), strain, visits)

    def entered(self, state: TribofilmState, clock: float) -> TribofilmState:
        """The film at the beginning of a step; clock: way of a counter-body that moves at its end, in m."""
        visits = state.visits
        if visits is None or self.period is None:
            return state
        new = ~visits.inside & ~(clock <= visits.left + ROUNDING * self.period)
        limit, failed = visits.limit, state.film.failed
        if self.rate is not None:
            again = new & np.isfinite(visits.left)
            limit = np.where(again, self.rate * np.sqrt(np.where(again, clock - visits.left, 0.0)), limit)
        if (failed & new).any():  # else the same array: nothing is solved anew for it
            failed = failed & ~new
        film = FilmState(np.where(new, 0.0, state.film.plastic), failed)
        reference = np.where(new, visits.strain, state.reference)
        return TribofilmState(film, reference, replace(visits, clock=clock, limit=limit))

    def coefficient(self, state: TribofilmState) -> Array:
        """Coefficient of friction of each cell, (nx, ny)."""
        return self.law.coefficient(state.film)

    def tested(
        self, committed: TribofilmState, tried: TribofilmState, strain: Array, *, pressure: Array, sign: float
    ) -> TribofilmState:
        """The film at the end of a step solved with the friction of `tried`, from `committed`;
        strain: (4, nx, ny); `failed` is the array of `tried` if no further cell fails.
        """
        before = FilmState(committed.film.plastic, tried.film.failed)
        since = strain - committed.reference
        visits = committed.visits
        limit = None if visits is None else visits.limit
        film = self.law.step(before, since[:3], pressure, sign=sign, bulk_normal=since[3], limit=limit)
        if not (film.failed & ~before.failed).any():
            film = replace(film, failed=before.failed)
        if visits is not None and self.period is not None:
            inside, bins = pressure > 0, bins_of_visits(self.period)
            came = inside & ~visits.inside & (visits.clock > visits.left + ROUNDING * self.period)
            ways = (visits.clock - visits.left)[came]
            which = np.minimum(np.searchsorted(bins, ways * (1 - ROUNDING)), BINS - 1)
            counts = visits.counts + np.bincount(which, minlength=BINS)
            left = np.where(visits.inside & ~inside, visits.clock, visits.left)
            visits = replace(visits, inside=inside, left=left, strain=strain, counts=counts)
        return replace(committed, film=film, visits=visits)
