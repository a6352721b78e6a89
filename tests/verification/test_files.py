# SPDX-License-Identifier: MIT
"""Run folders: every digit kept, strict JSON and CSV, each file whole or not at all, summary.json last;
records of checkpoints and the store through JSON and back: every bit, and nothing else than records.
"""

import csv
import json
import math
import os
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from builders import scene as small_scene
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from stored import same

from sam.scene import FieldMesh, LeftOut, Plasticity, Result, Status
from sam.scene.checkpoint import CodecError, decode, encode
from sam.scene.result import AXIS, COST, HISTORY, LINE, PLANE, QUANTITIES, SURFACE
from verification.runs import files
from verification.runs.files import FolderError, json_text, read_run, write_run
from verification.runs.provenance import collect
from verification.runs.tables import csv_text

THIRD = 1.0 / 3.0
TABLES = ("history", HISTORY, 2), ("axis", AXIS, 3), ("line", LINE, 4), ("plane", PLANE, 5)
SCENE = small_scene(title="Sphere", body={"poisson": THIRD})


def table(columns, rows):
    """Numbers that need all 17 digits, in the columns of an output table."""
    content = {name: THIRD * np.arange(1, rows + 1) / (1 + k) for k, name in enumerate(columns)}
    for name in {"state", "note"} & set(columns):
        content[name] = ["peak" if name == "state" else "elastic, in one step"] * rows
    return content


def a_result(**changes) -> Result:
    """A result that no solver made."""
    mesh = FieldMesh(
        points=np.array([[0.0, 0, 0], [1, 0, 1], [1, 1, 0], [0, 1, 0], [2, 0, 3], [2, 1, 0]]) * THIRD,
        cells={"quad": np.array([[0, 1, 2, 3]]), "triangle": np.array([[1, 4, 2], [4, 5, 2]])},
        point_data={"p_Pa": np.arange(6) * THIRD},
        cell_data={"stress_Pa": np.arange(18.0).reshape(3, 6), "mises_Pa": np.arange(3) * THIRD},
    )
    values = {
        "model": "sam",
        "status": Status.CONVERGED,
        "quantities": dict.fromkeys(QUANTITIES) | {"force_N": np.float64(0.1), "approach_m": math.nan},
        "tables": {name: table(columns, rows) for name, columns, rows in TABLES},
        "bodies": {"peak": mesh},
        "left_out": [LeftOut("tangential kernels", "no [friction]")],
        "discretisation": {"cells": np.array([65, 65]), "h_m": np.float64(THIRD), "dofs": np.int32(7)},
        "certificate": {"load_error": 1e-14},
        "cost": {"setup_s": 0.25},
    }
    return Result(**values | changes)


def test_a_run_reads_back_to_the_last_digit(tmp_path):
    result = a_result()
    assert write_run(result, SCENE, tmp_path / "deep" / "run") == tmp_path / "deep" / "run" / "summary.json"
    run = read_run(tmp_path / "deep" / "run")
    assert run.scene == SCENE and run.converged
    assert run.quantities["force_N"] == 0.1 and run.quantities["approach_m"] is None
    assert list(run.quantities) == list(QUANTITIES) and set(run.tables) == set(result.tables)
    for name, written in result.tables.items():
        assert list(run.tables[name]) == list(files.COLUMNS[name])
        for column, values in written.items():
            np.testing.assert_array_equal(run.tables[name][column], values)
    summary = run.summary
    assert summary["left_out"] == [{"stage": "tangential kernels", "reason": "no [friction]"}]
    assert summary["discretisation"] == {"cells": [65, 65], "h_m": THIRD, "dofs": 7}
    assert list(summary["cost"]) == list(COST) and summary["cost"]["ffts"] is None
    assert [summary[key] for key in ("status", "model", "message")] == ["converged", "sam", ""]


def test_the_spots_of_a_rough_body_by_hand(tmp_path):
    """Two spots on 4 x 3 cells of 2 um x 1 um, the larger force second, and none after unloading."""
    x, y = np.meshgrid([0.0, 2e-6, 4e-6, 6e-6], [0.0, 1e-6, 2e-6], indexing="ij")
    p = np.array([[1e6, 0, 0], [0, 0, 0], [0, 0, 2e6], [0, 0, 6e6]])  # x down, y to the right
    surface = {name: np.zeros(24) for name in SURFACE} | {"state": ["peak"] * 12 + ["unloaded"] * 12}
    surface |= {"x_m": np.tile(x.ravel(), 2), "y_m": np.tile(y.ravel(), 2), "p_Pa": np.append(p, 0.0 * p)}
    result = a_result(tables=a_result().tables | {"surface": surface})
    write_run(result, SCENE, tmp_path)
    first, second = read_run(tmp_path).tables["spots"].itertuples(index=False)
    assert first == pytest.approx(("peak", 1, 5.5e-6, 2e-6, 4e-12, 1.6e-5, 6e6, 2))
    assert second == pytest.approx(("peak", 2, 0.0, 0.0, 2e-12, 2e-6, 1e6, 1))


