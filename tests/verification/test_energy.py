# SPDX-License-Identifier: MIT
"""Balances of energy: their sums against closed forms, both models on small contacts, and what sees it when
one lies.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import PERFECT, RADIUS, hertz_force, scene
from hypothesis import given, settings, strategies as st
from rounding import close

from fem_reference import Model, load_steps
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.patches import displacement_coefficients as right
from sam.plasticity import outside, points, spectra
from sam.scene import CounterBody, Scene, plastic_work
from sam.scene.yield_curve import Linear, Swift, Tabulated
from tests.system.test_repeated_loading import MELAN, pressed
from verification.cases.energy.energy import cycle, flow, gates, of_cells, of_steps, pressing, within
from verification.cases.recipes import Resolution, resolved_at
from verification.energy import of_fem, of_sam
from verification.energy.balance import Balance, along_path
from verification.runs.models import FEM, FEM_3D, SAM, solve

YIELD = 1e9


def sphere(size=5, ratio=4.0, mu=None, law=None, loading=None) -> Scene:
    """p0 of the elastic contact is `ratio` times the yield stress; size: cells or elements in its radius;
    law: or elastic.
    """
    made = scene(
        body={"plasticity": law},
        loading={"force": hertz_force(ratio * YIELD), "steps": 4, "unload": True, **(loading or {})},
        friction=mu and {"coefficient": mu, "direction": "alternating"},
        solver={"tolerance": 1e-5},
    )
    return resolved_at(made, Resolution(size, size))


@pytest.fixture(scope="module")
def runs():
    """Of a perfectly plastic sphere: SAM by cells and by steps, FEM by steps."""
    found = {(SAM, n, 6): of_sam.balance_of(sphere(n, law=PERFECT, loading={"steps": 6})) for n in (5, 7, 10)}
    for n in (6, 12, 24):
        found[SAM, 5, n] = of_sam.balance_of(sphere(5, law=PERFECT, loading={"steps": n}))
        found[FEM, 6, n] = of_fem.balance_of(sphere(6, law=PERFECT, loading={"steps": n}), FEM)
    return found


# --- sums ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("peeq", [0.0, 1e-9, 1e-6, 1e-3, 0.2])
def test_plastic_work_is_the_integral_of_the_yield_curve(peeq):
    """Swift in closed form to 1e-6, over nine decades of the strain; polynomials to rounding; a corner to
    1e-3.
    """
    at = np.array([peeq])
    swift = Swift(945e6, 20.0, 0.121)
    exact = swift.B / (1.121 * swift.alpha) * ((swift.C + swift.alpha * peeq) ** 1.121 - swift.C**1.121)
    assert plastic_work(swift, at)[0] == pytest.approx(exact, rel=1e-6, abs=1e-3)
    assert plastic_work(Linear(1e9, 2e10), at)[0] == pytest.approx(1e9 * peeq + 1e10 * peeq**2, rel=1e-13)
    corner = Tabulated((0.0, 0.1), (1e9, 2e9))
    exact = 1e9 * peeq + 5e9 * min(peeq, 0.1) ** 2 + 1e9 * max(peeq - 0.1, 0.0)
    assert plastic_work(corner, at)[0] == pytest.approx(exact, rel=1e-3)


def test_the_work_along_a_path_is_exact_for_straight_parts():
    """Of f = u at two places: half the squares, whatever the steps; from there back to where it began:
    nothing.
    """
    u = np.array([[0.0, 0.0], [1.0, -0.5], [1.5, 3.0], [0.0, 0.0]])
    assert along_path([u], [u]) == pytest.approx(0.5 * (u**2).sum(axis=1), abs=1e-15)
    assert along_path([u, u], [u, u])[2] == pytest.approx((u[2] ** 2).sum())


# --- SAM ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mu", [None, 0.4])
def test_an_elastic_body_gives_all_back(mu):
    """To rounding, also where pressure and traction each move the surface along the other."""
    found = of_sam.balance_of(sphere(mu=mu))
    assert of_cells(found) < 1e-13 and abs(found.work[-1]) < 1e-13 * found.work[found.peak]
    assert not found.dissipated.any() and not found.flowed.any()


@pytest.mark.parametrize("component", [1, 3])
def test_coefficients_that_are_not_reciprocal_create_energy(monkeypatch, component):
    """u_x of the pressure, or u_z of the traction, too large by 0.1 %: a cycle of load no longer closes."""

    def wrong(*args, **which):
        cross = which["component"] == component and which["load"] == 4 - component
        return right(*args, **which) * (1.001 if cross else 1.0)

    assert of_cells(of_sam.balance_of(sphere(mu=0.4))) < 1e-13
    monkeypatch.setattr(of_sam, "displacement_coefficients", wrong)
    assert of_cells(of_sam.balance_of(sphere(mu=0.4))) > 1e-6


def test_sliding_to_and_fro_dissipates_in_each_cycle_and_still_balances():
    """Two cycles of alternating sign: 6e-4 of the work is missing at 5 cells in the radius, 1.6 % of it in 6
    steps; 0.8 % of it is plastic work of stresses that vary within the cells.
    """
    found = of_sam.balance_of(sphere(mu=0.4, law=PERFECT, loading={"steps": 6, "cycles": 2}))
    assert of_cells(found) < 1e-3 and of_steps(found) < 0.02 and 0 < within(found) < 0.01
    first, second = (np.flatnonzero(found.force == 0)[k] for k in (1, -1))
    assert found.dissipated[second] > 1.05 * found.dissipated[first] > 0
    assert (np.diff(found.dissipated) >= 0).all()


LAWS = (
    {"law": "perfect", "yield_stress": YIELD},
    {"law": "linear", "yield_stress": YIELD, "modulus": 1e10},
    {"law": "swift", "B": YIELD / 4**0.095, "C": 4.0, "n": 0.095},
)


@settings(max_examples=8, deadline=None, derandomize=True)
@given(
    st.sampled_from(LAWS),
    st.sampled_from([None, 0.1, 0.25]),
    st.floats(0.0, 0.45),
    st.floats(2.5, 3.5),
    st.floats(0.8, 1.25),
)
def test_any_yielding_contact_closes_its_balance(law, mu, poisson, ratio, aspect):
    """To 4e-3 of the work at 5 cells in the radius, whatever the law, Poisson's ratio and the shape of the
    cells.
    """
    scene = sphere(5, ratio, mu, law, {"steps": 3})
    body, (lx, ly) = scene.body.model_copy(update={"poisson": poisson}), scene.grid.extent
    grid = scene.grid.model_copy(update={"extent": (lx, ly * aspect)})
    found = of_sam.balance_of(scene.model_copy(update={"body": body, "grid": grid}))
    assert of_cells(found) < 4e-3 and found.dissipated[-1] > 0
    assert found.work[-1] == pytest.approx(found.flowed[-1] + found.stored[-1], abs=4e-3 * found.work.max())


def test_a_yielding_contact_dissipates_in_every_step_and_stores_what_its_residual_stress_holds(runs):
    for (model, *_), one in runs.items():
        assert (np.diff(one.dissipated) >= 0).all() and (np.diff(one.flowed) >= -1e-6 * one.work.max()).all()
        if model == SAM:  # nothing else is left
            assert one.elastic[-1] == close(one.stored[-1], 1e-12) and one.stored[-1] > 0
        else:
            assert of_cells(one) < 1e-8


def test_ladders_end_in_the_finest_balance_and_models_are_held_after_the_same_steps(runs):
    """What has no ladder has no order; with friction the counter-body does other work than the pressure."""
    values = gates(runs, 0.0)
    assert set(gates({run: runs[run] for run in ((SAM, 10, 6), (FEM, 6, 6))}, 0.0)) == {
        *("fem-cells", "work", "dissipated", "locked")
    }
    assert {name.rpartition("-")[0] for name in values if name not in gates(runs, 0.2)} == {
        *("sam", "fem", "sam-pressing", "fem-pressing")
    }
    assert values["sam-cells"].value == of_cells(runs[SAM, 10, 6])
    assert values["sam-steps"].value == of_steps(runs[SAM, 5, 24])
    assert values["locked"].expected == runs[FEM, 6, 6].elastic[-1]


def test_a_wrong_residual_displacement_creates_energy(monkeypatch, runs):
    """u_z of the plastic strain 1 % too large: the solver then solves another problem, and finds energy in
    it.
    """
    for module in (spectra, outside):
        monkeypatch.setattr(
            module,
            "surface_displacement_coefficients",
            lambda *args, **keys: 1.01 * surface_displacement_coefficients(*args, **keys),
        )
    spectra.spectra_of.cache_clear()
    wrong = of_sam.balance_of(sphere(10, law=PERFECT, loading={"steps": 6}))
    spectra.spectra_of.cache_clear()
    assert of_cells(wrong) > 1e-3 > of_cells(runs[SAM, 10, 6])


def test_a_wrong_return_to_the_yield_surface_dissipates_another_energy(monkeypatch, runs):
    """The accumulated strain 2 % too small, as of another norm: the dissipated energy no longer is that of
    the stress.
    """
    right = points.equivalent_strain
    monkeypatch.setattr(points, "equivalent_strain", lambda strain: 0.98 * right(strain))
    wrong = of_sam.balance_of(sphere(5, law=PERFECT, loading={"steps": 24}))
    assert of_steps(wrong) > 6e-4 > of_steps(runs[SAM, 5, 24])


# --- FEM ----------------------------------------------------------------------------------------------------


def test_a_state_out_of_balance_creates_energy():
    """Displacements of the peak moved by a thousandth below the surface."""
    model, steps = load_steps(sphere(6, law=PERFECT))
    assert of_cells(of_fem._of_steps(model, steps, of_fem._Axisymmetric(model))) < 1e-8
    wrong = [*steps[:-1], replace(steps[-1], state=_moved(model, steps[-1].state))]
    assert of_cells(of_fem._of_steps(model, wrong, of_fem._Axisymmetric(model))) > 1e-7


def _moved(model: Model, state):
    u = state.u.copy()
    u[~model.problem.fixed] *= 1.001
    return replace(state, u=u)


def test_an_elastic_counter_body_is_refused():
    other = CounterBody(shape="sphere", radius=RADIUS, young=210e9, poisson=0.3)
    for balance in (of_sam.balance_of, lambda one: of_fem.balance_of(one, FEM)):
        with pytest.raises(ValueError, match="counterbody"):
            balance(sphere(6).model_copy(update={"counterbody": other}))


def test_a_sliding_body_in_space_balances_to_the_residual_of_its_forces():
    """Half of it is modelled; elastic, 4 elements in the radius."""
    found = of_fem.balance_of(sphere(4, mu=0.3, loading={"steps": 1}), FEM_3D)
    assert of_cells(found) < 1e-8
    exact = of_sam.balance_of(sphere(10, mu=0.3, loading={"steps": 1}))
    assert found.work[1] == pytest.approx(exact.work[1], rel=0.02)


def test_errors_of_a_balance_by_hand():
    """Two cycles; each energy differs from what closes the balance by an amount of its own."""
    one = Balance(
        force=np.array([0.0, 2.0, 0.0, 2.0, 0.0]),
        approach=np.array([0.0, 2.0, 1.0, 3.0, 2.0]),
        work=np.array([0.0, 4.0, 3.0, 8.0, 7.0]),
        elastic=np.array([0.0, 2.0, 0.5, 2.5, 0.5]),
        dissipated=np.array([0.0, 1.0, 2.0, 3.0, 4.0]),
        flowed=np.array([0.0, 1.5, 2.0, 4.0, 4.5]),
        beyond=np.array([0.0, 0.1, 0.0, 0.1, 0.0]),
        back=np.array([0.0, 0.25, 0.0, 0.25, 0.0]),
        within=np.array([0.0, 0.2, 0.3, 0.4, 0.4]),
    )
    assert one.peak == 1 and one.pressing[1] == 2.0
    assert of_cells(one) == pytest.approx(2.4 / 8.0)
    assert of_steps(one) == pytest.approx(0.75 / 8.0) and within(one) == pytest.approx(0.4 / 8.0)
    assert pressing(one) == pytest.approx(0.5)
    assert cycle(one) == pytest.approx(4.0 / 2.0 - 1.0) and flow(one) == pytest.approx(2.5 / 2.0 - 1.0)


# --- back-stresses ------------------------------------------------------------------------------------------


def pressed_twice(steps, model):
    """(scene, balance) of a body with Prager's back-stress that alternates, two cycles."""
    kinematic = {"modulus": (150e9,)}
    given = pressed(1.5 * MELAN * 1e9, kinematic, cycles=2, steps=steps)
    grid = given.grid.model_copy(update={"cells": (13, 13), "layers": 10})
    fem = given.fem.model_copy(update={"cells_per_radius": 3})
    given = given.model_copy(update={"grid": grid, "fem": fem})
    return given, of_sam.balance_of(given) if model == SAM else of_fem.balance_of(given, model)


