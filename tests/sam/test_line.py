# SPDX-License-Identifier: MIT
"""A line contact: coefficients of plane strain against quadrature, cells of space, and balance of forces; a
cylinder against Hertz and McEwen, NAFEMS, the closed form of full slip, and itself on other grids.
"""

from itertools import pairwise

import numpy as np
import pytest
from builders import LINEAR, MODULUS, STEEL

from sam import solve
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import (
    STRESS,
    Cuboids,
    Lags,
    displacement_coefficients,
    stress_coefficients,
)
from sam.scene import Scene

NU, N = 0.3, 6
LINE = Lags(N, 1, 1.0, 40.0, period=1)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
PLANE = [STRESS.index(name) for name in ("11", "22", "33", "13")]


def between(low, high):
    """Gauss points and weights."""
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
    # and what a row of cells of space tends to
    ratios = []
    for count in (200, 400):
        cells = stress_coefficients(Lags(N, count, 1.0, 1.0), depths, NU, load=load)
        row = cells[..., 0] + 2 * cells[..., 1:].sum(axis=-1)
        ratios.append(np.abs(row[PLANE] - exact).max())
    assert ratios[0] < 4e-3
    assert ratios[1] / ratios[0] < 0.55  # 1 over the length or faster


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
    """No force crosses a vertical cut (inside and outside of the section), no traction the surface; e_yy is
    nu (e_xx + e_zz) in the plane, and adds -E e_yy to the stress along y.
    """
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


def cylinder(p0=1e9, *, cells=None, length=2e-3, radius=10e-3, **tables):
    """(scene, half-width) of a rigid cylinder on steel under the force of an elastic p0."""
    a = 2 * p0 * radius / MODULUS
    shape = {"shape": "cylinder", "radius": radius, "length": length}
    tables = {"body": STEEL, "loading": {"force": np.pi / 2 * a * p0 * length}, **tables}
    if cells:
        tables["grid"] = {"cells": (cells, 1)}
    return Scene(counterbody={**shape, **tables.pop("other", {})}, **tables), a


def test_a_cylinder_is_the_line_contact_of_hertz_with_the_stresses_of_mcewen():
    errors = []
    for cells in (65, 129, 257):
        scene, a = cylinder(cells=cells)
        result = solve(scene)
        found, axis, line = result.quantities, result.tables["axis"], result.tables["line"]
        p0, line_load = 1e9, np.pi / 2 * a * 1e9
        # Johnson 1985, section 4.2, with the displacement zero at half of the length
        approach = 2 * line_load / (np.pi * MODULUS) * (np.log(2e-3 / a) + 0.5)
        errors.append([found["p_max_Pa"] / p0 - 1, found["approach_m"] / approach - 1])
        assert found["contact_half_width_m"] == pytest.approx(a, rel=0.15 / cells)
        assert found["contact_radius_m"] is None
        assert found["force_N"] == pytest.approx(line_load * 2e-3, rel=1e-9)
    assert np.log2(np.abs(errors[0]) / np.abs(errors[2])) / 2 == pytest.approx(2, abs=0.2)
    assert np.abs(errors[2]).max() < 2e-5
    z = axis["z_m"] / a
    s11, s33 = -(1 + 2 * z * z) / np.sqrt(1 + z * z) + 2 * z, -1 / np.sqrt(1 + z * z)
    for name, exact in (("sxx_Pa", s11), ("syy_Pa", 0.3 * (s11 + s33)), ("szz_Pa", s33)):
        assert axis[name] / p0 == pytest.approx(exact, abs=2e-5)
    assert p0 / found["mises_max_Pa"] == pytest.approx(1.794, rel=3e-4)  # first yield, in yield stresses
    assert found["mises_max_depth_m"] / a == pytest.approx(0.704, abs=1e-3)
    outside = np.abs(line["x_m"]) > 1.2 * a
    far = np.abs(line["x_m"][outside]) / a
    log = np.arccosh(far) - far * np.sqrt(far**2 - 1) + far**2  # beside Hertz's pressure
    exact = -2 * line_load / (np.pi * MODULUS) * (log - 0.5 + np.log(a / 2e-3))
    assert line["uz_m"][outside] == pytest.approx(exact, rel=2e-4)


