# SPDX-License-Identifier: MIT
"""A sphere pressed into a body by small strain on a flat surface and by finite strain, and where the two come
apart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem_reference import plastic_radius
from fem_reference.finite_strain import Curve, build, curve_of, load_to
from sam.scene import Scene

LIMIT = 0.05
"""Relative difference from which on the models of the scenes are called no good."""
QUANTITIES = {
    "pressure": "mean pressure",
    "radius": "contact radius",
    "approach": "approach",
    "strain": "largest plastic strain",
}
POWERS = np.arange(1, 4)
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


ELASTIC = (Body("elastic, ν = 0.3", 0.3, 0.4, 16, 20), Body("elastic, ν = 0.49", 0.49, 0.4, 16, 20))
PERFECT = {"law": "perfect", "yield_stress": YOUNG / 300}
PLASTIC = (
    Body("Swift steel", 0.3, 0.4, 16, 60, SWIFT, 11.2e9),
    Body("perfectly plastic, yield strain 1/300", 0.3, 0.3, 16, 80, PERFECT, 2.8 * PERFECT["yield_stress"]),
)


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
