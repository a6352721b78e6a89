# SPDX-License-Identifier: MIT
"""The command from end to end: solve, plan, compare, exit codes, and what it says and writes."""

import csv
import hashlib
import io
import json
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from test_scene import scene_text

import sam
from sam.contact.real_transforms import half_length
from sam.scene import LeftOut, Status, parse_scene
from verification.app.cli import main
from verification.compare.comparison import COLUMNS, SCALARS, compare_results
from verification.cost.plan import plan
from verification.robustness.kills import hears_interrupts
from verification.runs import models
from verification.runs.files import read_run
from verification.text.console import Progress, digits, print_anything, print_table

COARSE = '[grid]\ncells = [33, 33]\nlayers = 40\ndepth = "12 um"\n[fem]\ncells_per_radius = 8\nbox = 6\n'
"""A few hundredths of a second a model."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch) -> Path:
    """The current folder, with the scene files sphere.toml (defaults) and coarse.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sphere.toml").write_text(scene_text())
    (tmp_path / "coarse.toml").write_text(scene_text(add="unload = true\n" + COARSE))
    return tmp_path


@pytest.fixture(scope="module")
def solved():
    """(SAM, FEM) results of the default scene."""
    scene = parse_scene(scene_text().encode(), "sphere")
    return models.solve(scene, models.SAM), models.solve(scene, models.FEM)


def hertz() -> dict[str, float]:
    """Hertz 1882 for the scene: a = (3FR/4E*)^(1/3), p0 = 3F/(2 pi a^2), approach a^2/R (Johnson 1985, Eq.
    4.22-4.24).
    """
    modulus, force, radius = 210e9 / (1 - 0.3**2), 0.65, 105e-6
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    return {"contact_radius_m": a, "p_max_Pa": 3 * force / (2 * math.pi * a**2), "approach_m": a**2 / radius}


@pytest.mark.parametrize("model", ["sam", "fem-axisymmetric"])
def test_solve_writes_a_result_that_agrees_with_hertz(folder, capsys, monkeypatch, model):
    monkeypatch.setattr(
        "verification.text.console.QUIET_S", math.inf
    )  # no progress, however slow the machine is
    assert main(["solve", "sphere.toml", "--model", model]) == 0
    run = read_run(folder / f"sphere-{model}")
    for name, value in hertz().items():
        assert run.quantities[name] == pytest.approx(
            value, rel=2e-3
        )  # default meshes: 1e-3 measured for p_max of FEM
    shown = capsys.readouterr()
    assert "approach_m" in shown.out and f"sphere-{model}/summary.json" in shown.out and shown.err == ""
    summary = run.summary
    assert summary["cost"]["cpu_s"] > 0 and summary["cost"]["peak_memory_bytes"] > 1e7
    digest = hashlib.sha256(scene_text().encode()).hexdigest()
    assert summary["provenance"]["input_sha256"] == {"sphere.toml": digest}
    assert summary["left_out"] and summary["certificate"]
    assert {entry.name for entry in folder.iterdir()} == {"sphere.toml", "coarse.toml", f"sphere-{model}"}


def test_solve_replaces_an_older_result_and_python_gives_the_same(folder):
    for _ in range(2):
        assert main(["solve", "coarse.toml", "--out", "out/deep"]) == 0
    run = read_run(folder / "out" / "deep")
    assert set(run.tables["line"]["state"]) == {"peak", "unloaded"}
    result = sam.solve(sam.scene.load_scene(folder / "coarse.toml"))
    assert run.quantities == result.quantities


def test_a_solve_that_does_not_converge_says_what_to_change_and_still_writes(folder, capsys):
    text = scene_text(add='[grid]\ncells = [33, 33]\nextent = ["4 um", "4 um"]\n')
    (folder / "edge.toml").write_text(text)
    assert main(["solve", "edge.toml"]) == 1
    message = capsys.readouterr().err
    assert "contact-at-grid-edge" in message and "raise grid.extent" in message
    assert read_run(folder / "edge-sam").summary["status"] == "contact-at-grid-edge"


