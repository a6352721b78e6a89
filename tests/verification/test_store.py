# SPDX-License-Identifier: MIT
"""The store: bit for bit what was computed, nothing that is stale, damaged, another's or half-written."""

import errno
import json
import multiprocessing
import os
import shutil
import signal
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from builders import PERFECT, SPHERE, STEEL, scene_text
from stored import BOTH, COARSE, COARSE_KEYS, flipped, same

from sam.scene import Scene, Section, Status, load_scene, read_scene, resolved
from verification.runs import checkpoints, models, store
from verification.runs.code_version import OF_CASES, ROOT, code_version, version_of_cases
from verification.runs.files import FolderError, json_text, write_run

# what is stored


@pytest.mark.parametrize("model", BOTH)
def test_a_result_comes_back_with_every_type_and_bit_and_writes_the_same_run(
    kept, coarse_results, model, tmp_path
):
    found = kept.lookup(COARSE, model)
    assert found.note == "" and same(found.result, coarse_results[model])
    assert not same(replace(found.result, message="x"), coarse_results[model])
    assert found.result.status is Status.CONVERGED and found.created
    for name, result in (("own", coarse_results[model]), ("stored", found.result)):
        write_run(result, COARSE, tmp_path / name, {})
    folders = (tmp_path / name for name in ("own", "stored"))
    own, stored = ({entry.name: entry.read_bytes() for entry in folder.iterdir()} for folder in folders)
    assert len(own) >= 6 and own == stored


# what it is found by


def test_the_title_is_no_part_of_the_key_and_everything_else_is(kept):
    assert kept.lookup(COARSE.model_copy(update={"title": "another"}), models.SAM).result is not None
    heavier = COARSE.loading.model_copy(update={"force": np.nextafter(COARSE.loading.force, 1)})
    assert kept.lookup(COARSE.model_copy(update={"loading": heavier}), models.SAM) == store.Lookup()
    assert store.identity(COARSE, models.SAM) != store.identity(COARSE, models.FEM)


PRAGER = {"plasticity": PERFECT | {"kinematic": {"modulus": (1e10,)}}}
KINEMATIC = Scene(body=STEEL | PRAGER, counterbody=SPHERE, loading={"force": 1.0})
IDENTITIES = {
    "running-in-renewed": "4e3c476a4c31",
    "coated-sliding": "85e03c37e064",
    "moving-sphere": "1d7bf50ab570",
    "misfit-sphere": "2253d87340a5",
    "rounded-punch": "449f4b4d97e7",
    KINEMATIC: "297a0d593882",
}
"""Scenes that have every table together, and the keys under which the store knew them before any key was left
unwritten. Only a change of their own files, or of a default, may change one; of a new key see `unwritten` of
`sam.scene.Section`.
"""


@pytest.mark.parametrize("name", IDENTITIES)
def test_a_key_at_its_default_changes_no_identity_and_no_byte(name):
    """Neither one that is new nor one that is written out, in the store, in checkpoints, in summary.json."""
    scene = load_scene(ROOT / f"verification/scenes/{name}.toml") if isinstance(name, str) else name
    assert store._key(store.identity(scene, models.SAM))[:12] == IDENTITIES[name]
    written = Scene(**_whole(scene))
    assert written == scene and written.model_fields_set == set(Scene.model_fields)
    assert json_text(resolved(written)) == json_text(resolved(scene))
    assert store.identity(written, models.SAM) == store.identity(scene, models.SAM)
    assert checkpoints.identity(written, models.SAM) == checkpoints.identity(scene, models.SAM)
    beyond = scene.model_copy(update={"solver": scene.solver.model_copy(update={"beyond_model": True})})
    assert store.identity(beyond, models.SAM) != store.identity(scene, models.SAM)
    assert resolved(beyond)["solver"]["beyond_model"] is True


def _whole(section):
    """All keys of a section, also those that it leaves unwritten."""
    fields = type(section).model_fields
    values = {field.alias or key: getattr(section, key) for key, field in fields.items()}
    return {key: _whole(value) if isinstance(value, Section) else value for key, value in values.items()}


