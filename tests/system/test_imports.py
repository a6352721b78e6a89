# SPDX-License-Identifier: MIT
"""Who imports whom, and what is loaded at run time.

`lint-imports` holds the order of the packages. Here one bad line is seen to turn each of its contracts red,
no circle and no forbidden import hides in a table of module names, and a command loads no more than it needs.
"""

from __future__ import annotations

import ast
import inspect
import os
import re
import shutil
import subprocess
import sys
import tomllib
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("samfem", "sam", "fem_reference", "verification")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def tree(tmp_path_factory) -> Path:
    """A copy of the packages and of the contracts, by links."""
    pytest.importorskip("importlinter", reason='part of the extra "lint"')
    folder = tmp_path_factory.mktemp("tree")
    for package in PACKAGES:
        shutil.copytree(
            ROOT / package,
            folder / package,
            copy_function=os.symlink,
            ignore=shutil.ignore_patterns("__pycache__"),
        )
    shutil.copy(ROOT / "pyproject.toml", folder)
    return folder


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
    (
        "fem_reference/common/contact.py",
        "def f():\n    from samfem import cli",
    ): "samfem.cli",
    ("fem_reference/common/contact.py", "from sam.contact.normal import solve_contact"): "sam.contact.normal",
    ("fem_reference/common/contact.py", "from sam import solve"): "sam",
    ("fem_reference/common/contact.py", "def g():\n    import meshio"): "meshio",
    ("fem_reference/common/contact.py", "import fem_reference.spatial.hexahedra"): (
        "fem_reference.spatial.hexahedra"
    ),
    ("verification/text/console.py", "from samfem import cli"): "samfem.cli",
    ("verification/text/console.py", "from verification.suite import verify"): "verification.suite.verify",
}
"""File and a line too many -> what it must not import."""


def lint_imports(tree: Path) -> subprocess.CompletedProcess[str]:
    program = "from importlinter.cli import lint_imports_command\nlint_imports_command()"
    return subprocess.run(
        [sys.executable, "-c", program, "--no-logo", "--no-cache"],
        cwd=tree,
        env=os.environ | {"PYTHONPATH": str(tree), "COLUMNS": "200"},
        capture_output=True,
        text=True,
    )


def test_every_contract_is_kept(tree):
    done = lint_imports(tree)
    assert done.returncode == 0, done.stdout


@pytest.fixture(scope="module")
def broken(tree, tmp_path_factory) -> str:
    """What is said of the packages with every bad line in its file."""
    copy = tmp_path_factory.mktemp("broken") / "tree"
    shutil.copytree(tree, copy, symlinks=True)
    for path, line in BAD:
        source = (copy / path).read_text(encoding="utf-8")
        (copy / path).unlink()
        (copy / path).write_text(f"{source}\n\n{line}\n", encoding="utf-8")
    done = lint_imports(copy)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stdout


def test_every_contract_breaks(broken):
    contracts = len(PROJECT["tool"]["importlinter"]["contracts"])
    assert f"0 kept, {contracts} broken" in broken, broken


@pytest.mark.parametrize(("path", "line"), BAD)
def test_one_line_is_named(broken, path, line):
    name = Path(path).stem  # a circle is told by the last parts of the names
    assert re.search(rf"\b{name} -> {re.escape(BAD[path, line])} \((l\.|1 import)", broken), broken


def modules() -> dict[str, Path]:
    """Module name -> file."""
    files = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in files
    }


def named_in(source: str) -> set[str]:
    """The texts of a source that may name a module: what import_module is given, and words with a dot as in a
    table.
    """
    nodes = list(ast.walk(ast.parse(source)))
    given = [
        node.args for node in nodes if isinstance(node, ast.Call) and "import_" in ast.unparse(node.func)
    ]
    words = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    loaded = {each.value for arguments in given for each in arguments if isinstance(each, ast.Constant)}
    return {word for word in words if "." in word} | loaded


@pytest.fixture(scope="module")
def named() -> dict[str, set[str]]:
    """Module -> the modules that it names as texts, to load them when a scene needs them."""
    every = modules()
    return {
        module: named_in(path.read_text(encoding="utf-8")) & every.keys() for module, path in every.items()
    }


NOT_YET = [
    each.split(" -> ")
    for contract in PROJECT["tool"]["importlinter"]["contracts"]
    if contract["id"] == "no-circles"
    for each in contract.get("ignore_imports", ())
]


def circle(imports: dict[str, set[str]]) -> list[str]:
    """The modules of one circle, none if there is none."""
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def test_no_circle_at_all(named):
    """Counted are all imports: lazy ones, those for types only, and names in tables of modules."""
    grimp = pytest.importorskip("grimp", reason='part of the extra "lint"')
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    imports = {
        module: graph.find_modules_directly_imported_by(module) | named[module] for module in modules()
    }
    for importer, imported in NOT_YET:
        imports.get(importer, set()).discard(imported)
    assert sum(map(len, imports.values())) > 1000
    assert circle(imports) == []


def test_a_circle_is_found():
    assert set(circle({"a": {"b"}, "b": {"c"}, "c": {"a"}})) == {"a", "b", "c"}


def test_a_table_names_no_module_of_the_other_model(named):
    known = {"sam": ("sam",), "fem_reference": ("fem_reference", "sam.scene")}
    wrong = [
        (module, name)
        for module, names in named.items()
        for name in names
        if not f"{name}.".startswith(tuple(f"{own}." for own in known.get(module.split(".")[0], PACKAGES)))
    ]
    assert wrong == []
    assert any(name.startswith("sam.") for name in named["sam"])  # the table of sam itself is seen


