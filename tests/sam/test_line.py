# SPDX-License-Identifier: MIT
"""A line contact in both models: coefficients of plane strain, images, line forces, full slip, passes."""

from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, MODULUS, STEEL

from fem_reference import plane_strain
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import mises, stiffness_tensor
from fem_reference.common.far_field import flamant, stretched
from fem_reference.plane_strain.recovery import stresses
from sam import solve
from sam.contact.convolution import Counters
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import ODD_Y, STRESS, Cuboids, Lags, displacement_coefficients, stress_coefficients
from sam.plasticity.spectra import BoxOperator
from sam.scene import Scene

NU, N = 0.3, 6
LINE = Lags(N, 1, 1.0, 40.0, period=1)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
PLANE = [STRESS.index(name) for name in ("11", "22", "33", "13")]


def between(low, high):
    return (low + high) / 2 + (high - low) / 2 * NODES, (high - low) / 2 * WEIGHTS


def line_force(load, x, z):
    """Stress 11 22 33 13 at (x, z) below a unit line force into the body or along x (Flamant)."""
    along = z if load == 3 else x
    radial = -2 / np.pi * along / (x * x + z * z) ** 2
    return np.stack([radial * x * x, NU * radial * (x * x + z * z), radial * z * z, radial * x * z])


@pytest.mark.parametrize("load", [1, 3])
def test_stress_below_a_strip_is_the_integral_of_line_forces(load):
    depths = np.array([0.7, 3.0, 30.0])
    s, w = between(-0.5, 0.5)
    x, z = np.arange(N)[None, :, None] - s, depths[:, None, None]
    exact = (line_force(load, x, z) * w).sum(axis=-1)
    found = stress_coefficients(LINE, depths, NU, load=load)[..., 0]
    assert found[PLANE] == pytest.approx(exact, abs=1e-11)
    assert not found[[3, 5]].any()


def test_displacement_of_a_strip_is_counted_from_half_of_its_length():
    s, w = between(-0.5, 0.5)
    x = np.arange(1, N)[:, None]
    exact = (1 - NU) / np.pi * -(np.log(np.abs(x - s) / 20.0) * w).sum(axis=-1)
    for component in (1, 3):
        found = displacement_coefficients(LINE, NU, component=component, load=component)[:, 0]
        assert found[1:] == pytest.approx(exact, rel=1e-12)
        assert found[0] == pytest.approx((1 - NU) / np.pi * (1 + np.log(40.0)), rel=1e-14)
    long = Lags(N, 1, 1.0, 1e5)  # its displacement has no logarithm, and tends as 1/length
    for component, load in ((3, 1), (1, 3)):
        found = displacement_coefficients(LINE, NU, component=component, load=load)
        assert found == pytest.approx(
            displacement_coefficients(long, NU, component=component, load=load), abs=2e-5
        )
        assert abs(found[1, 0]) == pytest.approx((1 - 2 * NU) / 4, rel=1e-14)


@pytest.mark.parametrize("component", [1, 3])
def test_strain_moves_the_surface_as_its_work_on_a_line_force_says(component):
    faces = (0.3, 1.0, 2.5)
    found = surface_displacement_coefficients(Cuboids(LINE, faces, NU), component=component)[..., 0]
    (s, w), x = between(-0.5, 0.5), np.arange(N)[:, None, None]
    for layer, (top, bottom) in enumerate(pairwise(faces)):
        z, v = between(top, bottom)
        # at the strained section, seen from the force at the observed point
        stress = line_force(component, s[:, None] - x, z) * (w[:, None] * v)
        exact = stress.sum(axis=(-2, -1)) * np.array([1, 1, 1, 2])[:, None]
        assert found[PLANE, layer] == pytest.approx(exact, abs=1e-10)


