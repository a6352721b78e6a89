# SPDX-License-Identifier: MIT
"""The largest von Mises stress between the depths at which it is known, and a large plastic strain."""

from __future__ import annotations

import numpy as np

from sam.arrays import Array, Mask
from sam.results.snapshots import Box, Snapshot
from sam.scene.result import EXCEEDING, STRAINED
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


def exceeded_strain(box: Box) -> float | None:
    """The accumulated plastic strain that a share EXCEEDING of the plastic volume exceeds, see
    `sam.scene.result`; None without any. A cell counts with half of its volume at its own strain.
    """
    peeq = box.peeq.ravel()
    if not peeq.any():
        return None
    volume = np.multiply.outer(np.diff(box.z), np.multiply.outer(np.diff(box.x), np.diff(box.y))).ravel()
    order = np.argsort(-peeq)[: np.count_nonzero(peeq > STRAINED * peeq.max())]
    above = np.cumsum(volume[order])
    return float(np.interp(EXCEEDING * above[-1], above - volume[order] / 2, peeq[order]))


def largest_in(depths: Array, mises: Array, part: Mask) -> tuple[float, float] | None:
    """Depth and height of the largest value at some of the depths, (nz,); None where there are none.

    mises: (nz, n). Refined between these depths only: the stress jumps at the interface of a coating.
    """
    if not part.any():
        return None
    some = mises[part]
    return refined_peak(depths[part], some[:, int(some.max(axis=0).argmax())])
