# SPDX-License-Identifier: MIT
"""Study files: what they may say, the values that they mean, and every error of them at once."""

from pathlib import Path

import numpy as np
import pytest
from builders import scene_text

from sam.scene import SceneError
from verification.runs.study import in_si, read_study

MORRIS = 'mode = "morris"\nsamples = 4\nseed = 1'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "sphere.toml").write_text(scene_text())
    return tmp_path


def study(folder: Path, vary: str, more: str = ""):
    (folder / "study.toml").write_text(f'scene = "sphere.toml"\n{more}\n[vary]\n{vary}\n')
    return read_study(folder / "study.toml")


def errors(folder: Path, vary: str, more: str = "") -> str:
    with pytest.raises(SceneError) as caught:
        study(folder, vary, more)
    return str(caught.value)


def column(content, key: str) -> list:
    place = list(content.study.vary).index(key)
    return [point.shown[place] for point in content.points]


def test_a_grid_is_every_combination_and_the_last_key_changes_fastest(folder):
    vary = '"loading.force" = { list = ["1 N", "2 N"] }\n"loading.steps" = { list = [1, 2, 3] }'
    content = study(folder, vary)
    assert [point.shown for point in content.points] == [[f, n] for f in (1.0, 2.0) for n in (1, 2, 3)]
    assert [point.index for point in content.points] == list(range(6))
    for point in content.points:
        assert [point.scene.loading.force, point.scene.loading.steps] == point.shown
    assert set(content.inputs) == {"study.toml", "sphere.toml"}
    vary = 'loading.force = { list = ["1 N", "2 N"] }\n"loading.steps" = { range = [3, 4], count = 2 }'
    assert [point.shown for point in study(folder, vary, 'mode = "zip"').points] == [[1.0, 3], [2.0, 4]]


def test_a_range_is_decimal_and_keeps_both_ends(folder):
    content = study(folder, '"loading.force" = { range = ["100 mN", "0.5 N"], count = 5 }')
    assert column(content, "loading.force") == [0.1, 0.2, 0.3, 0.4, 0.5]  # not 0.30000000000000004
    assert [point.values[0] for point in content.points] == ["100 mN", "200 mN", "300 mN", "400 mN", "0.5 N"]


@pytest.mark.parametrize("mode, size", [("morris", 3), ("sobol", 4), ("uniform", 1)])
def test_a_design_varies_its_keys_within_their_ends_and_draws_its_blocks_for_each_sample(folder, mode, size):
    vary = '"loading.force" = { log = ["0.1 N", "10 N"] }\n"loading.steps" = { list = [1, 2, 3, 4] }\n'
    vary += '"body.poisson" = { list = [0.1, 0.2, 0.3], block = true }'
    of = f'mode = "{mode}"\nsamples = 8\nseed = 5'
    content = study(folder, vary, of)
    force, steps, blocks = (np.array(column(content, key)).reshape(8, size) for key in content.study.vary)
    assert content.study.factors == ["loading.force", "loading.steps"]
    assert ((force >= 0.1) & (force <= 10.0)).all() and set(steps.flat) == {1, 2, 3, 4}
    assert (blocks == blocks[:, :1]).all() and len(set(blocks.flat)) > 1
    if mode == "morris":
        assert sorted(set(force.flat)) == pytest.approx(0.1 * 100 ** (np.arange(4) / 3))
    fewer = study(folder, vary, of.replace("8", "4"))
    assert [point.shown for point in fewer.points] == [point.shown for point in content.points[: 4 * size]]


def test_draws_depend_on_the_seed_and_on_their_own_key_only(folder):
    draw = '"body.young" = { random = ["200 GPa", "220 GPa"], count = 200 }'
    other = '"counterbody.radius" = { random-log = ["1 um", "1 m"], count = 200 }'
    first = column(study(folder, draw, "seed = 1"), "body.young")
    assert column(study(folder, draw, "seed = 1"), "body.young") == first
    assert column(study(folder, draw, "seed = 2"), "body.young") != first
    both = study(folder, f"{other}\n{draw}", 'seed = 1\nmode = "zip"')
    assert column(both, "body.young") == first
    assert min(first) > 200e9 and max(first) < 220e9
    sigmas = 5 / np.sqrt(12 * 200)  # five of the mean of uniform numbers
    assert np.mean(first) == pytest.approx(210e9, abs=20e9 * sigmas)
    radii = np.log10(column(both, "counterbody.radius"))
    assert np.mean(radii) == pytest.approx(-3.0, abs=6 * sigmas)


def test_the_first_draws_are_those_of_every_machine(folder):
    content = study(folder, '"body.poisson" = { random = [0, 0.4], count = 3 }', "seed = 1")
    assert column(content, "body.poisson") == [0.343200847562775, 0.10571221757134, 0.240298734941353]


def test_any_value_can_be_varied_and_tables_are_made_when_missing(folder):
    vary = '"grid.cells" = { list = [[33, 33], [65, 65]] }\n"loading.unload" = { list = [true, false] }\n'
    vary += '"title" = { list = ["a", "b"] }\n'
    content = study(folder, vary)
    assert [point.scene.grid.cells for point in content.points[::4]] == [(33, 33), (65, 65)]
    assert content.points[0].shown == ["[33, 33]", "true", "a"]
    assert in_si(["24 um", "1 mm"]) == "[2.4e-05, 0.001]"


def test_files_that_the_scene_names_can_be_varied(folder):
    for name, stress in (("a.csv", 1e9), ("b.csv", 2e9)):
        (folder / name).write_text(f"peeq,yield_stress_Pa\n0,{stress}\n")
    (folder / "sphere.toml").write_text(scene_text() + '\n[body.plasticity]\nlaw = "table"\n')
    content = study(folder, '"body.plasticity.file" = { list = ["a.csv", "b.csv"] }')
    assert [point.scene.body.plasticity.file[0][1] for point in content.points] == [1e9, 2e9]
    assert {"a.csv", "b.csv"} <= set(content.inputs)


