# SPDX-License-Identifier: MIT
"""A sphere pressed into a body by small strain on a flat surface and by finite strain, and where the two come
apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference import plastic_radius
from fem_reference.finite_strain import Curve, build, curve_of, load_to
from sam.scene import Scene
from verification.runs.model_range import (
    COLUMNS,
    ELASTIC as ELASTIC_LAW,
    PERFECT as PERFECT_LAW,
    SWIFT as SWIFT_LAW,
    WORDS,
)

LIMIT = 0.05
"""Relative difference from which on the models of the scenes are called no good."""
QUANTITIES = {
    "pressure": "mean pressure",
    "radius": "contact radius",
    "approach": "approach",
    "strain": "largest plastic strain",
}
COLUMN_OF = dict(zip(QUANTITIES, WORDS, strict=True))
"""Names of the quantities in the table of `verification.runs.model_range`."""
STEP = (
    0.025  # of a/R in that table: linear in between, the fits are off by less than 0.002 by their curvature
)
POWERS = np.arange(1, 4)
Table = dict[str, np.ndarray]
RESOLVED = 6  # elements in the contact radius from which a load step counts
YOUNG, RADIUS = 210e9, 105e-6
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
MODELS = {"flat": "small strain, flat surface", "finite": "finite strain, true sphere"}


@dataclass(frozen=True)
class Body:
    """A material and how far it is pressed. elements: in the largest contact radius; hardness: mean pressure
    there, about, None for Hertz; steps: load steps, the contact radius about equal parts of the largest,
    `reach` times that of the sphere.
    """

    name: str
    poisson: float
    reach: float
    elements: int
    steps: int
    plasticity: Mapping[str, object] | None = None
    hardness: float | None = None

    def scene(self, elements: int) -> Scene:
        """The scene with so many elements in the largest contact radius."""
        modulus = YOUNG / (1.0 - self.poisson**2)
        mean = self.hardness or 4.0 / (3.0 * np.pi) * modulus * self.reach
        body = {"young": YOUNG, "poisson": self.poisson} | (
            {"plasticity": self.plasticity} if self.plasticity else {}
        )
        scene = Scene(
            body=body,
            counterbody={"shape": "sphere", "radius": RADIUS},
            loading={"force": mean * np.pi * (self.reach * RADIUS) ** 2},
            fem={"cells_per_radius": 4, "box": 25.0},
        )
        cells = max(4, round(elements / (plastic_radius(scene) or 1.0)))
        return scene.model_copy(update={"fem": scene.fem.model_copy(update={"cells_per_radius": cells})})


ELASTIC = tuple(Body(f"elastic, ν = {nu:g}", nu, 0.4, 16, 20) for nu in (0.3, 0.49, 0.0))
PERFECT = {"law": "perfect", "yield_stress": YOUNG / 300}
PLASTIC = (
    Body("Swift steel", 0.3, 0.4, 16, 60, SWIFT, 11.2e9),
    Body("perfectly plastic, yield strain 1/300", 0.3, 0.3, 16, 80, PERFECT, 2.8 * PERFECT["yield_stress"]),
    Body("Swift steel, ν = 0.49", 0.49, 0.4, 16, 60, SWIFT, 11.2e9),
)
WEAKER = PERFECT | {"yield_stress": YOUNG / 600}
OTHERS = (
    Body("0.6 of the Swift steel", 0.3, 0.35, 10, 40, SWIFT | {"B": 0.6 * SWIFT["B"]}, 6.5e9),
    Body("Swift, n = 0.06", 0.3, 0.35, 10, 40, SWIFT | {"B": 1.3e9, "n": 0.06}, 7.5e9),
    Body("perfectly plastic, yield strain 1/600", 0.3, 0.25, 10, 50, WEAKER, 2.85 * WEAKER["yield_stress"]),
)
"""Materials by which an error differs that is taken from those above: a part of its uncertainty."""
FRESH = (
    Body("elastic, ν = 0.4", 0.4, 0.32, 20, 16),
    Body("1.3 of the Swift steel", 0.3, 0.35, 10, 40, SWIFT | {"B": 1.3 * SWIFT["B"]}, 14e9),
)
"""Materials and a mesh that the table of `verification.runs.model_range` was not made of."""


@dataclass(frozen=True)
class Difference:
    """Relative difference of a quantity at equal force over a/R of the finite model, and its fit x (c1 + c2 x
    + c3 x^2).

    covariance: (3, 3) of the coefficients, by the scatter of the points about the fit.
    """

    x: np.ndarray
    values: np.ndarray
    coefficients: np.ndarray
    covariance: np.ndarray

    @classmethod
    def of(cls, x: np.ndarray, values: np.ndarray) -> Difference:
        """Least squares; at least four points."""
        powers = x[:, None] ** POWERS
        coefficients = np.linalg.lstsq(powers, values, rcond=None)[0]
        variance = np.sum((powers @ coefficients - values) ** 2) / (x.size - POWERS.size)
        return cls(x, values, coefficients, variance * np.linalg.inv(powers.T @ powers))

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The fit."""
        return np.asarray(x)[..., None] ** POWERS @ self.coefficients

    def error(self, x: np.ndarray) -> np.ndarray:
        """Two standard deviations of the fit."""
        powers = np.asarray(x)[..., None] ** POWERS
        return 2.0 * np.sqrt(np.einsum("...i,ij,...j->...", powers, self.covariance, powers))

    def limit(self, errors: float = 0.0) -> float:
        """a/R at which the fit, with so many of its errors taken outwards, first reaches LIMIT; infinite if
        it does not.
        """
        dense = np.linspace(0.0, self.x.max(), 4001)
        beyond = np.flatnonzero(np.abs(self(dense)) + errors * self.error(dense) >= LIMIT)
        return float(dense[beyond[0]]) if beyond.size else np.inf

    def good_to(self) -> float:
        """The limit, or the largest contact that was looked at."""
        return min(self.limit(), float(self.x.max()))


