# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element solution of a scene: a rigid counter-body on a smooth or rough body, or
given tractions. Tables and fields are in SI units, with the columns of sam.scene.result.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np

from fem_reference.common import solution
from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.far_field import WORDS, kind_of
from fem_reference.common.loading import Step
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import columns, stacked
from fem_reference.spatial import recovery
from fem_reference.spatial.model import Model
from fem_reference.spatial.planner import SpatialPlan, plan
from fem_reference.spatial.recovery import Stresses, at_zero, with_interface
from sam.scene.checkpoint import Checkpoint, Keep
from sam.scene.result import AXIS, CUT, LINE, PLANE, FieldMesh, GridFields, Progress, Result, Table
from sam.scene.schema import Scene

TRACK = "fem_reference.spatial.track"
"""Where the track of a counter-body is measured that moves."""
MODULES = {"smooth": "fem_reference.spatial.model", "rough": "fem_reference.spatial.rough"}
"""Where the model of each kind of body is built; a smooth one does without the other."""


VTK_CORNERS = [0, 3, 6, 2, 1, 5, 7, 4]
"""Corners of a hexahedron of scikit-fem in the order of VTK; skfem.io.meshio has it too, and loads meshio."""


def axis_table(state: str, s: Stresses) -> dict[str, Any]:
    """Stresses and strains under the origin, at the centres of elements and below the interface."""
    layers = with_interface(s)
    return stacked([columns(AXIS, [state, p.z, p.axis_peeq, mises(p.axis), *p.axis]) for p in layers])


def line_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> dict[str, Any]:
    """Surface nodes on y = 0; NaN without a gap, and in ux_m and plastic_shear_m without friction."""
    unit, y = model.scales, model.lines.y
    ux, _, uz = (on_plane(equilibrium.u[dofs[model.surface]], y) for dofs in model.body.basis.nodal_dofs)
    gap = on_plane(model.at(equilibrium.load).initial_gap, y) + uz - equilibrium.approach
    gap = np.where(np.isfinite(gap) & (not model.prescribed), gap * unit.displacement, np.nan)
    nodal = model.nodal_pressure(equilibrium) * unit.pressure
    pressure, traction = on_plane(nodal, y), on_plane(model.ratio(equilibrium) * nodal, y)
    x = model.lines.x * unit.length
    values = [state, x, pressure, traction, gap, uz * unit.displacement]
    if model.plan.sliding.coefficient == 0.0:
        return columns(LINE, [*values, np.nan, np.nan])
    return columns(LINE, [*values, ux * unit.displacement, np.interp(x, s.x, plastic_shear(model, s))])


def on_plane(values: Array, line: Array) -> Array:
    """Values at zero of those (..., n) on the planes of `line` (n,), or the mean of both sides."""
    zero = int(np.searchsorted(line, 0.0))
    return values[..., zero] if line[zero] == 0.0 else 0.5 * (values[..., zero - 1] + values[..., zero])


def at_origin(values: Array, model: Model) -> float:
    """Value in the origin of those (nx + 1, ny + 1) at the surface nodes."""
    return float(on_plane(on_plane(values, model.lines.y), model.lines.x))


def plastic_shear(model: Model, s: Stresses) -> Array:
    """(nx,) in m: what plastic shear moves the surface along x, -integral of 2 e_p_xz over z."""
    if s.plastic_strain is None:
        return np.zeros(s.x.size)
    in_plane = at_zero(s.plastic_strain[4], model.lines.y, 1)
    return -2.0 * in_plane @ np.diff(model.lines.z) * model.scales.length


def plane_table(state: str, s: Stresses) -> dict[str, Any]:
    """The plane y = 0, extrapolated, at the centres of the elements and below an interface, x by x."""
    layers = with_interface(s)
    x, z = np.meshgrid(s.x, np.concatenate([part.z for part in layers]), indexing="ij")
    peeq, plane = (
        np.concatenate([getattr(part, name) for part in layers], axis=-1) for name in ("plane_peeq", "plane")
    )
    return columns(PLANE, [state, x.ravel(), z.ravel(), peeq.ravel(), mises(plane).ravel()])


def cut_table(state: str, model: Model, equilibrium: Equilibrium, s: Stresses) -> dict[str, Any]:
    """The plane y = const through the largest pressure: the mean of the elements beside it."""
    pressure = model.nodal_pressure(equilibrium)
    j = int(np.unravel_index(pressure.argmax(), pressure.shape)[1])
    y = float(model.lines.y[j])
    beside = slice(max(j - 1, 0), j + 1)
    stress, peeq = (
        (s.plane, s.plane_peeq)
        if y == 0.0
        else (s.stress[:, :, beside].mean(axis=2), s.peeq[:, beside].mean(axis=1))
    )
    x, z = np.meshgrid(s.x, s.z, indexing="ij")
    place = [x.ravel(), y * model.scales.length, z.ravel()]
    components = stress.reshape(6, -1)
    return columns(CUT, [state, *place, peeq.ravel(), mises(components), *components])


