# SPDX-License-Identifier: MIT
"""Transforms of what is even or odd about a point, against sums of exponentials over all of it."""

import numpy as np
import pytest
from rounding import EPS

from sam.contact import convolution as real_transforms
from sam.contact.convolution import back, forward, half_length, real_spectrum


def summed(kept: np.ndarray, half: int, odd: bool, between: bool) -> np.ndarray:
    """The 2 half values written out from the kept ones (..., n), their discrete Fourier sum, times i^odd and
    real.
    """
    place = np.arange(half if between else half + 1)[: kept.shape[-1]] + 0.5 * between
    kept = kept[..., : len(place)].astype(float)
    total = np.zeros((*kept.shape[:-1], half + 1), dtype=complex)
    for j, value in zip(place, np.moveaxis(kept, -1, 0), strict=True):
        for sign in (1, -1):
            if sign == -1 and j in (0, half):  # its own mirror image
                continue
            wave = np.exp(-1j * np.pi * sign * j * np.arange(half + 1) / half)
            total += (sign if odd else 1) * value[..., None] * wave
    return (1j * total if odd else total).real


@pytest.mark.parametrize("odd", [False, True])
@pytest.mark.parametrize("between", [False, True])
@pytest.mark.parametrize("n, half", [(1, 3), (5, 6), (6, 6), (7, 6), (9, 6), (40, 45)])
@pytest.mark.parametrize("short", [0, 10**4])
def test_forward_is_the_fourier_sum(monkeypatch, odd, between, n, half, short):
    """By fast transforms and by products, along both axes, with fewer and with more values than are taken.

    1e-13: the sums that it is held against turn by up to 40 pi, so a term has 126 roundings, and 40 terms are
    added.
    """
    monkeypatch.setattr(real_transforms, "SHORT", short)
    kept = np.random.default_rng(n).standard_normal((2, n, n))
    if odd and not between:
        kept[:, 0], kept[:, :, 0] = 0, 0  # what an odd row has in its middle
    expected = summed(kept, half, odd, between)
    assert np.abs(forward(kept, half, odd, -1, between=between) - expected).max() <= 1e-13 * max(
        np.abs(expected).max(), 1
    )
    across = np.moveaxis(forward(kept.swapaxes(-1, -2), half, odd, -2, between=between), -2, -1)
    assert np.abs(across - expected).max() <= 1e-13 * max(np.abs(expected).max(), 1)


@pytest.mark.parametrize("odd", [False, True])
@pytest.mark.parametrize("n", [1, 2, 9, 10])
@pytest.mark.parametrize("short", [0, 10**4])
def test_back_is_the_inverse(monkeypatch, odd, n, short):
    """Of a row of n cells from its middle outward, but for what an odd one has in the middle cell.

    Two sums, of the values and of their transforms, neither larger than twice the sum of the moduli.
    """
    monkeypatch.setattr(real_transforms, "SHORT", short)
    half, kept, between = half_length(n) + 3, n - n // 2, n % 2 == 0
    field = np.random.default_rng(6).normal(size=(3, kept, kept))
    for axis in (-1, -2):
        again = back(forward(field, half, odd, axis, between=between), kept, odd, axis, between=between)
        same = np.moveaxis(np.abs(again - field), axis, 0)[1 if odd and not between else 0 :]
        assert not same.size or same.max() <= 2 * (kept + half) * EPS * np.abs(field).sum(axis).max()


def test_spectrum_of_both_directions():
    """Against the two-dimensional sum over lags of both signs."""
    kernel = np.random.default_rng(8).standard_normal((4, 5))
    kernel[0] = 0  # odd in x
    expected = summed(summed(kernel.T, 6, True, False).T, 5, False, False)
    assert np.abs(real_spectrum(kernel, (6, 5), (1, 0)) - expected).max() <= 1e-13 * np.abs(expected).max()
