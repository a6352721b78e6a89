# SPDX-License-Identifier: MIT
"""What the cases of periodic patches take of results, on results made by hand."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import verification
from sam.scene import read_scene
from verification.cases.case import with_loading
from verification.cases.periodic import area_over_load, lateral, periodic_peers
from verification.cases.recipes import load_ratio
from verification.cases.sweep import Measured
from verification.peers.running import SAM, TAMAAS
from verification.references import double_wave, wave

SCENE, _ = read_scene(Path(verification.__file__).with_name("scenes") / "wavy-periodic.toml")


def test_held_sides_keep_what_hooke_says_and_free_ones_nothing():
    strain = np.zeros((6, 4, 2, 3))
    strain[:2, 1] = np.array([2e-3, -4e-4])[:, None, None]  # a quarter of the patch has it
    nu, pressure = 0.3, SCENE.loading.mean_pressure
    stress = np.zeros_like(strain)
    stress[0], stress[1] = (-210e9 / (1 - nu**2) * (e + nu * f) for e, f in ((5e-4, -1e-4), (-1e-4, 5e-4)))
    loaded = stress.copy()
    loaded[:2] -= nu / (1 - nu) * pressure
    grids = {
        state: {
            "body": SimpleNamespace(z=np.arange(4.0), cell_data={"stress_Pa": s, "plastic_strain": strain})
        }
        for state, s in (("peak", loaded), ("unloaded", stress))
    }
    result = SimpleNamespace(grids=grids)
    held, free = (with_loading(SCENE, lateral=name) for name in ("held", "free"))
    assert lateral.off_hand(held, result, None) < 1e-12
    assert lateral.off_hand(free, result, None) == pytest.approx(1.0, rel=1e-12)
    found: Measured = lateral.mean_stress(held, result, None)
    np.testing.assert_allclose(found.value, found.expected, rtol=1e-12)
    grids["unloaded"]["body"].cell_data["stress_Pa"] = 1.01 * stress
    assert lateral.off_hand(held, result, None) == pytest.approx(0.01 / 1.01)


def test_loads_of_waves_are_those_of_their_exact_contact():
    exact = wave(SCENE)
    assert load_ratio(SCENE, 0.5).loading.mean_pressure == pytest.approx(0.5 * exact.units["p0"], rel=1e-12)
    surface = SCENE.surface.model_copy(update={"wavelength_y": 20e-6})
    grid = SCENE.grid.model_copy(update={"cells": (32, 32), "extent": (20e-6, 20e-6)})
    scene = load_ratio(SCENE.model_copy(update={"surface": surface, "grid": grid}), 1.1)
    found = double_wave(scene)
    assert found.values["share"] == 1.0 and found.values["area"] == pytest.approx(4e-10)
    largest = found.units["p0"] * (1.1 + np.cos(np.pi / 32) ** 2)
    assert found.values["p-max"] == pytest.approx(largest, rel=1e-12)


def test_rows_take_where_the_area_departs_and_times_within_the_error():
    rows = pd.DataFrame({"index": [1.0, 2.0, 4.0], "over": [1.0, 1.0, 1.1], "kappa": [2.0, 2.2, 2.4]})
    assert area_over_load.departs(rows, "over") == pytest.approx(2 * 2**0.5)
    assert area_over_load.bar(rows, "kappa") == pytest.approx(0.2 / 3**0.5)
    times = pd.DataFrame(
        {
            "model": [SAM, SAM, TAMAAS, TAMAAS],
            "seconds": [1.0, 2.0, 8.0, 30.0],
            "error": [1e-3, 1e-5, 1e-3, 1e-6],
        }
    )
    assert periodic_peers.tamaas_over_sam(times, "seconds") == 15.0
