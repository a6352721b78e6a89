# SPDX-License-Identifier: MIT
"""DC-FFT against the direct sum over source cells, which is its definition."""

import numpy as np
import pytest

from sam.contact.convolution import Convolution, Counters
from sam.grid.cells import Window
from sam.kernels.patches import STRESS, Lags, parity, stress_coefficients


def direct_sum(kernel, signs, field, source, observed):
    """Sum over source cells of K[observed - source] f, cell by cell."""
    out = np.zeros(observed.shape)
    for i in range(observed.nx):
        for j in range(observed.ny):
            for k in range(source.nx):
                for m in range(source.ny):
                    lx, ly = observed.i0 + i - source.i0 - k, observed.j0 + j - source.j0 - m
                    sign = (signs[0] if lx < 0 else 1) * (signs[1] if ly < 0 else 1)
                    out[i, j] += sign * kernel[abs(lx), abs(ly)] * field[k, m]
    return out


WINDOWS = {
    "same window": (Window(0, 0, 9, 7), Window(0, 0, 9, 7)),
    "box seen from the whole grid": (Window(3, 2, 4, 5), Window(0, 0, 11, 9)),
    "one row": (Window(2, 1, 5, 6), Window(0, 4, 12, 1)),
    "apart": (Window(0, 0, 3, 2), Window(10, 7, 2, 4)),
    "one cell": (Window(5, 5, 1, 1), Window(5, 5, 1, 1)),
}


@pytest.mark.parametrize("name", WINDOWS)
def test_equals_the_direct_sum(name):
    """Rounding only: 1e-12 of the largest value, for kernels of every parity."""
    source, observed = WINDOWS[name]
    field = np.random.default_rng(3).standard_normal(source.shape)
    lags = Convolution.lags_needed(source, observed)
    for load in (1, 2, 3):
        kernels = stress_coefficients(Lags(*lags, 1.0, 0.7), 0.4, 0.3, load=load)[:, 0]
        signs = [parity(component, load) for component in STRESS]
        fast = Convolution(kernels, signs, source, observed)(field)
        for k in range(6):
            slow = direct_sum(kernels[k], signs[k], field, source, observed)
            assert np.abs(fast[k] - slow).max() <= 1e-12 * np.abs(kernels).max() * np.abs(field).sum()


def test_transforms_are_counted():
    counters = Counters()
    window = Window(0, 0, 5, 5)
    convolution = Convolution(np.ones((3, 5, 5)), [(1, 1)] * 3, window, window, counters=counters)
    assert counters.ffts == 3
    convolution(np.ones((5, 5)))
    assert counters.ffts == 3 + 1 + 3
