# SPDX-License-Identifier: MIT
"""What a film changes under a sphere: a map, contact radii at which it matters, and thin films."""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from sam.kernels import Lags
from sam.layered import LayeredPatches, Layers
from sam.scene import Result, Scene
from verification.cases.case import FEM, SAM, Context, DataFrame, Plot, with_grid, with_mesh
from verification.cases.recipes import coated_scene, film_under
from verification.figures.specials import change_maps
from verification.reference.coated_changes import (
    breaking_thickness,
    film_contact,
    mises_change,
    pressure_change,
)
from verification.references import changes_by_film, contact_of
from verification.rows import CaseFile
from verification.runs import models
from verification.runs.sampling import pressure_map

__all__ = ["at_limits", "changes_of_paper"]

SCENE, QUICK_MESH = "coated-sphere", 16
PAPER_RATIO, PAPER_FILM, FILM_YIELD = 80 / 210, 100e-9, 0.67e9
"""E1/E2, thickness in m and yield stress of the film in Pa: Bosman & Schipper (2011), Table 1, Fig. 3."""
COUNTER = {"rigid": math.inf, "steel": 1.0}
"""Contact modulus of the counter-body over the body's."""
CHANGES = {"p": pressure_change, "mises": mises_change}
WORDS = {"p": "Largest pressure", "mises": "Largest von Mises stress of the body"}
BOTH = {"sam": SAM, "fem": FEM}


def changes_of(result: Result) -> dict[str, float]:
    """By the film, as shares of the values without it. RuntimeError without convergence or such values."""
    found = {name: result.quantities[f"{name}_max_change"] for name in CHANGES}
    if not result.converged or None in found.values():
        said = " ".join((result.message, *result.warnings))
        raise RuntimeError(f"{result.model} ended {result.status}: {said}")
    return found


# --- map ------------------------------------------------------------------------------------------------

SIDES = {"quick": (2, (0.02, 1.0), (0.2, 5.0)), "full": (13, (0.01, 2.0), (0.1, 10.0))}
"""Points along each side, thickness over the contact radius without film, and E1/E2, of the map."""
CELLS = 65
"""A side: 8 to 26 of them in the smaller of the contact radii with and without film."""
DEPTHS = 0.05 * np.arange(27)
"""Output depths below the interface, over the contact radius without film."""
RADII = (0.5e-6, 1e-6, 2e-6, 5e-6)
"""Contact radii in m at which the film of the paper is marked."""
POINTS = (
    *((PAPER_RATIO, 0.02, "rigid"), (PAPER_RATIO, 0.2, "steel"), (PAPER_RATIO, 0.065, "rigid")),
    *((PAPER_RATIO, 0.13, "steel"), (0.1, 0.05, "rigid"), (0.1, 0.5, "steel"), (0.2, 1.0, "rigid")),
    *((0.6, 2.0, "steel"), (2.0, 0.05, "steel"), (2.0, 0.5, "rigid"), (4.0, 0.1, "rigid")),
    *((4.0, 1.0, "steel"), (10.0, 0.02, "steel"), (10.0, 0.3, "rigid")),
)
"""(E1/E2, thickness, counter-body) solved by FEM too; the first two at the quick level, coarser."""


def map_scene(base: Scene, ratio: float, thickness: float, counterbody: str) -> Scene:
    """The sphere of `base` on a film, with few cells and depths; thickness over a0 without film."""
    scene = coated_scene(base, ratio, thickness, counterbody)
    below = scene.body.coating.thickness + DEPTHS * contact_of(scene).contact_radius
    return with_grid(scene, cells=(CELLS, CELLS), depths=(0.0, *below))