def inside_a_solver(source: str) -> list[str]:
    """What a source imports of a solver that is not public: a module of a package, or a name that the
    package has not in `__all__`.
    """
    nodes = [*ast.walk(ast.parse(source))]
    whole = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    named = [
        (node.module, alias.name)
        for node in nodes
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    ]
    named = [each for each in named if each[0] and each[0].split(".")[0] in ("sam", "fem_reference")]
    return [name for name in whole if name.startswith(("sam.", "fem_reference."))] + [
        f"{package}.{name}" for package, name in named if not public(package, name)
    ]


def public(package: str, name: str) -> bool:
    """Whether a name stands in `__all__` of a package, or is a package itself."""
    inside = ROOT.joinpath(*package.split("."))
    if not (inside / "__init__.py").is_file():
        return False
    return name in getattr(import_module(package), "__all__", ()) or (inside / name / "__init__.py").is_file()


def test_verification_uses_what_the_solvers_export():
    found = {
        module: inside_a_solver(path.read_text(encoding="utf-8"))
        for module, path in modules().items()
        if module.startswith(("verification", "samfem"))
    }
    assert len(found) > 150
    assert {module: names for module, names in found.items() if names} == {}


@pytest.mark.parametrize(
    "line, wrong",
    [
        ("from sam.contact.normal import solve_contact", ["sam.contact.normal.solve_contact"]),
        ("def f():\n    from sam.contact import MARGIN, Counters", ["sam.contact.MARGIN"]),
        ("from sam import schedule", ["sam.schedule"]),
        ("import sam.scene.units", ["sam.scene.units"]),
        ("from fem_reference.common import hertz", ["fem_reference.common.hertz"]),
        ("import sam\nfrom fem_reference import Model, spatial\nfrom sam.scene.surface import heights", []),
    ],
)
def test_an_import_from_inside_a_solver_is_seen(line, wrong):
    assert inside_a_solver(line) == wrong


@pytest.mark.parametrize("package", [name for name, path in modules().items() if path.name == "__init__.py"])
def test_what_a_package_exports_is_there_and_has_a_docstring(package):
    """Constants and names of types, which can have none, have it in their module."""
    module = import_module(package)
    found = {name: getattr(module, name) for name in getattr(module, "__all__", ())}
    own = {name: each for name, each in found.items() if inspect.isclass(each) or inspect.isfunction(each)}
    assert [name for name, each in own.items() if not inspect.getdoc(each)] == []


def loaded_by(program: str) -> set[str]:
    """Names of all modules that a fresh interpreter has loaded after the program."""
    program += "\nimport sys\nprint('\\n'.join(sys.modules), file=sys.stderr)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=True
    )
    return set(done.stderr.split())


PICTURES = {"matplotlib", "pyvista", "vtk", "PIL"}
TABLES = {
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
OF_COMPARISONS = {
    "verification.reference",
    "verification.compare.comparison",
    "verification.compare.verdicts",
    "verification.figures.style",
}
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
COMMANDS = {
    "--help": HEAVY,
    "--version": HEAVY,
    "store": PICTURES | TABLES | SOLVERS | OF_COMPARISONS | {"meshio", "pandas", "pint"},
    "plan scene.toml": PICTURES | TABLES | OF_COMPARISONS | {"pyamg", "meshio", "pandas", "rich"},
    "solve scene.toml": PICTURES | TABLES | OF_COMPARISONS | {"skfem", "pyamg", "fem_reference"},
    "solve scene.toml --model fem-axisymmetric": PICTURES
    | TABLES
    | OF_COMPARISONS
    | {"pyamg", "sam.contact.normal", "sam.solver"},
    "solve scene.toml --out drawn --figures": TABLES | {"vtk", "skfem", "pyamg"},
}
"""Commands, and what they must not load."""


@pytest.fixture(scope="module")
def loaded_by_command(tmp_path_factory) -> dict[str, set[str]]:
    """Names of all modules that each command has loaded, in a process of its own. Pictures in space are drawn
    in a further process, whose modules are not seen here: no module can be started as one.
    """
    folder = tmp_path_factory.mktemp("commands")
    (folder / "scene.toml").write_text(SCENE)
    program = "import os, subprocess, sys\nrun = subprocess.run\n"
    program += "def none(words, **how): return run([os.devnull] if '-m' in words else words, **how)\n"
    program += "subprocess.run = none\n"
    program += "from samfem.cli import main\ncode = main(sys.argv[1:])\n"
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
    assert {"sam.contact.normal", "sam.solver", "numpy", "scipy", "pydantic", "pandas"} <= solved
    assert not {"pint", "scipy.stats"} & solved  # needed for other units, for designs
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
            "samfem",
        }
    )


@pytest.mark.parametrize("package", ["sam", "fem_reference"])
def test_a_solver_loads_no_pictures_and_not_the_other_solver(package):
    loaded = loaded_by(f"import {package}\n{package}.solve")
    other = {"sam": {"fem_reference"}, "fem_reference": {"sam.solver"}}[package]
    other |= {"scipy.optimize", "scipy.ndimage"} if package == "sam" else set()  # of ellipses, rough bodies
    assert loaded.isdisjoint({"matplotlib", "rich", "jinja2", "verification", "samfem", *other})
