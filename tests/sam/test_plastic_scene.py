# SPDX-License-Identifier: MIT
"""Scenes with [body.plasticity]: laws, the files they name, contradictions; malformed ones go through the
command.
"""

import hashlib
import json
import os
from pathlib import Path

import numpy as np
import pytest
from builders import HARDENING as GOOD, YIELD_CURVE as CURVE, scene_text
from pydantic import ValidationError

from sam.scene import (
    Body,
    Coating,
    CounterBody,
    Grid,
    Loading,
    Plasticity,
    Scene,
    Solver,
    load_scene,
    parse_scene,
    read_scene,
    resolved,
)
from sam.scene.body import LAWS
from sam.scene.section import SceneError
from sam.scene.yield_curve import DepthProfile, Linear, Swift, Tabulated

SWIFT, LINEAR, PERFECT, TABLE = (GOOD[law] for law in ("swift", "linear", "perfect", "table"))
PROFILE = "factor, depth_m\n2,0\n1.5,1e-6\n\n1,4e-6\n"


def plastic(section: str, *edits: tuple[str, str], add: str = "") -> str:
    return scene_text(*edits, add=f"{add}[body.plasticity]\n{section}")


def swift(old: str, new: str) -> str:
    assert old in SWIFT
    return plastic(SWIFT.replace(old, new))


def curve(rows: str, header: str = "peeq,yield_stress_Pa\n") -> tuple[str, dict]:
    return plastic(TABLE), {"curve.csv": header + rows}


def profile(rows: str) -> tuple[str, dict]:
    return plastic(PERFECT + 'profile = "p.csv"\n'), {"p.csv": "depth_m,factor\n" + rows}


FILE, DEPTHS = (
    'body.plasticity.file = "curve.csv": ',
    "with plasticity the faces of the layers: two or more, the first 0",
)
COLUMNS = "columns peeq and yield_stress_Pa, 1 to 10000 rows"
SWIFT_TAKES = 'law = "swift" takes B, C, n'
OUTSIDE = "outside the folder of the scene"

