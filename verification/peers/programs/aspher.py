# SPDX-License-Identifier: MIT
"""aspher (Yastrebov, github.com/cofebem/aspher), by its documented interface: nested grids of its own, free
space.

settings: tolerance, and what else `solve_nested` takes (backend, single_precision, active_set).
"""

from importlib import metadata

import numpy as np

from verification.peers import problems

COARSEST = {problems.HERTZ: 32, problems.ROUGH: 64}  # cells a side of its coarsest grid, or up to twice that


def load() -> None:
    import aspher  # noqa: F401


def versions() -> dict[str, str]:
    return {name: metadata.version(name) for name in ("aspher", "numpy")}


def coarsest(n: int, least: int) -> int:
    """The smallest size of at least `least` from which doubling leads to n."""
    while n % 2 == 0 and n // 2 >= least:
        n //= 2
    return n


def setup(problem: str, cells: int, settings: dict):
    contact = problems.elastic(problem, cells)
    size = coarsest(cells, COARSEST[problem])
    how = {name: value for name, value in settings.items() if name != "tolerance"}
    return lambda: _elastic(contact, size, settings["tolerance"], how)


def _elastic(contact: problems.Elastic, size: int, tolerance: float, how: dict):
    import aspher

    n = contact.gap.shape[0]
    gap = np.ascontiguousarray(contact.gap.ravel())

    def solve():
        found = aspher.solve_nested(
            grid_size=n,
            gap=gap,
            p_nominal=contact.force / contact.side**2,
            domain_size=contact.side,
            E_star=1.0,
            coarsest=size,
            tol=tolerance,
            **how,
        )
        return found, n

    return solve


def read(answer) -> tuple[dict, dict[str, np.ndarray]]:
    found, n = answer
    counts = {"iterations": int(found.iterations), "converged": found.status == "converged"}
    return counts, {"pressure": np.asarray(found.pressure, dtype=float).reshape(n, n)}
