# SPDX-License-Identifier: MIT
"""How the groove of a rigid sphere that moves depends on the step along the path, and on the cells; whether
coarse runs extrapolate to the limit of fine ones, and the uncertainty of a single run covers its error.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene
from verification import uncertainty
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable
from verification.cases.cyclic.repeated_loading import extrapolated
from verification.cases.moving.moving_sphere_scenes import Setting, radius
from verification.figures.moving import errors_over_counts

STEPS = (1, 2, 4, 8, 16, 32)  # in the radius; the strain has no order before the last three
CELLS, AT = (6, 8, 12), 8  # in the radius; where the other is varied
FINE = 8  # steps in the radius where cells are varied
SINGLE = Setting(cells=10, per_radius=4)  # whose coarsest companion has 4 cells in the contact, the fewest
NAMES = ("groove_depth_m", "groove_deepest_m", "peeq_max")


@dataclass(frozen=True)
class Steps:
    """By steps and by cells in the radius: steady depth, largest plastic strain of the steady part, and the
    quantities of NAMES. single: values and uncertainties of these of a single run; radius: in m.
    """

    by_steps: Mapping[int, tuple[float, ...]]
    by_cells: Mapping[int, tuple[float, ...]]
    single: Mapping[str, tuple[float, float]]
    radius: float

    def limit(self, which: int) -> tuple[float, float]:
        """Limit and order of the three finest steps."""
        a, b, c = (self.by_steps[n][which] for n in STEPS[-3:])
        ratio = (b - a) / (c - b)
        return c + (c - b) / (ratio - 1), ratio

    def of_cells(self, which: int) -> float:
        """What the two finest numbers of cells leave to add to those where the steps are varied."""
        one, two = (self.by_cells[n][which] for n in CELLS[1:])
        return float(extrapolated(one, two, *CELLS[1:])) - self.by_cells[AT][which]

    def refined(self, name: str) -> float:
        """Limit of a quantity in steps and cells, by the finest of both."""
        which = 2 + NAMES.index(name)
        return self.limit(which)[0] + self.of_cells(which)

    def from_coarse(self, name: str) -> float:
        """The same by steps of a/4 and a/8, as of first order, and the same cells: those of a/6, a/8 and a/12
        leave the strain of one cell within 0.6 % of each other, in no order.
        """
        which = 2 + NAMES.index(name)
        return 2 * self.by_steps[8][which] - self.by_steps[4][which] + self.of_cells(which)


def values_of(result: Result) -> tuple[float, ...]:
    """Steady depth in m, the largest plastic strain of the steady part, and the quantities of NAMES."""
    track = result.tables["track"]
    strain = max(p for p, steady in zip(track["peeq_max"], track["steady"], strict=True) if steady)
    found = (result.quantities[name] for name in NAMES)
    return result.quantities["groove_depth_m"], float(strain), *map(float, found)


def single(context: Context, scene: Scene) -> dict[str, tuple[float, float]]:
    """Values and uncertainties of one run, of NAMES."""

    def solved(each: Scene, label: str) -> Result:
        return context.solve(SAM, each, f"single, {label}")

    found = uncertainty.solve(uncertainty.asked_of(SINGLE.of(scene), "moving-sphere.toml"), SAM, solved)
    return {name: (found.quantities[name], found.uncertainty[name]["u_num"]) for name in NAMES}


class MovingSteps(Case):
    """Refinement of the step along the path, and of the cells."""

    def solve(self, context: Context) -> Steps:
        scene = context.scene("moving-sphere")
        by_steps = {
            n: values_of(context.solve(SAM, Setting(cells=AT, per_radius=n).of(scene), f"steps-{n}"))
            for n in STEPS
        }
        by_cells = {
            n: by_steps[FINE]
            if n == AT
            else values_of(context.solve(SAM, Setting(cells=n, per_radius=FINE).of(scene), f"cells-{n}"))
            for n in CELLS
        }
        return Steps(by_steps, by_cells, single(context, scene), radius(scene))

    def measure(self, found: Steps) -> dict[str, Measured | float]:
        (groove, _), (strain, _) = found.limit(0), found.limit(1)
        finest = {h: values[0] for h, values in found.by_cells.items()}
        errors: dict[str, Measured | float] = {}
        for key, name in (("groove", NAMES[0]), ("deepest", NAMES[1]), ("strain", NAMES[2])):
            limit, (value, known) = found.refined(name), found.single[name]
            errors[f"extrapolated-{key}"] = Measured(found.from_coarse(name), limit)
            errors[f"covered-{key}"] = abs(value - limit) / known
        return errors | {
            "groove-quarter": Measured(found.by_steps[4][0], groove, unit="m"),
            "peeq-eighth": Measured(found.by_steps[8][1], strain),
            "cells": Measured(finest[8], finest[12], unit="m"),
        }

    def tables(self, found: Steps) -> Iterator[SmallTable]:
        for name, values in (("steps", found.by_steps), ("cells", found.by_cells)):
            rows = [
                (str(n), f"{1e3 * groove / found.radius:.3f}", f"{1e3 * strain:.3f}")
                for n, (groove, strain, *_) in values.items()
            ]
            columns = (f"{name} in a", "groove, 1e-3 a", "plastic strain, 1e-3")
            yield SmallTable(f"Steady part by the {name} in a contact radius", columns, rows)
        rows = []
        for name, (value, known) in found.single.items():
            limit = found.refined(name)
            shares = (found.from_coarse(name) / limit - 1, value / limit - 1, known / limit)
            rows.append((name, f"{limit:.5g}", *(f"{100 * share:.2f} %" for share in shares)))
        columns = ("quantity", "refined limit", "coarse runs, extrapolated", "single run", "its uncertainty")
        yield SmallTable("Against the limit in steps and cells", columns, rows)

    def notes(self, found: Steps) -> Iterator[str]:
        for which, name in enumerate(("groove", "plastic strain")):
            limit, ratio = found.limit(which)
            scale = 1e3 / found.radius if which == 0 else 1e3
            yield f"Limit of the {name}: {limit * scale:.3f}e-3, by a ratio of {ratio:.2f} of halved steps."

    def figures(self, found: Steps) -> Iterator[Plot]:
        lines = {}
        for which, name in enumerate(("steady depth", "plastic strain")):
            limit, _ = found.limit(which)
            lines[name] = errors_of(found.by_steps, which, limit)
        depth = found.by_cells[AT][0] + found.of_cells(0)
        yield Plot(
            errors_over_counts(
                {"steps": lines, "cells": {"steady depth": errors_of(found.by_cells, 0, depth)}}
            ),
            "errors",
            "Error by the step along the path, and by the cells",
            "Relative errors over the number of steps and of cells in a radius, both logarithmic, falling.",
            f"Steady part of the track, on cells of a/{AT} (left) and in steps of a/{FINE} (right).",
        )


def errors_of(
    by_size: Mapping[int, tuple[float, ...]], which: int, limit: float
) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of steps or cells in a radius, and relative errors of a value."""
    return np.array(list(by_size)), np.abs(
        np.array([values[which] for values in by_size.values()]) / limit - 1
    )


CASES = (MovingSteps("moving-steps"),)
