# SPDX-License-Identifier: MIT
"""The Python module samfem: what it returns, reads and draws, and its page; what is in the wheel: all that
runs, nothing that only tests and maintainers need.
"""

import doctest
import fnmatch
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from builders import COARSE, parsed, scene_text
from pandas.testing import assert_frame_equal
from setuptools import find_namespace_packages

import sam
import samfem
from samfem import cli, python
from samfem.cli import main
from verification import EXTRAS

ROOT = Path(__file__).resolve().parents[2]
STEEL = {"young": "210 GPa", "poisson": 0.3}


@pytest.fixture(scope="module")
def run():
    return samfem.solve(parsed())


@pytest.fixture(scope="module")
def comparison():
    return samfem.compare(parsed())


def ended(*words: str, folder: Path, **environment: str) -> subprocess.CompletedProcess:
    """A process of Python in a folder that finds this source."""
    path = os.pathsep.join([environment.pop("first", ""), str(ROOT)]).strip(os.pathsep)
    known = {**os.environ, "PYTHONPATH": path, "MPLBACKEND": "Agg", **environment}
    return subprocess.run([sys.executable, *words], cwd=folder, env=known, capture_output=True, text=True)


def test_the_examples_of_the_module_hold():
    found = doctest.testmod(samfem)
    assert found.failed == 0 and found.attempted > 3


@pytest.mark.parametrize("model", ["sam", "fem-axisymmetric"])
def test_a_run_in_memory_is_the_run_that_is_written_and_read(tmp_path, model):
    scene = parsed(add="unload = true\n" + COARSE)
    solved = samfem.solve(scene, model)
    written = solved.save(tmp_path / "run")
    assert solved.folder is None and written.folder == tmp_path / "run"
    assert solved.quantities == written.quantities and solved.scene == written.scene == scene
    for name, table in samfem.read(tmp_path / "run").tables.items():
        assert_frame_equal(table, solved.tables[name])
    for part in ("body", "surface"):
        for unloaded in (False, True):
            mesh, read = (each.mesh(part, unloaded=unloaded) for each in (solved, written))
            assert np.array_equal(mesh.points, read.points) and mesh.n_cells == read.n_cells
            for fields, others in ((mesh.point_data, read.point_data), (mesh.cell_data, read.cell_data)):
                assert sorted(fields) == sorted(others)
                assert all(np.array_equal(fields[name], others[name], equal_nan=True) for name in fields)
    with pytest.raises(samfem.FolderError, match="no mesh edge-unloaded: it has surface, fields,"):
        solved.mesh("edge", unloaded=True)


def test_warnings_are_listed_shown_and_issued():
    rough = {"kind": "sinusoid", "amplitude": "0.1 um", "wavelength_x": "4 um"}
    grid = {"cells": np.array([16, 16]), "extent": np.full(2, 16e-6)}
    tables = {"counterbody": {"shape": "flat", **STEEL}, "loading": {"force": 0.1}, "surface": rough}
    with pytest.warns(UserWarning, match=".") as heard:
        found = samfem.solve(samfem.Scene(body=STEEL, grid=grid, **tables))
    issued = [(words, __file__) for words in found.warnings if words not in found.range_lines]
    assert [(str(each.message), each.filename) for each in heard] == issued
    assert "\nwarning: the contact touches the edge of the grid" in str(found)
    assert "<p>warning: the contact touches" in found._repr_html_()
    assert not any(value for name, value in found.quantities.items() if "_center_" in name)


def test_figures_are_named_and_an_unknown_one_is_refused(run, comparison, monkeypatch):
    each = {id(result): python._drawings(result) for result in (run, comparison)}  # drawn once
    monkeypatch.setattr(python, "_drawings", lambda result: each[id(result)])
    assert {"history", "pressure"} <= set(samfem.plot(run))
    assert samfem.plot(run, "pressure").axes and comparison.plot("history").axes
    assert run.plot()._repr_png_()[0].startswith(b"\x89PNG")  # what a notebook shows
    assert {"line", "axis", "history"} <= set(samfem.plot(comparison))
    with pytest.raises(KeyError, match="this result has the figures history"):
        samfem.plot(run, "colour")


