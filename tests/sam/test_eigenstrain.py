# SPDX-License-Identifier: MIT
"""Influence coefficients of an eigenstrain in a cuboid against quadrature of Mindlin's point-force
solution.
"""

from math import pi

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from derivations.eigenstrain_table import TABLE, derive
from derivations.load_table import as_text

import sam.kernels.eigenstrain as eigenstrain
import sam.kernels.layer_stress as layer_stress
import sam.kernels.primitives as primitives
from sam.kernels.eigenstrain import (
    displacement_parity,
    eigenstrain_table,
    parity,
    surface_displacement_coefficients,
)
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import Cuboids, Lags
from verification.reference.mindlin_cheng import EigenstrainSphere
from verification.reference.nuclei import (
    cuboid_by_faces,
    cuboid_by_nuclei,
    mindlin_displacement,
    point_force,
)

HX, HY = 1.0, 0.7
FACES = np.array([0.0, 0.3, 0.8, 2.0])  # uneven layers, the first one at the surface


def closed_form(i, j, z, layer, nu):
    """Stress (6) at z and displacement (3) of the surface for six eigenstrains, (9, 6), at a lag of either
    sign.
    """
    n = abs(i) + 1, abs(j) + 1
    stress = residual_stress_coefficients(Cuboids(Lags(*n, HX, HY), tuple(FACES), nu), z)[
        :, :, 0, layer, -1, -1
    ]
    shift = [
        surface_displacement_coefficients(Cuboids(Lags(*n, HX, HY), tuple(FACES), nu), component=c)[
            :, layer, -1, -1
        ]
        for c in (1, 2, 3)
    ]
    flips = [[parity(row, column) for column in range(6)] for row in range(6)]
    flips += [[displacement_parity(c, column) for column in range(6)] for c in (1, 2, 3)]
    sign = np.array([[(px if i < 0 else 1) * (py if j < 0 else 1) for px, py in line] for line in flips])
    return sign * np.concatenate([stress, shift])


def by_quadrature(method, i, j, z, layer, nu):
    """The same by integration; the displacement is that of the surface."""
    box = (HX / 2, HY / 2, FACES[layer], FACES[layer + 1])
    stress, displacement = (method((i * HX, j * HY, depth), box, nu) for depth in (z, 0.0))
    return np.concatenate([stress[:6], displacement[6:]])


def cuboid_stress(x, y, z, half_x, half_y, faces, nu):
    """Stress/mu at an offset (x, y) that need not be on the grid, outside the cuboids: (6, 6, layers)."""
    return without_own(
        np.array([[x - half_x], [x + half_x]]), np.array([[y - half_y, y + half_y]]), z, faces, nu
    )


def without_own(x, y, z, faces, nu):
    """The sum over the corners, to which the cuboid at this depth has its own stress added back, (6, 6,
    layers).
    """
    functions = layer_stress.CornerFunctions((1, 1), [corners[None] for corners in np.broadcast_arrays(x, y)])
    faces = np.asarray(faces, float)
    inside = (faces[:-1] <= z) & (z < faces[1:])
    stress = np.empty((36, len(faces) - 1, 1, 1))
    layer_stress.LayerStress(functions, np.array([[z]]), faces, nu).of(0, stress)
    return stress.reshape(6, 6, -1) + np.where(inside, eigenstrain.own_stress(nu)[..., None], 0.0)


def corner_sum(x, y, z, faces, nu):
    """The same from the functions of the corners, in whatever numbers these are."""
    at_faces = []
    for face in faces:
        image = eigenstrain.image_functions(x, y, z + face)
        full = eigenstrain.full_space_functions(x, y, z - face)
        image, full = (
            np.array(
                [np.diff(np.diff(np.broadcast_to(value, (2, 2)), axis=0), axis=1)[0, 0] for value in values]
            )
            for values in (image, full)
        )
        stress = np.empty(36, dtype=object)
        for block in eigenstrain.blocks(nu):
            of_image = np.tensordot(np.array([1, face, z, z * face]), block.image, 1)
            stress[block.rows] = of_image @ image[block.of_image] + block.full @ full[block.of_full]
        at_faces.append(stress)
    return np.moveaxis(np.diff(np.array(at_faces), axis=0), 0, -1).reshape(6, 6, -1)


def assert_close(value, answer, bound):
    """Within bound times the largest component, stress (rows 0 to 5) and displacement apart."""
    for part in (slice(0, 6), slice(6, 9)):
        assert np.abs(value - answer)[part].max() <= bound * np.abs(answer[part]).max()


