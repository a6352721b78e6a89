# SPDX-License-Identifier: MIT
"""The energy balance of a scene in the finite-element models, on a rigid counter-body.

Forces on the nodes in contact do the work; sums over the Gauss points give the energies. The outer boundary
of the mesh moves as in the half-space, so that work also leaves the mesh there: it is stored in what lies
beyond, which stays elastic. In space a half is modelled where y = 0 is a plane of symmetry.
"""

from __future__ import annotations

import numpy as np

import fem_reference
from fem_reference import Equilibrium, spatial
from sam.scene import Scene, plastic_work
from verification.energy.balance import Balance, along_path, back_energies


def balance_of(scene: Scene, model: str) -> Balance:
    """Solve with "fem-axisymmetric" or "fem-3d" and balance. RuntimeError without convergence."""
    if scene.counterbody is not None and scene.counterbody.elastic:
        raise ValueError("counterbody: elastic, the balance of energy is of a body below a rigid one")
    in_space = model == "fem-3d"
    if in_space and scene.loading.prescribed:
        raise ValueError("loading.prescribed: the balance of energy in space is of a contact")
    built, steps = (spatial if in_space else fem_reference).load_steps(scene)
    if not steps[-1].state.converged:
        raise RuntimeError("a load step did not converge")
    problem, body, material, unit = built.problem, built.body, built.problem.material, built.scales

    def pressing_of(state: Equilibrium) -> np.ndarray:
        """(size,) forces on the body in the contact."""
        out = np.zeros(problem.size)
        if in_space:
            out[problem.normal] = state.multipliers
            out[problem.along] = state.load.ratio * problem.weights * state.multipliers
        else:
            out += state.force * problem.prescribed
            out[problem.normal[0]] += state.multipliers
        return out

    states, weights = [built.virgin(), *(step.state for step in steps)], body.weights
    sides, pressing, stresses, plastic = [], [], [], []
    elastic, dissipated, back = (np.zeros(len(states)) for _ in range(3))
    compliance = np.linalg.inv(body.stiffness_tensor)
    for k, state in enumerate(states):
        strain = 0.0 if state.history is None else state.history.plastic_strain
        stress = body.stress(state.u, strain)
        sides.append(np.where(problem.fixed, body.internal_force(stress), 0.0))
        pressing.append(pressing_of(state))
        stresses.append(stress * weights)
        plastic.append(strain * np.ones_like(stress))
        elastic[k] = 0.5 * np.sum(np.einsum("st,seq,teq->eq", compliance, stress, stress) * weights)
        if state.history is not None:
            work = plastic_work(material.curve, state.history.peeq)
            dissipated[k] = np.sum(weights * material.factor * work)
    if material is not None and material.back_stresses:
        found = [
            (each.plastic_strain / material.engineering[:, None], each.back, each.peeq)
            for each in (state.history for state in states)
        ]
        back, recovered = back_energies(material.back.modulus, material.back.recovery, found, weights)
        dissipated += recovered
    motions = [state.u for state in states]
    newton = unit.pressure * unit.length**2
    joule = newton * unit.displacement / (problem.share if in_space else 1.0)
    return Balance(
        np.array([state.force for state in states]) * newton,
        np.array([state.approach for state in states]) * unit.displacement,
        work=joule * along_path([pressing], [motions]),
        elastic=joule * elastic,
        dissipated=joule * dissipated,
        flowed=joule * along_path([stresses], [plastic]),
        beyond=-joule * along_path([sides], [motions]),
        back=joule * back,
    )
