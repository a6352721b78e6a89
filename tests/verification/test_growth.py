# SPDX-License-Identifier: MIT
"""Growth of time and memory: exponents, processes that measure themselves alone, predictions against measured
memory.
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import LINEAR, PERFECT, RUN_IN_STEEL, SWIFT, SWIFT_YIELD, hertz_force, running_in, scene

import sam
from sam import choose_grid
from verification.cases import all_cases
from verification.cases.case import Context, with_loading
from verification.cases.cost import growth as case
from verification.cases.cyclic.repeated import law
from verification.cases.recipes import even_cells, rubbed
from verification.cost import estimates, growth
from verification.cost.growth import Applied, Taken
from verification.cost.measured import alone, idle_bytes, solve_alone
from verification.judging import judge
from verification.reference.convergence import fit_power
from verification.rows import load_rows
from verification.runs.models import FEM, SAM
from verification.runs.threads import EVERY_LIBRARY as THREADS

CELLS = np.array([1e3, 4e3, 16e3, 64e3])
MB = 1e6


def test_a_power_is_found_with_its_uncertainty():
    exact = fit_power(CELLS, 3e-7 * CELLS**1.2)
    assert (exact.exponent, exact.factor) == pytest.approx((1.2, 3e-7), rel=1e-12)
    assert exact.error < 1e-12 and exact(1e3) == pytest.approx(3e-7 * 1e3**1.2)
    rng, found = np.random.default_rng(0), []
    for _ in range(400):
        found.append(fit_power(CELLS, CELLS**1.2 * np.exp(0.1 * rng.standard_normal(4))))
    spread = np.std([power.exponent for power in found])
    assert np.sqrt(np.mean([power.error**2 for power in found])) == pytest.approx(spread, rel=0.1)


def test_a_power_needs_three_points_in_its_range():
    assert fit_power(CELLS, CELLS, first=2e3).first == 4e3
    for x, y, first in (
        (CELLS[:2], CELLS[:2], 0),
        (CELLS, CELLS, 1e4),
        (CELLS, -CELLS, 0),
        (CELLS, CELLS * np.nan, 0),
    ):
        with pytest.raises(ValueError):
            fit_power(x, y, first)


@pytest.fixture(scope="module")
def idle() -> int:
    """Memory of a process that has solved nothing."""
    return idle_bytes(SAM)


def test_a_process_measures_its_own_memory_and_one_thread(idle):
    """Also after this process had much more memory than it has."""
    before = {name: os.environ.get(name) for name in THREADS}
    large = np.ones(40_000_000)
    assert large.nbytes > 2 * idle
    del large
    assert (
        idle_bytes(SAM) < 1.3 * idle
    )  # of its own; more than twice as much if it began with that of this process
    assert alone(os.getenv, THREADS[0]) == "1" and {name: os.environ.get(name) for name in THREADS} == before


@pytest.mark.parametrize(
    "rung",
    [growth.elastic((401,), "elastic")[0], growth.rough((150,))[0], growth.plastic((41,), steps=2)[0]],
    ids=["elastic", "rough", "plastic"],
)
def test_memory_is_predicted_within_a_fifth(rung, idle, monkeypatch):
    """Sizes that the factors were not fitted to."""
    monkeypatch.setattr(growth, "REPEATS", 1)  # of the time
    taken = growth.measured_at(rung, idle)
    assert taken.converged and taken.memory > 80 * MB
    assert taken.expected.memory_bytes == pytest.approx(taken.memory, rel=0.2)


@pytest.mark.parametrize("slides", [False, True], ids=["pressed", "with traction"])
def test_memory_of_repeated_loads_is_predicted_within_a_fifth(slides, idle, tmp_path):
    """Four cycles with back-stresses; the zone below a given pressure is wider than below a sphere."""
    given = Context("growth", tmp_path, "quick", lambda *_: None).scene("repeated-hertz")
    ready = with_loading(law(given, "chaboche"), steps=1, cycles=4)
    if slides:
        ready = with_loading(rubbed(even_cells(ready, (6, 2.4, 2.4, 3.0)), {"coefficient": 0.2}), p0=3.8e9)
    else:
        ready = even_cells(ready, (9, 1.6, 1.6, 2.0))
    result = solve_alone(ready, SAM)
    taken = result.cost["peak_memory_bytes"] - idle
    said = estimates.estimate(ready, SAM).memory_bytes - estimates.IDLE_BYTES
    assert result.converged and taken > 100 * MB
    assert said == pytest.approx(taken, rel=0.2)


@pytest.mark.parametrize(("ratio", "cells"), [(2.0, 45), (6.2, 45)])
def test_the_box_of_a_plastic_scene_is_predicted(ratio, cells):
    """The box that the solution ends with, from the pressure of Hertz alone."""
    scene = growth.plastic((cells,), steps=3)[0].scene
    force = scene.loading.force * (ratio / 4) ** 3  # the scene is at 4
    scene = scene.model_copy(update={"loading": scene.loading.model_copy(update={"force": force})})
    found = sam.solve(scene).discretisation
    expected = estimates.plastic_box(scene, choose_grid(scene))
    nx, ny = map(int, found["plastic_box_cells"])
    actual = replace(expected, nx=nx, ny=ny, layers=found["plastic_box_layers"])
    assert expected.coefficients == pytest.approx(actual.coefficients, rel=0.2)


@pytest.mark.parametrize(("law", "ratio"), [(PERFECT, 3.0), (PERFECT, 10.0), (LINEAR, 4.0), (SWIFT, 6.0)])
def test_the_iterations_of_a_plastic_scene_are_predicted(law, ratio):
    """From a small plastic zone to a deep one, perfectly plastic or hardening, within a factor of 1.5."""
    force = hertz_force(ratio * law.get("yield_stress", SWIFT_YIELD))
    body = {"plasticity": law}
    ready = scene(body=body, loading={"force": force, "steps": 5}, grid={"cells": (25, 25)})
    found = sam.solve(ready).cost["plastic_iterations"] / ready.loading.steps
    assert found / 1.5 < estimates.plastic_iterations(ready, choose_grid(ready)) < 1.5 * found


@pytest.mark.parametrize("renew", [False, True], ids=["the same plane", "a new plane in each cycle"])
def test_the_iterations_of_running_in_are_predicted(renew):
    plane = {"kind": "self-affine", "sq": 20e-9, "cutoff_long": 16e-6, "cutoff_short": 8e-6, "hurst": 0.8}
    ready = running_in(cycles=3, steps=2, counterbody={"surface": plane | {"seed": 5, "renew": renew}})
    steps, further = estimates.rough_iterations(ready, sam.plan(ready))
    found = sam.solve(ready).cost["plastic_iterations"]
    assert found / 1.5 < estimates.ELASTIC_ITERATIONS * steps + further < 1.5 * found


def test_more_iterations_for_a_softer_layer_a_film_and_another_plane():
    def further(**keys) -> float:
        ready = running_in(cycles=8, **keys)
        return estimates.rough_iterations(ready, sam.plan(ready))[1]

    thick, plane = {"layer_thickness": 1e-6}, {"kind": "self-affine", "sq": 1e-9, "cutoff_long": 16e-6}
    plane |= {"cutoff_short": 8e-6, "hurst": 0.8, "seed": 5}
    soft = RUN_IN_STEEL | thick | {"layer": RUN_IN_STEEL | {"alpha": 1e3}}
    assert further(plasticity=soft) > 1.5 * further() > 3.0 * further(film=None)
    assert further(wear=0.02) < further(wear=0.002)
    same, other = (further(counterbody={"surface": plane | {"renew": renew}}) for renew in (False, True))
    assert other > 1.2 * same


def test_a_scene_that_hardly_yields_has_a_box():
    scene = growth.plastic((45,))[0].scene
    for force in (1e-6, 1e3, 0.0):
        loading = scene.loading.model_copy(update={"force": force})
        weak = scene.model_copy(
            update={"loading": loading, "grid": scene.grid.model_copy(update={"extent": (2e-5, 2e-5)})}
        )
        boxes = estimates.plastic_boxes(weak, choose_grid(weak))
        assert all(box.nx >= 1 and box.ny >= 1 and box.layers >= 1 for box in boxes)


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_yielding_body_without_a_load_has_an_estimate(model):
    none = scene(body={"plasticity": SWIFT}, loading={"force": 0.0})
    assert estimates.load_ratio(none, np.zeros(1))[0] == 0.0
    assert np.isfinite(estimates.estimate(none, model).time_s)


def test_factors_are_found_from_counts():
    counts = [{"a": a, "b": b} for a, b in np.random.default_rng(1).uniform(1e6, 1e8, (8, 2))]
    measured = [5 * each["a"] + 2 * each["b"] for each in counts]
    assert growth.fitted(counts, measured, 1.0) == pytest.approx({"a": 5.0, "b": 2.0}, rel=1e-6)


def test_every_count_has_a_factor():
    for make in growth.FAMILIES.values():
        for rung in make()[:1]:
            found = estimates.counted(rung.scene, rung.model)
            assert found.bytes.keys() <= estimates.MEMORY[rung.model].keys()
            assert found.work.keys() <= estimates.TIME[rung.model].keys()


def test_a_box_is_applied():
    box = growth.applied(6, 5, 3)
    assert box.cells == 90 and box.setup_s > 0 and box.apply_s > 0 and box.stored >= 36 * 9 * 30 * 4


def synthetic(power: float = 1.0) -> tuple[dict, dict]:
    """Measurements that grow as they should (their time to `power`) and are as the plan says."""
    found = {}
    for name, make in growth.FAMILIES.items():
        rungs = make()
        found[name] = []
        for k, rung in enumerate(rungs):
            size = rung.size or 1e4 * 3**k
            seconds = 1e-3 * (size if name == "cycles" else size / 1e3) ** power
            if name == "stresses":
                seconds *= 2
            taken = Taken(rung, size, seconds, 1, 1, True)
            found[name].append(replace(taken, memory=max(taken.expected.memory_bytes, 1)))
    boxes = {
        name: [
            Applied(
                nx, ny, nz, 1e-5 * nx * ny * nz, (1e-8 * nx * ny * nz**2) ** power, 8 * nx * ny, 9 * nx * ny
            )
            for nx, ny, nz in sizes
        ]
        for name, sizes in (("cells", case.BOXES), ("plane", case.PLANES), ("depth", case.DEPTHS))
    }
    return found, boxes


def verdicts(found, boxes, place: Path | None = None) -> dict:
    """The gates, judged; place: folder for the figures, which take most of the time. None: they are not
    written.
    """
    context = Context("growth", place or Path(), "full", lambda *_: None)
    if place is None:
        context.save = lambda *_, **__: None
    outcome = case.CASES[0].collect(context, case.Climbed(found, boxes))
    assert place is None or all((place / figure.png).is_file() for figure in outcome.figures)
    gates = [gate for gate in load_rows() if gate.case == "growth"]
    assert {gate.id for gate in gates} == outcome.values.keys()
    return {gate.id: judge(gate, outcome.values[gate.id]) for gate in gates}


def test_growth_as_it_should_be_passes(tmp_path):
    found, boxes = synthetic()
    judged = verdicts(found, boxes, tmp_path)
    red = [name for name, verdict in judged.items() if verdict.status.red and name != "growth.time-factor"]
    assert not red
    assert judged["growth.exponent-contact"].value == pytest.approx(1.0)
    assert judged["growth.memory-error"].value == pytest.approx(0.0, abs=1e-6)


def test_growth_that_is_too_fast_is_red():
    found, boxes = synthetic(power=1.4)
    judged = verdicts(found, boxes)
    for name in ("contact", "stresses", "operator", "cycles"):
        assert judged[f"growth.exponent-{name}"].status.red


def test_memory_that_was_not_predicted_and_a_solve_that_failed_are_red():
    found, boxes = synthetic()
    last = found["contact"][-1]
    found["contact"][-1] = replace(last, memory=round(1.25 * last.memory), converged=False)
    judged = verdicts(found, boxes)
    assert judged["growth.memory-error"].status.red and judged["growth.unconverged"].status.red


def test_the_case_is_of_the_full_level():
    assert all_cases()["growth"].levels == ("full",)
    assert {rung.model for rung in growth.finite_elements(FEM, (4,))} == {FEM}
