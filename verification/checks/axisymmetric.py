# SPDX-License-Identifier: MIT
"""Conditions of a solution of the axisymmetric FEM, from the displacements and histories of its steps.

Strains, stresses and nodal forces are formed anew here; as in `verification.checks.conditions`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from skfem import LinearForm, asm

from fem_reference import Model, Step
from sam.scene import Scene
from verification.checks.conditions import planes, tractions
from verification.checks.material import back_stress, elastic_stress, flow_of, limit_of, von_mises

DEEPEST = 3.0  # Hertz radii: down to there is the force through planes judged; below it elements are long


class Formed:
    """A step of a finite-element model, everything formed anew from its displacements and plastic strains.
    strain, stress: (n, ...), no engineering shear, in the units of the model; depths: of the Gauss points in
    m.
    """

    def __init__(self, scene: Scene, model: Any, step: Any, depths: np.ndarray):
        self.scene, self.model, self.state = scene, model, step.state
        self.depths = depths * model.scales.length

    def form(self, total: np.ndarray, shear: Sequence[float]) -> None:
        """Of the total strain; shear: factors of the components of the model's plastic strain."""
        history = self.state.history
        factors = np.array(shear)[:, None, None]
        self.plastic = np.zeros_like(total) if history is None else history.plastic_strain * factors
        self.peeq = np.zeros(total.shape[1:]) if history is None else history.peeq
        elastic = elastic_stress(self.scene, total - self.plastic, self.depths)
        self.stress = elastic / self.model.scales.modulus

    def six(self, tensor: np.ndarray) -> np.ndarray:
        """Components 11 22 33 23 13 12."""
        return tensor

    @property
    def unit(self) -> float:
        """Strain of a strain of the model."""
        return self.model.scales.displacement / self.model.scales.length

    def effective(self) -> np.ndarray:
        """Stress less the back-stresses as six components in Pa."""
        history, stress = self.state.history, self.six(self.stress * self.model.scales.pressure)
        if history is None or history.back is None:
            return stress
        return stress - self.six(back_stress(self.scene, history.back * self.unit, self.depths))

    def yields(self) -> float:
        """Largest (mises - sigma_y)/sigma_y at the Gauss points."""
        limit = limit_of(self.scene, self.peeq * self.unit, self.depths)
        return float((von_mises(self.effective()) / limit - 1.0).max())

    def flow(self, before: Formed) -> dict[str, float]:
        """`flow_of` in the step that ends here and began at `before`."""
        strain = self.six((self.plastic - before.plastic) * self.unit)
        peeq = before.peeq * self.unit, self.peeq * self.unit
        return flow_of(self.scene, strain, *peeq, stress=self.effective(), z=self.depths)


class Finite(Formed):
    """Of the axisymmetric model: (4, n_elements, n_points), components rr, tt, zz, rz."""

    def __init__(self, scene: Scene, model: Model, step: Step):
        self.basis = model.problem.solids[0].basis
        field = self.basis.interpolate(model.problem.body(step.state.u, 0))
        self.r, self.z = np.asarray(self.basis.global_coordinates())
        super().__init__(scene, model, step, self.z)
        grad = field.grad
        total = np.stack([grad[0, 0], field[0] / self.r, grad[1, 1], 0.5 * (grad[0, 1] + grad[1, 0])])
        self.form(total, (1.0, 1.0, 1.0, 0.5))

    def six(self, tensor: np.ndarray) -> np.ndarray:
        rr, tt, zz, rz = tensor
        return np.stack([rr, tt, zz, 0 * rr, rz, 0 * rr])

    def equilibrium(self) -> dict[str, float]:
        """Nodal forces: the largest on a free degree of freedom, and their sum less F; over F."""

        @LinearForm
        def internal(v, w):
            strain = (v.grad[0, 0], v[0] / w.x[0], v.grad[1, 1], 0.5 * (v.grad[0, 1] + v.grad[1, 0]))
            rr, tt, zz, rz = self.stress
            return (
                2 * np.pi * w.x[0] * (rr * strain[0] + tt * strain[1] + zz * strain[2] + 2 * rz * strain[3])
            )

        force, (x, z) = asm(internal, self.basis), self.basis.doflocs
        numbers = np.concatenate([self.basis.nodal_dofs[1], self.basis.facet_dofs[1]])
        along_z = np.isin(np.arange(force.size), numbers)
        held = (x >= x.max() * (1 - 1e-9)) | (z >= z.max() * (1 - 1e-9)) | ((x == 0.0) & ~along_z)
        surface = np.flatnonzero((z == 0.0) & along_z)
        surface = surface[np.argsort(x[surface])][: self.state.active.size]
        in_contact = surface[self.state.active]
        free = ~held
        free[in_contact] = False
        total = self.state.force
        return {
            "equilibrium": float(np.abs(force[free]).max()) / total,
            "load": abs(float(force[in_contact].sum()) / total - 1.0),
        }

    def surface(self) -> float:
        """Tractions in the elements at the surface against the nodal pressure, as `sam_surface`."""
        top = np.isclose(self.z.min(axis=1), self.z.min())
        z = self.z[top]
        order = np.lexsort((z, np.round(self.r[top] / self.r[top].max(), 9)))
        r, z, rz, zz = (
            np.take_along_axis(f, order, axis=1)
            for f in (self.r[top], z, self.stress[3][top], self.stress[2][top])
        )
        share = z[:, ::2] / (z[:, 1::2] - z[:, ::2])
        r, zz, rz = (f[:, ::2] + share * (f[:, ::2] - f[:, 1::2]) for f in (r, zz, rz))
        pressure = self.model.nodal_pressure(self.state)
        a, nodes = self.model.contact_radius(self.state), self.model.surface
        p = np.interp(r, nodes[::2], pressure[::2])
        return tractions(r / a, np.abs(zz + p) / pressure.max(), np.abs(rz) / pressure.max())

    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """(z, `planes`) at the depths of the Gauss points."""
        depths = np.unique(np.round(self.z, 10))
        spread = float(self.state.multipliers @ self.model.radii**2 / self.state.multipliers.sum())
        errors = []
        for depth in depths:
            here = np.isclose(self.z, depth, rtol=0, atol=1e-9)
            order = np.argsort(self.r[here])
            r, szz = self.r[here][order], self.stress[2][here][order]
            errors.append(planes(r, np.array([depth]), szz[:, None], self.state.force, spread=spread)[0])
        return depths, np.array(errors)
