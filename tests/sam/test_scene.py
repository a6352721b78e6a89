# SPDX-License-Identifier: MIT
"""Scenes: units, every error of a file at once, files that a scene names, and what is read back."""

import hashlib
import json
import os
import pickle
from decimal import Decimal
from fractions import Fraction
from pathlib import Path as FilePath

import numpy as np
import pytest
from builders import HARDENING, PATH, SPHERE_TEXT, YIELD_CURVE as CURVE, parsed, scene_text
from hypothesis import given, strategies as st
from pydantic import ValidationError

import verification
from sam.scene import (
    Body,
    Coating,
    CounterBody,
    Grid,
    Inputs,
    Loading,
    Plasticity,
    Scene,
    SceneError,
    Solver,
    load_scene,
    parse_scene,
    read_scene,
    resolved,
    scene_of,
    units,
)
from sam.scene.body import LAWS
from sam.scene.yield_curve import DepthProfile

SHIPPED = sorted((FilePath(verification.__file__).parent / "scenes").rglob("*.toml"))


def young(value: str) -> str:
    return scene_text(('"210 GPa"', value))


# bytes that are no scene -> fragments of the message
MALFORMED = {
    "[body\n": ["not TOML", "line 1, column"],
    scene_text(("poisson = 0.3", "poisson = 0.3\npoisson = 0.3")): ["not TOML", "line 5"],
    "title = " + "9" * 5000: ["not TOML"],
    "[body]\npoisson = 0.34 GPa": ["not TOML", "numbers with units stand in quotes"],
    "title = " + "[" * 100_000: ["nested too deeply"],
    "": ["empty", "[body], [counterbody] and [loading]"],
    "#" * (1 << 20) + "\n": ["too large", "1048576 bytes"],
}


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


def test_files_that_cannot_be_read_as_text(folder, samfem):
    (folder / "latin.toml").write_bytes(b'[body]\ntitle = "\xe9"\n')
    files = {"none.toml": "No such file", ".": "directory", "latin.toml": "0xe9 in line 2"}
    for name, fragment in files.items():
        assert fragment in samfem("solve", name, code=2).err


def test_all_errors_of_a_file_are_reported_at_once():
    keys = """body.yuong = "210 GPa"; body.poisson = 0.7; body.coating.thickness = "1 um"; wear = {}
        counterbody.shape = "sphere"; counterbody.radius_x = "3 s"; counterbody.young = "1 GPa"
        loading.force = 1.0; loading.unload_steps = 0"""
    with pytest.raises(SceneError) as caught:
        parse_scene(keys.replace("; ", "\n").encode(), "many.toml")
    keys = [problem.key for problem in caught.value.problems]
    expected = """
        body.coating body.coating.poisson body.coating.young body.poisson body.yuong
        counterbody.poisson counterbody.radius counterbody.radius_x
        counterbody.radius_x loading.force loading.unload loading.unload_steps loading.unload_steps wear
        wear.strain_limit
    """
    assert sorted(keys) == expected.split()
    assert str(caught.value).startswith("many.toml: 15 errors\n")
    assert all(str(problem) in str(caught.value) for problem in caught.value.problems)
    friction = "[friction]\ncoefficient = 0.2\ndirection = 'alternating'\n"
    with pytest.raises(SceneError) as caught:
        parsed(add=f"{PATH}{friction}[wear]\nstrain_limit = 1\n")
    assert {"friction.direction", "wear"} <= {each.key for each in caught.value.problems}


# units


@pytest.mark.parametrize(
    "text, value",
    [
        ("210GPa", 210e9),
        ("2.1e5 N / mm**2", 210e9),
        ("210 kN mm**-2", 210e9),
        ("+.5 psi", 0.5 * 4.4482216152605 / 0.0254**2),  # pound-force and inch, both exact by definition
        ("1000 bar", 1e8),
    ],
)
def test_units_of_pressure(text, value):
    assert parsed(('"210 GPa"', f'"{text}"')).body.young == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("micro", ["um", "\N{MICRO SIGN}m", "\N{GREEK SMALL LETTER MU}m"])
