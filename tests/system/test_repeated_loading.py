# SPDX-License-Identifier: MIT
"""A body with back-stresses under a Hertz pressure that comes and goes: both models, and Melan's limit.

Perfect plasticity with Prager's back-stress shakes down exactly where the elastic stress deviators of the
path lie in a ball of the yield stress (Melan); pressed in place that is twice the load of first yield: p0 =
3.2256 sigma_y for nu = 0.3, below the surface.
"""

from __future__ import annotations

import numpy as np
import pytest

from fem_reference.common.back_stress import KinematicJ2
from sam.plasticity.flow import KinematicFlow
from sam.plasticity.progress import Progressed
from sam.scene import Scene
from sam.scene.verdict import ORDER
from verification.runs.models import FEM, SAM, solve

YIELD = 1e9
MELAN = 3.2256


def pressed(p0, kinematic, **loading):
    """A given pressure of Hertz on a body of yield stress 1 GPa, four cycles."""
    plasticity = {"law": "perfect", "yield_stress": YIELD, "kinematic": kinematic}
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": plasticity},
        loading={"prescribed": "hertz", "p0": p0, "radius": 1e-5, "steps": 3, "unload": True, "cycles": 4}
        | loading,
        grid={"cells": (25, 25), "extent": (5e-5, 5e-5), "layers": 20, "depth": 3.4e-5},
        fem={"cells_per_radius": 6, "box": 6.0},
        solver={"tolerance": 1e-4},
    )


PRAGER = {"modulus": (210e9 / 19,)}
CHABOCHE = {"modulus": (150e9, 11e9), "recovery": (300.0, 0.0)}


@pytest.mark.parametrize("model", [SAM, FEM])
def test_below_melans_limit_the_second_cycle_strains_nothing(model):
    """3 % below: exactly elastic from the second cycle on in SAM, to the residual of equilibrium in FEM."""
    result = solve(pressed(0.97 * MELAN * YIELD, PRAGER), model)
    added = np.array(result.tables["cycles"]["peeq_step_max"])
    assert added[0] > 0.01 and added[1:].max() <= (0.0 if model == SAM else 1e-9)
    assert result.verdict["class"] == "shakedown"


def test_beyond_it_both_models_alternate():
    """15 % beyond Melan's limit the body yields in every cycle, and the strain of a cycle closes."""
    scene = pressed(1.15 * MELAN * YIELD, PRAGER, cycles=5)
    for model in (SAM, FEM):
        result = solve(scene, model)
        table = result.tables["cycles"]
        assert result.verdict["class"] == "alternating"
        assert np.array(table["peeq_step_max"][1:]) == pytest.approx(table["peeq_step_max"][-1], rel=0.1)
        assert "ratchetting" not in table["verdict"] and not max(table["ratchetting_volume_m3"])
        assert table["flowing_volume_m3"][-1] > 0 and result.verdict["trend"] == "steady"
        for fields in fields_of(result):
            assert largest(fields["peeq_step"]) == pytest.approx(table["peeq_step_max"][-1], rel=0.2)
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


def test_chaboches_law_strains_in_both_models():
    """With a back-stress that recovers the first cycles strain on and on, less in each."""
    scene = pressed(1.15 * MELAN * YIELD, CHABOCHE)
    for model in (SAM, FEM):
        added = np.array(solve(scene, model).tables["cycles"]["peeq_step_max"])
        assert (np.diff(added) < 0).all() and added[-1] > 1e-4


def test_with_pragers_law_the_back_stress_follows_the_plastic_strain():
    """a = eps_p in every cell and component, shears of both halves of a mirrored box included."""
    kept = []
    solve(pressed(1.15 * MELAN * YIELD, PRAGER), SAM, checkpoint=kept.append)
    material = kept[-1].record(Progressed).state.material
    assert np.abs(material.strain[3:]).max() > 1e-3
    assert np.abs(material.back[0] - material.strain).max() < 1e-12


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


def sheared_layer(thickness):
    """A pressure of Hertz and its traction come and go on a soft layer on an elastic body. thickness: in
    contact radii.
    """
    kinematic = {"modulus": (120e9,), "recovery": (200.0,)}
    layer = {"law": "perfect", "yield_stress": 0.46e9, "kinematic": kinematic}
    hard = {"law": "perfect", "yield_stress": 20e9, "layer_thickness": 1e-5 * thickness, "layer": layer}
    return Scene(
        body={"young": 210e9, "poisson": 0.3, "plasticity": hard},
        loading={"prescribed": "hertz", "p0": 2e9, "radius": 1e-5, "steps": 3, "unload": True, "cycles": 10},
        friction={"coefficient": 0.25},
        grid={
            "cells": (17, 17),
            "extent": (3.4e-5, 3.4e-5),
            "depths": tuple(1e-5 * thickness * np.array([0, 0.5, 1, 2, 4, 8, 16, 32])),
        },
        solver={"verdict": True},
    )


def test_a_thin_layer_that_is_sheared_ratchets():
    """Its mean shear stress is that of the traction, and no residual stress takes it from so thin a layer:
    it creeps forward in each cycle. What a tenth of the radius is thick piles up against the rest of the
    body, so that its strain falls: undecided, and never a ratchet.
    """
    thin = solve(sheared_layer(0.005), SAM)
    strain = np.array(thin.tables["cycles"]["strain_step_max"])
    assert thin.verdict["class"] == "ratchetting" and thin.verdict["periods_to_decide"] is None
    assert strain[-1] > 1e-3 and strain[-1] == pytest.approx(strain[1], rel=0.1)
    thick = solve(sheared_layer(0.1), SAM)
    falling = np.array(thick.tables["cycles"]["strain_step_max"][1:])
    assert (np.diff(falling) < 0).all() and "ratchetting" not in thick.tables["cycles"]["verdict"]
    assert thick.verdict["class"] != "undecided" or thick.verdict["periods_to_decide"] > 0
