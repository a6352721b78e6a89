# SPDX-License-Identifier: MIT
"""Plane-strain finite-element model of a line contact: a cylinder on a half-space."""

from importlib import import_module
from typing import Any

MODULES = {
    "Model": "fem_reference.plane_strain.model",
    "Step": "fem_reference.common.loading",
    "UnsupportedScene": "fem_reference.common.refusals",
    "check": "fem_reference.plane_strain.planner",
    "left_out": "fem_reference.plane_strain.planner",
    "load_steps": "fem_reference.plane_strain.solution",
    "plan": "fem_reference.plane_strain.planner",
    "solve": "fem_reference.plane_strain.solution",
}
__all__ = list(MODULES)


def __getattr__(name: str) -> Any:
    if name not in MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(MODULES[name]), name)
