# SPDX-License-Identifier: MIT
"""What an iteration of a plastic step is worth in each part of the strain; the answer does not know of it."""

import numpy as np
import pytest
from builders import RUN_IN_STEEL, running_in
from plastic_start import begin

from sam.contact.convolution import Counters
from sam.grid.cells import Window
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity import load_step as step
from sam.plasticity.flow import contraction, deviator, equivalent_strain
from sam.plasticity.load_step import PARTS, ROOT, preconditioned, stiffness_of_parts
from sam.plasticity.spectra import BoxOperator
from sam.plasticity.state import Extent
from sam.schedule import Load

MU, LAYERS = 2.5, 3
WEAK_LAYER = {
    **RUN_IN_STEEL,
    "layer_thickness": 0.4e-6,
    "profile": [[0.0, 0.6], [0.4e-6, 0.6], [0.5e-6, 1.0]],
}
WEAK_LAYER |= {"layer": {**RUN_IN_STEEL, "alpha": 1e3}}


def operator(aspect=1.0, **keys):
    return BoxOperator(Cuboids(Lags(5, 5, 1.0, aspect), (0.0, 0.1, 0.5, 1.5), 0.3), MU, Counters(), **keys)


def own_stress(on: BoxOperator):
    """Stress of a unit strain of each component in the middle cell of each layer, there."""
    found = np.empty((6, 6, LAYERS))
    for j in range(6):
        for layer in range(LAYERS):
            strain = np.zeros((6, LAYERS, 5, 5))
            strain[j, layer, 2, 2] = 1.0
            found[:, j, layer] = on.stress(None, on.response(on.transformed(strain)))[:, layer, 2, 2]
    return found


def test_own_stress_is_the_answer_of_a_cell_to_its_own_strain():
    """On oblong cells every entry; where only half of the wave numbers are stored, what has no direction."""
    on = operator(aspect=0.8)
    expected = own_stress(on)
    assert on.own_stress == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    mirrored = operator(mirror=(True, True), exchange=True)
    expected = stiffness_of_parts(own_stress(operator()))
    assert stiffness_of_parts(mirrored.own_stress) == pytest.approx(expected, rel=1e-12)


def test_a_flat_cell_at_the_surface_hardly_resists_a_shear_across_it():
    """A tenth as thick as wide: 0.1 mu for a shear across the layer, 1.6 mu in the plane, which the module
    says; and nothing but the diagonal there.
    """
    stiffness = stiffness_of_parts(operator().own_stress) / MU
    assert stiffness[2, 0] == stiffness[3, 0] == pytest.approx(0.097, rel=0.01)
    assert stiffness[[0, 4], 0] == pytest.approx([1.58, 1.6], rel=0.01)
    parts = np.einsum("ai,ijk,bj->abk", PARTS * ROOT, -operator().own_stress / MU, PARTS / ROOT)
    assert np.abs(parts - parts * np.eye(5)[..., None]).max() < 0.01


def test_it_solves_a_cell_that_flows_by_itself():
    """One cell of perfect plasticity, whose own strain lowers its stress by another stiffness in each part:
    an error across the flow is gone after one iteration, to second order.
    """
    m, limit, own = 1.0, np.full((1, 1, 1), 0.3), np.array([[1.6], [0.9], [0.1], [0.1], [1.6]])
    solution = np.array([0.0, 0, 0, 0, 2.0, 0]).reshape(6, 1, 1, 1)  # a shear 13

    def image(x):
        """Return map of the stress at x: that of the solution less what its own strain lowers it by."""
        off = PARTS @ (ROOT * (x - solution)[:, 0, 0, 0])
        lowered = (PARTS.T @ (own[:, 0] * off)) / ROOT
        at = solution * limit / (1.5 * equivalent_strain(solution))
        trial = at - lowered.reshape(x.shape) + 2 * m * x
        q = np.sqrt(1.5 * contraction(trial, trial))
        return 1.5 * (q - limit) / (3 * m) * trial / q

    assert image(solution) == pytest.approx(solution, abs=1e-15)
    assert preconditioned(solution, image(solution), limit, m=m, own=own) == pytest.approx(solution)
    error = 1e-6 * deviator(np.array([1.0, -2, 0.5, 3, 0, 1]).reshape(6, 1, 1, 1))
    x = solution + error
    better = preconditioned(x, image(x), limit, m=m, own=own)
    assert np.abs(better - solution).max() < 1e-5 * np.abs(error).max()
    assert np.abs(image(x) - solution).max() > 0.5 * np.abs(error).max()


def whole_grid(model):
    return Extent(Window(0, 0, 24, 24), 6)


def test_a_soft_layer_below_a_traction_takes_fewer_iterations_to_the_same_strain(monkeypatch):
    """Friction 0.4 everywhere on a layer that hardens little: strains of 20 %, equal within twice the
    tolerance to those of the return map alone. 18 iterations in place of 33 were measured.
    """
    a_scene = running_in(film=0.4, wear=None, plasticity=WEAK_LAYER)
    model, now = begin(a_scene, whole_grid)
    problem, load = model.problem(now.extent), Load(a_scene.loading.force / 4)
    found = problem.step(now.state, load)
    monkeypatch.setattr(step, "preconditioned", lambda x, image, *arguments, **keys: image)
    plain = problem.step(now.state, load)
    assert found.converged and plain.converged and plain.increment.peeq.max() > 0.2
    off = np.abs(found.increment.peeq - plain.increment.peeq).max()
    assert off <= 2 * problem.tolerance * plain.increment.peeq.max()
    assert len(found.history) <= 2 / 3 * len(plain.history)
