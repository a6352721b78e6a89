# SPDX-License-Identifier: MIT
"""A solve that was stopped and continued gives the same bytes, in Python and by --resume; another
checkpoint is refused by name.
"""

import json
import os
import signal
import threading
import time
from copy import deepcopy
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from builders import HARDENING, PERFECT, RUN_IN_STEEL, SPHERE, SWIFT, running_in, scene, scene_text
from plastic_start import shrink_first_box

from sam.plasticity import history, load_step as plastic_step
from sam.scene import HeightMap, Scene
from sam.scene.checkpoint import Checkpoint
from samfem.cli import main
from verification.runs import checkpoints, files, models
from verification.runs.archive import read_archive, write_archive
from verification.runs.files import CHECKPOINT, write_run
from verification.runs.models import FEM, FEM_3D, SAM

COUNTERS = (
    "contact_iterations",
    "plastic_iterations",
    "operator_applications",
    "displacement_applications",
    "ffts",
    "newton_iterations",
    "step_cuts",
)


class StoppedError(Exception):
    """In place of a kill."""


def sphere(plasticity=SWIFT, counterbody=SPHERE, *, coating=None, solver=None, **loading) -> Scene:
    return scene(
        body={"plasticity": plasticity, "coating": coating},
        counterbody=counterbody,
        loading={"force": 0.171424, "steps": 4, "unload": True, **loading},
        grid={"cells": (17, 17)},
        fem={"cells_per_radius": 4},
        solver=solver,
    )


DISC = {"kind": "self-affine", "sq": 20e-9, "cutoff_long": 16e-6, "cutoff_short": 8e-6, "hurst": 0.8}
DISC |= {"seed": 5, "renew": True}
PARTS = HeightMap(5e-9 * np.random.default_rng(1).standard_normal((72, 24)), (48e-6, 16e-6))
MAP_ON_SPHERE = {"shape": "sphere", "radius": 1e-3, "young": 210e9, "poisson": 0.3}
MAP_ON_SPHERE |= {"surface": {"kind": "file", "path": PARTS, "crop": (16e-6, 16e-6), "renew": True}}
PUNCH = sphere(
    PERFECT, {"shape": "punch", "radius": 1e-5}, force=2.5 * np.pi * 1e-10 * 1e9, steps=3, unload_steps=2
)
"""Its edge yields backwards: unloading takes the steps of the scene."""
PAPER = {"method": "paper", "tolerance": 1e-4}
CHABOCHE = {"modulus": (150e9, 11e9), "recovery": (300.0, 0.0)}


def judged(cells=(13, 11), **tables) -> Scene:
    """A given pressure on a body with back-stresses that strains in each of six cycles."""
    loading = {"prescribed": "hertz", "p0": 3.5e9, "radius": 5e-6, "steps": 1, "unload": True, "cycles": 6}
    return scene(
        body={"plasticity": PERFECT | {"kinematic": CHABOCHE}},
        loading=loading | tables.pop("loading", {}),
        grid={"cells": cells, "extent": (21e-6, 18e-6), "depths": tuple(1.6e-6 * np.arange(7))},
        **{"solver": {"tolerance": 1e-3}, "fem": {"cells_per_radius": 2, "box": 4}} | tables,
    )


TO_AND_FRO = judged(
    loading={"p0": 2.9e9, "cycles": 8, "path": {"start": (-2e-6, 0.0), "end": (2e-6, 0.0), "steps": 1}},
    friction={"coefficient": 0.2, "direction": "alternating"},
)
RUBBED = judged(loading={"cycles": 2}, friction={"coefficient": 0.2}, fem={"cells_per_radius": 2, "box": 3})
FALLING = running_in(
    cycles=2,
    steps=1,
    plasticity=RUN_IN_STEEL | {"layer_thickness": 0.2e-6},
    wear={"strain_limit": 0.002, "strain_limit_layer": 0.004, "roof": "falls", "smoothing_fills": True},
    solver={"method": "paper", "tolerance": 1e-3},
)
FILM = {"thickness": 0.3e-6, "young": 80e9, "poisson": 0.3, "yield_stress": 0.67e9}
MOVED = sphere(path={"start": (-0.7e-6, 0.0), "end": (0.7e-6, 0.0), "steps": 1}, steps=1, cycles=2)
RUN_IN_BACK = RUN_IN_STEEL | {"kinematic": CHABOCHE}


