# SPDX-License-Identifier: MIT
"""The store: bit for bit what was computed, and nothing that is stale, damaged, another's or half-written."""

import errno
import json
import multiprocessing
import os
import shutil
import signal
from dataclasses import fields, is_dataclass, replace
from datetime import UTC, datetime
from enum import Enum
from pathlib import Path

import numpy as np
import pytest
from builders import scene_text
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from test_report import sketch

from sam.scene import FieldMesh, LeftOut, Result, Status, parse_scene, read_scene, resolved
from sam.scene.codec import CodecError, decode, encode
from verification.app.cli import main
from verification.runs import models, store
from verification.runs.archive import read_archive, write_archive
from verification.runs.code_version import OF_CASES, PLACES, ROOT, code_version, version_of_cases
from verification.runs.files import write_run
from verification.runs.store import FOLDER, Store, default_store, identity, solve_or_reuse
from verification.suite import outcomes, verify
from verification.suite.cases.case import Case, Outcome
from verification.suite.gates import Measured, load_gates
from verification.suite.report import render

COARSE = 'unload = true\n[grid]\ncells = [33, 33]\nlayers = 20\ndepth = "12 um"\n[fem]\ncells_per_radius = 8\nbox = 6\n'
BOTH = (models.SAM, models.FEM)


@pytest.fixture(scope="module")
def scene():
    return parse_scene(scene_text(add=COARSE).encode(), "coarse")


@pytest.fixture(scope="module")
def solved(scene):
    return {model: models.solve(scene, model) for model in BOTH}


@pytest.fixture
def kept(tmp_path, scene, solved):
    """A store with the results of both models."""
    kept = Store(tmp_path / "store")
    for model, result in solved.items():
        kept.keep(scene, model, result)
    return kept


@pytest.fixture
def counted(monkeypatch, solved):
    """The models that were asked to solve; they answer at once."""
    calls = []

    def solve(scene, model, progress=None, **how):
        calls.append(model)
        return solved[model]

    monkeypatch.setattr(models, "solve", solve)
    return calls


