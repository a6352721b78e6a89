# SPDX-License-Identifier: MIT
"""Semi-analytical contact of half-spaces. `sam.scene` alone loads no kernel and no solver."""

from importlib import import_module

_WHERE = {"solve": "sam.solver", "left_out": "sam.solver", "choose_grid": "sam.grid", "solve_contact": "sam.contact"}

__all__ = ["choose_grid", "left_out", "solve", "solve_contact"]


def __getattr__(name: str):
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'sam' has no attribute {name!r}")