def test_mindlin_s_solution_is_in_equilibrium():
    """The independent answer itself: no traction at z = 0, the force carried at depth, symmetric in force and
    source.
    """
    x, y = np.array([0.3, 1.1])[:, None], np.array([-0.4, 0.9])
    assert np.abs(point_force((x, y, 0.0), 0.7, 0.3)[2:5]).max() <= 1e-14
    near = np.array(mindlin_displacement((0.4, -0.3, 0.5), 1.2, 0.3))
    far = np.array(mindlin_displacement((-0.4, 0.3, 1.2), 0.5, 0.3))
    assert near == pytest.approx(far.T, rel=1e-13)
    r, w = np.polynomial.legendre.leggauss(
        60
    )  # polar plane z = 2, r = t/(1 - t), four angles: exact for order < 4
    r, w = (r + 1) / 2, w / 2
    radius, weight = r / (1 - r), w / (1 - r) ** 2 * r / (1 - r) * pi / 2
    angle = np.arange(4)[:, None] * pi / 2 + 0.3
    traction = point_force((radius * np.cos(angle), radius * np.sin(angle), 2.0), 0.7, 0.3)[[4, 3, 2]]
    assert np.sum(traction * weight, axis=(-2, -1)) == pytest.approx(-np.eye(3), abs=1e-9)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_equal_to_quadrature_of_point_nuclei_outside(nu):
    """1e-10 of the largest component (the project's bound; measured below 1e-13), all quadrants, surface
    included.
    """
    for i, j, z, layer in ((1, 0, 0.6, 1), (0, -2, 0.2, 0), (-2, 1, 1.3, 1), (3, 3, 4.0, 2), (2, 0, 0.0, 0)):
        answer = by_quadrature(cuboid_by_nuclei, i, j, z, layer, nu)
        assert_close(closed_form(i, j, z, layer, nu), answer, 1e-10)


def test_equal_to_quadrature_in_one_place():
    """As above, with every term of the table in it (see below)."""
    assert_close(closed_form(1, 1, 0.5, 0, 0.3), by_quadrature(cuboid_by_nuclei, 1, 1, 0.5, 0, 0.3), 1e-10)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_equal_to_quadrature_of_point_forces_inside_and_close(nu):
    """Inside each of the uneven layers, right above and below, and beside: point forces on the six faces."""
    for i, j, z, layer in ((0, 0, 0.5, 1), (0, 0, 0.14, 0), (0, 0, 1.1, 1), (-1, 0, 0.15, 0)):
        answer = by_quadrature(lambda *a: cuboid_by_faces(*a, order=32), i, j, z, layer, nu)
        assert_close(closed_form(i, j, z, layer, nu), answer, 1e-10)


def test_both_quadratures_agree():
    for place in ((1.0, 0.7, 1.5), (-2.0, 0.4, 0.3)):
        box = (0.5, 0.35, 0.3, 0.8)
        assert_close(cuboid_by_faces(place, box, 0.3), cuboid_by_nuclei(place, box, 0.3), 1e-12)


def test_an_incompressible_body_is_the_limit():
    """nu = 1/2: nothing in the coefficients grows as 1/(1 - 2 nu); the change is of the order of the change
    of nu.
    """
    limit, near = (closed_form(0, 0, 0.5, 1, nu) for nu in (0.5, 0.5 - 1e-9))
    assert np.abs(limit - near).max() < 1e-8


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_surface_is_free_of_traction(nu):
    """1e-12 of the largest stress; for flat and for tall cells, in the body and at the surface."""
    for hx, hy, faces in ((1.0, 0.7, [0.3, 0.8, 2.0]), (1.0, 3.0, [0.01, 0.02, 5.0]), (1.0, 0.7, FACES)):
        stress = residual_stress_coefficients(Cuboids(Lags(6, 5, hx, hy), tuple(faces), nu), 0.0)
        assert np.abs(stress[2:5]).max() < 1e-12 * np.abs(stress).max()


def test_major_symmetry():
    """Betti: the mean over cuboid A of the stress by an eigenstrain in B, times volumes, is symmetric in A
    and B.

    Gauss points in A, which is so far from B that 8 of them an axis integrate to 1e-12.
    """
    boxes = [((0.0, 0.0), (0.5, 0.35), (0.3, 0.8)), ((1.9, -1.6), (0.4, 0.6), (0.9, 1.7))]
    t, w = np.polynomial.legendre.leggauss(8)

    def interaction(receiver, source):
        ((x, y), (a, b), (top, bottom)), ((xs, ys), half, faces) = receiver, source
        total = 0.0
        for (i, j, k), weight in np.ndenumerate(w[:, None, None] * w[:, None] * w):
            at = x + a * t[i] - xs, y + b * t[j] - ys, (top + bottom + (bottom - top) * t[k]) / 2
            total = (
                total + weight * a * b * (bottom - top) / 2 * cuboid_stress(*at, *half, faces, 0.3)[..., 0]
            )
        return total

    twice = np.array([1, 1, 1, 2, 2, 2])  # a shear column stands for two tensor components
    forward, back = interaction(*boxes) * twice[:, None], interaction(*boxes[::-1]) * twice[:, None]
    assert np.abs(forward - back.T).max() <= 1e-11 * np.abs(forward).max()


