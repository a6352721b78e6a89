# SPDX-License-Identifier: MIT
"""What is measured of a sphere that moves is right on tracks and passes that are known."""

import numpy as np
import pytest
from made_results import Made

from verification.quantities import OF_TRACKS, QUANTITIES, Reference, Solved, refined


def run(n: int, *, depth: float = 1.0, strain: float = 1.0) -> Made:
    """A track whose values are off by 1/n^2 of themselves."""
    off, x = 1 - 1 / n**2, np.linspace(-2.0, 2.0, 9)
    track = {"x_m": x, "uz_m": depth * off * (1 + 0.1 * np.abs(x))}
    return Made({"groove_deepest_m": 1.2 * depth * off, "peeq_max": strain * off}, {"track": track})


def solved(results: dict[str, Made]) -> Solved:
    return Solved(None, Reference({}, {"a": 1.0}), results)


def test_limits_of_second_order_are_recovered_and_those_of_both_models_held_against_each_other():
    runs = {name: run(int(name[4:])) for name in ("sam-8", "sam-12")}
    runs |= {name: run(int(name[4:]), depth=1.03, strain=0.98) for name in ("fem-6", "fem-8")}
    runs["cost-sam-4"] = run(4, depth=9.0)  # of no model that is compared
    found = solved(runs)
    for name, sam, fem in (("groove", 1.0, 1.03), ("deepest", 1.2, 1.236), ("strain", 1.0, 0.98)):
        measured = QUANTITIES[f"{name}-refined"].whole(found)
        assert (measured.value, measured.expected) == pytest.approx((sam, fem), rel=1e-12)
    finest = 1.03 * (1 - 1 / 8**2)
    off = abs(1 - 1 / 12**2 - finest) / finest
    assert QUANTITIES["groove"].whole(found) == pytest.approx(off, rel=1e-12)
    assert refined({12: run(12)}, OF_TRACKS["largest plastic strain"]) == 1 - 1 / 12**2


def passed(energy, strain, verdict="shakedown", floor=7e-5) -> Made:
    tables = {"cycles": {"dissipated_J": energy}, "passes": {"new_strain_max": strain}}
    return Made({}, tables, verdict={"class": verdict, "floor": floor})


def test_passes_of_both_models_are_held_over_the_first_and_those_that_count_over_themselves():
    right = passed((4.0, 0.2, 0.03), (6e-3, 3e-4, 4e-5))
    other = passed((4.0, 0.3, 0.03), (6e-3, 6e-4, 4e-5), "settling")
    found = solved({"sam-12": right, "fem-6": other})
    values = {
        name: QUANTITIES[name].whole(found) for name in ("energy", "strain", "own-energy", "own-strain")
    }
    assert values == pytest.approx(
        {"energy": 0.025, "strain": 0.05, "own-energy": 1.0 / 3.0, "own-strain": 0.5}, rel=1e-12
    )
    assert QUANTITIES["counted"].whole(found) == 2.0 and QUANTITIES["verdict"].whole(found).value == 2.0
    assert QUANTITIES["shakes-down"].whole(solved({"sam-6": right})).value == 1.0
    assert QUANTITIES["alternates"].whole(solved({"sam-6": right})).value == 0.0
