# SPDX-License-Identifier: MIT
"""The film of the three-dimensional model: against the axisymmetric one, far field, friction, yielding, what
has no answer.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import scene as small_scene

import fem_reference
from fem_reference import spatial
from fem_reference.common import loading
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.elasticity import mises
from fem_reference.common.far_field import slanted
from fem_reference.common.layered_force import slanted_pair
from fem_reference.common.schedule import Load
from fem_reference.spatial import recovery
from fem_reference.spatial.model import build
from fem_reference.spatial.planner import plan
from sam.scene.result import QUANTITIES
from sam.scene.schema import Scene
from verification.reference.coated_traction import coated_sliding_stress
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises

YOUNG, NU, RADIUS, A = 210e9, 0.3, 105e-6, 3e-6
MODULUS = YOUNG / (1 - NU**2)


def scene(h=0.1, ratio=80 / 210, cells=4, box=4.0, *, strength=None, friction=None, **load):
    coating = {"thickness": h * A, "young": ratio * YOUNG, "poisson": NU, "yield_stress": strength}
    given = (
        {"prescribed": "hertz", "radius": A, **load} if load else {"force": 4 / 3 * MODULUS * A**3 / RADIUS}
    )
    return small_scene(
        body={"coating": coating},
        loading=given,
        friction=friction,
        fem={"cells_per_radius": cells, "box": box},
    )


@cache
def solved():
    return spatial.solve(scene())


def test_against_the_axisymmetric_model():
    """Elements of a/4: changes of -7 and -8 % within 0.5 points, approach, pressure and stress within 1 and 2
    %, film 5 %.
    """
    coarse, fine = solved(), fem_reference.solve(scene(cells=16, box=10.0))
    assert coarse.converged and tuple(coarse.quantities) == QUANTITIES
    for name, allowed in (
        ("approach_m", 0.01),
        ("p_max_Pa", 0.02),
        ("mises_max_substrate_Pa", 0.02),
        ("contact_radius_m", 0.03),
    ):
        assert coarse.quantities[name] == pytest.approx(fine.quantities[name], rel=allowed), name
    for name in ("p_max_change", "mises_max_change"):
        assert coarse.quantities[name] == pytest.approx(fine.quantities[name], abs=0.005), name
        assert fine.quantities[name] < -0.05
    assert coarse.quantities["mises_max_film_Pa"] == pytest.approx(
        fine.quantities["mises_max_film_Pa"], rel=0.05
    )
    assert coarse.discretisation["film_layers"] == 2
    z = coarse.tables["axis"]["z_m"]
    assert z[2] == pytest.approx(0.1 * A, rel=1e-9) and (z < 0.099 * A).sum() == 2 and z[3] > 0.101 * A
    assert max(coarse.certificate.values()) < 1e-8


@cache
def given_tractions(cells, h=0.5, friction=0.4):
    """Model and stresses under the Hertz pressure and the traction; the film is as many elements thick as the
    radius, times h.
    """
    model = build(plan(scene(h, cells=cells, box=6.0, friction=friction, p0=P0)))
    return model, recovery.stresses(
        model, model.load(Load(model.scales.peak_force, friction), model.virgin())
    )


P0, INSIDE = 4e9, 0.5 * A
LAYERS = CoatedHalfSpace(80e9, NU, 0.5 * A, YOUNG, NU)


def error_on_face(cells: int, film: bool, depth: float) -> float:
    """Of the von Mises stress at a face of a layer, on y = 0 well inside the contact, relative L2, against
    the closed form.
    """
    _, s = given_tractions(cells)
    part = recovery.with_face(s.layer(film), depth)
    x, row = np.abs(s.x) <= INSIDE, 0 if depth < s.layer(film).z[0] else -1
    exact = von_mises(coated_sliding_stress(LAYERS, P0, A, 0.4, x=s.x[x], z=depth, film=film)[:, 0])
    return float(np.linalg.norm(mises(part.plane[:, x, row]) - exact) / np.linalg.norm(exact))


@pytest.mark.parametrize(("film", "depth"), [(True, 0.0), (True, 0.5 * A), (False, 0.5 * A)])
def test_stress_at_the_faces_of_a_layer_is_of_second_order(film, depth):
    """Elements halved: the error falls by 4 at second order. The film has two of them first, then four."""
    coarse, fine = (error_on_face(cells, film, depth) for cells in (4, 8))
    assert np.log2(coarse / fine) > 1.7 and fine < 0.01


def test_centres_of_elements_are_of_first_order_at_a_face(monkeypatch):
    """The stress of the nearest element in place of that of the face."""
    monkeypatch.setattr(recovery, "LEVELS", 1)
    coarse, fine = (error_on_face(cells, True, 0.5 * A) for cells in (4, 8))
    assert np.log2(coarse / fine) < 1.3 and fine > 0.03


def test_a_face_never_takes_from_the_other_layer():
    """The film's stresses multiplied leave those of the body's face as they are, and the other way round."""
    _, s = given_tractions(4)
    n, depth = s.coating_layers, s.interface
    for film, other in ((True, slice(n, None)), (False, slice(None, n))):
        changed = {name: getattr(s, name).copy() for name in ("stress", "plane", "axis")}
        for field in changed.values():
            field[..., other] *= 7.0
        right, found = (recovery.with_face(each.layer(film), depth) for each in (s, replace(s, **changed)))
        assert all(np.array_equal(getattr(right, name), getattr(found, name)) for name in changed)


def test_a_layer_that_yielded_is_read_at_its_elements():
    """Beyond them a polynomial would pass the yield stress."""
    _, s = given_tractions(4)
    part = s.layer(False)
    yielded = replace(part, peeq=np.where(part.peeq == 0.0, 1e-4, part.peeq))
    face = recovery.with_face(yielded, s.interface)
    assert np.array_equal(face.stress[..., 0], part.stress[..., 0]) and face.z[0] == s.interface
    assert not np.array_equal(recovery.with_face(part, s.interface).stress[..., 0], part.stress[..., 0])
    both = replace(s, peeq=np.full_like(s.peeq, 1e-4))
    assert recovery.largest_in_layer(both, coating=False)[0] == mises(part.stress).max()


def test_far_field_under_friction():
    """What the film adds far away, in the model, is that of an infinite film when it is thick, and zero when
    it is none.
    """
    points = np.array([[10.0, 3.0, -7.0], [0.0, 8.0, 2.0], [0.0, 5.0, 10.0]])
    for forces in ((1.0, 0.0), (0.0, 1.0), (1.0, 0.3)):
        found = np.einsum("f,fcn->cn", forces, slanted_pair(Coating(1e7, 0.4, 0.2), Elastic(1.0, NU), points))
        expected = slanted(forces, Elastic(0.4, 0.2), points) - slanted(forces, Elastic(1.0, NU), points)
        assert np.abs(found - expected).max() < 2e-5 * np.abs(expected).max()
    model, bare = (
        build(plan(scene(0.5, cells=2, friction=0.2))),
        build(plan(scene(0.5, cells=2, friction=0.2)).bare),
    )
    load = Load(4 / 3, 0.2)
    far, body = (m.problem.far_field(load) for m in (model, bare))
    assert np.abs(far - body).max() > 1e-3 * np.abs(body).max()
    assert np.array_equal(model.problem.far_field(load), far)


def test_equal_materials_under_friction():
    """A film of the body's material: to the tolerance of the loop nothing changes, under traction as well."""
    q = spatial.solve(scene(0.1, 1.0, cells=4, box=3.0, friction=0.2)).quantities
    assert abs(q["p_max_change"]) < 1e-7 and abs(q["mises_max_change"]) < 1e-7
    assert abs(q["pressure_centroid_x_m"]) > 0.01 * A  # against a rigid body the traction tilts the pressure


