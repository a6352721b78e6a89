# SPDX-License-Identifier: MIT
"""The verification cases: complete against the table of gates, and red when a solver is wrong."""

from pathlib import Path

import numpy as np
import pytest
from made_results import context

from sam.scene import load_scene
from verification.cases import LEVELS, all_cases
from verification.cases.case import with_grid
from verification.rows import load_rows
from verification.runs import models
from verification.runs.sampling import plane_field_on, pressure_on, surface_pressure
from verification.suite.forecast import costs_at
from verification.suite.verify import main

CASES = all_cases()


def test_gates_and_cases_belong_together():
    assert {gate.case for gate in load_rows()} == set(CASES)
    assert all(set(case.levels) <= set(LEVELS) for case in CASES.values())
    assert [name for name, case in CASES.items() if not case.levels] == [
        "periodic-peers",
        "peers",
    ]  # need other programs
    assert set(costs_at("quick")) == {name for name, case in CASES.items() if "quick" in case.levels}


def test_one_case_from_end_to_end(tmp_path):
    """The ellipse is the quickest; its report holds the page, the figures and the run."""
    assert main(["hertz-ellipse"], "quick", tmp_path / "out") == 0
    for name in (
        "index.html",
        "elastic.html",
        "README.md",
        "results.json",
        "gates.csv",
        "junit.xml",
        "runs/hertz-ellipse/sam/summary.json",
    ):
        assert (tmp_path / "out" / name).stat().st_size > 0
    for kind in ("png", "csv.gz"):
        assert (tmp_path / "out" / "figures" / f"hertz-ellipse-pressure-maps.{kind}").stat().st_size > 1000


@pytest.fixture(scope="module")
def scene():
    return load_scene(Path(__file__).parents[2] / "verification" / "scenes" / "hertz-sphere.toml")


def test_unconverged_solve_breaks_the_case_off(tmp_path, scene):
    case = context("test", tmp_path)
    coarse = with_grid(scene, extent=(5e-6, 5e-6))  # smaller than the contact
    with pytest.raises(RuntimeError, match="grid-edge"):
        case.solve(models.SAM, coarse, "sam")
    assert case.runs == ["runs/test/sam"]


class TestSampling:
    def test_unequal_cells_keep_their_directions(self):
        nodes = np.array([[x, y, 0.0] for x in (0.0, 2.0, 4.0) for y in (0.0, 1.0, 2.0, 3.0)])
        quads = np.array(
            [[4 * i + j, 4 * i + 4 + j, 4 * i + 5 + j, 4 * i + 1 + j] for i in (0, 1) for j in (0, 1, 2)]
        )
        x, y, p = surface_pressure(nodes, quads, np.arange(6.0))
        assert x.tolist() == [1.0, 3.0] and y.tolist() == [0.5, 1.5, 2.5]
        assert p.tolist() == [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]

    def test_hertz_pressure_is_interpolated_to_rounding(self):
        """p^2 is quadratic in r: lines between nodes 1/400 apart err by 1/(8 * 400^2) of p0^2."""
        r = np.linspace(0.0, 2.0, 801)
        line = {"state": ["peak"] * r.size, "x_m": r, "p_Pa": np.sqrt(np.maximum(1.0 - r**2, 0.0))}
        x, y = np.array([-0.31, 0.123]), np.array([0.4567])
        exact = 1.0 - (x[:, None] ** 2 + y**2)
        assert np.abs(pressure_on(x, y, {"line": line}) ** 2 - exact).max() <= 1.0 / (4.0 * 400**2)

    def test_linear_field_is_reproduced_and_nothing_extrapolated(self):
        r, z = (c.ravel() for c in np.meshgrid(np.linspace(0.02, 3.0, 41), np.linspace(0.03, 3.0, 43)))
        plane = {"state": ["peak"] * r.size, "x_m": r, "z_m": z, "mises_Pa": 2.0 + 5.0 * z}
        field = plane_field_on(
            np.array([-1.0, 0.0, 0.7]), np.array([0.0, 0.5, 1.0]), {"plane": plane}, "mises_Pa"
        )
        assert np.isnan(field[:, 0]).all() and np.allclose(field[:, 1:], [4.5, 7.0], rtol=1e-12)
        whole = plane | {"x_m": 2.0 * (r - 1.5), "mises_Pa": 2.0 + r}  # of a section that is not symmetric
        field = plane_field_on(np.array([-1.0, 0.7]), np.array([0.5]), {"plane": whole}, "mises_Pa")
        assert np.allclose(field[:, 0], [3.0, 3.85], rtol=1e-12)
