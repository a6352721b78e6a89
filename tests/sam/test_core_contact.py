# SPDX-License-Identifier: MIT
"""Parts of the contact of both sides against formulas: what counts as converged, halved loads, the far field,
film limits.
"""

import numpy as np
import pytest
from builders import SWIFT, scene as small_scene

from fem_reference.axisymmetric.elements import AxisymmetricSolid, half_plane
from fem_reference.axisymmetric.problem import Block
from fem_reference.common.bodies import Elastic
from fem_reference.common.hertz import plastic_radius
from fem_reference.common.schedule import Load
from sam.contact.convolution import Counters
from sam.contact.normal import Solved, Units, measured
from sam.contact.operators import SurfaceOperators
from sam.layered.response import Layers

BODY = {"young": 210e9, "poisson": 0.3}


def test_converged_within_twice_the_tolerance():
    """A gap of 1e-9 in the one cell that touches unevenly; the residual is that over the displacement of its
    pressure.
    """
    grid = SurfaceOperators((4, 4), 1.0, Counters())
    p, u = np.zeros((4, 4)), np.zeros((4, 4))
    p[1, 1:3], u[1, 2] = 0.5, 2e-9
    gap0 = np.where(p > 0, 0.0, 1.0)
    expected = 1e-9 / (grid.self_influence * 0.5)  # of the two cells each lies 1e-9 off their mean
    fields = Solved(p, u, grid.whole, 1)
    for share, converged in ((1.9995, True), (2.0005, False)):
        found = measured(grid, gap0, fields, Units(1.0, 1.0, 2.0), given=1.0, tolerance=expected / share)
        assert found.gap_residual == pytest.approx(expected, rel=1e-9, abs=0.0) and found.penetration == 0.0
        assert found.converged == converged
    other = measured(grid, gap0, fields, Units(2.0, 3.0, 10.0), given=30.0, tolerance=1.0)
    assert other.load_error == pytest.approx(0.0, abs=1e-15)
    assert found.approach == pytest.approx(1e-9, rel=1e-9, abs=0.0)


def test_a_load_is_halved_between_two():
    start, end = Load(2.0, 0.1, x=1.0, y=5.0), Load(6.0, 0.3, x=2.0, y=-1.0)
    assert end.halfway(start, 1.0) == Load(4.0, 0.3, x=1.5, y=2.0)
    assert end.halfway(Load(0.0, 0.1, x=7.0), 1.0) == Load(3.0, 0.3, x=2.0, y=-1.0)
    for from_none in (Load(0.0), Load(0.0, approach=1.0)):  # unloaded, or apart at an approach
        assert Load(6.0, approach=2.0).halfway(from_none, 1.0).approach == 1.5


def test_far_field_is_that_of_a_point_force():
    """Boussinesq (Johnson 1985, Eq. 3.18) under a unit force, on the outer boundary."""
    line = np.linspace(0.0, 3.0, 5)
    elastic = Elastic(2.0, 0.3)
    block = Block(AxisymmetricSolid(half_plane(line, line), elastic), elastic)
    values, shear = block.far_field(), 2.0 / 2.6
    for component in (0, 1):
        far = block.solid.boundary_dofs("far", component)
        r, z = block.solid.basis.doflocs[:, far]
        R = np.hypot(r, z)
        along = r * z / R**3 - (1 - 2 * 0.3) * r / (R * (R + z))
        down = z**2 / R**3 + 2 * (1 - 0.3) / R
        assert far.size and values[far] == pytest.approx(
            (along, down)[component] / (4 * np.pi * shear), rel=1e-12, abs=1e-15
        )


def test_radius_of_a_contact_that_yields():
    """Swift steel: the yield stress is taken at Tabor's strain, 0.2 a/R; a given pressure keeps its
    radius.
    """
    body, given = {"plasticity": SWIFT}, {"prescribed": "hertz", "p0": 6e9, "radius": 1e-5}
    sphere = small_scene(body=body, counterbody={"radius": 1e-4}, loading={"force": 4.0})
    modulus = 210e9 / 0.91
    slope = (0.75 * 4.0 / modulus * 1e-4) ** (1 / 3) / 1e-4
    limit = 945e6 * (20 + 1e6 * 0.2 * slope) ** 0.121
    cavity = 2 / 3 * (2 + np.log((modulus * slope / limit + 1.6) / 4.2))
    radius = np.sqrt(4.0 / (np.pi * limit * min(cavity, 3.0)))
    assert plastic_radius(sphere) == pytest.approx(radius / (slope * 1e-4), rel=1e-12)
    assert plastic_radius(small_scene(body=body, loading=given)) == 1.0


def test_radius_is_never_below_that_of_hertz():
    """Just above first yield the cavity would carry more than the elastic contact does."""
    barely = {"law": "perfect", "yield_stress": 4.5e9}
    sphere = small_scene(body={"plasticity": barely}, counterbody={"radius": 1e-4}, loading={"force": 0.4})
    assert plastic_radius(sphere) == 1.0


@pytest.mark.parametrize("name", ["poisson", "poisson_body"])
def test_poisson_ratio_of_layers_is_at_most_a_half(name):
    given = {"young": 1.0, "poisson": 0.3, "thickness": 1.0, "young_body": 1.0, "poisson_body": 0.3}
    assert getattr(Layers(**given | {name: 0.5}), name) == 0.5
    with pytest.raises(ValueError, match=f"{name} = 0.5002"):
        Layers(**given | {name: 0.5002})


def test_traction_acts_along_x_unless_said_otherwise():
    """u of p and of its traction: as summed with the sign 1, and half of both signs' sum is that without a
    traction.
    """
    grid = SurfaceOperators((5, 4), 1.0, Counters(), coupling=0.4)
    p = np.arange(20.0).reshape(5, 4)
    along, against = (grid.displacement(p, grid.whole, grid.whole, sign) for sign in (1.0, -1.0))
    assert grid.displacement(p, grid.whole, grid.whole) == pytest.approx(along, rel=1e-12)
    alone = SurfaceOperators((5, 4), 1.0, Counters()).displacement(p, grid.whole, grid.whole)
    assert (along + against) / 2 == pytest.approx(alone, rel=1e-12) and np.abs(along - against).max() > 0.1