def test_yielding_film_under_given_tractions():
    """mu p below the shear strength: at yield and not beyond. Three elements in the radius: fast, and said by
    the status.
    """
    result = spatial.solve(scene(0.05, cells=3, box=3.0, strength=0.67e9, friction=0.1, p0=2.5e9))
    q = result.quantities
    assert result.status == "under-resolved"
    assert q["mises_max_film_Pa"] == pytest.approx(
        0.67e9, rel=5e-3
    )  # means of elements whose points are all at yield
    assert q["mises_max_film_Pa"] < 0.67e9 * (1 + 1e-9) and 5e-3 < q["peeq_max"] < 5e-2
    assert result.certificate["yield_excess"] < 1e-9 and result.certificate["equilibrium"] < 1e-9
    assert -0.02 < q["mises_max_change"] < 0.0 == q["p_max_change"]


def test_no_equilibrium(monkeypatch):
    """mu p0 = 0.5 GPa is beyond 0.67/sqrt(3) GPa: it ends, says so and names the largest pressure that the
    film carries.
    """
    monkeypatch.setattr(loading, "MOST_CUTS", 0)
    result = spatial.solve(scene(0.05, cells=3, box=3.0, strength=0.67e9, friction=0.1, p0=5e9))
    assert result.status == "step-cut-limit"
    assert "no pressure beyond 3.868e+09 Pa" in result.message and "friction.coefficient" in result.message
    assert result.quantities["p_max_change"] is None


def test_what_is_refused():
    data = scene().model_dump()
    data["body"]["coating"]["poisson"] = 0.5
    with pytest.raises(spatial.UnsupportedScene, match=r"body\.coating\.poisson = 0\.5: .*poisson < 0\.5"):
        spatial.check(Scene(**data))
    assert "film elements" not in [entry.stage for entry in spatial.left_out(scene())]
