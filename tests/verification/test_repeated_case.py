# SPDX-License-Identifier: MIT
"""The cases of repeated loading: each of their gates turns red when a number is wrong."""

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from made_results import Made, red

from sam.scene import FieldMesh
from verification.cases import all_cases
from verification.cases.cyclic import misfit_cycles
from verification.cases.cyclic.repeated_loading import (
    NESTED,
    RADIUS,
    STEPS,
    VARIED,
    Both,
    Found,
    Kept,
    where_beyond,
)

CASE, KEPT = "repeated-loading", "repeated-loading-kept"
TOP = where_beyond(3.4e9)[0]
CYCLES = 12


@dataclass(frozen=True)
class Judged(Made):
    """A made result with a verdict."""

    verdict: dict = field(default_factory=lambda: {"class": "alternating", "decided_at_cycle": 4})


def made(size=9, *, factor=1.0, shift=0.0, leak=0.0, closes=0.5, verdict="alternating", cell=3) -> Judged:
    """Strains over depth on cells of a/size, as one function of it; those of a cycle fall to `closes`."""
    z = (np.arange(2 * size) + 0.5) / size
    peeq = factor * 0.03 * np.exp(-((z - 0.5) ** 2) / 0.2)
    flow = 1e-3 * np.maximum(1 - ((z - TOP - shift) / 0.2) ** 2, 0)
    flow[-1] = leak
    axis = {"state": ["peak"] * z.size + ["unloaded"] * z.size, "z_m": np.tile(z, 2) * RADIUS}
    axis["peeq"] = np.concatenate([peeq - flow, peeq])
    strain = np.append([2e-2], np.linspace(1, closes, CYCLES - 1) * 1e-4)
    steps = np.append([2e-2], np.full(CYCLES - 1, 1e-3))
    names = ["undecided"] * 3 + [verdict] * (CYCLES - 3)
    cycles = {"peeq_step_max": steps, "strain_step_max": strain, "verdict": names}
    points = np.stack([0 * z, 0 * z, z * RADIUS], axis=1)
    tensor = np.zeros((z.size, 6))
    tensor[:, 2] = -peeq
    data = {"peeq": peeq, "plastic_strain": tensor, "class": np.where(np.abs(z - 0.5) < 0.2, cell, 1)}
    mesh = FieldMesh(points, {}, point_data=data)
    said = {"class": verdict, "decided_at_cycle": 4}
    return Judged({"peeq_max": 0.0}, {"axis": axis, "cycles": cycles}, mesh, verdict=said)


def still(added=0.0) -> Made:
    return Made({"peeq_max": added}, {"cycles": {"peeq_step_max": [2e-2, added, 0.0]}})


def right(sam=None, fem=None, chaboche=None) -> Found:
    """Numbers with which every gate holds, but for the results that are given."""
    pairs = {
        "prager": Both({9: sam or made()}, {9: fem or made()}),
        "chaboche": Both({9: made()}, {9: chaboche or made()}),
    }
    return Found(still(), still(), pairs)


def kept(fine=None, floor=None, **fem) -> Kept:
    """fine: keys of the finer cells of SAM with twice the steps; floor: of a run with another floor."""
    sam = {size: made(size) for size in NESTED.cells}
    finer = sam | {max(NESTED.cells): made(max(NESTED.cells), **(fine or {}))}
    elements = {size: made(size, **fem) for size in NESTED.elements}
    by_steps = {STEPS: Both(sam, elements), 2 * STEPS: Both(finer, elements)}
    varied = {name: made(5, **(floor or {})) for name in VARIED}
    pairs = {"prager": by_steps, "chaboche": {n: Both(sam, sam) for n in by_steps}}
    return Kept(pairs, dict.fromkeys(pairs, varied))


def judged(case: str, found) -> set[str]:
    values = all_cases()[case].values(found)
    return red(case, {gate.removeprefix(f"{case}."): value for gate, value in values.items()}, whole=True)


