# SPDX-License-Identifier: MIT
"""The film of the axisymmetric model: point force on a layered half-space, coated spheres, yielding films,
record, resume.
"""

from functools import cache

import numpy as np
import pytest
from builders import SPHERE, SWIFT as STEEL, scene as small_scene

import fem_reference
import fem_reference.spatial
from fem_reference.axisymmetric import planner
from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common import layered_force
from fem_reference.common.bodies import Coating, Elastic, expected_radius
from fem_reference.common.far_field import boussinesq, cerruti
from fem_reference.common.layered_force import amplitudes, normal, tangential
from fem_reference.common.loading import run
from fem_reference.common.mesh_lines import Sizes, coated_depths
from fem_reference.common.plasticity import J2, History, Parts
from fem_reference.common.refusals import advice_of
from sam.scene.result import COLUMNS, QUANTITIES, Status
from sam.scene.schema import Scene
from sam.scene.yield_curve import Linear, Swift

YOUNG, NU, RADIUS, A = 210e9, 0.3, 105e-6, 6e-6
MODULUS = YOUNG / (1 - NU**2)


def scene(h=0.1, ratio=80 / 210, cells=16, box=10, *, flow=(None, None), p0=None, counter=SPHERE, **loading):
    """A sphere, the film h contact radii thick; p0: Hertz pressure on the body alone.

    flow: yield stress of the film, and plasticity of the body.
    """
    a = A if p0 is None else np.pi * p0 * RADIUS / (2 * MODULUS)
    coating = {"thickness": h * a, "young": ratio * YOUNG, "poisson": NU, "yield_stress": flow[0]}
    return small_scene(
        body={"coating": coating, "plasticity": flow[1]},
        counterbody=counter,
        loading={"force": 4 / 3 * MODULUS * a**3 / RADIUS, **loading},
        fem={"cells_per_radius": cells, "box": box},
    )


@cache
def coated(h, ratio, cells=16, box=10.0):
    """(p(0)/p0, a/a0, approach/(a0^2/R)) of the coated contact alone."""
    m = build(plan(scene(h, ratio, cells, box)))
    state = run(m, m.plan.schedule)[-1].state
    assert state.converged
    return m.nodal_pressure(state)[0] * np.pi / 2, m.contact_radius(state), state.approach


# p(0)/p0, a/a0, approach over that on the body alone: Hankel-spectral solution of a rigid paraboloid,
# residual 1e-9, as O'Sullivan and King, J. Tribol. 110 (1988) 235, pose it; digits as given
SPECTRAL = {
    (80 / 210, 0.1): (0.92655, 1.07866, 1.04509),
    (80 / 210, 0.5): (0.73740, 1.21664, 1.19339),
    (80 / 210, 1.0): (0.61839, 1.29633, 1.33858),
    (80 / 210, 2.0): (0.54862, 1.35393, 1.52584),
    (2.0, 0.1): (1.03223, 0.95975, 0.98090),
    (2.0, 0.5): (1.22803, 0.86969, 0.91020),
    (2.0, 1.0): (1.47544, 0.81848, 0.82687),
    (2.0, 2.0): (1.56845, 0.79822, 0.74256),
}


@pytest.mark.parametrize("ratio, h", SPECTRAL)
def test_coated_sphere(ratio, h):
    """Pressure within 1e-3 (the bare contact has 5e-4 on this mesh), approach 5e-4, radius 2e-3 (of the fit
    to the gap).
    """
    pressure, radius, approach = coated(h, ratio)
    expected = SPECTRAL[ratio, h]
    assert pressure == pytest.approx(expected[0], rel=1e-3)
    assert radius == pytest.approx(expected[1], rel=2e-3)
    assert approach == pytest.approx(expected[2], rel=5e-4)


def test_mesh_refinement():
    """Error of p(0) against the spectral solution: halving the elements leaves less than half (observed order
    1.5 to 2).
    """
    errors = [abs(coated(0.5, 80 / 210, cells)[0] / 0.73740 - 1) for cells in (4, 8, 16)]
    assert errors[0] > 2 * errors[1] > 4 * errors[2] and errors[2] < 6e-4


def test_outer_boundary(monkeypatch):
    """A box of 10 against one of 24, film 2 radii thick: pressure to 1e-5, approach to 1.2e-4, as without a
    film (the contact is not a point). With the far field of the body alone the approach is off by 8e-4.
    """
    small, large = coated(2.0, 80 / 210, 8, 10.0), coated(2.0, 80 / 210, 8, 24.0)
    assert small[0] == pytest.approx(large[0], rel=2e-5) and small[2] == pytest.approx(large[2], rel=2e-4)
    monkeypatch.setattr(layered_force, "normal", lambda coating, body, r, z: np.zeros((2, r.size)))
    assert abs(coated.__wrapped__(2.0, 80 / 210, 8, 10.0)[2] / large[2] - 1) > 5e-4


