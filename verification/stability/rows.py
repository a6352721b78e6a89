# SPDX-License-Identifier: MIT
"""All rows of the stability matrix, and what they must cover."""

from __future__ import annotations

from verification.stability import elastic
from verification.stability.matrix import Row

TOPICS = {
    "poisson": "Poisson's ratio 0, 0.4999 and 0.5",
    "force": "force 0, 1e-15 to 1e6 N",
}
"""Of what there must be rows at level full: name -> in words."""
_SOURCES = (elastic,)


def all_rows(level: str) -> list[Row]:
    """The rows of a level, in the order of the matrix."""
    found = [row for source in _SOURCES for row in source.rows()]
    return found if level == "full" else [row for row in found if row.quick]
