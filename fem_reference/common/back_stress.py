# SPDX-License-Identifier: MIT
"""J2 plasticity with isotropic hardening and back-stresses (Armstrong and Frederick 1966, Chaboche 1986): the
return map, exact for a constant direction of flow, and its consistent tangent.

Each back-stress is X_k = 2/3 C_k a_k, with d a_k = d e - g_k a_k dp along the plastic strain e. Within a
step, with s the deviator of the trial stress and 0 at its beginning:

    1. b_k = exp(-g_k dp),  i_k = (1 - b_k)/g_k (dp if g_k = 0),  eta = s - sum b_k X_k0,  N = 3/2 eta/J(eta)
    2. J(eta) - 3 G dp - sum C_k i_k = Y(p0 + dp): an equation for dp >= 0
    3. e <- e + dp N,  a_k <- b_k a_k0 + i_k N,  stress = trial stress - 2 G dp N
    4. d stress/d strain = D - 6 G^2 [ (dp/J) (I - n n) + n n/h + (dp/(J h)) Z' N ],  n = N/|N|,
       Z = sum g_k b_k X_k0,  Z' = Z - n (n:Z),  h = 3 G + sum C_k b_k + Y' - N:Z

J(eta)^2 is a quadratic form of the b_k, so that step 2 only needs products of s and X_k0. Of the last term
of 4, the only unsymmetric one, the symmetric part is used: the matrices stay symmetric, and the equilibrium
that is found is the same. Components and units as in `plasticity`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import deviator, mises
from fem_reference.common.plasticity import J2, History, Returned, deviatoric
from sam.scene.section import stated
from sam.scene.yield_curve import YieldCurve, step_energies

MAX_ITERATIONS = 100
"""Limit of the return map: bisection alone has the last digit after 53."""


@dataclass(frozen=True)
class BackStresses:
    """C_k and g_k of some points, both (N, ...), in the units of the caller."""

    modulus: Array
    recovery: Array

    def at(self, points: Bools) -> BackStresses:
        """Those of some points."""
        return BackStresses(self.modulus[:, points], self.recovery[:, points])

    def stresses(self, a: Array) -> Array:
        """X_k of a_k, (N, n, ...)."""
        return self.modulus[:, None] * a / 1.5

    def kept(self, dp: Array) -> tuple[Array, Array]:
        """(b_k, i_k) of step 1."""
        turn = self.recovery * dp
        with np.errstate(divide="ignore", invalid="ignore"):
            path = np.where(self.recovery == 0.0, dp, -np.expm1(-turn) / self.recovery)
        return np.exp(-turn), path


class KinematicJ2(J2):
    """Elastic-plastic material of a body with back-stresses, of all its points."""

    def __init__(
        self, elastic: Elastic, curve: YieldCurve, factor: Array, back: BackStresses, *, shears: int = 1
    ):
        super().__init__(elastic, curve, factor, shears=shears)
        self.back, self.back_stresses = back, len(back.modulus)

    def effective(self, stress: Array, history: History) -> Array:
        """Deviatoric stress less the back-stresses, which the yield stress limits."""
        return deviator(stress) - self.back_stress(history)

    def back_stress(self, history: History) -> Array:
        """The sum of the back-stresses at every point, (n, n_elements, n_points)."""
        return self.back.stresses(stated(history.back)).sum(axis=0)

    def dissipated(self, before: History, after: History) -> Array:
        """Energy that a step dissipates at every point; not what the back-stresses store."""
        strain = (after.plastic_strain - before.plastic_strain) / self.engineering[:, None]
        modulus, recovery = self.back.modulus, self.back.recovery
        length = after.peeq - before.peeq
        back = step_energies(modulus, recovery, stated(before.back), strain, length=length)
        return super().dissipated(before, after) + back.dissipated

    def returned(self, trial: Array, start: History, plastic: Bools) -> Returned:
        """Steps 1 to 4 at the points that yield."""
        s, a, back = deviator(trial[:, plastic]), stated(start.back)[:, :, plastic], self.back.at(plastic)
        factor, curve, peeq = self.factor[plastic], self.curve.at(plastic), start.peeq[plastic]
        X = back.stresses(a)
        dp = self._increment(s, X, back, plastic=plastic, peeq=peeq)
        b, path = back.kept(dp)
        eta = s - np.einsum("kp,ksp->sp", b, X)
        q = mises(eta)
        N = 1.5 * eta / q
        slope = factor * curve.slope(peeq + dp)
        Z = np.einsum("kp,ksp->sp", back.recovery * b, X)
        along = self._product(N, Z)  # N:Z
        h = 3.0 * self.shear + (back.modulus * b).sum(axis=0) + slope - along
        across = Z - N * along / 1.5  # Z'
        n = N / np.sqrt(1.5)
        turned = np.einsum("q,sq,tq->qst", 0.5 * dp / (q * h), across, N)
        loss = (dp / q)[:, None, None] * deviatoric(len(n)) + turned + np.swapaxes(turned, 1, 2)
        loss += np.einsum("q,sq,tq->qst", 1.0 / h - dp / q, n, n)
        change = (b - 1.0)[:, None] * a + path[:, None] * N
        return Returned(dp, N, 6.0 * self.shear**2 * loss, change)

    def _product(self, a: Array, b: Array) -> Array:
        """a:b of tensors (n, m)."""
        return (self.engineering * a * b).sum(axis=0)

    def _increment(self, s: Array, X: Array, back: BackStresses, *, plastic: Bools, peeq: Array) -> Array:
        """Root dp of step 2 by Newton's method, bracketed as in `plastic_increment`."""
        factor, curve, count = self.factor[plastic], self.curve.at(plastic), len(X)
        square = 1.5 * self._product(s, s)
        with_s = np.array([1.5 * self._product(s, back_stress) for back_stress in X])
        mutual = np.array([[1.5 * self._product(X[j], X[k]) for k in range(count)] for j in range(count)])
        dp = lower = np.zeros_like(square)
        upper = (mises(s - X.sum(axis=0)) - factor * curve.stress(peeq)) / (3.0 * self.shear)
        before = np.full_like(square, np.inf)
        rounding = 16.0 * np.finfo(float).eps * (peeq + np.sqrt(square) / (3.0 * self.shear))
        for _ in range(MAX_ITERATIONS):
            b, path = back.kept(dp)
            q = np.sqrt(square - 2.0 * (b * with_s).sum(axis=0) + np.einsum("jq,jkq,kq->q", b, mutual, b))
            limit = factor * curve.stress(peeq + dp) + (back.modulus * path).sum(axis=0)
            f = q - 3.0 * self.shear * dp - limit
            lower, upper = np.where(f > 0.0, dp, lower), np.where(f < 0.0, dp, upper)
            rate = back.recovery * b  # -db/ddp
            turning = ((rate * with_s).sum(axis=0) - np.einsum("jq,jkq,kq->q", rate, mutual, b)) / q
            hardening = factor * curve.slope(peeq + dp) + (back.modulus * b).sum(axis=0)
            step = f / (3.0 * self.shear + hardening - turning)
            done = np.abs(step) <= rounding
            bisect = (np.abs(f) > 0.5 * before) | (dp + step < lower) | (dp + step > upper)
            dp, before = np.where(bisect & ~done, 0.5 * (lower + upper), dp + step), np.abs(f)
            if done.all():
                break
        return dp
