# SPDX-License-Identifier: MIT
"""Studies: what their files may say; sweeps end to end, workers that die, what is kept, a Dask cluster."""

import csv
import json
import os
from concurrent.futures import Future
from contextlib import nullcontext
from pathlib import Path
from types import ModuleType
from unittest.mock import Mock, patch

import numpy as np
import pytest
import worker_functions as functions
from builders import scene_text

from sam.scene import SceneError
from samfem import executors, sweeping
from samfem.cli import main
from samfem.executors import WORKER_DIED, Failure, Processes, run
from verification.runs import models, threads
from verification.runs.files import read_run
from verification.runs.store import FOLDER
from verification.runs.study import in_si, read_study
from verification.sensitivity import indices

MORRIS = 'mode = "morris"\nsamples = 4\nseed = 1'


def study(folder: Path, vary: str, more: str = ""):
    (folder / "study.toml").write_text(f'scene = "sphere.toml"\n{more}\n[vary]\n{vary}\n')
    return read_study(folder / "study.toml")


def errors(folder: Path, vary: str, more: str = "") -> str:
    with pytest.raises(SceneError) as caught:
        study(folder, vary, more)
    return str(caught.value)


def column(content, key: str) -> list:
    place = list(content.study.vary).index(key)
    return [point.shown[place] for point in content.points]


def test_a_grid_is_every_combination_and_the_last_key_changes_fastest(folder):
    vary = '"loading.force" = { list = ["1 N", "2 N"] }\n"loading.steps" = { list = [1, 2, 3] }'
    content = study(folder, vary)
    assert [point.shown for point in content.points] == [[f, n] for f in (1.0, 2.0) for n in (1, 2, 3)]
    assert [point.index for point in content.points] == list(range(6))
    for point in content.points:
        assert [point.scene.loading.force, point.scene.loading.steps] == point.shown
    assert set(content.inputs) == {"study.toml", "sphere.toml"}
    vary = 'loading.force = { list = ["1 N", "2 N"] }\n"loading.steps" = { range = [3, 4], count = 2 }'
    assert [point.shown for point in study(folder, vary, 'mode = "zip"').points] == [[1.0, 3], [2.0, 4]]


def test_a_range_is_decimal_and_keeps_both_ends(folder):
    content = study(folder, '"loading.force" = { range = ["100 mN", "0.5 N"], count = 5 }')
    assert column(content, "loading.force") == [0.1, 0.2, 0.3, 0.4, 0.5]  # not 0.30000000000000004
    assert [point.values[0] for point in content.points] == ["100 mN", "200 mN", "300 mN", "400 mN", "0.5 N"]


@pytest.mark.parametrize("mode, size", [("morris", 3), ("sobol", 4), ("uniform", 1)])
def test_a_design_varies_its_keys_within_their_ends_and_draws_its_blocks_for_each_sample(folder, mode, size):
    vary = '"loading.force" = { log = ["0.1 N", "10 N"] }\n"loading.steps" = { list = [1, 2, 3, 4] }\n'
    vary += '"body.poisson" = { list = [0.1, 0.2, 0.3], block = true }'
    of = f'mode = "{mode}"\nsamples = 8\nseed = 5'
    content = study(folder, vary, of)
    force, steps, blocks = (np.array(column(content, key)).reshape(8, size) for key in content.study.vary)
    assert content.study.factors == ["loading.force", "loading.steps"]
    assert ((force >= 0.1) & (force <= 10.0)).all() and set(steps.flat) == {1, 2, 3, 4}
    assert (blocks == blocks[:, :1]).all() and len(set(blocks.flat)) > 1
    if mode == "morris":
        assert sorted(set(force.flat)) == pytest.approx(0.1 * 100 ** (np.arange(4) / 3))
    fewer = study(folder, vary, of.replace("8", "4"))
    assert [point.shown for point in fewer.points] == [point.shown for point in content.points[: 4 * size]]