def test_a_file_that_a_scene_names_counts_by_its_content(tmp_path):
    plastic = '[body.plasticity]\nlaw = "table"\nfile = "{}.csv"\n'
    found = []
    for name, second in (("a", "2e9"), ("b", "2.0e9"), ("c", "2.1e9")):
        (tmp_path / f"{name}.csv").write_text(f"peeq,yield_stress_Pa\n0,1e9\n0.1,{second}\n")
        (tmp_path / f"{name}.toml").write_text(scene_text() + plastic.format(name))
        found.append(store.identity(read_scene(tmp_path / f"{name}.toml")[0], models.SAM))
    assert found[0] == found[1] != found[2]


def test_an_entry_of_other_code_is_stale_and_is_replaced(kept, counted, monkeypatch):
    monkeypatch.setattr(store, "code_version", lambda model: "f" * 64)
    monkeypatch.setattr(store, "unchanged", lambda model: True)
    found = kept.lookup(COARSE, models.SAM)
    assert found.result is None
    assert found.note.startswith(f"stale: computed by code {code_version(models.SAM)[:8]} of 20")
    _, reuse = store.solve_or_reuse(kept, COARSE, models.SAM)
    assert counted == [models.SAM] and not reuse.reused and reuse.text == f"{found.note}: computed again"
    assert kept.lookup(COARSE, models.SAM).result is not None and len(kept.entries()) == 2


def test_a_result_is_solved_once_and_fresh_on_request(tmp_path, counted):
    own, before = store.Store(tmp_path / "deep" / "store"), datetime.now(UTC).replace(microsecond=0)
    reuses = [store.solve_or_reuse(own, COARSE, models.SAM)[1] for _ in range(3)]
    assert counted == [models.SAM] and [reuse.reused for reuse in reuses] == [False, True, True]
    assert all(before <= datetime.fromisoformat(reuse.created) <= datetime.now(UTC) for reuse in reuses)
    assert reuses[1].created == reuses[2].created and "taken from the store: computed 20" in reuses[1].text
    assert not store.solve_or_reuse(own, COARSE, models.SAM, fresh=True)[1].reused
    assert not store.solve_or_reuse(None, COARSE, models.SAM)[1].reused
    assert counted == [models.SAM] * 3


def test_a_result_is_not_kept_if_the_code_changed_meanwhile(tmp_path, coarse_results, monkeypatch, capsys):
    result = coarse_results[models.SAM]
    store.Store(tmp_path).keep(COARSE, models.SAM, replace(result, status=Status.UNDER_RESOLVED))
    assert store.Store(tmp_path).entries() == []  # neither what did not converge
    monkeypatch.setattr(store, "unchanged", lambda model: False)
    store.Store(tmp_path).keep(COARSE, models.SAM, result)
    assert (
        store.Store(tmp_path).entries() == [] and "changed since the command began" in capsys.readouterr().err
    )


# the version of the code


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    root = tmp_path_factory.mktemp("tree")
    for package in (*OF_CASES, "tests"):
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("__pycache__"))
    return root


def versions(root: Path) -> tuple[str, ...]:
    """Of SAM, of FEM, and of the cases."""
    models_ = (code_version.__wrapped__(model, root) for model in BOTH)
    return (*models_, version_of_cases.__wrapped__(root))


@pytest.fixture(scope="module")
def untouched(tree) -> tuple[str, ...]:
    """The versions of the copy, which every test leaves as it was."""
    return versions(tree)


@pytest.mark.parametrize(
    ("path", "changes"),
    [
        ("sam/contact/normal.py", (1, 0, 1)),
        ("sam/scene/yield_curve.py", (1, 1, 1)),
        ("fem_reference/common/plasticity.py", (0, 1, 1)),
        ("verification/runs/models.py", (1, 1, 1)),
        ("verification/cases/case.py", (0, 0, 1)),
        ("verification/data/advice.csv", (0, 0, 1)),
        ("tests/sam/test_wear.py", (0, 0, 0)),
        ("verification/runs/code_version.py", (0, 0, 0)),
        ("verification/cases/hertz/hertz.toml", (0, 0, 0)),
        ("verification/scenes/hertz-sphere.toml", (0, 0, 0)),
    ],
)
def test_one_byte_changes_the_version_of_what_depends_on_it(tree, untouched, path, changes):
    content = (tree / path).read_bytes()
    (tree / path).write_bytes(content[:-1] + b"#")
    after = versions(tree)
    (tree / path).write_bytes(content)
    assert tuple(int(a != b) for a, b in zip(untouched, after, strict=True)) == changes


