# SPDX-License-Identifier: MIT
"""Frequency response of a coated half-space against a solve with 60 digits, and its limits."""

import random
from dataclasses import replace

import numpy as np
import pytest
from rounding import close

from sam.layered.response import Layers, Response, normal_compliance, sinh_excess
from verification.reference import layered_errors
from verification.reference.layered import ManyDigits
from verification.reference.layered_errors import Worst, all_points, worst_errors

STEEL, FILM = (210e9, 0.3), (80e9, 0.3)
COATED = Layers(*FILM, 1e-7, *STEEL)


def points():
    """The corners of the range and a fixed draw of the rest: 5 ms each."""
    corners = [
        (kh, ratio, *nus)
        for kh in (1e-8, 1e4)
        for ratio in (1e-6, 1e6)
        for nus in ((0, 0.5), (0.5, 0), (0.5, 0.5))
    ]
    rng = random.Random(6)
    between = [
        (
            10 ** rng.uniform(-8, 4),
            10 ** rng.uniform(-6, 6),
            rng.choice([0.5, rng.uniform(0, 0.5)]),
            rng.uniform(0, 0.5),
        )
        for _ in range(40)
    ]
    return corners + rng.sample(all_points(), 80) + between


def test_whole_range_against_many_digits():
    """The bounds of the project. Measured: 9e-16, 9e-11, 4e-10, 6e-16, 2e-10 (1e-16 times the ratio of
    moduli, 1e6).
    """
    worst = worst_errors(points())
    bounds = {"c_zz": 1e-11, "matrix": 1e-9, "film": 1e-9, "body": 1e-9, "jump": 1e-9}
    for name, bound in bounds.items():
        assert worst[name].error < bound, f"{name}: {worst[name]}"


def test_moderate_ratios_lose_no_digits():
    """E1/E2 from 0.1 to 10: every quantity to 1e-13, some hundred roundings."""
    worst = worst_errors([p for p in points() if 0.1 <= p[1] <= 10])
    assert max(entry.error for entry in worst.values()) < 1e-13, worst


@pytest.mark.parametrize("field", ["young", "poisson", "poisson_body", "young_body"])
def test_a_changed_constant_is_seen(field, monkeypatch):
    """A relative change of 1e-7 in one material constant breaks every bound that the constant matters for."""

    class Changed(Response):
        def __init__(self, layers, kh):
            super().__init__(replace(layers, **{field: getattr(layers, field) * (1 + 1e-7)}), kh)

    monkeypatch.setattr(layered_errors, "Response", Changed)
    worst = worst_errors([(0.7, 80 / 210, 0.3, 0.25)])
    assert worst["c_zz"].error > 1e-11
    assert all(worst[name].error > 1e-9 for name in ("matrix", "film", "body")), worst


def test_not_a_number_is_the_worst():
    worst = Worst(0.5, "here")
    worst.update(float("nan"), "there")
    worst.update(1.0, "later")
    assert worst.where == "there"


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_equal_materials_are_a_bare_half_space(nu):
    """(1 - nu), -(1 - 2 nu)/2, 1 - nu, 1 for mu k c; nothing is reflected. 1e-10 is the project's bound."""
    layers = Layers(3.0, nu, 1.0, 3.0, nu)
    kh = np.geomspace(1e-8, 1e4, 61)
    response = Response(layers, kh)
    bare = np.array([1 - nu, -(1 - 2 * nu) / 2, 1 - nu, 1.0])
    assert np.abs(response.surface - bare[:, None]).max() < 1e-10
    assert np.abs(response.surface_excess).max() < 1e-14
    for z in (0.2, 1.0, 1.7):
        s = kh * z
        boussinesq = np.array([-(1 + s), -(1 - s), -2 * nu + 0 * s, -s]) * np.exp(
            -s
        )  # zz, LL, TT, zL under p
        assert np.abs(response.stress(z)[0][0] - boussinesq).max() < 1e-10


def test_excess_is_the_difference_from_a_half_space_of_film():
    """Where both are of order 1 the difference holds 1e-14."""
    kh, bare = np.geomspace(1e-3, 3, 21), Layers(*FILM, 1e-7, *FILM)
    coated, film = Response(COATED, kh), Response(bare, kh)
    assert np.abs(coated.surface - film.surface - coated.surface_excess).max() < 1e-13
    for z in (0.0, 0.4e-7, 0.9e-7):
        for mine, whole, half_space in zip(
            coated.coating_excess(z), coated.stress(z), film.stress(z), strict=True
        ):
            assert np.abs(whole - half_space - mine).max() < 1e-13


