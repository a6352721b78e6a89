# SPDX-License-Identifier: MIT
"""Scenes: units, ranges, contradictions, every error of a file at once; malformed files in the command."""

import difflib
import subprocess
import sys
from fractions import Fraction

import pytest
from builders import GIVEN, PATH, SPHERE_TEXT, friction_text as friction, given_pressure, parsed, scene_text
from hypothesis import given, strategies as st
from pydantic import ValidationError

from sam.scene import (
    Body,
    CounterBody,
    Friction,
    Grid,
    Loading,
    Path,
    Scene,
    SceneError,
    load_scene,
    parse_scene,
    resolved,
)


def read(text: str, name: str = "scene.toml") -> Scene:
    return parse_scene(text.encode(), name)


def young(value: str) -> str:
    return scene_text(('"210 GPa"', value))


def counter(lines: str) -> str:
    return scene_text(('shape = "sphere"\nradius = "105 um"', lines))


UNIT_PRESSURE = 'a pressure as a string with a unit, such as "210 GPa"'
UNIT_LENGTH = 'a length as a string with a unit, such as "10 um"'
TOGETHER = "young and poisson together"

# name -> (file, fragments of the message: key with value, and what is allowed)
MALFORMED = {
    "bare number": (young("210e9"), ["body.young = 210000000000.0", UNIT_PRESSURE]),
    "number in a string": (young('"210e9"'), ['body.young = "210e9"', UNIT_PRESSURE]),
    "no number": (young('"GPa"'), ['body.young = "GPa"', UNIT_PRESSURE]),
    "wrong dimension": (young('"210 mm"'), ['body.young = "210 mm"', UNIT_PRESSURE]),
    "unknown unit": (young('"210 Gpa"'), ['body.young = "210 Gpa"', UNIT_PRESSURE]),
    "negative": (young('"-210 GPa"'), ['body.young = "-210 GPa"', "from 1e-30 to 1e+30 Pa"]),
    "zero": (young('"0 GPa"'), ['body.young = "0 GPa"', "from 1e-30 to 1e+30 Pa"]),
    "nan": (young('"nan GPa"'), ['body.young = "nan GPa"', UNIT_PRESSURE]),
    "infinity": (young('"inf GPa"'), ['body.young = "inf GPa"', UNIT_PRESSURE]),
    "too large for a float": (young('"1e400 GPa"'), ['body.young = "1e400 GPa"', UNIT_PRESSURE]),
    "arithmetic": (young('"2 GPa * 3"'), ['body.young = "2 GPa * 3"', UNIT_PRESSURE]),
    "power tower": (young('"9**9**9**9 Pa"'), ['body.young = "9**9**9**9 Pa"', UNIT_PRESSURE]),
    "tower in the unit": (young('"1 Pa**9**9**9"'), ['body.young = "1 Pa**9**9**9"', UNIT_PRESSURE]),
    "parentheses": (young('"1 ((Pa))"'), ['body.young = "1 ((Pa))"', UNIT_PRESSURE]),
    "a long unit": (young('"1 ' + "Pa*" * 500 + 'Pa"'), ['body.young = "1 Pa*Pa', UNIT_PRESSURE]),
    "two numbers": (young('"1 2 GPa"'), ['body.young = "1 2 GPa"', UNIT_PRESSURE]),
    "decimal comma": (young('"210,5 GPa"'), ['body.young = "210,5 GPa"', UNIT_PRESSURE]),
    "offset unit": (young('"20 degC"'), ['body.young = "20 degC"', UNIT_PRESSURE]),
    "logarithmic unit": (young('"20 dB"'), ['body.young = "20 dB"', UNIT_PRESSURE]),
    "truth value": (young("true"), ["body.young = true", UNIT_PRESSURE]),
    "date": (young("2024-01-01"), ['body.young = "2024-01-01"', UNIT_PRESSURE]),
    "list": (young('["210 GPa"]'), ['body.young = ["210 GPa"]', UNIT_PRESSURE]),
    "empty string": (young('""'), ['body.young = ""', UNIT_PRESSURE]),
    "poisson too large": (scene_text(("0.3", "0.51")), ["body.poisson = 0.51", "from 0 to 0.5"]),
    "poisson negative": (scene_text(("0.3", "-0.1")), ["body.poisson = -0.1", "from 0 to 0.5"]),
    "poisson nan": (scene_text(("0.3", "nan")), ["body.poisson = NaN", "from 0 to 0.5"]),
    "poisson true": (scene_text(("0.3", "true")), ["body.poisson = true", "from 0 to 0.5"]),
    "poisson string": (scene_text(("0.3", '"0.3"')), ['body.poisson = "0.3"', "from 0 to 0.5"]),
    "poisson huge": (scene_text(("0.3", "1" + "0" * 400)), ["body.poisson = 1000", "from 0 to 0.5"]),
    "young missing": (scene_text(('young = "210 GPa"\n', "")), ["body.young is missing", UNIT_PRESSURE]),
    "body missing": (
        SPHERE_TEXT[SPHERE_TEXT.index("[counterbody]") :],
        ["body is missing", "a table [body]"],
    ),
    "body no table": (
        "body = 3\n" + SPHERE_TEXT[SPHERE_TEXT.index("[counterbody]") :],
        ["body = 3", "a table"],
    ),
    "table twice": (SPHERE_TEXT.replace("[body]", "[[body]]"), ["body = [{", "a table"]),
    "unknown key": (
        scene_text(("young", "yuong")),
        ['body.yuong = "210 GPa"', "did you mean young?", "young, poisson"],
    ),
    "unknown table": (scene_text(add="[lodaing]\nx = 1\n"), ["lodaing = ", "did you mean loading?"]),
    "unknown shape": (
        counter('shape = "cone"'),
        ['counterbody.shape = "cone"', '"punch", "rounded-punch" or "flat"'],
    ),
    "shape missing": (
        counter('radius = "1 mm"'),
        ["counterbody.shape is missing", '"sphere" or "ellipsoid"'],
    ),
    "flat on smooth": (counter('shape = "flat"'), ["surface is missing", 'counterbody.shape = "flat"']),
    "flat with radius": (
        counter('shape = "flat"\nradius = "1 mm"'),
        ['counterbody.radius = "1 mm"', "takes no radius"],
    ),
    "sphere without radius": (counter('shape = "sphere"'), ["counterbody.radius is missing", "takes radius"]),
    "sphere with radius_x": (
        counter('shape = "sphere"\nradius = "1 mm"\nradius_x = "1 mm"'),
        ['counterbody.radius_x = "1 mm"', "takes radius: remove it"],
    ),
    "ellipsoid with one radius": (
        counter('shape = "ellipsoid"\nradius_x = "1 mm"'),
        ["counterbody.radius_y is missing", "takes radius_x and radius_y"],
    ),
    "ellipsoid too slender": (
        counter('shape = "ellipsoid"\nradius_x = "1 mm"\nradius_y = "1 km"'),
        ['counterbody.radius_y = "1 km"', "radius_x/radius_y from 0.0001 to 10000"],
    ),
    "punch without radius": (counter('shape = "punch"'), ["counterbody.radius is missing", "takes radius"]),
    "young alone": (
        counter('shape = "punch"\nradius = "1 mm"\nyoung = "1 GPa"'),
        ["counterbody.poisson is", TOGETHER],
    ),
    "poisson alone": (
        counter('shape = "punch"\nradius = "1 mm"\npoisson = 0.2'),
        ["counterbody.young is", TOGETHER],
    ),
    "force negative": (scene_text(("0.65 N", "-1 N")), ['loading.force = "-1 N"', "or 0"]),
    "steps zero": (scene_text(add="steps = 0\n"), ["loading.steps = 0", "a whole number from 1 to 1000"]),
    "steps fractional": (scene_text(add="steps = 2.5\n"), ["loading.steps = 2.5", "a whole number"]),
    "steps float": (scene_text(add="steps = 2.0\n"), ["loading.steps = 2.0", "a whole number"]),
    "unload a number": (scene_text(add="unload = 1\n"), ["loading.unload = 1", "true or false"]),
    "unload_steps alone": (
        scene_text(add="unload_steps = 2\n"),
        ["loading.unload_steps = 2", "unload = true"],
    ),
    "neither force nor pressure": (
        given_pressure(""),
        ["loading.force is missing", "required: force, approach, or prescribed"],
    ),
    "force and pressure": (
        scene_text(add=GIVEN),
        ['loading.force = "0.65 N"', "not both", "counterbody = {", "nothing presses"],
    ),
    "pressure without its size": (
        given_pressure('prescribed = "hertz"\n'),
        ["loading.p0 is missing", "loading.radius is missing", "required: prescribed"],
    ),
    "size without pressure": (
        scene_text(add='p0 = "4 GPa"\n'),
        ['loading.p0 = "4 GPa"', 'only as part of prescribed = "h'],
    ),
    "another pressure": (
        given_pressure(GIVEN.replace("hertz", "flat")),
        ['loading.prescribed = "flat"', '"hertz"'],
    ),
    "no counter-body": (
        SPHERE_TEXT.replace('[counterbody]\nshape = "sphere"\nradius = "105 um"\n', ""),
        ["counterbody is missing", "required: a table [counterbody], or loading.prescribed"],
    ),
    "path to where it is": (
        given_pressure(GIVEN + PATH.replace('"9 um"', '"-9 um"')),
        ['loading.path.end = ["-9 um", "0 um"]', "another place than start"],
    ),
    "place without unit": (
        given_pressure(GIVEN + PATH.replace('"9 um"', "9e-6")),
        ["loading.path.end[0] = 9e-06", 'such as "-10 um"'],
    ),
    "place on a line": (
        given_pressure(GIVEN + PATH.replace('["9 um", "0 um"]', '["9 um"]')),
        ['loading.path.end = ["9 um"]', "a list of 2"],
    ),
    "path without steps": (
        given_pressure(GIVEN + PATH.replace(", steps = 4", "")),
        ["loading.path.steps is missing", "a whole number from 1 to 1000", "or step_per_radius"],
    ),
    "coating": (
        scene_text(add="[body.coating]\n"),
        ["body.coating.thickness is missing", "body.coating.young is missing"],
    ),
    "surface": (scene_text(add='[surface]\nkind = "file"\n'), ["surface.path is missing", "takes path"]),
    "friction without coefficient": (
        scene_text(add="[friction]\n"),
        ["friction.coefficient is missing", "from 0 to 10"],
    ),
    "friction negative": (friction("coefficient = -0.1"), ["friction.coefficient = -0.1", "from 0 to 10"]),
    "friction as text": (
        friction('coefficient = "0.1"'),
        ['friction.coefficient = "0.1"', "a number from 0 to 10"],
    ),
    "friction infinite": (friction("coefficient = inf"), ["friction.coefficient = Infinity", "from 0 to 10"]),
    "coupling a number": (
        friction("coefficient = 0.1\ncoupling = 0"),
        ["friction.coupling = 0", "true or false"],
    ),
    "direction": (
        friction('coefficient = 0.1\ndirection = "x"'),
        ['friction.direction = "x"', '"constant" or "alternating"'],
    ),
    "law of friction": (
        friction('law = "viscous"'),
        ['friction.law = "viscous"', '"constant", "map" or "chemical-film"'],
    ),
    "unknown key of friction": (
        friction("coefficient = 0.1\nmu = 0.2"),
        ["friction.mu = 0.2", "unknown key"],
    ),
    "wear": (
        scene_text(add="unload = true\n[wear]\nstrain_limit = 0.01\n"),
        ["wear", "only together with [body.plasticity]"],
    ),
    "paper's loop": (
        scene_text(add='[solver]\nmethod = "paper"\n'),
        ['solver.method = "paper"', "needs [body.plasticity]"],
    ),
    "stop": (
        scene_text(add='[solver]\nstop = "stress"\n'),
        ['solver.stop = "stress"', 'together with method = "paper"'],
    ),
    "tolerance": (scene_text(add="[solver]\ntolerance = 0\n"), ["solver.tolerance = 0", "from 1e-14 to 0.1"]),
    "relief": (
        scene_text(add='[grid]\nborder = "relief"\n'),
        ['grid.border = "relief"', "only together with [surface]"],
    ),
    "one cell number": (scene_text(add="[grid]\ncells = [65]\n"), ["grid.cells = [65]", "a list of 2"]),
    "cells a number": (scene_text(add="[grid]\ncells = 65\n"), ["grid.cells = 65", "a list of 2"]),
    "too many cells": (
        scene_text(add="[grid]\ncells = [65, 5000]\n"),
        ["grid.cells[1] = 5000", "from 3 to 4097"],
    ),
    "extent bare": (scene_text(add='[grid]\nextent = ["1 um", 2]\n'), ["grid.extent[1] = 2", UNIT_LENGTH]),
    "depths not ascending": (
        scene_text(add='[grid]\ndepths = ["1 um", "0 um"]\n'),
        ['grid.depths = ["1 um", "0 um"]', "strictly ascending"],
    ),
    "depth negative": (scene_text(add='[grid]\ndepths = ["-1 um"]\n'), ['grid.depths[0] = "-1 um"', "or 0"]),
    "depths empty": (scene_text(add="[grid]\ndepths = []\n"), ["grid.depths = []", "a list of 1 to 1001"]),
    "depths and layers": (
        scene_text(add='[grid]\ndepths = ["0 um"]\nlayers = 3\ndepth = "1 um"\n'),
        ['grid.depths = ["0 um"]', "not both"],
    ),
    "layers alone": (
        scene_text(add="[grid]\nlayers = 3\n"),
        ["grid.depth is missing", "layers and depth together"],
    ),
    "box too small": (scene_text(add="[fem]\nbox = 2.9\n"), ["fem.box = 2.9", "from 3 to 1000"]),
    "mesh too fine": (
        scene_text(add="[fem]\ncells_per_radius = 257\n"),
        ["fem.cells_per_radius = 257", "from 2 to 256"],
    ),
    "mesh too coarse": (
        scene_text(add="[fem]\ncells_per_radius = 1\n"),
        ["fem.cells_per_radius = 1", "from 2 to 256"],
    ),
    "title a number": (scene_text(('"Sphere"', "3")), ["title = 3", "a string"]),
    "TOML": ("[body\n", ["not TOML", "line 1, column"]),
    "key twice": (scene_text(("poisson = 0.3", "poisson = 0.3\npoisson = 0.3")), ["not TOML", "line 5"]),
    "thousands of digits": ("title = " + "9" * 5000, ["not TOML"]),
    "deep nesting": ("title = " + "[" * 100_000, ["nested too deeply"]),
    "empty": ("", ["empty", "[body], [counterbody] and [loading]"]),
    "too large": ("#" * (1 << 20) + "\n", ["too large", "1048576 bytes"]),
}


