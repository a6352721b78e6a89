# SPDX-License-Identifier: MIT
"""Semi-analytical contact of half-spaces. `sam.scene` alone loads no kernel and no solver."""

from importlib import import_module
from typing import Any

_WHERE = {
    "Load": "sam.schedule",
    "PeriodicHalfSpaces": "sam.contact.operators",
    "Plan": "sam.elastic.problem",
    "Search": "sam.contact.normal",
    "UnsupportedScene": "sam.planner.make",
    "check": "sam.planner.make",
    "choose_grid": "sam.planner.make",
    "expected_force": "sam.planner.bodies",
    "hertz_semi_axes": "sam.planner.bodies",
    "left_out": "sam.planner.make",
    "misfit_zone": "sam.planner.bodies",
    "model_of": "sam.plasticity.model",
    "plan": "sam.planner.make",
    "solve": "sam.solver",
    "solve_contact": "sam.contact.normal",
}

__all__ = list(_WHERE)


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'sam' has no attribute {name!r}")