@pytest.mark.parametrize("h, expected", [(0.01, 0.991), (0.05, 0.960), (0.2, 0.868)])
def test_largest_pressure(h, expected):
    """Coated over bare, E1/E2 = 80/210, another finite-element code to three digits."""
    change = fem_reference.solve(scene(h, cells=12)).quantities["p_max_change"]
    assert 1 + change == pytest.approx(expected, abs=1.2e-3)


def test_equal_materials_are_bare():
    """A film of the body's material changes nothing: to rounding on its own mesh, to 1e-3 against the mesh of
    the bare scene.
    """
    s = scene(0.1, 1.0)
    q = fem_reference.solve(s).quantities
    assert abs(q["p_max_change"]) < 1e-11 and abs(q["mises_max_change"]) < 1e-11
    data = s.model_dump()
    data["body"]["coating"] = None
    bare = fem_reference.solve(Scene(**data)).quantities
    for name in (
        "approach_m",
        "contact_radius_m",
        "p_max_Pa",
        "p_center_Pa",
        "mises_max_Pa",
        "mises_max_depth_m",
    ):
        assert q[name] == pytest.approx(bare[name], rel=2e-3 if "depth" in name else 1e-3), name
    assert bare["p_max_change"] is None and bare["mises_max_film_Pa"] is None


def compliance(k, film, young, poisson):
    """W(k, 0) under unit szz = -1: closed form of the layered half-space (Burmister 1945, in reflected
    waves).
    """
    mu1, mu2 = film.young / 2 / (1 + film.poisson), young / 2 / (1 + poisson)
    r, k1, k2, kh = mu1 / mu2, 3 - 4 * film.poisson, 3 - 4 * poisson, k * film.thickness
    th, fade = np.exp(-2 * kh), -np.expm1(-2 * kh)
    d1, d2 = 1 + r * k2, r + k1
    lam, kap = (r * k2 - k1) / d1, (r - 1) / d2
    top = r * (1 + k1) * (1 + k2) / (d1 * d2) + lam * kap * (1 - th**2) + 4 * kh * kap * th
    bottom = ((1 + k1) / d1 + lam * fade) * ((1 + k1) / d2 + kap * fade) - 4 * kap * kh**2 * th
    return (1 - film.poisson) / (mu1 * k) * top / bottom


@pytest.mark.parametrize("ratio", [1e-3, 80 / 210, 1e3])
@pytest.mark.parametrize("nu", [(0.3, 0.3), (0.45, 0.0)])
def test_layered_waves(ratio, nu):
    """Normal compliance against the closed form from k h = 1e-6 to 1e3; what is left is rounding."""
    film, k = Coating(2.0, ratio, nu[0]), np.logspace(-6, 3, 40) / 2.0
    change = amplitudes(film, Elastic(1.0, nu[1]), k, np.zeros(1), load=(-1.0, 0.0))[1, :, 0]
    found = change + 2 * (1 - nu[1] ** 2) / k
    assert found == pytest.approx(compliance(k, film, 1.0, nu[1]), rel=1e-9)


def test_layered_point_force_far_away():
    """Limits: no film, equal materials, infinitely thick film (that half-space instead, to 2e-5 of the
    difference).
    """
    r, z = np.array([10.0, 10.0, 10.0, 5.0, 0.0]), np.array([0.0, 1.0, 9.0, 10.0, 10.0])
    points, body = np.stack([r * np.cos(0.7), r * np.sin(0.7), z]), Elastic(1.0, NU)
    for young in (0.38, 100.0):
        thick, thin, stuff = Coating(1e7, young, 0.2), Coating(1e-9, young, 0.2), Elastic(young, 0.2)
        for found, with_film, without in (
            (normal(thick, body, r, z), boussinesq(1.0, stuff, r, z), boussinesq(1.0, body, r, z)),
            (tangential(thick, body, points), cerruti(1.0, stuff, points), cerruti(1.0, body, points)),
        ):
            expected = with_film - without
            assert np.abs(found - expected).max() < 2e-5 * np.abs(expected).max()
        assert np.abs(normal(thin, body, r, z)).max() < 1e-9
        assert np.abs(tangential(thin, body, points)).max() < 1e-9
    same = Coating(1.0, 1.0, NU)
    assert np.abs(normal(same, body, r, z)).max() < 1e-12
    assert np.abs(tangential(same, body, points)).max() < 1e-12


