# SPDX-License-Identifier: MIT
"""Who imports whom: the two solvers share the scene and nothing else, and bring no files, pictures or output
along.
"""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("sam", "fem_reference", "verification")
FOR_PEOPLE = {"matplotlib", "rich", "jinja2", "meshio", "argparse", "pyvista"}
"""What a solver has no business with: pictures, files, tables, the command line."""


def imported(source: str, module: str) -> set[str]:
    """Every absolute module name that the source of `module` (a package: with .__init__) imports, at any
    depth.
    """
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
    assert {"sam.scene.schema", "sam.scene.result", "fem_reference.__init__", "verification.app.cli"} <= names
    assert any(_inside(name, "sam") and not _inside(name, "sam.scene") for name in names)


@pytest.mark.parametrize(
    "module, line, hit",
    [
        ("fem_reference.common.contact", "from sam.grid import choose_grid", "sam.grid.choose_grid"),
        ("fem_reference.common.contact", "from sam import solve", "sam.solve"),
        ("fem_reference.common.contact", "from sam.scene import Scene\nimport sam", "sam"),
        ("fem_reference.common.contact", "import sam.kernels.patches as k", "sam.kernels.patches"),
        (
            "fem_reference.common.contact",
            "def f():\n    from verification.app import cli",
            "verification.app.cli",
        ),
        (
            "fem_reference.common.contact",
            "from importlib import import_module\nimport_module('sam.contact.stress')",
            "sam.contact.stress",
        ),
        (
            "sam.contact.stress",
            "from fem_reference.axisymmetric import mesh",
            "fem_reference.axisymmetric.mesh",
        ),
        ("sam.contact.stress", "import verification.reference.hertz", "verification.reference.hertz"),
        ("sam.contact.stress", "import matplotlib.pyplot", "matplotlib.pyplot"),
        ("sam.scene.schema", "from sam.contact.stress import von_mises", "sam.contact.stress.von_mises"),
        ("sam.scene.schema", "from ..contact.stress import von_mises", "sam.contact.stress.von_mises"),
        ("sam.scene.__init__", "from .. import grid", "sam.grid"),
    ],
)
def test_a_forbidden_import_is_caught(module, line, hit):
    assert hit in forbidden(module, imported(line, module))


@pytest.mark.parametrize("module", ["sam.contact.stress", "fem_reference.common.contact", "sam.scene.load"])
def test_the_shared_scene_is_allowed(module):
    assert not forbidden(module, imported("from sam.scene.result import Result\nimport numpy", module))


def loaded_by(program: str) -> set[str]:
    """Names of all modules that a fresh interpreter has loaded after the program."""
    program += "\nimport sys\nprint('\\n'.join(sys.modules), file=sys.stderr)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    return set(done.stderr.split())


PICTURES = {"matplotlib", "pyvista", "vtk", "PIL"}
TABLES = {
    "pandas",
    "distributed",
    "SurfaceTopography",
    "sympy",
    "mpmath",
    "netCDF4",
    "h5py",
}  # dask: pint loads it if it is there
SOLVERS = {
    "skfem",
    "pyamg",
    "sam.contact.normal",
    "sam.plasticity",
    "sam.layered",
    "fem_reference.common.contact",
    "sam.solver",
}
OF_OTHERS = {"sam.layered", "sam.plasticity", "sam.rough", "sam.tribofilm", "sam.wear"}
OF_COMPARISONS = {
    "verification.reference",
    "verification.compare.comparison",
    "verification.compare.verdicts",
    "verification.figures",
}
HEAVY = {"numpy", "scipy", "pint", "pydantic", "rich", "meshio", "sam"} | PICTURES | TABLES | SOLVERS
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
    "--help": HEAVY,
    "--version": HEAVY,
    "store": PICTURES | TABLES | SOLVERS | OF_COMPARISONS | {"meshio", "pint"},
    "plan scene.toml": PICTURES | TABLES | OF_COMPARISONS | {"pyamg", "meshio", "rich"},
    "solve scene.toml": PICTURES | TABLES | OF_COMPARISONS | {"skfem", "pyamg", "fem_reference"} | OF_OTHERS,
    "solve scene.toml --model fem-axisymmetric": PICTURES
    | TABLES
    | OF_COMPARISONS
    | {"pyamg", "sam.contact.normal", "sam.solver"},
    "solve scene.toml --out drawn --figures": TABLES | {"pyvista", "vtk", "skfem", "pyamg"},
}
"""Commands, and what they must not load."""


@pytest.fixture(scope="module")
def loaded_by_command(tmp_path_factory) -> dict[str, set[str]]:
    """Names of all modules that each command has loaded, in a process of its own."""
    folder = tmp_path_factory.mktemp("commands")
    (folder / "scene.toml").write_text(SCENE)
    program = "import sys\nfrom verification.app.cli import main\ncode = main(sys.argv[1:])\n"
    program += "print('\\n'.join(sys.modules), file=sys.stderr)\nsys.exit(code)"
    how = {
        "text": True,
        "cwd": folder,
        "env": os.environ | {"PYTHONPATH": str(ROOT), "SAMFEM_STORE": str(folder / "store")},
    }
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    running = {
        each: subprocess.Popen([sys.executable, "-c", program, *each.split()], **pipes, **how)
        for each in COMMANDS
    }
    errors = {each: process.communicate()[1] for each, process in running.items()}
    assert {each: process.returncode for each, process in running.items()} == dict.fromkeys(COMMANDS, 0), (
        errors
    )
    return {each: set(error.split()) for each, error in errors.items()}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_loads_nothing_that_it_does_not_need(loaded_by_command, command):
    assert sorted(loaded_by_command[command] & COMMANDS[command]) == []


def test_only_figures_load_pictures(loaded_by_command):
    """The other way round: the names above are those by which pictures and solvers are known."""
    drawn, solved = (
        loaded_by_command["solve scene.toml --out drawn --figures"],
        loaded_by_command["solve scene.toml"],
    )
    assert "matplotlib" in drawn - solved
    assert {"sam.contact.normal", "sam.solver", "numpy", "scipy", "pint", "pydantic", "meshio"} <= solved
    assert {"skfem", "fem_reference.common.contact"} <= loaded_by_command[
        "solve scene.toml --model fem-axisymmetric"
    ]


def test_the_scene_loads_no_solver_and_python_users_load_no_pint():
    loaded = loaded_by("from sam.scene import Body\nBody(young=2e11, poisson=0.3)")
    assert loaded.isdisjoint(
        {
            "pint",
            "scipy",
            "skfem",
            "sam.contact.stress",
            "sam.contact.normal",
            "fem_reference",
            "verification",
        }
    )


@pytest.mark.parametrize("package", ["sam", "fem_reference"])
def test_a_solver_loads_no_pictures_and_not_the_other_solver(package):
    loaded = loaded_by(f"import {package}\n{package}.solve")
    other = {"sam": "fem_reference", "fem_reference": "sam.solver"}[package]
    assert loaded.isdisjoint({"matplotlib", "rich", "jinja2", "verification", other})
