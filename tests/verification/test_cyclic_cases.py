# SPDX-License-Identifier: MIT
"""The cases of repeated loads on made results: the rows that turn red when a number is wrong, of the files of
the cases with what stands beside them.
"""

from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from made_results import Made, context, red

from sam.scene import FieldMesh
from verification.cases import all_cases
from verification.cases.cyclic import misfit_cycles, shakedown_limits
from verification.references import growing_sphere

LOADING, KEPT, SLIDING = "repeated-loading", "repeated-loading-kept", "repeated-sliding"
IN_PLACE, SPACE = "shakedown-limits", "shakedown-limits-space"
TOP = 0.481  # depth of the largest elastic stress on the axis in a: Johnson (1985), section 4.2


@dataclass(frozen=True)
class Judged(Made):
    """A made result with a verdict."""

    verdict: dict = field(default_factory=dict)


def judged(case: str, made, level: str = "full") -> set[str]:
    """The red rows of a case whose runs are those of made(model, scene)."""
    solver = context(case, Path(), level)
    solver.solve = lambda model, scene, label, demand=True: made(model, scene)
    return red(case, all_cases()[case].measure(all_cases()[case].solve(solver)), whole=True)


def pressed(scene, *, model, verdict="alternating", cell=3, **changed):
    """Strains over depth that err with the square of the width of cells and elements; those of a cycle fall
    to `closes`. changed: factors of all strains and of components, others by their names.
    """
    factor, shift, leak, closes = (
        changed.get(name, usual)
        for name, usual in (("factor", 1.0), ("shift", 0.0), ("leak", 0.0), ("closes", 0.5))
    )
    size, radius, cycles = scene.fem.cells_per_radius, scene.loading.radius, scene.loading.cycles
    z = (np.arange(2 * size) + 0.5) / size
    peeq = factor * 0.03 * np.exp(-((z - 0.5) ** 2) / 0.2) * (1 + (1 if model == "sam" else -1) / size**2)
    flow = 1e-3 * np.maximum(1 - ((z - TOP - shift) / 0.2) ** 2, 0)
    flow[-1] = leak
    axis = {"state": ["peak"] * z.size + ["unloaded"] * z.size, "z_m": np.tile(z, 2) * radius}
    axis["peeq"] = np.concatenate([peeq - flow, peeq])
    table = {"peeq_step_max": np.append([2e-2], np.full(cycles - 1, 1e-3))}
    table["strain_step_max"] = np.append([2e-2], np.linspace(1, closes, cycles - 1) * 1e-4)
    table["verdict"] = ["undecided"] * 3 + [verdict] * (cycles - 3)
    tensor = np.zeros((z.size, 6))
    for part, place, share in (("xx", 0, 0.3), ("zz", 2, -0.6), ("xz", 4, 0.2)):
        tensor[:, place] = share * peeq * changed.get(part, 1.0)
    data = {"peeq": peeq, "plastic_strain": tensor, "class": np.where(np.abs(z - 0.5) < 0.2, cell, 1)}
    mesh = FieldMesh(np.stack([0 * z, 0 * z, z * radius], axis=1), {}, point_data=data)
    said = {"class": verdict, "decided_at_cycle": 4}
    return Judged({"peeq_max": 0.0}, {"axis": axis, "cycles": table}, mesh, verdict=said)


def law_of(scene) -> str:
    return "prager" if len(scene.body.plasticity.kinematic.modulus) == 1 else "chaboche"


@pytest.mark.parametrize(("level", "wrong"), [("full", False), ("quick", True)])
def test_repeated_loading(level, wrong):
    changes = {
        ("sam", "prager"): {"shift": 0.06, "closes": 0.95, "verdict": "ratchetting"},
        ("fem-axisymmetric", "prager"): {"leak": 1e-9},
        ("fem-axisymmetric", "chaboche"): {"verdict": "settling"},
    }

    def made(model, scene):
        if scene.loading.p0 > 3.2e9:
            return pressed(scene, model=model, **changes.get((model, law_of(scene)), {}) if wrong else {})
        added = 1e-12 * wrong
        return Made({"peeq_max": added}, {"cycles": {"peeq_step_max": [2e-2, added, 0.0]}})

    seen = {"sam-depth", "sam-closes", "sam-alternates", "prager-class", "fem-elsewhere", "chaboche-class"}
    assert judged(LOADING, made, level) == (seen | {"below-yield", "below-melan"} if wrong else set())


