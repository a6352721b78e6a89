# SPDX-License-Identifier: MIT
"""A solve that was stopped and continued gives the same bytes; a checkpoint of anything else is refused by
name.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from plastic_start import shrink_first_box
from small_patch import running_in

from sam.plasticity import step as plastic_step
from sam.scene import Body, CounterBody, Fem, Grid, Loading, Plasticity, Scene, Solver
from sam.scene.checkpoint import Checkpoint
from verification.app.cli import main
from verification.runs import checkpoints, models
from verification.runs.archive import read_archive, write_archive
from verification.runs.files import CHECKPOINT, FolderError, check_target, write_run
from verification.runs.models import FEM, SAM

ROOT = Path(__file__).resolve().parents[2]
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
PERFECT = {"law": "perfect", "yield_stress": 1e9}
COUNTERS = (
    *(
        "contact_iterations",
        "plastic_iterations",
        "operator_applications",
        "displacement_applications",
        "ffts",
    ),
    *("newton_iterations", "step_cuts"),
)
TEXT = """title = "Small"
[body]
young = "210 GPa"
poisson = 0.3
[body.plasticity]
law = "swift"
B = "945 MPa"
C = 20
n = 0.121
[counterbody]
shape = "sphere"
radius = "105 um"
[loading]
force = "0.171424 N"
steps = 4
unload = true
[grid]
cells = [17, 17]
[fem]
cells_per_radius = 4
"""


class StoppedError(Exception):
    """In place of a kill."""


def sphere(plasticity=SWIFT, force=0.171424, solver=None, **loading) -> Scene:
    return Scene(
        body=Body(young=210e9, poisson=0.3, plasticity=Plasticity(**plasticity)),
        counterbody=CounterBody(shape="sphere", radius=105e-6),
        loading=Loading(**({"force": force, "steps": 4, "unload": True} | loading)),
        grid=Grid(cells=(17, 17)),
        fem=Fem(cells_per_radius=4),
        solver=solver or Solver(),
    )


def punch() -> Scene:
    """Its edge yields backwards: unloading takes the steps of the scene."""
    loading = {"force": 2.5 * np.pi * 1e-10 * 1e9, "steps": 3, "unload_steps": 2}
    return sphere(PERFECT, **loading).model_copy(
        update={"counterbody": CounterBody(shape="punch", radius=1e-5)}
    )


def few_iterations(monkeypatch):
    monkeypatch.setattr(plastic_step, "ITERATIONS", 8)


def small_first_box(monkeypatch):
    shrink_first_box(monkeypatch, x=2, y=2, less=4, layers=3)


CASES = {
    "SAM, two cycles": (SAM, sphere(cycles=2), None),
    "SAM, cut steps": (SAM, sphere(PERFECT, force=0.0167, steps=1), few_iterations),
    "SAM, growing box": (SAM, sphere(), small_first_box),
    "SAM, unloading in steps": (SAM, punch(), None),
    "SAM, running-in": (SAM, running_in(cycles=3), None),
    "SAM, paper": (SAM, sphere(steps=2, solver=Solver(method="paper", tolerance=1e-4)), None),
    "FEM, two cycles": (FEM, sphere(cycles=2), None),
    "FEM, cut steps": (FEM, sphere(PERFECT, force=0.0685, steps=2), None),
    "FEM, unloading in steps": (FEM, punch(), None),
}


def every_checkpoint(scene: Scene, model: str) -> tuple[object, list[Checkpoint]]:
    """The result of an undisturbed solve, and its checkpoints."""
    made: list[Checkpoint] = []
    return models.solve(scene, model, checkpoint=made.append), made


def stopped(scene: Scene, model: str, count: int) -> Checkpoint:
    """The last checkpoint of a solve that is stopped when it has made `count`."""
    made = []

    def keep(checkpoint):
        made.append(checkpoint)
        if len(made) == count:
            raise StoppedError

    with pytest.raises(StoppedError):
        models.solve(scene, model, checkpoint=keep)
    return made[-1]


def written(scene: Scene, model: str, folder: Path) -> tuple[object, list[Path]]:
    """The result of an undisturbed solve, and files with its checkpoints, each written before the solve goes
    on.
    """
    paths: list[Path] = []

    def keep(checkpoint):
        paths.append(folder / f"{len(paths)}.npz")
        write_archive(paths[-1], checkpoint.arrays, dict(checkpoint.values))

    return models.solve(scene, model, checkpoint=keep), paths


def next_of(scene: Scene, model: str, start: Path, folder: Path) -> Path:
    """The file of the next checkpoint of a solve that is continued from a file, and stopped then."""
    path = folder / "next.npz"

    def keep(checkpoint):
        write_archive(path, checkpoint.arrays, dict(checkpoint.values))
        raise StoppedError

    with pytest.raises(StoppedError):
        models.solve(scene, model, start=Checkpoint(model, *read_archive(start)), checkpoint=keep)
    return path


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
    """From the file of each of its checkpoints in turn: the next checkpoint, bit by bit, is the undisturbed
    run's.

    By induction every continued solve ends like it. From the first, a middle and the last one, the end itself
    is compared: every file of the run.
    """
    model, scene, change = CASES[name]
    if change is not None:
        change(monkeypatch)
    result, made = written(scene, model, tmp_path)
    expected = contents(result, scene, tmp_path / "whole")
    assert {"history.csv", "axis.csv", "line.csv", "plane.csv", "fields.vtu"} <= set(expected)
    assert ("cycles.csv" in expected) == (scene.loading.cycles > 1)
    assert len(made) >= len(result.tables["history"]["step"])
    for path, following in pairwise(made):
        assert state_of(next_of(scene, model, path, tmp_path)) == state_of(following), f"after {path.name}"
    for path in (made[0], made[len(made) // 2], made[-1]):
        again = models.solve(scene, model, start=Checkpoint(model, *read_archive(path)))
        assert contents(again, scene, tmp_path / "parts") == expected, f"from {path.name} of {len(made)}"


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_solve_that_breaks_off_leaves_checkpoints_as_good(model, tmp_path):
    """The callback raises: what it was given before does not change, and no caller's array is written to
    later.
    """
    scene = sphere()
    expected = contents(models.solve(scene, model), scene, tmp_path / "whole")
    for count in (1, 3):
        start = stopped(scene, model, count)
        for array in start.arrays.values():
            array.flags.writeable = False
        assert contents(models.solve(scene, model, start=start), scene, tmp_path / "parts") == expected


def test_the_cases_are_what_their_names_say(monkeypatch):
    """Cuts are pending in a checkpoint; a box grows between steps; unloading takes more than one step."""
    model, scene, change = CASES["SAM, cut steps"]
    with monkeypatch.context() as patch:
        change(patch)
        _, made = every_checkpoint(scene, model)
    assert any(one.values["tree"]["cuts"] for one in made)
    model, scene, change = CASES["SAM, growing box"]
    with monkeypatch.context() as patch:
        change(patch)
        _, made = every_checkpoint(scene, model)
    assert len({one.values["tree"]["extent"]["layers"] for one in made}) > 1
    assert models.solve(CASES["FEM, cut steps"][1], FEM).cost["step_cuts"] > 0


@pytest.mark.parametrize("name", ["SAM, unloading in steps", "FEM, unloading in steps"])
def test_the_punch_is_unloaded_in_more_than_one_step(name):
    model, scene, _ = CASES[name]
    history = models.solve(scene, model).tables["history"]
    assert history["step"] == [1, 2, 3, 4, 5] and history["note"][-1] == ""


@pytest.mark.parametrize(
    "model, changed", [(SAM, "state.material.strain"), (FEM, "steps.1.state.history.plastic_strain")]
)
def test_a_perturbed_checkpoint_gives_other_bytes(model, changed, tmp_path):
    """The comparison can fail: one part in 1e12 of the plastic strain, or one counter, shows."""
    scene = sphere()
    expected = contents(models.solve(scene, model), scene, tmp_path / "whole")
    start = stopped(scene, model, 2)
    strain = replace(start, arrays={**start.arrays, changed: start.arrays[changed] * (1 + 1e-12)})
    found = contents(models.solve(scene, model, start=strain), scene, tmp_path / "strain")
    assert found["plane.csv"] != expected["plane.csv"]
    tree = json.loads(json.dumps(start.values["tree"]))
    if model == SAM:
        tree["counters"]["ffts"] += 1
    else:
        tree["steps"][0]["work"]["newton"] += 1
    count = replace(start, values={**start.values, "tree": tree})
    found = contents(models.solve(scene, model, start=count), scene, tmp_path / "count")
    assert found["summary.json"] != expected["summary.json"]


@pytest.mark.parametrize("model", [SAM, FEM])
def test_arrays_of_a_checkpoint_are_in_the_order_that_a_file_keeps(model):
    """Numbers in C order: a file gives them back in it, and sums go along the memory."""
    for made in every_checkpoint(sphere(cycles=2), model)[1]:
        assert made.arrays
        for name, array in made.arrays.items():
            assert array.flags.c_contiguous and array.dtype.kind in "fb", name


def test_equal_arrays_are_stored_once():
    """Residual stress of the state and of the last step are one object, before and after."""
    made = every_checkpoint(sphere(), SAM)[1][1]
    assert "state.residual.stress" in made.arrays and "last.residual.stress" not in made.arrays
    tree = made.tree()
    assert tree["last"]["residual"]["stress"] is tree["state"]["residual"]["stress"]


def test_times_add_up_over_the_parts():
    start = stopped(sphere(), SAM, 2)
    assert start.cost["cpu_s"] > 0 and start.cost["solve_s"] > 0
    long = {"setup_s": 10.0, "solve_s": 20.0, "cpu_s": 30.0, "peak_memory_bytes": 10**15}
    cost = models.solve(sphere(), SAM, start=start.with_cost(long)).cost
    assert 10 < cost["setup_s"] < 15 and 20 < cost["solve_s"] < 25 and 30 < cost["cpu_s"] < 35
    assert cost["peak_memory_bytes"] == 10**15


@pytest.mark.parametrize("model, other", [(SAM, FEM), (FEM, SAM)])
def test_a_checkpoint_of_another_model_is_refused_in_python(model, other):
    start = stopped(sphere(steps=2), other, 1)
    with pytest.raises(ValueError, match=f"model {other}, needed is one of {model}"):
        models.solve(sphere(steps=2), model, start=start)


# the command


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """The current folder, with small.toml; a checkpoint after every step, and no store."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(checkpoints.INTERVAL, "0")
    monkeypatch.setenv("SAMFEM_STORE", "")
    (tmp_path / "small.toml").write_text(TEXT)
    return tmp_path


