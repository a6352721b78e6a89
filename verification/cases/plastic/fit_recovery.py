# SPDX-License-Identifier: MIT
"""Parameters that are drawn come back from data that SAM makes with noise, by a fit of finite elements.

Both models were solved once, at the nodes of a design in the logarithms of the parameters; in between their
depths are quadratics, `data/fit_recovery.csv`: in columns the law, the test, the model ("fine" and "coarse":
the two grids of a fit by finite elements), the coordinates of the node, -1 to 1 each, the largest strain, the
depth of the dent on the axis, and the depths at twenty equal steps of the force, all in m.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import resources
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import Context
from verification.fit import Fitted, definition_of, fit
from verification.fit.definition import Definition, Test, Variables
from verification.fit.fitting import QUANTILE
from verification.fit.solves import Answer

if TYPE_CHECKING:
    from pandas import DataFrame

NOISES = (0.005, 0.01, 0.03)
DRAWS = 40
INSIDE = 0.6
"""Coordinates of a draw are uniform between plus and minus this."""
SHARE = np.linspace(0.05, 1.0, 20)
YIELD = "body.plasticity.yield_stress"
LAWS: dict[str, tuple[dict[str, Any], dict[str, list[float]], list[float]]] = {
    "linear": (
        {"law": "linear", "yield_stress": 600e6, "modulus": 15e9},
        {YIELD: [400e6, 600e6, 900e6], "body.plasticity.modulus": [7.5e9, 15e9, 30e9]},
        [10.0],
    ),
    "swift": (
        {"law": "swift", "B": 87.5e6, "C": 2000.0, "n": 0.2},
        {
            "body.plasticity.B": [60e6, 87.5e6, 127e6],
            "body.plasticity.C": [700.0, 2000.0, 5700.0],
            "body.plasticity.n": [0.16, 0.2, 0.25],
        },
        [2.0, 20.0],
    ),
}
"""Law -> what is known of it, its unknowns with their bounds, and the forces of its tests in N."""


def recovered(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each law and noise, of all draws."""
    for law in table()["law"].unique():
        for noise in NOISES:
            draws = np.random.default_rng(7)
            found = [one(law, noise, draws) for _ in range(DRAWS)]
            context.progress(f"{context.case}, {law}, noise {100 * noise:g} %", 1, 1)
            means = {name: float(np.mean([each[name] for each in found])) for name in ("inside",)}
            medians = {
                n: float(np.median([each[n] for each in found])) for n in ("wide", "curve-error", "linked")
            }
            yield {"sweep": "recovered", "law": law, "noise": noise, **means, **medians}


def one(law: str, noise: float, draws: np.random.Generator) -> dict[str, float]:
    """inside: share of the parameters in their 90 % confidence; wide: half-widths over the bound of Cramer
    and Rao; curve-error: largest relative error of the yield curve, from 1e-4 to the largest strain; linked:
    the largest correlation.
    """
    _, unknown, _ = LAWS[law]
    at = draws.uniform(-INSIDE, INSIDE, len(unknown))
    true = {name: value(bounds, u) for (name, bounds), u in zip(unknown.items(), at, strict=True)}
    made = measured(law, true, noise, draws)
    found = fit(made, answer, ahead=False)
    inside = [low <= true[name] <= high for name, (low, high) in found.intervals.items()]
    wide = found.half_widths / (QUANTILE * bound(made, at))
    off = np.abs(np.triu(found.correlations, 1)).max()
    return {
        "inside": float(np.mean(inside)),
        "wide": float(np.median(wide)),
        "curve-error": curve_error(found, true),
        "linked": float(off),
    }


def value(bounds: list[float], at: float) -> float:
    """A parameter at a coordinate: -1, 0, 1 are its bounds and its start."""
    low, middle, high = bounds
    return float(middle * ((high if at > 0.0 else low) / middle) ** abs(at))


def coordinates(law: str, values: Variables) -> np.ndarray:
    """Back from there."""
    pairs = ((np.log(values[name] / bounds[1]), bounds) for name, bounds in LAWS[law][1].items())
    return np.array([x / np.log((b[2] if x > 0.0 else b[0]) / b[1]) * np.sign(x) for x, b in pairs])


