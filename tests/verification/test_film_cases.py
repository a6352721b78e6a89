# SPDX-License-Identifier: MIT
"""The film that yields: closed forms of a bonded film, and what is read from results."""

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.schedule import Load
from sam.scene import load_scene
from verification.cases.coated.film_yield import FilmContact, scene_of
from verification.reference.bonded_film import elastic_mises, in_plane_strain, thinning
from verification.reference.hertz import axis_stress

BASE = load_scene("verification/scenes/film-yield.toml")
FLOWING = FilmContact(2e-6, 6.5e9, "rigid", "B 945", "yields")


class TestBondedFilm:
    p, E, nu, Y = 5e9, 80e9, 0.3, 0.67e9

    def stiffness(self):
        lame = self.E * self.nu / (1 + self.nu) / (1 - 2 * self.nu)
        return lame * np.ones((3, 3)) + self.E / (1 + self.nu) * np.eye(3)

    def test_strain_of_the_body_is_that_of_hertz(self):
        stress = axis_stress(0.0, self.p, 1.0, 0.28)[:3]
        expected = (stress[0] - 0.28 * (stress[1] + stress[2])) / 210e9
        assert in_plane_strain(self.p, 210e9, 0.28) == pytest.approx(expected, rel=1e-12)

    def state(self, e, plastic):
        """Stresses for strains e, e in the surface, szz = -p and plastic strains (1/2, 1/2, -1)."""
        C, flow = self.stiffness(), np.array([0.5, 0.5, -1.0]) * plastic
        return C @ (np.array([e, e, (-self.p - C[2, :2].sum() * e + C[2] @ flow) / C[2, 2]]) - flow)

    def test_elastic_and_plastic_states_obey_hookes_law(self):
        e = in_plane_strain(self.p, 210e9, 0.3)
        sxx, _, szz = self.state(e, 0.0)
        assert elastic_mises(self.p, e, self.E, self.nu) == pytest.approx(sxx - szz, rel=1e-12)
        film = self.E, self.nu, self.Y
        flow = thinning(self.p, 0.0, e, film)
        sxx, _, szz = self.state(e, flow)
        assert sxx - szz == pytest.approx(self.Y, rel=1e-12) and flow > 0.02
        assert thinning(0.1 * self.p, 0.0, 0.1 * e, film) == 0.0


def test_a_flowing_film_keeps_the_contact_of_the_step_before():
    """A node too many squeezes the film to where no step converges, however small."""
    scene = scene_of(BASE, FLOWING, 6)
    for film in (True, False):
        whole = plan(scene)
        model = build(whole if film else whole.bare)
        virgin = model.virgin()
        flowed = replace(virgin.history, peeq=virgin.history.peeq + 1e-3)
        contact = model.radii <= 1.0
        before = replace(
            virgin,
            load=Load(1.0),
            active=contact,
            gap=np.where(contact, 0.0, model.radii - 1.0),
            history=flowed,
        )
        grown = model.starting_set(1.3, before)
        assert np.array_equal(grown, contact) == film and grown.sum() >= contact.sum()
