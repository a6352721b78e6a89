# SPDX-License-Identifier: MIT
"""The lock of a folder, and the gates of the faults: red when a file is cut, early, changed or lost."""

import errno
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest
from made_results import of_frame

from samfem import cli
from verification.cases.robustness import faults as case
from verification.cases.sweep import tables_of
from verification.robustness import kills
from verification.robustness.kills import differences, fault_of, inspect, killed_solve, killed_sweep
from verification.rows import case_files
from verification.runs import files, lock
from verification.runs.files import FolderError, write_atomically
from verification.runs.lock import locked

PROC = Path("/proc/self").exists()


def gates_of(findings) -> set[str]:
    return {gate for gate, _ in findings}


HOLD = """import sys, time
from verification.runs.lock import locked
with locked(sys.argv[1]):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that holds tmp_path/run."""
    process = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path / "run")], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"held\n"
    yield process
    process.kill()
    process.wait()


def test_a_folder_that_another_process_holds_is_refused_at_once_by_name(tmp_path, holder):
    began = time.monotonic()
    with pytest.raises(FolderError) as error, locked(tmp_path / "run"):
        pass
    assert time.monotonic() - began < 20.0  # to wait for the other would take its 60 s
    name = f"process {holder.pid} on " if PROC else "another process"
    assert f"run is being written by {name}" in str(error.value)
    assert "wait, or give another --out" in str(error.value)
    with locked(tmp_path / "other"):
        pass


def test_the_lock_of_a_killed_process_is_free_and_leaves_no_file(tmp_path, holder):
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    with locked(tmp_path / "run"):
        assert list((tmp_path / "run").iterdir()) == []


def test_two_blocks_of_one_process_exclude_each_other_until_one_ends_or_fails(tmp_path):
    with pytest.raises(ZeroDivisionError), locked(tmp_path):
        with pytest.raises(FolderError), locked(tmp_path):
            pass
        raise ZeroDivisionError
    with locked(tmp_path):
        pass
    (tmp_path / "file").touch()
    with pytest.raises(FolderError, match="cannot be used"), locked(tmp_path / "file" / "run"):
        pass


def test_a_locked_folder_is_made_and_goes_again_if_it_stays_empty(tmp_path):
    with locked(tmp_path / "a" / "b"):
        assert (tmp_path / "a" / "b").is_dir()
    assert list(tmp_path.iterdir()) == []
    with locked(tmp_path / "a" / "b"):
        (tmp_path / "a" / "b" / "file").touch()
    (tmp_path / "empty").mkdir()
    with locked(tmp_path / "empty"):
        pass
    assert (tmp_path / "a" / "b" / "file").exists() and (tmp_path / "empty").is_dir()


def test_without_locks_of_the_system_there_is_none(tmp_path, monkeypatch):
    def none(*_, **_by_name):
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))

    monkeypatch.setattr(lock, "lock_descriptor", none)
    with locked(tmp_path), locked(tmp_path):
        pass


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        ("a.csv", b"x,y\n1,2\n", b"x,y\n1\n"),
        ("b.csv", b"x,y\n1,2\n", b"x,y\n1,2"),
        ("c.csv", b"x\n", b""),
        ("d.json", b"{}\n", b'{"a": '),
        ("e.vtu", b"<a/>", b"<a>"),
        ("f.npz", None, b"PK\x03\x04"),
    ],
)
def test_a_file_that_is_cut_is_found(tmp_path, name, good, bad):
    path = tmp_path / name
    if good is not None:
        path.write_bytes(good)
        assert fault_of(path) == ""
    path.write_bytes(bad)
    assert fault_of(path)
    assert [gate for gate, _ in inspect(tmp_path)] == ["broken-files"]


def test_early_summaries_left_over_files_and_changed_tables_are_found(tmp_path):
    (tmp_path / "summary.json").write_text("{}")
    (tmp_path / ".history.csv.1.part").write_text("cut")
    (tmp_path / "a.csv").write_bytes(b"x\n1\n")
    assert gates_of(inspect(tmp_path)) == {"early-summaries"}
    assert gates_of(inspect(tmp_path, unfinished=False)) == {"early-summaries", "broken-files"}
    for expected, names in (({"a.csv": b"x\n1\n"}, 0), ({"a.csv": b"x\n2\n"}, 1), ({"b.csv": b"x\n1\n"}, 2)):
        found = differences(tmp_path, expected, "killed")
        assert [gate for gate, _ in found] == ["changed-tables"] * names


