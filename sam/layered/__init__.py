# SPDX-License-Identifier: MIT
"""Elastic coating bonded on an elastic half-space: frequency response and influence coefficients."""

from sam.layered.patches import LayeredPatches, Layers, Response, normal_compliance

__all__ = [
    "LayeredPatches",
    "Layers",
    "Response",
    "normal_compliance",
]
