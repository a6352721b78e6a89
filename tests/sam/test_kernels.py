# SPDX-License-Identifier: MIT
"""Influence coefficients against quadrature of point loads and of Mindlin's point force."""

from math import pi

import numpy as np
import pytest
import sympy as sp
from derivations import eigenstrain_table, load_table

import sam.kernels.eigenstrain as eigenstrain
import sam.kernels.layer_stress as layer_stress
import sam.kernels.primitives as primitives
from sam.kernels.eigenstrain import displacement_parity, surface_displacement_coefficients
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, parity, stress_coefficients
from verification.reference.mindlin_cheng import EigenstrainSphere
from verification.reference.nuclei import cuboid_by_faces, cuboid_by_nuclei
from verification.reference.quadrature import patch_response

HX, HY = 1.0, 0.7
FACES = np.array([0.0, 0.3, 0.8, 2.0])  # uneven layers, the first one at the surface


def assert_close(value, answer, bound=1e-10):
    """Within bound times the largest component, stress (rows 0 to 5) and displacement apart."""
    for part in (slice(0, 6), slice(6, 9)):
        assert np.abs(value - answer)[part].max() <= bound * np.abs(answer[part]).max()


def sign_of(lag, parity) -> int:
    """Of a coefficient of this parity at a lag of either sign."""
    return (parity[0] if lag[0] < 0 else 1) * (parity[1] if lag[1] < 0 else 1)


@pytest.mark.parametrize("table", [load_table, eigenstrain_table], ids=["load", "eigenstrain"])
def test_the_table_is_what_the_derivation_gives(table):
    assert table.TABLE.read_text(encoding="utf-8") == load_table.as_text(table.derive())


# a loaded rectangle


def of_patch(load, i, j, z, nu):
    """The nine coefficients (6 stresses, 3 displacements) at the lag (i, j), either sign."""
    lags = Lags(abs(i) + 1, abs(j) + 1, HX, HY)
    stress = stress_coefficients(lags, z, nu, load=load)[:, 0, -1, -1]
    shift = [displacement_coefficients(lags, nu, component=c, load=load, z=z)[-1, -1] for c in (1, 2, 3)]
    signs = [sign_of((i, j), parity(name, load)) for name in (*STRESS, "1", "2", "3")]
    return np.array(signs) * np.concatenate([stress, shift])


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", [1, 2, 3])
@pytest.mark.parametrize(
    "places",
    [
        ((3, 2, 0.5), (0, 0, 0.02), (-1, 0, 0.05), (0, -1, 0.4), (7, 5, 11.0)),
        ((0, 0, 0.3), (0, 0, 1.0), (0, 0, 4.0), *((1, 0, z) for z in (0.02, 0.3, 1.0, 4.0))),
        ((0, 1, 0.02), (0, 1, 0.3), (0, 1, 1.0), (0, 1, 4.0), (2, 3, 1.0), (2, 3, 4.0)),
        ((2, 3, 0.02), (2, 3, 0.3), *((6, 4, z) for z in (0.02, 0.3, 1.0, 4.0))),
    ],
    ids=["either side", "above", "beside", "far"],
)
def test_equal_to_quadrature_of_point_loads(load, nu, places):
    """1e-10 of the largest component (the project's bound): cancellation, largest for many cells away."""
    for i, j, z in places:
        answer = patch_response(load, (i * HX, j * HY, z), (HX / 2, HY / 2), nu)
        assert_close(of_patch(load, i, j, z, nu), answer)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", [1, 2, 3])
def test_nine_surface_displacements(load, nu):
    """At z = 0, under the patch too, where the integrand is singular: all D_ij of paper Eq. 5."""
    for i, j in ((0, 0), (1, 0), (0, 1), (-2, 1), (2, 3), (6, 4)):
        answer = patch_response(load, (i * HX, j * HY, 0.0), (HX / 2, HY / 2), nu)[6:]
        assert np.abs(of_patch(load, i, j, 0.0, nu)[6:] - answer).max() <= 1e-12


