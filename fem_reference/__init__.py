# SPDX-License-Identifier: MIT
"""Axisymmetric finite-element reference for the contact scenes; shares no physics with `sam`.

`plan` says what `solve` will do. A module is loaded when a name of it is asked for, so that to plan a
scene, or to ask what is left out of it, loads neither scikit-fem nor scipy.
"""

from importlib import import_module
from typing import Any

MODULES = {
    "AxisymmetricSolid": "fem_reference.common.quadrilaterals",
    "Elastic": "fem_reference.common.bodies",
    "Equilibrium": "fem_reference.common.contact",
    "Model": "fem_reference.axisymmetric.model",
    "Step": "fem_reference.common.loading",
    "UnsupportedScene": "fem_reference.common.refusals",
    "check": "fem_reference.axisymmetric.planner",
    "left_out": "fem_reference.axisymmetric.planner",
    "load_steps": "fem_reference.axisymmetric.solution",
    "plan": "fem_reference.axisymmetric.planner",
    "plastic_radius": "fem_reference.common.hertz",
    "solve": "fem_reference.axisymmetric.solution",
}
__all__ = list(MODULES)


def __getattr__(name: str) -> Any:
    if name not in MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(MODULES[name]), name)
