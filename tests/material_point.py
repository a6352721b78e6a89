# SPDX-License-Identifier: MIT
"""A material point under given strains and stresses, with the return map of either model."""

from __future__ import annotations

import numpy as np
from scipy.optimize import fsolve

from fem_reference.common.back_stress import BackStresses, KinematicJ2
from fem_reference.common.bodies import Elastic
from fem_reference.common.plasticity import History
from sam.plasticity.flow import BackStressFields, KinematicMaterial, equivalent_strain

YOUNG, POISSON = 210e9, 0.3
MU, BULK = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)
ENGINEERING = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


class SamPoint:
    """One cell: strains and stresses 11 22 33 23 13 12."""

    def __init__(self, curve, modulus, recovery):
        back = [np.reshape(np.array(values, dtype=float), (-1, 1, 1, 1)) for values in (modulus, recovery)]
        self.material = KinematicMaterial(MU, curve, np.ones(1), BackStressFields(*back))
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

    def __init__(self, curve, modulus, recovery):
        back = [np.reshape(np.array(values, dtype=float), (-1, 1, 1)) for values in (modulus, recovery)]
        elastic, factors = Elastic(YOUNG, POISSON), np.ones((1, 1))
        self.material = KinematicJ2(elastic, curve, factors, BackStresses(*back), shears=3)
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


class Specimen:
    """A material point some of whose components are strained; all others are free of stress."""

    def __init__(self, point):
        self.point, self.strain, self.stress = point, np.zeros(6), np.zeros(6)

    def to(self, strain):
        """Moves in one step. strain: component -> value in 1."""
        free, total = [i for i in range(6) if i not in strain], self.strain.copy()
        total[list(strain)] = list(strain.values())

        def off(values):
            total[free] = values
            return self.point.at(total)[0][free] / YOUNG

        if free:
            total[free] = fsolve(off, self.strain[free], xtol=1e-13, full_output=True)[0]
            assert np.abs(off(total[free])).max() < 1e-12
        self.strain = total
        self.stress, self.point.state = self.point.at(total)
