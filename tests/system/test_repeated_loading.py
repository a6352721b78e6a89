# SPDX-License-Identifier: MIT
"""A body with back-stresses under a Hertz pressure that comes and goes, in both models: what a result holds
of them, and nothing of them without the table. Limits and verdicts are rows of `repeated-loading`.
"""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.common.back_stress import KinematicJ2
from sam.plasticity.flow import KinematicFlow
from sam.plasticity.model import Progressed
from sam.scene import Scene
from sam.scene.verdict import ORDER
from verification.runs.models import FEM, SAM, solve

YIELD, MELAN = 1e9, 3.2256  # Pa; limit of shakedown, in yield stresses
PRAGER = {"modulus": (210e9 / 19,)}


def pressed(p0, kinematic, **loading):
    """A given pressure of Hertz on a body of yield stress 1 GPa, four cycles."""
    plasticity = {"law": "perfect", "yield_stress": YIELD, "kinematic": kinematic}
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        loading={"prescribed": "hertz", "p0": p0, "radius": 1e-5, "steps": 3, "unload": True, "cycles": 4}
        | loading,
        grid={"cells": (21, 21), "extent": (5e-5, 5e-5), "layers": 14, "depth": 3.4e-5},
        fem={"cells_per_radius": 4, "box": 6.0},
        solver={"tolerance": 1e-4},
    )


def test_with_pragers_law_the_back_stress_follows_the_plastic_strain():
    """a = eps_p in every cell and component, shears of both halves of a mirrored box included."""
    kept = []
    solve(pressed(1.15 * MELAN * YIELD, PRAGER), SAM, checkpoint=kept.append)
    material = kept[-1].record(Progressed).state.material.points
    assert np.abs(material.strain[3:]).max() > 1e-3
    assert np.abs(material.back[0] - material.strain).max() < 1e-12


@pytest.mark.parametrize("model", [SAM, FEM])
def test_fields_and_table_of_a_body_that_alternates_say_the_same(model):
    """15 % beyond Melan's limit the body yields in every cycle."""
    result = solve(pressed(1.15 * MELAN * YIELD, PRAGER, cycles=5), model)
    table = result.tables["cycles"]
    assert result.verdict["class"] == "alternating" and table["flowing_volume_m3"][-1] > 0
    assert "ratchetting" not in table["verdict"] and not max(table["ratchetting_volume_m3"])
    for fields in fields_of(result):
        assert largest(fields["strain_step"]) <= largest(fields["peeq_step"])
        at = np.nanargmax(fields["peeq_step"])
        assert np.ravel(fields["class"])[at] == ORDER.index("alternating")
        assert set(np.unique(np.nan_to_num(fields["class"]))) <= set(range(len(ORDER)))
        back = 2 / 3 * PRAGER["modulus"][0] * np.asarray(fields["plastic_strain"])
        assert largest(np.abs(fields["back_stress_Pa"] - back)) < 1e-9 * largest(back)


def fields_of(result):
    """The arrays with the strain in all meshes of a result: of the elements, or of the plane and the box."""
    if result.bodies:
        return [mesh.cell_data for mesh in result.bodies.values()]
    parts = [parts[name] for parts in result.grids.values() for name in ("plane", "body")]
    return [result.fields.point_data, *(dict(each.point_data) | dict(each.cell_data) for each in parts)]


def largest(field):
    """Its largest value; SAM has no stresses on the surface."""
    return float(np.nanmax(field))


@pytest.mark.parametrize("model", [SAM, FEM])
@pytest.mark.parametrize("kinematic", [None, PRAGER], ids=["without", "with"])
def test_without_the_table_there_is_no_back_stress_at_all(model, kinematic, monkeypatch):
    """No array of it in a checkpoint, its return map is not called, no table or mesh has a value of it."""
    calls, kept = [], []
    for owner in (KinematicFlow, KinematicJ2):
        monkeypatch.setattr(owner, "returned", counted(owner.returned, calls))
    result = solve(pressed(3e9, kinematic, steps=1), model, checkpoint=kept.append)
    names = {name for each in kept for name in each.arrays}
    fields = {name for each in fields_of(result) for name in each}
    assert result.quantities["peeq_max"] > 1e-3
    assert bool(calls) == any("back" in name for name in names) == (kinematic is not None)
    assert ("back_stress_Pa" in fields) == ("verdict" in result.tables["cycles"]) == (kinematic is not None)


def counted(function, calls):
    """The function, and a note of each of its calls."""
    return lambda *given, **keys: (calls.append(1), function(*given, **keys))[1]


def test_a_body_that_yields_nowhere_is_elastic():
    """At 1 GPa, below first yield at 1.6 times the yield stress: said with every number, in every row."""
    for model in (SAM, FEM):
        result = solve(pressed(1e9, PRAGER), model)
        assert (result.verdict["class"], result.verdict["decided_at_cycle"]) == ("elastic", 1)
        assert result.verdict["trend"] is None and result.verdict["peeq_per_period"] == 0.0
        assert list(result.tables["cycles"]["peeq_step_max"]) == [0.0] * 4
