# SPDX-License-Identifier: MIT
"""The onset of yield: the contact at the largest load if the body stayed elastic, and whether its stress
yields anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

from sam.arrays import Array
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.elastic.problem import ElasticProblem
from sam.elastic.stress import plane_stress, stresses_of
from sam.schedule import Load


@dataclass(frozen=True)
class ElasticPeak:
    """The contact at the largest load if the body stayed elastic, and the von Mises stress, (nz, n) in Pa.

    mises: below a smooth body in the plane y = 0, n = nx; below a rough one the largest of the whole grid, n
    = 1. A tribofilm may fail and raise the traction: then with its high coefficient everywhere.
    """

    contact: Contact
    mises: Array


def elastic_peak(problem: ElasticProblem, load: Load) -> ElasticPeak | None:
    """The elastic state under the largest load; None without any."""
    if load.rests:
        return None
    high = problem.slip.highest
    state = problem.state(load, problem.contact(load, high), high)
    if problem.looked.anywhere:
        return ElasticPeak(state.contact, stresses_of(state).mises)
    return ElasticPeak(state.contact, von_mises(plane_stress(state)).max(axis=-1))


def yields(peak: ElasticPeak | None, limit: Array) -> bool:
    """Whether the elastic stress at the peak exceeds the yield stress (nz,) in Pa anywhere. Paper Eq. 8."""
    return peak is not None and bool((peak.mises > limit[:, None]).any())
