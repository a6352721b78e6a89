# SPDX-License-Identifier: MIT
"""The energy balance of a body over its load steps, from quantities that either model can give.

The surface tractions t do the work W = integral of t . du on a body. It is stored elastically or dissipated,

    W = E + D,    E = 1/2 int sigma : C^-1 : sigma dV,    D = int int sigma : d eps_p dV,                  (a)

and a material of von Mises dissipates the work of its yield stress, whatever the path: D = int Phi(peeq) dV
with Phi the integral of sigma_y from 0 to peeq (b). With sigma = sigma_t + sigma_r of the tractions on the
elastic body and of the plastic strain, whose product has no energy (sigma_r balances no load), E = 1/2 int
t . u_t dA - 1/2 int sigma_r : eps_p dV (c).

Over finite steps W is summed by the trapezoidal rule. Summed likewise, D closes (a) at any number of steps
where the discrete operators are reciprocal: that is an error of space alone. D by (b) is that of the
material, which backward Euler follows to first order in the steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.scene import YieldCurve

POINTS, GRADING = 24, 4  # of Gauss's rule in s, peeq = s^GRADING: Swift's law rises within microstrains


@dataclass(frozen=True)
class Balance:
    """Energies in J after each step, the unloaded virgin body first; all (n + 1,).

    force in N; approach in m; work: of the surface tractions; pressing: of the force on the counter-body,
    integral of F d delta; elastic: E; stored: the part of E that the residual stress holds, None where it
    is not told apart; dissipated: D by (b); flowed: D by the trapezoidal rule; beyond: work on what lies
    outside of the mesh, zero for a half-space.
    """

    force: np.ndarray
    approach: np.ndarray
    work: np.ndarray
    elastic: np.ndarray
    dissipated: np.ndarray
    flowed: np.ndarray
    beyond: np.ndarray
    stored: np.ndarray | None = None

    @property
    def pressing(self) -> np.ndarray:
        return along_path([self.force], [self.approach])

    @property
    def error_of_cells(self) -> np.ndarray:
        """W - E - D over the largest W, with D by the trapezoidal rule."""
        return (self.work - self.elastic - self.beyond - self.flowed) / np.abs(self.work).max()

    @property
    def error_of_steps(self) -> np.ndarray:
        """What the two sums of D differ by, over the largest W; both errors together are W - E - D of the
        material.
        """
        return (self.flowed - self.dissipated) / np.abs(self.work).max()

    @property
    def peak(self) -> int:
        """The state under the largest force."""
        return int(np.argmax(self.force))


def along_path(forces, motions) -> np.ndarray:
    """(n + 1,) integral of sum(f . du) up to each state by the trapezoidal rule; lists of (n + 1, ...)
    arrays.
    """
    total = 0.0
    for f, u in zip(forces, motions, strict=True):
        f, u = (np.asarray(each, dtype=float).reshape(len(each), -1) for each in (f, u))
        total = total + np.sum((f[1:] + f[:-1]) / 2 * np.diff(u, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(total)])


def plastic_work(curve: YieldCurve, peeq: np.ndarray) -> np.ndarray:
    """Phi(peeq) = integral of sigma_y from 0 to peeq, in the unit of the curve, by Gauss's rule."""
    s, w = np.polynomial.legendre.leggauss(POINTS)
    s, w = (s + 1) / 2, w / 2
    total = np.zeros_like(peeq)
    for at, weight in zip(s, w, strict=True):
        total = total + weight * GRADING * at ** (GRADING - 1) * curve.stress(peeq * at**GRADING)
    return peeq * total
