# SPDX-License-Identifier: MIT
"""The verification cases. A new one is a module here with `CASES`, its name in `_MODULES`, and rows in gates.toml."""

from __future__ import annotations

from importlib import import_module

from verification.suite.cases.case import LEVELS, Case

_MODULES = (
    *(
        "coefficients",
        "hertz",
        "hertz_ellipse",
        "flat_punch",
        "sliding_sphere",
        "invariances",
        "symmetries",
        "convergence",
    ),
    *("plastic", "plastic_history", "plastic_convergence", "indentation", "paper_loop", "operator_budget"),
    *("spatial", "given_traction", "friction", "cyclic", "energy"),
    *("layered", "coated_sphere", "coated_convergence", "thin_film", "film_map", "film_limits"),
    *("rough_film", "rough_contact"),
    *("film_yield", "coated_traction", "coated_sliding"),
    *("film_law",),
    *("running_in", "running_in_wear"),
    *("work_precision",),
    *("growth",),
    *("model_limits",),
    *("peers",),
    *("stability",),
    *("certificates", "step_cutting", "threads"),
    *("bad_input", "faults", "cluster"),
    *("mutation",),
)


def all_cases() -> dict[str, Case]:
    """Name -> case, in the order of the report."""
    cases = [case for name in _MODULES for case in import_module(f"verification.suite.cases.{name}").CASES]
    return {case.name: case for case in cases}


__all__ = ["LEVELS", "Case", "all_cases"]
