# SPDX-License-Identifier: MIT
"""Extremes of smooth elastic contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from sam.scene import Status
from verification.robustness.matrix.checks import (
    balanced,
    ellipse,
    force_of_hertz,
    hertz,
    nothing_touches,
    punch,
    rounded_punch,
    same_as,
)
from verification.robustness.matrix.row import Absent, Expectation, Refused, Right, Row
from verification.robustness.matrix.scenes import BEYOND, CELLS, HERTZ, POISSON, RADIUS, YOUNG, scene_with
from verification.runs.models import FEM, FEM_3D, SAM

ORDINARY = "elastic contact is well posed"
OWN_MESH = Absent(
    "grid.cells and grid.extent are of the semi-analytical model: the finite elements choose their own"
)
NO_ELLIPSE = Refused("no symmetry of rotation", ["counterbody.shape"])
ELLIPSOID = {"counterbody.shape": "ellipsoid", "counterbody.radius": None}
NO_PUNCH = Refused("its nodes do not follow a circle", ["counterbody.shape", '"sphere" or "ellipsoid"'])
RIGID = Refused("it has no mesh of a second body", ["counterbody.young", "rigid"])
UNTOUCHED = Right("nothing touches", [nothing_touches])
INCOMPRESSIBLE = Refused("displacement elements divide by 1 - 2 nu", ["poisson", "< 0.5"])


def both(
    sam: Expectation, fem: Expectation | None = None, spatial: Expectation | None = None
) -> dict[str, Expectation]:
    """Model -> expectation; one for both if there is no other; spatial: where the three-dimensional one is
    asked.
    """
    return {SAM: sam, FEM: fem or sam} | ({FEM_3D: spatial} if spatial else {})


def row(
    name: str,
    topic: str,
    what: str,
    changes: Mapping[str, Any],
    *,
    expected: Mapping[str, Expectation],
    quick=False,
) -> Row:
    """A row whose scene is the base with other values."""
    return Row(name, topic, what, partial(scene_with, changes), expected, quick)


def rows() -> Iterator[Row]:
    """All of them."""
    yield from poisson()
    yield from forces()
    yield from approaches()
    yield from shapes()
    yield from grids()
    yield from steps_and_tolerances()


def poisson() -> Iterator[Row]:
    """Extremes of Poisson's ratio."""
    right = Right(ORDINARY, [hertz()])
    for value in (0.0, 0.4999):
        yield row(
            f"poisson-{value:g}",
            "poisson",
            f"ν = {value:g}",
            {"body.poisson": value},
            expected=both(right),
            quick=True,
        )
    yield row(
        "poisson-0.5",
        "poisson",
        "ν = 0.5",
        {"body.poisson": 0.5},
        expected=both(right, INCOMPRESSIBLE, INCOMPRESSIBLE),
        quick=True,
    )


def forces() -> Iterator[Row]:
    """Extremes of the force."""
    for force in (1e-15, 1e-9, 1e3, 1e6):
        yield row(
            f"force-{force:g}", "force", f"{force:g} N; p0 goes with the cube root",
            {"loading.force": force} | (BEYOND if force > 1.0 else {}),
            expected=both(Right("no length but the radius: the same contact, scaled", [hertz(), balanced])),
            quick=force in (1e-15, 1e6),
        )  # fmt: skip
    yield row(
        "force-0",
        "force",
        "0 N",
        {"loading.force": 0.0},
        expected=both(UNTOUCHED, UNTOUCHED, UNTOUCHED),
        quick=True,
    )


def approaches() -> Iterator[Row]:
    """Extremes of an approach that is given in place of the force."""
    for approach in (1e-18, 1e-9, 1e-6):
        yield row(
            f"approach-{approach:g}", "approach", f"{approach:g} m; F goes with its power 3/2",
            {"loading.force": None, "loading.approach": approach},
            expected=both(Right("no length but the radius: the same contact, scaled", [force_of_hertz])),
            quick=approach == 1e-18,
        )  # fmt: skip


