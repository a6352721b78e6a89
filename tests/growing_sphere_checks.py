# SPDX-License-Identifier: MIT
"""An elasto-plastic body in which a sphere grows, by radial elements: the independent answer to
``verification.reference.misfit_sphere``.

Linear elements from the centre to ENDS radii with one point each, flow theory with backward Euler, Newton's
method; beyond them an elastic body whose displacement falls with 1/r^2. Nothing is taken from the closed form
but the misfit strain itself.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

ENDS = 2.0
YOUNG, NU = 210e9, 0.3
LAWS = {
    "linear": (0.02, lambda peeq: 1e9 + 10e9 * peeq),
    "swift": (0.03, lambda peeq: 945e6 * (20 + 1e6 * peeq) ** 0.121),
    "perfect": (0.04, lambda peeq: 1e9 + 0 * peeq),
}
"""Misfit strains at the centre with their hardening laws, yield stress in Pa."""


@dataclass(frozen=True)
class RadialFields:
    """At the points of the elements: radius over that of the sphere, s_theta - s_r and s_r in Pa, peeq."""

    x: np.ndarray
    deviator: np.ndarray
    radial: np.ndarray
    peeq: np.ndarray


def radial_elements(law, strain, shares, count=400):
    """The fields after the misfit strain `strain(x)` has taken the shares, one after the other."""
    shear, bulk = YOUNG / (2 * (1 + NU)), YOUNG / (3 * (1 - 2 * NU))
    nodes = np.linspace(0.0, ENDS, count + 1)
    h, x = np.diff(nodes), (nodes[1:] + nodes[:-1]) / 2
    along, across = np.stack([-1 / h, 1 / h]), np.stack([0.5 / x, 0.5 / x])  # strains of a node's u
    q, peeq, u = np.zeros(count), np.zeros(count), np.zeros(count + 1)
    for share in shares:
        for _ in range(30):
            pairs = np.stack([u[:-1], u[1:]])
            e_r, e_t = (along * pairs).sum(0), (across * pairs).sum(0)
            trial = 2 * shear * (e_t - e_r - 3 * q)
            dq, softer = _returned(np.abs(trial), peeq, law, shear)
            deviator = np.sign(trial) * (np.abs(trial) - 6 * shear * dq)
            pressure = bulk * (e_r + 2 * e_t - 3 * share * strain(x))
            s_r = pressure - 2 / 3 * deviator
            weight, slope = h * x**2, 2 * shear * softer
            of_r, of_t = weight * s_r, 2 * weight * (pressure + deviator / 3)
            forces = np.zeros(count + 1)
            for k in (0, 1):
                np.add.at(forces, np.arange(count) + k, along[k] * of_r + across[k] * of_t)
            forces[-1] += 4 * shear * ENDS * u[-1]
            mean, apart = along + 2 * across, across - along
            matrix = weight * (bulk * mean[:, None] * mean + 2 / 3 * slope * apart[:, None] * apart)
            banded = np.zeros((2, count + 1))
            banded[1, :-1] += matrix[0, 0]
            banded[1, 1:] += matrix[1, 1]
            banded[0, 1:] = matrix[0, 1]
            banded[1, -1] += 4 * shear * ENDS
            forces[0], banded[1, 0], banded[0, 1] = 0.0, 1.0, 0.0  # the centre stays
            change = solveh_banded(banded, -forces)
            u = u + change
            if np.abs(change).max() < 1e-13 * np.abs(u).max():
                break
        q, peeq = q + np.sign(trial) * dq, peeq + 2 * dq
    return RadialFields(x, deviator, s_r, peeq)


def _returned(size, peeq, law, shear):
    """(dq, d|D|/d trial) of size - 6 shear dq = Y(peeq + 2 dq)."""
    dq, yields, step = np.zeros_like(size), size > law(peeq), 1e-8
    for _ in range(30):
        slope = 2 * (law(peeq + 2 * dq + step) - law(peeq + 2 * dq)) / step
        dq = np.maximum(dq + (size - 6 * shear * dq - law(peeq + 2 * dq)) / (6 * shear + slope), 0.0)
    return np.where(yields, dq, 0.0), np.where(yields, slope / (6 * shear + slope), 1.0)