def test_eight_sub_cuboids_sum_to_the_cuboid():
    for x, y, z in ((1.2, -0.9, 0.5), (0.1, 0.2, 1.9), (4.0, 3.0, 0.0)):
        whole = cuboid_stress(x, y, z, 0.5, 0.4, [0.3, 1.1], 0.3)[..., 0]
        parts = [
            cuboid_stress(x - sx * 0.25, y - sy * 0.2, z, 0.25, 0.2, [0.3, 0.6, 1.1], 0.3).sum(axis=-1)
            for sx in (-1, 1)
            for sy in (-1, 1)
        ]
        assert np.abs(sum(parts) - whole).max() <= 1e-13 * max(np.abs(whole).max(), 0.1)


def test_deep_cuboid_is_one_in_the_full_space():
    """Expansion of a cuboid (Goodier 1937): trace of the stress -4 mu (1 + nu)/(1 - nu) e inside, 0 outside;
    a third of it on each axis at the centre of a cube. The image falls as (size/depth)^3, 1e-9 here.
    """
    nu, deep = 0.3, 1000.0
    stress = residual_stress_coefficients(Cuboids(Lags(3, 3, 1.0, 1.0), (deep, deep + 1.0), nu), deep + 0.5)[
        :, :3, 0, 0
    ].sum(axis=1)
    trace = stress[:3].sum(axis=0)
    inside = np.zeros((3, 3))
    inside[0, 0] = -4 * (1 + nu) / (1 - nu)
    assert np.abs(trace - inside).max() < 1e-8
    assert stress[:3, 0, 0] == pytest.approx(inside[0, 0] / 3, abs=1e-8)
    flat = residual_stress_coefficients(Cuboids(Lags(1, 1, 3.0, 1.0), (deep, deep + 0.7), nu), deep + 0.1)[
        :3, :3, 0, 0, 0, 0
    ]
    assert flat.sum() == pytest.approx(inside[0, 0], abs=1e-8)


def test_far_away_an_expanding_cube_is_mindlin_and_cheng_s_sphere():
    """Equal volumes; by its symmetry a cube differs by (half side/distance)^4 only: below 2e-6 at 12 to 20
    sides.

    Half the cells' distance away the difference is 16 times larger (fourth order), what shows that it is this
    one.
    """

    def difference(n, top):
        centre, nu = top + 0.5, 0.3
        sphere = EigenstrainSphere(1.0, (3 / (4 * pi)) ** (1 / 3), centre, 2 * (1 + nu), nu)
        faces, depth = [top, top + 1.0], 1.5 * centre
        stress = residual_stress_coefficients(Cuboids(Lags(n + 1, n + 1, 1.0, 1.0), tuple(faces), nu), depth)[
            :, :3, 0, 0, n, n
        ].sum(axis=1)
        shift = surface_displacement_coefficients(Cuboids(Lags(n + 1, n + 1, 1.0, 1.0), tuple(faces), nu))[
            :3, 0, n, n
        ].sum()
        answer = sphere.stress(n, n, depth)
        bulge = sphere.surface_displacement(n, n)
        return np.abs(stress - answer).max() / np.abs(answer).max(), abs(shift / bulge - 1)

    far, near = np.array(difference(12, 9.5)), np.array(difference(6, 4.5))
    assert np.all(far < 2e-6)
    assert np.all(np.log2(near / far) == pytest.approx(4.0, abs=0.2))


def test_the_table_is_what_the_derivation_gives():
    assert TABLE.read_text(encoding="utf-8") == as_text(derive())


