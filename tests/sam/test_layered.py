# SPDX-License-Identifier: MIT
"""A bonded film: response against 60 digits, coefficients against quadrature, coated scenes."""

from collections import defaultdict
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from builders import RADIUS, scene as small_scene
from many_digits import ManyDigits
from rounding import close

import sam
from sam import choose_grid
from sam.contact.convolution import Counters
from sam.contact.operators import CoatedBodies, CoatedPair, SurfaceOperators
from sam.grid.cells import Window
from sam.grid.demands import contact_radius, depths_with_film
from sam.half_space import ElasticConstants, ElasticPair
from sam.kernels.patches import STRESS, Lags, displacement_coefficients, stress_coefficients
from sam.layered.patches import LayeredPatches, Layers, RadialTable, Response, spline_matrix, wave_numbers
from sam.results.history import Coated, Comparison
from sam.results.tables import coated_quantities
from sam.scene import Scene, Status

THICKNESS = 1e-7
COATED = Layers(80e9, 0.3, THICKNESS, 210e9, 0.25)
STIFF = Layers(2100e9, 0.2, THICKNESS, 210e9, 0.3)
SOFT = Layers(2e9, 0.5, THICKNESS, 210e9, 0.3)

RATIOS = (1e-6, 1e-3, 0.1, 80 / 210, 1.0, 3.0, 1e3, 1e6)
POISSONS = ((0.0, 0.0), (0.3, 0.3), (0.5, 0.5), (0.0, 0.5), (0.5, 0.0), (0.3, 0.5), (0.5, 0.3), (0.25, 0.45))
WAVES = 10.0 ** np.arange(-8, 4.1, 2)  # kh, wave number times thickness

# the response to a wave


def worst_errors(points) -> dict[str, float]:
    """Worst errors of the response over points (kh, E1/E2, nu1, nu2); a NaN is the worst.

    c_zz: relative; matrix: relative to the largest of the four components at that kh; film, body: stress
    relative to the larger of the traction and the largest component at that kh and depth; jump: of szz and
    szL at the interface, over the traction, film against body, both of the response.
    """
    errors = defaultdict(list)
    for kh, ratio, nu1, nu2 in points:
        layers = Layers(ratio, nu1, 1.0, 1.0, nu2)
        answer, ours = ManyDigits(kh, ratio, nu1, nu2), Response(layers, np.array(kh))
        exact = np.array([float(c) for c in answer.surface()])
        errors["c_zz"].append(abs(ours.surface[0] / exact[0] - 1))
        errors["matrix"].append(np.abs(ours.surface - exact).max() / np.abs(exact).max())
        # in the film, at both sides of the interface, and a wave length into the body
        inside, below_it = (0.0, 0.3, 0.5, 0.9, np.nextafter(1.0, 0.0)), (1.0, 1.0 + 0.1 / kh, 1.0 + 1.0 / kh)
        for height in (*inside, *below_it):
            errors["film" if height < 1 else "body"].append(stress_error(answer, ours, height))
        below, above = ours.stress(1.0), ours.stress(np.nextafter(1.0, 0.0))
        jump = np.max([*np.abs(below[0] - above[0])[:, [0, 3]].ravel(), abs(below[1] - above[1])[0]])
        errors["jump"].append(jump)
    return {name: float(np.max(each)) for name, each in errors.items()}


def stress_error(answer: ManyDigits, ours: Response, height: float) -> float:
    """Largest error of ten stresses at z = height h, each load over its largest one, at least 1."""
    body = height >= 1
    in_plane, antiplane = ours.stress(height)
    s = answer.kh * height
    exact = [np.array([float(v) for v in answer.state(s, load, body)[2:]]) for load in range(2)]
    out = np.array([float(v) for v in answer.antiplane_stress(s, body)])
    pairs = [*zip(in_plane, exact, strict=True), (antiplane, out)]
    return np.max([np.abs(mine - right).max() / max(1.0, np.abs(right).max()) for mine, right in pairs])


@pytest.mark.parametrize(
    "kh, ratio, nus", [(1e-8, 1e6, (0, 0.5)), (1e4, 1e-6, (0.5, 0)), (0.7, 0.4, (0.3, 0.25))]
)
def test_response_against_many_digits(kh, ratio, nus):
    """The bounds of the project at corners of the range, whose middle loses some hundred roundings."""
    worst = worst_errors([(kh, ratio, *nus)])
    for name, bound in {"c_zz": 1e-11, "matrix": 1e-9, "film": 1e-9, "body": 1e-9, "jump": 1e-9}.items():
        assert worst[name] < (1e-13 if kh == 0.7 else bound), f"{name}: {worst[name]}"


