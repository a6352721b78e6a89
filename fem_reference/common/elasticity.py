# SPDX-License-Identifier: MIT
"""Isotropic elasticity: stiffness tensor, stress invariants, bodies on meshes; axisymmetric bodies.

Components of strain and stress are three normal ones and then the shears, one in axial symmetry, (rr, tt, zz, rz), three in
space, (xx, yy, zz, yz, xz, xy); shear strains are engineering ones, 2 e_rz.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad
from skfem.element import Element


def stiffness_tensor(young: float, poisson: float, shears: int = 1) -> np.ndarray:
    """Isotropic stiffness, lambda 1 1 + 2 G, (n, n) with n = 3 + `shears` components; units of `young`."""
    shear = young / (2.0 * (1.0 + poisson))
    lame = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    D = np.diag([2.0 * shear] * 3 + [shear] * shears)
    D[:3, :3] += lame
    return D


def mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress, components in the first axis of `stress`."""
    xx, yy, zz, *shears = stress
    square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.sqrt(square + 3.0 * sum(shear**2 for shear in shears))


def deviator(stress: np.ndarray) -> np.ndarray:
    """Deviator, components in the first axis of `stress`."""
    s = stress.copy()
    s[:3] -= stress[:3].mean(axis=0)
    return s


@dataclass(frozen=True)
class Film:
    """An elastic layer 0 <= z < thickness, bonded to a body of other moduli; in the units of the caller."""

    thickness: float
    young: float
    poisson: float


class Solid:
    """An elastic body on a mesh, given the strain operator of its elements.

    Displacements are (n_dofs,), fields at the Gauss points (n_strains, n_elements, n_points).
    basis: of scikit-fem, with a vector element; B: (n_elements, n_points, n_strains, n_local), strain = B u_element, with
    engineering shear; weights: (n_elements, n_points), the volume of each Gauss point; young: any unit of stress; film: on
    the body, whose thickness is a plane between elements.
    """

    def __init__(
        self,
        basis: Basis,
        B: np.ndarray,
        weights: np.ndarray,
        young: float,
        poisson: float,
        film: Film | None = None,
    ):
        self.basis, self._B, self.weights, self.film = basis, B, weights, film
        self.points = np.asarray(basis.global_coordinates())  # (dimension, n_elements, n_points)
        self.stiffness_tensor = stiffness_tensor(young, poisson, shears=B.shape[2] - 3)
        self.stiffness = self._stiffness()

    @cached_property
    def in_film(self) -> np.ndarray:
        """Elements (bool) of the film."""
        thickness = 0.0 if self.film is None else self.film.thickness
        return self.points[-1].mean(axis=1) < thickness

    @cached_property
    def film_tensor(self) -> np.ndarray:
        """As `stiffness_tensor`, of the film."""
        return stiffness_tensor(self.film.young, self.film.poisson, shears=len(self.stiffness_tensor) - 3)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self.basis.N

    @property
    def _by_element(self) -> np.ndarray:
        """B as (n_elements, n_points n_strains, n_local)."""
        elements, points, strains, n_local = self._B.shape
        return self._B.reshape(elements, points * strains, n_local)

    def strain(self, u: np.ndarray) -> np.ndarray:
        """Strain (n_strains, n_elements, n_points) at the Gauss points."""
        flat = self._by_element @ u[self.basis.element_dofs].T[:, :, None]
        return np.ascontiguousarray(np.moveaxis(flat.reshape(self._B.shape[:3]), 2, 0))

    def stress(self, u: np.ndarray, plastic_strain: np.ndarray | float = 0.0) -> np.ndarray:
        """Stress (n_strains, n_elements, n_points) at the Gauss points."""
        strain = self.strain(u) - plastic_strain
        stress = np.einsum("st,teq->seq", self.stiffness_tensor, strain)
        if self.film is not None:
            stress[:, self.in_film] = np.einsum("st,teq->seq", self.film_tensor, strain[:, self.in_film])
        return stress

    def internal_force(self, stress: np.ndarray) -> np.ndarray:
        """Nodal forces (n_dofs,): integral of B^T stress."""
        weighted = np.moveaxis(stress * self.weights, 0, 2).reshape(len(self._B), 1, -1)
        local = (weighted @ self._by_element)[:, 0]
        return np.bincount(self.basis.element_dofs.T.ravel(), local.ravel(), minlength=self.size)

    def _stiffness(self) -> sp.csr_matrix:
        """Stiffness matrix (n_dofs, n_dofs): integral of B^T D B."""
        stress_operator = (self.stiffness_tensor @ self._B) * self.weights[:, :, None, None]
        if self.film is not None:
            weights = self.weights[self.in_film, :, None, None]
            stress_operator[self.in_film] = (self.film_tensor @ self._B[self.in_film]) * weights
        local = self._by_element.transpose(0, 2, 1) @ stress_operator.reshape(self._by_element.shape)
        dofs = self.basis.element_dofs.T
        rows = np.broadcast_to(dofs[:, :, None], local.shape)
        columns = np.broadcast_to(dofs[:, None, :], local.shape)
        return sp.coo_matrix(
            (local.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size, self.size)
        ).tocsr()

    @cached_property
    def _places(self) -> np.ndarray:
        """(n_elements, n_local, n_local) where the entries of each element are in the data of `stiffness`."""
        rows = np.repeat(np.arange(self.size, dtype=np.int64), np.diff(self.stiffness.indptr))
        keys = (
            rows * self.size + self.stiffness.indices
        )  # row and column of each entry as one ascending number
        dofs = self.basis.element_dofs.T.astype(np.int64)
        parts = (part[:, :, None] * self.size + part[:, None, :] for part in np.array_split(dofs, 16))
        return np.concatenate([np.searchsorted(keys, part).astype(np.int32) for part in parts])

    def softened(self, elements: np.ndarray, loss: np.ndarray) -> sp.csr_matrix:
        """The stiffness matrix, same pattern, when the moduli of some elements are smaller.

        elements: (m,) their numbers; loss: (m, n_points, n_strains, n_strains), subtracted from the elastic moduli.
        """
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

    def boundary_dofs(self, name: str, component: int) -> np.ndarray:
        """Degrees of freedom of one component on a boundary, by the first coordinate, then the next."""
        dofs = self.basis.get_dofs(name).all(f"u^{component + 1}")
        return dofs[np.lexsort(self.basis.doflocs[::-1, dofs])]


