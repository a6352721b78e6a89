# SPDX-License-Identifier: MIT
"""The conditions of a worn body: they hold in its last cycle, and each sees what is wrong."""

import pytest
from made_results import with_field

from sam import choose_grid
from sam.scene import load_scene
from verification.cases.case import with_keys
from verification.cases.certificates import worn_certificates as study
from verification.checks import cells as cell_checks, conditions as contact_checks, film as film_checks
from verification.checks.certificates import solved
from verification.runs.models import SAM

LOOSE = 1e-4


@pytest.fixture(scope="module")
def worn():
    """Scene, result and records of two cycles, less exactly than the case solves them."""
    base = load_scene("verification/scenes/running-in-bulk.toml")
    scene = with_keys(study.scene_of(base, 2), "solver", tolerance=LOOSE)
    return scene, *solved(scene, SAM)


def test_heights_that_are_not_worn_and_strains_of_other_cycles_are_seen(worn):
    scene, result, records = worn
    before, loaded, _end = study.last_cycle(records)
    assert len(loaded) == scene.loading.steps and before.tree()["wear"]["depth"].any()
    less = with_field(result, "cell_data", "worn_m", lambda depth: 0.99 * depth)
    assert cell_checks.displaced(scene, study.lowered(less), loaded) > 1e-3
    assert film_checks.states(scene, loaded) > 1e-3  # strains since the first load
    through = contact_checks.flow(scene, records, choose_grid(scene).depths)  # also over the removal
    assert through["flow"] > 1e-2
