# SPDX-License-Identifier: MIT
"""Parameters that are drawn come back from data that finite elements make with noise, by a fit of SAM.

`python -m verification.cases.plastic.fit_recovery` solves both models once at points of a scrambled Sobol
sequence over the bounds of each law, and writes data/fit_recovery.csv: the law, the model ("fine", "coarse":
the grids of a fit; "data": finite elements), the test, the coordinates of the point from -1 to 1, the largest
strain, a/R, the depth of the dent on the axis, and the depths at twenty equal steps of the force, in m. In
between the logarithms of these numbers are quadratics.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from importlib import resources
from typing import Any

import numpy as np
from scipy.stats.qmc import Sobol

from sam.scene import Scene
from verification.cases.case import Context
from verification.fit import Definition, Solves, definition_of, fit
from verification.fit.definition import Test, Variables
from verification.fit.fitting import QUANTILE
from verification.fit.solves import Answer
from verification.fit.words import oliver_pharr
from verification.runs.model_range import SWIFT as STEEL_MEASURED, errors
from verification.runs.models import FEM, SAM
from verification.runs.store import Store, default_store, kept_coefficients
from verification.runs.tables import read_any_table

NOISES, DRAWS, SEED = (0.005, 0.01, 0.03), 40, 7
INSIDE = 0.6
"""Coordinates of a draw are uniform between plus and minus this."""
SCATTER = 0.003
"""Of logarithms of depths, by where the edge of the contact falls in its cell."""
SHARE = np.linspace(0.05, 1.0, 20)
STEP = 1e-5  # of a coordinate, for derivatives of the quadratics
KEPT, GRIDS = "fit_recovery.csv", {"coarse": (SAM, False), "fine": (SAM, True), "data": (FEM, True)}


@dataclass(frozen=True)
class Law:
    """A hardening law whose numbers are to be found again. unknown: key -> middle and factor to the bounds;
    tests: (radius in m, force in N); grid: of SAM; points: which of the sequence stand in the table.
    """

    plasticity: Mapping[str, Any] | None
    unknown: Mapping[str, tuple[float, float]]
    tests: Sequence[tuple[float, float]]
    grid: Mapping[str, Any]
    points: Sequence[int] = ()

    def values(self, at: Any) -> dict[str, float]:
        """Unknown key -> its value at coordinates."""
        pairs = zip(self.unknown.items(), at, strict=True)
        return {key: middle * factor**x for (key, (middle, factor)), x in pairs}

    def place(self, values: Variables) -> np.ndarray:
        """The coordinates of values."""
        pairs = zip(self.unknown.values(), values.values(), strict=True)
        return np.array([np.log(value / middle) / np.log(factor) for (middle, factor), value in pairs])

    def definition(self, data: Sequence[np.ndarray], noise: Sequence[float], model: str = SAM) -> Definition:
        """A fit; depths in m of each test, of its dent, if any, loading, and unloading, if any; noise."""
        from pandas import DataFrame

        steps, (first, _) = {SAM: 32, FEM: 16}[model], self.tests[0]
        scene = Scene(
            body={"young": 210e9, "poisson": 0.3, "plasticity": self.plasticity},
            counterbody={"shape": "sphere", "radius": first, "young": 600e9, "poisson": 0.22},
            loading={"force": 1.0, "steps": steps, "unload": True, "unload_steps": 2},
            grid=self.grid if model == SAM else None,
            fem={"cells_per_radius": 6},
        )
        tests = []
        for (radius, force), depths, size in zip(self.tests, data, noise, strict=True):
            dent = depths[: len(depths) % 20]
            forces = force * np.append(SHARE, SHARE[::-1])[: len(depths) - len(dent)]
            frame = DataFrame({"force_N": forces, "depth_m": depths[len(dent) :]})
            own = {"radius": radius, "noise": size}
            tests.append({"data": frame, **own})
            tests += [{"kind": "depth", "depth": depth, "force": force, **own} for depth in dent]
        ends = (self.values(np.full(len(self.unknown), x)) for x in (-1.0, 0.0, 1.0))
        bounds = {key: [each[key] for each in found] for found in [list(ends)] for key in found[0]}
        return definition_of({"scene": scene, "model": model, "tests": tests, "unknown": bounds})


STEEL = {"law": "linear", "yield_stress": 600e6, "modulus": 10e9}
LAYER = STEEL | {"layer_thickness": 1e-6, "layer": {"law": "linear", "yield_stress": 1.5e9, "modulus": 30e9}}
PRAGER = {"law": "perfect", "yield_stress": 600e6, "kinematic": {"modulus": [15e9]}}
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
WIDE = {"cells": [41, 41], "extent": [2.5e-4, 2.5e-4]}
LAWS = {
    "linear": Law(
        STEEL,
        {"body.plasticity.yield_stress": (600e6, 1.5), "body.plasticity.modulus": (15e9, 2.0)},
        [(1e-3, 10.0)],
        WIDE,
        range(8),
    ),
    "prager": Law(
        PRAGER,
        {"body.plasticity.yield_stress": (600e6, 1.5), "body.plasticity.kinematic.modulus.0": (15e9, 2.0)},
        [(1e-3, 10.0)],
        WIDE,
        range(9),
    ),
    "layer": Law(
        LAYER,
        {"body.plasticity.layer.yield_stress": (1.5e9, 1.5), "body.plasticity.layer.modulus": (30e9, 2.0)},
        [(2e-5, 0.05)],
        {"cells": [41, 41], "extent": [13e-6, 13e-6]},
        (*range(5), 8),
    ),
    "swift": Law(
        SWIFT,
        {
            "body.plasticity.B": (945e6, 1.3),
            "body.plasticity.C": (20.0, 3.0),
            "body.plasticity.n": (0.121, 1.3),
        },
        [(2e-4, 2.0), (6e-5, 2.0)],
        {"cells": [31, 31]},
        (*range(7), *range(9, 13)),
    ),
}


def recovered(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each law and noise, of all draws, and one for each law on its quadratics."""
    from pandas import DataFrame

    for number, name in enumerate(LAWS, start=1):
        context.progress(context.case, number, len(LAWS))
        yield {"sweep": "kept", "law": name, "held-out": held_out(name)}
        for noise in NOISES:
            draws = np.random.default_rng(SEED)
            found = DataFrame([one(name, noise, draws) for _ in range(DRAWS)])
            shown = found.median().to_dict() | {"covered": found["covered"].mean()}
            shown["over-least"] = shown["curve-error"] / shown["curve-least"]
            yield {"sweep": "recovered", "law": name, "noise": noise, **shown}
    yield {"sweep": "finite", "law": "swift", "curve-bias": of_finite_strain()}


