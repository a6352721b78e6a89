# SPDX-License-Identifier: MIT
"""Influence coefficients of a coated half-space against quadrature over wave vectors, partition, limits and
balances.
"""

import numpy as np
import pytest
from rounding import EPS, close, of_sum

import sam.layered.patches as patches
from sam.kernels.patches import STRESS, Lags, displacement_coefficients, parity, stress_coefficients
from sam.layered.patches import (
    Angular,
    CellIntegrals,
    LayeredPatches,
    RadialTable,
    quintic,
    spline_matrix,
    wave_numbers,
)
from sam.layered.response import Layers, Response
from verification.reference.quadrature import point_response

THICKNESS = 1e-7
COATED = Layers(80e9, 0.3, THICKNESS, 210e9, 0.25)
STIFF = Layers(2100e9, 0.2, THICKNESS, 210e9, 0.3)
SOFT = Layers(2e9, 0.5, THICKNESS, 210e9, 0.3)
QUADRATURE = 1e-9
"""Of the largest component, against quadrature; measured 3e-10 and below (issue: 1e-7)."""
LAGS = [(0, 0), (1, 0), (3, 2), (0, 4)]


def waves(cell, lags, decay):
    """Wave vectors in polar panels (units 1/h) and the weights of each lag: k, phi, (lags, k, phi) complex
    weights.

    Gauss-Legendre in k up to 34/decay, where e^{-k decay} = 2e-15; trapezoidal in phi, exact once it resolves
    k r.
    """
    top, reach = 34 / decay, max(np.hypot((i + 1) * cell[0], (j + 1) * cell[1]) for i, j in lags)
    t, w = np.polynomial.legendre.leggauss(16)
    edges = np.linspace(0, top, 4 + int(top * reach / 10))
    edges = np.concatenate([[0], np.geomspace(1e-6, 1, 24) * edges[1], edges[2:]])
    k = (edges[:-1, None] + np.diff(edges)[:, None] * (t + 1) / 2).ravel()
    dk = (np.diff(edges)[:, None] * w / 2).ravel()
    count = 2 * int(top * reach / 2 + 40)
    phi = np.arange(count) * 2 * np.pi / count
    kx, ky = k[:, None] * np.cos(phi), k[:, None] * np.sin(phi)
    load = cell[0] * np.sinc(kx * cell[0] / 2 / np.pi) * cell[1] * np.sinc(ky * cell[1] / 2 / np.pi)
    load = load * (k * dk)[:, None] / (2 * np.pi * count)
    return k, phi, [load * np.exp(1j * (kx * i * cell[0] + ky * j * cell[1])) for i, j in lags]


def wave_tensors(in_plane, antiplane, phi, load):
    """Stress tensor in x, y, z, (3, 3, k, phi), of a traction e^{i k x} along x (1), y (2) or z (3)."""
    c, s, zero = np.cos(phi), np.sin(phi), np.zeros(in_plane.shape[-1])
    rotation = np.array([[c, -s, 0 * c], [s, c, 0 * c], [0 * c, 0 * c, 0 * c + 1]])  # columns: L, T, z
    total, turn = 0, np.einsum("iap,jbp->ijpab", rotation, rotation).reshape(-1, 9)
    for source in range(3):  # traction along L, T, z; sin = Re(-i e), so a load e^{ikL} along L has q_L = i
        if source == 1:
            zt, lt = antiplane
            local = np.array([[zero, 1j * lt, zero], [1j * lt, zero, zt], [zero, zt, zero]])
        else:
            zz, along, across, zl = in_plane[0] if source == 2 else 1j * in_plane[1]
            local = np.array([[along, zero, -1j * zl], [zero, across, zero], [-1j * zl, zero, zz]])
        turned = (turn @ local.reshape(9, -1)).reshape(3, 3, phi.size, -1)
        total = total + rotation[load - 1, source][:, None] * turned
    return np.swapaxes(total, -1, -2)


def by_quadrature(layers, cell, lags, height, load):
    """Six stresses at the lags, (lags, 6), at the depth height times thickness."""
    k, phi, weights = waves(cell, lags, height)
    tensor = wave_tensors(*Response(layers, k).stress(height * layers.thickness), phi, load)
    picked = [tensor[int(name[0]) - 1, int(name[1]) - 1] for name in STRESS]
    return np.array([[np.sum(f * w).real for f in picked] for w in weights])


