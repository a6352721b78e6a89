# SPDX-License-Identifier: MIT
"""Elastic-plastic contact of the finite-element model: elastic limit, history, convergence, correlations,
step cutting.
"""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from builders import scene as small_scene

import fem_reference
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.planner import Core, plan
from fem_reference.axisymmetric.problem import ContactProblem
from fem_reference.axisymmetric.recovery import stresses
from fem_reference.common import contact
from fem_reference.common.elasticity import deviator, mises
from fem_reference.common.loading import Step, climb, run
from sam.scene.result import COLUMNS, COST, QUANTITIES, Status

YOUNG, POISSON, RADIUS = 210e9, 0.3, 105e-6
MODULUS = YOUNG / (1 - POISSON**2)
LAWS = {
    "swift": {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121},
    "perfect": {"law": "perfect", "yield_stress": 1e9},
    "linear": {"law": "linear", "yield_stress": 1e9, "modulus": YOUNG / 20},
    "profile": {"law": "perfect", "yield_stress": 1e9, "profile": [[0.0, 1.3], [1e-6, 1.3], [4e-6, 1.0]]},
}
YIELD = {"swift": 945e6 * 20**0.121, "perfect": 1e9, "linear": 1e9, "profile": 1e9}


def hertz(law, ratio):
    """Force, contact radius, pressure of a sphere whose Hertz pressure is `ratio` times the yield stress."""
    p0 = ratio * YIELD[law]
    a = np.pi * p0 * RADIUS / (2 * MODULUS)
    return 2 / 3 * np.pi * a**2 * p0, a, p0


def scene(law="swift", ratio=4.0, cells=8, steps=10, length=1.0, stress=1.0, counter=None, **loading):
    return small_scene(
        length,
        stress,
        body={"young": YOUNG, "poisson": POISSON, "plasticity": law and LAWS[law]},
        counterbody={"radius": RADIUS, **(counter or {})},
        loading={"force": hertz(law or "swift", ratio)[0], "steps": steps, "unload": True, **loading},
        fem={"cells_per_radius": cells},
    )


@cache
def solved(law="swift", ratio=4.0, cells=8, steps=10):
    result = fem_reference.solve(scene(law, ratio, cells, steps))
    assert result.status is Status.CONVERGED
    return result


@cache
def loaded(law="swift", ratio=4.0, cells=8, steps=10) -> tuple[Model, list[Step]]:
    model = build(plan(scene(law, ratio, cells, steps, unload=False)))
    return model, run(model, model.plan.schedule)


def test_record_is_complete():
    result = solved()
    assert tuple(result.quantities) == QUANTITIES
    assert tuple(result.cost) == (*COST, "factorizations", "linear_iterations")
    for name, table in result.tables.items():
        assert tuple(table) == COLUMNS[name]
    h, q = result.tables["history"], result.quantities
    assert h["step"] == list(range(1, 12)) and h["peeq_max"][9] == q["peeq_max"] == h["peeq_max"][10]
    assert list(np.diff(h["peeq_max"]) >= 0) == [True] * 10
    assert h["note"] == [""] * 10 + ["elastic: unloading in one step"]
    assert result.tables["axis"]["peeq"].max() == pytest.approx(
        q["peeq_max"], rel=1e-2
    )  # parabola between points
    assert result.tables["plane"]["peeq"].max() <= q["peeq_max"]
    cells = result.fields.cell_data
    assert cells["peeq"].max() == pytest.approx(q["peeq_max"], rel=0.05)  # element means
    # monotone loading: accumulated strain is about the size of the plastic strain, whose trace is zero
    strain = cells["plastic_strain"]
    size = np.sqrt(2 / 3 * ((strain[:, :3] ** 2).sum(axis=1) + 2 * (strain[:, 3:] ** 2).sum(axis=1)))
    assert np.abs(strain[:, :3].sum(axis=1)).max() < 1e-15
    assert size.max() == pytest.approx(cells["peeq"].max(), rel=2e-2)
    assert max(result.certificate.values()) < 1e-8 and result.certificate["yield_excess"] < 1e-10
    assert 0 < q["residual_uz_center_m"] < q["approach_m"]
    assert 0 < q["residual_mises_max_Pa"] < q["mises_max_Pa"]


