# SPDX-License-Identifier: MIT
"""Axisymmetric contact with a rigid sphere of true geometry, at choice at finite strain: what the models of a
scene leave out. A study of their limits, which no scene asks for, on the mesh of the axisymmetric model.
"""

from fem_reference.finite_strain.model import KINDS, Curve, build, curve_of, load_to

__all__ = ["KINDS", "Curve", "build", "curve_of", "load_to"]