def test_residual_stress_of_a_section_balances_and_strain_along_the_line_acts_as_its_poisson_effect():
    """No force crosses a vertical cut, no traction the surface; e_yy acts by its Poisson effect."""
    cuboids = Cuboids(LINE, (0.5, 2.0), NU)
    parts = [between(0.0, 0.5), between(0.5, 2.0)] + [between(2.0**k, 2.0 ** (k + 1)) for k in range(1, 14)]
    z, w = (np.concatenate(each) for each in zip(*parts, strict=True))
    stress = residual_stress_coefficients(cuboids, z)[:, :, :, 0, :, 0]
    force = np.einsum("ijzx,z->ijx", stress, w)
    assert np.abs(force[np.ix_([0, 4], PLANE)]).max() < 1e-6
    assert np.abs(stress[0]).max() > 1
    at_surface = residual_stress_coefficients(cuboids, [0.0])
    assert np.abs(at_surface[[2, 3, 4]]).max() < 1e-11
    plane = [0, 2, 4]
    assert stress[plane, 1] == pytest.approx(NU * (stress[plane, 0] + stress[plane, 2]), abs=1e-12)
    inside = ((z > 0.5) & (z < 2.0))[:, None] * (np.arange(N) == 0)
    along = NU * (stress[0, 1] + stress[2, 1]) - 2 * (1 + NU) * inside  # in units of mu
    assert stress[1, 1] == pytest.approx(along, abs=1e-11)


def cylinder(p0=1e9, *, cells=None, length=2e-3, **tables):
    """(scene, half-width) of a rigid cylinder on steel under the force of an elastic p0."""
    a = 2 * p0 * 10e-3 / MODULUS
    shape = {"shape": "cylinder", "radius": 10e-3, "length": length}
    loading = {"force": np.pi / 2 * a * p0 * length} | tables.pop("loading", {})
    tables = {"body": STEEL, "loading": loading, **tables}
    if cells:
        tables["grid"] = {"cells": (cells, 1)}
    return Scene(counterbody={**shape, **tables.pop("other", {})}, **tables), a


@pytest.mark.parametrize("model, within", [(solve, (3e-4, 2e-3)), (plane_strain.solve, (3e-3, 4e-3))])
def test_full_slip_moves_the_contact_as_the_singular_integral_equation_says(model, within):
    """p ~ (a + x)^k (a - x)^(1 - k) about a centre, k = 1/2 + atan(beta mu)/pi: its centroid lies (8/3) (k -
    1/2) a beside the apex, and F' = pi E* a^2 k (1 - k)/R (Johnson 1985, Sec. 8.2).
    """
    nu, mu = 0.2, 0.5
    tables = {"body": {"young": 200e9, "poisson": nu}, "friction": {"coefficient": mu}}
    fem = {"cells_per_radius": 10, "box": 40.0}
    found = model(cylinder(cells=129, loading={"force": 1e3}, fem=fem, **tables)[0]).quantities
    shift = np.arctan((1 - 2 * nu) / (2 * (1 - nu)) * mu) / np.pi
    modulus = 200e9 / (1 - nu**2)
    a = np.sqrt(1e3 / 2e-3 * 10e-3 / (np.pi * modulus * (0.25 - shift**2)))
    assert found["pressure_centroid_x_m"] == pytest.approx(-8 / 3 * shift * a, rel=within[0])
    assert found["contact_half_width_m"] == pytest.approx(a, rel=within[1])


P0, SIDE = 2.5e9, 2 * 2.5e9 * 10e-3 / MODULUS  # of a cylinder that yields, and its half-width


def yielding(length=2e-3, other=None, **keys):
    """The result of a cylinder on linear hardening steel at p0 = 2.5 yield stresses."""
    loading = {"steps": 2, "unload": True, **keys}
    tables = {"body": {**STEEL, "plasticity": LINEAR}, "loading": loading, "other": other or {}}
    return solve(cylinder(P0, cells=33, length=length, **tables)[0])