def mapped(context: Context) -> Iterator[dict[str, Any]]:
    """The maps under both counter-bodies against the spectral solution, and a few points by both models."""
    base, quick = context.scene(SCENE), context.level == "quick"
    base = with_mesh(base, QUICK_MESH) if quick else base
    (count, *ends), done = SIDES[context.level], 0
    sides = [np.geomspace(*each, count) for each in ends]
    grid = [(float(ratio), float(h), other) for other, h, ratio in product(COUNTER, *sides)]
    for sweep, films in (("both models", POINTS[:2] if quick else POINTS), ("map", grid)):
        for ratio, thickness, other in films:
            scene = map_scene(base, ratio, thickness, other)
            row = {"sweep": sweep, "ratio": ratio, "thickness": thickness, "counterbody": other}
            if sweep == "map":
                sam, against = changes_of(models.solve(scene, SAM)), "spectral"
                contact = film_contact(thickness, ratio, counter=COUNTER[other])
                exact = {name: change(contact) for name, change in CHANGES.items()}
                context.progress(f"{context.case}: films", done := done + 1, len(grid))
            else:
                label, against = f"{ratio:.3g}-{thickness:g}-{other}".replace(".", "-"), "fem"
                sam, exact = (
                    changes_of(context.solve(m, scene, f"{name}-{label}")) for name, m in BOTH.items()
                )
            for name in CHANGES:
                row |= {f"{name} sam": sam[name], f"{name} {against}": exact[name]}
                row[f"{name}-off-{against}"] = abs(sam[name] - exact[name])
            yield row


def changes_of_paper(file: CaseFile, frame: DataFrame) -> Plot | None:
    """Heat maps under a rigid counter-body."""
    own = frame[(frame["sweep"] == "map") & (frame["counterbody"] == "rigid")]
    if own["thickness"].nunique() < 4:  # too few for a map
        return None
    panels = {
        WORDS[name]: own.pivot(index="thickness", columns="ratio", values=f"{name} sam") for name in CHANGES
    }
    words = (
        "The maps show by how much a film changes the largest pressure and the largest von Mises stress of "
        "the body by SAM, at equal force under a rigid sphere. The film of the paper, 100 nm of 80 GPa on "
        "steel, is green at contact radii of 0.5 to 5 µm."
    )
    drawing = change_maps(panels, (PAPER_RATIO, {f"{1e6 * a:g} µm": PAPER_FILM / a for a in RADII}))
    return Plot(drawing, "rigid", "What a film changes, rigid counter-body", words)


# --- limits ---------------------------------------------------------------------------------------------

LIMITS = (0.05, 0.01)
OWN_RADII = {"quick": (1e-6,), "full": (5e-6, 2e-6, 1e-6, 0.5e-6)}
"""Contact radii in m at which the stress of the film itself is looked at."""


def at_limits(context: Context) -> Iterator[dict[str, Any]]:
    """The contact radius at which the film breaks the claim, both models there, and the film at 6.5 GPa."""
    base, quick = context.scene(SCENE), context.level == "quick"
    base = with_mesh(base, QUICK_MESH) if quick else base
    for other, limit, name in product(COUNTER, LIMITS[: 1 if quick else 2], ("p",) if quick else CHANGES):
        how = {"counter": COUNTER[other], "limit": limit, "change": CHANGES[name]}
        radius = PAPER_FILM / breaking_thickness(PAPER_RATIO, **how)
        scene = film_under(base, (other, radius, PAPER_FILM, PAPER_RATIO))
        row = {"sweep": "limits", "counterbody": other, "of": name, "limit": limit}
        row["radius [µm]"] = 1e6 * radius
        for model in BOTH:
            label = f"{model}-{other}-{name}-{100 * limit:g}"
            found = changes_of(context.solve(BOTH[model], scene, label))[name]
            row |= {f"change, {model}": found, f"off-{model}": abs(abs(found) - limit)}
        yield row
    for other, a in product(COUNTER, OWN_RADII[context.level]):
        label = f"sam-{other}-{1e6 * a:g}um".replace(".", "-")
        result = context.solve(SAM, film_under(base, (other, a, PAPER_FILM, PAPER_RATIO)), label)
        stress = result.quantities["mises_max_film_Pa"]
        row = {"sweep": "stress of the film", "counterbody": other, "radius [µm]": 1e6 * a}
        row |= {f"change of {name}": value for name, value in changes_of(result).items()}
        yield row | {"von Mises stress [GPa]": 1e-9 * stress, "over its yield stress": stress / FILM_YIELD}


