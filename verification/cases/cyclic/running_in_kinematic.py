# SPDX-License-Identifier: MIT
"""Five materials that run in with back-stresses: does wear go on linearly? They have one curve of first
loading; the shares of kinematic hardening are assumed, no cyclic curve of the steel is known.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Plasticity
from verification.cases.case import SAM, Context, with_keys
from verification.cases.running_in import study
from verification.cases.running_in.study import MODULI, NAMES, RECOVERY, SHARES, Effort, Run

EFFORT = Effort(cycles=10, steps=4, cells=48)
FITTED, HALF = (1e-6, 0.03), EFFORT.cycles // 2


def back_stress(peeq: np.ndarray) -> np.ndarray:
    """Of all back-stresses on first loading, in Pa."""
    return np.sum([-c / g * np.expm1(-g * peeq) for c, g in zip(MODULI, RECOVERY, strict=True)], axis=0)


def misfit(law: Plasticity) -> float:
    """Largest relative error of the back-stresses."""
    peeq, start = np.geomspace(*FITTED, 200), float(study.swift(law, np.zeros(1))[0])
    return float(np.abs((start + back_stress(peeq)) / study.swift(law, peeq) - 1).max())


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each material and way to harden: volumes, m3, friction, strain over the isotropic less 1."""
    for case, base in study.printed_scenes(context, EFFORT).items():
        isotropic = None
        for way, share in SHARES.items():
            scene = with_keys(study.hardened(base, share), "solver", verdict=True)
            run = Run(scene, context.solve(SAM, scene, f"{case}-{share:g}".replace(".", "")))
            isotropic = isotropic or run
            yield {"material": NAMES[case], "hardening": way} | row(
                run, isotropic, misfit(base.body.plasticity)
            )


def row(run: Run, isotropic: Run, fit: float) -> dict[str, Any]:
    """Of a run, beside that of the same material with isotropic hardening."""
    wear, friction = run.of_cycles("wear_of_cycle_m3"), run.of_cycles("friction_coefficient")
    first = (each.result.tables["history"]["peeq_max"][EFFORT.steps - 1] for each in (run, isotropic))
    strain, reached = map(float, first)
    early, late = wear[:HALF].sum(), wear[HALF:].sum()
    return {
        "volume": wear.sum(),
        "late over early": late / early if early else 0.0,
        "friction, first": friction[0],
        "friction, last": friction[-1],
        "flowing volume, last": run.of_cycles("flowing_volume_m3")[-1],
        "first strain": strain,
        "reached": reached,
        "apart": abs(strain / reached - 1),
        "fit": fit,
        "converged": int(run.result.converged),
        "cycle": np.arange(EFFORT.cycles + 1),
        "wear-of-all": np.append(0.0, wear.cumsum()) / wear.sum() if wear.any() else None,
    }
