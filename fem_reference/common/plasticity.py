# SPDX-License-Identifier: MIT
"""J2 plasticity with isotropic hardening: backward-Euler radial return and its consistent tangent.

Simo and Hughes, Computational Inelasticity (1998), Sec. 3.3. Within a step, from plastic strain e and
accumulated plastic strain a at its beginning, with the trial stress s' = D (strain - e), its deviator s, q
= sqrt(3/2 s:s):

    1. q <= Y(a): elastic, nothing changes
    2. q - 3 G g = Y(a + g)          g >= 0: increment of the accumulated plastic strain
    3. n = 3/2 s/q,   e <- e + g n,   a <- a + g,   stress = s' - 2 G g n
    4. d stress/d strain = D - 6 G^2 [ (g/q) (I - N N) + N N/(3 G + Y'(a + g)) ]
       N = s/|s|, I: deviatoric identity

The yield stress Y is the curve times a factor of the point. Components as in `elasticity`, n = 4 in axial
symmetry and 6 in space, strains with the engineering shear. Everything is in the consistent units of the
caller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.common.arrays import Array, Bools, Integers
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import deviator, mises, stiffness_tensor
from sam.scene.yield_curve import YieldCurve, plastic_work

ON_SURFACE = 1e-11
"""A trial stress beyond yield by up to this, relatively, is rounding: elastic."""
MAX_ITERATIONS = 100
"""Limit of the return map: bisection alone has the last digit after 53."""


@dataclass(frozen=True)
class CurveInUnits:
    """A yield curve in other units: `strain` and `stress` are the units of the caller in those of `curve`."""

    curve: YieldCurve
    strain: float
    stress_unit: float

    def stress(self, peeq: Array | float) -> Array:
        """Yield stress in the units of the caller."""
        return self.curve.stress(peeq * self.strain) / self.stress_unit

    def slope(self, peeq: Array | float) -> Array:
        """Derivative of `stress`."""
        return self.curve.slope(peeq * self.strain) * self.strain / self.stress_unit

    def at(self, points: Bools) -> CurveInUnits:
        """The curve of some points."""
        return replace(self, curve=self.curve.at(points))


@dataclass(frozen=True)
class History:
    """Plastic strain (n, n_elements, n_points), accumulated plastic strain (n_elements, n_points) and the
    strains a_k of back-stresses (N, n, n_elements, n_points), tensors, see `back_stress`; never changed.

    misfit: strain that the load gives, a thermal one say, as the plastic strain; None without one.
    """

    plastic_strain: Array
    peeq: Array
    misfit: Array | None = None
    back: Array | None = None

    @property
    def inelastic(self) -> Array:
        """All strain that makes no stress where it is, (n, n_elements, n_points)."""
        return self.plastic_strain if self.misfit is None else self.plastic_strain + self.misfit

    def of(self, elements: Bools) -> History:
        """That of some elements, (n_elements,) bool."""
        misfit = None if self.misfit is None else self.misfit[:, elements]
        back = None if self.back is None else self.back[:, :, elements]
        return History(self.plastic_strain[:, elements], self.peeq[elements], misfit, back)

    @classmethod
    def virgin(cls, shape: tuple[int, ...], components: int = 4, back_stresses: int = 0) -> History:
        """Nothing has yielded. shape: (n_elements, n_points)."""
        back = np.zeros((back_stresses, components, *shape)) if back_stresses else None
        return cls(np.zeros((components, *shape)), np.zeros(shape), back=back)

    @property
    def yielded(self) -> bool:
        """Whether any point ever has."""
        return bool(self.peeq.any())


@dataclass(frozen=True)
class Update:
    """Outcome of a step at given strains.

    stress (n, n_elements, n_points); history at the end of the step; elements: (m,) those with a point that
    yields in the step; loss: (m, n_points, n, n), elastic minus consistent tangent of their points.
    """

    stress: Array
    history: History
    elements: Integers
    loss: Array


@dataclass(frozen=True)
class Returned:
    """Outcome of the return map at m points that yield: increment (m,) of the accumulated plastic strain;
    flow (n, m), a tensor; loss (m, n, n), elastic minus consistent tangent; back: change of the strains of
    the back-stresses (N, n, m).
    """

    increment: Array
    flow: Array
    loss: Array
    back: Array | None = None


class J2:
    """Elastic-plastic material of a body. factor: (n_elements, n_points), on the yield stress of `curve`,
    which may be another one in a layer.

    shears: components of shear stress, 1 in axial symmetry, 3 in space; back_stresses: how many there are.
    """

    back_stresses = 0

    def __init__(self, elastic: Elastic, curve: YieldCurve, factor: Array, *, shears: int = 1):
        self.stiffness = stiffness_tensor(elastic.young, elastic.poisson, shears)
        self.engineering = np.array([1.0] * 3 + [2.0] * shears)[:, None]
        self.shear = elastic.young / (2.0 * (1.0 + elastic.poisson))
        self.curve, self.factor, self.young = curve, factor, elastic.young

    @property
    def shape(self) -> tuple[int, int]:
        """(n_elements, n_points)."""
        return self.factor.shape

    @property
    def yield_strain(self) -> Array:
        """Initial yield stress over Young's modulus at every point."""
        return self.factor * self.curve.stress(np.zeros_like(self.factor)) / self.young

    def update(self, strain: Array, start: History) -> Update:
        """Stress, history and tangent at `strain` (n, n_elements, n_points), from `start`."""
        stress = np.einsum("st,teq->seq", self.stiffness, strain - start.inelastic)
        plastic = self.excess(stress, start) > ON_SURFACE  # step 1
        if not plastic.any():
            none = np.empty((0, *plastic.shape[1:], len(stress), len(stress)))
            return Update(stress, start, np.empty(0, dtype=int), none)
        returned = self.returned(stress, start, plastic)
        stress[:, plastic] -= 2.0 * self.shear * returned.increment * returned.flow  # step 3
        total, accumulated, back = start.plastic_strain.copy(), start.peeq.copy(), start.back
        total[:, plastic] += returned.increment * returned.flow * self.engineering
        accumulated[plastic] += returned.increment
        if back is not None and returned.back is not None:
            back = back.copy()
            back[:, :, plastic] += returned.back
        elements = np.flatnonzero(plastic.any(axis=1))
        loss = np.zeros((elements.size, *plastic.shape[1:], len(stress), len(stress)))
        loss[plastic[elements]] = returned.loss
        return Update(
            stress, replace(start, plastic_strain=total, peeq=accumulated, back=back), elements, loss
        )

    def returned(self, trial: Array, start: History, plastic: Bools) -> Returned:
        """Steps 2 to 4 at the points that yield; trial: stress (n, n_elements, n_points)."""
        s, peeq, factor = trial[:, plastic], start.peeq[plastic], self.factor[plastic]
        curve, q = self.curve.at(plastic), mises(s)
        increment = plastic_increment(q, peeq, factor, shear=self.shear, curve=curve)  # step 2
        s = deviator(s)
        slope = factor * curve.slope(peeq + increment)
        loss = tangent_loss(q, s, increment, slope=slope, shear=self.shear)
        return Returned(increment, 1.5 * s / q, loss)

    def dissipated(self, before: History, after: History) -> Array:
        """Energy that a step dissipates at every point, (n_elements, n_points)."""
        energy, flowing = np.zeros_like(after.peeq), after.peeq > before.peeq
        curve = self.curve.at(flowing)
        energy[flowing] = self.factor[flowing] * plastic_work(
            curve, after.peeq[flowing], before.peeq[flowing]
        )
        return energy

    def back_stress(self, history: History) -> Array:
        """The sum of the back-stresses at every point, (n, n_elements, n_points)."""
        return np.zeros_like(history.plastic_strain)

    def effective(self, stress: Array, history: History) -> Array:
        """The stress that the yield stress limits."""
        return stress

    def yields(self, q: Array, peeq: Array) -> Bools:
        """Points (bool) whose von Mises stress q is beyond the yield stress after the plastic strain peeq."""
        return self._beyond(q, peeq) > ON_SURFACE

    def excess(self, stress: Array, history: History) -> Array:
        """(q - Y)/Y at every point."""
        return self._beyond(mises(self.effective(stress, history)), history.peeq)

    def _beyond(self, q: Array, peeq: Array) -> Array:
        return q / (self.factor * self.curve.stress(peeq)) - 1.0


