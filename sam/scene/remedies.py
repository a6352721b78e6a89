# SPDX-License-Identifier: MIT
"""What a user should change when a solve ends badly: keys that the scene can still change, with the values
that they have; empty words where there is nothing left to change.
"""

from __future__ import annotations

from sam.scene.schema import Scene
from sam.scene.units import BOX, CELLS, COUNT, FRACTION, MESH_CELLS


def either(*remedies: str) -> str:
    """The remedies that apply, as alternatives; empty words do not, and empty if none applies.

    >>> either("raise grid.cells", "", "lower loading.force")
    'raise grid.cells, or lower loading.force'
    """
    return ", or ".join(filter(None, remedies))


def finer_cells(scene: Scene) -> str:
    """More cells of the grid. A measured surface has those of its file, unless it is resampled."""
    given = scene.grid.cells if scene.grid is not None else None
    surface = scene.patch_surface
    if surface is not None and surface.kind == "file" and surface.resample is None:
        cells = list(surface.patch()[0])
        return (
            f'give a finer {surface.table}.path, or {surface.table}.resample = "fourier" '
            f"with grid.cells above {cells}, those of the file"
        )
    if given is None:
        return "raise grid.cells"
    return f"raise grid.cells = {list(given)}" if max(given) < CELLS.high else ""


def smaller_patch(scene: Scene) -> str:
    """Less extent of the grid, for cells that are smaller; of a rough scene another surface."""
    if scene.patch_surface is not None:
        return "" if scene.patch_surface.kind == "file" else "lower grid.extent"
    given = scene.grid is not None and scene.grid.extent is not None
    return "lower grid.extent" if given else "give a smaller grid.extent"


def larger_patch(scene: Scene) -> str:
    """More extent of the grid, or of a measured surface."""
    surface = scene.patch_surface
    if surface is not None and surface.kind == "file":
        if surface.crop is not None:
            return f"raise {surface.table}.crop"
        return f"measure a larger {surface.table}.path"
    return "raise grid.extent"


def less_load(scene: Scene) -> str:
    """The load, by its key."""
    if scene.loading.misfit_sphere:
        return "lower loading.misfit"
    if scene.loading.prescribed:
        return "lower loading.p0"
    return "lower loading.force" if scene.loading.approach is None else "lower loading.approach"


def less_friction(scene: Scene) -> str:
    """The coefficient, by its key; empty without friction."""
    if scene.friction is None or not scene.coefficient:
        return ""
    key = {"constant": "friction.coefficient", "map": "the coefficients in friction.path"}
    return f"lower {key.get(scene.friction.law, 'friction.high')}, {scene.coefficient:g}"


def more_steps(scene: Scene) -> str:
    """More load steps, below the most that there may be."""
    steps = scene.loading.steps
    return f"raise loading.steps = {steps}" if steps < COUNT.high else ""


def looser(scene: Scene) -> str:
    """A larger tolerance, below the largest one."""
    tolerance = scene.solver.tolerance
    return f"raise solver.tolerance = {tolerance:g}" if tolerance < FRACTION.high else ""


def finer_mesh(scene: Scene) -> str:
    """More elements of a smooth scene."""
    count = scene.fem.cells_per_radius
    return f"raise fem.cells_per_radius = {count}" if count < MESH_CELLS.high else ""


def larger_box(scene: Scene) -> str:
    """A larger box of elements, below the largest one."""
    return f"raise fem.box = {scene.fem.box:g}" if scene.fem.box < BOX.high else ""
