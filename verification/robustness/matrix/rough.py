# SPDX-License-Identifier: MIT
"""Extremes of the surface: constant, a step, a ridge along the border, a spike, waves, and what is no
height.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, sqrt
from typing import Any

import numpy as np

from sam.scene import HeightMap, Result, Scene, Status
from verification.quantities import modulus_of
from verification.robustness.matrix.checks import balanced, relative
from verification.robustness.matrix.row import (
    Check,
    Deviation,
    Refused,
    Right,
    Row,
    Trial,
    both,
    changed,
    other,
    scene_with,
)

SIDE, CELLS, HIGH = 32e-6, 32, 1e-6  # of the patch in m; of what stands out of it
# compliance of a square punch over that of a disc of its area, inverse: King, Int. J. Solids Struct. 23
# (1987) 1657
KING = 1.012
NO_COUNTER = Refused("no symmetry of rotation", ["counterbody.surface.kind"])
NO_ROUGH = Refused("no symmetry of rotation", ["surface.kind", "remove [surface]"])


def heights_of(values: np.ndarray, **more: Any) -> dict[str, Any]:
    """A surface of heights, (nx, ny) in m on cells of the size of the whole patch's."""
    extent = tuple(SIDE * n / CELLS for n in values.shape)
    return {"kind": "file", "path": HeightMap(values, extent)} | more


def patch(values: np.ndarray, force: float = 1.0, **more: Any) -> dict[str, Any]:
    """A plane pressed on heights."""
    surface = heights_of(values, **more)
    return {"counterbody": {"shape": "flat"}, "grid": None, "loading": {"force": force}, "surface": surface}


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
    expected = trial.scene.loading.force / (2 * KING * modulus_of(trial.scene) * SIDE / sqrt(pi))
    found, reason = trial.quantities["approach_m"], "32 cells along the side"
    yield relative("approach, square punch", found, expected, 0.005, reason=reason)


def whole(result: Result) -> dict[str, float]:
    """Approach, and the largest pressure and the cells in contact of the whole patch (maxima leave its border
    out).
    """
    pressure, approach = np.asarray(result.fields.cell_data["p_Pa"]), result.quantities["approach_m"]
    touching = float(np.count_nonzero(pressure > 0))
    return {"approach": approach, "largest pressure": np.nanmax(pressure), "cells in contact": touching}


def as_twin(words: str, reason: str, twin: Callable[[Scene], Scene]) -> Check:
    """The same pressure and approach as of another scene."""

    def check(trial: Trial) -> Iterator[Deviation]:
        expected = whole(trial.bench.converged(twin(trial.scene), trial.model))
        for name, value in whole(trial.result).items():
            yield relative(f"{name}, {words}", value, expected[name], 1e-6, reason=reason)

    return check


def as_patch(values: np.ndarray) -> Check:
    """As of a smaller patch that holds all that touches."""
    reason = "the cells beside are not touched: one discrete problem"
    return as_twin("the part alone", reason, lambda scene: scene_with(patch(values, scene.loading.force)))


def as_sum(total: np.ndarray) -> Check:
    """As of the sum of the heights on the body under a plane."""
    reason = "the same gap, rounded differently"
    return as_twin("heights on the body", reason, lambda scene: scene_with(patch(total)))


def turned(scene: Scene) -> Scene:
    """The scene with its surface turned over in x."""
    path = scene.surface.path
    return other(scene, {"surface.path": HeightMap(path.values[::-1], path.extent)})


mirrored = as_twin("mirrored in x", "a reflection", turned)


def warned(trial: Trial) -> Iterator[Deviation]:
    """Contact at the border of a patch is said."""
    said = any("border" in text or "edge" in text for text in trial.result.warnings)
    yield Deviation("no warning of the border", float(not said), 0.5, "a patch is cut out of a surface")


def all_touch(trial: Trial) -> Iterator[Deviation]:
    """Every cell is in contact; then the problem is linear: equal increments of the force, equal ones of the
    approach.
    """
    force, found = trial.scene.loading.force, [trial.quantities["approach_m"]]
    apart = CELLS**2 - trial.result.discretisation["contact_cells"]
    yield Deviation("cells that do not touch", apart, 0.5, "all do")
    for factor in (1.25, 1.5):
        twin = trial.bench.converged(other(trial.scene, {"loading.force": factor * force}), trial.model)
        found.append(twin.quantities["approach_m"])
    first, second = np.diff(found)
    yield relative("increment of the approach", second, first, 1e-6, reason="all cells touch: linear")


