# SPDX-License-Identifier: MIT
"""A polynomial fitted to a result over the points of a design: how well it predicts points that it has not
seen, and which inputs make the variance that it predicts.

The terms are Legendre polynomials of single inputs, orthonormal over their ranges, so that sums of squared
coefficients are shares of the variance: Sudret, Reliab. Eng. Syst. Saf. 93 (2008) 964. Terms are chosen one
after the other by the error at points left out: Blatman & Sudret, J. Comput. Phys. 230 (2011) 2345. The
result is taken by its ranks, which may be infinite and follow any scale: Iman & Conover, Technometrics 21
(1979) 499.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import rankdata

DEGREES = 2
POINTS_A_TERM = 6  # no more terms than the points over this: beyond it they follow single points


@dataclass(frozen=True)
class Surrogate:
    """predicted: the share Q² of the variance that is predicted at points left out, the choice of terms made
    anew without each of them (negative: worse than the mean); shares (inputs,) of the variance by each
    input, whose sum is Q², 0 where that is negative; slopes (inputs,): sign of its linear term, 0 without.
    """

    predicted: float
    shares: np.ndarray
    slopes: np.ndarray


def surrogate(shares: np.ndarray, values: np.ndarray) -> Surrogate | None:
    """The polynomial of a result (points,) at shares (points, inputs) in [0, 1]; points where it is NaN are
    left out. None where it never changes or there are fewer points than for two terms.
    """
    there = ~np.isnan(values)
    ranks = rankdata(values[there])
    if len(ranks) < 2 * POINTS_A_TERM or not np.ptp(ranks):
        return None
    aims = (ranks - ranks.mean()) / ranks.std()
    basis = _basis(shares[there])
    errors = [
        aims[k] - _value(np.delete(basis, k, axis=0), np.delete(aims, k), basis[k]) for k in range(len(aims))
    ]
    spread = [aims[k] - np.delete(aims, k).mean() for k in range(len(aims))]
    predicted = 1.0 - float(np.sum(np.square(errors)) / np.sum(np.square(spread)))
    terms, coefficients = _fitted(basis, aims)
    own = np.zeros(basis.shape[1])
    own[terms] = coefficients
    linear, *rest = np.split(own, DEGREES)
    parts = linear**2 + np.sum(np.square(rest), axis=0)
    total = parts.sum()
    return Surrogate(predicted, parts * (max(predicted, 0.0) / total if total else 0.0), np.sign(linear))


def _basis(shares: np.ndarray) -> np.ndarray:
    """Orthonormal polynomials (points, degrees * inputs): all of degree 1, then all of degree 2."""
    at = 2.0 * shares - 1.0
    return np.hstack([np.sqrt(3.0) * at, np.sqrt(5.0) * (1.5 * at**2 - 0.5)])


def _value(basis: np.ndarray, aims: np.ndarray, at: np.ndarray) -> float:
    """The value of the polynomial fitted to some points at another one, whose basis is (terms,)."""
    terms, coefficients = _fitted(basis, aims)
    return float(aims.mean() + at[terms] @ coefficients - basis[:, terms].mean(axis=0) @ coefficients)


def _fitted(basis: np.ndarray, aims: np.ndarray) -> tuple[list[int], np.ndarray]:
    """The chosen columns of a basis, and their coefficients beside a constant."""
    terms: list[int] = []
    least = _left_out(np.ones((1, len(aims), 1)), aims)[0]
    while len(terms) < len(aims) // POINTS_A_TERM:
        rest = [k for k in range(basis.shape[1]) if k not in terms]
        errors = _left_out(np.stack([_columns(basis, [*terms, k]) for k in rest]), aims)
        best = int(errors.argmin())
        if errors[best] >= least:
            break
        least = errors[best]
        terms.append(rest[best])
    found = np.linalg.lstsq(_columns(basis, terms), aims, rcond=None)[0]
    return terms, found[1:]


def _columns(basis: np.ndarray, terms: Sequence[int]) -> np.ndarray:
    return np.column_stack([np.ones(len(basis)), basis[:, terms]])


def _left_out(columns: np.ndarray, aims: np.ndarray) -> np.ndarray:
    """Sum of squared errors (candidates,) at points left out one by one, of candidates (candidates, points,
    columns): the residual over one less the leverage.
    """
    q = np.linalg.qr(columns)[0]
    left = aims - np.einsum("cpk,ck->cp", q, np.einsum("cpk,p->ck", q, aims))
    errors: np.ndarray = np.sum(np.square(left / (1.0 - np.sum(q**2, axis=2))), axis=1)
    return errors
