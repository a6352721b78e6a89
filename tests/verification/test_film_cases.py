# SPDX-License-Identifier: MIT
"""The cases of the film that yields: measures on made results, and red gates for wrong ones."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from made_results import Made, red

from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.schedule import Load
from sam.scene import load_scene
from verification.cases.coated import film_words, film_yield
from verification.cases.coated.film_contacts import FilmContact, SolvedFilm, exact_changes, scene_of
from verification.judging import Measured
from verification.reference.bonded_film import (
    elastic_mises,
    flow_gradient,
    in_plane_strain,
    plastic_strain,
)
from verification.reference.hertz import axis_stress
from verification.references import contact_of

BASE = load_scene("verification/scenes/film-yield.toml")

ELASTIC = FilmContact(2e-6, 6.5e9, False, "elastic", False)
FLOWING = FilmContact(2e-6, 6.5e9, False, "B 945", True)


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
        """Stresses for strains e, e in the surface and the normal one that gives -p, plastic strains (1/2,
        1/2, -1).
        """
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


def tables(film, body, centre, mises, slope):
    """Axis and plane with two points in the film of 100 nm and two below; strains of film and body, at the
    centre of the film.
    """
    z = np.array([20e-9, 80e-9, 100e-9, 500e-9])
    axis = {"state": ["peak"] * 4, "z_m": z, "peeq": [0.9 * centre, 1.1 * centre, 0.5 * body, body]}
    axis["mises_Pa"] = [0.9 * mises, 1.1 * mises, 9e9, 9e9]
    plane = {
        "state": ["peak"] * 4,
        "x_m": [1e-7, 1e-7, 1e-7, 2e-6],
        "z_m": z,
        "peeq": [film, 0.8 * film, 0.1 * body, 0.0],
    }
    r = np.linspace(0.0, 2e-6, 41)
    line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": 6.5e9 - slope * r}
    return {"line": line, "axis": axis, "plane": plane | {"mises_Pa": [mises, 0.5 * mises, 9e9, 9e9]}}


@cache
def exact() -> tuple[float, float]:
    """Of the contact that is elastic throughout."""
    return exact_changes(SolvedFilm(ELASTIC, scene_of(BASE, ELASTIC, 8), None, None))


def made(contact, changes=None, film=0.04, body=0.007, *, centre=None, bare=0.0086, **layer) -> SolvedFilm:
    """A result that no solver made: what a film of that kind would give if every independent answer
    were met.

    layer: the von Mises stress of the film, and the slope of the pressure over the radius.
    """
    scene = scene_of(BASE, contact, 8)
    elastic = contact.body == "elastic"
    p_bare = contact.p0 if elastic else 0.8 * contact.p0
    p_change, mises_change = changes or exact()
    quantities = {"p_center_Pa": contact.p0, "p_max_bare_Pa": p_bare, "mises_max_film_Pa": 2.8e9}
    quantities |= {"p_max_change": p_change, "mises_max_change": mises_change}
    without = Made({"p_max_Pa": p_bare, "peeq_max": 0.0 if elastic else bare})
    found = SolvedFilm(contact, scene, Made(quantities), without)
    centre = found.thin_film if centre is None else centre
    made_tables = tables(
        film * contact.yields,
        0.0 if elastic else body,
        centre * contact.yields,
        layer.get("mises", 0.67e9) if contact.yields else centre,
        layer.get("slope", SLOPE),
    )
    return replace(found, result=Made(quantities, made_tables))


NONE = (0.0, 0.0)
SLOPE = flow_gradient(0.67e9, 100e-9)
THIN = [FilmContact(10e-6, 6.5e9, False, "elastic", yields) for yields in (False, True)]


class TestFound:
    def test_strains_and_stresses_are_of_their_layer(self):
        found = made(FLOWING, (-0.01, -0.02), centre=0.03)
        assert (found.film_strain, found.body_strain, found.bare_strain) == (0.04, 0.007, 0.0086)
        assert found.at_centre == pytest.approx(0.03) and found.film_mises == 0.67e9
        r, profile = found.film_profile
        assert r == pytest.approx([1e-7]) and profile == pytest.approx([0.9 * 0.04])

    def test_claim_needs_both_changes_and_a_film_that_is_not_squeezed_out(self):
        assert made(FLOWING, (-0.049, 0.049)).negligible is True
        assert made(FLOWING, (-0.049, -0.051)).negligible is False
        assert made(FLOWING, (0.051, 0.0)).negligible is False
        assert made(FLOWING, (-0.01, -0.01), film=0.15).negligible is None

    @pytest.mark.parametrize("steel", [False, True])
    def test_scenes_have_the_radius_and_pressure_that_they_are_named_by(self, steel):
        contact = FilmContact(1e-6, 4e9, steel, "B 1780", True)
        scene = scene_of(BASE, contact, 8)
        elastic = contact_of(scene)
        assert elastic.contact_radius == pytest.approx(
            1e-6, rel=1e-12
        ) and elastic.peak_pressure == pytest.approx(4e9, rel=1e-12)
        assert scene.body.plasticity.B == 1780e6 and scene.body.coating.yield_stress == 0.67e9
        assert scene_of(BASE, contact, 8, film=False).body.coating is None
        assert scene_of(BASE, replace(contact, yields=False), 8).body.coating.yield_stress is None

    def test_every_combination_is_there_once(self):
        full = film_yield.contacts("full")
        assert len(full) == len({contact.label for contact in full}) == 72
        assert set(film_yield.refined("full")) <= set(full) and set(film_yield.refined("quick")) <= set(
            film_yield.contacts("quick")
        )
        assert set(film_yield.contacts("quick")) <= set(full)


class TestFilmGates:
    def values(self, elastic=None, flowing=None, thin=None, fine=None, hill=None):
        found = [elastic or made(ELASTIC), flowing or made(FLOWING, (-0.01, -0.02))]
        limits, hills = (
            thin or [made(each, NONE) for each in THIN],
            [hill or made(film_yield.flowing(), NONE)],
        )
        values = film_yield.against_theory(found) | film_yield.of_the_layers(found, limits, hills)
        return values | film_yield.of_refinement([(found[1], fine or made(FLOWING, (-0.012, -0.018)))])

    def test_right_answers_hold(self):
        assert red("film-yield", self.values()) == set()

    def test_wrong_changes_turn_red(self):
        p, mises = exact()
        assert red("film-yield", self.values(made(ELASTIC, (p - 0.006, mises)))) == {"elastic-pressure"}
        assert red("film-yield", self.values(made(ELASTIC, (p, mises + 0.006)))) == {"elastic-mises"}
        stiffer = BASE.model_copy(
            update={"body": BASE.body.model_copy(update={"young": 250e9})}
        )  # a wrong body
        wrong = replace(made(ELASTIC), scene=scene_of(stiffer, ELASTIC, 8))
        assert "elastic-mises" in red("film-yield", self.values(wrong))

    @pytest.mark.parametrize(
        ("which", "wrong", "gates"),
        [
            ("flowing", {"mises": 0.68e9}, {"film-excess"}),
            ("flowing", {"body": 0.0087}, {"spared", "refined-strain"}),
            ("fine", {"changes": (-0.016, -0.02)}, {"refined-pressure"}),
            ("fine", {"changes": (-0.01, -0.026)}, {"refined-mises"}),
            ("fine", {"body": 0.0075}, {"refined-strain"}),
        ],
    )
    def test_wrong_layers_and_meshes_turn_red(self, which, wrong, gates):
        assert (
            red("film-yield", self.values(**{which: made(FLOWING, **({"changes": (-0.01, -0.02)} | wrong))}))
            == gates
        )

    def test_wrong_bare_contacts_turn_red(self):
        def without(found, p):
            return replace(
                found, result=replace(found.result, quantities=found.result.quantities | {"p_max_bare_Pa": p})
            )

        assert red("film-yield", self.values(without(made(ELASTIC), 6.53e9))) == {"bare-hertz"}
        assert red("film-yield", self.values(flowing=without(made(FLOWING, (-0.01, -0.02)), 5.23e9))) == {
            "bare-mesh"
        }

    def test_a_film_that_shares_no_strain_with_the_body_turns_red(self):
        """Thin film with the strain in the surface left out: 0.57 p and not 0.43 p of von Mises stress."""
        alone = [replace_centre(made(each, NONE)) for each in THIN]
        assert red("film-yield", self.values(thin=alone)) == {"centre-mises", "centre-strain"}

    def test_a_film_that_holds_twice_the_gradient_turns_red(self):
        """As one between two rough plates does."""
        right = made(film_yield.flowing(), NONE)
        assert right.gradient == pytest.approx(SLOPE, rel=1e-9) and 3.8e15 < SLOPE < 3.9e15
        assert red("film-yield", self.values(hill=made(film_yield.flowing(), NONE, slope=2.0 * SLOPE))) == {
            "flow"
        }

    def test_a_film_squeezed_too_far_is_not_gated_under_refinement(self):
        coarse, fine = made(FLOWING, (-0.01, -0.02)), made(FLOWING, (-0.05, -0.02), film=0.2)
        assert np.isnan(film_yield.off([]))
        values = film_yield.of_refinement([(coarse, fine), (coarse, coarse)])
        assert values["refined-pressure"].value == 0.0

    def test_a_film_of_one_material_that_changes_something_turns_red(self):
        right = {
            "equal-pressure": Measured(1e-12),
            "equal-mises": Measured(0.0),
            "equal-strain": Measured(0.008, 0.00803),
        }
        assert red("film-yield", right) == set()
        wrong = {
            "equal-pressure": Measured(1e-6),
            "equal-mises": Measured(1e-6),
            "equal-strain": Measured(0.008, 0.0082),
        }
        assert red("film-yield", wrong) == set(wrong)


def replace_centre(found: SolvedFilm) -> SolvedFilm:
    """The same with the film's answer under pressure alone."""
    film, p = found.scene.body.coating, found.result.quantities["p_center_Pa"]
    mises = elastic_mises(p, 0.0, film.young, film.poisson)
    flow = plastic_strain(p, 0.0, (film.young, film.poisson, 0.67e9))
    return made(found.contact, NONE, centre=flow if found.contact.yields else mises)


