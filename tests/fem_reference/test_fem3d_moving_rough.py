# SPDX-License-Identifier: MIT
"""Rough bodies and a rough counter-body that moves, in three dimensions: as at rest in each place, and as SAM
has it.
"""

import numpy as np
import pytest
from builders import STEEL

import sam
from fem_reference import spatial
from sam.scene import HeightMap, Scene

SIDE, CELLS = 8e-6, 10
CELL, FORCE, MU = SIDE / CELLS, 0.012, 0.2
WAVE = {"kind": "sinusoid", "amplitude": 20e-9, "wavelength_x": 2 * SIDE, "wavelength_y": 2 * SIDE}
HILL = WAVE | {"amplitude": 10e-9}
ELLIPSOID = {"shape": "ellipsoid", "radius_x": 400e-6, "radius_y": 300e-6}
PATH = {"start": (-1.5 * CELL, 0.0), "end": (1.5 * CELL, 0.0), "steps": 3}


def rough(counter=None, *, body=None, plasticity=None, friction=MU, **loading) -> Scene:
    """A plane with a wave, if no other counter-body is given, that slides three cells over 10 x 10."""
    loading = {"force": FORCE, "steps": 1, "unload": True, "path": PATH} | loading
    return Scene(
        body={**STEEL, "plasticity": plasticity},
        counterbody=counter or {"shape": "flat", "surface": WAVE},
        surface=body,
        loading={name: value for name, value in loading.items() if value is not None},
        friction={"coefficient": friction} if friction else None,
        grid={"cells": (CELLS, CELLS), "extent": (SIDE, SIDE)},
        fem={"box": 4},
        solver={"tolerance": 1e-4},
    )


def pressure(result) -> np.ndarray:
    """Of the peak in Pa, (CELLS, CELLS)."""
    table = result.tables["surface"]
    peak = np.array(table["state"]) == "peak"
    return np.array(table["p_Pa"])[peak].reshape(CELLS, CELLS)


@pytest.fixture(scope="module")
def elastic():
    """Of a plane with a wave on an elastic body, both models."""
    return [solve(rough()) for solve in (spatial.solve, sam.solve)]


def test_the_contact_is_that_of_a_counter_body_at_rest_with_those_heights(elastic):
    """The same discrete problem: each within EQUILIBRIUM of the force. Its heights are in the table."""
    moved, end = elastic[0], rough().counter_strip.at(0, PATH["end"])
    at_rest = {"shape": "flat", "surface": {"kind": "file", "path": HeightMap(end, (SIDE, SIDE))}}
    still = spatial.solve(rough(at_rest, path=None))
    assert moved.converged and still.converged
    np.testing.assert_allclose(pressure(moved), pressure(still), atol=1e-6 * pressure(still).max())
    assert not np.allclose(pressure(moved), pressure(moved)[::-1], atol=0.1 * pressure(moved).max())
    heights = np.array(moved.tables["surface"]["counterbody_height_m"])[: CELLS**2]
    np.testing.assert_allclose(heights, end.ravel(), atol=1e-12 * np.ptp(end))


def test_the_wave_carries_its_pressure_as_in_sam(elastic):
    """Cells of a sixth of the contact: pressure within 5 %, the rest within 1 % of each model's own."""
    fem, other = (
        {name: np.array(each.tables["history"][name])[:-1] for name in each.tables["history"]}
        for each in elastic
    )
    assert fem["s_m"] == pytest.approx(other["s_m"], abs=1e-15)
    assert fem["p_max_Pa"] == pytest.approx(other["p_max_Pa"], rel=0.05)
    assert fem["approach_m"] == pytest.approx(other["approach_m"], rel=0.01)
    assert fem["pressure_offset_m"] == pytest.approx(other["pressure_offset_m"], abs=0.02 * CELL)
    assert np.diff(fem["pressure_offset_m"]) == pytest.approx(CELL, rel=0.02)
    assert fem["fx_N"] == pytest.approx(other["fx_N"], rel=1e-3)
    assert np.abs(fem["fx_N"] / FORCE / MU - 1.0).max() < 2e-3  # a crest in equilibrium, at any place


def test_an_ellipsoid_over_a_hill_is_driven_as_in_sam():
    """It climbs and descends: the force on its slope to 3 % of the largest, without friction."""
    made = rough(ELLIPSOID, body=HILL, friction=0.0)
    fem, other = (solve(made).tables["history"] for solve in (spatial.solve, sam.solve))
    assert np.array(fem["fx_N"]) == pytest.approx(
        np.array(other["fx_N"]), abs=0.03 * np.abs(other["fx_N"]).max()
    )
    assert fem["pressure_offset_m"][:-1] == pytest.approx(other["pressure_offset_m"][:-1], abs=0.05 * CELL)
    assert fem["approach_m"][:-1] == pytest.approx(other["approach_m"][:-1], rel=0.02)


def test_a_body_that_yields_has_a_row_for_the_pass():
    """Every place counts as steady below a plane: the largest new strain is that of the history, within 15 %
    of SAM as so few cells leave it.
    """
    law = {"law": "linear", "yield_stress": 0.5e9, "modulus": 10e9}
    fem, other = (
        solve(rough(plasticity=law, path=PATH | {"steps": 1})) for solve in (spatial.solve, sam.solve)
    )
    for each in (fem, other):
        assert each.converged
        passes = each.tables["passes"]
        assert passes["pass"] == [1] and np.isnan(passes["groove_m"]).all()
        assert passes["new_strain_max"][0] == pytest.approx(each.tables["history"]["peeq_max"][-1], rel=0.15)
    assert fem.tables["passes"]["fx_mean_N"] == pytest.approx(other.tables["passes"]["fx_mean_N"], rel=0.01)
    assert "track" not in fem.tables
    assert fem.quantities["peeq_max"] == pytest.approx(other.quantities["peeq_max"], rel=0.15)
