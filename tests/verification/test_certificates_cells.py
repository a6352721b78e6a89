# SPDX-License-Identifier: MIT
"""Certificates of coated and rough bodies in SAM hold, and turn red on perturbed answers; the formulas by
themselves.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from made_results import with_column, with_field

from verification.cases.case import Context
from verification.cases.certificates.certificates import MEASURED, gated
from verification.cases.certificates.certificates_measures import OF_GROUP, Conditions, solved
from verification.cases.certificates.certificates_scenes import coated, rough
from verification.checks import (
    cells as cell_checks,
    coated as coated_checks,
    conditions as contact_checks,
    film as film_checks,
)
from verification.reference.hertz import CircularContact
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.point_loads import cerruti_displacement
from verification.rows import load_rows
from verification.runs.models import SAM

LIMITS = {
    each.id.removeprefix("certificates."): each.tolerance
    for each in load_rows()
    if each.case == "certificates"
}


@pytest.fixture(scope="module")
def solves(tmp_path_factory):
    """name -> (scene, result, records)."""
    context = Context("certificates", tmp_path_factory.mktemp("certificates"), "quick", lambda *_: None)
    return {
        name: (scene, *solved(scene, SAM))
        for name, scene in {**coated(context), **rough(context, SAM)}.items()
    }


def with_film(scene, **keys):
    film = scene.body.coating.model_copy(update=keys)
    return scene.model_copy(update={"body": scene.body.model_copy(update={"coating": film})})


COATED = "soft film", "film, sliding"
ROUGH = "rough, elastic", "rough, Swift", "rough, film that fails"


@pytest.mark.parametrize("name", [*COATED, *ROUGH])
def test_all_conditions_hold(solves, name):
    group = "coated" if name in COATED else "rough"
    for what, value in OF_GROUP[group](*solves[name]).values.items():
        assert value <= LIMITS[f"{group}-{what}"], what


def test_what_no_scene_was_measured_for_is_no_success():
    """And the largest value of a group counts."""
    found = {group: {"a": Conditions(dict.fromkeys(names, 0.0))} for group, names in MEASURED.items()}
    found["rough"]["b"] = Conditions({"load": 1.0})
    assert gated(found)["rough-load"].value == 1.0 and set(gated(found)) == set(LIMITS)
    del found["coated"]["a"].values["interface"]
    with pytest.raises(ValueError, match="coated: no scene has interface"):
        gated(found)


class TestAny:
    """Conditions of both groups."""

    @pytest.mark.parametrize("name, group", [("film, sliding", "coated"), ("rough, Swift", "rough")])
    def test_tables_and_fields(self, solves, name, group):
        scene, result, _ = solves[name]
        more = with_field(result, "cell_data", "p_Pa", lambda p: 1.00001 * p)
        assert contact_checks.load(scene, more)["load"] > LIMITS[f"{group}-load"]
        more = with_field(result, "cell_data", "qx_Pa", lambda q: 1.00001 * q)
        assert contact_checks.slips(scene, more) > LIMITS[f"{group}-friction"]
        more = with_column(result, "line", "uz_m", lambda u: 1.00001 * u)
        assert max(contact_checks.complementarity(scene, more).values()) > LIMITS[f"{group}-complementarity"]

    @pytest.mark.parametrize("name, group", [("film, sliding", "coated"), ("rough, elastic", "rough")])
    @pytest.mark.parametrize("component", [2, 4])
    def test_tractions_at_the_surface(self, solves, name, group, component):
        def more(stress):
            stress[:, component] *= 1.00001
            return stress

        scene, result, _ = solves[name]
        changed = with_field(result, "point_data", "stress_Pa", more)
        assert max(contact_checks.sam_surface(scene, changed).values()) > LIMITS[f"{group}-surface"]

    def test_a_step_that_ends_above_its_goal(self, solves):
        for group, name in (("coated", "soft film"), ("rough", "rough, Swift")):
            scene, result, records = solves[name]
            late = with_column(result, "residuals", "residual", lambda r: 1e9 * r)
            assert OF_GROUP[group](scene, late, records).values["histories"] > LIMITS[f"{group}-histories"]


class TestCoated:
    """Displacement and interface of a film."""

    @pytest.mark.parametrize("name", COATED)
    @pytest.mark.parametrize("key", ["young", "poisson", "thickness"])
    def test_another_film(self, solves, name, key):
        scene, result, _ = solves[name]
        other = with_film(scene, **{key: 1.00001 * getattr(scene.body.coating, key)})
        assert max(coated_checks.displaced(other, result).values()) > LIMITS["coated-displacement"]

    def test_another_pressure(self, solves):
        scene, result, _ = solves["soft film"]
        more = with_field(result, "cell_data", "p_Pa", lambda p: 1.0000001 * p)
        assert max(coated_checks.displaced(scene, more).values()) > LIMITS["coated-displacement"]

    @pytest.mark.parametrize("component", range(6))
    def test_a_jump(self, solves, component):
        scene, result, _ = solves["film, sliding"]
        z = contact_checks.plane_of(result)[1]
        k, nz = int(np.argmin(np.abs(z - scene.body.coating.thickness))), z.size

        def jump(stress):
            stress[k - nz - 1 :: -nz, component] += 1e-5 * result.quantities["p_max_Pa"]
            return stress

        changed = with_field(result, "point_data", "stress_Pa", jump)
        assert max(coated_checks.interface(scene, changed).values()) > LIMITS["coated-interface"]

    def test_compliance(self, solves):
        """Of the dense system with many digits: by Love's function of the axisymmetric problem, k from long
        to short waves.
        """
        scene = solves["soft film"][0]
        film, body = scene.body.coating, scene.body
        k = np.geomspace(1e-3, 20.0, 40) / film.thickness
        layers = CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)
        mu = film.young / (2 * (1 + film.poisson))
        excess = layers.compliance(k) * mu * k - (1 - film.poisson)
        assert coated_checks.compliance(scene, 0)(np.log(k * film.thickness)) == pytest.approx(
            excess, abs=1e-10
        )


class TestRough:
    """Displacement, stress, yield and flow below a rough patch."""

    def test_heights(self, solves):
        for name in ROUGH:
            scene, result, records = solves[name]
            higher = with_field(result, "cell_data", "height_m", lambda height: 1.0001 * height)
            assert max(cell_checks.displaced(scene, higher, records).values()) > LIMITS["rough-displacement"]
            higher = with_column(result, "surface", "height_m", lambda height: 1.0001 * height)
            assert (
                max(contact_checks.complementarity(scene, higher).values()) > LIMITS["rough-complementarity"]
            )

    @pytest.mark.parametrize("name", ROUGH)
    def test_without_the_traction(self, solves, name):
        scene, result, records = solves[name]
        decoupled = scene.model_copy(
            update={"friction": scene.friction.model_copy(update={"coupling": False})}
        )
        assert (
            max(cell_checks.displaced(decoupled, result, records).values())
            > 100 * LIMITS["rough-displacement"]
        )

    @pytest.mark.parametrize("component", range(6))
    def test_another_plastic_strain(self, solves, component):
        scene, result, records = solves["rough, Swift"]
        trees = [record.tree() for record in records]
        for tree in trees:
            material = tree["state"]["points"]
            material["strain"] = np.array(material["strain"])
            material["strain"][component] *= 1.05
        changed = [SimpleNamespace(tree=lambda tree=tree: tree) for tree in trees]
        assert max(cell_checks.displaced(scene, result, changed).values()) > LIMITS["rough-displacement"]
        assert cell_checks.left(scene, result, changed) > LIMITS["rough-displacement"]

    @pytest.mark.parametrize("component", range(6))
    def test_another_stress(self, solves, component):
        def more(stress):
            stress[:, component] *= 1.001
            return stress

        scene, result, _ = solves["rough, elastic"]
        changed = with_field(result, "point_data", "stress_Pa", more)
        assert cell_checks.stress(scene, changed) > LIMITS["rough-stress"]

    @pytest.mark.parametrize("name, what", [
        ("peeq", "flow"), ("strain", "flow"), ("stress", "consistency"), ("stress", "yield"),
    ])  # fmt: skip
    def test_another_flow(self, solves, name, what):
        scene, result, records = solves["rough, Swift"]
        trees = [record.tree() for record in records]
        tree = max(trees, key=lambda each: each["state"]["load"]["force"])
        owner = tree["last"] if name == "stress" else tree["state"]["points"]
        owner[name] = 1.0001 * owner[name]
        changed = [SimpleNamespace(tree=lambda tree=tree: tree) for tree in trees]
        assert OF_GROUP["rough"](scene, result, changed).values[what] > LIMITS[f"rough-{what}"]


class TestFilm:
    """The state of a chemical film in each cell."""

    @pytest.fixture
    def changed(self, solves):
        """Conditions of other film states at the peak, by a function of (pressure, state)."""
        scene, _, records = solves["rough, film that fails"]

        def conditions(change):
            trees = [record.tree() for record in records]
            peak = max(trees, key=lambda each: each["state"]["load"]["force"])
            film = peak["tribofilm"]
            state = film["film"] = {name: np.array(values) for name, values in film["film"].items()}
            change(film_checks.pressure_of(scene, peak), state)
            return film_checks.states(scene, [SimpleNamespace(tree=lambda tree=tree: tree) for tree in trees])

        return conditions

    def test_strain(self, changed):
        def more(pressure, state):
            state["plastic"] *= 1.001

        assert changed(more)["flow"] > LIMITS["rough-film"]

    def test_a_cell_that_should_have_failed(self, changed):
        """The one under the largest pressure, which has failed in the last step: the film does not bear its
        traction.
        """

        def whole(pressure, state):
            state["failed"][np.unravel_index(pressure.argmax(), pressure.shape)] = False

        found = changed(whole)
        assert (
            found["traction"] > LIMITS["rough-film"]
            and max(found["flow"], found["limit"]) < LIMITS["rough-film"]
        )

    def test_all_cells_whole(self, changed):
        found = changed(lambda pressure, state: state["failed"].fill(False))
        assert found["healed"] >= 1 and found["traction"] > 0

    def test_a_thinning_beyond_the_limit(self, solves):
        scene, _, records = solves["rough, film that fails"]
        friction = scene.friction.model_copy(update={"strain_limit": 1e-4})
        found = film_checks.states(scene.model_copy(update={"friction": friction}), records)
        assert found["limit"] > LIMITS["rough-film"]

    def test_cells_of_both_coefficients(self, solves):
        scene, result, _ = solves["rough, film that fails"]
        p = contact_checks.surface_of(result)[2]
        ratio = contact_checks.returned_traction(result)[p > 0] / p[p > 0]
        assert {round(float(each), 12) for each in ratio} == {scene.friction.low, scene.friction.high}
        other = with_field(result, "cell_data", "qx_Pa", lambda q: q + 1e-3 * p.max())
        assert contact_checks.slips(scene, other) > LIMITS["rough-friction"]


class TestFormulas:
    """Sums over cells against solutions of their own."""

    line = (np.arange(41) - 20) / 16

    def test_love(self):
        """A Hertz pressure moves the surface as Hertz says, to the order of the cells squared."""
        x = self.line
        r = np.hypot(x[:, None], x[None, :])
        hertz = CircularContact(1.0, 1.0, 1.0)
        p = hertz.pressure(hertz.contact_radius * r)
        u = cell_checks.half_space(1.0, 0.0, x, x, p=p, q=0 * p, cell=(1 / 16, 1 / 16)) * hertz.contact_radius
        assert u[20, 20] == pytest.approx(float(hertz.displacement(0.0)), rel=5e-3)

    def test_cerruti(self):
        """Far from one cell, as a point force; beside it odd in x."""
        q = np.zeros((41, 41))
        q[20, 20] = 1.0
        u = cell_checks.half_space(2.0, 0.2, self.line, self.line, p=0 * q, q=q, cell=(1 / 16, 1 / 16))
        far = cerruti_displacement(self.line[40], self.line[33], 0.0, 1 / 256, young=2.0, nu=0.2)[2]
        assert u[40, 33] == pytest.approx(far, rel=1e-3)
        assert u == pytest.approx(-u[::-1], abs=1e-6 * np.abs(u).max()) and u[20, 20] == 0.0

    def test_rules(self):
        """Weights of the graded points: integrals of a constant, and of 1/r^2 over a cube that the origin
        touches.
        """
        for low, high in ((-0.5, 0.5), (0.0, 1.0), (1.0, 2.0), (-2.0, -1.0)):
            points, weights = cell_checks.towards_zero(low, high, 40)
            assert weights.sum() == pytest.approx(high - low) and ((points > low) & (points < high)).all()
        x = y = cell_checks.towards_zero(-0.5, 0.5, 40)
        z = cell_checks.towards_zero(0.0, 0.5, 40)
        stress = cell_checks.integrals(x, y, z, 0.3).ravel()
        finer = [cell_checks.towards_zero(*ends, 80) for ends in ((-0.5, 0.5), (-0.5, 0.5), (0.0, 0.5))]
        assert stress == pytest.approx(cell_checks.integrals(*finer, 0.3).ravel(), abs=3e-6)
        assert abs(stress[3:]).max() < 1e-12 and stress[0] == pytest.approx(stress[1])
