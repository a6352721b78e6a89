# SPDX-License-Identifier: MIT
"""ContactMechanics (Pastewka and others, github.com/ContactEngineering), by its documented interface.

Its free-standing half-space, a convolution on the doubled domain, and its solver after Polonsky & Keer.
"""

from importlib import metadata

import numpy as np

from verification.peers import problems

MOST = 3000  # iterations


def load() -> None:
    import ContactMechanics  # noqa: F401
    import ContactMechanics.Factory  # noqa: F401
    import SurfaceTopography  # noqa: F401


def versions() -> dict[str, str]:
    names = "ContactMechanics", "SurfaceTopography", "muGrid", "numpy"
    return {name: metadata.version(name) for name in names}


def setup(problem: str, cells: int, settings: dict):
    contact = problems.elastic(problem, cells)
    height = problems.A**2 if problem == problems.HERTZ else problems.RMS  # its tolerance is a length
    return lambda: _elastic(contact, settings["tolerance"] * height)


def _elastic(contact: problems.Elastic, penetration: float):
    from ContactMechanics import FreeFFTElasticHalfSpace
    from ContactMechanics.Factory import make_system
    from SurfaceTopography import Topography

    n, sides = contact.gap.shape, (contact.side, contact.side)
    surface = Topography(-contact.gap, physical_sizes=sides)
    system = make_system(substrate=FreeFFTElasticHalfSpace(n, 1.0, sides), surface=surface)

    def solve():
        found = system.minimize_proxy(external_force=contact.force, pentol=penetration, maxiter=MOST)
        return found, n, contact.cell

    return solve


def read(answer) -> tuple[dict, dict[str, np.ndarray]]:
    found, (nx, ny), cell = answer
    counts = {"iterations": int(found.nit), "converged": bool(found.success)}
    return counts, {"pressure": np.asarray(found.jac)[:nx, :ny] / cell**2}