def test_a_comparison_passes_and_fails_with_its_rows_and_is_read_back(folder, comparison):
    assert comparison.passed and comparison.check() is None
    assert (comparison.frame["difference"] <= comparison.frame["tolerance"]).all()
    assert re.match(r"sam: .* cells of .*\nfem-axisymmetric: .* elements, .*\n\d+ of", str(comparison))
    assert "of its tolerance" in repr(comparison) and "<table" in comparison._repr_html_()
    strict = samfem.compare(parsed(), tolerances={"p_max_Pa": 1e-9})
    with pytest.raises(AssertionError, match="p_max_Pa"):
        strict.check()
    (folder / "sphere.toml").write_text(scene_text())
    assert main(["compare", "sphere.toml", "--out", "both"]) == 0
    read = samfem.read("both")
    columns = ["quantity", "sam", "fem", "tolerance", "passed"]
    assert_frame_equal(read.frame[columns], comparison.frame[columns])
    assert read.passed and read.sam.model == "sam" and read.fem.model == "fem-axisymmetric"


def test_a_sweep_of_a_mapping_leaves_nothing(folder):
    told = []
    vary = {"loading.force": np.array([0.1, 0.2]), "body.young": ["70 GPa", 210e9]}
    study = {"scene": parsed(add=COARSE), "vary": vary, "mode": "zip"}
    found = samfem.sweep(study, workers=1, progress=lambda *state: told.append(state))
    assert list(found.frame["loading.force"]) == [0.1, 0.2] and found.record["units"]["loading.force"] == "N"
    assert list(found.frame["body.young"]) == [70e9, 210e9] and found.plot().axes
    assert told[-1] == ("sweep", 2, 2) and list(folder.iterdir()) == []
    with pytest.raises(samfem.FolderError, match='out="folder"'):
        found.run(0)
    with pytest.raises(samfem.SceneError, match=r"vary\.loading\.force\.list = "):
        samfem.sweep(study | {"vary": {"loading.force": []}})
    with pytest.raises(samfem.SceneError, match="scene is missing"):
        samfem.sweep({"vary": vary})


def test_progress_is_told_and_else_silent(capsys):
    told = []
    samfem.solve(parsed(), progress=lambda *state: told.append(state))
    assert ("sam: stress", 1, 1) in told and capsys.readouterr() == ("", "")


def test_wrong_input_is_refused_by_name(tmp_path):
    with pytest.raises(
        samfem.ModelError, match="'fem-2d', allowed: sam, fem-axisymmetric, fem-3d, fem-plane"
    ):
        samfem.solve(parsed(), "fem-2d")
    with pytest.raises(samfem.FolderError, match="no result"):
        samfem.read(tmp_path)
    (tmp_path / "mine.txt").write_text("")
    with pytest.raises(samfem.FolderError, match=r"holds mine\.txt"):
        samfem.solve(parsed(), out=tmp_path)
    (tmp_path / "bad.toml").write_text("[body]\n")
    with pytest.raises(samfem.SceneError, match=r"body\.young"):
        samfem.load(tmp_path / "bad.toml")


FROM_PYTHON, COMMAND = ("-c", "import samfem; samfem.solve"), ("-m", "samfem.cli", "schema")


@pytest.mark.parametrize(
    ("name", "words"), [("sam", FROM_PYTHON), ("verification", FROM_PYTHON), ("verification", COMMAND)]
)
def test_another_distribution_of_the_same_name_is_named(tmp_path, name, words):
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("")
    found = ended(*words, folder=tmp_path, first=str(tmp_path))
    assert found.returncode == 1 and found.stderr.count("Traceback") == (words == FROM_PYTHON)
    assert f"needs its own package {name}" in found.stderr and f"{tmp_path}" in found.stderr


