# SPDX-License-Identifier: MIT
"""Made frames of the studies of running-in over surfaces, inputs and physics: no run of them is solved."""

from collections.abc import Mapping, Sequence

import numpy as np
from made_histories import CYCLES, as_the_paper_says, at_rest, history, result_of

from sam.scene import load_scene
from verification.cases.running_in.running_in_physics import ALL, RunningInPhysics
from verification.cases.running_in.running_in_sensitivity import INPUTS, Studied, scene_at
from verification.cases.running_in.study import NAMES, PARTS, Run, framed, judged, measured, with_seed
from verification.compare.running_in_measures import History
from verification.sensitivity import UNIFORM, design

POINTS = 40
GOOD = "moves, rough, new in each pass; alternating friction; kinematic"
SCENES = {case: load_scene(f"verification/scenes/running-in-{case}.toml") for case in NAMES}


def verdicts(surfaces: Sequence[Mapping[str, History]]) -> list[dict]:
    """What is told of each statement on surfaces, of each of which there are the materials that converged."""
    runs = {}
    for k, case in ((k, case) for k in range(len(surfaces)) for case in NAMES):
        there = case in surfaces[k]
        own = surfaces[k][case] if there else history(CYCLES)
        runs["", case, k] = Run(SCENES[case], result_of(own, converged=there))
    return judged(measured(framed(runs, PARTS), ["surface"]))


def over_inputs(**changed: History) -> Studied:
    """As the paper says where the deviation of the layer is in the upper half, or `changed`; else no wear."""
    shares, said, runs = design(UNIFORM, len(INPUTS), POINTS, 1), as_the_paper_says() | changed, {}
    deciding = [one.name for one in INPUTS].index("deviation")
    for point, case in np.ndindex(POINTS, len(NAMES)):
        name = list(NAMES)[case]
        own = said[name]
        if shares[point, deciding] < 0.5:
            own = history(0.0 * own.volume, 0.3, own.sa)
        runs[point, name, 7] = Run(scene_at(with_seed(SCENES[name], 7), shares[point]), result_of(own))
    return Studied(framed(runs, PARTS), np.asarray(shares))


def over_physics(**changed: History):
    """As the paper says under one physics; under the others nothing wears after the first cycle."""
    said = as_the_paper_says() | changed
    runs = {
        (physics, name, 2): Run(SCENES[name], result_of(own if physics == GOOD else at_rest(own)))
        for physics in ALL
        for name, own in said.items()
    }
    return framed_physics(runs)


def framed_physics(runs):
    return framed(runs, PARTS, RunningInPhysics.numbers)