def few_iterations(monkeypatch):
    monkeypatch.setattr(plastic_step, "ITERATIONS", 8)


def longer(monkeypatch):
    few_iterations(monkeypatch)
    monkeypatch.setattr(history, "MOST_CUTS", 0)


def small_first_box(monkeypatch):
    shrink_first_box(monkeypatch, x=2, y=2, less=4, layers=3)


CASES = {
    "SAM, two cycles": (SAM, sphere(cycles=2), None),
    "SAM, cut steps": (SAM, sphere(PERFECT, force=0.0167, steps=1), few_iterations),
    "SAM, longer iteration": (SAM, sphere(PERFECT, force=0.0167, steps=2), longer),
    "SAM, growing box": (SAM, sphere(), small_first_box),
    "SAM, unloading in steps": (SAM, PUNCH, None),
    "SAM, given approach": (SAM, sphere(force=None, approach=0.1e-6), None),
    "SAM, renewed counter-surface": (SAM, running_in(cycles=3, steps=1, counterbody={"surface": DISC}), None),
    "SAM, parts of a map on a sphere": (SAM, running_in(steps=1, counterbody=MAP_ON_SPHERE), None),
    "SAM, judged, growing box": (SAM, judged(), small_first_box),
    "SAM, judged, path and alternating traction": (SAM, TO_AND_FRO, None),
    "SAM, judged, film and wear": (SAM, running_in(cycles=4, steps=1, plasticity=RUN_IN_BACK), None),
    "SAM, judged, paper": (SAM, sphere(cycles=4, steps=1, solver=PAPER | {"verdict": True}), None),
    "SAM, paper, film, a roof falls, the filter fills": (SAM, FALLING, None),
    "FEM, judged": (FEM, judged(), None),
    "FEM, three dimensions, back-stresses": (FEM_3D, RUBBED, None),
    "FEM, coated, the bare contact after it": (FEM, sphere(coating=FILM, steps=2), None),
    "FEM, three dimensions, passes": (FEM_3D, MOVED, None),
    "FEM, cut steps": (FEM, sphere(PERFECT, force=0.0685, steps=2), None),
    "FEM, unloading in steps": (FEM, PUNCH, None),
    "FEM, given approach": (FEM, sphere(force=None, approach=0.1e-6), None),
}


def made_by(scene: Scene, model: str, folder: Path | None = None, *, start=None, stop: int = 0):
    """The result of a solve from `start` on, None where it is stopped after so many checkpoints,
    and these, or the files in a folder that each is written to before the solve goes on.
    """
    made: list = []

    def keep(checkpoint):
        made.append(checkpoint if folder is None else folder / f"{len(made)}.npz")
        if folder is not None:
            write_archive(made[-1], checkpoint.arrays, dict(checkpoint.values))
        if len(made) == stop:
            raise StoppedError

    try:
        return models.solve(scene, model, start=start, checkpoint=keep), made
    except StoppedError:
        return None, made


def read(path: Path, model: str) -> Checkpoint:
    return Checkpoint(model, *read_archive(path))


def state_of(path: Path) -> tuple[dict[str, tuple], str]:
    """All that a checkpoint holds, bit by bit, but for its times and memory."""
    arrays, values = read_archive(path)
    bits = {name: (array.dtype, array.shape, array.tobytes()) for name, array in arrays.items()}
    cost = {name: value for name, value in values["cost"].items() if name in COUNTERS}
    return bits, json.dumps(values | {"cost": cost}, sort_keys=True)


def contents(result, scene: Scene, folder: Path) -> dict[str, bytes]:
    """Every file of the run, with what of summary.json must not depend on an interruption."""
    write_run(result, scene, folder, {})
    files = {path.name: path.read_bytes() for path in folder.iterdir()}
    summary = json.loads(files["summary.json"])
    summary["cost"] = {name: summary["cost"][name] for name in COUNTERS}
    return files | {"summary.json": json.dumps(summary).encode()}