def test_surface_stress_balances_the_traction():
    """At z = 0 the traction on the body is (q_x, q_y, p) on the patch and nothing beside it."""
    for load, name in ((3, "33"), (1, "13"), (2, "23")):
        stress = stress_coefficients(Lags(4, 4, HX, HY), 0.0, 0.3, load=load)[2:5, 0]
        expected = np.zeros((3, 4, 4))
        expected[("33", "23", "13").index(name), 0, 0] = -1.0
        assert np.abs(stress - expected).max() < 1e-14


# an eigenstrain in a cuboid


def of_cuboid(i, j, z, layer, nu):
    """Stress (6) at z and displacement (3) of the surface for six eigenstrains, (9, 6), at any lag."""
    box = Cuboids(Lags(abs(i) + 1, abs(j) + 1, HX, HY), tuple(FACES), nu)
    stress = residual_stress_coefficients(box, z)[:, :, 0, layer, -1, -1]
    shift = [surface_displacement_coefficients(box, component=c)[:, layer, -1, -1] for c in (1, 2, 3)]
    flips = [[eigenstrain.parity(row, column) for column in range(6)] for row in range(6)]
    flips += [[displacement_parity(c, column) for column in range(6)] for c in (1, 2, 3)]
    signs = np.array([[sign_of((i, j), each) for each in line] for line in flips])
    return signs * np.concatenate([stress, shift])


def by_quadrature(method, i, j, z, layer, nu):
    """The same by integration; the displacement is that of the surface."""
    box = (HX / 2, HY / 2, FACES[layer], FACES[layer + 1])
    stress, displacement = (method((i * HX, j * HY, depth), box, nu) for depth in (z, 0.0))
    return np.concatenate([stress[:6], displacement[6:]])


@pytest.mark.parametrize(
    "place, nu",
    [((1, 1, 0.5, 0), 0.3), ((0, -2, 0.2, 0), 0.0), ((-2, 1, 1.3, 1), 0.49), ((2, 0, 0.0, 0), 0.3)],
)
def test_equal_to_quadrature_of_point_nuclei_outside(place, nu):
    """1e-10 of the largest component (measured below 1e-13), all quadrants, surface included."""
    assert_close(of_cuboid(*place, nu), by_quadrature(cuboid_by_nuclei, *place, nu))


@pytest.mark.parametrize(
    "place, nu", [((0, 0, 0.5, 1), 0.3), ((0, 0, 0.14, 0), 0.0), ((-1, 0, 0.15, 0), 0.49)]
)
def test_equal_to_quadrature_of_point_forces_inside_and_close(place, nu):
    """Inside each of the uneven layers, right above and below, and beside: point forces on the six faces."""
    answer = by_quadrature(lambda *a: cuboid_by_faces(*a, order=24), *place, nu)
    assert_close(of_cuboid(*place, nu), answer)


def test_both_quadratures_agree():
    place, box = (-2.0, 0.4, 0.3), (0.5, 0.35, 0.3, 0.8)
    assert_close(cuboid_by_faces(place, box, 0.3), cuboid_by_nuclei(place, box, 0.3), 1e-12)


@pytest.mark.parametrize("hx, hy, faces", [(1.0, 0.7, (0.3, 0.8, 2.0)), (1.0, 3.0, (0.0, 0.01, 5.0))])
def test_surface_is_free_of_traction(hx, hy, faces):
    """1e-12 of the largest stress; for flat and for tall cells, in the body and at the surface."""
    stress = residual_stress_coefficients(Cuboids(Lags(6, 5, hx, hy), faces, 0.3), 0.0)
    assert np.abs(stress[2:5]).max() < 1e-12 * np.abs(stress).max()