def test_a_distribution_that_wrote_over_ours_is_named_by_the_command_too(monkeypatch, capsys):
    monkeypatch.setattr(cli, "_run", lambda _: sam.no_such_name)
    assert cli.main(["schema"]) == 1 and "internal error" in capsys.readouterr().err
    monkeypatch.delattr(sam, "__all__")  # as `pip install sam` leaves it
    assert cli.main(["schema"]) == 1
    words = capsys.readouterr().err
    assert "needs its own package sam" in words and sam.__file__ in words and words.count("\n") == 1


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OWN = ("samfem", "sam", "fem_reference", "verification")
LEFT_OUT = "verification/robustness/mutants/"
STUDY = """
scene = "s.toml"
[vary]
"loading.force" = { list = ["0.05 N", "0.1 N"] }
"""
CORE = """
from pathlib import Path
import samfem
from samfem.cli import main
from verification.runs.meshes import read_mesh
if __name__ == "__main__":
    print([main(words.split()) for words in (
        "plan s.toml", "solve s.toml", "compare s.toml", "sweep study.toml --workers 1",
        "solve s.toml --figures", "compare s.toml --report r", "view s-sam",
        "export s-sam --format inp", "verify",
    )])
    print(samfem.read("study-sweep").run(1).tables["history"]["force_N"].to_list())
    for late in (samfem.plot, lambda _: read_mesh(Path("a.vtu"))):
        try:
            late(samfem.read("s-sam"))
        except ImportError as error:
            print(error)
"""


def test_the_wheel_has_every_file_of_the_packages_but_the_mutation_check():
    """By the rules of pyproject.toml, as setuptools reads them."""
    tools = PROJECT["tool"]["setuptools"]
    patterns = ["*.py", *tools["package-data"]["*"]]
    packages = find_namespace_packages(ROOT, **tools["packages"]["find"])
    files = [path for name in OWN for path in (ROOT / name).rglob("*") if path.is_file()]
    source = {path.relative_to(ROOT) for path in files if "__pycache__" not in path.parts}
    taken = {
        path
        for path in source
        if ".".join(path.parts[:-1]) in packages
        and any(fnmatch.fnmatch(path.name, each) for each in patterns)
    }
    left_out = {path.as_posix() for path in source - taken}
    assert left_out and all(name.startswith(LEFT_OUT) for name in left_out)
    project = PROJECT["project"]
    extras = project["optional-dependencies"]["report"]
    assert {each.split(">=")[0] for each in extras} == set(EXTRAS["report"])
    assert project["license"] == "MIT" and project["license-files"] == ["LICENSE"]
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")


def test_without_its_extras_samfem_solves_and_the_rest_says_what_to_install(tmp_path):
    """In processes that find none of the packages, the workers of a sweep too."""
    absent = dict.fromkeys((*EXTRAS["report"], "vtkmodules", *EXTRAS["html"]))
    (tmp_path / "sitecustomize.py").write_text(f"import sys\nsys.modules.update({absent})")
    for name, text in (("s.toml", scene_text()), ("study.toml", STUDY), ("core.py", CORE)):
        (tmp_path / name).write_text(text)
    environment = os.environ | {"PYTHONPATH": f"{tmp_path}:{ROOT}", "SAMFEM_STORE": str(tmp_path / "store")}
    how = {"text": True, "cwd": tmp_path, "env": environment, "capture_output": True, "check": True}
    done = subprocess.run([sys.executable, "core.py"], **how)
    codes, force, *said = done.stdout.splitlines()[-4:]
    assert codes == str([0] * 4 + [2] * 5) and force == "[0.1]"
    left_out = "surface.vtr, fields.vtu, run.pvd (vtk is not installed: pip install 'samfem[report]')"
    said += done.stderr.splitlines()
    assert said.count(f"samfem: sam: left out: {left_out}") == 2
    packages = ", ".join(EXTRAS["report"])
    for what in ("a figure", "reading a mesh", "--figures", "--report", "samfem view", "samfem verify"):
        assert any(f"{what} needs {packages}: pip install 'samfem[report]'" in line for line in said)
    summary = json.loads((tmp_path / "s-sam/summary.json").read_text())
    assert summary["left_out"][-1] == {"stage": "meshes", "reason": left_out}
    assert not [*tmp_path.glob("*/*.vt*"), *tmp_path.glob("*/*.pvd"), *tmp_path.rglob("*.png")]