def rows() -> Iterator[Row]:
    """All of them."""
    high, step, ridge = plain() + 1e-3, raised(np.s_[: CELLS // 2]), raised(np.s_[:4])
    spike, half, strip = raised(np.s_[CELLS // 2, CELLS // 2]), plain(CELLS // 2), plain(4)
    upper = [as_patch(half), mirrored, balanced]
    edge = [as_patch(strip), mirrored, balanced, warned]
    square, pressed = [square_punch, balanced, warned], "the same, pressed until its surroundings touch"
    closed, lone = [all_touch, balanced, warned], "one cell 1 um higher: it alone touches"
    few = Refused("one cell says nothing of the pressure on it", ["grid.cells"], Status.UNDER_RESOLVED)
    for name, topic, what, heights, force, expected in (
        ("constant", "constant", "constant heights: a square punch", plain(), 1.0, square),
        ("constant-1mm", "constant", "constant heights, 1 mm up", high, 1.0, square),
        ("step", "step", "half of the patch 1 um higher: only it touches", step, 1.0, upper),
        ("ridge", "ridge", "a ridge of 4 cells along the border", ridge, 0.2, edge),
        ("spike", "spike", lone, spike, 1e-3, few),
        ("spike-pressed", "spike", pressed, spike, 1.0, [mirrored, balanced]),
        ("closed", "all cells", "a wave pressed flat: all cells touch", waves(1e-8), 160.0, closed),
    ):
        if isinstance(expected, list):
            expected = Right("elastic contact is well posed on any heights", expected)
        quick = name in ("constant", "step", "ridge", "spike")
        yield Row(name, topic, what, patch(heights, force), both(expected, NO_ROUGH), quick)
    yield from opposite()
    yield from refused()


def opposite() -> Iterator[Row]:
    """Heights on the counter-body: as good as on the body, whose sum alone counts."""

    def under(values: np.ndarray, own: np.ndarray | None = None, **more: Any) -> dict[str, Any]:
        """A plane with heights pressed on a smooth body, or on one with heights of its own."""
        counter = {"shape": "flat", "surface": heights_of(values, renew=False) | more}
        surface = None if own is None else heights_of(own)
        return {"counterbody": counter, "surface": surface, "grid": None, "loading": {"force": 1.0}}

    topic, wave, up, down = "counter-surface", waves(1e-8), waves(2e-8), waves(-2e-8)
    for name, heights, own, total, what in (
        ("constant", plain(), None, plain(), "no heights on it"),
        ("constant-1mm", plain() + 1e-3, None, plain(), "1 mm of constant heights on it"),
        ("upside-down", up, None, up, "a wave on it, upside down on the body"),
        ("image", up, down, plain(), "a wave on it in its image on the body"),
        ("crests", wave, wave, up, "equal waves on both, crest on crest"),
    ):
        right = Right("the gap knows only the sum of the heights", [as_sum(total), balanced])
        expected, quick = (
            both(right, NO_COUNTER if own is None else NO_ROUGH),
            name in ("constant", "upside-down"),
        )
        yield Row(f"counter-{name}", topic, what, under(heights, own), expected, quick)
    last = Right("the second cycle meets the second part of the map alone", [as_sum(up), balanced])
    parts = under(np.concatenate([plain(), up]), renew=True, crop=(-SIDE / 2, 0.0, SIDE, SIDE))
    parts = changed(parts, {"surface": None, "loading.unload": True, "loading.cycles": 2})
    what = "renewed from a map of two parts, a plane and a wave"
    yield Row("counter-renewed", topic, what, parts, both(last, NO_COUNTER), quick=True)
    no_part = both(Refused("no second part", ["counterbody.surface.renew", "no second part"]))
    one = under(waves(1e-8), renew=True)
    yield Row("counter-one-part", topic, "renewed from a map that holds one patch", one, no_part)


def refused() -> Iterator[Row]:
    """What is no height, and a grid that the surface does not fit on."""
    hole = raised(np.s_[3, 3], np.nan)
    words = ["surface.path", "1 of 1024 heights are missing", "surface.missing"]
    missing = both(Refused("a height that is not there", words))
    yield Row("nan", "nan", "one height is not a number", patch(hole), missing, quick=True)
    right = both(Right("filled from its neighbours", [square_punch, balanced]), NO_ROUGH)
    filled = patch(hole, missing="harmonic")
    yield Row("nan-filled", "nan", 'the same with missing = "harmonic"', filled, right)
    endless = both(Refused("no length", ["heights from -1e+30 to 1e+30 m"]))
    infinite = lambda: scene_with(patch(raised(np.s_[3, 3], np.inf)))  # noqa: E731 - no map: it is refused as it is made
    yield Row("infinite", "nan", "one height is infinite", infinite, endless)
    coarse = both(Refused("waves below two cells", ["grid.cells", "cells in the shortest wavelength"]))
    short = {
        "counterbody": {"shape": "flat"},
        "grid": {"cells": (CELLS, CELLS), "extent": (SIDE, SIDE)},
        "surface": {"kind": "sinusoid", "amplitude": 1e-8, "wavelength_x": 1e-6},
    }
    yield Row("coarse-waves", "too coarse", "waves shorter than two cells", short, coarse)
