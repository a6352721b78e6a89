# SPDX-License-Identifier: MIT
"""How the material of a point yields over a load step: the increment of its plastic strain for a trial
stress, and how far a pair of both is from obeying the yield condition.

A `Flow` belongs to a material and to its state at the beginning of a step; `sam.plasticity.kinematic` has
that of a material with back-stresses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from sam.arrays import Array, Mask
from sam.plasticity.return_map import equivalent_strain, mises, plastic_multiplier
from sam.plasticity.state import MaterialFields
from sam.scene.yield_curve import YieldCurve, plastic_work


@dataclass(frozen=True)
class Material:
    """Elastic constants (mu in Pa), the yield curve of each point, and the factor of its yield stress, of a
    shape that broadcasts with the points. hardens_back: whether there are back-stresses.
    """

    mu: float
    curve: YieldCurve
    factor: Array
    hardens_back: ClassVar[bool] = False

    def yield_stress(self, peeq: Array) -> Array:
        """In Pa, of the shape of the points."""
        limit: Array = self.factor * self.curve.stress(peeq)  # phi of paper Eq. 8, with Eq. 18
        return limit

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
        """The increment that the return map gives for a trial stress, (6, ...): zero where that does not
        yield. near: about its length, which broadcasts.
        """
        q = mises(trial)
        yielding = q > self.limit  # paper Eq. 8 does not hold
        scale = np.zeros_like(q)
        near = np.broadcast_to(near, q.shape)
        scale[yielding] = 1.5 * self.multiplier(q, yielding, m=m, near=near) / q[yielding]
        return scale * trial

    def multiplier(self, q: Array, yielding: Mask, *, m: float, near: Array | None = None) -> Array:
        """Increment of the accumulated strain of the points that yield, for their trial stress q: (n,); near:
        about the answer.
        """
        material = self.material
        factor = np.broadcast_to(material.factor, q.shape)[yielding]
        near = None if near is None else near[yielding]
        curve = material.curve.at(yielding)
        return plastic_multiplier(q[yielding], self.before.peeq[yielding], curve, factor, m3=3 * m, near=near)

    def effective(self, x: Array, s: Array) -> Array:
        """The stress that the yield stress limits at the end of an increment x, (6, ...)."""
        return s

    def excess(self, x: Array, s: Array) -> float:
        """How far the deviatoric stress s at the end of an increment x violates paper Eq. 8: the largest
        (q - sigma_y)/sigma_y, zero where it holds.
        """
        limit = self.material.yield_stress(self.before.peeq + equivalent_strain(x))
        excess = (mises(self.effective(x, s)) - limit) / limit  # paper Eq. 8
        return float(excess.max(initial=0.0))

    def increment(self, x: Array, length: Array) -> MaterialFields:
        """Increment of all fields of the material by a plastic strain x of this accumulated length."""
        return MaterialFields(strain=x, peeq=length)

    def dissipated(self, increment: MaterialFields) -> Array:
        """Energy that an increment dissipates, of the shape of the points, in J/m^3."""
        found, flowing = np.zeros_like(increment.peeq), increment.peeq > 0
        start = self.before.peeq[flowing]
        factor = np.broadcast_to(self.material.factor, flowing.shape)[flowing]
        curve = self.material.curve.at(flowing)
        found[flowing] = factor * plastic_work(curve, start + increment.peeq[flowing], start)
        return found
