# SPDX-License-Identifier: MIT
"""From a scene to its plan."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from sam.grid.cells import CellGrid, Room
from sam.planner import parts
from sam.planner.bodies import hertz_semi_axes, looked_of, misfit_of, pair_of, remedies_of, shape_of, slip_of
from sam.planner.grids import coarse, demand_of, given_sides, misfit_demand_of, rough_demand_of
from sam.planner.plan import Demand, Plan
from sam.planner.schedules import given_pressure_of, schedule_of
from sam.planner.stages import stages_of
from sam.scene import LeftOut, Scene
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
