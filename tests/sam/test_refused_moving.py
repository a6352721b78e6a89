# SPDX-License-Identifier: MIT
"""Values that a key of a counter-body that moves cannot have: each is named with its key."""

import pytest
from builders import PATH, scene_text

from sam.scene import SceneError, parse_scene

SLIP = ('"105 um"', '"105 um"\nslip = {}')
SURFACE = (
    '[counterbody.surface]\nkind = "self-affine"\nsq = "10 nm"\ncutoff_long = "9 um"\ncutoff_short = "3 um"\n'
)
SURFACE += "hurst = 0.8\nseed = 3\n"
GRID = '[grid]\ncells = [40, 40]\nextent = ["40 um", "40 um"]\n'
OF_PATH = {
    "start": ("[1, 2]", '"9 um"', '["9 um"]', '["9 um", "0 um", "0 um"]', '["9 GPa", "0 um"]', "true", "[]"),
    "end": ("[1, 2]", '["9 um", nan]', '["inf um", "0 um"]', '["9 parsec", 0]', '[["9 um"], "0 um"]', "{}"),
    "steps": ("0", "-1", "1001", "1.5", '"4"', "true", "[4]", "nan"),
}
OF_SLIP = ("-0.1", "1.5", "nan", '"1"', "true", "[1]")
OF_SURFACE = {
    "renew": ('"yes"', "1", "[]"),
    "kind": ('"smooth"', "3"),
    "seed": ("-1", "1.5", '"3"'),
    "sq": ("10e-9", '"10 GPa"', '"-1 nm"'),
}


def told(text: str) -> str:
    with pytest.raises(SceneError) as caught:
        parse_scene(text.encode(), "bad.toml")
    return str(caught.value)


@pytest.mark.parametrize("key, value", [(key, value) for key, values in OF_PATH.items() for value in values])
def test_of_the_path(key, value):
    given = {"start": '["-9 um", "0 um"]', "end": '["9 um", "0 um"]', "steps": "4"} | {key: value}
    path = ", ".join(f"{name} = {each}" for name, each in given.items())
    assert f"loading.path.{key}" in told(scene_text(add=f"path = {{ {path} }}\n"))


@pytest.mark.parametrize(
    "words",
    ['return = "back"', "return = true", "step_per_radius = 0.5", "step_per_radius = inf", "speed = 1"],
)
def test_of_other_keys_of_the_path(words):
    path = PATH.replace("steps = 4", f"steps = 4, {words}")
    assert f"loading.path.{words.split()[0]}" in told(scene_text(add=path))


@pytest.mark.parametrize("value", OF_SLIP)
def test_of_the_slip(value):
    assert "counterbody.slip" in told(scene_text((SLIP[0], SLIP[1].format(value)), add=PATH))


@pytest.mark.parametrize(
    "key, value", [(key, value) for key, values in OF_SURFACE.items() for value in values]
)
def test_of_the_counter_surface(key, value):
    lines = [line for line in SURFACE.splitlines() if not line.startswith(f"{key} =")]
    text = "\n".join([*lines, f"{key} = {value}"])
    assert f"counterbody.surface.{key}" in told(scene_text(add=f"{PATH}{text}\n{GRID}"))


@pytest.mark.parametrize(
    "old, new, words",
    [
        (
            "start = ",
            "begin = ",
            "path.start is missing: required: a list of 2, each a coordinate as a string",
        ),
        ('force = "0.65 N"', 'force = "0 N"', 'loading.force = "0 N": above 0 with loading.path'),
        ('force = "0.65 N"', 'force = "1e-25 N"', "loading.path.step_per_radius = 3: at most"),
    ],
)
@pytest.mark.parametrize("surface", ["", SURFACE + GRID])
def test_a_path_without_places(surface, old, new, words):
    text = scene_text(add=f"{PATH.replace('steps = 4', 'step_per_radius = 3')}{surface}")
    assert old in text and words in told(text.replace(old, new))
