# SPDX-License-Identifier: MIT
"""What others fitted to their finite elements, for the contacts of published.toml."""

from collections.abc import Callable
from math import sqrt

import numpy as np
from scipy.optimize import brentq

from sam.scene import Result, Scene
from verification.cases.case import DataFrame, with_grid, with_keys, with_loading
from verification.cases.recipes import initial_yield
from verification.judging import Measured
from verification.quantities import Reference
from verification.reference.hamilton import largest_von_mises
from verification.reference.hertz import CircularContact
from verification.reference.indentation import Ghaednia, JacksonGreen, KogutEtsion, onset, residual_share
from verification.references import modulus_of

__all__ = ["area_jackson", "area_kogut", "load_jackson", "load_kogut", "sixty_depths", "w_of_steps", "w_star"]

LARGEST = 20.0  # w*: beyond it the two correlations part, 14 % at 110
RESOLVED = 0.35  # contact radius over that at the largest load from which a point counts


def jackson_green(scene: Scene) -> tuple[JacksonGreen, CircularContact]:
    """The fit for a scene, and the contact at first yield in it."""
    modulus, stress = modulus_of(scene), initial_yield(scene)
    fit = JacksonGreen(scene.body.poisson, stress / modulus)
    return fit, onset(fit.factor, scene.counterbody.radius, modulus, stress)


def w_star(scene: Scene, w: float) -> Scene:
    """Under the force of Jackson & Green at w*, the approach over that at first yield."""
    fit, first = jackson_green(scene)
    return with_loading(scene, force=first.force * float(fit.load(w)))


def share(scene: Scene, result: Result, reference: Reference | None) -> Measured:
    """Displacement that stays, over the largest approach."""
    approach = float(result.quantities["approach_m"])
    stays = float(result.quantities["residual_uz_center_m"]) / approach
    return Measured(stays, float(residual_share(approach / jackson_green(scene)[1].approach)))


def tangent(scene: Scene, tangent: float) -> Scene:
    """With the total tangent that a fit gives over Young's modulus."""
    slope = tangent * scene.body.young / (1.0 - tangent)
    return with_keys(scene, "body.plasticity", modulus=slope)


def ghaednia_of(scene: Scene) -> Ghaednia:
    """The fit for a scene; it holds for the body that yields."""
    body, slope = scene.body, scene.body.plasticity.modulus
    stress, share_ = initial_yield(scene), slope / (body.young + slope)
    return Ghaednia(modulus_of(scene), body.young, body.poisson, stress, share_)


def ghaednia_depth(scene: Scene, depth: float) -> Scene:
    """Under the force of Ghaednia et al. at an approach over the radius."""
    fit = ghaednia_of(scene)
    return with_loading(scene, force=float(fit.load(depth)) * fit.modulus * scene.counterbody.radius**2)


def ghaednia(scene: Scene) -> Reference:
    """Approach and contact radius of the fit under the force of the scene."""
    fit, radius = ghaednia_of(scene), scene.counterbody.radius
    force = scene.loading.force / (fit.modulus * radius**2)
    depth = brentq(lambda d: float(fit.load(d)) - force, 1e-3, 2e-2, xtol=1e-18, rtol=1e-15)
    area_radius = float(fit.area_radius(depth)) * radius
    return Reference({"approach": depth * radius, "radius": area_radius}, {"a": area_radius})


def sixty_depths(scene: Scene, step: float) -> Scene:
    """Sixty output depths, so many m apart, none at the surface."""
    return with_grid(scene, depths=tuple(float(k * step) for k in range(1, 61)))


def yields_at(scene: Scene, result: Result, reference: Reference | None) -> Measured:
    """Pressure p0/k at first yield below the surface, k the yield stress in shear."""
    ratio = float(result.quantities["p_max_Pa"]) / float(result.quantities["mises_max_Pa"])
    exact = largest_von_mises(1.0, 1.0, scene.body.poisson, scene.coefficient)[0][0]
    return Measured(sqrt(3.0) * ratio, sqrt(3.0) / exact)


def points(scene: Scene, result: Result) -> dict[str, np.ndarray]:
    """w*, P* and A* of the load steps whose contact is resolved and whose w* is within the fits."""
    first, history = jackson_green(scene)[1], result.tables["history"]
    units = {"approach_m": first.approach, "force_N": first.force, "contact_area_m2": first.area}
    w, load, area = (np.asarray(history[name], dtype=float) / unit for name, unit in units.items())
    use = (np.sqrt(area / area.max()) >= RESOLVED) & (w <= 1.05 * LARGEST)
    return {"w": w[use], "load": load[use], "area": area[use]}


def fits(scene: Scene) -> dict[str, JacksonGreen | KogutEtsion]:
    """The correlations of load and area over the approach."""
    return {
        "Jackson & Green 2005": jackson_green(scene)[0],
        "Kogut & Etsion 2002": KogutEtsion(scene.body.poisson),
    }


def _beside(what: str, name: str) -> Callable[[Scene, Result, Reference | None], Measured]:
    def of(scene: Scene, result: Result, reference: Reference | None) -> Measured:
        at = points(scene, result)
        return Measured(at[what], getattr(fits(scene)[name], what)(at["w"]))

    of.__doc__ = f"{what.capitalize()} over that at first yield, beside {name}."
    return of


load_jackson, area_jackson = (_beside(what, "Jackson & Green 2005") for what in ("load", "area"))
load_kogut, area_kogut = (_beside(what, "Kogut & Etsion 2002") for what in ("load", "area"))


def w_of_steps(scene: Scene, result: Result, reference: Reference | None) -> np.ndarray:
    """Approach over that at first yield."""
    return points(scene, result)["w"]


def farthest(rows: DataFrame, column: str) -> float:
    """The largest distance from a fit at all load steps of a run."""
    ((found, fit),) = rows[[column, f"{column} expected"]].to_numpy()
    return float(np.max(np.abs(found / fit - 1.0)))
