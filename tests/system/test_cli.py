# SPDX-License-Identifier: MIT
"""The command from end to end: solve, plan, compare, exit codes, what it writes, and in which words: the key
to change, suggestions, advice first, sizes that a person can read.
"""

import hashlib
import io
import json
import math
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import get_args

import pandas as pd
import pytest
from builders import COARSE, HARDENING, MODULUS, RADIUS, parsed, scene_text

import fem_reference.axisymmetric.planner
import sam
from fem_reference.common.refusals import message_of
from sam.half_space import circular_contact_radius
from sam.planner import bodies, make
from sam.planner.make import remedies_of
from sam.results.tables import advice as words_of
from sam.scene import Compare, LeftOut, Scene, SceneError, Status
from sam.scene.section import OTHER_NAMES, Section, places_of
from samfem.cli import CLAIMS, main
from verification.cases.case import with_keys
from verification.reference.hertz import CircularContact
from verification.runs import models
from verification.runs.files import read_run, write_run
from verification.runs.study import read_study
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
    "case": (["verify", "pavment"], "'pavment' (did you mean pavement?): samfem verify --list shows all"),
    "list": (["verify", "--list", "pavment"], "unknown case 'pavment' (did you mean pavement?)"),
    "gates": (["verify", "--gates", "pavment"], "unknown case 'pavment' (did you mean pavement?)"),
    "start": (["new", "cube"], "cube"),
    "start into no folder": (["new", "sphere", "--out", "nowhere/a.toml"], "no folder nowhere"),
    "example": (["examples", "cube"], "no example 'cube'"),
    "example elsewhere": (["examples", "../scenes/pin"], "no example"),
    "shell": (["completion", "ksh"], "ksh"),
    "no run": (["export", "none", "--format", "msh"], "there is no such folder"),
    "format": (["export", "RUN", "--format", "stl"], "'stl'"),
    "part": (["export", "RUN", "--format", "msh", "--part", "body"], "has no body: it has fields, surface"),
    "state": (["export", "RUN", "--format", "msh", "--state", "unloaded"], "has no fields-unloaded: it has"),
    "mesh": (["export", "RUN", "--format", "msh", "--out", "mesh.inp"], "ends in .msh"),
    "mesh into no folder": (["export", "RUN", "--format", "msh", "--out", "deep/mesh.msh"], "deep/mesh.msh"),
    "no run to view": (["view", "nowhere"], "nowhere is no result: there is no such folder"),
    "image": (["view", "RUN", "--out", "a.jpg"], "a.jpg does not end in .png"),
    "page": (["view", "RUN", "--html", "a.png"], "a.png does not end in .html"),
    "image into no folder": (["view", "RUN", "--out", "none/a.png"], "none/a.png cannot be written"),
    "not worn": (["view", "RUN", "--picture", "worn", "--out", "a.png"], "does not have what --picture worn"),
    "picture": (["view", "RUN", "--picture", "wron"], "invalid choice: 'wron'"),
    "both": (["view", "RUN", "--out", "a.png", "--html", "a.html"], "not allowed with argument"),
}


@pytest.fixture(scope="module")
def fem_run(tmp_path_factory) -> Path:
    """The folder of a run of the axisymmetric model."""
    folder, scene = tmp_path_factory.mktemp("run"), parsed(add=COARSE)
    return write_run(models.solve(scene, models.FEM), scene, folder, {}).parent


@pytest.mark.parametrize("arguments, fragment", REFUSED.values(), ids=REFUSED.keys())
def test_a_wrong_command_line_is_refused_and_nothing_is_created(refused, fem_run, arguments, fragment):
    assert fragment in refused(*(fem_run if word == "RUN" else word for word in arguments))


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


def advice(scene: Scene, status: Status) -> str:
    """What the semi-analytical model advises."""
    return words_of(remedies_of(scene), status)


FLAT = ('shape = "sphere"\nradius = "105 um"', 'shape = "flat"')
ROUGH = """
[surface]
kind = "sinusoid"
amplitude = "0.1 um"
wavelength_x = "4 um"
[grid]
cells = [16, 16]
extent = ["16 um", "16 um"]
border = "relief"
"""
ELASTIC_COUNTER = ('shape = "flat"', 'shape = "flat"\nyoung = "210 GPa"\npoisson = 0.3')
SMOOTH = parsed()
PATCH = parsed(FLAT, add=ROUGH)
FILM = '[body.coating]\nthickness = "100 nm"\nyoung = "80 GPa"\npoisson = 0.3\n'


@pytest.fixture
def scene_file(folder):
    """Writes a scene file into the current folder and returns its name."""

    def write(*edits: tuple[str, str], add: str = "") -> str:
        (folder / "scene.toml").write_text(scene_text(*edits, add=add))
        return "scene.toml"

    return write


