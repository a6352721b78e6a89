# SPDX-License-Identifier: MIT
"""The load history of a scene as a list of targets, and pressures that a scene gives instead of a counter-body.

Equal steps to the peak, along the path of a travelling load if there is one, then to zero. In full slip the traction on the
body is q = coefficient * p along x, at every step; its sign may change from cycle to cycle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from sam.contact.normal import Contact, around
from sam.scene import Scene

PARTS = 8  # of a cell each way, for the mean of a given pressure over it


@dataclass(frozen=True)
class Load:
    """force in N; sign: of the traction along x; x, y: centre of a given pressure in m."""

    force: float
    sign: float = 1.0
    x: float = 0.0
    y: float = 0.0

    def halfway_to(self, other: Load) -> Load:
        """The load half the way to another one, with its sign; without force there is no place to come from."""
        x, y = (self.x, self.y) if self.force else (other.x, other.y)
        return Load((self.force + other.force) / 2, other.sign, (x + other.x) / 2, (y + other.y) / 2)


UNLOADED = Load(0.0)


@dataclass(frozen=True)
class Target:
    """The end of a load step. cycle, step: as in the history.

    snapshot: the state to be recorded there ("peak", "unloaded" or none); at_once: unloading in one step, if that
    strains nothing; note: for the history.
    """

    cycle: int
    step: int
    load: Load
    rises: bool
    snapshot: str = ""
    at_once: bool = False
    note: str = ""


def peak_force(scene: Scene) -> float:
    """Largest normal force in N; of a given Hertz pressure 2/3 pi p0 a^2."""
    loading = scene.loading
    return 2 / 3 * pi * loading.p0 * loading.radius**2 if loading.prescribed else loading.force


def sign_of(scene: Scene, cycle: int) -> float:
    """Of the traction along x in a cycle (from 1)."""
    alternating = scene.friction is not None and scene.friction.direction == "alternating"
    return -1.0 if alternating and cycle % 2 == 0 else 1.0


def targets_of(scene: Scene) -> list[Target]:
    """All steps of the scene, unloading in one."""
    return [
        target for cycle in range(1, scene.loading.cycles + 1) for target in targets_of_cycle(scene, cycle)
    ]


def targets_of_cycle(scene: Scene, cycle: int) -> list[Target]:
    """Loading, at the start of the path if there is one, the way along it, and unloading."""
    loading, force, sign = scene.loading, peak_force(scene), sign_of(scene, cycle)
    last = cycle == loading.cycles
    places = path_of(scene)
    up = [Load(force * k / loading.steps, sign, *places[0]) for k in range(1, loading.steps + 1)]
    along = [Load(force, sign, *place) for place in places[1:]]
    targets = [Target(cycle, k, load, True) for k, load in enumerate(up, start=1)]
    for k, load in enumerate(along, start=loading.steps + 1):
        targets.append(Target(cycle, k, load, True, note=f"load at x = {load.x:.6g} m, y = {load.y:.6g} m"))
    if last:
        targets[-1] = replace(targets[-1], snapshot="peak")
    if loading.unload or not last:
        name, zero = "unloaded" if last else "", Load(0.0, sign, *places[-1])
        targets.append(Target(cycle, len(targets) + 1, zero, False, name, at_once=True))
    return targets


def path_of(scene: Scene) -> list[tuple[float, float]]:
    """Places of the load after each step at full size, the start first, (x, y) in m; the origin alone without path."""
    path = scene.loading.path
    if path is None:
        return [(0.0, 0.0)]
    shares = np.arange(path.steps + 1) / path.steps
    return [
        tuple(float(a + share * (b - a)) for a, b in zip(path.start, path.end, strict=True))
        for share in shares
    ]


def off_origin(scene: Scene) -> bool:
    """Whether the contact at the peak may be elsewhere than around the origin: of a rough body, at the end of a path."""
    path = scene.loading.path
    return scene.surface is not None or (path is not None and any(path.end))


def leaves_axis(scene: Scene) -> bool:
    """Whether a load on a smooth body ends beside y = 0; the largest stress is below it."""
    return scene.loading.path is not None and scene.loading.path.end[1] != 0.0


def in_steps(target: Target, scene: Scene) -> list[Target]:
    """Unloading in equal steps, in place of the target that does it at once."""
    count, peak = scene.loading.unload_steps or scene.loading.steps, peak_force(scene)
    forces = [peak * (1 - k / count) if k < count else 0.0 for k in range(1, count + 1)]
    steps = [
        Target(target.cycle, target.step + k, replace(target.load, force=force), False)
        for k, force in enumerate(forces)
    ]
    return [*steps[:-1], replace(steps[-1], snapshot=target.snapshot)]


def given_pressure(
    scene: Scene, load: Load, x: np.ndarray, y: np.ndarray, hx: float, hy: float
) -> np.ndarray:
    """Mean of (force/peak) p0 sqrt(1 - r^2/a^2) over each cell, (nx, ny) in Pa; x, y: centres, hx, hy: cells in m."""
    a, out = scene.loading.radius, np.zeros((x.size, y.size))
    part = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    i, j = (np.flatnonzero(np.abs(c - o) < a + h) for c, o, h in ((x, load.x, hx), (y, load.y, hy)))
    if load.force == 0 or not (i.size and j.size):
        return out
    fine_x, fine_y = (
        ((c[k, None] - o + h * part) / a).ravel() for c, k, o, h in ((x, i, load.x, hx), (y, j, load.y, hy))
    )
    p = np.sqrt(np.maximum(1.0 - fine_x[:, None] ** 2 - fine_y[None, :] ** 2, 0.0))
    p = p.reshape(i.size, PARTS, j.size, PARTS).mean(axis=(1, 3))
    out[np.ix_(i, j)] = scene.loading.p0 * (load.force / peak_force(scene)) * p
    return out


def given_contact(
    scene: Scene, load: Load, pressure: np.ndarray, displacement: np.ndarray, cell_area: float
) -> Contact:
    """The state under a given pressure on the full grid: nothing is opposite, so gap and approach are not numbers.

    pressure in Pa, displacement in m, (nx, ny); load_error: of the means over the cells against the force.
    """
    error = abs(float(pressure.sum()) * cell_area - load.force) / load.force
    nothing = np.full_like(pressure, np.nan)
    area = pi * scene.loading.radius**2
    return Contact(
        pressure, displacement, nothing, np.nan, around(pressure > 0), 0.0, 0.0, 0.0, error, 0, True, area
    )  # fmt: skip
