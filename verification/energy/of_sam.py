# SPDX-License-Identifier: MIT
"""The energy balance of a smooth scene in the semi-analytical model.

The states are those that the solver commits. Their displacements and stresses are evaluated again, all on the
last box of cells: what the solver carries along from step to step is not used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import sam
from sam import Load, choose_grid, model_of
from sam.contact import Convolution, Counters, convolution_onto
from sam.grid import CellGrid, Window
from sam.kernels import parity
from sam.plasticity import (
    POINTS,
    SHEAR,
    CellFields,
    Extent,
    MaterialFields,
    Model,
    Progressed,
    Strained,
    contraction,
    stress_at_points,
    surface_displacement,
)
from sam.scene import Checkpoint, Scene, plastic_work
from verification.energy.balance import Balance, along_path, back_energies


@dataclass(frozen=True)
class Committed:
    """A state: load, pressure (nx, ny) in Pa on the full grid; material of `extent`, None if elastic."""

    load: Load
    pressure: np.ndarray
    extent: Extent | None = None
    material: CellFields | None = None


def balance_of(scene: Scene) -> Balance:
    """Solve a smooth scene and balance the energy of the body. ValueError for an elastic counter-body or a
    coating; RuntimeError when a step does not converge. Where the pressure is given the approach is zero.
    """
    elastic = scene.counterbody is not None and scene.counterbody.elastic
    if elastic or scene.loading.prescribed == "misfit-sphere" or scene.body.coating is not None:
        raise ValueError("counterbody: a rigid one on a body without coating is needed")
    grid = choose_grid(scene)
    states = _plastic_states(scene, grid) if scene.body.plasticity else _elastic_states(scene)
    return _balance(scene, grid, [Committed(Load(0.0), np.zeros((grid.nx, grid.ny))), *states])


def _elastic_states(scene: Scene) -> list[Committed]:
    plan = sam.plan(scene)
    states, pressure, problem = [], None, plan.problem(Counters())
    for target in plan.schedule.targets:
        contact = problem.contact(target.load, start=pressure)
        if not contact.converged:
            raise RuntimeError(f"the contact under {contact.force:g} N did not converge")
        pressure = contact.pressure
        states.append(Committed(target.load.found(contact.force), pressure))
    return states


def _plastic_states(scene: Scene, grid: CellGrid) -> list[Committed]:
    """Of each committed step, also of the parts of a step that was halved."""
    states, unit = [], scene.body.young / (1 - scene.body.poisson**2) / 2

    def keep(checkpoint: Checkpoint) -> None:
        now = checkpoint.record(Progressed)
        pressure = np.zeros((grid.nx, grid.ny))
        pressure[now.extent.window.slices] = now.state.pressure * unit
        states.append(Committed(now.state.load, pressure, now.extent, now.state.material))

    result = sam.solve(scene, checkpoint=keep)
    if not result.converged:
        raise RuntimeError(f"the solution ended {result.status}: {result.message}")
    return states


def _balance(scene: Scene, grid: CellGrid, states: list[Committed]) -> Balance:
    tractions, moved, zero = [], [], np.zeros(len(states))
    for state in states:
        friction = state.load.sign * scene.coefficient * state.pressure
        tractions.append(np.stack([state.pressure, friction]) * grid.hx * grid.hy)
        moved.append(_moved(scene, grid, state.pressure, friction))
    elastic = 0.5 * np.array([np.sum(f * u) for f, u in zip(tractions, moved, strict=True)])
    parts = {"stored": zero, "dissipated": zero, "flowed": zero, "back": zero, "within": zero}
    if states[-1].extent is not None:
        residuals, parts = _plastic_parts(scene, grid, states)
        moved = [u + residual for u, residual in zip(moved, residuals, strict=True)]
    approach = zero.copy()
    if scene.counterbody is not None:
        initial = sam.plan(scene).problem(Counters()).gap
        for k, (state, u) in enumerate(zip(states, moved, strict=True)):
            gap = initial(state.load) + u[0]
            approach[k] = gap[state.pressure > 0].mean() if state.load.force else gap.min()
    forces = np.array([state.load.force for state in states])
    work = along_path([tractions], [moved])
    return Balance(forces, approach, work=work, elastic=elastic + parts["stored"], beyond=zero, **parts)


def _moved(scene: Scene, grid: CellGrid, pressure: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """(u_z, u_x) of the surface of the elastic body, (2, nx, ny) in m. Paper Eq. 5."""
    body, whole = scene.body, Window(0, 0, grid.nx, grid.ny)
    bodies, mu, lags = (
        sam.plan(scene).bodies,
        body.young / (2 * (1 + body.poisson)),
        Convolution.lags_needed(whole, whole),
    )
    out = np.zeros((2, grid.nx, grid.ny))
    for row, component in enumerate((3, 1)):
        for load, field in ((3, pressure), (1, friction)):
            if not field.any():
                continue
            kernel = bodies.kernel(grid, body.poisson)(*lags, component=component, load=load)
            signs = [parity(str(component), load)]
            out[row] += grid.hx / mu * convolution_onto(kernel[None], signs, whole, whole)(field)[0]
    return out


def _plastic_parts(scene: Scene, grid: CellGrid, states: list[Committed]):
    """(displacements of the surface by the plastic strain, parts of the balance that the strain makes)."""
    extent = states[-1].extent
    plan = sam.plan(scene)
    model, window = model_of(plan, plan.problem(Counters())), extent.window
    problem = model.problem(extent)
    material, m = problem.material, problem.stiffness
    volume = (grid.hx * grid.hy * np.diff(model.faces(extent)))[:, None, None]
    materials = [
        problem.virgin().material if state.material is None else state.material.on_box(state.extent, extent)
        for state in states
    ]
    fields = [_at_points(each) for each in materials]
    residuals, stresses, means = [], [], []
    stored, between, dissipated = np.zeros((3, len(states)))
    for k, (state, mean, points) in enumerate(zip(states, materials, fields, strict=True)):
        residual = problem.residual_of(mean)
        both = np.zeros((2, grid.nx, grid.ny))
        both[0, *window.slices] = residual.displacement
        if scene.coefficient:
            both[1, *window.slices] = _moved_along(model, mean.strain, extent)
        if grid.periodic:
            free = scene.loading.lateral == "free"
            both += _mean_moved(scene, mean.strain, np.diff(model.faces(extent)), free)[:, None, None]
        residuals.append(both)
        pressed = problem.stress(state.pressure[window.slices] / problem.unit, state.load)
        stress = problem.operator.whole(pressed) + residual.stress
        at_points, smooth = (
            stress_at_points(stress, strain, m, periodic=grid.periodic)
            for strain in (points.strain, 0 * points.strain)
        )
        apart = at_points - smooth  # from what is linear in a cell
        stresses.append(at_points * volume / POINTS)
        means.append((stress * volume, mean.strain))
        between[k] = np.sum(volume * contraction(apart, apart).mean(axis=0) / (4 * m))
        stored[k] = between[k] - 0.5 * np.sum(volume * contraction(residual.stress, mean.strain))
        work = plastic_work(material.curve, points.peeq).mean(axis=0)
        dissipated[k] = np.sum(volume * material.factor * work)
    back = np.zeros(len(states))
    if material.hardens_back:
        found = [(each.strain, each.back, each.peeq) for each in fields]
        weights = volume / POINTS
        back, recovered = back_energies(material.back.modulus, material.back.recovery, found, weights)
        dissipated = dissipated + recovered
    flowed = _work(stresses, [each.strain for each in fields])
    within = flowed + between - _work(*zip(*means, strict=True))
    parts = {"stored": stored, "dissipated": dissipated, "flowed": flowed, "back": back, "within": within}
    return residuals, parts


def _moved_along(model: Model, strain: np.ndarray, extent: Extent) -> np.ndarray:
    """u_x of the surface of a box by plastic strain in it, (nx, ny) in m. Paper Eq. 6."""
    cells, window = model.cuboids(extent), extent.window
    if model.plan.period is not None:
        return model.plan.period.moved(strain, cells, 1)
    return surface_displacement(Strained(strain, window, cells), window, counters=Counters(), component=1)


def _mean_moved(scene: Scene, strain: np.ndarray, thick: np.ndarray, free: bool) -> np.ndarray:
    """(u_z, u_x) of the mean plane of a periodic patch by its mean plastic strain, (6, layers, nx, ny), in m:
    the solver gives displacements about it, but the mean of the tractions does work on it.
    """
    e, nu = strain.mean(axis=(2, 3)), scene.body.poisson
    along_z = e[2] + (0.0 if free else nu / (1 - nu)) * (e[0] + e[1])
    return -np.array([along_z @ thick, 2 * e[4] @ thick])


def _work(stresses, strains) -> np.ndarray:
    """Of stresses times volumes in the increments of strain by the trapezoidal rule, lists of (6, ...)."""
    twice = SHEAR.reshape(6, *[1] * (stresses[0].ndim - 1))  # each shear stands for two entries of the tensor
    return along_path([[twice * each for each in stresses]], [strains])


def _at_points(material: CellFields) -> MaterialFields:
    """The fields at the points of all cells, (..., 4, n_layers, nx, ny)."""
    shape = material.cells.shape
    return material.on(np.ones(shape, dtype=bool)).each(lambda each: each.reshape(*each.shape[:-1], *shape))