def test_draws_depend_on_the_seed_and_on_their_own_key_only(folder):
    draw = '"body.young" = { random = ["200 GPa", "220 GPa"], count = 200 }'
    other = '"counterbody.radius" = { random-log = ["1 um", "1 m"], count = 200 }'
    first = column(study(folder, draw, "seed = 1"), "body.young")
    assert column(study(folder, draw, "seed = 1"), "body.young") == first
    assert column(study(folder, draw, "seed = 2"), "body.young") != first
    both = study(folder, f"{other}\n{draw}", 'seed = 1\nmode = "zip"')
    assert column(both, "body.young") == first
    assert min(first) > 200e9 and max(first) < 220e9
    sigmas = 5 / np.sqrt(12 * 200)  # five of the mean of uniform numbers
    assert np.mean(first) == pytest.approx(210e9, abs=20e9 * sigmas)
    radii = np.log10(column(both, "counterbody.radius"))
    assert np.mean(radii) == pytest.approx(-3.0, abs=6 * sigmas)


def test_the_first_draws_are_those_of_every_machine(folder):
    content = study(folder, '"body.poisson" = { random = [0, 0.4], count = 3 }', "seed = 1")
    assert column(content, "body.poisson") == [0.343200847562775, 0.10571221757134, 0.240298734941353]


def test_any_value_can_be_varied_and_tables_are_made_when_missing(folder):
    vary = '"grid.cells" = { list = [[33, 33], [65, 65]] }\n"loading.unload" = { list = [true, false] }\n'
    vary += '"title" = { list = ["a", "b"] }\n'
    content = study(folder, vary)
    assert [point.scene.grid.cells for point in content.points[::4]] == [(33, 33), (65, 65)]
    assert content.points[0].shown == ["[33, 33]", "true", "a"]
    assert in_si(["24 um", "1 mm"]) == "[2.4e-05, 0.001]"


def test_files_that_the_scene_names_can_be_varied(folder):
    for name, stress in (("a.csv", 1e9), ("b.csv", 2e9)):
        (folder / name).write_text(f"peeq,yield_stress_Pa\n0,{stress}\n")
    (folder / "sphere.toml").write_text(scene_text() + '\n[body.plasticity]\nlaw = "table"\n')
    content = study(folder, '"body.plasticity.file" = { list = ["a.csv", "b.csv"] }')
    assert [point.scene.body.plasticity.file[0][1] for point in content.points] == [1e9, 2e9]
    assert {"a.csv", "b.csv"} <= set(content.inputs)


def test_a_scene_that_is_refused_is_a_point_with_the_reason_of_the_parser(folder):
    content = study(folder, '"body.poisson" = { list = [0.3, 0.7] }')
    assert content.points[0].scene is not None and content.points[1].scene is None
    assert content.points[1].reason == "body.poisson = 0.7: a number from 0 to 0.5"
    content = study(folder, '"body.poisson" = { list = [0.3, 0.5] }', 'model = "fem-axisymmetric"')
    assert content.points[0].scene is not None
    assert content.points[1].scene is None and "poisson" in content.points[1].reason


def test_a_study_whose_scenes_are_all_refused_is_an_error_that_says_each_reason_once(folder):
    message = errors(folder, '"loading.forse" = { list = ["1 N", "2 N"] }')
    assert message.count('loading.forse = "1 N": unknown key, did you mean force?') == 1
    many = errors(folder, '"body.poisson" = { range = [1, 40], count = 40 }')
    assert many.count("body.poisson =") == 10 and "and 30 more" in many


