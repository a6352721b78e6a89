# SPDX-License-Identifier: MIT
"""Sweeps over depth against the matrices between all layers."""

import numpy as np
import pytest
from builders import SWIFT, running_in, scene
from made_results import column as of_state

import sam
from sam.contact.convolution import Counters
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity.spectra import SINGLE, BoxOperator
from sam.plasticity.swept import neighbours

EVEN, GRADED = np.arange(7.0), np.append(0.0, np.cumsum(0.3 * 1.5 ** np.arange(6)))
TWO = np.append(np.arange(5.0) / 4, np.arange(2.0, 9.0))


@pytest.mark.parametrize(
    ("faces", "n", "error", "nu", "kind"),
    [
        (EVEN, 8, 1e-4, 0.5, {"tolerance": SINGLE}),
        (GRADED, 8, 1e-4, 0.3, {"mirror": (False, True)}),
        (TWO, 8, 1e-4, 0.0, {}),
        (np.arange(19.0) / 2, 8, 1e-4, 0.3, {"mirror": (True, True), "exchange": True}),
        (np.arange(14.0), 16, 1e-6, 0.0, {}),
        (np.append(0.0, np.cumsum(0.4 * 1.25 ** np.arange(8))), 16, 1e-6, 0.5, {}),
    ],
    ids=["even", "graded", "two", "many", "even, small error", "graded, small error"],
)
def test_swept_stress_is_that_of_the_matrices(faces, n, error, nu, kind):
    """To the stated error, without images of the period and with the waves shorter than the cells."""
    box = Cuboids(Lags(n, n, 1.0, 1.0 if "exchange" in kind else 0.7), tuple(faces), nu)
    dense, swept = (BoxOperator(box, 1.0, Counters(), swept=each, **kind) for each in (0.0, error))
    strain = dense.keep(np.random.default_rng(1).standard_normal((6, len(faces) - 1, n, n)))
    if "exchange" in kind:
        strain = strain + strain[[1, 0, 2, 4, 3, 5]].swapaxes(-1, -2)
    expected, found = (on.stress(None, on.response(on.transformed(strain))) for on in (dense, swept))
    assert np.linalg.norm(found - expected) <= error * np.linalg.norm(strain)


@pytest.mark.parametrize("error", [0.5, 1e-3])
@pytest.mark.parametrize("faces", [EVEN, GRADED, TWO], ids=["even", "graded", "two"])
def test_layers_near_each_other_have_the_coefficients_of_cells(faces, error):
    """Less than log(8/error)/pi cells apart, or from the mirror image of the first; equal ones are a run."""
    reach, (runs, top) = np.log(8 / error) / np.pi, neighbours(faces, error)
    layers = range(len(faces) - 1)
    found = [(i, i + d) for run in runs for i in layers[run.first :][: run.count] for d in sorted(run.keys)]
    gap = np.subtract.outer(faces[:-1], faces[1:])
    near = np.argwhere(np.maximum(gap, gap.T) < reach).tolist()
    assert [[i, j] for i, j in found if j in layers] == near
    assert top == np.count_nonzero(faces[:-1] < reach) and (faces is not EVEN or len(runs) == 1)


def test_stresses_beside_a_large_box_are_those_of_its_coefficients(monkeypatch):
    """In y = 0, at centres: an error of .1 % two cells beside strained ones."""
    depths = tuple(np.linspace(0, 4e-6, 8))
    scene = running_in(cycles=1, steps=1, film=None, wear=None)
    scene = scene.model_copy(update={"grid": scene.grid.model_copy(update={"depths": depths})})
    by_size = sam.solve(scene)
    monkeypatch.setattr("sam.plasticity.box.MOST_BYTES", 0)
    swept = sam.solve(scene)
    box = by_size.discretisation["plastic_box_cells"]
    mises, found = (of_state(each, "plane", "mises_Pa", "unloaded") for each in (by_size, swept))
    assert box == swept.discretisation["plastic_box_cells"] and max(box) < 24
    assert mises.max() > 1e8
    np.testing.assert_allclose(found, mises, rtol=0, atol=1e-3 * mises.max())


def test_stresses_beside_a_box_are_swept_only_where_the_box_is(monkeypatch):
    """Below a sphere x and y are exchanged, and half of the matrices are stored."""
    grid = {"cells": (25, 25), "extent": (30e-6, 30e-6)}
    sphere = scene(body={"plasticity": SWIFT}, grid=grid, loading={"force": 0.3, "steps": 1})
    found = sam.solve(sphere)
    monkeypatch.setattr("sam.plasticity.box.MOST_BYTES", 1.5 * found.discretisation["operator_bytes"])
    monkeypatch.setattr("sam.plasticity.measure._swept_stress", None)
    again = sam.solve(sphere)
    assert max(found.discretisation["plastic_box_cells"]) < 25 and found.quantities["peeq_max"] > 0
    assert again.quantities == found.quantities
