# SPDX-License-Identifier: MIT
"""The command from end to end: solve, plan, compare, exit codes, and what it says and writes."""

import hashlib
import io
import json
import math
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import pytest
from builders import HARDENING, MODULUS, RADIUS, parsed, scene_text

import fem_reference.axisymmetric.planner
import sam
from sam.half_space import circular_contact_radius
from sam.planner import bodies, make
from sam.scene import LeftOut
from samfem.cli import main
from verification.reference.hertz import CircularContact
from verification.runs import models
from verification.runs.files import read_run
from verification.text.console import Progress, digits, print_anything, print_table


@pytest.fixture
def folder(sphere_folder) -> Path:
    return sphere_folder


@pytest.mark.parametrize("model", ["sam", "fem-axisymmetric"])
def test_solve_writes_a_result_that_agrees_with_hertz(folder, samfem, monkeypatch, model):
    monkeypatch.setattr("verification.text.console.QUIET_S", math.inf)  # however slow the machine is
    shown = samfem("solve", "sphere.toml", "--model", model)
    run = read_run(folder / f"sphere-{model}")
    # default meshes: 1e-3 measured for p_max of FEM
    exact = CircularContact(0.65, RADIUS, MODULUS)
    hertz = {"contact_radius_m": exact.contact_radius, "p_max_Pa": exact.peak_pressure}
    hertz["approach_m"] = exact.approach
    assert {name: run.quantities[name] for name in hertz} == pytest.approx(hertz, rel=2e-3)
    assert "approach_m" in shown.out and f"sphere-{model}/summary.json" in shown.out
    assert shown.err.count("\n") == 1 and "half-space): mean pressure 1.7 % too low" in shown.err
    summary = run.summary
    assert summary["cost"]["cpu_s"] > 0 and summary["cost"]["peak_memory_bytes"] > 1e7
    digest = hashlib.sha256(scene_text().encode()).hexdigest()
    assert summary["provenance"]["input_sha256"] == {"sphere.toml": digest}
    assert summary["left_out"] and summary["certificate"]
    assert {entry.name for entry in folder.iterdir()} == {"sphere.toml", "coarse.toml", f"sphere-{model}"}


def test_solve_replaces_an_older_result_and_python_gives_the_same(folder, samfem):
    for _ in range(2):
        samfem("solve", "coarse.toml", "--out", "out/deep")
    run = read_run(folder / "out" / "deep")
    assert set(run.tables["line"]["state"]) == {"peak", "unloaded"}
    assert run.quantities == sam.solve(sam.scene.load_scene(folder / "coarse.toml")).quantities


@pytest.mark.parametrize("target", ["sphere.toml", "sphere.toml/run", ".", "x" * 300])
def test_a_folder_that_must_not_be_written_to_is_refused_before_solving(refused, monkeypatch, target):
    monkeypatch.setattr(models, "solve", lambda *_: pytest.fail("solved"))
    assert target in refused("solve", "sphere.toml", "--out", target)


REFUSED = {
    "no command": ([], "required"),
    "unknown command": (["slove"], "unknown command 'slove' (did you mean solve"),
    "no scene": (["solve"], "SCENE"),
    "missing scene": (["solve", "none.toml"], "none.toml: cannot be read: No such file"),
    "unknown model": (["solve", "sphere.toml", "--model", "fem"], "invalid choice"),
    "SAM with SAM": (["compare", "sphere.toml", "--model", "sam"], "invalid choice"),
    "sweep": (["sweep", "study.toml", "--out", "x"], "study.toml: cannot be read: No such file"),
    "level": (["verify", "--level", "slow"], "invalid choice"),
    "report": (["report", "none"], "none"),
    "case": (["verify", "no-such-case"], "no-such-case"),
}


@pytest.mark.parametrize("arguments, fragment", REFUSED.values(), ids=REFUSED.keys())
def test_a_wrong_command_line_is_refused_and_nothing_is_created(refused, arguments, fragment):
    assert fragment in refused(*arguments)