def test_a_new_file_and_another_numpy_change_the_version_too(tree, untouched, monkeypatch):
    (tree / "sam" / "extra.py").write_text("")
    assert [a != b for a, b in zip(untouched, versions(tree), strict=True)] == [True, False, True]
    (tree / "sam" / "extra.py").unlink()
    monkeypatch.setattr("verification.runs.code_version.installed", lambda package: "0.0")
    assert all(a != b for a, b in zip(untouched, versions(tree), strict=True))


# damage


def test_no_flipped_byte_and_no_shortened_file_gives_another_result(kept, coarse_results):
    (path,) = [entry.path for entry in kept.entries() if entry.what == models.FEM]
    whole = path.read_bytes()
    places = np.random.default_rng(4).integers(0, len(whole), 40)
    damaged = 0
    for place in (0, len(whole) - 1, *places.tolist()):
        flipped(path, place)
        found = kept.lookup(COARSE, models.FEM)
        damaged += found.note.startswith("damaged: ")  # a byte of padding or of a date is none of it
        assert found.result is None or same(found.result, coarse_results[models.FEM])
        path.write_bytes(whole)
    assert damaged > 35
    for length in (0, len(whole) - 1):
        path.write_bytes(whole[:length])
        found = kept.lookup(COARSE, models.FEM)
        assert found.result is None and found.note.startswith("damaged: ") and str(path) in found.note


def test_an_entry_under_another_name_is_damage(kept):
    (sam,), (fem,) = ([entry.path for entry in kept.entries() if entry.what == model] for model in BOTH)
    shutil.copy(fem, sam)
    assert "holds something else than its name says" in kept.lookup(COARSE, models.SAM).note
    assert sorted(entry.state for entry in kept.entries()) == ["current", "damaged"]


# faults and company


def full(*_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("why", ["Not a directory", "No space left on device"])
def test_a_store_that_cannot_be_written_costs_one_warning_and_no_result(
    tmp_path, counted, capsys, monkeypatch, why
):
    own = store.Store(tmp_path / "place" / "store")
    if why == "Not a directory":
        own.folder.parent.write_text("")
    else:
        monkeypatch.setattr(os, "fsync", full)
    for _ in range(2):
        assert store.solve_or_reuse(own, COARSE, models.SAM)[0].converged
    message = capsys.readouterr().err
    assert (
        message.count("\n") == 1
        and f"warning: store {own.folder}: {why}" in message
        and store.FOLDER in message
    )
    assert own.entries() == [] and own.left_over() == []


def test_a_limit_of_coefficients_that_is_no_number_is_refused(monkeypatch):
    monkeypatch.setenv(store.LIMIT, "2 GB")
    with pytest.raises(FolderError, match="SAMFEM_COEFFICIENTS = 2 GB: a number of bytes is needed"):
        store.kept_coefficients()


def _keep_and_die(folder: Path, result) -> None:
    os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)
    store.Store(folder).keep(COARSE, models.SAM, result)


def test_a_killed_process_leaves_a_temporary_file_that_prune_removes(tmp_path, coarse_results):
    how = {"target": _keep_and_die, "args": (tmp_path, coarse_results[models.SAM])}
    process = multiprocessing.get_context("fork").Process(**how)
    process.start()
    process.join(20)
    assert process.exitcode == -signal.SIGKILL
    own = store.Store(tmp_path)
    assert own.entries() == [] and own.lookup(COARSE, models.SAM) == store.Lookup()
    (left,) = own.left_over()
    living = left.with_name(left.name.replace(f".{process.pid}.", f".{os.getpid()}."))
    shutil.copy(left, living)  # of a process that still writes
    (tmp_path / "notes.txt").write_text("not of the store")
    (tmp_path / "results.npz").write_text("neither")
    removed = list(own.prune(lambda entry: True))
    assert len(removed) == 1 and "left over" in removed[0][0] and removed[0][1] > 1e4
    assert {path.name for path in tmp_path.iterdir()} == {living.name, "notes.txt", "results.npz"}