# name -> (scene or (scene, {file: content}), fragments of the message)
MALFORMED = {
    "law missing": (
        plastic('B = "1 GPa"\n'),
        ["body.plasticity.law is missing", '"swift" or "linear" or "perfect"'],
    ),
    "unknown law": (
        plastic('law = "ramberg"\n'),
        ['body.plasticity.law = "ramberg"', '"swift", "linear", "perfect"'],
    ),
    "law a list": (plastic('law = ["swift"]\n'), ['body.plasticity.law = ["swift"]', '"table"']),
    "B missing": (swift('B = "945 MPa"\n', ""), ["body.plasticity.B is missing", SWIFT_TAKES]),
    "B bare": (
        swift('"945 MPa"', "945e6"),
        ["body.plasticity.B = 945000000.0", "a pressure as a string with a unit"],
    ),
    "B negative": (swift('"945 MPa"', '"-1 MPa"'), ['body.plasticity.B = "-1 MPa"', "from 1e-30"]),
    "C missing": (swift("C = 20\n", ""), ["body.plasticity.C is missing", SWIFT_TAKES]),
    "C zero": (swift("C = 20", "C = 0"), ["body.plasticity.C = 0", "a number from 1e-15"]),
    "C with a unit": (swift("C = 20", 'C = "20"'), ['body.plasticity.C = "20"', "a number from 1e-15"]),
    "n zero": (swift("n = 0.121", "n = 0"), ["body.plasticity.n = 0", "from 1e-06 to 0.999999"]),
    "n one": (swift("n = 0.121", "n = 1.0"), ["body.plasticity.n = 1.0", "from 1e-06 to 0.999999"]),
    "n nan": (swift("n = 0.121", "n = nan"), ["body.plasticity.n = NaN", "from 1e-06 to 0.999999"]),
    "alpha zero": (plastic(SWIFT + "alpha = 0\n"), ["body.plasticity.alpha = 0", "a number from 1e-15"]),
    "key of another law": (
        plastic(SWIFT + 'yield_stress = "1 GPa"\n'),
        ["yield_stress = ", f"{SWIFT_TAKES}, alpha: remove"],
    ),
    "alpha with linear": (
        plastic(LINEAR + "alpha = 1.0\n"),
        ["body.plasticity.alpha = 1.0", "takes yield_stress, modulus: r"],
    ),
    "modulus missing": (
        plastic(LINEAR.replace('modulus = "10.5 GPa"\n', "")),
        ["modulus is missing", "yield_stress, modulus"],
    ),
    "modulus negative": (
        plastic(LINEAR.replace('"10.5', '"-1')),
        ['body.plasticity.modulus = "-1 GPa"', "or 0"],
    ),
    "modulus with perfect": (
        plastic(PERFECT + 'modulus = "0 Pa"\n'),
        ["modulus = ", '"perfect" takes yield_stress: remove'],
    ),
    "yield stress zero": (
        plastic(PERFECT.replace('"1 GPa"', '"0 GPa"')),
        ['body.plasticity.yield_stress = "0 GPa"'],
    ),
    "yield stress missing": (plastic('law = "perfect"\n'), ["body.plasticity.yield_stress is missing"]),
    "unknown key": (
        plastic(PERFECT + "hardening = 3\n"),
        ["body.plasticity.hardening = 3", "unknown key", "layer_thickness"],
    ),
    "layer bare": (
        plastic(PERFECT + "layer_thickness = 1e-6\n"),
        ["layer_thickness = 1e-06", "a length as a string"],
    ),
    "no table": (
        scene_text(("[counterbody]", "plasticity = 3\n[counterbody]")),
        ["body.plasticity = 3", "a table"],
    ),
    "incompressible": (
        plastic(SWIFT, ("0.3", "0.5")),
        ["body.poisson = 0.5", "less than 0.5 with plasticity"],
    ),
    "coating": (
        plastic(SWIFT, add='[body.coating]\nyoung = "1 GPa"\npoisson = 0\n'),
        ["body.coating.thickness is missing"],
    ),
    "first face below": (
        plastic(SWIFT, add='[grid]\ndepths = ["1 nm", "1 um"]\n'),
        ["grid.depths = [", DEPTHS],
    ),
    "one face": (plastic(SWIFT, add='[grid]\ndepths = ["0 um"]\n'), ['grid.depths = ["0 um"]', DEPTHS]),
    "stop alone": (
        plastic(SWIFT, add='[solver]\nstop = "stress"\n'),
        ['solver.stop = "stress"', 'method = "paper"'],
    ),
    "unknown stop": (
        plastic(SWIFT, add='[solver]\nmethod = "paper"\nstop = "x"\n'),
        ["solver.stop", '"stress" or "strain"'],
    ),
    "unknown method": (
        plastic(SWIFT, add='[solver]\nmethod = "newton"\n'),
        ['solver.method = "newton"', '"paper"'],
    ),
    "tolerance": (
        plastic(SWIFT, add="[solver]\ntolerance = 1.0\n"),
        ["solver.tolerance = 1.0", "from 1e-14 to 0.1"],
    ),
    "file missing": (
        plastic('law = "table"\n'),
        ["body.plasticity.file is missing", 'law = "table" takes file'],
    ),
    "file a number": (
        plastic('law = "table"\nfile = 3\n'),
        ["body.plasticity.file = 3", "the name of a CSV file", COLUMNS],
    ),
    "rows in a file": (
        plastic('law = "table"\nfile = [[0, 1e9]]\n'),
        ["body.plasticity.file = [[0, ", "the name of a CSV"],
    ),
    "no such file": (plastic(TABLE), [FILE + "cannot be read: No such file"]),
    "file a folder": (
        plastic('law = "table"\nfile = "."\n'),
        ['body.plasticity.file = "."', "cannot be read: Is a directory"],
    ),
    "file above": (plastic('law = "table"\nfile = "../curve.csv"\n'), ['file = "../curve.csv"', OUTSIDE]),
    "file elsewhere": (plastic('law = "table"\nfile = "/etc/passwd"\n'), ['file = "/etc/passwd"', OUTSIDE]),
    "null in a name": (
        plastic('law = "table"\nfile = "a\\u0000"\n'),
        ["body.plasticity.file = ", "cannot be read"],
    ),
    "long name": (
        plastic(f'law = "table"\nfile = "{"a" * 300}"\n'),
        ["body.plasticity.file = ", "cannot be read"],
    ),
    "empty file": (curve("", ""), [FILE + 'its first line is ""', COLUMNS]),
    "no rows": (curve("\n\n"), [FILE + COLUMNS]),
    "other columns": (
        curve("0,1e9\n", "strain,stress\n"),
        [FILE + 'its first line is "strain,stress"', COLUMNS],
    ),
    "a column twice": (curve("0,1e9\n", "peeq,peeq\n"), [FILE + 'its first line is "peeq,peeq"']),
    "not CSV": (curve('0,"1e9\n'), [FILE + "not CSV"]),
    "a field too large": (curve("0," + "1" * 200_000), [FILE + "not CSV: field larger"]),
    "not UTF-8": ((plastic(TABLE), {"curve.csv": b"peeq,yield_stress_Pa\n\xff,1\n"}), [FILE + "not UTF-8"]),
    "too large": (curve("#" * (1 << 20)), [FILE + "too large: at most 1048576 bytes"]),
    "too many rows": (curve("0,1e9\n" * 10_001), [FILE + "more than 10000 rows"]),
    "three cells": (curve("0,1e9,3\n"), [FILE + 'line 2: ["0", "1e9", "3"] is not two numbers']),
    "no number": (curve("0,1 GPa\n"), [FILE + 'line 2: yield_stress_Pa = "1 GPa", allowed: a pressure']),
    "empty cell": (curve("0,\n"), [FILE + 'line 2: yield_stress_Pa = ""']),
    "nan": (curve("0,1e9\n0.1,nan\n"), [FILE + "line 3: yield_stress_Pa = NaN"]),
    "infinite": (
        curve("0,1e9\ninf,2e9\n"),
        [FILE + "line 3: peeq = Infinity, allowed: a number from 0 to 1000"],
    ),
    "negative strain": (curve("-0.1,1e9\n"), [FILE + "line 2: peeq = -0.1"]),
    "no strength": (curve("0,0\n"), [FILE + "line 2: yield_stress_Pa = 0.0"]),
    "first strain": (curve("0.002,1e9\n"), [FILE + "line 2: peeq = 0.002, allowed: 0 in the first row"]),
    "not ascending": (
        curve("0,1e9\n\n0,2e9\n"),
        [FILE + "line 4: peeq = 0 after 0, allowed: strictly ascending"],
    ),
    "softening": (
        curve("0,1e9\n0.1,9e8\n"),
        [FILE + "line 3: yield_stress_Pa = 9e+08 after 1e+09: softening is not av"],
    ),
    "many faults": (curve("0,a\n" * 7), ["line 2: ", "line 5: ", "; and 3 more"]),
    "no such profile": (
        plastic(PERFECT + 'profile = "p.csv"\n'),
        ['body.plasticity.profile = "p.csv"', "No such file"],
    ),
    "profile of a curve": (
        (plastic(PERFECT + 'profile = "curve.csv"\n'), {"curve.csv": CURVE}),
        ["depth_m and factor"],
    ),
    "depth negative": (
        profile("-1e-6,1\n"),
        ['profile = "p.csv": line 2: depth_m = -1e-06, allowed: a depth'],
    ),
    "factor zero": (profile("0,0\n"), ["line 2: factor = 0.0, allowed: a number from 1e-06"]),
    "depths not ascending": (
        profile("1e-6,1\n0,1\n"),
        ["line 3: depth_m = 0 after 1e-06, allowed: strictly asc"],
    ),
}