def of_finite_strain() -> float:
    """Largest relative error of the curve that is fitted to two loadings of the Swift steel of which case
    model-limits-plastic measured by how much the approach at small strain is off, with a as sqrt(F).
    """
    law, data = LAWS["swift"], []
    for _, ratio, _, *depths in made("swift", "fine", np.zeros(3)):
        off = [errors(STEEL_MEASURED, 0.3, a)["approach"][0] for a in ratio * np.sqrt(SHARE)]
        data.append(np.array(depths) / (1.0 + np.array(off)))
    found = fit(
        law.definition(data, [0.005 * each[-1] for each in data]), partial(answer, "swift"), ahead=False
    )
    return float(np.abs(found.curve(found.values)[1] / found.curve(law.values([0.0] * 3))[1] - 1.0).max())


def one(
    name: str, noise: float, draws: np.random.Generator, context: Context | None = None
) -> dict[str, float]:
    """Of a draw: share of the parameters in their confidence intervals; median of the half-widths over the
    bound of Cramer and Rao; largest relative error of the yield curve to the largest strain; its median for
    parameters with the covariance of the bound; correlation of the first parameter and the last.

    With a context both models are solved, else the table answers.
    """
    law, answers = LAWS[name], partial(answer, name)
    at = draws.uniform(-INSIDE, INSIDE, len(law.unknown))
    exact, true = made(name, "data", at)[:, 2:], law.values(at)
    if context is not None:
        exact = solved(law, "data", true, shape=list(exact), store=context.store)[:, 2:]
        answers = Solves(SAM, context.store)
    sizes = noise * exact[:, -1]
    data = exact + sizes[:, None] * draws.normal(size=exact.shape)
    found = fit(law.definition(list(data), list(map(float, sizes))), answers, ahead=False)
    covered = [low <= true[key] <= high for key, (low, high) in found.intervals.items()]
    least, curve = least_covariance(name, at, sizes), found.curve(true)[1]
    widths = np.log([factor for _, factor in law.unknown.values()])
    steps = [found.curve(law.values(at + STEP * each))[1] for each in np.eye(at.size)]
    others = np.random.default_rng(SEED).multivariate_normal(0.0 * at, least, 400) @ (
        np.log(steps / curve) / STEP
    )
    return {
        "covered": float(np.mean(covered)),
        "wide": float(np.median(found.half_widths / (QUANTILE * widths * np.sqrt(np.diag(least))))),
        "curve-error": float(np.abs(found.curve(found.values)[1] / curve - 1.0).max()),
        "curve-least": float(np.median(np.abs(others).max(1))),
        "correlation": float(found.correlations[0, -1]),
    }


