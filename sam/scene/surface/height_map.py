# SPDX-License-Identifier: MIT
"""Measured heights as a value of a scene, known by the digest of their content wherever they come from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from sam.arrays import Array
from sam.scene.inputs import InputError
from sam.scene.units import CELLS, COEFFICIENT, LENGTH, refused

HIGHEST = 1e30  # m; as for every length of a scene
PLACES = ("x_m", "y_m")
"""Columns of the coordinates in a file."""
KEYS = ("sha256", "cells", "extent")


class HeightMap:
    """Heights at the centres of nx x ny equal cells, positive out of the body; the origin in the middle.

    Parameters
    ----------
    values
        Heights (nx, ny) in m, x first; nan where one is missing.
    extent
        (Lx, Ly) in m: nx cells of Lx/nx each.

    Attributes
    ----------
    sha256
        Of extent and heights, by which two maps are equal.
    values
        Read-only; None if only the digest is at hand, as in the scene of a summary.json: such a map cannot be
        solved.
    of_file
        The keys of a scene file that name the file of the map; empty of one that was made in Python.

    Raises
    ------
    ValueError
        For too few or too many cells, or heights out of range.
    """

    __slots__ = ("cells", "extent", "of_file", "sha256", "values")
    column: ClassVar[str] = "height_m"
    wrapped: ClassVar[str] = "samfem.HeightMap(array, (Lx, Ly)), heights in m, x first"

    @classmethod
    def columns(cls) -> tuple[str, str, str]:
        """The columns of a file with such maps."""
        return (*PLACES, cls.column)

    @classmethod
    def columns_in_words(cls) -> str:
        """The same as messages name them."""
        return f"x_m, y_m and {cls.column} on a regular grid"

    def __init__(self, values: Array, extent: tuple[float, float]):
        heights: Array = np.array(values, dtype="<f8", order="C")
        if heights.ndim != 2:
            raise InputError(f"heights of shape {heights.shape}: two dimensions are needed")
        cells, sides = _sizes(heights.shape, tuple(extent))
        self.cells = cells
        self.extent = sides
        absent = np.isnan(heights)
        heights[absent] = np.nan  # of the many ways to write it the same
        if not (absent | (np.abs(heights) <= HIGHEST)).all():
            raise InputError(f"heights from {-HIGHEST:g} to {HIGHEST:g} m are allowed")
        heights.flags.writeable = False
        content = hashlib.sha256(np.array([*self.cells, *self.extent], dtype="<f8").tobytes())
        content.update(heights.tobytes())
        self.sha256 = content.hexdigest()
        self.values: Array | None = heights
        self.of_file: dict[str, Any] = {}

    @classmethod
    def known_by(cls, sha256: str, cells: tuple[int, int], extent: tuple[float, float]) -> HeightMap:
        """A map of which only the digest is at hand."""
        known = object.__new__(cls)
        known.values, known.sha256, known.cells, known.extent = None, sha256, cells, extent
        known.of_file = {}
        return known

    @property
    def cell(self) -> tuple[float, float]:
        """Sides of a cell in m."""
        return self.extent[0] / self.cells[0], self.extent[1] / self.cells[1]

    @property
    def missing(self) -> int:
        """How many heights are missing; 0 if only the digest is at hand."""
        return 0 if self.values is None else int(np.count_nonzero(np.isnan(self.values)))

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scene holds in place of the heights."""
        return {"sha256": self.sha256, "cells": list(self.cells), "extent": list(self.extent)}

    def __reduce__(self) -> tuple[Any, ...]:
        if self.values is None:
            return type(self).known_by, (self.sha256, self.cells, self.extent)
        return type(self), (self.values, self.extent), (None, {"of_file": self.of_file})

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.sha256 == other.sha256

    def __hash__(self) -> int:
        return hash(self.sha256)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.cells[0]} x {self.cells[1]} cells, {self.sha256[:8]})"


def _sizes(cells: tuple[Any, ...], extent: tuple[Any, ...]) -> tuple[tuple[int, int], tuple[float, float]]:
    """The cells and sides in m. Raises InputError unless they are those of a grid."""
    if len(cells) != 2 or not all(isinstance(n, int) and CELLS.low <= n <= CELLS.high for n in cells):
        words = f"{' x '.join(map(str, cells))} heights"
        raise InputError(f"{words}: {CELLS.low:g} to {CELLS.high:g} each way are allowed")
    sides = tuple(map(float, extent))
    if len(sides) != 2 or not all(LENGTH.low <= side <= LENGTH.high for side in sides):
        words = " and ".join(f"{side:g}" for side in sides)
        raise InputError(f"sides of {words} m: {LENGTH.low:g} to {LENGTH.high:g} are allowed")
    return (cells[0], cells[1]), (sides[0], sides[1])


class FrictionMap(HeightMap):
    """Coefficients of friction on (nx, ny) equal cells about the origin, as a HeightMap."""

    __slots__ = ()
    column: ClassVar[str] = "friction"
    wrapped: ClassVar[str] = "sam.scene.FrictionMap(array, (Lx, Ly)), x first"

    def __init__(self, values: Array, extent: tuple[float, float]):
        """Raises InputError also for coefficients out of range."""
        super().__init__(values, extent)
        coefficients = np.asarray(self.values)
        if not ((coefficients >= COEFFICIENT.low) & (coefficients <= COEFFICIENT.high)).all():
            raise InputError(f"coefficients from {COEFFICIENT.low:g} to {COEFFICIENT.high:g} are allowed")


def from_python(value: object, kind: type[HeightMap]) -> HeightMap:
    """A map given in Python, or as `HeightMap.described`; else an error "allowed"."""
    if type(value) is kind:
        return value
    if not isinstance(value, Mapping) or set(value) != set(KEYS):
        array = isinstance(value, np.ndarray)
        raise refused(f"wrap it: {kind.wrapped}" if array else f"a {kind.__name__}")
    try:
        sha256, cells, extent = (value[key] for key in KEYS)
        cells, extent = _sizes(tuple(cells), tuple(extent))
        if len(bytes.fromhex(sha256)) != hashlib.sha256().digest_size:
            raise ValueError(sha256)
    except (InputError, TypeError, ValueError):
        raise refused(f"a {kind.__name__}, or sha256, cells and extent of one") from None
    return kind.known_by(sha256, cells, extent)
