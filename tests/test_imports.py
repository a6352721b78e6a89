# SPDX-License-Identifier: MIT
"""Who imports whom: the two solvers share the scene and nothing else, and bring no files, pictures or output along."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("sam", "fem_reference", "verification")
FOR_PEOPLE = {"matplotlib", "rich", "jinja2", "meshio", "argparse", "pyvista"}
"""What a solver has no business with: pictures, files, tables, the command line."""


def imported(source: str, module: str) -> set[str]:
    """Every absolute module name that the source of `module` (a package: with .__init__) imports, at any depth."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = ".".join(module.split(".")[: -node.level]) if node.level else ""
            origin = ".".join(filter(None, (above, node.module)))
            found |= {f"{origin}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.Call) and _named(node.func) in ("import_module", "__import__"):
            found |= {argument.value for argument in node.args[:1] if isinstance(argument, ast.Constant)}
    return found


def _named(function: ast.expr) -> str:
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _inside(name: str, package: str) -> bool:
    return name == package or name.startswith(package + ".")


def forbidden(module: str, names: set[str]) -> set[str]:
    """Those of the imported names that `module` must not import."""
    if _inside(module, "verification"):
        return set()
    others = {"verification", *FOR_PEOPLE}
    if _inside(module, "sam"):
        others.add("fem_reference")
    hits = {name for name in names if name.split(".")[0] in others}
    if _inside(module, "sam.scene") or _inside(module, "fem_reference"):
        hits |= {name for name in names if _inside(name, "sam") and not _inside(name, "sam.scene")}
    return hits


def modules() -> dict[str, Path]:
    """Module name (a package: with .__init__) -> file."""
    files = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    return {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in files}


@pytest.mark.parametrize("module, path", modules().items(), ids=modules().keys())
def test_no_module_imports_what_it_must_not(module, path):
    assert forbidden(module, imported(path.read_text(encoding="utf-8"), module)) == set()


def test_the_walk_sees_the_whole_program():
    names = set(modules())
    assert {"sam.scene.schema", "sam.scene.result", "fem_reference.__init__", "verification.cli"} <= names
    assert any(_inside(name, "sam") and not _inside(name, "sam.scene") for name in names)


@pytest.mark.parametrize(
    "module, line, hit",
    [
        ("fem_reference.contact", "from sam.grid import choose_grid", "sam.grid.choose_grid"),
        ("fem_reference.contact", "from sam import solve", "sam.solve"),
        ("fem_reference.contact", "from sam.scene import Scene\nimport sam", "sam"),
        ("fem_reference.contact", "import sam.kernels.patches as k", "sam.kernels.patches"),
        ("fem_reference.contact", "def f():\n    from verification import cli", "verification.cli"),
        ("fem_reference.contact", "from importlib import import_module\nimport_module('sam.stress')", "sam.stress"),
        ("sam.stress", "from fem_reference import mesh", "fem_reference.mesh"),
        ("sam.stress", "import verification.closed_forms.hertz", "verification.closed_forms.hertz"),
        ("sam.stress", "import matplotlib.pyplot", "matplotlib.pyplot"),
        ("sam.scene.schema", "from sam.stress import von_mises", "sam.stress.von_mises"),
        ("sam.scene.schema", "from ..stress import von_mises", "sam.stress.von_mises"),
        ("sam.scene.__init__", "from .. import grid", "sam.grid"),
    ],
)
def test_a_forbidden_import_is_caught(module, line, hit):
    assert hit in forbidden(module, imported(line, module))


@pytest.mark.parametrize("module", ["sam.stress", "fem_reference.contact", "sam.scene.load"])
def test_the_shared_scene_is_allowed(module):
    assert not forbidden(module, imported("from sam.scene.result import Result\nimport numpy", module))


def loaded_by(program: str) -> set[str]:
    """Names of all modules that a fresh interpreter has loaded after the program."""
    program += "\nimport sys\nprint('\\n'.join(sys.modules), file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True)
    return set(done.stderr.split())


def test_help_loads_nothing_heavy():
    loaded = loaded_by("from verification.cli import main\nassert main(['--help']) == 0")
    assert loaded.isdisjoint({"numpy", "scipy", "pint", "pydantic", "matplotlib", "rich", "skfem", "meshio", "sam"})


def test_the_scene_loads_no_solver_and_python_users_load_no_pint():
    loaded = loaded_by("from sam.scene import Body\nBody(young=2e11, poisson=0.3)")
    assert loaded.isdisjoint({"pint", "scipy", "skfem", "sam.stress", "sam.contact", "fem_reference", "verification"})


@pytest.mark.parametrize("package", ["sam", "fem_reference"])
def test_a_solver_loads_no_pictures_and_not_the_other_solver(package):
    loaded = loaded_by(f"import {package}\n{package}.solve")
    other = {"sam": "fem_reference", "fem_reference": "sam.solver"}[package]
    assert loaded.isdisjoint({"matplotlib", "rich", "jinja2", "verification", other})
