# SPDX-License-Identifier: MIT
"""The cases of shakedown limits: each of their gates turns red when a number is wrong."""

from dataclasses import dataclass, field, replace

import pytest
from made_results import Made, red

from verification.cases import all_cases
from verification.cases.cyclic.shakedown_limits import (
    FRICTIONS,
    Found,
    Sides,
)

IN_PLACE, TRAVELLING, SPACE = (f"shakedown-limits{way}" for way in ("", "-travelling", "-space"))


@dataclass(frozen=True)
class Judged(Made):
    """A made result with a verdict."""

    verdict: dict = field(default_factory=dict)


def made(*strain: float, verdict: str = "alternating") -> Judged:
    return Judged(tables={"cycles": {"peeq_step_max": (1e-2, *strain)}}, verdict={"class": verdict})


def found(*, below=None, above=None, cells=1.01) -> Found:
    """Right numbers for each friction but the results that are given, which are those without friction."""
    right = Sides(made(1e-8, 0.0, verdict="shakedown"), made(1e-3, 1e-3))
    first = Sides(below or right.below, above or right.above)
    limits = dict.fromkeys(FRICTIONS, (4.6, 4.6 * cells))
    return Found({mu: right if mu else first for mu in FRICTIONS}, limits, made(1e-9, 0.0))


def judged(case: str, of: Found | dict[str, Sides]) -> set[str]:
    if case == IN_PLACE:
        of = replace(of, coarse=None)
    values = all_cases()[case].values(of)
    return red(case, {gate.removeprefix(f"{case}."): value for gate, value in values.items()}, whole=True)


def test_right_numbers_hold_every_gate():
    assert judged(IN_PLACE, found()) == judged(TRAVELLING, found()) == set()


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        ({"settles-0"}, found(below=made(1e-4, 1e-5))),
        ({"steady-0"}, found(above=made(1e-3, 0.97e-3))),
        ({"class-0"}, found(above=made(1e-3, 1e-3, verdict="settling"))),
        ({"steady-0"}, found(above=made(0.0, 0.0))),
    ],
    ids=["settles", "steady", "class", "nothing flows"],
)
def test_a_wrong_number_turns_its_gate_red(gates, wrong):
    assert judged(IN_PLACE, wrong) == gates


def test_coarse_cells_have_a_limit_too_high():
    """Those of a/6, on which the load 3 % above the limit of the body settles."""
    assert judged(TRAVELLING, found(cells=1.025)) == {"cells-0", "cells-01", "cells-02"}


def test_models_in_space_are_judged_by_themselves():
    right = Sides(made(1e-8, 0.0, verdict="shakedown"), made(1e-3, 1e-3))
    assert judged(SPACE, {"sam": right, "fem": right}) == set()
    flows = replace(right, below=made(1e-3, 9e-4, verdict="settling"))
    assert judged(SPACE, {"sam": right, "fem": flows}) == {"fem-settles", "fem-below"}
    fades = replace(right, above=made(1e-3, 9e-4, verdict="settling"))
    assert judged(SPACE, {"sam": fades, "fem": right}) == {"sam-steady", "sam-above"}
