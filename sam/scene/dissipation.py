# SPDX-License-Identifier: MIT
"""Energy of a plastic strain in a unit volume: what the yield stress dissipates, and what back-stresses store
and dissipate.

The power of the stress is s : d eps_p = sigma_y dp + sum X_k : d eps_p. Each back-stress X_k = 2/3 C a_k
stores W = C/3 a_k : a_k and dissipates the rest, dD = 2/3 g C a_k : a_k dp. Along a constant direction N, in
which a = b a_0 + i N with b = exp(-g t), i = (1 - b)/g (see `sam.plasticity.flow`), the integrals over a
step are, with u = g dp, A = a_0 : a_0, B = a_0 : N and N : N = 3/2,

    D = 2/3 g C [ (1 - b^2)/(2 g) A + i^2 B + 3/2 dp^3 phi(u) ],                                           (a)
    phi(u) = [ u - 2 (1 - e^-u) + (1 - e^-2u)/2 ]/u^3.

A step counts X_k at its end, X_k1 : x with x = dp N, which is more than W_1 - W_0 + D by

    E = C dp^2 chi(u) (1 - 2/3 g B),      chi(u) = [ 1 - e^-u (1 + u) ]/u^2,                               (b)

an error of first order in the step. Neither is ever negative, because 2/3 a : a <= 1/g^2. In all
s_1 : x = sigma_y1 dp + sum (W_1 - W_0 + D + E), to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial
from typing import cast

import numpy as np

from sam.arrays import Array
from sam.scene.yield_curve import YieldCurve

POINTS, GRADING = 24, 4  # of Gauss's rule in s, peeq = s^GRADING: Swift's law rises within microstrains
# g dp up to which phi and chi are taken from their power series: beyond it their closed forms lose at most
# a factor of 24 of rounding, below it 18 terms leave 1e-16.
SMALL, TERMS = 0.5, 18


@dataclass(frozen=True)
class StepEnergies:
    """Of the back-stresses over a step, summed over them, in J/m^3: stored: W_1 - W_0; dissipated: D of (a);
    error: E of (b).
    """

    stored: Array
    dissipated: Array
    error: Array


def plastic_work(curve: YieldCurve, peeq: Array, before: Array | float = 0.0) -> Array:
    """Work of the yield stress, its integral over the accumulated plastic strain, by Gauss's rule.

    Parameters
    ----------
    curve
        The yield stress.
    peeq, before
        Ends of the integral, of the same shape or numbers.

    Returns
    -------
    Array
        In the unit of the curve.

    Examples
    --------
    >>> from sam.scene.yield_curve import Linear
    >>> round(float(plastic_work(Linear(1e9, 2e9), np.array(0.02), 0.01)))  # 1e9 0.01 + 1e9 (4e-4 - 1e-4)
    10300000
    """
    s, w = np.polynomial.legendre.leggauss(POINTS)
    s, w = (s + 1) / 2, w / 2
    added, total = peeq - before, np.zeros_like(peeq)
    for at, weight in zip(s, w, strict=True):
        total = total + weight * GRADING * at ** (GRADING - 1) * curve.stress(before + added * at**GRADING)
    found: Array = added * total
    return found


def stored_energy(modulus: Array, strains: Array) -> Array:
    """The energy W that back-stresses store, summed over them.

    Parameters
    ----------
    modulus
        C_k in Pa, (N, ...), which broadcasts with (N, cells).
    strains
        a_k, (N, n, cells): three normal components first, then shears of the tensor.

    Returns
    -------
    Array
        In J/m^3, (cells).
    """
    found: Array = (modulus * _contraction(strains, strains)).sum(axis=0) / 3
    return found


def step_energies(
    modulus: Array, recovery: Array, start: Array, strain: Array, *, length: Array
) -> StepEnergies:
    """Energies of back-stresses over a step.

    Parameters
    ----------
    modulus, recovery
        C_k in Pa and g_k, (N, ...), which broadcast with (N, cells).
    start
        a_k at the beginning, (N, n, cells), components as of `stored_energy`.
    strain
        Increment x of the plastic strain, (n, cells), a tensor.
    length
        Its accumulated length dp, (cells).

    Returns
    -------
    StepEnergies
        In J/m^3, (cells); zero where dp is.
    """
    u = recovery * length
    kept = np.exp(-u)
    i = np.divide(-np.expm1(-u), recovery, out=length + 0 * u, where=recovery > 0)
    twice = np.divide(-np.expm1(-2 * u), 2 * recovery, out=length + 0 * u, where=recovery > 0)
    A = _contraction(start, start)
    B = np.divide(_contraction(start, strain[None]), length, out=np.zeros_like(u), where=length > 0)
    straight = 1.5 * length**3 * _phi(u)
    stored = modulus / 3 * (-2 * recovery * twice * A + 2 * kept * i * B + 1.5 * i**2)
    dissipated = recovery * modulus / 1.5 * (twice * A + i**2 * B + straight)
    error = modulus * length**2 * _chi(u) * (1 - recovery * B / 1.5)
    return StepEnergies(stored.sum(axis=0), dissipated.sum(axis=0), error.sum(axis=0))


def _contraction(a: Array, b: Array) -> Array:
    """Double contraction of tensors (N, n, cells), (N, cells)."""
    found: Array = (a[:, :3] * b[:, :3]).sum(axis=1) + 2 * (a[:, 3:] * b[:, 3:]).sum(axis=1)
    return found


def _phi(u: Array) -> Array:
    """Of (a), 1/3 at u = 0."""
    series = [(2 - 2 ** (n - 1)) * (-1) ** n / factorial(n) for n in range(3, 3 + TERMS)]
    return _joined(u, series, lambda v: (v + 2 * np.expm1(-v) - np.expm1(-2 * v) / 2) / v**3)


def _chi(u: Array) -> Array:
    """Of (b), 1/2 at u = 0."""
    series = [(n - 1) * (-1) ** n / factorial(n) for n in range(2, 2 + TERMS)]
    return _joined(u, series, lambda v: (-np.expm1(-v) - v * np.exp(-v)) / v**2)


def _joined(u: Array, series: list[float], closed: Callable[[Array], Array]) -> Array:
    """A function by its power series near zero, and by its closed form beyond."""
    near = cast(Array, np.polynomial.polynomial.polyval(np.minimum(u, SMALL), series))
    return np.where(u < SMALL, near, closed(np.maximum(u, SMALL)))