def write(folder: Path, case: str | tuple[str, dict]) -> Path:
    text, others = (case, {}) if isinstance(case, str) else case
    for name, content in others.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    path = folder / "bad.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("case, fragments", MALFORMED.values(), ids=MALFORMED.keys())
def test_a_malformed_plastic_scene_is_refused_by_name_and_nothing_is_created(
    folder, refused, case, fragments
):
    write(folder, case)
    message = refused("solve", "bad.toml", "--out", "out")
    assert [fragment for fragment in ["bad.toml", *fragments] if fragment not in message] == []
    assert message.count("\n") == 1 and len(message) < 1000


def test_all_errors_of_a_plastic_scene_and_its_files_are_reported_at_once(folder):
    text = plastic(
        'law = "table"\nB = "1 Pa"\nmodulus = 3\nfile = "curve.csv"\nprofile = "p.csv"\nlayer = 1\n'
    )
    text = text.replace("0.3", "0.5") + '[wear]\n[solver]\nstop = "strain"\n'
    write(folder, (text, {"curve.csv": "peeq,yield_stress_Pa\n0,x\n0.1,2e9\n0,1e9\n", "p.csv": "depth_m\n"}))
    with pytest.raises(SceneError) as caught:
        load_scene("bad.toml")
    found = {problem.key.removeprefix("body.plasticity.") for problem in caught.value.problems}
    of_others = {"body.poisson", "wear.strain_limit", "loading.unload", "solver.stop"}
    assert found == {"B", "modulus", "file", "profile", "layer", "layer_thickness"} | of_others
    (in_curve,) = (str(problem) for problem in caught.value.problems if problem.key.endswith(".file"))
    assert "line 2" in in_curve and "line 4: peeq = 0 after 0.1" in in_curve and "softening" in in_curve


