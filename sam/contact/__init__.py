# SPDX-License-Identifier: MIT
"""Elastic contact of half-spaces on a grid of cells: search for the cells in contact, operators, and stresses
below it.

Uses the influence coefficients of `sam.kernels` and `sam.layered`. Used by `sam.plasticity` and the solver.
"""

from sam.contact.convolution import Convolution, Counters, convolution_onto
from sam.contact.normal import Contact, Search, around, solve_contact
from sam.contact.operators import stresses, von_mises

__all__ = [
    "Contact",
    "Convolution",
    "Counters",
    "Search",
    "around",
    "convolution_onto",
    "solve_contact",
    "stresses",
    "von_mises",
]
