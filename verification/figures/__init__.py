# SPDX-License-Identifier: MIT
"""Figures of runs, comparisons and reports: functions that take results, or curves and fields in the units of
the axes, and return a `Drawing`, a figure of matplotlib and the columns of its CSV file. matplotlib is
imported by the modules here only, which whoever draws loads on use.

`style`: the one look and how figures are written; `check`: what cannot be read in one.
`lines`, `profiles`, `maps`, `specials`: lines over x, curves above their errors, fields, all others.
`run`, `run_maps`, `places`, `repeated`, `running_in`, `space`: of a finished run.
`compared`, `fit`, `sweep`, `work_precision`: of comparisons, fits, sweeps, and error over time.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from verification import need


def _late(module: str, function: str) -> Callable[..., Any]:
    """A function of a module here, which loads matplotlib when it is called; ExtraError without it."""

    def call(*given: Any, **how: Any) -> Any:
        need("a figure")
        return getattr(import_module(f"{__name__}.{module}"), function)(*given, **how)

    return call


compare_figures = _late("compared", "compare_figures")
drawing_of_fit = _late("fit", "drawing_of_fit")
drawing_of_sweep = _late("sweep", "drawing_of_sweep")
drawings_of_comparison: Callable[..., dict[str, Any]] = _late("compared", "drawings_of")
drawings_of_run: Callable[..., dict[str, Any]] = _late("run", "drawings_of")
sensitivity_figure = _late("specials", "sensitivity_figure")
solve_figures = _late("run", "draw_run")
sweep_figure = _late("sweep", "sweep_figure")