def test_the_folder_of_the_store(monkeypatch, tmp_path):
    monkeypatch.setenv(store.FOLDER, "")
    assert store.default_store() is None
    monkeypatch.setenv(store.FOLDER, str(tmp_path))
    assert store.default_store().folder == tmp_path
    monkeypatch.delenv(store.FOLDER)
    monkeypatch.setenv("HOME", str(tmp_path))
    usual = tmp_path / ".cache"
    for caches, expected in ((str(tmp_path / "c"), tmp_path / "c"), ("", usual), ("c", usual)):
        monkeypatch.setenv("XDG_CACHE_HOME", caches)
        assert store.default_store().folder == expected / "samfem"


# the commands


@pytest.fixture
def folder(folder, monkeypatch):
    """The current folder with coarse.toml, and a store of its own."""
    monkeypatch.setenv(store.FOLDER, str(folder / "store"))
    (folder / "coarse.toml").write_text(scene_text(add=COARSE_KEYS))
    return folder


def test_compare_solves_once_and_what_solve_left_not_at_all(folder, counted, samfem):
    samfem("solve", "coarse.toml", "--model", models.FEM)
    assert counted == [models.FEM]
    said = samfem("compare", "coarse.toml", code=1).err
    assert counted == [models.FEM, models.SAM]
    assert "fem-axisymmetric: taken from the store: computed 20" in said
    first = (folder / "coarse-compare" / "compare.csv").read_bytes()
    samfem("compare", "coarse.toml", code=1)
    assert counted == [models.FEM, models.SAM]
    assert (folder / "coarse-compare" / "compare.csv").read_bytes() == first
    summary = json.loads((folder / "coarse-compare" / "sam" / "summary.json").read_text(encoding="utf-8"))
    assert summary["provenance"]["from_store"]["computed_utc"].startswith("20")
    samfem("solve", "coarse.toml", "--model", models.FEM)
    assert counted == [models.FEM, models.SAM, models.FEM]  # solve always solves
    kept = len(list((folder / "store").iterdir()))
    assert "store" not in samfem("compare", "coarse.toml", "--no-store", code=1).err
    assert counted[3:] == [*BOTH] and len(list((folder / "store").iterdir())) == kept


def test_store_lists_and_prunes(folder, counted, samfem, monkeypatch):
    assert "0 entries" in samfem("store").out
    samfem("compare", "coarse.toml", code=1)
    listed = samfem("store").out
    assert "2 entries (2 current, 0 stale, 0 damaged), 0 left over" in listed and "fem-axisymmetric" in listed
    keys = [path.stem for path in (folder / "store").iterdir()]
    assert all(key[:12] in listed for key in keys)
    assert "0 removed, 0 B freed" in samfem("store", "--prune", "--older-than", "1").out
    flipped(folder / "store" / f"{keys[0]}.npz", 40)
    size = (folder / "store" / f"{keys[0]}.npz").stat().st_size
    said = samfem("store", "--prune").out
    assert f"removed {keys[0][:12]}" in said and "1 removed" in said and f"{size / 1e3:.0f} kB freed" in said
    monkeypatch.setattr(store.Entry, "age_days", 3.0)
    assert "0 removed" in samfem("store", "--prune", "--older-than", "4").out
    assert "1 removed" in samfem("store", "--prune", "--older-than", "2").out
    samfem("compare", "coarse.toml", code=1)
    assert "2 removed" in samfem("store", "--prune", "all").out
    assert list((folder / "store").iterdir()) == []


def test_store_refuses_what_could_be_misread(refused):
    for words in (["--older-than", "3"], ["--prune", "all", "--older-than", "3"], ["--prune", "x"]):
        assert "--" in refused("store", *words)
    for days in ("-1", "nan", "inf", "many"):
        assert "--older-than" in refused("store", "--prune", "--older-than", days)


def test_store_says_when_there_is_none(monkeypatch, samfem):
    monkeypatch.setenv(store.FOLDER, "")
    assert "no store" in samfem("store", "--prune").out