@pytest.mark.parametrize("law", ["swift", "perfect"])
def test_elastic_below_yield(law):
    """p0 = 1.5 Y: yield starts at 1.61 Y (Johnson 1985, Sec. 6.1); every number equals the elastic answer,
    bit by bit.
    """
    plastic = fem_reference.solve(scene(law, 1.5, steps=3))
    elastic = fem_reference.solve(scene(None, steps=3, force=hertz(law, 1.5)[0]))
    assert plastic.quantities == elastic.quantities | {"peeq_max": 0.0}
    for name, table in elastic.tables.items():
        for column, values in table.items():
            np.testing.assert_array_equal(plastic.tables[name][column], values, f"{name} {column}")


def test_onset_of_yield():
    """Nothing yields at 1.60 Y and something at 1.63 Y (0.62 p0 = Y at 1.613); Gauss points a/32 apart on the
    axis.
    """
    below, above = (loaded("perfect", ratio, 16, 1)[1][-1].state for ratio in (1.60, 1.63))
    assert not below.yielded
    assert above.yielded


@pytest.mark.parametrize("law, ratio", [("swift", 6.2), ("perfect", 3.0)])
def test_residuals_fall_quadratically_once_the_set_stands_still(law, ratio, monkeypatch):
    """Below 1e-3, where at most the rim of the plastic zone changes: r' < 40 r^2 up to rounding (observed:
    below 21).

    With linear solves that are exact: usually they end where their residual no longer matters.
    """
    monkeypatch.setattr(contact, "NEGLIGIBLE", 1e-4)
    pairs = []
    for step in loaded.__wrapped__(law, ratio)[1]:
        still = step.state.residuals[-step.state.steady :]
        pairs += [(a, b) for a, b in pairwise(still) if a < 1e-3]
    assert len(pairs) >= 10
    assert all(b < 40 * a**2 + 1e-12 for a, b in pairs)
    assert sum(b < 1e-3 * a for a, b in pairs) >= 10  # not merely slow from the start


def test_the_elastic_stiffness_as_tangent_is_not_quadratic(monkeypatch):
    """The test above sees a wrong tangent."""

    def elastic(self, _matrices):
        return self.blocks[0].solid.stiffness

    monkeypatch.setattr(ContactProblem, "tangent", elastic)
    monkeypatch.setattr(contact, "STALLED", 60)
    _, steps = loaded.__wrapped__("swift", 6.2, 4, 2)
    assert max(b / a**2 for a, b in pairwise(steps[0].state.residuals) if b > 1e-12) > 1e3


def test_history_is_committed_once():
    """Solving a step twice from the same state gives the same state: a discarded step leaves no trace."""
    model, steps = loaded()
    start = steps[-2].state
    before = start.history.peeq.copy()
    again = climb(model, [steps[-1].state.force], start)[0].state
    assert np.array_equal(start.history.peeq, before)
    assert np.array_equal(again.history.peeq, steps[-1].state.history.peeq)
    assert np.array_equal(again.u, steps[-1].state.u)


def test_yield_and_flow_rule_on_the_returned_state():
    """mises = Y(peeq) where the last step flowed, and the increment lies along the deviator; without the
    return map.
    """
    model, steps = loaded()
    old, new = (step.state for step in steps[-2:])
    stress = model.body.stress(model.problem.body(new.u, 0), new.history.plastic_strain)
    growth = new.history.peeq - old.history.peeq
    flowed = growth > 0
    material = model.problem.material
    strength = material.factor * material.curve.stress(new.history.peeq)
    q = mises(stress)
    assert np.abs(q[flowed] / strength[flowed] - 1).max() < 1e-12
    assert (q[~flowed] / strength[~flowed]).max() < 1 + 1e-10
    expected = growth * 1.5 * deviator(stress) / q * np.array([1, 1, 1, 2])[:, None, None]
    increment = new.history.plastic_strain - old.history.plastic_strain
    assert np.abs(increment - expected)[:, flowed].max() < 1e-12 * new.history.peeq.max()