@pytest.mark.parametrize("name", CASES)
def test_a_solve_continued_from_any_checkpoint_gives_the_same_bytes(name, tmp_path, monkeypatch):
    """From the file of each of its checkpoints in turn: the next checkpoint, bit by bit, is the
    undisturbed run's.

    By induction every continued solve ends like it. From one in the middle and the last one the end itself is
    compared: every file of the run.
    """
    model, scene, change = CASES[name]
    if change is not None:
        change(monkeypatch)
    for folder in (kept := tmp_path / "kept", further := tmp_path / "further"):
        folder.mkdir()
    result, made = made_by(scene, model, kept)
    expected = contents(result, scene, tmp_path / "whole")
    assert {"history.csv", "axis.csv", "line.csv", "plane.csv", "fields.vtu"} <= set(expected)
    assert ("cycles.csv" in expected) == (scene.loading.cycles > 1)
    assert (result.verdict is not None) == ("judged" in name) and result.quantities["peeq_max"] > 0
    assert len(made) >= len(result.tables["history"]["step"])
    is_what_its_name_says(name, result, made)
    for path, following in pairwise(made):
        _, (found,) = made_by(scene, model, further, start=read(path, model), stop=1)
        assert state_of(found) == state_of(following), f"after {path.name}"
    for path in (made[len(made) // 2], made[-1]):
        again = models.solve(scene, model, start=read(path, model))
        assert contents(again, scene, tmp_path / "parts") == expected, f"from {path.name} of {len(made)}"


def is_what_its_name_says(name: str, result, made: list[Path]) -> None:
    """Cuts are pending in a checkpoint; a box grows between steps; unloading takes more than one step."""
    if name == "SAM, cut steps":
        assert any(read_archive(path)[1]["tree"]["cuts"] for path in made)
    if name == "SAM, growing box":
        assert len({read_archive(path)[1]["tree"]["extent"]["layers"] for path in made}) > 1
    if name == "FEM, cut steps":
        assert result.cost["step_cuts"] > 0
    if "the bare contact" in name:
        assert len(made) > len(result.tables["history"]["step"])
    if "unloading in steps" in name:
        history = result.tables["history"]
        assert history["step"] == [1, 2, 3, 4, 5] and history["note"][-1] == ""


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_solve_that_breaks_off_leaves_checkpoints_as_good(model, tmp_path):
    """The callback raises: what it was given before does not change, and no caller's array is written to
    later. Its arrays are numbers in C order: a file gives them back in it, and sums go along the memory.
    """
    scene = sphere()
    expected = contents(models.solve(scene, model), scene, tmp_path / "whole")
    for count in (1, 3):
        start = made_by(scene, model, stop=count)[1][-1]
        for name, array in start.arrays.items():
            assert array.flags.c_contiguous and array.dtype.kind in "fb", name
            array.flags.writeable = False
        assert contents(models.solve(scene, model, start=start), scene, tmp_path / "parts") == expected


def test_times_add_up_over_the_parts():
    start = made_by(sphere(), SAM, stop=2)[1][-1]
    assert start.cost["cpu_s"] > 0 and start.cost["solve_s"] > 0
    long = {"setup_s": 10.0, "solve_s": 20.0, "cpu_s": 30.0, "peak_memory_bytes": 10**15}
    cost = models.solve(sphere(), SAM, start=start.with_cost(long)).cost
    assert 10 < cost["setup_s"] < 15 and 20 < cost["solve_s"] < 25 and 30 < cost["cpu_s"] < 35
    assert cost["peak_memory_bytes"] == 10**15


@pytest.mark.parametrize("model, other", [(SAM, FEM), (FEM, SAM)])
def test_a_checkpoint_of_another_model_is_refused_in_python(model, other):
    start = made_by(sphere(steps=2), other, stop=1)[1][-1]
    with pytest.raises(ValueError, match=f"model {other}, needed is one of {model}"):
        models.solve(sphere(steps=2), model, start=start)


LOADS = "steps = 4\nunload = true\n[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 4\n"
ELASTIC = scene_text(("0.65 N", "0.171424 N"), add=LOADS)
TEXT = ELASTIC.replace("[counterbody]", f"[body.plasticity]\n{HARDENING['swift']}[counterbody]")
OUT = Path("out")
SUMMARY = OUT / "summary.json"


@pytest.fixture
def folder(folder, monkeypatch) -> Path:
    """The current folder, with small.toml; a checkpoint after every step."""
    monkeypatch.setenv(checkpoints.INTERVAL, "0")
    (folder / "small.toml").write_text(TEXT)
    return folder


@pytest.fixture
def solve(folder, samfem):
    """Solves small.toml into the folder out, with options: what is printed (out, err)."""
    return lambda *options, code=0, out=OUT: samfem("solve", "small.toml", "--out", out, *options, code=code)


@pytest.fixture
def interrupt(solve, monkeypatch):
    """Solves and is interrupted after some checkpoints: what is printed on stderr, and the checkpoint."""
    original = checkpoints.Writer.__call__

    def interrupted(count: int, *options: str) -> tuple[str, Path]:
        calls = []

        def call(self, checkpoint):
            original(self, checkpoint)
            calls.append(checkpoint)
            if len(calls) == count:
                raise KeyboardInterrupt

        with monkeypatch.context() as patch:
            patch.setattr(checkpoints.Writer, "__call__", call)
            return solve(*options, code=130).err, OUT / CHECKPOINT

    return interrupted


def csv_files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.glob("*.csv")}


def is_whole(solve, *options: str) -> bool:
    """The tables of the folder out are those of a solve that nothing interrupted."""
    solve(*options, out="whole")
    return csv_files(OUT) == csv_files(Path("whole")) != {}


@pytest.mark.parametrize("model", [SAM, FEM])
def test_interrupt_then_resume_again_and_again(solve, interrupt, model):
    """130 and what to do, twice; then the rest of the steps, the same bytes, and no checkpoint left."""
    of = "--model", model
    said, checkpoint = interrupt(2, *of)
    assert "interrupted: --resume continues from step 3 of 5" in said
    assert list(OUT.iterdir()) == [checkpoint]
    assert "interrupted: --resume continues from step 4 of 5" in interrupt(1, *of, "--resume")[0]
    assert "continued from step 4 of 5" in solve(*of, "--resume").err
    assert is_whole(solve, *of) and not checkpoint.exists()


def test_interrupt_after_the_last_step_then_resume(solve, interrupt, monkeypatch):
    """Nothing is left to be solved; the latest checkpoint is written before its interval has passed."""
    monkeypatch.setenv(checkpoints.INTERVAL, "1e6")
    assert "continues after the last step" in interrupt(5)[0]
    assert "continued after the last of 5 steps" in solve("--resume").err
    assert is_whole(solve)


def test_terminated_is_interrupted(solve, monkeypatch):
    """SIGTERM as SIGINT, and the handler of before is there again."""
    before = signal.getsignal(signal.SIGTERM)

    def call(self, checkpoint):
        self.latest = checkpoint
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)

    monkeypatch.setattr(checkpoints.Writer, "__call__", call)
    assert "--resume continues from step 2 of 5" in solve(code=130).err
    assert signal.getsignal(signal.SIGTERM) is before


