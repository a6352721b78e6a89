# SPDX-License-Identifier: MIT
"""What is varied about the running-in cases: everything that the paper leaves open, one at a time, on one
surface.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from sam.scene import Scene
from verification.cases.case import with_keys
from verification.cases.running_in.running_in_scenes import (
    DEVIATIONS,
    LITERATURE_B,
    deeper,
    with_deviation,
    with_plasticity,
)
from verification.cases.running_in.running_in_statements import BULK, NAMES, B

WINDOWS = (0, 3, 7)  # cells; the scenes have 5
CURVE_C = "running-in-curve-c"


def varied_scenes(bases: Mapping[str, Scene], read: Callable[[str], Scene]) -> dict[str, tuple[str, Scene]]:
    """Name for the reader -> (label of the run, scene). read: the scene of a name, for its tables."""
    curve = read(CURVE_C).body.plasticity.profile
    scenes = {"curve C": ("curve-c", with_plasticity(bases[B], profile=curve))}
    for scale in DEVIATIONS:
        scenes[f"curve B, deviation × {scale:g}"] = (
            f"curve-b-deviation-{scale:g}",
            with_deviation(bases[B], scale),
        )
    for case in (BULK, B):
        name = f"{NAMES[case]}, B = {LITERATURE_B / 1e6:g} MPa"
        scenes[name] = (f"{case}-1280", deeper(with_plasticity(bases[case], B=LITERATURE_B)))
    for window in WINDOWS:
        scenes[f"bulk, window {window}"] = (
            f"bulk-window-{window}",
            with_keys(bases[BULK], "wear", smoothing_window=window),
        )
    return scenes
