# SPDX-License-Identifier: MIT
"""A misfit sphere in both models: stress and profiles, the plastic zone, means over cells, the grid."""

from __future__ import annotations

import numpy as np
import pytest
from builders import LINEAR, PERFECT, scene

import fem_reference
import sam
from fem_reference.axisymmetric.misfit import PROFILES as FEM_PROFILES, MisfitSphere as FemSphere
from fem_reference.common.bodies import Elastic
from sam.elastic.problem import PROFILES, MisfitSphere
from sam.grid.cells import CellGrid, Room
from sam.grid.demands import MisfitDemand
from sam.half_space import ElasticConstants
from sam.scene import Grid, Scene, resolved
from verification.reference.mindlin_cheng import EigenstrainSphere
from verification.reference.misfit_sphere import PROFILES as EXACT, GrowingSphere

YOUNG, NU, A, DEPTH = 210e9, 0.3, 1e-5, 1.7e-5


def sphere(profile: str, free=True) -> MisfitSphere:
    return MisfitSphere(ElasticConstants(YOUNG, NU), DEPTH, A, 0.02, PROFILES[profile], free)


def growing(plasticity=None, depth=DEPTH, **keys) -> Scene:
    loading = {"prescribed": "misfit-sphere", "depth": depth, "radius": A, "misfit": 0.02, **keys}
    return scene(body={"plasticity": plasticity}, loading=loading, fem={"cells_per_radius": 4})


def test_stress_below_a_free_surface_is_that_of_mindlin_and_cheng():
    """A uniform sphere, outside of it and inside."""
    exact, found = EigenstrainSphere(0.02, A, DEPTH, YOUNG, NU), sphere("ball")
    x, y, z = (A * np.array(each) for each in ([0.3, 2.0, 0.0], [0.1, -1.0, 0.0], [1.9, 0.0, 0.2]))
    off = np.abs(np.moveaxis(found.stress(x, y, z), 0, -1) - exact.stress(x, y, z))
    assert off.max() < 1e-12 * YOUNG * 0.02
    grid = CellGrid(3, 3, A, A, np.zeros(1))
    moved = exact.surface_displacement(grid.x[:, None], grid.y)
    assert found.moved_surface(grid) == pytest.approx(moved, rel=1e-12)


@pytest.mark.parametrize("profile", list(PROFILES))
def test_stress_of_an_infinite_body_is_that_of_the_closed_form(profile):
    exact = GrowingSphere(YOUNG, NU, lambda peeq: 1e30 + 0 * peeq, 0.02, A, profile)
    places = [0.3, 1.2, 0.0, 1e-3], [0.1, -1.0, 0.0, 0.0], [0.2, 0.3, 0.9, 0.0]
    x, y, z = (A * np.array(each) for each in places)
    found = np.moveaxis(sphere(profile, free=False).stress(x, y, z + DEPTH), 0, -1)
    assert np.abs(found - exact.stress(x, y, z)).max() < 2e-7 * YOUNG * 0.02


@pytest.mark.parametrize("name", list(PROFILES))
def test_strain_and_mean_are_those_of_the_reference(name):
    """In both models; far away the mean is the strength over the volume."""
    s, ours = np.array([1e-3, 0.05, 0.0999, 0.1001, 0.4, 0.9995, 1.0005, 1.3, 4.0]), PROFILES[name]
    exact, excess = EXACT[name](s)
    for local, mean in ((ours.local(s), ours.mean(s)), FEM_PROFILES[name](s)):
        assert local == pytest.approx(exact, abs=1e-14)
        assert mean - local == pytest.approx(excess, abs=1e-11)
    assert ours.strength == pytest.approx(8.0**3 * EXACT[name](np.array(8.0))[1], rel=1e-12)


def test_mean_of_gauss_near_the_centre():
    """Its series: 3 sum (-1)^n x^2n/(n! (2n + 3))."""
    x = 0.0099
    exact = 1 - 3 * x**2 / 5 + 3 * x**4 / 14 - x**6 / 18
    assert float(PROFILES["gauss"].mean(np.array(x))) == pytest.approx(exact, rel=3e-13)


@pytest.mark.parametrize("name, strength", [("smooth", 8 / 35), ("ball", 1.0)])
def test_zone_ends_where_the_stress_of_a_point_is_the_yield_stress(name, strength):
    """E e strength/((1 - nu) x^3) outside of the sphere; at most 4.5 radii."""
    exact = A * (YOUNG * 0.02 * strength / ((1 - NU) * 1e9)) ** (1 / 3)
    assert sphere(name).zone(1e9) == pytest.approx(exact, rel=1e-12)
    assert sphere(name).zone(1e6) == pytest.approx(4.5 * A, rel=1e-12)
    assert sphere(name).zone(1e12) == 0.0


def test_mean_stress_is_that_of_the_cells():
    """A smooth profile everywhere, against many more points in each cell."""
    found, grid = sphere("gauss"), CellGrid(3, 2, A / 2, A / 3, np.zeros(1))
    faces = DEPTH + A * np.array([-0.4, -0.1, 0.3])
    t, w = np.polynomial.legendre.leggauss(9)
    x, y = grid.x[:, None] + grid.hx / 2 * t, grid.y[:, None] + grid.hy / 2 * t
    z = (faces[1:] + faces[:-1])[:, None] / 2 + np.diff(faces)[:, None] / 2 * t
    points = found.stress(*(each.ravel() for each in np.meshgrid(x, y, z, indexing="ij")))
    exact = np.einsum("siajbkc,a,b,c->skij", points.reshape(6, 3, 9, 2, 9, 2, 9), w, w, w) / 8
    mean = found.mean_stress(grid, grid.whole, faces)
    assert np.abs(mean - exact).max() < 3e-6 * np.abs(exact).max()


