# SPDX-License-Identifier: MIT
"""The tribofilm on a grid of cells, solved together with the contact in each load step: it decides where
friction is low.

Within a load step the film is tested with the pressure and the surface strain of a solved contact. Where it
fails, friction becomes high, which changes both; so the step is solved again, from where it began, until no
further cell fails. Failures only add up, hence this ends. A failure lasts until the end of the cycle; the
next one begins with a new film. Bosman & Schipper 2011, section 4. Below a counter-body that moves a visit of
it takes the place of a cycle, see `sam.tribofilm.visits`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sam.arrays import Array
from sam.surface_state import FilmState, TribofilmState
from sam.tribofilm.law import FilmLaw

if TYPE_CHECKING:
    from sam.tribofilm.visits import VisitLaw


@dataclass(frozen=True)
class FilmOnCells:
    """The law of a tribofilm on `shape` (nx, ny) cells; what it makes is a new `TribofilmState` each time.
    visited: below a counter-body that moves.
    """

    law: FilmLaw
    shape: tuple[int, int]
    visited: VisitLaw | None = None

    def fresh(self, strain: Array) -> TribofilmState:
        """A whole film on a surface with these total strains xx, yy, xy, zz, (4, nx, ny)."""
        visits = None if self.visited is None else self.visited.never(strain, self.law.limit)
        return TribofilmState(FilmState.fresh(self.shape), strain, visits)

    def entered(self, state: TribofilmState, clock: float) -> TribofilmState:
        """The film at the beginning of a step; clock: way of a counter-body that moves at its end, in m."""
        if state.visits is None or self.visited is None:
            return state
        return self.visited.entered(state, state.visits, clock)

    def coefficient(self, state: TribofilmState) -> Array:
        """Coefficient of friction of each cell, (nx, ny)."""
        return self.law.coefficient(state.film)

    def tested(
        self, committed: TribofilmState, tried: TribofilmState, strain: Array, *, pressure: Array, sign: float
    ) -> TribofilmState:
        """The film at the end of a load step that was solved with the friction of `tried`.

        committed: at its beginning; strain: of the surface at its end, (4, nx, ny); pressure: in Pa, (nx,
        ny); sign: of the traction along x. The film flows from where it was committed, and what failed in an
        earlier pass of the step stays so. Where no further cell fails, `failed` is the array of `tried`:
        friction is what the step was solved with.
        """
        before = FilmState(committed.film.plastic, tried.film.failed)
        since = strain - committed.reference
        visits = committed.visits
        limit = None if visits is None else visits.limit
        found = self.law.step(before, since[:3], pressure, sign=sign, bulk_normal=since[3], limit=limit)
        if not (found.failed & ~before.failed).any():
            found = replace(found, failed=before.failed)
        if visits is not None and self.visited is not None:
            visits = self.visited.after(visits, pressure, strain)
        return replace(committed, film=found, visits=visits)
