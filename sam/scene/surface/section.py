# SPDX-License-Identifier: MIT
"""The table [surface] of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, inf, isclose
from typing import TYPE_CHECKING, Literal

from sam.scene.section import Conflict, Section
from sam.scene.surface.height_map import HeightMap
from sam.scene.units import Anisotropy, Hurst, Length, Seed, Share

if TYPE_CHECKING:
    from sam.scene.schema import Grid

_SELF_AFFINE = ("cutoff_long", "cutoff_short", "hurst", "seed")
KINDS = {
    "file": (("path",), ()),
    "hard-turned": (("ra", "feed", "nose_radius", "feed_share", *_SELF_AFFINE), ("anisotropy",)),
    "self-affine": (_SELF_AFFINE, ("ra", "sq", "anisotropy")),
    "sinusoid": (("amplitude",), ("wavelength_x", "wavelength_y")),
}
"""Kinds of surface, the keys that each needs, and those that it may have."""
GENERATED = tuple(kind for kind in KINDS if kind != "file")
FEWEST_CELLS = 2  # in the shortest wavelength (Nyquist)
CLOSE = 1e-6  # of a side: two sides are equal


class Surface(Section):
    """The heights of the body's surface, which is a plane without this table. Lengths in m, heights positive out of the body.

    kind "file": path, the name of a CSV or npz file in the folder of the scene, in Python a HeightMap; its grid is that of
    the scene. The others are made on any grid, see sam.scene.surface.generators. "self-affine": ra or sq, cutoff_long,
    cutoff_short, hurst, anisotropy (1 if not given), seed; "hard-turned": ra, feed, nose_radius and feed_share as well;
    "sinusoid": amplitude, wavelength_x and wavelength_y (one alone: a wave).
    """

    kind: Literal["file", "hard-turned", "self-affine", "sinusoid"]
    path: HeightMap | None = None
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

    @property
    def random(self) -> bool:
        """Whether a seed decides on it."""
        return self.seed is not None

    @property
    def shortest(self) -> tuple[float, float]:
        """Shortest wavelength along x and along y in m; infinite where the heights do not vary. Not for a file."""
        if self.kind == "sinusoid":
            return self.wavelength_x or inf, self.wavelength_y or inf
        return self.cutoff_short, self.cutoff_short * self.anisotropy

    @classmethod
    def implied(cls, given: Mapping) -> Mapping:
        return {"anisotropy": 1.0} if given.get("kind") in ("hard-turned", "self-affine") else {}

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        kind = given.get("kind")
        needed, optional = KINDS.get(kind, (None, ())) if isinstance(kind, str) else (None, ())
        if needed is None:
            return
        for key in cls.model_fields:
            if key in needed and key not in given:
                yield key, f'required: kind = "{kind}" takes {", ".join(needed)}'
            if key not in ("kind", *needed, *optional) and key in given:
                yield key, f'kind = "{kind}" takes {", ".join((*needed, *optional))}: remove it'
        if kind == "self-affine" and ("ra" in given) == ("sq" in given):
            yield ("sq", "either ra or sq, not both") if "ra" in given else ("ra", "required: ra or sq")
        if kind == "sinusoid" and not {"wavelength_x", "wavelength_y"} & set(given):
            yield "wavelength_x", "required: wavelength_x, wavelength_y, or both"

    def excesses(self) -> Iterator[Conflict]:
        if self.random and not self.cutoff_short < self.cutoff_long:
            yield "cutoff_short", f"less than cutoff_long, {self.cutoff_long:g} m"
        if self.feed is not None and not self.feed >= self.cutoff_short:
            yield "feed", f"at least cutoff_short, {self.cutoff_short:g} m: shorter waves are left out"


def grid_excesses(surface: Surface, grid: Grid | None) -> Iterator[Conflict]:
    """Keys of a scene whose grid does not suit its surface."""
    yield from (_other_grid if surface.kind == "file" else _coarse_grid)(surface, grid)


def _other_grid(surface: Surface, grid: Grid | None) -> Iterator[Conflict]:
    """A grid that is not the one of the file."""
    if grid is None:
        return
    found, words = surface.path, "the grid of surface.path (nothing is resampled): leave it out"
    if grid.cells is not None and grid.cells != found.cells:
        yield "grid.cells", f"{list(found.cells)}, {words}"
    if grid.extent is not None and not all(
        isclose(*sides, rel_tol=CLOSE) for sides in zip(grid.extent, found.extent, strict=True)
    ):
        yield "grid.extent", f"{' and '.join(f'{side:.9g} m' for side in found.extent)}, {words}"


def _coarse_grid(surface: Surface, grid: Grid) -> Iterator[Conflict]:
    """Cells that are too few for the shortest waves, or a patch that is too small for one of them."""
    fewest = [ceil(FEWEST_CELLS * side / short * (1 - CLOSE)) for side, short in zip(grid.extent, surface.shortest, strict=True)]
    if any(n < least for n, least in zip(grid.cells, fewest, strict=True)):
        yield "grid.cells", f"at least {fewest}: {FEWEST_CELLS} cells in the shortest wavelength of the surface"
    if surface.random and any(side * (1 + CLOSE) < short for side, short in zip(grid.extent, surface.shortest, strict=True)):
        shortest = " and ".join(f"{short:g} m" for short in surface.shortest)
        yield "grid.extent", f"at least {shortest}, the shortest wavelengths of the surface along x and y"
