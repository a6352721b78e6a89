# SPDX-License-Identifier: MIT
"""Conditions of a solution of the axisymmetric FEM, from the displacements and histories of its steps.

Strains, stresses and nodal forces are formed anew here; as in `verification.checks.conditions`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skfem import LinearForm, asm

from fem_reference import Model, Step, load_steps
from sam.scene import Checkpoint, Scene
from verification.checks.conditions import EDGE, planes
from verification.checks.material import back_stress, elastic_stress, flow_of_parts, limit_of, von_mises

DEEPEST = 3.0  # Hertz radii: down to there is the force through planes judged; below it elements are long


class Finite:
    """A step of the axisymmetric FEM, everything formed anew from its displacements and plastic strains.

    strain, stress: (4, n_elements, n_points), components rr, tt, zz, rz (no engineering shear), in the units
    of the model.
    """

    def __init__(self, scene: Scene, model: Model, step: Step):
        self.scene, self.model, self.state = scene, model, step.state
        self.basis = model.problem.blocks[0].solid.basis
        field = self.basis.interpolate(model.problem.body(step.state.u, 0))
        self.r, self.z = np.asarray(self.basis.global_coordinates())
        grad = field.grad
        total = np.stack([grad[0, 0], field[0] / self.r, grad[1, 1], 0.5 * (grad[0, 1] + grad[1, 0])])
        history = step.state.history
        shear = np.array([1.0, 1.0, 1.0, 0.5])[:, None, None]
        self.plastic = np.zeros_like(total) if history is None else history.plastic_strain * shear
        self.peeq = np.zeros_like(self.r) if history is None else history.peeq
        self.stress = elastic_stress(scene, total - self.plastic, self.depths) / model.scales.modulus

    @property
    def depths(self) -> np.ndarray:
        """Of the Gauss points in m."""
        return self.z * self.model.scales.length

    def pressures(self) -> np.ndarray:
        """Stress as six components in Pa."""
        return _six(self.stress * self.model.scales.pressure)

    def effective(self) -> np.ndarray:
        """Stress less the back-stresses as six components in Pa."""
        history = self.state.history
        if history is None or history.back is None:
            return self.pressures()
        return self.pressures() - _six(back_stress(self.scene, history.back * self.unit, self.depths))

    def equilibrium(self) -> dict[str, float]:
        """Nodal forces: the largest on a free degree of freedom, and the sum over the contact less F; over
        F.
        """

        @LinearForm
        def internal(v, w):
            strain = (v.grad[0, 0], v[0] / w.x[0], v.grad[1, 1], 0.5 * (v.grad[0, 1] + v.grad[1, 0]))
            rr, tt, zz, rz = self.stress
            return (
                2 * np.pi * w.x[0] * (rr * strain[0] + tt * strain[1] + zz * strain[2] + 2 * rz * strain[3])
            )

        force, (x, z) = asm(internal, self.basis), self.basis.doflocs
        along_z = np.isin(np.arange(force.size), self._numbers(1))
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

    def _numbers(self, component: int) -> np.ndarray:
        """Of the degrees of freedom along r (0) or z (1)."""
        return np.concatenate([self.basis.nodal_dofs[component], self.basis.facet_dofs[component]])

    def yields(self) -> float:
        """Largest (mises - sigma_y)/sigma_y at the Gauss points."""
        return float(
            (
                von_mises(self.effective()) / limit_of(self.scene, self.peeq * self.unit, self.depths) - 1.0
            ).max()
        )

    @property
    def unit(self) -> float:
        """Strain of a strain of the model."""
        return self.model.scales.displacement / self.model.scales.length

    def flow(self, before: Finite) -> dict[str, float]:
        """`flow_of_parts` in the step that ends here and began at `before`."""
        strain = _six((self.plastic - before.plastic) * self.unit)
        peeq = before.peeq * self.unit, self.peeq * self.unit
        return flow_of_parts(self.scene, strain, *peeq, stress=self.effective(), z=self.depths)

    def surface(self) -> dict[str, float]:
        """Tractions in the elements at the surface against the nodal pressure, as `sam_surface`, linear from
        the Gauss points.
        """
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
        normal, shear = np.abs(zz + p) / pressure.max(), np.abs(rz) / pressure.max()
        out, inside = r > (1 + EDGE) * a, r < (1 - EDGE) * a
        return {
            "free": float(max(normal[out].max(), shear[out].max())),
            "inside contact": float(max(normal[inside].max(), shear[inside].max())),
        }

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


def _six(tensor: np.ndarray) -> np.ndarray:
    """Components 11 22 33 23 13 12 of rr, tt, zz, rz."""
    rr, tt, zz, rz = tensor
    return np.stack([rr, tt, zz, 0 * rr, rz, 0 * rr])


def steps_of(scene: Scene, records: Sequence[Checkpoint]) -> tuple[Model, list[Step]]:
    """The model of a scene and its steps, of the last record, or, of an elastic body that has none, taken
    again.
    """
    return load_steps(scene, records[-1] if records else None)
