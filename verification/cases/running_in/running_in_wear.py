# SPDX-License-Identifier: MIT
"""Wear by itself: what it must do at its limits."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sam.scene import Result, Scene, Wear
from verification.cases.case import SAM, Case, Context, Measured, SmallTable, number, with_keys, with_loading
from verification.cases.recipes import Resolution, sliding_scene
from verification.cases.running_in.scenes import Effort, reduced
from verification.cases.running_in.study import CUBIC
from verification.runs.sampling import surface_pressure

SPHERE, RATIO, LIMIT = "plastic-linear", 6.2, 0.004
"""A law that hardens little: on Swift steel no strain reaches the surface without friction, however small the
limit.
"""
WORN, PLAIN, KEPT, ROUGH = "sphere-worn", "sphere-plain", "sphere-infinite", "patch-infinite"
RUNS = {WORN: "sphere that wears", KEPT: "sphere, infinite limit", ROUGH: "rough patch, infinite limit"}
Found = dict[str, tuple[Scene, Result]]


class WearLimits(Case):
    """A smooth sphere without friction that wears, one that never does, and a rough patch that never does."""

    def solve(self, context: Context) -> Found:
        sphere = sliding_scene(context.scene(SPHERE), RATIO, 0.0, Resolution(8, 8))
        sphere = with_loading(sphere, steps=3, unload=True, unload_steps=2, cycles=3)
        patch = reduced(context.scene("running-in-bulk"), Effort(cycles=5, steps=3, cells=32))
        scenes = {
            WORN: sphere.model_copy(update={"wear": Wear(strain_limit=LIMIT)}),
            PLAIN: sphere,
            KEPT: sphere.model_copy(update={"wear": Wear(strain_limit=np.inf)}),
            ROUGH: with_keys(patch, "wear", strain_limit=np.inf),
        }
        return {label: (scene, context.solve(SAM, scene, label)) for label, scene in scenes.items()}

    def measure(self, found: Found) -> dict[str, Measured | float]:
        (_, worn), (_, plain), (_, kept), (_, rough) = found.values()
        values = {
            "symmetry": asymmetry(worn_of(worn)),
            "quarter-turn": asymmetry(worn_of(worn), turned=True),
            "volume": Measured(of_cycles(worn, "wear_volume_m3")[-1], unit="m³"),
            "plain": Measured(
                max(
                    float(np.abs(of_cycles(kept, name) - of_cycles(plain, name)).max())
                    for name in ("peeq_max", "p_max_Pa", "friction_coefficient")
                ),
                0,
            ),
        }
        for label, result in (("sphere", kept), ("patch", rough)):
            strain = of_cycles(result, "peeq_max")
            values[f"{label}-wear"] = Measured(of_cycles(result, "wear_volume_m3")[-1], 0, unit="m³")
            values[f"{label}-settles"] = float((strain[-1] - strain[-2]) / strain[0])
        return values

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        cycles, side = found[PLAIN][0].loading.cycles, 1e6 * found[ROUGH][0].grid.extent[0]
        yield "Sphere", f"rigid, p₀/σ_y0 = {RATIO:g}, no friction, linear hardening, {cycles} cycles"
        yield "Limit", f"plastic strain of {LIMIT:.1%}, or infinite"
        yield "Patch", f"{side:g} µm of the bulk case of running-in, film and friction, infinite limit"

    def tables(self, found: Found) -> Iterator[SmallTable]:
        rows = []
        for label, words in RUNS.items():
            scene, result = found[label]
            ends = [
                number(scale * of_cycles(result, name)[k], 4)
                for name, scale in (("wear_volume_m3", CUBIC), ("peeq_max", 100.0))
                for k in (0, -1)
            ]
            worn = worn_of(result) if scene.surface is None else np.zeros(1)
            apart = f"{max(asymmetry(worn), asymmetry(worn, turned=True)):.1e}" if worn.any() else "–"
            rows.append((words, *ends, apart))
        columns = (
            "run|volume [µm³], first|volume [µm³], last|largest strain [%], first|largest strain [%], last"
        )
        yield SmallTable("First and last cycle", (*columns.split("|"), "asymmetry of the scar"), rows)


def worn_of(result: Result) -> np.ndarray:
    """(nx, ny) worn depth in m of a smooth scene at the last peak, before the removal of the last cycle; zero
    where nothing can wear.
    """
    fields = result.fields
    worn = fields.cell_data.get("worn_m", np.zeros(len(fields.cells["quad"])))
    return surface_pressure(fields.points, fields.cells["quad"], worn)[2]


def asymmetry(worn: np.ndarray, turned: bool = False) -> float:
    """Largest difference to the mirrored scar, or to the one turned by 90 degrees, over the largest depth;
    NaN without scar.
    """
    others = (worn.T,) if turned else (worn[::-1], worn[:, ::-1])
    with np.errstate(invalid="ignore"):
        return float(np.max([np.abs(worn - other).max() for other in others]) / worn.max())


def of_cycles(result: Result, column: str) -> np.ndarray:
    """A column of the table of cycles."""
    return np.asarray(result.tables["cycles"][column], dtype=float)


CASES = (WearLimits("wear-limits"),)
