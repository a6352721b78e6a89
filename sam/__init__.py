# SPDX-License-Identifier: MIT
"""Semi-analytical contact of half-spaces. `sam.scene` alone loads no kernel and no solver."""

from importlib import import_module

_WHERE = {
    "Search": "sam.contact.normal",
    "UnsupportedScene": "sam.planner.grids",
    "check": "sam.planner.grids",
    "choose_grid": "sam.planner.grids",
    "left_out": "sam.solver",
    "solve": "sam.solver",
    "solve_contact": "sam.contact.normal",
}

__all__ = ["Search", "UnsupportedScene", "check", "choose_grid", "left_out", "solve", "solve_contact"]


def __getattr__(name: str):
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'sam' has no attribute {name!r}")
