# SPDX-License-Identifier: MIT
"""The response of the coated half-space against a solution in many digits, and the stress under a disc on a
pavement.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.special import j1

from sam.kernels import STRESS, Lags, displacement_coefficients, stress_coefficients
from sam.layered import LayeredPatches, Layers, Response, normal_compliance
from verification.cases.case import Context
from verification.reference.burmister import interface_stress
from verification.reference.layered_axisymmetric import CoatedHalfSpace, wave_numbers, wave_pressure_ratio
from verification.reference.layered_errors import POISSONS, RATIOS, WAVES, all_points, worst_errors

__all__ = ["pavement", "response"]

FEW = 16
"""Of the points of the whole range, every such is looked at at the quick level; it shares no factor with
their 25 kh.
"""
FILM, STEEL, THICKNESS = (80e9, 0.3), (210e9, 0.3), 100e-9
"""(E in Pa, nu) of film and body and the thickness in m: Bosman & Schipper (2011), Table 1."""
WAVELENGTHS = (1e-6, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6)
SHORT_WAVE, DEPTHS_OF_A_WAVE = 1e4, (0.0, 0.5, 1.0, 2.0)
CELLS_OVER_THICKNESS, EQUAL_DEPTHS, LAGS = (0.1, 1.0, 10.0), (0.0, 0.3, 0.9, 1.0, 1.7, 6.0), 9

DISC_RATIOS = (1.0, 10.0, 100.0, 1000.0)
FOX = {
    0.5: (0.2845, 0.1006, 0.0237, 0.0051),
    1.0: (0.6464, 0.2914, 0.0809, 0.0189),
    2.0: (0.9106, 0.6437, 0.2449, 0.0666),
}
"""Radius over thickness -> pressure on the interface below the centre over that on the disc, for DISC_RATIOS;
nu = 0.5.
"""
LAST_DIGIT, DISC_CELLS = 1e-4, 100  # of the table; in the radius of the disc


def error_of_equal_materials() -> tuple[float, float]:
    """Largest error of the coefficients of displacement and stress, over the largest one at that depth, if
    film = body.

    Against the closed forms of the bare half-space, for cells smaller and larger than the thickness, both
    loads.
    """
    shifts, stresses = [], []
    for nu in (0.0, 0.3, 0.5):
        film = LayeredPatches(Layers(2.0, nu, 1.0, 2.0, nu))
        for cell in CELLS_OVER_THICKNESS:
            for load in (1, 3):
                size = LAGS, LAGS, cell, cell
                largest = displacement_coefficients(Lags(*size), nu, component=load, load=load).max()
                for i in (1, 2, 3):
                    right = displacement_coefficients(Lags(*size), nu, component=i, load=load)
                    found = film.layers.shear * film.displacement(Lags(*size), component=i, load=load)
                    shifts.append(np.abs(found - right).max() / largest)
                right = stress_coefficients(Lags(*size), np.array(EQUAL_DEPTHS), nu, load=load)
                error = np.abs(film.stress(Lags(*size), EQUAL_DEPTHS, load=load, names=STRESS) - right)
                stresses.append((error.max(axis=(0, 2, 3)) / np.abs(right).max(axis=(0, 2, 3))).max())
    return float(max(shifts)), float(max(stresses))


def short_waves() -> tuple[int, float]:
    """At kh = 1e4, all moduli: how many components are no finite number, and the largest distance of c_zz
    from the film's own.
    """
    unfinished, off = 0, 0.0
    for ratio in RATIOS:
        for nu1, nu2 in POISSONS:
            wave = Response(Layers(ratio, nu1, 1.0, 1.0, nu2), np.array(SHORT_WAVE))
            values = [wave.surface, *(part for z in DEPTHS_OF_A_WAVE for part in wave.stress(z))]
            unfinished += sum(int(np.size(v) - np.isfinite(v).sum()) for v in values)
            off = max(off, abs(wave.surface[0] / (1.0 - nu1) - 1.0))
    return unfinished, float(off)


def wave_ratios(counter: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressure that flattens a sinusoid of the paper's body over that without film, by SAM's c_zz and in many
    equations.

    counter: E/(1 - nu^2) of the counter-body in Pa, infinite if rigid; both (WAVELENGTHS,).
    """
    k = 2.0 * math.pi / np.array(WAVELENGTHS)
    film, body = Layers(*FILM, THICKNESS, *STEEL), Layers(*STEEL, THICKNESS, *STEEL)
    of_counter = 2.0 / (counter * k)
    ours = (normal_compliance(body, k) + of_counter) / (normal_compliance(film, k) + of_counter)
    return ours, wave_pressure_ratio(CoatedHalfSpace(*FILM, THICKNESS, *STEEL), WAVELENGTHS, counter)