def test_all_errors_of_a_study_come_at_once(folder):
    vary = """
"a" = { range = ["0.1 N", "0.5 m"], count = 5 }
"b" = { log = [0, 1], count = 4 }
"c" = { random = ["200 GPa", "220 GPa"] }
"d" = { lst = [1] }
"e" = { list = ["1 N", "2 m"] }
"f" = 3
"g" = { list = [1], range = [1, 2], count = 2 }
"h" = { list = [1], count = 1 }
"i" = { range = [2, 1], count = 0 }
"j" = { list = [] }
"k" = { range = ["1 N", 2], count = 3 }
"l" = { list = [{ x = 1 }] }
"m" = { range = [1, 2], count = 1 }
"n" = { log = ["-1 N", "1 N"], count = 3 }
"o" = { range = [nan, inf], count = 3 }
"""
    message = errors(folder, vary, 'modle = 1\nmode = "both"')
    for fragment in (
        'mode = "both": one of "grid", "zip", "morris", "sobol" or "uniform"',
        "modle = 1: unknown key",
        "seed is missing: required by random draws",
        'vary.a.range = ["0.1 N", "0.5 m"]: two numbers, or two strings with units of one dimension',
        "vary.b.log = [0, 1]",
        "vary.c.count is missing",
        "vary.d.lst = [1]: unknown key, did you mean list?",
        'vary.e.list = ["1 N", "2 m"]',
        "vary.f = 3: a table",
        "vary.g.range",
        "vary.h.count = 1: a list has its own number of values",
        "vary.i.range = [2, 1]",
        "vary.i.count = 0: a whole number from 1",
        "vary.j.list = []",
        'vary.k.range = ["1 N", 2]',
        'vary.l.list = [{"x": 1}]',
        "vary.m.count = 1: 2 or more",
        'vary.n.log = ["-1 N", "1 N"]',
        "vary.o.range = [NaN, Infinity]",
    ):
        assert fragment in message


@pytest.mark.parametrize(
    "vary, more, fragment",
    [
        ("", "", "vary = {}: one or more keys"),
        ('"a b" = { list = [1] }', "", '"a b" is no key of a scene'),
        (f'"{".".join("abcdefg")}" = {{ list = [1] }}', "", "is no key of a scene"),
        ('"body" = {list = [1]}\n"body.young" = {list = [1]}', "", "body or body.young: one is inside the"),
        ('"body.young.x" = { list = [1] }', "", "body.young is no table of the scene"),
        ('"loading.steps" = { range = [1, 10001], count = 10001 }', "", "vary.loading.steps.count = 10001"),
        ('"a" = {range = [1, 2], count = 101}\n"b" = {range = [1, 2], count = 100}', "", "at most 10000"),
        ('"a" = { list = [1] }\n"b" = { list = [1, 2] }', 'mode = "zip"', "here a 1, b 2"),
        ('"a" = {list = [1]}', "samples = 4", 'samples = 4: with mode = "morris", "sobol" or "uniform" only'),
        ('"a" = { list = [1], block = true }', "", 'vary.a.block = true: with mode = "morris", "sobol"'),
        ('"a" = { list = [1, 2] }', 'mode = "morris"', "samples is missing: required by this mode"),
        ('"a" = { list = [1, 2] }', 'mode = "sobol"', "seed is missing: required by random draws"),
        ('"a" = { range = [1, 2], count = 3 }', MORRIS, "vary.a.count = 3: the mode chooses the values"),
        ('"a.b" = { range = [1, 2], count = 3 }', MORRIS, "vary.a.b.count = 3: the mode chooses the values"),
        ('"a" = { random = [1, 2] }', MORRIS, "vary.a.random = [1, 2]: the mode chooses the values"),
        ('"a" = { range = [1, 2], block = true }', MORRIS, "vary.a.block = true: with a list of values"),
        ('"a" = { list = [1, 2], block = true }', MORRIS, "a key that is no block"),
        ('"a" = { range = [1, 2] }', "mode = 'sobol'\nsamples = 5000\nseed = 1", "at most 3333 with 1 keys"),
        ('"solver.uncertainty" = { list = [true] }', "", "solver.uncertainty = true: not in a sweep"),
        ('"a" = { range = [0, 1' + "0" * 400 + "], count = 3 }", "", "a = "),
    ],
)
def test_a_wrong_study_is_refused(folder, vary, more, fragment):
    assert fragment in errors(folder, vary, more)