def loaded(body: Body, elements: int, kind: str) -> Curve:
    """All load steps of one model."""
    model = build(body.scene(elements), kind)
    steps = load_to(model, (np.arange(1, body.steps + 1) / body.steps) ** 2)
    if not steps[-1].state.converged:
        raise RuntimeError(f"{body.name}, {MODELS[kind]}: step {len(steps)} of {body.steps} did not converge")
    return curve_of(model, steps)


def differences(found: Mapping[str, Curve], elements: int) -> dict[str, Difference]:
    """Quantity -> difference of the two models at equal force, at the steps whose contact is resolved."""
    flat, true = found["flat"], found["finite"]
    x = true.radius
    use = x >= RESOLVED / elements * x.max()
    both = {name: (getattr(flat, name)[use], getattr(true, name)[use]) for name in QUANTITIES}
    return {name: Difference.of(x[use], t / f - 1.0) for name, (f, t) in both.items() if (f > 0.0).all()}


def range_rows(body: Body, found: Mapping[str, Curve]) -> Table:
    """Rows of the table of `verification.runs.model_range`, by column: errors of the flat model over its own
    a/R, by the fits, with two of their standard errors.
    """
    fits = errors_of_flat(body, found)
    x = STEP * np.arange(1, int(fits["radius"].x.max() / STEP + 0.01) + 1)
    columns: Table = dict.fromkeys(COLUMNS, np.full(x.size, np.nan))
    columns |= {"law": np.full(x.size, law_of(body)), "poisson": np.full(x.size, body.poisson), "a_over_R": x}
    for name, fit in fits.items():
        columns |= {COLUMN_OF[name]: fit(x), f"u_{COLUMN_OF[name]}": fit.error(x)}
    return columns


def errors_of_flat(body: Body, found: Mapping[str, Curve]) -> dict[str, Difference]:
    """Quantity -> error of the flat model at equal force, over its own a/R."""
    return differences({"flat": found["finite"], "finite": found["flat"]}, body.elements)


def law_of(body: Body) -> str:
    """Of a body in the table."""
    law = (body.plasticity or {}).get("law")
    return {None: ELASTIC_LAW, "swift": SWIFT_LAW, "perfect": PERFECT_LAW}[law]


def with_spread(rows: Table, same: Table, others: Sequence[Table]) -> Table:
    """The rows, whose uncertainty has in it by how much `others` differ from `same`, all of one law."""
    widened = dict(rows)
    for name in WORDS if others else ():
        apart = [
            abs(
                np.interp(rows["a_over_R"], each["a_over_R"], each[name])
                - np.interp(rows["a_over_R"], same["a_over_R"], same[name])
            )
            for each in others
        ]
        widened[f"u_{name}"] = rows[f"u_{name}"] + np.max(apart, axis=0)
    return widened