def test_layered_point_force_is_reciprocal():
    """Betti: on the surface u_r at a distance under a normal force is minus u_z there under a
    tangential one.
    """
    film, x = Coating(1.5, 0.4, 0.2), np.array([7.0, 10.0])
    zero = np.zeros_like(x)
    assert normal(film, Elastic(1.0, NU), x, zero)[0] == pytest.approx(
        -tangential(film, Elastic(1.0, NU), np.stack([x, zero, zero]))[2], rel=1e-9
    )


def test_depths():
    """Two elements or more in the film, one line at the interface, neighbours that differ by no more than the
    growth allows.
    """
    for h in (1e-3, 0.05, 0.3, 3.0):
        z = coated_depths(h, 10.0, Sizes(1 / 16, 1 / 16, (0.8, 0.8)))
        assert np.abs(z - h).min() < 1e-12 and z[-1] == pytest.approx(10.0)
        steps = np.diff(z)
        assert np.count_nonzero(z < h * (1 - 1e-9)) >= 2
        assert (steps[1:] / steps[:-1]).max() < 1.6 and (steps[1:] / steps[:-1]).min() > 0.6
        # the last ones may have been beyond before the scaling to the box
        assert steps[z[1:] < 0.8].max() <= 1.25 / 16


def test_the_interface_is_a_line_to_the_last_digit():
    """Of any thickness: layers of elements are counted down to it."""
    for h in np.random.default_rng(0).uniform(0.01, 1.0, 200):
        z = coated_depths(h, 10.0, Sizes(1 / 8, 1 / 8, (0.8, 0.8)))
        assert z[np.searchsorted(z, h)] == h and z[-1] == 10.0


@pytest.mark.parametrize("ratio, h", SPECTRAL)
def test_estimate_of_the_radius(ratio, h):
    """The mesh is sized by it: within 7 %."""
    assert expected_radius(scene(h, ratio)) == pytest.approx(SPECTRAL[ratio, h][1], rel=0.07)


def test_parts_are_their_materials():
    """The return map of two materials, element by element, is that of each; what never yields keeps Hooke's
    law.
    """
    rng = np.random.default_rng(5)
    strain = rng.normal(size=(4, 6, 4))
    inside = np.array([True, False, True, False, False, True])
    ones = np.ones((3, 4))
    laws = [
        (inside, J2(Elastic(0.4, 0.2), Linear(0.3), ones)),
        (~inside, J2(Elastic(1.0, NU), Swift(0.1, 1.0, 0.2, 10.0), ones)),
    ]
    both = Parts(laws)
    start = History(0.1 * rng.normal(size=(4, 6, 4)), np.abs(rng.normal(size=(6, 4))))
    found = both.update(strain, start)
    assert both.shape == (6, 4)
    for elements, law in laws:
        alone = law.update(
            strain[:, elements], History(start.plastic_strain[:, elements], start.peeq[elements])
        )
        assert np.array_equal(found.stress[:, elements], alone.stress)
        assert np.array_equal(found.history.peeq[elements], alone.history.peeq)
        numbers = np.flatnonzero(elements)[alone.elements]
        assert np.array_equal(found.loss[np.isin(found.elements, numbers)], alone.loss)
    assert both.excess(found.stress, found.history).max() < 1e-12
    never = Parts([(inside, J2(Elastic(0.4, 0.2), Linear(np.inf), ones)), laws[1]])
    hooke = np.einsum("st,teq->seq", never.parts[0][1].stiffness, (strain - start.plastic_strain)[:, inside])
    assert np.array_equal(never.update(strain, start).stress[:, inside], hooke)
    still = never.update(np.zeros_like(strain), History.virgin((6, 4)))
    assert not still.elements.size and not still.history.yielded


def test_interface_on_the_axis():
    """In-plane strain and szz pass the interface: Hooke's law of each side, film a point above it, body at
    it.

    Over the distance of 0.013 a the gradient changes them by 4e-4 and 4e-3 p0; the moduli of the other side
    would be seen.
    """
    table, h = fem_reference.solve(scene(0.3)).tables["axis"], 0.3 * A
    z = table["z_m"]
    assert np.all(np.diff(z) > 0)
    below = int(np.searchsorted(z, h * (1 - 1e-12)))
    assert z[below] == pytest.approx(h, rel=1e-12)  # the first row of the body is at the interface
    p0 = 2 / np.pi * MODULUS * A / RADIUS
    sides = []
    for row, young in ((below - 1, 80e9), (below, YOUNG)):
        rr, zz = table["sxx_Pa"][row], table["szz_Pa"][row]
        sides.append((zz / p0, ((1 - NU) * rr - NU * zz) / young * YOUNG / p0))
    assert sides[0][0] == pytest.approx(sides[1][0], abs=5e-3)
    assert sides[0][1] == pytest.approx(sides[1][1], abs=1e-3)
    assert abs(sides[0][1] * 80 / 210 - sides[1][1]) > 1e-2


