# SPDX-License-Identifier: MIT
"""Passes of a rigid sphere over a track, with and without friction, on steel and on perfect plasticity."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from sam.scene import Friction, Plasticity, Scene
from verification.cases.case import SAM, Context, with_body, with_keys
from verification.cases.recipes import initial_yield, on_track

CELLS = {"quick": 4, "full": 8}  # in the radius
STEEL = {
    "one-way": (0.0, False),
    "to-and-fro": (0.0, True),
    "friction-one-way": (0.2, False),
    "friction-to-and-fro": (0.2, True),
}
"""Coefficient of friction, and whether the sphere goes to and fro; with friction at the full level."""
PERFECT = {"settles": (2.2, "shakedown"), "flows": (4.0, "alternating")}
"""p0 over the yield stress of perfect plasticity, and what becomes of it, in eight passes."""
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


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """What each pass adds, and the groove that each leaves in m. conservative: half the difference of the
    forces of the last passes, forth and back, over that of the first pass; falls: the least factor from one
    pass to the next, of the first; right: whether the verdict is the expected one.
    """
    for name, scene in scenes(context.scene("moving-sphere"), context.level):
        result = context.solve(SAM, scene, f"perfect-{name}" if name in PERFECT else name)
        strain, groove, rolling = (
            np.asarray(result.tables["passes"][each], dtype=float)
            for each in ("new_strain_max", "groove_m", "rolling")
        )
        row = {"run": name, "groove": groove[-1], "last": strain[-1], "before": strain[-2]}
        row |= {"new-strain": strain, "pass": np.arange(1, strain.size + 1)}
        row["conservative"] = float((rolling[-1] - rolling[-2]) / 2 / rolling[0])
        row["steady"] = result.quantities["passes_to_steady"]
        if name in PERFECT:
            history, verdict = result.tables["history"], result.verdict
            loaded = np.flatnonzero(np.array(history["force_N"]) > 0)[-1]
            row["falls"] = float(min(one / two for one, two in pairwise(strain[:LARGE])))
            row |= {"pressure": history["p_max_Pa"][loaded], "verdict": str(verdict["class"])}
            row["right"] = float(verdict["class"] == PERFECT[name][1])
        yield row
