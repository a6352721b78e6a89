# SPDX-License-Identifier: MIT
"""The case of running-in with back-stresses: its laws have one curve, and each gate turns red."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import Made, red

from sam.scene import Plasticity
from verification.cases import all_cases
from verification.cases.cyclic.running_in_kinematic import (
    EFFORT,
    FITTED,
    MODULI,
    RECOVERY,
    SHARES,
    Found,
    Run,
    back_stress,
    hardened,
    swift,
)

CASE = "running-in-kinematic"
LAW = Plasticity(law="swift", B=1780e6, C=4.0, n=0.095, alpha=1e6)


@pytest.mark.parametrize("share", SHARES.values(), ids=SHARES)
def test_all_ways_have_one_curve_of_first_loading(share):
    law, peeq = hardened(LAW, share), np.geomspace(*FITTED, 50)
    stress = law.curve().stress(peeq)
    if share:
        constants = zip(law.kinematic.modulus, law.kinematic.recovery, strict=True)
        stress = stress + sum(c / g * (1 - np.exp(-g * peeq)) for c, g in constants)
    assert stress == pytest.approx(swift(LAW, peeq), rel=0.02 if share < 1 else 0.005)


def made(first=1e-3, wear=(2.0, 1.0), converged=True) -> Run:
    half = EFFORT.cycles // 2
    cycles = {"wear_of_cycle_m3": np.repeat(wear, half) * 1e-18}
    history = {"peeq_max": [0.0] * (EFFORT.steps - 1) + [first]}
    return Run(Made(tables={"cycles": cycles, "history": history}, converged=converged))


def found(**kinematic) -> Found:
    ways = {name: made(**(kinematic if name == "kinematic" else {})) for name in SHARES}
    peeq = np.geomspace(*FITTED, 50)
    fit = np.abs((swift(LAW, np.zeros(1)) + back_stress(peeq)) / swift(LAW, peeq) - 1).max()
    return Found(float(fit), dict.fromkeys(("bulk", "A", "B", "C", "D"), ways))


def judged(of: Found) -> set[str]:
    values = all_cases()[CASE].values(of)
    return red(CASE, {gate.removeprefix(f"{CASE}."): value for gate, value in values.items()}, whole=True)


def test_right_numbers_hold_every_gate():
    assert judged(found()) == set() and len(MODULI) == len(RECOVERY) == 5
    assert found().runs["bulk"]["kinematic"].late == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        ({"fit"}, replace(found(), fit=0.01)),
        ({"first-loading"}, found(first=1.2e-3)),
        ({"converged"}, found(converged=False)),
    ],
)
def test_a_wrong_number_turns_its_gate_red(gates, wrong):
    assert judged(wrong) == gates