def test_the_scene_that_the_malformed_ones_start_from_is_good():
    assert parsed().counterbody.radius == 105e-6


@pytest.mark.parametrize("text, fragments", MALFORMED.values(), ids=MALFORMED.keys())
def test_a_malformed_scene_is_refused_by_name_and_nothing_is_created(folder, refused, text, fragments):
    (folder / "bad.toml").write_text(text, encoding="utf-8")
    message = refused("solve", "bad.toml", "--out", "out")
    assert [fragment for fragment in ["bad.toml", *fragments] if fragment not in message] == []
    assert len(message) < 2000


@pytest.mark.parametrize("name", ["plan", "compare"])
def test_every_command_refuses_a_malformed_scene(folder, refused, name):
    (folder / "bad.toml").write_text(young("3"))
    assert "body.young = 3" in refused(name, "bad.toml")


@pytest.mark.parametrize("name", ["wrong dimension", "TOML"])
def test_a_malformed_scene_in_a_process_of_its_own(folder, name):
    text, fragments = MALFORMED[name]
    (folder / "bad.toml").write_text(text)
    command = [sys.executable, "-m", "samfem.cli", "solve", "bad.toml"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stdout == ""
    assert all(fragment in done.stderr for fragment in fragments) and "Traceback" not in done.stderr
    assert [entry.name for entry in folder.iterdir()] == ["bad.toml"]


def test_files_that_cannot_be_read_as_text(folder, samfem):
    (folder / "latin.toml").write_bytes(b'[body]\ntitle = "\xe9"\n')
    for name, fragment in (
        ("none.toml", "No such file"),
        (".", "directory"),
        ("latin.toml", "0xe9 in line 2"),
    ):
        assert fragment in samfem("solve", name, code=2).err


def test_all_errors_of_a_file_are_reported_at_once():
    text = """
[body]
yuong = "210 GPa"
poisson = 0.7
[body.coating]
thickness = "1 um"
[counterbody]
shape = "sphere"
radius_x = "3 s"
young = "1 GPa"
[loading]
force = 1.0
unload_steps = 0
[wear]
"""
    with pytest.raises(SceneError) as caught:
        parse_scene(text.encode(), "many.toml")
    keys = [problem.key for problem in caught.value.problems]
    expected = """
        body.coating body.coating.poisson body.coating.young body.poisson body.young body.yuong
        counterbody.poisson counterbody.radius counterbody.radius_x
        counterbody.radius_x loading.force loading.unload loading.unload_steps loading.unload_steps wear
        wear.strain_limit
    """
    assert sorted(keys) == expected.split()
    assert str(caught.value).startswith("many.toml: 16 errors\n")
    assert all(str(problem) in str(caught.value) for problem in caught.value.problems)


@pytest.mark.parametrize(
    "text, value",
    [
        ("210 GPa", 210e9),
        ("210GPa", 210e9),
        ("2.1e5 N/mm^2", 210e9),
        ("2.1e5 N / mm**2", 210e9),
        ("210 kN mm**-2", 210e9),
        ("+.5 psi", 0.5 * 4.4482216152605 / 0.0254**2),  # pound-force and inch, both exact by definition
        ("1000 bar", 1e8),
    ],
)
def test_units_of_pressure(text, value):
    assert read(young(f'"{text}"')).body.young == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("micro", ["um", "\N{MICRO SIGN}m", "\N{GREEK SMALL LETTER MU}m"])
@given(count=st.integers(1, 10**6))
def test_conversion_rounds_once(micro, count):
    """Exact rational arithmetic, rounded to the nearest float, is the independent answer: not one digit is
    lost.
    """
    assert parsed(("105 um", f"{count} {micro}")).counterbody.radius == float(Fraction(count, 10**6))


TYPED = st.text(max_size=30) | st.from_regex(
    r"[0-9.+-]{1,5}(e[+-]?[0-9]{1,4})? ?[GMk]?Pa([*/^ ]{1,2}[0-9a-zA-Z.]{1,4})?"
)


@given(TYPED)
def test_no_string_but_a_quantity_is_a_pressure(text):
    """Whatever is typed: a finite pressure, or an error with the key; nothing else happens."""
    section = {"young": text, "poisson": 0.3}
    try:
        body = Body.model_validate(section, context={"spelling": "file"})
    except ValidationError as error:
        assert [item["loc"] for item in error.errors()] == [("young",)]
    else:
        assert 1e-30 <= body.young <= 1e30


def test_python_takes_si_floats_or_strings_with_units():
    scene = Scene(
        body=Body(young=210e9, poisson=0.3),
        counterbody=CounterBody(shape="sphere", radius=105e-6),
        loading=Loading(force=0.65),
        title="Sphere",
    )
    assert scene == parsed()
    for wrong in ("210 m", "210e9", True, float("nan"), float("inf"), -1.0, None):
        with pytest.raises(ValidationError, match="a pressure from 1e-30 to 1e\\+30 Pa \\(a float in SI, or"):
            Body(young=wrong, poisson=0.3)
    with pytest.raises(ValidationError, match="unknown key, did you mean young"):
        Body(young=1.0, poisson=0.3, yung=2.0)
    with pytest.raises(ValidationError, match="frozen"):
        scene.body.young = 1.0


def test_many_unknown_keys_are_compared_with_the_known_ones_up_to_those_that_are_shown(monkeypatch):
    compared = []
    near = difflib.get_close_matches
    monkeypatch.setattr(
        difflib, "get_close_matches", lambda name, *a, **k: compared.append(name) or near(name, *a, **k)
    )
    keys = "".join(f"yuong_{k} = 1\n" for k in range(300))
    with pytest.raises(SceneError) as caught:
        parse_scene(scene_text(("[body]\n", f"[body]\n{keys}")).encode(), "bad.toml")
    assert str(caught.value).count("did you mean young?") == 100 == len(set(compared))
    assert str(caught.value).endswith("and 200 more") and len(caught.value.problems) == 300


def test_resolved_is_complete_and_reads_back():
    add = 'unload = true\n[grid]\ncells = [65, 33]\ndepths = ["0 um", "0.5 um"]\n[fem]\nbox = 6\n'
    scene = parsed(add=add)
    content = resolved(scene)
    assert Scene(**content) == scene
    assert content["grid"]["cells"] == [65, 33] and content["grid"]["depths"] == [0.0, 0.5e-6]
    assert content["fem"] == {"cells_per_radius": 16, "box": 6.0} and content["solver"]["tolerance"] == 1e-6


def test_grid_may_give_cells_or_extent_alone_and_force_may_be_zero():
    assert Grid(cells=(65, 65)).extent is None and Grid(extent=(1e-5, 1e-5)).cells is None
    assert parsed(("0.65 N", "0 N")).loading.force == 0.0


def test_load_scene_reads_a_file_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SPHERE_TEXT.encode())
    assert load_scene(path) == parsed()


