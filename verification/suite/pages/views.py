# SPDX-License-Identifier: MIT
"""What the templates show of a case."""

from __future__ import annotations

import base64
import csv
import re
import struct
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from verification.judging import LIMITS, RowStatus
from verification.runs.files import SUMMARY
from verification.runs.store import short
from verification.suite.pages.stored import LIMIT_SIGNS, RED, ShownCase, share_used
from verification.suite.records import origin
from verification.text.console import number

WIDE = 1600  # pixels: letters of a picture drawn wider than 8 inches are too small in half a page
BRIEF = 60  # letters
_METRICS = {"relative_l2": "relative L2", "at_most": "at most", "at_least": "at least"}
NOT_CONFIRMED = "not confirmed"
_NUMBER = re.compile(r"[<>≤≥]? ?[+−-]?[0-9][^ ]*( [^ ]{1,4})?$")


@dataclass(frozen=True)
class Look:
    """How pages are written. folder: where; embed: figures inside the page; scenes: the folder of the scenes
    as the pages link it, empty where it is not near them.
    """

    folder: Path
    embed: bool = False
    scenes: str = ""


def case_view(each: ShownCase, look: Look, told: set[str], above: Collection[str] = ()) -> dict:
    """A case for the template. told: the equations that stand further up on the page; filled here; above:
    files of the figures that stand further up.
    """
    case, digest = each.case, each.case.get("code", "")[:12]
    equations = [tuple(row) for row in case["equations"]]
    new = [row for row in equations if row[1] not in told]
    told.update(row[1] for row in equations)
    figures = [figure_view(figure, look) for figure in case["figures"] if figure["png"] not in above]
    return {
        **case,
        "status": str(RowStatus.FAILED if each.failed else RowStatus.PASSED),
        "gates": sorted(each.gates, key=_first_what_failed),
        "red": len(each.red),
        "tightest": tightest(each),
        "equations": new,
        "equations_above": len(equations) - len(new),
        "figures": [figure for figure in figures if figure["embedded"]],
        "linked": [figure for figure in figures if not figure["embedded"]],
        "scenes": [(name, f"{look.scenes}/{name}" if look.scenes else "") for name in each.inputs],
        "runs": [run for run in case["runs"] if (look.folder / run / SUMMARY).is_file()],
        "works": works_of(case),
        "origin": f"{each.date[:10]}, {short(each.commit)}" + f", code {digest}" * bool(digest),
    }


@cache
def works() -> list[dict[str, str]]:
    """The literature: what finds it in the words of a case, a regular expression; its text; its DOI as public
    lists of references or its first page have it, NOT_CONFIRMED where none was found, empty without.
    """
    place = resources.files("verification.suite").joinpath("pages", "literature.csv")
    return list(csv.DictReader(place.read_text(encoding="utf-8").splitlines()))


def works_of(case: Mapping) -> list[tuple[str, str]]:
    """(citation, link) of what the question, the equations and the notes of a case refer to; no link without
    a confirmed DOI.
    """
    words = [text for row in case["equations"] for text in row]
    text, found = "\n".join([*words, case["question"], *case["notes"]]), []
    for work in works():
        doubt = work["doi"] == NOT_CONFIRMED
        if re.search(work["mark"], text):
            cited = work["text"] + f" (DOI {NOT_CONFIRMED})" * doubt
            found.append((cited, f"https://doi.org/{work['doi']}" if work["doi"] and not doubt else ""))
    return found


def tightest(each: ShownCase) -> str:
    """The gate that uses most of its tolerance."""
    shares = [(share, gate["quantity"]) for gate in each.gates if (share := share_used(gate)) is not None]
    share, quantity = max(shares, default=(0.0, ""))
    return f"{quantity}: {100 * share:.0f} %" if quantity else ""


def amount(gate: Mapping, value: float | None) -> str:
    """A computed or expected value with its unit; fields have no single value."""
    return f"{number(value, 6)} {gate['unit']}".rstrip()


def limit(gate: Mapping) -> str:
    """The tolerance with its sign."""
    return f"{LIMIT_SIGNS[LIMITS.get(gate['metric'], '<=')]} {number(gate['tolerance'])}"


def found(gate: Mapping) -> str:
    """What was found and what was asked, in short."""
    return f"{number(gate['error'], 3)} against {limit(gate)}"


def metric(name: str) -> str:
    """The name of a metric for the reader."""
    return _METRICS.get(name, name)


def _first_what_failed(gate: Mapping) -> tuple[bool, float]:
    return gate["status"] not in RED, -(share_used(gate) or 0.0)


def figure_view(figure: Mapping, look: Look) -> dict:
    """A figure for the template, with its size and the files that are there."""
    png = look.folder / figure["png"]
    data = figure.get("csv", "")
    files = [("PNG", figure["png"]), ("data, gzip" if data.endswith(".gz") else "data", data)]
    there = [(kind, path) for kind, path in files if path and (look.folder / path).is_file()]
    width, height = _size(png)
    inside = look.embed and figure["embedded"]
    return {
        **figure,
        "files": there,
        "findings": figure.get("findings", ()),
        "missing": not png.is_file(),
        "source": _embedded(png) if inside else figure["png"],
        "width": width,
        "height": height,
        "wide": width > min(2.2 * height, WIDE),
    }


def _size(png: Path) -> tuple[int, int]:
    """Width and height in pixels, as the head of the file has them; (0, 0) without the file."""
    try:
        with png.open("rb") as file:
            width, height = struct.unpack(">II", file.read(24)[16:])
    except (OSError, struct.error):
        return 0, 0
    return width, height


def _embedded(png: Path) -> str:
    """The picture as a data address, empty when the file is not there."""
    if not png.is_file():
        return ""
    return "data:image/png;base64," + base64.b64encode(png.read_bytes()).decode("ascii")


def numeric(table: Any) -> set[int]:
    """The columns that hold short numbers, which stand right: more than half of their cells."""
    rows = table["rows"] if isinstance(table, Mapping) else table.rows
    count = len(rows[0]) if rows else 0
    return {k for k in range(count) if 2 * sum(bool(_NUMBER.match(row[k])) for row in rows) > len(rows)}


def brief(caption: str) -> str:
    """A caption up to its first stop, in few words: for a line that names several."""
    head = re.split(r"(?<=.{15})[.:;] ", caption, maxsplit=1)[0]
    return head if len(head) <= BRIEF else f"{head[:BRIEF].rsplit(' ', 1)[0].rstrip(',')} …"


def markdown(table: Mapping) -> str:
    """A table as Markdown."""
    columns = table["columns"]
    rows = (columns, ["---"] * len(columns), *table["rows"])
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows)


def sources(results: Mapping) -> list[tuple[str, str]]:
    """Command, machine, versions and hashes as rows for the reader."""
    asked = {name: results[name] for name in ("command", "level") if name in results}
    if text := origin(results.get("solves")):
        asked["runs"] = text
    return list(_flat({**asked, **results["provenance"]}))


def _flat(tree: Mapping, prefix: str = "") -> Iterator[tuple[str, str]]:
    for key, value in tree.items():
        name = f"{prefix}{str(key).replace('_', ' ')}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{name}: ")
        elif isinstance(value, list | tuple):
            yield name, ", ".join(map(str, value)) or "none"
        else:
            yield name, "unknown" if value is None else str(value)