def test_a_steel_cylinder_on_aluminium_is_that_of_nafems():
    """R0094-1: half-width 6.2146 mm, largest pressure 3585.4 MPa; 35 kN on a mm, shorter than it is wide."""
    body, other = {"young": 70e9, "poisson": 0.3}, {"young": 210e9, "poisson": 0.3}
    tables = {"body": body, "loading": {"force": 35e3}, "other": other}
    found = solve(cylinder(length=1e-3, radius=50e-3, **tables)[0]).quantities
    assert found["contact_half_width_m"] == pytest.approx(6.2146e-3, rel=3e-4)
    assert found["p_max_Pa"] == pytest.approx(3585.4e6, rel=3e-5)


def test_full_slip_moves_the_contact_as_the_singular_integral_equation_says():
    """p ~ (a + x)^k (a - x)^(1 - k) about a centre, k = 1/2 + atan(beta mu)/pi: its centroid lies (8/3) (k -
    1/2) a beside the apex, and F' = pi E* a^2 k (1 - k)/R.
    """
    nu, mu = 0.2, 0.5
    body, friction = {"young": 200e9, "poisson": nu}, {"coefficient": mu}
    scene, _ = cylinder(cells=129, body=body, loading={"force": 1e3}, friction=friction)
    found = solve(scene).quantities
    shift = np.arctan((1 - 2 * nu) / (2 * (1 - nu)) * mu) / np.pi
    modulus = 200e9 / (1 - nu**2)
    a = np.sqrt(1e3 / 2e-3 * 10e-3 / (np.pi * modulus * (0.25 - shift**2)))
    assert found["pressure_centroid_x_m"] == pytest.approx(-8 / 3 * shift * a, rel=3e-4)
    assert found["contact_half_width_m"] == pytest.approx(a, rel=2e-3)


PEAK = ("peeq_max", "residual_uz_center_m", "p_max_Pa")


def yielding(cells, **tables):
    """The result of a cylinder on linear hardening steel at p0 = 2.5 yield stresses, and a."""
    scene, a = cylinder(2.5e9, cells=cells, body={**STEEL, "plasticity": LINEAR}, **tables)
    return solve(scene), a


def loads(length=2e-3, **keys):
    a = 2 * 2.5e9 * 10e-3 / MODULUS
    return {"force": np.pi / 2 * a * 2.5e9 * length, "steps": 2, "unload": True, **keys}


def test_a_yielding_cylinder_knows_only_the_force_on_a_length_and_keeps_plane_strain():
    coarse, fine = (yielding(cells, loading=loads())[0] for cells in (33, 65))
    values = [coarse.quantities[name] for name in PEAK]
    assert values == pytest.approx([fine.quantities[name] for name in PEAK], rel=5e-3)
    short = yielding(33, loading=loads(0.1e-3), length=0.1e-3)[0]  # narrower than the contact
    assert [short.quantities[name] for name in PEAK] == pytest.approx(values, rel=1e-4)
    cells = fine.grids["unloaded"]["body"].cell_data
    assert not cells["plastic_strain"][[3, 5]].any()
    assert not cells["stress_Pa"][[3, 5]].any()
    # flow alone does not strain along y, elastic strain does: their sum is zero
    young, poisson = STEEL["young"], STEEL["poisson"]
    s11, s22, s33 = cells["stress_Pa"][:3]
    along = cells["plastic_strain"][1] + (s22 - poisson * (s11 + s33)) / young
    assert np.abs(along).max() < 3e-5 * np.abs(cells["plastic_strain"]).max()


def test_a_pass_back_leaves_the_mirror_image_of_one_forth():
    a, tables = 2 * 2.5e9 * 10e-3 / MODULUS, []
    for side in (-2 * a, 2 * a):
        path = {"start": (side, 0.0), "end": (-side, 0.0), "step_per_radius": 1}
        result = yielding(45, loading=loads(path=path), other={"slip": 0.0})[0]
        tables.append(result.tables["track"])
        assert result.quantities["shoulder_side_m"] is None
    forth, back = tables
    assert np.max(forth["uz_m"]) > 1e-7
    largest = np.abs(forth["top_sxx_Pa"])[np.isfinite(forth["top_sxx_Pa"])].max()
    assert back["uz_m"][::-1] == pytest.approx(forth["uz_m"], abs=1e-3 * np.max(forth["uz_m"]))
    assert back["top_sxx_Pa"][::-1] == pytest.approx(forth["top_sxx_Pa"], abs=1e-2 * largest, nan_ok=True)
