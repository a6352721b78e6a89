# SPDX-License-Identifier: MIT
"""Who imports whom, and what is loaded at run time.

`lint-imports` holds the order of the packages. Here one bad line is seen to turn each of its contracts red,
no forbidden import hides in a table of module names, and a command loads no more than it needs.
"""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("samfem", "sam", "fem_reference", "verification")
SOURCES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
}
BAD = {
    ("sam/contact/stress.py", "from fem_reference.common import contact"): "fem_reference.common.contact",
    ("sam/contact/stress.py", "import matplotlib.pyplot"): "matplotlib",
    ("sam/scene/units.py", "import verification.reference.hertz"): "verification.reference.hertz",
    (
        "sam/kernels/patches.py",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import sam.solver",
    ): ("sam.solver"),
    ("sam/kernels/primitives.py", "def f():\n    from sam.kernels import patches"): ".patches",
    ("fem_reference/common/contact.py", "from sam import solve"): "sam",
    ("fem_reference/common/contact.py", "import fem_reference.spatial.area"): "fem_reference.spatial.area",
    ("verification/text/console.py", "from verification.suite import verify"): "verification.suite.verify",
    ("verification/text/console.py", "from sam.scene.units import UNITS"): "sam.scene.units",
}
"""File and a line too many -> what it must not import."""


def test_every_contract_breaks_and_each_bad_line_is_named(tmp_path):
    """A copy of the packages, by links, with bad lines in their files."""
    pytest.importorskip("importlinter", reason='part of the extra "lint"')
    ignored = shutil.ignore_patterns("__pycache__")
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, copy_function=os.symlink, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for path, line in BAD:
        source = (tmp_path / path).read_text(encoding="utf-8")
        (tmp_path / path).unlink()
        (tmp_path / path).write_text(f"{source}\n\n{line}\n", encoding="utf-8")
    program = "from importlinter.cli import lint_imports_command\nlint_imports_command()"
    words = [sys.executable, "-c", program, "--no-logo", "--no-cache"]
    environment = os.environ | {"PYTHONPATH": str(tmp_path), "COLUMNS": "200"}
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = len(project["tool"]["importlinter"]["contracts"])
    assert done.returncode == 1 and f"0 kept, {contracts} broken" in done.stdout, done.stdout + done.stderr
    for (path, _), imported in BAD.items():  # a circle is told by the last parts of the names
        named = rf"\b{Path(path).stem} -> {re.escape(imported)} \((l\.|1 import)"
        assert re.search(named, done.stdout), done.stdout


def test_a_table_names_no_module_of_the_other_model():
    """Texts of a source that are names of modules, to load them when a scene needs them."""
    own = {"sam": ("sam.",), "fem_reference": ("fem_reference.", "sam.scene.")}
    known = {path.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for path in SOURCES}
    seen = set()
    for path, text in SOURCES.items():
        nodes = ast.walk(ast.parse(text)) if path.split("/")[0] in own else ()
        texts = {str(node.value) for node in nodes if isinstance(node, ast.Constant)} & known
        assert all(f"{name}.".startswith(own[path.split("/")[0]]) for name in texts), path
        seen |= texts
    assert len(seen) > 10


PICTURES = {"matplotlib", "pyvista", "vtk", "PIL"}
TABLES = {"distributed", "SurfaceTopography", "sympy", "mpmath", "netCDF4", "h5py"}
SOLVERS = {"skfem", "pyamg", "sam.contact.normal", "sam.plasticity", "sam.layered", "sam.solver"}
SOLVERS |= {"fem_reference.common.contact"}
FEW = PICTURES | TABLES
FEW |= {"verification.reference", "verification.compare.comparison", "verification.figures.style"}
SOLVING = FEW - {"verification.reference"} | {"scipy.optimize"}  # beside a result stands that of Hertz
HEAVY = FEW | SOLVERS | {"numpy", "scipy", "pandas", "pint", "pydantic", "rich", "meshio", "sam"}
SCENE = """[body]
young = "210 GPa"
poisson = 0.3
[counterbody]
shape = "sphere"
radius = "105 um"
[loading]
force = "0.05 N"
[grid]
cells = [33, 33]
[fem]
cells_per_radius = 4
box = 5
"""
COMMANDS = {
    "--help": (set(), HEAVY),
    "plan scene.toml": ({"sam.scene"}, FEW | {"pyamg", "meshio", "pandas", "rich"}),
    "solve scene.toml": (  # pint for other units, scipy.stats for designs
        {"sam.contact.normal", "sam.solver", "numpy", "scipy", "pydantic"},
        SOLVING
        | {"skfem", "pyamg", "fem_reference", "pint", "pandas", "scipy.stats", "verification.figures"},
    ),
    "solve scene.toml --model fem-axisymmetric": (
        {"skfem", "fem_reference.common.contact"},
        SOLVING | {"pyamg", "sam.contact.normal", "sam.solver"},
    ),
    "store": (set(), FEW | SOLVERS | {"meshio", "pandas", "pint"}),
}
"""Commands, what they load, by which the names of the third are known, and what they must not load."""
PYTHON = {
    "from sam.scene import Body\nBody(young=2e11, poisson=0.3)": SOLVERS
    | {"pint", "scipy", "fem_reference", "verification", "samfem"},
    "import sam\nsam.solve": PICTURES
    | {"rich", "jinja2", "verification", "samfem", "fem_reference", "scipy.optimize"},
    "import fem_reference\nfem_reference.plan, fem_reference.UnsupportedScene": SOLVERS
    | {"skfem", "scipy", "verification"},
    "import fem_reference\nfem_reference.solve": PICTURES | {"rich", "verification", "sam.solver"},
    "import samfem\nsamfem.__version__": {"numpy", "pandas", "sam", "verification"},
    "import samfem\nsamfem.Scene, samfem.solve": FEW | SOLVERS | {"pandas", "scipy", "pint", "rich", "skfem"},
}
"""Programs, and what they must not load."""
CASES = {
    **{
        f"import sys\nfrom samfem.cli import main\nmain({command.split()})": need
        for command, need in COMMANDS.items()
    },
    **{program: (set(), others) for program, others in PYTHON.items()},
}


@pytest.mark.parametrize("program", CASES)
def test_nothing_is_loaded_that_is_not_needed(program, tmp_path):
    """In a process of its own."""
    needed, others = CASES[program]
    (tmp_path / "scene.toml").write_text(SCENE)
    program += "\nimport sys\nprint('loaded', *sys.modules)"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "SAMFEM_STORE": str(tmp_path / "store")}
    how = {"text": True, "cwd": tmp_path, "env": environment, "capture_output": True, "check": True}
    done = subprocess.run([sys.executable, "-c", program], **how)
    loaded = set(done.stdout.splitlines()[-1].split())
    assert needed <= loaded and sorted(loaded & others) == []
