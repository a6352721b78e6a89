# SPDX-License-Identifier: MIT
"""Validators, which return the cleaned value or raise a ValueError that names the argument."""

import math

import numpy as np


def positive(name: str, value: float) -> float:
    """The value as a float, finite and > 0."""
    number = float(value)
    if not (math.isfinite(number) and number > 0):
        raise ValueError(f"{name} = {value!r} must be finite and > 0")
    return number


def finite(name: str, value: float) -> float:
    """The value as a finite float of any sign."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name} = {value!r} must be finite")
    return number


def not_negative(name: str, value: float) -> float:
    """The value as a float, finite and >= 0."""
    if finite(name, value) < 0:
        raise ValueError(f"{name} = {value!r} must be >= 0")
    return float(value)


def poisson(name: str, value: float) -> float:
    """Poisson's ratio as a float, 0 <= nu <= 0.5."""
    number = float(value)
    if not 0.0 <= number <= 0.5:
        raise ValueError(f"{name} = {value!r} must be 0 <= {name} <= 0.5")
    return number


def coordinate(name: str, value) -> np.ndarray:
    """A finite coordinate (scalar or array) as an array of floats."""
    array = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} must be finite everywhere")
    return array


def depth(name: str, value) -> np.ndarray:
    """A depth or a distance: finite and >= 0."""
    array = coordinate(name, value)
    if np.any(array < 0):
        raise ValueError(f"{name} must be >= 0 everywhere, smallest value {array.min()!r}")
    return array


class Checked:
    """A record of numbers > 0; those called nu or poisson are Poisson's ratios."""

    def __post_init__(self):
        for name, value in vars(self).items():
            (poisson if name.startswith(("nu", "poisson")) else positive)(name, value)
