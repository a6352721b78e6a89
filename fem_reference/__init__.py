# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element reference for the contact scenes; shares no physics with `sam`.

Imports are lazy, so that asking what a scene leaves out loads neither scikit-fem nor scipy.
"""

from importlib import import_module

_HOME = {
    "UnsupportedScene": "fem_reference.axisymmetric.support",
    "check": "fem_reference.axisymmetric.support",
    "left_out": "fem_reference.axisymmetric.support",
    "solve": "fem_reference.axisymmetric.solution",
}
__all__ = ["UnsupportedScene", "check", "left_out", "solve"]


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
