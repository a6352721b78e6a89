# SPDX-License-Identifier: MIT
"""What the finite-element model returns: steps, cycles, unloading, no force, status, tables, what it
refuses.
"""

import subprocess
import sys

import numpy as np
import pytest
from builders import RADIUS, scene as small_scene
from rounding import close

import fem_reference
from fem_reference.axisymmetric import planner
from fem_reference.common.contact import ActiveSet
from sam.scene.result import COLUMNS, COST, QUANTITIES, Status


def scene(cells=8, shape="sphere", poisson=0.3, counter=None, **loading):
    radii = {"radius_x": 1e-4, "radius_y": 2e-4} if shape == "ellipsoid" else {"radius": RADIUS}
    return small_scene(
        body={"poisson": poisson},
        counterbody={"shape": shape, **radii, **(counter or {})},
        loading=loading,
        fem={"cells_per_radius": cells},
    )


def test_record_is_complete():
    """Names, columns and lengths are those of the result record; stresses of the mesh match the tables."""
    result = fem_reference.solve(scene(unload=True, cycles=2))
    assert result.model == "fem-axisymmetric" and tuple(result.quantities) == QUANTITIES
    assert tuple(result.cost) == (*COST, "factorizations", "linear_iterations")
    assert set(result.tables) == {"history", "axis", "line", "plane", "cycles", "residuals"}
    for name, table in result.tables.items():
        assert tuple(table) == COLUMNS[name] and len({len(column) for column in table.values()}) == 1
    for name in ("axis", "line", "plane"):
        assert list(dict.fromkeys(result.tables[name]["state"])) == ["peak", "unloaded"]
    assert result.message == "" and result.cost["contact_iterations"] >= 1
    assert {"dofs", "elements", "h_m", "box_m", "cells_per_radius"} <= set(result.discretisation)
    mesh = result.fields
    assert mesh.points[:, 1].max() == 0.0
    assert mesh.point_data["p_Pa"].max() == pytest.approx(result.quantities["p_max_Pa"], rel=1e-12)
    assert mesh.cell_data["stress_Pa"].shape == (len(mesh.cells["quad"]), 6)
    assert mesh.cell_data["mises_Pa"].max() < result.quantities["mises_max_Pa"]
    corners = mesh.points[mesh.cells["quad"]]
    x, z = corners[..., 0], corners[..., 2]
    area = 0.5 * np.abs(np.sum(x * np.roll(z, -1, axis=1) - np.roll(x, -1, axis=1) * z, axis=1))
    assert area.sum() == pytest.approx(result.discretisation["box_m"] ** 2, rel=1e-12)


def test_mesh_stress_balances_the_force():
    """Integral of s_zz over the box at half depth and outside it: element means carry the force like the
    exact field.

    Between axis and wall a plane holds F minus the part outside the box: Boussinesq, F (z/R)^3 with R to the
    corner.
    """
    result = fem_reference.solve(scene(cells=16))
    corners = result.fields.points[result.fields.cells["quad"]]
    r, z, szz = corners[..., 0], corners[..., 2], result.fields.cell_data["stress_Pa"][:, 2]
    level = np.unique(result.fields.points[:, 2])[-2]
    row = (z.min(axis=1) < level) & (z.max(axis=1) <= level * (1 + 1e-12)) & (z.max(axis=1) > 0.999 * level)
    force = -np.sum(szz[row] * np.pi * (r[row].max(axis=1) ** 2 - r[row].min(axis=1) ** 2))
    depth, box = z[row].mean(), result.discretisation["box_m"]
    # coarse elements of a fifth of the depth there: 1 %
    assert force == pytest.approx(0.65 * (1 - (depth / np.hypot(depth, box)) ** 3), rel=1e-2)


def test_load_steps_follow_hertz():
    """approach ~ F^(2/3), p_max ~ F^(1/3) at every equal step; the coarsest contact has 7 elements."""
    result = fem_reference.solve(scene(cells=16, steps=10))
    h = {name: np.array(column) for name, column in result.tables["history"].items()}
    share = np.arange(1, 11) / 10
    assert h["force_N"] == pytest.approx(0.65 * share, rel=1e-15) and h["step"].tolist() == list(range(1, 11))
    assert h["approach_m"] / h["approach_m"][-1] == pytest.approx(share ** (2 / 3), rel=1e-3)
    # radius and centre pressure of the first steps: the contact ends between nodes; radius within 3e-3
    assert h["p_max_Pa"] / h["p_max_Pa"][-1] == pytest.approx(share ** (1 / 3), rel=5e-3)
    assert h["contact_area_m2"] / h["contact_area_m2"][-1] == pytest.approx(share ** (2 / 3), rel=7e-3)
    # warm start: the scaled set is right, or off by one node
    assert max(h["iterations"]) <= 3 and h["residual"].max() < 1e-9
    assert result.cost["newton_iterations"] == h["iterations"].sum()


def test_path_does_not_matter():
    """Elastic and frictionless: ten steps end where one step does, up to the rounding of the solver."""
    one, ten = (fem_reference.solve(scene(steps=n)).quantities for n in (1, 10))
    for name, value in one.items():
        assert ten[name] == (None if value is None else close(value, 1e-9)), name


