# SPDX-License-Identifier: MIT
"""Deformation of axial symmetry: gradients of elements, and functions of symmetric tensors by their
principal values.

Components of a gradient are (rr, tt, zz, rz, zr), the first index that of the displacement; of a symmetric
tensor (rr, tt, zz, rz), without a factor on the shear. Lengths and displacements may have different units,
`strain` apart: the deformation gradient is F = 1 + strain grad u.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from skfem import Basis

from fem_reference.common.arrays import Array


class GradientOperator:
    """grad u at the Gauss points of axisymmetric elements, nodal forces and their derivative."""

    def __init__(self, basis: Basis, weights: Array):
        """weights: (n_elements, n_points) volume of each point, undeformed."""
        r = np.asarray(basis.global_coordinates())[0]
        rows = []
        for (shape,) in basis.basis:
            u, grad = np.asarray(shape), shape.grad
            rows.append([grad[0, 0], u[0] / r, grad[1, 1], grad[0, 1], grad[1, 0]])
        local = np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3))
        self.size, self.dofs, self.weights = basis.N, basis.element_dofs.T, weights
        self._shape = local.shape
        self._flat = np.ascontiguousarray(local.reshape(len(local), -1, local.shape[-1]))

    def gradient(self, u: Array) -> Array:
        """(n_elements, n_points, 5) of the displacements (n_dofs,)."""
        return (self._flat @ u[self.dofs][:, :, None]).reshape(self._shape[:3])

    def nodal_forces(self, stress: Array) -> Array:
        """(n_dofs,) of the first Piola-Kirchhoff stress (n_elements, n_points, 5)."""
        weighted = (stress * self.weights[..., None]).reshape(len(stress), 1, -1)
        flat = (weighted @ self._flat).ravel()
        return np.asarray(np.bincount(self.dofs.ravel(), flat, minlength=self.size), dtype=float)

    def stiffness(self, tangent: Array) -> sp.csr_matrix:
        """Derivative of the nodal forces from that of the stress, (n_elements, n_points, 5, 5)."""
        weighted = (tangent * self.weights[..., None, None]) @ self._flat.reshape(self._shape)
        local = self._flat.transpose(0, 2, 1) @ weighted.reshape(self._flat.shape)
        rows, columns = (
            np.broadcast_to(d, local.shape).ravel() for d in (self.dofs[:, :, None], self.dofs[:, None, :])
        )
        return sp.coo_matrix((local.ravel(), (rows, columns)), shape=(self.size,) * 2).tocsr()


@dataclass(frozen=True)
class Principal:
    """A symmetric tensor by its principal values (..., 3), in the order 1, hoop, 2, and the axes 1 and 2.

    axes: (..., 2, 2), column k is axis k in (r, z); difference: of the values 1 and 2, without cancellation.
    """

    values: Array
    axes: Array
    difference: Array


def principal(tensor: Array) -> Principal:
    """Principal values and axes of tensors (..., 4); r and z where both in the plane are equal."""
    rr, tt, zz, rz = np.moveaxis(tensor, -1, 0)
    middle, half = 0.5 * (rr + zz), np.hypot(0.5 * (rr - zz), rz)
    angle = 0.5 * np.arctan2(rz, 0.5 * (rr - zz))
    c, s = np.cos(angle), np.sin(angle)
    axes = np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)
    return Principal(np.stack([middle + half, tt, middle - half], axis=-1), axes, 2.0 * half)


def composed(axes: Array, values: Array) -> Array:
    """(..., 4): sum of values[k] axis_k axis_k^T in the plane, and the hoop value."""
    rr, zz = ((axes[..., i, :] ** 2 * values[..., ::2]).sum(axis=-1) for i in (0, 1))
    rz = (axes[..., 0, :] * axes[..., 1, :] * values[..., ::2]).sum(axis=-1)
    return np.stack([rr, values[..., 1], zz, rz], axis=-1)


def exponential_change(tensor: Array) -> Array:
    """exp - 1 of a symmetric tensor (..., 4), accurate where it is small."""
    p = principal(tensor)
    return composed(p.axes, np.expm1(p.values))


def logarithm(tensor: Array) -> Array:
    """log of a positive definite symmetric tensor (..., 4)."""
    p = principal(tensor)
    return composed(p.axes, np.log(p.values))


def deformation(gradient: Array, strain: float) -> tuple[Array, Array]:
    """F - 1 of (..., 5): in the plane (..., 2, 2), and of the hoop (...)."""
    rr, tt, zz, rz, zr = np.moveaxis(strain * gradient, -1, 0)
    return np.stack([np.stack([rr, rz], axis=-1), np.stack([zr, zz], axis=-1)], axis=-2), tt


def pushed_change(shift: Array, hoop: Array, change: Array) -> Array:
    """F (1 + change) F^T - 1 (..., 4) of F = 1 + shift, and of the hoop; without cancellation."""
    rr, tt, zz, rz = np.moveaxis(change, -1, 0)
    turned, F = np.swapaxes(shift, -1, -2), shift + np.eye(2)
    inner = np.stack([np.stack([rr, rz], axis=-1), np.stack([rz, zz], axis=-1)], axis=-2)
    plane = shift + turned + shift @ turned + F @ inner @ np.swapaxes(F, -1, -2)
    around = hoop * (2.0 + hoop) + (1.0 + hoop) ** 2 * tt
    return np.stack([plane[..., 0, 0], around, plane[..., 1, 1], plane[..., 0, 1]], axis=-1)
