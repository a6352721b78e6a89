# SPDX-License-Identifier: MIT
"""A comparison as a page (HTML) and as JUnit, with the page and the records of the verification suite."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from samfem.compared import Compared
from samfem.solving import seconds, status_line
from verification.compare.rows import metric_of
from verification.figures import compare_figures
from verification.judging import RowStatus
from verification.runs import provenance
from verification.runs.files import FIGURES, FolderError, check_place, json_text, plain, write_atomically
from verification.suite import pages
from verification.suite.records import gates_csv, junit_xml
from verification.suite.verify import FORMAT, RESULTS, finished
from verification.text.readable import with_time

QUESTION = "Do SAM and the finite elements agree?"
FIGURE_TITLES = {
    "line": ("On the surface", "Pressure, displacement and gap along y = 0 at peak load."),
    "axis": ("Below the contact", "Stresses on the axis at peak load."),
    "history": ("Loading", "Force over approach."),
}


Scenes = Mapping[str, Compared]
"""Comparisons by the names of their scenes."""


def check_report(folder: Path) -> None:
    """Raise FolderError unless the folder is new, empty or of an older page."""
    try:
        check_place(folder)
    except (FolderError, OSError) as error:
        raise FolderError(f"--report {error}") from None
    if folder.is_dir() and any(folder.iterdir()):
        finished(folder)


def write_report(scenes: Scenes, inputs: Mapping[str, bytes], folder: Path) -> Path:
    """Write report.html, its figures and the rows as data; returns the path of the page.

    inputs: name of a file that was read -> its content.
    """
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(folder / FIGURES, ignore_errors=True)  # of an older page
    for name, each in scenes.items():
        compare_figures(folder, each.solutions, prefix=f"{name}-")
    gates = _gates(scenes)
    results: dict[str, Any] = plain(
        {
            "format": FORMAT,
            "kind": "comparison",
            "complete": True,
            "command": f"samfem compare {' '.join(scenes)}",
            "provenance": provenance.collect(dict(inputs)),
            "summary": {status: sum(gate["status"] == status for gate in gates) for status in RowStatus},
            "cases": [_case(name, each) for name, each in scenes.items()],
            "gates": gates,
        }
    )
    write_atomically(folder / "gates.csv", gates_csv(results["gates"]).encode())
    write_atomically(folder / "junit.xml", junit_of(scenes))
    page = pages.write_report(results, folder)
    write_atomically(folder / RESULTS, json_text(results).encode())
    return page


def junit_of(scenes: Scenes) -> bytes:
    """A test suite for each scene, a test case for each row."""
    cases = [_case(name, each) for name, each in scenes.items()]
    return junit_xml(cases, _gates(scenes), name="samfem compare")


def _gates(scenes: Scenes) -> list[dict[str, Any]]:
    """Every row as a gate: SAM is what is computed, FEM or the data what is expected."""
    found = []
    for case, each in scenes.items():
        rows = [(row.quantity, row) for row in each.rows]
        for data, beside in zip(each.data, each.beside, strict=True):
            rows += [(f"{data.name}: {row.quantity}", row) for row in beside]
        for name, row in rows:
            unit = row.quantity.split(" ")[0].rpartition("_")[2]
            gate = {"id": name, "case": case, "quantity": name, "metric": metric_of(row), "value": row.value}
            gate |= {"expected": row.expected, "error": row.error, "tolerance": row.row.tolerance}
            gate |= {"unit": unit if unit in ("Pa", "m", "m2", "N") else "", "status": row.status}
            found.append(plain(gate | {"reason": row.row.reason, "note": ""}))
    return found


def _case(name: str, found: Compared) -> dict[str, Any]:
    """A scene as the page shows a case."""
    ended = [f"{each.model}: {each.status}: {each.message}" for each in found.results if not each.converged]
    setup = [(each.model, status_line(each)) for each in found.results]
    setup += [(data.name, "data of the user, held against SAM") for data in found.data]
    return {
        "name": name,
        "title": found.scene.title or name,
        "question": QUESTION,
        "equations": [],
        "setup": setup,
        "status": str(RowStatus.PASSED if found.passed else RowStatus.FAILED),
        "failure": "; ".join(ended),
        "seconds": sum(map(seconds, found.results)),
        "runs": [],
        "figures": [_figure(name, kind, title, words) for kind, (title, words) in FIGURE_TITLES.items()],
        "tables": [*([_uncertainties(found)] if found.uncertain else []), _costs(found)],
        "notes": [found.line, *([found.film.words] if found.film else []), *found.range_lines],
    }


def _figure(case: str, kind: str, title: str, words: str) -> dict[str, Any]:
    files = {suffix: f"figures/{case}-{kind}.{suffix}" for suffix in ("png", "csv")}
    return {"title": title, "alt": words, "caption": words, **files}


def _uncertainties(found: Compared) -> dict[str, Any]:
    columns = ["Quantity", "|SAM - FEM|", "of SAM", "of FEM", "Within both"]
    caption = "Difference of both models and their numerical uncertainties, in SI units"
    rows = [
        [each.quantity, *(f"{value:.2g}" for value in (each.difference, each.sam, each.fem)), str(each.holds)]
        for each in found.uncertain
    ]
    return {"caption": caption, "columns": columns, "rows": rows}


def _costs(found: Compared) -> dict[str, Any]:
    rows = []
    for each in found.results:
        cpu, memory = each.cost.get("cpu_s"), each.cost.get("peak_memory_bytes")
        gib = None if memory is None else memory / 2**30
        cells = ("-" if value is None else f"{value:.3g}" for value in (cpu, gib))
        rows.append([each.model, with_time(seconds(each)), *cells])
    columns = ["Model", "Wall time", "CPU time [s]", "Memory [GiB]"]
    return {"caption": "Cost", "columns": columns, "rows": rows}
