# SPDX-License-Identifier: MIT
"""The commands solve, plan and compare: from a scene file to a folder and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from sam.scene import Result, Scene, read_scene
from verification import models
from verification.compare import COLUMNS, Row, compare_scene, table_rows
from verification.console import Progress, digits, print_table
from verification.files import FolderError, check_target, csv_text, json_text, write_atomically, write_run
from verification.provenance import collect

COMPARISON = "compare.csv"
PARTS = {models.SAM: "sam", models.FEM: "fem"}


def solve(path: Path, model: str, out: Path | None, figures: bool) -> int:
    """Solve a scene into a folder; 0 if converged, else 1 with status and advice on stderr."""
    scene, inputs = read_scene(path)
    folder = out or Path(f"{path.stem}-{model}")
    models.check(scene, model)
    check_target(folder)
    result = _solved(scene, model, folder, inputs)
    shown = {name: value for name, value in result.quantities.items() if value is not None}
    print_table(("quantity", model), [(name, digits(value)) for name, value in shown.items()])
    print(folder / "summary.json")
    if figures:
        from verification.figures import solve_figures

        for drawn in solve_figures(folder):
            print(drawn)
    return _judge([result])


def plan(path: Path, as_json: bool) -> int:
    """Print what the scene will compute."""
    from verification.plan import plan as planned
    from verification.plan import plan_lines

    scene, _ = read_scene(path)
    content = planned(scene)
    print(json_text(content).rstrip() if as_json else "\n".join(plan_lines(content)))
    return 0


def compare(path: Path, model: str, out: Path | None) -> int:
    """Solve with SAM and `model`, write DIR/sam, DIR/fem and compare.csv; 0 if both converged and every row held."""
    scene, inputs = read_scene(path)
    folder = out or Path(f"{path.stem}-compare")
    models.check(scene, model)
    _check_comparison(folder)
    (folder / COMPARISON).unlink(missing_ok=True)
    results = [_solved(scene, name, folder / PARTS[name], inputs) for name in (models.SAM, model)]
    rows = compare_scene(scene, *results)
    write_atomically(folder / COMPARISON, csv_text(COLUMNS, table_rows(rows)).encode())
    _show(rows)
    print(folder / COMPARISON)
    return _judge(results, rows)


def _solved(scene: Scene, model: str, folder: Path, inputs: dict[str, bytes]) -> Result:
    with Progress() as progress:
        result = models.solve(scene, model, lambda stage, done, total: progress(f"{model}: {stage}", done, total))
    for warning in result.warnings:
        print(f"samfem: {model}: {warning}", file=sys.stderr)
    write_run(result, scene, folder, collect(inputs))
    return result


def _check_comparison(folder: Path) -> None:
    """Raise FolderError unless the folder is new, empty or of an older comparison."""
    check_target(folder, also=(COMPARISON, *PARTS.values()))
    if (folder / "summary.json").exists():
        raise FolderError(f"{folder} holds a single run: give a new or empty folder, or one of an older comparison")
    for part in PARTS.values():
        check_target(folder / part)


def _show(rows: Sequence[Row]) -> None:
    cells = [
        (
            row.quantity,
            digits(row.sam),
            digits(row.fem),
            digits(row.difference, 3),
            digits(row.tolerance),
            "passed" if row.passed else "FAILED",
        )
        for row in rows
    ]
    columns = ("quantity", "sam", "fem", "difference", "tolerance", "")
    print_table(columns, cells, red=[not row.passed for row in rows])


def _judge(results: Sequence[Result], rows: Sequence[Row] = ()) -> int:
    """Exit code; what did not hold, and what to change, on stderr."""
    unconverged = [result for result in results if not result.converged]
    for result in unconverged:
        message = result.message or result.status.advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    failed = [row.quantity for row in rows if not row.passed]
    if failed:
        finer = "refine grid.cells, grid.depths or fem.cells_per_radius and compare again"
        print(f"samfem: outside the tolerance: {', '.join(failed)}: {finer}", file=sys.stderr)
    return 1 if unconverged or failed else 0
