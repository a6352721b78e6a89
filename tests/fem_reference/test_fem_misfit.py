# SPDX-License-Identifier: MIT
"""A misfit sphere in the axisymmetric model: against closed forms, and below a free surface."""

import numpy as np
import pytest

from fem_reference.axisymmetric.misfit import PROFILES, MisfitSphere
from fem_reference.axisymmetric.solution import solve
from fem_reference.common.bodies import Elastic
from sam.scene import Scene
from verification.reference.mindlin_cheng import EigenstrainSphere
from verification.reference.misfit_sphere import PROFILES as EXACT, GrowingSphere

A, YOUNG, NU = 1e-5, 210e9, 0.3  # radius in m, elastic constants
LINEAR = {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}


def sphere(plasticity=LINEAR, cells=6, **loading):
    given = {"prescribed": "misfit-sphere", "depth": 1.5 * A, "radius": A, "misfit": 0.02, "surface": "held"}
    body = {"young": YOUNG, "poisson": NU} | ({"plasticity": plasticity} if plasticity else {})
    return Scene(body=body, loading=given | loading, fem={"cells_per_radius": cells})


@pytest.mark.parametrize("profile", list(PROFILES))
def test_strain_and_mean_are_those_of_the_reference(profile):
    s = np.array([1e-3, 0.05, 0.0999, 0.1001, 0.4, 0.9995, 1.0005, 1.3, 4.0])
    local, mean = PROFILES[profile](s)
    exact, excess = EXACT[profile](s)
    assert local == pytest.approx(exact, abs=1e-14)
    assert mean - local == pytest.approx(excess, abs=1e-11)


def test_far_field_is_that_of_mindlin_and_cheng():
    """At the surface, and without traction there: by differences of the displacements."""
    young, nu, depth = 0.91, 0.3, 1.5
    free = MisfitSphere(Elastic(young, nu), depth, "ball", free=True)
    r, zero = np.array([0.5, 2.0, 7.0]), np.zeros(3)
    exact = EigenstrainSphere(1.0, 1.0, depth, young, nu)
    assert free.displacement(r, zero)[1] == pytest.approx(exact.surface_displacement(r, 0.0), rel=1e-12)
    h, lame = 1e-5, young * nu / ((1 + nu) * (1 - 2 * nu))
    shear = young / (2 * (1 + nu))
    of_z = (free.displacement(r, zero + h) - free.displacement(r, zero - h)) / (2 * h)
    of_r = (free.displacement(r + h, zero) - free.displacement(r - h, zero)) / (2 * h)
    trace = of_r[0] + free.displacement(r, zero)[0] / r + of_z[1]
    assert np.abs(lame * trace + 2 * shear * of_z[1]).max() < 1e-8
    assert np.abs(of_z[0] + of_r[1]).max() < 1e-8


@pytest.mark.parametrize("profile", list(PROFILES))
def test_nodal_forces_of_a_held_surface_do_the_work_of_its_tractions(profile):
    """Over displacements 1, r and r^2, which quadratic edges have: integrals of the closed form's stress."""
    depth, r = 1.5, np.array([0.0, 0.2, 0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.4])
    held = MisfitSphere(Elastic(0.91, 0.3), depth, profile, free=False)
    exact = GrowingSphere(0.91, 0.3, lambda peeq: 1e30 + 0 * peeq, 1.0, 1.0, profile)
    t, w = np.polynomial.legendre.leggauss(60)
    at = 0.7 * (t + 1.0)
    stress = exact.stress(at, 0.0, -depth)
    forces = held.surface_forces(r)
    for power in range(3):
        for force, traction in zip(forces, (-stress[:, 4], -stress[:, 2]), strict=True):
            work = 0.7 * (w * 2 * np.pi * at ** (power + 1) * traction).sum()
            assert force @ r**power == pytest.approx(work, rel=1e-6)


def test_zone_ends_where_the_stress_of_a_point_is_the_yield_stress():
    """To the points at which it is looked for."""
    held = MisfitSphere(Elastic(0.91, 0.3), 1.5, "ball", free=False)
    for limit in (0.05, 0.2):
        assert held.zone(limit) == pytest.approx((1.3 / limit) ** (1 / 3), rel=3e-4)
    assert held.stiffness == pytest.approx(1.3, rel=1e-14) and held.zone(2.0) == 0.0


def test_nothing_touches_and_an_elastic_body_forgets_the_strain():
    """Below a free surface, all that it left is rounding; one that yields is within its yield stress."""
    elastic = solve(sphere(None, surface="free", cells=4, unload=True))
    plane = elastic.tables["plane"]
    left = plane["mises_Pa"][plane["state"] == "unloaded"]
    assert elastic.converged and np.abs(left).max() < 1e-9 * plane["mises_Pa"].max()
    plastic = solve(sphere(cells=4, steps=2, unload=True))
    assert plastic.certificate["yield_excess"] < 1e-9 and plastic.quantities["peeq_max"] > 0.0
    for q in (elastic.quantities, plastic.quantities):
        assert q["approach_m"] is None and q["force_N"] == q["contact_area_m2"] == q["p_max_Pa"] == 0.0
