# SPDX-License-Identifier: MIT
"""The tangent of the finite-element return map with back-stresses, against differences of the stress."""

from __future__ import annotations

import numpy as np
import pytest

from sam.scene.yield_curve import Linear, Swift
from tests.material_point import FemPoint, Specimen


@pytest.mark.parametrize("curve", [Linear(1e9), Swift(945e6, 20.0, 0.121)], ids=["perfect", "swift"])
@pytest.mark.parametrize(
    ("law", "symmetric"),
    [(([11e9], [0.0]), True), (([400e9, 60e9, 6e9], [2000.0, 300.0, 0.0]), False)],
    ids=["prager", "chaboche"],
)
def test_tangent_is_the_derivative_of_the_stress(curve, law, symmetric):
    """With Prager's law exactly; else it is the symmetric part of the derivative."""
    rng = np.random.default_rng(3)
    point = FemPoint(curve, *law)
    specimen = Specimen(point)
    for _ in range(4):
        specimen.to(strain=dict(enumerate(0.01 * rng.standard_normal(6))))
    start = point.state
    strain = specimen.strain + 0.02 * rng.standard_normal(6)

    def stress(engineering):
        return point.material.update(engineering.reshape(6, 1, 1), start).stress.ravel()

    at = strain * [1, 1, 1, 2, 2, 2]
    update = point.material.update(at.reshape(6, 1, 1), start)
    tangent = point.material.stiffness - update.loss[0, 0]
    columns = []
    for unit in 1e-5 * np.eye(6):
        near, far = (stress(at + n * unit) - stress(at - n * unit) for n in (1, 2))
        columns.append((8 * near - far) / 12e-5)  # of fourth order
    derivative = np.array(columns).T
    scale = np.abs(tangent).max()
    assert np.abs(tangent - tangent.T).max() < 1e-12 * scale
    assert np.abs(tangent - (derivative + derivative.T) / 2).max() < 2e-9 * scale
    skew = np.abs(derivative - derivative.T).max() / scale
    assert skew < 2e-9 if symmetric else skew > 1e-5
