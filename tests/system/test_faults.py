# SPDX-License-Identifier: MIT
"""The lock of a folder; readers raise their own errors only; the gates of faults and of bad input turn red
when a file is cut, early, changed or lost, and on what else is wrong.
"""

import errno
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, example, given, settings, strategies as st
from made_results import of_frame

from sam.scene import SceneError, parse_scene, read_scene
from sam.scene.inputs import open_file
from sam.scene.schema import parse_toml, scene_of
from samfem import cli
from verification.cases.robustness import bad_input, faults
from verification.cases.sweep import tables_of
from verification.cost.plan import check_needs, plan
from verification.robustness import fuzz, kills
from verification.robustness.hostile import MAPPING, SMALL
from verification.robustness.kills import differences, fault_of, inspect, killed_solve, killed_sweep
from verification.rows import case_files
from verification.runs import files, lock, models
from verification.runs.archive import ArchiveError, read_archive, write_archive
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
    every = [(how, []) for how in faults.KINDS]

    def red(trials):
        values = of_frame("faults", pd.DataFrame(faults.judged({"kills": trials}, [])))
        return {name for name, measured in values.items() if measured.value}

    for gate in faults.GATES:
        assert red([*every, ("", [(gate, "wrong")])]) == {gate}
    assert red(every[:-1]) == {"missing-kinds"}
    frame = pd.DataFrame(faults.judged({"kills": every}, [])).assign(model="")
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
    monkeypatch.setitem(faults.FAULTS, "x", (lambda base: (code, text), (2,), "another"))
    _, found = faults.judge_fault("x", tmp_path / "f")
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


SHARED = [HealthCheck.function_scoped_fixture]
SHARED_FOLDER = settings(max_examples=200, deadline=None, suppress_health_check=SHARED)
LEAVES = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=20), st.dates())
COUNT = len(fuzz.TURNS)


def test_some_inputs_are_valid_and_most_are_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tally = bad_input.judge_readers(range(12 * COUNT), tmp_path)
    ends = Counter(end for _, end in tally.counts.elements())
    assert tally.findings == []
    assert set(ends) == {"valid", "refused"} and ends["refused"] > ends["valid"] > 20
    assert all(tally.counts[kind, "refused"] for kind in fuzz.KINDS)
    some = "values", "tables", fuzz.MAPPINGS, fuzz.STUDIES
    assert all(tally.counts[kind, "valid"] for kind in some)


def test_a_good_mesh_is_read_in_each_format(tmp_path):
    for name in fuzz.good_meshes():
        text = MAPPING.replace("own.vtu", name)
        bad = fuzz.BadInput(fuzz.MESHES, *fuzz.with_mapping(text.encode(), fuzz.good_meshes()))
        assert bad_input.read_all(fuzz.lay(bad, tmp_path / name), bad) == "valid"


@SHARED_FOLDER
@given(
    st.recursive(
        LEAVES,
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=9), inner, max_size=4),
        max_leaves=12,
    ),
    st.sampled_from(["body", "body.young", "counterbody.shape", "loading.steps", "grid.cells", "title"]),
)
@example([17, "17"], "grid.cells")
def test_any_value_at_any_key_is_a_scene_or_a_scene_error(value, keys):
    table = parse_toml(SMALL.encode(), "scene.toml")
    section, _, key = keys.rpartition(".")
    (table[section] if section else table)[key] = value
    try:
        plan(scene_of(table, "scene.toml")).lines(verbose=True)
    except SceneError as error:
        assert keys.partition(".")[0] in str(error)


@SHARED_FOLDER
@given(st.binary(max_size=200), st.integers(0, 2**32))
def test_any_bytes_are_an_archive_or_an_archive_error(tmp_path, noise, seed):
    path = tmp_path / "good.npz"
    write_archive(path, {"a": np.arange(12.0)}, {"x": [1, "é"]})
    for content in (noise, fuzz.mutated(random.Random(seed), path.read_bytes())):
        (tmp_path / "bad.npz").write_bytes(content)
        try:
            arrays, values = read_archive(tmp_path / "bad.npz")
        except ArchiveError:
            continue
        assert values == {"x": [1, "é"]} and np.array_equal(arrays["a"], np.arange(12.0))