@pytest.mark.parametrize(
    "command, file, words",
    [
        ("plan", "study.toml", "study: samfem sweep"),
        ("compare", "case.toml", "verification case: samfem verify"),
        ("sweep", "sphere.toml", "scene: samfem solve"),
        ("verify", "study.toml", "study: samfem sweep"),
    ],
)
def test_a_file_of_another_kind_is_named_with_the_command_that_takes_it(folder, samfem, command, file, words):
    (folder / "study.toml").write_text('scene = "sphere.toml"\n[vary]\n"body.poisson" = { list = [0.2] }\n')
    (folder / "case.toml").write_text('scene = "sphere.toml"\n[rows.bound]\n')
    assert samfem(command, file, code=2).err == f"samfem: error: {file}: this is a {words} {file}\n"


def test_help_and_version(samfem):
    assert "solve" in samfem("--help").out
    assert samfem("--version").out.startswith("samfem ")


@pytest.mark.parametrize(
    "raised, code, fragment",
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 1, "lower grid.cells"),
        (OSError("disk full"), 1, "disk full"),
        (ZeroDivisionError("x"), 1, "internal error, please report it: ZeroDivisionError: x"),
    ],
)
def test_whatever_happens_there_is_a_message_and_no_traceback(
    folder, samfem, monkeypatch, raised, code, fragment
):
    def solve(*_, **__):
        raise raised

    monkeypatch.setattr(models, "solve", solve)
    message = samfem("solve", "sphere.toml", code=code).err
    assert fragment in message and message.count("\n") == 1
    assert not (folder / "sphere-sam").exists()
    monkeypatch.setenv("SAMFEM_DEBUG", "1")  # a defect shows where
    if "internal" in fragment:
        with pytest.raises(ZeroDivisionError):
            main(["solve", "sphere.toml"])


def test_an_interrupt_in_a_process_of_its_own(folder):
    """A command that waits stands for one that runs; in a background job tests would ignore the signal."""
    code = "import sys, time; from samfem import cli, solving\n"
    code += "solving.plan = lambda **_: (print('runs', flush=True), time.sleep(60))\n"
    code += "sys.exit(cli.main(['plan', 'sphere.toml']))"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}

    def hears():
        signal.signal(signal.SIGINT, signal.SIG_DFL)

    with subprocess.Popen([sys.executable, "-c", code], preexec_fn=hears, **pipes) as process:
        assert process.stdout.readline() == "runs\n"
        process.send_signal(signal.SIGINT)
        message = process.communicate(timeout=60)[1]
    assert process.returncode == 130 and "interrupted" in message and "Traceback" not in message


@pytest.mark.parametrize(
    "before, after, code, words",
    [
        ("", "--json | true", 0, ""),  # that a reader goes away is no error to report
        ("", ">&-", 1, "standard output is closed"),
        ("ulimit -v 150000;", "", 1, "out of memory"),
    ],
)
def test_closed_streams_and_little_memory_end_in_words(folder, before, after, code, words):
    command = f"{before} {sys.executable} -m samfem.cli plan sphere.toml {after}"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert done.returncode == code and done.stderr.count("\n") == bool(words) and words in done.stderr


def test_escapes_in_names_do_not_reach_the_terminal(folder, samfem):
    said = samfem("plan", "a\x1b[31m\nb.toml", code=2).err + samfem("sol\x9bve", code=2).err
    (folder / "s\x1b.toml").write_text((folder / "sphere.toml").read_text() + '"\\u001b[31m\\r" = 1\n')
    said += samfem("plan", "s\x1b.toml", code=2).err
    assert "a?[31m?b.toml: " in said and "?[31m? = 1: unknown key" in said
    assert all(letter.isprintable() or letter == "\n" for letter in said)


# plan


