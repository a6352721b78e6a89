# SPDX-License-Identifier: MIT
"""Reference solutions of the coated half-space: stresses, where a film matters, a two-layer pavement."""

import math

import numpy as np
import pytest
from test_coated_references import PAPER, STEEL

from verification.reference.burmister import disc_stress, interface_stress
from verification.reference.coated_changes import (
    breaking_thickness,
    film_contact,
    largest_mises,
    pressure_change,
)
from verification.reference.coated_sphere import solve_radius
from verification.reference.hertz import subsurface_stress
from verification.reference.layered_axisymmetric import (
    CoatedHalfSpace,
)
from verification.reference.stress import von_mises

# --- stresses -----------------------------------------------------------------------------------------------

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


def test_largest_von_mises_is_not_below_a_finer_scan():
    contact = film_contact(0.2, 10.0)
    found = largest_mises(contact)
    film = largest_mises(contact, film=True)
    r, z = np.linspace(0, 1.2, 61), np.linspace(0.2, 1.5, 66)
    scan = np.max(von_mises(contact.stress(r, z)))
    assert 1 - 1e-6 < found.value / scan < 1 + 2e-3  # the scan's own spacing
    assert film.value > found.value and film.z <= 0.2 <= found.z


# --- where the film matters ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "young, counter, limit, expected",
    [
        (PAPER, math.inf, 0.05, 0.065),
        (40 / 210, STEEL, 0.05, 0.052),
        (130 / 210, math.inf, 0.05, 0.171),
        (PAPER, STEEL, 0.01, 0.024),
    ],
)
def test_breaking_thickness_of_the_pressure(young, counter, limit, expected):
    """Values of another program, to their last digit; the change there is the limit."""
    h = breaking_thickness(young, counter=counter, limit=limit)
    assert h == pytest.approx(expected, abs=6e-4)
    assert abs(pressure_change(film_contact(h, young, counter=counter))) == pytest.approx(limit, rel=1e-5)


def test_a_film_of_the_body_never_breaks_and_a_soft_one_at_once():
    assert breaking_thickness(1.0) == math.inf
    with pytest.raises(ValueError, match=r"limit = 1e-06 is passed at thickness/a0 = 0\.002"):
        breaking_thickness(PAPER, limit=1e-6)


# --- two-layer pavement -------------------------------------------------------------------------------------


def test_pavement_is_smooth_at_the_incompressible_limit():
    """No 1/(1 - 2 nu) in the solution: nu = 0.5 - 1e-9 differs by that order."""
    assert interface_stress(1.0, 10.0, 0.5 - 1e-9, 0.5 - 1e-9) == pytest.approx(
        interface_stress(1.0, 10.0), abs=1e-8
    )


def test_disc_on_one_material_in_closed_form():
    """Axis (Johnson 3.32): s_rr/p = -(1 + 2 nu)/2 + (1 + nu) z/w - z^3/(2 w^3), w^2 = a^2 + z^2; in film and
    body.
    """
    nu, z = 0.3, np.array([0.1, 0.5, 1.0, 3.0])
    stress = disc_stress(CoatedHalfSpace(1.0, nu, 1.0, 1.0, nu), 1.0, 0.0, z)[0]
    c = z / np.hypot(1.0, z)
    np.testing.assert_allclose(stress[:, 2], -1 + c**3, rtol=0, atol=1e-12)
    for component in (0, 1):
        np.testing.assert_allclose(
            stress[:, component], -(1 + 2 * nu) / 2 + (1 + nu) * c - c**3 / 2, rtol=0, atol=1e-12
        )