COARSE = "[grid]\ncells = [17, 17]\n"
FORCES = [0.1, 0.2, 0.3, 0.4]
STUDY = 'scene = "coarse.toml"\n[vary]\n"loading.force" = { range = ["0.1 N", "0.4 N"], count = 4 }\n'


def dask_distributed() -> ModuleType:
    """The package; skips on a machine that cannot load it."""
    if not Path("/proc/self").exists():
        pytest.skip("distributed reads /proc, which this machine has not")
    return pytest.importorskip("distributed")


def write_study(folder: Path) -> None:
    """A scene of a few hundredths of a second, and its study."""
    (folder / "coarse.toml").write_text(scene_text(add=COARSE))
    (folder / "study.toml").write_text(STUDY)


@pytest.fixture
def folder(folder) -> Path:
    write_study(folder)
    (folder / "sphere.toml").write_text(scene_text())
    return folder


@pytest.fixture
def no_figure(monkeypatch) -> None:
    """For tests of something else: drawing takes longer than the scenes."""
    monkeypatch.setattr(sweeping, "sweep_figure", lambda *_: None)


@pytest.fixture(scope="module")
def pool():
    """A worker for all sweeps of which none dies: to start one takes longer than the scenes."""
    with Processes(1) as workers:
        yield workers


@pytest.fixture
def same_worker(monkeypatch, pool) -> None:
    """For tests of something else than the workers."""
    monkeypatch.setattr(sweeping, "_executor", lambda _scheduler, _count: nullcontext(pool))


@pytest.fixture(scope="module")
def calm(tmp_path_factory) -> bytes:
    """The table of the study, undisturbed, by the pool."""
    place = tmp_path_factory.mktemp("calm")
    write_study(place)
    words = ["sweep", str(place / "study.toml"), "--out", str(place / "out"), "--workers", "1", "--no-store"]
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sweeping, "sweep_figure", lambda *_: None)
        assert main(words) == 0
    return (place / "out" / "sweep.csv").read_bytes()


def sweep_of(out: str, *options: str, code: int = 0, workers: int = 1) -> dict:
    """Run the command; the content of sweep.json."""
    where = [] if "--scheduler" in options else ["--workers", str(workers)]
    assert main(["sweep", "study.toml", "--out", out, *where, *options]) == code
    return json.loads(Path(out, "sweep.json").read_text(encoding="utf-8"))


