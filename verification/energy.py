# SPDX-License-Identifier: MIT
"""The energy balance of a body over its load steps, from quantities that either model can give.

The surface tractions t do the work W = integral of t . du on a body. It is stored elastically or dissipated,

    W = E + D,    E = 1/2 int sigma : C^-1 : sigma dV,    D = int int sigma : d eps_p dV,                  (a)

and a material of von Mises dissipates the work of its yield stress, whatever the path: D = int Phi(peeq) dV
with Phi the integral of sigma_y from 0 to peeq (b). Back-stresses store a part W_X of the plastic work, which
then is W_X + D, and dissipate by their recovery, see `sam.scene.yield_curve`. With sigma = sigma_t + sigma_r
of the tractions on the elastic body and of the plastic strain, whose product has no energy (sigma_r balances
no load), E = 1/2 int t . u_t dA - 1/2 int sigma_r : eps_p dV (c).

Over finite steps W is summed by the trapezoidal rule. Summed likewise, D closes (a) at any number of steps
where the discrete operators are reciprocal: that is an error of space alone. D by (b) is that of the
material, which backward Euler follows to first order in the steps.

In the semi-analytical model, of a smooth scene, the states are those that the solver commits. Their
displacements and stresses are evaluated again, all on the last box of cells: what the solver carries along
from step to step is not used. In the finite-element models, on a rigid counter-body, forces on the nodes in
contact do the work; sums over the Gauss points give the energies. The outer boundary of the mesh moves as in
the half-space, so that work also leaves the mesh there: it is stored in what lies beyond, which stays
elastic. In space a half is modelled where y = 0 is a plane of symmetry.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import fem_reference
import sam
from fem_reference import Equilibrium, spatial
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
from sam.scene import Checkpoint, Scene, plastic_work, step_energies, stored_energy


@dataclass(frozen=True)
class Balance:
    """Energies in J after each step, the unloaded virgin body first; all (n + 1,). force in N; approach in m;
    work: of the surface tractions; pressing: of the force on the counter-body, integral of F d delta;
    elastic: E; stored: the part of E that the residual stress holds, None where it is not told apart;
    dissipated: D by (b), of back-stresses too; flowed: the plastic work D + W_X by the trapezoidal rule;
    beyond: work on what lies outside of the mesh, zero for a half-space; back: W_X; within: plastic work of
    stresses that vary within the cells of SAM, which the tractions do not do, as the operators take the
    strain of a cell as uniform: an error of space.
    """

    force: np.ndarray
    approach: np.ndarray
    work: np.ndarray
    elastic: np.ndarray
    dissipated: np.ndarray
    flowed: np.ndarray
    beyond: np.ndarray
    stored: np.ndarray | None = None
    back: np.ndarray | float = 0.0
    within: np.ndarray | float = 0.0

    @property
    def pressing(self) -> np.ndarray:
        return along_path([self.force], [self.approach])

    @property
    def error_of_cells(self) -> float:
        """The most that W - E is off the trapezoidal plastic work less `within`, over the largest W."""
        missing = self.work - self.elastic - self.beyond - self.flowed + self.within
        return float(np.abs(missing).max() / np.abs(self.work).max())

    @property
    def error_of_steps(self) -> float:
        """The most that the plastic work is off W_X + D, over the largest W: the error of the steps."""
        return float(np.abs(self.flowed - self.dissipated - self.back).max() / np.abs(self.work).max())

    @property
    def peak(self) -> int:
        """The state under the largest force."""
        return int(np.argmax(self.force))


def along_path(forces, motions) -> np.ndarray:
    """(n + 1,) integral of sum(f . du) up to each state by the trapezoidal rule; of (n + 1, ...) lists."""
    total = 0.0
    for f, u in zip(forces, motions, strict=True):
        f, u = (np.asarray(each, dtype=float).reshape(len(each), -1) for each in (f, u))
        total = total + np.sum((f[1:] + f[:-1]) / 2 * np.diff(u, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(total)])


def back_energies(moduli, recovery, fields: Sequence, weights) -> tuple[np.ndarray, np.ndarray]:
    """(n + 1,) energies of the back-stresses in each state: stored, and dissipated up to it. fields: of each
    state plastic strain, strains of the back-stresses and peeq at points with the weights in m3.
    """
    spent = [0.0]
    for (old, back, before), (new, _, now) in pairwise(fields):
        found = step_energies(moduli, recovery, back, new - old, length=now - before)
        spent.append(float(np.sum(weights * found.dissipated)))
    stored = [float(np.sum(weights * stored_energy(moduli, back))) for _, back, _ in fields]
    return np.array(stored), np.cumsum(spent)


@dataclass(frozen=True)
class Committed:
    """A state: load, pressure (nx, ny) in Pa on the full grid; material of `extent`, None if elastic."""

    load: Load
    pressure: np.ndarray
    extent: Extent | None = None
    material: CellFields | None = None


def balance_of_sam(scene: Scene) -> Balance:
    """Balance a smooth scene. ValueError for an elastic counter-body or film, RuntimeError unconverged."""
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
    bodies, lags = sam.plan(scene).bodies, Convolution.lags_needed(whole, whole)
    mu = body.young / (2 * (1 + body.poisson))
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
            thick = np.diff(model.faces(extent))
            # u_z, u_x of the mean plane by the mean plastic strain: the solver gives displacements about that
            # plane, but the mean of the tractions does work on it
            e, nu = mean.strain.mean(axis=(2, 3)), scene.body.poisson
            along_z = e[2] + (0.0 if free else nu / (1 - nu)) * (e[0] + e[1])
            both += (-np.array([along_z @ thick, 2 * e[4] @ thick]))[:, None, None]
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


def _work(stresses, strains) -> np.ndarray:
    """Of stresses times volumes in the increments of strain by the trapezoidal rule, lists of (6, ...)."""
    twice = SHEAR.reshape(6, *[1] * (stresses[0].ndim - 1))  # each shear stands for two entries of the tensor
    return along_path([[twice * each for each in stresses]], [strains])


def _at_points(material: CellFields) -> MaterialFields:
    """The fields at the points of all cells, (..., 4, n_layers, nx, ny)."""
    shape = material.cells.shape
    return material.on(np.ones(shape, dtype=bool)).each(lambda each: each.reshape(*each.shape[:-1], *shape))


def balance_of_fem(scene: Scene, model: str) -> Balance:
    """Solve with "fem-axisymmetric" or "fem-3d" and balance. RuntimeError without convergence."""
    if scene.counterbody is not None and scene.counterbody.elastic:
        raise ValueError("counterbody: elastic, the balance of energy is of a body below a rigid one")
    in_space = model == "fem-3d"
    if in_space and scene.loading.prescribed:
        raise ValueError("loading.prescribed: the balance of energy in space is of a contact")
    built, steps = (spatial if in_space else fem_reference).load_steps(scene)
    if not steps[-1].state.converged:
        raise RuntimeError("a load step did not converge")
    problem, body, material, unit = built.problem, built.body, built.problem.material, built.scales

    def pressing_of(state: Equilibrium) -> np.ndarray:
        """(size,) forces on the body in the contact."""
        out = np.zeros(problem.size)
        if in_space:
            out[problem.normal] = state.multipliers
            out[problem.along] = state.load.ratio * problem.weights * state.multipliers
        else:
            out += state.force * problem.prescribed
            out[problem.normal[0]] += state.multipliers
        return out

    states, weights = [built.virgin(), *(step.state for step in steps)], body.weights
    sides, pressing, stresses, plastic = [], [], [], []
    elastic, dissipated, back = (np.zeros(len(states)) for _ in range(3))
    compliance = np.linalg.inv(body.stiffness_tensor)
    for k, state in enumerate(states):
        strain = 0.0 if state.history is None else state.history.plastic_strain
        stress = body.stress(state.u, strain)
        sides.append(np.where(problem.fixed, body.internal_force(stress), 0.0))
        pressing.append(pressing_of(state))
        stresses.append(stress * weights)
        plastic.append(strain * np.ones_like(stress))
        elastic[k] = 0.5 * np.sum(np.einsum("st,seq,teq->eq", compliance, stress, stress) * weights)
        if state.history is not None:
            work = plastic_work(material.curve, state.history.peeq)
            dissipated[k] = np.sum(weights * material.factor * work)
    if material is not None and material.back_stresses:
        found = [
            (each.plastic_strain / material.engineering[:, None], each.back, each.peeq)
            for each in (state.history for state in states)
        ]
        back, recovered = back_energies(material.back.modulus, material.back.recovery, found, weights)
        dissipated += recovered
    motions = [state.u for state in states]
    newton = unit.pressure * unit.length**2
    joule = newton * unit.displacement / (problem.share if in_space else 1.0)
    return Balance(
        np.array([state.force for state in states]) * newton,
        np.array([state.approach for state in states]) * unit.displacement,
        work=joule * along_path([pressing], [motions]),
        elastic=joule * elastic,
        dissipated=joule * dissipated,
        flowed=joule * along_path([stresses], [plastic]),
        beyond=-joule * along_path([sides], [motions]),
        back=joule * back,
    )