def shapes() -> Iterator[Row]:
    """Extremes of the radii of the counter-body."""
    for ratio in (354.0, 1e-4, 1e4):
        yield row(
            f"radii-{ratio:g}", "aspect", f"ellipsoid, Ry/Rx = {ratio:g}; cells as slender as the contact",
            ELLIPSOID | {"counterbody.radius_x": RADIUS, "counterbody.radius_y": ratio * RADIUS}
            | (BEYOND if ratio < 1.0 else {}),
            expected=both(Right(ORDINARY, [ellipse(), balanced]), NO_ELLIPSE), quick=ratio == 354.0,
        )  # fmt: skip
    slender = Refused("a line contact on every grid that is allowed", ["radius_y", "radius_x/radius_y"])
    changes = ELLIPSOID | {"counterbody.radius_x": RADIUS, "counterbody.radius_y": 1e5 * RADIUS}
    yield row(
        "radii-1e5", "aspect", "ellipsoid, Ry/Rx = 1e5", changes, expected=both(slender, slender, slender)
    )
    flat = {"counterbody.shape": "punch", "counterbody.radius": 1e-5}
    sam, fem = (
        Right("rigid in its own radius", [punch(0.02), balanced]),
        Right("rigid in its own radius", [punch(0.004)]),
    )
    yield row(
        "punch",
        "punch",
        "flat-ended cylinder: pressure singular at its edge",
        flat,
        expected=both(sam, fem, NO_PUNCH),
        quick=True,
    )
    none = flat | {"loading.force": 0.0}
    yield row("punch-0", "punch", "the same, 0 N", none, expected=both(UNTOUCHED, UNTOUCHED, NO_PUNCH))
    yield from rounded_edges()
    for ratio in (1e-6, 1e6):
        changes = {"counterbody.young": ratio * YOUNG, "counterbody.poisson": POISSON}
        name, two = "softer" if ratio < 1 else "stiffer", Right("E* of both", [hertz()])
        what = f"counter-body {max(ratio, 1 / ratio):g} times {name}"
        changes |= BEYOND if ratio < 1 else {}
        yield row(f"counter-{ratio:g}", "counter-body", what, changes, expected=both(two, two, RIGID))


def rounded_edges() -> Iterator[Row]:
    """Extremes of a punch with a rounded edge: nearly a sphere, nearly sharp, and what has too few cells."""
    shape = {"counterbody.shape": "rounded-punch", "grid": None}
    for flat, edge, what in (
        (1e-12, RADIUS, "a flat end of 1e-7 contact radii: a sphere"),
        (1e-5, RADIUS, "the contact ends 8 % beyond the flat end"),
        (1e-5, 1e-6, "the contact ends 0.4 % beyond the flat end"),
    ):
        sam: Expectation = Right("the gap is continuous", [rounded_punch(), balanced])
        if edge == 1e-6:
            sam = Refused("more cells than are chosen", ["counterbody.radius", "1025 x 1025", "raise it"])
        changes = shape | {"counterbody.flat_radius": flat, "counterbody.radius": edge}
        fem = Right("the mesh is graded to the flat end", [rounded_punch()])
        yield row(
            f"edge-{flat:g}-{edge:g}",
            "edge of a punch",
            what,
            changes,
            expected=both(sam, fem, NO_PUNCH),
            quick=True,
        )
    coarse: dict[str, Any] = shape | {"grid": {"cells": (CELLS, CELLS)}}
    coarse |= {"counterbody.flat_radius": 1e-5, "counterbody.radius": 1e-5}
    few = Refused("2 cells or fewer in the edge", ["grid.cells = [33, 33]", "at least"])
    yield row(
        "edge-coarse", "edge of a punch", "too few cells", coarse, expected=both(few, OWN_MESH, NO_PUNCH)
    )
    none = coarse | {"loading.force": 0.0}
    nothing = both(UNTOUCHED, UNTOUCHED, NO_PUNCH)
    yield row("edge-0", "edge of a punch", "the same, 0 N", none, expected=nothing)


