# SPDX-License-Identifier: MIT
"""How the groove of a rigid sphere that moves depends on the step along the path, and on the cells."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from sam.scene import Result
from verification.suite.cases.case import SAM, Case, Context, Measured, SmallTable
from verification.suite.cases.moving_sphere_scenes import Setting, radius

STEPS = (1, 2, 4, 8, 16, 32)  # in the radius; the strain has no order before the last three
CELLS, AT = (6, 8, 12), 8  # in the radius; where the other is varied
FINE = 8  # steps in the radius where the cells are varied
EQUATIONS = (
    ("Limit", "q = q_2n + (q_2n − q_n)/(2^p − 1), p = log2((q_n − q_n/2)/(q_2n − q_n))", "Richardson (1911)"),
)


@dataclass(frozen=True)
class Steps:
    """Steady depth and largest plastic strain by steps, and by cells in the radius; radius: in m."""

    by_steps: Mapping[int, tuple[float, float]]
    by_cells: Mapping[int, tuple[float, float]]
    radius: float

    def limit(self, which: int) -> tuple[float, float]:
        """Limit and order of the three finest steps."""
        a, b, c = (self.by_steps[n][which] for n in STEPS[-3:])
        ratio = (b - a) / (c - b)
        return c + (c - b) / (ratio - 1), ratio


def both_of(result: Result) -> tuple[float, float]:
    """Steady depth in m, and the largest plastic strain of the steady part."""
    track = result.tables["track"]
    strain = max(p for p, steady in zip(track["peeq_max"], track["steady"], strict=True) if steady)
    return result.quantities["groove_depth_m"], float(strain)


class MovingSteps(Case):
    """Refinement of the step along the path, and of the cells."""

    def solve(self, context: Context) -> Steps:
        scene = context.scene("moving-sphere")
        by_steps = {
            n: both_of(context.solve(SAM, Setting(cells=AT, per_radius=n).of(scene), f"steps-{n}"))
            for n in STEPS
        }
        by_cells = {
            n: by_steps[FINE]
            if n == AT
            else both_of(context.solve(SAM, Setting(cells=n, per_radius=FINE).of(scene), f"cells-{n}"))
            for n in CELLS
        }
        return Steps(by_steps, by_cells, radius(scene))

    def measure(self, found: Steps) -> dict[str, Measured | float]:
        (groove, _), (strain, _) = found.limit(0), found.limit(1)
        finest = {h: values[0] for h, values in found.by_cells.items()}
        return {
            "groove-quarter": Measured(found.by_steps[4][0], groove, unit="m"),
            "peeq-eighth": Measured(found.by_steps[8][1], strain),
            "cells": Measured(finest[8], finest[12], unit="m"),
        }

    def tables(self, found: Steps) -> Iterator[SmallTable]:
        for name, values in (("steps", found.by_steps), ("cells", found.by_cells)):
            rows = [
                (str(n), f"{1e3 * groove / found.radius:.3f}", f"{1e3 * strain:.3f}")
                for n, (groove, strain) in values.items()
            ]
            columns = (f"{name} in a", "groove, 1e-3 a", "plastic strain, 1e-3")
            yield SmallTable(f"Steady part by the {name} in a contact radius", columns, rows)

    def notes(self, found: Steps) -> Iterator[str]:
        for which, name in enumerate(("groove", "plastic strain")):
            limit, ratio = found.limit(which)
            scale = 1e3 / found.radius if which == 0 else 1e3
            yield f"Limit of the {name}: {limit * scale:.3f}e-3, by a ratio of {ratio:.2f} of halved steps."


CASES = (
    MovingSteps(
        "moving-steps",
        "Step along the path, and cells",
        "How long may the steps of a sphere that moves be, and how large the cells?",
        EQUATIONS,
        levels=("full",),
    ),
)