@cache
def table() -> DataFrame:
    """The solves."""
    import pandas as pd

    with resources.as_file(resources.files("verification") / "data" / "fit_recovery.csv") as path:
        return pd.read_csv(path)


def features(at: np.ndarray) -> np.ndarray:
    """1, coordinates and their products, (n, m) of (n, p)."""
    pairs = combinations_with_replacement(range(at.shape[1]), 2)
    return np.stack([np.ones(len(at)), *at.T, *(at[:, i] * at[:, j] for i, j in pairs)], axis=1)


@cache
def quadratics(law: str, force: float, model: str) -> np.ndarray:
    """Coefficients (m, 22) of the logarithms of strain, dent and depths."""
    rows = table().query("law == @law and force == @force and model == @model")
    places = [f"at_{k}" for k in range(len(LAWS[law][1]))]
    values = np.log(rows[["strain", "dent", *(f"d{k}" for k in range(20))]].to_numpy(float))
    return np.linalg.lstsq(features(rows[places].to_numpy(float)), values, rcond=None)[0]


def said(law: str, force: float, model: str, at: np.ndarray) -> np.ndarray:
    """Strain, dent and depths (22,) at coordinates."""
    return np.exp(features(at[None])[0] @ quadratics(law, force, model))


def answer(test: Test, values: Variables, fine: bool) -> Answer:
    """What finite elements say of a test."""
    law = next(law for law, (_, unknown, _) in LAWS.items() if set(unknown) == set(values))
    force = float(test.scene.loading.force or 0.0)
    strain, dent, *depths = said(law, force, "fine" if fine else "coarse", coordinates(law, values))
    found = np.array([dent]) if test.kind == "depth" else np.array(depths)
    return Answer(found, np.zeros(found.size), float(strain), 0.05)


def measured(law: str, true: Variables, noise: float, draws: np.random.Generator) -> Definition:
    """A loading and the depth of its dent for each force, as SAM makes them, with noise."""
    import pandas as pd

    known, unknown, forces = LAWS[law]
    scene = Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": known},
        counterbody={"shape": "sphere", "radius": 1e-3, "young": 600e9, "poisson": 0.22},
        loading={"force": 1.0, "steps": 8, "unload": True},
    )
    tests: list[dict[str, Any]] = []
    for force in forces:
        _, dent, *depths = said(law, force, "sam", coordinates(law, true))
        size = noise * depths[-1]
        noisy = np.array([*depths, dent]) + draws.normal(0.0, size, 21)
        frame = pd.DataFrame({"force_N": SHARE * force, "depth_m": noisy[:20]})
        tests += [
            {"data": frame, "noise": size},
            {"kind": "depth", "depth": max(float(noisy[20]), 1e-10), "force": force, "noise": size},
        ]
    return definition_of({"scene": scene, "tests": tests, "unknown": unknown})


def bound(made: Definition, at: np.ndarray) -> np.ndarray:
    """Least standard errors (p,) of the logarithms by the fine model at the true parameters."""
    columns, step = [], 1e-3
    law = next(law for law, (_, unknown, _) in LAWS.items() if len(unknown) == len(made.of_scene))
    for p in made.of_scene:
        ends = []
        for sign in (-1.0, 1.0):
            other = {q.name: value(LAWS[law][1][q.name], u) for q, u in zip(made.of_scene, at, strict=True)}
            other[p.name] *= float(np.exp(sign * step))
            ends.append(
                np.concatenate([answer(t, other, True).depths / (t.noise or 1.0) for t in made.tests])
            )
        columns.append((ends[1] - ends[0]) / (2.0 * step))
    jacobian = np.stack(columns, axis=1)
    return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))


def curve_error(found: Fitted, true: Variables) -> float:
    """Largest relative error of the yield curve, from a plastic strain of 1e-4 to the largest."""
    strain, stress, _, _ = found.yield_curve()
    plasticity = found.scene(true).body.plasticity
    assert plasticity is not None
    exact = np.asarray(plasticity.curve().stress(strain))
    return float(np.abs(stress / exact - 1.0)[strain >= 1e-4].max())
