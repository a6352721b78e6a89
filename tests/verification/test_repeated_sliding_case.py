# SPDX-License-Identifier: MIT
"""The case of repeated sliding: each of its gates turns red when a number is wrong."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from made_results import Made, red

from sam.scene import FieldMesh
from verification.cases import all_cases
from verification.cases.cyclic.repeated_sliding import CELLS, ELEMENTS, FINE, RADIUS, Both

CASE = "repeated-sliding"


@dataclass(frozen=True)
class Judged(Made):
    """A made result with a verdict."""

    verdict: dict = field(default_factory=lambda: {"class": "alternating"})


def made(size, *, elements=False, cell=3, verdict="alternating", **factors) -> Judged:
    """Strains over depth that err with the square of the width; factors: by quantity, the rest right."""
    z = np.tile((np.arange(2 * size) + 0.5) / size, 2)
    x = np.repeat([-0.5 / size, 0.5 / size], 2 * size) if elements else np.repeat([0.0, 1.0 / size], 2 * size)
    peeq = 0.05 * np.exp(-((z - 0.5) ** 2) / 0.2) * (1 + (1 if elements else -1) * 2 / size**2)
    tensor = np.zeros((z.size, 6))
    for name, part, share in (("xx", 0, 0.3), ("zz", 2, -0.6), ("xz", 4, 0.2)):
        tensor[:, part] = share * peeq * factors.get(name, 1.0)
    data = {"peeq": peeq * factors.get("peeq", 1.0), "plastic_strain": tensor}
    data["class"] = np.where(np.abs(z - 0.5) < 0.2, cell, 1)
    points = np.stack([x, 0 * x, z], axis=1) * RADIUS
    said = {"class": verdict}
    if not elements:
        return Judged(fields=FieldMesh(points, {}, point_data=data), verdict=said)
    mesh = FieldMesh(points, {"hexahedron": np.repeat(np.arange(z.size)[:, None], 8, axis=1)}, cell_data=data)
    return Judged(fields=mesh, verdict=said)


def found(**fem) -> dict[str, Both]:
    sam = {size: made(size) for size in CELLS}
    right = Both(sam, {size: made(size, elements=True) for size in ELEMENTS})
    wrong = Both(sam, {size: made(size, elements=True, **fem) for size in ELEMENTS})
    return {"prager": wrong, "chaboche": right}


def judged(of: dict[str, Both]) -> set[str]:
    values = all_cases()[CASE].values(of)
    return red(CASE, {gate.removeprefix(f"{CASE}."): value for gate, value in values.items()}, whole=True)


def test_right_numbers_hold_every_gate():
    assert judged(found()) == set()
    assert FINE == CELLS[1] == ELEMENTS[1]


@pytest.mark.parametrize(
    ("gate", "wrong"),
    [
        ("peeq", {"peeq": 1.03}),
        ("xx", {"xx": 1.1}),
        ("zz", {"zz": 0.95}),
        ("xz", {"xz": -1.0}),
        ("class", {"verdict": "settling"}),
        ("cells", {"cell": 4}),
    ],
)
def test_a_wrong_number_turns_its_gate_red(gate, wrong):
    assert judged(found(**wrong)) == {f"prager-{gate}"}
