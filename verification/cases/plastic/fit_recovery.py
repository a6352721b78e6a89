# SPDX-License-Identifier: MIT
"""Parameters that are drawn come back from data that SAM makes with noise, by a fit of finite elements.

Both models were solved once, at the nodes of a design in the logarithms of both parameters; in between the
logarithms of their depths are quadratics. `data/fit_recovery.csv` has the model ("fine" and "coarse": the two
grids of a fit), the coordinates of the node, -1, 0 or 1, the largest strain, the depth of the dent on the
axis, and the depths at twenty equal steps of the force, in m.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import Context
from verification.fit import Definition, Fitted, definition_of, fit
from verification.fit.definition import Test, Variables
from verification.fit.fitting import QUANTILE
from verification.fit.solves import Answer
from verification.runs.tables import read_any_table

NOISES, DRAWS, SEED = (0.005, 0.01, 0.03), 40, 7
INSIDE = 0.6
"""Coordinates of a draw are uniform between plus and minus this."""
SHARE, FORCE = np.linspace(0.05, 1.0, 20), 10.0
LAW = {"law": "linear", "yield_stress": 600e6, "modulus": 15e9}
UNKNOWN = {
    "body.plasticity.yield_stress": [400e6, 600e6, 900e6],
    "body.plasticity.modulus": [7.5e9, 15e9, 30e9],
}
WIDTHS = np.log([1.5, 2.0])
"""Of a coordinate, in the logarithm of its parameter."""


def recovered(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each noise, of all draws."""
    for number, noise in enumerate(NOISES, start=1):
        context.progress(context.case, number, len(NOISES))
        draws = np.random.default_rng(SEED)
        found = np.array([one(noise, draws) for _ in range(DRAWS)])
        names = "covered", "wide", "curve-error"
        shown = found[:, 0].mean(), *np.median(found[:, 1:], axis=0)
        yield {"sweep": "recovered", "noise": noise} | dict(zip(names, map(float, shown), strict=True))


def one(noise: float, draws: np.random.Generator) -> tuple[float, float, float]:
    """Share of parameters in their intervals, half-widths over Cramer and Rao, error of the yield curve."""
    at = draws.uniform(-INSIDE, INSIDE, 2)
    start = [bounds[1] for bounds in UNKNOWN.values()]
    true = dict(zip(UNKNOWN, start * np.exp(WIDTHS * at), strict=True))
    made = measured(at, noise, draws)
    found = fit(made, answer, ahead=False)
    covered = [low <= true[name] <= high for name, (low, high) in found.intervals.items()]
    wide = found.half_widths / (QUANTILE * least_errors(made, true))
    return float(np.mean(covered)), float(np.median(wide)), curve_error(found, true)


@cache
def quadratics(model: str) -> np.ndarray:
    """Coefficients (6, 22) of the logarithms of strain, dent and depths."""
    rows = read_any_table((resources.files("verification") / "data" / "fit_recovery.csv").read_bytes())
    nodes = rows[rows["model"] == model].drop(columns="model").to_numpy(float)
    return np.linalg.lstsq(features(*nodes[:, :2].T), np.log(nodes[:, 2:]), rcond=None)[0]


def features(x: Any, y: Any) -> np.ndarray:
    """Powers and products up to the second of coordinates."""
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)


def answer(test: Test, values: Variables, fine: bool) -> Answer:
    """What finite elements say of a test."""
    at = np.log([values[name] / bounds[1] for name, bounds in UNKNOWN.items()]) / WIDTHS
    strain, dent, *depths = np.exp(features(*at) @ quadratics("fine" if fine else "coarse"))
    found = np.array([dent] if test.kind == "depth" else depths)
    return Answer(found, np.zeros(found.size), float(strain), 0.05)


def measured(at: np.ndarray, noise: float, draws: np.random.Generator) -> Definition:
    """A loading and the depth of its dent, as SAM makes them at coordinates, with noise."""
    from pandas import DataFrame

    _, dent, *depths = np.exp(features(*at) @ quadratics("sam"))
    size = noise * depths[-1]
    noisy = np.array([*depths, dent]) + draws.normal(0.0, size, 21)
    curve = {"data": DataFrame({"force_N": SHARE * FORCE, "depth_m": noisy[:20]}), "noise": size}
    imprint = {"kind": "depth", "depth": noisy[20], "force": FORCE, "noise": size}
    scene = Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": LAW},
        counterbody={"shape": "sphere", "radius": 1e-3, "young": 600e9, "poisson": 0.22},
        loading={"force": FORCE},
    )
    return definition_of({"scene": scene, "tests": [curve, imprint], "unknown": UNKNOWN})


def least_errors(made: Definition, true: Variables) -> np.ndarray:
    """The bound: standard errors (2,) of the logarithms, by the fine model at the true parameters."""

    def whitened(values: Variables) -> np.ndarray:
        return np.concatenate([answer(t, values, True).depths / (t.noise or 1.0) for t in made.tests])

    step, base = 1e-5, whitened(true)
    moved = [whitened({**true, name: true[name] * np.exp(step)}) for name in UNKNOWN]
    jacobian = (np.array(moved) - base).T / step
    return np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))


def curve_error(found: Fitted, true: Variables) -> float:
    """Largest relative error of the yield curve."""
    strain, stress, _, _ = found.yield_curve()
    exact = true["body.plasticity.yield_stress"] + true["body.plasticity.modulus"] * strain
    return float(np.abs(stress / exact - 1.0).max())
