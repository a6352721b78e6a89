# SPDX-License-Identifier: MIT
"""Conditions of a solution of the axisymmetric FEM, from the displacements and histories of its steps.

Strains, stresses and nodal forces are formed anew here; as in `verification.certify`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skfem import LinearForm, asm

from fem_reference.loading import Progressed, Step, run
from fem_reference.model import Model, build
from sam.scene import Scene
from sam.scene.checkpoint import Checkpoint
from verification.certify import EDGE, flow_of, planes, von_mises, yield_stress

DEEPEST = 3.0  # Hertz radii: down to there is the force through planes judged; below it elements are long


class Finite:
    """A step of the axisymmetric FEM, everything formed anew from its displacements and plastic strains.

    strain, stress: (4, n_elements, n_points), components rr, tt, zz, rz (no engineering shear), in the units of the model.
    """

    def __init__(self, model: Model, step: Step):
        self.model, self.state = model, step.state
        block = model.problem.blocks[0]
        self.basis = block.solid.basis
        field = self.basis.interpolate(model.problem.body(step.state.u, 0))
        self.r, self.z = np.asarray(self.basis.global_coordinates())
        grad = field.grad
        total = np.stack([grad[0, 0], field[0] / self.r, grad[1, 1], 0.5 * (grad[0, 1] + grad[1, 0])])
        history = step.state.history
        shear = np.array([1.0, 1.0, 1.0, 0.5])[:, None, None]
        self.plastic = np.zeros_like(total) if history is None else history.plastic_strain * shear
        self.peeq = np.zeros_like(self.r) if history is None else history.peeq
        elastic, young, nu = total - self.plastic, block.young, block.poisson
        mu, lame = young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))
        self.stress = 2 * mu * elastic
        self.stress[:3] += lame * elastic[:3].sum(axis=0)

    def pressures(self) -> np.ndarray:
        """Stress as six components in Pa."""
        rr, tt, zz, rz = self.stress * self.model.scales.pressure
        return np.stack([rr, tt, zz, 0 * rr, rz, 0 * rr])

    def equilibrium(self) -> dict[str, float]:
        """Nodal forces: the largest on a free degree of freedom, and the sum over the contact less F; over F."""

        @LinearForm
        def internal(v, w):
            strain = (v.grad[0, 0], v[0] / w.x[0], v.grad[1, 1], 0.5 * (v.grad[0, 1] + v.grad[1, 0]))
            rr, tt, zz, rz = self.stress
            return 2 * np.pi * w.x[0] * (rr * strain[0] + tt * strain[1] + zz * strain[2] + 2 * rz * strain[3])

        force, (x, z) = asm(internal, self.basis), self.basis.doflocs
        along_z = np.isin(np.arange(force.size), self._numbers(1))
        held = (x >= x.max() * (1 - 1e-9)) | (z >= z.max() * (1 - 1e-9)) | ((x == 0.0) & ~along_z)
        surface = np.flatnonzero((z == 0.0) & along_z)
        surface = surface[np.argsort(x[surface])][: self.state.active.size]
        pressed = surface[self.state.active]
        free = ~held
        free[pressed] = False
        total = self.state.force
        return {
            "equilibrium": float(np.abs(force[free]).max()) / total,
            "load": abs(float(force[pressed].sum()) / total - 1.0),
        }

    def _numbers(self, component: int) -> np.ndarray:
        """Of the degrees of freedom along r (0) or z (1)."""
        return np.concatenate([self.basis.nodal_dofs[component], self.basis.facet_dofs[component]])

    def yields(self, scene: Scene) -> float:
        """Largest (mises - sigma_y)/sigma_y at the Gauss points."""
        return float((von_mises(self.pressures()) / self.limit(scene) - 1.0).max())

    def limit(self, scene: Scene) -> np.ndarray:
        """Yield stress at the Gauss points in Pa."""
        return yield_stress(scene, self.peeq * self.unit, self.z * self.model.scales.length)

    @property
    def unit(self) -> float:
        """Strain of a strain of the model."""
        return self.model.scales.displacement / self.model.scales.length

    def flow(self, scene: Scene, before: Finite) -> dict[str, float]:
        """`flow_of` the step that ends here and began at `before`."""
        rr, tt, zz, rz = (self.plastic - before.plastic) * self.unit
        strain = np.stack([rr, tt, zz, 0 * rr, rz, 0 * rr])
        return flow_of(scene, strain, (self.peeq - before.peeq) * self.unit, self.pressures(), self.limit(scene))

    def surface(self) -> dict[str, float]:
        """Tractions in the elements at the surface against the nodal pressure, as `sam_surface`, linear from the Gauss points."""
        top = np.isclose(self.z.min(axis=1), self.z.min())
        z = self.z[top]
        order = np.lexsort((z, np.round(self.r[top] / self.r[top].max(), 9)))
        r, z, rz, zz = (np.take_along_axis(f, order, axis=1) for f in (self.r[top], z, self.stress[3][top], self.stress[2][top]))
        share = z[:, ::2] / (z[:, 1::2] - z[:, ::2])
        r, zz, rz = (f[:, ::2] + share * (f[:, ::2] - f[:, 1::2]) for f in (r, zz, rz))
        pressure = self.model.nodal_pressure(self.state)
        a, nodes = self.model.contact_radius(self.state), self.model.surface
        p = np.interp(r, nodes[::2], pressure[::2])
        normal, shear = np.abs(zz + p) / pressure.max(), np.abs(rz) / pressure.max()
        out, inside = r > (1 + EDGE) * a, r < (1 - EDGE) * a
        return {
            "free": float(max(normal[out].max(), shear[out].max())),
            "pressed": float(max(normal[inside].max(), shear[inside].max())),
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
            errors.append(planes(r, np.array([depth]), szz[:, None], self.state.force, spread)[0])
        return depths, np.array(errors)

def steps_of(scene: Scene, records: Sequence[Checkpoint]) -> tuple[Model, list[Step]]:
    """The model of a scene and its steps, of the last record, or, of an elastic body that has none, taken again."""
    model = build(scene)
    if not records:
        return model, run(model, scene.loading)
    return model, Progressed.from_tree(records[-1].tree()).steps
