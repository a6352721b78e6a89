# SPDX-License-Identifier: MIT
"""The robustness matrix: a coloured cell for each extreme and model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.patches import Patch, Rectangle

from verification.figures.style import BLUE, GREEN, VERMILION, Columns, Drawing, sheet

LOOKS = {
    "right": (GREEN, "r"),
    "error": (BLUE, "e"),
    "not applicable": ("#dddddd", ""),
    "wrong": (VERMILION, "W"),
}
"""What a cell is -> colour and letter, which tell it apart in grey too."""
ROWS_IN_COLUMN = 40


def matrix(cells: Mapping[str, Mapping[str, str]], models: Sequence[str]) -> Drawing:
    """cells: row -> model -> what the cell is; a model that a row does not name stays empty."""
    names = list(cells)
    parts = [names[first : first + ROWS_IN_COLUMN] for first in range(0, len(names), ROWS_IN_COLUMN)]
    data = Columns("row", "model", "cell")
    with sheet(max(3.4 * len(parts), 5.0), 1.3 + 0.17 * min(len(names), ROWS_IN_COLUMN), len(parts)) as (
        figure,
        axes,
    ):
        for axis, part in zip(axes, parts, strict=True):
            axis.grid(visible=False)
            for k, name in enumerate(part):
                for j, model in enumerate(models):
                    kind = cells[name].get(model)
                    if kind is None:
                        continue
                    color, letter = LOOKS[kind]
                    axis.add_patch(Rectangle((j + 0.04, k + 0.08), 0.92, 0.84, color=color, linewidth=0))
                    axis.text(j + 0.5, k + 0.5, letter, ha="center", va="center", color="white", fontsize=6.5)
                    data.add(name, model, kind)
            axis.set(xlim=(0, len(models)), ylim=(min(len(names), ROWS_IN_COLUMN), 0))
            axis.set_yticks([k + 0.5 for k in range(len(part))], part, fontsize=6.5)
            axis.set_xticks([j + 0.5 for j in range(len(models))], models, fontsize=7)
            axis.xaxis.tick_top()
            axis.tick_params(length=0)
            axis.spines[:].set_visible(False)
        handles = [
            Patch(color=color, label=f"{letter}  {kind}".strip()) for kind, (color, letter) in LOOKS.items()
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return Drawing(figure, data)
