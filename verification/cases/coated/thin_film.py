# SPDX-License-Identifier: MIT
"""A film of 100 nm on cells ten times as large and ten times as small: nothing overflows, nothing repeats
itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.kernels import Lags
from sam.layered import LayeredPatches, Layers
from sam.scene import Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, SmallTable, with_grid
from verification.cases.coated.film_limits import YOUNG, paper_film, sphere_scene
from verification.cases.coated.film_map import Changes, of_result, of_spectral, percent
from verification.runs.sampling import pressure_map

PARTS = 101
"""Cells of 9.9 nm in a cell of 1 um, along each side; odd, so that they have its centre."""
LAGS = ((0, 0), (1, 0), (1, 1), (4, 2), (20, 1), (60, 0))
"""In cells of 1 um."""


@dataclass(frozen=True)
class FilmPatch:
    """A sphere on the film of the paper on one grid. cell, radius: contact radius without film, in m; cells:
    a side.
    """

    name: str
    cell: float
    cells: int
    radius: float

    def scene(self, base: Scene, cells: int | None = None) -> Scene:
        """The sphere on this grid."""
        film, count = paper_film(), cells or self.cells
        depths = (0.0, 0.5 * film.thickness, *(film.thickness + self.radius * np.linspace(0.0, 1.0, 21)))
        scene = sphere_scene(base, film, self.radius, "rigid")
        return with_grid(scene, cells=(count, count), extent=(count * self.cell,) * 2, depths=depths)


PATCHES = (FilmPatch("coarse", 1e-6, 65, 8e-6), FilmPatch("fine", 10e-9, 251, 0.8e-6))
"""Patches of 65 um and 2.5 um, eight and eighty cells in the contact radius."""


@dataclass(frozen=True)
class SolvedPatch:
    """A patch, also on a wider patch with the same cells."""

    patch: FilmPatch
    result: Result
    wider: Result
    spectral: Changes

    def error(self, name: str) -> float:
        """Distance of SAM from the spectral solution."""
        return abs(getattr(of_result(self.result), name) - getattr(self.spectral, name))

    @property
    def alias(self) -> float:
        """Largest change of the pressure by the wider patch, over the largest pressure: 0 if nothing repeats
        itself.
        """
        near, far = (pressure_map(result)[2] for result in (self.result, self.wider))
        off = (np.array(far.shape) - near.shape) // 2
        part = far[off[0] : off[0] + near.shape[0], off[1] : off[1] + near.shape[1]]
        return float(np.abs(part - near).max() / near.max())


def unfinished(result: Result) -> int:
    """How many numbers of the fields are not finite."""
    values = [
        np.asarray(result.tables[table][name], dtype=float)
        for table, names in {
            "axis": ("mises_Pa", "sxx_Pa", "szz_Pa"),
            "line": ("p_Pa", "uz_m", "gap_m"),
            "plane": ("mises_Pa",),
        }.items()
        for name in names
    ]
    values.append(pressure_map(result)[2])
    return sum(int(np.size(v) - np.isfinite(v).sum()) for v in values)


def error_of_parts(kind: str) -> float:
    """Largest distance of a coefficient of a 1 um cell from the sum over its 9.9 nm parts, over the largest
    coefficient.

    kind: "displacement", or "stress": s_zz at the interface.
    """
    film, body = paper_film(), (210e9, 0.3)
    patches = LayeredPatches(Layers(film.young, film.poisson, film.thickness, *body))

    def coefficients(nx: int, ny: int, cell: float) -> np.ndarray:
        if kind == "displacement":
            return patches.displacement(Lags(nx, ny, cell, cell))
        return patches.stress(Lags(nx, ny, cell, cell), [film.thickness], load=3, names=["33"])[0, 0]

    most = np.array(LAGS).max(axis=0)
    coarse = coefficients(*(most + 1), 1e-6)
    fine = coefficients(*((most + 1) * PARTS), 1e-6 / PARTS)
    offset = np.arange(PARTS) - PARTS // 2
    sums = [fine[np.ix_(np.abs(i * PARTS + offset), np.abs(j * PARTS + offset))].sum() for i, j in LAGS]
    whole = np.array([coarse[i, j] for i, j in LAGS])
    return float(np.abs(np.array(sums) - whole).max() / np.abs(coarse).max())


class ThinFilmGrids(Case):
    """Both grids solved, also on wider patches, and the coefficients of both grids against each other."""

    def solve(self, context: Context) -> list[SolvedPatch]:
        base, film = context.scene("coated-sphere"), paper_film()
        found = []
        for patch in PATCHES:
            wider = patch.cells + 2 * (patch.cells // 4)
            results = (
                context.solve(SAM, patch.scene(base, cells), f"{patch.name}{word}")
                for cells, word in ((patch.cells, ""), (wider, "-wider"))
            )
            at = film.young / base.body.young, film.thickness / patch.radius
            found.append(SolvedPatch(patch, *results, of_spectral(*at, "rigid")))
        return found

    def measure(self, found: list[SolvedPatch]) -> dict[str, Measured | float]:
        numbers = sum(unfinished(result) for each in found for result in (each.result, each.wider))
        return {
            "alias": max(each.alias for each in found),
            "parts-displacement": error_of_parts("displacement"),
            "parts-stress": error_of_parts("stress"),
            "unfinished": Measured(numbers, 0),
            **{f"{each.patch.name}-{name}": each.error(name) for each in found for name in ("p", "mises")},
        }

    def setup(self, found: list[SolvedPatch]) -> list[tuple[str, str]]:
        film = paper_film()
        body = f"{YOUNG / 1e9:g} GPa"
        lags = ", ".join(map(str, LAGS))
        return [
            ("Film", f"{film.thickness * 1e9:g} nm, {film.young / 1e9:g} GPa, on {body}"),
            ("Sphere", "rigid, 6.5 GPa without film"),
            ("Parts of a cell", f"{PARTS} × {PARTS} of 9.9 nm in 1 µm, at lags of {lags} µm"),
        ]

    def tables(self, found: list[SolvedPatch]) -> Iterator[SmallTable]:
        rows = []
        for each in found:
            patch, ours = each.patch, of_result(each.result)
            sizes = f"{patch.cells} × {patch.cells} of {patch.cell * 1e9:g} nm", f"{patch.radius * 1e6:g} µm"
            values = (ours.p, each.spectral.p, ours.mises, each.spectral.mises)
            rows.append((*sizes, *map(percent, values), f"{each.alias:.1e}"))
        yield SmallTable(
            ("Changes by the film, and of the pressure by a patch of one and a half times the extent"),
            (
                *(
                    "cells",
                    "contact radius",
                    "p_max, SAM [%]",
                    "spectral [%]",
                    "σvM, SAM [%]",
                    "spectral [%]",
                ),
                "change of p by the wider patch",
            ),
            rows,
        )


CASES = (ThinFilmGrids("thin-film-grids"),)