def test_plan_solves_and_creates_nothing_and_has_what_the_solvers_then_do(folder, samfem, monkeypatch):
    solved = [models.solve(parsed(), model) for model in (models.SAM, models.FEM)]
    monkeypatch.setattr(models, "solve", lambda *_: pytest.fail("solved"))
    before = sorted(folder.iterdir())
    text = samfem("plan", "coarse.toml", "--verbose").out
    assert "cells from [grid], extent chosen from the Hertz radius (cells 33 x 33" in text
    assert "left out  tangential kernels" in text and sorted(folder.iterdir()) == before
    entries = json.loads(samfem("plan", "sphere.toml", "--json").out)["models"]
    for entry, result in zip(entries[:2], solved, strict=True):
        assert entry["model"] == result.model and entry["available"]
        skipped = [LeftOut(each["stage"], each["reason"]) for each in entry["stages"] if not each["runs"]]
        assert skipped == list(result.left_out)
        assert all(stage["reason"] for stage in entry["stages"])
    grid, mesh = ({each["stage"]: each["size"] for each in entry["stages"]} for entry in entries[:2])
    assert grid["grid"]["cells"] == solved[0].discretisation["cells"]
    assert grid["stresses at the output depths"]["depths"] == solved[0].discretisation["depths"]
    assert mesh["mesh"]["unknowns"] == solved[1].discretisation["dofs"]
    assert mesh["mesh"]["elements"] == solved[1].discretisation["elements"]


def calls_of(functions, act) -> dict[str, int]:
    """How often each of the functions is called while `act` runs, by the name of its module and its own."""
    names = {function.__code__: f"{function.__module__}.{function.__name__}" for function in functions}
    calls = Counter()

    def count(frame, event, _argument):
        if event == "call" and frame.f_code in names:
            calls[names[frame.f_code]] += 1

    sys.setprofile(count)
    try:
        act()
    finally:
        sys.setprofile(None)
    assert len(names) == len(functions)
    return {name: calls[name] for name in names.values()}


SMALL = "[grid]\ncells = [9, 9]\n[solver]\ntolerance = 1e-3\n"
ONCE = (make.check_bodies, make.plan_of, make.schedule_of, make.stages_of, bodies._by_hertz)


@pytest.mark.parametrize("add", [SMALL, SMALL + f"[body.plasticity]\n{HARDENING['swift']}"])
def test_a_scene_is_checked_planned_and_estimated_once(folder, add):
    """By the solver, and by the command with all that it asks before it begins."""
    scene, functions = parsed(("0.65 N", "0.05 N"), add=add), (*ONCE, circular_contact_radius)
    (folder / "small.toml").write_text(scene_text(("0.65 N", "0.05 N"), add=add))
    assert set(calls_of(functions, lambda: sam.solve(scene)).values()) == {1}
    assert set(calls_of(ONCE[:4], lambda: main(["solve", "small.toml"])).values()) == {1}
    planners, words = (fem_reference.axisymmetric.planner.plan,), ["--model", "fem-axisymmetric"]
    assert set(calls_of(planners, lambda: main(["solve", "small.toml", *words])).values()) == {1}


# console


def test_progress_is_quiet_at_first_and_then_says_where_it_is(capsys, monkeypatch):
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(time, "monotonic", lambda: clock.now)
    with Progress() as progress:
        for clock.now, done in ((0.5, 1), (1.5, 2), (2.0, 3), (2.5, 4), (2.6, 4)):
            progress("contact", done, 4)
        clock.now = 12.0
        progress("case 2 of 3: contact", 0, 0, ", about 9 s left")
    said = "contact: 2 of 4\ncontact: 4 of 4\ncase 2 of 3: contact, about 9 s left\n"
    assert capsys.readouterr().err == said


def test_tables_are_aligned_and_keep_brackets(capsys):
    print_table(("quantity", "sam"), [("[red]x", digits(1 / 3)), ("y", digits(None))])
    assert capsys.readouterr().out == "quantity  sam\n[red]x    0.333333\ny         -\n"


@pytest.mark.parametrize(
    ("encoding", "errors", "text", "written"),
    [
        ("ascii", "surrogateescape", "\u00b5 \u2013 um", b"? ? um"),
        ("ascii", "strict", "n\udcc3\udcb6.toml", b"n\xc3\xb6.toml"),
        ("utf-8", "strict", "n\udcf6 \u00b5", b"n\xf6 \xc2\xb5"),
        ("latin-1", "strict", "\u00b5\u2212", b"\xb5?"),
    ],
)
def test_every_text_can_be_printed_in_every_language(encoding, errors, text, written):
    """A letter that the language has not is a question mark; bytes of a file's name stay what they are."""
    raw = io.BytesIO()
    stream = io.TextIOWrapper(raw, encoding=encoding, errors=errors, write_through=True)
    print_anything(stream)
    stream.write(text)
    assert raw.getvalue() == written
