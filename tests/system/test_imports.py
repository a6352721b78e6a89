# SPDX-License-Identifier: MIT
"""Who imports whom, and what is loaded at run time.

`lint-imports` holds the order of the packages. Here one bad line is seen to turn each of its
contracts red, no forbidden import hides in a table of module names, and a command loads no more
than it needs.
"""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("samfem", "sam", "fem_reference", "verification")
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
}
"""Module name -> file."""
BAD = {
    ("sam/scene/units.py", "import verification.reference.hertz"): "verification.reference.hertz",
    ("sam/scene/result.py", "from ..contact.stress import von_mises"): "sam.contact.stress",
    ("sam/contact/stress.py", "from fem_reference.common import contact"): "fem_reference.common.contact",
    ("sam/contact/stress.py", "import matplotlib.pyplot"): "matplotlib",
    (
        "sam/kernels/patches.py",
        "import typing\nif typing.TYPE_CHECKING:\n    import sam.solver",
    ): "sam.solver",
    ("sam/kernels/primitives.py", "def f():\n    from sam.kernels import patches"): ".patches",
    ("fem_reference/common/contact.py", "from sam.contact.normal import solve_contact"): "sam.contact.normal",
    ("fem_reference/common/contact.py", "from sam import solve"): "sam",
    ("fem_reference/common/contact.py", "import fem_reference.spatial.hexahedra"): (
        "fem_reference.spatial.hexahedra"
    ),
    ("verification/text/console.py", "from samfem import cli"): "samfem.cli",
    ("verification/text/console.py", "from verification.suite import verify"): "verification.suite.verify",
}
"""File and a line too many -> what it must not import."""


def lint_imports(folder: Path, bad: dict) -> subprocess.CompletedProcess[str]:
    """What import-linter says of a copy of the packages, by links, with bad lines in their files."""
    pytest.importorskip("importlinter", reason='part of the extra "lint"')
    ignored = shutil.ignore_patterns("__pycache__")
    for package in PACKAGES:
        shutil.copytree(ROOT / package, folder / package, copy_function=os.symlink, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", folder)
    for path, line in bad:
        source = (folder / path).read_text(encoding="utf-8")
        (folder / path).unlink()
        (folder / path).write_text(f"{source}\n\n{line}\n", encoding="utf-8")
    program = "from importlinter.cli import lint_imports_command\nlint_imports_command()"
    return subprocess.run(
        [sys.executable, "-c", program, "--no-logo", "--no-cache"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "200"},
        capture_output=True,
        text=True,
    )


def test_every_contract_is_kept(tmp_path):
    done = lint_imports(tmp_path, {})
    assert done.returncode == 0, done.stdout


def test_every_contract_breaks_and_each_bad_line_is_named(tmp_path):
    done = lint_imports(tmp_path, BAD)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = len(project["tool"]["importlinter"]["contracts"])
    assert done.returncode == 1 and f"0 kept, {contracts} broken" in done.stdout, done.stdout + done.stderr
    for (path, _), imported in BAD.items():  # a circle is told by the last parts of the names
        named = rf"\b{Path(path).stem} -> {re.escape(imported)} \((l\.|1 import)"
        assert re.search(named, done.stdout), done.stdout


def test_a_table_names_no_module_of_the_other_model():
    """Texts of a source that are names of modules, to load them when a scene needs them."""
    allowed = {"sam": ("sam.",), "fem_reference": ("fem_reference.", "sam.scene.")}
    wrong, seen = [], set()
    for module, path in MODULES.items():
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        texts = {
            node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }
        package = module.split(".")[0]
        named = texts & MODULES.keys() - (set() if package in allowed else {*PACKAGES})
        seen |= named
        wrong += [
            (module, name)
            for name in named
            if not f"{name}.".startswith(allowed.get(package, tuple(f"{each}." for each in PACKAGES)))
        ]
    assert wrong == [] and any(name.startswith("sam.") for name in seen)


def inside_a_solver(source: str) -> list[str]:
    """What a source imports of a solver that is not public: a module of a package, or a name that
    the package has not in `__all__`.
    """
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names if alias.name.startswith(("sam.", "fem_reference."))]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in (
            "sam",
            "fem_reference",
        ):
            found += [
                f"{node.module}.{alias.name}" for alias in node.names if not public(node.module, alias.name)
            ]
    return found


def public(package: str, name: str) -> bool:
    """Whether a name stands in `__all__` of a package, or is a package itself."""
    inside = ROOT.joinpath(*package.split("."))
    exported = (inside / "__init__.py").is_file() and name in getattr(import_module(package), "__all__", ())
    return exported or (inside / name / "__init__.py").is_file()