def at(coefficients, lags):
    return np.array([coefficients[..., i, j] for i, j in lags])


@pytest.mark.parametrize("layers", [COATED, STIFF, SOFT], ids=["coated", "stiff", "soft"])
@pytest.mark.parametrize("load", [1, 2, 3])
def test_stress_equals_quadrature(layers, load):
    """In the film above and below the depth from which no closed form is taken out, at the interface, in the
    body.
    """
    for cell, height in (((1.0, 0.7), 0.8), ((0.4, 0.5), 0.6), ((0.4, 0.5), 1.0), ((0.7, 1.0), 2.5)):
        answer = by_quadrature(layers, cell, LAGS, height, load)
        lengths = cell[0] * THICKNESS, cell[1] * THICKNESS
        ours = at(
            LayeredPatches(layers).stress(Lags(4, 5, *lengths), [height * THICKNESS], load=load)[:, 0], LAGS
        )
        assert np.abs(ours - answer).max() < QUADRATURE * np.abs(answer).max(), (cell, height)


def displacement_by_quadrature(layers, cell, lags, load):
    """Surface displacement times mu_1/h, (lags, 3): difference from a half-space of film, and its closed
    form.
    """
    k, phi, weights = waves(cell, lags, 2.0)
    bare = Layers(layers.young, layers.poisson, layers.thickness, layers.young, layers.poisson)
    zz, zl, ll, tt = (Response(layers, k).surface - Response(bare, k).surface) / k
    zero = 0 * k
    local = np.array([[ll, zero, -1j * zl], [zero, tt, zero], [1j * zl, zero, zz]])  # rows: u, columns: load
    c, s = np.cos(phi), np.sin(phi)
    rotation = np.array([[c, -s, 0 * c], [s, c, 0 * c], [0 * c, 0 * c, 0 * c + 1]])
    u = np.einsum("iap,abk,bp->ikp", rotation, local, rotation[load - 1])
    excess = np.array([[np.sum(f * w).real for f in u] for w in weights])
    film = [
        displacement_coefficients(Lags(4, 5, *cell), layers.poisson, component=i, load=load)
        for i in (1, 2, 3)
    ]
    return excess + at(np.array(film), lags)


@pytest.mark.parametrize("layers", [COATED, STIFF, SOFT], ids=["coated", "stiff", "soft"])
@pytest.mark.parametrize("load", [1, 2, 3])
def test_displacement_equals_quadrature(layers, load):
    for cell in ((1.0, 0.7), (0.3, 0.4)):
        answer = displacement_by_quadrature(layers, cell, LAGS, load)
        lengths = cell[0] * THICKNESS, cell[1] * THICKNESS
        ours = [
            LayeredPatches(layers).displacement(Lags(4, 5, *lengths), component=i, load=load)
            for i in (1, 2, 3)
        ]
        ours = at(np.array(ours), LAGS) * layers.shear / THICKNESS
        assert np.abs(ours - answer).max() < QUADRATURE * np.abs(answer).max()


@pytest.mark.parametrize("load", [1, 3])
def test_each_changed_term_is_seen(load, monkeypatch):
    """Every term of the tables of entries, reversed, one after the other: the stress errs by more than
    1e-3.
    """
    lags, lengths = [(1, 1), (3, 2)], (0.4 * THICKNESS, 0.5 * THICKNESS)
    answer = by_quadrature(COATED, (0.4, 0.5), lags, 0.8, load)
    for key, terms in patches.STRESS_ENTRIES.items():
        if key[1] != load:
            continue
        for n, (table, angular, sign) in enumerate(terms):
            changed = (*terms[:n], (table, angular, -sign), *terms[n + 1 :])
            monkeypatch.setitem(patches.STRESS_ENTRIES, key, changed)
            ours = at(
                LayeredPatches(COATED).stress(Lags(4, 4, *lengths), [0.8 * THICKNESS], load=load)[:, 0], lags
            )
            assert np.abs(ours - answer).max() > 1e-3 * np.abs(answer).max(), (key, n)
            monkeypatch.setitem(patches.STRESS_ENTRIES, key, terms)


