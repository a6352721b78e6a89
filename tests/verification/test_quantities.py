# SPDX-License-Identifier: MIT
"""Every quantity of the vocabulary against its definition, on results, tracks and passes made by hand."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import Made, square_mesh

from verification.judging import error_of
from verification.quantities import OF_TRACKS, QUANTITIES, Reference, Solved, Values, refined
from verification.reference.westergaard import WavyContact
from verification.runs.models import FEM, SAM

X, Y, Z = np.linspace(-3.0, 3.0, 13), np.linspace(-2.0, 2.0, 9), np.linspace(0.0, 4.0, 9)


def pressure(x, y):
    """Of no symmetry, so that a transposed field differs."""
    return 10.0 + 3.0 * x + np.cos(y - 0.3) * x**2


def mises(z):
    return 5.0 + z * np.exp(-z)


def peak(**columns):
    size = len(next(iter(columns.values())))
    return {"state": ["peak"] * size + ["unloaded"] * size} | {
        k: [*v, *(0.0 * v)] for k, v in columns.items()
    }


def made(model: str, change=lambda field: field):
    """A result with these fields; change: of the pressure (nx, ny), and of every other field."""
    fields = square_mesh(X, change(pressure(X[:, None], Y[None, :])), Y)
    r = np.linspace(0.0, 3.0, 31)
    tables = {
        "line": peak(x_m=r, p_Pa=change(pressure(r, 0.0))),
        "axis": peak(z_m=Z, mises_Pa=change(mises(Z))),
    }
    quantities = {each.row: change(np.array(7.0)) for each in QUANTITIES.values() if " " not in each.row}
    certificate = {"force_balance": float(change(np.array(1e-9)))}
    return Made(quantities, tables, fields, model=model, certificate=certificate)


SCALARS = {name: 7.0 for name, quantity in QUANTITIES.items() if quantity.row and " " not in quantity.row}
LOAD = float(np.sum(pressure(X[:, None], Y[None, :])) * 0.25)
EXACT = Reference({**SCALARS, "load": LOAD, "pressure": pressure, "mises-axis": mises}, {}, deepest=2.5)
HELD = [name for name, quantity in QUANTITIES.items() if quantity.of and name in EXACT.values]


def error(name, result, reference=EXACT):
    measured = QUANTITIES[name].against(name, result, reference)
    return error_of("relative_l2" if np.ndim(measured.value) else "relative", measured)


@pytest.mark.parametrize("name", HELD)
@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_quantity_is_its_definition_and_a_wrong_field_is_seen(name, model):
    if (name, model) == ("load", FEM):
        return  # its own error, not a value: a row of kind bound
    assert error(name, made(model)) < 1e-14
    assert error(name, made(model, lambda field: 1.01 * field)) == pytest.approx(0.01, rel=1e-9)
    assert error(name, made(model, lambda field: field + 0.1)) > 1e-3


def test_a_transposed_or_mirrored_pressure_is_seen():
    for change in (lambda p: p[::-1], lambda p: p[:, ::-1] if p.ndim > 1 else p + p.size * 1e-3):
        assert error("pressure", made(SAM, lambda p, change=change: change(p) if p.ndim else p)) > 1e-4


def test_a_field_counts_as_far_as_its_reference_says():
    deep = made(SAM, lambda f: np.where(np.arange(f.size) * 0.5 > 2.5, 0.0, f) if f.shape == Z.shape else f)
    assert error("mises-axis", deep) < 1e-14
    inside = Reference(EXACT.values, {}, inside=1.0)
    punch = made(SAM, lambda f: np.where(np.arange(f.size) > 10, 0.0, f) if f.shape == (31,) else f)
    assert error("pressure", punch, inside) < 1e-14
    values = QUANTITIES["pressure"].of(punch, inside)
    assert isinstance(values, Values) and values.places[0].max() == 1.0 and values.values.size == 11


def test_the_width_of_a_strip_is_where_its_pressure_ends_and_its_outermost_cells_do_not_count():
    wave = WavyContact(1e-3, 1.0, 1.0, 0.2e-3 * np.pi)
    x = (np.arange(96) + 0.5) / 96 - 0.5
    p = np.repeat(wave.pressure(x)[:, None], 3, axis=1)
    p[[*np.flatnonzero(p[:, 0])[[0, -1]]]] *= 0.5
    result = Made({}, {}, square_mesh(x, p, np.arange(3.0) / 96), model=SAM)
    reference = Reference({"strip-width": 2 * wave.half_width}, {"wave": 1.0})
    assert error("strip-width", result, reference) < 1e-12
    p[40] *= 1.01
    wrong = replace(result, fields=square_mesh(x, p, np.arange(3.0) / 96))
    assert error("strip-width", wrong, reference) > 1e-4


# quantities of a sphere that moves


def run(n: int, *, depth: float = 1.0, strain: float = 1.0) -> Made:
    """A track whose values are off by 1/n^2 of themselves."""
    off, x = 1 - 1 / n**2, np.linspace(-2.0, 2.0, 9)
    track = {"x_m": x, "uz_m": depth * off * (1 + 0.1 * np.abs(x))}
    return Made({"groove_deepest_m": 1.2 * depth * off, "peeq_max": strain * off}, {"track": track})


def solved(results: dict[str, Made]) -> Solved:
    return Solved(None, Reference({}, {"a": 1.0}), results)


def test_limits_of_second_order_are_recovered_and_those_of_both_models_held_against_each_other():
    runs = {name: run(int(name[4:])) for name in ("sam-8", "sam-12")}
    runs |= {name: run(int(name[4:]), depth=1.03, strain=0.98) for name in ("fem-6", "fem-8")}
    runs["cost-sam-4"] = run(4, depth=9.0)  # of no model that is compared
    found = solved(runs)
    for name, sam, fem in (("groove", 1.0, 1.03), ("deepest", 1.2, 1.236), ("strain", 1.0, 0.98)):
        measured = QUANTITIES[f"{name}-refined"].whole(found)
        assert (measured.value, measured.expected) == pytest.approx((sam, fem), rel=1e-12)
    finest = 1.03 * (1 - 1 / 8**2)
    off = abs(1 - 1 / 12**2 - finest) / finest
    assert QUANTITIES["groove"].whole(found) == pytest.approx(off, rel=1e-12)
    assert refined({12: run(12)}, OF_TRACKS["largest plastic strain"]) == 1 - 1 / 12**2


def passed(energy, strain, verdict="shakedown", floor=7e-5) -> Made:
    tables = {"cycles": {"dissipated_J": energy}, "passes": {"new_strain_max": strain}}
    return Made({}, tables, verdict={"class": verdict, "floor": floor})


def test_passes_of_both_models_are_held_over_the_first_and_those_that_count_over_themselves():
    right = passed((4.0, 0.2, 0.03), (6e-3, 3e-4, 4e-5))
    other = passed((4.0, 0.3, 0.03), (6e-3, 6e-4, 4e-5), "settling")
    found = solved({"sam-12": right, "fem-6": other})
    exact = {"energy": 0.025, "strain": 0.05, "own-energy": 1.0 / 3.0, "own-strain": 0.5}
    assert {name: QUANTITIES[name].whole(found) for name in exact} == pytest.approx(exact, rel=1e-12)
    assert QUANTITIES["counted"].whole(found) == 2.0 and QUANTITIES["verdict"].whole(found).value == 2.0
    assert QUANTITIES["shakes-down"].whole(solved({"sam-6": right})).value == 1.0
    assert QUANTITIES["alternates"].whole(solved({"sam-6": right})).value == 0.0
