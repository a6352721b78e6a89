# SPDX-License-Identifier: MIT
"""What the axisymmetric model returns: record, steps, cycles, statuses, estimates."""

import numpy as np
import pytest
from builders import MODULUS, PERFECT, RADIUS, SHAPES, SPHERE, hertz_force, scene as small_scene
from rounding import close

import fem_reference
from fem_reference.axisymmetric import planner
from fem_reference.common.bodies import expected_radius
from fem_reference.common.contact import ActiveSet
from fem_reference.common.hertz import force_of_approach
from sam.scene.result import COLUMNS, COST, QUANTITIES, Status

PUNCH = {"shape": "punch", "radius": RADIUS}


def scene(cells=8, counter=SPHERE, *, poisson=0.3, plasticity=None, **loading):
    return small_scene(
        body={"poisson": poisson, "plasticity": plasticity},
        counterbody=counter,
        loading=loading,
        fem={"cells_per_radius": cells},
    )


def test_record_is_complete():
    result = fem_reference.solve(scene(unload=True, cycles=2))
    assert result.model == "fem-axisymmetric" and tuple(result.quantities) == QUANTITIES
    assert result.quantities["p_max_change"] is None and result.quantities["mises_max_film_Pa"] is None
    assert tuple(result.cost) == (*COST, "factorizations", "linear_iterations")
    assert set(result.tables) == {"history", "axis", "line", "plane", "cycles", "residuals"}
    for name, table in result.tables.items():
        assert tuple(table) == COLUMNS[name] and len({len(column) for column in table.values()}) == 1
    for name in ("axis", "line", "plane"):
        assert list(dict.fromkeys(result.tables[name]["state"])) == ["peak", "unloaded"]
    assert result.message == "" and result.cost["contact_iterations"] >= 1
    assert {"dofs", "elements", "h_m", "box_m", "cells_per_radius"} <= set(result.discretisation)
    assert max(result.certificate.values()) < 1e-8
    mesh = result.fields
    assert mesh.points[:, 1].max() == 0.0
    assert mesh.point_data["p_Pa"].max() == pytest.approx(result.quantities["p_max_Pa"], rel=1e-12)
    assert mesh.cell_data["stress_Pa"].shape == (len(mesh.cells["quad"]), 6)
    assert mesh.cell_data["mises_Pa"].max() < result.quantities["mises_max_Pa"]
    corners = mesh.points[mesh.cells["quad"]]
    x, z = corners[..., 0], corners[..., 2]
    area = 0.5 * np.abs(np.sum(x * np.roll(z, -1, axis=1) - np.roll(x, -1, axis=1) * z, axis=1))
    assert area.sum() == pytest.approx(result.discretisation["box_m"] ** 2, rel=1e-12)


def test_a_punch_is_singular_and_has_no_gap_beside_it():
    result = fem_reference.solve(scene(counter=PUNCH))
    line = {name: np.asarray(values) for name, values in result.tables["line"].items()}
    beside = line["x_m"] > RADIUS * (1 + 1e-12)
    assert result.quantities["contact_radius_m"] == RADIUS
    assert not line["p_Pa"][beside].any() and np.isnan(line["gap_m"][beside]).all()
    assert any("singular" in warning for warning in result.warnings)
    assert max(result.certificate.values()) < 1e-8


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
    assert result.quantities["residual_uz_center_m"] == result.quantities["residual_mises_max_Pa"] == 0.0
    assert result.tables["cycles"]["p_max_Pa"] == [result.quantities["p_max_Pa"]] * 3
    line = result.tables["line"]
    after = line["state"] == "unloaded"
    assert line["gap_m"][after] == close(line["x_m"][after] ** 2 / (2 * RADIUS), 1e-12)
    assert fem_reference.solve(scene()).quantities["residual_uz_center_m"] is None


@pytest.mark.parametrize("made", [scene(force=0.0), scene(counter=PUNCH, force=0.0, steps=2, unload=True)])
def test_no_force(made):
    result = fem_reference.solve(made)
    assert result.status is Status.CONVERGED
    q, zero = result.quantities, ("force_N", "approach_m", "contact_area_m2", "p_max_Pa", "mises_max_Pa")
    assert [q[name] for name in zero] == [0.0] * len(zero) and q["mises_max_depth_m"] is None
    assert not any(result.tables["history"]["force_N"]) and not result.tables["line"]["p_Pa"].any()
    assert not result.tables["plane"]["mises_Pa"].any() and np.isfinite(result.tables["axis"]["z_m"]).all()


