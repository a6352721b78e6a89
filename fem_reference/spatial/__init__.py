# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element model, for friction and contacts that are not axisymmetric. Imports are lazy.

Public as in fem_reference: solve, check, left_out, UnsupportedScene.
"""

from importlib import import_module

_HOME = {
    "UnsupportedScene": "fem_reference.axisymmetric.support",
    "check": "fem_reference.spatial.support",
    "left_out": "fem_reference.spatial.support",
    "solve": "fem_reference.spatial.solution",
}
__all__ = ["UnsupportedScene", "check", "left_out", "solve"]


def __getattr__(name: str):
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)