def test_a_yielding_cylinder_knows_only_the_force_on_a_length_and_keeps_plane_strain():
    whole, short = yielding(), yielding(0.1e-3)  # narrower than the contact
    for name in ("peeq_max", "residual_uz_center_m", "p_max_Pa"):
        assert short.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-4)
    cells = whole.grids["unloaded"]["body"].cell_data
    strain, (s11, s22, s33, s23, _, s12) = cells["plastic_strain"], cells["stress_Pa"]
    assert not (strain[3].any() or strain[5].any() or s23.any() or s12.any())
    # elastic strain along y undoes what flow adds
    along = strain[1] + (s22 - STEEL["poisson"] * (s11 + s33)) / STEEL["young"]
    assert np.abs(along).max() < 1e-4 * np.abs(strain).max()


def test_a_pass_back_leaves_the_mirror_image_of_one_forth():
    tables = []
    for side in (-1.5 * SIDE, 1.5 * SIDE):
        path = {"start": (side, 0.0), "end": (-side, 0.0), "steps": 3}
        result = yielding(path=path, other={"slip": 0.0})
        tables.append(result.tables["track"])
        assert result.quantities["shoulder_side_m"] is None
    forth, back = tables
    assert np.max(forth["uz_m"]) > 1e-7
    assert back["uz_m"][::-1] == pytest.approx(forth["uz_m"], abs=1e-3 * np.max(forth["uz_m"]))


def layer(lags: Lags) -> Cuboids:
    return Cuboids(lags, (0.0, 0.6), NU)


PERIOD, IMAGES = 4, 300
ODD = ODD_Y.astype(bool)
ODD_BOTH = np.not_equal.outer(ODD, ODD)
COEFFICIENTS = {
    "displacement": (lambda lags: displacement_coefficients(lags, NU), np.array(False)),
    "stress": (lambda lags: stress_coefficients(lags, 0.4, NU, load=1)[:, 0], ODD),
    "strained surface": (lambda lags: surface_displacement_coefficients(layer(lags))[:, 0], ODD),
    "residual stress": (lambda lags: residual_stress_coefficients(layer(lags), 0.3)[:, :, 0, 0], ODD_BOTH),
}


@pytest.mark.parametrize("of, odd", COEFFICIENTS.values(), ids=COEFFICIENTS)
def test_what_repeats_along_y_is_the_sum_of_its_images_about_plane_strain(of, odd):
    found, strip = (of(Lags(N, *rest)) for rest in ((PERIOD, 1.0, 0.7, PERIOD), (1, 1.0, 0.7 * PERIOD, 1)))
    mean = found.mean(axis=-1, keepdims=True)
    assert mean == pytest.approx(strip / PERIOD, abs=1e-12)
    above, end = of(Lags(N, (IMAGES + 1) * PERIOD + 1, 1.0, 0.7)), (IMAGES + 0.5) * PERIOD
    lag = np.arange(PERIOD)[:, None] + PERIOD * np.arange(-IMAGES - 1, IMAGES + 1)
    weight = np.where((lag < 0) & odd[..., None, None, None], -1, 1) * (np.sign(end - np.abs(lag)) + 1) / 2
    images = (weight * above[..., np.abs(lag)]).sum(axis=-1)
    assert found - mean == pytest.approx(images - images.mean(axis=-1, keepdims=True), abs=3e-6)


def test_the_operator_of_a_box_that_repeats_knows_no_place_along_y_and_has_plane_strain_as_mean():
    random = np.random.default_rng(0)
    strain, p = random.standard_normal((6, 2, 7, 6)), random.random((7, 6))

    def stress(strain, p=None):
        ny = strain.shape[-1]
        box = Cuboids(Lags(7, ny, 1.0, 0.7, ny), (0.0, 0.5, 1.2), NU)
        operator = BoxOperator(box, 1.0, Counters())
        return operator.stress(p, operator.response(operator.transformed(strain)), p)

    moved = stress(np.roll(strain, 2, -1), np.roll(p, 2, -1))
    assert moved == pytest.approx(np.roll(stress(strain, p), 2, -1), abs=1e-12)
    mean = stress(strain.mean(axis=-1, keepdims=True))
    assert stress(strain).mean(axis=-1)[PLANE] == pytest.approx(mean[PLANE, ..., 0], abs=1e-11)