@pytest.mark.parametrize(
    ("case", "steps", "wrong", "gates"),
    [
        (KEPT, 0, {}, ""),
        (KEPT, 12, {"factor": 1.006}, "peeq-limit plastic-strain-limit"),
        (
            *(KEPT, 6, {"factor": 1.03, "cell": 4, "verdict": "settling"}),
            "peeq plastic-strain peeq-limit plastic-strain-limit cells classes",
        ),
        (SLIDING, 0, {}, ""),
        (SLIDING, 4, {"xx": 1.1}, "xx"),
        (SLIDING, 4, {"factor": 1.2, "cell": 4, "verdict": "settling"}, "peeq xx zz xz cells class"),
    ],
)
def test_steps_floors_and_traction(case, steps, wrong, gates):
    """Finite elements with Prager's law and some load steps are wrong."""

    def made(model, scene):
        own = model != "sam" and law_of(scene) == "prager" and scene.loading.steps == steps
        return pressed(scene, model=model, **(wrong if own else {}))

    assert judged(case, made) == {f"prager-{gate}" for gate in gates.split()}


def strained(*strain: float, verdict: str = "alternating") -> Judged:
    return Judged(tables={"cycles": {"peeq_step_max": (1e-2, *strain)}}, verdict={"class": verdict})


@pytest.mark.parametrize("wrong", [False, True])
@pytest.mark.parametrize("case", [IN_PLACE, SPACE])
def test_shakedown_limits(case, wrong):
    """Strains on both sides of the limit of the load without friction, in space those of finite elements."""

    def made(model, scene):
        shear = scene.body.plasticity.yield_stress / np.sqrt(3.0)
        below = scene.loading.p0 < shakedown_limits.limit_of(scene) * shear
        if wrong and (model != "sam" if case == SPACE else scene.friction is None):
            return strained(*((1e-4, 1e-5) if below else (1e-3, 0.97e-3)), verdict="settling")
        return strained(1e-8, 0.0, verdict="shakedown") if below else strained(1e-3, 1e-3)

    seen = {IN_PLACE: "settles-0 steady-0 class-0", SPACE: "fem-settles fem-steady fem-below fem-above"}
    assert judged(case, made) == (set(seen[case].split()) if wrong else set())


exact_cycles = cache(misfit_cycles.cycled_sphere)
"""Each is asked for by both models and by the case."""


@pytest.mark.parametrize("wrong", [False, True])
def test_misfit_sphere_in_cycles(wrong, monkeypatch):
    """The exact strains and verdicts in both models; each run, known by its periods, wrong in its way."""
    monkeypatch.setattr(misfit_cycles, "REACHES", np.linspace(0.3, 3.0, 28))
    monkeypatch.setattr(misfit_cycles, "sphere_cells", lambda scene, size: scene)
    monkeypatch.setattr(misfit_cycles, "cycled_sphere", exact_cycles)
    changes = {
        ("sam", 30): {"peeq_step_max": 1.031},
        ("fem-axisymmetric", 30): {"strain_step_max": 0.969},
        ("fem-axisymmetric", 4): {"peeq_step_max": 0.969},
        ("sam", 4): {"verdict": ["undecided"] * 4},
        ("sam", 75): {"verdict": ["undecided"] * 52 + ["alternating"] * 23},
        ("fem-axisymmetric", 240): {"verdict": ["undecided"] * 240},
        ("sam", 240): {"verdict": ["ratchetting"] + ["alternating"] * 239},
    }

    def made(model, scene):
        periods, exact = scene.loading.cycles, exact_cycles(scene).values
        here = changes.get((model, periods), {}) if wrong else {}
        said = here.get("verdict", ["undecided"] * 3 + ["alternating"] * (periods - 3))
        table = {"verdict": said, "periods_to_decide": [4] * periods}
        for name, column in (("peeq", "peeq_step_max"), ("strain", "strain_step_max")):
            table[column] = np.append(1.0, exact[name]) * here.get(column, 1.0)
        return Made(tables={"cycles": table})

    seen = (
        "sam-af-5-peeq fem-af-5-strain fem-prager-5-peeq sam-prager-5-class sam-near-2-told fem-near-1-told"
    )
    assert judged("misfit-cycles-near", made) == ({*seen.split(), "ratchetting"} if wrong else set())


def test_the_exact_solution_of_a_period_is_that_of_the_closed_form():
    """A sphere that comes and goes twice: what the second period adds at the radius of the largest strain."""
    solver = context("misfit-cycles", Path(), "full")
    scene = misfit_cycles.above_limit(solver.scene("misfit-sphere"), (0.2, 90.0))
    loading = scene.loading.model_copy(update={"profile": "gauss", "cycles": 2})
    scene = scene.model_copy(update={"loading": loading})
    r = misfit_cycles.REACHES * loading.radius
    assert growing_sphere(scene).shares == (1.0,)  # it is put on alone
    _, once, _, twice = growing_sphere(scene, (1.0, 0.0) * 2).history(r)
    exact = misfit_cycles.cycled_sphere(scene).values
    assert exact["peeq"] == pytest.approx([(twice.peeq - once.peeq).max()], rel=1e-12)
    assert exact["strain"] == pytest.approx([np.abs(2 * (twice.plastic - once.plastic)).max()], rel=1e-12)
