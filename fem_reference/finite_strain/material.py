# SPDX-License-Identifier: MIT
"""J2 plasticity at finite strain: F = Fe Fp, Hencky's elasticity, return map in logarithmic strains.

Simo, Comput. Methods Appl. Mech. Engrg. 99 (1992) 61; de Souza Neto, Peric and Owen, Computational Methods
for Plasticity (2008), Sec. 14.4. Within a step that begins with the plastic deformation Cp = Fp^T Fp, axes
n_a:

    1. b' = F Cp^-1 F^T = sum b_a n_a n_a,   e_a = ln(b_a)/2   trial elastic stretches and strains
    2. Kirchhoff stresses t_a from e_a: return map and consistent tangent C_ab = d t_a/d e_b of small strain
    3. Cp^-1 <- F^-1 (sum exp(2 e_a) n_a n_a) F^-T, with the returned elastic strains: the exponential map
    4. P = t F^-T,   dP = (dt - t dL^T) F^-T,   dL = dF F^-1,
       dt_aa = sum_b C_ab dL_bb,   dt_12 = (t_1 - t_2)/(b_1 - b_2) (b_2 dL_12 + b_1 dL_21)

As the deviator of t is a multiple of that of e, step 4 needs no special case of equal stretches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.plasticity import J2, History, plastic_increment
from fem_reference.finite_strain.kinematics import (
    Principal,
    composed,
    deformation,
    exponential_change,
    logarithm,
    principal,
    pushed_change,
)

DEVIATORIC = np.eye(3) - 1.0 / 3.0
"""Deviator of three principal values."""
PLANE = ((0, 0, 0), (2, 1, 1), (3, 0, 1), (4, 1, 0))
"""Components of a gradient in the plane: number, row, column."""


@dataclass(frozen=True)
class Update:
    """Outcome of a step at given gradients.

    stress: first Piola-Kirchhoff (n_elements, n_points, 5); tangent: its derivative by the gradient (.., 5,
    5); kirchhoff: principal Kirchhoff stresses (.., 3); history at the end of the step, its plastic strain
    -ln(Cp^-1)/2, engineering shear.
    """

    stress: Array
    tangent: Array
    kirchhoff: Array
    history: History


class Hencky:
    """Elastic-plastic material at finite strain, from that of small strain; strain: unit."""

    def __init__(self, small: J2, strain: float):
        self.small, self.strain = small, strain
        self.shape = small.shape
        self.bulk = float(small.stiffness[0, :3].sum() / 3.0)

    def update(self, gradient: Array, start: History) -> Update:
        """Stress, tangent, history at grad u (n_elements, n_points, 5), from `start`."""
        unit, shear = self.strain, self.small.shear
        plane, hoop = deformation(gradient, unit)
        log_plastic = np.moveaxis(start.plastic_strain, 0, -1) * [1.0, 1.0, 1.0, 0.5]
        before = exponential_change(-2.0 * unit * log_plastic)
        change = principal(pushed_change(plane, hoop, before))  # of b' from 1
        trial = np.log1p(change.values) / (2.0 * unit)  # step 1
        mean = trial.mean(axis=-1, keepdims=True)
        s = 2.0 * shear * (trial - mean)
        q = np.sqrt(1.5) * np.linalg.norm(s, axis=-1)
        plastic, step, slope = self._returned(q, start.peeq)  # step 2
        q = np.where(q > 0.0, q, 1.0)
        share = 1.0 - 3.0 * shear * step / q
        stress = 3.0 * self.bulk * mean + share[..., None] * s
        M = np.linalg.inv(plane + np.eye(2)) @ change.axes
        onto = mapping(change.axes, M, 1.0 / (1.0 + hoop))
        C = principal_tangent(s, q, step, slope=slope, shear=shear, bulk=self.bulk)
        spatial = self._spatial(change, stress, share, C)
        history = start
        if plastic.any():
            elastic = trial - step[..., None] * 1.5 * s / q[..., None]
            after = composed(M, np.exp(2.0 * unit * elastic))  # step 3
            after[..., 1] /= (1.0 + hoop) ** 2
            total = np.where(plastic[..., None], -logarithm(after) / (2.0 * unit), log_plastic)
            total = total * [1.0, 1.0, 1.0, 2.0]
            history = History(np.ascontiguousarray(np.moveaxis(total, -1, 0)), start.peeq + step)
        piola = np.einsum("...ka,...k->...a", onto[..., :3, :], stress)  # step 4
        return Update(piola, np.swapaxes(onto, -1, -2) @ spatial @ onto, stress, history)

    def _returned(self, q: Array, peeq: Array) -> tuple[Bools, Array, Array]:
        """Points that yield, plastic increment and slope after it; elsewhere 0 and inf."""
        plastic = self.small.yields(q, peeq)
        step, slope = np.zeros_like(q), np.full_like(q, np.inf)
        if plastic.any():
            before, factor, curve = peeq[plastic], self.small.factor[plastic], self.small.curve.at(plastic)
            step[plastic] = plastic_increment(q[plastic], before, factor, shear=self.small.shear, curve=curve)
            slope[plastic] = factor * curve.slope(before + step[plastic])
        return plastic, step, slope

    def _spatial(self, change: Principal, stress: Array, share: Array, C: Array) -> Array:
        """(..., 5, 5): dt - t dL^T of step 4 over dL, on the principal axes: 1 stands for r, 2 for z."""
        b = 1.0 + change.values
        a = np.zeros((*b.shape[:-1], 5, 5))
        a[..., :3, :3] = C
        a[..., range(3), range(3)] -= self.strain * stress
        x = change.difference / b[..., 2]
        ratio = np.where(x > 0.0, np.log1p(x) / np.where(x > 0.0, x, 1.0), 1.0) / b[..., 2]
        both = self.small.shear * share * ratio
        a[..., 3, 3] = a[..., 4, 3] = both * b[..., 2]
        a[..., 3, 4] = a[..., 4, 4] = both * b[..., 0]
        a[..., 3, 4] -= self.strain * stress[..., 0]
        a[..., 4, 3] -= self.strain * stress[..., 2]
        return a


def principal_tangent(s: Array, q: Array, step: Array, *, slope: Array, shear: float, bulk: float) -> Array:
    """(..., 3, 3) consistent tangent C in principal values, step 4 of
    `fem_reference.common.plasticity`; s, q: deviator and von Mises stress of the trial stress;
    step, slope: 0 and inf without yield.
    """
    N = np.sqrt(1.5) * s / q[..., None]
    ratio, along = step / q, 1.0 / (3.0 * shear + slope)
    loss = (
        ratio[..., None, None] * DEVIATORIC
        + (along - ratio)[..., None, None] * N[..., :, None] * N[..., None, :]
    )
    return bulk + 2.0 * shear * DEVIATORIC - 6.0 * shear**2 * loss


def mapping(axes: Array, M: Array, hoop: Array) -> Array:
    """(..., 5, 5) from dF to dL on the axes, transposed from t to P. M: F^-1 axes; hoop: of F^-1."""
    onto = np.zeros((*hoop.shape, 5, 5))
    for row, k, m in PLANE:
        for column, i, j in PLANE:
            onto[..., row, column] = axes[..., i, k] * M[..., j, m]
    onto[..., 1, 1] = hoop
    return onto
