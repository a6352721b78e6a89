# SPDX-License-Identifier: MIT
"""Balances of energy: their sums against closed forms, both models on small contacts, and gates that turn red
when one lies.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import PERFECT, RADIUS, hertz_force, scene
from hypothesis import given, settings, strategies as st
from made_results import context, red
from rounding import close

from fem_reference import Model, load_steps
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.patches import displacement_coefficients as right
from sam.plasticity import outside, points, spectra
from sam.scene import CounterBody, Scene, plastic_work
from sam.scene.yield_curve import Linear, Swift, Tabulated
from tests.system.test_repeated_loading import MELAN, pressed
from verification.cases.energy import energy as case
from verification.cases.energy.energy_measures import (
    compared_gates,
    fem_gates,
    of_cells,
    of_steps,
    of_stress_within,
    sam_gates,
)
from verification.cases.recipes import Resolution, resolved_at
from verification.energy import of_fem, of_sam
from verification.energy.balance import Balance, along_path
from verification.runs.models import FEM, FEM_3D, SAM, solve

YIELD = 1e9
PREFIX = "perfect-"


def changed(ladder: dict, **factors) -> dict:
    return {
        n: replace(one, **{name: getattr(one, name) * by for name, by in factors.items()})
        for n, one in ladder.items()
    }


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
def sam_ladders():
    by_cells = {n: of_sam.balance_of(sphere(n, law=PERFECT)) for n in (5, 7, 10)}
    by_steps = {n: of_sam.balance_of(sphere(5, law=PERFECT, loading={"steps": n})) for n in (6, 12, 24)}
    return by_cells, by_steps


@pytest.fixture(scope="module")
def fem_ladder():
    return {n: of_fem.balance_of(sphere(6, law=PERFECT, loading={"steps": n}), FEM) for n in (6, 12, 24)}


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
    assert of_cells(found) < 1e-3 and of_steps(found) < 0.02 and 0 < of_stress_within(found) < 0.01
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


def test_energies_of_a_yielding_contact_hold_their_gates(sam_ladders):
    by_cells, by_steps = sam_ladders
    assert red("energy", sam_gates(by_cells, by_steps, 0.0), PREFIX) == set()
    for one in by_cells.values():
        assert (np.diff(one.dissipated) >= 0).all() and (np.diff(one.flowed) >= -1e-6 * one.work.max()).all()
        assert one.elastic[-1] == close(one.stored[-1], 1e-12) and one.stored[-1] > 0  # nothing else is left


@pytest.mark.parametrize(
    ("field", "factor", "gates"),
    [
        ("within", 1.5, {"sam-within", "sam-cells", "sam-cells-order"}),
        ("work", 1.01, {"sam-cells", "sam-cells-order", "sam-pressing", "sam-pressing-order"}),
        ("flowed", 1.01, {"sam-cells", "sam-steps", "sam-cells-order", "sam-steps-order"}),
        ("dissipated", 1.01, {"sam-steps", "sam-steps-order"}),
        ("approach", 1.01, {"sam-pressing", "sam-pressing-order"}),
    ],
)
def test_an_energy_wrong_by_a_hundredth_turns_gates_red(sam_ladders, field, factor, gates):
    by_cells, by_steps = (changed(ladder, **{field: factor}) for ladder in sam_ladders)
    found = red("energy", sam_gates(by_cells, by_steps, 0.0), PREFIX)
    assert found and found <= gates


def test_a_wrong_residual_displacement_turns_gates_red(monkeypatch):
    """u_z of the plastic strain 1 % too large: the solver then solves another problem, and finds energy in
    it.
    """
    for module in (spectra, outside):
        monkeypatch.setattr(
            module, "surface_displacement_coefficients", scaled(surface_displacement_coefficients, 1.01)
        )
    spectra.spectra_of.cache_clear()
    by_cells = {n: of_sam.balance_of(sphere(n, law=PERFECT)) for n in (5, 7, 10)}
    spectra.spectra_of.cache_clear()
    assert red("energy", sam_gates(by_cells, by_cells, 0.0), PREFIX) >= {"sam-cells"}


def scaled(function, factor):
    return lambda *args, **keys: factor * function(*args, **keys)


def test_a_wrong_return_to_the_yield_surface_turns_gates_red(monkeypatch):
    """The accumulated strain 2 % too small, as of another norm: the dissipated energy no longer is that of
    the stress.
    """
    right = points.equivalent_strain
    monkeypatch.setattr(points, "equivalent_strain", lambda strain: 0.98 * right(strain))
    by_steps = {n: of_sam.balance_of(sphere(5, law=PERFECT, loading={"steps": n})) for n in (6, 12, 24)}
    assert red("energy", sam_gates(by_steps, by_steps, 0.0), PREFIX) >= {"sam-steps", "sam-steps-order"}


# --- FEM ----------------------------------------------------------------------------------------------------


def test_elements_hold_their_gates(fem_ladder):
    assert red("energy-fem", fem_gates(fem_ladder), PREFIX) == set()
    assert max(of_cells(one) for one in fem_ladder.values()) < 1e-8


@pytest.mark.parametrize("field", ["work", "elastic", "flowed"])
def test_elements_that_lose_energy_turn_red(fem_ladder, field):
    """By a millionth: the elements close to rounding."""
    wrong = changed(fem_ladder, **{field: 1 + 1e-6})[6]
    assert "fem-cells" in red("energy", compared_gates(wrong, wrong), PREFIX)


@pytest.mark.parametrize("field", ["work", "dissipated", "elastic"])
def test_models_that_disagree_turn_red(fem_ladder, field):
    fem = fem_ladder[6]
    gate = {"elastic": "locked"}.get(field, field)
    assert red("energy", compared_gates(changed({6: fem}, **{field: 1.04})[6], fem), PREFIX) == {gate}


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


def test_the_case_draws_its_panels_and_rows(sam_ladders, fem_ladder, tmp_path):
    pair = sam_ladders[0][5], fem_ladder[6]
    panels = {"perfect": pair, "sliding": (pair[0], None)}
    (plot,) = case.CASES[0].figures(case.EnergyBalances({}, [], panels, ()))
    figure = context("energy", tmp_path).save(plot)
    assert (tmp_path / figure.png).stat().st_size > 1000
    assert "FEM" in (tmp_path / figure.csv).read_text(encoding="utf-8")
    row = case.row("sphere", "SAM", 5, pair[0])
    assert len(row) == len(case.COLUMNS) and row[3] == "4"


def test_a_balance_knows_its_peak():
    zero = np.zeros(4)
    one = Balance(np.array([0.0, 1.0, 2.0, 0.0]), np.array([0.0, 1.0, 3.0, 1.0]), *(zero + 1.0,) * 4, zero)
    assert one.peak == 2 and one.pressing[2] == pytest.approx(0.5 + 3.0)


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
