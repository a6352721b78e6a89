# SPDX-License-Identifier: MIT
"""Passes of a rigid sphere over a track: steel one way and to and fro, with and without friction; bodies of
perfect plasticity that settle, or flow in every pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np

from sam.scene import Friction, Plasticity, Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, with_body, with_keys
from verification.cases.recipes import initial_yield, on_track
from verification.figures.lines import new_strains

CELLS = {"quick": 4, "full": 8}  # in the radius
STEEL = {
    "one-way": (0.0, False),
    "to-and-fro": (0.0, True),
    "friction-one-way": (0.2, False),
    "friction-to-and-fro": (0.2, True),
}
"""Coefficient of friction, and whether the sphere goes to and fro; with friction at the full level."""
PERFECT = {"settles": (2.2, "shakedown"), "flows": (4.0, "alternating")}
"""p0 over the yield stress of perfect plasticity, and what becomes of it. It goes on for eight passes, until
each strains the body alike.
"""
LARGE = 4  # passes whose new strain is far above the 6e-7 that the plastic iteration leaves


def scenes(base: Scene, level: str) -> Iterator[tuple[str, Scene]]:
    """Name and scene of every run."""
    cells = CELLS[level]
    for name, (mu, to_and_fro) in STEEL.items():
        if not mu or level == "full":
            made = on_track(base, {"cells": cells, "cycles": 6, "to_and_fro": to_and_fro})
            friction = Friction(coefficient=mu) if mu else None
            yield name, made.model_copy(update={"friction": friction})
    law = Plasticity(law="perfect", yield_stress=initial_yield(base))
    perfect = with_keys(with_body(base, plasticity=law), "solver", verdict=True)
    for name, (ratio, _) in PERFECT.items():
        yield name, on_track(perfect, {"cells": cells, "cycles": 8, "ratio": ratio})


def column(result: Result, name: str = "new_strain_max") -> np.ndarray:
    """A column of the table of passes."""
    return np.asarray(result.tables["passes"][name], dtype=float)


class MovingPasses(Case):
    """Repeated passes: what each adds."""

    def solve(self, context: Context) -> dict[str, Result]:
        base = context.scene("moving-sphere")
        return {
            name: context.solve(SAM, scene, f"perfect-{name}" if name in PERFECT else name)
            for name, scene in scenes(base, context.level)
        }

    def measure(self, found: Mapping[str, Result]) -> dict[str, Measured | float]:
        first, *_, forth, back = column(found["to-and-fro"], "rolling")
        settles, flows = (column(found[name]) for name in PERFECT)
        one_way, to_and_fro = (column(found[name], "groove_m")[-1] for name in ("one-way", "to-and-fro"))
        verdicts = {name: float(found[name].verdict["class"] == of) for name, (_, of) in PERFECT.items()}
        return {
            "conservative": float((back - forth) / 2 / first),
            "both-ways": Measured(to_and_fro, one_way, unit="m"),
            "steady": found["one-way"].quantities["passes_to_steady"],
            "perfect-settles": float(min(one / two for one, two in pairwise(settles[:LARGE]))),
            "perfect-flows": Measured(flows[-1], flows[-2]),
            **{f"verdict-{name}": Measured(value, 1.0) for name, value in verdicts.items()},
        }

    def tables(self, found: Mapping[str, Result]) -> Iterator[SmallTable]:
        heads = ("run", *(str(k + 1) for k in range(8)))
        for caption, name in (("Largest plastic strain", "new_strain_max"), ("Groove in m", "groove_m")):
            rows = [(run, *(f"{v:.3e}" for v in column(each, name))) for run, each in found.items()]
            rows = [(*row, *[""] * (len(heads) - len(row))) for row in rows]
            yield SmallTable(f"{caption} that a pass {'leaves' if 'G' in caption else 'adds'}", heads, rows)

    def notes(self, found: Mapping[str, Result]) -> Iterator[str]:
        for name, (ratio, _) in PERFECT.items():
            verdict, history = found[name].verdict, found[name].tables["history"]
            loaded = np.flatnonzero(np.array(history["force_N"]) > 0)[-1]
            yield (
                f"Perfect plasticity at p0 = {ratio:g} yield stresses: the largest pressure ends at "
                f"{history['p_max_Pa'][loaded] / 1e9:.3f} GPa; verdict after eight passes: "
                f"{verdict['class']}, since pass {verdict['decided_at_cycle']}."
            )

    def figures(self, found: Mapping[str, Result]) -> Iterator[Plot]:
        words = (
            "Largest plastic strain that a pass adds to a cell of the steady part of the track, over the "
            "number of the pass; no mark where it adds none."
        )
        drawing = new_strains({name: column(each) for name, each in found.items()})
        yield Plot(drawing, "new-strain", "What each pass adds", words, words)


CASES = (MovingPasses("moving-passes"),)
