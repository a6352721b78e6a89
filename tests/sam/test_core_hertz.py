# SPDX-License-Identifier: MIT
"""The scales of a contact against identities between them: force from displacement, pressure summed, the
expanding cavity.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from fem_reference.common.hertz import (
    hertz_pressure,
    largest_mises,
    peak_force,
    plastic_radius,
    relative_moduli,
    scales,
)
from sam.scene.schema import Scene

BODY = {"young": 210e9, "poisson": 0.3}
SPHERE = {"shape": "sphere", "radius": 1e-4}
SOFT = {"young": 70e9, "poisson": 0.2}


def scene(body=BODY, counter=SPHERE, **loading):
    given = {"counterbody": counter} if counter else {}
    return Scene(body=body, loading=loading or {"force": 0.4}, **given)


def contact_modulus(counter):
    return 1 / (((1 - 0.3**2) / 210e9) + ((1 - 0.2**2) / 70e9 if "young" in counter else 0.0))


@pytest.mark.parametrize("counter", [SPHERE, SPHERE | SOFT])
def test_sphere_carries_the_force_at_its_approach(counter):
    """F = 4/3 E* sqrt(R) d^(3/2) with a^2 = R d."""
    unit, modulus = scales(scene(counter=counter)), contact_modulus(counter)
    assert unit.modulus == pytest.approx(modulus, rel=1e-12)
    assert 4 / 3 * modulus * np.sqrt(1e-4) * unit.displacement**1.5 == pytest.approx(0.4, rel=1e-12)
    assert unit.length**2 == pytest.approx(1e-4 * unit.displacement, rel=1e-12, abs=0.0)
    assert unit.peak_force * unit.pressure * unit.length**2 == pytest.approx(0.4, rel=1e-12)
    young = relative_moduli(scene(counter=counter))
    assert young[0] * modulus == pytest.approx(210e9, rel=1e-12)
    assert "young" not in counter or young[1] * modulus == pytest.approx(70e9, rel=1e-12)


def test_punch_and_given_pressure_carry_theirs():
    """A punch F = 2 a E* d; a pressure of Hertz displaces its centre by pi a p0/(2 E*) and sums to 2/3 pi
    a^2 p0.
    """
    modulus = contact_modulus(SPHERE)
    punch = scales(scene(counter={"shape": "punch", "radius": 2e-5}))
    assert 2 * 2e-5 * modulus * punch.displacement == pytest.approx(0.4, rel=1e-12) and punch.length == 2e-5
    assert punch.peak_force * punch.pressure * punch.length**2 == pytest.approx(0.4, rel=1e-12)
    pressed = scene(counter=None, prescribed="hertz", p0=2e9, radius=1e-5)
    total = quad(lambda r: 2e9 * np.sqrt(1 - (r / 1e-5) ** 2) * 2 * np.pi * r, 0, 1e-5, epsabs=0.0)[0]
    unit = scales(pressed)
    assert peak_force(pressed) == pytest.approx(total, rel=1e-9)
    assert unit.peak_force * unit.pressure * unit.length**2 == pytest.approx(total, rel=1e-9)
    centre = 2e9 * quad(lambda r: np.sqrt(1 - r * r), 0, 1)[0] * 2e-5 / modulus  # a ring gives 2 p dr/E*
    assert unit.displacement == pytest.approx(centre, rel=1e-9, abs=0.0)


def test_ellipsoid_takes_the_mean_radius():
    curved = {"shape": "ellipsoid", "radius_x": 4e-4, "radius_y": 0.25e-4}
    assert scales(scene(counter=curved)) == scales(scene())


def test_pressure_sums_to_one():
    total = quad(lambda r: float(hertz_pressure(np.array(r))) * 2 * np.pi * r, 0, 1)[0]
    assert total == pytest.approx(1.0, rel=1e-7) and hertz_pressure(np.array([1.0, 2.0])).tolist() == [
        0.0,
        0.0,
    ]


@pytest.mark.parametrize("poisson", [0.0, 0.2, 0.3, 0.45])
def test_largest_mises_is_that_of_the_axis(poisson):
    """From s_zz and the trace of the stress of point forces, summed over the pressure of Hertz."""

    def difference(z):
        def ring(r):
            R = np.hypot(r, z)
            s_zz = -3 * z**3 / (2 * np.pi * R**5)
            return ((-(1 + poisson) * z / (np.pi * R**3)) - s_zz) / 2 - s_zz

        return quad(lambda r: np.sqrt(1 - r * r) * 2 * np.pi * r * ring(r), 0, 1)[0]

    best = minimize_scalar(lambda z: -difference(z), bounds=(0.2, 1.0), method="bounded")
    assert largest_mises(poisson) == pytest.approx(-best.fun, rel=1e-5)


def yielding(stress, force=0.4):
    plasticity = {"law": "perfect", "yield_stress": stress}
    return scene(body=BODY | {"plasticity": plasticity}, force=force)


def test_soft_body_carries_three_yield_stresses():
    radius = plastic_radius(yielding(1e8)) * scales(yielding(1e8)).length
    assert 0.4 / (np.pi * radius**2) == pytest.approx(3e8, rel=1e-12)


def test_cavity_of_a_harder_body():
    """Johnson 1985, Eq. 6.33: p/Y = 2/3 (1 + ln(...)) + 2/3, with the slope a/R of the sphere."""
    stress = 2e9
    elastic = scales(yielding(stress))
    mean = 0.4 / (np.pi * (plastic_radius(yielding(stress)) * elastic.length) ** 2)
    tangent, young = elastic.length / 1e-4, 210e9
    inside = (young / (1 - 0.09) * tangent / stress + 4 * (1 - 0.6)) / (6 * 0.7)
    assert mean / stress == pytest.approx(2 / 3 * (1 + np.log(inside)) + 2 / 3, rel=1e-12)


def test_yielding_begins_where_the_largest_mises_stress_does():
    limit = largest_mises(0.3) * (1.5 * 0.4 / (np.pi * scales(scene()).length ** 2))
    assert plastic_radius(yielding(limit * (1 + 1e-9))) is None
    assert plastic_radius(yielding(limit * (1 - 1e-6))) is not None
