# SPDX-License-Identifier: MIT
"""The finite-element model through its public entry point, against the closed forms of Hertz and of the flat
punch.

Tolerances are the targets of the model (approach 5e-4, von Mises 0.5 %, pressure 1 % in L2), or the reason
stands there.
"""

from functools import cache

import numpy as np
import pytest
from builders import scene as small_scene
from rounding import close
from scipy.integrate import trapezoid
from scipy.optimize import minimize_scalar

import fem_reference
from fem_reference.axisymmetric.problem import ContactProblem
from fem_reference.common import elasticity
from fem_reference.common.hertz import force_of_approach
from sam.scene.result import Status

FORCE, RADIUS, STEEL = 0.65, 105e-6, 210e9
PERFECT_100 = {"law": "perfect", "yield_stress": 1e8}
COUNTERS = {
    "rigid": {},
    "steel": {"young": STEEL, "poisson": 0.3},
    "aluminium": {"young": 70e9, "poisson": 0.2},
}


def scene(
    cells=16, counter="rigid", box=10.0, poisson=0.3, shape="sphere", length=1.0, stress=1.0, **loading
):
    """The test scene with every length and stress multiplied by a factor."""
    return small_scene(
        length,
        stress,
        body={"poisson": poisson},
        counterbody={"shape": shape, "radius": RADIUS, **COUNTERS[counter]},
        loading=loading,
        fem={"cells_per_radius": cells, "box": float(box)},
    )


@cache
def solved(cells=16, counter="rigid", box=10.0, poisson=0.3, shape="sphere"):
    return fem_reference.solve(scene(cells, counter, box, poisson, shape))


def modulus(counter="rigid", poisson=0.3):
    compliance = (1 - poisson**2) / STEEL
    if COUNTERS[counter]:
        compliance += (1 - COUNTERS[counter]["poisson"] ** 2) / COUNTERS[counter]["young"]
    return 1.0 / compliance


def hertz(counter="rigid", poisson=0.3):
    """(a, p0, approach) of a sphere on a half-space."""
    a = (3 * FORCE * RADIUS / (4 * modulus(counter, poisson))) ** (1 / 3)
    return a, 3 * FORCE / (2 * np.pi * a**2), a**2 / RADIUS


def hertz_axis(z, poisson=0.3):
    """(s_rr, s_zz)/p0 at the depth z/a on the axis (Johnson, Contact Mechanics, 1985, Eq. 3.45)."""
    return -(1 + poisson) * (1 - z * np.arctan2(1.0, z)) + 0.5 / (1 + z**2), -1 / (1 + z**2)


def hertz_mises(poisson=0.3):
    """Largest von Mises stress over p0 on the axis, and its depth over a."""

    def negative(z):
        srr, szz = hertz_axis(z, poisson)
        return -abs(srr - szz)

    best = minimize_scalar(negative, bounds=(0.2, 0.9), method="bounded", options={"xatol": 1e-10})
    return -best.fun, best.x


def pressure_error(result, a, p0):
    """Relative L2 error of the pressure over the contact, weighted by 2 pi r."""
    r, p = result.tables["line"]["x_m"], result.tables["line"]["p_Pa"]
    inside = r <= a * (1 + 1e-9)
    r, p = r[inside], p[inside]
    exact = p0 * np.sqrt(np.clip(1 - (r / a) ** 2, 0.0, None))
    return float(np.sqrt(trapezoid((p - exact) ** 2 * r, r) / trapezoid(exact**2 * r, r)))


def approach_error(result, counter="rigid", poisson=0.3):
    return result.quantities["approach_m"] / hertz(counter, poisson)[2] - 1


def mises_error(result, counter="rigid", poisson=0.3):
    return result.quantities["mises_max_Pa"] / (hertz_mises(poisson)[0] * hertz(counter, poisson)[1]) - 1


def test_closed_form_of_the_tests():
    """0.6200 p0 at 0.481 a for nu = 0.3 (Johnson 1985, Sec. 4.2, to the digits quoted there and in the
    targets).
    """
    largest, depth = hertz_mises()
    assert largest == pytest.approx(0.6200, abs=5e-5)
    assert depth == pytest.approx(0.481, abs=5e-4)


