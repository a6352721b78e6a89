# SPDX-License-Identifier: MIT
"""References of the coated half-space, under waves, a sphere, a disc and a traction."""

import math

import numpy as np
import pytest
from many_digits import ManyDigits

from verification.reference.burmister import disc_stress
from verification.reference.coated_changes import film_contact, largest_bare_mises, largest_mises
from verification.reference.coated_sphere import solve_force, solve_radius, thin_layer
from verification.reference.coated_traction import coated_sliding_stress
from verification.reference.hamilton import sliding_stress
from verification.reference.hertz import largest_von_mises, subsurface_stress
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises

PAPER = 80 / 210  # E1/E2 of Table 1 of Bosman & Schipper (2011)
LAYERS = [CoatedHalfSpace(2.0, 0.3, 0.4, 1.0, 0.2), CoatedHalfSpace(0.2, 0.5, 0.4, 1.0, 0.3)]


# response to J0(k r)


@pytest.mark.parametrize(
    "young, nu, nu_body", [(PAPER, 0.3, 0.3), (1e3, 0.2, 0.4), (1e-3, 0.5, 0.0), (1e6, 0.3, 0.3)]
)
@pytest.mark.parametrize("kh", [1e-8, 1e-3, 1.0, 30.0])
def test_harmonics_equal_the_plane_wave_of_many_digits(young, nu, nu_body, kh):
    """J0, J1 and cos, sin share their depth functions; there by Papkovich-Neuber potentials and 60 digits.

    Tolerance: rounding times the ratio of the moduli, the condition of the system; s_LL is of the size of
    that ratio.
    """
    layers, exact = CoatedHalfSpace(young, nu, 1.0, 1.0, nu_body), ManyDigits(kh, young, nu, nu_body)
    k = np.array([kh])
    accuracy = 1e-14 * max(young, 1 / young)
    unit = (1 + nu) * 2 / young / kh  # 1/(mu k)
    assert layers.compliance(k)[0] == pytest.approx(float(exact.surface()[0]) * unit, rel=accuracy)
    for s, film in ((0.5 * kh, True), (kh, True), (kh, False), (1.5 * kh, False)):
        zz, rz, rr, tt, _ = layers.profiles(k, layers.amplitudes(k), s / kh, film)[:, 0]
        expected = np.array(exact.state(s, 0, body=not film)[2:], dtype=float)
        off = np.abs([zz, rr, tt, rz] - expected).max()
        assert off <= accuracy * np.max(np.abs(expected)) + 1e-15


def test_waves_of_full_contact():
    """p = z/c_zz(k) over that without film, film of Table 1 (0.1 um): values of another program."""
    layers = CoatedHalfSpace(80e9, 0.3, 0.1e-6, 210e9, 0.3)
    k = 2 * np.pi / (np.array([1, 2, 5, 10, 20, 50]) * 1e-6)
    bare, coated = 2 / (layers.modulus_body * k), layers.compliance(k)
    rigid, steel = bare / coated, 2 * bare / (coated + bare)
    np.testing.assert_allclose(rigid, [0.68791, 0.81461, 0.91480, 0.95492, 0.97676, 0.99052], atol=5.1e-6)
    np.testing.assert_allclose(steel, [0.81510, 0.89783, 0.95550, 0.97694, 0.98824, 0.99524], atol=5.1e-6)


# coated sphere

# rigid paraboloid, nu = 0.3, values of another program: E1/E2, h/a0: p(0)/p0, a/a0, approach ratio
TABLE = {
    (PAPER, 0.1): (0.92655, 1.07866, 1.04509),
    (PAPER, 0.5): (0.73740, 1.21664, 1.19339),
    (PAPER, 1.0): (0.61839, 1.29633, 1.33858),
    (PAPER, 2.0): (0.54862, 1.35393, 1.52584),
    (2.0, 0.1): (1.03223, 0.95975, 0.98090),
    (2.0, 0.5): (1.22803, 0.86969, 0.91020),
    (2.0, 1.0): (1.47544, 0.81848, 0.82687),
    (2.0, 2.0): (1.56845, 0.79822, 0.74256),
}


@pytest.mark.parametrize("case", TABLE)
def test_coated_sphere_of_the_table(case):
    contact = film_contact(case[1], case[0])
    bare = contact.bare
    ratios = contact.contact_radius / bare.contact_radius, contact.approach / bare.approach
    found = contact.central_pressure / bare.peak_pressure, *ratios
    np.testing.assert_allclose(found, TABLE[case], atol=1.1e-5)
    assert contact.residual() < 1e-12


@pytest.mark.parametrize("young", [0.1, 10.0])
def test_thick_film_is_its_own_half_space(young):
    """p(0)/p0 -> (E1/E2)^(2/3), a/a0 -> (E2/E1)^(1/3); the next term is of order (a/h)^3."""
    contact = film_contact(300.0, young)
    assert contact.central_pressure / contact.bare.peak_pressure == pytest.approx(young ** (2 / 3), rel=1e-6)
    assert contact.contact_radius == pytest.approx(young ** (-1 / 3), rel=1e-6)


