# SPDX-License-Identifier: MIT
"""Plastic scenes in full slip, and given tractions that stand or travel. Small grids, 8 cells in the
radius.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from builders import SWIFT, SWIFT_YIELD as YIELD, hertz_force, scene as small_scene
from made_results import column, line
from plastic_start import begin, shrink_first_box

import sam
from sam.contact.convolution import Counters
from sam.contact.stress import Window
from sam.grid.cells import CellGrid
from sam.kernels.eigenstrain import displacement_parity, surface_displacement_coefficients
from sam.kernels.patches import STRESS, Cuboids, Lags, parity, stress_coefficients
from sam.plasticity import Extent, Strained, surface_displacement
from sam.plasticity.spectra import BoxOperator, mean_stress_of_load
from sam.results.snapshots import SHEAR
from sam.scene import Path, Plasticity, Scene, Solver, Status
from sam.scene.checkpoint import Checkpoint
from sam.schedule import Load
from verification.reference.hamilton import sliding_stress

NX, NY, ASPECT, NU, MU = 7, 6, 0.8, 0.3, 2.5
FACES = np.array([0.0, 0.4, 1.0, 1.7, 3.0])  # uneven layers
LAYERS = len(FACES) - 1
BOX = Cuboids(Lags(NX, NY, 1.0, ASPECT), tuple(FACES), NU)
A = 2.8e-6  # radius of given pressures
MIRROR = np.array([1, 1, 1, 1, -1, -1.0])  # of strain and stress under x -> -x


def scene(coefficient=0.3, ratio=3.0, cells=33, *, given=False, path=None, units=(1.0, 1.0), **more) -> Scene:
    """Swift steel; p0 of Hertz is `ratio` times the initial yield stress, the force that of a rigid
    sphere.
    """
    load = {"force": hertz_force(ratio * YIELD)}
    if given:
        load = {"prescribed": "hertz", "p0": ratio * YIELD, "radius": A, "path": path}
    return small_scene(
        *units,
        body={"plasticity": SWIFT},
        loading={"steps": 2, "unload": True, **load, **more.get("loading", {})},
        friction=None if coefficient is None else {"coefficient": coefficient, **more.get("friction", {})},
        grid=more.get("grid", {"cells": (cells, cells)}),
        solver=more.get("solver"),
    )


def plane(result, name="peeq", state="unloaded"):
    """(nx, nz) a column of the table of the plane in one state."""
    return column(result, "plane", name, state).reshape(result.discretisation["cells"][0], -1)


@pytest.fixture(scope="module")
def sliding():
    return sam.solve(scene())


@pytest.fixture(scope="module")
def standing():
    return sam.solve(scene(given=True, loading={"steps": 1}))


def direct_sum(kernel, sign, field):
    """Sum over the source cells of one layer, with the sign of the lag."""
    lx, ly = (np.arange(n)[:, None] - np.arange(n) for n in (NX, NY))
    matrix = kernel[np.abs(lx)[:, :, None, None], np.abs(ly)[None, None]]
    matrix = (
        matrix * np.where(lx < 0, sign[0], 1)[:, :, None, None] * np.where(ly < 0, sign[1], 1)[None, None]
    )
    return np.einsum("ikjm,km->ij", matrix, field)


def test_stress_of_traction_in_the_box_equals_direct_summation():
    """Pressure and a traction of its own field: 1e-12 of the largest value."""
    rng = np.random.default_rng(0)
    pressure, traction = rng.random((NX, NY)), rng.standard_normal((NX, NY))
    found = BoxOperator(BOX, MU, Counters(), sliding=True).stress(pressure, traction=traction)
    expected = np.zeros_like(found)
    for load, field in ((3, pressure), (1, traction)):
        kernel = mean_stress_of_load(BOX, load)
        for i, k in np.ndindex(6, LAYERS):
            expected[i, k] += direct_sum(kernel[i, k], parity(STRESS[i], load), field)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_cell_means_of_the_stress_of_a_traction():
    """Against 6 Gauss points each way, in each layer.

    Two points a direction leave 3 % in the layer that touches the patch, whose edge makes the stress
    logarithmic, 2 % below it and 0.5 % from a cell on (the pressure: 7, 0.6 and 0.5 %). Beyond the near field
    second differences are used: 1e-3.
    """
    t, w = np.polynomial.legendre.leggauss(6)
    depths = np.concatenate([(a + b) / 2 + (b - a) / 2 * t for a, b in pairwise(FACES)])
    mean = 0.0
    for a, wa in zip(t / 2, w / 2, strict=True):
        for b, wb in zip(t / 2, w / 2, strict=True):
            at = stress_coefficients(Lags(9, 8, 1.0, ASPECT), depths, NU, load=1, shift=(a, ASPECT * b))
            mean = mean + wa * wb * at
    mean = np.tensordot(mean.reshape(6, LAYERS, 6, 9, 8), w / 2, axes=(2, 0))
    error = np.abs(mean_stress_of_load(Cuboids(Lags(9, 8, 1.0, ASPECT), tuple(FACES), NU), 1) - mean)
    scale = np.abs(mean).max(axis=(0, 2, 3))
    assert (error.max(axis=(0, 2, 3)) < np.array([0.05, 0.03, 5e-3, 5e-3]) * scale).all()
    assert error[..., 5:, 5:].max() < 1e-3 * np.abs(mean[..., 5:, 5:]).max()


def test_the_box_sees_hamiltons_stresses():
    """Given tractions, 24 cells across, layers of 0.08 a from 0.3 a on: 0.5 % of p0 in each component."""
    h, layers = 1 / 12, np.array([0.0, 0.26, 0.34, 0.66, 0.74, 1.16, 1.24])
    n = 31
    x = (np.arange(n) - (n - 1) / 2) * h
    given = sam.plan(scene(0.4, given=True)).given
    pressure = given.pressure(CellGrid(n, n, h * A, h * A, layers), Load(given.peak_force)) / given.p0
    operator = BoxOperator(Cuboids(Lags(n, n, h, h), tuple(layers), 0.3), 1.0, Counters(), sliding=True)
    found = operator.stress(pressure, traction=0.4 * pressure)
    for k in (1, 3, 5):
        depth = (layers[k] + layers[k + 1]) / 2
        exact = np.moveaxis(
            sliding_stress(x[:, None], x[None, :], depth, 1.0, contact_radius=1.0, nu=0.3, friction=0.4),
            -1,
            0,
        )
        assert np.abs(found[:, k] - exact).max() < 5e-3


def test_a_traction_of_a_field_of_coefficients():
    """The coefficient may differ from cell to cell: q = coefficient * p in the gap and in the stress."""
    model, now = begin(scene())
    rng, problem = np.random.default_rng(5), model.problem(now.extent)
    field = rng.random(now.state.pressure.shape)
    pressure, keep = now.state.pressure, problem.operator.keep  # a smooth scene is mirrored in y
    found = replace(problem, coefficient=field).stress(pressure, Load(1.0, sign=-1.0))
    loaded = pressure * problem.unit
    expected = problem.operator.stress(keep(loaded), traction=keep(-field * loaded))
    assert np.array_equal(found, expected)


def test_converged_with_the_current_traction(sliding):
    """Residuals of the returned fields, the gap with the traction of the returned pressure among them."""
    certificate = sliding.certificate
    assert sliding.status is Status.CONVERGED
    assert certificate["yield_excess"] <= 1e-6 and certificate["flow_residual"] <= 1e-6
    assert certificate["gap_in_contact"] < 2e-8 and certificate["penetration"] < 2e-8
    assert certificate["yield_excess_outside_box"] == 0.0
    assert sliding.quantities["friction_coefficient"] == pytest.approx(0.3, rel=1e-12)


def test_the_other_way_is_the_mirror_image():
    """One step with q along +x and one along -x: everything mirrored, to the tolerance of the step."""
    force, found = sam.plan(scene()).schedule.peak.force, {}
    for sign in (1.0, -1.0):
        model, now = begin(scene())
        trial = model.problem(now.extent).step(now.state, Load(force, sign))
        assert trial.converged
        found[sign] = now.extent, trial.increment.strain
    (there, strain), (back, other) = found.values()
    assert there == back
    mirrored = MIRROR[:, None, None, None] * strain[:, :, ::-1]
    scale = np.abs(strain).max()
    assert _on_grid(back, other) == pytest.approx(_on_grid(there, mirrored, True), abs=1e-5 * scale)


def _on_grid(extent: Extent, field, mirrored=False, n=33):
    out = np.zeros((*field.shape[:2], n, n))
    i0 = n - extent.window.i0 - extent.window.nx if mirrored else extent.window.i0
    out[:, :, i0 : i0 + extent.window.nx, extent.window.j0 : extent.window.j0 + extent.window.ny] = field
    return out


def test_without_coefficient_every_bit_is_that_of_no_friction():
    plain, zero = sam.solve(scene(None)), sam.solve(scene(0.0))
    assert zero.quantities == plain.quantities
    assert np.array_equal(plane(plain), plane(zero))
    for result in (plain, zero):
        assert result.discretisation["tangential_kernels"] == 0


def test_decoupled_keeps_the_pressure_in_the_middle(sliding):
    """Coupled: it leans back. Decoupled: only by the plastic strain, several times less."""
    decoupled = sam.solve(scene(friction={"coupling": False}))
    lean = {}
    for name, result in (("coupled", sliding), ("decoupled", decoupled)):
        p, x = line(result, "p_Pa", "peak"), line(result, "x_m", "peak")
        lean[name] = float((p * x).sum() / p.sum()) / 3e-6
    assert lean["coupled"] < -0.02 and abs(lean["decoupled"]) < 0.2 * abs(lean["coupled"])
    assert decoupled.left_out[0].stage == "coupling"


def test_the_first_box_does_not_matter(monkeypatch, sliding):
    """Started on a box that is too small in all directions, it grows, by sides, to the same answer."""
    shrink_first_box(monkeypatch, x=5, y=3, less=6, layers=5)
    other = sam.solve(scene())
    assert other.status is Status.CONVERGED
    for name in (
        "peeq_max",
        "residual_uz_center_m",
        "residual_ux_center_m",
        "tangential_displacement_center_m",
    ):
        assert other.quantities[name] == pytest.approx(sliding.quantities[name], rel=1e-4)


def test_units_do_not_matter(sliding):
    other = sam.solve(scene(units=(3.1e4, 7.3e-5)))
    assert other.cost["operator_applications"] == sliding.cost["operator_applications"]
    assert other.quantities["peeq_max"] == pytest.approx(sliding.quantities["peeq_max"], rel=1e-9)
    for name in ("residual_ux_center_m", "plastic_shear_center_m"):
        assert other.quantities[name] / 3.1e4 == pytest.approx(sliding.quantities[name], rel=1e-7)


def test_the_papers_loops_slide_too():
    """Coarse steps: the yield condition met, and a largest plastic strain that is off by percents, as without
    friction.
    """
    right = sam.solve(scene(loading={"steps": 1}))
    wrong = sam.solve(scene(loading={"steps": 1}, solver=Solver(method="paper", tolerance=1e-4)))
    assert wrong.status is Status.CONVERGED
    assert wrong.certificate["yield_excess"] < 1e-3 and wrong.certificate["flow_residual"] > 1e-2
    assert 1.02 < wrong.quantities["peeq_max"] / right.quantities["peeq_max"] < 2


def test_surface_along_x_by_plastic_strain_is_a_direct_sum():
    """Component 1 of the general routine, on a window that is not the box; the coefficients have their own
    tests.
    """
    strain = np.random.default_rng(2).standard_normal((6, LAYERS, NX, NY))
    source = Strained(strain, Window(4, 3, NX, NY), BOX)
    found = surface_displacement(source, Window(0, 5, 15, 1), counters=Counters(), component=1)
    kernel = surface_displacement_coefficients(
        Cuboids(Lags(15, 15, 1.0, ASPECT), tuple(FACES), NU), component=1
    )
    for x in (0, 6, 14):
        total = 0.0
        for i, j, b in np.ndindex(NX, NY, 6):
            lx, ly = x - 4 - i, 5 - 3 - j
            sx, sy = displacement_parity(1, b)
            sign = (sx if lx < 0 else 1) * (sy if ly < 0 else 1)
            total += sign * kernel[b, :, abs(lx), abs(ly)] @ strain[b, :, i, j]
        assert found[x, 0] == pytest.approx(total, rel=1e-10)


def test_a_wide_sheared_layer_carries_its_surface_by_the_shear():
    """Plastic shear in a layer without end leaves no stress: u_x = -2 e_13 times its thickness, what
    `plastic_shear_m` is.

    Of width L and thickness t the ends add of the order of t/L: 4 % at 60 thicknesses, half of it at twice
    the width.
    """
    errors = []
    for n in (61, 121):
        strain = np.zeros((6, 1, n, n))
        strain[SHEAR] = 1e-3
        window = Window(0, 0, n, n)
        source = Strained(strain, window, Cuboids(Lags(n, n, 1.0, 1.0), (0.0, 1.0), NU))
        ux = surface_displacement(source, window, counters=Counters(), component=1)
        errors.append(abs(ux[n // 2, n // 2] / -2e-3 - 1))
    assert errors[0] < 0.04 and errors[1] == pytest.approx(errors[0] / 2, rel=0.1)


def test_plastic_flow_drags_the_surface_along(sliding):
    """Traction along +x leaves the centre displaced to +x, and the material below sheared the same way."""
    q = sliding.quantities
    assert q["tangential_displacement_center_m"] > q["residual_ux_center_m"] > 0
    assert q["plastic_shear_center_m"] > 0
    assert line(sliding, "ux_m", "unloaded")[16] == pytest.approx(q["residual_ux_center_m"], rel=1e-12)


def test_given_pressure_stays_as_it_is(standing):
    """No contact is solved; the surface sinks in and the pressure does not notice. Not what has no meaning is
    null.
    """
    assert standing.status is Status.CONVERGED and standing.cost["contact_iterations"] == 0
    assert standing.quantities["p_max_Pa"] == pytest.approx(
        3 * YIELD, rel=2e-3
    )  # the mean of a cell of 0.12 a
    assert standing.quantities["approach_m"] is None and standing.quantities["residual_uz_center_m"] > 0
    assert standing.quantities["contact_radius_m"] == pytest.approx(A, rel=1e-12)
    assert standing.certificate["flow_residual"] <= 1e-6 and standing.certificate["yield_excess"] <= 1e-6


def travelling(distance, steps, **more):
    """The grid is chosen from radius and path."""
    path = Path(start=(-distance, 0.0), end=(distance, 0.0), steps=steps)
    return scene(given=True, path=path, grid=more.pop("grid", None), **more)


def test_loads_far_apart_do_what_each_would_do_alone(monkeypatch, standing):
    """In one step from one place to another: at each the plastic strain of a load that stands there.

    The first place exactly. At the second one the stress of the strain at the first one counts, which falls
    with the third power of the distance: 1.0 % at 2.9 a, and at 1.5 times the distance less by 1.5^3 at
    least.
    """
    monkeypatch.setattr("sam.grid.smooth.PLASTIC_CELLS", 33)
    h, alone, half, second = standing.discretisation["cell_m"][0], plane(standing), 10, []
    around = slice(len(alone) // 2 - half, len(alone) // 2 + half + 1)
    for away in (12, 18):
        result = sam.solve(travelling(away * h, 1, loading={"steps": 1}))
        assert result.status is Status.CONVERGED
        assert result.discretisation["cell_m"][0] == pytest.approx(h, rel=1e-12)
        both = plane(result)
        places = [len(both) // 2 + shift for shift in (-away, away)]
        errors = [np.abs(both[i - half : i + half + 1] - alone[around]).max() / alone.max() for i in places]
        assert errors[0] <= 1e-9
        second.append(errors[1])
    assert second[0] < 0.012 and second[1] < second[0] / 1.5**3
    history = result.tables["history"]
    assert "load at x" in history["note"][1] and list(history["step"]) == [1, 2, 3]
    assert line(result, "p_Pa", "peak").argmax() == len(both) // 2 + away


def test_a_travelling_load_leaves_a_track(monkeypatch):
    """In small steps: the plastic strain in the middle of the track is the same at neighbouring places; the
    ends are not.
    """
    monkeypatch.setattr("sam.grid.smooth.PLASTIC_CELLS", 25)
    result = sam.solve(travelling(2 * A, 12, solver=Solver(tolerance=1e-4)))
    track = plane(result).max(axis=1)
    n = len(track) // 2
    assert result.status is Status.CONVERGED
    assert np.ptp(track[n - 3 : n + 4]) < 0.05 * track[n] and track[0] == track[-1] == 0.0


def test_targets_of_a_path():
    path = Path(start=(-4e-6, 1e-6), end=(2e-6, 1e-6), steps=3)
    options = {
        "loading": {"steps": 2, "cycles": 2, "unload": False},
        "friction": {"direction": "alternating"},
    }
    targets = sam.plan(scene(given=True, path=path, grid=None, **options)).schedule.targets
    places = [
        (t.cycle, t.step, round(t.load.x * 1e6, 9), round(t.load.force / targets[1].load.force, 9))
        for t in targets
    ]
    assert places[:6] == [
        (1, 1, -4, 0.5),
        (1, 2, -4, 1),
        (1, 3, -2, 1),
        (1, 4, 0, 1),
        (1, 5, 2, 1),
        (1, 6, 2, 0),
    ]
    assert len(targets) == 11 and targets[-1].snapshot == "peak"
    assert {t.load.sign for t in targets if t.cycle == 1} == {1.0}
    assert {t.load.sign for t in targets if t.cycle == 2} == {-1.0}
    unloaded, next_one = targets[5].load, targets[6].load
    assert unloaded.halfway_to(next_one) == replace(next_one, force=next_one.force / 2)


def test_half_the_way_is_half_of_all_that_a_load_gives():
    pressed, moved = Load(2.0, x=1.0, y=-3.0, misfit=0.25), Load(6.0, x=2.0, y=1.0, misfit=0.75)
    assert pressed.halfway_to(moved) == Load(4.0, x=1.5, y=-1.0, misfit=0.5)
    assert Load.by_approach(2.0).halfway_to(Load.by_approach(3.0)).approach == 2.5


def test_continued_from_a_checkpoint_bit_by_bit():
    """From the middle of a path, and of cycles whose traction alternates."""
    path = Path(start=(-A / 2, 0.0), end=(A / 2, 0.0), steps=2)
    options = {"loading": {"steps": 1, "cycles": 2}, "friction": {"direction": "alternating"}, "cells": 25}
    a_scene = scene(given=True, path=path, **options)
    kept: list[Checkpoint] = []
    whole = sam.solve(a_scene, checkpoint=kept.append)
    for start in (kept[1], kept[-2]):
        again = sam.solve(a_scene, start=start)
        assert again.quantities == whole.quantities
        assert np.array_equal(plane(again), plane(whole))
        assert again.discretisation["tangential_kernels"] == whole.discretisation["tangential_kernels"]


def test_alternating_traction_strains_the_other_side_too():
    """Perfectly plastic, two cycles: the constant traction has shaken down; the reversed one strains the
    mirrored places.
    """
    strain, results = {}, {}
    for direction in ("constant", "alternating"):
        a_scene = scene(0.3, 2.5, friction={"direction": direction}, loading={"cycles": 2})
        body = a_scene.body.model_copy(update={"plasticity": Plasticity(law="perfect", yield_stress=YIELD)})
        results[direction] = sam.solve(a_scene.model_copy(update={"body": body}))
    for direction, result in results.items():
        first, second = result.tables["cycles"]["peeq_max"]
        assert result.status is Status.CONVERGED
        assert second == pytest.approx(first, rel=1e-5)
        strain[direction] = plane(result)
    aside = {direction: np.abs(each - each[::-1]).sum() for direction, each in strain.items()}
    assert strain["alternating"].sum() > 1.15 * strain["constant"].sum()
    assert aside["alternating"] < 0.7 * aside["constant"]
    cycles = results["alternating"].tables["cycles"]
    assert cycles["friction_coefficient"] == pytest.approx([0.3] * 2) and cycles["friction_sign"] == [1, -1]
    assert "friction_sign" not in results["constant"].tables["cycles"]