def test_unloading_and_reloading_add_nothing():
    """Swift steel: elastic both ways. Largest plastic strain and pressure of the second peak equal the first
    (1e-8).
    """
    result = fem_reference.solve(scene(steps=5, cycles=2))
    assert result.status is Status.CONVERGED
    h = {name: np.array(values) for name, values in result.tables["history"].items()}
    peaks = [4, 10]
    assert h["peeq_max"][peaks[1]] == pytest.approx(h["peeq_max"][peaks[0]], rel=1e-8)
    assert h["p_max_Pa"][peaks[1]] == pytest.approx(h["p_max_Pa"][peaks[0]], rel=1e-8)
    assert h["approach_m"][peaks[1]] == pytest.approx(h["approach_m"][peaks[0]], rel=1e-8)
    assert result.tables["cycles"]["peeq_max"] == list(h["peeq_max"][peaks])
    assert h["approach_m"][5] == pytest.approx(result.quantities["residual_uz_center_m"], rel=1e-9)


def test_residual_stress_leaves_the_surface_free():
    """Unloaded: the normal stress, extrapolated to the axis at the uppermost Gauss points (a/75 deep), is
    almost gone.
    """
    result = solved("swift", 6.2, 16)
    t = result.tables["axis"]
    for state, bounds in (("peak", (0.6, 0.8)), ("unloaded", (0.0, 0.005))):
        szz = -t["szz_Pa"][t["state"] == state][0] / hertz("swift", 6.2)[2]
        assert bounds[0] <= abs(szz) < bounds[1]
    line = result.tables["line"]
    after = line["state"] == "unloaded"
    assert not line["p_Pa"][after].any()
    assert line["gap_m"][after].min() == pytest.approx(0.0, abs=1e-15)  # the counter-body just touches


def orders(values):
    """Observed orders of convergence of a sequence of halved steps, from successive differences."""
    differences = np.abs(np.diff(values))
    return np.log2(differences[:-1] / differences[1:])


def test_load_steps_converge_with_first_order():
    """Backward Euler in 5, 10, 20 and 40 steps: orders 0.9 and 0.75 of the largest plastic strain.

    The limit is 0.7 % from the value of ten steps.
    """
    values = [solved("swift", 6.2, 4, n).quantities["peeq_max"] for n in (5, 10, 20, 40)]
    assert orders(values)[-1] == pytest.approx(1.0, abs=0.35)
    assert values[1] == pytest.approx(2 * values[-1] - values[-2], rel=1e-2)


def test_mesh_converges():
    """Same schedule, a/4, a/8, a/16: differences fall. Observed at a/8 against a/16: -0.3 %, -0.04 %,
    -0.6 %.
    """
    results = [solved("swift", 6.2, n).quantities for n in (4, 8, 16)]
    for name, tolerance in (("peeq_max", 5e-3), ("p_center_Pa", 1e-3), ("residual_uz_center_m", 1e-2)):
        values = np.array([q[name] for q in results])
        assert abs(values[1] / values[2] - 1) < tolerance
        assert abs(values[1] - values[2]) < 0.6 * abs(values[0] - values[1])


def test_pressure_is_limited_and_flattened():
    """Perfect plasticity at 4 Y: mean pressure between 1.1 Y (onset) and 2.8 Y (Tabor), contact larger than
    Hertz's.
    """
    q, (force, a, p0) = solved("perfect", 4.0).quantities, hertz("perfect", 4.0)
    mean = force / q["contact_area_m2"]
    assert 1.1e9 < mean < 2.8e9
    assert q["contact_radius_m"] > 1.1 * a and q["p_center_Pa"] < 0.6 * p0
    # a flat profile: centre over mean is 1.5 for Hertz
    assert q["p_center_Pa"] < 1.25 * mean