def test_response_against_many_digits_over_the_whole_range():
    """Moduli over twelve decades lose digits in differences; c_zz is a sum of terms of one sign."""
    worst = worst_errors((kh, ratio, *nus) for ratio, nus, kh in product(RATIOS, POISSONS, WAVES))
    assert {name for name, each in worst.items() if not each <= 1e-9} == set()
    assert worst["c_zz"] <= 1e-11


@pytest.mark.parametrize(
    "field, value",
    [
        ("young", 0.0),
        ("thickness", -1.0),
        ("poisson", 0.5002),
        ("poisson_body", 0.5002),
        ("young_body", np.nan),
    ],
)
def test_bad_layers_are_refused(field, value):
    with pytest.raises(ValueError, match=field):
        replace(COATED, **{field: value})
    assert replace(COATED, poisson=0.5, poisson_body=0.5).poisson == 0.5


# coefficients of cells

QUADRATURE = 1e-9
"""Of the largest component, against quadrature; measured 3e-10 and below (issue: 1e-7)."""
LAGS = [(0, 0), (1, 0), (3, 2), (0, 4)]
MATERIALS = pytest.mark.parametrize(
    "layers, load", [(COATED, 1), (COATED, 2), (COATED, 3), (STIFF, 3), (SOFT, 1), (SOFT, 3)]
)


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


@MATERIALS
def test_stress_equals_quadrature(layers, load):
    """In the film on both sides of where a closed form is taken out, at the interface, in the body."""
    for cell, height in (((1.0, 0.7), 0.8), ((0.4, 0.5), 0.6), ((0.4, 0.5), 1.0), ((0.7, 1.0), 2.5)):
        answer = by_quadrature(layers, cell, LAGS, height, load)
        lags = Lags(4, 5, cell[0] * THICKNESS, cell[1] * THICKNESS)
        ours = at(LayeredPatches(layers).stress(lags, [height * THICKNESS], load=load)[:, 0], LAGS)
        assert np.abs(ours - answer).max() < QUADRATURE * np.abs(answer).max(), (cell, height)


def displacement_by_quadrature(layers, cell, lags, load):
    """Surface displacement times mu_1/h, (lags, 3): excess over a half-space of film, and that."""
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


@MATERIALS
def test_displacement_equals_quadrature(layers, load):
    for cell in ((1.0, 0.7), (0.3, 0.4)):
        answer = displacement_by_quadrature(layers, cell, LAGS, load)
        lags, patches = Lags(4, 5, cell[0] * THICKNESS, cell[1] * THICKNESS), LayeredPatches(layers)
        ours = at(np.array([patches.displacement(lags, component=i, load=load) for i in (1, 2, 3)]), LAGS)
        ours = ours * layers.shear / THICKNESS
        assert np.abs(ours - answer).max() < QUADRATURE * np.abs(answer).max()


@pytest.mark.parametrize("load, nu", [*product((1, 3), (0.0, 0.3, 0.5))])
@pytest.mark.parametrize("cell", [0.1, 1.0, 10.0])
def test_cells_of_equal_materials_are_as_without_film(cell, load, nu):
    """Smaller and larger than the thickness; radial tables of a spline of fifth degree hold 1e-11."""
    same, lags = LayeredPatches(Layers(2.0, nu, 1.0, 2.0, nu)), Lags(9, 9, cell, cell)
    depths = np.array([0.0, 0.3, 0.9, 1.0, 1.7, 6.0])
    bare = stress_coefficients(lags, depths, nu, load=load)
    error = same.stress(lags, depths, load=load, names=STRESS) - bare
    assert np.all(np.abs(error).max(axis=(0, 2, 3)) < 1e-10 * np.abs(bare).max(axis=(0, 2, 3)))
    largest = displacement_coefficients(lags, nu, component=load, load=load).max()
    for i in (1, 2, 3):
        bare = displacement_coefficients(lags, nu, component=i, load=load)
        ours = same.displacement(lags, component=i, load=load) * same.layers.shear
        assert np.abs(ours - bare).max() < 1e-10 * largest


