# SPDX-License-Identifier: MIT
"""Extremes of the surface: constant, a step, a ridge along the border, a spike, waves, and what is no
height.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from math import pi, sqrt

import numpy as np

from sam.scene import HeightMap, Result, Scene, Status
from verification.robustness.matrix.checks import balanced, modulus_of, relative
from verification.robustness.matrix.row import Deviation, Expectation, Refused, Right, Row, Trial
from verification.robustness.matrix.scenes import other, scene_with
from verification.runs.models import FEM, SAM

SIDE, CELLS, HIGH = 32e-6, 32, 1e-6  # of the patch in m; of what stands out of it
# compliance of a square punch over that of a disc of its area, inverse: King, Int. J. Solids Struct. 23
# (1987) 1657
KING = 1.012
SAME_SUM = "the same gap, rounded differently"
SAME = "the cells beside are not touched: one discrete problem"
NO_COUNTER = Refused("no symmetry of rotation", ["counterbody.surface.kind"])
NO_ROUGH = Refused("no symmetry of rotation", ["surface.kind", "remove [surface]"])
Check = Callable[[Trial], Iterator[Deviation]]


def patch(heights: np.ndarray, side: float = SIDE, **loading: float) -> Scene:
    """A plane pressed on heights, (nx, ny) in m on cells of the size of the whole patch's."""
    nx, ny = heights.shape
    extent = side * nx / CELLS, side * ny / CELLS
    changes = {
        "counterbody": {"shape": "flat"}, "grid": None, "loading": {"force": 1.0} | loading,
        "surface": {"kind": "file", "path": HeightMap(heights, extent)},
    }  # fmt: skip
    return scene_with(changes)


def plain(nx: int = CELLS, ny: int = CELLS) -> np.ndarray:
    """Heights of nothing, (nx, ny)."""
    return np.zeros((nx, ny))


def raised(where: tuple, height: float = HIGH) -> np.ndarray:
    """A plane with some cells higher, (nx, ny) in m."""
    heights = plain()
    heights[where] = height
    return heights


def waves(amplitude: float) -> np.ndarray:
    """One cosine in x, (nx, ny) in m."""
    x = (np.arange(CELLS) + 0.5) / CELLS
    return amplitude * np.cos(2 * pi * x)[:, None] * np.ones(CELLS)


def square_punch(trial: Trial) -> Iterator[Deviation]:
    """A square pressed by a plane: F = 2 beta E* sqrt(A/pi) approach (King 1987)."""
    scene = trial.scene
    expected = scene.loading.force / (2 * KING * modulus_of(scene) * SIDE / sqrt(pi))
    yield relative(
        "approach, square punch",
        trial.quantities["approach_m"],
        expected,
        0.005,
        reason="32 cells along the side",
    )


def whole(result: Result) -> dict[str, float]:
    """Approach, and the largest pressure and the cells in contact of the whole patch (maxima leave its border
    out).
    """
    pressure = np.asarray(result.fields.cell_data["p_Pa"])
    touching = float(np.count_nonzero(pressure > 0))
    return {
        "approach": result.quantities["approach_m"],
        "largest pressure": np.nanmax(pressure),
        "cells in contact": touching,
    }


def as_patch(heights: np.ndarray) -> Check:
    """The same pressure and approach as of a smaller patch that holds all that touches."""

    def check(trial: Trial) -> Iterator[Deviation]:
        twin = trial.bench.converged(patch(heights, force=trial.scene.loading.force), trial.model)
        expected = whole(twin)
        for name, value in whole(trial.result).items():
            yield relative(f"{name}, the part alone", value, expected[name], 1e-6, reason=SAME)

    return check


def mirrored(trial: Trial) -> Iterator[Deviation]:
    """The same quantities with the surface turned over in x."""
    path = trial.scene.surface.path
    turned = other(trial.scene, {"surface.path": HeightMap(path.values[::-1], path.extent)})
    twin = trial.bench.converged(turned, trial.model)
    expected = whole(twin)
    for name, value in whole(trial.result).items():
        yield relative(f"{name}, mirrored in x", value, expected[name], 1e-6, reason="a reflection")


