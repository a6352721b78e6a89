# SPDX-License-Identifier: MIT
"""Extremes of the uncertainty: too coarse a grid, no load, singular stresses, accuracies of any size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from sam.scene import Scene
from verification.reference.hertz import CircularContact
from verification.robustness.matrix.elastic import both
from verification.robustness.matrix.row import (
    Check,
    Deviation,
    Expectation,
    Refused,
    Right,
    Row,
    Trial,
)
from verification.robustness.matrix.scenes import scene_with
from verification.runs.models import FEM, SAM

TOPIC = "uncertainty"
ASKED: dict[str, Any] = {"solver.uncertainty": True}
SAID = "0: it is as expected, 1: it is not"


def rows() -> Iterator[Row]:
    """Every row of the topic."""
    small = {"grid.cells": (17, 17), "fem.cells_per_radius": 6}
    none = both(Right("fewer than four cells in the radius of the coarsest", [without("p_max_Pa", "under-")]))
    yield row("coarse", "17 cells, 6 elements in the radius", small, none, quick=True)
    cells = {"grid.cells": (41, 41), "fem.cells_per_radius": 12, "fem.box": 30.0}
    yield row("hertz", "a closed form", cells, both(Right("it covers the error", [covers])), quick=True)
    few = {"fem.cells_per_radius": 9, "loading.force": 0.0}
    idle = {
        SAM: Right("no contact has no cells in it", [without("approach_m", "under-")]),
        FEM: Right("every value is zero", [zero]),
    }
    yield row("0", "no load", few, idle)
    punch = {"counterbody.shape": "punch", "fem.cells_per_radius": 9}
    singular = both(Right("it grows with every refinement", [without("p_max_Pa", "singular")]))
    yield row("punch", "a stress that is singular", punch, singular)
    other = Refused("its own change is none", ["solver.uncertainty = true", "extrapolate"])
    yield row("twice", "with extrapolation", {"solver.extrapolate": True}, both(other))
    found = both(Right("from coarse grids upwards, confirmed", [covers, reached]))
    yield row("far", "an accuracy of a half", {"grid": None, "solver.accuracy": 0.5}, found)
    yield row("near", "an accuracy of 0.1 %", {"grid": None, "solver.accuracy": 1e-3}, found)
    given = both(Refused("the cells are given", ["solver.accuracy = 0.01", "[grid]"]))
    yield row("given", "an accuracy on given cells", {"solver.accuracy": 0.01}, given)


def row(
    name: str,
    what: str,
    changes: Mapping[str, Any],
    expected: Mapping[str, Expectation],
    *,
    quick: bool = False,
) -> Row:
    """A row of the topic."""

    def make() -> Scene:
        return scene_with({**ASKED, **changes})

    return Row(f"uncertainty-{name}", TOPIC, what, make, expected, quick)


def without(name: str, words: str) -> Check:
    """A quantity has no uncertainty, and the reason has these words."""

    def check(trial: Trial) -> Iterator[Deviation]:
        entry = trial.result.uncertainty[name]
        right = entry["u_num"] is None and words in entry["flag"]
        yield Deviation(f"no uncertainty of {name}", float(not right), 0.5, SAID)

    return check


def covers(trial: Trial) -> Iterator[Deviation]:
    """The error of Hertz's pressure and approach is no larger than the uncertainty."""
    body, loading = trial.scene.body, trial.scene.loading
    modulus = body.young / (1 - body.poisson**2)
    exact = CircularContact(loading.force, trial.scene.counterbody.radius, modulus)
    for name, value in (("p_max_Pa", exact.peak_pressure), ("approach_m", exact.approach)):
        share = abs(trial.quantities[name] - value) / trial.result.uncertainty[name]["u_num"]
        yield Deviation(f"error of {name} over its uncertainty", share, 1.0, "what an uncertainty is")


def zero(trial: Trial) -> Iterator[Deviation]:
    """Nothing is uncertain where nothing happens."""
    entries = trial.result.uncertainty.values()
    yield Deviation("uncertainty", max(entry["u_num"] or 0.0 for entry in entries), 1e-30, "no load")


def reached(trial: Trial) -> Iterator[Deviation]:
    """The accuracy that was asked for."""
    found = trial.result.discretisation["accuracy"]
    yield Deviation("uncertainty over accuracy", found["relative"] / found["asked"], 1.0, "as asked")
