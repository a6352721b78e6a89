# SPDX-License-Identifier: MIT
"""Made histories of running-in, as the paper describes them."""

from dataclasses import replace

import numpy as np

from verification.cases.running_in.scenes import BULK, HARDENING, A, B
from verification.compare.running_in_measures import History

CYCLES = np.arange(1, 26)


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
