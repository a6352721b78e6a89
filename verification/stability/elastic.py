# SPDX-License-Identifier: MIT
"""Extremes of smooth elastic contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from sam.scene import Status
from verification.models import FEM, SAM
from verification.stability.checks import balanced, ellipse, hertz, nothing_touches, punch, same_as
from verification.stability.matrix import Absent, Expectation, Refused, Right, Row
from verification.stability.scenes import FORCE, scene_with

ORDINARY = "elastic contact is well posed"
OWN_MESH = Absent("grid.cells and grid.extent are of the semi-analytical model: the finite elements choose their own")
NO_ELLIPSE = Refused("no symmetry of rotation", ["counterbody.shape"])
INCOMPRESSIBLE = Refused("displacement elements divide by 1 - 2 nu", ["poisson", "< 0.5"])


def both(sam: Expectation, fem: Expectation | None = None) -> dict[str, Expectation]:
    """Model -> expectation; one for both if there is no other."""
    return {SAM: sam, FEM: fem or sam}


def row(name: str, topic: str, what: str, changes: Mapping[str, object], expected: Mapping[str, Expectation], quick=False) -> Row:
    """A row whose scene is the base with other values."""
    return Row(name, topic, what, partial(scene_with, changes), expected, quick)


def rows() -> Iterator[Row]:
    """All of them."""
    yield from poisson()
    yield from forces()
    yield from shapes()
    yield from grids()
    yield from steps_and_tolerances()


def poisson() -> Iterator[Row]:
    right = Right(ORDINARY, [hertz()])
    for value in (0.0, 0.4999):
        yield row(f"poisson-{value:g}", "poisson", f"ν = {value:g}", {"body.poisson": value}, both(right), quick=True)
    yield row("poisson-0.5", "poisson", "ν = 0.5", {"body.poisson": 0.5}, both(right, INCOMPRESSIBLE), quick=True)


def forces() -> Iterator[Row]:
    for force in (1e-15, 1e-9, 1e3, 1e6):
        yield row(
            f"force-{force:g}", "force", f"{force:g} N; p0 goes with the cube root", {"loading.force": force},
            both(Right("no length but the radius: the same contact, scaled", [hertz(), balanced])), quick=force in (1e-15, 1e6),
        )  # fmt: skip
    yield row("force-0", "force", "0 N", {"loading.force": 0.0}, both(Right("nothing touches", [nothing_touches])), quick=True)


def shapes() -> Iterator[Row]:
    return iter(())


def grids() -> Iterator[Row]:
    return iter(())


def steps_and_tolerances() -> Iterator[Row]:
    return iter(())
