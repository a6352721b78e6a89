# SPDX-License-Identifier: MIT
"""How far a value may be from its limit, of three values on grids (or with load steps) of different size.

With the formal order p and the size h_i of the i-th grid, an error C h^p makes f_1 - f_i = C (h_1^p - h_i^p).
Each further value then gives C h_1^p by itself, and the larger of both is taken FACTOR times. The order that
the three values show is reported and never used: where the edge of a contact or of a plastic zone moves
through the cells, it scatters from 0 to above 4. For the same reason three values may agree by chance: what
the edge of a contact leaves on given cells is known, and no uncertainty is less (`of_edge`).
"""

from collections.abc import Sequence
from math import log

FACTOR = 3.0  # that of Roache for an assumed order; case uncertainty measures what it covers
# The same for load steps, whose error falls smoothly: 72 of 72 values of case uncertainty-study are covered,
# and 48 of 48 of two spheres that are not in it (5 to 37 steps), U/error 1.06 to 3.7; 1.5 covers 97 %.
STEP_FACTOR = 2.0
# Of a value, over the square of the cells in the contact radius. Errors of Hertz, sliding and coated spheres
# (14 scenes, 5 to 17 cells in the radius): 0.03 to 0.07 in the median, 0.14 at most, by where the edge falls.
# Of the approach in axisymmetric elements (five spheres beyond yield, 9 to 20 in the radius): 0.12 at most.
EDGE = 0.1
ORDERS = (1e-3, 12.0)  # between which an order is looked for


def bound(values: Sequence[float], sizes: Sequence[float], order: float, factor: float = FACTOR) -> float:
    """Largest distance of the first value from the limit of zero size, in the unit of the values. values,
    sizes: (n,), n >= 2, that of the result first; sizes positive, all different from the first; order: with
    which the error falls, formally. ValueError otherwise.
    """
    if len(values) != len(sizes) or len(values) < 2 or min(sizes) <= 0.0 or sizes[0] in sizes[1:]:
        raise ValueError(f"values and sizes: two or more, sizes positive, other than the first: {sizes}")
    first, size = values[0], sizes[0]
    changes = zip(values[1:], sizes[1:], strict=True)
    return factor * max(abs(first - value) / abs((other / size) ** order - 1.0) for value, other in changes)


def of_edge(value: float, cells: float, share: float = EDGE) -> float:
    """Error of a value as the edge lies between cells; cells: in the contact radius; share: with one cell."""
    return share * abs(value) / cells**2


def order_seen(values: Sequence[float], sizes: Sequence[float]) -> float | None:
    """The order that three values follow, fine to coarse in any order; None where they approach no limit."""
    (f1, f2, f3), (h1, h2, h3) = _fine_to_coarse(values, sizes)
    if f2 == f3 or not 0.0 < (f2 - f1) / (f3 - f2) < 1.0:
        return None
    ratio = log((f3 - f2) / (f2 - f1))

    def excess(p: float) -> float:
        return log((h3**p - h2**p) / (h2**p - h1**p)) - ratio

    if excess(ORDERS[0]) * excess(ORDERS[1]) > 0.0:
        return None
    from scipy.optimize import brentq  # noqa: PLC0415 - 0.2 s, for three members alone

    return float(brentq(excess, *ORDERS))


def converging(values: Sequence[float], sizes: Sequence[float]) -> bool:
    """Whether three values change less from the middle to the finest size than from the coarsest."""
    (f1, f2, f3), _ = _fine_to_coarse(values, sizes)
    return abs(f2 - f1) <= abs(f3 - f2)


def _fine_to_coarse(values: Sequence[float], sizes: Sequence[float]) -> tuple[Sequence, Sequence]:
    pairs = sorted(zip(sizes, values, strict=True))
    return [value for _, value in pairs], [size for size, _ in pairs]