@pytest.mark.parametrize("counter", COUNTERS)
def test_hertz_targets(counter):
    """At a/32. Observed: approach 1.1e-4, von Mises -2e-5, pressure L2 4.4e-3, centre -1.1e-4, radius
    7e-5.
    """
    result = solved(32, counter)
    a, p0, _ = hertz(counter)
    q = result.quantities
    assert result.status is Status.CONVERGED
    assert abs(approach_error(result, counter)) < 5e-4 and abs(mises_error(result, counter)) < 5e-3
    assert q["mises_max_depth_m"] / a == pytest.approx(hertz_mises()[1], abs=5e-3)
    assert pressure_error(result, a, p0) < 1e-2
    assert (q["p_center_Pa"], q["p_max_Pa"]) == pytest.approx((p0, p0), rel=1e-3)
    # the zero of a straight line through pressures good to about 1 %
    assert q["contact_radius_m"] == pytest.approx(a, rel=5e-3)
    assert q["contact_area_m2"] == close(np.pi * q["contact_radius_m"] ** 2)
    assert result.certificate["force_balance"] < 1e-8 and max(result.certificate.values()) < 1e-8


@pytest.mark.parametrize("poisson", [0.0, 0.2, 0.49])
def test_other_poisson_ratios(poisson):
    """From no lateral strain to nearly incompressible: no locking."""
    result = solved(16, poisson=poisson)
    a, p0, _ = hertz(poisson=poisson)
    assert abs(approach_error(result, poisson=poisson)) < 5e-4
    assert abs(mises_error(result, poisson=poisson)) < 5e-3
    assert pressure_error(result, a, p0) < 2e-2  # first order in h: twice the target at a/32
    assert result.quantities["mises_max_depth_m"] / a == pytest.approx(hertz_mises(poisson)[1], abs=1e-2)


def test_convergence_with_the_mesh():
    """Pressure: order 1 in L2 (square-root edge), order 2 in the centre, where the edge is far; approach
    likewise.
    """
    results = [solved(cells) for cells in (8, 16, 32)]
    a, p0, delta = hertz()

    def order(errors):
        return np.log2(errors[:-1] / errors[1:])

    in_l2 = order(np.array([pressure_error(r, a, p0) for r in results]))
    centre = order(np.array([abs(r.quantities["p_center_Pa"] / p0 - 1) for r in results]))
    approach = np.array([r.quantities["approach_m"] / delta for r in results])
    # the far field leaves an error that does not depend on the mesh: order from successive differences
    changes = np.abs(np.diff(approach))
    # observed 1.16, 1.09; 2.00, 1.97; 1.9
    assert [*in_l2, *centre] == pytest.approx([1.0, 1.0, 2.0, 2.0], abs=0.3)
    assert order(changes)[0] == pytest.approx(2.0, abs=0.5)


def test_far_field_error_decreases_with_the_box():
    """Error of the approach at 6, 10 and 20 a; about 4e-5 is the mesh. Observed 4.8e-4, 1.4e-4, 5.6e-5."""
    errors = np.abs([approach_error(solved(16, box=box)) for box in (6.0, 10.0, 20.0)])
    assert (np.diff(errors) < 0.0).all() and errors[0] < 6e-4 and errors[1] < 2e-4 and errors[2] < 1e-4


def test_a_fixed_boundary_is_no_far_field(monkeypatch):
    """Without the point-force displacements the approach is 6 % too small at 10 a: the far-field gate can
    fail.
    """
    supports = ContactProblem._supports

    def clamped(self, far):
        fixed, values = supports(self, far)
        return fixed, 0.0 * values

    monkeypatch.setattr(ContactProblem, "_supports", clamped)
    assert approach_error(fem_reference.solve(scene())) == pytest.approx(-0.062, abs=0.002)


@pytest.mark.parametrize("entry", ["shear", "lame"])
def test_perturbed_stiffness_turns_the_targets_red(monkeypatch, entry):
    """One stiffness constant 5 % off: the approach is ten times its tolerance off, with G the von Mises
    stress as well.
    """
    exact = elasticity.stiffness_tensor

    def perturbed(young, poisson, shears):
        D = exact(young, poisson, shears)
        if entry == "shear":
            D[3, 3] *= 1.05
        else:
            D[:3, :3] += 0.05 * D[0, 1]
        return D

    monkeypatch.setattr(elasticity, "stiffness_tensor", perturbed)
    result = fem_reference.solve(scene())
    assert abs(approach_error(result)) > 5e-3
    if entry == "shear":
        assert abs(mises_error(result)) > 5e-3


