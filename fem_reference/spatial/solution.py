# SPDX-License-Identifier: MIT
"""Three-dimensional finite-element solution of a scene: a rigid counter-body on a smooth or rough body, or
given tractions. Tables and fields are in SI units, with the columns of sam.scene.result.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np

from fem_reference.common import solution
from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.far_field import words_of
from fem_reference.common.solution import Quantities
from fem_reference.common.tables import Surface, columns, stacked
from fem_reference.common.track import path_results
from fem_reference.spatial import model as smooth, recovery
from fem_reference.spatial.model import Model
from fem_reference.spatial.planner import SpatialPlan, plan
from fem_reference.spatial.recovery import Stresses, at_zero, with_interface
from sam.scene.result import AXIS, CUT, PLANE, FieldMesh, Table

TRACK = "fem_reference.spatial.track"
"""Where the track of a counter-body is measured that moves."""
ROUGH = "fem_reference.spatial.rough"
"""Where the model of a rough body is built; a smooth one does without."""
VTK_CORNERS = [0, 3, 6, 2, 1, 5, 7, 4]
"""Corners of a hexahedron of scikit-fem in the order of VTK; skfem.io.meshio has it too, and loads meshio."""


def axis_table(state: str, s: Stresses) -> dict[str, Any]:
    """Stresses and strains under the origin, at the centres of elements and below the interface."""
    layers = with_interface(s)
    return stacked([columns(AXIS, [state, p.z, p.axis_peeq, mises(p.axis), *p.axis]) for p in layers])


def surface_of(model: Model, equilibrium: Equilibrium) -> Surface:
    """The surface nodes; the gap is not finite where the pressure is given, and beside a patch."""
    unit, u = model.scales, equilibrium.u[model.body.basis.nodal_dofs[:, model.surface]]
    gap = model.at(equilibrium.load).initial_gap + u[2] - equilibrium.approach
    x, y = (line * unit.length for line in (model.lines.x, model.lines.y))
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    ratio = model.ratio(equilibrium) if model.plan.sliding.coefficient else None
    gap = np.where(model.plan.prescribed, np.nan, gap * unit.displacement)
    return Surface(x, y, pressure, ratio, gap, u * unit.displacement)


def plastic_shear(model: Model, s: Stresses, x: Array | float) -> Array | float:
    """See `fem_reference.common.solution.Method`."""
    if s.plastic_strain is None:
        return 0.0
    in_plane = at_zero(s.plastic_strain[4], model.lines.y, 1)
    return np.interp(x, s.x, -2.0 * in_plane @ np.diff(model.lines.z) * model.scales.length)


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


def build(plan: SpatialPlan) -> Model:
    """The model of a plan, smooth or rough."""
    made: Model = smooth.build(plan) if plan.patch is None else import_module(ROUGH).build(plan)
    return made


def _contact_quantities(model: Model, peak: Equilibrium) -> Quantities:
    """Quantities of the contact at the peak."""
    return {
        "contact_radius_m": float(np.sqrt(model.contact_area(peak) / np.pi)),
        "pressure_centroid_x_m": model.centroid(peak) * model.scales.length,
        **model.quantities_of_patch(peak),
    }


def _further(
    model: Model, states: Mapping[str, Equilibrium], fields: Mapping[str, Stresses]
) -> dict[str, Table]:
    """A section through the largest pressure where that is not at the origin, and the tables of a patch."""
    (shown, first), *_ = states.items()
    leaves = bool(model.plan.sliding.places.any())  # the origin
    cut = first.force and (leaves or model.plan.patch is not None)
    out = {"cut": cut_table(shown, model, first, fields[shown])} if cut else {}
    return out | model.tables_of_patch(states)


def _discretisation(model: Model) -> dict[str, object]:
    """The mesh in SI units."""
    plan, lines, length = model.plan, model.lines, model.scales.length
    words = words_of(plan.bodies.coating)
    return {
        "element": "8-node hexahedron, mean dilatation, 2 x 2 x 2 Gauss points",
        "symmetry": "half, y >= 0" if lines.half else "none",
        "cells_per_radius": plan.fine_cells_per_radius if plan.patch is None else None,
        "reference_radius_m": length,
        "h_m": float(np.diff(lines.x).min()) * length,
        "box_m": float(lines.z[-1]) * length,
        **solution.coating_elements(model, plan.coating_layers),
        "far_field": words.replace("the point force", "the normal and tangential point force"),
    }


METHOD = solution.Method(
    setups="multigrid_setups",
    plan=plan,
    build=build,
    stresses=recovery.stresses,
    contact_quantities=_contact_quantities,
    axis=axis_table,
    plane=plane_table,
    field_mesh=field_mesh,
    surface=surface_of,
    discretisation=_discretisation,
    plastic_shear=plastic_shear,
    further=_further,
    of_path=lambda model, *of_states: path_results(import_module(TRACK).Track(model), *of_states),
)
solve, load_steps = METHOD.solve, METHOD.load_steps
