# SPDX-License-Identifier: MIT
"""The table [surface] of a scene: rough heights, from a file or made, and the cells that they need."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import ceil, inf, isclose
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from sam.scene.inputs import listed
from sam.scene.numerics import Grid
from sam.scene.section import Conflict, Given, Section, broken, of_choice, stated
from sam.scene.surface.height_map import HeightField, HeightMap
from sam.scene.units import (
    CELLS,
    LENGTH,
    Anisotropy,
    Coordinate,
    Hurst,
    Length,
    Seed,
    Share,
    metres_in,
    refused,
)

_SELF_AFFINE = ("cutoff_long", "cutoff_short", "hurst", "seed")
KINDS = {
    "file": (("path",), ("extent", "unit", "missing", "form", "crop", "resample", "taper")),
    "hard-turned": (("ra", "feed", "nose_radius", "feed_share", *_SELF_AFFINE), ("anisotropy",)),
    "self-affine": (_SELF_AFFINE, ("ra", "sq", "anisotropy")),
    "sinusoid": (("amplitude",), ("wavelength_x", "wavelength_y")),
}
"""Kinds of surface, the keys that each needs, and those that it may have."""
GENERATED = tuple(kind for kind in KINDS if kind != "file")
FEWEST_CELLS = 2  # in the shortest wavelength (Nyquist)
CLOSE = 1e-6  # of a side: two sides are equal
MOST_FILLED = 1 << 18  # points whose heights are made up: a sparse factorization of some seconds
CROP = "[lx, ly], or [x, y, lx, ly] with the middle of the part at (x, y)"


def _two_or_four(value: object) -> tuple[Any, ...]:
    """A TOML array (or tuple, or list) as a tuple."""
    value = listed(value)
    if not isinstance(value, list | tuple) or len(value) not in (2, 4):
        raise refused(CROP)
    return tuple(value)


def _one_or_two(value: object) -> tuple[Any, ...]:
    """One length, or two of them in a TOML array (or tuple, or list), as a tuple."""
    value = listed(value)
    sides = tuple(value) if isinstance(value, list | tuple) else (value,)
    if len(sides) not in (1, 2):
        raise refused("[lx, ly], the sides of the map, or one length for a square one")
    return sides


def _unit(value: object) -> object:
    if metres_in(value) is None:
        raise refused('a unit of length, such as "um"')
    return value


_SIDE = LENGTH.__get_pydantic_json_schema__(None, None)
_SIDES = {"anyOf": [_SIDE, {"type": "array", "items": _SIDE, "minItems": 1, "maxItems": 2}]}
_NAME = {"type": "string", "examples": ["um"], "description": "a unit of length"}
Covered = Annotated[tuple[Length, ...], BeforeValidator(_one_or_two), WithJsonSchema(_SIDES)]
UnitName = Annotated[str, BeforeValidator(_unit), WithJsonSchema(_NAME)]


class Surface(Section):
    """The heights of the body's surface, which is a plane without this table. Lengths in m, heights positive
    out of the body.

    kind "file": path, the name of a text, npz or npy file or of an instrument's in the folder of the scene,
    in Python a HeightMap. extent and unit say what the file does not: what a matrix of heights covers, its
    outer cells as a whole, and the unit of its numbers; they are part of the map when it is read, and None
    then.
    What is done to it, in this order, see sam.scene.surface.making: form ("none" if not
    given): "tilt", "sphere" or "quadratic" is taken off; missing ("refuse" if not given): "harmonic" fills
    missing points; crop: [lx, ly], or [x, y, lx, ly], the part of that size with its middle at (x, y) from
    the middle of the map, rounded to whole cells; resample: "fourier" lets grid.cells be any, which else are
    those of the file; taper: on a periodic patch, the share of each side in which heights are blended so that
    they repeat. The other kinds are made on any grid, see sam.scene.surface.making. "self-affine":
    ra or sq, cutoff_long, cutoff_short, hurst, anisotropy (1 if not given), seed; "hard-turned": ra, feed,
    nose_radius and feed_share as well; "sinusoid": amplitude, wavelength_x and wavelength_y (one alone: a
    wave).
    """

    table: ClassVar[str] = "surface"
    words: ClassVar[str] = "surface"
    common: ClassVar[tuple[str, ...]] = ("kind",)  # keys that every kind may have
    kind: Literal["file", "hard-turned", "self-affine", "sinusoid"]
    extent: Covered | None = Field(None, exclude=True)
    unit: UnitName | None = Field(None, exclude=True)
    path: HeightField | None = None  # below extent and unit: they are known when it is read
    missing: Literal["refuse", "harmonic"] | None = None
    form: Literal["none", "tilt", "sphere", "quadratic"] | None = None
    crop: Annotated[tuple[Coordinate, ...], BeforeValidator(_two_or_four)] | None = None
    resample: Literal["fourier"] | None = None
    taper: Share | None = None
    ra: Length | None = None
    sq: Length | None = None
    feed: Length | None = None
    nose_radius: Length | None = None
    feed_share: Share | None = None
    cutoff_long: Length | None = None
    cutoff_short: Length | None = None
    hurst: Hurst | None = None
    anisotropy: Anisotropy | None = None
    seed: Seed | None = None
    amplitude: Length | None = None
    wavelength_x: Length | None = None
    wavelength_y: Length | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("taper",)

    @model_validator(mode="after")
    def _as_read(self) -> Self:
        """The same map is the same surface, however its file spells it."""
        self.__dict__.update(extent=None, unit=None)
        return self

    @property
    def random(self) -> bool:
        """Whether a seed decides on it."""
        return self.seed is not None

    @property
    def measured(self) -> HeightMap:
        """The map in the file. Only for a file."""
        return stated(self.path)

    @property
    def shortest(self) -> tuple[float, float]:
        """Shortest wavelength along x and y in m, or infinite. Not for a file."""
        if self.kind == "sinusoid":
            return self.wavelength_x or inf, self.wavelength_y or inf
        return stated(self.cutoff_short), stated(self.cutoff_short) * stated(self.anisotropy)

    @property
    def window(self) -> tuple[slice, slice]:
        """The cells of the file that are used: those that fit crop best."""
        *middle, lx, ly = (0.0, 0.0, *(self.crop or self.measured.extent))
        (x, y), (nx, ny), (hx, hy) = middle[-2:], self.measured.cells, self.measured.cell
        return _part(x, lx, nx, hx), _part(y, ly, ny, hy)

    def patch(self, cells: tuple[int, int] | None = None) -> tuple[tuple[int, int], tuple[float, float]]:
        """(nx, ny) and (Lx, Ly) in m of what is solved, of a file; cells: as asked for."""
        measured, extent = self.measured.cells, self.measured.extent
        if self.crop is not None:
            (x, y), (hx, hy) = self.window, self.measured.cell
            measured = x.stop - x.start, y.stop - y.start
            extent = measured[0] * hx, measured[1] * hy
        return (measured if cells is None or self.resample is None else cells), extent

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """What is done to a file, and the anisotropy of a generated surface, unless they are given."""
        if given.get("kind") == "file":
            return {"missing": "refuse", "form": "none"}
        return {"anisotropy": 1.0} if given.get("kind") in ("hard-turned", "self-affine") else {}

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Keys that the kind of surface needs, or has no use for."""
        kind = given.text("kind")
        if kind not in KINDS:
            return
        needed, optional = KINDS[kind]
        keys = [key for key in cls.model_fields if key not in cls.common]
        missing, surplus = (
            f'kind = "{kind}" takes {", ".join(some)}' for some in (needed, needed + optional)
        )
        words = f"required: {missing}", f"{surplus}: remove it"
        yield from of_choice(given, keys, (needed, needed + optional), words)
        affine, wave = kind == "self-affine", kind == "sinusoid"
        ra, sq = "ra" in given, "sq" in given
        waves = "wavelength_x" in given or "wavelength_y" in given
        yield from broken(
            (affine and ra and sq, "sq", "either ra or sq, not both"),
            (affine and not (ra or sq), "ra", "required: ra or sq"),
            (wave and not waves, "wavelength_x", "required: wavelength_x, wavelength_y, or both"),
        )

    def excesses(self) -> Iterator[Conflict]:
        """Wavelengths, crops and missing heights that do not fit each other."""
        if self.random and not stated(self.cutoff_short) < stated(self.cutoff_long):
            yield "cutoff_short", f"less than cutoff_long, {self.cutoff_long:g} m"
        if self.feed is not None and not self.feed >= stated(self.cutoff_short):
            yield "feed", f"at least cutoff_short, {self.cutoff_short:g} m: shorter waves are left out"
        if self.kind != "file":
            return
        (nx, ny), extent = self.measured.cells, self.measured.extent
        if self.crop is not None:
            sides, (x, y) = " x ".join(f"{side:.6g} m" for side in extent), self.window
            inside = 0 <= x.start and x.stop <= nx and 0 <= y.start and y.stop <= ny
            if not all(0 < a <= b * (1 + CLOSE) for a, b in zip(self.crop[-2:], extent, strict=True)):
                yield "crop", f"{CROP}, sides above 0, at most those of the map, {sides}"
            elif not inside:
                yield "crop", f"{CROP} from the middle of the map, inside of it: {sides}"
            elif min(self.patch()[0]) < CELLS.low:
                cell = " x ".join(f"{side:.6g} m" for side in self.measured.cell)
                yield "crop", f"{CROP}, at least {CELLS.low:g} cells each way, of {cell}"
        missing, most = self.measured.missing, min(MOST_FILLED, nx * ny // 2)
        words, refuses = f"{missing} of {nx * ny} heights are missing", self.missing == "refuse"
        fill = f'fill them, or give {self.table}.missing = "harmonic"'
        yield from broken(
            (missing and refuses, "path", f"{words}: {fill}"),
            (missing > most and not refuses, "missing", f"{words}: at most {most} of them can be filled"),
        )


def _part(middle: float, side: float, n: int, cell: float) -> slice:
    """The cells, of n, that fit best a part of that side about its middle."""
    count = round(side / cell)
    first = ceil(round(middle / cell + (n - count) / 2, 6) - 0.5)  # rounded twice: of two as near the first
    return slice(first, first + count)


def grid_excesses(surface: Surface, grid: Grid | None) -> Iterator[Conflict]:
    """Keys of a scene whose grid does not suit its surface: not that of the file, or too coarse."""
    if surface.kind != "file":
        grid = stated(grid)
        yield from coarse_grid(surface, stated(grid.cells), stated(grid.extent))
    elif grid is not None:
        words = f"the grid of {surface.table}.path" + f" after {surface.table}.crop" * (
            surface.crop is not None
        )
        (cells, extent), leave = surface.patch(grid.cells), "leave it out"
        resample = f'{surface.table}.resample = "fourier"'
        if grid.cells is not None and grid.cells != cells:
            yield "grid.cells", f"{list(cells)}, {words}: {leave}, or give {resample}"
        if grid.extent is not None and not _alike(grid.extent, extent):
            yield "grid.extent", f"{' and '.join(f'{side:.9g} m' for side in extent)}, {words}: {leave}"


def _alike(sides: Iterable[float], others: Iterable[float]) -> bool:
    return all(isclose(*pair, rel_tol=CLOSE) for pair in zip(sides, others, strict=True))


def patch_excesses(
    surface: Surface, cells: tuple[int, int], extent: tuple[float, float]
) -> Iterator[Conflict]:
    """Keys of a scene whose patch, (nx, ny) cells with sides in m, does not suit its other surface."""
    if surface.kind != "file":
        yield from coarse_grid(surface, cells, extent)
        return
    (measured, sides), table = surface.patch(cells), surface.table
    if measured != cells or not _alike(sides, extent):
        asked, there = (" x ".join(f"{side:.9g} m" for side in size) for size in (extent, sides))
        words = f"it has {list(measured)} on {there} after {table}.crop and {table}.resample"
        yield f"{table}.path", f"{list(cells)} heights on {asked}, as the surface of the body; {words}"


def coarse_grid(surface: Surface, cells: tuple[int, int], extent: tuple[float, float]) -> Iterator[Conflict]:
    """Cells that are too few for the shortest waves, or a patch that is too small for one of them."""
    sides = list(zip(extent, surface.shortest, strict=True))
    fewest = [max(1, ceil(FEWEST_CELLS * side / short * (1 - CLOSE))) for side, short in sides]
    coarse = any(n < least for n, least in zip(cells, fewest, strict=True))
    small = surface.random and any(side * (1 + CLOSE) < short for side, short in sides)
    shortest = " and ".join(f"{short:g} m" for short in surface.shortest)
    waves = f"{FEWEST_CELLS} cells in the shortest wavelength of the surface"
    lengths = f"at least {shortest}, the shortest wavelengths of the surface along x and y"
    return broken((coarse, "grid.cells", f"at least {fewest}: {waves}"), (small, "grid.extent", lengths))


def patch_of(surface: Surface, grid: Grid | None) -> tuple[tuple[int, int], tuple[float, float]]:
    """(nx, ny) and (Lx, Ly) in m of the patch of a rough scene, by its file or its grid."""
    if surface.kind == "file":
        return surface.patch(grid.cells if grid is not None else None)
    grid = stated(grid)
    return stated(grid.cells), stated(grid.extent)
