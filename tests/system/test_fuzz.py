# SPDX-License-Identifier: MIT
"""Bad input: readers raise their own errors only; each gate of the case turns red on what is wrong."""

import os
import random
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
from verification.cases.robustness import bad_input as case
from verification.cost.plan import check_needs, plan
from verification.robustness import fuzz
from verification.robustness.hostile import MAPPING, SMALL
from verification.runs import models
from verification.runs.archive import ArchiveError, read_archive, write_archive

SHARED = [HealthCheck.function_scoped_fixture]
SHARED_FOLDER = settings(max_examples=200, deadline=None, suppress_health_check=SHARED)
LEAVES = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=20), st.dates())
COUNT = len(fuzz.TURNS)


def test_some_inputs_are_valid_and_most_are_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tally = case.judge_readers(range(12 * COUNT), tmp_path)
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
        assert case.read_all(fuzz.lay(bad, tmp_path / name), bad) == "valid"


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
    values = of_frame("bad-input", pd.DataFrame(case.judged(tally, case.Tally())))
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
        (lambda path, bad: "valid" * bool(np.zeros(case.MEMORY // 4).size), "wrong-errors"),
        (lambda path, bad: Path("left").write_text("valid") and "valid", "writes-outside"),
    ],
)
def test_a_reader_that_misbehaves_turns_its_gate_red(tmp_path, monkeypatch, reader, gate):
    """It raises another error, takes too long or too much memory, or writes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(case, "LIMIT_S", 0.1)
    (folder := tmp_path / "in").mkdir()
    assert red(case.judge_readers([0], folder, reader)) == {gate}


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
        monkeypatch.setattr(case, "COMMAND_LIMIT_S", 0.3)
    one = [tuple(fuzz.KINDS).index("values")]
    assert red(case.judge_commands(one, tmp_path, (sys.executable, "-c", code))) == gates
