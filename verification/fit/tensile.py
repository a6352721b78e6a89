# SPDX-License-Identifier: MIT
"""From a tensile test to a hardening law: true stress and strain, yield stress and exponent, Swift's
constants, and a table that does not fall.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import isotonic_regression, least_squares

from sam.scene import InputError, read_limited
from verification.fit.measured import FEWEST, LARGEST, read_columns, refused

ELASTIC = (0.15, 0.5)
"""Shares of the stress at a strain of OFFSET between which the elastic line is fitted: above the foot of the
curve, below first plastic strains."""
OFFSET = 2e-3
SOFTEST, STIFFEST = 1e9, 2e12  # Pa; a slope beyond them is in another unit
ALPHA = 1e6  # of Swift's law in a scene: the strain in microstrain


@dataclass(frozen=True)
class Tensile:
    """What a tensile test says, in SI. young: slope of the elastic line; yield_stress: at an offset of 0.2 %,
    engineering; exponent: n of sigma = yield_stress (young strain/yield_stress)^n by least squares beyond
    yield, true and total strain; swift: B, C, n by least squares with alpha = 1e6; peeq, stress: the true
    curve that does not fall, (m,) each, from peeq = 0 to necking.
    """

    young: float
    yield_stress: float
    exponent: float
    swift: tuple[float, float, float]
    peeq: np.ndarray
    stress: np.ndarray


def tensile(
    strain: np.ndarray, stress: np.ndarray, *, rows: int = 60, source: str = "tensile test"
) -> Tensile:
    """The law of a tensile test.

    Parameters
    ----------
    strain, stress
        (n,) engineering strain (1, not %) and stress in Pa, as they were measured: with foot and noise.
    rows
        Of the table, equally spaced in the logarithm of the plastic strain, means between them.
    source
        What the messages name.

    Raises
    ------
    SceneError
        For too few points, a curve without an elastic line, or a unit that cannot be.
    """
    strain, stress = (np.asarray(each, dtype=float) for each in (strain, stress))
    top = int(np.argmax(stress)) + 1  # necking: beyond it the strain is not uniform
    strain, stress = strain[:top], stress[:top]
    if strain.size < FEWEST:
        raise refused(source, "points", str(strain.size), f"at least {FEWEST} before the largest stress")
    if strain.max() > 2.0:
        raise refused(source, "strain", f"up to {strain.max():.3g}", "at most 2: is it in %?")
    about = stress[int(np.argmax(strain > 2.0 * OFFSET))]
    elastic = (stress > ELASTIC[0] * about) & (stress < ELASTIC[1] * about) & (strain < 2.0 * OFFSET)
    if elastic.sum() < FEWEST:
        words = f"at least {FEWEST} between {ELASTIC[0]:g} and {ELASTIC[1]:g} of the stress at {2 * OFFSET:g}"
        raise refused(source, "points of the elastic line", str(int(elastic.sum())), words)
    young, at_zero = np.polyfit(strain[elastic], stress[elastic], 1)
    if not SOFTEST < young < STIFFEST:
        words = f"{SOFTEST:g} to {STIFFEST:g} Pa: is the unit of stress or strain another?"
        raise refused(source, "elastic slope", f"{young:.3g} Pa", words)
    strain = strain + at_zero / young  # the foot: the line passes zero
    below = stress < young * (strain - OFFSET)
    if not below.any():
        raise refused(source, "strain", f"up to {strain.max():.3g}", "beyond yield by 0.2 %")
    limit = float(stress[int(np.argmax(below))])
    total, true = np.log1p(strain), stress * (1.0 + strain)
    plastic = total - true / young
    beyond = plastic > OFFSET / 20.0
    total, true, plastic = total[beyond], true[beyond], plastic[beyond]
    power = least_squares(lambda n: limit * (young * total / limit) ** n[0] - true, [0.1], x_scale=0.1)

    def misfit(x: np.ndarray) -> np.ndarray:
        return np.asarray(np.exp(x[0]) * (np.exp(x[1]) + plastic) ** x[2] - true / limit)

    k, e0, n = least_squares(misfit, [0.7, np.log(0.01), 0.2], bounds=([-5, -14, 0.001], [5, 0, 0.99])).x
    swift = float(np.exp(k) * limit / ALPHA**n), float(ALPHA * np.exp(e0)), float(n)
    edges = np.concatenate([[0.0], np.geomspace(OFFSET / 20.0, plastic.max(), rows)])
    place = np.clip(np.digitize(plastic, edges) - 1, 0, rows - 1)
    means = [(plastic[place == j].mean(), true[place == j].mean()) for j in range(rows) if (place == j).any()]
    peeq, flow = np.array(means).T
    peeq[0] = 0.0
    return Tensile(float(young), limit, float(power.x[0]), swift, peeq, isotonic_regression(flow).x)


def read_tensile(path: str | Path) -> Tensile:
    """The law of the test in a CSV file with columns as strain_percent, stress_MPa. Raises SceneError."""
    try:
        content = read_limited(path, LARGEST)
    except InputError as error:
        raise refused(str(path), "", "", str(error)) from None
    strain, stress = read_columns(content, "tensile", (), str(path))
    return tensile(strain, stress, source=str(path))