@given(count=st.integers(1, 10**6))
def test_conversion_rounds_once(micro, count):
    """Exact rational arithmetic, rounded to the nearest float: not one digit is lost."""
    assert parsed(("105 um", f"{count} {micro}")).counterbody.radius == float(Fraction(count, 10**6))


TYPED = st.text(max_size=30) | st.from_regex(
    r"[0-9.+-]{1,5}(e[+-]?[0-9]{1,4})? ?[GMk]?Pa([*/^ ]{1,2}[0-9a-zA-Z.]{1,4})?"
)


@given(TYPED)
def test_no_string_but_a_quantity_is_a_pressure(text):
    """Whatever is typed: a finite pressure, or an error with the key; nothing else happens."""
    try:
        body = Body.model_validate({"young": text, "poisson": 0.3}, context={"spelling": "file"})
    except ValidationError as error:
        assert [item["loc"] for item in error.errors()] == [("young",)]
    else:
        assert 1e-30 <= body.young <= 1e30


@pytest.mark.parametrize("unit", units.PLAIN)
def test_a_prefix_is_the_factor_of_pint(unit):
    registry = units._registry()
    for prefix, power in units.PREFIXES.items():
        quantity = registry.Quantity(Decimal(1), registry.Unit(f"{prefix}{unit}"))
        assert quantity.to(unit).magnitude == Decimal(10) ** power == units._factor(f"{prefix}{unit}", unit)
    assert units._factor("Pa", "m") is None and units._factor("inch", "m") == Decimal("0.0254")


# what is read, and read back


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


def test_a_shipped_scene_is_written_as_a_file_that_gives_it_again(tmp_path):
    """Also of a map of heights and rows that it names, and of infinity; without what is at its default."""
    for path in SHIPPED:
        scene = load_scene(path)
        written, inputs = scene.to_toml(), Inputs(path.parent)
        again = parse_scene(written.encode(), path.name, inputs)
        assert again == scene and resolved(again) == resolved(scene), path
        assert repr(scene) == written.rstrip() and "None" not in written
    assert len(SHIPPED) > 30


def test_a_matrix_of_heights_and_its_size_are_written_again(tmp_path):
    np.savetxt(tmp_path / 'a "b".txt', np.outer(np.arange(4.0), [1, 2, 0, 5]))
    rough = {"kind": "file", "path": 'a "b".txt', "extent": ["4 um", "1e-6 m"], "unit": "nm"}
    tables = {"title": "\x7f \\u00b5", "body": {"young": "0.1 MPa", "poisson": 0.3}, "surface": rough}
    tables |= {"counterbody": {"shape": "flat"}, "loading": {"force": "1e-25 N"}}
    scene = scene_of(tables, "s", Inputs(tmp_path))
    assert parse_scene(scene.to_toml().encode(), "s", Inputs(tmp_path)) == scene
    assert pickle.loads(pickle.dumps(scene)).to_toml() == scene.to_toml()
    known = Scene(**resolved(scene))
    assert "path = HeightMap(4 x 4 cells, " in repr(known)
    with pytest.raises(SceneError, match=r"surface\.path = HeightMap.*a file of its own, which"):
        known.to_toml()


@given(st.floats(1e-30, 1e30), st.sampled_from(["m", "N", "Pa", "s", "m/s", "K"]))
def test_a_spelled_number_is_read_as_the_same_float(number, unit):
    assert float(units.in_unit(units.spelled(number, unit), unit)) == number


def test_load_scene_reads_a_file_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + SPHERE_TEXT.encode())
    assert load_scene(path) == parsed()


# files that a scene names


def plastic(section: str, add: str = "") -> str:
    return scene_text(add=f"{add}[body.plasticity]\n{section}")


def write(folder: FilePath, text: str, **files: str) -> FilePath:
    """bad.toml with this text, and NAME.csv beside it."""
    for name, content in files.items():
        (folder / f"{name}.csv").write_text(content)
    (folder / "bad.toml").write_text(text, encoding="utf-8")
    return folder / "bad.toml"


