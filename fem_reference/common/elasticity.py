# SPDX-License-Identifier: MIT
"""Isotropic elasticity: stiffness tensor, stress invariants, bodies on meshes.

Components of strain and stress are three normal ones and then the shears, one in axial symmetry, (rr, tt,
zz, rz), three in space, (xx, yy, zz, yz, xz, xy); shear strains are engineering ones, 2 e_rz.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from skfem import Basis

from fem_reference.common.arrays import Array, Bools, Integers
from fem_reference.common.bodies import Coating, Elastic


def stiffness_tensor(young: float, poisson: float, shears: int = 1) -> Array:
    """Isotropic stiffness, lambda 1 1 + 2 G, (n, n) with n = 3 + `shears` components; units of `young`."""
    shear = young / (2.0 * (1.0 + poisson))
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    D = np.diag([2.0 * shear] * 3 + [shear] * shears)
    D[:3, :3] += lame
    return D


def mises(stress: Array) -> Array:
    """Von Mises stress, components in the first axis of `stress`."""
    xx, yy, zz, *shears = stress
    square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.sqrt(square + 3.0 * sum(shear**2 for shear in shears))


def deviator(stress: Array) -> Array:
    """Deviator, components in the first axis of `stress`."""
    s = stress.copy()
    s[:3] -= stress[:3].mean(axis=0)
    return s


def on_grid(points: Array, shape: tuple[int, ...]) -> Integers:
    """Numbers of the points (dimension, n) of a tensor grid, as an array of the shape of the grid."""
    return np.lexsort(np.round(points, 12)[::-1]).reshape(shape)


class Solid:
    """An elastic body on a mesh, given the strain operator of its elements.

    Displacements are (n_dofs,), fields at the Gauss points (n_strains, n_elements, n_points). basis: of
    scikit-fem, with a vector element; elastic: constants below the coating; B: (n_elements, n_points,
    n_strains, n_local), strain = B u_element, with engineering shear; weights: (n_elements, n_points), the
    volume of each Gauss point; coating: on the body, whose thickness is a plane between elements.
    """

    def __init__(
        self, basis: Basis, B: Array, weights: Array, elastic: Elastic, *, coating: Coating | None = None
    ):
        self.basis, self._B, self.weights = basis, B, weights
        self.elastic, self.coating = elastic, coating
        self.points = np.asarray(basis.global_coordinates())  # (dimension, n_elements, n_points)
        self.stiffness_tensor = stiffness_tensor(elastic.young, elastic.poisson, shears=B.shape[2] - 3)
        self.stiffness = self._stiffness()

    @cached_property
    def in_coating(self) -> Bools:
        """Elements of the coating, (n_elements,)."""
        thickness = 0.0 if self.coating is None else self.coating.thickness
        return self.points[-1].mean(axis=1) < thickness

    @cached_property
    def coating_tensor(self) -> Array:
        """Stiffness tensor of the coating; of the body where there is none."""
        if self.coating is None:
            return self.stiffness_tensor
        shears = len(self.stiffness_tensor) - 3
        return stiffness_tensor(self.coating.young, self.coating.poisson, shears=shears)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return int(self.basis.N)

    @property
    def _by_element(self) -> Array:
        """B as (n_elements, n_points n_strains, n_local)."""
        elements, points, strains, n_local = self._B.shape
        return self._B.reshape(elements, points * strains, n_local)

    def strain(self, u: Array) -> Array:
        """Strain (n_strains, n_elements, n_points) at the Gauss points."""
        flat = self._by_element @ u[self.basis.element_dofs].T[:, :, None]
        return np.ascontiguousarray(np.moveaxis(flat.reshape(self._B.shape[:3]), 2, 0))

    def stress(self, u: Array, plastic_strain: Array | float = 0.0) -> Array:
        """Stress (n_strains, n_elements, n_points) at the Gauss points."""
        strain = self.strain(u) - plastic_strain
        stress = np.einsum("st,teq->seq", self.stiffness_tensor, strain)
        if self.coating is not None:
            stress[:, self.in_coating] = np.einsum(
                "st,teq->seq", self.coating_tensor, strain[:, self.in_coating]
            )
        return stress

    def internal_force(self, stress: Array) -> Array:
        """Nodal forces (n_dofs,): integral of B^T stress."""
        weighted = np.moveaxis(stress * self.weights, 0, 2).reshape(len(self._B), 1, -1)
        local = (weighted @ self._by_element)[:, 0]
        dofs = self.basis.element_dofs.T.ravel()
        return np.asarray(np.bincount(dofs, local.ravel(), minlength=self.size), dtype=float)

    def _stiffness(self) -> sp.csr_matrix:
        """Stiffness matrix (n_dofs, n_dofs): integral of B^T D B."""
        stress_operator = (self.stiffness_tensor @ self._B) * self.weights[:, :, None, None]
        if self.coating is not None:
            weights = self.weights[self.in_coating, :, None, None]
            stress_operator[self.in_coating] = (self.coating_tensor @ self._B[self.in_coating]) * weights
        local = self._by_element.transpose(0, 2, 1) @ stress_operator.reshape(self._by_element.shape)
        dofs = self.basis.element_dofs.T
        rows = np.broadcast_to(dofs[:, :, None], local.shape)
        columns = np.broadcast_to(dofs[:, None, :], local.shape)
        return sp.coo_matrix(
            (local.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size, self.size)
        ).tocsr()

    @cached_property
    def _places(self) -> Integers:
        """(n_elements, n_local, n_local) where the entries of each element are in the data of `stiffness`."""
        rows = np.repeat(np.arange(self.size, dtype=np.int64), np.diff(self.stiffness.indptr))
        # row and column of each entry as one ascending number
        keys = rows * self.size + self.stiffness.indices
        dofs = self.basis.element_dofs.T.astype(np.int64)
        parts = (part[:, :, None] * self.size + part[:, None, :] for part in np.array_split(dofs, 16))
        return np.concatenate([np.searchsorted(keys, part).astype(np.int32) for part in parts])

    def softened(self, elements: Integers, loss: Array) -> sp.csr_matrix:
        """The stiffness matrix less that of `loss` (m, n_points, n_strains, n_strains) in elements."""
        if not elements.size:
            return self.stiffness
        B, weights = self._B[elements], self.weights[elements]
        stress_operator = (loss @ B) * weights[:, :, None, None]
        flat = (elements.size, -1, B.shape[-1])
        local = B.reshape(flat).transpose(0, 2, 1) @ stress_operator.reshape(flat)
        places = self._places[elements].ravel()
        data = self.stiffness.data - np.bincount(places, local.ravel(), minlength=self.stiffness.nnz)
        return sp.csr_matrix(
            (data, self.stiffness.indices, self.stiffness.indptr), shape=self.stiffness.shape
        )

    def boundary_dofs(self, name: str, component: int) -> Integers:
        """Degrees of freedom of one component on a boundary, by the first coordinate, then the next."""
        dofs = self.basis.get_dofs(name).all(f"u^{component + 1}")
        return dofs[np.lexsort(self.basis.doflocs[::-1, dofs])]