def refined(fine, name, load):
    """Coefficients of cells three times as wide from those of cells a third: (n, n) from (3 n, 3 n) lags."""
    px, py = parity(name, load)
    fine = np.concatenate([px * fine[1:2], fine])
    fine = np.concatenate([py * fine[:, 1:2], fine], axis=1)
    n = fine.shape[0] // 3
    return fine[: 3 * n, : 3 * n].reshape(n, 3, n, 3).sum(axis=(1, 3))


@pytest.mark.parametrize("over", [1e-3, 0.3, 30.0, 1e4])
@pytest.mark.parametrize("load", [1, 3])
def test_a_cell_is_the_sum_of_its_parts(over, load):
    """Nine cells of a third: near and far cells, closed form or not, at any ratio of cell to thickness
    (over).
    """
    coated, h = LayeredPatches(COATED), over * THICKNESS
    depths = np.array([0.0, 0.2, 0.9, 1.0, 1.6, 8.0]) * THICKNESS
    fine, coarse = (
        coated.stress(Lags(45, 45, h / 3, h / 3), depths, load=load),
        coated.stress(Lags(15, 15, h, h), depths, load=load),
    )
    together = np.array([[refined(f, name, load) for f in fine[n]] for n, name in enumerate(STRESS)])
    largest = np.abs(coarse).max(axis=(0, 2, 3))
    assert np.all(np.abs(coarse - together).max(axis=(0, 2, 3)) < 3e-9 * largest)  # measured: below 1e-9
    for i in (1, 2, 3):
        fine, coarse = (
            coated.displacement(Lags(45, 45, h / 3, h / 3), component=i, load=load),
            coated.displacement(Lags(15, 15, h, h), component=i, load=load),
        )
        assert np.abs(coarse - refined(fine, str(i), load)).max() < 1e-9 * np.abs(coarse).max()


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", [1, 2, 3])
def test_equal_materials_are_the_closed_form(load, nu):
    """The displacement to rounding, nothing being added; the stress to that of the tables, 1e-9 of the
    largest.

    The displacement is a sum of eight terms x ln(y + r) at the corners, x up to 70 cells, r up to 72.
    """
    same, n = LayeredPatches(Layers(5e9, nu, THICKNESS, 5e9, nu)), (70, 20)
    hx, hy = THICKNESS, 0.6 * THICKNESS
    depths = np.array([0.0, 0.5, 0.95, 1.0, 2.0, 20.0]) * THICKNESS
    error = same.stress(Lags(*n, hx, hy), depths, load=load) - (
        bare := stress_coefficients(Lags(*n, hx, hy), depths, nu, load=load)
    )
    assert np.all(np.abs(error).max(axis=(0, 2, 3)) < 1e-9 * np.abs(bare).max(axis=(0, 2, 3)))
    for i in (1, 2, 3):
        bare = displacement_coefficients(Lags(*n, hx, hy), nu, component=i, load=load)
        ours = same.displacement(Lags(*n, hx, hy), component=i, load=load) * same.layers.shear
        assert np.abs(ours - bare).max() < of_sum(np.full(8, 70 * np.log(2 * 72))) * hx


def test_deep_below_small_cells_equals_point_loads():
    """10 nm cells, 100 nm film, 5 um deep: closed-form corner sums cancel there, the tables do not."""
    same, h, z = LayeredPatches(Layers(5e9, 0.3, THICKNESS, 5e9, 0.3)), 1e-8, 5e-6
    for load in (1, 3):
        ours = same.stress(Lags(61, 41, h, h), [z], load=load)[:, 0, 60, 40]
        answer = (
            point_response(load, (60 * h, 40 * h, z), 0.3)[:6] * h * h
        )  # the cell is a point to (h/z)^2 = 4e-6
        assert np.abs(ours - answer).max() < 1e-5 * np.abs(answer).max()


