# SPDX-License-Identifier: MIT
"""The verification cases, by what they are about, in the order of the report.

A case is a small class in a module here: a subclass of `Case` that says what is solved, what is measured of
it and what is shown, and a tuple `CASES` of its instances with name, title, question and equations. The
harness, `case`, calls its parts, leads the ids of its gates by its name and saves its figures. Modules
without `CASES` hold what a large case needs: its scenes, its tables, its words. A new case is a module, its
name in `_MODULES`, and a block for each of its gates in the file of its family; CONTRIBUTING shows one.

Used by the harness of the suite, by the lists of the command line and by tests.
"""

from __future__ import annotations

from importlib import import_module

from verification.suite.cases.case import LEVELS, Case

_MODULES = (
    *(
        "coefficients",
        "hertz",
        "hertz_ellipse",
        "flat_punch",
        "rounded_punch",
        "sliding_sphere",
        "invariances",
        "symmetries",
        "convergence",
    ),
    *(
        "plastic",
        "plastic_layer",
        "misfit_sphere",
        "plastic_history",
        "plastic_convergence",
        "indentation",
        "displacement_control",
        "published",
        "paper_loop",
        "operator_budget",
    ),
    *(
        "spatial",
        "given_traction",
        "friction",
        "cyclic",
        "repeated_loading",
        "misfit_cycles",
        "shakedown_limits",
        "repeated_sliding",
        "energy",
    ),
    *("moving_sphere", "moving_passes", "moving_steps", "moving_spatial", "moving_passes_spatial"),
    *("layered", "coated_sphere", "coated_convergence", "thin_film", "film_map", "film_limits"),
    *("rough_film", "rough_contact"),
    *("film_yield", "coated_traction", "coated_sliding"),
    *("film_law",),
    *(
        "running_in",
        "running_in_cells",
        "running_in_converged",
        "running_in_fem",
        "running_in_kinematic",
        "running_in_physics",
        "running_in_sensitivity",
        "running_in_way",
        "running_in_wear",
    ),
    *("work_precision", "uncertainty", "accuracy"),
    *("growth",),
    *("model_limits",),
    *("peers",),
    *("stability",),
    *("certificates", "worn_certificates", "step_cutting", "threads"),
    *("bad_input", "faults", "cluster"),
    *("mutation",),
)


def all_cases() -> dict[str, Case]:
    """Name -> case, in the order of the report."""
    cases = [case for name in _MODULES for case in import_module(f"verification.suite.cases.{name}").CASES]
    return {case.name: case for case in cases}


def module_of(case: str) -> str:
    """The module that makes a case, empty for one that is not among them."""
    names = (f"{__name__}.{name}" for name in _MODULES)
    return next((name for name in names if any(each.name == case for each in import_module(name).CASES)), "")


__all__ = ["LEVELS", "Case", "all_cases", "module_of"]
