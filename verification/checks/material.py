# SPDX-License-Identifier: MIT
"""Yield and flow of a body and its film by their laws, on stresses and plastic strains that a solver
returned.

Components in the order 11 22 33 23 13 12, no engineering shear; every value is zero in an exact solution.
"""

from __future__ import annotations

import numpy as np

from sam.scene import Plasticity, Scene


def _through_rows(law: Plasticity, peeq: np.ndarray) -> np.ndarray:
    (strain, stress) = np.array(law.file).T
    slopes = np.diff(stress) / np.diff(strain)
    rises = [
        slope * np.clip(peeq, low, high) for slope, low, high in zip(slopes, strain, strain[1:], strict=False)
    ]
    return stress[0] + sum(rises) - sum(slopes * strain[:-1])


FORMULAS = {
    "swift": lambda law, peeq: law.B * (law.C + law.alpha * peeq) ** law.n,
    "linear": lambda law, peeq: law.yield_stress + law.modulus * peeq,
    "perfect": lambda law, peeq: np.full(peeq.shape, law.yield_stress),
    "table": _through_rows,
}
"""The yield stress in Pa of each law, written once more."""


def yield_stress(scene: Scene, peeq: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Of the scene's laws in Pa at accumulated plastic strains and depths in m."""
    law = scene.body.plasticity
    if law is None:
        return np.full(peeq.shape, np.inf)
    found = FORMULAS[law.law](law, peeq)
    if law.layer is not None:
        found = np.where(z < law.layer_thickness, FORMULAS[law.layer.law](law.layer, peeq), found)
    return law.depth_profile()(z) * found


def back_stress(scene: Scene, strains: np.ndarray | None, z: np.ndarray) -> np.ndarray | float:
    """Sum of the back-stresses 2/3 factor C_k a_k in Pa, of a_k (N, n, ...) at depths in m."""
    law = scene.body.plasticity
    if law is None or strains is None:
        return 0.0
    found, inside = np.zeros_like(strains[0]), np.zeros(z.shape, dtype=bool)
    if law.layer is not None:
        inside = z < law.layer_thickness
    for part, where in ((law, ~inside), (law.layer, inside)):
        moduli = () if part is None or part.kinematic is None else part.kinematic.modulus
        for modulus, strain in zip(moduli, strains, strict=False):
            found[:, where] += 2 / 3 * modulus * strain[:, where]
    return law.depth_profile()(z) * found


def materials(scene: Scene, z: np.ndarray) -> list[tuple[np.ndarray, Scene]]:
    """(where, scene) of the materials at depths z: the body, and its film as a body of its own."""
    body, film = scene.body, scene.body.coating
    if film is None:
        return [(np.ones(z.shape, dtype=bool), scene)]
    law = None if film.yield_stress is None else Plasticity(law="perfect", yield_stress=film.yield_stress)
    alone = body.model_copy(
        update={"young": film.young, "poisson": film.poisson, "plasticity": law, "coating": None}
    )
    return [(z >= film.thickness, scene), (z < film.thickness, scene.model_copy(update={"body": alone}))]


def elastic_stress(scene: Scene, strain: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Hooke's law in Pa of elastic strains (n, ...), three normal ones first, at depths z (...) in m."""
    stress = np.empty_like(strain)
    for where, part in materials(scene, z):
        young, nu, elastic = part.body.young, part.body.poisson, strain[:, where]
        stress[:, where] = young / (1 + nu) * elastic
        stress[:3, where] += young * nu / ((1 + nu) * (1 - 2 * nu)) * elastic[:3].sum(axis=0)
    return stress


def in_plane(stress: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Elastic strains exx, eyy, exy of stresses (6, ...)."""
    xx, yy, zz, _, _, xy = stress
    return np.stack([xx - poisson * (yy + zz), yy - poisson * (xx + zz), (1 + poisson) * xy]) / young


def limit_of(scene: Scene, peeq: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Yield stress in Pa of body and film, infinite where they are elastic."""
    limit = np.empty_like(peeq)
    for where, part in materials(scene, z):
        limit[where] = yield_stress(part, peeq[where], z[where])
    return limit


def flow_of_parts(
    scene: Scene,
    strain: np.ndarray,
    before: np.ndarray,
    now: np.ndarray,
    *,
    stress: np.ndarray,
    z: np.ndarray,
) -> dict[str, float]:
    """The largest of `flow_of` in the film and below it; before, now: peeq, z: in m."""
    found = [
        flow_of(
            part,
            strain[:, where],
            (now - before)[where],
            stress[:, where],
            limit=yield_stress(part, now[where], z[where]),
        )
        for where, part in materials(scene, z)
        if part.body.plasticity is not None
    ]
    return {name: max(each[name] for each in found) for name in found[0]}


def von_mises(s: np.ndarray) -> np.ndarray:
    """Of stresses (6, ...) in the order 11 22 33 23 13 12."""
    a, b, c = s[0] - s[1], s[1] - s[2], s[2] - s[0]
    return np.sqrt(0.5 * (a**2 + b**2 + c**2) + 3.0 * (s[3] ** 2 + s[4] ** 2 + s[5] ** 2))


def flow_of(
    scene: Scene, strain: np.ndarray, length: np.ndarray, stress: np.ndarray, *, limit: np.ndarray
) -> dict[str, float]:
    """Increments of plastic strain (6, ...) and of its length, at the end of a step with the stress
    (6, ...), in Pa. direction: 2 G |d eps - 3/2 dgamma s/q| over the initial yield stress; length:
    |sqrt(2/3 d eps : d eps) - dgamma| likewise; volume: its trace likewise; consistency: |q -
    sigma_y|/sigma_y where a cell strains; backwards: -dgamma likewise; yield: the largest (q -
    sigma_y)/sigma_y.
    """
    unit = (
        scene.body.young / (1 + scene.body.poisson) / float(yield_stress(scene, np.zeros(1), np.zeros(1))[0])
    )
    q = von_mises(stress)
    s = stress.copy()
    s[:3] -= stress[:3].mean(axis=0)
    twice = np.array([1.0, 1, 1, 2, 2, 2]).reshape(6, *[1] * (strain.ndim - 1))
    direction = strain - 1.5 * length * s / q
    straining = length > 1e-3 * length.max()
    return {
        "direction": unit * float(np.sqrt((twice * direction**2).sum(axis=0).max())),
        "length": unit * float(np.abs(np.sqrt(2 / 3 * (twice * strain**2).sum(axis=0)) - length).max()),
        "volume": unit * float(np.abs(strain[:3].sum(axis=0)).max()),
        "consistency": float(np.abs(q / limit - 1.0)[straining].max(initial=0.0)),
        "backwards": unit * max(0.0, -float(length.min())),
        "yield": float((q / limit - 1.0).max()),
    }