def correlations(result):
    """Approach over the critical one, and force over Kogut & Etsion (2002) and Jackson & Green (2005), step
    by step.
    """
    h = result.tables["history"]
    approach, force = (np.array(h[name][:-1]) for name in ("approach_m", "force_N"))
    K, C, Y = 0.454 + 0.41 * POISSON, 1.295 * np.exp(0.736 * POISSON), 1e9
    critical = (np.pi * K * 2.8 * Y / (2 * MODULUS)) ** 2 * RADIUS
    w = approach / critical
    load = 2 / 3 * np.pi * K * 2.8 * Y * critical * RADIUS
    ke = force / load / np.where(w < 6, 1.03 * w**1.425, 1.40 * w**1.263)
    critical = (np.pi * C * Y / (2 * MODULUS)) ** 2 * RADIUS
    v = approach / critical
    load = 4 / 3 * (RADIUS / MODULUS) ** 2 * (np.pi * C * Y / 2) ** 3
    radius = np.pi * C * Y / (2 * MODULUS) * np.sqrt(v * (v / 1.9) ** (0.14 * np.exp(23 * Y / MODULUS)))
    hardness = 2.84 * (1 - np.exp(-0.82 * radius**-0.7))
    jg = np.exp(-(v ** (5 / 12)) / 4) * v**1.5 + 4 * hardness / C * (1 - np.exp(-(v ** (5 / 9)) / 25)) * v
    return w, ke, force / load / jg


def test_correlations_of_a_sphere():
    """Perfect plasticity, 2 to 20 critical approaches.

    The formulas differ from each other by 3 % and are for the flattening of a sphere, not the indentation of
    a half-space: within 5 % (observed: -5 to +1 %).
    """
    w, ke, jg = correlations(fem_reference.solve(scene("perfect", 6.0, steps=12)))
    valid = (w > 2) & (w < 20)
    assert valid.sum() >= 6
    assert np.abs(ke[valid] - 1).max() < 0.055 and np.abs(jg[valid] - 1).max() < 0.055


def test_plastic_zone_at_the_edge_is_a_status():
    """A box of two radii: the plastic zone of perfect plasticity at 6 Y reaches its outermost elements."""
    s = scene("perfect", 6.0, cells=4)
    s = s.model_copy(update={"fem": s.fem.model_copy(update={"box": 2.6})})
    result = fem_reference.solve(s)
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "fem.box" in result.message


def test_contact_beyond_the_fine_mesh_is_a_status(monkeypatch):
    monkeypatch.setattr("fem_reference.axisymmetric.planner.plastic_core", lambda radius: Core(1.1, 0.8))
    assert fem_reference.solve(scene("perfect", 4.0)).status is Status.CONTACT_AT_GRID_EDGE


@pytest.mark.parametrize("law", ["swift", "linear"])
def test_unit_system_changes_nothing(law):
    """Lengths in um or stresses in other units: same iterations, every quantity equal to 1e-9 (residual
    1e-9).
    """
    base, other = (
        solved(law, 4.0, 4, 4),
        fem_reference.solve(scene(law, 4.0, 4, 4, length=3.7e3, stress=7.3e-9)),
    )
    assert other.cost["newton_iterations"] == base.cost["newton_iterations"]
    for name, ending in (
        ("p_max_Pa", 7.3e-9),
        ("residual_mises_max_Pa", 7.3e-9),
        ("approach_m", 3.7e3),
        ("peeq_max", 1),
    ):
        assert other.quantities[name] / ending == pytest.approx(base.quantities[name], rel=1e-9), name


def test_depth_profile_strengthens_the_surface():
    """Factor 1.3 down to 1 um: less plastic strain than without, and yield at the local strength."""
    model, steps = loaded("profile", 4.0)
    depth = model.body.points[1] * model.scales.length
    factor = model.problem.material.factor
    assert factor[depth < 1e-6] == pytest.approx(1.3) and factor[depth > 4e-6] == pytest.approx(1.0)
    assert factor == pytest.approx(np.interp(depth, [1e-6, 4e-6], [1.3, 1.0]))
    plain = loaded("perfect", 4.0)[1][-1].state
    assert steps[-1].state.history.peeq.max() < plain.history.peeq.max()


