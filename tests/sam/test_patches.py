# SPDX-License-Identifier: MIT
"""Influence coefficients of a loaded rectangle against quadrature of the point-load solutions."""

import json

import numpy as np
import pytest
from derivations.load_table import TABLE, as_text, derive

import sam.kernels.patches as patches
from sam.kernels.patches import (
    STRESS,
    Lags,
    displacement_coefficients,
    load_table,
    parity,
    stress_coefficients,
)
from sam.kernels.primitives import Corners, orders, primitive
from verification.reference.quadrature import patch_response, point_response

HX, HY = 1.0, 0.7
POINTS = [(0, 0, 0.3), (0, 0, 0.02), (1, 0, 0.05), (0, 1, 0.4), (3, 2, 0.5), (0, 4, 2.0), (7, 5, 11.0)]


def closed_form(load, i, j, z, nu):
    """The nine coefficients (6 stresses, 3 displacements) at the lag (i, j), either sign."""
    n = abs(i) + 1, abs(j) + 1
    signs = [parity(name, load) for name in (*STRESS, "1", "2", "3")]
    stress = stress_coefficients(Lags(*n, HX, HY), z, nu, load=load)[:, 0, -1, -1]
    shift = [
        displacement_coefficients(Lags(*n, HX, HY), nu, component=c, load=load, z=z)[-1, -1]
        for c in (1, 2, 3)
    ]
    sign = [(px if i < 0 else 1) * (py if j < 0 else 1) for px, py in signs]
    return np.array(sign) * np.concatenate([stress, shift])


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", [1, 2, 3])
def test_equal_to_quadrature_of_point_loads(load, nu):
    """1e-10 of the largest component (the project's bound; measured below 2e-13)."""
    for i, j, z in POINTS:
        for si, sj in ((1, 1), (-1, 1), (1, -1)):
            answer = patch_response(load, (si * i * HX, sj * j * HY, z), (HX / 2, HY / 2), nu)
            error = closed_form(load, si * i, sj * j, z, nu) - answer
            assert np.abs(error[:6]).max() <= 1e-10 * np.abs(answer[:6]).max()
            assert np.abs(error[6:]).max() <= 1e-10 * np.abs(answer[6:]).max()


@pytest.mark.parametrize("load", [1, 2, 3])
def test_equal_to_quadrature_in_one_place(load):
    """As above, with every term of the table in it: off the axes and below the surface."""
    answer = patch_response(load, (3 * HX, 2 * HY, 0.5), (HX / 2, HY / 2), 0.3)
    error = closed_form(load, 3, 2, 0.5, 0.3) - answer
    assert np.abs(error[:6]).max() <= 1e-10 * np.abs(answer[:6]).max()
    assert np.abs(error[6:]).max() <= 1e-10 * np.abs(answer[6:]).max()


@pytest.mark.parametrize("load", [1, 2, 3])
def test_nine_surface_displacements(load):
    """At z = 0, under the patch too, where the integrand is singular: all D_ij of paper Eq. 5."""
    for i, j in ((0, 0), (1, 0), (0, 1), (2, 3), (-2, 1)):
        answer = patch_response(load, (i * HX, j * HY, 0.0), (HX / 2, HY / 2), 0.3)[6:]
        assert np.abs(closed_form(load, i, j, 0.0, 0.3)[6:] - answer).max() <= 1e-12


def test_surface_stress_balances_the_traction():
    """At z = 0 the traction on the body is (q_x, q_y, p) on the patch and nothing beside it."""
    for load, name, sign in ((3, "33", -1), (1, "13", -1), (2, "23", -1)):
        stress = stress_coefficients(Lags(4, 4, HX, HY), 0.0, 0.3, load=load)[:, 0]
        for component in ("33", "23", "13"):
            expected = np.zeros((4, 4))
            expected[0, 0] = sign if component == name else 0.0
            assert np.abs(stress[STRESS.index(component)] - expected).max() < 1e-14


def test_load_of_many_patches_is_carried_at_every_depth():
    """Vertical equilibrium: the sum of sigma_33 over a large plane tends to minus the force."""
    s33 = stress_coefficients(Lags(400, 400, 1.0, 1.0), 3.0, 0.3)[2, 0]
    total = s33[0, 0] + 2 * (s33[1:, 0].sum() + s33[0, 1:].sum()) + 4 * s33[1:, 1:].sum()
    assert total == pytest.approx(-1.0, abs=1e-4)  # what is outside the plane falls as (z/L)^3


def test_the_table_is_what_the_derivation_gives():
    assert TABLE.read_text(encoding="utf-8") == as_text(derive())


def test_far_away_a_patch_is_a_point_load():
    """75 cells away the patch differs from its resultant by (cell/distance)^2: 1e-4."""
    j = round(45 / HY)
    patch = closed_form(3, 60, j, 30.0, 0.3)
    point = point_response(3, (60.0, j * HY, 30.0), 0.3) * HX * HY
    assert np.abs(patch - point)[:6].max() < 1e-4 * np.abs(point[:6]).max()
    assert np.abs(patch - point)[6:].max() < 1e-4 * np.abs(point[6:]).max()


@pytest.mark.parametrize("kind", ["stress", "displacement"])
def test_a_changed_coefficient_is_seen(kind, monkeypatch):
    """Every row of the table, one after the other, changed by 1e-3: some component moves by more than the
    gate.
    """
    table = load_table()
    columns = slice(0, 6) if kind == "stress" else slice(6, 9)
    answers = {load: patch_response(load, (1 * HX, 2 * HY, 0.4), (HX / 2, HY / 2), 0.3) for load in (1, 2, 3)}
    for name, rows in table[kind].items():
        for k, (*index, powers) in enumerate(rows):
            changed = json.loads(json.dumps(table))
            changed[kind][name][k] = [*index, [c * 1.001 for c in powers]]
            monkeypatch.setattr(patches, "load_table", lambda t=changed: t)
            load = int(name[-1])
            error = (closed_form(load, 1, 2, 0.4, 0.3) - answers[load])[columns]
            assert np.abs(error).max() > 1e-7 * np.abs(answers[load][columns]).max(), (name, k)


def test_primitives_are_each_other_s_derivatives():
    """d/dz P[a,b,c] = P[a,b,c+1] by central differences of the corner sum, wherever both orders exist."""
    step = 1e-4
    x, y = np.array([1.3, 2.1])[:, None], np.array([0.4, 1.7])[None, :]

    def patch(a, b, c, z):
        return np.diff(np.diff(primitive(a, b, c, Corners(x, y, np.array(z))), axis=0), axis=1)

    known = set(orders())
    pairs = [(a, b, c) for a, b, c in known if (a, b, c + 1) in known]
    assert len(pairs) >= 7
    for a, b, c in pairs:
        slope = (patch(a, b, c, 0.6 + step) - patch(a, b, c, 0.6 - step)) / (2 * step)
        assert slope == pytest.approx(patch(a, b, c + 1, 0.6), rel=1e-6, abs=1e-9)


def test_far_coefficients_keep_their_digits():
    """300 cells away: cancellation in the corner sum and the difference to a point load, (1/300)^2, stay
    below 1e-5.
    """
    z = 40.0
    patch = stress_coefficients(Lags(301, 1, 1.0, 1.0), z, 0.3)[:, 0, 300, 0]
    near = point_response(3, (300.0, 0.0, z), 0.3)[:6]
    assert np.abs(patch - near).max() < 1e-5 * np.abs(near).max()
