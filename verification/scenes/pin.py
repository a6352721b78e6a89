# SPDX-License-Identifier: MIT
"""The shipped pin: heights as data, and the recipe that made them. `python -m verification.scenes.pin` writes
the data again.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sam.scene import load_scene
from sam.scene.surface import heights

SCENES = Path(__file__).parent
RECIPE, DATA = SCENES / "pin-recipe.toml", SCENES / "pin.csv"
DIGITS = 10  # of a height: 1e-16 m, below what the processor's sines and cosines could change


def pin_heights() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x (nx,), y (ny,) and heights (nx, ny) of the recipe at the centres of its cells, all in m."""
    scene = load_scene(RECIPE)
    x, y = (
        ((np.arange(n) + 0.5) / n - 0.5) * side
        for n, side in zip(scene.grid.cells, scene.grid.extent, strict=True)
    )
    return x, y, heights(scene.surface, x, y, scene.grid.extent)


def pin_table() -> str:
    """The content of DATA: a row a point, y running first."""
    x, y, found = pin_heights()
    rows = [f"{a:.9g},{b:.9g},{found[i, j]:.{DIGITS}g}\n" for i, a in enumerate(x) for j, b in enumerate(y)]
    return "x_m,y_m,height_m\n" + "".join(rows)


if __name__ == "__main__":
    DATA.write_text(pin_table(), encoding="utf-8")
