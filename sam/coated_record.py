# SPDX-License-Identifier: MIT
"""Scalar results of a coated scene: stresses in the film and below it, and what the film changes."""

from __future__ import annotations

import numpy as np

from sam.coating import Coated


def largest_in(depths: np.ndarray, mises: np.ndarray, part: np.ndarray) -> tuple[float, float] | None:
    """Depth and height of the largest value at some of the depths, (nz,) booleans; None where there are none.

    mises: (nz, n). Refined between these depths only: the stress jumps at the interface.
    """
    from sam.record import refined_peak

    if not part.any():
        return None
    some = mises[part]
    return refined_peak(depths[part], some[:, int(some.max(axis=0).argmax())])


def coated_quantities(
    depths: np.ndarray, mises: np.ndarray, p_max: float, coated: Coated
) -> dict[str, float | None]:
    """The names of QUANTITIES that only a coated scene has, and the largest stress anywhere.

    mises: von Mises stress of (nz, n) points in Pa; p_max in Pa. What the depths or the grid do not hold is None.
    """
    below, bare = depths >= coated.thickness, coated.comparison
    in_film, in_body = largest_in(depths, mises, ~below), largest_in(depths, mises, below)
    depth, largest = max((found for found in (in_film, in_body) if found), key=lambda found: found[1])
    values = {
        "mises_max_Pa": largest,
        "mises_max_depth_m": depth,
        "mises_max_film_Pa": in_film and in_film[1],
        "mises_max_substrate_Pa": in_body and in_body[1],
    }
    if bare is None or bare.mises is None:
        return values
    bare_in_body = largest_in(depths, bare.mises, below)
    values |= {"p_max_bare_Pa": bare.p_max, "p_max_change": p_max / bare.p_max - 1}
    if bare_in_body:
        values |= {
            "mises_max_bare_Pa": bare_in_body[1],
            "mises_max_change": in_body[1] / bare_in_body[1] - 1,
        }
    return values