def grids() -> Iterator[Row]:
    """Extremes of the grid."""

    def of_sam(
        name: str, topic: str, what: str, changes: Mapping[str, Any], *, expected: Expectation, quick=False
    ) -> Row:
        return row(name, topic, what, changes, expected={SAM: expected, FEM: OWN_MESH}, quick=quick)

    few = Refused(
        "p0 is off by more than 1 %", ["too few cells", "grid.cells", "grid.extent"], Status.UNDER_RESOLVED
    )
    cut = Refused("the contact is cut off", ["grid.extent", "loading.force"], Status.CONTACT_AT_GRID_EDGE)
    wide = {"grid.extent": (100 * HERTZ, 100 * HERTZ)}
    yield of_sam("one-cell", "one cell", "one cell in contact", wide, expected=few, quick=True)
    yield of_sam("coarse-grid", "too coarse", "2 cells in the radius", {"grid.cells": (9, 9)}, expected=few)
    yield of_sam("three-cells", "too coarse", "3 x 3 cells", {"grid.cells": (3, 3)}, expected=few)
    least = Refused("no grid", ["grid.cells", "3 to 4097"])
    yield row(
        "two-cells", "too coarse", "2 x 2 cells", {"grid.cells": (2, 2)}, expected=both(least, least, least)
    )
    small = Absent("fem.cells_per_radius is of the finite elements")
    few = Refused("p0 is off by more than 1 %", ["fem.cells_per_radius"], Status.UNDER_RESOLVED)
    yield row(
        "coarse-mesh",
        "too coarse",
        "2 elements in the radius",
        {"fem.cells_per_radius": 2},
        expected=both(small, few),
        quick=True,
    )
    half = {"grid.extent": (2 * HERTZ, 2 * HERTZ)}
    yield of_sam("edge", "edge", "contact up to the edge of the grid", half, expected=cut, quick=True)
    along_x = {"grid.extent": (4 * HERTZ, HERTZ)}
    yield of_sam("edge-y", "edge", "contact beyond two edges of the grid", along_x, expected=cut)
    inside = {"grid.extent": (HERTZ, HERTZ)}
    yield of_sam("all-cells", "all cells", "sphere, all cells in contact", inside, expected=cut)
    long, short = 4 * HERTZ, 4.3 * HERTZ
    for name, cells, extent in (("x", (751, 15), (long, short)), ("y", (15, 751), (short, long))):
        fine = Right("7 cells in the radius one way, 188 the other", [hertz(0.006, 0.003), balanced])
        changes = {"grid.cells": cells, "grid.extent": extent}
        yield of_sam(f"cells-1:54-{name}", "aspect", "cells 54 times as long as wide", changes, expected=fine)


def steps_and_tolerances() -> Iterator[Row]:
    """Extremes of the number of load steps and of the tolerance."""
    one = same_as({"loading.steps": 1}, 1e-6, "elastic: no path; each step within solver.tolerance")
    right = Right("elastic: the way to the peak does not matter", [one, hertz()])
    yield row("steps-200", "steps", "200 load steps, elastic", {"loading.steps": 200}, expected=both(right))
    yield row(
        "steps-1",
        "steps",
        "1 load step, elastic",
        {"loading.steps": 1},
        expected=both(Right(ORDINARY, [hertz()])),
    )
    many = Refused("a thousand is the most that is kept", ["loading.steps", "1 to 1000"])
    yield row(
        "steps-1001", "steps", "1001 load steps", {"loading.steps": 1001}, expected=both(many, many, many)
    )
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-12):
        twin = same_as({"solver.tolerance": 1e-6}, 1e-6, "1e-4 of the coarser tolerance, or rounding")
        yield row(
            f"tolerance-{tolerance:g}", "tolerance", f"elastic, solver.tolerance = {tolerance:g}",
            {"solver.tolerance": tolerance},
            expected=both(Right("a tolerance above rounding can be met", [twin, hertz()])),
            quick=tolerance == 1e-12,
        )  # fmt: skip
    below = Refused("below rounding of a double", ["solver.tolerance", "1e-14 to 0.1"])
    yield row(
        "tolerance-1e-15",
        "tolerance",
        "solver.tolerance = 1e-15",
        {"solver.tolerance": 1e-15},
        expected=both(below, below, below),
    )