@pytest.mark.parametrize("order, bias", [(0, 1.0), (1, 1.0), (1, 0.5), (2, 1.0), (3, 1.0)])
def test_radial_table_of_an_exponential(order, bias):
    """f = e^{-k}: g = (1 + m c) t^m/(1 + r^2)^1.5/(2 pi), c = sqrt(1 + r^2), t = r/(1 + c)."""
    r = np.geomspace(1e-3, 1e3, 61)
    root = np.sqrt(1 + r * r)
    exact = (1 + order * root) * (r / (1 + root)) ** order / root**3 / (2 * np.pi)
    spline, power = RadialTable(np.exp(-wave_numbers())[None], order, bias).coefficients("point")
    ours = (spline_matrix(r[:, None], np.ones((r.size, 1)), power, len(spline)) @ spline)[:, 0]
    assert np.abs(ours - exact).max() < 1e-11 * exact.max()  # rounding over r^bias at 1e-3, spline 1e-12


def test_a_bad_depth_is_refused():
    with pytest.raises(ValueError, match="depths"):
        LayeredPatches(COATED).stress(Lags(2, 2, 1e-8, 1e-8), [-1e-9])


# coated scenes

ALUMINIUM = {"young": 70e9, "poisson": 0.33}
FORCE = 0.65
A0 = (3 * FORCE * RADIUS * (1 - 0.3**2) / (4 * 210e9)) ** (1 / 3)  # Hertz: rigid sphere on bare steel
GIVEN = {"prescribed": "hertz", "p0": 4e9, "radius": 6e-6}


def coated(ratio=80 / 210, thickness=0.1, counterbody=None, *, cells=33, grid=None, bare=False, **keys):
    """ratio: E of the film over that of steel; thickness: in A0; bare: without it; keys of the load."""
    film = {"young": ratio * 210e9, "poisson": 0.3, "thickness": thickness * A0}
    return small_scene(
        body={"coating": None if bare else film},
        counterbody=counterbody or {},
        friction=keys.pop("friction", None),
        loading=keys,
        grid={"cells": (cells, cells)} | (grid or {}),
    )


def bare(a_scene: Scene) -> Scene:
    """The scene with the material of the body up to its surface."""
    return a_scene.model_copy(update={"body": a_scene.body.model_copy(update={"coating": None})})


@pytest.mark.parametrize(
    "more",
    [
        {"counterbody": ALUMINIUM, "steps": 2, "unload": True},
        {"counterbody": ALUMINIUM, "friction": {"coefficient": 0.3}},
        {"friction": {"coefficient": 0.3, "coupling": False}},
        {"friction": {"coefficient": 0.3}, **GIVEN},
    ],
    ids=["aluminium", "coupled", "decoupled", "given pressure"],
)
def test_a_film_of_the_material_of_the_body_changes_nothing(more):
    """Also its own comparison says so. 1e-9: ten times the tolerance of the contact."""
    depths = tuple(A0 * np.array([0, 0.1, 0.2, 0.5, 1.0]))
    same = coated(1.0, 0.2, cells=25, grid={"extent": (4 * A0, 4 * A0), "depths": depths}, **more)
    found, expected = sam.solve(same), sam.solve(bare(same))
    assert found.status is Status.CONVERGED and found.warnings == ()
    for name, value in expected.quantities.items():
        if value is not None and name not in ("mises_max_Pa", "mises_max_depth_m"):
            scale = A0 if name == "pressure_centroid_x_m" else abs(value)
            assert abs(found.quantities[name] - value) <= 1e-9 * scale, name
    for table, names in {"line": ("p_Pa", "uz_m", "ux_m", "qx_Pa"), "plane": ("mises_Pa",)}.items():
        for name in names:
            answer = np.asarray(expected.tables[table][name])
            off = np.nanmax(np.abs(found.tables[table][name] - answer), initial=0)
            assert off <= 1e-9 * np.nanmax(np.abs(answer), initial=0), name
    assert abs(found.quantities["p_max_change"]) < 1e-9 and abs(found.quantities["mises_max_change"]) < 1e-9


@pytest.mark.parametrize("deep, film, body", [(False, 4.0, None), (True, None, 4.0)])
def test_depths_on_one_side_of_the_interface_say_nothing_of_the_other(deep, film, body):
    depths, mises = np.arange(3.0) + 5 * deep, np.array([[1.0], [4.0], [1.0]])
    coating = Coated(4.0, np.zeros((1, 1)), Comparison(p_max=2.0, mises=mises / 2))
    found = coated_quantities(depths, mises, 3.0, coating)
    assert (found["mises_max_film_Pa"], found["mises_max_substrate_Pa"]) == (film, body)
    assert (found["mises_max_Pa"], found["mises_max_depth_m"]) == (4.0, depths[1])
    assert (found["p_max_bare_Pa"], found["p_max_change"]) == (2.0, 0.5)
    assert found.get("mises_max_bare_Pa") == (2.0 if deep else None)
    assert found.get("mises_max_change") == (1.0 if deep else None)