def field_mesh(model: Model, equilibrium: Equilibrium, s: Stresses) -> FieldMesh:
    """The block: pressure and displacement at the nodes, stress and strain in the elements."""
    unit, mesh = model.scales, model.problem.mesh
    pressure = np.zeros(mesh.p.shape[1])
    pressure[model.surface] = model.nodal_pressure(equilibrium) * unit.pressure
    u = equilibrium.u[model.body.basis.nodal_dofs] * unit.displacement
    by_number = np.argsort(model.elements, axis=None)

    def cells(field: Array) -> Array:
        return field.reshape(*field.shape[:-3], -1)[..., by_number].T

    cell_data = {"mises_Pa": cells(mises(s.stress)), "stress_Pa": cells(s.stress)}
    if s.plastic_strain is not None:
        cell_data |= {"peeq": cells(s.peeq), "plastic_strain": cells(s.plastic_strain)}
    return FieldMesh(
        points=mesh.p.T * unit.length,
        cells={"hexahedron": mesh.t[VTK_CORNERS].T.copy()},
        point_data={"p_Pa": pressure, "uz_m": u[2], "displacement_m": u.T.copy()},
        cell_data=cell_data,
    )


def surface_grid(model: Model, equilibrium: Equilibrium) -> GridFields:
    """The surface nodes: pressure, displacement, friction, and the gap where it is finite."""
    unit, pressure = model.scales, model.nodal_pressure(equilibrium) * model.scales.pressure
    u = equilibrium.u[model.body.basis.nodal_dofs[:, model.surface]] * unit.displacement
    points = {"p_Pa": pressure, "displacement_m": u}
    if model.plan.sliding.coefficient != 0.0:
        ratio = model.ratio(equilibrium)
        points |= {"qx_Pa": ratio * pressure, "friction": np.abs(ratio) * (pressure > 0.0)}
    gap = (
        model.at(equilibrium.load).initial_gap * unit.displacement
        + u[2]
        - equilibrium.approach * unit.displacement
    )
    if np.isfinite(gap).all() and not model.prescribed:
        points["gap_m"] = gap
    x, y = (line * unit.length for line in (model.lines.x, model.lines.y))
    return GridFields(x, y, np.zeros(1), {name: values[..., None] for name, values in points.items()})


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
    *,
    plan: SpatialPlan | None = None,
) -> Result:
    """Solve a smooth or rough scene with or without friction by finite elements in three dimensions.

    Parameters
    ----------
    scene : Scene
        A rigid counter-body on a smooth or rough body, or given tractions of Hertz.
    progress, checkpoint, start, plan : optional
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
    return solution.solve(METHOD, scene, progress=progress, checkpoint=checkpoint, start=start, plan=plan)


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
    quantities: Quantities = {
        "force_N": model.plan.force * model.share(peak),
        "contact_area_m2": area,
        "contact_radius_m": float(np.sqrt(area / np.pi)),
        "pressure_centroid_x_m": model.centroid(peak) * unit.length,
        **model.quantities_of_patch(peak),
    }
    if model.plan.kind != "smooth":  # nothing says where its centre is
        return quantities
    quantities["p_center_Pa"] = at_origin(model.nodal_pressure(peak), model) * unit.pressure
    if model.plan.sliding.coefficient > 0.0:
        quantities["tangential_displacement_center_m"] = _centre(model, peak, 0)
    return quantities


def _residual_quantities(model: Model, left: Equilibrium, s: Stresses) -> Quantities:
    """Quantities of the surface after unloading, of which a rough patch has none."""
    if model.plan.kind != "smooth":
        return {}
    quantities: Quantities = {"residual_uz_center_m": _centre(model, left, 2)}
    if model.plan.sliding.coefficient > 0.0:
        quantities["residual_ux_center_m"] = _centre(model, left, 0)
        quantities["plastic_shear_center_m"] = float(np.interp(0.0, s.x, plastic_shear(model, s)))
    return quantities


def _centre(model: Model, state: Equilibrium, component: int) -> float:
    """Displacement in m of the surface in the origin."""
    dofs = model.body.basis.nodal_dofs[component, model.surface]
    return at_origin(state.u[dofs], model) * model.scales.displacement


def _of_path(
    model: Model, steps: Sequence[Step], states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> tuple[dict[str, Table], Quantities]:
    """What a counter-body that moves adds to the tables and quantities."""
    if not model.plan.sliding.moves:
        return {}, {}
    track = import_module(TRACK)
    return track.path_results(model, steps, states, fields)


def _tables(
    model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, Table]:
    """Tables of the states."""
    (shown, first), *_ = states.items()
    out = {
        "axis": stacked([axis_table(name, fields[name]) for name in states]),
        "line": stacked([line_table(name, model, states[name], fields[name]) for name in states]),
        "plane": stacked([plane_table(name, fields[name]) for name in states]),
    }
    leaves = bool(model.plan.sliding.places.any())  # the origin
    if first.force and (leaves or model.plan.kind == "rough"):
        out["cut"] = cut_table(shown, model, first, fields[shown])
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
    field_mesh=field_mesh,
    surface=surface_grid,
    discretisation=_discretisation,
    of_path=_of_path,
)
