# SPDX-License-Identifier: MIT
"""Yield and flow of a body and its film by their laws, on stresses and plastic strains that a solver
returned.

Components in the order 11 22 33 23 13 12, no engineering shear; every value is zero in an exact solution.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from sam.scene import Plasticity, Scene

FORMULAS = {
    "swift": lambda law, peeq: law.B * (law.C + law.alpha * peeq) ** law.n,
    "linear": lambda law, peeq: law.yield_stress + law.modulus * peeq,
    "perfect": lambda law, peeq: np.full(peeq.shape, law.yield_stress),
    "table": lambda law, peeq: np.interp(peeq, *np.transpose(law.file)),
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


def von_mises(s: np.ndarray) -> np.ndarray:
    """Of stresses (6, ...) in the order 11 22 33 23 13 12."""
    a, b, c = s[0] - s[1], s[1] - s[2], s[2] - s[0]
    return np.sqrt(0.5 * (a**2 + b**2 + c**2) + 3.0 * (s[3] ** 2 + s[4] ** 2 + s[5] ** 2))


def flow_of(
    scene: Scene,
    strain: np.ndarray,
    before: np.ndarray,
    now: np.ndarray,
    *,
    stress: np.ndarray,
    z: np.ndarray,
) -> dict[str, float]:
    """The largest of each in body and film: of increments of plastic strain (6, ...), its length before and
    now, and the stress (6, ...) at the end of the step in Pa, at depths z in m. flow: of 2 G over the initial
    yield stress times |d eps - 3/2 dgamma s/q|, |sqrt(2/3 d eps : d eps) - dgamma|, the trace of d eps, and
    -dgamma; consistency: |q - sigma_y|/sigma_y where a cell strains; yield: (q - sigma_y)/sigma_y.
    """
    twice = np.array([1.0, 1, 1, 2, 2, 2])[:, None]
    found: dict[str, list[float]] = {"flow": [], "consistency": [], "yield": []}
    for where, part in materials(scene, z):
        if part.body.plasticity is None:
            continue
        first = yield_stress(part, np.zeros(1), np.zeros(1))[0]
        unit = part.body.young / (1 + part.body.poisson) / float(first)
        change, length, s = strain[:, where], (now - before)[where], stress[:, where]
        excess = von_mises(s) / yield_stress(part, now[where], z[where]) - 1.0
        direction = change - 1.5 * length * (s - np.where(twice == 1, s[:3].mean(axis=0), 0.0)) / von_mises(s)
        rules = (
            np.sqrt((twice * direction**2).sum(axis=0)),
            np.abs(np.sqrt(2 / 3 * (twice * change**2).sum(axis=0)) - length),
            np.abs(change[:3].sum(axis=0)),
            -length,
        )
        straining = length > 1e-3 * length.max()
        found["flow"].append(unit * max(float(each.max()) for each in rules))
        found["consistency"].append(float(np.abs(excess)[straining].max(initial=0.0)))
        found["yield"].append(float(excess.max()))
    return {name: max(values) for name, values in found.items()}


def around(values: np.ndarray, box: Mapping, shape: Sequence[int]) -> np.ndarray:
    """Values (..., nx, ny) of a box in a larger one, zero beside it; shape: (nx, ny) or (nz, nx, ny)."""
    out = np.zeros((*values.shape[: values.ndim - len(shape)], *shape), dtype=values.dtype)
    inside = out[..., box["i0"] : box["i0"] + box["nx"], box["j0"] : box["j0"] + box["ny"]]
    if len(shape) > 2:
        inside = inside[..., : values.shape[-3], :, :]
    inside[...] = values
    return out


def fields_at_points(material: Mapping) -> dict[str, np.ndarray]:
    """The fields of a record at the points of all cells of a box, (..., 4, nz, nx, ny)."""
    cells, out = material["cells"], {}
    for name, values in material["points"].items():
        if values is not None:
            out[name] = np.zeros((*values.shape[:-1], *cells.shape))
            out[name][..., cells] = values
    return out
