# SPDX-License-Identifier: MIT
"""Contact of a punch with a flat end and a rounded edge: it sets units and meshes, never a result."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sam.scene import CounterBody

ROUNDED = "rounded-punch"
HALVINGS = 60
"""Of the range of the angle: to the last digit."""


def radius_under_force(counter: CounterBody, force: float) -> float:
    """Contact radius in m, F/E* = a^3/R [4/3 sin^3 t - cos t (t - sin t cos t)], cos t = b/a."""
    return _radius(counter, lambda a, t: force_at(counter, a, t) < force)


def radius_at_approach(counter: CounterBody, approach: float) -> float:
    """Contact radius in m at an approach a b (tan t - t)/R."""
    flat, radius = _lengths(counter)
    return _radius(counter, lambda a, t: a * flat * (np.tan(t) - t) / radius < approach)


def force_at(counter: CounterBody, a: float, t: float | None = None) -> float:
    """Force in N over E* at a contact radius in m; t: its angle."""
    flat, radius = _lengths(counter)
    angle = np.arccos(min(1.0, flat / a)) if t is None else t
    beyond = angle - np.sin(angle) * np.cos(angle)
    return float(a**3 / radius * (4.0 / 3.0 * np.sin(angle) ** 3 - np.cos(angle) * beyond))


def _lengths(counter: CounterBody) -> tuple[float, float]:
    if counter.flat_radius is None or counter.radius is None:
        raise ValueError(f'counterbody.shape = "{counter.shape}" has no rounded edge')
    return counter.flat_radius, counter.radius


def _radius(counter: CounterBody, smaller: Callable[[float, float], bool]) -> float:
    """The radius b/cos t at which something that grows with it is no longer smaller than wanted."""
    flat, low, high = _lengths(counter)[0], 0.0, 0.5 * np.pi
    for _ in range(HALVINGS):
        t = 0.5 * (low + high)
        low, high = (t, high) if smaller(flat / np.cos(t), t) else (low, t)
    return float(flat / np.cos(low))
