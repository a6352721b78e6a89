# SPDX-License-Identifier: MIT
"""The robustness matrix: a coloured cell for each extreme and model."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.patches import Patch, Rectangle

from verification.figures.style import BLUE, GREEN, GREY, ORANGE, VERMILION, Columns, Drawing, sheet

LOOKS = {
    "right": (GREEN, "r"),
    "ended with a reason": (ORANGE, "e"),
    "input refused": (BLUE, "i"),
    "not for this model": ("#9a9a9a", "m"),
    "not applicable": (GREY, ""),
    "wrong": (VERMILION, "W"),
}
"""What a cell is -> colour and letter, which tell it apart in grey too."""
SIDE_BY_SIDE = 2


def matrix(
    cells: Mapping[str, Mapping[str, str]], models: Mapping[str, str], words: Mapping[str, str]
) -> Drawing:
    """cells: row -> model -> what the cell is; a model that a row does not name stays empty; models, words:
    what stands for each model and each row.
    """
    names, data = list(cells), Columns("row", "model", "cell")
    rows = -(-len(names) // SIDE_BY_SIDE)
    with sheet(8.6, 1.3 + 0.16 * rows, SIDE_BY_SIDE) as (figure, axes):
        for k, axis in enumerate(axes):
            part = names[k * rows : (k + 1) * rows]
            for at, name in enumerate(part):
                for j, model in enumerate(models):
                    if kind := cells[name].get(model):
                        _cell(axis, j, at, kind)
                        data.add(name, model, kind)
            axis.set(xlim=(0, len(models)), ylim=(rows, 0))
            axis.set_yticks(
                [at + 0.5 for at in range(len(part))], [words[name] for name in part], fontsize=6.5
            )
            axis.set_xticks([j + 0.5 for j in range(len(models))], list(models.values()), fontsize=7)
            axis.xaxis.tick_top()
            axis.tick_params(length=0)
            axis.grid(visible=False)
            axis.spines[:].set_visible(False)
        handles = [
            Patch(color=color, label=f"{letter}  {kind}".strip()) for kind, (color, letter) in LOOKS.items()
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return Drawing(figure, data)


def _cell(axis: Axes, column: int, row: int, kind: str) -> None:
    color, letter = LOOKS[kind]
    axis.add_patch(Rectangle((column + 0.04, row + 0.08), 0.92, 0.84, color=color, linewidth=0))
    axis.text(column + 0.5, row + 0.5, letter, ha="center", va="center", color="white", fontsize=6.5)
