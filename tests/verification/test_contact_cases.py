# SPDX-License-Identifier: MIT
"""Coated, rough and sliding contacts: what is measured of results in closed form; the film that yields."""

import math
from dataclasses import replace

import numpy as np
import pytest
from builders import GIVEN, friction_text, given_pressure, parsed
from made_results import Made, of_plane

from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.schedule import Load
from sam.scene import FieldMesh, Result, load_scene, parse_scene
from verification.cases.case import with_keys
from verification.cases.coated.film_yield import FilmContact, scene_of
from verification.compare import measures
from verification.compare.measures import Plane, depths_compared
from verification.figures.maps import in_body
from verification.judging import error_of
from verification.quantities import QUANTITIES
from verification.reference.bonded_film import elastic_mises, in_plane_strain, thinning
from verification.reference.hamilton import sliding_stress
from verification.reference.hertz import axis_stress
from verification.reference.shakedown import upper_bound
from verification.reference.stress import von_mises
from verification.references import hamilton
from verification.runs import models

SLIDING, ASPERITIES, FILM_YIELD = (
    load_scene(f"verification/scenes/{name}.toml")
    for name in ("coated-sliding", "rough-asperities", "film-yield")
)


def test_film_and_body_are_never_mixed():
    """A field that jumps at the interface and is linear below it, on other points than those of SAM."""

    def field(x, z):
        return np.where(z < 0.2e-6 * (1.0 - 1e-9), 100.0, 2.0 + 1e6 * (x + 3.0 * z))

    u, w = 1e-6 * (np.arange(-10, 10) + 0.5) / 10, 1e-6 * np.append(0.2, (np.arange(2, 10) + 0.5) / 10)
    fem = Made({}, {"plane": of_plane(u, np.union1d(w, [0.05e-6]), "mises_Pa", field)})
    found = in_body(fem, np.array([0.0, 0.33e-6]), np.array([0.1e-6, 0.3e-6, 0.61e-6]), 0.2e-6)
    assert np.isnan(found[:, 0]).all()
    exact = 2.0 + np.array([[0.0], [0.33]]) + 3.0 * np.array([[0.3, 0.61]])
    assert found[:, 1:] == pytest.approx(exact, rel=1e-12)
    scene = with_keys(SLIDING, "body.coating", thickness=0.2e-6)
    x, z = np.linspace(-1.6e-6, 1.6e-6, 52), np.arange(41) * 0.04e-6
    sam = Made({}, {"plane": of_plane(x, z, "mises_Pa", field)})
    for factor in (1.0, 1.02):
        scaled = fem.tables["plane"] | {"mises_Pa": factor * fem.tables["plane"]["mises_Pa"]}
        both = QUANTITIES["mises-below-film"].between(scene, sam, replace(fem, tables={"plane": scaled}))
        assert np.asarray(both.value) * factor == pytest.approx(both.expected, rel=1e-12)
        assert both.value.shape == (20, 9)


def asperities(load=1.0, strain=1.0, dent=1.0) -> Result:
    """Three spots of constant pressure, bells of strain below, dents; factors on spot 1."""
    x = np.linspace(-5.5e-6, 5.5e-6, 12)
    p, z = np.zeros((12, 12)), np.linspace(0.1e-6, 3e-6, 24)
    for k, value in zip((2, 6, 10), (4e9 * load, 3e9, 2e9), strict=True):
        p[k - 1 : k + 1, 5:7] = value
    xx, yy = np.meshgrid(x, x, indexing="ij")
    surface = {"x_m": xx.ravel(), "y_m": yy.ravel(), "p_Pa": p.ravel(), "state": ["peak"] * 144}
    plane = of_plane(x, z, "peeq", lambda _, z: 0.01 * strain * np.exp(-(((z - 0.6e-6) / 0.5e-6) ** 2)))
    plane["mises_Pa"] = plane["peeq"]
    uz = np.where(x < -2e-6, dent, 1.0) * 5e-9 * np.cos(x * 1e6) ** 2
    line = {"x_m": x, "uz_m": uz, "state": ["unloaded"] * 12}
    tables = {"surface": surface, "plane": plane, "line": line}
    return Result("made", "converged", {}, tables)


