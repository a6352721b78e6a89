# SPDX-License-Identifier: MIT
"""Newton's method with GMRES for the increment of a load step: slower than Anderson's, and sure where that stagnates.

The residual is image(x) - x on the cells whose trial stress yields. Its derivative follows the evaluation: plastic strain ->
stress and surface -> contact with its set of cells held -> stress -> consistent tangent of the return map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from sam.plastic.return_map import SHEAR, contraction, deviator

FORCING = 1e-2  # GMRES reduces the linear residual to this share
KRYLOV = 40  # directions at most
CONTACT_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Tangent:
    """Derivative of d eps_p = 3/2 gamma s/q of the cells that yield: b is a function of the trial deviator s.

    d(d eps_p) = 3/2 [ (gamma' - gamma/q) n (n : ds) 3/2 + gamma/q ds ],  n = s/q,  gamma' = 1/(3 m + H)
    """

    normal: np.ndarray  # s/q, (6, n)
    ratio: np.ndarray  # gamma/q, (n,)
    slope: np.ndarray  # gamma', (n,)

    def __call__(self, change: np.ndarray) -> np.ndarray:
        """Change of the increment for a change of the trial stress, both (6, n)."""
        ds = deviator(change)
        along = 1.5 * contraction(self.normal, ds)
        return 1.5 * (self.ratio * ds + (self.slope - self.ratio) * along * self.normal)


def direction(problem, state, x: np.ndarray, stress: np.ndarray, pressure: np.ndarray, m: float) -> np.ndarray:
    """The Newton correction of x, (6, n_layers, nx, ny), with the contact set of `pressure`. One operator call a direction."""
    material = problem.material
    trial = deviator(stress) + 2 * m * x
    q = np.sqrt(1.5 * contraction(trial, trial))
    yielding = q > material.yield_stress(state.alpha)
    right = (x - problem.image(state, x, stress, m))[:, yielding]
    # cells that no longer yield give their increment up at once
    out = np.where(yielding, 0.0, -x)
    gamma = problem.multiplier(state, q, yielding, m)
    factor = np.broadcast_to(material.factor[:, None, None], q.shape)[yielding]
    slope = factor * material.curve.slope(state.alpha[yielding] + gamma)
    tangent = Tangent(trial[:, yielding] / q[yielding], gamma / q[yielding], 1 / (3 * m + slope))
    contact = pressure > 0
    weight = np.sqrt(SHEAR)[:, None]

    def moved(change: np.ndarray) -> np.ndarray:
        """Change of the stress in the yielding cells, for a change of the increment on the whole box."""
        transformed = problem.operator.transformed(change)
        lift = problem.operator.displacement(transformed) / problem.operator.hx
        p = problem.contact.change(lift, contact, CONTACT_TOLERANCE) if contact.any() else None
        both = problem.operator.stress(None if p is None else p * problem.unit, transformed)
        return both[:, yielding]

    def apply(vector: np.ndarray) -> np.ndarray:
        v = vector.reshape(6, -1) / weight
        change = np.zeros_like(x)
        change[:, yielding] = v
        return (weight * (tangent(moved(change) + 2 * m * v) - v)).ravel()

    if out.any():
        right = right - tangent(moved(out))
    size = right.size
    found, _ = gmres(
        LinearOperator((size, size), matvec=apply), (weight * right).ravel(), rtol=FORCING, restart=KRYLOV, maxiter=1
    )
    out[:, yielding] = found.reshape(6, -1) / weight
    return out