def interrupt(monkeypatch, count: int) -> None:
    """Let the next solve be interrupted after `count` checkpoints."""
    calls, original = [], checkpoints.Writer.__call__

    def call(self, checkpoint):
        original(self, checkpoint)
        calls.append(checkpoint)
        if len(calls) == count:
            raise KeyboardInterrupt

    monkeypatch.setattr(checkpoints.Writer, "__call__", call)


def csv_files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.glob("*.csv")}


def test_interrupt_then_resume(folder, capsys, monkeypatch):
    """130 and what to do; then the rest of the steps, the same bytes, and no checkpoint left."""
    assert main(["solve", "small.toml", "--out", "whole"]) == 0
    with monkeypatch.context() as patch:
        interrupt(patch, 2)
        assert main(["solve", "small.toml", "--out", "out"]) == 130
    assert "interrupted: --resume continues from step 3 of 5" in capsys.readouterr().err
    assert [path.name for path in (folder / "out").iterdir()] == [CHECKPOINT]
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "continued from step 3 of 5" in capsys.readouterr().err
    assert csv_files(folder / "out") == csv_files(folder / "whole")
    assert not (folder / "out" / CHECKPOINT).exists()


def test_interrupt_after_the_last_step_then_resume(folder, capsys, monkeypatch):
    """Between the last step and the files of the result nothing is left to be solved."""
    assert main(["solve", "small.toml", "--out", "whole"]) == 0
    with monkeypatch.context() as patch:
        interrupt(patch, 5)
        assert main(["solve", "small.toml", "--out", "out"]) == 130
    capsys.readouterr()
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "continued after the last of 5 steps" in capsys.readouterr().err
    assert csv_files(folder / "out") == csv_files(folder / "whole")