def same(a, b) -> bool:
    """Equal in type, in every bit of a number, and all the way down."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray | np.generic):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, Enum) or not (is_dataclass(a) or isinstance(a, dict | list | tuple)):
        return repr(a) == repr(b)
    if is_dataclass(a):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a))
    if isinstance(a, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    return len(a) == len(b) and all(map(same, a, b))


def flipped(path: Path, place: int) -> None:
    content = bytearray(path.read_bytes())
    content[place] ^= 0x10
    path.write_bytes(content)


# what is stored


@pytest.mark.parametrize("model", BOTH)
def test_a_result_comes_back_with_every_type_and_bit_and_writes_the_same_run(
    kept, scene, solved, model, tmp_path
):
    found = kept.lookup(scene, model)
    assert found.note == "" and same(found.result, solved[model])
    assert found.result.status is Status.CONVERGED and found.created
    for name, result in (("own", solved[model]), ("stored", found.result)):
        write_run(result, scene, tmp_path / name, {})
    files = sorted(entry.name for entry in (tmp_path / "own").iterdir())
    assert len(files) >= 6
    assert all(
        (tmp_path / "own" / name).read_bytes() == (tmp_path / "stored" / name).read_bytes() for name in files
    )


@pytest.mark.parametrize("change", [{"message": "x"}, {"warnings": []}, {"quantities": {}}])
def test_the_comparison_of_this_test_sees_a_difference(solved, change):
    assert not same(replace(solved[models.SAM], **change), solved[models.SAM])


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
NAMED = st.dictionaries(st.text(max_size=3), TREES, max_size=3)
NUMBERS = st.none() | st.floats() | st.integers()
RECORDS = st.builds(
    Result,
    model=st.text(),
    status=st.sampled_from(list(Status)),
    quantities=st.dictionaries(st.text(max_size=3), st.none() | st.floats(), max_size=3),
    tables=st.dictionaries(
        st.text(max_size=3), st.dictionaries(st.text(max_size=3), st.lists(TREES) | ARRAYS)
    ),
    fields=st.none() | st.builds(FieldMesh, ARRAYS, st.dictionaries(st.text(max_size=3), ARRAYS, max_size=2)),
    left_out=st.lists(st.builds(LeftOut, st.text(), st.text()), max_size=2).map(tuple),
    discretisation=NAMED,
    cost=st.dictionaries(st.text(max_size=3), NUMBERS, max_size=3),
    warnings=st.lists(st.text(), max_size=2),
)


@settings(max_examples=150, deadline=None)
@given(TREES)
def test_any_values_come_back_through_json(value):
    tree, kept_arrays = encode(value)
    assert same(decode(json.loads(json.dumps(tree)), kept_arrays, object), value)


@settings(max_examples=60, deadline=None)
@given(RECORDS)
def test_any_record_comes_back_through_json(record):
    tree, kept_arrays = encode(record)
    assert same(decode(json.loads(json.dumps(tree)), kept_arrays, Result), record)


def test_an_array_that_is_met_twice_is_stored_once_and_is_one_again():
    array = np.arange(3.0)
    tree, kept_arrays = encode({"a": array, "b": [array]})
    found = decode(tree, kept_arrays, object)
    assert len(kept_arrays) == 1 and found["a"] is found["b"][0]


BAD = [object(), {1: 2}, np.array([None]), 1j, {"deep": [(set(),)]}, Path("x"), {"open": [Status.CONVERGED]}]


@pytest.mark.parametrize("value", [*BAD, {"open": LeftOut("a", "b")}])
def test_what_cannot_be_stored_is_refused(solved, value):
    with pytest.raises(CodecError):
        encode(replace(solved[models.SAM], discretisation={"x": value}))


@pytest.mark.parametrize(
    "tree",
    [
        {"array": "none"},
        {"dict": 3},
        {"bytes": 3},
        {"scalar": ["|O", "00" * 8]},
        {"scalar": ["<f8", "0"]},
        {"scalar": []},
        {"tuple": 1},
    ],
)
def test_values_that_were_not_encoded_are_refused(tree):
    with pytest.raises(CodecError):
        decode(tree, {}, object)


@pytest.mark.parametrize(
    "change",
    [
        {"status": "fine"},
        {"status": 3},
        {"model": None},
        {"quantities": {"force_N": "1"}},
        {"quantities": [1.0]},
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


# what it is found by


def test_the_title_is_no_part_of_the_key_and_everything_else_is(kept, scene):
    assert kept.lookup(scene.model_copy(update={"title": "another"}), models.SAM).result is not None
    heavier = scene.loading.model_copy(update={"force": np.nextafter(scene.loading.force, 1)})
    other = scene.model_copy(update={"loading": heavier})
    assert kept.lookup(other, models.SAM) == store.Lookup()
    assert identity(scene, models.SAM) != identity(scene, models.FEM)


def test_a_file_that_a_scene_names_counts_by_its_content(tmp_path):
    plastic = '[body.plasticity]\nlaw = "table"\nfile = "{}.csv"\n'
    found = []
    for name, second in (("a", "2e9"), ("b", "2.0e9"), ("c", "2.1e9")):
        (tmp_path / f"{name}.csv").write_text(f"peeq,yield_stress_Pa\n0,1e9\n0.1,{second}\n")
        (tmp_path / f"{name}.toml").write_text(scene_text() + plastic.format(name))
        found.append(identity(read_scene(tmp_path / f"{name}.toml")[0], models.SAM))
    assert found[0] == found[1] != found[2]


def test_an_entry_of_other_code_is_stale_and_is_replaced(kept, scene, counted, monkeypatch):
    monkeypatch.setattr(store, "code_version", lambda model: "f" * 64)
    monkeypatch.setattr(store, "unchanged", lambda model: True)
    found = kept.lookup(scene, models.SAM)
    assert found.result is None and found.note.startswith(
        f"stale: computed by code {code_version(models.SAM)[:8]} of 20"
    )
    _, reuse = solve_or_reuse(kept, scene, models.SAM)
    assert counted == [models.SAM] and not reuse.reused and reuse.text == f"{found.note}: computed again"
    assert kept.lookup(scene, models.SAM).result is not None and len(kept.entries()) == 2


def test_a_result_is_solved_once_and_fresh_on_request(tmp_path, scene, counted):
    own, before = Store(tmp_path / "deep" / "store"), datetime.now(UTC).replace(microsecond=0)
    reuses = [solve_or_reuse(own, scene, models.SAM)[1] for _ in range(3)]
    assert counted == [models.SAM] and [reuse.reused for reuse in reuses] == [False, True, True]
    assert all(before <= datetime.fromisoformat(reuse.created) <= datetime.now(UTC) for reuse in reuses)
    assert reuses[1].created == reuses[2].created and "taken from the store: computed 20" in reuses[1].text
    assert not solve_or_reuse(own, scene, models.SAM, fresh=True)[1].reused
    assert not solve_or_reuse(None, scene, models.SAM)[1].reused
    assert counted == [models.SAM] * 3


def test_what_did_not_converge_is_not_kept(tmp_path, scene, solved):
    own = Store(tmp_path)
    own.keep(scene, models.SAM, replace(solved[models.SAM], status=Status.UNDER_RESOLVED))
    assert own.entries() == []


def test_a_result_is_not_kept_if_the_code_changed_meanwhile(tmp_path, scene, solved, monkeypatch, capsys):
    monkeypatch.setattr(store, "unchanged", lambda model: False)
    Store(tmp_path).keep(scene, models.SAM, solved[models.SAM])
    assert Store(tmp_path).entries() == [] and "changed since the command began" in capsys.readouterr().err


# the version of the code


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    root = tmp_path_factory.mktemp("tree")
    for package in OF_CASES:
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("__pycache__"))
    return root


def versions(root: Path) -> tuple[str, str, str]:
    """Of SAM, FEM and the cases."""
    return (*(code_version.__wrapped__(model, root) for model in BOTH), version_of_cases.__wrapped__(root))


@pytest.mark.parametrize(
    ("path", "changes"),
    [
        ("sam/contact/normal.py", (True, False, True)),
        ("sam/kernels/load_table.json", (True, False, True)),
        ("sam/scene/yield_curve.py", (True, True, True)),
        ("fem_reference/common/plasticity.py", (False, True, True)),
        ("verification/runs/models.py", (True, True, True)),
        ("verification/suite/cases/hertz.py", (False, False, True)),
        ("verification/figures/style.py", (False, False, True)),
        ("verification/suite/report.py", (False, False, False)),
        ("verification/suite/gates.toml", (False, False, False)),
        ("verification/suite/templates/report.css", (False, False, False)),
        ("verification/scenes/hertz-sphere.toml", (False, False, False)),
    ],
)
def test_one_byte_changes_the_version_of_what_depends_on_it(tree, path, changes):
    before, content = versions(tree), (tree / path).read_bytes()
    (tree / path).write_bytes(content[:-1] + b"#")
    after = versions(tree)
    (tree / path).write_bytes(content)
    assert tuple(a != b for a, b in zip(before, after, strict=True)) == changes
    assert versions(tree) == before


def test_a_new_file_and_another_numpy_change_the_version_too(tree, monkeypatch):
    before = versions(tree)
    (tree / "sam" / "extra.py").write_text("")
    assert [a != b for a, b in zip(before, versions(tree), strict=True)] == [True, False, True]
    (tree / "sam" / "extra.py").unlink()
    monkeypatch.setattr("verification.runs.code_version._installed", lambda package: "0.0")
    assert all(a != b for a, b in zip(before, versions(tree), strict=True))


def test_every_model_has_a_version():
    assert set(PLACES) == set(models.MODELS)


# damage


def test_no_flipped_byte_and_no_shortened_file_gives_another_result(kept, scene, solved):
    (path,) = [entry.path for entry in kept.entries() if entry.what == models.FEM]
    whole = path.read_bytes()
    places = np.random.default_rng(4).integers(0, len(whole), 40)
    damaged = 0
    for place in (0, len(whole) - 1, *places.tolist()):
        flipped(path, place)
        found = kept.lookup(scene, models.FEM)
        damaged += found.note.startswith("damaged: ")
        assert found.result is None or same(
            found.result, solved[models.FEM]
        )  # a byte of padding or of a date is none of it
        path.write_bytes(whole)
    assert damaged > 35
    for length in (0, 1, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        found = kept.lookup(scene, models.FEM)
        assert found.result is None and found.note.startswith("damaged: ") and str(path) in found.note
        path.write_bytes(whole)


def test_a_damaged_entry_is_solved_again(kept, scene, counted):
    for entry in kept.entries():
        flipped(entry.path, entry.size // 2)
    assert [entry.state for entry in kept.entries()] == ["damaged", "damaged"]
    _, reuse = solve_or_reuse(kept, scene, models.SAM)
    assert (
        counted == [models.SAM]
        and reuse.text.startswith("damaged: ")
        and reuse.text.endswith(": computed again")
    )
    assert sorted(entry.state for entry in kept.entries()) == ["current", "damaged"]


def test_an_entry_under_another_name_is_damage(kept, scene):
    (sam,), (fem,) = ([entry.path for entry in kept.entries() if entry.what == model] for model in BOTH)
    shutil.copy(fem, sam)
    assert "holds something else than its name says" in kept.lookup(scene, models.SAM).note
    assert sorted(entry.state for entry in kept.entries()) == ["current", "damaged"]


@pytest.mark.parametrize("content", [3, {"Outcome": []}, {"dict": []}, None])
def test_an_entry_with_other_content_is_damage(kept, scene, content):
    (path,) = [entry.path for entry in kept.entries() if entry.what == models.SAM]
    inside, values = read_archive(path)
    write_archive(path, inside, values | {"content": content})
    assert kept.lookup(scene, models.SAM).note.startswith("damaged: ")


def test_nothing_is_unpickled(kept, scene, tmp_path):
    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "sprung"),)

    (path,) = [entry.path for entry in kept.entries() if entry.what == models.SAM]
    np.savez(path, **{"values.json": np.array([Trap()], dtype=object)})
    assert kept.lookup(scene, models.SAM).note.startswith("damaged: ")
    assert not (tmp_path / "sprung").exists()


# faults and company


def test_a_store_that_cannot_be_written_costs_one_warning_and_no_result(tmp_path, scene, counted, capsys):
    (tmp_path / "file").write_text("")
    own = Store(tmp_path / "file" / "store")
    for _ in range(2):
        assert solve_or_reuse(own, scene, models.SAM)[0].converged
    message = capsys.readouterr().err
    assert (
        message.count("\n") == 1 and str(own.folder) in message and FOLDER in message and "warning" in message
    )
    assert own.entries() == [] and own.left_over() == []


def test_a_full_disk_leaves_nothing(tmp_path, scene, counted, capsys, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    assert solve_or_reuse(Store(tmp_path), scene, models.SAM)[0].converged
    assert "No space left on device" in capsys.readouterr().err and list(tmp_path.iterdir()) == []


def _keep_and_look(folder: Path, scene, result, turns: int) -> None:
    own = Store(folder)
    for _ in range(turns):
        own.keep(scene, models.SAM, result)
        if own.lookup(scene, models.SAM).result is None:
            os._exit(3)


def test_processes_that_keep_the_same_key_all_succeed(tmp_path, scene, solved):
    fork = multiprocessing.get_context("fork")
    crowd = [
        fork.Process(target=_keep_and_look, args=(tmp_path, scene, solved[models.SAM], 8)) for _ in range(3)
    ]
    for process in crowd:
        process.start()
    for process in crowd:
        process.join(20)
    assert [process.exitcode for process in crowd] == [0, 0, 0]
    assert [entry.state for entry in Store(tmp_path).entries()] == ["current"]
    assert len(list(tmp_path.iterdir())) == 1


def _keep_and_die(folder: Path, scene, result) -> None:
    os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)
    Store(folder).keep(scene, models.SAM, result)


def test_a_killed_process_leaves_a_temporary_file_that_prune_removes(tmp_path, scene, solved):
    process = multiprocessing.get_context("fork").Process(
        target=_keep_and_die, args=(tmp_path, scene, solved[models.SAM])
    )
    process.start()
    process.join(20)
    assert process.exitcode == -signal.SIGKILL
    own = Store(tmp_path)
    assert own.entries() == [] and own.lookup(scene, models.SAM) == store.Lookup()
    (left,) = own.left_over()
    living = left.with_name(left.name.replace(f".{process.pid}.", f".{os.getpid()}."))
    shutil.copy(left, living)  # of a process that still writes
    (tmp_path / "notes.txt").write_text("not of the store")
    (tmp_path / "results.npz").write_text("neither")
    removed = list(own.prune(lambda entry: True))
    assert len(removed) == 1 and "left over" in removed[0][0] and removed[0][1] > 1e4
    assert {path.name for path in tmp_path.iterdir()} == {living.name, "notes.txt", "results.npz"}


def test_the_folder_of_the_store(monkeypatch, tmp_path):
    monkeypatch.setenv(FOLDER, "")
    assert default_store() is None
    monkeypatch.setenv(FOLDER, str(tmp_path))
    assert default_store().folder == tmp_path
    monkeypatch.delenv(FOLDER)
    monkeypatch.setenv("HOME", str(tmp_path))
    for caches, expected in (
        (str(tmp_path / "c"), tmp_path / "c"),
        ("", tmp_path / ".cache"),
        ("c", tmp_path / ".cache"),
    ):
        monkeypatch.setenv("XDG_CACHE_HOME", caches)
        assert default_store().folder == expected / "samfem"


# the commands


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder with coarse.toml, and a store of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(FOLDER, str(tmp_path / "store"))
    (tmp_path / "coarse.toml").write_text(scene_text(add=COARSE))
    return tmp_path


def test_compare_solves_once_and_what_solve_left_not_at_all(folder, counted, capsys):
    code = main(["solve", "coarse.toml", "--model", models.FEM])
    assert code == 0 and counted == [models.FEM]
    assert main(["compare", "coarse.toml"]) in (0, 1) and counted == [models.FEM, models.SAM]
    first = (folder / "coarse-compare" / "compare.csv").read_bytes()
    assert "fem-axisymmetric: taken from the store: computed 20" in capsys.readouterr().err
    main(["compare", "coarse.toml"])
    assert (
        counted == [models.FEM, models.SAM]
        and (folder / "coarse-compare" / "compare.csv").read_bytes() == first
    )
    summary = json.loads((folder / "coarse-compare" / "sam" / "summary.json").read_text(encoding="utf-8"))
    assert summary["provenance"]["from_store"]["computed_utc"].startswith("20")
    main(["solve", "coarse.toml", "--model", models.FEM])
    assert counted == [models.FEM, models.SAM, models.FEM]  # solve always solves


def test_compare_without_the_store_neither_reads_nor_fills_it(folder, counted, capsys):
    for _ in range(2):
        main(["compare", "coarse.toml", "--no-store"])
    assert (
        counted == [*BOTH, *BOTH]
        and not (folder / "store").exists()
        and "store" not in capsys.readouterr().err
    )


def test_store_lists_and_prunes(folder, counted, capsys, monkeypatch):
    assert main(["store"]) == 0 and "0 entries" in capsys.readouterr().out
    main(["compare", "coarse.toml"])
    capsys.readouterr()
    assert main(["store"]) == 0
    listed = capsys.readouterr().out
    assert "2 entries (2 current, 0 stale, 0 damaged), 0 left over" in listed and "fem-axisymmetric" in listed
    keys = [path.stem for path in (folder / "store").iterdir()]
    assert all(key[:12] in listed for key in keys)
    assert (
        main(["store", "--prune", "--older-than", "1"]) == 0
        and "0 removed, 0 B freed" in capsys.readouterr().out
    )
    flipped(folder / "store" / f"{keys[0]}.npz", 40)
    size = (folder / "store" / f"{keys[0]}.npz").stat().st_size
    assert main(["store", "--prune"]) == 0
    said = capsys.readouterr().out
    assert f"removed {keys[0][:12]}" in said and "1 removed" in said and f"{size / 1e3:.0f} kB freed" in said
    monkeypatch.setattr(store.Entry, "age_days", 3.0)
    assert main(["store", "--prune", "--older-than", "4"]) == 0 and "0 removed" in capsys.readouterr().out
    assert main(["store", "--prune", "--older-than", "2"]) == 0 and "1 removed" in capsys.readouterr().out
    main(["compare", "coarse.toml"])
    capsys.readouterr()
    assert main(["store", "--prune", "all"]) == 0 and "2 removed" in capsys.readouterr().out
    assert list((folder / "store").iterdir()) == []


@pytest.mark.parametrize(
    "words", [["--older-than", "3"], ["--prune", "all", "--older-than", "3"], ["--prune", "x"]]
)
def test_store_refuses_what_could_be_misread(folder, words, capsys):
    assert main(["store", *words]) == 2 and "--" in capsys.readouterr().err


@pytest.mark.parametrize("days", ["-1", "nan", "inf", "many"])
def test_store_refuses_an_age_that_is_none(folder, days, capsys):
    assert main(["store", "--prune", "--older-than", days]) == 2 and "--older-than" in capsys.readouterr().err


def test_store_says_when_there_is_none(monkeypatch, capsys):
    monkeypatch.setenv(FOLDER, "")
    assert main(["store", "--prune"]) == 0 and "no store" in capsys.readouterr().out


# whole cases

GATES = '[[gate]]\nid = "small.one"\ncase = "small"\nquantity = "one"\nmetric = "relative"\ntolerance = {}\nreason = "because"\n'


class Small:
    """A case that solves the coarse scene with SAM, draws, and counts its runs."""

    def __init__(self, scene):
        self.scene, self.runs, self.problem, self.fresh = scene, 0, "", False

    def __call__(self, context):
        self.runs += 1
        context.scene("hertz-sphere")
        result = context.solve(models.SAM, self.scene, "sam", fresh=self.fresh)
        if self.problem:
            raise RuntimeError(self.problem)
        outcome = Outcome(
            {
                "small.one": Measured(
                    np.float64(result.quantities["p_max_Pa"] * 1.01), result.quantities["p_max_Pa"]
                )
            }
        )
        outcome.figures = [context.save(sketch(), "curve", "A curve", "Two curves", "Caption")]
        outcome.setup = [("Force", "1 N")]
        return outcome


@pytest.fixture
def small(monkeypatch, scene, counted):
    case = Small(scene)
    monkeypatch.setattr(
        verify, "all_cases", lambda: {"small": Case("small", "Small case", "Does it hold?", case)}
    )
    monkeypatch.setattr(verify, "load_gates", lambda: load_gates(GATES.format(0.1)))
    return case


def report_of(tmp_path, code=0, name="out", level="quick") -> dict:
    assert verify.main([], level, tmp_path / name, None, Store(tmp_path / "store")) == code
    return json.loads((tmp_path / name / "results.json").read_text(encoding="utf-8"))


def tree_of(folder: Path) -> dict[str, bytes]:
    chosen = [*(folder / "figures").rglob("*"), *(folder / "runs").rglob("*"), folder / "gates.csv"]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in chosen if path.is_file()}


def test_a_case_runs_once_and_its_files_come_back_byte_for_byte(tmp_path, small, counted, capsys):
    first = report_of(tmp_path)
    second = report_of(tmp_path, name="again")
    assert small.runs == 1 and counted == [models.SAM]
    assert tree_of(tmp_path / "out") == tree_of(tmp_path / "again") and len(tree_of(tmp_path / "out")) == 11
    assert first["solves"] == {"solved": 1, "reused": 0, "cases": 0, "stale": 0, "damaged": 0}
    assert second["solves"] == {"solved": 0, "reused": 1, "cases": 1, "stale": 0, "damaged": 0}
    assert first["gates"] == second["gates"] and second["provenance"]["input_sha256"].keys() == {
        "hertz-sphere.toml"
    }
    pages = [(tmp_path / name / "report.html").read_text(encoding="utf-8") for name in ("out", "again")]
    assert (
        "(from the store" not in pages[0]
        and "Code and scenes" not in pages[0]
        and "1 solved, 0 taken" in pages[0]
    )
    assert "0 solved, 1 taken from the store" in pages[1] and "(from the store: 20" in pages[1]
    assert "Code and scenes unchanged" in pages[1]
    assert (
        "0 solved, 1 taken from the store; cases not run again, code and scenes unchanged: 1"
        in capsys.readouterr().out
    )
    assert report_of(tmp_path, level="full")["solves"]["cases"] == 0  # another level is another outcome
    assert small.runs == 2 and counted == [models.SAM]


def test_gates_of_a_reused_case_are_judged_anew(tmp_path, small, monkeypatch):
    report_of(tmp_path)
    monkeypatch.setattr(verify, "load_gates", lambda: load_gates(GATES.format(0.001)))
    assert report_of(tmp_path, code=1)["gates"][0]["status"] == "failed" and small.runs == 1


def test_a_case_of_other_code_runs_again_on_stored_results(tmp_path, small, counted, monkeypatch):
    report_of(tmp_path)
    monkeypatch.setattr(outcomes, "version_of_cases", lambda: "f" * 64)
    assert report_of(tmp_path)["solves"] == {"solved": 0, "reused": 1, "cases": 0, "stale": 1, "damaged": 0}
    assert small.runs == 2 and counted == [models.SAM]


def test_a_case_of_another_scene_runs_again(tmp_path, small, monkeypatch):
    report_of(tmp_path)
    monkeypatch.setattr(outcomes, "_scene", lambda name: b"title")
    assert report_of(tmp_path)["solves"]["stale"] == 1 and small.runs == 2


def test_a_damaged_outcome_is_run_again_and_said(tmp_path, small, capsys):
    report_of(tmp_path)
    (entry,) = [entry for entry in Store(tmp_path / "store").entries() if entry.kind == "outcome"]
    assert entry.what == "small, quick" and entry.state == "current"
    flipped(entry.path, entry.size // 2)
    assert report_of(tmp_path)["solves"]["damaged"] == 1 and small.runs == 2
    assert "small: damaged: " in capsys.readouterr().err
    assert report_of(tmp_path)["solves"]["cases"] == 1


def test_a_case_that_broke_off_or_measures_anew_is_not_kept(tmp_path, small, counted):
    small.problem = "no"
    report_of(tmp_path, code=1)
    small.problem, small.fresh = "", True
    for _ in range(2):
        report_of(tmp_path)
    assert small.runs == 3 and counted == [models.SAM] * 3


def test_without_a_store_every_case_runs(tmp_path, small, counted):
    for _ in range(2):
        assert verify.main([], "quick", tmp_path / "out") == 0
    assert small.runs == 2 and counted == [models.SAM] * 2


def test_a_page_of_results_that_say_nothing_of_a_store(tmp_path, small):
    results = report_of(tmp_path)
    del results["solves"]
    for case in results["cases"]:
        del case["reused"], case["sources"]
    assert "from the store" not in render(results, tmp_path / "out")


def test_the_scene_kept_is_the_resolved_one(kept, scene):
    _, values = read_archive(kept.entries()[0].path)
    assert values["identity"]["scene"] == {
        key: value for key, value in resolved(scene).items() if key not in ("title", "compare")
    }