def test_a_comparison_names_what_stops_every_model_at_once(scene_file, samfem):
    """Removing what fem-3d names makes the comparison possible; a model that was asked for stands alone."""
    film = '[friction]\nlaw = "chemical-film"\nlow = 0.1\nhigh = 0.4\nfilm_thickness = "100 nm"\n'
    film += 'film_young = "80 GPa"\nfilm_poisson = 0.3\nfilm_yield = "0.6 GPa"\nstrain_limit = 0.02\n'
    said = samfem("compare", scene_file(FLAT, ELASTIC_COUNTER, add=ROUGH + film), code=2).err
    _, axisymmetric, spatial = said.splitlines()
    assert axisymmetric.startswith("  fem-axisymmetric: ") and "remove [surface]" in axisymmetric
    assert spatial.startswith("  fem-3d: ") and "remove young and poisson" in spatial
    assert "counterbody.young = " in spatial
    assert 'friction.law = "chemical-film"' in spatial and not Path("scene-compare").exists()
    assert models.cheapest_reference(PATCH) == models.FEM_3D
    said = samfem("compare", scene_file(FLAT, add=ROUGH + FILM), code=2).err
    assert re.search(r"fem-3d: body.coating.thickness = .*: remove it, or \[surface\]", said)
    said = samfem("compare", scene_file(FLAT, add=ROUGH), "--model", models.FEM, code=2).err
    assert "model fem-axisymmetric: " in said and "fem-3d" not in said


class TestClaim:
    """A film of 0.08 contact radii, a third as stiff, changes pressure and stress by 6 and 7 %."""

    film = FILM.replace("100 nm", "500 nm")
    asked = '[compare]\nclaim = "negligible-film"\n'

    def test_the_exit_code_is_about_the_film_only_if_asked(self, scene_file, samfem, monkeypatch, tmp_path):
        """The same results, solved once: [compare] is no part of the key of the store."""
        monkeypatch.setenv("SAMFEM_STORE", str(tmp_path / "store"))
        sizes = {"size of p_max_change", "size of mises_max_change"}
        for name, file, more, outside in (
            ("agreement", self.film, [], set()),
            ("option", self.film, ["--claim", "negligible-film"], sizes),
            ("scene", self.film + self.asked, [], sizes),
        ):
            shown = samfem("compare", scene_file(add=file), *more, code=int(bool(outside)))
            table = pd.read_csv("scene-compare/compare.csv")
            assert {*table["quantity"][~table["passed"]]} == outside
            assert ("--claim negligible-film" in shown.out) == (name == "agreement")
            assert ("taken from the store" in shown.err) == (name != "agreement")
            verdict = json.loads(Path("scene-compare/verdict.json").read_text())
            assert verdict["film_negligible"] is False and verdict["change_p_max"] < -0.05

    def test_a_claim_that_is_none_is_refused(self, scene_file, samfem):
        said = samfem("compare", scene_file(), "--claim", "negligible-film", code=2).err
        assert '--claim = "negligible-film": only for a scene with [body.coating]' in said
        assert "compare.claim" in samfem("plan", scene_file(add=self.asked), code=2).err
        unknown = scene_file(add=FILM + '[compare]\nclaim = "no-film"\n')
        assert 'one of "negligible-film"' in samfem("plan", unknown, code=2).err
        samfem("compare", scene_file(add=FILM), "--claim", "no-film", code=2)
        assert get_args(get_args(Compare.model_fields["claim"].annotation)[0]) == CLAIMS


@pytest.mark.parametrize(
    ("table", "place"),
    [
        ('[coatings]\nthickness = "1 um"', "[body.coating]"),
        ('[plasticity]\nlaw = "perfect"', "[body.plasticity]"),
        ('[counterbody.coating]\nthickness = "1 um"', "[body.coating]"),
        ("[loading.friction]\ncoefficient = 0.2", "[friction]"),
        ('[body.surface]\nkind = "sinusoid"', "[counterbody.surface] or [surface]"),
        ('[layer]\nthickness = "1 um"', "[body.coating] or [body.plasticity.layer]"),
        ('[indenter]\nradius = "1 um"', "[counterbody]"),
        ("[solver]\nlayer_thickness = 9", "body.plasticity.layer_thickness"),
        ("[fem]\nboxx = 9", "box"),
        ("[counter_body]\nx = 9", "counterbody"),
    ],
)
def test_of_a_misplaced_key_the_error_says_where_it_belongs(table, place):
    with pytest.raises(SceneError, match=re.escape(f"unknown key, did you mean {place}?")):
        parsed(add=table)


def test_other_keys_get_no_such_suggestion_and_suggestions_exist(tmp_path):
    with pytest.raises(SceneError, match="unknown key, allowed here: title, body"):
        parsed(add="[zzz]\na = 1\n")
    (tmp_path / "s.toml").write_text('scene = "x.toml"\nforce = 1\n[vary]\n"loading.force" = {list = [1]}\n')
    with pytest.raises(SceneError, match="force = 1: unknown key, allowed here: title, scene"):
        read_study(tmp_path / "s.toml")
    known = {place for places in places_of(Section.whole).values() for place in places}
    assert {place.split(" with ")[0] for found in OTHER_NAMES.values() for place in found} <= known


