# SPDX-License-Identifier: MIT
"""Hooke's law and the radial return of the film and of the surface against forms that are written
otherwise.
"""

import numpy as np
import pytest

from sam.contact.stress import elastic_strain, surface_strain
from sam.tribofilm.law import Loads, Material, printed_stress, radial_flow

YOUNG = 80e9
CASES = [0.0, 0.2, 0.3, 0.45]


def moduli(poisson):
    """Bulk and shear modulus."""
    return YOUNG / (3 - 6 * poisson), YOUNG / (2 + 2 * poisson)


@pytest.mark.parametrize("poisson", CASES)
def test_printed_stress_has_the_shear_modulus_once_and_lames_constant(poisson):
    bulk, shear = moduli(poisson)
    strain, normal = np.array([[1e-3], [-4e-4], [7e-4]]), np.array([2e-4])
    loads = Loads(np.zeros((6, 1)), strain, np.array([1e8]), np.array([3e7]), normal)
    found = printed_stress(loads, Material(YOUNG, poisson, 3e8))[:, 0]
    normals = np.array([1e-3, -4e-4, 2e-4])
    expected = (bulk - 2 / 3 * shear) * normals.sum() + shear * normals + [0.0, 0.0, 1e8]
    np.testing.assert_allclose(found, [*expected, 0.0, 3e7, 0.0], rtol=1e-12)


@pytest.mark.parametrize("poisson", CASES)
@pytest.mark.parametrize("component", range(6))
def test_printed_flow_of_one_component_ends_on_the_yield_surface(poisson, component):
    """Pure shear yields at k = sigma_y/sqrt(3), tension at sigma_y; what flows takes the rest of the elastic
    strain.
    """
    _, shear = moduli(poisson)
    stress, plastic = np.zeros((6, 1)), np.zeros((6, 1))
    stress[component] = 9e8
    yield_stress, size = 3e8, 1.5 ** (component < 3)  # of a tension s the deviator is 2/3 s along it
    material = Material(YOUNG, poisson, yield_stress)
    flow = radial_flow(stress, plastic, material)[:, 0]
    bearable = yield_stress if component < 3 else yield_stress / np.sqrt(3)
    assert flow[component] == pytest.approx((9e8 - bearable) / size / (2 * shear), rel=1e-12)
    assert flow[:3].sum() == pytest.approx(0.0, abs=1e-18)
    held = np.full((6, 1), 1e-3) * np.array([[1.0], [-0.5], [-0.5], [0.4], [0.3], [0.2]])
    moved = radial_flow(stress + 2 * shear * held, held, material)[:, 0]
    np.testing.assert_allclose(moved, flow, rtol=1e-10, atol=1e-18)


@pytest.mark.parametrize("poisson", CASES)
def test_elastic_strain_is_the_inverse_of_lames_law_in_any_frame(poisson):
    bulk, shear = moduli(poisson)
    strain = np.random.default_rng(3).normal(size=(3, 3)) * 1e-3
    strain = strain + strain.T
    stress = (bulk - 2 / 3 * shear) * np.trace(strain) * np.eye(3) + 2 * shear * strain
    found = elastic_strain(stress[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]], YOUNG, poisson)
    np.testing.assert_allclose(found, strain[[0, 1, 0, 2], [0, 1, 1, 2]], rtol=1e-11)


def test_surface_strain_follows_a_line_through_two_layers():
    """Strain that is linear in depth, half elastic and half plastic."""
    depths, slope = np.array([0.3, 1.1]), np.array([2e-3, -1e-3, 5e-4, 4e-4])
    total = np.array([1e-3, 2e-3, -1e-3, 3e-4])[:, None] + slope[:, None] * depths
    bulk, shear = moduli(0.3)
    half = np.zeros((6, 2))
    half[[0, 1, 5, 2]] = total / 2
    stress = 2 * shear * half
    stress[:3] += (bulk - 2 / 3 * shear) * half[:3].sum(axis=0)
    found = surface_strain(
        stress[:, :, None, None], half[:, :, None, None], depths, young=YOUNG, poisson=0.3
    )[:, 0, 0]
    np.testing.assert_allclose(found, [1e-3, 2e-3, -1e-3, 3e-4], rtol=1e-11)