def test_interrupt_writes_the_latest_checkpoint(folder, capsys, monkeypatch):
    """Also if the interval has not passed."""
    monkeypatch.setenv(checkpoints.INTERVAL, "1e6")
    with monkeypatch.context() as patch:
        interrupt(patch, 3)
        assert main(["solve", "small.toml", "--out", "out"]) == 130
    assert "step 4 of 5" in capsys.readouterr().err
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "continued from step 4 of 5" in capsys.readouterr().err


def test_terminated_is_interrupted(folder, capsys, monkeypatch):
    """SIGTERM as SIGINT, and the handler of before is there again."""
    before = signal.getsignal(signal.SIGTERM)

    def call(self, checkpoint):
        self.latest = checkpoint
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)

    monkeypatch.setattr(checkpoints.Writer, "__call__", call)
    assert main(["solve", "small.toml", "--out", "out"]) == 130
    assert "--resume continues from step 2 of 5" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGTERM) is before


def test_outside_the_main_thread_no_handler_is_set(folder):
    """Signal handlers belong to the main thread: a solve in another one does without."""
    codes = []
    thread = threading.Thread(target=lambda: codes.append(main(["solve", "small.toml", "--out", "out"])))
    thread.start()
    thread.join()
    assert codes == [0]


def test_killed_then_resumed(folder):
    """kill -9 of a real process, right after its second checkpoint: only that is left, and the rest gives the
    same bytes.
    """
    program = (
        "import os, signal, sys\nfrom verification.app import cli\nfrom verification.runs import checkpoints\n"
        "class Killed(checkpoints.Writer):\n"
        "    def write(self):\n        super().write()\n"
        "        if self.written is not None and self.written.done == 2: os.kill(os.getpid(), signal.SIGKILL)\n"
        "checkpoints.Writer = Killed\nsys.exit(cli.main(['solve', 'small.toml', '--out', 'out']))\n"
    )
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, env=environment, check=False)
    assert done.returncode == -signal.SIGKILL
    assert [path.name for path in (folder / "out").iterdir()] == [CHECKPOINT]
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert main(["solve", "small.toml", "--out", "whole"]) == 0
    assert csv_files(folder / "out") == csv_files(folder / "whole")


