# SPDX-License-Identifier: MIT
"""The points of a study of running-in at which most statements hold together: how far they are from the
printed inputs, what they would mean for the body, and whether that is plausible.

They are chosen by their result, so that they are fitted, and each has a surface of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sam.scene import Scene
from verification.cases.case import SmallTable
from verification.cases.running_in.running_in_inputs import INPUTS, Input
from verification.cases.running_in.running_in_statements import BULK, NAMES, STATEMENTS, A, B

PRINTED = {
    "feed": 0.4,
    "shortest": 12e-6,
    "hurst": 0.8,
    "anisotropy": 1.5,
    "B": 1780e6,
    "depth": 1e-6,
    "deviation": 1.0,
    "hardening": 1e6,
    "limit": 0.002,
    "layer-limit": 0.02,
    "growth": 3.644e-9,
    "film-yield": 0.6667e9,
    "high": 0.4,
    "load": 0.6,
    "counter": 0.0,
    "window": 5,
}
"""Of the scenes, SI; of those that the paper does not print, what the scenes assume."""
TABOR = (2.8, 3.0)  # hardness over yield stress at STRAIN: Tabor, The Hardness of Metals (1951)
STRAIN = 0.08
STEEL = (6.8e9, 8.2e9)  # Pa: 697 to 832 HV, 60 to 65 HRC by ASTM E140, of AISI 52100 hardened through
DISCS = (5e-9, 60e-9)  # m rms: polished to ground, as in running-in-physics
POINTS = 3  # that are shown
MATERIALS = (BULK, A, B)
DISTANCE = "distance from the printed inputs, in shares of the ranges (rms)"


@dataclass(frozen=True)
class Points:
    """A study. shares: of the inputs, (points, inputs); counts: statements that hold together, (points,);
    scenes: of each point and material; printed: of each material before any input is put.
    """

    shares: np.ndarray
    counts: np.ndarray
    scenes: Mapping[tuple[int, str], Scene]
    printed: Mapping[str, Scene]

    @property
    def away(self) -> np.ndarray:
        """(points,) from the printed inputs: root mean square of the shares of the ranges."""
        found: np.ndarray = np.sqrt(np.mean((self.shares - printed_shares()) ** 2, axis=1))
        return found

    @property
    def best(self) -> list[int]:
        """The points at which most hold, the nearest to the printed inputs first."""
        most = np.flatnonzero(self.counts == self.counts.max())
        return [int(point) for point in most[np.argsort(self.away[most], kind="stable")]][:POINTS]


def share_of(one: Input, value: float) -> float:
    """The share of the range of an input at which it has a value; of a level the middle of its part."""
    if one.levels:
        return (one.levels.index(int(value)) + 0.5) / len(one.levels)
    ends = (*one.ends, value)
    low, high, at = np.log(ends) if one.logarithmic else ends
    return float((at - low) / (high - low))


def printed_shares() -> np.ndarray:
    """Of all printed inputs, (inputs,)."""
    return np.array([share_of(one, PRINTED[one.name]) for one in INPUTS])


def hardness(scene: Scene) -> tuple[float, float]:
    """Of the material at the surface in Pa, bounds by Tabor."""
    yields = float(scene.body.plasticity.strength().stress(0.0, STRAIN))
    return TABOR[0] * yields, TABOR[1] * yields


def fitted_table(points: Points) -> SmallTable:
    """The points at which most statements hold, beside the printed inputs."""
    best, away, printed = points.best, points.away, printed_shares()
    rows = [
        (one.words, one.shown(float(printed[n])), *(one.shown(float(points.shares[k, n])) for k in best))
        for n, one in enumerate(INPUTS)
    ]
    rows.append((DISTANCE, "0", *(f"{away[k]:.2f}" for k in best)))
    for case in MATERIALS:
        of_points = [hardness(points.scenes[k, case]) for k in best]
        ranges = (_range(each) for each in (hardness(points.printed[case]), *of_points))
        rows.append((f"hardness of the surface, {NAMES[case]} [GPa]", *ranges))
    return SmallTable(
        "Fitted: inputs of the points at which most statements hold together, the nearest to the "
        f"printed ones first. Hardness: {TABOR[0]:g} to {TABOR[1]:g} σ_y at a strain of {STRAIN:.0%} (Tabor)",
        ("input", "printed inputs", *(f"point {k}: {points.counts[k]} hold" for k in best)),
        rows,
    )


def fitted_note(points: Points) -> str:
    """What the nearest of them would mean."""
    point = points.best[0]
    said = (_beside(case, points.scenes[point, case], points.printed[case]) for case in MATERIALS)
    rough = points.scenes[point, BULK].counterbody.surface
    sq = rough.sq if rough else 0.0
    inside = DISCS[0] <= sq <= DISCS[1]
    judged = "as polished to ground discs have" if inside else "smoother than polished to ground discs"
    return (
        f"Fitted: at point {point}, {points.counts[point]} of {len(STATEMENTS)} statements hold together, "
        f"chosen of {len(points.shares)} points by this result, on one surface of its own; it is "
        f"{points.away[point]:.2f} of the ranges away from the printed inputs (two random points are "
        f"{1 / np.sqrt(6):.2f} apart). It would mean a surface hardness, by Tabor, of {'; '.join(said)}; "
        f"AISI 52100 hardened to 60 to 65 HRC has {_range(STEEL)} GPa. The counter-surface has "
        f"{1e9 * sq:.0f} nm rms, {judged} ({1e9 * DISCS[0]:.0f} to {1e9 * DISCS[1]:.0f} nm)."
    )


def _beside(case: str, scene: Scene, printed: Scene) -> str:
    """A hardness beside that of hardened steel and that of the printed inputs."""
    own, before = hardness(scene), hardness(printed)
    if own[0] > STEEL[1]:
        judged = f"{own[0] / STEEL[1]:.2f} times the hardest steel, not plausible"
    elif own[1] < STEEL[0]:
        judged = f"{own[1] / STEEL[0]:.2f} times the softest"
    else:
        judged = "plausible"
    return f"{NAMES[case]} {_range(own)} GPa, {judged} (printed inputs {_range(before)})"


def _range(ends: tuple[float, float]) -> str:
    return f"{1e-9 * ends[0]:.1f} to {1e-9 * ends[1]:.1f}"
