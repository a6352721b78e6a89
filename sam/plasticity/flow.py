# SPDX-License-Identifier: MIT
"""How the material of a point yields over a load step: the increment of its plastic strain for a trial
stress, and how far a pair of both is from obeying the yield condition.

Backward-Euler radial return of the von Mises yield condition with isotropic hardening (Simo & Hughes 1998,
box 3.1): with the trial stress s^tr (deviator) and q = sqrt(3/2 s^tr : s^tr), the increment of the
accumulated plastic strain solves

    q - 3 m dgamma = sigma_y(alpha + dgamma),        d eps_p = 3/2 dgamma s^tr/q,                      (a)

where m, in Pa, is the stiffness of the return map: that with which plastic strain lowers its own stress. For
a homogeneously strained body m = mu. A fixed point of trial = sigma(eps_p) + 2 m d eps_p is the same for
every m > 0, so m is free to speed it up. Equations (a) to (g) are counted through `sam.plasticity`.

Back-stresses: nonlinear kinematic hardening of Armstrong & Frederick (1966), several of them as Chaboche
(1986), integrated exactly along a constant direction of flow.

Each back-stress X_k = 2/3 C_k a_k follows

    d X_k = 2/3 C_k d eps_p - g_k X_k dp,      that is      d a_k = d eps_p - g_k a_k dp,                 (b)

with g_k = 0 for Prager's linear law. While the plastic strain grows by dp N with N : N = 3/2 and N constant,

    a_k1 = b_k a_k0 + i_k N,      b_k = exp(-g_k dp),      i_k = (1 - b_k)/g_k   (dp for g_k = 0).         (c)

Backward Euler of (b) has 1/(1 + g_k dp) in place of the exponential, an error of first order; (c) has none on
a straight path of strain. The return along N = 3/2 eta/J(eta), eta = s_tr - sum b_k X_k0, solves

    F(dp) = J(eta(dp)) - 3 m dp - sum C_k i_k(dp) - sigma_y(p0 + dp) = 0,                                 (d)

one scalar equation in each cell (as Kobayashi & Ohno 2002 have it for backward Euler), with a single root in
(0, F(0)/(3 m)], because J(X_k) <= C_k/g_k makes F fall everywhere.

The state is a_k, of the size of a strain: where material moves to another depth its back-stress changes as
its yield stress does, and means of a_k over cells stay where J(X_k) <= C_k/g_k.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.operators import yielding
from sam.plasticity.state import MaterialFields
from sam.scene.section import stated
from sam.scene.yield_curve import YieldCurve, plastic_work, step_energies

ITERATIONS = 50
ROUNDING = 1e-14  # of the yield stress
SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor


def deviator(stress: Array) -> Array:
    """Deviatoric part of (6, ...)."""
    out = stress.copy()
    out[:3] -= (stress[0] + stress[1] + stress[2]) / 3
    return out


def contraction(a: Array, b: Array) -> Array:
    """Double contraction a : b of symmetric tensors 11 22 33 23 13 12, (6, ...), in any units: (...).

    >>> float(contraction(np.array([1.0, 0, 0, 0, 0, 1]), np.array([2.0, 0, 0, 0, 0, 3])))  # 1 2 + 2 (1 3)
    8.0
    """
    return (SHEAR @ (a * b).reshape(6, -1)).reshape(a.shape[1:])


def equivalent_strain(strain: Array) -> Array:
    """sqrt(2/3 e : e) of a plastic strain (6, ...)."""
    return np.sqrt(2 / 3 * contraction(strain, strain))


def mises(s: Array) -> Array:
    """sqrt(3/2 s : s) of a deviator (6, ...)."""
    return np.sqrt(1.5 * contraction(s, s))


def plastic_multiplier(
    q: Array,
    alpha: Array,
    curve: YieldCurve,
    factor: Array,
    *,
    m3: float,
    near: Array | None = None,
) -> Array:
    """dgamma of (a), (n,), zero where paper Eq. 8 holds; m3: 3 m. Newton's method from `near`, or zero,
    bracketed: monotone from the left of the answer for a concave curve.
    """
    low, high = np.zeros_like(q), q / m3
    gamma = np.zeros_like(q) if near is None else np.minimum(near, high)
    flowing = yielding(q, factor * curve.stress(alpha))
    for _ in range(ITERATIONS):
        yield_stress = factor * curve.stress(alpha + gamma)
        excess = np.where(flowing, q - m3 * gamma - yield_stress, 0.0)
        done = np.abs(excess) <= ROUNDING * yield_stress
        if done.all():
            break
        low, high = np.where(excess > 0, gamma, low), np.where(excess < 0, gamma, high)
        newton = gamma + excess / (m3 + factor * curve.slope(alpha + gamma))
        inside = (newton > low) & (newton < high)
        gamma = np.where(done, gamma, np.where(inside, newton, (low + high) / 2))
    return np.where(flowing, gamma, 0.0)


@dataclass(frozen=True)
class Material:
    """Shear modulus in Pa, yield curve of each point, and factor of its yield stress, which broadcasts."""

    mu: float
    curve: YieldCurve
    factor: Array
    hardens_back: ClassVar[bool] = False

    def yield_stress(self, peeq: Array) -> Array:
        """In Pa, of the shape of the points."""
        return self.factor * self.curve.stress(peeq)  # phi of paper Eq. 8, with Eq. 18

    @cached_property
    def initial_yield(self) -> float:
        """The smallest yield stress of unstrained material, in Pa."""
        return float(self.yield_stress(np.zeros(1)).min())

    def at(self, cells: Mask) -> Material:
        """The material of some cells, (n_layers, nx, ny), in a row: for points (..., n)."""
        return replace(
            self, curve=self.curve.at(cells), factor=np.broadcast_to(self.factor, cells.shape)[cells]
        )

    def back_stress(self, fields: MaterialFields) -> Array | None:
        """The sum of the back-stresses in Pa, (6, ...); None without any."""
        return None

    def virgin(self, shape: tuple[int, ...]) -> MaterialFields:
        """The fields of points that never yielded."""
        return MaterialFields.zero(shape)

    def flow(self, before: MaterialFields) -> Flow:
        """How it yields over a step that begins in a state."""
        return Flow(self, before)


@dataclass(frozen=True)
class Flow:
    """Isotropic hardening over a step. before: the fields at its beginning."""

    material: Material
    before: MaterialFields

    @cached_property
    def limit(self) -> Array:
        """The yield stress at the beginning of the step in Pa, of the shape of the points."""
        return self.material.yield_stress(self.before.peeq)

    def returned(self, trial: Array, m: float, *, near: Array) -> Array:
        """The increment for a trial stress, (6, ...), zero where that does not yield; near: its length."""
        q = mises(trial)
        flowing = yielding(q, self.limit)
        scale = np.zeros_like(q)
        near = np.broadcast_to(near, q.shape)
        scale[flowing] = 1.5 * self.multiplier(q, flowing, m=m, near=near) / q[flowing]
        return scale * trial

    def multiplier(self, q: Array, flowing: Mask, *, m: float, near: Array | None = None) -> Array:
        """Increment of the accumulated strain of points that yield, (n,), for their trial stress q."""
        material = self.material
        factor = np.broadcast_to(material.factor, q.shape)[flowing]
        near = None if near is None else near[flowing]
        curve = material.curve.at(flowing)
        return plastic_multiplier(q[flowing], self.before.peeq[flowing], curve, factor, m3=3 * m, near=near)

    def effective(self, x: Array, s: Array) -> Array:
        """The stress that the yield stress limits at the end of an increment x, (6, ...)."""
        return s

    def excess(self, x: Array, s: Array) -> float:
        """The largest (q - sigma_y)/sigma_y, paper Eq. 8, of the stress s at the end of an increment x."""
        limit = self.material.yield_stress(self.before.peeq + equivalent_strain(x))
        excess = (mises(self.effective(x, s)) - limit) / limit  # paper Eq. 8
        return float(excess.max(initial=0.0))

    def increment(self, x: Array, length: Array) -> MaterialFields:
        """Increment of all fields of the material by a plastic strain x of this accumulated length."""
        return MaterialFields(strain=x, peeq=length)

    def dissipated(self, increment: MaterialFields) -> Array:
        """Energy that an increment dissipates, of the shape of the points, in J/m^3."""
        energy, flowing = np.zeros_like(increment.peeq), increment.peeq > 0
        start = self.before.peeq[flowing]
        factor = np.broadcast_to(self.material.factor, flowing.shape)[flowing]
        curve = self.material.curve.at(flowing)
        energy[flowing] = factor * plastic_work(curve, start + increment.peeq[flowing], start)
        return energy


KINEMATIC_ITERATIONS = 60  # bisection alone has the last digit after 53
KINEMATIC_ROUNDING = 1e-15  # of the sum of what is added in (d): four to five units in the last place
CurveOfIncrement = Callable[[Array], tuple[Array, Array]]
"""Increment of the accumulated strain -> yield stress, and its slope, in Pa."""


@dataclass(frozen=True)
class BackStressFields:
    """Constants of the back-stresses: C_k in Pa, with the factor of the yield stress, and g_k, (N, ...)."""

    modulus: Array
    recovery: Array

    def at(self, points: Mask) -> BackStressFields:
        """Those of some of the points, (N, n)."""

        def of(values: Array) -> Array:
            return np.broadcast_to(values, (len(values), *points.shape))[:, points]

        return BackStressFields(of(self.modulus), of(self.recovery))

    def of_strains(self, strains: Array) -> Array:
        """X_k in Pa of the a_k, both (N, 6, cells)."""
        return 2 / 3 * self.modulus[:, None] * strains

    def recovered(self, gamma: Array) -> tuple[Array, Array]:
        """(1 - b_k, i_k) of (c) after an increment gamma of the accumulated strain, (N, cells) both."""
        lost = -np.expm1(-self.recovery * gamma)
        steps = np.divide(lost, self.recovery, out=gamma + 0 * lost, where=self.recovery > 0)
        return lost, steps

    def change(self, start: Array, x: Array, length: Array) -> Array:
        """a_k1 - a_k0 of (c), (N, 6, cells), for a plastic strain x (6, cells) of this length (cells)."""
        lost, steps = self.recovered(length)
        along = np.divide(steps, length, out=np.zeros_like(steps), where=length > 0)
        return along[:, None] * x - lost[:, None] * start


def kinematic_multiplier(
    trial: Array,
    start: BackStresses,
    back: BackStressFields,
    curve: CurveOfIncrement,
    *,
    m3: float,
    near: Array,
) -> tuple[Array, Array]:
    """(dp, (n,), and eta in Pa, (6, n)) of (d) for n cells that yield, as `plastic_multiplier`; trial:
    deviatoric; start, back: back-stresses at the beginning and their constants.
    """
    xi = trial - start.sum
    weighted = (1.5 * SHEAR)[:, None] * xi
    cross = np.einsum("sn,ksn->kn", weighted, start.each)
    turns = _Turns(xi, start, np.einsum("sn,sn->n", weighted, xi), cross)
    low, high = np.zeros(trial.shape[1]), (turns.square**0.5 - curve(np.zeros(trial.shape[1]))[0]) / m3
    gamma = np.clip(near, low, high)
    for _ in range(KINEMATIC_ITERATIONS):
        lost, steps = back.recovered(gamma)
        (q, turning, rounded), (limit, slope) = turns.mises(lost, back.recovery), curve(gamma)
        straight = m3 * gamma + (back.modulus * steps).sum(axis=0) + limit
        excess = q - straight
        done = np.abs(excess) <= KINEMATIC_ROUNDING * (rounded + straight)
        if done.all():
            break
        low, high = np.where(excess > 0, gamma, low), np.where(excess < 0, gamma, high)
        harder = (back.modulus * (1 - lost)).sum(axis=0) + slope
        newton = gamma + excess / (m3 + harder - turning)  # over -dF/ddp
        inside = (newton > low) & (newton < high)
        gamma = np.where(done, gamma, np.where(inside, newton, (low + high) / 2))
    return gamma, turns.effective(back.recovered(gamma)[0])


@dataclass(frozen=True)
class BackStresses:
    """The back-stresses X_k0 at the beginning of a step in Pa, (N, 6, ...), and 3/2 X_j0 : X_k0."""

    each: Array
    mutual: Array

    @classmethod
    def of(cls, each: Array) -> Self:
        """Of the X_k0."""
        return cls(each, np.einsum("s,js...,ks...->jk...", 1.5 * SHEAR, each, each, optimize=True))

    @cached_property
    def sum(self) -> Array:
        """(6, ...) in Pa."""
        return np.asarray(self.each.sum(axis=0))

    @cached_property
    def sizes(self) -> Array:
        """J(X_k0) in Pa, (N, ...)."""
        return np.asarray(np.sqrt(np.einsum("kk...->k...", self.mutual)))

    def at(self, points: Mask) -> BackStresses:
        """Those of some of the points, in a row."""
        return BackStresses(self.each[:, :, points], self.mutual[:, :, points])


@dataclass(frozen=True)
class _Turns:
    """eta = xi + sum (1 - b_k) X_k0 of (d): 3/2 eta : eta is a quadratic form of 1 - b_k. xi: trial stress
    less all X_k0, (6, n); square: 3/2 xi : xi, (n,); cross: 3/2 xi : X_k0, (N, n).
    """

    xi: Array
    start: BackStresses
    square: Array
    cross: Array

    def mises(self, lost: Array, recovery: Array) -> tuple[Array, Array, Array]:
        """J(eta) after 1 - b_k, its slope over dp, and the size that its rounding goes with."""
        with_lost = self.cross + np.einsum("jkn,kn->jn", self.start.mutual, lost)
        q = np.sqrt(self.square + ((self.cross + with_lost) * lost).sum(axis=0))
        turning = (with_lost * recovery * (1 - lost)).sum(axis=0) / q
        return q, turning, (np.sqrt(self.square) + (self.start.sizes * lost).sum(axis=0)) ** 2 / q

    def effective(self, lost: Array) -> Array:
        """The tensor eta in Pa, (6, n)."""
        return np.asarray(self.xi + np.einsum("kn,ksn->sn", lost, self.start.each))


@dataclass(frozen=True)
class KinematicMaterial(Material):
    """A material with back-stresses."""

    back: BackStressFields
    hardens_back: ClassVar[bool] = True

    def back_stress(self, fields: MaterialFields) -> Array:
        """The sum of the back-stresses in Pa, (6, ...)."""
        return self.back.of_strains(stated(fields.back)).sum(axis=0)

    def at(self, cells: Mask) -> KinematicMaterial:
        """The material of some cells, (n_layers, nx, ny), in a row: for points (..., n)."""
        plain, back = super().at(cells), self.back.at(cells[None])
        in_row = BackStressFields(back.modulus[:, None], back.recovery[:, None])
        return replace(self, curve=plain.curve, factor=plain.factor, back=in_row)

    def virgin(self, shape: tuple[int, ...]) -> MaterialFields:
        """The fields of points that never yielded."""
        return MaterialFields.zero(shape, len(self.back.modulus))

    def flow(self, before: MaterialFields) -> Flow:
        """How it yields over a step that begins in a state."""
        return KinematicFlow(self, before)


@dataclass(frozen=True)
class KinematicFlow(Flow):
    """Isotropic hardening and back-stresses over a step."""

    material: KinematicMaterial

    @property
    def start(self) -> Array:
        """The strains a_k of the back-stresses at the beginning, (N, 6, ...)."""
        return stated(self.before.back)

    @cached_property
    def at_start(self) -> BackStresses:
        """The back-stresses at the beginning."""
        return BackStresses.of(self.material.back.of_strains(self.start))

    def returned(self, trial: Array, m: float, *, near: Array) -> Array:
        """As without back-stress, the return of the stress less what is left of the back-stresses."""
        flowing = yielding(mises(trial - self.at_start.sum), self.limit)
        increment = np.zeros_like(trial)
        if not flowing.any():
            return increment
        factor = np.broadcast_to(self.material.factor, flowing.shape)[flowing]
        before, curve = self.before.peeq[flowing], self.material.curve.at(flowing)
        gamma, eta = kinematic_multiplier(
            trial[:, flowing],
            self.at_start.at(flowing),
            self.material.back.at(flowing),
            lambda dp: (factor * curve.stress(before + dp), factor * curve.slope(before + dp)),
            m3=3 * m,
            near=np.broadcast_to(near, flowing.shape)[flowing],
        )
        increment[:, flowing] = 1.5 * gamma / mises(eta) * eta
        return increment

    def effective(self, x: Array, s: Array) -> Array:
        """The deviatoric stress less the back-stresses at the end of an increment x."""
        end = self.start + self.material.back.change(self.start, x, equivalent_strain(x))
        return s - self.material.back.of_strains(end).sum(axis=0)

    def increment(self, x: Array, length: Array) -> MaterialFields:
        """Increment of all fields of the material by a plastic strain x of this accumulated length."""
        return MaterialFields(strain=x, peeq=length, back=self.material.back.change(self.start, x, length))

    def dissipated(self, increment: MaterialFields) -> Array:
        """Energy that an increment dissipates in J/m^3, without what the back-stresses store."""
        modulus, recovery = self.material.back.modulus, self.material.back.recovery
        back = step_energies(modulus, recovery, self.start, increment.strain, length=increment.peeq)
        return super().dissipated(increment) + back.dissipated
