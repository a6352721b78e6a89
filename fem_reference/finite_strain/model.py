# SPDX-License-Identifier: MIT
"""Loading of a scene's sphere at true geometry, and the curves that are compared; lengths over its radius
R.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.axisymmetric import model as flat
from fem_reference.axisymmetric.planner import plan
from fem_reference.axisymmetric.recovery import stresses
from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.loading import Step, climb
from fem_reference.common.model import UNYIELDING
from fem_reference.common.plasticity import J2, CurveInUnits
from fem_reference.common.recovery import edge_radius
from fem_reference.finite_strain.contact import SphereContact
from fem_reference.finite_strain.material import Hencky
from sam.scene.schema import Scene

KINDS = ("flat", "sphere", "finite")
"""The model of the scenes; with the sphere's true geometry; at finite strain as well."""


@dataclass(frozen=True)
class SphereModel(flat.Model):
    """The model of a scene with a contact of true geometry."""

    problem: SphereContact

    def contact_radius(self, state: Equilibrium) -> float:
        """Radius of the contact on the deformed surface, read from the gap as in the model of the scenes."""
        if not state.active.any():
            return 0.0
        last = int(np.flatnonzero(state.active)[-1])
        return edge_radius(self.problem.place(state.u), state.gap, last)

    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """Nodes of the previous step: a node too many moves an element at the edge too far."""
        return previous.active if previous.force > 0.0 else super().starting_set(force, previous)


@dataclass(frozen=True)
class Curve:
    """What is compared, one entry a load step, (n,).

    force: normal force over E* R^2; radius, approach: of the contact over R; pressure: mean one over E*;
    strain: largest accumulated plastic one.
    """

    force: Array
    radius: Array
    approach: Array
    pressure: Array
    strain: Array


def build(scene: Scene, kind: str) -> flat.Model:
    """The model of a smooth, uncoated scene with a rigid sphere, of one of KINDS, for `load_to`.
    UnsupportedScene if `fem_reference.check` raises it.
    """
    model = flat.build(plan(scene))
    if kind == "flat":
        return model
    slope = model.scales.strain
    hencky = None
    if kind == "finite":
        small = model.problem.material
        if not isinstance(small, J2):
            curve = CurveInUnits(UNYIELDING, slope, model.scales.pressure)
            small = J2(model.body.elastic, curve, np.ones(model.body.weights.shape))
        hencky = Hencky(small, slope)
    return SphereModel(model.plan, SphereContact(model.problem, slope, hencky), model.surface)


def load_to(model: flat.Model, shares: Sequence[float]) -> list[Step]:
    """Load steps to shares of the scene's force, up to the first that does not converge."""
    return climb(model, [share * model.scales.peak_force for share in shares], model.virgin())


def curve_of(model: flat.Model, steps: Sequence[Step]) -> Curve:
    """The curves of load steps that converged, of `load_to`."""
    slope = model.scales.strain
    states = [step.state for step in steps]
    force = np.array([state.force for state in states]) * slope**3
    radius = np.array([model.contact_radius(state) for state in states]) * slope
    approach = np.array([state.approach for state in states]) * slope**2
    strain = np.array([stresses(model, state).largest_peeq()[0] for state in states])
    return Curve(force, radius, approach, force / (np.pi * radius**2), strain)