def test_thin_and_thick_films_tend_to_bare_bodies():
    """The change is of order thickness/cell, or cell/thickness: 1e-6 of the largest displacement or stress,
    times 2.
    """
    n, h = (40, 30), 1e-6
    for ratio, (young, nu) in ((1e-6, (210e9, 0.25)), (1e6, (80e9, 0.3))):
        coated = LayeredPatches(Layers(80e9, 0.3, ratio * h, 210e9, 0.25))
        bare = displacement_coefficients(Lags(*n, h, h), nu) * (2 * (1 + nu) / young)
        assert np.abs(coated.displacement(Lags(*n, h, h)) - bare).max() < 2e-6 * bare.max()
        bare = stress_coefficients(Lags(*n, h, h), [0.5 * h, 3 * h], nu)
        assert np.abs(coated.stress(Lags(*n, h, h), [0.5 * h, 3 * h]) - bare).max() < 2e-6


def test_far_away_the_film_is_not_felt():
    """1000 thicknesses away the displacement is that of the body, but for h/r times the contrast of the
    materials.
    """
    ours = LayeredPatches(COATED).displacement(Lags(1001, 1, THICKNESS, THICKNESS))[-1, 0]
    bare = displacement_coefficients(Lags(1001, 1, THICKNESS, THICKNESS), 0.25)[-1, 0] * 2.5 / 210e9
    assert ours == close(bare, 2e-3)


@pytest.mark.parametrize("load, name, sign", [(3, "33", -1), (1, "13", -1), (2, "23", -1)])
def test_surface_and_interface_balance(load, name, sign):
    """z = 0: the traction and nothing else. Interface: 33, 23, 13 continuous, and the strains 11, 22, 12 of
    both sides.
    """
    coated = LayeredPatches(COATED)
    depths = [0.0, np.nextafter(THICKNESS, 0), THICKNESS]
    stress = coated.stress(Lags(30, 20, 0.5 * THICKNESS, 0.8 * THICKNESS), depths, load=load)
    expected = np.zeros((3, 30, 20))
    expected[("33", "23", "13").index(name), 0, 0] = sign
    assert np.abs(stress[2:5, 0] - expected).max() < 1e-11  # rounding of the tables at small radii
    film, body = stress[:, 1], stress[:, 2]
    assert np.abs(film - body)[2:5].max() < 1e-11
    strains = []
    for side, (young, nu) in ((film, (80e9, 0.3)), (body, (210e9, 0.25))):
        s11, s22, s33 = side[:3]
        shear = (1 + nu) * side[5]
        strains.append(np.array([s11 - nu * (s22 + s33), s22 - nu * (s11 + s33), shear]) / young)
    assert np.abs(strains[0] - strains[1]).max() < 1e-11 * np.abs(strains[0]).max()


@pytest.mark.parametrize("height", [0.4, 1.0, 3.0])
def test_the_load_is_carried_at_every_depth(height):
    """Sum of 33 over a plane of 400 cells: minus the force, up to what lies outside, (z/L)^3 of order
    1e-6.
    """
    z = height * THICKNESS
    s33 = LayeredPatches(COATED).stress(Lags(400, 400, THICKNESS, THICKNESS), [z], load=3, names=["33"])[0, 0]
    total = s33[0, 0] + 2 * (s33[1:, 0].sum() + s33[0, 1:].sum()) + 4 * s33[1:, 1:].sum()
    assert total == pytest.approx(-1.0, abs=1e-5)


@pytest.mark.parametrize(
    "over, factors", [(1.0, (0.6464, 0.2914, 0.0809, 0.0189)), (2.0, (0.9106, 0.6437, 0.2449, 0.0666))]
)
def test_published_stress_under_a_disc(over, factors):
    """sigma_33/p at the interface on the axis of a disc of radius `over` thicknesses, nu = 1/2, E1/E2 = 1 ...
    1000.

    Two-layer pavement (Fox 1948, after Burmister 1945): to the last digit of the tables.
    """
    for ratio, factor in zip((1, 10, 100, 1000), factors, strict=True):
        samples = Response(Layers(ratio, 0.5, 1.0, 1.0, 0.5), wave_numbers()).stress(1.0)[0][0, :1]
        disc = radial_values(RadialTable(samples, 0, 1.0), np.array([over]), "disc")  # int_0^over g r dr
        assert -2 * np.pi * disc[0] == pytest.approx(factor, abs=6e-5)