def test_stresses_on_the_axis():
    """s_zz, s_rr and von Mises at every depth against the closed form, in p0 (observed 8e-5 at a/32)."""
    result = solved(32)
    a, p0, _ = hertz()
    t = result.tables["axis"]
    z = t["z_m"] / a
    near = z < 3.0
    srr, szz = hertz_axis(z)
    for name, expected in (
        ("szz_Pa", szz),
        ("sxx_Pa", srr),
        ("syy_Pa", srr),
        ("mises_Pa", np.abs(szz - srr)),
    ):
        assert np.abs(t[name] / p0 - expected)[near].max() < 5e-4
    assert (np.diff(t["z_m"]) > 0.0).all()


@pytest.mark.parametrize("counter", ["rigid", "aluminium"])
def test_surface_displacement_and_gap_outside(counter):
    """u_z of the body outside the contact (Johnson 1985, Eq. 3.42b), and the gap that both bodies leave."""
    result = solved(16, counter)
    a, _, delta = hertz(counter)
    t = result.tables["line"]
    r = t["x_m"] / a
    outside = (r > 1.1) & (r < 8.0)
    x = r[outside]
    both = delta / np.pi * ((2 - x**2) * np.arcsin(1 / x) + np.sqrt(x**2 - 1))
    share = modulus(counter) * (1 - 0.3**2) / STEEL
    # the far-field error, 1.4e-4 of the approach, and that of the edge
    assert np.abs(t["uz_m"][outside] - share * both).max() < 5e-4 * delta
    gap = (x * a) ** 2 / (2 * RADIUS) - delta + both
    assert np.abs(t["gap_m"][outside] - gap).max() < 1e-3 * delta
    assert np.abs(t["gap_m"][r < 0.99]).max() < 1e-12 * delta


def test_mises_at_the_gauss_points_lies_under_the_surface():
    """The map of Gauss points holds the maximum of the axis to 1 %, and equals the axis values next to it."""
    result = solved(16)
    a, p0, _ = hertz()
    t = result.tables["plane"]
    i = int(np.argmax(t["mises_Pa"]))
    assert t["mises_Pa"][i] / p0 == pytest.approx(hertz_mises()[0], rel=1e-2) and t["x_m"][i] < 0.1 * a
    assert t["z_m"][i] == pytest.approx(hertz_mises()[1] * a, abs=0.05 * a)


@pytest.mark.parametrize("counter", ["rigid", "aluminium"])
def test_flat_punch(counter):
    """Approach F/(2 E* R), pressure F/(2 pi R^2)/sqrt(1 - r^2/R^2) (Johnson 1985, Eq. 3.34, 3.36)."""
    result = solved(32, counter, shape="punch")
    q = result.quantities
    assert result.status is Status.CONVERGED
    assert q["approach_m"] == pytest.approx(FORCE / (2 * modulus(counter) * RADIUS), rel=5e-4)
    centre = FORCE / (2 * np.pi * RADIUS**2)
    assert q["p_center_Pa"] == pytest.approx(centre, rel=1e-3) and q["contact_radius_m"] == RADIUS
    r, p = (result.tables["line"][name] for name in ("x_m", "p_Pa"))
    inside = r < 0.95 * RADIUS  # nodal values, up to where the pressure is three times that of the centre
    assert p[inside] == pytest.approx(centre / np.sqrt(1 - (r[inside] / RADIUS) ** 2), rel=1e-2)
    assert not p[r > RADIUS * (1 + 1e-12)].any()
    assert np.isnan(result.tables["line"]["gap_m"][r > RADIUS * (1 + 1e-12)]).all()
    assert any("singular" in warning for warning in result.warnings)
    assert max(result.certificate.values()) < 1e-8


def test_flat_punch_converges_away_from_the_edge():
    """Error of the centre pressure falls with order 2 (observed 2.2)."""
    centre = FORCE / (2 * np.pi * RADIUS**2)
    coarse, fine = (abs(solved(n, shape="punch").quantities["p_center_Pa"] / centre - 1) for n in (16, 32))
    assert np.log2(coarse / fine) > 1.5


def unit(name, length, stress):
    for ending, factor in (("_N", stress * length**2), ("_Pa", stress), ("_m2", length**2), ("_m", length)):
        if name.endswith(ending):
            return factor
    return 1.0


