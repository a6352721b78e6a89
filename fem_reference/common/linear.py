# SPDX-License-Identifier: MIT
"""What the linear solves of a load step share, what they cost, and the order in which a plane mesh is
eliminated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fem_reference.common.arrays import Array, Bools, Integers

LEAF = 20
"""Nodes of a part that is divided no further: 30 % faster than minimum degree."""


@dataclass(frozen=True)
class Work:
    """Newton iterations, set-ups of the linear solver, iterations of linear solves."""

    newton: int = 0
    setups: int = 0
    linear: int = 0

    def __add__(self, other: Work) -> Work:
        return Work(self.newton + other.newton, self.setups + other.setups, self.linear + other.linear)


NO_WORK = Work()


@dataclass
class Kept:
    """The inverse of an earlier tangent of the same load step, exact or not, by which later ones are solved
    iteratively.

    target: residual of a linear solve that is as good as none; inverse, active: of the last set-up, and the
    set of its nodes in contact; first: linear iterations of its first solve. Nothing is kept from one load
    step to the next, so that a solve that is resumed is equal to the last digit to one that is not.
    """

    target: float
    inverse: Callable[[Array], Array] | None = None
    active: Bools | None = None
    first: int = 0
    setups: int = 0
    linear: int = 0

    def solve(self, r: Array) -> Array:
        """Return the product of the inverse that is kept with r."""
        if self.inverse is None:
            raise ValueError("no inverse is kept")
        return self.inverse(r)

    def keep(self, inverse: Callable[[Array], Array], active: Bools) -> None:
        """A set-up was made."""
        self.inverse, self.active, self.first, self.setups = inverse, active, 0, self.setups + 1


@dataclass
class Counted:
    """A function that counts its calls."""

    function: Callable[[Array], Array]
    calls: int = field(default=0)

    def __call__(self, x: Array) -> Array:
        """Return the value of the function, and count the call."""
        self.calls += 1
        return self.function(x)


def nested_dissection(columns: int, rows: int) -> Integers:
    """(2 columns + 1, 2 rows + 1) parts, in the order of their elimination, of the nodes of a plane tensor
    mesh.

    Corner and mid nodes in turn. A line of nodes between elements separates the two halves of the longer
    side, and is eliminated after both (George, SIAM J. Numer. Anal. 10 (1973) 345).
    """
    part = np.zeros((2 * columns + 1, 2 * rows + 1), dtype=np.int64)
    count = 0
    pending = [(0, part.shape[0], 0, part.shape[1])]
    while pending:  # separators first, and with the largest numbers
        i, k, j, m = pending.pop()
        if i >= k or j >= m:
            continue
        count -= 1
        wide = k - i >= m - j
        low, high = (i, k) if wide else (j, m)
        middle = 2 * ((low + high) // 4)
        if (k - i) * (m - j) <= LEAF or not low < middle < high - 1:
            part[i:k, j:m] = count
        elif wide:
            part[middle, j:m] = count
            pending += [(i, middle, j, m), (middle + 1, k, j, m)]
        else:
            part[i:k, middle] = count
            pending += [(i, k, j, middle), (i, k, middle + 1, m)]
    return part
