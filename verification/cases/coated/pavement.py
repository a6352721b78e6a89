# SPDX-License-Identifier: MIT
"""The stress under a disc on a pavement of two layers."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.special import j1

from sam.kernels import Lags
from sam.layered import LayeredPatches, Layers, Response
from verification.cases.case import Context
from verification.reference.burmister import interface_stress
from verification.reference.layered_axisymmetric import wave_numbers

__all__ = ["pavement"]

DISC_RATIOS = (1.0, 10.0, 100.0, 1000.0)
FOX = {
    0.5: (0.2845, 0.1006, 0.0237, 0.0051),
    1.0: (0.6464, 0.2914, 0.0809, 0.0189),
    2.0: (0.9106, 0.6437, 0.2449, 0.0666),
}
"""Radius over thickness -> pressure on the interface over that on the disc, for DISC_RATIOS; nu = 0.5."""
LAST_DIGIT, DISC_CELLS = 1e-4, 100  # of the table; in the radius of the disc


def disc_by_response(radius: float, ratio: float) -> float:
    """Pressure on the interface below the centre of a disc over that on it: Hankel integral of SAM's
    response, nu = 0.5. -s_zz/p = int_0^inf f(k) radius J1(k radius) dk with f = -s_zz under the wave; the
    thickness is 1.
    """
    k, weight = wave_numbers(1.0, radius, 40.0)
    wave = Response(Layers(ratio, 0.5, 1.0, 1.0, 0.5), k).stress(1.0)[0][0, 0]
    return float(-(weight * wave) @ (radius * j1(k * radius)))


def disc_by_cells(radius: float, ratio: float) -> float:
    """The same by SAM's coefficients: the cells of the disc, on its edge by their share in it."""
    cell, n = radius / DISC_CELLS, DISC_CELLS + 1
    patches = LayeredPatches(Layers(ratio, 0.5, 1.0, 1.0, 0.5))
    coefficients = patches.stress(Lags(n, n, cell, cell), [1.0], load=3, names=["33"])[0, 0]
    times = np.where(np.arange(n) == 0, 1, 2)  # cells at lags of both signs
    return float(-np.sum(coefficients * covered(DISC_CELLS) * times[:, None] * times[None, :]))


def covered(n: int) -> np.ndarray:
    """Share of the unit cells (i, j), 0 <= i, j <= n, in the disc of radius n: (n + 1, n + 1)."""

    def quadrant(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Area of the disc in 0..x, 0..y; odd in both. Below y up to where the circle falls below it, then
        below the circle.
        """
        x, y, sign = np.minimum(np.abs(x), n), np.minimum(np.abs(y), n), np.sign(x) * np.sign(y)
        start = np.minimum(x, np.sqrt(n**2 - y**2))
        return sign * (start * y + segment(x) - segment(start))

    def segment(x: np.ndarray) -> np.ndarray:
        return (x * np.sqrt(n**2 - x**2) + n**2 * np.arcsin(x / n)) / 2.0

    edges = np.arange(n + 2) - 0.5
    return np.diff(np.diff(quadrant(edges[:, None], edges[None, :]), axis=0), axis=1)


def pavement(context: Context) -> Iterator[dict[str, Any]]:
    """Pressure on the interface over that on the disc: of the table, by quadrature, and twice by SAM."""
    for radius, published in FOX.items():
        for ratio, table in zip(DISC_RATIOS, published, strict=True):
            own, wave, cells = (
                way(radius, ratio) for way in (interface_stress, disc_by_response, disc_by_cells)
            )
            row = {"a_over_h": radius, "E1_over_E2": ratio, "table": table, "quadrature": own}
            row |= {"fox": abs(own - table) / LAST_DIGIT, "response": abs(wave - own)}
            row["cells"] = abs(cells - own)
            if ratio == 1.0:
                row["bare"] = abs(own / (1.0 - (1.0 + radius**2) ** -1.5) - 1.0)
            yield row
