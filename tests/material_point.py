# SPDX-License-Identifier: MIT
"""A material point under given strains, with the return map of either model."""

from __future__ import annotations

import numpy as np

from fem_reference.common.back_stress import BackStresses, KinematicJ2
from fem_reference.common.bodies import Elastic
from fem_reference.common.plasticity import History
from sam.plasticity.flow import BackStressFields, KinematicMaterial, equivalent_strain

YOUNG, POISSON = 210e9, 0.3
MU, BULK = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)
ENGINEERING = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


class SamPoint:
    """One cell: strains and stresses 11 22 33 23 13 12."""

    def __init__(self, curve, modulus, recovery, factor=1.0):
        back = [np.reshape(np.array(values, dtype=float), (-1, 1, 1, 1)) for values in (modulus, recovery)]
        self.material = KinematicMaterial(
            MU, curve, np.full(1, factor), BackStressFields(factor * back[0], back[1])
        )
        self.state = self.material.virgin((1, 1, 1))

    def at(self, strain):
        """(stress, state) at the end of a step to a strain."""
        trial = np.reshape(strain, (6, 1, 1, 1)) - self.state.strain
        mean = trial[:3].sum() / 3
        trial[:3] -= mean
        flow = self.material.flow(self.state)
        x = flow.returned(2 * MU * trial, MU, near=np.zeros(1))
        stress = 2 * MU * (trial - x)
        stress[:3] += 3 * BULK * mean
        return stress.ravel(), self.state.plus(flow.increment(x, equivalent_strain(x)))

    @property
    def plastic(self):
        """(plastic strain, accumulated one)."""
        return self.state.strain.ravel(), float(self.state.peeq.item())


class FemPoint:
    """One Gauss point, likewise; its shears come in another order, which one shear alone does not tell."""

    def __init__(self, curve, modulus, recovery, factor=1.0):
        back = [np.reshape(np.array(values, dtype=float), (-1, 1, 1)) for values in (modulus, recovery)]
        factors = np.full((1, 1), factor)
        constants = BackStresses(factor * back[0], back[1])
        self.material = KinematicJ2(Elastic(YOUNG, POISSON), curve, factors, constants, shears=3)
        self.state = History.virgin((1, 1), 6, len(modulus))

    def at(self, strain):
        """(stress, history) at the end of a step to a strain."""
        update = self.material.update(np.reshape(strain * ENGINEERING, (6, 1, 1)), self.state)
        return update.stress.ravel(), update.history

    @property
    def plastic(self):
        """(plastic strain, accumulated one)."""
        return self.state.plastic_strain.ravel() / ENGINEERING, float(self.state.peeq.item())


POINTS = {"sam": SamPoint, "fem": FemPoint}
