# SPDX-License-Identifier: MIT
"""The case of wear over cycles against finite elements, on made results: none of its runs is solved."""

import numpy as np
import pytest
from made_results import Made, context, red

from fem_reference.spatial import WornCycle
from sam.scene import GridFields
from verification.cases.running_in import running_in_fem as study
from verification.cases.running_in.running_in_fem import (
    CELLS,
    CYCLES,
    GIVEN,
    OWN,
    SIDE,
    THICK,
    UNRESOLVED,
    Solved,
)
from verification.figures.check import findings

CASE = study.CASES[0]
WHAT = ("pressure", "strain", "residual", "volume")


def tables(cells: int, pressure: float = 1.0, strain: float = 1.0) -> dict:
    """Three spots of constant pressure, and bells of strain below."""
    x = ((np.arange(cells) + 0.5) / cells - 0.5) * SIDE
    p, z = np.zeros((cells, cells)), np.linspace(0.1e-6, 3e-6, 24)
    for k, value in enumerate((4e9, 3e9, 2e9)):
        p[(3 + 7 * k) : (6 + 7 * k), cells // 2 - 1 : cells // 2 + 1] = value * (pressure if k == 1 else 1.0)
    peeq = np.full((cells, 1), 0.01 * strain) * np.exp(-(((z - 0.6e-6) / 0.5e-6) ** 2))
    (xx, yy), (px, pz) = np.meshgrid(x, x, indexing="ij"), np.meshgrid(x, z, indexing="ij")
    return {
        "surface": {"x_m": xx.ravel(), "y_m": yy.ravel(), "p_Pa": p.ravel(), "state": ["peak"] * xx.size},
        "plane": {"x_m": px.ravel(), "z_m": pz.ravel(), "peeq": peeq.ravel(), "state": ["peak"] * px.size},
    }


def solved(cells: int, off: float = 1.0, runs: tuple[str, ...] = (), **factors: float) -> Solved:
    """One grid on which FEM is off by a factor in pressure, strain, residual height and volume; the named
    `runs` of it by others.
    """
    worn = np.zeros((cells, cells))
    worn[4:8, 4:8] = THICK
    moved = np.full((cells, cells), 2e-9)
    states = [*(f"cycle-{k}" for k in range(1, CYCLES)), "unloaded"]
    grid = (np.zeros(1), np.zeros(1), np.zeros(1), {})
    grids = {
        state: {
            "surface": GridFields(*grid, {"worn_m": k * worn[..., None], "uz_m": moved[..., None]}),
        }
        for k, state in enumerate(states, start=1)
    }
    cycles = {"p_max_Pa": [5e9] * CYCLES, "peeq_max": [0.02] * CYCLES}
    own = Made(tables={**tables(cells), "cycles": cycles})
    object.__setattr__(own, "grids", grids)
    fem = {}
    for name in (OWN, GIVEN):
        by = dict.fromkeys(WHAT, off) | (factors if name in runs else {})
        of = tables(cells, by["pressure"], by["strain"])
        height = moved + (by["residual"] - 1.0) * CYCLES * THICK * (worn > 0)
        # volume that is worn elsewhere in addition leaves the lost heights what they are
        more = np.where(worn > 0, 0.0, by["volume"] - 1.0) * 0.05e-9
        fem[name] = [WornCycle(of, 0.02, k * worn + more, height - more) for k in range(1, CYCLES + 1)]
    return Solved(own, own, fem)


def found(*runs: str, **factors: float) -> dict[int, Solved]:
    """Each grid is nearer than the one before it; the named runs have the factors on all but the first."""
    coarse, *finer = zip(CELLS, (1.6, 1.02, 1.01), strict=True)
    return {coarse[0]: solved(*coarse)} | {n: solved(n, off, runs, **factors) for n, off in finer}


def test_nearly_equal_results_hold_every_gate():
    assert red(CASE.name, CASE.measure(found(OWN, GIVEN)), whole=True) == set()


@pytest.mark.parametrize("run", [OWN, GIVEN])
@pytest.mark.parametrize("what", ["pressure", "strain", "residual"])
def test_a_wrong_result_turns_its_gate_red(run, what):
    prefix, gate = ("own", what) if run == OWN else ("given", what.replace("residual", "moved"))
    gates = (gate, "squares") if what == "pressure" else (gate,)
    wrong = red(CASE.name, CASE.measure(found(run, **{what: 3.0})))
    shrinking = {f"shrinks-{prefix}-{gate}" for gate in gates if (run, gate) not in UNRESOLVED}
    assert wrong == {f"{prefix}-{gate}" for gate in gates} | shrinking


def test_a_wrong_volume_turns_its_gate_red():
    assert red(CASE.name, CASE.measure(found(OWN, volume=3.0))) == {"own-volume"}


def test_a_cycle_that_does_not_wear_turns_its_gate_red():
    results = found(OWN, GIVEN)
    surface = results[CELLS[-1]].sam.grids["cycle-2"]["surface"].cell_data
    surface["worn_m"] = results[CELLS[-1]].sam.grids["cycle-1"]["surface"].cell_data["worn_m"]
    assert red(CASE.name, CASE.measure(results)) == {"wears"}


def test_finite_elements_are_given_what_sam_removes_in_each_cycle(monkeypatch, tmp_path):
    made, asked = solved(CELLS[0]), []
    solver = context(CASE.name, tmp_path)
    solver.solve = lambda *_: made.sam
    monkeypatch.setattr(study, "worn_cycles", lambda scene, depths: asked.append((scene, depths)) or [])
    study.solved(solver, solver.scene(study.SCENE), CELLS[0])
    (scene, own), (_, given) = asked
    assert own is None and scene.loading.cycles == CYCLES and scene.wear.smoothing_window == 0
    assert np.sum(given, axis=0) == pytest.approx(made.worn[-1], rel=1e-12) and len(given) == CYCLES


def test_tables_and_the_figure_can_be_read():
    results = found(OWN, GIVEN)
    for table in CASE.tables(results):
        assert all(len(row) == len(table.columns) for row in table.rows)
    for plot in CASE.figures(results):
        assert list(findings(plot.drawing.figure)) == []


def test_means_over_squares_count_each_cell_by_its_shares():
    """Cells of 2/3 of a square: the second lies in two."""
    p = np.zeros((24, 24))
    p[1, 0] = 4.0
    found = study.over_squares(p)
    assert found[:2, 0] == pytest.approx([4.0 * 2 / 9, 4.0 * 2 / 9], rel=1e-12)
    assert found.mean() == pytest.approx(p.mean(), rel=1e-12)