def test_verification_uses_what_the_solvers_export():
    above = {name: path for name, path in MODULES.items() if name.startswith(("verification", "samfem"))}
    found = {name: inside_a_solver(path.read_text(encoding="utf-8")) for name, path in above.items()}
    assert len(found) > 150 and {name: imports for name, imports in found.items() if imports} == {}


@pytest.mark.parametrize(
    "line, wrong",
    [
        ("def f():\n    from sam.contact import MARGIN, Counters", ["sam.contact.MARGIN"]),
        ("from sam import schedule", ["sam.schedule"]),
        ("import sam.scene.units", ["sam.scene.units"]),
        ("import sam\nfrom fem_reference import Model, spatial\nfrom sam.scene.surface import heights", []),
    ],
)
def test_an_import_from_inside_a_solver_is_seen(line, wrong):
    assert inside_a_solver(line) == wrong


PICTURES = {"matplotlib", "pyvista", "vtk", "PIL"}
TABLES = {"distributed", "SurfaceTopography", "sympy", "mpmath", "netCDF4", "h5py"}
SOLVERS = {"skfem", "pyamg", "sam.contact.normal", "sam.plasticity", "sam.layered", "sam.solver"}
SOLVERS |= {"fem_reference.common.contact"}
COMPARISONS = {"verification.reference", "verification.compare.comparison", "verification.figures.style"}
FEW = PICTURES | TABLES | COMPARISONS
HEAVY = (
    {"numpy", "scipy", "pandas", "pint", "pydantic", "rich", "meshio", "sam"} | PICTURES | TABLES | SOLVERS
)
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
SAM, FEM = "solve scene.toml", "solve scene.toml --model fem-axisymmetric"
DRAWN = "solve scene.toml --out drawn --figures"
COMMANDS = {
    "--help": (set(), HEAVY),
    "--version": (set(), HEAVY),
    "store": (set(), FEW | SOLVERS | {"meshio", "pandas", "pint"}),
    "plan scene.toml": ({"sam.scene"}, FEW | {"pyamg", "meshio", "pandas", "rich"}),
    SAM: (
        {"sam.contact.normal", "sam.solver", "numpy", "scipy", "pydantic", "pandas"},
        FEW | {"skfem", "pyamg", "fem_reference", "pint", "scipy.stats"},  # for other units, for designs
    ),
    FEM: ({"skfem", "fem_reference.common.contact"}, FEW | {"pyamg", "sam.contact.normal", "sam.solver"}),
    DRAWN: ({"matplotlib"}, TABLES | {"vtk", "skfem", "pyamg"}),
}
"""Commands, what they load, by which the names of the third are known, and what they must not load."""


@pytest.fixture(scope="module")
def loaded_by_command(tmp_path_factory) -> dict[str, set[str]]:
    """Names of all modules that each command has loaded, in a process of its own. Pictures in space
    are drawn in a further process, whose modules are not seen here: no module can be started as
    one.
    """
    folder = tmp_path_factory.mktemp("commands")
    (folder / "scene.toml").write_text(SCENE)
    program = "import os, subprocess, sys\nrun = subprocess.run\n"
    program += "def none(words, **how): return run([os.devnull] if '-m' in words else words, **how)\n"
    program += "subprocess.run = none\n"
    program += "from samfem.cli import main\ncode = main(sys.argv[1:])\n"
    program += "print('\\n'.join(sys.modules), file=sys.stderr)\nsys.exit(code)"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "SAMFEM_STORE": str(folder / "store")}
    how = {"text": True, "cwd": folder, "env": environment, "capture_output": True}
    done = {each: subprocess.run([sys.executable, "-c", program, *each.split()], **how) for each in COMMANDS}
    assert [each.stderr for each in done.values() if each.returncode] == []
    return {name: set(each.stderr.split()) for name, each in done.items()}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_loads_nothing_that_it_does_not_need(loaded_by_command, command):
    needed, others = COMMANDS[command]
    assert needed <= loaded_by_command[command]
    assert sorted(loaded_by_command[command] & others) == []


@pytest.mark.parametrize(
    "program, others",
    [
        (
            "from sam.scene import Body\nBody(young=2e11, poisson=0.3)",
            {"pint", "scipy", "skfem", "sam.contact.normal", "fem_reference", "verification", "samfem"},
        ),
        (
            "import sam\nsam.solve",
            {"matplotlib", "rich", "jinja2", "verification", "samfem", "fem_reference", "scipy.optimize"},
        ),
        ("import fem_reference\nfem_reference.solve", {"matplotlib", "rich", "verification", "sam.solver"}),
        ("import samfem", {"numpy", "pandas", "sam", "verification"}),
    ],
)
def test_python_loads_no_pictures_and_not_the_other_solver(program, others):
    program += "\nimport sys\nprint('\\n'.join(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    assert others.isdisjoint(done.stdout.split())