def test_right_numbers_hold_every_gate():
    assert judged(CASE, right()) == judged(KEPT, kept()) == set()


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        ({"below-yield"}, replace(right(), below=still(1e-12))),
        ({"below-melan"}, replace(right(), shaken=still(1e-12))),
        ({"sam-depth"}, right(made(shift=0.06))),
        ({"fem-elsewhere"}, right(fem=made(leak=1e-9))),
        ({"sam-closes"}, right(made(closes=0.95))),
        ({"sam-alternates", "prager-class"}, right(made(verdict="ratchetting"))),
        ({"fem-alternates", "prager-class"}, right(fem=made(verdict="settling"))),
        ({"chaboche-class"}, right(chaboche=made(verdict="settling"))),
    ],
    ids=lambda part: "-".join(sorted(part)) if isinstance(part, set) else "",
)
def test_a_wrong_number_turns_its_gate_red(gates, wrong):
    assert judged(CASE, wrong) == gates


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        ({"peeq-limit", "plastic-strain-limit"}, kept(fine={"factor": 1.006})),
        ({"peeq", "plastic-strain", "peeq-limit", "plastic-strain-limit"}, kept(factor=1.03)),
        ({"cells"}, kept(cell=4)),
        ({"classes"}, kept(floor={"verdict": "settling"})),
    ],
    ids=lambda part: "-".join(sorted(part)) if isinstance(part, set) else "",
)
def test_a_wrong_limit_or_class_turns_its_gate_red(gates, wrong):
    found = judged(KEPT, wrong)
    assert {gate.removeprefix("prager-") for gate in found if gate.startswith("prager-")} == gates
    assert found - {f"prager-{gate}" for gate in gates} <= {"chaboche-classes"}


NEAR = "misfit-cycles-near"


def near(name="", *, model="sam", **wrong):
    """The exact strains in both models, decided and told as exactly, but for one run. wrong: of it the share
    of a column, or its list of verdicts.
    """
    (case,) = (each for each in misfit_cycles.CASES if each.name == NEAR)
    found = {}
    for label, run in (case.strains | case.near).items():
        exact, results = run.exact(), {}
        for of in misfit_cycles.MODELS:
            here = wrong if (label, of) == (name, model) else {}
            said = here.get("verdict", ["undecided"] * 3 + ["alternating"] * (run.cycles - 3))
            rows = dict(zip(("peeq_step_max", "strain_step_max"), exact, strict=True))
            rows = {column: values * here.get(column, 1.0) for column, values in rows.items()}
            results[of] = Made(
                tables={"cycles": rows | {"verdict": said, "periods_to_decide": [4] * run.cycles}}
            )
        found[label] = misfit_cycles.Found(run, exact, results)
    return found


@pytest.mark.parametrize(
    ("gates", "wrong"),
    [
        (set(), {}),
        ({"sam-af-5-peeq"}, {"name": "af-5", "peeq_step_max": 1.031}),
        ({"fem-af-5-strain"}, {"name": "af-5", "model": "fem", "strain_step_max": 0.969}),
        ({"fem-prager-5-peeq"}, {"name": "prager-5", "model": "fem", "peeq_step_max": 0.969}),
        ({"sam-prager-5-class"}, {"name": "prager-5", "verdict": ["undecided"] * 4}),
        ({"sam-near-2-told"}, {"name": "near-2", "verdict": ["undecided"] * 52 + ["alternating"] * 23}),
        ({"fem-near-1-told"}, {"name": "near-1", "model": "fem", "verdict": ["undecided"] * 240}),
        ({"ratchetting"}, {"name": "near-1", "verdict": ["ratchetting"] + ["alternating"] * 239}),
        ({"ratchetting", "sam-af-5-class"}, {"name": "af-5", "verdict": ["ratchetting"] * 30}),
    ],
    ids=lambda part: "-".join(sorted(part)) if isinstance(part, set) else "",
)
def test_a_wrong_misfit_sphere_in_cycles_turns_its_gate_red(gates, wrong):
    assert judged(NEAR, near(**wrong)) == gates
