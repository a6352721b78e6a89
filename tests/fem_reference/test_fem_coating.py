# SPDX-License-Identifier: MIT
"""Coatings in the axisymmetric model: point force on a layered half-space, limits, record."""

import numpy as np
import pytest
from builders import MODULUS, RADIUS, SPHERE, scene as small_scene

import fem_reference
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.far_field import boussinesq, cerruti
from fem_reference.common.layered_force import normal, tangential
from fem_reference.common.refusals import advice_of
from sam.scene.result import COLUMNS, QUANTITIES, Status
from sam.scene.schema import Scene

YOUNG, NU, A = 210e9, 0.3, 6e-6


def scene(h=0.1, ratio=80 / 210, cells=4, box=10, *, flow=None, p0=None, bare=False, **tables):
    """A sphere, a coating of h contact radii; p0: Hertz pressure on the body alone; flow: yield stress."""
    a = A if p0 is None else np.pi * p0 * RADIUS / (2 * MODULUS)
    coating = {"thickness": h * a, "young": ratio * YOUNG, "poisson": NU, "yield_stress": flow}
    loading = {"force": 4 / 3 * MODULUS * a**3 / RADIUS} | tables.pop("loading", {})
    body = {"coating": None if bare else coating} | tables.pop("body", {})
    return small_scene(body=body, loading=loading, fem={"cells_per_radius": cells, "box": box}, **tables)


# --- the point force ---


def test_layered_point_force_far_away():
    """Limits: none, equal materials, infinitely thick (that half-space, to 2e-5 of the difference)."""
    r, z = np.array([10.0, 10.0, 10.0, 5.0, 0.0]), np.array([0.0, 1.0, 9.0, 10.0, 10.0])
    points, body = np.stack([r * np.cos(0.7), r * np.sin(0.7), z]), Elastic(1.0, NU)
    for young in (0.38, 100.0):
        thick, thin, stuff = Coating(1e7, young, 0.2), Coating(1e-9, young, 0.2), Elastic(young, 0.2)
        for added, coated, bare in (
            (normal(thick, body, r, z), boussinesq(1.0, stuff, r, z), boussinesq(1.0, body, r, z)),
            (tangential(thick, body, points), cerruti(1.0, stuff, points), cerruti(1.0, body, points)),
        ):
            assert np.abs(added - (coated - bare)).max() < 2e-5 * np.abs(coated - bare).max()
        assert np.abs(normal(thin, body, r, z)).max() < 1e-9
        assert np.abs(tangential(thin, body, points)).max() < 1e-9
    same = Coating(1.0, 1.0, NU)
    assert np.abs(normal(same, body, r, z)).max() < 1e-12
    assert np.abs(tangential(same, body, points)).max() < 1e-12


def test_layered_point_force_is_reciprocal():
    """Betti: on the surface u_r under a normal force is minus u_z there under a tangential one."""
    film, body, x = Coating(1.5, 0.4, 0.2), Elastic(1.0, NU), np.array([7.0, 10.0])
    zero = np.zeros_like(x)
    of_tangential = tangential(film, body, np.stack([x, zero, zero]))[2]
    assert normal(film, body, x, zero)[0] == pytest.approx(-of_tangential, rel=1e-9)


# --- contacts ---


def test_a_coating_of_the_body_changes_nothing():
    """To rounding on its own mesh."""
    q = fem_reference.solve(scene(0.1, 1.0)).quantities
    assert abs(q["p_max_change"]) < 1e-11 and abs(q["mises_max_change"]) < 1e-11
    bare = fem_reference.solve(scene(bare=True)).quantities
    assert bare["p_max_change"] is None and bare["mises_max_film_Pa"] is None


def test_record():
    """All names and columns, the largest von Mises stress of coating and body, what is left out."""
    result = fem_reference.solve(scene(0.5, cells=6, loading={"unload": True}))
    q = result.quantities
    assert tuple(q) == QUANTITIES
    assert all(tuple(table) == COLUMNS[name] for name, table in result.tables.items())
    assert q["mises_max_Pa"] == max(q["mises_max_film_Pa"], q["mises_max_substrate_Pa"])
    for of, name in (("p_max_Pa", "p_max"), ("mises_max_substrate_Pa", "mises_max")):
        assert q[f"{name}_change"] == pytest.approx(q[of] / q[f"{name}_bare_Pa"] - 1, abs=1e-15)
    assert result.discretisation["film_layers"] >= 2 and max(result.certificate.values()) < 1e-8
    stages = [entry.stage for entry in result.left_out]
    assert "film elements" not in stages and "return mapping and plastic history" in stages
    z, interface = result.tables["axis"]["z_m"], 0.5 * A
    first = int(np.searchsorted(z[: len(z) // 2], interface * (1 - 1e-12)))
    assert z[first] == pytest.approx(interface, rel=1e-12)  # the first row of the body
    plane = np.asarray(result.tables["plane"]["z_m"])
    assert not np.isclose(plane, interface, rtol=1e-6).any()  # Gauss points, none on the interface


def test_other_contacts():
    """An elastic counter-body, a punch, a given pressure, no force."""
    steel, punch, unloaded = (
        fem_reference.solve(scene(0.5, cells=8, **tables))
        for tables in (
            {"counterbody": SPHERE | {"young": YOUNG, "poisson": NU}},
            {"counterbody": {"shape": "punch", "radius": A}},
            {"loading": {"force": 0.0}},
        )
    )
    assert steel.converged and punch.converged and unloaded.converged
    assert unloaded.quantities["p_max_change"] is None and unloaded.quantities["mises_max_film_Pa"] == 0.0
    content = scene(0.5, cells=8).model_dump() | {"counterbody": None}
    q = fem_reference.solve(
        Scene(**content | {"loading": {"prescribed": "hertz", "p0": 1e9, "radius": A}})
    ).quantities
    assert q["p_max_change"] == 0.0 and q["mises_max_change"] < 0.0


def test_film_that_flows_away_is_not_converged():
    """A coating sheared by more than its length is no result, and the message names the pressure."""
    advice = advice_of(scene(flow=0.67e9, friction=0.1))
    assert advice.outcome(Status.CONVERGED, 0.05) == (Status.CONVERGED, "")
    status, message = advice.outcome(Status.CONVERGED, 11.0)
    assert status is Status.NOT_CONVERGED and "3.868e+09 Pa" in message and "yield_stress" in message
    status, message = advice.outcome(Status.STEP_CUT_LIMIT, 0.0)
    assert status is Status.STEP_CUT_LIMIT and message.startswith("a load step did not converge")
    assert "friction.coefficient" in message
    _, message = advice_of(scene(ratio=2.0)).outcome(Status.NOT_CONVERGED, 0.0)
    assert "too thin and stiff for the digits of a double" in message