class AxisymmetricSolid(Solid):
    """A body on a mesh: 8-node serendipity elements with 2 x 2 Gauss points, where stresses are superconvergent.

    e_rr = du_r/dr, e_tt = u_r/r, e_zz = du_z/dz, 2 e_rz = du_r/dz + du_z/dr; integrals are over the full ring, 2 pi r dr dz,
    so that nodal forces are forces. A patch of them has no zero-energy mode but the rigid one; 9-node elements (ElementQuad2)
    with these points have. young: any unit of stress. Displacements are (n_dofs,), fields at the Gauss points (4, n_elements, 4).
    """

    def __init__(
        self,
        mesh: MeshQuad,
        young: float,
        poisson: float,
        element: Element | None = None,
        film: Film | None = None,
    ):
        basis = Basis(mesh, ElementVector(element or ElementQuadS2()), intorder=3)
        r = np.asarray(basis.global_coordinates())[0]
        super().__init__(basis, _strain_operator(basis, r), 2.0 * np.pi * r * basis.dx, young, poisson, film)


def _strain_operator(basis: Basis, r: np.ndarray) -> np.ndarray:
    """B of strain = B u_element: (n_elements, 4 points, 4 strains, n_local)."""
    rows = []
    for (shape,) in basis.basis:
        u, grad = np.asarray(shape), shape.grad
        rows.append([grad[0, 0], u[0] / r, grad[1, 1], grad[0, 1] + grad[1, 0]])
    return np.ascontiguousarray(np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3)))


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