@pytest.mark.parametrize("model", [SAM, FEM])
def test_interrupted_again_and_again(folder, capsys, monkeypatch, model):
    """One step at a time, each in a solve of its own."""
    options = ["--model", model, "--out", "out"]
    for step in range(1, 5):
        with monkeypatch.context() as patch:
            interrupt(patch, 1)
            assert main(["solve", "small.toml", *options, "--resume"]) == 130
        assert f"continues from step {step + 1} of 5" in capsys.readouterr().err
    assert main(["solve", "small.toml", *options, "--resume"]) == 0
    assert main(["solve", "small.toml", "--model", model, "--out", "whole"]) == 0
    assert csv_files(folder / "out") == csv_files(folder / "whole")


def test_killed_while_the_result_is_written(folder, capsys, monkeypatch):
    """The checkpoint outlives everything but summary.json."""
    import verification.runs.files as files

    original = files.write_atomically

    def write(path, content):
        if path.name == "summary.json":
            raise KeyboardInterrupt
        original(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(files, "write_atomically", write)
        assert main(["solve", "small.toml", "--out", "out"]) == 130
    assert "--resume continues after the last step" in capsys.readouterr().err
    assert (folder / "out" / CHECKPOINT).exists() and not (folder / "out" / "summary.json").exists()
    before = csv_files(folder / "out")
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert csv_files(folder / "out") == before and not (folder / "out" / CHECKPOINT).exists()


def leave_a_checkpoint(monkeypatch, *options: str) -> Path:
    """An interrupted solve in the folder out."""
    with monkeypatch.context() as patch:
        interrupt(patch, 2)
        assert main(["solve", "small.toml", "--out", "out", *options]) == 130
    return Path("out") / CHECKPOINT


def edited(path: Path, change) -> None:
    """The checkpoint with its identity changed."""
    arrays, values = read_archive(path)
    change(values["identity"])
    write_archive(path, arrays, values)


REFUSED = {
    "scene": (lambda who: who.update(scene_sha256="0" * 64), "of another scene,"),
    "model": (lambda who: who.update(model=FEM), "of another model,"),
    "code": (lambda who: who.update(code="0" * 64), "of another version of samfem,"),
    "numpy": (lambda who: who.update(numpy="0.1"), "of another numpy,"),
    "machine": (lambda who: who["machine"].update(cpu="abacus"), "of another machine,"),
    "threads": (lambda who: who["threads"].update(OMP_NUM_THREADS="7"), "of another number of threads,"),
    "format": (lambda who: who.update(format="samfem checkpoint 0"), "of another format,"),
    "two": (lambda who: who.update(numpy="0.1", scipy="0.1"), "of another numpy, another scipy,"),
}


@pytest.mark.parametrize("change, words", REFUSED.values(), ids=REFUSED.keys())
def test_a_checkpoint_of_something_else_is_refused_by_name(folder, capsys, monkeypatch, change, words):
    path = leave_a_checkpoint(monkeypatch)
    edited(path, change)
    content = path.read_bytes()
    capsys.readouterr()
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 2
    message = capsys.readouterr().err
    assert words in message and "delete it to start anew, or solve into another folder" in message
    assert message.count("\n") == 1 and str(path) in message
    assert path.read_bytes() == content  # nothing lost


def test_another_scene_is_refused(folder, capsys, monkeypatch):
    """Through the command: the force was changed in between."""
    leave_a_checkpoint(monkeypatch)
    (folder / "small.toml").write_text(TEXT.replace("0.171424", "0.171425"))
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 2
    assert "of another scene, and cannot be continued" in capsys.readouterr().err


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "text", "other"])
def test_a_damaged_checkpoint_is_said_and_the_solve_starts_anew(folder, capsys, monkeypatch, damage):
    path = leave_a_checkpoint(monkeypatch)
    content = path.read_bytes()
    middle = len(content) // 2
    if damage == "other":
        write_archive(path, {"a": np.zeros(3)}, {"b": 1})
    else:
        path.write_bytes(
            {
                "cut": content[:middle],
                "flipped": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
                "empty": b"",
                "text": b"not an archive",
            }[damage]
        )
    capsys.readouterr()
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    message = capsys.readouterr().err
    assert str(path) in message and "solved from the beginning" in message
    assert not path.exists()