def table(out: str) -> list[dict[str, str]]:
    with open(Path(out, "sweep.csv"), encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_table_is_the_same_with_one_worker_and_with_two(folder, calm, capsys):
    record = sweep_of("two", workers=2)
    assert Path("two/sweep.csv").read_bytes() == calm
    assert record["counts"] == {"solved": 4, "reused": 0, "not_converged": 0, "failed": 0, "refused": 0}
    assert (record["format"], record["points"], record["retries"]) == ("samfem sweep 1", 4, 0)
    assert record["units"] == {"loading.force": "N"}
    rows = table("two")
    assert list(rows[0])[:5] == ["index", "loading.force", "model", "status", "reason"]
    assert [float(row["loading.force"]) for row in rows] == FORCES
    assert [row["index"] for row in rows] == ["0", "1", "2", "3"]
    pressures = np.array([float(row["p_max_Pa"]) for row in rows])
    np.testing.assert_allclose(pressures / pressures[0], np.cbrt(np.array(FORCES) / 0.1), rtol=1e-3)  # Hertz
    assert {path.name for path in Path("two").iterdir()} == {"runs", *sweeping.FILES}  # the figure too
    found = read_run(Path("two/runs/2"))
    assert found.quantities["p_max_Pa"] == pressures[2] and found.converged
    assert found.summary["provenance"]["threads"]["OMP_NUM_THREADS"] == "1"
    assert "two/sweep.csv" in capsys.readouterr().out


@pytest.mark.usefixtures("same_worker")
def test_scenes_that_are_refused_are_rows(folder, no_figure, capsys):
    (folder / "study.toml").write_text(STUDY + '"body.poisson" = { list = [0.3, 0.7] }\n')
    record = sweep_of("out", "--no-runs", code=1)
    rows = table("out")
    assert [row["status"] for row in rows] == ["converged", "refused"] * 4
    assert rows[1]["reason"] == "body.poisson = 0.7: a number from 0 to 0.5" and rows[1]["p_max_Pa"] == ""
    assert (record["counts"]["solved"], record["counts"]["refused"]) == (4, 4)
    assert not Path("out/runs").exists()
    said = capsys.readouterr().err
    assert "scene 1: refused: body.poisson = 0.7" in said and "and 1 more, see out/sweep.csv" in said


@pytest.mark.parametrize(
    "change, options, fragment",
    [
        ('"body.young" = { list = ["1 N"] }', [], "every scene is refused"),
        ('"loading.steps" = { range = [1] }', [], "count is missing"),
        ("", ["--workers", "0"], "no whole number from 1"),
        ("", ["--workers", "2", "--scheduler", "x"], "not allowed with"),
        ("", ["--scheduler", "nonsense"], '--scheduler = "nonsense": the address of a running Dask'),
        ("", ["--scheduler", "tcp://127.0.0.1:1"], "the address of a running Dask scheduler"),
        ("", ["--out", "coarse.toml"], "no folder that can be written to"),
        ("", ["--out", "."], "is not the folder of a run"),
    ],
)
def test_wrong_input_is_refused_and_nothing_is_created(
    folder, refused, monkeypatch, change, options, fragment
):
    if "--scheduler" in options and "x" not in options:
        dask_distributed()
    monkeypatch.setattr(executors, "CONNECT_S", 0.5)
    (folder / "study.toml").write_text(STUDY + change)
    assert fragment in refused("sweep", "study.toml", *options)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (ImportError("no such symbol"), "(no such symbol): use --workers"),
        (ModuleNotFoundError(), "pip install"),
    ],
)
def test_a_package_that_cannot_be_loaded_is_said(folder, refused, monkeypatch, error, words):
    monkeypatch.setattr(sweeping, "Cluster", Mock(side_effect=error))
    said = refused("sweep", "study.toml", "--scheduler", "tcp://localhost:8786")
    assert "needs the package distributed" in said and words in said


def test_a_folder_with_a_single_run_is_not_overwritten(folder, samfem):
    samfem("solve", "coarse.toml", "--out", "run")
    assert "run holds a single run" in samfem("sweep", "study.toml", "--out", "run", code=2).err
    assert read_run(Path("run")).converged


@pytest.mark.usefixtures("same_worker")
def test_the_second_time_nothing_is_solved_and_the_table_is_the_same(folder, no_figure, monkeypatch):
    monkeypatch.setenv(FOLDER, str(folder / "store"))
    sweep_of("out")
    first = Path("out/sweep.csv").read_bytes()
    written = Path("out/runs/0/summary.json").stat().st_mtime_ns
    monkeypatch.setattr(Processes, "submit", lambda *_: pytest.fail("solved"))
    record = sweep_of("out")
    assert (record["counts"]["solved"], record["counts"]["reused"]) == (0, 4)
    assert Path("out/sweep.csv").read_bytes() == first
    assert Path("out/runs/0/summary.json").stat().st_mtime_ns == written
    sweep_of("new")
    assert read_run(Path("new/runs/3")).summary["provenance"]["from_store"]["computed_utc"]


DESIGN = """scene = "coarse.toml"
mode = "morris"
samples = 3
seed = 2
[vary]
"loading.force" = { log = ["0.1 N", "0.4 N"] }
"body.young" = { list = ["150 GPa", "200 GPa", "300 GPa"] }
"counterbody.radius" = { list = ["105 um", "105.0 um"] }
"""