@pytest.mark.parametrize("command", [["solve", "--model", "fem-axisymmetric"], ["compare", "--no-store"]])
def test_what_is_predicted_to_take_more_than_a_day_is_begun_only_when_asked(
    scene_file, samfem, monkeypatch, folder, command
):
    """A sphere that yields in 1000 steps on 64 elements in the radius, four times: 61 h, 1 GB."""
    name = scene_file(
        ("force = ", "steps = 1000\nunload = true\ncycles = 4\nforce = "),
        add=f"[body.plasticity]\n{HARDENING['perfect']}[fem]\ncells_per_radius = 64\n",
    )
    before = sorted(folder.iterdir())
    words = samfem(*command, name, code=2).err
    assert "fem-axisymmetric: about 61 h of processor time predicted, more than 24 h: lower fem." in words
    assert words.endswith(", loading.steps = 1000 or loading.cycles = 4, or say --anyway\n")
    assert sorted(folder.iterdir()) == before

    def begun(*_, **__):
        raise KeyboardInterrupt("begun")

    monkeypatch.setattr(models, "solve", begun)
    assert "begun" in samfem(*command, name, "--anyway", code=130).err


class TestPrintedResult:
    """Of a coarse sphere: Hertz's pressure 8.5 GPa, approach 0.35 um."""

    coarse = "[grid]\ncells = [33, 33]\n"

    def test_on_a_terminal_in_gpa_and_um(self, scene_file, samfem, monkeypatch):
        monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
        shown = samfem("solve", scene_file(add=self.coarse)).out
        assert re.match(r"converged in [\d.]+ s: 33 x 33 cells of \d+ nm, \d+ in contact", shown)
        for words, exact in ((r"p_max +([\d.]+) GPa", 8.47), (r"approach +([\d.]+) um", 0.349)):
            assert float(re.search(words, shown)[1]) == pytest.approx(exact, rel=0.02)
        assert re.search(r"contact_area +1\d\d\.\d+ um\^2", shown) and re.search(r"force +0\.65 N", shown)
        assert not re.search(r"_Pa|_m\b|e[-+]\d", shown) and "residual" not in shown

    def test_elsewhere_in_si_under_the_names_of_the_summary(self, scene_file, samfem):
        """Without nulls and what the scene has not; the numbers are those of summary.json, to six digits."""
        status, columns, *rows, path = samfem("solve", scene_file(add=self.coarse)).out.splitlines()
        assert status.startswith("converged in ")
        assert columns.split() == ["quantity", "sam", "Hertz", "deviation"]
        quantities = json.loads(Path(path).read_text())["quantities"]
        shown = {name: [float(value) for value in values[:2]] for name, *values in map(str.split, rows)}
        own = {name: values[0] for name, values in shown.items()}
        assert own == pytest.approx({name: quantities[name] for name in shown}, rel=1e-5)
        absent = {"peeq_max", "friction_coefficient", "pressure_centroid_x_m", "wear_volume_m3"}
        given = {name for name, value in quantities.items() if value is not None}
        assert given - set(shown) == absent
        hertz = CircularContact(0.65, RADIUS, MODULUS)
        assert shown["p_max_Pa"][1] == pytest.approx(hertz.peak_pressure, rel=1e-5)
        assert shown["contact_radius_m"][1] == pytest.approx(hertz.contact_radius, rel=1e-5)


AT_LIMIT = [
    (advice, Status.NOT_CONVERGED, 0.1, "solver.tolerance"),
    (advice, Status.STEP_CUT_LIMIT, 0.1, "solver.tolerance"),
    (advice, Status.STEP_CUT_LIMIT, 1000, "loading.steps"),
    (advice, Status.UNDER_RESOLVED, (4097, 4097), "grid.cells"),
    (message_of, Status.UNDER_RESOLVED, 256, "fem.cells_per_radius"),
    (message_of, Status.PLASTIC_ZONE_AT_GRID_EDGE, 1000.0, "fem.box"),
    (message_of, Status.STEP_CUT_LIMIT, 1000, "loading.steps"),
]


class TestAdviceOfWhatCanBeChanged:
    """No key at its limit, none that the scene has not, none that is set already."""

    @pytest.mark.parametrize("advise", [advice, message_of])
    def test_every_status_says_what_to_change(self, advise):
        for scene in (SMOOTH, PATCH):
            for status in set(Status) - {Status.CONVERGED}:
                what = advise(scene, status).partition(": ")[2]
                assert re.match("raise|lower|change|refine|give", what), (scene.title, what)

    @pytest.mark.parametrize(("advise", "status", "limit", "key"), AT_LIMIT)
    def test_a_key_at_its_limit_is_not_advised(self, advise, status, limit, key):
        assert f"raise {key}" in advise(SMOOTH, status)
        section, _, name = key.partition(".")
        assert key not in advise(with_keys(SMOOTH, section, **{name: limit}), status)
