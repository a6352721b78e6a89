# SPDX-License-Identifier: MIT
"""The film that yields: closed forms of a bonded film, and what is read from results."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from made_results import Made

from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.schedule import Load
from sam.scene import load_scene
from verification.cases.coated.film_yield import (
    FilmContact,
    YieldingFilms,
    against_theory,
    row_of,
    scene_of,
)
from verification.reference.bonded_film import (
    elastic_mises,
    in_plane_strain,
    plastic_strain,
)
from verification.reference.hertz import axis_stress
from verification.references import contact_of

BASE = load_scene("verification/scenes/film-yield.toml")
ELASTIC = FilmContact(2e-6, 6.5e9, "rigid", "elastic", "elastic")
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
        flow = plastic_strain(self.p, e, (self.E, self.nu, self.Y))
        sxx, _, szz = self.state(e, flow)
        assert sxx - szz == pytest.approx(self.Y, rel=1e-12) and flow > 0.02
        assert plastic_strain(0.1 * self.p, 0.1 * e, (self.E, self.nu, self.Y)) == 0.0


def made(contact: FilmContact, film: float = 0.04, body: float = 0.007, **changes: float) -> dict:
    """Of two points in the film of 100 nm and two below; largest plastic strains of film and body, the
    pressure falls by 2e15 Pa/m.
    """
    z, r = np.array([20e-9, 80e-9, 100e-9, 500e-9]), np.linspace(0.0, 2e-6, 41)
    axis = {"state": ["peak"] * 4, "z_m": z, "peeq": [0.027, 0.033, 0.5 * body, body]}
    axis["mises_Pa"] = [2e9, 4e9, 9e9, 9e9]
    plane = {"state": ["peak"] * 4, "x_m": [1e-7, 1e-7, 1e-7, 2e-6], "z_m": z}
    plane |= {"peeq": [film, 0.8 * film, 0.1 * body, 0.0], "mises_Pa": [0.67e9, 0.5e9, 9e9, 9e9]}
    line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": 6.5e9 - 2e15 * r}
    quantities = {"p_max_change": -0.049, "mises_max_change": 0.049, "mises_max_film_Pa": 2.8e9}
    quantities |= {"p_max_bare_Pa": 6.5e9, "p_center_Pa": 6.5e9} | changes
    result = Made(quantities, {"line": line, "axis": axis, "plane": plane})
    bare = Made({"p_max_Pa": 6.5e9, "peeq_max": 0.0086})
    return row_of(contact, scene_of(BASE, contact, 8), result, bare)


class TestFrame:
    def test_strains_and_stresses_are_of_their_layer(self):
        found, elastic = made(FLOWING), made(ELASTIC)
        strains = (found[f"{name}_strain"] for name in ("film", "body", "bare"))
        assert tuple(strains) == (0.04, 0.007, 0.0086)
        assert found["at_centre"] == pytest.approx(0.03) and elastic["at_centre"] == 3e9
        assert found["gradient"] == pytest.approx(2e15, rel=1e-9)
        assert found["film_mises"] == 0.67e9 and elastic["film_mises"] == 2.8e9

    def test_claim_needs_both_changes_and_a_film_that_is_not_squeezed_out(self):
        assert made(FLOWING)["holds"] and made(FLOWING)["known"] and not made(FLOWING, film=0.15)["known"]
        for name in ("p_max_change", "mises_max_change"):
            assert not made(FLOWING, **{name: -0.051})["holds"]

    @pytest.mark.parametrize("counterbody", ["rigid", "steel"])
    def test_scenes_have_the_radius_and_pressure_that_they_are_named_by(self, counterbody):
        contact = FilmContact(1e-6, 4e9, counterbody, "B 1780", "yields")
        scene = scene_of(BASE, contact, 8)
        elastic = contact_of(scene)
        assert elastic.contact_radius == pytest.approx(1e-6, rel=1e-12)
        assert elastic.peak_pressure == pytest.approx(4e9, rel=1e-12)
        assert scene.body.plasticity.B == 1780e6 and scene.body.coating.yield_stress == 0.67e9
        assert scene_of(BASE, contact, 8, film=False).body.coating is None
        assert scene_of(BASE, replace(contact, film="elastic"), 8).body.coating.yield_stress is None

    def test_refinement_leaves_out_films_that_are_squeezed_too_far(self):
        right, squeezed, softer = (
            made(FLOWING),
            made(FLOWING, film=0.2, p_max_change=0.3),
            made(FLOWING, body=0.0075),
        )
        frames = ([made(ELASTIC), right], [right, right], [right], [right, right], [squeezed, softer])
        found = against_theory(YieldingFilms(BASE, *map(pd.DataFrame, frames), ()))
        assert found["refined-pressure"] == 0.0
        assert found["refined-strain"] == pytest.approx(1.0 - 0.007 / 0.0075)


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