def test_a_plastic_scene_reads_back_with_its_curve(tmp_path):
    """What was in files is in summary.json: the run needs no other file to be done again."""
    profile = [(0.0, 1 + THIRD), (1e-6 * THIRD, 1.0)]
    law = Plasticity(law="table", file=[(0.0, 1e9), (THIRD, 2e9)], profile=profile)
    scene = small_scene(body={"poisson": THIRD, "plasticity": law})
    write_run(a_result(), scene, tmp_path)
    read = read_run(tmp_path).scene
    assert read == scene
    ours, theirs = scene.body.plasticity, read.body.plasticity
    assert theirs.curve() == ours.curve() and theirs.depth_profile() == ours.depth_profile()


def test_what_is_no_number_is_null_in_json_and_empty_in_csv(tmp_path):
    rows = table(LINE, 2) | {"gap_m": [None, math.nan], "p_Pa": [math.inf, np.float32(0.5)]}
    none = {"x": math.inf, "y": np.float64("nan")}
    write_run(a_result(tables={"line": rows}, certificate=none), SCENE, tmp_path)
    text = (tmp_path / "summary.json").read_text(encoding="utf-8")
    summary = json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert summary["certificate"] == {"x": None, "y": None}
    with open(tmp_path / "line.csv", encoding="utf-8", newline="") as stream:
        lines = list(csv.DictReader(stream))
    assert [[line["gap_m"], line["p_Pa"]] for line in lines] == [["", "inf"], ["", "0.5"]]
    assert np.isnan(read_run(tmp_path).tables["line"]["gap_m"]).all()


@pytest.mark.parametrize("value", [1 / 3, 5e-324, 1.7976931348623157e308, -0.0])
def test_numbers_keep_every_digit_in_csv(value):
    cell = csv_text(("x",), [(np.float64(value),)]).splitlines()[1]
    assert float(cell) == value and math.copysign(1, float(cell)) == math.copysign(1, value)
    assert csv_text(("a", "b"), [(np.int64(3), "one, two"), (True, None)]) == 'a,b\n3,"one, two"\nTrue,\n'


@pytest.mark.parametrize(
    "line",
    ["peak,0.1", "peak,0.1,2,3,4,5,6,7,8", "peak,0.1,2,three,4,5,6,7", 'peak,"0.1,2,3,4,5,6,7', "\xe9"],
    ids=["short", "long", "no number", "open quotation mark", "not UTF-8"],
)
def test_a_damaged_table_is_refused_by_name(tmp_path, line):
    write_run(a_result(), SCENE, tmp_path)
    with open(tmp_path / "line.csv", "ab") as stream:
        stream.write(f"{line}\n".encode("latin-1"))
    with pytest.raises(FolderError, match=r"line\.csv is damaged \(.+\): solve the scene again"):
        read_run(tmp_path)


@pytest.mark.parametrize(
    "change",
    [{"uz_m": None}, {"extra": [1.0] * 3}, {"uz_m": [1.0] * 2}],
    ids=["missing", "further", "shorter"],
)
def test_a_table_with_other_columns_is_refused_before_anything_is_written(tmp_path, change):
    rows = {name: values for name, values in (table(LINE, 3) | change).items() if values is not None}
    with pytest.raises(ValueError, match=r"columns|shorter"):
        write_run(a_result(tables={"line": rows}), SCENE, tmp_path / "run")
    with pytest.raises(ValueError, match="volume_m3"):  # a quantity outside the interface
        write_run(a_result(quantities={"volume_m3": 1.0}), SCENE, tmp_path / "run")
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("broken", ["history.csv", "fields.vtu", "summary.json"])
def test_a_write_that_breaks_off_leaves_no_result(tmp_path, monkeypatch, broken):
    """Whichever file fails, the older result is gone, no half file is left, and the next write succeeds."""
    write_run(a_result(), SCENE, tmp_path)
    rename, order = os.replace, []

    def failing(source, target):
        if os.path.basename(target) == broken:
            raise OSError("disk full")
        order.append(target.name)
        rename(source, target)

    monkeypatch.setattr(os, "replace", failing)
    with pytest.raises(OSError, match="disk full"):
        write_run(a_result(), SCENE, tmp_path)
    names = {entry.name for entry in tmp_path.iterdir()}
    assert not names & {broken, "summary.json"} and not any(name.startswith(".") for name in names)
    with pytest.raises(FolderError, match=r"no result: it has no summary\.json"):
        read_run(tmp_path)
    order, broken = [], ""
    write_run(a_result(), SCENE, tmp_path)
    assert read_run(tmp_path).converged and order[-1] == "summary.json" and len(order) == 7