def test_the_python_in_the_refusal_of_a_noisy_curve_writes_the_nearest_one_that_rises(folder, monkeypatch):
    monkeypatch.chdir(folder)
    n = 25
    strain = np.linspace(0.0, 0.1, n)
    y = 1e9 * (1 + 2 * strain) + 20e6 * np.random.default_rng(1).standard_normal(n)
    write(folder, curve("".join(f"{x!r},{s!r}\n" for x, s in zip(strain.tolist(), y.tolist(), strict=True))))
    with pytest.raises(SceneError, match=r"is not available; and \d+ more. This Python writes") as refusal:
        load_scene("bad.toml")
    exec(str(refusal.value).partition("does not fall: ")[2])
    (folder / "bad.toml").write_text((folder / "bad.toml").read_text().replace("curve.csv", "rising.csv"))
    found = load_scene("bad.toml").body.plasticity.file
    nearest = [  # Barlow et al. 1972: of squares, the nearest curve that does not fall
        max(min(y[a : b + 1].mean() for b in range(k, n)) for a in range(k + 1)) for k in range(n)
    ]
    assert [x for x, _ in found] == list(strain) and [s for _, s in found] == pytest.approx(
        nearest, rel=1e-12
    )


@pytest.mark.parametrize("law", LAWS)
def test_a_good_scene_reads_back_from_its_resolved_form_without_its_files(folder, law):
    add = '[grid]\ndepths = ["0 um", "1 um"]\n[solver]\nmethod = "paper"\n'
    section = GOOD[law] + 'profile = "p.csv"\nlayer_thickness = "1 um"\n'
    path = write(folder, (plastic(section, add=add), {"curve.csv": CURVE, "p.csv": PROFILE}))
    scene = load_scene(path)
    for name in ("bad.toml", "curve.csv", "p.csv"):
        (folder / name).unlink(missing_ok=True)
    content = json.loads(json.dumps(resolved(scene)))
    assert Scene(**content) == scene
    assert content["solver"]["stop"] == "stress" and content["body"]["plasticity"]["law"] == law
    assert scene.body.plasticity.depth_profile() == DepthProfile((0.0, 1e-6, 4e-6), (2.0, 1.5, 1.0))


def test_what_a_file_and_python_say_is_the_same(folder):
    by_file = load_scene(write(folder, (plastic(TABLE), {"curve.csv": "\ufeff" + CURVE}))).body.plasticity
    rows = [(0.0, 1e9), (0.01, 1.5e9)]
    assert by_file == Plasticity(law="table", file=rows) == Plasticity(law="table", file=np.array(rows))
    assert by_file.curve() == Tabulated((0.0, 0.01), (1e9, 1.5e9))
    laws = [
        parse_scene(plastic(GOOD[law]).encode(), "").body.plasticity.curve()
        for law in ("swift", "linear", "perfect")
    ]
    assert laws == [Swift(945e6, 20.0, 0.121, 1e6), Linear(1e9, 10.5e9), Linear(1e9)]
    assert parse_scene(swift("C = 20", "C = 20e-6\nalpha = 1").encode(), "").body.plasticity.alpha == 1.0