def test_a_wave_along_x_is_the_same_in_one_row_of_cells_and_in_four():
    (scene, a), found = cylinder(), []
    other, wave = scene.counterbody.model_dump(exclude_none=True), {"kind": "sinusoid", "amplitude": 2e-7}
    tables = {"body": STEEL, "counterbody": other, "loading": {"force": scene.loading.force}}
    for cells in ((64, 1), (64, 4)):
        grid = {"cells": cells, "extent": (4 * a, 2e-3), "periodic": "y"}
        result = solve(Scene(**tables, surface={**wave, "wavelength_x": 1e-4}, grid=grid))
        found.append([result.quantities[name] for name in ("p_max_Pa", "approach_m", "mises_max_Pa")])
    assert found[0] == pytest.approx(found[1], rel=1e-6)
    assert found[0][0] > 1.1e9


# finite elements in plane strain

YIELD = 400e6


def line(ratio=1.0, *, cells=4, box=10.0, plasticity=None, path=None, **loading):
    """ratio: largest elastic pressure over YIELD; path: half of it in half-widths."""
    a, other = 2 * ratio * YIELD * 10e-3 / MODULUS, {}
    if path is not None:
        loading["path"], other = (
            {"start": [-path * a, 0], "end": [path * a, 0], "step_per_radius": 2},
            {"slip": 0.0},
        )
    tables = {"body": {**STEEL, "plasticity": plasticity}, "fem": {"cells_per_radius": cells, "box": box}}
    return cylinder(ratio * YIELD, loading=loading, other=other, **tables)[0]


def test_line_force_stress():
    """The one radial stress of Flamant, -2 (P cos t + Q sin t)/(pi r); no displacement at the datum."""
    body, force, step = Elastic(3.0, 0.3), (2.0, -0.7), 1e-5
    r, t = np.array([0.5, 1.0, 3.0, 20.0]), np.array([0.3, -1.2, 1.5, -0.4])
    at = np.stack([r * np.sin(t), r * np.cos(t)])
    ends = [[flamant(force, body, at + s[:, None], 5.0) for s in (way, -way)] for way in step * np.eye(2)]
    slopes = [(after - before) / (2 * step) for after, before in ends]
    strain = np.stack([slopes[0][0], np.zeros(4), slopes[1][1], slopes[0][1] + slopes[1][0]])
    xx, yy, zz, xz = stiffness_tensor(3.0, 0.3) @ strain
    radial = -2.0 * (force[0] * np.cos(t) + force[1] * np.sin(t)) / (np.pi * r)
    expected = radial * np.array([np.sin(t) ** 2, np.cos(t) ** 2, np.sin(t) * np.cos(t)])
    np.testing.assert_allclose([xx, zz, xz], expected, atol=1e-8)
    np.testing.assert_allclose(yy, 0.3 * radial, atol=1e-8)
    edge = np.array([[5.0, -5.0], [0.0, 0.0]])
    assert np.abs(flamant((2.0, 0.0), body, edge, 5.0)[1]).max() < 1e-15
    assert np.abs(flamant((0.0, -0.7), body, edge, 5.0)[0]).max() < 1e-15


def test_strain_far_away():
    """By flat plastic strain, and by its depth: derivatives of line forces along the surface."""
    body, at = Elastic(3.0, 0.3), np.array([[2.0, -1.0, 0.3], [0.0, 0.7, 1.5]])

    def moved(forces, shift):
        return flamant(forces, body, at - np.array([[shift], [0.0]]), 1.0)

    unit, step = 3.0 / (1.0 - 0.3**2), 1e-4
    flat, deeper = stretched(body, at)
    along = (moved((0.0, unit), step) - moved((0.0, unit), -step)) / (2 * step)
    down = [moved((unit, 0.0), shift) for shift in (-step, 0.0, step)]
    np.testing.assert_allclose(flat, along, rtol=1e-6)
    np.testing.assert_allclose(deeper, -(down[0] - 2 * down[1] + down[2]) / step**2, rtol=1e-6, atol=1e-6)