class TestWords:
    def found(self):
        small, large = FilmContact(1e-6, 6.5e9, False, "elastic", False), ELASTIC
        kinds = [replace(large, yields=True), replace(large, body="B 945"), FLOWING]
        found = [made(small, (-0.07, -0.08)), made(large, (-0.04, -0.04))]
        found += [
            made(contact, (-0.06, -0.07) if contact.body == "elastic" else (-0.01, -0.01))
            for contact in kinds
        ]
        return [*found, made(replace(small, body="B 945", yields=True), (-0.01, -0.03), film=0.3)]

    def test_answer_names_what_fails_and_what_has_no_answer(self):
        notes = film_words.answer(self.found(), BASE.body.coating)
        assert "in 1 of 2 contacts" in notes[0]
        assert (
            "survives in 0 of these 1 and fails in rigid, a₀ = 2 µm" in notes[2]
            and "-6.0 % and -7.0 %" in notes[2]
        )
        assert "survives in 1 of these 1; 1 without an answer" in notes[4]
        assert (
            "by up to 19 %" in notes[5]
            and "30 %" in notes[6]
            and "3.87 GPa/µm; in the contacts without an answer p₀/a₀ is 6.5 GPa/µm" in notes[6]
        )

    def test_tables_have_a_row_for_each(self):
        found = self.found()
        claims = film_words.claims(found)
        assert [row[2] for row in claims.rows] == ["1 of 2", "0 of 1", "1 of 1", "1 of 2"]
        assert len(film_words.numbers(found, False, 0.67e9).rows) == len(found)
        assert film_words.numbers(found, True, 0.67e9).rows == []
        for table in (
            claims,
            film_words.numbers(found, False, 0.67e9),
            film_words.refinement([(found[1], found[1])]),
        ):
            assert {len(row) for row in table.rows} == {len(table.columns)}


def test_a_flowing_film_keeps_the_contact_of_the_step_before():
    """A node too many, as the set scaled with the force may have, squeezes it to where no step converges,
    however small.
    """
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
