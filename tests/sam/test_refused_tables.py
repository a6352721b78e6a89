# SPDX-License-Identifier: MIT
"""What is refused of a layer in Python and of a counter-surface in a file, by key, value and what is
allowed; the other way round `test_layer` and `test_counter_surface` have it.
"""

import re

import pytest
from builders import LINEAR, SPHERE, SWIFT
from pydantic import ValidationError

from sam.scene import Scene, load_scene
from sam.scene.section import SceneError

THICK = SWIFT | {"layer_thickness": 1e-6}
SOFT = SWIFT | {"alpha": 1e3}
NO_C = {key: value for key, value in SOFT.items() if key != "C"}
AT = "body.plasticity.layer"
# keys of the body, its layer: key that is named, value, what is allowed
LAYERS = [
    (SWIFT, SOFT, f"{AT}_thickness", "", "the thickness of the layer"),
    (SWIFT | {"layer_thickness": 0.0}, SOFT, f"{AT}_thickness", "0.0", "a length from 1e-30"),
    (SWIFT | {"layer_thickness": -1e-6}, SOFT, f"{AT}_thickness", "-1e-06", "a length from 1e-30"),
    (SWIFT | {"layer_thickness": float("nan")}, SOFT, f"{AT}_thickness", "nan", "a length from 1e-30"),
    (SWIFT | {"layer_thickness": "1 N"}, SOFT, f"{AT}_thickness", "1 N", "a length from 1e-30"),
    (THICK, 3, AT, "3", "a table"),
    (THICK, [SOFT], AT, "swift", "a table"),
    (THICK, {}, f"{AT}.law", "", 'required: "swift" or "linear"'),
    (THICK, {"law": "voce"}, f"{AT}.law", "voce", 'one of "swift", "linear", "perfect" or "table"'),
    (THICK, {"law": None}, f"{AT}.law", "", '"swift", "linear", "perfect" or "table"'),
    (THICK, NO_C, f"{AT}.C", "", 'law = "swift" takes B, C, n'),
    (THICK, SOFT | {"B": -1.0}, f"{AT}.B", "-1.0", "a pressure from 1e-30"),
    (THICK, SOFT | {"B": "945 um"}, f"{AT}.B", "945 um", "a pressure from 1e-30"),
    (THICK, SOFT | {"B": float("inf")}, f"{AT}.B", "inf", "a pressure from 1e-30"),
    (THICK, SOFT | {"C": 0.0}, f"{AT}.C", "0.0", "a number from 1e-15"),
    (THICK, SOFT | {"n": 1.5}, f"{AT}.n", "1.5", "a number from 1e-06 to 0.999999"),
    (THICK, SOFT | {"alpha": True}, f"{AT}.alpha", "True", "a number from 1e-15"),
    (THICK, LINEAR | {"n": 0.1}, f"{AT}.n", "0.1", 'law = "linear" takes yield_stress, modulus: remove it'),
    (THICK, SOFT | {"yield_stress": 1e9}, f"{AT}.yield_stress", "1000000000.0", "remove it"),
    (
        THICK,
        {"law": "perfect", "yield_stress": 1e9, "modulus": 1e9},
        f"{AT}.modulus",
        "1000000000.0",
        "remove it",
    ),
    (THICK, LINEAR | {"modulus": -1.0}, f"{AT}.modulus", "-1.0", "to 1e+30 Pa or 0"),
    (THICK, {"law": "table", "file": ((0.0, 1e9), (0.1, 9e8))}, f"{AT}.file", "900000000.0", "softening"),
    (THICK, {"law": "table", "file": ((0.1, 1e9),)}, f"{AT}.file", "0.1", "peeq"),
    (THICK, SOFT | {"profile": ((0.0, 1.0),)}, f"{AT}.profile", "1.0", "unknown key"),
    (THICK, SOFT | {"aplha": 1e3}, f"{AT}.aplha", "1000.0", "did you mean"),
]
STEEL = {"young": 210e9, "poisson": 0.3}
MPA = {"law": "table", "file": ((0.0, 355.0), (0.01, 450.0))}  # in MPa, under a column in Pa
PERFECT = {"law": "perfect", "yield_stress": 355e6}
FILM = {"thickness": 1e-6, "young": 300e9, "poisson": 0.25}
FILMED = {"law": "chemical-film", "low": 0.1, "high": 0.4, "film_thickness": 1e-7, "film_young": 70e9}
FILMED |= {"film_poisson": 0.3, "strain_limit": 0.1}
# the body, and friction: key that is named, what is said of it; or nothing, where it is taken
MATERIALS = [
    (
        {"plasticity": MPA},
        None,
        "body.plasticity.file",
        "column yield_stress_Pa: .* at a plastic strain of 0.002: it is 374 Pa: are values in MPa",
    ),
    ({"plasticity": SWIFT | {"B": 945.0}}, None, "body.plasticity.B", "at least 2.1e.06 Pa"),
    (
        {"plasticity": PERFECT | {"profile": ((0.0, 1.0), (1e-5, 1e-3))}},
        None,
        "body.plasticity.profile",
        "factors from 0.001",
    ),
    (
        {"plasticity": THICK | {"layer": PERFECT | {"yield_stress": 1.0}}},
        None,
        f"{AT}.yield_stress",
        "it is 1 Pa",
    ),
    ({"coating": FILM | {"yield_stress": 4e3}}, None, "body.coating.yield_stress", "at least 3e.06 Pa"),
    ({}, FILMED | {"film_yield": 700.0}, "friction.film_yield", "film_young/100000"),
    ({"young": 11e9, "plasticity": PERFECT | {"yield_stress": 1e6}}, None, "", ""),  # annealed indium
    ({"young": 1141e9, "plasticity": PERFECT | {"yield_stress": 80e9}}, None, "", ""),  # diamond
    ({"plasticity": SWIFT | {"C": 1e-15, "n": 0.5}}, None, "", ""),  # rises from nearly 0
    ({"plasticity": PERFECT | {"yield_stress": 1e12}}, None, "", ""),  # never yields
]
WAVE = {"kind": '"sinusoid"', "amplitude": '"0.1 um"', "wavelength_x": '"10 um"', "wavelength_y": '"8 um"'}
DISC = {"kind": '"self-affine"', "sq": '"20 nm"', "cutoff_long": '"16 um"', "cutoff_short": '"8 um"'}
DISC |= {"hurst": "0.8", "seed": "5", "renew": "true"}
NO_SEED = {key: value for key, value in DISC.items() if key != "seed"}
MAP = {"kind": '"file"', "path": '"map.csv"', "renew": "true"}
ON = "counterbody.surface"
# the keys of the table: key that is named, value, what is allowed
SURFACES = [
    ({}, f"{ON}.kind", "is missing", '"file" or "hard-turned" or "self-affine" or "sinusoid"'),
    (WAVE | {"kind": '"waves"'}, f"{ON}.kind", '= "waves"', '"self-affine" or "sinusoid"'),
    (WAVE | {"amplitude": '"0 um"'}, f"{ON}.amplitude", '= "0 um"', "from 1e-30 to 1e+30 m"),
    (WAVE | {"amplitude": "0.1"}, f"{ON}.amplitude", "= 0.1", 'a string with a unit, such as "10 um"'),
    (WAVE | {"amplitude": '"0.1 N"'}, f"{ON}.amplitude", '= "0.1 N"', "a length as a string"),
    (WAVE | {"seed": "1"}, f"{ON}.seed", "= 1", "takes amplitude, wavelength_x, wavelength_y: remove it"),
    (DISC | {"renew": "1"}, f"{ON}.renew", "= 1", "true or false"),
    (DISC | {"renew": '"each"'}, f"{ON}.renew", '= "each"', "true or false"),
    (DISC | {"renewed": "true"}, f"{ON}.renewed", "= true", "did you mean renew?"),
    (DISC | {"renew": "[true]"}, f"{ON}.renew", "= [true]", "true or false"),
    (DISC | {"seed": "-1"}, f"{ON}.seed", "= -1", "a whole number from 0"),
    (DISC | {"seed": '"5"'}, f"{ON}.seed", '= "5"', "a whole number from 0"),
    (DISC | {"seed": "9223372036854775808"}, f"{ON}.seed", "= 9223372036854775808", "to 9.22337e+18"),
    (NO_SEED, f"{ON}.seed", "is missing", "takes cutoff_long, cutoff_short, hurst, seed"),
    (DISC | {"ra": '"20 nm"'}, f"{ON}.sq", '= "20 nm"', "either ra or sq"),
    (DISC | {"feed": '"80 um"'}, f"{ON}.feed", '= "80 um"', "remove it"),
    (DISC | {"hurst": "2.0"}, f"{ON}.hurst", "= 2.0", "a number from 0 to 1"),
    (DISC | {"cutoff_long": '"4 um"'}, f"{ON}.cutoff_short", '= "8 um"', "less than cutoff_long, 4e-06 m"),
    (DISC | {"cutoff_short": '"1 um"'}, "grid.cells", "= [32, 32]", "at least [40, 40]"),
    (DISC | {"crop": '["4 um", "4 um"]'}, f"{ON}.crop", '= ["4 um", "4 um"]', "remove it"),
    (MAP | {"path": '"none.csv"'}, f"{ON}.path", '= "none.csv"', "No such file"),
    (MAP | {"path": "3"}, f"{ON}.path", "= 3", "the name of a CSV or npz file"),
    (MAP, f"{ON}.renew", "= true", "no second part of the size of counterbody.surface.crop"),
    (MAP | {"crop": '["5 um", "6 um"]'}, f"{ON}.renew", "= true", "false: no second part"),
    (MAP | {"crop": '["9 um", "9 um"]'}, f"{ON}.crop", '= ["9 um", "9 um"]', "8e-06 m"),
]
PLACES = [
    ("renew = true\n", "counterbody.renew", "= true", "did you mean counterbody.surface.renew?"),
    ("seed = 3\n", "counterbody.seed", "= 3", "did you mean counterbody.surface.seed"),
    ("surface = 3\n", "counterbody.surface", "= 3", "a table"),
    ('surface = "map.csv"\n', "counterbody.surface", '= "map.csv"', "a table"),
]
STEEL = {"young": 210e9, "poisson": 0.3}
TEXT = """[body]
young = "210 GPa"
poisson = 0.3
[loading]
force = "20 mN"
cycles = 2
unload = true
[grid]
cells = [32, 32]
extent = ["20 um", "20 um"]
[counterbody]
shape = "flat"
"""