def test_every_finding_turns_its_gate_red():
    every = [(how, []) for how in case.KINDS]

    def red(trials):
        values = of_frame("faults", pd.DataFrame(case.judged({"kills": trials}, [])))
        return {name for name, measured in values.items() if measured.value}

    for gate in case.GATES:
        assert red([*every, ("", [(gate, "wrong")])]) == {gate}
    assert red(every[:-1]) == {"missing-kinds"}
    frame = pd.DataFrame(case.judged({"kills": every}, [])).assign(model="")
    assert [each.caption for each in tables_of(case_files()["faults"], frame)] == ["kills"]


FAKE = """import pathlib, sys, time
folder = pathlib.Path(sys.argv[sys.argv.index("--out") + 1]); folder.mkdir(parents=True, exist_ok=True)
def write(name, text): (folder / name).write_text(text)
"""


def fake(monkeypatch, body: str) -> None:
    """A command in place of samfem."""
    monkeypatch.setattr(kills, "SAMFEM", (sys.executable, "-c", FAKE + body))


@pytest.mark.parametrize(
    ("body", "gates"),
    [
        ("write('a.csv', 'x\\n1\\n')", set()),
        ("write('a.csv', 'x\\n2\\n')", {"changed-tables"}),
        ("write('a.csv', 'x,y\\n1')", {"broken-files", "changed-tables"}),
        ("write('a.csv', 'x\\n1\\n'); sys.exit(1)", {"wrong-endings"}),
        ("write('a.csv', 'x\\n1\\n'); write('summary.json', '{}')", {"early-summaries"}),
    ],
)
def test_a_solve_that_leaves_something_wrong_is_found(tmp_path, monkeypatch, body, gates):
    fake(monkeypatch, body)
    _, found = killed_solve(["solve"], tmp_path / "run", {"a.csv": b"x\n1\n"}, 0.0, store=tmp_path)
    assert gates_of(found) == gates


def test_a_sweep_that_solves_finished_points_again_is_found(tmp_path, monkeypatch):
    table = "index,status\n0,converged\n1,converged\n2,refused\n"
    counts = """write('sweep.json', '{"counts": {"reused": 0}}')"""
    again = f"(folder / 'again').exists() and ({counts}, sys.exit(0))\n"
    fake(monkeypatch, f"{again}write('sweep.csv', {table!r}); write('again', ''); time.sleep(30)")
    how = {"whom": "parent", "rng": random.Random(1)}
    _, found = killed_sweep(["sweep"], tmp_path / "s", table.encode(), 1.0, **how)
    assert [gate for gate, _ in found] == ["lost-points"] * 2


@pytest.mark.parametrize(
    ("code", "text", "gates"),
    [
        (2, "samfem: error: use another", set()),
        (1, "samfem: error: use another", {"wrong-endings"}),
        (2, "samfem: error: no", {"wrong-endings"}),
        (2, "Traceback (most recent call last)\nsamfem: error: another", {"wrong-endings"}),
    ],
)
def test_a_fault_that_ends_wrongly_is_found(tmp_path, monkeypatch, code, text, gates):
    monkeypatch.setitem(case.FAULTS, "x", (lambda base: (code, text), (2,), "another"))
    _, found = case.judge_fault("x", tmp_path / "f")
    assert gates_of(found) == gates


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EFBIG])
def test_a_full_disk_names_the_file_and_leaves_none(tmp_path, monkeypatch, capsys, number):
    def full(_descriptor):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(files.os, "fsync", full)
    monkeypatch.setattr(cli, "_run", lambda options: write_atomically(tmp_path / "a.csv", b"x\n"))
    assert cli.main(["plan", "x"]) == 1
    message = capsys.readouterr().err
    assert "a.csv" in message and "free some space" in message and list(tmp_path.iterdir()) == []