class Parts:
    """A body of several materials. parts: (elements (n_elements,) bool, material)."""

    def __init__(self, parts: Sequence[tuple[Bools, J2]]):
        self.parts = tuple(parts)

    @property
    def shape(self) -> tuple[int, int]:
        """(n_elements, n_points)."""
        elements, material = self.parts[0]
        return elements.size, material.shape[1]

    def _whole(self, of: Callable[[J2, Bools], Array], *leading: int) -> Array:
        """(*leading, n_elements, n_points) of the values of each material at its elements."""
        whole = np.empty((*leading, *self.shape))
        for elements, material in self.parts:
            whole[..., elements, :] = of(material, elements)
        return whole

    @property
    def yield_strain(self) -> Array:
        """Initial yield stress over Young's modulus at every point."""
        return self._whole(lambda material, _: material.yield_strain)

    @property
    def back_stresses(self) -> int:
        """The largest number of any part."""
        return max(material.back_stresses for _, material in self.parts)

    def update(self, strain: Array, start: History) -> Update:
        """Stress, history and tangent of the whole body at `strain`, see J2.update."""
        stress, total, accumulated = np.empty_like(strain), start.plastic_strain.copy(), start.peeq.copy()
        back = None if start.back is None else start.back.copy()
        numbers, losses = [], []
        for elements, material in self.parts:
            part = material.update(strain[:, elements], start.of(elements))
            stress[:, elements] = part.stress
            total[:, elements], accumulated[elements] = part.history.plastic_strain, part.history.peeq
            if back is not None:
                back[:, :, elements] = part.history.back
            numbers.append(np.flatnonzero(elements)[part.elements])
            losses.append(part.loss)
        yielding = np.concatenate(numbers)
        end = replace(start, plastic_strain=total, peeq=accumulated, back=back) if yielding.size else start
        return Update(stress, end, yielding, np.concatenate(losses))

    def dissipated(self, before: History, after: History) -> Array:
        """Energy that a step dissipates at every point, (n_elements, n_points)."""
        return self._whole(lambda material, at: material.dissipated(before.of(at), after.of(at)))

    def back_stress(self, history: History) -> Array:
        """The sum of the back-stresses at every point, (n, n_elements, n_points)."""
        components = len(history.plastic_strain)
        return self._whole(lambda material, at: material.back_stress(history.of(at)), components)

    def excess(self, stress: Array, history: History) -> Array:
        """(q - Y)/Y at every point; -1 where nothing ever yields."""
        return self._whole(lambda material, at: material.excess(stress[:, at], history.of(at)))