@cache
def table(name: str) -> dict[tuple[str, int], tuple[np.ndarray, np.ndarray]]:
    """Grid and test -> coordinates (n, p) and logarithms (n, 23) of strain, a/R, dent and depths of a law."""
    rows = read_any_table((resources.files("verification") / "data" / KEPT).read_bytes())
    found = {}
    for (grid, test), own in rows[rows["law"] == name].groupby(["model", "test"]):
        values = own.drop(columns=["law", "model", "test"]).to_numpy(float)
        found[grid, int(test)] = values[:, : len(LAWS[name].unknown)], np.log(values[:, 3:])
    return found


def features(at: np.ndarray) -> np.ndarray:
    """Powers and products up to the second of coordinates (..., p), each times its standard deviation:
    logarithms of depths are near 15, of first order in those of the parameters, and 0.1 off that.
    """
    at = np.concatenate([np.ones((*at.shape[:-1], 1)), at], axis=-1)
    first, second = np.triu_indices(at.shape[-1])
    return at[..., first] * at[..., second] * np.where(first > 0, 0.1, np.where(second > 0, 1.0, 15.0))


def inverse(at: np.ndarray) -> np.ndarray:
    """Coefficients of the quadratics over the values at coordinates, by Bayesian linear regression (Rasmussen
    & Williams, Gaussian Processes for Machine Learning (2006), Eq. 2.8), of standard deviation SCATTER; the
    prior, of `features`, determines them also where there are fewer points than coefficients.
    """
    known = features(at)
    return np.linalg.solve(known.T @ known + SCATTER**2 * np.eye(known.shape[1]), known.T)


@cache
def quadratics(name: str, grid: str) -> list[np.ndarray]:
    """Coefficients of the quadratics, of each test."""
    pairs = (table(name)[grid, k] for k in range(len(LAWS[name].tests)))
    return [inverse(at) @ values for at, values in pairs]


def held_out(name: str) -> float:
    """rms of the relative error of depths at points that are left out of their quadratics, one by one."""
    errors = []
    for at, values in table(name).values():
        hat = features(at) @ inverse(at)
        errors.append((values - hat @ values)[:, 2:] / (1.0 - np.diag(hat))[:, None])
    return float(np.sqrt(np.mean(np.square(errors))))


def made(name: str, grid: str, at: np.ndarray) -> np.ndarray:
    """Strain, a/R, dent and depths of the tests at coordinates, (tests, 23)."""
    return np.exp([features(at) @ each for each in quadratics(name, grid)])


def answer(name: str, test: Test, values: Variables, fine: bool) -> Answer:
    """What SAM says of a test, without a solve."""
    law, ball = LAWS[name], test.scene.counterbody
    number = [radius for radius, _ in law.tests].index(ball.radius if ball else 0.0)
    strain, ratio, dent, *depths = made(name, "fine" if fine else "coarse", law.place(values))[number]
    found = np.array([dent] if test.kind == "depth" else depths)
    return Answer(found, np.zeros(found.size), float(strain), float(ratio))


