# SPDX-License-Identifier: MIT
"""The command that runs the suite in other environments: what it counts, what it calls not run, and that it
goes on.
"""

import os
import sys

import pytest
import run_environments
from environments import KERNELS, Environment, NotHereError, Place, environments
from run_environments import Row, counts, main, probe, table

PLAIN = {"numpy": ["Haswell"], "scipy": ["Haswell"], "threads": [1], "features": ["AVX2"], "cores": 2}
BY_NAME = {environment.name: environment for environment in environments()}
SUITE = """import os, pytest
def test_language(): assert os.environ.get("LC_ALL") != "C"
def test_other(): pass
@pytest.mark.skip
def test_skipped(): pass
"""


@pytest.fixture
def suite(tmp_path):
    path = tmp_path / "test_small.py"
    path.write_text(SUITE, encoding="utf-8")
    return ["--", str(path), "-p", "no:randomly", f"--rootdir={tmp_path}", f"--confcutdir={tmp_path}"]


def test_a_failure_in_one_environment_is_told_and_does_not_stop_the_next(suite, tmp_path, capsys):
    file = tmp_path / "table.md"
    assert main(["c-locale", "dumb", "--out", str(file), *suite]) == 1
    lines = file.read_text(encoding="utf-8").splitlines()
    rows = {
        line.split(" | ")[0].lstrip("| "): line.rstrip(" |").split(" | ") for line in lines if "|" in line
    }
    assert rows["c-locale"][3:6] == ["1", "1", "1"] and rows["c-locale"][-1] == "FAILED: see below"
    assert rows["dumb"][3:6] == ["2", "0", "1"] and rows["dumb"][-1] == "passed"
    assert lines[-1].startswith("- c-locale: ") and lines[-1].endswith("::test_language")
    assert "def test_language" in capsys.readouterr().out  # with the output of pytest


def test_arguments_of_pytest_reach_it_and_no_tests_are_a_failure(suite, capsys):
    assert main(["dumb", "c-locale", *suite, "-k", "other"]) == 0
    assert main(["dumb", *suite, "-k", "nonesuch"]) == 1
    assert "FAILED: no tests" in capsys.readouterr().out


def test_an_unknown_environment_is_wrong_input(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["nonesuch"])
    assert stop.value.code == 2 and "no such environment: nonesuch" in capsys.readouterr().err


def test_a_kernel_that_the_processor_cannot_run_is_not_run(monkeypatch, tmp_path):
    """As SkylakeX where there is no AVX-512: the probe ends by a signal."""
    monkeypatch.setattr(run_environments, "PROBE", "import os, signal; os.kill(os.getpid(), signal.SIGILL)")
    with pytest.raises(NotHereError, match="SIGILL: this processor cannot run the kernel"):
        probe(BY_NAME["dumb"], Place(run_environments.ROOT, tmp_path), [])


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
    assert BY_NAME["openblas-prescott"].holds(found, PLAIN) is runs


def test_every_environment_asked_for_is_there():
    names = {f"openblas-{name.lower()}" for name in KERNELS}
    names |= {
        "plain",
        "numpy-baseline",
        "threads-1",
        "threads-2",
        "one-core",
        "time-zone",
        "c-locale",
        "ascii",
    }
    names |= {"no-home", "no-user", "user", "read-only", "no-proc", "terminal", "dumb", "folder"}
    assert set(BY_NAME) == names | {"random-1", "random-2", "random-3"}


@pytest.mark.parametrize(
    "name", ["threads-1", "threads-2", "numpy-baseline", "ascii", "time-zone", "terminal", "dumb"]
)
def test_the_probe_finds_what_the_environment_changes(name, tmp_path):
    """Of those that any user can have on any machine; numpy has no features above the baseline on some."""
    environment = BY_NAME[name]
    place = Place(run_environments.ROOT, tmp_path)
    found = probe(environment, place, environment.around(place))
    assert found["numpy"] and found["scipy"]
    if name != "numpy-baseline" or environment.variables["NPY_DISABLE_CPU_FEATURES"]:
        assert environment.holds(found, PLAIN)


def test_variables_are_set_taken_away_and_named_folders_made(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", "/somewhere")
    monkeypatch.setenv("TZ", "UTC")
    there = Environment("x", "", {"HOME": None, "TMPDIR": "tmp \u00fc", "A": "1"}).variables_in(tmp_path)
    assert "HOME" not in there and "TZ" not in there and there["A"] == "1"
    assert there["TMPDIR"] == str(tmp_path / "tmp \u00fc") and os.path.isdir(there["TMPDIR"])


def test_only_what_ran_can_be_bad():
    environment = BY_NAME["dumb"]
    assert not Row(environment, trouble="no such kernel").is_bad
    assert Row(environment, was_run=True, trouble="pytest ended with -9").is_bad
    assert (
        Row(environment, was_run=True, failed=("a::b",)).is_bad and not Row(environment, was_run=True).is_bad
    )
    assert "not run: no such kernel" in table([Row(environment, trouble="no such kernel")])


def test_a_report_that_was_not_written_counts_nothing(tmp_path):
    assert counts(tmp_path / "report.xml") == (0, (), 0)


def test_what_does_not_end_is_ended(monkeypatch, tmp_path):
    session = run_environments.Session([sys.executable, "-c", "import time; time.sleep(60)"], 0.2)
    assert session.code() is None and session.process.returncode == -9