def test_resume_of_a_finished_folder_solves_nothing(folder, capsys, monkeypatch):
    assert main(["solve", "small.toml", "--out", "out"]) == 0
    before = {path: path.stat().st_mtime_ns for path in (folder / "out").iterdir()}
    table = capsys.readouterr().out
    monkeypatch.setattr(models, "solve", lambda *_, **__: pytest.fail("solved"))
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    shown = capsys.readouterr()
    assert "already finished" in shown.err and shown.out == table
    assert {path: path.stat().st_mtime_ns for path in (folder / "out").iterdir()} == before


def test_resume_of_a_finished_folder_keeps_its_exit_code(folder, capsys, monkeypatch):
    (folder / "small.toml").write_text(
        TEXT.replace("cells = [17, 17]", 'cells = [17, 17]\nlayers = 6\ndepth = "2.5 um"')
    )
    assert main(["solve", "small.toml", "--out", "out"]) == 1
    first = capsys.readouterr().err
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 1
    assert first.splitlines()[-1] in capsys.readouterr().err


def test_a_result_of_another_scene_is_not_finished(folder, capsys):
    assert main(["solve", "small.toml", "--out", "out"]) == 0
    (folder / "small.toml").write_text(TEXT.replace("steps = 4", "steps = 3"))
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "no checkpoint in out: solved from the beginning" in capsys.readouterr().err