def test_far_away_an_expanding_cube_is_mindlin_and_cheng_s_sphere():
    """By its symmetry a cube differs by (half side/distance)^4: below 2e-6 at 12 to 20 sides."""
    n, top, nu = 12, 9.5, 0.3
    sphere = EigenstrainSphere(1.0, (3 / (4 * pi)) ** (1 / 3), top + 0.5, 2 * (1 + nu), nu)
    box, depth = Cuboids(Lags(n + 1, n + 1, 1.0, 1.0), (top, top + 1.0), nu), 1.5 * (top + 0.5)
    stress = residual_stress_coefficients(box, depth)[:, :3, 0, 0, n, n].sum(axis=1)
    answer = sphere.stress(n, n, depth)
    assert np.abs(stress - answer).max() < 2e-6 * np.abs(answer).max()
    shift = surface_displacement_coefficients(box)[:3, 0, n, n].sum()
    assert shift == pytest.approx(sphere.surface_displacement(n, n), rel=2e-6)


@pytest.mark.parametrize(
    ("z", "faces"), [(0.3, FACES), (-0.1, FACES), (0.1, [0.0, 0.5, 0.5]), (0.1, [-1.0, 1.0])]
)
def test_depths_on_a_face_or_out_of_order_are_refused(z, faces):
    with pytest.raises(ValueError, match=r"faces|z_observed"):
        residual_stress_coefficients(Cuboids(Lags(2, 2, 1.0, 1.0), tuple(faces), 0.3), z)


# what they are made of


def test_primitives_are_the_repeated_integrals_that_they_claim_to_be():
    """Each order by Gauss quadrature of d_x^a d_y^b d_z^c (1/R) over a rectangle and, for c <= 0, n = 1 - c
    times from infinity: P[a,b,c](z) = (-1)^n int_z^inf (s - z)^(n-1)/(n-1)! d_x^a d_y^b (1/R) ds. 1e-10 of
    the value.
    """
    symbols = sp.symbols("x y z")
    x0, x1, y0, y1, z = 0.3, 1.4, -0.35, 0.35, 0.6
    t, w = (np.polynomial.legendre.leggauss(48)[0] + 1) / 2, np.polynomial.legendre.leggauss(48)[1] / 2
    x, y = (x0 + (x1 - x0) * t)[:, None, None], (y0 + (y1 - y0) * t)[:, None]
    weight = (x1 - x0) * (y1 - y0) * w[:, None, None] * w[:, None]
    s, corners = t / (1 - t), primitives.Corners(np.array([[x0], [x1]]), np.array([[y0, y1]]), z)
    for a, b, c in primitives.orders():
        orders = (symbols[0], a), (symbols[1], b), (symbols[2], max(c - 1, 0))
        f = sp.lambdify(symbols, sp.diff(1 / sp.sqrt(sum(q**2 for q in symbols)), *orders), "numpy")
        n = 1 - c
        if n > 0:
            by_depth = (-1) ** n * s ** (n - 1) / float(sp.factorial(n - 1)) * w / (1 - t) ** 2
            answer = np.sum(f(x, y, z + s) * weight * by_depth)
        else:
            answer = np.sum(f(x, y, z) * weight)
        value = np.diff(np.diff(primitives.primitive(a, b, c, corners), axis=0), axis=1).item()
        assert value == pytest.approx(answer, rel=1e-10, abs=1e-13), (a, b, c)


@pytest.mark.parametrize("image", [True, False])
def test_corner_functions_are_means_over_their_points(image):
    x, y = np.broadcast_arrays(
        np.array([[0.5, 1.5], [0.6, 1.6]])[:, :, None], np.array([[[0.2, 0.9]], [[0.3, 1.0]]])
    )
    meshes = [
        layer_stress.CornerFunctions((1, 1), (x[part], y[part])) for part in (np.s_[:], np.s_[:1], np.s_[1:])
    ]
    both, first, last = (each.planes(each(image, np.array([[0.4, 1.1]])), (0, 0)) for each in meshes)
    assert both == pytest.approx((first + last) / 2, rel=1e-13)
