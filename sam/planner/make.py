# SPDX-License-Identifier: MIT
"""From a scene to its plan.

The valid scenes that the semi-analytical model cannot solve.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import ceil, inf

import numpy as np

from sam.grid.cells import CellGrid, Room
from sam.grid.smooth import MOST_CELLS, MOST_LAYERS, PLASTIC_CELLS, layers_as_thick_as_a_cell
from sam.planner import parts
from sam.planner.bodies import (
    coarse,
    demand_of,
    given_pressure_of,
    given_sides,
    hertz_semi_axes,
    largest_cell,
    looked_of,
    misfit_demand_of,
    misfit_of,
    misfit_zone,
    pair_of,
    remedies_of,
    rough_demand_of,
    schedule_of,
    shape_of,
    slip_of,
)
from sam.planner.plan import Demand, Plan
from sam.planner.stages import stages_of
from sam.scene import LeftOut, Scene
from sam.scene.section import stated
from sam.scene.verdict import counts_dissipation, judging_of


def plan(scene: Scene) -> Plan:
    """Plan the solve of a scene: what runs, on which grid, through which load steps, and what is left out and
    why.

    Parameters
    ----------
    scene : Scene
        A scene that `check` allows.

    Returns
    -------
    Plan
        All that the solution needs. The solver executes it.

    Raises
    ------
    ValueError
        For a map of friction that is of another grid.
    """
    pair, schedule, remedies = pair_of(scene), schedule_of(scene), remedies_of(scene)
    misfit, axes = misfit_of(scene), hertz_semi_axes(scene)
    coating, plasticity = scene.body.coating, scene.body.plasticity
    demand: Demand
    rough, track = None, parts.track(scene, axes) if scene.moves else None
    if scene.patch_surface is None:
        demand = demand_of(scene, pair) if misfit is None else misfit_demand_of(scene, misfit)
    else:
        patch = parts.rough_patch(scene)
        demand = rough_demand_of(scene, patch)
        rough = parts.rough_record(patch, remedies)
    grid, friction, wear = demand.grid(Room()), scene.friction, scene.wear
    layer = None if plasticity is None else plasticity.layer_thickness
    has_back = plasticity is not None and plasticity.back_stresses > 0
    made = Plan(
        grid=grid,
        pair=pair,
        shape=shape_of(scene),
        axes=axes,
        schedule=schedule,
        slip=slip_of(scene, pair, grid),
        looked=looked_of(scene, schedule),
        solver=scene.solver,
        remedies=remedies,
        given_sides=given_sides(scene),
        demand=demand,
        given=given_pressure_of(scene),
        misfit=misfit,
        track=track,
        coated=None if coating is None else parts.coated_pair(coating, pair),
        rough=rough,
        plasticity=plasticity,
        with_back=parts.material_with_back_stresses if has_back else None,
        judging=judging_of(scene),
        dissipates=counts_dissipation(scene),
        tribofilm=partial(parts.tribofilm, friction, track) if friction and friction.film else None,
        wear=partial(parts.wear, wear, layer) if wear and wear.removes else None,
        paper=parts.paper_problem if scene.solver.method == "paper" else None,
        coarser=plan(coarse(scene, grid)) if scene.solver.extrapolate else None,
    )
    return replace(made, stages=stages_of(scene, made))


def left_out(scene: Scene) -> list[LeftOut]:
    """The stages that a scene does not need, as its plan has them.

    Parameters
    ----------
    scene : Scene
        A scene that `check` allows.

    Returns
    -------
    list of LeftOut
        The name of each stage, and why it is left out.
    """
    return plan(scene).left_out


def choose_grid(scene: Scene) -> CellGrid:
    """The grid of a scene, as its plan has it.

    Parameters
    ----------
    scene : Scene
        A scene that `check` allows.

    Returns
    -------
    CellGrid
        Cells and depths in m: those of [grid], and what it leaves out chosen from the contact and the plastic
        zone that are to be expected.
    """
    return plan(scene).grid


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