@pytest.mark.parametrize(
    "rows, fragment",
    [
        ("curve.csv", "rows: columns peeq"),
        ([], COLUMNS),
        ([0.0, 1e9], "row 1: 0.0 is not two numbers"),
        ([(0.0, 1e9), (0.1, 1e9, 2)], "row 2: "),
        ([(0.0, "1e9")], 'row 1: yield_stress_Pa = "1e9"'),
        (np.array([[0.0, np.nan]]), "row 1: yield_stress_Pa = NaN"),
        ([(0.0, True)], "row 1: yield_stress_Pa = true"),
        ([(0.0, 2e9), (0.1, 1e9)], "softening"),
    ],
)
def test_python_rows_are_checked_as_files_are(rows, fragment):
    with pytest.raises(ValidationError, match=fragment):
        Plasticity(law="table", file=rows)


def test_contradictions_are_seen_between_sections_made_in_python():
    body = Body(young=210e9, poisson=0.3, plasticity=Plasticity(law="perfect", yield_stress=1e9))
    others = {"counterbody": CounterBody(shape="sphere", radius=1e-4), "loading": Loading(force=0.1)}
    layers = Grid(depths=(0.0, 1e-6))
    assert Scene(body=body, grid=layers, solver=Solver(method="paper"), **others).solver.stop == "stress"
    with pytest.raises(ValidationError, match="faces of the layers"):
        Scene(body=body, grid=Grid(depths=(1e-6, 2e-6)), **others)
    with pytest.raises(ValidationError, match=r"needs \[body.plasticity\]"):
        Scene(body=Body(young=210e9, poisson=0.3), solver=Solver(method="paper"), **others)
    with pytest.raises(ValidationError, match=r"less than 0\.5 with plasticity"):
        Body(young=210e9, poisson=0.5, plasticity=body.plasticity)
    with pytest.raises(ValidationError, match=r"less than 0\.5 with yield_stress"):
        Coating(thickness=1e-7, young=80e9, poisson=0.5, yield_stress=1e9)


def test_every_file_that_was_read_is_handed_on_for_its_hash(folder, samfem):
    (folder / "sub").mkdir()
    (folder / "sub" / "curve.csv").write_text(CURVE)
    os.symlink("sub/curve.csv", "link.csv")  # stays inside the folder
    _, inputs = read_scene(write(folder, plastic(TABLE.replace("curve.csv", "link.csv"))))
    assert list(inputs) == ["bad.toml", "link.csv"]
    assert hashlib.sha256(inputs["link.csv"]).digest() == hashlib.sha256(CURVE.encode()).digest()
    samfem("plan", "bad.toml")


def test_a_link_out_of_the_folder_is_refused(folder):
    inside = folder / "scene"
    inside.mkdir()
    (folder / "curve.csv").write_text(CURVE)
    os.symlink("../curve.csv", inside / "curve.csv")
    with pytest.raises(SceneError, match=OUTSIDE):
        load_scene(write(inside, plastic(TABLE)))


def test_bytes_without_a_folder_cannot_name_files():
    with pytest.raises(SceneError, match="no folder to read files from"):
        parse_scene(plastic(TABLE).encode(), "pasted")


def test_a_given_traction_beyond_the_shear_strength_is_refused():
    """Mean traction 2/3 mu p0 <= sigma_y/sqrt(3): beyond it the loaded circle slides off, unless the body
    hardens.
    """
    keys = {
        "body": {"young": 210e9, "poisson": 0.3, "plasticity": {"law": "perfect", "yield_stress": 1e9}},
        "loading": {"prescribed": "hertz", "p0": 0.866e9, "radius": 4e-6},
        "friction": {"coefficient": 1.0},
    }
    Scene.model_validate(keys)
    beyond = keys | {"loading": keys["loading"] | {"p0": 0.867e9}}
    with pytest.raises(ValidationError, match=r"at most 8\.66e\+08 Pa with friction\.coefficient = 1"):
        Scene.model_validate(beyond)
    hardens = keys["body"] | {"plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 1e9}}
    Scene.model_validate(beyond | {"body": hardens})
    Scene.model_validate({name: table for name, table in beyond.items() if name != "friction"})
