# SPDX-License-Identifier: MIT
"""What is in the wheel: all that runs, nothing that only tests and maintainers need; cases of an extra."""

import fnmatch
import json
import tomllib
from pathlib import Path

import pytest
from fake_case import FakeCase
from setuptools import find_namespace_packages

from verification.suite import verify

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OWN = ("samfem", "sam", "fem_reference", "verification")
LEFT_OUT = "verification/robustness/mutants/"


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
    assert project["license"] == "MIT" and project["license-files"] == ["LICENSE"]
    assert (ROOT / "LICENSE").read_text(encoding="utf-8").startswith("MIT License")
    assert (ROOT / project["readme"]).is_file()


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
