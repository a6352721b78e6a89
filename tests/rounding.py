# SPDX-License-Identifier: MIT
"""Bounds of rounding errors for tolerances that hold on any machine, to first order (Higham, Accuracy and
Stability of Numerical Algorithms, 2002).

Machines add in another order and fuse multiplications with additions (BLAS, LAPACK), and differ in the last
digits of elementary functions (numpy and libm: up to 4 EPS). What consists of + - * / and square roots in a
given order is the same on each of them. Where a test asks 1e-12 of a formula without a reason beside it, that
is 4500 EPS: fewer than a thousand roundings, and no cancellation.
"""

import numpy as np
import pytest

EPS = float(np.finfo(float).eps)


def close(expected, rel: float = 1e-14):
    """Relative only: many a depth or volume in SI units is below pytest's absolute tolerance of 1e-12."""
    return pytest.approx(expected, rel=rel, abs=0)


def of_least_squares(matrix: np.ndarray) -> float:
    """Of the norm of a solution by QR or SVD: longer side of the matrix, eps and condition (chapter 20)."""
    return max(matrix.shape) * EPS * float(np.linalg.cond(matrix))