@pytest.mark.usefixtures("same_worker")
def test_a_design_ends_with_the_indices_of_what_moves_a_contact(folder, no_figure, monkeypatch):
    """A key that changes nothing has no effect, and equal scenes are solved once."""
    monkeypatch.setenv(FOLDER, str(folder / "store"))
    (folder / "study.toml").write_text(DESIGN)
    tasks, submit = [], Processes.submit
    monkeypatch.setattr(Processes, "submit", lambda *task: tasks.append(task) or submit(*task))
    record = sweep_of("out", "--no-runs")
    assert record["counts"]["solved"] == 12 > len(tasks)
    with open("out/sensitivity.csv", encoding="utf-8", newline="") as stream:
        found = [row for row in csv.DictReader(stream) if row["quantity"] == "p_max_Pa"]
    study, rows = read_study("study.toml").study, table("out")
    pressure = np.array([float(row["p_max_Pa"]) for row in rows])
    for index in indices("morris", study.shares(), pressure, 2):
        own = {row["key"]: float(row["value"]) for row in found if row["index"] == index.name}
        assert own == pytest.approx(dict(zip(study.factors, index.values, strict=True)), rel=1e-12)
        assert own["counterbody.radius"] == 0.0
    assert Path("out/sensitivity.png").stat().st_size > 1000


@pytest.mark.usefixtures("same_worker")
def test_what_did_not_converge_is_not_solved_again(folder, no_figure, monkeypatch):
    monkeypatch.setenv(FOLDER, str(folder / "store"))
    (folder / "coarse.toml").write_text(scene_text(add=COARSE + 'extent = ["4 um", "4 um"]\n'))
    first = sweep_of("out", code=1)
    rows = Path("out/sweep.csv").read_bytes()
    monkeypatch.setattr(Processes, "submit", lambda *_: pytest.fail("solved"))
    again = sweep_of("out", code=1)
    assert (first["counts"]["not_converged"], again["counts"]["reused"]) == (4, 4)
    assert Path("out/sweep.csv").read_bytes() == rows


@pytest.mark.usefixtures("same_worker")
def test_runs_of_an_older_study_are_removed(folder, no_figure):
    sweep_of("out")
    (folder / "study.toml").write_text(STUDY.replace("0.1 N", "0.3 N").replace("count = 4", "count = 2"))
    sweep_of("out")
    assert [path.name for path in sorted(Path("out/runs").iterdir())] == ["0", "1"]
    assert read_run(Path("out/runs/0")).scene.loading.force == 0.3 and len(table("out")) == 2


def test_an_interrupted_sweep_keeps_what_is_finished_and_goes_on_from_there(
    folder, no_figure, samfem, monkeypatch
):
    monkeypatch.setenv(FOLDER, str(folder / "store"))
    write, stopped = sweeping.Sweep.write, []

    def write_and_stop(self, always=False):
        write(self, always=True)
        if len(self.rows) == 2 and not stopped:
            stopped.append(True)
            raise KeyboardInterrupt

    monkeypatch.setattr(sweeping.Sweep, "write", write_and_stop)
    said = samfem("sweep", "study.toml", "--out", "out", "--workers", "1", code=130).err
    assert "2 of 4 scenes are finished; the same command goes on from there" in said
    assert [row["index"] for row in table("out")] == ["0", "1"]
    assert not Path("out/sweep.json").exists()
    record = sweep_of("out")
    assert (record["counts"]["solved"], record["counts"]["reused"]) == (2, 2) and len(table("out")) == 4