def test_every_row_and_every_full_space_term_counts(monkeypatch):
    """Each changed by 1e-3, one after the other: the coefficients move by more than the 1e-10 that the tests
    allow.
    """
    table, place = eigenstrain_table(), (1, 1, 0.5, 0, 0.3)
    answer = by_quadrature(cuboid_by_nuclei, *place)
    assert_close(closed_form(*place), answer, 1e-10)

    def moved():
        eigenstrain._matrix.cache_clear()
        eigenstrain.blocks.cache_clear()
        return np.abs(closed_form(*place) - answer)

    for kind, rows in (("stress", slice(0, 6)), ("displacement", slice(6, 9))):
        for name, entries in table[kind].items():
            for term, powers in entries.items():
                changed = {
                    **table,
                    kind: {**table[kind], name: {**entries, term: tuple(1.001 * c for c in powers)}},
                }
                monkeypatch.setattr(eigenstrain, "eigenstrain_table", lambda t=changed: t)
                assert moved()[rows].max() > 1e-7 * np.abs(answer[rows]).max(), (kind, name, term)
    monkeypatch.undo()
    full = eigenstrain._full_space_matrix(0.3)
    for entry in np.argwhere(np.abs(full) > 1e-12):
        changed = full.copy()
        changed[tuple(entry)] *= 1.001
        monkeypatch.setattr(eigenstrain, "_full_space_matrix", lambda nu, m=changed: m)
        assert moved()[:6].max() > 1e-7 * np.abs(answer[:6]).max(), entry
    monkeypatch.undo()
    eigenstrain._matrix.cache_clear()
    eigenstrain.blocks.cache_clear()


def test_own_stress_counts(monkeypatch):
    """Every entry of the term inside, changed by 1e-3, is seen by the comparison inside the cuboid."""
    place = (0, 0, 0.5, 1, 0.3)
    answer = by_quadrature(lambda *a: cuboid_by_faces(*a, order=32), *place)
    own = eigenstrain.own_stress(0.3)
    for entry in np.argwhere(own):
        changed = own.copy()
        changed[tuple(entry)] *= 1.001
        monkeypatch.setattr(layer_stress, "own_stress", lambda nu, m=changed: m)
        assert np.abs(closed_form(*place) - answer).max() > 1e-5, entry


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
    s = t / (1 - t)
    for a, b, c in primitives.orders():
        derivative = sp.diff(
            1 / sp.sqrt(sum(q**2 for q in symbols)), symbols[0], a, symbols[1], b, symbols[2], max(c - 1, 0)
        )
        f = sp.lambdify(symbols, derivative, "numpy")
        n = 1 - c
        if n > 0:
            by_depth = (-1) ** n * s ** (n - 1) / float(sp.factorial(n - 1)) * w / (1 - t) ** 2
            answer = np.sum(f(x, y, z + s) * weight * by_depth)
        else:
            answer = np.sum(f(x, y, z) * weight)
        corners = primitives.Corners(np.array([[x0], [x1]]), np.array([[y0, y1]]), z)
        value = np.diff(np.diff(primitives.primitive(a, b, c, corners), axis=0), axis=1).item()
        assert value == pytest.approx(answer, rel=1e-10, abs=1e-13), (a, b, c)


class ManyDigits:
    """numpy for arrays of mpmath numbers: its elementary functions replaced, everything else numpy's own."""

    sqrt, log, arctan, arcsinh = (
        staticmethod(np.frompyfunc(f, 1, 1)) for f in (mp.sqrt, mp.log, mp.atan, mp.asinh)
    )
    arctan2 = staticmethod(np.frompyfunc(mp.atan2, 2, 1))

    def __getattr__(self, name):
        return getattr(np, name)


def test_double_precision_keeps_its_digits_near_and_far(monkeypatch):
    """The same formulas with 40 digits. Cancellation in the corner sums stays below 1e-13 of a cell's own
    stress at any distance (the project's bound is 1e-10), and below 1e-7 of the coefficient itself 60 cells
    away.
    """
    exact = np.frompyfunc(mp.mpf, 1, 1)
    for i, j, z in ((0, 0, 0.55), (1, 0, 0.31), (0, 1, 1e-3), (5, 3, 4.0), (60, 45, 20.0)):
        x, y = (np.array([i - 0.5, i + 0.5]) * HX)[:, None], (np.array([j - 0.5, j + 0.5]) * HY)[None, :]
        double = without_own(x, y, z, FACES, 0.3)
        with monkeypatch.context() as patch, mp.workdps(40):
            patch.setattr(eigenstrain, "np", ManyDigits())
            patch.setattr(primitives, "np", ManyDigits())
            answer = corner_sum(exact(x), exact(y), mp.mpf(z), exact(FACES), 0.3)
        error = np.abs((double - answer).astype(float)).max()
        assert error < 1e-13 and error < 1e-7 * np.abs(answer.astype(float)).max()


@pytest.mark.parametrize(
    ("z", "faces"), [(0.3, FACES), (-0.1, FACES), (0.1, [0.0, 0.5, 0.5]), (0.1, [-1.0, 1.0])]
)
def test_depths_on_a_face_or_out_of_order_are_refused(z, faces):
    with pytest.raises(ValueError, match=r"faces|z_observed"):
        residual_stress_coefficients(Cuboids(Lags(2, 2, 1.0, 1.0), tuple(faces), 0.3), z)