def test_a_scene_that_is_refused_is_a_point_with_the_reason_of_the_parser(folder):
    content = study(folder, '"body.poisson" = { list = [0.3, 0.7] }')
    assert content.points[0].scene is not None and content.points[1].scene is None
    assert content.points[1].reason == "body.poisson = 0.7: a number from 0 to 0.5"
    content = study(folder, '"body.poisson" = { list = [0.3, 0.5] }', 'model = "fem-axisymmetric"')
    assert content.points[0].scene is not None
    assert content.points[1].scene is None and "poisson" in content.points[1].reason


def test_a_study_whose_scenes_are_all_refused_is_an_error_that_says_each_reason_once(folder):
    message = errors(folder, '"loading.forse" = { list = ["1 N", "2 N"] }')
    assert message.count('loading.forse = "1 N": unknown key, did you mean force?') == 1
    many = errors(folder, '"body.poisson" = { range = [1, 40], count = 40 }')
    assert many.count("body.poisson =") == 10 and "and 30 more" in many


def test_all_errors_of_a_study_come_at_once(folder):
    vary = """
"a" = { range = ["0.1 N", "0.5 m"], count = 5 }
"b" = { log = [0, 1], count = 4 }
"c" = { random = ["200 GPa", "220 GPa"] }
"d" = { lst = [1] }
"e" = { list = ["1 N", "2 m"] }
"f" = 3
"g" = { list = [1], range = [1, 2], count = 2 }
"h" = { list = [1], count = 1 }
"i" = { range = [2, 1], count = 0 }
"j" = { list = [] }
"k" = { range = ["1 N", 2], count = 3 }
"l" = { list = [{ x = 1 }] }
"m" = { range = [1, 2], count = 1 }
"n" = { log = ["-1 N", "1 N"], count = 3 }
"o" = { range = [nan, inf], count = 3 }
"""
    message = errors(folder, vary, 'modle = 1\nmode = "both"')
    for fragment in (
        'mode = "both": one of "grid", "zip", "morris", "sobol" or "uniform"',
        "modle = 1: unknown key",
        "seed is missing: required by random draws",
        'vary.a.range = ["0.1 N", "0.5 m"]: two numbers, or two strings with units of one dimension',
        "vary.b.log = [0, 1]",
        "vary.c.count is missing",
        "vary.d.lst = [1]: unknown key, did you mean list?",
        'vary.e.list = ["1 N", "2 m"]',
        "vary.f = 3: a table",
        "vary.g.range",
        "vary.h.count = 1: a list has its own number of values",
        "vary.i.range = [2, 1]",
        "vary.i.count = 0: a whole number from 1",
        "vary.j.list = []",
        'vary.k.range = ["1 N", 2]',
        'vary.l.list = [{"x": 1}]',
        "vary.m.count = 1: 2 or more",
        'vary.n.log = ["-1 N", "1 N"]',
        "vary.o.range = [NaN, Infinity]",
    ):
        assert fragment in message


@pytest.mark.parametrize(
    "vary, more, fragment",
    [
        ("", "", "vary = {}: one or more keys"),
        ('"a b" = { list = [1] }', "", '"a b" is no key of a scene'),
        (f'"{".".join("abcdefg")}" = {{ list = [1] }}', "", "is no key of a scene"),
        ('"body" = {list = [1]}\n"body.young" = {list = [1]}', "", "body or body.young: one is inside the"),
        ('"body.young.x" = { list = [1] }', "", "body.young is no table of the scene"),
        ('"loading.steps" = { range = [1, 10001], count = 10001 }', "", "vary.loading.steps.count = 10001"),
        ('"a" = {range = [1, 2], count = 101}\n"b" = {range = [1, 2], count = 100}', "", "at most 10000"),
        ('"a" = { list = [1] }\n"b" = { list = [1, 2] }', 'mode = "zip"', "here a 1, b 2"),
        ('"a" = {list = [1]}', "samples = 4", 'samples = 4: with mode = "morris", "sobol" or "uniform" only'),
        ('"a" = { list = [1], block = true }', "", 'vary.a.block = true: with mode = "morris", "sobol"'),
        ('"a" = { list = [1, 2] }', 'mode = "morris"', "samples is missing: required by this mode"),
        ('"a" = { list = [1, 2] }', 'mode = "sobol"', "seed is missing: required by random draws"),
        ('"a" = { range = [1, 2], count = 3 }', MORRIS, "vary.a.count = 3: the mode chooses the values"),
        ('"a.b" = { range = [1, 2], count = 3 }', MORRIS, "vary.a.b.count = 3: the mode chooses the values"),
        ('"a" = { random = [1, 2] }', MORRIS, "vary.a.random = [1, 2]: the mode chooses the values"),
        ('"a" = { range = [1, 2], block = true }', MORRIS, "vary.a.block = true: with a list of values"),
        ('"a" = { list = [1, 2], block = true }', MORRIS, "a key that is no block"),
        ('"a" = { range = [1, 2] }', "mode = 'sobol'\nsamples = 5000\nseed = 1", "at most 3333 with 1 keys"),
        ('"solver.uncertainty" = { list = [true] }', "", "solver.uncertainty = true: not in a sweep"),
        ('"a" = { range = [0, 1' + "0" * 400 + "], count = 3 }", "", "a = "),
    ],
)
def test_a_wrong_study_is_refused(folder, vary, more, fragment):
    assert fragment in errors(folder, vary, more)
