# SPDX-License-Identifier: MIT
"""The pages: an index, a page for each group of cases that ran, the index as Markdown, or all in one file."""

import base64
import csv
import os
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from PIL import Image

from verification.judging import LIMITS, RowStatus
from verification.runs.files import SUMMARY, write_atomically
from verification.runs.store import short
from verification.suite.pages.answers import (
    Answer,
    Evidence,
    answers_of,
    far,
    first_numbers,
    kind_of,
    of_fields,
    origins,
    pairs_of,
    percent,
    sentence,
    unanswered,
)
from verification.suite.pages.headline import PAGE, headline_of
from verification.suite.pages.stored import (
    GROUPS,
    LIMIT_SIGNS,
    PAGES,
    RED,
    ShownCase,
    Stored,
    group_of,
    page_of,
    read_stored,
    share_used,
)
from verification.suite.records import origin
from verification.text.console import number
from verification.text.readable import with_time

ROOT = Path(__file__).resolve().parents[3]
INDEX, README = "index.html", "README.md"
ONE_FILE = "report.html"
PICTURE = "figures/agreement"
WORDS = {
    "verification": {"title": "Verification of samfem", "lead": "", "case": "Case", "gate": "gate"},
    "comparison": {
        "title": "Comparison of SAM and FEM",
        "lead": "Each scene is described once. The semi-analytical method (SAM) and finite elements (FEM) "
        "solve it without sharing any physics code, and the results are compared. Data of the user, where "
        "there are any, are the expected values for SAM.",
        "case": "Scene",
        "gate": "row",
    },
}
"""What a page is about, by its kind."""
WIDE = 1600  # pixels: letters of a picture drawn wider than 8 inches are too small in half a page
SIGNS = {
    ">=": "≥",
    "<=": "≤",
    r"\bmu\b": "μ",
    r"\bsigma_": "σ_",
    r"\bs(?=[xyz]{2}\b)": "σ_",
    r"\bp0\b": "p₀",
    r"(?<=[0-9] )um\b": "µm",
    r" %": "\N{NO-BREAK SPACE}%",
}
"""What is written in ASCII, as a pattern -> its sign."""
IN_TEXT = re.compile(r"(?<![\w])([A-Za-zσετνμκδ])_([A-Za-z0-9]+)\b")
LOWERED = re.compile(r"(?<![a-z]{4})(?<=\w)_([A-Za-z0-9]+)|(?<=[σε])([xyz]{2})")
"""What is a subscript in a formula, where a word of four letters before the dash is the name of a key."""
RAISED = re.compile(r"\^(\((?:[^()]|\([^()]*\))*\)|\{[^}]*\}|[−-]?[\w.]+)")
_NUMBER = re.compile(r"[<>≤≥]? ?[+−-]?[0-9][^ ]*( [^ ]{1,4})?$")


@dataclass(frozen=True)
class Look:
    """How pages are written. folder: where; place: where it will stand; embed: figures inside the page."""

    folder: Path
    embed: bool = False
    place: Path | None = None

    def to(self, place: str) -> str:
        """A file of the repository as the pages link it; empty elsewhere: a link would name a place."""
        here = (self.place or self.folder).resolve()
        return Path(os.path.relpath(ROOT / place, here)).as_posix() if here.is_relative_to(ROOT) else ""


def case_view(each: ShownCase, look: Look) -> dict:
    """A case for the template."""
    tight = [(share, gate["quantity"]) for gate in each.gates if (share := share_used(gate)) is not None]
    case, digest = each.case, each.case.get("code", "")[:12]
    return {
        **case,
        "status": str(RowStatus.FAILED if each.failed else RowStatus.PASSED),
        "gates": sorted(each.gates, key=lambda gate: (gate["status"] not in RED, -(share_used(gate) or 0.0))),
        "red": len(each.red),
        "tightest": f"{max(tight)[1]} ({100 * max(tight)[0]:.0f} % of the tolerance used)" if tight else "",
        "figures": [figure_view(figure, look) for figure in case["figures"]],
        "scenes": [(name, look.to(f"verification/scenes/{name}")) for name in each.inputs],
        "runs": [run for run in case["runs"] if (look.folder / run / SUMMARY).is_file()],
        "works": works_of(case),
        "origin": f"{each.date[:10]}, {short(each.commit)}" + f", code {digest}" * bool(digest),
    }


@cache
def works() -> list[dict[str, str]]:
    """The literature: what finds it in the words of a case, a regular expression; its text; its DOI as public
    lists of references or its first page have it, empty where none was found.
    """
    place = resources.files("verification.suite").joinpath("pages", "literature.csv")
    return list(csv.DictReader(place.read_text(encoding="utf-8").splitlines()))