def test_a_killed_worker_costs_a_retry_and_not_the_sweep(folder, no_figure, calm, monkeypatch):
    monkeypatch.setattr(sweeping, "solve_scene", functions.solve_but_die_once)
    monkeypatch.setenv(functions.MARKER, str(folder / "marker"))
    record = sweep_of("out", "--no-runs", workers=2)
    assert (folder / "marker").exists()
    assert (record["retries"], record["workers"]["lost"], record["counts"]["solved"]) == (1, 1, 4)
    assert Path("out/sweep.csv").read_bytes() == calm


def test_a_scene_that_kills_every_worker_is_a_row(folder, no_figure, monkeypatch, capsys):
    monkeypatch.setattr(sweeping, "solve_scene", functions.solve_but_die)
    record = sweep_of("out", "--no-runs", code=1, workers=2)
    assert [row["status"] for row in table("out")] == ["converged", "converged", "failed", "converged"]
    assert table("out")[2]["reason"] == WORKER_DIED
    assert (record["retries"], record["workers"]["lost"], record["counts"]["failed"]) == (2, 3, 1)
    assert f"scene 2: failed: {WORKER_DIED}" in capsys.readouterr().err


def test_a_worker_computes_with_its_own_version_only(folder):
    scene = read_study("study.toml").points[0].scene
    outcome = sweeping.solve_scene(scene, "sam", "another")
    assert isinstance(outcome, Failure) and "another version" in outcome.reason
    result, _ = sweeping.solve_scene(scene, "sam", sweeping.code_version("sam"))
    assert result.quantities == models.solve(scene, "sam").quantities


# workers


def outcomes(workers, function, tasks) -> dict:
    return {key: value for key, value, _ in run(workers, function, tasks)}


def test_tasks_run_in_processes_with_one_thread_each_and_leave_ours_alone(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    with Processes(1) as workers:
        found = outcomes(workers, functions.environment, {0: ()})[0]
    assert [found[name] for name in threads.EVERY_LIBRARY] == ["1"] * len(threads.EVERY_LIBRARY)
    assert os.environ["OMP_NUM_THREADS"] == "7" and "MKL_NUM_THREADS" not in os.environ


class Neighbours:
    """An executor that blames two tasks when one of them dies, as a cluster may: the pair of 1 and 2 dies."""

    alone, most_deaths, lost = True, 2, 0

    def __init__(self):
        self.executor, self.together = self, []

    def slots(self) -> int:
        return 4

    def died(self, error: BaseException) -> bool:
        return isinstance(error, MemoryError)

    def submit(self, function, value):
        future = Future()
        self.together.append(value)
        first = self.together.count(value) == 1
        if value == 1 or (value == 2 and first):
            future.set_exception(MemoryError())
        else:
            future.set_result(function(value))
        return future


def test_a_neighbour_of_a_deadly_task_is_not_blamed():
    found = outcomes(Neighbours(), functions.double, {k: (k,) for k in range(8)})
    assert found == {k: 2.0 * k for k in range(8)} | {1: Failure(WORKER_DIED)}


# Dask


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A local cluster of two workers; what it leaves in the environment is taken back."""
    distributed = dask_distributed()
    marker = tmp_path_factory.mktemp("dask") / "marker"
    seen = {functions.MARKER: str(marker), "PYTHONPATH": str(Path(__file__).parents[1])}
    # the cluster sets MALLOC_TRIM_THRESHOLD_ for all processes that come later
    how = {"dashboard_address": None, "local_directory": str(marker.parent)}
    with (
        patch.dict(os.environ, seen),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, **how) as found,
    ):
        yield found.scheduler_address, marker


def test_a_dask_cluster_that_loses_a_worker_gives_the_same_table(
    folder, no_figure, calm, cluster, monkeypatch
):
    address, marker = cluster
    monkeypatch.setattr(sweeping, "solve_scene", functions.solve_but_die_once)
    record = sweep_of("dask", "--no-runs", "--scheduler", address)
    assert marker.exists() and record["workers"] == {"kind": "dask", "lost": 1}
    assert record["counts"]["solved"] == 4 and Path("dask/sweep.csv").read_bytes() == calm