@pytest.mark.parametrize("target", ["sphere.toml", "sphere.toml/run", ".", "x" * 300])
def test_a_folder_that_must_not_be_written_to_is_refused_before_solving(folder, capsys, monkeypatch, target):
    monkeypatch.setattr(models, "solve", lambda *_: pytest.fail("solved"))
    before = sorted(folder.iterdir())
    assert main(["solve", "sphere.toml", "--out", target]) == 2
    assert target in capsys.readouterr().err
    assert sorted(folder.iterdir()) == before


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
def test_a_wrong_command_line_is_refused_and_nothing_is_created(folder, capsys, arguments, fragment):
    before = sorted(folder.iterdir())
    assert main(arguments) == 2
    message = capsys.readouterr().err
    assert fragment in message and "Traceback" not in message
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    "edit, key",
    [
        (("poisson = 0.3", "poisson = 0.5"), "body.poisson = 0.5"),
        (
            ('"sphere"\nradius = "105 um"', '"ellipsoid"\nradius_x = "1 mm"\nradius_y = "2 mm"'),
            "counterbody.shape",
        ),
    ],
)
def test_what_the_axisymmetric_model_cannot_represent_is_refused_by_name(folder, capsys, edit, key):
    (folder / "scene.toml").write_text(scene_text(edit))
    before, model = sorted(folder.iterdir()), ["--model", "fem-axisymmetric"]
    for command in (["solve", "scene.toml", *model], ["compare", "scene.toml", *model]):
        assert main(command) == 2
        assert key in capsys.readouterr().err
        assert sorted(folder.iterdir()) == before
    assert main(["plan", "scene.toml"]) == 0
    assert f"fem-axisymmetric: cannot be used: model fem-axisymmetric: {key}" in capsys.readouterr().out


def test_help_and_version(capsys):
    assert main(["--help"]) == 0 and "solve" in capsys.readouterr().out
    assert main(["--version"]) == 0 and capsys.readouterr().out.startswith("samfem ")


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
    folder, capsys, monkeypatch, raised, code, fragment
):
    def solve(*_, **__):
        raise raised

    monkeypatch.setattr(models, "solve", solve)
    assert main(["solve", "sphere.toml"]) == code
    message = capsys.readouterr().err
    assert fragment in message and message.count("\n") == 1
    assert not (folder / "sphere-sam").exists()