def test_unloading_and_cycles():
    """One step back to exactly nothing, with a note; later cycles repeat the first, with a note."""
    result = fem_reference.solve(scene(steps=3, unload=True, unload_steps=5, cycles=3))
    h = result.tables["history"]
    assert h["cycle"] == [1] * 4 + [2] * 4 + [3] * 4 and h["step"] == [1, 2, 3, 4] * 3
    assert h["note"][3] == "elastic: unloading in one step"
    assert all("equal to cycle 1" in note for note in h["note"][4:])
    for name in ("force_N", "approach_m", "contact_area_m2", "p_max_Pa"):
        assert h[name][3] == 0.0 and h[name][4:8] == h[name][:4]
    for table in ("axis", "line", "plane"):
        t = result.tables[table]
        after = t["state"] == "unloaded"
        for name in set(t) & {"p_Pa", "uz_m", "mises_Pa", "sxx_Pa", "szz_Pa"}:
            assert not t[name][after].any() and t[name][~after].any()
    assert result.quantities["residual_uz_center_m"] == 0.0
    assert result.quantities["residual_mises_max_Pa"] == 0.0
    assert result.tables["cycles"]["p_max_Pa"] == [result.quantities["p_max_Pa"]] * 3
    line = result.tables["line"]
    after = line["state"] == "unloaded"
    assert line["gap_m"][after] == close(line["x_m"][after] ** 2 / (2 * 105e-6), 1e-12)
    assert fem_reference.solve(scene()).quantities["residual_uz_center_m"] is None


@pytest.mark.parametrize("shape", ["sphere", "punch"])
def test_no_force(shape):
    """Zero force: a converged result of zeros, with the initial gap."""
    result = fem_reference.solve(scene(force=0.0, shape=shape, steps=2, unload=True))
    assert result.status is Status.CONVERGED
    q = result.quantities
    zero = (
        "force_N",
        "approach_m",
        "contact_area_m2",
        "contact_radius_m",
        "p_max_Pa",
        "p_center_Pa",
        "mises_max_Pa",
    )
    assert [q[name] for name in zero] == [0.0] * len(zero)
    assert q["mises_max_depth_m"] is None
    assert result.tables["history"]["force_N"] == [0.0, 0.0, 0.0] and not result.tables["line"]["p_Pa"].any()
    assert not result.tables["plane"]["mises_Pa"].any() and np.isfinite(result.tables["axis"]["z_m"]).all()


@pytest.mark.parametrize("shape", ["sphere", "punch"])
def test_status_under_resolved(shape):
    coarse, fine = (fem_reference.solve(scene(cells=n, shape=shape)) for n in (3, 4))
    assert coarse.status is Status.UNDER_RESOLVED and "fem.cells_per_radius" in coarse.message
    assert fine.status is Status.CONVERGED


def test_status_contact_at_the_edge_of_the_fine_mesh(monkeypatch):
    monkeypatch.setattr(planner, "ELASTIC", planner.Core(radius=0.9))
    result = fem_reference.solve(scene())
    assert result.status is Status.CONTACT_AT_GRID_EDGE and "loading.force" in result.message


def test_status_not_converged(monkeypatch):
    """A set that cannot come to rest ends in a result that says so."""

    def restless(self, _multipliers, _gaps):
        self.stuck = True
        return True

    monkeypatch.setattr(ActiveSet, "update", restless)
    result = fem_reference.solve(scene())
    assert result.status is Status.NOT_CONVERGED and "did not settle" in result.message


def test_refusals_name_the_key():
    """What the model cannot represent is a ValueError with key, value and what is allowed; all at once."""
    with pytest.raises(
        fem_reference.UnsupportedScene, match=r'counterbody\.shape = "ellipsoid".*"sphere" or "punch"'
    ):
        fem_reference.solve(scene(shape="ellipsoid"))
    with pytest.raises(fem_reference.UnsupportedScene, match=r"body\.poisson = 0\.5.*poisson < 0\.5"):
        fem_reference.solve(scene(poisson=0.5))
    with pytest.raises(
        ValueError, match=r"counterbody\.shape.*; body\.poisson.*; counterbody\.poisson"
    ) as caught:
        fem_reference.check(scene(shape="ellipsoid", poisson=0.5, counter={"young": 1e9, "poisson": 0.5}))
    assert isinstance(caught.value, fem_reference.UnsupportedScene)
    fem_reference.check(scene(poisson=0.4999))


def test_left_out_names_stage_and_reason():
    names = [item.stage for item in fem_reference.left_out(scene())]
    assert "mesh of the counter-body" in names
    assert all(item.reason for item in fem_reference.left_out(scene()))
    elastic = scene(counter={"young": 70e9, "poisson": 0.2}, unload=True, cycles=2)
    names = [item.stage for item in fem_reference.left_out(elastic)]
    assert "mesh of the counter-body" not in names
    assert {"unloading steps", "cycles after the first"} <= set(names)


def test_progress_counts_load_steps():
    seen = []
    fem_reference.solve(scene(steps=3), progress=lambda *args: seen.append(args))
    assert seen == [("contact", 1, 3), ("contact", 2, 3), ("contact", 3, 3)]


def test_left_out_loads_no_solver():
    """Asking what is left out imports neither scikit-fem nor scipy, and nothing of sam but sam.scene."""
    code = (
        "import sys, fem_reference; fem_reference.plan; fem_reference.UnsupportedScene\nprint(*sys.modules)"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not [m for m in loaded if m.split(".")[0] in ("skfem", "scipy", "verification")]
    of_sam = {m for m in loaded if m.split(".")[0] == "sam" and not m.startswith("sam.scene.")}
    assert of_sam <= {"sam", "sam.arrays", "sam.scene"}


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="nothing"):
        fem_reference.nothing  # noqa: B018
