# SPDX-License-Identifier: MIT
"""The closed form of sliding tractions on a coated body: one material, interface, surface, waves with many
digits.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import j0

from verification.reference.coated_traction import (
    antiplane,
    coated_sliding_stress,
    hertz_transform,
    largest_von_mises,
)
from verification.reference.hamilton import sliding_stress
from verification.reference.layered import ManyDigits
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises

X = np.array([-1.4, -0.95, -0.3, 0.0, 0.5, 1.0, 1.2])
SOFT, STIFF = CoatedHalfSpace(80.0, 0.3, 0.1, 210.0, 0.25), CoatedHalfSpace(900.0, 0.2, 0.4, 210.0, 0.3)
COATED = pytest.mark.parametrize("layers", [SOFT, STIFF], ids=["soft", "stiff"])
ROUNDING = 1e-12
"""Of the pressure: sums over some 1000 wave numbers of terms of order 1, and systems of condition 10 to 1000.
"""


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_one_material_is_hamilton(nu):
    """The body through the quadrature alone; the film through what the interface sends back, which is
    nothing.
    """
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
    film, body = (
        coated_sliding_stress(layers, 1.0, 1.0, 0.4, x=X, z=h, film=side)[:, 0].T for side in (True, False)
    )
    assert np.abs(film - body)[2:5].max() < ROUNDING
    strains = []
    for (xx, yy, zz, *_), young, nu in (
        (film, layers.young, layers.poisson),
        (body, layers.young_body, layers.poisson_body),
    ):
        strains.append(np.array([xx - nu * (yy + zz), yy - nu * (xx + zz)]) / young)
    assert np.abs(strains[0] - strains[1]).max() < ROUNDING * np.abs(strains[0]).max() * 100
    assert np.abs(film - body)[:2].max() > 0.1


@COATED
@pytest.mark.parametrize("k", [0.3, 4.0, 30.0])
def test_waves_of_traction_have_many_digits(layers, k):
    """Amplitudes under the shear traction and the antiplane wave, against a dense solve of other
    potentials.
    """
    h, ratio = layers.thickness, layers.young / layers.young_body
    exact = ManyDigits(k * h, ratio, layers.poisson, layers.poisson_body)
    for z, film in ((0.4 * h, True), (h, True), (h, False), (1.7 * h, False)):
        zz, shear, along, side, _ = layers.profiles(np.array([k]), layers.amplitudes(k, shear=True), z, film)[
            :, 0
        ]
        right = [float(v) for v in exact.state(k * z, 1, not film)[2:]]
        assert [zz, along, side, shear] == pytest.approx(right, abs=ROUNDING)
        turned = antiplane(layers, np.array([k]), z, film)[:, 0] + film * np.exp(-k * z) * np.array([-1, 1])
        right = [float(v) for v in exact.antiplane_stress(k * z, not film)]
        assert turned == pytest.approx(right, abs=ROUNDING)


def test_transform_of_the_hertz_pressure():
    """Where the series ends and the closed form begins as well."""
    for ka in (1e-3, 0.0999, 0.1001, 1.0, 7.0):
        exact = quad(lambda s, ka=ka: np.sqrt(1.0 - s * s) * j0(ka * s) * s, 0.0, 1.0, epsabs=1e-13)[0]
        assert hertz_transform(np.array([ka]))[0] == pytest.approx(exact, abs=1e-10)  # of the quadrature


@pytest.mark.parametrize("film", [True, False])
def test_largest_is_not_below_a_finer_scan(film):
    x = np.linspace(-1.2, 1.2, 401)
    z = np.linspace(0.0, 0.1, 11) if film else np.linspace(0.1, 1.0, 41)
    scan = von_mises(coated_sliding_stress(SOFT, 1.0, 1.0, 0.4, x=x, z=z, film=film)).max()
    peak = largest_von_mises(SOFT, 1.0, 1.0, 0.4, film=film)
    assert scan <= peak.value * (1.0 + 1e-9) and peak.value < 1.01 * scan
    at = von_mises(coated_sliding_stress(SOFT, 1.0, 1.0, 0.4, x=peak.r, z=peak.z, film=film))
    assert float(at[0, 0]) == pytest.approx(peak.value, rel=1e-9)


@pytest.mark.parametrize(("z", "film", "words"), [(0.2, True, "<="), (0.05, False, ">=")])
def test_a_place_in_the_other_layer_is_refused(z, film, words):
    with pytest.raises(ValueError, match=f"z must be {words} thickness = 0.1 m everywhere"):
        coated_sliding_stress(SOFT, 1.0, 1.0, 0.4, x=X, z=z, film=film)
