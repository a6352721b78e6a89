# SPDX-License-Identifier: MIT
"""What is in the wheel: all that runs, nothing that only tests and maintainers need, and no package
of an extra at import.
"""

import ast
import fnmatch
import json
import sys
import tomllib
from pathlib import Path

import pytest
from fake_case import FakeCase
from setuptools import find_namespace_packages

from verification.cases import all_cases
from verification.suite import verify

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OWN = ("samfem", "sam", "fem_reference", "verification")
LEFT_OUT = "verification/robustness/mutants/"
OF_SOURCE = ("verification.robustness.mutants", "tests")
OF_EXTRAS = (
    "mpmath",
    "sympy",
    "pytest",
    "hypothesis",
    "distributed",
    "dask",
    "SurfaceTopography",
    "ruff",
)


def in_wheel() -> set[str]:
    """Paths of the files that setuptools takes, by the rules of pyproject.toml."""
    tools = PROJECT["tool"]["setuptools"]
    patterns = ["*.py", *tools["package-data"]["*"]]
    packages = find_namespace_packages(ROOT, **tools["packages"]["find"])
    files = [path for name in packages for path in (ROOT / name.replace(".", "/")).iterdir()]
    wanted = [path for path in files if any(fnmatch.fnmatch(path.name, each) for each in patterns)]
    return {path.relative_to(ROOT).as_posix() for path in wanted if path.is_file()}


def test_the_wheel_has_every_file_of_the_packages_but_the_mutation_check():
    files = [path for name in OWN for path in (ROOT / name).rglob("*") if path.is_file()]
    source = {path.relative_to(ROOT).as_posix() for path in files if "__pycache__" not in path.parts}
    left_out = source - in_wheel()
    assert left_out and all(name.startswith(LEFT_OUT) for name in left_out)
    assert {name.split("/")[0] for name in in_wheel()} == set(OWN)
    project = PROJECT["project"]
    assert project["license"] == "MIT" and project["license-files"] == ["LICENSE"]
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")
    assert (ROOT / project["readme"]).is_file()


def loaded_at_import(path: Path) -> set[str]:
    """Modules that a file imports when it is itself imported, in no function and not for type
    checkers alone.
    """
    found, nodes = set(), list(ast.parse(path.read_text(encoding="utf-8")).body)
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            nodes += node.orelse
        elif not isinstance(node, ast.FunctionDef):
            nodes += [child for child in ast.iter_child_nodes(node) if isinstance(child, ast.stmt)]
    return found


def test_nothing_installed_imports_what_is_not():
    """At import; closed_forms.layered needs mpmath, and is itself imported on use by cases of the extra."""
    of_an_extra = "verification.reference.layered"
    hits = {
        (name, module)
        for name in in_wheel()
        if name.endswith(".py") and not name.startswith("verification/peers/programs/")
        for module in loaded_at_import(ROOT / name)
        if f"{module}.".startswith(tuple(f"{each}." for each in (*OF_SOURCE, *OF_EXTRAS, of_an_extra)))
    }
    assert hits == {("verification/reference/layered.py", "mpmath")}


def test_a_case_without_its_extra_is_not_run_and_says_what_to_install(tmp_path, monkeypatch, capsys):
    assert all_cases()["certificates"].needs() == ""
    monkeypatch.setitem(sys.modules, "mpmath", None)
    assert verify.main(["certificates"], "quick", tmp_path / "out") == 0
    assert (
        capsys.readouterr().out == 'certificates: not run: install mpmath: pip install "samfem[reference]"\n'
    )
    assert list(tmp_path.iterdir()) == []
    extras = PROJECT["project"]["optional-dependencies"]
    assert any(name.startswith("mpmath") for name in extras["reference"])


def test_a_case_that_is_not_run_does_not_stop_the_others(tmp_path, monkeypatch, capsys):
    """The page and results.json have the reason; nothing of it is red."""
    from test_report import CASES, ROWS  # noqa: PLC0415 - found once its folder is collected

    why = "install nothing: pip install x"
    unmet = FakeCase("slow", "Slow case", "Does it hold?", needs=lambda: why, does=pytest.fail)
    monkeypatch.setattr(verify, "all_cases", lambda: CASES | {"slow": unmet})
    monkeypatch.setattr(verify, "load_rows", lambda: ROWS)
    assert verify.main(["good", "slow"], "quick", tmp_path / "out") == 0
    assert f"slow: not run: {why}" in capsys.readouterr().out
    found = json.loads((tmp_path / "out/results.json").read_text())["cases"]
    records = {case["name"]: (case["status"], case["unmet"]) for case in found}
    assert records["slow"] == ("not run", why) and records["good"] == ("passed", "")
    assert f": {why}" in (tmp_path / "out/other.html").read_text()
