# SPDX-License-Identifier: MIT
"""--resume of the command continues a solve, or says why it cannot: interrupted, killed, damaged, foreign."""

import os
import signal
import threading
import time
from copy import deepcopy
from pathlib import Path

import numpy as np
import pytest
from builders import scene_text

from samfem.cli import main
from verification.runs import checkpoints, files, models
from verification.runs.archive import read_archive, write_archive
from verification.runs.files import CHECKPOINT
from verification.runs.models import FEM, SAM

PLASTIC = '[body.plasticity]\nlaw = "swift"\nB = "945 MPa"\nC = 20\nn = 0.121\n'
LOADS = "steps = 4\nunload = true\n[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 4\n"
ELASTIC = scene_text(("0.65 N", "0.171424 N"), add=LOADS)
TEXT = ELASTIC.replace("[counterbody]", PLASTIC + "[counterbody]")
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
