# SPDX-License-Identifier: MIT
"""Made results of the studies of running-in over inputs and over physics: no run of them is solved."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from made_histories import as_the_paper_says

from verification.cases.running_in import (
    running_in_physics as physics_study,
    running_in_sensitivity as inputs_study,
)
from verification.cases.running_in.running_in_physics import ALL, Counter, Physics
from verification.cases.running_in.running_in_sensitivity import INPUTS, Studied, scene_at
from verification.cases.running_in.scenes import NAMES
from verification.sensitivity import UNIFORM, design

POINTS = 40
GOOD = Physics(Counter.MOVES_RENEWED, "alternating", "kinematic")


def over_inputs(printed) -> Studied:
    """As the paper says where the deviation of the layer is in the upper half; else nothing wears. printed:
    the scene of each material.
    """
    shares = design(UNIFORM, len(INPUTS), POINTS, 1)
    deciding = [one.name for one in INPUTS].index("deviation")
    runs = {}
    for point, case in np.ndindex(POINTS, len(NAMES)):
        name = list(NAMES)[case]
        history = as_the_paper_says()[name]
        if shares[point, deciding] < 0.5:
            history = replace(history, volume=0.0 * history.volume, friction=0.0 * history.friction + 0.3)
        result = SimpleNamespace(converged=True, cost={"cpu_s": 2.0})
        scene = scene_at(printed[name], shares[point], 7)
        runs[point, name] = SimpleNamespace(history=history, result=result, scene=scene)
    return Studied(inputs_study.EFFORTS["full"][1], shares, runs, 400.0, printed)


def ran(history) -> SimpleNamespace:
    """A run of the study over physics."""
    result = SimpleNamespace(converged=True, cost={"cpu_s": 2.0})
    return SimpleNamespace(history=history, result=result, of_cycles=lambda _name: np.zeros(25))


def over_physics() -> physics_study.Found:
    """As the paper says under one physics; under the others nothing wears after the first cycle."""
    said, runs = as_the_paper_says(), {}
    for physics in ALL:
        for name in NAMES:
            own = said[name]
            if physics != GOOD:
                own = replace(own, volume=0.0 * own.volume + own.volume[0], friction=0.0 * own.friction + 0.3)
                own.friction[0] = said[name].friction[0]
            runs[physics, name] = ran(own)
    return physics_study.Found(runs, 400.0)
