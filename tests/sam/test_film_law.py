# SPDX-License-Identifier: MIT
"""The chemical film: return map against closed forms and a general solver, failures; the strain below it."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from sam.contact.operators import surface_strain
from sam.scene.body import Friction, growth_coefficient
from sam.tribofilm import FilmLaw, FilmState
from sam.tribofilm.law import Loads, printed_stress, radial_flow
from verification.cases.film import film_law
from verification.reference.bonded_film import in_plane_strain, printed_thinning, thinning
from verification.reference.film_flow import Film, FlowPoint

LAW = FilmLaw(80e9, 0.3, 2e9 / 3.0, 0.1, 0.4, np.inf)
STEEL = 210e9, 0.3


def cells(*values):
    """(n, 1) or (k, n, 1) from lists."""
    return np.array(values, dtype=float)[..., None]


def at_centre(law, pressures, body=STEEL):
    """A fresh film under each pressure, on a body strained as at the centre of a Hertz contact."""
    e = cells(*(in_plane_strain(p, *body) for p in pressures))
    state = FilmState.fresh((len(pressures), 1))
    return law.step(state, np.stack([e, e, 0.0 * e]), cells(*pressures), bulk_normal=2.0 * e)


class TestClosedForms:
    @pytest.mark.parametrize(
        ("low", "pressures", "percent"),
        [
            (0.0, (2e9, 3e9, 4e9, 5e9, 6.5e9), (0.338, 1.0905, 1.8429, 2.5952, 3.7238)),
            (0.1, (2e9, 3e9, 3.5e9, 3.8e9), (0.508, 1.526, 2.148, 2.673)),
        ],
    )
    def test_numbers_computed_elsewhere(self, low, pressures, percent):
        """By another code, with three and four digits behind the point; and the closed form, to rounding."""
        state, film = at_centre(replace(LAW, low=low), pressures), (LAW.young, LAW.poisson, LAW.yield_stress)
        assert 100.0 * state.thinning[:, 0] == pytest.approx(percent, abs=5.1e-4) and not state.failed.any()
        exact = [thinning(p, low, in_plane_strain(p, *STEEL), film) for p in pressures]
        assert state.thinning[:, 0] == pytest.approx(exact, rel=1e-12)

    @pytest.mark.parametrize(("nu", "body_nu"), [(0.0, 0.3), (0.25, 0.49), (0.3, 0.0), (0.3, 0.3)])
    def test_any_poisson_ratio(self, nu, body_nu):
        """Equal strains: exact in one step; the excess over the yield stress loses two digits at most."""
        pressures, body = (1.9e9, 2.7e9, 3.3e9), (150e9, body_nu)
        for low in (0.0, 0.1):
            law = replace(LAW, poisson=nu, low=low)
            film = (law.young, nu, law.yield_stress)
            exact = [thinning(p, low, in_plane_strain(p, *body), film) for p in pressures]
            found = at_centre(law, pressures, body).thinning[:, 0]
            assert found == pytest.approx(exact, rel=1e-12, abs=1e-16)

    def test_printed_form_thickens(self):
        """And relieves what it has strained: a second step at the same strains adds nothing."""
        law, film = replace(LAW, printed=True), (LAW.young, LAW.poisson, LAW.yield_stress)
        pressures = (0.5e9, 1e9, 3e9, 6e9)
        exact = [printed_thinning(p, LAW.low, film, STEEL) for p in pressures]
        assert exact[0] == 0.0 and exact[-1] < -0.05
        state = at_centre(law, pressures)
        assert state.thinning[:, 0] == pytest.approx(exact, rel=1e-12) and not state.failed.any()
        e = cells(*(in_plane_strain(p, *STEEL) for p in pressures))
        again = law.step(state, np.stack([e, e, 0.0 * e]), cells(*pressures), bulk_normal=2.0 * e)
        assert again.plastic == pytest.approx(state.plastic, abs=1e-16)


class TestGeneralSolver:
    @pytest.mark.parametrize(("nu", "sign"), [(0.0, -1.0), (0.3, 1.0), (0.49, -1.0)])
    def test_random_steps(self, nu, sign):
        """Same implicit equations, another solver that meets its stresses within 1e-10."""
        law, film = replace(LAW, poisson=nu), Film(LAW.young, nu, LAW.yield_stress)
        rng, n = np.random.default_rng(4), 40
        pressure, strain = rng.uniform(0.0, 3.7e9, n), rng.normal(scale=5e-3, size=(3, n))
        plastic = rng.normal(scale=3e-3, size=(6, n))
        plastic[2] = -plastic[0] - plastic[1]
        start = FilmState(plastic[..., None], np.zeros((n, 1), dtype=bool))
        found = law.step(start, strain[..., None], pressure[:, None], sign=sign).plastic[..., 0]
        points = (FlowPoint(strain[:, k], p, -sign * 0.1 * p) for k, p in enumerate(pressure))
        right = np.stack([film.implicit_step(plastic[:, k], point) for k, point in enumerate(points)]).T
        assert np.abs(found - right).max() < 1e-9 * np.abs(right).max()
        assert np.sum(np.abs(right - plastic).max(axis=0) > 1e-6) > n / 2  # most of them flow

    def test_rates_meet_the_closed_form_in_equal_strains(self):
        p = 3.5e9
        e = in_plane_strain(p, *STEEL)
        path = [FlowPoint(np.zeros(3), 0.0, 0.0), FlowPoint(np.array([e, e, 0.0]), p, -0.1 * p)]
        exact = thinning(p, 0.1, e, (LAW.young, LAW.poisson, LAW.yield_stress))
        stops = [path[0].towards(path[1], share) for share in (0.0, 0.2, 0.9, 1.0, 0.9)]
        for points in (path, stops):  # elastic at 0.2 and on the way back
            found = -Film(80e9, 0.3, LAW.yield_stress).along(points)[2]
            assert found == pytest.approx(exact, rel=1e-9)  # digits 1e-12
        with pytest.raises(ArithmeticError, match="no strains off the plane"):
            Film(80e9, 0.3, 1e9).implicit_step(np.zeros(6), FlowPoint(np.zeros(3), 1e9, 0.6e9))


class TestFailure:
    def test_no_equilibrium_is_a_failure_and_no_strain(self):
        limit = 2e9 / 3.0 / (np.sqrt(3.0) * 0.1)
        state = at_centre(LAW, [0.9 * limit, (1.0 - 1e-12) * limit, (1.0 + 1e-12) * limit, 3.0 * limit])
        assert state.failed[:, 0].tolist() == [False, False, True, True]
        assert np.isfinite(state.plastic).all() and not state.plastic[:, 2:].any()
        assert not at_centre(replace(LAW, low=0.0), [3.0 * limit]).failed.any()

    def test_thinning_beyond_the_limit(self):
        whole = at_centre(LAW, [3e9]).thinning[0, 0]
        assert at_centre(replace(LAW, limit=whole * (1.0 - 1e-9)), [3e9]).failed.all()
        assert not at_centre(replace(LAW, limit=whole * (1.0 + 1e-9)), [3e9]).failed.any()

    def test_failure_lasts_and_the_strain_stands_still(self):
        law = replace(LAW, limit=0.01)
        failed = at_centre(law, [3.5e9, 5e9, 1e9])
        assert failed.failed[:, 0].tolist() == [True, True, False]
        later = law.step(failed, np.full((3, 3, 1), -0.05), cells(0.1e9, 0.1e9, 0.1e9))
        assert later.failed[:2].all() and np.array_equal(later.plastic[:, :2], failed.plastic[:, :2])
        assert law.coefficient(failed)[:, 0].tolist() == [0.4, 0.4, 0.1]

    def test_without_pressure_the_film_flows_but_does_not_fail(self):
        law = replace(LAW, limit=1e-3)
        strain = cells([0.03], [0.03], [0.0])
        state = law.step(FilmState.fresh((1, 1)), strain, cells(0.0))
        assert state.thinning[0, 0] > 1e-3 and not state.failed.any()
        assert law.step(state, strain, cells(1e6)).failed.all()

    def test_sign_of_the_traction_mirrors_the_shear_alone(self):
        strain, pressure = cells([1e-3], [-4e-3], [2e-3]), cells(3e9)
        plus, minus = (LAW.step(FilmState.fresh((1, 1)), strain, pressure, sign=sign) for sign in (1.0, -1.0))
        mirrored = plus.plastic * np.array([1, 1, 1, 1, -1, 1])[:, None, None]
        assert np.array_equal(minus.plastic, mirrored) and plus.plastic[4, 0, 0] < 0.0  # s_xz = -q

    @pytest.mark.parametrize(
        ("law", "change", "message"),
        [
            ({}, {"strain": np.zeros((3, 2, 1))}, "must be"),
            ({}, {"strain": np.full((3, 1, 1), np.nan)}, "must be finite"),
            ({}, {"pressure": cells(-1.0)}, "nowhere below 0"),
            ({}, {"pressure": cells(np.inf)}, "must be finite"),
            ({"printed": True}, {}, "bulk_normal"),
        ],
    )
    def test_bad_input(self, law, change, message):
        loads = {"strain": np.zeros((3, 1, 1)), "pressure": cells(1e9)} | change
        with pytest.raises(ValueError, match=message):
            replace(LAW, **law).step(FilmState.fresh((1, 1)), **loads)


class TestScene:
    def test_law_of_a_scene(self):
        of_bath = film_law.friction_of(100.0)
        law = FilmLaw.of(of_bath)
        assert (law.young, law.poisson, law.yield_stress, law.low) == (80e9, 0.3, 2e9 / 3.0, 0.1)
        assert law.limit == pytest.approx(0.020415, abs=5e-7) and not law.printed and law.high == 0.4
        assert FilmLaw.of(of_bath.model_copy(update={"form": "printed"})).printed
        with pytest.raises(ValueError, match="chemical-film"):
            FilmLaw.of(Friction(coefficient=0.1))

    def test_growth_at_the_baths_of_table_3(self):
        """nm, to the digits given; between its rows the coefficient is linear."""
        growth = [1e9 * film_law.friction_of(bath).growth for bath in (50.0, 100.0, 150.0, 200.0)]
        assert growth == pytest.approx([1.3731, 2.04145, 2.5882, 2.7541], abs=5.1e-5)
        for bath, coefficient in pd.read_csv("verification/data/table-3.csv").to_numpy():
            exact, of_bath = coefficient * np.sqrt((314.15e-3 - 300e-6) / 1.0), film_law.friction_of(bath)
            assert 1e9 * of_bath.growth == pytest.approx(exact, rel=1e-12)
            assert 100.0 * of_bath.thinning_limit == pytest.approx(exact, rel=1e-12)
        assert growth_coefficient(398.15) == pytest.approx((3.644e-9 + 4.620e-9) / 2.0, rel=1e-14)


# Hooke's law and radial return against forms that are written otherwise

YOUNG = 80e9


def moduli(poisson):
    """Bulk and shear modulus."""
    return YOUNG / (3 - 6 * poisson), YOUNG / (2 + 2 * poisson)


@pytest.mark.parametrize("poisson", [0.0, 0.45])
def test_printed_stress_has_the_shear_modulus_once_and_lames_constant(poisson):
    bulk, shear = moduli(poisson)
    strain, normal = np.array([[1e-3], [-4e-4], [7e-4]]), np.array([2e-4])
    loads = Loads(np.zeros((6, 1)), strain, np.array([1e8]), np.array([3e7]), normal)
    found = printed_stress(loads, replace(LAW, young=YOUNG, poisson=poisson))[:, 0]
    normals = np.array([1e-3, -4e-4, 2e-4])
    expected = (bulk - 2 / 3 * shear) * normals.sum() + shear * normals + [0.0, 0.0, 1e8]
    np.testing.assert_allclose(found, [*expected, 0.0, 3e7, 0.0], rtol=1e-12)


@pytest.mark.parametrize("component", range(6))
def test_printed_flow_of_one_component_ends_on_the_yield_surface(component):
    """Pure shear yields at k = sigma_y/sqrt(3), tension at sigma_y; what flows takes the rest."""
    _, shear = moduli(0.3)
    stress, plastic = np.zeros((6, 1)), np.zeros((6, 1))
    stress[component] = 9e8
    yield_stress, size = 3e8, 1.5 ** (component < 3)  # of a tension s the deviator is 2/3 s along it
    law = replace(LAW, young=YOUNG, poisson=0.3, yield_stress=yield_stress)
    flow = radial_flow(stress, plastic, law)[:, 0]
    bearable = yield_stress if component < 3 else yield_stress / np.sqrt(3)
    assert flow[component] == pytest.approx((9e8 - bearable) / size / (2 * shear), rel=1e-12)
    assert flow[:3].sum() == pytest.approx(0.0, abs=1e-18)
    held = np.full((6, 1), 1e-3) * np.array([[1.0], [-0.5], [-0.5], [0.4], [0.3], [0.2]])
    moved = radial_flow(stress + 2 * shear * held, held, law)[:, 0]
    np.testing.assert_allclose(moved, flow, rtol=1e-10, atol=1e-18)


def test_surface_strain_follows_a_line_through_two_layers():
    """Strain that is linear in depth, half elastic and half plastic."""
    depths, slope = np.array([0.3, 1.1]), np.array([2e-3, -1e-3, 5e-4, 4e-4])
    total = np.array([1e-3, 2e-3, -1e-3, 3e-4])[:, None] + slope[:, None] * depths
    bulk, shear = moduli(0.3)
    half = np.zeros((6, 2))
    half[[0, 1, 5, 2]] = total / 2
    stress = 2 * shear * half
    stress[:3] += (bulk - 2 / 3 * shear) * half[:3].sum(axis=0)
    fields = (each[:, :, None, None] for each in (stress, half))
    found = surface_strain(*fields, depths, young=YOUNG, poisson=0.3)[:, 0, 0]
    np.testing.assert_allclose(found, [1e-3, 2e-3, -1e-3, 3e-4], rtol=1e-11)
