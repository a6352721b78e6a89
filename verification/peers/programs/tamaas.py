# SPDX-License-Identifier: MIT
"""Tamaas (Frérot, Anciaux, Rey, Pham-Ba & Molinari, J. Open Source Softw. 5 (2020) 2121), by its documented
interface.

Elastic contact: its solver after Polonsky & Keer with the non-periodic operator "dcfft", or its own where a
job is periodic. Elastic-plastic: its volume integral method, periodic in x and y; `hardening` is d sigma_y /
d peeq (measured: (mises - sigma_y)/peeq of its result is that number).
"""

from importlib import metadata
from typing import Any

import numpy as np

from verification.peers import problems

MOST = 3000  # iterations of the contact


def load() -> None:
    import tamaas
    import tamaas.nonlinear_solvers  # noqa: F401

    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(1)


def versions() -> dict[str, str]:
    return {name: metadata.version(name) for name in ("tamaas", "numpy")}


def setup(problem: str, cells: Any, settings: dict):
    if problem == problems.STEP:
        return lambda: _step(*cells, **settings)
    contact = problems.elastic(problem, cells)
    return lambda: _elastic(contact, **settings)


def _elastic(contact: problems.Elastic, tolerance: float, *, periodic: bool = False):
    import tamaas

    kind = tamaas.PolonskyKeerRey.pressure
    sides, cells = [contact.side] * 2, list(contact.gap.shape)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, sides, cells)
    model.E, model.nu = 1.0, 0.0
    solver = tamaas.PolonskyKeerRey(model, -contact.gap, tolerance, kind, kind)
    if not periodic:
        tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver.setIntegralOperator("dcfft")
    solver.max_iter = MOST

    def solve():
        error = solver.solve(contact.force / contact.side**2)
        return {"converged": bool(error <= tolerance)}, {"pressure": np.array(model.traction)}

    return solve


def _step(n: int, layers: int, tolerance: float, contact_tolerance: float, *, relaxation: float):
    import tamaas
    from tamaas.nonlinear_solvers import DFSANECXXSolver

    side, depth = problems.BOX
    x = problems.step_centres(n)
    surface = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * problems.RADIUS)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.volume_2d, [depth, side, side], [layers, n, n])
    model.E, model.nu = 1.0, problems.POISSON
    law = {"sigma_y": problems.YIELD, "hardening": problems.HARDENING}
    material = tamaas.materials.IsotropicHardening(model, **law)
    plastic = DFSANECXXSolver(tamaas.Residual(model, material))
    plastic.tolerance = tolerance
    contact = tamaas.PolonskyKeerRey(model, surface, contact_tolerance)
    contact.max_iter = MOST
    coupled = tamaas.EPICSolver(contact, plastic, tolerance, relaxation)
    keep = (material, plastic, contact)  # the coupled solver holds no references of its own

    def solve():
        error = coupled.solve(problems.STEP_FORCE / side**2)
        peeq = np.array(model["cumulated_plastic_strain"])[:, n // 2, n // 2] / problems.YIELD
        counts = {"converged": bool(error <= tolerance), "parts": len(keep)}
        return counts, {"z": np.linspace(0.0, depth, layers), "peeq": peeq}

    return solve


def read(answer) -> tuple[dict, dict[str, np.ndarray]]:
    return answer
