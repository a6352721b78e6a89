# SPDX-License-Identifier: MIT
"""Displacements on the outer boundary of a mesh: those of the point forces that balance the contact on the
half-space.
"""

from __future__ import annotations

from importlib import import_module

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.point_force import boussinesq

WORDS = {
    "half-space": "displacements of the point force on the outer boundary",
    "coated half-space": "displacements of the point force on the layered half-space on the outer boundary",
}
"""What a result says of the far field, by kind of body."""
MODULES = {"coated half-space": "fem_reference.common.layered_force"}
"""Modules of the kinds of body that need one beside `point_force`."""


def kind_of(coating: Coating | None) -> str:
    """The kind of body in WORDS and MODULES."""
    return "half-space" if coating is None else "coated half-space"


def normal_far_field(coating: Coating | None, body: Elastic, r: Array, z: Array) -> Array:
    """(u_r, u_z), (2, n), under a unit force along +z at the origin. coating: on the body; r, z: (n,) far
    from the origin.
    """
    u = boussinesq(1.0, body, r, z)
    if coating is None:
        return u
    effect: Array = import_module(MODULES[kind_of(coating)]).normal(coating, body, r, z)
    return u + effect


def coating_effect(coating: Coating, body: Elastic, points: Array, *, sliding: bool) -> Array:
    """(2, 3, n) displacements with the coating minus without it, under unit forces along z and along x at
    the origin.

    points: (3, n); sliding: whether there is a force along x; without it the second ones are zero.
    """
    effect: Array = import_module(MODULES[kind_of(coating)]).slanted_pair(
        coating, body, points, sliding=sliding
    )
    return effect
