# SPDX-License-Identifier: MIT
"""The chemical film on a grid of cells, settled with the contact in each load step: it decides where friction is low.

Within a load step the film is tested with the pressure and the surface strain of a solved contact. Where it fails, friction
becomes high, which changes both; so the step is solved again, from where it began, until no further cell fails. Failures
only add up, hence this ends. A failure lasts until the end of the cycle; the next one begins with a new film.
Bosman & Schipper 2011, section 4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.grid.cells import CellGrid
from sam.scene import Scene
from sam.tribofilm.law import FilmLaw, FilmState


@dataclass(frozen=True)
class Film:
    """The film after a committed load step. state: (nx, ny) cells; reference: surface strain at the start of the cycle.

    strains: xx, yy, xy (tensor), zz, (4, nx, ny); zz is needed by the printed form only.
    """

    state: FilmState
    reference: np.ndarray


class Protection:
    """The film of a scene during its load history."""

    def __init__(self, scene: Scene, grid: CellGrid):
        self.law = FilmLaw.of(scene.friction)
        self.shape = grid.nx, grid.ny
        self.begin_cycle(np.zeros((4, *self.shape)))

    def begin_cycle(self, strain: np.ndarray) -> None:
        """A new film on a surface with this strain."""
        self.film = Film(FilmState.fresh(self.shape), strain)
        self.revert()

    def revert(self) -> None:
        """Forget the passes since the last committed step."""
        self._trial = self.film.state

    @property
    def coefficient(self) -> np.ndarray:
        """(nx, ny), after the passes so far."""
        return self.law.coefficient(self._trial)

    def fails(self, strain: np.ndarray, pressure: np.ndarray, sign: float) -> bool:
        """Whether the film fails in further cells under a pressure in Pa, and with it the coefficient changes."""
        before = FilmState(self.film.state.plastic, self._trial.failed)
        since = strain - self.film.reference
        self._trial = self.law.step(before, since[:3], pressure, sign, since[3])
        return bool((self._trial.failed & ~before.failed).any())

    def commit(self) -> None:
        """The film after the last pass is the one at the end of the step."""
        self.film = Film(self._trial, self.film.reference)

    def continue_from(self, film: Film) -> None:
        """The film as it was recorded."""
        self.film = film
        self.revert()


def elastic_strain(stress: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Elastic strains xx, yy, xy, zz of stresses (6, ...) in Pa, order 11 22 33 23 13 12."""
    sxx, syy, szz, sxy = stress[0], stress[1], stress[2], stress[5]
    parts = (
        sxx - poisson * (syy + szz),
        syy - poisson * (sxx + szz),
        (1 + poisson) * sxy,
        szz - poisson * (sxx + syy),
    )
    return np.stack(parts) / young


def surface_strain(
    stress: np.ndarray, plastic: np.ndarray, depths: np.ndarray, young: float, poisson: float
) -> np.ndarray:
    """Total strains xx, yy, xy, zz of the surface, (4, nx, ny), from the mean strains of the two uppermost layers of cells.

    stress in Pa and plastic strain, (6, n_layers, nx, ny); depths: of the layer centres in m. In the plane total strains are
    continuous across the layers; they are extrapolated linearly to z = 0. With one layer its mean is taken.
    """
    total = elastic_strain(stress[:, :2], young, poisson) + plastic[[0, 1, 5, 2], :2]
    if total.shape[1] < 2:
        return total[:, 0]
    return total[:, 0] + (total[:, 0] - total[:, 1]) * depths[0] / (depths[1] - depths[0])