def test_the_python_in_the_refusal_of_a_noisy_curve_writes_the_nearest_one_that_rises(folder):
    n = 25
    strain = np.linspace(0.0, 0.1, n)
    y = 1e9 * (1 + 2 * strain) + 20e6 * np.random.default_rng(1).standard_normal(n)
    rows = "".join(f"{x!r},{s!r}\n" for x, s in zip(strain.tolist(), y.tolist(), strict=True))
    write(folder, plastic(HARDENING["table"]), curve="peeq,yield_stress_Pa\n" + rows)
    with pytest.raises(SceneError, match=r"is not available; and \d+ more. This Python writes") as refusal:
        load_scene("bad.toml")
    exec(str(refusal.value).partition("does not fall: ")[2])
    found = load_scene(write(folder, plastic(HARDENING["table"].replace("curve.csv", "rising.csv"))))
    nearest = [  # Barlow et al. 1972: of squares, the nearest curve that does not fall
        max(min(y[a : b + 1].mean() for b in range(k, n)) for a in range(k + 1)) for k in range(n)
    ]
    rows = found.body.plasticity.file
    assert [x for x, _ in rows] == list(strain)
    assert [s for _, s in rows] == pytest.approx(nearest, rel=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_a_good_scene_reads_back_from_its_resolved_form_without_its_files(folder, law):
    add = '[grid]\ndepths = ["0 um", "1 um"]\n[solver]\nmethod = "paper"\n'
    section = HARDENING[law] + 'profile = "p.csv"\nlayer_thickness = "1 um"\n'
    profile = "factor, depth_m\n2,0\n1.5,1e-6\n\n1,4e-6\n"
    scene = load_scene(write(folder, plastic(section, add), curve=CURVE, p=profile))
    for name in ("bad.toml", "curve.csv", "p.csv"):
        (folder / name).unlink()
    content = json.loads(json.dumps(resolved(scene)))
    assert Scene(**content) == scene
    assert content["solver"]["stop"] == "stress" and content["body"]["plasticity"]["law"] == law
    assert scene.body.plasticity.depth_profile() == DepthProfile((0.0, 1e-6, 4e-6), (2.0, 1.5, 1.0))


def test_contradictions_are_seen_between_sections_made_in_python():
    body = Body(young=210e9, poisson=0.3, plasticity=Plasticity(law="perfect", yield_stress=1e9))
    others = {"counterbody": CounterBody(shape="sphere", radius=1e-4), "loading": Loading(force=0.1)}
    layers = Grid(depths=(0.0, 1e-6))
    assert Scene(body=body, grid=layers, solver=Solver(method="paper"), **others).solver.stop == "stress"
    with pytest.raises(SceneError, match="faces of the layers"):
        Scene(body=body, grid=Grid(depths=(1e-6, 2e-6)), **others)
    with pytest.raises(ValidationError, match=r"less than 0\.5 with yield_stress"):
        Coating(thickness=1e-7, young=80e9, poisson=0.5, yield_stress=1e9)


def test_every_file_that_was_read_is_handed_on_for_its_hash(folder, samfem):
    (folder / "sub").mkdir()
    (folder / "sub" / "curve.csv").write_text(CURVE)
    os.symlink("sub/curve.csv", "link.csv")  # stays inside the folder
    _, inputs = read_scene(write(folder, plastic(HARDENING["table"].replace("curve.csv", "link.csv"))))
    assert list(inputs) == ["bad.toml", "link.csv"]
    assert hashlib.sha256(inputs["link.csv"]).digest() == hashlib.sha256(CURVE.encode()).digest()
    samfem("plan", "bad.toml")


def test_a_file_outside_of_the_folder_or_without_one_is_refused(folder):
    inside = folder / "scene"
    inside.mkdir()
    (folder / "curve.csv").write_text(CURVE)
    os.symlink("../curve.csv", inside / "curve.csv")
    with pytest.raises(SceneError, match="outside the folder of the scene"):
        load_scene(write(inside, plastic(HARDENING["table"])))
    with pytest.raises(SceneError, match="no folder to read files from"):
        parse_scene(plastic(HARDENING["table"]).encode(), "pasted")