def test_nothing_in_an_archive_is_unpickled(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.npz").write_bytes(fuzz.with_pickle())
    with pytest.raises(ArchiveError):
        read_archive(tmp_path / "bad.npz")
    assert not (tmp_path / "sprung").exists()
    with np.load(tmp_path / "bad.npz", allow_pickle=True) as content:  # the trap works
        content["x_m"]
    assert (tmp_path / "sprung").exists()


def test_a_pipe_a_device_or_a_folder_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", "/dev/zero", tmp_path):
        with pytest.raises(OSError, match=r"not an ordinary file|Is a directory"):
            open_file(path)
    with pytest.raises(SceneError, match="not an ordinary file"):
        read_scene(tmp_path / "pipe")


def test_deep_keys_and_thousands_of_errors_stay_readable():
    began = time.process_time()
    with pytest.raises(SceneError, match="nested too deeply"):
        parse_scene(b".".join([b"a"] * 50_000) + b" = 1", "s")
    with pytest.raises(SceneError, match="and 1903 more"):
        parse_scene(b"".join(b"k%d = 1\n" % k for k in range(2_000)), "s")
    assert time.process_time() - began < 2.0  # of the processor: other processes do not count
    parse_scene((SMALL.replace('"Small"', f'"{"." * 500}"')).encode(), "s")  # dots in a text are no depth


def plastic(grid: str, law: str = 'law = "perfect"\nyield_stress = "1 GPa"'):
    text = SMALL.replace("[counterbody]", f"[body.plasticity]\n{law}\n[counterbody]")
    return parse_scene(text.replace("cells = [17, 17]", grid).encode(), "s")


def test_what_takes_too_many_layers_or_too_wide_a_box_or_more_memory_than_there_is_is_refused_by_name():
    scene = plastic('extent = ["1e-15 m", "1e-15 m"]')
    with pytest.raises(models.ModelError, match=r"grid.extent = 1e-15 m and 1e-15 m: .* layers"):
        models.check(scene, models.SAM)
    assert [entry["available"] for entry in plan(scene).content["models"]] == [False, True, True]
    models.check(plastic('extent = ["1e-15 m", "1e-15 m"]\nlayers = 3\ndepth = "1 um"'), models.SAM)
    soft = plastic("", 'law = "perfect"\nyield_stress = "3 MPa"')
    with pytest.raises(models.ModelError, match=r"fem.box = 10.0: more than .* Hertz radii"):
        models.check(soft, models.FEM)
    large = plastic("cells = [4097, 4097]")
    words = r"TB of memory needed, 8 GB available: lower grid.cells = \[4097, 4097\].*; grid.cells = \[\d+, "
    with pytest.raises(models.ModelError, match=words):
        check_needs(large, models.SAM, 8e9)
    with pytest.raises(models.ModelError, match=r"lower fem.cells_per_radius = 4 or fem.box = 10"):
        check_needs(large, models.FEM, 1e6)
    check_needs(large, models.FEM, 8e9)


def test_control_characters_of_a_title_do_not_reach_the_terminal():
    lines = plan(parse_scene(SMALL.replace("Small", "\\u001b[31m\\u0007x").encode(), "s")).lines(verbose=True)
    assert lines[0] == "?[31m?x"


def red(tally) -> set[str]:
    values = of_frame("bad-input", pd.DataFrame(bad_input.judged(tally, bad_input.Tally())))
    return {name for name, measured in values.items() if measured.value} - {"kinds-left-out"}


def slow(path, bad):
    try:
        began = time.process_time()
        while time.process_time() < began + 5:
            pass
    except Exception:  # a handler that takes everything does not take the limit
        pass
    return "valid"


@pytest.mark.parametrize(
    ("reader", "gate"),
    [
        (lambda path, bad: {}[bad.kind], "wrong-errors"),
        (slow, "hangs"),
        (lambda path, bad: "valid" * bool(np.zeros(bad_input.MEMORY // 4).size), "wrong-errors"),
        (lambda path, bad: Path("left").write_text("valid") and "valid", "writes-outside"),
    ],
)
def test_a_reader_that_misbehaves_turns_its_gate_red(tmp_path, monkeypatch, reader, gate):
    """It raises another error, takes too long or too much memory, or writes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(bad_input, "LIMIT_S", 0.1)
    (folder := tmp_path / "in").mkdir()
    assert red(bad_input.judge_readers([0], folder, reader)) == {gate}


@pytest.mark.parametrize(
    ("code", "gates"),
    [
        ("pass", set()),
        ("import os; os.makedirs('out/run')", set()),
        ("import sys, os; os.makedirs('out/run'); sys.exit(2)", {"writes-outside"}),
        ("open('left', 'w')", {"writes-outside"}),
        ("import os; open(os.path.expanduser('~/.left'), 'w')", {"writes-outside"}),
        ("import tempfile; tempfile.mkdtemp()", {"writes-outside"}),
        ("import os; os.remove('../in/scene.toml')", {"writes-outside"}),
        ("1 / 0", {"tracebacks"}),
        ("print('internal error, please report it')", {"tracebacks"}),
        ("import sys; sys.exit(3)", {"exit-codes"}),
        ("import os; os.kill(os.getpid(), 11)", {"exit-codes"}),
        ("import time; time.sleep(9)", {"hangs"}),
    ],
)
def test_a_command_that_misbehaves_turns_its_gate_red(tmp_path, monkeypatch, code, gates):
    if gates == {"hangs"}:
        monkeypatch.setattr(bad_input, "COMMAND_LIMIT_S", 0.3)
    one = [tuple(fuzz.KINDS).index("values")]
    assert red(bad_input.judge_commands(one, tmp_path, (sys.executable, "-c", code))) == gates
