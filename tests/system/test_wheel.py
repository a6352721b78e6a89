# SPDX-License-Identifier: MIT
"""What is in the wheel: all that runs, nothing that only tests and maintainers need; cases of an extra."""

import fnmatch
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

from builders import scene_text
from setuptools import find_namespace_packages

from verification import EXTRAS

ROOT = Path(__file__).resolve().parents[2]
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
