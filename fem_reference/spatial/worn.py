# SPDX-License-Identifier: MIT
"""A rough body from which strained material is removed between the cycles of its load.

A study beside the scenes: no model of finite elements has [wear]. Unloaded, at the end of a cycle, each node
of the patch is lowered by the depth down to which the accumulated plastic strain below it is above the
limit, or by a depth that is given. Strains are small and the mesh stays: the gap opens by the depth, and the
state of every column of Gauss points moves up by it. Then the unloaded body is in equilibrium again.

Along a column the state is linear between the Gauss points, and the strain at the surface is extrapolated
from the first two. The strain below a node is the mean of the four columns next to it. Where a roof falls, a
node is lowered by the largest depth at which the strain below it is above the limit there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import RegularGridInterpolator, interp1d

from fem_reference.common.arrays import Array, Integers
from fem_reference.common.contact import Equilibrium, without_contact
from fem_reference.common.elasticity import on_grid
from fem_reference.common.loading import Progressed, Step, follow
from fem_reference.common.plasticity import History
from fem_reference.spatial.planner import plan
from fem_reference.spatial.recovery import stresses
from fem_reference.spatial.rough import RoughModel, build, on_mesh, surface_table
from fem_reference.spatial.solution import plane_table
from sam.scene.result import Table
from sam.scene.schema import Scene
from sam.scene.section import stated


@dataclass(frozen=True)
class WornCycle:
    """A cycle of a rough body that wears.

    tables: "surface" and "plane" at its peak, as in a result; peeq_max: largest accumulated plastic strain
    there; worn: (nx, ny) depth in m that is removed up to its end; moved: (nx, ny) displacement in m of the
    unloaded surface into the body after the removal, at the nodes of the patch.
    """

    tables: dict[str, Table]
    peeq_max: float
    worn: Array
    moved: Array


@dataclass(frozen=True)
class Limits:
    """Plastic strains beyond which material is removed: `layer` down to `thickness` (m), `bulk` below; and
    whether sound material above it falls.
    """

    bulk: float
    layer: float
    thickness: float
    roof_falls: bool = False


def worn_cycles(scene: Scene, *ways: Sequence[Array] | None) -> list[list[WornCycle]]:
    """The cycles of a rough scene with [wear], solved with removal at the end of each of them, for each of
    some ways to remove; the load of the first cycle, which they have in common, is solved once.

    scene: a rough body that yields below a rigid counter-body; of its [wear] only the strain limits and the
    roof are read, nothing is smoothed. ways: depths (nx, ny) in m to remove from the cells at the end of each
    cycle, or None for the model's own. Raises UnsupportedScene for what else of the scene finite elements
    cannot represent, ValueError where a cycle does not converge, or all that the mesh has below a node is
    above the limit.
    """
    wear, thickness = stated(scene.wear), stated(scene.body.plasticity).layer_thickness
    layer = None if thickness is None else wear.strain_limit_layer
    of_layer = (wear.strain_limit, 0.0) if layer is None else (layer, stated(thickness))
    limits = Limits(wear.strain_limit, *of_layer, wear.roof == "falls")
    body = build(plan(scene.model_copy(update={"wear": None})))
    first: list[Step] = []
    found = []
    for depths in ways:
        model, state, worn, cycles = body, body.virgin(), np.zeros(body.heights.shape), []
        for cycle in range(1, scene.loading.cycles + 1):
            targets = [target for target in model.plan.schedule.targets if target.cycle == cycle]
            steps = first if first and cycle == 1 else follow(model, Progressed(state, targets))
            first, state = first or steps, steps[-1].state
            if not state.converged or state.history is None:
                raise ValueError(f"cycle {cycle}: {state.ending or 'not converged'}")
            peak = [step.state for step in steps if not step.unloads][-1]
            depth = own_depth(model, state, limits) if depths is None else depths[cycle - 1]
            worn = worn + depth
            fields = stresses(model, peak)
            tables = {"surface": surface_table("peak", model, peak), "plane": plane_table("peak", fields)}
            model, state = lowered(model, state, depth)
            uz = state.u[model.body.basis.nodal_dofs[2][model.surface]] * model.scales.displacement
            moved = uz[np.isfinite(model.initial_gap)].reshape(worn.shape)
            cycles.append(WornCycle(tables, fields.largest_peeq()[0], worn, moved))
        found.append(cycles)
    return found


def columns_of_points(model: RoughModel) -> Integers:
    """(2 nx, 2 ny, 2 nz) numbers of the Gauss points of the whole mesh, as columns over depth."""
    return on_grid(model.body.points.reshape(3, -1), tuple(2 * n for n in model.lines.shape))


def own_depth(model: RoughModel, state: Equilibrium, limits: Limits) -> Array:
    """(nx, ny) depth in m down to which the strain below the nodes of the patch is above the limits."""
    columns, points = columns_of_points(model), model.body.points.reshape(3, -1)
    peeq = stated(state.history).peeq.ravel()[columns] * model.scales.strain
    # a node inside of the mesh has the last point of the element before it and the first of the one after
    beside = 0.5 * (peeq[1:-1:2] + peeq[2:-1:2])
    below = 0.5 * (beside[:, 1:-1:2] + beside[:, 2:-1:2])
    patch = np.isfinite(model.initial_gap)[1:-1, 1:-1]
    z, strain = points[2, columns[0, 0]] * model.scales.length, below[patch]
    if limits.roof_falls:
        parts = (limits.layer, 0.0, limits.thickness), (limits.bulk, limits.thickness, z[-1])
        lowest = [deepest_above(limit, z, strain, between) for limit, *between in parts]
        if (lowest[1] == z[-1]).any():
            raise ValueError("the lowest point of a column is above the strain limit")
        return np.maximum(*lowest).reshape(model.heights.shape)
    layer, bulk = (depth_above(limit, z, strain) for limit in (limits.layer, limits.bulk))
    depth = np.where(layer < limits.thickness, layer, np.maximum(bulk, limits.thickness))
    return depth.reshape(model.heights.shape)


def depth_above(limit: float, z: Array, strain: Array) -> Array:
    """(n,) depth at which profiles first fall to the limit, 0 where the surface is below it.

    z: (m,) depths, ascending; strain: (n, m) there, linear between them and from the first two on to z = 0.

    Raises ValueError where all of a profile is above the limit.
    """
    z, strain = from_surface(z, strain)
    below, depth = strain <= limit, np.zeros(len(strain))
    if not below.any(axis=1).all():
        raise ValueError("all of a column is above the strain limit")
    rows = np.flatnonzero(~below[:, 0])
    last = np.argmax(below[rows], axis=1)
    upper, lower = strain[rows, last - 1], strain[rows, last]
    depth[rows] = z[last - 1] + (upper - limit) / (upper - lower) * (z[last] - z[last - 1])
    return depth


def from_surface(z: Array, strain: Array) -> tuple[Array, Array]:
    """Depths and profiles with the surface, z = 0, before them."""
    slope = (strain[:, 1] - strain[:, 0]) / (z[1] - z[0])
    surface = np.maximum(strain[:, 0] - slope * z[0], 0.0)
    return np.append(0.0, z), np.column_stack([surface, strain])


def deepest_above(limit: float, z: Array, strain: Array, between: Sequence[float]) -> Array:
    """(n,) largest depth from the first to the second of `between` at which profiles, as in `depth_above`,
    are above the limit, 0 where none is.
    """
    z, strain = from_surface(z, strain)
    inner = z[(z > between[0]) & (z < between[1])]
    nodes, depth = np.array([between[0], *inner, between[1]]), np.zeros(len(strain))
    excess = interp1d(z, strain)(nodes) - limit
    rows = np.flatnonzero((excess > 0.0).any(axis=1))
    last = len(nodes) - 1 - np.argmax(excess[rows, ::-1] > 0.0, axis=1)
    after = np.minimum(last + 1, len(nodes) - 1)  # of the last node, itself
    upper, lower = excess[rows, last], excess[rows, after]
    depth[rows] = nodes[last] + upper / np.where(after > last, upper - lower, 1.0) * (
        nodes[after] - nodes[last]
    )
    return depth


def lowered(model: RoughModel, state: Equilibrium, depth: Array) -> tuple[RoughModel, Equilibrium]:
    """The unloaded body after so much (nx, ny), in m, is removed, in equilibrium."""
    if not depth.any():
        return model, state
    model = replace(model, heights=model.heights - depth)
    gap = model.initial_gap.ravel()[model.candidates]
    model = replace(model, problem=model.problem.with_gap(gap))
    nodal = on_mesh(model.plan, depth / model.scales.length, 0.0)
    history = moved_up(model, stated(state.history), nodal)
    load, scale = state.load, model.scales.peak_force
    state = without_contact(model.problem, load, scale, u=state.u, history=history)
    if not state.converged:
        raise ValueError(f"after the removal: {state.ending or 'not converged'}")
    return model, state


def moved_up(model: RoughModel, history: History, nodal: Array) -> History:
    """The history moved up by the depth `nodal` (nx + 1, ny + 1) in lengths of the model."""
    columns, points = columns_of_points(model), model.body.points.reshape(3, -1)
    x, y, z = points[0, columns[:, 0, 0]], points[1, columns[0, :, 0]], points[2, columns[0, 0]]
    depth = RegularGridInterpolator((model.lines.x, model.lines.y), nodal)
    places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    up = depth(places)
    worn = up > 0.0
    above, up = columns[worn], up[worn]

    def moved(field: Array) -> Array:
        flat = field.reshape(-1, history.peeq.size).copy()
        for column, far in zip(above, up, strict=True):
            flat[:, column] = interp1d(z, flat[:, column], bounds_error=False, fill_value=0.0)(z + far)
        return flat.reshape(field.shape)

    back = None if history.back is None else moved(history.back)
    return History(moved(history.plastic_strain), moved(history.peeq), history.misfit, back)
