# SPDX-License-Identifier: MIT
"""Figures of a comparison: the curves of both models, and of data of the user, at peak load."""

from collections.abc import Mapping
from itertools import cycle
from pathlib import Path

import numpy as np

from verification.compare.rows import Solution
from verification.figures import lines
from verification.figures.lines import Curve
from verification.figures.style import BLACK, FEM, GREEN, ORANGE, PURPLE, SAM, Columns, Drawing, marked, save
from verification.runs.files import FIGURES
from verification.runs.sampling import peak
from verification.runs.tables import contact_size

MICRO, GIGA = 1e6, 1e-9
WITHIN = 2.0
"""Of the contact radii: what is drawn. Everything, where a run has no contact radius."""
LOOKS = {"SAM": SAM, "FEM": FEM}
PANELS = {
    "line": {
        "pressure [GPa]": ("p_Pa", GIGA),
        lines.INTO: ("uz_m", MICRO),
        "gap [$\\mu$m]": ("gap_m", MICRO),
    },
    "axis": {
        "$\\sigma_{zz}$ [GPa]": ("szz_Pa", GIGA),
        "$\\sigma_{xx}$ [GPa]": ("sxx_Pa", GIGA),
        "von Mises [GPa]": ("mises_Pa", GIGA),
    },
}
"""Table -> label -> column and factor to its unit."""


def compare_figures(folder: Path, solutions: Mapping[str, Solution], prefix: str = "") -> list[Path]:
    """Write the figures of one scene into `folder`/figures; the paths. prefix: of the names of the files."""
    place = folder / FIGURES
    place.mkdir(parents=True, exist_ok=True)
    drawings = drawings_of(solutions)
    return [path for name, each in drawings.items() for path in save(each, place / f"{prefix}{name}")]


def drawings_of(solutions: Mapping[str, Solution]) -> dict[str, Drawing]:
    """The figures of results of one scene by name."""
    drawings = {table: curves(solutions, table) for table in PANELS} | {"history": history(solutions)}
    return marked(drawings, *solutions.values())


def curves(runs: Mapping[str, Solution], table: str) -> Drawing:
    """A panel for each quantity of a table over its place in um as far as SAM's contact; data in SI units."""
    place = {"line": "x_m", "axis": "z_m"}[table]
    radius = next((size for run in runs.values() if (size := contact_size(run.quantities))), 0.0)
    data, panels = Columns("panel", "model", place, "value"), dict[str, dict[str, Curve]]()
    for label, (column, factor) in PANELS[table].items():
        panels[label] = {}
        for model, run in runs.items():
            if column not in run.tables.get(table, ()):
                continue
            x, y = peak(run.tables[table], place, column)
            order = np.argsort(x, kind="stable")
            shown = order[np.abs(x[order]) <= WITHIN * radius] if radius else order
            panels[label][model] = Curve(x[shown] * MICRO, y[shown] * factor)
            data.add(column, model, x[shown], y[shown])
    how = {"looks": _looks(runs), "size": (3.45, 3.2)}
    return Drawing(lines.curves(panels, f"${place[0]}$ [$\\mu$m]", None, **how).figure, data)


def _looks(runs: Mapping[str, Solution]) -> dict[str, dict]:
    """How each is drawn: the models as everywhere, data in further colours."""
    own = (name for name in runs if name not in LOOKS)
    dotted = ({"linestyle": ":", "linewidth": 2.0, "color": c} for c in cycle((GREEN, PURPLE, ORANGE, BLACK)))
    return LOOKS | dict(zip(own, dotted, strict=False))


def history(runs: Mapping[str, Solution]) -> Drawing:
    """Force over approach, every row of the histories that have both."""
    data, drawn, looks = Columns("panel", "model", "approach_m", "value"), {}, _looks(runs)
    for (model, run), marker in zip(runs.items(), cycle("oxs^v"), strict=False):
        table = run.tables.get("history", {})
        if {"approach_m", "force_N"} <= set(table):
            approach, force = (np.asarray(table[name], dtype=float) for name in ("approach_m", "force_N"))
            look = looks[model] | {"marker": marker, "linestyle": "none", "fillstyle": "none"}
            drawn[model] = Curve(approach * MICRO, force, look=look)
            data.add("force_N", model, approach, force)
    panel = {"force [N]": drawn}
    return Drawing(lines.curves(panel, "approach [$\\mu$m]", None, size=(4.6, 3.2)).figure, data)
