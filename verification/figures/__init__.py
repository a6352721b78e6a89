# SPDX-License-Identifier: MIT
"""Figures of runs, of comparisons and of the verification report, with the numbers behind them.

A function here takes results, or curves and fields in the units of its axes, and returns a `Drawing`: a
matplotlib figure and the columns of its CSV file. `style` holds the one look of all figures and writes them
as PNG and CSV, or as PDF; `check` says what cannot be read in one; `lines` draws lines over x by series and
panel, `profiles` curves above their errors, `maps` two fields and their difference, `specials` what is of its
own kind; `run` and `compared` draw finished run folders. Nothing here solves or judges.

Used by the command line, for runs and comparisons, and by the cases of the suite. matplotlib is imported by
the modules here only, which whoever draws loads on use.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from verification.compare.rows import Solution
from verification.runs.files import Run, of_last_load
from verification.runs.study import Study

if TYPE_CHECKING:
    from pandas import DataFrame

    from verification.figures.style import Drawing


def solve_figures(run_dir: Path, *, pdf: bool = False) -> list[Path]:
    """Draw the figures of a finished run into its folder, or as PDF; see `verification.figures.run`."""
    from verification.figures.run import draw_run  # noqa: PLC0415 - loads matplotlib

    return draw_run(Path(run_dir), pdf=pdf)


def compare_figures(folder: Path, solutions: Mapping[str, Solution], prefix: str = "") -> list[Path]:
    """Draw results of one scene together into `folder`; see `verification.figures.compared`."""
    from verification.figures.compared import draw_comparison  # noqa: PLC0415 - loads matplotlib

    return draw_comparison(folder, solutions, prefix)


def drawings_of_run(run: Run) -> dict[str, Drawing]:
    """The figures of a run by name, not written; see `verification.figures.run`."""
    from verification.figures.run import drawings_of  # noqa: PLC0415 - loads matplotlib

    return drawings_of(of_last_load(run))


def drawings_of_comparison(solutions: Mapping[str, Solution]) -> dict[str, Drawing]:
    """The figures of results of one scene, not written; see `verification.figures.compared`."""
    from verification.figures.compared import drawings_of  # noqa: PLC0415 - loads matplotlib

    return drawings_of(solutions)


def drawing_of_sweep(frame: DataFrame, study: Mapping[str, Any]) -> Drawing:
    """The figure of a finished sweep, not written. frame, study: its table and what its record says of it."""
    from verification.figures.sweep import summary  # noqa: PLC0415 - loads matplotlib

    rows = frame.astype(object).where(frame.notna(), None).to_dict("records")
    return summary(Study.model_validate(dict(study)), rows)


def sweep_figure(study: Study, rows: Sequence[Mapping], path: Path) -> None:
    """Draw the table of a sweep as `path`.png; see `verification.figures.sweep`."""
    from verification.figures.style import save  # noqa: PLC0415 - loads matplotlib
    from verification.figures.sweep import summary  # noqa: PLC0415 - loads matplotlib

    save(summary(study, rows), path, data=False)


def sensitivity_figure(rows: Sequence[Mapping], path: Path) -> None:
    """Draw the indices of a study as `path`.png, if there are any; see `verification.figures.specials`."""
    from verification.figures.specials import sensitivities  # noqa: PLC0415 - loads matplotlib
    from verification.figures.style import save  # noqa: PLC0415 - loads matplotlib

    if rows:
        save(sensitivities(rows), path, data=False)


__all__ = [
    "compare_figures",
    "drawing_of_sweep",
    "drawings_of_comparison",
    "drawings_of_run",
    "sensitivity_figure",
    "solve_figures",
    "sweep_figure",
]