def test_the_largest_strain_at_the_face_of_a_layer_is_not_overshot(monkeypatch):
    """Below a layer of three times the yield stress: the largest value of the points, no parabola through the
    kink there.
    """
    a = hertz("swift", 4.0)[1]
    monkeypatch.setitem(LAWS, "swift", LAWS["swift"] | {"profile": [[0.5 * a, 3.0], [0.55 * a, 1.0]]})
    result = fem_reference.solve(scene("swift", unload=False))
    largest = max(result.tables[name]["peeq"].max() for name in ("axis", "plane"))
    assert 0 < result.quantities["peeq_max"] == pytest.approx(largest, rel=1e-3)


def test_the_mesh_has_a_line_where_the_yield_stress_has_a_kink(monkeypatch):
    """A weak layer 0.32 radii thick strains 14 % more than one of 0.28, though both end in one row of
    elements 1/8 high.

    By their Gauss points alone the two are the same; with lines at their faces the ratio is that of finer
    meshes.
    """
    a, found, bulk = hertz("swift", 4.0)[1], [], LAWS["swift"] | {"B": 9450e6}
    for thickness in (0.28, 0.32):
        monkeypatch.setitem(
            LAWS, "swift", bulk | {"profile": [[thickness * a, 0.1], [1.5 * thickness * a, 1.0]]}
        )
        result = fem_reference.solve(scene("swift", unload=False))
        faces = np.unique(result.fields.points[:, 2]) / a
        assert np.abs(faces - thickness).min() < 1e-9 > np.abs(faces - 1.5 * thickness).min()
        found.append(result.quantities["peeq_max"])
    assert found[1] / found[0] == pytest.approx(1.14, abs=0.04)  # 24 elements in the radius: 1.139


def test_elastic_counter_body():
    """Steel sphere: the body takes half the approach and yields less than under a rigid one at the same
    force.
    """
    counter = {"young": YOUNG, "poisson": POISSON}
    result, rigid = fem_reference.solve(scene("swift", 6.2, steps=5, counter=counter)), solved("swift", 6.2)
    assert result.status is Status.CONVERGED and max(result.certificate.values()) < 1e-8
    assert 0 < result.quantities["peeq_max"] < 0.7 * rigid.quantities["peeq_max"]
    assert result.quantities["approach_m"] > 1.2 * rigid.quantities["approach_m"]


def test_mean_stress_is_smooth_in_the_plastic_zone():
    """Perfect plasticity at 4 Y shows no checkerboard.

    On the Gauss points next to the axis, two in each element, the mean stress in the plastic zone stays
    within 2 % of Y of a smooth curve, with no sign that alternates from point to point.
    """
    model, steps = loaded("perfect", 4.0)
    s = stresses(model, steps[-1].state)
    column = np.isclose(s.r, s.r.min(), rtol=1e-6) & (s.peeq > 1e-3)
    order = np.argsort(s.z[column])
    z, mean = s.z[column][order], s.gauss[:3].mean(axis=0)[column][order]
    rest = mean - np.polynomial.Polynomial.fit(z, mean, 5)(z)
    assert z.size > 12
    assert np.abs(rest).max() < 0.02 * 1e9 and abs(np.mean(rest * (-1.0) ** np.arange(z.size))) < 0.003 * 1e9


def test_zero_force_and_left_out():
    result = fem_reference.solve(scene(steps=2, force=0.0))
    assert result.status is Status.CONVERGED and result.quantities["peeq_max"] == 0.0
    stages = [item.stage for item in fem_reference.left_out(scene(cycles=2))]
    assert not {"return mapping and plastic history", "unloading steps", "cycles after the first"} & set(
        stages
    )
