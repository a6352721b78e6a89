# SPDX-License-Identifier: MIT
"""How the groove of a rigid sphere depends on the step along the path, and on the cells."""

from collections.abc import Iterator, Mapping
from typing import Any

from sam.scene import Result, Scene
from verification.cases.case import SAM, Context
from verification.cases.recipes import on_track
from verification.quantities import refined
from verification.uncertainty import solving as uncertainty

STEPS = (1, 2, 4, 8, 16, 32)  # in the radius; the strain has no order before the last three
CELLS, AT = (6, 8, 12), 8  # in the radius; where the other is varied
SINGLE = {"cells": 10, "per_radius": 4}  # whose coarsest companion has 4 cells in the contact, the fewest
NAMES = {"groove": "groove_depth_m", "deepest": "groove_deepest_m", "strain": "peeq_max"}


def values_of(result: Result) -> dict[str, float]:
    """The quantities of NAMES, and "steady": the largest plastic strain of the steady part."""
    track = result.tables["track"]
    steady = max(p for p, steady in zip(track["peeq_max"], track["steady"], strict=True) if steady)
    return {key: float(result.quantities[name]) for key, name in NAMES.items()} | {"steady": float(steady)}


def limit(by_steps: Mapping[int, Mapping[str, float]], key: str) -> float:
    """Limit of the three finest steps, of the order that they have."""
    a, b, c = (by_steps[n][key] for n in STEPS[-3:])
    return c + (c - b) / ((b - a) / (c - b) - 1)


def of_cells(by_cells: Mapping[int, Mapping[str, float]], key: str) -> float:
    """What the two finest numbers of cells leave to add to those where the steps are varied."""
    return float(refined(by_cells, lambda values: values[key])) - by_cells[AT][key]


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """Values by the number of steps and of cells in a radius, in m and 1. limit: of short steps; refined: of
    fine cells; exact: of both. extrapolated: from coarse steps of a/4 and a/8, as of first order, and the
    same cells: those of a/6, a/8 and a/12 leave the strain of one cell within 0.6 %, in no order. covered:
    the error of a single run over its uncertainty.
    """
    base = context.scene("moving-sphere")

    def at(label: str, **keys: int) -> dict[str, float]:
        return values_of(context.solve(SAM, on_track(base, keys), label))

    def solved(scene: Scene, label: str) -> Result:
        return context.solve(SAM, scene, f"single, {label}")

    steps = {n: at(f"steps-{n}", cells=AT, per_radius=n) for n in STEPS}
    cells = {n: steps[AT] if n == AT else at(f"cells-{n}", cells=n, per_radius=AT) for n in CELLS}
    single = uncertainty.solve(
        uncertainty.asked_of(on_track(base, SINGLE), "moving-sphere.toml"), SAM, solved
    )
    short = {key: limit(steps, key) for key in steps[AT]}
    fine = {key: of_cells(cells, key) for key in steps[AT]}
    exact = {key: short[key] + fine[key] for key in fine}
    limits = {
        "limit": short,
        "refined": {key: cells[AT][key] + fine[key] for key in fine},
        "exact": exact,
        "extrapolated": {key: 2 * steps[8][key] - steps[4][key] + fine[key] for key in fine},
        "covered": {
            key: abs(single.quantities[name] - exact[key]) / single.uncertainty[name]["u_num"]
            for key, name in NAMES.items()
        },
    }
    for sweep, found, of in (("steps", steps, "limit"), ("cells", cells, "refined")):
        for n, values in found.items():
            errors = {f"{key}-error": abs(values[key] / limits[of][key] - 1) for key in ("groove", "steady")}
            yield {"sweep": sweep, "varied": sweep, "count": n} | values | errors
    yield from ({"sweep": "limits", "model": name} | values for name, values in limits.items())
