# SPDX-License-Identifier: MIT
"""Bounds of rounding errors for tolerances that hold on any machine, to first order (Higham, Accuracy and Stability of
Numerical Algorithms, 2002).

Machines add in another order and fuse multiplications with additions (BLAS, LAPACK), and differ in the last digits of
elementary functions (numpy and libm: up to 4 EPS). What consists of + - * / and square roots in a given order is the same
on each of them. Where a test asks 1e-12 of a formula without a reason beside it, that is 4500 EPS: fewer than a thousand
roundings, and no cancellation.

Numbers of iterations that must be equal, in other units say: rounding moves a relative residual r by some 5e-15/r of itself
(1e-4 of 1e-10, in contacts of up to 65 x 65 cells), and the residuals nearest to the goal of an iteration lie 0.14 % off it or
more in all of these tests.
"""

from __future__ import annotations

import numpy as np
import pytest

EPS = float(np.finfo(float).eps)


def close(expected, rel: float = 1e-14):
    """Relative only: pytest's own absolute tolerance of 1e-12 is larger than many a depth or volume in SI units."""
    return pytest.approx(expected, rel=rel, abs=0)


def of_sum(terms) -> float:
    """n eps sum |x|: a sum, or a scalar product with these n products, in any order (section 4.2)."""
    return np.size(terms) * EPS * float(np.abs(terms).sum())


def of_least_squares(matrix: np.ndarray) -> float:
    """Of the norm of a solution by QR or singular values: the longer side of the matrix, eps and its condition (chapter 20)."""
    return max(matrix.shape) * EPS * float(np.linalg.cond(matrix))