def test_outside_the_main_thread_no_handler_is_set(folder):
    """Signal handlers belong to the main thread: a solve in another one does without."""
    codes = []
    thread = threading.Thread(target=lambda: codes.append(main(["solve", "small.toml", "--out", "out"])))
    thread.start()
    thread.join()
    assert codes == [0]


def test_killed_while_the_result_is_written(solve, monkeypatch):
    """The checkpoint outlives everything but summary.json."""
    original = files.write_atomically

    def write(path, content):
        if path.name == "summary.json":
            raise KeyboardInterrupt
        original(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(files, "write_atomically", write)
        assert "--resume continues after the last step" in solve(code=130).err
    assert (OUT / CHECKPOINT).exists() and not SUMMARY.exists()
    before = csv_files(OUT)
    solve("--resume")
    assert csv_files(OUT) == before and not (OUT / CHECKPOINT).exists()


REFUSED = (
    (lambda who: who.update(scene_sha256="0" * 64), "of another scene,"),
    (lambda who: who.update(model=FEM), "of another model,"),
    (lambda who: who.update(code="0" * 64), "of another version of samfem,"),
    (lambda who: who.update(numpy="0.1"), "of another numpy,"),
    (lambda who: who["machine"].update(cpu="abacus"), "of another machine,"),
    (lambda who: who["threads"].update(OMP_NUM_THREADS="7"), "of another number of threads,"),
    (lambda who: who.update(format="samfem checkpoint 0"), "of another format,"),
    (lambda who: who.update(numpy="0.1", scipy="0.1"), "of another numpy, another scipy,"),
)


def test_a_checkpoint_of_something_else_is_refused_by_name(solve, interrupt):
    _, path = interrupt(2)
    arrays, values = read_archive(path)
    for change, words in REFUSED:
        change((changed := deepcopy(values))["identity"])
        write_archive(path, arrays, changed)
        content = path.read_bytes()
        message = solve("--resume", code=2).err
        assert words in message and "cannot be continued" in message
        assert "delete it to start anew, or solve into another folder" in message
        assert message.count("\n") == 1 and str(path) in message
        assert path.read_bytes() == content  # nothing lost


def test_a_damaged_checkpoint_is_said_and_the_solve_starts_anew(solve, interrupt):
    _, path = interrupt(2)
    content = path.read_bytes()
    half = len(content) // 2
    write_archive(path, {"a": np.zeros(3)}, {"b": 1})
    flipped = content[:half] + bytes([content[half] ^ 1]) + content[half + 1 :]
    for damaged in (path.read_bytes(), content[:half], flipped, b"", b"not an archive"):
        path.write_bytes(damaged)
        message, _ = interrupt(1, "--resume")
        assert str(path) in message and "solved from the beginning" in message
    solve("--resume")
    assert is_whole(solve) and not path.exists()


def test_resume_of_a_finished_folder_solves_nothing_and_keeps_its_exit_code(folder, solve, monkeypatch):
    coarse = TEXT.replace("cells = [17, 17]", 'cells = [17, 17]\nlayers = 6\ndepth = "2.5 um"')
    for text, code in ((coarse, 1), (TEXT, 0)):
        (folder / "small.toml").write_text(text)
        first = solve(code=code)
        before = {path: path.stat().st_mtime_ns for path in OUT.iterdir()}
        with monkeypatch.context() as patch:
            patch.setattr(models, "solve", lambda *_, **__: pytest.fail("solved"))
            shown = solve("--resume", code=code)
        assert "already finished" in shown.err and shown.out == first.out
        assert not code or first.err.splitlines()[-1] in shown.err
        assert {path: path.stat().st_mtime_ns for path in OUT.iterdir()} == before
    (folder / "small.toml").write_text(TEXT.replace("steps = 4", "steps = 3"))  # not finished
    assert "no checkpoint in out: solved from the beginning" in solve("--resume").err


def test_an_older_result_stays_until_a_newer_solve_is_finished(solve, interrupt):
    """Interrupted while it solves the scene of a finished folder again."""
    solve()
    summary = SUMMARY.read_bytes()
    interrupt(2)
    assert SUMMARY.read_bytes() == summary
    assert "continued from step 3 of 5" in solve("--resume").err


def test_a_checkpoint_left_beside_its_result_does_not_count(solve, interrupt):
    """Killed after summary.json and before the checkpoint is removed, or while that was written."""
    _, path = interrupt(2)
    content = path.read_bytes()
    solve("--resume")
    for left in (content, content[:100]):
        path.write_bytes(left)
        assert "already finished" in solve("--resume").err


def test_without_resume_a_checkpoint_is_said_and_replaced(solve, interrupt):
    _, path = interrupt(2)
    said = "a checkpoint of an interrupted run is in out, and is replaced; --resume continues it"
    assert said in solve().err
    assert not path.exists()


def test_without_a_checkpoint_it_starts_and_says_so(folder, solve):
    (folder / "small.toml").write_text(ELASTIC)
    assert "an elastic scene has no checkpoint: solved from the beginning" in solve("--resume").err


def test_a_checkpoint_that_cannot_be_written_does_not_end_the_solve(solve, monkeypatch):
    """A full disk, in place of which here the writing fails: said once, and the result is there."""

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoints, "write_archive", full)
    said = "cannot be written (No space left on device): the solve goes on without it"
    assert solve().err.count(said) == 1


@pytest.mark.parametrize("text", ["soon", "-1", "nan", "inf"])
def test_an_interval_that_is_no_number_of_seconds_is_refused(solve, monkeypatch, text):
    monkeypatch.setenv(checkpoints.INTERVAL, text)
    assert f"SAMFEM_CHECKPOINT_S = {text}: a number of seconds >= 0 is needed" in solve(code=2).err
    assert not OUT.exists()
