# SPDX-License-Identifier: MIT
"""Figures of runs and of the verification report. matplotlib is imported by the modules here only, on use."""

from __future__ import annotations

from pathlib import Path


def solve_figures(run_dir: Path) -> list[Path]:
    """Draw the figures of a finished run into its folder; see `verification.figures.run`."""
    from verification.figures.run import draw_run

    return draw_run(Path(run_dir))


def compare_figures(folder: Path, sam: Path, fem: Path) -> list[Path]:
    """Draw two finished runs of one scene together into `folder`; see `verification.figures.compared`."""
    from verification.figures.compared import draw_comparison

    return draw_comparison(folder, sam, fem)


__all__ = ["compare_figures", "solve_figures"]
