# SPDX-License-Identifier: MIT
"""Wear by itself: what it must do at its limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene, Wear
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    number,
    with_loading,
)
from verification.cases.recipes import Resolution, sliding_scene
from verification.cases.running_in.running_in_scenes import (
    Effort,
    reduced,
)
from verification.runs.sampling import surface_pressure

SPHERE, RATIO, LIMIT = "plastic-linear", 6.2, 0.004
"""A law that hardens little: on Swift steel no strain reaches the surface without friction, however small the
limit.
"""
CUBIC = 1e18


@dataclass(frozen=True)
class Extremes:
    """sphere, patch: the scenes; limited, plain, kept: the sphere with a limit, without wear, with an
    infinite limit; rough: the patch with an infinite limit.
    """

    sphere: Scene
    patch: Scene
    limited: Result
    plain: Result
    kept: Result
    rough: Result


class WearLimits(Case):
    """A smooth sphere without friction that wears, one that never does, and a rough patch that never does."""

    def solve(self, context: Context) -> Extremes:
        sphere, patch = sphere_scene(context), patch_scene(context)
        scenes = {
            "sphere-worn": with_limit(sphere, LIMIT),
            "sphere-plain": sphere,
            "sphere-infinite": with_limit(sphere, np.inf),
            "patch-infinite": with_limit(patch, np.inf),
        }
        results = (context.solve(SAM, scene, label) for label, scene in scenes.items())
        return Extremes(sphere, patch, *results)

    def measure(self, found: Extremes) -> dict[str, Measured | float]:
        values = {
            "symmetry": asymmetry(worn_of(found.limited)),
            "quarter-turn": asymmetry(worn_of(found.limited), turned=True),
            "volume": Measured(last(found.limited, "wear_volume_m3"), unit="m³"),
            "plain": Measured(difference(found.kept, found.plain), 0),
        }
        for label, result in (("sphere", found.kept), ("patch", found.rough)):
            values[f"{label}-wear"] = Measured(last(result, "wear_volume_m3"), 0, unit="m³")
            values[f"{label}-settles"] = last_gain(result)
        return values

    def setup(self, found: Extremes) -> list[tuple[str, str]]:
        return [
            (
                "Sphere",
                f"rigid, p₀/σ_y0 = {RATIO:g}, no friction, linear hardening, {found.sphere.loading.cycles} "
                "cycles",
            ),
            ("Limit", f"plastic strain of {LIMIT:.1%}, or infinite"),
            (
                "Patch",
                f"{1e6 * found.patch.grid.extent[0]:g} µm of the bulk case of running-in, film and friction, "
                "infinite limit",
            ),
        ]

    def tables(self, found: Extremes) -> Iterator[SmallTable]:
        results = found.limited, found.kept, found.rough
        rows = [row(words, result) for words, result in zip(RUNS, results, strict=True)]
        quantities = ("volume [µm³]", "largest strain [%]")
        ends = (f"{words}, {place}" for words in quantities for place in ("first", "last"))
        yield SmallTable("First and last cycle", ("run", *ends, "asymmetry of the scar"), rows)


RUNS = ("sphere that wears", "sphere, infinite limit", "rough patch, infinite limit")


def sphere_scene(context: Context) -> Scene:
    """A smooth sphere pressed on three times."""
    scene = sliding_scene(context.scene(SPHERE), RATIO, 0.0, Resolution(8, 8))
    return with_loading(scene, steps=3, unload=True, unload_steps=2, cycles=3)


def patch_scene(context: Context) -> Scene:
    """A small rough patch, sliding under its film."""
    return reduced(context.scene("running-in-bulk"), Effort((), (), cycles=5, steps=3, cells=32))


def with_limit(scene: Scene, limit: float) -> Scene:
    """The scene with wear beyond this strain."""
    wear = (
        Wear(strain_limit=limit)
        if scene.wear is None
        else scene.wear.model_copy(update={"strain_limit": limit})
    )
    return scene.model_copy(update={"wear": wear})


def worn_of(result: Result) -> np.ndarray:
    """(nx, ny) worn depth in m of a smooth scene at the last peak, before the removal of the last cycle."""
    fields = result.fields
    return surface_pressure(fields.points, fields.cells["quad"], fields.cell_data["worn_m"])[2]


def asymmetry(worn: np.ndarray, turned: bool = False) -> float:
    """Largest difference to the mirrored scar, or to the one turned by 90 degrees, over the largest depth;
    NaN without scar.
    """
    others = (worn.T,) if turned else (worn[::-1], worn[:, ::-1])
    with np.errstate(invalid="ignore"):
        return float(np.max([np.abs(worn - other).max() for other in others]) / worn.max())


def last(result: Result, column: str) -> float:
    """A column at the end of the last cycle."""
    return float(result.tables["cycles"][column][-1])


def last_gain(result: Result) -> float:
    """What the last cycle adds to the largest plastic strain, over that of the first."""
    strain = np.asarray(result.tables["cycles"]["peeq_max"], dtype=float)
    return float((strain[-1] - strain[-2]) / strain[0])


def difference(one: Result, other: Result) -> float:
    """Largest difference of the pressures and strains of all cycles."""
    pairs = [
        (np.asarray(r.tables["cycles"][name], dtype=float) for r in (one, other))
        for name in ("peeq_max", "p_max_Pa", "friction_coefficient")
    ]
    return max(float(np.abs(a - b).max()) for a, b in pairs)


def row(words: str, result: Result) -> tuple[str, ...]:
    """First and last cycle of a run."""
    cycles = result.tables["cycles"]
    volumes, strains = (np.asarray(cycles[name], dtype=float) for name in ("wear_volume_m3", "peeq_max"))
    worn = worn_of(result) if "worn_m" in result.fields.cell_data else np.zeros((1, 1))
    apart = max(asymmetry(worn), asymmetry(worn, turned=True)) if worn.any() else 0.0
    shape = f"{apart:.1e}" if worn.any() and result.tables.get("surface") is None else "–"
    ends = [number(scale * of[k], 4) for scale, of in ((CUBIC, volumes), (100.0, strains)) for k in (0, -1)]
    return (words, *ends, shape)


CASES = (WearLimits("wear-limits"),)
