# SPDX-License-Identifier: MIT
"""The command fit: from measured dents to the parameters of a scene, a yield curve and a page.

Every model solve is kept in the store as it ends, so that a fit that was interrupted goes on where it was,
and writes the same bytes.
"""

from __future__ import annotations

from base64 import b64encode
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from samfem.refusals import check_folder
from verification.figures import drawing_of_fit
from verification.figures.style import save
from verification.fit import Definition, Fitted, Solves, fit as fitted_to, read_definition
from verification.fit.tensile import Tensile, read_tensile
from verification.fit.words import PARAMETERS, content, parameter_rows, shown
from verification.runs.files import json_text, write_atomically
from verification.runs.lock import locked
from verification.runs.store import Store, default_store, kept_coefficients
from verification.runs.tables import csv_text
from verification.text.console import Progress, print_table
from verification.text.readable import with_prefix

if TYPE_CHECKING:
    from sam.scene import Progress as Told

RECORD, PAGE = "fit.json", "fit.html"
CURVES = "yield-curve.csv"
FILES = (RECORD, PAGE, CURVES, "parameters.csv", "residuals.csv", "scene.toml", "fit.png", "fit.csv")
SHOWN = ["parameter", "value", "90 % confidence"]
STYLE = "<style>body{font:15px sans-serif;max-width:62em;margin:2em auto} img{width:100%}</style>"
CURVE = ("peeq", "yield_stress_Pa", "low_Pa", "high_Pa")


def fit(path: Path, *, out: Path | None, use_store: bool) -> int:
    """Fit the tests of a file, print the parameters and what stays open, and write the folder; of a tensile
    test (CSV) its law. Returns 0.
    """
    folder = out or Path(f"{path.name.partition('.')[0]}-fit")
    check_folder(folder, FILES, "fit")
    if path.name.lower().endswith((".csv", ".csv.gz")):
        return _tensile(read_tensile(path), folder)
    definition = read_definition(path)
    with locked(folder), Progress() as told:
        found, solves = answer(definition, default_store() if use_store else None, told)
        record = write(found, solves, folder)
    print_table(SHOWN, shown(found))
    print(*record["findings"], folder / PAGE, sep="\n")
    return 0


def _tensile(law: Tensile, folder: Path) -> int:
    """Print and write the law of a tensile test."""
    names = "B", "C", "n"
    swift = dict(zip(names, law.swift, strict=True))
    rows = [
        ("E", with_prefix(law.young, "Pa"), "slope of the elastic line"),
        ("yield stress", with_prefix(law.yield_stress, "Pa"), "engineering, 0.2 % offset"),
        (
            "exponent",
            f"{law.exponent:.3f}",
            "of yield stress (E strain/yield stress)^n, true and total strain",
        ),
        *((name, f"{value:.4g}", "of Swift's law in a scene, B in Pa") for name, value in swift.items()),
    ]
    with locked(folder):
        folder.mkdir(parents=True, exist_ok=True)
        content = {"young": law.young, "yield_stress": law.yield_stress, "exponent": law.exponent, **swift}
        write_atomically(folder / RECORD, json_text(content).encode())
        curve = csv_text(CURVE[:2], zip(law.peeq, law.stress, strict=True))
        write_atomically(folder / CURVES, curve.encode())
    print_table(("", "value", "definition"), rows)
    print(folder / CURVES)
    return 0


def answer(definition: Definition, store: Store | None, told: Told) -> tuple[Fitted, int]:
    """The fit, and how many model solves it took, those of the store included."""
    solves = Solves(definition.model, store, told)  # type: ignore[arg-type]  # mypy drops the None of its field
    with kept_coefficients():
        found = fitted_to(definition, solves)
    return found, len(solves.known)


def write(found: Fitted, solves: int, folder: Path) -> dict[str, Any]:
    """The tables, the scene, the figure and the page; the record last, which is returned."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        (folder / name).unlink(missing_ok=True)
    tables = {"parameters.csv": csv_text(PARAMETERS, parameter_rows(found))}
    rows = [
        (test.name, *row)
        for test, residuals, sigma in zip(found.definition.tests, found.residuals, found.sigma, strict=True)
        for row in zip(test.points.x, test.points.depth, sigma * residuals, residuals, strict=True)
    ]
    tables["residuals.csv"] = csv_text(("test", "x", "depth_m", "residual_m", "residual_over_sigma"), rows)
    scene = found.scene()
    if scene.body.plasticity is not None:
        tables[CURVES] = csv_text(CURVE, zip(*found.yield_curve(), strict=True))
    tables["scene.toml"] = scene.to_toml()
    for name, text in tables.items():
        write_atomically(folder / name, text.encode())
    picture = save(drawing_of_fit(found), folder / "fit")[0].read_bytes()
    record = content(found, solves)
    write_atomically(folder / PAGE, page(found, record, picture).encode())
    write_atomically(folder / RECORD, json_text(record).encode())
    return record


def page(found: Fitted, record: dict[str, Any], picture: bytes) -> str:
    """The page (HTML), with its figure inside."""
    from pandas import DataFrame

    names = [p.name for p in found.parameters]
    parts = {
        "Parameters": DataFrame(shown(found), columns=SHOWN).to_html(index=False),
        "What to know": "".join(f"<p>{escape(words)}</p>" for words in record["findings"]),
        "Tests and yield curve": f'<img src="data:image/png;base64,{b64encode(picture).decode()}">',
        "Correlations": DataFrame(found.correlations, names, names).round(3).to_html(),
        "Residuals": DataFrame(record["tests"]).to_html(index=False),
        "Classical numbers": DataFrame(record["classical"]).to_html(index=False),
        "Scene": f"<pre>{escape(found.scene().to_toml())}</pre>",
    }
    title = escape(found.definition.title or "Fit")
    body = "".join(f"<h2>{head}</h2>{text}" for head, text in parts.items())
    head = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>{STYLE}'
    said = f"Model {record['model']}, {record['model_solves']} solves, a/R up to {record['a_over_R']:.2g}."
    return f"{head}<h1>{title}</h1><p>{said}</p>{body}</html>\n"