def response(context: Context) -> Iterator[dict[str, Any]]:
    """The worst errors at each kh over moduli, Poisson's ratios and depths: compliances relative, the matrix
    to its largest component, stresses and jump to the larger of traction and largest component; and the
    limits of equal materials and short waves, and waves pressed flat.
    """
    points = all_points()[:: 1 if context.level == "full" else FEW]
    for number, kh in enumerate(sorted({point[0] for point in points}), start=1):
        worst = worst_errors([point for point in points if point[0] == kh])
        errors = {name.replace("_", "-"): error for name, error in worst.items()}
        yield {"sweep": "waves", "kh": kh} | errors
        context.progress(f"{context.case}: wave numbers", number, len(WAVES))
    (shift, stress), (unfinished, off) = error_of_equal_materials(), short_waves()
    counters = math.inf, STEEL[0] / (1.0 - STEEL[1] ** 2)
    flattened = max(np.abs(np.divide(*wave_ratios(each)) - 1.0).max() for each in counters)
    row = {"equal-displacement": shift, "equal-stress": stress, "short-wave": off, "flattened": flattened}
    yield {"sweep": "limits"} | row | {"unfinished": unfinished, "unfinished expected": 0}


def disc_by_response(radius: float, ratio: float) -> float:
    """Pressure on the interface below the centre of a disc over that on it: Hankel integral of SAM's
    response, nu = 0.5.

    -s_zz/p = int_0^inf f(k) radius J1(k radius) dk with f = -s_zz under the wave; the thickness is 1.
    """
    k, weight = wave_numbers(1.0, radius, 40.0)
    wave = Response(Layers(ratio, 0.5, 1.0, 1.0, 0.5), k).stress(1.0)[0][0, 0]
    return float(-(weight * wave) @ (radius * j1(k * radius)))


def disc_by_cells(radius: float, ratio: float) -> float:
    """The same by SAM's coefficients: the disc of cells, those on its edge loaded by the share that it
    covers.
    """
    cell, n = radius / DISC_CELLS, DISC_CELLS + 1
    patches = LayeredPatches(Layers(ratio, 0.5, 1.0, 1.0, 0.5))
    coefficients = patches.stress(Lags(n, n, cell, cell), [1.0], load=3, names=["33"])[0, 0]
    times = np.where(np.arange(n) == 0, 1, 2)  # cells at lags of both signs
    return float(-np.sum(coefficients * covered(DISC_CELLS) * times[:, None] * times[None, :]))


def covered(n: int) -> np.ndarray:
    """Share of the cells (i, j), 0 <= i, j <= n, unit squares around their numbers, in the disc of radius n:
    (n + 1, n + 1).
    """

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
    """Pressure on the interface over that on the disc: of the table, by a quadrature of its own and in two
    ways by SAM.
    """
    for radius, published in FOX.items():
        for ratio, table in zip(DISC_RATIOS, published, strict=True):
            own, wave, cells = (
                way(radius, ratio) for way in (interface_stress, disc_by_response, disc_by_cells)
            )
            row = {"a_over_h": radius, "E1_over_E2": ratio, "table": table, "quadrature": own}
            row |= {
                "fox": abs(own - table) / LAST_DIGIT,
                "response": abs(wave - own),
                "cells": abs(cells - own),
            }
            if ratio == 1.0:
                row["bare"] = abs(own / (1.0 - (1.0 + radius**2) ** -1.5) - 1.0)
            yield row
