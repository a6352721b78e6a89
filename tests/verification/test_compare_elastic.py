# SPDX-License-Identifier: MIT
"""The comparison of elastic scenes: the command `compare`, and rows that turn red when one model is wrong."""

import csv
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from builders import COARSE, parsed, scene_text

from verification.compare.rows import COLUMNS
from verification.compare.smooth import SCALARS, compare_results
from verification.figures.compared import LOOKS, PANELS, curves
from verification.runs import models
from verification.runs.files import read_run


@pytest.fixture
def folder(sphere_folder):
    return sphere_folder


@pytest.fixture(scope="module")
def solved():
    """(SAM, FEM) results of the default scene."""
    return models.solve(parsed(), models.SAM), models.solve(parsed(), models.FEM)


def compared(folder) -> list[dict[str, str]]:
    """The rows of compare.csv in a folder."""
    with open(folder / "compare.csv", encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_compare_holds_on_the_default_meshes_and_writes_both_runs(folder, samfem):
    shown = samfem("compare", "sphere.toml").out
    rows = compared(folder / "sphere-compare")
    assert tuple(rows[0]) == COLUMNS
    assert COLUMNS[:7] == ("quantity", "sam", "fem", "metric", "difference", "tolerance", "passed")
    assert len(rows) == len(SCALARS) + 4 and {row["passed"] for row in rows} == {"True"}
    assert all(float(row["difference"]) <= float(row["tolerance"]) and row["reason"] for row in rows)
    assert all(row["quantity"] in shown for row in rows)
    assert all(read_run(folder / "sphere-compare" / part).converged for part in ("sam", "fem"))


def test_compare_on_coarse_meshes_fails_and_says_what_to_change(folder, samfem):
    coarser = scene_text(add="[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 5\n")
    (folder / "coarse.toml").write_text(coarser)
    shown = samfem("compare", "coarse.toml", "--out", "out", code=1)
    assert "FAILED" in shown.out and "outside the tolerance" in shown.err
    assert "raise grid.cells = [17, 17], or raise fem.cells_per_radius = 5" in shown.err
    samfem("compare", "sphere.toml", "--out", "out")  # an older comparison is replaced
    assert "FAILED" not in (folder / "out" / "compare.csv").read_text(encoding="utf-8")


def test_compare_draws_both_models_over_each_other(folder, samfem):
    """What is drawn is what the tables of both runs hold; figures of an older comparison do not stay."""
    (folder / "none.toml").write_text(scene_text(("0.65 N", "0 N"), add=COARSE))
    files = {f"{name}.{kind}" for name in ("line", "axis", "history") for kind in ("png", "csv")}
    for scene, code in (("coarse", 1), ("none", 0)):
        shown = samfem("compare", f"{scene}.toml", "--out", "out", "--figures", code=code)
        assert {entry.name for entry in (folder / "out" / "figures").iterdir()} == files
        assert "out/figures/line.png" in shown.out
        runs = {model: read_run(folder / "out" / part) for model, part in (("SAM", "sam"), ("FEM", "fem"))}
        for table in PANELS:
            panels = curves(runs, table).figure.axes
            for panel, (column, factor) in zip(panels, PANELS[table].values(), strict=True):
                assert [line.get_label() for line in panel.lines] == list(LOOKS)
                for line, run in zip(panel.lines, runs.values(), strict=True):
                    rows = run.tables[table]["state"] == "peak"
                    known = set((run.tables[table][column][rows] * factor).tolist())
                    assert len(line.get_ydata()) > 5 and set(np.asarray(line.get_ydata()).tolist()) <= known
    samfem("compare", "none.toml", "--out", "out")
    assert not list((folder / "out" / "figures").iterdir())


def test_compare_does_not_write_over_a_single_run(folder, samfem):
    samfem("solve", "coarse.toml", "--out", "out")
    assert "single run" in samfem("compare", "coarse.toml", "--out", "out", code=2).err


def test_compare_without_force_agrees_in_every_zero(folder, samfem):
    (folder / "none.toml").write_text(scene_text(("0.65 N", "0 N")))
    samfem("compare", "none.toml")


def test_compare_of_a_punch_leaves_out_what_is_infinite(folder, samfem):
    text = scene_text(('"sphere"\nradius = "105 um"', '"punch"\nradius = "10 um"'))
    (folder / "punch.toml").write_text(text)
    samfem("compare", "punch.toml")
    names = [row["quantity"] for row in compared(folder / "punch-compare")]
    assert "approach_m" in names and "p_max_Pa" not in names and len(names) == 7


def row_of(rows, name):
    return next(row for row in rows if row.quantity == name)


@pytest.mark.parametrize("name, metric, tolerance, _reason", SCALARS)
@pytest.mark.parametrize("wrong", ["off", None, math.nan, math.inf])
def test_a_wrong_or_missing_quantity_turns_its_row_red(solved, name, metric, tolerance, _reason, wrong):
    one, other = solved
    assert row_of(compare_results(one, other), name).passed
    scale = other.quantities["contact_radius_m"] if metric == "radii" else other.quantities[name]
    value = other.quantities[name] + 1.01 * tolerance * scale if wrong == "off" else wrong
    changed = replace(one, quantities={**one.quantities, name: value})
    red = {row.quantity for row in compare_results(changed, other) if not row.passed}
    # the pressure of a model ends at its contact radius, so that a wrong radius may show there too
    assert name in red and red <= {name, *(["p_Pa over the contact"] if name == "contact_radius_m" else [])}


FIELDS = {
    "p_Pa over the contact": ("line", "p_Pa"),
    "uz_m on the line": ("line", "uz_m"),
    "mises_Pa on the axis": ("axis", "mises_Pa"),
    "mises_Pa in the plane y = 0": ("plane", "mises_Pa"),
}


def with_column(result, table: str, column: str, change):
    tables = {**result.tables, table: {**result.tables[table]}}
    tables[table][column] = change(np.asarray(tables[table][column], dtype=float))
    return replace(result, tables=tables)


@pytest.mark.parametrize("name, place", FIELDS.items(), ids=FIELDS.keys())
@pytest.mark.parametrize("factor", [1.02, math.nan])
@pytest.mark.parametrize("side", [0, 1])
def test_a_wrong_field_turns_its_row_red(solved, name, place, factor, side):
    """2 % is beyond every tolerance; no other row looks at the field."""
    pair = list(solved)
    assert row_of(compare_results(*pair), name).passed
    pair[side] = with_column(pair[side], *place, lambda values: values * factor)
    assert [row.quantity for row in compare_results(*pair) if not row.passed] == [name]


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_field_at_the_wrong_place_turns_its_row_red(solved, factor):
    one, other = solved
    for name, (table, _) in FIELDS.items():
        moved = with_column(one, table, "z_m" if table == "axis" else "x_m", lambda x: x * factor)
        assert not row_of(compare_results(moved, other), name).passed


@pytest.mark.parametrize("name, place", FIELDS.items(), ids=FIELDS.keys())
def test_a_missing_table_or_state_turns_its_row_red(solved, name, place):
    one, other = solved
    table = {**one.tables[place[0]]}
    table["state"] = ["unloaded"] * len(table["state"])
    for tables in ({**one.tables, place[0]: table}, {k: t for k, t in one.tables.items() if k != place[0]}):
        assert not row_of(compare_results(replace(one, tables=tables), other), name).passed


def test_pressure_outside_the_contact_is_seen(solved):
    """A ring of pressure beyond the contact radius, of a few per cent of the largest."""
    one, other = solved
    x, p = (np.asarray(one.tables["line"][name]) for name in ("x_m", "p_Pa"))
    ring = np.abs(np.abs(x) - 1.1 * other.quantities["contact_radius_m"]) < 3e-7
    wrong = with_column(one, "line", "p_Pa", lambda values: np.where(ring, 0.05 * p.max(), values))
    assert ring.any() and not row_of(compare_results(wrong, other), "p_Pa over the contact").passed


def test_equal_parabolic_pressures_on_different_points_agree_to_rounding():
    """p^2 = p0^2 (1 - r^2/a^2) is reproduced exactly between any points, so the comparison adds no error of
    its own.
    """

    def hertzian(x):
        zero = np.zeros_like(x)
        p = np.sqrt(np.maximum(0.0, 1.0 - x**2))
        line = {"state": ["peak"] * x.size, "x_m": x, "p_Pa": p, "uz_m": zero}
        return SimpleNamespace(quantities={"contact_radius_m": 1.0}, tables={"line": line})

    whole, half = hertzian(np.linspace(-2, 2, 64)), hertzian(np.linspace(0, 5, 78))
    row = row_of(compare_results(whole, half), "p_Pa over the contact")
    # 64 points are even in number: nearest the apex p^2 is constant over (h/2)^2, 1e-3 of p0^2 on a disc of
    # 1e-3 a^2
    assert row.error < 1e-4
    odd = hertzian(np.linspace(-2, 2, 65))
    assert row_of(compare_results(odd, half), "p_Pa over the contact").error < 1e-12
