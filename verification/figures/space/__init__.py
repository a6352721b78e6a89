# SPDX-License-Identifier: MIT
"""Pictures of a run in space: rough and worn surfaces, contact spots, plastic zone, stresses, imprint.

They are drawn by VTK in a child process: where the libraries that it needs without a display are missing or
broken it ends in a segmentation fault, which then ends the child alone. `offscreen` starts the child and is
all that others use; `pictures` says what there is to draw, from the `meshes` of a run, and `view` draws it.
"""

from verification.figures.space.offscreen import CannotDrawError, draw, draw_run

__all__ = ["CannotDrawError", "draw", "draw_run"]