def test_an_older_run_is_replaced_and_nothing_else(tmp_path):
    write_run(a_result(), SCENE, tmp_path)
    (tmp_path / "figures").mkdir()
    for name in ("figures/old.png", "figures/mine.txt", "notes.txt", "cycles.csv"):
        (tmp_path / name).write_text("x")
    write_run(replace(a_result(), cost={"solve_s": 3.0}), SCENE, tmp_path)
    assert (tmp_path / "figures" / "old.png").exists()  # of an equal result
    write_run(replace(a_result(), bodies={}, message="other"), SCENE, tmp_path)
    kept = {entry.relative_to(tmp_path).as_posix() for entry in tmp_path.rglob("*")}
    assert {"figures/mine.txt", "notes.txt"} <= kept
    assert kept.isdisjoint({"figures/old.png", "cycles.csv", "fields.vtu"})


@pytest.mark.parametrize(
    "name, text", [("thesis.txt", "x"), ("summary.json", "{}"), ("summary.json", "{"), ("sam", None)]
)
def test_a_folder_of_something_else_is_not_written_to(tmp_path, name, text):
    place = tmp_path / name
    place.mkdir() if text is None else place.write_text(text)
    with pytest.raises(FolderError, match=str(tmp_path)):
        write_run(a_result(), SCENE, tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


def test_reading_says_what_is_no_result(tmp_path):
    (tmp_path / "summary.json").write_text('{"status": "converged"}')
    with pytest.raises(FolderError, match='does not say "format"'):
        read_run(tmp_path)


def test_provenance_names_versions_machine_and_inputs():
    found = collect({"scene.toml": b"title"}, seeds=[3])
    assert found["input_sha256"] == {"scene.toml": sha256(b"title").hexdigest()} and found["seeds"] == [3]
    assert found["versions"]["numpy"] == np.__version__ and found["versions"]["samfem"]
    assert found["machine"]["cores"] >= 1 and found["time_utc"].endswith("+00:00")
    assert set(found) >= {"commit", "dirty", "threads"}
    assert json.loads(json_text(found)) == found
    content = {"a": np.arange(2.0), "b": ({"x": np.bool_(True)}, None, Status.CONVERGED)}
    assert json.loads(json_text(content)) == {"a": [0.0, 1.0], "b": [{"x": True}, None, "converged"]}


# records


ARRAYS = arrays(
    st.sampled_from(["f8", "i4", "?", "U3", "u1"]),
    array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=3),
)
LEAVES = st.one_of(
    *(st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.binary(max_size=9), ARRAYS),
    *(st.floats().map(np.float64), st.integers(0, 9).map(np.int32)),
)
TAGS = st.sampled_from(["array", "bytes", "scalar", "tuple", "dict"])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.lists(inner, max_size=3).map(tuple),
        st.dictionaries(st.text(max_size=3) | TAGS, inner, max_size=3),
    ),
    max_leaves=12,
)


@settings(max_examples=150, deadline=None)
@given(TREES)
def test_any_values_come_back_through_json(value):
    tree, kept_arrays = encode(value)
    assert same(decode(json.loads(json.dumps(tree)), kept_arrays, object), value)


def test_an_array_that_is_met_twice_is_stored_once_and_is_one_again():
    array = np.arange(3.0)
    tree, kept_arrays = encode({"a": array, "b": [array]})
    found = decode(tree, kept_arrays, object)
    assert len(kept_arrays) == 1 and found["a"] is found["b"][0]


@pytest.mark.parametrize(
    "value",
    [
        *(object(), {1: 2}, np.array([None]), 1j, {"deep": [(set(),)]}, Path("x")),
        *({"open": [Status.CONVERGED]}, {"open": LeftOut("a", "b")}),
    ],
)
def test_what_cannot_be_stored_is_refused(value):
    with pytest.raises(CodecError):
        encode(a_result(discretisation={"x": value}))


@pytest.mark.parametrize(
    "tree",
    [
        *({"array": "none"}, {"dict": 3}, {"bytes": 3}, {"scalar": []}, {"tuple": 1}),
        *({"scalar": ["|O", "00" * 8]}, {"scalar": ["<f8", "0"]}),
    ],
)
def test_values_that_were_not_encoded_are_refused(tree):
    with pytest.raises(CodecError):
        decode(tree, {}, object)


@pytest.mark.parametrize(
    "change",
    [
        {"status": "fine"},
        {"model": None},
        {"quantities": {"force_N": "1"}},
        {"cost": {"ffts": {"tuple": []}}},
        {"left_out": [{"stage": "a"}]},
        {"left_out": [{"stage": "a", "reason": "b", "more": "c"}]},
        {"fields": {"points": [1.0], "cells": {}}},
        {"warnings": "none"},
        {"unknown": 1},
    ],
)
def test_a_record_with_a_field_of_another_type_is_refused(change):
    good, kept_arrays = encode(Result("sam", Status.CONVERGED, {"force_N": 1.0}, {}))
    assert decode(good, kept_arrays, Result).converged
    with pytest.raises(CodecError, match="not the values of a Result"):
        decode(good | change, kept_arrays, Result)