def works_of(case: Mapping) -> list[tuple[str, str]]:
    """(citation, link) of what the question, the equations and the notes of a case refer to."""
    words = [text for row in case["equations"] for text in row]
    text = "\n".join([*words, case["question"], *case["notes"]])
    return [
        (work["text"], f"https://doi.org/{work['doi']}" if work["doi"] else "")
        for work in works()
        if re.search(work["mark"], text)
    ]


def amount(gate: Mapping, value: float | None) -> str:
    """A computed or expected value with its unit; fields have no single value."""
    return f"{number(value, 6)} {gate['unit']}".rstrip()


def limit(gate: Mapping) -> str:
    """The tolerance with its sign."""
    return f"{LIMIT_SIGNS[LIMITS.get(gate['metric'], '<=')]} {number(gate['tolerance'])}"


def found(gate: Mapping) -> str:
    """What was found and what was asked, in short."""
    return f"{number(gate['error'], 3)} against {limit(gate)}"


def figure_view(figure: Mapping, look: Look) -> dict:
    """A figure for the template, with its size and the files that are there."""
    png = look.folder / figure["png"]
    data = figure.get("csv", "")
    files = [("PNG", figure["png"]), ("data, gzip" if data.endswith(".gz") else "data", data)]
    there = [(kind, path) for kind, path in files if path and (look.folder / path).is_file()]
    width, height = _size(png)
    source = figure["png"]
    if look.embed:
        content = base64.b64encode(png.read_bytes()).decode("ascii") if png.is_file() else ""
        source = content and f"data:image/png;base64,{content}"
    return {
        **figure,
        "files": there,
        "findings": figure.get("findings", ()),
        "missing": not png.is_file(),
        "source": source,
        "width": width,
        "height": height,
        "wide": width > min(2.2 * height, WIDE),
    }


def _size(png: Path) -> tuple[int, int]:
    """Width and height in pixels; (0, 0) without the file."""
    if not png.is_file():
        return 0, 0
    with Image.open(png) as picture:
        return picture.size


def with_scripts(text: str) -> Markup:
    """A sentence in which σ_y0 has its subscript, and what is written in ASCII its sign."""
    for pattern, sign in SIGNS.items():
        text = re.sub(pattern, sign, text)
    return Markup(IN_TEXT.sub(r"\1<sub>\2</sub>", str(escape(text))))


def formula(text: str) -> Markup:
    """A line of formulas, in which what follows `_` or `^`, by itself or in brackets, is a script."""

    def raised(found: re.Match[str]) -> str:
        power = found[1][1:-1] if found[1][0] in "({" else found[1]
        return f"<sup>{RAISED.sub(raised, power)}</sup>"

    lowered = LOWERED.sub(lambda found: f"<sub>{found[1] or found[2]}</sub>", str(escape(text)))
    return Markup(RAISED.sub(raised, lowered))


def numeric(table: Mapping) -> set[int]:
    """The columns that hold short numbers, which stand right: more than half of their cells."""
    rows = table["rows"]
    count = len(rows[0]) if rows else 0
    return {k for k in range(count) if 2 * sum(bool(_NUMBER.match(row[k])) for row in rows) > len(rows)}


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


FILTERS = {
    "number": number,
    "amount": amount,
    "found": found,
    "limit": limit,
    "formula": formula,
    "scripts": with_scripts,
    "time": with_time,
    "kind_of": kind_of,
    "percent": percent,
    "unanswered": unanswered,
    "page_of": page_of,
    "numeric": numeric,
    "sources": sources,
}
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")  # not allowed in HTML


def write_report(
    results: Mapping,
    folder: Path,
    *,
    single_file: bool = False,
    stale: Mapping[str, str] | None = None,
    place: Path | None = None,
) -> Path:
    """Write the pages of results into the folder of their figures; returns the one to open. single_file: also
    report.html with everything inside, which is all there is of a comparison; stale: name -> why a case is
    older than the code, which is marked; place: where the folder will stand.
    """
    alone = results.get("kind") == "comparison"
    if not alone:
        _write_pages(read_stored(results, stale), Look(folder, place=place))
    if alone or single_file:
        stored, look = read_stored(results), Look(folder, embed=True)
        cases = [case_view(each, look) for each in _ordered(stored.ran.values())]
        page = _page("single.html.j2", stored, look, cases=cases, origins=origins(stored.ran.values()))
        write_atomically(folder / ONE_FILE, page.encode())
    return folder / (ONE_FILE if alone or single_file else INDEX)