def test_a_defect_shows_where_when_asked(folder, monkeypatch):
    monkeypatch.setattr(models, "solve", lambda *_, **__: 1 / 0)
    monkeypatch.setenv("SAMFEM_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        main(["solve", "sphere.toml"])


def test_an_interrupt_in_a_process_of_its_own(folder):
    """The signal arrives while a command runs; one that waits stands for it. Tests in a background job would
    ignore it.
    """
    code = "import sys, time; from verification.app import cli, commands; "
    code += "commands.plan = lambda *_: (print('runs', flush=True), time.sleep(60)); sys.exit(cli.main(['plan', 'sphere.toml']))"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", code], preexec_fn=hears_interrupts, **pipes) as process:
        assert process.stdout.readline() == "runs\n"
        process.send_signal(signal.SIGINT)
        message = process.communicate(timeout=60)[1]
    assert process.returncode == 130 and "interrupted" in message and "Traceback" not in message


def test_a_reader_that_goes_away_is_no_error_to_report(folder):
    command = f"{sys.executable} -m verification.app.cli plan sphere.toml --json | true"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert done.stderr == ""


# plan


def test_plan_solves_nothing_and_creates_nothing(folder, capsys, monkeypatch):
    monkeypatch.setattr(models, "solve", lambda *_: pytest.fail("solved"))
    before = sorted(folder.iterdir())
    assert main(["plan", "coarse.toml"]) == 0
    text = capsys.readouterr().out
    for fragment in (
        "Sphere",
        "sam: about",
        "fem-axisymmetric: about",
        "cells 33 x 33",
        "left out  tangential kernels",
    ):
        assert fragment in text
    assert "cells from [grid], extent chosen from the Hertz radius" in text and "estimates" in text
    assert sorted(folder.iterdir()) == before


def test_plan_as_json_has_what_the_solvers_then_do(folder, capsys, solved):
    assert main(["plan", "sphere.toml", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    for entry, result in zip(content["models"][:2], solved, strict=True):
        assert entry["model"] == result.model and entry["available"]
        left_out = [
            LeftOut(stage["stage"], stage["reason"]) for stage in entry["stages"] if not stage["runs"]
        ]
        assert left_out == list(result.left_out)
        assert all(stage["reason"] for stage in entry["stages"])
    sizes = [{stage["stage"]: stage["size"] for stage in entry["stages"]} for entry in content["models"]]
    assert sizes[0]["grid"]["cells"] == solved[0].discretisation["cells"]
    assert sizes[0]["stresses at the output depths"]["depths"] == solved[0].discretisation["depths"]
    assert sizes[1]["mesh"]["unknowns"] == solved[1].discretisation["dofs"]
    assert sizes[1]["mesh"]["elements"] == solved[1].discretisation["elements"]


def test_estimates_grow_with_the_work():
    def estimates(add: str) -> list[dict]:
        return [entry["estimate"] for entry in plan(parse_scene(scene_text(add=add).encode(), ""))["models"]]

    small, large = estimates(""), estimates("[grid]\ncells = [513, 513]\n[fem]\ncells_per_radius = 64\n")
    for a, b in zip(small, large, strict=True):
        assert b["memory_bytes"] > 1.5 * a["memory_bytes"] and b["time_s"] > 2.5 * a["time_s"] > 0


def test_plan_of_a_scene_without_force(folder):
    content = plan(parse_scene(scene_text(("0.65 N", "0 N")).encode(), ""))
    contact = [
        stage
        for entry in content["models"]
        for stage in entry["stages"]
        if stage["stage"] == "contact search"
    ]
    assert [(stage["runs"], stage["reason"]) for stage in contact] == [
        (False, "loading.force is zero: no contact")
    ] * 3


PLASTIC = '[body.plasticity]\nlaw = "table"\nfile = "curve.csv"\n'
GRID = '[grid]\ncells = [65, 65]\nlayers = 20\ndepth = "10 um"\n'


def test_plan_of_a_plastic_scene_names_what_plasticity_adds(folder, capsys):
    (folder / "curve.csv").write_text("peeq,yield_stress_Pa\n0,1e9\n")
    elastic, plastic = (scene_text(add=f"steps = 4\nunload = true\n{GRID}{more}") for more in ("", PLASTIC))
    plans = []
    for text in (elastic, plastic):
        (folder / "scene.toml").write_text(text)
        assert main(["plan", "scene.toml", "--json"]) == 0
        plans.append(json.loads(capsys.readouterr().out)["models"])
    for before, after in zip(*plans, strict=True):
        for name in ("memory_bytes", "time_s"):
            assert after["estimate"][name] > before["estimate"][name]
    stages = {stage["stage"]: stage for entry in plans[1] for stage in entry["stages"] if stage["runs"]}
    assert (
        stages["volume grid"]["size"]["layers"] == 20
        and stages["volume grid"]["reason"] == "layers of [grid]"
    )
    nx, ny, nz = stages["eigenstrain kernels"]["size"]["box_cells"]
    assert nx == ny
    waves = (half_length(nx) + 1) * (half_length(nx) + 2) // 2  # a sphere at rest: x and y may be exchanged
    assert nz == 20 and stages["eigenstrain kernels"]["size"]["bytes"] == 8 * 36 * nz**2 * waves
    a, cell = hertz()["contact_radius_m"], stages["grid"]["size"]["cell_m"][0]
    assert 2 * a < nx * cell and nx <= 65
    assert stages["plastic loop"]["size"] == {"steps": 4, "unload_steps": 4}
    assert stages["return mapping and plastic history"]["size"]["points"] > 1000
    for entry in plans[1]:
        computed, left_out = (
            {stage["stage"] for stage in entry["stages"] if stage["runs"] is runs} for runs in (True, False)
        )
        assert not computed & left_out


def test_a_file_that_the_scene_names_is_hashed_with_it(folder):
    """A yield stress out of reach: the answer is Hertz's."""
    curve = "peeq,yield_stress_Pa\n0,1e12\n"
    (folder / "curve.csv").write_text(curve)
    (folder / "scene.toml").write_text(scene_text(add=PLASTIC))
    assert main(["solve", "scene.toml", "--model", "fem-axisymmetric"]) == 0
    run = read_run(folder / "scene-fem-axisymmetric")
    assert (
        run.summary["provenance"]["input_sha256"]["curve.csv"] == hashlib.sha256(curve.encode()).hexdigest()
    )
    assert run.quantities["peeq_max"] == 0.0 and run.scene.body.plasticity.file == ((0.0, 1e12),)
    assert run.quantities["p_max_Pa"] == pytest.approx(hertz()["p_max_Pa"], rel=2e-3)


# compare


def test_compare_holds_on_the_default_meshes_and_writes_both_runs(folder, capsys):
    assert main(["compare", "sphere.toml"]) == 0
    shown = capsys.readouterr().out
    with open(folder / "sphere-compare" / "compare.csv", encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert tuple(rows[0]) == COLUMNS
    assert COLUMNS[:7] == ("quantity", "sam", "fem", "metric", "difference", "tolerance", "passed")
    assert len(rows) == len(SCALARS) + 4 and {row["passed"] for row in rows} == {"True"}
    assert all(float(row["difference"]) <= float(row["tolerance"]) and row["reason"] for row in rows)
    assert all(row["quantity"] in shown for row in rows)
    for part in ("sam", "fem"):
        assert read_run(folder / "sphere-compare" / part).converged


def test_compare_on_coarse_meshes_fails_and_says_what_to_change(folder, capsys):
    (folder / "coarse.toml").write_text(
        scene_text(add="[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 5\n")
    )
    assert main(["compare", "coarse.toml", "--out", "out"]) == 1
    shown = capsys.readouterr()
    assert (
        "FAILED" in shown.out
        and "outside the tolerance" in shown.err
        and "raise grid.cells = [17, 17], or raise fem.cells_per_radius = 5" in shown.err
    )
    assert main(["compare", "sphere.toml", "--out", "out"]) == 0  # an older comparison is replaced
    assert "FAILED" not in (folder / "out" / "compare.csv").read_text(encoding="utf-8")


def test_compare_draws_both_models_over_each_other(folder, capsys):
    """What is drawn is what the tables of both runs hold; figures of an older comparison do not stay."""
    from verification.figures.compared import LOOKS, PANELS, curves

    (folder / "none.toml").write_text(scene_text(("0.65 N", "0 N"), add=COARSE))
    for scene, code in (("coarse", 1), ("none", 0)):
        assert main(["compare", f"{scene}.toml", "--out", "out", "--figures"]) == code
        drawn = {entry.name for entry in (folder / "out" / "figures").iterdir()}
        assert drawn == {
            f"{name}.{kind}" for name in ("line", "axis", "history") for kind in ("png", "svg", "csv")
        }
        assert "out/figures/line.png" in capsys.readouterr().out
        runs = {model: read_run(folder / "out" / part) for model, part in (("SAM", "sam"), ("FEM", "fem"))}
        for table in PANELS:
            panels = curves(runs, table).figure.axes
            for panel, (column, factor) in zip(panels, PANELS[table].values(), strict=True):
                assert [line.get_label() for line in panel.lines] == list(LOOKS)
                for line, run in zip(panel.lines, runs.values(), strict=True):
                    rows = run.tables[table]["state"] == "peak"
                    known = set((run.tables[table][column][rows] * factor).tolist())
                    assert len(line.get_ydata()) > 5 and set(np.asarray(line.get_ydata()).tolist()) <= known
    assert main(["compare", "none.toml", "--out", "out"]) == 0
    assert not list((folder / "out" / "figures").iterdir())


def test_compare_does_not_write_over_a_single_run(folder, capsys):
    assert main(["solve", "coarse.toml", "--out", "out"]) == 0
    assert main(["compare", "coarse.toml", "--out", "out"]) == 2
    assert "single run" in capsys.readouterr().err


def test_compare_without_force_agrees_in_every_zero(folder):
    (folder / "none.toml").write_text(scene_text(("0.65 N", "0 N")))
    assert main(["compare", "none.toml"]) == 0


def test_compare_of_a_punch_leaves_out_what_is_infinite(folder):
    text = scene_text(('"sphere"\nradius = "105 um"', '"punch"\nradius = "10 um"'))
    (folder / "punch.toml").write_text(text)
    assert main(["compare", "punch.toml"]) == 0
    with open(folder / "punch-compare" / "compare.csv", encoding="utf-8", newline="") as stream:
        names = [row["quantity"] for row in csv.DictReader(stream)]
    assert "approach_m" in names and "p_max_Pa" not in names and len(names) == 7


def row_of(rows, name):
    return next(row for row in rows if row.quantity == name)


@pytest.mark.parametrize("name, metric, tolerance, _reason", SCALARS)
@pytest.mark.parametrize("wrong", ["off", None, math.nan, math.inf])
def test_a_wrong_or_missing_quantity_turns_its_row_red(solved, name, metric, tolerance, _reason, wrong):
    one, other = solved
    assert row_of(compare_results(one, other), name).passed
    scale = other.quantities["contact_radius_m"] if metric == "radii" else other.quantities[name]
    value = other.quantities[name] + 1.01 * tolerance * scale if wrong == "off" else wrong
    changed = replace(one, quantities={**one.quantities, name: value})
    red = {row.quantity for row in compare_results(changed, other) if not row.passed}
    # the pressure of a model ends at its contact radius, so that a wrong radius may show there too
    assert name in red and red <= {name, *(["p_Pa over the contact"] if name == "contact_radius_m" else [])}


FIELDS = {
    "p_Pa over the contact": ("line", "p_Pa"),
    "uz_m on the line": ("line", "uz_m"),
    "mises_Pa on the axis": ("axis", "mises_Pa"),
    "mises_Pa in the plane y = 0": ("plane", "mises_Pa"),
}


def with_column(result, table: str, column: str, change):
    tables = {**result.tables, table: {**result.tables[table]}}
    tables[table][column] = change(np.asarray(tables[table][column], dtype=float))
    return replace(result, tables=tables)


@pytest.mark.parametrize("name, place", FIELDS.items(), ids=FIELDS.keys())
@pytest.mark.parametrize("factor", [1.02, math.nan])
@pytest.mark.parametrize("side", [0, 1])
def test_a_wrong_field_turns_its_row_red(solved, name, place, factor, side):
    """2 % is beyond every tolerance; no other row looks at the field."""
    pair = list(solved)
    assert row_of(compare_results(*pair), name).passed
    pair[side] = with_column(pair[side], *place, lambda values: values * factor)
    assert [row.quantity for row in compare_results(*pair) if not row.passed] == [name]


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_field_at_the_wrong_place_turns_its_row_red(solved, factor):
    one, other = solved
    for name, (table, _) in FIELDS.items():
        moved = with_column(one, table, "z_m" if table == "axis" else "x_m", lambda x: x * factor)
        assert not row_of(compare_results(moved, other), name).passed


@pytest.mark.parametrize("name, place", FIELDS.items(), ids=FIELDS.keys())
def test_a_missing_table_or_state_turns_its_row_red(solved, name, place):
    one, other = solved
    table = {**one.tables[place[0]]}
    table["state"] = ["unloaded"] * len(table["state"])
    for tables in ({**one.tables, place[0]: table}, {k: t for k, t in one.tables.items() if k != place[0]}):
        assert not row_of(compare_results(replace(one, tables=tables), other), name).passed


def test_pressure_outside_the_contact_is_seen(solved):
    """A ring of pressure beyond the contact radius, of a few per cent of the largest."""
    one, other = solved
    x, p = (np.asarray(one.tables["line"][name]) for name in ("x_m", "p_Pa"))
    ring = np.abs(np.abs(x) - 1.1 * other.quantities["contact_radius_m"]) < 3e-7
    wrong = with_column(one, "line", "p_Pa", lambda values: np.where(ring, 0.05 * p.max(), values))
    assert ring.any() and not row_of(compare_results(wrong, other), "p_Pa over the contact").passed


def test_equal_parabolic_pressures_on_different_points_agree_to_rounding():
    """p^2 = p0^2 (1 - r^2/a^2) is reproduced exactly between any points, so the comparison adds no error of
    its own.
    """

    def hertzian(x):
        zero = np.zeros_like(x)
        p = np.sqrt(np.maximum(0.0, 1.0 - x**2))
        line = {"state": ["peak"] * x.size, "x_m": x, "p_Pa": p, "uz_m": zero}
        return SimpleNamespace(quantities={"contact_radius_m": 1.0}, tables={"line": line})

    whole, half = hertzian(np.linspace(-2, 2, 64)), hertzian(np.linspace(0, 5, 78))
    row = row_of(compare_results(whole, half), "p_Pa over the contact")
    # 64 points are even in number: nearest the apex p^2 is constant over (h/2)^2, 1e-3 of p0^2 on a disc of
    # 1e-3 a^2
    assert row.difference < 1e-4
    odd = hertzian(np.linspace(-2, 2, 65))
    assert row_of(compare_results(odd, half), "p_Pa over the contact").difference < 1e-12


# console


def test_progress_is_quiet_at_first_and_then_says_where_it_is(capsys, monkeypatch):
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(time, "monotonic", lambda: clock.now)
    with Progress() as progress:
        for clock.now, done in ((0.5, 1), (1.5, 2), (2.0, 3), (7.0, 4)):
            progress("contact", done, 4)
    assert capsys.readouterr().err == "contact: 2 of 4\ncontact: 4 of 4\n"


def test_tables_are_aligned_and_keep_brackets(capsys):
    print_table(("quantity", "sam"), [("[red]x", digits(1 / 3)), ("y", digits(None))])
    assert capsys.readouterr().out == "quantity  sam\n[red]x    0.333333\ny         -\n"


def test_statuses_say_what_to_change():
    assert all(bool(status.advice) != (status is Status.CONVERGED) for status in Status)


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


def test_a_scene_whose_name_and_title_are_not_ascii_is_solved_in_the_c_locale(folder):
    name = os.fsdecode("n\u00f6".encode())
    text = (folder / "coarse.toml").read_text(encoding="utf-8").replace("title = ", 'title = "\u00b5" # ')
    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    language = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for words in (["plan"], ["solve", "--out", "out"]):
        command = [sys.executable, "-m", "verification.app.cli", *words, f"{name}.toml"]
        done = subprocess.run(command, capture_output=True, env=os.environ | language, check=False)
        assert (done.returncode, done.stderr) == (0, b""), done.stderr
        assert words != ["plan"] or b"?" in done.stdout
    assert set(read_run(folder / "out").summary["provenance"]["input_sha256"]) == {"n\u00f6.toml"}
