# SPDX-License-Identifier: MIT
"""A film of 100 nm on cells ten times as large and ten times as small: nothing overflows, nothing repeats itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.kernels.lags import Lags
from sam.layered.patches import LayeredPatches
from sam.layered.response import Layers
from sam.scene import Result, Scene
from verification.figures.views import pressure_map
from verification.runs.models import SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_grid
from verification.suite.cases.film_limits import paper_film, sphere_scene
from verification.suite.cases.film_map import Changes, of_result, of_spectral, percent
from verification.suite.gates import Measured

PARTS = 101
"""Cells of 9.9 nm in a cell of 1 um, along each side; odd, so that they have its centre."""
LAGS = ((0, 0), (1, 0), (1, 1), (4, 2), (20, 1), (60, 0))
"""In cells of 1 um."""


@dataclass(frozen=True)
class Patch:
    """A sphere on the film of the paper on one grid. cell, radius: contact radius without film, in m; cells: a side."""

    name: str
    cell: float
    cells: int
    radius: float

    def scene(self, base: Scene, cells: int | None = None) -> Scene:
        film, count = paper_film(), cells or self.cells
        depths = (0.0, 0.5 * film.thickness, *(film.thickness + self.radius * np.linspace(0.0, 1.0, 21)))
        scene = sphere_scene(base, film, self.radius, "rigid")
        return with_grid(scene, cells=(count, count), extent=(count * self.cell,) * 2, depths=depths)


PATCHES = (Patch("coarse", 1e-6, 65, 8e-6), Patch("fine", 10e-9, 251, 0.8e-6))
"""Patches of 65 um and 2.5 um, eight and eighty cells in the contact radius."""


@dataclass(frozen=True)
class Solved:
    """A patch, also on a wider patch with the same cells."""

    patch: Patch
    result: Result
    wider: Result
    spectral: Changes

    def error(self, name: str) -> float:
        return abs(getattr(of_result(self.result), name) - getattr(self.spectral, name))

    @property
    def alias(self) -> float:
        """Largest change of the pressure by the wider patch, over the largest pressure: 0 if nothing repeats itself."""
        near, far = (pressure_map(result)[2] for result in (self.result, self.wider))
        off = (np.array(far.shape) - near.shape) // 2
        part = far[off[0] : off[0] + near.shape[0], off[1] : off[1] + near.shape[1]]
        return float(np.abs(part - near).max() / near.max())


def unfinished(result: Result) -> int:
    """How many numbers of the fields are not finite."""
    columns = {
        "axis": ("mises_Pa", "sxx_Pa", "szz_Pa"),
        "line": ("p_Pa", "uz_m", "gap_m"),
        "plane": ("mises_Pa",),
    }
    values = [
        np.asarray(result.tables[table][name], dtype=float)
        for table, names in columns.items()
        for name in names
    ]
    values.append(pressure_map(result)[2])
    return sum(int(np.size(v) - np.isfinite(v).sum()) for v in values)


def error_of_parts(kind: str) -> float:
    """Largest distance of a coefficient of a 1 um cell from the sum over its 9.9 nm parts, over the largest coefficient.

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


def solve(context: Context, base: Scene, patch: Patch) -> Solved:
    results = [
        context.solve(SAM, patch.scene(base, cells), f"{patch.name}{word}")
        for cells, word in ((patch.cells, ""), (patch.cells + 2 * (patch.cells // 4), "-wider"))
    ]
    film = paper_film()
    return Solved(
        patch, *results, of_spectral(film.young / base.body.young, film.thickness / patch.radius, "rigid")
    )


def run(context: Context) -> Outcome:
    """Both grids solved, also on wider patches, and the coefficients of both grids against each other."""
    base = context.scene("coated-sphere")
    solved = [solve(context, base, patch) for patch in PATCHES]
    values = {
        "alias": max(each.alias for each in solved),
        "parts-displacement": error_of_parts("displacement"),
        "parts-stress": error_of_parts("stress"),
    }
    for each in solved:
        values |= {f"{each.patch.name}-{name}": each.error(name) for name in ("p", "mises")}
    outcome = Outcome({f"{context.case}.{name}": Measured(value) for name, value in values.items()})
    count = sum(unfinished(result) for each in solved for result in (each.result, each.wider))
    outcome.values[f"{context.case}.unfinished"] = Measured(count, 0)
    outcome.setup = [
        (
            "Film",
            f"{paper_film().thickness * 1e9:g} nm, {paper_film().young / 1e9:g} GPa, on {base.body.young / 1e9:g} GPa",
        ),
        ("Sphere", "rigid, 6.5 GPa without film"),
        (
            "Parts of a cell",
            f"{PARTS} × {PARTS} of 9.9 nm in 1 µm, at lags of {', '.join(map(str, LAGS))} µm",
        ),
    ]
    outcome.tables = [table(solved)]
    return outcome


def table(solved: list[Solved]) -> SmallTable:
    rows = []
    for each in solved:
        patch, ours = each.patch, of_result(each.result)
        sizes = f"{patch.cells} × {patch.cells} of {patch.cell * 1e9:g} nm", f"{patch.radius * 1e6:g} µm"
        pairs = ((ours.p, each.spectral.p), (ours.mises, each.spectral.mises))
        rows.append((*sizes, *(percent(value) for pair in pairs for value in pair), f"{each.alias:.1e}"))
    columns = (
        *("cells", "contact radius", "p_max, SAM [%]", "spectral [%]", "σvM, SAM [%]", "spectral [%]"),
        "change of p by the wider patch",
    )
    return SmallTable(
        "Changes by the film, and of the pressure by a patch of one and a half times the extent",
        columns,
        rows,
    )


CASES = (
    Case(
        "thin-film-grids",
        "Thin film on coarse and fine cells",
        "Are the coefficients and the answer right for a film of a tenth of a cell, and of ten cells?",
        run,
        (
            ("Superposition", "a cell is the sum of its parts, at any ratio of cell and film", "linearity"),
            (
                "No images",
                "the pressure does not depend on the extent of the patch",
                "coefficients without period",
            ),
            (
                "Spectral solution",
                "χ(t) + (2/π)∫ g P cos kt dk = (E/π)(δ − t²/R)",
                "O'Sullivan & King, J. Tribol. 110 (1988) 235; see coated-sphere",
            ),
        ),
    ),
)
