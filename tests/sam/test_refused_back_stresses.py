# SPDX-License-Identifier: MIT
"""What is refused of back-stresses and of the verdict, in Python and in a file: by key, value and what is
allowed.
"""

import re

import pytest
from builders import SPHERE, SWIFT
from pydantic import ValidationError

from sam.scene import Scene, load_scene
from sam.scene.section import SceneError

AT = "body.plasticity.kinematic"
GOOD = {"modulus": (1e9, 2e9), "recovery": (300.0, 0.0)}
MODULUS, LIST = "a pressure from 1e-30", "a list of 1 to 8"
RECOVERY = "a number from 0 to 1e+07"
# the table: key that is named, value, what is allowed
IN_PYTHON = [
    ({}, f"{AT}.modulus", "", "required"),
    ({"recovery": (1.0,)}, f"{AT}.modulus", "", "required"),
    ({"modulus": ()}, f"{AT}.modulus", "()", LIST),
    ({"modulus": (1e9,) * 9}, f"{AT}.modulus", "1000000000.0", LIST),
    ({"modulus": 1e9}, f"{AT}.modulus", "1000000000.0", LIST),
    ({"modulus": "1 GPa"}, f"{AT}.modulus", "1 GPa", LIST),
    ({"modulus": None}, f"{AT}.modulus", "None", LIST),
    ({"modulus": {"first": 1e9}}, f"{AT}.modulus", "first", LIST),
    ({"modulus": (0.0,)}, f"{AT}.modulus.0", "0.0", MODULUS),
    ({"modulus": (1e9, -1e9)}, f"{AT}.modulus.1", "-1000000000.0", MODULUS),
    ({"modulus": (float("nan"),)}, f"{AT}.modulus.0", "nan", MODULUS),
    ({"modulus": (float("inf"),)}, f"{AT}.modulus.0", "inf", MODULUS),
    ({"modulus": (True,)}, f"{AT}.modulus.0", "True", MODULUS),
    ({"modulus": ("1 um",)}, f"{AT}.modulus.0", "1 um", MODULUS),
    ({"modulus": ("one GPa",)}, f"{AT}.modulus.0", "one GPa", MODULUS),
    ({"modulus": ((1e9,),)}, f"{AT}.modulus.0", "1000000000.0", MODULUS),
    ({"modulus": (1e31,)}, f"{AT}.modulus.0", "1e+31", MODULUS),
    (GOOD | {"recovery": 300.0}, f"{AT}.recovery", "300.0", LIST),
    (GOOD | {"recovery": ()}, f"{AT}.recovery", "()", LIST),
    (GOOD | {"recovery": (1.0,) * 9}, f"{AT}.recovery", "1.0", LIST),
    (GOOD | {"recovery": (1.0,)}, f"{AT}.recovery", "1.0", "as many numbers as modulus has: 2"),
    (GOOD | {"recovery": (1.0,) * 3}, f"{AT}.recovery", "1.0", "as many numbers as modulus has: 2"),
    (GOOD | {"recovery": (-1.0, 0.0)}, f"{AT}.recovery.0", "-1.0", RECOVERY),
    (GOOD | {"recovery": (0.0, 2e7)}, f"{AT}.recovery.1", "20000000.0", RECOVERY),
    (GOOD | {"recovery": (float("nan"), 0.0)}, f"{AT}.recovery.0", "nan", RECOVERY),
    (GOOD | {"recovery": (float("inf"), 0.0)}, f"{AT}.recovery.0", "inf", RECOVERY),
    (GOOD | {"recovery": ("300", 0.0)}, f"{AT}.recovery.0", "300", RECOVERY),
    (GOOD | {"recovery": (True, 0.0)}, f"{AT}.recovery.0", "True", RECOVERY),
    (GOOD | {"moduli": (1e9,)}, f"{AT}.moduli", "1000000000.0", "allowed here: modulus, recovery"),
    (GOOD | {"law": "prager"}, f"{AT}.law", "prager", "unknown key"),
    (GOOD | {"yield_stress": 1e9}, f"{AT}.yield_stress", "1000000000.0", "unknown key"),
    ([GOOD], AT, "modulus", "a table"),
    (3, AT, "3", "a table"),
    ("prager", AT, "prager", "a table"),
]
KEYS = {"modulus": '["1 GPa", "2 GPa"]', "recovery": "[300, 0]"}
IN_FILE = [
    ({"recovery": "[300]"}, f"{AT}.modulus", "is missing", "required"),
    (KEYS | {"modulus": "[]"}, f"{AT}.modulus", "= []", LIST),
    (KEYS | {"modulus": '"1 GPa"'}, f"{AT}.modulus", '= "1 GPa"', LIST),
    (KEYS | {"modulus": "[1e9, 2e9]"}, f"{AT}.modulus[0]", "1000000000.0", "a pressure as a string"),
    (KEYS | {"modulus": '["1 GPa", "2 um"]'}, f"{AT}.modulus[1]", '"2 um"', "a pressure as a string"),
    (KEYS | {"modulus": '["1 GPa", "-2 GPa"]'}, f"{AT}.modulus[1]", '"-2 GPa"', "a pressure as a string"),
    (KEYS | {"modulus": '["0 GPa", "2 GPa"]'}, f"{AT}.modulus[0]", '"0 GPa"', "a pressure as a string"),
    (KEYS | {"modulus": '["1 GPa", "2"]'}, f"{AT}.modulus[1]", '"2"', "a pressure as a string"),
    (KEYS | {"modulus": '["1 GPa", ""]'}, f"{AT}.modulus[1]", '""', "a pressure as a string"),
    (KEYS | {"recovery": "[300]"}, f"{AT}.recovery", "300", "as many numbers as modulus has: 2"),
    (KEYS | {"recovery": "300"}, f"{AT}.recovery", "= 300", LIST),
    (KEYS | {"recovery": "[-1, 0]"}, f"{AT}.recovery[0]", "-1", RECOVERY),
    (KEYS | {"recovery": '["1", 0]'}, f"{AT}.recovery[0]", '"1"', RECOVERY),
    (KEYS | {"recovery": "[nan, 0]"}, f"{AT}.recovery[0]", "NaN", RECOVERY),
    (KEYS | {"recovery": "[1e8, 0]"}, f"{AT}.recovery[0]", "100000000.0", RECOVERY),
    (KEYS | {"modulus": '["nan GPa", "2 GPa"]'}, f"{AT}.modulus[0]", '"nan GPa"', "a pressure as a string"),
    (KEYS | {"modulus": '["1 GPa", true]'}, f"{AT}.modulus[1]", "true", "a pressure as a string"),
    (KEYS | {"modulus": str(["1 GPa"] * 9)}, f"{AT}.modulus", "1 GPa", LIST),
    (KEYS | {"recovery": "[300, inf]"}, f"{AT}.recovery[1]", "Infinity", RECOVERY),
    (KEYS | {"recovery": "[]"}, f"{AT}.recovery", "= []", LIST),
    (KEYS | {"recovery": "[[300, 0], 1]"}, f"{AT}.recovery[0]", "[300, 0]", RECOVERY),
    (KEYS | {"recover": "[1, 0]"}, f"{AT}.recover", "[1, 0]", "did you mean recovery?"),
    (KEYS | {"C": '["1 GPa"]'}, f"{AT}.C", "1 GPa", "unknown key"),
]
SOLVER = [
    ({"verdict": 1}, "solver.verdict", "1", "true or false"),
    ({"verdict": "yes"}, "solver.verdict", "yes", "true or false"),
    ({"verdict": 0.0}, "solver.verdict", "0.0", "true or false"),
    ({"verdict": (True,)}, "solver.verdict", "True", "true or false"),
    ({"verdict": None}, "solver.verdict", "None", "true or false"),
    ({"verdicts": True}, "solver.verdicts", "True", "did you mean verdict?"),
    ({"method": "paper"}, "solver.method", "paper", "the loop of the paper knows no back-stress"),
]


