# SPDX-License-Identifier: MIT
"""Axisymmetric isotropic elasticity on a quadrilateral mesh.

Strain and stress are (rr, tt, zz, rz) with the engineering shear strain 2 e_rz: e_rr = du_r/dr, e_tt = u_r/r,
e_zz = du_z/dz, 2 e_rz = du_r/dz + du_z/dr. Integrals are over the full ring, 2 pi r dr dz, so that nodal forces are
forces.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad
from skfem.element import Element


def stiffness_tensor(young: float, poisson: float) -> np.ndarray:
    """Isotropic stiffness (4, 4), lambda 1 1 + 2 G, in the components (rr, tt, zz, rz); units of `young`."""
    shear = young / (2.0 * (1.0 + poisson))
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    D = np.diag([2.0 * shear, 2.0 * shear, 2.0 * shear, shear])
    D[:3, :3] += lame
    return D


def mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress of (rr, tt, zz, rz) in the first axis of `stress`."""
    rr, tt, zz, rz = stress
    return np.sqrt(0.5 * ((rr - tt) ** 2 + (tt - zz) ** 2 + (zz - rr) ** 2) + 3.0 * rz**2)


def deviator(stress: np.ndarray) -> np.ndarray:
    """Deviator of (rr, tt, zz, rz) in the first axis of `stress`."""
    s = stress.copy()
    s[:3] -= stress[:3].mean(axis=0)
    return s


class AxisymmetricSolid:
    """A body on a mesh: 8-node serendipity elements with 2 x 2 Gauss points.

    A patch of them has no zero-energy mode but the rigid one; 9-node elements (ElementQuad2) with these points have.
    young: any unit of stress. Displacements are (n_dofs,), fields at the Gauss points (4, n_elements, 4).
    """

    def __init__(self, mesh: MeshQuad, young: float, poisson: float, element: Element | None = None):
        self.basis = Basis(mesh, ElementVector(element or ElementQuadS2()), intorder=3)
        self.stiffness_tensor = stiffness_tensor(young, poisson)
        self.points = np.asarray(self.basis.global_coordinates())  # (2, n_elements, 4)
        self.weights = 2.0 * np.pi * self.points[0] * self.basis.dx  # ring volume of each Gauss point
        self._B = self._strain_operator()
        self.stiffness = self._stiffness()

    def _strain_operator(self) -> np.ndarray:
        """B of strain = B u_element: (n_elements, 4 points, 4 strains, n_local)."""
        rows = []
        for (shape,) in self.basis.basis:
            u, grad = np.asarray(shape), shape.grad
            rows.append([grad[0, 0], u[0] / self.points[0], grad[1, 1], grad[0, 1] + grad[1, 0]])
        return np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3))

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self.basis.N

    def strain(self, u: np.ndarray) -> np.ndarray:
        """Strain (4, n_elements, 4) at the Gauss points."""
        return np.einsum("eqsi,ie->seq", self._B, u[self.basis.element_dofs])

    def stress(self, u: np.ndarray, plastic_strain: np.ndarray | float = 0.0) -> np.ndarray:
        """Stress (4, n_elements, 4) at the Gauss points, where the reduced rule makes it superconvergent."""
        return np.einsum("st,teq->seq", self.stiffness_tensor, self.strain(u) - plastic_strain)

    def internal_force(self, stress: np.ndarray) -> np.ndarray:
        """Nodal forces (n_dofs,): integral of B^T stress over the ring."""
        local = np.einsum("eqsi,seq,eq->ie", self._B, stress, self.weights)
        return np.bincount(self.basis.element_dofs.ravel(), local.ravel(), minlength=self.size)

    def _stiffness(self) -> sp.csr_matrix:
        """Stiffness matrix (n_dofs, n_dofs): integral of B^T D B over the ring."""
        elements, points, strains, n_local = self._B.shape
        B = self._B.reshape(elements, points * strains, n_local)
        stress_operator = np.einsum("st,eqti,eq->eqsi", self.stiffness_tensor, self._B, self.weights)
        local = B.transpose(0, 2, 1) @ stress_operator.reshape(B.shape)
        dofs = self.basis.element_dofs.T
        rows = np.broadcast_to(dofs[:, :, None], local.shape)
        columns = np.broadcast_to(dofs[:, None, :], local.shape)
        return sp.coo_matrix((local.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size, self.size)).tocsr()

    @cached_property
    def _places(self) -> np.ndarray:
        """Place of each entry of each element in the data of `stiffness`: (n_elements, n_local, n_local)."""
        pattern, dofs = self.stiffness, self.basis.element_dofs.T.astype(np.int64)
        rows = np.repeat(np.arange(self.size, dtype=np.int64), np.diff(pattern.indptr))
        return np.searchsorted(rows * self.size + pattern.indices, dofs[:, :, None] * self.size + dofs[:, None, :])

    def softened(self, elements: np.ndarray, loss: np.ndarray) -> sp.csr_matrix:
        """The stiffness matrix, same pattern, when the moduli of some elements are smaller.

        elements: (m,) their numbers; loss: (m, 4 points, 4, 4), subtracted from `stiffness_tensor`.
        """
        if not elements.size:
            return self.stiffness
        B, weights = self._B[elements], self.weights[elements]
        stress_operator = (loss @ B) * weights[:, :, None, None]
        flat = (elements.size, -1, B.shape[-1])
        local = B.reshape(flat).transpose(0, 2, 1) @ stress_operator.reshape(flat)
        places = self._places[elements].ravel()
        data = self.stiffness.data - np.bincount(places, local.ravel(), minlength=self.stiffness.nnz)
        return sp.csr_matrix((data, self.stiffness.indices, self.stiffness.indptr), shape=self.stiffness.shape)

    def boundary_dofs(self, name: str, component: int) -> np.ndarray:
        """Degrees of freedom of u_r (component 0) or u_z (1) on a boundary, ordered by r and then z."""
        dofs = self.basis.get_dofs(name).all(f"u^{component + 1}")
        r, z = self.basis.doflocs[:, dofs]
        return dofs[np.lexsort((z, r))]


def surface_weights(r: np.ndarray) -> np.ndarray:
    """Area of each node of a line of quadratic edges from the axis: integral of its shape function, 2 pi r dr.

    r: (2 n + 1,), corner and mid nodes in turn. An edge from r0 to r1 gives h r0/6, h (r0 + r1)/3 and h r1/6, times
    2 pi; hence the node on the axis has none.
    """
    h = np.diff(r[::2])
    area = np.zeros_like(r)
    area[:-2:2] += h * r[:-2:2] / 6.0
    area[2::2] += h * r[2::2] / 6.0
    area[1::2] = h * r[1::2] * 2.0 / 3.0
    return 2.0 * np.pi * area
