# SPDX-License-Identifier: MIT
"""The numbers of README.md and of pages of the guide, from the published results: `python -m
verification.suite.readme` (make readme).

A row of a table that names a gate gets the value of that gate, with as many digits as before; what stands
between the two marks, in a file that has them, is written anew: the gates that failed, and the answer about
running-in.
"""

import math
import re
import sys
import textwrap
from collections.abc import Mapping
from pathlib import Path

from verification.judging import RowStatus
from verification.runs.files import FolderError, write_atomically
from verification.suite.pages.headline import headline_of
from verification.suite.pages.site import found
from verification.suite.pages.stored import RED, read_stored
from verification.suite.verify import finished

BEGIN, END = "<!-- Written by `make readme`. -->", "<!-- Up to here. -->"
ROW = re.compile(r"\| ([0-9.]+) (%|times) \| `([a-z0-9.-]+)` \|")
COUNTS = ("No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten")
WIDTH = 118


def renewed(text: str, results: Mapping) -> str:
    """The text with the numbers of the results. ValueError for a gate that failed or a wrong mark."""
    gates = {gate["id"]: gate for gate in results["gates"]}
    marks = text.count(BEGIN), text.count(END)
    if marks not in ((0, 0), (1, 1)):
        raise ValueError(f"the text must hold once each: {BEGIN} and {END}")

    def row(match: re.Match) -> str:
        printed, unit, name = match.groups()
        gate = gates.get(name)
        if gate is None or gate["status"] != RowStatus.PASSED:
            state = gate["status"] if gate else "no gate"
            raise ValueError(f"{name}: {state}; the row needs a gate that passed")
        value = gate["error"] * (100 if unit == "%" else 1)
        digits = len(printed.replace(".", "").lstrip("0"))
        after = digits - 1 - math.floor(math.log10(value)) if value > 0.0 else 0
        return f"| {value:.{max(after, 0)}f} {unit} | `{name}` |"

    text = ROW.sub(row, text)
    if marks == (0, 0):
        return text
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}\n{_written(results)}\n{END}{rest.split(END)[1]}"


def _written(results: Mapping) -> str:
    """As items: the gates and the cases that failed, and what the pages say of running-in."""
    stored = read_stored(results)
    items = [_failed(results)]
    if stored.broken:
        named = ", ".join(f"`{each.name}`" for each in stored.broken)
        items.append(f"Cases that broke off or have a figure that cannot be read: {named}.")
    headline = headline_of(stored)
    if headline:
        link = f"[Does the model of running-in predict what its authors say?](reports/{headline.page})"
        items.append(f"{link} {headline.brief or headline.answer}")
    return "\n".join(
        textwrap.fill(f"- {each}", WIDTH, subsequent_indent="  ", break_on_hyphens=False) for each in items
    )


def _failed(results: Mapping) -> str:
    red = [gate for gate in results["gates"] if gate["status"] in RED]
    count = COUNTS[len(red)] if len(red) < len(COUNTS) else str(len(red))
    if not red:
        return "Every gate of the published pages holds."
    named = "; ".join(f"`{gate['id']}` ({found(gate)})" for gate in red)
    return f"{count} gate{'s fail' if len(red) > 1 else ' fails'} on the published pages: {named}."


def main(reports: Path, *pages: Path) -> int:
    """Write the files anew; 2 where one of them or the results are not as they must be."""
    try:
        results = finished(reports)
        texts = {page: renewed(page.read_text(encoding="utf-8"), results) for page in pages}
    except (FolderError, OSError, ValueError) as problem:
        print(f"samfem: error: {problem}", file=sys.stderr)
        return 2
    for page, text in texts.items():
        write_atomically(page, text.encode())
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
