# SPDX-License-Identifier: MIT
"""Figures of runs and of the verification report. matplotlib is imported by the modules here only, on use."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from verification.runs.study import Study


def solve_figures(run_dir: Path) -> list[Path]:
    """Draw the figures of a finished run into its folder; see `verification.figures.run`."""
    from verification.figures.run import draw_run

    return draw_run(Path(run_dir))


def compare_figures(folder: Path, sam: Path, fem: Path) -> list[Path]:
    """Draw two finished runs of one scene together into `folder`; see `verification.figures.compared`."""
    from verification.figures.compared import draw_comparison

    return draw_comparison(folder, sam, fem)


def sweep_figure(study: Study, rows: Sequence[Mapping], path: Path) -> None:
    """Draw the table of a sweep as `path`.png and .svg; see `verification.figures.sweep`."""
    from verification.figures.style import save
    from verification.figures.sweep import summary

    save(summary(study, rows), path, data=False)


__all__ = ["compare_figures", "solve_figures", "sweep_figure"]
