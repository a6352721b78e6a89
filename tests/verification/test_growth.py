# SPDX-License-Identifier: MIT
"""Growth of time and memory: exponents, processes that measure themselves alone, the published code."""

import os

import numpy as np
import pandas as pd
import pytest
from builders import PERFECT, SWIFT, scene
from made_results import of_frame, red

from sam.scene import parse_scene
from verification.cases.cost import published_code
from verification.cost import estimates
from verification.cost.measured import alone, idle_bytes
from verification.reference.convergence import fit_power
from verification.runs.models import FEM, SAM, check
from verification.runs.threads import EVERY_LIBRARY as THREADS

CELLS = np.array([1e3, 4e3, 16e3, 64e3])


def test_a_power_is_found():
    exact = fit_power(CELLS, 3e-7 * CELLS**1.2)
    assert (exact.exponent, exact.factor) == pytest.approx((1.2, 3e-7), rel=1e-12)
    assert exact.error < 1e-12 and exact(1e3) == pytest.approx(3e-7 * 1e3**1.2)


def test_a_power_needs_three_points_in_its_range():
    assert fit_power(CELLS, CELLS, first=4e3).first == 4e3
    bent = fit_power(CELLS[:3], CELLS[:3] * [1.0, 1.2, 1.0])
    assert bent.exponent == pytest.approx(1.0)
    assert bent.error == pytest.approx(np.log(1.2) / np.log(4.0) / np.sqrt(3.0))
    for x, y, first in (
        (CELLS[:2], CELLS[:2], 0),
        (CELLS[[0, 1, 1]], CELLS[:3], 0),
        (CELLS, CELLS[:3], 0),
        (CELLS, CELLS, 1e4),
        (CELLS, -CELLS, 0),
        (CELLS, CELLS * [1, 0, 1, 1], 0),
        (CELLS, CELLS * np.nan, 0),
    ):
        with pytest.raises(ValueError, match="x and y"):
            fit_power(x, y, first)


def test_a_process_measures_its_own_memory_and_one_thread():
    """Also after this process had much more memory than it has."""
    idle, before = idle_bytes(SAM), {name: os.environ.get(name) for name in THREADS}
    large = np.ones(40_000_000)
    assert large.nbytes > 2 * idle
    del large
    assert idle_bytes(SAM) < 1.3 * idle  # more than twice as much if it began with that of this process
    assert alone(os.getenv, THREADS[0]) == "1" and {name: os.environ.get(name) for name in THREADS} == before


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_yielding_body_without_a_load_has_an_estimate(model):
    none = scene(body={"plasticity": SWIFT}, loading={"force": 0.0})
    assert estimates.load_ratio(none, np.zeros(1))[0] == 0.0
    assert np.isfinite(estimates.estimate(none, model).time_s)


def test_back_stresses_count_by_what_they_add_at_one_per_cent():
    """0.01 C_1 + C_2 (1 - exp(-0.01 g))/g over the yield stress, and nothing without any."""
    kinematic = {"modulus": (50e9, 100e9), "recovery": (0.0, 300.0)}
    added = 0.01 * 50 + 100 * (1 - np.exp(-3.0)) / 300
    for law, expected in ((PERFECT, 0.0), (PERFECT | {"kinematic": kinematic}, added)):
        found = estimates._back_hardening(scene(body={"plasticity": law}), np.array([1e-6, 2e-6]))
        assert found == pytest.approx(expected, rel=1e-13)


# against the published code


def took(time: float = 1.0, ffts: int = 100, **quantities) -> dict:
    """What a solve took, counted and found."""
    counts = {"ffts": ffts, "step_cuts": max(ffts - 104, 0)}
    found = {"p_max_Pa": 1e9, "p_center_Pa": 1e-3, "contact_spots": None} | quantities
    return {"time": time, "memory": 1e8, "counts": counts, "quantities": found, "tolerance": 1e-4}


@pytest.mark.parametrize(("ffts", "wrong"), [(90, set()), (105, set()), (106, {"counts"}), (107, {"counts"})])
def test_a_count_may_grow_by_two_or_a_twentieth(ffts, wrong):
    pairs = [(took(), took(time, ffts, p_max_Pa=1.1e9, p_center_Pa=2e-3)) for time in (3.0, 1.0, 1.5)]
    row = published_code.row_of(pairs)
    assert (row["time ratio"], row["time ratio of pairs"], row["time [s]"]) == (1.5, "1.00 to 3.00", 1.5)
    assert row["counts"].startswith(f"ffts 100 {ffts - 100:+d}") and row["most different"] == "p_max_Pa"
    assert row["difference"] == pytest.approx(0.1)
    frame = pd.DataFrame([{"sweep": "", "model": ""} | row])
    assert red("published-code", of_frame("published-code", frame)) == wrong


def test_the_scenes_for_the_published_code_are_read_and_can_be_solved():
    for rung in published_code.RUNGS:
        check(parse_scene(rung.text(published_code.ROOT).encode(), rung.file), rung.model)
    with pytest.raises(RuntimeError, match="0 lines of cycles"):
        published_code.Rung("", "hertz-sphere", {"cycles": "2"}).text(published_code.ROOT)
