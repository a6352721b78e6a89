# SPDX-License-Identifier: MIT
"""The cases of a sphere that moves: each of their gates turns red when a number is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import Made, red

from verification.cases import all_cases
from verification.cases.case import FEM_3D, SAM
from verification.cases.moving.moving_passes import Passes
from verification.cases.moving.moving_passes_spatial import BECOMES, Both, Found, Passed
from verification.cases.moving.moving_spatial import LADDER, Grooves, time_at
from verification.cases.moving.moving_sphere import Hertz, Moving, Start
from verification.cases.moving.moving_steps import AT, CELLS, FINE, NAMES, STEPS, Steps

SPHERE, PASSES, REFINED, SPATIAL = "moving-sphere", "moving-passes", "moving-steps", "moving-passes-spatial"
KEYS = ("groove", "deepest", "strain")


def judged(case: str, found) -> set[str]:
    """The red gates of what a case found."""
    values = all_cases()[case].values(found)
    return red(case, {gate.removeprefix(f"{case}."): value for gate, value in values.items()}, whole=True)


def sphere(**changes) -> Moving:
    """Numbers like those that were measured, some of them changed."""
    small = dict.fromkeys(("groove", "peeq", "force"), 1e-6)
    right = Moving(
        None,
        None,
        Hertz(9.4e-4, 4.6e-4, 3e-9, 3.7e-4),
        small,
        {"whole": 3e-7, "half": 5e-3},
        2e-3,
        2e-3,
        -3e-3,
        Start(0.31, 2.2, (0.05, 0.12), 0.72),
        2e-3,
    )
    return replace(right, **changes)


def hertz(**changes) -> Moving:
    return sphere(hertz=replace(sphere().hertz, **changes))


def start(**changes) -> Moving:
    return sphere(start=replace(sphere().start, **changes))


@pytest.mark.parametrize(
    "gate, wrong",
    [
        ("elastic-pressure", hertz(pressure=2.5e-3)),
        ("elastic-approach", hertz(approach=1.5e-3)),
        ("elastic-whole-cells", hertz(spread=1e-4)),
        ("elastic-force", hertz(drive=2e-3)),
        ("turned-groove", sphere(turned=sphere().turned | {"groove": 1e-4})),
        ("turned-peeq", sphere(turned=sphere().turned | {"peeq": 1e-4})),
        ("turned-force", sphere(turned=sphere().turned | {"force": 2.0})),
        ("shifted-whole", sphere(shifted={"whole": 1e-4, "half": 0.0})),
        ("shifted-half", sphere(shifted={"whole": 0.0, "half": 0.03})),
        ("steady", sphere(spread=0.02)),
        ("energy", sphere(energy=0.02)),
        ("rolling-energy", sphere(rolling=-0.02)),
        ("friction-energy", sphere(with_friction=0.03)),
        ("deepest-at-start", start(deepest=1.5)),
        ("transient", start(transient=3.2)),
        ("shoulders", start(shoulders=(0.0, 0.1))),
        ("shear-changes-sign", start(shear=-0.1)),
    ],
)
def test_a_wrong_number_of_a_track_turns_its_gate_red(gate, wrong):
    assert judged(SPHERE, wrong) == {gate}


STEEL = {
    "new_strain_max": (2.2e-3, 3.9e-4, 4.3e-5, 5.9e-6, 1.6e-6, 6e-7),
    "groove_m": (2.39, 2.51, 2.52, 2.528, 2.529, 2.529),
    "rolling": (1e-3, 1e-4, 2e-5, 2e-5, 2.03e-5, 2.00e-5),
}
SETTLES, FLOWS = (1.7e-3, 3.0e-4, 4.6e-5, 8.5e-6, 1.8e-6), (9e-3, 5e-3, 3.3e-3, 3.10e-3, 3.06e-3)


def run(*strains: float, quantities: float = 4.0, verdict: str = "", **columns) -> Made:
    table = STEEL | columns | ({"new_strain_max": strains} if strains else {})
    return Made({"passes_to_steady": quantities}, {"passes": table}, verdict={"class": verdict})


def passes(**changes) -> Passes:
    steel = {"one-way": run(), "to-and-fro": run()}
    perfect = {"settles": run(*SETTLES, verdict="shakedown"), "flows": run(*FLOWS, verdict="alternating")}
    right = Passes(steel, perfect, 1e9, 1e-6)
    return replace(right, **changes)


@pytest.mark.parametrize(
    "gate, wrong",
    [
        ("conservative", {"to-and-fro": run(rolling=(1e-3, 0.0, 0.0, 0.0, 2.3e-5, 2.0e-5))}),
        ("both-ways", {"to-and-fro": run(groove_m=(2.4, 2.5, 2.5, 2.5, 2.5, 2.6))}),
        ("steady", {"one-way": run(quantities=6.0)}),
        ("perfect-settles", {"settles": run(1.7e-3, 3.0e-4, 2e-4, 1e-5, 1e-6, verdict="shakedown")}),
        ("perfect-flows", {"flows": run(9e-3, 5e-3, 3e-3, 2e-3, 1e-3, verdict="alternating")}),
        ("verdict-settles", {"settles": run(*SETTLES, verdict="settling")}),
        ("verdict-flows", {"flows": run(*FLOWS, verdict="ratchetting")}),
    ],
)
def test_a_wrong_pass_turns_its_gate_red(gate, wrong):
    right = passes()
    steel = right.steel | {name: each for name, each in wrong.items() if name in right.steel}
    perfect = right.perfect | {name: each for name, each in wrong.items() if name in right.perfect}
    assert judged(PASSES, passes(steel=steel, perfect=perfect)) == {gate}


def steps(groove: float = 0.01, strain: float = 0.3, cells: float = 0.02, **changes) -> Steps:
    """Errors of first order in the step; those of the strain of a lower one. Relative ones of a step of a
    radius, and of cells of a/8. A single run errs by 3 %, and knows 10 %.
    """
    by_steps, by_cells = {}, {}
    for n in STEPS:
        others = (0.98 - each / n for each in (0.1, 0.2, 0.3))
        by_steps[n] = 1 - groove / n, 1 - strain / n**0.8, *others
    for n in CELLS:
        others = (value + 0.02 * (1 - (AT / n) ** 2) for value in by_steps[FINE][2:])
        by_cells[n] = 1 - cells * (CELLS[1] / n) ** 2, 1.0, *others
    return replace(Steps(by_steps, by_cells, dict.fromkeys(NAMES, (0.97, 0.1)), 1.0), **changes)


def less(which: int, change: float, *sizes: int) -> dict[int, tuple[float, ...]]:
    """Values by steps of which one is lower in some sizes."""
    found = dict(steps().by_steps)
    for n in sizes:
        found[n] = tuple(v - change * (k == which) for k, v in enumerate(found[n]))
    return found


def known(**values: tuple[float, float]) -> dict[str, tuple[float, float]]:
    """A single run with other values and uncertainties."""
    return {**steps().single, **values}


@pytest.mark.parametrize(
    "gate, wrong",
    [
        ("groove-quarter", steps(groove=0.1)),
        ("peeq-eighth", steps(strain=0.6)),
        ("cells", steps(cells=0.1)),
        *((f"extrapolated-{key}", steps(by_steps=less(2 + k, 0.03, 4))) for k, key in enumerate(KEYS)),
        *((f"covered-{key}", steps(single=known(**{NAMES[k]: (0.97, 0.02)}))) for k, key in enumerate(KEYS)),
    ],
)
def test_a_coarse_step_turns_its_gate_red(gate, wrong):
    assert judged(REFINED, wrong) == {gate}


def both(energy: float = 0.0, strain: float = 0.0, verdict: str = "shakedown", floor: float = 7e-5) -> Both:
    """Four passes; what the second one of the finite elements does more, in units of the first one."""
    right = Passed((4.0, 0.2, 0.03, 0.004), (6e-3, 3e-4, 4e-5, 5e-6), floor, "shakedown", 2.4e9)
    other = replace(
        right,
        energy=(4.0, 0.2 + 4.0 * energy, 0.03, 0.004),
        strain=(6e-3, 3e-4 + 6e-3 * strain, 4e-5, 5e-6),
        verdict=verdict,
    )
    return Both(dict.fromkeys((8, 12), right), dict.fromkeys((4, 6), other))


def in_space(**laws: Both) -> Found:
    """What the case finds, with another pair of models of a law."""
    many = {ratio: Made(verdict={"class": name}) for ratio, name in BECOMES.items()}
    return Found({"swift": both(), "prager": both()} | laws, many)


@pytest.mark.parametrize(
    "law, gates, wrong",
    [
        ("swift", {"energy", "own-energy"}, both(0.06)),
        ("swift", {"strain", "own-strain"}, both(0.0, 0.06)),
        ("swift", {"own-energy"}, both(0.005)),
        ("swift", {"own-strain"}, both(0.0, 0.005)),
        ("swift", {"verdict"}, both(verdict="settling")),
        ("swift", {"counted"}, both(floor=1e-3)),
        ("prager", {"verdict"}, both(verdict="alternating")),
        ("prager", {"energy"}, both(0.06)),
    ],
)
def test_a_pass_that_differs_between_the_models_turns_its_gates_red(law, gates, wrong):
    assert judged(SPATIAL, in_space(**{law: wrong})) == {f"{law}-{gate}" for gate in gates}


@pytest.mark.parametrize("ratio", BECOMES)
def test_another_verdict_after_many_passes_turns_its_gate_red(ratio):
    many = in_space().many | {ratio: Made(verdict={"class": "settling"})}
    assert judged(SPATIAL, replace(in_space(), many=many)) == {f"many-{ratio:g}"}


def ladder(model: str, *, depth: float = 1.0, most: float = 1.0, strain: float = 1.0) -> dict[int, Made]:
    """Runs of second order, whose limits are these."""
    runs = {}
    for n in LADDER[model]:
        off, x = 1 - 1 / n**2, np.linspace(-2.0, 2.0, 9)
        values = {"groove_deepest_m": most * off, "peeq_max": strain * off}
        track = {"x_m": x, "uz_m": depth * off * (1 + 0.1 * np.abs(x))}
        runs[n] = Made(values, {"track": track}, cost={"cpu_s": n**3 * (1.0 if model == SAM else 10.0)})
    return runs


@pytest.mark.parametrize(
    "gates, wrong",
    [
        ({"groove", "groove-refined"}, {"depth": 1.08}),
        ({"groove-refined"}, {"depth": 1.03}),
        ({"deepest-refined"}, {"most": 1.03}),
        ({"strain-refined"}, {"strain": 1.03}),
        (set(), {}),
    ],
)
def test_a_groove_that_differs_between_the_models_turns_its_gate_red(gates, wrong):
    found = Grooves({SAM: ladder(SAM), FEM_3D: ladder(FEM_3D, **wrong)}, 1.0)
    assert judged("moving-spatial", found) == gates


def test_times_are_compared_at_the_same_error():
    """Both models err alike here, so that finite elements take ten times as long, at any error."""
    found = Grooves({model: ladder(model) for model in LADDER}, 1.0)
    for run in found.precision(FEM_3D):
        assert run.worst == pytest.approx(1 / run.size**2)
        assert run.cpu_s / time_at(run.worst, found.precision(SAM)) == pytest.approx(10.0)
    assert np.isnan(time_at(1e-6, found.precision(SAM)))


def test_right_numbers_hold_every_gate():
    assert judged(SPHERE, sphere()) == judged(PASSES, passes()) == judged(REFINED, steps()) == set()
    assert judged(SPATIAL, in_space()) == set()