def scene(kinematic, layer=None, solver=None):
    """A sphere on Swift steel."""
    plasticity = SWIFT | {"kinematic": kinematic}
    if layer is not None:
        plasticity |= {"layer_thickness": 1e-6, "layer": SWIFT | {"kinematic": layer}}
    body = {"young": 210e9, "poisson": 0.3, "plasticity": plasticity}
    return Scene(body=body, counterbody=SPHERE, loading={"force": 1.0}, solver=solver or {})


def said(error):
    """Key, value and what is allowed of each line."""
    return [(".".join(map(str, one["loc"])), str(one["input"]), one["msg"]) for one in error.errors()]


@pytest.mark.parametrize(("kinematic", "key", "value", "allowed"), IN_PYTHON)
@pytest.mark.parametrize("layer", [False, True], ids=["body", "layer"])
def test_refused_in_python(kinematic, key, value, allowed, layer):
    with pytest.raises(ValidationError) as caught:
        scene(None, kinematic) if layer else scene(kinematic)
    key = key.replace(AT, "body.plasticity.layer.kinematic") if layer else key
    found = [line for line in said(caught.value) if line[0] == key]
    assert found and value in found[0][1] and allowed in found[0][2]


@pytest.mark.parametrize(("solver", "key", "value", "allowed"), SOLVER)
def test_refused_of_the_solver(solver, key, value, allowed):
    with pytest.raises(ValidationError) as caught:
        scene(GOOD, solver=solver)
    assert [line for line in said(caught.value) if line[0] == key and value in line[1] and allowed in line[2]]


@pytest.mark.parametrize(("keys", "key", "value", "allowed"), IN_FILE)
def test_refused_in_a_file(tmp_path, keys, key, value, allowed):
    text = '[body]\nyoung = "210 GPa"\npoisson = 0.3\n'
    text += '[body.plasticity]\nlaw = "perfect"\nyield_stress = "1 GPa"\n'
    text += "[body.plasticity.kinematic]\n" + "".join(f"{name} = {said}\n" for name, said in keys.items())
    text += '[counterbody]\nshape = "sphere"\nradius = "1 mm"\n[loading]\nforce = "1 N"\n'
    (tmp_path / "scene.toml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        load_scene(tmp_path / "scene.toml")
    line = next(line for line in str(caught.value).splitlines() if re.search(re.escape(key) + r"\b|\]", line))
    assert key in line and value in line and allowed in line
