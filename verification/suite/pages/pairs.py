# SPDX-License-Identifier: MIT
"""Every number of SAM beside its reference: the pairs of the picture on the first page."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch

from verification.suite.pages.groups import group_of
from verification.suite.pages.stored import ShownCase, Stored

FEM, EXACT = "finite elements", "closed form or published value"
NOT_OF_SAM = ("spatial-*", "model-limits*", "film-yield.*", "growth.*", "work-precision.*")
"""Gates that hold two other things against each other, finite elements or times."""
NO_QUANTITY = ("solution [s]", "its depth")  # a time, and a place that the mesh decides
NO_PAIRS = ("Refinement", "Strain that a cycle adds")
"""Begins of tables without pairs: rows that differ in the grid, and increments that fall to zero."""
LARGEST = re.compile(r"largest |cycle [0-9]+$")
SIGNS = str.maketrans({"−": "-", ",": ""})


@dataclass(frozen=True)
class Pair:
    """A value of SAM and its reference, with the unit of both unsaid: what counts is their ratio; gate: that
    holds it, None where only a table has it.
    """

    case: ShownCase
    quantity: str
    against: str
    predicted: float
    reference: float
    gate: Mapping | None = None

    @property
    def error(self) -> float:
        """Of the ratio from one, with its sign."""
        return self.predicted / self.reference - 1.0

    @property
    def page(self) -> str:
        """Title of the page where its case stands."""
        return group_of(self.case.name).title


def pairs_of(stored: Stored) -> list[Pair]:
    """The pairs of all gates in the metric `relative`, and of the tables of quantities of the cases, each
    once.
    """
    found = []
    for each in stored.ran.values():
        gated = list(_gated(each))
        known = {round(pair.error, 4) for pair in gated}
        found += gated + [pair for pair in tabled(each) if round(pair.error, 4) not in known]
    return found


def _gated(each: ShownCase) -> Iterator[Pair]:
    for gate in each.gates:
        words = gate["quantity"]
        if gate["metric"] != "relative" or any(fnmatch(gate["id"], name) for name in NOT_OF_SAM):
            continue
        if "FEM" in words and "SAM" not in words:
            continue
        if gate["value"] and gate["expected"]:
            yield Pair(each, words, FEM if "FEM" in words else EXACT, gate["value"], gate["expected"], gate)


def tabled(each: ShownCase) -> Iterator[Pair]:
    """What the tables of a case hold side by side: rows of quantities with a column of SAM and one of FEM, or
    rows of models.
    """
    for table in each.case["tables"]:
        columns = list(table["columns"])
        if table["caption"].startswith(NO_PAIRS):
            continue
        if {"quantity", "SAM", "FEM"} <= set(columns):
            yield from _side_by_side(each, columns, table["rows"])
        elif "model" in columns:
            yield from _one_below_the_other(each, columns, table["rows"])


def _side_by_side(each: ShownCase, columns: list[str], rows: Sequence[Sequence[str]]) -> Iterator[Pair]:
    name, sam, fem = map(columns.index, ("quantity", "SAM", "FEM"))
    for row in rows:
        if not row[name].startswith(NO_QUANTITY):
            yield from _pair(each, row[name], _state(columns, row, name), (row[sam], row[fem]))


def _one_below_the_other(
    each: ShownCase, columns: list[str], rows: Sequence[Sequence[str]]
) -> Iterator[Pair]:
    """Columns of largest values, and of cycles, of the rows that differ in the model alone."""
    at = columns.index("model")
    of_fem = {tuple(row[:at]): row for row in rows if row[at] == "FEM"}
    for row in rows:
        other = of_fem.get(tuple(row[:at]))
        if row[at] == "SAM" and other:
            for k, column in enumerate(columns):
                if LARGEST.match(column):
                    yield from _pair(each, column, _state(columns, row, at), (_bare(row[k]), _bare(other[k])))


def _bare(cell: str) -> str:
    return cell.removesuffix(" %")


def _state(columns: Sequence[str], row: Sequence[str], before: int) -> str:
    """What the first cells of a row say, as `μ = 0.2`."""
    said = ", ".join(f"{columns[k]} = {row[k]}" for k in range(before))
    return f" ({said})" if said else ""


def _pair(each: ShownCase, name: str, state: str, cells: tuple[str, str]) -> Iterator[Pair]:
    sam, fem = map(number_in, cells)
    if math.isfinite(sam * fem) and sam * fem:
        yield Pair(each, name + state, FEM, sam, fem)


def number_in(cell: str) -> float:
    """The number of a cell, NaN where it is none."""
    try:
        return float(cell.translate(SIGNS))
    except ValueError:
        return math.nan
