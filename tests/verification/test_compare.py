# SPDX-License-Identifier: MIT
"""The comparison of plastic scenes, on fields in closed form that stand for both models; elastic ones are in
test_cli.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from builders import scene_text

from fem_reference.common import recovery
from sam.results import peaks
from sam.results.snapshots import Box
from sam.scene import parse_scene
from verification.compare.comparison import compare_scene
from verification.compare.rows import Pair
from verification.compare.smooth import (
    MEANS,
    PLASTIC_FIELDS,
    PLASTIC_SCALARS,
    RESIDUAL_FIELDS,
    RESIDUAL_SCALARS,
    _plane,
    compare_results,
)

QUANTITIES = {
    "force_N": 1.0,
    "approach_m": 1.0,
    "contact_radius_m": 1.0,
    "p_max_Pa": 1.0,
    "p_center_Pa": 1.0,
    "mises_max_Pa": 0.8,
    "mises_max_depth_m": 0.5,
    "peeq_max": 0.02,
    "peeq_max_depth_m": 0.5,
    "residual_uz_center_m": 0.1,
    "residual_mises_max_Pa": 0.2,
    "peeq_p95": 0.019,
}
STATES = ("peak", "unloaded")


@dataclass(frozen=True)
class Made:
    """A result that no solver made."""

    quantities: dict
    tables: dict


def peeq(r, z):
    """Zero outside an ellipsoid under the surface, with a kink in the slope of the slope at its border."""
    return 0.02 * np.maximum(0.0, 1 - (r / 0.9) ** 2 - ((z - 0.5) / 0.55) ** 2) ** 1.5


def mises(r, z):
    return 0.8 * np.exp(-(r**2) - (z - 0.5) ** 2)


def table(points: dict, columns: dict) -> dict:
    """One table of both states; columns: name -> (at peak, unloaded)."""
    rows = len(next(iter(points.values())))
    out = {"state": [state for state in STATES for _ in range(rows)]}
    out |= {name: np.tile(values, 2) for name, values in points.items()}
    return out | {name: np.concatenate(pair) for name, pair in columns.items()}


def made(line, depths, r, z) -> Made:
    """The fields on a line, at depths on the axis and at the points of the plane."""
    p = np.sqrt(np.maximum(0.0, 1 - line**2))
    uz = 1 / (1 + line**2)
    strains = [peeq(0.0, depths), peeq(r, z)]
    stresses = [mises(0.0, depths), mises(r, z)]
    tables = {
        "line": table({"x_m": line}, {"p_Pa": (p, 0 * p), "uz_m": (uz, 0.1 * np.exp(-(line**2)))}),
        "axis": table(
            {"z_m": depths}, {"peeq": (strains[0],) * 2, "mises_Pa": (stresses[0], stresses[0] / 4)}
        ),
        "plane": table(
            {"x_m": r, "z_m": z}, {"peeq": (strains[1],) * 2, "mises_Pa": (stresses[1], stresses[1] / 4)}
        ),
    }
    return Made(dict(QUANTITIES), tables)


def like_sam(cells: int = 14) -> Made:
    """Cells of 1/`cells` of the contact radius, layers of the same thickness: values at the centres."""
    h = 1 / cells
    x, z = np.arange(-2.5 * cells, 2.5 * cells + 1) * h, (np.arange(2 * cells) + 0.5) * h
    plane = np.meshgrid(x, z, indexing="ij")
    return made(x, z, plane[0].ravel(), plane[1].ravel())


def like_fem(cells: int = 16) -> Made:
    """The 2 x 2 Gauss points of square elements, nodes on the surface and on the axis."""
    gauss = (
        np.arange(2 * cells * 2) // 2 + np.tile([0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5], 2 * cells)
    ) / cells
    r, z = np.meshgrid(gauss, gauss, indexing="ij")
    line = np.linspace(0.0, 5.0, 10 * cells + 1)
    return made(line, line, r.ravel(), z.ravel())


SAM, FEM = like_sam(), like_fem()
ALL = {"plastic": True, "unloaded": True}
ADDED = [row[0] for row in (*PLASTIC_SCALARS, *RESIDUAL_SCALARS, *PLASTIC_FIELDS, *RESIDUAL_FIELDS)]


def rows_of(sam=SAM, fem=FEM, **kinds) -> dict:
    return {row.quantity: row for row in compare_results(sam, fem, **(kinds or ALL))}


def red(sam, fem) -> set[str]:
    return {name for name, row in rows_of(sam, fem).items() if not row.passed}


def changed(result: Made, name: str, column: str, change, state: str = "peak") -> Made:
    values = np.array(result.tables[name][column], dtype=float)
    rows = np.array(result.tables[name]["state"]) == state
    values[rows] = change(values[rows])
    return replace(result, tables={**result.tables, name: {**result.tables[name], column: values}})


@pytest.mark.parametrize("size", [1.0, 1e-6])
def test_both_models_find_the_strain_that_a_twentieth_of_the_plastic_volume_exceeds(size):
    """Linear over depth, of layers of different heights: 0.01 of the strain ends the plastic volume at 0.99
    of the depth, to half of the lowest layer, of 0.01.
    """
    z = size * np.append(np.linspace(0.0, 0.5, 101), np.linspace(0.51, 1.0, 50))
    middles, heights = (z[1:] + z[:-1]) / 2, np.diff(z)
    strain = 0.02 * (1 - middles / size)
    none = np.zeros((6, 150, 1, 1))
    box = Box(np.array([0, size]), np.array([0, size]), z, none, none, strain[:, None, None])
    found = peaks.exceeded_strain(box), recovery.exceeded_strain(strain, heights)
    assert found == pytest.approx((0.02 * (1 - 0.05 * 0.99),) * 2, rel=5e-4)
    empty = replace(box, peeq=np.zeros((150, 1, 1)))
    assert peaks.exceeded_strain(empty) is recovery.exceeded_strain(0 * strain, heights) is None


def test_equal_fields_agree_on_different_points():
    """Nothing but interpolation between cells of 1/14: at most 0.5 %, a quarter of the tightest tolerance of
    a strain.
    """
    rows = rows_of()
    assert set(ADDED) <= set(rows) and "mises_max_depth_m" not in rows and "residual_mises_max_Pa" not in rows
    assert all(row.error < 5e-3 for row in rows.values())
    assert all(row.passed and row.row.reason for row in rows.values())


def test_interpolation_converges_and_a_spline_is_better_than_lines():
    """Observed orders: 2 for lines, and 2 or more for the spline, which the border of the strain limits."""
    errors = {}
    for spline in (False, True):
        for cells in (14, 28):
            a, b, _ = _plane(Pair(like_sam(cells), FEM, 1.0, False, spline), "peeq")
            errors[spline, cells] = np.linalg.norm(a - b) / np.linalg.norm(b)
    assert errors[True, 14] < 0.5 * errors[False, 14] < 1e-2
    for spline in (False, True):
        assert math.log2(errors[spline, 14] / errors[spline, 28]) > 1.8


@pytest.mark.parametrize("name, metric, tolerance, _reason", (*PLASTIC_SCALARS, *RESIDUAL_SCALARS))
@pytest.mark.parametrize("wrong", ["off", None, math.nan])
def test_a_wrong_or_missing_quantity_turns_its_row_red(name, metric, tolerance, _reason, wrong):
    value = QUANTITIES[name]
    scale = 1.0 if metric == "radii" else value
    value = value + 1.01 * tolerance * scale if wrong == "off" else wrong
    assert red(replace(SAM, quantities={**QUANTITIES, name: value}), FEM) == {name}


FIELDS = {
    "peeq on the axis": ("axis", "peeq", "peak"),
    "peeq in the plane y = 0": ("plane", "peeq", "peak"),
    "residual uz_m on the line": ("line", "uz_m", "unloaded"),
    "residual mises_Pa on the axis": ("axis", "mises_Pa", "unloaded"),
    "mises_Pa on the axis": ("axis", "mises_Pa", "peak"),
    "mises_Pa in the plane y = 0": ("plane", "mises_Pa", "peak"),
}


@pytest.mark.parametrize("name, place", FIELDS.items(), ids=FIELDS.keys())
@pytest.mark.parametrize("factor", [1.06, math.nan])
@pytest.mark.parametrize("side", [0, 1])
def test_a_wrong_field_turns_its_row_red_and_no_other(name, place, factor, side):
    """6 % is beyond every tolerance."""
    pair = [SAM, FEM]
    pair[side] = changed(pair[side], *place[:2], lambda values: values * factor, place[2])
    assert red(*pair) == {name}


@pytest.mark.parametrize("name", FIELDS)
def test_a_missing_state_turns_its_row_red(name):
    place, _, state = FIELDS[name]
    states = ["other" if entry == state else entry for entry in FEM.tables[place]["state"]]
    fem = replace(FEM, tables={**FEM.tables, place: {**FEM.tables[place], "state": states}})
    assert name in red(SAM, fem)


@pytest.mark.parametrize("factor", [0.5, math.nan])
def test_a_wrong_pressure_at_the_edge_of_a_yielding_contact_is_seen_in_its_means(factor):
    """Half of it in the last cell, beyond 0.9 of the radius."""
    r = np.abs(
        np.array(SAM.tables["line"]["x_m"], dtype=float)[np.array(SAM.tables["line"]["state"]) == "peak"]
    )
    outside = (r > 0.92) & (r <= 1.0)
    wrong = changed(SAM, "line", "p_Pa", lambda p: np.where(outside, factor * p, p))
    assert MEANS in red(wrong, FEM)


def test_data_without_a_radius_have_no_means_of_the_pressure():
    data = replace(FEM, quantities={**QUANTITIES, "contact_radius_m": None})
    assert MEANS in rows_of() and MEANS not in rows_of(SAM, data)


def test_plastic_strain_at_the_wrong_depth_turns_red():
    """By a fifth of a layer of 1/14: less than the interpolation would hide if it were not centred."""
    for place, name in (("axis", "peeq on the axis"), ("plane", "peeq in the plane y = 0")):
        assert name in red(changed(SAM, place, "z_m", lambda z: z + 0.2 / 14), FEM)


def elastic(residual: float = 0.0) -> Made:
    """Nothing has yielded; a rounding error may be left of unloading."""
    none = dict.fromkeys(("peeq_max", "residual_mises_max_Pa"), 0.0)
    out = replace(
        SAM, quantities={**QUANTITIES, **none, "peeq_max_depth_m": None, "residual_uz_center_m": residual}
    )
    for place in ("axis", "plane"):
        out = changed(out, place, "peeq", np.zeros_like)
    out = changed(out, "line", "uz_m", lambda uz: 0 * uz + residual, "unloaded")
    return changed(out, "axis", "mises_Pa", lambda values: 0 * values + residual, "unloaded")


@pytest.mark.parametrize("residual, passed", [(0.0, True), (1e-12, True), (1e-6, False), (math.nan, False)])
def test_no_plastic_strain_in_both_models(residual, passed):
    """Equal zeros agree; rounding does not count, a residual of a millionth of the approach does."""
    rows = rows_of(elastic(residual), elastic())
    assert "peeq_max_depth_m" not in rows
    left = ("residual_uz_center_m", *(name for name, *_ in RESIDUAL_FIELDS))
    assert all(row.passed == (passed or name not in left) for name, row in rows.items())


def test_plastic_strain_in_one_model_only_turns_red():
    for pair in ((elastic(), FEM), (SAM, elastic())):
        assert {"peeq_max", "peeq_max_depth_m", "peeq on the axis", "peeq in the plane y = 0"} <= red(*pair)


@pytest.mark.parametrize(
    "add, added", [("", set()), ("P", {"peeq"}), ("unload = true\nP", {"peeq", "residual"})]
)
def test_a_scene_says_which_rows_there_are(add, added):
    plasticity = '[body.plasticity]\nlaw = "perfect"\nyield_stress = "1 GPa"\n'
    scene = parse_scene(scene_text(add=add.replace("P", plasticity)).encode(), "")
    rows = compare_scene(scene, SAM, FEM)
    names = [row.quantity for row in rows]
    assert {word for word in ("peeq", "residual") if any(name.startswith(word) for name in names)} == added
    tolerance = {row.quantity: row.row.tolerance for row in rows}
    assert tolerance["approach_m"] == (5e-3 if added else 2e-3) and ("mises_max_depth_m" in names) == (
        not added
    )
