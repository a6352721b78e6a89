# SPDX-License-Identifier: MIT
"""The cases of a sphere that grows: a solver that yields too early or too late is seen, and so is each
coefficient of the images at the surface.
"""

from copy import deepcopy
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from made_results import context

import sam
from sam.kernels import eigenstrain
from sam.kernels.eigenstrain import eigenstrain_table
from sam.plasticity import spectra
from verification.cases.case import with_keys, with_loading
from verification.cases.plastic.misfit_images import (
    BY_SYMMETRY,
    CELLS as IMAGE_CELLS,
    NAMES,
    SHARE,
    Images,
    images,
)
from verification.cases.plastic.misfit_sphere import l2, law, order_of_half, second_order, total
from verification.cases.recipes import sphere_cells
from verification.references import growing_sphere
from verification.rows import load_rows

CASE = "misfit-sphere"


@cache
def zone(cells: int) -> Images:
    """The images of the plastic zone of linear hardening."""
    scene = context(CASE, Path()).scene(CASE)
    return images(growing_sphere(law(scene, "linear")), cells)


def test_the_order_of_two_sizes_and_the_error_of_second_order():
    errors = pd.DataFrame({"total": [-4e-3, 1e-3, 3e-4], "sphere-cells": [6, 8, 12]})
    assert second_order(errors, "total") == pytest.approx(0.144, rel=1e-12)
    assert order_of_half(pd.DataFrame({"l2": [0.012, 0.002]}), "l2") == pytest.approx(np.log2(6.0), rel=1e-12)


def test_a_solver_with_one_point_in_a_cell_or_another_yield_stress_is_seen(tmp_path, monkeypatch):
    """On the coarsest cells, 0.5 % off: 4 % with all points of a cell at its centre."""
    base = with_loading(context(CASE, tmp_path).scene(CASE), unload=False)
    scene = sphere_cells(law(base, "linear"), 6)
    right = sam.solve(scene)
    off = total(scene, right, None)
    assert abs(off) * 6**2 < 0.25 and l2(scene, right, None) < 0.05
    with monkeypatch.context() as patched:
        patched.setattr("sam.plasticity.points.OFFSET", 0.0)
        assert abs(total(scene, sam.solve(scene), None)) * 6**2 > 1.4
    soft = with_keys(scene, "body.plasticity", yield_stress=0.98e9)
    assert abs(total(scene, sam.solve(soft), None) - off) > 0.01


def test_each_coefficient_of_the_image_that_is_1_percent_off_turns_its_gate_red():
    """All 36 of the stress and 6 of the displacement, in either sense."""
    found, tolerances = zone(IMAGE_CELLS), {gate.id: gate.tolerance for gate in load_rows()}
    own = {name: tolerances[f"{CASE}.sam-image-{name}"] for name in ("xx", "zz", "xz", "xy", "raised")}
    limits = np.array([own[BY_SYMMETRY.get(name, name)] for name in (*NAMES, "raised")])
    values = np.array([*found.left, found.largest])
    assert (values < limits).all() and (found.perturbed * values[:, None] > limits[:, None]).all()


@pytest.mark.parametrize(
    "kind, name, row, strain",
    [("stress", "12,33", 5, 2), ("displacement", "3,13", 6, 4)],
)
def test_a_coefficient_changed_in_the_table_leaves_what_the_case_says(monkeypatch, kind, name, row, strain):
    """On the coarsest cells; the answer is linear in it, so the smaller of both senses is one of them."""
    before, found = zone(6), []
    table = eigenstrain_table()
    for sign in (1, -1):
        changed = deepcopy(table)
        terms = changed[kind][name]
        changed[kind][name] = {k: tuple((1 + sign * SHARE) * c for c in v) for k, v in terms.items()}
        monkeypatch.setattr(eigenstrain, "eigenstrain_table", lambda t=changed: t)
        forget()
        after = zone.__wrapped__(6)
        found.append([*after.left / before.left, after.largest / before.largest])
    monkeypatch.undo()
    forget()
    assert np.min(found, axis=0)[row] == pytest.approx(before.perturbed[row, strain], rel=2e-3)
    assert np.abs(np.delete(found, row, axis=1) - 1.0).max() < 1e-9


def forget() -> None:
    """What the kernels remember of their table."""
    for each in (eigenstrain.blocks, eigenstrain._matrix, eigenstrain.image_orders, spectra.spectra_of):
        each.cache_clear()