# the grid


def grid_of(zone: float | None, given: Grid | None = None, depth: float = DEPTH) -> CellGrid:
    return MisfitDemand(given, depth, A, zone).grid(Room())


def test_cells_and_side_follow_the_sphere_and_its_zone():
    """Eight cells in the radius, at most twelve in its zone; 1.5 zones, or two radii, to each side."""
    assert grid_of(1.2 * A).hx == pytest.approx(A / 8, rel=1e-12)
    assert grid_of(1.8 * A).hx == pytest.approx(0.15 * A, rel=1e-12)
    for reach, cells in ((17.4999, 35), (17.5002, 37)):
        assert grid_of(reach / 12 * A).nx == cells
    some = Grid(cells=(21, 21))
    assert grid_of(0.0, some).hx == pytest.approx(4 * A / 21, rel=1e-12)
    assert grid_of(2 * A, some).hy == pytest.approx(6 * A / 21, rel=1e-12)
    layers = grid_of(A, Grid(depths=(0.0, A, 3 * A)))  # given are the faces
    assert layers.faces.tolist() == [0.0, A, 3 * A] and layers.depths == pytest.approx([A / 2, 2 * A])


def test_output_depths_of_an_elastic_body_reach_two_radii_below_the_centre():
    depths = grid_of(None).depths
    assert depths[-1] == pytest.approx(DEPTH + 2 * A, rel=1e-12)
    assert np.allclose(np.diff(depths), 0.02 * A) and 0 <= depths[0] < 0.02 * A


@pytest.mark.parametrize("reach, count", [(17.4999, 17), (17.5002, 18)])
def test_layers_reach_as_far_as_the_cells(reach, count):
    faces = grid_of(reach / 12 * A, depth=10 * A).faces
    assert faces[-1] == pytest.approx(10 * A + (count + 0.5) * A / 8, rel=1e-12)


@pytest.mark.parametrize("depth", [1.6, 4.0])
def test_the_chosen_grid_holds_the_plastic_zone_with_a_cell_at_the_centre(depth):
    given = growing(LINEAR, depth * A)
    assert (given.loading.profile, given.loading.surface) == ("smooth", "free")
    assert Scene(**resolved(given)) == given
    grid, zone = sam.choose_grid(given), sam.misfit_zone(given)
    assert zone == pytest.approx(1.11103 * A, rel=1e-3)
    assert grid.hx == pytest.approx(A / 8) and grid.nx % 2 == 1
    assert grid.nx * grid.hx / 2 > 1.4 * zone and grid.faces[0] == 0.0
    assert np.abs(grid.depths - depth * A).min() < 1e-6 * A
    assert np.all(np.diff(grid.faces) > 0.45 * grid.hx) and len(grid.depths) < 45


def test_a_zone_that_reaches_a_held_surface_is_refused():
    soft = growing(PERFECT | {"yield_stress": 0.2e9}, surface="held")
    with pytest.raises(sam.UnsupportedScene, match=r"loading\.depth = 1\.7.*held"):
        sam.solve(soft)


# finite elements


def test_far_field_is_that_of_mindlin_and_cheng():
    """At the surface, and without traction there: by differences of the displacements."""
    young, nu, depth = 0.91, 0.3, 1.5
    free = FemSphere(Elastic(young, nu), depth, "ball", free=True)
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
    held = FemSphere(Elastic(0.91, 0.3), depth, profile, free=False)
    exact = GrowingSphere(0.91, 0.3, lambda peeq: 1e30 + 0 * peeq, 1.0, 1.0, profile)
    t, w = np.polynomial.legendre.leggauss(60)
    at = 0.7 * (t + 1.0)
    stress = exact.stress(at, 0.0, -depth)
    forces = held.surface_forces(r)
    for power in range(3):
        for force, traction in zip(forces, (-stress[:, 4], -stress[:, 2]), strict=True):
            work = 0.7 * (w * 2 * np.pi * at ** (power + 1) * traction).sum()
            assert force @ r**power == pytest.approx(work, rel=1e-6)


def test_zone_of_fem_ends_where_the_stress_of_a_point_is_the_yield_stress():
    """To the points at which it is looked for."""
    held = FemSphere(Elastic(0.91, 0.3), 1.5, "ball", free=False)
    for limit in (0.05, 0.2):
        assert held.zone(limit) == pytest.approx((1.3 / limit) ** (1 / 3), rel=3e-4)
    assert held.stiffness == pytest.approx(1.3, rel=1e-14) and held.zone(2.0) == 0.0


def test_nothing_touches_and_an_elastic_body_forgets_the_strain():
    """Below a free surface, all that it left is rounding; one that yields is within its yield stress."""
    elastic = fem_reference.solve(growing(None, 1.5 * A, unload=True))
    plane = elastic.tables["plane"]
    left = plane["mises_Pa"][plane["state"] == "unloaded"]
    assert elastic.converged and np.abs(left).max() < 1e-9 * plane["mises_Pa"].max()
    plastic = fem_reference.solve(growing(LINEAR, 1.5 * A, surface="held", steps=2, unload=True))
    assert plastic.certificate["yield_excess"] < 1e-9 and plastic.quantities["peeq_max"] > 0.0
    for q in (elastic.quantities, plastic.quantities):
        assert q["approach_m"] is None and q["force_N"] == q["contact_area_m2"] == q["p_max_Pa"] == 0.0