def test_two_cylinders():
    """NAFEMS R0094-1: steel cylinder on aluminium, half-width 6.2146 mm, largest pressure 3585.4 MPa."""
    roller = {"shape": "cylinder", "radius": 0.05, "length": 1e-3, **STEEL}
    tables = {"loading": {"force": 35e3}, "fem": {"box": 20, "cells_per_radius": 10}}
    result = plane_strain.solve(Scene(body=STEEL | {"young": 70e9}, counterbody=roller, **tables))
    found = [result.quantities[name] for name in ("contact_half_width_m", "p_max_Pa", "contact_area_m2")]
    assert found == pytest.approx([6.2146e-3, 3585.4e6, 2 * 6.2146e-6], rel=1e-3)
    assert result.status == "converged" and max(result.certificate.values()) < 1e-9


PERFECT = {"law": "perfect", "yield_stress": YIELD}
KINEMATIC = PERFECT | {"kinematic": {"modulus": [20e9], "recovery": [0.0]}}


def test_flow_does_not_lock():
    """The mean pressure of a body that flows freely stays below that of a rigid-plastic one, (2 + pi) k, and
    rises towards it; the volume changes elastically alone.
    """
    model, steps = plane_strain.load_steps(line(6.0, cells=3, plasticity=PERFECT, steps=6))
    mean = [np.pi / 4.0 * 6.0 * step.state.force / model.scales.peak_force for step in steps]
    mean = [force / model.size(step.state) for force, step in zip(mean, steps, strict=True)]
    assert 2.3 < mean[-1] < (2.0 + np.pi) / np.sqrt(3.0) and mean == sorted(mean)
    state = steps[-1].state
    volume = model.body.strain(state.u)[:3].sum(axis=0)
    bulk = model.stress(state)[:3].sum(axis=0) * (1.0 - 2.0 * 0.3) / (1.0 - 0.3**2)
    np.testing.assert_allclose(volume, bulk, atol=1e-9)
    assert np.abs(state.history.plastic_strain[:3].sum(axis=0)).max() < 1e-9


def test_far_field_of_plastic_strain():
    """Residual stresses do not depend on the box, and those along x have no resultant on a line x = const."""
    found = []
    for box in (12.0, 24.0):
        model, steps = plane_strain.load_steps(line(3.0, box=box, plasticity=PERFECT, steps=2, unload=True))
        state = steps[-1].state
        assert steps[-1].unloads and not state.active.any() and state.residual < 1e-9
        s, height = stresses(model, state), np.repeat(np.diff(model.plan.z), 2) / 2.0
        forces = s.stress[0] @ height / (np.abs(s.stress[0]) @ height)
        found.append((np.abs(forces[s.x < 2.0 * model.scales.length]).max(), mises(s.stress).max()))
    (near, coarse), (far, fine) = found
    assert far < 0.5 * near < 0.05 and coarse == pytest.approx(fine, rel=0.01)


def test_rolling_leaves_a_track():
    """Passes add less and less; a resumed result is equal; an elastic contact moves with the apex."""
    rolls = line(2.1, plasticity=KINEMATIC, path=2.5, steps=2, cycles=2, unload=True)
    kept = []
    result = plane_strain.solve(rolls, checkpoint=kept.append)
    assert result.status == "converged" and result.quantities["groove_deepest_m"] > 0.0
    first, second = result.tables["passes"]["new_strain_max"]
    assert 0.0 <= second < 0.5 * first
    again = plane_strain.solve(rolls, start=kept[-4])
    assert again.quantities == result.quantities
    model, steps = plane_strain.load_steps(line(1.0, path=1.0))
    for step in steps:
        assert model.centroid(step.state) == pytest.approx(step.state.load.x, abs=0.05)