def table(keys: dict) -> str:
    """The table of a counter-surface in a file."""
    return "[counterbody.surface]\n" + "".join(f"{key} = {value}\n" for key, value in keys.items())


FILES = [(table(keys), *told) for keys, *told in SURFACES] + PLACES


@pytest.mark.parametrize("body, friction, key, words", MATERIALS)
def test_a_yield_stress_in_another_unit_than_youngs_modulus_is_refused(body, friction, key, words):
    tables = {"body": STEEL | body, "counterbody": SPHERE, "loading": {"force": 1.0}}
    tables |= {"friction": friction} if friction else {}
    if not key:
        assert Scene(**tables)
        return
    with pytest.raises(ValidationError, match=words) as error:
        Scene(**tables)
    assert [".".join(item["loc"]) for item in error.value.errors()] == [key]


@pytest.mark.parametrize(("body", "layer", "key", "value", "allowed"), LAYERS)
def test_a_malformed_layer_is_refused_by_name_in_python(body, layer, key, value, allowed):
    with pytest.raises(ValidationError) as caught:
        Scene(
            body={**STEEL, "plasticity": {**body, "layer": layer}}, counterbody=SPHERE, loading={"force": 0.1}
        )
    found = {".".join(map(str, each["loc"])): each for each in caught.value.errors()}
    assert key in found
    assert allowed in found[key]["msg"] and value in str(found[key]["input"])


@pytest.mark.parametrize(("text", "key", "value", "allowed"), FILES)
def test_a_malformed_counter_surface_is_refused_by_name_in_a_file(tmp_path, text, key, value, allowed):
    rows = [f"{x}e-6,{y}e-6,{x % 2}e-8\n" for x in range(8) for y in range(8)]
    (tmp_path / "map.csv").write_text("x_m,y_m,height_m\n" + "".join(rows))
    (tmp_path / "bad.toml").write_text(TEXT + text)
    with pytest.raises(SceneError) as caught:
        load_scene(tmp_path / "bad.toml")
    (line,) = [line for line in str(caught.value).splitlines() if re.search(rf"\b{key} ", line)]
    assert f"{key} {value}: " in line and allowed in line


def test_no_two_of_them_are_the_same():
    for cases in (LAYERS, FILES):
        assert len({repr(case[:-3]) for case in cases}) == len(cases)
    assert len(LAYERS) + len(FILES) >= 50
