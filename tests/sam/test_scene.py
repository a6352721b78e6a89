# SPDX-License-Identifier: MIT
"""Scenes: units, ranges, contradictions, every error of a file at once; malformed files in the command."""

import difflib
import subprocess
import sys
from decimal import Decimal
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
    units,
)


def read(text: str, name: str = "scene.toml") -> Scene:
    return parse_scene(text.encode(), name)


def young(value: str) -> str:
    return scene_text(('"210 GPa"', value))


# bytes that are no scene -> fragments of the message
MALFORMED = {
    "[body\n": ["not TOML", "line 1, column"],
    scene_text(("poisson = 0.3", "poisson = 0.3\npoisson = 0.3")): ["not TOML", "line 5"],
    "title = " + "9" * 5000: ["not TOML"],
    "title = " + "[" * 100_000: ["nested too deeply"],
    "": ["empty", "[body], [counterbody] and [loading]"],
    "#" * (1 << 20) + "\n": ["too large", "1048576 bytes"],
}


def test_the_scene_that_the_malformed_ones_start_from_is_good():
    assert parsed().counterbody.radius == 105e-6


@pytest.mark.parametrize("text, fragments", MALFORMED.items(), ids=range(len(MALFORMED)))
def test_what_is_no_scene_is_refused_and_nothing_is_created(folder, refused, text, fragments):
    (folder / "bad.toml").write_text(text, encoding="utf-8")
    message = refused("solve", "bad.toml", "--out", "out")
    assert [fragment for fragment in ["bad.toml", *fragments] if fragment not in message] == []
    assert len(message) < 2000


@pytest.mark.parametrize("name", ["plan", "compare"])
def test_every_command_refuses_a_malformed_scene(folder, refused, name):
    (folder / "bad.toml").write_text(young("3"))
    assert "body.young = 3" in refused(name, "bad.toml")


@pytest.mark.parametrize(
    "text, fragments",
    [(young('"210 mm"'), ['body.young = "210 mm"', "a pressure as a string"]), ("[body\n", ["not TOML"])],
)
def test_a_malformed_scene_in_a_process_of_its_own(folder, text, fragments):
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


@pytest.mark.parametrize("unit", units.PLAIN)
def test_a_prefix_is_the_factor_of_pint(unit):
    registry = units._registry()
    for prefix, power in units.PREFIXES.items():
        quantity = registry.Quantity(Decimal(1), registry.Unit(f"{prefix}{unit}"))
        assert quantity.to(unit).magnitude == Decimal(10) ** power == units._factor(f"{prefix}{unit}", unit)
    assert units._factor("Pa", "m") is None and units._factor("inch", "m") == Decimal("0.0254")
