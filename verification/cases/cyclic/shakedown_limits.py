# SPDX-License-Identifier: MIT
"""A Hertz load on a body with Prager's back-stress, on either side of the shakedown limit, in place and
travelling. Cells see means of the stress: a grid has a limit of its own above that of the body, by the same
theorem the smallest ball about the means over each cell.
"""

from functools import cache

import numpy as np

from sam.scene import Path, Plasticity, Result, Scene
from verification.cases.case import with_body, with_loading
from verification.quantities import Reference, of_cycles
from verification.reference.shakedown import cell_limit, in_place_limit, travelling_limit

__all__ = ["limit_of_cells", "share_of_limit"]


def back_stress(scene: Scene, modulus: float) -> Scene:
    """The scene with Prager's back-stress of a modulus in Pa."""
    stress, back = scene.body.plasticity.yield_stress, {"modulus": (modulus,)}
    return with_body(scene, plasticity=Plasticity(law="perfect", yield_stress=stress, kinematic=back))


def path(scene: Scene, way: tuple[float, int]) -> Scene:
    """The load travels along x from -half to half, in contact radii, in so many steps."""
    (half, steps), radius = way, scene.loading.radius
    return with_loading(scene, path=Path(start=(-half * radius, 0.0), end=(half * radius, 0.0), steps=steps))


@cache
def limit(friction: float, nu: float, travels: bool) -> float:
    """p0/k of a body at the shakedown limit, k the shear yield stress."""
    return (travelling_limit if travels else in_place_limit)(friction, nu=nu)[0]


def limit_of(scene: Scene) -> float:
    """That of the body of a scene."""
    return limit(scene.coefficient, scene.body.poisson, scene.loading.path is not None)


def share_of_limit(scene: Scene, share: float) -> Scene:
    """The load at a share of the limit of the body."""
    return with_loading(scene, p0=share * limit_of(scene) * scene.body.plasticity.yield_stress / np.sqrt(3.0))


def limit_of_cells(scene: Scene, result: Result, _: Reference | None) -> float:
    """Relative deviation of the limit of the cells from that of the body."""
    radius, ways = scene.loading.radius, scene.loading.path
    cells = round(radius * scene.grid.cells[0] / scene.grid.extent[0])
    stops = np.linspace(ways.start[0] / radius, ways.end[0] / radius, ways.steps + 1)
    return cell_limit(scene.coefficient, 1 / cells, stops, nu=scene.body.poisson) / limit_of(scene) - 1


def settles(scene: Scene, result: Result, _: Reference | None) -> float:
    """Strain of the last two cycles over that of the first."""
    strains = of_cycles(result, "peeq_step_max")
    return float(strains[-2:].max() / strains[0])


def steady(scene: Scene, result: Result, _: Reference | None) -> float:
    """Strain of the last cycle over that of the one before."""
    *_, before, last = of_cycles(result, "peeq_step_max")
    return float(last / before) if before else 0.0
