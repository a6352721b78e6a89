# SPDX-License-Identifier: MIT
"""The film of the three-dimensional model: against the axisymmetric one, far field, friction, yielding, what has no answer."""

from functools import cache

import numpy as np
import pytest

import fem_reference
from fem_reference import loading, spatial
from fem_reference.contact import Load
from fem_reference.elasticity import Film
from fem_reference.layered_force import slanted_pair
from fem_reference.point_force import slanted
from fem_reference.spatial.model import build
from sam.scene.result import QUANTITIES
from sam.scene.schema import Scene

YOUNG, NU, RADIUS, A = 210e9, 0.3, 105e-6, 3e-6
MODULUS = YOUNG / (1 - NU**2)


def scene(h=0.1, ratio=80 / 210, cells=4, box=4.0, strength=None, friction=None, **load):
    coating = {"thickness": h * A, "young": ratio * YOUNG, "poisson": NU, "yield_stress": strength}
    given = (
        {"prescribed": "hertz", "radius": A, **load} if load else {"force": 4 / 3 * MODULUS * A**3 / RADIUS}
    )
    return Scene(
        body={"young": YOUNG, "poisson": NU, "coating": coating},
        counterbody=None if load else {"shape": "sphere", "radius": RADIUS},
        loading=given,
        friction=friction and {"coefficient": friction},
        fem={"cells_per_radius": cells, "box": box},
    )


@cache
def solved():
    return spatial.solve(scene())


def test_against_the_axisymmetric_model():
    """Elements of a/4: changes of -7 and -8 % within 0.5 points, approach, pressure and stress within 1 and 2 %, film 5 %."""
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
    assert not np.isclose(z, 0.1 * A, rtol=1e-3).any() and (z < 0.1 * A).sum() == 2
    assert max(coarse.certificate.values()) < 1e-8


def test_far_field_under_friction():
    """What the film adds far away, in the model, is that of an infinite film when it is thick, and zero when it is none."""
    points = np.array([[10.0, 3.0, -7.0], [0.0, 8.0, 2.0], [0.0, 5.0, 10.0]])
    for forces in ((1.0, 0.0), (0.0, 1.0), (1.0, 0.3)):
        found = np.einsum("f,fcn->cn", forces, slanted_pair(Film(1e7, 0.4, 0.2), 1.0, NU, points))
        expected = slanted(forces, 0.4, 0.2, points) - slanted(forces, 1.0, NU, points)
        assert np.abs(found - expected).max() < 2e-5 * np.abs(expected).max()
    model, bare = (
        build(scene(0.5, cells=2, friction=0.2)),
        build(scene(0.5, cells=2, friction=0.2), film=False),
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
    """mu p below the shear strength: at yield and not beyond. Three elements in the radius: fast, and said by the status."""
    result = spatial.solve(scene(0.05, cells=3, box=3.0, strength=0.67e9, friction=0.1, p0=2.5e9))
    q = result.quantities
    assert result.status == "under-resolved"
    assert q["mises_max_film_Pa"] == pytest.approx(
        0.67e9, rel=5e-3
    )  # means of elements whose points are all at yield
    assert q["mises_max_film_Pa"] < 0.67e9 * (1 + 1e-9)
    assert 5e-3 < q["peeq_max"] < 5e-2
    assert result.certificate["yield_excess"] < 1e-9 and result.certificate["equilibrium"] < 1e-9
    assert -0.02 < q["mises_max_change"] < 0.0 == q["p_max_change"]


def test_no_equilibrium(monkeypatch):
    """mu p0 = 0.5 GPa is beyond 0.67/sqrt(3) GPa: it ends, says so and names the largest pressure that the film carries."""
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
