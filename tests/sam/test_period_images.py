# SPDX-License-Identifier: MIT
"""Stress of the periodic images of a box against sums of the closed form over images."""

from functools import cache

import numpy as np
import pytest

from sam.kernels.layer_stress import CornerFunctions, LayerStress
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity.images import MIRRORED, PeriodImages, _nodes
from sam.plasticity.spectra import GAUSS, ODD_X, ODD_Y

CELLS, ASPECT = (16, 16), 1.25
FACES = {"even": (0.0, 2.0, 4.0, 6.0), "graded": (0.5, 0.8, 2.0, 6.0)}
STRAIN = np.random.default_rng(3).standard_normal((6, 3, 2, 2))  # in layers and quarters of the box


def cuboids(faces, nu=0.3) -> Cuboids:
    return Cuboids(Lags(1, 1, 1.0, ASPECT), faces, nu)


@cache
def images(faces, nu, period, tolerance) -> PeriodImages:
    return PeriodImages(cuboids(faces, nu), CELLS, period, tolerance)


def closed_form(faces, nu, z, x, y):
    """Stress in z at the origin by unit strain between lines in x and y, (6, 6, layers, cells)."""
    layers = LayerStress(CornerFunctions((len(x) - 1, len(y) - 1), np.ix_([0], x, y)[1:]), z, faces, nu)
    out = np.empty((36, 1, len(faces) - 1, len(x) - 1, len(y) - 1))
    layers.of(0, out[:, 0])
    return out[:, 0].reshape(6, 6, *out.shape[2:])


def uniform(nu):
    """Stress/mu in a layer of laterally uniform strain, (6, 6)."""
    out = np.zeros((6, 6))
    out[:2, :2] = -2 / (1 - nu) * np.array([[1, nu], [nu, 1]])
    out[5, 5] = -2
    return out
