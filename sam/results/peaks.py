# SPDX-License-Identifier: MIT
"""The largest von Mises stress between the depths at which it is known, and the largest plastic strains."""

from __future__ import annotations

import numpy as np

from sam.arrays import Array, Mask
from sam.results.snapshots import Box, Snapshot
from sam.scene.result import MOST_STRAINED, STRAINED
from sam.scene.yield_curve import Kinks

EVEN = Kinks()
"""Those of a body whose yield stress is the same at all depths, or that does not yield."""


def refined_peak(z: Array, values: Array, kinks: Kinks = EVEN) -> tuple[float, float]:
    """Depth and height of the maximum, refined by a parabola through three neighbours (any spacing).

    kinks: of the yield stress of a body that yields; there the stress has one, and no parabola goes across.
    """
    k = int(values.argmax())
    if k in (0, len(values) - 1) or np.ptp(kinks.interval(z[k - 1 : k + 2])):
        return float(z[k]), float(values[k])
    c2, c1, c0 = np.polyfit(z[k - 1 : k + 2] - z[k], values[k - 1 : k + 2], 2)
    shift = -c1 / (2 * c2) if c2 < 0 else 0.0
    return float(z[k] + shift), float(c0 + c1 * shift + c2 * shift**2)


def largest_mises(z: Array, peak: Snapshot, kinks: Kinks = EVEN) -> tuple[float, float]:
    """Depth and value of the largest von Mises stress, refined by a parabola over depth unless its cell has
    yielded.

    A cell that has is on the yield surface, which a parabola through it and its neighbours would pass; so
    the value is the same whichever way the body is turned. kinks: as of `refined_peak`.
    """
    mises = peak.mises
    k, column = np.unravel_index(mises.argmax(), mises.shape)
    if peak.flowed is not None and peak.flowed[k, column]:
        return float(z[k]), float(mises[k, column])
    return refined_peak(z, mises[:, column], kinks)


def most_strained(box: Box) -> float | None:
    """Mean accumulated plastic strain of the part of the plastic volume that is strained most, see
    `sam.scene.result.MOST_STRAINED`; None without any.
    """
    peeq = box.peeq.ravel()
    if not peeq.any():
        return None
    volume = np.multiply.outer(np.diff(box.z), np.multiply.outer(np.diff(box.x), np.diff(box.y))).ravel()
    order = np.flatnonzero(peeq > STRAINED * peeq.max())
    order = order[np.argsort(-peeq[order])]
    so_far = np.cumsum(volume[order])
    part = np.clip(MOST_STRAINED * so_far[-1] - (so_far - volume[order]), 0.0, volume[order])
    return float(part @ peeq[order] / part.sum())


def largest_in(depths: Array, mises: Array, part: Mask) -> tuple[float, float] | None:
    """Depth and height of the largest value at some of the depths, (nz,); None where there are none.

    mises: (nz, n). Refined between these depths only: the stress jumps at the interface of a coating.
    """
    if not part.any():
        return None
    some = mises[part]
    return refined_peak(depths[part], some[:, int(some.max(axis=0).argmax())])
