# SPDX-License-Identifier: MIT
"""Axisymmetric contact with a rigid sphere at finite strain and true geometry: what the models of a scene
leave out.

A study of their limits, which no scene asks for: the scene's sphere, body and load are solved on the mesh
of `fem_reference.axisymmetric.solution`, with deformed positions and normals of the sphere, and at choice
with finite strain.
"""

from fem_reference.finite_strain.model import KINDS, Curve, build, curve_of, load_to

__all__ = ["KINDS", "Curve", "build", "curve_of", "load_to"]
