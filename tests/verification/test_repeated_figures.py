# SPDX-License-Identifier: MIT
"""Figures and the table loops of repeated loading, of both models on few cells."""

from __future__ import annotations

import pytest

from tests.system.test_repeated_loading import MELAN, PRAGER, YIELD, pressed
from verification.figures.check import findings
from verification.figures.repeated import drawings_of
from verification.figures.run import drawings_of as drawings_of_run
from verification.runs.files import read_run, write_run
from verification.runs.models import FEM, SAM, solve


@pytest.fixture(scope="module", params=[SAM, FEM])
def run(request, tmp_path_factory):
    """A body that alternates, four cycles in two steps and back."""
    scene = pressed(1.4 * MELAN * YIELD, PRAGER, cycles=4, steps=2)
    grid = scene.grid.model_copy(update={"cells": (13, 13), "layers": 10})
    fem = scene.fem.model_copy(update={"cells_per_radius": 3})
    scene = scene.model_copy(update={"grid": grid, "fem": fem})
    folder = tmp_path_factory.mktemp("run")
    write_run(solve(scene, request.param), scene, folder)
    return read_run(folder)


def test_every_figure_can_be_read_and_has_its_numbers(run):
    drawings = drawings_of(run)
    assert list(drawings) == ["strain-per-period", "loops", "classes"]
    if run.model == FEM:  # the other figures of SAM take longer
        assert set(drawings) < set(drawings_of_run(run))
    for drawing in drawings.values():
        assert findings(drawing.figure) == []
    assert list(drawings["strain-per-period"].data["period"]) == [1, 2, 3, 4]
    assert drawings["strain-per-period"].data["class"][-1] == "alternating"