def test_thin_layer_on_a_rigid_base():
    """Johnson 5.8: ratios 1 + c h/a, extrapolated linearly, are 1 to the square of h/a (0.02)."""
    ratios = []
    for h in (0.02, 0.01):
        layers = CoatedHalfSpace(1.0, 0.3, h, 1e8, 0.3)
        contact, (peak, force) = solve_radius(layers, 1.0, 1.0), thin_layer(layers, 1.0, 1.0)
        ratios.append(np.array([contact.central_pressure / peak, contact.force / force]))
        assert contact.residual() < 1e-10
    assert np.all(np.abs(ratios[0] - 1) < 0.02)
    np.testing.assert_allclose(2 * ratios[1] - ratios[0], 1.0, atol=1e-4)


# stresses

R = np.array([0.0, 0.4, 0.95, 1.3])


def test_stresses_of_equal_materials_are_those_of_huber():
    contact = solve_radius(CoatedHalfSpace(1.0, 0.3, 0.2, 1.0, 0.3), 1.0, 1.0)
    z = np.array([0.0, 0.05, 0.2, 0.5, 2.0])
    bare = subsurface_stress(R[:, None], 0.0, z, contact.bare.peak_pressure, contact_radius=1.0, nu=0.3)
    np.testing.assert_allclose(contact.stress(R, z), bare, rtol=0, atol=1e-11 * contact.bare.peak_pressure)


@pytest.mark.parametrize("young, nu, h", [(PAPER, 0.3, 0.1), (10.0, 0.3, 0.3), (0.5, 0.5, 1.0)])
def test_stresses_of_the_coated_contact(young, nu, h):
    """Surface: the pressure. Interface: tractions and hoop strain equal. Any plane carries the force."""
    contact = film_contact(h, young, poisson=nu, poisson_body=0.25)
    layers, p = contact.layers, contact.central_pressure
    r = R * contact.contact_radius
    surface = contact.stress(r, 0.0)[:, 0]
    np.testing.assert_allclose(surface[:, 2], -contact.pressure(r), rtol=0, atol=1e-11 * p)
    np.testing.assert_allclose(surface[:, 4], 0.0, rtol=0, atol=1e-12 * p)
    above, below = contact.stress(r, h, film=True)[:, 0], contact.stress(r, h)[:, 0]
    np.testing.assert_allclose(above[:, [2, 4]], below[:, [2, 4]], rtol=0, atol=1e-11 * p)

    def hoop(s, E, ratio):
        return (s[:, 1] - ratio * (s[:, 0] + s[:, 2])) / E

    jump = hoop(above, layers.young, nu) - hoop(below, layers.young_body, 0.25)
    assert np.max(np.abs(jump)) < 1e-11 * p / min(layers.young, layers.young_body)
    edges = contact.contact_radius * np.array([0, 0.5, 0.8, 0.95, 1, 1.05, 1.2, 1.5, 2.5, 6, 15, 40, 80])
    t, w = np.polynomial.legendre.leggauss(20)
    half = np.diff(edges)[:, None] / 2  # panels graded towards the rim
    s, ds = (edges[:-1, None] + half * (1 + t)).ravel(), (half * w).ravel()
    for z in (0.5 * h, h, 2 * h):
        carried = 2 * math.pi * -contact.stress(s, z)[:, 0, 2] * s * ds
        missing = [1 - np.sum(carried[s < end]) / contact.force for end in edges[-2:]]
        # a point force leaves (z/R)^3 of itself beyond R: little, and nearly an eighth of it beyond 2 R
        assert abs(missing[1]) < 1e-4
        assert abs(missing[1] - (missing[0] - missing[1]) / 7) < 0.3 * abs(missing[1]) + 1e-9


def test_largest_von_mises_is_that_of_hertz_and_not_below_a_finer_scan():
    """Bare on the axis, and at the interface of a thick film; of film and body."""
    bare = film_contact(0.1, PAPER)
    found = largest_bare_mises(bare)
    value, z = largest_von_mises(bare.bare.peak_pressure, bare.bare.contact_radius, 0.3)
    assert (found.value, found.r) == (pytest.approx(value, rel=1e-6), 0) and abs(found.z - z) < 2e-3
    assert largest_bare_mises(film_contact(1.0, PAPER)).z == 1.0
    contact = film_contact(0.2, 10.0)
    found = largest_mises(contact)
    film = largest_mises(contact, film=True)
    r, z = np.linspace(0, 1.2, 61), np.linspace(0.2, 1.5, 66)
    scan = np.max(von_mises(contact.stress(r, z)))
    assert 1 - 1e-6 < found.value / scan < 1 + 2e-3  # the scan's own spacing
    assert film.value > found.value and film.z <= 0.2 <= found.z