def test_record():
    """All names and columns, the film's and the body's largest von Mises stress, what is left out."""
    result = fem_reference.solve(scene(0.5, cells=6, unload=True))
    q = result.quantities
    assert tuple(q) == QUANTITIES
    assert all(tuple(table) == COLUMNS[name] for name, table in result.tables.items())
    assert q == q | {
        "mises_max_Pa": max(q["mises_max_film_Pa"], q["mises_max_substrate_Pa"]),
        "p_max_change": pytest.approx(q["p_max_Pa"] / q["p_max_bare_Pa"] - 1, abs=1e-15),
        "mises_max_change": pytest.approx(
            q["mises_max_substrate_Pa"] / q["mises_max_bare_Pa"] - 1, abs=1e-15
        ),
    }
    assert result.discretisation["film_layers"] >= 2 and max(result.certificate.values()) < 1e-8
    stages = [entry.stage for entry in result.left_out]
    assert "film elements" not in stages and "return mapping and plastic history" in stages
    plane = result.tables["plane"]
    assert not np.isclose(
        np.asarray(plane["z_m"]), 0.5 * A, rtol=1e-6
    ).any()  # Gauss points, none on the interface


@cache
def yielding(p0=5e9, h=0.0284, cells=12, steps=5, plastic=False):
    result = fem_reference.solve(
        scene(h, cells=cells, flow=(0.67e9, STEEL if plastic else None), p0=p0, steps=steps)
    )
    assert result.converged and result.message == ""
    return result


def test_film_that_yields():
    """Centre of a thin confined film under p on an elastic body: the plastic strain in closed form.

    In-plane strain of the body e = -((1 + 2 nu)/2 (1 - nu) - nu) p/E (Johnson 1985, Eq. 3.45, and Hooke),
    bonded film, szz = -p: trial von Mises stress q = p (1 - nu_f/(1 - nu_f)) + e E_f/(1 - nu_f), and plastic
    flow along z in confinement takes |e_p_zz| = (q - Y) 2 (1 - nu_f)/E_f. It is the limit of a thin film: 0.6
    % off for h/a = 0.004, 5 % for 0.028.
    """
    result = yielding(h=0.004)
    q, film = result.quantities, 80e9
    p = q["p_center_Pa"]
    strain = -((1 + 2 * NU) / 2 * (1 - NU) - NU) * p / YOUNG
    expected = ((p * (1 - NU / (1 - NU)) + strain * film / (1 - NU)) - 0.67e9) * 2 * (1 - NU) / film
    inside = np.asarray(result.tables["axis"]["z_m"]) < result.discretisation["film_thickness_m"] * (1 - 1e-9)
    assert np.mean(result.tables["axis"]["peeq"][inside]) == pytest.approx(expected, rel=0.01)
    assert q["mises_max_film_Pa"] == pytest.approx(0.67e9, rel=1e-9)
    assert result.certificate["yield_excess"] < 1e-10
    elastic = fem_reference.solve(scene(0.004, cells=12, p0=5e9)).quantities
    assert q["p_max_change"] < elastic["p_max_change"] < 0  # the flowing film gives way more
    assert elastic["mises_max_film_Pa"] > 3 * 0.67e9


def test_film_and_body_yield():
    """Both yield; the bare contact for comparison yields as well, and is that of the uncoated scene to the
    mesh: 5e-3.
    """
    result = yielding(cells=8, steps=4, plastic=True)
    q = result.quantities
    assert -0.05 < q["p_max_change"] < 0
    s = scene(0.0284, cells=8, flow=(None, STEEL), p0=5e9, steps=4).model_dump()
    s["body"]["coating"] = None
    bare = fem_reference.solve(Scene(**s)).quantities
    assert q["p_max_bare_Pa"] == pytest.approx(bare["p_max_Pa"], rel=5e-3)
    assert q["mises_max_bare_Pa"] == pytest.approx(bare["mises_max_Pa"], rel=5e-3)
    z, peeq = (np.asarray(result.tables["axis"][name]) for name in ("z_m", "peeq"))
    film = z < result.discretisation["film_thickness_m"] * (1 - 1e-9)
    assert peeq[film].min() > 2 * peeq[~film].max() > 0