def least_covariance(name: str, at: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The bound: covariance (p, p) of the coordinates, by the fine grid at the true parameters."""
    places = at + STEP * np.vstack([0.0 * at, np.eye(at.size)])
    depths = np.array([made(name, "fine", each)[:, 2:] / sizes[:, None] for each in places])
    jacobian = (depths[1:] - depths[0]).reshape(at.size, -1) / STEP
    return np.linalg.inv(jacobian @ jacobian.T)


def solved(
    law: Law, grid: str, values: Variables, *, shape: Sequence[np.ndarray], store: Store | None
) -> np.ndarray:
    """Strain, a/R and the depths of the tests, solved; shape: depths that may be of such tests."""
    model, fine = GRIDS[grid]
    tests, solves = law.definition(shape, [1e-9] * len(shape), model).tests, Solves(model, store)
    found: list[list[float]] = []
    for test in tests:
        each = solves(test, values, fine)
        if test.kind == "depth":
            found[-1].insert(2, float(each.depths[0]))
        else:
            found.append([each.strain, each.ratio, *each.depths])
    return np.array(found)


def unloaded(context: Context) -> Iterator[dict[str, Any]]:
    """Rows of fits that are solved: E from an unloading beside that of Oliver and Pharr."""
    draws, up, known = np.random.default_rng(SEED), 1e-6 * SHARE, {"cells": [31, 31]}
    for name, plasticity, force in (("elastic", None, 0.5), ("swift", SWIFT, 2.0)):
        context.progress(f"{context.case}: {name}", 1, 2)
        law = Law(plasticity, {"body.young": (210e9, 1.5)}, [(2e-4, force)], known)
        shape = [np.append(up, up[::-1])]
        exact = solved(law, "data", law.values([0.0]), shape=shape, store=context.store)[:, 2:]
        noise = 0.005 * exact.max()
        defined = law.definition(list(exact + noise * draws.normal(size=exact.shape)), [noise])
        found = fit(defined, Solves(SAM, context.store), ahead=False).values["body.young"]
        read = oliver_pharr(defined.tests[0])[0]
        off = {"fitted": abs(found / 210e9 - 1.0), "read": abs(read / 210e9 - 1.0)}
        yield {"sweep": "unloading", "law": name, **off}


def further(context: Context) -> Iterator[dict[str, Any]]:
    """Rows of fits that are solved: what tests leave of Swift's constants, each the proposed one."""
    draws, law = np.random.default_rng(SEED), replace(LAWS["swift"], tests=LAWS["swift"].tests[:1])
    values, data, shape = law.values([0.0] * 3), np.empty((0, 21)), [1e-6 * np.append(0.1, SHARE)]
    for tests in ("one", "two", "three"):
        context.progress(f"{context.case}: {tests}", 1, 3)
        last = replace(law, tests=law.tests[-1:])
        exact = solved(last, "data", values, shape=shape, store=context.store)[:, 2:]
        data = np.concatenate([data, exact + 0.005 * exact[:, -1:] * draws.normal(size=exact.shape)])
        defined = law.definition(list(data), [0.005 * float(each) for each in data[:, -1]])
        solves = Solves(SAM, context.store)
        found = fit(defined, solves)
        named = {name.rpartition(".")[2] for _, names in found.open_combinations for name in names}
        wide = {f"wide-{key[-1].lower()}": w for key, w in zip(values, found.half_widths, strict=True)}
        counted = {"solves": len(solves.known), "open": "".join(sorted(named))}
        yield {"sweep": "further", "tests": tests, **counted, **wide}
        if found.further:
            law = replace(law, tests=[*law.tests, (found.further[0].radius, found.further[0].force)])


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """Rows of fits that are solved: two draws of each law at 1 % of noise, and the two above."""
    for name in LAWS:
        draws = np.random.default_rng(SEED)
        for draw in range(2):
            context.progress(f"{context.case}: {name}", draw, 2)
            yield {"sweep": "drawn", "law": name, "draw": draw, **one(name, 0.01, draws, context)}
    yield from unloaded(context)
    yield from further(context)


def main() -> None:
    """Solve the tables."""
    from pandas import DataFrame

    rows, store = [], default_store()
    for name, law in LAWS.items():
        size = len(law.unknown)
        shape = [np.append(0.01, SHARE) * 0.02 * radius for radius, _ in law.tests]
        for at in sorted((2.0 * Sobol(size, seed=1).random(16)[list(law.points)] - 1.0).tolist()):
            for grid in sorted(GRIDS):
                for k, found in enumerate(solved(law, grid, law.values(at), shape=shape, store=store)):
                    rows.append([name, grid, k, *at, *[0.0] * (3 - size), *found])
    names = ["law", "model", "test", "at_0", "at_1", "at_2", "strain", "a_over_R", "dent"]
    frame = DataFrame(rows, columns=[*names, *(f"d{k}" for k in range(SHARE.size))])
    with resources.as_file(resources.files("verification") / "data" / KEPT) as path:
        frame.to_csv(path, index=False, float_format="%.6g")


if __name__ == "__main__":
    with kept_coefficients():
        main()
