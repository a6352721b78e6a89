# SPDX-License-Identifier: MIT
"""What the models of both geometries share: how a load step begins, and the material of the half-space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.back_stress import BackStresses, KinematicJ2
from fem_reference.common.bodies import Bodies, Elastic
from fem_reference.common.contact import Equilibrium, Problem, equilibrium, without_contact
from fem_reference.common.elasticity import Solid
from fem_reference.common.hertz import Scales
from fem_reference.common.linear import NO_WORK
from fem_reference.common.plan import Plan
from fem_reference.common.plasticity import J2, CurveInUnits, History, Material, Parts
from fem_reference.common.refusals import FEWEST_ELEMENTS
from fem_reference.common.schedule import HERTZ_RISE, NO_LOAD, Load
from sam.scene.yield_curve import Linear, Strength, YieldCurve

UNYIELDING = Linear(np.inf)
"""Yield curve of a material that stays elastic."""
ELASTIC = Strength(UNYIELDING)
HERTZ_GROWTH = 1.0 / 3.0
"""Power of the force with which the radius of an elastic contact grows: Johnson 1985, Eq. (4.22)."""
PLASTIC_GROWTH = 0.45
"""The same after yield, below 1/2 of constant mean pressure; for starting sets only."""

PLASTIC_RISE = 1.1
"""Power of the approach of the force after yield, above 1 of constant mean pressure; likewise."""


@dataclass(frozen=True)
class ContactModel(ABC):
    """Everything that is fixed during the loading, in the units of `plan.scales`."""

    plan: Plan
    problem: Problem

    on_axis: ClassVar[int] = 0
    """Number of candidates on an axis of symmetry, which have no area."""

    @property
    def centred(self) -> bool:
        """Whether the middle of the contact is known to be in the origin."""
        return True

    @property
    def part(self) -> float:
        """Modelled part of every force."""
        return 1.0

    @property
    def scales(self) -> Scales:
        """Units of the model."""
        return self.plan.scales

    @property
    def elastic(self) -> bool:
        """Whether no body has a plastic history."""
        return self.problem.material is None

    @property
    @abstractmethod
    def body(self) -> Solid:
        """The half-space of the scene."""

    @abstractmethod
    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """(n_candidates,) nodes that probably touch under `force`."""

    @abstractmethod
    def nodal_pressure(self, state: Equilibrium) -> Array:
        """Multiplier of each surface node over its area; `p_max_Pa` is the largest."""

    @abstractmethod
    def contact_area(self, state: Equilibrium) -> float:
        """Area of the contact in m^2."""

    def friction(self, state: Equilibrium) -> float:
        """Size of the tangential force over the normal one."""
        return self.plan.sliding.coefficient

    def displacements(self, state: Equilibrium) -> Array:
        """Displacements of the half-space, the first of the bodies."""
        return state.u[: self.body.size]

    @abstractmethod
    def contact_forces(self, state: Equilibrium) -> Array:
        """(n_candidates,) forces of the counter-body on the nodes, from the displacements."""

    @abstractmethod
    def outgrown(self, states: Sequence[Equilibrium]) -> bool:
        """Whether a contact reaches beyond the uniform part of the mesh."""

    @abstractmethod
    def yields_at_edge(self, peeq: Array) -> bool:
        """Whether anything at the outer boundary has yielded; peeq: as the stresses have it."""

    @abstractmethod
    def size(self, state: Equilibrium) -> float:
        """Radius or half-width of the contact, or of a circle of its area."""

    def too_coarse(self, states: Sequence[Equilibrium]) -> bool:
        """Whether the largest contact has fewer elements in its radius than FEWEST_ELEMENTS."""
        return round(max(map(self.size, states)) * self.plan.fine_cells_per_radius) < FEWEST_ELEMENTS

    def stress(self, state: Equilibrium) -> Array:
        """Stress of the half-space at the Gauss points, in the units of the model."""
        history = state.history
        return self.body.stress(self.displacements(state), 0.0 if history is None else history.inelastic)

    def largest_pressure(self, state: Equilibrium) -> float:
        """Largest nodal pressure in Pa, `p_max_Pa` of a result."""
        return float(self.nodal_pressure(state).max()) * self.scales.pressure

    def dissipated(self, before: Equilibrium, after: Equilibrium) -> float:
        """Energy in J that a step dissipates; 0 where nobody asks for it."""
        material, unit = self.problem.material, self.scales
        if not self.plan.dissipates or material is None or before.history is None or after.history is None:
            return 0.0
        density = material.dissipated(before.history, after.history)
        joule = unit.pressure * unit.strain * unit.length**3 / self.part
        return joule * float((self.body.weights * density).sum())

    def share(self, state: Equilibrium) -> float:
        """Force over that of the peak."""
        return state.force / (self.scales.peak_force or 1.0)

    def virgin(self, load: Load = NO_LOAD) -> Equilibrium:
        """The state before loading, and of an elastic body after it: one point touches without pressure."""
        none, material = np.zeros(self.problem.gap0.size), self.problem.material
        components = len(self.body.stiffness_tensor)
        history = (
            None if material is None else History.virgin(material.shape, components, material.back_stresses)
        )
        u = np.zeros(self.problem.size)
        return Equilibrium(u, 0.0, load, none, self.problem.gap0, none.astype(bool), history)

    def load(self, load: Load, previous: Equilibrium, *, halved: bool = False) -> Equilibrium:
        """Equilibrium under `load`, a step from the previous one; without force nothing touches.

        halved: a part of a step that did not converge begins with the nodes of the previous step: a node
        too many squeezes a soft body so far that Newton's method is lost.
        """
        return self.at(load).loaded(load, previous, halved=halved)

    def at(self, load: Load) -> Self:
        """The model with the counter-body where a load has it; the same unless that moves."""
        return self

    def loaded(self, load: Load, previous: Equilibrium, *, halved: bool) -> Equilibrium:
        """Equilibrium as of `load`, of a counter-body that is at its place."""
        u, history = previous.u, self.with_misfit(previous.history, load)
        if load.approach is not None:
            if previous.force == 0.0 and load.approach <= self.first_touch(previous):
                return self.apart(load, previous, load.approach)
            load = load.found(self.expected_force(load.approach, load.force, previous))
        if load.force == 0.0 and not previous.yielded:
            return self.virgin(load)
        if load.force == 0.0 or self.plan.prescribed:
            return without_contact(self.problem, load, self.scales.peak_force, u=u, history=history)
        start = previous.active
        if not (halved and start.any()):
            start = self.starting_set(load.force, previous)
        return equilibrium(self.problem, load, start, u=u, history=history)

    def with_misfit(self, history: History | None, load: Load) -> History | None:
        """The history in which a step to a load begins: with the misfit strain of that, if there is one."""
        return history

    def first_touch(self, unloaded: Equilibrium) -> float:
        """Approach at which the unloaded bodies touch."""
        return float(self.problem.gap(unloaded.u, 0.0).min())

    def apart(self, load: Load, unloaded: Equilibrium, approach: float) -> Equilibrium:
        """The unloaded bodies at an approach that leaves them apart."""
        gap, load = self.problem.gap(unloaded.u, approach), load.found(0.0)
        return replace(unloaded, load=load, approach=approach, gap=gap, residuals=(), work=NO_WORK)

    def expected_force(self, approach: float, scheduled: float, previous: Equilibrium) -> float:
        """Force that an approach probably needs, from the step before or Hertz."""
        if previous.force > 0.0:
            power = PLASTIC_RISE if previous.yielded else HERTZ_RISE
            return float(previous.force * (approach / previous.approach) ** power)
        return float(scheduled * (1.0 - self.first_touch(previous) / approach) ** HERTZ_RISE)


def material(bodies: Bodies, units: Scales, solid: Solid, *, misfit: bool = False) -> Material | None:
    """Plasticity of the half-space at its Gauss points; None if nothing yields or is misfit."""
    if not (bodies.yields or misfit):
        return None
    shears = len(solid.stiffness_tensor) - 3

    def in_units(curve: YieldCurve) -> CurveInUnits:
        return CurveInUnits(curve, units.strain, units.pressure)

    strength, z = (bodies.strength or ELASTIC).with_curves(in_units), solid.points[-1] * units.length

    def half_space(depths: Array) -> J2:
        elastic = bodies.elastic[0]
        curve, factor, back = strength.curve_at(depths), strength.profile(depths), strength.back_at(depths)
        if back is None:
            return J2(elastic, curve, factor, shears=shears)
        modulus, recovery = back
        back_stresses = BackStresses(modulus * units.strain / units.pressure, recovery * units.strain)
        return KinematicJ2(elastic, curve, factor, back_stresses, shears=shears)

    if bodies.coating is None:
        return half_space(z)
    inside, limit = solid.in_coating, bodies.coating_yield
    perfect = in_units(UNYIELDING if limit is None else Linear(limit))
    layer = Elastic(bodies.coating.young, bodies.coating.poisson)
    return Parts(
        [
            (inside, J2(layer, perfect, np.ones(z[inside].shape), shears=shears)),
            (~inside, half_space(z[~inside])),
        ]
    )