def test_an_older_result_stays_until_a_newer_solve_is_finished(folder, capsys, monkeypatch):
    """Interrupted while it solves the scene of a finished folder again: the result is there, and --resume
    finishes.
    """
    assert main(["solve", "small.toml", "--out", "out"]) == 0
    summary = (folder / "out" / "summary.json").read_bytes()
    leave_a_checkpoint(monkeypatch)
    assert (folder / "out" / "summary.json").read_bytes() == summary
    capsys.readouterr()
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "continued from step 3 of 5" in capsys.readouterr().err


def test_a_checkpoint_left_beside_its_result_does_not_count(folder, capsys, monkeypatch):
    """Killed after summary.json and before the checkpoint is removed."""
    path = leave_a_checkpoint(monkeypatch)
    content = path.read_bytes()
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    path.write_bytes(content)
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "already finished" in capsys.readouterr().err


def test_without_resume_a_checkpoint_is_said_and_replaced(folder, capsys, monkeypatch):
    leave_a_checkpoint(monkeypatch)
    capsys.readouterr()
    assert main(["solve", "small.toml", "--out", "out"]) == 0
    assert (
        "a checkpoint of an interrupted run is in out, and is replaced; --resume continues it"
        in capsys.readouterr().err
    )
    assert not (folder / "out" / CHECKPOINT).exists()


def test_without_a_checkpoint_it_starts_and_says_so(folder, capsys):
    assert main(["solve", "small.toml", "--out", "out", "--resume"]) == 0
    assert "no checkpoint in out: solved from the beginning" in capsys.readouterr().err
    elastic = "".join(
        line for line in TEXT.splitlines(True) if line.split(" ")[0] not in ("law", "B", "C", "n")
    )
    (folder / "small.toml").write_text(elastic.replace("[body.plasticity]\n", ""))
    assert main(["solve", "small.toml", "--out", "elastic", "--resume"]) == 0
    assert "an elastic scene has no checkpoint: solved from the beginning" in capsys.readouterr().err


def test_a_checkpoint_that_cannot_be_written_does_not_end_the_solve(folder, capsys, monkeypatch):
    """A full disk, in place of which here the writing fails: said once, and the result is there."""

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoints, "write_archive", full)
    assert main(["solve", "small.toml", "--out", "out"]) == 0
    message = capsys.readouterr().err
    assert message.count("cannot be written (No space left on device): the solve goes on without it") == 1


@pytest.mark.parametrize("text", ["soon", "-1", "nan", "inf"])
def test_an_interval_that_is_no_number_of_seconds_is_refused(folder, capsys, monkeypatch, text):
    monkeypatch.setenv(checkpoints.INTERVAL, text)
    assert main(["solve", "small.toml", "--out", "out"]) == 2
    assert f"SAMFEM_CHECKPOINT_S = {text}: a number of seconds >= 0 is needed" in capsys.readouterr().err
    assert not (folder / "out").exists()


def test_writing_takes_a_small_share_of_the_time(tmp_path, monkeypatch):
    """One that takes 1 s is followed by the next after 50 s; a fast one after the interval."""
    clock = [0.0]
    monkeypatch.setattr(checkpoints.time, "monotonic", lambda: clock[0])
    for duration, pause in ((1.0, 50.0), (0.01, 5.0)):
        times = []

        def write(*_, duration=duration, times=times):
            times.append(clock[0])
            clock[0] += duration

        monkeypatch.setattr(checkpoints, "write_archive", write)
        writer = checkpoints.Writer(tmp_path, {}, 5.0, None, pytest.fail)
        for k in range(2000):
            clock[0] += 0.1
            writer(Checkpoint(SAM, {}, {"done": k, "total": 2000}))
        gaps = np.diff(times) - duration
        assert gaps.size and gaps.min() >= pause - 1e-6 and gaps.max() < pause + 0.2


def test_a_folder_with_a_checkpoint_alone_is_the_folder_of_a_run(tmp_path):
    (tmp_path / CHECKPOINT).write_bytes(b"")
    check_target(tmp_path)
    (tmp_path / "thesis.doc").write_bytes(b"")
    with pytest.raises(FolderError, match=r"thesis\.doc"):
        check_target(tmp_path)
