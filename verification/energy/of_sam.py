# SPDX-License-Identifier: MIT
"""The energy balance of a smooth scene in the semi-analytical model.

The states are those that the solver commits. Their displacements and stresses are evaluated again, all on the
last box of cells: what the solver carries along from step to step is not used.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import sam
from sam import Load, choose_grid, model_of
from sam.contact import Convolution, Counters, convolution_onto
from sam.grid import CellGrid, Window
from sam.kernels import Lags, displacement_coefficients, parity
from sam.plasticity import (
    POINTS,
    SHEAR,
    Extent,
    MaterialFields,
    Progressed,
    Strained,
    contraction,
    stress_at_points,
    surface_displacement,
    surrounded,
)
from sam.scene import Checkpoint, Scene, plastic_work, step_energies, stored_energy
from verification.energy.balance import Balance, along_path


@dataclass(frozen=True)
class Committed:
    """A state: its load, pressure (nx, ny) in Pa on the full grid; fields of the material at the points of
    the cells of `extent`, None if elastic.
    """

    load: Load
    pressure: np.ndarray
    extent: Extent | None = None
    material: MaterialFields | None = None


def balance_of(scene: Scene) -> Balance:
    """Solve a smooth scene and balance the energy of the body.

    ValueError for an elastic counter-body or a coating; RuntimeError when a step does not converge. Where the
    pressure is given the approach is zero.
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
        states.append(Committed(now.state.load, pressure, now.extent, now.state.points))

    result = sam.solve(scene, checkpoint=keep)
    if not result.converged:
        raise RuntimeError(f"the solution ended {result.status}: {result.message}")
    return states


def _balance(scene: Scene, grid: CellGrid, states: list[Committed]) -> Balance:
    cell = grid.hx * grid.hy
    tractions, moved = [], []
    elastic = np.zeros(len(states))
    for k, state in enumerate(states):
        friction = state.load.sign * scene.coefficient * state.pressure
        tractions.append(np.stack([state.pressure, friction]) * cell)
        moved.append(_moved(scene, grid, state.pressure, friction))
        elastic[k] = 0.5 * np.sum(tractions[-1] * moved[-1])
    forces, approach = np.array([state.load.force for state in states]), np.zeros(len(states))
    zero = np.zeros(len(states))
    stored, back, dissipated, flowed, inside = zero, zero, zero, zero, zero
    if states[-1].extent is not None:
        residuals, stored, back, dissipated, flowed, inside = _plastic_parts(scene, grid, states)
        moved = [u + residual for u, residual in zip(moved, residuals, strict=True)]
    work = along_path([tractions], [moved])
    if scene.counterbody is not None:
        initial = sam.plan(scene).problem(Counters()).gap
        for k, (state, u) in enumerate(zip(states, moved, strict=True)):
            gap = initial(state.load) + u[0]
            approach[k] = gap[state.pressure > 0].mean() if state.load.force else gap.min()
    return Balance(forces, approach, work, elastic + stored, dissipated, flowed, zero, stored, back, inside)


def _moved(scene: Scene, grid: CellGrid, pressure: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """(u_z, u_x) of the surface of the elastic body, (2, nx, ny) in m. Paper Eq. 5."""
    body, whole = scene.body, Window(0, 0, grid.nx, grid.ny)
    mu, lags = body.young / (2 * (1 + body.poisson)), Convolution.lags_needed(whole, whole)
    out = np.zeros((2, grid.nx, grid.ny))
    for row, component in enumerate((3, 1)):
        for load, field in ((3, pressure), (1, friction)):
            if not field.any():
                continue
            kernel = displacement_coefficients(
                Lags(*lags, 1.0, grid.hy / grid.hx), body.poisson, component=component, load=load
            )
            signs = [parity(str(component), load)]
            out[row] += grid.hx / mu * convolution_onto(kernel[None], signs, whole, whole)(field)[0]
    return out


def _plastic_parts(scene: Scene, grid: CellGrid, states: list[Committed]):
    """(displacements of the surface by the plastic strain, E stored, energy of the back-stresses, D of the
    material, plastic work by the trapezoidal rule, that of stresses that vary within the cells).
    """
    extent = states[-1].extent
    plan = sam.plan(scene)
    model, window = model_of(plan, plan.problem(Counters())), extent.window
    problem, faces = model.problem(extent), model.faces(extent)
    volume = (grid.hx * grid.hy * np.diff(faces))[:, None, None]
    factor, curve = problem.material.factor, problem.material.curve
    back, recovered = _back_parts(problem.material, [_on(problem.material, extent, each) for each in states])
    residuals, strains, stresses, means = [], [], [], []
    stored, between, dissipated = np.zeros((3, len(states)))
    for k, state in enumerate(states):
        points = _on(problem.material, extent, state)
        material = points.means()
        residual = problem.residual_of(material)
        sideways = np.zeros(window.shape)
        if scene.coefficient:
            source = Strained(material.strain, window, model.cuboids(extent))
            sideways = surface_displacement(source, window, counters=Counters(), component=1)
        both = np.zeros((2, grid.nx, grid.ny))
        both[:, *window.slices] = residual.displacement, sideways
        loaded = problem.operator.whole(
            problem.stress(state.pressure[window.slices] / problem.unit, state.load)
        )
        residuals.append(both)
        stress, m = loaded + residual.stress, problem.stiffness
        at_points = stress_at_points(stress, points.strain, m)
        apart = at_points - stress_at_points(stress, 0 * points.strain, m)  # from what is linear in a cell
        strains.append(points.strain)
        stresses.append(at_points * volume / POINTS)
        means.append((stress * volume, material.strain))
        between[k] = np.sum(volume * contraction(apart, apart).mean(axis=0) / (4 * m))
        stored[k] = between[k] - 0.5 * np.sum(volume * contraction(residual.stress, material.strain))
        dissipated[k] = np.sum(volume * factor * plastic_work(curve, points.peeq).mean(axis=0))
    flowed, of_means = _work(stresses, strains), _work(*zip(*means, strict=True))
    back, recovered = (
        [float(np.sum(volume * np.mean(each, axis=0))) for each in fields] for fields in (back, recovered)
    )
    return (
        residuals,
        stored,
        np.array(back),
        dissipated + np.cumsum(recovered),
        flowed,
        flowed + between - of_means,
    )


def _work(stresses, strains) -> np.ndarray:
    """Of stresses times volumes in the increments of strain by the trapezoidal rule, lists of (6, ...)."""
    twice = SHEAR.reshape(6, *[1] * (stresses[0].ndim - 1))  # each shear stands for two entries of the tensor
    return along_path([[twice * each for each in stresses]], [strains])


def _back_parts(material, fields: list[MaterialFields]) -> tuple[list, list]:
    """Energies per volume of the back-stresses: stored in each state, dissipated in the step to it."""
    nothing = np.zeros((POINTS, 1, 1, 1))
    if not material.hardens_back:
        return [nothing] * len(fields), [nothing] * len(fields)
    modulus, recovery = material.back.modulus, material.back.recovery
    steps = [nothing]
    for old, new in pairwise(fields):
        length = new.peeq - old.peeq
        found = step_energies(modulus, recovery, old.back, new.strain - old.strain, length=length)
        steps.append(found.dissipated)
    return [stored_energy(modulus, each.back) for each in fields], steps


def _on(material, extent: Extent, state: Committed) -> MaterialFields:
    """The fields of the material of a state on a box that holds its own."""
    if state.extent is None or state.material is None:
        return material.virgin((POINTS, *extent.shape))
    where = state.extent.inside(extent)
    return state.material.each(lambda values: surrounded(values, where, extent.shape))
