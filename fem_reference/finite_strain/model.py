# SPDX-License-Identifier: MIT
"""Loading of a scene's sphere at true geometry, and the curves that are compared; lengths over its radius R."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from fem_reference.axisymmetric import model as flat
from fem_reference.axisymmetric.recovery import largest_peeq, stresses
from fem_reference.axisymmetric.support import check
from fem_reference.common.contact import Equilibrium
from fem_reference.common.loading import Step, climb
from fem_reference.common.plasticity import J2, CurveInUnits
from fem_reference.finite_strain.contact import SphereContact
from fem_reference.finite_strain.material import Hencky
from sam.scene.schema import Scene

KINDS = ("flat", "sphere", "finite")
"""The model of the scenes; small strain with the sphere's true geometry on the deformed surface; finite strain as well."""


class SphereModel(flat.Model):
    """The model of a scene with a contact of true geometry."""

    def contact_radius(self, state: Equilibrium) -> float:
        """Of the deformed surface, as in the model of the scenes."""
        if not state.active.any():
            return 0.0
        last = int(np.flatnonzero(state.active)[-1])
        return flat.edge_radius(self.problem.place(state.u), state.gap, last)

    def starting_set(self, force: float, previous: Equilibrium) -> np.ndarray:
        """Those of the previous step: a node too many moves an element at the edge too far."""
        return previous.active if previous.force > 0.0 else super().starting_set(force, previous)


@dataclass(frozen=True)
class Curve:
    """One entry a load step. force over E* R^2; radius of contact, approach over R; mean pressure over E*; strain: peeq."""

    force: np.ndarray
    radius: np.ndarray
    approach: np.ndarray
    pressure: np.ndarray
    strain: np.ndarray


def build(scene: Scene, kind: str) -> flat.Model:
    """The model of a smooth, uncoated scene with a rigid sphere; kind: one of KINDS."""
    check(scene)
    model = flat.build(scene)
    if kind == "flat":
        return model
    slope = model.scales.displacement / model.scales.length
    hencky = None
    if kind == "finite":
        small = model.problem.material
        if small is None:
            curve = CurveInUnits(flat.UNYIELDING, slope, model.scales.pressure)
            small = J2(
                model.problem.blocks[0].young, scene.body.poisson, curve, np.ones(model.body.weights.shape)
            )
        hencky = Hencky(small, slope)
    problem = SphereContact.of(model.problem, slope, hencky)
    if problem.material is None and hencky is not None:
        problem.material = hencky.small
    return SphereModel(**{f.name: getattr(model, f.name) for f in fields(model)} | {"problem": problem})


def press(model: flat.Model, shares: Sequence[float]) -> list[Step]:
    """Load steps to these shares of the scene's force, up to the first that does not converge."""
    return climb(model, [share * model.scales.peak_force for share in shares], model.virgin())


def curve_of(model: flat.Model, steps: Sequence[Step]) -> Curve:
    """The curves of a run that converged."""
    slope = model.scales.displacement / model.scales.length
    states = [step.state for step in steps]
    force = np.array([state.force for state in states]) * slope**3
    radius = np.array([model.contact_radius(state) for state in states]) * slope
    approach = np.array([state.approach for state in states]) * slope**2
    strain = np.array([largest_peeq(stresses(model, state))[0] for state in states])
    return Curve(force, radius, approach, force / (np.pi * radius**2), strain)
