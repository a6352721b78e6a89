# SPDX-License-Identifier: MIT
"""Parts between the coefficients and the solvers against formulas: means over cells, waves in layers,
displacements, meshes.
"""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

import sam
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.layered_force import _across
from fem_reference.spatial.lines import Lines
from sam.contact.convolution import Counters
from sam.contact.normal import fit_of
from sam.contact.operators import CoatedPair
from sam.half_space import ElasticConstants, ElasticPair
from sam.kernels.patches import Cuboids, Lags, stress_coefficients
from sam.layered.patches import normal_compliance
from sam.layered.response import Layers
from sam.plasticity.spectra import NEAR, mean_stress_of_load
from sam.results.snapshots import Sliding
from sam.scene import Scene, Status
from sam.schedule import Load

ONE_MATERIAL = Layers(210e9, 0.3, 1e-6, 210e9, 0.3)


@pytest.mark.parametrize("load", [1, 3])
def test_stress_of_a_load_is_the_mean_over_the_observed_cell(load):
    """Near: of 2 x 2 x 2 Gauss points; far: that of six a side in the plane, by second differences."""
    aspect, faces, n = 0.8, np.array([0.0, 0.5, 1.3]), NEAR + 5
    found = mean_stress_of_load(Cuboids(Lags(n, n, 1.0, aspect), tuple(faces), 0.3), load)
    scale = np.abs(found).max(axis=(0, 1))  # of each lag
    for order, lags, bound in ((2, np.s_[:NEAR, :NEAR], 1e-12), (6, np.s_[NEAR + 3 :, NEAR + 3 :], 2e-4)):
        t, weight = np.polynomial.legendre.leggauss(order)
        depths = (faces[1:] + faces[:-1])[:, None] / 2 + np.diff(faces)[:, None] / 2 * np.array(
            [-1, 1]
        ) / np.sqrt(3)
        expected = 0.0
        for (i, j), share in np.ndenumerate(np.outer(weight, weight) / 4):
            shift = t[i] / 2, aspect * t[j] / 2
            at = stress_coefficients(Lags(n, n, 1.0, aspect), depths.ravel(), 0.3, load=load, shift=shift)
            expected = expected + share * at.reshape(6, 2, 2, n, n).mean(axis=2)
        assert (np.abs(found - expected) / scale)[(..., *lags)].max() <= bound


def test_waves_across_a_film():
    """Antiplane shear of a film on a body, written out: no jump of displacement and stress at the interface,
    unit traction.
    """
    body, coating = Elastic(3.0, 0.25), Coating(young=1.0, poisson=0.3, thickness=0.4)
    mu1, mu2 = 1.0 / 2.6, 3.0 / 2.5
    k, z = np.array([0.3, 2.0]), np.array([0.0, 0.1, 0.39, 0.7])
    found = _across(coating, body, k, z)
    for row, wave in enumerate(k):
        down, up, tail = np.exp(-wave * 0.4), np.exp(wave * 0.4), np.exp(-wave * 0.4)
        system = [[mu1 * wave, -mu1 * wave, 0], [down, up, -tail], [-mu1 * down, mu1 * up, mu2 * tail]]
        a, b, c = np.linalg.solve(system, [1.0, 0.0, 0.0])
        coated = np.where(z < 0.4, a * np.exp(-wave * z) + b * np.exp(wave * z), c * np.exp(-wave * z))
        assert found[row] == pytest.approx(coated - np.exp(-wave * z) / (mu2 * wave), rel=1e-10, abs=1e-14)


def test_shear_that_plastic_flow_carries_the_surface_by():
    """-2 times the integral of the component 13 over depth; the surface moves by the residual
    displacement.
    """
    strain = np.arange(1.0, 37.0).reshape(6, 2, 3, 1)
    zero = np.zeros((3, 1))
    sliding = Sliding(zero, zero + 5.0, zero, zero, zero).strained(zero + 2.0, strain, np.array([0.5, 0.25]))
    assert sliding.shear == pytest.approx(-2 * (0.5 * strain[4, 0] + 0.25 * strain[4, 1]), rel=1e-12)
    assert sliding.ux == pytest.approx(zero + 7.0) and sliding.residual_ux == pytest.approx(zero + 2.0)


def test_compliance_of_a_film_of_the_material_of_its_body():
    """With that of the counter-body, of two half-spaces: 2/(E* k)."""
    k, body, other = np.array([1e4, 1e6, 1e8]), (1 - 0.3**2) / 210e9, (1 - 0.2**2) / 70e9
    layered = SimpleNamespace(response=partial(normal_compliance, ONE_MATERIAL))
    pair = ElasticPair(ElasticConstants(210e9, 0.3), ElasticConstants(70e9, 0.2))
    assert CoatedPair(layered, pair, 1e-6).response(k) == pytest.approx(
        2 * (body + other) / k, rel=1e-9, abs=0.0
    )


def test_given_pressure_lowers_the_surface_as_hertz_s():
    """pi p0 a (1 - nu^2)/(2 E) in the centre (Johnson 1985, Eq. 3.41a), to 3e-4 with 27 cells in a."""
    loading, grid = (
        {"prescribed": "hertz", "p0": 2e9, "radius": 10e-6},
        {"cells": (65, 65), "extent": (24e-6, 24e-6)},
    )
    plan = sam.plan(Scene(body={"young": 210e9, "poisson": 0.3}, loading=loading, grid=grid))
    found = plan.problem(Counters()).contact(Load(plan.schedule.peak.force))
    expected = np.pi * 2e9 * 10e-6 / 2 * (1 - 0.3**2) / 210e9
    assert found.displacement.max() == pytest.approx(expected, rel=3e-4, abs=0.0)


def test_lines_of_a_block():
    """Areas of the surface nodes sum to that of the surface; a half block carries half of every force."""
    x, y, z = np.array([-1.0, 0.5, 2.0, 2.5]), np.array([0.0, 0.4, 1.0]), np.array([0.0, 1.0])
    lines = Lines(x, y, z, half=True)
    assert lines.areas.sum() == pytest.approx(3.5, rel=1e-12) and lines.areas[1, 1] == pytest.approx(
        1.5 * 0.5, rel=1e-12
    )
    assert lines.shape == (3, 2, 1)
    assert lines.share == 0.5 and Lines(x, y, z, half=False).share == 1.0


@pytest.mark.parametrize("width, enough", [(5, False), (6, True)])
def test_six_cells_across_resolve_a_contact(width, enough):
    """Three in the radius, to the letter."""
    pressure = np.zeros((12, 12))
    pressure[3 : 3 + width, 3:10] = 1.0
    status = fit_of(SimpleNamespace(converged=True, pressure=pressure))
    assert status is (Status.CONVERGED if enough else Status.UNDER_RESOLVED)
