# SPDX-License-Identifier: MIT
"""The stress record: six components along the last axis, order xx, yy, zz, yz, xz, xy."""

from collections.abc import Callable

import numpy as np


def components(xx, yy, zz, yz=0.0, *, xz=0.0, xy=0.0) -> np.ndarray:
    """Stack six broadcastable components into an array (..., 6), same unit."""
    return np.stack(np.broadcast_arrays(xx, yy, zz, yz, xz, xy), axis=-1)


def von_mises(stress) -> np.ndarray:
    """Von Mises equivalent stress, (..., 6) -> (...), same unit. sqrt(((xx-yy)^2 + (yy-zz)^2 + (zz-xx)^2)/2 +
    3 (yz^2 + xz^2 + xy^2)). ValueError if the last axis is not 6 long.
    """
    stress = np.asarray(stress)
    if stress.shape[-1:] != (6,):
        raise ValueError(f"stress must have a last axis of length 6, not shape {stress.shape}")
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    normal = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
    return np.sqrt(normal + 3.0 * (yz**2 + xz**2 + xy**2))


def largest_mises(stress: Callable, depths: tuple[float, float]) -> tuple[float, float]:
    """Largest von Mises stress of stress(depth), (6,), between two depths of order 1, and its depth."""
    from scipy.optimize import minimize_scalar  # noqa: PLC0415 - a fifth of the time of samfem plan

    close = {"method": "bounded", "options": {"xatol": 1e-9}}
    best = minimize_scalar(lambda at: -float(von_mises(stress(at))), bounds=depths, **close)
    return -float(best.fun), float(best.x)


def deviator(stress) -> np.ndarray:
    """Deviatoric part, (..., 6) -> (..., 6), same unit."""
    found = np.array(stress, dtype=float)
    found[..., :3] -= found[..., :3].mean(axis=-1, keepdims=True)
    return found