# --- coarse and fine cells ------------------------------------------------------------------------------

PATCHES = {"coarse": (1e-6, 65, 8e-6), "fine": (10e-9, 251, 0.8e-6)}
"""Size of a cell in m, cells a side, contact radius without film in m: patches of 65 um and 2.5 um."""
PARTS = 101
"""Cells of 9.9 nm in a cell of 1 um, along each side; odd, so that they have its centre."""
LAGS = ((0, 0), (1, 0), (1, 1), (4, 2), (20, 1), (60, 0))
"""In cells of 1 um."""
FIELDS = {"axis": ("mises_Pa", "sxx_Pa", "szz_Pa"), "line": ("p_Pa", "uz_m", "gap_m"), "plane": ("mises_Pa",)}


def patch_scene(base: Scene, cell: float, cells: int, radius: float) -> Scene:
    """A rigid sphere on the film of the paper on one grid."""
    scene = film_under(base, ("rigid", radius, PAPER_FILM, PAPER_RATIO))
    depths = (0.0, 0.5 * PAPER_FILM, *(PAPER_FILM + radius * np.linspace(0.0, 1.0, 21)))
    return with_grid(scene, cells=(cells, cells), extent=(cells * cell,) * 2, depths=depths)


def alias(result: Result, wider: Result) -> float:
    """Largest change of the pressure by a wider patch over the largest pressure: 0 without images."""
    near, far = (pressure_map(each)[2] for each in (result, wider))
    x, y = (np.array(far.shape) - near.shape) // 2
    return float(np.abs(far[x : x + near.shape[0], y : y + near.shape[1]] - near).max() / near.max())


def unfinished(result: Result) -> int:
    """How many numbers of the fields are not finite."""
    values = [np.asarray(result.tables[t][name], float) for t, names in FIELDS.items() for name in names]
    return sum(int(np.size(v) - np.isfinite(v).sum()) for v in (*values, pressure_map(result)[2]))


def error_of_parts(kind: str) -> float:
    """Largest distance of a coefficient of a 1 um cell from the sum over its 9.9 nm parts, over the largest
    coefficient. kind: "displacement", or "stress": s_zz at the interface.
    """
    patches = LayeredPatches(Layers(PAPER_RATIO * 210e9, 0.3, PAPER_FILM, 210e9, 0.3))

    def coefficients(nx: int, ny: int, cell: float) -> np.ndarray:
        if kind == "displacement":
            return patches.displacement(Lags(nx, ny, cell, cell))
        return patches.stress(Lags(nx, ny, cell, cell), [PAPER_FILM], load=3, names=["33"])[0, 0]

    most = np.array(LAGS).max(axis=0)
    coarse = coefficients(*(most + 1), 1e-6)
    fine = coefficients(*((most + 1) * PARTS), 1e-6 / PARTS)
    offset = np.arange(PARTS) - PARTS // 2
    sums = [fine[np.ix_(np.abs(i * PARTS + offset), np.abs(j * PARTS + offset))].sum() for i, j in LAGS]
    whole = np.array([coarse[i, j] for i, j in LAGS])
    return float(np.abs(np.array(sums) - whole).max() / np.abs(coarse).max())


def grids(context: Context) -> Iterator[dict[str, Any]]:
    """Both grids solved, also on wider patches, and the coefficients of both grids against each other."""
    base = context.scene(SCENE)
    for name, (cell, cells, radius) in PATCHES.items():
        patches = {name: cells, f"{name}-wider": cells + 2 * (cells // 4)}
        scenes = {label: patch_scene(base, cell, n, radius) for label, n in patches.items()}
        both = [context.solve(SAM, scene, label) for label, scene in scenes.items()]
        row = {"sweep": "grids", "cells": name, "alias": alias(*both)}
        pairs = zip(changes_of(both[0]).items(), changes_by_film(scenes[name]), strict=True)
        row |= {change: abs(found - exact) for (change, found), exact in pairs}
        yield row | {"unfinished": sum(map(unfinished, both))}
    yield {"sweep": "parts"} | {kind: error_of_parts(kind) for kind in ("displacement", "stress")}