def test_radii_of_the_shapes():
    assert CounterBody(shape="sphere", radius=2.0).radii == (2.0, 2.0)
    assert CounterBody(shape="ellipsoid", radius_x=2.0, radius_y=3.0).radii == (2.0, 3.0)
    assert not CounterBody(shape="sphere", radius=2.0).elastic
    assert CounterBody(shape="sphere", radius=2.0, young=1e9, poisson=0.2).elastic


def test_friction_and_its_defaults():
    scene = read(friction("coefficient = 0.2"))
    assert scene.friction == Friction(coefficient=0.2) and scene.coefficient == 0.2
    assert scene.friction.coupling and scene.friction.direction == "constant"
    assert parsed().coefficient == 0.0
    assert Friction(coefficient=0, coupling=False, direction="alternating").coefficient == 0.0


def test_a_given_pressure_that_travels():
    scene = read(given_pressure(GIVEN + PATH + "cycles = 3\n[friction]\ncoefficient = 0.4\n"))
    loading = scene.loading
    assert scene.counterbody is None and loading.force is None and (loading.p0, loading.radius) == (4e9, 6e-6)
    assert loading.path == Path(start=(-9e-6, 0.0), end=(9e-6, 0.0), steps=4)
    assert Scene(**resolved(scene)) == scene


def test_units_are_read_where_there_is_no_proc():
    """dask, which pint loads where it is installed, asks psutil for the cores; psutil then knows of no
    process.
    """
    program = (
        "import psutil\n"
        "def none(self, *_): raise psutil.NoSuchProcess(1)\n"
        "psutil.Process.__init__ = none\n"
        "from sam.scene.units import in_unit\n"
        "print(int(in_unit('105 um', 'nm')))\n"
        "import sys; print('dask' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.stdout.split(), done.returncode) == (["105000", "False"], 0), done.stderr
