# SPDX-License-Identifier: MIT
"""A solve that ends before its peak load has no quantity of it, and says the last load that fitted."""

import io
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace

import numpy as np
import pytest
from builders import HARDENING, PERFECT, SWIFT, SWIFT_YIELD, hertz_force, scene as small_scene, scene_text

import fem_reference
import sam
from fem_reference.axisymmetric.model import Model
from fem_reference.common import loading
from sam.plasticity import history, load_step as plastic_step
from sam.scene import Status
from sam.scene.result import LAST, PEAK
from samfem.cli import main
from verification.figures import space
from verification.runs.files import of_last_load, read_run


def plastic(ratio, law=SWIFT, cells=33, **loading):
    """A rigid sphere; p0 of Hertz is `ratio` times the initial yield stress."""
    force = hertz_force(ratio * law.get("yield_stress", SWIFT_YIELD))
    return small_scene(
        body={"plasticity": law},
        loading={"force": force, "steps": 4, "unload": True, **loading},
        grid={"cells": (cells, cells)},
        fem={"cells_per_radius": 8},
    )


def states(result) -> dict[str, set[str]]:
    return {name: set(result.tables[name]["state"]) for name in ("axis", "line", "plane")}


def says_what_was_reached(result, force: float) -> None:
    """force: the peak in N."""
    assert set(result.quantities.values()) == {None} and result.last_fitting["force_N"] < force * (1 - 1e-6)
    assert result.last_fitting["p_max_Pa"] is not None
    assert set(map(frozenset, states(result).values())) == {frozenset({LAST})}


def limited(monkeypatch, model: type, fails) -> None:
    """Let Newton's method end unconverged where `fails` says so of the force over that of the peak."""
    solved = model.load

    def load(self, target, *arguments, **keys):
        state = solved(self, target, *arguments, **keys)
        failed = fails(target.force / self.scales.peak_force)
        return replace(state, converged=False) if failed else state

    monkeypatch.setattr(model, "load", load)


def test_sam_cut_before_the_first_step(monkeypatch):
    """Nothing was reached: the last load that fitted is none."""
    monkeypatch.setattr(plastic_step, "ITERATIONS", 1)
    monkeypatch.setattr(plastic_step, "LONG_ITERATIONS", 1)
    scene = plastic(3, PERFECT, steps=1)
    result = sam.solve(scene)
    assert result.status is Status.STEP_CUT_LIMIT and "steps" in result.message
    says_what_was_reached(result, scene.loading.force)


def test_sam_that_fails_in_the_second_cycle_has_the_first_in_its_cycles(monkeypatch):
    """The peak of the scene is that of the last cycle."""
    done, attempt = [], history.attempt

    def few(model, now, load):
        done.append(load.force)
        if len(done) > 4:  # both steps up, and what unloading takes
            ended = replace(now.history, status=Status.PLASTIC_ZONE_AT_GRID_EDGE)
            return replace(now, history=ended), None
        return attempt(model, now, load)

    monkeypatch.setattr(history, "attempt", few)
    result = sam.solve(plastic(3, cells=17, unload=True, cycles=2))
    assert result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE
    assert set(result.quantities.values()) == {None} and states(result)["line"] == {LAST}
    cycles = set(result.tables["history"]["cycle"])
    assert result.tables["cycles"]["cycle"] == [1] and cycles <= {1, 2}


@pytest.mark.parametrize("reached", [0.0, 0.5])
def test_axisymmetric_cut_limit(monkeypatch, reached):
    """Newton fails in the first or the second of two steps: none fits, or the first."""
    scene = plastic(4, PERFECT, steps=2)
    limited(monkeypatch, Model, lambda force: force > reached * 1.01)
    monkeypatch.setattr(loading, "MOST_CUTS", 1)
    result = fem_reference.solve(scene)
    assert result.status is Status.STEP_CUT_LIMIT and "loading.steps" in result.message
    says_what_was_reached(result, scene.loading.force)
    assert max(result.tables["residuals"]["step"]) not in result.tables["history"]["step"]
    assert result.last_fitting["force_N"] == pytest.approx(reached * scene.loading.force, rel=1e-9)


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Folder of the result of a plastic sphere on a grid of the scene whose layers end inside the plastic
    zone, and what the command wrote to stdout and stderr.
    """
    folder, out, err = tmp_path_factory.mktemp("edge"), io.StringIO(), io.StringIO()
    law = f"[body.plasticity]\n{HARDENING['swift']}"
    grid = '[grid]\ncells = [33, 33]\nlayers = 12\ndepth = "9 um"\n'
    (folder / "edge.toml").write_text(scene_text(add="steps = 8\n" + law + grid))
    command = ["solve", str(folder / "edge.toml"), "--out", str(folder / "out"), "--figures"]
    with pytest.MonkeyPatch.context() as patched, redirect_stdout(out), redirect_stderr(err):
        patched.setattr(space, "draw_run", lambda _folder, **_: [])  # pictures in space: not looked at here
        assert main(command) == 1
    return folder / "out", out.getvalue(), err.getvalue()


def test_solve_says_at_which_load_its_numbers_are(solved):
    out, said, error = solved
    run = read_run(out)
    says_what_was_reached(run, 0.65)
    force = run.last_fitting["force_N"]
    assert 0 < force == pytest.approx(run.tables["history"]["force_N"].iloc[-1], rel=1e-9)
    assert run.tables["line"]["p_Pa"].max() == pytest.approx(run.last_fitting["p_max_Pa"], rel=0.02)
    lines = said.splitlines()
    assert lines[0].startswith("plastic-zone-at-grid-edge in ")
    assert lines[1] == f"the peak load was not reached; at the last load that fitted, {force:.6g} N:"
    assert "plastic-zone-at-grid-edge" in error and (out / "figures" / "mises.png").exists()


def test_its_figures_are_of_that_load(solved):
    run = read_run(solved[0])
    drawn = of_last_load(run)
    assert drawn.quantities == run.last_fitting and set(drawn.tables["axis"]["state"]) == {PEAK}
    assert np.array_equal(drawn.tables["axis"]["mises_Pa"], run.tables["axis"]["mises_Pa"])