@pytest.mark.parametrize("length, stress", [(1e6, 1.0), (1.0, 1e6), (1.0, 1e-6), (3.7e3, 7.3e-9)])
@pytest.mark.parametrize("shape, counter", [("sphere", "rigid"), ("sphere", "aluminium"), ("punch", "rigid")])
def test_unit_system_changes_nothing(shape, counter, length, stress):
    """Lengths in um or forces in uN: same iterations, every number equal to 1e-12 of the largest of its
    column.
    """
    base = fem_reference.solve(scene(8, counter, shape=shape, steps=3))
    other = fem_reference.solve(scene(8, counter, shape=shape, length=length, stress=stress, steps=3))
    assert other.cost["newton_iterations"] == base.cost["newton_iterations"]
    for name, value in base.quantities.items():
        scaled = other.quantities[name]
        assert scaled == value or scaled / unit(name, length, stress) == close(value, 1e-12)
    for table, columns in base.tables.items():
        for name in (n for n in columns if n not in ("state", "note", "residual")):
            expected = np.asarray(columns[name], dtype=float)
            scaled = np.asarray(other.tables[table][name], dtype=float) / unit(name, length, stress)
            finite = np.isfinite(expected)
            assert (np.isfinite(scaled) == finite).all()
            largest = np.abs(expected[finite]).max(initial=0.0)
            assert np.abs(scaled[finite] - expected[finite]).max(initial=0.0) <= 1e-12 * largest, (
                table,
                name,
            )


def test_a_contact_of_nanometres_has_the_same_axis():
    """Lengths far below a micrometre: the axis table keeps its rows (no absolute tolerance in metres)."""
    small, large = (fem_reference.solve(scene(length=length)) for length in (1e-6, 1.0))
    assert len(small.tables["axis"]["z_m"]) == len(large.tables["axis"]["z_m"])
    assert np.allclose(
        np.asarray(small.tables["axis"]["mises_Pa"]), large.tables["axis"]["mises_Pa"], rtol=1e-9
    )


class TestTheForceEstimatedFromAnApproach:
    """Before anything is solved, at an approach of 0.2 um."""

    APPROACH = 2e-7

    def estimate(self, **parts):
        return force_of_approach(small_scene(**parts), self.APPROACH)

    @property
    def radius(self):
        """Of the contact of Hertz, in m."""
        return np.sqrt(RADIUS * self.APPROACH)

    def test_is_that_of_hertz_or_of_a_flat_punch(self):
        assert self.estimate() == pytest.approx(4 / 3 * modulus() * self.radius * self.APPROACH, rel=1e-12)
        punch = {"shape": "punch", "radius": 8e-6}
        wanted = 2 * modulus() * 8e-6 * self.APPROACH
        assert self.estimate(counterbody=punch) == pytest.approx(wanted, rel=1e-12)

    def test_ends_at_three_yield_stresses_on_the_part_below_the_surface(self):
        """Of hardening steel at the representative strain 0.2 sqrt(2 R d)/R (Tabor)."""
        area = 2 * np.pi * RADIUS * self.APPROACH
        for law in (PERFECT_100, {"law": "linear", "yield_stress": 1e8, "modulus": 1e10}):
            strain = 0.2 * np.sqrt(2 * RADIUS * self.APPROACH) / RADIUS
            wanted = 3 * area * (1e8 + law.get("modulus", 0.0) * strain)
            body = {"young": STEEL, "poisson": 0.3, "plasticity": law}
            assert self.estimate(body=body) == pytest.approx(wanted, rel=1e-12)

    @pytest.mark.parametrize(("thickness", "young", "poisson"), [(1e-3, 80e9, 0.2), (1e-12, STEEL, 0.3)])
    def test_is_that_of_the_film_or_of_the_body_where_the_other_does_not_count(
        self, thickness, young, poisson
    ):
        film = {"thickness": thickness, "young": 80e9, "poisson": 0.2}
        wanted = 4 / 3 * young / (1 - poisson**2) * self.radius * self.APPROACH
        body = {"young": STEEL, "poisson": 0.3, "coating": film}
        assert self.estimate(body=body) == pytest.approx(wanted, rel=1e-6)

    def test_of_a_rounded_punch_ends_so_too(self):
        """On the flat end and what of the edge lies below the surface."""
        counter = {"shape": "rounded-punch", "flat_radius": 5e-6, "radius": RADIUS}
        beyond = np.sqrt(2 * RADIUS * self.APPROACH)
        for slope in (0.0, 1e10):
            law = {"law": "linear", "yield_stress": 1e8, "modulus": slope} if slope else PERFECT_100
            wanted = 3 * np.pi * (5e-6 + beyond) ** 2 * (1e8 + slope * 0.2 * beyond / RADIUS)
            body = {"young": STEEL, "poisson": 0.3, "plasticity": law}
            assert self.estimate(body=body, counterbody=counter) == pytest.approx(wanted, rel=1e-12)
