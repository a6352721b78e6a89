# SPDX-License-Identifier: MIT
"""Whether a contact fits its grid: off the edge, and resolved."""

from __future__ import annotations

from math import pi

from sam.contact.normal import Contact
from sam.scene import Status

# cells in the contact radius; with fewer the largest pressure is off by up to 4 %, from here on by 1 %
FEWEST_CELLS = 3.0
FEWEST_IN_SPOT = round(pi * FEWEST_CELLS**2)


def fit_of(contact: Contact, rough: bool = False) -> Status:
    """CONVERGED, or what is wrong with a contact on the full grid; no contact fits.

    rough: the patch may be cut and single spots may be small, which costs warnings (sam.results.rough); all
    cells in contact together must be as many as resolve one spot.
    """
    if not contact.converged:
        return Status.NOT_CONVERGED
    touching = contact.pressure > 0
    if not touching.any():
        return Status.CONVERGED
    if rough:
        return Status.CONVERGED if touching.sum() >= FEWEST_IN_SPOT else Status.UNDER_RESOLVED
    if touching[[0, -1], :].any() or touching[:, [0, -1]].any():
        return Status.CONTACT_AT_GRID_EDGE
    if min(touching.any(axis=1).sum(), touching.any(axis=0).sum()) < 2 * FEWEST_CELLS:
        return Status.UNDER_RESOLVED
    return Status.CONVERGED
