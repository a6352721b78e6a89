# SPDX-License-Identifier: MIT
"""The energy balance of a body over its load steps, from quantities that either model can give.

The surface tractions t do the work W = integral of t . du on a body. It is stored elastically or dissipated,

    W = E + D,    E = 1/2 int sigma : C^-1 : sigma dV,    D = int int sigma : d eps_p dV,                  (a)

and a material of von Mises dissipates the work of its yield stress, whatever the path: D = int Phi(peeq) dV
with Phi the integral of sigma_y from 0 to peeq (b). Back-stresses store a part W_X of the plastic work, which
then is W_X + D, and dissipate by their recovery, see `sam.scene.yield_curve`. With sigma = sigma_t + sigma_r
of the tractions on the elastic body and of the plastic strain, whose product has no energy (sigma_r balances
no load), E = 1/2 int t . u_t dA - 1/2 int sigma_r : eps_p dV (c).

Over finite steps W is summed by the trapezoidal rule. Summed likewise, D closes (a) at any number of steps
where the discrete operators are reciprocal: that is an error of space alone. D by (b) is that of the
material, which backward Euler follows to first order in the steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sam.scene import step_energies, stored_energy


@dataclass(frozen=True)
class Balance:
    """Energies in J after each step, the unloaded virgin body first; all (n + 1,). force in N; approach in m;
    work: of the surface tractions; pressing: of the force on the counter-body, integral of F d delta;
    elastic: E; stored: the part of E that the residual stress holds, None where it is not told apart;
    dissipated: D by (b), of back-stresses too; flowed: the plastic work D + W_X by the trapezoidal rule;
    beyond: work on what lies outside of the mesh, zero for a half-space; back: W_X; within: plastic work of
    stresses that vary within the cells of SAM, which the tractions do not do, as the operators take the
    strain of a cell as uniform: an error of space.
    """

    force: np.ndarray
    approach: np.ndarray
    work: np.ndarray
    elastic: np.ndarray
    dissipated: np.ndarray
    flowed: np.ndarray
    beyond: np.ndarray
    stored: np.ndarray | None = None
    back: np.ndarray | float = 0.0
    within: np.ndarray | float = 0.0

    @property
    def pressing(self) -> np.ndarray:
        return along_path([self.force], [self.approach])

    @property
    def error_of_cells(self) -> float:
        """The most that W - E is off the trapezoidal plastic work less `within`, over the largest W."""
        missing = self.work - self.elastic - self.beyond - self.flowed + self.within
        return float(np.abs(missing).max() / np.abs(self.work).max())

    @property
    def error_of_steps(self) -> float:
        """The most that the plastic work is off W_X + D, over the largest W: the error of the steps."""
        return float(np.abs(self.flowed - self.dissipated - self.back).max() / np.abs(self.work).max())

    @property
    def peak(self) -> int:
        """The state under the largest force."""
        return int(np.argmax(self.force))


def along_path(forces, motions) -> np.ndarray:
    """(n + 1,) integral of sum(f . du) up to each state by the trapezoidal rule; of (n + 1, ...) lists."""
    total = 0.0
    for f, u in zip(forces, motions, strict=True):
        f, u = (np.asarray(each, dtype=float).reshape(len(each), -1) for each in (f, u))
        total = total + np.sum((f[1:] + f[:-1]) / 2 * np.diff(u, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(total)])


def back_energies(moduli, recovery, fields: Sequence, weights) -> tuple[np.ndarray, np.ndarray]:
    """(n + 1,) energies of the back-stresses in each state: stored, and dissipated up to it. fields: of each
    state plastic strain, strains of the back-stresses and peeq at points with the weights in m3.
    """
    spent = [0.0]
    for (old, back, before), (new, _, now) in pairwise(fields):
        found = step_energies(moduli, recovery, back, new - old, length=now - before)
        spent.append(float(np.sum(weights * found.dissipated)))
    stored = [float(np.sum(weights * stored_energy(moduli, back))) for _, back, _ in fields]
    return np.array(stored), np.cumsum(spent)
