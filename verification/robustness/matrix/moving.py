# SPDX-License-Identifier: MIT
"""Extremes of a counter-body that moves: hardly at all, by its own wave, too far, in broken cells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from sam.scene import HeightMap
from verification.robustness.matrix.checks import same_as
from verification.robustness.matrix.row import Absent, Expectation, Refused, Right, Row
from verification.robustness.matrix.scenes import HERTZ, scene_with
from verification.runs.models import FEM, FEM_3D, SAM

NO_PATH = Refused("no symmetry of rotation", ["loading.path", "axis of symmetry"])
SIDE, CELLS = 16e-6, 16
CELL = SIDE / CELLS
WAVE = {"kind": "sinusoid", "amplitude": 5e-8, "wavelength_x": SIDE / 2, "wavelength_y": SIDE / 2}


def way(cells: float, *, cell: float = CELL, steps: int = 1, **keys: Any) -> dict[str, Any]:
    """A path along x about the origin."""
    half = cells * cell / 2
    return {"start": (-half, 0.0), "end": (half, 0.0), "steps": steps} | keys


def over_patch(path: dict, surface: dict | None = None, **changes: Any) -> dict[str, Any]:
    """A plane with waves that slides over a smooth patch. changes: other keys, with __ for the dot."""
    counter = {"shape": "flat", "surface": surface or WAVE}
    made = {
        "counterbody": counter,
        "loading": {"force": 0.5, "path": path},
        "grid": {"cells": (CELLS, CELLS), "extent": (SIDE, SIDE), "border": "relief"},
    }
    return made | {key.replace("__", "."): value for key, value in changes.items()}


def rows() -> Iterator[Row]:
    """All of them."""
    still = {"loading.path": None}
    reason = "the same contact elsewhere on the cells; each within solver.tolerance"
    names = ("p_max_Pa", "approach_m")
    cell = 4 * HERTZ / 33
    for name, what, path, bound in (
        ("path-1e-9", "a path of 1e-9 contact radii", way(1e-9, cell=HERTZ), 1e-6),
        ("path-cells", "a path of two whole cells", way(2.0, cell=cell, steps=2), 1e-6),
    ):
        right = {SAM: Right("as in place", [same_as(still, bound, reason, names)]), FEM: NO_PATH}
        changes = {"loading.path": path, "grid.extent": (33 * cell, 33 * cell)}
        if name == "path-1e-9":
            right[FEM_3D] = Right("as in place", [same_as(still, 1e-6, "the same mesh", names)])
            changes |= COARSE
        yield Row(name, "path", what, partial(scene_with, changes), right, quick=True)
    yield from elements()
    own = Right("as half the way before", [same_as({"loading.path": HALF}, 1e-6, reason, names)])
    yield _row("path-wave", "a rough plane that slides by its own wave", over_patch(way(CELLS, steps=8)), own)
    yield from refused()


COARSE = {"fem.cells_per_radius": 4, "fem.box": 5.0}


def elements() -> Iterator[Row]:
    """Ways that the three-dimensional finite elements are asked for."""
    names = ("p_max_Pa", "approach_m", "contact_area_m2")
    forth, back = (way(sign, cell=HERTZ, steps=1) for sign in (1.0, -1.0))
    reason = "the mirror image: each within EQUILIBRIUM of the force"
    mirrored = Right("as backwards", [same_as({"loading.path": back}, 1e-6, reason, names)])
    changes = COARSE | {"loading.path": forth, "friction.coefficient": 0.3}
    what = "a way of a radius with friction, forth and back"
    expected = {SAM: mirrored, FEM: NO_PATH, FEM_3D: mirrored}
    yield Row("path-mirror", "path", what, partial(scene_with, changes), expected, quick=True)
    wide = way(4.0, cell=HERTZ, steps=8)
    still = Right(
        "as in place", [same_as({"loading.path": None}, 2e-3, "another box about each place", names)]
    )
    what = "a way of four radii in whole elements, elastic"
    made = partial(scene_with, COARSE | {"loading.path": wide})
    expected = {SAM: Absent("its cells are asked in path-cells"), FEM: NO_PATH, FEM_3D: still}
    yield Row("path-elements", "path", what, made, expected, quick=False)


HALF = {"start": (-SIDE, 0.0), "end": (0.0, 0.0), "steps": 8}
"""Another way of the same length: only the middle of the way says what is opposite."""


def _row(name: str, what: str, changes: dict, sam: Expectation, *, fem: Expectation = NO_PATH) -> Row:
    return Row(name, "path", what, partial(scene_with, changes), {SAM: sam, FEM: fem}, quick=True)


def refused() -> Iterator[Row]:
    """What does not go together, named before anything is solved."""
    short = {"kind": "file", "path": HeightMap(np.zeros((CELLS, CELLS)), (SIDE, SIDE))}
    film = {"law": "chemical-film", "low": 0.1, "high": 0.4}
    wrong: tuple[tuple[str, str, dict, list[str]], ...] = (
        ("none", "a path without length", {"loading.path": way(0.0)}, ["loading.path.end"]),
        (
            "long-step",
            "a step of three contact radii",
            {"loading.path": way(3.0, cell=HERTZ)},
            ["steps", "3 or more"],
        ),
        (
            "no-force",
            "a path without force",
            {"loading.path": way(1.0), "loading.force": 0.0},
            ["loading.force"],
        ),
        (
            "rolls",
            "rolling with friction",
            {"loading.path": way(1.0), "counterbody.slip": 0.0, "friction.coefficient": 0.2},
            ["counterbody.slip", "stick-slip"],
        ),
        (
            "broken-cells",
            "steps of 1.5 cells",
            over_patch(way(3.0, steps=2)),
            ["loading.path.steps", "divisor"],
        ),
        ("broken-way", "a way of 2.5 cells", over_patch(way(2.5, steps=1)), ["loading.path.end", "2.5"]),
        (
            "short-map",
            "a map as long as the patch",
            over_patch(way(2.0, steps=2), short),
            ["at least", "it has"],
        ),
        (
            "still-plane",
            "a smooth plane",
            over_patch(way(2.0), {}) | {"counterbody": {"shape": "flat"}},
            ["loading.path", "nothing moves"],
        ),
        (
            "coated",
            "a coated body",
            {"loading.path": way(1.0), "body.coating": {"thickness": 1e-6, "young": 1e11, "poisson": 0.3}},
            ["body.coating"],
        ),
        (
            "film",
            "a film without its limit",
            {"loading.path": way(1.0), "friction": film},
            ["friction.film_thickness"],
        ),
    )
    for name, what, changes, words in wrong:
        error = Refused("no such motion", words)
        row = _row(f"path-{name}", what, changes, error, fem=error)
        yield replace(row, expected={**row.expected, FEM_3D: error})
