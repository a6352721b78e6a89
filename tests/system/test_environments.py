# SPDX-License-Identifier: MIT
"""The command that runs the suite in other environments: what it calls failed or not run; it goes on."""

import pytest
from run_environments import environments, main

PLAIN = {"numpy": ["Haswell"], "scipy": ["Haswell"], "threads": [1], "features": ["AVX2"], "cores": 2}
SUITE = """import os, pytest
def test_language(): assert os.environ.get("LC_ALL") != "C"
def test_other(): pass
@pytest.mark.skip
def test_skipped(): pass
"""


def test_a_failure_in_one_environment_is_told_and_does_not_stop_the_next(tmp_path, capsys):
    (path := tmp_path / "test_small.py").write_text(SUITE, encoding="utf-8")
    words = ["--", str(path), "-p", "no:randomly", f"--rootdir={tmp_path}", f"--confcutdir={tmp_path}"]
    file = tmp_path / "table.md"
    assert main(["c-locale", "dumb", "--out", str(file), *words]) == 1
    failed, passed = file.read_text(encoding="utf-8").splitlines()[2:]
    assert failed.startswith("| c-locale |") and "FAILED, exit code 1: 1 failed, 1 passed, 1 skipp" in failed
    assert passed.startswith("| dumb |") and "| 2 passed, 1 skipped in " in passed
    assert "def test_language" in capsys.readouterr().out  # with the output of pytest
    assert main(["dumb", *words, "-k", "nonesuch"]) == 1  # no tests


@pytest.mark.parametrize(
    ("taken", "runs"),
    [
        (["Prescott", "Prescott"], True),
        (["Katmai", "Katmai"], True),  # Prescott's kernel by an older name
        (["Haswell", "Haswell"], False),  # that of this machine
        (["Prescott", "Haswell"], False),
        (["Nehalem", "Nehalem"], False),  # another environment's
        ([None, None], False),
    ],
)
def test_a_kernel_counts_if_both_libraries_took_one_of_its_own(taken, runs):
    found = PLAIN | {"numpy": taken[:1], "scipy": taken[1:]}
    assert environments()["openblas-prescott"].holds(found, PLAIN) is runs
