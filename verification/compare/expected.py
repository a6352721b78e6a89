# SPDX-License-Identifier: MIT
"""What the results of a scene are about, before it is solved: this shows a wrong unit or place of data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam import hertz_semi_axes
from sam.scene import PEAK, Problem, Scene
from verification.reference.hertz import effective_modulus
from verification.text.readable import with_prefix

FARTHEST = 100.0
"""Times more or less than expected: a wrong unit is off by 1000, plastic flow by less than 10."""
NEAR = (
    1.5  # contact radii: some values must be as near as that, and plastic flow may widen the contact so far
)
SHORTEST = 0.05  # contact radii: data that reach no farther are in a wrong unit of length
LEAST_NEAR = 2
PLACES = {"line": ("x_m",), "axis": ("z_m",), "plane": ("x_m", "z_m")}


@dataclass(frozen=True)
class Expected:
    """Sizes to within a factor of ten: contact radius and approach in m, pressure in Pa; NaN: unknown."""

    radius: float
    pressure: float
    approach: float

    @classmethod
    def of(cls, scene: Scene) -> Expected:
        """By Hertz, for the elastic body without coating; of a rough scene the half side of its patch alone:
        the line and the axis may miss every spot.
        """
        radius = float(max(hertz_semi_axes(scene)))
        body, other, loading = scene.body, scene.counterbody, scene.loading
        if other is None:
            return cls(radius, loading.p0 if loading.hertz else math.nan, math.nan)
        modulus = effective_modulus(body.young, body.poisson, other.young, other.poisson)
        if other.shape == "flat":
            return cls(radius, math.nan, math.nan)
        if other.radii is None:
            force = math.nan if loading.force is None else loading.force
            return cls(radius, force / (math.pi * radius**2), force / (2 * modulus * radius))
        largest = max(other.radii)
        return cls(radius, 2 * modulus * radius / (math.pi * largest), radius**2 / largest)

    @property
    def sizes(self) -> dict[str, float]:
        """Column -> what its largest value is about; a column that is not here may have any value."""
        lengths = dict.fromkeys(("uz_m", "approach_m"), self.approach)
        return dict.fromkeys(("p_Pa", "p_max_Pa", "mises_Pa", "szz_Pa"), self.pressure) | lengths

    def faults(self, name: str, table: Mapping[str, np.ndarray]) -> Iterator[Problem]:
        """What a table says that cannot be of this scene: its place, its units, its signs."""
        rows = np.asarray(table["state"]) == PEAK if "state" in table else slice(None)
        at_peak = {column: np.asarray(values)[rows] for column, values in table.items() if column != "note"}
        for column in PLACES.get(name, ()):
            yield from self._misplaced(column, at_peak[column])
        for column, size in self.sizes.items():
            if column in at_peak:
                yield from _out_of_size(column, at_peak[column], size)

    def _misplaced(self, column: str, values: np.ndarray) -> Iterator[Problem]:
        if not values.size:
            return
        low, high = float(values.min()), float(values.max())
        reach = f"{with_prefix(low, 'm')} to {with_prefix(high, 'm')}"
        around = f"the contact is at the origin, with a radius of about {with_prefix(self.radius, 'm')}"
        below = values[values >= 0] if column == "z_m" else np.abs(values)
        if column == "z_m" and high <= 0 > low:
            yield Problem(column, reach, "z points into the body: the axis is upside down")
        elif np.unique(below[below <= NEAR * self.radius]).size < LEAST_NEAR:
            yield Problem(column, reach, f"{around}: the place, or the unit of length, is another")
        elif max(abs(low), abs(high)) < SHORTEST * self.radius:
            yield Problem(column, reach, f"{around}: the unit of length is another")


def _out_of_size(column: str, values: np.ndarray, size: float) -> Iterator[Problem]:
    values = values[np.isfinite(values)]
    largest = float(np.abs(values).max(initial=0.0))
    unit = column.rpartition("_")[2]
    if values.size and size > 0 and not size / FARTHEST <= largest <= size * FARTHEST:
        times = f"it is in {unit}, and expected at about {with_prefix(size, unit)}"
        yield Problem(column, f"at most {with_prefix(largest, unit)}", f"{times}: the unit is another")
    elif column == "p_Pa" and values.size and values.min() < -largest / 2:
        yield Problem(column, with_prefix(float(values.min()), unit), "p > 0 is compressive: change the sign")
