# SPDX-License-Identifier: MIT
"""samfem itself: `solve_contact` for elastic problems, and the whole solve of a scene for the elastic-plastic
step.
"""

from importlib import metadata
from typing import Any

import numpy as np

from verification.peers import problems

YOUNG, RADIUS_M = 210e9, 10e-6  # of the scene: E in Pa, Hertz radius in m; the answer does not depend on them


def load() -> None:
    import sam
    import verification.runs.models  # noqa: F401

    assert sam.solve and sam.solve_contact  # loaded when asked for


def versions() -> dict[str, str]:
    return {name: metadata.version(name) for name in ("samfem", "numpy", "scipy")}


def setup(problem: str, cells: Any, settings: dict):
    if problem == problems.STEP:
        return lambda: _step(*cells, **settings)
    contact = problems.elastic(problem, cells, settings.get("side", problems.SIDE))
    return lambda: _elastic(contact, settings["tolerance"], periodic=settings.get("periodic", False))


def _elastic(contact: problems.Elastic, tolerance: float, *, periodic: bool):
    from sam import PeriodicHalfSpaces, Search, solve_contact

    given = contact.gap, (contact.cell, contact.cell), 1.0, contact.force
    how = {"bodies": PeriodicHalfSpaces()} if periodic else {}
    return lambda: solve_contact(*given, search=Search(tolerance), **how)


def scene_of(
    n: int, layers: int, tolerance: float, side: float = problems.BOX[0], *, depth: float = problems.BOX[1]
):
    """The elastic-plastic step as a scene; side and depth of the grid in Hertz radii, n cells a side."""
    from sam.scene import Body, CounterBody, Grid, Loading, Plasticity, Scene, Solver

    hard = Plasticity(law="linear", yield_stress=problems.YIELD * YOUNG, modulus=problems.HARDENING * YOUNG)
    return Scene(
        title="One step to three times the yield stress",
        body=Body(young=YOUNG, poisson=problems.POISSON, plasticity=hard),
        counterbody=CounterBody(shape="sphere", radius=problems.RADIUS * RADIUS_M),
        loading=Loading(force=problems.STEP_FORCE * YOUNG * RADIUS_M**2, steps=1, unload=False),
        grid=Grid(cells=(n, n), extent=(side * RADIUS_M,) * 2, layers=layers, depth=depth * RADIUS_M),
        solver=Solver(tolerance=tolerance),
    )


def repeated(scene):
    """The scene with its sphere as a summit of the body below a plane, which repeats."""
    from sam.scene import CounterBody, HeightMap, Surface

    (n, _), (side, _), radius = scene.grid.cells, scene.grid.extent, scene.counterbody.radius
    x = ((np.arange(n) + 0.5) / n - 0.5) * side
    surface = Surface(kind="file", path=HeightMap(-np.add.outer(x**2, x**2) / (2 * radius), (side, side)))
    grid = scene.grid.model_copy(update={"cells": None, "extent": None, "periodic": "xy"})
    other = CounterBody(shape="flat")
    return scene.model_copy(update={"counterbody": other, "surface": surface, "grid": grid})


def _step(n: int, layers: int, *, periodic: bool = False, **how):
    from verification.runs import models

    scene = scene_of(n, layers, **how)
    scene = repeated(scene) if periodic else scene
    return lambda: models.solve(scene, models.SAM)


def read(answer) -> tuple[dict, dict[str, np.ndarray]]:
    if hasattr(answer, "pressure"):
        counts = {"iterations": answer.iterations, "converged": bool(answer.converged)}
        return counts, {"pressure": answer.pressure}
    return step_of(answer)


def _column(result, table: str, name: str) -> np.ndarray:
    peak = np.asarray(result.tables[table]["state"]) == "peak"
    return np.asarray(result.tables[table][name], dtype=float)[peak]


def _below_the_apex(result, layers: int) -> np.ndarray:
    """Plastic strain on the axis, from the means over the cells beside it in the plane y = 0; the plane x = 0
    is like it.

    The layers are equal. With an even number of cells the pairs of cells on either side of the axis are taken
    as one.
    """
    from sam.plasticity import at_centres

    plane = _column(result, "plane", "peeq").reshape(-1, layers).T
    together = 2 - plane.shape[1] % 2
    first = (plane.shape[1] - 3 * together) // 2
    cross = np.zeros((layers, 3, 3))
    cross[:, :, 1] = plane[:, first : first + 3 * together].reshape(layers, 3, together).mean(axis=-1)
    cross[:, 1, :] = cross[:, :, 1]
    return at_centres(cross, np.arange(layers + 1.0))[:, 1, 1]


def step_of(result) -> tuple[dict, dict[str, np.ndarray]]:
    """Counts and the profile below the apex of a result of the step, of SAM or FEM."""
    unit = problems.YIELD
    z, peeq = _column(result, "axis", "z_m"), _column(result, "axis", "peeq")
    if "layers" in result.discretisation:  # of SAM: cells hold means, as points of other programs do not
        peeq = _below_the_apex(result, len(z))
    fields = {"z": z / RADIUS_M, "peeq": peeq / unit}
    one_step = not result.cost.get("step_cuts")
    iterations = result.cost.get("plastic_iterations") or result.cost.get("newton_iterations")
    return {"iterations": iterations, "converged": result.converged and one_step}, fields