def test_resumed_equals_uninterrupted():
    """From every checkpoint, of the coated contact and of the bare one that follows: the same numbers to the
    last bit.
    """
    s = scene(0.05, cells=4, flow=(0.67e9, STEEL), p0=5e9, steps=2, unload=True)
    kept, seen = [], []
    whole = fem_reference.solve(s, progress=lambda *step: seen.append(step), checkpoint=kept.append)
    assert seen == [("contact", k, 4) for k in range(1, 5)]
    assert [c.done for c in kept] == [
        1,
        2,
        3,
        4,
        5,
        6,
    ]  # the film flows back in unloading: two steps of it, not one
    assert kept[-1].total == 6
    for start in kept:
        again = fem_reference.solve(s, start=start)
        assert again.quantities == whole.quantities
        assert again.cost["newton_iterations"] == whole.cost["newton_iterations"]
        for name, table in whole.tables.items():
            for column, values in table.items():
                np.testing.assert_array_equal(again.tables[name][column], values)


def test_other_contacts():
    """Elastic counter-body: the film matters less (half the compliance is elsewhere). Punch and given
    pressure have a result.
    """
    rigid = fem_reference.solve(scene(0.1, cells=8)).quantities["p_max_change"]
    steel = fem_reference.solve(
        scene(0.1, cells=8, counter=SPHERE | {"young": YOUNG, "poisson": NU})
    ).quantities["p_max_change"]
    assert 0.4 * rigid > steel > 0.65 * rigid
    punch = fem_reference.solve(scene(0.5, cells=8, counter={"shape": "punch", "radius": A}))
    assert punch.converged and 1.0 < punch.quantities["approach_m"] / (
        punch.quantities["force_N"] / (2 * MODULUS * A)
    )  # softer than the body alone
    given = scene(0.5, cells=8).model_dump() | {
        "counterbody": None,
        "loading": {"prescribed": "hertz", "p0": 1e9, "radius": A},
    }
    q = fem_reference.solve(Scene(**given)).quantities
    assert q["p_max_change"] == 0.0 and q["mises_max_change"] < -0.02


def test_no_force():
    """No load: converged, and no relative change."""
    result = fem_reference.solve(Scene(**scene(0.1, cells=4).model_dump() | {"loading": {"force": 0.0}}))
    assert result.converged
    assert result.quantities["p_max_change"] is None and result.quantities["mises_max_film_Pa"] == 0.0


def test_what_is_refused():
    """Key, value, what is allowed; all at once."""
    wet = scene().model_dump()
    wet["body"]["coating"]["poisson"] = 0.5
    wet["body"]["coating"]["thickness"] = 10 * A
    with pytest.raises(
        fem_reference.UnsupportedScene, match=r"coating\.poisson = 0\.5: .*coating\.thickness = 6e-05: from"
    ):
        fem_reference.check(Scene(**wet))
    with pytest.raises(
        fem_reference.UnsupportedScene, match=r"fem\.box = 4\.0: more than .* this coated contact"
    ):
        fem_reference.check(scene(1.0, 1e-3, box=4.0))
    for package in (fem_reference, fem_reference.spatial):  # a million layers of elements otherwise
        with pytest.raises(
            package.UnsupportedScene,
            match=r"coating\.young = 2\.1e\+24: less: the contact would have .* 0\.01",
        ):
            package.check(scene(1.0, 1e13))


def test_film_that_flows_away_is_not_converged():
    """A converged iteration whose film is sheared by more than its length is no result; the message names the
    pressure.
    """
    s = Scene(**scene(flow=(0.67e9, None)).model_dump() | {"friction": {"coefficient": 0.1}})
    assert advice_of(s).outcome(Status.CONVERGED, 0.05) == (Status.CONVERGED, "")
    status, message = advice_of(s).outcome(Status.CONVERGED, 11.0)
    assert status is Status.NOT_CONVERGED and "3.868e+09 Pa" in message and "yield_stress" in message
    status, message = advice_of(s).outcome(Status.STEP_CUT_LIMIT, 0.0)
    assert (
        status is Status.STEP_CUT_LIMIT
        and message.startswith("a load step did not converge")
        and "friction.coefficient" in message
    )


def test_no_film_no_layered_force(monkeypatch):
    """An uncoated scene computes nothing of a film."""

    def unwanted(*_args):
        raise AssertionError

    for module, name in ((layered_force, "normal"), (planner, "coated_lines"), (planner, "coated_core")):
        monkeypatch.setattr(module, name, unwanted)
    data = scene(cells=4).model_dump()
    data["body"]["coating"] = None
    assert fem_reference.solve(Scene(**data)).converged
    with pytest.raises(AssertionError):
        fem_reference.solve(scene(cells=4))