# --- statuses ---


@pytest.mark.parametrize("counter", [SPHERE, PUNCH])
def test_status_under_resolved(counter):
    coarse, fine = (fem_reference.solve(scene(n, counter)) for n in (3, 4))
    assert coarse.status is Status.UNDER_RESOLVED and "fem.cells_per_radius" in coarse.message
    assert fine.status is Status.CONVERGED


@pytest.mark.parametrize(
    ("core", "keys"),
    [("ELASTIC", {}), ("plastic_core", {"plasticity": PERFECT, "force": hertz_force(4e9), "steps": 4})],
)
def test_status_contact_at_the_edge_of_the_fine_mesh(monkeypatch, core, keys):
    small = planner.Core(0.9, 0.8)
    monkeypatch.setattr(planner, core, small if core == "ELASTIC" else lambda radius: small)
    result = fem_reference.solve(scene(**keys))
    assert result.status is Status.CONTACT_AT_GRID_EDGE and "loading.force" in result.message


def test_status_plastic_zone_at_the_edge():
    made = scene(4, plasticity=PERFECT, force=hertz_force(6e9), steps=10)
    made = made.model_copy(update={"fem": made.fem.model_copy(update={"box": 2.6})})
    result = fem_reference.solve(made)
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE and "fem.box" in result.message


def test_status_not_converged(monkeypatch):

    def restless(self, _multipliers, _gaps):
        self.stuck = True
        return True

    monkeypatch.setattr(ActiveSet, "update", restless)
    result = fem_reference.solve(scene())
    assert result.status is Status.NOT_CONVERGED and "did not settle" in result.message


# --- estimates, which set meshes ---

APPROACH = 2e-7
FLAT = SHAPES["rounded-punch"] | {"radius": RADIUS}


def law(slope):
    return (
        {"law": "linear", "yield_stress": 1e8, "modulus": slope} if slope else PERFECT | {"yield_stress": 1e8}
    )


@pytest.mark.parametrize("slope", [0.0, 1e10])
def test_the_estimated_force_ends_at_three_yield_stresses_below_the_surface(slope):
    """Of hardening steel at the representative strain 0.2 sqrt(2 R d)/R (Tabor); of an edge too."""
    beyond = np.sqrt(2 * RADIUS * APPROACH)
    for counter, area in ((SPHERE, np.pi * beyond**2), (FLAT, np.pi * (FLAT["flat_radius"] + beyond) ** 2)):
        wanted = 3 * area * (1e8 + slope * 0.2 * beyond / RADIUS)
        made = small_scene(body={"plasticity": law(slope)}, counterbody=counter)
        assert force_of_approach(made, APPROACH) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(
    ("thickness", "modulus", "punch"),
    [
        (1e-12, MODULUS, False),
        (1e-3, 80e9 / (1 - 0.2**2), False),
        (None, MODULUS, False),
        (None, MODULUS, True),
    ],
)
def test_the_estimated_force_of_an_elastic_body_is_that_of_hertz_or_of_a_punch(thickness, modulus, punch):
    """With a coating that of its material or of the body's, where the other does not count."""
    coating = thickness and {"thickness": thickness, "young": 80e9, "poisson": 0.2}
    made = small_scene(body={"coating": coating}, counterbody=PUNCH if punch else SPHERE)
    wanted = 2 * modulus * RADIUS * APPROACH if punch else 4 / 3 * modulus * np.sqrt(RADIUS) * APPROACH**1.5
    assert force_of_approach(made, APPROACH) == pytest.approx(wanted, rel=1e-6)


def test_the_expected_radius_of_a_coated_contact_is_between_those_of_the_materials():
    """a^3 is as the compliance."""
    for thickness, ratio in ((1e-12, 1.0), (1e-3, 80e9 / (1 - 0.2**2) / MODULUS)):
        coating = {"thickness": thickness, "young": 80e9, "poisson": 0.2}
        made = small_scene(body={"coating": coating})
        assert expected_radius(made) == pytest.approx(ratio ** (-1 / 3), rel=1e-5)
