# SPDX-License-Identifier: MIT
"""How the material of each cell yields over a load step: the increment of its plastic strain for a stress,
and how far a pair of both is from obeying the yield condition and the flow rule.

A `Flow` belongs to a material and to its state at the beginning of a step; `sam.plasticity.kinematic` has
that of a material with back-stresses.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from sam.arrays import Array, Mask
from sam.plasticity.return_map import contraction, equivalent_strain, mises, plastic_multiplier
from sam.plasticity.state import MaterialFields
from sam.scene.dissipation import plastic_work
from sam.scene.yield_curve import YieldCurve


@dataclass(frozen=True)
class Material:
    """Elastic constants (mu in Pa), the yield curve of each cell, and the factor of the yield stress of each
    layer, (n_layers,). hardens_back: whether there are back-stresses.
    """

    mu: float
    curve: YieldCurve
    factor: Array
    hardens_back: ClassVar[bool] = False

    def yield_stress(self, peeq: Array) -> Array:
        """(n_layers, nx, ny) in Pa."""
        limit: Array = self.factor[:, None, None] * self.curve.stress(peeq)  # phi of paper Eq. 8, with Eq. 18
        return limit

    @cached_property
    def initial_yield(self) -> float:
        """The smallest yield stress of unstrained material, in Pa."""
        return float(self.yield_stress(np.zeros(1)).min())

    def back_stress(self, fields: MaterialFields) -> Array | None:
        """The sum of the back-stresses in Pa, (6, n_layers, nx, ny); None without any."""
        return None

    def virgin(self, shape: tuple[int, int, int]) -> MaterialFields:
        """The fields of (n_layers, nx, ny) cells that never yielded."""
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
        """The yield stress at the beginning of the step in Pa, (n_layers, nx, ny)."""
        return self.material.yield_stress(self.before.peeq)

    def image(self, x: Array, s: Array, m: float) -> Array:
        """The increment that the return map gives for the deviatoric stress s + 2 m x: zero where that does
        not yield.
        """
        trial = s + 2 * m * x
        q = mises(trial)
        yielding = q > self.limit  # paper Eq. 8 does not hold
        scale = np.zeros_like(q)
        scale[yielding] = 1.5 * self.multiplier(q, yielding, m=m, near=equivalent_strain(x)) / q[yielding]
        return scale * trial

    def multiplier(self, q: Array, yielding: Mask, *, m: float, near: Array | None = None) -> Array:
        """Increment of the accumulated strain of the cells that yield, for their trial stress q: (n,); near:
        about the answer.
        """
        material = self.material
        factor = np.broadcast_to(material.factor[:, None, None], q.shape)[yielding]
        near = None if near is None else near[yielding]
        curve = material.curve.at(yielding)
        return plastic_multiplier(q[yielding], self.before.peeq[yielding], curve, factor, m3=3 * m, near=near)

    def effective(self, x: Array, s: Array) -> Array:
        """The stress that the yield stress limits at the end of an increment x, (6, n_layers, nx, ny)."""
        return s

    def residuals(self, x: Array, s: Array) -> tuple[float, float]:
        """(yield_excess, flow_residual) of an increment and the deviatoric stress s that goes with it.

        yield_excess is how far paper Eq. 8 is violated.
        """
        material = self.material
        limit = material.yield_stress(self.before.peeq + equivalent_strain(x))
        excess = np.max((mises(self.effective(x, s)) - limit) / limit)  # paper Eq. 8
        change = self.image(x, s, material.mu) - x
        flow = 2 * material.mu * np.sqrt(contraction(change, change).max()) / material.initial_yield
        return float(max(excess, 0.0)), float(flow)

    def increment(self, x: Array, length: Array) -> MaterialFields:
        """Increment of all fields of the material by a plastic strain x of this accumulated length."""
        return MaterialFields(strain=x, peeq=length)

    def dissipated(self, increment: MaterialFields) -> Array:
        """Energy that an increment dissipates, (n_layers, nx, ny) in J/m^3."""
        found, flowing = np.zeros_like(increment.peeq), increment.peeq > 0
        start = self.before.peeq[flowing]
        factor = np.broadcast_to(self.material.factor[:, None, None], flowing.shape)[flowing]
        curve = self.material.curve.at(flowing)
        found[flowing] = factor * plastic_work(curve, start + increment.peeq[flowing], start)
        return found
