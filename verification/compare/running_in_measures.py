# SPDX-License-Identifier: MIT
"""Running-in in numbers: what a run's tables cycles.csv and surface.csv say of wear, friction and roughness.

Nothing here knows how they were computed, so that bookkeeping is summed again, and statements are judged,
independently.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Scene
from verification.reference import bonded_film
from verification.runs.sampling import Tables, gridded, rows_of

NAN = float("nan")


@dataclass(frozen=True)
class History:
    """A run over its cycles, each (n,) in SI; see CYCLES in sam.scene.result. The volume is cumulative."""

    cycle: np.ndarray
    volume: np.ndarray
    friction: np.ndarray
    sa: np.ndarray
    protected: np.ndarray
    p_max: np.ndarray

    @classmethod
    def of(cls, tables: Tables) -> History:
        """From the tables of a run."""
        columns = "cycle wear_volume_m3 friction_coefficient sa_m protected_fraction p_max_Pa".split()
        return cls(*(np.asarray(tables["cycles"][name], dtype=float) for name in columns))

    def at(self, column: str, cycle: int) -> float:
        """A column at the end of a cycle; NaN if the run does not get there."""
        found = np.flatnonzero(self.cycle == cycle)
        return float(getattr(self, column)[found[0]]) if found.size else float("nan")

    def volume_after(self, cycle: int) -> float:
        """Worn volume in m3 after so many cycles, 0 after none."""
        return self.at("volume", cycle) if cycle else 0.0

    def rate(self, first: int, last: int) -> float:
        """Volume in m3 that a cycle wears, the mean of those after `first` up to `last`."""
        return (self.volume_after(last) - self.volume_after(first)) / (last - first)

    def straightness(self, first: int, last: int) -> float:
        """Share of the variance of the volume that a straight line explains; NaN where it does not grow."""
        use = (self.cycle >= first) & (self.cycle <= last)
        x, y = self.cycle[use], self.volume[use]
        if x.size < last - first + 1 or not np.ptp(y) > 0.0:
            return float("nan")
        return float(np.corrcoef(x, y)[0, 1] ** 2)


@dataclass(frozen=True)
class Scar:
    """The surface of the last cycle: x (nx,), y (ny,) in m, the others (nx, ny). height: before any wear, in
    m; worn: depth in m after the cycle; at its peak p in Pa and friction, the local coefficient, NaN out of
    contact.
    """

    x: np.ndarray
    y: np.ndarray
    height: np.ndarray
    p: np.ndarray
    worn: np.ndarray
    friction: np.ndarray

    @classmethod
    def of(cls, tables: Tables) -> Scar:
        """From the tables of a run."""
        x, y, height, p, friction = _gridded(tables, "peak", "height_m", "p_Pa", "friction")
        *_, worn = _gridded(tables, "unloaded", "worn_m")
        return cls(x, y, height, p, worn, friction)

    @property
    def cell_area(self) -> float:
        """In m2, of cells that cover the patch evenly."""
        return float(np.ptp(self.x) / (self.x.size - 1) * np.ptp(self.y) / (self.y.size - 1))

    @property
    def volume(self) -> float:
        """Worn volume in m3."""
        return self.cell_area * float(np.nansum(self.worn))

    @property
    def force(self) -> float:
        """Sum of the pressure in N."""
        return self.cell_area * float(np.nansum(self.p))

    @property
    def in_contact(self) -> np.ndarray:
        """Cells under pressure."""
        return np.nan_to_num(self.p) > 0.0

    def unprotected(self, low: float, high: float) -> np.ndarray:
        """Cells in contact whose film has failed."""
        with np.errstate(invalid="ignore"):
            return self.in_contact & (self.friction > 0.5 * (low + high))

    def coefficient(self, low: float, high: float) -> float:
        """Overall coefficient of friction, low + (high - low) W_high/W, W_high: load on failed film."""
        p, bare = np.nan_to_num(self.p), self.unprotected(low, high)
        return bonded_film.overall_coefficient(p, bare, low, high, cell_area=self.cell_area)

    def protected_fraction(self, low: float, high: float) -> float:
        """Share of the contact area under a whole film."""
        return 1.0 - float(self.unprotected(low, high).sum() / self.in_contact.sum())


def _gridded(tables: Tables, state: str, *columns: str) -> tuple[np.ndarray, ...]:
    """x (nx,), y (ny,) and columns (nx, ny) of surface.csv. ValueError where cells are missing."""
    x, y, *fields = rows_of(tables["surface"], state, "x_m", "y_m", *columns)
    xs, ys, *grids = gridded(x, y, *fields)
    if xs.size * ys.size != x.size or not x.size:
        raise ValueError(f"surface, {state}: {x.size} rows for {xs.size} × {ys.size} cells")
    return xs, ys, *grids


@dataclass(frozen=True)
class Spread:
    """Median and range over seeds of what is a number, infinite ones too; n: of how many."""

    median: float
    low: float
    high: float
    n: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """From the values of several surfaces."""
        known = np.sort([value for value in values if not np.isnan(value)])
        n = known.size
        if not n:
            return cls(NAN, NAN, NAN, 0)
        return cls(float(np.median(known)), float(known[0]), float(known[-1]), n)

    @property
    def text(self) -> str:
        """Median (lowest to highest); a dash where nothing is known."""
        if not self.n:
            return "–"
        median, low, high = (f"{v:.3g}".replace("inf", "∞") for v in (self.median, self.low, self.high))
        return median if self.n == 1 else f"{median} ({low} to {high})"


@dataclass(frozen=True)
class Limits:
    """What decides the regime of a scene's spots, in Pa. strength: of the surface at its strain limit;
    removal: pressure above which the traction after film breakdown removes it; film: pressure of film
    breakdown.
    """

    strength: float
    removal: float
    film: float

    @classmethod
    def of(cls, scene: Scene) -> Limits:
        """From the materials and the film of a scene; below z = 0 the layer, if there is one."""
        friction, wear, plasticity = scene.friction, scene.wear, scene.body.plasticity
        limit, law = wear.strain_limit, plasticity
        if plasticity.layer_thickness is not None:
            limit, law = wear.strain_limit_layer or limit, plasticity.layer or law
        own = bonded_film.swift(law.B, law.C, law.n, limit * (law.alpha / bonded_film.MICROSTRAIN))
        strength = float(plasticity.depth_profile()(0.0)) * own
        film = friction.film_young, friction.film_poisson, friction.film_yield
        body = scene.body.young, scene.body.poisson
        fails = bonded_film.film_pressure(friction.thinning_limit, friction.low, film, body)
        return cls(strength, bonded_film.tear_pressure(strength, friction.high), fails)
