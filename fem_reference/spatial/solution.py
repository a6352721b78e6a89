# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element solution of a scene: a rigid counter-body on a smooth or rough body, or
given tractions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module

import numpy as np

from fem_reference.common import solution
from fem_reference.common.contact import Equilibrium
from fem_reference.common.far_field import WORDS, kind_of
from fem_reference.common.loading import Step
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import stacked
from fem_reference.spatial import recovery, tables
from fem_reference.spatial.model import Model
from fem_reference.spatial.planner import SpatialPlan, plan
from fem_reference.spatial.recovery import Stresses
from sam.scene.checkpoint import Checkpoint, Keep
from sam.scene.result import Progress, Result, Table
from sam.scene.schema import Scene

TRACK = "fem_reference.spatial.track"
"""Where the track of a counter-body is measured that moves."""
MODULES = {"smooth": "fem_reference.spatial.model", "rough": "fem_reference.spatial.rough"}
"""Where the model of each kind of body is built; a smooth one does without the other."""


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
) -> Result:
    """Solve a smooth or rough scene with or without friction by finite elements in three dimensions.

    Parameters
    ----------
    scene : Scene
        A rigid counter-body on a smooth or rough body, or given tractions of Hertz.
    progress, checkpoint, start : optional
        As of `fem_reference.solve`.

    Returns
    -------
    Result
        In SI units; its status says whether it may be used. ``p_max_Pa`` is the largest nodal pressure:
        the multiplier of a surface node over the area that belongs to it.

    Raises
    ------
    UnsupportedScene
        For what this model cannot represent, see `check`.
    ValueError
        For a `start` of another model.
    """
    return solution.solve(METHOD, scene, progress=progress, checkpoint=checkpoint, start=start)


def load_steps(scene: Scene, record: Checkpoint | None = None) -> tuple[Model, list[Step]]:
    """Return the model of a scene and its load steps, for a-posteriori checks of every state.

    Parameters
    ----------
    scene : Scene
        As of `solve`.
    record : Checkpoint, optional
        Of the last step of a solve; without it the steps are taken again, those of the coated contact alone.

    Returns
    -------
    model : Model
        Mesh, body, friction and units.
    steps : list of Step
        In their order, up to the first that did not converge; of a record of a counter-body that moves those
        inside a pass without displacements and strains.

    Raises
    ------
    UnsupportedScene
        For what this model cannot represent, see `check`.
    """
    return solution.load_steps(METHOD, scene, record)


def build(plan: SpatialPlan) -> Model:
    """The model of a plan, smooth or rough."""
    model: Model = import_module(MODULES[plan.kind]).build(plan)
    return model


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    unit, area = model.scales, model.contact_area(peak)
    centre = tables.at_origin(model.nodal_pressure(peak), model) * unit.pressure
    found = {
        "force_N": model.plan.force * model.share(peak),
        "contact_area_m2": area,
        "contact_radius_m": float(np.sqrt(area / np.pi)),
        "p_center_Pa": centre if model.plan.kind == "smooth" else None,
        "pressure_centroid_x_m": model.centroid(peak) * unit.length,
    }
    if model.plan.sliding.coefficient > 0.0:
        found["tangential_displacement_center_m"] = _centre(model, peak, 0)
    return found


def _residual_quantities(model: Model, left: Equilibrium, s: Stresses) -> Quantities:
    """Quantities of the surface after unloading."""
    found: Quantities = {"residual_uz_center_m": _centre(model, left, 2)}
    if model.plan.sliding.coefficient > 0.0:
        found["residual_ux_center_m"] = _centre(model, left, 0)
        found["plastic_shear_center_m"] = float(np.interp(0.0, s.x, tables.plastic_shear(model, s)))
    return found


def _centre(model: Model, state: Equilibrium, component: int) -> float:
    """Displacement in m of the surface in the origin."""
    dofs = model.body.basis.nodal_dofs[component, model.surface]
    return tables.at_origin(state.u[dofs], model) * model.scales.displacement


def _of_path(
    model: Model, steps: Sequence[Step], states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> tuple[dict[str, Table], Quantities]:
    """What a counter-body that moves adds to the tables and quantities."""
    if not model.plan.sliding.moves:
        return {}, {}
    found: tuple[dict[str, Table], Quantities] = import_module(TRACK).path_results(
        model, steps, states, fields
    )
    return found


def _tables(
    model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, Table]:
    """Tables of the states."""
    (name, first), *_ = states.items()
    out = {
        "axis": stacked([tables.axis_table(each, fields[each]) for each in states]),
        "line": stacked([tables.line_table(each, model, states[each], fields[each]) for each in states]),
        "plane": stacked([tables.plane_table(each, fields[each]) for each in states]),
    }
    leaves = bool(model.plan.sliding.places.any())  # the origin
    if first.force and (leaves or model.plan.kind == "rough"):
        out["cut"] = tables.cut_table(name, model, first, fields[name])
    return out | model.tables_of_patch(states)


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    plan, lines, length = model.plan, model.lines, model.scales.length
    words = WORDS[kind_of(plan.bodies.coating)]
    return {
        "element": "8-node hexahedron, mean dilatation, 2 x 2 x 2 Gauss points",
        "bodies": 1,
        "symmetry": "half, y >= 0" if lines.half else "none",
        "cells_per_radius": plan.fine_cells_per_radius if plan.kind == "smooth" else None,
        "reference_radius_m": length,
        "h_m": float(np.diff(lines.x).min()) * length,
        "box_m": float(lines.z[-1]) * length,
        **solution.coating_elements(model, plan.coating_layers),
        "elements": plan.elements,
        "dofs": plan.unknowns,
        "far_field": words.replace("the point force", "the normal and tangential point force"),
    }


METHOD = solution.Method(
    setups="multigrid_setups",
    plan=plan,
    build=build,
    stresses=recovery.stresses,
    largest_mises=recovery.largest_mises,
    largest_peeq=recovery.largest_peeq,
    largest_in_layer=recovery.largest_in_layer,
    contact_quantities=_contact_quantities,
    residual_quantities=_residual_quantities,
    tables=_tables,
    field_mesh=tables.field_mesh,
    surface=tables.surface_grid,
    discretisation=_discretisation,
    of_path=_of_path,
)
