# SPDX-License-Identifier: MIT
"""What the load history must not do: yield below the limit of elasticity, and yield again on reloading."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import (
    FEM,
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    with_body,
    with_loading,
)
from verification.cases.recipes import Resolution, at_ratio, initial_yield, resolved_at
from verification.runs.sampling import peak

AT = Resolution(10, 16)
MODELS = {SAM: "sam", FEM: "fem"}
ELASTIC, RELOADED = 1.5, 4.0  # p0 over the initial yield stress; first yield is at 1.613
SAME = ("approach_m", "contact_area_m2", "p_max_Pa")
SURFACE = ("p_Pa", "uz_m", "gap_m")


@dataclass(frozen=True)
class PlasticHistory(Case):
    """What both cases of a load history share. ratio: p0 over the initial yield stress; cycles: of load."""

    ratio: float = 0.0
    cycles: int = 1

    def scene(self, context: Context) -> Scene:
        """The scene at the load of the case."""
        scene = resolved_at(at_ratio(context.scene("plastic-swift-rigid"), self.ratio), AT)
        return with_loading(scene, cycles=self.cycles)

    def setup(self, found: tuple[Scene, Mapping]) -> list[tuple[str, str]]:
        scene, loading = found[0], found[0].loading
        return [
            ("Scene", "rigid sphere on Swift steel, as in plastic-swift-rigid-4"),
            ("Initial yield stress", f"{initial_yield(scene) / 1e6:.1f} MPa"),
            (
                "Level",
                f"p₀/σ_y0 = {self.ratio:g}; {loading.force:.5g} N in {loading.steps} steps, {loading.cycles} "
                "cycle(s)",
            ),
        ]


class ElasticLimit(PlasticHistory):
    """Below first yield with and without [body.plasticity]: largest plastic strain and change of the
    answer.
    """

    def solve(self, context: Context) -> tuple[Scene, dict[str, tuple[float, float]]]:
        scene, found = self.scene(context), {}
        for model in MODELS:
            plastic = context.solve(model, scene, f"{model}-plastic")
            elastic = context.solve(model, with_body(scene, plasticity=None), f"{model}-elastic")
            found[model] = plastic.quantities["peeq_max"], largest_change(plastic, elastic)
        return scene, found

    def measure(self, found: tuple[Scene, Mapping]) -> dict[str, Measured | float]:
        values = {f"{MODELS[model]}-peeq": Measured(peeq, 0.0) for model, (peeq, _) in found[1].items()}
        return values | {f"{MODELS[model]}-change": lost for model, (_, lost) in found[1].items()}

    def tables(self, found: tuple[Scene, Mapping]) -> Iterator[SmallTable]:
        yield SmallTable(
            "With a yield stress that is not reached",
            ("model", "plastic strain", "change"),
            [(model, f"{peeq:g}", f"{lost:.1e}") for model, (peeq, lost) in found[1].items()],
        )


def largest_change(plastic: Result, elastic: Result) -> float:
    """Largest difference of quantities and surface fields, relative to the largest value of each."""
    pairs = [(plastic.quantities[name], elastic.quantities[name]) for name in SAME]
    pairs += [
        (peak(plastic.tables["line"], name)[0], peak(elastic.tables["line"], name)[0]) for name in SURFACE
    ]
    return max(float(np.max(np.abs(np.subtract(a, b))) / np.max(np.abs(b))) for a, b in pairs)


class Reload(PlasticHistory):
    """Loaded, unloaded and loaded again to the same force."""

    def solve(self, context: Context) -> tuple[Scene, dict[str, tuple[float, float, float]]]:
        scene = self.scene(context)
        return scene, {model: cycles(context.solve(model, scene, model)) for model in MODELS}

    def measure(self, found: tuple[Scene, Mapping]) -> dict[str, Measured | float]:
        values = {f"{MODELS[m]}-peeq": Measured(second, first) for m, (first, second, _) in found[1].items()}
        return values | {f"{MODELS[model]}-approach": approach for model, (*_, approach) in found[1].items()}

    def tables(self, found: tuple[Scene, Mapping]) -> Iterator[SmallTable]:
        yield SmallTable(
            "The second cycle against the first",
            (
                "model",
                *("largest plastic strain, first load", "added by the second", "change of the approach"),
            ),
            [
                (model, f"{1e2 * first:.6f} %", f"{second / first - 1.0:.1e}", f"{approach:.1e}")
                for model, (first, second, approach) in found[1].items()
            ],
        )


def cycles(result: Result) -> tuple[float, float, float]:
    """Largest plastic strain at the peak of the first and at the end of the second cycle, relative change of
    the approach.
    """
    cycle, force, approach, peeq = (
        np.asarray(result.tables["history"][name]) for name in ("cycle", "force_N", "approach_m", "peeq_max")
    )
    tops = [np.flatnonzero(cycle == k)[np.argmax(force[cycle == k])] for k in (1, 2)]
    first, second = (float(approach[row]) for row in tops)
    return float(peeq[tops[0]]), float(peeq[-1]), abs(second / first - 1.0)


CASES = (
    ElasticLimit("plastic-elastic-limit", ratio=ELASTIC),
    Reload("plastic-reload", ratio=RELOADED, cycles=2),
)