def test_traction_moves_the_coated_body_and_the_counter_body_apart():
    """Both parts by direct sums over cells, each with a coefficient of friction of its own."""
    rng, n, h = np.random.default_rng(1), 7, 0.3e-6
    layered, slip = LayeredPatches(Layers(80e9, 0.25, 0.4e-6, 210e9, 0.3)), (1 - 2 * 0.33) * 2 * 1.33 / 70e9
    pair = ElasticPair(ElasticConstants(210e9, 0.3), ElasticConstants(70e9, 0.33))
    mu, p = rng.random((n, n)), 1e9 * rng.random((n, n))
    kernel = layered.displacement(Lags(n, n, h, h), component=3, load=1)
    kernel = kernel - slip * h * displacement_coefficients(Lags(n, n, 1.0, 1.0), 0.0, component=3, load=1)
    lag = np.arange(n)[:, None] - np.arange(n)
    signed = np.sign(lag)[:, :, None, None] * kernel[np.abs(lag)[:, :, None, None], np.abs(lag)[None, None]]
    expected = np.einsum("ikjm,km->ij", signed, mu * p)
    bodies, modulus = CoatedBodies(CoatedPair(layered, pair, 0.4e-6), h), pair.contact_modulus
    grid = SurfaceOperators((n, n), 1.0, Counters(), coupling=mu, bodies=bodies)
    found = grid.tangential(grid.whole, grid.whole)(2 * p / modulus) * h
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    assert bodies.coarser() is bodies.coarser() and bodies.coarser().hx == 2 * h
    part = grid.tangential(Window(0, 0, n, n), Window(2, 3, 3, 2))(2 * p / modulus) * h
    assert np.abs(part - expected[2:5, 3:5]).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize(
    ("body", "key"),
    [
        ({"coating": {"yield_stress": 0.67e9}}, r"body\.coating\.yield_stress = 6\.7e\+08"),
        ({"plasticity": {"law": "perfect", "yield_stress": 1e9}}, "body.coating together with body"),
    ],
)
def test_yielding_is_refused_by_name(body, key):
    film = {"young": 80e9, "poisson": 0.3, "thickness": 1e-6} | body.pop("coating", {})
    a_scene = small_scene(body={"coating": film, **body})
    for function in (sam.check, sam.solve):
        with pytest.raises(
            sam.UnsupportedScene, match=key + ".*allows an elastic coating on an elastic body"
        ):
            function(a_scene)


def test_depths_hold_the_film_the_interface_and_what_is_below():
    base = 0.02 * np.arange(101)
    for thickness in (1e-4, 0.1, 0.5, 1.99, 3.0, 9.0):
        depths = depths_with_film(base, thickness)
        inside, below = depths[depths < thickness], depths[depths >= thickness]
        assert (np.diff(depths) > 0).all() and depths[0] == 0 and below[0] == thickness
        assert len(inside) >= 8 and 0 < thickness - inside[-1] < 1e-5 * thickness and len(below) >= 6
        assert below[-1] >= min(1.5 * thickness, 2.0)
    assert np.array_equal(depths_with_film(base, 11.0), base)
    given = coated(grid={"depths": (0.0, 1e-6, 3e-6)})
    assert choose_grid(given).depths.tolist() == [0.0, 1e-6, 3e-6]
    modulus = 210e9 / 0.91
    assert contact_radius(lambda k: 2 / (modulus * k), FORCE, RADIUS, (A0, A0)) == close(A0, 1e-9)


def test_a_bare_contact_that_does_not_fit_is_said_and_not_compared():
    """A hard film on steel: the bare contact is wider than the grid that is given; the coated one fits."""
    result = sam.solve(coated(50.0, 2.0, grid={"extent": (1.2 * A0, 1.2 * A0)}))
    assert result.status is Status.CONVERGED
    assert result.quantities["p_max_bare_Pa"] is None and result.quantities["p_max_change"] is None
    assert len(result.warnings) == 1 and "raise grid.extent" in result.warnings[0]