def _write_pages(stored: Stored, look: Look) -> None:
    """Write index.html, README.md and a page for each group; report.html leads to the index."""
    evidence = Evidence(stored, pairs_of(stored))
    answers = answers_of(evidence)
    pages = {}
    for group, cases in _groups(stored):
        pages[f"{group['name']}.html"] = _page(
            "group.html.j2",
            stored,
            look,
            headline=headline_of(stored) if group["name"] == PAGE else None,
            answers=[each for each in answers if each.question["page"] == group["name"]],
            group=group,
            cases=[case_view(each, look) for each in cases],
            waiting=[row for row in stored.waiting if group_of(row[0]) == group],
            origins=origins(cases),
        )
    for name, template in ((INDEX, "index.html.j2"), (README, "README.md.j2"), (ONE_FILE, "moved.html.j2")):
        pages[name] = _index(template, evidence, answers, look)
    remove_pages(look.folder)
    _draw(evidence, look.folder)
    for name, text in pages.items():
        write_atomically(look.folder / name, text.encode())


def remove_pages(folder: Path) -> None:
    """Remove what `write_report` wrote, but for the picture."""
    names = (INDEX, README, ONE_FILE, *(f"{group['name']}.html" for group in GROUPS))
    for name in names:
        (folder / name).unlink(missing_ok=True)


def _groups(stored: Stored) -> Iterator[tuple[dict, list[ShownCase]]]:
    """The groups of which a case ran, with these: failed first, then by the share of the tolerance used."""
    for group in GROUPS:
        cases = [each for each in stored.ran.values() if group_of(each.name) == group]
        if cases:
            yield group, _ordered(cases)


def _ordered(cases: Iterable[ShownCase]) -> list[ShownCase]:
    return sorted(cases, key=lambda each: (not each.failed, -each.used))


def _contact(stored: Stored, look: Look) -> dict | None:
    """The picture of a contact on the first screen, of the case that is named for it or else of any."""
    case, name, words = PAGES["first"]["picture"]
    figures = [(each, figure) for each in stored.ran.values() for figure in each.case["figures"]]
    figures.sort(key=lambda one: f"{case}-{name}" not in one[1]["png"])
    if not figures:
        return None
    of, figure = figures[0]
    data, caption = look.folder / figure.get("csv", ""), f"{of.case['title']}: {figure['title']}"
    if f"{case}-{name}" in figure["png"] and data.is_file():
        *_, own, fem = np.loadtxt(data, delimiter=",", skiprows=1, unpack=True)
        caption = words.format(percent(np.abs(own - fem).max() / fem.max()))
    return {**figure_view(figure, look), "of": of, "caption": caption}


def _index(template: str, evidence: Evidence, answers: list[Answer], look: Look) -> str:
    stored = evidence.stored
    return _page(
        template,
        stored,
        look,
        contact=_contact(stored, look),
        numbers=first_numbers(evidence),
        cases=stored.ran,
        fields=(fields := of_fields(answers)),
        sentence=sentence(stored, evidence.pairs, fields),
        picture=f"{PICTURE}.png" if evidence.pairs else "",
        far=far(evidence.pairs),
        worst=max((abs(pair.error) for pair in evidence.pairs), default=None),
        pairs=len(evidence.pairs),
        gates=len(stored.gates),
        answers=answers,
        red=stored.red,
        broken=stored.broken,
        waiting=stored.waiting,
        further=stored.further,
        origins=origins(stored.ran.values()),
    )


def _page(template: str, stored: Stored, look: Look, **shown: Any) -> str:
    environment = Environment(
        loader=PackageLoader("verification.suite"),
        autoescape=lambda name: bool(name) and "html" in name,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= FILTERS
    css, _, _ = environment.loader.get_source(environment, "pages.css")
    words = WORDS[stored.results.get("kind", "verification")]
    text = environment.get_template(template).render(
        css=css,
        groups=[group for group, _ in _groups(stored)],
        results=stored.results,
        stale=stored.stale,
        words=words,
        first=PAGES["first"],
        home=look.to("README.md"),
        **shown,
    )
    return _CONTROL.sub("?", text)


def _draw(evidence: Evidence, folder: Path) -> None:
    if evidence.pairs:
        from verification.figures.specials import agreement  # noqa: PLC0415 - loads matplotlib
        from verification.figures.style import save  # noqa: PLC0415 - loads matplotlib

        (folder / PICTURE).parent.mkdir(parents=True, exist_ok=True)
        order = [group["title"] for group in GROUPS]
        titled = [(group_of(each.case.name)["title"], each) for each in evidence.pairs]
        titled.sort(key=lambda pair: order.index(pair[0]))
        rows = [
            (title, each.against, each.predicted, each.reference, each.case.name, each.quantity)
            for title, each in titled
        ]
        save(agreement(rows), folder / PICTURE, long=sys.maxsize)
