# SPDX-License-Identifier: MIT
"""Results of cases that hand no data to the pages, as those of older versions: what others hand on
is read from their tables, here and nowhere else. When all published cases have `data`, this goes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

NO_QUANTITY = ("solution [s]", "its depth")  # a time, and a place that the mesh decides
NO_PAIRS = ("Refinement", "Strain that a cycle adds")
"""Begins of tables without pairs: rows that differ in the grid, and increments that fall to zero."""


def pairs_in(case: Mapping) -> Iterator[tuple[str, float, float]]:
    """(quantity, SAM, FEM) of the tables of a case: of rows of quantities with a column of each, or
    of the columns of largest values, and of cycles, of rows that differ in the model alone.
    """
    for table in case["tables"]:
        columns, rows = list(table["columns"]), table["rows"]
        if table["caption"].startswith(NO_PAIRS):
            continue
        found = []
        if {"quantity", "SAM", "FEM"} <= set(columns):
            at = name = columns.index("quantity")
            of_sam, of_fem = columns.index("SAM"), columns.index("FEM")
            found = [
                (row, row[name], row[of_sam], row[of_fem])
                for row in rows
                if not row[name].startswith(NO_QUANTITY)
            ]
        elif "model" in columns:
            at = columns.index("model")
            others = {tuple(row[:at]): row for row in rows if row[at] == "FEM"}
            found = [
                (row, column, *(each[k].removesuffix(" %") for each in (row, others[tuple(row[:at])])))
                for row in rows
                if row[at] == "SAM" and tuple(row[:at]) in others
                for k, column in enumerate(columns)
                if re.match(r"largest |cycle [0-9]+$", column)
            ]
        for row, words, *cells in found:
            sam, fem = map(number_in, cells)
            state = ", ".join(f"{columns[k]} = {row[k]}" for k in range(at))
            if math.isfinite(sam * fem) and sam * fem:
                yield f"{words} ({state})" if state else words, sam, fem


def times_in(case: Mapping) -> Iterator[tuple[str, str, dict[str, tuple[float | None, bool]]]]:
    """(contact, quantity, method -> seconds to an error of 1 %, None where that is not reached, and
    whether they are a bound) of the case that measured times.
    """
    quantities: dict[str, list[str]] = {}
    times: dict[str, dict] = {}
    for table in case["tables"]:
        columns = list(table["columns"])
        for row in table["rows"]:
            if columns[:2] == ["problem", "quantity (SI)"]:
                quantities.setdefault(row[0], []).append(row[1])
            elif columns[:2] == ["problem", "method"] and "1 %" in columns:
                text = row[columns.index("1 %")].split(" (")[0]
                seconds = number_in(text.lstrip("< "))
                of = times.setdefault(row[0], {})
                of[row[1]] = None if math.isnan(seconds) else seconds, text.startswith("<")
    for problem, of in times.items():
        yield problem, " and ".join(dict.fromkeys(quantities.get(problem, ()))), of


def number_in(cell: str) -> float:
    """The number of a cell, NaN where it is none."""
    try:
        return float(cell.replace("\N{MINUS SIGN}", "-").replace(",", ""))
    except ValueError:
        return math.nan
