# SPDX-License-Identifier: MIT
"""Errors of the frequency response of the coated half-space over the whole range of its arguments."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sam.layered import Layers, Response

if TYPE_CHECKING:
    from verification.reference.layered import ManyDigits

RATIOS = (1e-6, 1e-3, 0.1, 80 / 210, 1.0, 3.0, 1e3, 1e6)
POISSONS = ((0.0, 0.0), (0.3, 0.3), (0.5, 0.5), (0.0, 0.5), (0.5, 0.0), (0.3, 0.5), (0.5, 0.3), (0.25, 0.45))
WAVES = tuple(10.0**n for n in np.arange(-8, 4.1, 0.5))
"""kh, wave number times thickness, from 1e-8 to 1e4."""


def all_points() -> list[tuple[float, float, float, float]]:
    """(kh, E1/E2, nu1, nu2) over the whole range."""
    return [(kh, ratio, *nus) for ratio, nus, kh in product(RATIOS, POISSONS, WAVES)]


def worst_errors(points: Iterable[tuple[float, float, float, float]]) -> dict[str, float]:
    """Worst errors of `sam.layered.response` over points (kh, E1/E2, nu1, nu2); a NaN is the worst.

    c_zz: relative; matrix: relative to the largest of the four components at that kh; film, body: stress
    relative to the larger of the traction and the largest component at that kh and depth; jump: of szz and
    szL at the interface, over the traction, film against body, both from `sam.layered.response`.
    """
    from verification.reference.layered import ManyDigits  # noqa: PLC0415 - loads mpmath, of an extra

    errors = defaultdict(list)
    for kh, ratio, nu1, nu2 in points:
        layers = Layers(ratio, nu1, 1.0, 1.0, nu2)
        answer, ours = ManyDigits(kh, ratio, nu1, nu2), Response(layers, np.array(kh))
        exact = np.array([float(c) for c in answer.surface()])
        errors["c_zz"].append(abs(ours.surface[0] / exact[0] - 1))
        errors["matrix"].append(np.abs(ours.surface - exact).max() / np.abs(exact).max())
        for height in depths(kh):
            errors["film" if height < 1 else "body"].append(stress_error(answer, ours, height))
        below, above = ours.stress(1.0), ours.stress(np.nextafter(1.0, 0.0))
        jump = np.max([*np.abs(below[0] - above[0])[:, [0, 3]].ravel(), abs(below[1] - above[1])[0]])
        errors["jump"].append(jump)
    return {name: float(np.max(each)) for name, each in errors.items()}


def depths(kh: float) -> tuple[float, ...]:
    """Depths over thickness: in the film, at both sides of the interface and a wave length into the body."""
    return 0.0, 0.3, 0.5, 0.9, float(np.nextafter(1.0, 0.0)), 1.0, 1.0 + 0.1 / kh, 1.0 + 1.0 / kh


def stress_error(answer: ManyDigits, ours: Response, height: float) -> float:
    """Largest error of ten stresses at z = height h, each load over its largest one, at least 1."""
    body = height >= 1
    in_plane, antiplane = ours.stress(height)
    s = answer.kh * height
    exact = [np.array([float(v) for v in answer.state(s, load, body)[2:]]) for load in range(2)]
    out = np.array([float(v) for v in answer.antiplane_stress(s, body)])
    pairs = [*zip(in_plane, exact, strict=True), (antiplane, out)]
    return np.max([np.abs(mine - right).max() / max(1.0, np.abs(right).max()) for mine, right in pairs])
