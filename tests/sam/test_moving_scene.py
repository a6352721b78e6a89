# SPDX-License-Identifier: MIT
"""Scenes with a counter-body that moves: what they are refused for, and the passes that all models share."""

from itertools import pairwise

import pytest
from builders import PATH, parsed, scene, scene_text
from hypothesis import given, strategies as st

from sam.planner.make import schedule_of
from sam.scene import Path, Scene, SceneError, Strokes, parse_scene, resolved


def test_all_that_a_path_excludes_is_told_at_once():
    text = scene_text(
        add=f"{PATH}[friction]\ncoefficient = 0.2\ndirection = 'alternating'\n[wear]\nstrain_limit = 1\n"
    )
    with pytest.raises(SceneError) as caught:
        parse_scene(text.encode(), "bad.toml")
    assert {"friction.direction", "wear"} <= {each.key for each in caught.value.problems}


TO_AND_FRO = PATH.replace("steps = 4", 'steps = 4, return = "to-and-fro"')


def test_a_scene_with_a_path_is_read_and_written():
    found = parsed(('"105 um"', '"105 um"\nslip = 0.5'), add=TO_AND_FRO)
    path = found.loading.path
    assert (path.start, path.end, path.steps, path.to_and_fro) == ((-9e-6, 0.0), (9e-6, 0.0), 4, True)
    assert found.counterbody.slip == 0.5
    assert resolved(found)["loading"]["path"]["return"] == "to-and-fro"
    assert Scene(**resolved(found)) == found


def test_steps_are_counted_in_radii_of_hertz():
    """a = (3 F R/(4 E*))^(1/3) = 6.053 um for this sphere: 18 um in steps of a/4 are 11.89, so 12."""
    found = parsed(add=PATH.replace("steps = 4", "step_per_radius = 4"))
    assert found.strokes.count == 12
    by_approach = parsed(
        ('force = "0.65 N"', 'approach = "0.349 um"'), add=PATH.replace("steps = 4", "step_per_radius = 4")
    )  # a^2/R
    assert by_approach.strokes.count == 12


@given(steps=st.integers(1, 40), cycles=st.integers(1, 6), back=st.booleans(), unload=st.booleans())
def test_a_pass_begins_where_the_load_is(steps, cycles, back, unload):
    """To and fro each pass begins where the last one ended; "lifted", at the start, where it is put on."""
    path = Path(
        start=(-1.0, 0.5), end=(2.0, 0.5), steps=steps, **{"return": "to-and-fro" if back else "lifted"}
    )
    strokes = Strokes(path, path.count(1.0), cycles, unload, with_motion=True)
    passes = [strokes.of_cycle(cycle) for cycle in range(1, cycles + 1)]
    for before, after in pairwise(passes):
        assert after.pressed is before.unloads is not back
        assert after.places[0] == (before.places[-1] if back else path.start)
        assert after.sign == (-before.sign if back else before.sign)
    assert passes[0].pressed and passes[-1].unloads is unload
    assert {len(each.places) for each in passes} == {steps + 1}
    assert all({each.places[0], each.places[-1]} == {path.start, path.end} for each in passes)


def test_the_steps_of_a_scene_to_and_fro():
    loading = {"force": 0.65, "steps": 2, "unload": True, "cycles": 2}
    path = {"start": (-9e-6, 0.0), "end": (9e-6, 0.0), "steps": 4, "return": "to-and-fro"}
    moving = scene(loading=loading | {"path": path}, friction={"coefficient": 0.1})
    schedule = schedule_of(moving)
    loads = [(t.cycle, t.step, round(t.load.x * 1e6, 9), t.load.force, t.load.sign) for t in schedule.targets]
    full = [(1, 2 + k, -9 + 4.5 * k, 0.65, 1.0) for k in range(5)]
    back = [(2, k, 9 - 4.5 * k, 0.65, -1.0) for k in range(1, 5)]
    assert loads == [(1, 1, -9.0, 0.325, 1.0), *full, *back, (2, 5, -9.0, 0.0, -1.0)]
    assert [t.step for t in schedule.targets if schedule.at_peak(t.cycle, t.step)] == [
        2,
        3,
        4,
        5,
        6,
        1,
        2,
        3,
        4,
    ]
    assert schedule.targets[-2].snapshot == "peak" and schedule.targets[-1].snapshot == "unloaded"


def test_friction_acts_along_a_motion_backwards():
    path = {"start": (9e-6, 0.0), "end": (-9e-6, 0.0), "steps": 4}
    moving = scene(loading={"force": 0.65, "path": path, "cycles": 2}, friction={"coefficient": 0.1})
    assert {target.load.sign for target in schedule_of(moving).targets} == {-1.0}
