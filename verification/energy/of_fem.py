# SPDX-License-Identifier: MIT
"""The energy balance of a scene in the finite-element models, on a rigid counter-body.

Forces on the nodes in contact do the work; sums over the Gauss points give the energies. The outer boundary
of the mesh moves as in the half-space, so that work also leaves the mesh there: it is stored in what lies
beyond, which stays elastic.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

import fem_reference
from fem_reference import Equilibrium, Model, Step, spatial
from sam.scene import Scene, plastic_work, step_energies, stored_energy
from verification.energy.balance import Balance, along_path


def balance_of(scene: Scene, model: str) -> Balance:
    """Solve with "fem-axisymmetric" or "fem-3d" and balance the energy. RuntimeError when it does not
    converge.
    """
    package, part = (spatial, _Spatial) if model == "fem-3d" else (fem_reference, _Axisymmetric)
    built, steps = package.load_steps(scene)
    return _of_steps(built, steps, part(built))


class _Axisymmetric:
    """Nodal forces and the body of the axisymmetric model. share: modelled part of every force."""

    share = 1.0

    def __init__(self, model: Model):
        self.problem, self.body = model.problem, model.body
        if len(model.problem.blocks) > 1:
            raise ValueError("counterbody: elastic, the balance of energy is of a body below a rigid one")

    def pressing(self, state: Equilibrium) -> np.ndarray:
        """(size,) forces on the body in the contact."""
        out = state.force * self.problem.prescribed * np.ones(self.problem.size)
        out[self.problem.normal[0]] += state.multipliers
        return out


class _Spatial:
    """As `_Axisymmetric`, of the model in space; a half of it where y = 0 is a plane of symmetry."""

    def __init__(self, model: spatial.Model):
        self.problem, self.body, self.share = model.problem, model.body, model.problem.share
        if model.prescribed:
            raise ValueError("loading.prescribed: the balance of energy in space is of a contact")

    def pressing(self, state: Equilibrium) -> np.ndarray:
        out = np.zeros(self.problem.size)
        out[self.problem.normal] = state.multipliers
        out[self.problem.along] = state.load.ratio * self.problem.weights * state.multipliers
        return out


def _of_steps(model: Model | spatial.Model, steps: list[Step], part: _Axisymmetric | _Spatial) -> Balance:
    if not steps[-1].state.converged:
        raise RuntimeError("a load step did not converge")
    states, weights, unit = [model.virgin(), *(step.state for step in steps)], part.body.weights, model.scales
    sides, pressing, stresses, plastic = [], [], [], []
    elastic, dissipated, back = (np.zeros(len(states)) for _ in range(3))
    compliance, material = np.linalg.inv(part.body.stiffness_tensor), model.problem.material
    for k, state in enumerate(states):
        strain = 0.0 if state.history is None else state.history.plastic_strain
        stress = part.body.stress(state.u, strain)
        sides.append(np.where(part.problem.fixed, part.body.internal_force(stress), 0.0))
        pressing.append(part.pressing(state))
        stresses.append(stress * weights)
        plastic.append(strain * np.ones_like(stress))
        elastic[k] = 0.5 * np.sum(np.einsum("st,seq,teq->eq", compliance, stress, stress) * weights)
        if state.history is not None:
            work = plastic_work(material.curve, state.history.peeq)
            dissipated[k] = np.sum(weights * material.factor * work)
    if material is not None and material.back_stresses:
        back, recovered = _back_parts(material, [state.history for state in states], weights)
        dissipated += np.cumsum(recovered)
    motions = [state.u for state in states]
    joule = unit.pressure * unit.length**2 * unit.displacement / part.share
    to_newton = unit.pressure * unit.length**2
    work, flowed = along_path([pressing], [motions]), along_path([stresses], [plastic])
    beyond = -along_path([sides], [motions])
    forces, approach = (
        np.array([getattr(state, name) for state in states]) for name in ("force", "approach")
    )
    return Balance(
        forces * to_newton,
        approach * unit.displacement,
        work=joule * work,
        elastic=joule * elastic,
        dissipated=joule * dissipated,
        flowed=joule * flowed,
        beyond=joule * beyond,
        back=joule * back,
    )


def _back_parts(material, histories: list, weights: np.ndarray) -> tuple[np.ndarray, list[float]]:
    """Energies of the back-stresses: stored in each state, dissipated in the step to it."""
    modulus, recovery = material.back.modulus, material.back.recovery
    recovered = [0.0]
    for old, new in pairwise(histories):
        strain = (new.plastic_strain - old.plastic_strain) / material.engineering[:, None]
        found = step_energies(modulus, recovery, old.back, strain, length=new.peeq - old.peeq)
        recovered.append(float(np.sum(weights * found.dissipated)))
    stored = [float(np.sum(weights * stored_energy(modulus, each.back))) for each in histories]
    return np.array(stored), recovered
