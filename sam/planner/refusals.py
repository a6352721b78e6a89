# SPDX-License-Identifier: MIT
"""The valid scenes that the semi-analytical model cannot solve."""

from __future__ import annotations

from math import ceil, inf

import numpy as np

from sam.grid.smooth import MOST_CELLS, MOST_LAYERS, PLASTIC_CELLS, layers_as_thick_as_a_cell
from sam.planner.bodies import hertz_semi_axes, largest_cell, misfit_of, misfit_zone, pair_of
from sam.planner.grids import demand_of
from sam.scene import Scene
from sam.scene.section import stated

ROUNDING = 1e-9  # relative, of a size that is at its bound


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that the model cannot solve; the message names key, value and what is allowed."""


def check(scene: Scene) -> None:
    """Refuse a scene that the model cannot solve.

    Parameters
    ----------
    scene : Scene
        Any valid scene.

    Raises
    ------
    UnsupportedScene
        For a coating where anything yields, as the coefficients of plastic strain hold for a homogeneous
        body; for no force on a shape from which no size of the grid follows; for a plastic scene whose cells
        are so small that layers as thick would be too many; for a rounded edge that the cells do not resolve;
        for a surface of which only the digest is known.
    """
    _check_coating(scene)
    _check_size(scene)
    _check_held(scene)
    _check_cells(scene)
    for surface in (scene.surface, scene.counter_surface):
        if surface is not None and surface.path is not None and surface.path.values is None:
            raise UnsupportedScene(
                f"{surface.table}.path = {surface.path!r}: only its digest is at hand, read the scene file"
            )
    given = scene.grid
    if scene.body.plasticity is None or given is None or given.extent is None or given.depths or given.layers:
        return
    thickness = min(np.divide(given.extent, given.cells or (PLASTIC_CELLS, PLASTIC_CELLS)))
    if scene.loading.misfit_sphere:
        axes = (2 * stated(scene.loading.depth),) * 2
    else:
        axes = hertz_semi_axes(scene)
    layers = layers_as_thick_as_a_cell(axes, thickness)
    if layers > MOST_LAYERS:
        extent = " and ".join(f"{side:g} m" for side in given.extent)
        raise UnsupportedScene(
            f"grid.extent = {extent}: {layers:.3g} layers as thick as a cell, at most {MOST_LAYERS} are "
            f"allowed: raise it, or give grid.layers and grid.depth"
        )


def _check_size(scene: Scene) -> None:
    other = scene.counterbody
    if other is not None and other.radii is None and min(hertz_semi_axes(scene)) == 0.0:
        raise UnsupportedScene(
            f'loading.force = {scene.loading.force} N: with counterbody.shape = "{other.shape}" the '
            f"semi-analytical model allows a force above 0, as nothing else says how large the grid is"
        )


def _check_cells(scene: Scene) -> None:
    """A contact that the cells of a smooth scene do not resolve: too few of them, or too many needed."""
    other, given = scene.counterbody, scene.grid
    if other is None or scene.patch_surface is not None or largest_cell(scene) == inf:
        return
    demand = demand_of(scene, pair_of(scene))
    needs = f"the rounded edge in contact needs cells of at most {demand.largest_cell:.3g} m"
    if given is not None and given.cells:
        cell = max(np.divide(demand.sides((demand.usual,) * 2), given.cells))
        if cell > demand.largest_cell * (1 + ROUNDING):
            least = ceil(max(given.cells) * cell / demand.largest_cell - ROUNDING)
            raise UnsupportedScene(
                f"grid.cells = {list(given.cells)}: {needs}, these have {cell:.3g} m: at least "
                f"{least} x {least} are allowed, fewer with a smaller grid.extent, or leave out [grid]"
            )
    elif demand.usual > MOST_CELLS:
        raise UnsupportedScene(
            f"counterbody.radius = {other.radius} m: {needs}, {demand.usual} x {demand.usual} of them; at "
            f"most {MOST_CELLS} x {MOST_CELLS} are chosen: raise it, give grid.cells, or take "
            f'shape = "punch"'
        )


def _check_held(scene: Scene) -> None:
    """A plastic zone that reaches a held surface would change the tractions that hold it."""
    sphere = misfit_of(scene)
    if sphere is None or sphere.free:
        return
    zone = misfit_zone(scene)
    if zone >= sphere.depth:
        raise UnsupportedScene(
            f'loading.depth = {sphere.depth:g} m: with surface = "held" more than {zone:g} m is allowed, the '
            f"radius of the plastic zone"
        )


def _check_coating(scene: Scene) -> None:
    coating, plasticity = scene.body.coating, scene.body.plasticity
    if coating is None:
        return
    allowed = (
        "the semi-analytical model allows an elastic coating on an elastic body; fem-axisymmetric solves it"
    )
    if plasticity is not None:
        raise UnsupportedScene(
            f'body.coating together with body.plasticity (law = "{plasticity.law}"): {allowed}'
        )
    if coating.yield_stress is not None:
        raise UnsupportedScene(f"body.coating.yield_stress = {coating.yield_stress:g} Pa: {allowed}")
