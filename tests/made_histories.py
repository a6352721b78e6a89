# SPDX-License-Identifier: MIT
"""Made histories of running-in, as the paper describes them, and results of runs that went so."""

from dataclasses import replace

import numpy as np
from made_results import Made

from verification.cases.running_in.study import BULK, HARDENING, A, B
from verification.compare.running_in_measures import History

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
        BULK: history(early, 0.17),
        A: history(3e-17 + linear, sa=2.5e-7),
        B: history(5e-17 + linear, 0.1, 2.0e-7),
        "curve-b-ductile": history(4e-17 + linear, 0.1),
        HARDENING: history(early + 1e-20 * CYCLES),
    }
    found[A] = replace(found[A], friction=0.15 + falls)
    found[HARDENING] = replace(found[HARDENING], friction=0.14 + falls)
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
