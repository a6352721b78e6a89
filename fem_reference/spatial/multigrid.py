# SPDX-License-Identifier: MIT
"""Conjugate gradients with algebraic multigrid: the linear systems of the three-dimensional model.

Smoothed aggregation with the rigid-body modes as candidates (Vanek, Mandel and Brezina, Computing 56 (1996) 179), by PyAMG.
The matrix keeps its pattern: rows and columns of prescribed degrees of freedom become those of the diagonal. Nothing in it
is random, so that equal problems have equal answers to the last digit.
"""

from __future__ import annotations

import numpy as np
import pyamg
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, cg, gmres

MOST = 300
"""Iterations of a linear solve; some tens are usual."""
COARSEST = 300
"""Nodes of a level below which it is solved directly."""
COARSEST_COATED = 60
"""With the more nodes of a film: as many iterations, a quarter of the time."""
COARSEST_ROUGH = 60
"""Of a rough body, modelled as a whole: likewise."""


class UnsolvedError(ArithmeticError):
    """A linear system that is not positive definite, or too badly conditioned."""


class Preconditioner:
    """Approximate inverse of the stiffness matrix between the free degrees of freedom.

    pattern: of the stiffness matrix, three degrees of freedom per node in turn; points: (3, n_nodes); far: (n_nodes,) bool,
    nodes that are never free; coarsest: nodes of a level that is solved directly.
    """

    def __init__(self, pattern: sp.csr_matrix, points: np.ndarray, far: np.ndarray, coarsest: int = COARSEST):
        self.coarsest = coarsest
        self.inner = np.flatnonzero(np.repeat(~far, 3))
        numbered = sp.csr_matrix(
            (np.arange(1, pattern.nnz + 1), pattern.indices, pattern.indptr), shape=pattern.shape
        )
        part = numbered[self.inner][:, self.inner].tocsr()
        part.sort_indices()
        self.places, self.part = part.data - 1, part
        self.rows = np.repeat(np.arange(part.shape[0]), np.diff(part.indptr))
        self.modes = rigid_modes(points[:, ~far])

    def __call__(self, matrix: sp.csr_matrix, free: np.ndarray):
        """Function r -> z, (n_dofs,) both, for the given tangent; zero outside `free` (n_dofs,) bool."""
        inside = free[self.inner]
        data = matrix.data[self.places]
        diagonal = self.rows == self.part.indices
        data = np.where((inside[self.rows] & inside[self.part.indices]) | diagonal, data, 0.0)
        blocks = sp.csr_matrix((data, self.part.indices, self.part.indptr), shape=self.part.shape).tobsr((3, 3))
        levels = pyamg.smoothed_aggregation_solver(
            blocks,
            B=self.modes * inside[:, None],
            # the local weighting needs no spectral radius, which PyAMG estimates from random vectors
            smooth=("jacobi", {"omega": 4.0 / 3.0, "weighting": "local"}),
            improve_candidates=None,
            max_coarse=self.coarsest,
        )
        cycle = levels.aspreconditioner()

        def apply(r: np.ndarray) -> np.ndarray:
            z = np.zeros(r.size)
            z[self.inner] = cycle @ (r[self.inner] * inside)
            return np.where(free, z, 0.0)

        return apply


def rigid_modes(points: np.ndarray) -> np.ndarray:
    """(3 n, 6) translations and rotations of n points (3, n), degrees of freedom of a node in turn."""
    x, y, z = points
    zero, one = np.zeros_like(x), np.ones_like(x)
    modes = [
        (one, zero, zero),
        (zero, one, zero),
        (zero, zero, one),
        (zero, -z, y),
        (z, zero, -x),
        (-y, x, zero),
    ]
    return np.stack([np.stack(mode, axis=1).ravel() for mode in modes], axis=1)


def solve(
    operator: LinearOperator, right: np.ndarray, preconditioner: LinearOperator, accuracy: float, symmetric: bool
) -> np.ndarray:
    """Solution with |right - A x| <= accuracy |right|: conjugate gradients, or GMRES if A is not symmetric.

    Raises UnsolvedError.
    """
    if not right.any():
        return np.zeros_like(right)
    if symmetric:
        x, info = cg(operator, right, rtol=accuracy, M=preconditioner, maxiter=MOST)
    else:
        x, info = gmres(operator, right, rtol=accuracy, M=preconditioner, maxiter=3, restart=MOST // 3)
    if info != 0 or not np.isfinite(x).all() or right @ x <= 0.0:
        raise UnsolvedError(f"no solution in {MOST} iterations")
    return x
