# SPDX-License-Identifier: MIT
"""How the groove of a rigid sphere that moves depends on the step along the path, and on the cells; whether
coarse runs extrapolate to the limit of fine ones, and the uncertainty of a single run covers its error.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification import uncertainty
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable
from verification.cases.recipes import on_track
from verification.figures.lines import errors_over_counts
from verification.quantities import refined

STEPS = (1, 2, 4, 8, 16, 32)  # in the radius; the strain has no order before the last three
CELLS, AT = (6, 8, 12), 8  # in the radius; where the other is varied
SINGLE = {"cells": 10, "per_radius": 4}  # whose coarsest companion has 4 cells in the contact, the fewest
NAMES = {"groove": "groove_depth_m", "deepest": "groove_deepest_m", "strain": "peeq_max"}


def values_of(result: Result) -> dict[str, float]:
    """The quantities of NAMES, and "steady": the largest plastic strain of the steady part."""
    track = result.tables["track"]
    steady = max(p for p, steady in zip(track["peeq_max"], track["steady"], strict=True) if steady)
    return {key: float(result.quantities[name]) for key, name in NAMES.items()} | {"steady": float(steady)}


def limit(by_steps: Mapping[int, Mapping[str, float]], key: str) -> tuple[float, float]:
    """Limit of the three finest steps, and the ratio of the changes, two to the order."""
    a, b, c = (by_steps[n][key] for n in STEPS[-3:])
    ratio = (b - a) / (c - b)
    return c + (c - b) / (ratio - 1), ratio


def of_cells(by_cells: Mapping[int, Mapping[str, float]], key: str) -> float:
    """What the two finest numbers of cells leave to add to those where the steps are varied."""
    return float(refined(by_cells, lambda values: values[key])) - by_cells[AT][key]


class MovingSteps(Case):
    """Refinement of the step along the path, and of the cells."""

    def solve(self, context: Context) -> dict[str, Any]:
        """steps, cells: number in a radius -> values; single: value and uncertainty of one run."""
        base = context.scene("moving-sphere")

        def at(label: str, **keys: int) -> dict[str, float]:
            return values_of(context.solve(SAM, on_track(base, keys), label))

        def solved(scene: Scene, label: str) -> Result:
            return context.solve(SAM, scene, f"single, {label}")

        steps = {n: at(f"steps-{n}", cells=AT, per_radius=n) for n in STEPS}
        cells = {n: steps[AT] if n == AT else at(f"cells-{n}", cells=n, per_radius=AT) for n in CELLS}
        asked = uncertainty.asked_of(on_track(base, SINGLE), "moving-sphere.toml")
        found = uncertainty.solve(asked, SAM, solved)
        single = {k: (found.quantities[n], found.uncertainty[n]["u_num"]) for k, n in NAMES.items()}
        return {"steps": steps, "cells": cells, "single": single}

    def measure(self, found: Mapping[str, Any]) -> dict[str, Measured | float]:
        """Coarse runs are those with steps of a/4 and a/8, as of first order, and the same cells: those of
        a/6, a/8 and a/12 leave the strain of one cell within 0.6 % of each other, in no order.
        """
        steps, cells, values = found["steps"], found["cells"], dict[str, Measured | float]()
        for key, (value, known) in found["single"].items():
            exact = limit(steps, key)[0] + of_cells(cells, key)
            coarse = 2 * steps[8][key] - steps[4][key] + of_cells(cells, key)
            values |= {f"extrapolated-{key}": Measured(coarse, exact)}
            values |= {f"covered-{key}": abs(value - exact) / known}
        return values | {
            "groove-quarter": Measured(steps[4]["groove"], limit(steps, "groove")[0], unit="m"),
            "peeq-eighth": Measured(steps[8]["steady"], limit(steps, "steady")[0]),
            "cells": Measured(cells[8]["groove"], cells[12]["groove"], unit="m"),
        }

    def tables(self, found: Mapping[str, Any]) -> Iterator[SmallTable]:
        for name in ("steps", "cells"):
            keys = found[name][AT]
            rows = [(str(n), *(f"{each[key]:.5g}" for key in keys)) for n, each in found[name].items()]
            if name == "steps":
                rows.append(("limit", *(f"{limit(found[name], key)[0]:.5g}" for key in keys)))
                rows.append(("ratio of changes", *(f"{limit(found[name], key)[1]:.2f}" for key in keys)))
            yield SmallTable(f"By the {name} in a contact radius, in m and 1", (f"{name} in a", *keys), rows)
        rows = [(key, f"{value:.5g}", f"{known:.2g}") for key, (value, known) in found["single"].items()]
        yield SmallTable("A single run", ("quantity", "value", "uncertainty"), rows)

    def figures(self, found: Mapping[str, Any]) -> Iterator[Plot]:
        ends = {
            ("steps", "groove"): limit(found["steps"], "groove")[0],
            ("steps", "steady"): limit(found["steps"], "steady")[0],
            ("cells", "groove"): found["cells"][AT]["groove"] + of_cells(found["cells"], "groove"),
        }
        panels: dict[str, dict] = {"steps": {}, "cells": {}}
        for (name, key), end in ends.items():
            values = np.array([each[key] for each in found[name].values()])
            panels[name][key] = np.array(list(found[name])), np.abs(values / end - 1)
        words = (
            "Relative errors of the steady part of the track over the number of steps and of cells in a "
            f"radius, on cells of a/{AT} (left) and in steps of a/{AT} (right)."
        )
        title = "Error by the step along the path, and by the cells"
        yield Plot(errors_over_counts(panels), "errors", title, words, words)


CASES = (MovingSteps("moving-steps"),)
