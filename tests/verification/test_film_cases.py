# SPDX-License-Identifier: MIT
"""The film that yields: closed forms of a bonded film, and what is read from results."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import Made, context, red

from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.schedule import Load
from sam.scene import load_scene
from verification.cases import all_cases
from verification.cases.coated import film_yield
from verification.cases.coated.film_yield import FilmContact, row_of, scene_of
from verification.reference.bonded_film import elastic_mises, in_plane_strain, thinning
from verification.reference.hertz import axis_stress
from verification.references import contact_of

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


def made(scene, **wrong: float) -> Made:
    """Of two points in the film of 100 nm and two below; largest plastic strains of film and body, the
    pressure falls by 2e15 Pa/m.
    """
    film, body, slope = (
        wrong.get(name, usual) for name, usual in (("film", 0.04), ("body", 0.007), ("slope", 2e15))
    )
    z, r = np.array([20e-9, 80e-9, 100e-9, 500e-9]), np.linspace(0.0, 1e-5, 201)
    axis = {"state": ["peak"] * 4, "z_m": z, "peeq": [0.027, 0.033, 0.5 * body, body]}
    axis["mises_Pa"] = [2e9, 4e9, 9e9, 9e9]
    plane = {"state": ["peak"] * 4, "x_m": [1e-7, 1e-7, 1e-7, 2e-6], "z_m": z}
    largest = scene.body.coating.yield_stress or 2.8e9 if scene.body.coating else 0.0
    plane |= {"peeq": [film, 0.8 * film, 0.1 * body, 0.0], "mises_Pa": [largest, 0.5e9, 9e9, 9e9]}
    line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": 6.5e9 - slope * r}
    quantities = {"p_max_change": -0.049, "mises_max_change": 0.049, "p_center_Pa": 6.5e9}
    quantities |= {"p_max_bare_Pa": 6.5e9, "p_max_Pa": 6.5e9, "peeq_max": 0.0086}
    return Made(
        quantities | {name: wrong[name] for name in wrong if name in quantities},
        {"line": line, "axis": axis, "plane": plane},
    )


@pytest.mark.parametrize(
    ("label", "wrong", "gates"),
    [
        ("", {}, set()),
        ("elastic-elastic-rigid-2um", {"p_max_change": -0.055}, {"elastic-pressure"}),
        ("elastic-elastic-rigid-2um", {"p_max_bare_Pa": 6.54e9}, {"bare-hertz", "bare-mesh"}),
        ("elastic-yields-rigid-1um", {"slope": 2.4e15}, {"flow"}),
        ("b945-yields-rigid-2um-65-8", {"body": 0.0087}, {"spared", "refined-strain"}),
        ("b945-yields-rigid-2um-65-16", {"body": 0.0075}, {"refined-strain"}),
        ("b945-yields-rigid-2um-65-16", {"p_max_change": -0.06}, {"refined-pressure"}),
        ("one-material", {"p_max_change": 0.0, "mises_max_change": 1e-7}, {"equal-mises"}),
    ],
)
def test_rows_of_the_yielding_film_see_what_is_wrong(monkeypatch, tmp_path, label, wrong, gates):
    """Contacts of the quick level whose answers are those of the closed forms, one of them changed."""
    monkeypatch.setattr(film_yield, "changes_by_film", lambda scene: (-0.049, 0.049))
    monkeypatch.setattr(film_yield, "elastic_mises", lambda *_: 3e9)
    monkeypatch.setattr(film_yield, "thinning", lambda *_: 0.03)
    monkeypatch.setattr(film_yield, "flow_gradient", lambda *_: 2e15)
    here, case = context("film-yield", tmp_path), all_cases()["film-yield"]

    def solve(model, scene, name, demand=True):
        usual = {"p_max_change": 0.0, "mises_max_change": 0.0} if name.startswith("one") else {}
        return made(scene, **usual | (wrong if label and name.startswith(label) else {}))

    here.solve = solve
    assert red("film-yield", case.measure(case.solve(here)), whole=True) == gates


def test_a_film_that_is_squeezed_out_is_no_answer():
    """The claim needs both changes, and strains are of their layer."""
    rows = [
        row_of(FLOWING, scene_of(BASE, FLOWING, 8), made(scene_of(BASE, FLOWING, 8), **wrong), made(BASE))
        for wrong in ({}, {"film": 0.15}, {"p_max_change": -0.051}, {"mises_max_change": 0.051})
    ]
    assert [row["known"] for row in rows] == ["yes", "no", "yes", "yes"]
    assert [row["holds"] for row in rows] == ["yes", "yes", "no", "no"]
    assert [rows[0][f"{name}_strain"] for name in ("film", "body", "bare")] == [0.04, 0.007, 0.0086]


def test_scenes_have_the_radius_and_pressure_that_they_are_named_by():
    elastic = contact_of(scene_of(BASE, FilmContact(1e-6, 4e9, "steel", "B 1780", "yields"), 8))
    assert elastic.contact_radius == pytest.approx(1e-6, rel=1e-12)
    assert elastic.peak_pressure == pytest.approx(4e9, rel=1e-12)


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
