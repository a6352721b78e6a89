# SPDX-License-Identifier: MIT
"""Plastic scenes through the semi-analytical solver: return map, convergence, history. Small grids, 8 cells
in the radius.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import MODULUS, PERFECT, RADIUS, SWIFT, hertz_force, scene as small_scene
from made_results import column
from plastic_start import begin, shrink_first_box
from scipy.optimize import brentq

import sam
import sam.plasticity.spectra as spectra
from sam import choose_grid
from sam.contact.convolution import Counters
from sam.elastic.history import solve_elastic
from sam.grid.smooth import LAYERS_IN_PROFILE
from sam.kernels.layer_stress import CornerFunctions, LayerStress, mesh
from sam.kernels.patches import Lags
from sam.planner.make import schedule_of
from sam.plasticity import load_step as plastic_step
from sam.plasticity.flow import contraction, deviator, equivalent_strain, plastic_multiplier
from sam.plasticity.history import committed
from sam.scene import Scene, Solver, Status
from sam.scene.yield_curve import Linear, Swift, Tabulated
from sam.schedule import Load

YIELD = {"swift": 945e6 * 20**0.121, "perfect": 1e9}


def force_of(ratio, law="swift"):
    """Force at which the Hertz pressure is `ratio` times the initial yield stress."""
    return hertz_force(ratio * YIELD[law])


def scene(ratio, plasticity=SWIFT, cells=33, *, grid=None, solver=None, units=(1.0, 1.0), **loading) -> Scene:
    return small_scene(
        *units,
        body={"plasticity": plasticity},
        loading={"force": force_of(ratio, plasticity["law"]), "steps": 4, "unload": True, **loading},
        grid={"cells": (cells, cells), **(grid or {})},
        solver=solver,
    )


@pytest.fixture(scope="module")
def swift4():
    return sam.solve(scene(4))


CURVES = {
    "swift": Swift(945e6, 20, 0.121),
    "linear": Linear(1e9, 10.5e9),
    "perfect": Linear(1e9),
    "table": Tabulated((0.0, 1e-3, 5e-3), (1e9, 1.4e9, 1.5e9)),
    "convex table": Tabulated((0.0, 1e-3, 2e-3), (1e9, 1.01e9, 2e9)),
}


@pytest.mark.parametrize("name", CURVES)
def test_plastic_multiplier_solves_the_return_map(name):
    """q - 3 m g = factor sigma_y(alpha + g), against a bracketing root finder, from just above yield to ten
    times it.
    """
    curve, m3, factor = CURVES[name], 3 * 80.8e9, 0.8
    for alpha in (0.0, 7e-4, 3e-3):
        q = (factor * float(curve.stress(alpha))) * np.array([0.5, 1.0 + 1e-9, 1.01, 2.0, 10.0])
        found = plastic_multiplier(q, np.full(5, alpha), curve, np.full(5, factor), m3=m3)
        assert found[0] == 0.0
        for near in (0.5, 2.0):
            from_there = plastic_multiplier(
                q, np.full(5, alpha), curve, np.full(5, factor), m3=m3, near=near * found
            )
            assert from_there == pytest.approx(found, rel=1e-12, abs=1e-17)
        for value, gamma in zip(q[1:], found[1:], strict=True):

            def excess(g, value=value, alpha=alpha):
                return value - m3 * g - factor * float(curve.stress(alpha + g))

            assert gamma == pytest.approx(
                brentq(excess, 0.0, value / m3, xtol=1e-18, rtol=1e-14), rel=1e-9, abs=1e-17
            )


def test_a_point_that_has_its_multiplier_keeps_it_while_the_others_are_sought(monkeypatch):
    """Else it leaves the answer, and all points take as many iterations as a bisection."""
    curve, m3 = CURVES["swift"], 3 * 80.8e9
    rng, asked = np.random.default_rng(1), []
    alpha = rng.uniform(0.0, 0.06, 2000)
    q = curve.stress(alpha) * rng.uniform(1.0, 6.0, 2000)
    near = plastic_multiplier(q, alpha, curve, np.ones(2000), m3=m3) * rng.uniform(0.8, 1.2, 2000)

    def counted(self, peeq):
        asked.append(peeq)
        return self.B * (self.C + self.alpha * peeq) ** self.n

    monkeypatch.setattr(Swift, "stress", counted)
    found = plastic_multiplier(q, alpha, curve, np.ones(2000), m3=m3, near=near)
    assert len(asked) <= 10  # of 50
    np.testing.assert_allclose(q - m3 * found, curve.stress(alpha + found), rtol=1e-13)


def test_tensor_helpers():
    stress = np.array([3.0, 1.0, -1.0, 0.5, -2.0, 1.5])
    assert deviator(stress)[:3].sum() == pytest.approx(0.0)
    full = np.array([[3.0, 1.5, -2.0], [1.5, 1.0, 0.5], [-2.0, 0.5, -1.0]])
    assert contraction(stress, stress) == pytest.approx((full * full).sum())
    assert equivalent_strain(np.array([-0.5, -0.5, 1.0, 0, 0, 0])) == pytest.approx(1.0)


def test_converged_in_every_cell(swift4):
    """Both residuals below the tolerance, contact checked on the full grid, nothing yields outside
    the box.
    """
    certificate = swift4.certificate
    assert swift4.status is Status.CONVERGED
    assert certificate["yield_excess"] <= 1e-6 and certificate["flow_residual"] <= 1e-6
    assert certificate["yield_excess_outside_box"] == 0.0
    assert certificate["gap_in_contact"] < 2e-8 and certificate["penetration"] < 2e-8
    assert certificate["load_error"] < 1e-12


def test_stress_is_on_the_yield_surface_where_it_strained(swift4):
    """Table against the law: where the axis yielded and does so at the peak, each point of a cell has its
    yield stress; the mean of their stresses is within that of their mean strain, by less than 0.2 %.
    """
    axis = {name: np.asarray(column) for name, column in swift4.tables["axis"].items()}
    peak = axis["state"] == "peak"
    curve = CURVES["swift"]
    strained = peak & (axis["peeq"] > 1e-5)
    assert strained.sum() >= 6
    share = axis["mises_Pa"][strained] / curve.stress(axis["peeq"][strained])
    assert (share > 1 - 2e-3).all() and (share < 1 + 1e-5).all()
    assert (axis["mises_Pa"][peak & (axis["peeq"] == 0)] <= curve.stress(0.0) * (1 + 1e-6)).all()


def test_one_and_a_half_times_the_yield_stress_is_elastic():
    """First yield is at 1.6128: no operator is built, and the answer is that of the elastic solver bit for
    bit.
    """
    a_scene = scene(1.5)
    result = sam.solve(a_scene)
    assert result.quantities["peeq_max"] == 0.0 and result.cost["operator_applications"] == 0
    assert any(entry.stage == "eigenstrain kernels" for entry in result.left_out)
    plan = sam.plan(a_scene)
    rows = solve_elastic(plan.problem(Counters()), lambda *_: None).rows
    assert result.tables["history"]["p_max_Pa"][3] == rows[3].p_max


def test_reloading_adds_no_plastic_strain(swift4):
    """Two cycles on Swift steel: unloading is elastic, and the second loading strains nothing."""
    result = sam.solve(scene(4, cycles=2))
    history = result.tables["history"]
    assert result.status is Status.CONVERGED
    assert history["peeq_max"][3] == pytest.approx(swift4.quantities["peeq_max"], rel=0.02)
    assert history["peeq_max"][8] - history["peeq_max"][3] <= 1e-6 * history["peeq_max"][3]
    assert "one step" in history["note"][4] and history["note"][9] == history["note"][4]
    assert result.tables["cycles"]["peeq_max"][0] == pytest.approx(
        result.tables["cycles"]["peeq_max"][1], rel=1e-6
    )


def test_unloading_leaves_a_dent_and_residual_stress(swift4):
    line, history = swift4.tables["line"], swift4.tables["history"]
    unloaded = np.array([state == "unloaded" for state in line["state"]])
    uz = np.asarray(line["uz_m"])[unloaded]
    assert uz[16] == pytest.approx(swift4.quantities["residual_uz_center_m"], rel=1e-12)
    assert uz[16] == uz.max() > 0 and np.asarray(line["p_Pa"])[unloaded].max() == 0.0
    assert uz == pytest.approx(uz[::-1], rel=1e-6)  # a symmetric dent
    assert swift4.quantities["residual_mises_max_Pa"] > 0.05 * YIELD["swift"]
    assert history["force_N"][-1] == 0.0 and "one step" in history["note"][-1]


def test_the_first_box_does_not_matter(monkeypatch, swift4):
    """Started on a box that is too small in all directions, it grows to the same answer."""
    shrink_first_box(monkeypatch, x=3, y=3, less=6, layers=5)
    other = sam.solve(scene(4))
    assert other.status is Status.CONVERGED
    assert other.quantities["peeq_max"] == pytest.approx(swift4.quantities["peeq_max"], rel=1e-5)
    assert other.quantities["residual_uz_center_m"] == pytest.approx(
        swift4.quantities["residual_uz_center_m"], rel=1e-4
    )


def test_units_do_not_matter(swift4):
    """Stresses times 7.3e-5, lengths times 3.1e4: the same iterations, results equal to 1e-9 (the tolerance
    is 1e-6).
    """
    other = sam.solve(scene(4, units=(3.1e4, 7.3e-5)))
    assert other.cost["operator_applications"] == swift4.cost["operator_applications"]
    assert other.quantities["peeq_max"] == pytest.approx(swift4.quantities["peeq_max"], rel=1e-9)
    assert other.quantities["p_max_Pa"] / 7.3e-5 == pytest.approx(swift4.quantities["p_max_Pa"], rel=1e-9)


def test_a_step_too_large_is_cut(monkeypatch):
    """With few iterations allowed, one step to p0 = 3 of perfect plasticity is cut until it converges, and
    says so.
    """
    monkeypatch.setattr(plastic_step, "ITERATIONS", 8)
    result = sam.solve(scene(2.5, PERFECT, steps=1))
    assert result.status is Status.CONVERGED and result.cost["step_cuts"] >= 1
    assert "cut into" in result.tables["history"]["note"][0]


def test_a_step_that_cannot_converge_ends_in_the_cut_limit(monkeypatch):
    monkeypatch.setattr(plastic_step, "ITERATIONS", 1)
    monkeypatch.setattr(plastic_step, "LONG_ITERATIONS", 1)
    result = sam.solve(scene(3, PERFECT, steps=1))
    assert result.status is Status.STEP_CUT_LIMIT and "steps" in result.message


def test_many_steps_in_single_precision_leave_the_contact_within_its_limit():
    """The displacement by plastic strain is a sum over the steps, 1e-7 of each off that of the full grid."""
    tolerance = spectra.SINGLE
    result = sam.solve(scene(4.8, PERFECT, steps=16, unload=False, solver={"tolerance": tolerance}))
    assert result.converged
    assert result.certificate["gap_in_contact"] <= 2 * plastic_step.CONTACT_SHARE * tolerance + 2e-9
    in_box = result.tables["history"]["p_max_Pa"][-1]
    assert result.quantities["p_max_Pa"] == pytest.approx(in_box, rel=1e-4)


def test_a_trial_that_did_not_converge_is_not_committed():
    a_scene = scene(3)
    model, now = begin(a_scene)
    trial = model.problem(now.extent).step(now.state, Load(a_scene.loading.force))
    assert trial.converged
    with pytest.raises(ValueError, match="did not converge"):
        now.state.after(replace(trial, converged=False))


def test_a_step_starts_from_the_last_one_without_an_operator():
    """The change of a step is what the operator makes of its increment; scaled, it is where the next step
    starts.
    """
    a_scene = scene(3, unload=False)
    model, now = begin(a_scene)
    problem, counters, force = model.problem(now.extent), model.counters, a_scene.loading.force
    now = committed(model, now, problem.step(now.state, Load(0.5 * force)), None)
    applied, iterations = counters.operator_applications, counters.plastic_iterations
    change, guess = now.change, now.guess(Load(force))
    assert np.array_equal(guess.strain, change.strain)
    assert np.array_equal(guess.residual.displacement, change.residual.displacement)
    trial = problem.step(now.state, Load(force), guess=guess)
    assert counters.operator_applications - applied == counters.plastic_iterations - iterations > 0
    expected = problem.residual(problem.virgin().residual, change.strain)
    for name in ("displacement", "stress"):
        found, right = getattr(change.residual, name), getattr(expected, name)
        assert np.abs(found - right).max() <= 1e-6 * np.abs(right).max()
    done, start = counters.plastic_iterations, {"guess": trial.change(now.state), "start": trial.pressure}
    again = problem.step(now.state, trial.load, **start)
    residual = trial.residual.displacement
    assert counters.plastic_iterations == done
    assert again.residual.displacement == pytest.approx(residual, abs=1e-12 * np.abs(residual).max())
    unstressed = replace(start["guess"].residual, stress=0 * expected.stress)
    problem.step(now.state, trial.load, **start | {"guess": replace(start["guess"], residual=unstressed)})
    assert counters.plastic_iterations > done


def test_plastic_zone_at_the_edge_of_the_grid_is_said():
    """Layers that end inside the plastic zone."""
    result = sam.solve(scene(4, grid={"layers": 6, "depth": 2.5e-6}))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "grid." in result.message


def test_a_soft_layer_strains_first():
    """The factor over depth: half the yield stress in the top 0.3 a moves the largest strain there."""
    profile = ((0.0, 0.5), (0.9e-6, 0.5), (1.0e-6, 1.0))
    result = sam.solve(scene(3, {**SWIFT, "profile": profile}, cells=41))
    plain = sam.solve(scene(3, cells=41))
    assert result.status is Status.CONVERGED
    soft, even = (
        axis["peeq"][axis["z_m"] < 0.9e-6].max() for axis in (result.tables["axis"], plain.tables["axis"])
    )
    assert soft > 5 * even


def test_layers_of_cells_end_where_the_yield_stress_has_a_kink():
    """A weak layer 0.32 radii thick strains 14 % more than one of 0.28, though both end in one row of cells
    1/8 high.
    """
    a, found = np.pi * 4 * YIELD["swift"] * RADIUS / (2 * MODULUS), []
    for thickness in (0.28, 0.32):
        profile = ((thickness * a, 0.1), (1.5 * thickness * a, 1.0))
        weak = scene(4, {**SWIFT, "B": 9450e6, "profile": profile}, unload=False)
        faces = choose_grid(weak).faces / a
        assert np.abs(faces - thickness).min() < 1e-9 > np.abs(faces - 1.5 * thickness).min()
        assert (
            np.diff(faces).min() > 0.05
            and np.count_nonzero(faces < 1.5 * thickness * (1 - 1e-9)) >= LAYERS_IN_PROFILE
        )
        found.append(sam.solve(weak).quantities["peeq_max"])
    assert found[1] / found[0] == pytest.approx(1.14, abs=0.04)  # 24 elements in the radius: 1.139


def test_rows_of_a_profile_that_make_no_layers():
    """Those nearer to one above than a fiftieth of a cell or so, those far below, and one alone."""
    a = np.pi * 4 * YIELD["swift"] * RADIUS / (2 * MODULUS)
    plain = choose_grid(scene(4)).faces
    for depths in ((0.0,), (5 * a,), (0.0, 1e-4 * a)):
        profile = tuple((z, 1.0) for z in depths)
        assert np.array_equal(choose_grid(scene(4, {**SWIFT, "profile": profile})).faces, plain)
    step = choose_grid(scene(4, {**SWIFT, "profile": ((0.3 * a, 0.5), (0.301 * a, 1.0))})).faces / a
    assert np.abs(step - 0.3).min() < 1e-9 < 5e-4 < np.abs(step - 0.301).min()


def test_the_largest_strain_at_the_face_of_a_layer_is_not_overshot():
    """Below a hard layer, and at the bottom of a soft one: no parabola through the kink there; it adds a
    tenth.
    """
    a = np.pi * 4 * YIELD["swift"] * RADIUS / (2 * MODULUS)
    grid = {"depths": tuple(a / 8 * np.arange(32))}
    for factor in (3.0, 0.5):
        profile = ((0.5 * a, factor), (0.55 * a, 1.0))
        result = sam.solve(scene(4, {**SWIFT, "profile": profile}, grid=grid, unload=False))
        assert result.status is Status.CONVERGED
        for name, table in (("peeq_max", "peeq"), ("mises_max_Pa", "mises_Pa")):
            largest = result.tables["plane"][table].max()
            assert result.quantities[name] == pytest.approx(largest, rel=0.01), (factor, name)


def test_the_papers_loops_meet_yield_but_not_the_flow_rule():
    """One load step: both stops leave the stress inside the yield surface, and a flow-rule residual of
    percents.
    """
    right = sam.solve(scene(4, steps=1))
    for stop in ("stress", "strain"):
        solver = Solver(method="paper", stop=stop, tolerance=1e-4)
        wrong = sam.solve(scene(4, steps=1, solver=solver))
        assert wrong.certificate["yield_excess"] < 1e-3
        assert wrong.certificate["flow_residual"] > 1e-2 > right.certificate["flow_residual"]
        assert wrong.quantities["peeq_max"] > 1.2 * right.quantities["peeq_max"]
        assert any("flow-rule residual" in text for text in wrong.warnings)


def test_budget_of_operator_applications(swift4):
    """Four load steps and one unloading at 1e-6: a counter, not seconds (measured 25)."""
    assert swift4.cost["operator_applications"] <= 32


def test_centre_values_of_the_stress_make_a_checkerboard(monkeypatch):
    """Why stresses are means over cells: with centre values, perfect plasticity strains neighbouring layers
    in turn.
    """

    def at_centre(means, points, *rest, **keys):
        functions = CornerFunctions(means.shape, mesh(Lags(*means.shape, 1.0, 1.0)))
        return LayerStress(functions, points.mean(axis=1, keepdims=True), *rest, **keys)

    def roughness(result):
        peeq = column(result, "axis", "peeq")
        inside = peeq[peeq > 0.3 * peeq.max()]  # not the ends of the zone, where the strain sets in
        return np.abs(np.diff(inside, 2)).max() / peeq.max()

    a_scene = scene(3, PERFECT, cells=41, steps=8, solver=Solver(tolerance=1e-4))
    smooth = roughness(sam.solve(a_scene))
    spectra.spectra_of.cache_clear()
    monkeypatch.setattr(spectra, "LayerStress", at_centre)
    rough = roughness(sam.solve(a_scene))
    spectra.spectra_of.cache_clear()
    assert rough > 3 * smooth


def test_unloading_in_steps_takes_equal_parts_of_the_force():
    loading = {"force": 0.4, "steps": 2, "unload": True, "unload_steps": 4}
    schedule = schedule_of(small_scene(body={"plasticity": SWIFT}, loading=loading))
    (unloading,) = (target for target in schedule.targets if not target.rises)
    steps = schedule.in_steps(unloading, schedule.peak)
    assert [step.load.force for step in steps] == pytest.approx([0.3, 0.2, 0.1, 0.0], rel=1e-12)