def test_interface_is_continuous():
    """zz, zL, zT pass through; the displacement does: the in-plane strains are equal (LL, TT; LT over mu)."""
    response = Response(COATED, np.geomspace(1e-8, 30, 50))
    (body, body_t), (film, film_t) = response.stress(1e-7), response.stress(np.nextafter(1e-7, 0))
    assert np.abs(body - film)[:, [0, 3]].max() < 1e-14 and np.abs(body_t - film_t)[0].max() < 1e-14
    strains = []
    for stress, (young, nu) in ((film, FILM), (body, STEEL)):
        zz, along, across = stress[:, 0], stress[:, 1], stress[:, 2]
        strains.append(np.array([along - nu * (across + zz), across - nu * (along + zz)]) / young)
    assert np.abs(strains[0] - strains[1]).max() < 1e-13 * np.abs(strains[0]).max()
    assert np.allclose(film_t[1] / FILM[0], body_t[1] / STEEL[0], rtol=1e-13, atol=1e-26)  # equal nu


def test_limits_of_the_compliance():
    """k h -> 0: the body; k h -> infinity: the film. The first correction is of order k h, so 1e-7 at
    1e-8.
    """
    k = np.array([1e-1, 1e12])
    moduli = 2 / (normal_compliance(COATED, k) * k)  # E/(1 - nu^2)
    assert moduli == pytest.approx([210e9 / 0.91, 80e9 / 0.91], rel=1e-6)
    assert normal_compliance(COATED, np.array([0.0]))[0] == np.inf


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_film_bonded_on_a_rigid_body(nu):
    """u = 0 at z = h: c_zz mu_1 k = (1 - nu) (kappa sinh 2H - 2H)/(kappa cosh 2H + 2 kh^2 + (1 +
    kappa^2)/2).
    """
    kh, kappa = np.geomspace(0.05, 20, 30), 3 - 4 * nu
    exact = (kappa * np.sinh(2 * kh) - 2 * kh) / (kappa * np.cosh(2 * kh) + 2 * kh * kh + (1 + kappa**2) / 2)
    ours = Response(Layers(1.0, nu, 1.0, 1e14, 0.3), kh).surface[0]
    assert ours == pytest.approx(
        (1 - nu) * exact, rel=1e-9
    )  # the body's 1e-14 against 4e-5 at kh = 0.05, nu = 0.5


def test_no_overflow_far_beyond_the_range():
    kh = np.geomspace(1e-80, 1e80, 33)
    for ratio in (1e-6, 1e6):
        response = Response(Layers(ratio, 0.5, 1.0, 1.0, 0.0), kh)
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            fields = [response.surface, response.surface_excess, *response.stress(0.5), *response.stress(3.0)]
        assert all(np.all(np.isfinite(field)) for field in fields)


def test_sinh_excess_keeps_its_digits():
    """x^3/6 (1 + x^2/20) e^{-x} for small x; the two branches meet at 1."""
    x = np.array([1e-6, 1e-3])
    assert sinh_excess(x) == close(np.exp(-x) * x**3 / 6 * (1 + x * x / 20), 1e-14)
    below, above = sinh_excess(np.array([1 - 1e-12, 1 + 1e-12]))
    assert below == pytest.approx(above, rel=1e-11)


@pytest.mark.parametrize(
    "field, value", [("young", 0.0), ("thickness", -1.0), ("poisson", 0.6), ("young_body", float("nan"))]
)
def test_bad_layers_are_refused(field, value):
    with pytest.raises(ValueError, match=field):
        replace(COATED, **{field: value})


def test_many_digits_do_not_depend_on_their_number():
    """The reference itself: 60 against 100 digits at the hardest corner."""
    few, many = (ManyDigits(1e-8, 1e6, 0.5, 0.0, digits=digits).surface() for digits in (60, 100))
    assert [float(a / b - 1) for a, b in zip(few, many, strict=True)] == pytest.approx([0] * 4, abs=1e-25)