Material = J2 | Parts


def deviatoric(components: int) -> Array:
    """(n, n): strain with engineering shear -> its deviator as a tensor."""
    shears = components - 3
    return np.diag([1.0] * 3 + [0.5] * shears) - np.pad(np.full((3, 3), 1.0 / 3.0), (0, shears))


def plastic_increment(q: Array, peeq: Array, factor: Array, *, shear: float, curve: YieldCurve) -> Array:
    """Root g of f(g) = q - 3 G g - Y(peeq + g), Y = factor * curve; all (n,), f(0) > 0.

    Newton's method from g = 0, monotone for a concave curve (f is convex and falls). For other curves, and
    corners of tables, bisection of the bracket 0 <= g <= f(0)/(3 G) replaces a step that leaves it or did
    not halve |f|.
    """
    g = lower = np.zeros_like(q)
    upper = (q - factor * curve.stress(peeq)) / (3.0 * shear)
    before = np.full_like(q, np.inf)
    rounding = 16.0 * np.finfo(float).eps * (peeq + q / (3.0 * shear))
    for _ in range(MAX_ITERATIONS):
        f = q - 3.0 * shear * g - factor * curve.stress(peeq + g)
        lower, upper = np.where(f > 0.0, g, lower), np.where(f < 0.0, g, upper)
        step = f / (3.0 * shear + factor * curve.slope(peeq + g))
        done = np.abs(step) <= rounding
        bisect = (np.abs(f) > 0.5 * before) | (g + step < lower) | (g + step > upper)
        g, before = np.where(bisect & ~done, 0.5 * (lower + upper), g + step), np.abs(f)
        if done.all():
            break
    return g


def tangent_loss(q: Array, trial: Array, increment: Array, *, slope: Array, shear: float) -> Array:
    """(m, n, n) elastic minus consistent tangent, step 4.

    q, trial: von Mises stress (m,) and deviator (n, m) of the trial stress; increment: g; slope: Y'(a + g).
    """
    N = np.sqrt(1.5) * trial / q
    ratio, along = increment / q, 1.0 / (3.0 * shear + slope)
    return (
        6.0
        * shear**2
        * (ratio[:, None, None] * deviatoric(len(N)) + np.einsum("n,sn,tn->nst", along - ratio, N, N))
    )
