# SPDX-License-Identifier: MIT
"""Passes of a rigid sphere over a track: steel one way and to and fro, with and without friction; bodies of
perfect plasticity that settle, or flow in every pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sam.scene import Friction, Plasticity, Result, Scene
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_body,
    with_keys,
)
from verification.cases.moving.moving_sphere_scenes import Setting, radius, yield_stress
from verification.figures.moving import new_strains

CELLS = {"quick": 4, "full": 8}  # in the radius
PASSES, FLOWS = 6, 8  # the latter over perfect plasticity: until each pass strains the body alike
LARGE = 4  # passes whose new strain is far above the 6e-7 that the plastic iteration leaves
STEEL = {
    "one-way": (0.0, False),
    "to-and-fro": (0.0, True),
    "friction-one-way": (0.2, False),
    "friction-to-and-fro": (0.2, True),
}
"""Coefficient of friction, and whether the sphere goes to and fro; with friction at the full level."""
PERFECT = {"settles": 2.2, "flows": 4.0}
"""p0 over the yield stress of perfect plasticity."""
VERDICTS = {"settles": "shakedown", "flows": "alternating"}


@dataclass(frozen=True)
class Passes:
    """Results of steel and of perfect plasticity by name, with the radius in m of each."""

    steel: Mapping[str, Result]
    perfect: Mapping[str, Result]
    yield_stress: float
    radius: float


def column(result: Result, name: str) -> np.ndarray:
    """A column of the table of passes."""
    return np.asarray(result.tables["passes"][name], dtype=float)


def perfect_of(scene: Scene) -> Scene:
    """The scene with perfect plasticity at the yield stress of its unstrained body, and a verdict."""
    law = Plasticity(law="perfect", yield_stress=yield_stress(scene))
    return with_keys(with_body(scene, plasticity=law), "solver", verdict=True)


class MovingPasses(Case):
    """Repeated passes: what each adds."""

    def solve(self, context: Context) -> Passes:
        scene, cells = context.scene("moving-sphere"), CELLS[context.level]
        steel, perfect = {}, {}
        for name, (mu, to_and_fro) in STEEL.items():
            if mu and context.level == "quick":
                continue
            setting = Setting(cells=cells, cycles=PASSES, to_and_fro=to_and_fro)
            friction = Friction(coefficient=mu) if mu else None
            made = setting.of(scene).model_copy(update={"friction": friction})
            steel[name] = context.solve(SAM, made, name)
        for name, ratio in PERFECT.items():
            setting = Setting(cells=cells, cycles=FLOWS, ratio=ratio)
            perfect[name] = context.solve(SAM, setting.of(perfect_of(scene)), f"perfect-{name}")
        return Passes(steel, perfect, yield_stress(scene), radius(scene))

    def measure(self, found: Passes) -> dict[str, Measured | float]:
        forth, back = column(found.steel["to-and-fro"], "rolling")[-2:]
        first = column(found.steel["to-and-fro"], "rolling")[0]
        settles, flows = (column(found.perfect[name], "new_strain_max") for name in PERFECT)
        classes = {name: found.perfect[name].verdict["class"] for name in PERFECT}
        depths = [column(found.steel[name], "groove_m")[-1] for name in ("one-way", "to-and-fro")]
        return {
            "conservative": float((back - forth) / 2 / first),
            "both-ways": Measured(*depths[::-1], unit="m"),
            "steady": found.steel["one-way"].quantities["passes_to_steady"],
            "perfect-settles": float(min(one / two for one, two in pairwise(settles[:LARGE]))),
            "perfect-flows": Measured(flows[-1], flows[-2]),
            **{f"verdict-{name}": Measured(float(of == VERDICTS[name]), 1.0) for name, of in classes.items()},
        }

    def tables(self, found: Passes) -> Iterator[SmallTable]:
        for runs, passes in ((found.steel, PASSES), (found.perfect, FLOWS)):
            rows = [
                (name, *(f"{value:.2e}" for value in column(each, "new_strain_max")))
                for name, each in runs.items()
            ]
            counts = [str(k + 1) for k in range(passes)]
            body = "Swift steel" if runs is found.steel else "perfect plasticity"
            yield SmallTable(f"Largest plastic strain that a pass adds, {body}", ("run", *counts), rows)
        grooves = [
            (name, *(f"{1e3 * value / found.radius:.3f}" for value in column(each, "groove_m")))
            for name, each in found.steel.items()
        ]
        counts = [str(k + 1) for k in range(PASSES)]
        yield SmallTable("Groove in the middle, in thousandths of the radius", ("run", *counts), grooves)

    def notes(self, found: Passes) -> Iterator[str]:
        for name, each in found.perfect.items():
            history = each.tables["history"]
            loaded = np.flatnonzero(np.array(history["force_N"]) > 0)[-1]
            pressure = history["p_max_Pa"][loaded] * np.sqrt(3) / found.yield_stress
            yield (
                f"Perfect plasticity at p0 = {PERFECT[name]:g} yield stresses: the pressure ends at "
                f"{pressure:.2f} k, k the shear strength; verdict after {FLOWS} passes: "
                f"{each.verdict['class']}, since pass {each.verdict['decided_at_cycle']}."
            )

    def figures(self, found: Passes) -> Iterator[Plot]:
        runs = {
            f"Swift steel, {name.replace('friction-', 'friction, ')}": column(each, "new_strain_max")
            for name, each in found.steel.items()
        }
        ratios = {
            f"perfect, p0 = {PERFECT[name]:g} yield stresses": each for name, each in found.perfect.items()
        }
        runs |= {name: column(each, "new_strain_max") for name, each in ratios.items()}
        yield Plot(
            new_strains(runs),
            "new-strain",
            "What each pass adds",
            "Largest new plastic strain over the number of the pass",
            "Largest plastic strain that a pass adds to a cell of the steady part of the track; no mark "
            "where it adds none.",
        )


CASES = (MovingPasses("moving-passes"),)