def warned(trial: Trial) -> Iterator[Deviation]:
    """Contact at the border of a patch is said."""
    said = any("border" in text or "edge" in text for text in trial.result.warnings)
    yield Deviation("no warning of the border", float(not said), 0.5, "a patch is cut out of a surface")


def all_touch(trial: Trial) -> Iterator[Deviation]:
    """Every cell is in contact; then the problem is linear: equal increments of the force, equal ones of the
    approach.
    """
    force, found = trial.scene.loading.force, [trial.quantities["approach_m"]]
    yield Deviation(
        "cells that do not touch", CELLS**2 - trial.result.discretisation["contact_cells"], 0.5, "all do"
    )
    for factor in (1.25, 1.5):
        twin = trial.bench.converged(other(trial.scene, {"loading.force": factor * force}), trial.model)
        found.append(twin.quantities["approach_m"])
    first, second = np.diff(found)
    yield relative("increment of the approach", second, first, 1e-6, reason="all cells touch: linear")


def rows() -> Iterator[Row]:
    """All of them."""
    checks, high = [square_punch, balanced, warned], np.full((CELLS, CELLS), 1e-3)
    yield of_sam(
        "constant", "constant", "constant heights: a square punch", plain(), checks=checks, quick=True
    )
    yield of_sam("constant-1mm", "constant", "constant heights, 1 mm up", high, checks=checks)
    step, ridge = raised(np.s_[: CELLS // 2]), raised(np.s_[:4])
    checks = [as_patch(plain(CELLS // 2)), mirrored, balanced]
    yield of_sam(
        "step",
        "step",
        "half of the patch 1 um higher: only it touches",
        step,
        checks=checks,
        force=1.0,
        quick=True,
    )
    checks = [as_patch(plain(4)), mirrored, balanced, warned]
    yield of_sam(
        "ridge", "ridge", "a ridge of 4 cells along the border", ridge, checks=checks, force=0.2, quick=True
    )
    few = Refused("one cell says nothing of the pressure on it", ["grid.cells"], Status.UNDER_RESOLVED)
    spike = raised(np.s_[CELLS // 2, CELLS // 2])
    yield _row(
        "spike",
        "spike",
        "one cell 1 um higher: it alone touches",
        partial(patch, spike, force=1e-3),
        expected=few,
        quick=True,
    )
    yield of_sam(
        "spike-pressed",
        "spike",
        "the same, pressed until its surroundings touch",
        spike,
        checks=[mirrored, balanced],
    )
    checks = [all_touch, balanced, warned]
    yield of_sam(
        "closed", "all cells", "a wave pressed flat: all cells touch", waves(1e-8), checks=checks, force=160.0
    )
    yield from opposite()
    yield from refused()


def opposite() -> Iterator[Row]:
    """Heights on the counter-body: as good as on the body, whose sum alone counts."""
    cases = {
        "constant": (plain(), None, plain(), "no heights on it", True),
        "constant-1mm": (plain() + 1e-3, None, plain(), "1 mm of constant heights on it", False),
        "upside-down": (waves(2e-8), None, waves(2e-8), "a wave on it, upside down on the body", True),
        "image": (waves(2e-8), waves(-2e-8), plain(), "a wave on it in its image on the body", False),
        "crests": (waves(1e-8), waves(1e-8), waves(2e-8), "equal waves on both, crest on crest", False),
    }
    for name, (heights, own, total, what, quick) in cases.items():
        expected = Right("the gap knows only the sum of the heights", [as_sum(total), balanced])
        make = partial(_opposite, heights, own)
        refusal = NO_COUNTER if own is None else NO_ROUGH
        answers = {SAM: expected, FEM: refusal}
        yield Row(f"counter-{name}", "counter-surface", what, make, answers, quick)
    whole_map = Refused("no second part", ["counterbody.surface.renew", "no second part"])
    make = partial(_opposite, waves(1e-8), None, renew=True)
    last = Right("the second cycle meets the second part of the map alone", [as_sum(waves(2e-8)), balanced])
    what = "renewed from a map of two parts, a plane and a wave"
    yield Row("counter-renewed", "counter-surface", what, _renewed, {SAM: last, FEM: NO_COUNTER}, quick=True)
    what = "renewed from a map that holds one patch"
    yield Row("counter-one-part", "counter-surface", what, make, {SAM: whole_map, FEM: whole_map})


def _opposite(heights: np.ndarray, own: np.ndarray | None, *, renew: bool = False) -> Scene:
    """A plane with heights pressed on a smooth body, or on one with heights of its own."""
    table = {"kind": "file", "path": HeightMap(heights, (SIDE, SIDE)), "renew": renew}
    surface = None if own is None else {"kind": "file", "path": HeightMap(own, (SIDE, SIDE))}
    changes = {"counterbody": {"shape": "flat", "surface": table}, "surface": surface, "grid": None}
    return scene_with(changes | {"loading": {"force": 1.0}})


def _renewed() -> Scene:
    """A plane of two parts pressed on a smooth body, the second in the second cycle."""
    parts = HeightMap(np.concatenate([plain(), waves(2e-8)]), (2 * SIDE, SIDE))
    first = (-SIDE / 2, 0.0, SIDE, SIDE)
    table = {"kind": "file", "path": parts, "crop": first, "renew": True}
    changes = {"counterbody": {"shape": "flat", "surface": table}, "grid": None}
    return scene_with(changes | {"loading": {"force": 1.0, "unload": True, "cycles": 2}})


def as_sum(total: np.ndarray) -> Check:
    """The same pressure and approach as of the sum of the heights on the body under a plane."""

    def check(trial: Trial) -> Iterator[Deviation]:
        twin = trial.bench.converged(patch(total), trial.model)
        expected = whole(twin)
        for name, value in whole(trial.result).items():
            yield relative(f"{name}, heights on the body", value, expected[name], 1e-6, reason=SAME_SUM)

    return check


def refused() -> Iterator[Row]:
    """What is no height, and a grid that the surface does not fit on."""
    hole = raised(np.s_[3, 3], np.nan)
    missing = Refused(
        "a height that is not there", ["surface.path", "1 of 1024 heights are missing", "surface.missing"]
    )
    yield Row(
        "nan",
        "nan",
        "one height is not a number",
        partial(patch, hole),
        {SAM: missing, FEM: missing},
        quick=True,
    )
    checks = [square_punch, balanced]
    filled = partial(_filled, hole)
    right = {SAM: Right("filled from its neighbours", checks), FEM: NO_ROUGH}
    yield Row("nan-filled", "nan", 'the same with missing = "harmonic"', filled, right)
    endless = Refused("no length", ["heights from -1e+30 to 1e+30 m"])
    infinite = partial(patch, raised(np.s_[3, 3], np.inf))
    yield Row("infinite", "nan", "one height is infinite", infinite, {SAM: endless, FEM: endless})
    coarse = Refused("waves below two cells", ["grid.cells", "cells in the shortest wavelength"])
    yield Row(
        "coarse-waves",
        "too coarse",
        "waves shorter than two cells",
        _coarse_waves,
        {SAM: coarse, FEM: coarse},
    )


def _filled(heights: np.ndarray) -> Scene:
    return other(
        patch(heights[:3]), {"surface.path": HeightMap(heights, (SIDE, SIDE)), "surface.missing": "harmonic"}
    )


def _coarse_waves() -> Scene:
    surface = {"kind": "sinusoid", "amplitude": 1e-8, "wavelength_x": 1e-6}
    grid = {"cells": (CELLS, CELLS), "extent": (SIDE, SIDE)}
    return scene_with({"counterbody": {"shape": "flat"}, "grid": grid, "surface": surface})


def _row(
    name: str, topic: str, what: str, make: Callable[[], Scene], *, expected: Expectation, quick: bool
) -> Row:
    return Row(name, topic, what, make, {SAM: expected, FEM: NO_ROUGH}, quick)


def of_sam(
    name: str,
    topic: str,
    what: str,
    heights: np.ndarray,
    *,
    checks: list[Check],
    force: float = 1.0,
    quick=False,
) -> Row:
    """A row that SAM must solve; the axisymmetric model knows no rough body."""
    expected = Right("elastic contact is well posed on any heights", checks)
    return _row(name, topic, what, partial(patch, heights, force=force), expected=expected, quick=quick)
