# SPDX-License-Identifier: MIT
"""Figures of runs, of comparisons and of the verification report, with the numbers behind them.

A function here takes results, or curves and fields in the units of its axes, and returns a `Drawing`: a
matplotlib figure and the columns of its CSV file. `style` holds the one look of all figures and writes them
as PNG, SVG and CSV; `maps` and `profiles` hold what several figures are made of; `run` and `compared` draw
finished run folders; the others are named after the case or the kind of contact that they show. Nothing here
solves or judges.

Used by the command line, for runs and comparisons, and by the cases of the suite. matplotlib is imported by
the modules here only, which whoever draws loads on use.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from verification.runs.study import Study


def solve_figures(run_dir: Path) -> list[Path]:
    """Draw the figures of a finished run into its folder; see `verification.figures.run`."""
    from verification.figures.run import draw_run  # noqa: PLC0415 - loads matplotlib

    return draw_run(Path(run_dir))


def compare_figures(folder: Path, sam: Path, fem: Path) -> list[Path]:
    """Draw two finished runs of one scene together into `folder`; see `verification.figures.compared`."""
    from verification.figures.compared import draw_comparison  # noqa: PLC0415 - loads matplotlib

    return draw_comparison(folder, sam, fem)


def sweep_figure(study: Study, rows: Sequence[Mapping], path: Path) -> None:
    """Draw the table of a sweep as `path`.png and .svg; see `verification.figures.sweep`."""
    from verification.figures.style import save  # noqa: PLC0415 - loads matplotlib
    from verification.figures.sweep import summary  # noqa: PLC0415 - loads matplotlib

    save(summary(study, rows), path, data=False)


__all__ = ["compare_figures", "solve_figures", "sweep_figure"]