def of_second_cycle(one: Balance) -> float:
    """Plastic work over what is dissipated and newly stored in the second cycle, less 1."""
    first, second = np.flatnonzero(one.force == 0)[1:]
    spent = (one.dissipated + one.back)[second] - (one.dissipated + one.back)[first]
    return (one.flowed[second] - one.flowed[first]) / spent - 1


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_cycle_of_a_body_with_back_stresses_dissipates_its_work(model):
    """The gap falls at least to half with halved steps; cycles.csv has the same energies."""
    (_, coarse), (given, fine) = (pressed_twice(steps, model) for steps in (2, 4))
    table = solve(given, model).tables["cycles"]
    assert of_cells(fine) < (1e-8 if model == FEM else 1e-2)
    assert abs(of_second_cycle(fine)) < 0.1 and abs(of_second_cycle(fine)) < abs(of_second_cycle(coarse)) / 2
    ends = np.flatnonzero(fine.force == 0)
    assert table["dissipated_J"] == pytest.approx(np.diff(fine.dissipated[ends]), rel=1e-9)
    assert (np.diff(fine.dissipated) >= 0).all() and fine.back.max() > 0.1 * fine.dissipated[-1]
    without = replace(fine, back=0.0)
    assert of_steps(without) > 3 * of_steps(fine)
