# SPDX-License-Identifier: MIT
"""Made histories of running-in, as the paper describes them, results of runs that went so, and frames of its
studies: no run of them is solved.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from made_results import Made

from sam.scene import load_scene
from verification.cases.running_in import study
from verification.cases.running_in.running_in_physics import ALL, RunningInPhysics
from verification.cases.running_in.running_in_sensitivity import INPUTS, Studied, scene_at
from verification.compare.running_in_measures import History
from verification.sensitivity import UNIFORM, design

CYCLES, N, FORCE = np.arange(1, 26), 8, 0.6 / 64  # cells of 1 um a side, and the load of a patch of them


def history(volume, friction=0.2, sa=2.7e-7, cycles=CYCLES) -> History:
    one = np.ones(cycles.size)
    return History(
        cycles.astype(float), np.asarray(volume, dtype=float), friction * one, sa * one, 0.5 * one, 5e9 * one
    )


def as_the_paper_says() -> dict[str, History]:
    """Made histories for which every statement holds."""
    early = 1e-17 * (1.0 - np.exp(-CYCLES))
    falls = np.linspace(0.25, 0.0, 25)
    linear = 1e-18 * CYCLES
    found = {
        study.BULK: history(early, 0.17),
        study.A: history(3e-17 + linear, sa=2.5e-7),
        study.B: history(5e-17 + linear, 0.1, 2.0e-7),
        "curve-b-ductile": history(4e-17 + linear, 0.1),
        study.HARDENING: history(early + 1e-20 * CYCLES),
    }
    found[study.A] = replace(found[study.A], friction=0.15 + falls)
    found[study.HARDENING] = replace(found[study.HARDENING], friction=0.14 + falls)
    return found


def at_rest(own: History, friction: float = 0.3) -> History:
    """Nothing wears after the first cycle, and friction stays at another value."""
    first = np.append(own.friction[0], np.full(own.cycle.size - 1, friction))
    return replace(own, volume=0.0 * own.volume + own.volume[0], friction=first)


def result_of(own: History, order: str = "C", **changes) -> Made:
    """A run with this history, half of its load on failed film, that strains until the last cycle. order: how
    rows of its surface run, y first or x first; changes: of the result.
    """
    x, p = (np.arange(N) - 3.5) * 1e-6, np.zeros((N, N))
    p[2:4, 2:6] = FORCE / 8 / 1e-12
    mu = np.where(p > 0, 0.1, np.nan)
    mu[3, 2:6] = 0.4
    worn = np.where(p > 0, 2.0, 0.0)
    worn[2, 2] = 5.0
    worn *= own.volume[-1] / (worn.sum() * 1e-12)
    places = {"x_m": x[:, None] + 0 * p, "y_m": x + 0 * p, "height_m": 1e-8 * np.arange(64.0).reshape(N, N)}
    peak = places | {"p_Pa": p, "worn_m": 0.5 * worn, "friction": mu}
    unloaded = places | {"p_Pa": 0.0 * p, "worn_m": worn, "friction": np.full_like(p, np.nan)}
    surface = {"state": ["peak"] * 64 + ["unloaded"] * 64}
    surface |= {name: np.concatenate([each[name].ravel(order) for each in (peak, unloaded)]) for name in peak}
    last = int(own.cycle[-1])
    cycles = {
        "cycle": own.cycle,
        "wear_volume_m3": own.volume,
        "friction_coefficient": own.friction,
        "sa_m": own.sa,
        "protected_fraction": own.protected,
        "p_max_Pa": own.p_max,
        "new_strain_max": np.linspace(0.02, 0.0, last),
        "yielding_cells": np.arange(last)[::-1],
        "wear_of_cycle_m3": np.diff(own.volume, prepend=0.0),
    }
    tables = {"cycles": cycles, "surface": surface}
    tables["history"] = {"cycle": own.cycle, "iterations": own.cycle[::-1]}
    return replace(Made(tables=tables, cost={"cpu_s": 2.0, "solve_s": 50.0}), **changes)


POINTS = 40
GOOD = "moves, rough, new in each pass; alternating friction; kinematic"
SCENES = {case: load_scene(f"verification/scenes/running-in-{case}.toml") for case in study.NAMES}


def verdicts(surfaces: Sequence[Mapping[str, History]]) -> list[dict]:
    """What is told of each statement on surfaces, of each of which there are the materials that converged."""
    runs = {}
    for k, case in ((k, case) for k in range(len(surfaces)) for case in study.NAMES):
        there = case in surfaces[k]
        own = surfaces[k][case] if there else history(CYCLES)
        runs["", case, k] = study.Run(SCENES[case], result_of(own, converged=there))
    return study.judged(study.measured(study.framed(runs, study.PARTS), ["surface"]))


def over_inputs() -> Studied:
    """As the paper says where the deviation of the layer is in the upper half; else no wear."""
    shares, said, runs = design(UNIFORM, len(INPUTS), POINTS, 1), as_the_paper_says(), {}
    deciding = [one.name for one in INPUTS].index("deviation")
    for point, case in np.ndindex(POINTS, len(study.NAMES)):
        name = list(study.NAMES)[case]
        own = said[name]
        if shares[point, deciding] < 0.5:
            own = history(0.0 * own.volume, 0.3, own.sa)
        runs[point, name, 7] = study.Run(
            scene_at(study.with_seed(SCENES[name], 7), shares[point]), result_of(own)
        )
    return Studied(study.framed(runs, study.PARTS), np.asarray(shares))


def over_physics():
    """As the paper says under one physics; under the others nothing wears after the first cycle."""
    runs = {
        (physics, name, 2): study.Run(SCENES[name], result_of(own if physics == GOOD else at_rest(own)))
        for physics in ALL
        for name, own in as_the_paper_says().items()
    }
    return framed_physics(runs)


def framed_physics(runs):
    return study.framed(runs, study.PARTS, RunningInPhysics.numbers)
