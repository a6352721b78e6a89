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

SWIFT, TABLE = GOOD["swift"], GOOD["table"]
PROFILE = "factor, depth_m\n2,0\n1.5,1e-6\n\n1,4e-6\n"


def plastic(section: str, *edits: tuple[str, str], add: str = "") -> str:
    return scene_text(*edits, add=f"{add}[body.plasticity]\n{section}")


def swift(old: str, new: str) -> str:
    assert old in SWIFT
    return plastic(SWIFT.replace(old, new))


def curve(rows: str, header: str = "peeq,yield_stress_Pa\n") -> tuple[str, dict]:
    return plastic(TABLE), {"curve.csv": header + rows}


COLUMNS = "columns peeq and yield_stress_Pa, 1 to 10000 rows"
OUTSIDE = "outside the folder of the scene"


def write(folder: Path, case: str | tuple[str, dict]) -> Path:
    text, others = (case, {}) if isinstance(case, str) else case
    for name, content in others.items():
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    path = folder / "bad.toml"
    path.write_text(text, encoding="utf-8")
    return path


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