def test_disc_on_one_material_in_closed_form():
    """s_rr/p = -(1 + 2 nu)/2 + (1 + nu) z/w - z^3/(2 w^3), w^2 = a^2 + z^2 (Johnson 3.32)."""
    nu, z = 0.3, np.array([0.1, 0.5, 1.0, 3.0])
    stress = disc_stress(CoatedHalfSpace(1.0, nu, 1.0, 1.0, nu), 1.0, 0.0, z)[0]
    c = z / np.hypot(1.0, z)
    np.testing.assert_allclose(stress[:, 2], -1 + c**3, rtol=0, atol=1e-12)
    across = -(1 + 2 * nu) / 2 + (1 + nu) * c - c**3 / 2
    np.testing.assert_allclose(stress[:, :2], np.stack([across, across], axis=-1), rtol=0, atol=1e-12)


# traction

X = np.array([-1.4, -0.95, -0.3, 0.0, 0.5, 1.0, 1.2])
SOFT, STIFF = CoatedHalfSpace(80.0, 0.3, 0.1, 210.0, 0.25), CoatedHalfSpace(900.0, 0.2, 0.4, 210.0, 0.3)
COATED = pytest.mark.parametrize("layers", [SOFT, STIFF], ids=["soft", "stiff"])
ROUNDING = 1e-12
"""Of the pressure: sums over some 1000 wave numbers of terms of order 1, and systems of condition 10 to 1000.
"""


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_one_material_is_hamilton(nu):
    """The body by quadrature alone; the film by what the interface sends back, nothing."""
    layers = CoatedHalfSpace(2.0, nu, 0.1, 2.0, nu)
    for film, z in ((True, np.array([0.0, 0.05, 0.1])), (False, np.array([0.1, 0.3, 1.0]))):
        found = coated_sliding_stress(layers, 3.0, 1.0, 0.4, x=X, z=z, film=film)
        exact = sliding_stress(X[:, None], 0.0, z[None, :], 3.0, contact_radius=1.0, nu=nu, friction=0.4)
        assert np.abs(found - exact).max() < 3.0 * ROUNDING


@COATED
def test_the_surface_carries_the_load(layers):
    stress = coated_sliding_stress(layers, 1.0, 1.0, 0.4, x=X, z=0.0, film=True)[:, 0]
    pressure = np.sqrt(np.clip(1.0 - X**2, 0.0, None))
    assert np.abs(stress[:, 2] + pressure).max() < ROUNDING
    assert np.abs(stress[:, 4] + 0.4 * pressure).max() < ROUNDING


@COATED
def test_the_interface_holds_together(layers):
    """Both sides have the tractions and the strains along the interface in common, and nothing else."""
    h = layers.thickness
    sides = (coated_sliding_stress(layers, 1.0, 1.0, 0.4, x=X, z=h, film=side) for side in (True, False))
    film, body = (side[:, 0].T for side in sides)
    assert np.abs(film - body)[2:5].max() < ROUNDING
    laws = (layers.young, layers.poisson), (layers.young_body, layers.poisson_body)
    strains = []
    for (xx, yy, zz, *_), (young, nu) in zip((film, body), laws, strict=True):
        strains.append(np.array([xx - nu * (yy + zz), yy - nu * (xx + zz)]) / young)
    assert np.abs(strains[0] - strains[1]).max() < ROUNDING * np.abs(strains[0]).max() * 100
    assert np.abs(film - body)[:2].max() > 0.1


# bad input


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: CoatedHalfSpace(0.0, 0.3, 1.0, 1.0, 0.3), "young = 0.0"),
        (lambda: CoatedHalfSpace(1.0, 0.3, 1.0, 1.0, 0.6), "poisson_body = 0.6"),
        (lambda: LAYERS[0].compliance([0.0]), "k must be > 0"),
        (lambda: solve_radius(LAYERS[0], 1.0, 1e3), "thickness/contact_radius = 0.0004 must be >= 0.001"),
        (lambda: solve_radius(LAYERS[0], 1.0, 1.0, counter_modulus=-1.0), "counter_modulus = -1.0 must be >"),
        (lambda: solve_force(LAYERS[0], 1.0, math.nan), "force = nan"),
        (lambda: film_contact(0.5, 1.0).stress(0.0, 0.6, film=True), "z must be <= thickness = 0.5"),
        (lambda: disc_stress(LAYERS[0], 1.0, 0.0, 0.0), "z must be >= contact_radius/1000"),
        (lambda: thin_layer(LAYERS[1], 1.0, 1.0), "poisson = 0.5: an incompressible"),
        (lambda: coated_sliding_stress(SOFT, 1.0, 1.0, 0.4, x=X, z=0.2, film=True), "z must be <= thickness"),
        (lambda: coated_sliding_stress(SOFT, 1.0, 1.0, 0.4, x=X, z=0.05), "z must be >= thickness = 0.1 m"),
    ],
)
def test_bad_input_names_the_argument(call, message):
    with pytest.raises(ValueError, match=message):
        call()