@pytest.mark.parametrize(
    ("wrong", "off"),
    [
        ({}, {}),
        ({"load": 1.03}, {"load-1": 0.03, "nodal-pressure": None}),
        ({"strain": 1.1}, {"strain-1": 0.1, "strain-3": 0.1, "strain-below-spots": 0.1}),
        ({"dent": 0.7}, {"residual-line": None}),
        ({"load": 0.0}, {"spots": 1.0, "nodal-pressure": None}),
    ],
)
def test_each_quantity_of_rough_contacts_sees_its_own(wrong, off):
    names = "spots", "load-1", "load-2", "nodal-pressure", "strain-1", "strain-3"
    names += "strain-below-spots", "residual-line"
    fem = asperities(load=0.0) if "spots" in off else asperities()
    found = {name: QUANTITIES[name].between(ASPERITIES, asperities(**wrong), fem) for name in names}
    metrics = {name: "relative_l2" if np.ndim(each.value) else "absolute" for name, each in found.items()}
    metrics |= dict.fromkeys(("load-1", "load-2"), "relative") | {"strain-below-spots": "at_most"}
    errors = {name: error_of(metrics[name], each) for name, each in found.items()}
    if "spots" in off:
        missing = QUANTITIES["load-3"].between(ASPERITIES, fem, fem)
        assert errors["spots"] == 1.0 and math.isnan(missing.value)
        return
    for name, error in errors.items():
        if name in off and off[name] is None:
            assert error > 1e-3
        else:
            assert error == pytest.approx(off.get(name, 0.0), rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("jump, above, under", [(0.9, 0.85, 0.95), (0.85, 0.75, 0.85)])
def test_the_strain_on_either_side_of_a_jump_is_found_and_not_between_the_points_beside_it(
    jump, above, under
):
    x, z = np.linspace(-1.0, 1.0, 5), np.arange(5, 200, 10) / 100
    strain = np.where(z < jump, 1.0 + z, 0.5 - 0.1 * z)
    depths = Plane(x, z, strain * np.ones((5, 1)), jump)
    at_z = np.array([0.1, above - 0.01, under + 0.01, 1.5])
    expected = [1.1, 0.99 + above, 0.499 - 0.1 * under, 0.35]
    np.testing.assert_allclose(depths.below(0.0, at_z), expected, rtol=1e-9)
    compared = depths_compared(depths, 0.0, 0.5)
    between = (compared > above + 1e-9) & (compared < under - 1e-9)
    assert not between.any() and ((compared > under) & (compared < under + 0.1)).any() and compared[-1] > 1.5
    even = Plane(x, z, (1.0 + z) * np.ones((5, 1)))
    np.testing.assert_allclose(even.below(0.0, at_z), 1.0 + at_z, rtol=1e-9)


class TestBondedFilm:
    p, E, nu, Y = 5e9, 80e9, 0.3, 0.67e9

    def test_strain_of_the_body_is_that_of_hertz(self):
        stress = axis_stress(0.0, self.p, 1.0, 0.28)[:3]
        expected = (stress[0] - 0.28 * (stress[1] + stress[2])) / 210e9
        assert in_plane_strain(self.p, 210e9, 0.28) == pytest.approx(expected, rel=1e-12)

    def mises(self, e, plastic=0.0):
        """By Hooke's law, of strains e, e in the surface, szz = -p and plastic strains (1/2, 1/2, -1)."""
        lame = self.E * self.nu / (1 + self.nu) / (1 - 2 * self.nu)
        C, flow = lame + self.E / (1 + self.nu) * np.eye(3), np.array([0.5, 0.5, -1.0]) * plastic
        across = (-self.p - C[2, :2].sum() * e + C[2] @ flow) / C[2, 2]
        sxx, _, szz = C @ (np.array([e, e, across]) - flow)
        return sxx - szz

    def test_elastic_and_plastic_states_obey_hookes_law(self):
        e, film = in_plane_strain(self.p, 210e9, 0.3), (self.E, self.nu, self.Y)
        assert elastic_mises(self.p, e, self.E, self.nu) == pytest.approx(self.mises(e), rel=1e-12)
        flow = thinning(self.p, 0.0, e, film)
        assert self.mises(e, flow) == pytest.approx(self.Y, rel=1e-12) and flow > 0.02
        assert thinning(0.1 * self.p, 0.0, 0.1 * e, film) == 0.0


@pytest.mark.parametrize("film", [True, False])
def test_a_flowing_film_keeps_the_contact_of_the_step_before(film):
    """A node too many squeezes the film to where no step converges, however small."""
    whole = plan(scene_of(FILM_YIELD, FilmContact(2e-6, 6.5e9, "rigid", "B 945", "yields"), 6))
    model = build(whole if film else whole.bare)
    virgin, contact = model.virgin(), model.radii <= 1.0
    gap, flowed = np.where(contact, 0.0, model.radii - 1.0), virgin.history.peeq + 1e-3
    history = replace(virgin.history, peeq=flowed)
    before = replace(virgin, load=Load(1.0), active=contact, gap=gap, history=history)
    grown = model.starting_set(1.3, before)
    assert np.array_equal(grown, contact) == film and grown.sum() >= contact.sum()


def strain(x, z):
    """A smooth zone that leans to +x, 1 % at its largest, zero outside an ellipse."""
    return 0.01 * np.maximum(0.0, 1.0 - ((x - 0.2 * z) / 1.1) ** 2 - ((z - 0.35) / 0.75) ** 2) ** 2


def plane(x, z, factor=1.0) -> Made:
    """The zone at the points of a grid in y = 0, times a factor."""
    return Made({}, {"plane": of_plane(x, z, "peeq", lambda a, b: factor * strain(a, b))})


def like_sam(factor=1.0) -> Made:
    """On cells of 1/16."""
    return plane(np.arange(-35, 36) / 16, np.arange(24) / 16 + 1 / 32, factor)


def test_hats_take_means_exactly():
    """Of constants and, inside, of linear functions at the centres of cells."""
    nodes, h = np.array([-1.0, -0.5, 0.0, 0.25, 1.0]), 0.25 / 10
    faces = np.linspace(-1.0, 1.0, 81)
    matrix, centres = measures.hat_means(nodes, faces), (faces[1:] + faces[:-1]) / 2
    assert matrix.sum(axis=1) == pytest.approx(np.ones(5), abs=1e-14)
    exact = nodes[1:-1] + (np.diff(nodes)[1:] - np.diff(nodes)[:-1]) / 3.0  # centre of an uneven triangle
    assert (matrix @ centres)[1:-1] == pytest.approx(exact, abs=h**2)


def test_profile_difference_is_that_of_the_strains():
    fem = Plane.of(plane((np.arange(-14, 14) + 0.5) / 10, (np.arange(15) + 0.5) / 10).tables)
    assert depths_compared(fem, 0.0)[0] == 0.3 and depths_compared(fem, 0.0)[-1] < 1.0
    assert measures.profile_difference(Plane.of(like_sam().tables), fem, 0.0) < 0.01
    larger = Plane.of(like_sam(factor=1.04).tables)
    assert measures.profile_difference(larger, fem, 0.0) == pytest.approx(0.04, abs=0.01)


def test_limits_are_recovered_of_errors_of_second_order_in_cells_and_first_order_in_steps():
    results = {
        f"limit-sam-{count}-{steps}": like_sam((1.0 + 3.0 / count**2) * (1.0 + 0.2 / steps))
        for count, steps in ((12, 1), (16, 1), (12, 5), (12, 10))
    }
    z = np.array([0.3, 0.5])
    exact = Plane.of(like_sam().tables).below(0.1, z)
    assert measures.limit_of_strain(results, "sam", a=1.0, x=0.1, z=z) == pytest.approx(exact, rel=1e-12)


def test_exact_stresses_of_sam_have_no_error_and_sliding_the_other_way_a_large_one():
    scene = parse_scene(given_pressure(GIVEN + "[friction]\ncoefficient = 0.4\n").encode(), "")
    a, reference = scene.loading.radius, hamilton(scene)

    def exact(x, z):
        return sliding_stress(x, 0.0, z, scene.loading.p0, contact_radius=a, nu=0.3, friction=0.4)

    def errors(result) -> np.ndarray:
        return np.array([QUANTITIES[name].of(result, reference) for name in measures.COMPONENTS])

    z = np.linspace(0.0, 2.0, 41) * a
    names, state = (f"{name}_Pa" for name in measures.COMPONENTS), ["peak"] * z.size
    axis = {"state": state, "z_m": z} | dict(zip(names, exact(0.0, z).T, strict=True))
    plane = {"state": state, "x_m": 0.3 * z, "z_m": z, "mises_Pa": von_mises(exact(0.3 * z, z))}
    found = Made({}, {"axis": axis, "plane": plane}, FieldMesh(np.zeros((0, 3)), {}))
    assert errors(found).max() < 1e-12 and QUANTITIES["plane"].of(found, reference) < 1e-12
    axis["sxz_Pa"] = -axis["sxz_Pa"]
    assert errors(found)[4] > 0.1


def test_upper_bound_is_that_of_the_literature():
    """4.68 without friction (Ponter, Hearle and Johnson 1985); 1/mu where the surface decides."""
    assert upper_bound(0.0) == pytest.approx(4.675, abs=2e-3)
    assert upper_bound(0.2) == pytest.approx(4.6715, abs=1e-3)
    assert upper_bound(0.25) == 4.0 and upper_bound(0.5) == 2.0


def test_cheapest_reference_of_a_scene():
    assert models.cheapest_reference(parsed()) == models.FEM
    assert (
        models.cheapest_reference(parse_scene(friction_text("coefficient = 0.1").encode(), ""))
        == models.FEM_3D
    )
    assert models.cheapest_reference(parse_scene(friction_text("coefficient = 0").encode(), "")) == models.FEM
    with pytest.raises(models.ModelError, match=r"fem-axisymmetric: body.poisson"):
        models.cheapest_reference(parsed(("0.3", "0.5")))
