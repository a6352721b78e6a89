# SPDX-License-Identifier: MIT
"""Figures of a comparison, from the files of its two runs: the curves of both models in the same axes, at
peak load.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from verification.figures.style import FEM, SAM, Columns, Drawing, save, sheet
from verification.runs.files import FIGURES, Run, read_run
from verification.runs.sampling import peak

MICRO, GIGA = 1e6, 1e-9
WITHIN = 2.0
"""Of the contact radii: what is drawn. Everything, where a run has no contact radius."""
LOOKS = {"SAM": SAM, "FEM": FEM}
PANELS = {
    "line": {
        "pressure [GPa]": ("p_Pa", GIGA),
        "displacement of the body [$\\mu$m]": ("uz_m", MICRO),
        "gap [$\\mu$m]": ("gap_m", MICRO),
    },
    "axis": {
        "$\\sigma_{zz}$ [GPa]": ("szz_Pa", GIGA),
        "$\\sigma_{xx}$ [GPa]": ("sxx_Pa", GIGA),
        "von Mises [GPa]": ("mises_Pa", GIGA),
    },
}
"""Table -> label -> column and factor to its unit."""
PLACES = {"line": "x_m", "axis": "z_m"}


def draw_comparison(folder: Path, sam: Path, fem: Path) -> list[Path]:
    """Write the figures of two runs of one scene into `folder`/figures; returns the paths (PNG, SVG, CSV of
    each).

    sam, fem: folders of the runs. Raises FolderError (a ValueError) where one holds no result.
    """
    drawings = drawings_of(read_run(sam), read_run(fem))
    (folder / FIGURES).mkdir(exist_ok=True)
    return [path for name, drawing in drawings.items() for path in save(drawing, folder / FIGURES / name)]


def drawings_of(sam: Run, fem: Run) -> dict[str, Drawing]:
    """The figures of two runs of one scene by name."""
    runs = {"SAM": sam, "FEM": fem}
    return {table: curves(runs, table) for table in PANELS} | {"history": history(runs)}


def curves(runs: Mapping[str, Run], table: str) -> Drawing:
    """A panel for each quantity of a table over its place in um; with the data in SI units."""
    place = PLACES[table]
    data = Columns("panel", "model", place, "value")
    with sheet(3.45 * len(PANELS[table]), 3.2, len(PANELS[table])) as (figure, axes):
        for panel, (label, (column, factor)) in zip(axes, PANELS[table].items(), strict=True):
            for model, run in runs.items():
                x, y = _shown(run, *peak(run.tables[table], place, column))
                panel.plot(x * MICRO, y * factor, label=model, **LOOKS[model])
                data.add(column, model, x, y)
            panel.set(xlabel=f"${place[0]}$ [$\\mu$m]", ylabel=label)
        axes[0].legend()
    return Drawing(figure, data)


def history(runs: Mapping[str, Run]) -> Drawing:
    """Force over approach, every row of both histories."""
    data = Columns("panel", "model", "approach_m", "value")
    with sheet(4.6, 3.2) as (figure, panel):
        for (model, run), marker in zip(runs.items(), "ox", strict=True):
            approach, force = run.tables["history"]["approach_m"], run.tables["history"]["force_N"]
            look = LOOKS[model] | {"marker": marker, "linestyle": "none", "fillstyle": "none"}
            panel.plot(approach * MICRO, force, label=model, **look)
            data.add("force_N", model, approach, force)
        panel.set(xlabel="approach [$\\mu$m]", ylabel="force [N]")
        panel.legend()
    return Drawing(figure, data)


def _shown(run: Run, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rows within the drawn range, along x."""
    radius = run.quantities["contact_radius_m"]
    order = np.argsort(x, kind="stable")
    kept = order[np.abs(x[order]) <= WITHIN * radius] if radius else order
    return x[kept], y[kept]
