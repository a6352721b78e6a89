# SPDX-License-Identifier: MIT
"""A punch with a rounded edge in both models, against its closed form, and what each refuses of it."""

from functools import partial

import numpy as np
import pytest
from builders import MODULUS, PERFECT, scene

import fem_reference
import sam
from fem_reference.common.hertz import force_of_approach, scales
from sam.grid.cells import RoundedPunch as SamPunch
from sam.planner.make import UnsupportedScene
from verification.reference.rounded_punch import RoundedPunch

FLAT, EDGE, FORCE = 5e-6, 100e-6, 0.05
PUNCH = {"shape": "rounded-punch", "flat_radius": FLAT, "radius": EDGE}
EXACT = RoundedPunch(FORCE, FLAT, EDGE, MODULUS)
pressed = partial(scene, counterbody=PUNCH, loading={"force": FORCE}, fem={"cells_per_radius": 32})


class TestTheGrid:
    def test_has_five_cells_in_the_contact_beyond_the_flat_end(self):
        sharp = pressed(counterbody=PUNCH | {"radius": 20e-6})
        grid, beyond = sam.choose_grid(sharp), RoundedPunch(FORCE, FLAT, 20e-6, MODULUS).contact_radius - FLAT
        assert 5 <= beyond / grid.hx < 5.1 and (grid.nx, grid.nx % 2) == (grid.ny, 1)
        assert sam.choose_grid(pressed()).nx == 129  # enough there already

    @pytest.mark.parametrize(
        ("grid", "says"),
        [
            ({"cells": (25, 25)}, r"grid\.cells = \[25, 25\].*at least 52 x 52"),
            ({"cells": (52, 52)}, None),
            ({"extent": (16e-6, 16e-6)}, None),
        ],
    )
    def test_that_is_given_is_refused_below_three(self, grid, says):
        if says is None:
            sam.check(pressed(grid=grid))
        else:
            with pytest.raises(UnsupportedScene, match=says):
                sam.check(pressed(grid=grid))

    def test_that_would_be_too_large_is_refused_by_the_radius(self):
        with pytest.raises(UnsupportedScene, match=r"counterbody\.radius = 1e-08 m.*raise it"):
            sam.check(pressed(counterbody=PUNCH | {"radius": 1e-8}))
        with pytest.raises(fem_reference.UnsupportedScene, match=r"counterbody\.radius.*\"punch\""):
            fem_reference.check(pressed(counterbody=PUNCH | {"radius": 1e-12}))


def test_the_mesh_has_lines_at_the_flat_end_and_the_edge():
    r = fem_reference.axisymmetric.planner.plan(pressed()).r * EXACT.contact_radius
    for place in (FLAT, EXACT.contact_radius):
        assert np.abs(r / place - 1).min() < 1e-12
    assert np.sum((r > FLAT * (1 + 1e-9)) & (r <= EXACT.contact_radius * (1 + 1e-9))) == 8


def test_the_mesh_has_lines_at_depths_where_the_yield_stress_changes():
    """In its fine part, and not nearer to the surface than an eighth of an element."""
    for thickness, line in ((1e-9, False), (0.5e-6, True), (20e-6, False)):
        layer = {"layer": PERFECT | {"yield_stress": 2e9}, "layer_thickness": thickness}
        made = pressed(body={"plasticity": PERFECT | layer})
        z = fem_reference.axisymmetric.planner.plan(made).z * scales(made).length
        assert (np.abs(z / thickness - 1).min() < 1e-12) == line


def test_the_estimated_force_of_an_approach_is_the_exact_one():
    assert force_of_approach(pressed(), EXACT.approach) == pytest.approx(FORCE, rel=1e-9)


class TestTheClosedFormOfSam:
    """Force and approach over the contact radius, of E* = 1 GPa; a sphere without a flat end."""

    PUNCH = SamPunch(5e-6, EDGE)

    def test_without_a_flat_end_is_that_of_hertz(self):
        sphere, a = SamPunch(0.0, EDGE), 3e-6
        assert sphere.force(a, 1e9) == pytest.approx(4 / 3 * 1e9 * a**3 / EDGE, rel=1e-12)
        assert sphere.approach(a) == pytest.approx(a**2 / EDGE, rel=1e-12, abs=0)

    @pytest.mark.parametrize("a", [5.0001e-6, 6e-6, 40e-6])
    def test_the_radius_is_found_from_either(self, a):
        assert self.PUNCH.contact_radius(self.PUNCH.force(a, 1e9), 1e9) == pytest.approx(a, rel=1e-9, abs=0)
        assert self.PUNCH.radius_at(self.PUNCH.approach(a)) == pytest.approx(a, rel=1e-9, abs=0)
