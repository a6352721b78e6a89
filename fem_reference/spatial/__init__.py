# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element model, for friction and contacts that are not axisymmetric; public as
`fem_reference`.
"""

from importlib import import_module
from typing import Any

MODULES = {
    "Equilibrium": "fem_reference.common.contact",
    "Model": "fem_reference.spatial.model",
    "Step": "fem_reference.common.loading",
    "UnsupportedScene": "fem_reference.common.refusals",
    "WornCycle": "fem_reference.spatial.worn",
    "check": "fem_reference.spatial.planner",
    "left_out": "fem_reference.spatial.planner",
    "load_steps": "fem_reference.spatial.solution",
    "plan": "fem_reference.spatial.planner",
    "solve": "fem_reference.spatial.solution",
    "worn_cycles": "fem_reference.spatial.worn",
}
__all__ = list(MODULES)


def __getattr__(name: str) -> Any:
    if name not in MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(MODULES[name]), name)