def radial_values(table, r, kind="point"):
    coefficients, power = table.coefficients(kind)
    return (spline_matrix(r[:, None], np.ones((r.size, 1)), power, len(coefficients)) @ coefficients)[:, 0]


@pytest.mark.parametrize("order, bias", [(0, 1.0), (1, 1.0), (1, 0.5), (2, 1.0), (3, 1.0)])
def test_radial_table_of_an_exponential(order, bias):
    """f = e^{-k}: g = (1 + m c) t^m/(1 + r^2)^1.5/(2 pi), c = sqrt(1 + r^2), t = r/(1 + c)  (int e^{-pk}
    J_m(kr) dk, -d/dp).
    """
    r = np.geomspace(1e-3, 1e3, 61)
    root = np.sqrt(1 + r * r)
    exact = (1 + order * root) * (r / (1 + root)) ** order / root**3 / (2 * np.pi)
    ours = radial_values(RadialTable(np.exp(-wave_numbers())[None], order, bias), r)
    assert np.abs(ours - exact).max() < 1e-11 * exact.max()  # rounding over r^bias at 1e-3, spline 1e-12


def test_quintic_pieces():
    """Sum 1; values and slopes of neighbouring pieces join; symbol at 0. 30 EPS: six terms of ten roundings,
    half an EPS each.
    """
    assert quintic(np.linspace(0, 1, 11)).sum(axis=-1) == pytest.approx(np.ones(11), abs=30 * EPS)
    assert quintic(np.array([0.0]))[0] == pytest.approx(np.array([1, 26, 66, 26, 1, 0]) / 120)
    assert quintic(np.array([1.0]))[0, 1:] == pytest.approx(quintic(np.array([0.0]))[0, :5])
    slope = np.diff(quintic(np.array([0.0, 1e-6, 1 - 1e-6, 1.0])), axis=0) / 1e-6
    assert slope[2, 1:] == pytest.approx(slope[0, :5], abs=1e-5)


@pytest.mark.parametrize("angular", [Angular(0), Angular(1), Angular(2, sine=True), Angular(3)])
def test_cells_of_a_known_function(angular):
    """Near, 5, 4, 3 and 2 point cells against 12 x 12 Gauss points of g: all but the cells at the origin."""
    table = RadialTable(np.exp(-wave_numbers())[None], angular.order, 1.0)
    ours = CellIntegrals(Lags(70, 12, 1.5, 1.0)).integrate(table, angular)[0]
    t, w = np.polynomial.legendre.leggauss(12)
    m = angular.order
    for i, j in ((3, 2), (5, 11), (14, 3), (30, 4), (50, 1), (69, 9)):
        x, y = (i + t[:, None] / 2) * 1.5, j + t[None, :] / 2
        r, root = np.hypot(x, y), np.sqrt(1 + x * x + y * y)
        g = (1 + m * root) * (r / (1 + root)) ** m / root**3 / (2 * np.pi) * angular(np.arctan2(y, x))
        exact = np.sum(g * w[:, None] * w) * 1.5 / 4
        assert ours[i, j] == pytest.approx(exact, abs=2e-11)  # of a largest value of 0.1


@pytest.mark.parametrize("cell", [1e-8, 1e-6, 1e-3])
@pytest.mark.parametrize("ratio", [1e-6, 1e6])
def test_no_overflow(cell, ratio):
    """100 nm film, cells from 10 nm to 1 mm, moduli 1e6 apart."""
    coated = LayeredPatches(Layers(ratio * 1e9, 0.5, THICKNESS, 1e9, 0.0))
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        for load in (1, 2, 3):
            assert np.all(
                np.isfinite(coated.stress(Lags(20, 15, cell, cell), [0.0, 5e-8, 1e-7, 1e-6, 1e-3], load=load))
            )
            assert np.all(np.isfinite(coated.displacement(Lags(20, 15, cell, cell), component=3, load=load)))


def test_a_bad_depth_is_refused():
    with pytest.raises(ValueError, match="depths"):
        LayeredPatches(COATED).stress(Lags(2, 2, 1e-8, 1e-8), [-1e-9])
