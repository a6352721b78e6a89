# SPDX-License-Identifier: MIT
"""Conjugate gradients with algebraic multigrid: the linear systems of the three-dimensional model.

Smoothed aggregation with the rigid-body modes as candidates (Vanek, Mandel and Brezina, Computing 56 (1996)
179), by PyAMG. The matrix keeps its pattern: rows and columns of prescribed degrees of freedom become those
of the diagonal. Nothing in it is random, so that equal problems have equal answers to the last digit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pyamg
import scipy.sparse as sp
from pyamg.relaxation.relaxation import gauss_seidel
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse.linalg import LinearOperator, cg, gmres

from fem_reference.common.arrays import Array, Bools

MOST = 300
"""Iterations of a linear solve; some tens are usual."""
COARSEST = 60
"""Nodes of a level below which it is solved directly."""


class UnsolvedError(ArithmeticError):
    """A linear system that is not positive definite, or too badly conditioned."""


class Preconditioner:
    """Approximate inverse between the free degrees of freedom. points: (3, n_nodes); far:
    (n_nodes,) bool.
    """

    def __init__(self, pattern: sp.csr_matrix, points: Array, far: Bools):
        self.inner = np.flatnonzero(np.repeat(~far, 3))
        numbered = sp.csr_matrix(
            (np.arange(1, pattern.nnz + 1), pattern.indices, pattern.indptr), shape=pattern.shape
        )
        part = numbered[self.inner][:, self.inner].tocsr()
        part.sort_indices()
        self.places, self.part = part.data - 1, part
        self.rows = np.repeat(np.arange(part.shape[0]), np.diff(part.indptr))
        self.modes = rigid_modes(points[:, ~far])

    def __call__(self, matrix: sp.csr_matrix, free: Bools) -> Callable[[Array], Array]:
        """Function r -> z, (n_dofs,) both, for the given tangent and `free` (n_dofs,) bool; by the diagonal
        outside of it.

        Positive definite between all degrees of freedom but those far away, so that it also serves another
        set of free ones.
        """
        inside = free[self.inner]
        data = matrix.data[self.places]
        diagonal = self.rows == self.part.indices
        data = np.where((inside[self.rows] & inside[self.part.indices]) | diagonal, data, 0.0)
        blocks = sp.csr_matrix((data, self.part.indices, self.part.indptr), shape=self.part.shape).tobsr(
            (3, 3)
        )
        made = pyamg.smoothed_aggregation_solver(
            blocks,
            B=self.modes * inside[:, None],
            # the local weighting needs no spectral radius, which PyAMG estimates from random vectors
            smooth=("jacobi", {"omega": 4.0 / 3.0, "weighting": "local"}),
            improve_candidates=None,
            presmoother=None,
            postsmoother=None,
            max_coarse=COARSEST,
        )
        *finer, last = made.levels
        levels, coarsest = [Level(level.A, level.P, level.R) for level in finer], Coarsest(last.A)

        def apply(r: Array) -> Array:
            z = np.zeros(r.size)
            z[self.inner] = v_cycle(levels, coarsest, r[self.inner])
            return z

        return apply


class Level:
    """A level of the hierarchy with its smoother, Gauss-Seidel by degrees of freedom: forwards on the way
    down, backwards on the way up.

    As many iterations as with blocks of a node, in half the time; and each sweep needs one triangle of the
    matrix, as the forward one begins at zero.
    """

    def __init__(self, A: sp.sparray, prolongation: sp.sparray, restriction: sp.sparray):
        matrix = A.tocsr()
        self.lower, self.upper = sp.tril(matrix, format="csr"), sp.triu(matrix, format="csr")
        self.diagonal, self.prolongation, self.restriction = matrix.diagonal(), prolongation, restriction

    def forwards(self, b: Array) -> Array:
        """Return x after a sweep from zero: (lower) x = b."""
        x = np.zeros_like(b)
        gauss_seidel(self.lower, x, b)
        return x

    def residual(self, x: Array) -> Array:
        """Return b - A x for the x of `forwards`."""
        return self.diagonal * x - self.upper @ x

    def backwards(self, x: Array, b: Array) -> Array:
        """Return x after a sweep backwards: (upper) x = b less what is below the diagonal."""
        right = b + self.diagonal * x - self.lower @ x
        gauss_seidel(self.upper, x, right, sweep="backward")
        return x


def v_cycle(levels: Sequence[Level], coarsest: Coarsest, b: Array) -> Array:
    """One V-cycle from zero."""
    if not levels:
        return coarsest(b)
    level, *coarser = levels
    x = level.forwards(b)
    x += level.prolongation @ v_cycle(coarser, coarsest, level.restriction @ level.residual(x))
    return level.backwards(x, b)


class Coarsest:
    """Direct solution of the coarsest level; rows of zeros give zero. Raises UnsolvedError."""

    def __init__(self, A: sp.sparray):
        dense = A.toarray()
        self.there = dense.diagonal() > np.finfo(float).eps * dense.diagonal().max()
        dense = np.where(np.outer(self.there, self.there), dense, np.diag(np.where(self.there, 0.0, 1.0)))
        try:
            self.factor = cho_factor(dense, lower=True)
        except LinAlgError as error:
            raise UnsolvedError(str(error)) from None

    def __call__(self, b: Array) -> Array:
        """Return the solution for the right-hand side b."""
        return cho_solve(self.factor, np.where(self.there, b, 0.0))


def rigid_modes(points: Array) -> Array:
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
    operator: LinearOperator,
    right: Array,
    preconditioner: LinearOperator,
    *,
    accuracy: float,
    target: float,
    symmetric: bool,
) -> Array:
    """Solution with |right - A x| at most accuracy |right| or `target`: conjugate gradients, or GMRES if A
    is not symmetric, with the preconditioner M on the right, A M y = right and x = M y.

    On the left it would end each of its few restarts by the residual of M (right - A x), which may be small
    where that of the equations is not. Raises UnsolvedError.
    """
    if not right.any():
        return np.zeros_like(right)
    x: Array
    if symmetric:
        x, info = cg(operator, right, maxiter=MOST, M=preconditioner, rtol=accuracy, atol=target)
    else:
        y, info = gmres(
            operator @ preconditioner, right, maxiter=3, restart=MOST // 3, rtol=accuracy, atol=target
        )
        x = preconditioner @ y
    if info != 0 or not np.isfinite(x).all() or right @ x < 0.0:
        raise UnsolvedError(f"no solution in {MOST} iterations")
    return x
