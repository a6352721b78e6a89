# SPDX-License-Identifier: MIT
"""The energy balance of a smooth scene in the semi-analytical model.

The states are those that the solver commits. Their displacements and stresses are evaluated again, all on the
last box of cells: what the solver carries along from step to step is not used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import sam
from sam.contact.convolution import Convolution, Counters, convolution_onto
from sam.elastic import load_step
from sam.grid.cells import CellGrid, Window
from sam.kernels.lags import Lags
from sam.kernels.patches import displacement_coefficients, parity
from sam.loading import Load, targets_of
from sam.planner.grids import choose_grid, gap_of
from sam.plasticity.extent import Extent
from sam.plasticity.outside import surface_lift
from sam.plasticity.return_map import SHEAR, contraction
from sam.plasticity.run import Run
from sam.scene import Scene
from sam.scene.checkpoint import Checkpoint
from verification.energy.balance import Balance, along_path, plastic_work


@dataclass(frozen=True)
class Committed:
    """A state: its load, pressure (nx, ny) in Pa on the full grid; plastic strain and peeq on `extent`, None
    if elastic.
    """

    load: Load
    pressure: np.ndarray
    extent: Extent | None = None
    strain: np.ndarray | None = None
    peeq: np.ndarray | None = None


def balance_of(scene: Scene) -> Balance:
    """Solve a smooth scene and balance the energy of the body.

    ValueError for an elastic counter-body or a coating; RuntimeError when a step does not converge.
    """
    if scene.counterbody is None or scene.counterbody.elastic or scene.body.coating is not None:
        raise ValueError("counterbody: a rigid one on a body without coating is needed")
    grid = choose_grid(scene)
    states = _plastic_states(scene, grid) if scene.body.plasticity else _elastic_states(scene, grid)
    return _balance(scene, grid, [Committed(Load(0.0), np.zeros((grid.nx, grid.ny))), *states])


def _elastic_states(scene: Scene, grid: CellGrid) -> list[Committed]:
    states, pressure = [], None
    for target in targets_of(scene):
        contact = load_step(scene, grid, target.load, pressure, Counters())
        if not contact.converged:
            raise RuntimeError(f"the contact under {target.load.force:g} N did not converge")
        pressure = contact.pressure
        states.append(Committed(target.load, pressure))
    return states


def _plastic_states(scene: Scene, grid: CellGrid) -> list[Committed]:
    """Of each committed step, also of the parts of a step that was cut."""
    states, unit = [], scene.body.young / (1 - scene.body.poisson**2) / 2

    def keep(checkpoint: Checkpoint) -> None:
        tree = checkpoint.tree()
        state, extent = tree["state"], tree["extent"]
        extent = Extent(Window(**extent["window"]), extent["layers"])
        pressure = np.zeros((grid.nx, grid.ny))
        pressure[extent.window.slices] = state["pressure"] * unit
        states.append(Committed(Load(**state["load"]), pressure, extent, state["strain"], state["alpha"]))

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
    locked, dissipated, flowed = zero, zero, zero
    if states[-1].extent is not None:
        lifts, locked, dissipated, flowed = _plastic_parts(scene, grid, states)
        moved = [u + lift for u, lift in zip(moved, lifts, strict=True)]
    gap0 = gap_of(scene, grid)
    for k, (state, u) in enumerate(zip(states, moved, strict=True)):
        approach[k] = (gap0 + u[0])[state.pressure > 0].mean() if state.load.force else (gap0 + u[0]).min()
    work = along_path([tractions], [moved])
    return Balance(forces, approach, work, elastic + locked, dissipated, flowed, zero, locked)


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
    """(displacements of the surface by the plastic strain, E locked, D of the material, D by the trapezoidal
    rule).
    """
    extent = states[-1].extent
    run, window, faces = Run(scene, grid, Counters(), extent), extent.window, grid.faces[: extent.layers + 1]
    problem, virgin = run.problem, run.problem.virgin()
    volume = (grid.hx * grid.hy * np.diff(faces))[:, None, None]
    factor, curve = problem.material.factor[:, None, None], problem.material.curve
    lifts, strains, stresses = [], [], []
    locked, dissipated = np.zeros(len(states)), np.zeros(len(states))
    for k, state in enumerate(states):
        strain, peeq = _on(extent, state)
        lift, residual = problem.plastic_part(virgin, strain)
        sideways = np.zeros_like(lift)
        if scene.coefficient:
            sideways = surface_lift(
                strain, window, faces, window, grid.hx, grid.hy, scene.body.poisson, Counters(), component=1
            )  # fmt: skip
        both = np.zeros((2, grid.nx, grid.ny))
        both[:, *window.slices] = lift, sideways
        loaded = problem.operator.whole(
            problem.stress(state.pressure[window.slices] / problem.unit, state.load)
        )
        lifts.append(both)
        strains.append(strain)
        stresses.append((loaded + residual) * volume)
        locked[k] = -0.5 * np.sum(volume * contraction(residual, strain))
        dissipated[k] = np.sum(volume * factor * plastic_work(curve, peeq))
    tensor = np.sqrt(SHEAR)  # each shear component stands for two entries of the tensor
    flowed = along_path(
        *([[tensor[:, None, None, None] * field for field in fields]] for fields in (stresses, strains))
    )
    return lifts, locked, dissipated, flowed


def _on(extent: Extent, state: Committed) -> tuple[np.ndarray, np.ndarray]:
    """Plastic strain and peeq of a state on a box that holds its own."""
    window, layers = extent.window, extent.layers
    strain, peeq = np.zeros((6, layers, *window.shape)), np.zeros((layers, *window.shape))
    if state.extent is not None:
        old, count = state.extent.window, state.extent.layers
        i, j = old.i0 - window.i0, old.j0 - window.j0
        cells = slice(i, i + old.nx), slice(j, j + old.ny)
        strain[:, :count, *cells], peeq[:count, *cells] = state.strain, state.peeq
    return strain, peeq
