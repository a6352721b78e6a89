# SPDX-License-Identifier: MIT
"""The rows of a comparison, on fields in closed form that stand for both models; its verdict on a film."""

import math
from dataclasses import replace

import numpy as np
import pytest
from builders import PERFECT, SHAPES, parsed, scene
from made_results import Made, with_column, with_quantities

from verification.compare import verdicts
from verification.compare.comparison import compare_scene, names_of_rows, pair_of, wanted
from verification.compare.own_data import read_data

ONES = ("force_N", "approach_m", "contact_radius_m", "p_max_Pa", "p_center_Pa")
QUANTITIES = dict.fromkeys(ONES, 1.0) | dict.fromkeys(("mises_max_depth_m", "peeq_max_depth_m"), 0.5)
QUANTITIES |= {"mises_max_Pa": 0.8, "residual_uz_center_m": 0.1, "residual_mises_max_Pa": 0.2}
QUANTITIES |= {"peeq_max": 0.02, "peeq_p95": 0.019}
ELASTIC, PLASTIC = scene(), scene(body={"plasticity": PERFECT}, loading={"unload": True})
MEANS = "p_Pa as means over a/4"


def peeq(r, z):
    """Zero outside an ellipsoid under the surface, with a kink in the slope of the slope at its border."""
    return 0.02 * np.maximum(0.0, 1 - (r / 0.9) ** 2 - ((z - 0.5) / 0.55) ** 2) ** 1.5


def mises(r, z):
    return 0.8 * np.exp(-(r**2) - (z - 0.5) ** 2)


def table(places: dict, columns: dict) -> dict:
    """One table of both states; columns: name -> (at peak, unloaded)."""
    rows = len(next(iter(places.values())))
    out = {"state": ["peak"] * rows + ["unloaded"] * rows}
    out |= {name: np.tile(values, 2) for name, values in places.items()}
    return out | {name: np.concatenate(pair) for name, pair in columns.items()}


def made(line, depths, r, z) -> Made:
    """The fields on a line, at depths on the axis and at the points of the plane."""
    p, uz = np.sqrt(np.maximum(0.0, 1 - line**2)), 1 / (1 + line**2)

    def inside(r, z) -> dict:
        stress = mises(r, z)
        return {"peeq": (peeq(r, z),) * 2, "mises_Pa": (stress, stress / 4)}

    tables = {
        "line": table({"x_m": line}, {"p_Pa": (p, 0 * p), "uz_m": (uz, 0.1 * np.exp(-(line**2)))}),
        "axis": table({"z_m": depths}, inside(0.0, depths)),
        "plane": table({"x_m": r, "z_m": z}, inside(r, z)),
    }
    return Made(dict(QUANTITIES), tables)


def like_sam(cells: int = 14) -> Made:
    """Cells of 1/`cells` of the contact radius, layers of the same thickness: values at the centres."""
    x, z = np.arange(-2.5 * cells, 2.5 * cells + 1) / cells, (np.arange(2 * cells) + 0.5) / cells
    return made(x, z, *(each.ravel() for each in np.meshgrid(x, z, indexing="ij")))


def like_fem(cells: int = 16) -> Made:
    """The 2 x 2 Gauss points of square elements, nodes on the surface and on the axis."""
    points = np.tile([0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5], 2 * cells)
    gauss = (np.arange(4 * cells) // 2 + points) / cells
    line = np.linspace(0.0, 5.0, 10 * cells + 1)
    return made(line, line, *(each.ravel() for each in np.meshgrid(gauss, gauss, indexing="ij")))


SAM, FEM = like_sam(), like_fem()


def rows_of(sam=SAM, fem=FEM, of=PLASTIC) -> dict:
    return {row.quantity: row for row in compare_scene(of, sam, fem)}


def red(sam, fem, of=PLASTIC) -> set[str]:
    return {name for name, row in rows_of(sam, fem, of).items() if not row.passed}


def test_equal_fields_agree_on_different_points():
    """Nothing but interpolation between cells of 1/14: at most half of the tightest tolerance."""
    for of, count in ((ELASTIC, 10), (PLASTIC, 18)):
        rows = rows_of(of=of)
        assert set(rows) == set(wanted(pair_of(of, SAM, FEM).kinds)) <= set(names_of_rows(of))
        assert len(rows) == count and all(row.error < 5e-3 for row in rows.values())
        assert all(row.passed and row.row.reason for row in rows.values())


@pytest.mark.parametrize("of", [ELASTIC, PLASTIC], ids=["elastic", "plastic"])
def test_a_wrong_or_missing_quantity_turns_its_row_red_and_no_other(of):
    for name, (metric, tolerance, _) in wanted(pair_of(of, SAM, FEM).kinds).items():
        if metric == "relative_l2":
            continue
        value = QUANTITIES[name]
        off = value + 1.01 * tolerance * (1.0 if metric == "radii" else value)
        # the pressure of a model ends at its contact radius, so that a wrong one may show there too
        also = {"p_Pa over the contact", MEANS} if name == "contact_radius_m" else set()
        for wrong in (off, None, math.nan, math.inf):
            seen = red(replace(SAM, quantities={**QUANTITIES, name: wrong}), FEM, of)
            assert name in seen and seen <= {name} | also, wrong


FIELDS = {
    "uz_m on the line": ("line", "uz_m", "peak"),
    "mises_Pa on the axis": ("axis", "mises_Pa", "peak"),
    "mises_Pa in the plane y = 0": ("plane", "mises_Pa", "peak"),
    "peeq on the axis": ("axis", "peeq", "peak"),
    "peeq in the plane y = 0": ("plane", "peeq", "peak"),
    "residual uz_m on the line": ("line", "uz_m", "unloaded"),
    "residual mises_Pa on the axis": ("axis", "mises_Pa", "unloaded"),
}


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("side", [0, 1])
def test_a_wrong_field_turns_its_row_red_and_a_missing_one_too(name, side):
    """6 % is beyond every tolerance, and another place."""
    place, column, state = FIELDS[name]
    pair = [SAM, FEM]
    for factor in (1.06, math.nan):
        wrong = with_column(pair[side], place, column, lambda v, factor=factor: factor * v, states=(state,))
        assert red(*(wrong if k == side else each for k, each in enumerate(pair))) == {name}
    old = pair[side].tables
    states = ["other" if entry == state else entry for entry in old[place]["state"]]
    for tables in (old | {place: {**old[place], "state": states}}, {k: old[k] for k in old if k != place}):
        assert name in red(*(replace(e, tables=tables) if k == side else e for k, e in enumerate(pair)))
    length = "z_m" if place == "axis" else "x_m"
    assert name in red(with_column(SAM, place, length, lambda x: 1.2 * x), FEM)


def test_a_wrong_pressure_is_seen_where_the_contact_ends_and_beside_it():
    """Half of it, or none, beyond 0.9 of a yielding contact; 2 % in an elastic one, a ring of 5 %."""
    r = np.abs(SAM.tables["line"]["x_m"])
    for factor in (0.5, math.nan):
        rim = np.where((r > 0.92) & (r <= 1.0), factor, 1.0)
        assert MEANS in red(with_column(SAM, "line", "p_Pa", lambda p, rim=rim: rim * p), FEM)
    ring = 0.05 * (np.abs(r - 1.1) < 0.06)
    for change in (lambda p: 1.02 * p, lambda p: p + ring):
        assert red(with_column(SAM, "line", "p_Pa", change), FEM, ELASTIC) == {"p_Pa over the contact"}


def test_data_without_a_radius_have_no_means_of_the_pressure():
    data = replace(FEM, quantities={**QUANTITIES, "contact_radius_m": None})
    assert MEANS in rows_of() and MEANS not in rows_of(SAM, data)


def unyielded(residual: float = 0.0) -> Made:
    """Nothing has yielded; a rounding error may be left of unloading."""
    out = with_quantities(SAM, peeq_max=0.0, residual_mises_max_Pa=0.0)
    left = {"peeq_max_depth_m": None, "residual_uz_center_m": residual}
    out = replace(out, quantities=out.quantities | left)
    for place in ("axis", "plane"):
        out = with_column(out, place, "peeq", np.zeros_like)
    for place, column in (("line", "uz_m"), ("axis", "mises_Pa")):
        out = with_column(out, place, column, lambda v: 0 * v + residual, states=("unloaded",))
    return out


@pytest.mark.parametrize("residual, passed", [(0.0, True), (1e-12, True), (1e-6, False), (math.nan, False)])
def test_no_plastic_strain_in_both_models(residual, passed):
    """Equal zeros agree; rounding does not count, a residual of a millionth of the approach does."""
    rows = rows_of(unyielded(residual), unyielded())
    assert "peeq_max_depth_m" not in rows
    assert all(row.passed == (passed or not name.startswith("residual")) for name, row in rows.items())


def test_plastic_strain_in_one_model_only_turns_red():
    for pair in ((unyielded(), FEM), (SAM, unyielded())):
        assert {"peeq_max", "peeq_max_depth_m", "peeq on the axis", "peeq in the plane y = 0"} <= red(*pair)


@pytest.mark.parametrize(
    ("tables", "added", "lost"),
    [
        ({}, "", ""),
        ({"body": {"plasticity": PERFECT}}, "peeq", "mises_max_depth_m"),
        ({"loading": {"unload": True}}, "", ""),
        ({"counterbody": SHAPES["punch"]}, "", "p_max_Pa mises_max_Pa mises_max_depth_m"),
        ({"friction": 0.2}, "pressure_centroid_x_m", "mises_max_Pa mises_max_depth_m"),
        (
            {"body": {"coating": {"young": 80e9, "poisson": 0.3, "thickness": 0.1}}},
            "mises_max_film_Pa p_max_bare_Pa mises_max_bare_Pa mises_max_substrate_Pa",
            "mises_max_Pa mises_max_depth_m",
        ),
    ],
)
def test_a_scene_says_which_rows_there_are(tables, added, lost):
    rows, plain = rows_of(of=scene(**tables)), set(rows_of(of=ELASTIC))
    assert plain - set(rows) == set(lost.split())
    more = {"peeq" if name.startswith(("peeq", MEANS)) else name for name in set(rows) - plain}
    assert more == set(added.split())
    assert rows["approach_m"].row.tolerance == (5e-3 if "peeq" in added or "punch" in str(tables) else 2e-3)


def test_what_a_scene_gives_is_not_compared_and_a_path_leaves_a_groove():
    """For an approach the force takes its place, 1.5 times as wide."""
    given = rows_of(of=scene(loading={"approach": 1e-7, "force": None}))
    assert "approach_m" not in given and given["force_N"].row.tolerance == 1.5 * 2e-3
    pressure = rows_of(of=scene(loading={"prescribed": "hertz", "p0": 4e9, "radius": 6e-6}))
    assert not {"approach_m", "force_N"} & set(pressure)
    path = {"start": (0.0, 0.0), "end": (1e-6, 0.0), "steps": 2}
    pair = (replace(each, quantities=QUANTITIES | {"groove_depth_m": 1.0}) for each in (SAM, FEM))
    moved = rows_of(*pair, of=scene(loading={"path": path}))
    assert list(moved)[-1] == "groove_depth_m" and not {"p_center_Pa", "p_Pa over the contact"} & set(moved)


def rough_contact(loads=(3.0, 1.0), area: float = 9.0) -> Made:
    """Two spots of 4 and 5 cells of a micrometre with these loads, in N, and a line after unloading."""
    x, y = (each.ravel() for each in np.meshgrid(*(1e-6 * np.arange(8.0),) * 2, indexing="ij"))
    p = np.zeros((8, 8))
    p[1:3, 1:3], p[5, 2:7] = loads[0] / 4e-12, loads[1] / 5e-12
    surface = {"state": ["peak"] * 64, "x_m": x, "y_m": y, "p_Pa": p.ravel()}
    line = {"state": ["unloaded"] * 8, "x_m": 1e-6 * np.arange(8.0), "uz_m": np.linspace(1.0, 2.0, 8)}
    quantities = {"force_N": 4.0, "approach_m": 1.0, "contact_area_m2": area, "peeq_max": 0.01}
    return Made(quantities, {"surface": surface, "line": line})


def test_a_rough_scene_is_compared_spot_by_spot():
    surface = {"kind": "sinusoid", "amplitude": 1e-7, "wavelength_x": 1e-5}
    rough = scene(
        body={"plasticity": PERFECT},
        counterbody={"shape": "flat"},
        surface=surface,
        loading={"unload": True},
        grid={"cells": (8, 8), "extent": (8e-6, 8e-6), "layers": 4, "depth": 4e-6},
    )
    spots = ["load of the spot at 1.50, 1.50 um", "load of the spot at 5.00, 4.00 um"]
    rows = rows_of(rough_contact(), rough_contact(), rough)
    quantities = ["approach_m", "contact_area_m2", "peeq_max"]
    assert list(rows) == [*quantities, *spots, "p_Pa over the patch", "residual uz_m on the line"]
    assert all(row.passed for row in rows.values()) and rows[spots[0]].points == 1
    known = ("load of the spot", "p_Pa over the patch", "friction_coefficient", *quantities)
    assert set(known) <= set(names_of_rows(rough))
    assert red(rough_contact((3.1, 1.0)), rough_contact(), rough) == {spots[0]}
    assert red(rough_contact(area=9.5), rough_contact(), rough) == {"contact_area_m2"}
    bare = replace(rough_contact(), tables={})
    assert red(bare, rough_contact(), rough) == {"p_Pa over the patch", "residual uz_m on the line"}
    none = replace(rough_contact(), quantities=rough_contact().quantities | {"force_N": 0.0})
    assert list(rows_of(none, none, rough)) == quantities


def test_finite_elements_in_space_count_on_both_sides_and_no_stress_at_the_edge_of_a_punch():
    skew = with_column(SAM, "line", "uz_m", lambda uz: uz * (1 + 0.06 * np.sign(SAM.tables["line"]["x_m"])))
    assert red(skew, FEM, ELASTIC) == set() and red(skew, like_sam(16), ELASTIC) == {"uz_m on the line"}
    plane = FEM.tables["plane"]
    edge = np.hypot(plane["x_m"] - 1.0, plane["z_m"]) < 0.25
    wrong = with_column(FEM, "plane", "mises_Pa", lambda mises: np.where(edge, 2 * mises, mises))
    name = "mises_Pa in the plane y = 0"
    assert red(SAM, wrong, ELASTIC) == {name}
    assert name not in red(SAM, wrong, scene(counterbody=SHAPES["punch"]))


def test_sliding_the_other_way_is_noticed():
    """Every field that has two sides differs when they are exchanged."""
    columns = ("line", "p_Pa"), ("line", "uz_m"), ("plane", "mises_Pa")

    def towards(side: float) -> Made:
        out = replace(SAM, quantities=QUANTITIES | {"pressure_centroid_x_m": 0.02 * side})
        for table, column in columns:
            skew = 1 + 0.2 * side * SAM.tables[table]["x_m"]
            out = with_column(out, table, column, lambda values, skew=skew: skew * values)
        return out

    sliding = scene(friction=0.2)
    assert red(towards(1), towards(1), sliding) == set()
    fields = {"p_Pa over the contact", "uz_m on the line", "mises_Pa in the plane y = 0"}
    assert red(towards(-1), towards(1), sliding) == fields | {"pressure_centroid_x_m"}


def test_six_stresses_of_own_data_have_a_von_mises_stress(tmp_path):
    rows = [f"{z}e-6,0,0,{-1 - z}e9,0,0,0\n" for z in range(6)]
    (tmp_path / "own.csv").write_text("z_m,sxx_Pa,syy_Pa,szz_Pa,syz_Pa,sxz_Pa,sxy_Pa\n" + "".join(rows))
    found = read_data(tmp_path / "own.csv", ELASTIC).tables["axis"]["mises_Pa"]
    assert found.tolist() == [1e9 * (1 + z) for z in range(6)]


# the film on a rough patch


COATED = parsed(add="[body.coating]\nthickness = '100 nm'\nyoung = '80 GPa'\npoisson = 0.3\n")


def changed(p: float | None, mises: float) -> Made:
    return Made({"p_max_change": p, "mises_max_change": mises})


def test_breaking_radius_is_that_of_the_closed_form():
    """Rigid sphere, 80 on 210 GPa: 5 % of the stress at h/a0 = 0.058."""
    assert verdicts.breaking_radius(COATED) == pytest.approx(100e-9 / 0.058, rel=0.01)


@pytest.mark.parametrize(
    ("sam", "fem", "holds", "failed"),
    [
        (changed(-0.02, -0.03), changed(-0.021, -0.03), True, set()),
        (changed(-0.02, -0.06), changed(-0.021, -0.06), False, {"size of mises_max_change"}),
        (changed(-0.049, -0.03), changed(-0.051, -0.03), False, {"size of p_max_change"}),
        (changed(-0.02, -0.03), changed(-0.03, -0.03), True, {"p_max_change"}),
        (changed(None, -0.03), changed(-0.03, -0.03), False, {"p_max_change", "size of p_max_change"}),
    ],
)
def test_claim_and_agreement(sam, fem, holds, failed, monkeypatch):
    monkeypatch.setattr(verdicts, "breaking_radius", lambda scene: 1.7e-6)
    claim = verdicts.verdict(COATED, sam, fem)
    rows = verdicts.change_rows(sam, fem) + verdicts.claim_rows(claim, sam, fem)
    assert claim.film_negligible == holds and {row.quantity for row in rows if not row.passed} == failed
    assert ("NOT negligible" in claim.words) != holds
    assert all(value is None or np.isfinite(value) for value in claim.content().values())
